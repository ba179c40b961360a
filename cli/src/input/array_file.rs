//! Files of arrays: which reader takes which.

use super::array::Array;
use super::error::{Problem, ReadError};
use super::{ending, grey, npy, npz, pgm, table, tiff, vti};
use std::path::Path;

/// Reads an array, a picture or a table of numbers; of a file of several arrays the one of a name.
pub(crate) fn read_array(path: &Path, name: Option<&str>) -> Result<Array, ReadError> {
    match ending(path).as_str() {
        "npz" => npz::read(path, name),
        "vti" => vti::read(path, name),
        _ if name.is_some() => Err(Problem::Unnamed.in_file(path)),
        "pgm" => pgm::read(path),
        "png" => grey::read(path),
        "txt" | "csv" | "tsv" => table::read(path),
        "tif" | "tiff" => tiff::read(path),
        _ => npy::read(path),
    }
}
