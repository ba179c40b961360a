//! Fields in files of more kinds, and what is made of them: trees, simpler fields, distances, pictures.

use crate::folder::{Folder, PROGRAM, stderr, stdout};
use assert_cmd::Command;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;
use std::fs::{self, File};
use std::io::Write;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

fn json(folder: &Folder, args: &[&str]) -> Value {
    serde_json::from_str(&stdout(&folder.run(&[args, &["--json"]].concat()).success())).expect("it is JSON")
}

/// An array of bytes as `NumPy` writes it; of three layers the second is from 50 on.
fn npy(shape: &str, count: usize) -> Vec<u8> {
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}\n");
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend((0..count).map(|i| (i % 3 * 50 + i / 3) as u8));
    file
}

/// A picture of 3 rows and 4 columns.
const MATRIX: &str = "9,3,1,4\n2,6,5,8\n7,3,0,4\n";

#[test]
fn a_matrix_is_a_matrix_in_whatever_text_it_comes() {
    let folder = Folder::new();
    folder.write("a.pgm", "P2 4 3 9\n9 3 1 4 2 6 5 8 7 3 0 4");
    folder.write("a.csv", MATRIX);
    folder.write("a.tsv", &MATRIX.replace(',', "\t"));
    folder.write("a.txt", &format!("# spaces\n\n{}", MATRIX.replace(',', "  ")));
    folder.write("b.csv", &MATRIX.replace(',', ";"));
    let expected = json(&folder, &["persistence", "a.pgm"]);
    for name in ["a.csv", "a.tsv", "a.txt", "b.csv"] {
        let found = json(&folder, &["persistence", name]);
        assert_eq!(found["input"]["shape"], expected["input"]["shape"], "{name}");
        assert_eq!(found["sublevel"], expected["sublevel"], "{name}");
    }
    folder.write("c.csv", "1,2\n3\n");
    let complaint = folder.complaint(&["persistence", "c.csv"]);
    assert!(complaint.contains("line 2") && complaint.contains("a line of 1 number where"), "{complaint}");
}

#[test]
fn a_series_has_positions() {
    let folder = Folder::new();
    folder.write("a.txt", "1\n5\n2\n");
    let told = stdout(&folder.run(&["persistence", "a.txt"]).success());
    assert!(told.starts_with("a.txt: series of 3 positions\n") && !told.contains("freudenthal"), "{told}");
}

#[test]
fn an_elevation_model_has_no_data_where_it_says_so() {
    let folder = Folder::new();
    let heights: [f32; 12] = [9.0, 3.0, 1.0, 4.0, 2.0, -9999.0, 5.0, 8.0, 7.0, 3.0, 0.5, 4.0];
    let file = File::create(folder.path("a.tif")).expect("it can be made");
    let mut encoder = TiffEncoder::new(file).expect("a header");
    let mut image = encoder.new_image::<colortype::Gray32Float>(4, 3).expect("a picture");
    image.encoder().write_tag(Tag::GdalNodata, "-9999").expect("a tag");
    image.write_data(&heights).expect("it can be written");
    assert!(folder.complaint(&["persistence", "a.tif"]).contains("vertex 5 is NaN"));
    let report = json(&folder, &["persistence", "a.tif", "--nan", "mask"]);
    assert_eq!(report["sublevel"]["essential"][0]["birth"], 0.5);
    assert_eq!(report["superlevel"]["essential"][0]["range"], 8.5);
    fs::write(folder.path("b.tif"), b"II*\0\xff\xff\xff\xff").expect("it can be written");
    assert!(folder.complaint(&["persistence", "b.tif"]).contains("TIFF"));
}

/// Writes pages of grey, each with its tag of what it is, and whether zero stands for white.
fn write_pages(folder: &Folder, name: &str, pages: &[(&[u8], [u32; 2], u32)], is_white_zero: bool) {
    let mut encoder = TiffEncoder::new(File::create(folder.path(name)).expect("it can be made")).expect("a header");
    for &(pixels, [width, height], kind) in pages {
        let mut image = encoder.new_image::<colortype::Gray8>(width, height).expect("a picture");
        image.encoder().write_tag(Tag::NewSubfileType, kind).expect("a tag");
        if is_white_zero {
            image.encoder().write_tag(Tag::PhotometricInterpretation, 0u16).expect("a tag");
            image.encoder().write_tag(Tag::GdalNodata, "200").expect("a tag");
        }
        image.write_data(pixels).expect("it can be written");
    }
}

