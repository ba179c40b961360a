//! How much of the sky each vertex sees: ambient occlusion, of the surface alone.
//!
//! From each of some directions the surface's vertices are drawn into a depth buffer, in parallel projection; a vertex that
//! nothing lies before is seen from there (Williams 1978, "Casting curved shadows on curved surfaces", with the sky in the
//! place of a lamp). A direction counts by its cosine to the vertex's normal, as light does. Pixels are so large that vertices alone
//! cover the surface, where they are spread over it; large triangles among small ones hide nothing.

use std::f64::consts::PI;

use crate::parallel::{self, try_each};
use crate::vector::{Vec3, add, cross, dot, length, scale, sub, unit};
use crate::watch::{Interrupted, Watch};

/// So many directions, spread evenly over the sphere.
const DIRECTIONS: usize = 16;
/// Pixels of a depth buffer for each vertex. A view shows half of the vertices on about half of its pixels, so that each has
/// some five.
const PIXELS_PER_POINT: f64 = 0.2;
/// Pixels along a depth buffer's side, at most.
const MOST_PIXELS: usize = 256;
/// By so many pixels, turned into depth, what hides a vertex must lie before it: its own triangles do not.
const BIAS: f64 = 2.5;

/// The share of the sky that each vertex sees, from 0 (hidden) to 1 (on a convex surface). What is behind other vertices is
/// hidden, whichever way these are turned. A vertex without a normal sees 1. O(F + 16 V).
///
/// ```
/// let sphere = geom::shapes::sphere(1000);
/// let seen = geom::exposure(&sphere.points, &sphere.triangles);
/// assert!(seen.iter().all(|seen| *seen > 0.9));
/// ```
///
/// # Panics
/// If a triangle names a point that is not there.
pub fn exposure(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    // Only a watch interrupts.
    exposure_watched(points, triangles, Watch::NONE).unwrap_or_default()
}

/// [`exposure`], watched.
///
/// # Errors
/// If it is stopped.
///
/// # Panics
/// If a triangle names a point that is not there.
pub fn exposure_watched(points: &[Vec3], triangles: &[[u32; 3]], watch: Watch) -> Result<Vec<f64>, Interrupted> {
    let normals = normals(points, triangles);
    let mut seen: Vec<Vec<bool>> = vec![Vec::new(); DIRECTIONS];
    watch.shared(|watch| {
        try_each(0, &mut seen, &|k, seen| {
            watch.ask(k as f64 / DIRECTIONS as f64)?;
            *seen = seen_from(direction(k), points, &normals);
            Ok(())
        })
    })?;
    let light = |v: usize| {
        let (mut all, mut light) = (0.0, 0.0);
        for (k, seen) in seen.iter().enumerate() {
            let cosine = dot(normals[v], direction(k));
            if cosine > 0.0 {
                all += cosine;
                light += if seen[v] { cosine } else { 0.0 };
            }
        }
        if all > 0.0 { light / all } else { 1.0 }
    };
    Ok(parallel::map(points.len(), light))
}

/// Whether each vertex that is turned to a direction is seen from there.
fn seen_from(direction: Vec3, points: &[Vec3], normals: &[Vec3]) -> Vec<bool> {
    let view = View::new(points, direction);
    let depth = view.draw();
    let is_seen = |(v, normal): (usize, &Vec3)| {
        let cosine = dot(*normal, direction);
        cosine > 0.0 && !view.hides(&depth, v, cosine)
    };
    normals.iter().enumerate().map(is_seen).collect()
}

/// The unit normals of vertices: the mean of their triangles', by area.
fn normals(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![[0.0; 3]; points.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| points[v as usize]);
        let normal = cross(sub(b, a), sub(c, a));
        t.iter().for_each(|&v| normals[v as usize] = add(normals[v as usize], normal));
    }
    normals.into_iter().map(|n| if length(n) > 0.0 { unit(n) } else { n }).collect()
}

/// The k-th direction: a spiral of equal areas from pole to pole.
fn direction(k: usize) -> Vec3 {
    let z = 1.0 - (2 * k + 1) as f64 / DIRECTIONS as f64;
    let turn = k as f64 * PI * (3.0 - 5.0_f64.sqrt());
    let radius = (1.0 - z * z).sqrt();
    [radius * turn.cos(), radius * turn.sin(), z]
}

/// The points seen from a direction: in pixels across and down, and in pixels towards the eye.
struct View {
    seen: Vec<Vec3>,
    /// Along the picture's side.
    pixels: usize,
}

impl View {
    fn new(points: &[Vec3], direction: Vec3) -> Self {
        let aside = if direction[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let across = unit(cross(aside, direction));
        let axes = [across, cross(direction, across), direction];
        let mut seen: Vec<Vec3> = points.iter().map(|&p| axes.map(|axis| dot(axis, p))).collect();
        let bound = |pick: fn(f64, f64) -> f64, start: f64| {
            seen.iter().fold([start; 3], |bound, p| std::array::from_fn(|k| pick(bound[k], p[k])))
        };
        let (low, high) = (bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY));
        let extent = (high[0] - low[0]).max(high[1] - low[1]).max(f64::MIN_POSITIVE);
        let pixels = ((PIXELS_PER_POINT * points.len() as f64).sqrt() as usize).clamp(2, MOST_PIXELS);
        let size = (pixels - 1) as f64 / extent;
        seen.iter_mut().for_each(|p| *p = scale(sub(*p, low), size));
        Self { seen, pixels }
    }

    /// The depth nearest to the eye, pixel by pixel.
    fn draw(&self) -> Vec<f64> {
        let mut depth = vec![f64::NEG_INFINITY; self.pixels * self.pixels];
        for p in &self.seen {
            let pixel = &mut depth[self.pixel(p)];
            *pixel = pixel.max(p[2]);
        }
        depth
    }

    fn pixel(&self, [x, y, _]: &Vec3) -> usize {
        y.round() as usize * self.pixels + x.round() as usize
    }

    /// Whether something lies before a vertex whose normal has this cosine to the direction.
    fn hides(&self, depth: &[f64], v: usize, cosine: f64) -> bool {
        let p = &self.seen[v];
        // The vertex's own plane rises by the tangent over a pixel.
        let slope = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine.max(0.1);
        depth[self.pixel(p)] > p[2] + BIAS + slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn a_convex_surface_sees_all_of_the_sky() {
        for shape in [shapes::sphere(2000), shapes::by_name("capsule", 1500).unwrap()] {
            assert!(exposure(&shape.points, &shape.triangles).iter().all(|seen| *seen > 0.9));
        }
    }

    #[test]
    fn the_inside_of_a_torus_sees_less_than_its_outside() {
        let torus = shapes::torus(1, 2000);
        let seen = exposure(&torus.points, &torus.triangles);
        let radius = |v: usize| torus.points[v][0].hypot(torus.points[v][1]);
        let [near, far] = [true, false].map(|near| {
            let mut order: Vec<usize> = (0..seen.len()).collect();
            order.sort_by(|a, b| radius(*a).total_cmp(&radius(*b)));
            let picked = if near { &order[..100] } else { &order[order.len() - 100..] };
            picked.iter().map(|&v| seen[v]).sum::<f64>() / 100.0
        });
        assert!(near < 0.8 * far, "{near} inside, {far} outside");
    }

    #[test]
    fn what_has_no_area_or_extent_is_seen() {
        assert_eq!(exposure(&[[0.0; 3]; 3], &[[0, 1, 2]]), [1.0; 3]);
        assert_eq!(exposure(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]]), [1.0; 3]);
    }
}
