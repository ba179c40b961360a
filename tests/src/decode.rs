//! Bytes read as small inputs: graphs, fields, surfaces.
//!
//! Any bytes are an input, a few bytes a small one, and changing one byte changes little, so that shrinking and fuzzing
//! have something to hold on to. Where bytes run out, zeros follow. What is decoded is made to hurt: equal values and
//! values one ulp apart, slivers, vertices of degree three, triangles of no area.

use geom::Mesh;
use geom::shapes::Shape;
use petgraph::graph::UnGraph;

use crate::solids;

/// Bytes that are used up from the front; then zeros.
#[derive(Clone, Debug)]
pub struct Bytes<'a> {
    rest: &'a [u8],
}

impl<'a> Bytes<'a> {
    /// Begins to read.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Whether all bytes are used up.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// All bytes that are left.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.rest.split_first() else { return 0 };
        self.rest = rest;
        first
    }

    /// One of two.
    pub fn coin(&mut self) -> bool {
        self.byte() % 2 == 1
    }

    /// A number below `count` (0 if there is none); of one byte where that is enough, otherwise of two.
    pub fn below(&mut self, count: usize) -> usize {
        let mut number = usize::from(self.byte());
        if count > 256 {
            number = 256 * number + usize::from(self.byte());
        }
        number % count.max(1)
    }

    /// A number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        let number = i16::from_le_bytes([self.byte(), self.byte()]);
        f64::from(number) / 32768.0
    }

    /// A value for a field: often one that others have too, or one an ulp away; zeros of both signs, infinities, any
    /// other bits. Never NaN.
    pub fn value(&mut self) -> f64 {
        let value = match self.byte() {
            kind @ 0..=99 => f64::from(kind % 7) - 3.0,
            kind @ 100..=139 => 1.0 + f64::from(kind % 4) * f64::EPSILON,
            140..=159 => -0.0,
            160..=169 => f64::INFINITY,
            170..=179 => f64::NEG_INFINITY,
            180..=189 => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))),
            _ => self.signed(),
        };
        if value.is_nan() { 0.0 } else { value }
    }

    /// A coordinate: mostly an ordinary one, sometimes one that is far too large or too small.
    pub fn coordinate(&mut self) -> f64 {
        match self.byte() {
            0..=63 => 0.0,
            64..=127 => f64::from(self.byte() % 4),
            128..=239 => self.signed(),
            240..=243 => 1e-12 * self.signed(),
            244..=247 => 1e12 * self.signed(),
            248..=251 => 1e-150 * self.signed(),
            _ => 1e150 * self.signed(),
        }
    }
}

/// An undirected graph of 1 to 64 vertices, with loops and repeated edges, connected or not.
pub fn graph(bytes: &mut Bytes) -> UnGraph<(), ()> {
    let count = 1 + bytes.below(64);
    let mut graph = UnGraph::new_undirected();
    let vertices: Vec<_> = (0..count).map(|_| graph.add_node(())).collect();
    for _ in 0..bytes.below(3 * count) {
        let (a, b) = (bytes.below(count), bytes.below(count));
        graph.add_edge(vertices[a], vertices[b], ());
    }
    graph
}

/// A field of so many values.
pub fn field(bytes: &mut Bytes, count: usize) -> Vec<f64> {
    (0..count).map(|_| bytes.value()).collect()
}

/// A small oriented manifold in one piece, of genus 0 to 2, closed or with up to two boundary loops: a solid whose faces
/// and edges were split, flipped and moved about.
pub fn surface(bytes: &mut Bytes) -> Shape {
    let mut shape = solid(bytes);
    let steps = bytes.below(24);
    for _ in 0..steps {
        if bytes.is_empty() {
            break;
        }
        match bytes.byte() % 4 {
            0 => split_face(&mut shape, bytes),
            1 => split_edge(&mut shape, bytes),
            2 => flip_edge(&mut shape, bytes),
            _ => move_vertex(&mut shape, bytes),
        }
    }
    shape
}

fn solid(bytes: &mut Bytes) -> Shape {
    match bytes.below(10) {
        0 => solids::tetrahedron(),
        1 => solids::octahedron(),
        2 => solids::torus(4, 3),
        3 => solids::patch(2, 2),
        4 => solids::tube(4, 2),
        5 => solids::slab(0, 0),
        6 => solids::slab(0, 2),
        7 => solids::slab(1, 1),
        8 => solids::slab(2, 0),
        _ => solids::bumpy_sphere(2),
    }
}

/// A new vertex inside a triangle, of degree three.
fn split_face(shape: &mut Shape, bytes: &mut Bytes) {
    let f = bytes.below(shape.triangles.len());
    let [a, b, c] = shape.triangles[f];
    let weights = [0, 1, 2].map(|_| 1.0 + f64::from(bytes.byte()));
    let new = add_point(shape, &[(a, weights[0]), (b, weights[1]), (c, weights[2])]);
    shape.triangles[f] = [a, b, new];
    shape.triangles.extend([[b, c, new], [c, a, new]]);
}

/// A new vertex on an edge.
fn split_edge(shape: &mut Shape, bytes: &mut Bytes) {
    let f = bytes.below(shape.triangles.len());
    let k = bytes.below(3);
    let (a, b) = (shape.triangles[f][k], shape.triangles[f][(k + 1) % 3]);
    let new = add_point(shape, &[(a, 1.0 + f64::from(bytes.byte())), (b, 128.0)]);
    for f in 0..shape.triangles.len() {
        let triangle = shape.triangles[f];
        let Some(k) = (0..3).find(|&k| is_edge(triangle, k, a, b)) else { continue };
        let (from, to, apex) = (triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]);
        shape.triangles[f] = [from, new, apex];
        shape.triangles.push([new, to, apex]);
    }
}

