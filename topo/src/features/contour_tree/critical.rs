//! A contour tree from the vertices that are critical in the join or the split tree, without sorting the others.
//!
//! Both trees come from the fast scan. Their leaves, saddles and roots are put into each other's branches, and the contour tree
//! of these few is found as that of all vertices would be. A vertex that is regular in both trees lies between two of them in each:
//! whichever of the two ways is taken out first, as a part of an edge, takes the vertex along. That is what becomes of it where all
//! vertices are in the trees; so the result is the same, where there is a contour tree at all. It is relied upon where the domain says
//! that its loops are filled.
//!
//! What takes time is to find the two places of each regular vertex. Values are compared once, to tell how many critical vertices are lower
//! ([`Ranks`]); the rest is done with numbers. Most vertices lie on the longest branch, where a table has the answer.

use super::super::attributes::Ancestry;
use super::super::merge_tree::MergeTree;
use super::combine::{Combined, Edges, Merging, arcs_between_nodes, edges};
use super::ranks::Ranks;
use crate::filtration::{Filtration, Kind, Rising};
use crate::pairing::{NONE, Settled, in_order};
use crate::parallel;
use crate::scalar::Scalar;

/// The vertices that are critical in either tree, by rising rank, and the tree of these; for each vertex of the domain its arc.
pub(super) struct Critical {
    pub(super) vertices: Vec<u32>,
    pub(super) tree: Combined,
    pub(super) arc_of: Vec<u32>,
}

/// The contour tree of what has these join and split trees, if there is one. All vertices enter.
pub(super) fn combine<S: Scalar>(
    join: &MergeTree<'_, (), S>,
    split: &MergeTree<'_, (), S>,
    filtration: &Filtration<'_, S, Rising>,
) -> Option<Critical> {
    let (vertices, mut arc_of) = critical_vertices([join, split], filtration);
    if filtration.stops() {
        return None; // the order is none
    }
    let upwards = Branched::new(join, &vertices, &arc_of);
    let downwards = Branched::new(split, &vertices, &arc_of);
    let Edges { in_order, order, taken } = edges(upwards.merging(join), downwards.merging(split))?;
    let (tree, arc_in_order) = arcs_between_nodes(&in_order, vertices.len());
    let mut arc_of_edge = vec![NONE; order.len()];
    order.iter().zip(arc_in_order).for_each(|(&found, arc)| arc_of_edge[found as usize] = arc);
    let values: Vec<S> = vertices.iter().map(|&vertex| filtration.value(vertex)).collect();
    let ranks = Ranks::new(&vertices, &values);
    parallel::map_blocks(&mut arc_of, 1, &|range, arcs| {
        if filtration.stops() {
            return;
        }
        for (v, arc) in (range.start as u32..).zip(arcs).filter(|(_, arc)| **arc == NONE) {
            let before = ranks.before(v, filtration.value(v));
            let last = [&upwards, &downwards].map(|tree| tree.last_before(v, before) as usize);
            let first = taken[0][last[0]].min(taken[1][last[1]]);
            *arc = arc_of_edge.get(first as usize).copied().unwrap_or(NONE);
        }
    });
    vertices.iter().zip(&tree.arc_of).for_each(|(&vertex, &arc)| arc_of[vertex as usize] = arc);
    Some(Critical { vertices, tree, arc_of })
}

/// Leaves, saddles and roots of the trees in the order in which they enter; and for each vertex its place among these, or [`NONE`].
fn critical_vertices<S: Scalar>(
    trees: [&MergeTree<'_, (), S>; 2],
    filtration: &Filtration<'_, S, Rising>,
) -> (Vec<u32>, Vec<u32>) {
    let mut rank_of = vec![NONE; filtration.field().len()];
    let mut count = 0;
    for tree in trees {
        let saddles = tree.ends.iter().map(|end| end.saddle);
        for vertex in tree.leaves.iter().copied().chain(saddles).chain(tree.roots.iter().map(|&(_, last)| last)) {
            count += usize::from(rank_of[vertex as usize] == NONE);
            rank_of[vertex as usize] = 0;
        }
    }
    let mut by_index: Vec<u32> = Vec::with_capacity(count);
    by_index.extend((0..).zip(&rank_of).filter(|&(_, &rank)| rank != NONE).map(|(vertex, _)| vertex));
    let order = in_order(filtration, by_index.len(), |place| by_index[place as usize]);
    let vertices: Vec<u32> = order.iter().map(|&place| by_index[place as usize]).collect();
    (0..).zip(&vertices).for_each(|(rank, &vertex)| rank_of[vertex as usize] = rank);
    (vertices, rank_of)
}

/// Critical vertices on the branches of one of the trees. They go by their *turns* there: ranks in the join tree, and in the split tree
/// ranks from the last on.
struct Branched<'a> {
    kind: Kind,
    ancestry: Ancestry,
    basins: Settled<'a>,
    /// How many critical vertices there are.
    count: u32,
    /// For each branch the turn at which it ends, [`NONE`] if it never does, and the branch in which it ends.
    ends: Vec<(u32, u32)>,
    /// Where the list of each branch begins, and the end of the last.
    starts: Vec<u32>,
    /// The turns on each branch, rising; first that of its leaf.
    turns: Vec<u32>,
    /// The branch with the longest list, on which most vertices are searched.
    longest: u32,
    /// For each turn the last one before it on that branch.
    last_on_longest: Vec<u32>,
}

