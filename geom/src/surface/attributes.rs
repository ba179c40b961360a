//! [`Attributes`]: what a file says of vertices, corners and faces besides where they are.
//!
//! An [`Attribute`] is a table of numbers in the file's own type, a row for each vertex, face or, by an index, corner: normals,
//! colours, and whatever else a file has under a name of its own. They go with a [`Model`](crate::Model) from its reader to
//! the writers and are never computed with. Readers make them, or whoever has numbers of their own ([`Attribute::of_vertices`]). Where a surface is cut finer they are interpolated ([`refine_attributes`](crate::refine_attributes)).

use thiserror::Error;

use crate::counted::counted;

/// The type of a number in a file. All of them fit in f64 exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ScalarType {
    /// Eight bits with a sign.
    I8,
    /// Eight bits.
    U8,
    /// Sixteen bits with a sign.
    I16,
    /// Sixteen bits.
    U16,
    /// Thirty-two bits with a sign.
    I32,
    /// Thirty-two bits.
    U32,
    /// A float of thirty-two bits.
    F32,
    /// A float of sixty-four bits.
    F64,
}

impl ScalarType {
    /// How many bytes it takes.
    pub const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// What stands for 1 where a number means a share, as in a colour: the largest integer, or 1.
    pub fn one(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::I32 => f64::from(i32::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 | Self::F64 => 1.0,
        }
    }

    /// Whether it is a float.
    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The number that begins these bytes, little end first; 0 where there are too few.
    pub(crate) fn decode(self, bytes: &[u8]) -> f64 {
        fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
            bytes.first_chunk().copied().unwrap_or([0; N])
        }
        match self {
            Self::I8 => i8::from_le_bytes(first(bytes)).into(),
            Self::U8 => u8::from_le_bytes(first(bytes)).into(),
            Self::I16 => i16::from_le_bytes(first(bytes)).into(),
            Self::U16 => u16::from_le_bytes(first(bytes)).into(),
            Self::I32 => i32::from_le_bytes(first(bytes)).into(),
            Self::U32 => u32::from_le_bytes(first(bytes)).into(),
            Self::F32 => f32::from_le_bytes(first(bytes)).into(),
            Self::F64 => f64::from_le_bytes(first(bytes)),
        }
    }

    /// Appends a number, rounded and bounded where the type is an integer's.
    pub(crate) fn encode(self, x: f64, out: &mut Vec<u8>) {
        match self {
            Self::I8 => out.extend((x.round() as i8).to_le_bytes()),
            Self::U8 => out.extend((x.round() as u8).to_le_bytes()),
            Self::I16 => out.extend((x.round() as i16).to_le_bytes()),
            Self::U16 => out.extend((x.round() as u16).to_le_bytes()),
            Self::I32 => out.extend((x.round() as i32).to_le_bytes()),
            Self::U32 => out.extend((x.round() as u32).to_le_bytes()),
            Self::F32 => out.extend((x as f32).to_le_bytes()),
            Self::F64 => out.extend(x.to_le_bytes()),
        }
    }
}

/// What an attribute's numbers are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Meaning {
    /// Directions, x y z.
    Normal,
    /// Red, green, blue and perhaps alpha, shares of [`ScalarType::one`].
    Colour,
    /// What the file calls so.
    Other(String),
}

impl std::fmt::Display for Meaning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Normal => f.write_str("normals"),
            Self::Colour => f.write_str("colours"),
            Self::Other(name) => f.write_str(name),
        }
    }
}

impl Meaning {
    /// Whether rows of so many numbers can be it.
    fn takes(&self, width: usize) -> bool {
        match self {
            Self::Normal => width == 3,
            Self::Colour => width == 3 || width == 4,
            Self::Other(_) => width > 0,
        }
    }
}

/// What an attribute has a row for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributeDomain {
    /// Each vertex.
    Vertices,
    /// Each corner, which names its row.
    Corners,
    /// Each face.
    Faces,
}

