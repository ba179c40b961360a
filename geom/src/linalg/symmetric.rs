//! Symmetric sparse matrices, kept by their lower triangles: half the memory of all entries, and what a factorization reads.

use std::ops::Range;

use sprs::CsMat;

use crate::parallel;
use crate::rows::Rows;

/// The place of a row that is not kept.
const NONE: u32 = u32::MAX;

/// A symmetric sparse matrix. Stored are the entries on the diagonal and below, column by column: first the diagonal one,
/// which is always there, then the others by rising row.
///
/// ```
/// # use geom::{Mesh, Metric, laplacian};
/// let triangle = Mesh::new(3, &[[0, 1, 2]])?;
/// let matrix = laplacian(&triangle, &Metric::new(vec![1.0; 3].into()));
/// assert_eq!(matrix.get(0, 2), matrix.get(2, 0));
/// assert!(matrix.multiply(&[1.0; 3]).iter().all(|x| x.abs() < 1e-15));
/// assert_eq!(matrix.to_csr().nnz(), 9);
/// # Ok::<(), geom::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricMatrix {
    pub(crate) column_start: Vec<u32>,
    pub(crate) row: Vec<u32>,
    pub(crate) value: Vec<f64>,
}

impl SymmetricMatrix {
    /// The Laplacian of a weighted graph on `dimension` vertices: `Σ w (e_i - e_j)(e_i - e_j)ᵀ` over its edges ij.
    /// Repeated edges add up and loops cancel.
    pub(crate) fn laplacian(dimension: usize, edges: impl Iterator<Item = ([u32; 2], f64)> + Clone + Sync) -> Self {
        let edges = edges.filter(|([i, j], _)| i != j);
        // Which end is the lower one is as good as random: nothing branches on it.
        let below = edges.clone().map(|([i, j], weight)| (i.min(j), i.max(j), weight));
        Self::with_sums(dimension, below, edges.flat_map(|([i, j], weight)| [(i, weight), (j, weight)]))
    }

    /// The first `dimension` rows of a graph's Laplacian, on vectors whose entry at any vertex is that at the one which it `stands_for`, one of
    /// the first: the columns are added up so. What comes of it must be symmetric where it is read.
    pub(crate) fn folded_laplacian(
        dimension: usize,
        edges: impl Iterator<Item = ([u32; 2], f64)> + Clone + Sync,
        stands_for: impl Fn(u32) -> u32 + Sync,
    ) -> Self {
        let entries = edges
            .filter(|([i, j], _)| i != j)
            .flat_map(|([i, j], weight)| [(i, j, weight), (j, i, weight)])
            .filter(|&(v, ..)| (v as usize) < dimension)
            .map(|(v, w, weight)| (v, stands_for(w), weight));
        let below = entries.clone().filter(|(column, row, _)| column < row);
        // An edge to what stands for the same vertex cancels.
        let outside = entries.filter(|(v, w, _)| v != w).map(|(v, _, weight)| (v, weight));
        Self::with_sums(dimension, below, outside)
    }

    /// A matrix with the negated weights below the diagonal, given with column and row, and on it the sums of others.
    fn with_sums(
        dimension: usize,
        below: impl Iterator<Item = (u32, u32, f64)> + Clone + Sync,
        diagonal: impl Iterator<Item = (u32, f64)> + Clone + Sync,
    ) -> Self {
        let sums = || {
            let mut sums = vec![0.0; dimension];
            diagonal.clone().for_each(|(v, weight)| sums[v as usize] += weight);
            sums
        };
        let put = || {
            let mut column_start = vec![1u32; dimension + 1];
            column_start[0] = 0;
            below.clone().for_each(|(column, ..)| column_start[column as usize + 1] += 1);
            for column in 0..dimension {
                column_start[column + 1] += column_start[column];
            }
            let stored = column_start[dimension] as usize;
            let mut matrix = Self { column_start, row: vec![0; stored], value: vec![0.0; stored] };
            let mut end = matrix.column_start[..dimension].to_vec();
            for (column, end) in end.iter_mut().enumerate() {
                matrix.row[*end as usize] = column as u32;
                *end += 1;
            }
            below.clone().for_each(|(column, row, weight)| {
                // Columns are short: a new entry is moved up to its place.
                let end = &mut end[column as usize];
                let mut place = *end as usize;
                while matrix.row[place - 1] > row {
                    place -= 1;
                }
                if matrix.row[place - 1] == row {
                    matrix.value[place - 1] -= weight;
                    return;
                }
                for k in (place..*end as usize).rev() {
                    (matrix.row[k + 1], matrix.value[k + 1]) = (matrix.row[k], matrix.value[k]);
                }
                matrix.row[place] = row;
                matrix.value[place] = -weight;
                *end += 1;
            });
            matrix.close_gaps(&end);
            matrix
        };
        let (sums, mut matrix) = parallel::join(sums, put);
        sums.into_iter().enumerate().for_each(|(i, sum)| *matrix.diagonal_mut(i) = sum);
        matrix
    }

