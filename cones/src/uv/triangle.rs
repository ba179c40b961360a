//! Two triangles in the plane: whether their interiors meet, how deep, and in how much area.
//!
//! Two convex polygons are disjoint iff a line through a side of one separates them: so two triangles that are turned
//! counter-clockwise have disjoint interiors iff some side of either has the other's three corners on its right or on it. At
//! most 18 signs of the orientation determinant decide, each exact (`robust`, after J. R. Shewchuk, *Adaptive precision
//! floating-point arithmetic and fast robust geometric predicates*, 1997); nothing is constructed. Neighbours need no
//! exception: the side that they share separates them if its ends have the same coordinates in both.
//!
//! The *depth* of an overlap is the least over the six sides of how far the other triangle reaches across the side, at most as far as
//! the triangle itself does: no more than the way one must be moved to leave the other, and no more than the height of either. A
//! triangle that is as thin as rounding overlaps nothing deeper.

use robust::{Coord, orient2d};

/// The positions of a triangle's corners.
pub type Triangle = [[f64; 2]; 3];

/// A positive number where c lies to the left of the way from a to b, negative on the right, 0 on the line. The sign is exact.
fn orientation([a, b, c]: Triangle) -> f64 {
    let [a, b, c] = [a, b, c].map(|[x, y]| Coord { x, y });
    orient2d(a, b, c)
}

/// The triangle turned counter-clockwise; none if it has no area or a coordinate is not finite.
pub(super) fn upright(triangle: Triangle) -> Option<Triangle> {
    if triangle.as_flattened().iter().any(|x| !x.is_finite()) {
        return None;
    }
    let [a, b, c] = triangle;
    match orientation(triangle) {
        area if area > 0.0 => Some(triangle),
        area if area < 0.0 => Some([a, c, b]),
        _ => None,
    }
}

/// Twice the area, positive if counter-clockwise.
pub(super) fn twice_area([a, b, c]: Triangle) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The area, whichever way round it is; none if it has none.
pub(crate) fn area(triangle: Triangle) -> Option<f64> {
    upright(triangle).map(|corners| 0.5 * twice_area(corners))
}

/// How deep two upright triangles overlap; none if their interiors are disjoint.
pub(super) fn depth(one: &Triangle, other: &Triangle) -> Option<f64> {
    // Most that are asked about do not overlap.
    let (of_other, of_one) = (reach(one, other)?, reach(other, one)?);
    Some(depth_inside(one, of_other).min(depth_inside(other, of_one)))
}

/// How far another triangle reaches inside across each side of one, as twice the area of its farthest corner with the side; none if a side
/// separates them.
fn reach(one: &Triangle, other: &Triangle) -> Option<[f64; 3]> {
    let mut reach = [0.0; 3];
    for (k, reach) in reach.iter_mut().enumerate() {
        let side = [one[k], one[(k + 1) % 3]];
        *reach = other.iter().map(|&corner| orientation([side[0], side[1], corner])).fold(0.0, f64::max);
        if *reach <= 0.0 {
            return None;
        }
    }
    Some(reach)
}

/// The least over the sides of a triangle of how far another reaches inside, at most the triangle's height.
fn depth_inside(triangle: &Triangle, reach: [f64; 3]) -> f64 {
    let across = orientation(*triangle);
    let inside = |k: usize| {
        let (p, q) = (triangle[k], triangle[(k + 1) % 3]);
        reach[k].min(across) / ((q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2)).sqrt()
    };
    (0..3).map(inside).fold(f64::INFINITY, f64::min)
}

