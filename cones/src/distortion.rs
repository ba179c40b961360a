//! How much a flattening will distort areas, from its log scale factor alone.

use crate::operators::Operators;
use crate::reduced::{Fitted, Reduced};

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

/// What linear theory predicts for a set of cones. One solve.
pub fn predict(reduced: &Reduced, set: &Fitted) -> Predicted {
    let u = reduced.log_scale(&set.cones, &set.curvature);
    Predicted {
        count: set.cones.len(),
        log_scale_norm: set.log_scale_norm(),
        area_distortion: area_distortion(reduced.operators(), &u),
    }
}

/// The area distortion D = Σ w max(r, 1/r) of a log scale factor u, r = e^(2u) with the mean of u in each triangle, scaled
/// so that the whole area stays, and w the triangles' shares of the area. It is 1 where areas are kept. Measured on a
/// layout by the ratios of its triangles' areas this is figure 1 of the paper.
///
/// # Panics
/// If `u` has not a value for each vertex.
pub fn area_distortion(operators: &Operators, u: &[f64]) -> f64 {
    assert_eq!(u.len(), operators.mesh.vertex_count(), "a log scale factor has one value a vertex");
    let of_face = |f| {
        let area = operators.metric.sides(&operators.mesh, f).area();
        let mean = operators.mesh.corners(f).iter().map(|v| u[v.0 as usize]).sum::<f64>() / 3.0;
        (area, (2.0 * mean).exp())
    };
    let faces: Vec<(f64, f64)> = operators.mesh.faces().map(of_face).collect();
    let before: f64 = faces.iter().map(|(area, _)| area).sum();
    let after: f64 = faces.iter().map(|(area, r)| area * r).sum();
    let distortion = |(area, r): &(f64, f64)| {
        let r = r * before / after;
        area / before * r.max(1.0 / r)
    };
    faces.iter().map(distortion).sum()
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
