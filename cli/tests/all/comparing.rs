//! `cones compare`.

use crate::folder::{Folder, stderr, stdout};
use serde_json::Value;

const EVERY: &str =
    "alternating+harmonic,refactoring+harmonic,iterative+harmonic,greedy,persistence,refined,pursuit,linear,lscm";

fn json(folder: &Folder, args: &[&str]) -> Value {
    let all = [&["compare", "--format", "json", "--best-of", "1"], args].concat();
    serde_json::from_str(&stdout(&folder.run(&all).success())).expect("it is JSON")
}

fn row<'a>(comparison: &'a Value, method: &str) -> &'a Value {
    let rows = comparison["rows"].as_array().expect("there are rows");
    rows.iter().find(|row| row["method"] == method).expect("the method was run")
}

#[test]
fn every_method_flattens_a_mesh_and_is_measured() {
    let folder = Folder::with_shapes();
    let comparison = json(&folder, &["hare.obj", "-n", "4,8", "--method", EVERY]);
    let rows = comparison["rows"].as_array().expect("there are rows");
    assert_eq!(rows.len(), 18);
    for row in rows {
        assert_eq!(row["cones"], row["n"], "{row}");
        for (key, least) in [("quasi_conformal", 1.0), ("area_mean", 1.0), ("u_l2", 0.0), ("detection_seconds", 0.0)] {
            assert!(row[key].as_f64().expect("a number") > least, "{key}: {row}");
        }
        let sum: f64 =
            ["detection_seconds", "flattening_seconds"].map(|key| row[key].as_f64().expect("a number")).iter().sum();
        assert!(row["whole_seconds"].as_f64().expect("a number") > sum, "{row}");
    }
}

#[test]
fn newton_leaves_no_curvature_where_linear_scaling_leaves_some() {
    let comparison = json(&Folder::with_shapes(), &["hare.obj", "--method", "alternating+harmonic,linear,lscm"]);
    let left = |method| row(&comparison, method)["curvature_left"].as_f64();
    assert!(left("alternating+harmonic").expect("a number") < 1e-9);
    assert!(left("alternating+harmonic+linear").expect("a number") > 1e-4);
    assert_eq!(left("refined+lscm"), None);
}

#[test]
fn smoothing_is_for_the_methods_that_look_for_extrema_and_as_in_unwrapping() {
    let folder = Folder::with_shapes();
    let comparison = json(&folder, &["hare.obj", "-n", "8", "--smooth", "--method", "persistence,refined,linear"]);
    let methods: Vec<&str> = comparison["rows"]
        .as_array()
        .expect("there are rows")
        .iter()
        .filter_map(|row| row["method"].as_str())
        .collect();
    assert_eq!(methods, ["persistence+smooth", "refined", "alternating+smooth+harmonic+linear"]);
    assert!(comparison["legend"]["method"].as_str().is_some_and(|meaning| meaning.contains("`+smooth`: ")));
    let area = |row: &Value| row["area_mean"].as_f64().expect("a number");
    let run = ["unwrap", "hare.obj", "-n", "8", "--method", "persistence", "--smooth", "--free-seams", "never"];
    folder.run(&[&run[..], &["-o", "o.obj", "--report", "r.json"]].concat()).success();
    let unwrapped = area(&folder.json("r.json")["distortion"]);
    assert!((area(row(&comparison, "persistence+smooth")) - unwrapped).abs() < 1e-6 * unwrapped);
    let plain = json(&folder, &["hare.obj", "-n", "8", "--method", "persistence,persistence+smooth"]);
    assert_eq!(area(row(&plain, "persistence+smooth")), area(row(&comparison, "persistence+smooth")));
    assert!((area(row(&plain, "persistence")) - unwrapped).abs() > 1e-3, "smoothing makes a difference here");
    for wrong in [["--method", "refined+smooth"], ["--paper", "."]] {
        folder.run(&[&["compare", "--smooth"], &wrong[..]].concat()).code(2);
    }
}

