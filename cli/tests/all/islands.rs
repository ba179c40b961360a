//! Maps that lie over themselves: found, drawn, and taken apart; what is written is read again.

use crate::folder::{Folder, stderr, stdout};
use serde_json::Value;
use std::fmt::Write;

/// An OBJ of points in space with a map: a quadrilateral grid of `columns` by `rows`, whose vertices a function places.
fn grid(columns: usize, rows: usize, place: impl Fn(usize, usize) -> ([f64; 3], [f64; 2])) -> String {
    let mut text = String::new();
    let all = || (0..=columns).flat_map(|i| (0..=rows).map(move |j| (i, j)));
    for (i, j) in all() {
        let [x, y, z] = place(i, j).0;
        writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
    }
    for (i, j) in all() {
        let [u, v] = place(i, j).1;
        writeln!(text, "vt {u:?} {v:?}").unwrap();
    }
    for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| i * (rows + 1) + j + 1);
        writeln!(text, "f {}", corners.map(|c| format!("{c}/{c}")).join(" ")).unwrap();
    }
    text
}

/// A ribbon that winds up as it goes round, and lies over itself seen from above, which is its map.
fn spiral() -> String {
    grid(120, 3, |i, j| {
        let (angle, radius) = (0.17 * i as f64, 1.0 + 0.2 * j as f64);
        let [x, y] = [radius * angle.cos(), radius * angle.sin()];
        ([x, y, 0.1 * angle], [x, y])
    })
}

fn printed(folder: &Folder, args: &[&str]) -> Value {
    serde_json::from_str(&stdout(&folder.run(args).success())).expect("it is JSON")
}

#[test]
fn a_spiral_is_found_and_taken_apart() {
    let folder = Folder::new();
    folder.write("spiral.obj", &spiral());
    let args = ["measure", "spiral.obj", "--json", "--overlap-faces", "faces.txt", "--layout", "layout.svg"];
    let measured = printed(&folder, &args);
    let [share, pairs, depth] =
        ["overlap", "overlap_pairs", "overlap_depth"].map(|key| measured["distortion"][key].as_f64().unwrap());
    assert!(share > 0.9 && pairs > 100.0 && depth > 0.01, "{share} {pairs} {depth}");
    let faces: Vec<usize> = folder.read("faces.txt").lines().map(|line| line.parse().unwrap()).collect();
    assert!(faces.len() > 300 && faces.is_sorted() && faces.iter().all(|&face| face < 360));
    assert!(folder.read("layout.svg").starts_with("<svg"));
    let report = printed(&folder, &["islands", "spiral.obj", "-o", "apart.obj", "--json"]);
    assert_eq!((&report["before"]["islands"], &report["after"]["islands"]), (&1.into(), &4.into()));
    let after = printed(&folder, &["measure", "apart.obj", "--json"]);
    assert_eq!(after["distortion"]["overlap_pairs"], 0);
    assert_eq!(after["islands"].as_array().unwrap().len(), 4);
    assert_eq!(after["distortion"]["flipped"], 0);
    assert!(stdout(&folder.run(&["measure", "apart.obj"]).success()).contains("none overlapping"));
}

#[test]
fn a_doubled_sheet_comes_apart_at_its_fold() {
    let folder = Folder::new();
    let fold = |i: usize| if i > 6 { 12 - i } else { i } as f64;
    let sheet = grid(12, 4, |i, j| ([i as f64, j as f64, 0.0], [fold(i), j as f64]));
    folder.write("folded.obj", &sheet);
    let report = printed(&folder, &["islands", "folded.obj", "-o", "apart.obj", "--json"]);
    assert_eq!((&report["after"]["islands"], &report["after"]["overlap_pairs"]), (&2.into(), &0.into()));
    assert_eq!(report["left"], 0);
}

