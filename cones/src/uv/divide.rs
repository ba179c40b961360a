//! Cuts that part what lies over each other.
//!
//! An island is a disk. A path along its edges from boundary to boundary divides it in two, and parts those overlapping
//! pairs of triangles that have one triangle on each side. With all boundary shrunk to a point, let T be the tree of shortest
//! paths to it. Each edge e = (u, v) that is not in T closes such a path, of length d(u) + l(e) + d(v); and the edges that are
//! not in T are a spanning tree of the triangles (tree and cotree; Eppstein 2003), in which the two sides of that path are what
//! is left when e is taken out. Two facts follow:
//!
//! - the shortest path that parts two triangles f and g is among these (of its edges one closes a path that parts them, and that
//!   one is not longer), so there is no need of a maximum flow for each pair or cluster of pairs;
//! - the pairs that e parts are those whose way in the cotree leads over e, so that one sweep counts for *all* paths at once how
//!   much overlap each resolves, and how much lies on either side of it.
//!
//! So one run of Dijkstra's algorithm serves for all cuts. The path that costs least for what it resolves is taken; what is
//! cut already is free for the next, and the counts are made again, until no pair is left. O(V log V) and O(V + pairs) for
//! each cut.
//!
//! Edges of infinite length (diagonals of polygons) are never cut. An island that is no disk is first cut to one, by the edges
//! that are in neither tree, with their shortest paths.

use geom::{
    EdgeData, EdgeId, FaceData, FaceId, Id, Interrupted, Islands, Mesh, ShortestPaths, VertexData, VertexId, Watch,
    kruskal, open_vertices, other_end,
};
use rayon::prelude::*;

use super::AT_ONCE;

/// What is preferred among cuts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Preference {
    /// An edge between two triangles that overlap something is so many times longer: above 1 cuts run beside overlaps rather
    /// than through them.
    pub(super) within_overlap: f64,
    /// The cost of a cut is its length over this power of what it resolves: the higher, the more each cut is to resolve.
    pub(super) power: f64,
    /// A side with a smaller share of the island's triangles makes a cut [`SMALL_SIDE`] times dearer.
    pub(super) least_share: f64,
}

/// An island of fewer triangles is a sliver.
pub(super) const SLIVER: u32 = 20;
/// A cut that leaves a small side is so many times dearer.
const SMALL_SIDE: f64 = 3.0;
/// A cut that leaves a sliver is so many times dearer.
const SLIVER_SIDE: f64 = 30.0;
/// After so many cuts one at a time, several are made between two counts: a surface unfolded at every vertex needs thousands.
const ONE_AT_A_TIME: usize = 64;

/// Two triangles of one island, and how much it is worth to part them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) triangles: [FaceId; 2],
    pub(super) weight: i64,
}

/// Adds cuts until no pair is on one island; see [`Divider`].
pub(super) fn divide(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    cut: &EdgeData<bool>,
    pairs: &[Pair],
    preference: &Preference,
    watch: Watch,
) -> Result<EdgeData<bool>, Interrupted> {
    let within = preference.within_overlap;
    Divider::new((mesh, lengths), cut, pairs, within, watch.within(0.0, 0.6))?
        .divide(preference, watch.within(0.6, 1.0))
}

/// What cuts by different preferences have in common, as long as an edge within overlaps counts the same.
pub(super) struct Divider<'a> {
    mesh: &'a Mesh,
    pairs: &'a [Pair],
    tree: Tree,
    open: Open,
    cotree: Cotree,
}

