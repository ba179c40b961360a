//! Gaussian and mean curvature at the vertices of any set of triangles, manifold or not.
//!
//! With A a third of the area of the triangles at v:
//!
//! - Gaussian, K = (2π − Σ angles at v) / A, and π in the place of 2π where an edge at v has one triangle only.
//! - mean, H = ¼ Σ l·θ / A over the edges at v, l an edge's length and θ the angle between the normals of the two
//!   triangles, positive where the edge is convex seen from outside (Cohen-Steiner & Morvan 2003, "Restricted Delaunay
//!   triangulations and normal cycle"; half of an edge's ½ l·θ goes to each end). Edges with one triangle, or more than two, or
//!   triangles that run the same way along them, add nothing.
//!
//! Units are those of the file: 1 / length², 1 / length. A vertex without area has no curvature: NaN.

use std::f64::consts::PI;

type Point = [f64; 3];
type Triangle = [u32; 3];

/// The Gaussian curvature of each vertex.
pub(super) fn gaussian(points: &[Point], triangles: &[Triangle]) -> Vec<f64> {
    let mut flat = vec![2.0 * PI; points.len()];
    for edge in edges(triangles).chunk_by(|a, b| a.ends == b.ends).filter(|sides| sides.len() == 1) {
        edge[0].ends.iter().for_each(|&v| flat[v as usize] = PI);
    }
    for t in triangles {
        for k in 0..3 {
            flat[t[k] as usize] -= angle(corner(points, t, k));
        }
    }
    over_areas(flat, points, triangles)
}

/// The mean curvature of each vertex.
pub(super) fn mean(points: &[Point], triangles: &[Triangle]) -> Vec<f64> {
    let mut integral = vec![0.0; points.len()];
    for edge in edges(triangles).chunk_by(|a, b| a.ends == b.ends) {
        let [left, right] = edge else { continue };
        if left.is_forward == right.is_forward {
            continue;
        }
        let [a, b] = left.ends.map(|v| points[v as usize]);
        let along = minus(b, a);
        let bend = bend(points, triangles, if left.is_forward { [left, right] } else { [right, left] }, along);
        for v in left.ends {
            integral[v as usize] += 0.25 * length(along) * bend;
        }
    }
    over_areas(integral, points, triangles)
}

/// The angle from the normal of the triangle that runs along an edge to the normal of the one that runs back.
fn bend(points: &[Point], triangles: &[Triangle], [forward, back]: [&Side; 2], along: Point) -> f64 {
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

fn over_areas(mut integral: Vec<f64>, points: &[Point], triangles: &[Triangle]) -> Vec<f64> {
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
fn edges(triangles: &[Triangle]) -> Vec<Side> {
    let side = |triangle: u32, a: u32, b: u32| Side { ends: [a.min(b), a.max(b)], triangle, is_forward: a < b };
    let of = |(i, &[a, b, c]): (u32, &Triangle)| [side(i, a, b), side(i, b, c), side(i, c, a)];
    let mut sides: Vec<Side> = (0..).zip(triangles).flat_map(of).collect();
    sides.sort_unstable();
    sides
}

/// The two sides that leave a corner of a triangle.
fn corner(points: &[Point], t: &Triangle, k: usize) -> [Point; 2] {
    let [a, b, c] = [0, 1, 2].map(|i| points[t[(k + i) % 3] as usize]);
    [minus(b, a), minus(c, a)]
}

fn angle([p, q]: [Point; 2]) -> f64 {
    length(cross(p, q)).atan2(dot(p, q))
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A built-in shape with its points scaled.
    fn shape(name: &str, scale: f64) -> (Vec<Point>, Vec<Triangle>) {
        let model = geom::Model::from(geom::shapes::by_name(name, 4000).expect("it is built in"));
        let triangles = model.triangles().vertices(&model);
        (model.points().iter().map(|p| p.map(|x| scale * x)).collect(), triangles)
    }

    fn total(values: &[f64], points: &[Point], triangles: &[Triangle]) -> f64 {
        let ones = over_areas(vec![1.0; points.len()], points, triangles);
        values.iter().zip(ones).map(|(value, inverse_area)| value / inverse_area).sum()
    }

    #[test]
    fn gaussian_curvature_sums_to_two_pi_times_the_euler_characteristic() {
        for (name, euler) in [("sphere", 2.0), ("torus-1", 0.0), ("torus-3", -4.0)] {
            let (points, triangles) = shape(name, 3.0);
            let sum = total(&gaussian(&points, &triangles), &points, &triangles);
            assert!((sum - 2.0 * PI * euler).abs() < 1e-8, "{name}: {sum}");
        }
    }

    #[test]
    fn a_sphere_has_the_curvatures_of_its_radius() {
        let (points, triangles) = shape("sphere", 1.0);
        let radius = length(points[0]);
        let area: f64 = 4.0 * PI * radius * radius;
        let sum = total(&mean(&points, &triangles), &points, &triangles);
        assert!(
            (sum * radius / area - 1.0).abs() < 0.01,
            "mean curvature {} of a sphere of radius {radius}",
            sum / area
        );
        let inside: Vec<Triangle> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let turned = total(&mean(&points, &inside), &points, &inside);
        assert!((turned + sum).abs() < 1e-9 * sum, "seen from inside it is hollow");
    }

    #[test]
    fn what_has_no_area_has_no_curvature() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [9.0; 3]];
        assert!(gaussian(&points, &[[0, 1, 2]]).iter().all(|k| k.is_nan()));
        assert!(mean(&points, &[[0, 1, 2]]).iter().all(|h| h.is_nan()));
    }
}
