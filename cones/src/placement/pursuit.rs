//! Nested cones for every number of them: `pursuit`.
//!
//! One order of cones whose every prefix is good: Σ log E(first N), taken over N = 1, 2, 4, 8, …, is minimised by replacing
//! a cone or by swapping two in the order. Moves are scored by the swap tables of all levels at once
//! ([`SwapTable`]); replacing the cone at place j changes the levels beyond j, swapping j < k those in between. It starts
//! from orders that are nested by nature: matching pursuit, and elimination of cones one by one. A nested order costs some percent against
//! [`refined`](crate::refined()), which serves one number alone.
//!
//! Which cones come first must not depend on how many are asked for, so an order is always found in blocks of 32, each
//! with all before it held.

use std::cmp::Ordering;

use geom::VertexId;

use super::energy_model::{ConeSet, EnergyModel};
use super::exchange::{TRIALS, drop_cheapest, exchange};
use super::matching_pursuit::{Rule, grow, start};
use super::nested::Nested;
use super::separation::Separation;
use super::swap_table::{LANES, Nearness, Rows, STRIDE, SwapTable};
use crate::curvature::COMFORTABLE_CORNER;

/// An order is found so many cones at a time.
pub(crate) const BLOCK: usize = 32;
/// Rounds that look for new candidates over the whole surface; each costs a table a level.
const ROUNDS: usize = 4;
/// New candidates of a round.
const NEW_CANDIDATES: usize = 16;
/// Rounds end when Σ log E falls by less than this for each level.
const LEAST_GAIN: f64 = 0.002;
/// A move must lower Σ log E by this.
const LEAST_MOVE: f64 = 1e-4;

/// The best order found of so many cones; fewer only where the surface has no more inner vertices. On a fresh model every
/// order begins with all shorter ones. About 190 back-solves for each 32 cones begun.
pub fn pursuit(model: &mut EnergyModel, count: usize) -> Nested {
    pursuit_by(model, count, BLOCK)
}

/// An order of so many cones, found in blocks of no more than that: for a few cones cheaper than [`pursuit`], but no prefix
/// of a longer order.
pub(crate) fn brief_pursuit(model: &mut EnergyModel, count: usize) -> Nested {
    pursuit_by(model, count, count.clamp(1, BLOCK))
}

fn pursuit_by(model: &mut EnergyModel, count: usize, block: usize) -> Nested {
    let mut cones: Vec<VertexId> = Vec::new();
    model.with_largest_corner(COMFORTABLE_CORNER, |model| {
        while cones.len() < count {
            let held = cones.len();
            cones = extended(model, std::mem::take(&mut cones), block);
            if cones.len() == held {
                break;
            }
        }
    });
    cones.truncate(count);
    Nested::new(model, &cones)
}

/// An order with a block more.
fn extended(model: &mut EnergyModel, held: Vec<VertexId>, block: usize) -> Vec<VertexId> {
    let mut order = best_start(model, held, block);
    for _ in 0..ROUNDS {
        let new = order.proposals(model);
        if new.is_empty() {
            break;
        }
        model.add(&new);
        let before = order.cost;
        order.improve(model);
        if order.cost > before - LEAST_GAIN * order.levels.len() as f64 {
            break;
        }
    }
    order.arranged(model)
}

/// The best of three orders: pursued by gradient, by gain, and, where nothing is held, the order in which cones are missed
/// least, backwards.
fn best_start(model: &mut EnergyModel, held: Vec<VertexId>, block: usize) -> Order {
    let count = held.len() + block;
    let first = if held.is_empty() { start(model, count) } else { model.fit(&held) };
    let by_gradient = grow(model, first.clone(), count, Rule::Gradient);
    let by_gain = grow(model, first, count, Rule::Gain);
    let mut best = Order::improved(model, by_gradient.cones, held.len());
    let mut others = vec![by_gain.cones.clone()];
    if held.is_empty() {
        others.push(backward(model, exchange(model, by_gain)));
    }
    for cones in others {
        let order = Order::improved(model, cones, held.len());
        if order.is_better_than(&best, 0.0) {
            best = order;
        }
    }
    best
}

/// A set's cones, those that are missed least last.
fn backward(model: &EnergyModel, mut set: ConeSet) -> Vec<VertexId> {
    let mut dropped = Vec::new();
    while !set.cones.is_empty() {
        let fewer = drop_cheapest(model, &set);
        dropped.extend(set.cones.iter().filter(|cone| !fewer.cones.contains(cone)));
        set = fewer;
    }
    dropped.reverse();
    dropped
}

/// An order of cones with the sets of its levels.
struct Order {
    cones: Vec<VertexId>,
    /// So many of them stay where they are.
    held: usize,
    levels: Vec<ConeSet>,
    /// Σ log E over the levels.
    cost: f64,
}

/// Puts a vertex in place of the cone at a place; where that vertex is in the order already, swaps the two.
#[derive(Clone, Copy)]
struct Move {
    change: f64,
    place: usize,
    vertex: VertexId,
}

