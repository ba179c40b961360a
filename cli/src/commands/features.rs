//! `cones features`: the feature points of a mesh, which are the extrema of a field by their persistence.

use crate::commands::persistence::{DomainField, NanName, Pair, PairList, PairingTimes, Places, Wanted, explain, html};
use crate::commands::shared::{ShotArgs, non_negative, whole};
use crate::error::CommandError;
use crate::input::{Number, Source, significant};
use crate::output::{self, Files};
use crate::render::{Mark, Paint, Scene, draw_model};
use crate::report::SCHEMA;
use crate::report::table::{columns, counted};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;
use topo::{Kind, NanPolicy, PersistenceOptions};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct FeaturesArgs {
    /// The surface: OBJ, OFF, PLY, STL or glTF
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The field: phi, curvature, mean-curvature, height[:x|y|z], distance[:VERTEX], a file .npy or .txt, or numbers that the file has at its vertices, such as a
    /// PLY's quality
    #[arg(long, value_name = "VALUES", default_value = "phi", value_parser = Source::parse)]
    field: Source,
    /// How many feature points [default: 16]
    #[arg(short = 'n', value_name = "N", group = "which", value_parser = whole::<usize>("number of feature points", 0..), allow_negative_numbers = true)]
    count: Option<usize>,
    /// All extrema that are more persistent than this
    #[arg(long, value_name = "P", group = "which", value_parser = non_negative, allow_negative_numbers = true)]
    min_persistence: Option<f64>,
    /// In what order extrema become feature points
    #[arg(long, value_enum, default_value_t = OrderName::Persistence)]
    method: OrderName,
    /// What to do with NaN in a file of values
    #[arg(long, value_enum, default_value_t = NanName::Refuse)]
    nan: NanName,
    /// Write the feature points: .csv or .json
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// Draw the mesh coloured by the field, minima marked blue and maxima red: .png
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    shot: ShotArgs,
    /// Write a page to see in a browser: the field, its segments at every level, merge tree, diagram and barcode: .html
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Print JSON in place of the table
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  cones features scan.ply -n 10 --picture features.png
  cones features scan.ply --field height:z --min-persistence 0.1 -o features.csv";

/// How many feature points there are by default.
const COUNT: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
enum OrderName {
    /// By persistence, whatever their kind
    Persistence,
    /// The most persistent maximum, minimum, maximum, …
    Alternating,
}

/// The report of `cones features`. Its keys are stable.
#[derive(Debug, Serialize)]
struct FeaturesReport {
    schema: u32,
    input: MeshInput,
    method: OrderName,
    /// How many extrema of some persistence the field has.
    count: usize,
    extrema: Vec<FeaturePoint>,
    times: PairingTimes,
}

#[derive(Debug, Serialize)]
struct MeshInput {
    path: String,
    vertices: usize,
    faces: usize,
}

#[derive(Clone, Debug, Serialize)]
struct FeaturePoint {
    vertex: usize,
    position: [f64; 3],
    kind: &'static str,
    value: Number,
    /// Of a global extremum the range of its component.
    persistence: Number,
    /// Nothing for a global extremum.
    saddle: Option<usize>,
}

pub(crate) fn run(args: &FeaturesArgs) -> Result<(), CommandError> {
    check_outputs(args)?;
    let start = Instant::now();
    let subject = DomainField::mesh(&args.input, &args.field)?;
    let mut times = PairingTimes { read: Some(start.elapsed().as_secs_f64()), ..PairingTimes::default() };
    let minima = pairs(args, &subject, Kind::Minimum, &mut times)?;
    let maxima = pairs(args, &subject, Kind::Maximum, &mut times)?;
    let page = match &args.report {
        Some(path) => Some((path, html(path, &subject, &[&minima, &maxima], options(args))?)),
        None => None,
    };
    let count = minima.persistent + maxima.persistent;
    let mut extrema = ordered(args.method, extrema(&minima, &subject.places), extrema(&maxima, &subject.places));
    if args.min_persistence.is_none() {
        extrema.truncate(args.count.unwrap_or(COUNT));
    }
    let start = Instant::now();
    let input = MeshInput {
        path: args.input.display().to_string(),
        vertices: subject.vertex_count(),
        faces: faces(&subject.places),
    };
    let mut report = FeaturesReport { schema: SCHEMA, input, method: args.method, count, extrema, times };
    let mut files = Files::new();
    if let Some((path, page)) = page {
        files.write_text(path, &page)?;
    }
    write(args, &subject, &report, &mut files)?;
    files.finish()?;
    report.times.write = Some(start.elapsed().as_secs_f64());
    if args.json { output::print_json(&report) } else { output::print_table(&text(&report)) }
}

fn check_outputs(args: &FeaturesArgs) -> Result<(), CommandError> {
    args.output.as_deref().map_or(Ok(""), |path| output::extension(path, &["csv", "json"]))?;
    args.picture.as_deref().map_or(Ok(""), |path| output::extension(path, &["png"]))?;
    args.report.as_deref().map_or(Ok(""), |path| output::extension(path, &["html"]))?;
    let inputs: Vec<&Path> = [Some(args.input.as_path()), args.field.file()].into_iter().flatten().collect();
    let outputs: Vec<&Path> =
        [&args.output, &args.picture, &args.report].into_iter().filter_map(|path| path.as_deref()).collect();
    output::check(&inputs, &outputs)?;
    output::check_json(args.json, &outputs)
}

fn options(args: &FeaturesArgs) -> PersistenceOptions {
    // A computed field is NaN where a mesh has no surface, which is no mistake of anyone's.
    let nan = if args.field.is_computed() { NanPolicy::Mask } else { args.nan.policy() };
    PersistenceOptions::new().nan(nan)
}

fn pairs(
    args: &FeaturesArgs,
    subject: &DomainField,
    kind: Kind,
    times: &mut PairingTimes,
) -> Result<PairList, CommandError> {
    let start = Instant::now();
    let wanted = Wanted { options: options(args), min_persistence: args.min_persistence.unwrap_or(0.0), top: None };
    let mut list = PairList::new(subject, kind, &wanted).map_err(|error| explain(&subject.path, error))?;
    // A vertex on its own, or a part where the field is constant, is no feature.
    list.pairs.retain(|pair| pair.persistence.to_f64() > wanted.min_persistence);
    times.add(kind, start.elapsed());
    Ok(list)
}

fn extrema(list: &PairList, places: &Places) -> Vec<FeaturePoint> {
    let extremum = |pair: &Pair| FeaturePoint {
        vertex: pair.extremum,
        position: places.point(pair.extremum).expect("a mesh's vertices are in space"),
        kind: list.kind.name(),
        value: pair.birth,
        persistence: pair.persistence,
        saddle: pair.saddle,
    };
    list.pairs.iter().map(extremum).collect()
}

/// The extrema of both kinds in one order, each kind given most persistent first; a maximum comes first.
fn ordered(method: OrderName, minima: Vec<FeaturePoint>, maxima: Vec<FeaturePoint>) -> Vec<FeaturePoint> {
    let mut ranked: Vec<(usize, FeaturePoint)> =
        maxima.into_iter().enumerate().chain(minima.into_iter().enumerate()).collect();
    match method {
        OrderName::Persistence => ranked.sort_by(|a, b| b.1.persistence.to_f64().total_cmp(&a.1.persistence.to_f64())),
        OrderName::Alternating => ranked.sort_by_key(|(rank, _)| *rank),
    }
    ranked.into_iter().map(|(_, extremum)| extremum).collect()
}

fn faces(places: &Places) -> usize {
    if let Places::Mesh { triangles, .. } = places { triangles.len() } else { 0 }
}

fn write(
    args: &FeaturesArgs,
    subject: &DomainField,
    report: &FeaturesReport,
    files: &mut Files,
) -> Result<(), CommandError> {
    if let Some(path) = &args.output {
        match output::extension(path, &["csv", "json"])? {
            "csv" => files.write_csv(path, &rows(report))?,
            _ => files.write_json(path, report)?,
        }
    }
    if let (Some(path), Places::Mesh { points, triangles }) = (&args.picture, &subject.places) {
        let mark = |e: &FeaturePoint| Mark { vertex: e.vertex as u32, positive: e.kind == Kind::Minimum.name() };
        let marks = report.extrema.iter().map(mark).collect();
        let scene = Scene::new(points, triangles.clone(), vec![[[0.0; 2]; 3]; triangles.len()], vec![], marks);
        let paint = Paint::field(&subject.values.to_f64(), triangles, "the field");
        files.write_png(path, &draw_model(&scene, &paint, args.shot.shot()))?;
    }
    Ok(())
}

/// A table that fits 80 columns with a million vertices; saddles are in the files.
fn text(report: &FeaturesReport) -> String {
    let head = ["#", "vertex", "kind", "value", "persistence", "x", "y", "z"].map(String::from).to_vec();
    let mut rows = vec![head];
    for (i, extremum) in report.extrema.iter().enumerate() {
        let mut row = vec![
            (i + 1).to_string(),
            extremum.vertex.to_string(),
            extremum.kind.to_owned(),
            significant(extremum.value.to_f64(), 4),
            extremum.persistence.short(),
        ];
        row.extend(extremum.position.map(|x| significant(x, 5)));
        rows.push(row);
    }
    let points = counted(report.extrema.len(), "feature point", "feature points");
    format!("{}{points} of {}\n", columns(&rows), counted(report.count, "extremum", "extrema"))
}

/// The feature points as rows of a table under a head.
fn rows(report: &FeaturesReport) -> Vec<Vec<String>> {
    let head = ["vertex", "kind", "value", "persistence", "saddle", "x", "y", "z"].map(str::to_owned).to_vec();
    let row = |FeaturePoint { vertex, position, kind, value, persistence, saddle }: &FeaturePoint| {
        let saddle = saddle.map_or_else(String::new, |saddle| saddle.to_string());
        let mut row = vec![vertex.to_string(), (*kind).to_owned(), value.to_string(), persistence.to_string(), saddle];
        row.extend(position.map(|x| format!("{x:?}")));
        row
    };
    std::iter::once(head).chain(report.extrema.iter().map(row)).collect()
}
