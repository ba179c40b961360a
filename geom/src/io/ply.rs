//! Stanford's polygon file format: text and binary of both byte orders.
//!
//! The header names elements and their properties in any order; we take `x`, `y`, `z` of `vertex`, the list `vertex_indices`
//! (or `vertex_index`) of `face` and of `tristrips`, and texture coordinates: `texcoord` of `face` as `MeshLab` writes it, or
//! `s t`, `u v` or `texture_u texture_v` of `vertex`. A strip's triangles alternate in direction, -1
//! starts a new one, and triangles that merely turn a strip (a vertex twice) are left out. All other properties, comments
//! and elements are kept as [`Attributes`]. Vertices that were split along seams when the file was written are joined again where
//! it says of what they are copies: the property [`SOURCE`].
//!
//! Source: Greg Turk, *The PLY polygon file format*, 1994. The ply-rs-bw crate was tried and is the oracle of our tests; as
//! the reader it lacks: it fills the memory for a binary header of 4·10⁹ elements without properties, narrows text to f32,
//! refuses `.5`, `1.`, blank lines, property names with dots and comments that are not UTF-8, and names no bytes in errors.

mod columns;
mod header;
mod values;

use super::error::{Fault, Place, Problem};
use super::joined::Joined;
use crate::surface::{
    AttributeDomain, Attributes, MAX_COORDINATE, Model, Polygons, Skipped, TextureCoordinates, is_coordinate,
};
use columns::{Columns, tables};
use header::{Element, Encoding, Header, Shape};
use values::{Binary, Text, Values};

/// The property of `vertex` that says of which vertex each is a copy: itself, or an earlier one at its place.
pub(super) const SOURCE: &str = "source_vertex";

pub(super) fn read(bytes: &[u8]) -> Result<Model, Fault> {
    let (header, payload) = header::read(bytes)?;
    let mut draft = Draft { vertices: header.count_of("vertex"), ..Draft::default() };
    draft.attributes.comments.clone_from(&header.comments);
    match header.encoding {
        Encoding::Text => draft.take_all(&header, &mut Text::new(bytes, &header, payload)),
        Encoding::Binary(order) => draft.take_all(&header, &mut Binary::new(bytes, payload, order)),
    }?;
    draft.finish()
}

/// What we want of a property.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Role {
    /// Kept as it is.
    Column,
    Position(usize),
    Texture(usize),
    Face,
    Strips,
    FaceTexture,
    Source,
}

impl Role {
    fn of(element: &str, property: &str, shape: Shape) -> Self {
        match (element, property, shape) {
            ("vertex", "x", Shape::One(_)) => Self::Position(0),
            ("vertex", "y", Shape::One(_)) => Self::Position(1),
            ("vertex", "z", Shape::One(_)) => Self::Position(2),
            ("vertex", "s" | "u" | "texture_u", Shape::One(_)) => Self::Texture(0),
            ("vertex", "t" | "v" | "texture_v", Shape::One(_)) => Self::Texture(1),
            ("face", "vertex_indices" | "vertex_index", Shape::List { .. }) => Self::Face,
            ("tristrips", "vertex_indices" | "vertex_index", Shape::List { .. }) => Self::Strips,
            ("face", "texcoord", Shape::List { .. }) => Self::FaceTexture,
            ("vertex", SOURCE, Shape::One(_)) => Self::Source,
            _ => Self::Column,
        }
    }

    /// The roles of an element's properties. Half a texture coordinate is none.
    fn of_all(element: &Element) -> Vec<Self> {
        let of = |property: &header::Property| Self::of(&element.name, &property.name, property.shape);
        let mut roles: Vec<Self> = element.properties.iter().map(of).collect();
        if !(roles.contains(&Self::Texture(0)) && roles.contains(&Self::Texture(1))) {
            let halves = roles.iter_mut().filter(|role| matches!(role, Self::Texture(_)));
            halves.for_each(|role| *role = Self::Column);
        }
        roles
    }
}

