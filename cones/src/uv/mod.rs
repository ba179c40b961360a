//! Maps to the plane as they are painted on: what lies over itself, how it is taken apart, and how islands are packed.
//!
//! | for | there is |
//! |---|---|
//! | finding overlap | [`overlaps`]: the pairs of triangles, exactly, with depth and area |
//! | a surface | [`separate`]: a [`UvMap`] cut and put together again until no island lies over itself |
//! | a model | [`part`]: the same for all its surfaces |
//! | painting | [`pack`]: islands moved rigidly into one square or onto tiles, [`repack`] those of a model; [`cut_for_fill`]: cut further so that they fill more |
//!
//! Everything is for maps of any origin. Positions belong to corners. Islands move rigidly, so that scale and distortion
//! stay.

mod across;
mod attach;
mod boxes;
mod cells;
mod chains;
mod companions;
mod cut_for_fill;
mod divide;
mod immersion;
mod map;
mod motion;
mod overlap;
mod pack;
mod part;
mod rearrange;
mod repack;
mod separate;
mod sides;
mod table;
#[cfg(test)]
mod tests;
mod textures;
mod triangle;

pub(crate) use companions::{Corners, leaders};
pub use cut_for_fill::{Part, cut_for_fill};
pub use map::UvMap;
pub use motion::Motion;
pub use overlap::{NEGLIGIBLE_DEPTH, Overlap, Overlaps, overlaps, overlaps_watched, rounding_depth};
pub use pack::{IslandPlace, PackError, PackOptions, Packing, Rotations, Tiles, fill, pack};
pub(crate) use pack::{filled, readable, room};
pub use part::{PartError, Parted, part};
pub(crate) use rearrange::{Figures, SEARCHES};
pub use repack::{Repacked, islands_of, repack};
pub use separate::{Separation, separate};
pub(crate) use separate::{add_necks, attached, overlaps_on_islands, seam, taken_apart};
pub use textures::textures_apart;
pub use triangle::Triangle;
pub(crate) use triangle::area;

/// So many triangles, edges or corners are gone through one after the other at least.
const AT_ONCE: usize = 1 << 12;
