//! A layout brought nearer to an isometry, each side of a seam moving for itself.
//!
//! With σ₁, σ₂ the singular values of the map of a triangle, and lengths such that the whole keeps its area, minimise
//!
//! ```text
//!     Σ A ψ(σ₁, σ₂),      ψ = (σ₁/σ₂ + σ₂/σ₁)/2 + λ (σ₁σ₂ + 1/σ₁σ₂):
//! ```
//!
//! the conformal energy of Hormann & Greiner (2000, "MIPS") with a small share λ of a symmetric one of areas. Both are infinite where a
//! triangle loses its area, so nothing is ever flipped. Newton's method with the Hessian of each triangle made positive semidefinite in closed form
//! (Smith, de Goes & Kim 2019, "Analytic eigensystems for isotropic distortion energies"): some ten to twenty steps, whatever the
//! surface.
//!
//! A cone metric is flat on *fine* triangles; where the input's are coarse, their linear images bend angles, and rigid seams leave no room to bend less. What is
//! given up here is that the two sides of a seam are congruent. Whether something comes to lie over something else is the caller's to
//! check: corners can be held where they are.

use geom::{Cholesky, CholeskyError, FaceId, Id, Mesh, Metric, SymmetricMatrix, Watch};
use num_complex::Complex64;

use super::layout::Layout;

/// A step that lowers the energy by less than this share of it is the last.
const LEAST_GAIN: f64 = 1e-4;
/// The share of the slope's promise that a step has to keep.
const DECREASE: f64 = 1e-4;
/// So often a step is halved.
const HALVINGS: i32 = 40;
/// What is added to the Hessian's diagonal, as a share of its mean: rigid motions cost no energy.
const SHIFT: f64 = 1e-8;
/// Triangles that are thinner, by area over the square of the longest side, stay where they are.
const LEAST_AREA: f64 = 1e-9;

/// A triangle that resists distortion.
struct Triangle {
    /// λ.
    areas: f64,
    corner: [usize; 3],
    /// The Jacobian is z ↦ p z + q z̄ with p = Σ cₖ zₖ over the corners' positions, and q the same with the conjugates of c.
    coefficient: [Complex64; 3],
    /// Its share of the area.
    weight: f64,
}

/// Where a step leads.
pub(crate) struct Step {
    pub(crate) position: Vec<Complex64>,
    energy: f64,
}

/// A layout on its way.
pub(crate) struct Relaxation {
    triangles: Vec<Triangle>,
    position: Vec<Complex64>,
    is_held: Vec<bool>,
    energy: f64,
    /// A Hessian's pattern, and where in it each triangle's entries are, row by row up to the diagonal.
    zeros: SymmetricMatrix,
    places: Vec<[u32; 21]>,
    factor: Option<Cholesky>,
    /// What positions are multiplied by.
    scale: f64,
}

impl Relaxation {
    /// Of a layout whose triangles are counter-clockwise, λ given; corners of those that are not, or hardly have area, are held. None where it has no size.
    pub(crate) fn new(mesh: &Mesh, metric: &Metric, layout: &Layout, areas: f64) -> Option<Self> {
        let whole: f64 = mesh.faces().map(|f| metric.sides(mesh, f).area()).sum();
        let covered = |f: FaceId| {
            let [a, b, c] = mesh.sides(f).map(|h| layout.corner(h));
            0.5 * ((b - a).conj() * (c - a)).im
        };
        let scale = (whole / mesh.faces().map(covered).sum::<f64>()).sqrt();
        let mut is_held = vec![false; layout.position.len()];
        let mut triangles = Vec::with_capacity(mesh.face_count());
        for f in mesh.faces() {
            let corner = mesh.sides(f).map(|h| layout.cut.wedge(h).index());
            let sides = metric.sides(mesh, f);
            let longest = sides.0.iter().fold(0.0_f64, |most, side| most.max(*side));
            let is_plain = |area: f64, longest: f64| area > LEAST_AREA * longest * longest;
            let image = corner.map(|wedge| layout.position[wedge]);
            let image_longest = (0..3).map(|k| (image[(k + 1) % 3] - image[k]).norm()).fold(0.0, f64::max);
            if !(is_plain(sides.area(), longest) && is_plain(covered(f), image_longest)) {
                corner.iter().for_each(|&wedge| is_held[wedge] = true);
                continue;
            }
            let [z, _, back] = sides.unfold().map(|[x, y]| Complex64::new(x, y));
            let w = -back;
            let determinant = z * w.conj() - w * z.conj();
            let (b, c) = (w.conj() / determinant, -z.conj() / determinant);
            triangles.push(Triangle { areas, corner, coefficient: [-(b + c), b, c], weight: sides.area() / whole });
        }
        let position: Vec<Complex64> = layout.position.iter().map(|p| scale * p).collect();
        let energy = energy(&triangles, &position);
        if !energy.is_finite() {
            return None;
        }
        let pairs = |triangle: &Triangle| {
            let unknown = [0, 1, 2, 3, 4, 5].map(|k| triangle.unknown(k));
            (0..6).flat_map(move |i| (0..=i).map(move |j| [unknown[i], unknown[j]]))
        };
        let zeros = SymmetricMatrix::zeros(2 * position.len(), triangles.iter().flat_map(pairs));
        let places = |triangle: &Triangle| {
            let mut places = [0; 21];
            let found = pairs(triangle).map(|[i, j]| zeros.place(i, j).expect("there is room") as u32);
            places.iter_mut().zip(found).for_each(|(place, found)| *place = found);
            places
        };
        let places = triangles.iter().map(places).collect();
        Some(Self { triangles, position, is_held, energy, zeros, places, factor: None, scale })
    }

