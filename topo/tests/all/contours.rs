//! Contour trees against contours counted and followed from level to level.

use crate::inputs::field;
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use topo::{Adjacency, Connectivity, ContourTree, Domain, Grid, NanPolicy, PersistenceOptions};

/// An arc by its end vertices, with the regular vertices on it.
type Arcs = BTreeSet<(usize, usize, BTreeSet<usize>)>;

/// The edges of the contour tree of all vertices, by vertices: between any two levels contours are the components of the
/// edges that cross, of which two are neighbours if they are in a triangle. Each vertex ends those that touch it from below and
/// begins those that touch it from above.
fn edges_by_brute_force(n: usize, edges: &BTreeSet<[usize; 2]>, field: &[f64]) -> Vec<[usize; 2]> {
    let mut order: Vec<usize> = (0..n).filter(|&v| !field[v].is_nan()).collect();
    order.sort_by(|&a, &b| field[a].partial_cmp(&field[b]).expect("no NaN").then(a.cmp(&b)));
    let mut rank = vec![None; n];
    order.iter().enumerate().for_each(|(place, &v)| rank[v] = Some(place));
    let ranked = |&[a, b]: &[usize; 2]| Some([rank[a]?.min(rank[b]?), rank[a]?.max(rank[b]?)]);
    let edges: BTreeSet<[usize; 2]> = edges.iter().filter_map(ranked).collect();
    let has = |a: usize, b: usize| edges.contains(&[a.min(b), a.max(b)]);
    let mut tree = Vec::new();
    // For each crossing edge the vertex at which its contour began.
    let mut began: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    for v in 0..order.len() {
        let ending: BTreeSet<usize> = began.iter().filter(|(edge, _)| edge[1] == v).map(|(_, &at)| at).collect();
        let touched = contours(&began.keys().copied().collect::<Vec<_>>(), has);
        let touched = touched.into_iter().filter(|contour| contour.iter().any(|edge| edge[1] == v));
        touched.for_each(|contour| tree.push([order[began[&contour[0]]], order[v]]));
        assert!(ending.iter().all(|&at| at < v));
        let crossing: Vec<[usize; 2]> = edges.iter().filter(|edge| edge[0] <= v && edge[1] > v).copied().collect();
        let mut next = BTreeMap::new();
        for contour in contours(&crossing, has) {
            let starts_here = contour.iter().any(|edge| edge[0] == v);
            let at = if starts_here { v } else { began[&contour[0]] };
            next.extend(contour.into_iter().map(|edge| (edge, at)));
        }
        began = next;
    }
    tree
}

/// Crossing edges in components. Two with a common end are in a triangle if their other ends are joined.
fn contours(crossing: &[[usize; 2]], has: impl Fn(usize, usize) -> bool) -> Vec<Vec<[usize; 2]>> {
    let mut left: Vec<[usize; 2]> = crossing.to_vec();
    let mut found = Vec::new();
    while let Some(first) = left.pop() {
        let mut contour = vec![first];
        let mut place = 0;
        while place < contour.len() {
            let [a, b] = contour[place];
            let is_beside = |&[c, d]: &[usize; 2]| a == c && has(b, d) || b == d && has(a, c);
            let (beside, others) = left.iter().partition::<Vec<_>, _>(|edge| is_beside(edge));
            contour.extend(beside);
            left = others;
            place += 1;
        }
        found.push(contour);
    }
    found
}

/// The arcs between nodes that are not regular.
fn arcs(n: usize, edges: &[[usize; 2]]) -> Arcs {
    let (mut down, mut up) = (vec![Vec::new(); n], vec![Vec::new(); n]);
    for &[lower, upper] in edges {
        up[lower].push(upper);
        down[upper].push(lower);
    }
    let is_regular = |v: usize| down[v].len() == 1 && up[v].len() == 1;
    let mut arcs = Arcs::new();
    for v in (0..n).filter(|&v| !is_regular(v)) {
        for &next in &up[v] {
            let (mut at, mut on) = (next, BTreeSet::new());
            while is_regular(at) {
                on.insert(at);
                at = up[at][0];
            }
            arcs.insert((v, at, on));
        }
    }
    arcs
}

