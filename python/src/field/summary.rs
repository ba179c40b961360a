//! Persistence by blocks: [`topo::Summary`] as bytes, which any engine can carry.
//!
//! A tile becomes bytes and the pairs that are final; bytes are joined to bytes and more pairs. Nothing is kept here in between.

use num_traits::{Bounded, FromBytes, ToBytes};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use topo::{Grid, Summary, Tile};

use super::domain::{Domain, DomainKind};
use super::number::Number;
use super::pairs::{Columns, columns};
use super::{kind, on_pool, options};
use crate::error::Error;

/// A number that summaries can be written with.
trait Written: Number + Bounded + ToBytes + FromBytes<Bytes = <Self as ToBytes>::Bytes> {}

impl<S: Number + Bounded + ToBytes + FromBytes<Bytes = <Self as ToBytes>::Bytes>> Written for S {}

/// The bytes of a summary, and the columns of the pairs that are final, with the number of those of zero persistence.
type Summarised<'py> = (Bound<'py, PyBytes>, Columns<'py>, usize);

/// Sums up a tile of a grid: the vertices from `start` to `stop` along each axis, and the layer after them where there is one.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "what Python gives by name")]
pub(crate) fn summarise<'py>(
    py: Python<'py>,
    grid: &Domain,
    start: Vec<usize>,
    stop: Vec<usize>,
    field: &Bound<'py, PyAny>,
    is_superlevel: bool,
    masks_nan: bool,
    keeps_zeros: bool,
) -> PyResult<Summarised<'py>> {
    let asked = (is_superlevel, masks_nan, keeps_zeros);
    let own = (&start[..], &stop[..]);
    macro_rules! on_grid {
        ($grid:ident) => {
            with_field!(field, [u8, u16, i16, i32, i64, u64, f32, f64], values => of_tile(py, $grid, own, values, asked))
        };
    }
    match &grid.kind {
        DomainKind::Line(grid) => on_grid!(grid),
        DomainKind::Picture(grid) => on_grid!(grid),
        DomainKind::Volume(grid) => on_grid!(grid),
        _ => Err(Error::new_err("tiles are of grids")),
    }
}

fn of_tile<'py, S: Written, const D: usize>(
    py: Python<'py>,
    grid: &Grid<D>,
    (start, stop): (&[usize], &[usize]),
    values: &[S],
    (is_superlevel, masks_nan, keeps_zeros): (bool, bool, bool),
) -> PyResult<Summarised<'py>> {
    let bounds = |ends: &[usize]| <[usize; D]>::try_from(ends).ok();
    let (Some(start), Some(stop)) = (bounds(start), bounds(stop)) else {
        return Err(Error::new_err(format!("a tile of this grid has {D} bounds below and above")));
    };
    let summary = on_pool(py, || {
        let tile = Tile::new(grid, core::array::from_fn(|axis| start[axis]..stop[axis]))?;
        Summary::of_tile(&tile, values, kind(is_superlevel), options(masks_nan, keeps_zeros))
    })?;
    Ok(written(py, summary))
}

/// Joins summaries of fields of one kind of numbers, named as numpy does (`"f8"`).
#[pyfunction]
pub(crate) fn join_summaries<'py>(
    py: Python<'py>,
    number: &str,
    parts: Vec<PyBackedBytes>,
) -> PyResult<Summarised<'py>> {
    macro_rules! of_number {
        ($($name:literal => $number:ty),*) => {
            match number {
                $($name => join::<$number>(py, &parts),)*
                other => Err(Error::new_err(format!("there are no summaries of fields of {other}"))),
            }
        };
    }
    of_number!("u1" => u8, "u2" => u16, "i2" => i16, "i4" => i32, "i8" => i64, "u8" => u64, "f4" => f32, "f8" => f64)
}

fn join<'py, S: Written>(py: Python<'py>, parts: &[PyBackedBytes]) -> PyResult<Summarised<'py>> {
    let summary = on_pool(py, || {
        let mut parts = parts.iter().map(|part| Summary::<S>::from_bytes(part));
        let first = parts.next().unwrap_or_else(|| Ok(Summary::empty(kind(false), options(false, false))))?;
        parts.try_fold(first, |joined, part| joined.join(part?))
    })?;
    Ok(written(py, summary))
}

/// How many vertices of a summary are shared with blocks that have not been joined: 0 at the end.
#[pyfunction]
pub(crate) fn open_vertices(number: &str, bytes: PyBackedBytes) -> PyResult<usize> {
    macro_rules! of_number {
        ($($name:literal => $number:ty),*) => {
            match number {
                $($name => Summary::<$number>::from_bytes(&bytes).map(|summary| summary.shared_count()),)*
                other => return Err(Error::new_err(format!("there are no summaries of fields of {other}"))),
            }
        };
    }
    let open = of_number!("u1" => u8, "u2" => u16, "i2" => i16, "i4" => i32, "i8" => i64, "u8" => u64, "f4" => f32, "f8" => f64);
    Ok(open.map_err(crate::error::Failed)?)
}

fn written<'py, S: Written>(py: Python<'py>, mut summary: Summary<S>) -> Summarised<'py> {
    let (pairs, bytes) = py.detach(|| {
        let pairs = summary.take_pairs();
        (pairs, summary.to_bytes())
    });
    (PyBytes::new(py, &bytes), columns(py, &pairs, |vertex| vertex as i64), pairs.zero_count())
}
