//! `cones unwrap`: a surface in, its texture coordinates out; or many.

mod many;

use crate::commands::shared::{
    Bake, CandidateArgs, ColourName, FormatName, HIERARCHY_ENDINGS, MapTextures, MaterialFiles, PackArgs, Scale,
    SeamArgs, ShotArgs, SurfaceFile, Unwrapped, non_negative, page_file, vtp_text, whole, write_hierarchy,
};
use crate::error::CommandError;
use crate::input::{self, ConeFile, cone_file};
use crate::output::{self, Files};
use crate::progress::Progress;
use crate::render::{self, Paint, Picture, Scene};
use crate::report::table::labelled;
use crate::report::{Times, UnwrapReport};
use clap::{ArgGroup, Args, ValueEnum};
use cones::uv::PackOptions;
use cones::{ConeChoice, ConeOrder, Islands, Options};
use geom::io::MeshFormat;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Args, Debug)]
#[command(group = ArgGroup::new("target").args(["output", "out_dir"]).required(true))]
#[command(group = ArgGroup::new("drawn").args(["picture", "layout"]).multiple(true))]
#[command(after_help = EXAMPLES)]
pub(crate) struct UnwrapArgs {
    /// The surface: OBJ, OFF, PLY, STL or glTF, gzipped or not; - is standard input
    #[arg(value_name = "IN", required = true)]
    inputs: Vec<PathBuf>,
    /// Where to write it with texture coordinates: .obj, .ply or .glb, also .gz; - is standard output
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// The format to write, where no ending tells
    #[arg(long, value_enum)]
    format: Option<FormatName>,
    /// Write the triangles that were computed with in place of the input's polygons
    #[arg(long)]
    triangulate: bool,
    /// Size of the texture coordinates
    #[arg(long, value_enum, default_value_t = Scale::Unit)]
    scale: Scale,
    /// Write a report: .json, or .html with surface, maps and cones to see in a browser, which takes ten to twenty times as long
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Print the report as JSON in place of the text
    #[arg(long)]
    json: bool,
    #[command(flatten, next_help_heading = "Cones")]
    candidates: CandidateArgs,
    /// Given cones: a file of lines `vertex curvature` or `vertex`, vertices counted from 0
    #[arg(long, value_name = "FILE", group = "which", help_heading = "Cones")]
    cones: Option<PathBuf>,
    /// Write the cones and their curvatures, as --cones reads them
    #[arg(long, value_name = "FILE", help_heading = "Cones")]
    cones_out: Option<PathBuf>,
    /// Write the order of cones for every number of them, with what is predicted for each: .json or .csv
    #[arg(long, value_name = "FILE", help_heading = "Cones")]
    hierarchy: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Seams")]
    seams: SeamArgs,
    /// What to do where the layout lies over itself
    #[arg(long, value_enum, default_value_t = IslandsName::OverlapFree, help_heading = "Islands")]
    islands: IslandsName,
    /// With --islands pack, the share by which seams may become longer; where there are hardly any, as of a flat ring, of four roots of the
    /// area [default: 0.1]
    #[arg(long, value_name = "SHARE", value_parser = non_negative, allow_negative_numbers = true, help_heading = "Islands")]
    max_seam: Option<f64>,
    #[command(flatten, next_help_heading = "Islands")]
    packing: PackArgs,
    /// Draw the model with seams and cones: .png
    #[arg(long, value_name = "FILE", help_heading = "Pictures")]
    picture: Option<PathBuf>,
    /// Draw the layout: .png or .svg
    #[arg(long, value_name = "FILE", help_heading = "Pictures")]
    layout: Option<PathBuf>,
    /// What both are coloured by
    #[arg(long, value_enum, default_value_t = ColourName::Checker, requires = "drawn", help_heading = "Pictures")]
    colour: ColourName,
    #[command(flatten, next_help_heading = "Pictures")]
    shot: ShotArgs,
    /// Give an OBJ a checkerboard to see in place of its materials: one (.mtl) and its picture (.png) beside it
    #[arg(long, help_heading = "Pictures")]
    checker: bool,
    /// Write surface, seams and cones with all that is known of them for programs that use VTK: .vtp
    #[arg(long, value_name = "FILE", help_heading = "Pictures")]
    vtp: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Many surfaces")]
    many: ManyArgs,
}

