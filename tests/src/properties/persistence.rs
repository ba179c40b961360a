//! Of the pairing of extrema and saddles.

use std::cmp::Ordering;

use petgraph::graph::{NodeIndex, UnGraph};
use petgraph::unionfind::UnionFind;
use petgraph::visit::EdgeRef;
use topo::{Connectivity, Domain, Grid, Kind, NanPolicy, Pairs, Path, PersistenceOptions, Scalar, TriangleMesh};

use crate::decode::{self, Bytes};
use crate::oracle;

type Graph = UnGraph<(), ()>;

/// Pairs of any field on any graph: by the fast way, by the plain sweep and by reduction of the boundary matrix they are
/// the same; each extremum is paired once, with a saddle after it in the order, and each component has one essential
/// class; superlevel pairs are the sublevel pairs of the negated field with the indices reversed.
pub fn pairing(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let graph = decode::graph(bytes);
    let field = decode::field(bytes, graph.node_count());
    let all = PersistenceOptions::new().keep_zeros();
    let pairs = all.persistence(&graph, &field).expect("a value for each vertex, and no NaN");
    assert_eq!(Ok(&pairs), all.plain_sweep().persistence(&graph, &field).as_ref(), "fast and plain agree");
    assert_eq!(indices(&pairs.minima), oracle::pairs_by_reduction(&graph, &field));
    assert_eq!(indices(&pairs.maxima), mirrored(&graph, &field));
    assert_eq!(pairs.minima.essential().count(), component_count(&graph));
    check_pairs(&graph, &field, &pairs.minima);
    let strict = topo::sublevel(&graph, &field).expect("as before");
    assert_eq!(strict.len() + strict.zero_count(), pairs.minima.len(), "only pairs of zero persistence are dropped");
    assert!(strict.finite().all(|pair| pair.persistence() > 0.0));
}

/// Each local minimum once, its saddle after it, values as in the field, by index, and ranked by persistence.
fn check_pairs(graph: &Graph, field: &[f64], pairs: &Pairs<NodeIndex, f64>) {
    let before = |a: NodeIndex, b: NodeIndex| order(field, a.index(), b.index()) == Ordering::Less;
    let is_minimum = |v: &NodeIndex| graph.neighbors(*v).all(|w| w == *v || before(*v, w));
    let mut minima: Vec<_> = graph.node_indices().filter(is_minimum).collect();
    minima.sort_unstable();
    let mut paired: Vec<_> = pairs.iter().map(|pair| pair.extremum).collect();
    paired.sort_unstable();
    assert_eq!(paired, minima, "every minimum is paired exactly once");
    for pair in pairs {
        assert!(pair.saddle.is_none_or(|saddle| before(pair.extremum, saddle)), "a saddle comes after its minimum");
        assert_eq!(pair.birth.key(), field[pair.extremum.index()].key());
        assert_eq!(pair.death().map(|death| death.key()), pair.saddle.map(|saddle| field[saddle.index()].key()));
    }
    assert!(pairs.windows(2).all(|two| two[0].extremum < two[1].extremum));
    assert!(pairs.ranked().windows(2).all(|two| two[0].persistence() >= two[1].persistence()));
}

/// The superlevel pairs, from the sublevel pairs of the negated field on the graph with the indices reversed.
fn mirrored(graph: &Graph, field: &[f64]) -> Vec<(usize, Option<usize>)> {
    let last = field.len() - 1;
    let reversed = relabel(graph, |v| last - v);
    let negated: Vec<f64> = field.iter().rev().map(|x| -x).collect();
    let pairs = oracle::pairs_by_reduction(&reversed, &negated);
    let mut pairs: Vec<_> = pairs.into_iter().map(|(v, saddle)| (last - v, saddle.map(|s| last - s))).collect();
    pairs.sort_unstable();
    pairs
}

/// Numbering the vertices otherwise changes the numbers in the pairs and nothing else, where no two values are equal. Nor
/// does a strictly monotone map of the field.
pub fn relabelled(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let graph = decode::graph(bytes);
    let count = graph.node_count();
    let mut remaining: Vec<usize> = (0..count).collect();
    let rank: Vec<usize> = (0..count).map(|_| remaining.swap_remove(bytes.below(remaining.len()))).collect();
    let mut remaining: Vec<usize> = (0..count).collect();
    let label: Vec<usize> = (0..count).map(|_| remaining.swap_remove(bytes.below(remaining.len()))).collect();
    let mut moved = vec![0; count];
    (0..count).for_each(|v| moved[label[v]] = rank[v].pow(3));
    let plain = topo::persistence(&graph, &rank).expect("a value for each vertex");
    let other = topo::persistence(&relabel(&graph, |v| label[v]), &moved).expect("a value for each vertex");
    for (plain, other) in [(plain.minima, other.minima), (plain.maxima, other.maxima)] {
        let mut plain: Vec<_> = indices(&plain).into_iter().map(|(v, s)| (label[v], s.map(|s| label[s]))).collect();
        plain.sort_unstable();
        assert_eq!(plain, indices(&other));
    }
}

