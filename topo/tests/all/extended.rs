//! Extended persistence against the reduction of the boundary matrix of the graph and the cone over it.

use crate::inputs::{field, graph};
use petgraph::graph::UnGraph;
use proptest::prelude::*;
use std::collections::BTreeSet;
use topo::PersistenceOptions;

/// What a column of the matrix stands for: a vertex or an edge, itself or with the cone's tip, by the vertex with which it enters.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Cell {
    Vertex,
    Edge,
    ConeOfVertex,
    ConeOfEdge,
}

/// Pairs (cell, vertex, cell, vertex) of all that is not born and dead at one vertex within one half: the tip, then vertices
/// and edges upwards, then the cones over them downwards, reduced over two elements from left to right.
fn pairs_by_reduction(graph: &UnGraph<(), ()>, field: &[f64]) -> BTreeSet<(Cell, usize, Cell, usize, usize)> {
    let n = field.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| field[a].partial_cmp(&field[b]).expect("no NaN").then(a.cmp(&b)));
    let mut rank = vec![0; n];
    order.iter().enumerate().for_each(|(place, &v)| rank[v] = place);
    let edges: BTreeSet<[usize; 2]> = graph
        .raw_edges()
        .iter()
        .map(|edge| [edge.source(), edge.target()].map(|v| rank[v.index()]))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .filter(|[a, b]| a != b)
        .collect();
    // Cells with their simplices: the tip is n.
    let mut cells: Vec<(Cell, usize, Vec<usize>)> = vec![(Cell::Vertex, n, vec![n])];
    for v in 0..n {
        cells.push((Cell::Vertex, v, vec![v]));
        cells.extend(edges.iter().filter(|edge| edge[1] == v).map(|edge| (Cell::Edge, v, edge.to_vec())));
    }
    for v in (0..n).rev() {
        cells.push((Cell::ConeOfVertex, v, vec![v, n]));
        let with = edges.iter().filter(|edge| edge[0] == v);
        cells.extend(with.map(|&[a, b]| (Cell::ConeOfEdge, v, vec![a, b, n])));
    }
    let place = |simplex: &[usize]| cells.iter().position(|cell| cell.2 == simplex).expect("faces are cells");
    let mut reduced: Vec<Option<BTreeSet<usize>>> = vec![None; cells.len()];
    let mut pairs = BTreeSet::new();
    for (number, (cell, v, simplex)) in cells.iter().enumerate() {
        let without =
            |k: usize| simplex.iter().enumerate().filter(|&(i, _)| i != k).map(|(_, &v)| v).collect::<Vec<_>>();
        let faces = if simplex.len() > 1 { 0..simplex.len() } else { 0..0 };
        let mut column: BTreeSet<usize> = faces.map(|k| place(&without(k))).collect();
        while let Some(&pivot) = column.last() {
            let Some(other) = &reduced[pivot] else {
                let (of, born, _) = &cells[pivot];
                if born != v {
                    pairs.insert((*of, order[*born], *cell, order[*v], number));
                }
                reduced[pivot] = Some(column);
                break;
            };
            column = column.symmetric_difference(other).copied().collect();
        }
    }
    pairs
}

fn graph_and_field() -> impl Strategy<Value = (UnGraph<(), ()>, Vec<f64>)> {
    graph(14).prop_flat_map(|graph| {
        let count = graph.node_count();
        (Just(graph), field(count))
    })
}

proptest! {
    #[test]
    fn all_four_kinds_of_pairs_are_those_of_the_matrix((graph, field) in graph_and_field()) {
        let found = PersistenceOptions::new().keep_zeros().extended_persistence(&graph, &field).expect("it fits");
        let matrix = pairs_by_reduction(&graph, &field);
        let of = |born: Cell, dies: Cell| {
            let mut pairs: Vec<(usize, usize)> =
                matrix.iter().filter(|pair| (pair.0, pair.2) == (born, dies)).map(|pair| (pair.1, pair.3)).collect();
            pairs.sort_unstable();
            pairs
        };
        let sorted = |mut pairs: Vec<(usize, usize)>| { pairs.sort_unstable(); pairs };
        let minima = found.minima.finite().map(|pair| (pair.extremum.index(), pair.saddle.expect("finite").index()));
        prop_assert_eq!(sorted(minima.collect()), of(Cell::Vertex, Cell::Edge));
        let maxima = found.maxima.finite().map(|pair| (pair.extremum.index(), pair.saddle.expect("finite").index()));
        prop_assert_eq!(sorted(maxima.collect()), of(Cell::ConeOfVertex, Cell::ConeOfEdge));
        let loops = found.loops.iter().map(|ring| (ring.highest.index(), ring.lowest.index()));
        prop_assert_eq!(sorted(loops.collect()), of(Cell::Edge, Cell::ConeOfEdge));
        // A component of one vertex begins and ends there, and is no pair of the matrix above.
        let ends = of(Cell::Vertex, Cell::ConeOfVertex);
        let births: Vec<usize> = ends.iter().map(|&(minimum, _)| minimum).collect();
        let mut tops: Vec<usize> = ends.iter().map(|&(_, maximum)| maximum).collect();
        tops.sort_unstable();
        let is_alone = |v: usize| graph.neighbors((v as u32).into()).all(|u| u.index() == v);
        let essential = |pairs: &topo::Pairs<petgraph::graph::NodeIndex, f64>| {
            pairs.essential().map(|pair| pair.extremum.index()).filter(|&v| !is_alone(v)).collect::<Vec<_>>()
        };
        prop_assert_eq!(essential(&found.minima), births);
        prop_assert_eq!(essential(&found.maxima), tops);
    }
}
