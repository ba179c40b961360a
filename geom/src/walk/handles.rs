//! Short loops that open the handles of a surface: disjoint, and together not separating.
//!
//! For several roots a tree of shortest paths and its maximum cotree leave the edges that close short loops (Erickson & Whittlesey 2005,
//! "Greedy optimal homotopy and homology generators"). Of the loops of all roots the shortest are taken that meet no other and no boundary and are
//! independent in homology: disjoint loops separate a surface only if they are not. Homology is told by signatures: for each edge a
//! vector over the field of two elements, one entry for each generator, that sums to zero round every triangle and every boundary loop
//! (Erickson & Nayyeri 2011, "Minimum cuts and shortest non-separating cycles via homology covers").

use super::path::{ShortestPaths, kruskal, maximum_spanning_cotree_watched, other_end};
use crate::mesh::{EdgeData, EdgeId, HalfedgeData, Id, Mesh, VertexData, VertexId};
use crate::watch::{Interrupted, Watch};

/// So many roots a round, if the surface is not large: a loop is only as short as it is near a root.
const ROOTS: usize = 16;
/// So many vertices are gone through a round, but for the least number of roots.
const REACHED: usize = 1_000_000;
/// And so many roots at least.
const LEAST_ROOTS: usize = 3;
/// So many rounds, each with the loops of the earlier ones taken out.
const ROUNDS: usize = 12;

/// A closed walk along edges that visits no vertex twice: `edges[k]` leads from `vertices[k]` to `vertices[k + 1]`, the last one
/// back to the first.
#[derive(Clone, Debug, PartialEq)]
pub struct HandleLoop {
    /// The edges.
    pub edges: Vec<EdgeId>,
    /// The vertices.
    pub vertices: Vec<VertexId>,
    /// The sum of the edges' lengths.
    pub length: f64,
}

/// Loops along which a connected surface is opened so that it has no handles any more: one for each, disjoint from each other and from the boundary,
/// short ones, the shortest first. Fewer where no more are found, as on surfaces of very few vertices; each opens a handle all the same.
/// Edges of infinite length are in none. O(V log V) for each of up to 16 roots a round, of which there is one for each few handles.
///
/// ```
/// let torus = geom::shapes::torus(1, 400);
/// let mesh = torus.mesh();
/// let metric = geom::Metric::from_points(&mesh, &torus.points);
/// let loops = geom::handle_loops(&mesh, metric.lengths(), geom::Watch::NONE)?;
/// assert_eq!(loops.len(), 1);
/// # Ok::<(), geom::Interrupted>(())
/// ```
///
/// # Errors
/// If it is stopped.
///
/// # Panics
/// If there is an edge without a length.
pub fn handle_loops(mesh: &Mesh, lengths: &EdgeData<f64>, watch: Watch) -> Result<Vec<HandleLoop>, Interrupted> {
    let mut taken: Vec<HandleLoop> = Vec::new();
    let genus = mesh.genus();
    if genus == 0 {
        return Ok(taken);
    }
    let signatures = Signatures::new(mesh, watch.within(0.0, 0.1))?;
    let mut basis = Basis::default();
    let mut lengths = lengths.clone();
    let close = |v: VertexId, lengths: &mut EdgeData<f64>| {
        super::path::edges_at(mesh, v).for_each(|(e, _)| lengths[e] = f64::INFINITY);
    };
    mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).for_each(|v| close(v, &mut lengths));
    let mut roots = Roots::new(mesh);
    let count = (REACHED / mesh.vertex_count()).clamp(LEAST_ROOTS, ROOTS);
    for round in 0..ROUNDS {
        let watch =
            watch.within(0.1 + 0.9 * round as f64 / ROUNDS as f64, 0.1 + 0.9 * (round + 1) as f64 / ROUNDS as f64);
        let mut loops = Vec::new();
        for k in 0..count {
            let part = |k: usize| k as f64 / count as f64;
            loops.extend(roots.next(&lengths, watch.within(part(k), part(k + 1)))?);
        }
        loops.sort_by(|a, b| a.length.total_cmp(&b.length).then_with(|| a.edges.cmp(&b.edges)));
        let before = taken.len();
        for around in loops {
            if taken.len() < genus
                && around.edges.iter().all(|&e| lengths[e].is_finite())
                && basis.add(signatures.of(&around.edges))
            {
                around.vertices.iter().for_each(|&v| close(v, &mut lengths));
                taken.push(around);
            }
        }
        if taken.len() == genus || taken.len() == before {
            break;
        }
    }
    taken.sort_by(|a, b| a.length.total_cmp(&b.length).then_with(|| a.edges.cmp(&b.edges)));
    Ok(taken)
}

