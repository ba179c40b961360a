//! `unwrap`, `extract`, `measure`, `shape` and `demo`, and what all subcommands share.

use crate::comparing::squeezed;
use crate::folder::{Folder, PROGRAM, stderr, stdout};
use serde_json::Value;
use std::fs;
use std::process::{Command as Process, Stdio};

#[test]
fn unwrapping_returns_the_input_with_texture_coordinates_added() {
    let folder = Folder::with_shapes();
    let done = folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "out.obj"]).success();
    assert!(stdout(&done).contains("cones     6 ("), "{}", stdout(&done));
    assert_eq!(stderr(&done), "", "nothing to warn of, and no progress bar where nobody watches");
    let (before, after) = (folder.read("hare.obj"), folder.read("out.obj"));
    let vertices = |text: &str| text.lines().filter(|l| l.starts_with("v ")).map(String::from).collect::<Vec<_>>();
    let faces = |text: &str| -> Vec<Vec<String>> {
        let vertex = |corner: &str| corner.split('/').next().map(String::from);
        let corners = |line: &str| line.split_whitespace().skip(1).filter_map(vertex).collect();
        text.lines().filter(|l| l.starts_with("f ")).map(corners).collect()
    };
    assert_eq!(vertices(&before), vertices(&after));
    assert_eq!(faces(&before), faces(&after));
    let texture: Vec<f64> = after
        .lines()
        .filter_map(|line| line.strip_prefix("vt "))
        .flat_map(|line| line.split_whitespace().map(|x| x.parse::<f64>().expect("vt lines are numbers")))
        .collect();
    assert!(texture.iter().all(|x| (0.0..=1.0).contains(x)), "the unit square is the default");
    // Half of the margin of 4 texels of 1024 is left at the border.
    let widest = texture.iter().fold(0.0_f64, |most, x| most.max(*x));
    assert!((widest - (1.0 - 2.0 / 1024.0)).abs() < 1e-9, "{widest}");
}

#[test]
fn the_number_of_cones_is_found_by_the_distortion_that_is_predicted() {
    let folder = Folder::with_shapes();
    let report = |options: &[&str]| {
        let run = ["unwrap", "hare.obj", "-o", "out.obj", "--report", "report.json", "--free-seams", "never"];
        folder.run(&[&run[..], options].concat()).success();
        folder.json("report.json")
    };
    let count = |report: &serde_json::Value| report["cones"].as_array().expect("a list").len();
    let area = |report: &serde_json::Value| report["distortion"]["area_mean"].as_f64().expect("a number");
    let (plain, near) = (report(&[]), report(&["--max-distortion", "1.1"]));
    assert_eq!((&plain["number"]["target"], &near["number"]["target"]), (&1.25.into(), &1.1.into()));
    for report in [&plain, &near] {
        let target = report["number"]["target"].as_f64().expect("a number");
        assert_eq!(report["number"]["met"], area(report) <= target + 0.005, "whether the map that is written meets it");
    }
    assert_eq!(near["number"]["met"], true, "cones are added until it does");
    assert_eq!(plain["number"]["chosen"], count(&plain));
    let predicted = plain["number"]["predicted_area"].as_f64().expect("a number");
    assert!((predicted - area(&plain)).abs() < 0.03, "{predicted} is predicted, {} measured", area(&plain));
    assert!(plain["curve"].as_array().is_some_and(|curve| curve.len() > 20));
    assert!(count(&near) > count(&plain) && area(&near) < 1.102);
    assert!(report(&["-n", "6"])["number"].is_null());
}

