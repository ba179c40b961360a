//! The islands of a mesh that is opened along edges.

use std::ops::Range;

use crate::mesh::{EdgeData, FaceData, FaceId, HalfedgeData, HalfedgeId, Id, Mesh, VertexData};
use crate::parallel;

/// So many triangles or halfedges are gone through one after the other.
const RUN: usize = 1 << 16;

/// The islands that a mesh falls into when it is opened along some of its edges, pieces that hang together by the others, and what bounds
/// them. Where the images of its vertices are told apart, too, see [`CutMesh`](super::CutMesh).
///
/// ```
/// use geom::{EdgeData, FaceId, Islands, Mesh, VertexId};
/// let tetrahedron = Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])?;
/// let cut: EdgeData<bool> = tetrahedron.edges().map(|e| !tetrahedron.ends(e).contains(&VertexId(0))).collect();
/// let islands = Islands::new(&tetrahedron, &cut);
/// assert_eq!((islands.count(), islands.of(FaceId(2)), islands.of(FaceId(3))), (2, 0, 1));
/// assert!(islands.boundary_loops().iter().all(|around| around.len() == 3));
/// # Ok::<(), geom::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Islands {
    of_face: FaceData<u32>,
    count: usize,
    boundary_loops: Vec<Vec<HalfedgeId>>,
}

impl Islands {
    /// Opens a mesh along the marked edges. Marks on boundary edges change nothing. O(F).
    ///
    /// # Panics
    /// If there is an edge without a mark.
    pub fn new(mesh: &Mesh, cut: &EdgeData<bool>) -> Self {
        let across = |h: HalfedgeId| mesh.twin(h).filter(|_| !cut[mesh.edge(h)]);
        let ((of_face, count), boundary_loops) =
            parallel::join(|| numbered(mesh, cut, RUN), || boundary_loops(mesh, across));
        Self { of_face, count, boundary_loops }
    }

    /// The island that a triangle is on. Islands are numbered by their lowest triangle.
    #[inline]
    pub fn of(&self, f: FaceId) -> u32 {
        self.of_face[f]
    }
    /// The island that each triangle is on.
    pub fn of_faces(&self) -> &FaceData<u32> {
        &self.of_face
    }
    /// How many islands there are.
    pub fn count(&self) -> usize {
        self.count
    }
    /// The triangles of each island, ascending.
    pub fn faces(&self) -> Vec<Vec<FaceId>> {
        let mut faces = vec![Vec::new(); self.count];
        self.of_face.iter_ids().for_each(|(f, &island)| faces[island as usize].push(f));
        faces
    }

    /// What bounds the islands: each loop as its halfedges in order, the surface on their left. Loops start at their lowest halfedge and are
    /// ordered by it.
    pub fn boundary_loops(&self) -> &[Vec<HalfedgeId>] {
        &self.boundary_loops
    }
}

/// Which vertices are on the boundary of a mesh that is opened along the marked edges. O(V + E).
///
/// # Panics
/// If there is an edge without a mark.
pub fn open_vertices(mesh: &Mesh, cut: &EdgeData<bool>) -> VertexData<bool> {
    let mut is_open: VertexData<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
    mesh.edges().filter(|&e| cut[e]).flat_map(|e| mesh.ends(e)).for_each(|v| is_open[v] = true);
    is_open
}

/// For each triangle the number of its island, and how many there are. Triangles are labelled in runs of so many.
fn numbered(mesh: &Mesh, cut: &EdgeData<bool>, run: usize) -> (FaceData<u32>, usize) {
    let runs = parallel::of_runs(mesh.face_count(), run, |run| Labels::new(mesh, cut, run));
    let mut same: Vec<u32> = Vec::new();
    let mut first = Vec::with_capacity(runs.len());
    for labels in &runs {
        let before = same.len() as u32;
        first.push(before);
        same.extend(labels.same.iter().map(|label| before + label));
    }
    let label = |f: usize| first[f / run] + runs[f / run].of_face[f % run];
    for (labels, first) in runs.iter().zip(&first) {
        labels.beside.iter().for_each(|&(own, g)| _ = join(&mut same, first + own, label(g.index())));
    }
    let mut number = vec![0; same.len()];
    let mut count = 0;
    for (k, &of_label) in same.iter().enumerate() {
        if of_label == k as u32 {
            number[k] = count;
            count += 1;
        } else {
            number[k] = number[of_label as usize]; // a lesser label
        }
    }
    (parallel::map(mesh.face_count(), |f| number[label(f) as usize]).into(), count as usize)
}

