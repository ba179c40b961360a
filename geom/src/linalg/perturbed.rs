//! Solves with a matrix that differs from a factored one much in few rows, and little in the others.
//!
//! Conjugate gradients, preconditioned by the factor that is there, converge as fast as the two matrices are alike. Where they differ
//! much, the rows are *near* the perturbation: these are solved for exactly, before and after each solve with the factor (a symmetric
//! multiplicative Schwarz method; Smith, Bjørstad & Gropp 1996). The Laplacian of a surface that is scaled to cones is such a matrix: Dirichlet
//! energies are conformally invariant, so away from the cones it hardly changes. With 134,345 vertices
//! and 16 cones (igea) an iteration lowers the residual by a factor of 45 to 90, and takes an eighth of a factorization; with 963,098 vertices a 25th.

use super::cholesky::Cholesky;
use super::single::dot;
use super::symmetric::{SymmetricMatrix, sums};
use crate::parallel::join;
use crate::rows::Rows;
use crate::watch::{Interrupted, Watch};

/// A row is near where its entries off the diagonal change by this share of the diagonal. (igea, 134,345 vertices, 16 cones: with 0.05,
/// 0.2 and 0.5 there are 443, 28 and 1 near rows, and 8, 14 and 20 iterations in all.)
const NEAR: f64 = 0.05;
/// With more near rows, as a share of all and in number, it is not worth it.
const MOST_NEAR: (usize, usize) = (8, 20_000);
/// More iterations cost as much as a factorization.
const MOST_ITERATIONS: usize = 10;
/// So many iterations have to lower the residual to [`LOWERED`] of itself.
const PATIENCE: usize = 3;
const LOWERED: f64 = 0.1;

impl Cholesky {
    /// Solves A x = b for another matrix than the factored one, until no entry of the residual is larger than `tolerance`; or until it would cost as
    /// much as to factor A. `None` if the two matrices differ too much, or A is not positive definite.
    pub(crate) fn solve_perturbed(
        &self,
        matrix: &SymmetricMatrix,
        b: &[f64],
        tolerance: f64,
        watch: Watch,
    ) -> Result<Option<Vec<f64>>, Interrupted> {
        let change = changes(self.matrix(), matrix);
        watch.ask(0.0)?;
        let is_near = |&row: &usize| change[row] > NEAR * self.matrix().get(row, row);
        let near: Vec<usize> = (0..matrix.dimension()).filter(is_near).collect();
        if near.len() > MOST_NEAR.1.min(matrix.dimension() / MOST_NEAR.0) {
            return Ok(None);
        }
        let (local, rows) = join(|| Self::new(&matrix.restricted(near.iter().copied())), || rows_of(matrix, &near));
        let Ok(local) = local else { return Ok(None) };
        watch.ask(0.0)?;
        Perturbed { factored: self, matrix, near, rows, local }.solve(b, tolerance, watch)
    }
}

struct Perturbed<'a> {
    factored: &'a Cholesky,
    matrix: &'a SymmetricMatrix,
    near: Vec<usize>,
    /// The entries of each near row, with their columns.
    rows: Rows<(u32, f64)>,
    /// The matrix of the near rows and columns, factored.
    local: Cholesky,
}

