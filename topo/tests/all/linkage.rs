//! Single linkage against what its definition says; diagrams as vectors.

use petgraph::unionfind::UnionFind;
use proptest::prelude::*;
use topo::{Diagram, Error, Kind};

fn graph() -> impl Strategy<Value = (usize, Vec<(usize, usize, i8)>)> {
    (1..25usize).prop_flat_map(|n| (Just(n), proptest::collection::vec((0..n, 0..n, -3..9i8), 0..60)))
}

proptest! {
    #[test]
    fn clusters_are_the_parts_joined_by_light_edges((n, edges) in graph(), weight in -4..10i8) {
        let dendrogram = topo::single_linkage(n, &edges).expect("ends exist");
        let mut parts = UnionFind::<usize>::new(n);
        for &(a, b, _) in edges.iter().filter(|edge| edge.2 <= weight) {
            parts.union(a, b);
        }
        let labels = dendrogram.at(weight);
        for u in 0..n {
            for v in 0..u {
                prop_assert_eq!(labels[u] == labels[v], parts.equiv(u, v));
            }
        }
    }

    #[test]
    fn links_are_a_minimum_spanning_forest((n, edges) in graph()) {
        let dendrogram = topo::single_linkage(n, &edges).expect("ends exist");
        let links = dendrogram.links();
        prop_assert!(links.is_sorted_by_key(|link| link.weight));
        let mut sizes = vec![1; n];
        for (link, number) in links.iter().zip(n..) {
            prop_assert!(link.clusters[0] < link.clusters[1] && link.clusters[1] < number);
            prop_assert_eq!(edges[link.edge].2, link.weight);
            sizes.push(link.clusters.iter().map(|&cluster| sizes[cluster]).sum::<usize>());
            prop_assert_eq!(sizes[number], link.size);
        }
        for count in 1..=n {
            let mut labels = dendrogram.clusters(count);
            prop_assert_eq!(labels[0], 0);
            labels.sort_unstable();
            labels.dedup();
            prop_assert_eq!(labels.len(), count.max(n - links.len()));
        }
    }
}

#[test]
fn edges_that_cannot_be_are_named() {
    assert_eq!(topo::single_linkage(2, &[(0, 2, 1.0)]), Err(Error::Edge { edge: 0, vertex: 2, vertices: 2 }));
    assert_eq!(topo::single_linkage(2, &[(0, 1, 1.0), (0, 1, f64::NAN)]), Err(Error::Weight { edge: 1 }));
    assert!(topo::single_linkage::<usize, f64>(0, &[]).is_ok_and(|dendrogram| dendrogram.at(0.0).is_empty()));
}

#[test]
fn vectors_of_a_diagram_are_as_defined() {
    let points = vec![(0.0, 4.0), (1.0, 5.0), (2.0, 2.0), (f64::NEG_INFINITY, 1.0)];
    let diagram = Diagram { kind: Kind::Minimum, finite: points, essential: vec![-1.0] };
    assert!((diagram.entropy() - 2f64.ln()).abs() < 1e-15);
    assert_eq!(diagram.landscape(3, &[2.0, 4.5]), [2.0, 0.5, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(diagram.silhouette(1.0, &[2.0, 4.5, 9.0]), [1.5, 0.25, 0.0]);
    let image = diagram.image(0.0..=1.0, 4.0..=4.0, [1, 2], 1.0);
    let expected = 4.0 / std::f64::consts::TAU * (1.0 + (-0.5f64).exp());
    assert!(image.iter().all(|pixel| (pixel - expected).abs() < 1e-12));
    // Births are births, also of maxima, which die lower down.
    let of_maxima = Diagram { kind: Kind::Maximum, finite: vec![(3.0, 1.0)], essential: vec![] };
    let image = of_maxima.image(0.0..=4.0, 2.0..=2.0, [1, 5], 0.5);
    let largest = (0..5).max_by(|&a, &b| image[a].total_cmp(&image[b]));
    assert_eq!(largest, Some(3));
    // Far enough round, the image has the sum of the lifetimes.
    let whole: f64 = diagram.image(-9.0..=11.0, -6.0..=14.0, [201, 201], 1.0).iter().sum();
    assert!((whole * 0.01 - 8.0).abs() < 1e-6);
    let none = Diagram { finite: vec![], ..diagram };
    assert!(none.entropy().is_sign_positive());
    assert_eq!((none.entropy(), none.silhouette(1.0, &[0.0])), (0.0, vec![0.0]));
    assert!(none.image(0.0..=1.0, 0.0..=1.0, [0, 0], 1.0).is_empty());
}
