//! Cone-based conformal unwrapping.

mod fit;
mod lbfgs;
mod seams;
mod untangle;

pub use fit::{Fit, FitError, Held, Quadratic, fit};
pub use seams::{Chain, SeamError, Seams};
pub use untangle::{Corner, Patch, PatchError, PatchTriangle, Untangled};