    /// A matrix of zeros that has room for the diagonal and for entries at these places, given once or often, from either side.
    ///
    /// # Panics
    /// If a place is outside the matrix.
    pub fn zeros(dimension: usize, places: impl Iterator<Item = [usize; 2]> + Clone) -> Self {
        let below = places.map(|[i, j]| (i.min(j), i.max(j) as u32)).filter(|&(column, row)| column < row as usize);
        let mut columns = Rows::sorted(dimension, below);
        let mut matrix = Self { column_start: vec![0], row: Vec::new(), value: Vec::new() };
        for column in 0..dimension {
            matrix.row.push(column as u32);
            let rows = columns.row_mut(column);
            rows.sort_unstable();
            matrix.row.extend(rows.chunk_by(|a, b| a == b).map(|same| same[0]));
            matrix.column_start.push(matrix.row.len() as u32);
        }
        assert!(matrix.row.iter().all(|&row| (row as usize) < dimension), "a place is outside the matrix");
        matrix.value = vec![0.0; matrix.row.len()];
        matrix
    }

    /// Where an entry is stored among the [values](Self::values_mut).
    ///
    /// # Panics
    /// If it is outside the matrix.
    pub fn place(&self, i: usize, j: usize) -> Option<usize> {
        let entries = self.range(i.min(j));
        self.row[entries.clone()].binary_search(&(i.max(j) as u32)).ok().map(|place| entries.start + place)
    }

