//! [`Model`]: points and polygons as a file had them, before anything is mended.
//!
//! Faces lie one after the other in one array of *corners* (compressed rows): the corners of face `f` are
//! `face_start[f] .. face_start[f + 1]`, each the index of a vertex. Texture coordinates belong to corners, not to vertices,
//! because a seam gives one vertex several of them.
//!
//! A `Model` promises little, but that always: at least one vertex and one face, faces of three corners or more, indices in
//! range, and coordinates whose squared distances do not overflow. Faces may be flipped, doubled, degenerate or
//! non-manifold and vertices isolated or coincident; that is for the stage that prepares surfaces.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use super::attributes::{Attribute, AttributeError, Attributes};
use crate::counted::{are, counted};

/// The largest absolute coordinate that a [`Model`] takes: three squared differences still add up to a finite number.
pub const MAX_COORDINATE: f64 = 1e153;

/// A model may have so many corners for each of its vertices, and [`FREE_CORNERS`] besides. Surfaces have about six, and
/// ones that cross themselves everywhere not ten times as many; what has more is a few bytes repeated, whose triangles would
/// fill the memory.
const MOST_CORNERS_PER_VERTEX: usize = 100;
/// So many corners are harmless however few vertices they have.
const FREE_CORNERS: usize = 1 << 20;

/// Why points and polygons do not make a [`Model`]. Vertices, faces and corners are counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The list of points is empty.
    #[error("there are no vertices")]
    NoVertices,
    /// The list of faces is empty.
    #[error("there {} but no faces, and a surface is needed", are(*vertices, "vertex", "vertices"))]
    NoFaces {
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is not finite or too large.
    #[error("vertex {vertex} has the coordinate {value:e}, which must be finite and at most {MAX_COORDINATE:e} from 0")]
    Coordinate {
        /// The vertex.
        vertex: usize,
        /// Its coordinate.
        value: f64,
    },
    /// A corner names a vertex that does not exist.
    #[error("face {face} uses vertex {index}, but there {} only (counted from 0)", are(*vertices, "vertex", "vertices"))]
    Index {
        /// The face.
        face: usize,
        /// The vertex it asks for.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A face has fewer than three corners.
    #[error("face {face} has {}, but a face needs at least 3", counted(*corners, "corner", "corners"))]
    FewCorners {
        /// The face.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// The same vertices over and over.
    #[error(
        "there are {corners} corners of faces, {largest} of them at face {face}, but only {}: a surface has \
         at most {MOST_CORNERS_PER_VERTEX} for each",
        counted(*vertices, "vertex", "vertices")
    )]
    ManyCorners {
        /// How many corners there are.
        corners: usize,
        /// How many vertices there are.
        vertices: usize,
        /// The face with the most corners.
        face: usize,
        /// How many it has.
        largest: usize,
    },
    /// Texture coordinates are one for each corner.
    #[error("there {} for {corners} corners of faces", are(*found, "texture coordinate", "texture coordinates"))]
    TextureCount {
        /// How many texture coordinates there are.
        found: usize,
        /// How many corners there are.
        corners: usize,
    },
    /// Indices are 32 bits wide.
    #[error("there are {count} {what}, more than 32-bit indices can count")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
}

/// Points and polygons as a file had them; see the module's head.
#[derive(Debug, Clone)]
pub struct Model {
    points: Vec<[f64; 3]>,
    face_start: Vec<u32>,
    corners: Vec<u32>,
    uv: Option<TextureCoordinates>,
    skipped: Skipped,
    obj_text: Option<Vec<u8>>,
    /// Whether the text has other texture coordinates than `uv`, which were given later.
    text_has_other_uv: bool,
    attributes: Arc<Attributes>,
}

impl Model {
    /// A model made of triangles.
    ///
    /// ```
    /// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let model = geom::Model::from_triangles(points, &[[0, 1, 2]])?;
    /// assert_eq!(model.face(0), [0, 1, 2]);
    /// # Ok::<(), geom::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// What a model must not have: no faces, indices out of range, coordinates not finite or beyond [`MAX_COORDINATE`].
    pub fn from_triangles(points: Vec<[f64; 3]>, triangles: &[[u32; 3]]) -> Result<Self, ModelError> {
        Self::from_polygons(points, triangles)
    }

