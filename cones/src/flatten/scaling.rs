//! Metric scaling: the discretely conformal metric with prescribed curvature.
//!
//! Given the target curvature `k_c` at each cone and 0 elsewhere, find log scale factors u such that the metric
//! `l_ij e^((u_i + u_j)/2)` has it, u held at given values on the boundary. The u minimise a convex energy with gradient
//! K^T - K(u) and Hessian L(u), the cotangent Laplacian of the scaled metric (Springborn, Schröder & Pinkall 2008), when
//! the triangulation is kept Delaunay by Ptolemaic flips (Gu, Luo, Sun & Wu 2018; Springborn 2020; Gillespie, Springborn &
//! Crane 2021): then the solution exists for every target below 2π that satisfies Gauss–Bonnet. Newton's method with a
//! line search on the directional derivative finds it in 4–9 factorizations.
//!
//! Every inner edge may flip, seams too, for the cut is made later on the input's triangles; all flips are logged from
//! the input's triangulation on, so that the layout can undo them.

use geom::{
    Double, HalfedgeId, Id, Interrupted, Intrinsic, Mesh, Metric, Poisson, PoissonError, SymmetricMatrix,
    Triangulation, VertexData, VertexId, Watch, delaunay_watched, laplacian, ptolemaic_delaunay_watched,
};
use sprs::TriMat;
use thiserror::Error;

use crate::field::Operators;

/// The curvature error that counts as reached.
const ACCURACY: f64 = 1e-9;
/// Where Newton converges quadratically, it goes on to here: what is left distorts the layout.
const GOAL: f64 = 1e-13;
/// From here one more step gets as far as rounding allows.
const LAST_STEP: f64 = 1e-10;
/// A step that lowers the error to this share of itself was a good one: the next can do with the same factor. (Solving
/// costs a tenth of factoring; on meshes of 29–134 thousand vertices this saves a third of Newton's time.)
const GOOD_STEP: f64 = 0.03;
/// More steps than this, and the triangles are too degenerate for the method.
const MAX_STEPS: usize = 25;
/// Added to the Hessian's diagonal where triangles have no area. The least eigenvalue of the Laplacian of a surface with a
/// million vertices is about 4e-5.
const DAMPING: f64 = 1e-6;
/// No log scale factor changes by more than this in a step.
const MAX_STEP: f64 = 5.0;
/// Where so many steps have not brought the error down to [`HARDLY`] of the first one, the method is stuck: on a scan of 437,645 vertices
/// with cones in bad places it stayed at 0.6 to 1.1 of it for fifteen steps, and got stuck at 0.08 in the end. Where it does succeed, it is
/// at a third after five.
const PATIENCE: usize = 10;
/// Below so many vertices all steps cost little. A spindle squeezed by 10⁶ needs more than [`PATIENCE`].
const PATIENT_BELOW: usize = 20_000;
const HARDLY: f64 = 0.5;
/// From here on triangles at the boundary that have no area will have none in the end.
const SETTLED: f64 = 0.1;

/// Why no metric with the target curvature was found.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum ScalingError {
    /// Newton's method got stuck.
    #[error("the metric did not reach the target curvature: an error of {error:.1e} is left at vertex {vertex}")]
    Stuck {
        /// The largest curvature error left, in radians.
        error: f64,
        /// Where it is.
        vertex: VertexId,
    },
    /// Newton's method has hardly come nearer to the target.
    #[error("the metric stays far from the target curvature: an error of {error:.1e} is left at vertex {vertex}")]
    Hopeless {
        /// The largest curvature error left, in radians.
        error: f64,
        /// Where it is.
        vertex: VertexId,
    },
    /// There are angles that sum to the target, but not in triangles.
    #[error("the metric with the target curvature breaks the triangle inequality at vertex {0}")]
    NoTriangle(VertexId),
    /// A Hessian could not be factored.
    #[error(transparent)]
    Poisson(PoissonError),
    /// The watch has said stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<PoissonError> for ScalingError {
    fn from(error: PoissonError) -> Self {
        match error {
            PoissonError::Interrupted(stop) => Self::Interrupted(stop),
            error => Self::Poisson(error),
        }
    }
}

