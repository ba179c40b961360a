//! `cones measure`: the distortion of any map, of an OBJ, PLY or glTF.

use crate::commands::shared::{MapTextures, WeldArgs, split_vertices, texture};
use crate::error::CommandError;
use crate::input;
use crate::output::{self, Files};
use crate::render::{self, Paint, Scene};
use crate::report::table::counted;
use crate::report::{SCHEMA, distortion_text, distortion_text_filling};
use clap::Args;
use cones::report::{DistortionReport, IslandReport, MeasuredMap};
use cones::uv::{Triangle, fill};
use geom::Model;
use geom::io::{Texture, Textures};
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MeasureArgs {
    /// A surface with texture coordinates: OBJ, PLY or glTF
    #[arg(value_name = "UV")]
    input: PathBuf,
    /// Measure against this surface, which has the same faces in the same order
    #[arg(long, value_name = "IN")]
    reference: Option<PathBuf>,
    #[command(flatten)]
    weld: WeldArgs,
    /// Write the faces that lie over or under another, counted from 0, a line each
    #[arg(long, value_name = "FILE")]
    overlap_faces: Option<PathBuf>,
    /// Draw the layout, what lies over itself in orange: .png or .svg
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// Print JSON in place of the text
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  cones measure scan.obj
  cones measure theirs.obj --reference scan.ply --layout theirs.svg";

#[derive(Debug, Serialize)]
struct MeasureReport {
    schema: u32,
    input: MeasuredInput,
    distortion: DistortionReport,
    islands: Vec<IslandReport>,
    textures: Vec<TextureReport>,
}

/// The part of the map that shows one texture.
#[derive(Debug, Serialize)]
struct TextureReport {
    name: String,
    faces: usize,
    fill: f64,
}

#[derive(Debug, Serialize)]
struct MeasuredInput {
    path: String,
    reference: Option<String>,
    vertices: usize,
    faces: usize,
    left_out: usize,
}

pub(crate) fn run(args: &MeasureArgs) -> Result<(), CommandError> {
    check_outputs(args)?;
    let (model, _) = input::read_model(&args.input)?;
    let reference = args.reference.as_deref().map(|path| reference(path, &args.input, &model)).transpose()?;
    let surface = reference.as_ref().unwrap_or(&model);
    let textures = MapTextures::of(&model, &args.input);
    let measured = measure(args, &model, surface, &textures)?;
    write_extras(args, surface, &measured)?;
    let report = report(args, surface, &measured, &textures);
    if !measured.left_out.is_empty() {
        output::warn(&format!(
            "{} with a vertex twice, or at the place of another one on the same vertices: not measured",
            counted(measured.left_out.len(), "triangle", "triangles")
        ));
    }
    let degenerate = report.distortion.degenerate;
    if degenerate > 0 {
        let triangles = counted(degenerate, "triangle has", "triangles have");
        output::warn(&format!("{triangles} no area in the map: left out of all means"));
    }
    warn_of_split(split_vertices(surface, args.weld.chosen()));
    if args.json {
        return output::print_json(&report);
    }
    let vertices = counted(report.input.vertices, "vertex", "vertices");
    let faces = counted(report.input.faces, "face", "faces");
    output::print_table(&format!("surface   {vertices}, {faces}\n{}", map_text(&report)))
}

/// So many textures are told of; all are in the JSON.
const MOST_TEXTURES: usize = 8;

/// What is measured of the map; where it has several textures, how much of each is filled.
fn map_text(MeasureReport { distortion, islands, textures, .. }: &MeasureReport) -> String {
    if textures.len() < 2 {
        return distortion_text(distortion, islands.len());
    }
    let of_one = |texture: &TextureReport| format!("{:.1} % of {}", 100.0 * texture.fill, texture.name);
    let mut fill: Vec<String> = textures.iter().take(MOST_TEXTURES).map(of_one).collect();
    if textures.len() > MOST_TEXTURES {
        fill.push(format!("and {} textures more", textures.len() - MOST_TEXTURES));
    }
    distortion_text_filling(distortion, islands.len(), &fill.join(", "))
}

/// Endings and places of the outputs, before anything is computed.
fn check_outputs(args: &MeasureArgs) -> Result<(), CommandError> {
    if let Some(path) = &args.layout {
        output::extension(path, &["png", "svg"])?;
    }
    let inputs: Vec<&Path> = [Some(&args.input), args.reference.as_ref()].into_iter().flatten().map(|p| &**p).collect();
    let outputs: Vec<&Path> = [&args.overlap_faces, &args.layout].into_iter().flatten().map(|p| &**p).collect();
    output::check_json(args.json, &outputs)?;
    output::check(&inputs, &outputs)
}

fn write_extras(args: &MeasureArgs, surface: &Model, measured: &MeasuredMap) -> Result<(), CommandError> {
    let mut files = Files::new();
    if let Some(path) = &args.overlap_faces {
        let mut faces: Vec<u32> = measured.quality.overlapping.iter().map(|&t| measured.face_of[t as usize]).collect();
        faces.dedup();
        files.write_text(path, &faces.iter().map(|face| format!("{face}\n")).collect::<String>())?;
    }
    if let Some(path) = &args.layout {
        let (vertices, uv) = (measured.vertices.clone(), measured.uv.clone());
        let scene = Scene::new(surface.points(), vertices, uv, Vec::new(), Vec::new());
        match output::extension(path, &["png", "svg"])? {
            "svg" => files.write_text(path, &render::draw_layout_svg(&scene, &Paint::Checker))?,
            _ => files.write_png(path, &render::draw_layout(&scene, &Paint::Checker))?,
        }
    }
    files.finish()
}

/// Says that seams cannot be told from boundaries where the surface is split along them.
fn warn_of_split(vertices: usize) {
    if vertices > 0 {
        output::warn(&format!(
            "{} on the boundary at the place of another one: what meets there counts as cut already; if the file was split along \
             its seams, islands and seams are right with --weld",
            counted(vertices, "vertex lies", "vertices lie")
        ));
    }
}

/// The surface to measure against, if it is the same mesh: the same numbers of corners face by face.
fn reference(path: &Path, input: &Path, model: &Model) -> Result<Model, CommandError> {
    let (reference, _) = input::read_model(path)?;
    let alike = reference.face_start() == model.face_start();
    if alike { Ok(reference) } else { Err(CommandError::OtherMesh(input.to_owned(), path.to_owned())) }
}

/// Measures the model's texture coordinates on the surface of `reference`.
fn measure(
    args: &MeasureArgs,
    model: &Model,
    reference: &Model,
    textures: &MapTextures,
) -> Result<MeasuredMap, CommandError> {
    let uv = texture(&args.input, model)?;
    MeasuredMap::of_textures(reference, &uv, args.weld.chosen(), textures.of_faces().unwrap_or(&[]))
        .map_err(|error| CommandError::Measure { path: args.input.clone(), error })
}

fn report(args: &MeasureArgs, reference: &Model, measured: &MeasuredMap, textures: &MapTextures) -> MeasureReport {
    let MeasuredMap { left_out, quality, .. } = measured;
    MeasureReport {
        schema: SCHEMA,
        input: MeasuredInput {
            path: args.input.display().to_string(),
            reference: args.reference.as_ref().map(|path| path.display().to_string()),
            vertices: reference.vertex_count(),
            faces: reference.face_count(),
            left_out: left_out.len(),
        },
        distortion: quality.distortion.clone(),
        islands: quality.islands.clone(),
        textures: of_textures(measured, &textures.textures),
    }
}

/// How much of each texture is filled.
fn of_textures(measured: &MeasuredMap, textures: &Textures) -> Vec<TextureReport> {
    let mut images = vec![Vec::new(); textures.list().len()];
    for (&face, &image) in measured.face_of.iter().zip(&measured.uv) {
        if let Some(texture) = textures.of_face(face as usize) {
            images[texture].push(image);
        }
    }
    let faces = |number: usize| textures.of_faces().iter().filter(|&&of| of == Some(number as u32)).count();
    let of_one = |(number, (texture, images)): (usize, (&Texture, &Vec<Triangle>))| TextureReport {
        name: texture.name.clone(),
        faces: faces(number),
        fill: fill(images),
    };
    textures.list().iter().zip(&images).enumerate().map(of_one).collect()
}
