//! `cones persistence` and `cones features` as a user runs them.

use crate::folder::{Folder, stderr, stdout};
use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The collection of fields, where it is at hand.
fn collection() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/fields");
    if !folder.is_dir() {
        println!("skipped: there is no {}", folder.display());
    }
    folder.is_dir().then_some(folder)
}

/// A row of the collection's index: the pairs and their total persistence, sublevel and superlevel, on each graph.
struct Row {
    file: String,
    graphs: HashMap<String, [(usize, f64); 2]>,
}

/// Reads `axis: 3228, 15305 / 2774, 29419; freudenthal: …` in the table's fourth column.
fn index(folder: &Path) -> Vec<Row> {
    let text = fs::read_to_string(folder.join("INDEX.md")).expect("the collection has an index");
    let rows = text.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| file"));
    rows.map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let graphs = cells[4].split(';').map(|graph| {
            let (name, figures) = graph.split_once(':').expect("a graph and its figures");
            let (sub, over) = figures.split_once('/').expect("both directions");
            let pairs = |figures: &str| {
                let mut words = figures.split([',', ' ']).filter(|word| !word.is_empty());
                let mut next = || words.next().expect("a figure");
                (next().parse().expect("a number of pairs"), next().parse().expect("a total"))
            };
            (name.trim().to_owned(), [pairs(sub), pairs(over)])
        });
        Row { file: cells[1].split('/').next().expect("a file").to_owned(), graphs: graphs.collect() }
    })
    .collect()
}

/// The arguments for a field of the collection on one of its graphs.
fn arguments(file: &str, graph: &str) -> Vec<String> {
    let words: Vec<&str> = match graph {
        "mesh" => vec!["conte69_lh_32492.obj", "--field", file, "--nan", "mask"],
        "axis" | "freudenthal" => vec![file, "--connectivity", graph],
        _ => vec![file],
    };
    words
        .into_iter()
        .map(|word| if word.contains('.') { format!("COLLECTION/{word}") } else { word.to_owned() })
        .collect()
}

#[test]
fn the_collection_has_the_pairs_that_its_index_tells() {
    let Some(collection) = collection() else { return };
    let folder = Folder::new();
    let rows = index(&collection);
    assert!(rows.len() > 15, "the index has {} rows", rows.len());
    for row in rows {
        for (graph, expected) in &row.graphs {
            let words = arguments(&row.file, graph);
            let words: Vec<String> =
                words.iter().map(|word| word.replace("COLLECTION", &collection.display().to_string())).collect();
            let mut args = vec!["persistence", "--json", "--top", "1"];
            args.extend(words.iter().map(String::as_str));
            let report: Value = serde_json::from_str(&stdout(&folder.run(&args).success())).expect("it is JSON");
            for (direction, (count, total)) in ["sublevel", "superlevel"].iter().zip(expected) {
                let name = format!("{} {graph} {direction}", row.file);
                assert_eq!(report[direction]["count"], *count, "{name}");
                let found = report[direction]["total_persistence"].as_f64().expect("a number");
                assert!((found - total).abs() <= 6e-6 * total, "{name}: {found}, not {total}");
            }
        }
    }
}

/// An array as `NumPy` writes it.
fn npy(descr: &str, is_fortran: bool, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let order = if is_fortran { "True" } else { "False" };
    let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(bytes);
    file
}

fn report(folder: &Folder, args: &[&str]) -> Value {
    let args = [&["persistence", "--json"], args].concat();
    serde_json::from_str(&stdout(&folder.run(&args).success())).expect("it is JSON")
}

/// A small landscape of 3 rows and 4 columns; along the axes its hills are 9, 8, 7 and 6.
const LANDSCAPE: [u8; 12] = [9, 3, 1, 4, 2, 6, 5, 8, 7, 3, 0, 4];

