//! The intrinsic metric: a length for every edge, and what follows from it.
//!
//! Lengths alone determine angles, areas and curvature, so nothing here needs positions. Angles are in radians. They
//! come from half-angle formulas and areas from Kahan's form of Heron's ("Miscalculating area and angles of a
//! needle-like triangle", 2014), which lose no digits on needles. Where three lengths violate the triangle inequality
//! the angle opposite the longest is π and the others are 0, the continuous extension of Bobenko, Pinkall and Springborn
//! (2015), with area 0.

use std::f64::consts::PI;

use crate::mesh::{EdgeData, EdgeId, FaceId, HalfedgeId, Id, Triangulation, VertexData};
use crate::parallel;
use crate::vector::distance;

/// An edge length for every edge of a triangulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    length: EdgeData<f64>,
}

impl Metric {
    /// A metric given by its lengths: finite and not negative.
    ///
    /// # Panics
    /// With debug assertions, if one is not.
    pub fn new(length: EdgeData<f64>) -> Self {
        debug_assert!(length.iter().all(|l| l.is_finite() && *l >= 0.0));
        Self { length }
    }

    /// The metric that positions in space induce: the Euclidean edge lengths.
    ///
    /// # Panics
    /// If there are fewer points than vertices.
    pub fn from_points(triangulation: &Triangulation, points: &[[f64; 3]]) -> Self {
        let length = |e| {
            let [p, q] = triangulation.ends(EdgeId::new(e)).map(|v| points[v.0 as usize]);
            distance(p, q)
        };
        Self::new(parallel::map(triangulation.edge_count(), length).into())
    }

    /// The length of an edge.
    #[inline]
    pub fn length(&self, e: EdgeId) -> f64 {
        self.length[e]
    }
    /// All lengths.
    pub fn lengths(&self) -> &EdgeData<f64> {
        &self.length
    }
    /// All lengths, to be changed together with the triangulation.
    pub(crate) fn lengths_mut(&mut self) -> &mut EdgeData<f64> {
        &mut self.length
    }

    /// The lengths of a triangle's sides, in the order of its halfedges.
    #[inline]
    pub fn sides(&self, triangulation: &Triangulation, f: FaceId) -> Sides {
        // Not by `map`, which is not always inlined.
        let length = |h| self.length[triangulation.edge(h)];
        let [a, b, c] = triangulation.sides(f);
        Sides([length(a), length(b), length(c)])
    }

    /// The angle of the triangle's corner at the tail of a halfedge.
    pub fn angle(&self, triangulation: &Triangulation, h: HalfedgeId) -> f64 {
        self.sides(triangulation, triangulation.face(h)).corner_angles()[h.0 as usize % 3]
    }

    /// The sum of the triangles' areas.
    pub fn area(&self, triangulation: &Triangulation) -> f64 {
        triangulation.faces().map(|f| self.sides(triangulation, f).area()).sum()
    }

    /// The share of the area that is in triangles with an angle below `angle`, in radians; 0 where there is no area.
    pub fn needle_share(&self, triangulation: &Triangulation, angle: f64) -> f64 {
        let (mut needles, mut whole) = (0.0, 0.0);
        let area_and_least = |f| {
            let sides = self.sides(triangulation, FaceId::new(f));
            (sides.area(), sides.corner_angles().into_iter().fold(f64::INFINITY, f64::min))
        };
        parallel::each_of(triangulation.face_count(), area_and_least, |_, (area, least)| {
            whole += area;
            if least < angle {
                needles += area;
            }
        });
        if whole > 0.0 { needles / whole } else { 0.0 }
    }

    /// Lumped vertex areas: a third of the area of each triangle at each of its corners. They sum to the area.
    pub fn vertex_areas(&self, triangulation: &Triangulation) -> VertexData<f64> {
        let mut areas = VertexData::constant(triangulation.vertex_count(), 0.0);
        for f in triangulation.faces() {
            let third = self.sides(triangulation, f).area() / 3.0;
            for v in triangulation.corners(f) {
                areas[v] += third;
            }
        }
        areas
    }

    /// The sum of the corner angles at each vertex: Θ.
    pub fn angle_sums(&self, triangulation: &Triangulation) -> VertexData<f64> {
        let mut sums = VertexData::constant(triangulation.vertex_count(), 0.0);
        let angles = |f| {
            let sides = self.sides(triangulation, FaceId::new(f));
            [sides.angle(1), sides.angle(2)]
        };
        parallel::each_of(triangulation.face_count(), angles, |f, [a, b]| {
            // The third angle is what is left of π: in a sum only its absolute error counts.
            for (v, angle) in triangulation.corners(FaceId::new(f)).into_iter().zip([a, b, PI - a - b]) {
                sums[v] += angle;
            }
        });
        sums
    }

