//! Merge trees and segmentations.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use topo::{Kind, LevelComponent, MergeTree, Segmentation};

use super::number::{Number, threshold};
use super::pairs::{Columns, columns};
use crate::error::Failed;

/// A merge tree of any kind of numbers.
pub(crate) trait AnyTree: Send + Sync {
    fn kind(&self) -> Kind;
    fn leaf_count(&self) -> usize;
    /// Vertex, value and parent (-1 for none) of each node.
    fn nodes<'py>(&self, py: Python<'py>) -> Nodes<'py>;
    /// The columns of the branches' pairs, parents (-1 for none) and sizes.
    fn branches<'py>(&self, py: Python<'py>) -> (Columns<'py>, Ints<'py>, Ints<'py>);
    fn segmentation<'py>(&self, py: Python<'py>, least: f64) -> PyResult<Segments<'py>>;
    fn clusters<'py>(&self, py: Python<'py>, count: usize) -> Segments<'py>;
    fn components<'py>(
        &self,
        py: Python<'py>,
        level: &Bound<'py, PyAny>,
    ) -> PyResult<(LevelColumns<'py>, Segments<'py>)>;
    fn simplify(&self, py: Python<'_>, least: f64) -> PyResult<Box<dyn AnyTree>>;
    fn field<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny>;
    fn sums(&self, weights: &[f64]) -> Result<Vec<f64>, topo::Error>;
}

type Ints<'py> = Bound<'py, PyArray1<i64>>;
type Nodes<'py> = (Ints<'py>, Bound<'py, PyAny>, Ints<'py>);
/// Extrema, and the segment of each vertex (-1 for none).
pub(crate) type Segments<'py> = (Ints<'py>, Bound<'py, PyArray1<i32>>);
/// Extremum, value, saddle (-1 for none) and size.
type LevelColumns<'py> = (Ints<'py>, Bound<'py, PyAny>, Ints<'py>, Ints<'py>);

fn ints<'py>(py: Python<'py>, values: impl Iterator<Item = Option<usize>>) -> Ints<'py> {
    PyArray1::from_vec(py, values.map(|value| value.map_or(-1, |value| value as i64)).collect())
}

/// A segmentation as arrays.
pub(crate) fn segments<'py>(py: Python<'py>, segmentation: &Segmentation<usize>) -> Segments<'py> {
    let labels = py.detach(|| segmentation.labels().map(|label| label.map_or(-1, |label| label as i32)).collect());
    (ints(py, segmentation.extrema().iter().map(|&v| Some(v))), PyArray1::from_vec(py, labels))
}