    /// A model made of polygons, each a list of vertices in order around it.
    ///
    /// # Errors
    /// As [`Model::from_triangles`], and faces with fewer than three corners.
    pub fn from_polygons<F: AsRef<[u32]>>(
        points: Vec<[f64; 3]>,
        faces: impl IntoIterator<Item = F>,
    ) -> Result<Self, ModelError> {
        let mut polygons = Polygons::default();
        for face in faces {
            polygons.push(face.as_ref());
        }
        Self::new(points, polygons)
    }

    /// A model of polygons that are already in rows.
    pub(crate) fn new(mut points: Vec<[f64; 3]>, mut polygons: Polygons) -> Result<Self, ModelError> {
        let face_start = polygons.checked_starts()?;
        points.shrink_to_fit();
        polygons.corners.shrink_to_fit();
        let model = Self {
            points,
            face_start,
            corners: polygons.corners,
            uv: None,
            skipped: Skipped::default(),
            obj_text: None,
            text_has_other_uv: false,
            attributes: Arc::default(),
        };
        model.check().map(|()| model)
    }

    fn check(&self) -> Result<(), ModelError> {
        let vertices = self.points.len();
        if vertices == 0 {
            return Err(ModelError::NoVertices);
        }
        if u32::try_from(vertices).is_err() {
            return Err(ModelError::TooMany { what: "vertices", count: vertices });
        }
        if self.face_count() == 0 {
            return Err(ModelError::NoFaces { vertices });
        }
        let corners = self.corners.len();
        if corners > FREE_CORNERS + MOST_CORNERS_PER_VERTEX * vertices {
            let size = |face: usize| self.face_corners(face).len();
            let face = (0..self.face_count()).rev().max_by_key(|&face| size(face)).expect("there is a face");
            return Err(ModelError::ManyCorners { corners, vertices, face, largest: size(face) });
        }
        for (vertex, point) in self.points.iter().enumerate() {
            if let Some(&value) = point.iter().find(|&&x| !is_coordinate(x)) {
                return Err(ModelError::Coordinate { vertex, value });
            }
        }
        for (face, corners) in self.faces().enumerate() {
            if corners.len() < 3 {
                return Err(ModelError::FewCorners { face, corners: corners.len() });
            }
            if let Some(&index) = corners.iter().find(|&&v| v as usize >= vertices) {
                return Err(ModelError::Index { face, index, vertices });
            }
        }
        Ok(())
    }

    /// The points, in the order of the file.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// How many vertices there are, isolated ones included.
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// How many faces there are.
    pub fn face_count(&self) -> usize {
        self.face_start.len() - 1
    }

    /// How many corners all faces have together.
    pub fn corner_count(&self) -> usize {
        self.corners.len()
    }

    /// The vertices of face `face` in order around it.
    ///
    /// # Panics
    /// When there is no such face.
    pub fn face(&self, face: usize) -> &[u32] {
        &self.corners[self.face_corners(face)]
    }

    /// The corners of face `face`: indices into [`Model::corners`].
    ///
    /// # Panics
    /// When there is no such face.
    pub fn face_corners(&self, face: usize) -> std::ops::Range<usize> {
        self.face_start[face] as usize..self.face_start[face + 1] as usize
    }

