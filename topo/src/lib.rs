//! 0-dimensional persistence of a scalar field on any graph.

mod domain;
mod filtration;
mod hierarchy;
mod persistence;
mod scalar;
mod sweep;
mod union_find;

pub use domain::Domain;
pub use filtration::{Direction, Falling, FieldError, Filtration, Kind, NanPolicy, Rising};
pub use hierarchy::{Extremum, Hierarchy};
pub use persistence::{Options, Pair, Pairs, Persistence, persistence, sublevel, superlevel};
pub use scalar::Scalar;
#[doc(hidden)]
pub use sweep::Merges;
