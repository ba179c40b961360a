//! Stanford's polygon file format out, binary, little endian.
//!
//! Vertices are f64 and keep their order. A map is the list `texcoord` of `face`, u and v for each corner, which is what
//! `MeshLab` writes and reads; it reads f32 there, so f32 it is.

use std::io::Write;

use super::cells::Cells;
use super::error::WriteError;
use super::wedge::Wedges;
use crate::surface::{Model, Triangles};

/// Writes a model as binary PLY, with a texture coordinate for each corner and triangles in the place of polygons if given.
///
/// # Errors
/// When texture coordinates or triangles do not fit the model, or when writing fails.
pub fn write_ply(
    model: &Model,
    uv: Option<&[[f64; 2]]>,
    triangles: Option<&Triangles>,
    mut out: impl Write,
) -> Result<(), WriteError> {
    if let Some(uv) = uv {
        Wedges::check(model, uv)?;
    }
    let cells = Cells::new(model, triangles)?;
    let count = Count::for_lists_up_to(2 * model.faces().map(<[u32]>::len).max().unwrap_or(0));
    write_header(model, cells.len(), uv.is_some(), count, &mut out)?;
    for x in model.points().iter().flatten() {
        out.write_all(&x.to_le_bytes())?;
    }
    cells.for_each(|corners| {
        count.write(corners.len(), &mut out)?;
        for &corner in corners {
            out.write_all(&model.corners()[corner as usize].to_le_bytes())?;
        }
        let Some(uv) = uv else { return Ok(()) };
        count.write(2 * corners.len(), &mut out)?;
        for x in corners.iter().flat_map(|&corner| uv[corner as usize]) {
            out.write_all(&(x as f32).to_le_bytes())?;
        }
        Ok(())
    })?;
    Ok(())
}

fn write_header(model: &Model, faces: usize, has_uv: bool, count: Count, out: &mut impl Write) -> std::io::Result<()> {
    let count = count.name();
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", model.vertex_count())?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    writeln!(out, "element face {faces}\nproperty list {count} int vertex_indices")?;
    if has_uv {
        writeln!(out, "property list {count} float texcoord")?;
    }
    writeln!(out, "end_header")
}

/// The type of a list's length: the small one that every reader takes, where it is large enough.
#[derive(Clone, Copy)]
enum Count {
    U8,
    U32,
}

impl Count {
    fn for_lists_up_to(longest: usize) -> Self {
        if longest <= usize::from(u8::MAX) { Self::U8 } else { Self::U32 }
    }

    fn name(self) -> &'static str {
        match self {
            Self::U8 => "uchar",
            Self::U32 => "uint",
        }
    }

    fn write(self, count: usize, out: &mut impl Write) -> std::io::Result<()> {
        match self {
            Self::U8 => out.write_all(&[count as u8]),
            Self::U32 => out.write_all(&(count as u32).to_le_bytes()),
        }
    }
}
