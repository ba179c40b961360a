//! Where the surface is cut open: conic cuts on any topology.
//!
//! The paper (§2) cuts a sphere along the shortest paths that a minimum spanning tree of the complete graph of the
//! cones' distances names. Here that tree comes from one run of Dijkstra's algorithm from all terminals at once
//! (Mehlhorn 1988, "A faster approximation algorithm for the Steiner problem in graphs"), and handles and boundaries
//! are taken care of by a tree–cotree decomposition (Eppstein 2003; Erickson & Whittlesey 2005):
//!
//! 1. *Terminals* are the cones, and each boundary loop as one. Every vertex belongs to the terminal nearest to it.
//! 2. An edge between two terminals' regions closes a path of length d(u) + l + d(v) from one to the other. Kruskal's
//!    algorithm on these edges gives a minimum spanning tree of the complete distance graph.
//! 3. Those edges and the forest of shortest paths are a spanning tree T of the vertices, each boundary loop shrunk to
//!    a point. A maximum spanning cotree by d(u) + l + d(v) leaves 2g edges that are in neither: the shortest loops
//!    that cut the handles open.
//! 4. T with these edges leaves a disk. Leaves that are no terminals are pruned, as long as there are any.
//!
//! Shortest paths that meet run on together, so the seams may be shorter than the paths of the spanning tree summed up.
//! Boundary edges are open already and are never marked. A surface without terminals (a closed one of genus ≥ 1) is cut
//! along loops through its first vertex; a closed sphere needs two cones at least.

use std::collections::BTreeMap;

use geom::{
    CutMesh, EdgeData, EdgeId, HalfedgeId, Interrupted, Mesh, Metric, ShortestPaths, Surface, VertexData, VertexId,
    Watch, are, counted, edges_at, kruskal, maximum_spanning_cotree_watched, other_end,
};
use thiserror::Error;

/// Why a surface cannot be cut to a disk.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum SeamError {
    /// There is nothing to cut between on a sphere.
    #[error("a closed sphere needs at least two cones to be cut open, but {} given", counted(*cones, "was", "were"))]
    TooFewCones {
        /// How many different cones were given.
        cones: usize,
    },
    /// The surface is not connected, or an edge is infinitely long.
    #[error("vertex {0} cannot be reached along edges from the first: cut each connected component by itself")]
    Unreachable(VertexId),
    /// A cone is not on the mesh.
    #[error("cone {cone} does not exist: there {}", are(*count, "vertex", "vertices"))]
    NoSuchVertex {
        /// The cone.
        cone: VertexId,
        /// How many vertices there are.
        count: usize,
    },
    /// The watch has said stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// Edges along which a connected surface opens to one disk.
#[derive(Clone, Debug, PartialEq)]
pub struct Seams {
    /// Which edges are cut. Boundary edges never are.
    pub cut: EdgeData<bool>,
    /// The cut edges in order: paths between cones, boundary and the places where seams meet.
    pub chains: Vec<Chain>,
    /// The length of all seams together.
    pub length: f64,
}

/// A piece of seam without branches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chain {
    /// The vertices along the chain; one more than edges. The first and the last may be the same.
    pub vertices: Vec<VertexId>,
    /// The edges along the chain.
    pub edges: Vec<EdgeId>,
}

impl Chain {
    /// The halfedges along the chain.
    pub(crate) fn halfedges(&self, mesh: &Mesh) -> Vec<HalfedgeId> {
        let along = |(&e, &from): (&EdgeId, &VertexId)| {
            let h = mesh.halfedge(e);
            if mesh.tail(h) == from { Some(h) } else { mesh.twin(h) }
        };
        self.edges.iter().zip(&self.vertices).filter_map(along).collect()
    }
}

