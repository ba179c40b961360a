//! The part of a report that says how good a map is.

use cones::uv::fill;
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
        Ok(Self {
            distortion: DistortionReport {
                fill: fill(uv),
                ..DistortionReport::new(&map, distortion::overlap(uv, OVERLAP_GRID), map.curvature_error(&cones))
            },
            islands: map.islands.iter().map(IslandReport::from).collect(),
            first_flaw: map.first_flaw.map(Id::index),
        })
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
    /// The share of the layout that is covered more than once.
    pub(crate) overlap: f64,
    /// The triangles' areas over that of the tiles they are on, or of the smallest square about them.
    pub(crate) fill: f64,
    /// Relative to the square root of the surface's area.
    pub(crate) seam_length: f64,
    /// The largest curvature off the cones, in radians.
    pub(crate) curvature_error: f64,
}

/// A connected piece of a layout.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct IslandReport {
    pub(crate) faces: usize,
    /// Its share of the surface's area.
    pub(crate) area: f64,
}

impl DistortionReport {
    fn new(map: &Distortion, overlap: f64, curvature_error: f64) -> Self {
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
