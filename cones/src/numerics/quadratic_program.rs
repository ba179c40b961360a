//! The curvatures of given cones: least squares between bounds.
//!
//! The squared area-weighted norm of the log scale is a quadratic function of the cones' curvatures q,
//!
//! ```text
//!     E(q) = c + 2 b·q + qᵀ H q        minimised under  lo ≤ q ≤ hi  and, on a closed surface,  Σ q = 2πχ,
//! ```
//!
//! with H symmetric and positive semidefinite, dense, of the cones' number. This is the primal active-set method
//! (Nocedal & Wright 2006, "Numerical Optimization", §16.5): from a feasible point minimise over the free variables as
//! if there were no bounds; where a bound is in the way stop there and hold that variable; at a minimum let go the held
//! variable that pulls inwards most; done when none does. Of many variables dozens come to a bound that way, each for a factor; so the
//! primal-dual method (Hintermüller, Ito & Kunisch 2002), which lets all of them come and go at once, goes first: three to five factors in place of 66
//! for 512 cones.
//!
//! The sum is kept by eliminating one free variable, so that every step holds it whatever the condition of H. Cones
//! close to each other make H nearly singular: its diagonal is raised by a ridge, and steps are repeated until the
//! gradient vanishes, so that the ridge is not seen in the result. The energy never grows and the number of steps is
//! limited, so the method always ends; what it returns is feasible in any case.

use geom::{Interrupted, Watch};
use thiserror::Error;

/// What is added to the matrix's diagonal, relative to its largest entry. Smaller lets rounding errors choose a
/// direction where the matrix is singular; larger needs more steps.
const RIDGE: f64 = 1e-10;

/// How often a step to the minimum over the free variables is repeated, each time with what the ridge and rounding
/// left of the gradient. One is enough but where the matrix is nearly singular.
const REPEATS: usize = 10;

/// A gradient counts from here on, relative to the terms it is the sum of.
const GRADIENT_TOLERANCE: f64 = 1e-11;

/// From so many variables on the primal-dual method goes first,
const MANY: usize = 65;
/// so many steps at most.
const LEAPS: usize = 12;

/// So many rows of a factor are computed between two looks at the watch.
const ROWS_AT_ONCE: usize = 64;

/// How far bounds may miss the sum, relative to their own size.
const SUM_TOLERANCE: f64 = 1e-12;

/// The function c + 2 b·q + qᵀ H q.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic<'a> {
    /// c
    pub constant: f64,
    /// b
    pub linear: &'a [f64],
    /// H, symmetric and positive semidefinite, row by row.
    pub matrix: &'a [f64],
}

impl Quadratic<'_> {
    /// The value at q.
    pub fn value(&self, q: &[f64]) -> f64 {
        self.half_gradient(q).iter().zip(self.linear).zip(q).fold(self.constant, |sum, ((r, b), q)| sum + (r + b) * q)
    }

    /// Half the gradient, b + H q.
    pub fn half_gradient(&self, q: &[f64]) -> Vec<f64> {
        (0..self.linear.len()).map(|i| self.linear[i] + dot(self.row(i), q)).collect()
    }

    fn row(&self, i: usize) -> &[f64] {
        let n = self.linear.len();
        &self.matrix[i * n..(i + 1) * n]
    }
}

/// Whether a variable is held at one of its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// It is between its bounds.
    Free,
    /// It is at the lower one.
    Lower,
    /// It is at the upper one.
    Upper,
}

/// The minimum of a [`Quadratic`] between bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// q: what the curvatures are.
    pub curvatures: Vec<f64>,
    /// E(q).
    pub energy: f64,
    /// λ, such that b + H q + λ is zero at free variables; zero where the sum is free.
    pub multiplier: f64,
    /// Which variables are at a bound.
    pub held: Vec<Held>,
}

/// Why there is nothing to fit.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ProgramError {
    /// The bounds exclude the sum.
    #[error(
        "the cones' curvatures must sum to {total:.4}, but their bounds allow only {least:.4} to {most:.4}: \
         choose more cones"
    )]
    Infeasible {
        /// What the sum must be.
        total: f64,
        /// The sum of the lower bounds.
        least: f64,
        /// The sum of the upper bounds.
        most: f64,
    },
    /// A lower bound is above the upper one.
    #[error("cone {index} has the lower bound {lower} above the upper bound {upper}")]
    CrossedBounds {
        /// The variable.
        index: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// A coefficient, a bound or the sum is NaN or infinite, or too large to compute with.
    #[error("the cones' energy or bounds are not finite numbers")]
    NotFinite,
    /// It was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// Matrix, vector and bounds do not fit each other.
    #[error("{variables} bounds were given for an energy with {linear} linear and {matrix} quadratic coefficients")]
    Sizes {
        /// The number of bounds.
        variables: usize,
        /// The length of b.
        linear: usize,
        /// The number of entries of H.
        matrix: usize,
    },
}

