//! The curvatures of given cones on a lattice: all of them multiples of one angle.
//!
//! The [`Quadratic`] E(q) is to be least over q = s·k with whole numbers k between bounds and, on a closed surface, of a given
//! sum. This is the closest vector problem, which is hard; there are no more than some dozens of cones, and few multiples
//! between their bounds. Where these are few in all, each choice is tried. Else two starts: the continuous minimum rounded, and its variables fixed one by one, the one
//! nearest to the lattice first, the others minimised again each time (Babai 1986, "On Lovász' lattice reduction and the nearest
//! lattice point problem", without the reduction). From either down by exchanges: one variable a step up and another a step down; and where no
//! exchange helps, from the least harmful of them down again.

use super::quadratic_program::{ProgramError, Quadratic, minimise};

/// Bounds admit a multiple that is outside by this share of a step.
const SLACK: f64 = 1e-9;
/// An exchange must lower the energy by this share of what it is made of.
const LEAST_GAIN: f64 = 1e-12;
/// So many exchanges that do harm alone are tried as the first of several.
const DETOURS: usize = 24;
/// So many of these detours are taken,
const MOST_DETOURS: usize = 50;
/// fewer for more variables than this, each of which costs their square; and so many times variables are fixed, which costs their cube.
const DOZENS: usize = 64;
/// Up to so many choices of multiples each is tried: those of five cones with quarters of a turn.
const FEW: f64 = 40_000.0;

/// The minimum, for few variables, else a local minimum of a quadratic function over multiples of `step` between bounds, where `total` is given with the sum that is
/// nearest to it: no exchange of a step between two variables lowers it (nor a single step, where the sum is free).
///
/// # Errors
/// If no multiples are between the bounds with that sum, and as [`minimise`].
pub(crate) fn minimise_on_lattice(
    energy: &Quadratic,
    bounds: &[[f64; 2]],
    total: Option<f64>,
    step: f64,
) -> Result<Vec<i32>, ProgramError> {
    let lattice = Lattice::new(energy, bounds, total, step)?;
    match lattice.least_of_all() {
        Some(least) => Ok(least),
        None => lattice.lowest_found(),
    }
}

struct Lattice<'a> {
    energy: &'a Quadratic<'a>,
    bounds: &'a [[f64; 2]],
    total: Option<f64>,
    step: f64,
    /// The least and greatest multiple of each variable.
    range: Vec<[i32; 2]>,
    /// What the multiples sum to.
    sum: Option<i32>,
    /// By so much an exchange must lower the energy.
    gain: f64,
}

/// Multiples of the step added to two variables: to the first, and taken from the second; or to one only.
#[derive(Clone, Copy)]
struct Exchange {
    up: Option<usize>,
    down: Option<usize>,
    change: f64,
}

impl<'a> Lattice<'a> {
    fn new(
        energy: &'a Quadratic<'a>,
        bounds: &'a [[f64; 2]],
        total: Option<f64>,
        step: f64,
    ) -> Result<Self, ProgramError> {
        let range: Vec<[i32; 2]> = bounds
            .iter()
            .map(|[low, high]| [(low / step - SLACK).ceil() as i32, (high / step + SLACK).floor() as i32])
            .collect();
        let sum = total.map(|total| (total / step).round() as i32);
        let [least, most] = [0, 1].map(|side| range.iter().map(|range| range[side]).sum::<i32>());
        let is_crossed = range.iter().any(|[low, high]| low > high);
        if is_crossed || sum.is_some_and(|sum| sum < least || sum > most) {
            let [least, most] = [least, most].map(|sum| f64::from(sum) * step);
            return Err(ProgramError::Infeasible { total: total.unwrap_or(0.0), least, most });
        }
        let size = energy.constant.abs().max(f64::MIN_POSITIVE);
        Ok(Self { energy, bounds, total, step, range, sum, gain: LEAST_GAIN * size })
    }

    fn curvatures(&self, multiples: &[i32]) -> Vec<f64> {
        multiples.iter().map(|&k| f64::from(k) * self.step).collect()
    }

    fn value(&self, multiples: &[i32]) -> f64 {
        self.energy.value(&self.curvatures(multiples))
    }

