//! The report: what went in, what was done, how good the result is. Its keys are stable; `schema` counts changes.

mod hierarchy_file;
mod names;
mod quality;
mod seams;
pub(crate) mod table;
mod text;

pub(crate) use hierarchy_file::{HierarchyFile, rows as hierarchy_rows};
pub(crate) use quality::{DistortionReport, IslandReport, OverlapReport, Quality};
use seams::SeamReport;

use cones::{Analysis, Atlas, ChosenNumber, Cone, Note, Options, Prediction, RefinedModel, Stage, Topology};
use geom::Repair;
pub(crate) use names::{angles_name, kind_name, policy_name, repair_text};
use serde::Serialize;
use std::path::Path;

/// The version of the reports' keys.
pub(crate) const SCHEMA: u32 = 1;

/// The report of an unwrapping.
#[derive(Debug, Serialize)]
pub(crate) struct UnwrapReport {
    pub(crate) schema: u32,
    pub(crate) input: InputReport,
    pub(crate) repairs: Vec<RepairReport>,
    /// The refined model, if the surface was refined.
    pub(crate) refined: Option<RefinedReport>,
    pub(crate) cones: Vec<Cone>,
    pub(crate) method: &'static str,
    pub(crate) angles: &'static str,
    /// What was done where the layout lay over itself.
    pub(crate) policy: &'static str,
    pub(crate) hierarchy: HierarchyReport,
    /// How the number of cones was found; nothing where it was given.
    pub(crate) number: Option<ChosenNumber>,
    /// Predicted distortion by number of cones, where that number was found.
    pub(crate) curve: Vec<Prediction>,
    pub(crate) distortion: DistortionReport,
    pub(crate) islands: Vec<IslandReport>,
    pub(crate) seams: SeamReport,
    pub(crate) times: Times,
    /// The most memory that the program has held so far, in bytes; nothing where the system does not tell.
    pub(crate) peak_memory: Option<u64>,
    pub(crate) warnings: Vec<String>,
    /// How cones and curvatures were chosen, in words.
    #[serde(skip)]
    pub(crate) rule: String,
}

/// The model that is written, where a surface was refined.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RefinedReport {
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    /// Whether all triangles that are computed with are even.
    pub(crate) complete: bool,
    /// The input's face that each face is part of.
    pub(crate) face: Vec<u32>,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct InputReport {
    pub(crate) path: String,
    #[serde(flatten)]
    pub(crate) topology: Topology,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct RepairReport {
    /// What was found and what was done.
    pub(crate) kind: &'static str,
    pub(crate) count: usize,
    /// The first one.
    pub(crate) first: Element,
}

/// An element of the input, counted from 0.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Element {
    Vertex(usize),
    Face(usize),
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct HierarchyReport {
    /// How many extrema the conformal factor has.
    pub(crate) extrema: usize,
    /// Their persistences, largest first.
    pub(crate) persistence: Vec<f64>,
}

/// Seconds for each stage; nothing for one that did not run. They add up to the time on the clock, but for what lies between
/// them: where parts are worked on at the same time, that time is divided among their stages.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Times {
    pub(crate) read: Option<f64>,
    pub(crate) prepare: Option<f64>,
    pub(crate) factor: Option<f64>,
    pub(crate) hierarchy: Option<f64>,
    pub(crate) curvature: Option<f64>,
    pub(crate) cut: Option<f64>,
    pub(crate) scale: Option<f64>,
    pub(crate) layout: Option<f64>,
    pub(crate) islands: Option<f64>,
    pub(crate) pack: Option<f64>,
    pub(crate) measure: Option<f64>,
    pub(crate) write: Option<f64>,
    pub(crate) draw: Option<f64>,
    /// On the clock, from reading to drawing.
    pub(crate) total: Option<f64>,
}

