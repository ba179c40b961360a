//! Textures transferred to another map.

use crate::folder::{Folder, PROGRAM, stderr, stdout};
use crate::textures::{TWO, materials};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;
use std::io::Cursor;

const RED: [u8; 3] = [200, 10, 30];
const BLUE: [u8; 3] = [20, 30, 220];
const GREEN: [u8; 3] = [40, 180, 60];

/// A PNG of so many pixels on a side.
pub(crate) fn png(side: usize, pixel: impl Fn(usize, usize) -> [u8; 3]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side as u32, side as u32);
    encoder.set_color(png::ColorType::Rgb);
    let pixels: Vec<u8> = (0..side * side).flat_map(|k| pixel(k % side, k / side)).collect();
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    bytes
}

/// The side and the pixels of a PNG without alpha.
fn pixels(bytes: &[u8]) -> (usize, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut samples).unwrap();
    assert_eq!(reader.output_color_type().0, png::ColorType::Rgb);
    (reader.info().width as usize, samples.as_chunks().0.to_vec())
}

/// Two squares: the one half red, half green, the other blue; and both packed into one square.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("two.obj", TWO);
    folder.write("two.mtl", &materials("map_Kd red.png", "map_Kd blue.png"));
    std::fs::write(folder.path("red.png"), png(64, |x, _| if x < 32 { RED } else { GREEN })).unwrap();
    std::fs::write(folder.path("blue.png"), png(8, |_, _| BLUE)).unwrap();
    folder.run(&["pack", "two.obj", "-o", "new.obj"]).success();
    folder
}

/// The colour that a model with one texture has at a point of a face, given by weights of its corners.
fn shown(folder: &Folder, model: &str, picture: &str, face: usize, weights: &[f64]) -> [u8; 3] {
    let model = geom::io::read(folder.path(model)).unwrap();
    let corners = model.face_corners(face).map(|corner| model.uv().unwrap().corner(corner).unwrap());
    let at = corners.zip(weights).fold([0.0; 2], |sum, (uv, w)| [sum[0] + w * uv[0], sum[1] + w * uv[1]]);
    let (side, pixels) = pixels(&std::fs::read(folder.path(picture)).unwrap());
    let [x, y] = [at[0], 1.0 - at[1]].map(|x| (x * side as f64) as usize);
    pixels[y * side + x]
}

#[test]
fn each_face_shows_in_the_new_map_what_it_showed_in_the_old() {
    let folder = folder();
    let done = folder.run(&["bake", "two.obj", "new.obj", "-o", "out.obj", "--texture-size", "128"]).success();
    assert!(stderr(&done).is_empty() && stdout(&done).contains("128 × 128 texels"), "{}", stdout(&done));
    assert_eq!(folder.read("out.mtl"), "newmtl baked\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd out.png\n");
    let model = folder.read("out.obj");
    assert!(model.contains("mtllib out.mtl\nusemtl baked\n") && model.matches("mtl ").count() == 1, "{model}");
    for (face, weights, colour) in [
        (0, [0.4, 0.1, 0.1, 0.4], RED),
        (0, [0.49, 0.01, 0.01, 0.49], RED),
        (0, [0.1, 0.4, 0.4, 0.1], GREEN),
        (1, [0.25; 4], BLUE),
        (1, [1.0, 0.0, 0.0, 0.0], BLUE),
    ] {
        assert_eq!(shown(&folder, "out.obj", "out.png", face, &weights), colour, "{face} {weights:?}");
    }
    // A picture alone says what shows it; triangles in place of the quadrilaterals, as PLY, are the same surface.
    folder.run(&["pack", "new.obj", "-o", "new.glb"]).success();
    let done = folder.run(&["bake", "two.obj", "new.glb", "-o", "alone.png", "--padding", "0"]).success();
    assert!(stdout(&done).contains("map_Kd alone.png") && stdout(&done).contains("128 × 128"), "{}", stdout(&done));
    assert_eq!(shown(&folder, "new.glb", "alone.png", 0, &[0.6, 0.2, 0.2]), RED);
    assert_eq!(shown(&folder, "new.glb", "alone.png", 3, &[0.6, 0.2, 0.2]), BLUE);
}

