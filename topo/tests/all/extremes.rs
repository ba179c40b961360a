//! Inputs at the edge of what is allowed, and beyond: nothing panics, nothing overflows, errors name what is wrong.

use petgraph::graph::UnGraph;
use std::fmt::Debug;
use topo::{
    Adjacency, Connectivity, Domain, Error, Grid, Kind, NanPolicy, Path, Persistence, PersistenceOptions, Scalar,
    TriangleMesh,
};

fn persistence<G: Domain<Vertex = usize>, S: Scalar>(domain: G, field: &[S]) -> Persistence<usize, S> {
    topo::persistence(domain, field).expect("the field fits")
}

/// Asks everything there is to ask of a field; the answers must agree with each other.
fn ask_everything<G, S>(domain: G, field: &[S], threshold: S::Width)
where
    G: Domain<Vertex: PartialEq + Debug>,
    S: Scalar,
{
    let masked = PersistenceOptions::new().keep_zeros().nan(NanPolicy::Mask);
    let persistence = masked.persistence(domain, field).expect("the field fits");
    assert_eq!(persistence, masked.plain_sweep().persistence(domain, field).expect("the field fits"));
    let refused = PersistenceOptions::new().keep_zeros().persistence(domain, field);
    match field.iter().position(|value| value.is_nan()) {
        Some(vertex) => assert_eq!(refused, Err(Error::NotANumber { vertex })),
        None => assert_eq!(refused.as_ref(), Ok(&persistence)),
    }
    let hierarchy = persistence.hierarchy();
    assert_eq!(hierarchy.alternating(usize::MAX).count(), hierarchy.extrema().len());
    let entering = field.iter().filter(|value| !value.is_nan()).count();
    for pairs in [&persistence.minima, &persistence.maxima] {
        let diagram = pairs.diagram();
        assert_eq!(
            (diagram.finite.len(), diagram.essential.len()),
            (pairs.finite().count(), pairs.essential().count())
        );
        assert_eq!(diagram.betti_curve().last().map_or(0, |last| last.1), pairs.essential().count());
        assert_eq!(diagram.persistence_curve().last().map(|last| last.1), Some(0));
        if pairs.len() < 50 {
            assert_eq!(diagram.bottleneck(&diagram), Ok(0.0));
            // Sums of squares do not see steps of less than the root of a rounding of the longest.
            let finite = diagram.finite.iter().flat_map(|&(birth, death)| [birth, death]).filter(|x| x.is_finite());
            let largest = finite.fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!(diagram.wasserstein(&diagram, 2.0).is_ok_and(|distance| distance <= 1e-7 * largest));
        }
        let tree = masked.merge_tree(domain, field, pairs.kind()).expect("the field fits");
        assert!(tree.branches().iter().map(|branch| &branch.pair).eq(pairs.iter()));
        assert_eq!(tree.nodes().len(), tree.arcs().len() + pairs.essential().count());
        let last = pairs.iter().find_map(|pair| pair.death()).or(field.first().copied());
        let components = last.map_or(vec![], |level| tree.at(level));
        assert!(components.len() <= pairs.len() && components.iter().map(|part| part.size).sum::<usize>() <= entering);
        let kept = pairs.finite().filter(|pair| pair.persistence() > threshold).count() + pairs.essential().count();
        assert_eq!(tree.simplify(threshold).leaf_count(), kept);
        let segments = masked.segmentation(domain, field, pairs.kind(), threshold).expect("the field fits");
        assert_eq!((segments.extrema().len(), segments.sizes().iter().sum::<usize>()), (kept, entering));
    }
    let simple = masked.simplify(domain, field, threshold).expect("the field fits");
    assert!(field.iter().zip(&simple).all(|(&a, &b)| a.is_nan() && b.is_nan() || a.width(b) <= threshold));
}