/// A model under construction.
#[derive(Default)]
struct Draft {
    /// How many vertices the header promises.
    vertices: u64,
    points: Vec<[f64; 3]>,
    polygons: Polygons,
    vertex_uv: Vec<[f64; 2]>,
    corner_uv: Vec<[f64; 2]>,
    /// Of which vertex each is a copy, if the file says so.
    sources: Vec<f64>,
    attributes: Attributes,
    /// What follows the last element.
    surplus: usize,
}

impl Draft {
    fn take_all(&mut self, header: &Header, values: &mut impl Values) -> Result<(), Fault> {
        for element in &header.elements {
            // Elements without properties take no room, however many are claimed.
            if !element.properties.is_empty() {
                self.take(element, values)?;
            }
        }
        self.surplus = values.surplus();
        Ok(())
    }

    fn take(&mut self, element: &Element, values: &mut impl Values) -> Result<(), Fault> {
        let roles = Role::of_all(element);
        element.check(&roles)?;
        let mut columns = Columns::new(element, &roles);
        let mut list = Vec::new();
        // Faces that are nothing but triangles come many at a time.
        let lists = match (&element.properties[..], &roles[..]) {
            (&[header::Property { shape: Shape::List { count, item }, .. }], [Role::Face]) => Some([count, item]),
            _ => None,
        };
        let mut present = 0;
        while present < element.count {
            if let Some(lists) = lists {
                let Self { polygons, vertices, .. } = self;
                present +=
                    values.triangles(lists, *vertices, element.count - present, |corners| polygons.push(&corners));
                if present == element.count {
                    break;
                }
            }
            if values.at_end() {
                let what = format!("element{} `{}`", if element.count == 1 { "" } else { "s" }, element.name);
                return Err(Fault::new(values.place(), Problem::CutShort { what, claimed: element.count, present }));
            }
            values.start_row();
            self.take_row((element, &roles), values, &mut columns, &mut list)?;
            present += 1;
        }
        self.keep(element, columns);
        Ok(())
    }

    fn take_row(
        &mut self,
        (element, roles): (&Element, &[Role]),
        values: &mut impl Values,
        columns: &mut Columns,
        list: &mut Vec<f64>,
    ) -> Result<(), Fault> {
        if roles.contains(&Role::FaceTexture) {
            // Triangles of strips have none, and may come first.
            self.corner_uv.resize(self.polygons.corners.len(), [f64::NAN; 2]);
        }
        let mut row = Row { first_uv: self.corner_uv.len(), ..Row::default() };
        for (k, (property, &role)) in element.properties.iter().zip(roles).enumerate() {
            match property.shape {
                Shape::One(scalar) => {
                    let value = values.scalar(scalar, &property.name)?;
                    columns.push(k, &[value]);
                    row.take(role, value, values)?;
                }
                Shape::List { count, item } => {
                    values.list(count, item, &property.name, list)?;
                    columns.push(k, list);
                    self.take_list(role, list, values)?;
                }
            }
        }
        self.end_row(roles, &row);
        Ok(())
    }

    /// Keeps what an element says besides.
    fn keep(&mut self, element: &Element, columns: Columns) {
        match element.name.as_str() {
            "vertex" => self.attributes.tables.extend(tables(columns, AttributeDomain::Vertices)),
            "face" => self.attributes.tables.extend(tables(columns, AttributeDomain::Faces)),
            "tristrips" => {}
            _ => self.attributes.listings.push(columns.listing(&element.name, element.count as usize)),
        }
    }

