//! Any bytes as a file, and files with damage: unwrapped.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tests::properties::files_unwrap(bytes));
