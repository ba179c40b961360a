//! Any polygons between any points: made into sound surfaces.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tests::properties::preparing(bytes));