    /// Holds a corner where it is; returns whether it was free.
    pub(crate) fn hold(&mut self, wedge: usize) -> bool {
        !std::mem::replace(&mut self.is_held[wedge], true)
    }

    /// Positions in the layout's own scale.
    pub(crate) fn unscaled(&self, position: &[Complex64]) -> Vec<Complex64> {
        position.iter().map(|p| p / self.scale).collect()
    }

    /// Newton's direction; none where nothing is to be gained.
    pub(crate) fn direction(&mut self, watch: Watch) -> Result<Option<Direction>, CholeskyError> {
        let (gradient, hessian) = self.derivatives();
        let factor = match self.factor.take() {
            Some(factor) => factor.refactor(hessian, watch.within(0.0, 0.9))?,
            None => Cholesky::new_watched(&hessian, None, watch.within(0.0, 0.9))?,
        };
        let downhill: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let step = factor.solve_watched(&downhill, watch.within(0.9, 1.0))?;
        self.factor = Some(factor);
        let slope: f64 = gradient.iter().zip(&step).map(|(g, d)| g * d).sum();
        let step = step.as_chunks::<2>().0.iter().map(|&[x, y]| Complex64::new(x, y)).collect();
        Ok((-slope > LEAST_GAIN * self.energy).then_some(Direction { step, slope }))
    }

    /// The longest step at most `most` that keeps all triangles and lowers the energy enough, if there is one.
    pub(crate) fn step(&self, direction: &Direction, most: f64) -> Option<(f64, Step)> {
        (0..HALVINGS).map(|k| most * 0.5_f64.powi(k)).find_map(|t| {
            let moved = self.position.iter().zip(&direction.step).map(|(p, d)| p + t * d);
            let position: Vec<Complex64> = moved.collect();
            let energy = energy(&self.triangles, &position);
            (energy <= self.energy + DECREASE * t * direction.slope).then_some((t, Step { position, energy }))
        })
    }

    /// The corners of triangles that would be turned over before so much of a direction is gone.
    pub(crate) fn in_the_way(&self, direction: &Direction, length: f64) -> Vec<usize> {
        let is_in_the_way = |triangle: &&Triangle| {
            let [p, q] = triangle.jacobian(&self.position);
            let [dp, dq] = triangle.jacobian(&direction.step);
            let half = (p.conj() * dp).re - (q.conj() * dq).re;
            let root = first_root(dp.norm_sqr() - dq.norm_sqr(), half, p.norm_sqr() - q.norm_sqr());
            root.is_some_and(|root| root < length)
        };
        self.triangles.iter().filter(is_in_the_way).flat_map(|triangle| triangle.corner).collect()
    }

    /// Takes a step; returns whether it gained enough for another.
    pub(crate) fn take(&mut self, step: Step) -> bool {
        let gain = self.energy - step.energy;
        (self.position, self.energy) = (step.position, step.energy);
        gain > LEAST_GAIN * self.energy
    }

    /// Where it is, in the layout's own scale.
    pub(crate) fn position(&self) -> Vec<Complex64> {
        self.unscaled(&self.position)
    }

