//! Connectivity of triangle meshes.
//!
//! A [`Triangulation`] is triangles glued along sides, and can be flipped. A [`Mesh`] is one that stays as it is and
//! therefore knows each vertex's ring; it is a graph for everything that takes petgraph's visit traits.

mod build;
mod graph;
mod id;
mod removal;
mod triangulation;
mod walk;

pub use build::MeshError;
pub(crate) use build::{Twins, of_edges};
pub use graph::VisitedVertices;
pub use id::{
    Data, EdgeData, EdgeId, FaceData, FaceId, HalfedgeData, HalfedgeId, Id, VertexData, VertexId, WedgeData, WedgeId,
};
pub use triangulation::Triangulation;

use std::ops::Deref;

use crate::parallel::join;

/// An oriented manifold triangle mesh, with or without boundary: connectivity only, no positions and no lengths.
///
/// ```
/// use geom::Mesh;
/// let tetrahedron = Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])?;
/// assert_eq!(tetrahedron.edge_count(), 6);
/// assert_eq!(tetrahedron.euler_characteristic(), 2);
/// # Ok::<(), geom::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    triangulation: Triangulation,
    /// For each vertex an outgoing halfedge; on the boundary the one along it, so that a walk counter-clockwise meets
    /// all the others.
    vertex_halfedge: Vec<HalfedgeId>,
    /// The neighbours of vertex v, counter-clockwise, are `ring[ring_start[v]..ring_start[v + 1]]`.
    ring_start: Vec<u32>,
    ring: Vec<VertexId>,
}

impl Mesh {
    /// The rings of a triangulation. O(V + F).
    ///
    /// # Errors
    /// If a vertex is in no triangle or in several fans.
    pub fn from_triangulation(triangulation: Triangulation) -> Result<Self, MeshError> {
        let unset = HalfedgeId(u32::MAX);
        let mut vertex_halfedge = vec![unset; triangulation.vertex_count()];
        let mut degree = vec![0u32; triangulation.vertex_count()];
        for h in triangulation.halfedges() {
            let v = triangulation.tail(h);
            degree[v.index()] += 1;
            let first = &mut vertex_halfedge[v.index()];
            if triangulation.twin(h).is_none() {
                if *first != unset && triangulation.twin(*first).is_none() {
                    return Err(MeshError::NonManifoldVertex(v));
                }
                *first = h;
            } else if *first == unset {
                *first = h;
            }
        }
        if let Some(v) = vertex_halfedge.iter().position(|&h| h == unset) {
            return Err(MeshError::IsolatedVertex(VertexId::new(v)));
        }
        // A ring on the boundary has one vertex more than triangles.
        let mut ring_start = vec![0];
        let mut end = 0;
        ring_start.extend(vertex_halfedge.iter().zip(degree).map(|(&first, degree)| {
            end += degree + u32::from(triangulation.twin(first).is_none());
            end
        }));
        let mut ring = vec![VertexId(0); end as usize];
        fill_rings(&triangulation, &vertex_halfedge, &ring_start, &mut ring)?;
        Ok(Self { triangulation, vertex_halfedge, ring_start, ring })
    }

    /// The connectivity alone, to be flipped.
    pub fn triangulation(&self) -> &Triangulation {
        &self.triangulation
    }

    /// The neighbours of a vertex, counter-clockwise; on the boundary from one boundary neighbour to the other. An
    /// intrinsic mesh may name a vertex twice, or the vertex itself.
    #[inline]
    pub fn neighbors(&self, v: VertexId) -> &[VertexId] {
        &self.ring[self.ring_start[v.index()] as usize..self.ring_start[v.index() + 1] as usize]
    }

    /// Whether a vertex lies on the boundary.
    #[inline]
    pub fn is_boundary_vertex(&self, v: VertexId) -> bool {
        self.twin(self.vertex_halfedge[v.index()]).is_none()
    }

    /// The number of triangles at a vertex (corners, where a triangle meets it more than once).
    pub fn face_degree(&self, v: VertexId) -> usize {
        self.neighbors(v).len() - usize::from(self.is_boundary_vertex(v))
    }

    /// Asserts every invariant.
    ///
    /// # Panics
    /// If one does not hold.
    pub fn check(&self) {
        self.triangulation.check();
        assert_eq!(self.ring_start.len(), self.vertex_count() + 1);
        let boundary_vertices = self.vertices().filter(|&v| self.is_boundary_vertex(v)).count();
        assert_eq!(self.ring.len(), self.halfedge_count() + boundary_vertices, "rings hold every neighbour once");
        for v in self.vertices() {
            assert!(self.outgoing(v).all(|h| self.tail(h) == v), "what goes out of a vertex starts there");
            assert_eq!(self.outgoing(v).count(), self.face_degree(v), "one outgoing halfedge a triangle");
            assert!(self.outgoing(v).skip(1).all(|h| self.twin(h).is_some()), "the boundary comes first");
        }
    }
}

/// So many vertices' rings are filled one after the other.
const AT_ONCE: usize = 4096;