impl Seams {
    /// The seams of a connected surface with the cones given; see the module's head. Cones may be neighbours, lie on
    /// the boundary or be named twice. O(V log V), and O(E log E) where there are handles.
    ///
    /// # Errors
    /// If the surface is a closed sphere and there are fewer than two cones, if it is not connected, or if a cone is
    /// no vertex of it.
    ///
    /// # Panics
    /// If there is an edge without a length.
    pub fn new(mesh: &Mesh, lengths: &EdgeData<f64>, cones: &[VertexId], watch: Watch) -> Result<Self, SeamError> {
        let count = mesh.vertex_count();
        if let Some(&cone) = cones.iter().find(|cone| cone.0 as usize >= count) {
            return Err(SeamError::NoSuchVertex { cone, count });
        }
        let terminals = terminals(mesh, cones);
        let root = terminals.is_empty().then_some((VertexId(0), 0));
        let sources = terminals.iter().copied().chain(root);
        let paths = ShortestPaths::new_watched(mesh, lengths, sources, watch.within(0.0, 0.6))?;
        watch.ask(0.6)?;
        let (component, _) = mesh.components();
        if let Some(v) = mesh.vertices().find(|&v| component[v] != 0 || paths.owner[v].is_none()) {
            return Err(SeamError::Unreachable(v));
        }
        let mut is_terminal = VertexData::constant(count, false);
        for &(v, _) in &terminals {
            is_terminal[v] = true;
        }
        let terminal_vertices = is_terminal.iter().filter(|&&terminal| terminal).count();
        if mesh.euler_characteristic() == 2 && terminal_vertices < 2 {
            return Err(SeamError::TooFewCones { cones: terminal_vertices });
        }
        let detours = Detours { mesh, lengths, paths: &paths };
        watch.ask(0.65)?;
        let mut cut = detours.spanning_tree();
        watch.ask(0.75)?;
        detours.add_handles(&mut cut, watch.within(0.75, 0.9))?;
        watch.ask(0.9)?;
        prune(mesh, &mut cut, &is_terminal);
        watch.ask(0.95)?;
        debug_assert!(CutMesh::open(mesh, &cut).is_disk(), "tree, cotree and 2g edges leave a disk");
        let length = mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).sum();
        Ok(Self { chains: chains(mesh, &cut, &is_terminal), cut, length })
    }

    /// Given seams and, for any two terminals (cones, and boundary loops as one each) whose regions meet, a shortest path over where they do (the graph of K. Mehlhorn,
    /// *A faster approximation algorithm for the Steiner problem in graphs*, 1988, of which seams are a spanning tree). O(V log V).
    ///
    /// # Errors
    /// If it is stopped.
    pub(crate) fn network(
        mesh: &Mesh,
        lengths: &EdgeData<f64>,
        terminals: &[(VertexId, u32)],
        mut cut: EdgeData<bool>,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let paths = ShortestPaths::new_watched(mesh, lengths, terminals.iter().copied(), watch)?;
        let owners = |e: EdgeId| mesh.ends(e).map(|v| paths.owner[v]);
        let mut shortest: BTreeMap<[u32; 2], (f64, EdgeId)> = BTreeMap::new();
        for e in mesh.edges() {
            let [Some(a), Some(b)] = owners(e) else { continue };
            let [u, v] = mesh.ends(e);
            let length = paths.distance[u] + lengths[e] + paths.distance[v];
            if a != b && length.is_finite() {
                let least = shortest.entry([a.min(b), a.max(b)]).or_insert((length, e));
                if length < least.0 {
                    *least = (length, e);
                }
            }
        }
        for (_, bridge) in shortest.into_values() {
            cut[bridge] = true;
            for v in mesh.ends(bridge) {
                paths.to_source(mesh, v).for_each(|(e, _)| cut[e] = true);
            }
        }
        for e in mesh.edges() {
            cut[e] &= !mesh.is_boundary_edge(e);
        }
        let mut is_terminal = VertexData::constant(mesh.vertex_count(), false);
        terminals.iter().for_each(|&(v, _)| is_terminal[v] = true);
        let length = mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).sum();
        Ok(Self { chains: chains(mesh, &cut, &is_terminal), cut, length })
    }

    /// The seams of a prepared surface, along edges of the model only: none runs inside a polygon. `metric` has the lengths
    /// in space.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    ///
    /// # Panics
    /// If there is an edge without a length.
    pub fn of_surface(surface: &Surface, metric: &Metric, cones: &[VertexId], watch: Watch) -> Result<Self, SeamError> {
        Self::new(&surface.mesh, &seam_lengths(surface, metric), cones, watch)
    }

    /// Seams of edges that are cut; chains end where it is said, and where seams end or branch.
    pub(crate) fn of_cut(mesh: &Mesh, lengths: &EdgeData<f64>, cut: EdgeData<bool>, is_end: &VertexData<bool>) -> Self {
        let length = mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).sum();
        Self { chains: chains(mesh, &cut, is_end), cut, length }
    }

    /// Strings the chains anew, after edges were added to the cut. Where chains ended they still do.
    pub(crate) fn string(&mut self, mesh: &Mesh, lengths: &EdgeData<f64>) {
        let mut is_end = VertexData::constant(mesh.vertex_count(), false);
        for chain in &self.chains {
            is_end[chain.vertices[0]] = true;
            is_end[chain.vertices[chain.edges.len()]] = true;
        }
        self.chains = chains(mesh, &self.cut, &is_end);
        self.length = mesh.edges().filter(|&e| self.cut[e]).map(|e| lengths[e]).sum();
    }
}

