//! Metric scaling: the discretely conformal metric with prescribed curvature.
//!
//! Given the target curvature `k_c` at each cone and 0 elsewhere, find log scale factors u such that the metric
//! `l_ij e^((u_i + u_j)/2)` has it, u held at given values on the boundary. The u minimise a convex energy with gradient
//! K^T - K(u) and Hessian L(u), the cotangent Laplacian of the scaled metric (Springborn, Schröder & Pinkall 2008), when
//! the triangulation is kept Delaunay by Ptolemaic flips (Gu, Luo, Sun & Wu 2018; Springborn 2020; Gillespie, Springborn &
//! Crane 2021): then the solution exists for every target below 2π that satisfies Gauss–Bonnet. Newton's method finds
//! it (`newton`).
//!
//! Every inner edge may flip, seams too, for the cut is made later on the input's triangles; all flips are logged from
//! the input's triangulation on, so that the layout can undo them.

mod newton;

use std::sync::Arc;

use geom::{
    Double, HalfedgeId, Interrupted, Intrinsic, Mesh, Metric, Poisson, PoissonError, Triangulation, VertexData,
    VertexId, Watch, delaunay_watched,
};
use thiserror::Error;

use crate::field::Operators;
use newton::{Factor, Newton};

/// A surface's boundary is flipped on a double with so many rings of the image first, if these have less than this part of its triangles.
const COLLAR: usize = 6;
const SMALL_IMAGE: usize = 3;

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
    /// Whether the triangulation is of its double.
    pub(crate) is_doubled: bool,
    /// The angle of the surface alone at each vertex round a hole that was filled for it, in the layout, if there are any.
    pub(crate) rim_angles: Vec<(VertexId, f64)>,
}

impl Scaling {
    /// The angle of each of the input's vertices in the flat metric.
    pub fn angles(&self, input: &Mesh) -> VertexData<f64> {
        let sums = self.metric.angle_sums(&self.triangulation);
        let angle = |v| if self.is_doubled && input.is_boundary_vertex(v) { 0.5 * sums[v] } else { sums[v] };
        let mut angles: VertexData<f64> = input.vertices().map(angle).collect();
        self.rim_angles.iter().for_each(|&(v, own)| angles[v] = own);
        angles
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
            is_doubled: false,
            rim_angles: Vec::new(),
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
    scale_by(operators.poisson(), (input, input_metric, operators), target, start, watch)
}

/// [`scale`] by the operators' factor, which is overwritten where nobody else has it.
pub(crate) fn scale_by(
    factor: Arc<Poisson>,
    (input, input_metric, operators): (&Mesh, &Metric, &Operators),
    target: &VertexData<f64>,
    start: &VertexData<f64>,
    watch: Watch,
) -> Result<Scaling, ScalingError> {
    let fixed: Vec<VertexId> = input.vertices().filter(|&v| input.is_boundary_vertex(v)).collect();
    let has_boundary = !fixed.is_empty();
    let newton = Newton { target, start, fixed, original: None, goal: newton::GOAL, watch };
    let mut factor = Factor::new(factor, true);
    let Failed { mut error, u } = match newton.run(intrinsic(operators), &mut factor) {
        Err(failed) if failed.may_go_otherwise() => failed,
        done => return done.map_err(|failed| failed.error),
    };
    let mut run = |double: Option<&Double>, metric: &Metric, start: &VertexData<f64>, goes_on: bool| {
        let newton = Newton { start, original: double.map(|double| &double.original), ..newton.clone() };
        let intrinsic = match double {
            None => delaunay_watched(input, metric, watch),
            Some(double) => delaunay_watched(&double.mesh, &double.metric(input, metric), watch),
        };
        if !goes_on || factor.is_lost() {
            factor = Factor::new(operators.factor_again(watch)?, false);
        }
        newton.run(intrinsic, &mut factor)
    };
    let mut double = None;
    if has_boundary {
        // Where only triangles at the boundary have broken, u is known but for these.
        let (start, goes_on) = u.as_ref().map_or((start, false), |u| (u, true));
        let collar = Double::collar(input, COLLAR);
        if collar.image_count() < input.face_count() / SMALL_IMAGE {
            match run(Some(&collar), input_metric, start, goes_on) {
                Err(failed) if failed.may_go_otherwise() => {}
                done => return done.map_err(|failed| failed.error),
            }
        }
        let whole = double.insert(Double::new(input));
        error = match run(Some(whole), input_metric, start, false) {
            Err(failed) if failed.may_go_otherwise() => failed.error,
            done => return done.map_err(|failed| failed.error),
        };
    }
    let mollified = input_metric.mollified(input, Metric::MOLLIFICATION);
    let [before, after] = [input_metric, &mollified].map(|metric| metric.lengths().iter().sum::<f64>());
    if after <= before * (1.0 + 1e-3 * Metric::MOLLIFICATION) {
        return Err(error);
    }
    let scaling = run(double.as_ref(), &mollified, start, false).map_err(|failed| failed.error)?;
    Ok(Scaling { mollified: true, ..scaling })
}

/// The triangulation that the operators are of.
fn intrinsic(operators: &Operators) -> Intrinsic {
    Intrinsic {
        triangulation: operators.mesh.triangulation().clone(),
        metric: operators.metric.clone(),
        flips: operators.flips.clone(),
    }
}

/// Newton's method has failed.
#[derive(Debug)]
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

#[cfg(test)]
mod tests {
    use super::*;
    use geom::shapes::{self, Shape};
    use std::f64::consts::PI;
    use std::ops::ControlFlow;
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

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
        let faces = flipped_on(&shapes::square(400));
        assert_eq!(faces[1], 2 * faces[0], "only on the double");
    }