impl Order {
    fn new(model: &EnergyModel, cones: Vec<VertexId>, held: usize) -> Self {
        let counts = (0..).map(|k| 1usize << k).take_while(|&n| n < cones.len()).chain([cones.len()]);
        let levels: Vec<ConeSet> = counts.map(|n| model.fit(&cones[..n])).collect();
        // A level that cannot take the curvature is none, as one or two cones on a sphere.
        let able: Vec<ConeSet> = levels.iter().filter(|level| level.shortfall == 0.0).cloned().collect();
        let levels = if able.is_empty() { levels } else { able };
        let cost = levels.iter().map(|level| worth(model, level).ln()).sum();
        Self { cones, held, levels, cost }
    }

    fn improved(model: &EnergyModel, cones: Vec<VertexId>, held: usize) -> Self {
        let mut order = Self::new(model, cones, held);
        order.improve(model);
        order
    }

    /// The cones with those between two levels in the best order, which levels say nothing about: whichever is missed
    /// least comes last.
    fn arranged(self, model: &EnergyModel) -> Vec<VertexId> {
        let mut cones = self.cones;
        let mut from = self.held;
        for to in self.levels.iter().map(|level| level.cones.len()).filter(|&to| to > self.held) {
            for last in (from + 1..to).rev() {
                if model.is_stopped() {
                    break;
                }
                let without = |place: usize| {
                    let mut fewer = cones[..=last].to_vec();
                    fewer.remove(place);
                    (place, model.fit(&fewer))
                };
                let better =
                    |a: (usize, ConeSet), b: (usize, ConeSet)| if b.1.is_better_than(&a.1, 0.0) { b } else { a };
                if let Some((place, _)) = (from..=last).map(without).reduce(better) {
                    cones[place..=last].rotate_left(1);
                }
            }
            from = to;
        }
        cones
    }

    /// Whether more levels can take the curvature than in another order, or Σ log E is less by so much.
    fn is_better_than(&self, other: &Self, by: f64) -> bool {
        match self.levels.len().cmp(&other.levels.len()) {
            Ordering::Equal => self.cost < other.cost - by,
            more => more == Ordering::Greater,
        }
    }

    /// Makes the best move as long as there is one, without solves.
    fn improve(&mut self, model: &EnergyModel) {
        while let Some(better) = self.best_move(model) {
            *self = better;
        }
    }

    fn best_move(&self, model: &EnergyModel) -> Option<Self> {
        if model.is_stopped() {
            return None;
        }
        let tables = self.tables(model);
        let separation = Separation::new(model.operators(), &self.cones);
        let mut moves = Vec::new();
        let mut rows: Vec<Rows> = tables.iter().map(|_| Rows::default()).collect();
        let open: Vec<VertexId> = model.pool().iter().copied().filter(|&v| separation.is_open(v)).collect();
        for members in open.chunks(LANES) {
            tables.iter().zip(&mut rows).for_each(|(table, rows)| table.fill_for_members(members, rows));
            for (lane, &vertex) in members.iter().enumerate() {
                let at = self.cones.iter().position(|&cone| cone == vertex);
                for place in self.held..at.unwrap_or(self.cones.len()) {
                    let change = self.change(model, (&rows, lane), place, at, |x: f64| x.max(1e-3).ln());
                    if change < -LEAST_MOVE && (at.is_some() || separation.admits(vertex, place)) {
                        moves.push(Move { change, place, vertex });
                    }
                }
            }
        }
        moves.sort_by(|a, b| a.change.total_cmp(&b.change));
        let mut results = moves.iter().take(TRIALS).map(|step| self.after(model, step));
        results.find(|after| after.is_better_than(self, LEAST_MOVE))
    }

    fn after(&self, model: &EnergyModel, step: &Move) -> Self {
        let mut cones = self.cones.clone();
        if let Some(at) = cones.iter().position(|&cone| cone == step.vertex) {
            cones[at] = cones[step.place];
        }
        cones[step.place] = step.vertex;
        Self::new(model, cones, self.held)
    }

    fn tables<'a>(&'a self, model: &'a EnergyModel) -> Vec<SwapTable<'a>> {
        self.levels.iter().map(|level| SwapTable::new(model, level)).collect()
    }

    /// What putting a vertex at a place changes in Σ log E; `at` is where the vertex is in the order, and `log` may be
    /// an approximation. Levels that contain both places, or none, stay as they are.
    fn change(
        &self,
        model: &EnergyModel,
        (rows, lane): (&[Rows], usize),
        place: usize,
        at: Option<usize>,
        log: impl Fn(f64) -> f64,
    ) -> f64 {
        let concerned = |level: &ConeSet| level.cones.len() > place && at.is_none_or(|at| level.cones.len() <= at);
        let levels = self.levels.iter().zip(rows).filter(|(level, _)| concerned(level));
        levels.map(|(level, rows)| log(1.0 + rows.change[place][lane] / worth(model, level))).sum()
    }

