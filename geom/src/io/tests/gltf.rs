//! glTF in, in all its ways, and what it must not be.

use serde_json::{Value, json};

use super::*;
use crate::surface::Meaning;

/// A quad as a strip with normals, colours and texture coordinates, once as it is and once mirrored; a value of the JSON may be
/// replaced.
fn document(change: impl Fn(&mut Value)) -> (Value, Vec<u8>) {
    let mut bytes: Vec<u8> = Vec::new();
    let points: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    points.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    [[0.0_f32, 0.0, 1.0]; 4].iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes.extend([255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 0, 0, 0, 255_u8]);
    [[0_u16, 0], [65535, 0], [0, 65535], [65535, 65535]].iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes.extend([0, 1, 2, 3_u8]);
    let view = |offset: usize, length: usize| json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
    let mut json = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"mesh": 0, "children": [1]},
            {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
        ],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2, "TEXCOORD_0": 3},
            "indices": 4, "mode": 5, "material": 1,
        }]}],
        "materials": [{"name": "other"}, {"name": "brick"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5123, "normalized": true, "count": 4, "type": "VEC2"},
            {"bufferView": 4, "componentType": 5121, "count": 4, "type": "SCALAR"},
        ],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 16), view(112, 16), view(128, 4)],
        "buffers": [{"byteLength": 132}],
    });
    change(&mut json);
    (json, bytes)
}

fn glb((json, binary): (Value, Vec<u8>)) -> Vec<u8> {
    glb_of(&json.to_string(), binary)
}

fn glb_of(json: &str, binary: Vec<u8>) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let size = 12 + 8 + json.len() + 8 + binary.len();
    [2, size as u32, json.len() as u32].iter().for_each(|word| out.extend(word.to_le_bytes()));
    out.extend(b"JSON");
    out.extend(json);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

pub(super) fn small_glb() -> Vec<u8> {
    glb(document(|_| ()))
}

/// The same with its buffer inside the JSON.
pub(super) fn small_json() -> String {
    use base64::Engine;
    let (mut json, binary) = document(|_| ());
    let data = base64::engine::general_purpose::STANDARD.encode(binary);
    json["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{data}").into();
    json.to_string()
}

fn refused(change: impl Fn(&mut Value)) -> String {
    message(glb(document(change)), "a.glb")
}

#[test]
fn nodes_are_moved_and_mirrored_ones_stay_outside_out() {
    let model = read_bytes(small_glb(), "a.glb").unwrap();
    assert_eq!((model.vertex_count(), model.face_count()), (8, 4));
    assert_eq!(model.faces().next().unwrap(), [0, 1, 2]);
    assert_eq!(model.faces().nth(1).unwrap(), [2, 1, 3], "every second triangle of a strip is turned");
    assert_eq!(model.points()[7], [-1.0, 2.0, 5.0]);
    assert_eq!(model.faces().nth(2).unwrap(), [4, 6, 5], "and all where the node mirrors");
    assert_eq!(model.uv().unwrap().corner(2), Some([0.0, 0.0]), "v is counted upwards");
    let attributes = model.attributes();
    assert_eq!((attributes.material(3), &attributes.left[..]), (Some("brick"), &[][..]));
    let row = |meaning, v| attributes.table(&meaning).unwrap().row(v).collect::<Vec<_>>();
    assert_eq!(row(Meaning::Normal, 7), [0.0, 0.0, 1.0]);
    assert_eq!(row(Meaning::Colour, 1), [0.0, 65535.0, 0.0, 65535.0]);
    let inside = read_bytes(small_json().into_bytes(), "a.gltf").unwrap();
    assert_same_surface(&inside, &model);
}

/// The JSON of a `.glb`.
fn json_of(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&glb[20..20 + length]).unwrap()
}

fn points_at_corners(model: &Model) -> Vec<[f64; 3]> {
    model.corners().iter().map(|&v| model.points()[v as usize]).collect()
}