/// Roots far from each other.
struct Roots<'a> {
    mesh: &'a Mesh,
    /// The distance from the roots so far.
    nearest: VertexData<f64>,
}

impl<'a> Roots<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, nearest: VertexData::constant(mesh.vertex_count(), f64::MAX) }
    }

    /// The short loops of the next root.
    fn next(&mut self, lengths: &EdgeData<f64>, watch: Watch) -> Result<Vec<HandleLoop>, Interrupted> {
        let mesh = self.mesh;
        let is_open = |v: &VertexId| super::path::edges_at(mesh, *v).any(|(e, _)| lengths[e].is_finite());
        let far = |v: &VertexId| self.nearest[*v];
        let root = mesh.vertices().filter(is_open).max_by(|a, b| far(a).total_cmp(&far(b)).then(b.cmp(a)));
        let Some(root) = root else { return Ok(Vec::new()) };
        let paths = ShortestPaths::new_watched(mesh, lengths, [(root, 0)], watch.within(0.0, 0.5))?;
        for (v, distance) in paths.distance.iter_ids() {
            self.nearest[v] = self.nearest[v].min(*distance);
        }
        let mut tree = EdgeData::constant(mesh.edge_count(), false);
        paths.predecessor.iter().flatten().for_each(|&e| tree[e] = true);
        let through = |e: EdgeId| lengths[e] + mesh.ends(e).iter().map(|&v| paths.distance[v]).sum::<f64>();
        let weight: EdgeData<f64> = mesh.edges().map(through).collect();
        let cotree = maximum_spanning_cotree_watched(mesh, &weight, &tree, watch.within(0.5, 1.0))?;
        let left = mesh.edges().filter(|&e| !tree[e] && !cotree[e] && weight[e].is_finite());
        Ok(left.map(|e| closed(mesh, lengths, &paths, e)).collect())
    }
}

/// The loop that an edge closes with the paths of its ends up to where these meet.
fn closed(mesh: &Mesh, lengths: &EdgeData<f64>, paths: &ShortestPaths, e: EdgeId) -> HandleLoop {
    let [from, to] = mesh.ends(e).map(|v| {
        let mut way = vec![(None, v)];
        way.extend(paths.to_source(mesh, v).map(|(e, w)| (Some(e), w)));
        way
    });
    // Both ways end at the root: what they share is at their ends.
    let shared = from.iter().rev().zip(to.iter().rev()).take_while(|(a, b)| a.1 == b.1).count();
    let (out, back) = (&to[..=to.len() - shared], &from[..=from.len() - shared]);
    // From the end of the edge to where the paths meet, then back to its beginning.
    let mut edges = vec![e];
    let mut vertices = vec![back[0].1];
    edges.extend(out[1..].iter().filter_map(|step| step.0));
    vertices.extend(out[..out.len() - 1].iter().map(|step| step.1));
    edges.extend(back[1..].iter().rev().filter_map(|step| step.0));
    vertices.extend(back[1..].iter().rev().map(|step| step.1));
    let length = edges.iter().map(|&e| lengths[e]).sum();
    debug_assert!(
        (0..edges.len()).all(|k| { other_end(mesh, edges[k], vertices[k]) == vertices[(k + 1) % vertices.len()] })
    );
    HandleLoop { edges, vertices, length }
}

