//! Cone-based conformal unwrapping.

mod fit;
mod seams;

pub use fit::{Fit, FitError, Held, Quadratic, fit};
pub use seams::{Chain, SeamError, Seams};
