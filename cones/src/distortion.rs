//! How much a flattening will distort areas, from its log scale factor alone.

use geom::VertexData;

use crate::angles::Angles;
use crate::operators::Operators;
use crate::reduced::Fitted;
use crate::settled::Settled;

/// What linear theory predicts for a set of cones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predicted {
    /// The number of cones.
    pub count: usize,
    /// The L2 norm of the log scale factor, weighted by area.
    pub log_scale_norm: f64,
    /// The area distortion D, see [`area_distortion`].
    pub area_distortion: f64,
}

/// What linear theory predicts for a set of cones that get their curvatures by a rule. Half a solve; one more for each cone
/// where they are harmonic.
pub fn predict(operators: &Operators, set: &Fitted, angles: Angles) -> Predicted {
    let u = Settled::new(operators, set, angles).log_scale(operators);
    Predicted {
        count: set.cones.len(),
        log_scale_norm: operators.inner(&u, &u).sqrt(),
        area_distortion: area_distortion(operators, &u),
    }
}

/// The area distortion D = Σ w max(r, 1/r) of a log scale factor u, r = e^(2u) with the mean of u in each triangle, scaled
/// so that the whole area stays, and w the triangles' shares of the area. It is 1 where areas are kept. Measured on a
/// layout by the ratios of its triangles' areas this is figure 1 of the paper.
///
/// # Panics
/// If `u` has not a value for each vertex.
pub fn area_distortion(operators: &Operators, u: &[f64]) -> f64 {
    distortion_of(&area_ratios(operators, u))
}

/// The area of each triangle, and by what it is multiplied.
fn area_ratios(operators: &Operators, u: &[f64]) -> Vec<(f64, f64)> {
    assert_eq!(u.len(), operators.mesh.vertex_count(), "a log scale factor has one value a vertex");
    // e^(2/3 u): three of them make a triangle's ratio.
    let share: VertexData<f64> = u.iter().map(|u| (u * (2.0 / 3.0)).exp()).collect();
    let of_face = |f| {
        let area = operators.metric.sides(&operators.mesh, f).area();
        let [a, b, c] = operators.mesh.corners(f).map(|v| share[v]);
        (area, a * b * c)
    };
    operators.mesh.faces().map(of_face).collect()
}

fn distortion_of<'a>(faces: impl IntoIterator<Item = &'a (f64, f64)> + Clone) -> f64 {
    let (before, after) = faces.clone().into_iter().fold((0.0, 0.0), |(b, a), (area, r)| (b + area, a + area * r));
    let distortion = |(area, r): &(f64, f64)| {
        let r = r * before / after;
        area / before * r.max(1.0 / r)
    };
    let sum: f64 = faces.into_iter().map(distortion).sum();
    // Log scale factors beyond what e^u can hold.
    if sum.is_nan() { f64::INFINITY } else { sum }
}

/// What is predicted for several connected parts that are laid out side by side, each with a mean log scale of 0.
pub(crate) struct Whole {
    parts: Vec<PartScale>,
}

/// A part under its log scale factor.
#[derive(Clone, Default)]
struct PartScale {
    count: usize,
    area: f64,
    energy: f64,
    faces: Vec<(f64, f64)>,
}

impl Whole {
    /// So many parts, of which nothing is known yet.
    pub(crate) fn new(parts: usize) -> Self {
        Self { parts: vec![PartScale::default(); parts] }
    }

    /// A part's number of cones and log scale factor; `area` is that in the model.
    pub(crate) fn put(&mut self, part: usize, operators: &Operators, area: f64, count: usize, mut u: VertexData<f64>) {
        operators.subtract_mean(&mut u);
        let mut faces = area_ratios(operators, &u);
        let own: f64 = faces.iter().map(|(area, _)| area).sum();
        faces.iter_mut().for_each(|(share, _)| *share *= area / own);
        self.parts[part] = PartScale { count, area, energy: operators.inner(&u, &u), faces };
    }

    /// What all parts together come to.
    pub(crate) fn predicted(&self) -> Predicted {
        let area: f64 = self.parts.iter().map(|part| part.area).sum();
        let energy: f64 = self.parts.iter().map(|part| part.area * part.energy).sum();
        Predicted {
            count: self.parts.iter().map(|part| part.count).sum(),
            log_scale_norm: (energy / area).sqrt(),
            area_distortion: distortion_of(self.parts.iter().flat_map(|part| &part.faces)),
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
}