#[test]
fn the_tree_of_nodes_comes_back_with_names_and_places() {
    let turned = [0.5, 0.5, 0.5, 0.5];
    let (json, bytes) = document(|json| {
        json["nodes"] = json!([
            {"name": "house", "translation": [3.0, 4.0, 5.0], "children": [2, 1]},
            {"name": "door", "mesh": 0, "matrix": [-1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 5.0, 1.0]},
            {"mesh": 0, "rotation": turned, "scale": [1.0, 2.0, -4.0], "children": [3]},
            {"name": "handle"},
            {"name": "elsewhere", "mesh": 0},
        ]);
        json["meshes"][0]["name"] = "panel".into();
    });
    let model = read_bytes(glb((json, bytes)), "a.glb").unwrap();
    let attributes = model.attributes();
    let names: Vec<&str> = attributes.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["house", "", "handle", "door"], "in the order of a walk down the tree");
    assert_eq!(attributes.face_node, [1, 1, 3, 3]);
    assert!(not_kept(&model, MeshFormat::Ply).unwrap().what.contains(&"nodes".to_owned()));
    assert_eq!(not_kept(&model, MeshFormat::Glb), None);
    let uv = model.whole_uv().unwrap();
    for uv in [None, Some(&uv[..])] {
        let mut out = Vec::new();
        write_glb(&model, uv, &model.triangles(), None, &mut out).unwrap();
        let written = json_of(&out);
        assert_eq!(
            written["nodes"],
            json!([
                {"name": "house", "translation": [3.0, 4.0, 5.0], "children": [1, 3]},
                {"mesh": 0, "rotation": turned, "scale": [1.0, 2.0, -4.0], "children": [2]},
                {"name": "handle"},
                {"name": "door", "mesh": 1, "matrix": [-1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 5.0, 1.0]},
            ])
        );
        assert_eq!(written["scenes"][0]["nodes"], json!([0]));
        assert_eq!([&written["meshes"][0]["name"], &written["meshes"][1]["name"]], ["panel"; 2]);
        assert_eq!(written["materials"].as_array().unwrap().len(), 1, "both meshes have one");
        let back = read_bytes(out, "b.glb").unwrap();
        assert_eq!(points_at_corners(&back), points_at_corners(&model));
        assert_eq!(
            (&back.attributes().nodes, &back.attributes().face_node),
            (&attributes.nodes, &attributes.face_node)
        );
        let normals = |model: &Model| {
            let table = model.attributes().table(&Meaning::Normal).unwrap();
            let row = |corner| table.row(table.row_at(model.corners(), corner).unwrap()).collect::<Vec<_>>();
            (0..model.corner_count()).map(row).collect::<Vec<_>>()
        };
        assert_eq!(normals(&back), normals(&model));
    }
}

#[test]
fn a_node_without_a_way_back_stays_and_its_mesh_stands_beside_it() {
    let (json, bytes) = document(|json| {
        json["nodes"] = json!([{"name": "shadow", "mesh": 0, "scale": [1.0, 0.0, 1.0]}, {"name": "thing", "mesh": 0}]);
        json["scenes"][0]["nodes"] = json!([0, 1]);
    });
    let model = read_bytes(glb((json, bytes)), "a.glb").unwrap();
    let mut out = Vec::new();
    write_glb(&model, None, &model.triangles(), None, &mut out).unwrap();
    let written = json_of(&out);
    assert_eq!(written["scenes"][0]["nodes"], json!([0, 1, 2]));
    assert_eq!([&written["nodes"][0]["mesh"], &written["nodes"][1]["mesh"]], [&Value::Null, &json!(1)]);
    let back = read_bytes(out, "b.glb").unwrap();
    let mut expected = points_at_corners(&model);
    expected.rotate_left(6);
    assert_eq!(points_at_corners(&back), expected, "the node that is new comes last");
}

