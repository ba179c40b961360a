//! `cones shape`: a built-in shape as a file.

use crate::args::Shape;
use crate::failure::Failure;
use crate::output;
use crate::table::thousands;
use geom::Model;
use geom::io::{ObjContent, write_obj};

pub(crate) fn run(args: &Shape) -> Result<(), Failure> {
    output::extension(&args.output, &["obj"])?;
    output::check(&[], &[&args.output])?;
    let shape = geom::shapes::by_name(&args.name, args.vertices).expect("the name was checked as an argument");
    let model = Model::from(shape);
    output::write(&args.output, |out| write_obj(&model, &ObjContent::default(), out))?;
    let (vertices, faces) = (thousands(model.vertex_count()), thousands(model.face_count()));
    output::print(&format!(
        "{}: {vertices} vertices, {faces} triangles, written to {}\n",
        args.name,
        args.output.display()
    ))
}
