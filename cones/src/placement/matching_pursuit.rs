//! Sets of cones that grow one by one: orthogonal matching pursuit (Pati, Rezaiifar & Krishnaprasad 1993) on Green's
//! functions. Each step adds the vertex where the energy's gradient is steepest and fits all curvatures again.

use geom::{VertexData, VertexId};

use super::energy_model::{ConeSet, EnergyModel};
use super::separation::Separation;
use super::swap_table::Nearness;

/// How the next cone is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// Where the gradient |r| is largest.
    Gradient,
    /// Where the energy falls most, by r²/s with the norm s estimated, within the bounds.
    Gain,
}

/// The first cones: at the lowest point of φ where the surface needs positive curvature, at the highest where it needs
/// negative, at both on a torus, none with a boundary; at most `count`.
pub(crate) fn start(model: &mut EnergyModel, count: usize) -> ConeSet {
    let mut cones = Vec::new();
    if let Some(total) = model.total() {
        let (low, high) = extremes(model.flattening());
        cones = match total {
            t if t > 1.0 => vec![low],
            t if t < -1.0 => vec![high],
            _ => vec![low, high],
        };
        cones.dedup();
        cones.truncate(count);
    }
    model.add(&cones);
    model.fit(&cones)
}

fn extremes(field: &VertexData<f64>) -> (VertexId, VertexId) {
    let mut extremes = [VertexId(0); 2];
    for (v, x) in field.iter_ids() {
        if *x < field[extremes[0]] {
            extremes[0] = v;
        }
        if *x > field[extremes[1]] {
            extremes[1] = v;
        }
    }
    extremes.into()
}

/// Adds cones until there are so many, or no vertex is left.
pub(crate) fn grow(model: &mut EnergyModel, mut set: ConeSet, count: usize, rule: Rule) -> ConeSet {
    let mut nearness = Nearness::default();
    while set.cones.len() < count && !model.is_stopped() {
        let Some(next) = steepest(model, &set, rule, &mut nearness) else { break };
        let mut cones = set.cones;
        cones.push(next);
        model.add(&[next]);
        set = model.fit(&cones);
    }
    set
}

/// Where the next cone should be.
fn steepest(model: &EnergyModel, set: &ConeSet, rule: Rule, nearness: &mut Nearness) -> Option<VertexId> {
    let separation = Separation::new(model.operators(), &set.cones);
    let gradient = gradient(model, set);
    let score: VertexData<f64> = match rule {
        Rule::Gradient => gradient.iter().map(|r| r.abs()).collect(),
        Rule::Gain => {
            let norms = nearness.norms(model, set);
            let gain = |(v, r): (VertexId, &f64)| {
                let [low, high] = model.bounds(v, set.cones.len() + 1);
                let t = (-r / norms[v].max(f64::MIN_POSITIVE)).clamp(low, high);
                -t * (2.0 * r + t * norms[v])
            };
            gradient.iter_ids().map(gain).collect()
        }
    };
    let open = score.iter_ids().filter(|(v, _)| separation.admits_another(*v));
    open.max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0))).map(|(v, _)| v)
}

/// r = b + H q + λ at every vertex.
pub(crate) fn gradient(model: &EnergyModel, set: &ConeSet) -> VertexData<f64> {
    let mut gradient: VertexData<f64> = model.linear().iter().map(|b| b + set.multiplier).collect();
    for (column, &q) in model.columns(&set.cones).into_iter().zip(&set.curvature) {
        gradient.iter_mut().zip(column).for_each(|(r, &h)| *r += q * f64::from(h));
    }
    gradient
}
