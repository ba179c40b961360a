//! How far apart points of diagrams are: the ground metric, an Lq norm of the differences in birth and death.

use super::Diagram;
use crate::scalar::Scalar;

/// Birth and death.
pub(super) type Point = (f64, f64);

/// The norm Lq; q is 1 at least, and may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ground(pub(super) f64);

impl Ground {
    /// The larger of the differences.
    pub(super) const MAXIMUM: Self = Self(f64::INFINITY);

    /// The norm of the differences of two points; infinite coordinates that are equal do not differ.
    #[inline]
    pub(super) fn distance(self, p: Point, q: Point) -> f64 {
        self.norm(p.0.width(q.0), p.1.width(q.1))
    }

    /// How far a point is from the nearest of the diagonal, which has the mean of birth and death for both.
    pub(super) fn to_diagonal(self, (birth, death): Point) -> f64 {
        // Halved first, so that nothing overflows.
        let half = (birth / 2.0).width(death / 2.0);
        self.norm(half, half)
    }

    /// The norm of two differences.
    #[inline]
    pub(super) fn norm(self, x: f64, y: f64) -> f64 {
        let largest = x.max(y);
        if self.0 == f64::INFINITY || largest == 0.0 || largest == f64::INFINITY {
            largest
        } else if self.0 == 1.0 {
            x + y
        } else if self.0 == 2.0 {
            x.hypot(y)
        } else {
            largest * ((x / largest).powf(self.0) + (y / largest).powf(self.0)).powf(self.0.recip())
        }
    }
}

pub(super) fn is_bounded((birth, death): &Point) -> bool {
    birth.is_finite() && death.is_finite()
}

/// The points with finite coordinates, with their places in the diagram.
pub(super) fn bounded(diagram: &Diagram) -> (Vec<usize>, Vec<Point>) {
    diagram.finite.iter().copied().enumerate().filter(|(_, point)| is_bounded(point)).unzip()
}
