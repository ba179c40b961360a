//! Lines on seams.

use super::table::labelled;
use cones::report::{SeamReport, TilingReport};

/// A line where handles were opened, one where limbs were cut off, one where seams are free, and one where tiling was asked for.
pub(super) fn seam_text(seams: &SeamReport) -> String {
    let opened = match seams.opened_handles {
        0 => String::new(),
        1 => labelled("handles", "1 opened along a short loop, whose sides fit in length alone"),
        count => labelled("handles", &format!("{count} opened along short loops, whose sides fit in length alone")),
    };
    let necks = match seams.necks {
        0 => String::new(),
        1 => labelled("limbs", "cut off at 1 neck, as no affordable number of cones keeps lengths"),
        count => {
            labelled("limbs", &format!("cut off at {count} necks, as no affordable number of cones keeps lengths"))
        }
    };
    let freed = match seams.freed_parts {
        0 => String::new(),
        _ => labelled(
            "seams",
            &format!("free: the lengths of their two sides differ by {:.1} %", 100.0 * seams.mismatch),
        ),
    };
    opened + &necks + &freed + &seams.tiling.map_or_else(String::new, tiling_text)
}

fn tiling_text(TilingReport { order, seams, broken, error, .. }: TilingReport) -> String {
    let tiled = seams - broken;
    labelled(
        "tiling",
        &format!("{tiled} of {seams} seams turn by multiples of 1/{order} of a turn, to {error:.0e} rad"),
    )
}
