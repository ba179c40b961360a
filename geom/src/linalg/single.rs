//! Substitution for one right-hand side.
//!
//! The factor is read once, and reading it is most of the work. Large ones are read on several threads: subtrees of the elimination tree have
//! nothing to do with each other, and what they change above them is added up in their order. Which subtrees these are depends on the
//! factor alone, so that the bits are the same for any number of threads.

use std::ops::Range;

use super::elimination::{Elimination, NONE};
use crate::parallel::try_each;
use crate::watch::{Interrupted, Watch};

/// Factors of fewer values are read by one thread: a millisecond's work.
pub(super) const LEAST: usize = 1 << 20;
/// Subtrees have at most this part of the values each, where that can be.
const SHARE: usize = 8;
/// After so many values of the factor the watch is asked again: about a millisecond.
const ASKED_AFTER: usize = 1 << 20;

/// Subtrees of an elimination tree, and what is above them.
#[derive(Debug)]
pub(super) struct Parted {
    /// The supernodes of each subtree, ascending.
    trees: Vec<Range<usize>>,
    /// The others, ascending.
    pub(super) above: Vec<usize>,
    /// The steps of these.
    pub(super) steps: Vec<u32>,
    /// Where a step is among them; `NONE` within subtrees.
    pub(super) place: Vec<u32>,
}

impl Parted {
    /// None where there are fewer values than `least`.
    pub(super) fn new(elimination: &Elimination, least: usize) -> Option<Self> {
        let all = elimination.value_count();
        if all < least {
            return None;
        }
        let (mut trees, mut above, mut waiting) = (Vec::new(), Vec::new(), elimination.roots());
        while let Some(root) = waiting.pop() {
            if elimination.tree_values(root).len() > all / SHARE {
                above.push(root);
                waiting.extend(elimination.children(root));
            } else {
                trees.push(elimination.subtree(root));
            }
        }
        trees.sort_unstable_by_key(|tree| tree.start);
        above.sort_unstable();
        let steps: Vec<u32> = above.iter().flat_map(|&s| steps(elimination, s..s + 1)).map(|k| k as u32).collect();
        let mut place = vec![NONE; elimination.order.len()];
        steps.iter().zip(0..).for_each(|(&step, k)| place[step as usize] = k);
        Some(Self { trees, above, steps, place })
    }

    #[cfg(test)]
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.trees.len(), self.above.len()]
    }

    /// The subtrees with their parts of so many vectors, given step by step.
    pub(super) fn parts<'a>(&self, elimination: &Elimination, mut x: &'a mut [f64], columns: usize) -> Vec<Part<'a>> {
        let mut from = 0;
        let mut part = |tree: &Range<usize>| {
            let steps = steps(elimination, tree.clone());
            let before = (steps.start - from) * columns;
            let (own, rest) = std::mem::take(&mut x)[before..].split_at_mut(steps.len() * columns);
            (x, from) = (rest, steps.end);
            Part { tree: tree.clone(), from: steps.start, own }
        };
        self.trees.iter().map(&mut part).collect()
    }
}

/// A factor C, as it is read for one right-hand side.
#[derive(Clone, Copy)]
pub(super) struct Factor<'a> {
    pub(super) elimination: &'a Elimination,
    /// Supernode after supernode.
    pub(super) values: &'a [f64],
    /// None if it is read by one thread.
    pub(super) parted: Option<&'a Parted>,
}

/// A subtree's part of vectors.
pub(super) struct Part<'a> {
    pub(super) tree: Range<usize>,
    /// Its first step.
    pub(super) from: usize,
    pub(super) own: &'a mut [f64],
}

/// The steps of some supernodes.
fn steps(elimination: &Elimination, supernodes: Range<usize>) -> Range<usize> {
    let last = supernodes.end - 1;
    elimination.first(supernodes.start)..elimination.first(last) + elimination.width(last)
}

impl<'a> Factor<'a> {
    /// x := C⁻¹ x
    pub(super) fn forward(&self, x: &mut [f64], watch: Watch) -> Result<(), Interrupted> {
        let Some(parted) = self.parted else {
            return self.forward_through(0..self.elimination.len(), x, watch);
        };
        let mut parts = parted.parts(self.elimination, x, 1);
        let mut changes = vec![Vec::new(); parts.len()];
        let mut work: Vec<_> = parts.iter_mut().zip(&mut changes).collect();
        watch.within(0.0, 0.9).shared(|watch| {
            try_each(0, &mut work, &|_, (Part { tree, from, own }, above)| {
                **above = vec![0.0; parted.steps.len()];
                let mut change = Vec::new();
                for s in tree.clone() {
                    if let Some(done) = self.asks_at(s, ASKED_AFTER) {
                        watch.ask(done)?;
                    }
                    let first = self.elimination.first(s) - *from;
                    self.eliminate(s, &mut own[first..first + self.elimination.width(s)], &mut change);
                    for (&r, change) in self.elimination.rows(s).iter().zip(&change) {
                        match own.get_mut(r as usize - *from) {
                            Some(x) => *x -= change,
                            None => above[parted.place[r as usize] as usize] -= change,
                        }
                    }
                }
                Ok(())
            })
        })?;
        for (k, &step) in parted.steps.iter().enumerate() {
            x[step as usize] += changes.iter().map(|change| change[k]).sum::<f64>();
        }
        self.forward_through(parted.above.iter().copied(), x, watch.within(0.9, 1.0))
    }

