//! What is written reads back the same.

use super::*;

/// Writes the model with a map and reads it again.
fn obj_with_map(model: &Model, uv: &[[f64; 2]]) -> Vec<u8> {
    let mut out = Vec::new();
    write_obj(model, &ObjContent { uv: Some(uv), ..ObjContent::default() }, &mut out).unwrap();
    out
}

pub(super) fn assert_obj_comes_back(model: &Model) {
    let uv = some_uv(model);
    let text = obj_with_map(model, &uv);
    if let Some(old) = model.obj_text() {
        assert_lines_are_kept(old, &text);
    }
    let back = read_bytes(text, "back.obj").unwrap();
    assert_same_surface(&back, model);
    assert_eq!(back.uv().unwrap().all().unwrap(), uv);
}

/// Written as PLY and as GLB and read again: the same faces at the same places, joined along the seams.
pub(super) fn assert_ply_and_glb_come_back(model: &Model) {
    let uv = some_uv(model);
    let mut ply = Vec::new();
    write_ply(model, Some(&uv), None, &mut ply).unwrap();
    let back = read_bytes(ply, "back.ply").unwrap();
    assert_same_surface(&back, model);
    let narrow: Vec<_> = uv.iter().map(|point| point.map(|x| f64::from(x as f32))).collect();
    assert_eq!(back.uv().unwrap().all().unwrap(), narrow);
    let mut glb = Vec::new();
    write_glb(model, Some(&uv), &model.triangles(), None, &mut glb).unwrap();
    let back = read_bytes(glb, "back.glb").unwrap();
    assert_eq!(back.face_count(), model.triangles().len());
    assert!(back.vertex_count() <= model.vertex_count());
}

/// A line without a backslash at its end: the last one may be continued with nothing, and what is added begins a line of its own.
fn without_continuation(line: &[u8]) -> &[u8] {
    let line = line.trim_ascii_end();
    line.strip_suffix(b"\\").unwrap_or(line)
}

/// The old text's lines that are no faces must be a subsequence of the new text's, and the rest be `vt` lines. Old `vt` lines are
/// kept only if something else than faces refers to them.
fn assert_lines_are_kept(old: &[u8], new: &[u8]) {
    let begins = |line: &text::Line, words: &[&[u8]]| line.words().next().is_some_and(|word| words.contains(&word));
    let is_used =
        Lines::joined(old).any(|line| begins(&line, &[b"l", b"surf"]) && line.words().any(|word| word.contains(&b'/')));
    let others = |text, without_texture: bool| -> Vec<&[u8]> {
        let is_face = |line: &text::Line| line.words().next().is_some_and(obj::is_face);
        let is_other = |line: &text::Line| !(is_face(line) || without_texture && begins(line, &[b"vt"]));
        Lines::joined(text).filter(is_other).map(|line| without_continuation(line.text)).collect()
    };
    let mut old_lines = others(old, !is_used).into_iter().peekable();
    for line in others(new, false) {
        if old_lines.next_if_eq(&line).is_none() {
            assert!(line.starts_with(b"vt "), "{}", line.escape_ascii());
        }
    }
    assert_eq!(old_lines.next(), None);
}

#[test]
fn an_obj_comes_back_line_for_line_in_every_dialect() {
    let faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let with_faces = |lines: &str| TETRAHEDRON.replace(faces, lines);
    let dialects = [
        TETRAHEDRON.to_owned(),
        TETRAHEDRON.trim_end().to_owned(),
        TETRAHEDRON.replace('\n', "\r\n"),
        TETRAHEDRON.replace('\n', "\r"),
        format!("\u{feff}{TETRAHEDRON}"),
        format!("\u{feff}{faces}{}", with_faces("")),
        with_faces("vn 0 0 1\nf -4//1 -2//1 -3//1\n  f\t1//-1\t2//-1 4//1 # c\nf 2 3 \\\n 4\nf 3 1 4"),
        with_faces("vt 0 0\nvt 1 1\nf 1/1 3/2 2/1\nf 1/1 2/2 4/2\nvt 3 3\nf 2/3 3/3 4/-1\nf 3 1 4\nvt 9 9\n"),
        with_faces(
            "vt 0 0\nvt 1 1\nl 1/1 2/2\nf 1/1 3/2 2/1\nvt 3 3\nl 1/3 2/-1\nf 1/1 2/2 4/2\nvt 9 9\nf 2 3 4\nf 3 1 4",
        ),
        with_faces(
            "o box\ng a b\nusemtl red # f\ns 1\nfo 1 3 2\nf 1 2 4\n# f 1 2 3\nf 2 3 4\nf 3 1 4\np 1\nl 1 2\nvp 0 0\n",
        ),
        with_faces("f 1 2 3 4\n"),
    ];
    for text in dialects {
        assert_obj_comes_back(&obj(&text));
    }
}

