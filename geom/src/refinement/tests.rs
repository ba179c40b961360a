use proptest::prelude::*;

use super::*;
use crate::intrinsic::{Metric, angle_defects, edge_weights};
use crate::mesh::{EdgeData, EdgeId, HalfedgeId, Id, Mesh, VertexId};
use crate::shapes;
use crate::surface::{Model, Weld, prepare};
use crate::vector;
use crate::watch::Watch;

/// Asserts all that is true of a refinement of a surface with these positions.
fn check(mesh: &Mesh, points: &[[f64; 3]]) -> Refinement {
    check_holding(mesh, points, &EdgeData::constant(mesh.edge_count(), false))
}

/// The same, with edges that are held.
fn check_holding(mesh: &Mesh, points: &[[f64; 3]], held: &EdgeData<bool>) -> Refinement {
    let (metric, size) = (Metric::from_points(mesh, points), TriangleSize::ANY);
    let roles = EdgeRoles { held: Some(held), ..EdgeRoles::default() };
    let refinement = refine_watched(mesh, &metric, size, roles, Watch::NONE).expect("it is not stopped");
    check_triangulation((mesh, &metric), size, held, &refinement);
    check_common(mesh, points, &refinement);
    check_held((mesh, &metric), held, &refinement);
    assert!(refinement.place.len() < 10_000, "it ended by itself: {}", refinement.place.len());
    refinement
}

/// Asserts that edges that are held are edges, in parts that are as long as they are, and that nothing crosses them.
fn check_held((mesh, metric): (&Mesh, &Metric), held: &EdgeData<bool>, refinement: &Refinement) {
    let Refinement { triangulation, metric: fine, place, along, common, .. } = refinement;
    let mut parts = EdgeData::constant(mesh.edge_count(), 0.0);
    for (e, part_of) in along.iter_ids() {
        if let Some(h) = *part_of {
            parts[mesh.edge(h)] += fine.length(e);
            let ends = triangulation.ends(e).map(|v| match place[v] {
                SurfacePoint::Vertex(v) => f64::from(u8::from(v == mesh.head(h))),
                SurfacePoint::Edge(on, share) if on == h => share,
                SurfacePoint::Edge(on, share) if Some(on) == mesh.twin(h) => 1.0 - share,
                elsewhere => panic!("{elsewhere:?} is not on {h:?}"),
            });
            assert!(ends[0] < ends[1], "{h:?}: {ends:?}");
        }
    }
    for (e, _) in held.iter_ids().filter(|&(_, held)| *held) {
        let length = metric.length(e);
        assert!((parts[e] - length).abs() < 1e-12 * length, "{e:?}, {length} long, is {} long", parts[e]);
    }
    let is_crossed = |place: &&SurfacePoint| matches!(place, SurfacePoint::Edge(h, _) if held[mesh.edge(*h)]);
    assert_eq!(common.place.iter().skip(place.len()).filter(is_crossed).count(), 0);
}

/// Shortest paths by the number of edges between vertices of a refinement, none of which touches another one or what is held.
fn disjoint_paths(
    refinement: &Refinement,
    held: &EdgeData<bool>,
    input: &Mesh,
    picks: &[prop::sample::Index],
) -> Vec<StraightPath> {
    let t = Mesh::from_triangulation(refinement.triangulation.clone()).expect("it is a manifold");
    let is_held = |e: EdgeId| refinement.along[e].is_some_and(|h| held[input.edge(h)]);
    let mut is_taken = vec![false; t.vertex_count()];
    t.edges().filter(|&e| is_held(e)).flat_map(|e| t.ends(e)).for_each(|v| is_taken[v.index()] = true);
    let mut paths = Vec::new();
    for pair in picks.chunks_exact(2) {
        let [from, to] = [0, 1].map(|k| VertexId::new(pair[k].index(t.vertex_count())));
        let mut into: Vec<Option<HalfedgeId>> = vec![None; t.vertex_count()];
        let mut queue = std::collections::VecDeque::from([from]);
        while let Some(v) = queue.pop_front().filter(|_| !is_taken[from.index()]) {
            for h in t.outgoing(v) {
                let w = t.head(h);
                if w != from && into[w.index()].is_none() && !is_taken[w.index()] {
                    into[w.index()] = Some(h);
                    queue.push_back(w);
                }
            }
        }
        let before = |h: &HalfedgeId| into[t.tail(*h).index()];
        let mut path: Vec<HalfedgeId> = std::iter::successors(into[to.index()], before).collect();
        path.reverse();
        path.iter().flat_map(|&h| [t.tail(h), t.head(h)]).for_each(|v| is_taken[v.index()] = true);
        paths.extend(
            Some(path).filter(|path| !path.is_empty()).map(|halfedges| StraightPath { halfedges, may_slide: true }),
        );
    }
    paths
}

