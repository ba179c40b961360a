//! What may be asked of `cones persistence`.

use crate::commands::shared::{non_negative, whole};
use crate::input::{Axes, Layer, Source};
use clap::{Args, ValueEnum};
use std::path::Path;
use std::path::PathBuf;
use topo::{Connectivity, Kind, NanPolicy, PersistenceOptions};

/// A field and what it lives on.
#[derive(Args, Clone, Debug)]
pub(crate) struct FieldArgs {
    /// An array or picture (.npy, .npz, .vti, .pgm, .png, whose colours become grey; .tif, such as an elevation model; .txt, .csv or .tsv of
    /// numbers), a mesh with --field, or a network's nodes (.csv with columns id, name, value); - is standard input: a .npy, or a mesh
    #[arg(value_name = "FIELD")]
    pub(crate) input: PathBuf,
    /// The values on a mesh: phi, curvature, mean-curvature, height[:x|y|z], distance[:VERTEX], a file .npy or .txt, or numbers that the file has at its vertices, such as a
    /// PLY's quality
    #[arg(long, value_name = "VALUES", value_parser = Source::parse)]
    pub(crate) field: Option<Source>,
    /// A network's edges (.csv with columns a, b) [default: X.edges.csv beside X.nodes.csv]
    #[arg(long, value_name = "FILE")]
    pub(crate) edges: Option<PathBuf>,
    /// Which values of an array are neighbours [default: freudenthal]
    #[arg(long, value_enum)]
    pub(crate) connectivity: Option<ConnectivityName>,
    /// Axes of an array whose ends are neighbours, such as `x` for longitudes or `x,y`
    #[arg(long, value_name = "AXES", value_parser = Axes::parse)]
    pub(crate) periodic: Option<Axes>,
    /// Of an array of three axes, the last with 3 or 4 values: one of these, from 0, or `volume` for all as they are
    #[arg(long, value_name = "N|volume", value_parser = Layer::parse)]
    pub(crate) layer: Option<Layer>,
    /// Which array of a file that has several (.npz, .vti), by its name
    #[arg(long, value_name = "NAME")]
    pub(crate) array: Option<String>,
    /// What to do with NaN, and with values that a file calls no data
    #[arg(long, value_enum, default_value_t = NanName::Refuse)]
    pub(crate) nan: NanName,
}

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct PersistenceArgs {
    #[command(flatten)]
    pub(crate) of: FieldArgs,
    /// Whether to pair minima, maxima or both
    #[arg(long, value_enum, default_value_t = DirectionName::Both)]
    pub(crate) direction: DirectionName,
    /// Leave out pairs that are no more persistent than this
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = non_negative, allow_negative_numbers = true)]
    pub(crate) min_persistence: f64,
    /// Keep the pairs of zero persistence, as plateaus and ties bring them
    #[arg(long, conflicts_with = "min_persistence")]
    pub(crate) keep_zero: bool,
    /// Draw a picture's extrema over it, minima blue and maxima red: .png
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
    /// Only the K most persistent pairs of each direction [default: 10 in the table, 50 in the picture]
    #[arg(long, value_name = "K", value_parser = whole::<usize>("number of pairs", 0..), allow_negative_numbers = true)]
    pub(crate) top: Option<usize>,
    /// Write the pairs: .csv, .json, or .vtp (extrema and saddles as points, pairs as lines)
    #[arg(long, value_name = "FILE")]
    pub(crate) pairs: Option<PathBuf>,
    /// Draw the persistence diagram: .svg
    #[arg(long, value_name = "FILE")]
    pub(crate) diagram: Option<PathBuf>,
    /// Draw the longest pairs as bars: .svg
    #[arg(long, value_name = "FILE")]
    pub(crate) barcode: Option<PathBuf>,
    /// How many bars of each direction are drawn
    #[arg(long, value_name = "N", value_parser = whole::<usize>("number of bars", 0..), allow_negative_numbers = true, default_value_t = 120, requires = "barcode")]
    pub(crate) bars: usize,
    /// Write the extremum that each vertex descends or climbs to, of those above --min-persistence: .npy, .ply (mesh) or
    /// .png (picture, shaded by the field); needs --direction sub or super
    #[arg(long, value_name = "FILE")]
    pub(crate) segmentation: Option<PathBuf>,
    /// Write a page to see in a browser: the field, its segments at every level, merge tree, diagram and barcode: .html
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    /// Print JSON in place of the table
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  cones persistence height.npy --direction super --report peaks.html
  cones persistence scan.ply --field curvature --pairs pairs.csv
  cones persistence net.nodes.csv --edges net.edges.csv";

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ConnectivityName {
    /// Along one axis: 4 in a picture, 6 in a volume
    Axis,
    /// Along any number of axes: 8 in a picture, 26 in a volume
    Full,
    /// Edges of the Freudenthal triangulation, 6 in a picture, 14 in a volume: for sampled smooth functions
    Freudenthal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DirectionName {
    /// Sublevel sets: minima
    Sub,
    /// Superlevel sets: maxima
    Super,
    /// Both
    Both,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum NanName {
    /// Stop and name the first
    Refuse,
    /// Leave such vertices out of the domain
    Mask,
}

impl ConnectivityName {
    pub(super) fn connectivity(self) -> Connectivity {
        match self {
            Self::Axis => Connectivity::Axis,
            Self::Full => Connectivity::Full,
            Self::Freudenthal => Connectivity::Freudenthal,
        }
    }
}

impl FieldArgs {
    /// The library's options for the field.
    pub(crate) fn options(&self) -> PersistenceOptions {
        // A computed field is NaN where a mesh has no surface, which is no mistake of anyone's.
        let has_gaps = self.field.as_ref().is_some_and(Source::is_computed);
        PersistenceOptions::new().nan(if has_gaps { NanPolicy::Mask } else { self.nan.policy() })
    }

    /// An option that is there, if any is: what is no field has none.
    pub(crate) fn first_given(&self) -> Option<&'static str> {
        let given = [
            (self.field.is_some(), "--field"),
            (self.edges.is_some(), "--edges"),
            (self.connectivity.is_some(), "--connectivity"),
            (self.periodic.is_some(), "--periodic"),
            (self.layer.is_some(), "--layer"),
            (self.array.is_some(), "--array"),
            (self.nan != NanName::Refuse, "--nan"),
        ];
        given.into_iter().find_map(|(is_given, option)| is_given.then_some(option))
    }

    /// The files that are read.
    pub(crate) fn files(&self) -> Vec<&Path> {
        let files = [Some(self.input.as_path()), self.edges.as_deref(), self.field.as_ref().and_then(Source::file)];
        files.into_iter().flatten().collect()
    }
}

impl DirectionName {
    /// The kinds of extrema that are paired.
    pub(crate) fn kinds(self) -> &'static [Kind] {
        match self {
            Self::Sub => &[Kind::Minimum],
            Self::Super => &[Kind::Maximum],
            Self::Both => &[Kind::Minimum, Kind::Maximum],
        }
    }
}

impl NanName {
    pub(crate) fn policy(self) -> NanPolicy {
        match self {
            Self::Refuse => NanPolicy::Refuse,
            Self::Mask => NanPolicy::Mask,
        }
    }
}
