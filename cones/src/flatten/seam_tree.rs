//! Spanning trees whose seams pass through cones of more than a full turn rather than end there.
//!
//! Where a single seam ends in a cone about which the triangles take more than 2π the layout lies over itself, wherever that seam comes
//! from: it has to be cut on from there. So among the trees of the terminals' distances one is sought that is short with these
//! cuts counted in: a cone costs the shortest further path from it that leaves no angle above 2π, as long as it needs one. From the
//! shortest tree on one path is put in another's place as long as that gains something, the most first.
//!
//! On six layouts that ended with 20 to 31 % of seam added (face and beetle) such trees are 1.7 to 15 % longer than the shortest ones, whose
//! cones ask for 19 to 42 % more.

use std::collections::{BTreeMap, HashMap};
use std::f64::consts::TAU;

use geom::{EdgeId, HalfedgeData, Mesh, ShortestPaths, VertexData, VertexId, other_end};

/// A cone has more than a full turn if it has so many times that.
const MORE: f64 = 1.0 + 1e-9;
/// So many paths are replaced for each terminal at most.
const MOST_REPLACED: usize = 4;
/// What replacing a path must gain, as a share of the tree.
const LEAST_GAIN: f64 = 1e-9;

/// A path between two terminals.
#[derive(Clone, Copy, Debug)]
struct Path {
    ends: [u32; 2],
    /// The angle in the plane at which it leaves either end, if that has more than a full turn.
    direction: [f64; 2],
    length: f64,
}

/// A tree like `tree`, whose edges go from one terminal's region to another's, that ends in as few cones of more than 2π as pays.
/// `bridges` are all such edges, those of shorter ways first, `angle` that in the plane of the corner at each halfedge's tail.
/// O(V), and O(P² T) at most for P paths between T terminals.
pub(super) fn through_cones(
    mesh: &Mesh,
    shortest: &ShortestPaths,
    bridges: &[(f64, EdgeId)],
    tree: &[EdgeId],
    angle: &HalfedgeData<f64>,
) -> Vec<EdgeId> {
    let owner = |v: VertexId| shortest.owner[v].unwrap_or(0);
    let count = mesh.vertices().map(owner).max().map_or(0, |last| last as usize + 1);
    let mut turn = vec![None; count];
    let mut direction: HashMap<(u32, EdgeId), f64> = HashMap::new();
    for v in mesh.vertices().filter(|&v| shortest.distance[v] == 0.0 && !mesh.is_boundary_vertex(v)) {
        let (around, sum) = directions(mesh, v, angle);
        if sum > MORE * TAU {
            turn[owner(v) as usize] = Some(sum);
            direction.extend(around.into_iter().map(|(e, at)| ((owner(v), e), at)));
        }
    }
    if direction.is_empty() {
        return tree.to_vec();
    }
    let first = first_edges(mesh, shortest);
    // Of the ways between two terminals that leave in the same directions only the shortest is of use.
    let mut known: BTreeMap<[(u32, Option<EdgeId>); 2], usize> = BTreeMap::new();
    let mut edges: Vec<EdgeId> = Vec::new();
    let mut paths: Vec<Path> = Vec::new();
    let mut number: HashMap<EdgeId, usize> = HashMap::new();
    for &(length, e) in bridges {
        let leaves = mesh.ends(e).map(|v| (owner(v), turn[owner(v) as usize].map(|_| first[v].unwrap_or(e))));
        let [a, b] = leaves;
        let path = *known.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            let at = |(end, first): (u32, Option<EdgeId>)| first.and_then(|e| direction.get(&(end, e)));
            let direction = leaves.map(|leaf| at(leaf).copied().unwrap_or(0.0));
            edges.push(e);
            paths.push(Path { ends: [a.0, b.0], direction, length });
            paths.len() - 1
        });
        number.insert(e, path);
    }
    let tree = tree.iter().map(|e| number[e]).collect();
    let mut tree = Tree::new(&paths, &turn, tree);
    tree.improve();
    tree.seams().map(|i| edges[i]).collect()
}