/// Asserts that the edges of a path are one between the ends that it had, no longer than before, and straight where nothing was in its way.
fn check_path(
    number: u32,
    path: &[HalfedgeId],
    (input, before, after): (&Mesh, &Refinement, &Refinement),
    is_free: bool,
) {
    let t = Mesh::from_triangulation(after.triangulation.clone()).expect("it is a manifold");
    let edges: Vec<EdgeId> = t.edges().filter(|&e| after.path[e] == Some(number)).collect();
    let was = &before.triangulation;
    let now = |v: VertexId| VertexId::new(v.index() - after.removed.partition_point(|&removed| removed < v));
    let ends = [was.tail(path[0]), was.head(path[path.len() - 1])].map(now);
    let length =
        |metric: &Metric, edges: &mut dyn Iterator<Item = EdgeId>| edges.map(|e| metric.length(e)).sum::<f64>();
    let [long, short] = [
        length(&before.metric, &mut path.iter().map(|&h| was.edge(h))),
        length(&after.metric, &mut edges.iter().copied()),
    ];
    assert!(short <= long * (1.0 + 1e-9), "{short} for {long}");
    let is_part = |h: HalfedgeId| after.path[t.edge(h)] == Some(number);
    let (mut v, mut came, mut passed) = (ends[0], None, 0);
    while v != ends[1] {
        let out: Vec<HalfedgeId> = t.outgoing(v).filter(|&h| is_part(h) && t.twin(h) != came).collect();
        assert_eq!(out.len(), 1, "{v:?} on path {number}");
        if let Some(came) = came.and_then(|h| t.twin(h)).filter(|_| is_free) {
            // Counter-clockwise from the way out to the way in.
            let (mut h, mut angle) = (out[0], 0.0);
            while h != came {
                angle += after.metric.angle(&t, h);
                h = t.twin(t.prev(h)).expect("it is closed");
            }
            let whole: f64 = t.outgoing(v).map(|h| after.metric.angle(&t, h)).sum();
            // Through a vertex of the input that it nearly goes through anyway it may turn a little.
            let least = if v.index() < input.vertex_count() { 0.25 } else { 1e-4 };
            assert!(angle.min(whole - angle) > std::f64::consts::PI - least, "{v:?}: {angle} of {whole}");
        }
        (v, came, passed) = (t.head(out[0]), Some(out[0]), passed + 1);
    }
    assert_eq!(passed, edges.len());
}

