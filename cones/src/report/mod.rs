//! Reports: how good a map is, and what was done to make it.
//!
//! [`MeasuredMap`] measures any map of a model: its [`Quality`], of the triangles that are [worth measuring](worth_measuring). [`MeasuredAtlas`] is an atlas with its texture coordinates in the size in which they are written, and what
//! they are worth; its [`report`](MeasuredAtlas::report) has what a user or a program wants to know of an unwrapping. With the
//! feature `serde` reports and qualities are serializable, under the keys of the command's JSON (`docs/json.md`), of which [`SCHEMA`] counts the changes.

mod map;
mod measured;
mod quality;
mod unwrapping;
mod worth;

pub use map::MeasuredMap;
pub use measured::{MeasuredAtlas, UvSize};
pub use quality::{DistortionReport, IslandReport, OverlapReport, Quality};
pub use unwrapping::{
    Element, HierarchyReport, RefinedReport, RepairReport, Report, SeamReport, TilingReport, sentences,
};
pub use worth::worth_measuring;

/// The version of the reports' keys.
pub const SCHEMA: u32 = 1;