/// The lengths that seams count: those of space, but infinite inside a polygon.
pub(crate) fn seam_lengths(surface: &Surface, metric: &Metric) -> EdgeData<f64> {
    let length = |(e, &l): (EdgeId, &f64)| if surface.diagonal[e] { f64::INFINITY } else { l };
    metric.lengths().iter_ids().map(length).collect()
}

/// The vertices of the terminals, cones and boundary loops, each with its terminal's number: boundary loops first, then cones.
pub(crate) fn terminals(mesh: &Mesh, cones: &[VertexId]) -> Vec<(VertexId, u32)> {
    let loops = mesh.boundary_loops();
    let on_loops = loops.iter().zip(0..).flat_map(|(around, k)| around.iter().map(move |&h| (mesh.tail(h), k)));
    on_loops.chain(cones.iter().copied().zip(loops.len() as u32..)).collect()
}

/// The ways from terminal to terminal over each edge.
#[derive(Clone, Copy)]
struct Detours<'a> {
    mesh: &'a Mesh,
    lengths: &'a EdgeData<f64>,
    paths: &'a ShortestPaths,
}

impl Detours<'_> {
    /// The length of the shortest way from a terminal over the edge to a terminal: d(u) + l + d(v).
    fn length(&self, e: EdgeId) -> f64 {
        let [u, v] = self.mesh.ends(e);
        self.paths.distance[u] + self.lengths[e] + self.paths.distance[v]
    }

    /// The edges over which a minimum spanning tree of the terminals' distances goes from one region to another.
    fn bridges(&self) -> Vec<EdgeId> {
        let owners = |e: EdgeId| self.mesh.ends(e).map(|v| self.paths.owner[v].unwrap_or(0));
        let between_regions = self.mesh.edges().filter(|&e| owners(e)[0] != owners(e)[1]);
        let mut order: Vec<_> = between_regions.map(|e| (self.length(e), e)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let terminal_count = self.paths.owner.iter().flatten().max().map_or(0, |&last| last as usize + 1);
        kruskal(terminal_count, order.iter().map(|&(_, e)| (e, owners(e))))
    }

    /// A spanning tree of all vertices, boundary loops shrunk to points: the shortest paths, and the bridges.
    fn spanning_tree(&self) -> EdgeData<bool> {
        let mut tree = EdgeData::constant(self.mesh.edge_count(), false);
        for e in self.paths.predecessor.iter().copied().flatten().chain(self.bridges()) {
            tree[e] = true;
        }
        tree
    }

    /// Adds to a spanning tree the edges that are neither in it nor crossed by a maximum spanning cotree.
    fn add_handles(&self, tree: &mut EdgeData<bool>, watch: Watch) -> Result<(), Interrupted> {
        if self.mesh.genus() == 0 {
            return Ok(()); // every cotree crosses all that is left
        }
        let detour: EdgeData<f64> = self.mesh.edges().map(|e| self.length(e)).collect();
        let cotree = maximum_spanning_cotree_watched(self.mesh, &detour, tree, watch)?;
        for e in self.mesh.edges() {
            tree[e] |= !cotree[e] && !self.mesh.is_boundary_edge(e);
        }
        Ok(())
    }
}

