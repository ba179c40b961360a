//! A map of a surface to the plane: positions of corners, and the edges where it is open.

use geom::{CutMesh, EdgeData, FaceId, HalfedgeData, HalfedgeId, Id, Islands, Mesh, WedgeData};
use rayon::prelude::*;

use super::AT_ONCE;
use super::triangle::Triangle;

/// A map of a surface to the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct UvMap {
    /// The position of each triangle's corner, by the halfedge that starts there.
    pub position: HalfedgeData<[f64; 2]>,
    /// The edges inside the surface where the map is open.
    pub cut: EdgeData<bool>,
}

impl UvMap {
    /// The map with these positions, open at the edges whose ends do not have the same bits on both sides.
    ///
    /// # Panics
    /// If there is a corner without a position.
    pub fn new(mesh: &Mesh, position: HalfedgeData<[f64; 2]>) -> Self {
        // Adding 0 makes -0 positive.
        let at = |h| position[h].map(|x| (x + 0.0).to_bits());
        let cut = mesh.edges().map(|e| {
            let h = mesh.halfedge(e);
            mesh.twin(h).is_some_and(|g| at(h) != at(mesh.next(g)) || at(mesh.next(h)) != at(g))
        });
        Self { cut: cut.collect(), position }
    }

    /// The map with these positions but for rounding: closed where both ends of an edge are nearer than `tolerance` on its two sides, with one
    /// position for each vertex of an island.
    pub(super) fn nearly(mesh: &Mesh, position: HalfedgeData<[f64; 2]>, tolerance: f64) -> Self {
        let is_near = |h: HalfedgeId, g: HalfedgeId| {
            position[h].iter().zip(&position[g]).all(|(x, y)| x == y || (x - y).abs() <= tolerance)
        };
        let cut = mesh.edges().map(|e| {
            let h = mesh.halfedge(e);
            mesh.twin(h).is_some_and(|g| !is_near(h, mesh.next(g)) || !is_near(mesh.next(h), g))
        });
        let cut = cut.collect();
        Self { cut, position }.snapped(mesh, |_, _| true)
    }

    /// The same map with one position for each vertex of an island: where its corners' positions are not the same to the bit, that of one
    /// which is as it was before, if there is any.
    pub(super) fn snapped(mut self, mesh: &Mesh, is_as_before: impl Fn(&Self, HalfedgeId) -> bool) -> Self {
        let opened = self.opened(mesh);
        let is_as_before = |h: HalfedgeId| is_as_before(&self, h);
        let mut from: WedgeData<Option<HalfedgeId>> = WedgeData::constant(opened.wedge_count(), None);
        for h in mesh.halfedges() {
            let chosen = &mut from[opened.wedge(h)];
            if chosen.is_none_or(|first| !is_as_before(first) && is_as_before(h)) {
                *chosen = Some(h);
            }
        }
        let position = from.iter().map(|h| self.position[h.expect("each wedge has corners")]);
        let position: WedgeData<[f64; 2]> = position.collect();
        let corners = self.position.par_iter_mut().with_min_len(AT_ONCE).enumerate();
        corners.for_each(|(h, corner)| *corner = position[opened.wedge(HalfedgeId::new(h))]);
        self
    }

    /// The images of the triangles.
    pub fn triangles(&self) -> &[Triangle] {
        self.position.as_chunks().0
    }

    /// The longer side of its bounding box.
    pub(super) fn extent(&self) -> f64 {
        let side = |i: usize| {
            let [low, high] = self
                .position
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p[i]), high.max(p[i])]);
            high - low
        };
        side(0).max(side(1))
    }

    pub(super) fn triangle(&self, f: FaceId) -> Triangle {
        self.triangles()[f.index()]
    }

    /// Its islands.
    pub fn islands(&self, mesh: &Mesh) -> Islands {
        Islands::new(mesh, &self.cut)
    }

    /// The surface opened where the map is: its islands, and the images of vertices.
    pub fn opened(&self, mesh: &Mesh) -> CutMesh {
        CutMesh::open(mesh, &self.cut)
    }
}