impl std::fmt::Display for AttributeDomain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Vertices => "vertices",
            Self::Corners => "corners of faces",
            Self::Faces => "faces",
        })
    }
}

/// Why numbers make no [`Attribute`], or none of a model's.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum AttributeError {
    /// Normals are rows of three numbers, colours of three or four, others of one at least.
    #[error("{meaning} cannot be rows of {}: normals have 3, colours 3 or 4, others at least 1", counted(*width, "number", "numbers"))]
    Width {
        /// What they were to be.
        meaning: Meaning,
        /// How many numbers a row has.
        width: usize,
    },
    /// A number is infinite or NaN.
    #[error("row {row} of {meaning} (counted from 0) has a number that is not finite")]
    NotFinite {
        /// What they were to be.
        meaning: Meaning,
        /// The row.
        row: usize,
    },
    /// A model has another number of vertices, corners or faces.
    #[error("{meaning} have a row for each of the model's {domain}: {found} where {needed} should be")]
    Count {
        /// What they are.
        meaning: Meaning,
        /// What they are of.
        domain: AttributeDomain,
        /// How many of these they are for.
        found: usize,
        /// How many of these there are.
        needed: usize,
    },
}

/// A table of numbers; see the module's head.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribute {
    meaning: Meaning,
    domain: AttributeDomain,
    scalar: ScalarType,
    /// How many numbers a row has, if all have as many.
    width: Option<usize>,
    /// Where rows begin, and at the end where the last ends, where they differ in length.
    start: Vec<u32>,
    /// The numbers, little end first.
    bytes: Vec<u8>,
    /// The row of each corner.
    index: Vec<u32>,
}

impl Attribute {
    /// Stands for a corner without a row.
    pub(crate) const NONE: u32 = u32::MAX;

    /// A table of rows of `width` numbers, without rows yet.
    pub(crate) fn new(meaning: Meaning, domain: AttributeDomain, scalar: ScalarType, width: usize) -> Self {
        let (start, bytes, index) = (Vec::new(), Vec::new(), Vec::new());
        Self { meaning, domain, scalar, width: Some(width.max(1)), start, bytes, index }
    }

    /// A table of vertices, a row each in the order of the model's. `scalar` is the type that files get: numbers are rounded to it, and a share of
    /// a colour is one of [`ScalarType::one`]. [`Model::with_attribute`](crate::Model::with_attribute) puts it on a model.
    ///
    /// ```
    /// # #[cfg(feature = "files")] {
    /// use geom::io::{read_bytes, write_ply};
    /// use geom::{Attribute, Meaning, Model, ScalarType};
    ///
    /// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let colours = [[255.0, 0.0, 0.0], [0.0, 255.0, 0.0], [0.0, 0.0, 255.0]];
    /// let colours = Attribute::of_vertices(Meaning::Colour, ScalarType::U8, &colours)?;
    /// let model = Model::from_triangles(points, &[[0, 1, 2]])?.with_attribute(colours)?;
    /// let mut file = Vec::new();
    /// write_ply(&model, None, None, &mut file)?;
    /// let back = read_bytes(file, "triangle.ply")?;
    /// let colours = back.attributes().table(&Meaning::Colour).expect("they were written");
    /// assert_eq!(colours.row(1).collect::<Vec<_>>(), [0.0, 255.0, 0.0]);
    /// # }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If rows are not as long as their meaning asks, or a number is not finite.
    pub fn of_vertices<const WIDTH: usize>(
        meaning: Meaning,
        scalar: ScalarType,
        rows: &[[f64; WIDTH]],
    ) -> Result<Self, AttributeError> {
        Self::of_rows(meaning, AttributeDomain::Vertices, scalar, rows)
    }

    /// A table of faces, a row each in the order of the model's; otherwise as [`Attribute::of_vertices`].
    ///
    /// # Errors
    /// As [`Attribute::of_vertices`].
    pub fn of_faces<const WIDTH: usize>(
        meaning: Meaning,
        scalar: ScalarType,
        rows: &[[f64; WIDTH]],
    ) -> Result<Self, AttributeError> {
        Self::of_rows(meaning, AttributeDomain::Faces, scalar, rows)
    }

