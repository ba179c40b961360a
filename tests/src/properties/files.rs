//! Of reading files.

use geom::io::read_bytes;

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

/// Temporary.
pub fn obj_is_given_back(_bytes: &[u8]) {}