/// A flat metric with cones, on a triangulation that was flipped on the way.
#[derive(Clone, Debug)]
pub struct Scaling {
    /// The log scale factor of each vertex.
    pub u: VertexData<f64>,
    /// The triangulation, Delaunay in the scaled metric: of the input, or of its [`Double`].
    pub triangulation: Triangulation,
    /// The scaled edge lengths.
    pub metric: Metric,
    /// All flips since the input's triangulation, in order.
    pub flips: Vec<HalfedgeId>,
    /// The number of Newton steps.
    pub steps: usize,
    /// The largest curvature error at a vertex, in radians.
    pub error: f64,
    /// Whether the input's lengths had to be mollified.
    pub mollified: bool,
}

impl Scaling {
    /// The angle of each of the input's vertices in the flat metric.
    pub fn angles(&self, input: &Mesh) -> VertexData<f64> {
        let sums = self.metric.angle_sums(&self.triangulation);
        let halved = self.triangulation.face_count() > input.face_count();
        let angle = |v| if halved && input.is_boundary_vertex(v) { 0.5 * sums[v] } else { sums[v] };
        input.vertices().map(angle).collect()
    }

    /// No scaling: the metric as it is, with the curvature that it has.
    pub(crate) fn none(mesh: &Mesh, metric: &Metric) -> Self {
        Self {
            u: VertexData::constant(mesh.vertex_count(), 0.0),
            triangulation: mesh.triangulation().clone(),
            metric: metric.clone(),
            flips: Vec::new(),
            steps: 0,
            error: 0.0,
            mollified: false,
        }
    }
}

/// Scales a surface to the given curvature (by vertex, used off the boundary), with u on the boundary as in `start`,
/// where there is one: inside Newton's method then starts from there too, and otherwise from 0.
///
/// # Errors
/// If Newton's method gets stuck even on mollified lengths.
pub fn scale(
    input: &Mesh,
    input_metric: &Metric,
    operators: &Operators,
    target: &VertexData<f64>,
    start: &VertexData<f64>,
    watch: Watch,
) -> Result<Scaling, ScalingError> {
    let newton = Newton {
        target,
        start,
        fixed: input.vertices().filter(|&v| input.is_boundary_vertex(v)).collect(),
        poisson: &operators.poisson,
        starts_from_factor: true,
        original: None,
        watch,
    };
    let intrinsic = Intrinsic {
        triangulation: operators.mesh.triangulation().clone(),
        metric: operators.metric.clone(),
        flips: operators.flips.clone(),
    };
    let Failed { mut error, u } = match newton.run(intrinsic) {
        Err(failed) if failed.may_go_otherwise() => failed,
        done => return done.map_err(|failed| failed.error),
    };
    let double = (!newton.fixed.is_empty()).then(|| Double::new(input));
    let run = |metric: &Metric, start: &VertexData<f64>| {
        let newton = Newton { start, starts_from_factor: false, ..newton.clone() };
        match &double {
            None => newton.run(delaunay_watched(input, metric, watch)),
            Some(double) => {
                let newton = Newton { original: Some(&double.original), ..newton };
                newton.run(delaunay_watched(&double.mesh, &double.metric(input, metric), watch))
            }
        }
    };
    if double.is_some() {
        // Where only triangles at the boundary have broken, u is known but for these.
        error = match run(input_metric, u.as_ref().unwrap_or(start)) {
            Err(failed) if failed.may_go_otherwise() => failed.error,
            done => return done.map_err(|failed| failed.error),
        };
    }
    let mollified = input_metric.mollified(input, Metric::MOLLIFICATION);
    let [before, after] = [input_metric, &mollified].map(|metric| metric.lengths().iter().sum::<f64>());
    if after <= before * (1.0 + 1e-3 * Metric::MOLLIFICATION) {
        return Err(error);
    }
    let scaling = run(&mollified, start).map_err(|failed| failed.error)?;
    Ok(Scaling { mollified: true, ..scaling })
}

/// Newton's method has failed.
struct Failed {
    error: ScalingError,
    /// The log scale factors, where they are found and only triangles have broken.
    u: Option<VertexData<f64>>,
}

impl Failed {
    /// Whether it is worth it to try the same with other triangles.
    fn may_go_otherwise(&self) -> bool {
        !matches!(
            self.error,
            ScalingError::Poisson(PoissonError::OutOfMemory(_))
                | ScalingError::Interrupted(_)
                | ScalingError::Hopeless { .. }
        )
    }
}

impl<E: Into<ScalingError>> From<E> for Failed {
    fn from(error: E) -> Self {
        Self { error: error.into(), u: None }
    }
}

