//! What one asks of a merge tree, against what its definition says.

use crate::inputs::{field, graph};
use petgraph::graph::{NodeIndex, UnGraph};
use petgraph::unionfind::UnionFind;
use proptest::prelude::*;
use topo::{Adjacency, Branch, Connectivity, Domain, Grid, Kind, NanPolicy, Path, PersistenceOptions, TriangleMesh};

fn graph_and_field() -> impl Strategy<Value = (UnGraph<(), ()>, Vec<f64>)> {
    graph(120).prop_flat_map(|graph| {
        let count = graph.node_count();
        (Just(graph), field(count))
    })
}

fn kind() -> impl Strategy<Value = Kind> {
    prop_oneof![Just(Kind::Minimum), Just(Kind::Maximum)]
}

fn is_before(kind: Kind, field: &[f64], u: usize, v: usize) -> bool {
    match kind {
        Kind::Minimum => field[u] < field[v] || field[u] == field[v] && u < v,
        Kind::Maximum => field[u] > field[v] || field[u] == field[v] && u > v,
    }
}

/// The connected parts of the vertices for which something holds.
fn parts(graph: &UnGraph<(), ()>, holds: impl Fn(usize) -> bool) -> UnionFind<usize> {
    let mut parts = UnionFind::new(graph.node_count());
    for (a, b) in graph.edge_indices().filter_map(|edge| graph.edge_endpoints(edge)) {
        if holds(a.index()) && holds(b.index()) {
            parts.union(a.index(), b.index());
        }
    }
    parts
}

/// The vertices of a branch's component just before its saddle.
fn component(graph: &UnGraph<(), ()>, kind: Kind, field: &[f64], branch: &Branch<NodeIndex, f64>) -> Vec<usize> {
    let saddle = branch.pair.saddle.map(NodeIndex::index);
    let holds = |v: usize| saddle.is_none_or(|saddle| is_before(kind, field, v, saddle));
    let parts = parts(graph, holds);
    (0..field.len()).filter(|&v| holds(v) && parts.equiv(v, branch.pair.extremum.index())).collect()
}

/// The same graph, known by its edges only.
fn listed<G: Domain>(domain: G) -> Adjacency {
    let mut lists = vec![Vec::new(); domain.vertex_count()];
    (0..lists.len()).for_each(|v| domain.for_each_neighbor(v, |u| lists[v].push(u)));
    Adjacency::new(&lists).expect("neighbours exist")
}

/// Basins of steepest descent are those of a graph whatever the domain knows of itself.
fn assert_steepest<G: Domain<Vertex = usize>>(domain: G, field: &[f64]) {
    let options = PersistenceOptions::new().nan(NanPolicy::Mask);
    for kind in [Kind::Minimum, Kind::Maximum] {
        let tree = options.merge_tree(domain, field, kind).expect("fits");
        assert!(tree == options.merge_tree(&listed(domain), field, kind).expect("fits"));
        for threshold in [-1.0, 0.0, 1.0] {
            let segments = options.segmentation(domain, field, kind, threshold).expect("fits");
            assert_eq!(segments, tree.segmentation(threshold));
        }
        // Without a threshold every vertex goes to where it is steepest.
        let basins = options.segmentation(domain, field, kind, -1.0).expect("fits");
        for v in (0..field.len()).filter(|&v| !field[v].is_nan()) {
            let mut steepest = v;
            domain.for_each_neighbor(v, |u| {
                if !field[u].is_nan() && is_before(kind, field, u, steepest) {
                    steepest = u;
                }
            });
            assert_eq!(basins.label(v), basins.label(steepest));
        }
    }
}

/// For each vertex the extremum of its segment by what a flood does: vertices enter one by one; where components meet, every one but the eldest
/// ends, the elder ones first, and spills into the basin of the earliest neighbour in what goes on.
fn flooded<G: Domain<Vertex = usize>>(domain: G, field: &[f64], kind: Kind, threshold: f64) -> Vec<Option<usize>> {
    let before = |u: usize, v: usize| is_before(kind, field, u, v);
    let order = |&u: &usize, &v: &usize| before(v, u).cmp(&before(u, v));
    let mut vertices: Vec<usize> = (0..field.len()).filter(|&v| !field[v].is_nan()).collect();
    vertices.sort_by(order);
    let mut basin: Vec<Option<usize>> = vec![None; field.len()];
    // For each extremum that of its component, and into whose basin it spills.
    let (mut component, mut beyond) = (vec![0; field.len()], vec![None; field.len()]);
    for v in vertices {
        let mut around = Vec::new();
        domain.for_each_neighbor(v, |u| around.extend((!field[u].is_nan() && before(u, v)).then_some(u)));
        around.sort_by(order);
        let basins: Vec<usize> = around.iter().filter_map(|&u| basin[u]).collect();
        basin[v] = basins.first().copied().or(Some(v));
        component[v] = v;
        let mut met: Vec<usize> = basins.iter().map(|&basin| component[basin]).collect();
        met.sort_by(order);
        met.dedup();
        for &younger in met.iter().skip(1) {
            let first = basins.iter().copied().find(|&basin| component[basin] == met[0]);
            if field[younger] == field[v] || (field[younger] - field[v]).abs() <= threshold {
                beyond[younger] = first;
            }
            component.iter_mut().filter(|of| **of == younger).for_each(|of| *of = met[0]);
        }
    }
    let end = |mut extremum: usize| {
        while let Some(next) = beyond[extremum] {
            extremum = next;
        }
        extremum
    };
    basin.into_iter().map(|basin| basin.map(end)).collect()
}

