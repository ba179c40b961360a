//! Making triangles nearly equilateral, all about the same size.
//!
//! Botsch and Kobbelt (2004), "A remeshing approach to multiresolution modeling", §4: edges longer than 4/3 of the
//! length wanted are split and those shorter than 4/5 of it collapsed, edges are flipped, and vertices move to the middle
//! of their neighbours, along the surface. We flip to Delaunay instead of evening out degrees: the cotangents
//! are not negative then. Edges and vertices of the boundary stay as they are. Whatever is done keeps the surface a
//! manifold of the same topology: an edge is collapsed only if its ends have no common neighbours but the two opposite
//! it, flipped only where its successor is not there already.

use super::Shape;
use crate::vector::{Vec3, add, distance, dot, length, normal, scale, step, sub};

/// How often the four steps are done. The share of poor triangles falls until about here.
const ROUNDS: usize = 10;

/// The shape in triangles with sides of a length, its new points placed by `project`.
pub(super) fn remesh(shape: Shape, length: f64, project: impl Fn(Vec3) -> Vec3) -> Shape {
    let mut mesh = Remesh::new(shape);
    mesh.flip_to_delaunay();
    for _ in 0..ROUNDS + mesh.halvings_to(length) {
        mesh.split_longer_than(length * 4.0 / 3.0, &project);
        mesh.collapse_shorter_than(length * 4.0 / 5.0, length * 4.0 / 3.0);
        mesh.flip_to_delaunay();
        mesh.relax(&project);
    }
    mesh.flip_to_delaunay();
    mesh.compact()
}

/// Triangles with the list of those at each vertex. What is gone has an empty list, or is [`GONE`].
struct Remesh {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    star: Vec<Vec<u32>>,
    /// Whether a vertex is on the boundary.
    is_fixed: Vec<bool>,
}

const GONE: [u32; 3] = [u32::MAX; 3];

/// An edge inside the surface: its ends, and its triangles with the vertex opposite, that on its left first.
struct Edge {
    ends: [u32; 2],
    opposite: [u32; 2],
    triangles: [u32; 2],
}

fn corner_after(triangle: [u32; 3], v: u32) -> u32 {
    let at = triangle.iter().position(|&w| w == v).expect("the star of a vertex holds its triangles");
    triangle[(at + 1) % 3]
}

impl Remesh {
    fn new(Shape { points, triangles }: Shape) -> Self {
        let mut star = vec![Vec::new(); points.len()];
        for (t, corners) in triangles.iter().enumerate() {
            corners.iter().for_each(|&v| star[v as usize].push(t as u32));
        }
        let mut mesh = Self { is_fixed: vec![false; points.len()], points, triangles, star };
        mesh.is_fixed =
            (0..mesh.points.len() as u32).map(|v| mesh.neighbors(v).any(|w| mesh.edge(v, w).is_none())).collect();
        mesh
    }

    fn point(&self, v: u32) -> Vec3 {
        self.points[v as usize]
    }

    fn star(&self, v: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.star[v as usize].iter().map(|&t| self.triangles[t as usize])
    }

    /// The vertices that follow `v` in its triangles: all its neighbours, but for one on the boundary.
    fn neighbors(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        self.star(v).map(move |t| corner_after(t, v))
    }

    fn are_adjacent(&self, v: u32, w: u32) -> bool {
        self.star(v).any(|t| t.contains(&w))
    }

    fn normal(&self, triangle: [u32; 3]) -> Vec3 {
        normal(triangle.map(|v| self.point(v)))
    }

    fn edge_length(&self, [a, b]: [u32; 2]) -> f64 {
        distance(self.point(a), self.point(b))
    }

    /// The edge between two vertices, if it is there and inside.
    fn edge(&self, a: u32, b: u32) -> Option<Edge> {
        let side = |a, b| {
            self.star[a as usize].iter().find_map(|&t| {
                let corners = self.triangles[t as usize];
                (corners.contains(&b) && corner_after(corners, a) == b).then(|| (t, corner_after(corners, b)))
            })
        };
        let ((left, c), (right, d)) = (side(a, b)?, side(b, a)?);
        Some(Edge { ends: [a, b], opposite: [c, d], triangles: [left, right] })
    }

    fn edges(&self) -> Vec<[u32; 2]> {
        let sides = self.triangles.iter().filter(|&&t| t != GONE).flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        sides.filter(|[a, b]| a < b).collect()
    }

    /// How often the longest edge must be halved until it is shorter than a length.
    fn halvings_to(&self, length: f64) -> usize {
        let longest = self.edges().into_iter().map(|edge| self.edge_length(edge)).fold(length, f64::max);
        (longest / length).log2().ceil() as usize
    }

    fn set(&mut self, t: u32, corners: [u32; 3]) {
        let old = std::mem::replace(&mut self.triangles[t as usize], corners);
        for v in old.into_iter().filter(|v| old != GONE && !corners.contains(v)) {
            self.star[v as usize].retain(|&s| s != t);
        }
        for v in corners.into_iter().filter(|v| corners != GONE && !old.contains(v)) {
            self.star[v as usize].push(t);
        }
    }

    fn split_longer_than(&mut self, limit: f64, project: &impl Fn(Vec3) -> Vec3) {
        for [a, b] in self.edges() {
            if self.edge_length([a, b]) > limit
                && let Some(edge) = self.edge(a, b)
            {
                let middle = scale(add(self.point(a), self.point(b)), 0.5);
                self.split(&edge, middle);
                self.move_to(self.points.len() as u32 - 1, project(middle));
            }
        }
    }

