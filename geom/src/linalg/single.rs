//! Substitution for one right-hand side.
//!
//! The factor is read once, and reading it is most of the work. Large ones are read on several threads: subtrees of the elimination tree have
//! nothing to do with each other, and what they change above them is added up in their order. Which subtrees these are depends on the
//! factor alone, so that the bits are the same for any number of threads.

use std::ops::Range;

use super::cholesky::{Cholesky, dot};
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
    above: Vec<usize>,
    /// The steps of these.
    steps: Vec<u32>,
    /// Where a step is among them; `NONE` within subtrees.
    place: Vec<u32>,
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

    /// The subtrees with their parts of a vector, and vectors for what is above.
    fn parts<'a>(&self, elimination: &Elimination, mut x: &'a mut [f64], above: usize) -> Vec<Part<'a>> {
        let mut from = 0;
        let mut part = |tree: &Range<usize>| {
            let steps = steps(elimination, tree.clone());
            let (own, rest) = std::mem::take(&mut x)[steps.start - from..].split_at_mut(steps.len());
            (x, from) = (rest, steps.end);
            Part { tree: tree.clone(), from: steps.start, own, above: vec![0.0; above] }
        };
        self.trees.iter().map(&mut part).collect()
    }
}

/// A subtree's part of a vector.
struct Part<'a> {
    tree: Range<usize>,
    /// Its first step.
    from: usize,
    own: &'a mut [f64],
    /// What is added to the steps above.
    above: Vec<f64>,
}

/// The steps of some supernodes.
fn steps(elimination: &Elimination, supernodes: Range<usize>) -> Range<usize> {
    let last = supernodes.end - 1;
    elimination.first(supernodes.start)..elimination.first(last) + elimination.width(last)
}

impl Cholesky {
    /// x := C⁻¹ x
    pub(super) fn forward(&self, x: &mut [f64], watch: Watch) -> Result<(), Interrupted> {
        let Some(parted) = &self.parted else {
            return self.forward_through(0..self.elimination.len(), x, watch);
        };
        let mut parts = parted.parts(&self.elimination, x, parted.steps.len());
        watch.shared(|watch| {
            try_each(0, &mut parts, &|_, Part { tree, from, own, above }: &mut Part| {
                let mut change = Vec::new();
                for s in tree.clone() {
                    if let Some(done) = self.asks_at(s) {
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
        let changes: Vec<Vec<f64>> = parts.into_iter().map(|part| part.above).collect();
        for (k, &step) in parted.steps.iter().enumerate() {
            x[step as usize] += changes.iter().map(|change| change[k]).sum::<f64>();
        }
        self.forward_through(parted.above.iter().copied(), x, watch)
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
            if let Some(done) = self.asks_at(s) {
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
        let Some(parted) = &self.parted else {
            return self.backward_through(0..self.elimination.len(), x, watch);
        };
        self.backward_through(parted.above.iter().copied(), x, watch)?;
        let above: Vec<f64> = parted.steps.iter().map(|&step| x[step as usize]).collect();
        let mut parts = parted.parts(&self.elimination, x, 0);
        watch.shared(|watch| {
            try_each(0, &mut parts, &|_, Part { tree, from, own, .. }: &mut Part| {
                let mut below = Vec::new();
                for s in tree.clone().rev() {
                    if let Some(left) = self.asks_at(s) {
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
            if let Some(left) = self.asks_at(s) {
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
    fn asks_at(&self, s: usize) -> Option<f64> {
        let values = self.elimination.values(s);
        let asks = values.start / ASKED_AFTER != values.end / ASKED_AFTER;
        asks.then(|| values.start as f64 / self.elimination.value_count() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use crate::{Metric, laplacian};

    #[test]
    fn in_parts_or_not_both_passes_come_to_the_same_and_to_the_same_bits_on_any_number_of_threads() {
        for shape in [shapes::hare(3000), shapes::torus(3, 2000), shapes::terrain(900, 5)] {
            let mesh = shape.mesh();
            let mut matrix = laplacian(&mesh, &Metric::from_points(&mesh, &shape.points));
            (0..matrix.dimension()).for_each(|v| *matrix.diagonal_mut(v) += 1e-3);
            let mut cholesky = Cholesky::with_points(&matrix, &shape.points).unwrap();
            let b: Vec<f64> = (0..matrix.dimension()).map(|k| (k as f64 * 0.37).sin()).collect();
            let near = |x: &[f64], y: &[f64]| x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-9 * (1.0 + y.abs()));
            let passes = |cholesky: &Cholesky| -> [Vec<f64>; 2] {
                let (mut forward, mut backward) = (b.clone(), b.clone());
                cholesky.forward(&mut forward, Watch::NONE).unwrap();
                cholesky.backward(&mut backward, Watch::NONE).unwrap();
                [forward, backward]
            };
            assert!(cholesky.parted.is_none());
            let whole = passes(&cholesky);
            cholesky.parted = Parted::new(&cholesky.elimination, 0);
            let parted = cholesky.parted.as_ref().unwrap();
            assert!(parted.trees.len() > 3 && parted.above.len() > 1, "{parted:?}");
            let in_parts = passes(&cholesky);
            assert!((0..2).all(|k| near(&in_parts[k], &whole[k])));
            #[cfg(feature = "rayon")]
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                assert_eq!(pool.install(|| passes(&cholesky)), in_parts);
            }
        }
    }
}
