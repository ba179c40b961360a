//! Chains: runs of open edges whose two sides differ by one rigid motion.
//!
//! Along a seam of a cone metric the two sides of the map are congruent, from one cone or branch to the next. There an island
//! can be glued to its neighbour. Boundaries are kept as linked loops of halfedges, the map on their left, so that
//! gluing a chain is a change at its two ends.

use std::cmp::Ordering;

use geom::{EdgeData, EdgeId, HalfedgeId, Islands, Mesh};

use super::motion::{Fit, Motion};
use super::table::{Set, Table};

/// The two sides of an edge are congruent if no end is farther off, in shares of the map's extent. What Newton's method leaves of
/// curvature, and positions along a tree, make up to 1e-11.
const CONGRUENT: f64 = 1e-10;
/// And in shares of the edge's length: a point that is moved so far turns no triangle that is not a needle.
const CONGRUENT_EDGE: f64 = 1e-3;

/// A run of open edges.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    /// The halfedges on one side, in order along the boundary; their twins are on the other.
    pub(super) sides: Vec<HalfedgeId>,
    /// The islands on the side of the halfedges and on that of their twins.
    pub(super) islands: [u32; 2],
    /// What takes the twins' island to the halfedges'.
    pub(super) motion: Motion,
    /// Its length in space.
    pub(super) length: f64,
}

impl Chain {
    pub(super) fn longer_first(&self, other: &Self) -> Ordering {
        other.length.total_cmp(&self.length).then(self.sides[0].cmp(&other.sides[0]))
    }
}

/// The tail of an edge on the other side and on this one, and its head.
fn ends(mesh: &Mesh, h: HalfedgeId, position: impl Fn(HalfedgeId) -> [f64; 2]) -> [([f64; 2], [f64; 2]); 2] {
    let g = mesh.twin(h).expect("a chain has two sides");
    [(position(mesh.next(g)), position(h)), (position(g), position(mesh.next(h)))]
}

/// Whether a motion takes an edge's other side to this one.
fn fits(motion: &Motion, [(tail, to_tail), (head, to_head)]: [([f64; 2], [f64; 2]); 2], extent: f64) -> bool {
    let squared = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
    let most = (CONGRUENT * extent).powi(2).min(CONGRUENT_EDGE.powi(2) * squared(to_tail, to_head));
    squared(motion.of(tail), to_tail) <= most && squared(motion.of(head), to_head) <= most
}

/// What takes the other side of a run of edges to this one; none if the sides are not congruent.
pub(super) fn motion_across(
    mesh: &Mesh,
    sides: &[HalfedgeId],
    position: impl Fn(HalfedgeId) -> [f64; 2],
    extent: f64,
) -> Option<Motion> {
    let ends = |&h: &HalfedgeId| ends(mesh, h, &position);
    if sides.iter().map(ends).all(|ends| ends.iter().all(|(from, to)| from == to)) {
        return Some(Motion::NONE);
    }
    let (tail, to_tail) = ends(&sides[0])[0];
    let mut fit = Fit::new(tail, to_tail);
    sides.iter().map(ends).for_each(|[_, (head, to_head)]| fit.add(head, to_head));
    let motion = fit.motion();
    sides.iter().map(ends).all(|ends| fits(&motion, ends, extent)).then_some(motion)
}

/// The boundary loops of the islands of a map.
#[derive(Clone, Debug)]
pub(super) struct Loops<'a> {
    mesh: &'a Mesh,
    /// What comes after a halfedge on the boundary.
    next: Table<HalfedgeId, HalfedgeId>,
    previous: Table<HalfedgeId, HalfedgeId>,
}

impl<'a> Loops<'a> {
    pub(super) fn new(mesh: &'a Mesh, islands: &Islands) -> Self {
        let mut loops = Self { mesh, next: Table::default(), previous: Table::default() };
        for around in islands.boundary_loops() {
            for (k, &h) in around.iter().enumerate() {
                loops.link(h, around[(k + 1) % around.len()]);
            }
        }
        loops
    }

    fn link(&mut self, h: HalfedgeId, next: HalfedgeId) {
        self.next.insert(h, next);
        self.previous.insert(next, h);
    }

    /// Whether a halfedge is on the boundary.
    pub(super) fn contains(&self, h: HalfedgeId) -> bool {
        self.next.contains_key(&h)
    }

    fn next(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        self.next.get(&h).copied()
    }

    fn previous(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        self.previous.get(&h).copied()
    }

