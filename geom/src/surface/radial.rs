//! The faces round an edge, paired by the solid between them.
//!
//! Where bodies touch along an edge, as two cubes of a voxel model do, it has four faces or more, an even number. Sorted by their angle about the edge,
//! as in a radial-edge structure, those that bound the same wedge of the solid are neighbours: each lies behind the other, and they run along the edge
//! in opposite directions. Glued in these pairs, the surface is that of bodies which touch and are not one (A. Guéziec, G. Taubin, F. Lazarus and
//! B. Horn, *Converting sets of polygons to manifold surfaces by cutting and stitching*, 1998; J. Rossignac and D. Cardoze, *Matchmaker: manifold
//! breps for non-manifold r-sets*, 1999).
//!
//! There is such a pairing only where directions alternate all the way round. Where they do not, where two faces are at the same angle, or where one has
//! no angle because it has no area, there is none: a wall with a fin, a doubled sheet, faces that are oriented at random. Normals are taken as the
//! file has them; where all of them point inwards, what is paired bounds the same wedge of empty space.

use std::f64::consts::TAU;

use crate::vector::{cross, dot, length, sub};

/// Faces that are nearer to each other than this, in radians, lie on each other: far above rounding in single precision, far below any wedge
/// that is meant.
const COINCIDENT: f64 = 1e-4;

/// An apex nearer to the line of its edge than this, as a share of its distance from the edge's start, is on that line.
const ON_THE_LINE: f64 = 1e-9;

/// A face at an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct RadialFace {
    /// The point where the face is seen from the edge: the third corner of its triangle.
    pub(super) apex: [f64; 3],
    /// Whether it runs along the edge from the edge's start to its end.
    pub(super) is_forward: bool,
}

/// Pairs the faces at an edge, given by its start and end, that bound the same wedge of the solid: numbers of faces, a backward one first. None if not
/// all can be paired; see the module's head. O(n log n).
pub(super) fn solid_pairs([start, end]: [[f64; 3]; 2], faces: &[RadialFace]) -> Option<Vec<[usize; 2]>> {
    if faces.is_empty() || !faces.len().is_multiple_of(2) {
        return None;
    }
    let order = in_order(unit(sub(end, start))?, start, faces)?;
    let count = order.len();
    let first = order.iter().position(|&f| !faces[f].is_forward)?;
    let at = |k: usize| order[(first + k) % count];
    let alternate = (0..count).all(|k| faces[at(k)].is_forward == (k % 2 == 1));
    // With the edge pointing at the eye, angles grow counter-clockwise, and so does the way from a backward face into the solid.
    alternate.then(|| (0..count).step_by(2).map(|k| [at(k), at(k + 1)]).collect())
}

/// The faces by ascending angle about an axis of length 1; none if two are at the same angle or one has none.
fn in_order(axis: [f64; 3], start: [f64; 3], faces: &[RadialFace]) -> Option<Vec<usize>> {
    let away = |face: &RadialFace| {
        let to = unit(sub(face.apex, start))?;
        let along = dot(to, axis);
        let across: [f64; 3] = std::array::from_fn(|k| to[k] - along * axis[k]);
        if length(across) > ON_THE_LINE { unit(across) } else { None }
    };
    let directions: Vec<[f64; 3]> = faces.iter().map(away).collect::<Option<_>>()?;
    let right = *directions.first()?;
    let up = cross(axis, right);
    let angle = |d: &[f64; 3]| dot(*d, up).atan2(dot(*d, right));
    let mut order: Vec<(f64, usize)> = directions.iter().map(angle).zip(0..).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let turned_on = order.iter().skip(1).map(|&(angle, _)| angle).chain([order[0].0 + TAU]);
    let is_apart = order.iter().zip(turned_on).all(|(&(angle, _), next)| next - angle > COINCIDENT);
    is_apart.then(|| order.into_iter().map(|(_, face)| face).collect())
}

/// A vector at length 1, whatever its length was; none of length 0.
fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let size = vector.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    if size <= 0.0 {
        return None;
    }
    let scaled = vector.map(|x| x / size);
    let length = length(scaled);
    Some(scaled.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGE: [[f64; 3]; 2] = [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]];

    /// Faces at angles about the z axis, in degrees, negative for those that run backwards.
    fn faces(angles: &[f64]) -> Vec<RadialFace> {
        let face = |&angle: &f64| {
            let (sin, cos) = angle.abs().to_radians().sin_cos();
            RadialFace { apex: [3.0 * cos, 3.0 * sin, 0.5], is_forward: angle > 0.0 }
        };
        angles.iter().map(face).collect()
    }

    /// The pairs in order.
    fn pairs(edge: [[f64; 3]; 2], faces: &[RadialFace]) -> Option<Vec<[usize; 2]>> {
        let mut pairs = solid_pairs(edge, faces)?;
        pairs.sort_unstable();
        Some(pairs)
    }

    #[test]
    fn neighbours_round_an_edge_bound_a_wedge_of_the_solid() {
        // Two cubes: from 0 to 90 and from 180 to 270 degrees.
        assert_eq!(pairs(EDGE, &faces(&[90.0, -180.0, 270.0, -360.0])), Some(vec![[1, 2], [3, 0]]));
        // The space between them as the solid.
        assert_eq!(pairs(EDGE, &faces(&[-90.0, 180.0, -270.0, 360.0])), Some(vec![[0, 1], [2, 3]]));
        let six = faces(&[-10.0, 50.0, -130.0, 170.0, -250.0, 290.0]);
        assert_eq!(pairs(EDGE, &six), Some(vec![[0, 1], [2, 3], [4, 5]]));
    }

    #[test]
    fn the_size_of_the_model_does_not_matter() {
        for scale in [1e-160, 1e-30, 1e30, 1e150] {
            let scaled = |p: [f64; 3]| p.map(|x| scale * x);
            let faces: Vec<RadialFace> = faces(&[90.0, -180.0, 270.0, -360.0])
                .into_iter()
                .map(|face| RadialFace { apex: scaled(face.apex), ..face })
                .collect();
            assert_eq!(pairs(EDGE.map(scaled), &faces), Some(vec![[1, 2], [3, 0]]), "{scale}");
        }
    }

    #[test]
    fn what_does_not_alternate_coincides_or_has_no_area_is_not_paired() {
        for angles in [
            &[][..],
            &[90.0, -180.0, 270.0],
            &[90.0, 180.0, -270.0, -360.0],
            &[90.0, 180.0, 270.0, 360.0],
            &[90.0, -180.0, 180.0, -360.0],
            &[180.0, -180.0, 90.0, -90.0],
        ] {
            assert_eq!(solid_pairs(EDGE, &faces(angles)), None, "{angles:?}");
        }
        let mut flat = faces(&[90.0, -180.0, 270.0, -360.0]);
        flat[2].apex = [0.0, 0.0, 5.0];
        assert_eq!(solid_pairs(EDGE, &flat), None);
        assert_eq!(solid_pairs([EDGE[0]; 2], &faces(&[90.0, -180.0, 270.0, -360.0])), None);
    }
}