/// Fills the rings of consecutive vertices, given where each starts, from a halfedge at each.
///
/// # Errors
/// With the first vertex whose triangles are more than those of one fan.
fn fill_rings(
    triangulation: &Triangulation,
    vertex_halfedge: &[HalfedgeId],
    ring_start: &[u32],
    ring: &mut [VertexId],
) -> Result<(), MeshError> {
    if vertex_halfedge.len() > AT_ONCE {
        let half = vertex_halfedge.len() / 2;
        let (low, high) = ring.split_at_mut((ring_start[half] - ring_start[0]) as usize);
        let (low, high) = join(
            || fill_rings(triangulation, &vertex_halfedge[..half], &ring_start[..=half], low),
            || fill_rings(triangulation, &vertex_halfedge[half..], &ring_start[half..], high),
        );
        return low.and(high);
    }
    for (&first, ends) in vertex_halfedge.iter().zip(ring_start.windows(2)) {
        let ring = &mut ring[(ends[0] - ring_start[0]) as usize..(ends[1] - ring_start[0]) as usize];
        let (mut filled, mut last) = (0, first);
        for (place, h) in ring.iter_mut().zip(walk::Outgoing::new(triangulation, first)) {
            *place = triangulation.head(h);
            (filled, last) = (filled + 1, h);
        }
        let closing = triangulation.prev(last);
        if triangulation.twin(closing).is_none() && filled < ring.len() {
            ring[filled] = triangulation.tail(closing);
            filled += 1;
        }
        if filled < ring.len() {
            return Err(MeshError::NonManifoldVertex(triangulation.tail(first)));
        }
    }
    Ok(())
}

impl Deref for Mesh {
    type Target = Triangulation;
    fn deref(&self) -> &Triangulation {
        &self.triangulation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Mesh {
        Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]).unwrap()
    }

    #[cfg(feature = "rayon")]
    #[test]
    fn triangles_are_glued_alike_on_any_number_of_threads() {
        // Enough vertices for three parts.
        let shape = crate::shapes::hare(50_000);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| shape.mesh())
        };
        let one = on(1);
        one.check();
        let twins = |mesh: &Mesh| mesh.halfedges().map(|h| mesh.twin(h)).collect::<Vec<_>>();
        assert!([2, 3].iter().all(|&threads| twins(&on(threads)) == twins(&one)));
    }

    #[test]
    fn every_flip_can_be_undone() {
        let mesh = tetrahedron();
        for e in mesh.edges() {
            let mut flipped = mesh.triangulation().clone();
            // Flip all that can be flipped, in turn, which makes loops and repeated edges; then undo it backwards.
            let log: Vec<_> = (0..20)
                .filter_map(|k| {
                    let e = EdgeId::new((e.index() + k) % mesh.edge_count());
                    flipped.is_flippable(e).then(|| {
                        let h = flipped.halfedge(e);
                        flipped.flip(h);
                        flipped.check();
                        h
                    })
                })
                .collect();
            assert!(log.len() > 6);
            Mesh::from_triangulation(flipped.clone()).unwrap().check();
            for &h in log.iter().rev() {
                flipped.unflip(h);
                flipped.check();
            }
            assert_eq!(flipped, *mesh.triangulation());
        }
    }

    #[test]
    fn boundary_loops_do_not_count_as_handles() {
        assert_eq!([tetrahedron(), crate::shapes::cylinder(100).mesh()].map(|mesh| mesh.genus()), [0, 0]);
        let torus = crate::shapes::torus(1, 300);
        let opened = Mesh::new(torus.points.len(), &torus.triangles[1..]).unwrap();
        assert_eq!((opened.genus(), opened.boundary_loops().len()), (1, 1));
    }

    #[test]
    fn rings_run_counter_clockwise_and_start_at_the_boundary() {
        let fan = Mesh::new(4, &[[0, 1, 2], [0, 2, 3]]).unwrap();
        fan.check();
        assert_eq!(fan.neighbors(VertexId(0)), [1, 2, 3].map(VertexId));
        assert_eq!(fan.neighbors(VertexId(2)), [3, 0, 1].map(VertexId));
        tetrahedron().check();
    }

    #[test]
    fn rings_of_many_vertices_are_those_of_few() {
        // Filled on several threads, and with a vertex of two fans among them.
        let shape = crate::shapes::hare(3 * AT_ONCE);
        let mesh = shape.mesh();
        mesh.check();
        for v in [mesh.vertex_count() / 3, mesh.vertex_count() - 1].map(VertexId::new) {
            let far = VertexId(0);
            assert!(v != far && !mesh.neighbors(v).contains(&far));
            let pinched = shape.triangles.iter().map(|t| t.map(|w| if w == far.0 { v.0 - 1 } else { w - 1 }));
            let pinched: Vec<[u32; 3]> = pinched.collect();
            assert_eq!(
                Mesh::new(mesh.vertex_count() - 1, &pinched),
                Err(MeshError::NonManifoldVertex(VertexId(v.0 - 1)))
            );
        }
    }

    #[test]
    fn what_is_no_manifold_is_refused_by_name() {
        use MeshError::*;
        let new = |n, faces: &[[u32; 3]]| Mesh::new(n, faces).unwrap_err();
        assert_eq!(new(3, &[]), NoFaces);
        assert_eq!(new(3, &[[0, 1, 3]]), VertexOutOfRange { face: FaceId(0), vertex: 3, count: 3 });
        assert_eq!(new(3, &[[0, 1, 1]]), RepeatedVertex { face: FaceId(0), vertex: VertexId(1) });
        assert_eq!(new(3, &[[0, 1, 0]]), RepeatedVertex { face: FaceId(0), vertex: VertexId(0) });
        assert_eq!(new(4, &[[0, 1, 2]]), IsolatedVertex(VertexId(3)));
        let tetrahedron = |a, b, c| [[0, a, b], [0, b, c], [0, c, a], [a, c, b]];
        let two = [tetrahedron(1, 2, 3), tetrahedron(4, 5, 6)].concat();
        assert_eq!(new(7, &two), NonManifoldVertex(VertexId(0)));
        assert_eq!(new(5, &[[0, 1, 2], [0, 3, 4]]), NonManifoldVertex(VertexId(0)));
        assert_eq!(new(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]), NonManifoldEdge { ends: [VertexId(0), VertexId(1)] });
        assert!(matches!(new(4, &[[0, 1, 2], [0, 1, 3]]), Misoriented { .. }));
    }
}
