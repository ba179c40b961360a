//! A checkerboard beside an OBJ.

use crate::error::CommandError;
use crate::output::Files;
use crate::render;
use geom::io::Material;
use std::path::{Path, PathBuf};

/// The material's name.
const NAME: &str = "checker";

/// A material with a checkerboard as its picture: two files, named as the OBJ that they are for.
#[derive(Debug)]
pub(crate) struct CheckerFiles {
    material: PathBuf,
    picture: PathBuf,
    /// The material's file name.
    library: String,
}

impl CheckerFiles {
    pub(crate) fn beside(path: &Path) -> Self {
        let [material, picture] = ["mtl", "png"].map(|ending| path.with_extension(ending));
        let library = file_name(&material);
        Self { material, picture, library }
    }

    pub(crate) fn paths(&self) -> [&Path; 2] {
        [&self.material, &self.picture]
    }

    /// What the OBJ says of it.
    pub(crate) fn material(&self) -> Material<'_> {
        Material { library: &self.library, name: NAME }
    }

    pub(crate) fn write(&self, files: &mut Files) -> Result<(), CommandError> {
        let picture = file_name(&self.picture);
        let text = format!("newmtl {NAME}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {picture}\n");
        files.write_text(&self.material, &text)?;
        files.write_png(&self.picture, &render::Checker::texture())
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
