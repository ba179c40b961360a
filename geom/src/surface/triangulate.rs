//! Cutting polygons into triangles.
//!
//! A quadrilateral is cut by the shorter of its diagonals that leave both triangles unflipped, by that from its first corner
//! where they are about as long; a concave one has just one such diagonal. A larger polygon is projected to the plane of its
//! Newell normal and its ears are clipped one after the other
//! (G. H. Meisters, *Polygons have ears*, 1975), skipping the neighbour of the last ear so that fans do not arise where
//! they need not. "Unflipped" is meant against the Newell normal, half the sum of the cross products of consecutive corners
//! (Sutherland, Sproull and Schumacker 1974), which is the mean normal also of corners that lie in no plane.
//!
//! Where there is no ear, as in polygons that cross themselves or have no area, the best corner is clipped all the same:
//! n corners always make n − 2 triangles. Clipping is quadratic at worst, and beyond [`WORK_PER_MODEL`] comparisons the
//! containment test is given up, for a polygon of 10⁵ corners is no mesh but must not stop the program either.

use super::model::Model;
use crate::vector::{cross, dot, sub};

/// How many pairs of corners are compared in a model before ears are clipped untested: about two seconds.
const WORK_PER_MODEL: u64 = 1 << 29;

/// Twice the area, in a polygon of size 1, up to which three corners count as lying on a line: far above rounding, and
/// below any triangle worth having.
const FLAT: f64 = 1e-12;

/// Corners of polygons of few corners that are this near to a side, in a polygon of size 1, lie on it, as far as ears without them can be found: files round,
/// and what lies on a straight side would be a triangle without area.
const NEAR: f64 = 1e-5;

/// So many corners are few: all of them are compared.
const FEW: usize = 64;

/// Squares of a quadrilateral's diagonals that differ by this share count as equal: the first is taken, so that instances of one shape, whose points
/// are rounded, are cut alike.
const TIE: f64 = 2e-3;

/// The triangles of a model's polygons.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Triangles {
    /// The three corners of each triangle: indices into [`Model::corners`], around it as the polygon goes around.
    pub corners: Vec<[u32; 3]>,
    /// The face that each triangle is part of; never decreasing.
    pub face_of: Vec<u32>,
}

impl Triangles {
    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there are none, which no model brings about.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The three vertices of each triangle.
    pub fn vertices(&self, model: &Model) -> Vec<[u32; 3]> {
        self.corners.iter().map(|corners| corners.map(|c| model.corners()[c as usize])).collect()
    }
}

impl Model {
    /// The polygons cut into triangles, for computing: n − 2 of them for n corners, whatever the polygon's shape.
    ///
    /// Quadrilaterals are cut by the shorter diagonal that keeps both triangles unflipped, that from the first corner where both are about as long; larger
    /// polygons by clipping ears.
    ///
    /// ```
    /// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    /// let model = geom::Model::from_polygons(square, [[0, 1, 2, 3]])?;
    /// assert_eq!(model.triangles().corners, [[0, 1, 2], [0, 2, 3]]);
    /// # Ok::<(), geom::ModelError>(())
    /// ```
    pub fn triangles(&self) -> Triangles {
        triangulate(self)
    }
}

fn triangulate(model: &Model) -> Triangles {
    let count = model.corner_count() - 2 * model.face_count();
    if count == model.face_count() {
        // No face has fewer than three corners, so that none has more.
        let faces = 0..count as u32;
        let corners = faces.clone().map(|face| [0, 1, 2].map(|k| 3 * face + k)).collect();
        return Triangles { corners, face_of: faces.collect() };
    }
    let mut triangles = Triangles { corners: Vec::with_capacity(count), face_of: Vec::with_capacity(count) };
    let mut work = WORK_PER_MODEL;
    for face in 0..model.face_count() {
        let range = model.face_corners(face);
        let first = range.start as u32;
        let mut push = |[a, b, c]: [usize; 3]| {
            triangles.corners.push([a, b, c].map(|i| first + i as u32));
            triangles.face_of.push(face as u32);
        };
        match range.len() {
            3 => push([0, 1, 2]),
            _ => clip(&unit_points(model, face), &mut work, &mut push),
        }
    }
    triangles
}

/// Cuts a polygon of three corners and more into triangles of them, with so much work at most before ears are clipped untested.
pub(super) fn cut_polygon(points: &[[f64; 3]], work: &mut u64) -> Vec<[usize; 3]> {
    let mut triangles = Vec::with_capacity(points.len() - 2);
    clip(&in_unit_size(points.iter().copied()), work, &mut |corners| triangles.push(corners));
    triangles
}