    /// The slack, relative to the mean edge length, that [`mollified`](Self::mollified) metrics are given. Tried on needle
    /// meshes: with 1e-5 Newton's method often fails, with 1e-4 it never did.
    pub const MOLLIFICATION: f64 = 1e-4;

    /// The metric with all edges longer by the same least amount, such that in every triangle two sides are together longer
    /// than the third by `slack` times the mean edge length (intrinsic mollification; Sharp & Crane 2020, §4.5). The metric
    /// itself where that is so already.
    pub fn mollified(&self, triangulation: &Triangulation, slack: f64) -> Self {
        let wanted = slack * self.length.iter().sum::<f64>() / triangulation.edge_count() as f64;
        let missing = |f| {
            let sides = self.sides(triangulation, f);
            wanted - (0..3).map(|k| sides.slack(k)).fold(f64::INFINITY, f64::min)
        };
        let longer = triangulation.faces().map(missing).fold(0.0, f64::max);
        Self { length: self.length.iter().map(|l| l + longer).collect() }
    }

    /// The discretely conformally equivalent metric with log scale factors `u`: the edge ij becomes
    /// `l_ij e^((u_i + u_j)/2)` (Luo 2004; Springborn, Schröder & Pinkall 2008).
    pub fn scaled(&self, triangulation: &Triangulation, u: &[f64]) -> Self {
        let half = parallel::map(u.len(), |v| (0.5 * u[v]).exp());
        let scale = |e| {
            let e = EdgeId::new(e);
            let [i, j] = triangulation.ends(e);
            self.length[e] * half[i.0 as usize] * half[j.0 as usize]
        };
        Self { length: parallel::map(triangulation.edge_count(), scale).into() }
    }
}

/// The side lengths of a triangle. Side `k` is opposite corner `k + 2` (mod 3) and starts at corner `k`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides(pub [f64; 3]);

impl Sides {
    /// The triangle's area; 0 where the triangle inequality fails.
    pub fn area(self) -> f64 {
        // Without branches, which could not be predicted.
        let [a, b, c] = self.0;
        let [a, b] = falling(a, b);
        let [b, c] = falling(b, c);
        let [a, b] = falling(a, b);
        // a ≥ b ≥ c; the parentheses matter (Kahan).
        let squared = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
        0.25 * squared.max(0.0).sqrt()
    }

    /// The angle opposite side `k`: tan²(α/2) = (s - b)(s - c) / (s (s - a)).
    #[inline]
    pub fn angle(self, k: usize) -> f64 {
        let above = self.slack((k + 1) % 3) * self.slack((k + 2) % 3);
        let below = self.0.iter().sum::<f64>() * self.slack(k);
        if below <= 0.0 {
            if above > 0.0 { PI } else { 0.0 }
        } else if above <= 0.0 {
            0.0
        } else {
            2.0 * (above / below).sqrt().atan()
        }
    }

    /// How much longer the other two sides are together than side `k`: negative where the triangle inequality fails.
    /// Near lengths are subtracted first, which is exact.
    #[inline]
    pub fn slack(self, k: usize) -> f64 {
        let (b, c) = (self.0[(k + 1) % 3], self.0[(k + 2) % 3]);
        (b.max(c) - self.0[k]) + b.min(c)
    }

    /// The angles at corners 0, 1, 2: opposite sides 1, 2, 0.
    pub fn corner_angles(self) -> [f64; 3] {
        [self.angle(1), self.angle(2), self.angle(0)]
    }

    /// The cotangents of the angles opposite sides 0, 1, 2; zeros for a triangle without area.
    pub fn cotangents(self) -> [f64; 3] {
        let area = self.area();
        if area <= 0.0 {
            return [0.0; 3];
        }
        let [a2, b2, c2] = self.0.map(|l| l * l);
        [b2 + c2 - a2, c2 + a2 - b2, a2 + b2 - c2].map(|twice_dot| twice_dot / (4.0 * area))
    }

    /// The three sides as vectors in a plane, counter-clockwise and summing to zero, the first along +x.
    pub fn unfold(self) -> [[f64; 2]; 3] {
        let [a, b, c] = self.0;
        if a <= 0.0 {
            return [[0.0, 0.0], [b, 0.0], [-b, 0.0]];
        }
        // The apex: at distance c from the origin and b from (a, 0).
        let x = 0.5 * (a + (c - b) * (c + b) / a);
        let y = 2.0 * self.area() / a;
        [[a, 0.0], [x - a, y], [-x, -y]]
    }
}

