//! The branch decomposition of a field: each extremum with its basin, and the branch its own grows out of.
//!
//! Merge trees, segmentations and simplified fields are all read off from it. Extrema are numbered by vertex index.
//! Pascucci, Cole-McLaughlin & Scorzelli (2004), "Multi-resolution computation and presentation of contour trees".

use crate::domain::Domain;
use crate::filtration::{Direction, Filtration};
use crate::pairing::{Merge, Merges, UnionFind, steepest_descent};
use crate::scalar::Scalar;

/// A branch ends at a saddle.
#[derive(Debug, Clone, Copy)]
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
    /// For each vertex the extremum whose basin it is in, if it enters.
    pub(crate) basins: Vec<Option<u32>>,
    /// The branches that end, in the order in which they do.
    pub(crate) ends: Vec<BranchEnd>,
    /// The others, with the last vertex to enter.
    pub(crate) essential: Vec<(u32, u32)>,
}

impl Branches {
    pub(crate) fn new<G: Domain, S: Scalar, D: Direction>(domain: G, filtration: &Filtration<'_, S, D>) -> Self {
        let Merges { finite, essential } = domain.merges(filtration);
        let descent = steepest_descent(domain, filtration);
        let basins: Vec<_> = (0..domain.vertex_count() as u32).map(|v| descent.basin_if_any(v)).collect();
        let extrema = descent.extrema().to_vec();
        let number = |vertex| extrema.binary_search(&vertex).expect("what merges is an extremum") as u32;

        let mut components = UnionFind::new(extrema.len());
        // Of several that end at one saddle the elder first, so that each finds the eldest of all.
        let merges = filtration.sorted(&filtration.sorted(&finite, |merge| merge.extremum), |merge| merge.saddle);
        let (mut sides, mut noted) = (vec![None; extrema.len()], None);
        let ends = merges.into_iter().map(|Merge { extremum, saddle, towards }| {
            if noted.replace(saddle) != Some(saddle) {
                note_sides(domain, filtration, saddle, &mut sides, |u| Some(components.find(basins[u as usize]?)));
            }
            let (extremum, elder) = (number(extremum), components.find(number(towards)));
            let side = sides[elder as usize];
            let beyond = side.and_then(|u: u32| basins[u as usize]).unwrap_or(elder);
            // From now on the younger component is a part of the elder one.
            sides[elder as usize] =
                side.into_iter().chain(sides[extremum as usize]).reduce(|u, v| filtration.earlier(u, v));
            components.join(extremum, elder);
            BranchEnd { extremum, saddle, elder, beyond }
        });
        let ends = ends.collect();
        let essential = essential.into_iter().map(|(extremum, last)| (number(extremum), last)).collect();
        Self { ends, essential, basins, extrema }
    }

    /// How long a branch lives.
    pub(crate) fn persistence<S: Scalar, D>(&self, filtration: &Filtration<'_, S, D>, end: &BranchEnd) -> S::Width
    where
        D: Direction,
    {
        filtration.value(self.extrema[end.extremum as usize]).width(filtration.value(end.saddle))
    }

    /// The branches that end after living no longer than a threshold.
    pub(crate) fn short<S: Scalar, D: Direction>(
        &self,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> impl DoubleEndedIterator<Item = &BranchEnd> {
        self.ends.iter().filter(move |end| self.persistence(filtration, end) <= threshold)
    }

    /// For each extremum the saddle up to which its basin must be filled so that no short branch is left.
    pub(crate) fn fill_levels<S: Scalar, D: Direction>(
        &self,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> Vec<Option<u32>> {
        let mut levels = vec![None; self.extrema.len()];
        // Later saddles first: a short branch on a short branch is filled as far as that.
        for end in self.short(filtration, threshold).rev() {
            levels[end.extremum as usize] = levels[end.elder as usize].or(Some(end.saddle));
        }
        levels
    }

    /// The field with all short branches filled up; every value changes by the threshold at most.
    pub(crate) fn filled<S: Scalar, D: Direction>(
        &self,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> Vec<S> {
        let levels = self.fill_levels(filtration, threshold);
        let fill = |(v, &basin): (u32, &Option<u32>)| {
            let level = basin.and_then(|basin| levels[basin as usize]);
            filtration.value(level.map_or(v, |saddle| filtration.later(v, saddle)))
        };
        (0..).zip(&self.basins).map(fill).collect()
    }
}

/// Notes for each component that touches a vertex, by its eldest extremum, where it does: at the earliest neighbour.
fn note_sides<G: Domain, S: Scalar, D: Direction>(
    domain: G,
    filtration: &Filtration<'_, S, D>,
    vertex: u32,
    sides: &mut [Option<u32>],
    mut component: impl FnMut(u32) -> Option<u32>,
) {
    let mut for_each_earlier = |note: &mut dyn FnMut(&mut Option<u32>, u32)| {
        domain.for_each_neighbor(vertex as usize, |u| {
            let u = u as u32;
            if filtration.precedes(u, vertex)
                && let Some(component) = component(u)
            {
                note(&mut sides[component as usize], u);
            }
        });
    };
    for_each_earlier(&mut |side, _| *side = None);
    for_each_earlier(&mut |side, u| *side = Some(side.map_or(u, |v| filtration.earlier(u, v))));
}
