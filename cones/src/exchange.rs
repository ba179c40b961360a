//! Better sets of cones from the pool, without solves.

use crate::crowd::Crowd;
use crate::reduced::{Fitted, Reduced};
use crate::swap::{Row, Swap, SwapTable};

/// So many of the best swaps are fitted before an exchange is over.
const TRIALS: usize = 6;
/// A swap must lower the energy by this share.
const LEAST_GAIN: f64 = 1e-4;

/// Moves cones to other members of the pool, one at a time, each time what brings most, until nothing helps.
pub(crate) fn exchange(reduced: &Reduced, mut set: Fitted) -> Fitted {
    while let Some(better) = best_swap(reduced, &set) {
        set = better;
    }
    set
}

fn best_swap(reduced: &Reduced, set: &Fitted) -> Option<Fitted> {
    let table = SwapTable::new(reduced, set);
    let crowd = Crowd::new(reduced, &set.cones);
    let mut swaps = Vec::new();
    let mut row = Row::default();
    for &coming in reduced.pool().iter().filter(|&&v| crowd.is_open(v) && !set.cones.contains(&v)) {
        table.fill_for_member(coming, &mut row);
        let helps = |(leaving, &change): (usize, &f64)| {
            let helps = change < -LEAST_GAIN * set.energy && crowd.admits(coming, leaving);
            helps.then_some(Swap { change, leaving, coming })
        };
        swaps.extend(row.change.iter().enumerate().filter_map(helps));
    }
    swaps.sort_by(|a, b| a.change.total_cmp(&b.change));
    swaps.iter().take(TRIALS).find_map(|swap| {
        let mut cones = set.cones.clone();
        cones[swap.leaving] = swap.coming;
        let after = reduced.fit(&cones);
        after.is_better_than(set, LEAST_GAIN).then_some(after)
    })
}

/// Takes cones away, one at a time whichever is missed least, until so many are left.
pub(crate) fn eliminate(reduced: &Reduced, mut set: Fitted, count: usize) -> Fitted {
    while set.cones.len() > count {
        set = drop_cheapest(reduced, &set);
    }
    set
}

/// Takes away the cone that is missed least, by an exact fit of the few that seem to be.
pub(crate) fn drop_cheapest(reduced: &Reduced, set: &Fitted) -> Fitted {
    let table = SwapTable::new(reduced, set);
    let mut order: Vec<usize> = (0..set.cones.len()).collect();
    order.sort_by(|&i, &j| table.removal(i).total_cmp(&table.removal(j)));
    let without = |&leaving: &usize| {
        let mut cones = set.cones.clone();
        cones.remove(leaving);
        reduced.fit(&cones)
    };
    let candidates = order.iter().take(3).map(without);
    candidates.reduce(|a, b| if b.is_better_than(&a, 0.0) { b } else { a }).unwrap_or_else(|| set.clone())
}