#[test]
fn a_field_has_the_same_pairs_in_whatever_form_it_comes() {
    let folder = Folder::new();
    let columns = |i: usize| LANDSCAPE[i % 3 * 4 + i / 3];
    let of = |bytes: &dyn Fn(u8) -> Vec<u8>| LANDSCAPE.iter().flat_map(|&x| bytes(x)).collect::<Vec<u8>>();
    let halves = [0x0000u16, 0x3c00, 0x4000, 0x4200, 0x4400, 0x4500, 0x4600, 0x4700, 0x4800, 0x4880];
    let forms: Vec<(&str, bool, Vec<u8>)> = vec![
        ("|u1", false, LANDSCAPE.to_vec()),
        ("|i1", true, (0..12).map(columns).collect()),
        ("<u2", false, of(&|x| u16::from(x).to_le_bytes().to_vec())),
        (">i2", false, of(&|x| i16::from(x).to_be_bytes().to_vec())),
        (">u4", false, of(&|x| u32::from(x).to_be_bytes().to_vec())),
        ("<i4", false, of(&|x| i32::from(x).to_le_bytes().to_vec())),
        (">i8", true, (0..12).flat_map(|i| i64::from(columns(i)).to_be_bytes()).collect()),
        ("<u8", false, of(&|x| u64::from(x).to_le_bytes().to_vec())),
        ("<f2", false, of(&|x| halves[x as usize].to_le_bytes().to_vec())),
        (">f4", true, (0..12).flat_map(|i| f32::from(columns(i)).to_be_bytes()).collect()),
        ("<f8", false, of(&|x| f64::from(x).to_le_bytes().to_vec())),
    ];
    let text: String = LANDSCAPE.iter().map(|x| format!("{x} ")).collect();
    fs::write(folder.path("a.pgm"), format!("P2 4 3 9\n{text}")).expect("it can be written");
    let expected = report(&folder, &["a.pgm"]);
    assert_eq!(expected["sublevel"]["essential"][0]["extremum"], 10);
    for (descr, is_fortran, bytes) in forms {
        fs::write(folder.path("a.npy"), npy(descr, is_fortran, "(3, 4)", &bytes)).expect("it can be written");
        let found = report(&folder, &["a.npy"]);
        for direction in ["sublevel", "superlevel"] {
            for list in ["pairs", "essential"] {
                assert_eq!(as_floats(&found[direction][list]), as_floats(&expected[direction][list]), "{descr}");
            }
        }
    }
}

/// The same with all numbers as floats: 3 and 3.0 are different JSON.
fn as_floats(value: &Value) -> Value {
    match value {
        Value::Number(number) => Value::from(number.as_f64()),
        Value::Array(items) => items.iter().map(as_floats).collect(),
        Value::Object(map) => map.iter().map(|(key, value)| (key.clone(), as_floats(value))).collect(),
        other => other.clone(),
    }
}

#[test]
fn the_report_has_the_documented_keys() {
    let folder = Folder::new();
    fs::write(folder.path("a.npy"), npy("|u1", false, "(3, 4)", &LANDSCAPE)).expect("it can be written");
    let report = report(&folder, &["a.npy", "--connectivity", "axis", "--periodic", "x"]);
    let keys = |value: &Value| {
        let mut keys: Vec<&str> = value.as_object().expect("an object").keys().map(String::as_str).collect();
        keys.sort_unstable();
        keys.join(" ")
    };
    assert_eq!(keys(&report), "input schema sublevel superlevel times");
    assert_eq!(keys(&report["input"]), "connectivity domain edges path periodic shape vertices");
    assert_eq!((&report["input"]["vertices"], &report["input"]["edges"]), (&Value::from(12), &Value::from(20)));
    for direction in ["sublevel", "superlevel"] {
        let direction = &report[direction];
        assert_eq!(keys(direction), "count essential pairs total_persistence zero_pairs");
        assert_eq!(keys(&direction["pairs"][0]), "birth death extremum persistence saddle");
        assert_eq!(keys(&direction["essential"][0]), "birth extremum range");
    }
}

