//! A mesh as a graph of its vertices and edges, through petgraph's visit traits.

use petgraph::visit::{
    EdgeCount, GraphBase, GraphProp, IntoNeighbors, IntoNodeIdentifiers, NodeCompactIndexable, NodeCount,
    NodeIndexable, VisitMap, Visitable,
};

use super::Mesh;
use super::id::{EdgeId, Id, VertexId};

impl GraphBase for Mesh {
    type NodeId = VertexId;
    type EdgeId = EdgeId;
}

impl GraphProp for Mesh {
    type EdgeType = petgraph::Undirected;
}

impl NodeCount for Mesh {
    fn node_count(&self) -> usize {
        self.vertex_count()
    }
}

impl EdgeCount for Mesh {
    fn edge_count(&self) -> usize {
        self.triangulation().edge_count()
    }
}

impl NodeIndexable for Mesh {
    fn node_bound(&self) -> usize {
        self.vertex_count()
    }
    #[inline]
    fn to_index(&self, v: VertexId) -> usize {
        v.index()
    }
    #[inline]
    fn from_index(&self, index: usize) -> VertexId {
        VertexId::new(index)
    }
}

impl NodeCompactIndexable for Mesh {}

impl<'a> IntoNeighbors for &'a Mesh {
    type Neighbors = std::iter::Copied<std::slice::Iter<'a, VertexId>>;
    #[inline]
    fn neighbors(self, v: VertexId) -> Self::Neighbors {
        Mesh::neighbors(self, v).iter().copied()
    }
}

impl IntoNodeIdentifiers for &Mesh {
    type NodeIdentifiers = std::iter::Map<std::ops::Range<usize>, fn(usize) -> VertexId>;
    fn node_identifiers(self) -> Self::NodeIdentifiers {
        (0..self.vertex_count()).map(VertexId::new)
    }
}

/// The vertices visited by one of petgraph's walks.
#[derive(Clone, Debug, Default)]
pub struct VisitedVertices(Vec<bool>);

impl VisitMap<VertexId> for VisitedVertices {
    fn visit(&mut self, v: VertexId) -> bool {
        !std::mem::replace(&mut self.0[v.index()], true)
    }
    fn is_visited(&self, v: &VertexId) -> bool {
        self.0[v.index()]
    }
    fn unvisit(&mut self, v: VertexId) -> bool {
        std::mem::replace(&mut self.0[v.index()], false)
    }
}

impl Visitable for Mesh {
    type Map = VisitedVertices;
    fn visit_map(&self) -> VisitedVertices {
        VisitedVertices(vec![false; self.vertex_count()])
    }
    fn reset_map(&self, map: &mut VisitedVertices) {
        map.0.clear();
        map.0.resize(self.vertex_count(), false);
    }
}
