//! The text of an OBJ whose faces were cut into triangles: groups, materials and comments stay where they were.
//!
//! The lines of a face's triangles stand where the face's line stood. New vertices follow the last one, with colours or whatever else
//! stands behind a position made of the same vertices in the same shares; after them stand the triangles' normals, interpolated.

use std::io::Write;

use super::obj;
use super::obj::is_face;
use super::text::{Lines, number};
use crate::surface::{Attribute, Attributes, Meaning, Model, refine_attributes};

/// A model from an OBJ whose faces are cut into triangles, with its text. `added` says what new vertices are made of: vertices of the
/// model with weights; `triangles` are in the order of faces, `face` has the face of each. None where the model has no text, or
/// one that cannot be kept because it counts back from its end.
pub fn refine_obj(model: &Model, added: &[[(u32, f64); 3]], refined: &Model, face: &[u32]) -> Option<Model> {
    rewritten(model, added, refined, face, &refine_attributes(model, refined, added, face))
}

/// A model whose edges are [split](Model::with_edges_split), with the text of the OBJ that it came from, in which faces gain corners; without one where
/// the model has none, or one that cannot be kept. Texture coordinates of the file are then those of the model, not of the text.
pub fn with_split_edges(model: &Model, split: Model) -> Model {
    let faces: Vec<u32> = (0..model.face_count() as u32).collect();
    let Some(read) = rewritten(model, &[], &split, &faces, split.attributes()) else { return split };
    match split.whole_uv() {
        Some(uv) => read.with_texture(uv).unwrap_or(split),
        None => read,
    }
}

/// A model with the text of an OBJ, in which lines of faces are replaced, with normals as `attributes` have them.
fn rewritten(
    model: &Model,
    added: &[[(u32, f64); 3]],
    refined: &Model,
    face: &[u32],
    attributes: &Attributes,
) -> Option<Model> {
    let text = model.obj_text()?;
    let behind = behind_positions(text);
    let mut out = Vec::with_capacity(2 * text.len() + 64 * face.len());
    let last_vertex = last_vertex_line(text)?;
    let normals = attributes.table(&Meaning::Normal);
    let known_normals = normals_before(text, last_vertex);
    let (mut at, mut faces, mut next) = (0, 0, 0);
    let mut lines = Lines::joined(text);
    while let Some(line) = lines.next() {
        let end = lines.position();
        if line.words().next().is_some_and(is_face) {
            out.extend(&text[at..line.start]);
            while next < face.len() && face[next] == faces {
                out.push(b'f');
                for corner in refined.face_corners(next) {
                    write!(out, " {}", refined.corners()[corner] + 1).ok()?;
                    if let Some(row) = normals.and_then(|table| table.row_at(refined.corners(), corner)) {
                        write!(out, "//{}", known_normals + row + 1).ok()?;
                    }
                }
                out.push(b'\n');
                next += 1;
            }
            faces += 1;
            at = end;
        }
        if line.start == last_vertex {
            out.extend(&text[at..end]);
            at = end;
            if !out.ends_with(b"\n") && !out.ends_with(b"\r") {
                out.push(b'\n');
            }
            let known = model.vertex_count();
            for (parts, point) in added.iter().zip(&refined.points()[known..]) {
                let [x, y, z] = point;
                write!(out, "v {x:?} {y:?} {z:?}").ok()?;
                for k in 0..behind.as_ref().map_or(0, |(width, _)| *width) {
                    let value: f64 = parts.iter().map(|&(v, weight)| weight * behind_of(&behind, v, k)).sum();
                    write!(out, " {value}").ok()?;
                }
                out.push(b'\n');
            }
            normals.map_or(Some(()), |table| write_normals(table, &mut out))?;
        }
    }
    out.extend(&text[at..]);
    let read = obj::read(out).ok()?;
    (read.points() == refined.points() && read.corners() == refined.corners()).then_some(read)
}

fn write_normals(table: &Attribute, out: &mut Vec<u8>) -> Option<()> {
    for row in 0..table.rows() {
        out.extend(b"vn");
        table.row(row).try_for_each(|x| write!(out, " {:?}", x as f32)).ok()?;
        out.push(b'\n');
    }
    Some(())
}

/// How many normals are listed before a byte.
fn normals_before(text: &[u8], at: usize) -> usize {
    let lines = Lines::joined(text).take_while(|line| line.start < at);
    lines.filter(|line| line.words().next() == Some(b"vn")).count()
}

