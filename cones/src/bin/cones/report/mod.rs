//! The report: what went in, what was done, how good the result is. Its keys are stable; `schema` counts changes.

mod quality;

pub(crate) use quality::{DistortionReport, IslandReport};

use crate::args::{angles_name, method_name};
use cones::{Atlas, Cone, Extraction, Kind, Options, Repair, Stage, Topology};
use geom::distortion::Distortion;
use serde::Serialize;
use std::path::Path;
use std::time::Duration;

/// The version of the reports' keys.
pub(crate) const SCHEMA: u32 = 1;

/// The report of an unwrapping.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) schema: u32,
    pub(crate) input: Input,
    pub(crate) repairs: Vec<RepairReport>,
    pub(crate) cones: Vec<ConeReport>,
    pub(crate) method: &'static str,
    pub(crate) angles: &'static str,
    pub(crate) hierarchy: Hierarchy,
    /// Predicted distortion by number of cones.
    pub(crate) curve: [(); 0],
    pub(crate) distortion: DistortionReport,
    pub(crate) islands: Vec<IslandReport>,
    pub(crate) times: Times,
    pub(crate) warnings: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Input {
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
    pub(crate) kind: &'static str,
    pub(crate) count: usize,
    pub(crate) first: String,
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
pub(crate) struct Hierarchy {
    /// How many extrema the conformal factor has.
    pub(crate) extrema: usize,
    /// Their persistences, largest first.
    pub(crate) persistence: Vec<f64>,
}

/// Seconds for each stage; nothing for one that did not run.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Times {
    pub(crate) read: Option<f64>,
    pub(crate) prepare: Option<f64>,
    pub(crate) factor: Option<f64>,
    pub(crate) hierarchy: Option<f64>,
    pub(crate) cut: Option<f64>,
    pub(crate) scale: Option<f64>,
    pub(crate) layout: Option<f64>,
    pub(crate) islands: Option<f64>,
    pub(crate) write: Option<f64>,
}
