//! One surface through the library: unwrapped, scaled, measured.

use crate::args::Scale;
use crate::failure::Failure;
use crate::limit;
use crate::output;
use crate::picture::{Chart, Mark};
use crate::progress::Progress;
use crate::report::{Quality, Report, Times};
use cones::{Atlas, Options};
use geom::{Model, Repair};
use std::path::Path;
use std::time::Instant;

/// An unwrapped surface with its texture coordinates as they are written, and what they are worth.
#[derive(Debug)]
pub(crate) struct Job {
    pub(crate) model: Model,
    pub(crate) options: Options,
    pub(crate) atlas: Atlas,
    /// For each corner of the model.
    pub(crate) uv: Vec<[f64; 2]>,
    pub(crate) quality: Quality,
}

impl Job {
    /// Unwraps a model. `path` is how messages call it.
    pub(crate) fn new(
        path: &Path,
        model: Model,
        options: Options,
        scale: Scale,
        progress: &mut Progress,
    ) -> Result<Self, Failure> {
        limit::check(path, model.vertex_count())?;
        let mut atlas = cones::unwrap(&model, &options, &mut |stage| progress.stage(stage))
            .map_err(|error| Failure::Unwrap { path: path.to_owned(), error })?;
        progress.step("measure");
        let uv = scaled(&atlas.uv, scale);
        let triangles = kept(&atlas);
        let cones: Vec<u32> = atlas.cones.iter().map(|cone| cone.vertex).collect();
        let (kept, corners) = (vertices(&model, &triangles), corner_uv(&triangles, &uv));
        let quality = Quality::measure(model.points(), &kept, &corners, Some(&cones))
            .map_err(|error| Failure::Measure { path: path.to_owned(), error })?;
        atlas.warnings.extend(flaws(&model, &quality, &triangles));
        Ok(Self { model, options, atlas, uv, quality })
    }

    /// What is wrong with the polygons of the map where another program cuts them into triangles in its own way: it may see
    /// triangles flipped, as the polygons are not convex.
    pub(crate) fn polygon_warning(&self) -> Option<String> {
        let mut turned = vec![[false; 2]; self.model.face_count()];
        for (&face, &corners) in self.atlas.triangles.face_of.iter().zip(&self.atlas.triangles.corners) {
            turned[face as usize][usize::from(area(corners.map(|c| self.uv[c as usize])) < 0.0)] = true;
        }
        let is_torn = |&face: &usize| {
            let [first, ..] = self.model.face_corners(face).collect::<Vec<_>>()[..] else { return false };
            let fan = self.model.face_corners(face).skip(1).zip(self.model.face_corners(face).skip(2));
            let mut areas = fan.map(|(b, c)| area([first, b, c].map(|c| self.uv[c])));
            match turned[face] {
                [true, false] => areas.any(|area| area <= 0.0),
                [false, true] => areas.any(|area| area >= 0.0),
                _ => false,
            }
        };
        let polygons = (0..self.model.face_count()).filter(|&face| self.model.face(face).len() > 3);
        let torn: Vec<usize> = polygons.filter(is_torn).collect();
        let first = torn.first()?;
        Some(format!(
            "{} polygons are not convex in the map (first face {first}, counted from 0): programs that cut them in another \
             way show flipped triangles; write triangles with --triangulate",
            torn.len()
        ))
    }

    /// What pictures of it are drawn from.
    pub(crate) fn chart(&self) -> Chart {
        let triangles = kept(&self.atlas);
        let cones = self.atlas.cones.iter().map(|c| Mark { vertex: c.vertex, positive: c.curvature >= 0.0 }).collect();
        Chart::new(
            self.model.points(),
            vertices(&self.model, &triangles),
            corner_uv(&triangles, &self.uv),
            self.atlas.seams.clone(),
            cones,
        )
    }

    /// Its report; `times` are those of reading and writing.
    pub(crate) fn report(&self, path: &Path, times: Times) -> Report {
        Report::new(path, &self.atlas, &self.options, &self.quality, times)
    }
}

/// What is wrong with the triangles of a map.
fn flaws(model: &Model, quality: &Quality, triangles: &[[u32; 3]]) -> Option<String> {
    let corner = triangles[quality.first_flaw?][0];
    let face = model.face_start().partition_point(|&start| start <= corner) - 1;
    let [flipped, degenerate] = [quality.distortion.flipped, quality.distortion.degenerate];
    Some(format!(
        "{flipped} triangles of the map are flipped, and {degenerate} have no area there (first face {face}, counted from 0)"
    ))
}

/// Twice the signed area of a triangle of the map.
fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Reads a model, and how many seconds that took.
pub(crate) fn read(path: &Path) -> Result<(Model, f64), Failure> {
    let start = Instant::now();
    Ok((geom::io::read(path)?, start.elapsed().as_secs_f64()))
}

/// Says on stderr what the library mended and had to decide.
pub(crate) fn warn(repairs: &[Repair], warnings: &[String]) {
    for repair in repairs {
        output::warn(&repair_text(repair));
    }
    for warning in warnings {
        output::warn(warning);
    }
}

/// A repair as a sentence.
fn repair_text(repair: &Repair) -> String {
    let element = if repair.kind.is_of_faces() { "face" } else { "vertex" };
    format!("{} {} (first {element} {}, counted from 0)", repair.count, repair.kind.description(), repair.first)
}

/// The triangles that lie on a surface, as corners of the model.
fn kept(atlas: &Atlas) -> Vec<[u32; 3]> {
    let mut kept = vec![true; atlas.triangles.len()];
    atlas.left_out.iter().for_each(|&t| kept[t as usize] = false);
    atlas.triangles.corners.iter().zip(kept).filter_map(|(&t, kept)| kept.then_some(t)).collect()
}

/// The model's vertices at triangles of its corners.
fn vertices(model: &Model, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    triangles.iter().map(|t| t.map(|c| model.corners()[c as usize])).collect()
}

/// The texture coordinates at triangles of corners.
pub(crate) fn corner_uv(triangles: &[[u32; 3]], uv: &[[f64; 2]]) -> Vec<[[f64; 2]; 3]> {
    triangles.iter().map(|t| t.map(|c| uv[c as usize])).collect()
}

/// The texture coordinates as they are to be written: from (0, 0) on, and in the unit square where that is asked.
fn scaled(uv: &[[f64; 2]], scale: Scale) -> Vec<[f64; 2]> {
    let (low, size) = crate::picture::extent(uv.iter().copied());
    let place = |uv: [f64; 2]| -> [f64; 2] {
        match scale {
            Scale::Unit => std::array::from_fn(|i| (uv[i] - low[i]) / size),
            Scale::Area => std::array::from_fn(|i| uv[i] - low[i]),
            Scale::None => uv,
        }
    };
    uv.iter().map(|&uv| place(uv)).collect()
}
