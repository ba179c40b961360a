//! `cones extract`: the cones that a surface asks for.

use crate::commands::shared::{CandidateArgs, warn};
use crate::error::CommandError;
use crate::input::{self, cone_file, significant};
use crate::output;
use crate::progress::Progress;
use crate::report::table::{columns, thousands};
use crate::report::{
    ConeReport, CurvePoint, HierarchyFile, HierarchyReport, InputReport, NumberReport, RepairReport, SCHEMA, Times,
    angles_name, curve, kind_name, method_name,
};
use clap::Args;
use cones::{Extraction, Options};
use serde::Serialize;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub(crate) struct ExtractArgs {
    /// The surface: OBJ, OFF, PLY or STL, gzipped or not
    #[arg(value_name = "IN")]
    input: PathBuf,
    #[command(flatten)]
    candidates: CandidateArgs,
    /// Write the cones and their curvatures, as --cones of `cones unwrap` reads them
    #[arg(long, value_name = "FILE")]
    cones_out: Option<PathBuf>,
    /// Write the order of cones for every number of them, with what is predicted for each: .json
    #[arg(long, value_name = "FILE")]
    hierarchy: Option<PathBuf>,
    /// Print JSON in place of the table
    #[arg(long)]
    json: bool,
}

/// The part of an unwrapping's report that is known before flattening.
#[derive(Debug, Serialize)]
struct ExtractReport {
    schema: u32,
    input: InputReport,
    repairs: Vec<RepairReport>,
    cones: Vec<ConeReport>,
    method: &'static str,
    angles: &'static str,
    hierarchy: HierarchyReport,
    number: Option<NumberReport>,
    curve: Vec<CurvePoint>,
    times: Times,
    warnings: Vec<String>,
}

pub(crate) fn run(args: &ExtractArgs) -> Result<(), CommandError> {
    if let Some(path) = &args.hierarchy {
        output::extension(path, &["json"])?;
    }
    let outputs: Vec<&Path> = [&args.cones_out, &args.hierarchy].into_iter().flatten().map(|p| &**p).collect();
    output::check(&[&args.input], &outputs)?;
    let options = Options { order: args.hierarchy.is_some(), ..args.candidates.options() };
    let mut progress = Progress::begin(&args.input.display().to_string());
    let (model, read) = input::read_model(&args.input)?;
    let found = cones::extract(&model, &options, &mut |stage| progress.stage(stage))
        .map_err(|error| CommandError::Unwrap { path: args.input.clone(), error })?;
    drop(progress);
    warn(&found.repairs, &found.warnings);
    if let Some(path) = &args.cones_out {
        output::write_text(path, &cone_file::text(&found.cones))?;
    }
    if let (Some(path), Some(order)) = (&args.hierarchy, &found.order) {
        output::write_json(path, &HierarchyFile::from(order))?;
    }
    if !args.json {
        return output::print(&table(&found));
    }
    output::print_json(&ExtractReport {
        schema: SCHEMA,
        input: InputReport::new(&args.input, &found.topology),
        repairs: found.repairs.iter().map(RepairReport::from).collect(),
        cones: found.cones.iter().map(ConeReport::from).collect(),
        method: method_name(options.method),
        angles: angles_name(options.angles),
        hierarchy: HierarchyReport::new(&found.persistence),
        number: found.number.as_ref().map(NumberReport::from),
        curve: curve(found.number.as_ref()),
        times: Times { read: Some(read), ..Times::default() }.with(&found.times),
        warnings: found.warnings.clone(),
    })
}

/// A table that fits 80 columns with a million vertices.
fn table(found: &Extraction) -> String {
    let head = ["#", "vertex", "kind", "persistence", "curvature", "x", "y", "z"].map(String::from).to_vec();
    let mut rows = vec![head];
    for (i, cone) in found.cones.iter().enumerate() {
        let mut row = vec![
            (i + 1).to_string(),
            cone.vertex.to_string(),
            kind_name(cone.kind).to_owned(),
            cone.persistence.map_or_else(|| "–".to_owned(), |p| format!("{p:.4}")),
            format!("{:.4} π", cone.curvature / PI),
        ];
        row.extend(cone.position.map(|x| significant(x, 5)));
        rows.push(row);
    }
    let (cones, extrema) = (thousands(found.cones.len()), thousands(found.persistence.len()));
    format!("{}{cones} cones; φ has {extrema} extrema\n", columns(&rows))
}
