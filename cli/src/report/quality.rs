//! The part of a report that says how good a map is.

use cones::uv;
use geom::distortion::{self, Distortion, DistortionError, Island, Percentiles};
use geom::{Id, VertexId};
use serde::Serialize;

/// Points of the grid along the layout's longer side on which overlaps are looked for.
const OVERLAP_GRID: usize = 2048;
/// Where it is not known which vertices are the cones, those are taken that are curved by more than this.
const CONE: f64 = 0.1;

/// All measures of a map.
#[derive(Clone, Debug)]
pub(crate) struct Quality {
    pub(crate) distortion: DistortionReport,
    pub(crate) islands: Vec<IslandReport>,
    /// The first triangle that is flipped or degenerate.
    pub(crate) first_flaw: Option<usize>,
    /// The triangles that lie over or under another.
    pub(crate) overlapping: Vec<u32>,
    /// The centred log scale of each triangle.
    pub(crate) log_scale: Vec<f64>,
    /// σ₁/σ₂ of each triangle, infinite if it is degenerate.
    pub(crate) stretch: Vec<f64>,
}

impl Quality {
    /// Measures a map given at the corners of triangles; `cones` are its cones, if they are known.
    pub(crate) fn measure(
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        uv: &[[[f64; 2]; 3]],
        cones: Option<&[u32]>,
    ) -> Result<Self, DistortionError> {
        let map = distortion::measure(points, triangles, uv)?;
        let cones: Vec<VertexId> = match cones {
            Some(known) => known.iter().map(|&v| VertexId::new(v as usize)).collect(),
            None => map.cones(CONE).into_iter().map(|(v, _)| v).collect(),
        };
        let overlaps = uv::overlaps(uv);
        Ok(Self {
            distortion: DistortionReport {
                fill: uv::fill(uv),
                ..DistortionReport::new(&map, OverlapReport::new(&overlaps, uv), map.curvature_error(&cones))
            },
            overlapping: overlaps.triangles(),
            islands: map.islands.iter().map(IslandReport::from).collect(),
            first_flaw: map.first_flaw.map(Id::index),
            log_scale: map.triangle_log_scale.to_vec(),
            stretch: map.triangle_quasi_conformal.to_vec(),
        })
    }
}

impl Quality {
    /// The log of the ratio of areas of each triangle, after the one scaling that makes the map's area the surface's; `areas`
    /// are the triangles' on the surface, in any unit.
    pub(crate) fn log_areas(&self, areas: &[f64]) -> Vec<f64> {
        let whole: f64 = areas.iter().sum();
        let scaled: f64 = areas.iter().zip(&self.log_scale).map(|(area, u)| area * (2.0 * u).exp()).sum();
        let shift = if scaled > 0.0 { (scaled / whole).ln() } else { 0.0 };
        self.log_scale.iter().map(|u| 2.0 * u - shift).collect()
    }
}

/// How far a map is from isometric and conformal, and what is wrong with it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct DistortionReport {
    /// Mean of max(r, 1/r), r the area ratio of a triangle: the D of the paper's Fig. 1.
    pub(crate) area_mean: f64,
    pub(crate) area_inverse_mean: f64,
    pub(crate) u_l2: f64,
    pub(crate) u_linf: f64,
    pub(crate) quasi_conformal: Percentiles,
    pub(crate) area: Percentiles,
    pub(crate) flipped: usize,
    pub(crate) degenerate: usize,
    #[serde(flatten)]
    pub(crate) overlap: OverlapReport,
    /// The triangles' areas over that of the tiles they are on, or of the smallest square about them.
    pub(crate) fill: f64,
    /// Relative to the square root of the surface's area.
    pub(crate) seam_length: f64,
    /// The largest curvature off the cones, in radians.
    pub(crate) curvature_error: f64,
}

/// How much of a layout lies over itself.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct OverlapReport {
    /// The share of the layout that is covered more than once.
    #[serde(rename = "overlap")]
    pub(crate) share: f64,
    /// How many pairs of triangles lie over each other.
    #[serde(rename = "overlap_pairs")]
    pub(crate) pairs: usize,
    /// How far two triangles reach into each other at most, over the layout's extent.
    #[serde(rename = "overlap_depth")]
    pub(crate) depth: f64,
}

impl OverlapReport {
    /// How much of a map lies over itself.
    pub(crate) fn of(uv: &[uv::Triangle]) -> Self {
        Self::new(&uv::overlaps(uv), uv)
    }

    fn new(overlaps: &uv::Overlaps, uv: &[uv::Triangle]) -> Self {
        let pairs = overlaps.pairs.len();
        // What the grid finds where no pair is, is rounding.
        let share = if pairs == 0 { 0.0 } else { distortion::overlap(uv, OVERLAP_GRID) };
        Self { share, pairs, depth: overlaps.depth() }
    }
}

/// A connected piece of a layout.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct IslandReport {
    pub(crate) faces: usize,
    /// Its share of the surface's area.
    pub(crate) area: f64,
}

impl DistortionReport {
    fn new(map: &Distortion, overlap: OverlapReport, curvature_error: f64) -> Self {
        Self {
            area_mean: map.area.mean,
            area_inverse_mean: map.area_inverse_mean,
            u_l2: map.u_l2,
            u_linf: map.u_linf,
            quasi_conformal: map.quasi_conformal,
            area: map.area,
            flipped: map.flipped,
            degenerate: map.degenerate,
            overlap,
            fill: 0.0,
            seam_length: map.seam_length,
            curvature_error,
        }
    }
}

impl From<&Island> for IslandReport {
    fn from(island: &Island) -> Self {
        Self { faces: island.faces, area: island.area }
    }
}