#[test]
fn a_report_has_the_documented_keys() {
    let folder = Folder::with_shapes();
    let run = ["unwrap", "hare.obj", "-n", "6", "-o", "out.obj", "--report", "report.json", "--free-seams", "never"];
    folder.run(&run).success();
    let report = folder.json("report.json");
    for key in ["input", "repairs", "cones", "hierarchy", "curve", "distortion", "islands", "times", "warnings"] {
        assert!(!report[key].is_null(), "{key}");
    }
    assert_eq!(report["peak_memory"].as_u64().is_some_and(|bytes| bytes > 1 << 20), cfg!(target_os = "linux"));
    assert_eq!(report["schema"], 1);
    assert_eq!(report["input"]["genus"], 0);
    assert_eq!(report["input"]["euler"], 2);
    assert_eq!((&report["method"], &report["angles"]), (&"refined".into(), &"optimal".into()));
    let cones = report["cones"].as_array().expect("cones are a list");
    let total: f64 = cones.iter().filter_map(|cone| cone["curvature"].as_f64()).sum();
    assert_eq!(cones.len(), 6);
    assert!((total - 4.0 * std::f64::consts::PI).abs() < 1e-9, "Gauss–Bonnet: {total}");
    let distortion = &report["distortion"];
    assert_eq!((&distortion["flipped"], &distortion["degenerate"]), (&0.into(), &0.into()));
    assert!(distortion["quasi_conformal"]["mean"].as_f64() < Some(1.3), "{distortion}");
    assert!(distortion["curvature_error"].as_f64() < Some(1e-6), "{distortion}");
    for stage in ["read", "prepare", "factor", "hierarchy", "cut", "scale", "layout", "write"] {
        assert!(report["times"][stage].as_f64() >= Some(0.0), "{stage}");
    }
}

#[test]
fn json_on_stdout_is_the_report_and_nothing_else() {
    let folder = Folder::with_shapes();
    let run = ["unwrap", "hare.obj", "-n", "6", "-o", "out.obj", "--report", "report.json", "--json"];
    let printed = stdout(&folder.run(&run).success());
    assert_eq!(serde_json::from_str::<Value>(&printed).expect("stdout is JSON"), folder.json("report.json"));
}

#[test]
fn measuring_the_output_gives_the_report_s_figures() {
    let folder = Folder::with_shapes();
    folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "out.obj", "--report", "report.json"]).success();
    let reported = &folder.json("report.json")["distortion"];
    for reference in [&[][..], &["--reference", "hare.obj"]] {
        let printed = stdout(&folder.run(&[&["measure", "out.obj", "--json"], reference].concat()).success());
        let measured = &serde_json::from_str::<Value>(&printed).expect("stdout is JSON")["distortion"];
        for key in ["area_mean", "u_l2", "seam_length"] {
            let (a, b) = (reported[key].as_f64().expect(key), measured[key].as_f64().expect(key));
            assert!((a - b).abs() < 1e-9 * a.abs(), "{key}: {a} {b}");
        }
        assert_eq!(measured["flipped"], 0);
    }
}

#[test]
fn what_cannot_be_measured_is_said() {
    let folder = Folder::with_shapes();
    assert!(folder.complaint(&["measure", "hare.obj"]).contains("no texture coordinates"));
    folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "out.obj"]).success();
    let other = folder.complaint(&["measure", "out.obj", "--reference", "sphere.obj"]);
    assert!(other.contains("same faces"), "{other}");
}

#[test]
fn cones_written_out_and_given_back_unwrap_the_same() {
    let folder = Folder::with_shapes();
    folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "a.obj", "--cones-out", "cones.txt"]).success();
    folder.run(&["unwrap", "hare.obj", "--cones", "cones.txt", "-o", "b.obj"]).success();
    let (a, b) = (folder.read("a.obj"), folder.read("b.obj"));
    let numbers = |text: &str| -> Vec<f64> {
        text.lines()
            .filter(|l| l.starts_with("vt"))
            .flat_map(|l| l[2..].split_whitespace().flat_map(str::parse))
            .collect()
    };
    assert!(numbers(&a).iter().zip(numbers(&b)).all(|(x, y)| (x - y).abs() < 1e-7));
}

