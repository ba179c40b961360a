//! What is made from the pairs, against what its definition says.

use crate::inputs::{field, graph};
use petgraph::graph::{NodeIndex, UnGraph};
use petgraph::unionfind::UnionFind;
use petgraph::visit::Walker;
use proptest::prelude::*;
use topo::{Connectivity, Diagram, Domain, Grid, Kind, LevelComponent, PersistenceOptions, Scalar};

fn graph_and_field() -> impl Strategy<Value = (UnGraph<(), ()>, Vec<f64>)> {
    graph(120).prop_flat_map(|graph| {
        let count = graph.node_count();
        (Just(graph), field(count))
    })
}

fn kind() -> impl Strategy<Value = Kind> {
    prop_oneof![Just(Kind::Minimum), Just(Kind::Maximum)]
}

/// A threshold; one that pairs meet exactly as often as not.
fn threshold() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..3.0f64, (0..3i32).prop_map(f64::from)]
}

/// The components of the vertices for which `holds`, as a sorted list of sizes.
fn component_sizes(graph: &UnGraph<(), ()>, holds: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut sets = UnionFind::new(graph.node_count());
    for (a, b) in graph.edge_indices().filter_map(|edge| graph.edge_endpoints(edge)) {
        if holds(a.index()) && holds(b.index()) {
            sets.union(a.index(), b.index());
        }
    }
    let mut sizes = vec![0; graph.node_count()];
    (0..graph.node_count()).filter(|&v| holds(v)).for_each(|v| sizes[sets.find_mut(v)] += 1);
    sizes.retain(|&size| size > 0);
    sizes.sort_unstable();
    sizes
}

fn sorted_sizes<V, S>(components: &[LevelComponent<V, S>]) -> Vec<usize> {
    let mut sizes: Vec<usize> = components.iter().map(|component| component.size).collect();
    sizes.sort_unstable();
    sizes
}

/// Centres and heights of eight hills round a higher ninth, which comes first (Fig. 3 of the paper on conformal factor
/// persistence), in a square of side 2.
fn hill_tops() -> Vec<([f64; 2], f64)> {
    let ring = (0..8).map(|k| (f64::from(k) * std::f64::consts::TAU / 8.0).sin_cos());
    [([0.0, 0.0], 2.0)].into_iter().chain(ring.map(|(sin, cos)| ([0.7 * sin, 0.7 * cos], 1.0))).collect()
}

/// Height of the hills at a place; they hardly overlap, so that their prominence is nearly their height.
fn hills(at: [f64; 2]) -> f64 {
    let bump =
        |([y, x], height): ([f64; 2], f64)| height * (-((at[0] - y).powi(2) + (at[1] - x).powi(2)) / 0.015).exp();
    hill_tops().into_iter().map(bump).sum()
}

/// How far apart two points of diagrams are, and how far one is from the diagonal; equal infinities are 0 apart.
fn step(p: (f64, f64), q: (f64, f64)) -> f64 {
    p.0.width(q.0).max(p.1.width(q.1))
}

fn to_diagonal((birth, death): (f64, f64)) -> f64 {
    birth.width(death) / 2.0
}

/// All ways to match the points of one diagram with those of another or the diagonal, by the norm of their steps.
fn best_matching(a: &[(f64, f64)], b: &[(f64, f64)], norm: &impl Fn(&[f64]) -> f64, steps: &mut Vec<f64>) -> f64 {
    let Some((&first, rest)) = a.split_first() else {
        let mut steps = steps.clone();
        steps.extend(b.iter().map(|&point| to_diagonal(point)));
        return norm(&steps);
    };
    steps.push(to_diagonal(first));
    let mut best = best_matching(rest, b, norm, steps);
    steps.pop();
    for (place, &partner) in b.iter().enumerate() {
        let mut others = b.to_vec();
        others.remove(place);
        steps.push(step(first, partner));
        best = best.min(best_matching(rest, &others, norm, steps));
        steps.pop();
    }
    best
}

