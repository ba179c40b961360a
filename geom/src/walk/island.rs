//! The islands of an opened mesh as meshes of their own.

use crate::mesh::{EdgeData, EdgeId, HalfedgeData, HalfedgeId, Id, Mesh, VertexData, VertexId};

use super::cut::CutMesh;

/// An island of a mesh that was opened along some of its edges: its boundary is the mesh's and both sides of the cuts.
#[derive(Clone, Debug)]
pub struct OpenedIsland {
    /// The island; a vertex of it is a [wedge](CutMesh) of the whole.
    pub mesh: Mesh,
    /// The whole mesh's halfedge that each of the island's is.
    pub halfedge: HalfedgeData<HalfedgeId>,
}

impl OpenedIsland {
    /// The whole mesh's vertex that each of the island's is. O(F).
    pub fn vertices_of(&self, whole: &Mesh) -> VertexData<VertexId> {
        let mut vertex = VertexData::constant(self.mesh.vertex_count(), VertexId(0));
        self.mesh.halfedges().for_each(|h| vertex[self.mesh.tail(h)] = whole.tail(self.halfedge[h]));
        vertex
    }

    /// The whole mesh's edge that each of the island's is. O(F).
    pub fn edges_of(&self, whole: &Mesh) -> EdgeData<EdgeId> {
        self.mesh.edges().map(|e| whole.edge(self.halfedge[self.mesh.halfedge(e)])).collect()
    }
}

/// The islands that a mesh falls into when it is opened along the marked edges, in the order of their lowest triangles. Triangles
/// keep their order. O(F).
///
/// ```
/// use geom::{Mesh, VertexId, open_islands};
/// let octahedron = Mesh::new(
///     6,
///     &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]],
/// )?;
/// let is_equator = |v: VertexId| (1..5).contains(&v.0);
/// let cut = octahedron.edges().map(|e| octahedron.ends(e).into_iter().all(is_equator)).collect();
/// let halves = open_islands(&octahedron, &cut);
/// assert_eq!(halves.len(), 2);
/// assert!(halves.iter().all(|half| half.mesh.euler_characteristic() == 1));
/// # Ok::<(), geom::MeshError>(())
/// ```
///
/// # Panics
/// If there is an edge without a mark.
pub fn open_islands(mesh: &Mesh, cut: &EdgeData<bool>) -> Vec<OpenedIsland> {
    let opened = CutMesh::open(mesh, cut);
    let mut faces = vec![Vec::new(); opened.island_count()];
    let mut place = vec![0u32; mesh.face_count()];
    for f in mesh.faces() {
        let island = &mut faces[opened.island(f) as usize];
        place[f.index()] = island.len() as u32;
        island.push(f);
    }
    let mut local = vec![u32::MAX; opened.wedge_count()];
    let island = |faces: Vec<_>| {
        let halfedge: HalfedgeData<HalfedgeId> = faces.iter().flat_map(|&f| mesh.sides(f)).collect();
        let mut count = 0;
        let mut vertex = |h: HalfedgeId| {
            let number = &mut local[opened.wedge(h).index()];
            if *number == u32::MAX {
                *number = count;
                count += 1;
            }
            VertexId(*number)
        };
        let tail = halfedge.iter().map(|&h| vertex(h)).collect();
        let across = |h: HalfedgeId| mesh.twin(h).filter(|_| !cut[mesh.edge(h)]);
        let renumbered = |g: HalfedgeId| 3 * place[mesh.face(g).index()] + g.0 % 3;
        let twin = halfedge.iter().map(|&h| across(h).map_or(u32::MAX, renumbered)).collect();
        let mesh = Mesh::from_twins(count as usize, tail, twin).expect("a wedge is one fan");
        OpenedIsland { mesh, halfedge }
    };
    faces.into_iter().map(island).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn islands_are_the_opened_mesh_in_pieces(every in 1u32..9, genus in 0u8..3, seed in 0u32..50) {
            let mesh = if genus == 0 { shapes::hare(300).mesh() } else { shapes::torus(genus, 400).mesh() };
            let cut = mesh.edges().map(|e| (e.0 * 7919 + seed) % 9 < every).collect();
            let opened = CutMesh::open(&mesh, &cut);
            let islands = open_islands(&mesh, &cut);
            prop_assert_eq!(islands.len(), opened.island_count());
            let euler: i64 = islands.iter().map(|island| island.mesh.euler_characteristic()).sum();
            prop_assert_eq!(euler, opened.euler_characteristic());
            let loops: usize = islands.iter().map(|island| island.mesh.boundary_loops().len()).sum();
            prop_assert_eq!(loops, opened.boundary_loops().len());
            for island in &islands {
                island.mesh.check();
                for h in island.mesh.halfedges() {
                    let whole = island.halfedge[h];
                    let across = mesh.twin(whole).filter(|_| !cut[mesh.edge(whole)]);
                    prop_assert_eq!(island.mesh.twin(h).map(|g| island.halfedge[g]), across);
                }
            }
        }
    }

    #[test]
    fn a_single_cut_edge_is_a_loop_of_two() {
        let mesh = shapes::hare(300).mesh();
        let cut = mesh.edges().map(|e| e.0 == 200).collect();
        let islands = open_islands(&mesh, &cut);
        assert_eq!(islands.len(), 1);
        assert_eq!(islands[0].mesh.boundary_loops().iter().map(Vec::len).collect::<Vec<_>>(), [2]);
    }
}
