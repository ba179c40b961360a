//! Maps of any origin: measured, taken apart where they lie over themselves, packed.

use cones::report::MeasuredMap;
use cones::uv::{PackError, PackOptions, PartError, Parted, Repacked, islands_of, repack};
use geom::{Model, Watch, are, counted};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::{depythonize, pythonize};

use crate::array::{from_rows, rows};
use crate::error::{Error, Failed, exception};
use crate::mesh::{Mesh, weld_by_name};
use crate::watched::watched;

/// A position for each corner, or nothing.
fn checked<'a>(model: &Model, uv: &'a PyReadonlyArray2<'_, f64>) -> PyResult<&'a [[f64; 2]]> {
    let uv = rows::<f64, 2>(uv, "uv")?;
    if uv.len() == model.corner_count() {
        return Ok(uv);
    }
    let (corners, vertices) = (model.corner_count(), model.vertex_count());
    Err(Error::new_err(format!(
        "uv has {}; it needs one for each of the {corners} corners of faces (the mesh has {vertices} vertices)",
        counted(uv.len(), "row", "rows")
    )))
}

/// Measures a map: the report, and arrays of what is known of each triangle, those that are not measured included.
#[pyfunction]
pub(crate) fn measure<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    uv: PyReadonlyArray2<'py, f64>,
    weld: &str,
    cones: Option<PyReadonlyArray1<'py, u32>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (uv, weld) = (checked(&mesh.0, &uv)?, weld_by_name(weld)?);
    let cones = cones.as_ref().map(|cones| cones.as_slice()).transpose()?;
    let model = &mesh.0;
    let map = watched(py, None, |told| {
        let stops = |_| told.goes_on();
        MeasuredMap::new_watched(model, uv, weld, cones, Watch::new(&stops))
    })?;
    let MeasuredMap { quality, triangle, left_out, .. } = map;
    let mut is_kept = vec![true; triangle.len() + left_out.len()];
    left_out.iter().for_each(|&t| is_kept[t as usize] = false);
    let overlapping = quality.overlapping.iter().map(|&t| triangle[t as usize]).collect();
    let island = quality.triangle_island.iter().map(|&island| i64::from(island));
    let report = pythonize(py, &quality)?.cast_into::<PyDict>()?;
    report.set_item("left_out", PyArray1::<u32>::from_vec(py, left_out))?;
    report.set_item("overlapping", PyArray1::<u32>::from_vec(py, overlapping))?;
    report.set_item("triangle_island", PyArray1::from_vec(py, of_all(&is_kept, island, -1)))?;
    let quasi_conformal = of_all(&is_kept, quality.quasi_conformal.iter().copied(), 1.0);
    report.set_item("triangle_quasi_conformal", PyArray1::from_vec(py, quasi_conformal))?;
    let log_scale = of_all(&is_kept, quality.log_scale.iter().copied(), 0.0);
    report.set_item("triangle_log_scale", PyArray1::from_vec(py, log_scale))?;
    Ok(report)
}

/// What there is for each triangle that is kept, for all of them: `other` for those that are not.
fn of_all<T: Copy>(is_kept: &[bool], mut values: impl Iterator<Item = T>, other: T) -> Vec<T> {
    is_kept.iter().map(|is_kept| is_kept.then(|| values.next()).flatten().unwrap_or(other)).collect()
}

/// Takes a map apart until no island lies over itself.
#[pyfunction]
pub(crate) fn part<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    uv: PyReadonlyArray2<'py, f64>,
    weld: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (uv, weld) = (checked(&mesh.0, &uv)?, weld_by_name(weld)?);
    let model = &mesh.0;
    let parted: Parted = watched(py, progress, |told| {
        told.watch("islands", |watch| cones::uv::part(model, uv, weld, watch)).map_err(Stopped)
    })?;
    let island = parted.islands.iter().map(|island| island.map_or(-1, i64::from)).collect();
    let answer = PyDict::new(py);
    answer.set_item("overlapping_pairs", parted.overlaps.pairs.len())?;
    answer.set_item("left", parted.left)?;
    answer.set_item("added_seam", parted.added_seam)?;
    answer.set_item("island_count", parted.island_count)?;
    answer.set_item("uv", from_rows(py, parted.uv)?)?;
    answer.set_item("triangle_island", PyArray1::from_vec(py, island))?;
    Ok(answer)
}

/// Packs the islands of a map: the positions of all corners, and what is known of the packing. `triangle_island` names the islands by any
/// numbers, negative ones are none; without it islands are found, `weld` taking vertices for one.
#[pyfunction]
pub(crate) fn pack<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    uv: PyReadonlyArray2<'py, f64>,
    triangle_island: Option<PyReadonlyArray1<'py, i64>>,
    weld: &str,
    options: &Bound<'py, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (uv, weld) = (checked(&mesh.0, &uv)?, weld_by_name(weld)?);
    let options: PackOptions = depythonize(options)?;
    let model = &mesh.0;
    let given = triangle_island.as_ref().map(|islands| islands.as_slice()).transpose()?;
    let triangles = model.triangles();
    let islands: Vec<Option<u32>> = match given {
        Some(given) if given.len() == triangles.len() => {
            let mut names: Vec<i64> = given.iter().copied().filter(|&island| island >= 0).collect();
            names.sort_unstable();
            names.dedup();
            given.iter().map(|island| names.binary_search(island).ok().map(|number| number as u32)).collect()
        }
        Some(given) => {
            let (given, there) = (given.len(), triangles.len());
            return Err(Error::new_err(format!(
                "islands are given for {}, but there {}",
                counted(given, "triangle", "triangles"),
                are(there, "triangle", "triangles")
            )));
        }
        None => watched(py, None, |told| {
            let stops = |_| told.goes_on();
            islands_of(model, uv, weld, Watch::new(&stops))
        })?,
    };
    let Repacked { uv: placed, packing, fill_before, .. } = watched(py, progress, |told| {
        told.watch("pack", |watch| repack(model, uv, &islands, (weld, &options), watch)).map_err(StoppedPacking)
    })?;
    let answer = PyDict::new(py);
    answer.set_item("uv", from_rows(py, placed)?)?;
    answer.set_item("islands", packing.places.len())?;
    answer.set_item("tiles", packing.tiles)?;
    answer.set_item("fill_before", fill_before)?;
    answer.set_item("fill", packing.fill)?;
    answer.set_item("margin", packing.margin)?;
    answer.set_item("scale", packing.scale)?;
    Ok(answer)
}

struct Stopped(PartError);

impl From<Failed<Stopped>> for PyErr {
    fn from(Failed(Stopped(error)): Failed<Stopped>) -> Self {
        match error {
            PartError::Interrupted(_) => PyKeyboardInterrupt::new_err(()),
            error => exception(&error),
        }
    }
}

struct StoppedPacking(PackError);

impl From<Failed<StoppedPacking>> for PyErr {
    fn from(Failed(StoppedPacking(error)): Failed<StoppedPacking>) -> Self {
        match error {
            PackError::Interrupted(_) => PyKeyboardInterrupt::new_err(()),
            error => exception(&error),
        }
    }
}