    /// The energy's gradient and its Hessian, made positive definite. Unknowns are the coordinates of corners, in pairs.
    fn derivatives(&self) -> (Vec<f64>, SymmetricMatrix) {
        let mut gradient = vec![0.0; 2 * self.position.len()];
        let mut hessian = self.zeros.clone();
        let mut trace = 0.0;
        for (triangle, places) in self.triangles.iter().zip(&self.places) {
            let (of_triangle, square) = triangle.derivatives(&self.position);
            let is_held = |k: usize| self.is_held[triangle.corner[k / 2]];
            let mut places = places.iter();
            for (i, row) in square.iter().enumerate() {
                for (j, (&value, &place)) in row.iter().zip(places.by_ref().take(i + 1)).enumerate() {
                    if !(is_held(i) || is_held(j)) {
                        hessian.values_mut()[place as usize] += value;
                    }
                }
                if !is_held(i) {
                    gradient[triangle.unknown(i)] += of_triangle[i];
                    trace += row[i];
                }
            }
        }
        let mean = trace / gradient.len() as f64;
        for i in 0..gradient.len() {
            *hessian.diagonal_mut(i) += if self.is_held[i / 2] { mean } else { SHIFT * mean };
        }
        (gradient, hessian)
    }
}

/// Where a step may lead.
pub(crate) struct Direction {
    step: Vec<Complex64>,
    /// The energy's slope along it.
    slope: f64,
}

/// The first t > 0 where a t² + 2 b t + c is 0, which is above 0 at t = 0.
fn first_root(a: f64, b: f64, c: f64) -> Option<f64> {
    let square = b * b - a * c;
    // Without cancellation: c over the root of larger size.
    let root = (square >= 0.0).then(|| c / (square.sqrt() - b));
    root.filter(|root| *root > 0.0)
}

/// Infinite where a triangle is turned over or has no area.
fn energy(triangles: &[Triangle], position: &[Complex64]) -> f64 {
    let mut sum = 0.0;
    for triangle in triangles {
        let [p, q] = triangle.jacobian(position);
        let (determinant, square) = (p.norm_sqr() - q.norm_sqr(), 2.0 * (p.norm_sqr() + q.norm_sqr()));
        if determinant.is_nan() || determinant <= 0.0 {
            return f64::INFINITY;
        }
        sum += triangle.weight * (0.5 * square / determinant + triangle.areas * (determinant + determinant.recip()));
    }
    sum
}

impl Triangle {
    /// The number of a coordinate of a corner among all unknowns.
    fn unknown(&self, k: usize) -> usize {
        2 * self.corner[k / 2] + k % 2
    }

    fn jacobian(&self, position: &[Complex64]) -> [Complex64; 2] {
        let of = |k: usize| (self.coefficient[k], position[self.corner[k]]);
        let sum = |conjugate: bool| -> Complex64 {
            (0..3).map(of).map(|(c, z)| if conjugate { c.conj() * z } else { c * z }).sum()
        };
        [sum(false), sum(true)]
    }

    /// The gradient, and the positive semidefinite part of the Hessian, in the coordinates of its corners.
    fn derivatives(&self, position: &[Complex64]) -> ([f64; 6], [[f64; 6]; 6]) {
        let [p, q] = self.jacobian(position);
        let [one, two] = [p.norm() + q.norm(), p.norm() - q.norm()];
        let (d, n) = (one * two, one * one + two * two);
        // ψ's derivatives by σ₁ and σ₂, and its eigenvalues where the singular vectors turn together and against each other.
        let by = |a: f64, b: f64| 0.5 * (b.recip() - b / (a * a)) + self.areas * (b - (a * d).recip());
        let by_twice = |a: f64, b: f64| b / (a * a * a) + self.areas * 2.0 / (a * a * d);
        let mixed = -0.5 * n / (d * d) + self.areas * (1.0 + (d * d).recip());
        let turning = d.recip() - 0.5 * n / (d * d) + self.areas * (1.0 - (d * d).recip());
        let shearing = d.recip() + 0.5 * n / (d * d) + self.areas * ((d * d).recip() - 1.0);
        let [(first, along), (second, across)] = eigen(by_twice(one, two), mixed, by_twice(two, one));
        // What a motion of the corners does to p and q, seen along the singular vectors.
        let unit = |z: Complex64| if z.norm() > 0.0 { z.conj() / z.norm() } else { Complex64::ONE };
        let (of_p, of_q) = (unit(p), unit(q));
        let mut form = [[0.0; 6]; 4];
        for (k, c) in self.coefficient.iter().enumerate() {
            let (p, q) = (of_p * c, of_q * c.conj());
            for (i, [p, q]) in [[p, q], [p * Complex64::I, q * Complex64::I]].into_iter().enumerate() {
                let i = 2 * k + i;
                (form[0][i], form[1][i], form[2][i], form[3][i]) = (p.re + q.re, p.re - q.re, p.im, q.im);
            }
        }
        let [stretch_one, stretch_two, turn, shear] = form;
        let mix = |[a, b]: [f64; 2]| -> [f64; 6] { std::array::from_fn(|i| a * stretch_one[i] + b * stretch_two[i]) };
        let slopes = mix([by(one, two), by(two, one)]);
        let parts = [(first, mix(along)), (second, mix(across)), (2.0 * turning, turn), (2.0 * shearing, shear)];
        let mut square = [[0.0; 6]; 6];
        for (value, row) in parts.iter().filter(|(value, _)| *value > 0.0) {
            for i in 0..6 {
                (0..6).for_each(|j| square[i][j] += self.weight * value * row[i] * row[j]);
            }
        }
        (slopes.map(|slope| self.weight * slope), square)
    }
}