/// The edges round a vertex within the surface, each with the angle from the first, and the whole angle.
fn directions(mesh: &Mesh, v: VertexId, angle: &HalfedgeData<f64>) -> (Vec<(EdgeId, f64)>, f64) {
    let (mut around, mut sum) = (Vec::new(), 0.0);
    let Some(first) = mesh.outgoing(v).next() else { return (around, sum) };
    let mut h = first;
    loop {
        around.push((mesh.edge(h), sum));
        sum += angle[h];
        match mesh.twin(mesh.prev(h)).filter(|&next| next != first) {
            Some(next) => h = next,
            None => return (around, sum),
        }
    }
}

/// The first edge of the way from its terminal to each vertex; none at terminals. O(V).
fn first_edges(mesh: &Mesh, shortest: &ShortestPaths) -> VertexData<Option<EdgeId>> {
    let mut first = VertexData::constant(mesh.vertex_count(), None);
    let mut way = Vec::new();
    for v in mesh.vertices() {
        let mut at = v;
        let mut found = first[at];
        while let (None, Some(e)) = (found, shortest.predecessor[at]) {
            way.push(at);
            at = other_end(mesh, e, at);
            found = if shortest.predecessor[at].is_none() { Some(e) } else { first[at] };
        }
        way.drain(..).for_each(|v| first[v] = found);
    }
    first
}

/// A spanning tree of the terminals.
struct Tree<'a> {
    paths: &'a [Path],
    /// The whole angle of each terminal that has more than 2π.
    turn: &'a [Option<f64>],
    is_in: Vec<bool>,
    /// The paths at each terminal.
    at: Vec<Vec<usize>>,
}

/// Where a terminal hangs in the tree.
#[derive(Clone, Copy)]
struct Hung {
    /// From which terminal, by which path; none at the root.
    from: Option<(u32, usize)>,
    depth: u32,
}

impl<'a> Tree<'a> {
    fn new(paths: &'a [Path], turn: &'a [Option<f64>], tree: Vec<usize>) -> Self {
        let mut is_in = vec![false; paths.len()];
        tree.into_iter().for_each(|i| is_in[i] = true);
        let mut at = vec![Vec::new(); turn.len()];
        for (i, path) in paths.iter().enumerate() {
            path.ends.iter().for_each(|&end| at[end as usize].push(i));
        }
        Self { paths, turn, is_in, at }
    }

    /// The paths that are in it.
    fn seams(&self) -> impl Iterator<Item = usize> {
        (0..self.paths.len()).filter(|&i| self.is_in[i])
    }

    fn improve(&mut self) {
        for _ in 0..MOST_REPLACED * self.turn.len() {
            let Some([added, taken]) = self.best() else { return };
            self.is_in[added] = true;
            self.is_in[taken] = false;
        }
    }

    /// The path that is best added, and the one in its circle that is then taken out.
    fn best(&self) -> Option<[usize; 2]> {
        let costs: Vec<f64> = (0..self.turn.len() as u32).map(|t| self.cost(t, None)).collect();
        let hung = self.hung();
        let mut best = None;
        let mut most = -LEAST_GAIN * self.seams().map(|i| self.paths[i].length).sum::<f64>();
        for added in (0..self.paths.len()).filter(|&i| !self.is_in[i]) {
            let path = &self.paths[added];
            let spared: f64 = path.ends.iter().map(|&end| costs[end as usize]).sum();
            for taken in self.between(path.ends, &hung) {
                let longer = path.length - self.paths[taken].length;
                if longer - spared >= most {
                    continue;
                }
                let [a, b] = path.ends;
                let others = self.paths[taken].ends.into_iter().filter(|&t| t != a && t != b);
                let dearer = |t: u32| self.cost(t, Some([added, taken])) - costs[t as usize];
                let change = longer + [a, b].into_iter().chain(others).map(dearer).sum::<f64>();
                if change < most {
                    most = change;
                    best = Some([added, taken]);
                }
            }
        }
        best
    }

    /// The tree, hung from the first terminal.
    fn hung(&self) -> Vec<Option<Hung>> {
        let mut hung: Vec<Option<Hung>> = vec![None; self.turn.len()];
        let mut stack = vec![(0_u32, Hung { from: None, depth: 0 })];
        while let Some((t, place)) = stack.pop() {
            if hung[t as usize].is_some() {
                continue;
            }
            hung[t as usize] = Some(place);
            for &i in self.at[t as usize].iter().filter(|&&i| self.is_in[i]) {
                let [a, b] = self.paths[i].ends;
                stack.push((if a == t { b } else { a }, Hung { from: Some((t, i)), depth: place.depth + 1 }));
            }
        }
        hung
    }

