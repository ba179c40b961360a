//! What can be wrong with a file, and where.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::MOST_EXPANSION;
use crate::counted::{are, counted};
use crate::surface::ModelError;

/// Why a file could not be read: one sentence with the path, the line or byte, what was found and what was expected.
///
/// ```
/// let error = geom::io::read_bytes(b"v 0 0 0\nv 1 0\n".to_vec(), "corner.obj").unwrap_err();
/// assert_eq!(error.to_string(), "corner.obj, line 2: found the end of the line, expected the z coordinate");
/// ```
#[derive(Debug)]
pub struct ReadError {
    path: PathBuf,
    place: Place,
    problem: Problem,
}

impl ReadError {
    /// The file, as it was named.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where in the file the problem is.
    pub fn place(&self) -> Place {
        self.place
    }

    /// What the problem is.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}: {}", self.path.display(), self.place, self.problem)
    }
}

impl Error for ReadError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.problem.source()
    }
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of text, counted from 1.
    Line(u64),
    /// A byte of binary data, counted from 0.
    Byte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Byte(byte) => write!(f, ", byte {byte}"),
        }
    }
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// There is no file of that name.
    #[error("there is no such file")]
    Missing,
    /// The path leads to a directory.
    #[error("this is a directory, give a mesh file")]
    Directory,
    /// Another file names what is a pipe or a device.
    #[error("this is a pipe or a device, give a file")]
    NoFile,
    /// The system refuses.
    #[error("the file cannot be read")]
    Io(#[source] io::Error),
    /// Damaged compression.
    #[error("the gzip data are damaged or cut short")]
    Gzip(#[source] io::Error),
    /// Compressed data that become far more than a mesh would.
    #[error(
        "its {compressed} bytes of gzip data expand more than {MOST_EXPANSION} times, as no mesh does that is not made to \
         fill the memory: if this one is to be read, decompress it first"
    )]
    Expansion {
        /// How many bytes there are compressed.
        compressed: usize,
    },
    /// No bytes at all.
    #[error("the file is empty")]
    Empty,
    /// Nothing tells the format.
    #[error("neither the content nor the extension is that of an OBJ, PLY, OFF, STL or glTF file")]
    UnknownFormat,
    /// Something else than the format allows.
    #[error("found {found}, expected {expected}")]
    Unexpected {
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// The header promises more than there is.
    #[error("the header claims {claimed} {what}, but the file ends after {present}: it is cut short or damaged")]
    CutShort {
        /// What is counted.
        what: String,
        /// The number in the header.
        claimed: u64,
        /// How many are there in full.
        present: u64,
    },
    /// The content is no surface.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// A problem and its place, in a file whose name the reader of one format does not know.
#[derive(Debug)]
pub(super) struct Fault {
    place: Place,
    problem: Problem,
}

impl Fault {
    pub(super) fn new(place: Place, problem: Problem) -> Self {
        Self { place, problem }
    }

    pub(super) fn unexpected(place: Place, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::new(place, Problem::Unexpected { found: found.into(), expected: expected.into() })
    }

    /// The end of the file where something should still come.
    pub(super) fn cut_short(place: Place, expected: impl fmt::Display) -> Self {
        Self::unexpected(place, "the end of the file", format!("{expected}: it seems to be cut short"))
    }

    /// A face that encloses nothing.
    pub(super) fn few_corners(place: Place, corners: usize) -> Self {
        Self::unexpected(place, format!("a face with {}", counted(corners, "corner", "corners")), "at least 3")
    }

    /// The same in a text where so many lines come before.
    pub(super) fn after_lines(self, lines: u64) -> Self {
        match self.place {
            Place::Line(line) => Self { place: Place::Line(lines + line), ..self },
            _ => self,
        }
    }

    pub(super) fn in_file(self, path: &Path) -> ReadError {
        ReadError { path: path.to_owned(), place: self.place, problem: self.problem }
    }
}

impl From<ModelError> for Fault {
    fn from(error: ModelError) -> Self {
        Self::new(Place::File, error.into())
    }
}

impl From<Problem> for Fault {
    fn from(problem: Problem) -> Self {
        Self::new(Place::File, problem)
    }
}

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refuses: no permission, disk full.
    #[error("the output cannot be written")]
    Io(#[from] io::Error),
    /// Texture coordinates that belong to another model.
    #[error("there {}, but the model has {corners} corners", are(*found, "texture coordinate", "texture coordinates"))]
    TextureCount {
        /// How many there are.
        found: usize,
        /// How many there should be.
        corners: usize,
    },
    /// A texture coordinate is infinite or NaN.
    #[error("the texture coordinate of corner {corner} is not finite")]
    NotFinite {
        /// The corner.
        corner: usize,
    },
    /// Triangles that belong to another model.
    #[error("triangle {triangle} is not made of corners of its face, or its face comes before that of the last one")]
    ForeignTriangle {
        /// The triangle.
        triangle: usize,
    },
    /// More than the format's 32-bit sizes can say.
    #[error("the model is too large for this format: {bytes} bytes")]
    TooLarge {
        /// How large the file would be.
        bytes: u64,
    },
}
