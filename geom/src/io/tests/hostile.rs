//! Bytes that mean harm: no panic, no memory beyond the file's size, and an answer that is a model or a sentence.

use std::io::Write;

use flate2::write::GzEncoder;
use proptest::prelude::*;

use super::*;

/// Small files of every format to start from.
fn seeds() -> Vec<Vec<u8>> {
    let model = obj(&format!("{TETRAHEDRON}f 1 2 3 4\nf 4 3 2 1 1 2 3\n"));
    let (mut ply, mut stl) = (Vec::new(), vec![0; 80]);
    write_ply(&model, Some(&some_uv(&model)), None, &mut ply).unwrap();
    stl.extend(2_u32.to_le_bytes());
    stl.extend((0..100).map(|i: u8| i.wrapping_mul(37)));
    let text = [
        &format!("vt 0 0\n{TETRAHEDRON}l 1/1 2/-1\nf 1/1/1 -1/1 3//2 \\\n 4\n"),
        "COFF\n4 2 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1\n3 0 1 2 9\n4 0 1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n5 0 1 2 -1 0\n",
        "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
    ];
    let (glb, json) = (super::gltf::small_glb(), super::gltf::small_json());
    text.into_iter().map(|text| text.as_bytes().to_vec()).chain([ply, stl, glb, json.into_bytes()]).collect()
}

/// What must hold for any bytes.
fn check(bytes: Vec<u8>, name: &str) {
    match read_bytes(bytes, name) {
        Err(error) => assert!(error.to_string().starts_with(name)),
        Ok(model) => {
            assert_eq!(model.triangles().len(), model.corner_count() - 2 * model.face_count());
            super::round_trip::assert_obj_comes_back(&model);
            super::round_trip::assert_ply_and_glb_come_back(&model);
        }
    }
}

/// A change to a file: replace, insert or remove bytes, or repeat a piece.
fn mutate(bytes: &mut Vec<u8>, kind: u8, at: usize, what: &[u8]) {
    let at = at % (bytes.len() + 1);
    let end = (at + what.len()).min(bytes.len());
    match kind % 4 {
        0 => bytes[at..end].copy_from_slice(&what[..end - at]),
        1 => drop(bytes.splice(at..at, what.iter().copied())),
        2 => drop(bytes.drain(at..end)),
        _ => bytes.extend_from_within(at..end),
    }
}

/// Pieces that mean something in one of the formats.
fn piece() -> impl Strategy<Value = Vec<u8>> {
    let words = [
        "\n",
        "\\\n",
        "#",
        "/",
        "-1",
        " 0",
        "nan",
        "1e308",
        "4294967295",
        "99999999999999999999",
        "v ",
        "f ",
        "list ",
        "\r",
    ];
    prop_oneof![
        proptest::collection::vec(any::<u8>(), 1..8),
        proptest::sample::select(words.to_vec()).prop_map(|word| word.as_bytes().to_vec()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_bytes_give_a_model_or_a_sentence(
        bytes in proptest::collection::vec(any::<u8>(), 0..400),
        name in proptest::sample::select(vec!["a.obj", "a.off", "a.ply", "a.stl", "a.glb", "a"]),
    ) {
        check(bytes, name);
    }

    #[test]
    fn damaged_files_give_a_model_or_a_sentence(
        seed in 0_usize..8,
        damage in proptest::collection::vec((any::<u8>(), any::<usize>(), piece()), 1..6),
        name in proptest::sample::select(vec!["a.obj", "a.off", "a.ply", "a.stl", "a.gltf"]),
    ) {
        let mut bytes = seeds()[seed].clone();
        for (kind, at, what) in damage {
            mutate(&mut bytes, kind, at, &what);
        }
        check(bytes, name);
    }
}

#[test]
fn headers_that_lie_cost_nothing() {
    let four = "4000000000";
    let lies = [
        ("a.off", format!("OFF\n{four} {four} 0\n0 0 0\n")),
        ("a.off", "OFF\n99999999999999999999 1 0\n0 0 0\n".to_owned()),
        ("a.off", format!("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n{four} 0 1 2\n")),
        ("a.ply", format!("ply\nformat binary_little_endian 1.0\nelement nothing {four}\nelement vertex {four}\nproperty float x\nproperty float y\nproperty float z\nend_header\n")),
        ("a.ply", "ply\nformat binary_big_endian 1.0\nelement other 1\nproperty list uint double data\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}\0\0\0\0".to_owned()),
        ("a.ply", format!("ply\nformat ascii 1.0\nelement other 1\nproperty list uint double data\nend_header\n{four}\n")),
    ];
    for (name, text) in lies {
        message(text, name);
    }
    let mut stl = vec![0; 84 + 50];
    stl[80..84].fill(255);
    assert!(message(stl, "a.stl").contains("claims 4294967295 triangles"));
}

#[test]
fn a_polygon_of_many_corners_that_is_no_polygon_ends() {
    let text = format!("{TETRAHEDRON}f{}\n", " 1 2 3 4 2".repeat(4000));
    let model = obj(&text);
    assert_eq!(model.triangles().len(), model.corner_count() - 2 * model.face_count());
}

#[test]
fn a_gzip_file_that_expands_as_no_mesh_does_is_refused_and_a_regular_one_is_read() {
    let gzipped = |text: &str| {
        let mut out = GzEncoder::new(Vec::new(), flate2::Compression::best());
        out.write_all(text.as_bytes()).unwrap();
        out.finish().unwrap()
    };
    let facet = "facet normal 0 0 1\n  outer loop\n    vertex 0.000000 0.000000 0.000000\n    vertex 1.000000 0.000000 0.000000\n    vertex 0.000000 1.000000 0.000000\n  endloop\nendfacet\n";
    let soup: String = (0..2000).map(|k| facet.replace("0.000000\n", &format!("{}.000000\n", k / 3))).collect();
    let regular = format!("solid x\n{soup}endsolid\n");
    let compressed = gzipped(&regular);
    assert!(regular.len() > 20 * compressed.len(), "regular text compresses well");
    assert!(read_bytes(compressed, "a.stl.gz").is_ok());
    for text in
        [format!("{TETRAHEDRON}f{}\n", " 1 2 3".repeat(1 << 20)), format!("{TETRAHEDRON}{}", "\n".repeat(1 << 20))]
    {
        let message = message(gzipped(&text), "a.obj.gz");
        assert!(message.contains("more than 100 times") && message.ends_with("decompress it first"), "{message}");
    }
}

#[test]
fn corners_without_end_on_a_few_vertices_are_refused_where_they_stand() {
    let text = format!("{TETRAHEDRON}f 1 2 3\nf{}\nf 1 2 3\n", " 1 2 3".repeat(1 << 19));
    let message = message(text.into_bytes(), "a.obj");
    assert!(
        message.starts_with("a.obj, line 10: there are 1572882 corners of faces, 1572864 of them at face 5"),
        "{message}"
    );
}
