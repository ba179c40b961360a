//! What cannot be laid out with its neighbours becomes an island of its own.
//!
//! Where fold-overs cannot be removed, a few triangles of a flat metric stay flipped: at slits of a scan that almost touch, at needles
//! round a cone of negative curvature. They are taken out of the layout, unfolded in one piece or several, and put beside it.
//! Each keeps the sides that it has in the layout, as its mirror image where it is flipped: then the seams round it are rigid
//! like all others, and what is detached may be attached elsewhere. Or, where that would be too stretched, all are unfolded
//! as they lie in space ([`DetachedShape`]). What is left of the layout stays as it is; so that it stays a disk, a hole that
//! does not reach a seam or the boundary is joined to the nearest by a further seam. A polygon goes as a whole, for its
//! triangles share their corners' positions.

use std::collections::VecDeque;

use geom::{
    CutMesh, EdgeData, FaceData, FaceId, HalfedgeData, HalfedgeId, Id, Mesh, Metric, ShortestPaths, Sides, VertexData,
    open_vertices,
};
use num_complex::Complex64;

use super::layout::Layout;
use super::seams::Seams;

/// The shape of what is detached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DetachedShape {
    /// With the sides that each triangle has in the layout: seams round it are rigid.
    AsLaidOut,
    /// As it lies in space, but for one scale: seams round it do not match.
    AsInSpace,
}

/// Takes triangles out of a layout, unfolded in the shape given; `u` are the log scale factors that the flat metric has. The seams' `lengths` say which
/// way further seams go; diagonals of polygons are infinitely long. O(V log V).
pub(crate) fn detach(
    input: &Mesh,
    metric: &Metric,
    u: &VertexData<f64>,
    lengths: &EdgeData<f64>,
    (faces, shape): (&[FaceId], DetachedShape),
    seams: &mut Seams,
    layout: &mut Layout,
) {
    let mut is_out = FaceData::constant(input.face_count(), false);
    let faces = &whole_polygons(input, lengths, faces);
    faces.iter().for_each(|&f| is_out[f] = true);
    let was_cut = seams.cut.clone();
    join_holes(input, lengths, &is_out, &mut seams.cut);
    faces.iter().flat_map(|&f| input.sides(f)).for_each(|h| seams.cut[input.edge(h)] |= input.twin(h).is_some());
    let position = input.halfedges().map(|h| layout.corner(h)).collect();
    let cut = &mut seams.cut;
    let mut unfolding = Unfolding { input, metric, lengths, was_cut: &was_cut, is_out, cut, position, shape };
    for &seed in faces {
        let scale = match shape {
            DetachedShape::AsLaidOut => 1.0,
            DetachedShape::AsInSpace => (input.corners(seed).iter().map(|&v| u[v]).sum::<f64>() / 3.0).exp(),
        };
        unfolding.unfold(seed, scale);
    }
    let position = unfolding.position;
    let cut = CutMesh::open(input, &seams.cut);
    let mut opened = vec![Complex64::ZERO; cut.wedge_count()];
    for h in input.halfedges() {
        opened[cut.wedge(h).index()] = position[h];
    }
    layout.cut = cut;
    layout.position = opened;
    seams.string(input, lengths);
}

/// The triangles, and those that hang together with them by diagonals, whose `lengths` are infinite.
pub(crate) fn whole_polygons(input: &Mesh, lengths: &EdgeData<f64>, faces: &[FaceId]) -> Vec<FaceId> {
    let mut whole = faces.to_vec();
    let mut is_in = FaceData::constant(input.face_count(), false);
    faces.iter().for_each(|&f| is_in[f] = true);
    let mut at = 0;
    while at < whole.len() {
        let diagonals = input.sides(whole[at]).into_iter().filter(|&h| lengths[input.edge(h)].is_infinite());
        let across = diagonals.filter_map(|h| input.twin(h)).map(|g| input.face(g));
        whole.extend(across.filter(|&f| !std::mem::replace(&mut is_in[f], true)));
        at += 1;
    }
    whole
}