const EXAMPLES: &str = "\
Examples:
  cones unwrap scan.ply -o scan.glb
  cones unwrap scan.ply -n 12 --islands pack -o scan.obj --report scan.html
  cones unwrap scans/*.ply --out-dir maps";

/// Many surfaces, each to a file of its own.
#[derive(Args, Debug)]
struct ManyArgs {
    /// Write each surface under its own name into this folder, in its own format where that can be written, else as OBJ; an error in
    /// one stops no other
    #[arg(
        long,
        value_name = "FOLDER",
        conflicts_with_all =
            [
                "output", "report", "cones_out", "hierarchy", "vtp", "picture", "layout", "view", "size", "colour", "cones", "seams",
                "avoid",
            ]
    )]
    out_dir: Option<PathBuf>,
    /// How many surfaces to work on at a time, which share the threads [default: as many as threads]
    #[arg(long, value_name = "J", value_parser = whole::<NonZeroUsize>("number of surfaces", 1..), allow_negative_numbers = true, conflicts_with = "output")]
    jobs: Option<NonZeroUsize>,
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
    args.packing.check();
    args.seams.check();
    check_max_seam(args);
    check_scale(args);
    args.candidates.warn_of_idle_smoothing();
    match (&args.many.out_dir, &args.output) {
        (Some(folder), _) => many::run(args, folder),
        (None, Some(output)) => run_one(args, output),
        // The arguments ask for one of them.
        (None, None) => Ok(()),
    }
}

/// Ends the run, as for any option that lacks another, where nothing would heed how much longer seams may be.
fn check_max_seam(args: &UnwrapArgs) {
    if args.max_seam.is_some() && !matches!(args.islands, IslandsName::Pack) {
        let message = "--max-seam is for --islands pack: add that, or leave --max-seam out\n";
        clap::Error::raw(clap::error::ErrorKind::MissingRequiredArgument, message).exit()
    }
}

/// Tiles are unit squares: islands in another size would lie across them.
fn check_scale(args: &UnwrapArgs) {
    if args.packing.is_udim() && !matches!(args.scale, Scale::Unit) {
        let message = "--udim puts islands on tiles that are unit squares, by --texel-density: leave --scale out\n";
        clap::Error::raw(clap::error::ErrorKind::ArgumentConflict, message).exit()
    }
}

/// One surface, with all that may be written of it.
fn run_one(args: &UnwrapArgs, output: &Path) -> Result<(), CommandError> {
    let [input] = args.inputs.as_slice() else {
        let message = "several surfaces cannot be written to one file: name a folder with --out-dir in place of -o\n";
        clap::Error::raw(clap::error::ErrorKind::ArgumentConflict, message).exit()
    };
    let format = check_outputs(args, input, output)?;
    let job = Job { args, input, output, format };
    let progress = Progress::begin(&input.display().to_string());
    let began = Instant::now();
    let (mut unwrapped, times) = job.unwrap(&progress)?;
    if args.hierarchy.is_some() {
        unwrapped.note_closed_order();
    }
    let extras = Extras::new(args, input, &unwrapped, &progress)?;
    let draw = extras.draw;
    progress.step("write");
    let start = Instant::now();
    let mut files = Files::new();
    job.write(&mut unwrapped, &mut files)?;
    extras.write(args, &unwrapped, &mut files)?;
    let write = Some(start.elapsed().as_secs_f64());
    let total = Some(began.elapsed().as_secs_f64());
    let report = unwrapped.report(input, Times { write, draw, total, ..times });
    if let (Some(path), None) = (&args.report, args.page()?) {
        files.write_json(path, &report)?;
    }
    files.finish()?;
    progress.finish();
    unwrapped.warn();
    if args.json { output::print_json(&report) } else { output::summary(&summary(&report, args, output)) }
}

/// One surface to one file.
struct Job<'a> {
    args: &'a UnwrapArgs,
    input: &'a Path,
    output: &'a Path,
    format: MeshFormat,
}

impl Job<'_> {
    /// Reads and unwraps it; the time of reading.
    fn unwrap(&self, progress: &Progress) -> Result<(Unwrapped, Times), CommandError> {
        let Self { args, input, format, .. } = *self;
        let mut options = options(args, input);
        let cones = args.cones.as_deref().map(ConeFile::read).transpose()?;
        if let Some(cones) = &cones {
            options.cones = ConeChoice::Recipe(Box::new(cones.recipe()));
        }
        args.candidates.warn_of_idle_choice(&options);
        let edges = args.seams.read(&mut options)?;
        let (model, read) = input::read_model(input)?;
        let textures = MapTextures::of(&model, input);
        let (model, split) = args.candidates.with_edges_split(model);
        args.seams.keep(input, &model, &mut options)?;
        let place = |error| edges.place(placed(cones.as_ref(), error));
        let mut unwrapped = Unwrapped::new(input, model, options, args.scale, progress).map_err(place)?;
        unwrapped.map.flaws.extend(split);
        let is_cut = args.triangulate || format == MeshFormat::Glb;
        if !is_cut {
            unwrapped.note_polygons();
        } else if unwrapped.has_overlapping_polygons() {
            unwrapped = unwrapped.triangulated(input, args.scale, progress).map_err(place)?;
        }
        unwrapped.map.flaws.extend(self.textures_do_not_fit(&textures));
        Ok((unwrapped, Times { read: Some(read), ..Times::default() }))
    }

    /// That the textures are for the old map, where there are any that no checkerboard is in place of.
    fn textures_do_not_fit(&self, textures: &MapTextures) -> Option<String> {
        let bake = Bake::of_tiles(self.args.packing.is_udim());
        textures.do_not_fit(self.output, bake).filter(|_| !self.args.checker)
    }

    /// Writes it, with its checkerboard, and notes what the format does not hold; how many seconds that took.
    fn write(&self, unwrapped: &mut Unwrapped, files: &mut Files) -> Result<f64, CommandError> {
        let Self { args, output, format, .. } = *self;
        let start = Instant::now();
        let triangles = args.triangulate.then(|| unwrapped.model.triangles());
        let checker = args.checker(output);
        let file = SurfaceFile {
            model: &unwrapped.model,
            source: Some(self.input),
            uv: Some(&unwrapped.map.uv),
            triangles: triangles.as_ref(),
            material: checker.as_ref().map(MaterialFiles::material),
        };
        let lost = file.write(files, output, format)?;
        checker.as_ref().map_or(Ok(()), |checker| checker.write_checker(files))?;
        unwrapped.map.flaws.extend(lost.map(|lost| lost.to_string()));
        Ok(start.elapsed().as_secs_f64())
    }
}

/// An error with the line of the cone that it is about.
fn placed(cones: Option<&ConeFile>, error: CommandError) -> CommandError {
    match (cones, error) {
        (Some(cones), CommandError::Unwrap { path, error }) => {
            cones.place(error).map_or_else(|error| CommandError::Unwrap { path, error }, CommandError::from)
        }
        (_, error) => error,
    }
}

/// The library's options, but for files.
fn options(args: &UnwrapArgs, input: &Path) -> Options {
    let islands = match args.islands {
        IslandsName::Single => Islands::Single,
        IslandsName::OverlapFree => Islands::OverlapFree,
        IslandsName::Pack => Islands::Pack,
    };
    let packing = args.packing.options();
    let packing = PackOptions { max_seam: args.max_seam.unwrap_or(packing.max_seam), ..packing };
    Options { islands, packing, ..args.candidates.options_for(input) }
}

/// Endings and places of the outputs, before anything is computed; the format of the surface.
fn check_outputs(args: &UnwrapArgs, input: &Path, output: &Path) -> Result<MeshFormat, CommandError> {
    if output.is_dir() {
        return Err(CommandError::OutputIsOutDir(output.to_owned()));
    }
    let format = output::surface_format(output, args.format.map(MeshFormat::from))?;
    let endings: [(&Option<_>, &[&str]); 5] = [
        (&args.report, &["json", "html"]),
        (&args.hierarchy, &HIERARCHY_ENDINGS),
        (&args.vtp, &["vtp"]),
        (&args.picture, &["png"]),
        (&args.layout, &["png", "svg"]),
    ];
    for (path, wanted) in endings {
        if let Some(path) = path {
            output::extension(path, wanted)?;
        }
    }
    check_checker(args, output, format)?;
    let inputs = [Some(input), args.cones.as_deref()].into_iter().flatten();
    let inputs: Vec<&Path> = inputs.chain(args.seams.files()).collect();
    let checker = args.checker(output);
    let mut outputs = outputs(args, output);
    let is_named = |path: &&Path| outputs.contains(path);
    if let Some(taken) = checker.iter().flat_map(MaterialFiles::paths).find(is_named) {
        return Err(CommandError::CheckerTaken(taken.to_owned()));
    }
    outputs.extend(checker.iter().flat_map(MaterialFiles::paths));
    output::check_json(args.json, &outputs)?;
    output::check(&inputs, &outputs)?;
    Ok(format)
}

/// A checkerboard is a file beside an OBJ; glTF has one within.
fn check_checker(args: &UnwrapArgs, output: &Path, format: MeshFormat) -> Result<(), CommandError> {
    if args.checker && format != MeshFormat::Obj {
        let (path, option, of) = (output.to_owned(), "--checker", "an .obj");
        return Err(CommandError::Misplaced { path, option, of });
    }
    Ok(())
}

impl UnwrapArgs {
    /// The report, if it is one for a browser.
    fn page(&self) -> Result<Option<&Path>, CommandError> {
        let Some(path) = &self.report else { return Ok(None) };
        Ok((output::extension(path, &["json", "html"])? == "html").then_some(path))
    }

    /// The files of the checkerboard, if it is asked for.
    fn checker(&self, output: &Path) -> Option<MaterialFiles> {
        self.checker.then(|| MaterialFiles::checker(output))
    }
}

fn outputs<'a>(args: &'a UnwrapArgs, output: &'a Path) -> Vec<&'a Path> {
    let extras = [&args.report, &args.cones_out, &args.hierarchy, &args.vtp, &args.picture, &args.layout];
    std::iter::once(output).chain(extras.into_iter().flatten().map(|p| &**p)).collect()
}

/// What other files than the surface hold, as far as it takes long: it is there before anything is written.
struct Extras {
    order: Option<ConeOrder>,
    picture: Option<Picture>,
    layout: Option<Drawing>,
    page: Option<String>,
    /// How many seconds pictures and page took.
    draw: Option<f64>,
}

/// A layout in either form.
enum Drawing {
    Pixels(Picture),
    Svg(String),
}

impl Extras {
    fn new(args: &UnwrapArgs, input: &Path, unwrapped: &Unwrapped, progress: &Progress) -> Result<Self, CommandError> {
        let order = args.hierarchy.as_ref();
        let order = order.map(|_| args.candidates.order(&unwrapped.analysis, unwrapped.map.atlas.cones.len()));
        let order = order.transpose().map_err(|error| CommandError::Unwrap { path: input.to_owned(), error })?;
        let start = Instant::now();
        let (mut picture, mut layout) = (None, None);
        if args.picture.is_some() || args.layout.is_some() {
            progress.step("draw");
            let scene = unwrapped.scene();
            let paint = unwrapped.paint(args.colour, &scene);
            picture = args.picture.as_ref().map(|_| render::draw_model(&scene, &paint, args.shot.shot()));
            layout = args.layout.as_ref().map(|path| drawn_layout(path, &scene, &paint)).transpose()?;
        }
        let page = args.page()?.map(|_| page_file::html(input, unwrapped, progress)).transpose()?;
        let is_drawn = picture.is_some() || layout.is_some() || page.is_some();
        let draw = is_drawn.then(|| start.elapsed().as_secs_f64());
        Ok(Self { order, picture, layout, page, draw })
    }

    fn write(self, args: &UnwrapArgs, unwrapped: &Unwrapped, files: &mut Files) -> Result<(), CommandError> {
        if let Some(path) = &args.cones_out {
            files.write_text(path, &cone_file::text(unwrapped.map.atlas.recipe()))?;
        }
        if let (Some(path), Some(order)) = (&args.hierarchy, self.order) {
            write_hierarchy(files, path, order)?;
        }
        if let Some(path) = &args.vtp {
            files.write_text(path, &vtp_text(unwrapped))?;
        }
        if let (Some(path), Some(picture)) = (&args.picture, self.picture) {
            files.write_png(path, &picture)?;
        }
        match (&args.layout, self.layout) {
            (Some(path), Some(Drawing::Svg(text))) => files.write_text(path, &text)?,
            (Some(path), Some(Drawing::Pixels(picture))) => files.write_png(path, &picture)?,
            _ => {}
        }
        if let (Some(path), Some(page)) = (args.page()?, self.page) {
            files.write_text(path, &page)?;
        }
        Ok(())
    }
}

fn drawn_layout(path: &Path, scene: &Scene, paint: &Paint) -> Result<Drawing, CommandError> {
    Ok(match output::extension(path, &["png", "svg"])? {
        "svg" => Drawing::Svg(render::draw_layout_svg(scene, paint)),
        _ => Drawing::Pixels(render::draw_layout(scene, paint)),
    })
}

fn summary(report: &UnwrapReport, args: &UnwrapArgs, output: &Path) -> String {
    let checker = args.checker(output);
    let all = outputs(args, output).into_iter().chain(checker.iter().flat_map(MaterialFiles::paths));
    let written: Vec<String> = all.map(|p| p.display().to_string()).collect();
    report.text() + &labelled("written", &written.join(", "))
}
