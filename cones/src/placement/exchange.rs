//! Better sets of cones from the pool, without solves.

use super::energy_model::{ConeSet, EnergyModel};
use super::separation::Separation;
use super::swap_table::{Row, Swap, SwapTable};

/// So many of the best swaps are fitted before an exchange is over.
pub(crate) const TRIALS: usize = 6;
/// So many moves that do harm alone are tried as the first of several.
const DETOURS: usize = 20;
/// On a coarse level detours are tried for so many cones at most. With 16 and more they take half of the time, and gain nothing
/// that is left once the cones are polished; with 8 they were worth a tenth on `rabbit_46646`.
const MOST_ON_LEVEL: usize = 12;
/// A swap must lower the energy by this share.
const LEAST_GAIN: f64 = 1e-4;

/// Moves cones to other members of the pool, one at a time, each time what brings most, until nothing helps.
pub(crate) fn exchange(model: &EnergyModel, mut set: ConeSet) -> ConeSet {
    while let Some(better) = best_swap(model, &set) {
        set = better;
    }
    set
}

/// As [`exchange`], and where no single move helps, pairs of moves: the least harmful ones, each followed by an exchange.
pub(crate) fn exchange_deeply(model: &EnergyModel, set: ConeSet) -> ConeSet {
    let mut set = exchange(model, set);
    if model.operators().is_coarse() && set.cones.len() > MOST_ON_LEVEL {
        return set;
    }
    while let Some(better) = best_detour(model, &set) {
        set = better;
    }
    set
}

fn best_swap(model: &EnergyModel, set: &ConeSet) -> Option<ConeSet> {
    if model.is_over() {
        return None;
    }
    let swaps = swaps(model, set);
    let helpful = swaps.iter().take(TRIALS).take_while(|swap| swap.change < -LEAST_GAIN * set.energy);
    let mut fitted = helpful.map(|swap| apply(model, set, swap));
    fitted.find(|after| after.is_better_than(set, LEAST_GAIN))
}

fn best_detour(model: &EnergyModel, set: &ConeSet) -> Option<ConeSet> {
    if model.is_over() {
        return None;
    }
    let swaps = swaps(model, set);
    let mut ends = swaps
        .iter()
        .take(DETOURS)
        .take_while(|_| !model.is_over())
        .map(|swap| exchange(model, apply(model, set, swap)));
    ends.find(|end| end.is_better_than(set, LEAST_GAIN))
}

fn apply(model: &EnergyModel, set: &ConeSet, swap: &Swap) -> ConeSet {
    let mut cones = set.cones.clone();
    cones[swap.leaving] = swap.coming;
    model.fit(&cones)
}

/// The best moves of a cone to another member of the pool, the most promising first.
fn swaps(model: &EnergyModel, set: &ConeSet) -> Vec<Swap> {
    let table = SwapTable::new(model, set);
    let separation = Separation::new(model.operators(), &set.cones);
    let mut swaps = Vec::new();
    let mut row = Row::default();
    for &coming in model.pool().iter().filter(|&&v| separation.is_open(v) && !set.cones.contains(&v)) {
        table.fill_for_member(coming, &mut row);
        let swap = |(leaving, &change)| separation.admits(coming, leaving).then_some(Swap { change, leaving, coming });
        swaps.extend(row.change.iter().enumerate().filter_map(swap));
    }
    most_promising(swaps)
}

/// The best swaps, the best first, ties in their order: no more are looked at.
fn most_promising(swaps: Vec<Swap>) -> Vec<Swap> {
    let mut ranked: Vec<(usize, Swap)> = swaps.into_iter().enumerate().collect();
    let before = |a: &(usize, Swap), b: &(usize, Swap)| a.1.change.total_cmp(&b.1.change).then(a.0.cmp(&b.0));
    if ranked.len() > DETOURS {
        ranked.select_nth_unstable_by(DETOURS, before);
        ranked.truncate(DETOURS);
    }
    ranked.sort_unstable_by(before);
    ranked.into_iter().map(|(_, swap)| swap).collect()
}

/// Takes cones away, one at a time whichever is missed least, until so many are left, exchanging after each.
pub(crate) fn eliminate(model: &EnergyModel, mut set: ConeSet, count: usize) -> ConeSet {
    while set.cones.len() > count {
        set = exchange(model, drop_cheapest(model, &set));
    }
    set
}

/// Takes away the cone that is missed least, by an exact fit of the few that seem to be.
pub(crate) fn drop_cheapest(model: &EnergyModel, set: &ConeSet) -> ConeSet {
    let table = SwapTable::new(model, set);
    let mut order: Vec<usize> = (0..set.cones.len()).collect();
    order.sort_by(|&i, &j| table.removal(i).total_cmp(&table.removal(j)));
    order.truncate(if model.is_over() { 1 } else { 3 });
    let without = |&leaving: &usize| {
        let mut cones = set.cones.clone();
        cones.remove(leaving);
        model.fit(&cones)
    };
    let candidates = order.iter().map(without);
    candidates.reduce(|a, b| if b.is_better_than(&a, 0.0) { b } else { a }).unwrap_or_else(|| set.clone())
}
