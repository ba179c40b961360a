//! Shapes given by a formula.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::patch::Patches;
use super::{Shape, edge_length, least};
use crate::vector::{Vec3, add, length, scale};

/// The unit sphere: an icosahedron whose faces are divided evenly and whose points are moved outwards.
pub fn sphere(vertices: usize) -> Shape {
    let parts = least(vertices, |n| 10 * n * n + 2);
    let mut patches = Patches::default();
    for face in ICOSAHEDRON_FACES {
        // Summed in the order of the corners' numbers, so that both faces at an edge find the same bits.
        let point = |weights: [usize; 3]| {
            let mut terms = [0, 1, 2].map(|k| (face[k], weights[k]));
            terms.sort_unstable();
            let sum = terms.iter().fold([0.0; 3], |sum, &(v, w)| add(sum, scale(icosahedron_point(v), w as f64)));
            scale(sum, 1.0 / length(sum))
        };
        for j in 0..parts {
            for i in 0..parts - j {
                let k = parts - i - j;
                patches.triangle([[k, i, j], [k - 1, i + 1, j], [k - 1, i, j + 1]].map(point));
                if k > 1 {
                    patches.triangle([[k - 1, i + 1, j], [k - 2, i + 1, j + 1], [k - 1, i, j + 1]].map(point));
                }
            }
        }
    }
    patches.join()
}

/// Pole, upper ring, lower ring, pole.
fn icosahedron_point(v: usize) -> Vec3 {
    let ring = |k: usize, turn: f64, height: f64| {
        let (sin, cos) = (TAU * (k as f64 + turn) / 5.0).sin_cos();
        [2.0 * cos, 2.0 * sin, height]
    };
    match v {
        0 => [0.0, 0.0, 5f64.sqrt()],
        11 => [0.0, 0.0, -5f64.sqrt()],
        1..=5 => ring(v - 1, 0.0, 1.0),
        _ => ring(v - 6, 0.5, -1.0),
    }
}

const ICOSAHEDRON_FACES: [[usize; 3]; 20] = {
    let mut faces = [[0; 3]; 20];
    let mut k = 0;
    while k < 5 {
        let next = (k + 1) % 5;
        faces[4 * k] = [0, 1 + k, 1 + next];
        faces[4 * k + 1] = [1 + k, 6 + k, 1 + next];
        faces[4 * k + 2] = [6 + k, 6 + next, 1 + next];
        faces[4 * k + 3] = [11, 6 + next, 6 + k];
        k += 1;
    }
    faces
};

/// The unit disk in the plane.
pub fn disk(vertices: usize) -> Shape {
    let rings = least(vertices, |n| 1 + 3 * n * (n + 1));
    let mut patches = Patches::default();
    patches.rings(6, rings, |k, j| on_ring(6, k, j, k as f64 / rings as f64, 0.0));
    patches.join()
}

/// The j-th of `sectors` · k points round the z axis.
fn on_ring(sectors: usize, k: usize, j: usize, radius: f64, height: f64) -> Vec3 {
    let (sin, cos) = (TAU * (j as f64 / (sectors * k.max(1)) as f64)).sin_cos();
    [radius * cos, radius * sin, height]
}

/// The square [-1, 1]² in the plane.
pub fn square(vertices: usize) -> Shape {
    lifted_square(square_side(vertices), |_, _| 0.0)
}

/// How many edges a square with so many vertices has along its side.
pub(super) fn square_side(vertices: usize) -> usize {
    least(vertices, |n| (n + 1) * (n + 1))
}

/// The square [-1, 1]² lifted to a height.
pub(super) fn lifted_square(side: usize, height: impl Fn(f64, f64) -> f64) -> Shape {
    let coordinate = |i: usize| 2.0 * i as f64 / side as f64 - 1.0;
    let mut patches = Patches::default();
    patches.grid(side, side, |i, j| [coordinate(i), coordinate(j), height(coordinate(i), coordinate(j))]);
    patches.join()
}

/// A pyramid without its base, of 3, 4 or 5 equilateral sides (6: a flat hexagon; other numbers are brought into this
/// range), its slanted edges of length 1. It is flat but for the apex, vertex 0, whose curvature is 2π - `sides` · π/3:
/// what develops it must not distort it at all.
pub fn cone(sides: u8, vertices: usize) -> Shape {
    let sides = usize::from(sides.clamp(3, 6));
    let radius = 0.5 / (PI / sides as f64).sin();
    let drop = (1.0 - radius * radius).max(0.0).sqrt();
    polyhedral_cone(sides, vertices, |_| drop, radius)
}

