//! Shortest paths along edges, and spanning trees.
//!
//! [`ShortestPaths`] is Dijkstra's algorithm from several sources at once: what grows is a forest that divides
//! the mesh into the sources' Voronoi regions along edges. [`minimum_spanning_tree`] and [`maximum_spanning_cotree`]
//! are minimum spanning forests of the vertices and of the faces: a tree of edges, and a tree of the dual graph that
//! crosses none of them. On a closed surface of genus g exactly 2g edges are in neither, and they carry its handles
//! (Eppstein 2003, "Dynamic generators of topologically embedded graphs").
//!
//! Lengths are those of edges; a path never crosses a triangle. All ties are broken by index, so that the same input
//! gives the same trees. A negative or missing (NaN) length counts as zero.

use std::cmp::Reverse;
use std::ops::Range;

use petgraph::unionfind::UnionFind;

use super::dijkstra::dijkstra;
use crate::mesh::{EdgeData, EdgeId, Id, Mesh, VertexData, VertexId};
use crate::parallel::of_runs;
use crate::rows::Rows;
use crate::watch::{Interrupted, Progress, Watch, unwatched};

/// After so many rounds in which nodes take their first edges .09 to .14 of all edges are left on layouts of spot, bunny and fandisk, .46 on one of igea.
const ROUNDS: usize = 3;
/// The edges at so many vertices are copied one after the other.
const RUN: usize = 1 << 15;

/// The forest of shortest paths from a set of sources.
///
/// ```
/// use geom::{EdgeData, Mesh, ShortestPaths, VertexId};
/// let strip = Mesh::new(5, &[[0, 1, 2], [2, 1, 3], [2, 3, 4]])?;
/// let lengths = EdgeData::constant(strip.edge_count(), 1.0);
/// let paths = ShortestPaths::new(&strip, &lengths, [(VertexId(0), 0)]);
/// assert_eq!(paths.distance[VertexId(4)], 2.0);
/// let way: Vec<_> = paths.to_source(&strip, VertexId(4)).map(|(_, v)| v).collect();
/// assert_eq!(way, [VertexId(2), VertexId(0)]);
/// # Ok::<(), geom::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ShortestPaths {
    /// The distance from the nearest source; infinite where none reaches.
    pub distance: VertexData<f64>,
    /// The last edge of the shortest path; none at sources and where no source reaches.
    pub predecessor: VertexData<Option<EdgeId>>,
    /// The owner of the nearest source; none where no source reaches.
    pub owner: VertexData<Option<u32>>,
}

impl ShortestPaths {
    /// Shortest paths from sources, each with the number of its owner; several sources may have the same owner, and
    /// a vertex named twice is its first owner's. A length that is negative or NaN counts as 0. O(V log V), and memory for each edge twice.
    ///
    /// # Panics
    /// If there is an edge without a length, or a source is no vertex of the mesh.
    pub fn new(mesh: &Mesh, lengths: &EdgeData<f64>, sources: impl IntoIterator<Item = (VertexId, u32)>) -> Self {
        unwatched(Self::new_watched(mesh, lengths, sources, Watch::NONE))
    }

    /// [`ShortestPaths::new`], watched.
    ///
    /// # Errors
    /// If it is stopped.
    ///
    /// # Panics
    /// As [`ShortestPaths::new`].
    pub fn new_watched(
        mesh: &Mesh,
        lengths: &EdgeData<f64>,
        sources: impl IntoIterator<Item = (VertexId, u32)>,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let count = mesh.vertex_count();
        let mut paths = Self {
            distance: VertexData::constant(count, f64::INFINITY),
            predecessor: VertexData::constant(count, None),
            owner: VertexData::constant(count, None),
        };
        let mut starts = Vec::new();
        for (source, owner) in sources {
            if paths.owner[source].is_none() {
                paths.owner[source] = Some(owner);
                starts.push(source.0);
            }
        }
        // Side by side, since what is reached one after the other is far apart: it takes half of the time.
        let at = |v: usize| edges_at(mesh, VertexId::new(v)).map(|(e, w)| (e, w.0, lengths[e].max(0.0)));
        let progress = Progress::new(watch.within(0.0, 0.25), count);
        let of_run = |run: Range<usize>| {
            progress.ask()?;
            progress.add(run.len());
            Ok(run.map(at).collect::<Rows<_>>())
        };
        let runs = of_runs(count, RUN, of_run).into_iter().collect::<Result<Vec<_>, _>>()?;
        let edges = |v: u32| runs[v as usize / RUN].row(v as usize % RUN).iter().copied();
        let Self { distance, predecessor, owner } = &mut paths;
        let reached = |from: u32, e: EdgeId, to: u32| {
            predecessor[VertexId(to)] = Some(e);
            owner[VertexId(to)] = owner[VertexId(from)];
        };
        dijkstra(distance, starts.into_iter(), edges, reached, watch.within(0.25, 1.0))?;
        Ok(paths)
    }

