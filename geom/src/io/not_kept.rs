//! What a format cannot hold of what a model says.

use std::fmt;

use super::write_glb;
use crate::surface::{Attribute, AttributeDomain, Attributes, Meaning, Model};

/// The formats that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford's polygon file format.
    Ply,
    /// Binary glTF.
    Glb,
}

impl MeshFormat {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Obj, Self::Ply, Self::Glb];

    /// The ending of its files' names, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Glb => "glb",
        }
    }
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.extension().to_uppercase())
    }
}

/// What of a model a format does not hold. Printed, it is one line: `not kept in GLB: groups, label of faces`.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct NotKept {
    /// The format.
    pub format: MeshFormat,
    /// What it does not hold, in words.
    pub what: Vec<String>,
}

impl fmt::Display for NotKept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not kept in {}: {}", self.format, self.what.join(", "))
    }
}

/// What a model says that a file of this format does not; none where it says all. Comments, polygons that become triangles in GLB and
/// numbers that become f32 there are not counted, nor a map of some corners alone, which PLY and GLB do not hold, as writers may be given one of all.
///
/// ```
/// use geom::io::{MeshFormat, not_kept, read_bytes};
///
/// let model = read_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\ng left\nf 1 2 3\n".to_vec(), "a.obj")?;
/// assert_eq!(not_kept(&model, MeshFormat::Obj), None);
/// let lost = not_kept(&model, MeshFormat::Ply).expect("PLY has no groups");
/// assert_eq!(lost.to_string(), "not kept in PLY: groups");
/// # Ok::<(), geom::io::ReadError>(())
/// ```
pub fn not_kept(model: &Model, format: MeshFormat) -> Option<NotKept> {
    if format == MeshFormat::Obj && model.obj_text().is_some() {
        return None;
    }
    let attributes = model.attributes();
    let mut what = attributes.left.clone();
    if format == MeshFormat::Ply && attributes.face_material.iter().any(|&m| (m as usize) < attributes.materials.len())
    {
        what.push(format!("materials ({})", attributes.materials.join(", ")));
    }
    let are_several = attributes.face_node.windows(2).any(|pair| pair[0] != pair[1]);
    if format != MeshFormat::Glb && (are_several || attributes.nodes.iter().any(|node| !node.name.is_empty())) {
        what.push("nodes".to_owned());
    }
    if format != MeshFormat::Glb && (0..model.face_count()).any(|face| attributes.look(face).is_some()) {
        what.push("looks of materials".to_owned());
    }
    if format != MeshFormat::Ply {
        what.extend(attributes.tables.iter().filter(|table| !is_kept(attributes, table, format)).map(name));
        what.extend(attributes.listings.iter().map(|listing| format!("elements `{}`", listing.name)));
    }
    (!what.is_empty()).then_some(NotKept { format, what })
}

fn is_kept(attributes: &Attributes, table: &Attribute, format: MeshFormat) -> bool {
    // Of two tables with one meaning the first is written.
    let is_first = attributes.table(table.meaning()).is_some_and(|first| std::ptr::eq(first, table));
    match (format, table.meaning()) {
        (MeshFormat::Ply, _) => true,
        (MeshFormat::Glb, _) => write_glb::is_written(table) && is_first,
        (MeshFormat::Obj, Meaning::Normal) => is_first,
        // An OBJ has one colour for each vertex.
        (MeshFormat::Obj, Meaning::Colour) => is_first && table.domain() == AttributeDomain::Vertices,
        (MeshFormat::Obj, Meaning::Other(_)) => false,
    }
}

fn name(table: &Attribute) -> String {
    match table.domain() {
        AttributeDomain::Faces => format!("{} of faces", table.meaning()),
        AttributeDomain::Corners if *table.meaning() == Meaning::Colour => {
            "colours that some corners of a vertex have and others have not".to_owned()
        }
        AttributeDomain::Vertices | AttributeDomain::Corners => table.meaning().to_string(),
    }
}