/// Asks everything about a field on all kinds of domains that have as many vertices.
fn ask_on_all_domains<S: Scalar>(field: &[S], threshold: S::Width) {
    let n = field.len();
    ask_everything(&Path::new(n), field, threshold);
    for connectivity in [Connectivity::Axis, Connectivity::Full, Connectivity::Freudenthal] {
        for ring in [false, true] {
            ask_everything(&Grid::new([n], connectivity).periodic([ring]), field, threshold);
            for rows in [1, 2, n / 2, n].into_iter().filter(|&rows| rows > 0 && n.is_multiple_of(rows)) {
                ask_everything(&Grid::new([rows, n / rows], connectivity).periodic([ring, false]), field, threshold);
                ask_everything(&Grid::new([1, n / rows, rows], connectivity).periodic([ring; 3]), field, threshold);
            }
        }
    }
    let strip: Vec<[u32; 3]> = (2..n as u32).map(|v| [v - 2, v - 1, v]).collect();
    let twisted: Vec<[u32; 3]> =
        strip.iter().chain(&strip).map(|&[a, b, c]| [b, a, c]).chain(strip.first().map(|t| [t[0]; 3])).collect();
    for triangles in [vec![], strip, twisted] {
        ask_everything(&TriangleMesh::new(n, &triangles).expect("corners exist"), field, threshold);
    }
    let path: Vec<[usize; 2]> = (1..n).map(|v| [v - 1, v]).collect();
    let star: Vec<[usize; 2]> = (1..n).map(|v| [0, v]).collect();
    let doubled: Vec<[usize; 2]> = path.iter().flat_map(|&[a, b]| [[a, b], [b, a], [a, a]]).collect();
    for edges in [vec![], path, star, doubled] {
        ask_everything(&Adjacency::from_edges(n, &edges).expect("ends exist"), field, threshold);
        let mut graph = UnGraph::<(), ()>::from_edges(edges.iter().map(|edge| (edge[0] as u32, edge[1] as u32)));
        while graph.node_count() < n {
            graph.add_node(());
        }
        ask_everything(&graph, field, threshold);
    }
}

#[test]
fn extreme_fields_are_answered_on_every_domain() {
    let alternating = |a: f64, b: f64| (0..24).map(|i| if i % 2 == 0 { a } else { b }).collect::<Vec<_>>();
    let (infinity, nan) = (f64::INFINITY, f64::NAN);
    let floats = [
        vec![],
        vec![7.0],
        vec![nan],
        vec![infinity],
        vec![3.0; 24],
        vec![-infinity; 24],
        vec![nan; 24],
        alternating(infinity, -infinity),
        alternating(0.0, -0.0),
        alternating(f64::MAX, f64::MIN),
        alternating(nan, infinity),
        alternating(infinity, -infinity).iter().enumerate().map(|(i, &x)| if i % 5 == 0 { nan } else { x }).collect(),
    ];
    for field in floats {
        [0.0, 1.0, infinity].into_iter().for_each(|threshold| ask_on_all_domains(&field, threshold));
        let single: Vec<f32> = field.iter().map(|&x| x as f32).collect();
        ask_on_all_domains(&single, 1.0);
    }
    let bytes: Vec<i8> = (0..256).map(|i| (i * 77 % 256 - 128) as i8).collect();
    [0, 1, 127, 255].into_iter().for_each(|threshold| ask_on_all_domains(&bytes, threshold));
    let large: Vec<u64> = (0..24).map(|i| if i % 4 == 0 { u64::MAX - i } else { (1 << 53) + i * 7 % 5 }).collect();
    [0, 1, u64::MAX].into_iter().for_each(|threshold| ask_on_all_domains(&large, threshold));
}

#[test]
fn integers_above_two_to_the_53rd_are_told_apart() {
    let field = [1 << 53, (1 << 53) + 2, (1 << 53) + 1, u64::MAX];
    let minima = persistence(&Path::new(4), &field).minima.ranked();
    assert_eq!((minima[0].persistence(), minima[1].persistence()), (u64::MAX - (1 << 53), 1));
}

#[test]
fn an_empty_domain_has_no_pairs() {
    let empty: [f64; 0] = [];
    assert!(persistence(&Path::new(0), &empty).minima.is_empty());
    assert!(persistence(&Adjacency::from_edges(0, &[[0u8; 2]; 0]).expect("no edges"), &empty).maxima.is_empty());
    assert!(persistence(&TriangleMesh::new(0, &[[0u32; 3]; 0]).expect("no corners"), &empty).maxima.is_empty());
    assert_eq!(persistence(&Path::new(0), &empty).hierarchy().alternating(3).count(), 0);
}

#[test]
fn a_single_vertex_lives_for_ever_and_has_no_range() {
    let persistence = persistence(&Path::new(1), &[7.0]);
    assert_eq!((persistence.minima[0].saddle, persistence.minima[0].persistence()), (None, 0.0));
}

#[test]
fn a_constant_field_has_one_extremum_of_each_kind() {
    let constant = persistence(&Grid::new([9, 9], Connectivity::Full), &[0u8; 81]);
    assert_eq!((constant.minima.len(), constant.minima.zero_count()), (1, 0));
    assert_eq!((constant.minima[0].extremum, constant.maxima[0].extremum), (0, 80));
}