fn check_triangulation(
    (mesh, metric): (&Mesh, &Metric),
    size: TriangleSize<'_>,
    held: &EdgeData<bool>,
    refinement: &Refinement,
) {
    let Refinement { triangulation, metric: fine, place, along, is_complete, .. } = refinement;
    triangulation.check();
    let [before, after] = [metric.area(mesh), fine.area(triangulation)];
    assert!((after / before - 1.0).abs() < 1e-9, "area {before} became {after}");
    assert_eq!(triangulation.euler_characteristic(), mesh.euler_characteristic());
    let refined = Mesh::from_triangulation(triangulation.clone()).expect("it is a manifold");
    let (before, after) = (angle_defects(mesh, metric), angle_defects(&refined, fine));
    for v in refined.vertices() {
        let expected = before.get(v.index()).copied().unwrap_or(0.0);
        assert!((after[v] - expected).abs() < 1e-7, "{v:?}: {expected} became {}", after[v]);
    }
    assert!(edge_weights(triangulation, fine).iter().enumerate().all(|(e, w)| {
        let e = crate::mesh::EdgeId::new(e);
        let is_held = along[e].is_some_and(|h| held[mesh.edge(h)]);
        *w > -1e-6 || triangulation.is_boundary_edge(e) || is_held
    }));
    if *is_complete {
        // Between edges that are held, or one and the boundary, angles may be narrow, and farther off what is as far from such a corner.
        let across = |h: HalfedgeId| {
            let is_held = along[triangulation.edge(h)].is_some_and(|h| held[mesh.edge(h)]);
            triangulation.twin(h).filter(|_| !is_held)
        };
        let is_narrow_at = |h: HalfedgeId| {
            let clockwise = |g: &HalfedgeId| across(*g).map(|g| triangulation.next(g)).filter(|&g| g != h);
            let first = std::iter::successors(Some(h), clockwise).last().expect("itself");
            let counterclockwise = |g: &HalfedgeId| across(triangulation.prev(*g)).filter(|&g| g != first);
            let sector = std::iter::successors(Some(first), counterclockwise);
            let is_of_input = triangulation.tail(h).index() < mesh.vertex_count();
            is_of_input && sector.map(|h| fine.angle(triangulation, h)).sum::<f64>() < std::f64::consts::PI / 3.0 + 1e-9
        };
        let mut has_narrow = vec![false; triangulation.vertex_count()];
        for h in triangulation.halfedges() {
            has_narrow[triangulation.tail(h).index()] |= is_narrow_at(h);
        }
        let from_corners = |v: VertexId| match place[v] {
            SurfacePoint::Edge(h, along) => {
                let length = metric.length(mesh.edge(h));
                vec![(mesh.tail(h), along * length), (mesh.head(h), (1.0 - along) * length)]
            }
            _ => Vec::new(),
        };
        let spans_corner = |v: VertexId, w: VertexId| {
            let corners = from_corners(w);
            let is_alike = |(v, far): (VertexId, f64)| {
                corners.iter().any(|&(w, as_far)| v == w && (far - as_far).abs() < 1e-8 * far && has_narrow[v.index()])
            };
            from_corners(v).into_iter().any(is_alike)
        };
        for h in triangulation.halfedges() {
            let opposite = triangulation.next(h);
            let is_narrow = is_narrow_at(h)
                || held.contains(&true) && spans_corner(triangulation.tail(opposite), triangulation.head(opposite));
            let angle = fine.angle(triangulation, h);
            let sides = fine.sides(triangulation, triangulation.face(h));
            let radius = sides.0.iter().product::<f64>() / (4.0 * sides.area());
            assert!(radius < size.largest * (1.0 + 1e-9), "{h:?} {radius}");
            assert!(is_narrow || radius < size.small || angle > LEAST_ANGLE - 1e-9, "{h:?} {angle}");
        }
    }
}

fn check_common(mesh: &Mesh, points: &[[f64; 3]], refinement: &Refinement) {
    check_surface(mesh, points, refinement);
    let common = &refinement.common;
    // Each triangle of the input is covered once: areas in barycentric coordinates sum to that of the whole.
    let mut covered = vec![0.0; mesh.face_count()];
    for (f, triangle) in common.triangles.iter_ids() {
        let home = common.input[f];
        let [a, b, c] = triangle.map(|v| common.place[crate::mesh::VertexId(v)].barycentric(mesh, home));
        let area = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
        assert!(area > -1e-9, "{f:?} is turned over: {area}");
        covered[home.index()] += area;
    }
    for (f, area) in covered.iter().enumerate() {
        assert!((area - 1.0).abs() < 1e-9, "triangle {f} is covered {area} times");
    }
}