/// Minimises a quadratic function between bounds `[lower, upper]`, and where `total` is given with that sum. A few
/// Cholesky factors of the matrix, O(n³) each.
///
/// ```
/// use cones::internals::{Held, Quadratic, minimise};
/// // (q₀ - 3)² + (q₁ - 1)² with q₀ + q₁ = 2 and q₀ ≤ 1.5
/// let energy = Quadratic { constant: 10.0, linear: &[-3.0, -1.0], matrix: &[1.0, 0.0, 0.0, 1.0] };
/// let optimum = minimise(&energy, &[[-5.0, 1.5], [-5.0, 5.0]], Some(2.0))?;
/// assert_eq!(optimum.curvatures, [1.5, 0.5]);
/// assert_eq!(optimum.held, [Held::Upper, Held::Free]);
/// # Ok::<(), cones::internals::ProgramError>(())
/// ```
///
/// # Errors
/// If no q is between the bounds with that sum, if something is not finite, or if the sizes do not agree.
pub fn minimise(energy: &Quadratic, bounds: &[[f64; 2]], total: Option<f64>) -> Result<Optimum, ProgramError> {
    minimise_watched(energy, bounds, total, Watch::NONE)
}

/// [`minimise`], watched: of many variables a step takes seconds.
///
/// # Errors
/// As [`minimise`], and if it is stopped.
pub(crate) fn minimise_watched(
    energy: &Quadratic,
    bounds: &[[f64; 2]],
    total: Option<f64>,
    watch: Watch,
) -> Result<Optimum, ProgramError> {
    fit(energy, bounds, total, (None, watch)).map(|(optimum, _)| optimum)
}

/// [`minimise`], begun at a guess if there is one, and the sum of the third powers of the sizes of the matrices that were factored
/// for it. A guess need not be feasible; near to the minimum fewer variables come to a bound on the way.
pub(crate) fn minimise_from(
    energy: &Quadratic,
    bounds: &[[f64; 2]],
    total: Option<f64>,
    guess: Option<&[f64]>,
) -> Result<(Optimum, u64), ProgramError> {
    fit(energy, bounds, total, (guess, Watch::NONE))
}

fn fit(
    energy: &Quadratic,
    bounds: &[[f64; 2]],
    total: Option<f64>,
    (guess, watch): (Option<&[f64]>, Watch),
) -> Result<(Optimum, u64), ProgramError> {
    let mut set = ActiveSet::feasible(energy, bounds, total)?;
    // What is few is done at once.
    set.watch = if bounds.len() >= MANY { watch } else { Watch::NONE };
    if let Some(guess) = guess {
        set.begin_at(guess);
    }
    if bounds.len() >= MANY {
        set.leap();
    }
    let multiplier = set.minimise();
    set.watch.ask(f64::NAN)?;
    let energy = energy.value(&set.q);
    if !energy.is_finite() {
        return Err(ProgramError::NotFinite);
    }
    Ok((Optimum { curvatures: set.q, energy, multiplier, held: set.held }, set.work))
}

/// A feasible point, and which of its variables are held.
struct ActiveSet<'a> {
    energy: &'a Quadratic<'a>,
    bounds: &'a [[f64; 2]],
    total: Option<f64>,
    q: Vec<f64>,
    held: Vec<Held>,
    /// The last factor, and the free variables that it is of: steps that are repeated take it again.
    factor: Option<(Vec<usize>, Cholesky)>,
    /// The sum of the third powers of the sizes of what was factored.
    work: u64,
    /// What it is stopped by, between rows of a factor.
    watch: Watch<'a>,
}

