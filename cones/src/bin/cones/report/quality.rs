//! The part of a report that says how good a map is.

use geom::distortion::{Distortion, Island, Percentiles};
use serde::Serialize;

/// How far a map is from isometric and conformal, and what is wrong with it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct DistortionReport {
    /// Mean of max(r, 1/r), r the area ratio of a triangle: the D of the paper's Fig. 1.
    pub(crate) area_mean: f64,
    pub(crate) area_inverse_mean: f64,
    pub(crate) u_l2: f64,
    pub(crate) u_linf: f64,
    pub(crate) quasi_conformal: Spread,
    pub(crate) area: Spread,
    pub(crate) flipped: usize,
    pub(crate) degenerate: usize,
    /// The share of the layout that is covered more than once.
    pub(crate) overlap: f64,
    /// Relative to the square root of the surface's area.
    pub(crate) seam_length: f64,
    /// The largest curvature off the cones, in radians.
    pub(crate) curvature_error: f64,
}

/// How a measure is spread over the surface, weighted by area.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Spread {
    pub(crate) mean: f64,
    pub(crate) median: f64,
    pub(crate) p95: f64,
    pub(crate) p99: f64,
    pub(crate) max: f64,
}

/// A connected piece of a layout.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct IslandReport {
    pub(crate) faces: usize,
    /// Its share of the surface's area.
    pub(crate) area: f64,
}

impl From<&Distortion> for DistortionReport {
    fn from(_: &Distortion) -> Self {
        let s = Spread { mean: 0.0, median: 0.0, p95: 0.0, p99: 0.0, max: 0.0 };
        Self {
            area_mean: 0.0,
            area_inverse_mean: 0.0,
            u_l2: 0.0,
            u_linf: 0.0,
            quasi_conformal: s,
            area: s,
            flipped: 0,
            degenerate: 0,
            overlap: 0.0,
            seam_length: 0.0,
            curvature_error: 0.0,
        }
    }
}
impl From<&Island> for IslandReport {
    fn from(i: &Island) -> Self {
        Self { faces: i.faces, area: i.area }
    }
}
