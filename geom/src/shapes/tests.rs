use std::f64::consts::PI;

use super::*;
use crate::vector::{cross, distance, dot, sub};
use crate::{Id, VertexData, VertexId};

/// The built-in shapes and a few more, with the Euler characteristic and the number of boundary loops that they have.
fn all(vertices: usize) -> Vec<(&'static str, Shape, i64, usize)> {
    let topology = |name| match name {
        "sphere" | "capsule" | "hare" | "part" => (2, 0),
        "torus" => (0, 0),
        "torus-2" => (-2, 0),
        "torus-9" => (-16, 0),
        "cylinder" => (0, 2),
        _ => (1, 1),
    };
    let shape = |&name: &&'static str| {
        let (euler_characteristic, loops) = topology(name);
        (name, by_name(name, vertices).unwrap(), euler_characteristic, loops)
    };
    NAMES.iter().chain(&["torus-9"]).map(shape).collect()
}

fn is_flat(name: &str) -> bool {
    ["disk", "square", "cone", "saddle-cone", "cylinder"].contains(&name)
}

/// 2π (π on the boundary) less the angles at each vertex.
fn curvature(shape: &Shape) -> VertexData<f64> {
    let mesh = shape.mesh();
    let whole = |v| if mesh.is_boundary_vertex(v) { PI } else { 2.0 * PI };
    let mut defect: VertexData<f64> = mesh.vertices().map(whole).collect();
    for &[a, b, c] in &shape.triangles {
        for corner in [[a, b, c], [b, c, a], [c, a, b]] {
            let [p, q, r] = shape.corners(corner);
            defect[VertexId(corner[0])] -= length(cross(sub(q, p), sub(r, p))).atan2(dot(sub(q, p), sub(r, p)));
        }
    }
    defect
}

/// 1 for an equilateral triangle, 0 for one without area: 4√3 area / Σ l².
fn quality(corners: [Vec3; 3]) -> f64 {
    let squares: f64 = [0, 1, 2].iter().map(|&k| distance(corners[k], corners[(k + 1) % 3]).powi(2)).sum();
    2.0 * 3f64.sqrt() * length(normal(corners)) / squares
}

#[test]
fn every_shape_is_a_connected_manifold_of_its_topology_at_any_size() {
    for vertices in [0, 50, 1000] {
        for (name, shape, euler_characteristic, loops) in all(vertices) {
            let mesh = shape.mesh();
            mesh.check();
            assert_eq!(mesh.euler_characteristic(), euler_characteristic, "{name}");
            assert_eq!(mesh.boundary_loops().len(), loops, "{name}");
            assert_eq!(mesh.components().1, 1, "{name}");
        }
    }
}

#[test]
fn shapes_have_about_as_many_vertices_as_asked_for_in_well_shaped_triangles() {
    for (name, shape, ..) in all(3000) {
        let ratio = shape.points.len() as f64 / 3000.0;
        assert!((0.85..1.2).contains(&ratio), "{name} has {} vertices", shape.points.len());
        let worst = shape.triangles.iter().map(|&t| quality(shape.corners(t))).fold(1.0, f64::min);
        assert!(worst > 0.3, "{name} has a triangle of quality {worst}");
    }
}

#[test]
fn closed_shapes_are_oriented_outwards_and_flat_ones_upwards() {
    for (name, shape, _, loops) in all(1000) {
        let along: f64 = match (name, loops) {
            (_, 0) => shape.triangles.iter().map(|&t| shape.corners(t)).map(|[a, b, c]| dot(a, cross(b, c))).sum(),
            ("cylinder", _) => {
                shape.triangles.iter().map(|&t| shape.corners(t)).map(|c| dot(normal(c), [c[0][0], c[0][1], 0.0])).sum()
            }
            _ => shape.triangles.iter().map(|&t| normal(shape.corners(t))[2]).sum(),
        };
        assert!(along > 0.0, "{name}");
    }
}

#[test]
fn areas_approach_the_formulas() {
    let formulas = [
        ("sphere", 4.0 * PI, 1e-3),
        ("capsule", 2.0 * PI, 1e-3),
        ("torus", 4.0 * PI * PI * 0.4, 1e-3),
        ("disk", PI, 1e-3),
        ("square", 4.0, 1e-12),
        ("cone", 5.0 * 3f64.sqrt() / 4.0, 1e-12),
        ("saddle-cone", 8.0 * 3f64.sqrt() / 4.0, 1e-12),
        ("cylinder", 4.0 * PI, 1e-3),
    ];
    for (name, area, tolerance) in formulas {
        let found = by_name(name, 10_000).unwrap().area();
        assert!((found / area - 1.0).abs() < tolerance, "{name}: {found}, not {area}");
    }
}

#[test]
fn curvatures_sum_to_the_euler_characteristic() {
    for (name, shape, euler_characteristic, _) in all(1000) {
        let sum: f64 = curvature(&shape).iter().sum();
        assert!((sum - 2.0 * PI * euler_characteristic as f64).abs() < 1e-9, "{name}");
    }
}

#[test]
fn flat_shapes_are_flat_but_for_the_apex() {
    for (name, shape, ..) in all(1000).into_iter().filter(|(name, ..)| is_flat(name)) {
        let mesh = shape.mesh();
        for (v, &defect) in curvature(&shape).iter_ids().filter(|&(v, _)| !mesh.is_boundary_vertex(v)) {
            let expected = match (name, v.index()) {
                ("cone", 0) => PI / 3.0,
                ("saddle-cone", 0) => -2.0 * PI / 3.0,
                _ => 0.0,
            };
            assert!((defect - expected).abs() < 1e-11, "{name}, vertex {v}: {defect}");
        }
    }
}

#[test]
fn smooth_shapes_lie_on_their_surface() {
    assert!(sphere(500).points.iter().all(|&p| (length(p) - 1.0).abs() < 1e-15));
    let to_axis = |[x, y, z]: Vec3| (x.hypot(y) - 1.0).hypot(z);
    assert!(torus(1, 500).points.iter().all(|&p| (to_axis(p) - 0.4).abs() < 1e-15));
    let to_axis = |[x, y, z]: Vec3| length([x, y, (z.abs() - 0.5).max(0.0)]);
    assert!(capsule(500).points.iter().all(|&p| (to_axis(p) - 0.5).abs() < 1e-15));
}

#[test]
fn shapes_are_a_few_units_large() {
    for (name, shape, ..) in all(1000).into_iter().filter(|(name, ..)| !name.starts_with("torus-")) {
        for axis in 0..2 {
            let coordinates = || shape.points.iter().map(|p| p[axis]);
            let extent = coordinates().fold(f64::MIN, f64::max) - coordinates().fold(f64::MAX, f64::min);
            assert!((0.9..=3.2).contains(&extent), "{name}: {extent}");
        }
    }
}

#[test]
fn the_highest_hill_is_in_the_middle_for_any_noise() {
    for seed in [0, 1, 2, 3, u64::MAX] {
        let shape = terrain(4000, seed);
        let [x, y, _] = shape.points.iter().copied().max_by(|p, q| p[2].total_cmp(&q[2])).unwrap();
        assert!(x.hypot(y) < 0.2, "({x}, {y})");
    }
}

#[test]
fn shapes_are_the_same_every_time() {
    for name in ["hare", "part", "terrain"] {
        assert_eq!(by_name(name, 1000), by_name(name, 1000));
    }
}

#[test]
fn what_is_no_shape_is_not_found() {
    for name in ["", "Sphere", "torus-", "torus-256", "torus--1", "torus-2.5"] {
        assert_eq!(by_name(name, 100), None, "{name}");
    }
}
