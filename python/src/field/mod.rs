//! Persistence of fields: numpy's arrays on grids, graphs and meshes, with [`topo`].
//!
//! Arrays are read where they lie. A function is compiled for each kind of number on grids; on graphs and meshes, where a field is small
//! beside its domain, for the widest ones only.

/// Does the same with a field of whatever numbers it has.
macro_rules! with_field {
    ($field:expr, [$($number:ty),*], $slice:ident => $work:expr) => {{
        let field: &Bound<'_, PyAny> = $field;
        $(if let Ok(array) = field.cast::<PyArray1<$number>>() {
            let array: PyReadonlyArray1<'_, $number> = array.try_readonly().map_err(|error| Error::new_err(error.to_string()))?;
            let $slice: &[$number] = array.as_slice().map_err(|_| Error::new_err("the field does not lie row by row"))?;
            return $work;
        })*
        Err(Error::new_err("a field is an array of integers or floats"))
    }};
}

mod diagram;
mod domain;
mod number;
mod pairs;
mod summary;
mod tree;

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use topo::{Kind, NanPolicy, PersistenceOptions, Watch};

use crate::error::{Error, Failed};
use crate::threads::pool;
use crate::watched::watched;
use domain::{Domain, DomainKind};
use number::{Number, threshold};
use pairs::Pairs;
use tree::{AnyTree, HoleColumns, Segments, Tree, hole_columns, segments};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Domain>()?;
    module.add_class::<domain::Linkage>()?;
    module.add_class::<Pairs>()?;
    module.add_class::<Tree>()?;
    module.add_class::<diagram::Diagram>()?;
    module.add_function(wrap_pyfunction!(domain::single_linkage, module)?)?;
    module.add_function(wrap_pyfunction!(pairs_of, module)?)?;
    module.add_function(wrap_pyfunction!(merge_tree, module)?)?;
    module.add_function(wrap_pyfunction!(segmentation, module)?)?;
    module.add_function(wrap_pyfunction!(simplify, module)?)?;
    module.add_function(wrap_pyfunction!(holes, module)?)?;
    module.add_function(wrap_pyfunction!(summary::summarise, module)?)?;
    module.add_function(wrap_pyfunction!(summary::join_summaries, module)?)?;
    module.add_function(wrap_pyfunction!(summary::open_vertices, module)?)?;
    module.add_function(wrap_pyfunction!(isolation, module)?)
}

/// Does the same on whatever domain, with the kinds of numbers that there are on it.
macro_rules! on_domain {
    ($domain:expr, $field:expr, ($on:ident, $slice:ident) => $work:expr) => {
        match &$domain.kind {
            DomainKind::Line($on) => with_field!($field, [u8, u16, i16, i32, i64, u64, f32, f64], $slice => $work),
            DomainKind::Picture($on) => with_field!($field, [u8, u16, i16, i32, i64, u64, f32, f64], $slice => $work),
            DomainKind::Volume($on) => with_field!($field, [u8, u16, i16, i32, i64, u64, f32, f64], $slice => $work),
            DomainKind::Graph(graph) => {
                let $on = &**graph;
                with_field!($field, [i64, u64, f64], $slice => $work)
            }
            DomainKind::Mesh(mesh) => {
                let $on = &**mesh;
                with_field!($field, [i64, u64, f64], $slice => $work)
            }
        }
    };
}

fn options(masks_nan: bool, keeps_zeros: bool) -> PersistenceOptions {
    let options = PersistenceOptions::new().nan(if masks_nan { NanPolicy::Mask } else { NanPolicy::Refuse });
    if keeps_zeros { options.keep_zeros() } else { options }
}

fn kind(is_superlevel: bool) -> Kind {
    if is_superlevel { Kind::Maximum } else { Kind::Minimum }
}

/// The pairs of one direction.
#[pyfunction]
fn pairs_of(
    py: Python<'_>,
    domain: &Domain,
    field: &Bound<'_, PyAny>,
    is_superlevel: bool,
    masks_nan: bool,
    keeps_zeros: bool,
) -> PyResult<Pairs> {
    let options = options(masks_nan, keeps_zeros);
    on_domain!(domain, field, (on, slice) => Ok(Pairs::new(stoppable(py, slice.len(), |watch| match is_superlevel {
        true => options.superlevel_watched(on, slice, watch),
        false => options.sublevel_watched(on, slice, watch),
    })?)))
}

/// So many values are paired within some 50 ms: below that the caller's thread does not look for signals.
const FEW: usize = 1 << 20;

