//! A surface glued to its mirror image.

use super::Metric;
use crate::mesh::{FaceData, FaceId, HalfedgeId, Id, Mesh, Triangulation, VertexData, VertexId};

/// A surface with a boundary and its mirror image, glued along the boundary: a closed surface, on which every edge can be
/// flipped. What is mirror-symmetric stays so under flips to Delaunay (Gillespie, Springborn & Crane 2021, §4.6), cocircular
/// quads aside.
///
/// The surface's own vertices, triangles and halfedges come first, with the indices that they have; then come those of
/// the image. Boundary vertices are shared.
///
/// Of a [collar](Double::collar) only the triangles near the boundary have an image. Then that ends in a boundary of its own, which is not
/// flipped; what flips do to the surface's own boundary is the same as long as they do not come so far.
#[derive(Clone, Debug)]
pub struct Double {
    /// The surface and its image.
    pub mesh: Mesh,
    /// For each of its vertices the one of the surface that it is, or is an image of.
    pub original: VertexData<VertexId>,
    /// The surface's triangles that have an image, in the order of their images.
    imaged: Vec<FaceId>,
}

impl Double {
    /// Glues a surface to its whole mirror image. O(V + F).
    pub fn new(surface: &Mesh) -> Self {
        Self::with_image(surface, |_| true)
    }

    /// Glues a surface to the mirror image of the triangles that reach its boundary within so many rings, one at least. O(V + F), and
    /// O(F) for each ring.
    pub fn collar(surface: &Mesh, rings: usize) -> Self {
        let mut is_near: VertexData<bool> = surface.vertices().map(|v| surface.is_boundary_vertex(v)).collect();
        for _ in 1..rings {
            let faces: Vec<FaceId> =
                surface.faces().filter(|&f| surface.corners(f).into_iter().any(|v| is_near[v])).collect();
            faces.into_iter().flat_map(|f| surface.corners(f)).for_each(|v| is_near[v] = true);
        }
        Self::with_image(surface, |f| surface.corners(f).into_iter().any(|v| is_near[v]))
    }

    /// The number of triangles that have an image.
    pub fn image_count(&self) -> usize {
        self.imaged.len()
    }

    /// Glues a surface to the image of some of its triangles, among them all with a corner on the boundary.
    fn with_image(surface: &Mesh, has_image: impl Fn(FaceId) -> bool) -> Self {
        let imaged: Vec<FaceId> = surface.faces().filter(|&f| has_image(f)).collect();
        let mut place: FaceData<u32> = FaceData::constant(surface.face_count(), u32::MAX);
        imaged.iter().zip(surface.face_count() as u32..).for_each(|(&f, k)| place[f] = k);
        // An image has the sides of its triangle backwards.
        let image =
            |h: HalfedgeId| Some(place[surface.face(h)]).filter(|&k| k != u32::MAX).map(|k| 3 * k + 2 - h.0 % 3);
        let own = surface.halfedge_count();
        let mut twin = vec![u32::MAX; own + 3 * imaged.len()];
        for h in surface.halfedges() {
            let across = surface.twin(h);
            twin[h.index()] = across.map_or_else(|| image(h).unwrap_or(u32::MAX), |g| g.0);
            if let Some(here) = image(h) {
                twin[here as usize] = across.map_or(Some(h.0), image).unwrap_or(u32::MAX);
            }
        }
        let mut tail: Vec<VertexId> = surface.halfedges().map(|h| surface.tail(h)).collect();
        tail.resize(twin.len(), VertexId(u32::MAX));
        let mut original: Vec<VertexId> = surface.vertices().collect();
        for h in imaged.iter().flat_map(|&f| surface.sides(f)) {
            let here = image(h).expect("its triangle has one") as usize;
            if tail[here] != VertexId(u32::MAX) {
                continue;
            }
            let v = surface.head(h);
            if surface.is_boundary_vertex(v) {
                tail[here] = v;
                continue;
            }
            // The triangles around an inner vertex may have images in several fans, each with a vertex of its own.
            let name = VertexId::new(original.len());
            original.push(v);
            let next = |h: usize| if h % 3 == 2 { h - 2 } else { h + 1 };
            let across = |h: usize| Some(twin[h] as usize).filter(|&g| g != u32::MAX as usize);
            let mut side = Some(here);
            while let Some(h) = side.filter(|&h| tail[h] != name) {
                tail[h] = name;
                side = across(next(next(h)));
            }
            side = across(here).map(next);
            while let Some(h) = side.filter(|&h| tail[h] != name) {
                tail[h] = name;
                side = across(h).map(next);
            }
        }
        let mesh = Mesh::from_twins(original.len(), tail, twin)
            .unwrap_or_else(|error| unreachable!("the surface and its image are manifold: {error}"));
        Self { mesh, original: original.into(), imaged }
    }

    /// The surface's edge lengths on both sides.
    pub fn metric(&self, surface: &Triangulation, metric: &Metric) -> Metric {
        let own = surface.halfedge_count();
        let of_surface = |h: HalfedgeId| match h.index().checked_sub(own) {
            None => h,
            Some(k) => HalfedgeId::new(3 * self.imaged[k / 3].index() + 2 - k % 3),
        };
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
    fn a_collar_is_the_surface_and_what_is_near_the_boundary_of_its_image() {
        for shape in [shapes::terrain(400, 2), shapes::square(300), shapes::saddle_cone(500)] {
            let surface = shape.mesh();
            let metric = Metric::from_points(&surface, &shape.points);
            let curvature = angle_defects(&surface, &metric);
            let mut before = surface.face_count();
            for rings in [1, 2, 3, 100] {
                let collar = Double::collar(&surface, rings);
                collar.mesh.check();
                assert!(surface.faces().all(|f| surface.corners(f) == collar.mesh.corners(f)));
                assert!(before < collar.mesh.face_count() || rings == 100);
                before = collar.mesh.face_count();
                let lengths = collar.metric(&surface, &metric);
                let own = |v: &VertexId| v.index() < surface.vertex_count();
                for (v, k) in angle_defects(&collar.mesh, &lengths).iter_ids().filter(|(v, _)| own(v)) {
                    assert!(!collar.mesh.is_boundary_vertex(v), "the surface's own boundary can be flipped");
                    let expected = if surface.is_boundary_vertex(v) { 2.0 } else { 1.0 } * curvature[v];
                    assert!((k - expected).abs() < 1e-12);
                }
                let image = |f: &FaceId| f.index() >= surface.face_count();
                for (f, &of) in collar.mesh.faces().filter(image).zip(&collar.imaged) {
                    let mut corners = collar.mesh.corners(f).map(|v| collar.original[v]);
                    corners.reverse();
                    let turned = (0..3).any(|_| {
                        corners.rotate_left(1);
                        corners == surface.corners(of)
                    });
                    assert!(turned, "an image is its triangle backwards");
                }
            }
            assert_eq!(before, 2 * surface.face_count(), "so many rings are all there are");
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
