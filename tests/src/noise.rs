//! How stable cones are under noise.
//!
//! Every vertex of a clean surface is moved at random: its displacement is Gaussian in each coordinate, with a root mean
//! square length of `strength` times the mean edge length h. A cone of the clean surface is *recovered* if a cone of the
//! noisy one is within 5 h of it, measured along the clean surface's edges. What the noisy surface's cones are worth is
//! judged where it counts, on the clean one: the L2 norm of the log scale factor that linear theory predicts there with
//! their best curvatures, over that of the clean cones. Noise moves cones of a flat optimum for nothing, so the second
//! figure says more than the first.

use std::f64::consts::TAU;

use cones::{Analysis, CurvatureRule, Error, Placement, Preparation};
use geom::{EdgeData, Mesh, Metric, Model, ShortestPaths, VertexId};

/// Cones within so many mean edge lengths count as the same.
const NEAR: f64 = 5.0;

/// A rule that chooses cones: a placement, and whether the curvature is diffused first.
pub type Rule = (Placement, bool);

/// All methods, and the two that read the extrema of φ also with diffused curvature, which changes nothing for the others.
pub const RULES: [Rule; 8] = [
    (Placement::Alternating, false),
    (Placement::Alternating, true),
    (Placement::Persistence, false),
    (Placement::Persistence, true),
    (Placement::Iterative, false),
    (Placement::Greedy, false),
    (Placement::Pursuit, false),
    (Placement::Refined, false),
];

/// What a rule's cones are after noise.
#[derive(Clone, Copy, Debug)]
pub struct Stability {
    /// The share of the clean surface's cones that are recovered.
    pub recovered: f64,
    /// The norm with the noisy surface's cones over that with the clean one's, on the clean surface.
    pub norm: f64,
}

impl Stability {
    /// The mean of shares, the geometric mean of norms.
    pub fn mean(of: &[Self]) -> Self {
        let count = of.len() as f64;
        let log: f64 = of.iter().map(|s| s.norm.ln()).sum();
        Self { recovered: of.iter().map(|s| s.recovered).sum::<f64>() / count, norm: (log / count).exp() }
    }
}

/// A clean surface with its cones by every rule.
#[derive(Debug)]
pub struct Clean {
    mesh: Mesh,
    points: Vec<[f64; 3]>,
    lengths: EdgeData<f64>,
    /// h
    mean_length: f64,
    analysis: Analysis,
    count: usize,
    cones: Vec<Vec<u32>>,
}

impl Clean {
    /// Chooses so many cones by each of [`RULES`].
    ///
    /// # Errors
    /// If a Laplacian cannot be factored.
    ///
    /// # Panics
    /// If the points are no model with this mesh.
    pub fn new(mesh: Mesh, points: Vec<[f64; 3]>, count: usize) -> Result<Self, Error> {
        let lengths = Metric::from_points(&mesh, &points).lengths().clone();
        let mean_length = lengths.iter().sum::<f64>() / mesh.edge_count() as f64;
        let model = model(&mesh, &points);
        let (analysis, cones) = (Analysis::new(&model)?, choose(&model, count)?);
        Ok(Self { mesh, points, lengths, mean_length, analysis, count, cones })
    }

    /// What each of [`RULES`] comes to under noise.
    ///
    /// # Errors
    /// If a Laplacian of the noisy surface cannot be factored.
    pub fn under_noise(&self, strength: f64, seed: u64) -> Result<Vec<Stability>, Error> {
        let mut random = Random(seed);
        let deviation = strength * self.mean_length / 3.0_f64.sqrt();
        let noisy: Vec<[f64; 3]> = self.points.iter().map(|p| p.map(|x| x + deviation * random.gaussian())).collect();
        let cones = choose(&model(&self.mesh, &noisy), self.count)?;
        let norm = |cones: &[u32]| -> Result<f64, Error> {
            Ok(self.analysis.predict(cones, CurvatureRule::Optimal)?.log_scale_norm)
        };
        let stability = |(clean, noisy): (&Vec<u32>, &Vec<u32>)| {
            Ok(Stability { recovered: self.recovered(clean, noisy), norm: norm(noisy)? / norm(clean)? })
        };
        self.cones.iter().zip(&cones).map(stability).collect()
    }

    fn recovered(&self, clean: &[u32], noisy: &[u32]) -> f64 {
        let paths = ShortestPaths::new(&self.mesh, &self.lengths, noisy.iter().map(|&v| (VertexId(v), 0)));
        let near = clean.iter().filter(|&&v| paths.distance[VertexId(v)] <= NEAR * self.mean_length).count();
        near as f64 / clean.len().max(1) as f64
    }
}

fn model(mesh: &Mesh, points: &[[f64; 3]]) -> Model {
    let triangles: Vec<[u32; 3]> = mesh.faces().map(|f| mesh.corners(f).map(|v| v.0)).collect();
    Model::from_triangles(points.to_vec(), &triangles).expect("a mesh with a point for each vertex")
}

/// The cones that each of [`RULES`] chooses.
fn choose(model: &Model, count: usize) -> Result<Vec<Vec<u32>>, Error> {
    let plain = Analysis::new(model)?;
    let smooth = Analysis::with(model, Preparation { smooth: true, ..Preparation::default() })?;
    let by_rule = |&(placement, is_smooth): &Rule| {
        let analysis = if is_smooth { &smooth } else { &plain };
        Ok(analysis.place(placement, count)?.iter().map(|cone| cone.vertex).collect())
    };
    RULES.iter().map(by_rule).collect()
}

/// Random numbers by `SplitMix64` (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    /// Between 0 and 1, neither of them.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + f64::EPSILON / 4.0
    }

    /// Of standard deviation 1 (Box and Muller 1958).
    fn gaussian(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_mean_zero_and_deviation_one() {
        let mut random = Random(5);
        let values: Vec<f64> = (0..100_000).map(|_| random.gaussian()).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        let square = values.iter().map(|x| x * x).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.02 && (square - 1.0).abs() < 0.02, "{mean} {square}");
    }

    #[test]
    fn without_noise_all_cones_are_recovered() {
        let shape = geom::shapes::hare(500);
        let clean = Clean::new(shape.mesh(), shape.points, 6).expect("a sound shape");
        for found in clean.under_noise(0.0, 1).expect("a sound shape") {
            assert!(found.recovered == 1.0 && (found.norm - 1.0).abs() < 1e-12);
        }
    }
}
