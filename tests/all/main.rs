//! What holds across the crates, one module a subject.

mod corpus;
mod files;
mod flattening;
mod invariance;
mod operators;
mod persistence;
mod preparing;
mod real;

use proptest::collection::vec;
use proptest::prelude::{Strategy, any};

/// Bytes for a law to read its input from.
fn bytes(most: usize) -> impl Strategy<Value = Vec<u8>> {
    vec(any::<u8>(), 0..most)
}
