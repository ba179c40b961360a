//! The smallest square for some pieces, and tiles for pieces of a given size.
//!
//! Pieces are placed greedily on a grid, one after the other in some order, each in the turn and at the place that a rule
//! likes best, until all are placed or one fits nowhere. What side that needs depends on the order, on the rule and on the
//! turn of the first: so many *plans* are tried on a coarse grid, each only for whether it goes below the best side so far.
//! The piece that fits nowhere comes earlier in the next plan ("squeaky wheel", Joslin & Clements 1999). Only the best plan is
//! carried out on a fine grid. How much is tried is bounded by the work, counted in words of bits, not by the time: also that of
//! a single plan, since one for hundreds of pieces may take as much as is allowed for all.

use std::collections::{HashSet, VecDeque};
use std::sync::Arc;

use geom::{Interrupted, Watch};
use num_complex::Complex64;
use rayon::prelude::*;

use super::bin::{Bin, Place, Rule};
use super::island_place::quarter;
use super::piece::Piece;
use super::raster::Shape;

/// The side of the coarse grid for each square root of a piece, and its bounds; with 128 for few, bones fill .688 for .728 and the
/// teapot .663 for .682 in the same time. For comparing one side is enough.
const COARSE: f64 = 18.0;
const COARSE_RANGE: [f64; 2] = [256.0, 384.0];
const ROUGH: f64 = 128.0;
/// The side of the fine grid. Islands lose up to two cells where they meet, .2 % of the side.
pub(super) const FINE: f64 = 1024.0;
/// So many plans are tried at a time; a number of its own, so that what is found does not depend on that of threads.
const BATCH: usize = 8;
/// The share of the square that islands are expected to fill at first.
const EXPECTED: f64 = 0.6;

/// Sides of pieces whose areas sum to 1 that differ by less are the same.
const ROUNDING: f64 = 1e-12;

/// How much is tried.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Plans are tried while no more words of bits were looked at.
    work: u64,
    is_fine: bool,
}

impl Effort {
    /// For what is kept: .30 s on one thread for bones, 26 islands, .59 s for 300 triangles.
    pub(super) const FULL: Self = Self { work: 60_000_000, is_fine: true };
    /// For comparing.
    pub(super) const ROUGH: Self = Self { work: 1_500_000, is_fine: false };
    /// For choosing what is worth comparing: the first plan that fits.
    pub(super) const ONCE: Self = Self { work: 0, is_fine: false };
}

/// Where a piece goes: z ↦ `turn` z + `to` in the pieces' unit, on a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Put {
    pub(super) turn: Complex64,
    pub(super) to: Complex64,
    pub(super) tile: u32,
}

/// A square grid, and the pieces as cells of it in all of their turns.
pub(super) struct Level {
    /// Cells for a unit.
    scale: f64,
    /// Cells that are kept between islands; half as many at the border.
    margin: f64,
    /// How many cells beside the margin the square may have at most.
    most: usize,
    shapes: Vec<Arc<[Shape]>>,
}

/// How pieces are placed.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Plan {
    order: Vec<usize>,
    /// The turn of each, where it is not to be chosen.
    turns: Vec<Option<usize>>,
    is_low: bool,
}

/// Words of bits that were looked at, and how many may be.
#[derive(Clone, Copy, Debug)]
struct Work {
    done: u64,
    most: u64,
}

/// Why a plan was not carried out.
#[derive(Clone, Copy, Debug)]
enum Failed {
    /// This piece fits nowhere.
    NoRoom(usize),
    /// It took too much work.
    TooMuch,
}

impl Work {
    fn up_to(most: u64) -> Self {
        Self { done: 0, most }
    }
}

/// A plan carried out: the side in cells, and the turn and place of each piece.
#[derive(Clone, Debug)]
struct Found {
    side: usize,
    plan: Plan,
    spots: Vec<(usize, [usize; 2])>,
}

