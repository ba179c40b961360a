//! Laws of taking maps apart: nothing lies over itself afterwards, islands are disks, triangles keep their shapes.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use geom::{EdgeData, FaceId, HalfedgeData, Id, Mesh, VertexId, Watch, edges_at, shapes};
use proptest::prelude::*;

use super::divide::{Pair, Preference, divide};
use super::*;

/// A tree of triangles, each glued to a free side of one before it, as they lie in the plane; and the lengths of its edges.
fn tree(sides: &[(u16, f64, f64)]) -> (Mesh, UvMap, EdgeData<f64>) {
    let mut points = vec![[0.0, 0.0], [1.0, 0.0], [0.3, 0.8]];
    let mut faces = vec![[0u32, 1, 2]];
    let mut free = vec![[0u32, 1], [1, 2], [2, 0]];
    for &(pick, along, height) in sides {
        let [a, b] = free.swap_remove(pick as usize % free.len());
        let [p, q] = [a, b].map(|v| points[v as usize]);
        let [x, y] = [q[0] - p[0], q[1] - p[1]];
        let apex = points.len() as u32;
        points.push([p[0] + along * x + height * y, p[1] + along * y - height * x]);
        faces.push([b, a, apex]);
        free.extend([[a, apex], [apex, b]]);
    }
    let mesh = Mesh::new(points.len(), &faces).expect("a tree of triangles is a disk");
    let position = mesh.halfedges().map(|h| points[mesh.tail(h).index()]).collect();
    let length = |e| {
        let [p, q] = mesh.ends(e).map(|v| points[v.index()]);
        (q[0] - p[0]).hypot(q[1] - p[1])
    };
    let lengths = mesh.edges().map(length).collect();
    let map = UvMap::new(&mesh, position);
    (mesh, map, lengths)
}

/// All pairs of triangles on one island that overlap, looked at one by one.
fn pairs_on_islands(mesh: &Mesh, map: &UvMap) -> Vec<[u32; 2]> {
    let opened = map.opened(mesh);
    let upright: Vec<_> = map.triangles().iter().copied().map(triangle::upright).collect();
    let extent = map.position.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut found = Vec::new();
    for g in mesh.faces() {
        for f in mesh.faces().take(g.index()).filter(|&f| opened.island(f) == opened.island(g)) {
            if let (Some(one), Some(other)) = (upright[f.index()], upright[g.index()])
                && triangle::depth(&one, &other).is_some_and(|depth| depth > 1e-9 * extent)
            {
                found.push([f.0, g.0]);
            }
        }
    }
    found
}