#[test]
fn a_texel_density_is_one_on_the_surface() {
    let folder = Folder::new();
    let fold = |i: usize| if i > 6 { 12 - i } else { i } as f64;
    let folded = grid(12, 4, |i, j| ([10.0 * i as f64, 10.0 * j as f64, 0.0], [fold(i), j as f64]));
    folder.write("folded.obj", &folded);
    for command in ["pack", "islands"] {
        let packed = |density: &'static str| {
            [command, "folded.obj", "-o", "out.obj", "--udim", "--texel-density", density, "--margin", "1"]
        };
        folder.run(&packed("6.4")).success();
        let model = geom::io::read(folder.path("out.obj")).unwrap();
        let uv = model.uv().unwrap().all().unwrap();
        let side = (uv[0][0] - uv[1][0]).hypot(uv[0][1] - uv[1][1]);
        assert!((side * 1024.0 - 64.0).abs() < 1e-6, "{command}: {}", side * 1024.0);
        let complaint = folder.complaint(&packed("640"));
        let fits: f64 =
            complaint.split("texel density to ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!(10.0 < fits && fits < 30.0, "{complaint}");
    }
}

#[test]
fn copies_and_faces_with_a_vertex_twice_are_not_measured_and_said_to_be_left_out() {
    let folder = Folder::new();
    let sheet = grid(9, 7, |i, j| ([i as f64, j as f64, 0.0], [i as f64 / 9.0, j as f64 / 7.0]));
    // The first face again, turned over, and one with a vertex twice.
    folder.write("spare.obj", &format!("{sheet}f 10/10 9/9 1/1 2/2\nf 1/1 2/2 2/3\n"));
    let spare = folder.run(&["measure", "spare.obj", "--json"]).success();
    assert!(stderr(&spare).contains("3 triangles with a vertex twice, or at the place of another one"));
    let spare: Value = serde_json::from_str(&stdout(&spare)).unwrap();
    folder.write("sheet.obj", &sheet);
    let plain = printed(&folder, &["measure", "sheet.obj", "--json"]);
    assert_eq!((&spare["input"]["left_out"], &plain["input"]["left_out"]), (&3.into(), &0.into()));
    assert_eq!((&spare["distortion"], &spare["islands"]), (&plain["distortion"], &plain["islands"]));
    // The same vertices elsewhere in the plane are no copy.
    folder.write("moved.obj", &format!("{sheet}vt 0.1 0.05\nf 1/1 9/9 10/10 2/81\n"));
    let moved = printed(&folder, &["measure", "moved.obj", "--json"]);
    assert!(moved["distortion"]["overlap_pairs"].as_u64().unwrap() > 0, "{moved}");
}

#[test]
fn tiles_that_touch_stay_as_they_are() {
    let folder = Folder::new();
    folder.write("tiles.obj", &grid(9, 7, |i, j| ([i as f64, j as f64, 0.0], [i as f64 / 9.0, j as f64 / 7.0])));
    let measured = printed(&folder, &["measure", "tiles.obj", "--json"]);
    assert_eq!(
        (&measured["distortion"]["overlap_pairs"], &measured["distortion"]["overlap"]),
        (&0.into(), &0.0.into())
    );
    folder.run(&["islands", "tiles.obj", "-o", "same.obj"]).success();
    let texture = |name: &str| -> Vec<String> {
        folder.read(name).lines().filter(|line| line.starts_with("vt")).map(str::to_owned).collect()
    };
    let numbers = |lines: Vec<String>| -> Vec<f64> {
        lines
            .iter()
            .flat_map(|line| line.split(' ').skip(1).map(|x| x.parse().unwrap()).collect::<Vec<f64>>())
            .collect()
    };
    let (mut before, mut after) = (numbers(texture("tiles.obj")), numbers(texture("same.obj")));
    before.sort_by(f64::total_cmp);
    after.sort_by(f64::total_cmp);
    assert_eq!(before, after, "to the bit");
}

