//! Meshes with a value for each vertex, from a file or computed.

use super::computed::Computed;
use super::decimal;
use super::ending;
use super::error::{Problem, ReadError};
use super::npy;
use super::values::Values;
use crate::failure::Failure;
use crate::job;
use cones::Options;
use geom::Model;
use std::path::{Path, PathBuf};

/// Where the values of a mesh come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// The conformal factor φ.
    Factor,
    Computed(Computed),
    /// A file of values, one for each vertex.
    File(PathBuf),
}

impl Source {
    /// From a name of a field or of a file.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if text == "phi" {
            return Ok(Self::Factor);
        }
        if let Some(computed) = Computed::by_name(text) {
            return Ok(Self::Computed(computed));
        }
        match ending(Path::new(text)).as_str() {
            "npy" | "txt" => Ok(Self::File(text.into())),
            _ => {
                Err("name phi, curvature, mean-curvature, height[:x|y|z], distance[:VERTEX] or a file .npy or .txt"
                    .into())
            }
        }
    }

    /// The file that is read, if one is.
    pub(crate) fn file(&self) -> Option<&Path> {
        if let Self::File(path) = self { Some(path) } else { None }
    }

    /// Whether NaN stands for vertices that are on no surface, and not for a mistake.
    pub(crate) fn leaves_gaps(&self) -> bool {
        !matches!(self, Self::File(_))
    }
}

/// A mesh with a field.
#[derive(Debug)]
pub(crate) struct Surface {
    pub(crate) model: Model,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) values: Values,
}

impl Surface {
    /// Reads a mesh and reads or computes its values. Polygons are cut into triangles.
    pub(crate) fn read(path: &Path, source: &Source) -> Result<Self, Failure> {
        let (model, _) = job::read(path)?;
        let triangles = model.triangles().vertices(&model);
        let values = match source {
            Source::Factor => Values::F64(factor(path, &model)?),
            Source::Computed(Computed::Distance(Some(from))) if *from >= model.vertex_count() => {
                return Err(Failure::NoVertex { path: path.to_owned(), vertex: *from, vertices: model.vertex_count() });
            }
            Source::Computed(computed) => Values::F64(computed.on(&model, &triangles)),
            Source::File(file) => read_values(file, model.vertex_count())?,
        };
        Ok(Self { model, triangles, values })
    }
}

/// The conformal factor φ of each vertex; NaN where it is on no surface.
fn factor(path: &Path, model: &Model) -> Result<Vec<f64>, Failure> {
    let found = cones::extract(model, &Options::default(), &mut |_| {})
        .map_err(|error| Failure::Unwrap { path: path.to_owned(), error })?;
    job::warn(&found.repairs, &[]);
    Ok(found.factor)
}

fn read_values(path: &Path, vertices: usize) -> Result<Values, ReadError> {
    let values = if ending(path) == "txt" { decimal::read(path)? } else { npy::read(path)?.values };
    match values.len() {
        values if values != vertices => Err(Problem::Count { values, vertices }.in_file(path)),
        _ => Ok(values),
    }
}