impl<'a> ActiveSet<'a> {
    /// The point that is as far on the way from lower to upper bound in every variable.
    fn feasible(energy: &'a Quadratic<'a>, bounds: &'a [[f64; 2]], total: Option<f64>) -> Result<Self, ProgramError> {
        let n = bounds.len();
        let (linear, matrix) = (energy.linear.len(), energy.matrix.len());
        if linear != n || matrix != n * n {
            return Err(ProgramError::Sizes { variables: n, linear, matrix });
        }
        let numbers = energy.linear.iter().chain(energy.matrix).chain(bounds.as_flattened()).chain(&total);
        if !numbers.copied().all(f64::is_finite) {
            return Err(ProgramError::NotFinite);
        }
        if let Some(index) = bounds.iter().position(|[lower, upper]| lower > upper) {
            let [lower, upper] = bounds[index];
            return Err(ProgramError::CrossedBounds { index, lower, upper });
        }
        let [least, most] = [0, 1].map(|side| bounds.iter().map(|bound| bound[side]).sum::<f64>());
        let mut way = 0.5;
        if let Some(total) = total {
            let size = bounds.as_flattened().iter().fold(total.abs(), |size, bound| size + bound.abs());
            if total < least - SUM_TOLERANCE * size || total > most + SUM_TOLERANCE * size {
                return Err(ProgramError::Infeasible { total, least, most });
            }
            way = if most > least { ((total - least) / (most - least)).clamp(0.0, 1.0) } else { 0.0 };
        }
        let between = |&[lower, upper]: &[f64; 2]| (lower + way * (upper - lower)).clamp(lower, upper);
        let held = bounds.iter().map(|[lower, upper]| if lower == upper { Held::Lower } else { Held::Free });
        let q = bounds.iter().map(between).collect();
        Ok(Self { energy, bounds, total, q, held: held.collect(), factor: None, work: 0, watch: Watch::NONE })
    }

    /// Goes to the feasible point near a guess: all variables as far on their ways to one of their bounds as the sum asks for.
    fn begin_at(&mut self, guess: &[f64]) {
        self.q = guess.iter().zip(self.bounds).map(|(q, [lower, upper])| q.clamp(*lower, *upper)).collect();
        self.bring_sum_about((0..guess.len()).collect());
        for (i, &[lower, upper]) in self.bounds.iter().enumerate() {
            let q = self.q[i];
            self.q[i] = q.clamp(lower, upper);
            self.held[i] = match q {
                _ if q <= lower => Held::Lower,
                _ if q >= upper => Held::Upper,
                _ => Held::Free,
            };
        }
        self.restore_sum();
    }

    /// Goes where the primal-dual active set method leads: over and over to the minimum over the free variables as if there were no
    /// bounds, after which all that are beyond theirs are held there, and all that pull inwards let go. Where that ends it is the minimum; where it does
    /// not soon, and the energy has not fallen, all stays as it was.
    fn leap(&mut self) {
        let before = (self.q.clone(), self.held.clone(), self.energy.value(&self.q));
        for _ in 0..LEAPS {
            let gradient = self.energy.half_gradient(&self.q);
            let Some(direction) = self.direction(&gradient).filter(|_| !self.watch.stops_at(f64::NAN)) else { break };
            self.q.iter_mut().zip(&direction).for_each(|(q, d)| *q += d);
            let gradient = self.energy.half_gradient(&self.q);
            let multiplier = self.multiplier(&gradient);
            let tolerance = self.tolerance(multiplier);
            let mut is_end = true;
            for (i, gradient) in gradient.iter().enumerate() {
                let (pull, [lower, upper]) = (gradient + multiplier, self.bounds[i]);
                let held = match self.held[i] {
                    Held::Free if self.q[i] < lower => Held::Lower,
                    Held::Free if self.q[i] > upper => Held::Upper,
                    Held::Lower if pull < -tolerance && lower < upper => Held::Free,
                    Held::Upper if pull > tolerance => Held::Free,
                    held => held,
                };
                is_end &= held == self.held[i];
                self.held[i] = held;
            }
            if is_end {
                break;
            }
            self.hold();
        }
        self.q.iter_mut().zip(self.bounds).for_each(|(q, [lower, upper])| *q = q.clamp(*lower, *upper));
        self.hold();
        self.bring_sum_about(self.free());
        self.restore_sum();
        let energy = self.energy.value(&self.q);
        let is_good = self.keeps_sum() && energy <= before.2; // not so with NaN either
        if !is_good {
            (self.q, self.held) = (before.0, before.1);
        }
    }

    /// Puts held variables to their bounds, and gives what the sum misses to a free one.
    fn hold(&mut self) {
        for (i, [lower, upper]) in self.bounds.iter().enumerate() {
            match self.held[i] {
                Held::Free => {}
                Held::Lower => self.q[i] = *lower,
                Held::Upper => self.q[i] = *upper,
            }
        }
        if let (Some(total), Some(&i)) = (self.total, self.free().first()) {
            self.q[i] += total - self.q.iter().sum::<f64>();
        }
    }

