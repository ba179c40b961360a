//! The curvature of each cone, given where the cones are.
//!
//! *Harmonic* curvatures are those of the conformal factor pinned to 0 at all cones, as in [BCGB08] and the paper.
//! *Optimal* ones make the L2 norm of the log scale factor least, under bounds that keep the cones buildable: the linear
//! log scale factor is `u = p + Σ q_c g_c`, with p the flattening of everything and `g_c` Green's function of cone c, so that
//! |u|² is a quadratic function of the curvatures q (a small dense program, [`fit`](crate::numerics::quadratic_program)).
//!
//! A cone's angle is θ = 2π - k. Bounds: k at most 1.7π, or 1.8π where that helps (less than 2π is needed, and near it the metric degenerates), or what
//! the vertex has itself; k at least -2π, and not so low that the cone's triangles in the input could not span θ: θ ≤ 0.87π a triangle.

use std::f64::consts::PI;

use geom::{Interrupted, Mesh, VertexData, VertexId, Watch, counted, gram_watched};
use rayon::prelude::*;
use thiserror::Error;

use crate::field::Operators;
use crate::numerics::dense;
use crate::numerics::quadratic_program::{Held, ProgramError, Quadratic, minimise_watched};

/// The widest angle that the triangles at a cone have on average. Below π they can be laid out without flips. Surfaces of
/// high genus with few cones need what there is: on casting (genus 9, 16 cones) 0.75π instead means an L2 norm 12 % larger
/// and a measured area distortion of 1.86 instead of 1.43. (Between 0.85π and 0.9π the norm jumps by 5 % from one local
/// minimum to another; with 12 cones the measured distortion is larger than with 0.75π, 1.94 to 1.76.)
pub(crate) const LARGEST_CORNER: f64 = 0.87 * PI;

/// As [`LARGEST_CORNER`], where there is a choice.
pub(crate) const COMFORTABLE_CORNER: f64 = 0.75 * PI;

/// The largest curvature of a cone. Where 1.5π holds one this lowers the L2 norm of the log scale by a tenth (bunny with 5 and 8 cones) to a
/// sixth (moai with 3, Planck's open head with 1), the area distortion from 1.90 to 1.81 on moai. With 1.9π the norm is lower still, but the area
/// distortion is 3.24 there, and triangles at tips are stretched 35 times in place of 8.
pub(crate) const LARGEST_CURVATURE: f64 = 1.7 * PI;

/// As [`LARGEST_CURVATURE`], where that lowers the energy by [`LEAST_SHARPENED`]. With 1.9π and 1.94π, as a peer has them, tips are
/// stretched 23 and 39 times, and the area distortion is up to twice as large.
pub(crate) const SHARPEST_CURVATURE: f64 = 1.8 * PI;

/// On bunny with 5 cones the energy falls by 5 %, the area distortion from 1.744 to 1.728, the quasi-conformal distortion grows from 1.0314
/// to 1.0326; on moai with 3 cones it falls by 1 %, and the area distortion grows from 1.71 to 1.80.
pub(crate) const LEAST_SHARPENED: f64 = 0.03;

/// The columns of so many cones are held at once where one solve would do.
const MOST_COLUMNS: usize = 512;

/// A vertex that has more curvature than that may keep it, up to here.
const SPIKE: f64 = 2.0 * PI - 1e-9;

/// As [`LARGEST_CURVATURE`], where there is a choice.
pub(crate) const COMFORTABLE_CURVATURE: f64 = 1.5 * PI;

/// How cones get their curvatures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum CurvatureRule {
    /// Those of the log scale factor that is 0 at all cones, as the paper has it.
    Harmonic,
    /// Those that make the L2 norm of the log scale factor least.
    #[default]
    Optimal,
}

impl CurvatureRule {
    /// Its name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Harmonic => "harmonic",
            Self::Optimal => "optimal",
        }
    }
}

