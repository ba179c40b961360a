//! Points and lines of one unfolded triangle or quad.

/// A point or vector in the plane.
pub(super) type Point = [f64; 2];

pub(super) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// Twice the area between two vectors: positive where the second lies to the left of the first.
pub(super) fn wedge(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The point at a share of the way from one to another.
pub(super) fn between(a: Point, b: Point, share: f64) -> Point {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
}

/// Whether a point lies to the left of a directed line.
pub(super) fn is_left(from: Point, to: Point, p: Point) -> bool {
    wedge(minus(to, from), minus(p, from)) > 0.0
}

/// Where two segments that are known to cross do so, as shares of each; the middle where rounding leaves no answer.
pub(super) fn crossing([a, b]: [Point; 2], [c, d]: [Point; 2]) -> [f64; 2] {
    let (along, across) = (minus(b, a), minus(d, c));
    let whole = wedge(along, across);
    let share = |part: f64| {
        let share = part / whole;
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 }
    };
    [share(wedge(minus(c, a), across)), share(wedge(minus(c, a), along))]
}

/// A point of a convex polygon, which runs counter-clockwise, moved straight away from sides that are nearer than `least`; where it is narrow,
/// no further than to the middle.
pub(super) fn away_from_sides(polygon: &[Point], mut p: Point, least: f64) -> Point {
    let count = polygon.len();
    // The inward normals of the sides that have any length.
    let side = |k: usize| {
        let (a, along) = (polygon[k], minus(polygon[(k + 1) % count], polygon[k]));
        let length = along[0].hypot(along[1]);
        (length > 0.0).then(|| (a, [-along[1] / length, along[0] / length]))
    };
    let sides: Vec<(Point, Point)> = (0..count).filter_map(side).collect();
    let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1];
    for &(a, normal) in &sides {
        let distance = dot(minus(p, a), normal);
        if distance >= least {
            continue;
        }
        // How far it can go until it meets another side.
        let room = sides.iter().filter_map(|&(b, other)| {
            let towards = -dot(normal, other);
            (towards > 0.0).then(|| dot(minus(p, b), other).max(0.0) / towards)
        });
        let room = room.fold(f64::INFINITY, f64::min);
        let step = (least - distance).min(0.5 * (room - distance)).max(0.0);
        if step.is_finite() {
            p = [p[0] + step * normal[0], p[1] + step * normal[1]];
        }
    }
    p
}

/// Mean value coordinates of a point in a convex polygon (Floater 2003): weights that are not negative and reproduce the
/// point. They go on where the polygon is as thin as a line.
pub(super) fn mean_value(polygon: &[Point], p: Point) -> Vec<f64> {
    let count = polygon.len();
    let spokes: Vec<(Point, f64)> =
        polygon.iter().map(|&q| minus(q, p)).map(|spoke| (spoke, spoke[0].hypot(spoke[1]))).collect();
    if let Some(at) = spokes.iter().position(|(_, length)| *length <= 0.0) {
        return (0..count).map(|k| f64::from(u8::from(k == at))).collect();
    }
    let half_tangent = |k: usize| {
        let ((a, la), (b, lb)) = (spokes[k], spokes[(k + 1) % count]);
        let dot = a[0] * b[0] + a[1] * b[1];
        // tan(α/2) = (1 - cos α)/sin α
        ((la * lb - dot) / wedge(a, b).abs().max(1e-12 * la * lb)).max(0.0)
    };
    let tangents: Vec<f64> = (0..count).map(half_tangent).collect();
    let weight = |k: usize| (tangents[(k + count - 1) % count] + tangents[k]) / spokes[k].1;
    let weights: Vec<f64> = (0..count).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    match sum.is_finite() && sum > 0.0 {
        true => weights.into_iter().map(|w| w / sum).collect(),
        false => vec![1.0 / count as f64; count],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_value_coordinates_reproduce_the_point() {
        let polygon = [[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [0.5, 1.5]];
        for p in [[0.7, 0.3], [1.9, 0.9], [0.1, 0.05]] {
            let weights = mean_value(&polygon, p);
            let sum = |c: usize| -> f64 { weights.iter().zip(polygon).map(|(w, q)| w * q[c]).sum() };
            assert!((sum(0) - p[0]).abs() < 1e-12 && (sum(1) - p[1]).abs() < 1e-12);
            assert!(weights.iter().all(|w| *w >= 0.0));
        }
    }

    #[test]
    fn a_point_near_a_side_goes_away_from_it_as_far_as_there_is_room() {
        let strip = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.01], [0.0, 0.01]];
        assert_eq!(away_from_sides(&strip, [1.0, 0.004], 0.003), [1.0, 0.004]);
        let near = |p: Point, q: Point| minus(p, q).iter().all(|d| d.abs() < 1e-12);
        assert!(near(away_from_sides(&strip, [1.0, 1e-17], 0.003), [1.0, 0.003]));
        assert!(near(away_from_sides(&strip, [1.0, 0.0], 0.1), [1.0, 0.005]), "the middle");
        assert!(near(away_from_sides(&strip, [1.0, 0.01], 0.001), [1.0, 0.009]));
        assert!(near(away_from_sides(&strip, [0.0, 0.01], 0.001), [0.001, 0.009]), "in a corner");
    }

    #[test]
    fn segments_cross_at_the_shares_of_both() {
        let [s, t] = crossing([[0.0, 0.0], [4.0, 0.0]], [[1.0, -1.0], [1.0, 3.0]]);
        assert_eq!([s, t], [0.25, 0.25]);
    }
}
