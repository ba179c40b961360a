//! What a field may live on: any graph, and domains that are faster for what they know.

mod adjacency;
mod graph;
mod grid;
mod path;
mod rings;
mod stencil;
mod triangle_mesh;

pub use adjacency::Adjacency;
pub use graph::Domain;
pub use grid::Grid;
pub use path::Path;
pub use rings::Rings;
pub use stencil::Connectivity;
pub use triangle_mesh::TriangleMesh;