/// Curvatures for cones, or why there are none.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum CurvatureError {
    /// The bounds admit no curvatures with the right sum.
    #[error("{} cannot take the total curvature of {total:.4}; at least {least} {} needed", counted(*cones, "cone", "cones"), if *least == 1 { "is" } else { "are" })]
    TooFew {
        /// How many cones were given.
        cones: usize,
        /// What they should sum to.
        total: f64,
        /// How many it takes, by count; vertices of low degree may ask for more.
        least: usize,
    },
    /// The watch has said stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The log scale that these cones cause is no finite number.
    #[error("{} a log scale that is not a finite number: their surroundings have no area", counted(*cones, "cone causes", "cones cause"))]
    NotFinite {
        /// How many cones were given.
        cones: usize,
    },
}

/// Cone curvatures with what is known of them.
#[derive(Clone, Debug)]
pub struct ConeCurvatures {
    /// The curvature of each cone, in radians; on a closed surface they sum to 2πχ exactly.
    pub curvature: Vec<f64>,
    /// The log scale factor that linear theory predicts, centred.
    pub predicted: VertexData<f64>,
    /// Harmonic curvatures were asked for, but these cones' were out of bounds, so that optimal ones were taken instead.
    pub out_of_bounds: Vec<VertexId>,
}

impl ConeCurvatures {
    /// Curvatures that were found for the same surface, or nearly; on a closed one they are brought to the right sum. `predicted` says
    /// what they cause.
    pub(crate) fn known(
        operators: &Operators,
        mut curvature: Vec<f64>,
        predicted: impl FnOnce(&[f64]) -> VertexData<f64>,
    ) -> Self {
        if !operators.is_bordered() {
            let off = operators.total_curvature() - curvature.iter().sum::<f64>();
            let share = off / curvature.len() as f64;
            curvature.iter_mut().for_each(|k| *k += share);
        }
        Self { predicted: predicted(&curvature), curvature, out_of_bounds: Vec::new() }
    }

    /// Curvatures that somebody gives. Up to [`MOST_COLUMNS`] cones cost a solve each and are summed as where their curvatures are found, so that the same come
    /// to the same bits; more cost one together.
    ///
    /// # Errors
    /// If the watch has said stop.
    pub fn given(
        operators: &Operators,
        cones: &[VertexId],
        curvature: Vec<f64>,
        watch: Watch,
    ) -> Result<Self, CurvatureError> {
        if cones.len() > MOST_COLUMNS {
            let predicted = operators.log_scale(cones, &curvature);
            watch.ask(1.0)?;
            return Ok(Self { predicted, curvature, out_of_bounds: Vec::new() });
        }
        let (p, green) = centred(operators, operators.green_watched(cones, watch)?, watch.within(1.0, 1.0))?;
        Ok(Self { predicted: combine(&p, &green, &curvature), curvature, out_of_bounds: Vec::new() })
    }
}

/// The least and greatest curvature of each of the `cones` on a surface whose layout will use the triangles of `input`.
fn bounds(operators: &Operators, input: &Mesh, cones: &[VertexId], largest: f64) -> Vec<[f64; 2]> {
    let general = general_bounds(operators, cones.len(), largest);
    cones.iter().map(|&v| bounds_at(operators, v, bound_by_degree(input, v, cones), general)).collect()
}

/// The bounds of a vertex that can have no less than `lowest`, from the general ones: whatever curvature it has itself it may keep. Nothing
/// need be stretched for that, while what the tip of a spike cannot keep has to leave through the spike's narrow foot: on a part
/// with folds of two needles, where .3π had to, an area distortion of 270 digits was predicted.
pub(crate) fn bounds_at(operators: &Operators, v: VertexId, lowest: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    let high = high.max(operators.curvature[v].min(SPIKE));
    [low.max(lowest).min(high), high]
}

/// The least and greatest curvature of any of so many cones, more than `largest` only where it has to be.
pub(crate) fn general_bounds(operators: &Operators, count: usize, largest: f64) -> [f64; 2] {
    let count = count.max(1) as f64;
    let total = if operators.is_bordered() { 0.0 } else { operators.total_curvature() };
    [-(2.0 * PI).max(2.5 * (-total).max(0.0) / count), largest.max(1.02 * total / count).min(1.99 * PI)]
}