impl<'a> Branched<'a> {
    /// From the critical vertices by rank, and their ranks.
    fn new<S: Scalar>(tree: &'a MergeTree<'_, (), S>, vertices: &[u32], rank_of: &[u32]) -> Self {
        let mut branched = Self {
            kind: tree.kind,
            ancestry: Ancestry::new(tree),
            basins: tree.basins(),
            count: vertices.len() as u32,
            ends: vec![(NONE, NONE); tree.leaves.len()],
            starts: vec![0; tree.leaves.len() + 1],
            turns: vec![0; vertices.len()],
            longest: 0,
            last_on_longest: Vec::new(),
        };
        for end in &tree.ends {
            let turn = branched.turn(rank_of[end.saddle as usize]);
            branched.ends[end.extremum as usize] = (turn, end.elder);
        }
        branched.fill(vertices);
        branched.tabulate();
        branched
    }

    /// The turn of a rank, and the rank of a turn.
    fn turn(&self, rank: u32) -> u32 {
        match self.kind {
            Kind::Minimum => rank,
            Kind::Maximum => self.count - 1 - rank,
        }
    }

    /// Puts the critical vertices into the lists of their branches.
    fn fill(&mut self, vertices: &[u32]) {
        let branch = |turn: u32| self.branch_of(vertices[self.turn(turn) as usize], turn + 1);
        let branches: Vec<u32> = (0..self.count).map(branch).collect();
        branches.iter().for_each(|&branch| self.starts[branch as usize + 1] += 1);
        for branch in 1..self.starts.len() {
            self.starts[branch] += self.starts[branch - 1];
        }
        let mut filled = self.starts.clone();
        for (turn, &branch) in (0..).zip(&branches) {
            let place = &mut filled[branch as usize];
            self.turns[*place as usize] = turn;
            *place += 1;
        }
    }

    /// Notes what comes last on the branch with the longest list.
    fn tabulate(&mut self) {
        let branches = 0..self.starts.len() as u32 - 1;
        self.longest = branches.max_by_key(|&branch| self.on_branch(branch).len()).unwrap_or(0);
        let mut table = Vec::with_capacity(self.count as usize + 1);
        let mut last = NONE;
        for &turn in self.on_branch(self.longest) {
            table.resize(turn as usize + 1, last);
            last = turn;
        }
        table.resize(self.count as usize + 1, last);
        self.last_on_longest = table;
    }

    /// The branch whose component a vertex enters before a turn, and after the one before that.
    fn branch_of(&self, vertex: u32, turn: u32) -> u32 {
        let end = |branch: u32| self.ends[branch as usize];
        self.ancestry.branch_going_on(self.basins.of(vertex), |branch| end(branch).0 < turn, |branch| end(branch).1)
    }

    /// The turns on a branch.
    fn on_branch(&self, branch: u32) -> &[u32] {
        &self.turns[self.starts[branch as usize] as usize..self.starts[branch as usize + 1] as usize]
    }

    /// The tree of the critical vertices: each is followed by the next on its branch, the last by the saddle at which the branch ends.
    fn merging<S: Scalar>(&self, tree: &MergeTree<'_, (), S>) -> Merging {
        let (mut next, mut degrees) = (vec![NONE; self.count as usize], vec![0; self.count as usize]);
        let mut follow = |turn: u32, by: u32| {
            let [rank, by] = [turn, by].map(|turn| self.turn(turn));
            next[rank as usize] = by;
            degrees[by as usize] += 1;
        };
        for branch in 0..tree.leaves.len() as u32 {
            self.on_branch(branch).windows(2).for_each(|pair| follow(pair[0], pair[1]));
        }
        for end in &tree.ends {
            let last = self.on_branch(end.extremum).last().expect("a branch begins with its leaf");
            follow(*last, self.ends[end.extremum as usize].0);
        }
        Merging::of_next(next, degrees)
    }

    /// The rank of the last critical vertex on the branch of a regular vertex that enters before it, given how many critical vertices are
    /// lower.
    #[inline]
    fn last_before(&self, vertex: u32, lower: u32) -> u32 {
        let turn = match self.kind {
            Kind::Minimum => lower,
            Kind::Maximum => self.count - lower,
        };
        let branch = self.branch_of(vertex, turn);
        let last = if branch == self.longest {
            self.last_on_longest[turn as usize]
        } else {
            let turns = self.on_branch(branch);
            turns[turns.partition_point(|&other| other < turn).max(1) - 1]
        };
        self.turn(last)
    }
}
