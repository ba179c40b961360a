//! What holds across the crates, one module a subject.

mod analysis;
mod choosing;
mod corpus;
mod files;
mod flattening;
mod holes;
mod instances;
mod invariance;
mod layers;
mod licences;
mod limbs;
mod noise;
mod operators;
mod persistence;
mod preparing;
mod real;
mod recipes;
mod seams;

use proptest::collection::vec;
use proptest::prelude::{ProptestConfig, Strategy, any};

/// Bytes for a law to read its input from.
fn bytes(most: usize) -> impl Strategy<Value = Vec<u8>> {
    vec(any::<u8>(), 0..most)
}

/// So many random inputs for a law, or as many as `PROPTEST_CASES` asks for. A failing one is printed, to become a file in
/// `fuzz/regressions`.
fn cases(count: u32) -> ProptestConfig {
    let asked = ProptestConfig::default();
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { asked.cases } else { count };
    ProptestConfig { cases, failure_persistence: None, ..asked }
}