#[test]
fn the_same_bits_come_of_any_number_of_threads_and_margins_are_as_wide_as_asked_for() {
    let folder = folder();
    let baked = |more: &[&str]| {
        folder
            .run(&[&["bake", "two.obj", "new.obj", "-o", "out.png", "--texture-size", "200"], more].concat())
            .success();
        std::fs::read(folder.path("out.png")).unwrap()
    };
    assert_eq!(baked(&["--threads", "1"]), baked(&["--threads", "3"]));
    let plain = |bytes: Vec<u8>| pixels(&bytes).1.iter().filter(|pixel| [RED, BLUE, GREEN].contains(pixel)).count();
    let [none, some, all] = ["0", "3", "400"].map(|padding| plain(baked(&["--padding", padding])));
    // The others are between red and green.
    assert!(none < some && some < all && all > 39_000, "{none} {some} {all}");
}

#[test]
fn what_cannot_be_baked_is_said_and_nothing_is_written() {
    let folder = folder();
    folder.write("moved.obj", &folder.read("new.obj").replace("v 6 1 0", "v 6 1.1 0"));
    folder.write("line.obj", "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 2 0 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\n");
    folder.write("tiles.obj", &TWO.replace("vt 1 1", "vt 1 1.5"));
    folder.write("bare.obj", &TWO.replace("mtllib", "# mtllib"));
    folder.write("plain.obj", &["/1", "/2", "/3", "/4"].iter().fold(TWO.to_owned(), |text, vt| text.replace(vt, "")));
    folder.write("lost.obj", &TWO.replace("two.mtl", "lost.mtl"));
    folder.write("turned.obj", &TWO.replace("two.mtl", "turned.mtl"));
    folder.write("turned.mtl", &materials("map_Kd -o 0.5 0 0 red.png", "map_Kd blue.png"));
    folder.write("gone.obj", &TWO.replace("two.mtl", "gone.mtl"));
    folder.write("gone.mtl", &materials("map_Kd red.png", "map_Kd gone.png"));
    folder.write("torn.obj", &TWO.replace("two.mtl", "torn.mtl"));
    folder.write("torn.mtl", &materials("map_Kd red.png", "map_Kd torn.jpg"));
    folder.write("torn.jpg", "GIF89a");
    folder.write("rough.obj", &TWO.replace("two.mtl", "rough.mtl"));
    folder.write("rough.mtl", &materials("map_Kd red.png\nmap_Bump -bm 0.5 bump.png", "map_Kd blue.png"));
    folder.write("bump.png", "as it was");
    folder.write("away.obj", &TWO.replace("two.mtl", r"C:\scans\lib.mtl"));
    folder.write("lib.mtl", &materials("map_Kd red.png", "map_Kd blue.png"));
    let names = folder.names();
    for (old, new, out, told) in [
        (
            "two.obj",
            "moved.obj",
            "o.png",
            "face 1 (counted from 0) of moved.obj is 1.64 % of the surface's size away from two.obj",
        ),
        ("line.obj", "new.obj", "o.png", "line.obj has no face with an area"),
        ("two.obj", "tiles.obj", "o.png", "tiles.obj has the texture coordinate 1 1.5 at face 0"),
        ("bare.obj", "new.obj", "o.png", "bare.obj has no textures"),
        ("plain.obj", "new.obj", "o.png", "plain.obj has no texture coordinates"),
        ("lost.obj", "new.obj", "o.png", "lost.obj: what red shows is not known"),
        ("turned.obj", "new.obj", "o.obj", "turned.obj: the texture red.png is moved or scaled"),
        ("gone.obj", "new.obj", "o.obj", "gone.png: there is no such file"),
        ("torn.obj", "new.obj", "o.obj", "torn.jpg: is neither a PNG nor a JPEG"),
        ("two.obj", "new.obj", "red.png", "red.png is the input"),
        ("two.obj", "new.obj", "two.obj", "two.obj is the input"),
        ("two.obj", "new.obj", "blue.obj", "blue.png is the input"),
        // Other maps of materials, and a library that is named as on another machine.
        ("rough.obj", "new.obj", "bump.png", "bump.png is the input"),
        ("away.obj", "new.obj", "lib.obj", "lib.mtl is the input"),
        ("two.obj", "new.obj", "o.jpg", "end it in .png, .glb or .obj"),
    ] {
        let complaint = folder.complaint(&["bake", old, new, "-o", out]);
        assert!(complaint.split_whitespace().collect::<Vec<_>>().join(" ").contains(told), "{complaint}");
        assert_eq!(folder.names(), names, "{told}");
    }
    folder.run(&["bake", "two.obj", "new.obj", "-o", "o.png", "--texture-size", "20000"]).code(2);
}

