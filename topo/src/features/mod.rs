//! What is made from the pairs: ranks, trees, basins, simpler fields, diagrams.

mod branches;
mod diagram;
mod hierarchy;
mod isolation;
mod merge_tree;
mod segmentation;
mod simplify;

pub use diagram::Diagram;
pub use hierarchy::{Extremum, Hierarchy};
pub use isolation::isolation;
pub use merge_tree::{Branch, LevelComponent, MergeTree, Node, merge_tree};
pub use segmentation::{Segmentation, segmentation};
pub use simplify::simplify;
