//! 0-dimensional persistence of a scalar field on any graph.

mod adjacency;
mod basins;
mod boruvka;
mod descent;
mod domain;
mod filtration;
mod grid;
mod hierarchy;
mod merges;
mod parallel;
mod path;
mod persistence;
mod scalar;
mod stencil;
mod sweep;
mod triangulation;
mod union_find;

pub use adjacency::{Adjacency, DomainError};
pub use domain::Domain;
pub use filtration::{Direction, Falling, FieldError, Filtration, Kind, NanPolicy, Rising};
pub use grid::{Connectivity, Grid};
pub use hierarchy::{Extremum, Hierarchy};
#[doc(hidden)]
pub use merges::Merges;
pub use path::Path;
pub use persistence::{Options, Pair, Pairs, Persistence, persistence, sublevel, superlevel};
pub use scalar::Scalar;
pub use triangulation::Triangulation;
