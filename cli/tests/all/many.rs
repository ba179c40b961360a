//! Many files, pipes, and what formats keep.

use crate::folder::{Folder, PROGRAM, stderr, stdout};
use serde_json::Value;
use std::fs;
use std::process::{Command as Process, Stdio};

/// The lines of JSON on standard output.
fn json_lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).expect("each line is a document")).collect()
}

#[test]
fn an_error_in_one_file_stops_no_other_and_is_the_exit_code() {
    let folder = Folder::with_shapes();
    folder.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    let args = ["unwrap", "hare.obj", "bad.obj", "none.ply", "sphere.obj", "-n", "4", "--out-dir", "out"];
    let done = folder.run(&args).code(1);
    let (said, complaint) = (stdout(&done), stderr(&done));
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines[0].starts_with("hare.obj → out/hare.obj: 4 cones, area "), "{said}");
    assert!(lines[1].starts_with("sphere.obj → out/sphere.obj: 4 cones"), "in the order of the command line: {said}");
    assert!(said.contains("surfaces  2 of 4 unwrapped, 2 not"), "{said}");
    assert!(
        complaint.contains("error: bad.obj, line 2: ") && complaint.contains("error: none.ply: there is no such file")
    );
    assert!(
        complaint.ends_with("error: 2 of 4 surfaces could not be unwrapped: see the errors above\n"),
        "{complaint}"
    );
    let mut names: Vec<_> = fs::read_dir(folder.path("out")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["hare.obj", "sphere.obj"], "nothing is left of what failed");
}

#[test]
fn where_no_surface_could_be_unwrapped_nothing_is_said_of_maps() {
    let folder = Folder::new();
    folder.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    let said = stdout(&folder.run(&["unwrap", "bad.obj", "--out-dir", "out"]).code(1));
    assert!(said.contains("surfaces  0 of 1 unwrapped, 1 not\n") && !said.contains("overlap"), "{said}");
}

#[test]
fn files_are_the_same_alone_together_and_at_the_same_time() {
    let folder = Folder::with_shapes();
    folder.run(&["unwrap", "hare.obj", "-n", "5", "-o", "alone.obj"]).success();
    for (out, jobs, threads) in [("one", "1", "3"), ("two", "2", "1"), ("three", "3", "4")] {
        let args =
            ["unwrap", "hare.obj", "sphere.obj", "-n", "5", "--out-dir", out, "--jobs", jobs, "--threads", threads];
        let done = folder.run(&args).success();
        assert_eq!(stderr(&done), "");
        assert_eq!(folder.read(&format!("{out}/hare.obj")), folder.read("alone.obj"));
    }
}

#[test]
fn the_same_name_in_two_folders_is_two_files_and_the_same_file_twice_an_error() {
    let folder = Folder::with_shapes();
    for place in ["a", "b"] {
        fs::create_dir(folder.path(place)).unwrap();
        fs::copy(folder.path("hare.obj"), folder.path(&format!("{place}/x.obj"))).unwrap();
    }
    folder.run(&["unwrap", "a/x.obj", "b/x.obj", "-n", "4", "--out-dir", "out", "-q"]).success();
    assert_eq!(folder.read("out/a/x.obj"), folder.read("out/b/x.obj"));
    for again in ["a/x.obj", "./a/x.obj", "b/../a/x.obj"] {
        let complaint = folder.complaint(&["unwrap", "a/x.obj", "hare.obj", again, "-n", "4", "--out-dir", "twice"]);
        assert_eq!(complaint, format!("error: {again} is named twice: name each surface once\n"));
        assert!(!folder.path("twice").exists());
    }
    let complaint = folder.complaint(&["unwrap", "a/x.obj", "b/x.obj", "hare.obj", "-n", "4", "--out-dir", ".", "-q"]);
    assert!(complaint.contains("x.obj is the input, which is never overwritten"), "{complaint}");
    assert!(!folder.read("a/x.obj").contains("vt "));
}

