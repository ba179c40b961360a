//! How much an island lies aslant of the axes.

use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::Complex64;

/// Sides whose directions differ by no more than this run the same way.
const SAME: f64 = PI / 360.0;
/// If less than this share of the boundary runs one way or across it, the island has no direction that one would see.
const LEAST: f64 = 0.25;
/// An angle that is no greater is none.
const ROUNDING: f64 = 1e-9;

/// The angle, from -π/4 to π/4, by which an island is turned away from where as much of its boundary as can be runs along the axes: the median of
/// directions that are the same. None if that is little of it. O(b log b).
pub(super) fn tilt(edges: impl Iterator<Item = [Complex64; 2]>) -> Option<f64> {
    let side = |[a, b]: [Complex64; 2]| ((b - a).arg().rem_euclid(FRAC_PI_2), (b - a).norm());
    let mut sides: Vec<(f64, f64)> = edges.map(side).collect();
    sides.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let whole: f64 = sides.iter().map(|side| side.1).sum();
    // Once more, a quarter on: what is a little less than a quarter is nearly the same as none.
    let on = sides.iter().map(|&(angle, length)| (angle + FRAC_PI_2, length));
    let round: Vec<(f64, f64)> = sides.iter().copied().chain(on).collect();
    let (mut last, mut length) = (0, 0.0);
    let mut best = (0.0, 0..0);
    for first in 0..sides.len() {
        while last < first + sides.len() && round[last].0 <= round[first].0 + SAME {
            length += round[last].1;
            last += 1;
        }
        // By more than what adding and taking away rounds.
        if length > best.0 + ROUNDING * whole {
            best = (length, first..last);
        }
        length -= round[first].1;
    }
    let (length, same) = (best.0, &round[best.1]);
    let mut up_to = 0.0;
    let is_median = |&&(_, length): &&(f64, f64)| {
        up_to += length;
        2.0 * up_to >= best.0
    };
    let angle = same.iter().find(is_median)?.0;
    let tilt = angle - (angle / FRAC_PI_2).round() * FRAC_PI_2;
    (length >= LEAST * whole && length > 0.0).then_some(if tilt.abs() > ROUNDING { tilt } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The sides of a polygon that is turned by an angle.
    fn polygon(corners: &[[f64; 2]], angle: f64) -> Vec<[Complex64; 2]> {
        let corner = |k: usize| {
            let [x, y] = corners[k % corners.len()];
            Complex64::new(x, y) * Complex64::cis(angle)
        };
        (0..corners.len()).map(|k| [corner(k), corner(k + 1)]).collect()
    }

    proptest! {
        #[test]
        fn straight_sides_lie_along_the_axes_without_their_tilt(width in 0.1..9.0f64, slant in 0.0..0.9f64, angle in -4.0..4.0f64) {
            let plank = polygon(&[[0.0, 0.0], [9.0, 0.0], [9.0 - slant, width], [0.0, width]], angle);
            let tilt = tilt(plank.iter().copied()).unwrap();
            prop_assert!(tilt.abs() <= FRAC_PI_2 / 2.0 + 1e-9);
            let long = (plank[0][1] - plank[0][0]) * Complex64::cis(-tilt);
            prop_assert!(long.re.abs().min(long.im.abs()) < 1e-9, "{long}");
        }
    }

    #[test]
    fn what_lies_along_the_axes_has_no_tilt_at_all() {
        for angle in [0.0, 1e-12, -1e-12, FRAC_PI_2, -PI] {
            let stairs = polygon(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], angle);
            assert_eq!(tilt(stairs.into_iter()), Some(0.0));
        }
    }

    #[test]
    fn what_has_no_straight_sides_has_none() {
        let around = |k: i32| (0.02 * PI * f64::from(k)).sin_cos();
        let ellipse: Vec<[f64; 2]> = (0..100).map(around).map(|(y, x)| [3.0 * x, y]).collect();
        assert_eq!(tilt(polygon(&ellipse, 0.4).into_iter()), None);
        assert_eq!(tilt(std::iter::empty()), None);
        assert_eq!(tilt(polygon(&[[2.0, 3.0]; 3], 0.0).into_iter()), None);
    }
}
