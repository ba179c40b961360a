//! From a model as a file had it to oriented manifold surfaces that can be computed with, and back.
//!
//! Whatever is wrong is mended here or named, and nothing is dropped silently:
//! - triangles that use a vertex twice, and copies of a triangle at an edge that has too many, are left out;
//! - isolated vertices are left out;
//! - triangles are turned until neighbours agree, the way most of the component had them; a surface that is not
//!   orientable is opened along the edges where they cannot;
//! - at an edge of four or more triangles, an even number, where bodies touch, triangles are glued in pairs that bound the same body; at other edges of
//!   three or more, and at a vertex of several fans, the surface is opened: every fan gets its own copy of the vertex;
//! - where a vertex lies on an edge of another face (a T-junction) the surface stays open, and that is named: see [`Model::with_edges_split`];
//! - each connected component becomes a [`Surface`] of its own, moved to the origin and scaled to unit size.
//!
//! Polygons are computed with as triangles ([`Model::triangles`]); the edges inside a polygon are known, so that no seam
//! need run along them. Every halfedge knows the model's corner that it came from: that is the way back.

use std::collections::{HashMap, HashSet};

use thiserror::Error;

use super::model::{Model, place_key};
use super::numbering::{along_a_curve, is_scattered};
use super::repair::{Repair, RepairKind, RepairLog};
use super::soup::{NONE, Soup, number};
use super::t_junctions::Insertion;
use super::triangulate::Triangles;
use super::weld::Weld;
use crate::intrinsic::Metric;
use crate::mesh::{EdgeData, EdgeId, FaceData, FaceId, HalfedgeData, HalfedgeId, Id, Mesh, VertexData, VertexId};
use crate::parallel::{each_of, join, map};
use crate::rows::Rows;
use crate::vector::{cross, length, sub};
use crate::watch::{Interrupted, Watch};

/// Why a model has no surface to compute with.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum PrepareError {
    /// All faces lie in lines or points.
    #[error("the mesh has no area: {}", if *faces == 1 { "its only face is a point or a line".to_owned() } else { format!("all of its {faces} faces are points or lines") })]
    NoArea {
        /// How many faces there are.
        faces: usize,
    },
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// A connected, oriented manifold surface with the way back to the model.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its connectivity.
    pub mesh: Mesh,
    /// The positions of its vertices, centred and scaled to unit size.
    pub points: Vec<[f64; 3]>,
    /// The model's vertex that each vertex is, or is a copy of.
    pub vertex: VertexData<u32>,
    /// The model's corner that each halfedge starts at.
    pub corner: HalfedgeData<u32>,
    /// The model's triangle that each face is (perhaps turned).
    pub triangle: FaceData<u32>,
    /// The edges that lie inside a polygon of the model.
    pub diagonal: EdgeData<bool>,
    /// What positions were multiplied by.
    pub scale: f64,
    /// How many triangles have no area.
    pub zero_area: usize,
}

impl Surface {
    /// The edge lengths in unit size; where triangles have no area, lengthened by a hair so that all have some.
    pub fn metric(&self) -> Metric {
        let metric = Metric::from_points(&self.mesh, &self.points);
        if self.zero_area > 0 { metric.mollified(&self.mesh, Metric::MOLLIFICATION) } else { metric }
    }
}

/// A model's surfaces and what was mended.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The connected components, in the order of their first triangles.
    pub surfaces: Vec<Surface>,
    /// The triangles of the model, before anything was left out.
    pub triangles: Triangles,
    /// Which of the triangles belong to no surface.
    pub left_out: Vec<u32>,
    /// What was mended, in a fixed order.
    pub repairs: Vec<Repair>,
}

/// Makes surfaces of a model, some of whose vertices may be taken for one. O(F) but for sorting.
///
/// # Errors
/// If nothing has any area.
pub fn prepare(model: &Model, weld: Weld) -> Result<Prepared, PrepareError> {
    prepare_watched(model, weld, Watch::NONE)
}