#[test]
fn pages_of_one_size_are_a_volume() {
    let folder = Folder::new();
    let (dark, light): (&[u8], &[u8]) = (&[0; 12], &[0, 0, 0, 0, 0, 99, 0, 0, 0, 0, 0, 0]);
    write_pages(&folder, "a.tif", &[(dark, [4, 3], 0), (light, [4, 3], 0)], false);
    let report = json(&folder, &["persistence", "a.tif"]);
    assert_eq!(report["input"]["shape"], serde_json::json!([2, 3, 4]));
    assert_eq!(report["superlevel"]["essential"][0]["extremum"], 17);
    let (coarse, mask): (&[u8], &[u8]) = (&[7; 2], &[1; 12]);
    write_pages(&folder, "b.tif", &[(light, [4, 3], 0), (coarse, [2, 1], 1), (mask, [4, 3], 4)], false);
    assert_eq!(json(&folder, &["persistence", "b.tif"])["input"]["shape"], serde_json::json!([3, 4]));
    write_pages(&folder, "c.tif", &[(light, [4, 3], 0), (light, [3, 4], 0)], false);
    let complaint = folder.complaint(&["persistence", "c.tif"]);
    assert!(complaint.contains("c.tif") && complaint.contains("page 2 of another size"), "{complaint}");
}

#[test]
fn a_picture_where_zero_is_white_has_the_numbers_of_its_file() {
    let folder = Folder::new();
    write_pages(&folder, "a.tif", &[(&[10, 30, 50, 200], [4, 1], 0)], true);
    let report = json(&folder, &["persistence", "a.tif", "--nan", "mask"]);
    assert_eq!(report["sublevel"]["essential"][0]["birth"], 10.0);
    assert_eq!(report["superlevel"]["essential"][0]["birth"], 50.0);
    let complaint = folder.complaint(&["persistence", "a.tif"]);
    assert!(complaint.contains("vertex 3 is NaN or the file's no-data value"), "{complaint}");
    let mut encoder = TiffEncoder::new(File::create(folder.path("b.tif")).expect("it can be made")).expect("a header");
    let mut image = encoder.new_image::<colortype::GrayI16>(2, 1).expect("a picture");
    image.encoder().write_tag(Tag::PhotometricInterpretation, 0u16).expect("a tag");
    image.write_data(&[-5, 5]).expect("it can be written");
    assert!(folder.complaint(&["persistence", "b.tif"]).contains("zero stands for white"));
}

#[test]
fn cells_of_a_table_may_be_quoted_or_missing() {
    let folder = Folder::new();
    folder.write("plain.csv", "3,9\n1,nan\n4,nan\n");
    let masked = |input: &str| json(&folder, &["persistence", input, "--nan", "mask"])["sublevel"].clone();
    for (name, text) in [
        ("quoted.csv", "\"3\",\"9\"\n\"1\",\"\"\n\"4\",\"NA\"\n"),
        ("missing.csv", "3;9\n1;\n4;n/a\n"),
        ("words.tsv", "3\t9\n1\tN/A\n4\tnull\n"),
    ] {
        folder.write(name, text);
        assert_eq!(masked(name), masked("plain.csv"), "{name}");
        let complaint = folder.complaint(&["persistence", name]);
        assert!(complaint.contains("vertex 3 is NaN or missing"), "{complaint}");
    }
    folder.write("first.csv", "NA\n3\n1\n");
    assert_eq!(json(&folder, &["persistence", "first.csv", "--nan", "mask"])["input"]["vertices"], 3);
    folder.write("named.csv", "level\n3\n1\n");
    let told = stderr(&folder.run(&["persistence", "named.csv"]).success());
    assert!(told.contains("named.csv: the first line, level, is taken for names of columns"), "{told}");
}

