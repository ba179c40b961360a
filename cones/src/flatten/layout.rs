//! The layout: from a flat metric to positions in the plane, on the input's own triangles.
//!
//! The metric comes on a flipped triangulation. Its triangles, each unfolded in a frame of its own, and the rotations that
//! take one frame to the next across an edge make a flat connection with cones. Undoing the flips one by one, backwards,
//! takes two triangles into one frame, replaces the diagonal by the other one (a sum of two sides), and so ends at the
//! input's triangles with exact edge vectors; a few of them may have come out negatively oriented
//! ([`fold_over`](super::fold_over)). Then the surface is opened along the cut, rotations are carried over the dual tree, and
//! positions along the tree of shortest edges, so that an error made somewhere stays as small as the region it was made in.
//! Similarities are never chained: lengths come from the metric alone.

use std::collections::VecDeque;
use std::ops::Index;

use geom::vector::norm;
use geom::{
    CutMesh, EdgeData, FaceData, FaceId, HalfedgeData, HalfedgeId, Id, Interrupted, Mesh, Rows, Triangulation, Watch,
    minimum_spanning_forest,
};
use num_complex::Complex64;
use rayon::prelude::*;

use super::scaling::Scaling;

/// So many flips are undone between two looks at the watch.
const STRIDE: usize = 4096;
/// So many triangles or halfedges are gone through one after the other.
const AT_ONCE: usize = 1024;

/// A surface in the plane: a position for each opened vertex.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The surface opened along its seams.
    pub cut: CutMesh,
    /// The position of each opened vertex, as a complex number.
    pub position: Vec<Complex64>,
    /// The rotation of each seam.
    pub seam_rotation: SeamRotations,
}

/// The rotation of each seam, by halfedge: what takes directions seen from the twin's side into directions seen from this side; 1 where
/// there is no seam. Kept for seams alone, ascending.
#[derive(Clone, Debug)]
pub struct SeamRotations(Vec<(HalfedgeId, Complex64)>);

impl SeamRotations {
    /// Those of the edges that are cut, by a halfedge and its twin.
    pub(super) fn new(
        mesh: &Mesh,
        cut: &EdgeData<bool>,
        rotation: impl Fn(HalfedgeId, HalfedgeId) -> Complex64,
    ) -> Self {
        let sides = mesh.halfedges().filter(|&h| cut[mesh.edge(h)]);
        Self(sides.filter_map(|h| Some((h, rotation(h, mesh.twin(h)?)))).collect())
    }

    /// Those of them that are of the edges of a mesh that are cut.
    pub(crate) fn of_cut(&self, mesh: &Mesh, cut: &EdgeData<bool>) -> Self {
        Self::new(mesh, cut, |h, _| self[h])
    }
}

impl Index<HalfedgeId> for SeamRotations {
    type Output = Complex64;

    fn index(&self, h: HalfedgeId) -> &Complex64 {
        match self.0.binary_search_by_key(&h, |(side, _)| *side) {
            Ok(k) => &self.0[k].1,
            Err(_) => &Complex64::ONE,
        }
    }
}

impl Layout {
    /// Lays out the input's triangles, opened along the edges of the cut, which must leave one disk.
    ///
    /// # Errors
    /// If the watch has said stop.
    pub fn new(input: &Mesh, scaling: &Scaling, cut: &EdgeData<bool>, watch: Watch) -> Result<Self, Interrupted> {
        let connection = Connection::new(scaling, watch.within(0.0, 0.1))?;
        let connection = connection.undo(&scaling.flips, watch.within(0.1, 0.3))?.of_input(input);
        watch.ask(0.3)?;
        let (rotation, opened) = watch.within(0.35, 0.7).shared(|watch| {
            rayon::join(|| connection.face_rotations(input, cut), || Opened::new(input, cut, &connection.vector, watch))
        });
        let opened = opened?;
        let FlatConnection { mut vector, transport } = connection;
        let seam_rotation = SeamRotations::new(input, cut, |h, g| {
            rotation[input.face(h)] * transport[h] * rotation[input.face(g)].conj()
        });
        drop(transport);
        let sides = vector.par_chunks_exact_mut(3).with_min_len(AT_ONCE).zip(rotation.par_iter());
        sides.for_each(|(sides, rotation)| sides.iter_mut().for_each(|side| *side = rotation * *side));
        drop(rotation);
        watch.ask(0.8)?;
        let position = opened.positions(input, &vector);
        Ok(Self { cut: opened.cut, position, seam_rotation })
    }