/// Asserts that the common refinement is the same surface in space.
fn check_surface(mesh: &Mesh, points: &[[f64; 3]], refinement: &Refinement) {
    let common = &refinement.common;
    let positions = common.positions(mesh, points);
    assert_eq!(&positions[..points.len()], points, "the input's vertices stay");
    let fine = Mesh::new(positions.len(), &common.triangles).expect("it is a manifold");
    assert_eq!(fine.euler_characteristic(), mesh.euler_characteristic());
    let area = |mesh: &Mesh, points: &[[f64; 3]]| Metric::from_points(mesh, points).area(mesh);
    assert!((area(&fine, &positions) / area(mesh, points) - 1.0).abs() < 1e-9);
    let volume = |mesh: &Mesh, points: &[[f64; 3]]| -> f64 {
        let of = |f| {
            let [a, b, c] = mesh.corners(f).map(|v| points[v.index()]);
            vector::dot(a, vector::cross(b, c))
        };
        mesh.faces().map(of).sum()
    };
    let [before, after] = [volume(mesh, points), volume(&fine, &positions)];
    assert!((before - after).abs() < 1e-9 * before.abs().max(1.0), "{before} {after}");
}

/// The first triangle of each one's region, between which no edges but these are.
fn regions(mesh: &Mesh, inner: &EdgeData<bool>) -> Vec<usize> {
    let mut region: Vec<usize> = (0..mesh.face_count()).collect();
    let mut is_done = false;
    while !is_done {
        is_done = true;
        for e in mesh.edges().filter(|&e| inner[e]) {
            let h = mesh.halfedge(e);
            let sides = [h, mesh.twin(h).expect("it is inside")].map(|h| mesh.face(h).index());
            let first = region[sides[0]].min(region[sides[1]]);
            is_done &= sides.iter().all(|&f| region[f] == first);
            sides.iter().for_each(|&f| region[f] = first);
        }
    }
    region
}

fn stretched(mut shape: shapes::Shape, by: [f64; 3]) -> shapes::Shape {
    shape.points.iter_mut().for_each(|p| (0..3).for_each(|c| p[c] *= by[c]));
    shape
}

#[test]
fn a_surface_of_even_triangles_stays_as_it_is() {
    let shape = shapes::sphere(300);
    let refinement = check(&shape.mesh(), &shape.points);
    assert_eq!(refinement.triangulation, *shape.mesh().triangulation());
    assert_eq!(refinement.common.triangles.len(), shape.triangles.len());
}

#[test]
fn stretched_shapes_get_even_triangles() {
    for by in [[1.0, 1.0, 20.0], [1.0, 0.05, 1.0], [1.0, 10.0, 100.0]] {
        for shape in [shapes::hare(300), shapes::torus(2, 300), shapes::terrain(200, 3), shapes::cylinder(100)] {
            let shape = stretched(shape, by);
            assert!(check(&shape.mesh(), &shape.points).is_complete);
        }
    }
}

#[test]
fn small_needles_may_stay() {
    for shape in [shapes::hare(900), shapes::torus(2, 900), shapes::terrain(600, 3)] {
        let shape = stretched(shape, [1.0, 1.0, 6.0]);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let none_held = EdgeData::constant(mesh.edge_count(), false);
        let root = metric.area(&mesh).sqrt();
        let counts = [0.0, 0.03, 0.08].map(|small| {
            let size = TriangleSize { largest: 0.1 * root, at: None, small: small * root };
            let refinement = refine(&mesh, &metric, size);
            check_triangulation((&mesh, &metric), size, &none_held, &refinement);
            check_common(&mesh, &shape.points, &refinement);
            assert!(refinement.is_complete);
            refinement.place.len()
        });
        assert!(counts.is_sorted_by(|more, fewer| more > fewer), "{counts:?}");
    }
}

