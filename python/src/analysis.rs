//! [`cones::Analysis`]: what is found once of a model and asked many times.

use std::sync::Arc;

use cones::report::{MeasuredAtlas, UvSize, sentences};
use cones::{Analysis as Found, ConeOrder, Kind, ModelExtremum, Options, Preparation, RefinedModel};
use geom::{Model, Watch};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::{depythonize, pythonize};

use crate::atlas::{dictionary, size_by_name, times};
use crate::error::Failed;
use crate::mesh::Mesh;
use crate::watched::{Told, watched};

/// An analysis, and the model that maps are of.
#[pyclass(frozen, module = "cones._cones")]
pub(crate) struct Analysis {
    found: Found,
    model: Arc<Model>,
    preparation: Preparation,
}

/// Cones that an analysis has placed.
#[pyclass(frozen, module = "cones._cones")]
pub(crate) struct Cones(cones::Cones);

/// Why there is no map, or none that can be measured.
enum NoMap {
    Cones(cones::Error),
    Distortion(geom::distortion::DistortionError),
}

impl From<Failed<NoMap>> for PyErr {
    fn from(Failed(error): Failed<NoMap>) -> Self {
        match error {
            NoMap::Cones(error) => Failed(error).into(),
            NoMap::Distortion(error) => Failed(error).into(),
        }
    }
}

impl Analysis {
    fn options(&self, options: &Bound<'_, PyAny>) -> PyResult<Options> {
        Ok(Options { preparation: self.preparation, ..depythonize(options)? })
    }
}

/// The model that maps are of.
fn model_of(found: &Found, mesh: &Mesh) -> Arc<Model> {
    found.refined().map_or_else(|| Arc::clone(&mesh.0), |refined| Arc::new(refined.model.clone()))
}

#[pymethods]
impl Analysis {
    #[new]
    fn new(py: Python<'_>, mesh: &Mesh, preparation: &Bound<'_, PyAny>, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        let preparation: Preparation = depythonize(preparation)?;
        let found = watched(py, progress, |told| Found::observed(&mesh.0, preparation, told.observer()))?;
        Ok(Self { model: model_of(&found, mesh), found, preparation })
    }

