//! 0-dimensional persistence of a scalar field on any graph.

mod adjacency;
mod basins;
mod boruvka;
mod branches;
mod descent;
mod diagram;
mod domain;
mod filtration;
mod grid;
mod hierarchy;
mod merge_tree;
mod merges;
mod options;
mod parallel;
mod path;
mod persistence;
mod scalar;
mod segmentation;
mod simplify;
mod stencil;
mod sweep;
mod triangulation;
mod union_find;

pub use adjacency::{Adjacency, DomainError};
pub use diagram::Diagram;
pub use domain::Domain;
pub use filtration::{Direction, Falling, FieldError, Filtration, Kind, NanPolicy, Rising};
pub use grid::{Connectivity, Grid};
pub use hierarchy::{Extremum, Hierarchy};
pub use merge_tree::{Component, MergeTree, Node, merge_tree};
#[doc(hidden)]
pub use merges::Merges;
pub use options::Options;
pub use path::Path;
pub use persistence::{Pair, Pairs, Persistence, persistence, sublevel, superlevel};
pub use scalar::Scalar;
pub use segmentation::{Segmentation, segmentation};
pub use simplify::simplify;
pub use triangulation::Triangulation;
