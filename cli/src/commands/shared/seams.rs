//! The options of seams.

use super::numbers::share;
use crate::error::CommandError;
use crate::input::EdgeFile;
use clap::error::ErrorKind;
use clap::{Args, ValueEnum};
use cones::{FreeSeams, Limbs, Options, SeamOptions, Symmetry};
use geom::{Model, texture_seams};
use std::path::{Path, PathBuf};

/// Where seams run, and what is to go on across them.
#[derive(Args, Debug)]
pub(crate) struct SeamArgs {
    /// How much seams may lengthen to run straight, along sharp edges and in hidden places: 0 (shortest) to 1
    #[arg(long, value_name = "W", value_parser = share, allow_negative_numbers = true, default_value_t = SeamOptions::default().weight)]
    seam_weight: f64,
    /// Edges to cut: a file of lines of two vertices, counted from 0
    #[arg(long, value_name = "FILE")]
    seams: Option<PathBuf>,
    /// Cut where the input's texture coordinates are cut
    #[arg(long)]
    keep_seams: bool,
    /// Edges not to cut if there is another way: a file as for --seams
    #[arg(long, value_name = "FILE")]
    avoid: Option<PathBuf>,
    /// Round cones for a texture that looks the same after 1/4 or 1/6 of a turn, so that it keeps its directions across seams
    #[arg(long, value_name = "4|6")]
    quantize: Option<SymmetryName>,
    /// Cut off thin limbs at their necks where no affordable number of cones keeps lengths
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = LimbsName::Auto)]
    cut_limbs: LimbsName,
    /// Let the two sides of seams differ, for less distortion
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = FreeSeamsName::Auto)]
    free_seams: FreeSeamsName,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LimbsName {
    Auto,
    Never,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FreeSeamsName {
    /// On coarse triangles, whose angles would be bent by more than a tenth
    Auto,
    Never,
    Always,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SymmetryName {
    /// Squares
    #[value(name = "4")]
    Fourfold,
    /// Triangles and hexagons
    #[value(name = "6")]
    Sixfold,
}

/// The edges of files, to name the line of one that is refused.
#[derive(Debug)]
pub(crate) struct EdgeFiles(Vec<EdgeFile>);

impl SeamArgs {
    /// Ends the run, as for any wrong argument, where two of them contradict each other.
    pub(crate) fn check(&self) {
        if matches!(self.free_seams, FreeSeamsName::Always) && self.quantize.is_some() {
            let message = "--free-seams always lets the two sides of seams differ, --quantize keeps them alike: leave one of the two out\n";
            clap::Error::raw(ErrorKind::ArgumentConflict, message).exit()
        }
    }

    /// The files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        [&self.seams, &self.avoid].into_iter().flatten().map(|path| &**path)
    }

    /// Reads the files into the library's options.
    pub(crate) fn read(&self, options: &mut Options) -> Result<EdgeFiles, CommandError> {
        let read = |path: &Option<PathBuf>| path.as_deref().map(EdgeFile::read).transpose();
        let (given, avoid) = (read(&self.seams)?, read(&self.avoid)?);
        let edges = |file: &Option<EdgeFile>| file.as_ref().map(EdgeFile::edges).unwrap_or_default();
        let (given_edges, avoided) = (edges(&given), edges(&avoid));
        options.seams =
            SeamOptions { weight: self.seam_weight, given: given_edges, avoid: avoided, ..SeamOptions::default() };
        options.quantize = self.quantize.map(|name| match name {
            SymmetryName::Fourfold => Symmetry::Fourfold,
            SymmetryName::Sixfold => Symmetry::Sixfold,
        });
        options.limbs = match self.cut_limbs {
            LimbsName::Auto => Limbs::Auto,
            LimbsName::Never => Limbs::Never,
        };
        options.free_seams = match self.free_seams {
            FreeSeamsName::Auto => FreeSeams::Auto,
            FreeSeamsName::Never => FreeSeams::Never,
            FreeSeamsName::Always => FreeSeams::Always,
        };
        Ok(EdgeFiles([given, avoid].into_iter().flatten().collect()))
    }

    /// Takes over the seams that a model has, where that is asked.
    pub(crate) fn keep(&self, path: &Path, model: &Model, options: &mut Options) -> Result<(), CommandError> {
        if self.keep_seams {
            if model.uv().is_none() {
                return Err(CommandError::NoSeamsToKeep(path.to_owned()));
            }
            options.seams.kept = texture_seams(model, options.preparation.weld);
        }
        Ok(())
    }
}

impl EdgeFiles {
    /// An error with the line of the edge that it is about.
    pub(crate) fn place(&self, error: CommandError) -> CommandError {
        let CommandError::Unwrap { path, mut error } = error else { return error };
        for file in &self.0 {
            match file.place(error) {
                Ok(placed) => return placed.into(),
                Err(same) => error = same,
            }
        }
        CommandError::Unwrap { path, error }
    }
}
