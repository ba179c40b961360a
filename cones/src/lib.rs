//! Cone-based conformal unwrapping by conformal factor persistence.
//!
//! A conformal map of a surface to the plane keeps angles and stretches lengths, by e^u with a log scale factor u that can
//! vary wildly. Letting a few vertices, the *cones*, keep curvature makes u nearly constant. This crate finds cones, cuts
//! the surface open through them, and lays it out: A. Vintescu, F. Dupont, G. Lavoué, P. Memari and J. Tierny, "Conformal
//! Factor Persistence for Fast Hierarchical Cone Extraction" (Eurographics 2017), called *the paper* here, and what goes
//! beyond it.
//!
//! # One analysis, many maps
//!
//! An [`Analysis`] finds once what is needed again and again; [`place`](Analysis::place), [`predict`](Analysis::predict),
//! [`order`](Analysis::order) and [`flatten`](Analysis::flatten) ask it. [`unwrap_model`] is all of it in one call: it chooses
//! the number of cones, and tries others where these fail.
//!
//! ```
//! use cones::{Analysis, Placement};
//!
//! let model = geom::shapes::by_name("capsule", 500).expect("it is built in").into();
//! let analysis = Analysis::new(&model)?;
//! let cones = analysis.place(Placement::Refined, 8)?;
//! let atlas = analysis.flatten(&cones)?;
//! assert_eq!(atlas.uv.len(), model.corner_count());
//! # Ok::<(), cones::Error>(())
//! ```
//!
//! # The method, folder by folder
//!
//! 1. `field` (paper §3.1): with the cotangent Laplacian L of the intrinsic Delaunay triangulation and the angle defects K,
//!    solve Lφ = K^T - K for the target curvature K^T that is spread evenly: 2πχ times each vertex's share of the area. The
//!    *conformal factor* φ is the log scale that evens curvature out: low at tips, high at saddles. One factorization serves
//!    this and everything that follows up to the flattening.
//! 2. `hierarchy` (§3.2): the local extrema of φ, each paired with the saddle where its component of the sub- or superlevel
//!    set joins an elder one, ranked by persistence |φ(extremum) - φ(saddle)| ([`topo`]).
//! 3. `curvature`: what curvature each cone gets. *Harmonic*: that of the φ that is 0 at all cones. *Optimal*: that for which
//!    the L2 norm of u is least, between bounds that keep the cone buildable.
//! 4. `placement`: the methods that choose cones, from the paper's to [`Placement::Refined`], which minimises that norm over
//!    the places too.
//! 5. `flatten` (§2): a minimum spanning tree of the cones' distances, and loops for handles and boundaries, cut the surface to
//!    a disk; Newton's method finds the u for which curvature is k at the cones and 0 elsewhere, exactly; the flat metric is
//!    brought back to the input's triangles and developed into the plane, and what folds over there is removed.
//! 6. [`uv`]: where the layout lies over itself it is cut, and put together again across other seams.
//! 7. [`report`]: how good a map is, and what was done to make it.
//! 8. `baseline`: what the method is compared with.
//!
//! Curvature is an angle defect in radians: a cone of curvature k has 2π - k of angle. L is positive semidefinite.
//! Everything is deterministic, and runs on the threads of the rayon pool from which it is called.
//!
//! # Features
//!
//! None is on by default. `files` reads and writes mesh files, by `cones::geom::io`; `serde` makes options, cones, orders and reports serializable.

mod analysis;
mod baseline;
mod curvature;
mod cut;
mod error;
mod field;
mod flatten;
mod hierarchy;
mod numerics;
mod placement;
pub mod report;
pub mod uv;

pub use ::geom;
pub use analysis::{
    Analysis, Atlas, Baseline, BaselineMap, ChosenNumber, Cone, ConeChoice, ConeOrder, Cones, Failure, FreeSeams,
    GivenCone, Handles, Islands, Limbs, MOST_AUTOMATIC, MOST_NEEDLES, ModelExtremum, Note, Observer, Options,
    OrderedCone, Preparation, Preview, Progress, Recipe, RefinedModel, Refining, SMALL_HOLE, Stage, TARGET_DISTORTION,
    TOLERABLE_DISTORTION, Times, Topology, unwrap_model,
};
pub use baseline::LscmError;
pub use curvature::{CurvatureError, CurvatureRule};
pub use cut::{SeamFigures, SeamOptions, Symmetry, Tiling};
pub use error::Error;
pub use flatten::{ScalingError, SeamError};
pub use placement::{MOST_OPTIMISED, MOST_ORDERED, Placement, Prediction, Search};
pub use topo::Kind;

/// What the laws in this workspace's tests are about, stage by stage. No part of the library: it changes without notice.
#[doc(hidden)]
pub mod internals {
    pub use crate::baseline::{Lscm, scale_linearly};
    pub use crate::curvature::{ConeCurvatures, cone_curvatures, least_cones};
    pub use crate::cut::SeamPlan;
    pub use crate::field::{ConformalFactor, Operators};
    pub use crate::flatten::{Chain, Corner, Layout, Patch, PatchTriangle, Scaling, SeamRotations, Seams, scale};
    pub use crate::hierarchy::ConeHierarchy;
    pub use crate::numerics::quadratic_program::{Held, ProgramError, Quadratic, minimise};
    pub use crate::placement::{ConeSet, EnergyModel, Nested, pursuit, refined};
}

/// The example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
