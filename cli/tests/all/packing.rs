//! `pack`, and the options of packing that `unwrap` has.

use crate::folder::{Folder, stderr, stdout};

/// Two squares of different sizes that share a place in texture space, one of them a quadrilateral, with what else an OBJ says.
const SQUARES: &str = "# two squares\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 8 0 0\nv 8 3 0\nv 5 3 0\n\
    vt 0 0\nvt 0.1 0\nvt 0.1 0.1\nvt 0 0.1\nvt 0.3 0\nvt 0.3 0.3\nvt 0 0.3\n\
    usemtl stone\nf 1/1 2/2 3/3 4/4\nf 5/1 6/5 7/6\nf 5/1 7/6 8/7\n";

#[test]
fn a_map_of_any_origin_is_packed_and_its_file_kept() {
    let folder = Folder::new();
    folder.write("in.obj", SQUARES);
    let done = folder.run(&["pack", "in.obj", "-o", "out.obj"]).success();
    assert!(stdout(&done).contains("2 islands") || stdout(&done).contains("islands   2"), "{}", stdout(&done));
    let packed = folder.read("out.obj");
    assert!(packed.contains("# two squares") && packed.contains("usemtl stone"), "{packed}");
    let quads = packed.lines().filter(|line| line.starts_with("f ") && line.split_whitespace().count() == 5);
    assert_eq!(quads.count(), 1, "{packed}");
    let measured = |file: &str| -> serde_json::Value {
        serde_json::from_str(&stdout(&folder.run(&["measure", file, "--json"]).success())).expect("it is JSON")
    };
    let [before, after] = ["in.obj", "out.obj"].map(|file| measured(file)["distortion"].clone());
    assert!(before["overlap"].as_f64() > Some(0.1) && after["overlap"] == 0.0, "islands that shared a place lie apart");
    assert!(after["fill"].as_f64() > Some(0.5), "{after}");
    for key in ["area_mean", "u_l2", "seam_length"] {
        let [a, b] = [&before, &after].map(|d| d[key].as_f64().expect("a number"));
        assert!((a - b).abs() < 1e-12, "{key}: {a} {b}");
    }
}

#[test]
fn tiles_are_filled_at_the_density_that_is_asked_for() {
    let folder = Folder::new();
    folder.write("in.obj", SQUARES);
    let report = |density: &str| -> serde_json::Value {
        let args = ["pack", "in.obj", "-o", "out.obj", "--udim", "--texel-density", density, "--json"];
        serde_json::from_str(&stdout(&folder.run(&args).success())).expect("it is JSON")
    };
    assert_eq!(report("100")["tiles"], 1);
    assert_eq!(report("330")["tiles"], 2);
    let complaint = folder.complaint(&["pack", "in.obj", "-o", "out.obj", "--udim", "--texel-density", "500"]);
    assert!(complaint.contains("too large") && complaint.contains("or cut it (--texel-density)"), "{complaint}");
    let fits = complaint.split("texel density to ").nth(1).and_then(|rest| rest.split(' ').next());
    assert_eq!(report(fits.expect("it is said which would fit"))["tiles"], 2);
    folder.run(&["pack", "in.obj", "-o", "out.obj", "--udim"]).code(2);
}

#[test]
fn what_no_packing_can_keep_to_is_a_wrong_argument_before_anything_is_read() {
    let folder = Folder::new();
    for command in ["unwrap", "pack", "islands"] {
        let refused =
            |more: &[&str]| stderr(&folder.run(&[&[command, "none.obj", "-o", "x.obj"], more].concat()).code(2));
        for margin in ["256", "300"] {
            let told = refused(&["--margin", margin]);
            assert!(told.contains(&format!("a margin of {margin} texels does not fit on a texture of 1024")), "{told}");
            assert!(told.contains("(--margin, --texture-size)"), "{told}");
        }
        assert!(refused(&["--margin", "3", "--texture-size", "8"]).contains("does not fit"));
        for density in ["0", "-1"] {
            let told = refused(&["--udim", "--texel-density", density]);
            assert!(told.contains("'--texel-density <D>': expected a number above 0"), "{told}");
        }
    }
}

