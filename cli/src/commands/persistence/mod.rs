//! `cones persistence`: the pairs of any scalar field.

mod args;
mod diagram;
mod field;
mod pairs;
mod picture;
mod report;
mod segments;
mod shown;
mod vtp;

pub(crate) use args::{DirectionName, FieldArgs, NanName, PersistenceArgs};
pub(crate) use field::{Domain, DomainField, Places, on};
pub(crate) use pairs::{Pair, PairList, Wanted};
pub(crate) use report::PairingTimes;
pub(crate) use shown::html;

use crate::error::CommandError;
use crate::output::{self, Files};
use report::PersistenceReport;
use std::path::Path;
use std::time::Instant;
use topo::{Kind, PersistenceOptions};

/// Rows of the table for each direction, where nothing else is asked.
const ROWS: usize = 10;

/// Extrema of each direction in a picture, where nothing else is asked.
const MARKS: usize = 50;

pub(crate) fn run(args: &PersistenceArgs) -> Result<(), CommandError> {
    check_outputs(args)?;
    let start = Instant::now();
    let subject = DomainField::read(&args.of)?;
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
        output::print_table(&report.text(&subject.places, &lists, args.top))
    }
}

/// The library's options.
fn options(args: &PersistenceArgs) -> PersistenceOptions {
    if args.keep_zero { args.of.options().keep_zeros() } else { args.of.options() }
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
        (&args.picture, &["png"]),
        (&args.segmentation, &["npy", "ply", "png"]),
        (&args.report, &["html"]),
    ];
    for (output, endings) in outputs {
        output.as_deref().map_or(Ok(""), |path| output::extension(path, endings))?;
    }
    let outputs: Vec<&Path> = outputs.iter().filter_map(|(output, _)| output.as_deref()).collect();
    output::check(&args.of.files(), &outputs)?;
    output::check_json(args.json, &outputs)?;
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
    if let (Some(path), None) = (&args.picture, shape_of_picture(places)) {
        return Err(CommandError::NoPicture(path.clone()));
    }
    args.segmentation.as_deref().map_or(Ok(()), |path| segments::check(path, places))
}

fn write(
    args: &PersistenceArgs,
    subject: &DomainField,
    lists: &[PairList],
    report: &PersistenceReport,
) -> Result<(), CommandError> {
    let page = match &args.report {
        Some(path) => Some((path, html(path, subject, &lists.iter().collect::<Vec<_>>(), options(args))?)),
        None => None,
    };
    let mut files = Files::new();
    if let Some(path) = &args.pairs {
        match output::extension(path, &["csv", "json", "vtp"])? {
            "csv" => files.write_csv(path, &report::rows(lists, &subject.places))?,
            "json" => files.write_json(path, report)?,
            _ => {
                if subject.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("vti")) {
                    output::warn(&format!(
                        "{}: points are numbered as in the array, without the image's origin and spacing",
                        path.display()
                    ));
                }
                files.write_text(path, &vtp::text(lists, &subject.places))?;
            }
        }
    }
    let title = subject.path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    if let Some(path) = &args.diagram {
        files.write_text(path, &diagram::diagram(lists, &title))?;
    }
    if let Some(path) = &args.barcode {
        files.write_text(path, &diagram::barcode(lists, &title, args.bars))?;
    }
    if let (Some(path), Some(shape)) = (&args.picture, shape_of_picture(&subject.places)) {
        let most = args.top.unwrap_or(MARKS);
        files.write_png(path, &picture::marked(&subject.values.to_f64(), shape, lists, most))?;
    }
    if let Some((path, page)) = page {
        files.write_text(path, &page)?;
    }
    if let (Some(path), &[kind]) = (&args.segmentation, args.direction.kinds()) {
        segments::write(&mut files, path, subject, kind, options(args), args.min_persistence)?;
    }
    files.finish()
}

/// Rows and columns, if vertices are pixels.
fn shape_of_picture(places: &Places) -> Option<[usize; 2]> {
    match places {
        Places::Array(shape) => <[usize; 2]>::try_from(&shape[..]).ok().filter(|shape| !shape.contains(&0)),
        _ => None,
    }
}

/// A kind's direction.
pub(crate) fn direction(kind: Kind) -> &'static str {
    match kind {
        Kind::Minimum => "sublevel",
        Kind::Maximum => "superlevel",
    }
}
