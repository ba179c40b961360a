//! The elder rule on basins, without sorting.
//!
//! Basins joined at saddles form a small graph. Borůvka's idea (1926) of letting all components act at once, with the
//! elder rule for its direction: the lowest join of a basin is where its component first meets another. If the basin
//! beyond is elder, this one dies there, whatever happens elsewhere; otherwise it waits. In a round every basin whose
//! lowest join leads to an elder one is paired and merged into it, and joins that have become inner ones are dropped.
//!
//! Each round pairs at least one basin, the first ones more than half. Young basins in a row can make rounds slow; so
//! when one pairs less than half, the remaining joins are sorted and paired one by one.
//!
//! Of a part of a domain only some pairs are final: those of components that die before anything enters them that is
//! shared with other parts. [`pair_inside`] finds these in the same rounds and leaves the other joins.

use super::merges::{Merge, NONE};
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

/// Below this many joins sorting them is as fast as another round.
const FEW_JOINS: usize = 64;

/// A round must pair one basin in this many, or sorting takes over. Of 2, 3, 4, 10 and always sorting, 2 was fastest on
/// white noise and on smooth noise, 1024² with Freudenthal edges: by 5 and 15 % over 10, by 20 and 30 % over sorting.
const SLOW_ROUND: usize = 2;

/// Pairs basins given their extrema, by rising index, and their joins, by rising index of the saddle: what becomes of each
/// basin, where the eldest have no end yet, and the basins of each connected component, the eldest at the root.
pub(crate) fn pair<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    extrema: &[u32],
    mut joins: Vec<Join>,
) -> (Vec<Merge>, UnionFind) {
    let mut basins = Basins::new(filtration, extrema);
    let mut active: Vec<u32> = (0..extrema.len() as u32).collect();
    while joins.len() > FEW_JOINS && !filtration.stops() {
        let count = active.len();
        let paired = basins.round(&mut active, &joins);
        basins.relabel_all(&mut joins);
        if paired * SLOW_ROUND < count {
            break;
        }
    }
    if !filtration.stops() {
        basins.pair_in_order(&joins);
    }
    (basins.merges, basins.merged)
}

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
        let blocks = joins.chunks(BLOCK).zip((0..).step_by(BLOCK)).take_while(|_| !self.filtration.stops());
        for (join, place) in blocks.flat_map(|(joins, start)| joins.iter().zip(start..)) {
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

    /// Relabels joins and drops those that are inner ones; all if the work is stopped.
    fn relabel_all(&mut self, joins: &mut Vec<Join>) {
        let (mut count, mut stops) = (0usize, false);
        joins.retain_mut(|join| {
            count += 1;
            stops |= count.is_multiple_of(BLOCK) && self.filtration.stops();
            !stops && self.relabel(join)
        });
    }

    /// Replaces basins by what they have merged into; whether the join still joins two.
    fn relabel(&mut self, join: &mut Join) -> bool {
        join.basins = join.basins.map(|basin| self.merged.find(basin));
        join.basins[0] != join.basins[1]
    }

    /// The plain sweep, on the joins that are left.
    fn pair_in_order(&mut self, joins: &[Join]) {
        let filtration = self.filtration;
        let sorted = filtration.sorted(joins, |join| join.saddle);
        for &(mut join) in sorted.chunks(BLOCK).take_while(|_| !filtration.stops()).flatten() {
            if self.relabel(&mut join) {
                let [a, b] = join.basins;
                let (elder, younger) = if self.is_elder(a, b) { (a, b) } else { (b, a) };
                self.merge(younger, elder, join.saddle);
            }
        }
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
