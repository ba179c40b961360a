//! What may be asked of `cones persistence`.

use crate::commands::shared::non_negative;
use crate::input::{Axes, Source};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use topo::{Connectivity, Kind, NanPolicy};

#[derive(Args, Debug)]
pub(crate) struct PersistenceArgs {
    /// An array or picture (.npy, .pgm, .png, whose colours become grey; .txt, a number a line), a mesh with --field, or a
    /// network's nodes (.csv with columns id, name, value)
    #[arg(value_name = "FIELD")]
    pub(crate) input: PathBuf,
    /// The values on a mesh: phi, curvature, mean-curvature, height[:x|y|z], distance[:VERTEX], or a file .npy or .txt
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
    /// Whether to pair minima, maxima or both
    #[arg(long, value_enum, default_value_t = DirectionName::Both)]
    pub(crate) direction: DirectionName,
    /// Leave out pairs that are no more persistent than this
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = non_negative, allow_negative_numbers = true)]
    pub(crate) min_persistence: f64,
    /// Keep the pairs of zero persistence, as plateaus and ties bring them
    #[arg(long, conflicts_with = "min_persistence")]
    pub(crate) keep_zero: bool,
    /// What to do with NaN
    #[arg(long, value_enum, default_value_t = NanName::Refuse)]
    pub(crate) nan: NanName,
    /// Only the K most persistent pairs of each direction [default for the table: 10]
    #[arg(long, value_name = "K")]
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
    /// Write the extremum that each vertex descends or climbs to, of those above --min-persistence: .npy, .ply (mesh) or
    /// .png (picture); needs --direction sub or super
    #[arg(long, value_name = "FILE")]
    pub(crate) segmentation: Option<PathBuf>,
    /// Write a page to see in a browser: the field, its segments at every level, merge tree, diagram and barcode: .html
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    /// Print JSON in place of the table
    #[arg(long)]
    pub(crate) json: bool,
}

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

impl DirectionName {
    /// The kinds of extrema that are paired.
    pub(super) fn kinds(self) -> &'static [Kind] {
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
