//! `cones pack`: the islands of any unwrapped OBJ, PLY or glTF, packed.

use crate::commands::shared::{PackArgs, SurfaceFile, WeldArgs, corner_uv, texture};
use crate::error::CommandError;
use crate::input;
use crate::output::{self, Files};
use crate::report::table::{counted, labelled};
use crate::report::{SCHEMA, tiles_text};
use clap::Args;
use cones::uv::{PackError, Packing, fill, pack};
use geom::distortion::{Distortion, measure, unit_on_surface};
use geom::io::MeshFormat;
use geom::{Model, Watch};
use serde::Serialize;
use std::path::PathBuf;

/// Islands are moved rigidly and scaled alike. Islands that lie over each other, mirrored halves that share their texture
/// for example, get a place each.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct PackCommandArgs {
    /// A surface with texture coordinates: OBJ, PLY or glTF
    #[arg(value_name = "UV")]
    input: PathBuf,
    /// Where to write it packed: .obj, .ply or .glb, also .gz; an OBJ's other lines are kept
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    weld: WeldArgs,
    #[command(flatten)]
    packing: PackArgs,
    /// Print JSON in place of the text
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  cones pack theirs.obj -o packed.obj --margin 8 --texture-size 2048
  cones pack theirs.glb -o tiles.glb --udim --texel-density 256";

#[derive(Debug, Serialize)]
struct PackReport {
    schema: u32,
    input: String,
    islands: usize,
    tiles: usize,
    /// The share of the tiles that is covered, before and after.
    fill_before: f64,
    fill: f64,
    /// Texels between islands.
    margin: f64,
}

pub(crate) fn run(args: &PackCommandArgs) -> Result<(), CommandError> {
    args.packing.check();
    let format = output::surface_format(&args.output, None)?;
    output::check(&[&args.input], &[&args.output])?;
    let (model, _) = input::read_model(&args.input)?;
    let uv = texture(&args.input, &model)?;
    let triangles = model.triangles();
    let corners = corner_uv(&triangles.corners, &uv);
    let mut vertices = triangles.vertices(&model);
    args.weld.chosen().apply(&model, &mut vertices);
    let measured = measure(model.points(), &vertices, &corners)
        .map_err(|error| CommandError::Measure { path: args.input.clone(), error })?;
    let packing = packing(args, &model, &corners, &measured)?;
    let mut placed = uv;
    for (t, &island) in triangles.corners.iter().zip(measured.triangle_island.iter()) {
        t.iter().zip(corner_of(&model, t)).for_each(|(&c, p)| placed[c as usize] = packing.place(island as usize, p));
    }
    write(&model, &placed, args, format)?;
    args.packing.warn_of_margin(packing.margin);
    let report = PackReport {
        schema: SCHEMA,
        input: args.input.display().to_string(),
        islands: measured.islands.len(),
        tiles: packing.tiles,
        fill_before: fill(&corners),
        fill: packing.fill,
        margin: packing.margin,
    };
    if args.json { output::print_json(&report) } else { output::summary(&text(&report, args)) }
}

/// The texture coordinates that the file has at corners of the model.
fn corner_of(model: &Model, corners: &[u32; 3]) -> [[f64; 2]; 3] {
    corners.map(|c| model.uv().and_then(|uv| uv.corner(c as usize)).unwrap_or_default())
}

fn packing(
    args: &PackCommandArgs,
    model: &Model,
    uv: &[[[f64; 2]; 3]],
    measured: &Distortion,
) -> Result<Packing, CommandError> {
    let vertices = model.triangles().vertices(model);
    let unit = unit_on_surface(model.points(), &vertices, uv);
    let options = args.packing.options(unit);
    let failed = |error: PackError| CommandError::Pack { path: args.input.clone(), error: error.in_unit(unit) };
    pack(uv, &measured.triangle_island, &options, Watch::NONE).map_err(failed)
}

fn write(model: &Model, uv: &[[f64; 2]], args: &PackCommandArgs, format: MeshFormat) -> Result<(), CommandError> {
    let file = SurfaceFile { model, source: Some(&args.input), uv: Some(uv), triangles: None, material: None };
    let mut files = Files::new();
    let lost = file.write(&mut files, &args.output, format)?;
    files.finish()?;
    if let Some(lost) = lost {
        output::warn(&lost.to_string());
    }
    Ok(())
}

fn text(report: &PackReport, args: &PackCommandArgs) -> String {
    let tiles = tiles_text(Some(report.tiles));
    let islands = counted(report.islands, "island", "islands");
    let (before, after) = (100.0 * report.fill_before, 100.0 * report.fill);
    let fill = format!("{after:.1} % of {tiles} ({before:.1} % before), {:.3} texels apart", report.margin);
    let written = args.output.display().to_string();
    [labelled("islands", &islands), labelled("fill", &fill), labelled("written", &written)].concat()
}
