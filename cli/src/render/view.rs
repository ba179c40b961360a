//! From where a model is looked at: from above, at a corner of its box.

use super::camera::Camera;
use super::scene::{Scene, face_normal};
use geom::vector::{Vec3, dot, step, unit};
use std::collections::BTreeMap;

/// Degrees to the right of the front, in order of preference.
const TURNS: [f64; 4] = [32.0, -32.0, -148.0, 148.0];
/// The height above the horizon for each length away.
const RISE: f64 = 0.42;
/// A cone is seen where the surface is turned to the eye by more than this cosine.
const SEEN: f64 = 0.15;

/// The camera at the corner from which most cones are seen: limbs and faces have many.
pub(crate) fn camera(scene: &Scene, width: usize, height: usize) -> Camera {
    let used: Vec<Vec3> = scene.triangles.iter().flatten().map(|&v| scene.points[v as usize]).collect();
    let (up, front, side) = axes(&used);
    let from = |turn: f64| {
        let (sin, cos) = turn.to_radians().sin_cos();
        unit(step(step(front.map(|x| x * cos), sin, side), RISE, up))
    };
    let normals = cone_normals(scene);
    let seen = |from: Vec3| normals.iter().filter(|&&n| dot(unit(n), from) > SEEN).count();
    let mut best = from(TURNS[0]);
    for other in TURNS.map(from) {
        if seen(other) > seen(best) {
            best = other;
        }
    }
    Camera::framing(&used, best, up, width, height)
}

/// The surface's normals at the cones.
fn cone_normals(scene: &Scene) -> Vec<Vec3> {
    let mut normals: BTreeMap<u32, Vec3> = scene.cones.iter().map(|cone| (cone.vertex, [0.0; 3])).collect();
    for t in &scene.triangles {
        for v in t {
            if let Some(normal) = normals.get_mut(v) {
                *normal = step(*normal, 1.0, face_normal(scene, t));
            }
        }
    }
    normals.into_values().collect()
}

/// Up, front and right of a model: y is up and z in front as in most files, except in a landscape, wide in x and y.
fn axes(points: &[Vec3]) -> (Vec3, Vec3, Vec3) {
    let size = |i: usize| {
        let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[i]), h.max(p[i])));
        high - low
    };
    if size(2) < 0.5 * size(0).min(size(1)) {
        ([0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0])
    } else {
        ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    }
}
