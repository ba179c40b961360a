//! What went in, what was done, what came out.

use geom::Repair;

use super::quality::{DistortionReport, IslandReport, Quality};
use crate::analysis::{Analysis, Atlas, ChosenNumber, Cone, Note, Options, RefinedModel};
use crate::cut::Tiling;
use crate::placement::Prediction;

/// The report of an unwrapping.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// What was mended in the input.
    pub repairs: Vec<RepairReport>,
    /// The refined model, if the surface was refined.
    pub refined: Option<RefinedReport>,
    /// Part by part, in the order in which they were placed.
    pub cones: Vec<Cone>,
    /// How they were placed, by [name](crate::Placement::name), or `given`.
    pub method: &'static str,
    /// How their curvatures were found, by [name](crate::CurvatureRule::name), or `given`.
    pub angles: &'static str,
    /// What was done where the layout lay over itself, by [name](crate::Islands::name).
    pub policy: &'static str,
    /// The extrema of the conformal factor.
    pub hierarchy: HierarchyReport,
    /// How the number of cones was found; nothing where it was given.
    pub number: Option<ChosenNumber>,
    /// Predicted distortion by number of cones, where that number was found.
    pub curve: Vec<Prediction>,
    /// Of the map as it is written.
    pub distortion: DistortionReport,
    /// Of the map as it is written.
    pub islands: Vec<IslandReport>,
    /// What the seams are like.
    pub seams: SeamReport,
    /// What was decided on the way, and what is wrong with the map: sentences, not to be parsed.
    pub warnings: Vec<String>,
}

impl Report {
    /// The report of an atlas that was measured.
    pub fn new(analysis: &Analysis, options: &Options, atlas: &Atlas, quality: &Quality) -> Self {
        Self {
            repairs: analysis.repairs().iter().map(RepairReport::from).collect(),
            refined: analysis.refined().map(RefinedReport::from),
            cones: atlas.cones.clone(),
            method: options.method_name(),
            angles: options.angles_name(),
            policy: options.islands.name(),
            hierarchy: HierarchyReport::new(analysis),
            // By the file's own triangles: the atlas has judged by those it was computed on, whose edges may be lengthened.
            number: atlas.number.clone().map(|number| number.judged(quality.distortion.area_mean)),
            curve: atlas.number.as_ref().map_or_else(Vec::new, |number| number.curve.clone()),
            distortion: quality.distortion.clone(),
            islands: quality.islands.clone(),
            seams: SeamReport::new(atlas),
            warnings: sentences(&atlas.notes, analysis.topology().components),
        }
    }
}

/// All notes as sentences, those of one of several components with its number.
pub fn sentences(notes: &[Note], components: usize) -> Vec<String> {
    let sentence = |note: &Note| match (note.component(), components) {
        (Some(component), 2..) => format!("part {}: {note}", component + 1),
        _ => note.to_string(),
    };
    notes.iter().map(sentence).collect()
}

/// The model that is written, where a surface was refined.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct RefinedReport {
    /// How many vertices it has.
    pub vertices: usize,
    /// How many triangles.
    pub faces: usize,
    /// Whether all triangles that are computed with are even.
    pub complete: bool,
    /// The input's face that each triangle is part of.
    pub face: Vec<u32>,
}

impl From<&RefinedModel> for RefinedReport {
    fn from(refined: &RefinedModel) -> Self {
        let RefinedModel { model, face, is_complete, .. } = refined;
        Self { vertices: model.vertex_count(), faces: model.face_count(), complete: *is_complete, face: face.clone() }
    }
}

/// Something that was mended.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct RepairReport {
    /// What was found and what was done.
    pub kind: &'static str,
    /// How often.
    pub count: usize,
    /// The first one.
    pub first: Element,
    /// All of that in words, in the singular for one.
    pub text: String,
}

/// An element of the input, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
pub enum Element {
    /// A vertex.
    Vertex(usize),
    /// A face.
    Face(usize),
}

impl From<&Repair> for RepairReport {
    fn from(repair: &Repair) -> Self {
        let place = if repair.kind.is_of_faces() { Element::Face } else { Element::Vertex };
        Self {
            kind: repair.kind.description(),
            count: repair.count,
            first: place(repair.first),
            text: repair.to_string(),
        }
    }
}

/// The extrema of the conformal factor.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct HierarchyReport {
    /// How many there are.
    pub extrema: usize,
    /// Their persistences, largest first.
    pub persistence: Vec<f64>,
}

impl HierarchyReport {
    /// Of what was analysed. O(extrema × log extrema).
    pub fn new(analysis: &Analysis) -> Self {
        let persistence: Vec<f64> = analysis.extrema().iter().map(|extremum| extremum.persistence).collect();
        Self { extrema: persistence.len(), persistence }
    }
}

/// Whether there are none: then that is not said.
#[cfg(feature = "serde")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_none(count: &usize) -> bool {
    *count == 0
}

/// What the seams of a map are like; how long they are is part of its distortion's report.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct SeamReport {
    /// By how much they turn from edge to edge, in all, in radians.
    pub turning: f64,
    /// The share of their length on edges that bend by more than 30°.
    pub sharp: f64,
    /// How many handles were opened along a loop each.
    pub opened_handles: usize,
    /// At how many necks thin limbs were cut off.
    pub necks: usize,
    /// How many holes were filled for computing.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "is_none"))]
    pub filled_holes: usize,
    /// On how many parts the two sides of seams differ.
    pub freed_parts: usize,
    /// By how much the lengths of both sides differ in the plane, over their mean, on average; 0 where seams are rigid.
    pub mismatch: f64,
    /// Across how many of them a texture keeps its directions; nothing where that was not asked for.
    pub tiling: Option<TilingReport>,
}

impl SeamReport {
    /// Of a map.
    pub fn new(atlas: &Atlas) -> Self {
        Self {
            turning: atlas.seam_figures.turning,
            sharp: atlas.seam_figures.sharp_share(),
            opened_handles: atlas.opened_handles,
            necks: atlas.necks,
            filled_holes: atlas.filled_holes,
            freed_parts: atlas.freed,
            mismatch: atlas.seam_figures.mean_mismatch(),
            tiling: atlas.tiling.as_ref().map(TilingReport::from),
        }
    }
}

/// Whether a texture keeps its directions across seams.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct TilingReport {
    /// The texture looks the same after this part of a turn.
    pub order: u32,
    /// How many pieces of seam there are.
    pub seams: usize,
    /// Across how many it does not.
    pub broken: usize,
    /// How far the others' rotations are from the texture's, in radians.
    pub error: f64,
}

impl From<&Tiling> for TilingReport {
    fn from(tiling: &Tiling) -> Self {
        let Tiling { symmetry, seams, broken, error, .. } = *tiling;
        Self { order: symmetry.order(), seams, broken, error }
    }
}