/// Cuts along a shortest path from each hole that touches no seam and no boundary to one that does.
fn join_holes(input: &Mesh, lengths: &EdgeData<f64>, is_out: &FaceData<bool>, cut: &mut EdgeData<bool>) {
    let is_open = open_vertices(input, cut);
    let open = input.vertices().filter(|&v| is_open[v]);
    let paths = ShortestPaths::new(input, lengths, open.map(|v| (v, 0)));
    let mut is_done = FaceData::constant(input.face_count(), false);
    for seed in input.faces().filter(|&f| is_out[f]) {
        if is_done[seed] {
            continue;
        }
        is_done[seed] = true;
        let mut hole = vec![seed];
        let mut at = 0;
        while at < hole.len() {
            let corners = input.corners(hole[at]);
            let around = corners.into_iter().flat_map(|v| input.outgoing(v)).map(|h| input.face(h));
            hole.extend(around.filter(|&f| is_out[f] && !std::mem::replace(&mut is_done[f], true)));
            at += 1;
        }
        let vertices = hole.iter().flat_map(|&f| input.corners(f));
        let nearest = vertices.min_by(|a, b| paths.distance[*a].total_cmp(&paths.distance[*b]).then(a.cmp(b)));
        let mut v = nearest.expect("a hole has triangles");
        while let Some(e) = paths.predecessor[v] {
            cut[e] = true;
            v = geom::other_end(input, e, v);
        }
    }
}

struct Unfolding<'a> {
    input: &'a Mesh,
    metric: &'a Metric,
    /// Infinite at the diagonals of polygons.
    lengths: &'a EdgeData<f64>,
    /// The cut before anything was detached.
    was_cut: &'a EdgeData<bool>,
    /// The triangles that are to be unfolded yet.
    is_out: FaceData<bool>,
    cut: &'a mut EdgeData<bool>,
    /// The position of each corner.
    position: HalfedgeData<Complex64>,
    shape: DetachedShape,
}