#[test]
fn a_file_of_cones_makes_the_map_again_that_it_was_written_with() {
    let folder = Folder::with_shapes();
    for (shape, options) in
        [("torus-4", &["-n", "4"]), ("terrain", &["-n", "0"]), ("hare", &["--max-distortion", "1.2"])]
    {
        folder.run(&["shape", shape, "--vertices", "1000", "-o", "in.obj"]).success();
        let first = ["unwrap", "in.obj", "-o", "a.obj", "--cones-out", "cones.txt", "--report", "r.json"];
        folder.run(&[&first[..], &options[..]].concat()).success();
        folder.run(&["unwrap", "in.obj", "-o", "b.obj", "--cones", "cones.txt"]).success();
        assert!(folder.read("a.obj") == folder.read("b.obj"), "{shape}");
        let text = folder.read("cones.txt");
        assert!(text.contains("#: vertices "), "{text}");
        assert_eq!(text.contains("#: opened "), shape == "torus-4", "{text}");
    }
}

#[test]
fn extracting_opens_handles_as_unwrapping_does() {
    let folder = Folder::with_shapes();
    folder.run(&["shape", "torus-4", "--vertices", "1000", "-o", "torus.obj"]).success();
    for number in ["2", "4"] {
        let number = ["-n", number];
        let args = [&["extract", "torus.obj", "--json", "--cones-out", "cones.txt"], &number[..]].concat();
        let extracted: Value = serde_json::from_str(&stdout(&folder.run(&args).success())).expect("stdout is JSON");
        let args = [&["unwrap", "torus.obj", "-o", "a.obj", "--report", "report.json"], &number[..]].concat();
        folder.run(&args).success();
        let report = folder.json("report.json");
        assert_eq!(extracted["cones"], report["cones"]);
        assert_eq!((&extracted["opened_handles"], &report["seams"]["opened_handles"]), (&4.into(), &4.into()));
        folder.run(&["unwrap", "torus.obj", "-o", "b.obj", "--cones", "cones.txt"]).success();
        assert!(folder.read("a.obj") == folder.read("b.obj"));
    }
}

#[test]
fn the_summary_says_how_the_cones_were_really_chosen() {
    let folder = Folder::with_shapes();
    folder.write("places", "5\n70\n140\n210\n");
    let told = |more: &[&str]| {
        let output = folder.run(&[&["unwrap", "hare.obj", "-o", "out.obj"], more].concat()).success();
        String::from_utf8_lossy(&output.get_output().stdout).into_owned()
    };
    let refined = told(&["-n", "5", "--cones-out", "cones"]);
    assert!(refined.contains("5 (method refined, optimal curvatures; "), "{refined}");
    assert!(told(&["--min-persistence", "1"]).contains("method persistence, "));
    assert!(told(&["--cones", "cones"]).contains("5 (given, given curvatures; "));
    assert!(told(&["--cones", "places"]).contains("4 (given, optimal curvatures; "));
}

#[test]
fn a_threshold_that_leaves_too_few_extrema_is_warned_of() {
    let folder = Folder::with_shapes();
    let above = |threshold: &str| {
        let args = ["unwrap", "hare.obj", "-o", "out.obj", "--min-persistence", threshold];
        stderr(&folder.run(&args).success())
    };
    assert!(
        above("100").contains("0 extrema are more persistent than 100, but this surface needs more cones: taking 3")
    );
    assert!(!above("0.5").contains("more persistent"));
}

#[test]
fn smoothing_where_no_extrema_are_looked_for_is_warned_of() {
    let folder = Folder::with_shapes();
    let is_idle = |more: &[&str]| {
        let told = ["extract", "unwrap"].map(|command| {
            let out: &[&str] = if command == "unwrap" { &["-o", "out.obj"] } else { &[] };
            stderr(&folder.run(&[&[command, "sphere.obj", "--smooth"], out, more].concat()).success())
        });
        let warning = "--smooth changes none of these cones: it acts on --method persistence and alternating, ";
        assert_eq!(told[0].contains(warning), told[1].contains(warning), "{told:?}");
        told[0].contains(warning)
    };
    for method in ["refined", "pursuit", "greedy", "iterative"] {
        assert!(is_idle(&["-n", "4", "--method", method]), "{method}");
    }
    for method in ["persistence", "alternating"] {
        assert!(!is_idle(&["-n", "4", "--method", method]), "{method}");
    }
    assert!(is_idle(&[]) && !is_idle(&["--min-persistence", "0.01"]));
}