/// Eight equilateral triangles round a vertex, vertex 0, in waves: flat but for that vertex, whose curvature is -2π/3.
pub fn saddle_cone(vertices: usize) -> Shape {
    // Rays of length 1 that end at the heights ±h are 1 apart if (1 - h²) c + 4h² = 1.
    let c = 2.0 - 2.0 * (TAU / 8.0).cos();
    let height = ((1.0 - c) / (4.0 - c)).sqrt();
    let wave = |sector: usize| if sector.is_multiple_of(2) { height } else { -height };
    polyhedral_cone(8, vertices, wave, (1.0 - height * height).sqrt())
}

/// Flat triangles between rays from the origin, which end in a radius at `drop(ray)` below it.
fn polyhedral_cone(sides: usize, vertices: usize, drop: impl Fn(usize) -> f64, radius: f64) -> Shape {
    let rings = least(vertices, |n| 1 + sides * n * (n + 1) / 2);
    let end = |ray: usize| on_ring(sides, 1, ray % sides, radius, -drop(ray % sides));
    let mut patches = Patches::default();
    patches.rings(sides, rings, |k, j| {
        let (ray, along) = (j / k.max(1), j % k.max(1));
        let sum = add(scale(end(ray), (k - along) as f64), scale(end(ray + 1), along as f64));
        scale(sum, 1.0 / rings as f64)
    });
    patches.join()
}

/// A prism without its ends, nearly a cylinder of radius 1 and height 2: its faces are flat, and it develops exactly.
pub fn cylinder(vertices: usize) -> Shape {
    let side = |n: usize| (4 * n).div_ceil(13).max(1);
    let around = least(vertices, |n| n * (side(n) + 1)).max(3);
    let mut patches = Patches::default();
    patches.grid(around, side(around), |i, j| {
        on_ring(around, 1, i % around, 1.0, 2.0 * j as f64 / side(around) as f64 - 1.0)
    });
    patches.join()
}

/// A cylinder of radius ½ and length 1 along z with half spheres on its ends.
pub fn capsule(vertices: usize) -> Shape {
    const SECTORS: usize = 5;
    const RADIUS: f64 = 0.5;
    // Rows as far apart as they are in triangles that are equilateral; evenly many, as every other one is shifted.
    let rows = |rings: usize| 2 * (SECTORS * rings).div_ceil(6).max(1);
    let rings = least(vertices, |n| SECTORS * n * (n + rows(n)) + 2);
    let cap = |k: usize, j: usize| {
        let (sin, cos) = (FRAC_PI_2 * k as f64 / rings as f64).sin_cos();
        // On the equator exactly the cylinder's end.
        let height = if k == rings { 0.5 } else { 0.5 + RADIUS * cos };
        on_ring(SECTORS, k, j, RADIUS * sin, height)
    };
    let mut upper = Patches::default();
    upper.rings(SECTORS, rings, cap);
    let upper = upper.join();
    let mut patches = Patches::default();
    patches.shape(&upper, false, |p| p);
    patches.band(SECTORS * rings, rows(rings), |t, j| {
        let (sin, cos) = (TAU * t).sin_cos();
        [RADIUS * cos, RADIUS * sin, j as f64 / rows(rings) as f64 - 0.5]
    });
    patches.shape(&upper, true, |[x, y, z]| [x, y, -z]);
    patches.join()
}

/// A torus of revolution about z, with the radii 1 and [`TUBE`].
pub(super) fn ring_torus(vertices: usize) -> Shape {
    let length = edge_length(4.0 * PI * PI * TUBE, vertices.max(40));
    let around = ((TAU / length).round() as usize).max(6);
    let rows = 2 * ((TAU * TUBE / (3f64.sqrt() * length)).round() as usize).max(2);
    let mut patches = Patches::default();
    patches.band(around, rows, |t, j| {
        let (sin, cos) = (TAU * t).sin_cos();
        let (up, out) = (TAU * (j % rows) as f64 / rows as f64).sin_cos();
        [(1.0 + TUBE * out) * cos, (1.0 + TUBE * out) * sin, TUBE * up]
    });
    patches.join()
}

/// The radius of a torus's tube; that of its middle circle is 1.
pub(super) const TUBE: f64 = 0.4;
