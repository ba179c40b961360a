//! Graphs in whatever integers they come; clusters of a density on a neighbour graph.

use crate::inputs::field;
use num_traits::PrimInt;
use proptest::prelude::*;
use topo::{Adjacency, CsrGraph, Error, Kind, PersistenceOptions, Scalar, TriangleMesh};

/// Edges as a symmetric matrix has them: starts and indices.
fn rows(graph: &Adjacency, n: usize) -> (Vec<i32>, Vec<u64>) {
    let mut starts = vec![0];
    let mut indices = Vec::new();
    for v in 0..n {
        indices.extend(graph.neighbors(v).iter().map(|&u| u64::from(u)));
        starts.push(indices.len() as i32);
    }
    (starts, indices)
}

fn renamed<I: PrimInt>(edges: &[(usize, usize)]) -> Vec<(I, I)> {
    let name = |v: usize| I::from(v).expect("there are few");
    edges.iter().map(|&(a, b)| (name(a), name(b))).collect()
}

fn graph() -> impl Strategy<Value = (Vec<f64>, Vec<(usize, usize)>)> {
    (1..30usize).prop_flat_map(|n| (field(n), proptest::collection::vec((0..n, 0..n), 0..70)))
}

/// `ToMATo` as in the paper: vertices by falling density; each joins the cluster of its densest neighbour, and clusters that meet
/// there are merged into that with the higher peak, where the other's peak is no more than the prominence above the vertex. For each
/// vertex the peak of its cluster.
fn tomato(graph: &Adjacency, density: &[f64], prominence: f64) -> Vec<usize> {
    let n = density.len();
    let comes_first = |u: usize, v: usize| density[u] > density[v] || density[u] == density[v] && u > v;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&u, &v| if comes_first(u, v) { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater });
    let mut cluster: Vec<usize> = (0..n).collect();
    for &v in &order {
        let mut above: Vec<usize> =
            graph.neighbors(v).iter().map(|&u| u as usize).filter(|&u| u != v && comes_first(u, v)).collect();
        above.sort_by(|&a, &b| if comes_first(a, b) { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater });
        let Some(&steepest) = above.first() else { continue };
        cluster[v] = cluster[steepest];
        for &u in &above {
            let [own, other] = [cluster[v], cluster[u]];
            let (elder, younger) = if comes_first(own, other) { (own, other) } else { (other, own) };
            if own != other && density[younger].width(density[v]) <= prominence {
                cluster.iter_mut().filter(|of| **of == younger).for_each(|of| *of = elder);
            }
        }
    }
    cluster
}