/// [`prepare()`], watched.
///
/// # Errors
/// If nothing has any area, or the work is stopped.
pub fn prepare_watched(model: &Model, weld: Weld, watch: Watch) -> Result<Prepared, PrepareError> {
    let mut log = RepairLog::default();
    let triangles = model.triangles();
    watch.ask(0.02)?;
    let mut soup = weld.glued(model, &triangles, &mut log, watch.within(0.05, 0.35))?;
    if weld != Weld::Never {
        note_t_junctions(&soup.t_junctions(model, true), &mut log);
    }
    note_isolated(model, &mut log);
    soup.orient(&mut log);
    watch.ask(0.5)?;
    let surfaces = surfaces(&soup, model.points(), &mut log, watch.within(0.5, 0.95))?;
    drop(soup);
    if surfaces.is_empty() {
        return Err(PrepareError::NoArea { faces: model.face_count() });
    }
    note_unwelded(model.points(), &surfaces, &mut log);
    let mut used = vec![false; triangles.len()];
    surfaces.iter().flat_map(|surface| surface.triangle.iter()).for_each(|&t| used[t as usize] = true);
    let left_out = (0..triangles.len() as u32).filter(|&t| !used[t as usize]).collect();
    Ok(Prepared { surfaces, triangles, left_out, repairs: log.into_repairs() })
}

/// Notes the vertices that lie on edges of other faces, those at one place once.
fn note_t_junctions(insertions: &[Insertion], log: &mut RepairLog) {
    let places: HashSet<u32> = insertions.iter().map(|insertion| insertion.place).collect();
    places.into_iter().for_each(|place| log.note(RepairKind::TJunction, place as usize));
}

/// A triangle's height in a surface of size 1 that may be rounding alone.
const ROUNDED_HEIGHT: f64 = 1e-14;

/// A surface of each connected component.
fn surfaces(soup: &Soup, points: &[[f64; 3]], log: &mut RepairLog, watch: Watch) -> Result<Vec<Surface>, Interrupted> {
    let ((fan, fan_vertex), components) = join(|| soup.fans(log), || soup.components());
    let face_count = soup.triangle.len();
    let (new_vertex, new_face) = (vec![NONE; fan_vertex.len()], vec![NONE; face_count]);
    let mut parting = Parting { soup, points, fan, fan_vertex, new_vertex, new_face };
    let mut surfaces = Vec::new();
    let mut done = 0;
    for faces in components {
        let share = |faces: usize| faces as f64 / face_count as f64;
        let watch = watch.within(share(done), share(done + faces.len()));
        watch.ask(0.0)?;
        done += faces.len();
        surfaces.extend(parting.surface(faces, log, watch)?);
    }
    Ok(surfaces)
}

/// Triangles parted into surfaces.
struct Parting<'a> {
    soup: &'a Soup,
    points: &'a [[f64; 3]],
    /// The fan of each halfedge's tail, and the vertex of each fan.
    fan: Vec<u32>,
    fan_vertex: Vec<VertexId>,
    /// What fans and triangles are numbered on the surface that they are of.
    new_vertex: Vec<u32>,
    new_face: Vec<u32>,
}

