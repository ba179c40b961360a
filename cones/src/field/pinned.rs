//! The conformal factor pinned to 0 at cones, for sets of cones that grow, on one factorization.
//!
//! With G the inverse of the grounded Laplacian and p = -G K, up to a constant, `φ = p + Σ k_c G e_c + s` vanishes at the cones S for the
//! curvatures k of the small dense system
//!
//! ```text
//!     [[G_SS, 1], [1ᵀ, 0]] [k; s] = [-p_S; 2πχ]        (with a boundary G_SS alone)
//! ```
//!
//! and it is what solving the Laplacian with the cones pinned gives, which takes a new factorization for each set. Entries
//! of G come from sparse forward substitutions ([`geom::Poisson::solve_forward`]), a small part of a solve each, and a new cone adds a row to a
//! Cholesky factor of `G_SS`. The grounded vertex, where G is 0, can be a cone too: it fixes s, and has the curvature that
//! is left.

use geom::{ForwardSolution, VertexData, VertexId};

use super::conformal_factor::ConformalFactor;
use super::operators::Operators;
use crate::numerics::dense::Growing;

/// Cones at which the conformal factor is pinned to 0.
pub(crate) struct PinnedFactor<'a> {
    operators: &'a Operators,
    cones: Vec<VertexId>,
    /// p: all curvature taken to the grounded vertex or the boundary.
    flattening: VertexData<f64>,
    /// The forward substitutions of the cones' unit vectors.
    forward: Vec<ForwardSolution>,
    /// The factor of `G_SS`, the grounded vertex left out; none where cones coincide.
    green: Option<Growing>,
}

impl<'a> PinnedFactor<'a> {
    pub(crate) fn new(operators: &'a Operators) -> Self {
        let mut source: VertexData<f64> = operators.curvature.iter().map(|k| -k).collect();
        if let Some(grounded) = operators.poisson().grounded() {
            source[grounded] += operators.total_curvature();
        }
        let flattening = operators.poisson().solve(&source);
        Self { operators, cones: Vec::new(), flattening, forward: Vec::new(), green: Some(Growing::default()) }
    }

    pub(crate) fn operators(&self) -> &'a Operators {
        self.operators
    }

    pub(crate) fn cones(&self) -> &[VertexId] {
        &self.cones
    }

    /// Pins more vertices. A sparse forward substitution each.
    pub(crate) fn add(&mut self, cones: &[VertexId]) {
        for (&cone, forward) in cones.iter().zip(self.operators.poisson().solve_forward(cones)) {
            self.cones.push(cone);
            self.forward.push(forward);
            let Some(last) = self.forward.last().filter(|_| !self.is_grounded(cone)) else { continue };
            let others = self.cones.iter().zip(&self.forward).filter(|(c, _)| !self.is_grounded(**c));
            let row = others.map(|(_, other)| last.dot(other)).collect();
            self.green = self.green.take().and_then(|green| green.with(row));
        }
    }

    fn is_grounded(&self, cone: VertexId) -> bool {
        self.operators.poisson().grounded() == Some(cone)
    }

    /// φ: the log scale factor that is 0 at all cones and leaves curvature nowhere else; the paper's conformal factor where
    /// there are none. A back-substitution.
    pub(crate) fn factor(&self) -> VertexData<f64> {
        let curvature = if self.cones.is_empty() { None } else { self.curvature() };
        let Some(curvature) = curvature else { return ConformalFactor::new(self.operators).phi };
        let mut phi = self.operators.poisson().solve_backward(self.forward.iter().zip(curvature));
        phi.iter_mut().zip(self.flattening.iter()).for_each(|(phi, p)| *phi += p);
        if !self.operators.is_bordered() {
            let at_cones = phi[self.cones[0]];
            phi.iter_mut().for_each(|phi| *phi -= at_cones);
        }
        phi
    }

    /// k, the curvatures that pin φ; none where cones coincide.
    pub(crate) fn curvature(&self) -> Option<Vec<f64>> {
        let green = self.green.as_ref()?;
        let free: Vec<VertexId> = self.cones.iter().copied().filter(|&c| !self.is_grounded(c)).collect();
        let minus_p = green.solve(free.iter().map(|&c| -self.flattening[c]).collect());
        if self.operators.is_bordered() {
            return Some(minus_p);
        }
        let ones = green.solve(vec![1.0; free.len()]);
        let total = self.operators.total_curvature();
        let shift = match self.operators.poisson().grounded().filter(|c| self.cones.contains(c)) {
            Some(grounded) => -self.flattening[grounded],
            None => (minus_p.iter().sum::<f64>() - total) / ones.iter().sum::<f64>(),
        };
        let mut curvature: Vec<f64> = minus_p.iter().zip(&ones).map(|(p, one)| p - shift * one).collect();
        if let Some(at) = self.cones.iter().position(|&c| self.is_grounded(c)) {
            curvature.insert(at, total - curvature.iter().sum::<f64>());
        }
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
            let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
            // On closed surfaces the last vertex is the grounded one.
            for cones in [
                inner.iter().copied().step_by(97).collect::<Vec<_>>(),
                inner.iter().rev().copied().step_by(97).collect(),
            ] {
                let mut pinned = PinnedFactor::new(&operators);
                cones.chunks(2).for_each(|pair| pinned.add(pair));
                let boundary = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v));
                let fixed: Vec<VertexId> = cones.iter().copied().chain(boundary).collect();
                let source: Vec<f64> = operators.curvature.iter().map(|k| -k).collect();
                let expected = Poisson::new(&operators.laplacian(), &fixed).unwrap().solve(&source);
                let phi = pinned.factor();
                assert!(phi.iter().zip(expected.iter()).all(|(phi, expected)| (phi - expected).abs() < 1e-10));
            }
        }
    }
}
