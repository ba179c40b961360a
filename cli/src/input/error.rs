//! Why a field cannot be read.

use super::told;
use geom::counted;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A file that does not hold a field, and where it shows.
#[derive(Debug, Error)]
#[error("{}{place}: {problem}", told(path))]
pub(crate) struct ReadError {
    path: PathBuf,
    place: FilePosition,
    problem: Problem,
}

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FilePosition {
    File,
    /// Counted from 1.
    Line(u64),
    /// Counted from 0.
    Byte(u64),
}

/// Why a file cannot be opened or read.
pub(super) fn unreadable(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        _ => format!("cannot be read ({error})"),
    }
}

/// What is wrong, and what to do.
#[derive(Debug, Error)]
pub(crate) enum Problem {
    #[error("{}", unreadable(.0))]
    Io(#[from] io::Error),
    #[error(
        "is of no known form: give an array (.npy, .npz, .vti, .pgm, .png, .tif, .txt, .csv), a mesh (.obj, .ply, .off, .stl) or a network (.csv)"
    )]
    Form,
    #[error("this is a directory, give a file")]
    Directory,
    #[error("is gzipped, as meshes and .npy may be and this may not: unpack it first")]
    Gzipped,
    #[error("there is {found} where {expected} should be")]
    Unexpected { found: String, expected: String },
    #[error("the header claims {claimed} value{}, but the file ends after {present}: it is cut short or damaged", if *claimed == 1 { "" } else { "s" })]
    CutShort { claimed: u64, present: u64 },
    #[error("has {0} axes, and one to three are read: take a part of it or reshape it")]
    Axes(usize),
    #[error("the shape {0:?} has more values than can be counted")]
    Shape(Vec<u64>),
    #[error("the values are of type {0:?}, which is not a real number: convert them, as with .astype('float64')")]
    Type(String),
    #[error(
        "has {vertices} values, which need {} of memory where {} are free: take a part of it or every other value",
        bytes(*needed),
        bytes(*free)
    )]
    Memory { vertices: u64, needed: u64, free: u64 },
    #[error("has so many pixels that {} of memory are needed where {} are free: make it smaller", bytes(*needed), bytes(*free))]
    PictureMemory { needed: u64, free: u64 },
    #[error("has {0} values, and 2147483646 are the most that can be numbered: take a part of it or every other value")]
    TooMany(u64),
    #[error(
        "claims {pixels} pixels in {length} bytes, which is more than a picture of anything: if it is one, save it as .npy or .pgm"
    )]
    Expansion { pixels: u64, length: u64 },
    #[error("is no PNG picture that can be read ({0})")]
    Png(#[from] png::DecodingError),
    #[error("is no JPEG picture that can be read ({0}): save it anew, or as PNG")]
    Jpeg(String),
    #[error("is neither a PNG nor a JPEG picture: save it as one of these")]
    Picture,
    #[error("has {width} × {height} pixels, and a texture has at most {most} on a side: save it smaller")]
    TextureSize { width: usize, height: usize, most: usize },
    #[error("{0}")]
    Csv(String),
    #[error("there is no column named {name}: the first line must name the columns {wanted}")]
    Column { name: &'static str, wanted: &'static str },
    #[error("the id {0:?} was there before: give each node its own")]
    Twice(String),
    #[error("no node has the id {0:?}: every edge joins two ids of the file of nodes")]
    NoNode(String),
    #[error("has {} where the mesh has {}: it needs one for each, in the mesh's order", counted(*values, "value", "values"), counted(*vertices, "vertex", "vertices"))]
    Count { values: usize, vertices: usize },
    #[error(
        "has no numbers called {name} at its vertices{}: name them, or phi, curvature, mean-curvature, height, distance, or a file .npy or .txt",
        named(there)
    )]
    NoAttribute { name: String, there: Vec<String> },
    #[error("has no vertex {vertex}: it has {vertices}, counted from 0")]
    NoVertex { vertex: usize, vertices: usize },
    #[error(
        "is an array of {0:?}, which may be a picture in colour or a volume: add --layer 0 for the first of its {last}, or --layer volume",
        last = .0.last().copied().unwrap_or(0)
    )]
    Colours(Vec<usize>),
    #[error("is an array of {0:?}, and --layer is for one of three axes, the last with 3 or 4 values: leave it out")]
    NoColours(Vec<usize>),
    #[error("has no layer {layer}: its last axis has {layers}, counted from 0")]
    NoLayer { layer: usize, layers: usize },
    #[error("is no TIFF picture that can be read ({0})")]
    Tiff(#[from] ::tiff::TiffError),
    #[error("has {0} values at each place, and one is read: save one of them by itself")]
    Samples(usize),
    #[error("has a bit depth of {0}, and 8 to 64 are read: save it as a picture in grey with 8")]
    Bits(u8),
    #[error(
        "says that zero stands for white, which is read of whole numbers without a sign only: save it so that zero stands for black"
    )]
    WhiteIsZero,
    #[error("has a page {page} of another size or another type of numbers than the first: save it by itself")]
    Pages { page: usize },
    #[error("is empty, with numbers below: each line is a place, so write NaN, or take the line out")]
    BlankLine,
    #[error("holds no values")]
    Empty,
    #[error("is no ZIP archive that can be read ({0})")]
    Zip(#[from] zip::result::ZipError),
    #[error("is no VTK image that can be read ({0})")]
    Vti(String),
    #[error("has the arrays {}: name one of them with --array", .0.join(", "))]
    Choose(Vec<String>),
    #[error("has no array {name:?}: it has {}", arrays.join(", "))]
    NoArray { name: String, arrays: Vec<String> },
    #[error("has one array, and that has no name: leave out --array")]
    Unnamed,
}

/// A problem and where it is, before the file is known.
pub(super) type Fault = (FilePosition, Problem);

impl Problem {
    pub(crate) fn in_file(self, path: &Path) -> ReadError {
        self.at(FilePosition::File, path)
    }

    pub(crate) fn at(self, place: FilePosition, path: &Path) -> ReadError {
        ReadError { path: path.to_owned(), place, problem: self }
    }

    pub(crate) fn unexpected(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Unexpected { found: found.into(), expected: expected.into() }
    }
}

impl fmt::Display for FilePosition {
    /// Between the file's name and the colon.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Byte(byte) => write!(f, ", byte {byte}"),
        }
    }
}

/// What else there is, as a part of a sentence.
fn named(there: &[String]) -> String {
    if there.is_empty() { String::new() } else { format!(", only {}", there.join(", ")) }
}

/// A number of bytes as people say it.
fn bytes(count: u64) -> String {
    let units = ["bytes", "kB", "MB", "GB", "TB", "PB", "EB"];
    let step = (0..units.len()).rev().find(|&i| count >= 1000u64.pow(i as u32)).unwrap_or(0);
    match step {
        0 => format!("{count} bytes"),
        _ => format!("{:.1} {}", count as f64 / 1000f64.powi(step as i32), units[step]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_told_in_round_units() {
        assert_eq!([0, 999, 1500, 7_200_000_000].map(bytes), ["0 bytes", "999 bytes", "1.5 kB", "7.2 GB"]);
        assert_eq!(bytes(u64::MAX), "18.4 EB");
    }
}
