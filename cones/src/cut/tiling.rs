//! Whether a texture of hatches or bricks keeps its directions across the seams.
//!
//! The two sides of a seam lie in the plane as a rigid motion apart. Where its rotation is one that the texture looks the same
//! after, the texture's lines meet at the seam. The rotation round a loop is the sum of the curvatures within (the holonomy):
//! with cones' curvatures all multiples of the texture's angle every seam between them tiles. Loops through handles and round boundaries
//! have rotations of their own, which no curvature of a cone changes.

use std::f64::consts::PI;

use geom::Mesh;
use num_complex::Complex64;

use super::options::Symmetry;
use crate::flatten::{Chain, Layout, Seams};

/// A rotation is one of the texture's if it is no further from it than this, in radians.
const TOLERANCE: f64 = 1e-9;

/// Across which seams a texture keeps its directions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Tiling {
    /// What the texture is like.
    pub symmetry: Symmetry,
    /// How many seams there are: pieces without branches.
    pub seams: usize,
    /// How many of them the texture does not keep them across.
    pub broken: usize,
    /// How far the rotation of any of the others is from one of the texture's, in radians: rounding.
    pub error: f64,
}

impl Tiling {
    /// Of no seam.
    pub(crate) fn none(symmetry: Symmetry) -> Self {
        Self { symmetry, seams: 0, broken: 0, error: 0.0 }
    }

    /// Of the seams of a layout, as it lies in the plane.
    pub fn new(mesh: &Mesh, seams: &Seams, layout: &Layout, symmetry: Symmetry) -> Self {
        let mut tiling = Self::none(symmetry);
        for chain in &seams.chains {
            tiling.seams += 1;
            let error = misfit(rotation(mesh, chain, layout), symmetry);
            match error <= TOLERANCE {
                true => tiling.error = tiling.error.max(error),
                false => tiling.broken += 1,
            }
        }
        tiling
    }
}

impl std::ops::AddAssign for Tiling {
    fn add_assign(&mut self, other: Self) {
        self.seams += other.seams;
        self.broken += other.broken;
        self.error = self.error.max(other.error);
    }
}

/// How far a rotation is from one of the texture's, in radians.
fn misfit(rotation: f64, symmetry: Symmetry) -> f64 {
    let turns = rotation / symmetry.angle();
    if turns.is_finite() { (turns - turns.round()).abs() * symmetry.angle() } else { PI }
}

/// The angle by which one side of a chain is turned against the other, by least squares over its edges.
fn rotation(mesh: &Mesh, chain: &Chain, layout: &Layout) -> f64 {
    let vector = |h| layout.corner(mesh.next(h)) - layout.corner(h);
    let mut sum = Complex64::ZERO;
    for (&e, &from) in chain.edges.iter().zip(&chain.vertices) {
        let h = mesh.halfedge(e);
        let Some(g) = mesh.twin(h) else { continue };
        let [left, right] = if mesh.tail(h) == from { [h, g] } else { [g, h] };
        sum -= vector(left) * vector(right).conj();
    }
    sum.arg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_by_the_textures_angles_fit() {
        for k in -7..8 {
            for symmetry in [Symmetry::Fourfold, Symmetry::Sixfold] {
                assert!(misfit(f64::from(k) * symmetry.angle(), symmetry) < 1e-14);
                assert!((misfit(f64::from(k) * symmetry.angle() + 0.3, symmetry) - 0.3).abs() < 1e-12);
            }
        }
        assert!(misfit(PI / 2.0, Symmetry::Sixfold) > 0.5 && misfit(f64::NAN, Symmetry::Sixfold) > 1.0);
    }
}
