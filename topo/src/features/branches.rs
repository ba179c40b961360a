//! The branch decomposition of a field: each extremum with its basin, and the branch its own grows out of.
//!
//! Merge trees, segmentations and simplified fields are all read off from it. Extrema are numbered by vertex index.
//! Pascucci, Cole-McLaughlin & Scorzelli (2004), "Multi-resolution computation and presentation of contour trees".

use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Filtration, Kind};
use crate::pairing::{BasinLabels, Descent, Merge, NONE, OUTSIDE, Paired, Pointing, UnionFind};
use crate::scalar::Scalar;

/// A branch ends at a saddle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BranchEnd {
    /// The extremum whose branch it is.
    pub(crate) extremum: u32,
    pub(crate) saddle: u32,
    /// The eldest extremum of all that meet at the saddle, whose branch goes on.
    pub(crate) elder: u32,
    /// The extremum to which one comes from the saddle by steepest descent into the elder component.
    pub(crate) beyond: u32,
}

/// Basins by steepest descent and the branches on them.
#[derive(Debug)]
pub(crate) struct Branches {
    /// The vertices of the extrema, rising.
    pub(crate) extrema: Vec<u32>,
    /// For each vertex the extremum whose basin it is in.
    pub(crate) basins: BasinLabels,
    /// The branches that end, in the order in which they do.
    pub(crate) ends: Vec<BranchEnd>,
    /// The others, with the last vertex to enter.
    pub(crate) essential: Vec<(u32, u32)>,
}

impl Branches {
    /// Finds them, unless the work is stopped.
    pub(crate) fn new<G: Domain, S: Scalar, D: Direction>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
    ) -> Result<Self, Error> {
        let Paired { merges, in_order, descent } = domain.basins(filtration, Pointing::Steepest).pair(filtration);
        if filtration.stops() {
            return Err(Error::Interrupted);
        }
        let essential = (0..).zip(&merges).filter(|(_, merge)| !merge.is_finite());
        let essential = essential.map(|(extremum, merge)| (extremum, merge.end)).collect();
        let ends = ends(domain, filtration, &descent, &merges, in_order);
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
/// kept; from (extremum, beyond) for all branches that end.
///
/// Every branch spills into another component, so spills close no circle: each group is a tree of them, with one
/// extremum that is kept, whichever member is the root of the union-find.
pub(crate) fn spilled(ends: impl Iterator<Item = (u32, u32)>, kept: &[bool]) -> Vec<u32> {
    let mut groups = UnionFind::new(kept.len());
    for (extremum, beyond) in ends.filter(|end| !kept[end.0 as usize]) {
        let (from, to) = (groups.find(extremum), groups.find(beyond));
        groups.join(from, to);
    }
    let mut place_of_group = vec![NONE; kept.len()];
    let kept = (0..).zip(kept).filter(|&(_, &kept)| kept);
    for (place, (extremum, _)) in (0..).zip(kept) {
        place_of_group[groups.find(extremum) as usize] = place;
    }
    (0..groups.len() as u32).map(|extremum| place_of_group[groups.find(extremum) as usize]).collect()
}

/// So many saddles are looked around at before the watch is asked.
const LOOKED_AT: usize = 1 << 13;

/// The branches that end, in the order in which they do; not all if the work is stopped.
fn ends<G: Domain, S: Scalar, D: Direction>(
    domain: G,
    filtration: &Filtration<'_, S, D>,
    descent: &Descent,
    merges: &[Merge],
    mut in_order: Vec<u32>,
) -> Vec<BranchEnd> {
    let saddle = |basin: u32| merges[basin as usize].end;
    // Of several that end at one saddle the elder first, so that each finds the eldest of all.
    for at_saddle in in_order.chunk_by_mut(|&a, &b| saddle(a) == saddle(b)).filter(|at_saddle| at_saddle.len() > 1) {
        at_saddle.copy_from_slice(&filtration.sorted(at_saddle, |&basin| merges[basin as usize].extremum));
    }
    let sides = Sides::new(domain, filtration, descent, in_order.iter().map(|&basin| saddle(basin)));
    // For each component that touches the saddle, where it does first.
    let (mut first, mut noted) = (vec![NONE; merges.len()], NONE);
    let mut components = UnionFind::new(merges.len());
    let end = |(&extremum, &list): (&u32, &u32)| {
        let Merge { end: saddle, towards, .. } = merges[extremum as usize];
        let around = sides.of(list);
        if noted != saddle {
            noted = saddle;
            for (place, &basin) in around.iter().enumerate().rev() {
                first[components.find(basin) as usize] = place as u32;
            }
        }
        let elder = components.find(descent.basin(towards));
        let [from, to] = [extremum, elder].map(|component| first[component as usize]);
        // From now on the younger component is a part of the elder one.
        first[elder as usize] = from.min(to);
        components.join(extremum, elder);
        BranchEnd { extremum, saddle, elder, beyond: around[to as usize] }
    };
    in_order.iter().zip(&sides.lists).map(end).collect()
}

/// The basins around saddles, those of earlier neighbours first.
struct Sides {
    /// For each saddle that was asked for its list.
    lists: Vec<u32>,
    /// Where each list begins, and the end of the last.
    starts: Vec<usize>,
    basins: Vec<u32>,
}

impl Sides {
    /// Looks around saddles, of which some come several times in a row. That is done as the field lies in memory: on noise it takes half the
    /// time of looking around when saddles come by value. No lists if the work is stopped.
    fn new<G: Domain, S: Scalar, D: Direction>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
        descent: &Descent,
        saddles: impl ExactSizeIterator<Item = u32>,
    ) -> Self {
        let mut sides = Self { lists: vec![0; saddles.len()], starts: vec![0], basins: Vec::new() };
        let mut placed: Vec<(u32, u32)> = saddles.zip(0..).collect();
        placed.sort_unstable();
        let mut neighbors = Vec::new();
        for (list, at_saddle) in (0..).zip(placed.chunk_by(|a, b| a.0 == b.0)) {
            if (list as usize).is_multiple_of(LOOKED_AT) && filtration.stops() {
                return Self { lists: Vec::new(), ..sides };
            }
            at_saddle.iter().for_each(|&(_, place)| sides.lists[place as usize] = list);
            let saddle = at_saddle[0].0;
            neighbors.clear();
            domain.for_each_neighbor(saddle as usize, |u| {
                if filtration.precedes(u as u32, saddle) {
                    neighbors.push(u as u32);
                }
            });
            neighbors.sort_unstable_by_key(|&u| (filtration.value(u).key(), u));
            if D::KIND == Kind::Maximum {
                neighbors.reverse();
            }
            sides.basins.extend(neighbors.iter().map(|&u| descent.basin(u)));
            sides.starts.push(sides.basins.len());
        }
        sides
    }

    fn of(&self, list: u32) -> &[u32] {
        &self.basins[self.starts[list as usize]..self.starts[list as usize + 1]]
    }
}

/// Whether a vertex with this basin enters.
pub(crate) fn enters(basin: u32) -> bool {
    basin != OUTSIDE
}