#[test]
fn without_additions_the_bytes_are_the_same() {
    let text = format!("\u{feff}# caf\u{e9}\r\n{TETRAHEDRON}vt nan\n\n");
    let mut out = Vec::new();
    write_obj(&obj(&text), &ObjContent::default(), &mut out).unwrap();
    assert_eq!(out, text.into_bytes());
}

#[test]
fn faces_of_a_long_text_are_written_in_their_places() {
    // More than are written at a time, with comments between, and an old line that is left out.
    let count = 70_000;
    let text = |face: &str, old: &str| {
        let line = |k: usize| format!("{}{face} # {k}\n", if k == count / 2 { old } else { "# no face\n" });
        (0..count).map(line).collect::<String>()
    };
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let model = obj(&format!("{points}{}", text("f 1 2 3", "vt 7 7\n")));
    let out = obj_with_map(&model, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].repeat(count));
    let expected = text("f 1/1 2/2 3/3", "");
    let (before, rest) = expected.split_once("f 1/").unwrap();
    let added = "vt 0.0 0.0\nvt 1.0 0.0\nvt 0.0 1.0\n";
    assert!(out == format!("{points}{before}{added}f 1/{rest}").into_bytes());
}

/// The texture coordinates that the polylines of a text refer to.
fn polyline_texture(text: &[u8]) -> Vec<Vec<u8>> {
    let all: Vec<_> = Lines::joined(text).filter(|line| line.words().next() == Some(b"vt")).collect();
    let mut used = Vec::new();
    for line in Lines::joined(text).filter(|line| line.words().next() == Some(b"l")) {
        let before = all.iter().filter(|vt| vt.start < line.start).count();
        for word in line.words().skip(1) {
            let index = text::integer(word.split(|&b| b == b'/').nth(1).unwrap()).unwrap();
            let from_zero = if index < 0 { before as i64 + index } else { index - 1 };
            used.push(all[from_zero as usize].text.to_owned());
        }
    }
    used
}

#[test]
fn polylines_keep_their_old_texture_coordinates() {
    for end in ["vt 5 5\n", "", "l 1/-1 2/-2\n", "l 1/-1 2/-2"] {
        let text = format!("vt 0 0\nvt 1 1\nl 1/1 2/-1\n{TETRAHEDRON}vt 3 3\nl 1/3 2/2\n{end}");
        let model = obj(&text);
        let out = obj_with_map(&model, &some_uv(&model));
        assert_eq!(polyline_texture(&out), polyline_texture(text.as_bytes()));
        assert_obj_comes_back(&model);
    }
}

#[test]
fn new_texture_coordinates_stand_before_the_faces_that_use_them() {
    let model = obj(&format!("vt 7 7\n{TETRAHEDRON}vt 8 8\nf 1/1 2/1 3/2\n"));
    let text = String::from_utf8(obj_with_map(&model, &some_uv(&model))).unwrap();
    let (first_face, own) = (text.find("\nf ").unwrap(), text.find("vt 0.0333").unwrap());
    assert!(own < first_face && text.contains("\nf 1/1 3/2 2/3\n"));
}

