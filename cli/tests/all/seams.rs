//! What a user says about seams.

use crate::folder::{Folder, stderr, stdout};
use serde_json::Value;

fn report(folder: &Folder, args: &[&str]) -> Value {
    serde_json::from_str(&stdout(&folder.run(&[args, &["--json"]].concat()).success()))
        .expect("it is one JSON document")
}

fn number(report: &Value, pointer: &str) -> f64 {
    report.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} is a number"))
}

#[test]
fn edges_of_a_file_are_cut() {
    let folder = Folder::with_shapes();
    let first = folder.read("hare.obj").lines().find_map(|line| line.strip_prefix("f ").map(String::from));
    let first = first.expect("there is a face");
    let corners: Vec<usize> = first.split_whitespace().map(|v| v.parse::<usize>().expect("an index") - 1).collect();
    let [a, b, c] = corners[..] else { panic!("a triangle") };
    folder.write("edges.txt", &format!("# a triangle\n{a} {b}\n\n{c} {b}\n{c} {a}\n"));
    let rigid = ["unwrap", "hare.obj", "-n", "6", "-o", "out.obj", "--free-seams", "never"];
    let plain = report(&folder, &rigid);
    assert_eq!(plain["islands"].as_array().map(Vec::len), Some(1));
    let cut = report(&folder, &[&rigid[..], &["--seams", "edges.txt"]].concat());
    let faces: Vec<u64> =
        cut["islands"].as_array().expect("a list").iter().filter_map(|i| i["faces"].as_u64()).collect();
    assert!(faces.len() == 2 && faces.contains(&1), "{faces:?}");
    for pointer in ["/distortion/area_mean", "/distortion/quasi_conformal/mean"] {
        assert!((number(&plain, pointer) - number(&cut, pointer)).abs() < 1e-6, "the cut changes no distortion");
    }
}

#[test]
fn the_line_of_an_edge_that_is_none_is_named() {
    let folder = Folder::with_shapes();
    folder.run(&["shape", "terrain", "--vertices", "400", "-o", "terrain.obj"]).success();
    for (option, text, expected) in [
        ("--seams", "0 1\nx\n", "edges.txt, line 2: \"x\" is not an edge"),
        ("--avoid", "# none\n4 99999\n", "edges.txt, line 2: there is no edge from vertex 4 to 99999"),
        ("--seams", "7 7\n", "edges.txt, line 1: \"7 7\" is not an edge"),
    ] {
        folder.write("edges.txt", text);
        for refined in [&[][..], &["--refine"]] {
            let args = [&["unwrap", "hare.obj", "-o", "out.obj", option, "edges.txt"], refined].concat();
            let said = folder.complaint(&args);
            let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(said.contains(expected) && !said.contains("even triangles"), "{said}");
        }
    }
    // The first edge of the boundary: one that a single face has.
    let faces: Vec<Vec<u32>> = folder
        .read("terrain.obj")
        .lines()
        .filter_map(|line| line.strip_prefix("f "))
        .map(|face| face.split_whitespace().map(|v| v.parse::<u32>().expect("an index") - 1).collect())
        .collect();
    let sides = || faces.iter().flat_map(|f| (0..3).map(|k| [f[k], f[(k + 1) % 3]]));
    let rim = sides().find(|&[a, b]| !sides().any(|side| side == [b, a])).expect("there is a boundary");
    folder.write("edges.txt", &format!("{} {}\n", rim[0], rim[1]));
    for refined in [&[][..], &["--refine"]] {
        let args = [&["unwrap", "terrain.obj", "-o", "out.obj", "--seams", "edges.txt"], refined].concat();
        let said = stderr(&folder.run(&args).success());
        assert!(said.contains("the edge that was to be cut is on the boundary"), "{said}");
    }
    folder.complaint(&["unwrap", "terrain.obj", "-o", "out.obj", "--seams", "missing.txt"]);
    folder.complaint(&["unwrap", "terrain.obj", "-o", "edges.txt", "--seams", "edges.txt"]);
}

