//! `--hierarchy`: the order of cones for every number of them.

use crate::folder::Folder;
use serde_json::Value;

/// `hare.obj`, and `family.obj` with a sphere, a torus and a piece of terrain in it.
fn folder() -> Folder {
    let folder = Folder::with_shapes();
    let (mut text, mut count) = (String::new(), 0);
    for (shape, shift) in [("hare", 0.0), ("torus-1", 5.0), ("terrain", 10.0)] {
        let name = format!("{shape}.obj");
        folder.run(&["shape", shape, "--vertices", "400", "-o", &name]).success();
        let part = folder.read(&name);
        let vertices = part.lines().filter_map(|line| line.strip_prefix("v "));
        for vertex in vertices.clone() {
            let numbers: Vec<f64> = vertex.split_whitespace().map(|x| x.parse().expect("a number")).collect();
            text += &format!("v {} {} {}\n", numbers[0] + shift, numbers[1], numbers[2]);
        }
        for face in part.lines().filter_map(|line| line.strip_prefix("f ")) {
            let corner = |c: &str| c.parse::<usize>().expect("an index") + count;
            text +=
                &format!("f {}\n", face.split_whitespace().map(|c| corner(c).to_string() + " ").collect::<String>());
        }
        count += vertices.count();
    }
    folder.write("family.obj", &text);
    folder
}

fn hierarchy(folder: &Folder, input: &str, options: &[&str]) -> Value {
    folder.run(&[&["extract", input, "--hierarchy", "h.json"], options].concat()).success();
    folder.json("h.json")
}

/// Vertex and curvature of each cone that `-n` takes.
fn taken(folder: &Folder, input: &str, count: usize, options: &[&str]) -> Vec<(u64, f64)> {
    let count = count.to_string();
    let run = [&["extract", input, "-n", &count, "--cones-out", "cones.txt"], options].concat();
    folder.run(&run).success();
    let text = folder.read("cones.txt");
    let cone = |line: &str| {
        let (vertex, curvature) = line.split_once(' ').expect("two words");
        (vertex.parse().expect("a vertex"), curvature.parse().expect("a curvature"))
    };
    text.lines().filter(|line| !line.starts_with('#')).map(cone).collect()
}

fn list<'a>(file: &'a Value, key: &str) -> &'a [Value] {
    file[key].as_array().map(Vec::as_slice).unwrap_or_else(|| panic!("{key} is a list"))
}

#[test]
fn its_first_cones_are_those_that_a_number_asks_for_with_their_curvatures() {
    let folder = folder();
    for input in ["hare.obj", "family.obj"] {
        for method in ["pursuit", "alternating", "persistence", "greedy", "iterative"] {
            let options = ["--method", method];
            let file = hierarchy(&folder, input, &options);
            let order = list(&file, "order");
            assert_eq!((&file["schema"], &file["method"], order.len()), (&1.into(), &method.into(), 64));
            for count in [3, 4, 9] {
                let mut first: Vec<u64> = order[..count].iter().filter_map(|cone| cone["vertex"].as_u64()).collect();
                let cones = taken(&folder, input, count, &options);
                let mut vertices: Vec<u64> = cones.iter().map(|cone| cone.0).collect();
                let last = &order[count - 1];
                assert_eq!(last["n"], count);
                let curvature =
                    cones.iter().find(|cone| Some(cone.0) == last["vertex"].as_u64()).expect("it is there").1;
                let written = last["curvature_at_n"].as_f64().expect("enough cones");
                assert!((written - curvature).abs() < 1e-6, "{input}, {method}: {written} {curvature}");
                first.sort_unstable();
                vertices.sort_unstable();
                assert_eq!(first, vertices, "{input}, {count} cones by {method}");
            }
        }
    }
}

#[test]
fn vertices_are_on_the_components_that_are_named() {
    let folder = folder();
    let count = |shape: &str| folder.read(shape).lines().filter(|line| line.starts_with("v ")).count() as u64;
    let [first, second] = ["hare.obj", "torus-1.obj"].map(count);
    let file = hierarchy(&folder, "family.obj", &["--method", "persistence"]);
    let mut seen = [0; 3];
    for key in ["order", "extrema"] {
        for entry in list(&file, key) {
            let vertex = entry["vertex"].as_u64().expect("a vertex");
            let component = usize::from(vertex >= first) + usize::from(vertex >= first + second);
            assert_eq!(entry["component"], component, "{key}: {entry}");
            seen[component] += 1;
        }
    }
    assert!(seen.iter().all(|&count| count > 1), "{seen:?}");
}

#[test]
fn refined_cones_have_no_order_and_give_that_of_pursuit() {
    let folder = folder();
    let [refined, pursuit] = ["refined", "pursuit"].map(|method| hierarchy(&folder, "hare.obj", &["--method", method]));
    assert_eq!(refined["method"], "pursuit");
    assert_eq!(refined, pursuit);
}

