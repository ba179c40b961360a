//! Small holes of a surface, and the surface with them closed by *caps*.
//!
//! Scans have holes where the scanner saw nothing, and each is a boundary loop that seams must reach and that takes curvature as it comes. A hole is
//! *small* if its loop is short for its surface: shorter than some roots of the area, whatever the unit. A flat sheet's own boundary never is below
//! 2√π = 3.54 of them, which a disk has (the isoperimetric inequality); seams are told in the same unit. A hole is a gap in a surface that goes on there: an open
//! end, of a spike or a tube, is none.
//!
//! A cap has the loop's vertices and no others: n - 2 triangles, the ears of the polygon ([`Model::triangles`](super::Model::triangles) cuts faces
//! so), with the lengths that its chords have in space. What is computed on it flips to the intrinsic Delaunay triangulation anyway. A chord may run
//! beside an edge of the surface from the same vertex to the same vertex: a [`Mesh`] glues halfedges, not pairs of vertices. A loop of two edges is
//! closed by gluing them to each other. So all vertices, halfedges and triangles of the surface keep their numbers, and those of caps follow; edges
//! get others.
//!
//! Where a loop comes by a place again, two holes touch, or the two sides of a slit: the surface has the vertex there twice, a fan of triangles each. The
//! copies are drawn apart by a hair, each into its own fan, and a chord joins them, so that each hole, each rung of the slit, is cut by itself. So all angles
//! round both copies are those of two vertices. (At one place they would be those of one, 2π too little.)

use std::collections::HashMap;
use std::f64::consts::PI;

use super::model::place_key;
use super::triangulate::cut_polygon;
use crate::intrinsic::Metric;
use crate::mesh::{EdgeData, HalfedgeId, Id, Mesh, VertexId};
use crate::vector::{Vec3, add, angle, distance, length, scale, sub};

/// How many pairs of corners are compared on a surface before ears are clipped untested: less than a second.
const WORK: u64 = 1 << 26;
/// Copies of a vertex are drawn apart by this share of the shortest edge at each.
const HAIR: f64 = 1e-3;

/// A hole whose cap would hold more curvature, either way, is the open end of something, as at the tip of a spike: of holes that are known to be ones it is up
/// to .28 π (`bunny_zipper`; .1 π on heads that were cut out of and on a sieve).
const MOST_CURVATURE: f64 = 0.5 * PI;

/// The boundary loops of a surface that are no longer than `size` roots of its area and round holes: each as its halfedges in order. What curvature
/// filling a loop adds, 2π less what it turns, is up to a quarter turn; at an open end it is more, which the loop takes without a cone as long as
/// it is open. O(F).
pub fn small_holes(mesh: &Mesh, metric: &Metric, size: f64) -> Vec<Vec<HalfedgeId>> {
    let longest = size * metric.area(mesh).sqrt();
    let mut holes = mesh.boundary_loops();
    holes.retain(|around| {
        let along: f64 = around.iter().map(|&h| metric.length(mesh.edge(h))).sum();
        around.len() > 1 && along <= longest && curvature_within(mesh, metric, around).abs() <= MOST_CURVATURE
    });
    holes
}

/// The curvature of a cap with its rim: angles of n - 2 triangles are added to those that there are (Gauss–Bonnet).
fn curvature_within(mesh: &Mesh, metric: &Metric, around: &[HalfedgeId]) -> f64 {
    let angle = |h: &HalfedgeId| mesh.outgoing(mesh.tail(*h)).map(|side| metric.angle(mesh, side)).sum::<f64>();
    2.0 * PI + around.iter().map(|h| PI - angle(h)).sum::<f64>()
}

