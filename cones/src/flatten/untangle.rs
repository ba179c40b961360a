//! Turning flipped triangles of a patch over, without moving its rim.
//!
//! The method of "Foldover-free maps in 50 lines of code" (Garanzha, Kaporin, Kudryavtseva, Protais, Ray & Sokolov
//! 2021): with J the Jacobian of the map from a triangle's reference shape to the plane, minimise
//!
//! ```text
//!     Σ w |J|² / 2χ(det J, ε),      χ(D, ε) = (D + √(ε² + D²)) / 2,
//! ```
//!
//! which is finite for flipped triangles as long as ε > 0, and the steeper for them the smaller ε is. L-BFGS lowers
//! it, with ε chosen anew by the worst triangle in each round, until none is flipped; then once more with ε = 0, where
//! χ is the determinant and flipping costs infinitely much. What remains is how far each triangle is from conformal: 1
//! at its best.
//!
//! What moves are *displacements*: each [`Corner`] sits at `position + R·d`, with R a rotation of its own. The copies
//! of a vertex on a seam share one displacement and differ in R, so that the two sides of the seam stay a rigid motion
//! of each other. A corner without displacement is fixed: the rim, and cones.
//!
//! Meant for patches of a few to a few thousand triangles. It knows nothing of angle sums: whether the angles at a
//! vertex add up to once round is the caller's to check.

use geom::Watch;
use thiserror::Error;

use crate::numerics::lbfgs::minimise;

/// Reference triangles flatter than this (height to longest side) are made this thick: no finite step could satisfy
/// thinner ones.
const LEAST_REFERENCE_HEIGHT: f64 = 1e-3;

/// A triangle counts as turned over when its height is above this share of its longest side, so that it still is
/// after rounding to written digits.
const LEAST_HEIGHT: f64 = 1e-7;

/// ε² = FLOOR + SLOPE·(worst determinant)²: the schedule of the authors' program.
const EPSILON_FLOOR: f64 = 1e-12;
const EPSILON_SLOPE: f64 = 0.04;

/// The least share of its unsigned area that a patch is taken to cover once it is untangled.
const LEAST_SIGNED_AREA: f64 = 1e-3;

/// Rounds in a row in which the worst triangle gains too little before the patch is given up; each halves ε. In the
/// patches of a mesh of needles (thingi520644) three find all that forty find, in a quarter of the time.
const STALLS: i32 = 3;

/// The share of its determinant that the worst triangle has to gain in a round.
const LEAST_GAIN: f64 = 0.2;

/// L-BFGS steps in a round, and in the last one,
const STEPS: usize = 200;
/// and the share of the energy that each has to gain, in a round and in the last one. With 10⁻¹² in both the layout of parts of needles takes up to
/// three times as long, and 15 of 130 files have another map: D lower by .001, quasi-conformal distortion the same but for one ruin. With 10⁻⁵ in the
/// last one 7 of 40 common meshes are others, which fill .01 less.
const ROUND: f64 = 1e-4;
const LAST_ROUND: f64 = 1e-12;

/// A corner of a patch: at `position + rotation·displacement`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Where it is while the displacement is zero.
    pub position: [f64; 2],
    /// The number of the displacement that moves it; none where it is fixed.
    pub displacement: Option<u32>,
    /// The unit complex number that the displacement is multiplied by.
    pub rotation: [f64; 2],
}

impl Corner {
    /// A corner that does not move.
    pub fn fixed(position: [f64; 2]) -> Self {
        Self { position, displacement: None, rotation: [1.0, 0.0] }
    }

    /// A corner that a displacement moves as it is.
    pub fn free(position: [f64; 2], displacement: u32) -> Self {
        Self { position, displacement: Some(displacement), rotation: [1.0, 0.0] }
    }

