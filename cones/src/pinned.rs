//! The conformal factor pinned to 0 at cones, for sets of cones that grow, on one factorization.
//!
//! With Green's functions `g_c` and the flattening p, `φ = p + Σ k_c g_c + s` vanishes at the cones S for the curvatures k of
//! the small dense system
//!
//! ```text
//!     [[G_SS, 1], [1ᵀ, 0]] [k; s] = [-p_S; 2πχ]        (with a boundary G_SS alone)
//! ```
//!
//! and it is what solving the Laplacian with the cones pinned gives, which takes a new factorization for each set. A new
//! cone adds a row to `G_SS`, so only the values of Green's functions at cones are kept.

use geom::{VertexData, VertexId};

use crate::dense;
use crate::factor::ConformalFactor;
use crate::operators::Operators;

/// Cones at which the conformal factor is pinned to 0.
pub(crate) struct Pinned<'a> {
    operators: &'a Operators,
    cones: Vec<VertexId>,
    /// p
    flattening: VertexData<f64>,
    /// G between cones, row by row up to the diagonal.
    green: Vec<Vec<f64>>,
}

impl<'a> Pinned<'a> {
    pub(crate) fn new(operators: &'a Operators) -> Self {
        let flattening = operators.poisson.solve(&operators.flattening_source());
        Self { operators, cones: Vec::new(), flattening, green: Vec::new() }
    }

    pub(crate) fn operators(&self) -> &'a Operators {
        self.operators
    }

    pub(crate) fn cones(&self) -> &[VertexId] {
        &self.cones
    }

    /// Pins more vertices. A solve each.
    pub(crate) fn add(&mut self, cones: &[VertexId]) {
        for (&cone, g) in cones.iter().zip(self.operators.green(cones)) {
            self.cones.push(cone);
            self.green.push(self.cones.iter().map(|&c| g[c]).collect());
        }
    }

    /// φ: the log scale factor that is 0 at all cones and leaves curvature nowhere else; the paper's conformal factor where
    /// there are none. One solve.
    pub(crate) fn factor(&self) -> VertexData<f64> {
        let curvature = if self.cones.is_empty() { None } else { self.curvature() };
        let Some(curvature) = curvature else { return ConformalFactor::new(self.operators).phi };
        let mut phi = self.operators.uncentred_log_scale(&self.cones, &curvature);
        if !self.operators.is_bordered() {
            let at_cones = phi[self.cones[0]];
            phi.iter_mut().for_each(|phi| *phi -= at_cones);
        }
        phi
    }

    /// k, the curvatures that pin φ; none where cones coincide.
    pub(crate) fn curvature(&self) -> Option<Vec<f64>> {
        let n = self.cones.len();
        let size = n + usize::from(!self.operators.is_bordered());
        let mut matrix = vec![0.0; size * size];
        for (i, row) in self.green.iter().enumerate() {
            for (j, &g) in row.iter().enumerate() {
                matrix[i * size + j] = g;
                matrix[j * size + i] = g;
            }
        }
        let mut right: Vec<f64> = self.cones.iter().map(|&c| -self.flattening[c]).collect();
        if size > n {
            for i in 0..n {
                matrix[i * size + n] = 1.0;
                matrix[n * size + i] = 1.0;
            }
            right.push(self.operators.total_curvature());
        }
        let mut curvature = dense::solve(matrix, right, 1)?;
        curvature.truncate(n);
        Some(curvature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Metric, Poisson, shapes};

    #[test]
    fn the_factor_is_that_of_the_solve_with_the_cones_pinned() {
        for shape in [shapes::hare(1500), shapes::torus(2, 1200), shapes::terrain(900, 4), shapes::cylinder(500)] {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let inner = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v));
            let cones: Vec<VertexId> = inner.step_by(97).collect();
            let mut pinned = Pinned::new(&operators);
            cones.chunks(2).for_each(|pair| pinned.add(pair));
            let boundary = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v));
            let fixed: Vec<VertexId> = cones.iter().copied().chain(boundary).collect();
            let source: Vec<f64> = operators.curvature.iter().map(|k| -k).collect();
            let expected = Poisson::new(&operators.laplacian, &fixed).unwrap().solve(&source);
            let phi = pinned.factor();
            assert!(phi.iter().zip(expected.iter()).all(|(phi, expected)| (phi - expected).abs() < 1e-10));
        }
    }
}
