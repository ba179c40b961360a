//! The elder rule on basins and their joins, the earliest join first.
//!
//! Basins that touch at saddles form a small graph, and this is Kruskal's algorithm (1956) on it: a join between two components ends the
//! younger one. Only joins are put in order, never the vertices (see [`by_value`]).

use super::by_value;
use super::merges::Merge;
use super::union_find::UnionFind;
use crate::filtration::{Direction, Filtration};
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
    // First, as sorting takes most memory.
    let order = by_value::in_order(filtration, joins.len(), |place| joins[place as usize].saddle);
    let births: Vec<S> = extrema.iter().map(|&extremum| filtration.value(extremum)).collect();
    let is_elder = |a: u32, b: u32| enters_before::<S, D>(&births, a, b);
    let mut components = Components::new(extrema);
    let mut in_order = Vec::with_capacity(extrema.len());
    for &place in order.chunks(BLOCK).take_while(|_| !filtration.stops()).flatten() {
        let Join { saddle, basins } = joins[place as usize];
        in_order.extend(components.join(saddle, basins, is_elder));
    }
    Ended { merges: components.merges, in_order, components: components.merged }
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
        let merges = extrema.iter().map(|&extremum| Merge::born(extremum)).collect();
        Self { extrema, merged: UnionFind::new(extrema.len()), merges }
    }

    /// Ends the younger one of the components of two basins at a saddle and tells which it is; none if they are the same.
    #[inline]
    pub(super) fn join(&mut self, saddle: u32, basins: [u32; 2], is_elder: impl Fn(u32, u32) -> bool) -> Option<u32> {
        let [a, b] = basins.map(|basin| self.merged.find(basin));
        if a == b {
            return None;
        }
        let (elder, younger) = if is_elder(a, b) { (a, b) } else { (b, a) };
        self.merged.join(younger, elder);
        let [extremum, towards] = [younger, elder].map(|basin| self.extrema[basin as usize]);
        self.merges[younger as usize] = Merge { extremum, end: saddle, towards };
        Some(younger)
    }
}
