//! Wasserstein distances of diagrams, and the matchings they come from.

use super::Diagram;
use super::assignment::{Costs, assign};
use super::auction::{Scale, bid};
use super::bottleneck::bottleneck;
use super::ground::{Ground, Point, bounded};
use super::unbounded::{self, Matched};
use crate::error::Error;
use crate::pairing::NONE;
use crate::watch::Watch;

/// How to measure the distance of two diagrams: the least possible p-norm of all steps when each point of one diagram goes to
/// one of the other or to the diagonal, to each its own. p is the order; steps are measured by a ground metric.
///
/// ```
/// use topo::{Path, Wasserstein};
///
/// let one = topo::sublevel(&Path::new(5), &[0.0, 6.0, 2.0, 9.0, 5.0])?.diagram();
/// let other = topo::sublevel(&Path::new(5), &[0.0, 6.0, 1.5, 9.0, 8.0])?.diagram();
/// assert_eq!(one.wasserstein(&other, 1.0)?, 0.5 + 2.5); // (2, 6) goes to (1.5, 6); (5, 9) to (8, 9) is 3, to the diagonals 2.5
/// let euclidean = Wasserstein::new(2.0).ground(2.0).matching(&one, &other)?;
/// println!("{} by {:?}", euclidean.distance, euclidean.finite);
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use = "it measures when it is asked to"]
pub struct Wasserstein {
    order: f64,
    ground: f64,
    relative_error: f64,
}

/// Diagrams with this many points are matched exactly, whatever error is allowed: below it that is as fast.
const EXACT: usize = 200;

/// A cost that nothing worth while has; that of all points together is finite.
const FAR: f64 = 1e200;

/// The relative error by default.
const RELATIVE_ERROR: f64 = 0.01;

/// Which points of two diagrams go to each other.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Matching {
    /// The p-norm of all steps; infinite if points that cannot go to the diagonal have no partner, and then the lists are empty.
    pub distance: f64,
    /// Places among the finite pairs of both diagrams, each place once; `None` is the diagonal.
    pub finite: Vec<[Option<usize>; 2]>,
    /// Places among the essential classes of both.
    pub essential: Vec<[usize; 2]>,
}

impl Wasserstein {
    /// Distances of order p, which is 1 at least; of infinite order they are bottleneck distances. Steps are measured by the
    /// larger of the differences in birth and death.
    pub fn new(order: f64) -> Self {
        Self { order, ground: f64::INFINITY, relative_error: RELATIVE_ERROR }
    }

    /// Measures steps by the norm Lq of the differences in birth and death; q is 1 at least, and 2 is the Euclidean one.
    pub fn ground(self, norm: f64) -> Self {
        Self { ground: norm, ..self }
    }

    /// By how much a distance may exceed the least one, as a part of it: 0.01 by default. Diagrams of 200 points and fewer,
    /// and bottleneck distances, are exact whatever is allowed; with 0 all are.
    pub fn relative_error(self, error: f64) -> Self {
        Self { relative_error: error, ..self }
    }

    /// The distance of two diagrams. It is that of a matching: never too small, and too large by the relative error at most, or by
    /// rounding: of p-th powers of steps beside that of the longest way to a diagonal.
    ///
    /// For n points an exact distance takes O(n³) at worst, an approximate one by measurement little more than n log n for each
    /// halving of the error.
    ///
    /// # Errors
    /// If one is of minima and the other of maxima, if a coordinate is NaN, if the order or the norm is not 1 at least, or
    /// if the relative error is negative.
    pub fn distance(self, a: &Diagram, b: &Diagram) -> Result<f64, Error> {
        self.distance_watched(a, b, Watch::NONE)
    }

    /// [`distance`](Self::distance) that can be stopped.
    ///
    /// # Errors
    /// As [`distance`](Self::distance); [`Error::Interrupted`] if the watch has stopped the work.
    pub fn distance_watched(self, a: &Diagram, b: &Diagram, watch: Watch<'_>) -> Result<f64, Error> {
        if self.order == f64::INFINITY {
            self.check(a, b)?;
            return watch.held(|watch| self.bottleneck(a, b, watch));
        }
        Ok(self.matching_watched(a, b, watch)?.distance)
    }

    /// The distance of two diagrams with a matching that has it.
    ///
    /// # Errors
    /// As [`distance`](Self::distance).
    pub fn matching(self, a: &Diagram, b: &Diagram) -> Result<Matching, Error> {
        self.matching_watched(a, b, Watch::NONE)
    }

