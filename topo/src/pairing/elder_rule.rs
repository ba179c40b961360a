//! The elder rule on basins and their joins, the earliest join first.
//!
//! Basins that touch at saddles form a small graph, and this is Kruskal's algorithm (1956) on it: a join between two components ends the
//! younger one. Only joins are put in order, never the vertices (see [`joins`](super::joins)).

use super::joins::{Join, Parts};
use super::merges::{BranchEnd, Merge};
use super::union_find::UnionFind;
use crate::filtration::{Direction, Filtration};
use crate::scalar::Scalar;

/// What becomes of the basins.
#[derive(Debug)]
pub(crate) struct Ended {
    /// The end of each basin; the eldest have none yet.
    pub(crate) merges: Vec<Merge>,
    /// The basins of each connected component, the eldest at the root.
    pub(crate) components: UnionFind,
}

/// Pairs basins given their extrema, by rising index, and their joins, by rising index of the saddle. Nonsense if the work is stopped.
pub(crate) fn pair<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    extrema: &[u32],
    joins: Vec<Join>,
) -> Ended {
    let parts = Parts::new(filtration, joins); // first, as it takes most memory
    let births = births(filtration, extrema);
    let is_elder = |a: u32, b: u32| enters_before::<S, D>(&births, a, b);
    let mut merges = born(extrema);
    let mut components = UnionFind::new(extrema.len());
    parts.for_each_saddle(filtration, &mut components, |components, joins| {
        for &Join { saddle, basins } in joins {
            if let Some(met) = meet(components, basins, is_elder) {
                note(&mut merges, extrema, saddle, met);
            }
        }
    });
    Ended { merges, components }
}

/// The branches that end, in the order in which they do, and the basins of each connected component, the eldest at the root; from extrema, by
/// rising index, and joins, by rising index of the saddle. Round each saddle joins lead from the basin of its earliest neighbour to other
/// basins in the order in which the first neighbours in them enter. Nonsense if the work is stopped.
pub(crate) fn branch<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    extrema: &[u32],
    joins: Vec<Join>,
) -> (Vec<BranchEnd>, UnionFind) {
    let parts = Parts::new(filtration, joins);
    let births = births(filtration, extrema);
    let is_elder = |a: u32, b: u32| enters_before::<S, D>(&births, a, b);
    let mut components = UnionFind::new(extrema.len());
    let mut ends = Vec::with_capacity(extrema.len());
    parts.for_each_saddle(filtration, &mut components, |components, joins| match *joins {
        [Join { saddle, basins }] => {
            let [first, second] = basins.map(|basin| components.find(basin));
            if first != second {
                let is_first_elder = is_elder(first, second);
                let (elder, extremum, beyond) =
                    if is_first_elder { (first, second, basins[0]) } else { (second, first, basins[1]) };
                components.join(extremum, elder);
                ends.push(BranchEnd { extremum, saddle, elder, beyond });
            }
        }
        _ => end_branches(components, joins, &is_elder, &mut ends),
    });
    (ends, components)
}

/// Ends all components that meet at a saddle but the eldest.
fn end_branches(
    components: &mut UnionFind,
    joins: &[Join],
    is_elder: &dyn Fn(u32, u32) -> bool,
    ends: &mut Vec<BranchEnd>,
) {
    let Some(&Join { saddle, basins: [earliest, _] }) = joins.first() else { return };
    let basins: Vec<u32> = [earliest].into_iter().chain(joins.iter().map(|join| join.basins[1])).collect();
    // Each component with the place of its first basin.
    let mut met: Vec<(u32, usize)> = basins.iter().map(|&basin| components.find(basin)).zip(0..).collect();
    met.sort_unstable();
    met.dedup_by_key(|&mut (component, _)| component);
    // The elder ones end first, as the younger spill into what they have become.
    met.sort_unstable_by(|&(a, _), &(b, _)| is_elder(b, a).cmp(&is_elder(a, b)));
    let (elder, mut first) = met[0];
    for &(extremum, place) in &met[1..] {
        ends.push(BranchEnd { extremum, saddle, elder, beyond: basins[first] });
        components.join(extremum, elder);
        first = first.min(place);
    }
}

/// The values at the extrema of basins.
fn births<S: Scalar, D: Direction>(filtration: &Filtration<'_, S, D>, extrema: &[u32]) -> Vec<S> {
    extrema.iter().map(|&extremum| filtration.value(extremum)).collect()
}

/// Basins of which only their births are known.
fn born(extrema: &[u32]) -> Vec<Merge> {
    extrema.iter().map(|&extremum| Merge::born(extremum)).collect()
}

/// Puts the younger one of the components of two basins into the other; tells which is younger and which elder, nothing if they are the same.
#[inline]
fn meet(components: &mut UnionFind, basins: [u32; 2], is_elder: impl Fn(u32, u32) -> bool) -> Option<[u32; 2]> {
    let [a, b] = basins.map(|basin| components.find(basin));
    if a == b {
        return None;
    }
    let [younger, elder] = if is_elder(a, b) { [b, a] } else { [a, b] };
    components.join(younger, elder);
    Some([younger, elder])
}

/// Notes that a component has ended in an elder one.
fn note(merges: &mut [Merge], extrema: &[u32], saddle: u32, met: [u32; 2]) {
    let [extremum, towards] = met.map(|basin| extrema[basin as usize]);
    merges[met[0] as usize] = Merge { extremum, end: saddle, towards };
}

/// Whether the extremum of one basin enters before that of another, given their values. Basins are numbered as their extrema are.
pub(super) fn enters_before<S: Scalar, D: Direction>(births: &[S], a: u32, b: u32) -> bool {
    let (birth_a, birth_b) = (births[a as usize], births[b as usize]);
    if a < b { D::precedes_higher_index(birth_a, birth_b) } else { D::precedes_lower_index(birth_a, birth_b) }
}

/// Basins that grow together.
pub(super) struct Components<'a> {
    extrema: &'a [u32],
    merged: UnionFind,
    pub(super) merges: Vec<Merge>,
}

impl<'a> Components<'a> {
    /// Each basin by itself.
    pub(super) fn new(extrema: &'a [u32]) -> Self {
        Self { extrema, merged: UnionFind::new(extrema.len()), merges: born(extrema) }
    }

    /// Ends the younger one of the components of two basins at a saddle and tells which it is; none if they are the same.
    #[inline]
    pub(super) fn join(&mut self, saddle: u32, basins: [u32; 2], is_elder: impl Fn(u32, u32) -> bool) -> Option<u32> {
        let met = meet(&mut self.merged, basins, is_elder)?;
        note(&mut self.merges, self.extrema, saddle, met);
        Some(met[0])
    }
}
