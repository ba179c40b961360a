//! What a field lives on: a grid of the array's shape, a graph, a triangle mesh.

use std::sync::Arc;

use geom::{are, counted};
use num_traits::PrimInt;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use topo::{Adjacency, Connectivity, TriangleMesh};

use crate::array::{from_rows, rows};
use crate::error::{Error, Failed};

/// A domain that Python keeps.
#[pyclass(frozen, module = "cones._cones")]
#[derive(Debug)]
pub(crate) struct Domain {
    pub(crate) kind: DomainKind,
    #[pyo3(get)]
    pub(crate) vertex_count: usize,
}

/// The kinds of domains.
#[derive(Clone, Debug)]
pub(crate) enum DomainKind {
    Line(topo::Grid<1>),
    Picture(topo::Grid<2>),
    Volume(topo::Grid<3>),
    Graph(Arc<Adjacency>),
    Mesh(Arc<TriangleMesh>),
}

#[pymethods]
impl Domain {
    /// A grid of one to three axes; `connectivity` is "axis", "full" or "freudenthal".
    #[staticmethod]
    fn grid(shape: Vec<usize>, connectivity: &str, periodic: Vec<bool>) -> PyResult<Self> {
        let connectivity = match connectivity {
            "axis" => Connectivity::Axis,
            "full" => Connectivity::Full,
            "freudenthal" => Connectivity::Freudenthal,
            other => return Err(Error::new_err(format!("connectivity is axis, full or freudenthal, not {other:?}"))),
        };
        let kind = match (&shape[..], &periodic[..]) {
            (&[x], &[px]) => DomainKind::Line(topo::Grid::new([x], connectivity).periodic([px])),
            (&[y, x], &[py, px]) => DomainKind::Picture(topo::Grid::new([y, x], connectivity).periodic([py, px])),
            (&[z, y, x], &[pz, py, px]) => {
                DomainKind::Volume(topo::Grid::new([z, y, x], connectivity).periodic([pz, py, px]))
            }
            (shape, periodic) if shape.len() == periodic.len() => {
                return Err(Error::new_err(format!("a grid has one to three axes, not {}", shape.len())));
            }
            _ => return Err(Error::new_err("periodic needs a truth value for each axis")),
        };
        let vertex_count = shape.iter().fold(1, |count: usize, &length| count.saturating_mul(length));
        Ok(Self { kind, vertex_count })
    }

    /// A graph of edges (m, 2).
    #[staticmethod]
    fn graph(py: Python<'_>, vertices: usize, edges: PyReadonlyArray2<'_, i64>) -> PyResult<Self> {
        let edges = rows::<i64, 2>(&edges, "edges")?;
        let made = py.detach(|| Adjacency::from_edges(vertices, edges));
        Ok(Self { kind: DomainKind::Graph(Arc::new(made.map_err(Failed)?)), vertex_count: vertices })
    }

    /// A graph in compressed rows: the neighbours of vertex v are `indices[starts[v]..starts[v + 1]]`, an edge in one row or in both.
    #[staticmethod]
    fn rows(py: Python<'_>, starts: PyReadonlyArray1<'_, i64>, indices: &Bound<'_, PyAny>) -> PyResult<Self> {
        let starts = starts.as_slice()?;
        if let Ok(indices) = indices.cast::<PyArray1<i32>>() {
            return Self::of_rows(py, starts, indices.try_readonly().map_err(not_readable)?.as_slice()?);
        }
        let indices = indices.cast::<PyArray1<i64>>().map_err(|_| Error::new_err("indices are integers"))?;
        Self::of_rows(py, starts, indices.try_readonly().map_err(not_readable)?.as_slice()?)
    }

    /// The vertices and edges of triangles (m, 3).
    #[staticmethod]
    fn triangles(py: Python<'_>, vertices: usize, triangles: PyReadonlyArray2<'_, u32>) -> PyResult<Self> {
        let triangles = rows::<u32, 3>(&triangles, "triangles")?;
        let made = py.detach(|| TriangleMesh::new(vertices, triangles));
        Ok(Self { kind: DomainKind::Mesh(Arc::new(made.map_err(Failed)?)), vertex_count: vertices })
    }

