//! Files of arrays: which reader takes which.

use super::array::Array;
use super::error::ReadError;
use super::{ending, grey, npy, pgm, table, tiff};
use std::path::Path;

/// Reads an array, a picture or a table of numbers.
pub(crate) fn read_array(path: &Path) -> Result<Array, ReadError> {
    match ending(path).as_str() {
        "pgm" => pgm::read(path),
        "png" => grey::read(path),
        "txt" | "csv" | "tsv" => table::read(path),
        "tif" | "tiff" => tiff::read(path),
        _ => npy::read(path),
    }
}
