//! Walks over a mesh: round a vertex, along the boundary, through the pieces.

use super::id::{HalfedgeId, Id, VertexData, VertexId};
use super::{Mesh, Triangulation};

impl Mesh {
    /// The halfedges that start at a vertex, counter-clockwise; on the boundary the one along it first.
    pub fn outgoing(&self, v: VertexId) -> Outgoing<'_> {
        Outgoing::new(self.triangulation(), self.vertex_halfedge[v.index()])
    }

    /// The boundary: each loop as its halfedges in order, the surface on their left. Loops start at their lowest
    /// halfedge and are ordered by it.
    pub fn boundary_loops(&self) -> Vec<Vec<HalfedgeId>> {
        let mut seen = vec![false; self.vertex_count()];
        let mut loops = Vec::new();
        for first in self.halfedges().filter(|&h| self.twin(h).is_none()) {
            if seen[self.tail(first).index()] {
                continue;
            }
            let mut around = Vec::new();
            let mut h = first;
            while !seen[self.tail(h).index()] {
                seen[self.tail(h).index()] = true;
                around.push(h);
                h = self.vertex_halfedge[self.head(h).index()];
            }
            loops.push(around);
        }
        loops
    }

    /// For each vertex the number of its connected component, and how many there are. Components are numbered by
    /// their lowest vertex.
    pub fn components(&self) -> (VertexData<u32>, usize) {
        let mut component = VertexData::constant(self.vertex_count(), u32::MAX);
        let mut count = 0;
        let mut stack = Vec::new();
        for seed in self.vertices() {
            if component[seed] != u32::MAX {
                continue;
            }
            component[seed] = count;
            stack.push(seed);
            while let Some(v) = stack.pop() {
                for &w in self.neighbors(v) {
                    if component[w] == u32::MAX {
                        component[w] = count;
                        stack.push(w);
                    }
                }
            }
            count += 1;
        }
        (component, count as usize)
    }

    /// The genus of a connected mesh: χ = 2 - 2g - (boundary loops).
    pub fn genus(&self) -> usize {
        let twice = 2 - self.euler_characteristic() - self.boundary_loops().len() as i64;
        debug_assert!(twice >= 0 && twice % 2 == 0, "the mesh is connected and oriented");
        (twice / 2).max(0) as usize
    }
}

/// The halfedges that start at a vertex; see [`Mesh::outgoing`].
#[derive(Clone, Debug)]
pub struct Outgoing<'a> {
    triangulation: &'a Triangulation,
    first: HalfedgeId,
    next: Option<HalfedgeId>,
}

impl<'a> Outgoing<'a> {
    pub(super) fn new(triangulation: &'a Triangulation, first: HalfedgeId) -> Self {
        Self { triangulation, first, next: Some(first) }
    }
}

impl Iterator for Outgoing<'_> {
    type Item = HalfedgeId;
    fn next(&mut self) -> Option<HalfedgeId> {
        let h = self.next?;
        self.next = self.triangulation.twin(self.triangulation.prev(h)).filter(|&next| next != self.first);
        Some(h)
    }
}
