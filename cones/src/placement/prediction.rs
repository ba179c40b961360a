//! How much a flattening will distort areas, from its log scale factor alone.

use geom::{FaceId, Id, VertexData};
use rayon::prelude::*;

use super::configuration::Configuration;
use super::energy_model::{ConeSet, EnergyModel};
use crate::curvature::CurvatureRule;
use crate::field::Operators;

/// So many triangles or vertices are gone through one after the other.
const AT_ONCE: usize = 1 << 12;
/// Lengths that change by more than this factor against the mean hardly ever can be: a scan whose noise has made tiny handles comes there, and
/// Newton's method would take long to fail.
pub(crate) const MOST_STRETCH: f64 = 3000.0;

/// What linear theory predicts for a set of cones.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Prediction {
    /// The number of cones.
    #[cfg_attr(feature = "serde", serde(rename = "n"))]
    pub count: usize,
    /// The L2 norm of the log scale factor, weighted by area.
    #[cfg_attr(feature = "serde", serde(rename = "predicted_l2"))]
    pub log_scale_norm: f64,
    /// The area distortion D: the mean of max(r, 1/r), weighted by area, r the ratio of areas after one global scaling.
    #[cfg_attr(feature = "serde", serde(rename = "predicted_area"))]
    pub area_distortion: f64,
}

impl Prediction {
    /// For so many cones and the log scale factor that they leave.
    pub(super) fn of(operators: &Operators, count: usize, u: &[f64]) -> Self {
        let log_scale_norm = operators.inner(u, u).sqrt();
        Self { count, log_scale_norm, area_distortion: area_distortion(operators, u) }
    }

    /// Nothing is known.
    pub(crate) fn none() -> Self {
        Self { count: 0, log_scale_norm: f64::NAN, area_distortion: f64::NAN }
    }
}

/// What linear theory predicts for a set of cones that get their curvatures by a rule. A back-substitution at most; one more for each
/// cone where they are harmonic.
pub(crate) fn predict(model: &EnergyModel, set: &ConeSet, rule: CurvatureRule) -> Prediction {
    let operators = model.operators();
    let u = match rule {
        CurvatureRule::Optimal => model.log_scale(&set.cones, &set.curvature),
        CurvatureRule::Harmonic => Configuration::new(operators, set, rule).log_scale(operators),
    };
    Prediction::of(operators, set.cones.len(), &u)
}

/// The area distortion D = Σ w max(r, 1/r) of a log scale factor u, r = e^(2u) with the mean of u in each triangle, scaled
/// so that the whole area stays, and w the triangles' shares of the area. It is 1 where areas are kept. Measured on a
/// layout by the ratios of its triangles' areas this is figure 1 of the paper.
///
/// # Panics
/// If `u` has not a value for each vertex.
pub(crate) fn area_distortion(operators: &Operators, u: &[f64]) -> f64 {
    distortion_of(&area_ratios(operators, u))
}

/// Where lengths change by more than [`MOST_STRETCH`], cones with a larger area distortion are hopeless: on `cheese` 32 cones with 1.9 leave 600 of
/// 17,786 triangles folded over after as much work as all the rest takes.
const POOR: f64 = 1.5;

/// Whether a log scale factor says that trying to flatten is a waste of time.
pub(crate) fn is_hopeless(operators: &Operators, u: &VertexData<f64>) -> bool {
    stretch(operators, u.clone()) > MOST_STRETCH.ln() && area_distortion(operators, u) > POOR
}

/// The logarithm of the largest factor by which lengths change against the mean.
pub(crate) fn stretch(operators: &Operators, mut u: VertexData<f64>) -> f64 {
    operators.subtract_mean(&mut u);
    u.iter().fold(0.0_f64, |most, u| most.max(u.abs()))
}

/// The area of each triangle, and by what it is multiplied.
fn area_ratios(operators: &Operators, u: &[f64]) -> Vec<(f64, f64)> {
    assert_eq!(u.len(), operators.mesh.vertex_count(), "a log scale factor has one value a vertex");
    // e^(2/3 u): three of them make a triangle's ratio.
    let share: Vec<f64> = u.par_iter().with_min_len(AT_ONCE).map(|u| (u * (2.0 / 3.0)).exp()).collect();
    let of_face = |f: usize| {
        let f = FaceId::new(f);
        let area = operators.metric.sides(&operators.mesh, f).area();
        let [a, b, c] = operators.mesh.corners(f).map(|v| share[v.index()]);
        (area, a * b * c)
    };
    (0..operators.mesh.face_count()).into_par_iter().with_min_len(AT_ONCE).map(of_face).collect()
}

