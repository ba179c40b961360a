//! The map that a file has.

use super::unwrapped::{corner_uv, picked};
use crate::error::CommandError;
use cones::report::{OverlapReport, worth_measuring};
use geom::{MissingTexture, Model, Weld};
use std::path::Path;

/// The texture coordinates of all corners of a model that was read from a file.
pub(crate) fn texture(path: &Path, model: &Model) -> Result<Vec<[f64; 2]>, CommandError> {
    let corners = 0..model.corner_count();
    let uv = model.uv().filter(|uv| corners.clone().any(|corner| uv.index(corner).is_some()));
    let uv = uv.ok_or_else(|| CommandError::NoTexture(path.to_owned()))?;
    uv.all().map_err(|MissingTexture { corner: first, .. }| CommandError::PartlyNoTexture {
        path: path.to_owned(),
        lacking: corners.clone().filter(|&corner| uv.corner(corner).is_none()).count(),
        corners: corners.len(),
        vertex: model.corners()[first],
        face: model.face_start().partition_point(|&start| start as usize <= first) - 1,
    })
}

/// How much of a model's map lies over itself.
pub(crate) fn overlap(model: &Model, uv: &[[f64; 2]], weld: Weld) -> OverlapReport {
    let triangles = model.triangles();
    let (mut vertices, images) = (triangles.vertices(model), corner_uv(&triangles.corners, uv));
    weld.apply(model, &mut vertices);
    OverlapReport::of(&picked(&worth_measuring(&vertices, &images), &images))
}