/// Cuts a polygon of size 1.
fn clip(points: &[[f64; 3]], work: &mut u64, push: &mut impl FnMut([usize; 3])) {
    match points.len() {
        3 => push([0, 1, 2]),
        4 => cut_quad(points).into_iter().for_each(push),
        _ => Ears::new(&project(points), work).clip(push),
    }
}

/// The points of a face in size 1.
fn unit_points(model: &Model, face: usize) -> Vec<[f64; 3]> {
    in_unit_size(model.face(face).iter().map(|&v| model.points()[v as usize]))
}

/// Points moved to the first and scaled to size 1, so that products neither overflow nor vanish.
fn in_unit_size(points: impl Iterator<Item = [f64; 3]> + Clone) -> Vec<[f64; 3]> {
    let origin = points.clone().next().unwrap_or_default();
    let mut points: Vec<[f64; 3]> = points.map(|p| sub(p, origin)).collect();
    let size = points.iter().flatten().fold(0.0_f64, |size, x| size.max(x.abs()));
    if size > 0.0 {
        points.iter_mut().flatten().for_each(|x| *x /= size);
    }
    points
}

fn cut_quad(points: &[[f64; 3]]) -> [[usize; 3]; 2] {
    let [a, b, c, d] = [points[0], points[1], points[2], points[3]];
    let normal = newell(points);
    let area = |p, q, r| dot(cross(sub(q, p), sub(r, p)), normal);
    let (worst_ac, worst_bd) = (area(a, b, c).min(area(a, c, d)), area(b, c, d).min(area(b, d, a)));
    let ac_is_better = match (worst_ac > 0.0, worst_bd > 0.0) {
        (true, true) => norm2(sub(c, a)) <= (1.0 + TIE) * norm2(sub(d, b)),
        (true, false) => true,
        (false, true) => false,
        (false, false) => worst_ac >= worst_bd,
    };
    if ac_is_better { [[0, 1, 2], [0, 2, 3]] } else { [[1, 2, 3], [1, 3, 0]] }
}

/// The polygon seen along its Newell normal, counter-clockwise on the whole.
fn project(points: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let normal = newell(points);
    let length = norm2(normal).sqrt();
    let normal = if length > 0.0 { normal.map(|x| x / length) } else { [0.0, 0.0, 1.0] };
    let [right, up] = basis(normal);
    points.iter().map(|&p| [dot(p, right), dot(p, up)]).collect()
}

/// Two vectors that make a right-handed orthonormal basis with a unit vector.
fn basis(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let axis = if normal[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let right = cross(axis, normal);
    let length = norm2(right).sqrt();
    let right = right.map(|x| x / length);
    [right, cross(normal, right)]
}

fn newell(points: &[[f64; 3]]) -> [f64; 3] {
    let mut normal = [0.0; 3];
    for (i, &p) in points.iter().enumerate() {
        let q = points[(i + 1) % points.len()];
        let product = cross(p, q);
        for axis in 0..3 {
            normal[axis] += product[axis];
        }
    }
    normal
}

/// A polygon of which ears are being clipped: a ring of the corners that are left.
struct Ears<'a> {
    points: &'a [[f64; 2]],
    previous: Vec<usize>,
    next: Vec<usize>,
    /// Corners where the polygon does not turn left; only they can lie in an ear. Corners never become such.
    reflex: Vec<usize>,
    work: &'a mut u64,
}

impl<'a> Ears<'a> {
    fn new(points: &'a [[f64; 2]], work: &'a mut u64) -> Self {
        let n = points.len();
        let previous = (0..n).map(|i| (i + n - 1) % n).collect();
        let next = (0..n).map(|i| (i + 1) % n).collect();
        let mut ears = Self { points, previous, next, reflex: Vec::new(), work };
        ears.reflex = (0..n).filter(|&i| ears.turn(i) <= FLAT).collect();
        ears
    }

    fn clip(mut self, push: &mut impl FnMut([usize; 3])) {
        let mut corner = 0;
        for left in (3..self.points.len()).rev() {
            let ear = self.find(corner);
            push([self.previous[ear], ear, self.next[ear]]);
            let behind = self.remove(ear);
            corner = self.next[behind];
            // Corners that are reflex no more are harmless in the list, they only take time.
            if left % 32 == 0 && *self.work > 0 {
                self.forget_convex();
            }
        }
        push([self.previous[corner], corner, self.next[corner]]);
    }

