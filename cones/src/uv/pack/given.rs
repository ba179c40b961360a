//! Islands as they lie, scaled and moved as a whole: what a packing has to be better than.

use geom::{Interrupted, Watch};
use num_complex::Complex64;
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, PointDistance, RTree};

use super::super::overlap::overlaps_watched;
use super::super::triangle::Triangle;
use super::arrangement::Arrangement;
use super::island_place::IslandPlace;
use super::outline::Outline;

/// Islands may be nearer than the margin by this share of the square's side, or reach into each other by it: files round.
const ROUNDING: f64 = 1e-6;

/// A side of an outline, and its island.
type Side = GeomWithData<Line<[f64; 2]>, u32>;

/// All islands in the smallest upright square about them, margins being the `share` of its side; none where that is nothing.
pub(super) fn as_given(outlines: &[Outline], unit: f64, share: f64) -> Option<Arrangement> {
    let points = || outlines.iter().flat_map(|outline| outline.edges.iter().flatten().map(|z| at(outline, *z, unit)));
    let [low, high] = points().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[0, 1].map(|k| low[k].min(p[k])), [0, 1].map(|k| high[k].max(p[k]))]
    });
    let side = (high[0] - low[0]).max(high[1] - low[1]) / (1.0 - share);
    let border = 0.5 * share * side;
    let place = |outline: &Outline| {
        let from = outline.centre;
        let to = [0, 1].map(|k| from[k] + (border - low[k]) * unit);
        IslandPlace { from, to, ..IslandPlace::NONE }
    };
    let places = outlines.iter().map(place).collect();
    (side > 0.0 && side.is_finite()).then_some(Arrangement { places, tiles: 1, side, share })
}

/// Whether islands are a margin apart as they lie, and none lies over another. O(n log n), and the sides that are near to each other.
pub(super) fn is_apart(
    (triangles, island): (&[Triangle], &[u32]),
    (outlines, unit): (&[Outline], f64),
    given: &Arrangement,
    watch: Watch,
) -> Result<bool, Interrupted> {
    let least = (given.share - ROUNDING) * given.side;
    let sides = |(island, outline): (u32, &Outline)| -> Vec<Side> {
        let side = |edge: &[Complex64; 2]| {
            let [from, to] = edge.map(|z| at(outline, z, unit));
            Side::new(Line { from, to }, island)
        };
        outline.edges.iter().map(side).collect()
    };
    let sides: Vec<Side> = (0..).zip(outlines).flat_map(sides).collect();
    watch.ask(0.1)?;
    let tree = RTree::bulk_load(sides.clone());
    watch.ask(0.3)?;
    let is_near = |side: &Side| {
        let Line { from, to } = *side.geom();
        let low = [0, 1].map(|k| from[k].min(to[k]) - least);
        let high = [0, 1].map(|k| from[k].max(to[k]) + least);
        let mut near = tree.locate_in_envelope_intersecting(AABB::from_corners(low, high));
        near.any(|other| other.data > side.data && distance(side.geom(), other.geom()) < least)
    };
    if least > 0.0 && sides.par_iter().any(is_near) {
        return Ok(false);
    }
    let are_two = |pair: [u32; 2]| island[pair[0] as usize] != island[pair[1] as usize];
    Ok(overlaps_watched(triangles, ROUNDING, are_two, watch.within(0.6, 1.0))?.pairs.is_empty())
}

/// A point of an outline where its island lies.
fn at(outline: &Outline, z: Complex64, unit: f64) -> [f64; 2] {
    [z.re + outline.centre[0] / unit, z.im + outline.centre[1] / unit]
}

/// The distance of two segments: 0 where they cross.
fn distance(one: &Line<[f64; 2]>, other: &Line<[f64; 2]>) -> f64 {
    let left = |line: &Line<[f64; 2]>, p: [f64; 2]| {
        let Line { from: a, to: b } = line;
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    let parts = |line: &Line<[f64; 2]>, by: &Line<[f64; 2]>| left(by, line.from) * left(by, line.to) < 0.0;
    if parts(one, other) && parts(other, one) {
        return 0.0;
    }
    let ends = [(one, other.from), (one, other.to), (other, one.from), (other, one.to)];
    ends.iter().map(|(line, p)| line.distance_2(p)).fold(f64::INFINITY, f64::min).sqrt()
}
