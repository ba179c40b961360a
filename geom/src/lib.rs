//! Triangle meshes and what conformal geometry computes on them.

mod cholesky;
mod curvature;
mod delaunay;
mod laplacian;
mod mesh;
mod metric;
mod poisson;

pub use curvature::angle_defects;
pub use delaunay::{Intrinsic, delaunay, ptolemaic_delaunay};
pub use laplacian::{edge_weights, laplacian};
pub use mesh::*;
pub use metric::{Metric, Sides};
pub use poisson::{Poisson, PoissonError};
