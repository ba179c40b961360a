//! Cone-based conformal unwrapping.

mod seams;

pub use seams::{Chain, SeamError, Seams};