    /// The shortest path from a vertex back to its source: each edge with the vertex it leads to.
    pub fn to_source<'a>(&'a self, mesh: &'a Mesh, v: VertexId) -> impl Iterator<Item = (EdgeId, VertexId)> + 'a {
        let mut at = v;
        std::iter::from_fn(move || {
            let e = self.predecessor[at]?;
            at = other_end(mesh, e, at);
            Some((e, at))
        })
    }
}

/// The edges at a vertex, each with its other end.
pub fn edges_at(mesh: &Mesh, v: VertexId) -> impl Iterator<Item = (EdgeId, VertexId)> + '_ {
    mesh.outgoing(v).flat_map(move |h| {
        let incoming = mesh.prev(h);
        let last = mesh.twin(incoming).is_none().then(|| (mesh.edge(incoming), mesh.tail(incoming)));
        std::iter::once((mesh.edge(h), mesh.head(h))).chain(last)
    })
}

/// The end of an edge that is not `v`; `v` itself where the edge is a loop.
pub fn other_end(mesh: &Mesh, e: EdgeId, v: VertexId) -> VertexId {
    let [a, b] = mesh.ends(e);
    if a == v { b } else { a }
}

/// Kruskal's algorithm: goes through the edges of a graph in the order given, each with its two nodes, and takes those
/// that join two trees of the forest made so far, until there is one tree.
///
/// # Panics
/// If an edge that is gone through names a node beyond the count.
pub fn kruskal<E>(node_count: usize, edges: impl IntoIterator<Item = (E, [u32; 2])>) -> Vec<E> {
    let mut trees = UnionFind::<u32>::new(node_count);
    let joining = edges.into_iter().filter(|&(_, [a, b])| trees.union(a, b));
    joining.map(|(e, _)| e).take(node_count.saturating_sub(1)).collect()
}

/// The edges of the minimum spanning forest of a graph, each a key with its two nodes, in no order that means anything. Keys tell which edges
/// come first, and no two are the same. Each node takes its first edge and becomes one with the node at its other end, several times over (Borůvka
/// 1926); few edges are left to be sorted for [`kruskal`] then. Edges are gone through twice. O(E) and a sort of what is left.
///
/// ```
/// let square = [(3, [0, 1]), (1, [1, 2]), (4, [2, 3]), (2, [3, 0])];
/// let mut forest = geom::minimum_spanning_forest(4, square.into_iter(), geom::Watch::NONE)?;
/// forest.sort();
/// assert_eq!(forest, [1, 2, 3]);
/// # Ok::<(), geom::Interrupted>(())
/// ```
///
/// # Errors
/// If it is stopped.
///
/// # Panics
/// If an edge names a node beyond the count.
pub fn minimum_spanning_forest<K: Ord + Copy>(
    node_count: usize,
    edges: impl Iterator<Item = (K, [u32; 2])> + Clone,
    watch: Watch,
) -> Result<Vec<K>, Interrupted> {
    let mut forest = Vec::with_capacity(node_count.saturating_sub(1));
    watch.ask(0.0)?;
    let (mut count, node) = joined(node_count, edges.clone(), &mut forest);
    watch.ask(0.3)?;
    let outside = |node: &[u32], (key, ends): (K, [u32; 2])| {
        let ends = ends.map(|end| node[end as usize]);
        (ends[0] != ends[1]).then_some((key, ends))
    };
    let mut left: Vec<(K, [u32; 2])> = edges.filter_map(|edge| outside(&node, edge)).collect();
    for _ in 1..ROUNDS {
        watch.ask(0.5)?;
        let node;
        (count, node) = joined(count, left.iter().copied(), &mut forest);
        left = left.into_iter().filter_map(|edge| outside(&node, edge)).collect();
    }
    watch.ask(0.8)?;
    left.sort_unstable_by_key(|(key, _)| *key);
    forest.extend(kruskal(count, left));
    Ok(forest)
}

