//! The branch decomposition of a field: each extremum with its basin, and the branch its own grows out of.
//!
//! Merge trees, segmentations and simplified fields are all read off from it. Extrema are numbered by vertex index.
//! Pascucci, Cole-McLaughlin & Scorzelli (2004), "Multi-resolution computation and presentation of contour trees".

use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Filtration};
use crate::pairing::{BasinLabels, BranchEnd, Branched, NONE, OUTSIDE, Pointing, UnionFind};
use crate::scalar::Scalar;

/// Basins by steepest descent and the branches on them.
#[derive(Debug)]
pub(crate) struct Branches {
    /// The vertices of the extrema, rising.
    pub(crate) extrema: Vec<u32>,
    /// For each vertex the extremum whose basin it is in.
    pub(crate) basins: BasinLabels,
    /// The branches that end, in the order in which they do.
    pub(crate) ends: Vec<BranchEnd>,
    /// The others, with the last vertex to enter, where not only labels are wanted.
    pub(crate) essential: Vec<(u32, u32)>,
}

impl Branches {
    /// Finds them, unless the work is stopped; `pointing` is the steepest, or that for labels.
    pub(crate) fn new<G: Domain, S: Scalar, D: Direction>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
        pointing: Pointing,
    ) -> Result<Self, Error> {
        let Branched { ends, essential, descent } = domain.basins(filtration, pointing).branch(filtration);
        if filtration.stops() {
            return Err(Error::Interrupted);
        }
        let (basins, extrema) = descent.into_labels();
        Ok(Self { extrema, basins, ends, essential })
    }

    /// For each extremum whether its branch lives longer than a threshold.
    pub(crate) fn longer<S: Scalar, D: Direction>(
        &self,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> Vec<bool> {
        let mut is_longer = vec![true; self.extrema.len()];
        for end in &self.ends {
            let born = filtration.value(self.extrema[end.extremum as usize]);
            is_longer[end.extremum as usize] = born.width(filtration.value(end.saddle)) > threshold;
        }
        is_longer
    }

    /// The field with all branches that are not kept filled up.
    pub(crate) fn filled<S: Scalar, D: Direction>(&self, filtration: &Filtration<'_, S, D>, kept: &[bool]) -> Vec<S> {
        let ends = self.ends.iter().map(|end| (end.extremum, end.elder, end.saddle));
        let levels = fill_levels(ends, kept);
        let fill = |(v, basin): (u32, u32)| {
            let level = levels.get(basin as usize).copied().flatten();
            filtration.value(level.map_or(v, |saddle| filtration.later(v, saddle)))
        };
        (0..).zip(self.basins.settled().iter()).map(fill).collect()
    }
}

/// For each extremum the level up to which its basin must be filled so that only kept branches are left; from the branches
/// that end, in their order: whose they are, the elder, and the level at which they do.
pub(crate) fn fill_levels<L: Copy>(
    ends: impl DoubleEndedIterator<Item = (u32, u32, L)>,
    kept: &[bool],
) -> Vec<Option<L>> {
    let mut levels = vec![None; kept.len()];
    // Later saddles first: a branch that goes, on one that goes, is filled as far as that.
    for (extremum, elder, level) in ends.rev().filter(|end| !kept[end.0 as usize]) {
        levels[extremum as usize] = levels[elder as usize].or(Some(level));
    }
    levels
}

/// For each extremum the place among the kept ones of that into whose basin its own spills, by way of others that are not
/// kept; from all branches that end.
///
/// Every branch spills into another component, so spills close no circle: each group is a tree of them, with one
/// extremum that is kept, whichever member is the root of the union-find.
pub(crate) fn spilled(ends: &[BranchEnd], kept: &[bool]) -> Vec<u32> {
    let mut groups = UnionFind::new(kept.len());
    for end in ends.iter().filter(|end| !kept[end.extremum as usize]) {
        let (from, to) = (groups.find(end.extremum), groups.find(end.beyond));
        groups.join(from, to);
    }
    let mut place_of_group = vec![NONE; kept.len()];
    let kept = (0..).zip(kept).filter(|&(_, &kept)| kept);
    for (place, (extremum, _)) in (0..).zip(kept) {
        place_of_group[groups.find(extremum) as usize] = place;
    }
    (0..groups.len() as u32).map(|extremum| place_of_group[groups.find(extremum) as usize]).collect()
}

/// Whether a vertex with this basin enters.
pub(crate) fn enters(basin: u32) -> bool {
    basin != OUTSIDE
}
