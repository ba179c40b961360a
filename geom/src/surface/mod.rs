//! From points and polygons as a file had them to surfaces that can be computed with.

mod model;
mod prepare;
mod triangulate;

pub use model::{MAX_COORDINATE, Model, ModelError, Skipped, TextureCoordinates};
pub(crate) use model::{Polygons, is_coordinate};
pub use prepare::{PrepareError, Prepared, Repair, RepairKind, Surface, prepare, prepare_watched};
pub use triangulate::Triangles;