/// What tells the homology of loops.
struct Signatures {
    /// Words of 64 entries for each edge.
    words: usize,
    entries: Vec<u64>,
}

impl Signatures {
    fn new(mesh: &Mesh, watch: Watch) -> Result<Self, Interrupted> {
        let lengths = EdgeData::constant(mesh.edge_count(), 1.0);
        let paths = ShortestPaths::new_watched(mesh, &lengths, [(VertexId(0), 0)], watch)?;
        let mut is_tree = EdgeData::constant(mesh.edge_count(), false);
        paths.predecessor.iter().flatten().for_each(|&e| is_tree[e] = true);
        let sides = closed_sides(mesh);
        let nodes = mesh.face_count() + mesh.boundary_loops().len();
        let rest: Vec<EdgeId> = mesh.edges().filter(|&e| !is_tree[e]).collect();
        let cotree = kruskal(nodes, rest.iter().map(|&e| (e, sides[e])));
        let mut is_cotree = EdgeData::constant(mesh.edge_count(), false);
        cotree.iter().for_each(|&e| is_cotree[e] = true);
        let generators: Vec<EdgeId> = rest.into_iter().filter(|&e| !is_cotree[e]).collect();
        let words = generators.len().div_ceil(64);
        let mut found = Self { words, entries: vec![0; words * mesh.edge_count()] };
        for (k, e) in generators.iter().enumerate() {
            found.entries[words * e.index() + k / 64] |= 1 << (k % 64);
        }
        found.sum_to_zero(mesh, nodes, &sides, &cotree);
        Ok(found)
    }

    /// Gives the edges of the cotree their signatures, from its leaves on: what the other edges round a node sum to.
    fn sum_to_zero(&mut self, mesh: &Mesh, nodes: usize, sides: &EdgeData<[u32; 2]>, cotree: &[EdgeId]) {
        let mut around: Vec<Vec<EdgeId>> = vec![Vec::new(); nodes];
        let mut tree: Vec<Vec<EdgeId>> = vec![Vec::new(); nodes];
        mesh.edges().for_each(|e| sides[e].iter().for_each(|&node| around[node as usize].push(e)));
        cotree.iter().for_each(|&e| sides[e].iter().for_each(|&node| tree[node as usize].push(e)));
        // Each node with the edge that leads to it from the first, in an order in which no node comes before that one's.
        let mut order: Vec<(u32, Option<EdgeId>)> = vec![(0, None)];
        let mut at = 0;
        while let Some(&(node, parent)) = order.get(at) {
            at += 1;
            for &e in tree[node as usize].iter().filter(|&&e| Some(e) != parent) {
                let [a, b] = sides[e];
                order.push((if a == node { b } else { a }, Some(e)));
            }
        }
        for &(node, parent) in order.iter().rev() {
            let Some(parent) = parent else { continue };
            let mut sum = vec![0; self.words];
            for &e in around[node as usize].iter().filter(|&&e| e != parent) {
                sum.iter_mut().zip(self.edge(e)).for_each(|(sum, entry)| *sum ^= entry);
            }
            self.entries[self.words * parent.index()..][..self.words].copy_from_slice(&sum);
        }
    }

    fn edge(&self, e: EdgeId) -> &[u64] {
        &self.entries[self.words * e.index()..][..self.words]
    }

    /// Of a loop: zero if it separates, but for handles that are not opened by it.
    fn of(&self, edges: &[EdgeId]) -> Vec<u64> {
        let mut sum = vec![0; self.words];
        for &e in edges {
            sum.iter_mut().zip(self.edge(e)).for_each(|(sum, entry)| *sum ^= entry);
        }
        sum
    }
}

