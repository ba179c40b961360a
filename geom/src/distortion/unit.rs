//! How large a map is.

use crate::vector::{length, normal};

/// The length on the surface of a unit of the map: the root of the ratio of their areas, whatever way triangles are turned. It is no number, or
/// infinite, where the map has no area.
///
/// ```
/// let points = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
/// let uv = [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]];
/// assert_eq!(geom::distortion::unit_on_surface(&points, &[[0, 1, 2]], &uv), 3.0);
/// ```
///
/// # Panics
/// If a triangle names a vertex that has no point.
pub fn unit_on_surface(points: &[[f64; 3]], triangles: &[[u32; 3]], uv: &[[[f64; 2]; 3]]) -> f64 {
    let area = |corners: [[f64; 3]; 3]| length(normal(corners));
    let on_surface: f64 = triangles.iter().map(|t| area(t.map(|v| points[v as usize]))).sum();
    let in_plane: f64 = uv.iter().map(|t| area(t.map(|[x, y]| [x, y, 0.0]))).sum();
    (on_surface / in_plane).sqrt()
}
