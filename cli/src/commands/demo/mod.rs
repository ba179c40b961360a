//! `cones demo`: built-in shapes unwrapped into a folder, to be looked at.

mod gallery;

use crate::commands::shape;
use crate::commands::shared::{MaterialFiles, Scale, Unwrapped};
use crate::error::CommandError;
use crate::output::{self, Files};
use crate::progress::Progress;
use crate::render::{self, Paint, Shot};
use crate::report::table;
use crate::report::{Times, UnwrapReport};
use clap::Args;
use cones::{ConeChoice, Options};
use geom::io::{Material, ObjContent, write_obj};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Args, Debug)]
pub(crate) struct DemoArgs {
    /// The folder to write
    #[arg(value_name = "FOLDER", default_value = "cones-demo")]
    folder: PathBuf,
    /// Print the reports as JSON in place of the table
    #[arg(long)]
    json: bool,
}

/// A shape to show, with how many vertices and cones.
struct Exhibit {
    shape: &'static str,
    vertices: usize,
    cones: usize,
}

const EXHIBITS: [Exhibit; 6] = [
    Exhibit { shape: "hare", vertices: 12_000, cones: 16 },
    Exhibit { shape: "part", vertices: 6_000, cones: 16 },
    Exhibit { shape: "torus-3", vertices: 10_000, cones: 16 },
    Exhibit { shape: "terrain", vertices: 10_000, cones: 8 },
    Exhibit { shape: "capsule", vertices: 5_000, cones: 4 },
    Exhibit { shape: "sphere", vertices: 5_000, cones: 6 },
];

pub(crate) fn run(args: &DemoArgs) -> Result<(), CommandError> {
    let folder = &args.folder;
    make_folder(folder)?;
    // The page first: it marks the folder as a demo's, should the rest be interrupted.
    let mut files = Files::new();
    files.write_text(&folder.join(gallery::NAME), &gallery::text(&EXHIBITS.map(|e| e.shape)))?;
    // The texture that the written shapes refer to.
    let checker = MaterialFiles::checker(&folder.join("checker.obj"));
    checker.write_checker(&mut files)?;
    files.finish()?;
    let reports =
        EXHIBITS.iter().map(|exhibit| show(exhibit, folder, checker.material())).collect::<Result<Vec<_>, _>>()?;
    if args.json {
        return output::print_json(&reports);
    }
    output::summary(&format!(
        "{}\narea D: mean of max(r, 1/r), r a triangle's ratio of areas; quasi-conf.: mean\nratio of a triangle's longest stretch to its shortest; 1 is ideal for both.\n\nWritten to {}: for each shape .obj (with checker.mtl), .png,\n-layout.png and .json; open {} to see them all.\n",
        overview(&reports),
        folder.display(),
        folder.join(gallery::NAME).display()
    ))
}

/// Makes the folder, or takes one that is empty or that a demo has written before.
fn make_folder(folder: &Path) -> Result<(), CommandError> {
    let failed = |source| CommandError::MakeFolder { path: folder.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(failed)?;
    let empty = std::fs::read_dir(folder).map_err(failed)?.next().is_none();
    if empty || gallery::is_ours(folder) { Ok(()) } else { Err(CommandError::NotADemo(folder.to_owned())) }
}

/// Unwraps a shape and writes all its files.
fn show(exhibit: &Exhibit, folder: &Path, material: Material) -> Result<UnwrapReport, CommandError> {
    let progress = Progress::begin(exhibit.shape);
    let model = shape::model(exhibit.shape, exhibit.vertices);
    let file = |ending: &str| folder.join(format!("{}{ending}", exhibit.shape));
    let options = Options { cones: ConeChoice::Count(exhibit.cones), ..Options::default() };
    let unwrapped = Unwrapped::new(Path::new(exhibit.shape), model, options, Scale::Unit, &progress)?;
    progress.step("draw");
    let start = Instant::now();
    let scene = unwrapped.scene();
    let picture = render::draw_model(&scene, &Paint::Checker, Shot::default());
    let layout = render::draw_layout(&scene, &Paint::Checker);
    let draw = Some(start.elapsed().as_secs_f64());
    progress.step("write");
    let start = Instant::now();
    let mut files = Files::new();
    let content = ObjContent { uv: Some(&unwrapped.map.uv), material: Some(material), ..ObjContent::default() };
    files.write(&file(".obj"), |out| write_obj(&unwrapped.model, &content, out))?;
    files.write_png(&file(".png"), &picture)?;
    files.write_png(&file("-layout.png"), &layout)?;
    let write = Some(start.elapsed().as_secs_f64());
    let report = unwrapped.report(Path::new(exhibit.shape), Times { write, draw, ..Times::default() });
    files.write_json(&file(".json"), &report)?;
    files.finish()?;
    progress.finish();
    unwrapped.warn();
    Ok(report)
}

/// A line a shape: how large, how good, and how many seconds it took. The stages are in the reports.
fn overview(reports: &[UnwrapReport]) -> String {
    let head = ["shape", "vertices", "cones", "area D", "quasi-conf.", "flips", "seconds"];
    let mut rows = vec![head.map(String::from).to_vec()];
    for report in reports {
        let d = &report.map.distortion;
        rows.push(vec![
            report.input.path.clone(),
            table::thousands(report.input.topology.vertices),
            report.map.cones.len().to_string(),
            format!("{:.3}", d.area_mean),
            format!("{:.4}", d.quasi_conformal.mean),
            d.flipped.to_string(),
            format!("{:.2}", report.times.stages().map(|(_, time)| time).sum::<f64>()),
        ]);
    }
    table::columns(&rows)
}
