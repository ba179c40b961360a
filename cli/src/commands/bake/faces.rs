//! The triangles of one surface in two files, face by face.

use crate::error::CommandError;
use geom::Model;
use std::collections::HashMap;
use std::path::Path;

/// Corners of the two files are at one place if they are no farther apart than this share of the surface's size: f32 rounds by a hundredth of it.
const NEAR: f64 = 1e-5;

/// A triangle of both: its face in the old file, and its corners in each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pair {
    pub(super) face: u32,
    pub(super) old: [u32; 3],
    pub(super) new: [u32; 3],
}

/// The triangles of a surface in its two files. Either both have the same polygons, or the new one has the triangles of the old one's in their order, or in that of a GLB, where
/// those of a material come together.
pub(super) fn pairs(old: (&Path, &Model), new: (&Path, &Model)) -> Result<Vec<Pair>, CommandError> {
    let (old_path, old) = old;
    let (new_path, new) = new;
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
    if ways.is_empty() {
        return Err(CommandError::BakeFaces {
            old: old_path.to_owned(),
            new: new_path.to_owned(),
            faces: [old.face_count(), new.face_count()],
            triangles: triangles.len(),
        });
    }
    let near = NEAR * size(old);
    let mut first = None;
    for pairs in ways {
        match farthest(old, new, &pairs).filter(|(_, distance)| *distance > near) {
            None => return Ok(pairs),
            Some(misfit) => first = first.or(Some(misfit)),
        }
    }
    let (face, distance) = first.unwrap_or_default();
    let share = distance / size(old);
    Err(CommandError::BakePlaces { old: old_path.to_owned(), new: new_path.to_owned(), face, share })
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

/// The first face of which a corner is farthest from where it should be, and how far.
fn farthest(old: &Model, new: &Model, pairs: &[Pair]) -> Option<(u32, f64)> {
    let at = |model: &Model, corner: u32| model.points()[model.corners()[corner as usize] as usize];
    let distance = |pair: &Pair| {
        let corners = pair.old.into_iter().zip(pair.new);
        corners.map(|(a, b)| length(at(old, a), at(new, b))).fold(0.0, f64::max)
    };
    let all = pairs.iter().map(|pair| (pair.face, distance(pair)));
    all.reduce(|most, next| if next.1 > most.1 { next } else { most })
}

fn length(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// The diagonal of the box about a surface.
fn size(model: &Model) -> f64 {
    let used = || model.corners().iter().map(|&v| model.points()[v as usize]);
    let bound = |start: f64, of: fn(f64, f64) -> f64| used().fold([start; 3], |b, p| [0, 1, 2].map(|k| of(b[k], p[k])));
    length(bound(f64::INFINITY, f64::min), bound(f64::NEG_INFINITY, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip(faces: &[&[u32]], shift: f64) -> Model {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]];
        Model::from_polygons(points.map(|[x, y]| [x + shift, y, 0.0]).to_vec(), faces).unwrap()
    }

    fn fit(old: &Model, new: &Model) -> Result<Vec<Pair>, String> {
        pairs((Path::new("a.obj"), old), (Path::new("b.obj"), new)).map_err(|error| error.to_string())
    }

    #[test]
    fn polygons_fit_polygons_and_their_triangles() {
        let quads = strip(&[&[0, 1, 2, 3], &[1, 4, 5, 2]], 0.0);
        let cut: Vec<[u32; 3]> = quads.triangles().vertices(&quads);
        let cut: Vec<&[u32]> = cut.iter().map(|t| &t[..]).collect();
        for new in [quads.clone(), strip(&cut, 0.0), strip(&cut, 1e-6)] {
            let pairs = fit(&quads, &new).unwrap();
            assert_eq!(pairs.iter().map(|pair| pair.face).collect::<Vec<_>>(), [0, 0, 1, 1]);
            for Pair { old, new: own, .. } in pairs {
                assert_eq!(old.map(|c| quads.corners()[c as usize]), own.map(|c| new.corners()[c as usize]));
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_said() {
        let quads = strip(&[&[0, 1, 2, 3], &[1, 4, 5, 2]], 0.0);
        let fewer = fit(&quads, &strip(&[&[0, 1, 2, 3]], 0.0)).unwrap_err();
        assert!(fewer.starts_with("b.obj has 1 face, and a.obj 2 (4 triangles)"), "{fewer}");
        let moved = fit(&quads, &strip(&[&[0, 1, 2, 3], &[1, 4, 5, 2]], 0.1)).unwrap_err();
        assert!(moved.contains("face 0 (counted from 0)") && moved.contains("4.47 %"), "{moved}");
        let turned = fit(&quads, &strip(&[&[1, 2, 3, 0], &[1, 4, 5, 2]], 0.0)).unwrap_err();
        assert!(turned.contains("face 0"), "{turned}");
    }
}
