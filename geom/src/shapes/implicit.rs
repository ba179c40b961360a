//! Solids given by a function that is negative inside, and the triangles of their surface.
//!
//! A cubic lattice is cut into tetrahedra, six a cell round its diagonal, and the surface in each tetrahedron is that of
//! the linear function (Doi and Koide 1991): a manifold without boundary, whatever the function, as long as it is
//! positive at the lattice's rim. Its triangles are poor; what comes from here is remeshed. The lattice decides about
//! the topology, the length asked for afterwards does not.

use std::collections::HashMap;

use super::remesh::remesh;
use super::{Shape, edge_length};
use crate::vector::{Vec3, add, distance, dot, length, step, sub};

/// How many more vertices a remeshed surface has than one of equilateral triangles of that length (measured).
const REMESHED: f64 = 1.13;

/// The surface of a solid within a box, with about so many vertices, the topology as seen by cells of a given size.
pub(super) fn surface(solid: impl Fn(Vec3) -> f64, bounds: [Vec3; 2], cell: f64, vertices: usize) -> Shape {
    let marched = march(&solid, bounds, cell);
    let length = edge_length(REMESHED * marched.area(), vertices);
    remesh(marched, length, |p| project(&solid, p, cell))
}

/// The ellipsoid with a centre and half axes; the distance to it is right to first order.
pub(super) fn ellipsoid(center: Vec3, axes: Vec3, p: Vec3) -> f64 {
    let q = sub(p, center);
    let once = [0, 1, 2].map(|k| q[k] / axes[k]);
    let twice = [0, 1, 2].map(|k| once[k] / axes[k]);
    let (radius, slope) = (length(once), length(twice));
    if slope == 0.0 { -axes[0].min(axes[1]).min(axes[2]) } else { radius * (radius - 1.0) / slope }
}

/// A limb: balls along a segment, whose radius is the given one at its start, middle and end and quadratic in between.
pub(super) fn limb(ends: [Vec3; 2], [first, middle, last]: [f64; 3], p: Vec3) -> f64 {
    let axis = sub(ends[1], ends[0]);
    let t = (dot(sub(p, ends[0]), axis) / dot(axis, axis)).clamp(0.0, 1.0);
    let swell = 4.0 * middle - 2.0 * (first + last);
    let radius = first + t * (last - first) + t * (1.0 - t) * swell;
    distance(p, step(ends[0], t, axis)) - radius
}

/// The union of two solids, rounded off where their distances differ by less than `width` (the quadratic smooth minimum).
pub(super) fn blend(a: f64, b: f64, width: f64) -> f64 {
    let overlap = (width - (a - b).abs()).max(0.0);
    a.min(b) - overlap * overlap / (4.0 * width)
}

/// Moves a point near the surface onto it: Newton along the gradient, which is taken by differences. Where
/// there is none to speak of it does not go further than about `limit`.
fn project(solid: &impl Fn(Vec3) -> f64, mut p: Vec3, limit: f64) -> Vec3 {
    let h = 0.01 * limit;
    for _ in 0..3 {
        let value = solid(p);
        let gradient = [0, 1, 2].map(|k| {
            let mut ahead = p;
            ahead[k] += h;
            (solid(ahead) - value) / h
        });
        let square = dot(gradient, gradient);
        if value.abs() < 1e-3 * h {
            break;
        }
        p = step(p, (-value / square).clamp(-limit, limit), gradient);
    }
    p
}

fn march(solid: &impl Fn(Vec3) -> f64, bounds: [Vec3; 2], cell: f64) -> Shape {
    let counts = [0, 1, 2].map(|k| ((bounds[1][k] - bounds[0][k]) / cell).ceil() as usize + 1);
    let index = |[i, j, k]: [usize; 3]| (k * counts[1] + j) * counts[0] + i;
    let place = |at: usize| {
        let ijk = [at % counts[0], at / counts[0] % counts[1], at / (counts[0] * counts[1])];
        add(bounds[0], ijk.map(|i| i as f64 * cell))
    };
    let values: Vec<f64> = (0..counts.iter().product()).map(|at| solid(place(at))).collect();
    let mut crossings = Crossings { values: &values, place, shape: Shape::default(), vertex_on: HashMap::new() };
    for k in 0..counts[2] - 1 {
        for j in 0..counts[1] - 1 {
            for i in 0..counts[0] - 1 {
                for (order, even) in AXIS_ORDERS {
                    let mut corner = [i, j, k];
                    let path = [None, Some(order[0]), Some(order[1]), Some(order[2])].map(|axis| {
                        axis.into_iter().for_each(|a: usize| corner[a] += 1);
                        index(corner)
                    });
                    crossings.tetrahedron(path, even);
                }
            }
        }
    }
    crossings.shape
}

/// The ways along a cell's edges from its lowest to its highest corner: each passes the corners of one tetrahedron, in
/// positive order if it is even.
const AXIS_ORDERS: [([usize; 3], bool); 6] = [
    ([0, 1, 2], true),
    ([1, 2, 0], true),
    ([2, 0, 1], true),
    ([0, 2, 1], false),
    ([2, 1, 0], false),
    ([1, 0, 2], false),
];

/// The surface as found so far, with a vertex on each lattice edge that it crosses.
struct Crossings<'a, P> {
    values: &'a [f64],
    place: P,
    shape: Shape,
    vertex_on: HashMap<[usize; 2], u32>,
}

impl<P: Fn(usize) -> Vec3> Crossings<'_, P> {
    fn is_inside(&self, at: usize) -> bool {
        self.values[at] < 0.0
    }

    fn tetrahedron(&mut self, mut corners: [usize; 4], mut even: bool) {
        // Inside first, by swaps of neighbours, each of which turns the orientation over.
        for last in (1..4).rev() {
            for k in 0..last {
                if !self.is_inside(corners[k]) && self.is_inside(corners[k + 1]) {
                    corners.swap(k, k + 1);
                    even = !even;
                }
            }
        }
        let [a, b, c, d] = corners;
        match corners.iter().filter(|&&at| self.is_inside(at)).count() {
            1 => self.triangle([[a, b], [a, c], [a, d]], even),
            2 => {
                self.triangle([[a, c], [a, d], [b, d]], even);
                self.triangle([[a, c], [b, d], [b, c]], even);
            }
            3 => self.triangle([[a, d], [b, d], [c, d]], even),
            _ => {}
        }
    }

    fn triangle(&mut self, edges: [[usize; 2]; 3], even: bool) {
        let [a, b, c] = edges.map(|edge| self.vertex(edge));
        self.shape.triangles.push(if even { [a, b, c] } else { [a, c, b] });
    }

    fn vertex(&mut self, [inside, outside]: [usize; 2]) -> u32 {
        let (values, place, points) = (self.values, &self.place, &mut self.shape.points);
        *self.vertex_on.entry([inside, outside]).or_insert_with(|| {
            let t = values[inside] / (values[inside] - values[outside]);
            points.push(step(place(inside), t, sub(place(outside), place(inside))));
            points.len() as u32 - 1
        })
    }
}