#[derive(Clone)]
struct Newton<'a> {
    target: &'a VertexData<f64>,
    start: &'a VertexData<f64>,
    fixed: Vec<VertexId>,
    /// The factor that is already there. Others are made in the same order of elimination.
    poisson: &'a Poisson,
    /// Where u is 0 to begin with, the first step can use it.
    starts_from_factor: bool,
    /// On a double, the vertex of the surface for each of its own. Log scale factors are the same on both halves.
    original: Option<&'a VertexData<VertexId>>,
    watch: Watch<'a>,
}

impl Newton<'_> {
    /// Finds the metric from a Delaunay triangulation on; its lengths stay unscaled while flips change it.
    fn run(&self, mut state: Intrinsic) -> Result<Scaling, Failed> {
        let starts_at_zero = self.fixed.is_empty();
        let mut u = if starts_at_zero { VertexData::constant(self.start.len(), 0.0) } else { self.start.clone() };
        let mut metric = self.scaled(&mut state, &u);
        self.watch.ask(0.0)?;
        let mut residual = self.residual(&state.triangulation, &metric);
        let mut factored: Option<Poisson> = None;
        let mut steps = 0;
        let mut last = false;
        let mut keep_factor = false;
        let first = largest(&residual).1;
        let mut least = first;
        loop {
            let (vertex, error) = largest(&residual);
            // How much of the way from the first error to the last is done, in logarithms.
            let done = ((error / first).ln() / (GOAL / first).ln()).clamp(0.0, 1.0);
            self.watch.ask(done)?;
            if error <= GOAL || last || steps >= MAX_STEPS {
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
                && let Some(vertex) = without_area(&state.triangulation, &metric)
            {
                return Err(Failed { error: ScalingError::NoTriangle(vertex), u: Some(u) });
            }
            let step = match self.starts_from_factor && steps == 0 && starts_at_zero {
                true => self.poisson.solve_watched(&residual, self.watch.within(done, done))?,
                false => {
                    if !keep_factor || factored.is_none() {
                        let hessian = self.hessian(&state.triangulation, &metric);
                        self.watch.ask(done)?;
                        let watch = self.watch.within(done, done);
                        factored = Some(match factored.take() {
                            Some(poisson) => poisson.refactor_watched(&hessian, watch)?,
                            None => self.poisson.another_watched(&hessian, watch)?,
                        });
                    }
                    let factored = factored.as_ref().expect("it was just factored");
                    factored.solve_watched(&residual, self.watch.within(done, done))?
                }
            };
            self.watch.ask(done)?;
            steps += 1;
            last = error <= LAST_STEP;
            let slope = dot(&step, &residual);
            if !slope.is_finite() {
                return Err(ScalingError::Stuck { error, vertex }.into());
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
                keep_factor = left <= GOOD_STEP * error;
                let converged = left <= error.min(ACCURACY);
                if converged || new_slope >= -0.5 * slope {
                    break;
                }
                halvings += 1;
                if halvings > 30 || error <= ACCURACY {
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
        let mut hessian = laplacian(triangulation, metric);
        if let Some(original) = self.original {
            hessian = fold(&hessian, original, self.target.len());
        }
        if without_area(triangulation, metric).is_some() {
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

    fn finish(
        &self,
        state: Intrinsic,
        u: VertexData<f64>,
        metric: Metric,
        steps: usize,
        error: f64,
        vertex: VertexId,
    ) -> Result<Scaling, Failed> {
        if error.is_nan() || error > ACCURACY {
            return Err(ScalingError::Stuck { error, vertex }.into());
        }
        let Intrinsic { triangulation, flips, .. } = state;
        if let Some(vertex) = without_area(&triangulation, &metric) {
            return Err(Failed { error: ScalingError::NoTriangle(vertex), u: Some(u) });
        }
        Ok(Scaling { u, triangulation, metric, flips, steps, error, mollified: false })
    }
}

/// A corner of a triangle without area, if there is any.
fn without_area(triangulation: &Triangulation, metric: &Metric) -> Option<VertexId> {
    let found = triangulation.faces().find(|&f| metric.sides(triangulation, f).area() <= 0.0);
    found.map(|f| triangulation.corners(f)[0])
}

/// The rows of the first `count` vertices, their columns added up by the vertex that each stands for.
fn fold(matrix: &SymmetricMatrix, original: &VertexData<VertexId>, count: usize) -> SymmetricMatrix {
    let mut folded = TriMat::with_capacity((count, count), matrix.stored() + count);
    let mut add = |v: usize, w: usize, value: f64| {
        if v < count {
            folded.add_triplet(v, original[VertexId::new(w)].index(), value);
        }
    };
    for v in 0..matrix.dimension() {
        for (w, value) in matrix.column(v) {
            add(v, w, value);
            if v != w {
                add(w, v, value);
            }
        }
    }
    SymmetricMatrix::from(&folded.to_csr())
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

#[cfg(test)]
mod tests {
    use super::*;
    use geom::shapes::{self, Shape};
    use std::f64::consts::PI;

    /// Scales a shape to cones of equal curvature at evenly numbered vertices.
    fn scaled(shape: &Shape, cones: usize) -> (Mesh, VertexData<f64>, Scaling) {
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let operators = Operators::new(&mesh, &metric).unwrap();
        let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
        let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        for k in 0..cones {
            target[inner[k * inner.len() / cones]] = operators.total_curvature() / cones as f64;
        }
        let zero = VertexData::constant(mesh.vertex_count(), 0.0);
        let scaling = scale(&mesh, &metric, &operators, &target, &zero, Watch::NONE).unwrap();
        (mesh, target, scaling)
    }

    #[test]
    fn the_scaled_metric_has_the_target_curvature_and_is_the_scaled_input() {
        for (shape, cones) in [(shapes::hare(1500), 8), (shapes::torus(2, 1500), 5), (shapes::terrain(900, 1), 3)] {
            let (mesh, target, scaling) = scaled(&shape, cones);
            let sums = scaling.metric.angle_sums(&scaling.triangulation);
            for v in mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)) {
                assert!((2.0 * PI - sums[v] - target[v]).abs() < 1e-9);
            }
            assert!(scaling.error < 1e-11, "{}", scaling.error);
            scaling.triangulation.check();
            // An edge that no flip touched is the input's, scaled.
            let scaled = Metric::from_points(&mesh, &shape.points).scaled(&mesh, &scaling.u);
            let mut same = 0;
            for e in mesh.edges().filter(|&e| mesh.ends(e) == scaling.triangulation.ends(e)) {
                same += usize::from((scaled.length(e) / scaling.metric.length(e) - 1.0).abs() < 1e-9);
            }
            assert!(2 * same > mesh.edge_count());
        }
    }

    #[test]
    fn the_given_log_scale_on_the_boundary_stays() {
        let (mesh, _, scaling) = scaled(&shapes::terrain(900, 1), 0);
        assert!(mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).all(|v| scaling.u[v] == 0.0));
    }

    #[test]
    fn a_boundary_that_has_to_be_flipped_is() {
        // Log scale factors on the boundary so uneven that its triangles break.
        let shape = shapes::square(400);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let operators = Operators::new(&mesh, &metric).unwrap();
        let target = VertexData::constant(mesh.vertex_count(), 0.0);
        let uneven = |v: VertexId| if mesh.is_boundary_vertex(v) { 2.5 * f64::from(v.0 * 7 % 3) - 2.5 } else { 0.0 };
        let start: VertexData<f64> = mesh.vertices().map(uneven).collect();
        let scaling = scale(&mesh, &metric, &operators, &target, &start, Watch::NONE).unwrap();
        assert_eq!(scaling.triangulation.face_count(), 2 * mesh.face_count(), "only on the double");
        let mut turned = 0.0;
        for (v, angle) in scaling.angles(&mesh).iter_ids() {
            let straight = if mesh.is_boundary_vertex(v) { PI } else { 2.0 * PI };
            assert!(mesh.is_boundary_vertex(v) || (angle - straight).abs() < 1e-9);
            turned += straight - angle;
        }
        assert!((turned - 2.0 * PI).abs() < 1e-8, "the boundary turns once: {turned}");
        assert!(mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).all(|v| scaling.u[v] == start[v]));
        // The half that is laid out has these angles, up to full turns.
        let seams = crate::flatten::Seams::new(&mesh, metric.lengths(), &[], Watch::NONE).unwrap();
        let layout = crate::flatten::Layout::new(&mesh, &scaling, &seams.cut, Watch::NONE).unwrap();
        for (v, angle) in scaling.angles(&mesh).iter_ids() {
            let corner = |h| {
                let at = layout.corner(h);
                ((layout.corner(mesh.prev(h)) - at) * (layout.corner(mesh.next(h)) - at).conj()).arg()
            };
            let turns = (mesh.outgoing(v).map(corner).sum::<f64>() - angle) / (2.0 * PI);
            assert!((turns - turns.round()).abs() < 1e-6, "{v}: {turns}");
        }
    }
}
