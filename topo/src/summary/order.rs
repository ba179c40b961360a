//! A domain whose vertices are numbered in the order of their names.
//!
//! Ties are broken by index. In a block they are to be broken as in the whole domain, so its vertices have to be numbered
//! by rising name; where they are not, they are renumbered.

use crate::domain::Domain;
use crate::error::Error;

/// The vertices of a block by rising name.
#[derive(Debug)]
pub(super) struct Order {
    /// The index of each before.
    before: Vec<u32>,
    /// The place of each index among the names.
    rank: Vec<u32>,
}

impl Order {
    /// From the name of each vertex.
    pub(super) fn by(names: &[u64]) -> Result<Self, Error> {
        let name = |v: u32| names[v as usize];
        let mut before: Vec<u32> = (0..names.len() as u32).collect();
        before.sort_unstable_by_key(|&v| name(v));
        if let Some(twice) = before.windows(2).find(|two| name(two[0]) == name(two[1])) {
            return Err(Error::Twice { vertex: name(twice[0]) });
        }
        let mut rank = vec![0; names.len()];
        before.iter().zip(0..).for_each(|(&v, place)| rank[v as usize] = place);
        Ok(Self { before, rank })
    }

    /// How many vertices there are.
    pub(super) fn len(&self) -> usize {
        self.before.len()
    }

    /// The index that a vertex had.
    pub(super) fn before(&self, vertex: u32) -> u32 {
        self.before[vertex as usize]
    }

    /// The new index of a vertex.
    pub(super) fn rank(&self, before: u32) -> u32 {
        self.rank[before as usize]
    }

    /// Values by new index.
    pub(super) fn sorted<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.before.iter().map(|&v| values[v as usize]).collect()
    }
}

/// A domain with its vertices in another order.
#[derive(Debug, Clone, Copy)]
pub(super) struct Renumbered<'a, G> {
    pub(super) domain: G,
    pub(super) order: &'a Order,
}

impl<G: Domain> Domain for &Renumbered<'_, G> {
    type Vertex = usize;

    fn vertex_count(&self) -> usize {
        self.domain.vertex_count()
    }

    fn vertex(&self, index: usize) -> usize {
        index
    }

    fn for_each_neighbor(&self, index: usize, mut visit: impl FnMut(usize)) {
        self.domain
            .for_each_neighbor(self.order.before(index as u32) as usize, |u| visit(self.order.rank(u as u32) as usize));
    }
}
