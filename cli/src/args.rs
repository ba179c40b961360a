//! The command line: what may be asked for, and nothing that is not built.

use crate::commands::{
    bake, compare, completions, demo, distance, extract, features, figure, islands, man, measure, pack, persistence,
    shape, simplify, tree, unwrap, view, whole,
};
use crate::limits::MOST_THREADS;
use crate::output::Volume;
use clap::error::ErrorKind;
use clap::{Command, CommandFactory, Parser};
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::Path;

/// Unwrap surfaces conformally, with a few cones taking the curvature.
#[derive(Debug, Parser)]
#[command(name = "cones", version, arg_required_else_help = true, max_term_width = 80)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Subcommand,
    /// How many threads to work on [default: one for each core]; results do not depend on it
    #[arg(
        long,
        value_name = "T",
        value_parser = whole::<NonZeroUsize>("number of threads", 1..=MOST_THREADS),
        allow_negative_numbers = true,
        global = true,
        help_heading = "For all commands"
    )]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Say nothing but results and errors: no warnings, no progress, no summary
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "For all commands")]
    quiet: bool,
    /// Say each stage on standard error as it begins
    #[arg(short, long, global = true, help_heading = "For all commands")]
    verbose: bool,
}

impl Arguments {
    /// What this run was asked for; where that is wrong, says so and ends it.
    pub(crate) fn of_this_run() -> Self {
        let words: Vec<OsString> = std::env::args_os().collect();
        if let Some(message) = spaced_value(&Self::command(), &words) {
            clap::Error::raw(ErrorKind::InvalidValue, message).exit()
        }
        Self::parse_from(words)
    }

    /// How much is said.
    pub(crate) fn volume(&self) -> Volume {
        match (self.quiet, self.verbose) {
            (true, _) => Volume::Quiet,
            (_, true) => Volume::Verbose,
            _ => Volume::Normal,
        }
    }
}

/// What is said where an option whose value may be missing, and so stands behind `=`, has it behind a space: then it would be taken for
/// a file, which is not there.
fn spaced_value(command: &Command, words: &[OsString]) -> Option<String> {
    let options: Vec<_> = command.get_subcommands().flat_map(Command::get_arguments).collect();
    let words = words.split(|word| word == "--").next()?;
    words.windows(2).find_map(|pair| {
        let (name, value) = (pair[0].to_str()?.strip_prefix("--")?, pair[1].to_str()?);
        let is_meant = options.iter().any(|option| {
            option.is_require_equals_set()
                && option.get_long() == Some(name)
                && match &option.get_possible_values()[..] {
                    [] => value.parse::<f64>().is_ok(),
                    possible => possible.iter().any(|possible| possible.matches(value, false)),
                }
        });
        (is_meant && !Path::new(value).exists())
            .then(|| format!("there is no file {value}: if --{name} is to be {value}, write --{name}={value}\n"))
    })
}

#[derive(Debug, clap::Subcommand)]
pub(crate) enum Subcommand {
    /// Compute texture coordinates: find cones, cut between them, flatten
    Unwrap(Box<unwrap::UnwrapArgs>),
    /// List the cones that a surface asks for, without flattening it
    Extract(extract::ExtractArgs),
    /// Compare methods: distortion and time of each, on your meshes or as in the paper's Table 1
    Compare(compare::CompareArgs),
    /// Draw the figures of the paper, of any surface and methods
    Figure(figure::FigureArgs),
    /// Measure the distortion of an unwrapped OBJ, PLY or glTF, whoever made it
    Measure(measure::MeasureArgs),
    /// Take a map apart where it lies over itself, whoever made it
    Islands(islands::IslandsArgs),
    /// Pack the islands of an unwrapped OBJ, PLY or glTF into the unit square, or onto tiles
    Pack(pack::PackCommandArgs),
    /// Transfer the textures of a model to another map of it
    Bake(bake::BakeArgs),
    /// Pair the extrema of a scalar field with saddles: an array, a picture, a mesh with values, a network
    Persistence(persistence::PersistenceArgs),
    /// Find how the components of a scalar field's level sets merge
    Tree(tree::TreeArgs),
    /// Remove the small extrema of a scalar field
    Simplify(simplify::SimplifyArgs),
    /// Measure how far apart two scalar fields are, by their persistence diagrams
    Distance(distance::DistanceArgs),
    /// Find the feature points of a surface: the persistent extrema of a field on it
    Features(features::FeaturesArgs),
    /// See a surface and its maps in the browser, for any number of cones
    View(view::ViewArgs),
    /// Write one of the built-in shapes
    Shape(shape::ShapeArgs),
    /// Unwrap some built-in shapes into a folder, with pictures
    Demo(demo::DemoArgs),
    /// Print what a shell needs to complete the command line
    Completions(completions::CompletionsArgs),
    /// Print the manual page of the command or of a subcommand
    Man(man::ManArgs),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn one_way_of_choosing_cones_at_a_time() {
        let parse = |more: &[&str]| Arguments::try_parse_from([&["cones", "unwrap", "a", "-o", "b"], more].concat());
        assert!(parse(&["-n", "8"]).is_ok());
        assert!(parse(&["-n", "8", "--min-persistence", "0.1"]).is_err());
        assert!(parse(&["-n", "8", "--cones", "c"]).is_err());
        assert!(parse(&["--min-persistence", "-1"]).is_err());
    }

    #[test]
    fn a_value_behind_a_space_is_told_from_a_file() {
        let said = |line: &str| {
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            spaced_value(&Arguments::command(), &words)
        };
        for line in [
            "cones unwrap a.stl --refine always -o b.obj",
            "cones -q view --weld never a.obj",
            "cones unwrap --fill-holes 0.3 a.obj -o b.obj",
        ] {
            assert!(said(line).is_some_and(|message| message.contains("=")), "{line}");
        }
        for line in [
            "cones unwrap a.stl --refine=always -o b.obj",
            "cones unwrap --refine a.stl -o b.obj",
            "cones unwrap a.stl -o b.obj --refine",
            "cones unwrap --refine -o b.obj -- --weld never",
            "cones unwrap a.obj --open-handles always -o b.obj",
        ] {
            assert_eq!(said(line), None, "{line}");
        }
    }

    #[test]
    fn what_is_not_built_is_not_accepted() {
        for option in ["--islands=sideways", "--udim", "--threads=0", "--texel-density=9"] {
            assert!(Arguments::try_parse_from(["cones", "unwrap", "a", "-o", "b", option]).is_err(), "{option}");
        }
    }
}
