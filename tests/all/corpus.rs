//! The inputs that fuzzing begins with and those that it found, replayed on stable.

use std::fs;
use std::path::{Path, PathBuf};

use tests::properties;

/// The files of a fuzz target: its corpus and its regressions.
fn inputs(target: &str) -> Vec<PathBuf> {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz");
    let files = |folder: &str| {
        let entries = fs::read_dir(fuzz.join(folder).join(target)).into_iter().flatten();
        entries.map(|entry| entry.expect("a readable folder").path()).collect::<Vec<_>>()
    };
    let mut inputs = [files("corpus"), files("regressions")].concat();
    inputs.sort();
    inputs
}

fn replay(target: &str, law: impl Fn(&[u8])) {
    let inputs = inputs(target);
    assert!(!inputs.is_empty(), "{target} has a corpus");
    for input in inputs {
        eprintln!("{}", input.display()); // shown where a test fails: the last one is at fault
        law(&fs::read(input).expect("a readable file"));
    }
}

#[test]
fn obj_files_are_read_or_refused() {
    replay("obj", properties::obj);
}

#[test]
fn off_files_are_read_or_refused() {
    replay("off", |bytes| properties::reading(bytes, "a.off"));
}

#[test]
fn ply_files_are_read_or_refused() {
    replay("ply", |bytes| properties::reading(bytes, "a.ply"));
}

#[test]
fn stl_files_are_read_or_refused() {
    replay("stl", |bytes| properties::reading(bytes, "a.stl"));
}

#[test]
fn fields_are_paired() {
    replay("field", properties::field);
}

#[test]
fn polygons_are_prepared() {
    replay("prepare", properties::preparing);
}

#[test]
fn surfaces_are_refined() {
    replay("refine", properties::refinement);
}

#[test]
fn insulted_meshes_unwrap() {
    replay("unwrap", properties::insults_unwrap);
}

#[test]
fn what_can_be_read_unwraps() {
    replay("files", properties::files_unwrap);
}

#[test]
fn surfaces_flatten() {
    replay("flatten", properties::surface);
}