impl Perturbed<'_> {
    fn solve(&self, b: &[f64], tolerance: f64, watch: Watch) -> Result<Option<Vec<f64>>, Interrupted> {
        let mut x = vec![0.0; b.len()];
        let mut residual = b.to_vec();
        let first = largest(b);
        let mut direction = vec![0.0; b.len()];
        let mut energy = f64::INFINITY;
        for iteration in 1..=MOST_ITERATIONS {
            let conditioned = self.precondition(&residual, watch)?;
            let last = std::mem::replace(&mut energy, dot(&residual, &conditioned));
            let share = energy / last;
            by_halves(&mut direction, &conditioned, |direction, z| *direction = z + share * *direction);
            let image = self.matrix.multiply_by_halves(&direction);
            let length = energy / dot(&direction, &image);
            if !length.is_finite() || length <= 0.0 {
                return Ok(None);
            }
            let (left, ()) = join(
                || {
                    add(&mut residual, -length, &image);
                    largest(&residual)
                },
                || add(&mut x, length, &direction),
            );
            watch.ask(0.0)?;
            if left <= tolerance {
                return Ok(Some(x));
            }
            if iteration == PATIENCE && left > LOWERED * first {
                return Ok(None);
            }
        }
        Ok(Some(x))
    }

    /// About A⁻¹ of a residual: the near rows, all with the factor, the near rows again.
    fn precondition(&self, residual: &[f64], watch: Watch) -> Result<Vec<f64>, Interrupted> {
        let first = self.local.solve(&self.near.iter().map(|&row| residual[row]).collect::<Vec<f64>>());
        let mut x = residual.to_vec();
        for (k, x_k) in first.iter().enumerate() {
            self.rows.row(k).iter().for_each(|&(column, value)| x[column as usize] -= value * x_k);
        }
        self.factored.solve_columns(&mut [&mut x], &|row| row, watch.within(0.0, 0.0))?;
        self.near.iter().zip(first).for_each(|(&row, first)| x[row] += first);
        let product = |k| self.rows.row(k).iter().map(|&(column, value)| value * x[column as usize]).sum::<f64>();
        let rest: Vec<f64> = self.near.iter().enumerate().map(|(k, &row)| residual[row] - product(k)).collect();
        self.near.iter().zip(self.local.solve(&rest)).for_each(|(&row, correction)| x[row] += correction);
        Ok(x)
    }
}

/// The entries of some rows, in both triangles, with their columns.
fn rows_of(matrix: &SymmetricMatrix, rows: &[usize]) -> Rows<(u32, f64)> {
    const NONE: usize = usize::MAX;
    let mut place = vec![NONE; matrix.dimension()];
    rows.iter().enumerate().for_each(|(k, &row)| place[row] = k);
    let mut entries = Vec::new();
    for column in 0..matrix.dimension() {
        let is_near = place[column] != NONE;
        for (row, value) in matrix.column(column) {
            if place[row] != NONE {
                entries.push((place[row], (column as u32, value)));
            }
            if is_near && row != column {
                entries.push((place[column], (row as u32, value)));
            }
        }
    }
    Rows::sorted(rows.len(), entries.into_iter())
}

/// For each row the sum of how much its entries off the diagonal differ.
fn changes(from: &SymmetricMatrix, to: &SymmetricMatrix) -> Vec<f64> {
    sums(from.dimension(), |column, first, changes| {
        let [old, new] = [from, to].map(|matrix| matrix.below(column));
        let mut add = |row: usize, change: f64| {
            changes[column - first] += change.abs();
            changes[row - first] += change.abs();
        };
        if old.0 == new.0 {
            let values = old.1.iter().zip(new.1);
            old.0.iter().zip(values).for_each(|(&row, (before, after))| add(row as usize, before - after));
            return;
        }
        let mut before = from.column(column).skip(1).peekable();
        let mut after = to.column(column).skip(1).peekable();
        while let Some(row) = before.peek().into_iter().chain(after.peek()).map(|entry| entry.0).min() {
            let value = |entry: Option<(usize, f64)>| entry.map_or(0.0, |entry| entry.1);
            add(row, value(before.next_if(|entry| entry.0 == row)) - value(after.next_if(|entry| entry.0 == row)));
        }
    })
}

/// Changes each entry of a vector by that of another one.
fn by_halves(x: &mut [f64], y: &[f64], change: impl Fn(&mut f64, &f64) + Sync) {
    let half = x.len() / 2;
    let ((x, other_x), (y, other_y)) = (x.split_at_mut(half), y.split_at(half));
    let change = |x: &mut [f64], y: &[f64]| x.iter_mut().zip(y).for_each(|(x, y)| change(x, y));
    join(|| change(x, y), || change(other_x, other_y));
}