#[test]
fn faces_without_a_texture_and_maps_that_lie_over_themselves_are_told_of() {
    let folder = folder();
    folder.write("two.mtl", &materials("map_Kd red.png", "").replace("Kd 0 0 1", ""));
    let said = stderr(&folder.run(&["bake", "two.obj", "new.obj", "-o", "out.png"]).success());
    assert!(said.contains("1 face has no texture in two.obj"), "{said}");
    // One with a colour has that.
    folder.write("two.mtl", &materials("map_Kd red.png", ""));
    let said = stderr(&folder.run(&["bake", "two.obj", "new.obj", "-o", "out.png"]).success());
    assert!(said.is_empty(), "{said}");
    assert_eq!(shown(&folder, "new.obj", "out.png", 1, &[0.25; 4]), [0, 0, 255]);
    folder.write("two.mtl", &materials("map_Kd red.png\nmap_Bump bump.png\nmap_Pr rough.png", "map_Kd blue.png"));
    let said = stderr(&folder.run(&["bake", "two.obj", "new.obj", "-o", "out.png"]).success());
    assert!(said.contains("and not map_Bump and map_Pr: directions"), "{said}");
    let said = stderr(&folder.run(&["bake", "two.obj", "two.obj", "-o", "out.png"]).success());
    assert!(said.contains("two.obj lies over itself"), "{said}");
}

#[test]
fn a_glb_has_its_texture_in_it() {
    let folder = folder();
    folder.run(&["pack", "two.obj", "-o", "new.glb"]).success();
    let told = stderr(&folder.run(&["pack", "two.obj", "-o", "new.glb"]).success());
    assert!(told.contains("cones bake two.obj new.glb -o new.baked.glb makes one that does"), "{told}");
    let size = ["--texture-size", "128"];
    folder.run(&[&["bake", "two.obj", "new.glb", "-o", "out.png"], &size[..]].concat()).success();
    let done = folder.run(&[&["bake", "two.obj", "new.glb", "-o", "out.glb"], &size[..]].concat()).success();
    assert!(stderr(&done).is_empty() && stdout(&done).contains("out.glb"), "{}", stdout(&done));
    // It is the picture that is written alone, and a model with a texture as any other.
    let model = geom::io::read(folder.path("out.glb")).unwrap();
    let textures = geom::io::Textures::of(&model, &folder.path("out.glb"));
    let inside = geom::io::read_picture(folder.path("out.glb"), &textures.list()[0].picture).unwrap();
    assert_eq!(inside, std::fs::read(folder.path("out.png")).unwrap());
    folder.run(&["bake", "out.glb", "new.obj", "-o", "again.png"]).success();
    for (face, colour) in [(0, RED), (1, BLUE)] {
        assert_eq!(shown(&folder, "new.obj", "again.png", face, &[0.4, 0.1, 0.1, 0.4]), colour);
    }
    let glb = std::fs::read(folder.path("out.glb")).unwrap();
    let piped = assert_cmd::Command::new(PROGRAM)
        .args(["bake", "-", "new.obj", "-o", "none.png"])
        .current_dir(folder.root())
        .write_stdin(glb)
        .assert()
        .code(1);
    assert!(stderr(&piped).contains("standard input, where pictures are not read from"), "{}", stderr(&piped));
}

