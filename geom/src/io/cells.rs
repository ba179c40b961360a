//! The faces that are written: a model's polygons, or the triangles they were cut into.

use super::error::WriteError;
use crate::surface::{Model, Triangles};

/// What stands in the file for each face: lists of corners.
pub(super) struct Cells<'a> {
    model: &'a Model,
    triangles: Option<&'a Triangles>,
    /// The first triangle that was not given yet.
    next: usize,
}

impl<'a> Cells<'a> {
    /// Polygons, or these triangles of them in the order of their faces.
    pub(super) fn new(model: &'a Model, triangles: Option<&'a Triangles>) -> Result<Self, WriteError> {
        if let Some(triangles) = triangles {
            check(model, triangles)?;
        }
        Ok(Self { model, triangles, next: 0 })
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.triangles.map_or(self.model.face_count(), Triangles::len)
    }

    /// Calls `take` with the face and the corners of each.
    pub(super) fn for_each(
        mut self,
        mut take: impl FnMut(usize, &[u32]) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        let mut polygon = Vec::new();
        for face in 0..self.model.face_count() {
            match self.triangles_of(face) {
                Some(triangles) => triangles.iter().try_for_each(|corners| take(face, corners))?,
                None => {
                    polygon.clear();
                    polygon.extend(self.model.face_corners(face).map(|corner| corner as u32));
                    take(face, &polygon)?;
                }
            }
        }
        Ok(())
    }

    /// The triangles in place of a face, if it is not to be written as it is. Faces are asked in order.
    pub(super) fn triangles_of(&mut self, face: usize) -> Option<&'a [[u32; 3]]> {
        let triangles = self.triangles?;
        let rest = &triangles.face_of[self.next..];
        let count = rest.iter().take_while(|&&of| of as usize == face).count();
        let cut = &triangles.corners[self.next..self.next + count];
        self.next += count;
        Some(cut)
    }
}

fn check(model: &Model, triangles: &Triangles) -> Result<(), WriteError> {
    let mut last = 0;
    for (triangle, corners) in triangles.corners.iter().enumerate() {
        let face = triangles.face_of.get(triangle).map_or(usize::MAX, |&face| face as usize);
        let fits = face < model.face_count() && face >= last && {
            let own = model.face_corners(face);
            corners.iter().all(|&corner| own.contains(&(corner as usize)))
        };
        if !fits {
            return Err(WriteError::ForeignTriangle { triangle });
        }
        last = face;
    }
    Ok(())
}