/// Adds a multiple of a vector.
fn add(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most, x| if x.abs() > most || x.is_nan() { x.abs() } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Metric, VertexData, laplacian, shapes};

    /// The Laplacian of a shape whose metric is scaled at and round one vertex, without its last row.
    fn scaled(spike: f64) -> SymmetricMatrix {
        let shape = shapes::hare(3000);
        let mesh = shape.mesh();
        let mut u = VertexData::constant(mesh.vertex_count(), 0.0);
        let tip = mesh.vertices().next().expect("it has vertices");
        u[tip] = spike;
        mesh.neighbors(tip).iter().for_each(|&v| u[v] = 0.3 * spike);
        let metric = Metric::from_points(&mesh, &shape.points).scaled(&mesh, &u);
        laplacian(&mesh, &metric).restricted(0..mesh.vertex_count() - 1)
    }

    fn residual(matrix: &SymmetricMatrix, x: &[f64], b: &[f64]) -> f64 {
        matrix.multiply(x).iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_matrix_that_differs_in_few_rows_is_solved_with_by_the_factor_of_the_other() {
        let factored = Cholesky::new(&scaled(0.0)).unwrap();
        let rows = factored.matrix().dimension() as u32;
        let b: Vec<f64> = (0..rows).map(|row| f64::from(row * 7919 % 101) - 50.0).collect();
        for spike in [0.0, 0.5, -0.6] {
            let matrix = scaled(spike);
            let x = factored.solve_perturbed(&matrix, &b, 1e-9, Watch::NONE).unwrap();

            let left = x.map(|x| residual(&matrix, &x, &b));
            assert!(left.is_some_and(|left| left <= 2e-9), "{spike}: {left:?}");
        }
    }

    #[test]
    fn the_preconditioner_is_symmetric_and_exact_at_near_rows() {
        let (factored, matrix) = (Cholesky::new(&scaled(0.0)).unwrap(), scaled(0.5));
        let near: Vec<usize> = (0..40).collect();
        let local = Cholesky::new(&matrix.restricted(near.iter().copied())).unwrap();
        let rows = rows_of(&matrix, &near);
        let perturbed = Perturbed { factored: &factored, matrix: &matrix, near, rows, local };
        let rows = matrix.dimension() as u32;
        let [b, c] = [7919, 6007].map(|k| (0..rows).map(|row| f64::from(row * k % 101) - 50.0).collect::<Vec<f64>>());
        let [x, y] = [&b, &c].map(|b| perturbed.precondition(b, Watch::NONE).unwrap());
        assert!((dot(&x, &c) / dot(&y, &b) - 1.0).abs() < 1e-9);
        let product = matrix.multiply(&x);
        assert!((0..40).all(|row| (product[row] - b[row]).abs() < 1e-9));
    }

    #[test]
    fn changes_are_counted_where_both_matrices_have_entries_and_where_one_has() {
        let laplacian = |diagonal: [u32; 2], weight| {
            let edges = [([0, 1], weight), ([1, 2], 1.0), ([2, 3], 1.0), ([0, 3], 2.0), (diagonal, 0.5)];
            SymmetricMatrix::laplacian(4, edges.into_iter())
        };
        let from = laplacian([0, 2], 1.0);
        assert_eq!(changes(&from, &laplacian([0, 2], 4.0)), [3.0, 3.0, 0.0, 0.0]);
        assert_eq!(changes(&from, &laplacian([1, 3], 4.0)), [3.5, 3.5, 0.5, 0.5]);
    }

    #[test]
    fn a_matrix_that_differs_everywhere_is_refused() {
        let factored = Cholesky::new(&scaled(0.0)).unwrap();
        let mut matrix = scaled(0.0);
        matrix.scale(2.0);
        let b = vec![1.0; matrix.dimension()];
        assert!(factored.solve_perturbed(&matrix, &b, 1e-9, Watch::NONE).unwrap().is_none());
    }
}
