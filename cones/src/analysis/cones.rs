//! The cones of a model.

use geom::{VertexData, VertexId};
use topo::Kind;

use super::note::Note;
use super::observer::Times;
use super::options::Recipe;
use crate::curvature::CurvatureRule;
use crate::cut::Symmetry;
use crate::placement::{Placement, Prediction};

/// A cone: a vertex that keeps curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Cone {
    /// The connected component that it is on.
    pub component: usize,
    /// The vertex of the model.
    pub vertex: u32,
    /// Where it is.
    pub position: [f64; 3],
    /// The kind of extremum of the conformal factor it is; where it is none, what its curvature says: a minimum if positive,
    /// since φ is low where the surface sticks out.
    #[cfg_attr(feature = "serde", serde(serialize_with = "kind_name"))]
    pub kind: Kind,
    /// The persistence of the extremum, if it is one.
    pub persistence: Option<f64>,
    /// Its curvature in radians: the cone's angle is 2π less this.
    pub curvature: f64,
}

#[cfg(feature = "serde")]
pub(super) fn kind_name<S: serde::Serializer>(kind: &Kind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.name())
}

/// How the number of cones was found, where none was given.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ChosenNumber {
    /// The area distortion that was aimed at.
    pub target: f64,
    /// How many cones were chosen for it; once the model is flattened, how many were taken in the end.
    pub chosen: usize,
    /// The area distortion that is predicted for them, in all connected components together.
    #[cfg_attr(feature = "serde", serde(rename = "predicted_area"))]
    pub predicted: f64,
    /// Whether the target is met: in every component by what is predicted, and once the model is flattened by the map.
    #[cfg_attr(feature = "serde", serde(rename = "met"))]
    pub is_met: bool,
    /// What is predicted for every number of cones in a nested order, as far as they are enough for all components.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub curve: Vec<Prediction>,
}

/// A measured area distortion counts as within a target if it is when printed with two decimals.
pub(super) const ROUNDING: f64 = 0.005;

impl ChosenNumber {
    /// The same with what was measured.
    pub(crate) fn judged(self, area_distortion: f64) -> Self {
        Self { is_met: area_distortion <= self.target + ROUNDING, ..self }
    }
}

/// The cones of a model, with their curvatures and what is predicted for them.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Cones {
    pub(crate) cones: Vec<Cone>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) recipe: Recipe,
    pub(crate) placement: Option<Placement>,
    pub(crate) rule: CurvatureRule,
    pub(crate) prediction: Prediction,
    pub(crate) number: Option<ChosenNumber>,
    /// Of all components together first, then of each.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) notes: Vec<Note>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) times: Times,
    /// What the analysis that has placed them knows of them, component by component.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) configurations: Vec<Configuration>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) analysis: usize,
    /// What their curvatures were rounded for.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) quantize: Option<Symmetry>,
}

/// The cones of one component.
#[derive(Clone, Debug)]
pub(crate) struct Configuration {
    pub(crate) vertices: Vec<VertexId>,
    pub(crate) curvature: Vec<f64>,
    /// The log scale factor that linear theory predicts.
    pub(crate) predicted: VertexData<f64>,
    pub(crate) notes: Vec<Note>,
}

impl Configuration {
    /// Whether it has the same cones as that of another component of the same shape, with the same curvatures, and the same is said of them.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let said = |of: &Self| of.notes.iter().map(|note| note.clone().said_of(0, |_| 0)).collect::<Vec<Note>>();
        self.vertices == other.vertices && self.curvature == other.curvature && said(self) == said(other)
    }
}

impl Cones {
    /// The cones, component by component, in the order in which they were placed.
    pub fn as_slice(&self) -> &[Cone] {
        &self.cones
    }

    /// The cones, component by component, in the order in which they were placed.
    pub fn iter(&self) -> std::slice::Iter<'_, Cone> {
        self.cones.iter()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.cones.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.cones.is_empty()
    }

    /// The method that has placed them; none where they were given.
    pub fn placement(&self) -> Option<Placement> {
        self.placement
    }

    /// The rule that was asked to give them their curvatures.
    pub fn rule(&self) -> CurvatureRule {
        self.rule
    }

    /// What linear theory predicts for them.
    pub fn prediction(&self) -> Prediction {
        self.prediction
    }

    /// How their number was found, where none was given.
    pub fn number(&self) -> Option<&ChosenNumber> {
        self.number.as_ref()
    }

    /// What makes a map with them again.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// What the user should know of how they were chosen.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// The time that placing them took.
    pub fn times(&self) -> Times {
        self.times
    }
}

impl<'a> IntoIterator for &'a Cones {
    type Item = &'a Cone;
    type IntoIter = std::slice::Iter<'a, Cone>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