    /// [`matching`](Self::matching) that can be stopped.
    ///
    /// # Errors
    /// As [`distance_watched`](Self::distance_watched).
    pub fn matching_watched(self, a: &Diagram, b: &Diagram, watch: Watch<'_>) -> Result<Matching, Error> {
        self.check(a, b)?;
        watch.held(|watch| self.matched(a, b, watch))
    }

    fn matched(self, a: &Diagram, b: &Diagram, watch: Watch<'_>) -> Result<Matching, Error> {
        let (Some(essential), Some(infinite)) = (unbounded::essential(a, b), unbounded::infinite(a, b)) else {
            return Ok(Matching { distance: f64::INFINITY, finite: Vec::new(), essential: Vec::new() });
        };
        let ((places_a, a_points), (places_b, b_points)) = (bounded(a), bounded(b));
        let reach = if self.order == f64::INFINITY { self.bottleneck(a, b, watch)? } else { f64::INFINITY };
        let matched = self.match_bounded(&a_points, &b_points, reach, watch);
        if watch.stops() {
            return Err(Error::Interrupted);
        }
        let mut steps = [essential.steps, infinite.steps].concat();
        steps.extend(matched.iter().map(|&pair| self.step(&a_points, &b_points, pair)));
        let finite = infinite.pairs.iter().map(|pair| pair.map(Some));
        let bounded = matched.iter().map(|[p, q]| [p.map(|p| places_a[p]), q.map(|q| places_b[q])]);
        Ok(Matching {
            distance: norm(&steps, self.order),
            finite: finite.chain(bounded).collect(),
            essential: essential.pairs,
        })
    }

    fn check(self, a: &Diagram, b: &Diagram) -> Result<(), Error> {
        let is_norm = |power: f64| power >= 1.0;
        let is_nothing = |diagram: &Diagram| {
            diagram.essential.is_empty() && diagram.finite.iter().all(|(birth, death)| birth == death)
        };
        // What has only points on the diagonal is of either kind.
        if a.kind != b.kind && !is_nothing(a) && !is_nothing(b) {
            return Err(Error::Directions);
        }
        if !is_norm(self.order) || !is_norm(self.ground) {
            return Err(Error::Order);
        }
        if self.relative_error.is_nan() || self.relative_error < 0.0 {
            return Err(Error::RelativeError);
        }
        for diagram in [a, b] {
            let point = |&(birth, death): &Point| birth.is_nan() || death.is_nan();
            let place = diagram.finite.iter().position(point);
            let class = diagram.essential.iter().position(|birth| birth.is_nan());
            if let Some(point) = place.or(class) {
                return Err(Error::Point { point });
            }
        }
        Ok(())
    }

    fn bottleneck(self, a: &Diagram, b: &Diagram, watch: Watch<'_>) -> Result<f64, Error> {
        let steps = |matched: Option<Matched>| matched.map_or(vec![f64::INFINITY], |matched| matched.steps);
        let unbounded = [steps(unbounded::essential(a, b)), steps(unbounded::infinite(a, b))].concat();
        let least = unbounded.into_iter().fold(0.0, f64::max);
        let distance = bottleneck(&bounded(a).1, &bounded(b).1, Ground(self.ground), least, watch);
        if watch.stops() { Err(Error::Interrupted) } else { Ok(distance) }
    }

    fn step(self, a: &[Point], b: &[Point], pair: [Option<usize>; 2]) -> f64 {
        let ground = Ground(self.ground);
        match pair {
            [Some(p), Some(q)] => ground.distance(a[p], b[q]),
            [Some(p), None] => ground.to_diagonal(a[p]),
            [None, Some(q)] => ground.to_diagonal(b[q]),
            [None, None] => 0.0,
        }
    }

