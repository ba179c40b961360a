//! Parts of a model that are instances of one shape, as its screws and wheels are.

use std::collections::HashMap;

use super::prepare::Surface;
use crate::mesh::{EdgeId, HalfedgeData, HalfedgeId, Id, Mesh, VertexData, VertexId};
use crate::vector::{Vec3, add, cross, distance, dot, length, normal, scale, sub};

/// A motion takes one instance to another but for this share of the heights of triangles, on average by area: files say where points are to some
/// digits only.
const TOLERANCE: f64 = 3e-3;
/// And nowhere for more than this share of the longest side of a triangle.
const LARGEST_OFFSET: f64 = 0.05;
/// Areas of instances, and the lengths of their edges, are in classes as wide as this share of them, or in the next ones.
const SAME_SIZE: f64 = 0.01;
/// With so many shapes that are as large a surface is compared: of hundreds of thousands of separate triangles many are about as large.
const MOST_COMPARED: usize = 32;

/// Finds which surfaces are instances of one shape and gives each of them the numbering and the points of the first, so that what is computed of one
/// is true of all to the bit. For each surface the number of that first one: its own where none before it is of its shape.
///
/// Two surfaces are instances of one shape if from the first corner of the model on each they have the same triangles and polygons, and if a rigid
/// motion takes the points of the one to those of the other, on average as closely as three thousandths of the triangles' heights, and nowhere less
/// than a twentieth of their longest side. What is larger or smaller by more is none, nor are mirror images, unless one of them is inside out.
///
/// O(n) for n triangles in all, and as many again for each of up to 32 shapes that have as many vertices and triangles as a surface, and are as large.
///
/// ```
/// use geom::{Model, Weld, prepare, shapes, unify_instances};
///
/// let hare = shapes::hare(500);
/// let beside = |p: &[f64; 3]| [5.0 - p[1], p[0], p[2]]; // turned and moved
/// let points: Vec<[f64; 3]> = hare.points.iter().copied().chain(hare.points.iter().map(beside)).collect();
/// let count = hare.points.len() as u32;
/// let others = hare.triangles.iter().map(|corners| corners.map(|v| v + count));
/// let triangles: Vec<[u32; 3]> = hare.triangles.iter().copied().chain(others).collect();
/// let mut surfaces = prepare(&Model::from_triangles(points, &triangles)?, Weld::Never)?.surfaces;
/// assert_eq!(unify_instances(&mut surfaces), [0, 0]);
/// assert_eq!(surfaces[0].points, surfaces[1].points);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn unify_instances(surfaces: &mut [Surface]) -> Vec<usize> {
    if let [_] = surfaces {
        return vec![0];
    }
    let mut known: HashMap<Class, Vec<Shape>> = HashMap::new();
    let mut first: Vec<usize> = Vec::with_capacity(surfaces.len());
    for k in 0..surfaces.len() {
        let (before, others) = surfaces.split_at_mut(k);
        let surface = &mut others[0];
        let area = area(surface);
        let (Some(class), Some(frame)) = (Class::of(surface, area), Frame::new(&surface.points)) else {
            first.push(k);
            continue;
        };
        let mut shapes: Vec<&Shape> = class.near().filter_map(|near| known.get(&near)).flatten().collect();
        shapes.sort_unstable_by_key(|shape| shape.number);
        shapes.truncate(MOST_COMPARED);
        let instance = |shape: &&Shape| Some((shape.number, shape.instance(&before[shape.number], surface)?));
        if let Some((number, instance)) = shapes.iter().find_map(instance) {
            *surface = instance;
            first.push(number);
        } else {
            first.push(k);
            known.entry(class).or_default().push(Shape { number: k, area, frame });
        }
    }
    first
}

/// What instances of one shape have in common, but for rounding.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Class {
    vertices: usize,
    faces: usize,
    /// By their logarithms in the model's units, in which they may be too large or too small themselves.
    area: i64,
    edges: i64,
}

