//! Random inputs that hurt, and an independent way to the pairs.

use petgraph::graph::UnGraph;
use proptest::prelude::*;
use std::cmp::Ordering;

/// Undirected graphs with loops and repeated edges, connected or not.
pub(crate) fn graph(max_vertices: usize) -> impl Strategy<Value = UnGraph<(), ()>> {
    (1..=max_vertices).prop_flat_map(|count| {
        let edge = (0..count as u32, 0..count as u32);
        proptest::collection::vec(edge, 0..3 * count).prop_map(move |edges| {
            let mut graph = UnGraph::from_edges(edges);
            while graph.node_count() < count {
                graph.add_node(());
            }
            graph
        })
    })
}

/// Values that are equal, an ulp apart, infinite, or zeros of both signs as often as they are ordinary.
pub(crate) fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1.0..1.0f64,
        4 => (-3..=3i32).prop_map(f64::from),
        1 => Just(-0.0),
        1 => Just(1.0 + f64::EPSILON),
        1 => Just(f64::INFINITY),
        1 => Just(f64::NEG_INFINITY),
    ]
}

/// One value for each of `count` vertices.
pub(crate) fn field(count: usize) -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(value(), count)
}

/// The (extremum, saddle) pairs of the sublevel filtration by reducing the boundary matrix of vertices and edges over
/// two elements, column by column from left to right (Edelsbrunner, Letscher & Zomorodian 2002), sorted by extremum.
pub(crate) fn matrix_reduction(graph: &UnGraph<(), ()>, field: &[f64]) -> Vec<(usize, Option<usize>)> {
    let mut order: Vec<usize> = (0..field.len()).collect();
    let compare = |&a: &usize, &b: &usize| field[a].partial_cmp(&field[b]).unwrap_or(Ordering::Equal).then(a.cmp(&b));
    order.sort_by(compare);
    let mut rank = vec![0; field.len()];
    order.iter().enumerate().for_each(|(place, &vertex)| rank[vertex] = place);

    // An edge enters with its later end; its boundary are its two ends, which cancel if they are one.
    let mut columns: Vec<[usize; 2]> = graph
        .edge_indices()
        .filter_map(|edge| graph.edge_endpoints(edge))
        .map(|(a, b)| [rank[a.index()].min(rank[b.index()]), rank[a.index()].max(rank[b.index()])])
        .filter(|[a, b]| a != b)
        .collect();
    columns.sort_by_key(|&[a, b]| (b, a));

    let mut column_of_pivot: Vec<Option<Vec<usize>>> = vec![None; field.len()];
    let mut death: Vec<Option<usize>> = vec![None; field.len()];
    for column in columns {
        let enters = column[1];
        let mut column = column.to_vec();
        while let Some(pivot) = column.iter().copied().max() {
            let Some(earlier) = &column_of_pivot[pivot] else {
                death[pivot] = Some(enters);
                column_of_pivot[pivot] = Some(column);
                break;
            };
            for &row in earlier {
                match column.iter().position(|&other| other == row) {
                    Some(place) => drop(column.swap_remove(place)),
                    None => column.push(row),
                }
            }
        }
    }
    let pairs = (0..field.len()).filter(|&place| death[place] != Some(place));
    let mut pairs: Vec<_> = pairs.map(|place| (order[place], death[place].map(|death| order[death]))).collect();
    pairs.sort_unstable();
    pairs
}

/// The same graph where vertex `v` is called `order[v]`.
pub(crate) fn relabelled(graph: &UnGraph<(), ()>, order: &[usize]) -> UnGraph<(), ()> {
    let ends = graph.edge_indices().filter_map(|edge| graph.edge_endpoints(edge));
    let mut relabelled = UnGraph::from_edges(ends.map(|(a, b)| (order[a.index()] as u32, order[b.index()] as u32)));
    while relabelled.node_count() < graph.node_count() {
        relabelled.add_node(());
    }
    relabelled
}
