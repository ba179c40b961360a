//! How good a map is, under the keys of the command's reports (`docs/json.md`): the tests hold the two to the same numbers.

use cones::uv;
use geom::distortion::{self, DistortionError, Percentiles};
use geom::{Id, VertexId};
use serde::Serialize;

/// Points of the grid along the layout's longer side on which overlaps are looked for.
const OVERLAP_GRID: usize = 2048;
/// Where it is not known which vertices are the cones, those are taken that are curved by more than this.
const CONE: f64 = 0.1;

/// All measures of a map.
#[derive(Debug, Serialize)]
pub(crate) struct Quality {
    pub(crate) distortion: Distortion,
    pub(crate) islands: Vec<Island>,
    /// The first triangle that is flipped or degenerate.
    #[serde(skip)]
    pub(crate) first_flaw: Option<usize>,
    /// The triangles that lie over or under another.
    #[serde(skip)]
    pub(crate) overlapping: Vec<u32>,
    /// The island of each triangle.
    #[serde(skip)]
    pub(crate) triangle_island: Vec<u32>,
    /// σ₁/σ₂ of each triangle.
    #[serde(skip)]
    pub(crate) quasi_conformal: Vec<f64>,
    /// The centred log scale of each triangle.
    #[serde(skip)]
    pub(crate) log_scale: Vec<f64>,
}

/// How far a map is from isometric and conformal, and what is wrong with it.
#[derive(Debug, Serialize)]
pub(crate) struct Distortion {
    area_mean: f64,
    area_inverse_mean: f64,
    u_l2: f64,
    u_linf: f64,
    quasi_conformal: Percentiles,
    area: Percentiles,
    pub(crate) flipped: usize,
    pub(crate) degenerate: usize,
    overlap: f64,
    overlap_pairs: usize,
    overlap_depth: f64,
    fill: f64,
    seam_length: f64,
    curvature_error: f64,
}

/// A connected piece of a layout.
#[derive(Debug, Serialize)]
pub(crate) struct Island {
    faces: usize,
    /// Its share of the surface's area.
    area: f64,
}

impl Quality {
    /// Measures a map given at the corners of triangles; `cones` are its cones, if they are known.
    ///
    /// # Errors
    /// If the map does not fit the surface, or has a coordinate that is not finite.
    pub(crate) fn measure(
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        uv: &[uv::Triangle],
        cones: Option<&[u32]>,
    ) -> Result<Self, DistortionError> {
        let map = distortion::measure(points, triangles, uv)?;
        let cones: Vec<VertexId> = match cones {
            Some(known) => known.iter().map(|&v| VertexId::new(v as usize)).collect(),
            None => map.cones(CONE).into_iter().map(|(v, _)| v).collect(),
        };
        let overlaps = uv::overlaps(uv);
        let overlap_pairs = overlaps.pairs.len();
        let distortion = Distortion {
            area_mean: map.area.mean,
            area_inverse_mean: map.area_inverse_mean,
            u_l2: map.u_l2,
            u_linf: map.u_linf,
            quasi_conformal: map.quasi_conformal,
            area: map.area,
            flipped: map.flipped,
            degenerate: map.degenerate,
            // What the grid finds where no pair is, is rounding.
            overlap: if overlap_pairs == 0 { 0.0 } else { distortion::overlap(uv, OVERLAP_GRID) },
            overlap_pairs,
            overlap_depth: overlaps.depth(),
            fill: uv::fill(uv),
            seam_length: map.seam_length,
            curvature_error: map.curvature_error(&cones),
        };
        Ok(Self {
            distortion,
            overlapping: overlaps.triangles(),
            islands: map.islands.iter().map(|island| Island { faces: island.faces, area: island.area }).collect(),
            first_flaw: map.first_flaw.map(Id::index),
            triangle_island: map.triangle_island.to_vec(),
            quasi_conformal: map.triangle_quasi_conformal.to_vec(),
            log_scale: map.triangle_log_scale.to_vec(),
        })
    }
}