fn behind_of(behind: &Option<(usize, Vec<f64>)>, v: u32, k: usize) -> f64 {
    behind.as_ref().map_or(0.0, |(width, values)| values[v as usize * width + k])
}

/// How many numbers stand behind each position, and these; none where they are not as many everywhere.
fn behind_positions(text: &[u8]) -> Option<(usize, Vec<f64>)> {
    let mut all = Vec::new();
    let mut width = None;
    for line in Lines::joined(text) {
        let mut words = line.words();
        if words.next() != Some(b"v") {
            continue;
        }
        let values: Vec<f64> = words.skip(3).map_while(number).collect();
        if *width.get_or_insert(values.len()) != values.len() {
            return None;
        }
        all.extend(values);
    }
    width.map(|width| (width, all))
}

/// Where the line of the last vertex starts.
fn last_vertex_line(text: &[u8]) -> Option<usize> {
    let vertices = Lines::joined(text).filter(|line| line.words().next() == Some(b"v"));
    vertices.last().map(|line| line.start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_and_materials_stay_and_colours_are_mixed() {
        let text = "v 0 0 0 1 0 0\nv 2 0 0 0 1 0\nv 0 2 0 0 0 1\nv 2 2 0 1 1 1\n# a comment\nusemtl red\nf 1 2 3 # one\ng two\nf 2 4 3\n";
        let model = obj::read(text.into()).unwrap();
        let mut points = model.points().to_vec();
        points.push([1.0, 1.0, 0.0]);
        let triangles = [[0, 1, 4], [0, 4, 2], [1, 3, 4], [4, 3, 2]];
        let refined = Model::from_triangles(points, &triangles).unwrap();
        let read = refine_obj(&model, &[[(1, 0.5), (2, 0.5), (0, 0.0)]], &refined, &[0, 0, 1, 1]).unwrap();
        let text = String::from_utf8(read.obj_text().unwrap().to_vec()).unwrap();
        assert!(text.contains("v 1.0 1.0 0.0 0 0.5 0.5\n"));
        assert!(text.contains("usemtl red\nf 1 2 5\nf 1 5 3\ng two\nf 2 4 5\nf 5 4 3\n"), "{text}");
        assert_eq!(read.corners(), refined.corners());
    }

    #[test]
    fn names_that_are_no_utf8_stay_as_they_are() {
        let text = b"v 0 0 0\nv 2 0 0\nv 0 2 0\nusemtl mati\xe8re\nf 1 2 3\n".to_vec();
        let model = obj::read(text).unwrap();
        let mut points = model.points().to_vec();
        points.push([1.0, 0.0, 0.0]);
        let refined = Model::from_triangles(points, &[[0, 3, 2], [3, 1, 2]]).unwrap();
        let read = refine_obj(&model, &[[(0, 0.5), (1, 0.5), (2, 0.0)]], &refined, &[0, 0]).unwrap();
        assert!(read.obj_text().unwrap().windows(14).any(|bytes| bytes == b"usemtl mati\xe8re"));
    }

    #[test]
    fn normals_are_interpolated() {
        let text = "vn 9 9 9\nv 0 0 0\nv 2 0 0\nv 0 2 0\nvn 0 0 1\nvn 0 1 0\nf 1//2 2//3 3//2\n";
        let model = obj::read(text.into()).unwrap();
        let mut points = model.points().to_vec();
        points.push([1.0, 0.0, 0.0]);
        let refined = Model::from_triangles(points, &[[0, 3, 2], [3, 1, 2]]).unwrap();
        let read = refine_obj(&model, &[[(0, 0.5), (1, 0.5), (2, 0.0)]], &refined, &[0, 0]).unwrap();
        let table = read.attributes().table(&Meaning::Normal).unwrap();
        let normal = |corner| table.row(table.row_at(read.corners(), corner).unwrap()).collect::<Vec<_>>();
        let half = f64::from(0.5_f32.sqrt());
        assert_eq!((normal(0), normal(1)), (vec![0.0, 0.0, 1.0], vec![0.0, half, half]));
        assert_eq!(normal(4), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn a_model_without_a_text_has_none_to_keep() {
        let model = Model::from_triangles(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]).unwrap();
        assert!(refine_obj(&model, &[], &model, &[0]).is_none());
    }
}
