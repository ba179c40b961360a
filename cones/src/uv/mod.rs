//! Maps to the plane as they are painted on: what lies over itself, and how it is taken apart.
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
