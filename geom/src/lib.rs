//! Triangle meshes and what conformal geometry computes on them.

pub mod io;
mod mesh;
mod model;
mod triangulate;

pub use mesh::*;
pub use model::{MAX_COORDINATE, Model, ModelError, Skipped, TextureCoordinates};
pub use triangulate::Triangles;
