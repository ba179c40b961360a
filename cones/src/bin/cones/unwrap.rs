//! `cones unwrap`: a surface in, its texture coordinates out.

use crate::args::Unwrap;
use crate::failure::Failure;
use crate::job::{self, Job};
use crate::picture::{self, Chart};
use crate::progress::Progress;
use crate::report::{Report, Times};
use crate::{cone_file, hierarchy_file, output};
use cones::Options;
use geom::io::{ObjContent, write_glb, write_obj, write_ply};
use std::path::Path;
use std::time::Instant;

pub(crate) fn run(args: &Unwrap) -> Result<(), Failure> {
    check_outputs(args)?;
    let options = Options { order: args.hierarchy.is_some(), ..args.choice.options()? };
    let mut progress = Progress::begin(&args.input.display().to_string());
    let began = Instant::now();
    let (model, read) = job::read(&args.input)?;
    let mut job = Job::new(&args.input, model, options, args.scale, &mut progress)?;
    if !args.triangulate && output::extension(&args.output, &["obj", "ply", "glb"])? != "glb" {
        let polygons = job.polygon_warning();
        job.atlas.warnings.extend(polygons);
    }
    progress.step("write");
    let start = Instant::now();
    write_surface(&job, &args.output, args.triangulate)?;
    let [write, total] = [start, began].map(|since| Some(since.elapsed().as_secs_f64()));
    let times = Times { read: Some(read), write, total, ..Times::default() };
    let report = job.report(&args.input, times);
    write_extras(args, &job, &report)?;
    drop(progress);
    job::warn(&job.atlas.repairs, &job.atlas.warnings);
    if args.json { output::print_json(&report) } else { output::print(&summary(&report, args)) }
}

/// Endings and places of the outputs, before anything is computed.
fn check_outputs(args: &Unwrap) -> Result<(), Failure> {
    output::extension(&args.output, &["obj", "ply", "glb"])?;
    let endings: [(&Option<_>, &[&str]); 4] = [
        (&args.report, &["json"]),
        (&args.hierarchy, &["json"]),
        (&args.picture, &["png"]),
        (&args.layout, &["png", "svg"]),
    ];
    for (path, wanted) in endings {
        if let Some(path) = path {
            output::extension(path, wanted)?;
        }
    }
    let inputs: Vec<&Path> =
        [Some(&args.input), args.choice.cones.as_ref()].into_iter().flatten().map(|p| &**p).collect();
    output::check(&inputs, &outputs(args))
}

fn outputs(args: &Unwrap) -> Vec<&Path> {
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

fn write_surface(job: &Job, path: &Path, triangulate: bool) -> Result<(), Failure> {
    let triangles = job.model.triangles();
    let asked = triangulate.then_some(&triangles);
    let uv = Some(job.uv.as_slice());
    match output::extension(path, &["obj", "ply", "glb"])? {
        "ply" => output::write(path, |out| write_ply(&job.model, uv, asked, out)),
        "glb" => output::write(path, |out| {
            write_glb(&job.model, uv, &triangles, Some(&picture::Checker::texture().png()?), out)
        }),
        _ => {
            let content = ObjContent { uv, triangles: asked, material: None };
            output::write(path, |out| write_obj(&job.model, &content, out))
        }
    }
}

fn write_extras(args: &Unwrap, job: &Job, report: &Report) -> Result<(), Failure> {
    if let Some(path) = &args.report {
        output::write_text(path, &output::json(report))?;
    }
    if let Some(path) = &args.cones_out {
        output::write_text(path, &cone_file::text(&job.atlas.cones))?;
    }
    hierarchy_file::write(args.hierarchy.as_deref(), job.atlas.order.as_ref())?;
    if args.picture.is_none() && args.layout.is_none() {
        return Ok(());
    }
    let chart = job.chart();
    if let Some(path) = &args.picture {
        output::write_png(path, &picture::draw_model(&chart))?;
    }
    args.layout.as_ref().map_or(Ok(()), |path| write_layout(path, &chart))
}

fn write_layout(path: &Path, chart: &Chart) -> Result<(), Failure> {
    match output::extension(path, &["png", "svg"])? {
        "svg" => output::write_text(path, &picture::draw_layout_svg(chart)),
        _ => output::write_png(path, &picture::draw_layout(chart)),
    }
}

fn summary(report: &Report, args: &Unwrap) -> String {
    let written: Vec<String> = outputs(args).iter().map(|p| p.display().to_string()).collect();
    format!("{}written   {}\n", report.text(), written.join(", "))
}
