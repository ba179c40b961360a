//! Triangles glued along their sides: connectivity that can be flipped.
//!
//! Triangle `f` has the halfedges `3f`, `3f + 1`, `3f + 2`, counter-clockwise, so that `next`, `prev` and `face` are
//! arithmetic and only tails, twins and edges are stored (a *corner table*; Rossignac 2001). Nothing here assumes that
//! an edge is known by its ends: an *intrinsic* triangulation may have loops, several edges between two vertices and
//! triangles glued to themselves, and flips make such.

use super::id::{EdgeId, FaceId, HalfedgeId, Id, VertexId};

/// Stands in `twin` for "none: this side is on the boundary".
const NONE: u32 = u32::MAX;

/// Halfedge connectivity of triangles; see the module's head.
///
/// What needs a vertex's ring is asked of a [`Mesh`](crate::Mesh), which is a triangulation that stays as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangulation {
    pub(super) tail: Vec<VertexId>,
    pub(super) twin: Vec<u32>,
    pub(super) edge: Vec<EdgeId>,
    pub(super) edge_halfedge: Vec<HalfedgeId>,
    pub(super) vertex_count: usize,
}

impl Triangulation {
    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }
    /// The number of edges.
    pub fn edge_count(&self) -> usize {
        self.edge_halfedge.len()
    }
    /// The number of triangles.
    pub fn face_count(&self) -> usize {
        self.tail.len() / 3
    }
    /// The number of halfedges: three a triangle, none on the outer side of the boundary.
    pub fn halfedge_count(&self) -> usize {
        self.tail.len()
    }

    /// All vertices.
    pub fn vertices(&self) -> impl DoubleEndedIterator<Item = VertexId> + ExactSizeIterator + Clone + use<> {
        (0..self.vertex_count).map(VertexId::new)
    }
    /// All edges.
    pub fn edges(&self) -> impl DoubleEndedIterator<Item = EdgeId> + ExactSizeIterator + Clone + use<> {
        (0..self.edge_count()).map(EdgeId::new)
    }
    /// All triangles.
    pub fn faces(&self) -> impl DoubleEndedIterator<Item = FaceId> + ExactSizeIterator + Clone + use<> {
        (0..self.face_count()).map(FaceId::new)
    }
    /// All halfedges.
    pub fn halfedges(&self) -> impl DoubleEndedIterator<Item = HalfedgeId> + ExactSizeIterator + Clone + use<> {
        (0..self.halfedge_count()).map(HalfedgeId::new)
    }

    /// The next halfedge counter-clockwise round its triangle.
    #[inline]
    pub fn next(&self, h: HalfedgeId) -> HalfedgeId {
        HalfedgeId(if h.0 % 3 == 2 { h.0 - 2 } else { h.0 + 1 })
    }
    /// The previous halfedge round its triangle.
    #[inline]
    pub fn prev(&self, h: HalfedgeId) -> HalfedgeId {
        HalfedgeId(if h.0.is_multiple_of(3) { h.0 + 2 } else { h.0 - 1 })
    }
    /// The halfedge on the other side of the edge; none on the boundary.
    #[inline]
    pub fn twin(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        let twin = self.twin[h.index()];
        (twin != NONE).then_some(HalfedgeId(twin))
    }
    /// The vertex where the halfedge starts.
    #[inline]
    pub fn tail(&self, h: HalfedgeId) -> VertexId {
        self.tail[h.index()]
    }
    /// The vertex where the halfedge ends.
    #[inline]
    pub fn head(&self, h: HalfedgeId) -> VertexId {
        self.tail(self.next(h))
    }
    /// The triangle that the halfedge is a side of.
    #[inline]
    pub fn face(&self, h: HalfedgeId) -> FaceId {
        FaceId(h.0 / 3)
    }
    /// The edge that the halfedge is a side of.
    #[inline]
    pub fn edge(&self, h: HalfedgeId) -> EdgeId {
        self.edge[h.index()]
    }
    /// One halfedge of an edge; on the boundary its only one.
    #[inline]
    pub fn halfedge(&self, e: EdgeId) -> HalfedgeId {
        self.edge_halfedge[e.index()]
    }
    /// The two ends of an edge.
    #[inline]
    pub fn ends(&self, e: EdgeId) -> [VertexId; 2] {
        let h = self.halfedge(e);
        [self.tail(h), self.head(h)]
    }
    /// The three halfedges of a triangle.
    #[inline]
    pub fn sides(&self, f: FaceId) -> [HalfedgeId; 3] {
        [HalfedgeId(3 * f.0), HalfedgeId(3 * f.0 + 1), HalfedgeId(3 * f.0 + 2)]
    }
    /// The three vertices of a triangle, in the order of its halfedges' tails.
    #[inline]
    pub fn corners(&self, f: FaceId) -> [VertexId; 3] {
        let [a, b, c] = self.sides(f);
        [self.tail(a), self.tail(b), self.tail(c)]
    }
    /// Whether an edge has a triangle on one side only.
    #[inline]
    pub fn is_boundary_edge(&self, e: EdgeId) -> bool {
        self.twin[self.halfedge(e).index()] == NONE
    }

    /// The Euler characteristic V - E + F.
    pub fn euler_characteristic(&self) -> i64 {
        self.vertex_count as i64 - self.edge_count() as i64 + self.face_count() as i64
    }

    /// Whether an edge can be flipped: it has two different triangles at its sides.
    pub fn is_flippable(&self, e: EdgeId) -> bool {
        let h = self.halfedge(e);
        self.twin(h).is_some_and(|g| self.face(g) != self.face(h))
    }

    /// Turns the edge of `h` counter-clockwise into the other diagonal of its quad; returns the new places of the
    /// quad's sides, as `(from, to)` pairs, for data kept by halfedge.
    ///
    /// ```text
    ///       k                 k
    ///    b ╱ ╲ a           b ╱│╲ a
    ///     ╱ h ╲             ╱ │ ╲
    ///    i─────j    ──→    i h│g j
    ///     ╲ g ╱             ╲ │ ╱
    ///    c ╲ ╱ d           c ╲│╱ d
    ///       l                 l
    /// ```
    /// `h` and its twin stay the two halfedges of the edge; the four sides change places.
    ///
    /// # Panics
    /// If the edge cannot be flipped ([`is_flippable`](Self::is_flippable)).
    pub fn flip(&mut self, h: HalfedgeId) -> [(HalfedgeId, HalfedgeId); 4] {
        let g = self.twin(h).expect("a boundary edge cannot be flipped");
        assert_ne!(self.face(h), self.face(g), "an edge inside one triangle cannot be flipped");
        let [a, b, c, d] = [self.next(h), self.prev(h), self.next(g), self.prev(g)];
        let (k, l) = (self.tail(b), self.tail(d));
        let moves = [(a, d), (b, a), (c, b), (d, c)];
        self.move_sides(moves);
        self.tail[h.index()] = l;
        self.tail[g.index()] = k;
        moves
    }

    /// Undoes the [`flip`](Self::flip) of `h`; returns the sides' moves likewise.
    ///
    /// # Panics
    /// If the edge cannot be flipped.
    pub fn unflip(&mut self, h: HalfedgeId) -> [(HalfedgeId, HalfedgeId); 4] {
        let g = self.twin(h).expect("a boundary edge cannot be flipped");
        assert_ne!(self.face(h), self.face(g), "an edge inside one triangle cannot be flipped");
        let [b, c, d, a] = [self.next(h), self.prev(h), self.next(g), self.prev(g)];
        let (i, j) = (self.tail(c), self.tail(a));
        let moves = [(b, c), (c, d), (d, a), (a, b)];
        self.move_sides(moves);
        self.tail[h.index()] = i;
        self.tail[g.index()] = j;
        moves
    }

    /// Moves four sides to each other's places, with all that points to them.
    fn move_sides(&mut self, moves: [(HalfedgeId, HalfedgeId); 4]) {
        let old = moves.map(|(from, _)| {
            let at = from.index();
            (self.tail[at], self.twin[at], self.edge[at])
        });
        // Edges first, while `edge_halfedge` still speaks of the old places; a side whose twin is among the four
        // would otherwise be moved twice.
        let held = old.map(|(_, _, edge)| self.edge_halfedge[edge.index()]);
        for (k, &(from, to)) in moves.iter().enumerate() {
            let (tail, twin, edge) = old[k];
            self.tail[to.index()] = tail;
            self.edge[to.index()] = edge;
            if held[k] == from {
                self.edge_halfedge[edge.index()] = to;
            }
            let moved = moves.iter().find(|(from, _)| from.0 == twin).map(|(_, to)| to.0);
            self.twin[to.index()] = moved.unwrap_or(twin);
            if moved.is_none() && twin != NONE {
                self.twin[twin as usize] = to.0;
            }
        }
    }

    /// Puts a new vertex v inside a triangle (i, j, k), which becomes (i, j, v); (j, k, v) and (k, i, v) are new, and so are the
    /// edges of v, named by halfedges from j, k and i. What the triangle had at its second and third side moves to the first
    /// sides of the new triangles.
    pub(crate) fn insert(&mut self, f: FaceId) -> VertexId {
        let [_, h, g] = self.sides(f);
        let first = self.tail.len() as u32;
        let (to_h, to_g) = (HalfedgeId(first), HalfedgeId(first + 3));
        let [i, j, k] = self.corners(f);
        let v = VertexId::new(self.vertex_count);
        self.vertex_count += 1;
        let edge = |n: usize| EdgeId::new(self.edge_halfedge.len() + n);
        let [to_j, to_k, to_i] = [edge(0), edge(1), edge(2)];
        let (old_h, old_g) = (self.edge[h.index()], self.edge[g.index()]);
        let moved = |twin: u32| match twin {
            twin if twin == h.0 => to_h.0,
            twin if twin == g.0 => to_g.0,
            twin => twin,
        };
        let (twin_h, twin_g) = (moved(self.twin[h.index()]), moved(self.twin[g.index()]));
        self.tail.extend([j, k, v, k, i, v]);
        self.twin.extend([twin_h, first + 5, h.0, twin_g, g.0, first + 1]);
        self.edge.extend([old_h, to_k, to_j, old_g, to_i, to_k]);
        for (twin, to) in [(twin_h, to_h), (twin_g, to_g)] {
            if twin != NONE {
                self.twin[twin as usize] = to.0;
            }
        }
        for (edge, from, to) in [(old_h, h, to_h), (old_g, g, to_g)] {
            if self.edge_halfedge[edge.index()] == from {
                self.edge_halfedge[edge.index()] = to;
            }
        }
        (self.tail[h.index()], self.tail[g.index()]) = (j, v);
        (self.twin[h.index()], self.twin[g.index()]) = (first + 2, first + 4);
        (self.edge[h.index()], self.edge[g.index()]) = (to_j, to_i);
        self.edge_halfedge.extend([h, HalfedgeId(first + 1), HalfedgeId(first + 4)]);
        v
    }

    /// Puts a new vertex m on an edge ij, which becomes im, and its triangle (i, j, k) (i, m, k); mj, mk and (m, j, k) are new. `h` is
    /// the halfedge from i to j; what was at the side jk moves to the second side of the new triangle. Likewise with what is across the edge,
    /// a triangle (j, i, l): ml, then, is new, and (m, i, l).
    pub(crate) fn split(&mut self, h: HalfedgeId) -> VertexId {
        debug_assert!(self.twin(h).is_none_or(|g| self.face(g) != self.face(h)), "two triangles, or one");
        let e = self.edge(h);
        let m = VertexId::new(self.vertex_count);
        self.vertex_count += 1;
        let to_j = EdgeId::new(self.edge_count());
        let first = HalfedgeId::new(self.halfedge_count());
        self.edge_halfedge[e.index()] = h;
        self.edge_halfedge.push(first);
        self.split_side(h, m, to_j);
        if let Some(g) = self.twin(h) {
            let second = HalfedgeId::new(self.halfedge_count());
            self.split_side(g, m, e);
            self.edge[g.index()] = to_j;
            for (one, other) in [(h, second), (g, first)] {
                (self.twin[one.index()], self.twin[other.index()]) = (other.0, one.0);
            }
        }
        m
    }

    /// Puts a vertex m on a side ij of a triangle (i, j, k), which becomes (i, m, k); (m, j, k) is new, and its side mj part of this edge.
    fn split_side(&mut self, h: HalfedgeId, m: VertexId, to_j: EdgeId) {
        let a = self.next(h);
        let first = self.tail.len() as u32;
        let [j, k] = [self.tail(a), self.head(a)];
        let to_k = EdgeId::new(self.edge_count());
        let (old, to) = (self.edge[a.index()], HalfedgeId(first + 1));
        // The triangle's third side may be the twin; it stays where it is.
        let twin = self.twin[a.index()];
        self.tail.extend([m, j, k]);
        self.twin.extend([NONE, twin, a.0]);
        self.edge.extend([to_j, old, to_k]);
        if twin != NONE {
            self.twin[twin as usize] = to.0;
        }
        if self.edge_halfedge[old.index()] == a {
            self.edge_halfedge[old.index()] = to;
        }
        self.tail[a.index()] = m;
        self.twin[a.index()] = first + 2;
        self.edge[a.index()] = to_k;
        self.edge_halfedge.push(a);
    }

    /// Takes out a vertex that three different triangles are about, the tail of `h`, whose triangle becomes all three. The other two, the vertex and its
    /// edges are of no use until they are [gone](Self::compact).
    pub(crate) fn remove(&mut self, h: HalfedgeId) {
        let second = self.twin(self.prev(h)).expect("it is inside");
        let third = self.twin(self.prev(second)).expect("it is inside");
        for (from, to) in [(self.next(second), self.prev(h)), (self.next(third), h)] {
            let (twin, edge) = (self.twin[from.index()], self.edge[from.index()]);
            self.tail[to.index()] = self.tail[from.index()];
            (self.twin[to.index()], self.edge[to.index()]) = (twin, edge);
            if twin != NONE {
                self.twin[twin as usize] = to.0;
            }
            if self.edge_halfedge[edge.index()] == from {
                self.edge_halfedge[edge.index()] = to;
            }
        }
    }

    /// Keeps these vertices, edges and triangles, in their order, under new numbers.
    pub(crate) fn compact(
        &mut self,
        keeps_vertex: impl Fn(VertexId) -> bool,
        keeps_edge: impl Fn(EdgeId) -> bool,
        keeps_face: impl Fn(FaceId) -> bool,
    ) {
        let number = |keeps: &mut dyn Iterator<Item = bool>| -> Vec<u32> {
            let counted = keeps.scan(0, |next, keeps| {
                let number = *next;
                *next += u32::from(keeps);
                Some(number)
            });
            counted.collect()
        };
        let vertex = number(&mut self.vertices().map(&keeps_vertex));
        let edge = number(&mut self.edges().map(&keeps_edge));
        let face = number(&mut self.faces().map(&keeps_face));
        let halfedge = |h: u32| if h == NONE { NONE } else { 3 * face[h as usize / 3] + h % 3 };
        let kept: Vec<usize> = self.halfedges().filter(|&h| keeps_face(self.face(h))).map(HalfedgeId::index).collect();
        let edges: Vec<EdgeId> = self.edges().filter(|&e| keeps_edge(e)).collect();
        self.vertex_count = self.vertices().filter(|&v| keeps_vertex(v)).count();
        self.tail = kept.iter().map(|&h| VertexId(vertex[self.tail[h].index()])).collect();
        self.twin = kept.iter().map(|&h| halfedge(self.twin[h])).collect();
        self.edge = kept.iter().map(|&h| EdgeId(edge[self.edge[h].index()])).collect();
        self.edge_halfedge = edges.iter().map(|&e| HalfedgeId(halfedge(self.halfedge(e).0))).collect();
    }

    /// Asserts every invariant of the connectivity.
    ///
    /// # Panics
    /// If one does not hold.
    pub fn check(&self) {
        assert_eq!(self.tail.len() % 3, 0);
        assert_eq!(self.twin.len(), self.tail.len());
        assert_eq!(self.edge.len(), self.tail.len());
        let mut sides = vec![0u8; self.edge_count()];
        for h in self.halfedges() {
            assert!(self.tail(h).index() < self.vertex_count, "{h:?} starts at a vertex that exists");
            sides[self.edge(h).index()] += 1;
            if let Some(g) = self.twin(h) {
                assert_ne!(g, h, "no halfedge is its own twin");
                assert_eq!(self.twin(g), Some(h), "twins know each other");
                assert_eq!(self.edge(g), self.edge(h), "twins share their edge");
                assert_eq!(
                    (self.tail(g), self.head(g)),
                    (self.head(h), self.tail(h)),
                    "twins run in opposite directions"
                );
            }
        }
        for e in self.edges() {
            assert_eq!(self.edge(self.halfedge(e)), e, "an edge's halfedge is one of its own");
            assert_eq!(sides[e.index()], if self.is_boundary_edge(e) { 1 } else { 2 }, "an edge has one or two sides");
        }
    }
}
