//! How good a map is.

use std::collections::BTreeMap;

use geom::distortion::{self, DistortionError, Island, Percentiles};
use geom::{Id, VertexId, Watch};

use crate::uv::{self, NEGLIGIBLE_DEPTH, Overlaps, Triangle};

/// Where it is not known which vertices are the cones, those are taken that are curved by more than this.
const CONE: f64 = 0.1;

/// All measures of a map.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Quality {
    /// How far it is from isometric and conformal, and what is wrong with it.
    pub distortion: DistortionReport,
    /// Its connected pieces.
    pub islands: Vec<IslandReport>,
    /// The first triangle that is flipped or degenerate.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub first_flaw: Option<usize>,
    /// The triangles that lie over or under another.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub overlapping: Vec<u32>,
    /// The island of each triangle.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub triangle_island: Vec<u32>,
    /// The centred log scale of each triangle.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub log_scale: Vec<f64>,
    /// σ₁/σ₂ of each triangle, infinite if it is degenerate.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub quasi_conformal: Vec<f64>,
}

impl Quality {
    /// Measures a map given at the corners of triangles; `cones` are its cones, if they are known. Costs a sort of the triangles and what
    /// lies near each other in the plane.
    ///
    /// # Errors
    /// If the map does not fit the surface, or has a coordinate that is not finite, or if a cone is none of the points.
    pub fn measure(
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        uv: &[Triangle],
        cones: Option<&[u32]>,
    ) -> Result<Self, DistortionError> {
        Self::measure_watched(points, triangles, uv, cones, Watch::NONE)
    }

    /// [`measure`](Self::measure), watched.
    ///
    /// # Errors
    /// As [`measure`](Self::measure), and if it is stopped.
    pub fn measure_watched(
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        uv: &[Triangle],
        cones: Option<&[u32]>,
        watch: Watch,
    ) -> Result<Self, DistortionError> {
        Self::measure_deeper(points, triangles, uv, (cones, NEGLIGIBLE_DEPTH), None, watch)
    }

    /// [`measure_watched`](Self::measure_watched), where overlaps that are no deeper than a share of the map's extent are none, nor those of triangles with different
    /// textures, if these are given.
    pub(super) fn measure_deeper(
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        uv: &[Triangle],
        (cones, deeper_than): (Option<&[u32]>, f64),
        texture: Option<&[Option<u32>]>,
        watch: Watch,
    ) -> Result<Self, DistortionError> {
        let count = points.len();
        if let Some(&cone) = cones.into_iter().flatten().find(|&&cone| cone as usize >= count) {
            return Err(DistortionError::ConeOutOfRange { cone, count });
        }
        let is_one_texture =
            |[f, g]: [u32; 2]| texture.is_none_or(|texture| texture[f as usize] == texture[g as usize]);
        let (map, (overlaps, (fill, tiles))) = watch.within(0.0, 0.8).shared(|watch| {
            rayon::join(
                || distortion::measure_watched(points, triangles, uv, watch),
                || (uv::overlaps_watched(uv, deeper_than, is_one_texture, watch), uv::filled(uv)),
            )
        });
        let (map, overlaps) = (map?, overlaps?);
        let mut overlap = OverlapReport::new(&overlaps, uv);
        if let Some(texture) = texture.filter(|_| !overlaps.is_complete) {
            overlap.share = share_by_texture(uv, texture);
        }
        watch.ask(0.9)?;
        let cones: Vec<VertexId> = match cones {
            Some(known) => known.iter().map(|&v| VertexId::new(v as usize)).collect(),
            None => map.cones(CONE).into_iter().map(|(v, _)| v).collect(),
        };
        Ok(Self {
            distortion: DistortionReport {
                area_mean: map.area.mean,
                area_inverse_mean: map.area_inverse_mean,
                u_l2: map.u_l2,
                u_linf: map.u_linf,
                quasi_conformal: map.quasi_conformal,
                area: map.area,
                flipped: map.flipped,
                degenerate: map.degenerate,
                overlap,
                fill,
                tiles,
                seam_length: map.seam_length,
                curvature_error: map.curvature_error(&cones),
            },
            islands: map.islands.iter().map(IslandReport::from).collect(),
            first_flaw: map.first_flaw.map(Id::index),
            overlapping: overlaps.triangles(),
            triangle_island: map.triangle_island.to_vec(),
            log_scale: map.triangle_log_scale.to_vec(),
            quasi_conformal: map.triangle_quasi_conformal.to_vec(),
        })
    }
}