    /// The next ear from `start` on, or the corner with the widest triangle if there is no ear.
    fn find(&mut self, start: usize) -> usize {
        if let Some(ear) = self.find_wide(start) {
            return ear;
        }
        let (mut corner, mut widest) = (start, start);
        loop {
            if *self.work == 0 {
                return start;
            }
            self.spend(1);
            if self.is_ear(corner) {
                return corner;
            }
            if self.turn(corner) > self.turn(widest) {
                widest = corner;
            }
            corner = self.next[corner];
            if corner == start {
                return widest;
            }
        }
    }

    /// The next ear whose corners are apart, of a polygon of few corners.
    fn find_wide(&mut self, start: usize) -> Option<usize> {
        let count = self.points.len();
        let mut corner = start;
        for _ in 0..if count <= FEW { count } else { 0 } {
            if self.is_wide_ear(corner) {
                return Some(corner);
            }
            corner = self.next[corner];
        }
        None
    }

    fn is_wide_ear(&self, corner: usize) -> bool {
        let [a, b, c] = [self.previous[corner], corner, self.next[corner]].map(|i| self.points[i]);
        let beside = |from: [f64; 2], to: [f64; 2], p: [f64; 2]| {
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            orientation(from, to, p) / length
        };
        let is_apart = |i: usize| {
            let p = self.points[i];
            let is_corner = p == a || p == b || p == c;
            is_corner || [(a, b), (b, c), (c, a)].into_iter().any(|(from, to)| beside(from, to, p) < -NEAR)
        };
        let left = |&i: &usize| self.next[i] != i;
        beside(c, a, b) > NEAR && (0..self.points.len()).filter(left).all(is_apart)
    }

    /// Takes a corner out and returns the one behind it.
    fn remove(&mut self, ear: usize) -> usize {
        let (before, behind) = (self.previous[ear], self.next[ear]);
        self.next[before] = behind;
        self.previous[behind] = before;
        // The ear points to itself from now on: it is recognised as removed.
        self.next[ear] = ear;
        behind
    }

    fn forget_convex(&mut self) {
        let mut reflex = std::mem::take(&mut self.reflex);
        self.spend(reflex.len());
        reflex.retain(|&i| self.next[i] != i && self.turn(i) <= FLAT);
        self.reflex = reflex;
    }

    fn spend(&mut self, work: usize) {
        *self.work = self.work.saturating_sub(work as u64);
    }

    fn is_ear(&mut self, corner: usize) -> bool {
        if self.turn(corner) <= FLAT {
            return false;
        }
        self.spend(self.reflex.len());
        let triangle = [self.previous[corner], corner, self.next[corner]].map(|i| self.points[i]);
        !self.reflex.iter().any(|&i| self.next[i] != i && is_inside(self.points[i], triangle))
    }

    /// Twice the area of the triangle at a corner, positive where the polygon turns left.
    fn turn(&self, corner: usize) -> f64 {
        orientation(self.points[self.previous[corner]], self.points[corner], self.points[self.next[corner]])
    }
}

/// Whether a point is in a counter-clockwise triangle or on its rim, its corners excepted.
fn is_inside(p: [f64; 2], [a, b, c]: [[f64; 2]; 3]) -> bool {
    let is_corner = p == a || p == b || p == c;
    !is_corner && [(a, b), (b, c), (c, a)].into_iter().all(|(a, b)| orientation(a, b, p) >= -FLAT)
}

