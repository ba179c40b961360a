//! Opening a mesh along edges.
//!
//! Cutting an edge takes its two triangles apart there. A vertex where k edges are cut falls into k *wedges* (k + 1 on
//! the boundary): runs of corners between one cut and the next. So a wedge is a vertex of the opened surface, and it
//! is what has a position in the plane once that surface is laid out.
//!
//! ```text
//!        ╲   ║   ╱
//!         ╲ 0║1 ╱         v has three cut edges (double lines), hence the wedges 0, 1, 2;
//!      ────╲─v─╱────      an end of a seam has one cut edge and stays whole
//!         ╱╱ 2╲╲
//! ```

use super::islands::Islands;
use crate::mesh::{EdgeData, FaceId, HalfedgeData, HalfedgeId, Id, Mesh, VertexData, VertexId, WedgeData, WedgeId};
use crate::parallel;

/// A mesh opened along some of its edges: what its vertices, islands and boundary are then.
///
/// ```
/// use geom::{CutMesh, EdgeData, Mesh};
/// let tetrahedron = Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])?;
/// let mut cut = EdgeData::constant(tetrahedron.edge_count(), false);
/// for e in tetrahedron.edges().filter(|&e| tetrahedron.ends(e).contains(&geom::VertexId(0))) {
///     cut[e] = true;
/// }
/// let net = CutMesh::open(&tetrahedron, &cut);
/// assert!(net.is_disk());
/// assert_eq!(net.wedge_count(), 6); // the tip three times, and the base
/// # Ok::<(), geom::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct CutMesh {
    wedge: HalfedgeData<WedgeId>,
    vertex: WedgeData<VertexId>,
    /// The wedges of vertex v are `first_wedge[v]..first_wedge[v + 1]`.
    first_wedge: Vec<u32>,
    edge_count: usize,
    islands: Islands,
}

impl CutMesh {
    /// Opens a mesh along the marked edges. Marks on boundary edges change nothing. O(F).
    ///
    /// # Panics
    /// If there is an edge without a mark.
    pub fn open(mesh: &Mesh, cut: &EdgeData<bool>) -> Self {
        let (wedges, islands) = parallel::join(|| Wedges::new(mesh, cut), || Islands::new(mesh, cut));
        let Wedges { wedge, vertex, first_wedge } = wedges;
        // An edge of the opened surface has two sides, or one on its boundary.
        let boundary: usize = islands.boundary_loops().iter().map(Vec::len).sum();
        Self { wedge, vertex, first_wedge, edge_count: (mesh.halfedge_count() + boundary) / 2, islands }
    }

    /// The wedge of the corner at a halfedge's tail.
    #[inline]
    pub fn wedge(&self, h: HalfedgeId) -> WedgeId {
        self.wedge[h]
    }
    /// The three wedges of a triangle, in the order of its halfedges' tails.
    #[inline]
    pub fn corners(&self, f: FaceId) -> [WedgeId; 3] {
        [0, 1, 2].map(|k| self.wedge[HalfedgeId(3 * f.0 + k)])
    }
    /// The vertex that a wedge is a piece of.
    #[inline]
    pub fn vertex(&self, w: WedgeId) -> VertexId {
        self.vertex[w]
    }
    /// The wedges that a vertex falls into, counter-clockwise.
    pub fn wedges(&self, v: VertexId) -> impl ExactSizeIterator<Item = WedgeId> + Clone + use<> {
        (self.first_wedge[v.index()]..self.first_wedge[v.index() + 1]).map(WedgeId)
    }
    /// The number of wedges: the opened surface's vertices.
    pub fn wedge_count(&self) -> usize {
        self.vertex.len()
    }
    /// The number of edges of the opened surface: each cut edge counts twice.
    pub fn edge_count(&self) -> usize {
        self.edge_count
    }
    /// The number of triangles.
    pub fn face_count(&self) -> usize {
        self.islands.of_faces().len()
    }

    /// The [island](Islands::of) that a triangle is on.
    #[inline]
    pub fn island(&self, f: FaceId) -> u32 {
        self.islands.of(f)
    }
    /// The number of islands.
    pub fn island_count(&self) -> usize {
        self.islands.count()
    }

    /// The opened surface's [boundary](Islands::boundary_loops).
    pub fn boundary_loops(&self) -> &[Vec<HalfedgeId>] {
        self.islands.boundary_loops()
    }
    /// The Euler characteristic V - E + F of the opened surface.
    pub fn euler_characteristic(&self) -> i64 {
        self.wedge_count() as i64 - self.edge_count as i64 + self.face_count() as i64
    }
    /// Whether the opened surface is one disk.
    pub fn is_disk(&self) -> bool {
        self.island_count() == 1 && self.euler_characteristic() == 1
    }
}

/// The wedges, as a [`CutMesh`] has them.
struct Wedges {
    wedge: HalfedgeData<WedgeId>,
    vertex: WedgeData<VertexId>,
    first_wedge: Vec<u32>,
}

