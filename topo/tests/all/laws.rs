//! Laws of the pairing on random graphs and fields, with ties on purpose.

use crate::inputs::{field, graph, matrix_reduction, relabelled};
use petgraph::graph::{NodeIndex, UnGraph};
use proptest::prelude::*;
use topo::{Hierarchy, Kind, Pair, Pairs, Path, PersistenceOptions, Scalar};

type Graph = UnGraph<(), ()>;
type Indices = Vec<(usize, Option<usize>)>;

/// (extremum, saddle) of all pairs, those of zero persistence included, by index of the extremum.
fn indices<S: Scalar>(pairs: &Pairs<NodeIndex, S>) -> Indices {
    let indices = |pair: &Pair<NodeIndex, S>| (pair.extremum.index(), pair.saddle.map(NodeIndex::index));
    let mut indices: Indices = pairs.iter().map(indices).collect();
    indices.sort_unstable();
    indices
}

fn sublevel(graph: &Graph, field: &[f64]) -> Pairs<NodeIndex, f64> {
    PersistenceOptions::new().keep_zeros().sublevel(graph, field).expect("one value for every vertex")
}

fn superlevel(graph: &Graph, field: &[f64]) -> Pairs<NodeIndex, f64> {
    PersistenceOptions::new().keep_zeros().superlevel(graph, field).expect("one value for every vertex")
}

fn graph_and_field() -> impl Strategy<Value = (Graph, Vec<f64>)> {
    graph(200).prop_flat_map(|graph| {
        let count = graph.node_count();
        (Just(graph), field(count))
    })
}

/// A graph with finite values and a permutation of its vertices.
fn graph_and_permutation() -> impl Strategy<Value = (Graph, Vec<f64>, Vec<usize>)> {
    graph(80).prop_flat_map(|graph| {
        let count = graph.node_count();
        let distinct: Vec<f64> = (0..count).map(|place| place as f64 / 7.0).collect();
        (Just(graph), Just(distinct).prop_shuffle(), Just((0..count).collect::<Vec<_>>()).prop_shuffle())
    })
}

fn finite_field(count: usize) -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(-8.0..8.0f64, count)
}

