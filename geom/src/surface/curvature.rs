//! Gaussian and mean curvature at the vertices of any set of triangles in space, manifold or not.
//!
//! With A a third of the area of the triangles at v:
//!
//! - Gaussian, K = (2π − Σ angles at v) / A, and π in the place of 2π where an edge at v has one triangle only.
//! - mean, H = ¼ Σ l·θ / A over the edges at v, l an edge's length and θ the angle between the normals of the two
//!   triangles, positive where the edge is convex seen from outside (Cohen-Steiner & Morvan 2003, "Restricted Delaunay
//!   triangulations and normal cycle"; half of an edge's ½ l·θ goes to each end). Edges with one triangle, or more than two, or
//!   triangles that run the same way along them, add nothing.
//!
//! Both are densities, in 1 / length² and 1 / length; the angle defects of a mesh ([`angle_defects`](crate::angle_defects)) are
//! integrals. A vertex without area has no curvature: NaN.

use std::f64::consts::PI;

use crate::vector::{Vec3, angle, cross, dot, length, sub};

/// The Gaussian curvature of each vertex, an angle defect over an area. O(F log F).
///
/// # Panics
/// If a triangle names a point that is not there.
pub fn gaussian_curvature(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut flat = vec![2.0 * PI; points.len()];
    for edge in edges(triangles).chunk_by(|a, b| a.ends == b.ends).filter(|sides| sides.len() == 1) {
        edge[0].ends.iter().for_each(|&v| flat[v as usize] = PI);
    }
    for t in triangles {
        for k in 0..3 {
            let [p, q] = corner(points, t, k);
            flat[t[k] as usize] -= angle(p, q);
        }
    }
    over_areas(flat, points, triangles)
}

/// The mean curvature of each vertex: positive where the surface is convex seen from the side its triangles run
/// counter-clockwise on. O(F log F).
///
/// ```
/// // A sphere of radius 1 has mean curvature 1 and Gaussian curvature 1.
/// let sphere = geom::shapes::sphere(2000);
/// let mean = geom::mean_curvature(&sphere.points, &sphere.triangles);
/// assert!(mean.iter().all(|h| (h - 1.0).abs() < 0.2));
/// ```
///
/// # Panics
/// If a triangle names a point that is not there.
pub fn mean_curvature(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut integral = vec![0.0; points.len()];
    for edge in edges(triangles).chunk_by(|a, b| a.ends == b.ends) {
        let [left, right] = edge else { continue };
        if left.is_forward == right.is_forward {
            continue;
        }
        let [a, b] = left.ends.map(|v| points[v as usize]);
        let along = sub(b, a);
        let bend = bend(points, triangles, if left.is_forward { [left, right] } else { [right, left] }, along);
        for v in left.ends {
            integral[v as usize] += 0.25 * length(along) * bend;
        }
    }
    over_areas(integral, points, triangles)
}

/// The angle from the normal of the triangle that runs along an edge to the normal of the one that runs back.
fn bend(points: &[Vec3], triangles: &[[u32; 3]], [forward, back]: [&Side; 2], along: Vec3) -> f64 {
    let normal = |side: &Side| {
        let [p, q] = corner(points, &triangles[side.triangle as usize], 0);
        cross(p, q)
    };
    let (n, m) = (normal(forward), normal(back));
    // With the first triangle to the left of the edge, normals turn about it to the right-handed side where it is convex.
    let sine = dot(cross(n, m), along) / length(along);
    let cosine = dot(n, m);
    if sine == 0.0 && cosine == 0.0 { 0.0 } else { sine.atan2(cosine) }
}

fn over_areas(mut integral: Vec<f64>, points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for t in triangles {
        let [p, q] = corner(points, t, 0);
        t.iter().for_each(|&v| areas[v as usize] += length(cross(p, q)) / 6.0);
    }
    for (value, area) in integral.iter_mut().zip(areas) {
        *value /= area;
        if !value.is_finite() {
            *value = f64::NAN;
        }
    }
    integral
}

/// A side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// The lower vertex first.
    ends: [u32; 2],
    triangle: u32,
    /// Whether the triangle runs from the lower vertex to the higher.
    is_forward: bool,
}