    fn take_list(&mut self, role: Role, list: &[f64], values: &impl Values) -> Result<(), Fault> {
        match role {
            Role::Face => self.face(list, values),
            Role::Strips => self.strips(list, values),
            Role::FaceTexture => {
                self.corner_uv.extend(list.as_chunks::<2>().0);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn end_row(&mut self, roles: &[Role], row: &Row) {
        let has = |role| roles.contains(&role);
        if has(Role::Position(0)) {
            self.points.push(row.position);
        }
        if has(Role::Texture(0)) && has(Role::Texture(1)) {
            self.vertex_uv.push(row.texture);
        }
        if has(Role::Source) {
            self.sources.push(row.source);
        }
        let corners = self.polygons.corners.len();
        if has(Role::FaceTexture) && self.corner_uv.len() != corners {
            // A face without texture has an empty list.
            self.corner_uv.truncate(row.first_uv);
            self.corner_uv.resize(corners, [f64::NAN; 2]);
        }
    }

    fn face(&mut self, list: &[f64], values: &impl Values) -> Result<(), Fault> {
        if list.len() < 3 {
            return Err(Fault::few_corners(values.place(), list.len()));
        }
        for &index in list {
            let vertex = self.vertex(index, values)?;
            self.polygons.corners.push(vertex);
        }
        self.polygons.end_face();
        Ok(())
    }

    fn strips(&mut self, list: &[f64], values: &impl Values) -> Result<(), Fault> {
        for strip in list.split(|&index| index == -1.0) {
            for (i, corners) in strip.windows(3).enumerate() {
                let mut triangle = [0; 3];
                for (vertex, &index) in triangle.iter_mut().zip(corners) {
                    *vertex = self.vertex(index, values)?;
                }
                let [a, b, c] = triangle;
                if a != b && b != c && c != a {
                    self.polygons.push(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
        }
        Ok(())
    }

    fn vertex(&self, index: f64, values: &impl Values) -> Result<u32, Fault> {
        if index >= 0.0 && index < self.vertices as f64 && index.fract() == 0.0 {
            // Larger indices than u32 holds belong to files that `Model` refuses for their number of points.
            return Ok(index as u32);
        }
        let expected = match self.vertices {
            0 => "vertices for it".to_owned(),
            n => format!("a vertex from 0 to {}", n - 1),
        };
        Err(Fault::unexpected(values.place(), format!("vertex {index}"), expected))
    }

    fn finish(self) -> Result<Model, Fault> {
        let uv = if !self.corner_uv.is_empty() {
            let corners = (0..self.polygons.corners.len() as u32).collect();
            Some(TextureCoordinates::new(self.corner_uv, corners))
        } else if !self.vertex_uv.is_empty() {
            Some(TextureCoordinates::new(self.vertex_uv, self.polygons.corners.clone()))
        } else {
            None
        };
        let skipped = Skipped { surplus: self.surplus, ..Skipped::default() };
        let Self { mut points, mut polygons, mut attributes, sources, .. } = self;
        if let Some(joined) = Joined::of_sources(&sources, &points) {
            attributes.tables = joined.tables(attributes.tables, &polygons.corners);
            joined.apply(&mut points, &mut polygons.corners);
        }
        Ok(Model::new(points, polygons)?.with_uv(uv).with_skipped(skipped).with_attributes(attributes))
    }
}

/// What the single numbers of an element say.
#[derive(Default)]
struct Row {
    position: [f64; 3],
    texture: [f64; 2],
    source: f64,
    /// How many corners had texture coordinates before.
    first_uv: usize,
}

impl Row {
    fn take(&mut self, role: Role, value: f64, values: &impl Values) -> Result<(), Fault> {
        match role {
            Role::Position(_) if !is_coordinate(value) => {
                let found = format!("the coordinate {value:e}");
                return Err(Fault::unexpected(values.place(), found, format!("at most {MAX_COORDINATE:e}")));
            }
            Role::Position(axis) => self.position[axis] = value,
            Role::Texture(axis) => self.texture[axis] = value,
            Role::Source => self.source = value,
            _ => {}
        }
        Ok(())
    }
}

impl Element {
    /// Vertices need all coordinates, faces their indices.
    fn check(&self, roles: &[Role]) -> Result<(), Fault> {
        let missing = match self.name.as_str() {
            "vertex" => {
                ["x", "y", "z"].into_iter().enumerate().find(|&(axis, _)| !roles.contains(&Role::Position(axis)))
            }
            "face" if !roles.contains(&Role::Face) => Some((0, "vertex_indices")),
            "tristrips" if !roles.contains(&Role::Strips) => Some((0, "vertex_indices")),
            _ => None,
        };
        match missing {
            Some((_, property)) => Err(Fault::unexpected(
                Place::Line(self.line),
                format!("element `{}` without a property `{property}`", self.name),
                "one",
            )),
            None => Ok(()),
        }
    }
}
