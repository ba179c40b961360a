//! Even triangles for every surface: intrinsic Delaunay refinement, and the way back.
//!
//! Points are put into the *intrinsic* Delaunay triangulation, at the circumcentres of bad triangles, until angles are at
//! least [`LEAST_ANGLE`] (Chew 1993, his second algorithm; intrinsically Sharp, Soliman & Crane 2019, §4–5). The surface stays the
//! same: only lengths are computed with. Where the boundary lies between, or the circumcentre in the diametral circle of a boundary
//! edge, that edge is split instead (Ruppert 1995): Chew takes points out again there, which a correspondence does not like. So at
//! boundaries the bound that is proven is Ruppert's, 20.7°; a cap ends what does not end. Corners that are narrow by themselves
//! cannot have the angle and are let be, and nothing is asked of triangles that are [small](TriangleSize::small). Edges that are [held](EdgeRoles::held) are such boundaries with a triangle on both sides.
//!
//! The input's edges are carried along ([`overlay`]), exactly as far as order goes, so that both triangulations cut the surface into
//! a [`CommonRefinement`]: the same surface in space, and in each of its triangles a map of either is linear. Where the surface is plane
//! the input's edges change nothing, and it can do without them ([`planar_edges`]): the thin pieces beside them are gone.

mod chew;
mod common;
mod cut;
mod overlay;
mod planar;
mod plane;
mod straight;

pub use chew::{EdgeRoles, LEAST_ANGLE, Refinement, TriangleSize, refine, refine_watched};
pub use common::CommonRefinement;
pub use planar::planar_edges;
pub use straight::StraightPath;

use crate::mesh::{FaceId, HalfedgeId, Triangulation, VertexId};

/// Where a point is on the input's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfacePoint {
    /// At a vertex.
    Vertex(VertexId),
    /// On the edge of this halfedge, so far along it, from 0 to 1.
    Edge(HalfedgeId, f64),
    /// In a triangle, at these barycentric coordinates.
    Face(FaceId, [f64; 3]),
}

impl SurfacePoint {
    /// Barycentric coordinates in a triangle that it is part of; the middle where it is none of it.
    pub fn barycentric(self, input: &Triangulation, f: FaceId) -> [f64; 3] {
        let at_corner = |s: usize| [0, 1, 2].map(|k| f64::from(u8::from(k == s)));
        let on_side = |h: HalfedgeId, along: f64| {
            let s = h.0 as usize % 3;
            let mut weights = [0.0; 3];
            (weights[s], weights[(s + 1) % 3]) = (1.0 - along, along);
            weights
        };
        match self {
            Self::Vertex(v) => input.corners(f).iter().position(|&w| w == v).map(at_corner),
            Self::Edge(h, along) if input.face(h) == f => Some(on_side(h, along)),
            Self::Edge(h, along) => {
                input.twin(h).filter(|&twin| input.face(twin) == f).map(|twin| on_side(twin, 1.0 - along))
            }
            Self::Face(home, weights) => (home == f).then_some(weights),
        }
        .unwrap_or([1.0 / 3.0; 3])
    }

    /// Its position in space, those of the input's vertices given.
    ///
    /// # Panics
    /// If there are fewer points than vertices.
    pub fn position(self, input: &Triangulation, points: &[[f64; 3]]) -> [f64; 3] {
        let point = |v: VertexId| points[v.0 as usize];
        match self {
            Self::Vertex(v) => point(v),
            Self::Edge(h, along) => {
                let [p, q] = [point(input.tail(h)), point(input.head(h))];
                [0, 1, 2].map(|c| p[c] + along * (q[c] - p[c]))
            }
            Self::Face(f, weights) => {
                let corners = input.corners(f).map(point);
                [0, 1, 2].map(|c| (0..3).map(|s| weights[s] * corners[s][c]).sum())
            }
        }
    }
}

#[cfg(test)]
mod tests;