/// Takes away edges that lead to a vertex without going on there, unless it is a terminal. O(V).
fn prune(mesh: &Mesh, cut: &mut EdgeData<bool>, is_terminal: &VertexData<bool>) {
    let mut degree = cut_degrees(mesh, cut);
    for leaf in mesh.vertices() {
        let mut v = leaf;
        while degree[v] == 1 && !is_terminal[v] {
            let Some((e, w)) = edges_at(mesh, v).find(|&(e, _)| cut[e]) else { break };
            cut[e] = false;
            degree[v] = 0;
            degree[w] -= 1;
            v = w;
        }
    }
}

/// How many cut edges are at each vertex.
fn cut_degrees(mesh: &Mesh, cut: &EdgeData<bool>) -> VertexData<u32> {
    let mut degree = VertexData::constant(mesh.vertex_count(), 0);
    for v in mesh.edges().filter(|&e| cut[e]).flat_map(|e| mesh.ends(e)) {
        degree[v] += 1;
    }
    degree
}

/// The cut edges, strung together from each terminal or branch to the next, and loops without either.
fn chains(mesh: &Mesh, cut: &EdgeData<bool>, is_terminal: &VertexData<bool>) -> Vec<Chain> {
    let cut_edges = |v: VertexId| edges_at(mesh, v).filter(|&(e, _)| cut[e]);
    let degree = cut_degrees(mesh, cut);
    let is_end = |v: VertexId| is_terminal[v] || degree[v] != 2;
    let mut strung = EdgeData::constant(mesh.edge_count(), false);
    let mut chains = Vec::new();
    let on_seams = || mesh.vertices().filter(|&v| degree[v] > 0);
    for end in on_seams().filter(|&v| is_end(v)).chain(on_seams()) {
        for (first, _) in cut_edges(end) {
            let mut chain = Chain { vertices: vec![end], edges: Vec::new() };
            let (mut v, mut next) = (end, Some(first));
            while let Some(e) = next.filter(|&e| !strung[e]) {
                strung[e] = true;
                v = other_end(mesh, e, v);
                chain.vertices.push(v);
                chain.edges.push(e);
                let is_last = is_end(v) || v == end;
                next = if is_last { None } else { cut_edges(v).map(|(e, _)| e).find(|&e| !strung[e]) };
            }
            if !chain.edges.is_empty() {
                chains.push(chain);
            }
        }
    }
    chains
}

#[cfg(test)]
mod tests {
    use geom::shapes;
    use proptest::prelude::*;

    use super::*;