#[test]
fn it_has_every_extremum_and_a_curve_that_falls() {
    let folder = folder();
    for (input, components, least) in [("hare.obj", 1, 3), ("family.obj", 3, 3)] {
        let file = hierarchy(&folder, input, &[]);
        let (extrema, curve) = (list(&file, "extrema"), list(&file, "curve"));
        let essential = extrema.iter().filter(|e| e["saddle"].is_null()).count();
        assert_eq!(essential, 2 * components, "the lowest and the highest point of each");
        let persistence: Vec<f64> = extrema.iter().filter_map(|e| e["persistence"].as_f64()).collect();
        assert!(persistence.len() == extrema.len() && persistence.windows(2).all(|two| two[0] >= two[1]));
        assert_eq!((&curve[0]["n"], &curve[curve.len() - 1]["n"]), (&least.into(), &64.into()));
        let norm: Vec<f64> = curve.iter().filter_map(|point| point["predicted_l2"].as_f64()).collect();
        assert!(norm.windows(2).all(|two| two[1] <= two[0] * (1.0 + 1e-9)), "{norm:?}");
        assert!(curve.iter().all(|point| point["predicted_area"].as_f64() >= Some(1.0)));
    }
}

#[test]
fn curvatures_are_harmonic_where_that_is_asked_for_and_missing_where_cones_are_too_few() {
    let folder = folder();
    let [optimal, harmonic] =
        ["optimal", "harmonic"].map(|angles| hierarchy(&folder, "hare.obj", &["--angles", angles]));
    for file in [&optimal, &harmonic] {
        let known: Vec<bool> = list(file, "order").iter().map(|cone| cone["curvature_at_n"].is_number()).collect();
        assert_eq!(known[..3], [false, false, true]);
    }
    let cones = taken(&folder, "hare.obj", 6, &["--method", "pursuit", "--angles", "harmonic"]);
    let last = &list(&harmonic, "order")[5];
    let curvature = cones.iter().find(|cone| Some(cone.0) == last["vertex"].as_u64()).expect("it is there").1;
    assert!((last["curvature_at_n"].as_f64().expect("a number") - curvature).abs() < 1e-6);
    assert_ne!(list(&optimal, "order")[5]["curvature_at_n"], last["curvature_at_n"]);
}

#[test]
fn as_many_cones_as_are_asked_for_are_in_it() {
    let folder = folder();
    let file = hierarchy(&folder, "hare.obj", &["-n", "70", "--method", "greedy"]);
    assert_eq!(list(&file, "order").len(), 70);
    folder.run(&["shape", "sphere", "--vertices", "20", "-o", "small.obj"]).success();
    let all = hierarchy(&folder, "small.obj", &[]);
    assert!(list(&all, "order").len() < 64, "a small surface has no more vertices");
}

#[test]
fn unwrapping_writes_the_same_file() {
    let folder = folder();
    let extracted = hierarchy(&folder, "family.obj", &["-n", "8"]);
    folder.run(&["unwrap", "family.obj", "-n", "8", "-o", "out.obj", "--hierarchy", "u.json"]).success();
    assert_eq!(folder.json("u.json"), extracted);
    let complaint = folder.complaint(&["extract", "hare.obj", "--hierarchy", "h.txt"]);
    assert!(complaint.contains(".json"), "{complaint}");
    let twice = folder.complaint(&["extract", "hare.obj", "--hierarchy", "a.json", "--cones-out", "a.json"]);
    assert!(twice.contains("two outputs"), "{twice}");
}

#[test]
fn without_a_number_the_curve_of_several_parts_leads_to_what_is_measured() {
    let folder = folder();
    let run = ["unwrap", "family.obj", "-o", "out.obj", "--report", "r.json", "--free-seams", "never"];
    let printed = crate::folder::stdout(&folder.run(&run).success());
    let report = folder.json("r.json");
    let predicted = report["number"]["predicted_area"].as_f64().expect("a number");
    let measured = report["distortion"]["area_mean"].as_f64().expect("a number");
    assert!((predicted - measured).abs() < 0.03, "{predicted} is predicted, {measured} measured");
    let curve = list(&report, "curve");
    let numbers: Vec<u64> = curve.iter().filter_map(|point| point["n"].as_u64()).collect();
    assert!(numbers[0] == 3 && numbers.windows(2).all(|two| two[1] == two[0] + 1), "{numbers:?}");
    // Lines are broken anywhere.
    let printed = printed.split_whitespace().collect::<Vec<&str>>().join(" ");
    assert!(printed.contains(", 4 cones") || printed.contains("as -n does: 4 cones"), "{printed}");
    assert!(printed.contains(", target 1.25 on each part"), "{printed}");
}