/// What must hold of a separated map.
fn check(mesh: &Mesh, before: &UvMap, lengths: &EdgeData<f64>, done: &Separation) {
    let after = &done.map;
    if pairs_on_islands(mesh, before).is_empty() {
        assert_eq!(before, after, "a map without overlap stays as it is");
        return;
    }
    let opened = after.opened(mesh);
    assert_eq!(opened.euler_characteristic(), opened.island_count() as i64, "islands are disks");
    assert_eq!(opened.boundary_loops().len(), opened.island_count());
    let distance = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    for h in mesh.halfedges() {
        let length = |map: &UvMap| distance(map.position[h], map.position[mesh.next(h)]);
        assert!((length(after) - length(before)).abs() <= 1e-9 * (1.0 + length(before)), "scale is untouched");
        let e = mesh.edge(h);
        assert!(lengths[e].is_finite() || after.cut[e] == before.cut[e], "polygons are not parted");
        if let Some(g) = mesh.twin(h).filter(|_| !after.cut[e]) {
            assert_eq!(after.position[h], after.position[mesh.next(g)], "one position at both sides of what is glued");
        }
    }
    for f in mesh.faces() {
        let sign = |map: &UvMap| triangle::twice_area(map.triangle(f));
        assert!(sign(before).abs() < 1e-12 || sign(before).signum() == sign(after).signum(), "nothing is mirrored");
    }
    let of = |pair: [u32; 2]| pair.map(FaceId);
    for [f, g] in pairs_on_islands(mesh, after).into_iter().map(of) {
        assert!(!done.left.pairs.is_empty(), "{f:?} and {g:?} lie over each other");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn trees_of_triangles_come_apart(
        sides in prop::collection::vec((any::<u16>(), 0.0..1.0f64, 0.2..1.2f64), 1..70),
    ) {
        let (mesh, map, lengths) = tree(&sides);
        let found: Vec<[u32; 2]> = overlaps(map.triangles()).pairs.iter().map(|pair| pair.triangles).collect();
        let expected = pairs_on_islands(&mesh, &map);
        prop_assert_eq!(found.into_iter().collect::<BTreeSet<_>>(), expected.iter().copied().collect());
        let from_boundary = immersion::overlaps_from_boundary(&mesh, &map, Watch::NONE);
        let pairs = from_boundary.unwrap().expect("nothing is folded over").pairs;
        prop_assert_eq!(pairs.iter().map(|pair| pair.triangles).collect::<BTreeSet<_>>(), expected.into_iter().collect());
        let done = separate(&mesh, &lengths, None, map.clone(), Watch::NONE).unwrap();
        check(&mesh, &map, &lengths, &done);
        prop_assert!(done.left.pairs.is_empty());
    }

    #[test]
    fn polygons_are_never_parted(
        sides in prop::collection::vec((any::<u16>(), 0.0..1.0f64, 0.2..1.2f64), 1..50),
        diagonals in prop::collection::vec(any::<bool>(), 50),
    ) {
        let (mesh, map, mut lengths) = tree(&sides);
        for (e, &is_diagonal) in mesh.edges().zip(&diagonals) {
            if is_diagonal && !mesh.is_boundary_edge(e) {
                lengths[e] = f64::INFINITY;
            }
        }
        let done = separate(&mesh, &lengths, None, map.clone(), Watch::NONE).unwrap();
        check(&mesh, &map, &lengths, &done);
    }

    #[test]
    fn random_positions_come_apart_whatever_they_are(
        corners in prop::collection::vec(prop::array::uniform2(0..7i32), 600),
        cuts in prop::collection::vec(any::<u8>(), 300),
    ) {
        // Folded, flat and opened at random: nothing but that it ends and leaves no overlap that could be parted.
        let mesh = shapes::disk(30).mesh();
        let mut cut: EdgeData<bool> = EdgeData::constant(mesh.edge_count(), false);
        for (e, &pick) in mesh.edges().zip(&cuts) {
            cut[e] = pick % 5 == 0 && !mesh.is_boundary_edge(e);
        }
        let opened = geom::CutMesh::open(&mesh, &cut);
        let position: HalfedgeData<[f64; 2]> =
            mesh.halfedges().map(|h| corners[opened.wedge(h).index()].map(f64::from)).collect();
        let lengths = EdgeData::constant(mesh.edge_count(), 1.0);
        let done = separate(&mesh, &lengths, None, UvMap { position, cut }, Watch::NONE).unwrap();
        prop_assert!(done.left.pairs.is_empty());
        prop_assert_eq!(pairs_on_islands(&mesh, &done.map), Vec::<[u32; 2]>::new());
    }

    #[test]
    fn one_pair_is_parted_by_a_shortest_path(
        lengths in prop::collection::vec(0.1..1.0f64, 400),
        pick in prop::array::uniform2(any::<u16>()),
    ) {
        let mesh = shapes::disk(60).mesh();
        let lengths: EdgeData<f64> = mesh.edges().zip(lengths).map(|(_, l)| l).collect();
        let triangles = pick.map(|f| FaceId::new(f as usize % mesh.face_count()));
        prop_assume!(triangles[0] != triangles[1]);
        let none = EdgeData::constant(mesh.edge_count(), false);
        let preference = Preference { within_overlap: 1.0, power: 1.0, least_share: 0.0 };
        let pair = Pair { triangles, weight: 1 };
        let cut = divide(&mesh, &lengths, &none, &[pair], &preference, Watch::NONE).unwrap();
        let opened = geom::CutMesh::open(&mesh, &cut);
        prop_assert_eq!(opened.island_count(), 2);
        prop_assert_ne!(opened.island(triangles[0]), opened.island(triangles[1]));
        let length: f64 = mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).sum();
        let shortest = shortest_parting(&mesh, &lengths, triangles);
        // Edges that the shortest way passes twice are cut once; slivers cost thirty times as much.
        prop_assert!(length <= 30.0 * shortest + 1e-9);
        let size = |island| mesh.faces().filter(|&f| opened.island(f) == island).count();
        if size(0).min(size(1)) < 20 {
            prop_assert!(length <= shortest + 1e-9, "a sliver is taken only where nothing shorter is to be had");
        }
    }
}