#[test]
fn seams_that_a_file_has_are_kept() {
    let folder = Folder::with_shapes();
    let first = report(&folder, &["unwrap", "hare.obj", "-n", "6", "--seam-weight", "1", "-o", "first.obj"]);
    let again = ["unwrap", "first.obj", "-n", "6", "--seam-weight", "0", "-o", "second.obj"];
    let keeping = |options: &[&str]| report(&folder, &[&again[..], &["--keep-seams"], options].concat());
    let (least, kept) = (report(&folder, &again), keeping(&["--free-seams", "never"]));
    let figures = |report: &Value| ["/distortion/seam_length", "/seams/turning"].map(|at| number(report, at));
    for (kept, first) in figures(&kept).into_iter().zip(figures(&first)) {
        assert!((kept - first).abs() < 1e-6, "{kept} and {first}");
    }
    assert!(figures(&least)[0] < figures(&first)[0] && figures(&least)[1] > figures(&first)[1]);
    // Opened along them the surface needs no cones.
    let alone = ["unwrap", "first.obj", "-n", "0", "-o", "alone.obj", "--keep-seams"];
    let alone = report(&folder, &alone);
    assert_eq!(alone["cones"].as_array().map(Vec::len), Some(0));
    assert!((figures(&alone)[0] - figures(&first)[0]).abs() < 1e-6);
    let said = folder.complaint(&["unwrap", "hare.obj", "-o", "out.obj", "--keep-seams"]);
    assert!(said.contains("texture coordinates"), "{said}");
}

#[test]
fn seams_that_should_tile_do_or_it_is_said() {
    let folder = Folder::with_shapes();
    for order in ["4", "6"] {
        let report = report(&folder, &["unwrap", "hare.obj", "-n", "12", "-o", "out.obj", "--quantize", order]);
        let tiling = &report["seams"]["tiling"];
        assert_eq!((&tiling["order"], &tiling["broken"]), (&order.parse::<u32>().expect("a number").into(), &0.into()));
        assert!(number(tiling, "/seams") >= 1.0 && number(tiling, "/error") < 1e-9);
    }
    folder.run(&["shape", "torus-2", "--vertices", "500", "-o", "torus.obj"]).success();
    let done = folder.run(&["unwrap", "torus.obj", "-n", "6", "-o", "out.obj", "--quantize", "4"]).success();
    assert!(stderr(&done).contains("does not keep its directions"), "{}", stderr(&done));
    assert!(stdout(&done).contains("tiling"), "{}", stdout(&done));
    folder.run(&["unwrap", "hare.obj", "-o", "out.obj", "--quantize", "5"]).code(2);
    let free = folder.run(&["unwrap", "hare.obj", "-o", "no.obj", "--quantize", "4", "--free-seams", "always"]).code(2);
    assert!(stderr(&free).contains("leave one of the two out"), "{}", stderr(&free));
    assert!(!folder.path("no.obj").exists());
    folder.run(&["unwrap", "hare.obj", "-o", "out.obj", "--seam-weight", "2"]).code(2);
}

#[test]
fn a_checkerboard_comes_with_an_obj() {
    let folder = Folder::with_shapes();
    folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "out.obj", "--checker"]).success();
    let text = folder.read("out.obj");
    assert!(text.contains("mtllib out.mtl") && text.contains("usemtl checker"));
    assert!(folder.read("out.mtl").contains("map_Kd out.png"));
    assert!(std::fs::read(folder.path("out.png")).expect("it is there").starts_with(b"\x89PNG"));
    let said = folder.complaint(&["unwrap", "hare.obj", "-n", "6", "-o", "out.ply", "--checker"]);
    assert!(said.contains("--checker"), "{said}");
    let twice = ["unwrap", "hare.obj", "-o", "out.obj", "--checker", "--picture", "out.png"];
    assert!(folder.complaint(&twice).contains("--checker writes its board"));
}

#[test]
fn a_missing_file_of_edges_or_cones_is_told_as_a_missing_mesh_is() {
    let folder = Folder::with_shapes();
    for option in ["--seams", "--avoid", "--cones"] {
        let complaint = folder.complaint(&["unwrap", "hare.obj", "-o", "x.obj", option, "missing.txt"]);
        assert_eq!(complaint, "error: missing.txt: there is no such file\n");
    }
}

#[test]
fn edges_that_are_named_are_edges_of_even_triangles() {
    let folder = Folder::with_shapes();
    folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "before.obj"]).success();
    let refined = ["unwrap", "before.obj", "-n", "6", "--refine", "-o", "out.obj"];
    let said = stderr(&folder.run(&[&refined[..], &["--keep-seams"]].concat()).success());
    assert!(!said.contains("seams"), "{said}");
    let faces = folder.read("before.obj");
    let face = faces.lines().find_map(|line| line.strip_prefix("f ")).expect("there is a face");
    let corners: Vec<usize> = face.split_whitespace().map(vertex).collect();
    let sides = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| format!("{} {}\n", corners[a], corners[b]));
    folder.write("edges.txt", &sides.concat());
    for option in ["--seams", "--avoid"] {
        folder.run(&[&refined[..], &[option, "edges.txt"]].concat()).success();
    }
}

/// The vertex, from 0, of a corner in an OBJ.
fn vertex(corner: &str) -> usize {
    corner.split('/').next().and_then(|v| v.parse::<usize>().ok()).expect("an index") - 1
}