/// Labels of a run of triangles: each has that of a neighbour before it, or a new one. Labels that meet are one, the least of them.
struct Labels {
    of_face: Vec<u32>,
    /// For each label itself, or a lesser one that is the same.
    same: Vec<u32>,
    /// Labels that are those of triangles before the run.
    beside: Vec<(u32, FaceId)>,
}

impl Labels {
    fn new(mesh: &Mesh, cut: &EdgeData<bool>, run: Range<usize>) -> Self {
        let mut labels = Self { of_face: Vec::with_capacity(run.len()), same: Vec::new(), beside: Vec::new() };
        let mut outside = Vec::new();
        for f in run.clone().map(FaceId::new) {
            let mut own = None;
            for h in mesh.sides(f) {
                let Some(g) = mesh.twin(h).map(|twin| mesh.face(twin)).filter(|&g| g < f && !cut[mesh.edge(h)]) else {
                    continue;
                };
                if g.index() < run.start {
                    outside.push(g);
                    continue;
                }
                let other = least(&mut labels.same, labels.of_face[g.index() - run.start]);
                own = Some(match own {
                    Some(own) if own != other => join(&mut labels.same, own, other),
                    _ => other,
                });
            }
            let own = own.unwrap_or_else(|| {
                labels.same.push(labels.same.len() as u32);
                labels.same.len() as u32 - 1
            });
            labels.of_face.push(own);
            labels.beside.extend(outside.drain(..).map(|g| (own, g)));
        }
        labels
    }
}

/// The least label that is the same as one.
fn least(same: &mut [u32], mut label: u32) -> u32 {
    while same[label as usize] != label {
        same[label as usize] = same[same[label as usize] as usize];
        label = same[label as usize];
    }
    label
}

/// Makes two labels one: the least of them.
fn join(same: &mut [u32], one: u32, other: u32) -> u32 {
    let [one, other] = [one, other].map(|label| least(same, label));
    let low = one.min(other);
    same[one.max(other) as usize] = low;
    low
}

/// The loops of halfedges over which nothing leads.
fn boundary_loops(mesh: &Mesh, across: impl Fn(HalfedgeId) -> Option<HalfedgeId> + Sync) -> Vec<Vec<HalfedgeId>> {
    let open = |run: Range<usize>| run.map(HalfedgeId::new).filter(|&h| across(h).is_none()).collect::<Vec<_>>();
    let open = parallel::of_runs(mesh.halfedge_count(), RUN, open);
    let mut seen = HalfedgeData::constant(mesh.halfedge_count(), false);
    let mut loops = Vec::new();
    for first in open.into_iter().flatten() {
        if seen[first] {
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
    use crate::shapes;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn islands_are_the_same_in_runs_of_any_length(marks: Vec<bool>, size in 60..200_usize, run in 1..9_usize) {
            for shape in [shapes::hare(size), shapes::torus(1, size), shapes::terrain(size, 3)] {
                let mesh = shape.mesh();
                // With the marks one after the other, over and over, most edges are cut or few.
                let cut: EdgeData<bool> = mesh.edges().map(|e| marks.get(e.index() % marks.len().max(1)) == Some(&true)).collect();
                let across = |h: HalfedgeId| mesh.twin(h).filter(|_| !cut[mesh.edge(h)]);
                let (in_one, count) = numbered(&mesh, &cut, mesh.face_count());
                prop_assert_eq!(numbered(&mesh, &cut, run), (in_one.clone(), count));
                // Each island is reached from its lowest triangle, and these ascend.
                let mut flooded = FaceData::constant(mesh.face_count(), u32::MAX);
                let mut seeds = 0;
                for seed in mesh.faces() {
                    let mut waiting = vec![seed];
                    seeds += u32::from(flooded[seed] == u32::MAX);
                    while let Some(f) = waiting.pop() {
                        if flooded[f] == u32::MAX {
                            flooded[f] = seeds - 1;
                            waiting.extend(mesh.sides(f).into_iter().filter_map(across).map(|h| mesh.face(h)));
                        }
                    }
                }
                prop_assert_eq!((in_one, count), (flooded, seeds as usize));
            }
        }
    }
}
