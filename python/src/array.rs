//! Numpy's arrays as slices, and vectors as numpy's arrays. Neither copies: Python hands over arrays that lie in memory row by row, and
//! a vector becomes the array's memory.

use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::error::Error;

/// The rows of an array of `N` columns.
pub(crate) fn rows<'a, T: Element, const N: usize>(
    array: &'a PyReadonlyArray2<'_, T>,
    name: &str,
) -> PyResult<&'a [[T; N]]> {
    use numpy::PyUntypedArrayMethods;
    let [rows, columns] = [0, 1].map(|axis| array.shape()[axis]);
    let refused = || Error::new_err(format!("{name} must have the shape (n, {N}), but it has ({rows}, {columns})"));
    if columns != N {
        return Err(refused());
    }
    let (rows, rest) = array.as_slice().map_err(|_| refused())?.as_chunks::<N>();
    debug_assert!(rest.is_empty(), "there are N columns");
    Ok(rows)
}

/// An array of `N` columns.
pub(crate) fn from_rows<'py, T: Element, const N: usize>(
    py: Python<'py>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let shape = [rows.len(), N];
    PyArray1::from_vec(py, rows.into_flattened()).reshape(shape)
}
