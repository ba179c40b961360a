//! Cones whose curvatures are multiples of one angle.
//!
//! Given cones with the best curvatures they can have, rounded ones cost the more the fewer and the nearer the cones are. Four
//! things in turn, on the energy model, until none helps: the best multiples for these places
//! ([`minimise_on_lattice`]); cones whose multiple is 0 go; each of the others goes where its own curvature does
//! best with the others as they are; and in the places of those that went come pairs of one step up and one down (a single one
//! with a boundary).
//!
//! Where a cone t goes from v to w the energy changes by 2 t (r(w) - r(v)) + t² (`H_ww` - `H_vv`), r the residual b + H q
//! without the cone itself. What is not known without solving for w is `H_ww`; it varies little, so that w is looked for as if
//! it were `H_vv`, and the change with the true one decides.

use geom::{Interrupted, VertexId};

use super::Ground;
use super::energy_model::EnergyModel;
use super::separation::Separation;
use crate::curvature::{CurvatureError, least_cones};
use crate::numerics::lattice::minimise_on_lattice;
use crate::numerics::quadratic_program::{ProgramError, Quadratic};

/// So often all is tried in turn, at most.
const ROUNDS: usize = 6;
/// A move must lower the energy by this share.
const LEAST_GAIN: f64 = 1e-3;

/// Cones with multiples of an angle.
#[derive(Clone, Debug)]
struct Lattice {
    cones: Vec<VertexId>,
    multiples: Vec<i32>,
    energy: f64,
}

/// Cones with curvatures that are multiples of `step`, which a whole number of makes a turn; as many as were given at most. They are
/// moved and replaced where `is_free`, else only left out. Two solves for each place that is tried.
///
/// # Errors
/// If so few cones cannot take the surface's curvature in such steps, or the watch has said stop.
pub(crate) fn quantized(
    ground: Ground,
    cones: &[VertexId],
    step: f64,
    is_free: bool,
) -> Result<(Vec<VertexId>, Vec<f64>), CurvatureError> {
    let model = ground.energy_model()?;
    let mut search = Search { ground, model, step, most: cones.len() };
    let mut best = search.rounded(cones)?;
    for _ in 0..if is_free { ROUNDS } else { 0 } {
        let mut next = best.clone();
        search.move_each(&mut next);
        search.fill(&mut next);
        ground.watch.ask(f64::NAN).map_err(CurvatureError::Interrupted)?;
        let next = search.rounded(&next.cones)?;
        if next.energy > (1.0 - LEAST_GAIN) * best.energy {
            break;
        }
        best = next;
    }
    let curvature = best.multiples.iter().map(|&k| f64::from(k) * step).collect();
    Ok((best.cones, curvature))
}

struct Search<'a> {
    ground: Ground<'a>,
    model: EnergyModel<'a>,
    step: f64,
    /// So many cones there may be.
    most: usize,
}

