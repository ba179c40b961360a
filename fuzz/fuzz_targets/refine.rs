//! A small manifold surface, slivers and all: refined to even triangles.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tests::properties::refinement(bytes));
