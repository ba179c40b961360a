//! An unwrapped model as a dictionary of arrays, with the command's report.

use cones::report::{MeasuredAtlas, Report, SCHEMA, UvSize};
use cones::uv::Tiles;
use cones::{Analysis, Atlas, Options, Stage, Topology};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use pythonize::pythonize;
use serde::Serialize;

use crate::array::from_rows;
use crate::error::Error;

/// A size of texture coordinates by its name on the command line.
pub(crate) fn size_by_name(name: &str, options: &Options) -> PyResult<UvSize> {
    match name {
        "unit" => Ok(UvSize::Unit),
        "area" | "none" if options.packing.tiles != Tiles::One => {
            Err(Error::new_err("texel_density puts islands on tiles that are unit squares: leave scale out"))
        }
        "area" => Ok(UvSize::Area),
        "none" => Ok(UvSize::Raw),
        other => Err(Error::new_err(format!("scale is unit, area or none, not {other:?}"))),
    }
}

/// The command's report, but for what a file and a program have.
#[derive(Serialize)]
struct WholeReport {
    schema: u32,
    input: Topology,
    #[serde(flatten)]
    map: Report,
}

/// A map with what it is worth, handed over as a dictionary.
pub(crate) fn dictionary<'py>(
    py: Python<'py>,
    map: MeasuredAtlas,
    analysis: &Analysis,
    options: &Options,
) -> PyResult<Bound<'py, PyDict>> {
    let input = analysis.topology();
    let report = pythonize(py, &WholeReport { schema: SCHEMA, input, map: map.report(analysis, options) })?;
    report.set_item("times", times(py, &[analysis.times(), map.atlas.times])?)?;
    let MeasuredAtlas { atlas, uv, .. } = map;
    let Atlas { triangles, islands, seams, detached, left_out, tiles, fill, scale, curvature_error, .. } = atlas;
    let answer = PyDict::new(py);
    answer.set_item("report", report)?;
    answer.set_item("uv", from_rows(py, uv)?)?;
    answer.set_item("triangles", from_rows(py, triangles.corners)?)?;
    answer.set_item("triangle_face", PyArray1::from_vec(py, triangles.face_of))?;
    let island = islands.iter().map(|island| island.map_or(-1, i64::from)).collect();
    answer.set_item("triangle_island", PyArray1::from_vec(py, island))?;
    let seams = seams.into_iter().map(|seam| PyArray1::from_vec(py, seam));
    answer.set_item("seams", PyList::new(py, seams)?)?;
    answer.set_item("detached", PyArray1::from_vec(py, detached))?;
    answer.set_item("left_out", PyArray1::from_vec(py, left_out))?;
    answer.set_item("tiles", tiles)?;
    answer.set_item("fill", fill)?;
    answer.set_item("unit", scale)?;
    answer.set_item("curvature_error", curvature_error)?;
    Ok(answer)
}

/// Seconds by stage, of several pieces of work.
pub(crate) fn times<'py>(py: Python<'py>, times: &[cones::Times]) -> PyResult<Bound<'py, PyDict>> {
    let seconds = PyDict::new(py);
    for stage in Stage::ALL {
        let time: f64 = times.iter().map(|times| times.of(stage).as_secs_f64()).sum();
        if time > 0.0 {
            seconds.set_item(stage.name(), time)?;
        }
    }
    Ok(seconds)
}