fn arcs_of(tree: &ContourTree<usize, f64>) -> Arcs {
    let node = |node: usize| tree.nodes()[node].vertex;
    let nodes: BTreeSet<usize> = tree.nodes().iter().map(|node| node.vertex).collect();
    let on = |arc: usize| tree.labels().enumerate().filter(move |&(_, label)| label == Some(arc)).map(|(v, _)| v);
    let arcs = tree.arcs().iter().enumerate();
    arcs.map(|(k, arc)| (node(arc.lower), node(arc.upper), on(k).filter(|v| !nodes.contains(v)).collect())).collect()
}

fn edges_of<G: Domain>(domain: G) -> BTreeSet<[usize; 2]> {
    let mut edges = BTreeSet::new();
    for v in 0..domain.vertex_count() {
        domain.for_each_neighbor(v, |u| edges.extend([[u.min(v), u.max(v)]]));
    }
    edges.retain(|[a, b]| a != b);
    edges
}

fn check<G: Domain<Vertex = usize>>(domain: G, field: &[f64]) {
    let tree = PersistenceOptions::new().nan(NanPolicy::Mask).contour_tree(domain, field).expect("it fits");
    let n = domain.vertex_count();
    assert_eq!(arcs_of(&tree), arcs(n, &edges_by_brute_force(n, &edges_of(domain), field)));
    check_tree(&tree, field);
    check_pairs(domain, field, &tree);
    check_contours(domain, field, &tree);
    let mut thresholds: Vec<f64> = (0..5).map(f64::from).collect();
    thresholds.push(f64::INFINITY);
    for threshold in thresholds {
        let simple = tree.simplify(threshold);
        check_tree(&simple, field);
        assert_eq!(arcs_of(&simple), pruned_slowly(&tree, threshold));
        let (mut below, mut above) = (vec![0; simple.nodes().len()], vec![0; simple.nodes().len()]);
        simple
            .arcs()
            .iter()
            .for_each(|arc| (below[arc.upper], above[arc.lower]) = (below[arc.upper] + 1, above[arc.lower] + 1));
        for arc in simple.arcs() {
            let [low, high] = [arc.lower, arc.upper].map(|node| simple.nodes()[node].value);
            let has = |node: usize, arcs: (i32, i32)| (below[node], above[node]) == arcs;
            let is_leaf =
                has(arc.upper, (1, 0)) && above[arc.lower] > 1 || has(arc.lower, (0, 1)) && below[arc.upper] > 1;
            assert!(!is_leaf || low != high && high - low > threshold);
        }
        assert!((0..below.len()).all(|node| (below[node], above[node]) != (1, 1)));
    }
    let roots = tree.nodes().len() - tree.arcs().len();
    let alone = (0..n).filter(|&v| !field[v].is_nan() && tree.label(v).is_none()).count();
    assert_eq!(tree.simplify(f64::INFINITY).arcs().len(), roots - alone);
}

/// The pairs of a field, without those of no persistence, are those of its contour tree as a graph.
fn check_pairs<G: Domain<Vertex = usize>>(domain: G, field: &[f64], tree: &ContourTree<usize, f64>) {
    let edges: Vec<[usize; 2]> = tree.arcs().iter().map(|arc| [arc.lower, arc.upper]).collect();
    let graph = Adjacency::from_edges(tree.nodes().len(), &edges).expect("ends exist");
    let values: Vec<f64> = tree.nodes().iter().map(|node| node.value).collect();
    let vertex = |node: usize| tree.nodes()[node].vertex;
    let options = PersistenceOptions::new().nan(NanPolicy::Mask);
    let (of_field, of_tree) = (options.persistence(domain, field), options.persistence(&graph, &values));
    let (of_field, of_tree) = (of_field.expect("it fits"), of_tree.expect("it fits"));
    for (of_field, of_tree) in [(of_field.minima, of_tree.minima), (of_field.maxima, of_tree.maxima)] {
        let of_field: BTreeSet<_> = of_field.iter().map(|pair| (pair.extremum, pair.saddle)).collect();
        let of_tree: BTreeSet<_> =
            of_tree.iter().map(|pair| (vertex(pair.extremum), pair.saddle.map(vertex))).collect();
        assert_eq!(of_tree, of_field);
    }
}

/// Contours are counted as components of the edges that cross a level.
fn check_contours<G: Domain<Vertex = usize>>(domain: G, field: &[f64], tree: &ContourTree<usize, f64>) {
    let edges = edges_of(domain);
    let has = |a: usize, b: usize| edges.contains(&[a.min(b), a.max(b)]);
    for level in [-2.0, -0.5, 0.0, 1.0] {
        let crosses = |&[a, b]: &[usize; 2]| field[a] <= level && field[b] > level;
        let crossing: Vec<[usize; 2]> = edges.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).filter(crosses).collect();
        assert_eq!(tree.contours_at(level), contours(&crossing, has).len());
    }
}

