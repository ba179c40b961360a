//! Normals, colours, materials and whatever else there is, from format to format.

use super::*;
use crate::surface::{Attribute, AttributeDomain, Meaning, ScalarType, TextureCoordinates};

const PLY: &str = "ply
format ascii 1.0
comment made by hand
obj_info 3
element vertex 5
property float x
property float y
property float z
property float nx
property float ny
property float nz
property uchar red
property uchar green
property uchar blue
property uchar alpha
property short flag
property double quality
property list uchar int near
element face 2
property list uchar int vertex_indices
property int label
property uchar red
property uchar green
property uchar blue
element edge 1
property int vertex1
property int vertex2
end_header
0 0 0 0 0 1 255 0 0 255 -3 0.1 2 1 2
1 0 0 0 0 1 0 255 0 255 4 0.2 0
1 1 0 0 0 1 0 0 255 255 5 0.3 1 0
0 1 0 0 0 1 9 8 7 6 6 0.4 0
5 5 5 1 0 0 1 2 3 4 7 0.5 0
3 0 1 2 7 1 2 3
3 0 2 3 8 4 5 6
0 2
";

fn written(model: &Model, uv: Option<&[[f64; 2]]>, format: MeshFormat) -> Model {
    let mut out = Vec::new();
    match format {
        MeshFormat::Obj => write_obj(model, &ObjContent { uv, ..ObjContent::default() }, &mut out).unwrap(),
        MeshFormat::Ply => write_ply(model, uv, None, &mut out).unwrap(),
        MeshFormat::Glb => write_glb(model, uv, &model.triangles(), None, &mut out).unwrap(),
    }
    read_bytes(out, format!("back.{}", format.extension())).unwrap()
}

/// What a table says at each corner.
fn at_corners(model: &Model, meaning: Meaning) -> Vec<Option<Vec<f64>>> {
    let table = model.attributes().table(&meaning).unwrap_or_else(|| panic!("no {meaning}"));
    let one = if meaning == Meaning::Colour { table.scalar().one() } else { 1.0 };
    let row = |corner| Some(table.row(table.row_at(model.corners(), corner)?).map(|x| x / one).collect());
    (0..model.corner_count()).map(row).collect()
}

#[track_caller]
fn assert_near(a: &Model, b: &Model, meaning: Meaning, tolerance: f64) {
    for (corner, (a, b)) in at_corners(a, meaning.clone()).into_iter().zip(at_corners(b, meaning)).enumerate() {
        let (a, b) = (a.unwrap_or_default(), b.unwrap_or_default());
        let near = a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= tolerance);
        assert!(near && a.len().min(3) == b.len().min(3), "corner {corner}: {a:?} {b:?}");
    }
}

#[test]
fn a_ply_names_the_texture_of_its_own_map_alone() {
    let text = PLY.replace("comment made by hand", "comment TextureFile skin.png\ncomment made by hand");
    let model = read_bytes(text.into(), "a.ply").unwrap();
    let own: Vec<[f64; 2]> = model.corners().iter().map(|&v| [f64::from(v), 0.5]).collect();
    let of = |model: &Model, uv| written(model, uv, MeshFormat::Ply).attributes().comments.clone();
    let without = ["comment made by hand", "obj_info 3"];
    assert_eq!(of(&model, Some(&own)), without, "a map where there was none");
    let mapped = model.clone().with_uv(Some(TextureCoordinates::new(own.clone(), (0..own.len() as u32).collect())));
    assert_eq!(of(&mapped, None).len(), 3);
    assert_eq!(of(&mapped, Some(&own)).len(), 3);
    assert_eq!(of(&mapped, Some(&some_uv(&model))), without);
}

#[test]
fn a_ply_comes_back_with_everything_split_along_the_seams_or_not() {
    let model = read_bytes(PLY.into(), "a.ply").unwrap();
    let attributes = model.attributes();
    assert_eq!(attributes.comments, ["comment made by hand", "obj_info 3"]);
    assert_eq!((attributes.tables.len(), attributes.listings.len()), (7, 1));
    let whole: Vec<_> = model.corners().iter().map(|&v| [f64::from(v), 0.5]).collect();
    for uv in [None, Some(whole.as_slice()), Some(&some_uv(&model))] {
        let back = written(&model, uv, MeshFormat::Ply);
        assert_same_surface(&back, &model);
        assert_eq!(back.attributes(), attributes);
    }
    assert_eq!(not_kept(&model, MeshFormat::Ply), None);
}

