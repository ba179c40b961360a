//! The part of a report that says what seams are like.

use super::table::labelled;
use cones::{Atlas, Tiling};
use serde::Serialize;

/// What the seams of a map are like.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SeamReport {
    /// By how much they turn from edge to edge, in all, in radians.
    turning: f64,
    /// The share of their length on edges that bend by more than 30°.
    sharp: f64,
    /// How many handles were opened along a loop each.
    opened_handles: usize,
    /// Across how many of them a texture runs on; nothing where that was not asked for.
    tiling: Option<TilingReport>,
}

#[derive(Clone, Debug, Serialize)]
struct TilingReport {
    /// The texture looks the same after this part of a turn.
    order: u32,
    seams: usize,
    /// Across how many it does not run on.
    broken: usize,
    /// How far the others' rotations are from the texture's, in radians.
    error: f64,
}

impl SeamReport {
    pub(crate) fn new(atlas: &Atlas) -> Self {
        let figures = atlas.seam_figures;
        Self {
            turning: figures.turning,
            sharp: figures.sharp_share(),
            opened_handles: atlas.opened_handles,
            tiling: atlas.tiling.as_ref().map(TilingReport::from),
        }
    }

    /// A line where handles were opened, and one where tiling was asked for.
    pub(crate) fn text(&self) -> String {
        let opened = match self.opened_handles {
            0 => String::new(),
            1 => labelled("handles", "1 opened along a short loop, whose sides fit in length alone"),
            count => labelled("handles", &format!("{count} opened along short loops, whose sides fit in length alone")),
        };
        opened + &self.tiling_text()
    }

    fn tiling_text(&self) -> String {
        let Some(TilingReport { order, seams, broken, error }) = self.tiling else { return String::new() };
        let tiled = seams - broken;
        labelled(
            "tiling",
            &format!("{tiled} of {seams} seams turn by multiples of 1/{order} of a turn, to {error:.0e} rad"),
        )
    }
}

impl From<&Tiling> for TilingReport {
    fn from(tiling: &Tiling) -> Self {
        let Tiling { symmetry, seams, broken, error, .. } = *tiling;
        Self { order: symmetry.order(), seams, broken, error }
    }
}
