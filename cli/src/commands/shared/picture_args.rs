//! The options of pictures.

use crate::render::{Paint, Scene, Shot, View};
use clap::{Args, ValueEnum};
use cones::report::Quality;

/// Pixels along a side of a picture, at most: a larger one takes a gigabyte while it is drawn.
const MOST_PIXELS: usize = 4096;
const LEAST_PIXELS: usize = 64;

/// From where a picture is taken, and how large it is.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ShotArgs {
    /// From where the picture looks: front, right, back, left, above (top), below (bottom), or degrees AZIMUTH,ELEVATION to the right of the front and
    /// above the horizon [default: the corner from which most cones are seen]
    #[arg(long, value_name = "VIEW", value_parser = View::parse, allow_hyphen_values = true, requires = "picture")]
    view: Option<View>,
    /// Its size in pixels, such as 640x480, or one number for a square [default: what the model fills of 1280x1024]
    #[arg(long, value_name = "SIZE", value_parser = size, requires = "picture")]
    size: Option<[usize; 2]>,
}

impl ShotArgs {
    pub(crate) fn shot(self) -> Shot {
        Shot { view: self.view, size: self.size }
    }
}

/// What the surface and its layout are coloured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColourName {
    /// A checkerboard
    Checker,
    /// Area distortion: blue where areas shrink, red where they grow
    Area,
    /// Quasi-conformal distortion: the longest stretch over the shortest
    Stretch,
    /// The conformal factor
    Factor,
    /// A colour for each island
    Islands,
    /// Nothing
    Plain,
}

impl ColourName {
    /// What a scene is painted with. `quality` is that of its map, `factor` the conformal factor of its vertices.
    pub(crate) fn paint(self, scene: &Scene, quality: &Quality, factor: &[f64]) -> Paint {
        match self {
            Self::Checker => Paint::Checker,
            Self::Area => Paint::area(&quality.log_areas(&scene.areas())),
            Self::Stretch => Paint::stretch(&quality.quasi_conformal),
            Self::Factor => Paint::field(factor, &scene.triangles, "conformal factor"),
            Self::Islands => Paint::Islands,
            Self::Plain => Paint::Plain,
        }
    }
}

fn size(text: &str) -> Result<[usize; 2], String> {
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    let side = |text: &str| text.parse().ok().filter(|n| (LEAST_PIXELS..=MOST_PIXELS).contains(n));
    match (side(width), side(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err(format!("not WIDTHxHEIGHT with {LEAST_PIXELS} to {MOST_PIXELS} pixels each")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_one_number_or_two() {
        assert_eq!(size("640x400"), Ok([640, 400]));
        assert_eq!(size("300"), Ok([300, 300]));
        for wrong in ["", "x", "640x", "640x400x2", "63", "4097", "-5x100", "1e3"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
