//! Wedges: what the corners of one vertex that have one texture coordinate, one normal and so on are together (H. Hoppe, *Efficient
//! implementation of progressive meshes*, 1998). A file lists a texture coordinate once for each of them.

use std::cmp::Ordering;

use super::error::WriteError;
use crate::parallel::map;
use crate::surface::{Attribute, AttributeDomain, Model};

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
        Self::split(model, Some(uv), &[])
    }

    /// The wedges of a model whose corners may have a texture coordinate, and rows of some tables. Without any of them they are
    /// the vertices that have corners.
    pub(super) fn split(model: &Model, uv: Option<&[[f64; 2]]>, tables: &[&Attribute]) -> Result<Self, WriteError> {
        if let Some(uv) = uv {
            Self::check(model, uv)?;
        }
        Ok(Self::unchecked(model, uv, tables))
    }

    /// The same of texture coordinates that need not be finite.
    pub(super) fn unchecked(model: &Model, uv: Option<&[[f64; 2]]>, tables: &[&Attribute]) -> Self {
        let (start, mut corners) = corners_by_vertex(model);
        let order = |a: u32, b: u32| order(model, uv, tables, a, b);
        let is_one = |v: usize| {
            let ring = &corners[start[v] as usize..start[v + 1] as usize];
            ring.iter().all(|&corner| order(ring[0], corner).is_eq())
        };
        // Corners ascend, and most vertices are one wedge.
        let is_one = map(model.vertex_count(), is_one);
        let mut first_of_corner = vec![0; corners.len()];
        for (ends, is_one) in start.windows(2).zip(is_one) {
            let ring = &mut corners[ends[0] as usize..ends[1] as usize];
            if is_one {
                ring.iter().for_each(|&corner| first_of_corner[corner as usize] = ring[0]);
                continue;
            }
            ring.sort_unstable_by(|&a, &b| order(a, b).then(a.cmp(&b)));
            for wedge in ring.chunk_by(|&a, &b| order(a, b).is_eq()) {
                wedge.iter().for_each(|&corner| first_of_corner[corner as usize] = wedge[0]);
            }
        }
        Self::numbered(first_of_corner)
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

/// Two corners of a vertex in some order, equal if all bits of what they have are.
fn order(model: &Model, uv: Option<&[[f64; 2]]>, tables: &[&Attribute], a: u32, b: u32) -> Ordering {
    let point = |corner: u32| uv.map(|uv| uv[corner as usize].map(f64::to_bits));
    let row = |table: &Attribute, corner: u32| table.row_at(model.corners(), corner as usize);
    let by_table = |table: &&Attribute| {
        let [a, b] = [row(table, a), row(table, b)];
        // Most rows that are equal are the same row.
        if a == b { Ordering::Equal } else { a.map(|a| table.row_bytes(a)).cmp(&b.map(|b| table.row_bytes(b))) }
    };
    tables.iter().map(by_table).fold(point(a).cmp(&point(b)), Ordering::then)
}

/// Wedges as the vertices of a file: first the model's vertices under their own numbers, each with its first wedge, then the
/// copies that its other wedges need.
pub(super) struct Split {
    /// The file's vertex of each corner.
    pub(super) of_corner: Vec<u32>,
    /// The model's vertex that each of the file's is.
    pub(super) vertex: Vec<u32>,
    /// A corner of each of the file's vertices; [`Attribute::NONE`] where there is none.
    pub(super) corner: Vec<u32>,
}

impl Split {
    pub(super) fn new(model: &Model, wedges: &Wedges) -> Self {
        let mut vertex: Vec<u32> = (0..model.vertex_count() as u32).collect();
        let mut corner = vec![Attribute::NONE; vertex.len()];
        let number = |&first: &u32| {
            let v = model.corners()[first as usize];
            if corner[v as usize] == Attribute::NONE {
                corner[v as usize] = first;
                return v;
            }
            vertex.push(v);
            corner.push(first);
            vertex.len() as u32 - 1
        };
        let of_wedge: Vec<u32> = wedges.first.iter().map(number).collect();
        let of_corner = wedges.of_corner.iter().map(|&wedge| of_wedge[wedge as usize]).collect();
        Self { of_corner, vertex, corner }
    }

    /// The row of a table that a vertex of the file has.
    pub(super) fn row(&self, model: &Model, table: &Attribute, vertex: usize) -> Option<usize> {
        match self.corner[vertex] {
            Attribute::NONE => (table.domain() == AttributeDomain::Vertices).then_some(vertex),
            corner => table.row_at(model.corners(), corner as usize),
        }
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
