//! What once broke the command, made here or, where the collection of such files is at hand, as it was found.

use crate::folder::{Folder, PROGRAM, stderr};
use geom::Model;
use geom::distortion::measure;
use std::fs;
use std::path::Path;
use std::process::Command as Process;

/// So many numbers of cones at most are tried, in all parts of a file together.
const MOST_ATTEMPTS: usize = 40;

#[test]
fn polygons_that_are_not_convex_in_the_map_are_told_of() {
    let folder = Folder::with_shapes();
    folder.write("dart.obj", "v 4 -0.1 0\nv 0.5 0.5 0\nv -0.1 4 0\nv 0 0 0\nf 1 2 3 4\n");
    let told = stderr(&folder.run(&["unwrap", "dart.obj", "-o", "out.obj"]).success());
    assert!(
        told.contains(
            "1 polygon is not convex in the map (face 0, counted from 0): programs that cut it in another way"
        ),
        "{told}"
    );
    let two = "v 4 -0.1 0\nv 0.5 0.5 0\nv -0.1 4 0\nv 0 0 0\nv 9 -0.1 0\nv 5.5 0.5 0\nv 4.9 4 0\nv 5 0 0\nf 1 2 3 4\nf 5 6 7 8\n";
    folder.write("darts.obj", two);
    let told = stderr(&folder.run(&["unwrap", "darts.obj", "-o", "out.obj"]).success());
    assert!(told.contains("2 polygons are not convex in the map (first face 0, counted from 0)"), "{told}");
    let told = stderr(&folder.run(&["unwrap", "dart.obj", "-o", "out.obj", "--triangulate"]).success());
    assert_eq!(told, "", "triangles are what they are");
}

#[cfg(unix)]
#[test]
fn without_a_thread_to_be_had_the_work_is_done_all_the_same() {
    let folder = Folder::with_shapes();
    let run = |limit: &str, out: &str| {
        let script = format!("{limit} exec \"$0\" unwrap hare.obj -n 6 -o {out}");
        let done = Process::new("sh").args(["-c", &script, PROGRAM]).current_dir(folder.root()).output();
        let done = done.expect("there is a shell");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        folder.read(out)
    };
    // The superuser has no such limit.
    assert_eq!(run("ulimit -u 1 2>/dev/null;", "few.obj"), run("", "many.obj"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_limit_of_memory_that_is_too_low_is_told_before_the_work() {
    let folder = Folder::with_shapes();
    folder.run(&["shape", "sphere", "--vertices", "30000", "-o", "large.obj"]).success();
    let script = "ulimit -v 60000; exec \"$0\" unwrap large.obj -n 6 -o out.obj";
    let done = Process::new("sh").args(["-c", script, PROGRAM]).current_dir(folder.root()).output();
    let done = done.expect("there is a shell");
    let told = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1), "{told}");
    assert!(told.contains("vertices, which need more than"), "{told}");
    assert!(!folder.path("out.obj").exists());
}

#[test]
fn found_files_end_with_a_sentence_or_a_map_whose_flaws_are_told() {
    let finds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/meshes/finds");
    if !finds.is_dir() {
        println!("skipped: the files that were found are not at hand ({} is missing)", finds.display());
        return;
    }
    let folder = Folder::with_shapes();
    let mut files: Vec<_> = fs::read_dir(&finds).expect("a folder").map(|file| file.expect("a file").path()).collect();
    files.sort();
    for file in files {
        let name = file.file_name().and_then(|name| name.to_str()).expect("plain names").to_owned();
        if [".csv", ".png", ".md"].iter().any(|ending| name.ends_with(ending)) {
            continue;
        }
        for options in [&[][..], &["-n", "3"], &["-n", "4"]] {
            let path = file.to_str().expect("a plain path");
            let done = folder.run(&[&["unwrap", path, "-o", "found.obj"], options].concat());
            let told = stderr(&done);
            assert!(matches!(done.get_output().status.code(), Some(0 | 1)), "{name} {options:?}: {told}");
            assert!(told.matches("): trying").count() <= MOST_ATTEMPTS, "{name} {options:?}: {told}");
            if !done.get_output().status.success() {
                assert!(told.starts_with("error: ") || told.contains("\nerror: "), "{name} {options:?}: {told}");
                continue;
            }
            let flaws = flaws(&geom::io::read(folder.path("found.obj")).expect("it was written"));
            assert!(flaws == 0 || told.contains("warning: "), "{name} {options:?}: {flaws} flipped triangles");
        }
    }
}

/// The flipped triangles of a map whose polygons are cut from their first corners.
fn flaws(model: &Model) -> usize {
    let uv = model.uv().expect("it has a map").all().expect("at all corners");
    let fans = (0..model.face_count()).flat_map(|face| {
        let corners = model.face_corners(face);
        let first = corners.start;
        (first + 1..corners.end - 1).map(move |c| [first, c, c + 1])
    });
    let corners: Vec<[usize; 3]> = fans.collect();
    let triangles: Vec<[u32; 3]> = corners.iter().map(|t| t.map(|c| model.corners()[c])).collect();
    let images: Vec<_> = corners.iter().map(|t| t.map(|c| uv[c])).collect();
    measure(model.points(), &triangles, &images).map_or(0, |map| map.flipped + map.degenerate)
}
