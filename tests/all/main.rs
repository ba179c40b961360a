//! What holds across the crates.

mod command;
