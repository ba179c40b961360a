//! An unwrapped model: what comes out of flattening all components.

use std::sync::Arc;

use geom::{FaceId, HalfedgeId, Repair, Surface, Triangles};

use super::cones::{ChosenNumber, Cone};
use super::note::Note;
use super::observer::Times;
use super::options::Recipe;
use super::refined::RefinedModel;
use crate::cut::{SeamFigures, Tiling};

/// The topology of a model's surfaces, added up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
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
    pub(crate) fn of<'a>(surfaces: impl IntoIterator<Item = &'a Surface>) -> Self {
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
#[non_exhaustive]
pub struct Atlas {
    /// A position in the plane for each corner of the model. On each part the mean of the log scale, weighted by area, is about 0: islands have
    /// more area than the surface, the more the greater the area distortion ([`uv_in`](Self::uv_in) has other sizes).
    pub uv: Vec<[f64; 2]>,
    /// The area of the surface.
    pub area: f64,
    /// What positions are multiplied by so that the tile is the unit square, or tiles are unit squares.
    pub scale: f64,
    /// How many tiles the islands are on.
    pub tiles: usize,
    /// The islands' areas, added up, over that of the tiles.
    pub fill: f64,
    /// The triangles that were computed with, as corners of the model.
    pub triangles: Triangles,
    /// The triangles that belong to no surface: copies lie where the triangle lies that they are copies of, others (repeated vertices, parts without
    /// area, copies of triangles in a plane with neighbours where these were refined) at one point.
    pub left_out: Vec<u32>,
    /// The island of each triangle, numbered from 0 component by component; none for those that belong to no surface.
    pub islands: Vec<Option<u32>>,
    /// The triangles that folded over and are islands of their own.
    pub detached: Vec<u32>,
    /// The cones that were used, component by component.
    pub cones: Vec<Cone>,
    /// The seams as chains of vertices of the model.
    pub seams: Vec<Vec<u32>>,
    /// How many handles were opened: so many of the seams, the last ones, are closed loops whose sides have equal lengths and are not
    /// congruent.
    pub opened_handles: usize,
    /// How many seams are necks where thin limbs were cut off: those before the opened handles.
    pub necks: usize,
    /// How many holes were [filled](crate::Preparation::fill_holes) for computing.
    pub filled_holes: usize,
    /// What the seams are like.
    pub seam_figures: SeamFigures,
    /// Across which seams a texture keeps its directions, where curvatures were to be [rounded](crate::Options::quantize) for it.
    pub tiling: Option<Tiling>,
    /// How the number of cones was found, where none was given.
    pub number: Option<ChosenNumber>,
    /// The largest curvature off the cones that the cone metric has, in radians. Where seams were set [free](crate::FreeSeams) afterwards angles along
    /// them are other ones: what is written is measured by [`report`](crate::report).
    pub curvature_error: f64,
    /// How many components, or pieces of one whose limbs were cut off, no cones could flatten: these are unfolded with a cone at every vertex, cut to shreds.
    pub unfolded: usize,
    /// On how many components, or pieces, the two sides of seams differ, as with [free seams](crate::FreeSeams) and where triangles folded over.
    pub freed: usize,
    /// The time each stage took.
    pub times: Times,
    /// What the user should know.
    pub notes: Vec<Note>,
    /// What was repaired in the model.
    pub repairs: Vec<Repair>,
    /// The model that the map is of, where that is [another one](crate::Analysis::refined) than was given: vertices, corners and triangles are its.
    pub refined: Option<Arc<RefinedModel>>,
    pub(crate) recipe: Recipe,
    /// The triangles of components that lay over others before islands were parted.
    pub(crate) overlapped: Vec<(usize, FaceId)>,
    /// The edges that seams run along, if no limbs were cut off.
    pub(crate) cut: Vec<CutEdge>,
    /// The components that are unfolded, or on which the two sides of seams differ.
    pub(crate) torn: Vec<usize>,
}

/// An edge that a seam runs along.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutEdge {
    pub(crate) component: usize,
    /// One of its sides: where handles are opened, edges get other numbers, and halfedges keep theirs.
    pub(crate) halfedge: HalfedgeId,
    /// Whether it is of a loop that a handle was opened along.
    pub(crate) is_loop: bool,
}

impl Atlas {
    /// What makes it again.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }
}
