//! A model with its polygons cut into triangles.

use super::obj;
use super::write_obj::{ObjContent, write_obj};
use crate::surface::{Attribute, AttributeDomain, Attributes, Model, ModelError, Triangles};

/// The model whose faces are the [triangles](Model::triangles) of another's, with the attributes of vertices, faces and corners.
/// An OBJ keeps its text, so far as it can be read back.
///
/// # Errors
/// If there are more corners than a model may have.
pub fn triangulated(model: &Model) -> Result<Model, ModelError> {
    let triangles = model.triangles();
    let corners: Vec<[u32; 3]> =
        triangles.corners.iter().map(|corners| corners.map(|c| model.corners()[c as usize])).collect();
    if let Some(model) = with_text(model, &triangles, &corners) {
        return Ok(model);
    }
    let plain = Model::from_triangles(model.points().to_vec(), &corners)?;
    Ok(plain.with_attributes(attributes(model, &triangles)))
}

fn with_text(model: &Model, triangles: &Triangles, corners: &[[u32; 3]]) -> Option<Model> {
    model.obj_text()?;
    let mut text = Vec::new();
    write_obj(model, &ObjContent { triangles: Some(triangles), ..ObjContent::default() }, &mut text).ok()?;
    let read = obj::read(text).ok()?;
    (read.points() == model.points() && read.corners() == corners.as_flattened()).then_some(read)
}

fn attributes(model: &Model, triangles: &Triangles) -> Attributes {
    let table = |table: &Attribute| match table.domain() {
        AttributeDomain::Vertices => table.clone(),
        AttributeDomain::Faces => table.picked(triangles.face_of.iter().map(|&f| f as usize)),
        AttributeDomain::Corners => {
            let row = |&c: &u32| table.row_at(model.corners(), c as usize).map_or(Attribute::NONE, |row| row as u32);
            table.clone().at_corners(triangles.corners.as_flattened().iter().map(row).collect())
        }
    };
    let known = model.attributes();
    let of_faces = |whole: &[u32]| triangles.face_of.iter().filter_map(|&f| whole.get(f as usize).copied()).collect();
    Attributes {
        tables: known.tables.iter().map(table).collect(),
        face_material: of_faces(&known.face_material),
        face_node: of_faces(&known.face_node),
        ..known.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::read_bytes;
    use crate::{Meaning, ScalarType};

    /// What a table of corners has at one.
    fn weight(model: &Model, corner: usize) -> f64 {
        let table = &model.attributes().tables[0];
        table.row(table.row_at(model.corners(), corner).unwrap()).next().unwrap()
    }

    #[test]
    fn groups_materials_and_normals_stay_with_their_faces() {
        let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0 # last\nvn 0 0 1\nvn 0 1 0\n\
                   g one\nusemtl red\nf 1//1 2//1 3//1 4//1\ng two\nusemtl blue\nf 2//1 5//2 3//1\n";
        let model = read_bytes(obj.into(), "a.obj").unwrap();
        let cut = triangulated(&model).unwrap();
        assert_eq!((cut.points(), cut.face_count()), (model.points(), 3));
        let text = String::from_utf8(cut.obj_text().unwrap().to_vec()).unwrap();
        let groups: Vec<&str> = text.lines().filter(|line| line.starts_with(['g', 'u', 'f'])).collect();
        let [one, red, first, second, two, blue, last] = groups[..] else { panic!("{text}") };
        assert_eq!([one, red, two, blue, last], ["g one", "usemtl red", "g two", "usemtl blue", "f 2//1 5//2 3//1"]);
        assert!(first.starts_with("f ") && second.starts_with("f ") && text.contains("# last"));

        let ply = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                   property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
                   property list uchar int vertex_indices\nproperty int part\nend_header\n\
                   0 0 0 1 2 3\n1 0 0 4 5 6\n1 1 0 7 8 9\n0 1 0 1 1 1\n2 0 0 2 2 2\n4 0 1 2 3 7\n3 1 4 2 8\n";
        let model = read_bytes(ply.into(), "a.ply").unwrap();
        let cut = triangulated(&model).unwrap();
        let part = cut.attributes().tables.iter().find(|table| table.domain() == AttributeDomain::Faces).unwrap();
        let parts: Vec<f64> = (0..part.rows()).flat_map(|row| part.row(row)).collect();
        assert_eq!(parts, [7.0, 7.0, 8.0]);
        let vertices = |model: &Model| {
            let tables = model.attributes().tables.iter();
            tables.filter(|table| table.domain() == AttributeDomain::Vertices).cloned().collect::<Vec<_>>()
        };
        assert_eq!(vertices(&cut), vertices(&model));
        assert_eq!(cut.corner_count(), 9);

        // Other corners' attributes than an OBJ's.
        let mut table = Attribute::new(Meaning::Other("weight".into()), AttributeDomain::Vertices, ScalarType::F64, 1);
        (0..7).for_each(|x| table.push(f64::from(x)));
        let given = Attributes {
            tables: vec![table.at_corners((0..7).rev().collect())],
            face_material: vec![1, 0],
            ..Attributes::default()
        };
        let model = model.with_attributes(given);
        let (cut, triangles) = (triangulated(&model).unwrap(), model.triangles());
        let weights: Vec<f64> = (0..9).map(|c| weight(&cut, c)).collect();
        let expected: Vec<f64> = triangles.corners.iter().flatten().map(|&c| weight(&model, c as usize)).collect();
        assert_eq!((weights, &cut.attributes().face_material), (expected, &vec![1, 1, 0]));
    }
}