#[test]
fn options_that_given_cones_leave_idle_are_warned_of_and_not_reported() {
    let folder = Folder::with_shapes();
    folder.write("places", "5\n70\n140\n210\n");
    folder.run(&["unwrap", "hare.obj", "-n", "5", "-o", "out.obj", "--cones-out", "cones"]).success();
    let run = |cones: &str, more: &[&str]| {
        let args = ["unwrap", "hare.obj", "-o", "out.obj", "--report", "r.json", "--cones", cones];
        let told = stderr(&folder.run(&[&args[..], more].concat()).success());
        let report = folder.json("r.json");
        let said = |key: &str| report[key].as_str().expect("it is a word").to_owned();
        let is_idle = |option: &str| told.contains(&format!("{option} changes none of these "));
        ([is_idle("--method"), is_idle("--angles")], [said("method"), said("angles")])
    };
    let both = ["--method", "pursuit", "--angles", "harmonic"];
    let words = |[method, angles]: [&str; 2]| [method.to_owned(), angles.to_owned()];
    assert_eq!(run("cones", &[]), ([false; 2], words(["given", "given"])));
    assert_eq!(run("cones", &both), ([true; 2], words(["given", "given"])));
    assert_eq!(run("places", &both), ([true, false], words(["given", "harmonic"])));
}

#[test]
fn a_checkerboard_is_on_all_faces_whatever_materials_the_file_has() {
    let folder = Folder::new();
    let tetrahedron = "mtllib own.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 3 2\nusemtl blue\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    folder.write("two.obj", tetrahedron);
    folder.run(&["unwrap", "two.obj", "-o", "out.obj", "--checker"]).success();
    let written = folder.read("out.obj");
    let of_materials: Vec<&str> = written.lines().filter(|line| line.contains("mtl")).collect();
    assert_eq!(of_materials, ["mtllib out.mtl", "usemtl checker"]);
    folder.run(&["unwrap", "two.obj", "-o", "out.obj"]).success();
    assert!(folder.read("out.obj").contains("usemtl blue\n"));
}

#[test]
fn a_wrong_line_in_a_file_of_cones_is_named() {
    let folder = Folder::with_shapes();
    folder.write("cones.txt", "# mine\n3 1.5\nseven\n");
    let run = ["unwrap", "hare.obj", "--cones", "cones.txt", "-o", "out.obj"];
    assert!(folder.complaint(&run).contains("cones.txt, line 3"));
    for (text, expected) in [
        ("4\n\n999999\n", "cones.txt, line 3: cone 999999"),
        ("4\n5\n# again\n4\n", "cones.txt, line 4: cone 4 is given twice"),
        ("4 1\n5\n6 1\n", "cones.txt, line 2: of 3 cones 2 are given with a curvature"),
        ("4 7\n5 1\n6 4.566370614359172\n", "cones.txt, line 1: a cone's curvature must be less than 2π"),
        ("4 1\n5 1\n", "cones.txt: the given curvatures sum to 2.0"),
        ("#: vertices 7\n4\n5\n6\n", "cones.txt: the cones are of a model of 7 vertices"),
        ("#: handles 7\n4\n", "cones.txt, line 1: \"#: handles 7\" is nothing that can be said"),
        ("4 #: face 99999\n", "cones.txt, line 1: cone 4 is no vertex of face 99999"),
        ("# nothing\n\n", "cones.txt lists no cone"),
    ] {
        folder.write("cones.txt", text);
        let said = folder.complaint(&run).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(expected), "{said}");
    }
    assert!(!folder.path("out.obj").exists());
}

