//! What holds across the crates.
//! What holds across the crates, one module a subject.

mod command;
mod corpus;
mod fields_command;
mod files;
mod flattening;
mod invariance;
mod operators;
mod persistence;
mod preparing;
mod real;
