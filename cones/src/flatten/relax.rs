//! Bent triangles of a layout relaxed: nearer to conformal, without moving anything else.
//!
//! The flat metric is conformal on its own triangles, which are Delaunay. The input's triangles are not: a needle that reaches
//! across many of those is mapped linearly all the same, and what its straight sides cut off bends the angles of its neighbours. On
//! a CAD part some percent of the area are so bent by more than a factor of two, and make up most of the mean. So patches round
//! triangles with a large σ₁/σ₂ are relaxed by what untangling minimises once nothing is flipped, Σ w |J|² / 2 det J
//! ([`untangle`](super::untangle)): rims and cones stay where they are and seams stay rigid, so that the map around is as it was.
//!
//! A patch is only taken if it measures better than before, its angles and areas together: untangling's reference shapes are no
//! thinner than one in a thousand, needles in space are.

use geom::{FaceId, Mesh, Metric, Sides, Watch};
use num_complex::Complex64;

use super::fold_over::{Fixed, Untangler};
use super::layout::Layout;
use super::scaling::Scaling;

/// Triangles with a larger σ₁/σ₂ are relaxed. Even triangles have that at a few cones only.
pub(crate) const BENT: f64 = 1.5;
/// Nothing is to be relaxed where no larger share of the area is bent: on even triangles it is a few at cones.
pub(crate) const MOST_BENT: f64 = 0.01;
/// What is relaxed reaches so many rings round them.
const RINGS: usize = 2;
/// So often: what was bent by a rim that was in the way is inside the next time.
const ROUNDS: usize = 3;
/// σ₁/σ₂ counts up to here, so that one needle does not outweigh a patch.
const WORST: f64 = 1e3;

/// σ₁/σ₂ of the linear map that takes a triangle with given sides to given corners, and by what it multiplies the area; none where
/// the triangle has no area.
pub(crate) fn stretch(sides: Sides, [a, b, c]: [Complex64; 3]) -> Option<[f64; 2]> {
    let [along, _, back] = sides.unfold().map(|[x, y]| Complex64::new(x, y));
    // The map z ↦ p z + q z̄ takes both sides at the first corner to their images.
    let (z, w) = (along, -back);
    let determinant = z * w.conj() - w * z.conj();
    let has_area = sides.area() > 0.0 && determinant.norm() > 0.0; // not so with NaN either
    has_area.then(|| {
        let p = ((b - a) * w.conj() - (c - a) * z.conj()) / determinant;
        let q = (z * (c - a) - w * (b - a)) / determinant;
        let stretch = (p.norm() + q.norm()) / (p.norm() - q.norm()).abs().max(f64::MIN_POSITIVE);
        [stretch, (p.norm_sqr() - q.norm_sqr()).abs().max(f64::MIN_POSITIVE)]
    })
}

/// Relaxes what is bent in a layout, in place; returns the number of triangles in patches that became better.
pub(crate) fn relax(
    input: &Mesh,
    metric: &Metric,
    scaling: &Scaling,
    fixed: &Fixed,
    layout: &mut Layout,
    watch: Watch,
) -> usize {
    let areas = || input.faces().map(|f| (f, metric.sides(input, f).area()));
    let whole: f64 = areas().map(|(_, area)| area).sum();
    let covered = |layout: &Layout| -> f64 {
        let ratio = |f: FaceId| stretch(metric.sides(input, f), input.sides(f).map(|h| layout.corner(h)));
        areas().filter_map(|(f, area)| ratio(f).map(|[_, ratio]| area * ratio)).sum()
    };
    let mean = covered(layout) / whole;
    let cost = |layout: &Layout, faces: &[FaceId]| -> f64 {
        let of_face = |&f: &FaceId| {
            let sides = metric.sides(input, f);
            let [stretch, ratio] = stretch(sides, input.sides(f).map(|h| layout.corner(h)))?;
            let ratio = ratio / mean;
            Some(sides.area() * (stretch.min(WORST) + ratio.max(ratio.recip()).min(WORST)))
        };
        faces.iter().filter_map(of_face).sum()
    };
    let is_bent = |layout: &Layout, f: FaceId| {
        let corners = input.sides(f).map(|h| layout.corner(h));
        stretch(metric.sides(input, f), corners).is_some_and(|[stretch, _]| stretch > BENT)
    };
    let Ok(mut untangler) = Untangler::new(input, metric, scaling, fixed, layout, watch) else { return 0 };
    let mut relaxed = 0;
    for _ in 0..ROUNDS {
        let bent: Vec<FaceId> = input.faces().filter(|&f| is_bent(untangler.layout(), f)).collect();
        let before = relaxed;
        for piece in untangler.pieces(&bent, RINGS) {
            relaxed += untangler.improve(&piece, |layout| cost(layout, &piece), watch);
        }
        if relaxed == before || watch.stops_at(f64::NAN) {
            break;
        }
    }
    relaxed
}
