//! Where thin limbs are cut off.
//!
//! Along a tube as thin as it is long the conformal factor φ falls by 2π towards the tip, and so on from limb to limb of a tree: no few cones make
//! up for that. φ itself tells where limbs are. Growing from below, its sublevel sets begin at tips, and where two of them meet a limb has branched
//! (elder rule: a minimum that is hardly lower than where its set meets another is none). Once more than a few tips are together their set is cut off from
//! the rest by the shortest edges near its rim, which is the limb's neck.

use std::collections::BTreeMap;

use geom::{EdgeData, FaceData, FaceId, Interrupted, Mesh, Side, VertexData, VertexId, Watch, shortest_separation};

/// A minimum of φ is a tip if its set meets another one so much higher: lengths change by a factor of 20 on the way.
const PERSISTENT: f64 = 3.0;
/// Necks are looked for so far below the level where sets meet,
const DEEP: f64 = 3.0;
/// among so many triangles at most: more take long, and leave room enough on any mesh.
const MOST_NEAR: usize = 1 << 13;
/// The mark of triangles that may be on either side.
const NEAR: u32 = u32::MAX;
/// Where nothing could be cut so often it is not tried again.
const MOST_IN_VAIN: usize = 64;
/// Regions of fewer triangles are no pieces.
const CRUMB: usize = 20;

/// A sublevel set of φ, as far as it is not cut off.
struct Limb {
    /// Its lowest value; none where that has been cut off, or is on the boundary, which takes curvature without a cone.
    lowest: Option<f64>,
    tips: usize,
    faces: Vec<FaceId>,
}

/// A surface whose thin limbs are cut off.
pub(crate) struct Limbs {
    /// The piece that each triangle is on, 0 for what is left. Not all of a piece need be connected.
    pub(crate) piece: FaceData<u32>,
    /// How many tips it has.
    pub(crate) tips: usize,
}

/// The thin limbs of a surface, so that no piece has more than so many tips as far as edges let it; none if it has no more itself. `lengths` are
/// infinite where nothing may be cut. O(V log V), and the time of the [separations](shortest_separation) of small parts.
///
/// # Errors
/// If it is stopped.
pub(crate) fn limbs(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    phi: &VertexData<f64>,
    most_tips: usize,
    watch: Watch,
) -> Result<Option<Limbs>, Interrupted> {
    let mut order: Vec<VertexId> = mesh.vertices().collect();
    order.sort_by(|a, b| phi[*a].total_cmp(&phi[*b]).then(a.cmp(b)));
    let mut rank = VertexData::constant(mesh.vertex_count(), 0u32);
    (0..).zip(&order).for_each(|(place, &v)| rank[v] = place);
    let highest = |f: FaceId| mesh.corners(f).into_iter().max_by_key(|&v| rank[v]).expect("a triangle has corners");
    let mut sweep = Sweep {
        mesh,
        lengths,
        most_tips,
        height: mesh.faces().map(|f| phi[highest(f)]).collect(),
        parent: mesh.vertices().collect(),
        limbs: mesh.vertices().map(|_| None).collect(),
        piece: FaceData::constant(mesh.face_count(), 0),
        pieces: 0,
        cut: 0,
        in_vain: 0,
    };
    for (k, &v) in order.iter().enumerate() {
        if k % 4096 == 0 {
            watch.ask(k as f64 / order.len() as f64)?;
        }
        let mut below: Vec<VertexId> =
            mesh.neighbors(v).iter().filter(|&&w| rank[w] < rank[v]).map(|&w| sweep.root(w)).collect();
        below.sort_unstable();
        below.dedup();
        sweep.meet(v, phi[v], &below, watch)?;
        let own = mesh.outgoing(v).map(|h| mesh.face(h)).filter(|&f| highest(f) == v);
        let root = sweep.root(v);
        sweep.limbs[root].get_or_insert_with(Limb::none).faces.extend(own);
    }
    sweep.without_crumbs();
    let Sweep { piece, pieces, mut cut, limbs, .. } = sweep;
    cut += limbs.iter().flatten().map(|limb| limb.tips).sum::<usize>();
    Ok((pieces > 0).then_some(Limbs { piece, tips: cut }))
}