#[test]
fn a_line_that_is_missing_in_a_column_is_missed() {
    let folder = Folder::new();
    folder.write("rows.tsv", "1\t2\t3\n\t\t\n4\t5\t6\n");
    let complaint = folder.complaint(&["persistence", "rows.tsv"]);
    assert!(complaint.contains("rows.tsv, line 2: is empty"), "{complaint}");
    for name in ["a.csv", "a.txt"] {
        folder.write(name, "# heights\n\n1\n5\n\n\n2\n");
        let complaint = folder.complaint(&["persistence", name]);
        assert!(complaint.contains(&format!("{name}, line 5: is empty")), "{complaint}");
        folder.write(name, "1\n5\n# between\n2\n\n\n");
        assert_eq!(json(&folder, &["persistence", name])["input"]["vertices"], 3, "{name}");
    }
    folder.write("b.csv", "1,5\n\n2,7\n");
    assert_eq!(json(&folder, &["persistence", "b.csv"])["input"]["vertices"], 4);
}

#[test]
fn a_network_may_have_semicolons() {
    let folder = Folder::new();
    folder.write("x.nodes.csv", "id;value\na;3\nb;5\nc;\"1\"\n");
    folder.write("x.edges.csv", "a;b\na;b\nb;c\n");
    let report = json(&folder, &["persistence", "x.nodes.csv"]);
    assert_eq!((&report["input"]["domain"], &report["input"]["edges"]), (&Value::from("network"), &Value::from(2)));
    assert_eq!(report["sublevel"]["pairs"][0]["persistence"], 2);
}

#[test]
fn standard_output_holds_one_thing() {
    let folder = Folder::new();
    folder.write("a.txt", "0\n5\n3\n4\n2\n9\n1\n");
    for (args, output) in [
        (&["persistence", "a.txt", "--pairs"][..], "p.csv"),
        (&["persistence", "a.txt", "--diagram"], "d.svg"),
        (&["tree", "a.txt", "-o"], "t.csv"),
        (&["simplify", "a.txt", "--threshold", "1", "-o"], "s.npy"),
    ] {
        let told = folder.run(&[args, &[output]].concat()).success();
        let piped = folder.run(&[args, &["-"]].concat()).success();
        assert_eq!(piped.get_output().stdout, fs::read(folder.path(output)).expect("it is there"), "{args:?}");
        assert_eq!(stderr(&piped), stdout(&told), "{args:?}");
        assert_eq!(stderr(&folder.run(&[args, &["-", "-q"]].concat()).success()), "", "{args:?}");
    }
    assert_eq!(stdout(&folder.run(&["simplify", "a.txt", "--threshold", "1", "-o", "s.npy", "-q"]).success()), "");
    for args in [
        &["persistence", "a.txt", "--pairs", "-", "--diagram", "-"][..],
        &["persistence", "a.txt", "--pairs", "-", "--json"],
        &["tree", "a.txt", "-o", "-", "--json"],
    ] {
        assert!(folder.complaint(args).contains("- is named for two outputs"), "{args:?}");
    }
}

#[test]
fn one_of_several_arrays_is_named() {
    let folder = Folder::new();
    let files: [(&str, &[u8]); 4] = [
        ("one.npz", include_bytes!("../files/one.npz")),
        ("two.npz", include_bytes!("../files/two.npz")),
        ("raw.vti", include_bytes!("../files/raw.vti")),
        ("cut.npz", &include_bytes!("../files/two.npz")[..300]),
    ];
    files.iter().for_each(|(name, bytes)| fs::write(folder.path(name), bytes).expect("it can be written"));
    let pairs = |args: &[&str]| json(&folder, &[&["persistence"], args].concat());
    let one = pairs(&["one.npz"]);
    assert_eq!(one["input"]["shape"], serde_json::json!([2, 3, 4]));
    assert_eq!(one["superlevel"]["essential"][0]["birth"], 2.25);
    assert_eq!(pairs(&["two.npz", "--array", "height"])["sublevel"], one["sublevel"]);
    assert_eq!(pairs(&["two.npz", "--array", "other"])["superlevel"]["essential"][0]["birth"], 0.0);
    assert_eq!(pairs(&["raw.vti", "--array", "other"])["sublevel"], one["sublevel"]);
    let told = stderr(&folder.run(&["persistence", "raw.vti", "--array", "other", "--pairs", "p.vtp"]).success());
    assert!(told.contains("without the image's origin and spacing"), "{told}");
    let complaint = folder.complaint(&["persistence", "two.npz"]);
    assert!(complaint.contains("height, other") && complaint.contains("--array"), "{complaint}");
    assert!(folder.complaint(&["persistence", "two.npz", "--array", "width"]).contains("\"width\""));
    assert!(folder.complaint(&["persistence", "cut.npz"]).contains("ZIP"));
    folder.write("a.txt", "1\n5\n2\n");
    assert!(folder.complaint(&["persistence", "a.txt", "--array", "height"]).contains("no name"));
}

