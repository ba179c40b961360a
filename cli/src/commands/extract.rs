//! `cones extract`: the cones that a surface asks for.

use crate::commands::shared::{CLOSED_ORDER, CandidateArgs, HIERARCHY_ENDINGS, warn, write_hierarchy};
use crate::error::CommandError;
use crate::input::{self, cone_file, significant};
use crate::output::{self, Files};
use crate::progress::Progress;
use crate::report::table::{columns, counted};
use crate::report::{InputReport, SCHEMA, Times};
use clap::Args;
use cones::report::{HierarchyReport, RepairReport, sentences};
use cones::{Analysis, ChosenNumber, Cone, Cones, Handles, Note, Prediction};
use serde::Serialize;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// The cones that `cones unwrap` begins with on the same surface and by the same options, handles opened and triangles refined alike. It may end with others where
/// their map shows that they fold triangles over, bend angles, or miss the target, and where it cuts off thin limbs: rarely with -n, more often with an automatic number.
#[derive(Args, Debug)]
pub(crate) struct ExtractArgs {
    /// The surface: OBJ, OFF, PLY, STL or glTF, gzipped or not; - is standard input
    #[arg(value_name = "IN")]
    input: PathBuf,
    #[command(flatten)]
    candidates: CandidateArgs,
    /// Write the cones and their curvatures, as --cones of `cones unwrap` reads them
    #[arg(long, value_name = "FILE")]
    cones_out: Option<PathBuf>,
    /// Write the order of cones for every number of them, with what is predicted for each: .json or .csv
    #[arg(long, value_name = "FILE")]
    hierarchy: Option<PathBuf>,
    /// Print JSON in place of the table
    #[arg(long)]
    json: bool,
}

/// The part of an unwrapping's report that is known before flattening.
#[derive(Debug, Serialize)]
struct ExtractReport<'a> {
    schema: u32,
    input: InputReport,
    repairs: Vec<RepairReport>,
    cones: &'a [Cone],
    method: &'static str,
    angles: &'static str,
    hierarchy: HierarchyReport,
    opened_handles: usize,
    number: Option<&'a ChosenNumber>,
    curve: &'a [Prediction],
    times: Times,
    warnings: Vec<String>,
}

pub(crate) fn run(args: &ExtractArgs) -> Result<(), CommandError> {
    if let Some(path) = &args.hierarchy {
        output::extension(path, &HIERARCHY_ENDINGS)?;
    }
    let outputs: Vec<&Path> = [&args.cones_out, &args.hierarchy].into_iter().flatten().map(|p| &**p).collect();
    output::check_json(args.json, &outputs)?;
    output::check(&[&args.input], &outputs)?;
    args.candidates.warn_of_idle_smoothing();
    let options = args.candidates.options_for(&args.input);
    let progress = Progress::begin(&args.input.display().to_string());
    let (model, read) = input::read_model(&args.input)?;
    let (model, split) = args.candidates.with_edges_split(model);
    let failed = |error| CommandError::Unwrap { path: args.input.clone(), error };
    let analysis = Analysis::observed(&model, options.preparation, progress.observer()).map_err(failed)?;
    let (taken, found) = analysis.choose_for_map(&options).map_err(failed)?;
    let order = args.hierarchy.as_ref().map(|path| Ok((path, args.candidates.order(&analysis, found.len())?)));
    let order = order.transpose().map_err(failed)?;
    progress.finish();
    let topology = analysis.topology();
    let notes: Vec<Note> = taken.notes().iter().chain(found.notes()).cloned().collect();
    warn(analysis.repairs(), &notes, topology.components);
    if args.hierarchy.is_some() && taken.opened_handles() > 0 && options.preparation.handles == Handles::Auto {
        output::warn(CLOSED_ORDER);
    }
    split.iter().for_each(|line| output::warn(line));
    let mut files = Files::new();
    if let Some(path) = &args.cones_out {
        files.write_text(path, &cone_file::text(found.recipe()))?;
    }
    if let Some((path, order)) = order {
        write_hierarchy(&mut files, path, order)?;
    }
    files.finish()?;
    let hierarchy = HierarchyReport::new(&analysis);
    if !args.json {
        return output::print(&table(&found, hierarchy.extrema, taken.opened_handles()));
    }
    output::print_json(&ExtractReport {
        schema: SCHEMA,
        input: InputReport::new(&args.input, topology),
        repairs: analysis.repairs().iter().map(RepairReport::from).collect(),
        cones: found.as_slice(),
        method: options.method_name(),
        angles: options.angles_name(),
        hierarchy,
        opened_handles: taken.opened_handles(),
        number: found.number(),
        curve: found.number().map_or(&[], |number| &number.curve),
        times: Times { read: Some(read), ..Times::default() }.with(analysis.times()).with(found.times()),
        warnings: sentences(&notes, topology.components),
    })
}

/// A table that fits 80 columns with a million vertices.
fn table(found: &Cones, extrema: usize, opened: usize) -> String {
    let head = ["#", "vertex", "kind", "persistence", "curvature", "x", "y", "z"].map(String::from).to_vec();
    let mut rows = vec![head];
    for (i, cone) in found.iter().enumerate() {
        let mut row = vec![
            (i + 1).to_string(),
            cone.vertex.to_string(),
            cone.kind.name().to_owned(),
            cone.persistence.map_or_else(|| "–".to_owned(), |p| format!("{p:.4}")),
            format!("{:.4} π", cone.curvature / PI),
        ];
        row.extend(cone.position.map(|x| significant(x, 5)));
        rows.push(row);
    }
    let (cones, extrema) = (counted(found.len(), "cone", "cones"), counted(extrema, "extremum", "extrema"));
    let opened = match opened {
        0 => String::new(),
        opened => format!("; {} opened", counted(opened, "handle", "handles")),
    };
    format!("{}{cones}; φ has {extrema}{opened}\n", columns(&rows))
}