#[test]
fn further_cuts_fill_more_and_keep_to_their_share() {
    let folder = Folder::with_shapes();
    let report = |share: &str| {
        let args = ["unwrap", "hare.obj", "-n", "8", "-o", "out.obj", "--report", "r.json", "--layout", "l.svg"];
        folder.run(&[&args[..], &["--islands", "pack", "--max-seam", share]].concat()).success();
        folder.json("r.json")["distortion"].clone()
    };
    for islands in ["single", "overlap-free"] {
        let args = ["unwrap", "hare.obj", "-o", "x.obj", "--max-seam", "0.2", "--islands", islands];
        assert!(stderr(&folder.run(&args).code(2)).contains("--max-seam is for --islands pack"));
    }
    let [plain, cut] = ["0", "0.2"].map(report);
    let of = |d: &serde_json::Value, key: &str| d[key].as_f64().expect("a number");
    assert!(of(&cut, "fill") >= of(&plain, "fill") - 0.01);
    assert!(of(&cut, "seam_length") <= 1.2 * of(&plain, "seam_length") + 1e-9);
    for key in ["area_mean", "u_l2"] {
        assert!((of(&cut, key) - of(&plain, key)).abs() < 1e-12, "{key}");
    }
    assert!(folder.read("l.svg").contains("% filled"));
}

#[test]
fn where_most_of_the_square_stays_empty_it_is_said_what_to_do() {
    let folder = Folder::new();
    let side = |y: u32| (0..=60).map(move |x| format!("v {x} {y} 0\n"));
    let face = |x: u32| format!("f {} {} {} {}\n", x + 1, x + 2, x + 63, x + 62);
    folder.write("strip.obj", &side(0).chain(side(1)).chain((0..60).map(face)).collect::<String>());
    folder.write("patch.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n");
    let advice = |args: &[&str]| {
        let printed = stdout(&folder.run(&[&["unwrap"], args, &["-o", "out.obj"]].concat()).success());
        printed.contains("--islands pack")
    };
    assert!(advice(&["strip.obj"]));
    assert!(!advice(&["strip.obj", "--islands", "pack"]));
    assert!(!advice(&["patch.obj"]));
}

#[test]
fn what_has_no_map_is_to_be_unwrapped_first() {
    let folder = Folder::with_shapes();
    for args in
        [&["measure", "hare.obj"][..], &["pack", "hare.obj", "-o", "x.obj"], &["islands", "hare.obj", "-o", "x.obj"]]
    {
        let complaint = folder.complaint(args);
        assert!(complaint.contains("hare.obj has no texture coordinates: unwrap it first"), "{complaint}");
    }
}

#[test]
fn a_map_with_holes_is_refused_with_the_first_of_them() {
    let folder = Folder::new();
    for (corner, point, lacking) in [("7", "0.3 0.3", 1), ("7/6", "nan 0.3", 2), ("7/60", "0.3 0.3", 1)] {
        folder.write(
            "holes.obj",
            &SQUARES.replace("6/5 7/6", &format!("6/5 {corner}")).replace("vt 0.3 0.3", &format!("vt {point}")),
        );
        for args in [
            &["measure", "holes.obj"][..],
            &["pack", "holes.obj", "-o", "x.obj"],
            &["islands", "holes.obj", "-o", "x.obj"],
        ] {
            let told = format!(
                "no finite texture coordinate at {lacking} of 10 corners, the first at vertex 6 of face 1 (counted from 0)"
            );
            let complaint = folder.complaint(args);
            assert!(complaint.contains(&told), "{complaint}");
        }
    }
    folder.write("none.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/3\n");
    assert!(
        folder.complaint(&["measure", "none.obj"]).contains("none.obj has no texture coordinates: unwrap it first")
    );
}