#[test]
fn texture_coordinates_that_nothing_uses_are_left_out() {
    let model = obj(&format!("vt 7 7\n{TETRAHEDRON}vt 8 8\nf 1/1 2/1 3/2\nvt 9 9"));
    let text = String::from_utf8(obj_with_map(&model, &some_uv(&model))).unwrap();
    assert!(["vt 7 7", "vt 8 8", "vt 9 9"].iter().all(|old| !text.contains(old)), "{text}");
    let mut same = Vec::new();
    write_obj(&model, &ObjContent::default(), &mut same).unwrap();
    assert!(String::from_utf8(same).unwrap().contains("vt 7 7"), "without a new map the old one stays");
}

#[test]
fn corners_of_a_vertex_with_equal_texture_share_a_line() {
    let model = obj(TETRAHEDRON);
    let uv: Vec<_> = model.corners().iter().map(|&v| [f64::from(v), 0.5]).collect();
    let text = String::from_utf8(obj_with_map(&model, &uv)).unwrap();
    assert_eq!(text.lines().filter(|line| line.starts_with("vt ")).count(), 4);
    assert!(text.ends_with("f 1/1 3/2 2/3\nf 1/1 2/3 4/4\nf 2/3 3/2 4/4\nf 3/2 1/1 4/4\n"));
}

#[test]
fn triangles_take_the_place_of_polygons() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 2\nvn 0 0 1\nf 1//1 2//1 3//1 4//1 # quad\nf 3 4 5\n";
    let model = obj(text);
    let uv: Vec<_> = (0..7).map(|i| [f64::from(i), 0.0]).collect();
    let triangles = model.triangles();
    let content = ObjContent { uv: Some(&uv), triangles: Some(&triangles), ..ObjContent::default() };
    let mut out = Vec::new();
    write_obj(&model, &content, &mut out).unwrap();
    let out = String::from_utf8(out).unwrap();
    assert!(out.ends_with("f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1 # quad\nf 3/5 4/6 5/7\n"), "{out}");
    let from_memory = Model::from_polygons(model.points().to_vec(), model.faces()).unwrap();
    let mut out = Vec::new();
    write_obj(&from_memory, &content, &mut out).unwrap();
    assert!(String::from_utf8(out).unwrap().ends_with("f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 3/5 4/6 5/7\n"));
}

#[test]
fn a_material_is_named_before_the_faces() {
    let material = Some(Material { library: "checker.mtl", name: "checker" });
    let mut out = Vec::new();
    write_obj(&obj(TETRAHEDRON), &ObjContent { material, ..ObjContent::default() }, &mut out).unwrap();
    let added = "v 0 0 -1e-1\nmtllib checker.mtl\nusemtl checker\nf 1 3 2\n";
    assert!(String::from_utf8(out).unwrap().contains(added));
}

#[test]
fn a_material_is_that_of_all_faces_whatever_the_text_has() {
    let text = "mtllib own.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl red\ng one\nf 1 2 3\nusemtl blue # sky\n\
                f 2 4 3\nvt 0 0\nl 1/1 2/1\nusemtl unused";
    let model = obj(text);
    let uv = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let material = Some(Material { library: "checker.mtl", name: "checker" });
    let mut out = Vec::new();
    write_obj(&model, &ObjContent { uv: Some(&uv), material, ..ObjContent::default() }, &mut out).unwrap();
    let expected = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\ng one\nmtllib checker.mtl\nusemtl checker\nf 1/2 2/3 3/4\n\
                    f 2/3 4/5 3/4\nvt 0 0\nvt 0.0 0.0\nvt 1.0 0.0\nvt 0.0 1.0\nvt 1.0 1.0\nl 1/1 2/1\n";
    assert_eq!(String::from_utf8(out).unwrap(), expected);
}

