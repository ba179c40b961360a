//! Maps to the plane as they are painted on: what lies over itself, how it is taken apart, and how islands are packed.
//!
//! | for | there is |
//! |---|---|
//! | finding overlap | [`overlaps`]: the pairs of triangles, exactly, with depth and area |
//! | a surface | [`separate`]: a [`UvMap`] cut and put together again until no island lies over itself |
//! | a model | [`part`]: the same for all its surfaces |
//! | painting | [`pack`]: islands moved rigidly into one square or onto tiles; [`cut_for_fill`]: cut further so that they fill more |
//!
//! Everything is for maps of any origin. Positions belong to corners. Islands move rigidly, so that scale and distortion
//! stay.

mod across;
mod attach;
mod boxes;
mod chains;
mod cut_for_fill;
mod divide;
mod exchange;
mod immersion;
mod map;
mod motion;
mod overlap;
mod pack;
mod part;
mod separate;
mod sides;
mod table;
#[cfg(test)]
mod tests;
mod triangle;

pub use cut_for_fill::{Part, cut_for_fill};
pub(crate) use exchange::Aim;
pub use map::UvMap;
pub use motion::Motion;
pub use overlap::{NEGLIGIBLE_DEPTH, Overlap, Overlaps, overlaps, overlaps_watched};
pub(crate) use pack::room;
pub use pack::{IslandPlace, PackError, PackOptions, Packing, Rotations, Tiles, fill, pack};
pub use part::{Parted, part};
pub(crate) use separate::{Effort, attached, is_searched, overlaps_on_islands, separate_by};
pub use separate::{Separation, separate};
pub use triangle::Triangle;