/// A tree pruned as the definition says: all leaves are looked at for the lowest, again and again. An arc is its ends with the vertices
/// on it; what is pruned stays at the side of the inner node and goes with it, or to the longest arc there in the end.
fn pruned_slowly(tree: &ContourTree<usize, f64>, threshold: f64) -> Arcs {
    let (vertex, value) = (|node: usize| tree.nodes()[node].vertex, |node: usize| tree.nodes()[node].value);
    let height = |&(low, high): &(usize, usize)| if value(low) == value(high) { 0.0 } else { value(high) - value(low) };
    let number = |of: usize| tree.nodes().iter().position(|node| node.vertex == of).expect("arcs end at nodes");
    let all = arcs_of(tree).into_iter().map(|(low, high, on)| ((number(low), number(high)), on));
    let mut arcs: BTreeMap<(usize, usize), BTreeSet<usize>> = all.collect();
    let mut given: BTreeMap<(usize, bool), BTreeSet<usize>> = BTreeMap::new();
    loop {
        let of = |node: usize, is_above: bool| {
            let arcs = arcs.keys().filter(move |arc| node == if is_above { arc.0 } else { arc.1 });
            arcs.copied().collect::<Vec<_>>()
        };
        let upper = arcs.keys().filter(|arc| of(arc.1, true).is_empty() && of(arc.1, false).len() == 1);
        let upper = upper.filter(|arc| of(arc.0, true).len() > 1).map(|&arc| (arc, arc.1, arc.0, true));
        let lower = arcs.keys().filter(|arc| of(arc.0, false).is_empty() && of(arc.0, true).len() == 1);
        let lower = lower.filter(|arc| of(arc.1, false).len() > 1).map(|&arc| (arc, arc.0, arc.1, false));
        let leaves = upper.chain(lower).filter(|(arc, ..)| height(arc) <= threshold);
        let lowest = leaves.min_by(|a, b| height(&a.0).total_cmp(&height(&b.0)).then(a.1.cmp(&b.1)));
        let Some((arc, leaf, inner, is_above)) = lowest else { break };
        let mut take = |node: usize| {
            let at = [false, true].into_iter().flat_map(|side| given.remove(&(node, side)).unwrap_or_default());
            at.chain([vertex(node)]).collect::<BTreeSet<usize>>()
        };
        let mut gone = take(leaf);
        gone.extend(arcs.remove(&arc).expect("it is there"));
        given.entry((inner, is_above)).or_default().extend(gone);
        let of = |node: usize| arcs.keys().filter(|arc| arc.0 == node || arc.1 == node).copied().collect::<Vec<_>>();
        let around = of(inner);
        if let [one, other] = around[..] {
            let ends = (one.0.min(other.0), one.1.max(other.1));
            if ends.0 < inner && inner < ends.1 {
                let mut on: BTreeSet<usize> =
                    around.iter().flat_map(|arc| arcs.remove(arc).expect("it is there")).collect();
                for side in [false, true] {
                    on.extend(given.remove(&(inner, side)).unwrap_or_default());
                }
                on.insert(vertex(inner));
                arcs.insert(ends, on);
            }
        }
    }
    for ((node, is_above), on) in given {
        let beside = arcs.keys().filter(|arc| node == if is_above { arc.0 } else { arc.1 }).copied();
        let longest = beside.reduce(|a, b| if height(&b) > height(&a) { b } else { a }).expect("one is left");
        arcs.get_mut(&longest).expect("it is there").extend(on);
    }
    arcs.into_iter().map(|((low, high), on)| (vertex(low), vertex(high), on)).collect()
}

/// Arcs rise, nodes rise, each vertex that enters and is not alone lies on an arc.
fn check_tree(tree: &ContourTree<usize, f64>, field: &[f64]) {
    assert!(tree.arcs().iter().all(|arc| arc.lower < arc.upper));
    assert!(tree.arcs().is_sorted_by_key(|arc| arc.lower));
    assert!(tree.nodes().is_sorted_by(|a, b| (a.value, a.vertex) < (b.value, b.vertex)));
    assert!(tree.labels().zip(field).all(|(label, value)| label.is_none() || !value.is_nan()));
    for (place, node) in tree.nodes().iter().enumerate() {
        let ends_here = |arc: usize| [tree.arcs()[arc].lower, tree.arcs()[arc].upper].contains(&place);
        assert!(tree.label(node.vertex).is_none_or(ends_here));
    }
    assert_eq!(tree.sizes().iter().sum::<usize>(), tree.labels().flatten().count());
}