/// The hierarchy holds the extrema of both kinds by persistence, and what it takes first of them is nested.
pub fn hierarchy(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let graph = decode::graph(bytes);
    let field = decode::field(bytes, graph.node_count());
    let pairs = topo::persistence(&graph, &field).expect("a value for each vertex, and no NaN");
    let hierarchy = pairs.hierarchy();
    let count = hierarchy.extrema().len();
    assert_eq!(count, pairs.minima.len() + pairs.maxima.len());
    let all: Vec<_> = hierarchy.alternating(count).collect();
    assert_eq!(all.len(), count);
    for n in 0..=count {
        assert!(hierarchy.alternating(n).eq(all[..n].iter().copied()), "the first {n} are a prefix");
        assert_eq!(hierarchy.by_persistence(n), &hierarchy.extrema()[..n]);
    }
    let threshold = bytes.signed().abs();
    assert!(hierarchy.extrema().iter().take_while(|e| e.persistence > threshold).eq(hierarchy.above(threshold)));
    if component_count(&graph) == 1 {
        let range = field.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
        assert!(all[..2].iter().all(|e| e.saddle.is_none() && (e.value == range.0 || e.value == range.1)));
    }
}

fn indices<S: Scalar>(pairs: &Pairs<NodeIndex, S>) -> Vec<(usize, Option<usize>)> {
    let mut indices: Vec<_> = pairs.iter().map(|p| (p.extremum.index(), p.saddle.map(NodeIndex::index))).collect();
    indices.sort_unstable();
    indices
}

fn order(field: &[f64], a: usize, b: usize) -> Ordering {
    field[a].partial_cmp(&field[b]).expect("no NaN").then(a.cmp(&b))
}

fn relabel(graph: &Graph, label: impl Fn(usize) -> usize) -> Graph {
    let mut relabelled = UnGraph::new_undirected();
    let vertices: Vec<_> = graph.node_indices().map(|_| relabelled.add_node(())).collect();
    for e in graph.edge_references() {
        let [a, b] = [e.source(), e.target()].map(|v| vertices[label(v.index())]);
        relabelled.add_edge(a, b, ());
    }
    relabelled
}

fn component_count(graph: &Graph) -> usize {
    let mut pieces = UnionFind::<usize>::new(graph.node_count());
    for e in graph.edge_references() {
        pieces.union(e.source().index(), e.target().index());
    }
    let mut roots = pieces.into_labeling();
    roots.sort_unstable();
    roots.dedup();
    roots.len()
}

/// On grids, triangles and paths, with values left out, as f64 and as i8: the fast way is the plain sweep; the merge tree
/// has a leaf for every pair; basins cover what is not left out; a field is simplified within its bound.
pub fn domains(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let connectivity = [Connectivity::Axis, Connectivity::Full, Connectivity::Freudenthal][bytes.below(3)];
    match bytes.below(5) {
        0 => domain(&Path::new(bytes.below(64)), bytes),
        1 => domain(&Grid::new([1 + bytes.below(64)], connectivity).periodic([bytes.coin()]), bytes),
        2 => {
            let shape = [1 + bytes.below(9), 1 + bytes.below(9)];
            domain(&Grid::new(shape, connectivity).periodic([bytes.coin(), bytes.coin()]), bytes);
        }
        3 => {
            let shape = [1 + bytes.below(4), 1 + bytes.below(4), 1 + bytes.below(4)];
            domain(&Grid::new(shape, connectivity).periodic([bytes.coin(), bytes.coin(), bytes.coin()]), bytes);
        }
        _ => {
            let count = 1 + bytes.below(32);
            let corner = |bytes: &mut Bytes| bytes.below(count) as u32;
            let triangles: Vec<_> =
                (0..bytes.below(96)).map(|_| [corner(bytes), corner(bytes), corner(bytes)]).collect();
            domain(&TriangleMesh::new(count, &triangles).expect("corners exist"), bytes);
        }
    }
}

fn domain<G: Domain<Vertex = usize>>(domain: G, bytes: &mut Bytes) {
    let count = domain.vertex_count();
    let integers: Vec<i8> = (0..count).map(|_| bytes.byte() as i8).collect();
    domain_with(domain, &integers, i8::width(0, bytes.byte() as i8));
    let mut field = decode::field(bytes, count);
    for _ in 0..bytes.below(8).min(count) {
        field[bytes.below(count)] = f64::NAN;
    }
    domain_with(domain, &field, bytes.value().abs());
}

fn domain_with<G: Domain<Vertex = usize>, S: Scalar>(domain: G, field: &[S], bound: S::Width) {
    let options = PersistenceOptions::new().keep_zeros().nan(NanPolicy::Mask);
    let fast = options.persistence(domain, field).expect("a value for each vertex");
    assert_eq!(Ok(&fast), options.plain_sweep().persistence(domain, field).as_ref(), "fast and plain agree");
    let inside = field.iter().filter(|value| !value.is_nan()).count();
    for (kind, pairs) in [(Kind::Minimum, &fast.minima), (Kind::Maximum, &fast.maxima)] {
        let tree = options.merge_tree(domain, field, kind).expect("as before");
        assert_eq!(tree.leaf_count(), pairs.len());
        let basins = options.segmentation(domain, field, kind, bound).expect("as before");
        assert_eq!(basins.sizes().iter().sum::<usize>(), inside);
    }
    let simple = options.simplify(domain, field, bound).expect("as before");
    for (before, after) in field.iter().zip(&simple).filter(|(before, _)| !before.is_nan()) {
        assert!(before.width(*after) <= bound, "{after:?} is further than {bound:?} from {before:?}");
    }
    let left = PersistenceOptions::new().nan(NanPolicy::Mask).persistence(domain, &simple).expect("as before");
    let is_larger = |pair: &topo::Pair<usize, S>| pair.persistence() > bound;
    assert!(left.minima.finite().chain(left.maxima.finite()).all(is_larger), "no smaller pair is left");
}