impl Parting<'_> {
    /// The surface of the triangles of one component; none if it has no area.
    fn surface(&mut self, faces: Vec<u32>, log: &mut RepairLog, watch: Watch) -> Result<Option<Surface>, Interrupted> {
        let soup = self.soup;
        let first_face = soup.triangle[faces[0] as usize].1 as usize;
        let fans = self.fans_of(&faces);
        let places = map(fans.len(), |k| self.points[self.fan_vertex[fans[k] as usize].index()]);
        let Some((points, scale)) = to_unit_size(&places) else {
            log.note(RepairKind::ComponentWithoutArea, first_face);
            return Ok(None);
        };
        let (faces, fans, points) = self.numbered(faces, fans, points);
        watch.ask(0.2)?;
        let mesh = self.mesh(&faces, fans.len(), watch)?;
        watch.ask(0.6)?;
        let vertex = map(fans.len(), |k| self.fan_vertex[fans[k] as usize].0).into();
        let corner = map(mesh.halfedge_count(), |k| soup.corner[side(&faces, k)]).into();
        let face_of = |h: HalfedgeId| soup.triangle[faces[h.index() / 3] as usize].1;
        let metric = Metric::from_points(&mesh, &points);
        watch.ask(0.8)?;
        let mut zero_area = 0;
        let has_none = |f: usize| metric.sides(&mesh, FaceId::new(f)).area() <= 0.0;
        each_of(mesh.face_count(), has_none, |f, has_none| {
            if has_none {
                log.note(RepairKind::ZeroArea, face_of(mesh.sides(FaceId::new(f))[0]) as usize);
                zero_area += 1;
            }
        });
        if zero_area == mesh.face_count() || mesh.faces().all(|f| is_line(mesh.corners(f).map(|v| points[v.index()]))) {
            log.note(RepairKind::ComponentWithoutArea, first_face);
            return Ok(None);
        }
        let inside = |e: EdgeId| {
            let h = mesh.halfedge(e);
            mesh.twin(h).is_some_and(|g| face_of(g) == face_of(h))
        };
        let diagonal = map(mesh.edge_count(), |e| inside(EdgeId::new(e))).into();
        let triangle = map(faces.len(), |k| soup.triangle[faces[k] as usize].0).into();
        Ok(Some(Surface { mesh, points, vertex, corner, triangle, diagonal, scale, zero_area }))
    }

    /// The fans of triangles, ascending.
    fn fans_of(&mut self, faces: &[u32]) -> Vec<u32> {
        if faces.len() == self.new_face.len() {
            return (0..self.fan_vertex.len() as u32).collect();
        }
        let Self { fan, new_vertex, .. } = self;
        let is_new = |fan: &u32| std::mem::replace(&mut new_vertex[*fan as usize], 0) == NONE;
        let mut fans: Vec<u32> = (0..3 * faces.len()).map(|k| fan[side(faces, k)]).filter(is_new).collect();
        fans.sort_unstable();
        fans
    }

    /// Numbers triangles and fans, the points with these: as they are listed, or along a curve where they are scattered.
    fn numbered(
        &mut self,
        mut faces: Vec<u32>,
        mut fans: Vec<u32>,
        mut points: Vec<[f64; 3]>,
    ) -> (Vec<u32>, Vec<u32>, Vec<[f64; 3]>) {
        number(&fans, &mut self.new_vertex);
        let new_vertex = |this: &Self, h: usize| this.new_vertex[this.fan[h] as usize];
        if is_scattered(fans.len(), &faces, |h| new_vertex(self, h)) {
            let order = along_a_curve(&points);
            fans = order.iter().map(|&k| fans[k as usize]).collect();
            points = order.iter().map(|&k| points[k as usize]).collect();
            number(&fans, &mut self.new_vertex);
            // By their first vertices.
            let first = |k: usize| (0..3).map(|i| new_vertex(self, side(&faces, 3 * k + i))).fold(NONE, u32::min);
            let first = map(faces.len(), first);
            let in_rows = first.iter().zip(&faces).map(|(&first, &f)| (first as usize, f));
            faces = Rows::sorted(fans.len(), in_rows).into_items();
        }
        number(&faces, &mut self.new_face);
        (faces, fans, points)
    }

    /// The mesh of triangles that are numbered.
    fn mesh(&self, faces: &[u32], vertex_count: usize, watch: Watch) -> Result<Mesh, Interrupted> {
        let tail = |k: usize| VertexId(self.new_vertex[self.fan[side(faces, k)] as usize]);
        let renumber = |g: u32| if g == NONE { NONE } else { 3 * self.new_face[g as usize / 3] + g % 3 };
        let tail = map(3 * faces.len(), tail);
        let twin = map(3 * faces.len(), |k| renumber(self.soup.twin[side(faces, k)]));
        watch.ask(0.4)?;
        Ok(Mesh::from_twins(vertex_count, tail, twin).expect("every fan is a vertex of its own"))
    }
}

/// A side of the triangles of a list, counted through it.
fn side(faces: &[u32], k: usize) -> usize {
    3 * faces[k / 3] as usize + k % 3
}

/// Points moved so that their bounding box is centred, and scaled so that its longest side is 1, with that scale; none if
/// they all coincide.
fn to_unit_size(points: &[[f64; 3]]) -> Option<(Vec<[f64; 3]>, f64)> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for p in points {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let scale = size.recip();
    if !(size > 0.0 && scale.is_finite()) {
        return None;
    }
    let middle = [0, 1, 2].map(|k| 0.5 * low[k] + 0.5 * high[k]);
    Some((points.iter().map(|p| [0, 1, 2].map(|k| (p[k] - middle[k]) * scale)).collect(), scale))
}

/// Whether a triangle is so flat, in a surface of size 1, that rounding gave it all the height it has.
fn is_line([a, b, c]: [[f64; 3]; 3]) -> bool {
    let [first, second, third] = [sub(b, a), sub(c, a), sub(c, b)];
    let longest = [first, second, third].map(length).into_iter().fold(0.0, f64::max);
    length(cross(first, second)) <= ROUNDED_HEIGHT * longest
}

fn note_isolated(model: &Model, log: &mut RepairLog) {
    let mut used = vec![false; model.vertex_count()];
    model.corners().iter().for_each(|&v| used[v as usize] = true);
    for (v, _) in used.iter().enumerate().filter(|(_, used)| !**used) {
        log.note(RepairKind::IsolatedVertex, v);
    }
}

