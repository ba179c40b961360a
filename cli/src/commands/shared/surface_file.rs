//! A surface as a file in any of the formats that are written.

use crate::error::CommandError;
use crate::output::Files;
use crate::render;
use clap::ValueEnum;
use geom::io::{Material, MeshFormat, NotKept, ObjContent, not_kept, write_glb, write_obj, write_ply};
use geom::{Model, Triangles};
use std::path::Path;

/// The formats by the names of their endings.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum FormatName {
    /// Wavefront OBJ
    Obj,
    /// Stanford PLY, binary
    Ply,
    /// Binary glTF
    Glb,
}

impl From<FormatName> for MeshFormat {
    fn from(name: FormatName) -> Self {
        match name {
            FormatName::Obj => Self::Obj,
            FormatName::Ply => Self::Ply,
            FormatName::Glb => Self::Glb,
        }
    }
}

/// A surface as it is to be written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceFile<'a> {
    pub(crate) model: &'a Model,
    /// A texture coordinate for each corner.
    pub(crate) uv: Option<&'a [[f64; 2]]>,
    /// Triangles in place of polygons.
    pub(crate) triangles: Option<&'a Triangles>,
    /// A material for an OBJ.
    pub(crate) material: Option<Material<'a>>,
}

impl SurfaceFile<'_> {
    /// Writes it; what the format does not hold of it.
    pub(crate) fn write(
        &self,
        files: &mut Files,
        path: &Path,
        format: MeshFormat,
    ) -> Result<Option<NotKept>, CommandError> {
        let &Self { model, uv, triangles, material } = self;
        match format {
            MeshFormat::Ply => files.write(path, |out| write_ply(model, uv, triangles, out))?,
            MeshFormat::Glb => {
                let own = model.triangles();
                let texture = uv.map(|_| render::Checker::texture().png()).transpose();
                files.write(path, |out| write_glb(model, uv, triangles.unwrap_or(&own), texture?.as_deref(), out))?;
            }
            MeshFormat::Obj => {
                let content = ObjContent { uv, triangles, material };
                files.write(path, |out| write_obj(model, &content, out))?;
            }
        }
        Ok(not_kept(model, format))
    }
}
