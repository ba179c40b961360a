//! An unwrapped model as a dictionary of arrays, with the command's report.

use cones::{Analysis, Atlas, Cone, Note, Options, RefinedModel, Stage, Tiling, Topology};
use geom::{Model, Repair};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use pythonize::pythonize;
use serde::Serialize;

use crate::array::from_rows;
use crate::error::Error;
use crate::quality::Quality;
use crate::uv::{corner_uv, welded};

/// Size of the texture coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Scale {
    /// The tile is the unit square.
    Unit,
    /// Areas are those of the surface.
    Area,
    /// As computed.
    None,
}

impl Scale {
    /// By its name on the command line.
    pub(crate) fn by_name(name: &str) -> PyResult<Self> {
        match name {
            "unit" => Ok(Self::Unit),
            "area" => Ok(Self::Area),
            "none" => Ok(Self::None),
            other => Err(Error::new_err(format!("scale is unit, area or none, not {other:?}"))),
        }
    }

    /// The texture coordinates in this size.
    fn of(self, atlas: &Atlas) -> Vec<[f64; 2]> {
        let low = atlas.uv.iter().fold([f64::INFINITY; 2], |low, uv| [0, 1].map(|k| uv[k].min(low[k])));
        let place = |uv: &[f64; 2]| match self {
            Self::Unit => uv.map(|x| x * atlas.scale),
            Self::Area => [0, 1].map(|k| uv[k] - low[k]),
            Self::None => *uv,
        };
        atlas.uv.iter().map(place).collect()
    }
}

/// The command's report, but for what a file and a program have.
#[derive(Serialize)]
struct Report<'a> {
    schema: u32,
    input: Topology,
    repairs: Vec<RepairReport>,
    refined: Option<RefinedReport>,
    cones: &'a [Cone],
    method: &'static str,
    angles: &'static str,
    policy: &'static str,
    number: Option<&'a cones::ChosenNumber>,
    curve: &'a [cones::Prediction],
    #[serde(flatten)]
    quality: &'a Quality,
    seams: SeamReport,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct RefinedReport {
    vertices: usize,
    faces: usize,
    complete: bool,
}

#[derive(Serialize)]
struct RepairReport {
    kind: &'static str,
    count: usize,
    first: Element,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Element {
    Vertex(usize),
    Face(usize),
}

#[derive(Serialize)]
struct SeamReport {
    turning: f64,
    sharp: f64,
    opened_handles: usize,
    tiling: Option<TilingReport>,
}

#[derive(Serialize)]
struct TilingReport {
    order: u32,
    seams: usize,
    broken: usize,
    error: f64,
}

/// A map with what it is worth, ready to be handed over.
pub(crate) struct Measured {
    atlas: Atlas,
    uv: Vec<[f64; 2]>,
    quality: Quality,
    flaw: Option<String>,
}

impl Measured {
    /// Scales and measures a map; `model` is the one that was unwrapped.
    ///
    /// # Errors
    /// If it cannot be measured.
    pub(crate) fn new(
        model: &Model,
        atlas: Atlas,
        options: &Options,
        scale: Scale,
    ) -> Result<Self, geom::distortion::DistortionError> {
        let uv = scale.of(&atlas);
        let mut is_kept = vec![true; atlas.triangles.len()];
        atlas.left_out.iter().for_each(|&t| is_kept[t as usize] = false);
        let triangles: Vec<[u32; 3]> =
            atlas.triangles.corners.iter().zip(is_kept).filter_map(|(&t, kept)| kept.then_some(t)).collect();
        let mut vertices: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|c| model.corners()[c as usize])).collect();
        let mut cones: Vec<u32> = atlas.cones.iter().map(|cone| cone.vertex).collect();
        if options.preparation.weld {
            let first = welded(model);
            vertices.iter_mut().flatten().chain(&mut cones).for_each(|v| *v = first[*v as usize]);
        }
        let quality = Quality::measure(model.points(), &vertices, &corner_uv(&triangles, &uv), Some(&cones))?;
        let flaw = flaw(model, &quality, &triangles);
        Ok(Self { atlas, uv, quality, flaw })
    }

    /// The dictionary.
    pub(crate) fn into_dict<'py>(
        self,
        py: Python<'py>,
        analysis: &Analysis,
        options: &Options,
    ) -> PyResult<Bound<'py, PyDict>> {
        let report = pythonize(py, &self.report(analysis, options))?;
        report.set_item("times", times(py, &[analysis.times(), self.atlas.times])?)?;
        let Self { atlas, uv, .. } = self;
        let answer = PyDict::new(py);
        answer.set_item("report", report)?;
        answer.set_item("uv", from_rows(py, uv)?)?;
        answer.set_item("triangles", from_rows(py, atlas.triangles.corners)?)?;
        answer.set_item("triangle_face", PyArray1::from_vec(py, atlas.triangles.face_of))?;
        let island = atlas.islands.iter().map(|island| island.map_or(-1, i64::from)).collect();
        answer.set_item("triangle_island", PyArray1::from_vec(py, island))?;
        let seams = atlas.seams.into_iter().map(|seam| PyArray1::from_vec(py, seam));
        answer.set_item("seams", PyList::new(py, seams)?)?;
        answer.set_item("detached", PyArray1::from_vec(py, atlas.detached))?;
        answer.set_item("left_out", PyArray1::from_vec(py, atlas.left_out))?;
        answer.set_item("tiles", atlas.tiles)?;
        answer.set_item("fill", atlas.fill)?;
        answer.set_item("unit", atlas.scale)?;
        answer.set_item("curvature_error", atlas.curvature_error)?;
        Ok(answer)
    }

    fn report(&self, analysis: &Analysis, options: &Options) -> Report<'_> {
        let atlas = &self.atlas;
        let components = analysis.topology().components;
        Report {
            schema: 1,
            input: analysis.topology(),
            repairs: analysis.repairs().iter().map(RepairReport::from).collect(),
            refined: analysis.refined().map(RefinedReport::from),
            cones: &atlas.cones,
            method: options.placement.name(),
            angles: if options.rule == cones::CurvatureRule::Harmonic { "harmonic" } else { "optimal" },
            policy: if options.islands == cones::Islands::Single { "single" } else { "overlap-free" },
            number: atlas.number.as_ref(),
            curve: atlas.number.as_ref().map_or(&[], |number| &number.curve),
            quality: &self.quality,
            seams: SeamReport {
                turning: atlas.seam_figures.turning,
                sharp: atlas.seam_figures.sharp_share(),
                opened_handles: atlas.opened_handles,
                tiling: atlas.tiling.as_ref().map(TilingReport::from),
            },
            warnings: sentences(&atlas.notes, components).into_iter().chain(self.flaw.clone()).collect(),
        }
    }
}

