//! The mesh collection, where it is at hand.

use std::path::PathBuf;

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
    let mut files: Vec<_> = entries.filter(|path| path.is_file() && Format::of_name(path).is_some()).collect();
    files.sort();
    files
}

#[test]
fn bad_files_are_read_or_refused_as_their_class_says() {
    let Some(folder) = collection() else { return };
    let plain = read(folder.join("bad/b01_crlf.obj")).unwrap();
    for path in files(&folder.join("bad")) {
        let name = path.file_name().unwrap().to_str().unwrap();
        match (name.as_bytes()[0], read(&path)) {
            (b'a', refused) if name != "a23_faces_before_vertices.obj" => {
                println!("{}", refused.expect_err(name));
            }
            (_, Err(error)) => panic!("{error}"),
            (b'a' | b'b', Ok(model)) if name != "b14_interleaved.obj" => assert_same_surface(&model, &plain),
            (_, Ok(model)) => assert_eq!(model.triangles().len(), model.corner_count() - 2 * model.face_count()),
        }
    }
}

#[test]
fn good_files_have_as_many_vertices_as_their_names_say() {
    let Some(folder) = collection() else { return };
    for path in ["", "table1", "table1_resized", "bad_real"].iter().flat_map(|sub| files(&folder.join(sub))) {
        let model = read(&path).unwrap();
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let Some(Ok(vertices)) = stem.rsplit('_').next().map(str::parse::<usize>) else { continue };
        assert_eq!(model.vertex_count(), vertices, "{stem}");
        assert!(model.skipped().is_empty(), "{stem}: {}", model.skipped());
    }
}

#[test]
fn every_file_comes_back_with_its_map() {
    let Some(folder) = collection() else { return };
    for path in ["", "bad"].iter().flat_map(|sub| files(&folder.join(sub))) {
        let Ok(model) = read(&path) else { continue };
        super::round_trip::assert_obj_comes_back(&model);
    }
}
