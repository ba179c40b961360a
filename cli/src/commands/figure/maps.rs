//! The maps of a surface that figures are drawn of: one analysis of it, many methods and numbers of cones.

use crate::commands::compare::{Flattening, Variant};
use crate::commands::shared::{ColourName, Subject};
use crate::error::CommandError;
use crate::render::{Paint, Picture, Scene, Shot, View, draw_bare_layout, draw_layout, draw_model};
use cones::report::Quality;
use cones::{Analysis, ConeChoice, Preparation, SeamOptions};
use geom::{Model, Watch};
use std::path::Path;

/// A surface with an analysis for each way of preparing it.
pub(super) struct Surface<'a> {
    /// How figures call it.
    pub(super) name: String,
    model: &'a Model,
    subjects: Vec<(Preparation, Subject<'a>)>,
}

/// A map, ready to be drawn.
pub(super) struct Map {
    pub(super) cones: usize,
    scene: Scene,
    pub(super) quality: Quality,
    factor: Vec<f64>,
}

impl<'a> Surface<'a> {
    pub(super) fn new(name: &str, model: &'a Model) -> Self {
        Self { name: name.to_owned(), model, subjects: Vec::new() }
    }

    /// Its analysis as a method wants it prepared.
    pub(super) fn subject(&mut self, variant: Variant) -> Result<&Subject<'a>, CommandError> {
        let options = variant.options();
        let known = self.subjects.iter().position(|(preparation, _)| *preparation == options.preparation);
        let at = match known {
            Some(at) => at,
            None => {
                let path = Path::new(&self.name);
                let analysis = Analysis::with(self.model, options.preparation)
                    .map_err(|error| CommandError::Unwrap { path: path.to_owned(), error })?;
                let preparation = options.preparation;
                self.subjects.push((preparation, Subject::new(path, self.model, analysis, options)));
                self.subjects.len() - 1
            }
        };
        Ok(&self.subjects[at].1)
    }

    /// Its map by a method with so many cones, or as few as it can do with where these are more.
    pub(super) fn map(&mut self, variant: Variant, count: usize) -> Result<Map, CommandError> {
        let name = self.name.clone();
        let failed = |error| CommandError::Unwrap { path: Path::new(&name).to_owned(), error };
        let subject = self.subject(variant)?;
        let analysis = &subject.analysis;
        let options = cones::Options { cones: ConeChoice::Count(count), ..variant.options() };
        let factor = analysis.conformal_factor();
        match variant.flattening {
            Flattening::Exact => {
                let shown = subject.map(analysis, &options)?;
                let atlas = &shown.atlas;
                let (scene, quality) =
                    (subject.scene_of(&shown), subject.measure(&shown.uv, &atlas.cones, Watch::NONE)?);
                Ok(Map { cones: atlas.cones.len(), scene, quality, factor })
            }
            Flattening::By(baseline) => {
                let cones = analysis.choose(&options).map_err(failed)?;
                let map = analysis.flatten_by(baseline, &cones).map_err(failed)?;
                let seams = analysis.seams(&cones, &SeamOptions::default()).map_err(failed)?;
                let quality = subject.measure(&map.uv, cones.as_slice(), Watch::NONE)?;
                let scene = subject.scene(&map.uv, seams, cones.as_slice());
                Ok(Map { cones: cones.len(), scene, quality, factor })
            }
        }
    }
}

impl Map {
    /// From where its cones are seen best.
    pub(super) fn view(&self) -> View {
        View::best(&self.scene)
    }

    /// The surface in its colours.
    pub(super) fn model(&self, colour: ColourName, view: View, size: [usize; 2]) -> Picture {
        draw_model(&self.scene, &self.paint(colour), Shot { view: Some(view), size: Some(size) })
    }

    /// The layout in its colours, whose legend stands with the model.
    pub(super) fn layout(&self, colour: ColourName) -> Picture {
        draw_bare_layout(&self.scene, &self.paint(colour))
    }

    /// The layout with all that is told of it.
    pub(super) fn told_layout(&self) -> Picture {
        draw_layout(&self.scene, &Paint::Checker)
    }

    fn paint(&self, colour: ColourName) -> Paint {
        colour.paint(&self.scene, &self.quality, &self.factor)
    }
}