#[test]
fn triangles_are_as_small_as_is_said_at_a_place() {
    let shape = shapes::sphere(400);
    let mesh = shape.mesh();
    let metric = Metric::from_points(&mesh, &shape.points);
    let top = shape.points[0];
    let far = |place: SurfacePoint| vector::distance(place.position(&mesh, &shape.points), top);
    let at = |place: SurfacePoint| 0.005 + 0.3 * far(place);
    let size = TriangleSize { largest: 0.4, at: Some(&at), small: 0.0 };
    let none_held = EdgeData::constant(mesh.edge_count(), false);
    let refinement = refine_watched(&mesh, &metric, size, EdgeRoles::default(), Watch::NONE).unwrap();
    check_triangulation((&mesh, &metric), size, &none_held, &refinement);
    check_common(&mesh, &shape.points, &refinement);
    assert!(refinement.is_complete);
    let Refinement { triangulation, metric, place, .. } = &refinement;
    let mut radii = Vec::new();
    for f in triangulation.faces() {
        let sides = metric.sides(triangulation, f);
        let radius = sides.0.iter().product::<f64>() / (4.0 * sides.area());
        let most = triangulation.corners(f).iter().map(|&v| at(place[v]) / 3.0).sum::<f64>();
        assert!(radius <= most * (1.0 + 1e-9), "{radius} {most}");
        radii.push(radius);
    }
    radii.sort_by(f64::total_cmp);
    assert!(radii[radii.len() - 1] > 8.0 * radii[0], "{:?}", [radii[0], radii[radii.len() - 1]]);
}

#[test]
fn a_needle_alone_is_cut_up() {
    for aspect in [1e1, 1e3, 1e5] {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.4, 1.0 / aspect, 0.0]];
        let mesh = Mesh::new(3, &[[0, 1, 2]]).unwrap();
        check(&mesh, &points);
    }
}

/// A closed bipyramid whose rim is anywhere: needles and caps of any aspect, and vertices of any angle.
fn bipyramid(rim: &[(f64, f64, f64)], height: f64) -> (Mesh, Vec<[f64; 3]>) {
    let count = rim.len() as u32;
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut turned = 0.0;
    let whole: f64 = rim.iter().map(|(step, _, _)| step).sum();
    for (step, radius, z) in rim {
        turned += std::f64::consts::TAU * step / whole;
        points.push([radius * turned.cos(), radius * turned.sin(), *z]);
    }
    points.extend([[0.0, 0.0, height], [0.0, 0.0, -height]]);
    let faces: Vec<[u32; 3]> =
        (0..count).flat_map(|k| [[k, (k + 1) % count, count], [(k + 1) % count, k, count + 1]]).collect();
    (Mesh::new(points.len(), &faces).expect("a bipyramid"), points)
}

