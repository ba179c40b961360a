//! Sparse Cholesky factorization of a symmetric positive definite matrix, kept for many solves.
//!
//! The order of elimination, its analysis and the values of the factor are made one after the other (`dissection`, `elimination`,
//! `factorization`); what is kept of them for another matrix of the same pattern, or of nearly the same, is kept.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::dissection::dissect;
use super::elimination::Elimination;
use super::error::CholeskyError;
use super::factorization::{Entries, factor};
use super::graph::Graph;
use super::single::{Factor, LEAST, Parted};
use super::substitution::{LANES, Passes, substitute};
use super::symmetric::SymmetricMatrix;
use crate::parallel::{self, try_each};
use crate::watch::{Interrupted, Watch, unwatched};

/// So many rows of a block are copied column after column: their values for all columns stay in the cache meanwhile.
const ROWS: usize = 1 << 9;
/// So many right-hand sides are solved for at once.
const BLOCK: usize = 16;
/// One in so many values more than the first factor has is room for: factors of matrices with other patterns go there. Newton's method
/// on 134 thousand vertices needs up to a hundredth. What nobody touches takes no memory.
const ROOM: usize = 16;
/// The graph of a matrix.
fn graph(matrix: &SymmetricMatrix) -> Graph {
    Graph::of_lower_triangle(&matrix.column_start, &matrix.row)
}

/// An order of elimination by approximate minimum degree (Amestoy, Davis & Duff 1996).
fn minimum_degree(matrix: &SymmetricMatrix) -> Result<Vec<u32>, CholeskyError> {
    let n = matrix.dimension();
    let (mut order, mut step) = (vec![0; n], vec![0; n]);
    let mut scratch = MemBuffer::new(amd::order_scratch::<u32>(n, matrix.row.len()));
    let pattern = SymbolicSparseColMatRef::new_checked(n, n, &matrix.column_start, None, &matrix.row);
    amd::order(&mut order, &mut step, pattern, Default::default(), MemStack::new(&mut scratch))
        .map_err(|_| CholeskyError::OutOfMemory(n))?;
    Ok(order)
}

/// A factored symmetric positive definite matrix: C Cᵀ = P A Pᵀ, P the order of elimination. Factoring costs as much as ten
/// to twenty solves.
///
/// ```
/// # use geom::{Cholesky, Mesh, Metric, laplacian};
/// let triangle = Mesh::new(3, &[[0, 1, 2]])?;
/// let mut matrix = laplacian(&triangle, &Metric::new(vec![1.0; 3].into()));
/// (0..3).for_each(|i| *matrix.diagonal_mut(i) += 1.0);
/// let x = Cholesky::new(&matrix)?.solve(&[3.0, 2.0, 1.0]);
/// assert!((matrix.multiply(&x)[0] - 3.0).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Cholesky {
    matrix: SymmetricMatrix,
    elimination: Elimination,
    entries: Entries,
    /// The values of the factor, and room for more.
    values: Vec<f64>,
    /// How one right-hand side is solved for on several threads.
    parted: Option<Parted>,
}

/// Not its numbers, which are millions.
impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (dimension, entries) = (self.matrix.dimension(), self.factor_len());
        f.debug_struct("Cholesky").field("dimension", &dimension).field("factor_len", &entries).finish_non_exhaustive()
    }
}

impl Cholesky {
    /// Factors a matrix, eliminating in an order of approximate minimum degree.
    ///
    /// # Errors
    /// If it is not positive definite, or memory does not suffice.
    pub fn new(matrix: &SymmetricMatrix) -> Result<Self, CholeskyError> {
        Self::new_watched(matrix, None, Watch::NONE)
    }

    /// Factors a matrix whose rows have positions, and entries mostly between near ones: nested dissection finds an order that
    /// is better from some ten thousand rows on. Positions only guide.
    ///
    /// # Errors
    /// As [`Cholesky::new`].
    ///
    /// # Panics
    /// If there are fewer points than rows.
    pub fn with_points(matrix: &SymmetricMatrix, points: &[[f64; 3]]) -> Result<Self, CholeskyError> {
        Self::new_watched(matrix, Some(points), Watch::NONE)
    }