#[test]
fn infinities_are_values() {
    let field: Vec<f64> = (0..101).map(|i| if i % 2 == 0 { f64::INFINITY } else { f64::NEG_INFINITY }).collect();
    let alternating = persistence(&Path::new(101), &field);
    assert_eq!(alternating.minima.len(), 50);
    assert!(alternating.minima.iter().all(|pair| pair.persistence() == f64::INFINITY));
}

#[test]
fn nan_is_refused_with_its_vertex_or_masked() {
    let path = Path::new(3);
    assert_eq!(topo::sublevel(&path, &[0.0, f64::NAN, 0.0]), Err(Error::NotANumber { vertex: 1 }));
    let all_masked = PersistenceOptions::new().nan(NanPolicy::Mask).persistence(&path, &[f64::NAN; 3]).expect("masked");
    assert!(all_masked.minima.is_empty() && all_masked.maxima.is_empty());
}

#[test]
fn a_field_of_the_wrong_length_is_refused() {
    let error = topo::sublevel(&Path::new(3), &[0.0; 2]).expect_err("too short");
    assert_eq!(error.to_string(), "the field has 2 values for 3 vertices; it needs one for each");
}

#[test]
fn zeros_of_both_signs_are_equal() {
    let pairs = PersistenceOptions::new().keep_zeros().sublevel(&Path::new(3), &[0.0, 1.0, -0.0]).expect("fits");
    assert_eq!((pairs[0].extremum, pairs[0].is_essential()), (0, true));
}

#[test]
fn integers_may_use_their_whole_range() {
    let bytes = persistence(&Path::new(3), &[i8::MIN, i8::MAX, i8::MIN]);
    assert!(bytes.minima.iter().all(|pair| pair.persistence() == 255));
    let large = [u64::MAX, u64::MAX - 1, u64::MAX];
    assert_eq!(persistence(&Path::new(3), &large).maxima.ranked()[1].persistence(), 1);
}

#[test]
fn a_million_isolated_vertices_are_as_many_components() {
    let field: Vec<u32> = (0..1_000_000).collect();
    let isolated = Adjacency::from_edges(field.len(), &[[0usize; 2]; 0]).expect("no edges");
    assert_eq!(persistence(&isolated, &field).minima.essential().count(), field.len());
    ask_everything(&isolated, &field, 10);
}

#[test]
fn a_star_pairs_all_its_leaves_at_the_centre() {
    const LEAVES: usize = 1_000_000;
    let edges: Vec<_> = (1..=LEAVES).map(|leaf| [0, leaf]).collect();
    let star = Adjacency::from_edges(LEAVES + 1, &edges).expect("ends exist");
    let mut field: Vec<i64> = (0..=LEAVES as i64).map(|i| i * 7919 % 1_000_003).collect();
    field[0] = 2_000_000;
    let minima = persistence(&star, &field).minima;
    assert_eq!(minima.finite().filter(|pair| pair.saddle == Some(0)).count(), LEAVES - 1);
    ask_everything(&star, &field, 1_500_000);
    let graph = UnGraph::<(), ()>::from_edges((1..=LEAVES as u32).map(|leaf| (0, leaf)));
    let segments = topo::segmentation(&graph, &field, Kind::Minimum, u64::MAX).expect("fits");
    assert_eq!(segments.sizes(), [LEAVES + 1]);
}

#[test]
fn long_ways_down_are_no_trouble() {
    const LENGTH: usize = 10_000_000;
    let tent: Vec<f32> = (0..LENGTH).map(|i| i.min(LENGTH - i) as f32).collect();
    let by_stack = persistence(&Path::new(LENGTH), &tent);
    assert_eq!(by_stack.minima.len(), 2);
    assert_eq!(by_stack, persistence(&Grid::new([LENGTH], Connectivity::Axis), &tent));
    let edges: Vec<[usize; 2]> = (1..LENGTH).map(|v| [v - 1, v]).collect();
    let listed = Adjacency::from_edges(LENGTH, &edges).expect("ends exist");
    drop(edges);
    ask_everything(&listed, &tent, 9.0);
    drop(listed);
    let graph = UnGraph::<(), ()>::from_edges((1..LENGTH as u32).map(|v| (v - 1, v)));
    let of_graph = topo::sublevel(&graph, &tent).expect("fits");
    assert!(of_graph.iter().map(|pair| pair.extremum.index()).eq(by_stack.minima.iter().map(|pair| pair.extremum)));
}

#[test]
fn a_thin_grid_is_scanned_along_its_length() {
    let field: Vec<i32> = (0..90_000).map(|i| i * 7919 % 1013).collect();
    let column = persistence(&Grid::new([90_000, 1], Connectivity::Full), &field);
    assert_eq!(column, persistence(&Path::new(90_000), &field));
}