impl Class {
    fn of(surface: &Surface, area: f64) -> Option<Self> {
        let Surface { mesh, points, scale, .. } = surface;
        let length = |e: EdgeId| mesh.ends(e).map(|v| points[v.index()]);
        let edges: f64 = mesh.edges().map(length).map(|[p, q]| distance(p, q)).sum();
        let [area, edges] = [area.ln() - 2.0 * scale.ln(), edges.ln() - scale.ln()].map(|x| (x / SAME_SIZE).floor());
        let class =
            || Self { vertices: mesh.vertex_count(), faces: mesh.face_count(), area: area as i64, edges: edges as i64 };
        (area.is_finite() && edges.is_finite()).then(class)
    }

    /// Those that rounding may have made of the same.
    fn near(self) -> impl Iterator<Item = Self> {
        let steps = |of: i64| [of, of - 1, of + 1];
        steps(self.area).into_iter().flat_map(move |area| steps(self.edges).map(|edges| Self { area, edges, ..self }))
    }
}

/// A surface that is not of the shape of one before it.
struct Shape {
    number: usize,
    /// In unit size.
    area: f64,
    frame: Frame,
}

impl Shape {
    /// Another surface as an instance of this one, if it is that.
    fn instance(&self, surface: &Surface, other: &Surface) -> Option<Surface> {
        let Surface { mesh, diagonal, .. } = surface;
        let (same, vertex) = isomorphism([mesh, &other.mesh], [surface, other].map(first_halfedge))?;
        if mesh.edges().any(|e| diagonal[e] != other.diagonal[other.mesh.edge(same[mesh.halfedge(e)])]) {
            return None;
        }
        let frame = Frame::through(&other.points, self.frame.vertices.map(|v| vertex[VertexId::new(v)].index()))?;
        // Inside out they may be mirror images: the same but for which way the third axis goes.
        [1.0, -1.0].into_iter().find(|&side| self.is_near(surface, other, &vertex, (&frame, side)))?;
        Some(Surface {
            vertex: vertex.iter().map(|&v| other.vertex[v]).collect(),
            corner: same.iter().map(|&h| other.corner[h]).collect(),
            triangle: mesh.faces().map(|f| other.triangle[other.mesh.face(same[mesh.sides(f)[0]])]).collect(),
            ..surface.clone()
        })
    }

    /// Whether vertices are where they would be if the surfaces were of one shape.
    fn is_near(
        &self,
        Surface { mesh, points, scale: unit, .. }: &Surface,
        other: &Surface,
        vertex: &VertexData<VertexId>,
        (frame, side): (&Frame, f64),
    ) -> bool {
        let offset = |(v, w): (VertexId, &VertexId)| {
            let [x, y, z] = scale(frame.coordinates(other.points[w.index()]), unit / other.scale);
            distance(self.frame.coordinates(points[v.index()]), [x, y, side * z])
        };
        let offsets: VertexData<f64> = vertex.iter_ids().map(offset).collect();
        let mut sum = 0.0;
        for f in mesh.faces() {
            let corners = mesh.corners(f);
            let side = |k: usize| distance(points[corners[k].index()], points[corners[(k + 1) % 3].index()]);
            let longest = side(0).max(side(1)).max(side(2));
            let offset = corners.iter().map(|&v| offsets[v]).fold(0.0, f64::max);
            if offset > LARGEST_OFFSET * longest {
                return false;
            }
            sum += 0.5 * offset * longest;
        }
        sum <= TOLERANCE * self.area
    }
}

/// The halfedge that starts at the first corner of the model that is on a surface, in the first triangle there.
fn first_halfedge(Surface { mesh, corner, triangle, .. }: &Surface) -> HalfedgeId {
    mesh.halfedges().min_by_key(|&h| (corner[h], triangle[mesh.face(h)])).expect("a surface has triangles")
}

