//! How large triangles may be where, from how much a map bends their angles.
//!
//! A map that is linear on a triangle bends it in proportion to its size and to how fast the scale factor changes there. For as little as can be had
//! of so many triangles on average, their size goes with that change's power of −1/3: near cones they are smallest, and where nothing changes they
//! stay as they are.

use rstar::RTree;
use rstar::primitives::GeomWithData;

use geom::distortion::Distortion;
use geom::vector::{add, cross, length, step, sub};
use geom::{FaceId, VertexId};

use super::Analysis;
use super::atlas::Atlas;
use super::component::Component;

/// What the mean of σ₁/σ₂ is to have above 1, by what triangles do as they are. It comes out a fourth below, since none becomes larger.
const AIM: f64 = 0.05;
/// There are to be about so many times as many triangles at most,
const MOST_GROWTH: f64 = 3.0;
/// or so many.
const FEW: f64 = 10_000.0;
/// A triangle becomes at most so many times smaller,
const SMALLEST: f64 = 1.0 / 16.0;
/// and none is bent by less than this, nor by more.
const BEND: [f64; 2] = [1e-4, 3.0];

/// How large circumcircles may be, part by part: where a part touches another one, or lies in it, that one's triangles say nothing.
pub(super) struct Sizing(Vec<PartSizing>);

/// Of a part, whose first vertex is at the origin.
struct PartSizing {
    origin: [f64; 3],
    /// What the model's lengths are multiplied by in this part.
    scale: f64,
    /// Radii at places.
    radii: RTree<GeomWithData<[f64; 3], f64>>,
}

/// An intrinsic triangle and its map. Lengths are in the part's unit.
struct Sample {
    middle: [f64; 3],
    area: f64,
    radius: f64,
    /// How fast the map changes: what σ₁/σ₂ has above 1, over the radius.
    change: f64,
}

impl Sizing {
    /// Of a refined model and its map, as measured on the triangles that are on islands; none if nothing was refined.
    pub(super) fn of(analysis: &Analysis, atlas: &Atlas, measured: &Distortion) -> Option<Self> {
        let mut ratios = measured.triangle_quasi_conformal.iter();
        let ratio = |island: &Option<u32>| island.and_then(|_| ratios.next()).map_or(1.0, |ratio| *ratio);
        let ratio: Vec<f64> = atlas.islands.iter().map(ratio).collect();
        let components = analysis.components();
        let samples = components.iter().map(|component| component.samples(analysis, atlas, &ratio));
        let samples: Vec<Vec<Sample>> = samples.collect();
        // In the unit of the first part, which need not be near the model's.
        let units: Vec<f64> = components.iter().map(|c| components[0].surface.scale / c.surface.scale).collect();
        let all = || samples.iter().zip(&units).flat_map(|(samples, &unit)| samples.iter().map(move |s| (s, unit)));
        let whole: f64 = all().map(|(sample, unit)| sample.area * unit * unit).sum();
        let needed =
            |(sample, unit): (&Sample, f64)| sample.area * unit * unit * (sample.change / unit).powf(2.0 / 3.0);
        let needed: f64 = all().map(needed).sum();
        if !(whole > 0.0 && needed > 0.0 && needed.is_finite()) {
            return None;
        }
        let to_aim = AIM * whole / needed;
        // The area of an even triangle, over the square of its radius.
        let even = 0.75 * 3.0_f64.sqrt();
        let to_growth = (needed / even / (MOST_GROWTH * all().count() as f64).max(FEW)).sqrt();
        let size = |&Sample { radius, change, .. }: &Sample, unit: f64| {
            let size = to_aim.max(to_growth) * (change / unit).powf(-1.0 / 3.0) / unit;
            if size < radius { size.max(SMALLEST * radius) } else { f64::INFINITY }
        };
        let parts = components.iter().zip(&samples).zip(&units).map(|((component, samples), &unit)| PartSizing {
            origin: component.origin(analysis),
            scale: component.surface.scale,
            radii: RTree::bulk_load(samples.iter().map(|s| GeomWithData::new(s.middle, size(s, unit))).collect()),
        });
        Some(Self(parts.collect()))
    }

    /// How large triangles of a part may be at a place, both in the model's unit.
    pub(super) fn at(&self, part: usize, place: [f64; 3]) -> f64 {
        let Some(PartSizing { origin, scale, radii }) = self.0.get(part) else { return f64::INFINITY };
        let nearest = radii.nearest_neighbor(sub(place, *origin).map(|x| x * scale));
        nearest.map_or(f64::INFINITY, |nearest| nearest.data / scale)
    }
}

impl Component {
    fn origin(&self, analysis: &Analysis) -> [f64; 3] {
        analysis.points()[self.surface.vertex[VertexId(0)] as usize]
    }

