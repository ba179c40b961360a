//! What methods, curvature rules, extrema and repairs are called in reports.

use cones::{Angles, Kind, Method};
use geom::Repair;

/// A method's name, as the command line takes it and reports give it.
pub(crate) fn method_name(method: Method) -> &'static str {
    match method {
        Method::Persistence => "persistence",
        Method::Alternating => "alternating",
        Method::Iterative => "iterative",
        Method::Greedy => "greedy",
        Method::Refined => "refined",
        Method::Pursuit => "pursuit",
    }
}

/// A curvature rule's name, as the command line takes it and reports give it.
pub(crate) fn angles_name(angles: Angles) -> &'static str {
    match angles {
        Angles::Optimal => "optimal",
        Angles::Harmonic => "harmonic",
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