    /// The best of all choices, the first of them in order, where they are few.
    fn least_of_all(&self) -> Option<Vec<i32>> {
        let values = |[low, high]: &[i32; 2]| high - low + 1;
        let choices: f64 = self.range.iter().map(|range| f64::from(values(range))).product();
        if choices > FEW {
            return None;
        }
        let choice = |mut number: i32| -> Vec<i32> {
            let digit = |range: &[i32; 2]| {
                let digit = number % values(range);
                number /= values(range);
                range[0] + digit
            };
            self.range.iter().map(digit).collect()
        };
        let has_sum = |multiples: &Vec<i32>| self.sum.is_none_or(|sum| multiples.iter().sum::<i32>() == sum);
        let all = (0..choices as i32).map(choice).filter(has_sum).map(|multiples| (self.value(&multiples), multiples));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, multiples)| multiples)
    }

    /// The lower end of the ways down from both starts.
    fn lowest_found(&self) -> Result<Vec<i32>, ProgramError> {
        let [first, second] = [self.rounded()?, self.one_by_one()?].map(|start| self.descend_deeply(start));
        Ok(if self.value(&second) < self.value(&first) { second } else { first })
    }

    fn nearest(&self, i: usize, q: f64) -> i32 {
        ((q / self.step).round() as i32).clamp(self.range[i][0], self.range[i][1])
    }

    /// The continuous minimum rounded, with the sum mended.
    fn rounded(&self) -> Result<Vec<i32>, ProgramError> {
        let optimum = minimise(self.energy, self.bounds, self.total)?.curvatures;
        Ok(self.mended(optimum.iter().enumerate().map(|(i, &q)| self.nearest(i, q)).collect()))
    }

    /// Variables fixed one by one, the nearest to the lattice first; several at a time where there are more than [`DOZENS`].
    fn one_by_one(&self) -> Result<Vec<i32>, ProgramError> {
        let mut bounds = self.bounds.to_vec();
        let mut free: Vec<usize> = (0..bounds.len()).collect();
        let mut multiples = vec![0; bounds.len()];
        while !free.is_empty() {
            // What was fixed may leave the others no room: then they stay where they are, for the sum to be mended.
            let Ok(optimum) = minimise(self.energy, &bounds, self.total) else { break };
            let q = optimum.curvatures;
            let off = |i: usize| (q[i] - f64::from(self.nearest(i, q[i])) * self.step).abs();
            for &i in &free {
                multiples[i] = self.nearest(i, q[i]);
            }
            for _ in 0..self.range.len().div_ceil(DOZENS).min(free.len()) {
                let place = (0..free.len()).min_by(|&a, &b| off(free[a]).total_cmp(&off(free[b])));
                let i = free.swap_remove(place.expect("one is free"));
                bounds[i] = [f64::from(multiples[i]) * self.step; 2];
            }
        }
        Ok(self.mended(multiples))
    }

    /// With the right sum, by the steps that cost least.
    fn mended(&self, mut multiples: Vec<i32>) -> Vec<i32> {
        let Some(sum) = self.sum else { return multiples };
        loop {
            let missing = sum - multiples.iter().sum::<i32>();
            let steps = self.exchanges(&multiples).into_iter().filter(|exchange| match missing.signum() {
                1 => exchange.down.is_none(),
                _ => exchange.up.is_none(),
            });
            match steps.min_by(|a, b| a.change.total_cmp(&b.change)) {
                Some(step) if missing != 0 => apply(&mut multiples, step),
                _ => return multiples,
            }
        }
    }

    /// All single steps and exchanges within the bounds, with what they change.
    fn exchanges(&self, multiples: &[i32]) -> Vec<Exchange> {
        let slope = self.energy.half_gradient(&self.curvatures(multiples));
        let (n, s) = (multiples.len(), self.step);
        let entry = |i: usize, j: usize| self.energy.matrix[i * n + j];
        let ups: Vec<usize> = (0..n).filter(|&i| multiples[i] < self.range[i][1]).collect();
        let downs: Vec<usize> = (0..n).filter(|&i| multiples[i] > self.range[i][0]).collect();
        let mut exchanges = Vec::with_capacity((ups.len() + 1) * (downs.len() + 1));
        let single = |i: usize, sign: f64| s * (sign * 2.0 * slope[i] + s * entry(i, i));
        exchanges.extend(ups.iter().map(|&i| Exchange { up: Some(i), down: None, change: single(i, 1.0) }));
        exchanges.extend(downs.iter().map(|&i| Exchange { up: None, down: Some(i), change: single(i, -1.0) }));
        for &i in &ups {
            for &j in downs.iter().filter(|&&j| j != i) {
                let change = single(i, 1.0) + single(j, -1.0) - 2.0 * s * s * entry(i, j);
                exchanges.push(Exchange { up: Some(i), down: Some(j), change });
            }
        }
        exchanges
    }

    /// The exchanges that keep the sum.
    fn allowed(&self, multiples: &[i32]) -> impl Iterator<Item = Exchange> {
        let is_free = self.sum.is_none();
        self.exchanges(multiples).into_iter().filter(move |e| is_free || e.up.is_some() && e.down.is_some())
    }

    /// The best of them first.
    fn ranked(&self, multiples: &[i32]) -> Vec<Exchange> {
        let mut exchanges: Vec<Exchange> = self.allowed(multiples).collect();
        exchanges.sort_by(|a, b| a.change.total_cmp(&b.change));
        exchanges
    }

    fn descend(&self, mut multiples: Vec<i32>) -> Vec<i32> {
        loop {
            let best = self.allowed(&multiples).min_by(|a, b| a.change.total_cmp(&b.change));
            let Some(best) = best.filter(|best| best.change < -self.gain) else { return multiples };
            apply(&mut multiples, best);
        }
    }

    fn descend_deeply(&self, start: Vec<i32>) -> Vec<i32> {
        let mut best = self.descend(start);
        for _ in 0..MOST_DETOURS * DOZENS.pow(2) / self.range.len().max(DOZENS).pow(2) {
            let least = self.value(&best) - self.gain;
            let ends = self.ranked(&best).into_iter().take(DETOURS).map(|exchange| {
                let mut multiples = best.clone();
                apply(&mut multiples, exchange);
                self.descend(multiples)
            });
            let Some(better) = ends.into_iter().find(|end| self.value(end) < least) else { break };
            best = better;
        }
        best
    }
}

