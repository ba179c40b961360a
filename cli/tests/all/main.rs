//! The command `cones` as a user runs it.
//!
//! These tests live here and not with those across crates because cargo builds a program for the tests of its own package
//! only.

mod baking;
mod comparing;
mod documented;
mod field_files;
mod fields;
mod finds;
mod folder;
mod hierarchy;
mod islands;
mod limits;
mod many;
mod packing;
mod pictures;
mod seams;
mod terminal;
mod textures;
mod unwrapping;
mod viewing;
