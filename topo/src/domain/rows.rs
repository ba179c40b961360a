//! Lists of different lengths, one behind the other; and vertices named by any integer.

use crate::error::{Error, check_vertex_count};
use num_traits::PrimInt;

/// A list for each vertex.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Rows<T> {
    /// Where the list of each vertex begins, and the end of the last.
    starts: Vec<usize>,
    items: Vec<T>,
}

impl<T: Copy + Default> Rows<T> {
    /// Sorts things, which come several at a time, by the vertex they belong to; those of one vertex keep their order. They are gone
    /// through twice.
    pub(super) fn sorted<const N: usize>(vertices: usize, things: impl Iterator<Item = [(u32, T); N]> + Clone) -> Self {
        // Counted two places on, and filled one place on, so that each start ends up where the list before has been filled to.
        let mut starts = vec![0; vertices + 2];
        things.clone().for_each(|things| things.iter().for_each(|&(of, _)| starts[of as usize + 2] += 1));
        for v in 0..vertices {
            starts[v + 2] += starts[v + 1];
        }
        let mut items = vec![T::default(); starts[vertices + 1]];
        things.for_each(|things| {
            for &(of, thing) in &things {
                let place = &mut starts[of as usize + 1];
                items[*place] = thing;
                *place += 1;
            }
        });
        starts.pop();
        Self { starts, items }
    }

    /// How many lists there are.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The list of a vertex.
    pub(super) fn of(&self, vertex: usize) -> &[T] {
        &self.items[self.starts[vertex]..self.starts[vertex + 1]]
    }
}

impl<T: Copy + Default> Rows<[T; 2]> {
    /// With each list of twos replaced by the firsts of them, if `order` has put these in order and says so, or by what it has appended to an
    /// empty list, which must not take more room. What is new stays where lists were.
    pub(super) fn flattened(self, mut order: impl FnMut(&mut [[T; 2]], &mut Vec<T>) -> bool) -> Rows<T> {
        let Self { mut starts, items } = self;
        let mut items = items.into_flattened();
        let (mut kept, mut made) = (0, Vec::new());
        for v in 0..starts.len() - 1 {
            let list = 2 * starts[v]..2 * starts[v + 1];
            starts[v] = kept;
            made.clear();
            if order(items[list.clone()].as_chunks_mut().0, &mut made) {
                for first in list.step_by(2) {
                    items[kept] = items[first];
                    kept += 1;
                }
            } else {
                items[kept..kept + made.len()].copy_from_slice(&made);
                kept += made.len();
            }
        }
        *starts.last_mut().expect("there is one start more than there are vertices") = kept;
        items.truncate(kept);
        items.shrink_to_fit();
        Rows { starts, items }
    }
}

impl<T: Copy + Ord> Rows<T> {
    /// Sorts each list and keeps each thing once.
    pub(super) fn without_repetitions(mut self) -> Self {
        let mut kept = 0;
        for v in 0..self.starts.len() - 1 {
            let list = self.starts[v]..self.starts[v + 1];
            self.items[list.clone()].sort_unstable();
            self.starts[v] = kept;
            for place in list {
                let thing = self.items[place];
                if kept == self.starts[v] || self.items[kept - 1] != thing {
                    self.items[kept] = thing;
                    kept += 1;
                }
            }
        }
        *self.starts.last_mut().expect("there is one start more than there are vertices") = kept;
        self.items.truncate(kept);
        self
    }
}

/// The index of a vertex that some integer names; what it names instead if there is none.
pub(crate) fn vertex_index<I: PrimInt>(named: I, vertices: usize) -> Result<u32, i128> {
    let index = named.to_u32().filter(|&index| (index as usize) < vertices);
    index.ok_or_else(|| named.to_i128().unwrap_or(i128::MAX))
}

/// Checks both ends of all edges.
pub(crate) fn check_edges<I: PrimInt>(vertices: usize, edges: impl Iterator<Item = [I; 2]>) -> Result<(), Error> {
    check_vertex_count(vertices)?;
    for (edge, ends) in edges.enumerate() {
        for end in ends {
            vertex_index(end, vertices).map_err(|vertex| Error::Edge { edge, vertex, vertices })?;
        }
    }
    Ok(())
}

/// The index of a vertex that is known to exist.
pub(crate) fn known<I: PrimInt>(named: I) -> u32 {
    named.to_u32().expect("indices have been checked")
}
