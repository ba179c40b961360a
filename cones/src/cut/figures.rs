//! What seams are like.

use std::f64::consts::PI;

use geom::{EdgeId, HalfedgeId, Mesh, Metric, Surface};

use super::cost::bend;
use super::turning::Turning;
use crate::flatten::{Chain, Layout, Seams};

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
    /// The sum over their edges, each times its length, of the difference of the lengths of both sides in the plane over their mean.
    pub mismatch: f64,
}

impl SeamFigures {
    /// Of the seams of one surface; of their sides nothing is known. O(seam edges).
    #[doc(hidden)] // Seams are nothing that users of the library have; this is for what `internals` is for.
    pub fn new(surface: &Surface, metric: &Metric, seams: &Seams) -> Self {
        let length = seams.length / surface.scale;
        Self { length, ..Self::of_chains(surface, metric, &seams.chains) }
    }

    /// The same with what is to be said of the sides that seams have in a layout. O(edges).
    pub(crate) fn laid_out(surface: &Surface, metric: &Metric, seams: &Seams, layout: &Layout) -> Self {
        let mesh = &surface.mesh;
        let length = |h: HalfedgeId| (layout.corner(mesh.next(h)) - layout.corner(h)).norm();
        let cut = mesh.edges().filter(|&e| seams.cut[e]);
        let mismatch = mismatch(mesh, metric, cut, length) / surface.scale;
        Self { mismatch, ..Self::new(surface, metric, seams) }
    }

    /// Of chains, with what is to be said of their sides in a map that has a position for each of the model's corners. O(edges).
    pub(crate) fn of_mapped_chains(surface: &Surface, metric: &Metric, chains: &[Chain], uv: &[[f64; 2]]) -> Self {
        let mesh = &surface.mesh;
        let at = |h: HalfedgeId| uv[surface.corner[h] as usize];
        let length = |h: HalfedgeId| {
            let ([a, b], [c, d]) = (at(h), at(mesh.next(h)));
            (c - a).hypot(d - b)
        };
        let edges = chains.iter().flat_map(|chain| chain.edges.iter().copied());
        let mismatch = mismatch(mesh, metric, edges, length) / surface.scale;
        Self { mismatch, ..Self::of_chains(surface, metric, chains) }
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
            mismatch: 0.0,
        }
    }

    /// How much they turn for their length: 0 for none.
    pub fn turning_per_length(&self) -> f64 {
        if self.length > 0.0 { self.turning / self.length } else { 0.0 }
    }

    /// By how much the lengths of both sides differ in the plane, over their mean, on average: 0 where all seams are rigid, or for none.
    pub fn mean_mismatch(&self) -> f64 {
        if self.length > 0.0 { self.mismatch / self.length } else { 0.0 }
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
        self.mismatch += other.mismatch;
    }
}

/// By how much the two sides of edges differ in the length that each has, weighted by the length in space.
fn mismatch(
    mesh: &Mesh,
    metric: &Metric,
    edges: impl Iterator<Item = EdgeId>,
    length: impl Fn(HalfedgeId) -> f64,
) -> f64 {
    let of_edge = |e: EdgeId| {
        let h = mesh.halfedge(e);
        let sides = [length(h), length(mesh.twin(h)?)];
        let sum = sides[0] + sides[1];
        (sum > 0.0).then(|| metric.length(e) * (sides[0] - sides[1]).abs() / (0.5 * sum))
    };
    edges.filter_map(of_edge).sum()
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
