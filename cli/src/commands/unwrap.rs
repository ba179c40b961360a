//! `cones unwrap`: a surface in, its texture coordinates out.

use crate::commands::shared::{
    CandidateArgs, CheckerFiles, PackArgs, Scale, SeamArgs, Unwrapped, non_negative, page_file,
};
use crate::error::CommandError;
use crate::input::{self, cone_file};
use crate::output;
use crate::progress::Progress;
use crate::render::{self, Scene};
use crate::report::table::labelled;
use crate::report::{HierarchyFile, Times, UnwrapReport};
use clap::{Args, ValueEnum};
use cones::uv::PackOptions;
use cones::{ConeChoice, Islands, Options};
use geom::io::{ObjContent, write_glb, write_obj, write_ply};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Args, Debug)]
pub(crate) struct UnwrapArgs {
    /// The surface: OBJ, OFF, PLY or STL, gzipped or not
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Where to write it with texture coordinates: .obj, .ply or .glb
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    candidates: CandidateArgs,
    #[command(flatten)]
    seams: SeamArgs,
    /// Given cones: a file of lines `vertex curvature` or `vertex`, vertices counted from 0
    #[arg(long, value_name = "FILE", group = "which")]
    cones: Option<PathBuf>,
    /// What to do where the layout lies over itself
    #[arg(long, value_enum, default_value_t = IslandsName::OverlapFree)]
    islands: IslandsName,
    #[command(flatten)]
    packing: PackArgs,
    /// With --islands pack, the share by which seams may become longer
    #[arg(long, value_name = "SHARE", value_parser = non_negative, default_value_t = PackOptions::default().max_seam)]
    max_seam: f64,
    /// Size of the texture coordinates
    #[arg(long, value_enum, default_value_t = Scale::Unit)]
    scale: Scale,
    /// Write the triangles that were computed with in place of the input's polygons
    #[arg(long)]
    triangulate: bool,
    /// Write a report: .json, or .html with surface, maps and cones to see in a browser
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Write the cones and their curvatures, as --cones reads them
    #[arg(long, value_name = "FILE")]
    cones_out: Option<PathBuf>,
    /// Write the order of cones for every number of them, with what is predicted for each: .json
    #[arg(long, value_name = "FILE")]
    hierarchy: Option<PathBuf>,
    /// Draw the model with checkerboard, seams and cones: .png
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Draw the layout: .png or .svg
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// Give an OBJ a checkerboard to see: a material (.mtl) and its picture (.png) beside it
    #[arg(long)]
    checker: bool,
    /// Print the report as JSON in place of the text
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum IslandsName {
    /// Leave it: each part of the surface is one island
    Single,
    /// Cut it and attach what is cut off across other seams, until nothing lies over itself
    OverlapFree,
    /// The same, and cut further where islands then fill more of the square: see --max-seam
    Pack,
}

pub(crate) fn run(args: &UnwrapArgs) -> Result<(), CommandError> {
    check_outputs(args)?;
    let mut options = options(args)?;
    let edges = args.seams.read(&mut options)?;
    let progress = Progress::begin(&args.input.display().to_string());
    let began = Instant::now();
    let (model, read) = input::read_model(&args.input)?;
    args.seams.keep(&args.input, &model, &mut options)?;
    let unwrapped = Unwrapped::new(&args.input, model, options, args.scale, &progress);
    let mut unwrapped = unwrapped.map_err(|error| edges.place(error))?;
    if !args.triangulate && output::extension(&args.output, &["obj", "ply", "glb"])? != "glb" {
        unwrapped.note_polygons();
    }
    progress.step("write");
    let start = Instant::now();
    write_surface(&unwrapped, args)?;
    write_extras(args, &unwrapped)?;
    let write = Some(start.elapsed().as_secs_f64());
    let draw = draw(args, &unwrapped, &progress)?;
    if let Some(path) = args.page()? {
        output::write_text(path, &page_file::html(&args.input, &unwrapped, &progress)?)?;
    }
    let total = Some(began.elapsed().as_secs_f64());
    let report = unwrapped.report(&args.input, Times { read: Some(read), write, draw, total, ..Times::default() });
    if let (Some(path), None) = (&args.report, args.page()?) {
        output::write_json(path, &report)?;
    }
    progress.finish();
    unwrapped.warn();
    if args.json { output::print_json(&report) } else { output::summary(&summary(&report, args)) }
}

/// The library's options.
fn options(args: &UnwrapArgs) -> Result<Options, CommandError> {
    let islands = match args.islands {
        IslandsName::Single => Islands::Single,
        IslandsName::OverlapFree => Islands::OverlapFree,
        IslandsName::Pack => Islands::Pack,
    };
    let packing = PackOptions { max_seam: args.max_seam, ..args.packing.options(1.0) };
    let options = Options { islands, packing, ..args.candidates.options_for(&args.input) };
    Ok(match &args.cones {
        Some(file) => Options { cones: ConeChoice::Given(cone_file::read(file)?), ..options },
        None => options,
    })
}

/// Endings and places of the outputs, before anything is computed.
fn check_outputs(args: &UnwrapArgs) -> Result<(), CommandError> {
    output::extension(&args.output, &["obj", "ply", "glb"])?;
    let endings: [(&Option<_>, &[&str]); 4] = [
        (&args.report, &["json", "html"]),
        (&args.hierarchy, &["json"]),
        (&args.picture, &["png"]),
        (&args.layout, &["png", "svg"]),
    ];
    for (path, wanted) in endings {
        if let Some(path) = path {
            output::extension(path, wanted)?;
        }
    }
    let inputs = [Some(&args.input), args.cones.as_ref()].into_iter().flatten().map(|p| &**p);
    let inputs: Vec<&Path> = inputs.chain(args.seams.files()).collect();
    if args.checker && output::extension(&args.output, &["obj", "ply", "glb"])? != "obj" {
        let (path, option, of) = (args.output.clone(), "--checker", "an .obj");
        return Err(CommandError::Misplaced { path, option, of });
    }
    let checker = args.checker();
    let mut outputs = outputs(args);
    outputs.extend(checker.iter().flat_map(CheckerFiles::paths));
    output::check(&inputs, &outputs)
}

impl UnwrapArgs {
    /// The report, if it is one for a browser.
    fn page(&self) -> Result<Option<&Path>, CommandError> {
        let Some(path) = &self.report else { return Ok(None) };
        Ok((output::extension(path, &["json", "html"])? == "html").then_some(path))
    }

