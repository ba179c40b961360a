//! The checkerboard, the same on the model, in the layout and in the texture file.

use super::canvas::Picture;
use super::colour::{self, CHECKER, Colour};

/// Squares along the unit square's side in the texture file.
pub(crate) const SQUARES: f64 = 32.0;

/// The colour at texture coordinates in the unit square.
pub(crate) fn colour(uv: [f64; 2]) -> Colour {
    let square = uv.map(|x| (x * SQUARES).floor() as i64);
    CHECKER[((square[0] + square[1]) & 1) as usize]
}

/// The texture file: SQUARES × SQUARES squares over the unit square.
pub(crate) fn texture() -> Picture {
    const PIXELS: usize = 1024;
    let at = |i: usize| (i as f64 + 0.5) / PIXELS as f64;
    // Rows run downwards, v upwards.
    let pixels = (0..PIXELS * PIXELS).map(|i| colour::encode(colour([at(i % PIXELS), 1.0 - at(i / PIXELS)]))).collect();
    Picture { width: PIXELS, height: PIXELS, pixels }
}
