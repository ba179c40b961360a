//! Of reading files.

use geom::io::{ObjContent, read_bytes, write_obj};

/// Any bytes are read or refused with a sentence that names the file; what was read keeps a model's promises.
pub fn reading(bytes: &[u8], name: &str) {
    match read_bytes(bytes.to_vec(), name) {
        Err(error) => assert!(error.to_string().starts_with(name), "{error}"),
        Ok(model) => {
            assert!(model.vertex_count() > 0 && model.face_count() > 0);
            assert!(model.points().iter().flatten().all(|x| x.abs() <= geom::MAX_COORDINATE));
            assert!(model.corners().iter().all(|&v| (v as usize) < model.vertex_count()));
            assert!(model.faces().all(|face| face.len() >= 3));
            assert_eq!(model.triangles().len(), model.corner_count() - 2 * model.face_count());
        }
    }
}

/// An OBJ comes back line for line, with nothing but texture coordinates added: what is read from it again has the same
/// points and faces, and the map that was added.
pub fn obj_is_given_back(bytes: &[u8]) {
    let Ok(model) = read_bytes(bytes.to_vec(), "fuzz.obj") else { return };
    if model.obj_text().is_none() {
        return;
    }
    let uv: Vec<[f64; 2]> = (0..model.corner_count()).map(|c| [c as f64 / 7.0, -0.125 * (c % 5) as f64]).collect();
    let mut out = Vec::new();
    let content = ObjContent { uv: Some(&uv), ..ObjContent::default() };
    write_obj(&model, &content, &mut out).expect("one position a corner, and memory takes everything");
    let again = read_bytes(out, "written.obj").expect("what is written can be read");
    assert_eq!(again.points(), model.points());
    assert_eq!((again.corners(), again.face_start()), (model.corners(), model.face_start()));
    assert_eq!(again.uv().expect("a map was added").all().as_ref(), Ok(&uv), "to the bit");
}
