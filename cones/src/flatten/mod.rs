//! From cones with curvatures to the plane: the cut (paper §2), metric scaling, the layout, and what is done where
//! triangles of the layout fold over.

mod detach;
#[cfg(test)]
pub(crate) mod flattened;
mod fold_over;
mod isometry;
mod layout;
mod relax;
mod rims;
mod scaling;
mod seams;
mod untangle;

pub(crate) use detach::{DetachedShape, detach, whole_polygons};
pub(crate) use fold_over::FoldOvers;
pub(crate) use fold_over::{Fixed, remove_fold_overs};
pub(crate) use isometry::Relaxation;
pub use layout::{Layout, SeamRotations};
pub(crate) use relax::{BENT, MOST_BENT, relax, stretch};
pub(crate) use rims::narrow_rims;
pub(crate) use scaling::scale_by;
pub use scaling::{Scaling, ScalingError, scale};
pub use seams::{Chain, SeamError, Seams};
pub(crate) use seams::{seam_lengths, terminals};
pub use untangle::{Corner, Patch, PatchTriangle};
