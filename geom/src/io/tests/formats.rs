//! Each format in its variants, and against other readers.

use std::io::Write;

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::DefaultElement;

use super::*;

const SQUARE: [[f64; 3]; 4] = [[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn square(faces: &[&[u32]]) -> Model {
    Model::from_polygons(SQUARE.to_vec(), faces).unwrap()
}

#[test]
fn the_content_tells_the_format_where_the_extension_lies() {
    let triangle = "0.1 0 0\n1 0 0\n1 1 0\n";
    let off = format!("OFF\n3 1 0\n{triangle}3 0 1 2\n");
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n{triangle}3 0 1 2\n"
    );
    let stl = format!(
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex {}\nendloop\nendfacet\nendsolid s\n",
        triangle.trim_end().replace('\n', "\nvertex ")
    );
    let obj = format!("# c\nv {}\nf 1 2 3\n", triangle.trim_end().replace('\n', "\nv "));
    let expected = Model::from_triangles(SQUARE[..3].to_vec(), &[[0, 1, 2]]).unwrap();
    for text in [off, ply, stl, obj] {
        for name in ["a.obj", "a.OFF", "a.ply", "a.stl", "a.obj.gz", "a.txt", "a"] {
            assert_same_surface(&read_bytes(text.clone().into(), name).unwrap(), &expected);
        }
    }
    assert!(message("0 0 0\n", "a.txt").contains("neither the content nor the extension"));
}

#[test]
fn compressed_files_are_read_and_damaged_ones_refused() {
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    gzip.write_all(TETRAHEDRON.as_bytes()).unwrap();
    let bytes = gzip.finish().unwrap();
    let model = read_bytes(bytes.clone(), "a.obj.gz").unwrap();
    assert_eq!(model.obj_text().unwrap(), TETRAHEDRON.as_bytes());
    assert_eq!(message(&bytes[..bytes.len() - 9], "a.obj.gz"), "a.obj.gz: the gzip data are damaged or cut short");
}

#[test]
fn missing_files_and_directories_are_named() {
    assert_eq!(read("no/such/file.obj").unwrap_err().to_string(), "no/such/file.obj: there is no such file");
    assert_eq!(read(".").unwrap_err().to_string(), ".: this is a directory, give a mesh file");
    assert_eq!(message("", "a.obj"), "a.obj: the file is empty");
}

#[test]
fn obj_statements_that_make_no_surface_are_counted() {
    let model = obj(&format!("{TETRAHEDRON}l 1 2\nl 2 3\np 1\nvp 0\ncstype bezier\ndeg 3\nmagic 7\nf 1/9 2/9 3/1\n"));
    let printed = "2 lines, 1 point, 3 free-form statements, 1 unknown statement, 3 missing texture coordinates";
    assert_eq!(model.skipped().to_string(), printed);
    assert_eq!(model.uv().unwrap().all().unwrap_err().corner, 0);
}

#[test]
fn obj_normals_that_are_missing_are_counted() {
    let faces = "f 1//99 2//1 3//1\nf 1//-2 2//0 3\n";
    let model = obj(&format!("{TETRAHEDRON}{faces}vn 0 0 1\n"));
    assert_eq!(model.skipped().to_string(), "3 missing normals");
    let normals = model.attributes().table(&crate::surface::Meaning::Normal).unwrap();
    let rows = (12..18).map(|corner| normals.row_at(model.corners(), corner)).collect::<Vec<_>>();
    assert_eq!(rows, [None, Some(0), Some(0), None, None, None]);
}

#[test]
fn a_byte_0_separates_no_words() {
    for line in
        ["v 0\0 0 0", "v 0 0\x000 0 0", "f 1 2\x003 4", "f 1 2 3 \0", "\0f 1 2 3", "f\0 1 2 3", "\0\0\0", "vt 0 1\x001"]
    {
        let complaint = message(format!("{TETRAHEDRON}{line}\n"), "a.obj");
        assert!(complaint.starts_with("a.obj, line 9: found `") && complaint.contains("\\0"), "{line:?}: {complaint}");
    }
    obj(&format!("{TETRAHEDRON}# \0\nf 1 2 3 # \0 \n"));
}

#[test]
fn obj_texture_coordinates_belong_to_corners() {
    let model = obj(&format!("vt 0 1 0\nvt 2\nvt nan 0\n{TETRAHEDRON}f 1/1 2/-2 3/3\n"));
    let uv = model.uv().unwrap();
    assert_eq!((uv.corner(12), uv.corner(13), uv.corner(14)), (Some([0.0, 1.0]), Some([2.0, 0.0]), None));
    assert_eq!((uv.corner(11), uv.corner(99)), (None, None));
    assert_eq!(obj(TETRAHEDRON).uv(), None);
}

#[test]
fn off_is_read_with_colours_normals_comments_and_loose_headers() {
    let quad = "0.1 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let coloured = "0.1 0 0 255 0 0 255\n1 0 0 0.5 0.5 0.5\n\n1 1 0 # corner\n0 1 0 7\n";
    for (header, points) in [
        ("OFF\n4 2 5\n", quad),
        ("OFF 4 2 5\n", quad),
        ("OFF4 2 5\n", quad),
        ("4 2 5\n", quad),
        ("# hello\n\nOFF # hello\n# hello\n4 2\n", quad),
        ("COFF\n4 2 0\n", coloured),
        ("NOFF\r\n4 2 0\r\n", coloured),
        ("STCNOFF\n4 2 0\n", coloured),
    ] {
        let text = format!("{header}{points}3 0 1 2 255 0 0\n  4 0 1 2 3   0.1 0.2 0.3\n");
        let model = read_bytes(text.into(), "a.off").unwrap();
        assert_same_surface(&model, &square(&[&[0, 1, 2], &[0, 1, 2, 3]]));
    }
}

#[test]
fn what_is_passed_over_of_an_off_or_an_stl_is_said() {
    let left = |text: String, name: &str| read_bytes(text.into(), name).unwrap().attributes().left.clone();
    let off = |keyword: &str, behind: &str, of_face: &str| {
        left(format!("{keyword}\n3 1 0\n0 0 0{behind}\n1 0 0{behind}\n0 1 0{behind}\n3 0 1 2{of_face}\n"), "a.off")
    };
    assert!(off("OFF", "", "").is_empty());
    assert_eq!(off("COFF", " 255 0 0 255", ""), ["colours"]);
    assert_eq!(off("NOFF", " 0 0 1", " 255 0 0"), ["normals", "colours of faces"]);
    assert_eq!(off("STOFF", " 0.5 1", ""), ["texture coordinates"]);
    assert_eq!(off("STCNOFF", " 0 0 1 9 9 9 9 0 1", ""), ["colours and other numbers of vertices"]);
    let solid = |name: &str| {
        let points = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0";
        format!("solid{name}\nfacet normal 0 0 1\nouter loop\n{points}\nendloop\nendfacet\nendsolid{name}\n")
    };
    assert!(left(solid(""), "a.stl").is_empty());
    assert_eq!(left(solid(" lid") + &solid(" box"), "a.stl"), ["names of solids"]);
    let mut binary = vec![0; 84 + 50];
    binary[80] = 1;
    for (at, x) in [(108, 1.0_f32), (124, 1.0)] {
        binary[at..at + 4].copy_from_slice(&x.to_le_bytes());
    }
    assert!(read_bytes(binary.clone(), "a.stl").unwrap().attributes().left.is_empty());
    binary[133] = 0x80;
    let model = read_bytes(binary, "a.stl").unwrap();
    let told = not_kept(&model, MeshFormat::Obj).expect("its triangles had attributes").to_string();
    assert_eq!(told, "not kept in OBJ: attributes of triangles");
}

#[test]
fn off_refuses_what_it_cannot_mean() {
    let off = |rest: &str| message(format!("OFF\n3 1 0\n{rest}"), "a.off");
    assert_eq!(off("0 0 0\n1 0 0\n0 1\n"), "a.off, line 5: found the end of the line, expected the z coordinate");
    assert!(off("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n").ends_with("line 6: found vertex 3, expected a vertex from 0 to 2"));
    assert!(off("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n").contains("line 6: found `-1`"));
    assert!(off("0 0 0\n1 0 0\n0 1 0\n2 0 1\n").contains("found a face with 2 corners, expected at least 3"));
    assert!(
        off("0 0 0\n")
            .ends_with("a.off: the header claims 3 vertices, but the file ends after 1: it is cut short or damaged")
    );
    assert!(message("4OFF\n3 1 0\n", "a.off").contains("found `4OFF`"));
    assert!(message("OFF BINARY\n3 1 0\n", "a.off").contains("found `BINARY`"));
    assert!(message("OFF\n", "a.off").contains("found no header"));
}

/// A PLY of a square with extra elements and properties, text or binary.
fn ply(encoding: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat {encoding} 1.0\ncomment c\nobj_info o\n\
         element camera 1\nproperty float fov\nproperty list ushort short path\n\
         element nothing 4000000000\n\
         element vertex 4\nproperty uchar red\nproperty double z\nproperty float y\nproperty list uchar uint rings\nproperty double x\n\
         element face 2\nproperty int flags\nproperty list int ushort vertex_index\nproperty double quality\nend_header\n"
    );
    let mut out = header.into_bytes();
    if encoding == "ascii" {
        out.extend(b"50 2 -7 8\n");
        for [x, y, z] in SQUARE {
            out.extend(format!("255 {z} {y} 2 1 2 {x}\n").as_bytes());
        }
        out.extend(b"-1 3 0 1 2 .5\n\n0 4 0 1 2 3 1.\n");
        return out;
    }
    let is_big = encoding == "binary_big_endian";
    let mut push = |mut bytes: Vec<u8>| {
        if is_big {
            bytes.reverse();
        }
        out.extend(bytes);
    };
    push(50_f32.to_le_bytes().into());
    push(2_u16.to_le_bytes().into());
    push((-7_i16).to_le_bytes().into());
    push(8_i16.to_le_bytes().into());
    for [x, y, z] in SQUARE {
        push(vec![255]);
        push(z.to_le_bytes().into());
        push((y as f32).to_le_bytes().into());
        push(vec![1]);
        push(9_u32.to_le_bytes().into());
        push(x.to_le_bytes().into());
    }
    for face in [&[0_u16, 1, 2][..], &[0, 1, 2, 3]] {
        push((-1_i32).to_le_bytes().into());
        push((face.len() as i32).to_le_bytes().into());
        face.iter().for_each(|v| push(v.to_le_bytes().into()));
        push(0.5_f64.to_le_bytes().into());
    }
    out
}

