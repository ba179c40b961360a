//! A contour tree from the vertices that are critical in the join or the split tree, without sorting the others.
//!
//! Both trees come from the fast scan. Their leaves, saddles and roots are put into each other's branches, and the contour tree
//! of these few is found as that of all vertices would be. A vertex that is regular in both trees lies between two of them in each:
//! whichever of the two ways is taken out first, as a part of an edge, takes the vertex along. That is what becomes of it where all
//! vertices are in the trees; so the result is the same, where there is a contour tree at all. It is relied upon where the domain says
//! that its loops are filled.

use super::super::attributes::Ancestry;
use super::super::merge_tree::MergeTree;
use super::combine::{Combined, Edges, Merging, arcs_between_nodes, edges};
use crate::filtration::{Direction, Falling, Filtration, Kind, Rising};
use crate::pairing::{NONE, Settled};
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
    let vertices = critical_vertices(join, split, filtration);
    let values: Vec<S> = vertices.iter().map(|&vertex| filtration.value(vertex)).collect();
    let upwards = Branched::new::<Rising>(join, &vertices, &values);
    let downwards = Branched::new::<Falling>(split, &vertices, &values);
    let Edges { in_order, found, taken } = edges(upwards.merging(join), downwards.merging(split))?;
    let (tree, arc_in_order) = arcs_between_nodes(&in_order, vertices.len());
    let arc_of_edge: Vec<u32> = found
        .iter()
        .map(|edge| arc_in_order[in_order.binary_search(edge).expect("both lists have the same edges")])
        .collect();
    let mut arc_of = vec![NONE; filtration.field().len()];
    parallel::map_blocks(&mut arc_of, 1, |range, arcs| {
        if filtration.stops() {
            return;
        }
        for (v, arc) in (range.start as u32..).zip(arcs) {
            let value = filtration.value(v);
            let first = [(&upwards, &taken[0]), (&downwards, &taken[1])].map(|(tree, taken)| match tree.kind {
                Kind::Minimum => taken[tree.last_before::<Rising>(join, v, value) as usize],
                Kind::Maximum => taken[tree.last_before::<Falling>(split, v, value) as usize],
            });
            *arc = arc_of_edge.get(first[0].min(first[1]) as usize).copied().unwrap_or(NONE);
        }
    });
    vertices.iter().zip(&tree.arc_of).for_each(|(&vertex, &arc)| arc_of[vertex as usize] = arc);
    Some(Critical { vertices, tree, arc_of })
}

/// Leaves, saddles and roots of both trees in the order in which they enter.
fn critical_vertices<S: Scalar>(
    join: &MergeTree<'_, (), S>,
    split: &MergeTree<'_, (), S>,
    filtration: &Filtration<'_, S, Rising>,
) -> Vec<u32> {
    let of_tree = |tree: &MergeTree<'_, (), S>| -> Vec<u32> {
        let leaves = tree.leaves.iter().map(|leaf| leaf.index);
        let saddles = tree.endings.iter().map(|end| end.saddle.index);
        leaves.chain(saddles).chain(tree.roots.iter().map(|(_, last)| last.index)).collect()
    };
    let mut vertices = [of_tree(join), of_tree(split)].concat();
    vertices.sort_unstable();
    vertices.dedup();
    filtration.sorted(&vertices, |&vertex| vertex)
}

/// Critical vertices on the branches of one of the trees.
struct Branched<'a, S> {
    kind: Kind,
    ancestry: Ancestry,
    basins: Settled<'a>,
    /// The critical vertices by rank.
    vertices: &'a [u32],
    /// Where the list of each branch begins, and the end of the last.
    starts: Vec<u32>,
    /// The ranks on each branch in the order in which they enter; first its leaf.
    ranks: Vec<u32>,
    /// The values there.
    levels: Vec<S>,
}

