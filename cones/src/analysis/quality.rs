//! What a layout of a component is worth, as it came out.

use geom::{FaceId, Id, Mesh, Metric};
use rayon::prelude::*;

use crate::flatten::{BENT, Layout, stretch};
use crate::placement::distortion_of;

/// σ₁/σ₂ counts up to here, so that one needle does not outweigh a surface.
const WORST: f64 = 1e3;
/// So many triangles are measured one after the other.
const AT_ONCE: usize = 1024;

/// The measures of [`geom::distortion`] that attempts are compared by.
#[derive(Clone, Debug)]
pub(crate) struct Quality {
    /// The mean of σ₁/σ₂, weighted by area.
    pub(crate) quasi_conformal: f64,
    /// Each triangle's area in space, and its area in the layout over that.
    pub(crate) ratios: Vec<(f64, f64)>,
    /// The share of the area in triangles with σ₁/σ₂ above [`BENT`].
    pub(crate) bent_share: f64,
}

impl Quality {
    /// Measures a layout; `metric` has the lengths in space. Triangles without area in space are left out.
    pub(crate) fn of(mesh: &Mesh, metric: &Metric, layout: &Layout) -> Self {
        let measured = |f: usize| {
            let f = FaceId::new(f);
            let sides = metric.sides(mesh, f);
            let [stretch, ratio] = stretch(sides, mesh.sides(f).map(|h| layout.corner(h)))?;
            let area = sides.area();
            Some((area, stretch, ratio))
        };
        let measured: Vec<(f64, f64, f64)> =
            (0..mesh.face_count()).into_par_iter().with_min_len(AT_ONCE).filter_map(measured).collect();
        let sums = || {
            let whole: f64 = measured.iter().map(|(area, ..)| area).sum();
            let sum: f64 = measured.iter().map(|(area, stretch, _)| area * stretch.min(WORST)).sum();
            let bent: f64 = measured.iter().filter(|(_, stretch, _)| *stretch > BENT).map(|(area, ..)| area).sum();
            [sum / whole, bent / whole]
        };
        let ratios = || measured.iter().map(|&(area, _, ratio)| (area, ratio)).collect();
        let ([quasi_conformal, bent_share], ratios) = rayon::join(sums, ratios);
        Self { quasi_conformal, bent_share, ratios }
    }

    /// What maps are compared by: the logarithms of both distortions, added up.
    pub(crate) fn cost(&self) -> f64 {
        self.area_distortion().ln() + self.quasi_conformal.ln()
    }

    /// The mean of the log scale, weighted by area.
    pub(crate) fn mean_log_scale(&self) -> f64 {
        let whole: f64 = self.ratios.iter().map(|(area, _)| area).sum();
        let weighed = self.ratios.par_iter().with_min_len(AT_ONCE).map(|(area, ratio)| 0.5 * area * ratio.ln());
        // Added up in order, so that the bits are the same for any number of threads.
        weighed.collect::<Vec<f64>>().iter().sum::<f64>() / whole
    }

    /// The largest log scale of a triangle, either way, beside the mean.
    pub(crate) fn largest_log_scale(&self) -> f64 {
        let mean = self.mean_log_scale();
        let ratios = self.ratios.iter().map(|(_, ratio)| *ratio);
        let (least, most) =
            ratios.fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), r| (least.min(r), most.max(r)));
        [least, most].into_iter().map(|ratio| (0.5 * ratio.ln() - mean).abs()).fold(0.0, f64::max)
    }

    /// The area distortion D.
    pub(crate) fn area_distortion(&self) -> f64 {
        distortion_of(&self.ratios)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_log_scale_is_that_farthest_from_the_mean_either_way() {
        for sign in [1.0, -1.0] {
            // Log scales of 1, -2 and 0.5, with the mean 0.3 · 1 - 0.2 · 2 + 0.5 · 0.5 = 0.15.
            let ratios =
                [(3.0, 1.0), (2.0, -2.0), (5.0, 0.5)].map(|(area, u): (f64, f64)| (area, (2.0 * sign * u).exp()));
            let quality = Quality { quasi_conformal: 1.0, ratios: ratios.to_vec(), bent_share: 0.0 };
            assert!((quality.mean_log_scale() - sign * 0.15).abs() < 1e-12);
            assert!((quality.largest_log_scale() - 2.15).abs() < 1e-12);
        }
    }
}