    /// The faces in order, each the list of its vertices.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.face_start.windows(2).map(|ends| &self.corners[ends[0] as usize..ends[1] as usize])
    }

    /// The vertex of every corner, face after face.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Where each face's corners begin, and at the end their number.
    pub fn face_start(&self) -> &[u32] {
        &self.face_start
    }

    /// The texture coordinates that the file had, if it had any.
    pub fn uv(&self) -> Option<&TextureCoordinates> {
        self.uv.as_ref()
    }

    /// What the file said and the model does not hold.
    pub fn skipped(&self) -> &Skipped {
        &self.skipped
    }

    /// For each vertex the first one at exactly the same place: what welding makes of it. O(vertices).
    pub fn first_at_place(&self) -> Vec<u32> {
        let mut first = HashMap::with_capacity(self.points.len());
        (0..).zip(&self.points).map(|(v, point)| *first.entry(place_key(point)).or_insert(v)).collect()
    }

    /// The OBJ file that the model came from, byte for byte (after decompression), to be given back with a map added.
    pub fn obj_text(&self) -> Option<&[u8]> {
        self.obj_text.as_deref()
    }

    /// Normals, colours, materials and whatever else the file said; shared by clones.
    pub fn attributes(&self) -> &Attributes {
        &self.attributes
    }

    /// The same model with other attributes. Tables that have not as many rows as they should are left out.
    ///
    /// The text of an OBJ says what the old ones were, so that it is [no longer kept](Self::obj_text): its comments, groups and material libraries
    /// are gone from what is written.
    ///
    /// See also [`Model::with_attribute`].
    pub fn with_attributes(mut self, attributes: Attributes) -> Self {
        self.obj_text = None;
        self.attributes = Arc::new(attributes.fitting(self.vertex_count(), self.face_count(), self.corner_count()));
        self
    }
}

impl Model {
    /// The same model with one more table of numbers, in place of any of its meaning; tables of faces and others stand side by side. As of
    /// [`Model::with_attributes`], the text of an OBJ is no longer kept. An example is at [`Attribute::of_vertices`].
    ///
    /// # Errors
    /// If the table is for another number of vertices, faces or corners than there are.
    pub fn with_attribute(self, table: Attribute) -> Result<Self, AttributeError> {
        table.check([self.vertex_count(), self.face_count(), self.corner_count()])?;
        let mut attributes = self.attributes().clone();
        attributes.put(table);
        Ok(self.with_attributes(attributes))
    }
}

/// Equal for equal points; adding 0 makes -0 positive.
pub(super) fn place_key(p: &[f64; 3]) -> [u64; 3] {
    p.map(|x| (x + 0.0).to_bits())
}

impl Model {
    /// The same model with a texture coordinate for each corner, in place of those of its file. The text of an OBJ stays, and is written with the new ones.
    ///
    /// ```
    /// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    /// let model = geom::Model::from_triangles(square, &[[0, 1, 2], [0, 2, 3]])?;
    /// let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    /// let moved = [a, c, d].map(|[u, v]| [u + 2.0, v]);
    /// let model = model.with_texture([[a, b, c], moved].concat())?;
    /// assert_eq!(geom::texture_seams(&model, geom::Weld::Never), [[0, 2]]);
    /// # Ok::<(), geom::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// If there are more or fewer than corners.
    pub fn with_texture(mut self, uv: Vec<[f64; 2]>) -> Result<Self, ModelError> {
        let (found, corners) = (uv.len(), self.corners.len());
        if found != corners {
            return Err(ModelError::TextureCount { found, corners });
        }
        self.uv = Some(TextureCoordinates { points: uv, corners: (0..corners as u32).collect() });
        self.text_has_other_uv = true;
        Ok(self)
    }
}

impl Model {
    /// The same model with other texture coordinates, or none, for some of its corners or all.
    pub(super) fn with_texture_coordinates(mut self, uv: Option<TextureCoordinates>) -> Self {
        debug_assert!(uv.as_ref().is_none_or(|uv| uv.corners.len() == self.corners.len()));
        self.uv = uv;
        self.text_has_other_uv = true;
        self
    }
}

#[cfg(feature = "files")]
impl Model {
    /// The same model with what a file said besides its points and faces.
    pub(crate) fn with_uv(mut self, uv: Option<TextureCoordinates>) -> Self {
        debug_assert!(uv.as_ref().is_none_or(|uv| uv.corners.len() == self.corners.len()));
        self.uv = uv;
        self
    }

    pub(crate) fn with_skipped(mut self, skipped: Skipped) -> Self {
        self.skipped = skipped;
        self
    }

    pub(crate) fn with_obj_text(mut self, text: Vec<u8>) -> Self {
        self.obj_text = Some(text);
        self.text_has_other_uv = false;
        self
    }

    /// The texture coordinates of all corners in order, if each has one.
    pub(crate) fn whole_uv(&self) -> Option<Vec<[f64; 2]>> {
        self.uv.as_ref()?.all().ok()
    }

