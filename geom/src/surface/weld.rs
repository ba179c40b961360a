//! Which vertices of a model are taken for one.
//!
//! Many files have a vertex several times where its faces differ in normals or texture coordinates, up to one for each corner of a
//! triangle: as they are numbered, their surfaces fall apart.

use std::collections::HashMap;

use petgraph::unionfind::UnionFind;

use super::model::{Model, place_key};
use crate::vector::{length, sub};

/// Which vertices of a model are taken for one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Weld {
    /// Those at the ends of two sides of the boundary that are at exactly the same place, if no third one is there: so the surface is closed
    /// where it meets itself, and nothing that was a surface before is one no longer. What lies on top of a copy of itself stays apart, and so
    /// do bodies that touch each other; slits and the mouths of pockets that are short for their surface stay open, as scans have them.
    #[default]
    Auto,
    /// None.
    Never,
    /// All that are at exactly the same place.
    Always,
}

impl Weld {
    /// For each vertex of a model the one that it is taken for, the first of its kind; none if each is taken for itself. O(F).
    pub fn of(self, model: &Model) -> Option<Vec<u32>> {
        let place = match self {
            Self::Never => return None,
            Self::Always => model.first_at_place(),
            Self::Auto => return super::prepare::stitches_of(model),
        };
        (0..).zip(&place).any(|(v, &place)| v != place).then_some(place)
    }

    /// Gives triangles of a model the vertices that theirs are taken for. O(F).
    pub fn apply(self, model: &Model, triangles: &mut [[u32; 3]]) {
        if let Some(place) = self.of(model) {
            triangles.iter_mut().flatten().for_each(|v| *v = place[*v as usize]);
        }
    }
}

/// A run that is joined is at least this times the root of the area of the largest part that it is of: slits of scans are shorter (.03 on the dragon),
/// seams and creases longer (1 and more on robot parts).
const LONG_ENOUGH: f64 = 0.3;
/// Or, where the smallest of its parts has at least this share of the area of the largest, that times the root of the smallest: the mouths of pockets of scans
/// are of less (4e-7 at most on the dragon, which no cones flatten with its pockets joined).
const POCKET: f64 = 1e-5;

/// A side of a triangle on the boundary.
#[derive(Clone, Copy)]
pub(super) struct BoundarySide {
    /// The vertices of the triangle, first those that the side is between.
    pub(super) triangle: [u32; 3],
    /// The connected part that it is of.
    pub(super) part: u32,
}