    #[test]
    fn a_boundary_that_is_a_small_part_is_flipped_on_a_collar() {
        let faces = flipped_on(&shapes::square(10_000));
        assert!(faces[0] < faces[1] && faces[1] < faces[0] + faces[0] / SMALL_IMAGE, "{faces:?}");
    }

    #[test]
    fn a_boundary_that_breaks_for_good_is_seen_once_what_is_around_it_is_solved_for() {
        let shape = shapes::square(10_000);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let operators = Operators::new(&mesh, &metric).unwrap();
        let target = VertexData::constant(mesh.vertex_count(), 0.0);
        let start = uneven(&mesh, |v| v.0 < 20);
        let fixed: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
        // With a goal that is less strict parts are not solved for by themselves.
        let [early, late] = [newton::GOAL, 2.0 * newton::GOAL].map(|goal| {
            let asked = AtomicUsize::new(0);
            // On parts nobody knows how much is done.
            let count = |done: f64| {
                asked.fetch_add(usize::from(!done.is_nan()), Relaxed);
                ControlFlow::Continue(())
            };
            let watch = Watch::new(&count);
            let newton = Newton { target: &target, start: &start, fixed: fixed.clone(), original: None, goal, watch };
            let failed =
                newton.run(intrinsic(&operators), &mut Factor::new(operators.poisson(), true)).expect_err("it breaks");
            assert!(matches!(failed.error, ScalingError::NoTriangle(_)), "{}", failed.error);
            let u = failed.u.expect("they are found");
            let collar = Double::collar(&mesh, COLLAR);
            let newton = Newton { start: &u, original: Some(&collar.original), watch: Watch::NONE, ..newton };
            let intrinsic = geom::delaunay(&collar.mesh, &collar.metric(&mesh, &metric));
            let found = newton.run(intrinsic, &mut Factor::new(operators.poisson(), true));
            (asked.into_inner(), found.expect("the collar's triangles can be flipped").steps)
        });
        assert!(2 * early.0 < late.0 && early.1 <= late.1 + 1, "{early:?} {late:?}");
    }

    /// Log scale factors that go up and down from vertex to vertex where it is asked, and are 0 elsewhere.
    fn uneven(mesh: &Mesh, is_uneven: impl Fn(VertexId) -> bool) -> VertexData<f64> {
        let u = |v: VertexId| if is_uneven(v) { 2.5 * f64::from(v.0 * 7 % 3) - 2.5 } else { 0.0 };
        mesh.vertices().map(u).collect()
    }

    /// Scales a square to log scale factors on the boundary so uneven that its triangles break; the number of its triangles, and of those
    /// that it was scaled on.
    fn flipped_on(shape: &Shape) -> [usize; 2] {
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let operators = Operators::new(&mesh, &metric).unwrap();
        let target = VertexData::constant(mesh.vertex_count(), 0.0);
        let start = uneven(&mesh, |v| mesh.is_boundary_vertex(v));
        let scaling = scale(&mesh, &metric, &operators, &target, &start, Watch::NONE).unwrap();
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
        [mesh.face_count(), scaling.triangulation.face_count()]
    }
}