#[test]
fn what_cannot_be_written_is_told_before_anything_is() {
    let folder = Folder::new();
    folder.write("a.txt", "1\n2\n");
    folder.write("x.nodes.csv", "id,value\na,1\nb,2\n");
    folder.write("x.edges.csv", "a,b\na,b\n");
    let before = folder.names();
    for (input, output) in
        [("a.txt", "--segmentation=s.png"), ("a.txt", "--segmentation=s.ply"), ("x.nodes.csv", "--pairs=p.vtp")]
    {
        folder.complaint(&[
            "persistence",
            input,
            "--direction",
            "sub",
            "--diagram",
            "d.svg",
            "--barcode=b.svg",
            output,
        ]);
        assert_eq!(folder.names(), before, "{output}");
    }
    let negative = stderr(&folder.run(&["persistence", "a.txt", "--min-persistence", "-1"]).code(2));
    assert!(
        negative.contains("invalid value '-1'") && negative.contains("expected a number, at least 0"),
        "{negative}"
    );
}

#[test]
fn integers_are_told_exactly() {
    let folder = Folder::new();
    let values = [u64::MAX, 0, u64::MAX - 1];
    let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(folder.path("a.npy"), npy("<u8", false, "(3,)", &bytes)).expect("it can be written");
    let report = report(&folder, &["a.npy"]);
    assert_eq!(report["superlevel"]["essential"][0]["range"], u64::MAX);
    assert_eq!(report["superlevel"]["pairs"][0]["persistence"], u64::MAX - 1);
}

#[test]
fn options_choose_among_the_pairs() {
    let folder = Folder::new();
    folder.write("a.txt", "# a series\n0\n5\n5\n3\n4\n4\n4\n1\n");
    let count = |args: &[&str]| {
        let report = report(&folder, &[&["a.txt"], args].concat());
        ["sublevel", "superlevel"].map(|direction| report[direction]["pairs"].as_array().map(Vec::len))
    };
    assert_eq!(count(&[]), [Some(2), Some(1)]);
    assert_eq!(count(&["--direction", "super"]), [None, Some(1)]);
    assert_eq!(count(&["--min-persistence", "1"]), [Some(1), Some(0)]);
    assert_eq!(count(&["--top", "1"]), [Some(0), Some(0)], "the essential class comes first");
    let told = stdout(&folder.run(&["persistence", "a.txt", "--top", "1"]).success());
    assert!(told.contains("… and 2 less persistent; a greater --top gives more\n"), "{told}");
    assert!(count(&["--keep-zero"])[0] >= Some(2));
    folder.run(&["persistence", "a.txt", "--keep-zero", "--min-persistence", "1"]).code(2);
    folder.run(&["persistence", "a.txt", "--periodic", "w"]).code(2);
}

#[test]
fn infinities_are_values_and_nan_is_what_it_is_told_to_be() {
    let folder = Folder::new();
    folder.write("a.txt", "-inf\n2\ninf\nnan\n1\n3\n");
    let complaint = folder.complaint(&["persistence", "a.txt"]);
    assert!(complaint.contains("a.txt") && complaint.contains("vertex 3 is NaN") && complaint.contains("--nan mask"));
    let report = report(&folder, &["a.txt", "--nan", "mask"]);
    let essential = &report["sublevel"]["essential"];
    assert_eq!((&essential[0]["birth"], &essential[0]["range"]), (&Value::from("-inf"), &Value::from("inf")));
    assert_eq!(essential[1]["extremum"], 4);
    folder.run(&["persistence", "a.txt", "--nan", "mask", "--diagram", "a.svg", "--barcode", "b.svg"]).success();
}

#[test]
fn pairs_are_written_in_every_form_that_is_promised() {
    let folder = Folder::new();
    fs::write(folder.path("a.npy"), npy("|u1", false, "(3, 4)", &LANDSCAPE)).expect("it can be written");
    let pairs = report(&folder, &["a.npy", "--pairs", "a.json"]);
    assert_eq!(folder.json("a.json")["sublevel"], pairs["sublevel"]);
    folder.run(&["persistence", "a.npy", "--pairs", "a.csv", "--connectivity", "axis"]).success();
    let csv = folder.read("a.csv");
    let mut lines = csv.lines();
    let head = "kind,extremum,saddle,birth,death,persistence,extremum_y,extremum_x,saddle_y,saddle_x";
    assert_eq!(lines.next(), Some(head));
    assert_eq!(lines.next(), Some("minimum,10,,0,,9,2,2,,"));
    assert!(lines.all(|line| line.split(',').count() == 10));
    folder.run(&["persistence", "a.npy", "--pairs", "a.vtp"]).success();
    let vtp = folder.read("a.vtp");
    let finite =
        ["sublevel", "superlevel"].map(|direction| pairs[direction]["pairs"].as_array().expect("a list").len());
    let lines = finite[0] + finite[1];
    assert!(vtp.contains(&format!("NumberOfPoints=\"{}\"", 2 * lines + 2)), "{vtp}");
    assert!(vtp.contains(&format!("NumberOfLines=\"{lines}\"")) && vtp.ends_with("</VTKFile>\n"));
    for (option, name) in [("--diagram", "d"), ("--barcode", "b")] {
        let (svg, png) = (format!("{name}.svg"), format!("{name}.png"));
        folder.run(&["persistence", "a.npy", option, &svg]).success();
        assert!(folder.read(&svg).contains("minima"));
        assert!(folder.complaint(&["persistence", "a.npy", option, &png]).contains("end it in .svg"));
    }
}

