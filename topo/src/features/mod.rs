//! What is made from the pairs: ranks, trees, basins, simpler fields, diagrams.

mod attributes;
mod branches;
mod contour_tree;
mod diagram;
mod extended;
mod hierarchy;
mod holes;
mod isolation;
mod levels;
mod linkage;
mod merge_tree;
mod segmentation;
mod simplify;

pub use attributes::Branch;
pub use contour_tree::{ContourArc, ContourNode, ContourTree, contour_tree};
pub use diagram::{Diagram, Matching, Wasserstein};
pub use extended::{Extended, Loop, extended_persistence};
pub use hierarchy::{Extremum, Hierarchy};
pub use holes::{Hole, Holes, holes, holes_watched, pairs_and_holes, pairs_and_holes_watched};
pub use isolation::isolation;
pub use levels::LevelComponent;
pub use linkage::{Dendrogram, Link, single_linkage, weighted_edges};
pub use merge_tree::{MergeTree, Node, merge_tree};
pub use segmentation::{Segmentation, segmentation};
pub use simplify::simplify;