#[test]
fn ply_is_read_in_every_encoding_with_any_properties() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let model = read_bytes(ply(encoding), "a.ply").unwrap();
        assert_same_surface(&model, &square(&[&[0, 1, 2], &[0, 1, 2, 3]]));
    }
    let mut longer = ply("binary_big_endian");
    longer.extend([0; 5]);
    assert_eq!(read_bytes(longer, "a.ply").unwrap().skipped().surplus, 5);
    let windows = String::from_utf8(ply("ascii")).unwrap().replace('\n', "\r\n");
    assert_eq!(read_bytes(windows.clone().into(), "a.ply").unwrap().face_count(), 2);
    assert_eq!(read_bytes((windows + "1\n\n2\n").into(), "a.ply").unwrap().skipped().surplus, 2);
}

#[test]
fn a_ply_cut_anywhere_is_refused() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let bytes = ply(encoding);
        // A text may lose its last line end and the decimals of the last number.
        for end in 1..bytes.len() - if encoding == "ascii" { 3 } else { 0 } {
            message(&bytes[..end], "a.ply");
        }
    }
}

#[test]
fn ply_says_where_it_is_wrong() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let text = |rest: &str| message(format!("{header}{rest}"), "a.ply");
    assert_eq!(text("0 0 0\n0 0\n"), "a.ply, line 11: found the end of the line, expected `z`");
    assert_eq!(text("0 0 0\n0 0 x\n"), "a.ply, line 11: found `x`, expected a number for `z`");
    assert!(text("0 0 0\n0 0 nan\n").starts_with("a.ply, line 11: found the coordinate NaN"));
    assert_eq!(text("0 0 0\n0 0 1\n0 1 0\n3 0 1 3\n"), "a.ply, line 13: found vertex 3, expected a vertex from 0 to 2");
    assert!(text("0 0 0\n0 0 1\n0 1 0\n9 0 1 2\n").starts_with("a.ply, line 13: found the end of the line"));
    assert!(
        text("0 0 0\n0 0 1\n").contains("the header claims 3 elements `vertex`, but the file ends after 2: it is cut")
    );
    let no_z = header.replace("property float z\n", "");
    assert!(message(no_z, "a.ply").contains("line 3: found element `vertex` without a property `z`"));
}