/// Adds to a forest the first edge of each node, and joins what these connect: how many nodes there are then, and which each has become.
fn joined<K: Ord + Copy>(
    count: usize,
    edges: impl Iterator<Item = (K, [u32; 2])>,
    forest: &mut Vec<K>,
) -> (usize, Vec<u32>) {
    // With the other end.
    let mut first: Vec<Option<(K, u32)>> = vec![None; count];
    for (key, [a, b]) in edges {
        for (from, to) in [(a, b), (b, a)] {
            let first = &mut first[from as usize];
            if a != b && first.is_none_or(|(least, _)| key < least) {
                *first = Some((key, to));
            }
        }
    }
    // Ways along first edges have falling keys, so that each ends at an edge that is the first of both its nodes: at the lower one.
    let end = |from: u32| {
        let (key, to) = first[from as usize]?;
        let is_end = from < to && first[to as usize].is_some_and(|(least, _)| least == key);
        (!is_end).then_some((key, to))
    };
    let mut node = vec![u32::MAX; count];
    let (mut tree_count, mut way) = (0, Vec::new());
    for start in 0..count as u32 {
        let mut at = start;
        while node[at as usize] == u32::MAX {
            way.push(at);
            let Some((key, to)) = end(at) else {
                node[at as usize] = tree_count;
                tree_count += 1;
                break;
            };
            forest.push(key);
            at = to;
        }
        let new = node[at as usize];
        way.drain(..).for_each(|on| node[on as usize] = new);
    }
    (tree_count as usize, node)
}

/// The edges of a minimum spanning tree of the vertices (a forest, where the mesh is not connected). Costs as
/// [`minimum_spanning_forest`].
///
/// # Panics
/// If there is an edge without a cost.
pub fn minimum_spanning_tree(mesh: &Mesh, cost: &EdgeData<f64>) -> EdgeData<bool> {
    unwatched(minimum_spanning_tree_watched(mesh, cost, Watch::NONE))
}

/// [`minimum_spanning_tree`], watched.
///
/// # Errors
/// If it is stopped.
///
/// # Panics
/// If there is an edge without a cost.
pub fn minimum_spanning_tree_watched(
    mesh: &Mesh,
    cost: &EdgeData<f64>,
    watch: Watch,
) -> Result<EdgeData<bool>, Interrupted> {
    let edges = mesh.edges().map(|e| ((in_order(cost[e]), e), mesh.ends(e).map(|v| v.0)));
    Ok(mark(mesh, minimum_spanning_forest(mesh.vertex_count(), edges, watch)?))
}

/// The edges crossed by a maximum spanning tree of the faces that crosses no edge of `tree` (a forest, where `tree`
/// separates the faces). Costs as [`minimum_spanning_forest`].
///
/// # Panics
/// If there is an edge without a weight, or without a mark whether it is in the tree.
pub fn maximum_spanning_cotree(mesh: &Mesh, weight: &EdgeData<f64>, tree: &EdgeData<bool>) -> EdgeData<bool> {
    unwatched(maximum_spanning_cotree_watched(mesh, weight, tree, Watch::NONE))
}

/// [`maximum_spanning_cotree`], watched.
///
/// # Errors
/// If it is stopped.
///
/// # Panics
/// If there is an edge without a weight, or without a mark whether it is in the tree.
pub fn maximum_spanning_cotree_watched(
    mesh: &Mesh,
    weight: &EdgeData<f64>,
    tree: &EdgeData<bool>,
    watch: Watch,
) -> Result<EdgeData<bool>, Interrupted> {
    let edges = mesh.edges().filter(|&e| !tree[e]).filter_map(|e| {
        let h = mesh.halfedge(e);
        Some(((Reverse(in_order(weight[e])), e), [mesh.face(h).0, mesh.face(mesh.twin(h)?).0]))
    });
    Ok(mark(mesh, minimum_spanning_forest(mesh.face_count(), edges, watch)?))
}

