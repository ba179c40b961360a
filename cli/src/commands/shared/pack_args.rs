//! The options of packing islands.

use super::numbers::{non_negative, positive, whole};
use crate::error::options;
use crate::output;
use clap::error::ErrorKind;
use clap::{Args, ValueEnum};
use cones::Note;
use cones::uv::{PackOptions, Rotations, Tiles};

/// How islands are packed.
#[derive(Args, Debug)]
pub(crate) struct PackArgs {
    /// How many texels islands keep from each other, and half as many from the border: what is between two sides of one island is as wide as it is
    #[arg(long, value_name = "TEXELS", value_parser = non_negative, allow_negative_numbers = true, default_value_t = PackOptions::default().margin)]
    margin: f64,
    /// The side of the texture in texels
    #[arg(long, value_name = "TEXELS", value_parser = whole::<u32>("number of texels", 1..), allow_negative_numbers = true, default_value_t = PackOptions::default().texture_size)]
    texture_size: u32,
    /// How islands may be turned: those of a given map from how they lie in it, those of a new one, where they have straight sides, from where
    /// these run along the axes
    #[arg(long, value_enum, default_value_t = RotationsName::Any)]
    rotations: RotationsName,
    /// Put islands of a given size on as many tiles as they need, 1001 and on
    #[arg(long, requires = "texel_density")]
    udim: bool,
    /// Texels for each unit of length on the surface, on average over all islands, for --udim
    #[arg(long, value_name = "D", value_parser = positive, allow_negative_numbers = true, requires = "udim")]
    texel_density: Option<f64>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RotationsName {
    /// By any angle
    Any,
    /// By quarters
    Quarter,
    /// Not at all
    None,
}

impl PackArgs {
    /// Ends the run, as for any wrong argument, where each of them is right but not all together: before anything is read.
    pub(crate) fn check(&self) {
        if let Err(error) = self.options().check() {
            clap::Error::raw(ErrorKind::ValueValidation, format!("{error}{}\n", options(&error))).exit()
        }
    }

    /// Says where islands are nearer to each other than was asked for.
    pub(crate) fn warn_of_margin(&self, kept: f64) {
        if let Some(note) = Note::of_margin(self.margin, kept) {
            output::warn(&note.to_string());
        }
    }

    /// Whether islands go onto many tiles.
    pub(crate) fn is_udim(&self) -> bool {
        self.udim
    }

    /// The library's options.
    pub(crate) fn options(&self) -> PackOptions {
        let rotations = match self.rotations {
            RotationsName::Any => Rotations::Any,
            RotationsName::Quarter => Rotations::Quarter,
            RotationsName::None => Rotations::None,
        };
        let tiles = match self.texel_density {
            Some(texel_density) => Tiles::Udim { texel_density },
            None => Tiles::One,
        };
        PackOptions { texture_size: self.texture_size, margin: self.margin, rotations, tiles, ..PackOptions::default() }
    }
}
