//! The checkerboard: on the model, in the layout, and as a texture file.

use super::colour::{self, CHECKER, Colour};
use super::picture::Picture;

/// Squares along the unit square's side in the texture file.
const TEXTURE_SQUARES: u32 = 64;
/// In pictures a surface's area is that of so many squares, squared.
const FINENESS: f64 = 30.0;

/// A checkerboard over the unit square.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Checker {
    /// Along a side.
    pub(crate) squares: u32,
}

impl Checker {
    /// One whose squares are small against a layout of this area in the unit square, however thin it is.
    pub(crate) fn for_area(area: f64) -> Self {
        let squares = FINENESS / area.max(1e-4).sqrt();
        Self { squares: 2 * (0.5 * squares.clamp(32.0, 128.0)).round() as u32 }
    }

    /// The colour at texture coordinates in the unit square.
    pub(crate) fn colour(self, uv: [f64; 2]) -> Colour {
        let square = uv.map(|x| (x * f64::from(self.squares)) as i64);
        CHECKER[((square[0] + square[1]) & 1) as usize]
    }

    /// As a texture file over the unit square.
    pub(crate) fn texture() -> Picture {
        const PIXELS: usize = 1024;
        let checker = Self { squares: TEXTURE_SQUARES };
        let at = |i: usize| (i as f64 + 0.5) / PIXELS as f64;
        // Rows run downwards, v upwards.
        let pixel = |i: usize| colour::encode(checker.colour([at(i % PIXELS), 1.0 - at(i / PIXELS)]));
        Picture { width: PIXELS, height: PIXELS, pixels: (0..PIXELS * PIXELS).map(pixel).collect() }
    }
}
