//! The branch decomposition of a field: each extremum with its basin, and the branch its own grows out of.
//!
//! Merge trees, segmentations and simplified fields are all read off from it. Extrema are numbered by vertex index.
//! Pascucci, Cole-McLaughlin & Scorzelli (2004), "Multi-resolution computation and presentation of contour trees".

use crate::basins;
use crate::merges::Merges;
use crate::union_find::UnionFind;
use crate::{Direction, Domain, Filtration, Scalar};

/// A branch ends at a saddle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ending {
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
    pub(crate) endings: Vec<Ending>,
    /// The others, with the last vertex to enter.
    pub(crate) essential: Vec<(u32, u32)>,
}

impl Branches {
    pub(crate) fn new<G: Domain, S: Scalar, D: Direction>(domain: G, filtration: &Filtration<'_, S, D>) -> Self {
        let Merges { finite, essential } = domain.merges(filtration);
        let descent = basins::steepest(domain, filtration);
        let basins: Vec<_> = (0..domain.vertex_count() as u32).map(|v| descent.basin_if_any(v)).collect();
        let extrema = descent.extrema().to_vec();
        let number = |vertex| extrema.binary_search(&vertex).expect("what merges is an extremum") as u32;

        let mut components = UnionFind::new(extrema.len());
        // Of several that end at one saddle the elder first, so that each finds the eldest of all.
        let merges = filtration.sorted(&filtration.sorted(&finite, |merge| merge.extremum), |merge| merge.saddle);
        // A saddle at which many meet is looked around once: they all find the same elder there.
        let mut spill: Option<Ending> = None;
        let endings = merges.into_iter().map(|merge| {
            let (extremum, elder) = (number(merge.extremum), components.find(number(merge.towards)));
            let beyond = match spill {
                Some(last) if last.saddle == merge.saddle => last.beyond,
                _ => {
                    let mut is_elder = |u: u32| basins[u as usize].is_some_and(|basin| components.find(basin) == elder);
                    let neighbor = earliest_neighbor(domain, filtration, merge.saddle, &mut is_elder);
                    basins[neighbor as usize].unwrap_or(elder)
                }
            };
            components.join(extremum, elder);
            *spill.insert(Ending { extremum, saddle: merge.saddle, elder, beyond })
        });
        let endings = endings.collect();
        let essential = essential.into_iter().map(|(extremum, last)| (number(extremum), last)).collect();
        Self { endings, essential, basins, extrema }
    }

    /// How long a branch lives.
    pub(crate) fn persistence<S: Scalar, D>(&self, filtration: &Filtration<'_, S, D>, ending: &Ending) -> S::Width
    where
        D: Direction,
    {
        filtration.value(self.extrema[ending.extremum as usize]).width(filtration.value(ending.saddle))
    }

    /// The branches that end after living no longer than a threshold.
    pub(crate) fn short<S: Scalar, D: Direction>(
        &self,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> impl DoubleEndedIterator<Item = &Ending> {
        self.endings.iter().filter(move |ending| self.persistence(filtration, ending) <= threshold)
    }

    /// For each extremum the saddle up to which its basin must be filled so that no short branch is left.
    pub(crate) fn fill_levels<S: Scalar, D: Direction>(
        &self,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> Vec<Option<u32>> {
        let mut levels = vec![None; self.extrema.len()];
        // Later saddles first: a short branch on a short branch is filled as far as that.
        for ending in self.short(filtration, threshold).rev() {
            levels[ending.extremum as usize] = levels[ending.elder as usize].or(Some(ending.saddle));
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

/// The earliest of the earlier neighbours of a vertex for which something holds; the vertex itself if there is none.
fn earliest_neighbor<G: Domain, S: Scalar, D: Direction>(
    domain: G,
    filtration: &Filtration<'_, S, D>,
    vertex: u32,
    holds: &mut impl FnMut(u32) -> bool,
) -> u32 {
    let mut earliest = vertex;
    domain.for_each_neighbor(vertex as usize, |u| {
        if filtration.precedes(u as u32, earliest) && holds(u as u32) {
            earliest = u as u32;
        }
    });
    earliest
}
