//! Of even triangles for any surface.

use std::f64::consts::PI;

use geom::{
    EdgeData, EdgeRoles, Id, LEAST_ANGLE, Mesh, Metric, Refinement, SurfacePoint, TriangleSize, VertexId, Watch,
    angle_defects, refine_watched,
};

use super::{assert_close, metric_of};
use crate::decode::{self, Bytes};

/// By how much, in radians, an angle of a triangle with sides near to rounding may be less than the least.
const ROUNDING: f64 = 1e-6;

/// A refinement is the same surface, in even triangles: its vertices stay where they are, area and curvature are as before, angles
/// have the least that is promised but at narrow corners, each triangle of the input is covered once by the triangles that both
/// cut it into, and edges that are held are covered by edges. It ends.
pub fn refinement(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let shape = decode::surface(&mut bytes);
    let mesh = shape.mesh();
    let metric = metric_of(&mesh, &shape);
    let held: EdgeData<bool> = mesh.edges().map(|_| bytes.below(4) == 1).collect();
    let roles = EdgeRoles { held: Some(&held), left_out: None };
    let refinement = refine_watched(&mesh, &metric, TriangleSize::ANY, roles, Watch::NONE).expect("nobody says stop");
    let Refinement { triangulation, metric: fine, place, is_complete, .. } = &refinement;
    triangulation.check();
    assert_eq!(triangulation.euler_characteristic(), mesh.euler_characteristic());
    assert!(triangulation.vertex_count() <= 21 * mesh.vertex_count() + 10_000, "there is a cap");
    assert!(mesh.vertices().all(|v| place[v] == SurfacePoint::Vertex(v)), "the input's vertices stay");
    let longest = metric.lengths().iter().fold(0.0_f64, |most, &l| most.max(l));
    // Slivers round by more: 1.03e-9 was seen.
    assert_close(fine.area(triangulation), metric.area(&mesh), 1e-8, longest * longest);

    let refined = Mesh::from_triangulation(triangulation.clone()).expect("it is a manifold");
    let total: f64 = angle_defects(&refined, fine).iter().sum();
    assert_close(total, 2.0 * PI * mesh.euler_characteristic() as f64, 1e-9, refined.face_count() as f64);
    let sums = metric.angle_sums(&mesh);
    let is_narrow = |v: VertexId| sums.get(v.index()).is_some_and(|sum| *sum < PI / 3.0);
    if *is_complete && !held.contains(&true) {
        for h in triangulation.halfedges().filter(|&h| !is_narrow(triangulation.tail(h))) {
            let angle = fine.angle(triangulation, h);
            assert!(angle > LEAST_ANGLE - ROUNDING, "{h:?} has {angle}");
        }
    }
    is_covered_once(&mesh, &refinement);
    is_held(&mesh, (&metric, &held), &refinement);
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