    /// What the triangles that it is computed on are like; nothing if they are the model's own.
    fn samples(&self, analysis: &Analysis, atlas: &Atlas, ratio: &[f64]) -> Vec<Sample> {
        let (Some(way), mesh, origin) = (&self.way, &self.surface.mesh, self.origin(analysis)) else {
            return Vec::new();
        };
        let place = |corner: u32| {
            let point = analysis.points()[analysis.corner_vertices()[corner as usize] as usize];
            sub(point, origin).map(|x| x * self.surface.scale)
        };
        let sample = |f: FaceId| {
            let (mut area, mut bend, mut moment) = (0.0, 0.0, [0.0; 3]);
            for &t in way.triangles(f) {
                let [a, b, c] = atlas.triangles.corners[t as usize].map(place);
                let piece = 0.5 * length(cross(sub(b, a), sub(c, a)));
                area += piece;
                bend += piece * (ratio[t as usize] - 1.0).clamp(BEND[0], BEND[1]);
                moment = step(moment, piece / 3.0, add(a, add(b, c)));
            }
            let sides = self.metric.sides(mesh, f);
            let radius = sides.0.iter().product::<f64>() / (4.0 * sides.area());
            let sample = Sample { middle: moment.map(|x| x / area), area, radius, change: bend / area / radius };
            (area > 0.0 && radius.is_finite() && sample.change > 0.0).then_some(sample)
        };
        mesh.faces().filter_map(sample).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, Preparation, Refining};
    use geom::{Model, shapes};

    /// The atlas of a refined model with so many cones, and what that says of sizes.
    fn sizing(model: &Model, cones: usize) -> (Atlas, Sizing) {
        let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
        let analysis = Analysis::with(model, preparation).unwrap();
        let cones = crate::ConeChoice::Count(cones);
        let atlas = analysis.atlas(&Options { preparation, cones, ..Options::default() }).unwrap();
        let sizing = Sizing::of(&analysis, &atlas, &analysis.measures(&atlas).unwrap()).unwrap();
        (atlas, sizing)
    }

    fn scaled(mut shape: shapes::Shape, by: f64) -> shapes::Shape {
        shape.points.iter_mut().flatten().for_each(|x| *x *= by);
        shape
    }

    #[test]
    fn triangles_are_smallest_at_cones_whatever_the_unit() {
        // A power of two of a size whose squares are no numbers any more, and one whose squares are 0.
        for unit in [1.0, 2.0_f64.powi(400), 2.0_f64.powi(-400)] {
            let (atlas, sizing) = sizing(&scaled(shapes::sphere(200), unit).into(), 2);
            let poles: Vec<[f64; 3]> = atlas.cones.iter().map(|cone| cone.position.map(|x| x / unit)).collect();
            let at = |place: [f64; 3]| sizing.at(0, place.map(|x| x * unit)) / unit;
            let most = at(poles[0]).max(at(poles[1]));
            // On the equator between two cones of 2π at the poles the map is as good as rigid.
            let between = cross(poles[0], [0.3, 0.5, 0.8]);
            let between = at(between.map(|x| x / length(between)));
            assert!(most < 0.06 && between > 2.0 * most, "{unit:e}: {most} {between}");
        }
    }

    #[test]
    fn a_part_is_sized_by_its_own_triangles() {
        // A ball in another one that is hardly larger: the same sizes as where it lies elsewhere.
        let sizes = [0.0, 9.0].map(|far| {
            let (inner, mut outer) = (shapes::sphere(200), scaled(shapes::sphere(90), 1.001));
            outer.points.iter_mut().for_each(|point| point[0] += far);
            let triangles = outer.triangles.iter().map(|t| t.map(|v| v + inner.points.len() as u32));
            let triangles: Vec<[u32; 3]> = inner.triangles.iter().copied().chain(triangles).collect();
            let model = Model::from_triangles([&inner.points[..], &outer.points].concat(), &triangles).unwrap();
            let (_, sizing) = sizing(&model, 6);
            let differs = |&&point: &&[f64; 3]| sizing.at(0, point) != sizing.at(1, point);
            assert!(outer.points.iter().filter(differs).count() > 45);
            inner.points.iter().map(|&point| sizing.at(0, point)).collect::<Vec<f64>>()
        });
        // Rounding moves the outer one's cones, and so what there is for all by a little.
        let is_same = |(one, other): &(&f64, &f64)| one == other || (*one - *other).abs() < 0.1 * *one;
        let same = sizes[0].iter().zip(&sizes[1]).filter(is_same).count();
        let finite = sizes[0].iter().filter(|size| size.is_finite()).count();
        assert!(same >= 190 && finite > 20, "{same} {finite}");
    }
}
