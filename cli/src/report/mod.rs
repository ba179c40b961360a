//! The report: what went in, what was done, how good the result is. Its keys are stable; `schema` counts changes.

mod hierarchy_file;
mod names;
mod quality;
pub(crate) mod table;
mod text;

pub(crate) use hierarchy_file::HierarchyFile;
pub(crate) use quality::{DistortionReport, IslandReport, Quality};

use cones::{Atlas, Cone, NumberOfCones, Options, Predicted, Stage, Topology};
use geom::Repair;
pub(crate) use names::{angles_name, kind_name, method_name, repair_text};
use serde::Serialize;
use std::path::Path;
use std::time::Duration;

/// The version of the reports' keys.
pub(crate) const SCHEMA: u32 = 1;

/// The report of an unwrapping.
#[derive(Debug, Serialize)]
pub(crate) struct UnwrapReport {
    pub(crate) schema: u32,
    pub(crate) input: InputReport,
    pub(crate) repairs: Vec<RepairReport>,
    pub(crate) cones: Vec<ConeReport>,
    pub(crate) method: &'static str,
    pub(crate) angles: &'static str,
    pub(crate) hierarchy: HierarchyReport,
    /// How the number of cones was found; nothing where it was given.
    pub(crate) number: Option<NumberReport>,
    /// Predicted distortion by number of cones, where that number was found.
    pub(crate) curve: Vec<CurvePoint>,
    pub(crate) distortion: DistortionReport,
    pub(crate) islands: Vec<IslandReport>,
    pub(crate) times: Times,
    /// The most memory that the program has held so far, in bytes; nothing where the system does not tell.
    pub(crate) peak_memory: Option<u64>,
    pub(crate) warnings: Vec<String>,
    /// How cones and curvatures were chosen, in words.
    #[serde(skip)]
    pub(crate) rule: String,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct InputReport {
    pub(crate) path: String,
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    pub(crate) components: usize,
    pub(crate) boundary_loops: usize,
    pub(crate) genus: usize,
    pub(crate) euler: i64,
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
pub(crate) struct ConeReport {
    pub(crate) vertex: u32,
    pub(crate) position: [f64; 3],
    pub(crate) kind: &'static str,
    /// Nothing where the cone is no extremum, or essential.
    pub(crate) persistence: Option<f64>,
    /// In radians.
    pub(crate) curvature: f64,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct HierarchyReport {
    /// How many extrema the conformal factor has.
    pub(crate) extrema: usize,
    /// Their persistences, largest first.
    pub(crate) persistence: Vec<f64>,
}

/// What led to the number of cones.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct NumberReport {
    /// The area distortion that was aimed at.
    pub(crate) target: f64,
    /// How many cones were chosen for it.
    pub(crate) chosen: usize,
    pub(crate) predicted_area: f64,
    pub(crate) met: bool,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct CurvePoint {
    pub(crate) n: usize,
    pub(crate) predicted_l2: f64,
    pub(crate) predicted_area: f64,
}

/// Seconds for each stage; nothing for one that did not run. Parts that are worked on at the same time add up.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Times {
    pub(crate) read: Option<f64>,
    pub(crate) prepare: Option<f64>,
    pub(crate) factor: Option<f64>,
    pub(crate) hierarchy: Option<f64>,
    pub(crate) cut: Option<f64>,
    pub(crate) scale: Option<f64>,
    pub(crate) layout: Option<f64>,
    pub(crate) write: Option<f64>,
    /// On the clock, from reading to writing; measuring the map is part of it.
    pub(crate) total: Option<f64>,
}

impl UnwrapReport {
    /// The report of an atlas made from the file at `path`.
    pub(crate) fn new(path: &Path, atlas: &Atlas, options: &Options, quality: &Quality, times: Times) -> Self {
        Self {
            schema: SCHEMA,
            input: InputReport::new(path, &atlas.topology),
            repairs: atlas.repairs.iter().map(RepairReport::from).collect(),
            cones: atlas.cones.iter().map(ConeReport::from).collect(),
            method: method_name(options.method),
            angles: angles_name(options.angles),
            hierarchy: HierarchyReport::new(&atlas.persistence),
            number: atlas.number.as_ref().map(NumberReport::from),
            curve: curve(atlas.number.as_ref()),
            distortion: quality.distortion.clone(),
            islands: quality.islands.clone(),
            times: times.with(&atlas.times),
            peak_memory: peak_memory(),
            warnings: atlas.warnings.clone(),
            rule: text::rule(options),
        }
    }
}

impl InputReport {
    pub(crate) fn new(path: &Path, topology: &Topology) -> Self {
        Self {
            path: path.display().to_string(),
            vertices: topology.vertices,
            faces: topology.faces,
            components: topology.components,
            boundary_loops: topology.boundary_loops,
            genus: topology.genus,
            euler: topology.euler,
        }
    }
}

impl HierarchyReport {
    pub(crate) fn new(persistence: &[f64]) -> Self {
        Self { extrema: persistence.len(), persistence: persistence.to_vec() }
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

impl From<&NumberOfCones> for NumberReport {
    fn from(number: &NumberOfCones) -> Self {
        Self { target: number.target, chosen: number.chosen, predicted_area: number.predicted, met: number.is_met }
    }
}

/// The curve that a number of cones was read from.
pub(crate) fn curve(number: Option<&NumberOfCones>) -> Vec<CurvePoint> {
    number.map_or_else(Vec::new, |number| number.curve.iter().map(CurvePoint::from).collect())
}

impl From<&Predicted> for CurvePoint {
    fn from(of: &Predicted) -> Self {
        Self { n: of.count, predicted_l2: of.log_scale_norm, predicted_area: of.area_distortion }
    }
}

impl From<&Cone> for ConeReport {
    fn from(cone: &Cone) -> Self {
        Self {
            vertex: cone.vertex,
            position: cone.position,
            kind: kind_name(cone.kind),
            persistence: cone.persistence.filter(|p| p.is_finite()),
            curvature: cone.curvature,
        }
    }
}

impl Times {
    /// The library's stages added to what the command took itself.
    pub(crate) fn with(mut self, stages: &[(Stage, Duration)]) -> Self {
        for &(stage, time) in stages {
            let slot = match stage {
                Stage::Prepare => &mut self.prepare,
                Stage::Factor => &mut self.factor,
                Stage::Hierarchy => &mut self.hierarchy,
                Stage::Cut => &mut self.cut,
                Stage::Scale => &mut self.scale,
                Stage::Layout => &mut self.layout,
            };
            *slot = Some(slot.unwrap_or(0.0) + time.as_secs_f64());
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
            ("cut", self.cut),
            ("scale", self.scale),
            ("layout", self.layout),
            ("write", self.write),
        ];
        all.into_iter().filter_map(|(name, time)| Some((name, time?)))
    }
}
