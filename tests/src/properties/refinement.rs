//! Of even triangles for any surface.

use std::f64::consts::PI;

use geom::{
    EdgeData, EdgeRoles, HalfedgeId, Id, LEAST_ANGLE, Mesh, Metric, Refinement, StraightPath, SurfacePoint,
    TriangleSize, VertexId, Watch, angle_defects, refine_watched,
};

use super::{assert_close, metric_of};
use crate::decode::{self, Bytes};

/// By how much, in radians, an angle of a triangle with sides near to rounding may be less than the least.
const ROUNDING: f64 = 1e-6;

/// A refinement is the same surface, in even triangles: its vertices stay where they are, area and curvature are as before, angles
/// have the least that is promised but at narrow corners, each triangle of the input is covered once by the triangles that both
/// cut it into, and edges that are held are covered by edges. It ends. All of this but the angles stays so where paths are made straight, and none of these is lost.
pub fn refinement(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let shape = decode::surface(&mut bytes);
    let mesh = shape.mesh();
    let metric = metric_of(&mesh, &shape);
    let held: EdgeData<bool> = mesh.edges().map(|_| bytes.below(4) == 1).collect();
    let refined = |straight: &[StraightPath]| {
        let roles = EdgeRoles { held: Some(&held), straight, ..EdgeRoles::default() };
        refine_watched(&mesh, &metric, TriangleSize::ANY, roles, Watch::NONE).expect("nobody says stop")
    };
    let refinement = refined(&[]);
    is_refinement(&mesh, (&metric, &held), &refinement, true);
    let paths = paths(&refinement, &mut bytes);
    if refinement.is_complete && !paths.is_empty() {
        let straight = refined(&paths);
        is_refinement(&mesh, (&metric, &held), &straight, false);
        let is_there = |number: u32| straight.path.contains(&Some(number));
        assert!(!straight.is_complete || (0..paths.len() as u32).all(is_there));
    }
}

/// Paths over a refined surface that touch only at their ends.
fn paths(refinement: &Refinement, bytes: &mut Bytes) -> Vec<StraightPath> {
    let mesh = Mesh::from_triangulation(refinement.triangulation.clone()).expect("it is a manifold");
    let mut is_taken: Vec<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
    let mut ends: Vec<VertexId> = Vec::new();
    let mut paths = Vec::new();
    for _ in 0..bytes.below(4) {
        let mut at = match ends.is_empty() || bytes.below(2) == 0 {
            true => VertexId::new(bytes.below(mesh.vertex_count())),
            false => ends[bytes.below(ends.len())],
        };
        if is_taken[at.index()] && !ends.contains(&at) {
            continue;
        }
        is_taken[at.index()] = true;
        let (first, mut halfedges) = (at, Vec::new());
        for _ in 0..1 + bytes.below(12) {
            let free: Vec<HalfedgeId> = mesh.outgoing(at).filter(|&h| !is_taken[mesh.head(h).index()]).collect();
            if free.is_empty() {
                break;
            }
            let h = free[bytes.below(free.len())];
            at = mesh.head(h);
            is_taken[at.index()] = true;
            halfedges.push(h);
        }
        if !halfedges.is_empty() {
            ends.extend([first, at]);
            paths.push(StraightPath { halfedges, may_slide: bytes.below(2) == 1 });
        }
    }
    paths
}

fn is_refinement(mesh: &Mesh, (metric, held): (&Metric, &EdgeData<bool>), refinement: &Refinement, is_even: bool) {
    let Refinement { triangulation, metric: fine, place, is_complete, .. } = refinement;
    triangulation.check();
    assert_eq!(triangulation.euler_characteristic(), mesh.euler_characteristic());
    assert!(triangulation.vertex_count() <= 32 * mesh.vertex_count() + 15_500, "there is a cap");
    assert!(mesh.vertices().all(|v| place[v] == SurfacePoint::Vertex(v)), "the input's vertices stay");
    let longest = metric.lengths().iter().fold(0.0_f64, |most, &l| most.max(l));
    // Slivers round by more: 1.03e-9 was seen.
    assert_close(fine.area(triangulation), metric.area(mesh), 1e-8, longest * longest);

    let refined = Mesh::from_triangulation(triangulation.clone()).expect("it is a manifold");
    let total: f64 = angle_defects(&refined, fine).iter().sum();
    assert_close(total, 2.0 * PI * mesh.euler_characteristic() as f64, 1e-9, refined.face_count() as f64);
    let sums = metric.angle_sums(mesh);
    let is_narrow = |v: VertexId| sums.get(v.index()).is_some_and(|sum| *sum < PI / 3.0);
    if is_even && *is_complete && !held.contains(&true) {
        for h in triangulation.halfedges().filter(|&h| !is_narrow(triangulation.tail(h))) {
            let angle = fine.angle(triangulation, h);
            assert!(angle > LEAST_ANGLE - ROUNDING, "{h:?} has {angle}");
        }
    }
    is_covered_once(mesh, refinement);
    is_held(mesh, (metric, held), refinement);
}

/// The edges that run along one that is held are as long as it together.
fn is_held(mesh: &Mesh, (metric, held): (&Metric, &EdgeData<bool>), refinement: &Refinement) {
    let mut parts = EdgeData::constant(mesh.edge_count(), 0.0);
    for (e, along) in refinement.along.iter_ids() {
        if let Some(h) = *along {
            parts[mesh.edge(h)] += refinement.metric.length(e);
        }
    }
    let held = mesh.edges().filter(|&e| held[e]);
    held.for_each(|e| assert_close(parts[e], metric.length(e), 1e-9, metric.length(e)));
}

/// Areas in barycentric coordinates of what lies on each triangle of the input sum to that of the whole, none turned over.
fn is_covered_once(mesh: &Mesh, refinement: &Refinement) {
    let common = &refinement.common;
    let mut covered = vec![0.0; mesh.face_count()];
    for (f, triangle) in common.triangles.iter_ids() {
        let home = common.input[f];
        let [a, b, c] = triangle.map(|v| common.place[VertexId(v)].barycentric(mesh, home));
        let area = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
        assert!(area > -1e-9, "{f:?} is turned over: {area}");
        covered[home.index()] += area;
    }
    covered.iter().for_each(|&area| assert_close(area, 1.0, 1e-7, 1.0));
}
