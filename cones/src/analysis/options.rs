//! What a user may choose.

use geom::Weld;

use crate::curvature::CurvatureRule;
use crate::cut::{SeamOptions, Symmetry};
use crate::error::Error;
use crate::placement::{MOST_ORDERED, Placement, Search};
use crate::uv::{PackOptions, Rotations};

/// What reports call cones and curvatures that no method has found.
const GIVEN: &str = "given";

/// How a model is made ready.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Preparation {
    /// Which vertices are taken for one.
    pub weld: Weld,
    /// Diffuse the curvature before looking for extrema of the conformal factor, which helps on noisy scans.
    pub smooth: bool,
    /// Whether surfaces are refined until their triangles are even, whatever the model has: what is unwrapped is then the
    /// [refined model](crate::Analysis::refined).
    pub refine: Refining,
    /// Whether handles are opened along loops that take curvature.
    pub handles: Handles,
    /// The longest boundary loops that are filled for computing, in roots of the area of their part ([`SMALL_HOLE`](crate::SMALL_HOLE) is a good one); none where none is. A part is then
    /// unwrapped as if it had no such holes: no seam need run to one, an island may have holes, and all else is of the surface as it is.
    pub fill_holes: Option<f64>,
}

/// Boundary loops of up to so many roots of their part's area are small holes, where nothing else is said.
pub const SMALL_HOLE: f64 = 0.5;

/// Whether handles are opened: along short loops, each a seam whose sides have equal lengths but are not congruent. Each handle asks cones
/// for 4π of curvature otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Handles {
    /// Where [`Analysis::atlas`](crate::Analysis::atlas) finds that lengths are predicted to change much less with the cones chosen, or
    /// that far fewer cones are enough.
    #[default]
    Auto,
    /// They stay closed.
    Never,
    /// All are opened. Vertices on their loops can be no cones, and need not be.
    Always,
}

/// Whether thin limbs are cut off at their necks, as pieces that get cones of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Limbs {
    /// Where [`Analysis::atlas`](crate::Analysis::atlas) chooses the number of cones, those that it chooses first are predicted to distort areas by more than 1.5,
    /// the surface has dozens of tips, and nothing is said of where seams run.
    #[default]
    Auto,
    /// They stay on.
    Never,
}

/// Whether the two sides of a seam may differ; never where curvatures are [quantized](Options::quantize).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum FreeSeams {
    /// On components whose triangles are so coarse that rigid seams leave a quasi-conformal distortion above 1.1, or where areas miss their target; and along seams that are
    /// [given](crate::SeamOptions::given), whose sides have the same lengths where the map is conformal.
    #[default]
    Auto,
    /// They are congruent, but along opened handles and where needles were detached.
    Never,
    /// Angles and areas are kept as well as can be, whatever becomes of the seams.
    Always,
}

/// Whether surfaces are refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Refining {
    /// They stay as they are.
    #[default]
    Never,
    /// Where more than [`MOST_NEEDLES`](crate::MOST_NEEDLES) of the model's area is in needles that no flip removes; in
    /// [`Analysis::unwrapped`](crate::Analysis::unwrapped) also where that gives a map that is better, and angles would be bent.
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
    /// How thoroughly the best cones are looked for.
    pub search: Search,
    /// How cones get their curvatures.
    pub rule: CurvatureRule,
    /// What is done where the layout lies over itself.
    pub islands: Islands,
    /// Where seams should run.
    pub seams: SeamOptions,
    /// Whether curvatures are rounded to multiples of a texture's angle, so that it keeps its directions across seams; those that are given are not.
    pub quantize: Option<Symmetry>,
    /// Whether thin limbs are cut off where cones fail.
    pub limbs: Limbs,
    /// Whether seams stay rigid once islands are as they are to be.
    pub free_seams: FreeSeams,
    /// How islands are packed.
    pub packing: PackOptions,
}

