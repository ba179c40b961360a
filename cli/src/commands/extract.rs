//! `cones extract`: the cones that a surface asks for.

use crate::args::{Extract, angles_name, method_name};
use crate::failure::Failure;
use crate::input::cone_file;
use crate::progress::Progress;
use crate::report::hierarchy_file;
use crate::report::table::{columns, thousands};
use crate::report::{ConeReport, CurvePoint, Hierarchy, Input, Number, RepairReport, SCHEMA, Times, curve, kind_name};
use crate::{job, output};
use cones::{Extraction, Options};
use serde::Serialize;
use std::f64::consts::PI;
use std::path::Path;

/// The part of an unwrapping's report that is known before flattening.
#[derive(Debug, Serialize)]
struct ExtractReport {
    schema: u32,
    input: Input,
    repairs: Vec<RepairReport>,
    cones: Vec<ConeReport>,
    method: &'static str,
    angles: &'static str,
    hierarchy: Hierarchy,
    number: Option<Number>,
    curve: Vec<CurvePoint>,
    times: Times,
    warnings: Vec<String>,
}

pub(crate) fn run(args: &Extract) -> Result<(), Failure> {
    let inputs: Vec<&Path> =
        [Some(&args.input), args.choice.cones.as_ref()].into_iter().flatten().map(|p| &**p).collect();
    if let Some(path) = &args.hierarchy {
        output::extension(path, &["json"])?;
    }
    let outputs: Vec<&Path> = [&args.cones_out, &args.hierarchy].into_iter().flatten().map(|p| &**p).collect();
    output::check(&inputs, &outputs)?;
    let options = Options { order: args.hierarchy.is_some(), ..args.choice.options()? };
    let mut progress = Progress::begin(&args.input.display().to_string());
    let (model, read) = job::read(&args.input)?;
    let found = cones::extract(&model, &options, &mut |stage| progress.stage(stage))
        .map_err(|error| Failure::Unwrap { path: args.input.clone(), error })?;
    drop(progress);
    job::warn(&found.repairs, &found.warnings);
    if let Some(path) = &args.cones_out {
        output::write_text(path, &cone_file::text(&found.cones))?;
    }
    hierarchy_file::write(args.hierarchy.as_deref(), found.order.as_ref())?;
    if !args.json {
        return output::print(&table(&found));
    }
    output::print_json(&ExtractReport {
        schema: SCHEMA,
        input: Input::new(&args.input, &found.topology),
        repairs: found.repairs.iter().map(RepairReport::from).collect(),
        cones: found.cones.iter().map(ConeReport::from).collect(),
        method: method_name(options.method),
        angles: angles_name(options.angles),
        hierarchy: Hierarchy::new(&found.persistence),
        number: found.number.as_ref().map(Number::from),
        curve: curve(found.number.as_ref()),
        times: Times { read: Some(read), ..Times::default() }.with(&found.times),
        warnings: found.warnings.clone(),
    })
}

fn table(found: &Extraction) -> String {
    let head = ["#", "vertex", "kind", "persistence", "curvature/π", "x", "y", "z"].map(String::from).to_vec();
    let mut rows = vec![head];
    for (i, cone) in found.cones.iter().enumerate() {
        let mut row = vec![
            (i + 1).to_string(),
            cone.vertex.to_string(),
            kind_name(cone.kind).to_owned(),
            cone.persistence.map_or_else(|| "–".to_owned(), |p| format!("{p:.4}")),
            format!("{:.4}", cone.curvature / PI),
        ];
        row.extend(cone.position.map(|x| format!("{x:.6}")));
        rows.push(row);
    }
    let (cones, extrema) = (thousands(found.cones.len()), thousands(found.persistence.len()));
    format!("{}{cones} cones; φ has {extrema} extrema\n", columns(&rows))
}