    /// Moves some variables as far on their ways to one of their bounds as the sum asks for.
    fn bring_sum_about(&mut self, variables: Vec<usize>) {
        let Some(total) = self.total else { return };
        let missing = total - self.q.iter().sum::<f64>();
        let side = usize::from(missing > 0.0);
        let room: f64 = variables.iter().map(|&i| self.bounds[i][side] - self.q[i]).sum();
        let share = if room == 0.0 { 0.0 } else { (missing / room).clamp(0.0, 1.0) };
        variables.into_iter().for_each(|i| self.q[i] += share * (self.bounds[i][side] - self.q[i]));
    }

    /// Steps until no variable pulls inwards; returns the sum's multiplier.
    fn minimise(&mut self) -> f64 {
        let mut repeats = 0;
        // A variable comes to a bound and leaves it once or twice; what takes longer goes round in circles.
        for _ in 0..50 + 20 * self.q.len() {
            if self.watch.stops_at(f64::NAN) {
                break;
            }
            let gradient = self.energy.half_gradient(&self.q);
            let multiplier = self.multiplier(&gradient);
            let tolerance = self.tolerance(multiplier);
            let is_minimum = self.free().iter().all(|&i| (gradient[i] + multiplier).abs() <= tolerance);
            if !is_minimum && repeats < REPEATS {
                let before = self.q.clone();
                let blocked = self.step(&gradient);
                // A step that leads nowhere would not when repeated.
                let is_last = self.q == before;
                repeats = if blocked {
                    0
                } else if is_last {
                    REPEATS
                } else {
                    repeats + 1
                };
            } else if self.release(&gradient, multiplier, tolerance) {
                repeats = 0;
            } else {
                break;
            }
        }
        self.multiplier(&self.energy.half_gradient(&self.q))
    }

    /// Below what a gradient is rounding.
    fn tolerance(&self, multiplier: f64) -> f64 {
        let size = |i: usize| {
            let terms = self.energy.row(i).iter().zip(&self.q).map(|(h, q)| (h * q).abs());
            self.energy.linear[i].abs() + multiplier.abs() + terms.sum::<f64>()
        };
        GRADIENT_TOLERANCE * (0..self.q.len()).map(size).fold(0.0, f64::max)
    }

    /// Whether the variables have the sum that they should, up to rounding.
    fn keeps_sum(&self) -> bool {
        let size: f64 = self.q.iter().map(|q| q.abs()).sum();
        self.total
            .is_none_or(|total| (self.q.iter().sum::<f64>() - total).abs() <= SUM_TOLERANCE * (size + total.abs()))
    }

    fn is_fixed(&self, i: usize) -> bool {
        self.bounds[i][0] == self.bounds[i][1]
    }

    fn free(&self) -> Vec<usize> {
        (0..self.q.len()).filter(|&i| self.held[i] == Held::Free).collect()
    }

    /// Goes to the minimum over the free variables, or to the first bound on the way; whether there was one.
    fn step(&mut self, gradient: &[f64]) -> bool {
        let Some(direction) = self.direction(gradient) else { return false };
        let slope = dot(gradient, &direction);
        let curved = (0..self.q.len()).map(|i| direction[i] * dot(self.energy.row(i), &direction)).sum::<f64>();
        if slope >= 0.0 {
            return false;
        }
        let mut length = if curved > 0.0 { -slope / curved } else { f64::INFINITY };
        let mut blocking = None;
        for (i, &d) in direction.iter().enumerate().filter(|&(_, &d)| d != 0.0) {
            let side = usize::from(d > 0.0);
            let room = ((self.bounds[i][side] - self.q[i]) / d).max(0.0);
            if room < length {
                (length, blocking) = (room, Some((i, side)));
            }
        }
        for (i, d) in direction.iter().enumerate() {
            self.q[i] = (self.q[i] + length * d).clamp(self.bounds[i][0], self.bounds[i][1]);
        }
        if let Some((i, side)) = blocking {
            self.q[i] = self.bounds[i][side];
            self.held[i] = [Held::Lower, Held::Upper][side];
        }
        self.restore_sum();
        blocking.is_some()
    }