/// What is done where a layout lies over itself. A flat metric can be laid out without a single fold-over and still do so, as a
/// long spiral does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Islands {
    /// Nothing: each connected component is one island, but for triangles that fold over; a note says how much lies over
    /// itself.
    Single,
    /// It is cut and put together again across other seams until nothing lies over itself, in as few islands as can be
    /// ([`uv`](crate::uv)). Of a model of several parts that then fills less than .6 of the square an island is cut, too, if a fiftieth of
    /// the seams lets it fill .04 more and nothing is said of where seams run.
    #[default]
    OverlapFree,
    /// The same, and it is cut further where islands then fill more of the square, within [`PackOptions::max_seam`].
    Pack,
}

impl Islands {
    /// Its name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::OverlapFree => "overlap-free",
            Self::Pack => "pack",
        }
    }
}

/// Which cones to use.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum ConeChoice {
    /// In each connected component as few as keep its area distortion within [`TARGET_DISTORTION`](crate::TARGET_DISTORTION),
    /// as predicted, at most [`MOST_AUTOMATIC`](crate::MOST_AUTOMATIC), or as many as keep it within
    /// [`TOLERABLE_DISTORTION`](crate::TOLERABLE_DISTORTION); where a few more leave nearly nothing to distort, as the corners of a
    /// box do, these; where no number does, and twice as many hardly leave less, fewer.
    #[default]
    Automatic,
    /// In each connected component as few as keep its area distortion within this, confirmed by flattening, at most
    /// [`MOST_OPTIMISED`](crate::MOST_OPTIMISED); 1 at least.
    WithinDistortion(f64),
    /// So many, on all connected components together.
    Count(usize),
    /// So many on each connected component, in the order of their first faces, or as many as it needs; none where the list ends.
    Each(Vec<usize>),
    /// All extrema of the conformal factor with a persistence above this, which must not be NaN.
    MinPersistence(f64),
    /// These vertices of the model, each with its curvature if that is given too (for all or for none). On coarse triangles, where seams are set
    /// [free](FreeSeams), angles at cones come out otherwise: with [`FreeSeams::Never`] just so.
    Given(Vec<(u32, Option<f64>)>),
    /// The cones of a map that was made, with what was done to its surface for them: the same map again.
    Recipe(Box<Recipe>),
}

/// A cone that is given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GivenCone {
    /// The vertex of the model.
    pub vertex: u32,
    /// Its curvature in radians, if that is given too: for all cones or for none.
    pub curvature: Option<f64>,
    /// A face with that vertex, where the surface has the vertex several times, as where two sheets touch there: the cone is on the
    /// sheet of this face.
    pub face: Option<u32>,
}

/// The cones of a map, and what was done to its surface before it was flattened with them: with the same preparation, seams and islands
/// [`ConeChoice::Recipe`] makes the same map again, but for rounding. [`Atlas::recipe`](crate::Atlas::recipe) has that of a map, [`Cones::recipe`](crate::Cones::recipe) that
/// of cones.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Recipe {
    /// The cones.
    pub cones: Vec<GivenCone>,
    /// How many vertices the model has that their numbers are of, to refuse those of another one: a [refined](crate::RefinedModel) one has more.
    pub vertices: Option<usize>,
    /// A face of each part whose handles were opened. It is heeded with [`Handles::Auto`].
    pub opened: Vec<u32>,
    /// The necks that thin limbs were cut off at, as chains of vertices of the model.
    pub necks: Vec<Vec<u32>>,
    /// Whether all vertices at one place were welded since no metric was found otherwise.
    pub welded: bool,
    /// Up to which length [holes were filled](Preparation::fill_holes), if some were.
    pub filled: Option<f64>,
    /// Whether the surface was opened along the seams that were given, and each chart flattened for itself.
    pub charts: bool,
    /// Whether seams are those that the model was refined for so that they are straight.
    pub straight: bool,
    /// A face of each part whose seams were set free since areas came out worse than was asked for and predicted.
    pub freed: Vec<u32>,
    /// The area distortion that was asked for, if one was.
    pub target: Option<f64>,
    /// What cones were asked for, where the model was refined by what the map of others of them was like: to refine it again so, that map is made first.
    pub refined_for: Option<Box<ConeChoice>>,
    /// How many vertices that model has: where it is refined otherwise with the options given, the map of that choice is taken itself.
    pub refined_from: Option<usize>,
}

