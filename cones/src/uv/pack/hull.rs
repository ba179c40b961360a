//! Enclosing rectangles by rotating calipers.
//!
//! The extent of a convex polygon across a direction is, between two directions of its edges, d·u(θ) for one pair of
//! opposite points: a concave function of θ. So the enclosing rectangle of least area or width has a side on an edge
//! (Freeman & Shapira 1975), and the smallest enclosing square has one too or is where both extents are equal.

use std::f64::consts::FRAC_PI_2;

use num_complex::Complex64;

/// A rectangle that encloses a polygon when that is turned by -`angle`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Enclosing {
    pub(super) angle: f64,
    pub(super) extent: [f64; 2],
}

impl Enclosing {
    pub(super) fn area(&self) -> f64 {
        self.extent[0] * self.extent[1]
    }

    pub(super) fn width(&self) -> f64 {
        self.extent[0].min(self.extent[1])
    }

    pub(super) fn side(&self) -> f64 {
        self.extent[0].max(self.extent[1])
    }
}

/// The convex hull, counter-clockwise, by Andrew's monotone chain (1979).
pub(in crate::uv) fn convex_hull(mut points: Vec<Complex64>) -> Vec<Complex64> {
    points.sort_unstable_by(|p, q| p.re.total_cmp(&q.re).then(p.im.total_cmp(&q.im)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut lower = chain(points.iter().copied());
    let mut upper = chain(points.iter().rev().copied());
    lower.pop();
    upper.pop();
    lower.extend(upper);
    lower
}

fn chain(points: impl Iterator<Item = Complex64>) -> Vec<Complex64> {
    let mut hull: Vec<Complex64> = Vec::new();
    for p in points {
        while let [.., a, b] = hull[..]
            && cross(b - a, p - b) <= 0.0
        {
            hull.pop();
        }
        hull.push(p);
    }
    hull
}

fn cross(a: Complex64, b: Complex64) -> f64 {
    a.re * b.im - a.im * b.re
}

/// The enclosing rectangles that can be the best of their kind, one for each direction of an edge and each direction where
/// both extents are equal, angles from 0 to π/2. O(h log h).
pub(super) fn enclosing(hull: &[Complex64]) -> Vec<Enclosing> {
    let mut angles = vec![0.0];
    for (k, &p) in hull.iter().enumerate() {
        let edge = hull[(k + 1) % hull.len()] - p;
        if edge != Complex64::default() {
            angles.push(edge.arg().rem_euclid(FRAC_PI_2));
        }
    }
    angles.sort_unstable_by(f64::total_cmp);
    angles.dedup();
    let mut calipers = Calipers::new(hull);
    let mut found = Vec::with_capacity(2 * angles.len());
    for (k, &angle) in angles.iter().enumerate() {
        let next = angles.get(k + 1).copied().unwrap_or(FRAC_PI_2);
        let [across, along] = calipers.spans(0.5 * (angle + next));
        found.push(extents(across, along, angle));
        // Both extents are equal where across·u = along·v for u = (cos, sin) and v = (-sin, cos).
        let equal = (along.im - across.re).atan2(across.im + along.re).rem_euclid(FRAC_PI_2);
        if angle < equal && equal < next {
            found.push(extents(across, along, equal));
        }
    }
    found
}

/// The angle of the enclosing rectangle that is the least by a measure; 0 without any point.
pub(super) fn least(found: &[Enclosing], measure: fn(&Enclosing) -> f64) -> f64 {
    found.iter().min_by(|a, b| measure(a).total_cmp(&measure(b))).map_or(0.0, |best| best.angle)
}

fn extents(across: Complex64, along: Complex64, angle: f64) -> Enclosing {
    let u = Complex64::cis(angle);
    let v = Complex64::i() * u;
    let dot = |a: Complex64, b: Complex64| (a.re * b.re + a.im * b.im).max(0.0);
    Enclosing { angle, extent: [dot(across, u), dot(along, v)] }
}

/// The outermost points in four directions, which move on as these turn.
struct Calipers<'a> {
    hull: &'a [Complex64],
    at: [usize; 4],
}

impl<'a> Calipers<'a> {
    fn new(hull: &'a [Complex64]) -> Self {
        let outermost = |direction: Complex64| {
            let reach = |k: &usize| (hull[*k] * direction.conj()).re;
            (0..hull.len()).max_by(|j, k| reach(j).total_cmp(&reach(k))).unwrap_or(0)
        };
        Self { hull, at: directions(0.0).map(outermost) }
    }

    /// The vectors between opposite outermost points, across the direction of `angle` and across its normal; angles must rise.
    fn spans(&mut self, angle: f64) -> [Complex64; 2] {
        let Self { hull, at } = self;
        if hull.is_empty() {
            return [Complex64::default(); 2];
        }
        for (at, direction) in at.iter_mut().zip(directions(angle)) {
            let reach = |k: usize| (hull[k % hull.len()] * direction.conj()).re;
            let mut steps = 0;
            while steps < hull.len() && reach(*at + 1) > reach(*at) {
                *at = (*at + 1) % hull.len();
                steps += 1;
            }
        }
        [hull[at[0]] - hull[at[2]], hull[at[1]] - hull[at[3]]]
    }
}

/// Right, up, left, down, turned by an angle.
fn directions(angle: f64) -> [Complex64; 4] {
    let u = Complex64::cis(angle);
    let v = Complex64::i() * u;
    [u, v, -u, -v]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygon(points: &[[f64; 2]]) -> Vec<Complex64> {
        convex_hull(points.iter().map(|p| Complex64::new(p[0], p[1])).collect())
    }

    fn extent_at(hull: &[Complex64], angle: f64) -> [f64; 2] {
        let turned = hull.iter().map(|z| z * Complex64::cis(-angle));
        let range = |values: Vec<f64>| {
            values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min)
        };
        [range(turned.clone().map(|z| z.re).collect()), range(turned.map(|z| z.im).collect())]
    }

    proptest! {
        #[test]
        fn no_angle_is_better_than_the_best_of_the_calipers(points in prop::collection::vec([-1.0..1.0f64, -1.0..1.0], 1..12)) {
            let hull = polygon(&points);
            let found = enclosing(&hull);
            for rectangle in &found {
                let extent = extent_at(&hull, rectangle.angle);
                prop_assert!((0..2).all(|k| (extent[k] - rectangle.extent[k]).abs() < 1e-9), "{rectangle:?} {extent:?}");
            }
            let best = |measure: fn(&Enclosing) -> f64| found.iter().map(measure).fold(f64::MAX, f64::min);
            for k in 0..500 {
                let angle = f64::from(k) / 500.0 * FRAC_PI_2;
                let any = Enclosing { angle, extent: extent_at(&hull, angle) };
                for measure in [Enclosing::area, Enclosing::width, Enclosing::side] {
                    prop_assert!(measure(&any) >= best(measure) - 1e-9);
                }
            }
        }
    }

    #[test]
    fn a_turned_stick_goes_along_the_diagonal_of_its_square() {
        let hull = polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1e-6], [0.0, 1e-6]]);
        let side = enclosing(&hull).iter().map(Enclosing::side).fold(f64::MAX, f64::min);
        assert!((side - 0.5f64.sqrt()).abs() < 1e-5, "{side}");
    }
}