/// All notes as sentences, those of one part of several with its number.
pub(crate) fn sentences(notes: &[Note], components: usize) -> Vec<String> {
    let sentence = |note: &Note| match (note.component(), components) {
        (Some(component), 2..) => format!("part {}: {note}", component + 1),
        _ => note.to_string(),
    };
    notes.iter().map(sentence).collect()
}

/// Seconds by stage, of several pieces of work.
pub(crate) fn times<'py>(py: Python<'py>, times: &[cones::Times]) -> PyResult<Bound<'py, PyDict>> {
    let seconds = PyDict::new(py);
    for stage in Stage::ALL {
        let time: f64 = times.iter().map(|times| times.of(stage).as_secs_f64()).sum();
        if time > 0.0 {
            seconds.set_item(stage.name(), time)?;
        }
    }
    Ok(seconds)
}

/// What is wrong with the triangles of a map.
fn flaw(model: &Model, quality: &Quality, triangles: &[[u32; 3]]) -> Option<String> {
    let corner = triangles[quality.first_flaw?][0];
    let face = model.face_start().partition_point(|&start| start <= corner) - 1;
    let (flipped, degenerate) = (quality.distortion.flipped, quality.distortion.degenerate);
    Some(format!(
        "{flipped} triangles of the map are flipped, and {degenerate} have no area there (first face {face}, counted from 0)"
    ))
}

impl From<&RefinedModel> for RefinedReport {
    fn from(refined: &RefinedModel) -> Self {
        let model = &refined.model;
        Self { vertices: model.vertex_count(), faces: model.face_count(), complete: refined.is_complete }
    }
}

impl From<&Repair> for RepairReport {
    fn from(repair: &Repair) -> Self {
        let place = if repair.kind.is_of_faces() { Element::Face } else { Element::Vertex };
        Self { kind: repair.kind.description(), count: repair.count, first: place(repair.first) }
    }
}

impl From<&Tiling> for TilingReport {
    fn from(tiling: &Tiling) -> Self {
        let Tiling { symmetry, seams, broken, error, .. } = *tiling;
        Self { order: symmetry.order(), seams, broken, error }
    }
}
