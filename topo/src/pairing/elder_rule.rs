//! The elder rule on basins and their joins, the earliest join first.
//!
//! Basins that touch at saddles form a small graph, and this is Kruskal's algorithm (1956) on it: a join between two components ends the
//! younger one. Only joins are put in order, never the vertices (see [`by_value`](super::by_value)).

use super::by_value::by_value;
use super::merges::Merge;
use super::union_find::UnionFind;
use crate::filtration::{Direction, Filtration, Kind};
use crate::parallel::BLOCK;
use crate::scalar::Scalar;

/// A vertex at which two basins touch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Join {
    pub(crate) saddle: u32,
    pub(crate) basins: [u32; 2],
}

/// What becomes of the basins.
#[derive(Debug)]
pub(crate) struct Ended {
    /// The end of each basin; the eldest have none yet.
    pub(crate) merges: Vec<Merge>,
    /// Those that end, in the order in which they do.
    pub(crate) in_order: Vec<u32>,
    /// The basins of each connected component, the eldest at the root.
    pub(crate) components: UnionFind,
}

/// Pairs basins given their extrema, by rising index, and their joins, by rising index of the saddle. Nonsense if the work is stopped.
pub(crate) fn pair<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    extrema: &[u32],
    joins: &[Join],
) -> Ended {
    let mut merges: Vec<Merge> = extrema.iter().map(|&extremum| Merge::born(extremum)).collect();
    let births: Vec<S> = extrema.iter().map(|&extremum| filtration.value(extremum)).collect();
    // Basins are numbered as their extrema are.
    let is_elder = |a: u32, b: u32| {
        let (birth_a, birth_b) = (births[a as usize], births[b as usize]);
        if a < b { D::precedes_higher_index(birth_a, birth_b) } else { D::precedes_lower_index(birth_a, birth_b) }
    };
    let mut components = UnionFind::new(extrema.len());
    let mut in_order = Vec::with_capacity(extrema.len());
    for_each_in_order(filtration, joins, |&Join { saddle, basins }| {
        let [a, b] = basins.map(|basin| components.find(basin));
        if a == b {
            return;
        }
        let (elder, younger) = if is_elder(a, b) { (a, b) } else { (b, a) };
        components.join(younger, elder);
        let towards = extrema[elder as usize];
        merges[younger as usize] = Merge { extremum: extrema[younger as usize], end: saddle, towards };
        in_order.push(younger);
    });
    Ended { merges, in_order, components }
}

/// Visits joins in the order in which their saddles enter; not all if the work is stopped.
fn for_each_in_order<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    joins: &[Join],
    mut visit: impl FnMut(&Join),
) {
    let order = by_value(filtration.field(), joins.len(), |place| joins[place as usize].saddle, filtration.watch());
    let mut count = 0usize;
    let mut visit = |place: u32| {
        let goes_on = !count.is_multiple_of(BLOCK) || !filtration.stops();
        count += 1;
        goes_on.then(|| visit(&joins[place as usize]))
    };
    let mut order = order;
    // Backwards the order is the reverse one, ties included.
    let _all = if D::KIND == Kind::Minimum { order.try_for_each(&mut visit) } else { order.rev().try_for_each(&mut visit) };
}