/// The best of all matchings of whole diagrams. An essential class is as a point that dies at infinity.
fn best_of_all(a: &Diagram, b: &Diagram, norm: impl Fn(&[f64]) -> f64) -> f64 {
    let classes = |diagram: &Diagram| diagram.essential.iter().map(|&birth| (birth, f64::INFINITY)).collect::<Vec<_>>();
    norm(&[
        best_matching(&a.finite, &b.finite, &norm, &mut Vec::new()),
        best_matching(&classes(a), &classes(b), &norm, &mut Vec::new()),
    ])
}

fn longest(steps: &[f64]) -> f64 {
    steps.iter().copied().fold(0.0, f64::max)
}

fn sum(steps: &[f64]) -> f64 {
    steps.iter().sum()
}

/// The bottleneck distance by trying every length that a step can have, each with a matching found point by point.
fn shortest_that_matches(a: &[(f64, f64)], b: &[(f64, f64)]) -> f64 {
    // Point i goes to point j, to the diagonal, or the diagonal to point j.
    let cost = |i: usize, j: usize| match (a.get(i), b.get(j)) {
        (Some(&p), Some(&q)) => step(p, q),
        (Some(&p), None) | (None, Some(&p)) => to_diagonal(p),
        (None, None) => 0.0,
    };
    fn finds_place(
        i: usize,
        is_near: &impl Fn(usize, usize) -> bool,
        tried: &mut [bool],
        owner: &mut [Option<usize>],
    ) -> bool {
        for j in 0..owner.len() {
            if !tried[j] && is_near(i, j) {
                tried[j] = true;
                if owner[j].is_none_or(|other| finds_place(other, is_near, tried, owner)) {
                    owner[j] = Some(i);
                    return true;
                }
            }
        }
        false
    }
    let count = a.len() + b.len();
    let matches = |reach: f64| {
        let mut owner = vec![None; count];
        (0..count).all(|i| finds_place(i, &|i, j| cost(i, j) <= reach, &mut vec![false; count], &mut owner))
    };
    let mut lengths: Vec<f64> =
        (0..count).flat_map(|i| (0..count).map(move |j| (i, j))).map(|(i, j)| cost(i, j)).collect();
    lengths.push(0.0);
    lengths.sort_by(f64::total_cmp);
    lengths[lengths.partition_point(|&reach| !matches(reach))]
}

/// Points on a coarse raster, so that many steps are equally long.
fn diagram(max: usize) -> impl Strategy<Value = Diagram> {
    let point = (-4..=4i32, 0..=4i32).prop_map(|(birth, width)| (f64::from(birth), f64::from(birth + width)));
    proptest::collection::vec(point, 0..=max).prop_map(|finite| Diagram {
        kind: Kind::Minimum,
        finite,
        essential: vec![0.0],
    })
}

/// Points of which some are born or die at infinity, and any number of essential classes.
fn unbounded_diagram() -> impl Strategy<Value = Diagram> {
    let birth = prop_oneof![2 => (-3..=0i32).prop_map(f64::from), 1 => Just(f64::NEG_INFINITY)];
    let death = prop_oneof![2 => (1..=3i32).prop_map(f64::from), 1 => Just(f64::INFINITY)];
    let points = proptest::collection::vec((birth, death), 0..5);
    let essential = proptest::collection::vec((-3..=3i32).prop_map(f64::from), 1..3);
    (points, essential).prop_map(|(finite, essential)| Diagram { kind: Kind::Minimum, finite, essential })
}