/// An edge turned into the other diagonal of its quad, unless there is such an edge already.
fn flip_edge(shape: &mut Shape, bytes: &mut Bytes) {
    let f = bytes.below(shape.triangles.len());
    let k = bytes.below(3);
    let [a, b, c] = [0, 1, 2].map(|j| shape.triangles[f][(k + j) % 3]);
    let across = |g: &usize| *g != f && (0..3).any(|k| is_edge(shape.triangles[*g], k, a, b));
    let Some(g) = (0..shape.triangles.len()).find(across) else { return };
    let Some(d) = shape.triangles[g].into_iter().find(|v| *v != a && *v != b) else { return };
    let is_joined = shape.triangles.iter().any(|t| t.contains(&c) && t.contains(&d));
    if !is_joined {
        shape.triangles[f] = [a, d, c];
        shape.triangles[g] = [d, b, c];
    }
}

/// A vertex moved by a part of the way to another one.
fn move_vertex(shape: &mut Shape, bytes: &mut Bytes) {
    let v = bytes.below(shape.points.len());
    let toward = shape.points[bytes.below(shape.points.len())];
    let share = 0.4 * bytes.signed();
    let lift = 0.2 * bytes.signed();
    let p = shape.points[v];
    shape.points[v] = [0, 1, 2].map(|k| p[k] + share * (toward[k] - p[k]) + if k == v % 3 { lift } else { 0.0 });
}

fn is_edge(triangle: [u32; 3], k: usize, a: u32, b: u32) -> bool {
    let ends = [triangle[k], triangle[(k + 1) % 3]];
    ends == [a, b] || ends == [b, a]
}

fn add_point(shape: &mut Shape, weighted: &[(u32, f64)]) -> u32 {
    let total: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let coordinate = |k: usize| weighted.iter().map(|&(v, weight)| weight / total * shape.points[v as usize][k]).sum();
    let point = [0, 1, 2].map(coordinate);
    shape.points.push(point);
    shape.points.len() as u32 - 1
}

/// How far insults move vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    /// Within the size of the surface, onto other vertices and edges as well.
    Near,
    /// From 1e-150 to 1e150.
    Anywhere,
}

/// A surface that was then insulted: triangles turned, copied and deleted, vertices welded, split off and moved. At least
/// one triangle is left.
pub fn insulted(bytes: &mut Bytes, moves: Moves) -> Shape {
    let mut shape = surface(bytes);
    while !bytes.is_empty() {
        insult(&mut shape, bytes, moves);
    }
    shape
}

fn insult(shape: &mut Shape, bytes: &mut Bytes, moves: Moves) {
    let kind = bytes.byte() % 6;
    let f = bytes.below(shape.triangles.len());
    let k = bytes.below(3);
    let v = shape.triangles[f][k];
    match kind {
        0 => shape.triangles[f].swap(0, 1),
        1 => {
            let mut copy = shape.triangles[f];
            copy.rotate_left(k);
            shape.triangles.push(copy);
        }
        2 if shape.triangles.len() > 1 => drop(shape.triangles.swap_remove(f)),
        3 => shape.triangles[f][k] = bytes.below(shape.points.len()) as u32,
        4 => {
            shape.points.push(shape.points[v as usize]);
            shape.triangles[f][k] = shape.points.len() as u32 - 1;
        }
        _ if moves == Moves::Anywhere => shape.points[v as usize] = [0, 1, 2].map(|_| bytes.coordinate()),
        _ => {
            let grid = |bytes: &mut Bytes| f64::from(bytes.byte() % 9) / 4.0 - 1.0;
            shape.points[v as usize] = [0, 1, 2].map(|_| if k == 0 { grid(bytes) } else { bytes.signed() });
        }
    }
}

/// Any points and polygons between them at all.
pub fn polygons(bytes: &mut Bytes) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    let points: Vec<[f64; 3]> = (0..3 + bytes.below(30)).map(|_| [0, 1, 2].map(|_| bytes.coordinate())).collect();
    let mut faces = Vec::new();
    while faces.is_empty() || !bytes.is_empty() && faces.len() < 200 {
        let corners = [3, 3, 3, 3, 4, 4, 5, 9][bytes.below(8)];
        faces.push((0..corners).map(|_| bytes.below(points.len()) as u32).collect());
    }
    (points, faces)
}

/// So many different inner vertices of a mesh, or fewer.
pub fn inner_vertices(bytes: &mut Bytes, mesh: &Mesh, count: usize) -> Vec<geom::VertexId> {
    let mut inner: Vec<_> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
    let count = count.min(inner.len());
    (0..count).map(|_| inner.swap_remove(bytes.below(inner.len()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_bytes_are_a_manifold_surface() {
        for seed in 0..2000u32 {
            let mut state = seed;
            let bytes: Vec<u8> = (0..120)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (state >> 24) as u8
                })
                .collect();
            let shape = surface(&mut Bytes::new(&bytes));
            shape.mesh().check();
            assert_eq!(shape.mesh().components().1, 1);
        }
    }

    #[test]
    fn no_bytes_are_the_smallest_input() {
        let mut none = Bytes::new(&[]);
        assert_eq!(surface(&mut none), solids::tetrahedron());
        assert_eq!((graph(&mut none).node_count(), none.value(), none.below(0)), (1, -3.0, 0));
    }
}