    fn split(&mut self, edge: &Edge, middle: Vec3) {
        let (m, [a, b]) = (self.points.len() as u32, edge.ends);
        self.points.push(middle);
        self.star.push(Vec::new());
        self.is_fixed.push(false);
        for t in edge.triangles {
            let corners = self.triangles[t as usize];
            let with_m_for = |gone| corners.map(|v| if v == gone { m } else { v });
            self.set(t, with_m_for(b));
            self.triangles.push(GONE);
            self.set(self.triangles.len() as u32 - 1, with_m_for(a));
        }
    }

    fn collapse_shorter_than(&mut self, limit: f64, longest: f64) {
        for [a, b] in self.edges() {
            if self.edge_length([a, b]) >= limit {
                continue;
            }
            for [from, to] in [[a, b], [b, a]] {
                if let Some(edge) = self.edge(from, to)
                    && self.is_collapsible(&edge, longest)
                {
                    self.collapse(&edge);
                    break;
                }
            }
        }
    }

    /// Whether the edge's first end can be moved to the second.
    fn is_collapsible(&self, edge: &Edge, longest: f64) -> bool {
        let [from, to] = edge.ends;
        let shared = self.neighbors(from).filter(|&v| v != to && self.are_adjacent(v, to)).count();
        !self.is_fixed[from as usize]
            && shared == 2
            && self.star[from as usize].len() > 3
            && self.neighbors(from).all(|v| v == to || self.edge_length([v, to]) <= longest)
            && self.star(from).filter(|t| !t.contains(&to)).all(|t| {
                let moved = t.map(|v| if v == from { to } else { v });
                is_same_way(self.normal(t), self.normal(moved))
            })
    }

    fn collapse(&mut self, edge: &Edge) {
        let [from, to] = edge.ends;
        edge.triangles.into_iter().for_each(|t| self.set(t, GONE));
        for t in std::mem::take(&mut self.star[from as usize]) {
            let corners = self.triangles[t as usize].map(|v| if v == from { to } else { v });
            self.set(t, corners);
        }
    }

    fn flip_to_delaunay(&mut self) {
        // The surface is not flat, so that this need not end by itself.
        for _ in 0..ROUNDS {
            let mut flips = 0;
            for [a, b] in self.edges() {
                if let Some(edge) = self.edge(a, b)
                    && self.is_worth_a_flip(&edge)
                {
                    let [c, d] = edge.opposite;
                    self.set(edge.triangles[0], [a, d, c]);
                    self.set(edge.triangles[1], [b, c, d]);
                    flips += 1;
                }
            }
            if flips == 0 {
                break;
            }
        }
    }

    /// Whether the angles opposite an edge sum to more than π and it can be flipped.
    fn is_worth_a_flip(&self, edge: &Edge) -> bool {
        let [[a, b], [c, d]] = [edge.ends, edge.opposite];
        let cotangent = |at: u32| {
            let [x, y] = [a, b].map(|v| sub(self.point(v), self.point(at)));
            dot(x, y) / length(normal([self.point(at), self.point(a), self.point(b)])).max(f64::MIN_POSITIVE)
        };
        let facing = add(self.normal([a, b, c]), self.normal([b, a, d]));
        cotangent(c) + cotangent(d) < -1e-9
            && self.star[a as usize].len() > 3
            && self.star[b as usize].len() > 3
            && !self.are_adjacent(c, d)
            && [[a, d, c], [b, c, d]].into_iter().all(|t| is_same_way(self.normal(t), facing))
    }

    fn relax(&mut self, project: &impl Fn(Vec3) -> Vec3) {
        for v in 0..self.points.len() as u32 {
            if self.is_fixed[v as usize] || self.star[v as usize].is_empty() {
                continue;
            }
            let normals = self.star(v).map(|t| self.normal(t));
            let up = normals.fold([0.0; 3], add);
            let share = 1.0 / self.star[v as usize].len() as f64;
            let here = self.point(v);
            let to_middle = self.neighbors(v).fold([0.0; 3], |sum, w| step(sum, share, sub(self.point(w), here)));
            let along = step(to_middle, -dot(to_middle, up) / dot(up, up).max(f64::MIN_POSITIVE), up);
            self.move_to(v, project(add(here, along)));
        }
    }

    /// Moves a vertex unless that turns a triangle over.
    fn move_to(&mut self, v: u32, place: Vec3) {
        let before: Vec<Vec3> = self.star(v).map(|t| self.normal(t)).collect();
        let old = std::mem::replace(&mut self.points[v as usize], place);
        if !self.star(v).zip(&before).all(|(t, &n)| is_same_way(self.normal(t), n)) {
            self.points[v as usize] = old;
        }
    }

    /// What is left, vertices numbered as the triangles meet them.
    fn compact(self) -> Shape {
        let mut shape = Shape::default();
        let mut number = vec![u32::MAX; self.points.len()];
        for triangle in self.triangles.iter().filter(|&&t| t != GONE) {
            shape.triangles.push(triangle.map(|v| {
                if number[v as usize] == u32::MAX {
                    number[v as usize] = shape.points.len() as u32;
                    shape.points.push(self.points[v as usize]);
                }
                number[v as usize]
            }));
        }
        shape
    }
}

/// Whether two normals are less than 60° apart, so that no triangle turns over. (A triangle without area may do as it
/// likes.)
fn is_same_way(a: Vec3, b: Vec3) -> bool {
    dot(a, b) >= 0.5 * length(a) * length(b)
}
