//! Gluing triangles given by their vertices.

use thiserror::Error;

use super::id::{EdgeId, FaceId, HalfedgeId, Id, VertexId};
use super::{Mesh, Triangulation};
use crate::parallel;
use crate::rows::Rows;

/// Why triangles do not form an oriented manifold.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshError {
    /// There is nothing to glue.
    #[error("the mesh has no faces")]
    NoFaces,
    /// A triangle names a vertex that is not there.
    #[error("face {face} refers to vertex {vertex}, but there are {count} vertices")]
    VertexOutOfRange {
        /// The triangle.
        face: FaceId,
        /// What it names.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// A triangle names a vertex twice.
    #[error("face {face} uses vertex {vertex} twice")]
    RepeatedVertex {
        /// The triangle.
        face: FaceId,
        /// The vertex.
        vertex: VertexId,
    },
    /// An edge has more than two triangles.
    #[error("edge ({}, {}) is non-manifold: it has more than two faces", ends[0], ends[1])]
    NonManifoldEdge {
        /// The edge's vertices.
        ends: [VertexId; 2],
    },
    /// Two triangles run along their common edge in the same direction.
    #[error("faces {} and {} are oriented against each other at edge ({}, {})", faces[0], faces[1], ends[0], ends[1])]
    Misoriented {
        /// The edge's vertices.
        ends: [VertexId; 2],
        /// The two triangles.
        faces: [FaceId; 2],
    },
    /// The triangles at a vertex do not form one fan.
    #[error("vertex {0} is non-manifold: its faces form more than one fan")]
    NonManifoldVertex(VertexId),
    /// A vertex is in no triangle.
    #[error("vertex {0} is isolated: no face uses it")]
    IsolatedVertex(VertexId),
}

impl Mesh {
    /// Glues triangles, given by their vertices counter-clockwise, along their common edges. O(F) but for a sort
    /// within each vertex's star.
    ///
    /// # Errors
    /// If the triangles do not form an oriented manifold without isolated vertices; see [`MeshError`].
    pub fn new(vertex_count: usize, faces: &[[u32; 3]]) -> Result<Self, MeshError> {
        if faces.is_empty() {
            return Err(MeshError::NoFaces);
        }
        for (f, corners) in faces.iter().enumerate() {
            let face = FaceId::new(f);
            for (k, &vertex) in corners.iter().enumerate() {
                if vertex as usize >= vertex_count {
                    return Err(MeshError::VertexOutOfRange { face, vertex, count: vertex_count });
                }
                if corners[..k].contains(&vertex) {
                    return Err(MeshError::RepeatedVertex { face, vertex: VertexId(vertex) });
                }
            }
        }
        let tail: Vec<VertexId> = faces.iter().flatten().map(|&v| VertexId(v)).collect();
        let twin = match_twins(vertex_count, &tail)?;
        Self::from_twins(vertex_count, tail, twin)
    }

    /// A mesh from its gluing: for each halfedge (three a triangle, counter-clockwise) the vertex where it starts and its
    /// twin, `u32::MAX` on the boundary. Unlike [`Mesh::new`] it can hold triangles that are *not* glued along an edge
    /// whose two ends they share.
    pub(crate) fn from_twins(vertex_count: usize, tail: Vec<VertexId>, twin: Vec<u32>) -> Result<Self, MeshError> {
        let mut edge = vec![EdgeId(u32::MAX); tail.len()];
        let mut edge_halfedge = Vec::with_capacity(tail.len() / 2 + 1);
        for h in 0..tail.len() {
            let twin = twin[h] as usize;
            if twin > h {
                edge[h] = EdgeId::new(edge_halfedge.len());
                edge_halfedge.push(HalfedgeId::new(h));
            } else {
                edge[h] = edge[twin];
            }
        }
        Self::from_triangulation(Triangulation { tail, twin, edge, edge_halfedge, vertex_count })
    }
}

/// For each halfedge the one that runs the other way between the same vertices, `u32::MAX` where there is none.
fn match_twins(vertex_count: usize, tail: &[VertexId]) -> Result<Vec<u32>, MeshError> {
    let mut twin = vec![u32::MAX; tail.len()];
    let mut error = None;
    for_each_edge(vertex_count, tail, |ends, sides| match *sides {
        [_] => {}
        [h, g] if tail[h as usize] != tail[g as usize] => {
            twin[h as usize] = g;
            twin[g as usize] = h;
        }
        [h, g] => error = error.take().or(Some(MeshError::Misoriented { ends, faces: [FaceId(h / 3), FaceId(g / 3)] })),
        _ => error = error.take().or(Some(MeshError::NonManifoldEdge { ends })),
    });
    error.map_or(Ok(twin), Err)
}

/// So many vertices at least are gone through by one thread, and in no more parts than this: each looks at all halfedges.
const LEAST_AT_ONCE: usize = 1 << 14;
const MOST_PARTS: usize = 4;

/// Visits each pair of vertices that halfedges (three a triangle, given by where they start) run between, with these
/// halfedges in ascending order. Edges come by their lower end, then by the upper one.
pub(crate) fn for_each_edge(vertex_count: usize, tail: &[VertexId], mut visit: impl FnMut([VertexId; 2], &[u32])) {
    let head = |h: usize| tail[if h % 3 == 2 { h - 2 } else { h + 1 }];
    let lower_end = |h: usize| tail[h].min(head(h)).index();
    // Halfedges in rows by the lower end of their edge, each row sorted by the upper end; some vertices on each thread.
    let at_once = vertex_count.div_ceil(parallel::threads().min(MOST_PARTS)).max(LEAST_AT_ONCE);
    let mut parts = vec![Rows::sorted(0, std::iter::empty()); vertex_count.div_ceil(at_once)];
    parallel::each(&mut parts, |k, stars| {
        let own = k * at_once..vertex_count.min((k + 1) * at_once);
        let here = (0..tail.len()).filter(|&h| own.contains(&lower_end(h)));
        *stars = Rows::sorted(own.len(), here.map(|h| (lower_end(h) - own.start, (tail[h].max(head(h)), h as u32))));
        (0..own.len()).for_each(|star| stars.row_mut(star).sort_unstable());
    });
    let stars = parts.iter().flat_map(|stars| (0..stars.len()).map(|star| stars.row(star)));
    let mut sides = Vec::new();
    for (v, star) in stars.enumerate() {
        for edge in star.chunk_by(|a, b| a.0 == b.0) {
            sides.clear();
            sides.extend(edge.iter().map(|&(_, h)| h));
            visit([VertexId::new(v), edge[0].0], &sides);
        }
    }
}
