//! Measured fields, with pair counts and total persistences computed by others.
//!
//! They lie beside the workspace in `../shared/fields` and are described by the table in their `INDEX.md`; where that is
//! missing the tests say so and pass.

use std::fs;
use std::path::PathBuf;
use topo::{Adjacency, Connectivity, Domain, Grid, NanPolicy, Pairs, Path, PersistenceOptions, Scalar, TriangleMesh};

fn folder() -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "..", "..", "shared", "fields"].iter().collect()
}

/// What the table says of a field on a graph: number and total persistence of the pairs, below and above.
#[derive(Debug)]
struct Row {
    file: String,
    graph: String,
    expected: [(usize, f64); 2],
}

/// The rows of the table, one for each field and graph.
fn table() -> Vec<Row> {
    let Ok(index) = fs::read_to_string(folder().join("INDEX.md")) else {
        println!("skipped: there are no fields in ../shared/fields");
        return Vec::new();
    };
    let rows = index.lines().filter(|line| line.starts_with("| ") && line.contains(": ") && !line.contains("GRAPH"));
    rows.flat_map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let (file, graphs) = (cells[1].to_owned(), cells[4].to_owned());
        graphs.split(';').filter_map(|graph| row(&file, graph)).collect::<Vec<_>>()
    })
    .collect()
}

/// From `axis: 3228, 15305 / 2774, 29419`, perhaps with a remark in brackets.
fn row(file: &str, text: &str) -> Option<Row> {
    let (graph, figures) = text.split('(').next()?.split_once(':')?;
    let (sub, sup) = figures.split_once('/')?;
    let figures = |text: &str| {
        let (count, total) = text.split_once(',')?;
        Some((count.trim().parse().ok()?, total.trim().parse().ok()?))
    };
    Some(Row { file: file.to_owned(), graph: graph.trim().to_owned(), expected: [figures(sub)?, figures(sup)?] })
}

/// An array as `NumPy` writes it, little endian and in C order.
struct Array {
    shape: Vec<usize>,
    kind: String,
    data: Vec<u8>,
}

fn read_npy(file: &str) -> Array {
    let bytes = fs::read(folder().join(file)).expect("a file of the table is there");
    let header_length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = String::from_utf8_lossy(&bytes[10..10 + header_length]).into_owned();
    let between = |after: &str, before: &str| {
        let rest = &header[header.find(after).expect("a key of the header") + after.len()..];
        rest[..rest.find(before).expect("the end of the value")].to_owned()
    };
    let shape = between("'shape': (", ")").split(',').filter_map(|length| length.trim().parse().ok()).collect();
    Array { shape, kind: between("'descr': '", "'"), data: bytes[10 + header_length..].to_vec() }
}

fn check(row: &Row) {
    if row.graph == "graph" {
        return check_network(row);
    }
    let array = read_npy(&row.file);
    match array.kind.as_str() {
        "|u1" => check_array(row, &array.shape, &array.data),
        "<i2" => check_array(row, &array.shape, &decoded(&array.data, i16::from_le_bytes)),
        "<f4" => check_array(row, &array.shape, &decoded(&array.data, f32::from_le_bytes)),
        "<f8" => check_array(row, &array.shape, &decoded(&array.data, f64::from_le_bytes)),
        other => panic!("{}: no reader for {other}", row.file),
    }
}

fn decoded<S, const N: usize>(data: &[u8], decode: fn([u8; N]) -> S) -> Vec<S> {
    data.chunks_exact(N).map(|bytes| decode(bytes.try_into().expect("chunks of this length"))).collect()
}

fn check_array<S: Scalar>(row: &Row, shape: &[usize], field: &[S]) {
    let connectivity = if row.graph == "axis" { Connectivity::Axis } else { Connectivity::Freudenthal };
    match (row.graph.as_str(), shape) {
        ("axis" | "freudenthal", &[ny, nx]) => check_domain(row, &Grid::new([ny, nx], connectivity), field),
        ("axis" | "freudenthal", &[nz, ny, nx]) => check_domain(row, &Grid::new([nz, ny, nx], connectivity), field),
        ("path", &[length]) => check_domain(row, &Path::new(length), field),
        ("mesh", &[count]) => check_domain(row, &mesh(count), field),
        other => panic!("{}: no domain for {other:?}", row.file),
    }
}

/// The mesh all vertex data of the table belong to.
fn mesh(vertices: usize) -> TriangleMesh {
    let text = fs::read_to_string(folder().join("conte69_lh_32492.obj")).expect("the mesh is there");
    let corner = |word: &str| word.split('/').next().and_then(|index| index.parse::<u32>().ok()).expect("an index") - 1;
    let faces = text.lines().filter_map(|line| line.strip_prefix("f "));
    let triangles: Vec<[u32; 3]> = faces
        .map(|face| face.split_whitespace().map(corner).collect::<Vec<_>>().try_into().expect("three corners"))
        .collect();
    TriangleMesh::new(vertices, &triangles).expect("corners exist")
}

fn check_network(row: &Row) {
    let columns = |file: &str| -> Vec<Vec<String>> {
        let text = fs::read_to_string(folder().join(file)).expect("a file of the table is there");
        text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.trim().to_owned()).collect()).collect()
    };
    let (nodes, edges) = row.file.split_once('/').expect("two files");
    let edges = nodes.replace("nodes.csv", edges.trim_start_matches('.'));
    let field: Vec<f64> = columns(nodes).iter().map(|node| node[2].parse().expect("a value")).collect();
    let index = |cell: &String| cell.parse::<usize>().expect("an index");
    let edges: Vec<_> = columns(&edges).iter().map(|edge| [index(&edge[0]), index(&edge[1])]).collect();
    check_domain(row, &Adjacency::from_edges(field.len(), &edges).expect("ends exist"), &field);
}

fn check_domain<G: Domain<Vertex = usize>, S: Scalar>(row: &Row, domain: G, field: &[S]) {
    let options = PersistenceOptions::new().nan(NanPolicy::Mask);
    let fast = options.persistence(domain, field).expect("the field fits");
    for (pairs, expected) in [&fast.minima, &fast.maxima].into_iter().zip(row.expected) {
        check_figures(row, pairs, expected);
    }
    if field.len() < 1 << 20 {
        assert!(fast == options.plain_sweep().persistence(domain, field).expect("the field fits"), "{row:?}");
    }
}

fn check_figures<S: Scalar>(row: &Row, pairs: &Pairs<usize, S>, (count, total): (usize, f64)) {
    assert_eq!(pairs.finite().count(), count, "{row:?}");
    // The table has six digits.
    assert!(
        (pairs.total_persistence() - total).abs() <= 1e-5 * total.max(1.0),
        "{row:?}: {}",
        pairs.total_persistence()
    );
}

#[test]
fn pairs_of_measured_fields_are_those_that_others_found() {
    let rows = table();
    rows.iter().for_each(check);
    println!("checked {} fields on graphs", rows.len());
}
