//! Stanford's polygon file format out, binary, little endian.
//!
//! Vertices are f64 and keep their order. A map is `s t` of vertices, in f32 as `MeshLab` takes no others: the one way that Blender,
//! `MeshLab`, trimesh and meshio all read. A list `texcoord` of faces besides, as `MeshLab` writes it, keeps meshio from
//! reading the file at all. A vertex has one `s t`, so those along seams are split: the copies follow the last vertex, and
//! `source_vertex` says of which vertex each is one, so that our reader joins them again.
//!
//! Normals, colours and all other properties, comments and elements are written as they came, but for the comment `TextureFile`, which names the picture of
//! a map: it goes where another map is written. Colours that came with another
//! format have 8 bits, as `MeshLab` reads no others.

use std::collections::HashSet;
use std::io::{self, Write};

use super::cells::Cells;
use super::error::WriteError;
use super::look::one_word;
use super::ply::SOURCE;
use super::wedge::{Split, Wedges};
use crate::surface::{Attribute, AttributeDomain, Listing, Meaning, Model, ScalarType, Triangles};

/// Writes a model as binary PLY, with a texture coordinate for each corner and triangles in the place of polygons if given. Without texture coordinates the
/// model's own are written, if each corner has one; a map of some corners alone a PLY cannot hold.
///
/// # Errors
/// When texture coordinates or triangles do not fit the model, or when writing fails.
pub fn write_ply(
    model: &Model,
    uv: Option<&[[f64; 2]]>,
    triangles: Option<&Triangles>,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let own = model.whole_uv();
    let has_old_map = uv.is_none() || uv == own.as_deref();
    let uv = uv.or(own.as_deref());
    let of_corners: Vec<&Attribute> =
        model.attributes().tables.iter().filter(is_of(AttributeDomain::Corners)).collect();
    let wedges = Wedges::split(model, uv, &of_corners)?;
    let longest = model.faces().map(<[u32]>::len).max().unwrap_or(0);
    let tables = &model.attributes().tables;
    let job = Job {
        model,
        uv,
        has_old_map,
        split: Split::new(model, &wedges),
        count: Count::for_lists_up_to(longest),
        vertex_columns: columns(
            tables.iter().filter(|table| table.domain() != AttributeDomain::Faces),
            &["x", "y", "z", "s", "t", SOURCE],
        ),
        face_columns: columns(
            tables.iter().filter(is_of(AttributeDomain::Faces)),
            &["vertex_indices", "vertex_index", "texcoord"],
        ),
    };
    let cells = Cells::new(model, triangles)?;
    job.header(cells.len(), &mut out)?;
    job.vertices(&mut out)?;
    job.faces(cells, &mut out)?;
    for listing in &model.attributes().listings {
        let columns = columns(listing.columns.iter(), &[]);
        for row in 0..listing.count {
            columns.iter().try_for_each(|column| column.write(Some(row), &mut out))?;
        }
    }
    Ok(())
}

fn is_of(domain: AttributeDomain) -> impl Fn(&&Attribute) -> bool {
    move |table| table.domain() == domain
}

struct Job<'a> {
    model: &'a Model,
    uv: Option<&'a [[f64; 2]]>,
    /// Whether these are the model's own.
    has_old_map: bool,
    split: Split,
    count: Count,
    /// Of vertices and corners.
    vertex_columns: Vec<Column<'a>>,
    face_columns: Vec<Column<'a>>,
}

impl Job<'_> {
    fn has_copies(&self) -> bool {
        self.split.vertex.len() > self.model.vertex_count()
    }

    fn header(&self, faces: usize, out: &mut impl Write) -> io::Result<()> {
        let count = self.count.name();
        writeln!(out, "ply\nformat binary_little_endian 1.0")?;
        let is_of_old_map = |comment: &str| comment.split_whitespace().nth(1) == Some("TextureFile");
        let comments = self.model.attributes().comments.iter();
        comments
            .filter(|comment| self.has_old_map || !is_of_old_map(comment))
            .try_for_each(|comment| writeln!(out, "{comment}"))?;
        writeln!(out, "element vertex {}", self.split.vertex.len())?;
        writeln!(out, "property double x\nproperty double y\nproperty double z")?;
        self.vertex_columns.iter().try_for_each(|column| column.header(out))?;
        if self.uv.is_some() {
            writeln!(out, "property float s\nproperty float t")?;
        }
        if self.has_copies() {
            writeln!(out, "property uint {SOURCE}")?;
        }
        writeln!(out, "element face {faces}\nproperty list {count} int vertex_indices")?;
        self.face_columns.iter().try_for_each(|column| column.header(out))?;
        for Listing { name, count, columns } in &self.model.attributes().listings {
            writeln!(out, "element {name} {count}")?;
            self::columns(columns.iter(), &[]).iter().try_for_each(|column| column.header(out))?;
        }
        writeln!(out, "end_header")
    }

    fn vertices(&self, out: &mut impl Write) -> io::Result<()> {
        let Split { vertex, corner, .. } = &self.split;
        for (number, (&v, &corner)) in vertex.iter().zip(corner).enumerate() {
            for x in self.model.points()[v as usize] {
                out.write_all(&x.to_le_bytes())?;
            }
            for column in &self.vertex_columns {
                column.write(self.split.row(self.model, column.table, number), out)?;
            }
            if let Some(uv) = self.uv {
                for x in uv.get(corner as usize).copied().unwrap_or_default() {
                    out.write_all(&(x as f32).to_le_bytes())?;
                }
            }
            if self.has_copies() {
                out.write_all(&v.to_le_bytes())?;
            }
        }
        Ok(())
    }

    fn faces(&self, cells: Cells, out: &mut impl Write) -> io::Result<()> {
        cells.for_each(|face, corners| {
            self.count.write(corners.len(), out)?;
            for &corner in corners {
                out.write_all(&self.split.of_corner[corner as usize].to_le_bytes())?;
            }
            self.face_columns.iter().try_for_each(|column| column.write(Some(face), out))
        })
    }
}

