//! Any bytes as an OFF file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tests::properties::reading(bytes, "a.off"));
