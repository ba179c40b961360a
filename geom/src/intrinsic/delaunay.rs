//! Intrinsic Delaunay triangulations, by flips.
//!
//! An edge is Delaunay when the two angles opposite it sum to at most π, that is when their cosines sum to at least 0.
//! Flipping what is not ends in the intrinsic Delaunay triangulation of the same surface (Bobenko & Springborn 2007),
//! where the cotangent Laplacian has no negative weights. Two kinds of flip:
//! - *Euclidean*: the surface stays, and the new edge is the other diagonal of the unfolded quad;
//! - *Ptolemaic*: for a metric that is to be scaled conformally, the new length is the one that Ptolemy's relation gives
//!   (`l_kl l_ij = l_jk l_il + l_ki l_lj`), so that the discrete conformal class stays (Springborn 2020; Gillespie,
//!   Springborn & Crane 2021). On a Delaunay edge of the scaled metric the two agree, the quad being cyclic.
//!
//! Flips are logged by halfedge, so that they can be undone.

use super::laplacian::weights_by;
use super::metric::{Metric, Sides};
use crate::mesh::{EdgeData, EdgeId, HalfedgeId, Triangulation};
use crate::watch::Watch;

/// An edge counts as Delaunay down to this sum of cosines, lest a cocircular quad flip for ever.
pub(crate) const TOLERANCE: f64 = 1e-12;
/// An edge with a greater cotangent weight is Delaunay: far more than what rounding may add where the angles are at most π
/// in all.
const CLEAR: f64 = 0.01;

/// A mesh's surface with its intrinsic Delaunay triangulation.
#[derive(Clone, Debug)]
pub struct Intrinsic {
    /// The triangulation after the flips; edges keep their ids.
    pub triangulation: Triangulation,
    /// Its edge lengths.
    pub metric: Metric,
    /// What was flipped, in order ([`Triangulation::flip`]).
    pub flips: Vec<HalfedgeId>,
}

/// The intrinsic Delaunay triangulation of a surface. O(E) for surfaces met in practice.
///
/// ```
/// # use geom::{Mesh, Metric, delaunay};
/// let mesh = Mesh::new(4, &[[0, 1, 2], [0, 3, 1]])?;
/// let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, -1.0, 0.0]];
/// let intrinsic = delaunay(&mesh, &Metric::from_points(&mesh, &points));
/// assert_eq!(intrinsic.flips.len(), 1);
/// # Ok::<(), geom::MeshError>(())
/// ```
pub fn delaunay(triangulation: &Triangulation, metric: &Metric) -> Intrinsic {
    delaunay_watched(triangulation, metric, Watch::NONE)
}

/// [`delaunay`], watched. Stopped, it returns a triangulation of the same surface that is not Delaunay everywhere.
pub fn delaunay_watched(triangulation: &Triangulation, metric: &Metric, watch: Watch) -> Intrinsic {
    let mut triangulation = triangulation.clone();
    let mut metric = metric.clone();
    let mut flips = Vec::new();
    flip_to_delaunay(&mut triangulation, &mut metric, &mut flips, watch, |length, e, quad| {
        length[e] = other_diagonal(length[e], quad.map(|side| length[side]));
    });
    Intrinsic { triangulation, metric, flips }
}

/// Makes the metric that is `metric` scaled by `u` Delaunay through Ptolemaic flips: `triangulation` and `metric` are
/// changed alike, flips are added to the log, and the scaled metric is returned.
pub fn ptolemaic_delaunay(
    triangulation: &mut Triangulation,
    metric: &mut Metric,
    u: &[f64],
    flips: &mut Vec<HalfedgeId>,
) -> Metric {
    ptolemaic_delaunay_watched(triangulation, metric, u, flips, Watch::NONE)
}

/// [`ptolemaic_delaunay`], watched. Stopped, it leaves a triangulation and a metric of the same discrete conformal class, with
/// the log of all flips, which scaled is not Delaunay everywhere.
pub fn ptolemaic_delaunay_watched(
    triangulation: &mut Triangulation,
    metric: &mut Metric,
    u: &[f64],
    flips: &mut Vec<HalfedgeId>,
    watch: Watch,
) -> Metric {
    let mut scaled = metric.scaled(triangulation, u);
    flip_to_delaunay(triangulation, &mut scaled, flips, watch, |scaled, e, quad| {
        for length in [scaled, metric.lengths_mut()] {
            length[e] = ptolemy(length[e], quad.map(|side| length[side]));
        }
    });
    scaled
}