#[inline]
fn falling(a: f64, b: f64) -> [f64; 2] {
    [if a > b { a } else { b }, if a > b { b } else { a }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, VertexId};

    #[test]
    fn angles_of_every_triangle_sum_to_pi() {
        for sides in [[3.0, 4.0, 5.0], [1.0, 1.0, 1e-9], [1.0, 2.0, 3.0], [1.0, 1.0, 5.0], [2.0, 1.0, 1.0 + 1e-12]] {
            let sum: f64 = Sides(sides).corner_angles().iter().sum();
            assert!((sum - PI).abs() < 1e-12, "{sides:?}: {sum}");
        }
    }

    #[test]
    fn a_right_triangle_is_measured_exactly() {
        let sides = Sides([3.0, 4.0, 5.0]);
        assert_eq!(sides.area(), 6.0);
        assert!((sides.angle(2) - PI / 2.0).abs() < 1e-15);
        let [a, b, c] = sides.cotangents();
        assert_eq!([a, b, c], [4.0 / 3.0, 3.0 / 4.0, 0.0]);
    }

    #[test]
    fn unfolded_sides_have_their_lengths_and_close() {
        let sides = Sides([3.0, 4.5, 5.0]);
        let vectors = sides.unfold();
        for (v, l) in vectors.iter().zip(sides.0) {
            assert!((v[0].hypot(v[1]) - l).abs() < 1e-14);
        }
        assert!(vectors.iter().map(|v| v[0]).sum::<f64>().abs() < 1e-14);
        assert!(vectors.iter().map(|v| v[1]).sum::<f64>().abs() < 1e-14);
    }

    #[test]
    fn corner_angles_sit_at_the_tails_of_their_halfedges() {
        let mesh = Mesh::new(4, &[[0, 1, 2], [2, 1, 3]]).unwrap();
        let points = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [3.0, 4.0, 0.0]];
        let metric = Metric::from_points(&mesh, &points);
        for f in mesh.faces() {
            for (h, angle) in mesh.sides(f).into_iter().zip(metric.sides(&mesh, f).corner_angles()) {
                assert_eq!(metric.angle(&mesh, h), angle);
                let right = [0, 3].contains(&mesh.tail(h).0);
                assert_eq!((angle - PI / 2.0).abs() < 1e-15, right);
            }
        }
    }

    #[test]
    fn vertex_areas_are_thirds_of_triangles_and_sum_to_the_area() {
        let mesh = Mesh::new(4, &[[0, 1, 2], [2, 1, 3]]).unwrap();
        let metric = Metric::from_points(&mesh, &[[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [9.0, 4.0, 0.0]]);
        let areas = metric.vertex_areas(&mesh);
        assert!((areas[VertexId(0)] - 2.0).abs() < 1e-14 && (areas[VertexId(1)] - 8.0).abs() < 1e-14);
        assert!((areas.iter().sum::<f64>() - metric.area(&mesh)).abs() < 1e-13);
    }

    #[test]
    fn needles_keep_all_digits_of_their_area() {
        for sides in [[1.0, 1.0, 1e-9], [1.0, 1e-9, 1.0], [1e-9, 1.0, 1.0]] {
            assert!((Sides(sides).area() / 5e-10 - 1.0).abs() < 1e-15);
        }
        assert!(Sides([0.0, 1.0, 1.0]).unfold().as_flattened().iter().all(|x| x.is_finite()));
    }

    #[test]
    fn a_mollified_metric_has_the_slack_asked_for_and_one_that_has_it_already_stays() {
        let mesh = Mesh::new(3, &[[0, 1, 2]]).unwrap();
        for longest in 0..3 {
            let mut lengths = [1.0; 3];
            lengths[longest] = 2.0;
            let metric = Metric::new(lengths.to_vec().into());
            let sides = metric.mollified(&mesh, 0.03).sides(&mesh, FaceId(0));
            let slack = (0..3).map(|k| sides.slack(k)).fold(f64::INFINITY, f64::min);
            assert!((slack - 0.03 * 4.0 / 3.0).abs() < 1e-15, "{sides:?}");
        }
        let equilateral = Metric::new(vec![1.0; 3].into());
        assert_eq!(equilateral.mollified(&mesh, 1e-4), equilateral);
    }
}