    /// The stored entries, column by column.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.value
    }

    /// Moves columns together where they end before the next one starts.
    fn close_gaps(&mut self, end: &[u32]) {
        let mut filled = 0;
        for (column, &end) in end.iter().enumerate() {
            let entries = self.column_start[column] as usize..end as usize;
            if filled < entries.start {
                self.column_start[column] = filled as u32;
                self.row.copy_within(entries.clone(), filled);
                self.value.copy_within(entries.clone(), filled);
            }
            filled += entries.len();
        }
        self.column_start[end.len()] = filled as u32;
        self.row.truncate(filled);
        self.value.truncate(filled);
    }

    /// The number of rows, and of columns.
    pub fn dimension(&self) -> usize {
        self.column_start.len() - 1
    }

    /// The number of entries that are stored: those on the diagonal and below.
    pub fn stored(&self) -> usize {
        self.row.len()
    }

    /// Where the entries of a column are stored.
    pub(crate) fn range(&self, column: usize) -> Range<usize> {
        self.column_start[column] as usize..self.column_start[column + 1] as usize
    }

    /// The rows and values of a column's entries below the diagonal.
    pub(crate) fn below(&self, column: usize) -> (&[u32], &[f64]) {
        let entries = self.range(column).start + 1..self.range(column).end;
        (&self.row[entries.clone()], &self.value[entries])
    }

    /// The entries of a column on the diagonal and below, with their rows.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
        self.range(column).map(|k| (self.row[k] as usize, self.value[k]))
    }

    /// An entry; 0 where none is stored.
    ///
    /// # Panics
    /// If it is outside the matrix.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        assert!(i < self.dimension() && j < self.dimension(), "entry ({i}, {j}) is outside the matrix");
        self.place(i, j).map_or(0.0, |place| self.value[place])
    }

    /// An entry of the diagonal.
    ///
    /// # Panics
    /// If it is outside the matrix.
    pub fn diagonal_mut(&mut self, i: usize) -> &mut f64 {
        &mut self.value[self.column_start[i] as usize]
    }

    /// Multiplies all entries.
    pub fn scale(&mut self, factor: f64) {
        self.value.iter_mut().for_each(|value| *value *= factor);
    }

    /// The product with a vector.
    ///
    /// # Panics
    /// If the vector is shorter than the matrix.
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.dimension()];
        (0..y.len()).for_each(|column| self.add_products(column, x, 0, &mut y));
        y
    }

    /// The same but for rounding, on two threads (see [`sums`]).
    pub(super) fn multiply_by_halves(&self, x: &[f64]) -> Vec<f64> {
        sums(self.dimension(), |column, first, y| self.add_products(column, x, first, y))
    }

    /// Adds what comes of a column and of the row on the other side of the diagonal, to the product's rows from the `first` on.
    fn add_products(&self, column: usize, x: &[f64], first: usize, y: &mut [f64]) {
        let (rows, values) = self.below(column);
        let mut own = y[column - first] + self.value[self.range(column).start] * x[column];
        for (&row, &value) in rows.iter().zip(values) {
            y[row as usize - first] += value * x[column];
            own += value * x[row as usize];
        }
        y[column - first] = own;
    }

    /// The rows and columns with the given indices, which must rise.
    ///
    /// # Panics
    /// If there is no such row.
    #[must_use]
    pub fn restricted(&self, kept: impl ExactSizeIterator<Item = usize> + Clone) -> Self {
        debug_assert!(kept.clone().is_sorted_by(|a, b| a < b), "the rows that are kept rise");
        let index = self.numbered(kept.clone());
        let mut restricted = Self { column_start: vec![0], row: Vec::new(), value: Vec::new() };
        for column in kept {
            let entries = self.range(column).map(|k| (index[self.row[k] as usize], self.value[k]));
            for (row, value) in entries.filter(|&(row, _)| row != NONE) {
                restricted.row.push(row);
                restricted.value.push(value);
            }
            restricted.column_start.push(restricted.row.len() as u32);
        }
        restricted
    }

    /// The same in the place of the whole matrix.
    ///
    /// # Panics
    /// If there is no such row.
    #[must_use]
    pub fn into_restricted(mut self, kept: impl ExactSizeIterator<Item = usize> + Clone) -> Self {
        debug_assert!(kept.clone().is_sorted_by(|a, b| a < b), "the rows that are kept rise");
        let count = kept.len();
        if kept.clone().eq(0..count) {
            let end = |column| {
                self.range(column).end - self.range(column).rev().take_while(|&k| self.row[k] as usize >= count).count()
            };
            let end: Vec<u32> = (0..count).map(|column| end(column) as u32).collect();
            self.column_start.truncate(count + 1);
            self.close_gaps(&end);
            return self;
        }
        let index = self.numbered(kept.clone());
        let mut column_start = Vec::with_capacity(kept.len() + 1);
        column_start.push(0);
        let mut filled = 0;
        for column in kept {
            for k in self.range(column) {
                let row = index[self.row[k] as usize];
                if row != NONE {
                    (self.row[filled], self.value[filled]) = (row, self.value[k]);
                    filled += 1;
                }
            }
            column_start.push(filled as u32);
        }
        self.row.truncate(filled);
        self.value.truncate(filled);
        Self { column_start, ..self }
    }

    /// The place of each row among those that are kept, or [`NONE`].
    fn numbered(&self, kept: impl Iterator<Item = usize>) -> Vec<u32> {
        let mut index = vec![NONE; self.dimension()];
        kept.zip(0..).for_each(|(i, k)| index[i] = k);
        index
    }

    /// All entries, both triangles.
    pub fn to_csr(&self) -> CsMat<f64> {
        let n = self.dimension();
        let mut start = vec![0usize; n + 1];
        for column in 0..n {
            for &row in &self.row[self.range(column)] {
                start[row as usize + 1] += 1;
                start[column + 1] += usize::from(row as usize != column);
            }
        }
        for v in 0..n {
            start[v + 1] += start[v];
        }
        let mut end = start.clone();
        let (mut indices, mut values) = (vec![0; start[n]], vec![0.0; start[n]]);
        let mut put = |row: usize, column: usize, value: f64| {
            (indices[end[row]], values[end[row]]) = (column, value);
            end[row] += 1;
        };
        // Column by column from the left each row is filled by rising column: up to the diagonal, and then beyond it.
        for column in 0..n {
            self.column(column).for_each(|(row, value)| put(row, column, value));
            self.column(column).skip(1).for_each(|(row, value)| put(column, row, value));
        }
        CsMat::new((n, n), start, indices, values)
    }
}