#[test]
fn json_is_a_line_for_each_file_and_one_for_all() {
    let folder = Folder::with_shapes();
    folder.write("bad.off", "OFF\n");
    let args = ["unwrap", "hare.obj", "bad.off", "-n", "4", "--out-dir", "out", "--format", "glb", "--json"];
    let lines = json_lines(&stdout(&folder.run(&args).code(1)));
    assert_eq!(lines.len(), 3);
    assert_eq!((&lines[0]["input"], &lines[0]["output"]), (&"hare.obj".into(), &"out/hare.glb".into()));
    assert_eq!(lines[0]["report"]["cones"].as_array().map(Vec::len), Some(4));
    assert!(lines[0]["error"].is_null() && lines[1]["report"].is_null() && lines[1]["output"].is_null());
    assert!(lines[1]["error"].as_str().is_some_and(|error| error.starts_with("bad.off")), "{}", lines[1]);
    assert_eq!((&lines[2]["summary"]["unwrapped"], &lines[2]["summary"]["failed"]), (&1.into(), &1.into()));
}

#[test]
fn what_is_for_one_surface_is_refused_for_several() {
    let folder = Folder::with_shapes();
    let several = ["unwrap", "hare.obj", "sphere.obj"];
    let refused = |more: &[&str]| stderr(&folder.run(&[&several, more].concat()).code(2));
    assert!(refused(&["-o", "x.obj"]).contains("--out-dir"));
    fs::create_dir(folder.path("there")).unwrap();
    let complaint = folder.complaint(&["unwrap", "hare.obj", "-o", "there"]);
    assert!(complaint.contains("there is a folder") && complaint.contains("--out-dir in place of -o"), "{complaint}");
    for command in ["pack", "islands"] {
        let complaint = folder.complaint(&[command, "hare.obj", "-o", "there"]);
        assert_eq!(complaint, "error: there is a folder: name a file in it\n");
    }
    fs::remove_dir(folder.path("there")).unwrap();
    assert!(refused(&["--out-dir", "d", "-o", "x.obj"]).contains("cannot be used with"));
    assert!(refused(&["--out-dir", "d", "--report", "x.json"]).contains("cannot be used with"));
    let neither = stderr(&folder.run(&["unwrap", "hare.obj"]).code(2));
    assert!(neither.contains("--output <OUT>") && neither.contains("--out-dir <FOLDER>"), "{neither}");
    assert!(refused(&["--jobs", "2", "-o", "x.obj"]).contains("cannot be used with"));
    for option in [["--view", "front"], ["--size", "300"], ["--colour", "area"]] {
        assert!(refused(&[&["--out-dir", "d"][..], &option].concat()).contains("cannot be used with"), "{option:?}");
    }
    assert_eq!(folder.names(), ["hare.obj", "sphere.obj"]);
}

#[test]
fn a_value_that_needs_an_equals_sign_is_no_second_surface() {
    let folder = Folder::with_shapes();
    for (option, value) in [("--refine", "always"), ("--refine", "needles"), ("--weld", "never"), ("--weld", "auto")] {
        for target in [&["-o", "x.obj"][..], &["--out-dir", "d"]] {
            let said = stderr(&folder.run(&[&["unwrap", "hare.obj", option, value], target].concat()).code(2));
            assert!(said.contains(&format!("write {option}={value}")) && !said.contains("several"), "{said}");
        }
        let said = stderr(&folder.run(&["extract", "hare.obj", option, value]).code(2));
        assert!(said.contains(&format!("write {option}={value}")), "{said}");
    }
    assert_eq!(folder.names(), ["hare.obj", "sphere.obj"]);
    // A file of that name is a file.
    fs::copy(folder.path("sphere.obj"), folder.path("always")).unwrap();
    folder.run(&["extract", "-n", "4", "--refine", "always"]).success();
}

#[test]
fn surfaces_come_and_go_through_pipes() {
    let folder = Folder::with_shapes();
    folder.run(&["unwrap", "hare.obj", "-n", "4", "-o", "file.ply"]).success();
    let input = fs::File::open(folder.path("hare.obj")).unwrap();
    let done = Process::new(PROGRAM)
        .args(["unwrap", "-", "-n", "4", "-o", "-", "--format", "ply"])
        .current_dir(folder.root())
        .stdin(Stdio::from(input))
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert_eq!(done.stdout, fs::read(folder.path("file.ply")).unwrap());
    assert!(String::from_utf8_lossy(&done.stderr).contains("written   -"), "the summary makes way for the surface");
    let empty = Process::new(PROGRAM).args(["unwrap", "-", "-o", "-"]).stdin(Stdio::null()).output().unwrap();
    assert_eq!((empty.status.code(), empty.stdout.len()), (Some(1), 0));
    assert!(String::from_utf8_lossy(&empty.stderr).contains("standard input: the file is empty"));
    let complaint = folder.complaint(&["unwrap", "hare.obj", "-o", "-", "--json"]);
    assert!(complaint.contains("two outputs"), "{complaint}");
}

