//! The conformal factor and what it is solved with (paper §3.1).

mod conformal_factor;
mod operators;
mod pinned;

pub use conformal_factor::ConformalFactor;
pub use operators::Operators;
pub(crate) use pinned::PinnedFactor;