impl UnwrapReport {
    /// The report of a model that came from the file at `path`.
    pub(crate) fn new(
        path: &Path,
        options: &Options,
        analysis: &Analysis,
        atlas: &Atlas,
        quality: &Quality,
        times: Times,
    ) -> Self {
        Self {
            schema: SCHEMA,
            input: InputReport::new(path, analysis.topology()),
            repairs: analysis.repairs().iter().map(RepairReport::from).collect(),
            refined: analysis.refined().map(RefinedReport::from),
            cones: atlas.cones.clone(),
            method: options.placement.name(),
            angles: angles_name(options.rule),
            policy: policy_name(options.islands),
            hierarchy: HierarchyReport::new(analysis),
            number: atlas.number.clone(),
            curve: curve(atlas.number.as_ref()).to_vec(),
            distortion: quality.distortion.clone(),
            islands: quality.islands.clone(),
            seams: SeamReport::new(atlas),
            times,
            peak_memory: peak_memory(),
            warnings: warnings(&atlas.notes, analysis.topology().components),
            rule: text::rule(options),
        }
    }
}

/// All notes as sentences, those of one part of several with its number.
pub(crate) fn warnings(notes: &[Note], components: usize) -> Vec<String> {
    let sentence = |note: &Note| match (note.component(), components) {
        (Some(component), 2..) => format!("part {}: {note}", component + 1),
        _ => note.to_string(),
    };
    notes.iter().map(sentence).collect()
}

impl InputReport {
    pub(crate) fn new(path: &Path, topology: Topology) -> Self {
        Self { path: path.display().to_string(), topology }
    }
}

impl From<&RefinedModel> for RefinedReport {
    fn from(refined: &RefinedModel) -> Self {
        let RefinedModel { model, face, is_complete, .. } = refined;
        Self { vertices: model.vertex_count(), faces: model.face_count(), complete: *is_complete, face: face.clone() }
    }
}

impl HierarchyReport {
    pub(crate) fn new(analysis: &Analysis) -> Self {
        let persistence: Vec<f64> = analysis.extrema().iter().map(|extremum| extremum.persistence).collect();
        Self { extrema: persistence.len(), persistence }
    }
}

impl From<&Repair> for RepairReport {
    fn from(repair: &Repair) -> Self {
        let place = if repair.kind.is_of_faces() { Element::Face } else { Element::Vertex };
        Self { kind: repair.kind.description(), count: repair.count, first: place(repair.first) }
    }
}

/// Linux keeps the account.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * kilobytes.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
}

/// The curve that a number of cones was read from.
pub(crate) fn curve(number: Option<&ChosenNumber>) -> &[Prediction] {
    number.map_or(&[], |number| &number.curve)
}

impl Times {
    /// The library's stages added to what the command took itself.
    pub(crate) fn with(mut self, stages: cones::Times) -> Self {
        for stage in Stage::ALL {
            let slot = match stage {
                Stage::Prepare => &mut self.prepare,
                Stage::Factor => &mut self.factor,
                Stage::Hierarchy => &mut self.hierarchy,
                Stage::Curvature => &mut self.curvature,
                Stage::Cut => &mut self.cut,
                Stage::Scale => &mut self.scale,
                Stage::Layout => &mut self.layout,
                Stage::Islands => &mut self.islands,
                Stage::Pack => &mut self.pack,
                _ => continue,
            };
            let time = stages.of(stage).as_secs_f64();
            if time > 0.0 {
                *slot = Some(slot.unwrap_or(0.0) + time);
            }
        }
        self
    }

    /// All seconds.
    pub(crate) fn total(&self) -> f64 {
        self.total.unwrap_or_else(|| self.stages().map(|(_, time)| time).sum())
    }

    /// The stages that ran, by name, in order.
    pub(crate) fn stages(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let all = [
            ("read", self.read),
            ("prepare", self.prepare),
            ("factor", self.factor),
            ("hierarchy", self.hierarchy),
            ("curvature", self.curvature),
            ("cut", self.cut),
            ("scale", self.scale),
            ("layout", self.layout),
            ("islands", self.islands),
            ("pack", self.pack),
            ("measure", self.measure),
            ("write", self.write),
            ("draw", self.draw),
        ];
        all.into_iter().filter_map(|(name, time)| Some((name, time?)))
    }
}