    /// The files of the checkerboard, if it is asked for.
    fn checker(&self) -> Option<CheckerFiles> {
        self.checker.then(|| CheckerFiles::beside(&self.output))
    }
}

fn outputs(args: &UnwrapArgs) -> Vec<&Path> {
    let all = [
        Some(&args.output),
        args.report.as_ref(),
        args.cones_out.as_ref(),
        args.hierarchy.as_ref(),
        args.picture.as_ref(),
        args.layout.as_ref(),
    ];
    all.into_iter().flatten().map(|p| &**p).collect()
}

fn write_surface(unwrapped: &Unwrapped, args: &UnwrapArgs) -> Result<(), CommandError> {
    let UnwrapArgs { output: path, triangulate, .. } = args;
    let triangles = unwrapped.model.triangles();
    let asked = (*triangulate).then_some(&triangles);
    let uv = Some(unwrapped.uv.as_slice());
    match output::extension(path, &["obj", "ply", "glb"])? {
        "ply" => output::write(path, |out| write_ply(&unwrapped.model, uv, asked, out)),
        "glb" => {
            let texture = render::Checker::texture().png();
            output::write(path, |out| write_glb(&unwrapped.model, uv, &triangles, Some(&texture?), out))
        }
        _ => {
            let checker = args.checker();
            let material = checker.as_ref().map(|checker| checker.material());
            let content = ObjContent { uv, triangles: asked, material };
            output::write(path, |out| write_obj(&unwrapped.model, &content, out))?;
            checker.map_or(Ok(()), |checker| checker.write())
        }
    }
}

fn write_extras(args: &UnwrapArgs, unwrapped: &Unwrapped) -> Result<(), CommandError> {
    if let Some(path) = &args.cones_out {
        output::write_text(path, &cone_file::text(&unwrapped.atlas.cones))?;
    }
    if let Some(path) = &args.hierarchy {
        let order = args.candidates.order(&unwrapped.analysis, unwrapped.atlas.cones.len());
        let order = order.map_err(|error| CommandError::Unwrap { path: args.input.clone(), error })?;
        output::write_json(path, &HierarchyFile::new(order))?;
    }
    Ok(())
}

/// Draws what is asked for; how many seconds that took.
fn draw(args: &UnwrapArgs, unwrapped: &Unwrapped, progress: &Progress) -> Result<Option<f64>, CommandError> {
    if args.picture.is_none() && args.layout.is_none() {
        return Ok(None);
    }
    progress.step("draw");
    let start = Instant::now();
    let scene = unwrapped.scene();
    if let Some(path) = &args.picture {
        output::write_png(path, &render::draw_model(&scene))?;
    }
    if let Some(path) = &args.layout {
        write_layout(path, &scene)?;
    }
    Ok(Some(start.elapsed().as_secs_f64()))
}

fn write_layout(path: &Path, scene: &Scene) -> Result<(), CommandError> {
    match output::extension(path, &["png", "svg"])? {
        "svg" => output::write_text(path, &render::draw_layout_svg(scene)),
        _ => output::write_png(path, &render::draw_layout(scene)),
    }
}

fn summary(report: &UnwrapReport, args: &UnwrapArgs) -> String {
    let checker = args.checker();
    let all = outputs(args).into_iter().chain(checker.iter().flat_map(CheckerFiles::paths));
    let written: Vec<String> = all.map(|p| p.display().to_string()).collect();
    report.text() + &labelled("written", &written.join(", "))
}
