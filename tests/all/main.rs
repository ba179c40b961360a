//! What holds across the crates, one module a subject.

mod corpus;
mod files;
mod flattening;
mod invariance;
mod operators;
mod persistence;
mod preparing;
mod real;
