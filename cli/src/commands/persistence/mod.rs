//! `cones persistence`: the pairs of any scalar field.

mod args;
mod diagram;
mod field;
mod pairs;
mod report;
mod segments;
mod shown;
mod vtp;

pub(crate) use args::{NanName, PersistenceArgs};
pub(crate) use field::{DomainField, Places};
pub(crate) use pairs::{Pair, PairList, Wanted};
pub(crate) use report::PairingTimes;
pub(crate) use shown::html;

use crate::error::CommandError;
use crate::input::Source;
use crate::output;
use report::PersistenceReport;
use std::path::Path;
use std::time::Instant;
use topo::{Kind, NanPolicy, PersistenceOptions};

/// Rows of the table for each direction, where nothing else is asked.
const ROWS: usize = 10;

pub(crate) fn run(args: &PersistenceArgs) -> Result<(), CommandError> {
    check_outputs(args)?;
    let start = Instant::now();
    let subject = DomainField::read(args)?;
    check_forms(args, &subject.places)?;
    let mut report = PersistenceReport::new(&subject, args, start.elapsed());
    let wanted = Wanted { options: options(args), min_persistence: args.min_persistence, top: args.top };
    let mut lists = Vec::new();
    for &kind in args.direction.kinds() {
        let start = Instant::now();
        let list = PairList::new(&subject, kind, &wanted).map_err(|error| explain(&subject.path, error))?;
        report.add(&list, &subject.places, start.elapsed());
        lists.push(list);
    }
    let start = Instant::now();
    write(args, &subject, &lists, &report)?;
    report.times.write = Some(start.elapsed().as_secs_f64());
    if args.json {
        output::print_json(&report)
    } else {
        output::print(&report.text(&subject.places, &lists, args.top.unwrap_or(ROWS)))
    }
}

/// The library's options.
fn options(args: &PersistenceArgs) -> PersistenceOptions {
    // A computed field is NaN where a mesh has no surface, which is no mistake of anyone's.
    let has_gaps = args.field.as_ref().is_some_and(Source::leaves_gaps);
    let nan = if has_gaps { NanPolicy::Mask } else { args.nan.policy() };
    let options = PersistenceOptions::new().nan(nan);
    if args.keep_zero { options.keep_zeros() } else { options }
}

/// What the library refuses, in the command's words.
pub(crate) fn explain(path: &Path, error: topo::Error) -> CommandError {
    match error {
        topo::Error::NotANumber { vertex } => CommandError::NotANumber { path: path.to_owned(), vertex },
        error => CommandError::Persistence { path: path.to_owned(), error },
    }
}

/// Makes sure, before anything is read, that all outputs can be written.
fn check_outputs(args: &PersistenceArgs) -> Result<(), CommandError> {
    let outputs = [
        (&args.pairs, &["csv", "json", "vtp"][..]),
        (&args.diagram, &["svg"]),
        (&args.barcode, &["svg"]),
        (&args.segmentation, &["npy", "ply", "png"]),
        (&args.report, &["html"]),
    ];
    for (output, endings) in outputs {
        output.as_deref().map_or(Ok(""), |path| output::extension(path, endings))?;
    }
    let inputs = [Some(args.input.as_path()), args.edges.as_deref(), args.field.as_ref().and_then(Source::file)];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().collect();
    let outputs: Vec<&Path> = outputs.iter().filter_map(|(output, _)| output.as_deref()).collect();
    output::check(&inputs, &outputs)?;
    match (&args.segmentation, args.direction.kinds()) {
        (Some(path), [_, _]) => Err(CommandError::WhichSegments(path.clone())),
        _ => Ok(()),
    }
}

/// Makes sure, before anything is written, that the outputs can tell of vertices where these are.
fn check_forms(args: &PersistenceArgs, places: &Places) -> Result<(), CommandError> {
    match &args.pairs {
        Some(path) if output::extension(path, &["csv", "json", "vtp"])? == "vtp" && !places.are_in_space() => {
            return Err(CommandError::NoPlaces(path.clone()));
        }
        _ => {}
    }
    args.segmentation.as_deref().map_or(Ok(()), |path| segments::check(path, places))
}

fn write(
    args: &PersistenceArgs,
    subject: &DomainField,
    lists: &[PairList],
    report: &PersistenceReport,
) -> Result<(), CommandError> {
    if let Some(path) = &args.pairs {
        match output::extension(path, &["csv", "json", "vtp"])? {
            "csv" => output::write_csv(path, &report::rows(lists, &subject.places))?,
            "json" => output::write_json(path, report)?,
            _ => output::write_text(path, &vtp::text(lists, &subject.places))?,
        }
    }
    for (path, draw) in [(&args.diagram, diagram::diagram as fn(&[PairList]) -> _), (&args.barcode, diagram::barcode)] {
        if let Some(path) = path {
            output::write_text(path, &draw(lists))?;
        }
    }
    if let Some(path) = &args.report {
        output::write_text(path, &html(path, subject, &lists.iter().collect::<Vec<_>>(), options(args))?)?;
    }
    if let (Some(path), &[kind]) = (&args.segmentation, args.direction.kinds()) {
        segments::write(path, subject, kind, options(args), args.min_persistence)?;
    }
    Ok(())
}

/// A kind's direction.
fn direction(kind: Kind) -> &'static str {
    match kind {
        Kind::Minimum => "sublevel",
        Kind::Maximum => "superlevel",
    }
}
