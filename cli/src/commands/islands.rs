//! `cones islands`: a map that somebody made, taken apart where it lies over itself.

use crate::commands::shared::{Bake, MapTextures, PackArgs, WeldArgs, split_vertices, texture, write_map};
use crate::error::CommandError;
use crate::input;
use crate::output;
use crate::report::table::{counted, labelled};
use crate::report::{SCHEMA, overlap_text};
use clap::Args;
use cones::report::{MeasuredMap, OverlapReport, Quality};
use cones::uv::{Parted, part, repack};
use geom::{Model, Watch};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A map of which nothing overlaps stays as it is. Where anything does, all islands are packed anew, by the options of packing: into the unit
/// square, or with --udim onto tiles.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct IslandsArgs {
    /// A surface with texture coordinates: OBJ, PLY or glTF
    #[arg(value_name = "UV")]
    input: PathBuf,
    /// Where to write it with islands that lie neither over themselves nor over each other: .obj, .ply or .glb, also .gz
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
  cones islands theirs.obj -o apart.obj
  cones islands theirs.glb -o apart.glb --weld --rotations quarter";

#[derive(Debug, Serialize)]
struct IslandsReport {
    schema: u32,
    input: PartedInput,
    before: MapReport,
    after: MapReport,
    /// Whether islands were moved and scaled, as all are where any lay over itself or another.
    packed: bool,
    /// How many pairs of triangles could not be parted.
    left: usize,
}

#[derive(Debug, Serialize)]
struct PartedInput {
    path: String,
    vertices: usize,
    faces: usize,
}

/// What matters here of a map.
#[derive(Debug, Serialize)]
struct MapReport {
    islands: usize,
    #[serde(flatten)]
    overlap: OverlapReport,
    seam_length: f64,
    flipped: usize,
}

pub(crate) fn run(args: &IslandsArgs) -> Result<(), CommandError> {
    args.packing.check();
    let format = output::surface_format(&args.output, None)?;
    output::check_json(args.json, &[&args.output])?;
    output::check(&[&args.input], &[&args.output])?;
    let (model, _) = input::read_model(&args.input)?;
    let uv = texture(&args.input, &model)?;
    let textures = MapTextures::of(&model, &args.input);
    let of_faces = textures.of_faces().unwrap_or(&[]);
    let before = measured(args, &model, &uv, of_faces)?;
    let parted = part(&model, &textures.apart(&model, &uv), args.weld.chosen(), Watch::NONE)
        .map_err(|error| CommandError::Unwrap { path: args.input.clone(), error: error.into() })?;
    let left = parted.left;
    let is_packed = !parted.overlaps.pairs.is_empty();
    let placed = if is_packed { packed(args, &model, parted)? } else { uv };
    let after = measured(args, &model, &placed, if is_packed { &[] } else { of_faces })?;
    write_map(&model, &placed, (&args.input, &args.output), format)?;
    if is_packed {
        let bake = Bake::of_tiles(args.packing.is_udim());
        let told = textures.become_one(&args.output, bake).or_else(|| textures.do_not_fit(&args.output, bake));
        told.iter().for_each(|told| output::warn(told));
    }
    if split_vertices(&model, args.weld.chosen()) > 0 {
        output::warn("the surface is split along its seams: with --weld what is cut off can be attached across them");
    }
    let input = PartedInput {
        path: args.input.display().to_string(),
        vertices: model.vertex_count(),
        faces: model.face_count(),
    };
    let report = IslandsReport { schema: SCHEMA, input, before, after, packed: is_packed, left };
    if args.json { output::print_json(&report) } else { output::summary(&summary(&report, &args.output)) }
}

/// The islands side by side in the unit square, or on tiles.
fn packed(args: &IslandsArgs, model: &Model, parted: Parted) -> Result<Vec<[f64; 2]>, CommandError> {
    let Parted { uv, islands, .. } = parted;
    let packed = repack(model, &uv, &islands, (args.weld.chosen(), &args.packing.options()), Watch::NONE)
        .map_err(|error| CommandError::Pack { path: args.input.clone(), error })?;
    args.packing.warn_of_margin(packed.packing.margin);
    Ok(packed.uv)
}

/// What matters of a map; `of_faces` are the textures of its faces, if it has several.
fn measured(
    args: &IslandsArgs,
    model: &Model,
    uv: &[[f64; 2]],
    of_faces: &[Option<u32>],
) -> Result<MapReport, CommandError> {
    let map = MeasuredMap::of_textures(model, uv, args.weld.chosen(), of_faces)
        .map_err(|error| CommandError::Measure { path: args.input.clone(), error })?;
    let Quality { distortion, islands, .. } = map.quality;
    Ok(MapReport {
        islands: islands.len(),
        overlap: distortion.overlap,
        seam_length: distortion.seam_length,
        flipped: distortion.flipped,
    })
}

fn summary(report: &IslandsReport, path: &Path) -> String {
    let IslandsReport { input, before, after, packed, left, .. } = report;
    let map = |map: &MapReport| {
        let islands = counted(map.islands, "island", "islands");
        let flipped = if map.flipped > 0 { format!(", {} flipped", map.flipped) } else { String::new() };
        format!("{islands}{flipped}, {} overlapping, seams {:.2} √area", overlap_text(map.overlap), map.seam_length)
    };
    let left = match left {
        0 => String::new(),
        left => labelled(
            "left",
            &format!("{} of one polygon each", counted(*left, "pair of triangles", "pairs of triangles")),
        ),
    };
    [
        labelled(
            "surface",
            &format!("{}, {}", counted(input.vertices, "vertex", "vertices"), counted(input.faces, "face", "faces")),
        ),
        labelled("before", &map(before)),
        labelled("after", &map(after)),
        labelled(
            "places",
            if *packed { "all islands packed anew, scaled alike" } else { "as they were: nothing overlaps" },
        ),
        left,
        labelled("written", &path.display().to_string()),
    ]
    .concat()
}