#[test]
fn vertices_at_one_place_are_joined_and_what_differs_stays_at_corners() {
    let split = document(|json| {
        json["accessors"][4]["count"] = 3.into();
        json["meshes"][0]["primitives"][0]["mode"] = 4.into();
        let mut second = json["meshes"][0]["primitives"][0].clone();
        second["attributes"]["NORMAL"] = 0.into();
        second["material"] = 0.into();
        json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
        json["nodes"][0]["children"] = json!([]);
    });
    let model = read_bytes(glb(split), "a.glb").unwrap();
    assert_eq!((model.vertex_count(), model.faces().collect::<Vec<_>>()), (3, vec![&[0, 1, 2][..]; 2]));
    let normals = model.attributes().table(&Meaning::Normal).unwrap();
    let at = |corner| normals.row(normals.row_at(model.corners(), corner).unwrap()).collect::<Vec<_>>();
    assert_eq!((at(1), at(4)), (vec![0.0, 0.0, 1.0], vec![1.0, 0.0, 0.0]));
    assert_eq!(model.attributes().table(&Meaning::Colour).unwrap().rows(), 3, "what agrees is the vertices'");
    assert_eq!((model.attributes().material(0), model.attributes().material(1)), (Some("brick"), Some("other")));
}

#[test]
fn sparse_elements_stand_in_place_of_others() {
    let sparse = |index: u32| {
        move |json: &mut Value| {
            json["accessors"][0]["sparse"] = json!({
                "count": 1,
                "indices": {"bufferView": 4, "byteOffset": index, "componentType": 5121},
                "values": {"bufferView": 1},
            });
        }
    };
    let model = read_bytes(glb(document(sparse(3))), "a.glb").unwrap();
    assert_eq!((model.points()[3], model.points()[1]), ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]));
    assert!(refused(sparse(4)).contains("1 sparse element that is not there in accessor 0 (for positions)"));
    let zeros = read_bytes(
        glb(document(|json| {
            sparse(3)(json);
            json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        })),
        "a.glb",
    );
    assert_eq!(zeros.unwrap().points()[..2], [[0.0; 3], [0.0, 0.0, 1.0]], "all zeros but one");
}

#[test]
fn materials_keep_their_looks_but_for_textures() {
    let red = json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}});
    let seen = document(|json| {
        let mut material = red.clone();
        material["name"] = "brick".into();
        material["normalTexture"] = json!({"index": 0});
        material["extensions"] = json!({"KHR_materials_unlit": {}});
        material["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
        json["materials"][1] = material;
    });
    let model = read_bytes(glb(seen), "a.glb").unwrap();
    assert_eq!(model.attributes().looks, ["", &red.to_string()]);
    let lost = not_kept(&model, MeshFormat::Obj).unwrap().what;
    assert!(lost.contains(&"looks of materials".to_owned()), "{lost:?}");
    // What has a look keeps it, and what has none gets the texture, which is no look when it is read again.
    let uv = vec![[0.0; 2]; model.corner_count()];
    let written = |model: &Model| {
        let mut out = Vec::new();
        write_glb(model, Some(&uv), &model.triangles(), Some(GlbTexture::Checker(b"png")), &mut out).unwrap();
        read_bytes(out, "b.glb").unwrap()
    };
    let back = written(&model);
    assert_eq!((back.attributes().look(0), back.attributes().material(0)), (model.attributes().look(0), Some("brick")));
    assert!(!not_kept(&back, MeshFormat::Obj).unwrap().what.contains(&"textures".to_owned()));
    // A number that is too large is no cause to refuse the surface.
    let (json, bytes) = document(|json| json["materials"][1]["alphaCutoff"] = 1234.5.into());
    let huge = glb_of(&json.to_string().replace("1234.5", "1e999"), bytes);
    assert_eq!(read_bytes(huge, "a.glb").unwrap().attributes().look(0), None);
    let plain = read_bytes(glb(document(|_| {})), "a.glb").unwrap();
    assert_eq!(written(&plain).attributes().look(0), None);
}

