//! Wedges: what the corners of one vertex that have one texture coordinate are together (H. Hoppe, *Efficient
//! implementation of progressive meshes*, 1998). A file lists a texture coordinate once for each of them.

use super::error::WriteError;
use crate::surface::Model;

/// The wedges of a map, numbered by their first corners.
pub(super) struct Wedges {
    /// The wedge of each corner.
    pub(super) of_corner: Vec<u32>,
    /// The first corner of each wedge.
    pub(super) first: Vec<u32>,
}

impl Wedges {
    /// The wedges of a map that has a texture coordinate for each corner. Coordinates are the same if their bits are.
    pub(super) fn new(model: &Model, uv: &[[f64; 2]]) -> Result<Self, WriteError> {
        Self::check(model, uv)?;
        let bits = |corner: u32| uv[corner as usize].map(f64::to_bits);
        let (start, mut corners) = corners_by_vertex(model);
        let mut first_of_corner = vec![0; corners.len()];
        for ends in start.windows(2) {
            let ring = &mut corners[ends[0] as usize..ends[1] as usize];
            ring.sort_unstable_by_key(|&corner| (bits(corner), corner));
            for wedge in ring.chunk_by(|&a, &b| bits(a) == bits(b)) {
                wedge.iter().for_each(|&corner| first_of_corner[corner as usize] = wedge[0]);
            }
        }
        Ok(Self::numbered(first_of_corner))
    }

    /// The wedges of a model without map: one a vertex, if any corner is there.
    pub(super) fn of_vertices(model: &Model) -> Self {
        let mut first = vec![u32::MAX; model.vertex_count()];
        for (corner, &vertex) in model.corners().iter().enumerate().rev() {
            first[vertex as usize] = corner as u32;
        }
        Self::numbered(model.corners().iter().map(|&vertex| first[vertex as usize]).collect())
    }

    /// Whether a map has a finite texture coordinate for each corner of a model.
    pub(super) fn check(model: &Model, uv: &[[f64; 2]]) -> Result<(), WriteError> {
        let corners = model.corner_count();
        if uv.len() != corners {
            return Err(WriteError::TextureCount { found: uv.len(), corners });
        }
        match uv.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            Some(corner) => Err(WriteError::NotFinite { corner }),
            None => Ok(()),
        }
    }

    /// Numbers wedges of which the first corner is known for each corner.
    fn numbered(mut of_corner: Vec<u32>) -> Self {
        let mut first = Vec::new();
        for corner in 0..of_corner.len() {
            let leader = of_corner[corner] as usize;
            of_corner[corner] = if leader == corner {
                first.push(corner as u32);
                first.len() as u32 - 1
            } else {
                of_corner[leader]
            };
        }
        Self { of_corner, first }
    }
}

/// The corners sorted by their vertices (a counting sort), and where each vertex's begin.
fn corners_by_vertex(model: &Model) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0_u32; model.vertex_count() + 1];
    for &vertex in model.corners() {
        start[vertex as usize + 1] += 1;
    }
    for vertex in 0..model.vertex_count() {
        start[vertex + 1] += start[vertex];
    }
    let mut next = start.clone();
    let mut corners = vec![0; model.corner_count()];
    for (corner, &vertex) in model.corners().iter().enumerate() {
        corners[next[vertex as usize] as usize] = corner as u32;
        next[vertex as usize] += 1;
    }
    (start, corners)
}
