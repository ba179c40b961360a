//! Laws of readers and writers that no single file of them owns.

mod collection;
mod formats;
mod gltf;
mod hostile;
mod kept;
mod round_trip;

use super::*;

/// A tetrahedron with coordinates that f32 does not have.
const TETRAHEDRON: &str = "\
v 0.1 0 0
v 1 0.2 0
v 0 1 0.3
v 0 0 -1e-1
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
";

fn obj(text: &str) -> Model {
    read_bytes(text.into(), "test.obj").unwrap()
}

fn message(bytes: impl Into<Vec<u8>>, name: &str) -> String {
    read_bytes(bytes.into(), name).expect_err("must be refused").to_string()
}

fn assert_same_surface(a: &Model, b: &Model) {
    assert_eq!(a.points(), b.points());
    assert_eq!(a.face_start(), b.face_start());
    assert_eq!(a.corners(), b.corners());
}

/// A different texture coordinate for each corner but the last two of a model, as hard to print as they come.
fn some_uv(model: &Model) -> Vec<[f64; 2]> {
    let last = model.corner_count() - 2;
    (0..=last + 1).map(|corner| (corner.min(last) as f64 + 0.1) / 3.0).map(|x| [x, 1e-7 / x]).collect()
}
