//! Sets of cones that grow one by one: orthogonal matching pursuit (Pati, Rezaiifar & Krishnaprasad 1993) on Green's
//! functions. Each step adds the vertex where the energy's gradient is steepest and fits all curvatures again.

use geom::{VertexData, VertexId};

use crate::crowd::Crowd;
use crate::reduced::{Fitted, Reduced};
use crate::swap::norms;

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
pub(crate) fn start(reduced: &mut Reduced, count: usize) -> Fitted {
    let mut cones = Vec::new();
    if let Some(total) = reduced.total() {
        let (low, high) = extremes(reduced.flattening());
        cones = match total {
            t if t > 1.0 => vec![low],
            t if t < -1.0 => vec![high],
            _ => vec![low, high],
        };
        cones.dedup();
        cones.truncate(count);
    }
    reduced.add(&cones);
    reduced.fit(&cones)
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
pub(crate) fn grow(reduced: &mut Reduced, mut set: Fitted, count: usize, rule: Rule) -> Fitted {
    while set.cones.len() < count {
        let Some(next) = steepest(reduced, &set, rule) else { break };
        let mut cones = set.cones;
        cones.push(next);
        reduced.add(&[next]);
        set = reduced.fit(&cones);
    }
    set
}

/// Where the next cone should be.
fn steepest(reduced: &Reduced, set: &Fitted, rule: Rule) -> Option<VertexId> {
    let crowd = Crowd::new(reduced.operators(), &set.cones);
    let gradient = gradient(reduced, set);
    let score: VertexData<f64> = match rule {
        Rule::Gradient => gradient.iter().map(|r| r.abs()).collect(),
        Rule::Gain => {
            let norms = norms(reduced, set);
            let gain = |(v, r): (VertexId, &f64)| {
                let [low, high] = reduced.bounds(v, set.cones.len() + 1);
                let t = (-r / norms[v].max(f64::MIN_POSITIVE)).clamp(low, high);
                -t * (2.0 * r + t * norms[v])
            };
            gradient.iter_ids().map(gain).collect()
        }
    };
    let open = score.iter_ids().filter(|(v, _)| crowd.admits_another(*v));
    open.max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0))).map(|(v, _)| v)
}

/// r = b + H q + λ at every vertex.
pub(crate) fn gradient(reduced: &Reduced, set: &Fitted) -> VertexData<f64> {
    let mut gradient: VertexData<f64> = reduced.linear().iter().map(|b| b + set.multiplier).collect();
    for (&cone, &q) in set.cones.iter().zip(&set.curvature) {
        gradient.iter_mut().zip(reduced.column(cone)).for_each(|(r, &h)| *r += q * f64::from(h));
    }
    gradient
}