proptest! {
    #[test]
    fn integers_of_any_type_name_the_same_graph((field, edges) in graph()) {
        let n = field.len();
        let expected = Adjacency::from_edges(n, &edges).expect("ends exist");
        prop_assert_eq!(Adjacency::from_edges(n, &renamed::<u8>(&edges)), Ok(expected.clone()));
        prop_assert_eq!(Adjacency::from_edges(n, &renamed::<i64>(&edges)), Ok(expected.clone()));
        let arrays: Vec<[u32; 2]> = renamed::<u32>(&edges).into_iter().map(<[u32; 2]>::from).collect();
        prop_assert_eq!(Adjacency::from_edges(n, &arrays), Ok(expected.clone()));
        let mut lists = vec![Vec::<i16>::new(); n];
        renamed::<i16>(&edges).into_iter().for_each(|(a, b)| lists[a as usize].push(b));
        prop_assert_eq!(Adjacency::new(&lists), Ok(expected.clone()));

        let weighted: Vec<(usize, usize, f64)> = edges.iter().map(|&(a, b)| (a, b, field[a].max(field[b]))).collect();
        let as_integers: Vec<(i8, i8, f64)> = weighted.iter().map(|&(a, b, w)| (a as i8, b as i8, w)).collect();
        prop_assert_eq!(topo::single_linkage(n, &weighted), topo::single_linkage(n, &as_integers));
    }

    #[test]
    fn rows_of_a_sparse_matrix_are_the_graph_itself((field, edges) in graph()) {
        let listed = Adjacency::from_edges(field.len(), &edges).expect("ends exist");
        let (starts, indices) = rows(&listed, field.len());
        let csr = CsrGraph::new(&starts, &indices).expect("symmetric");
        prop_assert_eq!(topo::persistence(&csr, &field), topo::persistence(&listed, &field));
        let options = PersistenceOptions::new();
        for kind in [Kind::Minimum, Kind::Maximum] {
            prop_assert_eq!(options.merge_tree(&csr, &field, kind), options.merge_tree(&listed, &field, kind));
        }
    }

    #[test]
    fn an_edge_from_one_end_only_is_named((field, edges) in graph(), gone in any::<proptest::sample::Index>()) {
        let listed = Adjacency::from_edges(field.len(), &edges).expect("ends exist");
        let (mut starts, mut indices) = rows(&listed, field.len());
        prop_assume!(!indices.is_empty());
        let place = gone.index(indices.len());
        let to = indices.remove(place) as usize;
        let from = starts.partition_point(|&start| start as usize <= place) - 1;
        starts[from + 1..].iter_mut().for_each(|start| *start -= 1);
        let result = CsrGraph::new(&starts, &indices).map(|_| ());
        // What is left stands in the row of the other end. An edge to itself is there from both ends in any case.
        prop_assert_eq!(result, if from == to { Ok(()) } else { Err(Error::OneWay { from: to, to: from }) });
    }

    #[test]
    fn clusters_are_those_of_tomato((density, edges) in graph(), prominence in 0..4usize) {
        let prominence = [0.0, 0.5, 1.0, 2.5][prominence];
        let near = Adjacency::from_edges(density.len(), &edges).expect("ends exist");
        let tree = topo::merge_tree(&near, &density, Kind::Maximum).expect("fits");
        let segments = tree.segmentation(prominence);
        let found: Vec<Option<usize>> =
            segments.labels().map(|label| label.map(|segment| segments.extrema()[segment])).collect();
        let expected: Vec<Option<usize>> = tomato(&near, &density, prominence).into_iter().map(Some).collect();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn so_many_clusters_are_those_of_the_most_prominent_peaks((density, edges) in graph(), count in 0..12usize) {
        let near = Adjacency::from_edges(density.len(), &edges).expect("ends exist");
        for kind in [Kind::Minimum, Kind::Maximum] {
            let tree = topo::merge_tree(&near, &density, kind).expect("fits");
            let clusters = tree.clusters(count);
            let options = PersistenceOptions::new().keep_zeros();
            let pairs = if kind == Kind::Minimum { options.sublevel(&near, &density) } else { options.superlevel(&near, &density) };
            let pairs = pairs.expect("fits");
            let essential = pairs.essential().count();
            prop_assert_eq!(clusters.extrema().len(), count.max(essential).min(pairs.len()));
            // Essential classes are kept whatever their range; of the others the first ones.
            let mut finite = pairs.ranked();
            finite.retain(|pair| !pair.is_essential());
            let mut kept: Vec<usize> = finite.iter().take(count.saturating_sub(essential)).map(|pair| pair.extremum).collect();
            kept.extend(pairs.essential().map(|pair| pair.extremum));
            kept.sort_unstable();
            prop_assert_eq!(clusters.extrema(), &kept[..]);
            prop_assert_eq!(clusters.sizes().iter().sum::<usize>(), density.len());
        }
    }
}

#[test]
fn triangles_take_any_integers() {
    let expected = TriangleMesh::new(4, &[[0u32, 1, 2], [1, 3, 2]]).expect("corners exist");
    assert_eq!(TriangleMesh::new(4, &[(0usize, 1, 2), (1, 3, 2)]).as_ref(), Ok(&expected));
    assert_eq!(TriangleMesh::new(4, &[[0i64, 1, 2], [1, 3, 2]]).as_ref(), Ok(&expected));
    let error = TriangleMesh::new(4, &[[0, 1, -2]]).expect_err("no corner is negative");
    assert_eq!(error, Error::Triangle { triangle: 0, vertex: -2, vertices: 4 });
    assert_eq!(error.to_string(), "triangle 0 names vertex -2, but there are only 4, counted from 0");
}
