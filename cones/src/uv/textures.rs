//! Maps of several textures, of which each has the plane to itself, as maps of one.

use std::collections::BTreeMap;

use geom::Model;

/// Textures are no farther apart than this, lest coordinates lose their digits.
const FARTHEST: f64 = (1_u64 << 24) as f64;

/// The map whose faces lie beside each other where they have not the same texture: each texture is moved by whole numbers, so that tiles stay tiles and nothing of one lies over
/// anything of another; all stay where they are if they reach too far for that. Faces beyond those whose textures are given have none. O(corners).
///
/// ```
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let square = geom::Model::from_triangles(points, &[[0, 1, 2], [2, 3, 0]])?;
/// let [a, b, c] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
/// let uv = cones::uv::textures_apart(&square, &[a, b, c, a, b, c], &[Some(7), Some(3)]);
/// assert_eq!(uv[..3], [[2.0, 0.0], [3.0, 0.0], [3.0, 1.0]]);
/// assert_eq!(uv[3..], [a, b, c]);
/// # Ok::<(), geom::ModelError>(())
/// ```
pub fn textures_apart(model: &Model, uv: &[[f64; 2]], of_face: &[Option<u32>]) -> Vec<[f64; 2]> {
    let texture = |face: usize| of_face.get(face).copied().flatten();
    let mut place: BTreeMap<Option<u32>, usize> = (0..model.face_count()).map(|face| (texture(face), 0)).collect();
    place.values_mut().zip(0..).for_each(|(place, number)| *place = number);
    let columns = (place.len() as f64).sqrt().ceil().max(1.0) as usize;
    let range = |k: usize| {
        let finite = uv.iter().map(|p| p[k]).filter(|x| x.is_finite());
        finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    // A tile between them, lest corners beyond a border by a rounding error meet.
    let step = [0, 1].map(|k| (range(k)[1].ceil() - range(k)[0].floor()).max(0.0) + 1.0);
    let mut apart = uv.to_vec();
    if !step.iter().all(|step| *step <= FARTHEST) {
        return apart;
    }
    for face in 0..model.face_count() {
        let number = place[&texture(face)];
        let shift = [(number % columns) as f64 * step[0], (number / columns) as f64 * step[1]];
        for corner in model.face_corners(face) {
            if let Some(p) = apart.get_mut(corner) {
                *p = [0, 1].map(|k| p[k] + shift[k]);
            }
        }
    }
    apart
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinate_that_is_out_of_all_bounds_moves_nothing() {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let square = Model::from_triangles(points, &[[0, 1, 2], [2, 3, 0]]).unwrap();
        let mut uv = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for far in [1e15, 1e308] {
            (uv[0][0], uv[1][0]) = (-far, far);
            assert_eq!(textures_apart(&square, &uv, &[Some(0), Some(1)]), uv);
        }
    }
}