#[test]
fn where_another_number_of_cones_is_taken_the_row_has_it_and_says_why_as_unwrapping_does() {
    let folder = Folder::with_shapes();
    folder.run(&["shape", "torus-9", "--vertices", "600", "-o", "torus.obj"]).success();
    // A sphere needs three; genus 9 needs more than two, and flattening fails with the first numbers that would do.
    for (mesh, asked, method) in
        [("hare.obj", "1", "refined"), ("torus.obj", "2", "persistence"), ("torus.obj", "2", "iterative")]
    {
        let run = [
            "unwrap",
            mesh,
            "-n",
            asked,
            "--method",
            method,
            "--open-handles",
            "never",
            "--free-seams",
            "never",
            "-o",
            "out.obj",
        ];
        folder.run(&[&run[..], &["--report", "report.json"]].concat()).success();
        let report = folder.json("report.json");
        let warnings: Vec<&str> =
            report["warnings"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
        assert!(!warnings.is_empty());
        let methods = [method.to_owned(), format!("{method}+linear"), format!("{method}+lscm")];
        let comparison = json(&folder, &[mesh, "-n", asked, "--method", &methods.join(",")]);
        for name in &methods {
            let row = row(&comparison, name);
            assert_eq!(row["n"].to_string(), asked);
            assert_eq!(row["cones"].as_u64(), report["cones"].as_array().map(|cones| cones.len() as u64), "{row}");
            assert_ne!(row["cones"], row["n"]);
            assert!(row["note"].as_str().is_some_and(|note| note.contains(&warnings.join("; "))), "{row}");
        }
        let [measured, reported] = [&row(&comparison, method)["area_mean"], &report["distortion"]["area_mean"]]
            .map(|d| d.as_f64().expect("a number"));
        assert!((measured / reported - 1.0).abs() < 1e-6, "{mesh}: {measured} {reported}");
        let note = row(&comparison, &methods[2])["note"].as_str().expect("a note");
        assert!(note.starts_with(&format!("cut as for {method}: ")), "{note}");
    }
}

/// A sphere of so many rings and meridians, squeezed along the axes.
pub(crate) fn squeezed(rings: u32, meridians: u32, [x, y, z]: [f64; 3]) -> String {
    let mut text = format!("v 0 0 {z}\nv 0 0 {}\n", -z);
    let vertex = |ring: u32, meridian: u32| 3 + (ring - 1) * meridians + meridian % meridians;
    for ring in 1..rings {
        let (radius, height) = (std::f64::consts::PI * f64::from(ring) / f64::from(rings)).sin_cos();
        for meridian in 0..meridians {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(meridian) / f64::from(meridians)).sin_cos();
            text += &format!("v {} {} {}\n", x * radius * cos, y * radius * sin, z * height);
        }
    }
    for m in 0..meridians {
        text += &format!("f 1 {} {}\n", vertex(1, m), vertex(1, m + 1));
        text += &format!("f 2 {} {}\n", vertex(rings - 1, m + 1), vertex(rings - 1, m));
        for ring in 1..rings - 1 {
            let [a, b, c, d] = [(ring, m), (ring + 1, m), (ring + 1, m + 1), (ring, m + 1)].map(|(r, m)| vertex(r, m));
            text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
        }
    }
    text
}

#[test]
fn what_no_cones_can_flatten_is_not_compared() {
    let folder = Folder::new();
    folder.write("spindle.obj", &squeezed(20, 20, [1e-7, 1e-7, 1.0]));
    let comparison = json(&folder, &["spindle.obj", "-n", "4", "--method", "persistence,refined,linear,lscm"]);
    for row in comparison["rows"].as_array().expect("there are rows") {
        let note = row["note"].as_str().unwrap_or_default();
        assert!(note.starts_with("failed: the surface would be unfolded"), "{row}");
        assert!(row["cones"].is_null() && row["area_mean"].is_null(), "{row}");
    }
}

#[test]
fn refactoring_and_reusing_the_factor_give_the_same_map() {
    let comparison = json(&Folder::with_shapes(), &["hare.obj", "--method", "refactoring,iterative"]);
    for key in ["quasi_conformal", "area_mean", "u_l2"] {
        let [a, b] =
            ["refactoring", "iterative"].map(|method| row(&comparison, method)[key].as_f64().expect("a number"));
        assert!((a - b).abs() < 1e-6, "{key}: {a} {b}");
    }
}

#[test]
fn without_a_mesh_built_in_shapes_are_compared() {
    let folder = Folder::new();
    let done =
        folder.run(&["compare", "--vertices", "500", "--best-of", "1", "--method", "persistence", "-o", "table.md"]);
    assert_eq!(stdout(&done.success()), "");
    let table = folder.read("table.md");
    for shape in ["hare", "part", "torus-3", "terrain"] {
        assert!(table.contains(&format!("| {shape} |")), "{table}");
    }
}

