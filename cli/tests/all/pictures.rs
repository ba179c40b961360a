//! Pictures, figures and what else is written to be looked at.

use crate::folder::{Folder, stderr, stdout};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use serde_json::{Value, json};
use std::fs;
use std::io::Read;

/// Width and height as a PNG's head says them.
fn size(folder: &Folder, name: &str) -> [u32; 2] {
    let bytes = fs::read(folder.path(name)).expect("it was written");
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes")))
}

/// `cones unwrap` of a surface with six cones, with options.
fn unwrap(folder: &Folder, input: &str, more: &[&str]) {
    folder.run(&[&["unwrap", input, "-n", "6", "-o", "out.obj"], more].concat()).success();
}

#[test]
fn a_picture_is_as_large_as_is_asked_and_looks_from_where_is_asked() {
    let folder = Folder::with_shapes();
    for (name, view) in [("front.png", "front"), ("right.png", "right"), ("turned.png", "90,0"), ("low.png", "-40,-20")]
    {
        unwrap(&folder, "hare.obj", &["--picture", name, "--view", view, "--size", "200x160"]);
        assert_eq!(size(&folder, name), [200, 160]);
    }
    let bytes = |name: &str| fs::read(folder.path(name)).expect("it was written");
    assert!(bytes("right.png") == bytes("turned.png"));
    assert!(bytes("right.png") != bytes("front.png") && bytes("right.png") != bytes("low.png"));
    for lonely in [["--view", "front"], ["--size", "300"], ["--colour", "area"]] {
        let said = stderr(&folder.run(&[&["unwrap", "hare.obj", "-o", "out.obj"], &lonely[..]].concat()).code(2));
        assert!(said.contains("--picture"), "{said}");
    }
    for wrong in [["--view", "under"], ["--size", "9"], ["--colour", "blue"]] {
        folder.run(&[&["unwrap", "hare.obj", "-o", "x.obj", "--picture", "x.png"][..], &wrong].concat()).code(2);
    }
}

#[test]
fn every_colour_is_another_picture_and_another_layout() {
    let folder = Folder::with_shapes();
    let mut seen = Vec::new();
    for colour in ["checker", "area", "stretch", "factor", "islands", "plain"] {
        let outputs = ["--picture", "p.png", "--layout", "l.svg", "--colour", colour];
        unwrap(&folder, "hare.obj", &outputs);
        seen.push((fs::read(folder.path("p.png")).expect("it was written"), folder.read("l.svg")));
        assert_eq!(folder.read("l.svg").contains("linearGradient"), ["area", "stretch", "factor"].contains(&colour));
    }
    for (k, (picture, layout)) in seen.iter().enumerate() {
        assert!(seen[..k].iter().all(|(other, plane)| other != picture && plane != layout), "the {k}th");
    }
}

#[test]
fn that_a_surface_is_inside_out_is_told_below_its_picture() {
    let folder = Folder::with_shapes();
    let turn = |line: &str| match line.split_whitespace().collect::<Vec<_>>()[..] {
        ["f", a, b, c] => format!("f {c} {b} {a}\n"),
        _ => format!("{line}\n"),
    };
    let turned: String = folder.read("sphere.obj").lines().map(turn).collect();
    folder.write("turned.obj", &turned);
    for (input, picture) in [("sphere.obj", "out.png"), ("turned.obj", "in.png")] {
        unwrap(&folder, input, &["--picture", picture, "--view", "front"]);
    }
    let ([_, plain], [_, told]) = (size(&folder, "out.png"), size(&folder, "in.png"));
    assert!(told > plain + 20, "{told} {plain}");
}

#[test]
fn a_figure_s_values_are_those_of_the_command() {
    let folder = Folder::with_shapes();
    let args = ["figure", "1", "hare.obj", "-n", "3,6", "--panel", "200", "-o", "one.png"];
    let printed = stdout(&folder.run(&args).success());
    let paper = ["--method", "alternating", "--angles", "harmonic", "--open-handles", "never", "--report", "r.json"];
    unwrap(&folder, "hare.obj", &[&paper[..], &["--free-seams", "never"]].concat());
    let area = folder.json("r.json")["distortion"]["area_mean"].as_f64().expect("it is measured");
    let line = printed.lines().find(|line| line.contains("(b)")).expect("a line for the second map");
    assert!(line.contains("alternating+harmonic, 6 cones") && line.contains(&format!("D {area:.3}")), "{line} {area}");
    assert!(printed.contains("the paper, on its model: 47.361"), "{printed}");
    let [width, height] = size(&folder, "one.png");
    assert!(width > 400 && height > 2 * width / 2, "{width} {height}");
}