    /// [`Cholesky::with_points`] where there are points, else [`Cholesky::new`]; watched.
    ///
    /// # Errors
    /// As [`Cholesky::new`], and if it is stopped.
    ///
    /// # Panics
    /// If there are fewer points than rows.
    pub fn new_watched(
        matrix: &SymmetricMatrix,
        points: Option<&[[f64; 3]]>,
        watch: Watch,
    ) -> Result<Self, CholeskyError> {
        Self::of(matrix.clone(), points, watch)
    }

    /// Orders, analyses and factors a matrix.
    pub(crate) fn of(
        matrix: SymmetricMatrix,
        points: Option<&[[f64; 3]]>,
        watch: Watch,
    ) -> Result<Self, CholeskyError> {
        let graph = graph(&matrix);
        let order = match points {
            Some(points) => dissect(&graph, points, watch.within(0.0, 0.2))?,
            None => minimum_degree(&matrix)?,
        };
        Self::in_order(matrix, &graph, &order, watch.within(0.2, 1.0))
    }

    /// Factors another matrix of the same dimension in the same order.
    pub(crate) fn another(&self, matrix: SymmetricMatrix, watch: Watch) -> Result<Self, CholeskyError> {
        let graph = graph(&matrix);
        Self::in_order(matrix, &graph, &self.elimination.order, watch)
    }

    fn in_order(matrix: SymmetricMatrix, graph: &Graph, order: &[u32], watch: Watch) -> Result<Self, CholeskyError> {
        Self::into_room((matrix, graph), order, Vec::new(), watch)
    }

    /// Factors a matrix, given with its graph, into the memory of another factor if there is room.
    fn into_room(
        (matrix, graph): (SymmetricMatrix, &Graph),
        order: &[u32],
        room: Vec<f64>,
        watch: Watch,
    ) -> Result<Self, CholeskyError> {
        let elimination = Elimination::new(graph, order, watch.within(0.0, 0.12))?;
        let entries = Entries::new(&matrix, &elimination, watch.within(0.12, 0.15))?;
        let parted = Parted::new(&elimination, LEAST);
        let mut cholesky = Self { matrix, elimination, entries, values: room, parted };
        cholesky.factor_values(watch.within(0.15, 1.0))?;
        Ok(cholesky)
    }

    /// Factors another matrix of the same dimension in place of this one: the analysis is kept where the pattern is the same,
    /// the order in any case (it stays good while a few entries come and go).
    ///
    /// # Errors
    /// As [`Cholesky::new`], and if it is stopped.
    pub fn refactor(mut self, matrix: SymmetricMatrix, watch: Watch) -> Result<Self, CholeskyError> {
        if matrix.column_start == self.matrix.column_start && matrix.row == self.matrix.row {
            self.matrix.value = matrix.value;
            self.factor_values(watch)?;
            return Ok(self);
        }
        let graph = graph(&matrix);
        Self::into_room((matrix, &graph), &self.elimination.order, self.values, watch)
    }

    fn factor_values(&mut self, watch: Watch) -> Result<(), CholeskyError> {
        let needed = self.elimination.value_count();
        if self.values.len() < needed {
            // The old factor goes before the new one is made: at peak there is one.
            self.values = Vec::new();
            let rows = self.matrix.dimension();
            let with_room = needed + needed / ROOM;
            Vec::<f64>::new().try_reserve_exact(with_room).map_err(|_| CholeskyError::OutOfMemory(rows))?;
            self.values = vec![0.0; with_room];
        }
        let values = &mut self.values[..needed];
        factor(&self.elimination, &self.entries, &self.matrix.value, values, watch)
    }

    /// The matrix that is factored.
    pub(super) fn matrix(&self) -> &SymmetricMatrix {
        &self.matrix
    }

