//! The terrain of the paper's Fig. 3.

use std::f64::consts::TAU;

use super::Shape;
use super::plain::{lifted_square, square_side};

/// The square [-1, 1]² lifted along z: eight hills round a higher ninth in the middle, and noise. The field of heights is
/// the z coordinate of the points; the nine highest persistences of its maxima are the hills'. `seed` chooses the
/// noise and how high each of the eight is; the ground is the same however fine the mesh.
pub fn terrain(vertices: usize, seed: u64) -> Shape {
    lifted_square(square_side(vertices), |x, y| {
        let hills: f64 = (0..8)
            .map(|k| {
                let (sin, cos) = (TAU * k as f64 / 8.0).sin_cos();
                let height = 0.35 + 0.1 * random(seed, [k, -1]);
                height * bump((x - 0.68 * cos).hypot(y - 0.68 * sin) / 0.16)
            })
            .sum();
        hills
            + 0.75 * bump(x.hypot(y) / 0.22)
            + 0.05 * noise(seed, 9.0 * x, 9.0 * y)
            + 0.025 * noise(seed.wrapping_add(1), 22.0 * x, 22.0 * y)
    })
}

/// 1 at 0, small beyond 2.
fn bump(t: f64) -> f64 {
    (-0.5 * t * t).exp()
}

/// Random values on the integer lattice, between -1 and 1, and smoothly in between.
fn noise(seed: u64, x: f64, y: f64) -> f64 {
    let [i, j] = [x.floor(), y.floor()];
    let [s, t] = [x - i, y - j].map(|t| t * t * (3.0 - 2.0 * t));
    let at = |di: i64, dj: i64| 2.0 * random(seed, [i as i64 + di, j as i64 + dj]) - 1.0;
    let row = |dj| at(0, dj) + s * (at(1, dj) - at(0, dj));
    row(0) + t * (row(1) - row(0))
}

/// A random number from 0 to 1 that depends on a seed and two integers (the finalizer of `SplitMix64`; Steele, Lea and
/// Flood 2014).
fn random(seed: u64, [i, j]: [i64; 2]) -> f64 {
    let mut z = seed ^ (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).rotate_left(32);
    for _ in 0..2 {
        z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
    }
    (z >> 11) as f64 / (1u64 << 53) as f64
}