/// A surface closed by a cap at each of some of its boundary loops, with its edge lengths: those that there were, lengthened by a hair where caps have no area.
/// Linear but for ears.
///
/// ```
/// use geom::{Metric, fill_holes, shapes, small_holes};
///
/// let disk = shapes::disk(300);
/// let (mesh, metric) = (disk.mesh(), Metric::from_points(&disk.mesh(), &disk.points));
/// assert!(small_holes(&mesh, &metric, f64::INFINITY).is_empty(), "its rim is an open end");
/// let (closed, _) = fill_holes(&mesh, &metric, &disk.points, &mesh.boundary_loops());
/// assert_eq!((closed.vertex_count(), closed.euler_characteristic()), (mesh.vertex_count(), 2));
/// # Ok::<(), geom::MeshError>(())
/// ```
///
/// # Panics
/// If one of them is no boundary loop.
pub fn fill_holes(mesh: &Mesh, metric: &Metric, points: &[[f64; 3]], holes: &[Vec<HalfedgeId>]) -> (Mesh, Metric) {
    let mut filling = Filling {
        tail: mesh.halfedges().map(|h| mesh.tail(h)).collect(),
        twin: mesh.halfedges().map(|h| mesh.twin(h).map_or(u32::MAX, |g| g.0)).collect(),
    };
    let mut work = WORK;
    let apart = drawn_apart(mesh, points, holes);
    for around in holes {
        // Against the surface, so that it is on the left of the polygon's sides' twins.
        let corners: Vec<VertexId> = around.iter().rev().map(|&h| mesh.head(h)).collect();
        let places = |points: &[Vec3]| corners.iter().map(|v| points[v.index()]).collect::<Vec<Vec3>>();
        match around[..] {
            [h, g] => filling.glue(h.0, g.0),
            _ => filling.cap(around, &corners, cut_loop(&places(points), &places(&apart), &mut work)),
        }
    }
    let filled = Mesh::from_twins(mesh.vertex_count(), filling.tail, filling.twin)
        .expect("a vertex of a boundary is on one loop, so that it still has one fan");
    let metric = lengths(mesh, metric, [points, &apart], &filled);
    (filled, metric)
}

/// The points, those that a loop comes by again drawn apart.
fn drawn_apart(mesh: &Mesh, points: &[Vec3], holes: &[Vec<HalfedgeId>]) -> Vec<Vec3> {
    let mut apart = points.to_vec();
    for around in holes {
        let mut times: HashMap<_, u32> = HashMap::new();
        let place = |h: &HalfedgeId| place_key(&points[mesh.tail(*h).index()]);
        around.iter().for_each(|h| *times.entry(place(h)).or_default() += 1);
        for h in around.iter().filter(|h| times[&place(h)] > 1) {
            let v = mesh.tail(*h);
            apart[v.index()] = drawn_in(mesh, points, v);
        }
    }
    apart
}

/// A vertex of the boundary drawn into its fan, on the triangle where half of its angle is reached, towards there.
fn drawn_in(mesh: &Mesh, points: &[Vec3], v: VertexId) -> Vec3 {
    let at = points[v.index()];
    let to = |w: VertexId| sub(points[w.index()], at);
    // The two sides of each triangle at the vertex, and the angle between them.
    let corner = |h: HalfedgeId| [to(mesh.head(h)), to(mesh.tail(mesh.prev(h)))];
    let corners: Vec<([Vec3; 2], f64)> =
        mesh.outgoing(v).map(corner).map(|sides| (sides, angle(sides[0], sides[1]))).collect();
    let shortest = corners.iter().flat_map(|(sides, _)| sides).map(|&side| length(side)).fold(f64::INFINITY, f64::min);
    let mut left = 0.5 * corners.iter().map(|(_, angle)| angle).sum::<f64>();
    for ([a, b], angle) in corners {
        if left <= angle {
            let [from, to] = [(angle - left).sin() / length(a), left.sin() / length(b)];
            let inward = add(scale(a, from), scale(b, to));
            let reach = length(inward);
            return if reach > 0.0 { add(at, scale(inward, HAIR * shortest / reach)) } else { at };
        }
        left -= angle;
    }
    at
}

/// The triangles of a loop of three places and more, which are drawn `apart` where it comes by one again.
fn cut_loop(places: &[Vec3], apart: &[Vec3], work: &mut u64) -> Vec<[usize; 3]> {
    let mut triangles = Vec::with_capacity(places.len() - 2);
    let mut cut = |polygon: &[usize]| {
        let points: Vec<Vec3> = polygon.iter().map(|&i| apart[i]).collect();
        triangles.extend(cut_polygon(&points, work).into_iter().map(|corners| corners.map(|k| polygon[k])));
    };
    // The way so far, but for what was cut off at places that it came by again, and where each place is on it.
    let (mut way, mut position) = (Vec::new(), HashMap::new());
    for (i, place) in places.iter().enumerate() {
        way.push(i);
        if let Some(before) = position.insert(place_key(place), way.len() - 1)
            && before + 2 < way.len()
        {
            cut(&way[before..]);
            way[before + 1..way.len() - 1].iter().for_each(|&i| _ = position.remove(&place_key(&places[i])));
            way.drain(before + 1..way.len() - 1);
            position.insert(place_key(place), way.len() - 1);
        }
    }
    if way.len() > 2 {
        cut(&way);
    }
    triangles
}

