//! The shortest edges between two sets of triangles.
//!
//! A minimum cut of the dual graph, by a maximum flow (Dinic 1970, "Algorithm for solution of a problem of maximum flow in networks with power
//! estimation"): triangles are nodes, edges of the mesh let as much through as they are long.

use std::collections::HashMap;

use crate::mesh::{EdgeData, FaceId, Mesh};
use crate::watch::{Interrupted, Watch};

/// Where a triangle is that is to be kept from others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// It stays on the inner side.
    Inner,
    /// It stays on the outer side.
    Outer,
    /// It matters not: edges to it cost nothing.
    Neither,
}

/// Lengths are counted in so many parts of the longest edge, so that flows are exact.
const PARTS: f64 = 1e6;
/// More than all edges of a mesh are long.
const UNCUTTABLE: u64 = 1 << 52;

/// On which side of the shortest separation each of some triangles is: true for the inner one. `between` are the triangles that may be on either
/// side, each named once; `side` tells where all others are. Of their edges those of infinite length are not cut. None where that keeps the two sides
/// together, or nothing keeps them apart. O(E) for each of the flow's phases, of which there are few.
///
/// ```
/// use geom::{Id, Metric, Side, Watch, shortest_separation};
///
/// let capsule = geom::shapes::by_name("capsule", 900).expect("it is built in");
/// let mesh = capsule.mesh();
/// let metric = Metric::from_points(&mesh, &capsule.points);
/// let height = |f| mesh.corners(f).iter().map(|v| capsule.points[v.index()][2]).sum::<f64>() / 3.0;
/// let side = |f| if height(f) < 0.0 { Side::Inner } else { Side::Outer };
/// let between: Vec<_> = mesh.faces().filter(|&f| height(f).abs() < 0.2).collect();
/// let inner = shortest_separation(&mesh, metric.lengths(), &between, side, Watch::NONE)?;
/// assert_eq!(inner.expect("they are apart").len(), between.len());
/// # Ok::<(), geom::Interrupted>(())
/// ```
///
/// # Errors
/// If it is stopped.
pub fn shortest_separation(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    between: &[FaceId],
    side: impl Fn(FaceId) -> Side,
    watch: Watch,
) -> Result<Option<Vec<bool>>, Interrupted> {
    let node: HashMap<FaceId, usize> = between.iter().copied().zip(0..).collect();
    let (inner, outer) = (between.len(), between.len() + 1);
    let edges = || between.iter().flat_map(|&f| mesh.sides(f)).map(|h| lengths[mesh.edge(h)]);
    let longest = edges().filter(|l| l.is_finite()).fold(f64::MIN_POSITIVE, f64::max);
    let mut network = Network::new(between.len() + 2);
    for (&f, from) in between.iter().zip(0..) {
        for h in mesh.sides(f) {
            let Some(g) = mesh.twin(h).map(|g| mesh.face(g)) else { continue };
            let length = lengths[mesh.edge(h)] / longest;
            let room = if length.is_finite() { (PARTS * length).ceil() as u64 } else { UNCUTTABLE };
            match (node.get(&g), side(g)) {
                (Some(&to), _) if to > from => network.connect(from, to, room),
                (Some(_), _) | (None, Side::Neither) => {}
                (None, Side::Inner) => network.connect(inner, from, room),
                (None, Side::Outer) => network.connect(from, outer, room),
            }
        }
    }
    let flow = network.fill(inner, outer, watch)?;
    if flow == 0 || flow >= UNCUTTABLE {
        return Ok(None);
    }
    // What more could still flow to.
    Ok(Some(network.level[..between.len()].iter().map(|level| level.is_some()).collect()))
}

/// A network of pipes, which let as much through in one direction as in the other.
struct Network {
    /// The pipes at each node: where they lead, and their number.
    pipes: Vec<Vec<(usize, usize)>>,
    /// What more each pipe lets through, to its second end and back.
    room: Vec<[u64; 2]>,
    ends: Vec<[usize; 2]>,
    /// How far each node is from the source, where anything more can flow to it.
    level: Vec<Option<u32>>,
}

impl Network {
    fn new(nodes: usize) -> Self {
        Self { pipes: vec![Vec::new(); nodes], room: Vec::new(), ends: Vec::new(), level: vec![None; nodes] }
    }

    fn connect(&mut self, a: usize, b: usize, room: u64) {
        self.pipes[a].push((b, self.room.len()));
        self.pipes[b].push((a, self.room.len()));
        self.room.push([room; 2]);
        self.ends.push([a, b]);
    }

    /// The direction in which a pipe leads away from a node.
    fn direction(&self, from: usize, pipe: usize) -> usize {
        usize::from(self.ends[pipe][0] != from)
    }

