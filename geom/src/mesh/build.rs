//! Gluing triangles given by their vertices.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use thiserror::Error;

use super::id::{EdgeId, FaceId, HalfedgeId, Id, VertexId};
use super::{Mesh, Triangulation};
use crate::counted::are;
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
    #[error("face {face} refers to vertex {vertex}, but there {}", are(*count, "vertex", "vertices"))]
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
    let twins = Twins::none(tail.len());
    let visit = |(): &mut (), ends: [u32; 2], sides: &[u32]| {
        let ends = ends.map(VertexId);
        match *sides {
            [_] => Ok(()),
            [h, g] if tail[h as usize] != tail[g as usize] => {
                twins.set(h, g);
                Ok(())
            }
            [h, g] => Err(MeshError::Misoriented { ends, faces: [FaceId(h / 3), FaceId(g / 3)] }),
            _ => Err(MeshError::NonManifoldEdge { ends }),
        }
    };
    of_edges(vertex_count, tail.len(), |h| tail[h].0, visit).into_iter().collect::<Result<(), _>>()?;
    Ok(twins.into_vec())
}

/// The twin of each halfedge, written by several threads.
pub(crate) struct Twins(Vec<AtomicU32>);

impl Twins {
    /// None for any of so many halfedges.
    pub(crate) fn none(count: usize) -> Self {
        Self(parallel::map(count, |_| AtomicU32::new(u32::MAX)))
    }

    /// Makes two halfedges twins.
    pub(crate) fn set(&self, h: u32, g: u32) {
        self.0[h as usize].store(g, Relaxed);
        self.0[g as usize].store(h, Relaxed);
    }

    /// Those of all halfedges; `u32::MAX` where there is none.
    pub(crate) fn into_vec(self) -> Vec<u32> {
        self.0.into_iter().map(AtomicU32::into_inner).collect()
    }
}

/// So many vertices at least are gone through by one thread, and in no more parts than this: each looks at all halfedges.
const LEAST_AT_ONCE: usize = 1 << 14;
const MOST_PARTS: usize = 4;

/// Visits each pair of vertices that the sides of triangles run between, with these sides in ascending order: side 3f + k is that from corner
/// k of triangle f to the next, and `vertex` tells where sides start. Edges come by their lower end, then by the upper one, but some at the
/// same time: each part of them is collected in a value of its own, or ends with an error, and these are in order.
pub(crate) fn of_edges<T: Default + Send, E: Send>(
    vertex_count: usize,
    side_count: usize,
    vertex: impl Fn(usize) -> u32 + Sync,
    visit: impl Fn(&mut T, [u32; 2], &[u32]) -> Result<(), E> + Sync,
) -> Vec<Result<T, E>> {
    let ends = |side: usize| [side, if side % 3 == 2 { side - 2 } else { side + 1 }].map(&vertex);
    let at_once = vertex_count.div_ceil(parallel::threads().min(MOST_PARTS)).max(LEAST_AT_ONCE);
    parallel::of_runs(vertex_count, at_once, |own| {
        // Sides in rows by the lower end of their edge, each row sorted by the upper end.
        let here = (0..side_count).map(|side| (ends(side), side as u32));
        let here = here.filter(|([a, b], _)| own.contains(&(*a.min(b) as usize)));
        let here = here.map(|([a, b], side)| (a.min(b) as usize - own.start, (a.max(b), side)));
        let mut stars = Rows::sorted(own.len(), here);
        let (mut found, mut sides) = (T::default(), Vec::new());
        for lower in own.clone() {
            let star = stars.row_mut(lower - own.start);
            star.sort_unstable();
            for edge in star.chunk_by(|a, b| a.0 == b.0) {
                sides.clear();
                sides.extend(edge.iter().map(|&(_, side)| side));
                visit(&mut found, [lower as u32, edge[0].0], &sides)?;
            }
        }
        Ok(found)
    })
}
