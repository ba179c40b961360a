//! Taking vertices out of a triangulation: the inverse of inserting them.
//!
//! What is taken out leaves gaps: the triangles and edges, and the vertex, stay in the arrays and mean nothing, until
//! [`Triangulation::without_gaps`] closes all of them at once.

use super::Triangulation;
use super::id::{EdgeId, FaceId, HalfedgeId, Id, VertexId};

/// Stands in `twin` for a side on the boundary.
const NONE: u32 = u32::MAX;

impl Triangulation {
    /// Takes out an inner vertex that has three different triangles. That of `h`, an outgoing halfedge, becomes the triangle of
    /// its neighbours; returns the two others, which are gone.
    ///
    /// ```text
    ///         2                2
    ///        ╱│╲              ╱ ╲
    ///       ╱ v ╲     ──→    ╱   ╲
    ///      ╱ ╱ ╲ ╲          ╱     ╲
    ///     0───────1        0───────1
    /// ```
    pub(crate) fn take_out(&mut self, h: HalfedgeId) -> [FaceId; 2] {
        let to_second = self.twin(self.prev(h)).expect("the vertex is inside");
        let to_third = self.twin(self.prev(to_second)).expect("the vertex is inside");
        self.relocate(self.next(to_second), self.prev(h));
        self.relocate(self.next(to_third), h);
        [to_second, to_third].map(|h| self.face(h))
    }

    /// Takes out a boundary vertex that has two different triangles. That of `h`, its halfedge along the boundary, becomes the
    /// triangle of its neighbours, with `h` where the boundary was; returns the other, which is gone.
    pub(crate) fn take_out_of_boundary(&mut self, h: HalfedgeId) -> FaceId {
        let inward = self.twin(self.prev(h)).expect("the vertex has two triangles");
        let last = self.tail(self.prev(inward));
        self.relocate(self.next(inward), self.prev(h));
        self.tail[h.index()] = last;
        self.face(inward)
    }

    /// Moves a side to another place, whose own is gone.
    fn relocate(&mut self, from: HalfedgeId, to: HalfedgeId) {
        let (twin, edge) = (self.twin[from.index()], self.edge[from.index()]);
        self.tail[to.index()] = self.tail[from.index()];
        self.twin[to.index()] = twin;
        self.edge[to.index()] = edge;
        if twin != NONE {
            self.twin[twin as usize] = to.0;
        }
        if self.edge_halfedge[edge.index()] == from {
            self.edge_halfedge[edge.index()] = to;
        }
    }

    /// The triangles that are not gone (or wanted, of a triangulation without gaps), by themselves, with the vertices and edges that they have: each with its former name, in
    /// order. O(F).
    pub(crate) fn without_gaps(&self, is_gone: impl Fn(FaceId) -> bool) -> (Self, Vec<VertexId>, Vec<EdgeId>) {
        let kept: Vec<FaceId> = self.faces().filter(|&f| !is_gone(f)).collect();
        let sides = || kept.iter().flat_map(|&f| self.sides(f));
        let (vertices, vertex) = renumbered(self.vertex_count, sides().map(|h| self.tail(h).index()));
        let (edges, edge) = renumbered(self.edge_count(), sides().map(|h| self.edge(h).index()));
        let (_, halfedge) = renumbered(self.halfedge_count(), sides().map(Id::index));
        let twin = |h: HalfedgeId| self.twin(h).map_or(NONE, |g| halfedge[g.index()]);
        // Of a side that is not there the twin is.
        let side = |h: HalfedgeId| match halfedge[h.index()] {
            NONE => HalfedgeId(halfedge[self.twin[h.index()] as usize]),
            side => HalfedgeId(side),
        };
        let compact = Self {
            tail: sides().map(|h| VertexId(vertex[self.tail(h).index()])).collect(),
            twin: sides().map(twin).collect(),
            edge: sides().map(|h| EdgeId(edge[self.edge(h).index()])).collect(),
            edge_halfedge: edges.iter().map(|&e| side(self.halfedge(EdgeId(e)))).collect(),
            vertex_count: vertices.len(),
        };
        (compact, vertices.into_iter().map(VertexId).collect(), edges.into_iter().map(EdgeId).collect())
    }
}

/// Those of so many things that are in use, in order, and the place of each among them.
fn renumbered(count: usize, used: impl Iterator<Item = usize>) -> (Vec<u32>, Vec<u32>) {
    let mut place = vec![NONE; count];
    used.for_each(|k| place[k] = 0);
    let kept: Vec<u32> = (0..count as u32).filter(|&k| place[k as usize] == 0).collect();
    (0..).zip(&kept).for_each(|(new, &old)| place[old as usize] = new);
    (kept, place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::shapes;

    #[test]
    fn taking_out_undoes_inserting() {
        let before = shapes::torus(1, 100).mesh().triangulation().clone();
        for f in before.faces().step_by(7) {
            let mut changed = before.clone();
            changed.insert(f);
            let [_, _, out] = changed.sides(f);
            let gone = changed.take_out(out);
            let (after, vertices, edges) = changed.without_gaps(|f| gone.contains(&f));
            assert_eq!(after, before);
            assert!(vertices.into_iter().eq(before.vertices()) && edges.into_iter().eq(before.edges()));
        }
    }

    #[test]
    fn taking_out_of_the_boundary_undoes_splitting_it() {
        let before = shapes::disk(60).mesh().triangulation().clone();
        for h in before.halfedges().filter(|&h| before.twin(h).is_none()) {
            let mut changed = before.clone();
            changed.split(h);
            let [out, ..] = changed.sides(FaceId::new(before.face_count()));
            let gone = changed.take_out_of_boundary(out);
            let (after, ..) = changed.without_gaps(|f| f == gone);
            after.check();
            assert_eq!(after.euler_characteristic(), before.euler_characteristic());
            let corners = |t: &Triangulation| {
                let sorted = |f| {
                    let [a, b, c] = t.corners(f);
                    [[a, b, c], [b, c, a], [c, a, b]].into_iter().min()
                };
                let mut all: Vec<_> = t.faces().map(sorted).collect();
                all.sort();
                all
            };
            assert_eq!(corners(&after), corners(&before));
        }
    }

    #[test]
    fn what_is_left_is_a_mesh_of_its_own() {
        let octahedron = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]];
        let mut triangulation = Mesh::new(6, &octahedron).unwrap().triangulation().clone();
        let h = triangulation.halfedges().find(|&h| triangulation.tail(h).0 == 0).unwrap();
        let moved = triangulation.prev(h);
        triangulation.flip(h);
        let gone = triangulation.take_out(moved);
        let (left, vertices, _) = triangulation.without_gaps(|f| gone.contains(&f));
        left.check();
        assert_eq!(vertices, [1, 2, 3, 4, 5].map(VertexId));
        assert_eq!((left.face_count(), left.euler_characteristic()), (6, 2));
    }
}