#[test]
fn copies_along_seams_follow_the_vertices_and_name_them() {
    let model = read_bytes(PLY.into(), "a.ply").unwrap();
    let mut out = Vec::new();
    write_ply(&model, Some(&some_uv(&model)), None, &mut out).unwrap();
    let text = String::from_utf8_lossy(&out).into_owned();
    assert!(
        text.contains("element vertex 7\n")
            && text.contains("property float s\nproperty float t\nproperty uint source_vertex\n")
    );
    // A file that lies about its copies is taken as it stands.
    let at = text.find("source_vertex").unwrap();
    out[at] = b'S';
    assert_eq!(read_bytes(out, "a.ply").unwrap().vertex_count(), 7);
    let lie = PLY.replace("property short flag", "property short source_vertex");
    assert_eq!(read_bytes(lie.into(), "a.ply").unwrap().vertex_count(), 5);
}

#[test]
fn normals_colours_and_materials_go_from_format_to_format() {
    let text = "v 0 0 0 1 0.5 0\nv 1 0 0 0.25 0 1\nv 1 1 0 0 0 0\nv 0 1 0 1 1 1\nvn 0 0 1\nvn 0.6 0 0.8\n\
                g left\nusemtl red brick\nf 1//1 2//2 3//1\nusemtl b\nf 1//2 3//1 4//1\n";
    let model = obj(text);
    let materials = |model: &Model| [0, 1].map(|f| model.attributes().material(f).map(str::to_owned));
    let uv = some_uv(&model);
    for first in MeshFormat::ALL {
        let there = written(&model, Some(&uv), first);
        for second in MeshFormat::ALL {
            let back = written(&there, Some(&uv), second);
            assert_eq!(back.face_count(), 2, "{first} {second}");
            assert_near(&model, &back, Meaning::Normal, 1e-6);
            let bits = if first == MeshFormat::Ply || second == MeshFormat::Ply { 0.5 / 255.0 } else { 3e-5 };
            assert_near(&model, &back, Meaning::Colour, bits);
            let is_held = first != MeshFormat::Ply && second != MeshFormat::Ply;
            let names = materials(&back).map(|name| name.map(|name| name.replace('_', " ")));
            assert_eq!(names, if is_held { [Some("red brick".into()), Some("b".into())] } else { [None, None] });
        }
    }
    assert_eq!(not_kept(&model, MeshFormat::Obj), None);
    let words = |format| not_kept(&model, format).unwrap().what.join("; ");
    assert_eq!(
        (words(MeshFormat::Glb), words(MeshFormat::Ply)),
        ("groups".into(), "groups; materials (red brick, b)".into())
    );
}

#[test]
fn what_a_format_does_not_hold_is_named() {
    let model = read_bytes(PLY.into(), "a.ply").unwrap();
    let words = |format| not_kept(&model, format).unwrap().to_string();
    assert_eq!(words(MeshFormat::Glb), "not kept in GLB: near, colours of faces, label of faces, elements `edge`");
    assert_eq!(
        words(MeshFormat::Obj),
        "not kept in OBJ: flag, quality, near, colours of faces, label of faces, elements `edge`"
    );
    let back = written(&model, Some(&some_uv(&model)), MeshFormat::Glb);
    assert_near(&model, &back, Meaning::Other("quality".into()), 1e-7);
    // A step of sixteen bits of light is 2e-4 of sRGB where it is dark.
    assert_near(&model, &back, Meaning::Colour, 1e-4);
}

