//! Small dense systems: by Gaussian elimination with partial pivoting, and by a Cholesky factor that grows by rows.

/// Solves A X = B for `columns` right-hand sides, both matrices row by row; none if A is singular.
pub(crate) fn solve(mut a: Vec<f64>, mut b: Vec<f64>, columns: usize) -> Option<Vec<f64>> {
    let n = b.len().checked_div(columns).unwrap_or(0);
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))?;
        let is_regular = a[pivot * n + k].abs() > 0.0; // not so with NaN either
        if !is_regular {
            return None;
        }
        swap_rows(&mut a, n, k, pivot);
        swap_rows(&mut b, columns, k, pivot);
        for i in k + 1..n {
            let share = a[i * n + k] / a[k * n + k];
            subtract_row(&mut a, n, i, k, share);
            subtract_row(&mut b, columns, i, k, share);
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            subtract_row(&mut b, columns, k, j, a[k * n + j]);
        }
        b[k * columns..(k + 1) * columns].iter_mut().for_each(|x| *x /= a[k * n + k]);
    }
    Some(b)
}

/// The inverse of an n × n matrix; none if it is singular.
pub(crate) fn invert(a: Vec<f64>, n: usize) -> Option<Vec<f64>> {
    let mut identity = vec![0.0; n * n];
    identity.iter_mut().step_by(n + 1).for_each(|x| *x = 1.0);
    solve(a, identity, n)
}

/// The Cholesky factor of a symmetric positive definite matrix to which rows are added.
#[derive(Debug, Default)]
pub(crate) struct Growing {
    /// The rows of the factor, up to the diagonal.
    row: Vec<Vec<f64>>,
}

impl Growing {
    /// Adds a row of the matrix, up to the diagonal; none if the matrix is not definite any more.
    pub(crate) fn with(mut self, mut row: Vec<f64>) -> Option<Self> {
        let diagonal = row.pop()?;
        self.forward(&mut row);
        let square = diagonal - row.iter().map(|x| x * x).sum::<f64>();
        let is_definite = square > f64::EPSILON * diagonal; // not so with NaN either
        row.push(square.sqrt());
        self.row.push(row);
        is_definite.then_some(self)
    }

    /// Solves A x = b.
    pub(crate) fn solve(&self, mut b: Vec<f64>) -> Vec<f64> {
        self.forward(&mut b);
        for (k, row) in self.row.iter().enumerate().rev() {
            b[k] /= row[k];
            let x = b[k];
            b[..k].iter_mut().zip(row).for_each(|(b, c)| *b -= c * x);
        }
        b
    }

    fn forward(&self, b: &mut [f64]) {
        for (k, row) in self.row.iter().enumerate() {
            let sum: f64 = row[..k].iter().zip(&b[..k]).map(|(c, b)| c * b).sum();
            b[k] = (b[k] - sum) / row[k];
        }
    }
}

fn swap_rows(a: &mut [f64], columns: usize, i: usize, j: usize) {
    for k in 0..columns {
        a.swap(i * columns + k, j * columns + k);
    }
}

/// Subtracts from row i a multiple of row j.
fn subtract_row(a: &mut [f64], columns: usize, i: usize, j: usize, share: f64) {
    for k in 0..columns {
        a[i * columns + k] -= share * a[j * columns + k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_the_identity() {
        let n = 7;
        let a: Vec<f64> = (0..n * n).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
        let inverse = invert(a.clone(), n).unwrap();
        for i in 0..n {
            for j in 0..n {
                let entry: f64 = (0..n).map(|k| a[i * n + k] * inverse[k * n + j]).sum();
                assert!((entry - f64::from(i == j)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_zero_on_the_diagonal_is_no_hindrance() {
        assert_eq!(solve(vec![0.0, 1.0, 2.0, 0.0], vec![3.0, 4.0], 1), Some(vec![2.0, 3.0]));
    }

    #[test]
    fn a_growing_factor_solves_as_elimination_does() {
        let n = 6;
        let entry = |i: usize, j: usize| 1.0 / (1 + i + j) as f64 + f64::from(u8::from(i == j));
        let matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let rows = (0..n).map(|i| (0..=i).map(|j| entry(i, j)).collect());
        let growing = rows.fold(Growing::default(), |growing, row| growing.with(row).unwrap());
        let right: Vec<f64> = (0..n).map(|k| k as f64 - 1.5).collect();
        let expected = solve(matrix, right.clone(), 1).unwrap();
        assert!(growing.solve(right).iter().zip(&expected).all(|(x, expected)| (x - expected).abs() < 1e-12));
        assert!(growing.with(vec![f64::NAN; n + 1]).is_none());
        assert!(Growing::default().with(vec![1.0]).unwrap().with(vec![1.0, 1.0]).is_none());
    }

    #[test]
    fn a_singular_matrix_has_no_inverse() {
        assert_eq!(invert(vec![1.0, 2.0, 2.0, 4.0], 2), None);
        assert_eq!(invert(vec![f64::NAN], 1), None);
    }
}