    /// Where the corner is after displacements.
    pub fn moved(&self, displacements: &[[f64; 2]]) -> [f64; 2] {
        let Some(k) = self.displacement else { return self.position };
        let ([x, y], [c, s], [dx, dy]) = (self.position, self.rotation, displacements[k as usize]);
        [x + c * dx - s * dy, y + s * dx + c * dy]
    }
}

/// A triangle of a patch, its corners counter-clockwise where it is not flipped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchTriangle {
    /// Its corners.
    pub corners: [u32; 3],
    /// Its reference shape: the lengths from corner 0 to 1, 1 to 2 and 2 to 0. Their scale matters only against that
    /// of the other triangles.
    pub lengths: [f64; 3],
    /// How much its distortion counts, for instance max(0.01, √(area / mean area)).
    pub weight: f64,
}

/// A part of a layout, to be untangled.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    corners: Vec<Corner>,
    triangles: Vec<PatchTriangle>,
    displacement_count: usize,
}

/// Why something is no patch.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PatchError {
    /// A triangle names a corner that is not there.
    #[error("triangle {triangle} of the patch refers to a corner that does not exist")]
    NoSuchCorner {
        /// The triangle.
        triangle: usize,
    },
    /// A corner names a displacement that is not there.
    #[error("corner {corner} of the patch refers to a displacement that does not exist")]
    NoSuchDisplacement {
        /// The corner.
        corner: usize,
    },
    /// A position or rotation is NaN or infinite.
    #[error("corner {corner} of the patch is not at a finite place")]
    CornerNotFinite {
        /// The corner.
        corner: usize,
    },
    /// A length or weight is not a positive finite number.
    #[error("triangle {triangle} of the patch has lengths or a weight that are not positive and finite")]
    NotPositive {
        /// The triangle.
        triangle: usize,
    },
}

/// A patch after [`Patch::untangle`].
#[derive(Clone, Debug, PartialEq)]
pub struct Untangled {
    /// The displacements; [`Corner::moved`] applies them.
    pub displacements: Vec<[f64; 2]>,
    /// Whether every triangle is counter-clockwise now, with a height that rounding does not lose.
    pub succeeded: bool,
    /// The least determinant of a triangle's Jacobian, the reference shapes scaled to the patch.
    pub least_determinant: f64,
    /// The weighted mean of |J|² / 2 det J: 1 where the map is conformal, infinite where a triangle is flipped.
    pub distortion: f64,
}

impl Patch {
    /// A patch of triangles whose corners are moved by as many displacements.
    ///
    /// # Errors
    /// If something refers to what does not exist, or a number is not finite, or a length or weight not positive.
    pub fn new(
        corners: Vec<Corner>,
        triangles: Vec<PatchTriangle>,
        displacement_count: usize,
    ) -> Result<Self, PatchError> {
        for (corner, at) in corners.iter().enumerate() {
            if at.displacement.is_some_and(|k| k as usize >= displacement_count) {
                return Err(PatchError::NoSuchDisplacement { corner });
            }
            if !at.position.iter().chain(&at.rotation).all(|x| x.is_finite()) {
                return Err(PatchError::CornerNotFinite { corner });
            }
        }
        for (triangle, shape) in triangles.iter().enumerate() {
            if shape.corners.iter().any(|&c| c as usize >= corners.len()) {
                return Err(PatchError::NoSuchCorner { triangle });
            }
            if !shape.lengths.iter().chain([&shape.weight]).all(|&x| x > 0.0 && x.is_finite()) {
                return Err(PatchError::NotPositive { triangle });
            }
        }
        Ok(Self { corners, triangles, displacement_count })
    }

    /// Where the corners are after displacements.
    pub fn positions(&self, displacements: &[[f64; 2]]) -> Vec<[f64; 2]> {
        self.corners.iter().map(|corner| corner.moved(displacements)).collect()
    }