fn apply(multiples: &mut [i32], exchange: Exchange) {
    if let Some(i) = exchange.up {
        multiples[i] += 1;
    }
    if let Some(i) = exchange.down {
        multiples[i] -= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The least value over all multiples, tried one by one.
    fn least(lattice: &Lattice, at: &mut Vec<i32>) -> f64 {
        if at.len() == lattice.range.len() {
            let is_sum = lattice.sum.is_none_or(|sum| at.iter().sum::<i32>() == sum);
            return if is_sum { lattice.value(at) } else { f64::INFINITY };
        }
        let [low, high] = lattice.range[at.len()];
        (low..=high).fold(f64::INFINITY, |best, k| {
            at.push(k);
            let value = least(lattice, at);
            at.pop();
            best.min(value)
        })
    }

    proptest! {
        #[test]
        fn of_few_cones_the_minimum_is_that_of_trying_all(
            rows in prop::collection::vec(prop::collection::vec(-1.0..1.0f64, 4), 2..5),
            linear in prop::collection::vec(-3.0..3.0f64, 5),
            total in prop::option::of(-2i32..6),
        ) {
            let n = rows.len();
            let entry = |i: usize, j: usize| {
                rows[i].iter().zip(&rows[j]).map(|(a, b)| a * b).sum::<f64>() + if i == j { 0.1 } else { 0.0 }
            };
            let matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
            let energy = Quadratic { constant: 10.0, linear: &linear[..n], matrix: &matrix };
            let (step, bounds) = (0.7, vec![[-2.0, 2.5]; n]);
            let total = total.map(|k| f64::from(k) * step);
            let lattice = Lattice::new(&energy, &bounds, total, step).unwrap();
            let best = least(&lattice, &mut Vec::new());
            let found = minimise_on_lattice(&energy, &bounds, total, step).unwrap();
            prop_assert!(lattice.value(&found) <= best + 1e-9 * (1.0 + best.abs()), "{} for {best}", lattice.value(&found));
            let local = lattice.lowest_found().unwrap();
            prop_assert!(lattice.ranked(&local).first().is_none_or(|exchange| exchange.change >= -lattice.gain));
            for multiples in [found, local] {
                prop_assert!(lattice.sum.is_none_or(|sum| multiples.iter().sum::<i32>() == sum));
                for (k, [low, high]) in multiples.iter().zip(&lattice.range) {
                    prop_assert!(low <= k && k <= high);
                }
            }
        }
    }

    #[test]
    fn what_no_multiples_sum_to_is_refused() {
        let energy = Quadratic { constant: 0.0, linear: &[0.0; 2], matrix: &[1.0, 0.0, 0.0, 1.0] };
        let refused = minimise_on_lattice(&energy, &[[-1.0, 1.4]; 2], Some(4.0), 1.0);
        assert!(matches!(refused, Err(ProgramError::Infeasible { most, .. }) if most == 2.0), "{refused:?}");
        assert_eq!(minimise_on_lattice(&energy, &[[-1.0, 2.0]; 2], Some(4.0), 1.0), Ok(vec![2, 2]));
    }
}
