//! One surface through the library: unwrapped, its texture coordinates scaled, its map measured.

use super::picture_args::ColourName;
use super::warn::said;
use crate::error::CommandError;
use crate::limits;
use crate::output;
use crate::progress::Progress;
use crate::render::{Mark, Paint, Scene};
use crate::report::{Times, UnwrapReport};
use clap::ValueEnum;
use cones::report::{MeasuredAtlas, UvSize};
use cones::{Analysis, Handles, Islands, MOST_NEEDLES, Note, Options, RefinedModel};
use geom::io::{refine_obj, triangulated};
use geom::{Model, refine_attributes};
use std::path::Path;
use std::time::Instant;

/// Size of the texture coordinates.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Scale {
    /// The islands' tile is the unit square, or their tiles are unit squares
    Unit,
    /// All islands together have the surface's area
    Area,
    /// As computed
    None,
}

impl From<Scale> for UvSize {
    fn from(scale: Scale) -> Self {
        match scale {
            Scale::Unit => Self::Unit,
            Scale::Area => Self::Area,
            Scale::None => Self::Raw,
        }
    }
}

/// That an order of cones for any number of them is for another surface than the cones are of.
pub(crate) const CLOSED_ORDER: &str = "the hierarchy is of the surface with its handles closed, but these cones are for opened ones: --open-handles always or \
                                       never has both alike";

/// Where needles bend angles by more than this, as the mean of σ₁/σ₂, it is told that refining helps.
const WORTH_REFINING: f64 = 1.1;

/// The area of a triangle of a polygon that may be rounding alone, as a share of the polygon's.
const ROUNDED: f64 = 1e-12;

/// An unwrapped surface with its texture coordinates as they are written, and what they are worth.
#[derive(Debug)]
pub(crate) struct Unwrapped {
    pub(crate) model: Model,
    pub(crate) options: Options,
    pub(crate) analysis: Analysis,
    pub(crate) map: MeasuredAtlas,
    /// The seconds that measuring it took.
    measuring: f64,
}

impl Unwrapped {
    /// Unwraps a model. `path` is how messages call it.
    pub(crate) fn new(
        path: &Path,
        model: Model,
        options: Options,
        scale: Scale,
        progress: &Progress,
    ) -> Result<Self, CommandError> {
        limits::check_memory(path, model.vertex_count(), limits::UNWRAPPED)?;
        let failed = |error| CommandError::Unwrap { path: path.to_owned(), error };
        let (analysis, atlas) = Analysis::unwrapped(&model, &options, progress.observer()).map_err(failed)?;
        let model = refined_model(model, &analysis);
        progress.step("measure");
        let start = Instant::now();
        let map = MeasuredAtlas::new(&model, atlas, scale.into(), analysis.weld())
            .map_err(|error| CommandError::Measure { path: path.to_owned(), error })?;
        let measuring = start.elapsed().as_secs_f64();
        Ok(Self { model, options, analysis, map, measuring })
    }

    /// Whether triangles of polygons lie over others, and so could not be parted.
    pub(crate) fn has_overlapping_polygons(&self) -> bool {
        let kept = self.kept();
        let face = |&t: &u32| self.map.atlas.triangles.face_of[kept[t as usize] as usize];
        let mut faces = self.map.quality.overlapping.iter().map(face);
        self.options.islands != Islands::Single && faces.any(|face| self.model.face(face as usize).len() > 3)
    }

    /// The same with polygons cut into triangles first, between which seams may run; as it is if that is no better.
    pub(crate) fn triangulated(self, path: &Path, scale: Scale, progress: &Progress) -> Result<Self, CommandError> {
        let Ok(model) = triangulated(&self.model) else { return Ok(self) };
        let other = Self::new(path, model, self.options.clone(), scale, progress)?;
        let pairs = |unwrapped: &Self| unwrapped.map.quality.distortion.overlap.pairs;
        Ok(if pairs(&other) < pairs(&self) { other } else { self })
    }

    /// Notes that an order of cones for any number of them is for another surface, where handles were opened for just this number.
    pub(crate) fn note_closed_order(&mut self) {
        let opened = self.map.atlas.opened_handles;
        if opened > 0 && self.options.preparation.handles == Handles::Auto {
            self.map.flaws.push(CLOSED_ORDER.to_owned());
        }
    }

    /// Notes what is wrong with the polygons of the map where another program cuts them into triangles in its own way: it may
    /// see triangles flipped, as the polygons are not convex.
    pub(crate) fn note_polygons(&mut self) {
        if self.has_overlapping_polygons() {
            let told =
                "polygons are not cut, and so what they lie over is not parted: write triangles with --triangulate";
            self.map.flaws.push(told.to_owned());
        }
        let mut turned = vec![[false; 2]; self.model.face_count()];
        let MeasuredAtlas { atlas, uv, .. } = &self.map;
        for (&face, &corners) in atlas.triangles.face_of.iter().zip(&atlas.triangles.corners) {
            turned[face as usize][usize::from(area(corners.map(|c| uv[c as usize])) < 0.0)] = true;
        }
        let is_torn = |&face: &usize| {
            let first = self.model.face_corners(face).start;
            let fan = self.model.face_corners(face).skip(1).zip(self.model.face_corners(face).skip(2));
            let areas: Vec<f64> = fan.map(|(b, c)| area([first, b, c].map(|c| uv[c]))).collect();
            // Corners on a straight side make triangles without area, which are rounded either way.
            let negligible = ROUNDED * areas.iter().map(|area| area.abs()).sum::<f64>();
            match turned[face] {
                [true, false] => areas.iter().any(|&area| area < -negligible),
                [false, true] => areas.iter().any(|&area| area > negligible),
                _ => false,
            }
        };
        let polygons = (0..self.model.face_count()).filter(|&face| self.model.face(face).len() > 3);
        let torn: Vec<usize> = polygons.filter(is_torn).collect();
        let told = match torn[..] {
            [] => return,
            [face] => {
                format!("1 polygon is not convex in the map (face {face}, counted from 0): programs that cut it in")
            }
            [first, ..] => format!(
                "{} polygons are not convex in the map (first face {first}, counted from 0): programs that cut them in",
                torn.len()
            ),
        };
        self.map.flaws.push(told + " another way show flipped triangles; write triangles with --triangulate");
    }