    /// A table of corners, of which each names its row: what is no row is none. Otherwise as [`Attribute::of_vertices`].
    ///
    /// # Errors
    /// As [`Attribute::of_vertices`].
    pub fn of_corners<const WIDTH: usize>(
        meaning: Meaning,
        scalar: ScalarType,
        rows: &[[f64; WIDTH]],
        row_of_corner: Vec<u32>,
    ) -> Result<Self, AttributeError> {
        Self::of_rows(meaning, AttributeDomain::Corners, scalar, rows).map(|table| table.at_corners(row_of_corner))
    }

    fn of_rows<const WIDTH: usize>(
        meaning: Meaning,
        domain: AttributeDomain,
        scalar: ScalarType,
        rows: &[[f64; WIDTH]],
    ) -> Result<Self, AttributeError> {
        // As it is kept.
        let is_finite = |&x: &f64| if scalar == ScalarType::F32 { (x as f32).is_finite() } else { x.is_finite() };
        if !meaning.takes(WIDTH) {
            return Err(AttributeError::Width { meaning, width: WIDTH });
        }
        if let Some(row) = rows.iter().position(|row| !row.iter().all(is_finite)) {
            return Err(AttributeError::NotFinite { meaning, row });
        }
        let mut table = Self::new(meaning, domain, scalar, WIDTH);
        rows.as_flattened().iter().for_each(|&x| table.push(x));
        Ok(table)
    }

    /// What its numbers are.
    pub fn meaning(&self) -> &Meaning {
        &self.meaning
    }

    /// What it has a row for.
    pub fn domain(&self) -> AttributeDomain {
        self.domain
    }

    /// The type that its numbers had in the file.
    pub fn scalar(&self) -> ScalarType {
        self.scalar
    }

    /// How many numbers a row has; none where rows are lists of any length.
    pub fn width(&self) -> Option<usize> {
        self.width
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        let numbers = self.bytes.len() / self.scalar.size();
        self.width.map_or(self.start.len().saturating_sub(1), |width| numbers / width)
    }

