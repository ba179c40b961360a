//! The command line: what may be asked for, and nothing that is not built.

use crate::commands::{compare, features, persistence};
use crate::failure::Failure;
use crate::input::cone_file;
use clap::{Args, Parser, Subcommand, ValueEnum};
use cones::{Angles, ConeChoice, Method, Options};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Unwrap surfaces conformally, with a few cones taking the curvature.
#[derive(Debug, Parser)]
#[command(name = "cones", version, arg_required_else_help = true, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// How many threads to work on [default: one for each core]; results do not depend on it
    #[arg(long, value_name = "T", global = true)]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Compute texture coordinates: find cones, cut between them, flatten
    Unwrap(Unwrap),
    /// List the cones that a surface asks for, without flattening it
    Extract(Extract),
    /// Compare methods: distortion and time of each, on your meshes or as in the paper's Table 1
    Compare(compare::Arguments),
    /// Measure the distortion of an unwrapped OBJ or PLY, whoever made it
    Measure(Measure),
    /// Pair the extrema of a scalar field with saddles: an array, a picture, a mesh with values, a network
    Persistence(persistence::Arguments),
    /// Find the feature points of a surface: the persistent extrema of a field on it
    Features(features::Arguments),
    /// Write one of the built-in shapes
    Shape(Shape),
    /// Unwrap some built-in shapes into a folder, with pictures
    Demo(Demo),
}

#[derive(Args, Debug)]
pub(crate) struct Unwrap {
    /// The surface: OBJ, OFF, PLY or STL, gzipped or not
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// Where to write it with texture coordinates: .obj, .ply or .glb
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) choice: Choice,
    /// Size of the texture coordinates
    #[arg(long, value_enum, default_value_t = Scale::Unit)]
    pub(crate) scale: Scale,
    /// Write the triangles that were computed with in place of the input's polygons
    #[arg(long)]
    pub(crate) triangulate: bool,
    /// Write a report: .json
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    /// Write the cones and their curvatures, as --cones reads them
    #[arg(long, value_name = "FILE")]
    pub(crate) cones_out: Option<PathBuf>,
    /// Write the order of cones for every number of them, with what is predicted for each: .json
    #[arg(long, value_name = "FILE")]
    pub(crate) hierarchy: Option<PathBuf>,
    /// Draw the model with checkerboard, seams and cones: .png
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
    /// Draw the layout: .png or .svg
    #[arg(long, value_name = "FILE")]
    pub(crate) layout: Option<PathBuf>,
    /// Print the report as JSON in place of the text
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Extract {
    /// The surface: OBJ, OFF, PLY or STL, gzipped or not
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) choice: Choice,
    /// Write the cones and their curvatures, as --cones reads them
    #[arg(long, value_name = "FILE")]
    pub(crate) cones_out: Option<PathBuf>,
    /// Write the order of cones for every number of them, with what is predicted for each: .json
    #[arg(long, value_name = "FILE")]
    pub(crate) hierarchy: Option<PathBuf>,
    /// Print JSON in place of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Measure {
    /// A surface with texture coordinates: OBJ or PLY
    #[arg(value_name = "UV")]
    pub(crate) input: PathBuf,
    /// Measure against this surface, which has the same faces in the same order
    #[arg(long, value_name = "IN")]
    pub(crate) reference: Option<PathBuf>,
    /// Print JSON in place of the text
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Shape {
    /// Which shape
    #[arg(value_name = "NAME", value_parser = shape_name, long_help = shape_help())]
    pub(crate) name: String,
    /// About how many vertices
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = vertex_count)]
    pub(crate) vertices: usize,
    /// Where to write it: .obj
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
}

#[derive(Args, Debug)]
pub(crate) struct Demo {
    /// The folder to write
    #[arg(value_name = "FOLDER", default_value = "cones-demo")]
    pub(crate) folder: PathBuf,
    /// Print the reports as JSON in place of the table
    #[arg(long)]
    pub(crate) json: bool,
}