#[test]
fn every_column_is_defined() {
    let folder = Folder::with_shapes();
    let args = ["compare", "sphere.obj", "--best-of", "1", "--method", "persistence", "--format", "md"];
    let table = stdout(&folder.run(&args).success());
    let head = table.lines().next().expect("a head").trim_matches('|');
    for column in head.split(" | ").map(|c| c.trim().replace("\\|", "|")) {
        assert!(table.contains(&format!("- {column}: ")), "{column}: {table}");
    }
}

#[test]
fn as_csv_there_are_rows_alone() {
    let folder = Folder::with_shapes();
    let args = ["compare", "sphere.obj", "--best-of", "1", "--method", "persistence,lscm", "--format", "csv"];
    let done = folder.run(&args).success();
    let mut reader = csv_lines(&stdout(&done));
    let head = reader.remove(0);
    assert!(head.starts_with("mesh,vertices,n,method,cones"));
    assert_eq!(reader.len(), 2);
    assert!(stderr(&done).contains("- floor s: "));
}

fn csv_lines(text: &str) -> Vec<String> {
    text.lines().map(str::to_owned).collect()
}

#[test]
fn a_method_that_fails_says_so_in_its_row_and_the_others_have_theirs() {
    let folder = Folder::new();
    folder.write("spindle.obj", &squeezed(20, 6, [1e-6, 1e-6, 1.0]));
    let comparison = json(&folder, &["spindle.obj", "-n", "4", "--method", "persistence,refined,linear"]);
    let failed = row(&comparison, "alternating+harmonic+linear");
    assert!(failed["quasi_conformal"].is_null() && failed["cones"].is_null(), "{failed}");
    assert!(
        failed["note"].as_str().is_some_and(|note| note.starts_with("failed: the least-squares conformal map")),
        "{failed}"
    );
    for other in ["persistence", "refined"] {
        assert!(row(&comparison, other)["quasi_conformal"].is_number(), "{other}");
    }
}

#[test]
fn the_papers_table_needs_one_of_its_models() {
    let folder = Folder::new();
    assert!(folder.complaint(&["compare", "--paper", "."]).contains("name the folder that holds table1/"));
    for wrong in ["--method=best", "-n=1000", "--best-of=0", "--format=html"] {
        folder.run(&["compare", wrong]).code(2);
    }
}

/// The files themselves are nobody's to give away: a small shape stands in for one of them.
#[test]
fn the_papers_table_is_run_on_what_there_is_and_its_claims_are_judged() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("table1")).expect("a temporary folder can be written to");
    folder.run(&["shape", "hare", "--vertices", "800", "-o", "table1/moai_10002.obj"]).success();
    let comparison = json(&folder, &["--paper", "."]);
    let files = comparison["files"].as_array().expect("there are files");
    assert_eq!(files.len(), 7);
    assert_eq!(files.iter().filter(|file| file["vertices"].is_number()).count(), 1);
    assert_eq!(comparison["rows"].as_array().map(Vec::len), Some(15));
    let paper = row(&comparison, "alternating+harmonic");
    assert_eq!([&paper["paper_areal"], &paper["paper_quasi_conformal"]], [1.285, 1.043]);
    assert_eq!(row(&comparison, "refactoring+harmonic")["paper_detection_seconds"], 0.329);
    assert!(row(&comparison, "refined")["paper_areal"].is_null());
    let claims = comparison["claims"].as_array().expect("there are claims");
    assert_eq!(claims.len(), 6);
    assert!(claims.iter().all(|claim| claim["holds"].is_boolean() && claim["measured"].is_string()));
}

#[test]
fn a_mesh_that_cannot_be_read_stops_no_other() {
    let folder = Folder::with_shapes();
    folder.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    let args = ["compare", "broken.obj", "hare.obj", "-n", "4", "--best-of", "1", "--method", "persistence"];
    let done = folder.run(&args).code(1);
    assert!(stdout(&done).contains("hare.obj") && stdout(&done).contains("persistence"), "{}", stdout(&done));
    assert!(stderr(&done).contains("broken.obj, line 2") && stderr(&done).contains("1 of 2 surfaces"));
}