    /// Looks for displacements that leave no triangle flipped, and among those for ones with little distortion.
    ///
    /// The same patch gives the same bits; a patch that is scaled, moved or turned gives displacements scaled and
    /// turned likewise, up to rounding.
    pub fn untangle(&self, watch: Watch) -> Untangled {
        let scaled = Scaled::new(self);
        let mut x = vec![0.0; 2 * self.displacement_count];
        if !scaled.has_rigid_flip(&x) {
            x = scaled.untangled(x, watch);
        }
        if scaled.least_determinant(&x) > 0.0 {
            x = minimise(|x| scaled.energy(x, 0.0), x, (STEPS, LAST_ROUND), || !watch.stops_at(f64::NAN));
        }
        let displacements: Vec<_> = x.chunks_exact(2).map(|d| [d[0] * scaled.unit, d[1] * scaled.unit]).collect();
        let positions = self.positions(&displacements);
        Untangled {
            succeeded: self.triangles.iter().all(|shape| is_upright(shape.corners.map(|c| positions[c as usize]))),
            least_determinant: scaled.least_determinant(&x),
            distortion: scaled.energy(&x, 0.0).0,
            displacements,
        }
    }
}

/// Whether a triangle is counter-clockwise with a height above [`LEAST_HEIGHT`].
fn is_upright([a, b, c]: [[f64; 2]; 3]) -> bool {
    let sides = [minus(b, a), minus(c, b), minus(a, c)];
    let longest_squared = sides.iter().map(|&side| dot(side, side)).fold(0.0, f64::max);
    2.0 * area([a, b, c]) > LEAST_HEIGHT * longest_squared
}

/// A patch in coordinates where its triangles' mean area is one, the reference shapes' as well.
struct Scaled<'a> {
    patch: &'a Patch,
    /// What is one in these coordinates.
    unit: f64,
    positions: Vec<[f64; 2]>,
    /// For each triangle the gradients of its corners' hat functions over the reference shape.
    hats: Vec<[[f64; 2]; 3]>,
    /// The triangles' weights; they sum to one.
    weights: Vec<f64>,
}

impl<'a> Scaled<'a> {
    fn new(patch: &'a Patch) -> Self {
        let triangles = &patch.triangles;
        let count = triangles.len().max(1) as f64;
        let size = triangles.iter().flat_map(|triangle| triangle.lengths).fold(0.0, f64::max);
        let shapes: Vec<_> = triangles.iter().map(|triangle| place(triangle.lengths.map(|l| l / size))).collect();
        let reference_unit = (shapes.iter().map(|&shape| area(shape)).sum::<f64>() / count).sqrt();
        let positions = |triangle: &PatchTriangle| triangle.corners.map(|c| patch.corners[c as usize].position);
        let areas: Vec<f64> = triangles.iter().map(|triangle| area(positions(triangle))).collect();
        // The signed area is what a fixed rim encloses, hence that of the patch untangled. A patch that has collapsed
        // to nothing has only its reference shapes for a scale.
        let [signed, folded] = [areas.iter().sum::<f64>(), areas.iter().map(|area| area.abs()).sum::<f64>()];
        let mean_area = signed.max(LEAST_SIGNED_AREA * folded) / count;
        let units = [mean_area.sqrt(), reference_unit * size, 1.0];
        let unit = units.into_iter().find(|unit| unit.is_normal()).unwrap_or(1.0);
        let origin = patch.corners.first().map_or([0.0; 2], |corner| corner.position);
        let total: f64 = triangles.iter().map(|triangle| triangle.weight).sum();
        Self {
            patch,
            unit,
            positions: patch.corners.iter().map(|at| minus(at.position, origin).map(|x| x / unit)).collect(),
            hats: shapes.into_iter().map(|shape| hats(shape.map(|p| p.map(|x| x / reference_unit)))).collect(),
            weights: triangles.iter().map(|triangle| triangle.weight / total).collect(),
        }
    }

