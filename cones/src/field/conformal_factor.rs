//! The conformal factor (paper §3.1): how much scaling it takes to spread a surface's curvature evenly.
//!
//! Closed: Lφ = K^T - K with the target curvature K^T proportional to vertex area, `K^T_v = 2πχ A_v / A`. With a boundary
//! no target is needed, since the boundary can take all the curvature: Lφ = -K inside, φ constant on each boundary loop
//! with the constants that make φ's L2 norm least. φ is low where the surface sticks out (positive curvature) and high at
//! saddles. One solve on the factor of [`Operators`].

use geom::{Metric, Poisson, PoissonError, VertexData, VertexId, Watch, laplacian};

use super::operators::Operators;

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
    /// If M + tL cannot be factored, or the watch has said stop.
    pub fn smoothed(operators: &Operators, watch: Watch) -> Result<Self, PoissonError> {
        let diffused = diffuse(operators, watch)?;
        watch.ask(1.0)?;
        Ok(Self::of_curvature(operators, &diffused))
    }

    fn of_curvature(operators: &Operators, curvature: &VertexData<f64>) -> Self {
        let total = if operators.is_bordered() { 0.0 } else { curvature.iter().sum() };
        let source: VertexData<f64> =
            curvature.iter().zip(operators.weight.iter()).map(|(k, w)| total * w - k).collect();
        let mut phi = operators.poisson().solve(&source);
        operators.centre(&mut phi);
        Self { phi }
    }
}

/// M(M + tL)⁻¹K with t = (3h)², h the mean edge length: one implicit step of the heat equation. Keeps ΣK. What the boundary
/// has is its own affair and does not diffuse inside.
fn diffuse(operators: &Operators, watch: Watch) -> Result<VertexData<f64>, PoissonError> {
    let Operators { mesh, metric, .. } = operators;
    let inside = |(v, k): (VertexId, &f64)| if mesh.is_boundary_vertex(v) { 0.0 } else { *k };
    let curvature: VertexData<f64> = operators.curvature.iter_ids().map(inside).collect();
    let mean_length = metric.lengths().iter().sum::<f64>() / mesh.edge_count() as f64;
    let time = (3.0 * mean_length).powi(2);
    let mass = Metric::vertex_areas(metric, mesh);
    let mut matrix = laplacian(mesh, metric);
    matrix.scale(time);
    for (v, &area) in mass.iter().enumerate() {
        *matrix.diagonal_mut(v) += area;
    }
    watch.ask(0.1)?;
    let density = Poisson::definite(&matrix, operators.points(), watch.within(0.1, 0.9))?
        .solve_watched(&curvature, watch.within(0.9, 1.0))?;
    Ok(density.iter().zip(mass.iter()).map(|(x, m)| x * m).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Id, shapes};

    fn factors(shape: &shapes::Shape) -> (Operators, ConformalFactor, ConformalFactor) {
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let (plain, smooth) =
            (ConformalFactor::new(&operators), ConformalFactor::smoothed(&operators, Watch::NONE).unwrap());
        (operators, plain, smooth)
    }

    #[test]
    fn phi_is_nearly_constant_on_a_sphere_and_zero_on_a_flat_disk() {
        let (_, sphere, _) = factors(&shapes::sphere(2000));
        assert!(sphere.phi.iter().all(|phi| phi.abs() < 1e-2));
        let (_, disk, smooth) = factors(&shapes::disk(500));
        let worst = disk.phi.iter().chain(smooth.phi.iter()).fold(0.0, |m: f64, phi| m.max(phi.abs()));
        assert!(worst < 1e-11, "{worst}");
    }

    #[test]
    fn phi_is_lowest_at_the_tips_of_a_capsule() {
        let shape = shapes::capsule(2000);
        let (_, factor, smooth) = factors(&shape);
        for phi in [factor.phi, smooth.phi] {
            let (lowest, _) = phi.iter_ids().min_by(|a, b| a.1.total_cmp(b.1)).unwrap();
            let tip = shape.points[lowest.index()];
            let reach = |p: &[f64; 3]| p.iter().map(|x| x * x).sum::<f64>();
            assert!(reach(&tip) > 0.95 * shape.points.iter().map(reach).fold(0.0, f64::max));
        }
    }

    #[test]
    fn the_laplacian_of_phi_is_the_change_of_curvature_that_was_asked_for() {
        let (operators, factor, _) = factors(&shapes::hare(1500));
        for (v, change) in operators.laplacian().multiply(&factor.phi).into_iter().enumerate() {
            let v = VertexId::new(v);
            let wanted = operators.total_curvature() * operators.weight[v] - operators.curvature[v];
            assert!((change - wanted).abs() < 1e-9);
        }
    }
}
