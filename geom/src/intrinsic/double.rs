//! A surface glued to its mirror image.

use super::Metric;
use crate::mesh::{HalfedgeId, Id, Mesh, Triangulation, VertexData, VertexId};

/// A surface with a boundary and its mirror image, glued along the boundary: a closed surface, on which every edge can be
/// flipped. What is mirror-symmetric stays so under flips to Delaunay (Gillespie, Springborn & Crane 2021, §4.6), cocircular
/// quads aside.
///
/// The surface's own vertices, triangles and halfedges come first, with the indices that they have; then come those of
/// the image. Boundary vertices are shared.
#[derive(Clone, Debug)]
pub struct Double {
    /// The closed surface.
    pub mesh: Mesh,
    /// For each of its vertices the one of the surface that it is, or is the image of.
    pub original: VertexData<VertexId>,
}

impl Double {
    /// Glues a surface to its mirror image. O(V + F).
    pub fn new(surface: &Mesh) -> Self {
        let sides = surface.halfedge_count() as u32;
        // Triangle f + F has the sides of f backwards.
        let image = |h: u32| sides + h - h % 3 + (2 - h % 3);
        let mut original: VertexData<VertexId> = surface.vertices().collect();
        let mut image_of: VertexData<VertexId> = surface.vertices().collect();
        let mut count = surface.vertex_count();
        let mut inner = Vec::new();
        for v in surface.vertices().filter(|&v| !surface.is_boundary_vertex(v)) {
            image_of[v] = VertexId::new(count);
            inner.push(v);
            count += 1;
        }
        original = original.iter().copied().chain(inner).collect();
        let mut tail: Vec<VertexId> = surface.halfedges().map(|h| surface.tail(h)).collect();
        let mut twin = vec![0; 2 * sides as usize];
        tail.resize(2 * sides as usize, VertexId(0));
        for h in surface.halfedges() {
            let here = image(h.0) as usize;
            tail[here] = image_of[surface.head(h)];
            let across = surface.twin(h);
            twin[h.index()] = across.map_or(image(h.0), |g| g.0);
            twin[here] = across.map_or(h.0, |g| image(g.0));
        }
        let mesh = Mesh::from_twins(count, tail, twin)
            .unwrap_or_else(|error| unreachable!("both halves are manifold: {error}"));
        Self { mesh, original }
    }

    /// The surface's edge lengths on both halves.
    pub fn metric(&self, surface: &Triangulation, metric: &Metric) -> Metric {
        let half = surface.halfedge_count() as u32;
        let of_surface = |h: HalfedgeId| if h.0 < half { h } else { HalfedgeId(h.0 - half - h.0 % 3 + (2 - h.0 % 3)) };
        let length = |e| metric.length(surface.edge(of_surface(self.mesh.halfedge(e))));
        Metric::new(self.mesh.edges().map(length).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{angle_defects, delaunay, shapes};

    #[test]
    fn a_double_is_closed_and_has_the_surface_twice() {
        for shape in [shapes::terrain(300, 2), shapes::square(100), shapes::saddle_cone(200)] {
            let surface = shape.mesh();
            let metric = Metric::from_points(&surface, &shape.points);
            let double = Double::new(&surface);
            double.mesh.check();
            assert!(double.mesh.edges().all(|e| !double.mesh.is_boundary_edge(e)));
            assert_eq!(double.mesh.euler_characteristic(), 2 * surface.euler_characteristic());
            assert!(surface.faces().all(|f| surface.corners(f) == double.mesh.corners(f)));
            let lengths = double.metric(&surface, &metric);
            let curvature = angle_defects(&surface, &metric);
            for (v, k) in angle_defects(&double.mesh, &lengths).iter_ids() {
                let here = double.original[v];
                let expected = if surface.is_boundary_vertex(here) { 2.0 } else { 1.0 } * curvature[here];
                assert!((k - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn flips_of_a_double_go_through_the_boundary() {
        // A triangle whose longest side is on the boundary: with its image that side is not Delaunay.
        let surface = Mesh::new(3, &[[0, 1, 2]]).unwrap();
        let metric = Metric::from_points(&surface, &[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
        let double = Double::new(&surface);
        assert!(delaunay(&surface, &metric).flips.is_empty());
        assert_eq!(delaunay(&double.mesh, &double.metric(&surface, &metric)).flips.len(), 1);
    }
}