/// For each halfedge and vertex of a triangulation that of another one with as many, given a halfedge of each that are the same; none if the
/// triangulations are not.
fn isomorphism(
    [one, other]: [&Mesh; 2],
    start: [HalfedgeId; 2],
) -> Option<(HalfedgeData<HalfedgeId>, VertexData<VertexId>)> {
    let mut same = HalfedgeData::constant(one.halfedge_count(), None);
    let mut same_vertex = VertexData::constant(one.vertex_count(), None);
    let mut next = vec![start.into()];
    while let Some((h, g)) = next.pop() {
        if let Some(known) = same[h] {
            if known != g {
                return None;
            }
            continue;
        }
        let (mut h, mut g) = (h, g);
        for _ in 0..3 {
            same[h] = Some(g);
            if *same_vertex[one.tail(h)].get_or_insert(other.tail(g)) != other.tail(g) {
                return None;
            }
            match (one.twin(h), other.twin(g)) {
                (None, None) => {}
                (Some(h), Some(g)) => next.push((h, g)),
                _ => return None,
            }
            (h, g) = (one.next(h), other.next(g));
        }
    }
    let same = same.iter().copied().collect::<Option<_>>()?;
    Some((same, same_vertex.iter().copied().collect::<Option<_>>()?))
}

/// Three axes at right angles that go where the surface goes.
struct Frame {
    /// The vertices that they are drawn through: far from the middle, and from the line to the first.
    vertices: [usize; 2],
    middle: Vec3,
    axes: [Vec3; 3],
}

impl Frame {
    /// None where all points are on a line.
    fn new(points: &[Vec3]) -> Option<Self> {
        let middle = middle(points);
        let farthest =
            |of: &dyn Fn(Vec3) -> f64| (0..points.len()).max_by(|&v, &w| of(points[v]).total_cmp(&of(points[w])));
        let one = farthest(&|p| distance(p, middle))?;
        let axis = sub(points[one], middle);
        let other = farthest(&|p| length(cross(axis, sub(p, middle))))?;
        Self::through(points, [one, other])
    }

    fn through(points: &[Vec3], vertices: [usize; 2]) -> Option<Self> {
        let middle = middle(points);
        let [one, other] = vertices.map(|v| sub(points[v], middle));
        let across = cross(one, other);
        let axes = [one, cross(across, one), across].map(|axis| scale(axis, length(axis).recip()));
        axes.as_flattened().iter().all(|x| x.is_finite()).then_some(Self { vertices, middle, axes })
    }

    fn coordinates(&self, p: Vec3) -> Vec3 {
        self.axes.map(|axis| dot(axis, sub(p, self.middle)))
    }
}

fn middle(points: &[Vec3]) -> Vec3 {
    let sum = points.iter().fold([0.0; 3], |sum, &p| add(sum, p));
    scale(sum, (points.len() as f64).recip())
}

