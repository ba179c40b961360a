//! The values of a Cholesky factor, front by front.
//!
//! The factorization is *multifrontal* (Duff & Reid 1983; Liu 1992): each supernode gathers what its children leave behind in a
//! dense front, eliminates its own steps there, and leaves the rest, its *update*, to its parent. Since supernodes come in
//! postorder, a subtree of them is in one piece, and updates wait on a stack. On Laplacians of surfaces this takes about half the
//! time of faer's supernodal factorization, which is the oracle in the tests.
//!
//! Subtrees have nothing to do with each other, so they are factored in parallel: trees of more than [`GRAIN`] values are parted
//! at their roots, and dense work in large fronts is shared too. A front adds the updates of its children in their order, whoever
//! made them.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use super::elimination::Elimination;
use super::error::CholeskyError;
use super::front::Eliminator;
use super::symmetric::SymmetricMatrix;
use crate::parallel::{join, try_each};
use crate::rows::Rows;
use crate::watch::{Progress, Watch};

/// Subtrees with fewer values of the factor than this are not parted: some hundred microseconds of work.
const GRAIN: usize = 1 << 16;
/// After so many multiplications in fronts the watch is asked again: about a millisecond.
const ASKED_AFTER: usize = 1 << 20;

/// The places of the entries of so many columns are found one after the other: some hundred microseconds.
const COLUMNS: usize = 1 << 12;

/// How many matrices have been factored.
static FACTORIZATIONS: AtomicUsize = AtomicUsize::new(0);

/// How many matrices this process has begun to factor, to check what costs a factorization and what does not.
pub fn factorizations() -> usize {
    FACTORIZATIONS.load(Relaxed)
}

/// Where the entries of a matrix are in the factor: for each supernode the places among its values, each with the
/// entry that belongs there.
#[derive(Debug)]
pub(crate) struct Entries(Rows<(u32, u32)>);

impl Entries {
    pub(crate) fn new(
        matrix: &SymmetricMatrix,
        elimination: &Elimination,
        watch: Watch,
    ) -> Result<Self, CholeskyError> {
        let mut places = vec![(0, 0); matrix.stored()];
        let mut blocks = Vec::new();
        let mut rest = places.as_mut_slice();
        for first in (0..matrix.dimension()).step_by(COLUMNS) {
            let columns = first..matrix.dimension().min(first + COLUMNS);
            let stored = matrix.range(columns.end - 1).end - matrix.range(first).start;
            let block;
            (block, rest) = rest.split_at_mut(stored);
            blocks.push((columns, block));
        }
        watch.shared(|watch| {
            try_each(0, &mut blocks, &|k, (columns, places)| {
                watch.ask((k * COLUMNS) as f64 / matrix.dimension() as f64)?;
                find_places(matrix, elimination, columns.clone(), places)
            })
        })?;
        let entries = places.into_iter().zip(0..).map(|((s, place), k)| (s as usize, (place, k)));
        Ok(Self(Rows::sorted(elimination.len(), entries)))
    }
}

/// For each entry of some columns its supernode, and its place among the values of that.
fn find_places(
    matrix: &SymmetricMatrix,
    elimination: &Elimination,
    columns: std::ops::Range<usize>,
    places: &mut [(u32, u32)],
) -> Result<(), CholeskyError> {
    let entries = columns.flat_map(|column| matrix.range(column).map(move |k| (column as u32, matrix.row[k])));
    for (found, (column, row)) in places.iter_mut().zip(entries) {
        let (s, place) = elimination.place(column, row);
        *found = (s as u32, u32::try_from(place).map_err(|_| CholeskyError::OutOfMemory(matrix.dimension()))?);
    }
    Ok(())
}

/// Fills in the values of the factor of a matrix whose entries are given.
pub(crate) fn factor(
    elimination: &Elimination,
    entries: &Entries,
    entry: &[f64],
    values: &mut [f64],
    watch: Watch,
) -> Result<(), CholeskyError> {
    FACTORIZATIONS.fetch_add(1, Relaxed);
    let progress = Progress::new(watch, values.len());
    progress.ask()?;
    let factorization = Factorization { elimination, entries, entry, progress };
    factorization.trees(&elimination.roots(), values)?;
    Ok(())
}

