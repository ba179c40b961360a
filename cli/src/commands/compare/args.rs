//! What may be asked of `cones compare`.

use super::variant::Variant;
use crate::commands::shared::{vertex_count, whole};
use clap::{Args, ValueEnum};
use cones::MOST_ORDERED;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub(crate) struct CompareArgs {
    /// The surfaces: OBJ, OFF, PLY, STL or glTF [default: built-in shapes]
    #[arg(value_name = "MESH", conflicts_with = "paper")]
    pub(super) meshes: Vec<PathBuf>,
    /// How many cones, such as 4,8,16
    #[arg(short = 'n', value_name = "N,…", value_delimiter = ',', default_value = "8", value_parser = whole::<usize>("number of cones", 0..=MOST_ORDERED), allow_negative_numbers = true, conflicts_with = "paper")]
    pub(super) counts: Vec<usize>,
    /// Which methods: RULE[+smooth][+ANGLES][+FLATTENING] [default: the paper's two, persistence, refined, linear, lscm]
    #[arg(
        long,
        value_name = "M,…",
        value_delimiter = ',',
        default_value = "alternating+harmonic,refactoring+harmonic,persistence,refined,linear,lscm",
        hide_default_value = true,
        value_parser = Variant::parse,
        long_help = Variant::help(),
        conflicts_with = "paper"
    )]
    pub(super) method: Vec<Variant>,
    /// Diffuse the curvature before extrema are looked for, in all methods that look for them: +smooth
    #[arg(long, conflicts_with = "paper")]
    pub(super) smooth: bool,
    /// Run Table 1 of the paper on the meshes of this folder, and say which of its claims hold
    #[arg(long, value_name = "DIR")]
    pub(super) paper: Option<PathBuf>,
    /// How to write the table [default: as the output's ending says, else text]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Where to write it [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Run everything so many times in turn, and keep the best times
    #[arg(long, value_name = "K", default_value_t = 3, value_parser = whole::<u16>("number", 1..=usize::from(u16::MAX)), allow_negative_numbers = true)]
    pub(super) best_of: u16,
    /// About how many vertices the built-in shapes have
    #[arg(long, value_name = "V", default_value_t = 3000, value_parser = vertex_count, allow_negative_numbers = true)]
    pub(super) vertices: usize,
}

impl CompareArgs {
    /// How to write the table.
    pub(super) fn format(&self) -> Format {
        let ending = self.output.as_deref().and_then(Path::extension).and_then(|ending| ending.to_str());
        let by_ending = || ending.and_then(|ending| Format::from_str(ending, true).ok());
        self.format.or_else(by_ending).unwrap_or(Format::Text)
    }

    /// The methods to run.
    pub(super) fn variants(&self) -> Vec<Variant> {
        self.method.iter().map(|variant| if self.smooth { variant.smoothed() } else { *variant }).collect()
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Format {
    /// A table for each mesh and N with the most important columns, for terminals
    Text,
    /// A Markdown table of all columns with its legend
    Md,
    /// The rows alone; the legend goes to standard error
    Csv,
    /// One document with rows and legend
    Json,
}