    /// The texture coordinates that a text of the model's own does not have.
    pub(crate) fn uv_beside_text(&self) -> Option<&TextureCoordinates> {
        self.uv.as_ref().filter(|_| self.obj_text.is_none() || self.text_has_other_uv)
    }
}

/// Whether `x` may be a coordinate of a [`Model`].
pub(crate) fn is_coordinate(x: f64) -> bool {
    x.abs() <= MAX_COORDINATE
}

/// Polygons under construction, row by row.
#[derive(Debug, Default)]
pub(crate) struct Polygons {
    face_end: Vec<u32>,
    pub(crate) corners: Vec<u32>,
}

impl Polygons {
    #[cfg(feature = "files")]
    pub(crate) fn with_capacity(faces: usize) -> Self {
        Self { face_end: Vec::with_capacity(faces), corners: Vec::with_capacity(3 * faces) }
    }

    pub(crate) fn push(&mut self, face: &[u32]) {
        self.corners.extend_from_slice(face);
        self.end_face();
    }

    /// Makes a face of the corners that were pushed since the last one.
    pub(crate) fn end_face(&mut self) {
        // Too many corners wrap here and are refused, by their number, in `checked_starts`.
        self.face_end.push(self.corners.len() as u32);
    }

    /// Appends other polygons.
    #[cfg(feature = "files")]
    pub(crate) fn append(&mut self, next: &Self) {
        let before = self.corners.len() as u32;
        self.face_end.extend(next.face_end.iter().map(|end| before.wrapping_add(*end)));
        self.corners.extend_from_slice(&next.corners);
    }

    #[cfg(feature = "files")]
    pub(crate) fn face_count(&self) -> usize {
        self.face_end.len()
    }

    fn checked_starts(&self) -> Result<Vec<u32>, ModelError> {
        let count = self.corners.len();
        if u32::try_from(count).is_err() {
            return Err(ModelError::TooMany { what: "corners", count });
        }
        let mut starts = Vec::with_capacity(self.face_end.len() + 1);
        starts.push(0);
        starts.extend_from_slice(&self.face_end);
        Ok(starts)
    }
}

/// A corner of a model has no texture coordinate, or one that is not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("corner {corner} (counted from 0) has no finite texture coordinate")]
#[non_exhaustive]
pub struct MissingTexture {
    /// The corner.
    pub corner: usize,
}

/// Texture coordinates of a file: points of the plane, and for each corner of the model which of them it has.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureCoordinates {
    points: Vec<[f64; 2]>,
    corners: Vec<u32>,
}

#[cfg(feature = "files")]
impl TextureCoordinates {
    /// Stands for a corner without texture coordinate.
    pub(crate) const NONE: u32 = u32::MAX;

    /// Points, and one index (or [`Self::NONE`]) a corner; what is out of range counts as none.
    pub(crate) fn new(points: Vec<[f64; 2]>, corners: Vec<u32>) -> Self {
        Self { points, corners }
    }
}

impl TextureCoordinates {
    /// Points, and one index a corner; what is out of range counts as none.
    pub(super) fn of(points: Vec<[f64; 2]>, corners: Vec<u32>) -> Self {
        Self { points, corners }
    }

    /// The points of the plane, in the order of the file.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Which of the points belongs to a corner of the model, if the file says so.
    pub fn index(&self, corner: usize) -> Option<u32> {
        self.corners.get(corner).copied().filter(|&i| (i as usize) < self.points.len())
    }

    /// The texture coordinate of a corner of the model: none where the file has none, or one that is not finite.
    pub fn corner(&self, corner: usize) -> Option<[f64; 2]> {
        let point = self.points[self.index(corner)? as usize];
        point.iter().all(|x| x.is_finite()).then_some(point)
    }

    /// The texture coordinates of all corners in order.
    ///
    /// # Errors
    /// If a corner has none; the first is named.
    pub fn all(&self) -> Result<Vec<[f64; 2]>, MissingTexture> {
        (0..self.corners.len()).map(|corner| self.corner(corner).ok_or(MissingTexture { corner })).collect()
    }
}

