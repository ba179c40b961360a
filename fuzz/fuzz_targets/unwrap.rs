//! A small mesh after any insults: unwrapped.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tests::properties::insults_unwrap(bytes));