/// Computes something on so many vertices without the interpreter's lock, so that Ctrl-C stops it where it is long.
fn stoppable<T: Send>(
    py: Python<'_>,
    vertices: usize,
    compute: impl FnOnce(Watch<'_>) -> Result<T, topo::Error> + Send,
) -> PyResult<T> {
    if vertices <= FEW {
        on_pool(py, || compute(Watch::NONE))
    } else {
        watched(py, None, |told| compute(Watch::new(&|| told.goes_on())))
    }
}

/// Computes something without the interpreter's lock, on the pool.
fn on_pool<T: Send>(py: Python<'_>, compute: impl FnOnce() -> Result<T, topo::Error> + Send) -> PyResult<T> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(compute)).map_err(Failed)?)
}

/// The merge tree of one direction.
#[pyfunction]
fn merge_tree(
    py: Python<'_>,
    domain: &Domain,
    field: &Bound<'_, PyAny>,
    is_superlevel: bool,
    masks_nan: bool,
) -> PyResult<Tree> {
    let (options, kind) = (options(masks_nan, false), kind(is_superlevel));
    on_domain!(domain, field, (on, slice) => {
        let tree = |watch: Watch<'_>| {
            let tree = options.merge_tree_watched(on, slice, kind, watch)?;
            Ok::<_, topo::Error>(tree.into_owned())
        };
        let tree: Box<dyn AnyTree> = Box::new(stoppable(py, slice.len(), tree)?);
        Ok(Tree(tree))
    })
}

/// The basins of one direction: extrema, and the segment of each vertex.
#[pyfunction]
fn segmentation<'py>(
    py: Python<'py>,
    domain: &Domain,
    field: &Bound<'py, PyAny>,
    is_superlevel: bool,
    least: f64,
    masks_nan: bool,
) -> PyResult<Segments<'py>> {
    let (options, kind) = (options(masks_nan, false), kind(is_superlevel));
    on_domain!(domain, field, (on, slice) => {
        let least = threshold_of(slice, least)?;
        let basins = |watch: Watch<'_>| options.segmentation_watched(on, slice, kind, least, watch);
        Ok(segments(py, &stoppable(py, slice.len(), basins)?))
    })
}

/// The field without extrema that are no more persistent than a threshold.
#[pyfunction]
fn simplify<'py>(
    py: Python<'py>,
    domain: &Domain,
    field: &Bound<'py, PyAny>,
    least: f64,
    masks_nan: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let options = options(masks_nan, false);
    on_domain!(domain, field, (on, slice) => {
        let least = threshold_of(slice, least)?;
        let simpler = |watch: Watch<'_>| options.simplify_watched(on, slice, least, watch);
        Ok(PyArray1::from_vec(py, stoppable(py, slice.len(), simpler)?).into_any())
    })
}

/// The holes of a picture, the cavities of a volume.
#[pyfunction]
fn holes<'py>(
    py: Python<'py>,
    domain: &Domain,
    field: &Bound<'py, PyAny>,
    is_superlevel: bool,
) -> PyResult<HoleColumns<'py>> {
    let kind = kind(is_superlevel);
    match &domain.kind {
        DomainKind::Picture(on) => with_field!(field, [u8, u16, i16, i32, i64, u64, f32, f64], slice => {
            Ok(hole_columns(py, &stoppable(py, slice.len(), |watch| topo::holes_watched(on, slice, kind, watch))?))
        }),
        DomainKind::Volume(on) => with_field!(field, [u8, u16, i16, i32, i64, u64, f32, f64], slice => {
            Ok(hole_columns(py, &stoppable(py, slice.len(), |watch| topo::holes_watched(on, slice, kind, watch))?))
        }),
        _ => Err(Error::new_err("holes are those of pictures and volumes: give an array of two or three axes")),
    }
}

/// For each extremum how far it is to a vertex that is more extreme; infinite where there is none.
#[pyfunction]
fn isolation<'py>(
    py: Python<'py>,
    domain: &Domain,
    field: &Bound<'py, PyAny>,
    is_superlevel: bool,
    extrema: PyReadonlyArray1<'py, i64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let kind = kind(is_superlevel);
    let vertex = |&v: &i64| usize::try_from(v).ok().filter(|&v| v < domain.vertex_count);
    let extrema: Option<Vec<usize>> = extrema.as_slice()?.iter().map(vertex).collect();
    let extrema = extrema.ok_or_else(|| Error::new_err("an extremum is not on the grid"))?;
    macro_rules! on_grid {
        ($on:ident) => {
            with_field!(field, [u8, u16, i16, i32, i64, u64, f32, f64], slice => {
                let distances = on_pool(py, || topo::isolation($on, slice, kind, &extrema))?;
                Ok(PyArray1::from_vec(py, distances.into_iter().map(|d| d.unwrap_or(f64::INFINITY)).collect()))
            })
        };
    }
    match &domain.kind {
        DomainKind::Line(on) => on_grid!(on),
        DomainKind::Picture(on) => on_grid!(on),
        DomainKind::Volume(on) => on_grid!(on),
        _ => Err(Error::new_err("isolation is measured on grids: give an array of one to three axes")),
    }
}

/// The threshold in the numbers of a field.
fn threshold_of<S: Number>(_field: &[S], least: f64) -> PyResult<S::Width> {
    threshold::<S>(least)
}
