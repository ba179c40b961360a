//! Small dense systems, by Gaussian elimination with partial pivoting.

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
    fn a_singular_matrix_has_no_inverse() {
        assert_eq!(invert(vec![1.0, 2.0, 2.0, 4.0], 2), None);
        assert_eq!(invert(vec![f64::NAN], 1), None);
    }
}
