//! What was mended and decided, on stderr.

use crate::output;
use crate::report::repair_text;
use geom::Repair;

/// Says what the library mended and had to decide.
pub(crate) fn warn(repairs: &[Repair], warnings: &[String]) {
    repairs.iter().for_each(|repair| output::warn(&repair_text(repair)));
    warnings.iter().for_each(|warning| output::warn(warning));
}
