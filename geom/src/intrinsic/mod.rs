//! What edge lengths alone determine: angles, areas and curvature, Delaunay triangulations, the Laplacian and its equation.

mod curvature;
mod delaunay;
mod double;
mod laplacian;
mod metric;
mod part;
mod poisson;
mod simplification;

pub use curvature::angle_defects;
pub use delaunay::{Intrinsic, delaunay, delaunay_watched, ptolemaic_delaunay, ptolemaic_delaunay_watched};
pub(crate) use delaunay::{TOLERANCE, opposite_cosines, other_diagonal};
pub use double::Double;
pub use laplacian::{edge_weights, folded_laplacian, laplacian};
pub use metric::{Metric, Sides};
pub use part::Part;
pub use poisson::{ForwardSolution, Poisson, PoissonError};
pub use simplification::{Simplified, simplified};
