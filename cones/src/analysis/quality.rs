//! What a layout of a component is worth, as it came out.

use geom::{FaceId, Id, Mesh, Metric};
use num_complex::Complex64;
use rayon::prelude::*;

use crate::flatten::Layout;
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
}

impl Quality {
    /// Measures a layout; `metric` has the lengths in space. Triangles without area in space are left out.
    pub(crate) fn of(mesh: &Mesh, metric: &Metric, layout: &Layout) -> Self {
        let measured = |f: usize| {
            let f = FaceId::new(f);
            let sides = metric.sides(mesh, f);
            let area = sides.area();
            let [along, _, back] = sides.unfold().map(|[x, y]| Complex64::new(x, y));
            let [a, b, c] = mesh.sides(f).map(|h| layout.corner(h));
            // The map z ↦ p z + q z̄ takes both sides at the first corner to their images.
            let (z, w) = (along, -back);
            let determinant = z * w.conj() - w * z.conj();
            let is_measured = area > 0.0 && determinant.norm() > 0.0; // not so with NaN either
            if !is_measured {
                return None;
            }
            let p = ((b - a) * w.conj() - (c - a) * z.conj()) / determinant;
            let q = (z * (c - a) - w * (b - a)) / determinant;
            let stretch = (p.norm() + q.norm()) / (p.norm() - q.norm()).abs().max(f64::MIN_POSITIVE);
            Some((area, stretch, (p.norm_sqr() - q.norm_sqr()).abs().max(f64::MIN_POSITIVE)))
        };
        let measured: Vec<(f64, f64, f64)> =
            (0..mesh.face_count()).into_par_iter().with_min_len(AT_ONCE).filter_map(measured).collect();
        let whole: f64 = measured.iter().map(|(area, ..)| area).sum();
        let sum: f64 = measured.iter().map(|(area, stretch, _)| area * stretch.min(WORST)).sum();
        Self { quasi_conformal: sum / whole, ratios: measured.iter().map(|&(area, _, ratio)| (area, ratio)).collect() }
    }

    /// The area distortion D.
    pub(crate) fn area_distortion(&self) -> f64 {
        distortion_of(&self.ratios)
    }
}