    /// The numbers of a row; none where there is no such row.
    pub fn row(&self, row: usize) -> impl ExactSizeIterator<Item = f64> + use<'_> {
        let size = self.scalar.size();
        let bytes = self.row_bytes(row);
        bytes.chunks_exact(size).map(|bytes| self.scalar.decode(bytes))
    }

    /// How many vertices, corners or faces it is for.
    fn count(&self) -> usize {
        if self.domain == AttributeDomain::Corners { self.index.len() } else { self.rows() }
    }

    /// Whether it fits a model of so many vertices, faces and corners.
    ///
    /// # Errors
    /// If it does not.
    pub(super) fn check(&self, [vertices, faces, corners]: [usize; 3]) -> Result<(), AttributeError> {
        let needed = match self.domain {
            AttributeDomain::Vertices => vertices,
            AttributeDomain::Faces => faces,
            AttributeDomain::Corners => corners,
        };
        let (meaning, domain, found) = (self.meaning.clone(), self.domain, self.count());
        if found == needed { Ok(()) } else { Err(AttributeError::Count { meaning, domain, found, needed }) }
    }

    /// The bytes of a row.
    pub(crate) fn row_bytes(&self, row: usize) -> &[u8] {
        let size = self.scalar.size();
        let ends = match self.width {
            Some(width) => [row * width * size, (row + 1) * width * size],
            None => [row, row + 1].map(|i| self.start.get(i).map_or(0, |&start| start as usize * size)),
        };
        self.bytes.get(ends[0]..ends[1]).unwrap_or(&[])
    }

    /// The row of a corner: that of its vertex, which `corners` tells as [`Model::corners`](crate::Model::corners), its own, or none
    /// for what faces have.
    pub fn row_at(&self, corners: &[u32], corner: usize) -> Option<usize> {
        let row = match self.domain {
            AttributeDomain::Vertices => *corners.get(corner)?,
            AttributeDomain::Corners => *self.index.get(corner)?,
            AttributeDomain::Faces => return None,
        };
        ((row as usize) < self.rows()).then_some(row as usize)
    }

    /// The same table for corners, of which each names its row.
    pub(crate) fn at_corners(self, index: Vec<u32>) -> Self {
        Self { domain: AttributeDomain::Corners, index, ..self }
    }

    /// Appends a number of a row.
    pub(crate) fn push(&mut self, x: f64) {
        self.scalar.encode(x, &mut self.bytes);
    }

    /// Appends the rows of a table of the same kind, whose rows have as many numbers.
    #[cfg(feature = "files")]
    pub(crate) fn append(&mut self, rows: &Self) {
        debug_assert!((self.width, self.scalar) == (rows.width, rows.scalar) && self.width.is_some());
        self.bytes.extend_from_slice(&rows.bytes);
    }

    /// Ends a row of a table of lists.
    pub(crate) fn end_row(&mut self) {
        if self.width.is_none() {
            // What has more than 2³² numbers wraps here and is left out, as rows then do not fit.
            self.start.push((self.bytes.len() / self.scalar.size()) as u32);
        }
    }

    /// The table of some of its rows.
    pub(crate) fn picked(&self, rows: impl Iterator<Item = usize>) -> Self {
        let mut table = Self { bytes: Vec::new(), index: Vec::new(), start: Vec::new(), ..self.clone() };
        if self.width.is_none() {
            table.start.push(0);
        }
        for row in rows {
            table.bytes.extend_from_slice(self.row_bytes(row));
            table.end_row();
        }
        table
    }

    /// Appends a row that is made of others with weights; a list is taken from the heaviest.
    pub(super) fn mix(&mut self, of: &Self, parts: &[(usize, f64)]) {
        let heaviest = parts.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |part| part.0);
        let Some(width) = self.width else {
            self.bytes.extend_from_slice(of.row_bytes(heaviest));
            self.end_row();
            return;
        };
        // Numbers of a kind that is counted are not mixed: a label of 1.5 is none.
        let is_label = !of.scalar.is_float() && of.meaning != Meaning::Colour;
        let mut mixed = vec![0.0; width];
        if is_label {
            mixed.iter_mut().zip(of.row(heaviest)).for_each(|(x, value)| *x = value);
        } else {
            for &(row, weight) in parts {
                mixed.iter_mut().zip(of.row(row)).for_each(|(x, value)| *x += weight * value);
            }
        }
        if self.meaning == Meaning::Normal {
            let length = mixed.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > 0.0 {
                mixed.iter_mut().for_each(|x| *x /= length);
            }
        }
        mixed.into_iter().for_each(|x| self.push(x));
    }
}

#[cfg(feature = "files")]
impl Attribute {
    /// A table of rows of any lengths, without rows yet.
    pub(crate) fn lists(meaning: Meaning, domain: AttributeDomain, scalar: ScalarType) -> Self {
        Self { width: None, start: vec![0], ..Self::new(meaning, domain, scalar, 1) }
    }

    /// The same table for vertices or faces.
    pub(crate) fn of_domain(self, domain: AttributeDomain) -> Self {
        Self { domain, ..self }
    }

    /// The columns of one number side by side as rows of one table, if each has as many rows.
    pub(crate) fn side_by_side(columns: &[&Self], meaning: Meaning) -> Option<Self> {
        let first = columns.first()?;
        let is_alike = |c: &&&Self| c.width == Some(1) && c.rows() == first.rows();
        if columns.iter().filter(is_alike).count() != columns.len() {
            return None;
        }
        let same = columns.iter().all(|column| column.scalar == first.scalar);
        let scalar = if same { first.scalar } else { ScalarType::F64 };
        let mut table = Self::new(meaning, first.domain, scalar, columns.len());
        for row in 0..first.rows() {
            for column in columns {
                let x = column.row(row).next().unwrap_or(0.0);
                // Shares keep their meaning where the types of columns differ.
                let unit = if same || table.meaning != Meaning::Colour { 1.0 } else { column.scalar.one() };
                table.push(x / unit);
            }
        }
        Some(table)
    }

