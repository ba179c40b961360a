//! How far a map of a surface to the plane is from isometric and conformal.
//!
//! On a triangle the map is linear, with singular values σ₁ ≥ σ₂. The measures, all weighted by area on the surface:
//!
//! - *quasi-conformal* σ₁/σ₂: 1 where the map keeps angles (the paper's Table 1);
//! - *area* max(r, 1/r), where r is the triangle's area in the plane over that on the surface, after one scaling of the
//!   whole map that makes the total areas equal: 1 where the map keeps areas. Its mean is the D of the paper's Fig. 1;
//!   the mean of 1/r is closest to the areal figures of Table 1;
//! - *log scale* u = ½ log r, less its mean: 0 where the map keeps lengths up to one scale. Unlike a mean of r, which is
//!   always 1, its norms see every deviation.
//!
//! The map is given at the corners of triangles, since a vertex on a seam has several images. Two triangles belong to
//! one *island* if they share an edge whose two ends have the same images in both; other edges inside the surface are
//! the *seam*. The triangles may be any: meeting in threes, turned against each other, without area.
//!
//! The cone angles of a map are read off it: the *curvature* of a vertex inside the surface is 2π less the angles round
//! its images. It is 0 off the cones if the map is a flattening by cones at all.

mod chart;
mod linear;
mod measured;
mod overlap;
mod unit;

pub use overlap::{coverage, overlap};
pub use unit::unit_on_surface;

use std::array;
use std::borrow::Cow;
use std::f64::consts::PI;

use thiserror::Error;

use self::chart::Charts;
use self::linear::{Image, images};
use self::measured::Measured;
use crate::counted::are;
use crate::mesh::{FaceData, FaceId, Id, VertexData, VertexId};
use crate::parallel::join;
use crate::vector::distance;
use crate::watch::{Interrupted, Watch};

/// Extents of up to 2 to so many, or over so many, are computed with as they are.
const NEAR_UNIT: f64 = 20.0;

/// The measures of a map; see the module's head.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Distortion {
    /// σ₁/σ₂.
    pub quasi_conformal: Percentiles,
    /// max(r, 1/r).
    pub area: Percentiles,
    /// The mean of 1/r.
    pub area_inverse_mean: f64,
    /// The root of the mean square of the centred log scale.
    pub u_l2: f64,
    /// The largest absolute centred log scale.
    pub u_linf: f64,
    /// How many triangles are oriented against the greater part of their island.
    pub flipped: usize,
    /// How many triangles that have an area on the surface have none in the plane, or nearly none. They take no part in
    /// the measures.
    pub degenerate: usize,
    /// The first triangle that is flipped or has no area in the plane but one on the surface.
    pub first_flaw: Option<FaceId>,
    /// How many triangles have no area on the surface. They take no part in the measures either.
    pub degenerate_on_surface: usize,
    /// The connected pieces of the map, ordered by their first triangles.
    pub islands: Vec<Island>,
    /// How many edges inside the surface are cut.
    pub seam_edges: usize,
    /// Their length on the surface over the square root of its area.
    pub seam_length: f64,
    /// How much longer one side of the seam is than the other: the mean, weighted by length, of the difference over the
    /// average. 0 for a flattening by cones.
    pub seam_mismatch: f64,
    /// 2π less the angles at each vertex's images; 0 on the boundary and where no triangle is.
    pub curvature: VertexData<f64>,
    /// σ₁/σ₂ of each triangle, infinite if it is degenerate.
    pub triangle_quasi_conformal: FaceData<f64>,
    /// The centred log scale of each triangle, 0 if it is degenerate.
    pub triangle_log_scale: FaceData<f64>,
    /// Which island each triangle is in.
    pub triangle_island: FaceData<u32>,
}

impl Distortion {
    /// The vertices with a curvature beyond a threshold, largest first.
    pub fn cones(&self, threshold: f64) -> Vec<(VertexId, f64)> {
        let found = self.curvature.iter_ids().filter(|(_, k)| k.abs() > threshold);
        let mut cones: Vec<_> = found.map(|(v, &k)| (v, k)).collect();
        cones.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        cones
    }