/// Whether a cone can have a harmonic curvature, where optimal ones are at least `low`. Harmonic curvatures may go further:
/// what they must leave is an angle.
pub(crate) fn is_buildable(curvature: f64, low: f64) -> bool {
    curvature < 2.0 * PI - 0.02 && curvature >= low.min(-2.0 * PI)
}

/// θ ≤ [`LARGEST_CORNER`] a triangle.
fn bound_by_degree(input: &Mesh, v: VertexId, cones: &[VertexId]) -> f64 {
    2.0 * PI - LARGEST_CORNER * usable_degree(input, cones, v) as f64
}

/// The triangles at a vertex that can open up. A flat neighbour of degree 3 makes three triangles one.
pub(crate) fn usable_degree(input: &Mesh, cones: &[VertexId], v: VertexId) -> usize {
    let stuck = |w: &&VertexId| input.face_degree(**w) == 3 && !input.is_boundary_vertex(**w) && !cones.contains(w);
    let degree = input.face_degree(v);
    degree.saturating_sub(input.neighbors(v).iter().filter(stuck).count()).max(1)
}

/// The least number of cones of a closed surface, from the total curvature alone; 0 with a boundary. A sphere needs
/// three, each below 2π; a torus none; beyond, one.
pub fn least_cones(operators: &Operators) -> usize {
    match operators.mesh.euler_characteristic() {
        _ if operators.is_bordered() => 0,
        2 => 3,
        0 => 0,
        _ => 1,
    }
}

/// The curvatures of the given cones, in their order. `input` is the triangulation that will be laid out. Costs a solve for each of N cones, of which all
/// are held, O(V N) numbers, and a dense program of N² numbers and O(N³); nothing where all inner vertices are cones, which keep their own.
///
/// # Errors
/// If the bounds cannot be met with so few cones.
pub fn cone_curvatures(
    operators: &Operators,
    input: &Mesh,
    cones: &[VertexId],
    rule: CurvatureRule,
    watch: Watch,
) -> Result<ConeCurvatures, CurvatureError> {
    if rule == CurvatureRule::Optimal && are_all(operators, input, cones) {
        return Ok(own(operators, cones));
    }
    let flattening = operators.flattening_watched(watch.within(0.0, 0.1))?;
    let green = operators.green_watched(cones, watch.within(0.1, 0.6))?;
    watch.ask(0.6)?;
    let bounds = [LARGEST_CURVATURE, SHARPEST_CURVATURE].map(|largest| bounds(operators, input, cones, largest));
    let mut out_of_bounds = Vec::new();
    if rule == CurvatureRule::Harmonic {
        if let Some(curvature) = harmonic(operators, cones, flattening, &green) {
            out_of_bounds = cones
                .iter()
                .zip(&curvature)
                .zip(&bounds[0])
                .filter(|((_, k), [low, _])| !is_buildable(**k, *low))
                .map(|((v, _), _)| *v)
                .collect();
            if out_of_bounds.is_empty() {
                let mut predicted = combine(flattening, &green, &curvature);
                operators.subtract_mean(&mut predicted);
                return Ok(ConeCurvatures { curvature, predicted, out_of_bounds });
            }
        } else {
            out_of_bounds = cones.to_vec();
        }
    }
    let (p, g) = centred(operators, green, watch.within(0.6, 0.7))?;
    let curvature = optimal(operators, &p, &g, [&bounds[0], &bounds[1]], watch.within(0.7, 1.0))?;
    let predicted = combine(&p, &g, &curvature);
    Ok(ConeCurvatures { curvature, predicted, out_of_bounds })
}

/// Whether so many cones, all different, are all inner vertices of the surface, none of which has too much curvature for a cone.
fn are_all(operators: &Operators, input: &Mesh, cones: &[VertexId]) -> bool {
    input.vertex_count() == operators.mesh().vertex_count()
        && cones.len() == input.vertices().filter(|&v| !input.is_boundary_vertex(v)).count()
        && cones.iter().all(|&v| operators.curvature[v] <= SPIKE)
}