impl Unfolding<'_> {
    /// Unfolds the triangles that hang together with `seed` and are out yet, at one scale.
    fn unfold(&mut self, seed: FaceId, scale: f64) {
        if !std::mem::replace(&mut self.is_out[seed], false) {
            return;
        }
        let input = self.input;
        let first = self.place(input.sides(seed)[0], Complex64::ZERO, Complex64::from(scale));
        let mut queue = VecDeque::new();
        self.enqueue(first, &mut queue);
        while let Some(h) = queue.pop_front() {
            let Some(g) = input.twin(h).filter(|_| !self.was_cut[input.edge(h)]) else { continue };
            if std::mem::replace(&mut self.is_out[input.face(g)], false) {
                self.cut[input.edge(h)] = false;
                let [tail, head] = [self.position[h], self.position[input.next(h)]];
                let along = tail - head;
                let direction = if along.norm() > 0.0 { along / along.norm() } else { Complex64::ONE };
                let sides = self.place(g, head, direction * scale);
                self.enqueue(sides, &mut queue);
            }
        }
    }

    /// Sides to go across, diagonals before all others: so a polygon is placed as a whole before its neighbours are.
    fn enqueue(&self, sides: [HalfedgeId; 3], queue: &mut VecDeque<HalfedgeId>) {
        for side in sides {
            match self.lengths[self.input.edge(side)].is_infinite() {
                true => queue.push_front(side),
                false => queue.push_back(side),
            }
        }
    }

    /// Places a triangle by the corner at a halfedge's tail and the halfedge's direction, multiplied by the scale; returns
    /// its sides.
    fn place(&mut self, h: HalfedgeId, tail: Complex64, direction: Complex64) -> [HalfedgeId; 3] {
        let sides = [h, self.input.next(h), self.input.prev(h)];
        let length = |side: HalfedgeId| match self.shape {
            DetachedShape::AsLaidOut => (self.position[self.input.next(side)] - self.position[side]).norm(),
            DetachedShape::AsInSpace => self.metric.length(self.input.edge(side)),
        };
        let vectors = Sides(sides.map(length)).unfold();
        let mut at = tail;
        for (side, [x, y]) in sides.into_iter().zip(vectors) {
            self.position[side] = at;
            at += direction * Complex64::new(x, y);
        }
        sides
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{VertexId, shapes};

    use crate::flatten::flattened::Flattened;

    fn flattened(shape: &shapes::Shape) -> Flattened {
        Flattened::new(shape, &[20, 170, 290, 410].map(VertexId))
    }

    #[test]
    fn what_is_detached_keeps_its_shape_and_all_islands_are_disks() {
        for (shape, out) in [(shapes::hare(900), [5, 6, 7, 300, 901]), (shapes::terrain(600, 2), [0, 1, 400, 401, 600])]
        {
            let Flattened { mesh, metric, scaling, mut seams, mut layout } = flattened(&shape);
            let before = layout.clone();
            let was_cut = seams.cut.clone();
            // The rings of some vertices, lone triangles, and the two beside a seam.
            let ring = |v| mesh.outgoing(v).map(|h| mesh.face(h));
            let mut faces: Vec<FaceId> =
                [VertexId(50), VertexId(333)].into_iter().flat_map(ring).chain(out.map(FaceId)).collect();
            let seam = mesh.edges().find(|&e| was_cut[e] && mesh.twin(mesh.halfedge(e)).is_some()).expect("it is cut");
            let first = mesh.halfedge(seam);
            faces.extend([Some(first), mesh.twin(first)].into_iter().flatten().map(|h| mesh.face(h)));
            faces.sort();
            faces.dedup();
            let detached = (&faces[..], DetachedShape::AsInSpace);
            detach(&mesh, &metric, &scaling.u, metric.lengths(), detached, &mut seams, &mut layout);

            let islands = layout.cut.island_count();
            assert!(islands > 2);
            assert_eq!(layout.cut.euler_characteristic(), islands as i64);
            assert_eq!(layout.cut.boundary_loops().len(), islands, "each island has one boundary");
            let strung: usize = seams.chains.iter().map(|chain| chain.edges.len()).sum();
            assert_eq!(strung, mesh.edges().filter(|&e| seams.cut[e]).count());
            assert!(mesh.edges().all(|e| seams.cut[e] || !was_cut[e]), "a seam stays one");
            let is_out = |h| mesh.twin(h).is_some_and(|g| faces.contains(&mesh.face(g)));
            for f in mesh.faces() {
                let corners = |layout: &Layout| mesh.sides(f).map(|h| layout.corner(h));
                if !faces.contains(&f) {
                    assert_eq!(corners(&layout), corners(&before));
                    continue;
                }
                let [a, b, c] = corners(&layout);
                let sides = metric.sides(&mesh, f).0;
                let scales = [(b - a).norm() / sides[0], (c - b).norm() / sides[1], (a - c).norm() / sides[2]];
                assert!(scales.iter().all(|s| (s / scales[0] - 1.0).abs() < 1e-9), "{scales:?}");
                assert!(((b - a).conj() * (c - a)).im > 0.0);
                if !mesh.sides(f).into_iter().any(is_out) {
                    let mean = mesh.corners(f).iter().map(|&v| scaling.u[v]).sum::<f64>() / 3.0;
                    assert!((scales[0].ln() - mean).abs() < 1e-9, "alone, it has the size that it had on the mean");
                }
            }
        }
    }

    #[test]
    fn what_is_detached_as_laid_out_has_rigid_seams_and_is_turned_over_where_it_was_flipped() {
        let Flattened { mesh, metric, scaling, mut seams, mut layout } = flattened(&shapes::hare(900));
        let is_plain = |v: &VertexId| mesh.outgoing(*v).all(|h| !seams.cut[mesh.edge(h)]);
        let middle = mesh.vertices().filter(is_plain).nth(40).expect("most vertices are such");
        let ring: Vec<HalfedgeId> = mesh.outgoing(middle).collect();
        // Drawn across the opposite side of one of its triangles, the vertex flips that.
        let [b, c] = [mesh.next(ring[0]), mesh.prev(ring[0])].map(|h| layout.corner(h));
        let wedge = layout.cut.wedge(ring[0]).index();
        layout.position[wedge] = b + c - layout.position[wedge];
        let area = |layout: &Layout, f: FaceId| {
            let [a, b, c] = mesh.sides(f).map(|h| layout.corner(h));
            ((b - a).conj() * (c - a)).im
        };
        let bad: Vec<FaceId> = ring.iter().map(|&h| mesh.face(h)).filter(|&f| area(&layout, f) <= 0.0).collect();
        assert!(!bad.is_empty());
        let length = |layout: &Layout, h: HalfedgeId| (layout.corner(mesh.next(h)) - layout.corner(h)).norm();
        let before = layout.clone();
        let detached = (&bad[..], DetachedShape::AsLaidOut);
        detach(&mesh, &metric, &scaling.u, metric.lengths(), detached, &mut seams, &mut layout);
        assert!(mesh.faces().all(|f| area(&layout, f) > 0.0));
        for h in mesh.halfedges() {
            assert!((length(&layout, h) / length(&before, h) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_polygon_is_detached_as_a_whole() {
        let Flattened { mesh, metric, scaling, mut seams, mut layout } = flattened(&shapes::hare(900));
        let before = layout.clone();
        // All round a vertex a fan of quadrilaterals: every other spoke is a diagonal.
        let is_plain = |v: &VertexId| {
            let mut around = mesh.outgoing(*v);
            mesh.face_degree(*v) == 6 && around.all(|h| !seams.cut[mesh.edge(h)])
        };
        let middle = mesh.vertices().find(is_plain).expect("most vertices are such");
        let spokes: Vec<HalfedgeId> = mesh.outgoing(middle).collect();
        let mut lengths = metric.lengths().clone();
        spokes.iter().step_by(2).for_each(|&h| lengths[mesh.edge(h)] = f64::INFINITY);
        let halves: Vec<FaceId> = spokes.iter().step_by(2).map(|&h| mesh.face(h)).collect();
        let detached = (&halves[..], DetachedShape::AsInSpace);
        detach(&mesh, &metric, &scaling.u, &lengths, detached, &mut seams, &mut layout);
        for (k, &h) in spokes.iter().enumerate() {
            let corners = |layout: &Layout| mesh.sides(mesh.face(h)).map(|side| layout.corner(side));
            assert_ne!(corners(&layout), corners(&before), "the other halves go, too");
            assert!(k % 2 == 1 || !seams.cut[mesh.edge(h)], "no diagonal is cut");
        }
    }

    #[test]
    fn a_hole_is_joined_by_the_shortest_way_to_a_seam() {
        let shape = shapes::terrain(900, 2);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let lengths = metric.lengths();
        let rim = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).map(|v| (v, 0));
        let paths = ShortestPaths::new(&mesh, lengths, rim);
        for v in mesh.vertices().filter(|&v| paths.distance[v] > 0.0) {
            let is_out = mesh.faces().map(|f| mesh.corners(f).contains(&v)).collect();
            let mut cut = EdgeData::constant(mesh.edge_count(), false);
            join_holes(&mesh, lengths, &is_out, &mut cut);
            let length: f64 = mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).sum();
            let ring = mesh.outgoing(v).map(|h| mesh.head(h));
            let least = ring.map(|w| paths.distance[w]).fold(f64::INFINITY, f64::min);
            assert!((length - least).abs() < 1e-9, "{length} where {least} is enough");
        }
    }
}