/// Simply connected graphs: each new vertex hangs from an older one, or from both ends of an edge.
fn hanging() -> impl Strategy<Value = (Vec<[usize; 2]>, usize)> {
    proptest::collection::vec((any::<prop::sample::Index>(), 0..6u8), 1..30).prop_map(|hung| {
        let mut edges: Vec<[usize; 2]> = Vec::new();
        for (v, (at, how)) in hung.iter().enumerate().skip(1) {
            match how {
                0 => {}
                1..=3 if !edges.is_empty() => {
                    let [a, b] = *at.get(&edges);
                    edges.extend([[a, v], [b, v]]);
                }
                _ => edges.push([at.index(v), v]),
            }
        }
        (edges, hung.len())
    })
}

fn masked_field(count: usize) -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(prop_oneof![9 => crate::inputs::value(), 1 => Just(f64::NAN)], count)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(350))]

    #[test]
    fn of_pictures((shape, field) in [1..9usize, 1..9usize].prop_flat_map(|s| (Just(s), field(s.iter().product())))) {
        check(&Grid::new(shape, Connectivity::Freudenthal), &field);
        check(&Grid::new(shape, Connectivity::Full), &field);
    }

    #[test]
    fn of_volumes((shape, field) in [1..5usize, 1..5usize, 1..5usize].prop_flat_map(|s| (Just(s), field(s.iter().product())))) {
        check(&Grid::new(shape, Connectivity::Freudenthal), &field);
    }

    #[test]
    fn of_graphs_without_loops(((edges, n), field) in hanging().prop_flat_map(|g| { let n = g.1; (Just(g), field(n)) })) {
        check(&Adjacency::from_edges(n, &edges).expect("ends exist"), &field);
    }

    /// A tree stays one without some of its vertices.
    #[test]
    fn of_trees_with_holes((hung, field) in (2..30usize).prop_flat_map(|n| {
        (proptest::collection::vec(any::<prop::sample::Index>(), n - 1), masked_field(n))
    })) {
        let edges: Vec<[usize; 2]> = hung.iter().zip(1..).map(|(at, v)| [at.index(v), v]).collect();
        check(&Adjacency::from_edges(field.len(), &edges).expect("ends exist"), &field);
    }
}

/// The components of the vertices up to each, and of those from each on.
fn sublevel_and_superlevel_components(n: usize, edges: &[[usize; 2]]) -> Vec<Vec<usize>> {
    let components = |contains: &dyn Fn(usize) -> bool| {
        let mut names: Vec<usize> = (0..n).map(|v| if contains(v) { v } else { n }).collect();
        for _ in 0..n {
            for &[a, b] in edges.iter().filter(|edge| edge.iter().all(|&v| contains(v))) {
                let name = names[a].min(names[b]);
                (names[a], names[b]) = (name, name);
            }
        }
        names
    };
    (0..n).flat_map(|level| [components(&|v| v <= level), components(&|v| v >= level)]).collect()
}