    /// The Newton direction of the free variables that keeps the sum; none where nothing can move.
    fn direction(&mut self, gradient: &[f64]) -> Option<Vec<f64>> {
        let mut free = self.free();
        let all_free = free.clone();
        // With the sum given the last free variable moves against all others.
        let last = if self.total.is_some() { Some(free.pop()?) } else { None };
        if free.is_empty() {
            return None;
        }
        if self.factor.as_ref().is_none_or(|(of, _)| *of != all_free) {
            self.work += (free.len() as u64).pow(3);
            self.factor = Some((all_free, Cholesky::new(free.len(), self.reduced(&free, last), self.watch)));
        }
        let (_, factor) = self.factor.as_ref()?;
        let downhill = free.iter().map(|&i| last.map_or(0.0, |p| gradient[p]) - gradient[i]).collect();
        let solution = factor.solve(downhill);
        let mut direction = vec![0.0; self.q.len()];
        for (&i, &d) in free.iter().zip(&solution) {
            direction[i] = d;
        }
        if let Some(p) = last {
            direction[p] = -solution.iter().sum::<f64>();
        }
        direction.iter().all(|d| d.is_finite()).then_some(direction)
    }

    /// The matrix of the free variables where `last` moves against them, up to the diagonal.
    fn reduced(&self, free: &[usize], last: Option<usize>) -> Vec<f64> {
        let n = free.len();
        let mut matrix = Vec::with_capacity(n * n);
        for (k, &i) in free.iter().enumerate() {
            let row = self.energy.row(i);
            match last.map(|p| (p, self.energy.row(p))) {
                Some((p, across)) => matrix.extend(free[..=k].iter().map(|&j| row[j] - row[p] - across[j] + across[p])),
                None => matrix.extend(free[..=k].iter().map(|&j| row[j])),
            }
            matrix.resize((k + 1) * n, 0.0);
        }
        matrix
    }

    /// Gives what rounding took from the sum to the free variable that is farthest from its bounds.
    fn restore_sum(&mut self) {
        let Some(total) = self.total else { return };
        let room = |i: usize| (self.q[i] - self.bounds[i][0]).min(self.bounds[i][1] - self.q[i]);
        if let Some(i) = self.free().into_iter().max_by(|&i, &j| room(i).total_cmp(&room(j))) {
            let missing = total - self.q.iter().sum::<f64>();
            self.q[i] = (self.q[i] + missing).clamp(self.bounds[i][0], self.bounds[i][1]);
        }
    }

    /// The sum's multiplier: what makes the gradient vanish at free variables, and where there are none as good as it
    /// gets at the held ones.
    fn multiplier(&self, gradient: &[f64]) -> f64 {
        let free = self.free();
        if self.total.is_none() {
            return 0.0;
        }
        if !free.is_empty() {
            return -free.iter().map(|&i| gradient[i]).sum::<f64>() / free.len() as f64;
        }
        match [self.pulling_up(gradient), self.pulling_down(gradient)] {
            [Some(i), Some(j)] => -0.5 * (gradient[i] + gradient[j]),
            [Some(i), None] | [None, Some(i)] => -gradient[i],
            [None, None] => 0.0,
        }
    }

    /// The variable at its lower bound that would gain most by growing.
    fn pulling_up(&self, gradient: &[f64]) -> Option<usize> {
        let lower = (0..self.q.len()).filter(|&i| self.held[i] == Held::Lower && !self.is_fixed(i));
        lower.min_by(|&i, &j| gradient[i].total_cmp(&gradient[j]))
    }

    /// The variable at its upper bound that would gain most by shrinking.
    fn pulling_down(&self, gradient: &[f64]) -> Option<usize> {
        let upper = (0..self.q.len()).rev().filter(|&i| self.held[i] == Held::Upper);
        upper.max_by(|&i, &j| gradient[i].total_cmp(&gradient[j]))
    }

    /// Lets go the held variable that pulls inwards most, or a pair where nothing else is free; whether there is one.
    fn release(&mut self, gradient: &[f64], multiplier: f64, tolerance: f64) -> bool {
        let up = self.pulling_up(gradient).map(|i| (-gradient[i] - multiplier, i));
        let down = self.pulling_down(gradient).map(|i| (gradient[i] + multiplier, i));
        let mut pulling: Vec<_> = [up, down].into_iter().flatten().filter(|&(pull, _)| pull > tolerance).collect();
        if self.total.is_none() || !self.free().is_empty() {
            pulling.sort_by(|a, b| b.0.total_cmp(&a.0));
            pulling.truncate(1);
        } else if pulling.len() < 2 {
            return false; // with the sum given, one alone cannot move
        }
        for &(_, i) in &pulling {
            self.held[i] = Held::Free;
        }
        !pulling.is_empty()
    }
}

/// A dense Cholesky factor of a matrix with a ridge.
struct Cholesky {
    n: usize,
    /// Row by row; what is above the diagonal is not used.
    factor: Vec<f64>,
}