#[test]
fn every_format_is_read_again_compressed_or_not_with_the_same_map() {
    let folder = Folder::with_shapes();
    let measure = |file: &str| -> Value {
        let printed = stdout(&folder.run(&["measure", file, "--json"]).success());
        serde_json::from_str(&printed).expect("it is one JSON document")
    };
    folder.run(&["unwrap", "hare.obj", "-n", "4", "-o", "out.obj"]).success();
    let expected = measure("out.obj");
    for file in ["out.ply", "out.glb", "out.obj.gz", "out.ply.gz", "out.GLB.gz"] {
        folder.run(&["unwrap", "hare.obj", "-n", "4", "-o", file]).success();
        let bytes = fs::read(folder.path(file)).unwrap();
        assert_eq!(bytes.starts_with(b"\x1f\x8b"), file.ends_with("gz"), "{file}");
        let found = measure(file);
        for key in ["vertices", "faces"] {
            assert_eq!(found["input"][key], expected["input"][key], "{file} {key}");
        }
        assert_eq!(found["islands"].as_array().map(Vec::len), expected["islands"].as_array().map(Vec::len), "{file}");
        let of = |document: &Value| document["distortion"]["area_mean"].as_f64().unwrap();
        assert!((of(&found) - of(&expected)).abs() < 1e-4, "{file}");
    }
    folder.run(&["pack", "out.glb", "-o", "packed.ply.gz"]).success();
    folder.run(&["islands", "out.ply.gz", "-o", "apart.glb"]).success();
    let complaint = folder.complaint(&["unwrap", "hare.obj", "-o", "out.stl.gz"]);
    assert!(complaint.contains("end it in .obj, .ply or .glb before .gz"), "{complaint}");
    let complaint = folder.complaint(&["unwrap", "hare.obj", "-o", "out.obj", "--format", "ply"]);
    assert!(complaint.contains("end it in .ply"), "{complaint}");
}

#[test]
fn what_a_format_does_not_hold_is_one_line_and_in_the_report() {
    let folder = Folder::with_shapes();
    let text = folder.read("hare.obj");
    folder.write("named.obj", &format!("usemtl skin\n{text}"));
    let done = folder.run(&["unwrap", "named.obj", "-n", "4", "-o", "out.ply", "--report", "report.json"]).success();
    let line = "not kept in PLY: materials (skin)";
    assert_eq!(stderr(&done), format!("warning: {line}\n"));
    assert_eq!(folder.json("report.json")["warnings"], Value::from(vec![line]));
    let done = folder.run(&["unwrap", "named.obj", "-n", "4", "-o", "out.glb"]).success();
    assert_eq!(stderr(&done), "");
    assert!(String::from_utf8_lossy(&fs::read(folder.path("out.glb")).unwrap()).contains(r#""name":"skin""#));
}

#[test]
fn a_refined_surface_has_colours_and_normals_between_those_of_the_file() {
    let folder = Folder::new();
    folder.run(&["shape", "part", "--vertices", "300", "-o", "part.obj"]).success();
    let text: String = folder
        .read("part.obj")
        .lines()
        .map(|line| if line.starts_with("v ") { format!("{line} 0.4 0.4 0.4\n") } else { format!("{line}\n") })
        .collect();
    folder.write("part.obj", &text);
    folder.run(&["unwrap", "part.obj", "-n", "8", "--refine=always", "-o", "out.ply", "-q"]).success();
    let ply = fs::read(folder.path("out.ply")).unwrap();
    let header = String::from_utf8_lossy(&ply[..600]).into_owned();
    assert!(
        header.contains("property uint8 red\nproperty uint8 green\nproperty uint8 blue\nproperty float s\n"),
        "{header}"
    );
    folder.run(&["unwrap", "out.ply", "-n", "8", "-o", "again.obj", "-q"]).success();
    let colours: Vec<String> = folder
        .read("again.obj")
        .lines()
        .filter(|line| line.starts_with("v "))
        .map(|line| line.split(' ').skip(4).collect::<Vec<_>>().join(" "))
        .collect();
    assert!(colours.len() > 300 && colours.iter().all(|colour| colour == "0.4 0.4 0.4"), "{:?}", colours[0]);
}
