//! Why the command could not do it: each a sentence with what to do.

use crate::input::{gaps, told};
use cones::uv::PackError;
use geom::counted;
use geom::distortion::DistortionError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

#[derive(Debug, Error)]
pub(crate) enum CommandError {
    #[error(transparent)]
    Read(#[from] geom::io::ReadError),
    #[error("{}: {error}{}", told(path), if let cones::Error::Pack(error) = error { options(error) } else { "" })]
    Unwrap { path: PathBuf, error: cones::Error },
    #[error(
        "{} has {vertices} vertices, which need more than {} MB of memory where {} MB are allowed: raise the limit (ulimit -v) \
         or take a coarser mesh",
        told(path),
        needed / 1_000_000,
        allowed / 1_000_000
    )]
    Memory { path: PathBuf, vertices: usize, needed: u64, allowed: u64 },
    #[error("{} has no texture coordinates: unwrap it first, or name the unwrapped file", told(.0))]
    NoTexture(PathBuf),
    #[error(
        "{} has no finite texture coordinate at {lacking} of {corners} corners, the first at vertex {vertex} of face {face} (counted from 0): \
         complete the map, or unwrap the surface anew",
        told(path)
    )]
    PartlyNoTexture { path: PathBuf, lacking: usize, corners: usize, vertex: u32, face: usize },
    #[error("{} and {} do not have the same faces in the same order: name the mesh that was unwrapped", told(.0), told(.1))]
    OtherMesh(PathBuf, PathBuf),
    #[error(
        "face {face} (counted from 0) of {} is {:.2} % of the surface's size away from {}: it is to be the same surface, or name how far it may be \
         (--max-distance)",
        told(new),
        100.0 * share,
        told(old)
    )]
    BakePlaces { old: PathBuf, new: PathBuf, face: u32, share: f64 },
    #[error("{} has no face with an area, of which anything could be transferred", told(.0))]
    BakeNoArea(PathBuf),
    #[error(
        "{} has no textures: its faces show none, or its material library is not there; name the model whose textures are to be transferred",
        told(.0)
    )]
    NoTextures(PathBuf),
    #[error(
        "{}: what {name} shows is not known, as the file that tells it cannot be read: put it where {} names it",
        told(path),
        told(path)
    )]
    UnknownPicture { path: PathBuf, name: String },
    #[error(
        "the picture {name} is in the glTF that came through standard input, where pictures are not read from: name the file"
    )]
    PictureInPipe { name: String },
    #[error(
        "{}: the texture {name} is moved or scaled by its material, or placed by other coordinates than the first ones, which is not read: apply \
         that to the texture coordinates",
        told(path)
    )]
    MovedTexture { path: PathBuf, name: String },
    #[error(
        "{} has the texture coordinate {u} {v} at face {face} (counted from 0), which is not in the unit square: one picture is for that, so pack the map \
         without --udim and --scale",
        told(path)
    )]
    OutsideSquare { path: PathBuf, face: usize, u: f64, v: f64 },
    #[error("{}: {error}", told(path))]
    Measure { path: PathBuf, error: DistortionError },
    #[error("{}: {error}{}", told(path), options(error))]
    Pack { path: PathBuf, error: PackError },
    #[error("{} is the input, which is never overwritten: name another file", .0.display())]
    OutputIsInput(PathBuf),
    #[error("{} is named for two outputs: give each its own file", .0.display())]
    OutputTwice(PathBuf),
    #[error("{} is where --checker writes its board beside the OBJ: name another file", .0.display())]
    CheckerTaken(PathBuf),
    #[error("{} is named twice: name each surface once", .0.display())]
    InputTwice(PathBuf),
    #[error("{} is a folder: name a file in it", .0.display())]
    OutputIsFolder(PathBuf),
    #[error("{} is a folder: name a file in it, or write --out-dir in place of -o", .0.display())]
    OutputIsOutDir(PathBuf),
    #[error("there is no folder {} to write {} into: make it first", folder.display(), path.display())]
    NoFolder { folder: PathBuf, path: PathBuf },
    #[error("{} cannot be written here with this ending: end it in {wanted}", path.display())]
    Extension { path: PathBuf, wanted: String },
    #[error("{} holds other files than a demo's: name a new folder", .0.display())]
    NotADemo(PathBuf),
    #[error("{} cannot be written", path.display())]
    WriteFile { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Write(#[from] geom::io::WriteError),
    #[error("there is no subcommand {0}: cones --help lists them")]
    NoSubcommand(String),
    #[error("the folder {} cannot be made", path.display())]
    MakeFolder { path: PathBuf, source: io::Error },
    #[error(transparent)]
    ConeFile(#[from] crate::input::ConeFileError),
    #[error(transparent)]
    EdgeFile(#[from] crate::input::EdgeFileError),
    #[error(transparent)]
    Field(#[from] crate::input::ReadError),
    #[error("{} is a mesh without values: name a field with --field, such as --field phi", told(.0))]
    NoField(PathBuf),
    #[error("{} has nodes without edges: name the file of edges with --edges", .0.display())]
    NoEdges(PathBuf),
    #[error("{} has no texture coordinates whose seams --keep-seams could keep: leave it out", told(.0))]
    NoSeamsToKeep(PathBuf),
    #[error("{option} is for {of}, which {} is not: leave it out", path.display())]
    Misplaced { path: PathBuf, option: &'static str, of: &'static str },
    #[error("{} has no axis {axis}, only {axes}: x is the last, y the one before", told(path))]
    NoAxis { path: PathBuf, axis: &'static str, axes: usize },
    #[error(
        "{}: the value of vertex {vertex} is NaN{}: replace it, or leave such vertices out with --nan mask",
        told(path),
        gaps(path)
    )]
    NotANumber { path: PathBuf, vertex: usize },
    #[error("{}: {error}", told(path))]
    Domain { path: PathBuf, error: topo::Error },
    #[error("{}: {error}", told(path))]
    Persistence { path: PathBuf, error: topo::Error },
    #[error("{} cannot be written, as a network's nodes are nowhere in space: write .csv or .json", .0.display())]
    NoPlaces(PathBuf),
    #[error("{} can be written for {of} only: end it in .npy", path.display())]
    SegmentsAs { path: PathBuf, of: &'static str },
    #[error("{} can be drawn over a picture only: leave --picture out, or give an array of two axes", .0.display())]
    NoPicture(PathBuf),
    #[error("{} needs to know whose segments are meant: add --direction sub for minima or --direction super for maxima", .0.display())]
    WhichSegments(PathBuf),
    #[error("{} has none of the paper's models: name the folder that holds table1/ and table1_resized/", .0.display())]
    NoPaperMeshes(PathBuf),
    #[error("{failed} of {} could not be unwrapped: see the errors above", counted(*count, "surface", "surfaces"))]
    SomeFailed { failed: usize, count: usize },
    #[error("{failed} of {} could not be compared: see the errors above", counted(*count, "surface", "surfaces"))]
    SomeNotCompared { failed: usize, count: usize },
    #[error("{}: the program has a fault, and stopped on this surface", told(.0))]
    Fault(PathBuf),
    #[error("port {port} of this machine cannot be listened at: name another with --port, or none")]
    Listen { port: u16, source: io::Error },
    #[error("a thread to answer the browser with cannot be started")]
    Threads(#[source] io::Error),
    #[error("the system has no random number for the page's address")]
    Random,
    #[error("standard output cannot be written")]
    Stdout(#[source] io::Error),
}

/// The options that mend why islands cannot be packed, behind the sentence that says it.
pub(crate) fn options(error: &PackError) -> &'static str {
    match error {
        PackError::TooLarge { .. } | PackError::TooManyTiles(_) => " (--texel-density)",
        PackError::Margin { .. } => " (--margin, --texture-size)",
        _ => "",
    }
}

impl CommandError {
    /// Whether the reader of standard output left, as `head` does: no fault of anyone's.
    pub(crate) fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Stdout(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}
