//! Of making surfaces of whatever a file holds.

use std::collections::HashSet;

use geom::{Id, Model, PrepareError, prepare};

use super::flattening::weld;

use crate::decode::{self, Bytes};

/// Any polygons become sound, connected surfaces of unit size with lengths to compute with; every triangle is on one of
/// them, once, or is named as left out; and each corner knows the model's corner that it is.
pub fn preparing(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let weld = weld(bytes);
    let (points, faces) = decode::polygons(bytes);
    let model = Model::from_polygons(points, faces).expect("coordinates are bounded and indices in range");
    let triangles = model.triangles();
    assert_eq!(triangles.len(), model.corner_count() - 2 * model.face_count());
    let prepared = match prepare(&model, weld) {
        Err(PrepareError::NoArea { faces }) => return assert_eq!(faces, model.face_count()),
        Err(error) => unreachable!("nobody stops it: {error}"),
        Ok(prepared) => prepared,
    };
    let mut seen: HashSet<u32> = prepared.left_out.iter().copied().collect();
    assert_eq!(seen.len(), prepared.left_out.len());
    for surface in &prepared.surfaces {
        surface.mesh.check();
        assert_eq!(surface.mesh.components().1, 1, "one piece");
        assert!(surface.points.iter().flatten().all(|x| x.abs() <= 0.5 + 1e-9));
        assert!(surface.metric().lengths().iter().all(|l| l.is_finite()));
        assert!(surface.metric().area(&surface.mesh) > 0.0);
        for f in surface.mesh.faces() {
            assert!(seen.insert(surface.triangle[f]), "no triangle is on two surfaces");
            let mut corners = surface.mesh.sides(f).map(|h| surface.corner[h]);
            let mut expected = triangles.corners[surface.triangle[f] as usize];
            corners.sort_unstable();
            expected.sort_unstable();
            assert_eq!(corners, expected);
        }
        for h in surface.mesh.halfedges() {
            let vertex = surface.vertex[surface.mesh.tail(h)];
            let corner = model.corners()[surface.corner[h] as usize];
            let same_place = model.points()[vertex as usize] == model.points()[corner as usize];
            assert!(
                vertex == corner || weld != geom::Weld::Never && same_place,
                "corner {} is at its vertex",
                h.index()
            );
        }
    }
    assert_eq!(seen.len(), triangles.len(), "every triangle is somewhere");
    for repair in &prepared.repairs {
        let limit = if repair.kind.is_of_faces() { model.face_count() } else { model.vertex_count() };
        assert!(repair.count > 0 && repair.first < limit, "{repair:?}");
    }
}
