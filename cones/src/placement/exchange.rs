//! Better sets of cones from the pool, without solves.

use std::collections::HashSet;

use geom::VertexId;

use super::energy_model::{ConeSet, EnergyModel};
use super::separation::Separation;
use super::swap_table::{LANES, Rows, Swap, SwapTable};

/// So many of the best swaps are fitted before an exchange is over.
pub(crate) const TRIALS: usize = 6;
/// So many moves that do harm alone are tried as the first of several.
const DETOURS: usize = 20;
/// Swaps are collected up to so many before all but the best are forgotten.
const KEPT: usize = 64;
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

/// As [`exchange`], but none where it comes to a set that another exchange came to: it would end where that one has ended.
pub(crate) fn exchange_anew(
    model: &EnergyModel,
    mut set: ConeSet,
    known: &mut HashSet<Vec<VertexId>>,
) -> Option<ConeSet> {
    while known.insert(in_order(&set)) {
        match best_swap(model, &set) {
            Some(better) => set = better,
            None => return Some(set),
        }
    }
    None
}

/// The cones of a set, whichever came first.
fn in_order(set: &ConeSet) -> Vec<VertexId> {
    let mut cones = set.cones.clone();
    cones.sort_unstable();
    cones
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
    let helpful = swaps(model, set, TRIALS, -LEAST_GAIN * set.energy);
    let mut fitted = helpful.iter().map(|swap| apply(model, set, swap));
    fitted.find(|after| after.is_better_than(set, LEAST_GAIN))
}

fn best_detour(model: &EnergyModel, set: &ConeSet) -> Option<ConeSet> {
    if model.is_over() {
        return None;
    }
    // Most detours lead back to where they came from, or where one before has ended.
    let mut known = HashSet::from([in_order(set)]);
    let swaps = swaps(model, set, DETOURS, f64::INFINITY);
    let mut ends = swaps
        .iter()
        .take_while(|_| !model.is_over())
        .filter_map(|swap| exchange_anew(model, apply(model, set, swap), &mut known));
    ends.find(|end| end.is_better_than(set, LEAST_GAIN))
}

fn apply(model: &EnergyModel, set: &ConeSet, swap: &Swap) -> ConeSet {
    let mut cones = set.cones.clone();
    cones[swap.leaving] = swap.coming;
    model.fit(&cones)
}

/// The best moves of a cone to another member of the pool, so many at most, that change the energy by less than `below`; the most promising first.
fn swaps(model: &EnergyModel, set: &ConeSet, count: usize, below: f64) -> Vec<Swap> {
    let table = SwapTable::new(model, set);
    let separation = Separation::new(model.operators(), &set.cones);
    let (mut swaps, mut most) = (Vec::new(), below);
    let mut rows = Rows::default();
    let is_other = |v: &VertexId| separation.is_open(*v) && !set.cones.contains(v);
    let others: Vec<VertexId> = model.pool().iter().copied().filter(is_other).collect();
    for members in others.chunks(LANES) {
        table.fill_for_members(members, &mut rows);
        for (lane, &coming) in members.iter().enumerate() {
            let swap = |(leaving, changes): (usize, &[f64; LANES])| {
                let change = changes[lane];
                (change < most && separation.admits(coming, leaving)).then_some(Swap { change, leaving, coming })
            };
            swaps.extend(rows.change.iter().enumerate().filter_map(swap));
            if swaps.len() >= KEPT {
                keep_most_promising(&mut swaps, count);
                most = swaps.last().map_or(below, |worst| worst.change);
            }
        }
    }
    keep_most_promising(&mut swaps, count);
    swaps
}

/// Leaves so many of the best swaps, the best first, ties in their order.
fn keep_most_promising(swaps: &mut Vec<Swap>, count: usize) {
    swaps.sort_by(|a, b| a.change.total_cmp(&b.change));
    swaps.truncate(count);
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

#[cfg(test)]
mod tests {
    use geom::{Metric, shapes};

    use super::*;
    use crate::field::Operators;
    use crate::placement::refined;

    #[test]
    fn detours_that_are_not_gone_twice_lead_where_all_of_them_lead() {
        for shape in [shapes::hare(700), shapes::torus(2, 700), shapes::terrain(700, 3)] {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let mut model = EnergyModel::new(&operators, &mesh);
            // The pool of a search, and cones that are no end of it.
            refined(&mut model, 8);
            let some: Vec<VertexId> = model.pool().iter().copied().step_by(5).take(6).collect();
            let mut set = exchange(&model, model.fit(&some));
            loop {
                let all = swaps(&model, &set, DETOURS, f64::INFINITY)
                    .into_iter()
                    .map(|swap| exchange(&model, apply(&model, &set, &swap)));
                let by_all = all.into_iter().find(|end| end.is_better_than(&set, LEAST_GAIN));
                assert_eq!(best_detour(&model, &set), by_all);
                let Some(better) = by_all else { break };
                set = better;
            }
        }
    }
}
