//! Models: vertices and polygons from arrays or files, and back into files.

use std::path::PathBuf;
use std::sync::Arc;

use geom::io::{ObjContent, read, write_glb, write_obj, write_ply};
use geom::{Model, Triangles, Weld, texture_seams};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::array::{from_rows, rows};
use crate::error::{Error, Failed};
use crate::threads::in_pool;

/// Three corners a triangle (t, 3), and the face of each (t,).
type TriangleArrays<'py> = (Bound<'py, PyArray2<u32>>, Bound<'py, PyArray1<u32>>);

/// Vertices and polygons; [`geom::Model`].
#[pyclass(frozen, module = "cones._cones")]
#[derive(Debug)]
pub(crate) struct Mesh(pub(crate) Arc<Model>);

#[pymethods]
impl Mesh {
    /// Of vertices (n, 3), the vertex of each corner, where each face's corners begin (with their number at the end), and a position in the
    /// plane for each corner.
    #[new]
    fn new(
        points: PyReadonlyArray2<'_, f64>,
        corners: PyReadonlyArray1<'_, u32>,
        face_start: PyReadonlyArray1<'_, i64>,
        uv: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Self> {
        let points = rows::<f64, 3>(&points, "vertices")?.to_vec();
        let (corners, starts) = (corners.as_slice()?, face_start.as_slice()?);
        let face = |ends: &[i64]| {
            let range = usize::try_from(ends[0]).ok()?..usize::try_from(ends[1]).ok()?;
            corners.get(range)
        };
        let faces: Option<Vec<&[u32]>> = starts.windows(2).map(face).collect();
        let spans = starts.first() == Some(&0) && starts.last().is_some_and(|&end| end == corners.len() as i64);
        let faces =
            faces.filter(|_| spans).ok_or_else(|| Error::new_err("face_start does not cut the corners into faces"))?;
        let model = Model::from_polygons(points, faces).map_err(Failed)?;
        let model = match uv {
            Some(uv) => model.with_texture(rows::<f64, 2>(&uv, "uv")?.to_vec()).map_err(Failed)?,
            None => model,
        };
        Ok(Self(Arc::new(model)))
    }

    /// Reads a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let model = in_pool(py, || read(path))?.map_err(Failed)?;
        Ok(Self(Arc::new(model)))
    }

    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        from_rows(py, self.0.points().to_vec())
    }

    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, self.0.corners())
    }

    #[getter]
    fn face_start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_vec(py, self.0.face_start().iter().map(|&start| i64::from(start)).collect())
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.0.vertex_count()
    }

    #[getter]
    fn face_count(&self) -> usize {
        self.0.face_count()
    }

    #[getter]
    fn corner_count(&self) -> usize {
        self.0.corner_count()
    }

    /// What the file said and the model does not hold, as words.
    #[getter]
    fn skipped(&self) -> String {
        self.0.skipped().to_string()
    }

    /// Whether any corner may have texture coordinates.
    #[getter]
    fn has_uv(&self) -> bool {
        self.0.uv().is_some()
    }

    /// The texture coordinates of all corners; none if any corner has none.
    #[getter]
    fn uv<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.0.uv().and_then(|uv| uv.all().ok()).map(|uv| from_rows(py, uv)).transpose()
    }

    /// Triangles as corners of the model, and the face of each.
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<TriangleArrays<'py>> {
        let Triangles { corners, face_of, .. } = self.0.triangles();
        Ok((from_rows(py, corners)?, PyArray1::from_vec(py, face_of)))
    }

    /// The edges where the file's texture coordinates are cut.
    fn texture_seams<'py>(&self, py: Python<'py>, weld: &str) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let weld = weld_by_name(weld)?;
        from_rows(py, in_pool(py, || texture_seams(&self.0, weld))?)
    }

    /// The bytes of a file: "obj", "ply" or "glb".
    fn to_bytes<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        uv: Option<PyReadonlyArray2<'py, f64>>,
        triangulate: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let uv = uv.as_ref().map(|uv| rows::<f64, 2>(uv, "uv")).transpose()?;
        let triangles = self.0.triangles();
        let asked = triangulate.then_some(&triangles);
        if !["obj", "ply", "glb"].contains(&format) {
            return Err(Error::new_err(format!("a mesh is written as obj, ply or glb, not as {format:?}")));
        }
        let mut bytes = Vec::new();
        let written = in_pool(py, || match format {
            "obj" => {
                let content = ObjContent { uv, triangles: asked, ..ObjContent::default() };
                write_obj(&self.0, &content, &mut bytes)
            }
            "ply" => write_ply(&self.0, uv, asked, &mut bytes),
            _ => write_glb(&self.0, uv, &triangles, None, &mut bytes),
        });
        written?.map_err(Failed)?;
        Ok(PyBytes::new(py, &bytes))
    }
}

/// Which vertices are taken for one.
pub(crate) fn weld_by_name(name: &str) -> PyResult<Weld> {
    match name {
        "auto" => Ok(Weld::Auto),
        "never" => Ok(Weld::Never),
        "always" => Ok(Weld::Always),
        other => Err(Error::new_err(format!("weld is auto, never or always, not {other:?}"))),
    }
}

/// A built-in surface.
#[pyfunction]
pub(crate) fn shape(py: Python<'_>, name: &str, vertices: usize) -> PyResult<Mesh> {
    let shape = in_pool(py, || geom::shapes::by_name(name, vertices))?;
    let shape = shape.ok_or_else(|| Error::new_err(format!("there is no built-in shape {name:?}")))?;
    Ok(Mesh(Arc::new(shape.into())))
}