#[test]
fn extracting_lists_the_cones_that_unwrapping_uses() {
    let folder = Folder::with_shapes();
    let printed = stdout(&folder.run(&["extract", "hare.obj", "-n", "6", "--json"]).success());
    let extracted: Value = serde_json::from_str(&printed).expect("stdout is JSON");
    folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "out.obj", "--report", "report.json"]).success();
    assert_eq!(extracted["cones"], folder.json("report.json")["cones"]);
    let table = stdout(&folder.run(&["extract", "hare.obj", "-n", "6"]).success());
    assert_eq!(table.lines().count(), 2 + 6 + 1, "{table}");
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let folder = Folder::with_shapes();
    for name in ["a", "b"] {
        let (out, picture) = (format!("{name}.obj"), format!("{name}.png"));
        folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", &out, "--picture", &picture]).success();
    }
    for ending in ["obj", "png"] {
        let bytes = |name: &str| fs::read(folder.path(&format!("{name}.{ending}"))).expect("it was written");
        assert!(bytes("a") == bytes("b"), "{ending}");
    }
}

#[test]
fn every_kind_of_output_is_written() {
    let folder = Folder::with_shapes();
    folder
        .run(&["unwrap", "hare.obj", "-o", "out.ply", "--layout", "layout.svg", "--picture", "picture.png"])
        .success();
    folder.run(&["unwrap", "hare.obj", "-o", "out.glb", "--layout", "layout.PNG", "--scale", "area"]).success();
    let starts = |name: &str, magic: &[u8]| fs::read(folder.path(name)).expect("it was written").starts_with(magic);
    assert!(starts("out.ply", b"ply"));
    assert!(starts("out.glb", b"glTF"));
    assert!(starts("layout.svg", b"<svg"));
    assert!(starts("layout.PNG", b"\x89PNG\r\n"));
    assert!(starts("picture.png", b"\x89PNG\r\n"));
}

#[test]
fn broken_input_is_refused_in_a_sentence_and_leaves_no_file() {
    let folder = Folder::new();
    folder.write("empty.obj", "");
    folder.write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n");
    fs::create_dir(folder.path("folder.obj")).expect("a folder can be made");
    let before = folder.names();
    for (input, says) in [
        ("empty.obj", "empty.obj"),
        ("nan.obj", "line 2"),
        ("range.obj", "line 4"),
        ("folder.obj", "folder.obj"),
        ("missing.obj", "missing.obj"),
    ] {
        let complaint = folder.complaint(&["unwrap", input, "-o", "out.obj", "--report", "out.json"]);
        assert!(complaint.contains(says), "{complaint}");
        assert_eq!(complaint.lines().count(), 1, "{complaint}");
        folder.complaint(&["extract", input]);
        folder.complaint(&["measure", input]);
    }
    assert_eq!(folder.names(), before);
}

#[test]
fn too_few_cones_become_the_least_number_with_a_warning() {
    let folder = Folder::with_shapes();
    for asked in ["0", "2"] {
        let done =
            folder.run(&["unwrap", "sphere.obj", "-n", asked, "-o", "out.obj", "--report", "report.json"]).success();
        assert!(stderr(&done).starts_with("warning: "), "{}", stderr(&done));
        let report = folder.json("report.json");
        assert_eq!(report["cones"].as_array().map(Vec::len), Some(3));
        assert_eq!(report["warnings"].as_array().map(Vec::len), Some(1));
    }
}

