//! The best cones for one number of them: `refined`.
//!
//! The area-weighted variance of the log scale factor is minimised over cones *and* curvatures. Sets grow by
//! matching pursuit from both sides ([`grow`](crate::grow), [`eliminate`](crate::exchange::eliminate)); then *rounds*
//! look over the whole surface for better places ([`SwapTable::proposals`]), solve for the most promising ones only, and
//! exchange cones with all vertices solved for so far. Adding some cones more and eliminating them again gets out of
//! local minima. All of it is back-solves on one factor, a few for each cone, and dense work below their cost.

use crate::exchange::{eliminate, exchange};
use crate::grow::{Rule, grow, start};
use crate::reduced::{Fitted, Reduced};
use crate::swap::SwapTable;

/// Rounds end when the energy falls by less than this share.
const LEAST_GAIN: f64 = 0.003;
/// So many rounds at most for each start; in trials eight were the most.
const ROUNDS: usize = 12;
/// New candidates of a round: more find little, since the next round asks again.
const NEW_CANDIDATES: usize = 8;
/// So many times cones are added and eliminated again.
const RESTARTS: usize = 4;
/// Up to this number of cones a start by estimated gain pays too.
const FEW: usize = 8;

/// The best set of so many cones that was found (fewer only where the surface has no more inner vertices). About
/// 70, 125, 236 and 389 back-solves for 4, 8, 16 and 32 cones.
pub fn refined(reduced: &mut Reduced, count: usize) -> Fitted {
    let first = start(reduced);
    if first.cones.len() > count {
        let cones = first.cones[..count].to_vec();
        return reduced.fit(&cones);
    }
    if count == 0 {
        return first;
    }
    let mut best = improve(reduced, first.clone(), count);
    best = restart(reduced, best, count);
    best
}

fn improve(reduced: &mut Reduced, first: Fitted, count: usize) -> Fitted {
    let forward = grow(reduced, first.clone(), count, Rule::Gradient);
    let twice = if reduced.operators().is_bordered() { (2 * count).max(12) } else { 2 * count };
    let beyond = grow(reduced, forward.clone(), twice, Rule::Gradient);
    let backward = eliminate(reduced, exchange(reduced, beyond), count);
    let mut starts = vec![forward, backward];
    if count <= FEW {
        starts.push(grow(reduced, first, count, Rule::Gain));
    }
    let ends: Vec<Fitted> = starts.into_iter().map(|set| rounds(reduced, set, ROUNDS)).collect();
    ends.into_iter().reduce(better).expect("there are starts")
}

/// Adds some cones and eliminates as many, as long as that helps.
fn restart(reduced: &mut Reduced, mut best: Fitted, count: usize) -> Fitted {
    for _ in 0..RESTARTS {
        let more = grow(reduced, best.clone(), count + (count / 4).max(2), Rule::Gain);
        let fewer = eliminate(reduced, exchange(reduced, more), count);
        let next = rounds(reduced, fewer, 2);
        if !next.is_better_than(&best, LEAST_GAIN) {
            return better(best, next);
        }
        best = next;
    }
    best
}

/// Exchanges with the pool, and in rounds with new candidates from all over the surface.
pub(crate) fn rounds(reduced: &mut Reduced, set: Fitted, most: usize) -> Fitted {
    let mut set = exchange(reduced, set);
    for _ in 0..most {
        let proposals = SwapTable::new(reduced, &set).proposals();
        let helpful = proposals.iter().filter(|swap| swap.change < 0.0).map(|swap| swap.coming);
        let mut new = Vec::new();
        for v in helpful.filter(|&v| !reduced.knows(v)) {
            if new.len() < NEW_CANDIDATES && !new.contains(&v) {
                new.push(v);
            }
        }
        if new.is_empty() {
            break;
        }
        reduced.add(&new);
        let next = exchange(reduced, set.clone());
        let is_over = !next.is_better_than(&set, LEAST_GAIN);
        set = next;
        if is_over {
            break;
        }
    }
    set
}

fn better(a: Fitted, b: Fitted) -> Fitted {
    if b.is_better_than(&a, 0.0) { b } else { a }
}