/// All graphs of six vertices whose values are their indices: the tree is the forest, of all forests, with the same components of sublevel
/// and superlevel sets, and if there is none the graph is refused.
#[test]
fn of_graphs_with_loops_there_is_a_tree_if_one_has_their_join_and_split_trees() {
    let n = 6;
    let pairs: Vec<[usize; 2]> = (0..n).flat_map(|b| (0..b).map(move |a| [a, b])).collect();
    let graph = |choice: usize| -> Vec<[usize; 2]> {
        pairs.iter().enumerate().filter(|(k, _)| choice >> k & 1 == 1).map(|(_, &edge)| edge).collect()
    };
    let trees: BTreeMap<Vec<Vec<usize>>, Vec<[usize; 2]>> = (0..1 << pairs.len())
        .map(|choice| (sublevel_and_superlevel_components(n, &graph(choice)), graph(choice)))
        .filter(|(components, edges)| {
            let parts: BTreeSet<usize> = components[2 * n - 2].iter().copied().collect();
            edges.len() + parts.len() == n
        })
        .collect();
    let mut refused = 0;
    for choice in 0..1 << pairs.len() {
        let adjacency = Adjacency::from_edges(n, &graph(choice)).expect("ends exist");
        let found = topo::contour_tree(&adjacency, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        match trees.get(&sublevel_and_superlevel_components(n, &graph(choice))) {
            Some(edges) => assert_eq!(arcs_of(&found.expect("there is one")), arcs(n, edges)),
            None => {
                assert_eq!(found.expect_err("there is none"), topo::Error::Loops);
                refused += 1;
            }
        }
    }
    assert!(refused > 0);
}

#[test]
fn a_star_of_many_rays_is_pruned_at_once() {
    let rays = 300_000;
    let edges: Vec<[usize; 2]> = (1..=rays).map(|ray| [0, ray]).collect();
    let star = Adjacency::from_edges(rays + 1, &edges).expect("ends exist");
    let field: Vec<i64> = (0..=rays as i64).map(|ray| if ray == 0 { 0 } else { ray % 2 * 2 * ray - ray }).collect();
    let simple = topo::contour_tree(&star, &field).expect("it fits").simplify(u64::MAX);
    assert_eq!((simple.nodes().len(), simple.sizes()), (2, vec![rays + 1]));
}

#[test]
fn what_has_no_contours_has_an_empty_tree() {
    assert!(topo::contour_tree::<_, f64>(&topo::Path::new(0), &[]).expect("it fits").nodes().is_empty());
    let alone = topo::contour_tree(&topo::Path::new(1), &[1.0]).expect("it fits");
    assert_eq!((alone.nodes().len(), alone.arcs().len(), alone.label(0)), (1, 0, None));
    assert!(topo::contour_tree(&topo::Path::new(2), &[1.0, f64::NAN]).is_err());
}

/// On a grid the tree comes from what is critical, on the same graph without a grid from all vertices in order.
#[test]
fn critical_vertices_give_the_tree_of_all() {
    for seed in 0..60usize {
        let shape = [3 + seed % 9, 4 + seed % 7];
        for connectivity in [Connectivity::Freudenthal, Connectivity::Full] {
            let grid = Grid::new(shape, connectivity);
            let n = (&grid).vertex_count();
            let field: Vec<usize> = (0..n).map(|v| (v * 7919 + seed * 104_729) * (v + 31) % (5 + 40 * seed)).collect();
            let mut lists = vec![Vec::new(); n];
            for (v, list) in lists.iter_mut().enumerate() {
                (&grid).for_each_neighbor(v, |u| list.push(u));
            }
            let listed = Adjacency::new(&lists).expect("neighbours exist");
            assert_eq!(topo::contour_tree(&grid, &field), topo::contour_tree(&listed, &field), "{seed}");
        }
    }
}

/// The same across the blocks that rows are labelled in, on hills, terraces and noise.
#[test]
fn critical_vertices_give_the_tree_of_all_on_large_grids() {
    let hills = |y: usize, x: usize| ((y as f64 / 9.0).sin() * (x as f64 / 7.0).cos() * 1e6) as i64;
    let noise = |y: usize, x: usize| (y * 7919 + x * 104_729) as i64 * (y as i64 - 3 * x as i64 + 5) % 1009;
    let fields: [&dyn Fn(usize, usize) -> i64; 3] =
        [&hills, &|y, x| hills(y, x) / 50_000, &|y, x| hills(y, x) + 300 * noise(y, x)];
    for field in fields {
        let shape = [150, 331];
        let field: Vec<i64> = (0..shape[0] * shape[1]).map(|v| field(v / shape[1], v % shape[1])).collect();
        let pictures = [Connectivity::Freudenthal, Connectivity::Full].map(|edges| Grid::new(shape, edges));
        pictures.iter().for_each(|picture| equals_the_tree_of_all(picture, &field));
        equals_the_tree_of_all(&Grid::new([10, 15, 331], Connectivity::Freudenthal), &field);
    }
}

fn equals_the_tree_of_all<G: Domain<Vertex = usize>>(grid: G, field: &[i64]) {
    let mut lists = vec![Vec::new(); field.len()];
    for (v, list) in lists.iter_mut().enumerate() {
        grid.for_each_neighbor(v, |u| list.push(u));
    }
    let listed = Adjacency::new(&lists).expect("neighbours exist");
    let (on_grid, on_lists) = (topo::contour_tree(grid, field), topo::contour_tree(&listed, field));
    assert_eq!(on_grid, on_lists);
}
