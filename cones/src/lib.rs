//! Cone-based conformal unwrapping by conformal factor persistence.
//!
//! A conformal map of a surface to the plane keeps angles and stretches lengths, by e^u with a log scale factor u that can
//! vary wildly. Letting a few vertices, the *cones*, keep curvature makes u nearly constant. This crate finds cones, cuts
//! the surface open through them, and lays it out: A. Vintescu, F. Dupont, G. Lavoué, P. Memari and J. Tierny, "Conformal
//! Factor Persistence for Fast Hierarchical Cone Extraction" (Eurographics 2017), called *the paper* here, and what goes
//! beyond it.
//!
//! # The method
//!
//! 1. **Conformal factor** ([`ConformalFactor`], §3.1 of the paper). With the cotangent Laplacian L of the intrinsic Delaunay
//!    triangulation and the angle defects K, solve Lφ = K^T - K for the target curvature K^T that is spread evenly:
//!    2πχ times each vertex's share of the area. φ is the log scale that evens curvature out: low at tips, high at saddles.
//!    One factorization ([`Operators`]) serves this and everything that follows up to the flattening.
//! 2. **Hierarchy** ([`ConeHierarchy`], §3.2). The local extrema of φ, each paired with the saddle where its component of
//!    the sub- or superlevel set joins an elder one, ranked by persistence |φ(extremum) - φ(saddle)| ([`topo`]).
//! 3. **Curvatures** ([`cone_curvatures`]). *Harmonic*: those of the φ that is 0 at all cones. *Optimal*: those for which the
//!    L2 norm of u is least, between bounds that keep the cone buildable.
//! 4. **Cut** ([`Seams`], §2). A minimum spanning tree of the cones' distances, and loops for handles and boundaries: the
//!    surface opens to a disk.
//! 5. **Metric scaling** ([`scale`]). Newton's method on the convex energy of discrete conformal maps finds the u for which
//!    curvature is k at the cones and 0 elsewhere, exactly.
//! 6. **Layout** ([`Layout`]). The flat metric, brought back to the input's triangles, developed into the plane; the few
//!    triangles that come out flipped are mended.
//!
//! [`unwrap()`] does all of it:
//!
//! ```
//! use cones::{ConeChoice, Options, unwrap};
//!
//! let model = geom::shapes::by_name("capsule", 500).expect("it is built in").into();
//! let options = Options { cones: ConeChoice::Count(4), ..Options::default() };
//! let atlas = unwrap(&model, &options, &mut |_stage| {})?;
//! assert_eq!(atlas.cones.len(), 4);
//! assert_eq!(atlas.uv.len(), model.corner_count());
//! let total: f64 = atlas.cones.iter().map(|cone| cone.curvature).sum();
//! assert!((total - 4.0 * std::f64::consts::PI).abs() < 1e-9);
//! # Ok::<(), cones::Error>(())
//! ```
//!
//! Curvature is an angle defect in radians: a cone of curvature k has 2π - k of angle. L is positive semidefinite.
//! Everything is deterministic. The feature `cli` (on by default) is for the command only; libraries turn it off.

mod angles;
mod atlas;
mod automatic;
mod component;
mod crowd;
mod dense;
mod detach;
mod distance;
mod distortion;
mod error;
mod exchange;
mod factor;
mod fit;
mod grow;
mod hierarchy;
mod iterative;
mod layout;
mod lbfgs;
mod linear;
mod lscm;
mod mend;
mod operators;
mod options;
mod order;
mod pinned;
mod pursuit;
mod reduced;
mod refined;
mod scaling;
mod seams;
mod settled;
mod share;
mod shelf;
mod swap;
mod untangle;
mod unwrap;

pub use angles::{Angles, AnglesError, ConeCurvatures, cone_curvatures, least_cones};
pub use atlas::{Atlas, Cone, Extraction, NumberOfCones, Stage, Topology};
pub use automatic::{Automatic, MOST_AUTOMATIC, TARGET_DISTORTION, automatic, shortest};
pub use distortion::{Predicted, area_distortion, predict};
pub use error::Error;
pub use factor::ConformalFactor;
pub use fit::{Fit, FitError, Held, Quadratic, fit};
pub use hierarchy::{Candidate, ConeHierarchy, Method};
pub use iterative::{greedy, iterative, iterative_refactoring};
pub use layout::Layout;
pub use linear::{LinearScaling, scale_linearly};
pub use lscm::{Lscm, LscmError};
pub use mend::MendError;
pub use operators::Operators;
pub use options::{ConeChoice, Options};
pub use order::{ConeOrder, ModelExtremum, OrderedCone};
pub use pursuit::{Nested, pursuit};
pub use reduced::{Fitted, Reduced};
pub use refined::refined;
pub use scaling::{Scaling, ScalingError, scale};
pub use seams::{Chain, SeamError, Seams};
pub use share::{Part, sequence, share_out};
pub use topo::Kind;
pub use untangle::{Corner, Patch, PatchError, PatchTriangle, Untangled};
pub use unwrap::{extract, unwrap};
