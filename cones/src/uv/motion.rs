//! Rigid motions of the plane, and the one that takes points nearest to others.

use num_complex::Complex64;

use super::triangle::Triangle;

/// A rotation and a shift: z goes to `turn` · z + `shift`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// A complex number of modulus 1.
    pub turn: Complex64,
    /// What is added after turning.
    pub shift: Complex64,
}

impl Motion {
    /// Leaves every point where it is, to the bit.
    pub const NONE: Self = Self { turn: Complex64::ONE, shift: Complex64::ZERO };

    /// Where a point goes.
    pub fn of(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        if *self == Self::NONE {
            return [x, y];
        }
        let z = self.turn * Complex64::new(x, y) + self.shift;
        [z.re, z.im]
    }

    /// Where a triangle goes.
    pub fn of_triangle(&self, triangle: Triangle) -> Triangle {
        triangle.map(|p| self.of(p))
    }

    /// First the other, then this.
    #[must_use]
    pub fn after(&self, other: &Self) -> Self {
        let turn = self.turn * other.turn;
        // One step of Newton's method to modulus 1, from which rounding alone can have led away.
        Self { turn: turn * (1.5 - 0.5 * turn.norm_sqr()), shift: self.turn * other.shift + self.shift }
    }

    /// What undoes it.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let turn = self.turn.conj();
        Self { turn, shift: -turn * self.shift }
    }
}

/// Points and where they should go, for the motion that takes them nearest in the sense of least squares.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// The first point and its goal; sums are of differences from them.
    first: [Complex64; 2],
    count: f64,
    from: Complex64,
    to: Complex64,
    product: Complex64,
}

impl Fit {
    pub(super) fn new(from: [f64; 2], to: [f64; 2]) -> Self {
        let zero = Complex64::ZERO;
        Self { first: [from, to].map(complex), count: 1.0, from: zero, to: zero, product: zero }
    }

    pub(super) fn add(&mut self, from: [f64; 2], to: [f64; 2]) {
        let [from, to] = [complex(from) - self.first[0], complex(to) - self.first[1]];
        self.count += 1.0;
        self.from += from;
        self.to += to;
        self.product += to * from.conj();
    }

    /// The motion; without a turn where the points say nothing of it.
    pub(super) fn motion(&self) -> Motion {
        let turn = self.product - self.to * self.from.conj() / self.count;
        let norm = turn.norm();
        let turn = if norm > 0.0 { turn / norm } else { Complex64::ONE };
        let [from, to] = [self.first[0] + self.from / self.count, self.first[1] + self.to / self.count];
        Motion { turn, shift: to - turn * from }
    }
}

fn complex([x, y]: [f64; 2]) -> Complex64 {
    Complex64::new(x, y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_motion_is_found_from_what_it_moves_and_undone(
            points in prop::collection::vec(prop::array::uniform2(-1.0..1.0f64), 2..9),
            angle in 0.0..6.3f64,
            shift in prop::array::uniform2(-9.0..9.0f64),
        ) {
            let spread = points.iter().map(|p| (p[0] - points[0][0]).hypot(p[1] - points[0][1])).fold(0.0, f64::max);
            prop_assume!(spread > 0.05);
            let motion = Motion { turn: Complex64::from_polar(1.0, angle), shift: complex(shift) };
            let mut fit = Fit::new(points[0], motion.of(points[0]));
            points[1..].iter().for_each(|&p| fit.add(p, motion.of(p)));
            let distance = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
            for &p in &points {
                prop_assert!(distance(fit.motion().of(p), motion.of(p)) < 1e-12);
                prop_assert!(distance(motion.inverse().of(motion.of(p)), p) < 1e-12);
                let twice = motion.after(&motion);
                prop_assert!(distance(twice.of(p), motion.of(motion.of(p))) < 1e-12);
            }
        }
    }
}
