//! Which extremum dies at which saddle: the ways to find it, on vertex indices.
//!
//! The plain one sorts all vertices ([`sweep`](mod@sweep)); the fast one lets every vertex look at its neighbours once
//! and pairs the basins that it finds ([`basins`], [`descent`], [`boruvka`]). Both end in [`Merges`].

mod basins;
mod boruvka;
mod descent;
mod graph;
mod merges;
mod sweep;
mod union_find;

pub(crate) use basins::{SaddleCandidate, Scan, merges_of_graph, merges_of_scan, steepest_descent};
pub(crate) use descent::OUTSIDE;
pub(crate) use graph::Graph;
pub(crate) use merges::Merge;
pub use merges::Merges;
pub(crate) use sweep::sweep;
pub(crate) use union_find::UnionFind;
