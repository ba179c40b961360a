//! Which extremum dies at which saddle: the ways to find it, on vertex indices.
//!
//! The plain one sorts all vertices ([`sweep`](mod@sweep)); the fast one lets every vertex look at its neighbours once
//! and pairs the basins that it finds ([`basins`], [`descent`], [`elder_rule`]). Both end in a [`Merge`] an extremum.

mod basins;
mod boruvka;
mod by_value;
mod descent;
mod duality;
mod elder_rule;
mod graph;
mod joins;
mod merges;
mod sweep;
mod union_find;

pub use basins::{Basins, Pointing};
pub(crate) use basins::{Branched, Remnant, SaddleCandidate, Scan, basins_of_graph, last_of_all, note_sides};
pub(crate) use by_value::in_order;
pub(crate) use descent::{BasinLabels, Descent, OUTSIDE, Settled};
pub(crate) use duality::{Crossing, pair_both};
pub(crate) use graph::Graph;
pub(crate) use joins::Join;
pub use merges::Merge;
pub(crate) use merges::{BranchEnd, NONE};
pub(crate) use sweep::sweep;
pub(crate) use union_find::UnionFind;