#[test]
fn ply_strips_alternate_and_drop_their_turns() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0.1 0 0\n1 0 0\n1 1 0\n0 1 0\n12 0 1 2 3 -1 3 2 1 1 0 -1 0\n";
    let model = read_bytes(text.into(), "a.ply").unwrap();
    assert_eq!(model.faces().collect::<Vec<_>>(), [[0, 1, 2], [2, 1, 3], [3, 2, 1]]);
}

#[test]
fn ply_faces_beside_strips_keep_their_texture_coordinates() {
    let strips = ("element tristrips 1\nproperty list int int vertex_indices\n", "4 0 1 2 3\n");
    let faces = (
        "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n",
        "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 1 1 0 1\n",
    );
    let own = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for ([first, second], at) in [([strips, faces], 6), ([faces, strips], 0)] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{}{}end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n{}{}",
            first.0, second.0, first.1, second.1
        );
        let model = read_bytes(text.into_bytes(), "a.ply").unwrap();
        assert_eq!(model.corner_count(), 12);
        let uv = model.uv().unwrap();
        assert_eq!((at..at + 6).map(|c| uv.corner(c)).collect::<Vec<_>>(), own.map(Some));
        assert!((0..12).filter(|c| !(at..at + 6).contains(c)).all(|c| uv.corner(c).is_none()));
    }
}