/// Which cones, and what curvatures they get.
#[derive(Args, Debug)]
pub(crate) struct Choice {
    /// How many cones [default: as few as keep the area distortion within 1.25, at most 32 a part]
    #[arg(short = 'n', value_name = "N", group = "which")]
    count: Option<usize>,
    /// As few cones as keep the area distortion within this
    #[arg(long, value_name = "D", group = "which", value_parser = distortion)]
    max_distortion: Option<f64>,
    /// All extrema of the conformal factor that are at least so persistent
    #[arg(long, value_name = "P", group = "which", value_parser = non_negative)]
    min_persistence: Option<f64>,
    /// Given cones: a file of lines `vertex curvature` or `vertex`, vertices counted from 0
    #[arg(long, value_name = "FILE", group = "which")]
    pub(crate) cones: Option<PathBuf>,
    /// How cones are chosen; `refined` and `pursuit` choose more than 64 by persistence
    #[arg(long, value_enum, default_value_t = MethodName::Refined)]
    method: MethodName,
    /// How curvature is shared among the cones
    #[arg(long, value_enum, default_value_t = AnglesName::Optimal)]
    angles: AnglesName,
    /// Diffuse the curvature before cones are looked for: steadier on noisy scans
    #[arg(long)]
    smooth: bool,
    /// Merge vertices that are at exactly the same place, as those along a seam of another unwrapping are
    #[arg(long)]
    weld: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Scale {
    /// From 0 to 1: the layout's longer side is 1
    Unit,
    /// Areas in the layout are areas on the surface
    Area,
    /// As computed
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MethodName {
    /// By persistence, whatever their kind
    Persistence,
    /// As in the paper: the most persistent maximum, minimum, maximum, …
    Alternating,
    /// Highest and lowest point of the conformal factor, again and again
    Iterative,
    /// Where the conformal factor is farthest from 0, again and again
    Greedy,
    /// The best set for this number of cones
    Refined,
    /// The best order, good for every number of cones
    Pursuit,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AnglesName {
    /// By least squares: the least variation of scale with these cones
    Optimal,
    /// As in the paper: no change of scale at the cones
    Harmonic,
}

impl Choice {
    /// The library's options.
    pub(crate) fn options(&self) -> Result<Options, Failure> {
        let cones = match (&self.cones, self.min_persistence, self.count) {
            (Some(file), _, _) => ConeChoice::Given(cone_file::read(file)?),
            (_, Some(persistence), _) => ConeChoice::MinPersistence(persistence),
            (_, _, Some(count)) => ConeChoice::Count(count),
            (None, None, None) => self.max_distortion.map_or(ConeChoice::Automatic, ConeChoice::WithinDistortion),
        };
        let method = match self.method {
            MethodName::Persistence => Method::Persistence,
            MethodName::Alternating => Method::Alternating,
            MethodName::Iterative => Method::Iterative,
            MethodName::Greedy => Method::Greedy,
            MethodName::Refined => Method::Refined,
            MethodName::Pursuit => Method::Pursuit,
        };
        let angles = match self.angles {
            AnglesName::Optimal => Angles::Optimal,
            AnglesName::Harmonic => Angles::Harmonic,
        };
        Ok(Options { cones, method, angles, smooth: self.smooth, order: false, weld: self.weld })
    }
}

/// A method's name, as the command line takes it and reports give it.
pub(crate) fn method_name(method: Method) -> &'static str {
    match method {
        Method::Persistence => "persistence",
        Method::Alternating => "alternating",
        Method::Iterative => "iterative",
        Method::Greedy => "greedy",
        Method::Refined => "refined",
        Method::Pursuit => "pursuit",
    }
}

/// A curvature rule's name, as the command line takes it and reports give it.
pub(crate) fn angles_name(angles: Angles) -> &'static str {
    match angles {
        Angles::Optimal => "optimal",
        Angles::Harmonic => "harmonic",
    }
}

fn shape_name(text: &str) -> Result<String, String> {
    // A shape of few vertices is made in no time, and tells whether the name is known.
    let known = geom::shapes::by_name(text, 1).is_some();
    if known { Ok(text.to_owned()) } else { Err(format!("known are {}", geom::shapes::NAMES.join(", "))) }
}

fn shape_help() -> String {
    format!("Which shape: {}, or torus-G of genus G", geom::shapes::NAMES.join(", "))
}

pub(crate) fn vertex_count(text: &str) -> Result<usize, String> {
    let most = geom::shapes::MAX_VERTICES;
    text.parse().ok().filter(|n| (1..=most).contains(n)).ok_or_else(|| format!("not a number from 1 to {most}"))
}

pub(crate) fn non_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x >= 0.0 && x.is_finite() => Ok(x),
        _ => Err("not a number of at least 0".into()),
    }
}

fn distortion(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(d) if d > 1.0 && d.is_finite() => Ok(d),
        _ => Err("not a number above 1, which is no distortion".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn one_way_of_choosing_cones_at_a_time() {
        let parse = |more: &[&str]| Arguments::try_parse_from([&["cones", "unwrap", "a", "-o", "b"], more].concat());
        assert!(parse(&["-n", "8"]).is_ok());
        assert!(parse(&["-n", "8", "--min-persistence", "0.1"]).is_err());
        assert!(parse(&["--min-persistence", "-1"]).is_err());
    }

    #[test]
    fn what_is_not_built_is_not_accepted() {
        for option in ["--islands=pack", "--udim", "--threads=0"] {
            assert!(Arguments::try_parse_from(["cones", "unwrap", "a", "-o", "b", option]).is_err(), "{option}");
        }
    }
}