    /// The surface of a slab of cubes with `genus` square holes through it, and that many quads taken out of its
    /// bottom; lengths are Euclidean but for a factor that looks random.
    fn slab(genus: usize, windows: usize) -> (Mesh, EdgeData<f64>) {
        let size = [3 * (2 * genus + 1), 9, 2].map(|cells| cells as i32);
        let solid = |p: [i32; 3]| {
            let inside = (0..3).all(|k| (0..size[k]).contains(&p[k]));
            inside && !(p[0] / 3 % 2 == 1 && p[1] / 3 == 1)
        };
        let is_window =
            |p: [i32; 3], axis| axis == 2 && p[2] == 0 && p[0] == 1 && p[1] % 3 == 1 && p[1] / 3 < windows as i32;
        let mut vertices = BTreeMap::new();
        let mut points = Vec::new();
        let mut faces = Vec::new();
        for index in 0..(size[0] + 1) * (size[1] + 1) * (size[2] + 1) {
            let p =
                [index % (size[0] + 1), index / (size[0] + 1) % (size[1] + 1), index / (size[0] + 1) / (size[1] + 1)];
            for axis in 0..3 {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let shifted = |steps: &[(usize, i32)]| {
                    let mut at = p;
                    steps.iter().for_each(|&(k, step)| at[k] += step);
                    at
                };
                let (above, below) = (solid(p), solid(shifted(&[(axis, -1)])));
                if above == below || is_window(p, axis) {
                    continue;
                }
                let quad = [p, shifted(&[(i, 1)]), shifted(&[(i, 1), (j, 1)]), shifted(&[(j, 1)])].map(|corner| {
                    *vertices.entry(corner).or_insert_with(|| {
                        points.push(corner.map(f64::from));
                        points.len() as u32 - 1
                    })
                });
                let [a, b, c, d] = if above { [quad[0], quad[3], quad[2], quad[1]] } else { quad };
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
        let mesh = Mesh::new(points.len(), &faces).unwrap();
        let length = |e: EdgeId| {
            let [a, b] = mesh.ends(e).map(|v| points[v.0 as usize]);
            let squared: f64 = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum();
            squared.sqrt() * (1.0 + 0.3 * (f64::from(e.0) * 0.618).fract())
        };
        let lengths = mesh.edges().map(length).collect();
        (mesh, lengths)
    }

    /// Asserts what is true of the seams of any surface with any cones.
    fn check(mesh: &Mesh, lengths: &EdgeData<f64>, cones: &[VertexId], seams: &Seams) {
        assert!(CutMesh::open(mesh, &seams.cut).is_disk());
        assert!(mesh.edges().all(|e| !(seams.cut[e] && mesh.is_boundary_edge(e))), "the boundary is open already");
        let on_seam = |v: VertexId| edges_at(mesh, v).any(|(e, _)| seams.cut[e]);
        let closed = mesh.boundary_loops().is_empty();
        assert!(cones.iter().all(|&v| on_seam(v) || mesh.is_boundary_vertex(v) && !closed), "seams contain all cones");
        for v in mesh.vertices().filter(|&v| edges_at(mesh, v).filter(|&(e, _)| seams.cut[e]).count() == 1) {
            assert!(cones.contains(&v) || mesh.is_boundary_vertex(v), "seams end at cones and boundaries only");
        }
        let mut strung = EdgeData::constant(mesh.edge_count(), false);
        for chain in &seams.chains {
            assert_eq!(chain.vertices.len(), chain.edges.len() + 1);
            for (k, &e) in chain.edges.iter().enumerate() {
                assert!(!std::mem::replace(&mut strung[e], true), "{e:?} is in one chain only");
                let [a, b] = [chain.vertices[k], chain.vertices[k + 1]];
                assert!(mesh.ends(e) == [a, b] || mesh.ends(e) == [b, a]);
            }
            let middle = &chain.vertices[1..chain.vertices.len() - 1];
            assert!(middle.iter().all(|v| !cones.contains(v) && !mesh.is_boundary_vertex(*v)));
        }
        assert_eq!(strung, seams.cut, "chains hold all seams");
        let length: f64 = seams.chains.iter().flat_map(|chain| &chain.edges).map(|&e| lengths[e]).sum();
        assert!((length - seams.length).abs() <= 1e-12 * length);
    }

    /// A minimum spanning tree of all distances between cones, each from a run of Dijkstra's algorithm.
    fn all_pairs_tree_length(mesh: &Mesh, lengths: &EdgeData<f64>, cones: &[VertexId]) -> f64 {
        let mut pairs = Vec::new();
        for (i, &a) in cones.iter().enumerate() {
            let paths = ShortestPaths::new(mesh, lengths, [(a, 0)]);
            pairs.extend((0..i).map(|j| (paths.distance[cones[j]], [i as u32, j as u32])));
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        kruskal(cones.len(), pairs).iter().sum()
    }

    /// Vertices spread over a mesh.
    fn spread(mesh: &Mesh, count: usize) -> Vec<VertexId> {
        (0..count).map(|k| VertexId(((k * 7919 + 13) % mesh.vertex_count()) as u32)).collect()
    }

    #[test]
    fn every_genus_with_every_number_of_boundaries_and_cones_opens_to_a_disk() {
        for genus in 0..5 {
            for windows in 0..4 {
                let (mesh, lengths) = slab(genus, windows);
                assert_eq!((mesh.genus(), mesh.boundary_loops().len()), (genus, windows));
                for count in [0, 1, 2, 3, 8, 40] {
                    let cones = spread(&mesh, count);
                    match Seams::new(&mesh, &lengths, &cones, Watch::NONE) {
                        Ok(seams) => check(&mesh, &lengths, &cones, &seams),
                        Err(why) => {
                            assert_eq!(why, SeamError::TooFewCones { cones: count });
                            assert!(genus == 0 && windows == 0 && count < 2);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn bridges_form_the_minimum_spanning_tree_of_all_distances() {
        for (windows, count) in [(0, 2), (0, 3), (0, 16), (0, 64)] {
            let (mesh, lengths) = slab(0, windows);
            let cones = spread(&mesh, count);
            let paths = ShortestPaths::new(&mesh, &lengths, terminals(&mesh, &cones));
            let detours = Detours { mesh: &mesh, lengths: &lengths, paths: &paths };
            let length: f64 = detours.bridges().into_iter().map(|e| detours.length(e)).sum();
            let expected = all_pairs_tree_length(&mesh, &lengths, &cones);
            assert!((length - expected).abs() < 1e-12 * expected, "{length} is {expected}");
            let seams = Seams::new(&mesh, &lengths, &cones, Watch::NONE).unwrap();
            assert!(seams.length <= expected * (1.0 + 1e-12), "paths may share edges, which shortens the seams");
        }
    }

    #[test]
    fn a_network_holds_what_it_was_given_and_a_shortest_tree_and_its_cells_are_disks() {
        for (genus, windows) in [(0, 0), (0, 2), (2, 0), (1, 1)] {
            let (mesh, lengths) = slab(genus, windows);
            let cones = spread(&mesh, 20);
            let seams = Seams::new(&mesh, &lengths, &cones, Watch::NONE).unwrap();
            let network =
                Seams::network(&mesh, &lengths, &terminals(&mesh, &cones), seams.cut.clone(), Watch::NONE).unwrap();
            assert!(
                mesh.edges().all(|e| network.cut[e] >= seams.cut[e] && !(network.cut[e] && mesh.is_boundary_edge(e)))
            );
            let cells = CutMesh::open(&mesh, &network.cut);
            assert!(cells.island_count() > 10, "{}", cells.island_count());
            assert_eq!(cells.euler_characteristic(), cells.island_count() as i64);
            if genus == 0 {
                let nothing = EdgeData::constant(mesh.edge_count(), false);
                let alone = Seams::network(&mesh, &lengths, &terminals(&mesh, &cones), nothing, Watch::NONE).unwrap();
                assert!(mesh.edges().all(|e| alone.cut[e] >= seams.cut[e]), "of its paths some are the shortest tree");
            }
        }
    }

    #[test]
    fn two_cones_are_joined_by_their_shortest_path() {
        let (mesh, lengths) = slab(0, 0);
        let cones = [VertexId(0), VertexId(mesh.vertex_count() as u32 - 1)];
        let seams = Seams::new(&mesh, &lengths, &cones, Watch::NONE).unwrap();
        let distance = ShortestPaths::new(&mesh, &lengths, [(cones[0], 0)]).distance[cones[1]];
        assert!((seams.length - distance).abs() < 1e-12 * distance);
        assert_eq!(seams.chains.len(), 1);
        assert_eq!([seams.chains[0].vertices[0], *seams.chains[0].vertices.last().unwrap()], cones);
    }

    #[test]
    fn cones_may_be_all_vertices_there_are() {
        let tetrahedron = Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]).unwrap();
        let lengths = EdgeData::constant(6, 1.0);
        let cones: Vec<_> = tetrahedron.vertices().collect();
        let seams = Seams::new(&tetrahedron, &lengths, &cones, Watch::NONE).unwrap();
        check(&tetrahedron, &lengths, &cones, &seams);
        assert_eq!((seams.length, seams.chains.len()), (3.0, 3));
    }

    #[test]
    fn a_cone_on_the_boundary_needs_no_seam() {
        let triangle = Mesh::new(3, &[[0, 1, 2]]).unwrap();
        let lengths = EdgeData::constant(3, 1.0);
        for cones in [&[][..], &[VertexId(1)], &[VertexId(1), VertexId(2), VertexId(1)]] {
            let seams = Seams::new(&triangle, &lengths, cones, Watch::NONE).unwrap();
            assert_eq!((seams.length, seams.chains.len()), (0.0, 0));
        }
    }

    #[test]
    fn a_cone_named_twice_is_one_cone() {
        let (mesh, lengths) = slab(0, 0);
        let once = Seams::new(&mesh, &lengths, &[5, 90, 44].map(VertexId), Watch::NONE);
        assert_eq!(once, Seams::new(&mesh, &lengths, &[5, 90, 5, 44, 90].map(VertexId), Watch::NONE));
        let same = Seams::new(&mesh, &lengths, &[5, 5].map(VertexId), Watch::NONE);
        assert_eq!(same, Err(SeamError::TooFewCones { cones: 1 }));
    }

    #[test]
    fn a_network_without_the_boundary_has_paths_where_its_region_parts_cones() {
        let shape = shapes::square(900);
        let mesh = shape.mesh();
        let lengths = Metric::from_points(&mesh, &shape.points).lengths().clone();
        let away = |v: VertexId, p: [f64; 2]| {
            let [x, y, _] = shape.points[v.0 as usize];
            (x - p[0]).hypot(y - p[1])
        };
        let side = shape.area().sqrt();
        let [left, bottom] = [0, 1].map(|k| shape.points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min));
        // Both are near the lower side, and far from each other.
        let cones = [0.3, 0.7].map(|x| {
            let p = [left + x * side, bottom + 0.05 * side];
            mesh.vertices().min_by(|&v, &w| away(v, p).total_cmp(&away(w, p))).unwrap()
        });
        let nothing = || EdgeData::constant(mesh.edge_count(), false);
        let between = |terminals: &[(VertexId, u32)]| -> f64 {
            let network = Seams::network(&mesh, &lengths, terminals, nothing(), Watch::NONE).unwrap();
            let weights = mesh.edges().map(|e| if network.cut[e] { lengths[e] } else { f64::INFINITY }).collect();
            ShortestPaths::new(&mesh, &weights, [(cones[0], 0)]).distance[cones[1]]
        };
        let shortest = ShortestPaths::new(&mesh, &lengths, [(cones[0], 0)]).distance[cones[1]];
        let alone = cones.iter().copied().zip(0..).collect::<Vec<_>>();
        assert!((between(&alone) / shortest - 1.0).abs() < 1e-12);
        assert!(between(&terminals(&mesh, &cones)) > 1.2 * shortest);
    }

    #[test]
    fn what_cannot_be_cut_is_refused_by_name() {
        let two = Mesh::new(6, &[[0, 1, 2], [3, 4, 5]]).unwrap();
        let lengths = EdgeData::constant(6, 1.0);
        let two_balls =
            Mesh::new(8, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2], [4, 5, 6], [4, 6, 7], [4, 7, 5], [5, 7, 6]]);
        let unreachable = Seams::new(&two_balls.unwrap(), &EdgeData::constant(12, 1.0), &[VertexId(1)], Watch::NONE);
        assert_eq!(unreachable, Err(SeamError::Unreachable(VertexId(4))));
        assert_eq!(Seams::new(&two, &lengths, &[], Watch::NONE), Err(SeamError::Unreachable(VertexId(3))));
        let triangle = Mesh::new(3, &[[0, 1, 2]]).unwrap();
        Seams::new(&triangle, &EdgeData::constant(3, f64::INFINITY), &[], Watch::NONE).unwrap();
        let (mesh, mut lengths) = slab(0, 0);
        edges_at(&mesh, VertexId(9)).for_each(|(e, _)| lengths[e] = f64::INFINITY);
        let endless = Seams::new(&mesh, &lengths, &[VertexId(0), VertexId(1)], Watch::NONE);
        assert_eq!(endless, Err(SeamError::Unreachable(VertexId(9))));
        let beyond = Seams::new(&two, &lengths, &[VertexId(6)], Watch::NONE);
        assert_eq!(beyond, Err(SeamError::NoSuchVertex { cone: VertexId(6), count: 6 }));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn any_cones_lie_on_seams_that_open_to_a_disk(
            genus in 0usize..3,
            windows in 0usize..4,
            picks in prop::collection::vec(any::<prop::sample::Index>(), 2..30),
        ) {
            let (mesh, lengths) = slab(genus, windows);
            let cones: Vec<_> = picks.iter().map(|pick| VertexId(pick.index(mesh.vertex_count()) as u32)).collect();
            prop_assume!(cones.iter().any(|&cone| cone != cones[0]));
            let seams = Seams::new(&mesh, &lengths, &cones, Watch::NONE).unwrap();
            check(&mesh, &lengths, &cones, &seams);
        }
    }
}
