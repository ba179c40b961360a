//! The branch decomposition of a field: each extremum with its basin, and the branch its own grows out of.
//!
//! Merge trees, segmentations and simplified fields are all read off from it. Extrema are numbered by vertex index.
//! Pascucci, Cole-McLaughlin & Scorzelli (2004), "Multi-resolution computation and presentation of contour trees".

use crate::domain::Domain;
use crate::filtration::{Direction, Filtration};
use crate::pairing::{Merge, NONE, OUTSIDE, Pointing, UnionFind};
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
#[derive(Debug, Clone)]
pub(crate) struct Branches {
    /// The vertices of the extrema, rising.
    pub(crate) extrema: Vec<u32>,
    /// For each vertex the extremum whose basin it is in, [`OUTSIDE`] if it never enters.
    pub(crate) basins: Vec<u32>,
    /// The branches that end, in the order in which they do.
    pub(crate) ends: Vec<BranchEnd>,
    /// The others, with the last vertex to enter.
    pub(crate) essential: Vec<(u32, u32)>,
}

impl Branches {
    pub(crate) fn new<G: Domain, S: Scalar, D: Direction>(domain: G, filtration: &Filtration<'_, S, D>) -> Self {
        let (merges, descent) = domain.basins(filtration, Pointing::Steepest).pair(filtration);
        let (basins, extrema) = descent.into_basins();
        let essential = (0..).zip(&merges).filter(|(_, merge)| !merge.is_finite());
        let essential = essential.map(|(extremum, merge)| (extremum, merge.end)).collect();
        let ends = ends(domain, filtration, &basins, &merges);
        Self { extrema, basins, ends, essential }
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
        let fill = |(v, &basin): (u32, &u32)| {
            let level = levels.get(basin as usize).copied().flatten();
            filtration.value(level.map_or(v, |saddle| filtration.later(v, saddle)))
        };
        (0..).zip(&self.basins).map(fill).collect()
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

/// The branches that end, in the order in which they do.
fn ends<G: Domain, S: Scalar, D: Direction>(
    domain: G,
    filtration: &Filtration<'_, S, D>,
    basins: &[u32],
    merges: &[Merge],
) -> Vec<BranchEnd> {
    let basin = |vertex: u32| basins[vertex as usize];
    let mut components = UnionFind::new(merges.len());
    // Of several that end at one saddle the elder first, so that each finds the eldest of all.
    let finite: Vec<Merge> = merges.iter().copied().filter(Merge::is_finite).collect();
    let finite = filtration.sorted(&filtration.sorted(&finite, |merge| merge.extremum), |merge| merge.end);
    let (mut sides, mut noted) = (vec![NONE; merges.len()], NONE);
    let end = |Merge { extremum, end: saddle, towards }: Merge| {
        if noted != saddle {
            noted = saddle;
            note_sides(domain, filtration, saddle, &mut sides, |u| components.find(basin(u)));
        }
        let (extremum, elder) = (basin(extremum), components.find(basin(towards)));
        let [from, to] = [extremum, elder].map(|component| sides[component as usize]);
        let beyond = if to == NONE { elder } else { basin(to) };
        // From now on the younger component is a part of the elder one.
        sides[elder as usize] = match (from, to) {
            (NONE, side) | (side, NONE) => side,
            (from, to) => filtration.earlier(from, to),
        };
        components.join(extremum, elder);
        BranchEnd { extremum, saddle, elder, beyond }
    };
    finite.into_iter().map(end).collect()
}

/// Notes for each component that touches a vertex, by its eldest extremum, where it does: at the earliest neighbour.
fn note_sides<G: Domain, S: Scalar, D: Direction>(
    domain: G,
    filtration: &Filtration<'_, S, D>,
    vertex: u32,
    sides: &mut [u32],
    mut component: impl FnMut(u32) -> u32,
) {
    let mut for_each_earlier = |note: &mut dyn FnMut(&mut u32, u32)| {
        domain.for_each_neighbor(vertex as usize, |u| {
            let u = u as u32;
            if filtration.precedes(u, vertex) {
                note(&mut sides[component(u) as usize], u);
            }
        });
    };
    for_each_earlier(&mut |side, _| *side = NONE);
    for_each_earlier(&mut |side, u| *side = if *side == NONE { u } else { filtration.earlier(u, *side) });
}

/// Whether a vertex with this basin enters.
pub(crate) fn enters(basin: u32) -> bool {
    basin != OUTSIDE
}
