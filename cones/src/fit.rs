//! Temporary.
pub(crate) struct Quadratic<'a> { pub(crate) constant: f64, pub(crate) linear: &'a [f64], pub(crate) matrix: &'a [f64] }
pub(crate) fn solve_dense(mut a: Vec<f64>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for k in 0..n {
        let p = (k..n).max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))?;
        if a[p * n + k] == 0.0 { return None; }
        for j in 0..n { a.swap(k * n + j, p * n + j); }
        b.swap(k, p);
        for i in k + 1..n {
            let f = a[i * n + k] / a[k * n + k];
            for j in k..n { a[i * n + j] -= f * a[k * n + j]; }
            b[i] -= f * b[k];
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n { b[k] -= a[k * n + j] * b[j]; }
        b[k] /= a[k * n + k];
    }
    Some(b)
}
pub(crate) fn minimise(q: &Quadratic, _lo: &[f64], hi: &[f64], total: Option<f64>) -> Result<Vec<f64>, ()> {
    let n = hi.len();
    let s = n + usize::from(total.is_some());
    let mut a = vec![0.0; s * s];
    let mut b = vec![0.0; s];
    for i in 0..n { for j in 0..n { a[i * s + j] = q.matrix[i * n + j]; } b[i] = -q.linear[i];
        if total.is_some() { a[i * s + n] = 1.0; a[n * s + i] = 1.0; } }
    if let Some(t) = total { b[n] = t; }
    let _ = q.constant;
    let mut x = solve_dense(a, b).ok_or(())?; x.truncate(n); Ok(x)
}