    /// The table of vertices that were joined: `joined` says for each old vertex which it became, `corners` which old one each
    /// corner had. It stays one of vertices where joined ones agree, and becomes one of corners where not.
    pub(crate) fn joined(self, joined: &[u32], count: usize, corners: &[u32]) -> Self {
        let mut first = vec![Self::NONE; count];
        let mut agree = true;
        for (old, &new) in joined.iter().enumerate() {
            let row = &mut first[new as usize];
            if *row == Self::NONE {
                *row = old as u32;
            } else {
                agree &= self.row_bytes(*row as usize) == self.row_bytes(old);
            }
        }
        if agree { self.picked(first.iter().map(|&row| row as usize)) } else { self.at_corners(corners.to_vec()) }
    }
}

/// What else a file lists than vertices and faces, by columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Listing {
    /// Its name.
    pub name: String,
    /// How many rows it has.
    pub count: usize,
    /// Its columns.
    pub columns: Vec<Attribute>,
}

/// A node of a scene, as a glTF has them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneNode {
    /// Its name; empty where it has none.
    pub name: String,
    /// The name of its mesh; empty where it has none.
    pub mesh: String,
    /// The node that it hangs on, one of those before it.
    pub parent: Option<u32>,
    /// Where it is there.
    pub place: NodePlace,
}

/// Where a node is, as its file says it.
#[derive(Debug, Clone, PartialEq)]
pub enum NodePlace {
    /// A matrix of four rows, column by column.
    Matrix(Box<[f64; 16]>),
    /// First scaled, then rotated by a quaternion x y z w, then moved, each if it is there.
    Parts {
        /// Along each axis.
        translation: Option<[f64; 3]>,
        /// A quaternion of length 1.
        rotation: Option<[f64; 4]>,
        /// Along each axis.
        scale: Option<[f64; 3]>,
    },
}

impl Default for NodePlace {
    /// Where its parent is.
    fn default() -> Self {
        Self::Parts { translation: None, rotation: None, scale: None }
    }
}

/// A picture of a glTF as the base colour of a material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BaseColourPicture {
    /// Its number among the glTF's images.
    pub image: usize,
    /// What it is called there.
    pub name: String,
    /// Whether it is placed by other coordinates than the first ones, or by a transformation of them.
    pub is_moved: bool,
}

/// All that a file says besides points, faces and texture coordinates; see the module's head.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Attributes {
    /// Normals, colours and others, each with a row for all that its domain counts.
    pub tables: Vec<Attribute>,
    /// The names of materials.
    pub materials: Vec<String>,
    /// What a glTF says of their looks, in its JSON and without textures; empty where it says nothing, or another format was read.
    pub looks: Vec<String>,
    /// The picture that a glTF has for each material's base colour, if any has one.
    pub pictures: Vec<Option<BaseColourPicture>>,
    /// What a glTF says of where its images are, of those in other files: relative URIs.
    pub images: Vec<String>,
    /// What else a glTF's materials have textures for, in its words, such as `normalTexture`.
    pub other_maps: Vec<String>,
    /// The material of each face, an index into `materials`, if any has one; what is out of range is none.
    pub face_material: Vec<u32>,
    /// The nodes of a glTF's scene, each after the one that it hangs on. Points are where these have put them.
    pub nodes: Vec<SceneNode>,
    /// The node of each face, an index into `nodes`, if any has one; what is out of range is none.
    pub face_node: Vec<u32>,
    /// The material libraries that an OBJ names.
    pub libraries: Vec<String>,
    /// Comments, of a PLY, each with its keyword.
    pub comments: Vec<String>,
    /// Other elements of a PLY, such as its edges.
    pub listings: Vec<Listing>,
    /// What the reader has seen and does not keep, in words.
    pub left: Vec<String>,
}

