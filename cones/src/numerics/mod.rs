//! Small dense systems and a minimiser: no geometry.

pub(crate) mod dense;
pub(crate) mod lattice;
pub(crate) mod lbfgs;
pub(crate) mod quadratic_program;
pub(crate) mod random;

/// a · b, in eight sums that do not wait for each other.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a, a_tail) = a.as_chunks::<8>();
    let (b, b_tail) = b.as_chunks::<8>();
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    let tail: f64 = a_tail.iter().zip(b_tail).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + tail
}
