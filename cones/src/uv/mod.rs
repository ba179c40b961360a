//! Maps to the plane as they are painted on: what lies over itself, and how it is taken apart.
//!
//! | for | there is |
//! |---|---|
//! | finding overlap | [`overlaps`]: the pairs of triangles, exactly, with depth and area |
//! | a surface | [`separate`]: a [`UvMap`] cut and put together again until no island lies over itself |
//! | a model | [`part`]: the same for all its surfaces, islands placed apart, as by [`shelve`] |
//!
//! Everything is for maps of any origin. Positions belong to corners. Islands move rigidly, so that scale and distortion
//! stay.

mod attach;
mod chains;
mod divide;
mod map;
mod motion;
mod overlap;
mod part;
mod separate;
mod shelf;
#[cfg(test)]
mod tests;
mod triangle;

pub use map::UvMap;
pub use motion::Motion;
pub use overlap::{NEGLIGIBLE_DEPTH, Overlap, Overlaps, overlaps, overlaps_watched};
pub use part::{Parted, part};
pub use separate::{Separation, separate};
pub use shelf::shelve;
pub use triangle::Triangle;
