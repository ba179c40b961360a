//! An atlas as it is written.

use std::borrow::Cow;

use geom::distortion::DistortionError;
use geom::{Model, Watch, Weld};
use rayon::prelude::*;

use super::quality::{OverlapReport, Quality};
use super::unwrapping::Report;
use crate::analysis::{Analysis, Atlas, Note, Options};

/// So many corners are gone through one after the other.
const AT_ONCE: usize = 4096;

/// The size of texture coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum UvSize {
    /// The islands' tile is the unit square, or their tiles are unit squares.
    #[default]
    Unit,
    /// All islands together have the surface's area; the layout begins at 0.
    Area,
    /// As computed.
    Raw,
}

/// An atlas with its texture coordinates as they are written, and what they are worth.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MeasuredAtlas {
    /// The map as it was computed.
    pub atlas: Atlas,
    /// Texture coordinates, for each corner of the model.
    pub uv: Vec<[f64; 2]>,
    /// All measures of it.
    pub quality: Quality,
    /// What is wrong with it, in sentences.
    pub flaws: Vec<String>,
}

impl MeasuredAtlas {
    /// Measures a map of `model`, the [refined](crate::Analysis::refined) one where there is one. `weld` takes vertices for one,
    /// as [`Preparation::weld`](crate::Preparation::weld) does.
    ///
    /// # Errors
    /// If it has a coordinate that is not finite, or is of a model with another number of corners.
    pub fn new(model: &Model, atlas: Atlas, size: UvSize, weld: Weld) -> Result<Self, DistortionError> {
        Self::new_watched(model, atlas, size, weld, Watch::NONE)
    }

    /// [`new`](Self::new), watched.
    ///
    /// # Errors
    /// As [`new`](Self::new), and if it is stopped.
    pub fn new_watched(
        model: &Model,
        atlas: Atlas,
        size: UvSize,
        weld: Weld,
        watch: Watch,
    ) -> Result<Self, DistortionError> {
        let (found, corners) = (atlas.uv.len(), model.corner_count());
        if found != corners {
            return Err(DistortionError::TextureCount { found, corners });
        }
        let uv = atlas.uv_in(size);
        let triangles: Cow<[[u32; 3]]> = match atlas.left_out.is_empty() {
            true => Cow::Borrowed(&atlas.triangles.corners),
            false => Cow::Owned(atlas.surface_triangles()),
        };
        let mut vertices: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|c| model.corners()[c as usize])).collect();
        let mut cones: Vec<u32> = atlas.cones.iter().map(|cone| cone.vertex).collect();
        if let Some(first) = weld.of(model) {
            vertices.iter_mut().flatten().chain(&mut cones).for_each(|v| *v = first[*v as usize]);
        }
        // As corners are numbered in models of triangles.
        let is_in_order = (0..).zip(triangles.iter()).all(|(f, corners)| *corners == [3 * f, 3 * f + 1, 3 * f + 2]);
        let corners: Cow<[[[f64; 2]; 3]]> = match is_in_order {
            true => Cow::Borrowed(&uv.as_chunks().0[..triangles.len()]),
            false => triangles.iter().map(|t| t.map(|c| uv[c as usize])).collect(),
        };
        let quality = Quality::measure_watched(model.points(), &vertices, &corners, Some(&cones), watch)?;
        let flaws = flaws(model, &quality, &triangles, &atlas.notes);
        Ok(Self { atlas, uv, quality, flaws })
    }

    /// What a user wants to know of it. `analysis` and `options` are those that it was made with.
    pub fn report(&self, analysis: &Analysis, options: &Options) -> Report {
        let mut report = Report::new(analysis, options, &self.atlas, &self.quality);
        report.warnings.extend(self.flaws.iter().cloned());
        report
    }
}

/// What is wrong with the triangles of a map, where the notes do not say it.
fn flaws(model: &Model, quality: &Quality, triangles: &[[u32; 3]], notes: &[Note]) -> Vec<String> {
    let mut flaws = Vec::new();
    if let Some(first) = quality.first_flaw {
        let face = model.face_start().partition_point(|&start| start <= triangles[first][0]) - 1;
        let [flipped, degenerate] = [quality.distortion.flipped, quality.distortion.degenerate];
        let what = match (flipped, degenerate) {
            (1, 0) => "1 triangle of the map is flipped".to_owned(),
            (flipped, 0) => format!("{flipped} triangles of the map are flipped"),
            (0, 1) => "1 triangle of the map has no area".to_owned(),
            (0, degenerate) => format!("{degenerate} triangles of the map have no area"),
            _ => format!("of the map's triangles {flipped} are flipped, and {degenerate} have no area"),
        };
        flaws.push(format!("{what} (first face {face}, counted from 0)"));
    }
    let is_said = notes.iter().any(|note| matches!(note, Note::Overlap { .. }));
    if quality.distortion.overlap.pairs > 0 && !is_said {
        let OverlapReport { pairs, share, .. } = quality.distortion.overlap;
        let overlap =
            if pairs == 1 { "pair of triangles of the map overlaps" } else { "pairs of triangles of the map overlap" };
        flaws.push(format!("{pairs} {overlap}, on {:.2} % of it", 100.0 * share));
    }
    flaws
}

impl Atlas {
    /// How many islands there are.
    pub fn island_count(&self) -> usize {
        self.islands.iter().flatten().max().map_or(0, |&last| last as usize + 1)
    }

    /// The triangles that lie on a surface, as corners of the model.
    pub fn surface_triangles(&self) -> Vec<[u32; 3]> {
        self.on_surface().into_iter().map(|t| self.triangles.corners[t as usize]).collect()
    }

    /// The triangles that lie on a surface, by number.
    pub fn on_surface(&self) -> Vec<u32> {
        let mut is_kept = vec![true; self.triangles.len()];
        self.left_out.iter().for_each(|&t| is_kept[t as usize] = false);
        (0..).zip(is_kept).filter_map(|(t, kept)| kept.then_some(t)).collect()
    }

    /// The texture coordinates in a size.
    pub fn uv_in(&self, size: UvSize) -> Vec<[f64; 2]> {
        let low = self.uv.iter().fold([f64::INFINITY; 2], |low, uv| [0, 1].map(|k| uv[k].min(low[k])));
        let islands = self.fill * self.tiles as f64 / (self.scale * self.scale);
        let to_area = if islands > 0.0 { (self.area / islands).sqrt() } else { 1.0 };
        let place = |uv: &[f64; 2]| match size {
            UvSize::Unit => uv.map(|x| x * self.scale),
            UvSize::Area => [0, 1].map(|k| to_area * (uv[k] - low[k])),
            UvSize::Raw => *uv,
        };
        self.uv.par_iter().with_min_len(AT_ONCE).map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_atlas_of_a_model_with_another_number_of_corners_is_refused_by_both_numbers() {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 1.5, 0.0], [0.0, 1.0, 0.0]];
        let polygon = |face: &[u32]| Model::from_polygons(points.clone(), [face]).unwrap();
        let quad = polygon(&[0, 1, 2, 4]);
        let atlas = Analysis::new(&quad).unwrap().atlas(&Options::default()).unwrap();
        for (other, corners) in [(polygon(&[0, 1, 2]), 3), (polygon(&[0, 1, 2, 3, 4]), 5)] {
            let error = MeasuredAtlas::new(&other, atlas.clone(), UvSize::Unit, Weld::Never).unwrap_err();
            let told = format!("there are 4 texture coordinates for {corners} corners of faces");
            assert_eq!(error.to_string(), told);
        }
    }
}