/// Two squares side by side, the second with vertices of its own, and one map of both.
const SPLIT: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 2 0\nvt 2 1\nf 1/1 2/2 3/3 4/4\nf 5/2 6/5 7/6 8/3\n";

#[test]
fn what_split_vertices_join_is_packed_as_one_island() {
    let folder = Folder::new();
    folder.write("in.obj", SPLIT);
    let islands = |weld: &[&str]| {
        let args = [&["pack", "in.obj", "-o", "out.obj", "--json"], weld].concat();
        let report: serde_json::Value =
            serde_json::from_str(&stdout(&folder.run(&args).success())).expect("it is JSON");
        report["islands"].as_u64()
    };
    assert_eq!([islands(&[]), islands(&["--weld"]), islands(&["--weld=never"])], [Some(1), Some(1), Some(2)]);
}

#[test]
fn a_margin_that_is_not_kept_is_said_and_so_are_edges_that_are_cut_and_avoided() {
    let folder = Folder::with_shapes();
    let faces = folder.read("hare.obj");
    let corners = |line: &str| -> Vec<usize> {
        line.split_whitespace().skip(1).map(|word| word.parse().expect("a vertex")).collect()
    };
    let edges: String = faces
        .lines()
        .filter(|line| line.starts_with("f "))
        .flat_map(|line| [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|k| corners(line)[k] - 1)))
        .filter(|[a, b]| a < b)
        .map(|[a, b]| format!("{a} {b}\n"))
        .collect();
    folder.write("all.edges", &edges);
    let args = ["unwrap", "hare.obj", "-n", "6", "-o", "out.obj", "--texture-size", "256", "--margin", "16"];
    let whole = stderr(&folder.run(&args).success());
    assert!(!whole.contains("margin") && !whole.contains("avoided"), "{whole}");
    let cut = [&args[..], &["--seams", "all.edges", "--avoid", "all.edges"]].concat();
    let said = stderr(&folder.run(&cut).success());
    assert!(said.contains("a margin of 16 texels was asked for, but islands are "), "{said}");
    assert!(said.contains("edges that were to be avoided were to be cut, too"), "{said}");
    let packed = stderr(&folder.run(&["pack", "out.obj", "-o", "p.obj", "--texture-size", "256", "--margin", "16"]));
    assert!(packed.contains("a margin of 16 texels was asked for"), "{packed}");
}

#[test]
fn material_libraries_are_found_from_another_folder() {
    let folder = Folder::new();
    folder.write("in.obj", &format!("mtllib stone.mtl\n{SQUARES}"));
    std::fs::create_dir(folder.path("out")).expect("it is new");
    for command in ["pack", "islands", "unwrap"] {
        folder.run(&[command, "in.obj", "-o", "out/x.obj"]).success();
        assert!(folder.read("out/x.obj").starts_with("mtllib ../stone.mtl\n"), "{command}");
        folder.run(&[command, "in.obj", "-o", "x.obj"]).success();
        assert!(folder.read("x.obj").starts_with("mtllib stone.mtl\n"), "{command}");
    }
}

#[test]
fn it_is_said_whether_islands_were_packed_anew() {
    let folder = Folder::new();
    for (text, is_packed, places) in [(SPLIT, false, "as they were"), (SQUARES, true, "packed anew")] {
        folder.write("in.obj", text);
        let said = stdout(&folder.run(&["islands", "in.obj", "-o", "out.obj"]).success());
        assert!(said.contains(places), "{said}");
        let report = stdout(&folder.run(&["islands", "in.obj", "-o", "out.obj", "--json"]).success());
        let report: serde_json::Value = serde_json::from_str(&report).expect("it is JSON");
        assert_eq!(report["packed"], is_packed);
    }
}
