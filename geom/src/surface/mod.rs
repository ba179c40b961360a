//! From points and polygons as a file had them to surfaces that can be computed with.

mod curvature;
mod model;
mod prepare;
mod triangulate;

pub use curvature::{gaussian_curvature, mean_curvature};
pub use model::{MAX_COORDINATE, Model, ModelError, Skipped, TextureCoordinates};
#[cfg(feature = "files")]
pub(crate) use model::{Polygons, is_coordinate};
pub use prepare::{PrepareError, Prepared, Repair, RepairKind, Surface, prepare, prepare_watched};
pub use triangulate::Triangles;