/// Sums for each row of a symmetric matrix, of what each column `adds` to its own and to those below: two halves of the columns at the same
/// time. `adds` gets the column, the first of its half, and the sums from there on.
pub(super) fn sums(dimension: usize, adds: impl Fn(usize, usize, &mut [f64]) + Sync) -> Vec<f64> {
    let of = |columns: Range<usize>| {
        let mut sums = vec![0.0; dimension - columns.start];
        columns.clone().for_each(|column| adds(column, columns.start, &mut sums));
        sums
    };
    let half = dimension / 2;
    let (mut sums, lower) = parallel::join(|| of(0..half), || of(half..dimension));
    sums[half..].iter_mut().zip(lower).for_each(|(sum, more)| *sum += more);
    sums
}

/// Takes the lower triangle of a matrix that is symmetric.
impl From<&CsMat<f64>> for SymmetricMatrix {
    fn from(matrix: &CsMat<f64>) -> Self {
        let mut lower = Self { column_start: vec![0], row: Vec::new(), value: Vec::new() };
        // Its rows are its columns.
        for (column, entries) in matrix.outer_iterator().enumerate() {
            lower.row.push(column as u32);
            lower.value.push(entries.get(column).copied().unwrap_or(0.0));
            for (row, value) in entries.iter().filter(|(row, _)| *row > column) {
                lower.row.push(row as u32);
                lower.value.push(*value);
            }
            lower.column_start.push(lower.row.len() as u32);
        }
        lower
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_matrix_of_zeros_has_the_places_that_were_asked_for() {
        let mut matrix = SymmetricMatrix::zeros(4, [[2, 0], [0, 2], [3, 1], [1, 1], [2, 0]].into_iter());
        assert_eq!((matrix.stored(), matrix.place(1, 0), matrix.place(3, 2)), (6, None, None));
        for ([i, j], value) in [([0, 2], 1.0), ([1, 3], 2.0), ([3, 3], 3.0)] {
            assert_eq!(matrix.place(i, j), matrix.place(j, i));
            let place = matrix.place(i, j).unwrap();
            matrix.values_mut()[place] = value;
            assert_eq!(matrix.get(j, i), value);
        }
        assert_eq!(matrix.multiply(&[1.0; 4]), [1.0, 2.0, 1.0, 5.0]);
    }

    proptest! {
        #[test]
        fn a_graph_s_laplacian_is_the_sum_over_its_edges(
            edges in proptest::collection::vec((0..9u32, 0..9u32, -2.0..2.0f64), 0..40),
        ) {
            let mut dense = [[0.0; 9]; 9];
            for &(i, j, weight) in edges.iter().filter(|(i, j, _)| i != j) {
                let [i, j] = [i as usize, j as usize];
                (dense[i][i], dense[j][j]) = (dense[i][i] + weight, dense[j][j] + weight);
                (dense[i][j], dense[j][i]) = (dense[i][j] - weight, dense[j][i] - weight);
            }
            let matrix = SymmetricMatrix::laplacian(9, edges.iter().map(|&(i, j, weight)| ([i, j], weight)));
            let full = matrix.to_csr();
            prop_assert_eq!(&SymmetricMatrix::from(&full), &matrix);
            let x: Vec<f64> = (0..9).map(|k| f64::from(k * k) - 7.0).collect();
            let product = matrix.multiply(&x);
            let by_halves = matrix.multiply_by_halves(&x);
            prop_assert!(product.iter().zip(by_halves).all(|(one, other)| (one - other).abs() < 1e-10));
            for (i, row) in dense.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    prop_assert!((matrix.get(i, j) - entry).abs() < 1e-12);
                    prop_assert_eq!(full.get(i, j).copied().unwrap_or(0.0), matrix.get(i, j));
                }
                let expected: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
                prop_assert!((product[i] - expected).abs() < 1e-10);
            }
            // The last four rows stand for the first ones.
            let edges = edges.iter().map(|&(i, j, weight)| ([i, j], weight));
            let folded = SymmetricMatrix::folded_laplacian(5, edges, |v| v % 5);
            for (i, row) in dense.iter().enumerate().take(5) {
                for j in i..5 {
                    let sum: f64 = row.iter().skip(j).step_by(5).sum();
                    prop_assert!((folded.get(i, j) - sum).abs() < 1e-12);
                }
            }
            let kept = [1, 2, 5, 8];
            let restricted = matrix.restricted(kept.into_iter());
            prop_assert_eq!(&matrix.clone().into_restricted(kept.into_iter()), &restricted);
            prop_assert_eq!(matrix.clone().into_restricted(0..6), matrix.restricted(0..6));
            for (i, &v) in kept.iter().enumerate() {
                for (j, &w) in kept.iter().enumerate() {
                    prop_assert_eq!(restricted.get(i, j), matrix.get(v, w));
                }
            }
        }
    }
}