    /// An analysis and a map in one call, as the command makes them: of a refined mesh the analysis may be in smaller triangles, or in those that
    /// it had.
    #[staticmethod]
    fn unwrapped<'py>(
        py: Python<'py>,
        mesh: &Mesh,
        preparation: &Bound<'py, PyAny>,
        options: &Bound<'py, PyAny>,
        scale: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Self, Bound<'py, PyDict>)> {
        let preparation: Preparation = depythonize(preparation)?;
        let options = Options { preparation, ..depythonize(options)? };
        let size = size_by_name(scale, &options)?;
        let (analysis, measured) = watched(py, progress, |told| {
            let (found, atlas) = Found::unwrapped(&mesh.0, &options, told.observer()).map_err(NoMap::Cones)?;
            let analysis = Self { model: model_of(&found, mesh), found, preparation };
            let measured = analysis.measured(atlas, size, told)?;
            Ok::<_, NoMap>((analysis, measured))
        })?;
        let found = dictionary(py, measured, &analysis.found, &options)?;
        Ok((analysis, found))
    }

    /// The cones that options ask for.
    fn choose(&self, py: Python<'_>, options: &Bound<'_, PyAny>, progress: Option<Py<PyAny>>) -> PyResult<Cones> {
        let options = self.options(options)?;
        let choose = |told: &Arc<_>| self.found.with_observer(Told::observer(told)).choose(&options);
        Ok(Cones(watched(py, progress, choose)?))
    }

    /// A map with cones that were placed.
    fn flatten<'py>(
        &self,
        py: Python<'py>,
        cones: &Cones,
        options: &Bound<'py, PyAny>,
        scale: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        self.map(py, options, scale, progress, |found, options| found.flatten_with(&cones.0, options))
    }

    /// Cones and a map with them; others where they fail.
    fn atlas<'py>(
        &self,
        py: Python<'py>,
        options: &Bound<'py, PyAny>,
        scale: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        self.map(py, options, scale, progress, |found, options| found.atlas(options))
    }

    /// An order of cones for every number of them.
    fn order<'py>(
        &self,
        py: Python<'py>,
        options: &Bound<'py, PyAny>,
        count: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let Options { placement, rule, .. } = self.options(options)?;
        let order: ConeOrder =
            watched(py, progress, |told| self.found.with_observer(told.observer()).order(placement, rule, count))?;
        let answer = PyDict::new(py);
        answer.set_item("method", order.placement.name())?;
        answer.set_item("order", pythonize(py, &order.cones)?)?;
        answer.set_item("curve", pythonize(py, &order.curve)?)?;
        Ok(answer)
    }

    /// φ of each vertex; NaN where it is on no surface.
    fn conformal_factor<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, py.detach(|| self.found.conformal_factor()))
    }

    /// All extrema of φ, most persistent first: the columns of a table.
    fn extrema<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let extrema = py.detach(|| self.found.extrema());
        let columns = PyDict::new(py);
        let ints = |of: fn(&ModelExtremum) -> i64| PyArray1::from_vec(py, extrema.iter().map(of).collect());
        let floats = |of: fn(&ModelExtremum) -> f64| PyArray1::from_vec(py, extrema.iter().map(of).collect());
        columns.set_item("component", ints(|e| e.component as i64))?;
        columns.set_item("vertex", ints(|e| i64::from(e.vertex)))?;
        columns.set_item("is_maximum", ints(|e| i64::from(e.kind == Kind::Maximum)))?;
        columns.set_item("value", floats(|e| e.value))?;
        columns.set_item("persistence", floats(|e| e.persistence))?;
        columns.set_item("saddle", ints(|e| e.saddle.map_or(-1, i64::from)))?;
        Ok(columns)
    }

    fn least_cones(&self) -> usize {
        self.found.least_cones()
    }

    fn needle_share(&self) -> f64 {
        self.found.needle_share()
    }

    #[getter]
    fn topology<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, &self.found.topology())?)
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        sentences(self.found.notes(), self.found.topology().components)
    }

    /// What was repaired: what it was, how often, the first place.
    #[getter]
    fn repairs(&self) -> Vec<(&'static str, usize, usize)> {
        self.found.repairs().iter().map(|r| (r.kind.description(), r.count, r.first)).collect()
    }

    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        times(py, &[self.found.times()])
    }

    /// The refined model, and the face of the given one that each of its triangles is part of.
    #[getter]
    fn refined<'py>(&self, py: Python<'py>) -> Option<(Mesh, Bound<'py, PyArray1<u32>>)> {
        let RefinedModel { face, .. } = self.found.refined()?;
        Some((Mesh(Arc::clone(&self.model)), PyArray1::from_slice(py, face)))
    }
}

impl Analysis {
    fn map<'py>(
        &self,
        py: Python<'py>,
        options: &Bound<'py, PyAny>,
        scale: &str,
        progress: Option<Py<PyAny>>,
        work: impl FnOnce(&Found, &Options) -> Result<cones::Atlas, cones::Error> + Send,
    ) -> PyResult<Bound<'py, PyDict>> {
        let options = self.options(options)?;
        let size = size_by_name(scale, &options)?;
        let measured = watched(py, progress, |told| {
            let atlas = work(&self.found.with_observer(told.observer()), &options).map_err(NoMap::Cones)?;
            self.measured(atlas, size, told)
        })?;
        dictionary(py, measured, &self.found, &options)
    }

    fn measured(&self, atlas: cones::Atlas, size: UvSize, told: &Told) -> Result<MeasuredAtlas, NoMap> {
        let stops = |_| told.goes_on();
        MeasuredAtlas::new_watched(&self.model, atlas, size, self.found.weld(), Watch::new(&stops))
            .map_err(NoMap::Distortion)
    }
}

#[pymethods]
impl Cones {
    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// The cones, a dictionary each.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, self.0.as_slice())?)
    }

    /// What linear theory predicts for them.
    #[getter]
    fn prediction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, &self.0.prediction())?)
    }

    /// How their number was found, where none was given.
    #[getter]
    fn number<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, &self.0.number())?)
    }

    /// What the user should know; `components` is how many parts the model has.
    fn notes(&self, components: usize) -> Vec<String> {
        sentences(self.0.notes(), components)
    }

    #[getter]
    fn method(&self) -> Option<&'static str> {
        self.0.placement().map(cones::Placement::name)
    }
}