/// A table as properties.
struct Column<'a> {
    table: &'a Attribute,
    /// The type that is written.
    scalar: ScalarType,
    /// The type of lists' lengths.
    count: Count,
    names: Vec<String>,
}

/// Tables as properties, no two of one name, nor of one that is taken.
fn columns<'a>(tables: impl Iterator<Item = &'a Attribute>, taken: &[&str]) -> Vec<Column<'a>> {
    let mut taken: HashSet<String> = taken.iter().map(|&name| name.to_owned()).collect();
    let column = |table: &'a Attribute| {
        let mut column = Column::new(table);
        for name in &mut column.names {
            while !taken.insert(name.clone()) {
                name.push('_');
            }
        }
        column
    };
    tables.map(column).collect()
}

impl<'a> Column<'a> {
    fn new(table: &'a Attribute) -> Self {
        let is_wide =
            *table.meaning() == Meaning::Colour && matches!(table.scalar(), ScalarType::U16 | ScalarType::U32);
        let scalar = if is_wide { ScalarType::U8 } else { table.scalar() };
        let longest = match table.width() {
            Some(_) => 0,
            None => (0..table.rows()).map(|row| table.row(row).len()).max().unwrap_or(0),
        };
        Self { table, scalar, count: Count::for_lists_up_to(longest), names: names(table) }
    }

    fn header(&self, out: &mut impl Write) -> io::Result<()> {
        let (kind, count) = (scalar_name(self.scalar), self.count.name());
        let list = if self.table.width().is_none() { format!("list {count} ") } else { String::new() };
        self.names.iter().try_for_each(|name| writeln!(out, "property {list}{kind} {name}"))
    }

    /// Writes a row, zeros where there is none.
    fn write(&self, row: Option<usize>, out: &mut impl Write) -> io::Result<()> {
        let bytes = row.map_or(&[][..], |row| self.table.row_bytes(row));
        let Some(width) = self.table.width() else {
            self.count.write(bytes.len() / self.scalar.size(), out)?;
            return out.write_all(bytes);
        };
        if bytes.is_empty() {
            return (0..width * self.scalar.size()).try_for_each(|_| out.write_all(&[0]));
        }
        if self.scalar == self.table.scalar() {
            return out.write_all(bytes);
        }
        let share = self.scalar.one() / self.table.scalar().one();
        let mut narrow = Vec::with_capacity(4);
        bytes
            .chunks_exact(self.table.scalar().size())
            .for_each(|x| self.scalar.encode(self.table.scalar().decode(x) * share, &mut narrow));
        out.write_all(&narrow)
    }
}

/// The names of a table's properties, without spaces, as they stand in a line of words.
fn names(table: &Attribute) -> Vec<String> {
    let width = table.width().unwrap_or(1);
    let known: &[&str] = match table.meaning() {
        Meaning::Normal => &["nx", "ny", "nz"],
        Meaning::Colour => &["red", "green", "blue", "alpha"],
        Meaning::Other(name) => {
            let word = one_word(name);
            return if width == 1 { vec![word] } else { (0..width).map(|k| format!("{word}_{k}")).collect() };
        }
    };
    (0..width).map(|k| known.get(k).map_or_else(|| format!("{}_{k}", known[0]), ToString::to_string)).collect()
}

fn scalar_name(scalar: ScalarType) -> &'static str {
    match scalar {
        ScalarType::I8 => "int8",
        // What is called uchar meshio reads with a sign.
        ScalarType::U8 => "uint8",
        ScalarType::I16 => "short",
        ScalarType::U16 => "ushort",
        ScalarType::I32 => "int",
        ScalarType::U32 => "uint",
        ScalarType::F32 => "float",
        ScalarType::F64 => "double",
    }
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
            Self::U8 => "uint8",
            Self::U32 => "uint",
        }
    }

    fn write(self, count: usize, out: &mut impl Write) -> io::Result<()> {
        match self {
            Self::U8 => out.write_all(&[count as u8]),
            Self::U32 => out.write_all(&(count as u32).to_le_bytes()),
        }
    }
}
