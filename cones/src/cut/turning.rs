//! How much a path along edges turns.
//!
//! Where a path goes through a vertex it has an angle on its left and one on its right; both add up to the vertex's angle Θ. It
//! runs straight on where they are equal (Polthier & Schmies 1998, "Straightest geodesics on polyhedral surfaces"), so it
//! *turns* by
//!
//! ```text
//!     |left - right| · π / Θ        0 straight on, π back along the same edge
//! ```
//!
//! which on a flat vertex is the exterior angle. Bending with the surface is no turning: a path along a crease, or round a
//! sphere on a great circle, is straight.

use std::f64::consts::PI;
use std::ops::Sub;

use geom::{FaceId, HalfedgeData, HalfedgeId, Id, Mesh, Metric};
use rayon::prelude::*;

/// So many triangles are gone through one after the other.
const AT_ONCE: usize = 1024;

/// Parts of a turn all round; differences of directions wrap round as angles do.
const PARTS: f64 = 4_294_967_296.0;

/// Directions at every vertex.
#[derive(Clone, Debug)]
pub(crate) struct Turning {
    /// The angle from a vertex's first halfedge counter-clockwise to each, scaled so that all round is 2³²: half the memory of a float, for 10⁻⁹ of a radian.
    direction: HalfedgeData<u32>,
}

impl Turning {
    /// Directions by the corner angles of a metric. O(F).
    pub(crate) fn new(mesh: &Mesh, metric: &Metric) -> Self {
        let corners = |f: usize| metric.sides(mesh, FaceId::new(f)).corner_angles();
        let angles: Vec<[f64; 3]> = (0..mesh.face_count()).into_par_iter().with_min_len(AT_ONCE).map(corners).collect();
        let angles: HalfedgeData<f64> = angles.into_flattened().into();
        let mut direction = HalfedgeData::constant(angles.len(), 0);
        for v in mesh.vertices() {
            let all: f64 = mesh.outgoing(v).map(|h| angles[h]).sum();
            let size = if all > 0.0 { PARTS / all } else { 0.0 };
            let mut sum = 0.0;
            for h in mesh.outgoing(v) {
                direction[h] = (sum * size) as u32;
                sum += angles[h];
            }
        }
        Self { direction }
    }

    /// As [`between`](Self::between), where it is asked but once.
    pub(crate) fn once(mesh: &Mesh, metric: &Metric, h: HalfedgeId, g: HalfedgeId) -> f64 {
        let Some(back) = mesh.twin(h) else { return 0.0 };
        let (mut sum, mut ends) = (0.0, [0.0; 2]);
        for spoke in mesh.outgoing(mesh.head(h)) {
            for (end, at) in ends.iter_mut().zip([back, g]) {
                *end = if spoke == at { sum } else { *end };
            }
            sum += metric.angle(mesh, spoke);
        }
        if sum > 0.0 { ((ends[1] - ends[0]) * 2.0 * PI / sum).rem_euclid(2.0 * PI).sub(PI).abs() } else { PI }
    }

    /// By how much a path turns that comes along `h` and goes on along `g`; not along the boundary.
    pub(crate) fn between(&self, mesh: &Mesh, h: HalfedgeId, g: HalfedgeId) -> f64 {
        let Some(back) = mesh.twin(h) else { return 0.0 };
        let between = self.direction[g].wrapping_sub(self.direction[back]);
        (f64::from(between) * (2.0 * PI / PARTS) - PI).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{VertexId, shapes};

    #[test]
    fn on_a_plane_a_path_turns_by_its_exterior_angles() {
        let faces: Vec<[u32; 3]> = (0..6).map(|k| [6, k, (k + 1) % 6]).collect();
        let mesh = Mesh::new(7, &faces).unwrap();
        let metric = Metric::new(vec![1.0; mesh.edge_count()].into());
        let turning = Turning::new(&mesh, &metric);
        let spokes: Vec<HalfedgeId> = mesh.outgoing(VertexId(6)).collect();
        let inwards = mesh.twin(spokes[0]).unwrap();
        let turns: Vec<f64> = spokes.iter().map(|&g| 3.0 / PI * turning.between(&mesh, inwards, g)).collect();
        for (turn, expected) in turns.iter().zip([3.0, 2.0, 1.0, 0.0, 1.0, 2.0]) {
            assert!((turn - expected).abs() < 1e-8, "{turns:?}");
        }
    }

    #[test]
    fn backwards_a_path_turns_as_much_and_once_is_as_often() {
        let shape = shapes::hare(300);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let turning = Turning::new(&mesh, &metric);
        let twin = |h| mesh.twin(h).unwrap();
        for h in mesh.halfedges() {
            for g in mesh.outgoing(mesh.head(h)) {
                let once = Turning::once(&mesh, &metric, h, g);
                assert!((turning.between(&mesh, h, g) - once).abs() < 1e-8);
                let [there, back] = [turning.between(&mesh, h, g), turning.between(&mesh, twin(g), twin(h))];
                assert!((there - back).abs() < 1e-8 && (0.0..=PI + 1e-12).contains(&there));
            }
        }
    }
}
