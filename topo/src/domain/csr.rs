//! Graphs in the caller's own compressed rows, as sparse matrices have them.

use super::graph::Domain;
use super::rows::vertex_index;
use crate::error::{Error, check_vertex_count};
use num_traits::PrimInt;

/// An undirected graph as a compressed sparse matrix: the neighbours of vertex v are `indices[starts[v]..starts[v + 1]]`. The arrays
/// are borrowed, of integers of any type, and not copied. Where the matrix has values these are not asked for.
///
/// ```
/// // 0 – 1 – 2, as scipy.sparse.csr_matrix has it in `indptr` and `indices`.
/// let (indptr, indices) = ([0i64, 1, 3, 4], [1i32, 0, 2, 1]);
/// let graph = topo::CsrGraph::new(&indptr, &indices)?;
/// assert_eq!(topo::superlevel(&graph, &[4, 1, 3])?.len(), 2);
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CsrGraph<'a, P, I> {
    starts: &'a [P],
    indices: &'a [I],
}

impl<'a, P: PrimInt, I: PrimInt> CsrGraph<'a, P, I> {
    /// A graph of one vertex fewer than there are starts. O(n + m) for n vertices and m entries, without memory.
    ///
    /// Each edge must be there from both of its ends, and as often, as in a symmetric matrix; for others see
    /// [`Adjacency::new`](crate::Adjacency::new). That is seen from a sum of 64-bit hashes of all entries, in which those of both
    /// directions cancel.
    ///
    /// # Errors
    /// If starts do not rise from 0 to the number of indices, if an index is not a vertex, or if an edge is there from one end only.
    pub fn new(starts: &'a [P], indices: &'a [I]) -> Result<Self, Error> {
        let vertices = starts.len().saturating_sub(1);
        check_vertex_count(vertices)?;
        check_starts(starts, indices.len())?;
        let graph = Self { starts, indices };
        let mut balance = 0u64;
        for of in 0..vertices {
            for &neighbor in graph.row(of) {
                let to = vertex_index(neighbor, vertices).map_err(|vertex| Error::Neighbor { of, vertex, vertices })?;
                balance = balance.wrapping_add(hash(of as u32, to)).wrapping_sub(hash(to, of as u32));
            }
        }
        if balance == 0 { Ok(graph) } else { Err(graph.one_way()) }
    }

    fn row(&self, vertex: usize) -> &'a [I] {
        let [start, end] = [vertex, vertex + 1].map(|at| self.starts[at].to_usize().unwrap_or(0));
        &self.indices[start..end]
    }

    /// Names an edge that is not there as often from its other end.
    fn one_way(&self) -> Error {
        let count = |of: usize, to: usize| self.row(of).iter().filter(|index| index.to_usize() == Some(to)).count();
        let mut entries = (0..self.starts.len() - 1).flat_map(|of| self.row(of).iter().map(move |&to| (of, to)));
        let lone = entries.find_map(|(of, to)| {
            let to = to.to_usize()?;
            (count(of, to) != count(to, of)).then_some((of, to))
        });
        let (from, to) = lone.expect("a sum of hashes that cancel is zero");
        Error::OneWay { from, to }
    }
}

fn check_starts<P: PrimInt>(starts: &[P], indices: usize) -> Result<(), Error> {
    let mut last = 0;
    for (row, start) in starts.iter().enumerate() {
        let rises = |start: &usize| *start >= last && *start <= indices && (row > 0 || *start == 0);
        last = start.to_usize().filter(rises).ok_or(Error::Rows { row })?;
    }
    if last == indices { Ok(()) } else { Err(Error::Rows { row: starts.len().saturating_sub(1) }) }
}

/// A number for each direction of an edge that looks random (the finaliser of `SplitMix64`).
fn hash(from: u32, to: u32) -> u64 {
    let mut bits = (u64::from(from) << 32 | u64::from(to)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ bits >> 31
}

impl<P: PrimInt, I: PrimInt> Domain for &CsrGraph<'_, P, I> {
    type Vertex = usize;

    fn vertex_count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    fn vertex(&self, index: usize) -> usize {
        index
    }

    #[inline]
    fn for_each_neighbor(&self, index: usize, visit: impl FnMut(usize)) {
        self.row(index).iter().filter_map(|neighbor| neighbor.to_usize()).for_each(visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_cannot_be_are_named() {
        let refused = |starts: &[i32], indices: &[i64]| CsrGraph::new(starts, indices).expect_err("refused");
        assert_eq!(refused(&[1, 2], &[0, 0]), Error::Rows { row: 0 });
        assert_eq!(refused(&[0, 2, 1, 2], &[0, 0]), Error::Rows { row: 2 });
        assert_eq!(refused(&[0, 1], &[0, 0]), Error::Rows { row: 1 });
        assert_eq!(refused(&[0, -1], &[]), Error::Rows { row: 1 });
        assert_eq!(refused(&[], &[0]), Error::Rows { row: 0 });
        assert_eq!(refused(&[0, 1], &[-3]), Error::Neighbor { of: 0, vertex: -3, vertices: 1 });
        assert_eq!(refused(&[0, 1, 1], &[1]), Error::OneWay { from: 0, to: 1 });
        assert_eq!(refused(&[0, 2, 3], &[1, 1, 0]), Error::OneWay { from: 0, to: 1 });
        for starts in [&[][..], &[0u8]] {
            let empty = CsrGraph::new(starts, &[0u8; 0]).expect("no vertices");
            assert_eq!((&empty).vertex_count(), 0);
        }
    }
}
