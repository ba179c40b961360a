//! Graphs given as lists of neighbours or of edges, for those who have no petgraph graph.

use super::graph::Domain;
use crate::error::{Error, check_vertex_count};

/// An undirected graph as sorted neighbour lists, one behind the other.
///
/// ```
/// let neighbors = [vec![1, 2], vec![0], vec![0]]; // 1 – 0 – 2
/// let graph = topo::Adjacency::new(&neighbors)?;
/// let peaks = topo::superlevel(&graph, &[1.0f32, 4.0, 3.0])?.ranked();
/// assert_eq!((peaks[0].extremum, peaks[1].extremum, peaks[1].saddle), (1, 2, Some(0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adjacency {
    /// Where the list of each vertex begins, and the end of the last.
    starts: Vec<usize>,
    neighbors: Vec<u32>,
}

impl Adjacency {
    /// From the neighbours of each vertex. An edge may stand in one of the two lists or in both.
    ///
    /// # Errors
    /// If a neighbour is not a vertex.
    pub fn new(lists: &[impl AsRef<[usize]>]) -> Result<Self, Error> {
        let vertices = lists.len();
        let mut edges = Vec::with_capacity(lists.iter().map(|list| list.as_ref().len()).sum());
        for (of, list) in lists.iter().enumerate() {
            for &vertex in list.as_ref() {
                if vertex >= vertices {
                    return Err(Error::Neighbor { of, vertex, vertices });
                }
                edges.push([of, vertex]);
            }
        }
        Self::from_edges(vertices, &edges)
    }

    /// From pairs of vertices. O(n + m) for n vertices and m edges, and sorting within each list.
    ///
    /// # Errors
    /// If an end of an edge is not a vertex.
    pub fn from_edges(vertices: usize, edges: &[[usize; 2]]) -> Result<Self, Error> {
        check_vertex_count(vertices)?;
        for (edge, ends) in edges.iter().enumerate() {
            if let Some(&vertex) = ends.iter().find(|&&end| end >= vertices) {
                return Err(Error::Edge { edge, vertex, vertices });
            }
        }
        let mut starts = vec![0; vertices + 1];
        edges.iter().flatten().for_each(|&end| starts[end + 1] += 1);
        for v in 0..vertices {
            starts[v + 1] += starts[v];
        }
        let mut filled = starts.clone();
        let mut neighbors = vec![0; 2 * edges.len()];
        for &[a, b] in edges {
            for (of, neighbor) in [(a, b), (b, a)] {
                neighbors[filled[of]] = neighbor as u32;
                filled[of] += 1;
            }
        }
        Ok(Self { starts, neighbors }.without_repetitions())
    }

    fn without_repetitions(mut self) -> Self {
        let mut kept = 0;
        for v in 0..self.starts.len() - 1 {
            let list = self.starts[v]..self.starts[v + 1];
            self.neighbors[list.clone()].sort_unstable();
            self.starts[v] = kept;
            for place in list {
                let neighbor = self.neighbors[place];
                if kept == self.starts[v] || self.neighbors[kept - 1] != neighbor {
                    self.neighbors[kept] = neighbor;
                    kept += 1;
                }
            }
        }
        *self.starts.last_mut().expect("there is one start more than there are vertices") = kept;
        self.neighbors.truncate(kept);
        self
    }

    /// The neighbours of a vertex by rising index.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn neighbors(&self, vertex: usize) -> &[u32] {
        &self.neighbors[self.starts[vertex]..self.starts[vertex + 1]]
    }
}

impl Domain for &Adjacency {
    type Vertex = usize;

    fn vertex_count(&self) -> usize {
        self.starts.len() - 1
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
    }
}