#[test]
fn ply_texture_coordinates_of_vertices_are_those_of_their_corners() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0.5 0\n1 0 0 0.25 0\n0 1 0 0 1\n3 2 1 0\n";
    let model = read_bytes(text.into(), "a.ply").unwrap();
    assert_eq!(model.uv().unwrap().all().unwrap(), [[0.0, 1.0], [0.25, 0.0], [0.5, 0.0]]);
}

#[test]
fn ply_agrees_with_ply_rs() {
    for encoding in ["binary_little_endian", "binary_big_endian"] {
        let bytes = ply(encoding);
        // Their reader would take memory for the elements that the header claims and the file does not have.
        let lie = b"element nothing 4000000000\n";
        let at = bytes.windows(lie.len()).position(|piece| piece == lie).unwrap();
        let honest = [&bytes[..at], &bytes[at + lie.len()..]].concat();
        let theirs = Parser::<DefaultElement>::new().read_ply(&mut &honest[..]).unwrap();
        let ours = read_bytes(bytes, "a.ply").unwrap();
        for (vertex, point) in theirs.payload["vertex"].iter().zip(ours.points()) {
            let x = match vertex["x"] {
                ply_rs_bw::ply::Property::Double(x) => x,
                _ => unreachable!("x is a double"),
            };
            assert_eq!(x, point[0]);
        }
        for (face, corners) in theirs.payload["face"].iter().zip(ours.faces()) {
            assert_eq!(face["vertex_index"].to_u32_list().unwrap(), corners);
        }
    }
}