/// An array of zeros that takes gigabytes where its archive takes some hundred kilobytes.
#[test]
fn an_archive_that_is_made_to_fill_memory_is_refused() {
    let folder = Folder::new();
    let file = File::create(folder.path("bomb.npz")).expect("it can be made");
    let mut archive = zip::ZipWriter::new(file);
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    archive.start_file("zeros.npy", options).expect("it can be begun");
    let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (60000000,), }\n";
    archive.write_all(b"\x93NUMPY\x01\x00").expect("it can be written");
    archive.write_all(&(header.len() as u16).to_le_bytes()).expect("it can be written");
    archive.write_all(header.as_bytes()).expect("it can be written");
    (0..60).for_each(|_| archive.write_all(&[0; 1_000_000]).expect("it can be written"));
    archive.finish().expect("it can be ended");
    let complaint = folder.complaint(&["persistence", "bomb.npz"]);
    assert!(complaint.contains("60000000"), "{complaint}");
}

#[test]
fn what_may_be_colours_is_asked_about() {
    let folder = Folder::new();
    fs::write(folder.path("a.npy"), npy("(4, 5, 3)", 60)).expect("it can be written");
    let complaint = folder.complaint(&["persistence", "a.npy"]);
    assert!(complaint.contains("[4, 5, 3]") && complaint.contains("--layer 0"), "{complaint}");
    let green = json(&folder, &["persistence", "a.npy", "--layer", "1"]);
    assert_eq!(green["input"]["shape"], serde_json::json!([4, 5]));
    assert_eq!(green["sublevel"]["essential"][0]["birth"], 50);
    assert_eq!(json(&folder, &["persistence", "a.npy", "--layer", "volume"])["input"]["vertices"], 60);
    assert!(folder.complaint(&["persistence", "a.npy", "--layer", "3"]).contains("no layer 3"));
    folder.run(&["persistence", "a.npy", "--layer", "red"]).code(2);
}

#[test]
fn a_layer_is_taken_of_what_may_be_colours_alone() {
    let folder = Folder::new();
    fs::write(folder.path("matrix.npy"), npy("(3, 4)", 12)).expect("it can be written");
    fs::write(folder.path("volume.npy"), npy("(5, 4, 6)", 120)).expect("it can be written");
    fs::write(folder.path("small.npy"), npy("(2, 2, 3)", 12)).expect("it can be written");
    for args in [["matrix.npy", "0"], ["matrix.npy", "volume"], ["volume.npy", "3"]] {
        let complaint = folder.complaint(&["persistence", args[0], "--layer", args[1]]);
        assert!(complaint.contains("--layer is for one of three axes") && complaint.contains(args[0]), "{complaint}");
    }
    assert_eq!(json(&folder, &["persistence", "volume.npy", "--layer", "volume"])["input"]["vertices"], 120);
    // Not asked about, as it is too small to be a picture of anything, but it may be one.
    assert_eq!(json(&folder, &["persistence", "small.npy", "--layer", "2"])["input"]["vertices"], 4);
}

