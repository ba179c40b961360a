//! Ways over a mesh along its edges: shortest paths, spanning trees, cuts.

mod cut;
mod path;

pub use cut::CutMesh;
pub use path::{ShortestPaths, edges_at, kruskal, maximum_spanning_cotree, minimum_spanning_tree, other_end};
