//! Where the values of a mesh come from: a file, or they are computed.

use super::computed::Computed;
use super::decimal;
use super::ending;
use super::error::{Problem, ReadError};
use super::npy;
use super::values::Values;
use geom::{Attribute, AttributeDomain, Model, ScalarType};
use std::path::{Path, PathBuf};

/// Where the values of a mesh come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// The conformal factor φ.
    Factor,
    Computed(Computed),
    /// A file of values, one for each vertex.
    File(PathBuf),
    /// Numbers of the vertices in the mesh's own file, by their name.
    Attribute(String),
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
            "" if !text.is_empty() && !text.contains(':') => Ok(Self::Attribute(text.to_owned())),
            _ => Err("name phi, curvature, mean-curvature, height[:x|y|z], distance[:VERTEX], a file .npy or .txt, or numbers that the \
                      mesh has at its vertices"
                .into()),
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
            Self::Attribute(name) => attribute(model, name).map(Some).map_err(|problem| problem.in_file(path)),
        }
    }

    /// Whether values are computed: then NaN stands for vertices that are on no surface, and not for a mistake.
    pub(crate) fn is_computed(&self) -> bool {
        matches!(self, Self::Factor | Self::Computed(_))
    }
}

/// The numbers of a name that a model's file has at its vertices, one at each.
fn attribute(model: &Model, name: &str) -> Result<Values, Problem> {
    let is_field = |table: &&Attribute| table.domain() == AttributeDomain::Vertices && table.width() == Some(1);
    let tables = || model.attributes().tables.iter().filter(is_field);
    let Some(table) = tables().find(|table| table.meaning().to_string() == name) else {
        let there = tables().map(|table| table.meaning().to_string()).collect();
        return Err(Problem::NoAttribute { name: name.to_owned(), there });
    };
    let numbers = (0..table.rows()).flat_map(|row| table.row(row));
    Ok(match table.scalar() {
        ScalarType::F64 => Values::F64(numbers.collect()),
        ScalarType::F32 => Values::F32(numbers.map(|x| x as f32).collect()),
        // All others fit.
        _ => Values::I64(numbers.map(|x| x as i64).collect()),
    })
}

fn read_values(path: &Path, vertices: usize) -> Result<Values, ReadError> {
    let values = if ending(path) == "txt" { decimal::read(path)? } else { npy::read(path)?.values };
    match values.len() {
        values if values != vertices => Err(Problem::Count { values, vertices }.in_file(path)),
        _ => Ok(values),
    }
}
