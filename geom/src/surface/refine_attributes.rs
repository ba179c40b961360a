//! Attributes of a surface that was cut finer.

use super::attributes::{Attribute, AttributeDomain, Attributes};
use super::model::Model;

/// The attributes of a model whose faces were cut into triangles. `added` says what new vertices are made of, vertices of
/// the model with weights, and `face` which face each triangle is part of. Floats and colours are interpolated, normals
/// made of length 1, other integers and lists taken from the vertex of the largest weight.
///
/// # Panics
/// If the triangles name faces or vertices that the model does not have.
pub fn refine_attributes(model: &Model, refined: &Model, added: &[[(u32, f64); 3]], face: &[u32]) -> Attributes {
    let attributes = model.attributes();
    let parts_of = |vertex: u32| match (vertex as usize).checked_sub(model.vertex_count()) {
        Some(new) => added.get(new).copied().unwrap_or_default(),
        None => [(vertex, 1.0), (vertex, 0.0), (vertex, 0.0)],
    };
    let table = |table: &Attribute| match table.domain() {
        AttributeDomain::Faces => table.picked(face.iter().map(|&f| f as usize)),
        AttributeDomain::Vertices => {
            let mut mixed = table.picked(0..model.vertex_count());
            (model.vertex_count() as u32..refined.vertex_count() as u32)
                .for_each(|vertex| mixed.mix(table, &parts_of(vertex).map(|(v, weight)| (v as usize, weight))));
            mixed
        }
        AttributeDomain::Corners => at_corners(table, model, refined, parts_of, face),
    };
    let of_faces = |whole: &[u32]| -> Vec<u32> {
        let of_face = |&f: &u32| whole.get(f as usize).copied().unwrap_or(Attribute::NONE);
        if whole.is_empty() { Vec::new() } else { face.iter().map(of_face).collect() }
    };
    Attributes {
        tables: attributes.tables.iter().map(table).collect(),
        face_material: of_faces(&attributes.face_material),
        face_node: of_faces(&attributes.face_node),
        nodes: attributes.nodes.clone(),
        materials: attributes.materials.clone(),
        looks: attributes.looks.clone(),
        pictures: attributes.pictures.clone(),
        images: attributes.images.clone(),
        other_maps: attributes.other_maps.clone(),
        libraries: attributes.libraries.clone(),
        comments: attributes.comments.clone(),
        listings: attributes.listings.clone(),
        left: attributes.left.clone(),
    }
}

/// A table of corners, of the triangles' ones; each has a row of its own.
fn at_corners(
    table: &Attribute,
    model: &Model,
    refined: &Model,
    parts_of: impl Fn(u32) -> [(u32, f64); 3],
    face: &[u32],
) -> Attribute {
    let mut mixed = table.picked(std::iter::empty());
    let mut index = Vec::with_capacity(refined.corner_count());
    for (triangle, &face) in face.iter().enumerate() {
        for &vertex in refined.face(triangle) {
            let parts = parts_of(vertex).into_iter().filter(|part| part.1 != 0.0);
            let known: Vec<(usize, f64)> =
                parts.filter_map(|(v, weight)| Some((row_in(table, model, face, v)?, weight))).collect();
            index.push(if known.is_empty() { Attribute::NONE } else { mixed.rows() as u32 });
            if !known.is_empty() {
                mixed.mix(table, &known);
            }
        }
    }
    mixed.at_corners(index)
}

/// The row that a vertex has in a face.
fn row_in(table: &Attribute, model: &Model, face: u32, vertex: u32) -> Option<usize> {
    let mut corners = model.face_corners(face as usize);
    let corner = corners.find(|&corner| model.corners()[corner] == vertex)?;
    table.row_at(model.corners(), corner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Meaning, ScalarType};

    fn square() -> Model {
        let points = vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        Model::from_polygons(points, [[0, 1, 2, 3]]).unwrap()
    }

    fn table(meaning: Meaning, domain: AttributeDomain, scalar: ScalarType, width: usize, values: &[f64]) -> Attribute {
        let mut table = Attribute::new(meaning, domain, scalar, width);
        values.iter().for_each(|&x| table.push(x));
        table
    }

    #[test]
    fn a_vertex_that_is_put_in_has_the_mean_of_colours_and_a_label_of_its_nearest() {
        let model = square();
        let mut points = model.points().to_vec();
        points.push([0.5, 0.5, 0.0]);
        let triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let refined = Model::from_triangles(points, &triangles).unwrap();
        let colour = table(Meaning::Colour, AttributeDomain::Vertices, ScalarType::U8, 1, &[200.0, 0.0, 100.0, 0.0]);
        let label =
            table(Meaning::Other("label".into()), AttributeDomain::Vertices, ScalarType::I32, 1, &[7.0, 0.0, 1.0, 0.0]);
        let face = table(Meaning::Other("part".into()), AttributeDomain::Faces, ScalarType::I32, 1, &[5.0]);
        let normals = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
        let normal = table(Meaning::Normal, AttributeDomain::Vertices, ScalarType::F64, 3, &normals)
            .at_corners(vec![0, 0, 1, 0]);
        let tables = vec![colour, label, face, normal];
        let model = model.with_attributes(Attributes {
            tables,
            face_material: vec![0],
            face_node: vec![7],
            ..Attributes::default()
        });
        let mixed = refine_attributes(&model, &refined, &[[(0, 0.75), (2, 0.25), (1, 0.0)]], &[0; 4]);
        let last = |k: usize| mixed.tables[k].row(mixed.tables[k].rows() - 1).collect::<Vec<_>>();
        assert_eq!((last(0), last(1), last(2)), (vec![175.0], vec![7.0], vec![5.0]));
        assert_eq!((mixed.tables[2].rows(), mixed.face_material.len(), &mixed.face_node[..]), (4, 4, &[7; 4][..]));
        let length: f64 = last(3).iter().map(|x| x * x).sum();
        assert!((length - 1.0).abs() < 1e-12 && (last(3)[2] / last(3)[0] - 3.0).abs() < 1e-12);
    }
}
