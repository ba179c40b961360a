//! Triangle meshes, with their neighbours in cyclic order where these are asked for.
//!
//! The triangles need be no surface. Pairs are found from them as they are (see [`triangles`]). What else asks for neighbours gets them in
//! rings. At a boundary the ring is an open chain; where sheets meet there are several chains.
//! Chains that share a vertex are counted as different parts, which costs time and changes no pair (see [`rings`]).

use super::graph::Domain;
use super::rings::{self, Linked};
use super::rows::{Rows, vertex_index};
use super::triangles;
use crate::error::{Error, check_vertex_count};
use crate::filtration::{Direction, Filtration};
use crate::pairing::{Basins, Pointing};
use crate::scalar::Scalar;
use num_traits::PrimInt;
use std::sync::OnceLock;

/// Marks the last vertex of an open chain. A ring without a mark is closed.
const END: u32 = 1 << 31;

const NONE: u32 = u32::MAX;

/// The vertices and edges of a set of triangles.
///
/// ```
/// // A tetrahedron. Its lowest and highest corner live for ever.
/// let mesh = topo::TriangleMesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])?;
/// let persistence = topo::persistence(&mesh, &[0.0, 1.0, 2.0, 3.0])?;
/// assert_eq!((persistence.minima.len(), persistence.maxima.len()), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct TriangleMesh {
    vertices: usize,
    triangles: Vec<[u32; 3]>,
    /// The neighbours of each vertex, made when they are first asked for.
    rings: OnceLock<Rows<u32>>,
}

impl PartialEq for TriangleMesh {
    /// Whether the triangles are the same.
    fn eq(&self, other: &Self) -> bool {
        (self.vertices, &self.triangles) == (other.vertices, &other.triangles)
    }
}

impl Eq for TriangleMesh {}

impl TriangleMesh {
    /// From the corners of the triangles, arrays or tuples of integers of any type, in any orientation. O(vertices + triangles).
    ///
    /// Pairs are found from the triangles as they are. What asks for neighbours (trees, segmentations, the plain sweep) has them put into
    /// rings first, once for a mesh; that is fastest where neighbouring triangles are oriented alike.
    ///
    /// # Errors
    /// If a corner is not a vertex, or if there are more than 2³¹ - 1 triangles.
    pub fn new<I: PrimInt>(vertices: usize, triangles: &[impl Into<[I; 3]> + Copy]) -> Result<Self, Error> {
        check_vertex_count(vertices.max(triangles.len()))?;
        let checked = |(triangle, &corners): (usize, &_)| {
            let corners: [I; 3] = Into::into(corners);
            let mut indices = [0; 3];
            for (index, corner) in indices.iter_mut().zip(corners) {
                *index =
                    vertex_index(corner, vertices).map_err(|vertex| Error::Triangle { triangle, vertex, vertices })?;
            }
            Ok(indices)
        };
        let triangles = triangles.iter().enumerate().map(checked).collect::<Result<_, Error>>()?;
        Ok(Self { vertices, triangles, rings: OnceLock::new() })
    }

    fn rings(&self) -> &Rows<u32> {
        self.rings.get_or_init(|| rings_of(self.vertices, &self.triangles))
    }

    fn ring(&self, vertex: usize) -> &[u32] {
        self.rings().of(vertex)
    }
}

/// The neighbours of each vertex in cyclic order.
fn rings_of(vertices: usize, triangles: &[[u32; 3]]) -> Rows<u32> {
    let corners = triangles.iter().copied();
    let links = Rows::sorted(vertices, corners.filter(|[a, b, c]| a != b || b != c).map(link_edges));
    let mut chaining = Chaining::default();
    links.flattened(|link, ring| {
        let is_cycle = is_cycle(link);
        if !is_cycle {
            chaining.append_ring(vertices, link, ring);
        }
        is_cycle
    })
}

impl Domain for &TriangleMesh {
    type Vertex = usize;

    fn vertex_count(&self) -> usize {
        self.vertices
    }

    fn vertex(&self, index: usize) -> usize {
        index
    }

    fn for_each_neighbor(&self, index: usize, mut visit: impl FnMut(usize)) {
        self.ring(index).iter().for_each(|&entry| visit((entry & !END) as usize));
    }

    fn basins<S: Scalar, D: Direction>(&self, filtration: &Filtration<'_, S, D>, pointing: Pointing) -> Basins {
        if pointing == Pointing::Any && self.rings.get().is_none() {
            return triangles::basins(self.vertices, &self.triangles, filtration);
        }
        rings::basins(*self, filtration, pointing)
    }
}

