//! A picture beside an OBJ, with the material that shows it.

use crate::error::CommandError;
use crate::output::Files;
use crate::render;
use geom::io::Material;
use std::path::{Path, PathBuf};

/// A material with a picture: two files, named as the OBJ that they are for.
#[derive(Debug)]
pub(crate) struct MaterialFiles {
    /// The material's name.
    name: &'static str,
    material: PathBuf,
    picture: PathBuf,
    /// The material's file name.
    library: String,
}

impl MaterialFiles {
    /// With a checkerboard as the picture.
    pub(crate) fn checker(path: &Path) -> Self {
        Self::beside(path, "checker")
    }

    pub(crate) fn beside(path: &Path, name: &'static str) -> Self {
        let [material, picture] = ["mtl", "png"].map(|ending| path.with_extension(ending));
        let library = file_name(&material);
        Self { name, material, picture, library }
    }

    pub(crate) fn paths(&self) -> [&Path; 2] {
        [&self.material, &self.picture]
    }

    pub(crate) fn picture(&self) -> &Path {
        &self.picture
    }

    /// What the OBJ says of it.
    pub(crate) fn material(&self) -> Material<'_> {
        Material { library: &self.library, name: self.name }
    }

    /// Writes the material, and a checkerboard as its picture.
    pub(crate) fn write_checker(&self, files: &mut Files) -> Result<(), CommandError> {
        self.write_material(files)?;
        files.write_png(&self.picture, &render::Checker::texture())
    }

    /// Writes the material alone.
    pub(crate) fn write_material(&self, files: &mut Files) -> Result<(), CommandError> {
        files.write_text(&self.material, &material_text(self.name, &self.picture))
    }
}

/// A material that shows a picture beside it.
pub(crate) fn material_text(name: &str, picture: &Path) -> String {
    let picture = file_name(picture);
    format!("newmtl {name}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {picture}\n")
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