    /// For each place the best vertex of the surface, as far as not solved for; the best first, not too many.
    fn proposals(&self, model: &EnergyModel) -> Vec<VertexId> {
        let tables = self.tables(model);
        let separation = Separation::new(model.operators(), &self.cones);
        let mut nearness = Nearness::default();
        let norms: Vec<_> = self.levels.iter().map(|level| nearness.norms(model, level)).collect();
        let mut rows: Vec<Rows> = tables.iter().map(|_| Rows::default()).collect();
        let mut best: Vec<Option<Move>> = vec![None; self.cones.len()];
        let is_new = |v: &VertexId| separation.is_open(*v) && !model.knows(*v);
        let open: Vec<VertexId> = model.operators().mesh.vertices().filter(is_new).collect();
        for (k, vertices) in open.chunks(LANES).enumerate() {
            if k.is_multiple_of(STRIDE) && model.is_stopped() {
                return Vec::new();
            }
            for ((table, norms), rows) in tables.iter().zip(&norms).zip(&mut rows) {
                table.fill_for_vertices(vertices, |v| norms[v], rows);
            }
            for (place, best) in best.iter_mut().enumerate().skip(self.held) {
                for (lane, &vertex) in vertices.iter().enumerate() {
                    let change = self.change(model, (&rows, lane), place, None, |x| x - 1.0);
                    if best.is_none_or(|best| change < best.change) && separation.admits(vertex, place) {
                        *best = Some(Move { change, place, vertex });
                    }
                }
            }
        }
        let mut best: Vec<Move> = best.into_iter().flatten().filter(|step| step.change < 0.0).collect();
        best.sort_by(|a, b| a.change.total_cmp(&b.change));
        let mut new: Vec<VertexId> = Vec::new();
        for step in best {
            if new.len() < NEW_CANDIDATES && !new.contains(&step.vertex) {
                new.push(step.vertex);
            }
        }
        new
    }
}

/// A level's energy, with what it lacks; never zero, so that it has a logarithm.
fn worth(model: &EnergyModel, level: &ConeSet) -> f64 {
    (level.energy + model.price() * level.shortfall).max(1e-12 * (1.0 + model.constant()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::CurvatureRule;
    use crate::field::Operators;
    use crate::placement::refined::refined;
    use geom::{Metric, shapes};

    fn with_nested<T>(shape: &shapes::Shape, count: usize, then: impl Fn(&mut EnergyModel, Nested) -> T) -> T {
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let mut model = EnergyModel::new(&operators, &mesh);
        let nested = pursuit(&mut model, count);
        then(&mut model, nested)
    }

    #[test]
    fn every_set_is_a_prefix_of_the_next_and_no_worse() {
        for shape in [shapes::hare(1200), shapes::torus(1, 900), shapes::terrain(900, 5)] {
            with_nested(&shape, 20, |_, nested| {
                assert_eq!(nested.sets.len(), 21);
                for pair in nested.sets.windows(2) {
                    assert_eq!(pair[0].cones, pair[1].cones[..pair[0].cones.len()]);
                    assert!(pair[0].shortfall > 0.0 || pair[1].energy <= pair[0].energy * (1.0 + 1e-9));
                }
            });
        }
    }

    #[test]
    fn nested_sets_are_not_much_worse_than_the_best_of_their_size() {
        for shape in [shapes::hare(1200), shapes::torus(2, 900), shapes::terrain(900, 5)] {
            with_nested(&shape, 16, |model, nested| {
                let ratio = |count: usize| nested.sets[count].log_scale_norm() / refined(model, count).log_scale_norm();
                let ratios = [4, 8, 16].map(ratio);
                assert!(ratios.iter().product::<f64>().cbrt() < 1.15, "{ratios:?}");
            });
        }
    }

    #[test]
    fn an_order_begins_with_every_shorter_one() {
        for shape in [shapes::hare(900), shapes::torus(2, 700), shapes::terrain(700, 5)] {
            let order = |count: usize| with_nested(&shape, count, |_, nested| nested.cones().to_vec());
            let all = order(40);
            assert_eq!(all.len(), 40);
            for count in [1, 3, 8, 31, 32, 33] {
                assert_eq!(order(count), all[..count], "{count} cones");
            }
        }
    }

    #[test]
    fn the_curve_begins_with_what_the_surface_needs() {
        let curve = |model: &mut EnergyModel, nested: Nested| {
            nested.curve(model.operators(), CurvatureRule::Optimal, geom::Watch::NONE)
        };
        let first = |shape: shapes::Shape| with_nested(&shape, 6, |model, nested| curve(model, nested)[0]);
        assert_eq!(first(shapes::hare(600)).count, 3);
        assert_eq!(first(shapes::torus(1, 600)).count, 0);
        assert_eq!(first(shapes::terrain(600, 2)).count, 0);
        let square = first(shapes::square(400));
        assert!(square.log_scale_norm < 1e-9 && (square.area_distortion - 1.0).abs() < 1e-9);
    }
}
