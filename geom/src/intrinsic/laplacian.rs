//! The cotangent Laplacian, positive semidefinite.
//!
//! `L_ij = -(cot α_ij + cot β_ij)/2` off the diagonal, α and β the angles opposite the edge ij, and rows sum to zero
//! (Pinkall & Polthier 1993). To first order, scaling lengths by e^φ turns the angle defects K into K + Lφ; so the
//! paper's ∇²φ = K^T - K^O reads Lφ = K^T - K^O with this sign.

use super::metric::{Metric, Sides};
use crate::linalg::SymmetricMatrix;
use crate::mesh::{EdgeData, FaceId, Id, Triangulation, VertexId};
use crate::parallel;

/// The weight (cot α + cot β)/2 of every edge.
pub fn edge_weights(triangulation: &Triangulation, metric: &Metric) -> EdgeData<f64> {
    weights_by(triangulation, metric, Sides::cotangents)
}

/// The same with what stands for the cotangents of a triangle, opposite its sides.
pub(crate) fn weights_by(
    triangulation: &Triangulation,
    metric: &Metric,
    cotangents: impl Fn(Sides) -> [f64; 3] + Send + Sync,
) -> EdgeData<f64> {
    // Written before it is added to (see `Factorization::fill`).
    let mut weights: EdgeData<f64> = triangulation.edges().map(|_| 0.0).collect();
    parallel::each_of(
        triangulation.face_count(),
        |f| cotangents(metric.sides(triangulation, FaceId::new(f))),
        |f, cotangents| {
            for (h, cotangent) in triangulation.sides(FaceId::new(f)).into_iter().zip(cotangents) {
                weights[triangulation.edge(h)] += 0.5 * cotangent;
            }
        },
    );
    weights
}

/// The cotangent Laplacian of a triangulation: symmetric, positive semidefinite, rows sum to zero; V × V. Repeated edges
/// add up and loops cancel. O(F).
pub fn laplacian(triangulation: &Triangulation, metric: &Metric) -> SymmetricMatrix {
    let weights = edge_weights(triangulation, metric);
    SymmetricMatrix::laplacian(triangulation.vertex_count(), weighted(triangulation, &weights))
}

/// The Laplacian's rows of the first `count` vertices, on functions that have at any vertex the value of the one which it `stands_for`, one of
/// these: of a [`Double`](super::Double) with its `original`, that on what is the same on both halves. `count` × `count`; it is symmetric but
/// for the rows of vertices on the boundary, which the halves share, and kept is what lies right of the diagonal. O(F).
pub fn folded_laplacian(
    triangulation: &Triangulation,
    metric: &Metric,
    count: usize,
    stands_for: impl Fn(VertexId) -> VertexId + Sync,
) -> SymmetricMatrix {
    let weights = edge_weights(triangulation, metric);
    SymmetricMatrix::folded_laplacian(count, weighted(triangulation, &weights), |v| stands_for(VertexId(v)).0)
}

fn weighted<'a>(
    triangulation: &'a Triangulation,
    weights: &'a EdgeData<f64>,
) -> impl Iterator<Item = ([u32; 2], f64)> + Clone + Sync + 'a {
    triangulation.edges().map(|e| (triangulation.ends(e).map(|v| v.0), weights[e]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, Poisson, angle_defects};

    /// A tetrahedron with one long limb, and its curvature.
    fn limb() -> (Mesh, Metric) {
        let mesh = Mesh::new(5, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 4], [3, 2, 4], [2, 1, 4]]).unwrap();
        let points = [[0.0, 0.0, 3.0], [1.0, 0.0, 0.0], [-0.5, 0.9, 0.0], [-0.5, -0.9, 0.1], [0.1, 0.0, -1.0]];
        let metric = Metric::from_points(&mesh, &points);
        (mesh, metric)
    }

    #[test]
    fn constants_are_in_the_kernel_and_the_matrix_is_symmetric() {
        let (mesh, metric) = limb();
        let matrix = laplacian(&mesh, &metric);
        assert!(matrix.multiply(&[1.0; 5]).iter().all(|x| x.abs() < 1e-14));
        for i in 0..5 {
            assert!((0..5).all(|j| matrix.get(i, j) == matrix.get(j, i)));
        }
    }

    #[test]
    fn a_step_along_the_solution_lowers_the_curvature_error() {
        // This fixes the sign of L: the first-order change of K under scaling by e^φ is +Lφ.
        let (mesh, metric) = limb();
        let curvature = angle_defects(&mesh, &metric);
        let mean = curvature.iter().sum::<f64>() / 5.0;
        let error = |metric: &Metric| -> f64 {
            angle_defects(&mesh, metric).iter().map(|k| (k - mean).powi(2)).sum::<f64>().sqrt()
        };
        let wanted: Vec<f64> = curvature.iter().map(|k| mean - k).collect();
        let phi = Poisson::new(&laplacian(&mesh, &metric), &[]).unwrap().solve(&wanted);
        let step: Vec<f64> = phi.iter().map(|phi| 0.01 * phi).collect();
        let change = error(&metric.scaled(&mesh, &step)) / error(&metric);
        assert!((change - 0.99).abs() < 1e-3, "{change}");
    }

    #[test]
    fn on_a_double_what_is_the_same_on_both_halves_has_the_surface_s_laplacian_off_the_boundary() {
        let shape = crate::shapes::terrain(400, 3);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let double = crate::Double::new(&mesh);
        let of_double = double.metric(&mesh, &metric);
        let folded = folded_laplacian(&double.mesh, &of_double, mesh.vertex_count(), |v| double.original[v]);
        let alone = laplacian(&mesh, &metric);
        let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        assert!(inner.len() > 300);
        for &v in &inner {
            for &w in mesh.neighbors(v).iter().filter(|w| !mesh.is_boundary_vertex(**w)).chain([&v]) {
                let [one, other] = [&folded, &alone].map(|matrix| matrix.get(v.index(), w.index()));
                assert!((one - other).abs() < 1e-12 * other.abs().max(1.0), "{one} {other}");
            }
        }
    }

    #[test]
    fn solutions_satisfy_the_equation_with_and_without_fixed_vertices() {
        let (mesh, metric) = limb();
        let matrix = laplacian(&mesh, &metric);
        let b = [1.0, -2.0, 0.5, 0.25, 0.25];
        for fixed in [&[][..], &[VertexId(1)], &[VertexId(4), VertexId(0), VertexId(0)]] {
            let mut poisson = Poisson::new(&matrix, fixed).unwrap();
            for _ in 0..2 {
                let x = poisson.solve(&b);
                let product = matrix.multiply(&x);
                for v in mesh.vertices().filter(|v| !fixed.contains(v)) {
                    let residual = product[v.0 as usize] - b[v.0 as usize];
                    assert!(residual.abs() < 1e-13, "{residual}");
                }
                assert!(fixed.iter().all(|&v| x[v] == 0.0));
                let many = poisson.solve_many(&[b.to_vec().into(), x.iter().map(|_| 0.0).collect()]);
                assert!(mesh.vertices().all(|v| (many[0][v] - x[v]).abs() < 1e-12 && many[1][v] == 0.0));
                poisson = poisson.refactor(&matrix).unwrap();
            }
        }
    }
}