/// The cones' own curvatures: where no other vertex has any, nothing is stretched, and nothing is better.
fn own(operators: &Operators, cones: &[VertexId]) -> ConeCurvatures {
    let own = cones.iter().map(|&v| operators.curvature[v]).collect();
    let nothing = VertexData::constant(operators.mesh().vertex_count(), 0.0);
    ConeCurvatures::known(operators, own, |_| nothing)
}

fn centred(
    operators: &Operators,
    mut green: Vec<VertexData<f64>>,
    watch: Watch,
) -> Result<(VertexData<f64>, Vec<VertexData<f64>>), Interrupted> {
    let mut flattening = operators.flattening().clone();
    operators.centre(&mut flattening);
    operators.centre_all(&mut green, watch)?;
    Ok((flattening, green))
}

/// p + Σ q g.
pub(crate) fn combine<'a>(
    p: &VertexData<f64>,
    green: impl IntoIterator<Item = &'a VertexData<f64>>,
    curvature: &[f64],
) -> VertexData<f64> {
    let mut u = p.clone();
    for (g, q) in green.into_iter().zip(curvature) {
        u.iter_mut().zip(g.iter()).for_each(|(u, g)| *u += q * g);
    }
    u
}

/// The curvatures least in |p + Σ q g|², on a closed surface with sum 2πχ.
fn optimal(
    operators: &Operators,
    p: &VertexData<f64>,
    green: &[VertexData<f64>],
    [bounds, sharpest]: [&[[f64; 2]]; 2],
    watch: Watch,
) -> Result<Vec<f64>, CurvatureError> {
    let n = green.len();
    let quadratic = gram_watched(green, &operators.weight, watch.within(0.0, 0.7))?;
    let product = |g: &VertexData<f64>| watch.ask(0.7).map(|()| operators.inner(g, p));
    let linear = green.par_iter().map(product).collect::<Result<Vec<f64>, Interrupted>>()?;
    let total = (!operators.is_bordered()).then(|| operators.total_curvature());
    let energy = Quadratic { constant: operators.inner(p, p), linear: &linear, matrix: &quadratic };
    let watch = watch.within(0.7, 1.0);
    match minimise_watched(&energy, bounds, total, watch) {
        Ok(optimum) => {
            let is_held = (0..n).any(|i| optimum.held[i] == Held::Upper && bounds[i][1] < sharpest[i][1]);
            let sharper = is_held.then(|| minimise_watched(&energy, sharpest, total, watch).ok()).flatten();
            watch.ask(1.0)?;
            let most = (1.0 - LEAST_SHARPENED) * optimum.energy;
            Ok(sharper.filter(|sharper| sharper.energy < most).unwrap_or(optimum).curvatures)
        }
        Err(ProgramError::Interrupted(stop)) => Err(stop.into()),
        Err(ProgramError::Infeasible { .. }) => Err(CurvatureError::TooFew {
            cones: n,
            total: operators.total_curvature(),
            least: least_cones(operators).max(n + 1),
        }),
        Err(_) => Err(CurvatureError::NotFinite { cones: n }),
    }
}