/// The area that two upright triangles have in common, up to rounding: one is clipped by the sides of the other (Sutherland
/// and Hodgman 1974).
pub(super) fn common_area(one: &Triangle, other: &Triangle) -> f64 {
    let mut polygon = [[0.0; 2]; 9];
    polygon[..3].copy_from_slice(other);
    let mut count = 3;
    for k in 0..3 {
        let (p, q) = (one[k], one[(k + 1) % 3]);
        let inside = |corner: [f64; 2]| twice_area([p, q, corner]);
        let mut clipped = [[0.0; 2]; 9];
        let mut kept = 0;
        let mut keep = |corner| {
            // A triangle clipped by three lines has six corners at most; rounding may double some.
            if kept < clipped.len() {
                clipped[kept] = corner;
                kept += 1;
            }
        };
        for i in 0..count {
            let (from, to) = (polygon[i], polygon[(i + 1) % count]);
            let (here, there) = (inside(from), inside(to));
            if here >= 0.0 {
                keep(from);
            }
            if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
                let t = here / (here - there);
                keep([0, 1].map(|i| from[i] + t * (to[i] - from[i])));
            }
        }
        (polygon, count) = (clipped, kept);
    }
    let fan = (2..count).map(|i| twice_area([polygon[0], polygon[i - 1], polygon[i]]));
    0.5 * fan.sum::<f64>().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Lattice = [[i128; 2]; 3];

    fn sign(a: [i128; 2], b: [i128; 2], c: [i128; 2]) -> i128 {
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).signum()
    }

    /// Whether the interiors meet, found another way and exactly: a corner inside the other, or sides that cross, or both
    /// have the same side of a common line. Clipped polygons in rational coordinates, as numerators over one denominator.
    fn meet(one: Lattice, other: Lattice) -> bool {
        // The common part of two convex polygons has an interior iff clipping leaves a polygon with area. Homogeneous
        // coordinates keep it in integers.
        let mut polygon: Vec<[i128; 3]> = other.iter().map(|p| [p[0], p[1], 1]).collect();
        for k in 0..3 {
            let (p, q) = (one[k], one[(k + 1) % 3]);
            let line = [p[1] - q[1], q[0] - p[0], p[0] * q[1] - p[1] * q[0]];
            let side = |c: &[i128; 3]| line[0] * c[0] + line[1] * c[1] + line[2] * c[2];
            let mut clipped = Vec::new();
            for i in 0..polygon.len() {
                let (from, to) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                let (here, there) = (side(&from), side(&to));
                if here >= 0 {
                    clipped.push(from);
                }
                if here.signum() * there.signum() < 0 {
                    let (s, t) = (here.abs(), there.abs());
                    // from / w₁ and to / w₂ in the ratio of their distances.
                    let (w1, w2) = (from[2], to[2]);
                    let (s, t) = (s * w2, t * w1);
                    let at = [0, 1].map(|i| from[i] * w2 * t + to[i] * w1 * s);
                    clipped.push(reduced([at[0], at[1], w1 * w2 * (s + t)]));
                }
            }
            polygon = clipped;
        }
        let cross = |a: [i128; 3], b: [i128; 3], c: [i128; 3]| {
            let [x, y] = [0, 1].map(|i| b[i] * a[2] - a[i] * b[2]);
            let [z, w] = [0, 1].map(|i| c[i] * a[2] - a[i] * c[2]);
            x * w - y * z
        };
        (2..polygon.len()).any(|i| cross(polygon[0], polygon[i - 1], polygon[i]) > 0)
    }

    fn reduced(p: [i128; 3]) -> [i128; 3] {
        fn divisor(a: i128, b: i128) -> i128 {
            if b == 0 { a.abs() } else { divisor(b, a % b) }
        }
        let d = divisor(divisor(p[0], p[1]), p[2]).max(1);
        p.map(|x| x / d)
    }

    fn lattice(side: i128) -> impl Strategy<Value = Lattice> {
        prop::array::uniform3(prop::array::uniform2(0..side))
    }

    fn real(t: Lattice, scale: f64) -> Triangle {
        t.map(|p| p.map(|x| x as f64 * scale))
    }

    fn turned(t: Lattice) -> Option<Lattice> {
        match sign(t[0], t[1], t[2]) {
            1 => Some(t),
            -1 => Some([t[0], t[2], t[1]]),
            _ => None,
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]
        #[test]
        fn interiors_meet_where_exact_clipping_leaves_something(one in lattice(6), other in lattice(6), wide in lattice(900)) {
            for (a, b) in [(one, other), (one, wide)] {
                // Multiples of an odd number are not on the lattice of powers of two any more, but signs stay.
                let [x, y] = [a, b].map(|t| upright(real(t, 3.0)));
                prop_assert_eq!([x.is_some(), y.is_some()], [a, b].map(|t| turned(t).is_some()));
                let (Some(x), Some(y), Some(a), Some(b)) = (x, y, turned(a), turned(b)) else { continue };
                prop_assert_eq!(depth(&x, &y).is_some(), meet(a, b), "{:?} {:?}", a, b);
                prop_assert_eq!(depth(&x, &y), depth(&y, &x));
                prop_assert_eq!(common_area(&x, &y) > 1e-9, meet(a, b));
            }
        }

        #[test]
        fn moved_by_less_than_the_depth_none_leaves_the_other(
            one in lattice(9),
            other in lattice(9),
            angle in 0.0..6.3f64,
        ) {
            let (Some(x), Some(y)) = (upright(real(one, 1.0)), upright(real(other, 1.0))) else { return Ok(()) };
            let Some(deep) = depth(&x, &y) else { return Ok(()) };
            let far = 0.99 * deep;
            prop_assert!(depth(&x, &y.map(|[u, v]| [u + far * angle.cos(), v + far * angle.sin()])).is_some());
            for triangle in [x, y] {
                let height = |k: usize| {
                    let (p, q) = (triangle[k], triangle[(k + 1) % 3]);
                    twice_area(triangle) / (q[0] - p[0]).hypot(q[1] - p[1])
                };
                prop_assert!((0..3).all(|k| deep <= height(k) * (1.0 + 1e-12)));
            }
        }
    }

    #[test]
    fn the_area_in_common_is_that_of_the_common_part() {
        let [unit, half] = [1.0, 0.5].map(|s| [[0.0, 0.0], [s, 0.0], [0.0, s]]);
        assert_eq!(common_area(&unit, &unit), 0.5);
        assert_eq!(common_area(&unit, &half), 0.125);
        let star = [[1.0, 1.0], [0.0, 0.5], [0.5, 0.0]];
        assert!((common_area(&unit, &star) - (0.375 - 1.0 / 6.0)).abs() < 1e-15);
    }

    #[test]
    fn what_has_no_area_or_no_place_is_no_triangle() {
        assert_eq!(upright([[0.0, 0.0], [0.1, 0.1], [0.3, 0.3]]), None);
        assert_eq!(upright([[0.0, 0.0], [1.0, 0.0], [0.0, f64::NAN]]), None);
        assert_eq!(upright([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]), Some([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]));
    }
}
