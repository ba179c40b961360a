//! Islands arranged, and which arrangement is the better one.

use super::island_place::IslandPlace;
use super::search::FINE;

/// Sides that differ by no more than this, a cell of the fine grid, are alike.
const ALIKE: f64 = 1.0 + 1.0 / FINE;

/// Where islands go, and in the outlines' unit the side of a tile, of which margins take a share.
pub(super) struct Arrangement {
    pub(super) places: Vec<IslandPlace>,
    pub(super) tiles: usize,
    pub(super) side: f64,
    pub(super) share: f64,
}

impl Arrangement {
    /// Whether it is worth turning islands further for it.
    pub(super) fn is_better_than(&self, other: &Self) -> bool {
        let has_fewer = self.tiles < other.tiles;
        has_fewer || self.tiles == other.tiles && self.side * ALIKE < other.side
    }
}