    /// Where the corners are.
    fn corners(&self, x: &[f64]) -> Vec<[f64; 2]> {
        let displacements = x.as_chunks().0;
        let at = |(&position, corner): (&[f64; 2], &Corner)| Corner { position, ..*corner }.moved(displacements);
        self.positions.iter().zip(&self.patch.corners).map(at).collect()
    }

    /// The Jacobian's rows: its map's x and y by the reference shape's two coordinates.
    fn jacobian(&self, triangle: usize, corners: &[[f64; 2]]) -> [[f64; 2]; 2] {
        let mut rows = [[0.0; 2]; 2];
        for (&c, hat) in self.patch.triangles[triangle].corners.iter().zip(&self.hats[triangle]) {
            let p = corners[c as usize];
            for (row, p) in rows.iter_mut().zip(p) {
                row[0] += p * hat[0];
                row[1] += p * hat[1];
            }
        }
        rows
    }

    fn least_determinant(&self, x: &[f64]) -> f64 {
        let corners = self.corners(x);
        (0..self.hats.len()).map(|t| self.jacobian(t, &corners)).map(|[a, b]| cross(a, b)).fold(f64::INFINITY, f64::min)
    }

    /// Whether a triangle is flipped of which no corner can move: then nothing helps.
    fn has_rigid_flip(&self, x: &[f64]) -> bool {
        let is_fixed = |&c: &u32| self.patch.corners[c as usize].displacement.is_none();
        let is_rigid = |t: &usize| self.patch.triangles[*t].corners.iter().all(is_fixed);
        let corners = self.corners(x);
        let mut jacobians = (0..self.hats.len()).filter(is_rigid).map(|t| self.jacobian(t, &corners));
        jacobians.any(|[a, b]| cross(a, b) <= 0.0)
    }

    /// Displacements that flip no triangle any more, or where it goes no further.
    fn untangled(&self, mut x: Vec<f64>, watch: Watch) -> Vec<f64> {
        let mut worst = f64::NEG_INFINITY;
        let mut stalls = 0;
        loop {
            let least = self.least_determinant(&x);
            if least > (1.0 - LEAST_GAIN) * worst {
                (worst, stalls) = (least, 0);
            } else {
                stalls += 1;
            }
            if least > 0.0 || stalls == STALLS || watch.stops_at(f64::NAN) {
                return x;
            }
            let squared_epsilon = EPSILON_FLOOR + EPSILON_SLOPE * least.powi(2) * 0.25f64.powi(stalls);
            x = minimise(|x| self.energy(x, squared_epsilon), x, (STEPS, ROUND), || !watch.stops_at(f64::NAN));
        }
    }

    /// The energy and its gradient. With ε = 0 it is infinite where a triangle is flipped.
    fn energy(&self, x: &[f64], squared_epsilon: f64) -> (f64, Vec<f64>) {
        let mut energy = 0.0;
        let mut gradient = vec![0.0; x.len()];
        let corners = self.corners(x);
        for (t, weight) in self.weights.iter().enumerate() {
            let [a, b] = self.jacobian(t, &corners);
            let determinant = cross(a, b);
            let root = (determinant * determinant + squared_epsilon).sqrt();
            // Two forms of (D + √(ε² + D²)) / 2, each where it does not cancel.
            let chi = if determinant > 0.0 {
                0.5 * (root + determinant)
            } else {
                0.5 * squared_epsilon / (root - determinant)
            };
            if !(chi > 0.0 && chi.is_finite()) {
                return (f64::INFINITY, gradient);
            }
            let squared_norm = dot(a, a) + dot(b, b);
            energy += weight * squared_norm / (2.0 * chi);
            // d|J|² = 2 J : dJ,  dD = cof J : dJ,  dχ = χ/√(ε² + D²) dD
            let along = weight / chi;
            let turning = -weight * squared_norm / (2.0 * chi * root);
            let by_jacobian = [
                [along * a[0] + turning * b[1], along * a[1] - turning * b[0]],
                [along * b[0] - turning * a[1], along * b[1] + turning * a[0]],
            ];
            for (&c, hat) in self.patch.triangles[t].corners.iter().zip(&self.hats[t]) {
                let corner = &self.patch.corners[c as usize];
                let Some(k) = corner.displacement else { continue };
                let [gx, gy] = by_jacobian.map(|row| dot(row, *hat));
                let [cos, sin] = corner.rotation;
                gradient[2 * k as usize] += cos * gx + sin * gy;
                gradient[2 * k as usize + 1] += cos * gy - sin * gx;
            }
        }
        (energy, gradient)
    }
}

