//! The conformal factor and what it is solved with (paper §3.1).

mod coarse;
mod coarsened;
mod conformal_factor;
mod opened;
mod operators;
mod pinned;

pub(crate) use coarse::coarse_level;
pub use conformal_factor::ConformalFactor;
pub(crate) use opened::{open_handles, opened_level};
pub use operators::Operators;
pub(crate) use operators::TiedLoops;
pub(crate) use pinned::PinnedFactor;