proptest! {
    #[test]
    fn the_fast_way_agrees_with_the_plain_sweep((graph, field) in graph_and_field()) {
        let options = PersistenceOptions::new().keep_zeros();
        prop_assert_eq!(options.persistence(&graph, &field), options.plain_sweep().persistence(&graph, &field));
    }

    #[test]
    fn the_sweep_agrees_with_reduction_of_the_boundary_matrix((graph, field) in graph_and_field()) {
        let pairs = PersistenceOptions::new().keep_zeros().plain_sweep().sublevel(&graph, &field).expect("fits");
        prop_assert_eq!(indices(&pairs), matrix_reduction(&graph, &field));
    }

    #[test]
    fn every_minimum_is_paired_exactly_once((graph, field) in graph_and_field()) {
        let is_earlier = |u: usize, v: usize| field[u] < field[v] || field[u] == field[v] && u < v;
        let minima = graph.node_indices().filter(|&v| !graph.neighbors(v).any(|u| is_earlier(u.index(), v.index())));
        let paired: Vec<usize> = indices(&sublevel(&graph, &field)).into_iter().map(|(minimum, _)| minimum).collect();
        prop_assert_eq!(paired, minima.map(NodeIndex::index).collect::<Vec<_>>());
    }

    #[test]
    fn a_saddle_is_never_below_its_minimum((graph, field) in graph_and_field()) {
        for pair in &sublevel(&graph, &field) {
            prop_assert!(pair.death().is_none_or(|death| death >= pair.birth));
            prop_assert!(pair.saddle.is_none_or(|saddle| field[saddle.index()] >= field[pair.extremum.index()]));
        }
    }

    #[test]
    fn pairs_come_by_index_and_are_ranked_by_persistence_and_zeros_are_counted((graph, field) in graph_and_field()) {
        let all = sublevel(&graph, &field);
        prop_assert!(all.windows(2).all(|pair| pair[0].extremum < pair[1].extremum));
        let ranked = all.ranked();
        prop_assert!(ranked.windows(2).all(|pair| pair[0].persistence() >= pair[1].persistence()));
        for n in 0..=all.len() + 1 {
            prop_assert_eq!(&all.top(n)[..], &ranked[..n.min(all.len())]);
        }
        let kept = topo::sublevel(&graph, &field).expect("fits");
        prop_assert_eq!(kept.len() + kept.zero_count(), all.len());
        prop_assert_eq!(kept.zero_count(), all.finite().filter(|pair| pair.persistence() == 0.0).count());
        prop_assert_eq!(kept.above(1.0).count(), all.iter().filter(|pair| pair.persistence() > 1.0).count());
    }

    #[test]
    fn equally_persistent_pairs_come_as_their_extrema_enter((graph, field) in graph_and_field()) {
        let is_before = |kind: Kind, u: usize, v: usize| match kind {
            Kind::Minimum => field[u] < field[v] || field[u] == field[v] && u < v,
            Kind::Maximum => field[u] > field[v] || field[u] == field[v] && u > v,
        };
        for pairs in [sublevel(&graph, &field), superlevel(&graph, &field)] {
            for pair in pairs.ranked().windows(2).filter(|pair| pair[0].persistence() == pair[1].persistence()) {
                let [a, b] = [&pair[0], &pair[1]];
                let enters_first = is_before(pairs.kind(), a.extremum.index(), b.extremum.index());
                let is_in_order = if a.is_essential() == b.is_essential() { enters_first } else { a.is_essential() };
                prop_assert!(is_in_order);
            }
        }
    }

    #[test]
    fn negation_with_indices_reversed_swaps_minima_and_maxima((graph, field) in graph_and_field()) {
        let last = field.len() - 1;
        let reversed: Vec<usize> = (0..field.len()).rev().collect();
        let negated: Vec<f64> = field.iter().rev().map(|value| -value).collect();
        let mut minima: Indices = indices(&sublevel(&relabelled(&graph, &reversed), &negated))
            .into_iter()
            .map(|(extremum, saddle)| (last - extremum, saddle.map(|saddle| last - saddle)))
            .collect();
        minima.sort_unstable();
        prop_assert_eq!(minima, indices(&superlevel(&graph, &field)));
    }

    #[test]
    fn relabelling_commutes_where_there_are_no_ties((graph, field, order) in graph_and_permutation()) {
        let mut moved = vec![0.0; field.len()];
        order.iter().zip(&field).for_each(|(&to, &value)| moved[to] = value);
        let mut expected: Indices = indices(&sublevel(&graph, &field))
            .into_iter()
            .map(|(extremum, saddle)| (order[extremum], saddle.map(|saddle| order[saddle])))
            .collect();
        expected.sort_unstable();
        prop_assert_eq!(indices(&sublevel(&relabelled(&graph, &order), &moved)), expected);
    }

    #[test]
    fn a_strictly_monotone_map_keeps_the_pairs((graph, field) in graph_and_field()) {
        // Ranks, as integers.
        let mut sorted = field.clone();
        sorted.sort_by(f64::total_cmp);
        let ranks: Vec<i16> = field.iter().map(|value| sorted.partition_point(|other| other < value) as i16 - 100).collect();
        let of_ranks = PersistenceOptions::new().keep_zeros().sublevel(&graph, &ranks).expect("fits");
        prop_assert_eq!(indices(&of_ranks), indices(&sublevel(&graph, &field)));
    }

    #[test]
    fn small_changes_move_the_diagram_little(
        (graph, field, noise) in graph(60).prop_flat_map(|graph| {
            let count = graph.node_count();
            (Just(graph), finite_field(count), proptest::collection::vec(-0.5..0.5f64, count))
        })
    ) {
        let noisy: Vec<f64> = field.iter().zip(&noise).map(|(value, noise)| value + noise).collect();
        let change = field.iter().zip(&noisy).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        for pairs in [sublevel, superlevel] {
            let (before, after) = (pairs(&graph, &field).diagram(), pairs(&graph, &noisy).diagram());
            prop_assert!(before.bottleneck(&after).expect("alike") <= change * (1.0 + 1e-12));
        }
    }

    #[test]
    fn an_edge_more_never_makes_more_components((mut graph, field) in graph_and_field(), ends: [prop::sample::Index; 2]) {
        let before = sublevel(&graph, &field).essential().count();
        let [a, b] = ends.map(|end| NodeIndex::new(end.index(field.len())));
        graph.add_edge(a, b, ());
        prop_assert!(sublevel(&graph, &field).essential().count() <= before);
    }

    #[test]
    fn repeated_edges_and_loops_change_nothing((graph, field) in graph_and_field()) {
        let mut more = graph.clone();
        let edges: Vec<_> = graph.edge_indices().filter_map(|edge| graph.edge_endpoints(edge)).collect();
        more.extend_with_edges(edges.into_iter().map(|(a, b)| (b, a)));
        more.extend_with_edges(graph.node_indices().map(|v| (v, v)));
        prop_assert_eq!(topo::persistence(&more, &field), topo::persistence(&graph, &field));
    }

    #[test]
    fn what_falls_on_a_path_is_what_its_pairs_live(field in (1..200usize).prop_flat_map(finite_field)) {
        let descent: f64 = field.windows(2).map(|pair| (pair[0] - pair[1]).max(0.0)).sum();
        let minimum = field.iter().copied().fold(f64::INFINITY, f64::min);
        let pairs = topo::sublevel(&Path::new(field.len()), &field).expect("fits");
        prop_assert!((descent - (pairs.total_persistence() + field[0] - minimum)).abs() <= 1e-12 * (1.0 + descent));
    }

    #[test]
    fn hierarchies_are_nested((graph, field) in graph_and_field()) {
        let hierarchy: Hierarchy<_, _> = topo::persistence(&graph, &field).expect("fits").hierarchy();
        let count = hierarchy.extrema().len();
        let all: Vec<_> = hierarchy.alternating(count + 1).collect();
        prop_assert_eq!(all.len(), count);
        for n in 0..count {
            prop_assert!(hierarchy.alternating(n).eq(all[..n].iter().copied()));
            prop_assert_eq!(hierarchy.by_persistence(n), &hierarchy.extrema()[..n]);
        }
        for threshold in [0.0, 1.0, 2.5, f64::INFINITY] {
            let above: Vec<_> = hierarchy.extrema().iter().copied().filter(|e| e.persistence > threshold).collect();
            prop_assert_eq!(hierarchy.above(threshold), above);
        }
        prop_assert!(hierarchy.of_kind(Kind::Maximum).count() > 0);
    }
}
