//! Disjoint sets whose root is their eldest member.
//!
//! No ranks: the root carries the meaning (it is the extremum at which the component was born), so unions are directed
//! and path halving alone keeps finds short: O(log n) amortised, in practice constant.

/// Sets of the numbers `0..n`.
#[derive(Debug, Clone)]
pub(crate) struct UnionFind {
    parent: Vec<u32>,
}

impl UnionFind {
    /// `n` sets of one member each.
    pub(crate) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// How many members there are.
    pub(crate) fn len(&self) -> usize {
        self.parent.len()
    }

    /// The eldest member of the set of `v`.
    pub(crate) fn find(&mut self, mut v: u32) -> u32 {
        while self.parent[v as usize] != v {
            let up = self.parent[self.parent[v as usize] as usize];
            self.parent[v as usize] = up;
            v = up;
        }
        v
    }

    /// Puts the set of the root `younger` under the root `elder`.
    pub(crate) fn join(&mut self, younger: u32, elder: u32) {
        debug_assert!(self.parent[younger as usize] == younger && self.parent[elder as usize] == elder);
        self.parent[younger as usize] = elder;
    }
}