impl<'a> Divider<'a> {
    /// An edge between two triangles that overlap something is so many times longer. `lengths` are those of space, infinite where nothing may be
    /// cut.
    pub(super) fn new(
        (mesh, lengths): (&'a Mesh, &EdgeData<f64>),
        cut: &EdgeData<bool>,
        pairs: &'a [Pair],
        within_overlap: f64,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let weights = weights(mesh, lengths, cut, pairs, within_overlap);
        let mut open = Open::new(mesh, cut.clone());
        let (mut tree, distance) = Tree::new(mesh, weights, &open, watch.within(0.0, 0.8))?;
        let (steps, cotree) =
            rayon::join(|| tree.steps(mesh, &distance), || Cotree::new(mesh, (&tree, &distance), &mut open, pairs));
        tree.steps = steps;
        open.distance = distance;
        if open.cut != *cut {
            tree.measure(&mut open);
        }
        watch.ask(1.0)?;
        Ok(Self { mesh, pairs, tree, open, cotree })
    }

    /// Adds cuts until no pair is on one island.
    pub(super) fn divide(&self, preference: &Preference, watch: Watch) -> Result<EdgeData<bool>, Interrupted> {
        let mut open = self.open.clone();
        let mut division = Division::new(&self.cotree, self.pairs);
        let crossing = self.cotree.crossing.par_iter().with_min_len(AT_ONCE);
        let closing: Vec<Closing> = crossing.map(|&e| self.tree.closing(self.mesh, e)).collect();
        let mut cuts = 0_usize;
        while division.has_pairs() {
            watch.ask(1.0 - division.left() as f64 / self.pairs.len() as f64)?;
            let wanted = if cuts < ONE_AT_A_TIME { 1 } else { cuts / 8 };
            let chosen = division.best(|i| closing[i].length(&open.distance), preference, wanted);
            if chosen.is_empty() {
                break;
            }
            cuts += chosen.len();
            for i in chosen {
                self.tree.cut(self.mesh, &mut open, self.cotree.crossing[i]);
                division.part(i);
            }
            rayon::join(|| division.count(), || self.tree.measure(&mut open));
        }
        Ok(open.cut)
    }
}

/// What cutting an edge costs: its length, on islands that have pairs; elsewhere nothing is cut.
fn weights(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    cut: &EdgeData<bool>,
    pairs: &[Pair],
    within_overlap: f64,
) -> EdgeData<f64> {
    let islands = Islands::new(mesh, cut);
    let mut has_pairs = vec![false; islands.count()];
    let mut overlaps = FaceData::constant(mesh.face_count(), false);
    for f in pairs.iter().flat_map(|pair| pair.triangles) {
        overlaps[f] = true;
        has_pairs[islands.of(f) as usize] = true;
    }
    let finite = lengths.iter().filter(|l| l.is_finite());
    let mean = finite.clone().sum::<f64>() / finite.count().max(1) as f64;
    let weight = |e: EdgeId| {
        let h = mesh.halfedge(e);
        let f = mesh.face(h);
        if !has_pairs[islands.of(f) as usize] {
            return f64::INFINITY;
        }
        // Paths must get longer edge by edge, also along edges without length.
        let length = lengths[e].max(1e-9 * mean);
        let is_within = overlaps[f] && mesh.twin(h).is_some_and(|g| overlaps[mesh.face(g)]);
        if is_within { length * within_overlap } else { length }
    };
    let edges = (0..mesh.edge_count()).into_par_iter().with_min_len(AT_ONCE);
    edges.map(|e| weight(EdgeId::new(e))).collect::<Vec<_>>().into()
}

/// What is open, as cuts are added.
#[derive(Clone)]
struct Open {
    cut: EdgeData<bool>,
    is_open: VertexData<bool>,
    /// The length of the path to what is open.
    distance: VertexData<f64>,
}

impl Open {
    fn new(mesh: &Mesh, cut: EdgeData<bool>) -> Self {
        let mut is_open = open_vertices(mesh, &cut);
        if let (false, Some(first)) = (is_open.iter().any(|&open| open), mesh.vertices().next()) {
            is_open[first] = true; // a closed surface: any point will do
        }
        Self { cut, is_open, distance: VertexData::constant(0, 0.0) }
    }
}

/// The tree of shortest paths to what was open at first.
struct Tree {
    weights: EdgeData<f64>,
    predecessor: VertexData<Option<EdgeId>>,
    /// How the vertices are reached, nearer ones first.
    steps: Vec<Step>,
}

/// The last edge of a shortest path.
#[derive(Clone, Copy)]
struct Step {
    to: VertexId,
    from: VertexId,
    weight: f64,
}

/// What the length of a path comes from that an edge closes.
struct Closing {
    ends: [VertexId; 2],
    weight: f64,
}

impl Closing {
    fn length(&self, distance: &VertexData<f64>) -> f64 {
        let [u, v] = self.ends.map(|v| distance[v]);
        u + self.weight + v
    }
}

impl Tree {
    /// Without steps, and with the distances.
    fn new(
        mesh: &Mesh,
        weights: EdgeData<f64>,
        open: &Open,
        watch: Watch,
    ) -> Result<(Self, VertexData<f64>), Interrupted> {
        let sources = mesh.vertices().filter(|&v| open.is_open[v]).map(|v| (v, 0));
        let ShortestPaths { distance, predecessor, .. } = ShortestPaths::new_watched(mesh, &weights, sources, watch)?;
        Ok((Self { weights, predecessor, steps: Vec::new() }, distance))
    }

