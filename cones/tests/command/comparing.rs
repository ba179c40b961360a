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
    let args = ["compare", "sphere.obj", "--best-of", "1", "--method", "persistence"];
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
fn a_method_that_fails_says_so_in_its_row() {
    let folder = Folder::new();
    folder.write("two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    let comparison = json(&folder, &["two.obj", "-n", "4", "--method", "persistence,linear,lscm"]);
    for row in comparison["rows"].as_array().expect("there are rows") {
        let has_result = row["quasi_conformal"].is_number();
        assert!(has_result || row["note"].as_str().is_some_and(|note| note.starts_with("failed: ")), "{row}");
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