    /// The largest absolute curvature off the cones.
    pub fn curvature_error(&self, cones: &[VertexId]) -> f64 {
        let mut off_cones = self.curvature.clone();
        for &v in cones.iter().filter(|v| v.index() < self.curvature.len()) {
            off_cones[v] = 0.0;
        }
        off_cones.iter().fold(0.0, |most, k| k.abs().max(most))
    }
}

/// How a measure is spread over the surface, by area.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Percentiles {
    /// The mean.
    pub mean: f64,
    /// What half of the surface does not exceed.
    pub median: f64,
    /// What 95 % of the surface do not exceed.
    pub p95: f64,
    /// What 99 % of the surface do not exceed.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

/// A connected piece of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Island {
    /// How many triangles it has.
    pub faces: usize,
    /// Its share of the surface's area.
    pub area: f64,
    /// Vertices - edges + triangles.
    pub euler_characteristic: i64,
    /// How many loops bound it.
    pub boundary_loops: usize,
    /// Whether most of it is turned clockwise.
    pub is_mirrored: bool,
}

impl Island {
    /// Whether it is a topological disk.
    pub fn is_disk(&self) -> bool {
        self.euler_characteristic == 1 && self.boundary_loops == 1
    }
}

/// Why a map cannot be measured.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DistortionError {
    /// The lists do not belong together.
    #[error("there {} but texture coordinates for {uv}", are(*triangles, "triangle", "triangles"))]
    Count {
        /// How many triangles there are.
        triangles: usize,
        /// How many have images.
        uv: usize,
    },
    /// Texture coordinates are one for each corner of a model's faces.
    #[error("there {} for {corners} corners of faces", are(*found, "texture coordinate", "texture coordinates"))]
    TextureCount {
        /// How many texture coordinates there are.
        found: usize,
        /// How many corners there are.
        corners: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {face} uses vertex {vertex}, but there {} only (counted from 0)", are(*count, "vertex", "vertices"))]
    VertexOutOfRange {
        /// The triangle.
        face: FaceId,
        /// What it names.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// A cone is no vertex.
    #[error("cone {cone} is no vertex: there {} only (counted from 0)", are(*count, "vertex", "vertices"))]
    ConeOutOfRange {
        /// The cone.
        cone: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// A coordinate in space is infinite or NaN.
    #[error("vertex {0} has a coordinate that is not a finite number")]
    PointNotFinite(VertexId),
    /// A coordinate in the plane is infinite or NaN.
    #[error("triangle {0} has a texture coordinate that is not a finite number")]
    UvNotFinite(FaceId),
    /// There is nothing to measure.
    #[error("no triangle has an area both on the surface and in texture space, so that there is nothing to measure")]
    NoArea,
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// Measures a map, given by the images of the corners of each triangle. Linear but for two sorts of the triangles.
///
/// ```
/// use geom::distortion::measure;
/// // A unit square whose image is stretched to twice its width.
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let triangles = [[0, 1, 2], [0, 2, 3]];
/// let uv = triangles.map(|t| t.map(|v| [2.0 * points[v as usize][0], points[v as usize][1]]));
/// let distortion = measure(&points, &triangles, &uv)?;
/// assert_eq!(distortion.quasi_conformal.max, 2.0);
/// assert_eq!(distortion.area.mean, 1.0);
/// assert!(distortion.islands[0].is_disk());
/// # Ok::<(), geom::distortion::DistortionError>(())
/// ```
///
/// # Errors
/// If indices are out of range, coordinates are not finite, or no triangle has an area on both sides.
pub fn measure(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    uv: &[[[f64; 2]; 3]],
) -> Result<Distortion, DistortionError> {
    measure_watched(points, triangles, uv, Watch::NONE)
}

/// [`measure`], watched.
///
/// # Errors
/// As [`measure`], and if it is stopped.
pub fn measure_watched(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    uv: &[[[f64; 2]; 3]],
    watch: Watch,
) -> Result<Distortion, DistortionError> {
    watch.ask(0.0)?;
    check(points, triangles, uv)?;
    let (points, uv) = join(
        || unit_size(points, triangles.as_flattened().iter().map(|&v| points[v as usize])),
        || unit_size(uv.as_flattened(), uv.as_flattened().iter().copied()),
    );
    let uv = uv.as_chunks::<3>().0;
    watch.ask(0.1)?;
    let (images, charts) =
        join(|| images(&points, triangles, uv), || Charts::new(points.len(), triangles, uv, watch.within(0.1, 0.55)));
    let (mut images, charts) = (images, charts?);
    watch.ask(0.55)?;
    orient(&mut images, &charts);
    watch.ask(0.58)?;
    let measured = Measured::new(&images)?;
    watch.ask(0.6)?;
    let from_one = || measured.area_ratio.iter().map(|r| r.max(1.0 / r)).collect::<Vec<_>>();
    let (((curvature, seam), islands), (quasi_conformal, area)) = join(
        || {
            let curvature_and_seam =
                || (curvature(&charts, triangles, uv, &images, points.len()), seam(&charts, triangles, &points, uv));
            join(curvature_and_seam, || islands(&charts, &images))
        },
        || join(|| measured.percentiles(&measured.quasi_conformal), || measured.percentiles(&from_one())),
    );
    watch.ask(0.9)?;
    let total_area: f64 = images.iter().map(|image| image.surface_area).sum();
    Ok(Distortion {
        quasi_conformal,
        area,
        area_inverse_mean: measured.mean(measured.area_ratio.iter().map(|r| 1.0 / r)),
        u_l2: measured.mean(measured.log_scale.iter().map(|u| u * u)).sqrt(),
        u_linf: measured.log_scale.iter().fold(0.0, |most, u| u.abs().max(most)),
        flipped: images.iter().filter(|image| image.has_surface && image.area < 0.0).count(),
        degenerate: images.iter().filter(|image| image.has_surface).count() - measured.faces.len(),
        first_flaw: measured.first_flaw(&images),
        degenerate_on_surface: images.iter().filter(|image| !image.has_surface).count(),
        islands,
        seam_edges: charts.seam().count(),
        seam_length: seam.length / total_area.sqrt(),
        seam_mismatch: seam.mismatch,
        curvature,
        triangle_quasi_conformal: measured.by_face(images.len(), &measured.quasi_conformal, f64::INFINITY),
        triangle_log_scale: measured.by_face(images.len(), &measured.log_scale, 0.0),
        triangle_island: charts.island,
    })
}

fn check(points: &[[f64; 3]], triangles: &[[u32; 3]], uv: &[[[f64; 2]; 3]]) -> Result<(), DistortionError> {
    let count = points.len();
    if triangles.len() != uv.len() {
        return Err(DistortionError::Count { triangles: triangles.len(), uv: uv.len() });
    }
    for (f, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
            return Err(DistortionError::VertexOutOfRange { face: FaceId::new(f), vertex, count });
        }
    }
    let is_finite = |p: &[f64]| p.iter().all(|x| x.is_finite());
    if let Some(v) = points.iter().position(|p| !is_finite(p)) {
        return Err(DistortionError::PointNotFinite(VertexId::new(v)));
    }
    if let Some(f) = uv.iter().position(|corners| !is_finite(corners.as_flattened())) {
        return Err(DistortionError::UvNotFinite(FaceId::new(f)));
    }
    Ok(())
}

/// Points scaled by a power of two, and so without rounding, such that those in use have an extent that is not far from 1: areas
/// neither overflow nor vanish.
fn unit_size<const N: usize>(points: &[[f64; N]], used: impl Iterator<Item = [f64; N]>) -> Cow<'_, [[f64; N]]> {
    let [low, high] = used.fold([[f64::MAX; N], [f64::MIN; N]], |[low, high], p| {
        [array::from_fn(|axis| p[axis].min(low[axis])), array::from_fn(|axis| p[axis].max(high[axis]))]
    });
    let largest = (0..N).map(|axis| 0.5 * high[axis] - 0.5 * low[axis]).fold(0.0, f64::max);
    let exponent = if largest > 0.0 { -largest.log2().floor() } else { 0.0 };
    if exponent.abs() < NEAR_UNIT {
        return Cow::Borrowed(points);
    }
    // In two steps, as 2^1074 is no number.
    let (first, second) = ((0.5 * exponent).floor().exp2(), (exponent - (0.5 * exponent).floor()).exp2());
    points.iter().map(|p| p.map(|x| x * first * second)).collect()
}

/// Turns the areas' signs so that they are positive in the greater part of each island. (In a closed one neither part is
/// greater.)
fn orient(images: &mut [Image], charts: &Charts) {
    let mut signed = vec![0.0; charts.count];
    let mut total = vec![0.0; charts.count];
    for (f, (image, &island)) in images.iter_mut().zip(charts.island.iter()).enumerate() {
        image.area *= charts.orientation(f);
        signed[island as usize] += image.area;
        total[island as usize] += image.area.abs();
    }
    for (image, &island) in images.iter_mut().zip(charts.island.iter()) {
        image.is_mirrored = signed[island as usize] < -1e-9 * total[island as usize];
        if image.is_mirrored {
            image.area = -image.area;
        }
    }
}

fn islands(charts: &Charts, images: &[Image]) -> Vec<Island> {
    let empty = Island { faces: 0, area: 0.0, euler_characteristic: 0, boundary_loops: 0, is_mirrored: false };
    let mut islands = vec![empty; charts.count];
    let total: f64 = images.iter().map(|image| image.surface_area).sum();
    for (image, &island) in images.iter().zip(charts.island.iter()) {
        let island = &mut islands[island as usize];
        island.faces += 1;
        island.area += image.surface_area / total;
        island.is_mirrored = image.is_mirrored;
    }
    for (island, (chi, loops)) in
        islands.iter_mut().zip(charts.euler_characteristics().into_iter().zip(charts.boundary_loops()))
    {
        island.euler_characteristic = chi;
        island.boundary_loops = loops;
    }
    islands
}

/// 2π less the angles at the images of each vertex inside the surface, 2π for each fan of triangles round it; angles of flipped triangles count
/// negative.
fn curvature(
    charts: &Charts,
    triangles: &[[u32; 3]],
    uv: &[[[f64; 2]; 3]],
    images: &[Image],
    count: usize,
) -> VertexData<f64> {
    let mut curvature = VertexData::constant(count, 0.0);
    let mut is_inside = vec![false; count];
    triangles.as_flattened().iter().for_each(|&v| is_inside[v as usize] = true);
    for side in charts.boundary_sides() {
        for corner in [side, chart::end(side)] {
            is_inside[triangles.as_flattened()[corner as usize] as usize] = false;
        }
    }
    curvature.iter_mut().zip(&is_inside).filter(|&(_, &is_inside)| is_inside).for_each(|(k, _)| *k = 2.0 * PI);
    for ((corners, uv), image) in triangles.iter().zip(uv).zip(images) {
        for k in 0..3 {
            if is_inside[corners[k] as usize] {
                let angle = linear::angle(uv[k], uv[(k + 1) % 3], uv[(k + 2) % 3]);
                curvature[VertexId(corners[k])] -= if image.area < 0.0 { -angle } else { angle };
            }
        }
    }
    for v in charts.further_fans(triangles.as_flattened(), &is_inside) {
        curvature[VertexId(v)] += 2.0 * PI;
    }
    curvature
}

/// The seam's length on the surface, and how much its sides differ in the plane.
struct Seam {
    length: f64,
    mismatch: f64,
}

fn seam(charts: &Charts, triangles: &[[u32; 3]], points: &[[f64; 3]], uv: &[[[f64; 2]; 3]]) -> Seam {
    let (corners, uv) = (triangles.as_flattened(), uv.as_flattened());
    let (mut length, mut mismatch) = (0.0, 0.0);
    for sides in charts.seam() {
        let [a, b] = [sides[0], chart::end(sides[0])].map(|corner| points[corners[corner as usize] as usize]);
        let on_surface = distance(a, b);
        let [one, other] = sides.map(|side| {
            let [a, b] = [side, chart::end(side)].map(|corner| uv[corner as usize]);
            (a[0] - b[0]).hypot(a[1] - b[1])
        });
        length += on_surface;
        mismatch += on_surface * (one - other).abs() / (0.5 * (one + other)).max(f64::MIN_POSITIVE);
    }
    Seam { length, mismatch: if length > 0.0 { mismatch / length } else { 0.0 } }
}

#[cfg(test)]
mod tests;
