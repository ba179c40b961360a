//! What may be asked of a packing, and why there is none.

use geom::{Interrupted, are, counted};
use thiserror::Error;

/// How islands are packed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct PackOptions {
    /// The side of the texture in texels, which [`margin`](Self::margin) is counted in.
    pub texture_size: u32,
    /// How many texels islands keep from each other; half as many from the border of their tile. 4 texels keep
    /// bilinear filtering apart on the first three mipmaps, where they are 2, 1 and ½ a texel to either side.
    pub margin: f64,
    /// How islands may be turned.
    pub rotations: Rotations,
    /// Whether they need not be turned from how they lie, which then means nothing: of one with straight sides as much of the boundary as can be runs
    /// along the axes before it is turned further. Islands of a new map are packed so, whatever is said here, but for a
    /// [texture that runs on across seams](crate::Options::quantize).
    pub align: bool,
    /// How large they become, and on how many tiles.
    pub tiles: Tiles,
    /// The share by which seams may become longer so that islands fill more of the square, with
    /// [`Islands::Pack`](crate::Islands::Pack). Where seams are shorter than a quarter of the root of the area, as of a flat ring, it is a share
    /// of four such roots.
    pub max_seam: f64,
}

impl Default for PackOptions {
    fn default() -> Self {
        Self {
            texture_size: 1024,
            margin: 4.0,
            rotations: Rotations::Any,
            align: false,
            tiles: Tiles::One,
            max_seam: 0.1,
        }
    }
}

/// How islands may be turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Rotations {
    /// Not at all.
    None,
    /// By quarters.
    Quarter,
    /// By any angle.
    #[default]
    Any,
}

impl Rotations {
    /// What may be done to islands, beginning with the least: whoever may turn them further may also turn them less.
    pub(super) fn up_to(self) -> &'static [Self] {
        let all = &[Self::None, Self::Quarter, Self::Any];
        match self {
            Self::None => &all[..1],
            Self::Quarter => &all[..2],
            Self::Any => all,
        }
    }
}

/// How large islands become, and on how many tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Tiles {
    /// As large as goes on one tile, the unit square.
    #[default]
    One,
    /// Their scale is given, and they go on as many tiles as they need, numbered as UDIM does.
    Udim {
        /// Texels for each unit of length in the islands' plane.
        texel_density: f64,
    },
}

/// Why islands cannot be packed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PackError {
    /// The lists do not belong together.
    #[error("there {} but islands for {islands}", are(*triangles, "triangle", "triangles"))]
    Count {
        /// How many triangles there are.
        triangles: usize,
        /// For how many an island is given.
        islands: usize,
    },
    /// Texture coordinates are one for each corner of a model's faces.
    #[error("there {} for {corners} corners of faces", are(*found, "texture coordinate", "texture coordinates"))]
    TextureCount {
        /// How many texture coordinates there are.
        found: usize,
        /// How many corners there are.
        corners: usize,
    },
    /// An island's number is as large as there are triangles, or larger.
    #[error(
        "triangle {triangle} (counted from 0) is on island {island}, but of {} islands can have the numbers from 0 to {} only",
        counted(*triangles, "triangle", "triangles"),
        triangles.saturating_sub(1)
    )]
    Island {
        /// The first triangle on such an island.
        triangle: usize,
        /// The island's number.
        island: u32,
        /// How many triangles there are.
        triangles: usize,
    },
    /// A coordinate is infinite, NaN, or too large to measure with.
    #[error(
        "triangle {triangle} (counted from 0) has a texture coordinate that is not a finite number, or is beyond 1e300"
    )]
    NotFinite {
        /// The triangle.
        triangle: usize,
    },
    /// The margin leaves no room.
    #[error(
        "a margin of {} texel{} does not fit on a texture of {texture_size}: it must be at least 0 and less than a quarter of it",
        readable(*margin),
        if *margin == 1.0 { "" } else { "s" }
    )]
    Margin {
        /// What was asked for.
        margin: f64,
        /// The side of the texture.
        texture_size: u32,
    },
    /// The share of the seams is negative or no number.
    #[error("seams can become longer by a share of their length that is at least 0, but {} is given", readable(*.0))]
    MaxSeam(f64),
    /// The density is no positive number.
    #[error("a texel density must be a positive number, but {} is given", readable(*.0))]
    Density(f64),
    /// An island is larger than a tile; of several, the largest: a density lower by `times` takes all.
    #[error(
        "island {island} (counted from 0) does not fit on a tile: it is {times:.2} times too large; lower the texel density to \
         {} or cut it",
        three_digits(*fits)
    )]
    TooLarge {
        /// The island.
        island: usize,
        /// The side of the square that it takes over that of a tile.
        times: f64,
        /// A texel density with which it fits.
        fits: f64,
    },
    /// More tiles than UDIM can number.
    #[error("more than {0} tiles are needed: lower the texel density")]
    TooManyTiles(usize),
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl PackError {
    /// The same with densities in another unit, of which a unit of the islands' plane is so many.
    pub fn in_unit(self, unit: f64) -> Self {
        match self {
            Self::Density(density) => Self::Density(density / unit),
            Self::TooLarge { island, times, fits } => Self::TooLarge { island, times, fits: fits / unit },
            other => other,
        }
    }
}

/// A number as it is, or by its power of ten where it has more than fifteen digits before the point.
pub(crate) fn readable(x: f64) -> String {
    if x.abs() < 1e15 { x.to_string() } else { format!("{x:e}") }
}

/// A positive number with three digits, rounded down.
fn three_digits(x: f64) -> String {
    let last = x.log10().floor() as i32 - 2;
    format!("{:.*}", usize::try_from(-last).unwrap_or(0), (x / 10f64.powi(last)).floor() * 10f64.powi(last))
}

impl PackOptions {
    /// Refuses what makes no sense, as [`pack`](super::pack()) does, before there is anything to pack.
    ///
    /// # Errors
    /// If the margin leaves no room, the share of the seams is negative, or the density is no positive number.
    pub fn check(&self) -> Result<(), PackError> {
        let Self { texture_size, margin, tiles, .. } = *self;
        if !(margin >= 0.0 && 4.0 * margin < f64::from(texture_size)) {
            return Err(PackError::Margin { margin, texture_size });
        }
        if !(self.max_seam >= 0.0 && self.max_seam.is_finite()) {
            return Err(PackError::MaxSeam(self.max_seam));
        }
        match tiles {
            Tiles::Udim { texel_density: d } if !(d > 0.0 && d.is_finite()) => Err(PackError::Density(d)),
            _ => Ok(()),
        }
    }
}
