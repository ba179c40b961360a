//! Laws of all readers and writers together, and the mesh collection where it is at hand.

use std::fs;
use std::path::{Path, PathBuf};

use super::*;

/// The folder of meshes beside the repository, which is not part of it.
fn collection() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/meshes");
    if !folder.is_dir() {
        eprintln!("the mesh collection is not at hand: {}", folder.display());
        return None;
    }
    Some(folder)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_mesh =
        |path: &PathBuf| path.is_file() && !["json", "md"].iter().any(|e| path.extension().is_some_and(|x| x == *e));
    let mut files: Vec<_> = entries.filter(is_mesh).filter(|p| p.extension().is_some()).collect();
    files.sort();
    files
}

#[test]
fn bad_files_are_read_or_refused_as_their_class_says() {
    let Some(folder) = collection() else { return };
    let plain = read(folder.join("bad/b01_crlf.obj")).unwrap();
    for path in files(&folder.join("bad")) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let model = read(&path);
        match (name.as_bytes()[0], model) {
            (b'a', model) if name != "a23_faces_before_vertices.obj" => {
                let message = model.expect_err(name).to_string();
                println!("{}", message.replace(folder.to_str().unwrap(), ""));
            }
            (_, Err(error)) => panic!("{error}"),
            (b'a' | b'b', Ok(model)) if name != "b14_interleaved.obj" => {
                assert_eq!(model.points(), plain.points(), "{name}");
                assert_eq!(model.corners(), plain.corners(), "{name}");
            }
            (_, Ok(model)) => assert_eq!(model.triangles().len(), model.corner_count() - 2 * model.face_count()),
        }
    }
}

#[test]
fn the_collection_is_read_with_the_sizes_in_its_names() {
    let Some(folder) = collection() else { return };
    for path in ["", "table1", "table1_resized", "bad_real"].iter().flat_map(|sub| files(&folder.join(sub))) {
        let model = read(&path).unwrap();
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let Some(Ok(vertices)) = stem.rsplit('_').next().map(str::parse::<usize>) else { continue };
        assert_eq!(model.vertex_count(), vertices, "{stem}");
    }
}
