//! Sparse Cholesky factorization of a symmetric positive definite matrix, kept for many solves.
//!
//! The factorization is *multifrontal* (Duff & Reid 1983; Liu 1992): each supernode gathers what its children leave behind in a
//! dense front, eliminates its own steps there, and leaves the rest, its *update*, to its parent. Since supernodes come in
//! postorder, updates wait on a stack. On Laplacians of surfaces this takes two thirds of the time of faer's supernodal
//! factorization, which is the oracle in the tests; both run on one thread (more gain nothing at these sizes).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::dissection::dissect;
use crate::elimination::{Elimination, Graph};
use crate::front::Eliminator;
use crate::poisson::PoissonError;

/// So many right-hand sides are solved for at once.
const BLOCK: usize = 16;

/// The lower triangle of a symmetric matrix, by columns with sorted rows.
#[derive(Debug)]
pub(crate) struct LowerTriangle {
    pub(crate) column_start: Vec<u32>,
    pub(crate) row: Vec<u32>,
    pub(crate) value: Vec<f64>,
}

impl LowerTriangle {
    pub(crate) fn dimension(&self) -> usize {
        self.column_start.len() - 1
    }

    fn column(&self, column: usize) -> std::ops::Range<usize> {
        self.column_start[column] as usize..self.column_start[column + 1] as usize
    }

    fn graph(&self) -> Graph {
        Graph::of_lower_triangle(&self.column_start, &self.row)
    }

    /// An order of elimination by approximate minimum degree (Amestoy, Davis & Duff 1996).
    fn minimum_degree(&self) -> Result<Vec<u32>, PoissonError> {
        let n = self.dimension();
        let (mut order, mut step) = (vec![0; n], vec![0; n]);
        let mut scratch = MemBuffer::new(amd::order_scratch::<u32>(n, self.row.len()));
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.column_start, None, &self.row);
        amd::order(&mut order, &mut step, pattern, Default::default(), MemStack::new(&mut scratch))
            .map_err(|_| PoissonError::OutOfMemory(n))?;
        Ok(order)
    }
}

/// C Cᵀ = P A Pᵀ.
#[derive(Debug)]
pub(crate) struct Cholesky {
    matrix: LowerTriangle,
    elimination: Elimination,
    /// Where each entry of the matrix is in the factor.
    place: Vec<usize>,
    factor: Vec<f64>,
}

impl Cholesky {
    /// Orders, analyses and factors a matrix: by nested dissection where points are given, one for each row; else by
    /// approximate minimum degree.
    pub(crate) fn new(matrix: LowerTriangle, points: Option<&[[f32; 3]]>) -> Result<Self, PoissonError> {
        let graph = matrix.graph();
        let order = match points {
            Some(points) => dissect(&graph, points),
            None => matrix.minimum_degree()?,
        };
        Self::in_order(matrix, &graph, &order)
    }

    /// Factors another matrix of the same dimension in the same order.
    pub(crate) fn another(&self, matrix: LowerTriangle) -> Result<Self, PoissonError> {
        let graph = matrix.graph();
        Self::in_order(matrix, &graph, &self.elimination.order)
    }

    fn in_order(matrix: LowerTriangle, graph: &Graph, order: &[u32]) -> Result<Self, PoissonError> {
        let elimination = Elimination::new(graph, order);
        let column = |c: usize| matrix.row[matrix.column(c)].iter().map(move |&r| (c as u32, r));
        let place =
            (0..matrix.dimension()).flat_map(column).map(|(column, row)| elimination.place(column, row)).collect();
        let mut cholesky = Self { matrix, elimination, place, factor: Vec::new() };
        cholesky.factor_values()?;
        Ok(cholesky)
    }

    /// Factors another matrix of the same dimension: the analysis is kept where the pattern is the same, the order in any
    /// case (it stays good while a few edges flip).
    pub(crate) fn refactor(&mut self, matrix: LowerTriangle) -> Result<(), PoissonError> {
        if matrix.column_start == self.matrix.column_start && matrix.row == self.matrix.row {
            self.matrix.value = matrix.value;
            return self.factor_values();
        }
        // The old factor goes before the new one is made: at peak there is one.
        self.factor = Vec::new();
        *self = self.another(matrix)?;
        Ok(())
    }