/// A length of any magnitude down to 10^-`digits`.
fn magnitude(digits: f64) -> impl Strategy<Value = f64> {
    (-digits..0.0).prop_map(|digits| 10f64.powf(digits))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn needles_of_any_aspect_get_even_triangles(
        rim in prop::collection::vec((magnitude(4.0), 0.3..1.0f64, -0.2..0.2f64), 4..12),
        height in magnitude(2.0),
    ) {
        let (mesh, points) = bipyramid(&rim, height);
        check(&mesh, &points);
    }

    #[test]
    fn patches_stretched_by_any_factor_get_even_triangles(
        heights in prop::collection::vec(0.0..1.0f64, 25),
        by in (magnitude(3.0), magnitude(3.0), magnitude(3.0)),
    ) {
        let points: Vec<[f64; 3]> =
            heights.iter().enumerate().map(|(v, z)| [by.0 * (v % 5) as f64, by.1 * (v / 5) as f64, by.2 * z]).collect();
        let squares = (0..16u32).map(|k| k / 4 * 5 + k % 4);
        let faces: Vec<[u32; 3]> = squares.flat_map(|v| [[v, v + 1, v + 6], [v, v + 6, v + 5]]).collect();
        check(&Mesh::new(25, &faces).expect("a patch"), &points);
    }

    #[test]
    fn edges_that_are_held_stay_edges(
        rim in prop::collection::vec((magnitude(4.0), 0.3..1.0f64, -0.2..0.2f64), 4..12),
        height in magnitude(2.0),
        held in prop::collection::vec(any::<bool>(), 36),
    ) {
        let (mesh, points) = bipyramid(&rim, height);
        check_holding(&mesh, &points, &mesh.edges().map(|e| held[e.index()]).collect());
    }

    #[test]
    fn edges_that_are_held_in_a_patch_stay_edges(
        heights in prop::collection::vec(0.0..1.0f64, 25),
        by in (magnitude(3.0), magnitude(3.0), magnitude(3.0)),
        held in prop::collection::vec(prop::sample::select(vec![false, false, true]), 56),
    ) {
        let points: Vec<[f64; 3]> =
            heights.iter().enumerate().map(|(v, z)| [by.0 * (v % 5) as f64, by.1 * (v / 5) as f64, by.2 * z]).collect();
        let squares = (0..16u32).map(|k| k / 4 * 5 + k % 4);
        let faces: Vec<[u32; 3]> = squares.flat_map(|v| [[v, v + 1, v + 6], [v, v + 6, v + 5]]).collect();
        let mesh = Mesh::new(25, &faces).expect("a patch");
        check_holding(&mesh, &points, &mesh.edges().map(|e| held[e.index()]).collect());
    }

    #[test]
    fn paths_become_straight(
        rim in prop::collection::vec((magnitude(1.5), 0.3..1.0f64, -0.2..0.2f64), 4..12),
        height in magnitude(1.0),
        picks in prop::collection::vec(any::<prop::sample::Index>(), 6),
        held in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let (mesh, points) = bipyramid(&rim, height);
        let metric = Metric::from_points(&mesh, &points);
        let held: EdgeData<bool> =
            mesh.edges().map(|e| held.is_some_and(|held| held.index(mesh.edge_count()) == e.index())).collect();
        let size = TriangleSize { largest: 0.1, ..TriangleSize::ANY };
        let refined = |straight: &[StraightPath]| {
            let roles = EdgeRoles { held: Some(&held), straight, ..EdgeRoles::default() };
            refine_watched(&mesh, &metric, size, roles, Watch::NONE).expect("it is not stopped")
        };
        let before = refined(&[]);
        prop_assume!(before.is_complete);
        let paths = disjoint_paths(&before, &held, &mesh, &picks);
        let after = refined(&paths);
        check_common(&mesh, &points, &after);
        after.triangulation.check();
        prop_assert!(after.removed.is_sorted() && after.removed.iter().all(|v| v.index() >= mesh.vertex_count()));
        prop_assert!((after.metric.area(&after.triangulation) / metric.area(&mesh) - 1.0).abs() < 1e-9);
        for (number, path) in (0..).zip(&paths) {
            check_path(number, &path.halfedges, (&mesh, &before, &after), paths.len() == 1 && !held.contains(&true));
        }
    }

    #[test]
    fn planes_need_no_edges_of_the_input(
        heights in prop::collection::vec(prop::sample::select(vec![0.0, 0.0, 0.0, 0.0, 1.0]), 49),
        diagonals in prop::collection::vec(any::<bool>(), 36),
        by in (magnitude(2.0), magnitude(2.0)),
    ) {
        let points: Vec<[f64; 3]> =
            heights.iter().enumerate().map(|(v, z)| [by.0 * (v % 7) as f64, by.1 * (v / 7) as f64, *z]).collect();
        let squares = (0..36u32).map(|k| k / 6 * 7 + k % 6).zip(&diagonals);
        let faces: Vec<[u32; 3]> = squares
            .flat_map(|(v, rises)| match rises {
                true => [[v, v + 1, v + 8], [v, v + 8, v + 7]],
                false => [[v, v + 1, v + 7], [v + 1, v + 8, v + 7]],
            })
            .collect();
        let mesh = Mesh::new(49, &faces).expect("a patch");
        let planar = planar_edges(&mesh, &points, 1e-12, |_, _| true);
        for e in mesh.edges() {
            let ends = [Some(mesh.halfedge(e)), mesh.twin(mesh.halfedge(e))].map(|h| h.map(|h| mesh.face(h)));
            let normal = |f| vector::normal(mesh.corners(f).map(|v| points[v.index()]));
            let is_flat = match ends {
                [Some(f), Some(g)] => vector::distance(vector::unit(normal(f)), vector::unit(normal(g))) < 1e-9,
                _ => false,
            };
            prop_assert_eq!(planar[e], is_flat, "{:?}", e);
        }
        let metric = Metric::from_points(&mesh, &points);
        let cut = |left_out| refine_watched(&mesh, &metric, TriangleSize::ANY, EdgeRoles { left_out, ..EdgeRoles::default() }, Watch::NONE).expect("it is not stopped");
        let (all, fewer) = (cut(None), cut(Some(&planar)));
        prop_assert_eq!(&fewer.triangulation, &all.triangulation);
        check_surface(&mesh, &points, &fewer);
        // The input's triangle that each one names is in the region that it lies in.
        let at = fewer.common.positions(&mesh, &points);
        let region = regions(&mesh, &planar);
        let inside = |f: FaceId, p: [f64; 3]| {
            let [a, b, c] = mesh.corners(f).map(|v| points[v.index()]);
            let turn = |a: [f64; 3], b: [f64; 3]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            [turn(a, b), turn(b, c), turn(c, a)].iter().all(|&side| side >= 0.0)
        };
        for (t, triangle) in fewer.common.triangles.iter_ids() {
            let sum = triangle.iter().fold([0.0; 3], |sum, &v| vector::add(sum, at[v as usize]));
            let middle = vector::scale(sum, 1.0 / 3.0);
            let home = fewer.common.input[t];
            let there: Vec<FaceId> = mesh.faces().filter(|&f| inside(f, middle)).collect();
            prop_assert!(there.iter().any(|&f| region[f.index()] == region[home.index()]), "{:?} is not on {:?}", t, home);
        }
        // What is left are crossings with creases.
        let crossings = |refinement: &Refinement| {
            let crossed = refinement.common.place.iter().skip(refinement.place.len());
            let on = crossed.filter(|place| matches!(place, SurfacePoint::Edge(h, _) if planar[mesh.edge(*h)]));
            on.count()
        };
        prop_assert_eq!(crossings(&fewer), 0);
        let gone = all.common.place.len() - fewer.common.place.len();
        prop_assert_eq!(gone, crossings(&all));
        prop_assert_eq!(all.common.triangles.len() - fewer.common.triangles.len(), 2 * gone);
    }

    #[test]
    fn one_triangle_of_aspect_up_to_a_hundred_million_ends(x in 0.0..1.0f64, height in magnitude(8.0)) {
        let mesh = Mesh::new(3, &[[0, 1, 2]]).expect("a triangle");
        let metric = Metric::from_points(&mesh, &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [x, height, 0.0]]);
        let refinement = refine(&mesh, &metric, TriangleSize::ANY);
        refinement.triangulation.check();
        prop_assert!(refinement.triangulation.vertex_count() <= 3 + 10_060);
    }
}

