//! A map of a surface to the plane: positions of corners, and the edges where it is open.

use geom::{CutMesh, EdgeData, FaceId, HalfedgeData, Mesh};

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
        let at = |h| position[h].map(f64::to_bits);
        let cut = mesh.edges().map(|e| {
            let h = mesh.halfedge(e);
            mesh.twin(h).is_some_and(|g| at(h) != at(mesh.next(g)) || at(mesh.next(h)) != at(g))
        });
        Self { cut: cut.collect(), position }
    }

    /// The images of the triangles.
    pub fn triangles(&self, mesh: &Mesh) -> Vec<Triangle> {
        mesh.faces().map(|f| self.triangle(mesh, f)).collect()
    }

    pub(super) fn triangle(&self, mesh: &Mesh, f: FaceId) -> Triangle {
        mesh.sides(f).map(|h| self.position[h])
    }

    /// The surface opened where the map is: its islands, and the images of vertices.
    pub fn opened(&self, mesh: &Mesh) -> CutMesh {
        CutMesh::open(mesh, &self.cut)
    }
}
