//! Newton's method for the metric with prescribed curvature.
//!
//! Each step solves with the Hessian, the Laplacian of the scaled metric, by conjugate gradients on the last factor that there is
//! ([`Poisson::solve_perturbed`]): mostly that of the unscaled surface, and then nothing is factored. Far from the cones and from spikes the
//! linear solution is good at once; where it is not, that part alone is solved for first, u held around it, so that the whole
//! is asked few times (a nonlinear Schwarz method; Cai & Keyes 2002). What is left is a line search on the directional derivative.

use std::sync::Arc;

use geom::{
    FaceId, Id, Interrupted, Intrinsic, Metric, Poisson, PoissonError, SymmetricMatrix, Triangulation, VertexData,
    VertexId, Watch, folded_laplacian, laplacian, ptolemaic_delaunay_watched,
};
use rayon::prelude::*;

use super::{Failed, Scaling, ScalingError};

/// The curvature error that counts as reached.
const ACCURACY: f64 = 1e-9;
/// Where Newton converges quadratically, it goes on to here: what is left distorts the layout.
pub(super) const GOAL: f64 = 1e-13;
/// From here one more step gets as far as rounding allows.
const LAST_STEP: f64 = 1e-10;
/// A step is found to this share of the error, and to the error's square: what a step leaves is of that order, however exact it is.
const FORCING: f64 = 0.03;
/// Vertices with more curvature left than this are solved for by themselves, with so many rings of triangles around them, down to [`MENDED`].
const ROUGH: f64 = 0.05;
const RINGS: usize = 4;
const MENDED: f64 = 1e-4;
/// If that is no more than this part of all triangles.
const SMALL_PART: usize = 8;
/// More steps than this, and the triangles are too degenerate for the method.
const MAX_STEPS: usize = 25;
/// Added to the Hessian's diagonal where triangles have no area. The least eigenvalue of the Laplacian of a surface with a
/// million vertices is about 4e-5.
const DAMPING: f64 = 1e-6;
/// No log scale factor changes by more than this in a step.
const MAX_STEP: f64 = 5.0;
/// Where so many steps have not brought the error down to [`HARDLY`] of the first one, the method is stuck: on a scan of 437,645 vertices
/// with cones in bad places it stayed at 0.6 to 1.1 of it for fifteen steps, and got stuck at 0.08 in the end. Where it does succeed there (8 to 64
/// cones by three methods), it is at 0.56 at most after four and at 0.1 after five; other large surfaces need three steps in all.
const PATIENCE: usize = 6;
/// Below so many vertices all steps cost little. A spindle squeezed by 10⁶ needs more than [`PATIENCE`].
const PATIENT_BELOW: usize = 20_000;
const HARDLY: f64 = 0.5;
/// From here on triangles at the boundary that have no area will have none in the end.
const SETTLED: f64 = 0.1;

/// So many triangles are looked at one after the other.
const AT_ONCE: usize = 4096;

#[derive(Clone)]
pub(super) struct Newton<'a> {
    /// The curvature wanted at each vertex that is not fixed.
    pub(super) target: &'a VertexData<f64>,
    /// The log scale factors to start from, where there are fixed vertices; otherwise it starts from 0.
    pub(super) start: &'a VertexData<f64>,
    /// Where u stays as it is; ascending for a whole surface.
    pub(super) fixed: Vec<VertexId>,
    /// On a double, the vertex of the surface for each of its own. Log scale factors are the same on both halves.
    pub(super) original: Option<&'a VertexData<VertexId>>,
    /// The error to reach.
    pub(super) goal: f64,
    pub(super) watch: Watch<'a>,
}

/// The last factor of a Laplacian of the surface that there is. Others are made in the same order of elimination, in its place where nobody
/// else has it.
pub(super) struct Factor {
    /// Nothing once a Laplacian could not be factored.
    poisson: Option<Arc<Poisson>>,
    /// Whether it is of the Laplacian that is asked for next, or one much like it.
    is_like: bool,
}

impl Factor {
    pub(super) fn new(poisson: Arc<Poisson>, is_like: bool) -> Self {
        Self { poisson: Some(poisson), is_like }
    }

    pub(super) fn is_lost(&self) -> bool {
        self.poisson.is_none()
    }

