//! Cone-based conformal unwrapping.

mod angles;
mod crowd;
mod dense;
mod error;
mod exchange;
mod factor;
mod fit;
mod grow;
mod hierarchy;
mod layout;
mod lbfgs;
mod mend;
mod operators;
mod reduced;
mod refined;
mod scaling;
mod seams;
mod swap;
mod untangle;
mod unwrap;

pub use angles::{Angles, AnglesError, ConeCurvatures, cone_curvatures, least_cones};
pub use error::Error;
pub use factor::ConformalFactor;
pub use fit::{Fit, FitError, Held, Quadratic, fit};
pub use hierarchy::{Candidate, ConeHierarchy, Method};
pub use layout::Layout;
pub use mend::MendError;
pub use operators::Operators;
pub use reduced::{Fitted, Reduced};
pub use refined::refined;
pub use scaling::{Scaling, ScalingError, scale};
pub use seams::{Chain, SeamError, Seams};
pub use topo::Kind;
pub use untangle::{Corner, Patch, PatchError, PatchTriangle, Untangled};
pub use unwrap::{Atlas, Cone, ConeChoice, Extraction, Options, Stage, Topology, extract, unwrap};