impl Quality {
    /// The log of the ratio of areas of each triangle, after the one scaling that makes the map's area the surface's; `areas`
    /// are the triangles' on the surface, in any unit.
    pub fn log_areas(&self, areas: &[f64]) -> Vec<f64> {
        let whole: f64 = areas.iter().sum();
        let scaled: f64 = areas.iter().zip(&self.log_scale).map(|(area, u)| area * (2.0 * u).exp()).sum();
        let shift = if scaled > 0.0 { (scaled / whole).ln() } else { 0.0 };
        self.log_scale.iter().map(|u| 2.0 * u - shift).collect()
    }
}

/// The share of a map that is covered more than once by triangles of one texture, where not all of their pairs are known: the mean of the textures', by area.
fn share_by_texture(uv: &[Triangle], texture: &[Option<u32>]) -> f64 {
    let mut of_texture: BTreeMap<Option<u32>, Vec<Triangle>> = BTreeMap::new();
    uv.iter().zip(texture).for_each(|(&triangle, &texture)| of_texture.entry(texture).or_default().push(triangle));
    let weighed = of_texture.values().map(|uv| {
        let area: f64 = uv.iter().filter_map(|&triangle| uv::area(triangle)).sum();
        [area, area * OverlapReport::of(uv).share]
    });
    let [area, overlapping] = weighed.fold([0.0; 2], |[area, share], [a, s]| [area + a, share + s]);
    if area > 0.0 { overlapping / area } else { 0.0 }
}

/// How far a map is from isometric and conformal, and what is wrong with it: figures of [`geom::distortion::Distortion`], overlap and fill.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct DistortionReport {
    /// Mean of max(r, 1/r), r the area ratio of a triangle: the D of the paper's Fig. 1.
    pub area_mean: f64,
    /// The mean of 1/r.
    pub area_inverse_mean: f64,
    /// The L2 norm of the centred log scale u = ½ log r.
    pub u_l2: f64,
    /// Its largest absolute value.
    pub u_linf: f64,
    /// σ₁/σ₂.
    pub quasi_conformal: Percentiles,
    /// max(r, 1/r).
    pub area: Percentiles,
    /// How many triangles are turned against the rest of their island.
    pub flipped: usize,
    /// How many have no area in the plane.
    pub degenerate: usize,
    /// How much lies over itself.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub overlap: OverlapReport,
    /// The triangles' areas over that of the tiles they are on, or of the smallest square about them.
    pub fill: f64,
    /// On how many tiles the map is, unit squares; nothing where it keeps to none.
    pub tiles: Option<usize>,
    /// Relative to the square root of the surface's area.
    pub seam_length: f64,
    /// The largest curvature off the cones, in radians.
    pub curvature_error: f64,
}

/// How much of a layout lies over itself.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct OverlapReport {
    /// The share of the layout that is covered more than once.
    #[cfg_attr(feature = "serde", serde(rename = "overlap"))]
    pub share: f64,
    /// How many pairs of triangles lie over each other.
    #[cfg_attr(feature = "serde", serde(rename = "overlap_pairs"))]
    pub pairs: usize,
    /// Whether these are all pairs; where very many lie over each other counting ends.
    #[cfg_attr(feature = "serde", serde(rename = "overlap_complete"))]
    pub is_complete: bool,
    /// How far two triangles reach into each other at most, over the layout's extent.
    #[cfg_attr(feature = "serde", serde(rename = "overlap_depth"))]
    pub depth: f64,
}

impl OverlapReport {
    /// How much of a map lies over itself deeper than [rounding](uv::rounding_depth) explains.
    pub fn of(uv: &[Triangle]) -> Self {
        // Only a watch interrupts.
        let found = uv::overlaps_watched(uv, uv::rounding_depth(uv), |_| true, Watch::NONE);
        Self::new(&found.unwrap_or_default(), uv)
    }

    fn new(overlaps: &Overlaps, uv: &[Triangle]) -> Self {
        let &Overlaps { ref pairs, is_complete, .. } = overlaps;
        Self { share: overlaps.share(uv), pairs: pairs.len(), is_complete, depth: overlaps.depth() }
    }
}

/// A connected piece of a layout.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct IslandReport {
    /// How many triangles it has.
    pub faces: usize,
    /// Its share of the surface's area.
    pub area: f64,
}

impl From<&Island> for IslandReport {
    fn from(island: &Island) -> Self {
        Self { faces: island.faces, area: island.area }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_that_is_no_vertex_is_refused() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let measured =
            |cones: &[u32]| Quality::measure(&points, &[[0, 1, 2]], &[points.map(|[x, y, _]| [x, y])], Some(cones));
        assert!(measured(&[2]).is_ok());
        let told = measured(&[2, 3]).unwrap_err();
        assert_eq!(told, DistortionError::ConeOutOfRange { cone: 3, count: 3 });
        assert_eq!(told.to_string(), "cone 3 is no vertex: there are 3 vertices only (counted from 0)");
    }
}
