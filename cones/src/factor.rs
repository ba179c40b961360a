//! The conformal factor (paper §3.1): how much scaling it takes to spread a surface's curvature evenly.
//!
//! Closed: Lφ = K^T - K with the target curvature K^T proportional to vertex area, `K^T_v = 2πχ A_v / A`. With a boundary
//! no target is needed, since the boundary can take all the curvature: Lφ = -K inside, φ constant on each boundary loop
//! with the constants that make φ's L2 norm least. φ is low where the surface sticks out (positive curvature) and high at
//! saddles. One solve on the factor of [`Operators`].

use geom::{Metric, Poisson, PoissonError, VertexData, laplacian};
use sprs::CsMat;

use crate::operators::Operators;

/// The conformal factor φ of a surface: its log scale at each vertex, centred.
#[derive(Clone, Debug)]
pub struct ConformalFactor {
    /// φ by vertex.
    pub phi: VertexData<f64>,
}

impl ConformalFactor {
    /// Solves for φ.
    pub fn new(operators: &Operators) -> Self {
        Self::of_curvature(operators, &operators.curvature)
    }

    /// φ of the curvature diffused for the time of three mean edge lengths squared, M(M + tL)⁻¹K: the extrema of noisy
    /// scans keep their places better. Costs a second factorization.
    ///
    /// # Errors
    /// If M + tL cannot be factored.
    pub fn smoothed(operators: &Operators) -> Result<Self, PoissonError> {
        Ok(Self::of_curvature(operators, &diffuse(operators)?))
    }

    fn of_curvature(operators: &Operators, curvature: &VertexData<f64>) -> Self {
        let total = if operators.is_bordered() { 0.0 } else { curvature.iter().sum() };
        let source: VertexData<f64> =
            curvature.iter().zip(operators.weight.iter()).map(|(k, w)| total * w - k).collect();
        let mut phi = operators.poisson.solve(&source);
        operators.centre(&mut phi);
        Self { phi }
    }
}

/// M(M + tL)⁻¹K with t = (3h)², h the mean edge length: one implicit step of the heat equation. Keeps ΣK.
fn diffuse(operators: &Operators) -> Result<VertexData<f64>, PoissonError> {
    let Operators { mesh, metric, curvature, .. } = operators;
    let mean_length = metric.lengths().iter().sum::<f64>() / mesh.edge_count() as f64;
    let time = (3.0 * mean_length).powi(2);
    let mass = Metric::vertex_areas(metric, mesh);
    let mut matrix: CsMat<f64> = laplacian(mesh, metric);
    matrix.data_mut().iter_mut().for_each(|l| *l *= time);
    for (v, &area) in mass.iter().enumerate() {
        *matrix.get_mut(v, v).expect("the Laplacian stores its diagonal") += area;
    }
    let density = Poisson::definite(&matrix)?.solve(curvature);
    Ok(density.iter().zip(mass.iter()).map(|(x, m)| x * m).collect())
}