    /// The position of a triangle's corner, named by the halfedge that starts there.
    pub fn corner(&self, h: HalfedgeId) -> Complex64 {
        self.position[self.cut.wedge(h).index()]
    }

    /// The area of all triangles of the input, whichever way round they lie.
    pub(crate) fn area(&self, input: &Mesh) -> f64 {
        let area = |[a, b, c]: [Complex64; 3]| 0.5 * ((b - a).conj() * (c - a)).im.abs();
        input.faces().map(|f| area(input.sides(f).map(|h| self.corner(h)))).sum()
    }
}

/// A [`Connection`] of the input.
struct FlatConnection {
    vector: HalfedgeData<Complex64>,
    transport: HalfedgeData<Complex64>,
}

/// Triangles in frames of their own, and the rotations between the frames.
struct Connection {
    triangulation: Triangulation,
    /// Each halfedge as a vector in its triangle's frame.
    vector: HalfedgeData<Complex64>,
    /// The unit complex number that takes vectors of the twin's frame into the halfedge's.
    transport: HalfedgeData<Complex64>,
}

impl Connection {
    fn new(scaling: &Scaling, watch: Watch) -> Result<Self, Interrupted> {
        watch.ask(0.0)?;
        let triangulation = scaling.triangulation.clone();
        let unfolded = |f: usize| {
            let sides = scaling.metric.sides(&triangulation, FaceId::new(f));
            sides.unfold().map(|[x, y]| Complex64::new(x, y))
        };
        let vector: Vec<[Complex64; 3]> =
            (0..triangulation.face_count()).into_par_iter().with_min_len(AT_ONCE).map(unfolded).collect();
        let vector: HalfedgeData<Complex64> = vector.into_flattened().into();
        watch.ask(0.5)?;
        let across = |h: usize| {
            let h = HalfedgeId::new(h);
            triangulation.twin(h).map_or(Complex64::ONE, |g| unit(-vector[h] * vector[g].conj()))
        };
        let transport: Vec<Complex64> =
            (0..triangulation.halfedge_count()).into_par_iter().with_min_len(AT_ONCE).map(across).collect();
        Ok(Self { triangulation, vector, transport: transport.into() })
    }

    fn undo(mut self, flips: &[HalfedgeId], watch: Watch) -> Result<Self, Interrupted> {
        for (count, &h) in flips.iter().rev().enumerate() {
            if count.is_multiple_of(STRIDE) {
                watch.ask(count as f64 / flips.len() as f64)?;
            }
            self.unflip(h);
        }
        Ok(self)
    }

    /// What belongs to the input, once all flips are undone: all of it, or the first half of a double.
    fn of_input(self, input: &Mesh) -> FlatConnection {
        debug_assert!(input.faces().all(|f| self.triangulation.corners(f) == input.corners(f)), "all flips are undone");
        let of_input = |data: HalfedgeData<Complex64>| -> HalfedgeData<Complex64> {
            if data.len() == input.halfedge_count() { data } else { input.halfedges().map(|h| data[h]).collect() }
        };
        FlatConnection { vector: of_input(self.vector), transport: of_input(self.transport) }
    }

