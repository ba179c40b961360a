//! A part as a machine shop would make it.

use super::patch::Patches;
use super::remesh::remesh;
use super::{Shape, edge_length};
use crate::vector::{Vec3, distance, normal, step, sub};

/// About the surface's area; a little less, since the right triangles of the sides are larger than equilateral ones.
const AREA: f64 = 17.6;

/// A plate with a raised boss: flat faces, a rounded edge, a round cut, a hollow top. Faces meet in sharp edges, which
/// are edges of the mesh. A sphere by topology.
///
/// ```text
///   I ⁀ H---G----F        the plate: all of it, from z = 0 to 1
///   |       |     \       the boss: left of BG, from z = 1 to its top
///   |      (       `E--D
///   A-------B----------C
/// ```
pub fn part(vertices: usize) -> Shape {
    let length = edge_length(AREA, vertices.max(300));
    let curve = |from, to, bulge| arc(from, to, bulge, length);
    let [a, b, c, d, e] = [[0.0, 0.0], [1.1, 0.0], [3.0, 0.0], [3.0, 0.6], [2.4, 0.6]].map(on_ground);
    let [f, g, h, i] = [[1.4, 1.6], [1.1, 1.6], [0.7, 1.6], [0.0, 0.9]].map(on_ground);
    let quarter = (std::f64::consts::PI / 8.0).tan();
    let shared = [curve(g, h, 0.0), curve(h, i, quarter), curve(i, a, 0.0), curve(a, b, 0.0)].concat();
    let right =
        [curve(b, c, 0.0), curve(c, d, 0.0), curve(d, e, 0.0), curve(e, f, -quarter), curve(f, g, 0.0)].concat();
    let wall = curve(b, g, 0.25);
    let wall_back: Vec<Vec3> = std::iter::once(g).chain(wall.iter().rev().copied()).take(wall.len()).collect();

    let plate = [shared.clone(), right.clone()].concat();
    let boss = [shared, wall].concat();
    let step = [right, wall_back].concat();

    let mut patches = Patches::default();
    patches.shape(&flat(&plate, length), true, |p| at_height(p, 0.0));
    side(&mut patches, &plate, [0.0, 1.0], length);
    patches.shape(&flat(&step, length), false, |p| at_height(p, 1.0));
    side(&mut patches, &boss, [1.0, 1.6], length);
    patches.shape(&flat(&boss, length), false, |p| at_height(p, 1.6));
    let mut part = patches.join();
    for [x, y, z] in &mut part.points {
        // The boss's top is hollow: the lowest in the middle.
        let off = *y / 0.8 - 1.0;
        *z += (*z - 1.0).max(0.0) * (0.6 * off * off - 0.3);
        [*x, *y, *z] = sub([*x, *y, *z], [1.5, 0.8, 0.75]);
    }
    part
}

fn on_ground([x, y]: [f64; 2]) -> Vec3 {
    [x, y, 0.0]
}

fn at_height([x, y, _]: Vec3, z: f64) -> Vec3 {
    [x, y, z]
}

/// Points from one to another, without the last, about a length apart, on the arc whose angle is 4 arctan `bulge`,
/// counter-clockwise; on the straight line if that is 0.
fn arc(from: Vec3, to: Vec3, bulge: f64, length: f64) -> Vec<Vec3> {
    let chord = sub(to, from);
    let angle = 4.0 * bulge.atan();
    let along = distance(from, to) * if bulge == 0.0 { 1.0 } else { 0.5 * angle / (0.5 * angle).sin() };
    let count = (along / length).round().max(1.0) as usize;
    let point = |k: usize| {
        let t = k as f64 / count as f64;
        if bulge == 0.0 || k == 0 {
            return step(from, t, chord);
        }
        // The chord to the point spans the angle t · angle, and its direction turns by half of what is left.
        let (sin, cos) = (0.5 * (t - 1.0) * angle).sin_cos();
        let turned = [cos * chord[0] - sin * chord[1], sin * chord[0] + cos * chord[1], 0.0];
        step(from, (0.5 * t * angle).sin() / (0.5 * angle).sin(), turned)
    };
    (0..count).map(point).collect()
}

/// The upright face over an outline between two heights.
fn side(patches: &mut Patches, outline: &[Vec3], [low, high]: [f64; 2], length: f64) {
    let rows = ((high - low) / length).round().max(1.0) as usize;
    patches.grid(outline.len(), rows, |i, j| {
        let t = j as f64 / rows as f64;
        at_height(outline[i % outline.len()], low * (1.0 - t) + high * t)
    });
}

/// The inside of an outline that runs counter-clockwise, in triangles.
fn flat(outline: &[Vec3], length: f64) -> Shape {
    remesh(Shape { points: outline.to_vec(), triangles: clip_ears(outline) }, length, |p| p)
}

/// Cuts corners off an outline until it is used up.
fn clip_ears(outline: &[Vec3]) -> Vec<[u32; 3]> {
    let turn = |corners: [u32; 3]| normal(corners.map(|v| outline[v as usize]))[2];
    let is_within =
        |[a, b, c]: [u32; 3], v: u32| turn([a, b, v]) >= 0.0 && turn([b, c, v]) >= 0.0 && turn([c, a, v]) >= 0.0;
    let mut left: Vec<u32> = (0..outline.len() as u32).collect();
    let mut triangles = Vec::new();
    let (mut at, mut tried) = (0, 0);
    while left.len() > 2 && tried <= left.len() {
        let n = left.len();
        at %= n;
        let ear = [left[(at + n - 1) % n], left[at], left[(at + 1) % n]];
        if turn(ear) > 1e-12 && left.iter().all(|&v| ear.contains(&v) || !is_within(ear, v)) {
            triangles.push(ear);
            left.remove(at);
            tried = 0;
        } else {
            tried += 1;
        }
        at += 1;
    }
    triangles
}
