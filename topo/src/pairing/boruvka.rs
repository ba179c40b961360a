//! The elder rule on the basins of a part of a domain: which pairs are final whatever the other parts are.
//!
//! Borůvka's idea (1926) of letting all components act at once, with the elder rule for its direction: the lowest join of a basin is where
//! its component first meets another. If the basin beyond is elder, this one dies there, whatever happens elsewhere; otherwise it waits. In
//! a round every basin whose lowest join leads to an elder one is paired and merged into it, and joins that have become inner ones are
//! dropped; basins that something shared with other parts enters first stay. Each round pairs at least one basin, the first ones more than
//! half; when one pairs less, what is left is left.

use super::joins::Join;
use super::merges::{Merge, NONE};
use super::union_find::UnionFind;
use crate::filtration::{Direction, Filtration};
use crate::scalar::Scalar;

/// So few joins are as well left as they are.
const FEW_JOINS: usize = 64;

/// A round must pair one basin in this many, or it was the last.
const SLOW_ROUND: usize = 2;

/// Pairs the basins whose components no *open* vertex enters before they die, given open vertices with their basins: what
/// becomes of each basin, where those that are not paired have no end; the basins grouped by what they have merged into;
/// and the joins between the groups that are left. Some that could be paired may be left, too.
pub(crate) fn pair_inside<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    extrema: &[u32],
    mut joins: Vec<Join>,
    open: &[(u32, u32)],
) -> (Vec<Merge>, UnionFind, Vec<Join>) {
    let mut basins = Basins::new(filtration, extrema);
    basins.open(open);
    let mut active: Vec<u32> = (0..extrema.len() as u32).collect();
    while joins.len() > FEW_JOINS {
        let count = active.len();
        let paired = basins.round(&mut active, &joins);
        joins.retain_mut(|join| basins.relabel(join));
        if paired == 0 || paired * SLOW_ROUND < count {
            break;
        }
    }
    (basins.merges, basins.merged, joins)
}

struct Basins<'a, S, D> {
    filtration: &'a Filtration<'a, S, D>,
    births: Vec<S>,
    merged: UnionFind,
    /// For each basin its lowest join, as a place among the joins, and the value there.
    lowest: Vec<(u32, S)>,
    /// What becomes of each basin.
    merges: Vec<Merge>,
    /// For each basin the first open vertex to enter it, or [`NONE`]. Empty if no vertex is open.
    opened: Vec<u32>,
}

impl<'a, S: Scalar, D: Direction> Basins<'a, S, D> {
    fn new(filtration: &'a Filtration<'a, S, D>, extrema: &[u32]) -> Self {
        let births: Vec<S> = extrema.iter().map(|&extremum| filtration.value(extremum)).collect();
        let lowest = births.iter().map(|&birth| (NONE, birth)).collect();
        let merges = extrema.iter().map(|&extremum| Merge::born(extremum)).collect();
        Self { filtration, births, merged: UnionFind::new(extrema.len()), lowest, merges, opened: Vec::new() }
    }

    /// Notes open vertices.
    fn open(&mut self, open: &[(u32, u32)]) {
        self.opened = vec![NONE; self.births.len()];
        for &(basin, vertex) in open {
            self.note_open(basin, vertex);
        }
    }

    fn note_open(&mut self, basin: u32, vertex: u32) {
        let first = &mut self.opened[basin as usize];
        *first = if *first == NONE { vertex } else { self.filtration.earlier(*first, vertex) };
    }

    /// Whether an open vertex enters a basin before a saddle.
    fn is_open_before(&self, basin: u32, saddle: u32) -> bool {
        let first = self.opened.get(basin as usize).copied().unwrap_or(NONE);
        first != NONE && self.filtration.precedes(first, saddle)
    }

    /// Merges every basin whose lowest join leads to an elder one; returns how many. Basins that cannot merge any more,
    /// because they have or because they touch nothing, cease to be active.
    fn round(&mut self, active: &mut Vec<u32>, joins: &[Join]) -> usize {
        for &basin in active.iter() {
            self.lowest[basin as usize].0 = NONE;
        }
        self.find_lowest(joins);
        let mut paired = 0;
        active.retain(|&basin| {
            let (place, _) = self.lowest[basin as usize];
            // What is open at its lowest join stays so, since later joins are higher.
            let may_merge = place != NONE && !self.is_open_before(basin, joins[place as usize].saddle);
            let merges = may_merge && self.try_merge(basin, &joins[place as usize]);
            paired += usize::from(merges);
            may_merge && !merges
        });
        paired
    }

    fn find_lowest(&mut self, joins: &[Join]) {
        for (join, place) in joins.iter().zip(0..) {
            let value = self.filtration.value(join.saddle);
            for basin in join.basins {
                let lowest = &mut self.lowest[basin as usize];
                // Saddles come by rising index. Written in any case, as no branch could be foretold.
                let is_lower = (lowest.0 == NONE) | D::precedes_lower_index(value, lowest.1);
                *lowest = if is_lower { (place, value) } else { *lowest };
            }
        }
    }

    /// Merges a basin across its lowest join if an elder one lies beyond.
    fn try_merge(&mut self, basin: u32, lowest: &Join) -> bool {
        let [a, b] = lowest.basins;
        let beyond = if a == basin { b } else { a };
        let dies = self.is_elder(beyond, basin);
        if dies {
            self.merge(basin, beyond, lowest.saddle);
        }
        dies
    }

    /// Replaces basins by what they have merged into; whether the join still joins two.
    fn relabel(&mut self, join: &mut Join) -> bool {
        join.basins = join.basins.map(|basin| self.merged.find(basin));
        join.basins[0] != join.basins[1]
    }

    fn merge(&mut self, younger: u32, towards: u32, saddle: u32) {
        let elder = self.merged.find(towards);
        self.merged.join(younger, elder);
        if let Some(&open) = self.opened.get(younger as usize)
            && open != NONE
        {
            self.note_open(elder, open);
        }
        let towards = self.merges[towards as usize].extremum;
        let merge = &mut self.merges[younger as usize];
        (merge.end, merge.towards) = (saddle, towards);
    }

    /// Whether basin `a` is elder than basin `b`. Basins are numbered as their extrema are.
    fn is_elder(&self, a: u32, b: u32) -> bool {
        let (birth_a, birth_b) = (self.births[a as usize], self.births[b as usize]);
        if a < b { D::precedes_higher_index(birth_a, birth_b) } else { D::precedes_lower_index(birth_a, birth_b) }
    }
}
