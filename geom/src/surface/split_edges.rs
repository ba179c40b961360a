//! Edges split at the vertices of other faces that lie on them.

use super::attributes::{Attribute, AttributeDomain, Attributes};
use super::model::{Model, Polygons, TextureCoordinates};
use super::repair::RepairLog;
use super::t_junctions::Insertion;
use super::weld::Weld;
use crate::watch::{Watch, unwatched};

/// A model whose edges are split at T-junctions.
#[derive(Clone, Debug)]
pub struct SplitEdges {
    /// The model: the vertices and faces of the one that was given in their order, some faces with more corners.
    pub model: Model,
    /// How many vertices lie on edges of other faces, those at one place counted once.
    pub vertices: usize,
    /// How many faces have more corners.
    pub faces: usize,
}

impl Model {
    /// The same surface, closed where vertices lie on the edges of other faces (T-junctions): these faces gain a corner there, on a straight side, as
    /// far as that closes the surface. None if there is nothing to close. `weld` says which vertices are taken for one: those of faces with vertices of
    /// their own are found at T-junctions unless it is [`Weld::Never`].
    ///
    /// Vertices, the order of faces and attributes stay; normals and texture coordinates of a new corner lie between those at the ends of its side. The
    /// text of an OBJ is not kept: see [`io::with_split_edges`](crate::io::with_split_edges). O(n log n) in the number of open edges, besides
    /// O(faces) to find them.
    ///
    /// ```
    /// // A square beside two that are half as high.
    /// let points = [[0, 0], [2, 0], [2, 1], [2, 2], [0, 2], [3, 0], [3, 1], [3, 2]].map(|[x, y]| [f64::from(x), f64::from(y), 0.0]);
    /// let model = geom::Model::from_polygons(points.to_vec(), [[0, 1, 3, 4], [1, 5, 6, 2], [2, 6, 7, 3]])?;
    /// let split = model.with_edges_split(geom::Weld::Auto).expect("vertex 2 lies on an edge");
    /// assert_eq!(split.model.face(0), [0, 1, 2, 3, 4]);
    /// # Ok::<(), geom::ModelError>(())
    /// ```
    pub fn with_edges_split(&self, weld: Weld) -> Option<SplitEdges> {
        let triangles = self.triangles();
        let soup = unwatched(weld.glued(self, &triangles, &mut RepairLog::default(), Watch::NONE));
        let insertions = soup.t_junctions(self, weld != Weld::Never);
        if insertions.is_empty() {
            return None;
        }
        let split = Split::new(self, &insertions);
        let mut places: Vec<u32> = insertions.iter().map(|insertion| insertion.place).collect();
        places.sort_unstable();
        places.dedup();
        let faces = (0..self.face_count()).filter(|&face| split.size(face) > self.face(face).len()).count();
        Some(SplitEdges { model: split.model()?, vertices: places.len(), faces })
    }
}

/// A corner of a split model.
#[derive(Clone, Copy)]
enum Corner {
    /// One that was there.
    Old(u32),
    /// A new one, between two old ones.
    New { between: [u32; 2], along: f64, vertex: u32 },
}

/// A model about to be split.
struct Split<'a> {
    model: &'a Model,
    corners: Vec<Corner>,
    /// Where the corners of each face begin, and at the end their number.
    face_start: Vec<usize>,
}

impl<'a> Split<'a> {
    fn new(model: &'a Model, insertions: &[Insertion]) -> Self {
        let mut corners = Vec::with_capacity(model.corner_count() + insertions.len());
        let mut face_start = vec![0];
        let mut insertions = insertions.iter().peekable();
        for face in 0..model.face_count() {
            let range = model.face_corners(face);
            for corner in range.clone() {
                corners.push(Corner::Old(corner as u32));
                let behind = if corner + 1 < range.end { corner + 1 } else { range.start };
                while let Some(new) = insertions.next_if(|new| new.corner as usize == corner) {
                    let between = [corner as u32, behind as u32];
                    corners.push(Corner::New { between, along: new.along, vertex: new.vertex });
                }
            }
            face_start.push(corners.len());
        }
        Self { model, corners, face_start }
    }

    fn size(&self, face: usize) -> usize {
        self.face_start[face + 1] - self.face_start[face]
    }

    fn model(&self) -> Option<Model> {
        let vertex = |corner: &Corner| match *corner {
            Corner::Old(corner) => self.model.corners()[corner as usize],
            Corner::New { vertex, .. } => vertex,
        };
        let mut polygons = Polygons::default();
        for face in self.face_start.windows(2) {
            polygons.corners.extend(self.corners[face[0]..face[1]].iter().map(vertex));
            polygons.end_face();
        }
        let model = Model::new(self.model.points().to_vec(), polygons).ok()?;
        Some(model.with_attributes(self.attributes()).with_texture_coordinates(self.uv()))
    }

