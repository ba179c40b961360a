//! Triangle meshes and what conformal geometry computes on them.

mod mesh;
pub mod shapes;
mod vector;

pub use mesh::*;
