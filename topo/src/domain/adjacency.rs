//! Graphs given as lists of neighbours or of edges, for those who have no petgraph graph.

use super::graph::Domain;
use core::fmt;

/// Why lists of vertices do not describe a domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DomainError {
    /// A neighbour does not exist.
    Neighbor {
        /// The vertex in whose list it stands.
        of: usize,
        /// What stands there.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// An end of an edge does not exist.
    Edge {
        /// Number of the edge, from 0.
        edge: usize,
        /// What it names.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A corner of a triangle does not exist.
    Triangle {
        /// Number of the triangle, from 0.
        triangle: usize,
        /// What it names.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// There are more vertices than can be numbered, which are 2³¹ - 1.
    TooLarge {
        /// Number of vertices.
        vertices: usize,
    },
}

impl fmt::Display for DomainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, number, vertex, vertices) = match *self {
            Self::Neighbor { of, vertex, vertices } => ("the neighbour list of vertex", of, vertex, vertices),
            Self::Edge { edge, vertex, vertices } => ("edge", edge, vertex, vertices),
            Self::Triangle { triangle, vertex, vertices } => ("triangle", triangle, vertex, vertices),
            Self::TooLarge { vertices } => {
                return write!(
                    f,
                    "there are {vertices} vertices, more than can be numbered; coarsen or split the domain"
                );
            }
        };
        write!(f, "{what} {number} names vertex {vertex}, but there are only {vertices}, counted from 0")
    }
}

impl core::error::Error for DomainError {}

/// Refuses more vertices than fit into 31 bits.
pub(crate) fn check_count(vertices: usize) -> Result<(), DomainError> {
    if vertices >= 1 << 31 { Err(DomainError::TooLarge { vertices }) } else { Ok(()) }
}

/// An undirected graph as sorted neighbour lists, one behind the other.
///
/// ```
/// let neighbors = [vec![1, 2], vec![0], vec![0]]; // 1 – 0 – 2
/// let graph = topo::Adjacency::new(&neighbors)?;
/// let peaks = topo::superlevel(&graph, &[1.0f32, 4.0, 3.0])?;
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
    pub fn new(lists: &[impl AsRef<[usize]>]) -> Result<Self, DomainError> {
        let vertices = lists.len();
        let mut edges = Vec::with_capacity(lists.iter().map(|list| list.as_ref().len()).sum());
        for (of, list) in lists.iter().enumerate() {
            for &vertex in list.as_ref() {
                if vertex >= vertices {
                    return Err(DomainError::Neighbor { of, vertex, vertices });
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
    pub fn from_edges(vertices: usize, edges: &[[usize; 2]]) -> Result<Self, DomainError> {
        check_count(vertices)?;
        for (edge, ends) in edges.iter().enumerate() {
            if let Some(&vertex) = ends.iter().find(|&&end| end >= vertices) {
                return Err(DomainError::Edge { edge, vertex, vertices });
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
        assert_eq!(error, DomainError::Neighbor { of: 1, vertex: 2, vertices: 2 });
        assert_eq!(
            error.to_string(),
            "the neighbour list of vertex 1 names vertex 2, but there are only 2, counted from 0"
        );
    }
}
