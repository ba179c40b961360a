//! A small manifold surface: every law of operators, seams and layout.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tests::properties::surface(bytes));
