//! Triangle meshes and what conformal geometry computes on them.

mod mesh;

pub use mesh::*;