/// The faces at both sides of each edge; boundary loops are counted on as faces.
fn closed_sides(mesh: &Mesh) -> EdgeData<[u32; 2]> {
    let mut outside = HalfedgeData::constant(mesh.halfedge_count(), u32::MAX);
    for (k, around) in (mesh.face_count() as u32..).zip(mesh.boundary_loops()) {
        around.iter().for_each(|&h| outside[h] = k);
    }
    let sides = |e: EdgeId| {
        let h = mesh.halfedge(e);
        [mesh.face(h).0, mesh.twin(h).map_or(outside[h], |g| mesh.face(g).0)]
    };
    mesh.edges().map(sides).collect()
}

/// Independent vectors over the field of two elements, each with its first entry, which no other has.
#[derive(Default)]
struct Basis(Vec<(usize, Vec<u64>)>);

impl Basis {
    /// Takes a vector if it is independent of those taken.
    fn add(&mut self, mut vector: Vec<u64>) -> bool {
        let has = |vector: &[u64], entry: usize| vector[entry / 64] >> (entry % 64) & 1 == 1;
        for (first, row) in &self.0 {
            if has(&vector, *first) {
                vector.iter_mut().zip(row).for_each(|(x, y)| *x ^= y);
            }
        }
        let Some(first) = (0..64 * vector.len()).find(|&entry| has(&vector, entry)) else { return false };
        for (_, row) in self.0.iter_mut().filter(|(_, row)| has(row, first)) {
            row.iter_mut().zip(&vector).for_each(|(x, y)| *x ^= y);
        }
        self.0.push((first, vector));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::open_islands;
    use crate::{Metric, shapes};
    use proptest::prelude::*;

    /// Opens a surface along its loops, after some of its triangles were taken out.
    fn check(shape: &shapes::Shape, out: &[u32]) {
        let triangles: Vec<[u32; 3]> =
            (0..).zip(&shape.triangles).filter(|(f, _)| !out.contains(f)).map(|(_, t)| *t).collect();
        let Ok(mesh) = Mesh::new(shape.points.len(), &triangles) else { return };
        let metric = Metric::from_points(&mesh, &shape.points);
        let loops = handle_loops(&mesh, metric.lengths(), Watch::NONE).unwrap();
        let mut cut = EdgeData::constant(mesh.edge_count(), false);
        loops.iter().flat_map(|around| &around.edges).for_each(|&e| cut[e] = true);
        let pieces = open_islands(&mesh, &cut);
        assert_eq!(pieces.len(), 1, "together they do not separate");
        let opened = &pieces[0].mesh;
        assert_eq!(loops.len(), mesh.genus(), "with so many vertices all are found");
        assert_eq!(opened.genus(), 0);
        assert_eq!(opened.boundary_loops().len(), mesh.boundary_loops().len() + 2 * loops.len());
        assert!(pieces[0].halfedge.iter_ids().all(|(new, old)| new == *old), "halfedges keep their numbers");
        let length = |around: &HandleLoop| around.edges.iter().map(|&e| metric.length(e)).sum::<f64>();
        assert!(loops.iter().all(|around| (length(around) / around.length - 1.0).abs() < 1e-12));
        assert!(loops.windows(2).all(|two| two[0].length <= two[1].length));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn opened_along_its_loops_a_surface_is_one_piece_without_handles(
            genus in 0u8..6, count in 600usize..2000, out in prop::collection::vec(0u32..1200, 0..4),
        ) {
            check(&shapes::torus(genus, count), &out);
        }
    }

    #[test]
    fn the_loop_of_a_torus_goes_round_its_tube() {
        let torus = shapes::torus(1, 2000);
        let mesh = torus.mesh();
        let metric = Metric::from_points(&mesh, &torus.points);
        let loops = handle_loops(&mesh, metric.lengths(), Watch::NONE).unwrap();
        // Any loop round a tube of area A and length l is at least as long as a circle of length A / l.
        assert_eq!(loops.len(), 1);
        assert!(loops[0].length < 0.8 * metric.area(&mesh).sqrt(), "{}", loops[0].length);
    }
}