    fn unflip(&mut self, h: HalfedgeId) {
        let g = self.triangulation.twin(h).expect("a flipped edge has two sides");
        let turn = self.transport[h];
        for side in [self.triangulation.next(g), self.triangulation.prev(g)] {
            self.vector[side] *= turn;
            self.transport[side] = kept_unit(self.transport[side] * turn);
            if let Some(twin) = self.triangulation.twin(side) {
                self.transport[twin] = kept_unit(self.transport[twin] * turn.conj());
            }
        }
        self.transport[h] = Complex64::ONE;
        self.transport[g] = Complex64::ONE;
        let moves = self.triangulation.unflip(h);
        for data in [&mut self.vector, &mut self.transport] {
            let old = moves.map(|(from, _)| data[from]);
            for (&(_, to), old) in moves.iter().zip(old) {
                data[to] = old;
            }
        }
        // The two new triangles close.
        self.vector[h] = -(self.vector[self.triangulation.next(h)] + self.vector[self.triangulation.prev(h)]);
        self.vector[g] = -self.vector[h];
    }
}

impl FlatConnection {
    /// The rotation of each triangle's frame into the plane, carried across edges that are not cut, and from island to
    /// island across one that is.
    fn face_rotations(&self, mesh: &Mesh, cut: &EdgeData<bool>) -> FaceData<Complex64> {
        // 0 where it is not known yet.
        let mut rotation: FaceData<Complex64> = FaceData::constant(mesh.face_count(), Complex64::ZERO);
        let mut queue = VecDeque::new();
        // Where islands that are to come begin: across the edges of those that are done.
        let mut shores = VecDeque::new();
        for seed in mesh.faces() {
            shores.push_back((seed, Complex64::ONE));
            while let Some((seed, turn)) = shores.pop_front() {
                queue.push_back((seed, turn));
                while let Some((f, turn)) = queue.pop_front() {
                    if rotation[f] != Complex64::ZERO {
                        continue;
                    }
                    rotation[f] = turn;
                    for h in mesh.sides(f) {
                        let Some(g) = mesh.twin(h).map(|twin| mesh.face(twin)) else { continue };
                        if rotation[g] == Complex64::ZERO {
                            let next = if cut[mesh.edge(h)] { &mut shores } else { &mut queue };
                            next.push_back((g, kept_unit(turn * self.transport[h])));
                        }
                    }
                }
            }
        }
        rotation
    }
}

/// The opened surface with a spanning tree of shortest edges, one of the two sides each.
struct Opened {
    cut: CutMesh,
    tree: Vec<HalfedgeId>,
}

impl Opened {
    /// Lengths are those of the vectors, however they are turned.
    fn new(
        input: &Mesh,
        is_cut: &EdgeData<bool>,
        vector: &HalfedgeData<Complex64>,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let cut = CutMesh::open(input, is_cut);
        watch.ask(0.3)?;
        let one_a_side = |&h: &HalfedgeId| is_cut[input.edge(h)] || input.halfedge(input.edge(h)) == h;
        let ends = |h: HalfedgeId| [h, input.next(h)].map(|h| cut.wedge(h).0);
        // What is not negative is in the order of its bits, what is no number last or first.
        let edges = input.halfedges().filter(one_a_side).map(|h| ((vector[h].norm_sqr().to_bits(), h), ends(h)));
        let tree = minimum_spanning_forest(cut.wedge_count(), edges, watch.within(0.3, 1.0))?;
        let tree = tree.into_iter().map(|(_, h)| h).collect();
        Ok(Self { cut, tree })
    }

    /// Positions that follow the edge vectors along the tree.
    fn positions(&self, input: &Mesh, vector: &HalfedgeData<Complex64>) -> Vec<Complex64> {
        let Self { cut, tree } = self;
        let ends = |h: HalfedgeId| [h, input.next(h)].map(|h| cut.wedge(h).index());
        let links = Rows::sorted(cut.wedge_count(), tree.iter().flat_map(|&h| ends(h).map(|end| (end, h))));
        let mut position: Vec<Option<Complex64>> = vec![None; cut.wedge_count()];
        let mut stack = Vec::new();
        for root in 0..position.len() {
            if position[root].is_none() {
                position[root] = Some(Complex64::ZERO);
                stack.push((root, Complex64::ZERO));
            }
            while let Some((w, at)) = stack.pop() {
                for &h in links.row(w) {
                    let [from, to] = ends(h);
                    let (to, step) = if from == w { (to, vector[h]) } else { (from, -vector[h]) };
                    if position[to].is_none() {
                        position[to] = Some(at + step);
                        stack.push((to, at + step));
                    }
                }
            }
        }
        position.into_iter().flatten().collect()
    }
}