    fn refactor(&mut self, laplacian: SymmetricMatrix, watch: Watch) -> Result<&Poisson, PoissonError> {
        let new = match Arc::try_unwrap(self.poisson.take().expect("it is not lost")) {
            Ok(own) => own.refactor_watched(laplacian, watch)?,
            Err(shared) => shared.another_watched(laplacian, watch)?,
        };
        self.is_like = true;
        Ok(self.poisson.insert(Arc::new(new)))
    }
}

/// Log scale factors, the metric scaled by them, and what its curvature lacks.
type Scaled = (VertexData<f64>, Metric, VertexData<f64>);

impl Newton<'_> {
    /// Finds the metric from a Delaunay triangulation on; its lengths stay unscaled while flips change it.
    pub(super) fn run(&self, mut state: Intrinsic, factor: &mut Factor) -> Result<Scaling, Failed> {
        let starts_at_zero = self.fixed.is_empty();
        let mut u = if starts_at_zero { VertexData::constant(self.start.len(), 0.0) } else { self.start.clone() };
        let mut metric = self.scaled(&mut state, &u);
        self.watch.ask(0.0)?;
        let mut residual = self.residual(&state.triangulation, &metric);
        let mut steps = 0;
        let mut last = false;
        let first = largest(&residual).1;
        let mut least = first;
        loop {
            let (vertex, error) = largest(&residual);
            // How much of the way from the first error to the last is done, in logarithms.
            let done = ((error / first).ln() / (self.goal / first).ln()).clamp(0.0, 1.0);
            self.watch.ask(done)?;
            if error <= self.goal || last || steps >= MAX_STEPS {
                return self.finish(state, u, metric, steps, error, vertex);
            }
            least = least.min(error);
            let is_large = self.target.len() >= PATIENT_BELOW;
            if is_large && steps >= PATIENCE && least > (HARDLY * first).max(SETTLED) {
                return Err(ScalingError::Hopeless { error, vertex }.into());
            }
            if error <= SETTLED
                && !self.fixed.is_empty()
                && self.original.is_none()
                && let Some(vertex) = self.without_area(&state.triangulation, &metric)
            {
                return Err(Failed { error: ScalingError::NoTriangle(vertex), u: Some(u) });
            }
            let watch = self.watch.within(done, done);
            let is_of_surface = factor.is_like && steps == 0 && starts_at_zero;
            let step = match &factor.poisson {
                Some(poisson) if is_of_surface => {
                    // What is lacking in exactness the next step corrects.
                    let mut step = [residual.clone()];
                    poisson.solve_many_in_place(&mut step, watch)?;
                    let [step] = step;
                    step
                }
                poisson => {
                    let tolerance = (error * error.min(FORCING)).max(0.2 * self.goal);
                    let hessian = || {
                        self.watch.ask(done)?;
                        Ok::<_, Interrupted>(self.hessian(&state.triangulation, &metric))
                    };
                    let step = match poisson.as_ref().filter(|_| factor.is_like) {
                        Some(like) => like.solve_perturbed(hessian()?, &residual, tolerance, watch)?,
                        None => None,
                    };
                    match step {
                        Some(step) => step,
                        None => factor.refactor(hessian()?, watch)?.solve_watched(&residual, watch)?,
                    }
                }
            };
            self.watch.ask(done)?;
            steps += 1;
            last = error <= LAST_STEP;
            let slope = dot(&step, &residual);
            if !slope.is_finite() {
                return Err(ScalingError::Stuck { error, vertex }.into());
            }
            if let Some(mended) = self.mended_step(&mut state, &u, &step, error)? {
                (u, metric, residual) = mended;
                continue;
            }
            let mut length = (MAX_STEP / step.iter().fold(0.0, |m: f64, d| m.max(d.abs()))).min(1.0);
            let from = u.clone();
            let mut halvings = 0;
            loop {
                u = from.iter().zip(step.iter()).map(|(u, d)| u + length * d).collect();
                metric = self.scaled(&mut state, &u);
                self.watch.ask(done)?;
                residual = self.residual(&state.triangulation, &metric);
                self.watch.ask(done)?;
                let new_slope = dot(&step, &residual);
                let left = largest(&residual).1;
                let converged = left <= error.min(self.accuracy());
                if converged || new_slope >= -0.5 * slope {
                    break;
                }
                halvings += 1;
                if halvings > 30 || error <= self.accuracy() {
                    // No further: rounding is all that is left, or the method is stuck.
                    u = from;
                    metric = self.scaled(&mut state, &u);
                    residual = self.residual(&state.triangulation, &metric);
                    let (vertex, error) = largest(&residual);
                    return self.finish(state, u, metric, steps, error, vertex);
                }
                length *= 0.5;
            }
        }
    }

    /// The whole step, where that leaves much curvature at few vertices, and there solved for; with its metric and residual. `None` if
    /// that does not halve the error.
    ///
    /// # Errors
    /// With the step, if triangles at the boundary have broken there for good.
    fn mended_step(
        &self,
        state: &mut Intrinsic,
        from: &VertexData<f64>,
        step: &VertexData<f64>,
        error: f64,
    ) -> Result<Option<Scaled>, Failed> {
        if self.goal > GOAL || self.original.is_some() || error < ROUGH {
            return Ok(None);
        }
        let mut u: VertexData<f64> =
            from.iter().zip(step.iter()).map(|(u, d)| u + d.clamp(-MAX_STEP, MAX_STEP)).collect();
        let mut metric = self.scaled(state, &u);
        self.watch.ask(f64::NAN)?;
        let mut residual = self.residual(&state.triangulation, &metric);
        self.watch.ask(f64::NAN)?;
        let left = largest(&residual).1;
        if left > ROUGH {
            match self.mend(state, &mut u, &residual)? {
                Mended::All => {}
                Mended::ButATriangle(vertex) if self.fixed.binary_search(&vertex).is_ok() => {
                    return Err(Failed { error: ScalingError::NoTriangle(vertex), u: Some(u) });
                }
                Mended::ButATriangle(_) | Mended::Nothing => return Ok(None),
            }
            metric = self.scaled(state, &u);
            self.watch.ask(f64::NAN)?;
            residual = self.residual(&state.triangulation, &metric);
        }
        Ok((largest(&residual).1 <= HARDLY * error).then_some((u, metric, residual)))
    }

    /// Solves for u around the vertices with much curvature left, held around that. Nothing where that is no small part of the
    /// surface, or cannot be done.
    fn mend(
        &self,
        state: &mut Intrinsic,
        u: &mut VertexData<f64>,
        residual: &VertexData<f64>,
    ) -> Result<Mended, Interrupted> {
        let triangulation = &state.triangulation;
        let mut is_near: VertexData<bool> = residual.iter().map(|r| r.is_nan() || r.abs() > ROUGH).collect();
        let touches = |is_near: &VertexData<bool>, f| triangulation.corners(f).into_iter().any(|v| is_near[v]);
        for _ in 1..RINGS {
            let faces: Vec<_> = triangulation.faces().filter(|&f| touches(&is_near, f)).collect();
            faces.into_iter().flat_map(|f| triangulation.corners(f)).for_each(|v| is_near[v] = true);
        }
        let part = state.part(|f| touches(&is_near, f));
        let inside = &part.intrinsic.triangulation;
        if inside.face_count() > triangulation.face_count() / SMALL_PART {
            return Ok(Mended::Nothing);
        }
        let ends = |h| [inside.tail(h), inside.head(h)];
        let fixed: Vec<VertexId> = inside.halfedges().filter(|&h| inside.twin(h).is_none()).flat_map(ends).collect();
        let of_part =
            |whole: &VertexData<f64>| -> VertexData<f64> { part.vertices.iter().map(|&v| whole[v]).collect() };
        let (target, start) = (of_part(self.target), of_part(u));
        let scaled = part.intrinsic.metric.scaled(inside, &start);
        let Ok(poisson) = Poisson::new(&laplacian(inside, &scaled), &fixed) else { return Ok(Mended::Nothing) };
        let watch = self.watch.within(f64::NAN, f64::NAN);
        let newton = Newton { target: &target, start: &start, fixed, original: None, goal: MENDED, watch };
        let mut take =
            |found: VertexData<f64>| part.vertices.iter().zip(found.iter()).for_each(|(&v, &found)| u[v] = found);
        match newton.run(part.intrinsic.clone(), &mut Factor::new(Arc::new(poisson), true)) {
            Ok(found) => {
                state.repeat(&part, &found.flips);
                take(found.u);
                Ok(Mended::All)
            }
            Err(Failed { error: ScalingError::Interrupted(stop), .. }) => Err(stop),
            Err(Failed { error: ScalingError::NoTriangle(vertex), u: Some(found) }) => {
                take(found);
                Ok(Mended::ButATriangle(part.vertices[vertex.index()]))
            }
            Err(_) => Ok(Mended::Nothing),
        }
    }

    /// The error that counts as reached.
    fn accuracy(&self) -> f64 {
        ACCURACY.max(self.goal)
    }

    /// The Delaunay metric with log scale factors u.
    fn scaled(&self, state: &mut Intrinsic, u: &VertexData<f64>) -> Metric {
        let spread: Option<VertexData<f64>> = self.original.map(|original| original.iter().map(|&v| u[v]).collect());
        let u = spread.as_ref().unwrap_or(u);
        let watch = self.watch.within(f64::NAN, f64::NAN);
        ptolemaic_delaunay_watched(&mut state.triangulation, &mut state.metric, u, &mut state.flips, watch)
    }

    /// The Laplacian of the scaled metric; that of a double as it acts on what is the same on both halves. Where triangles
    /// have no area it may be singular, and is made definite.
    fn hessian(&self, triangulation: &Triangulation, metric: &Metric) -> SymmetricMatrix {
        let mut hessian = match self.original {
            None => laplacian(triangulation, metric),
            Some(original) => folded_laplacian(triangulation, metric, self.target.len(), |v| original[v]),
        };
        if self.without_area(triangulation, metric).is_some() {
            for v in 0..hessian.dimension() {
                let diagonal = hessian.diagonal_mut(v);
                *diagonal += if *diagonal < DAMPING { 1.0 } else { DAMPING };
            }
        }
        hessian
    }

    /// K^T - K, 0 at fixed vertices.
    fn residual(&self, triangulation: &Triangulation, metric: &Metric) -> VertexData<f64> {
        let sums = metric.angle_sums(triangulation);
        let mut residual: VertexData<f64> =
            self.target.iter().zip(sums.iter()).map(|(k, sum)| k - (2.0 * std::f64::consts::PI - sum)).collect();
        for &v in &self.fixed {
            residual[v] = 0.0;
        }
        if self.fixed.is_empty() {
            // Gauss–Bonnet: what it sums to is rounding, and belongs to no vertex.
            let mean = residual.iter().sum::<f64>() / residual.len() as f64;
            residual.iter_mut().for_each(|r| *r -= mean);
        }
        residual
    }

    /// A corner of a triangle without area, if there is any; a fixed one if it has one.
    fn without_area(&self, triangulation: &Triangulation, metric: &Metric) -> Option<VertexId> {
        let faces = (0..triangulation.face_count()).into_par_iter().with_min_len(AT_ONCE).map(FaceId::new);
        let broken = faces.find_first(|&f| metric.sides(triangulation, f).area() <= 0.0)?;
        let corners = triangulation.corners(broken);
        Some(corners.into_iter().find(|v| self.fixed.contains(v)).unwrap_or(corners[0]))
    }

    fn finish(
        &self,
        state: Intrinsic,
        u: VertexData<f64>,
        metric: Metric,
        steps: usize,
        error: f64,
        vertex: VertexId,
    ) -> Result<Scaling, Failed> {
        if error.is_nan() || error > self.accuracy() {
            return Err(ScalingError::Stuck { error, vertex }.into());
        }
        let Intrinsic { triangulation, flips, .. } = state;
        if let Some(vertex) = self.without_area(&triangulation, &metric) {
            return Err(Failed { error: ScalingError::NoTriangle(vertex), u: Some(u) });
        }
        let (is_doubled, rim_angles) = (self.original.is_some(), Vec::new());
        Ok(Scaling { u, triangulation, metric, flips, steps, error, mollified: false, is_doubled, rim_angles })
    }
}

/// What came of solving for a part by itself.
enum Mended {
    All,
    /// The log scale factors were found, but a triangle at this vertex has broken.
    ButATriangle(VertexId),
    Nothing,
}

fn largest(residual: &VertexData<f64>) -> (VertexId, f64) {
    residual.iter_ids().fold(
        (VertexId(0), 0.0),
        |(at, most), (v, r)| {
            if r.abs() > most || r.is_nan() { (v, r.abs()) } else { (at, most) }
        },
    )
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}
