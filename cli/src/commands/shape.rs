//! `cones shape`: a built-in shape as a file.

use crate::commands::shared::{SurfaceFile, vertex_count};
use crate::error::CommandError;
use crate::limits;
use crate::output::{self, Files};
use crate::report::table::counted;
use clap::Args;
use geom::Model;
use geom::shapes;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub(crate) struct ShapeArgs {
    /// Which shape
    #[arg(value_name = "NAME", value_parser = shape_name, long_help = shape_help())]
    name: String,
    /// About how many vertices
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = vertex_count, allow_negative_numbers = true)]
    vertices: usize,
    /// Where to write it: .obj, .ply or .glb, also .gz
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
}

fn shape_name(text: &str) -> Result<String, String> {
    // A shape of few vertices is made in no time, and tells whether the name is known.
    let known = shapes::by_name(text, 1).is_some();
    if known {
        Ok(text.to_owned())
    } else {
        Err(format!("known are {}, or torus-G of genus G", shapes::NAMES.join(", ")))
    }
}

fn shape_help() -> String {
    format!("Which shape: {}, or torus-G of genus G", shapes::NAMES.join(", "))
}

pub(crate) fn run(args: &ShapeArgs) -> Result<(), CommandError> {
    let format = output::surface_format(&args.output, None)?;
    output::check(&[], &[&args.output])?;
    limits::check_memory(Path::new(&args.name), args.vertices, limits::MADE)?;
    let model = model(&args.name, args.vertices);
    let mut files = Files::new();
    let file = SurfaceFile { model: &model, source: None, uv: None, triangles: None, material: None };
    file.write(&mut files, &args.output, format)?;
    files.finish()?;
    let vertices = counted(model.vertex_count(), "vertex", "vertices");
    let triangles = counted(model.face_count(), "triangle", "triangles");
    output::summary(&format!("{}: {vertices}, {triangles}, written to {}\n", args.name, args.output.display()))
}

/// A built-in shape. The name must be one that the arguments accept.
pub(crate) fn model(name: &str, vertices: usize) -> Model {
    let shape = shapes::by_name(name, vertices).expect("the names are checked as arguments");
    Model::from_triangles(shape.points, &shape.triangles).expect("built-in shapes are sound")
}
