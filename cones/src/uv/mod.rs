//! Maps to the plane, of any origin: what is done with them once they are there.

mod pack;

pub use pack::{IslandPlace, PackError, PackOptions, Packing, Rotations, Tiles, fill, pack};