fn orientation(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn norm2(a: [f64; 3]) -> f64 {
    dot(a, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygon(points: &[[f64; 3]]) -> Model {
        let face: Vec<u32> = (0..points.len() as u32).collect();
        Model::from_polygons(points.to_vec(), [face]).unwrap()
    }

    fn area2(model: &Model, corners: [u32; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| model.points()[model.corners()[corner as usize] as usize]);
        cross(sub(b, a), sub(c, a))
    }

    /// Triangles of a planar polygon must all turn as it does, and their areas add up to its own.
    fn assert_is_partition(model: &Model) {
        let triangles = model.triangles();
        let normal = newell(&unit_points(model, 0));
        let mut sum = [0.0; 3];
        for &corners in &triangles.corners {
            let area = area2(model, corners);
            assert!(dot(area, normal) > 0.0, "triangle {corners:?} is flipped in {:?}", model.points());
            (0..3).for_each(|axis| sum[axis] += area[axis]);
        }
        let whole = newell(model.points());
        assert!(norm2(sub(sum, whole)) <= 1e-18 * norm2(whole), "{sum:?} is not {whole:?}");
        assert_eq!(triangles.len(), model.corner_count() - 2);
    }

    fn flat(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
        points.iter().map(|&[x, y]| [x, y, 0.25 * x - 2.0 * y]).collect()
    }

    #[test]
    fn a_quad_is_cut_by_its_shorter_diagonal() {
        let kite = [[0.0, -1.0, 0.0], [3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-3.0, 0.0, 0.0]];
        assert_eq!(polygon(&kite).triangles().corners, [[0, 1, 2], [0, 2, 3]]);
        let turned = [kite[1], kite[2], kite[3], kite[0]];
        assert_eq!(polygon(&turned).triangles().corners, [[1, 2, 3], [1, 3, 0]]);
    }

    #[test]
    fn rounding_does_not_decide_which_diagonal_of_a_rectangle_is_the_shorter() {
        for rounded in [-1e-5, 0.0, 1e-5] {
            let rectangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0 + rounded, 1.0, 0.0], [0.0, 1.0, 0.0]];
            assert_eq!(polygon(&rectangle).triangles().corners, [[0, 1, 2], [0, 2, 3]]);
        }
        let leaning = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.01, 1.0, 0.0], [0.01, 1.0, 0.0]];
        assert_eq!(polygon(&leaning).triangles().corners, [[1, 2, 3], [1, 3, 0]]);
    }

    #[test]
    fn a_concave_quad_is_cut_at_its_reflex_corner_at_any_scale() {
        let dart = [[0.0, 0.0], [4.0, -0.1], [0.5, 0.5], [-0.1, 4.0]];
        for scale in [1.0, 1e-160, 1e150] {
            for shift in 0..4 {
                let mut points = flat(&dart);
                points.iter_mut().flatten().for_each(|x| *x *= scale);
                points.rotate_left(shift);
                let triangles = polygon(&points).triangles();
                let reflex = (2 + 4 - shift as u32) % 4;
                assert!(triangles.corners.iter().all(|corners| corners.contains(&reflex)), "{triangles:?}");
            }
        }
    }

    #[test]
    fn polygons_are_cut_alike_wherever_they_are() {
        let dart = [[0.0, 0.0], [4.0, -1.0], [1.0, 1.0], [-1.0, 4.0]];
        let arrow = [[0.0, 0.0], [4.0, -1.0], [3.0, 0.0], [4.0, 1.0], [-5.0, 6.0]];
        for points in [&dart[..], &arrow] {
            let here: Vec<[f64; 3]> = points.iter().map(|&[x, y]| [x, y, x - 2.0 * y]).collect();
            // These are exact.
            let there: Vec<[f64; 3]> = here.iter().map(|p| p.map(|x| x + 1e12)).collect();
            assert_eq!(polygon(&there).triangles(), polygon(&here).triangles());
        }
    }

    #[test]
    fn where_there_is_no_ear_the_widest_corner_is_clipped() {
        let mut random = 1_u64;
        let mut coordinate = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f64 / (1 << 24) as f64
        };
        let mut earless = 0;
        for _ in 0..2000 {
            let points: Vec<[f64; 2]> = (0..6).map(|_| [coordinate(), coordinate()]).collect();
            let mut work = WORK_PER_MODEL;
            let mut ears = Ears::new(&points, &mut work);
            let found = ears.find(0);
            if !ears.is_ear(found) {
                earless += 1;
                assert!((0..6).all(|corner| ears.turn(corner) <= ears.turn(found)), "{points:?}");
            }
        }
        assert!(earless > 10, "{earless}");
    }

    #[test]
    fn concave_polygons_are_cut_without_overlap() {
        let comb: Vec<_> = (0..20).map(|i| [f64::from(i), if i % 2 == 0 { 0.0 } else { 5.0 }]).collect();
        let comb: Vec<_> = comb.into_iter().chain([[19.0, 9.0], [0.0, 9.0]]).collect();
        let spiral: Vec<_> = (0..60).map(|i| f64::from(i) * 0.3).collect();
        let arm = |width: f64| move |&t: &f64| [(t + width) * t.cos(), (t + width) * t.sin()];
        let spiral: Vec<_> = spiral.iter().map(arm(2.0)).chain(spiral.iter().rev().map(arm(1.0))).collect();
        let with_straight_corners =
            [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
        let keyhole = [
            [0.0, 0.0],
            [9.0, 0.0],
            [9.0, 9.0],
            [0.0, 9.0],
            [0.0, 0.0],
            [3.0, 3.0],
            [3.0, 6.0],
            [6.0, 6.0],
            [6.0, 3.0],
            [3.0, 3.0],
        ];
        let reversed: Vec<_> = spiral.iter().rev().copied().collect();
        // So many on one side that corners are dropped from the list of those that may lie in an ear.
        let straight_side: Vec<_> = (0..70).map(|i| [f64::from(i), 0.0]).chain([[30.0, 50.0]]).collect();
        for points in [&comb[..], &spiral, &reversed, &with_straight_corners, &keyhole, &straight_side] {
            for shift in 0..points.len() {
                let mut points = flat(points);
                points.rotate_left(shift);
                assert_is_partition(&polygon(&points));
            }
        }
    }

    #[test]
    fn degenerate_polygons_still_make_all_their_triangles() {
        let line: Vec<_> = (0..7).map(|i| [f64::from(i % 4), 0.0, 0.0]).collect();
        let bow = flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [2.0, 3.0]]);
        for points in [vec![[1.0, 2.0, 3.0]; 9], line, bow, vec![[0.0; 3]; 4]] {
            let triangles = polygon(&points).triangles();
            assert_eq!(triangles.len(), points.len() - 2);
            assert!(triangles.corners.iter().flatten().all(|&corner| (corner as usize) < points.len()));
        }
    }

    #[test]
    fn triangles_of_several_faces_name_their_faces() {
        let points = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 2.0]]);
        let faces: [&[u32]; 3] = [&[0, 1, 2, 3, 4], &[2, 1, 0], &[3, 2, 1, 0]];
        let model = Model::from_polygons(points, faces).unwrap();
        let triangles = model.triangles();
        assert_eq!(triangles.face_of, [0, 0, 0, 1, 2, 2]);
        assert_eq!(triangles.corners[3], [5, 6, 7]);
        assert_eq!(triangles.vertices(&model)[3], [2, 1, 0]);
        for (corners, &face) in triangles.corners.iter().zip(&triangles.face_of) {
            assert!(corners.iter().all(|&corner| model.face_corners(face as usize).contains(&(corner as usize))));
        }
    }

    #[test]
    fn corners_on_straight_sides_make_no_triangle_without_area() {
        // Three sides of a rectangle with corners inside them, turned, in single precision.
        let sides = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [3.0, 2.0], [1.5, 2.0], [0.0, 2.0]];
        for angle in [0.1_f64, 0.7, 1.9, 2.6] {
            for shift in 0..sides.len() {
                let turn =
                    |[x, y]: [f64; 2]| [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos(), 0.5 * x];
                let mut points: Vec<[f64; 3]> = sides.iter().map(|&p| turn(p).map(|x| f64::from(x as f32))).collect();
                points.rotate_left(shift);
                let model = polygon(&points);
                for corners in model.triangles().corners {
                    assert!(norm2(area2(&model, corners)).sqrt() > 0.1, "{corners:?} of {points:?}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn no_other_cut_of_a_quad_has_a_better_worst_triangle_where_one_is_flipped(
            corners in proptest::array::uniform4([-1.0..1.0_f64, -1.0..1.0]),
        ) {
            let model = polygon(&corners.map(|[x, y]| [x, y, 0.0]));
            let whole = newell(model.points());
            let worst = |cut: [[u32; 3]; 2]| cut.map(|t| dot(area2(&model, t), whole)).into_iter().fold(f64::INFINITY, f64::min);
            let taken = worst([model.triangles().corners[0], model.triangles().corners[1]]);
            let best = worst([[0, 1, 2], [0, 2, 3]]).max(worst([[1, 2, 3], [1, 3, 0]]));
            prop_assert!(taken > 0.0 || taken >= best - 1e-12);
        }

        #[test]
        fn star_shaped_polygons_are_cut_without_overlap(radii in proptest::collection::vec(0.1_f64..3.0, 5..40)) {
            let step = std::f64::consts::TAU / radii.len() as f64;
            let points: Vec<_> = radii.iter().enumerate().map(|(i, r)| [r * (i as f64 * step).cos(), r * (i as f64 * step).sin()]).collect();
            assert_is_partition(&polygon(&flat(&points)));
        }
    }
}