#[test]
fn segments_are_labelled_with_their_extrema() {
    let folder = Folder::new();
    fs::write(folder.path("a.npy"), npy("|u1", false, "(3, 4)", &LANDSCAPE)).expect("it can be written");
    let args = ["persistence", "a.npy", "--connectivity", "axis", "--direction", "super", "--segmentation"];
    folder.run(&[&args[..], &["s.npy"]].concat()).success();
    let bytes = fs::read(folder.path("s.npy")).expect("it is there");
    let labels: Vec<i32> =
        bytes[bytes.len() - 48..].chunks(4).map(|b| i32::from_le_bytes(b.try_into().expect("four bytes"))).collect();
    assert_eq!(bytes.len() % 64, 48, "values begin at a multiple of 64");
    assert_eq!([0, 5, 7, 8].map(|hill| labels[hill]), [0, 5, 7, 8], "an extremum is in its own segment");
    assert!(labels.iter().all(|label| [0, 5, 7, 8].contains(label)), "{labels:?}");
    // What was written can be read, and merged segments are fewer.
    assert_eq!(report(&folder, &["s.npy"])["input"]["shape"], Value::from(vec![3, 4]));
    folder.run(&[&args[..], &["t.npy", "--min-persistence", "8"]].concat()).success();
    let merged = fs::read(folder.path("t.npy")).expect("it is there");
    assert!(merged[merged.len() - 48..].iter().all(|&byte| byte == 0), "one hill is left, that of vertex 0");
    folder.run(&[&args[..], &["s.png"]].concat()).success();
    assert!(folder.complaint(&[&args[..], &["s.ply"]].concat()).contains("a mesh only"));
    let both = folder.complaint(&["persistence", "a.npy", "--segmentation", "u.npy"]);
    assert!(both.contains("--direction sub"), "{both}");
}

#[test]
fn a_mesh_has_fields_of_its_own() {
    let folder = Folder::with_shapes();
    for field in ["phi", "curvature", "mean-curvature", "height", "height:x", "distance", "distance:3"] {
        let report = report(&folder, &["hare.obj", "--field", field]);
        assert_eq!(report["input"]["domain"], "mesh", "{field}");
        assert_eq!(report["sublevel"]["essential"].as_array().map(Vec::len), Some(1), "{field}");
        // V - E + F = 2, and 3 F = 2 E.
        let count = |key: &str| report["input"][key].as_u64().expect("a number");
        assert_eq!(count("edges"), 3 * count("vertices") - 6, "{field}");
    }
    assert_eq!(report(&folder, &["hare.obj", "--field", "distance:3"])["sublevel"]["essential"][0]["extremum"], 3);
    let args = ["persistence", "hare.obj", "--field", "height:y", "--direction", "super", "--segmentation", "s.ply"];
    folder.run(&args).success();
    let ply = geom::io::read(folder.path("s.ply")).expect("what is written can be read");
    let hare = geom::io::read(folder.path("hare.obj")).expect("it is a mesh");
    assert_eq!((ply.points(), ply.face_count()), (hare.points(), hare.face_count()));
    folder.write("short.txt", "1\n2\n3\n");
    let complaint = folder.complaint(&["persistence", "hare.obj", "--field", "short.txt"]);
    assert!(complaint.contains("short.txt") && complaint.contains("has 3 values where the mesh has"), "{complaint}");
    assert!(folder.complaint(&["persistence", "hare.obj"]).contains("--field"));
    assert!(folder.complaint(&["persistence", "hare.obj", "--field", "distance:99999"]).contains("vertex 99999"));
}

