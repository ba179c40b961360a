//! Diagrams: points (birth, death) and births of essential classes, and how far two are apart.

use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use topo::{Kind, Wasserstein, Watch};

use super::stoppable;
use crate::array::rows;

/// A distance, the finite points and the essential classes that go to each other.
type Matched = (f64, Vec<[i64; 2]>, Vec<[usize; 2]>);

/// [`topo::Diagram`].
#[pyclass(frozen, module = "cones._cones")]
#[derive(Debug)]
pub(crate) struct Diagram(topo::Diagram);

impl Diagram {
    /// Compares two diagrams so that Ctrl-C stops it where it is long: a pair of points is taken to cost what a value of a field does.
    fn compared<T: Send>(
        &self,
        py: Python<'_>,
        other: &Self,
        compare: impl FnOnce(&topo::Diagram, &topo::Diagram, Watch<'_>) -> Result<T, topo::Error> + Send,
    ) -> PyResult<T> {
        let points = self.0.finite.len() + other.0.finite.len();
        stoppable(py, points.saturating_mul(points), |watch| compare(&self.0, &other.0, watch))
    }
}

#[pymethods]
impl Diagram {
    #[new]
    fn new(
        finite: PyReadonlyArray2<'_, f64>,
        essential: PyReadonlyArray1<'_, f64>,
        is_superlevel: bool,
    ) -> PyResult<Self> {
        let finite = rows::<f64, 2>(&finite, "a diagram")?.iter().map(|&[birth, death]| (birth, death)).collect();
        let kind = if is_superlevel { Kind::Maximum } else { Kind::Minimum };
        Ok(Self(topo::Diagram { kind, finite, essential: essential.as_slice()?.to_vec() }))
    }

    fn bottleneck(&self, py: Python<'_>, other: &Self) -> PyResult<f64> {
        let asked = Wasserstein::new(f64::INFINITY);
        self.compared(py, other, |a, b, watch| asked.distance_watched(a, b, watch))
    }

    fn wasserstein(&self, py: Python<'_>, other: &Self, order: f64, ground: f64, relative_error: f64) -> PyResult<f64> {
        let asked = Wasserstein::new(order).ground(ground).relative_error(relative_error);
        self.compared(py, other, |a, b, watch| asked.distance_watched(a, b, watch))
    }

    /// The distance, and places among the finite points of both that go to each other; -1 is the diagonal.
    fn matching(
        &self,
        py: Python<'_>,
        other: &Self,
        order: f64,
        ground: f64,
        relative_error: f64,
    ) -> PyResult<Matched> {
        let asked = Wasserstein::new(order).ground(ground).relative_error(relative_error);
        let matching = self.compared(py, other, |a, b, watch| asked.matching_watched(a, b, watch))?;
        let place = |place: Option<usize>| place.map_or(-1, |place| place as i64);
        let finite = matching.finite.into_iter().map(|pair| pair.map(place)).collect();
        Ok((matching.distance, finite, matching.essential))
    }

    fn entropy(&self) -> f64 {
        self.0.entropy()
    }

    fn betti_curve(&self) -> Vec<(f64, usize)> {
        self.0.betti_curve()
    }

    fn persistence_curve(&self) -> Vec<(f64, usize)> {
        self.0.persistence_curve()
    }

    /// The first `count` functions of the landscape at some levels, one after the other.
    fn landscape<'py>(
        &self,
        py: Python<'py>,
        count: usize,
        levels: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let levels = levels.as_slice()?;
        Ok(PyArray1::from_vec(py, py.detach(|| self.0.landscape(count, levels))))
    }

    fn silhouette<'py>(
        &self,
        py: Python<'py>,
        power: f64,
        levels: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let levels = levels.as_slice()?;
        Ok(PyArray1::from_vec(py, py.detach(|| self.0.silhouette(power, levels))))
    }

    /// The persistence image, row by row.
    fn image<'py>(
        &self,
        py: Python<'py>,
        births: (f64, f64),
        lifetimes: (f64, f64),
        shape: [usize; 2],
        bandwidth: f64,
    ) -> Bound<'py, PyArray1<f64>> {
        let image = py.detach(|| self.0.image(births.0..=births.1, lifetimes.0..=lifetimes.1, shape, bandwidth));
        PyArray1::from_vec(py, image)
    }
}