fn note_unwelded(points: &[[f64; 3]], surfaces: &[Surface], log: &mut RepairLog) {
    let mut at_place: HashMap<[u64; 3], u32> = HashMap::new();
    // A vertex with several fans is on the boundary more than once.
    let mut noted = HashSet::new();
    for surface in surfaces {
        for v in surface.mesh.vertices().filter(|&v| surface.mesh.is_boundary_vertex(v)) {
            let vertex = surface.vertex[v];
            let other = *at_place.entry(place_key(&points[vertex as usize])).or_insert(vertex);
            if other != vertex && noted.insert(vertex) {
                log.note(RepairKind::Unwelded, vertex as usize);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::numbering::FITS_THE_CACHE;
    use super::*;
    use crate::shapes;

    fn prepared(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Prepared {
        prepare(&Model::from_triangles(points.to_vec(), faces).unwrap(), Weld::Never).unwrap()
    }

    fn count(prepared: &Prepared, kind: RepairKind) -> usize {
        prepared.repairs.iter().find(|repair| repair.kind == kind).map_or(0, |repair| repair.count)
    }

    fn check(prepared: &Prepared, model: &Model) {
        for surface in &prepared.surfaces {
            surface.mesh.check();
            assert_eq!(surface.mesh.components().1, 1);
            for h in surface.mesh.halfedges() {
                let vertex = model.corners()[surface.corner[h] as usize];
                assert_eq!(surface.vertex[surface.mesh.tail(h)], vertex, "corners lead back to their vertices");
            }
        }
        let faces: usize = prepared.surfaces.iter().map(|surface| surface.mesh.face_count()).sum();
        assert_eq!(faces + prepared.left_out.len(), prepared.triangles.len(), "no triangle is lost");
    }

    fn sphere() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let shape = shapes::sphere(100);
        (shape.points, shape.triangles)
    }

    #[test]
    fn a_clean_mesh_stays_as_it_is() {
        let (points, faces) = sphere();
        let model = Model::from_triangles(points.clone(), &faces).unwrap();
        let prepared = prepare(&model, Weld::Always).unwrap();
        assert_eq!(prepared.repairs, []);
        check(&prepared, &model);
        let [surface] = &prepared.surfaces[..] else { panic!("it is connected") };
        assert_eq!(surface.mesh, Mesh::new(points.len(), &faces).unwrap());
        assert!((surface.points[0][0] / surface.points[1][0] - points[0][0] / points[1][0]).abs() < 1e-9);
    }

    #[test]
    fn a_large_surface_in_no_order_is_numbered_along_a_curve() {
        let shape = shapes::sphere(FITS_THE_CACHE);
        let n = shape.points.len();
        assert!((FITS_THE_CACHE..4 * FITS_THE_CACHE).contains(&n), "{n}");
        let share_of_far = |mesh: &Mesh| {
            let far = mesh.edges().map(|e| mesh.ends(e)).filter(|[a, b]| a.0.abs_diff(b.0) > 1000).count();
            far as f64 / mesh.edge_count() as f64
        };
        // The k-th vertex becomes vertex 3,163 k mod n.
        let renumbered: Vec<usize> = (0..n).map(|k| k * 3_163 % n).collect();
        let mut points = vec![[0.0; 3]; n];
        renumbered.iter().zip(&shape.points).for_each(|(&to, &p)| points[to] = p);
        assert!(points.iter().all(|p| *p != [0.0; 3]), "every number is taken");
        let mut faces: Vec<[u32; 3]> =
            shape.triangles.iter().map(|t| t.map(|v| renumbered[v as usize] as u32)).collect();
        let half = faces.split_off(faces.len() / 2);
        faces = half.into_iter().zip(faces).flat_map(|(a, b)| [a, b]).collect();
        let model = Model::from_triangles(points.clone(), &faces).unwrap();
        let prepared = prepare(&model, Weld::Never).unwrap();
        check(&prepared, &model);
        let surface = &prepared.surfaces[0];
        assert!(share_of_far(&Mesh::new(n, &faces).unwrap()) > 0.7);
        assert!(share_of_far(&surface.mesh) < 0.1, "{}", share_of_far(&surface.mesh));
        for v in surface.mesh.vertices() {
            let given = points[surface.vertex[v] as usize];
            assert!((0..3).all(|k| (surface.points[v.index()][k] / surface.scale - given[k]).abs() < 1e-2));
        }
    }

    #[test]
    fn a_surface_that_cannot_be_oriented_is_opened_between_polygons_only() {
        for count in 3..9_u32 {
            // A Möbius band of quads: half a turn about its centre line on the way round.
            let at = |k: u32, side: f64| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
                let (up, out) = (std::f64::consts::PI * f64::from(k) / f64::from(count)).sin_cos();
                [(2.0 + side * out) * cos, (2.0 + side * out) * sin, side * up]
            };
            let points = (0..count).flat_map(|k| [at(k, -0.5), at(k, 0.5)]).collect();
            let quad = |k: u32| match k + 1 < count {
                true => [2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2],
                false => [2 * k, 2 * k + 1, 0, 1],
            };
            let quads: Vec<[u32; 4]> = (0..count).map(quad).collect();
            let model = Model::from_polygons(points, &quads).unwrap();
            let prepared = prepare(&model, Weld::Never).unwrap();
            check(&prepared, &model);
            let [surface] = &prepared.surfaces[..] else { panic!("it is connected") };
            assert_eq!(surface.diagonal.iter().filter(|&&is_inside| is_inside).count(), quads.len(), "{count} quads");
            assert_eq!(self::count(&prepared, RepairKind::NonOrientableEdge), 1);
            assert_eq!(surface.mesh.euler_characteristic(), 1, "a strip");
        }
    }

    #[test]
    fn misoriented_faces_are_turned_to_the_majority() {
        let (points, mut faces) = sphere();
        for f in [0, 3, 17] {
            faces[f].swap(1, 2);
        }
        let model = Model::from_triangles(points.clone(), &faces).unwrap();
        let turned = prepare(&model, Weld::Never).unwrap();
        check(&turned, &model);
        assert_eq!(turned.repairs, [Repair { kind: RepairKind::FlippedFace, count: 3, first: 0 }]);
        // Inside out is consistent, too.
        faces.iter_mut().for_each(|face| face.swap(0, 2));
        let inside_out = prepared(&points, &faces);
        assert_eq!(count(&inside_out, RepairKind::FlippedFace), 3);
    }

    #[test]
    fn copies_repeated_vertices_and_isolated_ones_are_left_out_and_counted() {
        let (mut points, mut faces) = sphere();
        faces.extend([faces[5], [faces[7][0], faces[7][2], faces[7][1]], [1, 1, 2]]);
        points.push([9.0, 9.0, 9.0]);
        let model = Model::from_triangles(points.clone(), &faces).unwrap();
        let mended = prepare(&model, Weld::Never).unwrap();
        check(&mended, &model);
        assert_eq!(count(&mended, RepairKind::DuplicateFace), 2);
        assert_eq!(count(&mended, RepairKind::RepeatedVertex), 1);
        assert_eq!(count(&mended, RepairKind::IsolatedVertex), 1);
        assert_eq!(mended.surfaces.len(), 1);
        assert_eq!(mended.surfaces[0].mesh.euler_characteristic(), 2);
        assert_eq!(mended.left_out.len(), 3);
    }

    /// The faces of a box of quads between two corners, its vertices numbered from `first` on.
    fn cuboid([low, high]: [[f64; 3]; 2], first: u32) -> (Vec<[f64; 3]>, Vec<[u32; 4]>) {
        let points = (0..8).map(|v| [0, 1, 2].map(|k| if v >> k & 1 == 0 { low[k] } else { high[k] })).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        (points, quads.map(|quad: [u32; 4]| quad.map(|v| first + v)).to_vec())
    }

    /// Boxes, vertices at one place taken for one.
    fn cuboids(boxes: &[[[f64; 3]; 2]]) -> Model {
        let (mut points, mut quads) = (Vec::new(), Vec::new());
        for &ends in boxes {
            let (more, faces) = cuboid(ends, points.len() as u32);
            points.extend(more);
            quads.extend(faces);
        }
        let first = Model::from_polygons(points.clone(), &quads).unwrap().first_at_place();
        quads.iter_mut().flatten().for_each(|v| *v = first[*v as usize]);
        Model::from_polygons(points, &quads).unwrap()
    }

    fn unit_cube(at: [f64; 3]) -> [[f64; 3]; 2] {
        [at, at.map(|x| x + 1.0)]
    }

    fn euler(prepared: &Prepared) -> Vec<i64> {
        prepared.surfaces.iter().map(|surface| surface.mesh.euler_characteristic()).collect()
    }

    #[test]
    fn boxes_that_touch_along_edges_are_closed_each_for_itself() {
        let [a, b, c] = [[0.0; 3], [1.0, 1.0, 0.0], [2.0, 0.0, 0.0]].map(unit_cube);
        for (boxes, edges) in [(&[a, b][..], 1), (&[a, b, c], 2)] {
            let model = cuboids(boxes);
            let closed = prepare(&model, Weld::Never).unwrap();
            check(&closed, &model);
            assert_eq!(euler(&closed), vec![2; boxes.len()]);
            assert_eq!(
                (count(&closed, RepairKind::TouchingEdge), count(&closed, RepairKind::NonManifoldEdge)),
                (edges, 0)
            );
            // The same where each face has vertices of its own.
            let apart: Vec<[f64; 3]> = model.corners().iter().map(|&v| model.points()[v as usize]).collect();
            let quads: Vec<[u32; 4]> =
                (0..model.face_count() as u32).map(|f| [0, 1, 2, 3].map(|k| 4 * f + k)).collect();
            let apart = Model::from_polygons(apart, &quads).unwrap();
            assert_eq!(euler(&prepare(&apart, Weld::Auto).unwrap()), vec![2; boxes.len()]);
            assert_eq!(euler(&prepare(&apart, Weld::Always).unwrap()), vec![2; boxes.len()]);
        }
    }

    #[test]
    fn an_edge_alone_where_a_body_touches_itself_stays_open() {
        // A way of cubes from one to another that touches it along an edge.
        let way = [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 0.0]];
        let quads = |model: &Model| -> Vec<Vec<u32>> {
            let faces: Vec<Vec<u32>> = model.faces().map(<[u32]>::to_vec).collect();
            let sorted = |face: &Vec<u32>| {
                let mut face = face.clone();
                face.sort_unstable();
                face
            };
            // Walls between cubes are there twice.
            faces
                .iter()
                .filter(|face| faces.iter().filter(|other| sorted(other) == sorted(face)).count() == 1)
                .cloned()
                .collect()
        };
        let model = cuboids(&way.map(unit_cube));
        let model = Model::from_polygons(model.points().to_vec(), quads(&model)).unwrap();
        assert_eq!(model.face_count(), 22);
        let open = prepare(&model, Weld::Never).unwrap();
        check(&open, &model);
        assert_eq!((count(&open, RepairKind::TouchingEdge), count(&open, RepairKind::NonManifoldEdge)), (0, 1));
    }

    #[test]
    fn an_edge_stays_open_where_its_faces_do_not_alternate() {
        let cubes = cuboids(&[[0.0; 3], [1.0, 1.0, 0.0]].map(unit_cube));
        let quads = || cubes.faces().map(<[u32]>::to_vec);
        let edge = |face: &Vec<u32>| {
            [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0]].iter().all(|p| face.iter().any(|&v| cubes.points()[v as usize] == *p))
        };
        let first = quads().position(|face| edge(&face)).unwrap();
        // One face at the edge is turned; one is not there.
        let turned = quads().enumerate().map(|(f, mut face)| {
            if f == first {
                face.reverse();
            }
            face
        });
        let fewer = quads().enumerate().filter(|&(f, _)| f != first).map(|(_, face)| face);
        for faces in [turned.collect::<Vec<_>>(), fewer.collect()] {
            let model = Model::from_polygons(cubes.points().to_vec(), &faces).unwrap();
            let open = prepare(&model, Weld::Never).unwrap();
            check(&open, &model);
            assert_eq!((count(&open, RepairKind::TouchingEdge), count(&open, RepairKind::NonManifoldEdge)), (0, 1));
        }
    }

    #[test]
    fn vertices_on_the_edges_of_other_faces_are_counted_unless_none_is_to_be_joined() {
        let points = [[0, 0], [2, 0], [2, 1], [2, 2], [0, 2], [3, 0], [3, 1], [3, 2]]
            .map(|[x, y]| [f64::from(x), f64::from(y), 0.0]);
        let model = Model::from_polygons(points.to_vec(), [[0, 1, 3, 4], [1, 5, 6, 2], [2, 6, 7, 3]]).unwrap();
        let open = prepare(&model, Weld::Auto).unwrap();
        let noted = Repair { kind: RepairKind::TJunction, count: 1, first: 2 };
        assert!(open.repairs.contains(&noted) && open.surfaces.len() == 2, "{:?}", open.repairs);
        assert_eq!(count(&prepare(&model, Weld::Never).unwrap(), RepairKind::TJunction), 0);
    }

    #[test]
    fn surfaces_are_opened_at_edges_with_too_many_faces_and_at_vertices_with_several_fans() {
        // Two tetrahedra with an edge in common, then with a vertex in common.
        let points: Vec<[f64; 3]> =
            (0..7).map(|k| [f64::from(k * k % 7), f64::from(k % 3), f64::from(k * 3 % 5)]).collect();
        let tetrahedron = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d], [a, d, b], [b, d, c]];
        for (second, edges, vertices, parts) in [([0, 1, 4, 5], 1, 0, 1), ([0, 4, 5, 6], 0, 1, 2)] {
            let faces = [tetrahedron([0, 1, 2, 3]), tetrahedron(second)].concat();
            let used = 1 + faces.iter().flatten().max().unwrap();
            let model = Model::from_triangles(points[..used as usize].to_vec(), &faces).unwrap();
            let opened = prepare(&model, Weld::Never).unwrap();
            check(&opened, &model);
            assert_eq!(count(&opened, RepairKind::NonManifoldEdge), edges);
            assert!(count(&opened, RepairKind::NonManifoldVertex) >= vertices);
            assert!(opened.surfaces.len() >= parts);
        }
    }

    #[test]
    fn a_polygon_stays_in_one_piece_where_others_share_its_diagonal() {
        // A quad, and two triangles on each of its diagonals.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let tips = [[0.5, 0.5, 1.0], [0.5, 0.4, -1.0], [0.6, 0.5, 2.0], [0.4, 0.5, -2.0]];
        let faces: [&[u32]; 5] = [&[0, 1, 2, 3], &[0, 2, 4], &[2, 0, 5], &[1, 3, 6], &[3, 1, 7]];
        let model = Model::from_polygons([&points[..], &tips].concat(), faces).unwrap();
        let prepared = prepare(&model, Weld::Never).unwrap();
        check(&prepared, &model);
        let of_quad = |s: &Surface| s.corner.iter().filter(|&&c| c < 4).count();
        assert_eq!(prepared.surfaces.iter().map(of_quad).filter(|&sides| sides > 0).collect::<Vec<_>>(), [6]);
        assert!(prepared.surfaces.iter().any(|s| s.diagonal.iter().any(|&inside| inside)));
        assert_eq!(count(&prepared, RepairKind::NonManifoldEdge), 0);
    }

    #[test]
    fn a_polygon_stays_in_one_piece_where_a_triangle_covers_a_part_of_it() {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
        let faces: [&[u32]; 3] = [&[0, 1, 2], &[0, 2, 4], &[0, 1, 2, 3]];
        let model = Model::from_polygons(points.clone(), faces).unwrap();
        let prepared = prepare(&model, Weld::Never).unwrap();
        check(&prepared, &model);
        let of_quad = |s: &Surface| s.corner.iter().filter(|&&c| c >= 6).count();
        assert_eq!(prepared.surfaces.iter().map(of_quad).filter(|&sides| sides > 0).collect::<Vec<_>>(), [6]);
        assert!(prepared.left_out.is_empty());
        // A copy of the whole polygon is left out as before.
        let faces: [&[u32]; 3] = [&[0, 1, 2, 3], &[0, 2, 4], &[0, 1, 2, 3]];
        let copied = prepare(&Model::from_polygons(points, faces).unwrap(), Weld::Never).unwrap();
        assert_eq!((count(&copied, RepairKind::DuplicateFace), &copied.left_out[..]), (1, &[3, 4][..]));
    }

    #[test]
    fn copies_of_polygons_are_left_out_wherever_they_begin_and_whichever_way_they_go() {
        // A grid of squares, whose two diagonals are as long.
        let points: Vec<[f64; 3]> = (0..16).map(|v| [f64::from(v % 4), f64::from(v / 4), 0.0]).collect();
        let corner = |k: u32| 4 * (k / 3) + k % 3;
        let squares: Vec<[u32; 4]> = (0..9).map(|k| [0, 1, 5, 4].map(|v| corner(k) + v)).collect();
        let begun_elsewhere = |[a, b, c, d]: [u32; 4]| [b, c, d, a];
        let reversed = |[a, b, c, d]: [u32; 4]| [d, c, b, a];
        let ways: [&dyn Fn([u32; 4]) -> [u32; 4]; 3] = [&|face| face, &begun_elsewhere, &reversed];
        for way in ways {
            let faces: Vec<[u32; 4]> = squares.iter().copied().chain(squares.iter().map(|&face| way(face))).collect();
            let model = Model::from_polygons(points.clone(), faces).unwrap();
            let prepared = prepare(&model, Weld::Never).unwrap();
            check(&prepared, &model);
            assert_eq!(prepared.repairs, [Repair { kind: RepairKind::DuplicateFace, count: 9, first: 9 }]);
            assert_eq!((prepared.surfaces.len(), prepared.left_out.len()), (1, 18));
        }
    }

    #[test]
    fn points_on_a_slanted_line_are_no_surface_however_they_are_rounded() {
        let points: Vec<[f64; 3]> = (0..12).map(|k| [0.1, 0.7, 0.3].map(|x| x * f64::from(k))).collect();
        let faces: Vec<[u32; 3]> = (0..10).map(|k| [k, k + 1, k + 2]).collect();
        let line = Model::from_triangles(points, &faces).unwrap();
        assert_eq!(prepare(&line, Weld::Never).unwrap_err(), PrepareError::NoArea { faces: 10 });
    }

    #[test]
    fn a_moebius_strip_is_opened_where_it_cannot_be_oriented() {
        let n = 12u32;
        let points: Vec<[f64; 3]> = (0..2 * n)
            .map(|k| {
                let around = std::f64::consts::TAU * f64::from(k / 2) / f64::from(n);
                let across = if k % 2 == 0 { 0.3 } else { -0.3 };
                let radius = 1.0 + across * (0.5 * around).cos();
                [radius * around.cos(), radius * around.sin(), across * (0.5 * around).sin()]
            })
            .collect();
        let faces: Vec<[u32; 3]> = (0..n)
            .flat_map(|k| {
                let [a, b] = [2 * k, 2 * k + 1];
                let [c, d] = if k + 1 < n { [a + 2, b + 2] } else { [1, 0] };
                [[a, b, c], [b, d, c]]
            })
            .collect();
        let model = Model::from_triangles(points, &faces).unwrap();
        let opened = prepare(&model, Weld::Never).unwrap();
        check(&opened, &model);
        // It is opened where the file has it disagree, and nothing is turned.
        assert_eq!((count(&opened, RepairKind::NonOrientableEdge), count(&opened, RepairKind::FlippedFace)), (1, 0));
        assert_eq!(opened.surfaces[0].mesh.euler_characteristic(), 1);
    }

    #[test]
    fn unwelded_vertices_are_reported_and_welded_on_request() {
        let (points, faces) = sphere();
        let soup: Vec<[f64; 3]> = faces.iter().flatten().map(|&v| points[v as usize]).collect();
        let apart: Vec<[u32; 3]> = (0..faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let model = Model::from_triangles(soup, &apart).unwrap();
        let loose = prepare(&model, Weld::Never).unwrap();
        check(&loose, &model);
        assert_eq!(loose.surfaces.len(), faces.len());
        assert_eq!(count(&loose, RepairKind::Unwelded), 3 * faces.len() - points.len());
        let welded = prepare(&model, Weld::Always).unwrap();
        assert_eq!(welded.surfaces.len(), 1);
        assert_eq!(welded.surfaces[0].mesh.euler_characteristic(), 2);
        assert_eq!(count(&welded, RepairKind::Welded), 3 * faces.len() - points.len());
    }

    #[test]
    fn triangles_without_area_are_given_some_and_a_mesh_without_any_is_refused() {
        let points = [[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let flat = prepared(&points, &[[0, 1, 2], [0, 2, 3], [2, 1, 3]]);
        assert_eq!(count(&flat, RepairKind::ZeroArea), 1);
        let surface = &flat.surfaces[0];
        let metric = surface.metric();
        assert!(surface.mesh.faces().all(|f| metric.sides(&surface.mesh, f).area() > 0.0));
        let line = Model::from_triangles(points[..3].to_vec(), &[[0, 1, 2]]).unwrap();
        assert_eq!(prepare(&line, Weld::Never).unwrap_err(), PrepareError::NoArea { faces: 1 });
    }

    #[test]
    fn size_and_place_do_not_matter() {
        let (points, faces) = sphere();
        for (scale, offset) in [(1e-160, 0.0), (1e150, 0.0), (1.0, 1e6)] {
            let moved: Vec<[f64; 3]> = points.iter().map(|p| p.map(|x| scale * x + offset)).collect();
            let prepared = prepared(&moved, &faces);
            let reference = self::prepared(&points, &faces);
            let [a, b] = [&prepared, &reference].map(|p| p.surfaces[0].metric());
            let worst =
                a.lengths().iter().zip(b.lengths().iter()).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-15 * (1.0 + 1e4 * offset), "scale {scale}, offset {offset}: {worst}");
        }
    }
}
