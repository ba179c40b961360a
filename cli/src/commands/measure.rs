//! `cones measure`: the distortion of any unwrapped OBJ.

use crate::commands::shared::corner_uv;
use crate::error::CommandError;
use crate::report::table::thousands;
use crate::report::{DistortionReport, IslandReport, Quality, SCHEMA};
use crate::{input, output};
use clap::Args;
use geom::Model;
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub(crate) struct MeasureArgs {
    /// A surface with texture coordinates: OBJ or PLY
    #[arg(value_name = "UV")]
    input: PathBuf,
    /// Measure against this surface, which has the same faces in the same order
    #[arg(long, value_name = "IN")]
    reference: Option<PathBuf>,
    /// Print JSON in place of the text
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct MeasureReport {
    schema: u32,
    input: MeasuredInput,
    distortion: DistortionReport,
    islands: Vec<IslandReport>,
}

#[derive(Debug, Serialize)]
struct MeasuredInput {
    path: String,
    reference: Option<String>,
    vertices: usize,
    faces: usize,
}

pub(crate) fn run(args: &MeasureArgs) -> Result<(), CommandError> {
    let (model, _) = input::read_model(&args.input)?;
    let reference = args.reference.as_deref().map(|path| reference(path, &args.input, &model)).transpose()?;
    let report = measure(args, &model, reference.as_ref().unwrap_or(&model))?;
    if args.json {
        return output::print_json(&report);
    }
    let (vertices, faces) = (thousands(report.input.vertices), thousands(report.input.faces));
    output::print(&format!(
        "surface   {vertices} vertices, {faces} faces\n{}",
        report.distortion.text(report.islands.len())
    ))
}

/// The surface to measure against, if it is the same mesh: the same numbers of corners face by face.
fn reference(path: &Path, input: &Path, model: &Model) -> Result<Model, CommandError> {
    let (reference, _) = input::read_model(path)?;
    let alike = reference.face_start() == model.face_start();
    if alike { Ok(reference) } else { Err(CommandError::OtherMesh(input.to_owned(), path.to_owned())) }
}

/// Measures the model's texture coordinates on the surface of `reference`.
fn measure(args: &MeasureArgs, model: &Model, reference: &Model) -> Result<MeasureReport, CommandError> {
    let no_texture = || CommandError::NoTexture(args.input.clone());
    let uv = model.uv().ok_or_else(no_texture)?.all().map_err(|_| no_texture())?;
    let triangles = reference.triangles();
    let (vertices, corners) = (triangles.vertices(reference), corner_uv(&triangles.corners, &uv));
    let quality = Quality::measure(reference.points(), &vertices, &corners, None)
        .map_err(|error| CommandError::Measure { path: args.input.clone(), error })?;
    Ok(MeasureReport {
        schema: SCHEMA,
        input: MeasuredInput {
            path: args.input.display().to_string(),
            reference: args.reference.as_ref().map(|path| path.display().to_string()),
            vertices: reference.vertex_count(),
            faces: reference.face_count(),
        },
        distortion: quality.distortion,
        islands: quality.islands,
    })
}