/// Segments are where a flood spills.
fn assert_spills<G: Domain<Vertex = usize>>(domain: G, field: &[f64]) {
    let options = PersistenceOptions::new().nan(NanPolicy::Mask);
    for kind in [Kind::Minimum, Kind::Maximum] {
        for threshold in [0.0, 1.0, 2.0] {
            let segments = options.segmentation(domain, field, kind, threshold).expect("fits");
            let extrema: Vec<_> = segments.labels().map(|label| Some(segments.extrema()[label?])).collect();
            assert_eq!(extrema, flooded(domain, field, kind, threshold));
        }
    }
}

fn grid<const D: usize>(max: usize) -> impl Strategy<Value = (Grid<D>, Vec<f64>)> {
    let connectivity = prop_oneof![Just(Connectivity::Axis), Just(Connectivity::Full), Just(Connectivity::Freudenthal)];
    let shape = proptest::array::uniform::<_, D>(1..=max);
    (shape, proptest::array::uniform::<_, D>(any::<bool>()), connectivity).prop_flat_map(
        |(shape, periodic, connectivity)| {
            let grid = Grid::new(shape, connectivity).periodic(periodic);
            let value = prop_oneof![9 => crate::inputs::value(), 1 => Just(f64::NAN)];
            (Just(grid), proptest::collection::vec(value, (&grid).vertex_count()))
        },
    )
}

