//! What seams are like.

use std::f64::consts::PI;

use geom::{Mesh, Metric, Surface};

use super::cost::bend;
use super::turning::Turning;
use crate::flatten::{Chain, Seams};

/// An edge is sharp if its triangles' normals have a larger angle between them.
const SHARP: f64 = 30.0 * PI / 180.0;

/// What a model's seams are like. Sums, so that those of parts add up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SeamFigures {
    /// How long they are in all, in the model's units.
    pub length: f64,
    /// How long they are where edges bend by more than 30°.
    pub sharp: f64,
    /// The sum of the angles by which they turn from edge to edge, in radians: exterior angles along the surface, without
    /// corners where seams meet or end.
    pub turning: f64,
}

impl SeamFigures {
    /// Of the seams of one surface. O(seam edges).
    pub fn new(surface: &Surface, metric: &Metric, seams: &Seams) -> Self {
        let length = seams.length / surface.scale;
        Self { length, ..Self::of_chains(surface, metric, &seams.chains) }
    }

    /// Of chains. O(edges).
    pub(crate) fn of_chains(surface: &Surface, metric: &Metric, chains: &[Chain]) -> Self {
        let Surface { mesh, points, .. } = surface;
        let edges = || chains.iter().flat_map(|chain| chain.edges.iter().copied());
        let size = surface.scale.recip();
        Self {
            length: size * edges().map(|e| metric.length(e)).sum::<f64>(),
            sharp: size * edges().filter(|&e| bend(mesh, points, e) > SHARP).map(|e| metric.length(e)).sum::<f64>(),
            turning: chains.iter().map(|chain| turning(mesh, metric, chain)).sum(),
        }
    }

    /// How much they turn for their length: 0 for none.
    pub fn turning_per_length(&self) -> f64 {
        if self.length > 0.0 { self.turning / self.length } else { 0.0 }
    }

    /// The share of their length that is on sharp edges: 0 for none.
    pub fn sharp_share(&self) -> f64 {
        if self.length > 0.0 { self.sharp / self.length } else { 0.0 }
    }
}

impl std::ops::AddAssign for SeamFigures {
    fn add_assign(&mut self, other: Self) {
        self.length += other.length;
        self.sharp += other.sharp;
        self.turning += other.turning;
    }
}

/// By how much a chain turns between its ends.
fn turning(mesh: &Mesh, metric: &Metric, chain: &Chain) -> f64 {
    let side = |k: usize| {
        let h = mesh.halfedge(chain.edges[k]);
        if mesh.tail(h) == chain.vertices[k] { Some(h) } else { mesh.twin(h) }
    };
    let turn = |k: usize| Some(Turning::once(mesh, metric, side(k - 1)?, side(k)?));
    (1..chain.edges.len()).filter_map(turn).sum()
}