#[test]
fn numbers_at_the_vertices_of_a_ply_are_a_field() {
    let folder = Folder::new();
    let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                property double quality\nproperty short label\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
    folder.write("a.ply", &format!("{head}0 0 0 .5 3\n1 0 0 .25 7\n1 1 0 4 1\n0 1 0 2 9\n3 0 1 2\n3 0 2 3\n"));
    let quality = report(&folder, &["a.ply", "--field", "quality"]);
    assert_eq!(quality["sublevel"]["essential"][0]["birth"], 0.25);
    assert_eq!(report(&folder, &["a.ply", "--field", "label"])["superlevel"]["essential"][0]["birth"], 9);
    let complaint = folder.complaint(&["persistence", "a.ply", "--field", "qualty"]);
    assert!(
        complaint.contains("a.ply: has no numbers called qualty at its vertices, only quality, label"),
        "{complaint}"
    );
    folder.run(&["persistence", "a.ply", "--field", "height:w"]).code(2);
}

#[test]
fn a_network_is_two_tables() {
    let folder = Folder::new();
    folder.write("x.nodes.csv", "id,name,value\nann,\"Ann, of Arc\",3\nbob,Bob,5\ncid,Cid, 1\ndon,Don,4\n");
    folder.write("x.edges.csv", "a,b,weight\nann,bob,1\nbob,cid,2\ncid,don,3\n");
    let report = report(&folder, &["x.nodes.csv", "--pairs", "x.csv"]);
    assert_eq!((&report["input"]["domain"], &report["input"]["edges"]), (&Value::from("network"), &Value::from(3)));
    let pair = &report["sublevel"]["pairs"][0];
    assert_eq!((&pair["extremum_name"], &pair["saddle_name"]), (&Value::from("Ann, of Arc"), &Value::from("Bob")));
    assert_eq!((&pair["persistence"], &pair["saddle"]), (&Value::from(2), &Value::from(1)));
    assert!(folder.read("x.csv").contains("minimum,0,1,3,5,2,\"Ann, of Arc\",Bob"));
    assert!(stdout(&folder.run(&["persistence", "x.nodes.csv"]).success()).contains("Cid"));
    assert!(folder.complaint(&["persistence", "x.nodes.csv", "--pairs", "x.vtp"]).contains("nowhere in space"));
    for (nodes, edges, told) in [
        ("id,name\na,b\n", "a,b\n", "nodes.csv, line 1: there is no column named value"),
        ("id,value\na,1\na,2\n", "a,b\n", "nodes.csv, line 3: the id \"a\" was there before"),
        ("id,value\na,one\n", "a,b\n", "nodes.csv, line 2: there is \"one\" where a number should be"),
        ("id,value\na,1,2\n", "a,b\n", "nodes.csv, line 2: there are 3 cells where the first line names 2"),
        ("id,value\na,1\n", "a,b\na,z\n", "edges.csv, line 2: no node has the id \"z\""),
        ("id,value\na,1\n", "from,to\n", "edges.csv, line 1: there is no column named a"),
        ("id,value\n", "a,b\n", "nodes.csv: holds no values"),
    ] {
        folder.write("nodes.csv", nodes);
        folder.write("edges.csv", edges);
        let complaint = folder.complaint(&["persistence", "nodes.csv", "--edges", "edges.csv"]);
        assert!(complaint.contains(told), "{complaint}");
    }
    assert!(folder.complaint(&["persistence", "nodes.csv"]).contains("--edges"));
}

