//! What branches of a merge tree measure, and trees of those that measure enough.
//!
//! A vertex belongs to the branch whose component it enters: that of its basin, or where that has ended, the elder, and so
//! on. Going up is by skip pointers (Myers 1983, "An applicative random-access stack"), as branches can end in each other in
//! a long row: O(log n) for n branches at worst, mostly one step.

use super::branches::enters;
use super::merge_tree::MergeTree;
use crate::error::Error;
use crate::pairing::NONE;
use crate::persistence::Pair;
use crate::scalar::Scalar;

/// An extremum with the extremum whose component its own joins.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Branch<V, S> {
    /// Birth and death.
    pub pair: Pair<V, S>,
    /// The eldest extremum of the component that is joined at the saddle; `None` if the class is essential. Among peaks:
    /// the highest one that can be reached without going below the saddle (the *island* or *encirclement* parent).
    pub parent: Option<V>,
    /// How many vertices the component has just before the saddle; at the end, if the class is essential.
    pub size: usize,
}

impl<V: Copy, S: Scalar> MergeTree<'_, V, S> {
    /// The extrema with their parents, in the order of [`Pairs`](crate::Pairs) and with the pairs of zero persistence.
    ///
    /// ```
    /// let heights = [0.0, 7.0, 2.0, 5.0, 4.0, 9.0];
    /// let tree = topo::merge_tree(&topo::Path::new(6), &heights, topo::Kind::Maximum)?;
    /// let family: Vec<_> = tree.branches().iter().map(|peak| (peak.pair.extremum, peak.parent, peak.size)).collect();
    /// assert_eq!(family, [(1, Some(5), 1), (3, Some(5), 1), (5, None, 6)]);
    /// # Ok::<(), topo::Error>(())
    /// ```
    pub fn branches(&self) -> Vec<Branch<V, S>> {
        let sizes = self.accumulated(|_| 1);
        let mut ends = vec![None; self.leaves.len()];
        for (end, saddle) in self.ends_and_saddles() {
            ends[end.extremum as usize] = Some((saddle, self.value(end.saddle), Some(self.leaf_name(end.elder))));
        }
        for (leaf, last, name) in self.roots_and_names() {
            ends[leaf as usize] = Some((name, self.value(last), None));
        }
        let branch = |((leaf, end), size)| {
            let (last, end, parent): (V, S, Option<V>) = end?;
            let (extremum, birth) = (self.leaf_name(leaf), self.value(self.leaves[leaf as usize]));
            Some(Branch { pair: Pair { extremum, saddle: parent.map(|_| last), birth, end }, parent, size })
        };
        (0u32..).zip(ends).zip(sizes).filter_map(branch).collect()
    }

    /// For each of the [branches](Self::branches) the sum of what the vertices of its component weigh just before the
    /// saddle, such as their areas, or the depths of lakes. O(vertices log branches).
    ///
    /// # Errors
    /// If there is not one weight for every vertex.
    pub fn sums(&self, weights: &[f64]) -> Result<Vec<f64>, Error> {
        let vertices = self.values.len();
        if weights.len() != vertices {
            return Err(Error::Length { values: weights.len(), vertices });
        }
        Ok(self.accumulated(|vertex| weights[vertex]))
    }

    /// The tree of the branches that are wanted, those that they end in, and essential ones; the others are filled up (or,
    /// for maxima, cut off) to the saddle. Branches are asked about in the order of [`branches`](Self::branches).
    ///
    /// ```
    /// let heights = [0.0, 3.0, 0.0, 2.0, 2.0, 2.0, 0.0, 9.0];
    /// let tree = topo::merge_tree(&topo::Path::new(8), &heights, topo::Kind::Maximum)?;
    /// let wide = tree.filter(|peak| peak.size >= 3);
    /// assert_eq!(wide.field(), [0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 0.0, 9.0]);
    /// # Ok::<(), topo::Error>(())
    /// ```
    #[must_use = "the tree itself is left as it is"]
    pub fn filter(&self, mut is_wanted: impl FnMut(&Branch<V, S>) -> bool) -> MergeTree<'static, V, S> {
        let mut kept: Vec<bool> = self.branches().iter().map(&mut is_wanted).collect();
        self.roots.iter().for_each(|root| kept[root.0 as usize] = true);
        for end in &self.ends {
            kept[end.elder as usize] |= kept[end.extremum as usize];
        }
        self.pruned(&kept)
    }

    /// For each leaf the sum over the component of its branch where that ends.
    fn accumulated<T: Copy + Default + core::ops::AddAssign>(&self, weight: impl Fn(usize) -> T) -> Vec<T> {
        let ancestry = Ancestry::new(self);
        let mut sums = vec![T::default(); self.leaves.len()];
        for (v, (basin, &value)) in self.basins().iter().zip(&*self.values).enumerate() {
            if enters(basin) {
                sums[ancestry.branch_of(self, self.enters_with(v as u32), value, basin) as usize] += weight(v);
            }
        }
        for end in &self.ends {
            let ended = sums[end.extremum as usize];
            sums[end.elder as usize] += ended;
        }
        sums
    }
}

/// The branches that each branch ends in, one after the other.
pub(super) struct Ancestry {
    /// For each leaf its ending, as a place among them; [`NONE`] if it has none.
    ending: Vec<u32>,
    /// For each leaf one farther up; itself at a root.
    skip: Vec<u32>,
}

impl Ancestry {
    pub(super) fn new<V: Copy, S: Scalar>(tree: &MergeTree<'_, V, S>) -> Self {
        let count = tree.leaves.len();
        let (mut ending, mut depth) = (vec![NONE; count], vec![0u32; count]);
        let mut skip: Vec<u32> = (0..count as u32).collect();
        // What ends later has its place before what ends in it.
        for (place, end) in (0..tree.ends.len() as u32).zip(&tree.ends).rev() {
            let (leaf, elder) = (end.extremum as usize, end.elder as usize);
            (ending[leaf], depth[leaf]) = (place, depth[elder] + 1);
            let once = skip[elder] as usize;
            let twice = skip[once] as usize;
            let is_even = depth[elder] - depth[once] == depth[once] - depth[twice];
            skip[leaf] = if is_even { twice as u32 } else { end.elder };
        }
        Self { ending, skip }
    }

    /// The branch whose component a vertex of a basin enters.
    pub(super) fn branch_of<V: Copy, S: Scalar>(
        &self,
        tree: &MergeTree<'_, V, S>,
        vertex: u32,
        value: S,
        basin: u32,
    ) -> u32 {
        let ending = |leaf: u32| tree.ends.get(self.ending[leaf as usize] as usize);
        let has_ended = |leaf: u32| ending(leaf).is_some_and(|end| !tree.is_before(vertex, value, end.saddle));
        self.branch_going_on(basin, has_ended, |leaf| ending(leaf).map_or(leaf, |end| end.elder))
    }

    /// The first branch that has not ended, from one on; given which have, and the elder of each that does.
    #[inline]
    pub(super) fn branch_going_on(
        &self,
        mut branch: u32,
        has_ended: impl Fn(u32) -> bool,
        elder: impl Fn(u32) -> u32,
    ) -> u32 {
        while has_ended(branch) {
            let skip = self.skip[branch as usize];
            branch = if has_ended(skip) { skip } else { elder(branch) };
        }
        branch
    }
}
