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

use crate::mesh::{
    EdgeData, FaceData, FaceId, HalfedgeData, HalfedgeId, Id, Mesh, VertexData, VertexId, WedgeData, WedgeId,
};
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
    island: FaceData<u32>,
    island_count: usize,
    edge_count: usize,
    boundary_loops: Vec<Vec<HalfedgeId>>,
}

impl CutMesh {
    /// Opens a mesh along the marked edges. Marks on boundary edges change nothing. O(F).
    ///
    /// # Panics
    /// If there is an edge without a mark.
    pub fn open(mesh: &Mesh, cut: &EdgeData<bool>) -> Self {
        let across = |h: HalfedgeId| mesh.twin(h).filter(|_| !cut[mesh.edge(h)]);
        let (wedges, ((island, island_count), boundary_loops)) = parallel::join(
            || Wedges::new(mesh, cut),
            || parallel::join(|| islands(mesh, across), || boundary_loops(mesh, across)),
        );
        let Wedges { wedge, vertex, first_wedge } = wedges;
        Self {
            wedge,
            vertex,
            first_wedge,
            island,
            island_count,
            edge_count: mesh.edge_count() + mesh.edges().filter(|&e| cut[e] && !mesh.is_boundary_edge(e)).count(),
            boundary_loops,
        }
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
        self.island.len()
    }

    /// The island that a triangle is on. Islands are numbered by their lowest triangle.
    #[inline]
    pub fn island(&self, f: FaceId) -> u32 {
        self.island[f]
    }
    /// The number of islands: pieces that hang together by edges that are not cut.
    pub fn island_count(&self) -> usize {
        self.island_count
    }

    /// The opened surface's boundary: each loop as its halfedges in order, the surface on their left. Loops start at
    /// their lowest halfedge and are ordered by it.
    pub fn boundary_loops(&self) -> &[Vec<HalfedgeId>] {
        &self.boundary_loops
    }
    /// The Euler characteristic V - E + F of the opened surface.
    pub fn euler_characteristic(&self) -> i64 {
        self.wedge_count() as i64 - self.edge_count as i64 + self.face_count() as i64
    }
    /// Whether the opened surface is one disk.
    pub fn is_disk(&self) -> bool {
        self.island_count == 1 && self.euler_characteristic() == 1
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

/// For each triangle the number of its island, and how many there are; `across` leads over edges that are not cut.
fn islands(mesh: &Mesh, across: impl Fn(HalfedgeId) -> Option<HalfedgeId>) -> (FaceData<u32>, usize) {
    // Each triangle has the label of a neighbour before it, or a new one; labels that meet are one, the least of them.
    let mut same: Vec<u32> = Vec::new();
    fn least(same: &mut [u32], mut label: u32) -> u32 {
        while same[label as usize] != label {
            same[label as usize] = same[same[label as usize] as usize];
            label = same[label as usize];
        }
        label
    }
    let mut island: FaceData<u32> = FaceData::constant(mesh.face_count(), 0);
    for f in mesh.faces() {
        let mut own = None;
        for g in mesh.sides(f).into_iter().filter_map(&across).map(|h| mesh.face(h)).filter(|&g| g < f) {
            let other = least(&mut same, island[g]);
            let [low, high] = own.map_or([other; 2], |own: u32| [own.min(other), own.max(other)]);
            same[high as usize] = low;
            own = Some(low);
        }
        island[f] = own.unwrap_or_else(|| {
            same.push(same.len() as u32);
            same.len() as u32 - 1
        });
    }
    let mut number = vec![0; same.len()];
    let mut count = 0;
    for label in 0..same.len() {
        if same[label] == label as u32 {
            number[label] = count;
            count += 1;
        } else {
            number[label] = number[same[label] as usize]; // a lesser label
        }
    }
    island.iter_mut().for_each(|label| *label = number[*label as usize]);
    (island, count as usize)
}

/// The loops of halfedges over which nothing leads.
fn boundary_loops(mesh: &Mesh, across: impl Fn(HalfedgeId) -> Option<HalfedgeId>) -> Vec<Vec<HalfedgeId>> {
    let mut seen = HalfedgeData::constant(mesh.halfedge_count(), false);
    let mut loops = Vec::new();
    for first in mesh.halfedges() {
        if seen[first] || across(first).is_some() {
            continue;
        }
        let mut around = Vec::new();
        let mut h = first;
        while !seen[h] {
            seen[h] = true;
            around.push(h);
            h = mesh.next(h);
            while let Some(twin) = across(h) {
                h = mesh.next(twin);
            }
        }
        loops.push(around);
    }
    loops
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