#[test]
fn unwrapping_leaves_no_overlap_unless_one_island_is_asked_for() {
    let folder = Folder::new();
    folder.run(&["shape", "hare", "--vertices", "900", "-o", "hare.obj"]).success();
    let unwrap = |policy: &str| {
        let args = ["unwrap", "hare.obj", "-n", "32", "-o", "out.obj", "--islands", policy, "--json"];
        let done = folder.run(&args).success();
        let report: Value = serde_json::from_str(&stdout(&done)).unwrap();
        (report, stderr(&done))
    };
    let (single, said) = unwrap("single");
    assert_eq!(single["policy"], "single");
    assert_eq!(single["islands"].as_array().unwrap().len(), 1);
    assert!(single["distortion"]["overlap_pairs"].as_u64().unwrap() > 0, "choose a hare that lies over itself");
    // The same share as in the report.
    let share = 100.0 * single["distortion"]["overlap"].as_f64().unwrap();
    assert!(said.contains(&format!("{share:.2} % of the layout lies over itself")), "{share} {said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    let (free, said) = unwrap("overlap-free");
    assert_eq!((&free["policy"], &free["distortion"]["overlap_pairs"]), (&"overlap-free".into(), &0.into()));
    assert!(!said.contains("lies over itself") && free["times"]["islands"].as_f64().is_some(), "{said}");
    let written = printed(&folder, &["measure", "out.obj", "--reference", "hare.obj", "--json"]);
    assert_eq!(written["distortion"]["overlap_pairs"], 0);
    assert_eq!(written["islands"], free["islands"]);
    for key in ["flipped", "degenerate"] {
        assert_eq!(written["distortion"][key], 0);
    }
    for key in ["area_mean", "u_l2"] {
        let [a, b] = [&single, &free].map(|report| report["distortion"][key].as_f64().unwrap());
        assert!((a - b).abs() < 1e-9, "islands move, their scale stays");
    }
}

/// The same OBJ with a vertex of its own for each pair of a vertex and its texture coordinate, as many formats have it.
fn split_along_seams(text: &str) -> String {
    let of = |key: &str| -> Vec<Vec<&str>> {
        text.lines().filter(|line| line.starts_with(key)).map(|line| line.split(' ').skip(1).collect()).collect()
    };
    let (points, texture, faces) = (of("v "), of("vt "), of("f "));
    let mut pairs: Vec<&str> = faces.concat();
    pairs.sort_unstable();
    pairs.dedup();
    let mut split = String::new();
    for pair in &pairs {
        let (v, vt) = pair.split_once('/').expect("faces have texture coordinates");
        let [v, vt] = [v, vt].map(|index| index.parse::<usize>().expect("an index") - 1);
        writeln!(split, "v {}\nvt {}", points[v].join(" "), texture[vt].join(" ")).unwrap();
    }
    for face in faces {
        let corners = face.iter().map(|pair| pairs.binary_search(pair).expect("it is there") + 1);
        writeln!(split, "f {}", corners.map(|c| format!("{c}/{c}")).collect::<Vec<_>>().join(" ")).unwrap();
    }
    split
}

#[test]
fn figures_of_a_split_surface_are_those_of_the_welded_one() {
    let folder = Folder::new();
    folder.run(&["shape", "hare", "--vertices", "500", "-o", "hare.obj"]).success();
    folder.run(&["unwrap", "hare.obj", "-n", "8", "-o", "out.obj"]).success();
    folder.write("split.obj", &split_along_seams(&folder.read("out.obj")));
    let whole = printed(&folder, &["measure", "out.obj", "--json"]);
    let split = folder.run(&["measure", "split.obj", "--weld=never", "--json"]).success();
    assert!(stderr(&split).contains("--weld"), "it says that it cannot know");
    let figures = |report: &Value| {
        let faces: Vec<Value> = report["islands"].as_array().unwrap().iter().map(|i| i["faces"].clone()).collect();
        (faces, (1e4 * report["distortion"]["seam_length"].as_f64().unwrap()).round())
    };
    for weld in ["--weld=auto", "--weld"] {
        assert_eq!(figures(&printed(&folder, &["measure", "split.obj", weld, "--json"])), figures(&whole));
        let again = ["unwrap", "split.obj", weld, "-n", "8", "-o", "again.obj", "--json"];
        assert_eq!(figures(&printed(&folder, &again)), figures(&whole), "and those of an unwrapping");
    }
}

#[test]
fn tiles_are_unit_squares_and_what_does_not_fit_says_which_density_does() {
    let folder = Folder::with_shapes();
    let tiles = |density: &str, scale: &str| {
        folder.run(&["unwrap", "hare.obj", "-o", "out.obj", "--udim", "--texel-density", density, "--scale", scale])
    };
    for scale in ["area", "none"] {
        let said = stderr(&tiles("100", scale).code(2));
        assert!(said.contains("leave --scale out"), "{said}");
    }
    let said = stderr(&tiles("400", "unit").code(1));
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let fits = said.split("lower the texel density to ").nth(1).and_then(|rest| rest.split(' ').next());
    let fits: f64 = fits.and_then(|fits| fits.parse().ok()).unwrap_or_else(|| panic!("{said}"));
    tiles(&fits.to_string(), "unit").success();
    tiles(&(1.02 * fits).to_string(), "unit").code(1);
}