/// The eigenvalues of [[a, b], [b, c]] with their unit eigenvectors.
fn eigen(a: f64, b: f64, c: f64) -> [(f64, [f64; 2]); 2] {
    let angle = 0.5 * (2.0 * b).atan2(a - c);
    let (sin, cos) = angle.sin_cos();
    let value = |[x, y]: [f64; 2]| a * x * x + 2.0 * b * x * y + c * y * y;
    [[cos, sin], [-sin, cos]].map(|vector| (value(vector), vector))
}

#[cfg(test)]
mod tests {
    use super::super::flattened::Flattened;
    use super::*;
    use geom::{VertexId, shapes};

    fn relaxation(shape: &shapes::Shape, cones: &[u32], areas: f64) -> (Flattened, Relaxation) {
        let cones: Vec<VertexId> = cones.iter().map(|&v| VertexId(v)).collect();
        let flattened = Flattened::new(shape, &cones);
        let relaxation = Relaxation::new(&flattened.mesh, &flattened.metric, &flattened.layout, areas).unwrap();
        (flattened, relaxation)
    }

    #[test]
    fn the_gradient_and_the_hessian_of_a_triangle_are_those_of_its_energy() {
        let (c, corner, weight) = (Complex64::new(0.3, -0.8), [0, 1, 2], 0.7);
        let d = Complex64::new(-0.5, 0.2);
        let triangle = Triangle { areas: 0.2, corner, coefficient: [-(c + d), c, d], weight };
        let mut at = [(0.1, 0.2), (0.7, 0.5), (0.2, 1.2)].map(|(x, y)| Complex64::new(x, y));
        if triangle.jacobian(&at)[0].norm() < triangle.jacobian(&at)[1].norm() {
            at = at.map(|z| z.conj());
        }
        let moved = |i: usize, by: f64| {
            let mut moved = at;
            moved[i / 2] += if i.is_multiple_of(2) { Complex64::new(by, 0.0) } else { Complex64::new(0.0, by) };
            moved
        };
        let step = 1e-5;
        let value = |at: &[Complex64; 3]| energy(std::slice::from_ref(&triangle), at);
        let (gradient, square) = triangle.derivatives(&at);
        let mut whole = [[0.0; 6]; 6];
        for i in 0..6 {
            let slope = (value(&moved(i, step)) - value(&moved(i, -step))) / (2.0 * step);
            assert!((slope - gradient[i]).abs() < 1e-7 * (1.0 + slope.abs()), "{i}: {slope} {}", gradient[i]);
            let [more, less] = [step, -step].map(|by| triangle.derivatives(&moved(i, by)).0);
            whole[i] = std::array::from_fn(|j| (more[j] - less[j]) / (2.0 * step));
        }
        // The positive part is at least the Hessian itself: x·(H₊ - H)x ≥ 0, and H₊ ≥ 0.
        let form = |m: &[[f64; 6]; 6], x: &[f64; 6]| -> f64 {
            (0..6).map(|i| (0..6).map(|j| x[i] * m[i][j] * x[j]).sum::<f64>()).sum()
        };
        let mut differ = 0;
        for k in 0..200 {
            let x: [f64; 6] = std::array::from_fn(|i| f64::sin((7 * k + 3 * i * i + i) as f64));
            let (positive, exact) = (form(&square, &x), form(&whole, &x));
            assert!(positive > -1e-9 && positive > exact - 1e-5 * (1.0 + exact.abs()), "{positive} {exact}");
            differ += usize::from(positive > exact + 1e-3);
        }
        assert!(differ > 0, "this triangle's Hessian is not positive semidefinite");
        let isometry = [(0.0, 0.0), (2.0, 0.0), (0.0, 1.0)].map(|(x, y)| Complex64::new(x, y));
        let det = -2.0 * Complex64::I * 2.0;
        let (b, c) = (isometry[2].conj() / det, -isometry[1].conj() / det);
        let triangle = Triangle { areas: 0.2, corner, coefficient: [-(b + c), b, c], weight };
        let slopes = triangle.derivatives(&isometry).0;
        assert!(slopes.iter().all(|slope| slope.abs() < 1e-12), "nothing is to be gained at an isometry: {slopes:?}");
    }