#[test]
fn an_array_comes_gzipped_and_through_a_pipe_too() {
    let folder = Folder::with_shapes();
    let bytes = npy("(3, 4)", 12);
    fs::write(folder.path("a.npy"), &bytes).expect("it can be written");
    let gzipped = |name: &str, bytes: &[u8]| {
        let mut gzip = GzEncoder::new(File::create(folder.path(name)).expect("it can be made"), Compression::default());
        gzip.write_all(bytes).and_then(|()| gzip.finish().map(drop)).expect("it can be written");
    };
    gzipped("a.npy.gz", &bytes);
    let plain = json(&folder, &["persistence", "a.npy"]);
    let same = |found: &Value| {
        assert_eq!((&found["sublevel"], &found["superlevel"]), (&plain["sublevel"], &plain["superlevel"]));
    };
    same(&json(&folder, &["persistence", "a.npy.gz"]));
    let piped = |args: &[&str], bytes: &[u8]| {
        Command::new(PROGRAM).args(args).current_dir(folder.root()).write_stdin(bytes).assert()
    };
    let args = ["persistence", "-", "--json"];
    same(&serde_json::from_str(&stdout(&piped(&args, &bytes).success())).expect("it is JSON"));
    let mesh = fs::read(folder.path("hare.obj")).expect("it is there");
    piped(&["persistence", "-", "--field", "height"], &mesh).success();
    let told = |args: &[&str], bytes: &[u8]| stderr(&piped(args, bytes).code(1));
    assert!(told(&args, &mesh).contains("standard input: there is content that does not begin with"));
    assert!(told(&["measure", "-"], &mesh).contains("standard input has no texture coordinates"));
    // What expands as no array does, what is no gzip, and what is not read gzipped.
    gzipped("bomb.npy.gz", &[npy("(60000000,)", 0), vec![0; 60_000_000]].concat());
    assert!(folder.complaint(&["persistence", "bomb.npy.gz"]).contains("60000000"));
    fs::write(folder.path("plain.npy.gz"), &bytes).expect("it can be written");
    assert!(folder.complaint(&["persistence", "plain.npy.gz"]).contains("gzip"));
    assert!(folder.complaint(&["persistence", "a.pgm.gz"]).contains("unpack it first"));
    assert!(folder.complaint(&["persistence", "hare.obj.gz"]).contains("name a field with --field"));
    assert!(folder.complaint(&["persistence", "."]).contains(".: this is a directory"));
}

#[test]
fn a_tree_has_the_leaves_saddles_and_root_of_the_field() {
    let folder = Folder::new();
    folder.write("a.txt", "9\n1\n6\n4\n");
    let report = json(&folder, &["tree", "a.txt", "--direction", "sub", "-o", "a.csv"]);
    let tree = &report["trees"][0];
    assert_eq!((&tree["kind"], &tree["leaves"]), (&Value::from("minimum"), &Value::from(2)));
    let nodes: Vec<_> = tree["nodes"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|node| (node["vertex"].as_u64(), node["parent"].as_u64(), node["size"].as_u64()))
        .collect();
    let some = |vertex, parent, size| (Some(vertex), parent, size);
    assert_eq!(
        nodes,
        [some(1, Some(2), Some(4)), some(3, Some(2), Some(1)), some(2, Some(3), None), some(0, None, None)]
    );
    let csv = folder.read("a.csv");
    assert_eq!(csv.lines().nth(2), Some("minimum,1,3,4,2,1,3"), "{csv}");
    let told = stdout(&folder.run(&["tree", "a.txt"]).success());
    assert!(told.contains("minimum: tree of 2 leaves, 1 saddle, 1 root"), "{told}");
    let pruned = json(&folder, &["tree", "a.txt", "--min-persistence", "2", "--direction", "sub"]);
    assert_eq!(pruned["trees"][0]["leaves"], 1);
}

#[test]
fn a_simplified_field_is_written_in_its_own_numbers() {
    let folder = Folder::new();
    folder.write("a.txt", "0\n5\n3\n4\n2\n9\n1\n");
    let told = stdout(&folder.run(&["simplify", "a.txt", "--threshold", "1", "-o", "b.npy"]).success());
    assert_eq!(told, "3 of 4 minima and 2 of 3 maxima are left; no value is changed by more than 1\n");
    let by_other_name = folder.run(&["simplify", "a.txt", "--min-persistence", "1", "-o", "c.npy"]).success();
    assert_eq!(stdout(&by_other_name), told);
    let bytes = fs::read(folder.path("b.npy")).expect("it is there");
    let values: Vec<i64> = bytes[bytes.len() - 56..]
        .chunks_exact(8)
        .map(|bytes| i64::from_le_bytes(bytes.try_into().expect("eight")))
        .collect();
    assert_eq!(values, [0, 5, 4, 4, 2, 9, 1]);
    assert_eq!(json(&folder, &["persistence", "b.npy"])["sublevel"]["count"], 2);
    assert!(folder.complaint(&["simplify", "a.txt", "--threshold", "1", "-o", "b.txt"]).contains("end it in .npy"));
}