    /// Says on stderr what was repaired, what had to be decided, and what is wrong with the map.
    pub(crate) fn warn(&self) {
        self.warnings().iter().for_each(|line| output::warn(line));
    }

    /// What is said of that, a line each.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let flaws = self.map.flaws.iter().cloned().chain(self.uneven()).chain(self.hint()).collect();
        said(self.analysis.repairs(), &self.map.atlas.notes, flaws, self.analysis.topology().components)
    }

    /// What is not as it was asked for where a surface was refined.
    fn uneven(&self) -> Option<String> {
        let is_complete = self.analysis.refined().is_none_or(|refined| refined.is_complete);
        (!is_complete).then(|| {
            "not all triangles could be made even: some parts would take too many, and are refined in part or not at all".to_owned()
        })
    }

    /// What would help where angles are bent because the input's triangles are needles, or no metric was found on them.
    fn hint(&self) -> Option<String> {
        let bent = self.map.quality.distortion.quasi_conformal.mean;
        let notes = &self.map.atlas.notes;
        let is_tried = notes.iter().any(|note| matches!(note, Note::NotRefined { .. }));
        if self.analysis.refined().is_some() || is_tried {
            return None;
        }
        if notes.iter().any(Note::lacks_metric) {
            return Some(
                "where no flat metric is found on the triangles as they are, --refine may find one".to_owned(),
            );
        }
        if bent <= WORTH_REFINING {
            return None;
        }
        let needles = self.analysis.needle_share();
        (needles > MOST_NEEDLES).then(|| {
            format!(
                "{:.0} % of the area is in needles, and angles are bent by {bent:.2}: --refine cuts them into even triangles",
                100.0 * needles
            )
        })
    }

    /// What pictures of it are drawn from.
    pub(crate) fn scene(&self) -> Scene {
        let atlas = &self.map.atlas;
        let triangles = atlas.surface_triangles();
        let cones = atlas.cones.iter().map(|c| Mark { vertex: c.vertex, positive: c.curvature >= 0.0 }).collect();
        let uv = corner_uv(&triangles, &atlas.uv_in(UvSize::Unit));
        let mut vertices = vertices(&self.model, &triangles);
        self.analysis.weld().apply(&self.model, &mut vertices);
        let scene =
            Scene::new(self.model.points(), vertices, uv.clone(), atlas.seams.clone(), cones).packed(uv, atlas.fill);
        if self.map.quality.distortion.flipped == 0 { scene.upright() } else { scene }
    }

    /// What a scene of it is painted with.
    pub(crate) fn paint(&self, colour: ColourName, scene: &Scene) -> Paint {
        let factor = if colour == ColourName::Factor { self.analysis.conformal_factor() } else { Vec::new() };
        colour.paint(scene, &self.map.quality, &factor)
    }

    /// The triangles that lie on a surface, by number: those of its scene and of its quality, in this order.
    pub(crate) fn kept(&self) -> Vec<u32> {
        self.map.atlas.on_surface()
    }

    /// Its report; `times` are those of reading, writing and drawing.
    pub(crate) fn report(&self, path: &Path, times: Times) -> UnwrapReport {
        let Self { options, analysis, map, .. } = self;
        let times = Times { measure: Some(self.measuring), ..times }.with(analysis.times()).with(map.atlas.times);
        let mut report = UnwrapReport::new(path, options, analysis.topology(), map.report(analysis, options), times);
        report.may_advise_refining &= self.hint().is_none();
        report
    }
}

/// The model as it is written: where its analysis was refined, that, with all that the file says of its own vertices and faces.
pub(crate) fn refined_model(model: Model, analysis: &Analysis) -> Model {
    let Some(RefinedModel { model: refined, face, added, .. }) = analysis.refined() else { return model };
    refine_obj(&model, added, refined, face)
        .unwrap_or_else(|| refined.clone().with_attributes(refine_attributes(&model, refined, added, face)))
}

/// The model's vertices at triangles of its corners.
pub(crate) fn vertices(model: &Model, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    triangles.iter().map(|t| t.map(|c| model.corners()[c as usize])).collect()
}

/// The texture coordinates at triangles of corners.
pub(crate) fn corner_uv(triangles: &[[u32; 3]], uv: &[[f64; 2]]) -> Vec<[[f64; 2]; 3]> {
    triangles.iter().map(|t| t.map(|c| uv[c as usize])).collect()
}

/// Some of many things.
pub(crate) fn picked<T: Copy>(kept: &[u32], items: &[T]) -> Vec<T> {
    kept.iter().map(|&t| items[t as usize]).collect()
}

/// Twice the signed area of a triangle of the map.
fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