    fn factor_values(&mut self) -> Result<(), PoissonError> {
        let Self { matrix, elimination, place, factor } = self;
        let out_of_memory = |_| PoissonError::OutOfMemory(matrix.dimension());
        factor.clear();
        factor.try_reserve_exact(elimination.value_count()).map_err(out_of_memory)?;
        factor.resize(elimination.value_count(), 0.0);
        for (&place, value) in place.iter().zip(&matrix.value) {
            factor[place] += value;
        }
        let mut updates: Vec<f64> = Vec::new();
        updates.try_reserve_exact(most_updates(elimination)).map_err(out_of_memory)?;
        let mut waiting: Vec<usize> = Vec::new();
        let mut eliminator = Eliminator::new();
        for s in 0..elimination.len() {
            let (width, rest) = (elimination.width(s), elimination.rows(s).len());
            let children = waiting.partition_point(|&child| elimination.parent(child) != Some(s));
            let begin = updates.len() - waiting[children..].iter().map(|&c| update_len(elimination, c)).sum::<usize>();
            let end = updates.len();
            updates.resize(end + rest * rest, 0.0);
            let (mut from_children, update) = updates[begin..].split_at_mut(end - begin);
            let mut front = Front { panel: &mut factor[elimination.values(s)], update, width, rest };
            for child in waiting.drain(children..) {
                let (from_child, others) = from_children.split_at_mut(update_len(elimination, child));
                front.add(from_child, elimination.rows_in_parent(child));
                from_children = others;
            }
            if !eliminator.eliminate(front.panel, width + rest, front.update) {
                return Err(PoissonError::NotPositiveDefinite);
            }
            updates.copy_within(end.., begin);
            updates.truncate(begin + rest * rest);
            if rest > 0 {
                waiting.push(s);
            }
        }
        Ok(())
    }

    /// Solves A x = b for each of the columns of `b`, in place.
    pub(crate) fn solve_in_place(&self, b: &mut [f64]) {
        let n = self.matrix.dimension();
        if n == 0 {
            return;
        }
        for block in b.chunks_mut(n * BLOCK) {
            if block.len() == n {
                let mut x: Vec<f64> = self.elimination.order.iter().map(|&v| block[v as usize]).collect();
                self.forward(&mut x, 0..self.elimination.len());
                self.backward(&mut x);
                self.elimination.order.iter().zip(x).for_each(|(&v, x)| block[v as usize] = x);
            } else {
                self.solve_block(block);
            }
        }
    }

    /// C⁻¹ e for a unit vector: its nonzero entries, by step. Only the supernodes on the way to the root of the elimination
    /// tree take part.
    pub(crate) fn half_solve(&self, row: u32, x: &mut Vec<f64>) -> Vec<(u32, f64)> {
        let elimination = &self.elimination;
        let step = elimination.step[row as usize] as usize;
        x.resize(elimination.order.len(), 0.0);
        x[step] = 1.0;
        let start = elimination.supernode[step] as usize;
        let path = || std::iter::successors(Some(start), |&s| elimination.parent(s));
        self.forward(x, path());
        let mut entries = Vec::new();
        for s in path() {
            let from = elimination.first(s);
            for k in from..from + elimination.width(s) {
                let entry = std::mem::take(&mut x[k]);
                if entry != 0.0 {
                    entries.push((k as u32, entry));
                }
            }
        }
        entries
    }

    /// C⁻ᵀ y.
    pub(crate) fn half_solve_back(&self, mut y: Vec<f64>) -> Vec<f64> {
        self.backward(&mut y);
        self.elimination.step.iter().map(|&k| y[k as usize]).collect()
    }

    /// x := C⁻¹ x through the given supernodes.
    fn forward(&self, x: &mut [f64], supernodes: impl Iterator<Item = usize>) {
        let mut change = Vec::new();
        for s in supernodes {
            let (first, width, rows) = self.steps_and_rows(s);
            change.clear();
            change.resize(rows.len(), 0.0);
            let own = &mut x[first..first + width];
            for (j, column) in self.factor[self.elimination.values(s)].chunks_exact(width + rows.len()).enumerate() {
                own[j] /= column[j];
                let y = own[j];
                let (top, bottom) = column.split_at(width);
                own[j + 1..].iter_mut().zip(&top[j + 1..]).for_each(|(x, c)| *x -= c * y);
                change.iter_mut().zip(bottom).for_each(|(x, c)| *x += c * y);
            }
            rows.iter().zip(&change).for_each(|(&r, change)| x[r as usize] -= change);
        }
    }

