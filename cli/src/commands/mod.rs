//! The subcommands, a file or a folder each: what may be asked of it, and what it does.

pub(crate) mod bake;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod distance;
pub(crate) mod extract;
pub(crate) mod features;
pub(crate) mod figure;
pub(crate) mod islands;
pub(crate) mod man;
pub(crate) mod measure;
pub(crate) mod pack;
pub(crate) mod persistence;
pub(crate) mod shape;
pub(crate) mod simplify;
pub(crate) mod tree;
pub(crate) mod unwrap;
pub(crate) mod view;

mod shared;

pub(crate) use shared::whole;
