//! Seams where people want them.
//!
//! [`flatten`](crate::flatten) cuts a surface to a disk along seams as short as edges allow. Here is what people ask beyond that:
//! seams along sharp edges and in hidden places ([`cost`]), straight ones ([`straighten`]), through edges that are given and
//! round edges that are to be avoided ([`plan`]), and whether a texture of hatches or bricks keeps its directions across them ([`tiling`]). The
//! metric knows nothing of the cut, so that all of this costs length and nothing else.

mod cost;
mod figures;
mod limbs;
mod options;
mod plan;
mod straighten;
mod tiling;
mod turning;

pub use figures::SeamFigures;
pub(crate) use limbs::{Limbs, limbs};
pub use options::{SeamOptions, Symmetry};
pub use plan::SeamPlan;
pub(crate) use plan::{ModelEdges, ascending, named_edges, names};
pub use tiling::Tiling;
