//! What holds across the crates.

mod command;
mod fields_command;