#[test]
fn triangles_of_a_binary_ply_that_come_many_at_a_time_are_those_that_come_one_by_one() {
    let square = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let file = |is_big: bool, index: &str, faces: &[&[i32]], claimed: usize| {
        let order = if is_big { "big" } else { "little" };
        let header = format!(
            "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face {claimed}\nproperty list uchar {index} vertex_indices\nend_header\n"
        );
        let mut bytes = header.into_bytes();
        for x in square.as_flattened() {
            bytes.extend(if is_big { x.to_be_bytes() } else { x.to_le_bytes() });
        }
        for face in faces {
            bytes.push(face.len() as u8);
            bytes.extend(face.iter().flat_map(|v| if is_big { v.to_be_bytes() } else { v.to_le_bytes() }));
        }
        bytes
    };
    let faces: [&[i32]; 5] = [&[0, 1, 2], &[2, 3, 0], &[0, 1, 2, 3], &[1, 2, 3], &[3, 0, 1]];
    for (is_big, index) in [(false, "int"), (false, "uint"), (true, "int"), (true, "uint")] {
        let read = |faces: &[&[i32]], claimed: usize| read_bytes(file(is_big, index, faces, claimed), "a.ply");
        let model = read(&faces, 5).unwrap();
        assert!((0..5).all(|f| model.face(f).iter().map(|&v| v as i32).eq(faces[f].iter().copied())));
        assert_eq!(read(&faces, 3).unwrap().skipped().surplus, 26, "no more than are claimed");
        let complaint = |faces: &[&[i32]], claimed| read(faces, claimed).unwrap_err().to_string();
        assert!(complaint(&faces, 6).contains("element"), "{}", complaint(&faces, 6));
        for bad in [4, -1] {
            let found = complaint(&[&[0, 1, 2], &[0, 1, bad]], 2);
            assert!(found.contains("expected a vertex from 0 to 3"), "{found}");
        }
        assert!(complaint(&[&[0, 1, 2], &[0, 1]], 2).contains("2 corners"));
    }
}

fn binary_stl(comment: &str, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut out = vec![0; 80];
    out[..comment.len()].copy_from_slice(comment.as_bytes());
    out.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        out.extend([0; 12]);
        out.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
        out.extend([0; 2]);
    }
    out
}

const TWO_TRIANGLES: [[[f32; 3]; 3]; 2] =
    [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[-0.0, 0.0, -0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]]];