impl<'a, S: Scalar> Branched<'a, S> {
    fn new<D: Direction>(tree: &'a MergeTree<'_, (), S>, vertices: &'a [u32], values: &'a [S]) -> Self {
        let (ancestry, basins) = (Ancestry::new(tree), tree.basins());
        let branch = |rank: usize| {
            let vertex = vertices[rank];
            ancestry.branch_of(tree, vertex, values[rank], basins.of(vertex))
        };
        let branches: Vec<u32> = (0..vertices.len()).map(branch).collect();
        let mut starts = vec![0; tree.leaves.len() + 1];
        branches.iter().for_each(|&branch| starts[branch as usize + 1] += 1);
        for branch in 0..tree.leaves.len() {
            starts[branch + 1] += starts[branch];
        }
        let (mut filled, mut ranks) = (starts.clone(), vec![0; vertices.len()]);
        let mut put = |rank: u32| {
            let place = &mut filled[branches[rank as usize] as usize];
            ranks[*place as usize] = rank;
            *place += 1;
        };
        let all = 0..vertices.len() as u32;
        if D::KIND == Kind::Minimum {
            all.for_each(&mut put);
        } else {
            all.rev().for_each(&mut put);
        }
        let levels = ranks.iter().map(|&rank: &u32| values[rank as usize]).collect();
        Self { kind: D::KIND, ancestry, basins, vertices, starts, ranks, levels }
    }

    fn on_branch(&self, branch: u32) -> &[u32] {
        &self.ranks[self.starts[branch as usize] as usize..self.starts[branch as usize + 1] as usize]
    }

    /// The tree of the critical vertices: each is followed by the next on its branch, the last by the saddle at which the branch ends.
    fn merging(&self, tree: &MergeTree<'_, (), S>) -> Merging {
        let (mut next, mut degrees) = (vec![NONE; self.vertices.len()], vec![0; self.vertices.len()]);
        let mut follow = |rank: u32, by: u32| {
            next[rank as usize] = by;
            degrees[by as usize] += 1;
        };
        let mut rank_of: Vec<(u32, u32)> = self.vertices.iter().copied().zip(0..).collect();
        rank_of.sort_unstable();
        for branch in 0..tree.leaves.len() as u32 {
            self.on_branch(branch).windows(2).for_each(|pair| follow(pair[0], pair[1]));
        }
        for end in &tree.endings {
            let place = rank_of.partition_point(|&(vertex, _)| vertex < end.saddle.index);
            let last = self.on_branch(end.leaf).last().expect("a branch begins with its leaf");
            follow(*last, rank_of[place].1);
        }
        Merging::of_next(next, degrees)
    }

    /// The rank of the last critical vertex on the branch of a vertex that enters no later than it.
    fn last_before<D: Direction>(&self, tree: &MergeTree<'_, (), S>, vertex: u32, value: S) -> u32 {
        let branch = self.ancestry.branch_of(tree, vertex, value, self.basins.of(vertex));
        let [first, end] = [branch, branch + 1].map(|branch| self.starts[branch as usize] as usize);
        let (levels, ranks) = (&self.levels[first..end], &self.ranks[first..end]);
        let has_entered = |other: u32, level: S| match other < vertex {
            true => D::precedes_higher_index(level, value),
            false => other == vertex || D::precedes_lower_index(level, value),
        };
        // By values alone, which lie side by side: those before it, and those equal to it, of which only the vertices tell.
        let is_lower = |level: S| D::precedes_higher_index(level, value) && D::precedes_lower_index(level, value);
        let is_no_higher = |level: S| D::precedes_higher_index(level, value) || D::precedes_lower_index(level, value);
        let end = levels.partition_point(|&level| is_no_higher(level));
        let has_equal = levels[..end].last().is_some_and(|&level| !is_lower(level));
        let entered = if !has_equal {
            end
        } else {
            let start = levels[..end].partition_point(|&level| is_lower(level));
            start + ranks[start..end].partition_point(|&rank| has_entered(self.vertices[rank as usize], value))
        };
        ranks[entered.max(1) - 1]
    }
}
