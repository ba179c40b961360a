//! Discrete Gaussian curvature: the angle defect, an angle in radians that sits at a vertex.
//!
//! K = 2π - Θ inside and π - Θ on the boundary, Θ the sum of the angles at the vertex (paper §2). Discrete
//! Gauss–Bonnet holds exactly: ΣK = 2πχ.

use std::f64::consts::PI;

use super::metric::Metric;
use crate::mesh::{Mesh, VertexData};

/// The angle defect of every vertex. O(F).
pub fn angle_defects(mesh: &Mesh, metric: &Metric) -> VertexData<f64> {
    let sums = metric.angle_sums(mesh);
    mesh.vertices().map(|v| flat_angle(mesh, v) - sums[v]).collect()
}

/// The angle sum at which a vertex is flat: 2π inside, π on the boundary.
pub(crate) fn flat_angle(mesh: &Mesh, v: crate::VertexId) -> f64 {
    if mesh.is_boundary_vertex(v) { PI } else { 2.0 * PI }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn total_curvature_is_two_pi_times_the_euler_characteristic() {
        let tetrahedron = Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]).unwrap();
        let points = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 2.0, 0.0], [0.0, 0.3, 3.0]];
        let total: f64 = angle_defects(&tetrahedron, &Metric::from_points(&tetrahedron, &points)).iter().sum();
        assert!((total - 4.0 * PI).abs() < 1e-13);
        let disk = Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1]]).unwrap();
        let total: f64 = angle_defects(&disk, &Metric::from_points(&disk, &points)).iter().sum();
        assert!((total - 2.0 * PI).abs() < 1e-13);
    }
}