    /// x := C⁻ᵀ x
    fn backward(&self, x: &mut [f64]) {
        let mut below = Vec::new();
        for s in (0..self.elimination.len()).rev() {
            let (first, width, rows) = self.steps_and_rows(s);
            below.clear();
            below.extend(rows.iter().map(|&r| x[r as usize]));
            let own = &mut x[first..first + width];
            let columns = self.factor[self.elimination.values(s)].chunks_exact(width + rows.len());
            for (j, column) in columns.enumerate().rev() {
                let (top, bottom) = column.split_at(width);
                let sum = dot(&top[j + 1..], &own[j + 1..]) + dot(bottom, &below);
                own[j] = (own[j] - sum) / column[j];
            }
        }
    }

    /// Solves for several columns at once.
    fn solve_block(&self, b: &mut [f64]) {
        let n = self.matrix.dimension();
        let columns = b.len() / n;
        let order = &self.elimination.order;
        let mut x = Mat::from_fn(n, columns, |k, c| b[c * n + order[k] as usize]);
        let mut below = Vec::new();
        for s in 0..self.elimination.len() {
            let (first, width, rows) = self.steps_and_rows(s);
            let (top, bottom) = self.panel(s).split_at_row(width);
            let mut own = x.as_mut().subrows_mut(first, width);
            solve_lower_triangular_in_place(top, own.as_mut(), Par::Seq);
            below.resize(rows.len() * columns, 0.0);
            let change = MatMut::from_column_major_slice_mut(&mut below, rows.len(), columns);
            matmul(change, Accum::Replace, bottom, own.as_ref(), 1.0, Par::Seq);
            for (c, change) in below.chunks_exact(rows.len().max(1)).enumerate() {
                let x = x.col_as_slice_mut(c);
                rows.iter().zip(change).for_each(|(&r, change)| x[r as usize] -= change);
            }
        }
        for s in (0..self.elimination.len()).rev() {
            let (first, width, rows) = self.steps_and_rows(s);
            let (top, bottom) = self.panel(s).split_at_row(width);
            below.clear();
            for c in 0..columns {
                let x = x.col_as_slice(c);
                below.extend(rows.iter().map(|&r| x[r as usize]));
            }
            let below = MatRef::from_column_major_slice(&below, rows.len(), columns);
            let mut own = x.as_mut().subrows_mut(first, width);
            matmul(own.as_mut(), Accum::Add, bottom.transpose(), below, -1.0, Par::Seq);
            solve_upper_triangular_in_place(top.transpose(), own, Par::Seq);
        }
        for (c, b) in b.chunks_exact_mut(n).enumerate() {
            order.iter().zip(x.col_as_slice(c)).for_each(|(&v, &x)| b[v as usize] = x);
        }
    }

    fn steps_and_rows(&self, s: usize) -> (usize, usize, &[u32]) {
        (self.elimination.first(s), self.elimination.width(s), self.elimination.rows(s))
    }

    fn panel(&self, s: usize) -> MatRef<'_, f64> {
        let (_, width, rows) = self.steps_and_rows(s);
        MatRef::from_column_major_slice(&self.factor[self.elimination.values(s)], width + rows.len(), width)
    }

    /// y = A x for one column.
    pub(crate) fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for column in 0..x.len() {
            let entries = self.matrix.column(column);
            for (&row, &value) in self.matrix.row[entries.clone()].iter().zip(&self.matrix.value[entries]) {
                let row = row as usize;
                y[row] += value * x[column];
                if row != column {
                    y[column] += value * x[row];
                }
            }
        }
        y
    }

    /// The number of stored entries of the factor, zeros within supernodes included.
    pub(crate) fn factor_len(&self) -> usize {
        self.factor.len()
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

/// How many values of updates there are at most.
fn most_updates(elimination: &Elimination) -> usize {
    let mut waiting: Vec<usize> = Vec::new();
    let (mut now, mut most) = (0, 0);
    for s in 0..elimination.len() {
        most = most.max(now + update_len(elimination, s));
        while waiting.last().is_some_and(|&child| elimination.parent(child) == Some(s)) {
            now -= waiting.pop().map_or(0, |child| update_len(elimination, child));
        }
        waiting.push(s);
        now += update_len(elimination, s);
    }
    most
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
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