    /// The same through the given supernodes, ascending.
    pub(super) fn forward_through(
        &self,
        supernodes: impl Iterator<Item = usize>,
        x: &mut [f64],
        watch: Watch,
    ) -> Result<(), Interrupted> {
        let mut change = Vec::new();
        for s in supernodes {
            if let Some(done) = self.asks_at(s, ASKED_AFTER) {
                watch.ask(done)?;
            }
            let first = self.elimination.first(s);
            self.eliminate(s, &mut x[first..first + self.elimination.width(s)], &mut change);
            let rows = self.elimination.rows(s);
            rows.iter().zip(&change).for_each(|(&r, change)| x[r as usize] -= change);
        }
        Ok(())
    }

    /// Eliminates the steps of a supernode; what is to be subtracted from its rows in `change`.
    fn eliminate(&self, s: usize, own: &mut [f64], change: &mut Vec<f64>) {
        let height = own.len() + self.elimination.rows(s).len();
        change.clear();
        change.resize(height - own.len(), 0.0);
        for (j, column) in self.panel(s).chunks_exact(height).enumerate() {
            own[j] /= column[j];
            let y = own[j];
            let (top, bottom) = column.split_at(own.len());
            own[j + 1..].iter_mut().zip(&top[j + 1..]).for_each(|(x, c)| *x -= c * y);
            change.iter_mut().zip(bottom).for_each(|(x, c)| *x += c * y);
        }
    }

    /// x := C⁻ᵀ x
    pub(super) fn backward(&self, x: &mut [f64], watch: Watch) -> Result<(), Interrupted> {
        let Some(parted) = self.parted else {
            return self.backward_through(0..self.elimination.len(), x, watch);
        };
        self.backward_through(parted.above.iter().copied(), x, watch.within(0.0, 0.1))?;
        let above: Vec<f64> = parted.steps.iter().map(|&step| x[step as usize]).collect();
        let mut parts = parted.parts(self.elimination, x, 1);
        watch.within(0.1, 1.0).shared(|watch| {
            try_each(0, &mut parts, &|_, Part { tree, from, own }| {
                let mut below = Vec::new();
                for s in tree.clone().rev() {
                    if let Some(left) = self.asks_at(s, ASKED_AFTER) {
                        watch.ask(1.0 - left)?;
                    }
                    let there = |&r: &u32| match own.get(r as usize - *from) {
                        Some(x) => *x,
                        None => above[parted.place[r as usize] as usize],
                    };
                    below.clear();
                    below.extend(self.elimination.rows(s).iter().map(there));
                    let first = self.elimination.first(s) - *from;
                    self.substitute_back(s, &mut own[first..first + self.elimination.width(s)], &below);
                }
                Ok(())
            })
        })
    }

    /// The same through the given supernodes, given ascending.
    fn backward_through(
        &self,
        supernodes: impl DoubleEndedIterator<Item = usize>,
        x: &mut [f64],
        watch: Watch,
    ) -> Result<(), Interrupted> {
        let mut below = Vec::new();
        for s in supernodes.rev() {
            if let Some(left) = self.asks_at(s, ASKED_AFTER) {
                watch.ask(1.0 - left)?;
            }
            below.clear();
            below.extend(self.elimination.rows(s).iter().map(|&r| x[r as usize]));
            let first = self.elimination.first(s);
            self.substitute_back(s, &mut x[first..first + self.elimination.width(s)], &below);
        }
        Ok(())
    }

    /// Finds the steps of a supernode from what is in its rows.
    fn substitute_back(&self, s: usize, own: &mut [f64], below: &[f64]) {
        let columns = self.panel(s).chunks_exact(own.len() + below.len());
        for (j, column) in columns.enumerate().rev() {
            let (top, bottom) = column.split_at(own.len());
            let sum = dot(&top[j + 1..], &own[j + 1..]) + dot(bottom, below);
            own[j] = (own[j] - sum) / column[j];
        }
    }

    /// The share of the values before a supernode, where the watch is to be asked: if it has some beyond the next multiple of so many.
    pub(super) fn asks_at(&self, s: usize, after: usize) -> Option<f64> {
        let values = self.elimination.values(s);
        let asks = values.start / after != values.end / after;
        asks.then(|| values.start as f64 / self.elimination.value_count() as f64)
    }

    /// The values of a supernode, column after column.
    pub(super) fn panel(&self, s: usize) -> &'a [f64] {
        &self.values[self.elimination.values(s)]
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; 8];
    let (a, a_tail) = a.as_chunks::<8>();
    let (b, b_tail) = b.as_chunks::<8>();
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            sum[k] += a[k] * b[k];
        }
    }
    let tail: f64 = a_tail.iter().zip(b_tail).map(|(a, b)| a * b).sum();
    sum.iter().sum::<f64>() + tail
}