/// Triangles with the halfedges glued that are so far.
struct Filling {
    tail: Vec<VertexId>,
    twin: Vec<u32>,
}

impl Filling {
    fn glue(&mut self, h: u32, g: u32) {
        self.twin[h as usize] = g;
        self.twin[g as usize] = h;
    }

    /// Closes a loop by triangles of its corners, which are listed against it.
    fn cap(&mut self, around: &[HalfedgeId], corners: &[VertexId], triangles: Vec<[usize; 3]>) {
        let count = corners.len();
        let mut open = HashMap::new();
        for triangle in triangles {
            let first = self.tail.len() as u32;
            self.tail.extend(triangle.map(|i| corners[i]));
            self.twin.extend([u32::MAX; 3]);
            for k in 0..3 {
                let (i, j, h) = (triangle[k], triangle[(k + 1) % 3], first + k as u32);
                match open.remove(&(j, i)) {
                    _ if j == (i + 1) % count => self.glue(h, around[count - 1 - i].0),
                    Some(g) => self.glue(h, g),
                    None => _ = open.insert((i, j), h),
                }
            }
        }
    }
}

/// The lengths of a surface's edges on it when it is filled; chords are as long as in space. Of the points some were drawn apart.
fn lengths(mesh: &Mesh, metric: &Metric, [points, apart]: [&[Vec3]; 2], filled: &Mesh) -> Metric {
    let mut lengths: EdgeData<f64> = Metric::from_points(filled, apart).lengths().clone();
    for h in mesh.halfedges() {
        let [v, w] = [mesh.tail(h), mesh.head(h)].map(Id::index);
        let drawn = distance(apart[v], apart[w]) - distance(points[v], points[w]);
        lengths[filled.edge(h)] = metric.length(mesh.edge(h)) + drawn;
    }
    let metric = Metric::new(lengths);
    let caps = filled.faces().skip(mesh.face_count());
    let has_area = |f| metric.sides(filled, f).area() > 0.0;
    if { caps }.all(has_area) { metric } else { metric.mollified(filled, Metric::MOLLIFICATION) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::shapes::{self, Shape};
    use crate::surface::{Model, Weld, prepare};

    /// A shape without the triangles at some vertices, its own vertices at each corner of the others where `are_apart`.
    fn pierced(shape: &Shape, at: &[u32]) -> (Mesh, Vec<[f64; 3]>) {
        let left: Vec<[u32; 3]> =
            shape.triangles.iter().filter(|t| !t.iter().any(|v| at.contains(v))).copied().collect();
        let surface = prepare(&Model::from_triangles(shape.points.clone(), &left).unwrap(), Weld::Auto).unwrap();
        let surface = surface.surfaces.into_iter().next().expect("it has one part");
        (surface.mesh, surface.points)
    }

    /// Fills all holes and checks what is always true of that.
    fn filled(mesh: &Mesh, points: &[[f64; 3]]) -> (Mesh, Metric) {
        let metric = Metric::from_points(mesh, points);
        let holes = mesh.boundary_loops();
        let (closed, lengths) = fill_holes(mesh, &metric, points, &holes);
        closed.check();
        assert!(closed.boundary_loops().is_empty());
        assert_eq!(closed.euler_characteristic(), mesh.euler_characteristic() + holes.len() as i64);
        assert!(mesh.halfedges().all(|h| closed.tail(h) == mesh.tail(h)), "halfedges keep their numbers");
        let of_caps: usize = holes.iter().map(|around| around.len() - 2).sum();
        assert_eq!(closed.face_count(), mesh.face_count() + of_caps, "caps have no vertices of their own");
        assert!(closed.faces().all(|f| lengths.sides(&closed, f).area() > 0.0));
        (closed, lengths)
    }

    #[test]
    fn the_cap_of_a_flat_hole_is_flat() {
        let grid = shapes::by_name("disk", 900).unwrap();
        let middle = (0..grid.points.len() as u32)
            .min_by(|&v, &w| {
                crate::vector::length(grid.points[v as usize])
                    .total_cmp(&crate::vector::length(grid.points[w as usize]))
            })
            .unwrap();
        let (mesh, points) = pierced(&grid, &[middle]);
        let metric = Metric::from_points(&mesh, &points);
        let holes = small_holes(&mesh, &metric, 1.0);
        assert_eq!(holes.len(), 1, "the disk's own boundary is none");
        let (closed, lengths) = fill_holes(&mesh, &metric, &points, &holes);
        let sums = lengths.angle_sums(&closed);
        assert!(closed.vertices().all(|v| closed.is_boundary_vertex(v) || (sums[v] - TAU).abs() < 1e-9));
    }

    #[test]
    fn an_open_end_is_no_hole() {
        let ball = shapes::sphere(300);
        let below: Vec<u32> = (0..ball.points.len() as u32).filter(|&v| ball.points[v as usize][2] < 0.0).collect();
        for (mesh, points) in [pierced(&ball, &below), (shapes::disk(300).mesh(), shapes::disk(300).points)] {
            assert!(small_holes(&mesh, &Metric::from_points(&mesh, &points), f64::INFINITY).is_empty());
        }
    }

    #[test]
    fn holes_that_touch_are_filled_each_for_itself() {
        // Of a flat sheet the squares at two corners of one are taken out: the vertex between them has two fans.
        let at = |x: u32, y: u32| 6 * y + x;
        let points: Vec<[f64; 3]> = (0..36).map(|v| [f64::from(v % 6), f64::from(v / 6), 0.0]).collect();
        let squares = (0..25).map(|k| (k % 5, k / 5)).filter(|square| ![(1, 1), (2, 2)].contains(square));
        let triangles: Vec<[u32; 3]> = squares
            .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
            .collect();
        let surface = prepare(&Model::from_triangles(points, &triangles).unwrap(), Weld::Auto).unwrap();
        let surface = &surface.surfaces[0];
        let metric = surface.metric();
        let holes = small_holes(&surface.mesh, &metric, 2.0);
        assert_eq!(holes.iter().map(Vec::len).collect::<Vec<_>>(), [8], "one loop, which comes by a place twice");
        let (closed, lengths) = fill_holes(&surface.mesh, &metric, &surface.points, &holes);
        closed.check();
        let sums = lengths.angle_sums(&closed);
        let bent = closed.vertices().filter(|&v| !closed.is_boundary_vertex(v)).map(|v| (sums[v] - TAU).abs());
        assert!(bent.fold(0.0, f64::max) < 1e-2, "the two fans together have the angle of two vertices");
    }

    #[test]
    fn a_slit_is_closed_as_if_it_had_never_been() {
        // A strip of squares, slit along its middle: the vertices there are there twice.
        let [width, across] = [7_u32, 3];
        let at = |x: u32, y: u32| y * width + x;
        let mut points: Vec<[f64; 3]> =
            (0..width * across).map(|v| [f64::from(v % width), f64::from(v / width), 0.0]).collect();
        let copies: Vec<u32> = (2..5).map(|x| width * across + x - 2).collect();
        points.extend((2..5).map(|x| [f64::from(x), 1.0, 0.0]));
        let upper = |x: u32| if (2..5).contains(&x) { copies[x as usize - 2] } else { at(x, 1) };
        let triangles: Vec<[u32; 3]> = (0..width - 1)
            .flat_map(|x| {
                let square = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
                let low = square([at(x, 0), at(x + 1, 0), at(x + 1, 1), at(x, 1)]);
                let high = square([upper(x), upper(x + 1), at(x + 1, 2), at(x, 2)]);
                [low, high].concat()
            })
            .collect();
        let surface = prepare(&Model::from_triangles(points, &triangles).unwrap(), Weld::Never).unwrap();
        let surface = &surface.surfaces[0];
        let metric = surface.metric();
        let holes = small_holes(&surface.mesh, &metric, 2.5);
        assert_eq!(holes.iter().map(Vec::len).collect::<Vec<_>>(), [8]);
        let (closed, lengths) = fill_holes(&surface.mesh, &metric, &surface.points, &holes);
        let sums = lengths.angle_sums(&closed);
        let bent = closed.vertices().filter(|&v| !closed.is_boundary_vertex(v)).map(|v| (sums[v] - TAU).abs());
        assert!(bent.fold(0.0, f64::max) < 1e-2, "it is flat");
    }

    #[test]
    fn a_slit_with_bends_is_closed_as_if_it_had_never_been() {
        // Of a flat sheet of squares, whose diagonals go one way or the other, slit like a Z: one fan at each bend has three quarters of a turn.
        let slit: [(u32, u32); 4] = [(3, 5), (4, 5), (4, 6), (5, 6)];
        for is_mirrored in [false, true] {
            let mut points: Vec<[f64; 3]> = (0..121).map(|v| [f64::from(v % 11), f64::from(v / 11), 0.0]).collect();
            points.extend([[4.0, 5.0, 0.0], [4.0, 6.0, 0.0]]);
            // The copies are of those below, and to the right of, the slit.
            let right = |(x, y): (u32, u32), middle: [f64; 2]| match (x, y) {
                _ if (x, y) == slit[1] && (middle[0] > 4.0 || middle[1] < 5.0) => 121,
                _ if (x, y) == slit[2] && middle[0] > 4.0 && middle[1] < 6.0 => 122,
                _ => 11 * y + x,
            };
            let mut triangles = Vec::new();
            for (x, y) in (0..100).map(|k| (k % 10, k / 10)) {
                let middle = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                let at = |dx: u32, dy: u32| right((x + dx, y + dy), middle);
                let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                triangles.extend(if is_mirrored { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] });
            }
            let surface = prepare(&Model::from_triangles(points, &triangles).unwrap(), Weld::Never).unwrap();
            let surface = &surface.surfaces[0];
            let metric = surface.metric();
            let holes = small_holes(&surface.mesh, &metric, 2.0);
            assert_eq!(holes.iter().map(Vec::len).collect::<Vec<_>>(), [6]);
            let (closed, lengths) = fill_holes(&surface.mesh, &metric, &surface.points, &holes);
            let sums = lengths.angle_sums(&closed);
            let bent = closed.vertices().filter(|&v| !closed.is_boundary_vertex(v)).map(|v| (sums[v] - TAU).abs());
            let bent = bent.fold(0.0, f64::max);
            assert!(bent < 1e-6, "it is flat, but for {bent}");
        }
    }

    #[test]
    fn holes_in_all_sorts_of_surfaces_are_filled() {
        for (name, count) in [("hare", 900), ("part", 900), ("sphere", 300)] {
            let shape = shapes::by_name(name, count).unwrap();
            for stride in [3, 7, 40] {
                let at: Vec<u32> = (0..shape.points.len() as u32).step_by(stride).collect();
                let left = |t: &&[u32; 3]| !t.iter().any(|v| at.contains(v));
                let left: Vec<[u32; 3]> = shape.triangles.iter().filter(left).copied().collect();
                let Ok(model) = Model::from_triangles(shape.points.clone(), &left) else { continue };
                let Ok(prepared) = prepare(&model, Weld::Auto) else { continue };
                prepared.surfaces.iter().for_each(|surface| _ = filled(&surface.mesh, &surface.points));
            }
        }
    }

    #[test]
    fn two_edges_between_two_vertices_are_glued() {
        // A sphere opened along one edge.
        let shape = shapes::sphere(80);
        let mesh = shape.mesh();
        let h = mesh.halfedges().next().unwrap();
        let twin = |g: HalfedgeId| if mesh.edge(g) == mesh.edge(h) { u32::MAX } else { mesh.twin(g).unwrap().0 };
        let tail = mesh.halfedges().map(|g| mesh.tail(g)).collect();
        let opened = Mesh::from_twins(mesh.vertex_count(), tail, mesh.halfedges().map(twin).collect()).unwrap();
        assert_eq!(opened.boundary_loops().iter().map(Vec::len).collect::<Vec<_>>(), [2]);
        let (closed, lengths) = filled(&opened, &shape.points);
        assert_eq!((closed.face_count(), closed.edge_count()), (mesh.face_count(), mesh.edge_count()));
        assert_eq!(lengths.length(closed.edge(h)), Metric::from_points(&mesh, &shape.points).length(mesh.edge(h)));
    }

    #[test]
    fn a_long_ragged_loop_is_filled() {
        // A fan round a tip, and an edge more for each triangle, so that the loop is ragged.
        let count = 100_000_u32;
        let round = |k: u32, r: f64| {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(count)).sin_cos();
            [r * cos, r * sin, if k.is_multiple_of(2) { 0.1 } else { -0.1 } * r]
        };
        let mut points: Vec<[f64; 3]> = (0..count).map(|k| round(k, 1.0)).collect();
        points.push([0.0, 0.0, 2.0]);
        let triangles: Vec<[u32; 3]> = (0..count).map(|k| [k, (k + 1) % count, count]).collect();
        filled(&Mesh::new(points.len(), &triangles).unwrap(), &points);
    }
}