    /// What is read for one right-hand side.
    fn single(&self) -> Factor<'_> {
        Factor { elimination: &self.elimination, values: self.factor(), parted: self.parted.as_ref() }
    }

    /// The values of the factor, supernode after supernode.
    fn factor(&self) -> &[f64] {
        &self.values[..self.elimination.value_count()]
    }

    /// Solves A x = b. One step of refinement is added where the residual asks for it.
    ///
    /// # Panics
    /// If `b` is not as long as the matrix.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        unwatched(self.solve_watched(b, Watch::NONE))
    }

    /// [`Cholesky::solve`], watched.
    ///
    /// # Errors
    /// If it is stopped.
    ///
    /// # Panics
    /// If `b` is not as long as the matrix.
    pub fn solve_watched(&self, b: &[f64], watch: Watch) -> Result<Vec<f64>, Interrupted> {
        assert_eq!(b.len(), self.matrix.dimension(), "a right-hand side has one value a row");
        let mut x = b.to_vec();
        self.solve_one(&mut x, &|row| row, watch.within(0.0, 0.4))?;
        let product = self.matrix.multiply(&x);
        let mut residual: Vec<f64> = b.iter().zip(&product).map(|(b, p)| b - p).collect();
        if norm(&residual) > 1e-13 * norm(b) {
            self.solve_one(&mut residual, &|row| row, watch.within(0.5, 0.9))?;
            for (x, correction) in x.iter_mut().zip(&residual) {
                *x += correction;
            }
        }
        Ok(x)
    }

    /// Solves A x = b in place, for one right-hand side.
    fn solve_one(&self, b: &mut [f64], place: &impl Fn(usize) -> usize, watch: Watch) -> Result<(), Interrupted> {
        watch.ask(0.0)?;
        let mut x: Vec<f64> = self.elimination.order.iter().map(|&row| b[place(row as usize)]).collect();
        self.single().forward(&mut x, watch.within(0.0, 0.5))?;
        self.single().backward(&mut x, watch.within(0.5, 1.0))?;
        self.elimination.order.iter().zip(x).for_each(|(&row, x)| b[place(row as usize)] = x);
        Ok(())
    }

    /// Solves A x = b for each of the columns in place, without refinement; row k is at `place(k)` of a column, and what is elsewhere
    /// stays.
    pub(crate) fn solve_columns(
        &self,
        columns: &mut [&mut [f64]],
        place: &(impl Fn(usize) -> usize + Sync),
        watch: Watch,
    ) -> Result<(), Interrupted> {
        let count = if self.matrix.dimension() > 0 { columns.len() } else { 0 };
        let rooms = Rooms::default();
        watch.shared(|watch| {
            try_each(0, &mut parted(&mut columns[..count]), &|_, (of_block, block)| {
                let watch = watch_of_block(watch, of_block, count);
                match block {
                    [alone] => self.solve_one(alone, place, watch),
                    _ => self.solve_block(block, place, &rooms, watch),
                }
            })
        })
    }

    /// Solves A x = b for right-hand sides with few entries that are not 0, given as (row, value), into columns where row k is at
    /// `place(k)`. Costs little more than half as much as other right-hand sides.
    pub(crate) fn solve_sparse(
        &self,
        b: &[Vec<(u32, f64)>],
        columns: &mut [&mut [f64]],
        place: &(impl Fn(usize) -> usize + Sync),
        watch: Watch,
    ) -> Result<(), Interrupted> {
        let count = if self.matrix.dimension() > 0 { columns.len() } else { 0 };
        let rooms = Rooms::default();
        watch.shared(|watch| {
            try_each(0, &mut parted(&mut columns[..count]), &|_, (of_block, block)| {
                let watch = watch_of_block(watch, of_block, count);
                self.solve_sparse_block(&b[of_block.clone()], block, place, &rooms, watch)
            })
        })
    }

    /// [`Self::solve_sparse`] for one block of right-hand sides.
    fn solve_sparse_block(
        &self,
        b: &[Vec<(u32, f64)>],
        columns: &mut [&mut [f64]],
        place: &impl Fn(usize) -> usize,
        rooms: &Rooms,
        watch: Watch,
    ) -> Result<(), Interrupted> {
        let n = self.matrix.dimension();
        let mut half = vec![0.0; n];
        watch.ask(0.0)?;
        if let ([b], [column]) = (b, &mut *columns) {
            self.forward_sparse(b, &mut half);
            self.single().backward(&mut half, watch)?;
            self.elimination.step.iter().enumerate().for_each(|(k, &step)| column[place(k)] = half[step as usize]);
            return Ok(());
        }
        let padded = b.len().next_multiple_of(LANES);
        let mut block = rooms.zeros(n * padded);
        for (k, b) in b.iter().enumerate() {
            for s in self.forward_sparse(b, &mut half) {
                let steps = self.elimination.first(s)..self.elimination.first(s) + self.elimination.width(s);
                steps.for_each(|step| block[step * padded + k] = std::mem::take(&mut half[step]));
            }
        }
        substitute(self.single(), Passes::Backward, padded, &mut block, watch)?;
        self.unpack(&block, columns, place, watch)?;
        rooms.give_back(block);
        Ok(())
    }

    /// C⁻¹ e for a unit vector: its nonzero entries, by step.
    pub(crate) fn solve_forward(&self, row: u32, x: &mut Vec<f64>) -> Vec<(u32, f64)> {
        x.resize(self.matrix.dimension(), 0.0);
        let mut entries = Vec::new();
        for s in self.forward_sparse(&[(row, 1.0)], x) {
            let from = self.elimination.first(s);
            for (step, x) in (from as u32..).zip(&mut x[from..from + self.elimination.width(s)]) {
                let entry = std::mem::take(x);
                if entry != 0.0 {
                    entries.push((step, entry));
                }
            }
        }
        entries
    }

    /// C⁻¹ b for a right-hand side with few nonzero entries, by step; `x` is zero before. Returns the supernodes that take
    /// part, ascending: those on the ways from the entries to the root of the elimination tree.
    fn forward_sparse(&self, b: &[(u32, f64)], x: &mut [f64]) -> Vec<usize> {
        let elimination = &self.elimination;
        let mut supernodes = BTreeSet::new();
        for &(row, value) in b {
            let step = elimination.step[row as usize] as usize;
            x[step] += value;
            let mut next = Some(elimination.supernode[step] as usize);
            while let Some(s) = next.filter(|&s| supernodes.insert(s)) {
                next = elimination.parent(s);
            }
        }
        let supernodes: Vec<usize> = supernodes.into_iter().collect();
        unwatched(self.single().forward_through(supernodes.iter().copied(), x, Watch::NONE));
        supernodes
    }

    /// C⁻ᵀ y.
    pub(crate) fn solve_backward(&self, mut y: Vec<f64>) -> Vec<f64> {
        unwatched(self.single().backward(&mut y, Watch::NONE));
        self.elimination.step.iter().map(|&k| y[k as usize]).collect()
    }

    /// Solves for several columns at once.
    fn solve_block(
        &self,
        columns: &mut [&mut [f64]],
        place: &impl Fn(usize) -> usize,
        rooms: &Rooms,
        watch: Watch,
    ) -> Result<(), Interrupted> {
        // Others are zero.
        let padded = columns.len().next_multiple_of(LANES);
        let mut x = rooms.zeros(self.matrix.dimension() * padded);
        for (first, steps) in self.rows_in_pieces() {
            watch.ask(0.0)?;
            for (k, column) in columns.iter().enumerate() {
                let rows = (first..).zip(steps);
                rows.for_each(|(row, &step)| x[step as usize * padded + k] = column[place(row)]);
            }
        }
        substitute(self.single(), Passes::Both, padded, &mut x, watch)?;
        self.unpack(&x, columns, place, watch)?;
        rooms.give_back(x);
        Ok(())
    }

    /// The columns of what lies step by step in the order of the elimination.
    fn unpack(
        &self,
        x: &[f64],
        columns: &mut [&mut [f64]],
        place: &impl Fn(usize) -> usize,
        watch: Watch,
    ) -> Result<(), Interrupted> {
        let padded = columns.len().next_multiple_of(LANES);
        for (first, steps) in self.rows_in_pieces() {
            watch.ask(1.0)?;
            for (k, column) in columns.iter_mut().enumerate() {
                let rows = (first..).zip(steps);
                rows.for_each(|(row, &step)| column[place(row)] = x[step as usize * padded + k]);
            }
        }
        Ok(())
    }

    /// The rows in pieces, the first of each with the steps in which they are eliminated.
    fn rows_in_pieces(&self) -> impl Iterator<Item = (usize, &[u32])> {
        self.elimination.step.chunks(ROWS).enumerate().map(|(k, steps)| (k * ROWS, steps))
    }

    /// The number of stored entries of the factor, zeros within supernodes included.
    pub fn factor_len(&self) -> usize {
        self.factor().len()
    }
}