struct Factorization<'a> {
    elimination: &'a Elimination,
    entries: &'a Entries,
    entry: &'a [f64],
    progress: Progress<'a>,
}

/// What subtrees leave behind: the updates of their roots, one after the other.
#[derive(Default)]
struct Updates {
    roots: Vec<usize>,
    values: Vec<f64>,
}

impl Factorization<'_> {
    /// Factors neighbouring subtrees, given by their roots.
    fn trees(&self, roots: &[usize], values: &mut [f64]) -> Result<Vec<Updates>, CholeskyError> {
        let Some((&first, &last)) = roots.first().zip(roots.last()) else { return Ok(Vec::new()) };
        if values.len() <= GRAIN {
            return Ok(vec![self.in_postorder(self.elimination.subtree(first).start..last + 1, values)?]);
        }
        if roots.len() == 1 {
            return Ok(vec![self.tree(last, values)?]);
        }
        let from = self.elimination.tree_values(first).start;
        let end = |k: usize| self.elimination.tree_values(roots[k]).end - from;
        let half = (0..roots.len() - 1).min_by_key(|&k| end(k).abs_diff(values.len() / 2)).unwrap_or(0);
        let (low, high) = values.split_at_mut(end(half));
        let (mid, rest) = roots.split_at(half + 1);
        let (low, high) = join(|| self.trees(mid, low), || self.trees(rest, high));
        let mut updates = low?;
        updates.extend(high?);
        Ok(updates)
    }

    /// Factors a large subtree. Where of the children of its root, of their children and so on only one is large, it goes down to the last
    /// of these and up again, so that a recursion is as deep as there are forks.
    fn tree(&self, root: usize, values: &mut [f64]) -> Result<Updates, CholeskyError> {
        let from = self.elimination.tree_values(root).start;
        let is_large = |s: &usize| self.elimination.tree_values(*s).len() > GRAIN;
        let mut way = vec![root];
        let mut children = self.elimination.children(root);
        while let [only] = children.iter().copied().filter(is_large).collect::<Vec<_>>()[..] {
            way.push(only);
            children = self.elimination.children(only);
        }
        let mut done: Option<Updates> = None;
        for &s in way.iter().rev() {
            let children = self.elimination.children(s);
            let tree = self.elimination.tree_values(s);
            let values = &mut values[tree.start - from..tree.end - from];
            let (below, panel) = values.split_at_mut(self.elimination.values(s).start - tree.start);
            let updates = match done.take() {
                None => self.trees(&children, below)?,
                Some(known) => {
                    let known_root = known.roots[0];
                    let at = children.partition_point(|&child| child < known_root);
                    let range = self.elimination.tree_values(known_root);
                    let (low, rest) = below.split_at_mut(range.start - tree.start);
                    let high = &mut rest[range.len()..];
                    let (low, high) =
                        join(|| self.trees(&children[..at], low), || self.trees(&children[at + 1..], high));
                    let mut updates = low?;
                    updates.push(known);
                    updates.extend(high?);
                    updates
                }
            };
            done = Some(Updates { roots: vec![s], values: self.front(s, updates, panel)? });
        }
        Ok(done.unwrap_or_default())
    }

    /// Eliminates the steps of a supernode of a large tree; returns its update.
    fn front(&self, s: usize, children: Vec<Updates>, panel: &mut [f64]) -> Result<Vec<f64>, CholeskyError> {
        let (width, rest) = (self.elimination.width(s), self.elimination.rows(s).len());
        self.progress.ask()?;
        self.fill(s, panel);
        let mut update = Vec::with_capacity(rest * rest);
        update.resize(rest * rest, 0.0);
        let mut front = Front { panel, update: &mut update, width, rest };
        for updates in children {
            front.add_all(self.elimination, &updates.roots, &updates.values);
        }
        if !Eliminator::new().eliminate_large(front.panel, width + rest, front.update) {
            return Err(CholeskyError::NotPositiveDefinite);
        }
        self.progress.add(front.panel.len());
        Ok(update)
    }

    /// Factors a range of supernodes that is one or more whole subtrees.
    fn in_postorder(&self, range: std::ops::Range<usize>, values: &mut [f64]) -> Result<Updates, CholeskyError> {
        let elimination = self.elimination;
        let mut updates = Updates::default();
        updates.values.reserve(most_updates(elimination, range.clone()));
        let mut eliminator = Eliminator::new();
        let mut work = 0;
        let mut panels = values;
        for s in range {
            let (width, rest) = (elimination.width(s), elimination.rows(s).len());
            work += width * (width + rest).pow(2);
            if work > ASKED_AFTER {
                self.progress.ask()?;
                work = 0;
            }
            let panel;
            (panel, panels) = std::mem::take(&mut panels).split_at_mut(elimination.values(s).len());
            self.fill(s, panel);
            let Updates { roots, values } = &mut updates;
            let children = roots.partition_point(|&child| elimination.parent(child) != Some(s));
            let begin = values.len() - roots[children..].iter().map(|&c| update_len(elimination, c)).sum::<usize>();
            let end = values.len();
            values.resize(end + rest * rest, 0.0);
            let (from_children, update) = values[begin..].split_at_mut(end - begin);
            let mut front = Front { panel, update, width, rest };
            front.add_all(elimination, &roots[children..], from_children);
            if !eliminator.eliminate(front.panel, width + rest, front.update) {
                return Err(CholeskyError::NotPositiveDefinite);
            }
            values.copy_within(end.., begin);
            values.truncate(begin + rest * rest);
            roots.truncate(children);
            if rest > 0 {
                roots.push(s);
            }
            self.progress.add(width * (width + rest));
        }
        Ok(updates)
    }

    /// Puts the entries of the matrix into the values of a supernode.
    fn fill(&self, s: usize, panel: &mut [f64]) {
        // New memory, too: where it is read first, as by a sum, the system maps it twice, and has all threads forget the first place.
        panel.fill(0.0);
        for &(place, k) in self.entries.0.row(s) {
            panel[place as usize] += self.entry[k as usize];
        }
    }
}

