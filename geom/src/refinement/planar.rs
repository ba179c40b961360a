//! Edges inside plane regions of a surface, which nobody would miss.

use std::collections::VecDeque;

use crate::mesh::{EdgeData, FaceData, FaceId, Id, Triangulation, VertexId};
use crate::vector::{Vec3, cross, distance, dot, length, scale, sub};

/// The inner edges with the same plane region on both sides. A region is a triangle with what hangs on it as long as all vertices
/// are within `tolerance` of that triangle's plane, nothing is turned over, and `are_alike` says of both triangles of an edge that nobody
/// needs it. Largest triangles begin. O(n log n) for n triangles.
///
/// # Panics
/// If there are fewer points than vertices.
pub fn planar_edges(
    mesh: &Triangulation,
    points: &[Vec3],
    tolerance: f64,
    are_alike: impl Fn(FaceId, FaceId) -> bool,
) -> EdgeData<bool> {
    let point = |v: VertexId| points[v.index()];
    let normal = |f: FaceId| {
        let [a, b, c] = mesh.corners(f).map(point);
        cross(sub(b, a), sub(c, a))
    };
    let twice_area: FaceData<f64> = mesh.faces().map(|f| length(normal(f))).collect();
    let mut by_size: Vec<FaceId> = mesh.faces().collect();
    by_size.sort_by(|&f, &g| twice_area[g].total_cmp(&twice_area[f]));
    let mut region: FaceData<Option<FaceId>> = FaceData::constant(mesh.face_count(), None);
    for first in by_size {
        if region[first].is_some() || twice_area[first] <= 0.0 {
            continue;
        }
        let up = scale(normal(first), 1.0 / twice_area[first]);
        let origin = point(mesh.corners(first)[0]);
        let is_near = |v: VertexId| dot(sub(point(v), origin), up).abs() <= tolerance;
        // What is turned over by no more than vertices may be off does not count.
        let is_upright = |f: FaceId| {
            let sides = mesh.sides(f).map(|h| distance(point(mesh.head(h)), point(mesh.tail(h))));
            dot(normal(f), up) >= -tolerance * sides.into_iter().fold(0.0, f64::max)
        };
        region[first] = Some(first);
        let mut queue = VecDeque::from([first]);
        while let Some(f) = queue.pop_front() {
            for g in mesh.sides(f).into_iter().filter_map(|h| mesh.twin(h)) {
                let beyond = mesh.face(g);
                let joins = region[beyond].is_none()
                    && are_alike(f, beyond)
                    && is_near(mesh.head(mesh.next(g)))
                    && is_upright(beyond);
                if joins {
                    region[beyond] = Some(first);
                    queue.push_back(beyond);
                }
            }
        }
    }
    let is_inside = |h| {
        let [f, g] = [Some(h), mesh.twin(h)].map(|h| h.map(|h| mesh.face(h)));
        f.zip(g).is_some_and(|(f, g)| region[f].is_some() && region[f] == region[g] && are_alike(f, g))
    };
    mesh.edges().map(|e| is_inside(mesh.halfedge(e))).collect()
}