proptest! {
    #[test]
    fn nine_hills_are_found_under_noise(noise in proptest::collection::vec(-0.2..0.2f64, 60 * 60)) {
        let place = |vertex: usize| [vertex / 60, vertex % 60].map(|at| (at as f64 + 0.5) / 30.0 - 1.0);
        let terrain: Vec<f64> = noise.iter().enumerate().map(|(vertex, noise)| hills(place(vertex)) + noise).collect();
        let maxima = topo::superlevel(&Grid::new([60, 60], Connectivity::Freudenthal), &terrain).expect("fits");
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let hill_of = |peak: usize| {
            hill_tops().iter().position(|&(top, _)| distance(top, place(peak)) < 0.2)
        };
        let mut found: Vec<_> = maxima.top(9).iter().map(|peak| hill_of(peak.extremum)).collect();
        prop_assert_eq!(found[0], Some(0));
        found.sort_unstable();
        prop_assert_eq!(found, (0..9).map(Some).collect::<Vec<_>>());
    }

    #[test]
    fn a_merge_tree_knows_the_components_at_every_level((graph, field) in graph_and_field(), kind in kind(), level in -3.5..3.5f64) {
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        for level in [level, level.round(), f64::INFINITY, f64::NEG_INFINITY] {
            let holds = |v: usize| if kind == Kind::Minimum { field[v] <= level } else { field[v] >= level };
            prop_assert_eq!(sorted_sizes(&tree.at(level)), component_sizes(&graph, holds));
        }
    }

    #[test]
    fn a_simplified_tree_keeps_the_persistent_branches((graph, field) in graph_and_field(), kind in kind(), threshold in threshold(), level in -3.5..3.5f64) {
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        let pairs = if kind == Kind::Minimum { topo::sublevel(&graph, &field) } else { topo::superlevel(&graph, &field) };
        let pairs = pairs.expect("fits");
        let simple = tree.simplify(threshold);
        let kept = pairs.finite().filter(|pair| pair.persistence() > threshold).count() + pairs.essential().count();
        prop_assert_eq!(simple.leaf_count(), kept);
        prop_assert_eq!(simple.simplify(threshold).nodes().len(), simple.nodes().len());
        // A component whose extremum goes is filled up from the saddle on; the others keep all their vertices.
        let is_kept = |extremum| pairs.essential().chain(pairs.above(threshold)).any(|pair| pair.extremum == extremum);
        for level in [level, level.round(), f64::INFINITY] {
            let components = tree.at(level).into_iter().filter(|component| is_kept(component.extremum));
            prop_assert_eq!(simple.at(level), components.collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_tree_has_every_extremum_saddle_and_last_vertex_once((graph, field) in graph_and_field(), kind in kind()) {
        let options = PersistenceOptions::new().keep_zeros();
        let pairs = if kind == Kind::Minimum { options.sublevel(&graph, &field) } else { options.superlevel(&graph, &field) };
        let pairs = pairs.expect("fits");
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        prop_assert!(tree.branches().iter().map(|branch| &branch.pair).eq(pairs.iter()));
        let is_before = |u: usize, v: usize| match kind {
            Kind::Minimum => field[u] < field[v] || field[u] == field[v] && u < v,
            Kind::Maximum => field[u] > field[v] || field[u] == field[v] && u > v,
        };
        let component = |v: usize| petgraph::visit::Dfs::new(&graph, NodeIndex::new(v)).iter(&graph).map(NodeIndex::index).collect::<Vec<_>>();
        let last = |v: usize| component(v).into_iter().reduce(|u, v| if is_before(u, v) { v } else { u }).expect("itself");
        let mut expected: Vec<usize> = pairs.iter().map(|pair| pair.extremum.index()).collect();
        expected.extend(pairs.iter().map(|pair| pair.saddle.map_or_else(|| last(pair.extremum.index()), NodeIndex::index)));
        expected.sort_unstable();
        expected.dedup();
        let mut nodes: Vec<usize> = tree.nodes().iter().map(|node| node.vertex.index()).collect();
        nodes.sort_unstable();
        prop_assert_eq!(nodes, expected);
    }

    #[test]
    fn arcs_lead_from_every_node_to_a_root((graph, field) in graph_and_field(), kind in kind()) {
        let tree = topo::merge_tree(&graph, &field, kind).expect("fits");
        let nodes = tree.nodes();
        for node in &nodes {
            let (mut at, mut steps) = (*node, 0);
            while let Some(parent) = at.parent {
                let rises = nodes[parent].value >= at.value;
                prop_assert!(rises == (kind == Kind::Minimum) || nodes[parent].value == at.value);
                (at, steps) = (nodes[parent], steps + 1);
                prop_assert!(steps < nodes.len());
            }
        }
        let roots = nodes.iter().filter(|node| node.parent.is_none()).count();
        prop_assert_eq!(roots, petgraph::algo::connected_components(&graph));
        prop_assert_eq!(tree.arcs().len() + roots, nodes.len());
        prop_assert!(tree.arcs().iter().all(|&[child, parent]| nodes[child].parent == Some(parent)));
    }

    #[test]
    fn a_parent_is_the_eldest_of_all_that_can_be_reached_by_the_saddle((graph, field) in graph_and_field(), kind in kind()) {
        let is_before = |u: usize, v: usize| match kind {
            Kind::Minimum => field[u] < field[v] || field[u] == field[v] && u < v,
            Kind::Maximum => field[u] > field[v] || field[u] == field[v] && u > v,
        };
        for branch in topo::merge_tree(&graph, &field, kind).expect("fits").branches() {
            let saddle = branch.pair.saddle.map(|saddle| saddle.index());
            let holds = |v: usize| saddle.is_none_or(|saddle| v == saddle || is_before(v, saddle));
            let mut sets = UnionFind::new(graph.node_count());
            for (a, b) in graph.edge_indices().filter_map(|edge| graph.edge_endpoints(edge)) {
                if holds(a.index()) && holds(b.index()) {
                    sets.union(a.index(), b.index());
                }
            }
            let own = branch.pair.extremum.index();
            let reached = (0..graph.node_count()).filter(|&v| sets.equiv(v, own));
            let eldest = reached.reduce(|u, v| if is_before(u, v) { u } else { v });
            prop_assert_eq!(branch.parent.map_or(own, |parent| parent.index()), eldest.expect("it reaches itself"));
        }
    }

    #[test]
    fn segments_are_connected_and_hold_their_extremum((graph, field) in graph_and_field(), kind in kind(), threshold in 0.0..3.0f64) {
        let segments = topo::segmentation(&graph, &field, kind, threshold).expect("fits");
        for (segment, extremum) in segments.extrema().iter().enumerate() {
            prop_assert_eq!(segments.label(extremum.index()), Some(segment));
            prop_assert_eq!(component_sizes(&graph, |v| segments.label(v) == Some(segment)), vec![segments.sizes()[segment]]);
        }
        prop_assert_eq!(segments.sizes().iter().sum::<usize>(), graph.node_count());
    }

    #[test]
    fn a_simplified_field_is_near_and_has_persistent_extrema_only((graph, field) in graph_and_field(), threshold in 0.0..4.0f64) {
        let simple = topo::simplify(&graph, &field, threshold).expect("fits");
        prop_assert!(field.iter().zip(&simple).all(|(&a, &b)| a.width(b) <= threshold));
        let left = topo::persistence(&graph, &simple).expect("fits");
        prop_assert!(left.minima.finite().chain(left.maxima.finite()).all(|pair| pair.persistence() > threshold));
        prop_assert_eq!(topo::simplify(&graph, &simple, threshold).expect("fits"), simple);
    }

    #[test]
    fn distances_are_those_of_the_best_of_all_matchings(a in diagram(4), b in diagram(4)) {
        prop_assert_eq!(a.bottleneck(&b).expect("alike"), best_of_all(&a, &b, longest));
        prop_assert_eq!(a.wasserstein(&b, 1.0).expect("alike"), best_of_all(&a, &b, sum));
        let squares = |steps: &[f64]| steps.iter().map(|step| step * step).sum::<f64>();
        let best = best_matching(&a.finite, &b.finite, &squares, &mut Vec::new());
        prop_assert!((a.wasserstein(&b, 2.0).expect("alike").powi(2) - best).abs() < 1e-12);
    }

    #[test]
    fn points_at_infinity_are_matched_as_well_as_they_can_be(a in unbounded_diagram(), b in unbounded_diagram(), shuffle in any::<prop::sample::Index>()) {
        prop_assert_eq!(a.bottleneck(&b).expect("alike"), best_of_all(&a, &b, longest));
        prop_assert_eq!(a.wasserstein(&b, 1.0).expect("alike"), best_of_all(&a, &b, sum));
        // The same points a step of 1 away, in another order.
        let mut moved = a.clone();
        moved.finite.iter_mut().for_each(|(birth, death)| (*birth, *death) = (*birth + 1.0, *death + 1.0));
        moved.finite.rotate_left(shuffle.index(a.finite.len().max(1)));
        prop_assert_eq!(a.bottleneck(&moved).expect("alike"), best_of_all(&a, &moved, longest));
        prop_assert_eq!(a.wasserstein(&moved, 1.0).expect("alike"), best_of_all(&a, &moved, sum));
    }

    #[test]
    fn the_bottleneck_of_many_points_is_the_shortest_step_that_matches_all(a in diagram(25), b in diagram(25)) {
        prop_assert_eq!(a.bottleneck(&b).expect("alike"), shortest_that_matches(&a.finite, &b.finite));
    }

    #[test]
    fn curves_count_what_they_say(diagram in unbounded_diagram(), plateaus in 0..3usize, unit in prop_oneof![Just(1.0), Just(1e-9)]) {
        let mut diagram = diagram;
        diagram.finite.iter_mut().for_each(|(birth, death)| (*birth, *death) = (*birth * unit, *death * unit));
        diagram.finite.extend(vec![(0.5, 0.5); plateaus]);
        let longer = |than: f64| diagram.finite.iter().filter(|(birth, death)| birth.width(*death) > than).count();
        let curve = diagram.persistence_curve();
        prop_assert_eq!(curve[0].0, 0.0);
        prop_assert!(curve.windows(2).all(|step| step[0].0 < step[1].0 && step[0].1 > step[1].1));
        prop_assert!(curve.iter().all(|&(threshold, count)| count == longer(threshold)));
        prop_assert_eq!(curve.last().map(|last| last.1), Some(0));
        let alive = |level: f64| {
            let births = diagram.finite.iter().map(|point| point.0).chain(diagram.essential.iter().copied());
            births.filter(|&birth| birth <= level).count() - diagram.finite.iter().filter(|point| point.1 <= level).count()
        };
        prop_assert!(diagram.betti_curve().iter().all(|&(level, count)| count == alive(level)));
    }

    #[test]
    fn distances_are_metrics(a in diagram(12), b in diagram(12), c in diagram(12)) {
        for order in [f64::INFINITY, 2.0] {
            let distance = |a: &Diagram, b: &Diagram| a.wasserstein(b, order).expect("alike");
            prop_assert_eq!(distance(&a, &a), 0.0);
            prop_assert!((distance(&a, &b) - distance(&b, &a)).abs() <= 1e-12);
            prop_assert!(distance(&a, &c) <= distance(&a, &b) + distance(&b, &c) + 1e-12);
        }
    }
}

#[test]
fn masked_vertices_have_no_segment() {
    let path = topo::Path::new(3);
    let options = topo::PersistenceOptions::new().nan(topo::NanPolicy::Mask);
    let segments = options.segmentation(&path, &[1.0, f64::NAN, 2.0], Kind::Minimum, 9.0).expect("fits");
    assert_eq!(segments.labels().collect::<Vec<_>>(), [Some(0), None, Some(1)]);
    assert_eq!((&path).vertex_count(), segments.labels().len());
}

#[test]
fn a_basin_spills_to_where_its_saddle_drains_if_that_is_elder() {
    // Four basins meet at vertex 0, which drains into that of vertex 6 by way of vertex 5.
    let meeting = UnGraph::<(), ()>::from_edges([(0, 1), (1, 2), (0, 3), (3, 4), (0, 5), (5, 6), (0, 7)]);
    let field = [9.0, 8.0, 1.0, 7.0, 3.0, 4.0, 2.0, 5.0];
    let segments = topo::segmentation(&meeting, &field, Kind::Minimum, 4.0).expect("fits");
    assert_eq!(segments.extrema().iter().map(|v| v.index()).collect::<Vec<_>>(), [2, 4, 6]);
    assert_eq!(segments.sizes(), [2, 2, 4]);
}

#[test]
fn three_basins_that_meet_at_a_monkey_saddle_become_one() {
    let star = UnGraph::<(), ()>::from_edges([(0, 1), (0, 2), (0, 3)]);
    let segments = topo::segmentation(&star, &[9.0, 3.0, 2.0, 1.0], Kind::Minimum, 8.0).expect("fits");
    assert_eq!(segments.sizes(), [4]);
    assert_eq!(topo::sublevel(&star, &[9.0, 3.0, 2.0, 1.0]).expect("fits").finite().count(), 2);
}