impl Cholesky {
    /// Where the watch says stop what is returned is none.
    fn new(n: usize, mut a: Vec<f64>, watch: Watch) -> Self {
        let largest = (0..n).map(|i| a[i * n + i]).fold(0.0, f64::max);
        let ridge = if largest > 0.0 { RIDGE * largest } else { 1.0 };
        // Each entry needs the product of two rows. Those of a row are summed up side by side, which takes a fifth of the
        // time that one after the other takes, and gives the same bits.
        let mut columns = vec![0.0; n * n];
        let mut products = vec![0.0; n];
        for i in 0..n {
            if i % ROWS_AT_ONCE == 0 && watch.stops_at(f64::NAN) {
                break;
            }
            a[i * n + i] += ridge;
            products[..=i].fill(-0.0);
            for j in 0..=i {
                let rest = a[i * n + j] - products[j];
                let entry = if j == i { rest.max(ridge).sqrt() } else { rest / a[j * n + j] };
                a[i * n + j] = entry;
                columns[j * n + i] = entry;
                let column = &columns[j * n + j + 1..=j * n + i];
                products[j + 1..=i].iter_mut().zip(column).for_each(|(sum, other)| *sum += entry * other);
            }
        }
        Self { n, factor: a }
    }

    fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        let (n, l) = (self.n, &self.factor);
        for i in 0..n {
            x[i] = (x[i] - dot(&l[i * n..i * n + i], &x[..i])) / l[i * n + i];
        }
        for i in (0..n).rev() {
            x[i] /= l[i * n + i];
            for j in 0..i {
                x[j] -= l[i * n + j] * x[i];
            }
        }
        x
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A problem that has a solution, on purpose with matrices of low rank, variables that cannot move and sums at the
    /// ends of what the bounds allow.
    #[derive(Clone, Debug)]
    struct Problem {
        linear: Vec<f64>,
        matrix: Vec<f64>,
        bounds: Vec<[f64; 2]>,
        total: Option<f64>,
    }

