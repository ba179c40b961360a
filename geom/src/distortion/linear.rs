//! The linear map of one triangle.

use crate::parallel;
use crate::vector::{cross, dot, length, norm, sub};

/// A triangle of the surface is degenerate below this share of the mean area.
const LEAST_AREA: f64 = 1e-12;
/// Its image is degenerate below this ratio of the singular values.
const LEAST_RATIO: f64 = 1e-9;

/// A triangle's image in the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Image {
    pub(super) surface_area: f64,
    /// Whether the area on the surface is more than rounding.
    pub(super) has_surface: bool,
    /// In the plane; negative if it is turned against the greater part of its island.
    pub(super) area: f64,
    /// Whether the greater part of its island is turned clockwise.
    pub(super) is_mirrored: bool,
    /// σ₁/σ₂.
    pub(super) quasi_conformal: f64,
    /// Whether it has nearly no width.
    pub(super) is_collapsed: bool,
}

impl Image {
    fn new([p0, p1, p2]: [[f64; 3]; 3], [q0, q1, q2]: [[f64; 2]; 3]) -> Self {
        let (e1, e2) = (sub(p1, p0), sub(p2, p0));
        let (d1, d2) = ([q1[0] - q0[0], q1[1] - q0[1]], [q2[0] - q0[0], q2[1] - q0[1]]);
        let (base, twice_area) = (length(e1), length(cross(e1, e2)));
        // In the frame of the first side the corners are (0, 0), (base, 0) and (x, height).
        let (x, height) = (dot(e1, e2) / base, twice_area / base);
        let right = d1.map(|d| d / base);
        let up = [0, 1].map(|k| (d2[k] - right[k] * x) / height);
        // A linear map is a similarity plus one that is turned over; their scales are the half sum and difference of σ.
        let similar = 0.5 * norm([right[0] + up[1], right[1] - up[0]]);
        let mirrored = 0.5 * norm([right[0] - up[1], right[1] + up[0]]);
        let (larger, smaller) = (similar + mirrored, (similar - mirrored).abs());
        Self {
            surface_area: 0.5 * twice_area,
            has_surface: false,
            area: 0.5 * (d1[0] * d2[1] - d1[1] * d2[0]),
            is_mirrored: false,
            quasi_conformal: larger / smaller,
            is_collapsed: smaller <= LEAST_RATIO * larger,
        }
    }
}

pub(super) fn images(points: &[[f64; 3]], triangles: &[[u32; 3]], uv: &[[[f64; 2]; 3]]) -> Vec<Image> {
    let mut images = parallel::map(triangles.len(), |f| Image::new(triangles[f].map(|v| points[v as usize]), uv[f]));
    let mean = images.iter().map(|image| image.surface_area).sum::<f64>() / images.len() as f64;
    for image in &mut images {
        image.has_surface = image.surface_area > LEAST_AREA * mean;
        if !image.has_surface {
            image.surface_area = 0.0;
        }
    }
    images
}

/// The angle at `a` between the directions to `b` and `c`.
pub(super) fn angle(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let (x, y) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    (x[0] * y[1] - x[1] * y[0]).abs().atan2(x[0] * y[0] + x[1] * y[1])
}
