//! What a user may choose.

use crate::curvature::CurvatureRule;
use crate::placement::Placement;

/// How a model is made ready.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Preparation {
    /// Merge vertices that are at exactly the same place.
    pub weld: bool,
    /// Diffuse the curvature before looking for extrema of the conformal factor, which helps on noisy scans.
    pub smooth: bool,
    /// Whether surfaces are refined until their triangles are even, whatever the model has: what is unwrapped is then the
    /// [refined model](crate::Analysis::refined).
    pub refine: Refining,
}

/// Whether surfaces are refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Refining {
    /// They stay as they are.
    #[default]
    Never,
    /// Where more than [`MOST_NEEDLES`](crate::MOST_NEEDLES) of the model's area is in needles that no flip removes.
    Needles,
    /// Always.
    Always,
}

/// Which cones to use, and how a model is made ready for them.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Options {
    /// How the model is made ready; an [`Analysis`](crate::Analysis) has been already.
    pub preparation: Preparation,
    /// Which cones.
    pub cones: ConeChoice,
    /// How cones are placed.
    pub placement: Placement,
    /// How cones get their curvatures.
    pub rule: CurvatureRule,
}

/// Which cones to use.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum ConeChoice {
    /// In each connected component as few as keep its area distortion within [`TARGET_DISTORTION`](crate::TARGET_DISTORTION),
    /// as predicted, at most [`MOST_AUTOMATIC`](crate::MOST_AUTOMATIC); where a few more leave nearly nothing to distort, as the
    /// corners of a box do, these.
    #[default]
    Automatic,
    /// In each connected component as few as keep its area distortion within this, confirmed by flattening, at most
    /// [`MOST_OPTIMISED`](crate::MOST_OPTIMISED).
    WithinDistortion(f64),
    /// So many, on all connected components together.
    Count(usize),
    /// So many on each connected component, in the order of their first faces; none where the list ends.
    Each(Vec<usize>),
    /// All extrema of the conformal factor with a persistence above this.
    MinPersistence(f64),
    /// These vertices of the model, each with its curvature if that is given too (for all or for none).
    Given(Vec<(u32, Option<f64>)>),
}

impl Options {
    /// The method that places so many cones on a component. A threshold of persistence speaks of extrema by persistence.
    pub(crate) fn placement_for(&self, count: usize) -> Placement {
        match self.cones {
            ConeChoice::MinPersistence(_) => Placement::Persistence,
            _ => self.placement.for_count(count),
        }
    }
}
