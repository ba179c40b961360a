//! The triangles of one surface in two files, face by face.

use super::tree::bounds;
use cones::uv::Triangle;
use geom::{Model, vector};
use std::collections::HashMap;

/// Corners of the two files are at one place if they are no farther apart than this share of the surface's size: f32 rounds by a hundredth of it.
pub(super) const NEAR: f64 = 1e-5;

/// A triangle in both maps: its face in the old file, and its images; none in the old map where that has no coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Image {
    pub(super) face: u32,
    pub(super) old: Option<Triangle>,
    pub(super) new: Triangle,
}

/// A triangle of both: its face in the old file, and its corners in each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pair {
    face: u32,
    old: [u32; 3],
    new: [u32; 3],
}

/// The images of the triangles of a surface that has the same ones in two files: the same polygons, or the new one the triangles of the old one's in their order, or in that of a
/// GLB, where those of a material come together.
pub(super) fn images(old: &Model, new: &Model, new_uv: &[[f64; 2]]) -> Option<Vec<Image>> {
    let image = |pair: Pair| {
        let corners = pair.old.map(|corner| old.uv()?.corner(corner as usize));
        let whole = if let [Some(a), Some(b), Some(c)] = corners { Some([a, b, c]) } else { None };
        Image { face: pair.face, old: whole, new: pair.new.map(|corner| new_uv[corner as usize]) }
    };
    Some(pairs(old, new)?.into_iter().map(image).collect())
}

fn pairs(old: &Model, new: &Model) -> Option<Vec<Pair>> {
    let triangles = old.triangles();
    let mut ways: Vec<Vec<Pair>> = Vec::new();
    let all = || triangles.face_of.iter().zip(&triangles.corners);
    if old.face_start() == new.face_start() {
        ways.push(all().map(|(&face, &corners)| Pair { face, old: corners, new: corners }).collect());
    }
    if new.face_count() == triangles.len() && new.corner_count() == 3 * triangles.len() {
        let own = |number: u32| [0, 1, 2].map(|k| 3 * number + k);
        if ways.is_empty() {
            ways.push((0..).zip(all()).map(|(n, (&face, &old))| Pair { face, old, new: own(n) }).collect());
        }
        let ordered = by_material(old, &triangles.face_of);
        if !ordered.is_sorted() {
            let pair =
                |(n, &t): (u32, &usize)| Pair { face: triangles.face_of[t], old: triangles.corners[t], new: own(n) };
            ways.push((0..).zip(&ordered).map(pair).collect());
        }
    }
    let near = NEAR * size(old);
    ways.into_iter().find(|pairs| pairs.iter().all(|pair| distance(old, new, pair) <= near))
}

/// The triangles in the order of the first ones with their materials.
fn by_material(model: &Model, face_of: &[u32]) -> Vec<usize> {
    let mut number = HashMap::new();
    let rank: Vec<usize> = face_of
        .iter()
        .map(|&face| {
            let next = number.len();
            *number.entry(model.attributes().material(face as usize)).or_insert(next)
        })
        .collect();
    let mut ordered: Vec<usize> = (0..face_of.len()).collect();
    ordered.sort_by_key(|&t| rank[t]);
    ordered
}

/// How far a corner is from where it should be, of the one that is farthest.
fn distance(old: &Model, new: &Model, pair: &Pair) -> f64 {
    let at = |model: &Model, corner: u32| model.points()[model.corners()[corner as usize] as usize];
    let corners = pair.old.into_iter().zip(pair.new);
    corners.map(|(a, b)| vector::distance(at(old, a), at(new, b))).fold(0.0, f64::max)
}

/// The diagonal of the box about a surface.
pub(super) fn size(model: &Model) -> f64 {
    let [low, high] = bounds(model.corners().iter().map(|&v| model.points()[v as usize]));
    vector::distance(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip(faces: &[&[u32]], shift: f64) -> Model {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]];
        Model::from_polygons(points.map(|[x, y]| [x + shift, y, 0.0]).to_vec(), faces).unwrap()
    }

    #[test]
    fn polygons_fit_polygons_and_their_triangles() {
        let quads = strip(&[&[0, 1, 2, 3], &[1, 4, 5, 2]], 0.0);
        let cut: Vec<[u32; 3]> = quads.triangles().vertices(&quads);
        let cut: Vec<&[u32]> = cut.iter().map(|t| &t[..]).collect();
        for new in [quads.clone(), strip(&cut, 0.0), strip(&cut, 1e-6)] {
            let pairs = pairs(&quads, &new).unwrap();
            assert_eq!(pairs.iter().map(|pair| pair.face).collect::<Vec<_>>(), [0, 0, 1, 1]);
            for Pair { old, new: own, .. } in pairs {
                assert_eq!(old.map(|c| quads.corners()[c as usize]), own.map(|c| new.corners()[c as usize]));
            }
        }
    }

    #[test]
    fn other_faces_other_places_and_another_order_do_not_fit() {
        let quads = strip(&[&[0, 1, 2, 3], &[1, 4, 5, 2]], 0.0);
        for (faces, shift) in [
            (&[&[0, 1, 2, 3][..]][..], 0.0),
            (&[&[0, 1, 2, 3], &[1, 4, 5, 2]], 0.1),
            (&[&[1, 2, 3, 0], &[1, 4, 5, 2]], 0.0),
        ] {
            assert_eq!(pairs(&quads, &strip(faces, shift)), None);
        }
    }
}