#[test]
fn other_triangles_of_the_surface_show_what_is_at_their_places() {
    let folder = folder();
    folder.run(&["unwrap", "two.obj", "--refine=always", "-o", "refined.obj"]).success();
    let refined = geom::io::read(folder.path("refined.obj")).unwrap();
    assert!(refined.face_count() > 4, "{} faces", refined.face_count());
    // The other way round, too: fine triangles are transferred to coarse ones.
    folder.run(&["bake", "two.obj", "refined.obj", "-o", "baked.obj", "--texture-size", "256"]).success();
    folder.run(&["bake", "baked.obj", "new.obj", "-o", "back.png", "--texture-size", "256"]).success();
    for face in 0..refined.face_count() {
        let middle = |k: usize| refined.face(face).iter().map(|&v| refined.points()[v as usize][k]).sum::<f64>() / 3.0;
        let colour = match middle(0) {
            x if x > 4.0 => BLUE,
            x if (0.45..0.55).contains(&x) => continue,
            x => {
                if x < 0.5 {
                    RED
                } else {
                    GREEN
                }
            }
        };
        assert_eq!(shown(&folder, "refined.obj", "baked.png", face, &[1.0 / 3.0; 3]), colour, "{face}");
    }
    for (face, weights, colour) in
        [(0, [0.4, 0.1, 0.1, 0.4], RED), (0, [0.1, 0.4, 0.4, 0.1], GREEN), (1, [0.25; 4], BLUE)]
    {
        let seen = shown(&folder, "new.obj", "back.png", face, &weights);
        assert!(seen.iter().zip(colour).all(|(a, b)| a.abs_diff(b) <= 1), "{seen:?} {colour:?}");
    }
    // What is farther away than may be is refused, unless that is asked for.
    folder.write("high.obj", &folder.read("new.obj").replace(" 0\nv", " 0.1\nv"));
    let bake = ["bake", "two.obj", "high.obj", "-o", "high.png"];
    assert!(folder.complaint(&bake).contains("1.64 % of the surface's size away from two.obj"));
    folder.run(&[&bake[..], &["--max-distance", "0.02"]].concat()).success();
}

#[test]
fn textures_within_a_gltf_are_read() {
    let folder = Folder::new();
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let points = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let uv = floats(&[0.0, 1.0, 0.5, 1.0, 0.0, 0.5]);
    let picture = png(16, |x, y| if x < 8 && y >= 8 { GREEN } else { RED });
    let bytes = [points, uv, picture].concat();
    let accessor =
        |view: usize, kind: &str| json!({"bufferView": view, "componentType": 5126, "count": 3, "type": kind});
    let mut gltf = json!({
        "asset": {"version": "2.0"},
        "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 2, "mimeType": "image/png", "name": "leaf"}],
        "accessors": [accessor(0, "VEC3"), accessor(1, "VEC2")],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 24},
            {"buffer": 0, "byteOffset": 60, "byteLength": bytes.len() - 60},
        ],
        "buffers": [{"byteLength": bytes.len(), "uri": format!("data:;base64,{}", STANDARD.encode(&bytes))}],
    });
    folder.write("old.gltf", &gltf.to_string());
    folder.write("new.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.1 0.1\nvt 0.9 0.1\nvt 0.1 0.9\nf 1/1 2/2 3/3\n");
    folder.run(&["bake", "old.gltf", "new.obj", "-o", "out.png", "--texture-size", "32"]).success();
    assert_eq!(shown(&folder, "new.obj", "out.png", 0, &[0.3, 0.3, 0.4]), GREEN);
    let unwrapped = stderr(&folder.run(&["unwrap", "old.gltf", "-o", "u.obj"]).success());
    assert!(unwrapped.contains("leaf was made for the old map"), "{unwrapped}");
    // What a material multiplies its texture by belongs to what is seen.
    gltf["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 0, 1, 1]);
    folder.write("old.gltf", &gltf.to_string());
    folder.run(&["bake", "old.gltf", "new.obj", "-o", "out.png", "--texture-size", "32"]).success();
    assert_eq!(shown(&folder, "new.obj", "out.png", 0, &[0.3, 0.3, 0.4]), [GREEN[0], 0, GREEN[2]]);
    gltf["images"] = json!([{"uri": "leaf.png"}]);
    folder.write("old.gltf", &gltf.to_string());
    std::fs::write(folder.path("leaf.png"), png(16, |_, _| RED)).unwrap();
    assert!(folder.complaint(&["bake", "old.gltf", "new.obj", "-o", "leaf.png"]).contains("leaf.png is the input"));
    gltf["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1.into();
    folder.write("old.gltf", &gltf.to_string());
    let complaint = folder.complaint(&["bake", "old.gltf", "new.obj", "-o", "none.png"]);
    assert!(complaint.contains("placed by other coordinates"), "{complaint}");
}