impl Limb {
    fn none() -> Self {
        Self { lowest: None, tips: 0, faces: Vec::new() }
    }
}

struct Sweep<'a> {
    mesh: &'a Mesh,
    lengths: &'a EdgeData<f64>,
    most_tips: usize,
    /// The largest φ of each triangle's corners.
    height: FaceData<f64>,
    /// Towards the root of each vertex's set.
    parent: VertexData<VertexId>,
    /// The set of each root.
    limbs: VertexData<Option<Limb>>,
    piece: FaceData<u32>,
    pieces: u32,
    /// How many tips have been cut off.
    cut: usize,
    /// How often nothing could be cut.
    in_vain: usize,
}

impl Sweep<'_> {
    fn root(&mut self, mut v: VertexId) -> VertexId {
        while self.parent[v] != v {
            self.parent[v] = self.parent[self.parent[v]];
            v = self.parent[v];
        }
        v
    }

    /// The sets at the vertices `below` meet at one of this level.
    fn meet(&mut self, v: VertexId, level: f64, below: &[VertexId], watch: Watch) -> Result<(), Interrupted> {
        if below.is_empty() {
            let lowest = (!self.mesh.is_boundary_vertex(v)).then_some(level);
            self.limbs[v] = Some(Limb { lowest, ..Limb::none() });
            return Ok(());
        }
        if below.len() == 1 {
            self.parent[v] = below[0];
            return Ok(());
        }
        let mut met: Vec<Limb> = below.iter().filter_map(|&root| self.limbs[root].take()).collect();
        for limb in &mut met {
            let is_tip = limb.lowest.is_some_and(|lowest| level - lowest >= PERSISTENT);
            limb.tips = limb.tips.max(usize::from(is_tip));
        }
        while met.iter().map(|limb| limb.tips).sum::<usize>() > self.most_tips
            && self.in_vain < MOST_IN_VAIN
            && let Some(fullest) = met.iter_mut().max_by_key(|limb| limb.tips)
        {
            let limb = std::mem::replace(fullest, Limb::none());
            match self.cut_off(limb, level, watch)? {
                Ok(left) => *fullest = left,
                Err(whole) => {
                    // Higher up it may be possible.
                    *fullest = whole;
                    self.in_vain += 1;
                    break;
                }
            }
        }
        let mut whole = Limb::none();
        for mut limb in met {
            if whole.faces.len() < limb.faces.len() {
                std::mem::swap(&mut whole.faces, &mut limb.faces);
            }
            whole.faces.append(&mut limb.faces);
            whole.lowest = [whole.lowest, limb.lowest].into_iter().flatten().min_by(f64::total_cmp);
            whole.tips += limb.tips;
        }
        let root = below[0];
        below.iter().for_each(|&other| self.parent[other] = root);
        self.parent[v] = root;
        self.limbs[root] = Some(whole);
        Ok(())
    }

    /// Cuts off the tips of a set that ends at a level; what is left of it, or why not: all of it.
    fn cut_off(&mut self, limb: Limb, level: f64, watch: Watch) -> Result<Result<Limb, Limb>, Interrupted> {
        let (mut near, mut far): (Vec<FaceId>, Vec<FaceId>) =
            limb.faces.iter().partition(|&&f| self.height[f] > level - DEEP);
        if near.len() > MOST_NEAR {
            let higher = |f: &FaceId, g: &FaceId| self.height[*g].total_cmp(&self.height[*f]).then(f.cmp(g));
            near.select_nth_unstable_by(MOST_NEAR, higher);
            far.append(&mut near.split_off(MOST_NEAR));
        }
        let piece = self.pieces + 1;
        near.iter().for_each(|&f| self.piece[f] = NEAR);
        far.iter().for_each(|&f| self.piece[f] = piece);
        self.keep_polygons_whole(&far, piece, &mut near);
        let side = |f: FaceId| match self.piece[f] {
            0 => Side::Outer,
            other if other == piece => Side::Inner,
            _ => Side::Neither,
        };
        let is_inner = shortest_separation(self.mesh, self.lengths, &near, side, watch)?;
        near.iter().for_each(|&f| self.piece[f] = 0);
        let Some(is_inner) = is_inner else {
            far.iter().for_each(|&f| self.piece[f] = 0);
            return Ok(Err(limb));
        };
        self.pieces = piece;
        self.cut += limb.tips;
        let mut left = Limb::none();
        for (f, is_inner) in near.into_iter().zip(is_inner) {
            if is_inner { self.piece[f] = piece } else { left.faces.push(f) }
        }
        Ok(Ok(left))
    }

    /// What hangs together with the outside over edges that must not be cut may be on either side.
    fn keep_polygons_whole(&mut self, far: &[FaceId], piece: u32, near: &mut Vec<FaceId>) {
        let mesh = self.mesh;
        let whole = |f: FaceId| {
            let kept = mesh.sides(f).into_iter().filter(|&h| self.lengths[mesh.edge(h)].is_infinite());
            kept.filter_map(|h| mesh.twin(h)).map(|g| mesh.face(g))
        };
        let mut stack: Vec<FaceId> = far.iter().copied().filter(|&f| whole(f).any(|g| self.piece[g] == 0)).collect();
        while let Some(f) = stack.pop() {
            if self.piece[f] == piece {
                self.piece[f] = NEAR;
                near.push(f);
                stack.extend(whole(f));
            }
        }
    }

    /// Gives regions of few triangles to the piece that they have the longest edges with.
    fn without_crumbs(&mut self) {
        let mesh = self.mesh;
        let mut is_seen = FaceData::constant(mesh.face_count(), false);
        for first in mesh.faces() {
            if is_seen[first] {
                continue;
            }
            let own = self.piece[first];
            let mut region = vec![first];
            is_seen[first] = true;
            let mut borders: BTreeMap<u32, f64> = BTreeMap::new();
            let mut at = 0;
            while let Some(&f) = region.get(at) {
                at += 1;
                for h in mesh.sides(f) {
                    let Some(g) = mesh.twin(h).map(|g| mesh.face(g)) else { continue };
                    if self.piece[g] != own {
                        *borders.entry(self.piece[g]).or_default() += self.lengths[mesh.edge(h)];
                    } else if !std::mem::replace(&mut is_seen[g], true) {
                        region.push(g);
                    }
                }
            }
            if region.len() < CRUMB
                && let Some((&other, _)) = borders.iter().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0)))
            {
                region.into_iter().for_each(|f| self.piece[f] = other);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Id, Metric, shapes};

    /// A capsule's φ rises along its axis from both ends as far as is said: two tips.
    fn capsule(height: f64) -> (geom::Mesh, Metric, VertexData<f64>) {
        let shape = shapes::by_name("capsule", 2000).expect("it is built in");
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let along = |v: VertexId| shape.points[v.index()];
        let axis = (0..3).max_by(|&j, &k| {
            let reach = |k: usize| mesh.vertices().map(|v| along(v)[k].abs()).fold(0.0, f64::max);
            reach(j).total_cmp(&reach(k))
        });
        let reach = |v: VertexId| along(v)[axis.expect("there are three")].abs();
        let most = mesh.vertices().map(reach).fold(0.0, f64::max);
        let phi = mesh.vertices().map(|v| -height * reach(v) / most).collect();
        (mesh, metric, phi)
    }

    #[test]
    fn a_limb_is_cut_off_at_its_neck_where_there_are_more_tips_than_asked_for() {
        let (mesh, metric, phi) = capsule(9.0);
        let found = limbs(&mesh, metric.lengths(), &phi, 1, Watch::NONE).unwrap().expect("one tip is too many");
        assert_eq!(found.tips, 2);
        let is_cut = |e: geom::EdgeId| {
            let h = mesh.halfedge(e);
            mesh.twin(h).is_some_and(|g| found.piece[mesh.face(h)] != found.piece[mesh.face(g)])
        };
        let cut: EdgeData<bool> = mesh.edges().map(is_cut).collect();
        let pieces = geom::open_islands(&mesh, &cut);
        assert_eq!(pieces.len(), 2);
        assert!(pieces.iter().all(|piece| piece.mesh.boundary_loops().len() == 1));
        // Round its waist, hardly longer than a circle.
        let around: f64 = mesh.edges().filter(|&e| cut[e]).map(|e| metric.length(e)).sum();
        let waist = metric.area(&mesh).sqrt();
        assert!(around < 1.6 * waist, "{around} {waist}");
        assert!(limbs(&mesh, metric.lengths(), &phi, 2, Watch::NONE).unwrap().is_none(), "two are not too many");
    }

    #[test]
    fn polygons_are_not_cut_through_however_steep_it_is_and_crumbs_are_no_pieces() {
        let mut cut_off = 0;
        for height in (9..300).step_by(3).map(f64::from) {
            let (mesh, metric, phi) = capsule(height);
            // Every triangle and the next free one are a quadrangle.
            let mut is_taken = FaceData::constant(mesh.face_count(), false);
            let mut lengths = metric.lengths().clone();
            for e in mesh.edges() {
                let h = mesh.halfedge(e);
                let Some(g) = mesh.twin(h) else { continue };
                let faces = [h, g].map(|h| mesh.face(h));
                if faces.iter().all(|&f| !is_taken[f]) {
                    faces.iter().for_each(|&f| is_taken[f] = true);
                    lengths[e] = f64::INFINITY;
                }
            }
            // Half of the middle a high plain, from which it falls so steeply that no triangle is near its rim.
            let points = shapes::by_name("capsule", 2000).expect("it is built in").points;
            let cliff = |k: usize| -> VertexData<f64> {
                let is_plain = |v: VertexId| phi[v] > -0.3 * height && points[v.index()][k] > 0.0;
                mesh.vertices().map(|v| if is_plain(v) { 5.0 + 0.01 * phi[v] } else { phi[v] }).collect()
            };
            for phi in [phi.clone(), cliff(0), cliff(1), cliff(2)] {
                let Some(found) = limbs(&mesh, &lengths, &phi, 1, Watch::NONE).unwrap() else { continue };
                cut_off += 1;
                let pieces = |e: geom::EdgeId| {
                    let h = mesh.halfedge(e);
                    [Some(h), mesh.twin(h)].map(|h| h.map(|h| found.piece[mesh.face(h)]))
                };
                let mut through = mesh.edges().filter(|&e| lengths[e].is_infinite());
                assert!(through.all(|e| pieces(e)[0] == pieces(e)[1]), "{height}");
                let cut: EdgeData<bool> = mesh.edges().map(|e| pieces(e)[0] != pieces(e)[1]).collect();
                assert!(geom::open_islands(&mesh, &cut).iter().all(|piece| piece.mesh.face_count() >= CRUMB));
            }
        }
        assert!(cut_off > 9, "{cut_off}");
    }

    #[test]
    fn what_is_hardly_a_tip_is_none_and_what_must_not_be_cut_is_left_whole() {
        let (mesh, metric, phi) = capsule(2.0);
        assert!(limbs(&mesh, metric.lengths(), &phi, 1, Watch::NONE).unwrap().is_none());
        let (mesh, _, phi) = capsule(9.0);
        let uncuttable = EdgeData::constant(mesh.edge_count(), f64::INFINITY);
        assert!(limbs(&mesh, &uncuttable, &phi, 1, Watch::NONE).unwrap().is_none());
    }
}