/// A number of modulus 1 in the direction of `z`; 1 where `z` is 0.
fn unit(z: Complex64) -> Complex64 {
    let norm = norm([z.re, z.im]);
    if norm > 0.0 { z / norm } else { Complex64::ONE }
}

/// A product of numbers of modulus 1, with the modulus brought back to 1 to rounding: a step of Newton's method, which takes no root.
fn kept_unit(z: Complex64) -> Complex64 {
    z * (1.5 - 0.5 * z.norm_sqr())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Operators;
    use crate::flatten::{Seams, scale};
    use geom::{Metric, VertexData, VertexId, shapes};

    #[test]
    fn a_developable_cone_is_laid_out_exactly() {
        for shape in [shapes::cone(5, 400), shapes::saddle_cone(400)] {
            let mesh = shape.mesh();
            let metric = Metric::from_points(&mesh, &shape.points);
            let operators = Operators::new(&mesh, &metric).unwrap();
            let inner = |v: &VertexId| !mesh.is_boundary_vertex(*v);
            let tip = mesh
                .vertices()
                .filter(inner)
                .max_by(|a, b| operators.curvature[*a].abs().total_cmp(&operators.curvature[*b].abs()));
            let tip = tip.expect("there are inner vertices");
            let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
            target[tip] = operators.curvature[tip];
            let zero = VertexData::constant(mesh.vertex_count(), 0.0);
            let scaling = scale(&mesh, &metric, &operators, &target, &zero, Watch::NONE).unwrap();
            let seams = Seams::new(&mesh, metric.lengths(), &[tip], Watch::NONE).unwrap();
            let layout = Layout::new(&mesh, &scaling, &seams.cut, Watch::NONE).unwrap();
            for h in mesh.halfedges() {
                let length = (layout.corner(mesh.next(h)) - layout.corner(h)).norm();
                assert!((length / metric.length(mesh.edge(h)) - 1.0).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn the_two_sides_of_a_seam_differ_by_its_rotation() {
        let shape = shapes::torus(2, 800);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let operators = Operators::new(&mesh, &metric).unwrap();
        let cones = [VertexId(10), VertexId(400)];
        let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
        for v in cones {
            target[v] = 0.5 * operators.total_curvature();
        }
        let zero = VertexData::constant(mesh.vertex_count(), 0.0);
        let scaling = scale(&mesh, &metric, &operators, &target, &zero, Watch::NONE).unwrap();
        let seams = Seams::new(&mesh, metric.lengths(), &cones, Watch::NONE).unwrap();
        let layout = Layout::new(&mesh, &scaling, &seams.cut, Watch::NONE).unwrap();
        let extent = layout.position.iter().map(|z| z.norm()).fold(0.0, f64::max);
        for h in mesh.halfedges() {
            let g = mesh.twin(h).expect("it is closed");
            let here = layout.corner(mesh.next(h)) - layout.corner(h);
            let there = layout.corner(g) - layout.corner(mesh.next(g));
            assert!((here - layout.seam_rotation[h] * there).norm() < 1e-10 * extent);
            assert!((layout.seam_rotation[h] * layout.seam_rotation[g] - 1.0).norm() < 1e-12);
            let cut = layout.cut.wedge(h) != layout.cut.wedge(mesh.next(g));
            assert!(cut || layout.seam_rotation[h] == Complex64::ONE);
        }
    }
}
