//! The report: what went in, what was done, how good the result is. Its keys are stable; `schema` counts changes.

mod hierarchy_file;
mod seams;
pub(crate) mod table;
mod text;

pub(crate) use hierarchy_file::{HierarchyFile, rows as hierarchy_rows};
pub(crate) use seams::on_seams;
pub(crate) use text::{distortion_text, distortion_text_filling, overlap_text, repair_text, tiles_text};

use cones::report::Report;
pub(crate) use cones::report::SCHEMA;
use cones::uv::Tiles;
use cones::{Islands, Options, Refining, Stage, Topology};
use serde::Serialize;
use std::path::Path;

/// The report of an unwrapping: the library's, with what a file and a program have besides.
#[derive(Debug, Serialize)]
pub(crate) struct UnwrapReport {
    pub(crate) schema: u32,
    pub(crate) input: InputReport,
    #[serde(flatten)]
    pub(crate) map: Report,
    pub(crate) times: Times,
    /// The most memory that the program has held so far, in bytes; nothing where the system does not tell.
    pub(crate) peak_memory: Option<u64>,
    /// How cones and curvatures were chosen, in words.
    #[serde(skip)]
    pub(crate) rule: String,
    /// What was asked for islands.
    #[serde(skip)]
    pub(crate) islands: Islands,
    /// Whether islands are of a size that was asked for, on as many tiles as they need.
    #[serde(skip)]
    pub(crate) is_udim: bool,
    /// Whether to advise refining: not where it was tried, or a warning does.
    #[serde(skip)]
    pub(crate) may_advise_refining: bool,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct InputReport {
    pub(crate) path: String,
    #[serde(flatten)]
    pub(crate) topology: Topology,
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
    /// Of a model that came from the file at `path`.
    pub(crate) fn new(path: &Path, options: &Options, topology: Topology, report: Report, times: Times) -> Self {
        let input = InputReport::new(path, topology);
        let (rule, islands) = (text::rule(options), options.islands);
        let may_advise_refining = options.preparation.refine == Refining::Never;
        Self {
            schema: SCHEMA,
            input,
            map: report,
            times,
            peak_memory: peak_memory(),
            rule,
            islands,
            is_udim: options.packing.tiles != Tiles::One,
            may_advise_refining,
        }
    }
}

impl InputReport {
    pub(crate) fn new(path: &Path, topology: Topology) -> Self {
        Self { path: path.display().to_string(), topology }
    }
}

/// Linux keeps the account.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * kilobytes.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
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