    /// How the vertices are reached, nearer ones first.
    fn steps(&self, mesh: &Mesh, distance: &VertexData<f64>) -> Vec<Step> {
        let last = |v: VertexId| {
            let e = self.predecessor[v]?;
            Some(Step { to: v, from: other_end(mesh, e, v), weight: self.weights[e] })
        };
        let mut steps: Vec<Step> = mesh.vertices().filter_map(last).collect();
        steps.par_sort_unstable_by(|a, b| distance[a.to].total_cmp(&distance[b.to]).then(a.to.cmp(&b.to)));
        steps
    }

    /// Finds the lengths anew after cuts.
    fn measure(&self, open: &mut Open) {
        for &Step { to, from, weight } in &self.steps {
            open.distance[to] = if open.is_open[to] { 0.0 } else { open.distance[from] + weight };
        }
    }

    /// An edge that closes a path.
    fn closing(&self, mesh: &Mesh, e: EdgeId) -> Closing {
        Closing { ends: mesh.ends(e), weight: self.weights[e] }
    }

    /// Cuts along the path that an edge closes.
    fn cut(&self, mesh: &Mesh, open: &mut Open, e: EdgeId) {
        open.cut[e] = true;
        for mut v in mesh.ends(e) {
            while !std::mem::replace(&mut open.is_open[v], true) {
                let Some(e) = self.predecessor[v] else { break };
                open.cut[e] = true;
                v = other_end(mesh, e, v);
            }
        }
    }
}

/// A spanning tree of the triangles of each island with pairs, over edges that are not in the tree of shortest paths. Triangles
/// are numbered such that each comes after the one that it hangs from.
struct Cotree {
    /// The number of each triangle; `NONE` on islands without pairs.
    number: FaceData<u32>,
    /// What each hangs from; roots from themselves.
    parent: Vec<u32>,
    /// The edge to what it hangs from; any at roots.
    crossing: Vec<EdgeId>,
    depth: Vec<u32>,
    /// A further one on the way to the root (E. W. Myers, *An applicative random-access stack*, 1983).
    jump: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Cotree {
    /// Cuts islands that are no disks, too.
    fn new(mesh: &Mesh, (tree, distance): (&Tree, &VertexData<f64>), open: &mut Open, pairs: &[Pair]) -> Self {
        let mut is_tree: EdgeData<bool> = EdgeData::constant(mesh.edge_count(), false);
        for &e in tree.predecessor.iter().flatten() {
            is_tree[e] = true;
        }
        let is_between = |open: &Open, e: EdgeId| !is_tree[e] && !open.cut[e] && mesh.twin(mesh.halfedge(e)).is_some();
        let cotree = Self::spanning(mesh, pairs, |e| is_between(open, e));
        let spare = mesh.edges().any(|e| {
            let f = mesh.face(mesh.halfedge(e));
            is_between(open, e) && cotree.number[f] != NONE && !cotree.crosses(mesh, e)
        });
        if !spare {
            return cotree;
        }
        // The edges that close the longest paths are kept, the others cut.
        let mut edges: Vec<EdgeId> = mesh.edges().filter(|&e| is_between(open, e)).collect();
        let length = |e: EdgeId| tree.closing(mesh, e).length(distance);
        edges.sort_by(|a, b| length(*b).total_cmp(&length(*a)));
        let faces = |e: EdgeId| {
            let h = mesh.halfedge(e);
            [mesh.face(h).0, mesh.twin(h).map_or(mesh.face(h).0, |g| mesh.face(g).0)]
        };
        let mut is_kept = EdgeData::constant(mesh.edge_count(), false);
        for e in kruskal(mesh.face_count(), edges.iter().map(|&e| (e, faces(e)))) {
            is_kept[e] = true;
        }
        for &e in &edges {
            if !is_kept[e] && length(e).is_finite() && cotree.number[mesh.face(mesh.halfedge(e))] != NONE {
                tree.cut(mesh, open, e);
            }
        }
        Self::spanning(mesh, pairs, |e| is_kept[e])
    }

    /// By breadth, from the first triangle of each pair.
    fn spanning(mesh: &Mesh, pairs: &[Pair], may_cross: impl Fn(EdgeId) -> bool) -> Self {
        let mut number = FaceData::constant(mesh.face_count(), NONE);
        let mut cotree =
            Self { number: FaceData::constant(0, NONE), parent: vec![], crossing: vec![], depth: vec![], jump: vec![] };
        let mut faces: Vec<FaceId> = Vec::new();
        for root in pairs.iter().map(|pair| pair.triangles[0]) {
            if number[root] != NONE {
                continue;
            }
            number[root] = faces.len() as u32;
            let mut at = faces.len();
            faces.push(root);
            cotree.hang(None);
            while at < faces.len() {
                for h in mesh.sides(faces[at]) {
                    let Some(g) = mesh.twin(h).filter(|_| may_cross(mesh.edge(h))).map(|g| mesh.face(g)) else {
                        continue;
                    };
                    if number[g] == NONE {
                        number[g] = faces.len() as u32;
                        faces.push(g);
                        cotree.hang(Some((at as u32, mesh.edge(h))));
                    }
                }
                at += 1;
            }
        }
        cotree.number = number;
        cotree
    }

    /// Adds a triangle.
    fn hang(&mut self, from: Option<(u32, EdgeId)>) {
        let new = self.parent.len() as u32;
        let (parent, crossing) = from.unwrap_or((new, EdgeId(0)));
        self.parent.push(parent);
        self.crossing.push(crossing);
        if from.is_none() {
            self.depth.push(0);
            self.jump.push(new);
            return;
        }
        let depth = |i: u32| self.depth[i as usize];
        let [far, farther] = [self.jump[parent as usize], self.jump[self.jump[parent as usize] as usize]];
        let is_even = depth(parent) - depth(far) == depth(far) - depth(farther);
        let (depth, jump) = (depth(parent) + 1, if is_even { farther } else { parent });
        self.depth.push(depth);
        self.jump.push(jump);
    }

    fn crosses(&self, mesh: &Mesh, e: EdgeId) -> bool {
        let h = mesh.halfedge(e);
        let sides = [Some(h), mesh.twin(h)].into_iter().flatten().map(|h| self.number[mesh.face(h)]);
        sides.filter(|&i| i != NONE).any(|i| self.parent[i as usize] != i && self.crossing[i as usize] == e)
    }

    /// Where the ways of two triangles to the root meet; none if they are in different trees. O(log n).
    fn meeting(&self, mut a: u32, mut b: u32) -> Option<u32> {
        let [parent, jump] = [&self.parent, &self.jump].map(|next| |i: u32| next[i as usize]);
        let depth = |i: u32| self.depth[i as usize];
        if depth(a) < depth(b) {
            (a, b) = (b, a);
        }
        while depth(a) > depth(b) {
            a = if depth(jump(a)) >= depth(b) { jump(a) } else { parent(a) };
        }
        while a != b {
            if parent(a) == a {
                return None;
            }
            (a, b) = if jump(a) != jump(b) { (jump(a), jump(b)) } else { (parent(a), parent(b)) };
        }
        Some(a)
    }
}

/// A pair as numbers of the cotree.
#[derive(Clone, Copy)]
struct Way {
    ends: [u32; 2],
    meeting: u32,
    weight: i64,
}

/// The pieces that a cotree falls into, and what further cuts would resolve.
struct Division<'a> {
    cotree: &'a Cotree,
    ways: Vec<Way>,
    is_parted: Vec<bool>,
    /// The root of the piece that each triangle is in.
    piece: Vec<u32>,
    /// How many triangles hang from each in its piece, itself included.
    size: Vec<u32>,
    /// What parting each from what it hangs from would resolve.
    resolved: Vec<i64>,
}

impl<'a> Division<'a> {
    fn new(cotree: &'a Cotree, pairs: &[Pair]) -> Self {
        let ways = pairs.iter().filter_map(|pair| {
            let ends = pair.triangles.map(|f| cotree.number[f]);
            let meeting = (ends[0] != NONE && ends[1] != NONE).then(|| cotree.meeting(ends[0], ends[1]))??;
            Some(Way { ends, meeting, weight: pair.weight })
        });
        let count = cotree.parent.len();
        let mut division = Self {
            cotree,
            ways: ways.collect(),
            is_parted: vec![false; count],
            piece: vec![0; count],
            size: vec![0; count],
            resolved: vec![0; count],
        };
        division.count();
        division
    }

