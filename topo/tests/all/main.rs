//! What holds of persistence on any domain, on random input and on measured fields.

mod contours;
mod distances;
mod domains;
mod extended;
mod extremes;
mod features;
mod fields;
mod graphs;
mod holes;
mod inputs;
mod laws;
mod linkage;
#[cfg(feature = "serde")]
mod serialized;
mod stopping;
mod threads;
mod tiles;
mod trees;
