//! A surface as a file in any of the formats that are written.

use crate::error::CommandError;
use crate::input;
use crate::output::{self, Files};
use crate::render;
use clap::ValueEnum;
use geom::io::{GlbTexture, Material, MeshFormat, NotKept, ObjContent, not_kept, write_glb, write_obj, write_ply};
use geom::{Model, Triangles};
use std::path::{Component, Path};

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
    /// The file that it came from, for what that names beside itself.
    pub(crate) source: Option<&'a Path>,
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
        let &Self { model, source, uv, triangles, material } = self;
        match format {
            MeshFormat::Ply => files.write(path, |out| write_ply(model, uv, triangles, out))?,
            MeshFormat::Glb => {
                let own = model.triangles();
                let texture = uv.map(|_| render::Checker::texture().png()).transpose();
                files.write(path, |out| {
                    let texture = texture?;
                    let texture = texture.as_deref().map(GlbTexture::Checker);
                    write_glb(model, uv, triangles.unwrap_or(&own), texture, out)
                })?;
            }
            MeshFormat::Obj => {
                let libraries = source.and_then(|source| way_back(source, path));
                let content = ObjContent { uv, triangles, material, libraries: libraries.as_deref() };
                files.write(path, |out| write_obj(model, &content, out))?;
            }
        }
        Ok(not_kept(model, format))
    }
}

/// The way from the folder of a file that is written to that of the one that was read, with `/` at its end; none where both are the same, or either is no
/// file in a folder.
fn way_back(source: &Path, path: &Path) -> Option<String> {
    if input::is_standard(source) || path == Path::new(output::STANDARD) {
        return None;
    }
    let [from, to] = [path, source].map(|path| output::folder_of(path).canonicalize());
    let (from, to) = (from.ok()?, to.ok()?);
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 || (from.components().count() == shared && to.components().count() == shared) {
        return None;
    }
    let up = from.components().skip(shared).map(|_| "..".to_owned());
    let down = to.components().skip(shared).filter_map(|component| match component {
        Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
        _ => None,
    });
    Some(up.chain(down).map(|name| name + "/").collect())
}

/// Writes a surface that was read from a file with other texture coordinates.
pub(crate) fn write_map(
    model: &Model,
    uv: &[[f64; 2]],
    (input, output): (&Path, &Path),
    format: MeshFormat,
) -> Result<(), CommandError> {
    let file = SurfaceFile { model, source: Some(input), uv: Some(uv), triangles: None, material: None };
    let mut files = Files::new();
    let lost = file.write(&mut files, output, format)?;
    files.finish()?;
    if let Some(lost) = lost {
        output::warn(&lost.to_string());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_back_leads_from_the_written_file_to_the_read_one() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["in/a", "out"] {
            std::fs::create_dir_all(folder.path().join(name)).unwrap();
        }
        let way = |source: &str, path: &str| way_back(&folder.path().join(source), &folder.path().join(path));
        assert_eq!(way("in/a/m.obj", "out/m.obj").as_deref(), Some("../in/a/"));
        assert_eq!(way("in/a/m.obj", "m.obj").as_deref(), Some("in/a/"));
        assert_eq!(way("m.obj", "in/a/m.obj").as_deref(), Some("../../"));
        assert_eq!(way("in/m.obj", "in/n.obj"), None);
        assert_eq!(way_back(Path::new("-"), Path::new("m.obj")), None);
        assert_eq!(way_back(Path::new("m.obj"), Path::new("-")), None);
    }
}
