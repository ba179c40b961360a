//! Triangle meshes and what conformal geometry computes on them.

mod cholesky;
mod curvature;
mod cut;
mod delaunay;
pub mod io;
mod laplacian;
mod mesh;
mod metric;
mod model;
mod path;
mod poisson;
mod prepare;
pub mod shapes;
mod triangulate;
mod vector;

pub use curvature::angle_defects;
pub use cut::CutMesh;
pub use delaunay::{Intrinsic, delaunay, ptolemaic_delaunay};
pub use laplacian::{edge_weights, laplacian};
pub use mesh::*;
pub use metric::{Metric, Sides};
pub use model::{MAX_COORDINATE, Model, ModelError, Skipped, TextureCoordinates};
pub use path::{ShortestPaths, edges_at, kruskal, maximum_spanning_cotree, minimum_spanning_tree, other_end};
pub use poisson::{Poisson, PoissonError};
pub use prepare::{PrepareError, Prepared, Repair, RepairKind, Surface, prepare};
pub use triangulate::Triangles;
