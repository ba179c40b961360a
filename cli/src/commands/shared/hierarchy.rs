//! The file of the cone hierarchy, for the commands that write one.

use crate::error::CommandError;
use crate::output;
use crate::report::{HierarchyFile, hierarchy_rows};
use cones::ConeOrder;
use std::path::Path;

/// The endings that it may have.
pub(crate) const HIERARCHY_ENDINGS: [&str; 2] = ["json", "csv"];

/// Writes an order of cones in the format of the file's ending.
pub(crate) fn write_hierarchy(path: &Path, order: ConeOrder) -> Result<(), CommandError> {
    match output::extension(path, &HIERARCHY_ENDINGS)? {
        "csv" => output::write_csv(path, &hierarchy_rows(&order)),
        _ => output::write_json(path, &HierarchyFile::new(order)),
    }
}