/// All sides, those of one edge together.
fn edges(triangles: &[[u32; 3]]) -> Vec<Side> {
    let side = |triangle: u32, a: u32, b: u32| Side { ends: [a.min(b), a.max(b)], triangle, is_forward: a < b };
    let of = |(i, &[a, b, c]): (u32, &[u32; 3])| [side(i, a, b), side(i, b, c), side(i, c, a)];
    let mut sides: Vec<Side> = (0..).zip(triangles).flat_map(of).collect();
    sides.sort_unstable();
    sides
}

/// The two sides that leave a corner of a triangle.
fn corner(points: &[Vec3], t: &[u32; 3], k: usize) -> [Vec3; 2] {
    let [a, b, c] = [0, 1, 2].map(|i| points[t[(k + i) % 3] as usize]);
    [sub(b, a), sub(c, a)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    /// A built-in shape with its points scaled.
    fn shape(name: &str, scale: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let shape = shapes::by_name(name, 4000).unwrap();
        (shape.points.iter().map(|p| p.map(|x| scale * x)).collect(), shape.triangles)
    }

    fn total(values: &[f64], points: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
        let ones = over_areas(vec![1.0; points.len()], points, triangles);
        values.iter().zip(ones).map(|(value, inverse_area)| value / inverse_area).sum()
    }

    #[test]
    fn gaussian_curvature_sums_to_two_pi_times_the_euler_characteristic() {
        for (name, euler) in [("sphere", 2.0), ("torus-1", 0.0), ("torus-3", -4.0), ("terrain", 1.0)] {
            let (points, triangles) = shape(name, 3.0);
            let sum = total(&gaussian_curvature(&points, &triangles), &points, &triangles);
            assert!((sum - 2.0 * PI * euler).abs() < 1e-8, "{name}: {sum}");
        }
    }

    #[test]
    fn a_sphere_has_the_curvatures_of_its_radius() {
        for radius in [1.0, 4.0] {
            let (points, triangles) = shape("sphere", radius);
            assert!((length(points[0]) / radius - 1.0).abs() < 1e-9);
            let mean = mean_curvature(&points, &triangles);
            let area: f64 = 4.0 * PI * radius * radius;
            let sum = total(&mean, &points, &triangles);
            assert!((sum * radius / area - 1.0).abs() < 0.01, "mean curvature {} of radius {radius}", sum / area);
            let gaussian = gaussian_curvature(&points, &triangles);
            assert!(gaussian.iter().all(|k| (k * radius * radius - 1.0).abs() < 0.5));
            let inside: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
            let turned = total(&mean_curvature(&points, &inside), &points, &inside);
            assert!((turned + sum).abs() < 1e-9 * sum, "seen from inside it is hollow");
        }
    }

    #[test]
    fn an_edge_bends_by_the_angle_of_its_triangles_if_they_agree() {
        // Two right triangles with a right angle between them, convex seen from outside; a third of their area at each end.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
        let mean = mean_curvature(&points, &[[0, 1, 2], [1, 0, 3]]);
        let expected = 0.25 * (PI / 2.0) / (1.0 / 3.0);
        assert!((mean[0].abs() - expected).abs() < 1e-15 && mean[0] == mean[1], "{mean:?}");
        assert_eq!(mean[2..4], [0.0, 0.0]);
        for others in [vec![[0, 1, 3]], vec![[1, 0, 3], [1, 0, 4]], vec![]] {
            let triangles: Vec<[u32; 3]> = [[0, 1, 2]].into_iter().chain(others).collect();
            assert_eq!(mean_curvature(&points, &triangles)[..2], [0.0, 0.0]);
        }
    }

    #[test]
    fn what_has_no_area_has_no_curvature() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [9.0; 3]];
        assert!(gaussian_curvature(&points, &[[0, 1, 2]]).iter().all(|k| k.is_nan()));
        assert!(mean_curvature(&points, &[[0, 1, 2]]).iter().all(|h| h.is_nan()));
    }

    #[test]
    fn an_edge_of_three_triangles_is_no_boundary() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 2, 1]];
        let sum = total(&gaussian_curvature(&points, &triangles), &points, &triangles);
        assert!((sum - (4.0 * 2.0 * PI - 5.0 * PI)).abs() < 1e-13);
    }
}
