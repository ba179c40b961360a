//! Normals and colours as an OBJ has them.

use std::io::{self, Write};

use crate::surface::{Attribute, Meaning, Model, ScalarType};

/// The tables of a model that an OBJ can hold.
pub(super) struct Look<'a> {
    model: &'a Model,
    normals: Option<&'a Attribute>,
    colours: Option<&'a Attribute>,
    /// The row of colours of each vertex: that of its first corner that has one.
    colour_row: Vec<u32>,
}

impl<'a> Look<'a> {
    pub(super) fn of(model: &'a Model) -> Self {
        let table = |meaning| model.attributes().table(&meaning);
        let (normals, colours) = (table(Meaning::Normal), table(Meaning::Colour));
        let mut colour_row = Vec::new();
        if let Some(colours) = colours {
            // A vertex without corners has the row of its number, if rows are the vertices'.
            let is_of_vertices = colours.domain() == crate::surface::AttributeDomain::Vertices;
            let own = |v| if is_of_vertices { v } else { Attribute::NONE };
            colour_row = (0..model.vertex_count() as u32).map(own).collect();
            for (corner, &v) in model.corners().iter().enumerate().rev() {
                if let Some(row) = colours.row_at(model.corners(), corner) {
                    colour_row[v as usize] = row as u32;
                }
            }
        }
        Self { model, normals, colours, colour_row }
    }

    /// Writes what stands behind a vertex: shares of 1. All vertices have a colour or none.
    pub(super) fn colour(&self, vertex: usize, out: &mut impl Write) -> io::Result<()> {
        let Some(table) = self.colours else { return Ok(()) };
        let width = table.width().unwrap_or(3).min(4);
        let mut row = table.row(self.colour_row[vertex] as usize);
        (0..width).try_for_each(|_| {
            let share = row.next().map_or(1.0, |x| x / table.scalar().one());
            // Five digits give 16 bits back.
            let share = if table.scalar() == ScalarType::F64 { share } else { (share * 1e5).round() / 1e5 };
            write!(out, " {share}")
        })
    }

    /// Writes the lines of normals, in the order of their rows.
    pub(super) fn normals(&self, out: &mut impl Write) -> io::Result<()> {
        let Some(table) = self.normals else { return Ok(()) };
        for row in 0..table.rows() {
            out.write_all(b"vn")?;
            for x in table.row(row) {
                // Those of f32 have its digits.
                if table.scalar() == ScalarType::F64 { write!(out, " {x:?}")? } else { write!(out, " {:?}", x as f32)? }
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    }

    /// The normal of a corner.
    pub(super) fn normal(&self, corner: usize) -> Option<usize> {
        self.normals?.row_at(self.model.corners(), corner)
    }
}

/// A name without spaces, at which many readers end it, nor `#` before it, which begins a comment.
pub(super) fn one_word(name: &str) -> String {
    let word = name.split(|c: char| c.is_whitespace() || c.is_control()).filter(|part| !part.is_empty());
    let word = word.collect::<Vec<_>>().join("_");
    let word = word.trim_start_matches('#');
    if word.is_empty() { "unnamed" } else { word }.to_owned()
}