    #[test]
    fn a_flat_sheet_that_was_bent_in_the_plane_becomes_an_isometry_again() {
        let (flattened, _) = relaxation(&shapes::disk(300), &[], 0.1);
        let Flattened { mesh, metric, mut layout, .. } = flattened;
        layout.position.iter_mut().for_each(|z| *z = Complex64::new(z.re + 0.3 * z.im * z.im, 1.7 * z.im + 0.2 * z.re));
        let mut relaxation = Relaxation::new(&mesh, &metric, &layout, 0.1).unwrap();
        let mut steps = 0;
        while let Some(direction) = relaxation.direction(Watch::NONE).unwrap() {
            let (_, step) = relaxation.step(&direction, 1.0).expect("downhill");
            let goes_on = relaxation.take(step);
            steps += 1;
            if !goes_on {
                break;
            }
        }
        assert!(steps < 30, "{steps}");
        assert!((relaxation.energy - 1.2).abs() < 1e-3, "{} where an isometry has 1.2", relaxation.energy);
        layout.position = relaxation.position();
        for h in mesh.halfedges() {
            let length = (layout.corner(mesh.next(h)) - layout.corner(h)).norm() * relaxation.scale;
            assert!((length / metric.length(mesh.edge(h))).ln().abs() < 0.1, "{length}");
        }
    }

    #[test]
    fn what_is_in_the_way_of_a_step_is_turned_over_before_its_end() {
        let (_, mut relaxation) = relaxation(&shapes::hare(500), &[20, 90, 170, 240], 0.05);
        let direction = relaxation.direction(Watch::NONE).unwrap().expect("something is to be gained");
        assert!(relaxation.in_the_way(&direction, 1e-6).is_empty());
        let is_turned_over = |triangle: &Triangle, t: f64| {
            let moved: Vec<Complex64> =
                relaxation.position.iter().zip(&direction.step).map(|(p, d)| p + t * d).collect();
            let [p, q] = triangle.jacobian(&moved);
            p.norm() <= q.norm()
        };
        let mut met = 0;
        for length in [2.0, 8.0, 32.0] {
            let found = relaxation.in_the_way(&direction, length);
            for triangle in relaxation.triangles.iter().step_by(7) {
                let corners = found.as_chunks::<3>().0;
                // It may turn over and back again between two of these.
                if (1..40).any(|k| is_turned_over(triangle, length * f64::from(k) / 40.0)) {
                    assert!(corners.contains(&triangle.corner), "{length}");
                    met += 1;
                }
            }
        }
        assert!(met > 10, "{met}");
    }

    #[test]
    fn what_is_held_stays_where_it_is_and_nothing_is_turned_over() {
        let (Flattened { mesh, layout, .. }, mut relaxation) =
            relaxation(&shapes::hare(500), &[20, 90, 170, 240], 0.05);
        let held: Vec<usize> = (0..layout.position.len()).step_by(3).collect();
        assert!(held.iter().all(|&wedge| relaxation.hold(wedge)) && !relaxation.hold(held[0]));
        let first = relaxation.energy;
        for _ in 0..5 {
            let Some(direction) = relaxation.direction(Watch::NONE).unwrap() else { break };
            let Some((_, step)) = relaxation.step(&direction, 1.0) else { break };
            relaxation.take(step);
        }
        assert!(relaxation.energy < 0.99 * first, "{} {first}", relaxation.energy);
        let position = relaxation.position();
        for &wedge in &held {
            assert!((position[wedge] - layout.position[wedge]).norm() < 1e-12 * position[wedge].norm().max(1.0));
        }
        for f in mesh.faces() {
            let [a, b, c] = mesh.sides(f).map(|h| position[layout.cut.wedge(h).index()]);
            assert!(((b - a).conj() * (c - a)).im > 0.0);
        }
    }
}
