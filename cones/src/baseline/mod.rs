//! What the method is compared with, and nothing else uses.

mod linear;
mod lscm;

pub use linear::scale_linearly;
pub use lscm::{Lscm, LscmError};