/// The curvatures for which u is 0 at all cones: G q = -p there, on a closed surface up to a constant and with sum 2πχ.
fn harmonic(
    operators: &Operators,
    cones: &[VertexId],
    flattening: &VertexData<f64>,
    green: &[VertexData<f64>],
) -> Option<Vec<f64>> {
    let n = cones.len();
    let closed = !operators.is_bordered();
    let size = n + usize::from(closed);
    let mut matrix = vec![0.0; size * size];
    let mut right = vec![0.0; size];
    for (i, &v) in cones.iter().enumerate() {
        for (j, g) in green.iter().enumerate() {
            matrix[i * size + j] = g[v];
        }
        right[i] = -flattening[v];
        if closed {
            matrix[i * size + n] = 1.0;
            matrix[n * size + i] = 1.0;
        }
    }
    if closed {
        right[n] = operators.total_curvature();
    }
    let mut curvature = dense::solve(matrix, right, 1)?;
    curvature.truncate(n);
    Some(curvature)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Metric, Poisson, shapes};

    fn hare() -> (Mesh, Operators) {
        let shape = shapes::hare(1500);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        (mesh, operators)
    }

    fn spread(mesh: &Mesh, count: usize) -> Vec<VertexId> {
        let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        (0..count).map(|k| inner[k * inner.len() / count]).collect()
    }

    #[test]
    fn the_tip_of_a_spike_may_keep_its_curvature() {
        let mut shape = shapes::sphere(300);
        shape.points[0] = shape.points[0].map(|x| 20.0 * x);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let cones = [0, 60, 120, 200, 280].map(VertexId);
        let own = operators.curvature[cones[0]];
        assert!(own > SHARPEST_CURVATURE && own < 2.0 * PI);
        let found = cone_curvatures(&operators, &mesh, &cones, CurvatureRule::Optimal, Watch::NONE).unwrap();
        assert!(found.curvature[0] > SHARPEST_CURVATURE && found.curvature[0] <= own, "{} {own}", found.curvature[0]);
        assert!(found.curvature[1..].iter().all(|k| *k <= SHARPEST_CURVATURE));
        let mut model = crate::placement::EnergyModel::new(&operators, &mesh);
        assert_eq!(model.bounds(cones[0], 5)[1], own);
        model.add(&cones);
        assert!(model.fit(&cones).curvature[0] > SHARPEST_CURVATURE);
    }

    #[test]
    fn harmonic_curvatures_are_those_of_the_solve_with_the_cones_pinned() {
        let (mesh, operators) = hare();
        let cones = spread(&mesh, 9);
        let green = operators.green(&cones);
        let curvature = harmonic(&operators, &cones, operators.flattening(), &green).unwrap();
        let source: Vec<f64> = operators.curvature.iter().map(|k| -k).collect();
        let pinned = Poisson::new(&operators.laplacian(), &cones).unwrap().solve(&source);
        let change = operators.laplacian().multiply(&pinned);
        for (&v, k) in cones.iter().zip(curvature) {
            assert!((operators.curvature[v] + change[v.0 as usize] - k).abs() < 1e-9);
        }
    }

    #[test]
    fn optimal_curvatures_sum_to_the_total_keep_their_bounds_and_beat_harmonic_ones() {
        let (mesh, operators) = hare();
        let norm = |c: &ConeCurvatures| operators.inner(&c.predicted, &c.predicted).sqrt();
        for count in [3, 4, 8, 20] {
            let cones = spread(&mesh, count);
            let optimal = cone_curvatures(&operators, &mesh, &cones, CurvatureRule::Optimal, Watch::NONE).unwrap();
            assert!((optimal.curvature.iter().sum::<f64>() - 4.0 * PI).abs() < 1e-11);
            for (k, [low, high]) in optimal.curvature.iter().zip(bounds(&operators, &mesh, &cones, SHARPEST_CURVATURE))
            {
                assert!(*k >= low - 1e-12 && *k <= high + 1e-12);
            }
            let harmonic = cone_curvatures(&operators, &mesh, &cones, CurvatureRule::Harmonic, Watch::NONE).unwrap();
            let legal = harmonic.out_of_bounds.is_empty();
            let within = harmonic.curvature.iter().zip(bounds(&operators, &mesh, &cones, SHARPEST_CURVATURE));
            if legal && within.clone().all(|(k, [low, high])| *k >= low && *k <= high) {
                assert!(norm(&optimal) <= norm(&harmonic) + 1e-12);
            }
        }
    }

    #[test]
    fn too_few_cones_for_the_curvature_are_refused() {
        let (mesh, operators) = hare();
        let error =
            cone_curvatures(&operators, &mesh, &spread(&mesh, 2), CurvatureRule::Optimal, Watch::NONE).unwrap_err();
        assert!(matches!(error, CurvatureError::TooFew { cones: 2, least: 3, .. }), "{error}");
    }

    #[test]
    fn a_developable_cone_needs_just_its_own_curvature() {
        let shape = shapes::cone(5, 300);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let tip = mesh.vertices().find(|&v| operators.curvature[v].abs() > 0.5 && !mesh.is_boundary_vertex(v)).unwrap();
        let curvatures = cone_curvatures(&operators, &mesh, &[tip], CurvatureRule::Optimal, Watch::NONE).unwrap();
        assert!((curvatures.curvature[0] - operators.curvature[tip]).abs() < 1e-9);
        assert!(curvatures.predicted.iter().all(|u| u.abs() < 1e-9));
    }

    #[test]
    fn harmonic_curvatures_must_leave_an_angle_and_may_go_lower_than_optimal_ones() {
        assert!(is_buildable(2.0 * PI - 0.03, -2.0 * PI) && !is_buildable(2.0 * PI - 0.01, -2.0 * PI));
        assert!(is_buildable(-2.0 * PI, 0.0) && !is_buildable(-2.1 * PI, 0.0));
        assert!(is_buildable(-2.1 * PI, -2.2 * PI) && !is_buildable(-2.3 * PI, -2.2 * PI));
    }

    #[test]
    fn a_flat_neighbour_of_degree_three_makes_three_triangles_one() {
        // Vertex 4 is inside the triangle 0 1 2 of a tetrahedron.
        let mesh = Mesh::new(5, &[[0, 1, 4], [1, 2, 4], [2, 0, 4], [0, 3, 1], [1, 3, 2], [2, 3, 0]]).unwrap();
        let [corner, tip, inside] = [VertexId(0), VertexId(3), VertexId(4)];
        assert_eq!([corner, tip, inside].map(|v| mesh.face_degree(v)), [4, 3, 3]);
        assert_eq!(usable_degree(&mesh, &[corner], corner), 2, "both other tips are of degree three");
        assert_eq!(usable_degree(&mesh, &[corner, inside], corner), 3, "a cone is not flat");
        assert_eq!(usable_degree(&mesh, &[corner, inside, tip], corner), 4);
        assert_eq!(usable_degree(&mesh, &[inside], inside), 3, "neighbours of degree four are not stuck");
    }

    #[test]
    fn on_surfaces_of_high_genus_few_cones_take_more_curvature_than_a_turn_each() {
        let shape = shapes::torus(3, 900);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let wide: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.face_degree(v) >= 6).step_by(97).take(3).collect();
        let found = cone_curvatures(&operators, &mesh, &wide, CurvatureRule::Optimal, Watch::NONE).unwrap();
        assert!((found.curvature.iter().sum::<f64>() + 8.0 * PI).abs() < 1e-9);
    }

    #[test]
    fn where_all_vertices_are_cones_they_keep_their_own_curvature() {
        let (mesh, operators) = hare();
        let all: Vec<VertexId> = mesh.vertices().collect();
        let found = cone_curvatures(&operators, &mesh, &all, CurvatureRule::Optimal, Watch::NONE).unwrap();
        assert!(found.predicted.iter().all(|u| *u == 0.0));
        let own = all.iter().map(|&v| operators.curvature()[v]);
        assert!(found.curvature.iter().zip(own).all(|(found, own)| (found - own).abs() < 1e-12));
    }

    #[test]
    fn many_given_curvatures_cause_what_few_columns_say() {
        let (mesh, operators) = hare();
        let cones = spread(&mesh, MOST_COLUMNS + 1);
        let curvature: Vec<f64> =
            (0..cones.len()).map(|k| 4.0 * PI / cones.len() as f64 + 0.01 * (k % 2) as f64).collect();
        let off = (curvature.iter().sum::<f64>() - 4.0 * PI) / cones.len() as f64;
        let curvature: Vec<f64> = curvature.iter().map(|k| k - off).collect();
        let found = ConeCurvatures::given(&operators, &cones, curvature.clone(), Watch::NONE).unwrap();
        let (p, green) = centred(&operators, operators.green(&cones), Watch::NONE).unwrap();
        let summed = combine(&p, &green, &curvature);
        assert!(found.predicted.iter().zip(summed.iter()).all(|(one, other)| (one - other).abs() < 1e-9));
    }
}
