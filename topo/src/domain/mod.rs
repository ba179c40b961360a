//! What a field may live on: any graph, and domains that are faster for what they know.

mod adjacency;
mod csr;
mod graph;
mod grid;
mod path;
mod picture;
mod rings;
mod rows;
mod stencil;
mod triangle_mesh;
mod triangles;

pub use adjacency::Adjacency;
pub use csr::CsrGraph;
pub use graph::Domain;
pub use grid::Grid;
pub use path::Path;
pub(crate) use picture::Picture;
pub use rings::Rings;
pub(crate) use rows::{check_edges, known};
pub use stencil::Connectivity;
pub use triangle_mesh::TriangleMesh;
