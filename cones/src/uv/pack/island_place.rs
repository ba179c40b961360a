//! Rigid motions of the plane: z ↦ t(z - from) + to with |t| = 1.

use num_complex::Complex64;

/// Where an island goes: a rotation about a point and a translation, never a mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IslandPlace {
    /// Cosine and sine of the angle that it is turned by.
    pub turn: [f64; 2],
    /// The point that it is turned about.
    pub from: [f64; 2],
    /// Where that point comes to lie, in the plane of the islands, before scaling.
    pub to: [f64; 2],
    /// Its tile, counted from 0: the first is UDIM 1001, ten are in a row.
    pub tile: u32,
}

impl IslandPlace {
    /// What leaves everything where it is.
    pub const NONE: Self = Self { turn: [1.0, 0.0], from: [0.0; 2], to: [0.0; 2], tile: 0 };

    /// The image of a point on the island's tile, before scaling.
    pub fn apply(&self, p: [f64; 2]) -> [f64; 2] {
        let Self { turn: [c, s], from, to, .. } = self;
        let [x, y] = [p[0] - from[0], p[1] - from[1]];
        [c * x - s * y + to[0], s * x + c * y + to[1]]
    }

    /// The angle in radians, from -π to π, counter-clockwise.
    pub fn angle(&self) -> f64 {
        self.turn[1].atan2(self.turn[0])
    }

    /// The lower left corner of the tile.
    pub fn corner(&self) -> [f64; 2] {
        [self.tile % 10, self.tile / 10].map(f64::from)
    }

    /// The tile's number by UDIM.
    pub fn udim(&self) -> u32 {
        1001 + self.tile
    }
}

/// The turn by an angle in radians; quarters are exact.
pub(super) fn turn(angle: f64) -> Complex64 {
    let quarters = angle / std::f64::consts::FRAC_PI_2;
    match quarters {
        q if q == q.round() => quarter(q as i64),
        _ => Complex64::cis(angle),
    }
}

/// The turn by so many quarters, exactly.
pub(super) fn quarter(k: i64) -> Complex64 {
    match k.rem_euclid(4) {
        0 => Complex64::new(1.0, 0.0),
        1 => Complex64::new(0.0, 1.0),
        2 => Complex64::new(-1.0, 0.0),
        _ => Complex64::new(0.0, -1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_motion_turns_about_its_point_and_moves_it() {
        let motion = IslandPlace { turn: [0.0, 1.0], from: [1.0, 1.0], to: [5.0, 0.0], tile: 12 };
        assert_eq!(motion.apply([1.0, 1.0]), [5.0, 0.0]);
        assert_eq!(motion.apply([2.0, 1.0]), [5.0, 1.0]);
        assert_eq!((motion.angle(), motion.udim()), (PI / 2.0, 1013));
        assert_eq!(IslandPlace::NONE.apply([0.3, -7.0]), [0.3, -7.0]);
    }

    #[test]
    fn quarters_are_exact() {
        for k in -4..8 {
            assert_eq!(turn(k as f64 * PI / 2.0), quarter(k));
        }
    }
}