#[test]
fn edges_of_a_network_that_join_nothing_new_are_counted_in_one_line() {
    let folder = Folder::new();
    folder.write("x.nodes.csv", "id,value\na,3\nb,5\nc,1\n");
    for (edges, told) in [
        ("a,b\nb,c\n", ""),
        ("a,b\nb,c\nb,b\n", "x.edges.csv: left out 1 edge from a node to itself\n"),
        ("a,b\nb,a\nb,c\na,b\n", "x.edges.csv: left out 2 edges that are listed before\n"),
        (
            "c,c\na,b\nb,a\nb,c\nc,c\n",
            "x.edges.csv: left out 2 edges from a node to itself and 1 edge that is listed before\n",
        ),
    ] {
        folder.write("x.edges.csv", &format!("a,b\n{edges}"));
        let done = folder.run(&["persistence", "x.nodes.csv", "--json"]).success();
        let report: Value = serde_json::from_str(&stdout(&done)).unwrap();
        assert_eq!(report["input"]["edges"], 2);
        let said = stderr(&done);
        assert_eq!((said.contains(told), said.lines().count()), (true, usize::from(!told.is_empty())), "{said}");
    }
}

#[test]
fn what_is_no_field_is_refused_with_the_reason() {
    let folder = Folder::new();
    let lying = npy("<f8", false, "(100000, 100000, 100000)", &[0; 64]);
    let endless = npy("<f8", false, "(18446744073709551615, 18446744073709551615)", &[]);
    let four = npy("|u1", false, "(1, 1, 1, 1)", &[7]);
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("a.npy", vec![], "NumPy array"),
        ("a.npy", b"\x93NUMPY\x02\x00\xff\xff\xff\x7f".to_vec(), "a header of"),
        ("a.npy", b"\x93NUMPY\x01\x00\xff\x00{'descr'".to_vec(), "the end of the file"),
        ("a.npy", b"\x93NUMPY\x09\x00\x00\x00".to_vec(), "version 9"),
        ("a.npy", lying, "claims 1000000000000000 values, but the file ends after 8"),
        ("a.npy", endless, "more values than can be counted"),
        ("a.npy", four, "has 4 axes"),
        ("a.npy", npy("<c8", false, "(1,)", &[0; 8]), "\"<c8\", which is not a real number"),
        ("a.npy", npy("|u1", false, "(3,)", &[0; 2]), "ends after 2"),
        ("a.pgm", b"P5 9 9 255\n123".to_vec(), "ends after 3"),
        ("a.pgm", b"P6 9 9 255\n123".to_vec(), "P2 or P5"),
        ("a.png", b"\x89PNG\r\n\x1a\nrest".to_vec(), "PNG"),
        ("a.txt", b"1\n\nx\n".to_vec(), "line 3: there is \"x\" where a number should be"),
        ("a.txt", b"# nothing\n".to_vec(), "no values"),
        ("a.docx", b"1".to_vec(), "no known form"),
    ];
    for (name, bytes, told) in cases {
        fs::write(folder.path(name), bytes).expect("it can be written");
        let complaint = folder.complaint(&["persistence", name]);
        assert!(complaint.contains(told) && complaint.contains(name), "{complaint}");
    }
    assert!(folder.complaint(&["persistence", "missing.npy"]).contains("missing.npy"));
    fs::write(folder.path("b.npy"), npy("|u1", false, "(3,)", &[1, 2, 3])).expect("it can be written");
    assert!(folder.complaint(&["persistence", "b.npy", "--field", "phi"]).contains("--field is for a mesh"));
    assert!(folder.complaint(&["persistence", "b.npy", "--periodic", "y"]).contains("no axis y"));
    folder.write("b.json", "");
    assert!(folder.complaint(&["persistence", "b.npy", "--pairs", "b.npy"]).contains(".csv"));
    assert!(folder.complaint(&["persistence", "b.npy", "--segmentation", "./b.npy"]).contains("never overwritten"));
}

#[test]
fn an_array_larger_than_memory_is_refused_with_the_size_it_needs() {
    let folder = Folder::new();
    // A file of holes takes no room on the disk.
    let header = npy("|u1", false, "(2000000, 2000000)", &[]);
    fs::write(folder.path("huge.npy"), &header).expect("it can be written");
    let file = fs::File::options().write(true).open(folder.path("huge.npy")).expect("it is there");
    if file.set_len(header.len() as u64 + 4_000_000_000_000).is_err() {
        println!("skipped: the file system has no files of 4 TB");
        return;
    }
    let complaint = folder.complaint(&["persistence", "huge.npy"]);
    let told = if cfg!(target_os = "linux") { "112.0 TB of memory" } else { "can be numbered" };
    assert!(complaint.contains(told), "{complaint}");
}