#[test]
fn vertices_at_circumcentres_on_edges_of_the_input_leave_no_triangle_without_area() {
    // Right triangles, as CAD parts have them: their circumcentres lie on the diagonal.
    for width in [1.0, 1.5, 2.0, 4.0, 8.0] {
        let points = [[0.0, 0.0, 0.0], [width, 0.0, 0.0], [width, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(4, &[[0, 1, 2], [0, 2, 3]]).unwrap();
        for largest in [0.4, 0.2, 0.1, 0.05] {
            let refinement =
                refine(&mesh, &Metric::from_points(&mesh, &points), TriangleSize { largest, at: None, small: 0.0 });
            let at = refinement.common.positions(&mesh, &points);
            let area = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|v| at[v as usize]);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            };
            let least = refinement.common.triangles.iter().map(area).fold(f64::INFINITY, f64::min);
            assert!(least > 1e-9, "{width}, {largest}: {least:e}");
        }
    }
}

#[test]
fn a_plane_face_keeps_its_edges_where_faces_differ_or_fold_back() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Mesh::new(4, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let planar = |points: &[[f64; 3]], are_alike: bool| {
        planar_edges(&mesh, points, 1e-9, |_, _| are_alike).iter().filter(|&&is_planar| is_planar).count()
    };
    assert_eq!((planar(&points, true), planar(&points, false)), (1, 0));
    let folded = [points[0], points[1], points[2], [0.9, 0.2, 0.0]];
    assert_eq!(planar(&folded, true), 0);
}

