//! What holds of persistence on any domain, on random input and on measured fields.

mod distances;
mod domains;
mod extremes;
mod features;
mod fields;
mod inputs;
mod laws;
#[cfg(feature = "serde")]
mod serialized;
mod threads;
mod trees;