/// The dense matrix of a supernode's steps and rows: the panel of its steps' columns, and the square of the rest. Of both
/// the lower triangle counts.
struct Front<'a> {
    panel: &'a mut [f64],
    update: &'a mut [f64],
    width: usize,
    rest: usize,
}

impl Front<'_> {
    /// Adds the updates of children, which follow each other.
    fn add_all(&mut self, elimination: &Elimination, children: &[usize], mut updates: &[f64]) {
        for &child in children {
            let (from_child, others) = updates.split_at(update_len(elimination, child));
            self.add(from_child, elimination.rows_in_parent(child));
            updates = others;
        }
    }

    /// Adds the update that a child left behind, whose rows are at the given places.
    fn add(&mut self, from_child: &[f64], places: &[u32]) {
        let height = self.width + self.rest;
        for (j, column) in from_child.chunks_exact(places.len()).enumerate() {
            let place = places[j] as usize;
            let (target, skipped) = match place.checked_sub(self.width) {
                None => (&mut self.panel[place * height..][..height], 0),
                Some(place) => (&mut self.update[place * self.rest..][..self.rest], self.width),
            };
            for (&place, x) in places[j..].iter().zip(&column[j..]) {
                target[place as usize - skipped] += x;
            }
        }
    }
}

fn update_len(elimination: &Elimination, s: usize) -> usize {
    elimination.rows(s).len().pow(2)
}

/// How many values of updates there are at most while a range of supernodes is factored.
fn most_updates(elimination: &Elimination, range: std::ops::Range<usize>) -> usize {
    let mut waiting: Vec<usize> = Vec::new();
    let (mut now, mut most) = (0, 0);
    for s in range {
        most = most.max(now + update_len(elimination, s));
        while waiting.last().is_some_and(|&child| elimination.parent(child) == Some(s)) {
            now -= waiting.pop().map_or(0, |child| update_len(elimination, child));
        }
        waiting.push(s);
        now += update_len(elimination, s);
    }
    most
}
