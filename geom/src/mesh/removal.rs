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

    /// The triangles that are not gone, by themselves, with the vertices and edges that they have: each with its former name, in
    /// order. O(F).
    pub(crate) fn without_gaps(&self, is_gone: impl Fn(FaceId) -> bool) -> (Self, Vec<VertexId>, Vec<EdgeId>) {
        let kept: Vec<FaceId> = self.faces().filter(|&f| !is_gone(f)).collect();
        let sides = || kept.iter().flat_map(|&f| self.sides(f));
        let (vertices, vertex) = renumbered(self.vertex_count, sides().map(|h| self.tail(h).index()));
        let (edges, edge) = renumbered(self.edge_count(), sides().map(|h| self.edge(h).index()));
        let (_, halfedge) = renumbered(self.halfedge_count(), sides().map(Id::index));
        let twin = |h: HalfedgeId| self.twin(h).map_or(NONE, |g| halfedge[g.index()]);
        let compact = Self {
            tail: sides().map(|h| VertexId(vertex[self.tail(h).index()])).collect(),
            twin: sides().map(twin).collect(),
            edge: sides().map(|h| EdgeId(edge[self.edge(h).index()])).collect(),
            edge_halfedge: edges.iter().map(|&e| HalfedgeId(halfedge[self.halfedge(EdgeId(e)).index()])).collect(),
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
