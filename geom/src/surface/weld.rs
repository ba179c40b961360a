//! Which vertices of a model are taken for one.
//!
//! Many files have a vertex several times where its faces differ in normals or texture coordinates, up to one for each corner of a
//! triangle: as they are numbered, their surfaces fall apart.

use super::model::Model;
use super::repair::RepairLog;
use super::soup::{Soup, stitches_of};
use super::triangulate::Triangles;
use crate::watch::{Interrupted, Watch};

/// Which vertices of a model are taken for one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Weld {
    /// Those at the ends of two sides of the boundary that are at exactly the same place, if no third one is there, or of
    /// four and more, an even number, in pairs that bound the same body: so the surface is closed where it meets itself, and nothing that was a surface
    /// before is one no longer. What lies on top of a copy of itself stays apart, and so
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
            Self::Auto => return stitches_of(model),
        };
        (0..).zip(&place).any(|(v, &place)| v != place).then_some(place)
    }

    /// The triangles of a model, each glued to its neighbours, with vertices taken for one.
    pub(super) fn glued(
        self,
        model: &Model,
        triangles: &Triangles,
        log: &mut RepairLog,
        watch: Watch,
    ) -> Result<Soup, Interrupted> {
        // Boundaries have to be known before they are joined: where they are, triangles are glued again.
        let place = if self == Self::Always { self.of(model) } else { None };
        let mut first = RepairLog::default();
        let soup = Soup::glued(model, triangles, place.as_deref(), &mut first, watch.within(0.0, 0.8))?;
        if self == Self::Auto
            && let Some(place) = soup.stitches(model.points())
        {
            return Soup::glued(model, triangles, Some(&place), log, watch.within(0.8, 1.0));
        }
        *log = first;
        Ok(soup)
    }

    /// Gives triangles of a model the vertices that theirs are taken for. O(F).
    pub fn apply(self, model: &Model, triangles: &mut [[u32; 3]]) {
        if let Some(place) = self.of(model) {
            triangles.iter_mut().flatten().for_each(|v| *v = place[*v as usize]);
        }
    }
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