#[test]
fn the_input_is_never_overwritten() {
    let folder = Folder::with_shapes();
    let before = folder.read("hare.obj");
    fs::hard_link(folder.path("hare.obj"), folder.path("hard.obj")).expect("hard links can be made");
    let mut names = vec!["hare.obj", "./hare.obj", "hard.obj"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("hare.obj", folder.path("soft.obj")).expect("links can be made");
        names.push("soft.obj");
    }
    for name in names {
        let complaint = folder.complaint(&["unwrap", "hare.obj", "-o", name]);
        assert!(complaint.contains("is the input"), "{complaint}");
        assert_eq!(folder.read("hare.obj"), before);
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let folder = Folder::with_shapes();
    let before = folder.names();
    for (output, says) in [("out.xyz", ".obj, .ply or .glb"), ("no/out.obj", "there is no folder no"), ("out", ".obj")]
    {
        let complaint = folder.complaint(&["unwrap", "missing.obj", "-o", output]);
        assert!(complaint.contains(says), "{complaint}");
    }
    folder.complaint(&["unwrap", "hare.obj", "-o", "out.obj", "--picture", "out.jpg"]);
    folder.complaint(&["unwrap", "hare.obj", "-o", "out.obj", "--report", "out.pdf"]);
    let twice = folder.complaint(&["unwrap", "hare.obj", "-o", "out.obj", "--cones-out", "./out.obj"]);
    assert!(twice.contains("two outputs"), "{twice}");
    assert_eq!(folder.names(), before);
}

#[test]
fn an_output_that_the_system_refuses_is_known_before_the_input_is_read() {
    let folder = Folder::new();
    let protected = folder.path("protected.json");
    fs::write(&protected, "old").expect("a temporary folder can be written to");
    let mut permissions = fs::metadata(&protected).expect("the file is there").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&protected, permissions).expect("the file is ours");
    for args in [
        &["unwrap", "missing.obj", "-o", "out.obj", "--report", "protected.json"][..],
        &["extract", "missing.obj", "--cones-out", "protected.json"],
        &["extract", "missing.obj", "--hierarchy", "protected.json"],
        &["compare", "missing.obj", "-o", "protected.json"],
        &["features", "missing.obj", "-o", "protected.json"],
    ] {
        assert!(folder.complaint(args).contains("protected.json cannot be written"), "{args:?}");
    }
    // A folder in which nobody makes files, not even the administrator.
    if fs::exists("/proc/self").is_ok_and(|there| there) {
        let complaint = folder.complaint(&["unwrap", "missing.obj", "-o", "/proc/self/out.obj"]);
        assert!(complaint.contains("/proc/self/out.obj cannot be written"), "{complaint}");
    }
    assert_eq!((folder.names(), folder.read("protected.json")), (vec!["protected.json".to_owned()], "old".to_owned()));
}

#[test]
fn wrong_arguments_exit_with_2() {
    let folder = Folder::with_shapes();
    for args in [
        &["unwrap", "hare.obj"][..],
        &["unwrap", "hare.obj", "-o", "out.obj", "--islands", "sideways"],
        &["unwrap", "hare.obj", "-o", "out.obj", "-n", "many"],
        &["unwrap", "hare.obj", "-o", "out.obj", "-n", "4", "--min-persistence", "0.1"],
        &["unwrap", "hare.obj", "-o", "out.obj", "--method", "magic"],
        &["shape", "teapot", "-o", "out.obj"],
        &["view", "hare.obj", "--port", "many"],
        &[],
    ] {
        folder.run(args).code(2);
    }
    assert!(!folder.path("out.obj").exists());
}

#[test]
fn every_built_in_shape_can_be_written_and_unwrapped() {
    let folder = Folder::new();
    for name in geom::shapes::NAMES {
        folder.run(&["shape", name, "--vertices", "300", "-o", "shape.obj"]).success();
        folder.run(&["unwrap", "shape.obj", "-o", "out.obj"]).success();
    }
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let folder = Folder::with_shapes();
    let mut process = Process::new(PROGRAM);
    process.args(["extract", "hare.obj"]).current_dir(folder.root());
    let mut running = process.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts");
    drop(running.stdout.take());
    let done = running.wait_with_output().expect("it ends");
    assert_eq!(String::from_utf8_lossy(&done.stderr), "");
    assert_eq!(done.status.code(), Some(0));
}