/// Flips edges until each one is Delaunay. `set_diagonal` gives a flipped edge its new length from the sides of its quad,
/// in the order jk, ki, il, lj.
fn flip_to_delaunay(
    triangulation: &mut Triangulation,
    metric: &mut Metric,
    flips: &mut Vec<HalfedgeId>,
    watch: Watch,
    mut set_diagonal: impl FnMut(&mut EdgeData<f64>, EdgeId, [EdgeId; 4]),
) {
    if watch.stops_at(0.0) {
        return;
    }
    let mut queued = suspects(triangulation, metric);
    let mut queue: Vec<EdgeId> = triangulation.edges().rev().filter(|&e| queued[e]).collect();
    // How far the queue will grow again is not known: its least length tells how far the work is.
    let (first_length, mut least_length) = (queue.len(), queue.len());
    let mut looked_at = 0;
    let length = metric.lengths_mut();
    // The flips of a Delaunay triangulation end in exact arithmetic; on needles rounding may disagree.
    let mut budget = 64 * triangulation.edge_count() + 1024;
    while let Some(e) = queue.pop() {
        looked_at += 1;
        least_length = least_length.min(queue.len());
        if looked_at % 4096 == 0 && watch.stops_at(1.0 - least_length as f64 / first_length as f64) {
            return;
        }
        queued[e] = false;
        if budget == 0 || !triangulation.is_flippable(e) {
            continue;
        }
        let h = triangulation.halfedge(e);
        let quad = quad(triangulation, h);
        let [jk, ki, il, lj] = quad;
        if opposite_cosines(length[e], [length[jk], length[ki], length[il], length[lj]]) >= -TOLERANCE {
            continue;
        }
        budget -= 1;
        set_diagonal(length, e, quad);
        triangulation.flip(h);
        flips.push(h);
        for side in quad {
            if !std::mem::replace(&mut queued[side], true) {
                queue.push(side);
            }
        }
    }
}

/// The edges that may not be Delaunay, by their cotangent weights: going through the triangles costs less than looking at
/// each edge's quad.
fn suspects(triangulation: &Triangulation, metric: &Metric) -> EdgeData<bool> {
    // Triangles that violate the triangle inequality have no cotangents, and an edge that must be flipped.
    let cotangents = |sides: Sides| if sides.area() > 0.0 { sides.cotangents() } else { [f64::NEG_INFINITY; 3] };
    let weights = weights_by(triangulation, metric, cotangents);
    weights.iter().map(|weight| weight.is_nan() || *weight < CLEAR).collect()
}

/// The edges jk, ki, il, lj round the edge ij of a halfedge (k left of it, l right).
pub(super) fn quad(triangulation: &Triangulation, h: HalfedgeId) -> [EdgeId; 4] {
    let g = triangulation.twin(h).expect("only inner edges are flipped");
    let [a, b, c, d] = [triangulation.next(h), triangulation.prev(h), triangulation.next(g), triangulation.prev(g)];
    [triangulation.edge(a), triangulation.edge(b), triangulation.edge(c), triangulation.edge(d)]
}

/// Twice the sum of the cosines of the two angles opposite an edge of length `ij`.
pub(crate) fn opposite_cosines(ij: f64, [jk, ki, il, lj]: [f64; 4]) -> f64 {
    let twice_cosine = |p: f64, q: f64| (p * p + q * q - ij * ij) / (p * q);
    let sum = twice_cosine(jk, ki) + twice_cosine(il, lj);
    // A side of length zero: nothing to gain from a flip.
    if sum.is_finite() { sum } else { 0.0 }
}

/// The length of the other diagonal of the quad unfolded into the plane.
pub(crate) fn other_diagonal(ij: f64, [jk, ki, il, lj]: [f64; 4]) -> f64 {
    let apex = |sides: [f64; 3]| {
        let [_, _, back] = Sides(sides).unfold();
        [-back[0], -back[1]]
    };
    let k = apex([ij, jk, ki]);
    let l = apex([ij, lj, il]);
    (k[0] - l[0]).hypot(k[1] + l[1])
}

