//! A report that opens in a browser: the page with a surface and maps of it inside.

use super::shown::{Chosen, ForeseenLevel, Subject};
use super::unwrapped::Unwrapped;
use crate::error::CommandError;
use crate::page::{Level, Report};
use crate::progress::Progress;
use cones::{ConeChoice, Options, SeamOptions};
use geom::Watch;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::Path;

/// The numbers of cones that maps are stored for, besides the one that was chosen.
const STORED: [usize; 13] = [3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64];
/// Those of several parts, whose numbers are sums, as shares of the one that was chosen.
const OF_CHOSEN: [f64; 4] = [0.25, 0.5, 0.7, 1.4];
/// Of large surfaces fewer maps are stored, so that the file stays one that browsers open at once: a vertex of a map takes some 9
/// bytes of it (rabbit, 46,646 vertices).
const MOST_VERTICES: usize = 1_000_000;

/// The report of an unwrapped surface. Costs a flattening for each of the stored maps.
pub(crate) fn html(path: &Path, unwrapped: &Unwrapped, progress: &Progress) -> Result<String, CommandError> {
    progress.step("report");
    let failed = |error| CommandError::Unwrap { path: path.to_owned(), error };
    let Unwrapped { model, analysis, options, map, .. } = unwrapped;
    let atlas = &map.atlas;
    let subject = Subject::new(path, model, analysis.clone(), options.clone());
    let surface = subject.surface();
    let report = Report::new(&surface);
    let foreseen = subject.foreseen(options.placement, options.rule).map_err(failed)?;
    let chosen = atlas.cones.len();
    let first = stored_level(&subject, &report, options, chosen)?;
    let mut levels = vec![first];
    let room = MOST_VERTICES / model.vertex_count().max(1);
    let mut numbers = match analysis.topology().components {
        1 => STORED.to_vec(),
        _ => OF_CHOSEN.map(|share| (share * chosen as f64).ceil() as usize).to_vec(),
    };
    numbers.retain(|n| *n != chosen && *n >= analysis.least_cones() && *n <= subject.most());
    numbers.dedup();
    // The nearest to what was chosen, where there is no room for all.
    numbers.sort_by_key(|n| n.abs_diff(chosen));
    numbers.truncate(room);
    // Where so many cones make no map there is none in the report either.
    let stored = |&n: &usize| {
        let options = Options { cones: ConeChoice::Count(n), ..options.clone() };
        stored_level(&subject, &report, &options, n).ok()
    };
    levels.extend(numbers.par_iter().with_max_len(1).filter_map(stored).collect::<Vec<Level>>());
    for foreseen in &foreseen.levels {
        if foreseen.n != chosen && !levels.iter().any(|level| level.meta["n"] == foreseen.n) {
            levels.extend(level(&subject, options, foreseen).ok());
        }
    }
    levels.sort_by_key(|level| level.meta["n"].as_u64());
    let meta = subject.meta(&Chosen::new(Some(chosen), options.placement, options.rule));
    report
        .html(&meta, &json!(foreseen), &levels)
        .map_err(|source| CommandError::WriteFile { path: path.to_owned(), source })
}

/// A number of cones with its map.
fn stored_level(subject: &Subject, report: &Report, options: &Options, n: usize) -> Result<Level, CommandError> {
    let shown = subject.map(&subject.analysis, options)?;
    let map = subject.drawn(&shown);
    let quality = subject.measure(&shown.uv, &shown.atlas.cones, Watch::NONE)?;
    let meta = json!({
        "n": n,
        "cones": places(shown.atlas.cones.iter()),
        "predicted": subject.predicted(options, &shown.atlas),
        "map": subject.map_meta(&shown, options),
        "measured": Subject::measured_meta(&quality, &shown.atlas),
    });
    Ok(Level { meta, map: Some(report.pack(&map, &subject.stretches(&quality))), seams: map.seams })
}

/// Cones that are foreseen, with the seams that their map begins with; these are the shortest, and not yet straight.
fn level(subject: &Subject, options: &Options, foreseen: &ForeseenLevel) -> Result<Level, cones::Error> {
    let vertices: Vec<u32> = foreseen.cones.iter().map(|&(vertex, _)| vertex).collect();
    let cones = subject.analysis.given(&vertices, options.rule)?;
    let seams = subject.analysis.seams(&cones, &SeamOptions { weight: 0.0, ..options.seams.clone() })?;
    let meta = json!({
        "n": foreseen.n,
        "cones": places(cones.iter()),
        "predicted": cones.prediction().area_distortion,
        "map": null,
    });
    Ok(Level { meta, seams, map: None })
}

fn places<'a>(cones: impl Iterator<Item = &'a cones::Cone>) -> Vec<Value> {
    cones.map(|cone| json!({ "vertex": cone.vertex, "curvature": cone.curvature })).collect()
}