    fn attributes(&self) -> Attributes {
        let attributes = self.model.attributes();
        let table = |table: &Attribute| match table.domain() {
            AttributeDomain::Corners => self.table(table),
            AttributeDomain::Vertices | AttributeDomain::Faces => table.clone(),
        };
        Attributes { tables: attributes.tables.iter().map(table).collect(), ..attributes.clone() }
    }

    /// A table of corners, of the split model's ones.
    fn table(&self, table: &Attribute) -> Attribute {
        let mut mixed = table.picked(0..table.rows());
        let row = |corner: u32| table.row_at(self.model.corners(), corner as usize);
        let index = self.corners.iter().map(|corner| match *corner {
            Corner::Old(corner) => row(corner).map_or(Attribute::NONE, |row| row as u32),
            Corner::New { between: [a, b], along, .. } => {
                let (Some(a), Some(b)) = (row(a), row(b)) else { return Attribute::NONE };
                mixed.mix(table, &[(a, 1.0 - along), (b, along)]);
                mixed.rows() as u32 - 1
            }
        });
        let index = index.collect();
        mixed.at_corners(index)
    }

    fn uv(&self) -> Option<TextureCoordinates> {
        let uv = self.model.uv()?;
        let mut points = uv.points().to_vec();
        let corners = self.corners.iter().map(|corner| match *corner {
            Corner::Old(corner) => uv.index(corner as usize).unwrap_or(u32::MAX),
            Corner::New { between, along, .. } => {
                let [Some(a), Some(b)] = between.map(|corner| uv.corner(corner as usize)) else { return u32::MAX };
                points.push([0, 1].map(|k| (1.0 - along) * a[k] + along * b[k]));
                points.len() as u32 - 1
            }
        });
        let corners = corners.collect();
        Some(TextureCoordinates::of(points, corners))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Prepared, RepairKind, prepare};
    use proptest::prelude::*;

