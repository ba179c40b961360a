//! Minimising a smooth function of many variables from its gradient.
//!
//! L-BFGS (Nocedal 1980, "Updating quasi-Newton matrices with limited storage"; Nocedal & Wright 2006, alg. 7.4) with a
//! line search that brackets a step with the weak Wolfe conditions (Lewis & Overton 2013, "Nonsmooth optimization via
//! quasi-Newton methods", alg. 2.6). Where the function is infinite the step was too long: a barrier is never crossed.

use std::collections::VecDeque;

/// How many earlier steps the inverse Hessian is built from.
const MEMORY: usize = 8;

/// The weak Wolfe conditions: the least decrease and the largest slope left, as shares of the slope at the start.
const DECREASE: f64 = 1e-4;
const SLOPE_LEFT: f64 = 0.9;

/// Trials in a line search; each halves or doubles.
const TRIALS: usize = 60;

/// The length of the first step that is tried, and of the first after a fresh start.
const FIRST_STEP: f64 = 0.1;

/// A function's value and gradient at a place.
struct Point {
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
}

/// Goes downhill from `x` for at most so many steps, as long as it may, and returns where that leads: nowhere, where the
/// value is not finite. A step that gains less than a share of the value is the last.
pub(crate) fn minimise(
    function: impl Fn(&[f64]) -> (f64, Vec<f64>),
    x: Vec<f64>,
    (steps, least_gain): (usize, f64),
    may_go_on: impl Fn() -> bool,
) -> Vec<f64> {
    let (value, gradient) = function(&x);
    let mut here = Point { x, value, gradient };
    let mut memory = Memory::default();
    for _ in 0..steps {
        if !may_go_on() {
            break;
        }
        let direction = memory.direction(&here.gradient);
        match line_search(&function, &here, &direction) {
            Some(next) => {
                let gain = here.value - next.value;
                memory.remember(&here, &next);
                here = next;
                if gain <= least_gain * here.value.abs() {
                    break;
                }
            }
            None if memory.steps.is_empty() => break,
            None => memory.steps.clear(),
        }
    }
    here.x
}

/// The nearest place found in a direction that satisfies the weak Wolfe conditions, or at least the first of them.
fn line_search(function: impl Fn(&[f64]) -> (f64, Vec<f64>), start: &Point, direction: &[f64]) -> Option<Point> {
    let slope = dot(&start.gradient, direction);
    if !(slope < 0.0 && slope.is_finite() && start.value.is_finite()) {
        return None;
    }
    let (mut short, mut long) = (0.0, f64::INFINITY);
    let mut length = 1.0;
    let mut best = None;
    for _ in 0..TRIALS {
        let x: Vec<f64> = start.x.iter().zip(direction).map(|(x, d)| x + length * d).collect();
        let (value, gradient) = function(&x);
        if value <= start.value + DECREASE * length * slope {
            let slope_here = dot(&gradient, direction);
            best = Some(Point { x, value, gradient });
            if slope_here >= SLOPE_LEFT * slope {
                break;
            }
            short = length;
        } else {
            long = length;
        }
        length = if long.is_finite() { 0.5 * (short + long) } else { 2.0 * short };
    }
    best
}

/// The last steps and what they changed in the gradient.
#[derive(Default)]
struct Memory {
    steps: VecDeque<Update>,
}

struct Update {
    step: Vec<f64>,
    change: Vec<f64>,
    /// 1 / step·change
    rho: f64,
}

impl Memory {
    /// Minus the approximate inverse Hessian times the gradient.
    fn direction(&self, gradient: &[f64]) -> Vec<f64> {
        let mut direction: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let mut alphas = Vec::with_capacity(self.steps.len());
        for update in self.steps.iter().rev() {
            let alpha = update.rho * dot(&update.step, &direction);
            add(&mut direction, -alpha, &update.change);
            alphas.push(alpha);
        }
        let scale = match self.steps.back() {
            Some(last) => 1.0 / (last.rho * dot(&last.change, &last.change)),
            None => FIRST_STEP / dot(gradient, gradient).sqrt(),
        };
        direction.iter_mut().for_each(|d| *d *= scale);
        for (update, alpha) in self.steps.iter().zip(alphas.into_iter().rev()) {
            let beta = update.rho * dot(&update.change, &direction);
            add(&mut direction, alpha - beta, &update.step);
        }
        direction
    }

    /// Keeps a step, unless the function curves downwards along it.
    fn remember(&mut self, from: &Point, to: &Point) {
        let step: Vec<f64> = to.x.iter().zip(&from.x).map(|(to, from)| to - from).collect();
        let change: Vec<f64> = to.gradient.iter().zip(&from.gradient).map(|(to, from)| to - from).collect();
        let rho = 1.0 / dot(&step, &change);
        if rho > 0.0 && rho.is_finite() {
            if self.steps.len() == MEMORY {
                self.steps.pop_front();
            }
            self.steps.push_back(Update { step, change, rho });
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a += factor·b
fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bottom_of_rosenbrocks_valley_is_found() {
        let valley = |x: &[f64]| {
            let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
            (a * a + 100.0 * b * b, vec![-2.0 * a - 400.0 * x[0] * b, 200.0 * b])
        };
        let x = minimise(valley, vec![-1.2, 1.0], (200, 1e-12), || true);
        assert!((x[0] - 1.0).abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-6, "{x:?}");
    }

    #[test]
    fn a_barrier_is_not_crossed() {
        let well = |x: &[f64]| {
            let value = if x[0] > 0.0 { x[0] - x[0].ln() } else { f64::INFINITY };
            (value, vec![1.0 - 1.0 / x[0]])
        };
        for start in [1e-6, 0.5, 30.0] {
            let x = minimise(well, vec![start], (200, 1e-12), || true);
            assert!((x[0] - 1.0).abs() < 1e-5, "{x:?} from {start}");
        }
    }

    #[test]
    fn an_ill_conditioned_bowl_is_searched_to_its_bottom() {
        let weight = |i: usize| 10f64.powi(i as i32 % 7 - 3);
        let bowl = |x: &[f64]| {
            let value = x.iter().enumerate().map(|(i, x)| weight(i) * (x - 1.0).powi(2)).sum();
            (value, x.iter().enumerate().map(|(i, x)| 2.0 * weight(i) * (x - 1.0)).collect())
        };
        let x = minimise(bowl, vec![0.0; 30], (2000, 1e-12), || true);
        assert!(bowl(&x).0 < 1e-9, "{}", bowl(&x).0);
    }

    #[test]
    fn nowhere_to_go_is_no_failure() {
        assert_eq!(minimise(|_| (3.0, vec![]), Vec::new(), (10, 1e-12), || true), Vec::<f64>::new());
        assert_eq!(minimise(|_| (3.0, vec![0.0]), vec![2.0], (10, 1e-12), || true), [2.0]);
        assert_eq!(minimise(|_| (f64::NAN, vec![1.0]), vec![2.0], (10, 1e-12), || true), [2.0]);
    }
}
