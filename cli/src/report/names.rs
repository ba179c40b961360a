//! What curvature rules, extrema and repairs are called in reports.

use cones::{CurvatureRule, Islands, Kind};
use geom::Repair;

/// A curvature rule's name, as the command line takes it and reports give it.
pub(crate) fn angles_name(rule: CurvatureRule) -> &'static str {
    match rule {
        CurvatureRule::Harmonic => "harmonic",
        _ => "optimal",
    }
}

/// The name of what is done where a layout lies over itself, as the command line takes it and reports give it.
pub(crate) fn policy_name(islands: Islands) -> &'static str {
    match islands {
        Islands::Single => "single",
        _ => "overlap-free",
    }
}

/// A cone's kind in reports and tables.
pub(crate) fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Minimum => "minimum",
        Kind::Maximum => "maximum",
    }
}

/// A repair as a sentence.
pub(crate) fn repair_text(repair: &Repair) -> String {
    let element = if repair.kind.is_of_faces() { "face" } else { "vertex" };
    format!("{} {} (first {element} {}, counted from 0)", repair.count, repair.kind.description(), repair.first)
}