impl Level {
    /// A grid of so many cells on a square of a side, margins being the `share` of it.
    ///
    /// # Errors
    /// If it is stopped.
    pub(super) fn new(
        pieces: &[Piece],
        turns: Option<&[usize]>,
        cells: f64,
        (side, share): (f64, f64),
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let (scale, margin) = (cells / side, share * cells);
        let shapes = |(k, piece): (usize, &Piece)| -> Result<Arc<[Shape]>, Interrupted> {
            watch.ask(0.0)?;
            let shape = |turn| Shape::new(&piece.edges, turn, scale, margin);
            match turns {
                Some(turns) => Ok([shape(piece.turns[turns[k]])].into()),
                None => piece.rasters.of(scale, margin, || {
                    let mut shapes: Vec<Shape> = Vec::with_capacity(piece.turns.len());
                    for &turn in &piece.turns {
                        watch.ask(0.0)?;
                        let before = shapes.iter().find(|before| quarter(1) * before.turn == turn);
                        shapes.push(before.map_or_else(|| shape(turn), Shape::quarter_on));
                    }
                    Ok(shapes.into())
                }),
            }
        };
        let shapes = pieces.par_iter().enumerate().map(shapes).collect::<Result<_, _>>()?;
        Ok(Self { scale, margin, most: (cells - margin) as usize, shapes })
    }

    /// Carries a plan out in a square of a side, unless that takes too much work.
    fn carry_out(&self, plan: &Plan, side: usize, work: &mut Work) -> Result<Found, Failed> {
        let mut bin = Bin::new(side);
        let mut spots = vec![(0, [0; 2]); self.shapes.len()];
        let mut taken = 0;
        for &k in &plan.order {
            if work.done > work.most {
                return Err(Failed::TooMuch);
            }
            let (turn, place) = self.best_place(&bin, k, plan, &mut work.done).ok_or(Failed::NoRoom(k))?;
            let shape = &self.shapes[k][turn];
            bin.add(shape, place.at);
            spots[k] = (turn, place.at);
            taken = (0..2).fold(taken, |most, i| most.max(place.at[i] + shape.size[i]));
        }
        Ok(Found { side: taken, plan: plan.clone(), spots })
    }

    fn best_place(&self, bin: &Bin, k: usize, plan: &Plan, work: &mut u64) -> Option<(usize, Place)> {
        let rule = if plan.is_low { Rule::Low } else { Rule::Corner };
        let mut best: Option<(usize, Place)> = None;
        *work += 1;
        for (turn, shape) in self.shapes[k].iter().enumerate() {
            if plan.turns[k].is_some_and(|only| only != turn) {
                continue;
            }
            if let Some(place) = bin.place(shape, rule, best.map(|(_, place)| place), work) {
                best = Some((turn, place));
            }
        }
        best
    }

    /// The smallest side that a plan needs, if it is not above one, or what was found of that with the work that is allowed.
    fn squeeze(&self, plan: &Plan, most: usize, work: &mut Work) -> Result<Found, Failed> {
        let mut found = self.carry_out(plan, most, work)?;
        while found.side > 1
            && let Ok(better) = self.carry_out(plan, found.side - 1, work)
        {
            found = better;
        }
        Ok(found)
    }

    /// The side of the square in the pieces' unit, the margin at its border included.
    fn side(&self, cells: usize) -> f64 {
        (cells as f64 + self.margin) / self.scale
    }

    /// An empty square.
    pub(super) fn bin(&self) -> Bin {
        Bin::new(self.most)
    }

    /// Places a piece on a tile as low as it goes, if it goes.
    pub(super) fn place_on(&self, bin: &mut Bin, k: usize, tile: u32) -> Option<Put> {
        let mut best: Option<(&Shape, Place)> = None;
        for shape in self.shapes[k].iter() {
            if let Some(place) = bin.place(shape, Rule::Low, best.map(|(_, place)| place), &mut 0) {
                best = Some((shape, place));
            }
        }
        let (shape, place) = best?;
        bin.add(shape, place.at);
        Some(self.put_one(shape, place.at, tile))
    }

    fn put(&self, found: &Found) -> Vec<Put> {
        let put = |(shapes, &(turn, at)): (&Arc<[Shape]>, &(usize, [usize; 2]))| self.put_one(&shapes[turn], at, 0);
        self.shapes.iter().zip(&found.spots).map(put).collect()
    }

    fn put_one(&self, shape: &Shape, at: [usize; 2], tile: u32) -> Put {
        let border = Complex64::new(0.5 * self.margin, 0.5 * self.margin);
        let at = Complex64::new(at[0] as f64, at[1] as f64);
        Put { turn: shape.turn, to: (at - shape.low + border) / self.scale, tile }
    }
}

