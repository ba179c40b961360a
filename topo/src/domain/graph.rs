//! What a field may live on.
//!
//! 0-dimensional persistence asks very little of a domain: how many vertices there are and which are neighbours. Every
//! undirected petgraph graph with compact indices is a domain as it is (`&UnGraph`, `&Csr`, `&GraphMap`, and whatever
//! else implements petgraph's visit traits); by measurement this costs nothing against a hand-written adjacency loop.
//! The domains of this crate ([`Grid`](crate::Grid), …) know more about themselves and use it to be faster.

use crate::filtration::{Direction, Filtration};
use crate::pairing::{Basins, Graph, Merge, Pointing, basins_of_graph};
use crate::scalar::Scalar;
use petgraph::Undirected;
use petgraph::visit::{GraphProp, IntoNeighbors, NodeCompactIndexable};

/// A finite undirected graph, passed around as a cheap copy: mostly a reference.
///
/// The contract: indices are `0..vertex_count()`; `u` is reported as a neighbour of `v` exactly if `v` is one of `u`.
/// Repeated edges and edges from a vertex to itself do no harm. The value of vertex `i` is element `i` of the field.
///
/// Implemented for everything with petgraph's `IntoNeighbors + NodeCompactIndexable + GraphProp<EdgeType = Undirected>`.
/// A directed graph has no sublevel components in this sense, and does not compile:
///
/// ```compile_fail
/// let directed = petgraph::graph::DiGraph::<(), ()>::from_edges([(0, 1)]);
/// topo::sublevel(&directed, &[0.0, 1.0]);
/// ```
pub trait Domain: Copy {
    /// How the domain names a vertex: petgraph's `NodeId`, or an index.
    type Vertex: Copy;

    /// Number of vertices.
    fn vertex_count(&self) -> usize;

    /// The vertex with a given index.
    fn vertex(&self, index: usize) -> Self::Vertex;

    /// Calls `visit` with the index of every neighbour of the vertex with index `index`.
    fn for_each_neighbor(&self, index: usize, visit: impl FnMut(usize));

    /// Finds the basins of the extrema in the way that is fastest on this domain.
    #[doc(hidden)]
    fn basins<S: Scalar, D: Direction>(&self, filtration: &Filtration<'_, S, D>, pointing: Pointing) -> Basins {
        basins_of_graph(*self, filtration, pointing)
    }

    /// Whether it is known that every loop of the domain is filled by triangles, so that every field on it has a contour tree.
    #[doc(hidden)]
    fn fills_loops(&self) -> bool {
        false
    }

    /// Pairs the extrema in the way that is fastest on this domain; by rising index.
    #[doc(hidden)]
    fn merges<S: Scalar, D: Direction>(&self, filtration: &Filtration<'_, S, D>) -> Vec<Merge> {
        self.basins(filtration, Pointing::Any).pair(filtration)
    }

    /// Whether [`map_merges`](Self::map_merges) looks for NaN itself and then finds nothing, so that values come from memory once.
    #[doc(hidden)]
    fn looks_once(&self) -> bool {
        false
    }

    /// What `pair` makes of the merges, each with the values at its extremum and at its end; nothing if the work is stopped. Of a component
    /// that joins an elder one it is asked once; before that it may be asked what it made of one that has no end yet.
    #[doc(hidden)]
    fn map_merges<S: Scalar, D: Direction, T>(
        &self,
        filtration: &Filtration<'_, S, D>,
        pair: impl Fn(&Merge, S, S) -> T,
    ) -> Vec<T> {
        let merges = self.merges(filtration);
        if filtration.stops() {
            return Vec::new();
        }
        let pair = |merge: &Merge| pair(merge, filtration.value(merge.extremum), filtration.value(merge.end));
        merges.iter().map(pair).collect()
    }
}

impl<G> Domain for G
where
    G: IntoNeighbors + NodeCompactIndexable + GraphProp<EdgeType = Undirected>,
{
    type Vertex = G::NodeId;

    fn vertex_count(&self) -> usize {
        self.node_count()
    }

    fn vertex(&self, index: usize) -> G::NodeId {
        self.from_index(index)
    }

    #[inline]
    fn for_each_neighbor(&self, index: usize, mut visit: impl FnMut(usize)) {
        for neighbor in self.neighbors(self.from_index(index)) {
            visit(self.to_index(neighbor));
        }
    }
}

impl<G: Domain> Graph for G {
    fn vertex_count(&self) -> usize {
        Domain::vertex_count(self)
    }

    #[inline]
    fn for_each_neighbor(&self, index: usize, visit: impl FnMut(usize)) {
        Domain::for_each_neighbor(self, index, visit);
    }
}