/// The length of the shortest way from boundary to boundary that passes between two triangles: Dijkstra's algorithm on vertices with
/// the parity of how often a path of triangles between the two was crossed.
fn shortest_parting(mesh: &Mesh, lengths: &EdgeData<f64>, [from, to]: [FaceId; 2]) -> f64 {
    let mut came: Vec<Option<geom::HalfedgeId>> = vec![None; mesh.face_count()];
    let mut queue = std::collections::VecDeque::from([from]);
    while let Some(f) = queue.pop_front() {
        for h in mesh.sides(f) {
            let Some(g) = mesh.twin(h).map(|g| mesh.face(g)) else { continue };
            if g != from && came[g.index()].is_none() {
                came[g.index()] = Some(h);
                queue.push_back(g);
            }
        }
    }
    let mut is_crossed = vec![false; mesh.edge_count()];
    let mut at = to;
    while let Some(h) = came[at.index()] {
        is_crossed[mesh.edge(h).index()] = true;
        at = mesh.face(h);
    }
    let mut distance = vec![f64::INFINITY; 2 * mesh.vertex_count()];
    let mut heap = BinaryHeap::new();
    for v in mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)) {
        distance[2 * v.index()] = 0.0;
        heap.push(Reverse((0u64, 2 * v.index())));
    }
    while let Some(Reverse((bits, state))) = heap.pop() {
        let (v, d) = (VertexId::new(state / 2), f64::from_bits(bits));
        if d > distance[state] {
            continue;
        }
        if state % 2 == 1 && mesh.is_boundary_vertex(v) {
            return d;
        }
        for (e, w) in edges_at(mesh, v).filter(|&(e, _)| !mesh.is_boundary_edge(e)) {
            let next = 2 * w.index() + ((state % 2) ^ usize::from(is_crossed[e.index()]));
            if d + lengths[e] < distance[next] {
                distance[next] = d + lengths[e];
                heap.push(Reverse((distance[next].to_bits(), next)));
            }
        }
    }
    f64::INFINITY
}

/// A ribbon that winds round a point more than three times, by unit squares cut in two.
fn spiral() -> (Mesh, UvMap, EdgeData<f64>) {
    let steps = 120u32;
    let at = |k: u32, radius: f64| {
        let angle = f64::from(k) * 0.17;
        [radius * angle.cos(), radius * angle.sin()]
    };
    let points: Vec<[f64; 2]> = (0..=steps).flat_map(|k| [at(k, 1.0), at(k, 1.5)]).collect();
    let faces: Vec<[u32; 3]> = (0..steps)
        .flat_map(|k| {
            let [a, b, c, d] = [2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 3];
            [[a, b, c], [c, b, d]]
        })
        .collect();
    let mesh = Mesh::new(points.len(), &faces).unwrap();
    let position = mesh.halfedges().map(|h| points[mesh.tail(h).index()]).collect();
    let lengths = mesh.edges().map(|e| {
        let [p, q] = mesh.ends(e).map(|v| points[v.index()]);
        (p[0] - q[0]).hypot(p[1] - q[1])
    });
    let lengths = lengths.collect();
    (mesh.clone(), UvMap::new(&mesh, position), lengths)
}

