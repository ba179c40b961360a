//! Sparse Cholesky factorization of a symmetric positive definite matrix: faer's supernodal one, kept for many solves.
//!
//! The supernodal path is forced (faer's own choice is the simplicial one on our matrices, up to 19 times slower) and
//! runs on one thread (more threads gain nothing at these sizes).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::poisson::PoissonError;

/// The lower triangle of a symmetric matrix, by columns with sorted rows.
#[derive(Debug)]
pub(crate) struct LowerTriangle {
    pub(crate) column_start: Vec<u32>,
    pub(crate) row: Vec<u32>,
    pub(crate) value: Vec<f64>,
}

impl LowerTriangle {
    fn dimension(&self) -> usize {
        self.column_start.len() - 1
    }
    fn pattern(&self) -> SymbolicSparseColMatRef<'_, u32> {
        let n = self.dimension();
        SymbolicSparseColMatRef::new_checked(n, n, &self.column_start, None, &self.row)
    }
}

/// C Cᵀ = P A Pᵀ.
#[derive(Debug)]
pub(crate) struct Cholesky {
    pattern: LowerTriangle,
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<f64>,
}

impl Cholesky {
    /// Orders (approximate minimum degree), analyses and factors a matrix.
    pub(crate) fn new(matrix: LowerTriangle) -> Result<Self, PoissonError> {
        Self::with_ordering(matrix, SymmetricOrdering::Amd)
    }

    fn with_ordering(matrix: LowerTriangle, ordering: SymmetricOrdering<'_, u32>) -> Result<Self, PoissonError> {
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(matrix.pattern(), Side::Lower, ordering, parameters)
            .map_err(|_| PoissonError::OutOfMemory(matrix.dimension()))?;
        let mut cholesky = Self { factor: Vec::new(), pattern: matrix, symbolic };
        cholesky.factor_values()?;
        Ok(cholesky)
    }

    /// Factors another matrix of the same dimension: the analysis is kept where the pattern is the same, the ordering
    /// in any case (it stays good while a few edges flip).
    pub(crate) fn refactor(&mut self, matrix: LowerTriangle) -> Result<(), PoissonError> {
        let same = matrix.column_start == self.pattern.column_start && matrix.row == self.pattern.row;
        if same {
            self.pattern.value = matrix.value;
            return self.factor_values();
        }
        let n = matrix.dimension();
        let ordering = self.symbolic.perm().map(|perm| {
            let (forward, inverse) = perm.arrays();
            (forward.to_vec(), inverse.to_vec())
        });
        let ordering = match &ordering {
            Some((forward, inverse)) => SymmetricOrdering::Custom(PermRef::new_checked(forward, inverse, n)),
            None => SymmetricOrdering::Identity,
        };
        // The old factor goes before the new one is made: at peak there is one.
        self.factor = Vec::new();
        *self = Self::with_ordering(matrix, ordering)?;
        Ok(())
    }

    fn factor_values(&mut self) -> Result<(), PoissonError> {
        self.factor.clear();
        self.factor.resize(self.symbolic.len_val(), 0.0);
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut scratch = MemBuffer::new(scratch);
        let matrix = SparseColMatRef::new(self.pattern.pattern(), &self.pattern.value);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut scratch),
                Default::default(),
            )
            .map(|_| ())
            .map_err(|_| PoissonError::NotPositiveDefinite)
    }

    /// Solves A x = b for each of the columns of `b`, in place.
    pub(crate) fn solve_in_place(&self, b: &mut [f64]) {
        let n = self.pattern.dimension();
        if n == 0 || b.is_empty() {
            return;
        }
        let columns = b.len() / n;
        let mut scratch = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq));
        let b = MatMut::from_column_major_slice_mut(b, n, columns);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            b,
            Par::Seq,
            MemStack::new(&mut scratch),
        );
    }

    /// y = A x for one column.
    pub(crate) fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for column in 0..x.len() {
            let [from, to] = [column, column + 1].map(|c| self.pattern.column_start[c] as usize);
            for (&row, &value) in self.pattern.row[from..to].iter().zip(&self.pattern.value[from..to]) {
                let row = row as usize;
                y[row] += value * x[column];
                if row != column {
                    y[column] += value * x[row];
                }
            }
        }
        y
    }

    /// The number of stored entries of the factor, padding of the supernodes included.
    pub(crate) fn factor_len(&self) -> usize {
        self.factor.len()
    }
}