    impl Problem {
        fn energy(&self) -> Quadratic<'_> {
            Quadratic { constant: 1.0, linear: &self.linear, matrix: &self.matrix }
        }
    }

    prop_compose! {
        fn problem(most: usize)(n in 1..=most, rank in 1..=most)(
            root in prop::collection::vec(-1.0..1.0f64, n * rank),
            target in prop::collection::vec(-3.0..3.0f64, n),
            bounds in prop::collection::vec((-2.0..2.0f64, prop_oneof![3 => 0.1..3.0f64, 1 => Just(0.0)]), n),
            way in prop_oneof![4 => prop::option::of(0.0..1.0f64), 1 => Just(Some(0.0)), 1 => Just(Some(1.0))],
        ) -> Problem {
            let n = target.len();
            let rows: Vec<_> = root.chunks(root.len() / n).collect();
            let matrix: Vec<f64> = rows.iter().flat_map(|a| rows.iter().map(|b| dot(a, b))).collect();
            // b in the range of H, as where E is a squared norm
            let linear = (0..n).map(|i| -dot(&matrix[i * n..(i + 1) * n], &target)).collect();
            let bounds: Vec<_> = bounds.into_iter().map(|(lower, width)| [lower, lower + width]).collect();
            let total = way.map(|way| bounds.iter().map(|[lower, upper]| lower + way * (upper - lower)).sum());
            Problem { linear, matrix, bounds, total }
        }
    }

    /// The least energy over all choices of held variables, each by Gaussian elimination of its KKT system.
    fn by_enumeration(problem: &Problem) -> f64 {
        let n = problem.bounds.len();
        let has_total = problem.total.is_some();
        let mut best = f64::INFINITY;
        for choice in 0..3usize.pow(n as u32) {
            let digit = |i: usize| choice / 3usize.pow(i as u32) % 3;
            let all_held = (0..n).all(|i| digit(i) < 2);
            let mut system: Vec<Vec<f64>> = (0..n)
                .map(|i| {
                    let unit = (0..n).map(|j| f64::from(i == j));
                    let row = problem.matrix[i * n..(i + 1) * n].iter().copied();
                    match digit(i) {
                        2 => row.chain([f64::from(has_total), -problem.linear[i]]).collect(),
                        side => unit.chain([0.0, problem.bounds[i][side]]).collect(),
                    }
                })
                .collect();
            // With all held the sum is right or is not, and the multiplier is of no account.
            let in_sum = f64::from(has_total && !all_held);
            let right = if all_held { 0.0 } else { problem.total.unwrap_or(0.0) };
            system.push([vec![in_sum; n], vec![1.0 - in_sum, right]].concat());
            let Some(q) = eliminate(system) else { continue };
            let inside = (0..n).all(|i| (problem.bounds[i][0] - 1e-9..=problem.bounds[i][1] + 1e-9).contains(&q[i]));
            let sum_holds = problem.total.is_none_or(|total| (q[..n].iter().sum::<f64>() - total).abs() < 1e-9);
            if inside && sum_holds {
                best = best.min(problem.energy().value(&q[..n]));
            }
        }
        best
    }

    fn eliminate(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
        let n = rows.len();
        for k in 0..n {
            let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
            rows.swap(k, pivot);
            if rows[k][k].abs() < 1e-9 {
                return None;
            }
            for i in (0..n).filter(|&i| i != k) {
                let factor = rows[i][k] / rows[k][k];
                let pivot_row = rows[k].clone();
                rows[i].iter_mut().zip(pivot_row).for_each(|(entry, above)| *entry -= factor * above);
            }
        }
        Some((0..n).map(|k| rows[k][n] / rows[k][k]).collect())
    }

    /// Asserts that a fit is feasible and that nothing pulls inwards.
    fn check(problem: &Problem, optimum: &Optimum) {
        let gradient = problem.energy().half_gradient(&optimum.curvatures);
        let scale = 1.0 + problem.linear.iter().chain(&problem.matrix).fold(0.0, |a: f64, b| a.max(b.abs()));
        for (i, &q) in optimum.curvatures.iter().enumerate() {
            let [lower, upper] = problem.bounds[i];
            assert!(lower <= q && q <= upper);
            let pull = gradient[i] + optimum.multiplier;
            match optimum.held[i] {
                Held::Free => assert!(pull.abs() < 1e-8 * scale, "free {i} feels {pull}"),
                Held::Lower => {
                    assert!(q == lower && (pull > -1e-8 * scale || lower == upper), "lower {i} feels {pull}");
                }
                Held::Upper => assert!(q == upper && pull < 1e-8 * scale, "upper {i} feels {pull}"),
            }
        }
        if let Some(total) = problem.total {
            let size = optimum.curvatures.iter().fold(total.abs(), |size, q| size + q.abs());
            assert!((optimum.curvatures.iter().sum::<f64>() - total).abs() <= 1e-12 * size, "the sum holds");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(512))]

        #[test]
        fn nothing_pulls_inwards_at_the_minimum(problem in problem(24)) {
            check(&problem, &minimise(&problem.energy(), &problem.bounds, problem.total).unwrap());
        }

        #[test]
        fn the_minimum_is_the_least_over_all_active_sets(problem in problem(5)) {
            let optimum = minimise(&problem.energy(), &problem.bounds, problem.total).unwrap();
            let expected = by_enumeration(&problem);
            prop_assert!((optimum.energy - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{} is {expected}", optimum.energy);
        }

        #[test]
        fn a_leap_keeps_to_bounds_and_sum_raises_no_energy_and_changes_no_minimum(problem in problem(5)) {
            let (energy, expected) = (problem.energy(), by_enumeration(&problem));
            let mut set = ActiveSet::feasible(&energy, &problem.bounds, problem.total).unwrap();
            let before = energy.value(&set.q);
            set.leap();
            prop_assert!(energy.value(&set.q) <= before && set.keeps_sum());
            prop_assert!(set.q.iter().zip(&problem.bounds).all(|(q, [lower, upper])| (lower..=upper).contains(&q)));
            set.minimise();
            let reached = energy.value(&set.q);
            prop_assert!((reached - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{reached} is {expected}");
        }

        #[test]
        fn bounds_never_lower_the_energy(problem in problem(12)) {
            let bounded = minimise(&problem.energy(), &problem.bounds, problem.total).unwrap();
            let wide: Vec<_> = problem.bounds.iter().map(|[lower, upper]| [lower - 50.0, upper + 50.0]).collect();
            let unbounded = minimise(&problem.energy(), &wide, problem.total).unwrap();
            prop_assert!(bounded.energy >= unbounded.energy - 1e-9 * (1.0 + unbounded.energy.abs()));
        }

        #[test]
        fn scaling_the_energy_changes_no_curvature(problem in problem(8), exponent in -20i32..20) {
            let scale = 4f64.powi(exponent); // which has an exact square root
            let scaled = Problem {
                linear: problem.linear.iter().map(|b| b * scale).collect(),
                matrix: problem.matrix.iter().map(|h| h * scale).collect(),
                ..problem.clone()
            };
            let before = minimise(&problem.energy(), &problem.bounds, problem.total).unwrap();
            let after = minimise(&scaled.energy(), &problem.bounds, problem.total).unwrap();
            prop_assert_eq!(before.curvatures, after.curvatures);
        }
    }

    #[test]
    fn a_hundred_cones_in_pairs_that_nearly_coincide_are_fitted() {
        let n = 128;
        // The Gram matrix of exp(-|x - y|) for points in close pairs.
        let at = |i: usize| (i / 2) as f64 + 1e-7 * (i % 2) as f64;
        let matrix: Vec<f64> = (0..n * n).map(|k| (-(at(k / n) - at(k % n)).abs()).exp()).collect();
        let linear: Vec<f64> = (0..n).map(|i| (i as f64 * 1.7).sin()).collect();
        let problem = Problem { linear, matrix, bounds: vec![[-0.5, 0.4]; n], total: Some(3.0) };
        let optimum = minimise(&problem.energy(), &problem.bounds, problem.total).unwrap();
        check(&problem, &optimum);
        assert!(
            optimum.held.contains(&Held::Lower)
                && optimum.held.contains(&Held::Upper)
                && optimum.held.contains(&Held::Free)
        );
    }

    #[test]
    fn what_has_no_quadratic_part_goes_to_its_bounds() {
        let energy = Quadratic { constant: 0.0, linear: &[1.0, -2.0, 0.5], matrix: &[0.0; 9] };
        let optimum = minimise(&energy, &[[-1.0, 1.0]; 3], Some(0.0)).unwrap();
        assert_eq!(optimum.curvatures, [-1.0, 1.0, 0.0]);
        assert_eq!(optimum.multiplier, -0.5);
    }

    #[test]
    fn no_cones_are_fitted_where_nothing_is_asked() {
        let nothing = Quadratic { constant: 2.5, linear: &[], matrix: &[] };
        assert_eq!(minimise(&nothing, &[], None).unwrap().energy, 2.5);
        assert_eq!(minimise(&nothing, &[], Some(0.0)).unwrap().energy, 2.5);
        let sphere = minimise(&nothing, &[], Some(12.0)).unwrap_err();
        assert_eq!(sphere, ProgramError::Infeasible { total: 12.0, least: 0.0, most: 0.0 });
    }

    #[test]
    fn what_cannot_be_fitted_is_refused_by_name() {
        let energy = Quadratic { constant: 0.0, linear: &[1.0, 1.0], matrix: &[1.0, 0.0, 0.0, 1.0] };
        let two_cones = minimise(&energy, &[[-1.0, 5.0]; 2], Some(12.0)).unwrap_err();
        assert_eq!(two_cones, ProgramError::Infeasible { total: 12.0, least: -2.0, most: 10.0 });
        let crossed = minimise(&energy, &[[0.0, 1.0], [2.0, 1.0]], None).unwrap_err();
        assert_eq!(crossed, ProgramError::CrossedBounds { index: 1, lower: 2.0, upper: 1.0 });
        assert_eq!(minimise(&energy, &[[0.0, f64::NAN]; 2], None).unwrap_err(), ProgramError::NotFinite);
        assert_eq!(minimise(&energy, &[[-1e308, 1e308]; 2], Some(3.0)).unwrap_err(), ProgramError::NotFinite);
        assert!(matches!(minimise(&energy, &[[0.0, 1.0]; 3], None), Err(ProgramError::Sizes { .. })));
    }

    #[test]
    fn many_variables_are_stopped_between_rows_of_a_factor() {
        use std::ops::ControlFlow;
        use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
        let n = 400;
        let matrix: Vec<f64> = (0..n * n).map(|k| if k % (n + 1) == 0 { 2.0 } else { 1.0 / n as f64 }).collect();
        let linear = vec![-1.0; n];
        let energy = Quadratic { constant: 0.0, linear: &linear, matrix: &matrix };
        let bounds = vec![[-1.0, 1.0]; n];
        let asked = AtomicUsize::new(0);
        let goes_on = |most: usize| {
            let asked = &asked;
            move |_: f64| match asked.fetch_add(1, Relaxed) < most {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        };
        let (few, all) = (goes_on(3), goes_on(usize::MAX));
        let stopped = minimise_watched(&energy, &bounds, Some(1.0), Watch::new(&few));
        assert_eq!(stopped, Err(ProgramError::Interrupted(Interrupted)));
        assert!(asked.load(Relaxed) < 3 + 8, "it goes on for {} looks", asked.load(Relaxed));
        let done = minimise_watched(&energy, &bounds, Some(1.0), Watch::new(&all)).unwrap();
        assert_eq!(done, minimise(&energy, &bounds, Some(1.0)).unwrap());
    }
}