/// How much of a file is not in its [`Model`]. Printed, it reads `2 lines, 1 point`; nothing at all prints nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Skipped {
    /// Polylines (`l`).
    pub lines: usize,
    /// Points (`p`).
    pub points: usize,
    /// Statements of free-form curves and surfaces.
    pub free_form: usize,
    /// Statements or elements that are none of the format's.
    pub unknown: usize,
    /// Texture coordinates that corners ask for and the file does not have.
    pub texture_references: usize,
    /// Normals that corners ask for and the file does not have.
    pub normal_references: usize,
    /// Lines or bytes after the end that the header announced.
    pub surplus: usize,
}

impl Skipped {
    /// Whether the model holds all that the file said.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl fmt::Display for Skipped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = [
            (self.lines, "line", "lines"),
            (self.points, "point", "points"),
            (self.free_form, "free-form statement", "free-form statements"),
            (self.unknown, "unknown statement", "unknown statements"),
            (self.texture_references, "missing texture coordinate", "missing texture coordinates"),
            (self.normal_references, "missing normal", "missing normals"),
            (self.surplus, "surplus item after the end", "surplus items after the end"),
        ];
        let mut separator = "";
        for (count, one, many) in kinds.into_iter().filter(|kind| kind.0 > 0) {
            write!(f, "{separator}{count} {}", if count == 1 { one } else { many })?;
            separator = ", ";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn what_makes_no_model_is_refused_by_name() {
        let refused = |points: &[[f64; 3]], faces: &[&[u32]]| Model::from_polygons(points.to_vec(), faces).unwrap_err();
        assert_eq!(refused(&[], &[&[0, 1, 2]]), ModelError::NoVertices);
        assert_eq!(refused(&POINTS, &[]), ModelError::NoFaces { vertices: 4 });
        assert_eq!(refused(&POINTS, &[&[0, 1, 2], &[0, 1]]), ModelError::FewCorners { face: 1, corners: 2 });
        assert_eq!(refused(&POINTS, &[&[0, 1, 4]]), ModelError::Index { face: 0, index: 4, vertices: 4 });
        let mut points = POINTS;
        for value in [f64::INFINITY, -1.1e153] {
            points[2][1] = value;
            assert_eq!(refused(&points, &[&[0, 1, 2]]), ModelError::Coordinate { vertex: 2, value });
        }
        points[2][1] = f64::NAN;
        assert!(refused(&points, &[&[0, 1, 2]]).to_string().starts_with("vertex 2 has the coordinate NaN"));
        points[2][1] = -1.1e153;
        let told = "vertex 2 has the coordinate -1.1e153, which must be finite and at most 1e153 from 0";
        assert_eq!(refused(&points, &[&[0, 1, 2]]).to_string(), told);
    }

    #[test]
    fn the_largest_coordinates_have_finite_squared_distances() {
        assert!((3.0 * (2.0 * MAX_COORDINATE).powi(2)).is_finite());
    }

    #[test]
    fn faces_are_rows_of_corners() {
        let model = Model::from_polygons(POINTS.to_vec(), [&[0, 1, 2][..], &[0, 1, 2, 3]]).unwrap();
        assert_eq!((model.vertex_count(), model.face_count(), model.corner_count()), (4, 2, 7));
        assert_eq!((model.face(1), model.face_corners(1)), (&[0, 1, 2, 3][..], 3..7));
        assert_eq!(model.faces().map(<[u32]>::len).collect::<Vec<_>>(), [3, 4]);
    }

    #[test]
    fn of_corners_without_texture_the_first_is_named() {
        let uv = vec![[0.0, 0.0], [1.0, f64::NAN], [f64::INFINITY, 0.0]];
        let model = Model::from_triangles(POINTS.to_vec(), &[[0, 1, 2]]).unwrap().with_texture(uv).unwrap();
        let missing = model.uv().unwrap().all().unwrap_err();
        assert_eq!(missing, MissingTexture { corner: 1 });
        let error: Box<dyn std::error::Error> = missing.into();
        assert_eq!(error.to_string(), "corner 1 (counted from 0) has no finite texture coordinate");
    }

    #[test]
    fn skipped_things_are_printed_in_words() {
        assert!(Skipped::default().is_empty());
        let skipped = Skipped { lines: 2, points: 1, surplus: 3, ..Skipped::default() };
        assert_eq!(skipped.to_string(), "2 lines, 1 point, 3 surplus items after the end");
    }
}
