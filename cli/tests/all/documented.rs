//! The page on JSON outputs has every key that the program writes.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::baking::png;
use crate::folder::{Folder, stdout};

const PAGE: &str = include_str!("../../../docs/json.md");

/// All keys of a document, at any depth.
fn keys(document: &Value, found: &mut BTreeSet<String>) {
    match document {
        Value::Object(entries) => entries.iter().for_each(|(key, value)| {
            found.insert(key.clone());
            keys(value, found);
        }),
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

/// Whether the page has a heading's section name a key, or one of the sections that it refers to.
fn assert_documented(heading: &str, document: &Value) {
    let sections: Vec<&str> = PAGE.split("\n## ").collect();
    let section = |heading: &str| {
        *sections.iter().find(|section| section.starts_with(heading)).unwrap_or_else(|| panic!("no section {heading}"))
    };
    let mut told = section(heading).to_owned();
    if told.contains("#distortion-and-islands") || told.starts_with("extract") || told.starts_with("Hierarchy") {
        told += section("Report");
    }
    if told.starts_with("features") {
        told += section("persistence");
    }
    let mut found = BTreeSet::new();
    keys(document, &mut found);
    assert!(found.contains("schema"), "{heading}");
    let missing: Vec<&String> = found.iter().filter(|key| !told.contains(&format!("`{key}`"))).collect();
    assert!(missing.is_empty(), "{heading}: docs/json.md does not name {missing:?}");
}

#[test]
fn every_key_of_every_json_output_is_on_the_page() {
    let folder = Folder::with_shapes();
    let printed = |args: &[&str]| -> Value {
        serde_json::from_str(&stdout(&folder.run(args).success())).expect("it is one JSON document")
    };
    let unwrap = ["unwrap", "hare.obj", "-o", "out.obj", "--hierarchy", "order.json", "--layout", "l.svg", "--json"];
    assert_documented("Report", &printed(&unwrap));
    assert_documented("Hierarchy", &folder.json("order.json"));
    assert_documented("extract", &printed(&["extract", "hare.obj", "--json"]));
    assert_documented("measure", &printed(&["measure", "out.obj", "--reference", "hare.obj", "--json"]));
    assert_documented("pack", &printed(&["pack", "out.obj", "-o", "packed.obj", "--json"]));
    assert_documented("islands", &printed(&["islands", "out.obj", "-o", "apart.obj", "--json"]));
    folder.write("hare.mtl", "newmtl fur\nmap_Kd fur.png\n");
    folder.write("fur.obj", &format!("mtllib hare.mtl\nusemtl fur\n{}", folder.read("out.obj")));
    std::fs::write(folder.path("fur.png"), png(4, |_, _| [9; 3])).expect("a temporary folder can be written to");
    assert_documented("bake", &printed(&["bake", "fur.obj", "packed.obj", "-o", "packed.png", "--json"]));
    assert_documented("features", &printed(&["features", "hare.obj", "--json"]));
    assert_documented("persistence", &printed(&["persistence", "hare.obj", "--field", "height", "--json"]));
    folder.write("series.txt", "1\n3\n2\n4\n");
    assert_documented("persistence", &printed(&["persistence", "series.txt", "--json"]));
    assert_documented("tree", &printed(&["tree", "series.txt", "--json"]));
    assert_documented("distance", &printed(&["distance", "series.txt", "series.txt", "--json"]));
    folder.write("net.nodes.csv", "id,name,value\n0,a,1\n1,b,3\n2,c,0\n");
    folder.write("net.edges.csv", "a,b\n0,1\n1,2\n");
    assert_documented("persistence", &printed(&["persistence", "net.nodes.csv", "--json"]));
    let compare = ["compare", "hare.obj", "-n", "4", "--method", "refined,lscm", "--best-of", "1", "--format", "json"];
    assert_documented("compare", &printed(&compare));
    let tiled = ["unwrap", "hare.obj", "-n", "8", "-o", "out.obj", "--quantize", "4", "--json"];
    assert_documented("Report", &printed(&tiled));
    let many = stdout(&folder.run(&["unwrap", "hare.obj", "-n", "4", "--out-dir", "many", "--json"]).success());
    for line in many.lines() {
        let mut line: Value = serde_json::from_str(line).expect("each line is a document");
        // What it holds is told where the report is.
        line["report"] = Value::Null;
        assert_documented("Lines", &line);
    }
    // What is mended is told with places of vertices and of faces.
    folder.write("torn.obj", &format!("v 9 9 9\n{}f 1 2 2\nf 2 2 3\n", folder.read("sphere.obj")));
    assert_documented("Report", &printed(&["unwrap", "torn.obj", "-n", "4", "-o", "torn-out.obj", "--json"]));
}

#[test]
fn what_the_paper_table_adds_is_on_the_page() {
    let folder = Folder::with_shapes();
    // Any mesh stands in for Fandisk.
    for place in ["table1", "table1_resized"] {
        std::fs::create_dir(folder.path(place)).expect("a folder can be made");
    }
    folder.run(&["shape", "part", "--vertices", "300", "-o", "table1_resized/fandisk_28910.obj"]).success();
    let args = ["compare", "--paper", ".", "--best-of", "1", "--format", "json"];
    let document = serde_json::from_str(&stdout(&folder.run(&args).success())).expect("it is one JSON document");
    assert_documented("compare", &document);
}