impl Attributes {
    /// The first table of a meaning, of vertices or corners.
    pub fn table(&self, meaning: &Meaning) -> Option<&Attribute> {
        self.tables.iter().find(|table| table.meaning == *meaning && table.domain != AttributeDomain::Faces)
    }

    /// Whether nothing is said of vertices, corners and faces.
    pub fn is_bare(&self) -> bool {
        self.tables.is_empty() && self.face_material.is_empty() && self.face_node.is_empty()
    }

    /// The name of a face's material.
    pub fn material(&self, face: usize) -> Option<&str> {
        self.materials.get(*self.face_material.get(face)? as usize).map(String::as_str)
    }

    /// What is known of the look of a face's material, in glTF's JSON.
    pub fn look(&self, face: usize) -> Option<&str> {
        let look = self.looks.get(*self.face_material.get(face)? as usize)?;
        (!look.is_empty()).then_some(look)
    }

    /// The node of a face, an index into [`nodes`](Self::nodes).
    pub fn node(&self, face: usize) -> Option<u32> {
        self.face_node.get(face).copied().filter(|&node| (node as usize) < self.nodes.len())
    }

    /// Adds a table that was checked, in place of those with its meaning.
    pub(super) fn put(&mut self, table: Attribute) {
        let is_of_faces = |table: &Attribute| table.domain == AttributeDomain::Faces;
        self.tables.retain(|old| old.meaning != table.meaning || is_of_faces(old) != is_of_faces(&table));
        self.tables.push(table);
    }

    /// Leaves out tables whose rows are not as many as they should be.
    pub(super) fn fitting(mut self, vertices: usize, faces: usize, corners: usize) -> Self {
        self.tables.retain(|table| table.check([vertices, faces, corners]).is_ok());
        if self.face_material.len() != faces {
            self.face_material.clear();
        }
        if self.face_node.len() != faces {
            self.face_node.clear();
        }
        self
    }
}

#[cfg(all(test, feature = "files"))]
mod tests {
    use super::*;

    fn table(meaning: Meaning, domain: AttributeDomain, scalar: ScalarType, width: usize, values: &[f64]) -> Attribute {
        let mut table = Attribute::new(meaning, domain, scalar, width);
        values.iter().for_each(|&x| table.push(x));
        table
    }

    #[test]
    fn every_type_gives_its_numbers_back_and_bounds_what_does_not_fit() {
        use ScalarType::{F32, F64, I8, I16, I32, U8, U16, U32};
        for scalar in [I8, U8, I16, U16, I32, U32, F32, F64] {
            let mut bytes = Vec::new();
            [scalar.one(), 0.0, 1.0].into_iter().for_each(|x| scalar.encode(x, &mut bytes));
            assert_eq!(bytes.len(), 3 * scalar.size());
            assert_eq!((scalar.decode(&bytes), scalar.decode(&bytes[2 * scalar.size()..])), (scalar.one(), 1.0));
        }
        let mut bytes = Vec::new();
        [-3.0, 0.4, 254.6, 1e9].into_iter().for_each(|x| U8.encode(x, &mut bytes));
        assert_eq!(bytes, [0, 0, 255, 255]);
    }

    #[test]
    fn joined_vertices_that_differ_keep_their_numbers_at_corners() {
        let same = table(Meaning::Colour, AttributeDomain::Vertices, ScalarType::U8, 1, &[1.0, 2.0, 3.0, 1.0]);
        let joined = [0, 1, 2, 0];
        assert_eq!(same.clone().joined(&joined, 3, &[0, 1, 2]).rows(), 3);
        let other = table(Meaning::Colour, AttributeDomain::Vertices, ScalarType::U8, 1, &[1.0, 2.0, 3.0, 9.0]);
        let apart = other.joined(&joined, 3, &[3, 1, 2]);
        assert_eq!((apart.domain(), apart.rows()), (AttributeDomain::Corners, 4));
    }
}
