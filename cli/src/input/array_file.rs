//! Files of arrays: which reader takes which.

use super::array::Array;
use super::error::ReadError;
use super::{decimal, ending, grey, npy, pgm};
use std::path::Path;

/// Reads an array, a picture or a column of numbers.
pub(crate) fn read_array(path: &Path) -> Result<Array, ReadError> {
    match ending(path).as_str() {
        "pgm" => pgm::read(path),
        "png" => grey::read(path),
        "txt" => {
            let values = decimal::read(path)?;
            Ok(Array { shape: vec![values.len()], values })
        }
        _ => npy::read(path),
    }
}