    /// The paths on the way from one terminal to another.
    fn between(&self, [mut a, mut b]: [u32; 2], hung: &[Option<Hung>]) -> Vec<usize> {
        let mut way = Vec::new();
        let depth = |t: u32| hung[t as usize].map_or(0, |place| place.depth);
        while a != b {
            if depth(a) < depth(b) {
                (a, b) = (b, a);
            }
            let Some((from, path)) = hung[a as usize].and_then(|place| place.from) else { return Vec::new() };
            way.push(path);
            a = from;
        }
        way
    }

    /// The length of the shortest further path that a terminal needs, if one were added to the tree and one taken out. Where no single path is
    /// enough, twice that of the longest.
    fn cost(&self, t: u32, change: Option<[usize; 2]>) -> f64 {
        let Some(turn) = self.turn[t as usize] else { return 0.0 };
        let is_in = |i: usize| change.map_or(self.is_in[i], |[add, take]| i == add || self.is_in[i] && i != take);
        let direction = |i: usize| self.paths[i].direction[usize::from(self.paths[i].ends[0] != t)];
        let paths = &self.at[t as usize];
        let seams: Vec<f64> = paths.iter().filter(|&&i| is_in(i)).map(|&i| direction(i)).collect();
        if is_parted(&seams, None, turn) {
            return 0.0;
        }
        let length = |i: &usize| self.paths[*i].length;
        let parting = paths.iter().filter(|&&i| is_parted(&seams, Some(direction(i)), turn));
        let shortest = parting.map(length).min_by(f64::total_cmp);
        shortest.unwrap_or_else(|| 2.0 * paths.iter().map(length).fold(0.0, f64::max))
    }
}

/// Whether seams in these directions, and another, leave no angle above 2π of a whole turn.
fn is_parted(seams: &[f64], other: Option<f64>, turn: f64) -> bool {
    let all = || seams.iter().copied().chain(other);
    let after = |from: f64| all().map(|to| if to > from { to - from } else { to - from + turn }).fold(turn, f64::min);
    all().next().is_some() && all().all(|from| after(from) <= TAU)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::flatten::flattened::Flattened;
    use crate::flatten::{Seams, Variation};
    use geom::{Watch, edges_at, shapes};

    #[test]
    fn a_longer_way_through_a_cone_is_taken_in_place_of_one_past_it() {
        let path = |ends, direction, length| Path { ends, direction, length };
        let turn = [None, Some(2.5 * PI), None];
        let ways =
            |to: f64| [path([0, 1], [0.0, 0.0], 1.0), path([0, 2], [0.0, 0.0], 1.2), path([1, 2], [to, 0.0], 1.5)];
        let improved = |paths: &[Path]| {
            let mut tree = Tree::new(paths, &turn, vec![0, 1]);
            tree.improve();
            tree.seams().collect::<Vec<_>>()
        };
        assert_eq!(improved(&ways(1.2 * PI)), [0, 2]);
        assert_eq!(improved(&ways(0.2 * PI)), [0, 1], "an angle of 2.3π would be left");
    }

    #[test]
    fn seams_that_pass_through_cones_leave_a_disk_and_fewer_ends() {
        let mut ends = [0, 0];
        for (shape, step) in [(shapes::hare(900), 70), (shapes::terrain(900, 2), 90), (shapes::torus(2, 800), 60)] {
            let cones: Vec<VertexId> = (0..9).map(|k| VertexId(7 + k * step)).collect();
            let Flattened { mesh, metric, .. } = Flattened::new(&shape, &cones);
            let angle = mesh.halfedges().map(|h| 3.0 * PI / mesh.face_degree(mesh.tail(h)) as f64).collect();
            for (angle, ends) in [None, Some(&angle)].into_iter().zip(&mut ends) {
                let variation = Variation { strength: 0.0, number: 0, angle };
                let seams = Seams::varied(&mesh, metric.lengths(), &cones, variation, Watch::NONE).unwrap();
                assert!(geom::CutMesh::open(&mesh, &seams.cut).is_disk());
                let is_end = |v: &&VertexId| edges_at(&mesh, **v).filter(|&(e, _)| seams.cut[e]).count() == 1;
                *ends += cones.iter().filter(is_end).count();
            }
        }
        assert!(ends[1] < ends[0], "{ends:?}");
    }
}