#[test]
fn a_model_from_memory_comes_back_bit_for_bit() {
    let points = vec![[0.1 + 0.2, 1e-160, 1e150], [f64::MIN_POSITIVE, -0.0, 1.0 / 3.0], [5e-324, 1.0, 2.0]];
    let model = Model::from_triangles(points, &[[0, 1, 2]]).unwrap();
    let bits = |model: &Model| model.points().iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
    let mut text = Vec::new();
    write_obj(&model, &ObjContent::default(), &mut text).unwrap();
    assert_eq!(bits(&read_bytes(text, "back.obj").unwrap()), bits(&model));
    let mut ply = Vec::new();
    write_ply(&model, None, None, &mut ply).unwrap();
    assert_eq!(bits(&read_bytes(ply, "back.ply").unwrap()), bits(&model));
}

#[test]
fn a_ply_comes_back_with_its_map_in_f32() {
    let many = format!("{TETRAHEDRON}f{}\n", " 1 2 3 4".repeat(100));
    for text in [TETRAHEDRON, &many] {
        let model = obj(text);
        let uv = some_uv(&model);
        let mut out = Vec::new();
        write_ply(&model, Some(&uv), None, &mut out).unwrap();
        let back = read_bytes(out, "back.ply").unwrap();
        assert_same_surface(&back, &model);
        let narrow: Vec<_> = uv.iter().map(|point| point.map(|x| f64::from(x as f32))).collect();
        assert_eq!(back.uv().unwrap().all().unwrap(), narrow);
    }
}

#[test]
fn a_glb_is_as_long_as_its_headers_say() {
    let model = obj(TETRAHEDRON);
    let uv = some_uv(&model);
    for (uv, texture) in [(Some(uv.as_slice()), Some(GlbTexture::Checker(b"12345"))), (Some(&uv), None), (None, None)] {
        let mut out = Vec::new();
        write_glb(&model, uv, &model.triangles(), texture, &mut out).unwrap();
        let word = |at: usize| u32::from_le_bytes(out[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&out[..4], word(4), word(8)), (&b"glTF"[..], 2, out.len()));
        let binary = 20 + word(12);
        assert_eq!((&out[16..20], &out[binary + 4..binary + 8]), (&b"JSON"[..], &b"BIN\0"[..]));
        assert_eq!(binary + 8 + word(binary), out.len());
        let json = std::str::from_utf8(&out[20..binary]).unwrap();
        let json: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(json["buffers"][0]["byteLength"], word(binary));
        let vertices = if uv.is_some() { 12 } else { 4 };
        assert_eq!((&json["accessors"][0]["count"], &json["accessors"][0]["type"]), (&vertices.into(), &"VEC3".into()));
    }
}

#[test]
fn a_vertex_far_off_that_is_of_no_face_costs_a_glb_no_digits() {
    let at = |x: f64, y: f64| format!("v {} {} 0\n", 5e5 + x, 5.4e6 + y);
    let text = format!("v 0 0 0\n{}{}{}f 2 3 4\n", at(0.0, 0.0), at(0.1, 0.0), at(0.0, 0.1));
    let model = obj(&text);
    let mut out = Vec::new();
    write_glb(&model, None, &model.triangles(), None, &mut out).unwrap();
    let back = read_bytes(out, "back.glb").unwrap();
    for (point, expected) in back.points().iter().zip(&model.points()[1..]) {
        assert!(point.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-7), "{point:?} {expected:?}");
    }
}

#[test]
fn what_does_not_fit_the_model_is_not_written() {
    let model = obj(TETRAHEDRON);
    let refused = |uv: Option<&[[f64; 2]]>, triangles: Option<&crate::Triangles>| {
        let content = ObjContent { uv, triangles, ..ObjContent::default() };
        write_obj(&model, &content, Vec::new()).unwrap_err().to_string()
    };
    let mut uv = some_uv(&model);
    assert_eq!(refused(Some(&uv[1..]), None), "there are 11 texture coordinates, but the model has 12 corners");
    uv[7][1] = f64::NAN;
    assert_eq!(refused(Some(&uv), None), "the texture coordinate of corner 7 is not finite");
    let mut triangles = model.triangles();
    triangles.corners[2][0] = 1;
    assert!(refused(None, Some(&triangles)).starts_with("triangle 2 "));
    triangles.face_of.clear();
    assert!(refused(None, Some(&triangles)).starts_with("triangle 0 "));
}
