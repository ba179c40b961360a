//! Tori with any number of holes.

use super::Shape;
use super::implicit::{blend, surface};
use super::plain::{TUBE, ring_torus, sphere};
use crate::vector::Vec3;

/// How far apart the middles of neighbouring tori are: their tubes run into each other.
const SPACING: f64 = 2.2;

/// A surface of any genus: tori in a row along x that run into each other, with the z axis through their holes. Genus 1
/// is the torus of revolution with the radii 1 and 0.4, genus 0 the unit sphere. Each hole asks for 150 vertices.
pub fn torus(genus: u8, vertices: usize) -> Shape {
    match genus {
        0 => sphere(vertices),
        1 => ring_torus(vertices),
        _ => {
            let end = 0.5 * SPACING * f64::from(genus - 1);
            let margin = 1.1 + TUBE;
            let bounds = [[-end - margin, -margin, -margin], [end + margin, margin, margin]];
            surface(|p| row(end, p), bounds, 0.11, vertices.max(150 * usize::from(genus)))
        }
    }
}

/// The nearest torus of a row whose middles go from -end to end, and its neighbours.
fn row(end: f64, [x, y, z]: Vec3) -> f64 {
    let nearest = ((x.clamp(-end, end) + end) / SPACING).round() * SPACING - end;
    [nearest - SPACING, nearest, nearest + SPACING]
        .into_iter()
        .filter(|middle| middle.abs() < end + 0.5 * SPACING)
        .map(|middle| ((x - middle).hypot(y) - 1.0).hypot(z) - TUBE)
        .fold(f64::INFINITY, |union, ring| blend(union, ring, 0.3))
}