fn area(Surface { mesh, points, .. }: &Surface) -> f64 {
    mesh.faces().map(|f| 0.5 * length(normal(mesh.corners(f).map(|v| points[v.index()])))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Model, Weld, prepare, shapes};

    /// The surfaces of a hare and of others made of its points, their triangles reversed or not.
    fn beside(others: &[(&dyn Fn(Vec3) -> Vec3, bool)]) -> Vec<Surface> {
        let hare = shapes::hare(400);
        let count = hare.points.len() as u32;
        let (mut points, mut triangles) = (hare.points.clone(), Vec::new());
        triangles.extend_from_slice(&hare.triangles);
        for ((place, is_reversed), k) in others.iter().zip(1..) {
            points.extend(hare.points.iter().map(|&p| place(p)));
            let turned = |[a, b, c]: [u32; 3]| if *is_reversed { [a, c, b] } else { [a, b, c] };
            triangles.extend(hare.triangles.iter().map(|triangle| turned(triangle.map(|v| v + k * count))));
        }
        prepare(&Model::from_triangles(points, &triangles).unwrap(), Weld::Never).unwrap().surfaces
    }

    #[test]
    fn what_is_moved_turned_or_mirrored_inside_out_is_an_instance_and_what_is_scaled_or_bent_is_none() {
        let (cos, sin) = (0.8, 0.6);
        let turned = |[x, y, z]: Vec3| [9.0 + cos * x - sin * y, sin * x + cos * y, z - 7.0];
        let mirrored = |[x, y, z]: Vec3| [-9.0 - x, y, z];
        let larger = |[x, y, z]: Vec3| [30.0 + 1.1 * x, 1.1 * y, 1.1 * z];
        let hardly_bent = |[x, y, z]: Vec3| [x + 1e-6 * (100.0 * y).sin(), y + 20.0, z];
        let bent = |[x, y, z]: Vec3| [x + 0.05 * y * y, y + 40.0, z];
        let mut surfaces = beside(&[
            (&turned, false),
            (&mirrored, false),
            (&larger, false),
            (&hardly_bent, false),
            (&bent, false),
            (&mirrored, true),
        ]);
        let before = surfaces.clone();
        assert_eq!(unify_instances(&mut surfaces), [0, 0, 0, 3, 0, 5, 6]);
        for k in [3, 5, 6] {
            assert_eq!((&surfaces[k].points, &surfaces[k].mesh), (&before[k].points, &before[k].mesh));
        }
    }

    #[test]
    fn instances_keep_their_way_back_to_the_model_under_any_numbers() {
        let hare = shapes::hare(400);
        let count = hare.points.len() as u32;
        // The second hare's vertices run the other way, and the corners of its triangles begin elsewhere, but for the first.
        let number = |v: u32| 2 * count - 1 - v;
        let mut points = hare.points.clone();
        points.extend(hare.points.iter().rev().map(|p| [p[0] + 5.0, p[1], p[2]]));
        let mut triangles = hare.triangles.clone();
        for k in 0..triangles.len() {
            let mut other = triangles[k].map(number);
            other.rotate_left(if k == 0 { 0 } else { k % 3 });
            triangles.push(other);
        }
        let model = Model::from_triangles(points, &triangles).unwrap();
        let mut surfaces = prepare(&model, Weld::Never).unwrap().surfaces;
        assert_ne!(surfaces[0].mesh, surfaces[1].mesh);
        assert_eq!(unify_instances(&mut surfaces), [0, 0]);
        let [one, other] = &surfaces[..] else { panic!("two hares") };
        assert_eq!((&one.mesh, &one.points), (&other.mesh, &other.points));
        for v in one.mesh.vertices() {
            assert_eq!(other.vertex[v], number(one.vertex[v]));
        }
        for h in one.mesh.halfedges() {
            assert_eq!(model.corners()[other.corner[h] as usize], other.vertex[other.mesh.tail(h)]);
            assert_eq!(other.corner[h] / 3, other.triangle[other.mesh.face(h)]);
        }
    }

    #[test]
    fn a_spike_makes_another_shape_however_many_triangles_there_are() {
        let sphere = shapes::by_name("sphere", 6000).unwrap();
        let count = sphere.points.len() as u32;
        let mut points = sphere.points.clone();
        points.extend(sphere.points.iter().map(|p| [p[0] + 5.0, p[1], p[2]]));
        let others = sphere.triangles.iter().map(|corners| corners.map(|v| v + count));
        let triangles: Vec<[u32; 3]> = sphere.triangles.iter().copied().chain(others).collect();
        let shapes_of = |points: Vec<Vec3>| {
            let model = Model::from_triangles(points, &triangles).unwrap();
            unify_instances(&mut prepare(&model, Weld::Never).unwrap().surfaces)
        };
        assert_eq!(shapes_of(points.clone()), [0, 0]);
        points[count as usize + 77][1] += 0.02;
        assert_eq!(shapes_of(points), [0, 1]);
    }

    #[test]
    fn what_has_other_polygons_is_no_instance() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let points: Vec<Vec3> = (0..3).flat_map(|k| square.map(|p| [p[0] + 2.0 * f64::from(k), p[1], p[2]])).collect();
        let polygons: [&[u32]; 4] = [&[0, 1, 2, 3], &[4, 5, 6], &[4, 6, 7], &[8, 9, 10, 11]];
        let model = Model::from_polygons(points, polygons).unwrap();
        let mut surfaces = prepare(&model, Weld::Never).unwrap().surfaces;
        assert_eq!(unify_instances(&mut surfaces), [0, 1, 0]);
    }
}
