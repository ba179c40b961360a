//! The measures of all triangles and how they are spread.

use super::linear::Image;
use super::{DistortionError, Percentiles};
use crate::mesh::{FaceData, FaceId, Id};
use crate::parallel::{map, sort_by};

/// What can be measured: the triangles with an area on both sides, and their measures.
pub(super) struct Measured {
    pub(super) faces: Vec<FaceId>,
    /// Areas on the surface; they sum to 1.
    weight: Vec<f64>,
    pub(super) quasi_conformal: Vec<f64>,
    pub(super) area_ratio: Vec<f64>,
    /// Centred.
    pub(super) log_scale: Vec<f64>,
}

impl Measured {
    pub(super) fn new(images: &[Image]) -> Result<Self, DistortionError> {
        let with_surface: Vec<FaceId> = (0..images.len()).filter(|&f| images[f].has_surface).map(FaceId::new).collect();
        let areas = |faces: &[FaceId]| {
            let sum = |area: fn(&Image) -> f64| faces.iter().map(|f| area(&images[f.index()])).sum::<f64>();
            (sum(|image| image.surface_area), sum(|image| image.area.abs()))
        };
        let ratio =
            |image: &Image, (surface, plane): (f64, f64)| image.area.abs() * (surface / plane) / image.surface_area;
        let of_all = areas(&with_surface);
        let is_measured = |image: &Image| !image.is_collapsed && ratio(image, of_all) > 1e-14;
        let faces: Vec<FaceId> = with_surface.into_iter().filter(|f| is_measured(&images[f.index()])).collect();
        if faces.is_empty() {
            return Err(DistortionError::NoArea);
        }
        let measured = |k: usize| &images[faces[k].index()];
        let (total, plane) = areas(&faces);
        let area_ratio = map(faces.len(), |k| ratio(measured(k), (total, plane)));
        let mut new = Self {
            weight: map(faces.len(), |k| measured(k).surface_area / total),
            quasi_conformal: map(faces.len(), |k| measured(k).quasi_conformal),
            log_scale: map(faces.len(), |k| 0.5 * area_ratio[k].ln()),
            area_ratio,
            faces,
        };
        let mean = new.mean(new.log_scale.iter().copied());
        new.log_scale.iter_mut().for_each(|u| *u -= mean);
        Ok(new)
    }

    pub(super) fn mean(&self, values: impl Iterator<Item = f64>) -> f64 {
        values.zip(&self.weight).map(|(value, weight)| value * weight).sum()
    }

    pub(super) fn percentiles(&self, values: &[f64]) -> Percentiles {
        let mut sorted: Vec<(f64, f64)> = values.iter().copied().zip(self.weight.iter().copied()).collect();
        // Where values are equal by their weights, so that the bits are the same for any number of threads.
        sort_by(&mut sorted, |a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let max = sorted.last().map_or(f64::NAN, |last| last.0);
        let mut below = 0.0;
        for (_, weight) in &mut sorted {
            below += *weight;
            *weight = below;
        }
        let [median, p95, p99] = [0.5, 0.95, 0.99].map(|share| {
            let reached = sorted.partition_point(|&(_, below)| below < share);
            sorted.get(reached).map_or(max, |&(value, _)| value)
        });
        Percentiles { mean: self.mean(values.iter().copied()), median, p95, p99, max }
    }

    /// The first triangle with an area on the surface that is turned over in the map, or has no area there.
    pub(super) fn first_flaw(&self, images: &[Image]) -> Option<FaceId> {
        let mut measured = self.faces.iter().peekable();
        let mut is_flawed = |f: FaceId, image: &Image| {
            let is_measured = measured.next_if_eq(&&f).is_some();
            image.has_surface && (image.area < 0.0 || !is_measured)
        };
        (0..images.len()).map(FaceId::new).zip(images).find(|&(f, image)| is_flawed(f, image)).map(|(f, _)| f)
    }

    pub(super) fn by_face(&self, count: usize, values: &[f64], otherwise: f64) -> FaceData<f64> {
        let mut by_face = FaceData::constant(count, otherwise);
        self.faces.iter().zip(values).for_each(|(&f, &value)| by_face[f] = value);
        by_face
    }
}