impl Wedges {
    fn new(mesh: &Mesh, cut: &EdgeData<bool>) -> Self {
        let is_cut = |h: HalfedgeId| cut[mesh.edge(h)];
        // Only ends of cut edges may fall into several wedges: their rings alone are gone round.
        let mut is_end = VertexData::constant(mesh.vertex_count(), false);
        for v in mesh.edges().filter(|&e| cut[e]).flat_map(|e| mesh.ends(e)) {
            is_end[v] = true;
        }
        let mut vertex = Vec::with_capacity(mesh.vertex_count());
        let mut first_wedge = Vec::with_capacity(mesh.vertex_count() + 1);
        first_wedge.push(0);
        let mut of_ends = Vec::new();
        let mut ring = Vec::new();
        for v in mesh.vertices() {
            ring.clear();
            ring.extend(mesh.outgoing(v).take(if is_end[v] { usize::MAX } else { 1 }));
            if is_end[v] && !mesh.is_boundary_vertex(v) {
                let first_cut = ring.iter().position(|&h| is_cut(h)).unwrap_or(0);
                ring.rotate_left(first_cut);
            }
            for (k, &h) in ring.iter().enumerate() {
                if k == 0 || is_cut(h) {
                    vertex.push(v);
                }
                if is_end[v] {
                    of_ends.push((h, WedgeId::new(vertex.len() - 1)));
                }
            }
            first_wedge.push(vertex.len() as u32);
        }
        let first = |h: usize| WedgeId(first_wedge[mesh.tail(HalfedgeId::new(h)).index()]);
        let mut wedge: HalfedgeData<WedgeId> = parallel::map(mesh.halfedge_count(), first).into();
        of_ends.into_iter().for_each(|(h, of_end)| wedge[h] = of_end);
        Self { wedge, vertex: vertex.into(), first_wedge }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts what holds of every opened mesh.
    fn check(mesh: &Mesh, cut: &EdgeData<bool>, open: &CutMesh) {
        for h in mesh.halfedges() {
            assert_eq!(open.vertex(open.wedge(h)), mesh.tail(h), "a wedge is a piece of its corners' vertex");
            if let Some(g) = mesh.twin(h).filter(|_| !cut[mesh.edge(h)]) {
                assert_eq!(open.wedge(h), open.wedge(mesh.next(g)), "{h:?} is not cut: one wedge at its tail");
                assert_eq!(open.island(mesh.face(h)), open.island(mesh.face(g)), "and one island on both sides");
            }
        }
        let mut boundary = 0;
        for around in open.boundary_loops() {
            boundary += around.len();
            for (k, &h) in around.iter().enumerate() {
                assert!(mesh.twin(h).is_none() || cut[mesh.edge(h)]);
                let next = around[(k + 1) % around.len()];
                assert_eq!(open.wedge(mesh.next(h)), open.wedge(next), "a boundary runs on from wedge to wedge");
            }
        }
        assert_eq!(boundary, 2 * open.edge_count() - 3 * open.face_count(), "an edge has two sides or one");
        for v in mesh.vertices() {
            let cuts = mesh.outgoing(v).filter(|&h| mesh.twin(h).is_some() && cut[mesh.edge(h)]).count();
            let wedges = if mesh.is_boundary_vertex(v) { cuts + 1 } else { cuts.max(1) };
            assert_eq!(open.wedges(v).len(), wedges);
            assert!(open.wedges(v).all(|w| open.vertex(w) == v));
        }
    }

    fn octahedron() -> Mesh {
        let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]];
        Mesh::new(6, &faces).unwrap()
    }

    fn marked(mesh: &Mesh, ends: &[[u32; 2]]) -> EdgeData<bool> {
        mesh.edges().map(|e| ends.iter().any(|&[a, b]| [[a, b], [b, a]].contains(&mesh.ends(e).map(|v| v.0)))).collect()
    }

    #[test]
    fn every_set_of_cut_edges_gives_a_consistent_surface() {
        let closed = octahedron();
        let bordered = Mesh::new(6, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2]]).unwrap();
        for mesh in [closed, bordered] {
            for set in 0..1u32 << mesh.edge_count() {
                let cut = mesh.edges().map(|e| set >> e.0 & 1 == 1).collect();
                check(&mesh, &cut, &CutMesh::open(&mesh, &cut));
            }
        }
    }

    #[test]
    fn nothing_cut_changes_nothing() {
        let mesh = octahedron();
        let open = CutMesh::open(&mesh, &EdgeData::constant(mesh.edge_count(), false));
        assert_eq!(open.wedge_count(), mesh.vertex_count());
        assert_eq!(open.euler_characteristic(), 2);
        assert!(open.boundary_loops().is_empty() && !open.is_disk());
    }

    #[test]
    fn a_path_opens_a_sphere_to_a_disk_and_a_circle_to_two() {
        let mesh = octahedron();
        let path = CutMesh::open(&mesh, &marked(&mesh, &[[0, 1], [1, 5]]));
        assert!(path.is_disk());
        assert_eq!([0, 1, 5].map(|v| path.wedges(VertexId(v)).len()), [1, 2, 1]);
        assert_eq!(path.boundary_loops().iter().map(Vec::len).collect::<Vec<_>>(), [4]);

        let circle = CutMesh::open(&mesh, &marked(&mesh, &[[1, 2], [2, 3], [3, 4], [4, 1]]));
        assert_eq!((circle.island_count(), circle.euler_characteristic()), (2, 2));
        assert_eq!(circle.island(FaceId(0)), 0);
        assert_eq!(circle.island(FaceId(4)), 1);
    }

    #[test]
    fn everything_cut_leaves_single_triangles() {
        let mesh = octahedron();
        let open = CutMesh::open(&mesh, &EdgeData::constant(mesh.edge_count(), true));
        assert_eq!((open.wedge_count(), open.island_count()), (24, 8));
    }

    #[test]
    fn a_disk_and_a_ring_are_no_disk() {
        let [disk, ring] = [crate::shapes::disk(50), crate::shapes::cylinder(50)];
        let shift = disk.points.len() as u32;
        let faces: Vec<[u32; 3]> =
            disk.triangles.iter().copied().chain(ring.triangles.iter().map(|t| t.map(|v| v + shift))).collect();
        let mesh = Mesh::new(disk.points.len() + ring.points.len(), &faces).unwrap();
        let open = CutMesh::open(&mesh, &EdgeData::constant(mesh.edge_count(), false));
        assert_eq!((open.euler_characteristic(), open.island_count(), open.is_disk()), (1, 2, false));
    }
}
