//! Laws of the pairing on random graphs and fields, with ties on purpose.

use crate::inputs::{field, graph, matrix_reduction};
use petgraph::graph::UnGraph;
use proptest::prelude::*;
use topo::{Options, Pair, Pairs};

type Graph = UnGraph<(), ()>;

fn in_indices<S: topo::Scalar>(pairs: &Pairs<petgraph::graph::NodeIndex, S>) -> Vec<(usize, Option<usize>)> {
    let indices = |pair: &Pair<petgraph::graph::NodeIndex, S>| {
        (pair.extremum.index(), pair.saddle.map(petgraph::graph::NodeIndex::index))
    };
    pairs.iter().map(indices).collect()
}

fn graph_and_field() -> impl Strategy<Value = (Graph, Vec<f64>)> {
    graph(200).prop_flat_map(|graph| {
        let count = graph.node_count();
        (Just(graph), field(count))
    })
}

proptest! {
    #[test]
    fn the_fast_way_agrees_with_the_plain_sweep((graph, field) in graph_and_field()) {
        let options = Options::new().keep_zeros();
        prop_assert_eq!(options.persistence(&graph, &field), options.plain_sweep().persistence(&graph, &field));
    }

    #[test]
    fn the_sweep_agrees_with_reduction_of_the_boundary_matrix((graph, field) in graph_and_field()) {
        let mut pairs = in_indices(&Options::new().keep_zeros().sublevel(&graph, &field).expect("fits"));
        pairs.sort_unstable();
        prop_assert_eq!(pairs, matrix_reduction(&graph, &field));
    }
}
