//! Lines on seams.

use super::table::{counted, labelled};
use cones::report::{SeamReport, TilingReport};

/// A line where handles were opened, one where limbs were cut off, one where seams are free, and one where tiling was asked for.
pub(super) fn seam_text(seams: &SeamReport) -> String {
    let lines: String = on_seams(seams).into_iter().map(|(label, text)| labelled(label, &text)).collect();
    lines + &seams.tiling.map_or_else(String::new, tiling_text)
}

/// What became of handles, limbs and the two sides of seams, and of which it is said.
pub(crate) fn on_seams(seams: &SeamReport) -> Vec<(&'static str, String)> {
    let loops = if seams.opened_handles == 1 { "a short loop" } else { "short loops" };
    let necks = counted(seams.necks, "neck", "necks");
    let mismatch = 100.0 * seams.mismatch;
    let fit = if seams.freed_parts == 0 { ", whose sides fit in length alone" } else { "" };
    let told = [
        (
            seams.filled_holes,
            "holes",
            counted(seams.filled_holes, "small hole", "small holes") + " filled for computing",
        ),
        (seams.opened_handles, "handles", format!("{} opened along {loops}{fit}", seams.opened_handles)),
        (seams.necks, "limbs", format!("cut off at {necks}, as no affordable number of cones keeps lengths")),
        (seams.freed_parts, "seams", format!("free, the lengths of their two sides differing by {mismatch:.1} %")),
    ];
    told.into_iter().filter(|(count, ..)| *count > 0).map(|(_, label, text)| (label, text)).collect()
}

fn tiling_text(TilingReport { order, seams, broken, error, .. }: TilingReport) -> String {
    let tiled = seams - broken;
    labelled(
        "tiling",
        &format!(
            "{tiled} of {} by multiples of 1/{order} of a turn, to {error:.0e} rad",
            counted(seams, "seam turns", "seams turn")
        ),
    )
}