/// The length that Ptolemy's relation gives to the other diagonal.
pub(super) fn ptolemy(ij: f64, [jk, ki, il, lj]: [f64; 4]) -> f64 {
    (jk * il + ki * lj) / ij
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intrinsic::laplacian::edge_weights;
    use crate::mesh::Mesh;

    /// A bumpy sphere of slivers: poles and stretched rings.
    fn slivers() -> (Mesh, Vec<[f64; 3]>) {
        let (rings, segments) = (7u32, 9u32);
        let mut points = vec![[0.0, 0.0, 1.0]];
        for r in 1..=rings {
            for s in 0..segments {
                let polar = std::f64::consts::PI * f64::from(r * r) / f64::from((rings + 1) * (rings + 1));
                let around = std::f64::consts::TAU * (f64::from(s) + 0.4 * f64::from(r)) / f64::from(segments);
                points.push([polar.sin() * around.cos(), 0.2 * polar.sin() * around.sin(), polar.cos()]);
            }
        }
        points.push([0.0, 0.0, -1.0]);
        let last = points.len() as u32 - 1;
        let at = |r: u32, s: u32| 1 + (r - 1) * segments + s % segments;
        let mut faces = Vec::new();
        for s in 0..segments {
            faces.push([0, at(1, s), at(1, s + 1)]);
            faces.push([last, at(rings, s + 1), at(rings, s)]);
            for r in 1..rings {
                faces.push([at(r, s), at(r + 1, s), at(r + 1, s + 1)]);
                faces.push([at(r, s), at(r + 1, s + 1), at(r, s + 1)]);
            }
        }
        (Mesh::new(points.len(), &faces).unwrap(), points)
    }

    #[test]
    fn delaunay_weights_are_not_negative_and_curvature_and_area_stay() {
        let (mesh, points) = slivers();
        let metric = Metric::from_points(&mesh, &points);
        assert!(edge_weights(&mesh, &metric).iter().any(|&w| w < -0.1));
        let intrinsic = delaunay(&mesh, &metric);
        intrinsic.triangulation.check();
        assert!(edge_weights(&intrinsic.triangulation, &intrinsic.metric).iter().all(|&w| w > -1e-9));
        let before = metric.angle_sums(&mesh);
        let after = intrinsic.metric.angle_sums(&intrinsic.triangulation);
        for v in mesh.vertices() {
            assert!((before[v] - after[v]).abs() < 1e-11);
        }
        let ratio = intrinsic.metric.area(&intrinsic.triangulation) / metric.area(&mesh);
        assert!((ratio - 1.0).abs() < 1e-12);
    }

    #[test]
    fn ptolemaic_flips_leave_the_conformal_class() {
        // Scaling by u, flipping, and scaling back gives lengths that again scale to the same Delaunay metric.
        let (mesh, points) = slivers();
        let intrinsic = delaunay(&mesh, &Metric::from_points(&mesh, &points));
        let u: Vec<f64> = (0..mesh.vertex_count()).map(|v| ((v * 37) % 11) as f64 / 8.0).collect();
        let (mut triangulation, mut metric) = (intrinsic.triangulation, intrinsic.metric);
        let mut flips = Vec::new();
        let scaled = ptolemaic_delaunay(&mut triangulation, &mut metric, &u, &mut flips);
        assert!(!flips.is_empty());
        assert!(edge_weights(&triangulation, &scaled).iter().all(|&w| w > -1e-9));
        let again = metric.scaled(&triangulation, &u);
        for e in triangulation.edges() {
            assert!((again.length(e) / scaled.length(e) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn an_edge_beside_a_side_of_length_zero_is_left_alone() {
        let mesh = Mesh::new(4, &[[0, 1, 2], [0, 3, 1]]).unwrap();
        let metric = Metric::from_points(&mesh, &[[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3], [0.5, -0.1, 0.0]]);
        assert!(delaunay(&mesh, &metric).flips.is_empty());
    }

    #[test]
    fn stopped_flips_leave_a_valid_triangulation_of_the_same_surface() {
        let shape = crate::shapes::hare(12_000);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let u: Vec<f64> = (0..mesh.vertex_count()).map(|v| 1.5 * (v as f64 * 0.01).sin()).collect();
        let begin = delaunay(&mesh, &metric);
        let asked = std::sync::atomic::AtomicUsize::new(0);
        let at_the_third_question = |_: f64| match asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) {
            0..2 => std::ops::ControlFlow::Continue(()),
            _ => std::ops::ControlFlow::Break(()),
        };
        let (mut triangulation, mut changed, mut flips) = (begin.triangulation.clone(), begin.metric.clone(), vec![]);
        let watch = Watch::new(&at_the_third_question);
        ptolemaic_delaunay_watched(&mut triangulation, &mut changed, &u, &mut flips, watch);
        triangulation.check();
        let first = flips.len();
        let scaled = ptolemaic_delaunay(&mut triangulation, &mut changed, &u, &mut flips);
        assert!(0 < first && first < flips.len(), "stopped after {first} of {} flips", flips.len());
        assert!(edge_weights(&triangulation, &scaled).iter().all(|&w| w > -1e-9));
        flips.iter().rev().for_each(|&h| _ = triangulation.unflip(h));
        assert_eq!(triangulation, begin.triangulation);
    }
}
