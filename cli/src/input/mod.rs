//! What is read: models, files of cones, and scalar fields with what they live on: arrays, pictures, meshes and networks.
//!
//! A file is known by its ending. Every message names the file and the line, byte or vertex. Memory is asked for as data
//! comes in, never because a header claims it, and a field that cannot be worked on in the memory that is free is refused
//! with the size it needs.

mod array;
mod array_file;
mod computed;
pub(crate) mod cone_file;
mod decimal;
mod edge_file;
mod error;
mod grey;
mod memory;
mod network;
mod npy;
mod npz;
mod pgm;
mod source;
mod stored;
mod table;
mod texels;
mod tiff;
mod values;
mod vti;
mod vtk_blocks;

pub(crate) use array::{Array, Axes, Layer};
pub(crate) use array_file::read_array;
pub(crate) use cone_file::{ConeFile, ConeFileError};
pub(crate) use edge_file::{EdgeFile, EdgeFileError};
pub(crate) use error::{Problem, ReadError};
pub(crate) use network::{Network, edges_beside};
pub(crate) use npy::{write_labels, write_values};
pub(crate) use source::Source;
pub(crate) use table::heading;
pub(crate) use texels::Texels;
pub(crate) use values::{FieldScalar, Number, Values, each, significant, six_digits};

use geom::Model;
use std::path::Path;
use std::time::Instant;

/// What stands for standard input.
const STANDARD: &str = "-";

/// Whether a path stands for standard input.
pub(crate) fn is_standard(path: &Path) -> bool {
    path == Path::new(STANDARD)
}

/// An input as it is called in messages.
pub(crate) fn told(path: &Path) -> std::path::Display<'_> {
    if is_standard(path) { Path::new("standard input") } else { path }.display()
}

/// Reads a model, from standard input where the path is `-`, and how many seconds that took.
pub(crate) fn read_model(path: &Path) -> Result<(Model, f64), geom::io::ReadError> {
    let start = Instant::now();
    let model = if is_standard(path) {
        geom::io::read_stream(std::io::stdin().lock(), told(path).to_string())?
    } else {
        geom::io::read(path)?
    };
    Ok((model, start.elapsed().as_secs_f64()))
}

/// Refuses a square picture of so many pixels on a side, each of which takes so many bytes, that does not fit into the memory; `path` is where it is to be.
pub(crate) fn check_memory(side: usize, bytes_per_pixel: usize, path: &Path) -> Result<(), ReadError> {
    memory::check_picture(side as u64 * side as u64, bytes_per_pixel).map_err(|problem| problem.in_file(path))
}

/// What NaN may stand for in a file, by its ending: for what readers put it.
pub(crate) fn gaps(path: &Path) -> &'static str {
    match ending(path).as_str() {
        "tif" | "tiff" => " or the file's no-data value",
        "csv" | "tsv" | "txt" => " or missing",
        _ => "",
    }
}

/// The endings of arrays, but for `csv`, which networks have too.
const ARRAYS: [&str; 9] = ["npy", "npz", "vti", "pgm", "png", "txt", "tsv", "tif", "tiff"];

/// What a file holds, by its ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Array,
    Network,
    Mesh,
}

impl Form {
    /// The form of the file at a path.
    pub(crate) fn of(path: &Path) -> Result<Self, ReadError> {
        match ending(path).as_str() {
            _ if path.is_dir() => Err(Problem::Directory.in_file(path)),
            ending if ARRAYS.contains(&ending) => Ok(Self::Array),
            "csv" if table::is_of_nodes(path) => Ok(Self::Network),
            "csv" => Ok(Self::Array),
            "obj" | "ply" | "off" | "stl" | "glb" | "gltf" => Ok(Self::Mesh),
            "gz" => match ending(&path.with_extension("")).as_str() {
                "npy" => Ok(Self::Array),
                ending if ending == "csv" || ARRAYS.contains(&ending) => Err(Problem::Gzipped.in_file(path)),
                // Of a mesh the content tells.
                _ => Ok(Self::Mesh),
            },
            _ => Err(Problem::Form.in_file(path)),
        }
    }
}

/// A file name's ending in lower case.
fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or("").to_lowercase()
}