/// Places pieces in a square that is as small as is found, and its side; margins are the `share` of that.
pub(super) fn smallest_square(
    pieces: &[Piece],
    share: f64,
    effort: Effort,
    watch: Watch,
) -> Result<(Vec<Put>, f64), Interrupted> {
    let largest = pieces.iter().map(|piece| piece.side).fold(0.0, f64::max) / (1.0 - share);
    if let [piece] = pieces {
        return Ok(alone(piece, share));
    }
    let few_to_many = (COARSE * (pieces.len() as f64).sqrt()).clamp(COARSE_RANGE[0], COARSE_RANGE[1]);
    let cells = if effort.is_fine { few_to_many } else { ROUGH };
    let area: f64 = pieces.iter().map(|piece| piece.area).sum();
    let mut side = largest.max((area / EXPECTED).sqrt());
    let side_or_one = |side: f64| if side > 0.0 { side } else { 1.0 };
    if !effort.is_fine {
        // Up a little, so that the same area, but for rounding, gives the same grid, for which pieces may be cells already.
        side = (side / ROUNDING).ceil() * ROUNDING;
    }
    let (coarse, first) = loop {
        let level = Level::new(pieces, None, cells, (side_or_one(side), share), watch.within(0.0, 0.05))?;
        let mut work = Work::up_to(u64::MAX);
        match level.carry_out(&by_size(pieces), level.most, &mut work) {
            Ok(found) => break (level, (found, work.done)),
            Err(_) => side = 1.08 * side_or_one(side),
        }
    };
    let best = explore(&coarse, pieces, first, effort.work, watch.within(0.05, 0.8))?;
    let side = coarse.side(best.side);
    if !effort.is_fine {
        return Ok((coarse.put(&best), side));
    }
    let fine = refine(pieces, &best, side, share, watch.within(0.8, 1.0))?;
    Ok(fine.filter(|fine| fine.1 < side).unwrap_or_else(|| (coarse.put(&best), side)))
}

/// One piece in its smallest square.
fn alone(piece: &Piece, share: f64) -> (Vec<Put>, f64) {
    let (turn, low) = piece.in_smallest_square();
    let side = if piece.side > 0.0 { piece.side / (1.0 - share) } else { 1.0 };
    let border = 0.5 * share * side;
    (vec![Put { turn, to: Complex64::new(border, border) - low, tile: 0 }], side)
}

/// The largest first.
fn by_size(pieces: &[Piece]) -> Plan {
    Plan { order: order(pieces, |piece| piece.area), turns: vec![None; pieces.len()], is_low: true }
}

fn order(pieces: &[Piece], size: impl Fn(&Piece) -> f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|&a, &b| size(&pieces[b]).total_cmp(&size(&pieces[a])));
    order
}

/// Tries plans after a first one, whose work tells how many at a time are likely to come to an end.
fn explore(
    level: &Level,
    pieces: &[Piece],
    (mut best, first): (Found, u64),
    most_work: u64,
    watch: Watch,
) -> Result<Found, Interrupted> {
    let mut queue = VecDeque::from(plans(pieces));
    let mut seen: HashSet<Plan> = queue.iter().cloned().collect();
    let mut work = 0;
    while !queue.is_empty() && work < most_work {
        watch.ask(work as f64 / most_work as f64)?;
        let likely = ((most_work - work) / first.max(1)).clamp(1, BATCH as u64) as usize;
        let batch: Vec<Plan> = queue.drain(..likely.min(queue.len())).collect();
        let share = (most_work - work) / batch.len() as u64;
        let most = best.side - 1;
        let tried = |plan: &Plan| {
            let mut work = Work::up_to(share);
            let found = level.squeeze(plan, most, &mut work);
            (found, work.done)
        };
        let tried: Vec<_> = batch.par_iter().map(tried).collect();
        for (plan, (result, took)) in batch.into_iter().zip(tried) {
            work += took;
            let next = match result {
                Err(Failed::NoRoom(piece)) => earlier(plan, piece),
                Err(Failed::TooMuch) => None,
                Ok(found) => {
                    if found.side < best.side {
                        best = found;
                    }
                    Some(plan)
                }
            };
            if let Some(next) = next
                && seen.insert(next.clone())
            {
                queue.push_back(next);
            }
        }
    }
    Ok(best)
}