    /// A box two units wide of unit squares, but for its lid: one rectangle.
    fn house() -> Model {
        let at = |x: u32, y: u32, z: u32| 6 * z + 3 * y + x;
        let points = (0..12).map(|v| [v % 3, v / 3 % 2, v / 6].map(f64::from)).collect();
        let mut faces = vec![[at(0, 0, 1), at(2, 0, 1), at(2, 1, 1), at(0, 1, 1)]];
        faces.push([at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)]);
        faces.push([at(2, 0, 0), at(2, 1, 0), at(2, 1, 1), at(2, 0, 1)]);
        for x in 0..2 {
            faces.push([at(x, 0, 0), at(x, 1, 0), at(x + 1, 1, 0), at(x + 1, 0, 0)]);
            faces.push([at(x, 0, 0), at(x + 1, 0, 0), at(x + 1, 0, 1), at(x, 0, 1)]);
            faces.push([at(x, 1, 0), at(x, 1, 1), at(x + 1, 1, 1), at(x + 1, 1, 0)]);
        }
        Model::from_polygons(points, &faces).unwrap()
    }

    /// The same with vertices of its own for each face.
    fn apart(model: &Model) -> Model {
        let points = model.corners().iter().map(|&v| model.points()[v as usize]).collect();
        let faces = (0..model.face_count())
            .map(|face| model.face_corners(face).map(|corner| corner as u32).collect::<Vec<_>>());
        Model::from_polygons(points, faces).unwrap()
    }

    fn turned_faces(model: &Model, is_turned: impl Fn(usize) -> bool) -> Model {
        let turned = |(f, face): (usize, &[u32])| {
            let mut face = face.to_vec();
            if is_turned(f) {
                face.reverse();
            }
            face
        };
        Model::from_polygons(model.points().to_vec(), model.faces().enumerate().map(turned)).unwrap()
    }

    fn euler(prepared: &Prepared) -> Vec<i64> {
        prepared.surfaces.iter().map(|surface| surface.mesh.euler_characteristic()).collect()
    }

    #[test]
    fn a_box_is_closed_at_its_lid() {
        let house = house();
        for (model, weld) in [
            (house.clone(), Weld::Never),
            (house.clone(), Weld::Auto),
            (apart(&house), Weld::Auto),
            (apart(&house), Weld::Always),
        ] {
            assert_ne!(euler(&prepare(&model, weld).unwrap()), [2]);
            let split = model.with_edges_split(weld).unwrap();
            assert_eq!((split.vertices, split.faces), (2, 1));
            assert_eq!(split.model.points(), model.points());
            assert_eq!(split.model.face(0).len(), 6);
            assert!((1..model.face_count()).all(|face| split.model.face(face) == model.face(face)));
            let closed = prepare(&split.model, weld).unwrap();
            assert_eq!(euler(&closed), [2]);
            assert!(closed.repairs.iter().all(|repair| repair.kind == RepairKind::Welded), "{:?}", closed.repairs);
            assert!(split.model.with_edges_split(weld).is_none(), "there is nothing left to close");
        }
        assert!(apart(&house).with_edges_split(Weld::Never).is_none(), "nothing is joined");
    }

    #[test]
    fn size_and_rounding_do_not_matter_but_a_gap_does() {
        let moved = |by: f64, scale: f64| {
            let points = house()
                .points()
                .iter()
                .map(|&[x, y, z]| [x, y, if x == 1.0 && z == 1.0 { z - by } else { z }].map(|x| scale * x))
                .collect();
            Model::from_polygons(points, house().faces()).unwrap()
        };
        for scale in [1e-150, 1e-3, 1.0, 1e150] {
            assert_eq!(moved(1e-8, scale).with_edges_split(Weld::Auto).map(|split| split.vertices), Some(2), "{scale}");
            assert!(moved(1e-3, scale).with_edges_split(Weld::Auto).is_none(), "{scale}");
        }
    }

    #[test]
    fn faces_against_each_other_sheets_on_sheets_and_what_merely_touches_stay_apart() {
        let against = turned_faces(&house(), |face| face == 0);
        assert!(against.with_edges_split(Weld::Auto).is_none());
        // A square on its back, cut in two.
        let at = |p: [i32; 2]| [f64::from(p[0]), f64::from(p[1]), 0.0];
        let rim = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [1, 2]].map(at);
        let faces = [[0, 1, 2, 3], [0, 3, 5, 4], [4, 5, 2, 1]];
        assert!(Model::from_polygons(rim.to_vec(), faces).unwrap().with_edges_split(Weld::Auto).is_none());
        // Triangles of which one has its tip on the side of another.
        let points = [[0, 0], [2, 0], [1, 2], [1, 0], [0, -1], [2, -1]].map(at);
        assert!(
            Model::from_triangles(points.to_vec(), &[[0, 1, 2], [3, 4, 5]])
                .unwrap()
                .with_edges_split(Weld::Auto)
                .is_none()
        );
    }

    #[test]
    fn attributes_and_texture_coordinates_of_new_corners_are_between_those_of_their_side() {
        let house = house();
        let corners: Vec<f64> = (0..house.corner_count()).map(|corner| corner as f64).collect();
        let mut heat =
            Attribute::new(crate::Meaning::Other("heat".into()), AttributeDomain::Corners, crate::ScalarType::F64, 1);
        corners.iter().for_each(|&x| heat.push(x));
        let heat = heat.at_corners((0..corners.len() as u32).collect());
        let model = house.with_attributes(Attributes { tables: vec![heat], ..Attributes::default() });
        let model = model.with_texture(corners.iter().map(|&x| [x, -x]).collect()).unwrap();
        let split = model.with_edges_split(Weld::Auto).unwrap().model;
        assert_eq!(split.face(0), [6, 7, 8, 11, 10, 9]);
        let uv = split.uv().unwrap().all().unwrap();
        assert_eq!(uv[..7].iter().map(|uv| uv[0]).collect::<Vec<_>>(), [0.0, 0.5, 1.0, 2.0, 2.5, 3.0, 4.0]);
        let table = &split.attributes().tables[0];
        let heat = |corner| table.row(table.row_at(split.corners(), corner).unwrap()).collect::<Vec<_>>();
        assert_eq!([1, 4, 6].map(heat), [[0.5], [2.5], [4.0]]);
    }

    #[test]
    fn very_many_points_on_one_line_take_no_long_time() {
        let count = 20_000;
        let points = (0..count).map(|k| [f64::from(k * 7_919 % count), 0.0, 0.0]).chain([[0.0, 1.0, 0.0]]).collect();
        let faces: Vec<[u32; 3]> = (0..count as u32 - 1).map(|k| [k, k + 1, count as u32]).collect();
        let _ = Model::from_triangles(points, &faces).unwrap().with_edges_split(Weld::Auto);
    }

    proptest! {
        #[test]
        fn whatever_is_split_keeps_its_corners_in_order(
            points in proptest::collection::vec(proptest::array::uniform3(0..4_u8), 3..30),
            faces in proptest::collection::vec(proptest::collection::vec(0..30_u32, 3..6), 1..40),
        ) {
            let count = points.len() as u32;
            let points = points.into_iter().map(|p| p.map(f64::from)).collect();
            let faces: Vec<Vec<u32>> = faces.into_iter().map(|face| face.into_iter().map(|v| v % count).collect()).collect();
            let model = Model::from_polygons(points, &faces).unwrap();
            for weld in [Weld::Auto, Weld::Never, Weld::Always] {
                let Some(split) = model.with_edges_split(weld) else { continue };
                prop_assert!(split.vertices > 0 && split.faces > 0);
                for (face, old) in faces.iter().enumerate() {
                    let mut new = split.model.face(face).iter();
                    prop_assert!(old.iter().all(|v| new.any(|w| w == v)));
                }
                if let Ok(prepared) = prepare(&split.model, weld) {
                    prepared.surfaces.iter().for_each(|surface| surface.mesh.check());
                }
            }
        }
    }
}