    fn has_pairs(&self) -> bool {
        !self.ways.is_empty()
    }

    fn left(&self) -> usize {
        self.ways.len()
    }

    fn part(&mut self, i: usize) {
        self.is_parted[i] = true;
    }

    /// Counts anew after cuts.
    fn count(&mut self) {
        let parent = &self.cotree.parent;
        for (i, &from) in parent.iter().enumerate() {
            let is_root = self.is_parted[i] || from as usize == i;
            self.piece[i] = if is_root { i as u32 } else { self.piece[from as usize] };
        }
        let piece = &self.piece;
        self.ways.retain(|way| piece[way.ends[0] as usize] == piece[way.ends[1] as usize]);
        self.resolved.fill(0);
        for way in &self.ways {
            way.ends.iter().for_each(|&end| self.resolved[end as usize] += way.weight);
            self.resolved[way.meeting as usize] -= 2 * way.weight;
        }
        self.size.fill(1);
        for i in (0..parent.len()).rev() {
            if piece[i] as usize != i {
                self.size[parent[i] as usize] += self.size[i];
                self.resolved[parent[i] as usize] += self.resolved[i];
            }
        }
    }

    /// The cheapest cuts, at most so many; further ones only if they cost little more than the best.
    fn best(&self, length: impl Fn(usize) -> f64 + Sync, preference: &Preference, wanted: usize) -> Vec<usize> {
        let all = (0..self.piece.len()).into_par_iter().with_min_len(AT_ONCE);
        let candidates = all.filter(|&i| self.piece[i] as usize != i && self.resolved[i] > 0);
        let with_cost = |i: usize| {
            let cost = self.cost(i, length(i), preference);
            cost.is_finite().then_some((cost, i))
        };
        let is_less = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if wanted == 1 {
            return candidates.filter_map(with_cost).min_by(is_less).map(|(_, i)| i).into_iter().collect();
        }
        let mut all: Vec<(f64, usize)> = candidates.filter_map(with_cost).collect();
        all.sort_unstable_by(is_less);
        let worst = all.first().map_or(0.0, |(least, _)| 2.0 * least);
        all.into_iter().take(wanted).take_while(|(cost, _)| *cost <= worst).map(|(_, i)| i).collect()
    }

