//! A part of a surface by itself: its triangles are flipped there, and the flips repeated on the whole.

use super::delaunay::{Intrinsic, ptolemy, quad};
use crate::mesh::{FaceId, HalfedgeId, Id, VertexId};

/// Some triangles of a surface. Where others of the surface's were beside them is boundary.
#[derive(Clone, Debug)]
pub struct Part {
    /// The triangles with the vertices and edges that they have, and no flips yet.
    pub intrinsic: Intrinsic,
    /// The surface's vertex for each of the part's.
    pub vertices: Vec<VertexId>,
    /// The surface's triangle for each of the part's, ascending.
    faces: Vec<FaceId>,
}

impl Intrinsic {
    /// The given triangles by themselves. O(F), F the triangles of the whole.
    pub fn part(&self, is_in: impl Fn(FaceId) -> bool) -> Part {
        let faces: Vec<FaceId> = self.triangulation.faces().filter(|&f| is_in(f)).collect();
        let (triangulation, vertices, edges) = self.triangulation.without_gaps(|f| !is_in(f));
        let metric = super::Metric::new(edges.iter().map(|&e| self.metric.length(e)).collect());
        Part { intrinsic: Self { triangulation, metric, flips: Vec::new() }, vertices, faces }
    }

    /// Repeats the Ptolemaic flips that a part of this surface was given since it was taken.
    pub fn repeat(&mut self, part: &Part, flips: &[HalfedgeId]) {
        for h in flips {
            // Both keep the sides of a triangle together, and a flip moves them alike.
            let h = HalfedgeId::new(3 * part.faces[h.index() / 3].index() + h.index() % 3);
            let e = self.triangulation.edge(h);
            let sides = quad(&self.triangulation, h);
            let length = self.metric.lengths_mut();
            length[e] = ptolemy(length[e], sides.map(|side| length[side]));
            self.triangulation.flip(h);
            self.flips.push(h);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::intrinsic::{delaunay, ptolemaic_delaunay};
    use crate::mesh::{Id, VertexData};
    use crate::{Metric, shapes};

    #[test]
    fn flips_of_a_part_are_repeated_on_the_whole() {
        let shape = shapes::hare(2000);
        let mesh = shape.mesh();
        let mut whole = delaunay(&mesh, &Metric::from_points(&mesh, &shape.points));
        whole.flips.clear();
        let mut part = whole.part(|f| f.index() % 1000 > 200);
        let u: VertexData<f64> = part.vertices.iter().map(|v| f64::from(v.0 * 7919 % 101) * 0.02).collect();
        let (taken, mut flips) = (part.clone(), Vec::new());
        let inside = &mut part.intrinsic;
        ptolemaic_delaunay(&mut inside.triangulation, &mut inside.metric, &u, &mut flips);
        assert!(flips.len() > 100, "{}", flips.len());
        whole.repeat(&taken, &flips);
        whole.triangulation.check();
        assert_eq!(whole.flips.len(), flips.len());
        let again = whole.part(|f| f.index() % 1000 > 200);
        assert_eq!(again.vertices, part.vertices);
        assert_eq!(again.intrinsic.triangulation.face_count(), inside.triangulation.face_count());
        for f in inside.triangulation.faces() {
            assert_eq!(again.intrinsic.triangulation.corners(f), inside.triangulation.corners(f));
            let lengths = |of: &crate::Intrinsic| of.metric.sides(&of.triangulation, f);
            assert_eq!(lengths(&again.intrinsic), lengths(inside));
        }
    }
}
