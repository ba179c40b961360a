//! Where the values of a mesh come from: a file, or they are computed.

use super::computed::Computed;
use super::decimal;
use super::ending;
use super::error::{Problem, ReadError};
use super::npy;
use super::values::Values;
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

    /// The values on a mesh, read or computed; none for the conformal factor, which takes a solver.
    pub(crate) fn values(
        &self,
        path: &Path,
        model: &Model,
        triangles: &[[u32; 3]],
    ) -> Result<Option<Values>, ReadError> {
        let vertices = model.vertex_count();
        match self {
            Self::Factor => Ok(None),
            Self::Computed(Computed::Distance(Some(vertex))) if *vertex >= vertices => {
                Err(Problem::NoVertex { vertex: *vertex, vertices }.in_file(path))
            }
            Self::Computed(computed) => Ok(Some(Values::F64(computed.on(model, triangles)))),
            Self::File(file) => read_values(file, vertices).map(Some),
        }
    }

    /// Whether NaN stands for vertices that are on no surface, and not for a mistake.
    pub(crate) fn leaves_gaps(&self) -> bool {
        !matches!(self, Self::File(_))
    }
}

fn read_values(path: &Path, vertices: usize) -> Result<Values, ReadError> {
    let values = if ending(path) == "txt" { decimal::read(path)? } else { npy::read(path)?.values };
    match values.len() {
        values if values != vertices => Err(Problem::Count { values, vertices }.in_file(path)),
        _ => Ok(values),
    }
}