#[test]
fn colours_that_are_floats_stay_floats_in_ply() {
    let floats = PLY.replacen("uchar red", "float red", 1).replacen("uchar green", "float green", 1);
    let model = read_bytes(floats.into(), "a.ply").unwrap();
    let table = model.attributes().table(&Meaning::Colour).map(Attribute::scalar);
    assert_eq!(table, Some(ScalarType::F64), "columns of two types are shares");
    let all = PLY.replacen("uchar red", "float red", 1).replacen("uchar green", "float green", 1);
    let all = all.replacen("uchar blue", "float blue", 1).replacen("uchar alpha", "float alpha", 1);
    let back = written(&read_bytes(all.into(), "a.ply").unwrap(), None, MeshFormat::Ply);
    let table = back.attributes().table(&Meaning::Colour).unwrap();
    assert_eq!((table.scalar(), table.domain()), (ScalarType::F32, AttributeDomain::Vertices));
}

#[test]
fn no_two_properties_of_a_ply_have_one_name() {
    let mut model = obj(TETRAHEDRON);
    let table = |name: &str| {
        let mut table = Attribute::new(Meaning::Other(name.into()), AttributeDomain::Vertices, ScalarType::U8, 1);
        (0..4).for_each(|v| table.push(f64::from(v)));
        table
    };
    let tables = ["x", "s", "my name", "my\nname", ""].map(table).to_vec();
    model = model.with_attributes(crate::Attributes { tables, ..Default::default() });
    let back = written(&model, Some(&some_uv(&model)), MeshFormat::Ply);
    assert_same_surface(&back, &model);
    let names: Vec<String> = back.attributes().tables.iter().map(|table| table.meaning().to_string()).collect();
    assert_eq!(names, ["x_", "s_", "my_name", "my_name_", "unnamed"]);
}

const TEXTURED: &str = "# by hand\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\ng left\nf 1/1/1 2/2/1 3/3/1\nf 1/1 3/3 4\n";

