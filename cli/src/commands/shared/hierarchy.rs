//! The file of the cone hierarchy, for the commands that write one.

use crate::error::CommandError;
use crate::output::{self, Files};
use crate::report::{HierarchyFile, hierarchy_rows};
use cones::ConeOrder;
use std::path::Path;

/// The endings that it may have.
pub(crate) const HIERARCHY_ENDINGS: [&str; 2] = ["json", "csv"];

/// Writes an order of cones in the format of the file's ending.
pub(crate) fn write_hierarchy(files: &mut Files, path: &Path, order: ConeOrder) -> Result<(), CommandError> {
    match output::extension(path, &HIERARCHY_ENDINGS)? {
        "csv" => files.write_csv(path, &hierarchy_rows(&order)),
        _ => files.write_json(path, &HierarchyFile::new(order)),
    }
}
