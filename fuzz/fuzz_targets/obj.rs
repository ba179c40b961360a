//! Any bytes as an OBJ file: read or refused, and given back line for line.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tests::properties::obj(bytes));