    /// The cheapest matching of points with finite coordinates; any if the watch has stopped the work. Steps longer than the reach are
    /// not taken.
    fn match_bounded(self, a: &[Point], b: &[Point], reach: f64, watch: Watch<'_>) -> Vec<[Option<usize>; 2]> {
        // Rows are the fewer ones.
        if a.len() > b.len() {
            let swapped = self.match_bounded(b, a, reach, watch);
            return swapped.into_iter().map(|[q, p]| [p, q]).collect();
        }
        let scale = Units::new(a, b, self);
        let is_exact = b.len() <= EXACT || self.relative_error == 0.0 || reach < f64::INFINITY;
        // Both are sums of powers of steps.
        let allowed = (1.0 + self.relative_error).powf(self.order);
        let near = if is_exact { None } else { bid(a, b, &scale, |cost, bound| cost <= bound * allowed, watch) };
        let columns = near.unwrap_or_else(|| assign(&Steps::new(a, b, &scale, reach), watch));
        let mut is_taken = vec![false; b.len()];
        columns.iter().filter(|&&column| column != NONE).for_each(|&column| is_taken[column as usize] = true);
        let rows = columns.iter().enumerate().map(|(p, &q)| [Some(p), (q != NONE).then_some(q as usize)]);
        let left = is_taken.iter().enumerate().filter(|&(_, &is_taken)| !is_taken).map(|(q, _)| [None, Some(q)]);
        rows.chain(left).collect()
    }
}

/// The p-norm of some steps, scaled so that powers do not overflow.
fn norm(steps: &[f64], order: f64) -> f64 {
    let longest = steps.iter().copied().fold(0.0, f64::max);
    if order == f64::INFINITY || longest == 0.0 || longest == f64::INFINITY {
        return longest;
    }
    if order == 1.0 {
        return steps.iter().sum();
    }
    let sum: f64 = steps.iter().map(|step| (step / longest).powf(order)).sum();
    longest * sum.powf(order.recip())
}

/// By what power a step counts.
#[derive(Clone, Copy)]
enum Power {
    Integer(i32),
    Real(f64),
}

impl Power {
    fn of(self, step: f64) -> f64 {
        match self {
            Self::Integer(power) => step.powi(power),
            Self::Real(power) => step.powf(power),
        }
    }
}

/// What steps cost: their powers, in units of the longest step to the diagonal.
struct Units {
    ground: Ground,
    power: Power,
    unit: f64,
}

impl Units {
    fn new(a: &[Point], b: &[Point], Wasserstein { order, ground, .. }: Wasserstein) -> Self {
        let ground = Ground(ground);
        let unit = a.iter().chain(b).map(|&point| ground.to_diagonal(point)).fold(f64::MIN_POSITIVE, f64::max);
        // Within reach of a bottleneck distance any matching will do; of least sum is as good as any.
        let power = match order {
            f64::INFINITY => Power::Integer(1),
            1.0 | 2.0 | 3.0 | 4.0 => Power::Integer(order as i32),
            _ => Power::Real(order),
        };
        Self { ground, power, unit }
    }

    fn of(&self, step: f64) -> f64 {
        self.power.of(step / self.unit).min(FAR)
    }
}

impl Scale for Units {
    #[inline]
    fn cost(&self, along_births: f64, along_deaths: f64) -> f64 {
        self.of(self.ground.norm(along_births, along_deaths))
    }

    fn alone(&self, point: Point) -> f64 {
        self.of(self.ground.to_diagonal(point))
    }
}

/// Costs between the points of two diagrams.
struct Steps<'a> {
    a: &'a [Point],
    b: &'a [Point],
    units: &'a Units,
    reach: f64,
    alone: Vec<f64>,
    /// What each column costs at the diagonal.
    columns: Vec<f64>,
}

impl<'a> Steps<'a> {
    fn new(a: &'a [Point], b: &'a [Point], units: &'a Units, reach: f64) -> Self {
        let mut steps = Self { a, b, units, reach, alone: Vec::new(), columns: Vec::new() };
        let [alone, columns] =
            [a, b].map(|points| points.iter().map(|&point| steps.cost(units.ground.to_diagonal(point))).collect());
        (steps.alone, steps.columns) = (alone, columns);
        steps
    }

    /// What a step costs. Beyond the reach more than all others within it.
    #[inline]
    fn cost(&self, step: f64) -> f64 {
        let beyond = if step > self.reach { 2.0 * (self.a.len() + self.b.len()) as f64 } else { 0.0 };
        self.units.of(step) + beyond
    }
}

impl Costs for Steps<'_> {
    fn alone(&self) -> &[f64] {
        &self.alone
    }

    fn columns(&self) -> usize {
        self.columns.len()
    }

    fn write_row(&self, row: usize, costs: &mut [f64]) {
        let p = self.a[row];
        for ((cost, &q), &alone) in costs.iter_mut().zip(self.b).zip(&self.columns) {
            *cost = self.cost(self.units.ground.distance(p, q)) - alone;
        }
    }
}
