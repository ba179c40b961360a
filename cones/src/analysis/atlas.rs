//! What comes out of the method: an unwrapped model, or its cones alone.

use std::time::Duration;

use geom::{Repair, Surface, Triangles};
use topo::Kind;

use crate::distortion::Predicted;
use crate::order::ConeOrder;

/// The stages, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// The model is made into surfaces.
    Prepare,
    /// Intrinsic Delaunay triangulation, Laplacian, its factorization.
    Factor,
    /// The conformal factor, its persistent extrema, the cones' curvatures.
    Hierarchy,
    /// Seams through the cones.
    Cut,
    /// Newton's method for the metric.
    Scale,
    /// Positions in the plane, mended.
    Layout,
}

impl Stage {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Prepare, Self::Factor, Self::Hierarchy, Self::Cut, Self::Scale, Self::Layout];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Prepare => "prepare",
            Self::Factor => "factor",
            Self::Hierarchy => "hierarchy",
            Self::Cut => "cut",
            Self::Scale => "scale",
            Self::Layout => "layout",
        }
    }
}

/// A cone of an unwrapped model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The vertex of the model.
    pub vertex: u32,
    /// Where it is.
    pub position: [f64; 3],
    /// The kind of extremum it is; where it is none, what its curvature says: a minimum if positive.
    pub kind: Kind,
    /// The persistence of the extremum, if it is one.
    pub persistence: Option<f64>,
    /// Its curvature in radians: the cone's angle is 2π less this.
    pub curvature: f64,
}

/// How the number of cones was found, where none was given.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberOfCones {
    /// The area distortion that was aimed at.
    pub target: f64,
    /// How many cones were chosen for it; others were taken where these could not be flattened.
    pub chosen: usize,
    /// What is predicted for the cones that were chosen, in all connected parts together.
    pub predicted: f64,
    /// Whether the prediction meets the target in every part.
    pub is_met: bool,
    /// What is predicted for every number of cones in a nested order, as far as they are enough for all parts.
    pub curve: Vec<Predicted>,
}

/// The topology of a model's surfaces, added up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Vertices, copies included.
    pub vertices: usize,
    /// Triangles.
    pub faces: usize,
    /// Connected components.
    pub components: usize,
    /// Boundary loops.
    pub boundary_loops: usize,
    /// The sum of the components' genera.
    pub genus: usize,
    /// V - E + F.
    pub euler: i64,
}

impl Topology {
    /// The topology of prepared surfaces.
    pub fn of<'a>(surfaces: impl IntoIterator<Item = &'a Surface>) -> Self {
        surfaces.into_iter().map(|s| &s.mesh).fold(Self::default(), |sum, mesh| Self {
            vertices: sum.vertices + mesh.vertex_count(),
            faces: sum.faces + mesh.face_count(),
            components: sum.components + 1,
            boundary_loops: sum.boundary_loops + mesh.boundary_loops().len(),
            genus: sum.genus + mesh.genus(),
            euler: sum.euler + mesh.euler_characteristic(),
        })
    }
}

/// An unwrapped model.
#[derive(Clone, Debug)]
pub struct Atlas {
    /// A position in the plane for each corner of the model. The total area is that of the surface.
    pub uv: Vec<[f64; 2]>,
    /// The triangles that were computed with.
    pub triangles: Triangles,
    /// The triangles that belong to no surface (repeated vertices, copies); their corners have their vertices' positions.
    pub left_out: Vec<u32>,
    /// The cones, component by component, in the order of the hierarchy.
    pub cones: Vec<Cone>,
    /// The seams as chains of vertices of the model.
    pub seams: Vec<Vec<u32>>,
    /// The conformal factor φ for each vertex of the model; NaN where it is on no surface.
    pub factor: Vec<f64>,
    /// The number of extrema of φ, and the persistences of all of them, descending.
    pub persistence: Vec<f64>,
    /// How the number of cones was found, where none was given.
    pub number: Option<NumberOfCones>,
    /// The order of the cones for every number of them, where it was asked for.
    pub order: Option<ConeOrder>,
    /// The shape of the model.
    pub topology: Topology,
    /// The largest curvature off the cones that the metric has, in radians.
    pub curvature_error: f64,
    /// How many connected parts no cones could flatten: these are unfolded with a cone at every vertex, cut to shreds.
    pub unfolded: usize,
    /// The time each stage took.
    pub times: Vec<(Stage, Duration)>,
    /// What was mended in the model.
    pub repairs: Vec<Repair>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// The cones of a model without a flattening.
#[derive(Clone, Debug)]
pub struct Extraction {
    /// The cones, component by component, in the order of the hierarchy.
    pub cones: Vec<Cone>,
    /// The conformal factor φ for each vertex of the model; NaN where it is on no surface.
    pub factor: Vec<f64>,
    /// The persistences of all extrema of φ, descending.
    pub persistence: Vec<f64>,
    /// How the number of cones was found, where none was given.
    pub number: Option<NumberOfCones>,
    /// The order of the cones for every number of them, where it was asked for.
    pub order: Option<ConeOrder>,
    /// The shape of the model.
    pub topology: Topology,
    /// The time each stage took.
    pub times: Vec<(Stage, Duration)>,
    /// What was mended in the model.
    pub repairs: Vec<Repair>,
    /// What the user should know.
    pub warnings: Vec<String>,
}