impl Linked for &TriangleMesh {
    fn vertex_count(&self) -> usize {
        self.vertices
    }

    #[inline]
    fn for_each_in_link(&self, index: usize, mut visit: impl FnMut(u32, bool)) {
        self.ring(index).iter().for_each(|&entry| visit(entry & !END, entry & END == 0));
    }

    /// Only a closed ring ends without a mark.
    fn is_closed(&self, _: usize) -> bool {
        true
    }
}

/// The corners of a triangle that is no point, each with the edge opposite to it. Where corners coincide, an edge that leads to the corner
/// itself shrinks to its other end. Edges are put where their corners have them: looking triangles up from there took longer than all else.
#[inline]
fn link_edges([a, b, c]: [u32; 3]) -> [(u32, [u32; 2]); 3] {
    let edges = [(a, [b, c]), (b, [c, a]), (c, [a, b])];
    if a != b && b != c && c != a {
        return edges;
    }
    edges.map(|(v, [p, q])| {
        (
            v,
            if p == v {
                [q, q]
            } else if q == v {
                [p, p]
            } else {
                [p, q]
            },
        )
    })
}

/// Links of more edges than this are chained by a table, since searching each for the next takes their number squared.
const MAX_SEARCHED: usize = 24;

/// Whether the edges of a link make one cycle, each leading on from the one before; if so, they are put into its order, else as far
/// as it goes. That is how it is round nearly every vertex of a mesh whose triangles are oriented alike: a million vertices in a third
/// of the time that [`Chaining`] takes.
#[inline]
fn is_cycle(link: &mut [[u32; 2]]) -> bool {
    let count = link.len();
    if count == 0 || count > MAX_SEARCHED {
        return count == 0;
    }
    for place in 1..count {
        let to = link[place - 1][1];
        let Some(next) = (place..count).find(|&next| link[next][0] == to) else { return false };
        link.swap(place, next);
    }
    link[count - 1][1] == link[0][0] && count > 1
}

/// Orders the edges of links into chains, however they are directed; its arrays are reused from vertex to vertex.
#[derive(Default)]
struct Chaining {
    /// For each vertex up to two edges of the present link that end there.
    at: Vec<[u32; 2]>,
    used: Vec<bool>,
}

impl Chaining {
    /// Appends the vertices of a link in the order of its chains, open ones first.
    fn append_ring(&mut self, vertices: usize, link: &[[u32; 2]], rings: &mut Vec<u32>) {
        let start = rings.len();
        self.at.resize(vertices, [NONE; 2]);
        self.used.clear();
        for (edge, &ends) in (0..).zip(link) {
            let alone = self.stands_alone(edge, ends);
            self.used.push(alone);
            match ends {
                _ if !alone => {}
                [p, q] if p == q => rings.push(p | END),
                [p, q] => rings.extend([p, q | END]),
            }
        }
        for edge in 0..link.len() {
            if let Some(&end) = link[edge].iter().find(|&&end| self.at[end as usize][1] == NONE) {
                self.append_chain(link, edge, end, rings);
            }
        }
        for edge in 0..link.len() {
            let begin = rings.len();
            self.append_chain(link, edge, link[edge][0], rings);
            if begin == start && !self.used.contains(&false) {
                // The only chain, and closed: it needs neither its first vertex twice nor a mark.
                rings.pop();
            }
        }
        for &end in link.iter().flatten() {
            self.at[end as usize] = [NONE; 2];
        }
    }

    /// Hooks an edge to its ends; whether that is impossible, because the edge is a point or an end has two already.
    fn stands_alone(&mut self, edge: u32, [p, q]: [u32; 2]) -> bool {
        let alone = p == q || self.at[p as usize][1] != NONE || self.at[q as usize][1] != NONE;
        if !alone {
            for end in [p, q] {
                let at = &mut self.at[end as usize];
                at[usize::from(at[0] != NONE)] = edge;
            }
        }
        alone
    }

    /// Appends the vertices of the chain that begins with an unused edge at one of its ends, and marks the last.
    fn append_chain(&mut self, link: &[[u32; 2]], edge: usize, end: u32, rings: &mut Vec<u32>) {
        let (mut edge, mut end) = (edge as u32, end);
        if self.used[edge as usize] {
            return;
        }
        rings.push(end);
        while edge != NONE && !core::mem::replace(&mut self.used[edge as usize], true) {
            let [p, q] = link[edge as usize];
            end = if end == p { q } else { p };
            rings.push(end);
            let [a, b] = self.at[end as usize];
            edge = if a == edge { b } else { a };
        }
        *rings.last_mut().expect("a chain has vertices") |= END;
    }
}
