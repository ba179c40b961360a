//! Graphs given as lists of neighbours or of edges, for those who have no petgraph graph.

use super::graph::Domain;
use super::rows::{Rows, check_edges, known, vertex_index};
use crate::error::{Error, check_vertex_count};
use num_traits::PrimInt;

/// An undirected graph as sorted neighbour lists, one behind the other.
///
/// Vertices are named by integers of any type.
///
/// ```
/// let neighbors = [vec![1, 2], vec![0], vec![0]]; // 1 – 0 – 2
/// let graph = topo::Adjacency::new(&neighbors)?;
/// let peaks = topo::superlevel(&graph, &[1.0f32, 4.0, 3.0])?.ranked();
/// assert_eq!((peaks[0].extremum, peaks[1].extremum, peaks[1].saddle), (1, 2, Some(0)));
///
/// let edges: [(u32, u32); 2] = [(0, 1), (2, 0)];
/// assert_eq!(topo::Adjacency::from_edges(3, &edges)?, graph);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Rows that lie in memory already, such as those of a sparse matrix, are taken without a copy by
/// [`CsrGraph`](crate::CsrGraph).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adjacency {
    neighbors: Rows<u32>,
}

impl Adjacency {
    /// From the neighbours of each vertex, named by integers of any type. An edge may stand in one of the two lists or in both.
    ///
    /// # Errors
    /// If a neighbour is not a vertex.
    pub fn new<I: PrimInt>(lists: &[impl AsRef<[I]>]) -> Result<Self, Error> {
        let vertices = lists.len();
        check_vertex_count(vertices)?;
        for (of, list) in lists.iter().enumerate() {
            for &neighbor in list.as_ref() {
                vertex_index(neighbor, vertices).map_err(|vertex| Error::Neighbor { of, vertex, vertices })?;
            }
        }
        let edges = (0..).zip(lists).flat_map(|(of, list)| list.as_ref().iter().map(move |&to| [of, known(to)]));
        Ok(Self::both_ways(vertices, edges))
    }

    /// From pairs of vertices, arrays or tuples of integers of any type. O(n + m) for n vertices and m edges, and sorting
    /// within each list.
    ///
    /// # Errors
    /// If an end of an edge is not a vertex.
    pub fn from_edges<I: PrimInt>(vertices: usize, edges: &[impl Into<[I; 2]> + Copy]) -> Result<Self, Error> {
        let edges = edges.iter().map(|&edge| edge.into());
        check_edges(vertices, edges.clone())?;
        Ok(Self::both_ways(vertices, edges.map(|edge| edge.map(known))))
    }

    fn both_ways(vertices: usize, edges: impl Iterator<Item = [u32; 2]> + Clone) -> Self {
        let ends = edges.map(|[a, b]| [(a, b), (b, a)]);
        Self { neighbors: Rows::sorted(vertices, ends).without_repetitions() }
    }

    /// The neighbours of a vertex by rising index.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn neighbors(&self, vertex: usize) -> &[u32] {
        self.neighbors.of(vertex)
    }
}

impl Domain for &Adjacency {
    type Vertex = usize;

    fn vertex_count(&self) -> usize {
        self.neighbors.len()
    }

    fn vertex(&self, index: usize) -> usize {
        index
    }

    fn for_each_neighbor(&self, index: usize, mut visit: impl FnMut(usize)) {
        self.neighbors(index).iter().for_each(|&neighbor| visit(neighbor as usize));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_counts_once_wherever_it_is_listed() {
        let one_sided = Adjacency::new(&[vec![1, 1, 2], vec![], vec![2]]).expect("all exist");
        let both_sided = Adjacency::new(&[vec![1, 2], vec![0], vec![0, 2]]).expect("all exist");
        assert_eq!(one_sided, both_sided);
        assert_eq!(one_sided.neighbors(0), [1, 2]);
    }

    #[test]
    fn a_stranger_is_named() {
        let error = Adjacency::new(&[[1], [2]]).expect_err("vertex 2 does not exist");
        assert_eq!(error, Error::Neighbor { of: 1, vertex: 2, vertices: 2 });
        assert_eq!(
            error.to_string(),
            "the neighbour list of vertex 1 names vertex 2, but there are only 2, counted from 0"
        );
        let error = Adjacency::from_edges(2, &[(0i64, 1), (1, -1)]).expect_err("no vertex is negative");
        assert_eq!(error, Error::Edge { edge: 1, vertex: -1, vertices: 2 });
        let error = Adjacency::from_edges(2, &[[0, u64::MAX]]).expect_err("far too large");
        assert_eq!(error, Error::Edge { edge: 0, vertex: u64::MAX.into(), vertices: 2 });
    }
}
