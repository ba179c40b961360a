//! What a user may choose.

use crate::angles::Angles;
use crate::hierarchy::Method;

/// What to do.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Which cones.
    pub cones: ConeChoice,
    /// The order in which extrema become cones.
    pub method: Method,
    /// How cones get their curvatures.
    pub angles: Angles,
    /// Diffuse the curvature before looking for extrema, which helps on noisy scans.
    pub smooth: bool,
    /// Also find the order of cones for every number of them: [`ConeOrder`](crate::ConeOrder).
    pub order: bool,
    /// Merge vertices that are at exactly the same place.
    pub weld: bool,
}

/// Which cones to use.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ConeChoice {
    /// In each connected part as few as keep its area distortion within [`TARGET_DISTORTION`](crate::TARGET_DISTORTION), as
    /// predicted, at most [`MOST_AUTOMATIC`](crate::MOST_AUTOMATIC).
    #[default]
    Automatic,
    /// In each connected part as few as keep its area distortion within this, confirmed by flattening, at most 64.
    WithinDistortion(f64),
    /// The first so many of the hierarchy, in all connected parts together.
    Count(usize),
    /// All extrema with a persistence above this.
    MinPersistence(f64),
    /// These vertices of the model, each with its curvature if that is given too (for all or for none).
    Given(Vec<(u32, Option<f64>)>),
}