#[test]
fn a_spiral_comes_apart_at_each_turn() {
    let (mesh, map, lengths) = spiral();
    let done = separate(&mesh, &lengths, None, map.clone(), Watch::NONE).unwrap();
    check(&mesh, &map, &lengths, &done);
    let islands = done.map.opened(&mesh).island_count();
    // 120 · 0.17 rad are 3.25 turns; pieces of a ring have nowhere else to go.
    assert_eq!(islands, 4);
    assert!((done.added_seam - 3.0 * 0.5).abs() < 0.3, "cut across the ribbon: {}", done.added_seam);
}

#[test]
fn a_ring_that_turns_by_more_than_a_full_angle_comes_apart() {
    let strip = |n: u32| -> Vec<[u32; 3]> {
        let square = |k: u32| [[2 * k, 2 * k + 1, 2 * k + 2], [2 * k + 2, 2 * k + 1, 2 * k + 3]];
        (0..n).flat_map(square).collect()
    };
    let n = 24u32;
    // A ring: the last two vertices are the first two.
    let ring = 2 * n;
    let faces: Vec<[u32; 3]> = strip(n).into_iter().map(|t| t.map(|v| v % ring)).collect();
    let mesh = Mesh::new(ring as usize, &faces).unwrap();
    // A cone of more than 2π: each square takes 0.3 rad, 7.2 in all, opened between the last square and the first.
    let place = |k: u32, outer: u32| {
        let (angle, radius) = (0.3 * f64::from(k), 1.0 + 0.4 * f64::from(outer));
        [radius * angle.cos(), radius * angle.sin()]
    };
    let position: HalfedgeData<[f64; 2]> = mesh
        .halfedges()
        .map(|h| {
            let (v, square) = (mesh.tail(h).0, mesh.face(h).0 / 2);
            let k = v / 2;
            place(if k == 0 && square == n - 1 { n } else { k }, v % 2)
        })
        .collect();
    let map = UvMap::new(&mesh, position);
    assert_eq!(map.cut.iter().filter(|&&cut| cut).count(), 1);
    let lengths = mesh.edges().map(|e| if map.cut[e] { 0.4 } else { 0.4 + 0.01 * f64::from(e.0 % 7) }).collect();
    let done = separate(&mesh, &lengths, None, map.clone(), Watch::NONE).unwrap();
    check(&mesh, &map, &lengths, &done);
    assert!(!done.overlaps.pairs.is_empty());
    assert_eq!(done.map.opened(&mesh).island_count(), 2, "a turn and the rest, which hangs on nothing else");
}

#[test]
fn a_folded_sheet_is_cut_along_its_fold() {
    let at = |i: u32, j: u32| 5 * i + j;
    let square =
        |i: u32, j: u32| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let faces: Vec<[u32; 3]> = (0..8).flat_map(|i| (0..4).flat_map(move |j| square(i, j))).collect();
    let mesh = Mesh::new(45, &faces).unwrap();
    let fold = |v: u32| [f64::from((v / 5).min(8 - v / 5)), f64::from(v % 5)];
    let map = UvMap::new(&mesh, mesh.halfedges().map(|h| fold(mesh.tail(h).0)).collect());
    let lengths = EdgeData::constant(mesh.edge_count(), 1.0);
    let done = separate(&mesh, &lengths, None, map.clone(), Watch::NONE).unwrap();
    check(&mesh, &map, &lengths, &done);
    assert_eq!((done.map.opened(&mesh).island_count(), done.added_seam), (2, 4.0));
    assert_eq!(done.map.position, map.position, "nothing had to be moved");
}