    /// The numbers of axes of a grid; none for others.
    #[getter]
    fn axes(&self) -> Option<usize> {
        match self.kind {
            DomainKind::Line(_) => Some(1),
            DomainKind::Picture(_) => Some(2),
            DomainKind::Volume(_) => Some(3),
            _ => None,
        }
    }
}

fn not_readable(error: numpy::BorrowError) -> PyErr {
    Error::new_err(error.to_string())
}

impl Domain {
    fn of_rows<I: PrimInt + Sync>(py: Python<'_>, starts: &[i64], indices: &[I]) -> PyResult<Self> {
        let row = |ends: &[i64]| indices.get(usize::try_from(ends[0]).ok()?..usize::try_from(ends[1]).ok()?);
        let lists: Option<Vec<&[I]>> = starts.windows(2).map(row).collect();
        let is_whole = starts.first() == Some(&0) && starts.last().is_some_and(|&end| end == indices.len() as i64);
        let lists = lists.filter(|_| is_whole).ok_or_else(|| {
            Error::new_err(format!("the starts of the rows do not rise from 0 to the {} indices", indices.len()))
        })?;
        let made = py.detach(|| Adjacency::new(&lists)).map_err(Failed)?;
        Ok(Self { kind: DomainKind::Graph(Arc::new(made)), vertex_count: lists.len() })
    }
}

/// Single linkage of weighted edges (m, 2): clusters joined, weight, edge and size of each link.
#[pyfunction]
pub(crate) fn single_linkage<'py>(
    py: Python<'py>,
    vertices: usize,
    edges: PyReadonlyArray2<'py, i64>,
    weights: PyReadonlyArray1<'py, f64>,
) -> PyResult<Linkage> {
    let (edges, weights) = (rows::<i64, 2>(&edges, "edges")?, weights.as_slice()?);
    if edges.len() != weights.len() {
        return Err(Error::new_err(format!(
            "there {} but {}",
            are(edges.len(), "edge", "edges"),
            counted(weights.len(), "weight", "weights")
        )));
    }
    let made = py.detach(|| {
        let weighted: Vec<(i64, i64, f64)> =
            edges.iter().zip(weights).map(|(&[a, b], &weight)| (a, b, weight)).collect();
        topo::single_linkage(vertices, &weighted)
    });
    Ok(Linkage(made.map_err(Failed)?))
}

/// [`topo::Dendrogram`].
#[pyclass(frozen, module = "cones._cones")]
#[derive(Debug)]
pub(crate) struct Linkage(topo::Dendrogram<f64>);

#[pymethods]
impl Linkage {
    /// Both clusters, weight and size of each link, as `scipy.cluster.hierarchy` has them.
    fn links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let row = |link: &topo::Link<f64>| {
            let [a, b] = link.clusters;
            [a as f64, b as f64, link.weight, link.size as f64]
        };
        let links = py.detach(|| self.0.links().iter().map(row).collect());
        from_rows(py, links)
    }

    /// The cluster of each vertex after all links up to a weight.
    fn at<'py>(&self, py: Python<'py>, weight: f64) -> Bound<'py, PyArray1<i64>> {
        numbers(py, || self.0.at(weight))
    }

    /// The cluster of each vertex where there are so many clusters, or as few as can be.
    fn clusters<'py>(&self, py: Python<'py>, count: usize) -> Bound<'py, PyArray1<i64>> {
        numbers(py, || self.0.clusters(count))
    }
}

/// Numbers of clusters as an array, found without the interpreter's lock.
fn numbers<'py>(py: Python<'py>, find: impl FnOnce() -> Vec<usize> + Send) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_vec(py, py.detach(|| find().into_iter().map(|cluster| cluster as i64).collect()))
}