impl Search<'_> {
    /// The best multiples for these cones; those with none left out.
    fn rounded(&mut self, cones: &[VertexId]) -> Result<Lattice, CurvatureError> {
        self.model.add(cones);
        if self.model.is_stopped() {
            return Err(CurvatureError::Interrupted(Interrupted));
        }
        let bounds: Vec<[f64; 2]> = cones.iter().map(|&v| self.model.bounds(v, cones.len())).collect();
        let (linear, matrix) = self.terms(cones);
        let energy = Quadratic { constant: self.model.constant(), linear: &linear, matrix: &matrix };
        let multiples = minimise_on_lattice(&energy, &bounds, self.model.total(), self.step).map_err(|error| {
            let operators = self.ground.operators;
            match error {
                ProgramError::Infeasible { .. } => CurvatureError::TooFew {
                    cones: cones.len(),
                    total: operators.total_curvature(),
                    least: least_cones(operators).max(cones.len() + 1),
                },
                _ => CurvatureError::NotFinite { cones: cones.len() },
            }
        })?;
        let kept: Vec<usize> = (0..cones.len()).filter(|&i| multiples[i] != 0).collect();
        let mut set = Lattice {
            cones: kept.iter().map(|&i| cones[i]).collect(),
            multiples: kept.iter().map(|&i| multiples[i]).collect(),
            energy: 0.0,
        };
        set.energy = self.energy(&set);
        Ok(set)
    }

    /// b and H of cones.
    fn terms(&self, cones: &[VertexId]) -> (Vec<f64>, Vec<f64>) {
        let linear = cones.iter().map(|&v| self.model.linear()[v]).collect();
        let product = |&v: &VertexId| cones.iter().map(move |&x| self.model.product(v, x));
        (linear, cones.iter().flat_map(product).collect())
    }

    fn energy(&self, set: &Lattice) -> f64 {
        let (linear, matrix) = self.terms(&set.cones);
        let curvatures: Vec<f64> = set.multiples.iter().map(|&k| f64::from(k) * self.step).collect();
        Quadratic { constant: self.model.constant(), linear: &linear, matrix: &matrix }.value(&curvatures)
    }

    /// r: what half of the energy's gradient would be at each vertex.
    fn residual(&self, set: &Lattice) -> Vec<f64> {
        let mut residual = self.model.linear().to_vec();
        for (&v, &k) in set.cones.iter().zip(&set.multiples) {
            let q = f64::from(k) * self.step;
            residual.iter_mut().zip(self.model.column(v)).for_each(|(r, h)| *r += q * f64::from(*h));
        }
        residual
    }

    /// Takes a set where it has less energy; its cones are solved for first.
    fn take(&mut self, set: &mut Lattice, mut other: Lattice) {
        self.model.add(&other.cones);
        other.energy = self.energy(&other);
        if !self.model.is_stopped() && other.energy < (1.0 - LEAST_GAIN) * set.energy {
            *set = other;
        }
    }

    /// Moves one cone after the other.
    fn move_each(&mut self, set: &mut Lattice) {
        for i in 0..set.cones.len() {
            let (v, t) = (set.cones[i], f64::from(set.multiples[i]) * self.step);
            let residual = self.residual(set);
            let column = self.model.column(v);
            let cost = |w: VertexId| 2.0 * t * (residual[w.0 as usize] - t * f64::from(column[w.0 as usize]));
            let separation = Separation::new(self.ground.operators, &set.cones);
            let may_go = |w: &VertexId| separation.admits(*w, i) && self.model.lowest(*w) <= t;
            let best =
                self.ground.operators.mesh.vertices().filter(may_go).min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
            if let Some(w) = best.filter(|&w| w != v) {
                let mut other = set.clone();
                other.cones[i] = w;
                self.take(set, other);
            }
        }
    }

    /// Adds cones of one step each, as long as they help and there may be more.
    fn fill(&mut self, set: &mut Lattice) {
        loop {
            let before = set.cones.len();
            let is_closed = self.model.total().is_some();
            if before + if is_closed { 2 } else { 1 } > self.most {
                return;
            }
            let residual = self.residual(set);
            let separation = Separation::new(self.ground.operators, &set.cones);
            let place = |sign: i32| {
                let may_come = |w: &VertexId| {
                    separation.admits_another(*w) && self.model.lowest(*w) <= f64::from(sign) * self.step
                };
                let cost = |w: VertexId| f64::from(sign) * residual[w.0 as usize];
                let mesh = &self.ground.operators.mesh;
                let best = mesh.vertices().filter(may_come).min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
                best.map(|w| (w, sign))
            };
            let [up, down] = [1, -1].map(place);
            let sets: Vec<Vec<(VertexId, i32)>> = match (up, down) {
                (Some(up), Some(down)) if is_closed => vec![vec![up, down]],
                (up, down) if !is_closed => [up, down].into_iter().flatten().map(|one| vec![one]).collect(),
                _ => return,
            };
            for more in sets {
                if set.cones.len() > before {
                    break;
                }
                let mut other = set.clone();
                for (w, sign) in more {
                    other.cones.push(w);
                    other.multiples.push(sign);
                }
                self.take(set, other);
            }
            if set.cones.len() == before {
                return;
            }
        }
    }
}