#[test]
fn arrays_without_values_have_no_pairs() {
    let folder = Folder::new();
    let huge = u64::MAX;
    let shapes = ["(0,)".to_owned(), "(3, 0)".into(), format!("(0, {huge}, 9)"), format!("({huge}, {huge}, 0)")];
    for (shape, is_fortran) in shapes.iter().flat_map(|shape| [(shape, false), (shape, true)]) {
        fs::write(folder.path("a.npy"), npy("<f8", is_fortran, shape, &[])).expect("it can be written");
        let report = report(&folder, &["a.npy", "--diagram", "a.svg", "--barcode", "b.svg", "--pairs", "a.vtp"]);
        assert_eq!(report["sublevel"]["essential"].as_array().map(Vec::len), Some(0), "{shape}");
        assert_eq!(report["input"]["edges"], 0);
        assert!(report["sublevel"]["total_persistence"].as_f64().is_some_and(f64::is_sign_positive), "{shape}");
    }
}

#[test]
fn feature_points_are_the_most_persistent_extrema() {
    let folder = Folder::with_shapes();
    let features = |args: &[&str]| -> Value {
        let args = [&["features", "hare.obj", "--json"], args].concat();
        serde_json::from_str(&stdout(&folder.run(&args).success())).expect("it is JSON")
    };
    for field in ["phi", "mean-curvature"] {
        for method in ["persistence", "alternating"] {
            let few = features(&["--field", field, "--method", method, "-n", "5"]);
            let more = features(&["--field", field, "--method", method, "-n", "6"]);
            let list = |report: &Value| report["extrema"].as_array().expect("a list").clone();
            assert_eq!(list(&few), list(&more)[..5], "the hierarchy is nested");
            let first: Vec<_> = list(&few).iter().take(2).map(|extremum| extremum["saddle"].clone()).collect();
            assert_eq!(first, [Value::Null, Value::Null], "it begins with the global extrema");
        }
    }
    let done = folder.run(&["features", "hare.obj", "-n", "4", "-o", "f.csv", "--picture", "f.png"]).success();
    assert!(stdout(&done).contains("4 feature points of"), "{}", stdout(&done));
    assert_eq!(folder.read("f.csv").lines().count(), 5);
    assert!(fs::metadata(folder.path("f.png")).expect("it is there").len() > 10_000);
    let above = features(&["--min-persistence", "0.3"]);
    let persistences = above["extrema"].as_array().expect("a list").iter().map(|e| e["persistence"].as_f64());
    assert!(persistences.into_iter().all(|persistence| persistence > Some(0.3)));
    assert_eq!(above["count"], features(&[])["count"], "it is of the field, whatever is listed");
    folder.run(&["features", "hare.obj", "-n", "4", "--min-persistence", "1"]).code(2);
}

#[test]
fn a_spreadsheet_may_name_its_columns_and_a_missing_one_is_missed() {
    let folder = Folder::new();
    folder.write("plain.csv", "3\n1\n4\n1.5\n");
    folder.write("named.csv", "level (m)\n3\n1\n4\n1.5\n");
    let pairs = |input: &str| report(&folder, &[input])["sublevel"].clone();
    assert_eq!(pairs("named.csv"), pairs("plain.csv"));
    folder.write("late.csv", "level\n3\nlevel\n4\n");
    let complaint = folder.complaint(&["persistence", "late.csv"]);
    assert!(complaint.contains("late.csv, line 3: there is \"level\" where a number should be"), "{complaint}");
    folder.write("series.txt", "level\n3\n4\n");
    assert!(folder.complaint(&["persistence", "series.txt"]).contains("series.txt, line 1:"));
    for missing in ["none.csv", "none.npy", "none.txt", "none.png"] {
        let complaint = folder.complaint(&["persistence", missing]);
        assert!(complaint.contains(&format!("{missing}: there is no such file")), "{complaint}");
    }
}
