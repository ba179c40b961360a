//! Why something that was asked for cannot be had.

use geom::distortion::DistortionError;
use geom::{Interrupted, ModelError, PoissonError, PrepareError, are, counted};
use thiserror::Error;

use crate::baseline::LscmError;
use crate::curvature::CurvatureError;
use crate::flatten::{ScalingError, SeamError};
use crate::uv::{PackError, PartError, readable};

/// Why a model cannot be analysed, its cones placed, or flattened.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The model has no surface.
    #[error(transparent)]
    Prepare(PrepareError),
    /// There is no such model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A map cannot be measured.
    #[error(transparent)]
    Measure(DistortionError),
    /// Fewer cones distort less than nothing.
    #[error("an area distortion of {} cannot be had: it is 1 at least", readable(*.0))]
    TargetDistortion(f64),
    /// A threshold that no extremum is above or below of.
    #[error("the threshold of persistence is NaN")]
    Threshold,
    /// The refined model is too large.
    #[error("the refined model cannot be had")]
    Refined(#[source] ModelError),
    /// No cones flatten a component in the even triangles that it was refined to; [`Analysis::unwrapped`](crate::Analysis::unwrapped) then takes
    /// the model as it is.
    #[error("no cones flatten part {} in even triangles: do not refine it", .component + 1)]
    NotFlatRefined {
        /// The component, counted from 0.
        component: usize,
    },
    /// A Laplacian cannot be factored.
    #[error(transparent)]
    Poisson(PoissonError),
    /// The cones cannot take the surface's curvature.
    #[error(transparent)]
    Curvature(CurvatureError),
    /// The surface cannot be cut open.
    #[error(transparent)]
    Seams(SeamError),
    /// No metric with these cones was found.
    #[error(transparent)]
    Scaling(ScalingError),
    /// The islands cannot be packed.
    #[error(transparent)]
    Pack(PackError),
    /// There is no least-squares conformal map.
    #[error(transparent)]
    Lscm(#[from] LscmError),
    /// A given cone is no vertex of a surface.
    #[error("cone {vertex} is not a vertex of any face (vertices are numbered from 0 to {}; cones of a refined map are vertices of what was written)", count.saturating_sub(1))]
    NoSuchCone {
        /// The vertex that was given.
        vertex: u32,
        /// How many vertices the model has.
        count: usize,
    },
    /// A given cone is no vertex of the face that it was given with.
    #[error("cone {vertex} is no vertex of face {face} (counted from 0)")]
    NotAtFace {
        /// The vertex that was given.
        vertex: u32,
        /// The face.
        face: u32,
    },
    /// A recipe is that of another model.
    #[error(
        "the cones are of a model of {}, and this one has {count}: give them with the mesh that they were found on, or, where that was refined, with what was written",
        counted(*vertices, "vertex", "vertices")
    )]
    OtherModel {
        /// How many vertices its model has.
        vertices: usize,
        /// How many this one has.
        count: usize,
    },
    /// Necks are no edges of the surface's, or do not part it.
    #[error(
        "the necks that limbs are to be cut off at do not part the surface: give them with the mesh that they were found on, prepared alike"
    )]
    NoNecks,
    /// A cone was given twice.
    #[error("cone {0} is given twice")]
    RepeatedCone(u32),
    /// A cone was given on the boundary.
    #[error("cone {0} lies on the boundary, where no cone is needed: choose an inner vertex")]
    ConeOnBoundary(u32),
    /// Numbers of cones were given for more components than there are.
    #[error("{} given, but there {}: give one for each, in the order of their first faces", counted(*numbers, "number of cones is", "numbers of cones are"), are(*parts, "part", "parts"))]
    NumbersWithoutParts {
        /// How many numbers.
        numbers: usize,
        /// How many components there are.
        parts: usize,
    },
    /// Some cones were given curvatures and others not.
    #[error("of {given} cones {} given with a curvature: give one for all of them, or for none", counted(*known, "is", "are"))]
    SomeCurvatures {
        /// How many have a curvature.
        known: usize,
        /// How many cones there are.
        given: usize,
    },
    /// Given curvatures break Gauss–Bonnet.
    #[error("the given curvatures{} sum to {sum:.9}, but on {} closed surface they must sum to 2πχ = {total:.9}: {}", part.map_or_else(String::new, |part| format!(" of part {}", part + 1)), if part.is_some() { "that" } else { "this" }, if *has_handles { "those found with opened handles may not, open them again" } else { "give none, and the best ones are taken" })]
    CurvatureSum {
        /// The component, counted from 0, if there are several.
        part: Option<usize>,
        /// What they sum to.
        sum: f64,
        /// What they should.
        total: f64,
        /// Whether it has handles, which may be [opened](crate::Handles).
        has_handles: bool,
    },
    /// A cone was given at the rim of a small hole.
    #[error(
        "cone {0} lies on the rim of a small hole, where no cone is needed unless small holes are filled (--fill-holes): fill them, or choose an inner vertex"
    )]
    ConeAtHole(u32),
    /// Cones were given that do not take the curvature of a surface whose small holes are filled.
    #[error("these cones do not go with small holes that are filled: leave --fill-holes out, or choose others")]
    ConesForHoles,
    /// The cones of a recipe are of a surface with its small holes filled.
    #[error("these cones are of a surface with small holes filled: fill them, too (--fill-holes={})", readable(*.0))]
    NotFilled(f64),
    /// The cones of a recipe are of a surface opened along other seams than are given, or none are.
    #[error("these cones are of a surface that was opened along the seams that were given: give the same seams")]
    OtherSeams,
    /// A given curvature leaves no angle.
    #[error("a cone's curvature must be less than 2π, but {} is given", readable(*.0))]
    CurvatureTooLarge(f64),
    /// Cones were asked about that another analysis has placed.
    #[error("these cones are of another analysis: give their vertices to this one")]
    ForeignCones,
    /// An edge for seams, or without, is none of the model's.
    #[error("there is no edge from vertex {} to {} (counted from 0): seams run along edges of faces{}", ends[0], ends[1], if *is_refined { ", and these are even triangles, which have other edges" } else { "" })]
    NoSuchEdge {
        /// Its vertices.
        ends: [u32; 2],
        /// Whether the surface was [refined](crate::Refining) before edges were named.
        is_refined: bool,
    },
    /// The observer has said stop.
    #[error("interrupted")]
    Interrupted,
}

impl From<Interrupted> for Error {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// What was interrupted says so in one way.
macro_rules! from {
    ($($error:ident => $variant:ident),*) => {
        $(impl From<$error> for Error {
            fn from(error: $error) -> Self {
                match error {
                    $error::Interrupted(_) => Self::Interrupted,
                    error => Self::$variant(error),
                }
            }
        })*
    };
}

from!(DistortionError => Measure, PrepareError => Prepare, PackError => Pack, PoissonError => Poisson, CurvatureError => Curvature, SeamError => Seams, ScalingError => Scaling);

impl From<PartError> for Error {
    fn from(error: PartError) -> Self {
        match error {
            PartError::Prepare(error) => error.into(),
            PartError::TextureCount { found, corners } => Self::Model(ModelError::TextureCount { found, corners }),
            PartError::Interrupted(interrupted) => interrupted.into(),
        }
    }
}