#[test]
fn one_command_draws_all_figures() {
    let folder = Folder::with_shapes();
    let drawn = |meshes: &[&str], output: &str| {
        let all = ["figure", "all", "-o", output, "--vertices", "600", "--panel", "200"];
        folder.run(&[&all[..], meshes].concat()).success();
        let entries = fs::read_dir(folder.path(output)).expect("it was made");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("it can be listed").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    let five = ["figure-1", "figure-2", "figure-3", "figure-4-hare", "figure-4-part", "figure-5", "readme"];
    assert_eq!(drawn(&[], "figures"), five.map(|name| format!("{name}.png")));
    let one = ["figure-1", "figure-2", "figure-3", "figure-4-sphere", "figure-5", "readme"];
    assert_eq!(drawn(&["sphere.obj"], "sphere"), one.map(|name| format!("{name}.png")));
    folder.complaint(&["figure", "2", "-o", "two.svg"]);
    assert!(folder.complaint(&["figure", "5", "--paper", ".", "-o", "five.png"]).contains("paper's models"));
}

#[test]
fn a_hierarchy_as_csv_has_the_numbers_of_the_json() {
    let folder = Folder::with_shapes();
    unwrap(&folder, "hare.obj", &["--hierarchy", "h.csv"]);
    unwrap(&folder, "hare.obj", &["--hierarchy", "h.json"]);
    let table = folder.read("h.csv");
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let document = folder.json("h.json");
    let order = document["order"].as_array().expect("it is an array");
    assert_eq!(rows.len(), order.len() + 1);
    assert_eq!(rows[0][..4], ["n", "component", "vertex", "curvature_at_n"]);
    for (row, cone) in rows[1..].iter().zip(order) {
        assert_eq!(row.len(), rows[0].len());
        assert_eq!((row[0], row[2]), (&*cone["n"].to_string(), &*cone["vertex"].to_string()));
        // A reader of JSON may round the last digit.
        let is_told = |text: &str, number: Option<f64>| match (text.parse::<f64>(), number) {
            (Ok(told), Some(number)) => (told - number).abs() <= 1e-14 * number.abs(),
            (told, number) => told.is_err() && number.is_none() && text.is_empty(),
        };
        assert!(is_told(row[3], cone["curvature_at_n"].as_f64()), "{row:?}");
        let of_curve =
            document["curve"].as_array().and_then(|curve| curve.iter().find(|point| point["n"] == cone["n"]));
        assert!(is_told(row[5], of_curve.and_then(|point| point["predicted_area"].as_f64())), "{row:?}");
    }
}

#[test]
fn a_vtp_has_a_cell_for_each_cone_seam_and_triangle() {
    let folder = Folder::with_shapes();
    unwrap(&folder, "hare.obj", &["--vtp", "out.vtp"]);
    let text = folder.read("out.vtp");
    let triangles = folder.read("hare.obj").lines().filter(|line| line.starts_with("f ")).count();
    assert!(text.contains("NumberOfVerts=\"6\"") && text.contains(&format!("NumberOfPolys=\"{triangles}\"")));
    for name in ["phi", "uv", "vertex", "kind", "curvature", "face", "island", "area", "stretch", "u"] {
        assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
    }
    folder.complaint(&["unwrap", "hare.obj", "-o", "out.obj", "--vtp", "out.vtk"]);
}

#[test]
fn a_field_s_report_is_one_page_for_meshes_arrays_and_networks() {
    let folder = Folder::with_shapes();
    folder.write("series.txt", "1\n3\n2\n4\n");
    folder.write("flat.txt", "1\n1\n1\n");
    folder.write("net.nodes.csv", "id,name,value\n0,a,1\n1,b,3\n2,c,0\n");
    folder.write("net.edges.csv", "a,b\n0,1\n1,2\n");
    let inputs: [&[&str]; 5] = [
        &["features", "hare.obj"],
        &["persistence", "hare.obj", "--field", "height"],
        &["persistence", "series.txt", "--direction", "sub"],
        &["persistence", "flat.txt"],
        &["persistence", "net.nodes.csv"],
    ];
    for input in inputs {
        folder.run(&[input, &["--report", "field.html"]].concat()).success();
        let page = folder.read("field.html");
        let (_, data) =
            page.rsplit_once("<script id=\"data\" type=\"application/octet-stream\">").expect("a place for data");
        assert!(data.len() > 200, "{input:?}: {}", data.len());
    }
    folder.complaint(&["features", "hare.obj", "--report", "field.json"]);
}

#[test]
fn the_page_of_a_network_has_its_values_and_the_names_of_its_nodes() {
    let folder = Folder::new();
    folder.write("net.nodes.csv", "id,name,value\n0,New York,1\n1,Utah,3\n2,Iowa,0\n");
    folder.write("net.edges.csv", "a,b\n0,1\n1,2\n");
    folder.run(&["persistence", "net.nodes.csv", "--report", "net.html"]).success();
    let page = folder.read("net.html");
    let (_, data) =
        page.rsplit_once("<script id=\"data\" type=\"application/octet-stream\">").expect("a place for data");
    let deflated = STANDARD.decode(data.split('<').next().expect("it ends")).expect("it is base64");
    let mut bytes = Vec::new();
    ZlibDecoder::new(&deflated[..]).read_to_end(&mut bytes).expect("it is deflated");
    let length = u32::from_le_bytes(bytes[..4].try_into().expect("four bytes")) as usize;
    let head: Value = serde_json::from_slice(&bytes[4..4 + length]).expect("JSON comes first");
    let field = &head["meta"]["field"];
    assert_eq!((&field["kind"], &field["range"]), (&json!("network"), &json!([0.0, 3.0])));
    assert_eq!(field["names"], json!(["New York", "Utah", "Iowa"]));
    for array in ["values", "basins.0", "basins.1"] {
        assert_eq!(head["arrays"][array]["length"], 3, "{array}");
    }
    assert_eq!(field["directions"][0]["pairs"][1][0], 0, "New York is a minimum, above Iowa");
}