    fn cost(&self, i: usize, length: f64, preference: &Preference) -> f64 {
        let whole = self.size[self.piece[i] as usize];
        let side = self.size[i].min(whole - self.size[i]);
        let smallness = if side < SLIVER {
            SLIVER_SIDE
        } else if f64::from(side) < preference.least_share * f64::from(whole) {
            SMALL_SIDE
        } else {
            1.0
        };
        let resolved = self.resolved[i] as f64;
        smallness * length / if preference.power == 1.0 { resolved } else { resolved.powf(preference.power) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Metric, shapes};

    #[test]
    fn each_cut_is_the_best_with_all_before_it_free() {
        // A torus is first cut to a disk.
        for shape in [shapes::disk(600), shapes::torus(1, 600)] {
            let mesh = shape.mesh();
            let metric = Metric::from_points(&mesh, &shape.points);
            let triangle = |k: usize| FaceId::new(k % mesh.face_count());
            let pair = |k: usize| Pair { triangles: [triangle(7919 * k), triangle(104_729 * k)], weight: 1 + k as i64 };
            let pairs: Vec<Pair> = (1..40).map(pair).filter(|pair| pair.triangles[0] != pair.triangles[1]).collect();
            let preference = Preference { within_overlap: 3.0, power: 1.0, least_share: 0.03 };
            let cut = EdgeData::constant(mesh.edge_count(), false);
            let divider = Divider::new((&mesh, metric.lengths()), &cut, &pairs, 3.0, Watch::NONE).unwrap();
            assert!(mesh.vertices().all(|v| !divider.open.is_open[v] || divider.open.distance[v] == 0.0));
            let mut open = divider.open.clone();
            let mut division = Division::new(&divider.cotree, &pairs);
            let mut cuts = 0;
            while division.has_pairs() {
                divider.tree.measure(&mut open);
                let length = |i: usize| divider.tree.closing(&mesh, divider.cotree.crossing[i]).length(&open.distance);
                let [i] = division.best(length, &preference, 1)[..] else { panic!("there is one best cut") };
                divider.tree.cut(&mesh, &mut open, divider.cotree.crossing[i]);
                division.part(i);
                division.count();
                cuts += 1;
            }
            assert!((4..ONE_AT_A_TIME).contains(&cuts), "{cuts} cuts");
            assert_eq!(divider.divide(&preference, Watch::NONE).unwrap(), open.cut);
        }
    }
}