/// Where blocks of right-hand sides are solved for. One takes the room of another that is done: of a million rows sixteen take 128 MB, which
/// the system would have to clear page by page for each block.
#[derive(Default)]
struct Rooms(Mutex<Vec<Vec<f64>>>);

impl Rooms {
    /// Zeros, written: what the system has cleared is mapped twice if it is read first.
    fn zeros(&self, count: usize) -> Vec<f64> {
        let mut room = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        room.clear();
        room.resize(count, 0.0);
        room
    }

    fn give_back(&self, room: Vec<f64>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(room);
    }
}

/// The right-hand sides that are solved for at once, of so many. Where there are several threads a block is two, if these fill the
/// processor's vectors; what comes out is the same, as each right-hand side has a place of its own in these, but for one that is alone.
fn blocks_of(columns: usize) -> Vec<Range<usize>> {
    let is_shared = parallel::threads() > 1;
    let halves = |from: usize| {
        let end = columns.min(from + BLOCK);
        let middle = if is_shared && end > from + LANES + 1 { from + LANES } else { from };
        [from..middle, middle..end].into_iter().filter(|block| !block.is_empty())
    };
    (0..columns).step_by(BLOCK).flat_map(halves).collect()
}

/// Right-hand sides by blocks.
fn parted<'a, 'b>(columns: &'a mut [&'b mut [f64]]) -> Vec<(Range<usize>, &'a mut [&'b mut [f64]])> {
    let of_blocks = blocks_of(columns.len());
    let mut rest = columns;
    let mut part = |of_block: Range<usize>| {
        let block;
        (block, rest) = std::mem::take(&mut rest).split_at_mut(of_block.len());
        (of_block, block)
    };
    of_blocks.into_iter().map(&mut part).collect()
}

