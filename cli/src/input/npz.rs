//! `NumPy`'s archives of arrays, as `savez` and `savez_compressed` write them: ZIP files of `.npy` files, by the crate `zip`.
//!
//! An archive may expand as a picture may, and no more: a few kilobytes that would take gigabytes are refused by what the array's header says.

use super::array::Array;
use super::error::{Problem, ReadError};
use super::npy;
use std::borrow::Cow;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use zip::ZipArchive;

/// Reads the array of a name, or the only one.
pub(super) fn read(path: &Path, name: Option<&str>) -> Result<Array, ReadError> {
    of_archive(path, name).map_err(|problem| problem.in_file(path))
}

fn of_archive(path: &Path, name: Option<&str>) -> Result<Array, Problem> {
    let file = File::open(path)?;
    let compressed = file.metadata()?.len();
    let mut archive = ZipArchive::new(BufReader::new(file))?;
    let array = |name: Cow<'_, str>| name.strip_suffix(".npy").map(str::to_owned);
    let arrays = archive.file_names().filter_map(|name| array(name.ok()?)).collect();
    let mut member = archive.by_name(&format!("{}.npy", chosen(arrays, name)?))?;
    let length = member.size();
    npy::read_compressed(&mut member, compressed, length)
}

/// The array of a name, or the only one, in whatever order they are.
pub(super) fn chosen(mut arrays: Vec<String>, name: Option<&str>) -> Result<String, Problem> {
    arrays.sort_unstable();
    match name {
        _ if arrays.is_empty() => Err(Problem::Empty),
        Some(name) if arrays.iter().any(|array| array == name) => Ok(name.to_owned()),
        Some(name) => Err(Problem::NoArray { name: name.to_owned(), arrays }),
        None if arrays.len() > 1 => Err(Problem::Choose(arrays)),
        None => Ok(arrays.remove(0)),
    }
}