#[test]
fn texture_coordinates_that_an_obj_is_given_are_written_with_its_text() {
    let model = obj(TEXTURED);
    let uv = some_uv(&model);
    let bytes = |model: &Model, uv| {
        let mut out = Vec::new();
        write_obj(model, &ObjContent { uv, ..ObjContent::default() }, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    };
    let given = model.clone().with_texture(uv.clone()).unwrap();
    assert_eq!(bytes(&given, None), bytes(&model, Some(&uv)));
    assert_eq!(bytes(&model, None), TEXTURED);
    // A corner that is given nothing has nothing.
    let mut partly = uv.clone();
    partly[0][1] = f64::NAN;
    let text = bytes(&model.with_texture(partly).unwrap(), None);
    assert!(text.starts_with("# by hand\n") && text.contains("\nf 1//1 2/1/1 3/2/1\n"), "{text}");
    let back = obj(&text);
    let found: Vec<_> = (0..6).map(|corner| back.uv().unwrap().corner(corner)).collect();
    assert_eq!((found[0], &found[1..]), (None, &uv[1..].iter().copied().map(Some).collect::<Vec<_>>()[..]));
}

#[test]
fn attributes_that_an_obj_is_given_are_written_and_its_map_stays() {
    let model = obj(TEXTURED);
    let mut table = Attribute::new(Meaning::Colour, AttributeDomain::Vertices, ScalarType::U8, 3);
    (0..12).for_each(|x| table.push(f64::from(20 * x)));
    let mut attributes = model.attributes().clone();
    attributes.tables.push(table);
    let given = model.clone().with_attributes(attributes);
    let back = written(&given, None, MeshFormat::Obj);
    assert_near(&given, &back, Meaning::Colour, 1e-5);
    assert_near(&given, &back, Meaning::Normal, 0.0);
    let map = |model: &Model| (0..6).map(|corner| model.uv().unwrap().corner(corner)).collect::<Vec<_>>();
    assert_eq!(map(&back), map(&model));
    assert_eq!(not_kept(&given, MeshFormat::Obj).unwrap().to_string(), "not kept in OBJ: groups");
    let bare = written(&model.with_attributes(crate::Attributes::default()), None, MeshFormat::Obj);
    assert!(bare.attributes().is_bare());
}

#[test]
fn attributes_of_a_mesh_in_memory_go_through_files() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let bare = Model::from_triangles(points, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let [up, aside] = [[0.0, 0.0, 1.0], [0.0, 0.6, 0.8]];
    let normals =
        Attribute::of_corners(Meaning::Normal, ScalarType::F32, &[up, aside], vec![0, 0, 0, 1, 1, 1]).unwrap();
    let colours: Vec<_> = (0..4).map(|v| [51.0 * f64::from(v), 255.0, 0.0, 102.0]).collect();
    let colours = Attribute::of_vertices(Meaning::Colour, ScalarType::U8, &colours).unwrap();
    let label = Meaning::Other("label".into());
    let labels = Attribute::of_faces(label.clone(), ScalarType::I32, &[[7.0], [-8.0]]).unwrap();
    let tables = [normals, colours, labels];
    let model = tables.into_iter().try_fold(bare.clone(), Model::with_attribute).unwrap();
    for format in MeshFormat::ALL {
        let back = written(&model, None, format);
        assert_near(&model, &back, Meaning::Normal, 1e-6);
        assert_near(&model, &back, Meaning::Colour, 1e-4);
    }
    let back = written(&model, None, MeshFormat::Ply);
    let label = back.attributes().tables.iter().find(|table| *table.meaning() == label).unwrap();
    assert_eq!((label.row(0).next(), label.row(1).next(), label.scalar()), (Some(7.0), Some(-8.0), ScalarType::I32));

    // Another table of colours takes the place of the first.
    let grey = Attribute::of_vertices(Meaning::Colour, ScalarType::F32, &[[0.5; 3]; 4]).unwrap();
    let model = model.with_attribute(grey.clone()).unwrap();
    assert_eq!((model.attributes().tables.len(), model.attributes().table(&Meaning::Colour)), (3, Some(&grey)));

    let refused = |table: Result<Attribute, crate::AttributeError>| {
        table.and_then(|table| bare.clone().with_attribute(table)).unwrap_err().to_string()
    };
    let of = |rows: &[[f64; 3]]| Attribute::of_vertices(Meaning::Normal, ScalarType::F32, rows);
    assert_eq!(refused(of(&[up; 3])), "normals have a row for each of the model's vertices: 3 where 4 should be");
    assert_eq!(
        refused(of(&[up, [0.0, f64::NAN, 1.0]])),
        "row 1 of normals (counted from 0) has a number that is not finite"
    );
    let few = Attribute::of_corners(Meaning::Normal, ScalarType::F32, &[up], vec![0; 5]);
    assert_eq!(refused(few), "normals have a row for each of the model's corners of faces: 5 where 6 should be");
    let narrow = refused(Attribute::of_vertices(Meaning::Colour, ScalarType::U8, &[[0.0; 2]; 4]));
    assert!(narrow.starts_with("colours cannot be rows of 2 numbers"), "{narrow}");
}

#[test]
fn the_map_of_a_model_is_written_where_no_other_is_given() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let bare = Model::from_triangles(points, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let narrow = |uv: &[[f64; 2]]| uv.iter().map(|point| point.map(|x| x as f32)).collect::<Vec<_>>();
    let uv = some_uv(&bare);
    let model = bare.clone().with_texture(uv.clone()).unwrap();
    let other: Vec<_> = uv.iter().map(|[u, v]| [*v, *u]).collect();
    for format in MeshFormat::ALL {
        assert!(written(&bare, None, format).uv().is_none());
        for (given, expected) in [(None, &uv), (Some(other.as_slice()), &other)] {
            let back = written(&model, given, format).uv().unwrap().all().unwrap();
            let near = |(a, b): (&[f32; 2], &[f32; 2])| (0..2).all(|k| (a[k] - b[k]).abs() <= 1e-6);
            assert!(narrow(&back).iter().zip(&narrow(expected)).all(near), "{format}: {back:?}");
        }
    }
    // What is not one of all corners, only an OBJ holds.
    let mut partly = uv;
    partly[4][0] = f64::NAN;
    let partly = bare.with_texture(partly).unwrap();
    let corners = |model: &Model| (0..6).map(|c| model.uv()?.corner(c)).collect::<Vec<_>>();
    assert_eq!(corners(&written(&partly, None, MeshFormat::Obj)), corners(&partly));
    for format in [MeshFormat::Ply, MeshFormat::Glb] {
        assert!(written(&partly, None, format).uv().is_none());
    }
}