#[cfg(unix)]
#[test]
fn an_interrupt_exits_with_130_and_leaves_no_half_file() {
    let folder = Folder::new();
    let mut process = Process::new(PROGRAM);
    process.args(["demo", "show"]).current_dir(folder.root());
    let mut running = process.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the command starts");
    // Once the page is there the demo is at work, and its shapes take it a while.
    while !folder.path("show/index.html").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let id = running.id().to_string();
    assert!(Process::new("kill").args(["-INT", &id]).status().expect("there is a kill").success());
    assert_eq!(running.wait().expect("it ends").code(), Some(130));
    for entry in fs::read_dir(folder.path("show")).expect("the folder is there") {
        let name = entry.expect("it can be listed").file_name().to_string_lossy().into_owned();
        assert!(!name.ends_with(".part"), "{name}");
    }
}

#[test]
fn the_demo_writes_what_it_promises_into_a_folder_of_its_own() {
    let folder = Folder::new();
    let done = folder.run(&["demo"]).success();
    let text = stdout(&done);
    for column in ["shape", "vertices", "cones", "area D", "quasi-conf.", "flips", "seconds"] {
        assert!(text.contains(column), "{column}: {text}");
    }
    let page = folder.read("cones-demo/index.html");
    for name in
        page.split('"').filter(|name| name.ends_with(".png") || name.ends_with(".obj") || name.ends_with(".json"))
    {
        assert!(fs::metadata(folder.path("cones-demo").join(name)).expect(name).len() > 1000, "{name}");
    }
    assert!(folder.read("cones-demo/hare.obj").contains("mtllib checker.mtl"));
    assert!(folder.read("cones-demo/checker.mtl").contains("checker.png"));
    fs::create_dir(folder.path("mine")).expect("a folder can be made");
    folder.write("mine/index.html", "<p>precious");
    assert!(folder.complaint(&["demo", "mine"]).contains("holds other files"));
    assert_eq!(folder.read("mine/index.html"), "<p>precious");
}

#[test]
fn spindles_whose_tips_keep_their_curvature_come_out_with_few_cones() {
    let folder = Folder::new();
    for (thickness, asked, most, best) in [(1e-3, &[][..], 8, 1.3), (1e-5, &["-n", "4"], 4, 2.0)] {
        folder.write("spindle.obj", &squeezed(20, 20, [thickness, thickness, 1.0]));
        let args = [&["unwrap", "spindle.obj", "-o", "out.obj", "--json"], asked].concat();
        let done = folder.run(&args).success();
        let report: Value = serde_json::from_str(&stdout(&done)).expect("it is JSON");
        assert!(!stderr(&done).contains("could not be flattened well"), "{}", stderr(&done));
        assert!(report["cones"].as_array().is_some_and(|cones| cones.len() <= most));
        let area = report["distortion"]["area_mean"].as_f64().expect("a number");
        assert!(area < best && report["distortion"]["flipped"] == 0, "{area}");
    }
}

/// Their edges are lengthened by up to 1e-4 of the mean: what is flattened is another surface than what is measured.
#[test]
fn whether_the_target_is_met_is_said_of_the_figure_beside_it() {
    let folder = Folder::new();
    let mut missed = 0;
    for thickness in [1e-3, 1e-9] {
        folder.write("spindle.obj", &squeezed(8, 4, [thickness, thickness, 1.0]));
        let done =
            folder.run(&["unwrap", "spindle.obj", "--max-distortion", "1.1", "-o", "out.obj", "--json"]).success();
        let report: Value = serde_json::from_str(&stdout(&done)).expect("it is JSON");
        let area = report["distortion"]["area_mean"].as_f64().expect("a number");
        assert_eq!(report["number"]["met"], area <= 1.105, "{area}");
        missed += usize::from(area > 1.105);
    }
    assert_eq!(missed, 1);
}