    /// Takes the sides of a chain off the boundary. What comes to follow each other instead.
    pub(super) fn glue(&mut self, chain: &Chain) -> Vec<HalfedgeId> {
        let mut joined = Vec::new();
        for &h in &chain.sides {
            let Some(g) = self.mesh.twin(h) else { continue };
            // What comes before one side goes on with what comes after the other.
            for (before, after) in [(self.previous(h), self.next(g)), (self.previous(g), self.next(h))] {
                if let (Some(before), Some(after)) = (before, after) {
                    self.link(before, after);
                    joined.extend([before, after]);
                }
            }
            for side in [h, g] {
                self.next.remove(&side);
                self.previous.remove(&side);
            }
        }
        joined
    }

    /// The chains of edges that are not kept open, between islands that are `asked` for, of the runs that some of the halfedges are in, longest
    /// first; of each chain the side whose island comes first. `position` gives the corners as they lie now.
    pub(super) fn chains_through(
        &self,
        some: impl Iterator<Item = HalfedgeId>,
        asked: impl Fn([u32; 2]) -> bool,
        (island, is_kept): (impl Fn(HalfedgeId) -> u32, impl Fn(EdgeId) -> bool),
        position: impl Fn(HalfedgeId) -> [f64; 2],
        lengths: &EdgeData<f64>,
        extent: f64,
    ) -> Vec<Chain> {
        let islands = |h: HalfedgeId| {
            let g = self.mesh.twin(h).filter(|_| !is_kept(self.mesh.edge(h)))?;
            Some([island(h), island(g)]).filter(|&islands| asked(islands))
        };
        let mesh = self.mesh;
        // Whether the edges of a halfedge and of the next one on the boundary also follow each other on the other side, but not back
        // along the same edge.
        let goes_on = |h: HalfedgeId, next: HalfedgeId| {
            islands(h).is_some()
                && mesh.twin(h) != Some(next)
                && islands(h) == islands(next)
                && mesh.twin(next).is_some_and(|g| self.next(g) == mesh.twin(h))
        };
        let mut is_done = Set::default();
        let mut chains = Vec::new();
        for first in some.filter(|&h| self.contains(h)) {
            if islands(first).is_none() || is_done.contains(&first) {
                continue;
            }
            let mut start = first;
            while let Some(before) = self.previous(start).filter(|&before| before != first && goes_on(before, start)) {
                start = before;
            }
            let mut run = vec![start];
            while let Some(next) = self.next(run[run.len() - 1])
                && next != start
                && goes_on(run[run.len() - 1], next)
            {
                run.push(next);
            }
            is_done.extend(run.iter().flat_map(|&h| [Some(h), mesh.twin(h)]).flatten());
            let islands = islands(first).expect("it was asked for");
            chains.extend(self.congruent(&run, islands, &position, lengths, extent));
        }
        chains.sort_by(Chain::longer_first);
        chains
    }

    /// A run of edges in chains that have one motion each. Edges whose sides are not congruent are in none.
    fn congruent(
        &self,
        run: &[HalfedgeId],
        islands: [u32; 2],
        position: impl Fn(HalfedgeId) -> [f64; 2],
        lengths: &EdgeData<f64>,
        extent: f64,
    ) -> Vec<Chain> {
        let mesh = self.mesh;
        let ends = |h: HalfedgeId| ends(mesh, h, &position);
        let fits = |motion: &Motion, h: HalfedgeId| fits(motion, ends(h), extent);
        let mut chains: Vec<Chain> = Vec::new();
        let mut begun: Option<(Fit, Chain)> = None;
        for &h in run {
            let [(tail, to_tail), (head, to_head)] = ends(h);
            let longer = begun.take().map(|(mut fit, chain)| {
                fit.add(head, to_head);
                let motion = fit.motion();
                if fits(&motion, h) && fits(&motion, chain.sides[0]) { Ok((fit, motion, chain)) } else { Err(chain) }
            });
            match longer {
                Some(Ok((fit, motion, mut chain))) => {
                    chain.sides.push(h);
                    chain.length += lengths[mesh.edge(h)];
                    begun = Some((fit, Chain { motion, ..chain }));
                    continue;
                }
                Some(Err(chain)) => chains.push(chain),
                None => {}
            }
            let mut fit = Fit::new(tail, to_tail);
            fit.add(head, to_head);
            let motion = fit.motion();
            if fits(&motion, h) {
                begun = Some((fit, Chain { sides: vec![h], islands, motion, length: lengths[mesh.edge(h)] }));
            }
        }
        chains.extend(begun.map(|(_, chain)| chain));
        chains
    }
}