/// A cylinder whose caps are polygons of so many corners.
fn prism(corners: u32) -> (Mesh, Vec<[f64; 3]>) {
    let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(corners);
    let rim = |z: f64| (0..corners).map(move |k| [turn(k).cos(), turn(k).sin(), z]);
    let points: Vec<[f64; 3]> = rim(0.0).chain(rim(1.0)).collect();
    let caps: [Vec<u32>; 2] = [(0..corners).rev().collect(), (corners..2 * corners).collect()];
    let around = (0..corners).map(|k| (k, (k + 1) % corners));
    let around = around.map(|(k, next)| vec![k, next, corners + next, corners + k]);
    let model = Model::from_polygons(points, caps.into_iter().chain(around)).expect("a prism");
    let surface = prepare(&model, Weld::Never).expect("a prism").surfaces.remove(0);
    (surface.mesh, surface.points)
}

#[test]
fn a_vertex_in_the_middle_of_a_large_polygon_flips_as_many_edges_as_it_takes() {
    // Its corners lie on one circle, and the first vertex put into it sees them all.
    for corners in [100, 1400, 2000] {
        let (mesh, points) = prism(corners);
        let metric = Metric::from_points(&mesh, &points);
        let size = TriangleSize { largest: 0.07, at: None, small: 0.0 };
        let refinement = refine(&mesh, &metric, size);
        check_triangulation((&mesh, &metric), size, &EdgeData::constant(mesh.edge_count(), false), &refinement);
        check_common(&mesh, &points, &refinement);
        assert!(refinement.is_complete && refinement.place.len() < 4 * points.len() + 10_000, "{corners}");
    }
}

#[test]
fn what_would_be_cut_too_often_stays_as_it_is() {
    // The first is crossed too often on the way, even if all of that could be left out; the second in the end.
    for (by, can_be_left_out) in [(1e6, true), (2e4, false)] {
        let shape = stretched(shapes::sphere(600), [1.0, 1.0, by]);
        let mesh = shape.mesh();
        let left_out = EdgeData::constant(mesh.edge_count(), can_be_left_out);
        let metric = Metric::from_points(&mesh, &shape.points);
        let roles = EdgeRoles { left_out: Some(&left_out), ..EdgeRoles::default() };
        let refinement = refine_watched(&mesh, &metric, TriangleSize::ANY, roles, Watch::NONE).unwrap();
        assert!(!refinement.is_complete, "{by}");
        assert_eq!(refinement.triangulation, *mesh.triangulation());
        assert_eq!(refinement.common.triangles.len(), mesh.face_count());
        check_common(&mesh, &shape.points, &refinement);
    }
}