/// An integer in the order of [`f64::total_cmp`].
fn in_order(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

fn mark<K>(mesh: &Mesh, edges: Vec<(K, EdgeId)>) -> EdgeData<bool> {
    let mut marked = EdgeData::constant(mesh.edge_count(), false);
    for (_, e) in edges {
        marked[e] = true;
    }
    marked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_forest_is_that_of_the_sorted_edges() {
        for (count, seed) in (0..60).chain([5000]).zip(3_u32..) {
            let random = |k: u32| (k * seed + 7).wrapping_mul(2_654_435_761) >> 8;
            // Loops, several edges between two nodes, and often more than one tree.
            let edges = (0..2 * count)
                .map(|k| ((random(k) % 50, k), [random(3 * k + 1) % count.max(1), random(5 * k + 2) % count.max(1)]));
            let mut sorted: Vec<_> = edges.clone().collect();
            sorted.sort_unstable();
            let mut forest = minimum_spanning_forest(count as usize, edges, Watch::NONE).unwrap();
            forest.sort_unstable();
            assert_eq!(forest, kruskal(count as usize, sorted));
        }
    }

    #[test]
    fn integers_are_in_the_order_of_what_they_stand_for() {
        let positive = [0.0, f64::MIN_POSITIVE / 8.0, 1e-3, 2.5, f64::MAX, f64::INFINITY, f64::NAN];
        let all: Vec<f64> = positive.into_iter().flat_map(|x| [x.abs(), -x.abs()]).collect();
        for (x, y) in all.iter().flat_map(|x| all.iter().map(move |y| (x, y))) {
            assert_eq!(in_order(*x).cmp(&in_order(*y)), x.total_cmp(y));
        }
    }

    /// A grid of squares, wrapped round to a torus, with lengths that look random.
    fn torus(size: u32) -> (Mesh, EdgeData<f64>) {
        let at = |i: u32, j: u32| (i % size) * size + j % size;
        let squares = (0..size).flat_map(|i| (0..size).map(move |j| (i, j)));
        let faces: Vec<[u32; 3]> = squares
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let mesh = Mesh::new((size * size) as usize, &faces).unwrap();
        let lengths = mesh.edges().map(|e| 1.0 + (f64::from(e.0) * 0.618).fract()).collect();
        (mesh, lengths)
    }

    /// Shortest distances by relaxing every edge until nothing changes.
    fn relaxed(mesh: &Mesh, lengths: &EdgeData<f64>, sources: &[VertexId]) -> VertexData<f64> {
        let mut distance = VertexData::constant(mesh.vertex_count(), f64::INFINITY);
        for &source in sources {
            distance[source] = 0.0;
        }
        loop {
            let before = distance.clone();
            for e in mesh.edges() {
                let [a, b] = mesh.ends(e);
                distance[a] = distance[a].min(distance[b] + lengths[e]);
                distance[b] = distance[b].min(distance[a] + lengths[e]);
            }
            if before == distance {
                return distance;
            }
        }
    }

    #[test]
    fn distances_are_those_of_relaxing_every_edge() {
        let (mesh, lengths) = torus(9);
        let sources = [VertexId(3), VertexId(40), VertexId(77)];
        let paths = ShortestPaths::new(&mesh, &lengths, sources.into_iter().zip(0..));
        let expected = relaxed(&mesh, &lengths, &sources);
        for v in mesh.vertices() {
            assert!((paths.distance[v] - expected[v]).abs() < 1e-12);
        }
    }

    #[test]
    fn no_edge_makes_a_way_shorter_on_a_surface_whose_edges_are_copied_in_several_runs() {
        let (mesh, lengths) = torus(200);
        assert!(mesh.vertex_count() > RUN);
        let source = VertexId(RUN as u32 - 1);
        let paths = ShortestPaths::new(&mesh, &lengths, [(source, 0)]);
        for (e, [a, b]) in mesh.edges().map(|e| (e, mesh.ends(e).map(|v| paths.distance[v]))) {
            assert!(a <= b + lengths[e] && b <= a + lengths[e]);
        }
        for v in mesh.vertices().filter(|&v| v != source) {
            let e = paths.predecessor[v].unwrap();
            assert_eq!(paths.distance[v], paths.distance[other_end(&mesh, e, v)] + lengths[e]);
        }
    }

    #[test]
    fn paths_lead_to_their_owner_and_are_as_long_as_the_distance() {
        let (mesh, lengths) = torus(9);
        let sources = [VertexId(3), VertexId(40), VertexId(77)];
        let paths = ShortestPaths::new(&mesh, &lengths, sources.into_iter().zip(0..));
        for v in mesh.vertices() {
            let (mut end, mut length) = (v, 0.0);
            for (e, w) in paths.to_source(&mesh, v) {
                (end, length) = (w, length + lengths[e]);
            }
            assert_eq!(paths.owner[v].map(|owner| sources[owner as usize]), Some(end));
            assert!((length - paths.distance[v]).abs() < 1e-12);
        }
    }

    #[test]
    fn ties_go_to_the_lower_index() {
        let strip = Mesh::new(4, &[[0, 1, 2], [2, 1, 3]]).unwrap();
        let ones = EdgeData::constant(strip.edge_count(), 1.0);
        let paths = ShortestPaths::new(&strip, &ones, [(VertexId(2), 2), (VertexId(1), 1)]);
        assert_eq!([0, 3].map(|v| paths.owner[VertexId(v)]), [Some(1), Some(1)]);
    }

    #[test]
    fn what_no_source_reaches_is_infinitely_far() {
        let two = Mesh::new(6, &[[0, 1, 2], [3, 4, 5]]).unwrap();
        let paths = ShortestPaths::new(&two, &EdgeData::constant(6, 1.0), [(VertexId(0), 7)]);
        assert_eq!(paths.distance[VertexId(4)], f64::INFINITY);
        assert_eq!(paths.owner[VertexId(4)], None);
        assert_eq!(paths.to_source(&two, VertexId(4)).count(), 0);
    }

    #[test]
    fn no_edge_off_a_minimum_spanning_tree_is_shorter_than_those_it_bridges() {
        let (mesh, lengths) = torus(6);
        let tree = minimum_spanning_tree(&mesh, &lengths);
        assert_eq!(tree.iter().filter(|&&taken| taken).count(), mesh.vertex_count() - 1);
        for off in mesh.edges().filter(|&e| !tree[e]) {
            let [a, b] = mesh.ends(off);
            let mut trees = UnionFind::<u32>::new(mesh.vertex_count());
            for e in mesh.edges().filter(|&e| tree[e] && lengths[e] <= lengths[off]) {
                trees.union(mesh.ends(e)[0].0, mesh.ends(e)[1].0);
            }
            assert!(trees.equiv(a.0, b.0), "the tree joins the ends of {off:?} without longer edges");
        }
    }

    #[test]
    fn tree_and_cotree_leave_two_edges_of_a_torus() {
        let (mesh, lengths) = torus(7);
        let tree = minimum_spanning_tree(&mesh, &lengths);
        let cotree = maximum_spanning_cotree(&mesh, &lengths, &tree);
        assert_eq!(cotree.iter().filter(|&&crossed| crossed).count(), mesh.face_count() - 1);
        assert_eq!(mesh.edges().filter(|&e| !tree[e] && !cotree[e]).count(), 2);
        assert!(mesh.edges().all(|e| !(tree[e] && cotree[e])));
        for off in mesh.edges().filter(|&e| !tree[e] && !cotree[e]) {
            let faces = |e| [mesh.halfedge(e), mesh.twin(mesh.halfedge(e)).unwrap()].map(|h| mesh.face(h).0);
            let mut trees = UnionFind::<u32>::new(mesh.face_count());
            for e in mesh.edges().filter(|&e| cotree[e] && lengths[e] >= lengths[off]) {
                trees.union(faces(e)[0], faces(e)[1]);
            }
            assert!(trees.equiv(faces(off)[0], faces(off)[1]), "the cotree joins the sides of {off:?} by none lighter");
        }
    }

    #[test]
    fn equal_edges_are_taken_by_index_and_owners_by_their_order() {
        let strip = Mesh::new(4, &[[0, 1, 2], [2, 1, 3]]).unwrap();
        let ones = EdgeData::constant(strip.edge_count(), 1.0);
        let tree = minimum_spanning_tree(&strip, &ones);
        assert!(tree[EdgeId(0)] && tree[EdgeId(1)] && !tree[EdgeId(2)]);
        let paths = ShortestPaths::new(&strip, &ones, [(VertexId(0), 8), (VertexId(0), 9)]);
        assert!(strip.vertices().all(|v| paths.owner[v] == Some(8)));
    }

    #[test]
    fn negative_and_missing_lengths_count_as_zero() {
        let triangle = Mesh::new(3, &[[0, 1, 2]]).unwrap();
        let paths = ShortestPaths::new(&triangle, &vec![-1.0, 5.0, f64::NAN].into(), [(VertexId(0), 0)]);
        assert_eq!(paths.distance.to_vec(), [0.0; 3]);
    }
}
