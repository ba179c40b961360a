//! Metric scaling to first order: the baseline that the paper and [BCGB08] use.
//!
//! Curvature changes by Lφ to first order when lengths are scaled by e^φ. So one solve of Lφ = K^T - K, φ = 0 on the
//! boundary, and `l_ij e^((φ_i + φ_j)/2)`, give a metric whose curvature is nearly K^T (Ben-Chen, Gotsman & Bunin 2008,
//! "Conformal flattening by curvature prescription and metric scaling"). L is the cotangent Laplacian of the triangulation
//! as it is, negative weights and all, as published. The metric is not flat, and the triangle inequality may fail: what
//! is left is reported. It is here to be compared with [`scale`](crate::flatten::scale), which is exact.

use geom::{Mesh, Metric, Poisson, PoissonError, VertexData, VertexId, angle_defects, laplacian};

/// A metric scaled by the solution of one linear system.
#[derive(Clone, Debug)]
pub struct LinearScaling {
    /// The log scale factor φ of each vertex.
    pub phi: VertexData<f64>,
    /// The scaled edge lengths.
    pub metric: Metric,
    /// The largest curvature error at an inner vertex, in radians.
    pub error: f64,
    /// The triangles in which one side is as long as the other two together, or longer.
    pub broken: usize,
}

/// Scales a surface to nearly the given curvature (by vertex, used off the boundary). One factorization and one solve.
///
/// On a closed surface the target must sum to 2πχ.
///
/// ```
/// use cones::internals::scale_linearly;
/// use geom::{Metric, VertexData, shapes};
///
/// let shape = shapes::terrain(400, 4);
/// let mesh = shape.mesh();
/// let metric = Metric::from_points(&mesh, &shape.points);
/// let flat = VertexData::constant(mesh.vertex_count(), 0.0);
/// let scaling = scale_linearly(&mesh, &metric, &flat)?;
/// assert!(scaling.error > 1e-9); // not flat, but nearly
/// # Ok::<(), geom::PoissonError>(())
/// ```
///
/// # Errors
/// If the Laplacian cannot be factored.
///
/// # Panics
/// If there is a vertex without a target.
pub fn scale_linearly(input: &Mesh, metric: &Metric, target: &VertexData<f64>) -> Result<LinearScaling, PoissonError> {
    let boundary: Vec<VertexId> = input.vertices().filter(|&v| input.is_boundary_vertex(v)).collect();
    let missing = |metric: &Metric| -> VertexData<f64> {
        angle_defects(input, metric).iter_ids().map(|(v, k)| target[v] - k).collect()
    };
    let phi = Poisson::new(&laplacian(input, metric), &boundary)?.solve(&missing(metric));
    let scaled = metric.scaled(input, &phi);
    let left = missing(&scaled);
    let inner = input.vertices().filter(|&v| !input.is_boundary_vertex(v));
    let error = inner.map(|v| left[v].abs()).fold(0.0, f64::max);
    let broken = input.faces().filter(|&f| scaled.sides(input, f).area() <= 0.0).count();
    Ok(LinearScaling { phi, metric: scaled, error, broken })
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::shapes;

    #[test]
    fn the_error_is_of_second_order() {
        for shape in [shapes::hare(1200), shapes::terrain(900, 4)] {
            let mesh = shape.mesh();
            let metric = Metric::from_points(&mesh, &shape.points);
            let curvature = angle_defects(&mesh, &metric);
            let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
            let error = |change: f64| {
                let mut target = curvature.clone();
                target[inner[7]] += change;
                target[inner[inner.len() / 2]] -= change;
                scale_linearly(&mesh, &metric, &target).unwrap().error
            };
            let ratio = error(2e-3) / error(1e-3);
            assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
        }
    }

    #[test]
    fn what_has_its_curvature_already_is_not_scaled() {
        let shape = shapes::hare(800);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let scaling = scale_linearly(&mesh, &metric, &angle_defects(&mesh, &metric)).unwrap();
        assert!(scaling.phi.iter().all(|phi| phi.abs() < 1e-12));
        assert!(scaling.error < 1e-12);
        assert_eq!(scaling.broken, 0);
    }

    #[test]
    fn triangles_that_cannot_be_are_counted() {
        let shape = shapes::hare(800);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        // All curvature of a sphere in two vertices: far from what one linear step can do.
        let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
        target[VertexId(0)] = 40.0 * std::f64::consts::PI;
        target[VertexId(400)] = -36.0 * std::f64::consts::PI;
        let scaling = scale_linearly(&mesh, &metric, &target).unwrap();
        assert!(scaling.broken > 0);
        assert!(scaling.error > 1.0);
    }
}