    /// Lets as much flow as can; how much that is.
    fn fill(&mut self, source: usize, sink: usize, watch: Watch) -> Result<u64, Interrupted> {
        let mut flow = 0;
        loop {
            watch.ask(0.5)?;
            self.measure(source);
            if self.level[sink].is_none() || flow >= UNCUTTABLE {
                return Ok(flow);
            }
            let mut next = vec![0; self.pipes.len()];
            while flow < UNCUTTABLE
                && let Some(more) = self.way(source, sink, &mut next)
            {
                flow += more;
            }
        }
    }

    /// How far each node is from the source along pipes that have room.
    fn measure(&mut self, source: usize) {
        self.level.fill(None);
        self.level[source] = Some(0);
        let mut queue = vec![source];
        let mut at = 0;
        while let Some(&from) = queue.get(at) {
            at += 1;
            let beyond = self.level[from].map(|level| level + 1);
            for &(to, pipe) in &self.pipes[from] {
                if self.level[to].is_none() && self.room[pipe][self.direction(from, pipe)] > 0 {
                    self.level[to] = beyond;
                    queue.push(to);
                }
            }
        }
    }

    /// One more way of the present length, filled; how much flows there. Pipes before `next` are known to be of no use.
    fn way(&mut self, source: usize, sink: usize, next: &mut [usize]) -> Option<u64> {
        let mut way: Vec<(usize, usize)> = Vec::new();
        let mut at = source;
        while at != sink {
            match self.pipes[at].get(next[at]) {
                Some(&(to, pipe)) => {
                    let direction = self.direction(at, pipe);
                    if self.room[pipe][direction] > 0 && self.level[to] == self.level[at].map(|level| level + 1) {
                        way.push((pipe, direction));
                        at = to;
                    } else {
                        next[at] += 1;
                    }
                }
                None => {
                    let (pipe, direction) = way.pop()?;
                    at = self.ends[pipe][direction];
                    next[at] += 1;
                }
            }
        }
        let least = way.iter().map(|&(pipe, direction)| self.room[pipe][direction]).min()?;
        for (pipe, direction) in way {
            self.room[pipe][direction] -= least;
            self.room[pipe][1 - direction] += least;
        }
        Some(least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Id;
    use crate::shapes;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn no_other_separation_is_shorter(
            weights in prop::collection::vec(1u32..9, 120), first in 0usize..80, inner in 0usize..80, few in 2usize..10,
        ) {
            let mesh = shapes::sphere(42).mesh();
            let lengths: EdgeData<f64> = mesh.edges().map(|e| f64::from(weights[e.index() % weights.len()])).collect();
            let faces: Vec<FaceId> = mesh.faces().collect();
            let between: Vec<FaceId> = faces.iter().cycle().skip(first).take(few).copied().collect();
            let side = |f: FaceId| match f.index() {
                i if i == inner % faces.len() => Side::Inner,
                i if i % 7 == 3 => Side::Neither,
                _ => Side::Outer,
            };
            // Edges between sides that are both given cost the same whatever is chosen.
            let cost = |is_inner: &[bool]| {
                let place = |f: FaceId| match between.iter().position(|&g| g == f) {
                    Some(k) => if is_inner[k] { Side::Inner } else { Side::Outer },
                    None => side(f),
                };
                let is_cut = |e| {
                    let h = mesh.halfedge(e);
                    let sides = [Some(h), mesh.twin(h)].map(|h| h.map(|h| place(mesh.face(h))));
                    sides.contains(&Some(Side::Inner)) && sides.contains(&Some(Side::Outer))
                };
                mesh.edges().filter(|&e| is_cut(e)).map(|e| lengths[e]).sum::<f64>()
            };
            let all = (0..1u32 << few).map(|bits| (0..few).map(|k| bits >> k & 1 == 1).collect::<Vec<bool>>());
            let least = all.map(|is_inner| cost(&is_inner)).fold(f64::INFINITY, f64::min);
            if let Some(found) = shortest_separation(&mesh, &lengths, &between, side, Watch::NONE).unwrap() {
                prop_assert!((cost(&found) - least).abs() < 1e-9, "{} {least}", cost(&found));
            }
        }
    }

    #[test]
    fn what_must_not_be_cut_is_not() {
        let mesh = shapes::sphere(42).mesh();
        let lengths = EdgeData::constant(mesh.edge_count(), f64::INFINITY);
        let between: Vec<FaceId> = mesh.faces().skip(1).take(9).collect();
        let side = |f: FaceId| if f.0 == 0 { Side::Inner } else { Side::Outer };
        assert_eq!(shortest_separation(&mesh, &lengths, &between, side, Watch::NONE), Ok(None));
        assert_eq!(
            shortest_separation(&mesh, &EdgeData::constant(mesh.edge_count(), 1.0), &[], side, Watch::NONE),
            Ok(None),
            "nothing lies between"
        );
    }
}
