//! Triangle meshes and what conformal geometry computes on them.

mod cut;
mod mesh;
mod path;

pub use cut::CutMesh;
pub use mesh::*;
pub use path::{ShortestPaths, edges_at, kruskal, maximum_spanning_cotree, minimum_spanning_tree, other_end};