/// Plans to begin with: two orders, two rules, and the different turns of the first piece.
fn plans(pieces: &[Piece]) -> Vec<Plan> {
    let orders = [order(pieces, |piece| piece.area), order(pieces, |piece| piece.side)];
    let mut plans = Vec::new();
    for order in &orders[..if orders[0] == orders[1] { 1 } else { 2 }] {
        for is_low in [true, false] {
            let first = order[0];
            let different = pieces[first].turns.len().div_ceil(4);
            for turn in std::iter::once(None).chain((0..different).map(Some)) {
                let mut turns = vec![None; pieces.len()];
                turns[first] = turn;
                plans.push(Plan { order: order.clone(), turns, is_low });
            }
        }
    }
    plans
}

/// The same plan with a piece half as far back.
fn earlier(mut plan: Plan, piece: usize) -> Option<Plan> {
    let at = plan.order.iter().position(|&k| k == piece).filter(|&at| at > 0)?;
    plan.order[at / 2..=at].rotate_right(1);
    Some(plan)
}

/// Carries the best plan out on a fine grid, each piece in the turn that was found for it.
fn refine(
    pieces: &[Piece],
    best: &Found,
    side: f64,
    share: f64,
    watch: Watch,
) -> Result<Option<(Vec<Put>, f64)>, Interrupted> {
    let turns: Vec<usize> = best.spots.iter().map(|&(turn, _)| turn).collect();
    let level = Level::new(pieces, Some(&turns), FINE, (side, share), watch)?;
    let mut plan = Plan { turns: vec![None; pieces.len()], ..best.plan.clone() };
    let mut found: Option<Found> = None;
    for is_low in [best.plan.is_low, !best.plan.is_low] {
        plan.is_low = is_low;
        let mut step = level.most / 32;
        let mut most = found.as_ref().map_or(level.most, |found| found.side - 1);
        while step > 0 {
            watch.ask(1.0 - step as f64 / level.most as f64)?;
            match level.carry_out(&plan, most, &mut Work::up_to(u64::MAX)) {
                Ok(better) => {
                    most = better.side.saturating_sub(step).max(1);
                    found = Some(better);
                }
                Err(_) => {
                    let Some(found) = &found else { break };
                    step /= 2;
                    most = found.side.saturating_sub(step).max(1);
                }
            }
        }
    }
    Ok(found.map(|found| (level.put(&found), level.side(found.side))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uv::pack::options::Rotations;

    /// Rectangles of many sizes.
    fn pieces(count: usize) -> Vec<Piece> {
        let extent = |k: usize, step: usize| 1.0 + (k * step % 23) as f64 / 23.0;
        let piece = |k| {
            let [w, h] = [extent(k, 7), extent(k, 11)];
            Piece::rectangle([w, h], w * h, Rotations::Any)
        };
        (0..count).map(piece).collect()
    }

    #[test]
    fn a_plan_takes_no_more_work_than_it_may_but_for_its_last_piece() {
        let pieces = pieces(60);
        let area: f64 = pieces.iter().map(|piece| piece.area).sum();
        let level = Level::new(&pieces, None, 200.0, ((area / 0.5).sqrt(), 0.01), Watch::NONE).unwrap();
        let plan = by_size(&pieces);
        let mut all = Work::up_to(u64::MAX);
        let found = level.squeeze(&plan, level.most, &mut all).unwrap();
        // Of one piece each of two turns looks at each run at each place at most.
        let runs = level.shapes.iter().flat_map(|shapes| shapes.iter()).map(|shape| shape.taken.len()).max().unwrap();
        let last = 1 + 2 * (runs * level.most * level.most.div_ceil(64)) as u64;
        for most in [0, all.done / 20, all.done / 3, all.done - 1] {
            let mut work = Work::up_to(most);
            match level.squeeze(&plan, level.most, &mut work) {
                Ok(sooner) => assert!(sooner.side >= found.side),
                Err(failed) => assert!(matches!(failed, Failed::TooMuch)),
            }
            assert!(work.done <= most + last, "{} {most}", work.done);
        }
    }
}
