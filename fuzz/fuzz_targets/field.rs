//! Any field on any graph: paired alike in every way.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tests::properties::field(bytes));