#[test]
fn fields_are_as_far_apart_as_their_diagrams() {
    let folder = Folder::new();
    folder.write("a.txt", "0\n6\n2\n9\n5\n");
    folder.write("b.txt", "0\n6\n1.5\n9\n8\n");
    let report = json(&folder, &["distance", "a.txt", "b.txt", "--order", "1"]);
    assert_eq!(report["sublevel"]["bottleneck"], 2.0);
    assert_eq!(report["sublevel"]["wasserstein"], 3.0);
    assert_eq!(json(&folder, &["distance", "a.txt", "a.txt"])["superlevel"]["wasserstein"], 0.0);
    let told = stdout(&folder.run(&["distance", "a.txt", "b.txt", "--direction", "sub"]).success());
    assert!(told.contains("2 and 2") && !told.contains("superlevel"), "{told}");
    folder.run(&["distance", "a.txt", "b.txt", "--order", "0.5"]).code(2);
    let limit = json(&folder, &["distance", "a.txt", "b.txt", "--order", "inf"]);
    assert_eq!((&limit["order"], &limit["sublevel"]["wasserstein"]), (&Value::from("inf"), &Value::from(2.0)));
    // Of (2, 6) and (5, 9) the first is left, and of (1.5, 6) and (8, 9).
    let args = ["distance", "a.txt", "b.txt", "--min-persistence", "4", "--order", "1"];
    let persistent = json(&folder, &args);
    assert_eq!(persistent["sublevel"]["pairs"], serde_json::json!([0, 1]));
    assert_eq!(persistent["sublevel"]["wasserstein"], 2.25);
}

#[test]
fn a_distance_is_as_exact_as_is_asked_for() {
    let folder = Folder::new();
    let zigzag = |seed: u64| -> String {
        let heights = (0..1200u64).map(|i| (i * i * seed + 7 * i) % 1009 + 2000 * (i % 2));
        heights.map(|height| format!("{height}\n")).collect()
    };
    folder.write("a.txt", &zigzag(3));
    folder.write("b.txt", &zigzag(5));
    let distance = |error: &str| {
        let args = ["distance", "a.txt", "b.txt", "--direction", "sub", "--relative-error", error];
        json(&folder, &args)["sublevel"]["wasserstein"].as_f64().expect("a number")
    };
    let (exact, near) = (distance("0"), distance("0.2"));
    assert!(exact < near && near <= 1.2 * exact, "{exact} {near}");
}

#[test]
fn extrema_are_drawn_over_the_picture_and_segments_are_shaded_by_it() {
    let folder = Folder::new();
    folder.write("a.csv", MATRIX);
    folder.write("s.txt", "1\n2\n");
    let pictures = ["--picture", "p.png", "--segmentation", "s.png", "--direction", "super"];
    folder.run(&[&["persistence", "a.csv"], &pictures[..]].concat()).success();
    for name in ["p.png", "s.png"] {
        let report = json(&folder, &["persistence", name]);
        // Each of three by four values is a square of 120 pixels.
        assert_eq!(report["input"]["shape"], serde_json::json!([360, 480]), "{name}");
    }
    assert!(folder.complaint(&["persistence", "s.txt", "--picture", "q.png"]).contains("two axes"));
}

#[test]
fn as_many_bars_are_drawn_as_are_asked_for() {
    let folder = Folder::new();
    let zigzag: String = (0..400).map(|i| format!("{}\n", if i % 2 == 0 { i } else { i + 1000 })).collect();
    folder.write("a.txt", &zigzag);
    let lines = |more: &[&str]| {
        let args = [&["persistence", "a.txt", "--direction", "sub", "--barcode", "b.svg"], more].concat();
        folder.run(&args).success();
        let svg = folder.read("b.svg");
        assert!(svg.contains('∞') && svg.contains("a.txt"), "the class that never dies and the title are told");
        svg.matches("<line").count() + svg.matches("<path").count()
    };
    let (few, many) = (lines(&[]), lines(&["--bars", "180"]));
    assert_eq!(many - few, 60);
    folder.run(&["persistence", "a.txt", "--bars", "5"]).code(2);
}

#[test]
fn an_array_file_that_is_none_is_told_by_what_it_holds() {
    let folder = Folder::new();
    for (content, expected) in [
        ("", "a.npy: there is an empty file where a NumPy array should be"),
        ("milk and bread", "content that does not begin with \\x93NUMPY where a NumPy array should be"),
    ] {
        folder.write("a.npy", content);
        let complaint = folder.complaint(&["persistence", "a.npy"]);
        assert!(complaint.contains(expected), "{complaint}");
    }
}
