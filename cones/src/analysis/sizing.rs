//! How large triangles may be where, from how much a map bends their angles.
//!
//! A map that is linear on a triangle bends it in proportion to its size and to how fast the scale factor changes there. For as little as can be had
//! of so many triangles on average, their size goes with that change's power of −1/3: near cones they are smallest, and where nothing changes they
//! stay as they are.

use rstar::RTree;
use rstar::primitives::GeomWithData;

use geom::distortion::Distortion;
use geom::vector::{add, cross, length, step, sub};

use super::Analysis;
use super::atlas::Atlas;
use super::component::Component;
use super::refined::Way;

/// What the mean of σ₁/σ₂ is to have above 1, by what triangles do as they are. It comes out a fourth below, since none becomes larger.
const AIM: f64 = 0.05;
/// There are to be so many times as many triangles at most,
const MOST_GROWTH: f64 = 3.0;
/// or so many.
const FEW: f64 = 10_000.0;
/// A triangle becomes at most so many times smaller,
const SMALLEST: f64 = 1.0 / 16.0;
/// and none is bent by less than this, nor by more.
const BEND: [f64; 2] = [1e-4, 3.0];

/// Radii of circumcircles at places in space, in the model's unit.
pub(super) struct Sizing(RTree<GeomWithData<[f64; 3], f64>>);

/// An intrinsic triangle and its map.
struct Sample {
    middle: [f64; 3],
    area: f64,
    radius: f64,
    /// How fast the map changes: what σ₁/σ₂ has above 1, over the radius.
    change: f64,
}

impl Sizing {
    /// Of a refined model and its map, as measured on the triangles that are on islands.
    pub(super) fn new(analysis: &Analysis, atlas: &Atlas, measured: &Distortion) -> Self {
        let mut ratios = measured.triangle_quasi_conformal.iter();
        let ratio = |island: &Option<u32>| island.and_then(|_| ratios.next()).map_or(1.0, |ratio| *ratio);
        let ratio: Vec<f64> = atlas.islands.iter().map(ratio).collect();
        let mut samples = Vec::new();
        for component in analysis.components() {
            let Some(way) = &component.way else { continue };
            let corners = |t: u32| {
                let vertices = atlas.triangles.corners[t as usize].map(|c| analysis.corner_vertices()[c as usize]);
                vertices.map(|v| analysis.points()[v as usize])
            };
            samples.extend(component.samples(way, corners, &ratio));
        }
        let whole: f64 = samples.iter().map(|sample| sample.area).sum();
        let mean = |of: &dyn Fn(&Sample) -> f64| samples.iter().map(|s| s.area * of(s)).sum::<f64>() / whole;
        let to_aim = AIM / mean(&|sample| sample.change.powf(2.0 / 3.0));
        // The area of an even triangle, over the square of its radius.
        let even = 0.75 * 3.0_f64.sqrt();
        let count = whole * mean(&|sample| sample.change.powf(2.0 / 3.0)) / even;
        let to_growth = (count / (MOST_GROWTH * samples.len() as f64).max(FEW)).sqrt();
        let size = |Sample { radius, change, .. }: &Sample| {
            let size = to_aim.max(to_growth) * change.powf(-1.0 / 3.0);
            if size < *radius { size.max(SMALLEST * radius) } else { f64::INFINITY }
        };
        Self(RTree::bulk_load(samples.iter().map(|sample| GeomWithData::new(sample.middle, size(sample))).collect()))
    }

    /// How large triangles may be at a place.
    pub(super) fn at(&self, place: [f64; 3]) -> f64 {
        self.0.nearest_neighbor(place).map_or(f64::INFINITY, |nearest| nearest.data)
    }
}

impl Component {
    /// What the triangles that it is computed on are like.
    fn samples<'a>(
        &'a self,
        way: &'a Way,
        corners: impl Fn(u32) -> [[f64; 3]; 3] + 'a,
        ratio: &'a [f64],
    ) -> impl Iterator<Item = Sample> + 'a {
        let mesh = &self.surface.mesh;
        mesh.faces().filter_map(move |f| {
            let (mut area, mut bend, mut moment) = (0.0, 0.0, [0.0; 3]);
            for &t in way.triangles(f) {
                let [a, b, c] = corners(t);
                let piece = 0.5 * length(cross(sub(b, a), sub(c, a)));
                area += piece;
                bend += piece * (ratio[t as usize] - 1.0).clamp(BEND[0], BEND[1]);
                moment = step(moment, piece / 3.0, add(a, add(b, c)));
            }
            let sides = self.metric.sides(mesh, f);
            let radius = sides.0.iter().product::<f64>() / (4.0 * sides.area()) / self.surface.scale;
            let sample = Sample { middle: moment.map(|x| x / area), area, radius, change: bend / area / radius };
            (area > 0.0 && radius.is_finite() && sample.change > 0.0).then_some(sample)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, Preparation, Refining};
    use geom::shapes;

    #[test]
    fn triangles_are_smallest_at_cones_and_as_they_are_where_nothing_changes() {
        let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
        let analysis = Analysis::with(&shapes::sphere(200).into(), preparation).unwrap();
        let options = Options { preparation, cones: crate::ConeChoice::Count(2), ..Options::default() };
        let atlas = analysis.atlas(&options).unwrap();
        let corners = atlas.triangles.corners.iter().map(|t| t.map(|c| analysis.corner_vertices()[c as usize]));
        let vertices: Vec<[u32; 3]> = corners.collect();
        let uv: Vec<[[f64; 2]; 3]> = atlas.triangles.corners.iter().map(|t| t.map(|c| atlas.uv[c as usize])).collect();
        let measured = geom::distortion::measure(analysis.points(), &vertices, &uv).unwrap();
        let sizing = Sizing::new(&analysis, &atlas, &measured);
        let poles: Vec<[f64; 3]> = atlas.cones.iter().map(|cone| cone.position).collect();
        let [one, other] = [poles[0], poles[1]].map(|pole| sizing.at(pole));
        // On the equator between two cones of 2π at the poles the map is as good as rigid.
        let between = cross(poles[0], [0.3, 0.5, 0.8]);
        let between = between.map(|x| x / length(between));
        assert!(
            one.max(other) < 0.06 && sizing.at(between) > 2.0 * one.max(other),
            "{one} {other} {}",
            sizing.at(between)
        );
    }
}