impl<S: Number> AnyTree for MergeTree<'static, usize, S> {
    fn kind(&self) -> Kind {
        self.kind()
    }

    fn leaf_count(&self) -> usize {
        self.leaf_count()
    }

    fn nodes<'py>(&self, py: Python<'py>) -> Nodes<'py> {
        let nodes = py.detach(|| self.nodes());
        let values = PyArray1::from_vec(py, nodes.iter().map(|node| node.value).collect());
        (
            ints(py, nodes.iter().map(|node| Some(node.vertex))),
            values.into_any(),
            ints(py, nodes.iter().map(|node| node.parent)),
        )
    }

    fn branches<'py>(&self, py: Python<'py>) -> (Columns<'py>, Ints<'py>, Ints<'py>) {
        let branches = py.detach(|| self.branches());
        let pairs: Vec<_> = branches.iter().map(|branch| branch.pair).collect();
        let parents = ints(py, branches.iter().map(|branch| branch.parent));
        (
            columns(py, &pairs, |vertex| vertex as i64),
            parents,
            ints(py, branches.iter().map(|branch| Some(branch.size))),
        )
    }

    fn segmentation<'py>(&self, py: Python<'py>, least: f64) -> PyResult<Segments<'py>> {
        let least = threshold::<S>(least)?;
        Ok(segments(py, &py.detach(|| self.segmentation(least))))
    }

    fn clusters<'py>(&self, py: Python<'py>, count: usize) -> Segments<'py> {
        segments(py, &py.detach(|| self.clusters(count)))
    }

    fn components<'py>(
        &self,
        py: Python<'py>,
        level: &Bound<'py, PyAny>,
    ) -> PyResult<(LevelColumns<'py>, Segments<'py>)> {
        let level: S = level.extract().map_err(Into::into)?;
        let (at, components): (Vec<LevelComponent<usize, S>>, _) =
            py.detach(|| (self.at(level), self.components(level)));
        let values = PyArray1::from_vec(py, at.iter().map(|component| component.value).collect());
        let columns = (
            ints(py, at.iter().map(|component| Some(component.extremum))),
            values.into_any(),
            ints(py, at.iter().map(|component| component.saddle)),
            ints(py, at.iter().map(|component| Some(component.size))),
        );
        Ok((columns, segments(py, &components)))
    }

    fn simplify(&self, py: Python<'_>, least: f64) -> PyResult<Box<dyn AnyTree>> {
        let least = threshold::<S>(least)?;
        Ok(Box::new(py.detach(|| self.simplify(least))))
    }

    fn field<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        PyArray1::from_slice(py, self.field()).into_any()
    }

    fn sums(&self, weights: &[f64]) -> Result<Vec<f64>, topo::Error> {
        self.sums(weights)
    }
}

/// [`topo::MergeTree`].
#[pyclass(frozen, module = "cones._cones")]
pub(crate) struct Tree(pub(crate) Box<dyn AnyTree>);

#[pymethods]
impl Tree {
    #[getter]
    fn is_superlevel(&self) -> bool {
        self.0.kind() == Kind::Maximum
    }

    #[getter]
    fn leaf_count(&self) -> usize {
        self.0.leaf_count()
    }

    fn nodes<'py>(&self, py: Python<'py>) -> Nodes<'py> {
        self.0.nodes(py)
    }

    fn branches<'py>(&self, py: Python<'py>) -> (Columns<'py>, Ints<'py>, Ints<'py>) {
        self.0.branches(py)
    }

    fn segmentation<'py>(&self, py: Python<'py>, threshold: f64) -> PyResult<Segments<'py>> {
        self.0.segmentation(py, threshold)
    }

    fn clusters<'py>(&self, py: Python<'py>, count: usize) -> Segments<'py> {
        self.0.clusters(py, count)
    }

    fn components<'py>(
        &self,
        py: Python<'py>,
        level: &Bound<'py, PyAny>,
    ) -> PyResult<(LevelColumns<'py>, Segments<'py>)> {
        self.0.components(py, level)
    }

    fn simplify(&self, py: Python<'_>, threshold: f64) -> PyResult<Self> {
        Ok(Self(self.0.simplify(py, threshold)?))
    }

    #[getter]
    fn field<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.0.field(py)
    }

    /// For each branch the sum of its vertices' weights.
    fn sums<'py>(&self, py: Python<'py>, weights: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let weights = weights.as_slice()?;
        let sums = py.detach(|| self.0.sums(weights)).map_err(Failed)?;
        Ok(PyArray1::from_vec(py, sums))
    }
}

/// Holes or cavities: where each is closed and filled, birth and death.
pub(crate) type HoleColumns<'py> = (Ints<'py>, Ints<'py>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Holes as the columns of a table.
pub(crate) fn hole_columns<'py, S: Number>(py: Python<'py>, holes: &topo::Holes<S>) -> HoleColumns<'py> {
    (
        ints(py, holes.iter().map(|hole| Some(hole.closed))),
        ints(py, holes.iter().map(|hole| Some(hole.filled))),
        PyArray1::from_vec(py, holes.iter().map(|hole| hole.birth).collect()).into_any(),
        PyArray1::from_vec(py, holes.iter().map(|hole| hole.death).collect()).into_any(),
    )
}