/// A triangle with the sides given, but not flatter than [`LEAST_REFERENCE_HEIGHT`].
fn place(lengths: [f64; 3]) -> [[f64; 2]; 3] {
    let first = (0..3).fold(0, |k, other| if lengths[other] > lengths[k] { other } else { k });
    let [longest, second, third] = [0, 1, 2].map(|k| lengths[(first + k) % 3]);
    let along = (0.5 * (longest + (third - second) * (third + second) / longest)).clamp(0.0, longest);
    let height = (third * third - along * along).max(0.0).sqrt().max(LEAST_REFERENCE_HEIGHT * longest);
    let mut corners = [[0.0, 0.0], [longest, 0.0], [along, height]];
    corners.rotate_right(first);
    corners
}

/// The gradients of a triangle's hat functions: each is one at its corner and zero at the others.
fn hats([a, b, c]: [[f64; 2]; 3]) -> [[f64; 2]; 3] {
    let twice = 2.0 * area([a, b, c]);
    [[b, c], [c, a], [a, b]].map(|[from, to]| [(from[1] - to[1]) / twice, (to[0] - from[0]) / twice])
}

/// The area of a triangle, negative where it runs clockwise.
fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    0.5 * cross(minus(b, a), minus(c, a))
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const HEXAGON: [[f64; 2]; 6] =
        [[1.0, 0.0], [0.5, 0.866], [-0.5, 0.866], [-1.0, 0.0], [-0.5, -0.866], [0.5, -0.866]];

    fn lengths(corners: [[f64; 2]; 3]) -> [f64; 3] {
        let [a, b, c] = corners;
        [minus(b, a), minus(c, b), minus(a, c)].map(|side| dot(side, side).sqrt())
    }

    /// A fan of equilateral triangles round a corner that was moved to `centre`; the rim is fixed.
    fn star(centre: [f64; 2]) -> Patch {
        let mut corners: Vec<_> = HEXAGON.map(Corner::fixed).into();
        corners.push(Corner::free(centre, 0));
        let triangle = |k| PatchTriangle { corners: [6, k, (k + 1) % 6], lengths: [1.0; 3], weight: 1.0 };
        Patch::new(corners, (0..6).map(triangle).collect(), 1).unwrap()
    }

    /// A square grid, its inner corners moved by offsets; references are the grid's own triangles, `scale` times.
    fn grid(size: u32, offsets: &[[f64; 2]], scale: f64) -> Patch {
        let mut count = 0;
        let corners: Vec<_> = (0..size * size)
            .map(|k| {
                let (i, j) = (k % size, k / size);
                let at = [f64::from(i), f64::from(j)];
                if [i, j].iter().any(|&x| x == 0 || x == size - 1) {
                    return Corner::fixed(at.map(|x| scale * x));
                }
                let [dx, dy] = offsets[count as usize % offsets.len()];
                count += 1;
                Corner::free([at[0] + dx, at[1] + dy].map(|x| scale * x), count - 1)
            })
            .collect();
        let squares = (0..(size - 1) * (size - 1)).map(|k| k % (size - 1) + k / (size - 1) * size);
        let triangles = squares.flat_map(|a| {
            let [ab, diagonal] = [scale, scale * 2f64.sqrt()];
            [
                PatchTriangle { corners: [a, a + 1, a + size + 1], lengths: [ab, ab, diagonal], weight: 1.0 },
                PatchTriangle { corners: [a, a + size + 1, a + size], lengths: [diagonal, ab, ab], weight: 1.0 },
            ]
        });
        Patch::new(corners, triangles.collect(), count as usize).unwrap()
    }

    #[test]
    fn a_star_folded_over_its_rim_opens_to_the_regular_one() {
        for centre in [[2.0, 0.3], [-0.1, 5.0], [0.9, 0.9], [30.0, -20.0], [1.0, 0.0]] {
            let patch = star(centre);
            assert!(Scaled::new(&patch).least_determinant(&[0.0; 2]) <= 1e-3);
            let untangled = patch.untangle(Watch::NONE);
            assert!(untangled.succeeded && untangled.least_determinant > 0.5, "{centre:?} gives {untangled:?}");
            let [x, y] = patch.positions(&untangled.displacements)[6];
            assert!(x.abs() < 1e-3 && y.abs() < 1e-3, "the centre comes to ({x}, {y})");
            assert!((untangled.distortion - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_good_patch_stays_good_and_its_distortion_falls() {
        let patch = star([0.4, -0.3]);
        let before = Scaled::new(&patch).energy(&[0.0; 2], 0.0).0;
        let after = patch.untangle(Watch::NONE);
        assert!(after.succeeded);
        assert!(after.distortion < before, "{} falls from {before}", after.distortion);
        let best = star([0.0; 2]).untangle(Watch::NONE);
        assert!(best.succeeded && best.displacements[0].iter().all(|d| d.abs() < 1e-3));
    }

    #[test]
    fn copies_of_a_seam_vertex_move_alike_up_to_their_rotation() {
        // The same star, cut in two halves: the second is turned by ρ and put elsewhere.
        let rho = [0.6, 0.8];
        let turn = |[x, y]: [f64; 2]| [rho[0] * x - rho[1] * y, rho[1] * x + rho[0] * y];
        let elsewhere = |p| [turn(p)[0] + 7.0, turn(p)[1] - 3.0];
        let centre = [1.4, 0.9];
        let mut corners: Vec<_> = [0, 1, 2, 3].map(|k| Corner::fixed(HEXAGON[k])).into();
        corners.extend([3, 4, 5, 0].map(|k| Corner::fixed(elsewhere(HEXAGON[k]))));
        corners.push(Corner::free(centre, 0));
        corners.push(Corner { position: elsewhere(centre), displacement: Some(0), rotation: rho });
        let triangles = [[8, 0, 1], [8, 1, 2], [8, 2, 3], [9, 4, 5], [9, 5, 6], [9, 6, 7]];
        let triangles = triangles.map(|corners| PatchTriangle { corners, lengths: [1.0; 3], weight: 1.0 });
        let patch = Patch::new(corners, triangles.into(), 1).unwrap();
        let untangled = patch.untangle(Watch::NONE);
        assert!(untangled.succeeded);
        let after = patch.positions(&untangled.displacements);
        let copy = elsewhere(after[8]);
        assert!((copy[0] - after[9][0]).abs() < 1e-12 && (copy[1] - after[9][1]).abs() < 1e-12);
        let whole = star(centre).untangle(Watch::NONE);
        assert!((0..2).all(|k| (whole.displacements[0][k] - untangled.displacements[0][k]).abs() < 1e-5));
    }

    #[test]
    fn the_gradient_is_the_energys_slope() {
        let offsets = [[0.3, -1.2], [-2.0, 0.7], [0.9, 0.4], [1.5, 1.5]];
        let mut patch = grid(5, &offsets, 1.0);
        patch.corners[12].rotation = [0.6, -0.8];
        let scaled = Scaled::new(&patch);
        let x: Vec<f64> = (0..2 * patch.displacement_count).map(|k| 0.1 * (k as f64).sin()).collect();
        let (_, gradient) = scaled.energy(&x, 0.3);
        for k in 0..x.len() {
            let at = |step: f64| {
                let mut moved = x.clone();
                moved[k] += step;
                scaled.energy(&moved, 0.3).0
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((slope - gradient[k]).abs() < 1e-6 * (1.0 + slope.abs()), "{k}: {slope} and {}", gradient[k]);
        }
    }

    #[test]
    fn the_scale_and_place_of_a_patch_do_not_matter() {
        let offsets = [[0.3, -1.2], [-2.0, 0.7], [0.9, 0.4], [1.5, 1.5]];
        let plain = grid(6, &offsets, 1.0).untangle(Watch::NONE);
        assert!(plain.succeeded);
        for scale in [1e-6, 1e5, 1e12] {
            let scaled = grid(6, &offsets, scale).untangle(Watch::NONE);
            assert!(scaled.succeeded && (scaled.distortion - plain.distortion).abs() < 1e-3, "scaled {scale}");
        }
        let mut patch = grid(6, &offsets, 1.0);
        patch.corners.iter_mut().for_each(|corner| corner.position[0] += 1e6);
        assert!(patch.untangle(Watch::NONE).succeeded);
    }

    #[test]
    fn needles_do_not_keep_a_star_from_opening() {
        let mut corners: Vec<_> = [[0.0, 0.0], [1.0, 0.0], [1.0, 1e-4], [0.0, 1e-4]].map(Corner::fixed).into();
        corners.push(Corner::free([0.5, -3e-4], 0));
        let at = |c: u32| if c == 4 { [0.5, 0.4e-4] } else { corners[c as usize].position };
        let triangles = [[4, 0, 1], [4, 1, 2], [4, 2, 3], [4, 3, 0]].map(|corners| PatchTriangle {
            corners,
            lengths: lengths(corners.map(at)),
            weight: 1.0,
        });
        assert!(Patch::new(corners, triangles.into(), 1).unwrap().untangle(Watch::NONE).succeeded);
    }

    #[test]
    fn what_cannot_be_untangled_is_reported() {
        let mut corners: Vec<_> = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]].map(Corner::fixed).into();
        corners.push(Corner::free([5.0, 5.0], 0));
        let flipped = PatchTriangle { corners: [0, 1, 2], lengths: [1.0; 3], weight: 1.0 };
        let patch = Patch::new(corners.clone(), vec![flipped], 1).unwrap();
        assert!(!patch.untangle(Watch::NONE).succeeded);
        let new = |triangle| Patch::new(corners.clone(), vec![triangle], 1).unwrap_err();
        assert_eq!(new(PatchTriangle { corners: [0, 1, 4], ..flipped }), PatchError::NoSuchCorner { triangle: 0 });
        let flat = PatchTriangle { lengths: [1.0, 0.0, 1.0], ..flipped };
        assert_eq!(new(flat), PatchError::NotPositive { triangle: 0 });
        assert_eq!(Patch::new(corners, vec![], 0), Err(PatchError::NoSuchDisplacement { corner: 3 }));
        let nowhere = vec![Corner::fixed([f64::NAN, 0.0])];
        assert_eq!(Patch::new(nowhere, vec![], 0), Err(PatchError::CornerNotFinite { corner: 0 }));
        assert!(
            Patch::new(vec![], vec![], 0).unwrap().untangle(Watch::NONE).succeeded,
            "nothing is flipped in nothing"
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn a_grid_in_any_disorder_is_untangled(
            size in 3u32..9,
            offsets in prop::collection::vec([-4.0..4.0f64, -4.0..4.0f64], 49),
        ) {
            let untangled = grid(size, &offsets, 1.0).untangle(Watch::NONE);
            prop_assert!(untangled.succeeded, "least determinant {}", untangled.least_determinant);
            prop_assert!(untangled.distortion < 1.5);
        }
    }
}
