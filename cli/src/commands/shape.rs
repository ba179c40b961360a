//! `cones shape`: a built-in shape as a file.

use crate::args::Shape;
use crate::failure::Failure;
use crate::output;
use crate::report::table::thousands;
use geom::Model;
use geom::io::{ObjContent, write_obj};
use geom::shapes;

pub(crate) fn run(args: &Shape) -> Result<(), Failure> {
    output::extension(&args.output, &["obj"])?;
    output::check(&[], &[&args.output])?;
    let model = model(&args.name, args.vertices);
    output::write(&args.output, |out| write_obj(&model, &ObjContent::default(), out))?;
    let (vertices, faces) = (thousands(model.vertex_count()), thousands(model.face_count()));
    output::print(&format!(
        "{}: {vertices} vertices, {faces} triangles, written to {}\n",
        args.name,
        args.output.display()
    ))
}

/// A built-in shape. The name must be one that the arguments accept.
pub(crate) fn model(name: &str, vertices: usize) -> Model {
    let shape = shapes::by_name(name, vertices).expect("the names are checked as arguments");
    Model::from_triangles(shape.points, &shape.triangles).expect("built-in shapes are sound")
}
