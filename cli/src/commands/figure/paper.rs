//! What the paper prints beside its figures, and which files stand in for its models.

use super::maps::Map;
use crate::commands::compare::{MODELS, PaperModel, Variant};
use crate::error::CommandError;
use crate::output;
use std::path::{Path, PathBuf};

/// The mean area distortion D under Fig. 1, without cones and with them, on a model that the paper does not name.
const FIGURE_ONE: [f64; 2] = [47.361, 1.487];

/// A file that stands in for a model of the paper.
#[derive(Clone, Debug)]
pub(super) struct Stand {
    pub(super) model: &'static PaperModel,
    pub(super) path: PathBuf,
}

/// Those of the named models that are in a folder, in this order; which are not is told.
pub(super) fn stands(folder: &Path, names: &[&str]) -> Result<Vec<Stand>, CommandError> {
    let (mut found, mut missing) = (Vec::new(), String::new());
    for model in names.iter().filter_map(|name| MODELS.iter().find(|model| model.name == *name)) {
        match model.file.map(|file| folder.join(file)).filter(|path| path.is_file()) {
            Some(path) => found.push(Stand { model, path }),
            None => {
                let why = if model.file.is_some() { "not in the folder" } else { model.remark };
                missing += &format!("{}: {why}, left out\n", model.name);
            }
        }
    }
    if found.is_empty() {
        return Err(CommandError::NoPaperMeshes(folder.to_owned()));
    }
    if !missing.is_empty() {
        output::note(&missing);
    }
    Ok(found)
}

impl Stand {
    /// The numbers of cones that the paper has of it.
    pub(super) fn counts(&self) -> Vec<usize> {
        self.model.rows.iter().map(|row| row.cones).collect()
    }
}

/// What the paper prints for a method under Fig. 1.
pub(super) fn figure_one(method: Variant) -> Option<f64> {
    let [without, with] = FIGURE_ONE;
    if method == Variant::LSCM { Some(without) } else { (method == Variant::PAPER).then_some(with) }
}

/// What was measured of a map, with what Table 1 has for the model that it stands in for.
pub(super) fn beside(map: &Map, stand: Option<&Stand>, method: Variant, count: usize) -> Vec<String> {
    let measured = &map.quality.distortion;
    let (areal, angles) = (measured.area_inverse_mean, measured.quasi_conformal.mean);
    let row = stand.and_then(|stand| stand.model.rows.iter().find(|row| row.cones == count));
    let printed = row.and_then(|row| match method {
        Variant::PAPER => Some(row.ours),
        Variant::PUBLISHED | Variant::REUSING => Some(row.published),
        _ => None,
    });
    let told = |of: Option<f64>| of.map_or_else(String::new, |x| format!(", the paper {x:.3}"));
    vec![
        format!("areal {areal:.3}{}", told(printed.map(|p| p.areal))),
        format!("quasi-conformal {angles:.3}{}", told(printed.map(|p| p.quasi_conformal))),
        format!("D {:.3}, {} flipped", measured.area_mean, measured.flipped),
    ]
}