impl ConeChoice {
    /// What makes a map again, where that was given.
    pub(super) fn recipe(&self) -> Option<&Recipe> {
        if let Self::Recipe(recipe) = self { Some(recipe) } else { None }
    }

    /// Whether seams are those that were made straight.
    pub(super) fn has_straight_seams(&self) -> bool {
        self.recipe().is_some_and(|recipe| recipe.straight)
    }

    /// At most how many cones are asked for.
    pub(super) fn most(&self) -> usize {
        if let Self::Count(count) = self { *count } else { usize::MAX }
    }

    /// The cones that are given, where they are.
    pub(super) fn given(&self) -> Option<Vec<GivenCone>> {
        match self {
            Self::Given(given) => {
                Some(given.iter().map(|&(vertex, curvature)| GivenCone { vertex, curvature, face: None }).collect())
            }
            Self::Recipe(recipe) => Some(recipe.cones.clone()),
            _ => None,
        }
    }
}

impl ConeChoice {
    /// Whether it says which vertices are cones.
    pub fn is_given(&self) -> bool {
        matches!(self, Self::Given(_) | Self::Recipe(_))
    }

    /// Refuses numbers that mean nothing.
    pub(super) fn check(&self) -> Result<(), Error> {
        match self {
            Self::WithinDistortion(target) if target.is_nan() || *target < 1.0 => Err(Error::TargetDistortion(*target)),
            Self::MinPersistence(threshold) if threshold.is_nan() => Err(Error::Threshold),
            _ => Ok(()),
        }
    }
}

impl Options {
    /// How cones are placed, in a word: the method's [name](Placement::name), or `given`.
    pub fn method_name(&self) -> &'static str {
        match self.cones {
            ConeChoice::Given(_) | ConeChoice::Recipe(_) => GIVEN,
            ConeChoice::MinPersistence(_) => Placement::Persistence.name(),
            _ => self.placement.name(),
        }
    }

    /// How their curvatures are found, in a word: the rule's [name](CurvatureRule::name), or `given`.
    pub fn angles_name(&self) -> &'static str {
        if self.gives_curvatures() { GIVEN } else { self.rule.name() }
    }

    /// Whether cones are given with their curvatures.
    pub fn gives_curvatures(&self) -> bool {
        self.cones.given().is_some_and(|given| given.iter().any(|cone| cone.curvature.is_some()))
    }

    /// How islands are packed: those of a texture that goes on across seams are not turned out of its directions, others have none.
    pub(crate) fn packing_for_texture(&self) -> PackOptions {
        let rotations = match (self.quantize, self.packing.rotations) {
            (Some(Symmetry::Fourfold), Rotations::Any) => Rotations::Quarter,
            (Some(Symmetry::Sixfold), _) => Rotations::None,
            (_, rotations) => rotations,
        };
        PackOptions { rotations, align: self.quantize.is_none(), ..self.packing }
    }

    /// Whether cones are searched for on the coarse level of a surface, where it has one.
    pub(super) fn searches_coarse_level(&self) -> bool {
        let is_searched = matches!(self.placement, Placement::Refined | Placement::Pursuit);
        let counts = match &self.cones {
            ConeChoice::Automatic | ConeChoice::WithinDistortion(_) => true,
            ConeChoice::Count(count) => *count <= MOST_ORDERED,
            ConeChoice::Each(counts) => counts.iter().any(|count| *count <= MOST_ORDERED),
            ConeChoice::MinPersistence(_) | ConeChoice::Given(_) | ConeChoice::Recipe(_) => false,
        };
        self.search == Search::CoarseToFine && is_searched && counts
    }

    /// The method that places so many cones on a component. A threshold of persistence speaks of extrema by persistence.
    pub(crate) fn placement_for(&self, count: usize) -> Placement {
        match self.cones {
            ConeChoice::MinPersistence(_) => Placement::Persistence,
            _ => self.placement.for_count(count),
        }
    }
}