pub(crate) fn distortion_of<'a>(faces: impl IntoIterator<Item = &'a (f64, f64)> + Clone) -> f64 {
    let (before, after) = faces.clone().into_iter().fold((0.0, 0.0), |(b, a), (area, r)| (b + area, a + area * r));
    let distortion = |(area, r): &(f64, f64)| {
        let r = r * before / after;
        area / before * r.max(1.0 / r)
    };
    let sum: f64 = faces.into_iter().map(distortion).sum();
    // Log scale factors beyond what e^u can hold.
    if sum.is_nan() { f64::INFINITY } else { sum }
}

/// What is predicted for several components that are laid out side by side, each with a mean log scale of 0.
pub(crate) struct Predictor {
    components: Vec<ScaledComponent>,
}

/// A component under its log scale factor.
#[derive(Clone, Default)]
struct ScaledComponent {
    count: usize,
    area: f64,
    energy: f64,
    faces: Vec<(f64, f64)>,
}

impl Predictor {
    /// So many components, of which nothing is known yet.
    pub(crate) fn new(components: usize) -> Self {
        Self { components: vec![ScaledComponent::default(); components] }
    }

    /// A component's number of cones and log scale factor; `area` is that in the model.
    pub(crate) fn put(
        &mut self,
        component: usize,
        operators: &Operators,
        area: f64,
        count: usize,
        mut u: VertexData<f64>,
    ) {
        operators.subtract_mean(&mut u);
        let mut faces = area_ratios(operators, &u);
        let own: f64 = faces.iter().map(|(area, _)| area).sum();
        faces.iter_mut().for_each(|(share, _)| *share *= area / own);
        self.components[component] = ScaledComponent { count, area, energy: operators.inner(&u, &u), faces };
    }

    /// What all components together come to.
    pub(crate) fn prediction(&self) -> Prediction {
        let area: f64 = self.components.iter().map(|component| component.area).sum();
        let energy: f64 = self.components.iter().map(|component| component.area * component.energy).sum();
        Prediction {
            count: self.components.iter().map(|component| component.count).sum(),
            log_scale_norm: (energy / area).sqrt(),
            area_distortion: distortion_of(self.components.iter().flat_map(|component| &component.faces)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Metric, VertexData, shapes};

    #[test]
    fn what_keeps_areas_or_scales_all_alike_has_no_distortion() {
        let shape = shapes::hare(500);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        for u in [0.0, 2.5] {
            let u = VertexData::constant(mesh.vertex_count(), u);
            assert!((area_distortion(&operators, &u) - 1.0).abs() < 1e-12);
        }
        let uneven: VertexData<f64> = mesh.vertices().map(|v| f64::from(v.0 % 3)).collect();
        assert!(area_distortion(&operators, &uneven) > 1.0);
    }

    #[test]
    fn the_area_distortion_is_that_of_each_triangle_scaled_by_the_square_of_its_mean_scale() {
        let shape = shapes::hare(300);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let u: VertexData<f64> = mesh.vertices().map(|v| 0.3 * f64::from(v.0 % 5)).collect();
        let faces: Vec<(f64, f64)> = operators
            .mesh
            .faces()
            .map(|f| {
                let mean = operators.mesh.corners(f).iter().map(|&v| u[v]).sum::<f64>() / 3.0;
                (operators.metric.sides(&operators.mesh, f).area(), (2.0 * mean).exp())
            })
            .collect();
        let whole: f64 = faces.iter().map(|(area, _)| area).sum();
        let image: f64 = faces.iter().map(|(area, r)| area * r).sum();
        let ratio = |r: f64| r * whole / image;
        let expected: f64 = faces.iter().map(|&(area, r)| area / whole * ratio(r).max(1.0 / ratio(r))).sum();
        assert!((area_distortion(&operators, &u) - expected).abs() < 1e-12 * expected);
    }

    #[test]
    fn components_count_by_their_areas() {
        let shape = shapes::hare(300);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let u: VertexData<f64> = mesh.vertices().map(|v| f64::from(v.0 % 3)).collect();
        let mut alone = Predictor::new(1);
        alone.put(0, &operators, 3.0, 4, u.clone());
        let alone = alone.prediction();
        let mut centred = u.clone();
        operators.subtract_mean(&mut centred);
        assert!((alone.log_scale_norm - operators.inner(&centred, &centred).sqrt()).abs() < 1e-12);
        let mut both = Predictor::new(2);
        both.put(0, &operators, 3.0, 4, u);
        both.put(1, &operators, 1.0, 2, VertexData::constant(mesh.vertex_count(), 7.0));
        let both = both.prediction();
        assert_eq!((alone.count, both.count), (4, 6));
        assert!((both.log_scale_norm - (0.75 * alone.log_scale_norm.powi(2)).sqrt()).abs() < 1e-12);
        assert!(both.area_distortion < alone.area_distortion && both.area_distortion > 1.0);
    }
}
