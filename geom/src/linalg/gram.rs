//! The Gram matrix of many functions on a mesh.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, MatRef, Par};

use std::ops::Deref;

use super::registers;
use crate::watch::{Interrupted, Watch, unwatched};

/// So many vertices are multiplied at a time: their values, copied side by side, stay in the cache.
const BLOCK: usize = 2048;

/// The inner products `Σ_v w_v x_i(v) x_j(v)` of functions `x` for weights w that are not negative, as a symmetric matrix
/// by rows. O(n k²) for k functions on n vertices, at the speed of dense matrix products.
///
/// ```
/// let gram = geom::gram(&[vec![1.0, 2.0], vec![0.0, 1.0]], &[0.5, 0.25]);
/// assert_eq!(gram, [1.5, 0.5, 0.5, 0.25]);
/// ```
///
/// # Panics
/// If a function is shorter than the weights.
pub fn gram<X: Deref<Target = [f64]>>(functions: &[X], weight: &[f64]) -> Vec<f64> {
    unwatched(gram_watched(functions, weight, Watch::NONE))
}

/// [`gram`], watched.
///
/// # Errors
/// If it is stopped.
///
/// # Panics
/// If a function is shorter than the weights.
pub fn gram_watched<X: Deref<Target = [f64]>>(
    functions: &[X],
    weight: &[f64],
    watch: Watch,
) -> Result<Vec<f64>, Interrupted> {
    let count = functions.len();
    let root: Vec<f64> = weight.iter().map(|w| w.sqrt()).collect();
    let mut products = Mat::zeros(count, count);
    let mut block = vec![0.0; BLOCK * count];
    for start in (0..weight.len()).step_by(BLOCK) {
        watch.ask(start as f64 / weight.len() as f64)?;
        let root = &root[start..weight.len().min(start + BLOCK)];
        for (column, function) in block.chunks_exact_mut(root.len()).zip(functions) {
            let values = &function[start..start + root.len()];
            column.iter_mut().zip(values.iter().zip(root)).for_each(|(x, (value, root))| *x = value * root);
        }
        let x = MatRef::from_column_major_slice(&block[..root.len() * count], root.len(), count);
        matmul(
            products.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            x.transpose(),
            BlockStructure::Rectangular,
            x,
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
    }
    registers::clear();
    let entry = |k: usize| products[((k / count).max(k % count), (k / count).min(k % count))];
    Ok((0..count * count).map(entry).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_add_up() {
        let weight: Vec<f64> = (0..BLOCK + 77).map(|v| (v % 7) as f64).collect();
        let functions: Vec<Vec<f64>> =
            (1..6).map(|k| (0..weight.len()).map(|v| ((v * k) as f64 * 0.1).sin()).collect()).collect();
        let gram = gram(&functions, &weight);
        for (i, x) in functions.iter().enumerate() {
            for (j, y) in functions.iter().enumerate() {
                let product: f64 = weight.iter().zip(x).zip(y).map(|((w, x), y)| w * x * y).sum();
                assert!((gram[i * functions.len() + j] - product).abs() < 1e-9);
            }
        }
        assert!(super::gram::<Vec<f64>>(&[], &weight).is_empty());
    }
}
