//! `cones pack`: the islands of any unwrapped OBJ, PLY or glTF, packed.

use crate::commands::shared::{Bake, MapTextures, PackArgs, WeldArgs, overlap, texture, write_map};
use crate::error::CommandError;
use crate::input;
use crate::output;
use crate::report::table::{counted, labelled};
use crate::report::{SCHEMA, overlap_text, tiles_text};
use clap::Args;
use cones::uv::{islands_of, repack};
use geom::{Model, Watch, Weld};
use serde::Serialize;
use std::path::PathBuf;

/// Islands are moved rigidly and scaled alike; if no packing that is found is better than how they lie, they stay so. Islands that lie over each
/// other, mirrored halves that share their texture for example, get a place each.
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
    output::check_json(args.json, &[&args.output])?;
    output::check(&[&args.input], &[&args.output])?;
    let (model, _) = input::read_model(&args.input)?;
    let uv = texture(&args.input, &model)?;
    let textures = MapTextures::of(&model, &args.input);
    let apart = textures.apart(&model, &uv);
    let islands = islands_of(&model, &apart, args.weld.chosen(), Watch::NONE)
        .map_err(|error| CommandError::Measure { path: args.input.clone(), error })?;
    let packed = repack(&model, &apart, &islands, (args.weld.chosen(), &args.packing.options()), Watch::NONE)
        .map_err(|error| CommandError::Pack { path: args.input.clone(), error })?;
    write_map(&model, &packed.uv, (&args.input, &args.output), format)?;
    if packed.uv != uv {
        let bake = Bake::of_tiles(args.packing.is_udim());
        let told = textures.become_one(&args.output, bake).or_else(|| textures.do_not_fit(&args.output, bake));
        told.iter().for_each(|told| output::warn(told));
    }
    args.packing.warn_of_margin(packed.packing.margin);
    warn_of_overlap(&model, &packed.uv, args.weld.chosen());
    let report = PackReport {
        schema: SCHEMA,
        input: args.input.display().to_string(),
        islands: packed.packing.places.len(),
        tiles: packed.packing.tiles,
        fill_before: packed.fill_before,
        fill: packed.packing.fill,
        margin: packed.packing.margin,
    };
    if args.json { output::print_json(&report) } else { output::summary(&text(&report, args)) }
}

/// Islands that lie over themselves are packed as they are.
fn warn_of_overlap(model: &Model, uv: &[[f64; 2]], weld: Weld) {
    let found = overlap(model, uv, weld);
    if found.pairs > 0 {
        output::warn(&format!("islands lie over themselves, {}: cones islands takes them apart", overlap_text(found)));
    }
}

fn text(report: &PackReport, args: &PackCommandArgs) -> String {
    let tiles = tiles_text(Some(report.tiles));
    let islands = counted(report.islands, "island", "islands");
    let (before, after) = (100.0 * report.fill_before, 100.0 * report.fill);
    // One island has none that it could keep from.
    let apart = if report.islands > 1 { format!(", {:.3} texels apart", report.margin) } else { String::new() };
    let fill = format!("{after:.1} % of {tiles} ({before:.1} % before){apart}");
    let written = args.output.display().to_string();
    [labelled("islands", &islands), labelled("fill", &fill), labelled("written", &written)].concat()
}