/// The watch of a block of right-hand sides.
fn watch_of_block<'a>(watch: Watch<'a>, block: &Range<usize>, columns: usize) -> Watch<'a> {
    let done = |count: usize| count as f64 / columns.max(1) as f64;
    watch.within(done(block.start), done(block.end))
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{self, Shape};
    use crate::{Metric, laplacian};
    use faer::sparse::linalg::cholesky::{
        CholeskySymbolicParams, LltRef, SymmetricOrdering, factorize_symbolic_cholesky,
    };
    use faer::sparse::{SparseColMatRef, linalg::SupernodalThreshold};
    use faer::{Conj, MatMut, Par, Side};
    use std::ops::ControlFlow;

    /// The Laplacian of a shape plus a little on the diagonal, and the points.
    fn matrix(shape: &Shape) -> (SymmetricMatrix, Vec<[f64; 3]>) {
        let mesh = shape.mesh();
        let mut matrix = laplacian(&mesh, &Metric::from_points(&mesh, &shape.points));
        (0..matrix.dimension()).for_each(|v| *matrix.diagonal_mut(v) += 1e-3);
        (matrix, shape.points.clone())
    }

    /// The same for columns one after the other.
    impl Cholesky {
        fn solve_in_place(&self, b: &mut [f64], watch: Watch) -> Result<(), Interrupted> {
            let mut columns: Vec<&mut [f64]> = b.chunks_exact_mut(self.matrix.dimension().max(1)).collect();
            self.solve_columns(&mut columns, &|row| row, watch)
        }

        fn solved_sparse(&self, b: &[Vec<(u32, f64)>], watch: Watch) -> Result<Vec<Vec<f64>>, Interrupted> {
            let mut x = vec![vec![0.0; self.matrix.dimension()]; b.len()];
            let mut columns: Vec<&mut [f64]> = x.iter_mut().map(Vec::as_mut_slice).collect();
            self.solve_sparse(b, &mut columns, &|row| row, watch)?;
            Ok(x)
        }
    }

    fn right_hand_side(n: usize) -> Vec<f64> {
        (0..n).map(|k| (k as f64 * 0.37).sin()).collect()
    }

    /// A x = b by faer's supernodal factorization.
    fn solved_by_faer(a: &SymmetricMatrix, mut b: Vec<f64>) -> Vec<f64> {
        let n = a.dimension();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &a.column_start, None, &a.row);
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, SymmetricOrdering::Amd, parameters).unwrap();
        let mut factor = vec![0.0; symbolic.len_val()];
        let mut scratch = MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()));
        let matrix = SparseColMatRef::new(pattern, &a.value);
        let stack = MemStack::new(&mut scratch);
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                matrix,
                Side::Lower,
                Default::default(),
                Par::Seq,
                stack,
                Default::default(),
            )
            .unwrap();
        let mut scratch = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        LltRef::new(&symbolic, &factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut b, n, 1),
            Par::Seq,
            MemStack::new(&mut scratch),
        );
        b
    }

    fn assert_near(x: &[f64], y: &[f64]) {
        let size = y.iter().fold(0.0, |m: f64, y| m.max(y.abs()));
        let difference = x.iter().zip(y).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()));
        assert!(difference < 1e-10 * size, "{difference} of {size}");
    }

    #[test]
    fn solutions_are_those_of_faer() {
        // Large enough for fronts that faer's kernels take.
        for shape in [shapes::disk(60), shapes::hare(900), shapes::terrain(12_000, 3)] {
            let (matrix, points) = matrix(&shape);
            let b = right_hand_side(points.len());
            let expected = solved_by_faer(&matrix, b.clone());
            for points in [None, Some(&points[..])] {
                let mut x = b.clone();
                Cholesky::of(matrix.clone(), points, Watch::NONE).unwrap().solve_in_place(&mut x, Watch::NONE).unwrap();
                assert_near(&x, &expected);
            }
        }
    }

    #[test]
    fn many_right_hand_sides_are_solved_for_as_one_is() {
        let (matrix, points) = matrix(&shapes::hare(900));
        let n = points.len();
        let cholesky = Cholesky::of(matrix, Some(&points), Watch::NONE).unwrap();
        for columns in [2, 16, 17, 35] {
            let right = right_hand_side(columns * n);
            let mut all = right.clone();
            cholesky.solve_in_place(&mut all, Watch::NONE).unwrap();
            for (x, b) in all.chunks_exact(n).zip(right.chunks_exact(n)) {
                let mut one = b.to_vec();
                cholesky.solve_in_place(&mut one, Watch::NONE).unwrap();
                assert_near(x, &one);
            }
        }
    }

    #[test]
    fn right_hand_sides_with_few_entries_are_solved_for_as_others_are() {
        let (matrix, points) = matrix(&shapes::hare(900));
        let n = points.len();
        let cholesky = Cholesky::of(matrix, Some(&points), Watch::NONE).unwrap();
        let sparse: Vec<Vec<(u32, f64)>> = (0..35).map(|k| vec![(k, 1.0), (17 * k + 50, -0.5)]).collect();
        let solved = cholesky.solved_sparse(&sparse, Watch::NONE).unwrap();
        for (x, entries) in solved.iter().zip(&sparse) {
            let mut b = vec![0.0; n];
            entries.iter().for_each(|&(row, value)| b[row as usize] += value);
            cholesky.solve_in_place(&mut b, Watch::NONE).unwrap();
            assert_near(x, &b);
        }
    }

    #[test]
    fn two_halves_are_a_solve() {
        let (mut matrix, points) = matrix(&shapes::hare(900));
        let n = points.len();
        // With every other row and column negated, so that solutions have both signs.
        for column in 0..n {
            for k in matrix.range(column) {
                matrix.value[k] *= if (matrix.row[k] as usize + column).is_multiple_of(2) { 1.0 } else { -1.0 };
            }
        }
        let cholesky = Cholesky::of(matrix, Some(&points), Watch::NONE).unwrap();
        let mut scratch = Vec::new();
        for row in [0, 17, n - 1] {
            let mut whole = vec![0.0; n];
            whole[row] = 1.0;
            cholesky.solve_in_place(&mut whole, Watch::NONE).unwrap();
            let mut half = vec![0.0; n];
            cholesky.solve_forward(row as u32, &mut scratch).iter().for_each(|&(step, x)| half[step as usize] = x);
            assert!(scratch.iter().all(|x| *x == 0.0));
            let square: f64 = half.iter().map(|x| x * x).sum();
            assert!((square / whole[row] - 1.0).abs() < 1e-12);
            assert_near(&cholesky.solve_backward(half), &whole);
        }
    }

    #[test]
    fn another_matrix_is_factored_in_the_order_of_the_first() {
        let (matrix, points) = matrix(&shapes::hare(900));
        let mut doubled = matrix.clone();
        doubled.value.iter_mut().for_each(|value| *value *= 2.0);
        let cholesky = Cholesky::of(matrix, Some(&points), Watch::NONE).unwrap();
        let other = cholesky.another(doubled.clone(), Watch::NONE).unwrap();
        let cholesky = cholesky.refactor(doubled, Watch::NONE).unwrap();
        assert_eq!((cholesky.factor(), &cholesky.elimination.order), (other.factor(), &other.elimination.order));
    }

    #[test]
    fn another_pattern_is_told_from_the_first_also_where_its_columns_are_as_long() {
        // A path of four vertices in two orders: 0–1–2–3 and 0–2–1–3, each edge in the column of its lesser end.
        let path = |row: [u32; 7], column_start: [u32; 5]| {
            let value = [2.0, -1.0, 2.0, -1.0, 2.0, -1.0, 2.0].to_vec();
            SymmetricMatrix { column_start: column_start.to_vec(), row: row.to_vec(), value }
        };
        let first = || path([0, 1, 1, 2, 2, 3, 3], [0, 2, 4, 6, 7]);
        let second = || path([0, 2, 1, 3, 2, 3, 3], [0, 2, 4, 6, 7]);
        let b = right_hand_side(4);
        let cholesky = Cholesky::of(first(), None, Watch::NONE).unwrap();
        let cholesky = cholesky.refactor(second(), Watch::NONE).unwrap();
        let mut x = b.clone();
        cholesky.solve_in_place(&mut x, Watch::NONE).unwrap();
        assert_near(&x, &solved_by_faer(&second(), b));
    }

    #[test]
    fn what_is_not_definite_is_refused() {
        let (matrix, points) = matrix(&shapes::hare(900));
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for column in [0, 450, points.len() - 1] {
                let mut matrix = matrix.clone();
                let diagonal = matrix.column_start[column] as usize;
                matrix.value[diagonal] = wrong;
                let error = Cholesky::of(matrix, Some(&points), Watch::NONE).unwrap_err();
                assert_eq!(error, CholeskyError::NotPositiveDefinite);
            }
        }
        let zero = SymmetricMatrix { column_start: vec![0, 1], row: vec![0], value: vec![0.0] };
        assert!(Cholesky::of(zero, None, Watch::NONE).is_err());
    }

    #[cfg(feature = "rayon")]
    #[test]
    fn the_bits_are_the_same_for_any_number_of_threads() {
        // Large enough for trees that are parted and fronts whose work is shared.
        let (matrix, points) = matrix(&shapes::hare(20_000));
        let n = points.len();
        // Two full blocks and one of ten, which is parted too; of the others all but one that is alone.
        let b = right_hand_side(42 * n);
        let sparse: Vec<Vec<(u32, f64)>> = (0..25).map(|k| vec![(k, 1.0), (3000 + k, -1.0)]).collect();
        let solved = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let cholesky = Cholesky::with_points(&matrix, &points).unwrap();
                let mut x = b.clone();
                cholesky.solve_in_place(&mut x, Watch::NONE).unwrap();
                let some = cholesky.solved_sparse(&sparse, Watch::NONE).unwrap();
                (cholesky.elimination.order.clone(), cholesky.factor().to_vec(), x, some)
            })
        };
        let one = solved(1);
        assert!(one.1.len() > 500_000);
        assert!([2, 5].iter().all(|&threads| solved(threads) == one));
    }

    #[test]
    fn trees_with_a_long_trunk_are_factored() {
        // A band matrix in the given order: a path of supernodes, each with nearly all values below it.
        let (n, wide) = (20_000u32, 12);
        let rows = |column: u32| column..n.min(column + wide);
        let row: Vec<u32> = (0..n).flat_map(rows).collect();
        let column_start: Vec<u32> =
            (0..=n).scan(0, |at, c| Some(std::mem::replace(at, *at + rows(c).len() as u32))).collect();
        let value = (0..n).flat_map(|c| rows(c).map(move |r| if r == c { 30.0 } else { -1.0 })).collect();
        let matrix = SymmetricMatrix { column_start, row, value };
        let order: Vec<u32> = (0..n).collect();
        let cholesky = Cholesky::in_order(matrix.clone(), &graph(&matrix), &order, Watch::NONE).unwrap();
        let b = right_hand_side(n as usize);
        let product = matrix.multiply(&cholesky.solve(&b));
        assert!(b.iter().zip(product).all(|(b, p)| (b - p).abs() < 1e-12));
    }

    #[test]
    fn a_matrix_without_rows_is_factored() {
        let empty = || SymmetricMatrix { column_start: vec![0], row: Vec::new(), value: Vec::new() };
        for points in [None, Some(&[][..])] {
            let cholesky = Cholesky::of(empty(), points, Watch::NONE).unwrap();
            cholesky.solve_in_place(&mut [], Watch::NONE).unwrap();
            assert_eq!(cholesky.factor_len(), 0);
        }
    }

    #[test]
    fn wide_fronts_are_refused_too_where_they_are_not_definite() {
        // A full matrix is one front.
        let n = 60;
        let full = |diagonal: f64| {
            let row: Vec<u32> = (0..n).flat_map(|column| column..n).collect();
            let column_start: Vec<u32> = (0..=n).map(|c| c * n - c * c.saturating_sub(1) / 2).collect();
            let mut value = vec![-1.0; row.len()];
            column_start[..n as usize].iter().for_each(|&start| value[start as usize] = f64::from(n) + 1.0);
            value[column_start[n as usize - 1] as usize] = diagonal;
            SymmetricMatrix { column_start, row, value }
        };
        let matrix = full(f64::from(n) + 1.0);
        let x = Cholesky::new(&matrix).unwrap().solve(&[2.0; 60]);
        assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-13));
        for wrong in [-1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Cholesky::new(&full(wrong)).unwrap_err(), CholeskyError::NotPositiveDefinite);
        }
    }

    #[test]
    fn a_factorization_stops_wherever_it_is_told_to() {
        let (matrix, points) = matrix(&shapes::hare(3000));
        for points in [None, Some(&points[..])] {
            for stop in [0.0, 0.1, 0.25, 0.6, 0.9] {
                let told = std::sync::Mutex::new(0.0);
                let observer = |fraction: f64| {
                    let before = std::mem::replace(&mut *told.lock().unwrap(), fraction);
                    assert!(before <= fraction && fraction <= 1.0, "{before} {fraction}");
                    if fraction < stop { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
                };
                let error = Cholesky::new_watched(&matrix, points, Watch::new(&observer)).unwrap_err();
                assert_eq!(error, CholeskyError::Interrupted(Interrupted));
            }
        }
        let b = right_hand_side(3 * points.len());
        let cholesky = Cholesky::with_points(&matrix, &points).unwrap();
        let never: &(dyn Fn(f64) -> ControlFlow<()> + Sync) = &|_| ControlFlow::Break(());
        assert_eq!(cholesky.solve_in_place(&mut b.clone(), Watch::new(never)), Err(Interrupted));
        assert_eq!(cholesky.solved_sparse(&[vec![(0, 1.0)]], Watch::new(never)), Err(Interrupted));
    }

    #[test]
    fn in_parts_or_not_both_passes_come_to_the_same_and_to_the_same_bits_on_any_number_of_threads() {
        for shape in [shapes::hare(3000), shapes::torus(3, 2000), shapes::terrain(900, 5)] {
            let mesh = shape.mesh();
            let mut matrix = laplacian(&mesh, &Metric::from_points(&mesh, &shape.points));
            (0..matrix.dimension()).for_each(|v| *matrix.diagonal_mut(v) += 1e-3);
            let mut cholesky = Cholesky::with_points(&matrix, &shape.points).unwrap();
            let b: Vec<f64> = (0..matrix.dimension()).map(|k| (k as f64 * 0.37).sin()).collect();
            let near = |x: &[f64], y: &[f64]| x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-9 * (1.0 + y.abs()));
            // For one right-hand side, for eleven, and for two with few entries.
            let passes = |cholesky: &Cholesky| -> [Vec<f64>; 4] {
                let (mut forward, mut backward, mut several) = (b.clone(), b.clone(), b.repeat(11));
                cholesky.single().forward(&mut forward, Watch::NONE).unwrap();
                cholesky.single().backward(&mut backward, Watch::NONE).unwrap();
                cholesky.solve_in_place(&mut several, Watch::NONE).unwrap();
                let sparse = [vec![(0, 1.0), (70, -1.0)], vec![(500, 1.0)]];
                [forward, backward, several, cholesky.solved_sparse(&sparse, Watch::NONE).unwrap().concat()]
            };
            assert!(cholesky.parted.is_none());
            let whole = passes(&cholesky);
            cholesky.parted = Parted::new(&cholesky.elimination, 0);
            let [trees, above] = cholesky.parted.as_ref().unwrap().counts();
            assert!(trees > 3 && above > 1, "{trees} {above}");
            let in_parts = passes(&cholesky);
            assert!((0..4).all(|k| near(&in_parts[k], &whole[k])));
            #[cfg(feature = "rayon")]
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                assert_eq!(pool.install(|| passes(&cholesky)), in_parts);
            }
        }
    }
}