#[test]
fn stl_is_welded_and_numbered_by_first_appearance() {
    for comment in ["made by a test", "solid binary", "solid\nfacet "] {
        let model = read_bytes(binary_stl(comment, &TWO_TRIANGLES), "a.stl").unwrap();
        assert_eq!(model.faces().collect::<Vec<_>>(), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(model.points()[3], [0.0, 1.0, 0.5]);
    }
}

#[test]
fn stl_text_is_read_in_f64() {
    let text = "solid\n facet normal 0 0 1\n  outer loop\n vertex 0.1 0 0\n VERTEX 1 0 0\n vertex 0 1 1E-30\n endloop\n endfacet\nendsolid\nsolid b\nendsolid b\n";
    let model = read_bytes(text.into(), "a.stl").unwrap();
    assert_eq!(model.points(), [[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1e-30]]);
    let (whole, _) = text.rsplit_once("endfacet").unwrap();
    assert_eq!(
        message(whole, "a.stl"),
        "a.stl, line 8: found the end of the file, expected `endfacet`: it seems to be cut short"
    );
    let four = text.replace(" endloop", " vertex 1 1 1\n endloop");
    assert_eq!(message(four, "a.stl"), "a.stl, line 7: found `vertex`, expected `endloop`");
}

#[test]
fn stl_cut_short_is_refused_and_surplus_counted() {
    let mut bytes = binary_stl("", &TWO_TRIANGLES);
    let short = message(&bytes[..bytes.len() - 1], "a.stl");
    assert_eq!(
        short,
        "a.stl, byte 183: the header claims 2 triangles, but the file ends after 1: it is cut short or damaged"
    );
    bytes.extend([0; 7]);
    assert_eq!(read_bytes(bytes.clone(), "a.stl").unwrap().skipped().surplus, 7);
    bytes[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(message(bytes, "a.stl").starts_with("a.stl, byte 96: found a point with the coordinate NaN"));
}

#[test]
fn text_that_is_no_stl_is_told_to_be_text() {
    let list = "milk 2\nbread 1\n".repeat(20);
    let expected =
        "a.stl, line 1: found text that begins with `milk`, expected `solid`, as in a text STL, or a binary STL";
    assert_eq!(message(list.clone(), "a.stl"), expected);
    assert_eq!(message("milk", "a.stl"), expected);
    assert_eq!(
        message(format!("solid s\n{list}"), "a.stl"),
        "a.stl, line 2: found `milk`, expected `facet` or `endsolid`"
    );
    assert_eq!(
        message("solid s\nendsolid s\nmilk\n", "a.stl"),
        "a.stl, line 3: found `milk`, expected `solid` or the end of the file"
    );
    // A comment of letters is no text of triangles.
    let mut bytes = binary_stl("solid of a program that fills the comment with words", &TWO_TRIANGLES);
    bytes.pop();
    assert!(message(bytes, "a.stl").contains("claims 2 triangles"));
}

#[test]
fn a_file_of_another_kind_is_told_by_what_it_begins_with() {
    let shopping = message("milk\nbread\n", "a.obj");
    assert_eq!(shopping, "a.obj: found no line that begins with `v`, expected vertices, as lines `v x y z`");
    let bytes = message(b"\x07\x91\xfe\x03\x00\x55".to_vec(), "a.glb");
    assert!(
        bytes.starts_with("a.glb, byte 0: found content that begins with `") && bytes.contains("`glTF`"),
        "{bytes}"
    );
    assert!(message("{\"asset\": 1}", "a.gltf").contains("JSON that is no glTF"));
}

#[test]
fn a_text_that_ends_within_a_line_is_said_to_be_cut_short() {
    let cut = "it seems to be cut short";
    for (text, name) in [
        ("v 0 0 0\nv 1 0", "a.obj"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2", "a.obj"),
        ("OFF\n3 1 0\n0 0 0\n1 0", "a.off"),
        ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nend_hea", "a.ply"),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 1",
            "a.ply",
        ),
        ("solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0", "a.stl"),
    ] {
        let said = message(text, name);
        assert!(said.ends_with(cut), "{said}");
        // A line that has its end is wrong in itself.
        let ended = message(format!("{text}\n#\n"), name);
        assert!(name == "a.ply" || !ended.contains(cut), "{ended}");
    }
    let binary = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n123";
    assert_eq!(
        message(binary, "a.ply"),
        "a.ply, byte 115: found the end of the file, expected a number for `x`: it seems to be cut short"
    );
}

#[test]
fn stl_agrees_with_stl_io() {
    let bytes = binary_stl("", &TWO_TRIANGLES);
    let theirs = stl_io::read_stl(&mut std::io::Cursor::new(&bytes)).unwrap();
    let ours = read_bytes(bytes, "a.stl").unwrap();
    for (face, corners) in theirs.faces.iter().zip(ours.faces()) {
        for (&theirs_at, &ours_at) in face.vertices.iter().zip(corners) {
            let point: [f32; 3] = theirs.vertices[theirs_at].into();
            assert_eq!(point.map(f64::from), ours.points()[ours_at as usize]);
        }
    }
}