proptest! {
    #[test]
    fn basins_in_a_picture_are_of_steepest_descent((grid, field) in grid::<2>(12)) {
        assert_steepest(&grid, &field);
        assert_spills(&grid, &field);
    }

    #[test]
    fn basins_in_a_volume_are_of_steepest_descent((grid, field) in grid::<3>(5)) {
        assert_steepest(&grid, &field);
        assert_spills(&grid, &field);
    }

    #[test]
    fn basins_on_a_path_and_a_strip_are_of_steepest_descent(field in (1..60usize).prop_flat_map(field)) {
        assert_steepest(&Path::new(field.len()), &field);
        let strip: Vec<[u32; 3]> = (2..field.len() as u32).map(|v| [v - 2, v - 1, v]).collect();
        let strip = TriangleMesh::new(field.len(), &strip).expect("corners exist");
        assert_steepest(&strip, &field);
        assert_spills(&strip, &field);
    }

    #[test]
    fn one_tree_gives_the_segments_of_every_threshold((graph, field) in graph_and_field(), kind in kind(), first in 0..3u8, second in 0..3u8) {
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        let [first, second] = [first, second].map(f64::from);
        let expected = topo::segmentation(&graph, &field, kind, first.max(second)).expect("fits");
        prop_assert_eq!(&tree.segmentation(first.max(second)), &expected);
        prop_assert_eq!(&tree.simplify(first).segmentation(second), &expected);
    }

    #[test]
    fn a_branch_is_as_large_as_its_component_before_the_saddle((graph, field) in graph_and_field(), kind in kind()) {
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        let weights: Vec<f64> = (0..field.len()).map(|v| (v % 5) as f64).collect();
        let sums = tree.sums(&weights).expect("a weight for each");
        for (branch, sum) in tree.branches().iter().zip(sums) {
            let component = component(&graph, kind, &field, branch);
            prop_assert_eq!(branch.size, component.len());
            prop_assert_eq!(sum, component.iter().map(|&v| weights[v]).sum::<f64>());
        }
    }

    #[test]
    fn branches_that_are_kept_are_as_large_as_before((graph, field) in graph_and_field(), kind in kind(), first in 0..3u8, least in 1..4usize) {
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        let weights: Vec<f64> = (0..field.len()).map(|v| (v % 5) as f64).collect();
        let before: Vec<_> = tree.branches().into_iter().zip(tree.sums(&weights).expect("a weight for each")).collect();
        let once = tree.simplify(f64::from(first));
        let twice = once.filter(|branch| branch.size >= least);
        for simple in [once, twice] {
            for (branch, sum) in simple.branches().iter().zip(simple.sums(&weights).expect("a weight for each")) {
                let same = before.iter().find(|(other, _)| other.pair.extremum == branch.pair.extremum);
                let (other, sum_before) = same.expect("it was there");
                prop_assert_eq!((branch.size, sum), (other.size, *sum_before));
            }
        }
    }

    #[test]
    fn a_filtered_tree_has_the_wanted_branches_and_what_they_end_in((graph, field) in graph_and_field(), kind in kind(), least in 1..6usize) {
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        let wide = tree.filter(|branch| branch.size >= least);
        // Sizes never fall from a branch to that in which it ends.
        let wanted = tree.branches().into_iter().filter(|branch| branch.size >= least || branch.pair.is_essential());
        let kept: Vec<_> = wide.branches().iter().map(|branch| branch.pair).collect();
        prop_assert_eq!(kept, wanted.map(|branch| branch.pair).collect::<Vec<_>>());
        // The field of the tree is the field without those branches.
        let again = PersistenceOptions::new().merge_tree(&graph, wide.field(), kind).expect("fits");
        let finite = |tree: &topo::MergeTree<NodeIndex, f64>| {
            let mut widths: Vec<f64> = tree.branches().iter().filter(|b| !b.pair.is_essential()).map(|b| b.pair.persistence()).collect();
            widths.retain(|&width| width > 0.0);
            widths.sort_by(f64::total_cmp);
            widths
        };
        prop_assert_eq!(finite(&again), finite(&wide));
        prop_assert!(tree.filter(|_| true) == tree);
    }

    #[test]
    fn components_at_a_level_are_the_parts_of_the_set((graph, field) in graph_and_field(), kind in kind(), level in -3..=3i32) {
        let level = f64::from(level);
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        let holds = |v: usize| if kind == Kind::Minimum { field[v] <= level } else { field[v] >= level };
        let parts = parts(&graph, holds);
        let components = tree.components(level);
        for u in 0..field.len() {
            prop_assert_eq!(components.label(u).is_some(), holds(u));
            for v in (0..u).filter(|&v| holds(u) && holds(v)) {
                prop_assert_eq!(components.label(u) == components.label(v), parts.equiv(u, v));
            }
        }
        let branches = tree.branches();
        for (component, part) in tree.at(level).iter().zip(0..) {
            prop_assert_eq!(components.extrema()[part], component.extremum);
            prop_assert_eq!(components.vertices(part).count(), component.size);
            let branch = branches.iter().find(|branch| branch.pair.extremum == component.extremum).expect("it is a leaf");
            prop_assert_eq!((component.value, component.saddle), (branch.pair.birth, branch.pair.saddle));
            let eldest = components.vertices(part).reduce(|u, v| if is_before(kind, &field, u, v) { u } else { v });
            prop_assert_eq!(eldest, Some(component.extremum.index()));
        }
    }
}

#[test]
fn a_weight_must_be_there_for_every_vertex() {
    let tree = topo::merge_tree(&Path::new(3), &[1, 2, 3], Kind::Minimum).expect("fits");
    let error = topo::Error::Length { values: 2, vertices: 3 };
    assert_eq!(tree.sums(&[1.0, 2.0]), Err(error));
    assert_eq!(tree.components(2).sums(&[1.0, 2.0]), Err(error));
}

#[test]
fn a_long_row_of_branches_is_climbed_quickly() {
    // Each valley ends in the next deeper one; a high plain drains into the shallowest.
    const VALLEYS: usize = 60_000;
    let (row, plain) = (2 * VALLEYS, 60_000);
    let height = |v: usize| if v.is_multiple_of(2) { 1_000_000 - v as i64 } else { 1_000_001 + v as i64 };
    let mut field: Vec<i64> = (0..row).map(height).collect();
    field.extend(vec![10_000_000; plain]);
    let mut edges: Vec<[usize; 2]> = (1..row).map(|v| [v - 1, v]).collect();
    edges.extend((0..plain).map(|v| [0, row + v]));
    let graph = Adjacency::from_edges(field.len(), &edges).expect("ends exist");
    let tree = topo::merge_tree(&graph, &field, Kind::Minimum).expect("fits");
    let branches = tree.branches();
    assert_eq!(branches.iter().map(|branch| branch.size).max(), Some(field.len()));
    assert_eq!(branches[0].size, 1);
}