/// On a spindle as thin as this triangles fold over.
#[test]
fn where_cones_fail_others_are_tried_and_the_map_that_measures_best_is_kept() {
    let folder = Folder::new();
    folder.write("spindle.obj", &squeezed(20, 6, [1e-6, 1e-6, 1.0]));
    let done = folder.run(&["unwrap", "spindle.obj", "-n", "4", "-o", "out.obj", "--json", "-v"]).success();
    let report: Value = serde_json::from_str(&stdout(&done)).expect("it is JSON");
    let said = "4 cones could not be flattened well (48 triangles fold over): taking 3";
    assert!(stderr(&done).contains(said), "{}", stderr(&done));
    assert_eq!(report["cones"].as_array().map(Vec::len), Some(3));
    assert_eq!(report["distortion"]["flipped"], 0);
}

#[test]
fn a_surface_that_would_be_cut_too_often_stays_as_it_is_and_that_is_said() {
    let folder = Folder::new();
    folder.run(&["shape", "sphere", "--vertices", "600", "-o", "sphere.obj"]).success();
    let sphere = folder.read("sphere.obj");
    let stretched = sphere.lines().map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
        ["v", x, y, z] => format!("v {x} {y} {:?}\n", 1e6 * z.parse::<f64>().unwrap()),
        _ => format!("{line}\n"),
    });
    folder.write("stretched.obj", &stretched.collect::<String>());
    let unwrapped = folder.run(&["unwrap", "stretched.obj", "--refine", "-o", "map.obj"]).success();
    assert!(stderr(&unwrapped).contains("not all triangles could be made even"), "{}", stderr(&unwrapped));
    assert!(stdout(&unwrapped).contains("in part; written as 642 vertices"), "{}", stdout(&unwrapped));
}

/// A box of unit squares, but for its lid, one rectangle that two vertices lie on the edges of.
const LIDDED: &str = "# a box
v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0
v 0 0 1\nv 1 0 1\nv 2 0 1\nv 0 1 1\nv 1 1 1\nv 2 1 1
vn 0 0 1\nvn 0 0 -1
g lid\nf 7//1 9//1 12//1 10//1
g rest\nf 1//2 7//2 10//2 4//2\nf 3//2 6//2 12//2 9//2
f 1//2 4//2 5//2 2//2\nf 2//2 5//2 6//2 3//2
f 1//2 2//2 8//2 7//2\nf 2//2 3//2 9//2 8//2
f 4//2 10//2 11//2 5//2\nf 5//2 11//2 12//2 6//2
";

#[test]
fn vertices_on_the_edges_of_other_faces_are_told_of_and_close_the_surface_on_request() {
    let folder = Folder::new();
    folder.write("box.obj", LIDDED);
    let said = |run: &[&str]| stderr(&folder.run(run).success()).split_whitespace().collect::<Vec<_>>().join(" ");
    let open = said(&["unwrap", "box.obj", "-o", "open.obj"]);
    assert!(open.contains("2 vertices on the edges of other faces"), "{open}");
    assert!(open.contains("--split-edges"), "{open}");
    let closed = said(&["unwrap", "box.obj", "--split-edges", "-o", "closed.obj"]);
    assert!(closed.contains("2 vertices lay on the edges of other faces: 1 face has more corners"), "{closed}");
    let report = folder.run(&["unwrap", "box.obj", "--split-edges", "-o", "again.obj", "--json"]).success();
    let report: Value = serde_json::from_str(&stdout(&report)).unwrap();
    assert_eq!((&report["input"]["components"], &report["input"]["boundary_loops"]), (&1.into(), &0.into()));
    let text = folder.read("closed.obj");
    let lines = |start: &str| text.lines().filter(|line| line.starts_with(start)).map(String::from).collect::<Vec<_>>();
    assert_eq!(
        (lines("v ").len(), lines("g "), lines("# a box").len()),
        (12, vec!["g lid".into(), "g rest".into()], 1)
    );
    let corners =
        |line: &String| line.split(' ').skip(1).map(|c| c.split('/').next().unwrap().into()).collect::<Vec<String>>();
    assert_eq!((corners(&lines("f ")[0]).join(" "), lines("f ").len()), ("7 8 9 12 11 10".into(), 9));
    assert!(lines("f ").iter().flat_map(|face| face.split(' ').skip(1)).all(|corner| corner.split('/').count() == 3));
}