/// For each vertex the first of those that sides of the boundary at the same place join; none if there are none such. `area` is that of each part of
/// the surface, once points are multiplied by `scale`.
pub(super) fn stitches(
    (points, scale): (&[[f64; 3]], f64),
    sides: impl Iterator<Item = BoundarySide>,
    area: &[f64],
) -> Option<Vec<u32>> {
    let key = |v: u32| place_key(&points[v as usize]);
    let mut number = HashMap::new();
    let mut at_place: Vec<([u32; 2], BoundarySide)> = Vec::new();
    for side in sides {
        let [a, b, c] = side.triangle.map(key);
        // What has no area would be a third one between two that meet.
        if a == b || b == c || c == a {
            continue;
        }
        let mut place = [a, b].map(|key| {
            let next = number.len() as u32;
            *number.entry(key).or_insert(next)
        });
        place.sort_unstable();
        at_place.push((place, side));
    }
    at_place.sort_by_key(|&(place, _)| place);
    let places = |side: &BoundarySide| {
        let mut places = side.triangle.map(key);
        places.sort_unstable();
        places
    };
    let pairs: Vec<([u32; 2], [BoundarySide; 2])> = at_place
        .chunk_by(|a, b| a.0 == b.0)
        .filter_map(|at_one| match *at_one {
            [(place, one), (_, other)] if places(&one) != places(&other) => Some((place, [one, other])),
            _ => None,
        })
        .collect();
    // Runs of such sides, their lengths and the areas of the smallest and the largest part that they are of.
    let mut runs = UnionFind::<u32>::new(number.len());
    pairs.iter().for_each(|&([a, b], _)| {
        runs.union(a, b);
    });
    let mut run = vec![(0.0, [f64::INFINITY, 0.0]); number.len()];
    for (place, pair) in &pairs {
        let [a, b] = [0, 1].map(|k| points[pair[0].triangle[k] as usize].map(|x| x * scale));
        let (long, of) = &mut run[runs.find_mut(place[0]) as usize];
        *long += length(sub(b, a));
        for side in pair {
            let area = area[side.part as usize];
            *of = [area.min(of[0]), area.max(of[1])];
        }
    }
    let mut joined = UnionFind::<u32>::new(points.len());
    let mut is_any = false;
    for (place, [one, other]) in pairs {
        let (long, [least, most]) = run[runs.find_mut(place[0]) as usize];
        let of = if least < POCKET * most { most } else { least };
        if long < LONG_ENOUGH * f64::sqrt(of) {
            continue;
        }
        let ([a, b, _], [mut c, mut d, _]) = (one.triangle, other.triangle);
        if key(a) != key(c) {
            std::mem::swap(&mut c, &mut d);
        }
        is_any |= joined.union(a, c) | joined.union(b, d);
    }
    is_any.then(|| {
        let mut first = vec![u32::MAX; points.len()];
        (0..points.len() as u32)
            .map(|v| {
                let first = &mut first[joined.find_mut(v) as usize];
                *first = v.min(*first);
                *first
            })
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use crate::surface::{Prepared, RepairKind, prepare};

    fn model(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Model {
        Model::from_triangles(points.to_vec(), faces).unwrap()
    }

    /// Each triangle with vertices of its own.
    fn soup(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Model {
        let points: Vec<[f64; 3]> = faces.as_flattened().iter().map(|&v| points[v as usize]).collect();
        let faces: Vec<[u32; 3]> = (0..faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        model(&points, &faces)
    }

    fn euler(prepared: &Prepared) -> Vec<i64> {
        prepared.surfaces.iter().map(|surface| surface.mesh.euler_characteristic()).collect()
    }

    fn kinds(prepared: &Prepared) -> Vec<RepairKind> {
        prepared.repairs.iter().map(|repair| repair.kind).collect()
    }

    #[test]
    fn triangles_with_vertices_of_their_own_are_the_surface_that_they_came_from() {
        for shape in
            [shapes::sphere(200), shapes::torus(1, 300), shapes::hare(200), shapes::terrain(200, 1), shapes::part(400)]
        {
            let (points, faces) = (shape.points, shape.triangles);
            let before = prepare(&model(&points, &faces), Weld::Never).unwrap();
            let stitched = prepare(&soup(&points, &faces), Weld::Auto).unwrap();
            assert_eq!(kinds(&stitched), [RepairKind::Welded]);
            assert_eq!(euler(&stitched), euler(&before));
            assert_eq!(prepare(&soup(&points, &faces), Weld::Never).unwrap().surfaces.len(), faces.len());
            // What needs none is left as it is.
            assert_eq!(Weld::Auto.of(&model(&points, &faces)), None);
        }
    }

    #[test]
    fn triangles_that_run_against_their_neighbours_are_stitched_and_turned() {
        let shapes::Shape { points, triangles: mut faces } = shapes::sphere(200);
        faces.iter_mut().step_by(3).for_each(|face| face.swap(0, 1));
        let stitched = prepare(&soup(&points, &faces), Weld::Auto).unwrap();
        assert_eq!(kinds(&stitched), [RepairKind::FlippedFace, RepairKind::Welded]);
        assert_eq!(euler(&stitched), [2]);
    }

    #[test]
    fn two_sides_of_a_sheet_and_bodies_that_touch_stay_apart() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let doubled = model(&[square, square].concat(), &[[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]);
        assert_eq!(Weld::Auto.of(&doubled), None);
        // Two tetrahedra on one triangle.
        let [a, b, c, d, e] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [4, 5, 6], [4, 7, 5], [5, 7, 6], [6, 7, 4]];
        let touching = model(&[a, b, c, d, a, b, c, e], &faces);
        assert_eq!(Weld::Auto.of(&touching), None);
        assert_eq!(prepare(&touching, Weld::Auto).unwrap().surfaces.len(), 2);
    }

    #[test]
    fn halves_are_joined_but_a_short_slit_and_the_mouth_of_a_pocket_stay_open() {
        let shapes::Shape { points, triangles } = shapes::sphere(2000);
        let count = points.len() as u32;
        let is_upper = |face: &[u32; 3]| face.iter().map(|&v| points[v as usize][2]).sum::<f64>() > 0.0;
        let half = |&face: &[u32; 3]| face.map(|v| if is_upper(&face) { v + count } else { v });
        let faces: Vec<[u32; 3]> = triangles.iter().map(half).collect();
        let halves = model(&[points.clone(), points.clone()].concat(), &faces);
        assert_eq!(prepare(&halves, Weld::Never).unwrap().surfaces.len(), 2);
        let joined = prepare(&halves, Weld::Auto).unwrap();
        assert_eq!(euler(&joined), [2]);
        // One triangle has a vertex of its own: two of its sides are open.
        let mut slit = triangles.clone();
        let about = slit.iter_mut().find(|face| face.contains(&7)).unwrap();
        about.iter_mut().filter(|v| **v == 7).for_each(|v| *v = count);
        let slit = model(&[points.clone(), vec![points[7]]].concat(), &slit);
        assert_eq!(Weld::Auto.of(&slit), None);
        // A sheet with a hole of some size, and a tetrahedron without a base about the same hole.
        let pocket = |size: f64| {
            let hole = [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]].map(|p| p.map(|x| size * x));
            let sheet = [[0.0; 3], [1000.0, 0.0, 0.0], [0.0, 1000.0, 0.0]];
            let points = [&sheet[..], &hole, &hole, &[[size, size, -size]]].concat();
            let faces =
                [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 0, 5], [0, 3, 5], [6, 7, 9], [7, 8, 9], [8, 6, 9]];
            prepare(&model(&points, &faces), Weld::Auto).unwrap().surfaces.len()
        };
        assert_eq!([pocket(1.0), pocket(100.0)], [2, 1]);
    }

    #[test]
    fn where_three_meet_none_is_chosen_but_what_has_no_area_is_passed_over() {
        let edge = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        let sheet = |apex: [f64; 3]| [edge[0], edge[1], apex];
        let [up, down, aside] = [[0.5, 1.0, 0.0], [0.5, -1.0, 0.0], [0.5, 0.0, 1.0]].map(sheet);
        let faces = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
        assert_eq!(Weld::Auto.of(&model(&[up, down, aside].concat(), &faces)), None);
        let [start, end] = edge;
        let needle = [start, end, end];
        let stitched = Weld::Auto.of(&model(&[up, down, needle].concat(), &faces)).unwrap();
        assert_eq!(stitched, [0, 1, 2, 0, 1, 5, 6, 7, 8]);
    }
}