#[test]
fn a_baked_texture_is_on_one_material_and_read_again() {
    let model = read_bytes(glb(document(|_| {})), "a.glb").unwrap();
    let uv = vec![[0.0; 2]; model.corner_count()];
    let texture = GlbTexture::Baked { png: b"png", name: "baked", alpha_mode: "MASK" };
    let mut out = Vec::new();
    write_glb(&model, Some(&uv), &model.triangles(), Some(texture), &mut out).unwrap();
    assert_eq!(super::super::gltf::image(&out, 0, None).unwrap(), b"png");
    let back = read_bytes(out, "b.glb").unwrap();
    let attributes = back.attributes();
    assert_eq!(
        (attributes.materials.as_slice(), &*attributes.left),
        (&["baked".to_owned()][..], &["textures".to_owned()][..])
    );
    assert!(attributes.looks[0].contains("MASK"), "{:?}", attributes.looks);
    let textures = Textures::of(&back, Path::new("b.glb"));
    assert_eq!(textures.list()[0].picture, Picture::Image(0));
    assert!((0..back.face_count()).all(|face| textures.of_face(face) == Some(0)));
}

#[test]
fn a_texture_has_its_factor_and_other_files_are_named() {
    let seen = document(|json| {
        json["images"] = json!([{"uri": "a%20b.webp"}, {"uri": "data:;base64,"}, {"uri": "bump.png"}]);
        json["textures"] = json!([{"extensions": {"EXT_texture_webp": {"source": 0}}}]);
        json["materials"][1]["pbrMetallicRoughness"] =
            json!({"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1, 1, 1]});
        json["materials"][1]["normalTexture"] = json!({"index": 0});
    });
    let model = read_bytes(glb(seen), "a.glb").unwrap();
    let textures = Textures::of(&model, Path::new("in/a.glb"));
    assert_eq!((&*textures.list()[0].name, textures.colour(0)), ("a%20b.webp", Some([0.5, 1.0, 1.0, 1.0])));
    assert_eq!(textures.files(), [Path::new("in/a b.webp"), Path::new("in/bump.png")]);
    assert_eq!(textures.other_maps(), ["normalTexture"]);
}

#[test]
fn what_is_passed_over_is_named_and_what_is_needed_refused() {
    let seen = document(|json| {
        json["animations"] = json!([{}]);
        json["images"] = json!([{}]);
        json["meshes"][0]["primitives"][0]["targets"] = json!([{}]);
        json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = 2.into();
        json["extensionsRequired"] = json!(["KHR_mesh_quantization", "KHR_materials_unlit"]);
    });
    let model = read_bytes(glb(seen), "a.glb").unwrap();
    assert_eq!(model.attributes().left, ["tangents", "morph targets", "animations", "textures"]);
    let ours = document(|json| {
        json["asset"]["generator"] = "cones".into();
        json["images"] = json!([{}]);
    });
    assert!(read_bytes(glb(ours), "a.glb").unwrap().attributes().left.is_empty(), "a checkerboard of ours is no loss");
    for (name, advice) in [
        ("KHR_draco_mesh_compression", "without compression"),
        ("EXT_meshopt_compression", "without compression"),
        ("EXT_mesh_gpu_instancing", "export it without"),
    ] {
        let message = refused(|json| json["extensionsRequired"] = json!([name]));
        assert!(message.starts_with("a.glb: found the required extension") && message.contains(name), "{message}");
        assert!(message.ends_with(advice), "{message}");
    }
    assert!(refused(|json| json["asset"]["version"] = "1.0".into()).contains("expected glTF of version 2"));
    assert!(refused(|json| json["meshes"][0]["primitives"][0]["mode"] = 1.into()).contains("no vertices"));
}

#[test]
fn pictures_of_base_colours_are_known_by_number_and_read_by_it() {
    let change = |json: &mut Value| {
        json["materials"][1]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": 1}});
        json["textures"] = json!([{"source": 1}, {"source": 0}]);
        // The indices of the strip stand in for a picture.
        json["images"] = json!([{"bufferView": 4, "mimeType": "image/png"}, {"uri": "a.png"}, 7]);
    };
    let bytes = glb(document(change));
    let model = read_bytes(bytes.clone(), "a.glb").unwrap();
    let textures = crate::io::Textures::of(&model, "in/a.glb".as_ref());
    assert_eq!((textures.list().len(), textures.of_face(0)), (1, Some(0)));
    let texture = &textures.list()[0];
    assert_eq!((&*texture.name, &texture.picture), ("image 0", &crate::io::Picture::Image(0)));
    let image = |number| super::super::gltf::image(&bytes, number, None);
    assert_eq!(image(0).unwrap(), [0, 1, 2, 3]);
    let told = |number| image(number).unwrap_err().in_file("a.glb".as_ref()).to_string();
    assert!(told(1).contains("an image in another file, `a.png`"), "{}", told(1));
    assert!(told(2).contains("image 2 without data") && told(3).contains("no image 3"));
    let ours = document(|json| {
        change(json);
        json["asset"]["generator"] = "cones".into();
    });
    assert!(read_bytes(glb(ours), "a.glb").unwrap().attributes().pictures.is_empty());
}

#[test]
fn what_points_outside_is_refused_where_it_stands() {
    let set = |path: &'static str, value: u64| {
        let message = refused(|json| *json.pointer_mut(path).unwrap() = value.into());
        assert!(message.starts_with("a.glb: "), "{message}");
        message
    };
    assert!(set("/accessors/0/count", 5).contains("accessor 0 (for positions)"));
    assert!(set("/accessors/0/count", u64::from(u32::MAX) * 1000).contains("accessor 0"));
    assert!(set("/accessors/1/count", 3).contains("3 elements of NORMAL for 4 vertices"));
    assert!(
        set("/accessors/4/bufferView", 2).contains("found vertex 255 in a primitive, expected a vertex from 0 to 3")
    );
    for (path, value) in [
        ("/bufferViews/0/byteLength", 1 << 60),
        ("/bufferViews/0/byteOffset", u64::MAX),
        ("/bufferViews/0/buffer", 7),
        ("/accessors/0/bufferView", 99),
        ("/accessors/0/componentType", 5124),
        ("/accessors/4/componentType", 5126),
        ("/nodes/0/mesh", 9),
        ("/nodes/0/children/0", 0),
        ("/nodes/0/children/0", 12),
        ("/meshes/0/primitives/0/attributes/POSITION", 3),
        ("/meshes/0/primitives/0/mode", 7),
        ("/buffers/0/byteLength", 133),
    ] {
        set(path, value);
    }
    let message = refused(|json| json["bufferViews"][0]["byteStride"] = 0.into());
    assert!(message.contains("0 bytes apart"), "elements on top of each other would be many for few bytes: {message}");
}

#[test]
fn a_glb_cut_anywhere_is_refused_and_lying_lengths_too() {
    let whole = small_glb();
    for end in 0..whole.len() {
        message(whole[..end].to_vec(), "a.glb");
    }
    for at in [8, 12] {
        for length in [0, 3, 0x7fff_ffff, u32::MAX] {
            let mut bytes = whole.clone();
            bytes[at..at + 4].copy_from_slice(&length.to_le_bytes());
            message(bytes, "a.glb");
        }
    }
}

#[test]
fn one_mesh_over_and_over_fills_no_memory() {
    let many = document(|json| {
        let primitive = json["meshes"][0]["primitives"][0].clone();
        json["meshes"][0]["primitives"] = vec![primitive; 1000].into();
        json["nodes"] = vec![json!({"mesh": 0}); 2000].into();
        json["scenes"][0]["nodes"] = (0..2000).collect();
    });
    assert!(message(glb(many), "a.glb").contains("over and over"));
}

#[test]
fn buffers_beside_the_file_are_read_and_those_elsewhere_not() {
    let folder = std::env::temp_dir().join(format!("geom-io-gltf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let with = |uri: &str| {
        let (mut json, binary) = document(|_| ());
        json["buffers"][0]["uri"] = uri.into();
        std::fs::write(folder.join("the data.bin"), binary).unwrap();
        let path = folder.join("a.gltf");
        std::fs::write(&path, json.to_string()).unwrap();
        path
    };
    let path = with("the%20data.bin");
    assert_eq!(read(&path).unwrap().face_count(), 4);
    let text = std::fs::read(&path).unwrap();
    assert!(message(text, "a.gltf").contains("or the path of the .gltf"));
    for (uri, expected) in
        [("missing.bin", "there is no such file"), ("/etc/passwd", "beside"), ("http://a/b", "beside")]
    {
        let message = read(with(uri)).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
