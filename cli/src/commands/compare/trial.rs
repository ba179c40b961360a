//! One run of one method on one mesh: its map, and how long each step took.

use cones::report::OverlapReport;
use cones::{Analysis, ConeChoice, Islands, Options, Stage, Times};
use geom::Surface;
use geom::distortion::{self, Distortion, DistortionError};
use thiserror::Error;

use crate::commands::shared::corner_uv;

use super::plan::Plan;
use super::prepared::PreparedModel;
use super::variant::{Flattening, Variant};

/// Why a method has no result.
#[derive(Debug, Error)]
pub(super) enum TrialError {
    #[error(transparent)]
    Unwrap(#[from] cones::Error),
    #[error(transparent)]
    Measure(#[from] DistortionError),
}

/// The seconds that the steps of a run took.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrialTimes {
    pub(super) preparing: f64,
    pub(super) detection: f64,
    pub(super) flattening: f64,
    pub(super) whole: f64,
}

/// A run.
#[derive(Debug)]
pub(super) struct Trial {
    pub(super) cones: usize,
    pub(super) seconds: TrialTimes,
    /// How far the metric's curvature is from what it should be, at most; none where no metric was computed.
    pub(super) curvature_left: Option<f64>,
    /// Triangles that the scaled metric breaks.
    pub(super) broken: usize,
    /// For each corner of the model.
    uv: Vec<[f64; 2]>,
}

impl Trial {
    /// Runs a method with as many cones on each part as its plan has.
    pub(super) fn run(subject: &PreparedModel, variant: Variant, plan: &Plan) -> Result<Self, TrialError> {
        let options = Options { cones: ConeChoice::Each(plan.counts.clone()), ..variant.options() };
        let analysis = Analysis::with(&subject.model, options.preparation)?;
        let cones = analysis.choose(&options)?;
        let (uv, curvature_left, broken, times) = match variant.flattening {
            Flattening::Exact => {
                let atlas = analysis.flatten_with(&cones, &Options { islands: Islands::Single, ..options })?;
                (atlas.uv, Some(atlas.curvature_error), 0, atlas.times)
            }
            Flattening::By(baseline) => {
                let map = analysis.flatten_by(baseline, &cones)?;
                (map.uv, map.curvature_error, map.broken, map.times)
            }
        };
        let times: Times = [analysis.times(), cones.times(), times].into_iter().sum();
        Ok(Self { cones: cones.len(), seconds: TrialTimes::new(times), curvature_left, broken, uv })
    }

    /// The share of the layout that is covered more than once.
    pub(super) fn overlap(&self, subject: &PreparedModel) -> f64 {
        let corners = |surface: &Surface| -> Vec<[u32; 3]> {
            surface.mesh.faces().map(|f| surface.mesh.sides(f).map(|h| surface.corner[h])).collect()
        };
        let uv = corner_uv(&subject.surfaces.iter().flat_map(corners).collect::<Vec<_>>(), &self.uv);
        OverlapReport::of(&uv).share
    }

    /// Measures the map, on the surfaces as they were opened.
    pub(super) fn distortion(&self, subject: &PreparedModel) -> Result<Distortion, TrialError> {
        let (mut points, mut triangles, mut corners) = (Vec::new(), Vec::new(), Vec::new());
        for surface in &subject.surfaces {
            let first = points.len() as u32;
            points.extend(surface.points.iter().map(|point| point.map(|x| x / surface.scale)));
            for f in surface.mesh.faces() {
                triangles.push(surface.mesh.corners(f).map(|v| first + v.0));
                corners.push(surface.mesh.sides(f).map(|h| surface.corner[h]));
            }
        }
        Ok(distortion::measure(&points, &triangles, &corner_uv(&corners, &self.uv))?)
    }
}

impl TrialTimes {
    /// The cones' curvatures are counted to the flattening, as in the paper.
    fn new(times: Times) -> Self {
        let sum = |stages: &[Stage]| stages.iter().map(|&stage| times.of(stage).as_secs_f64()).sum();
        Self {
            preparing: sum(&[Stage::Prepare]),
            detection: sum(&[Stage::Factor, Stage::Hierarchy]),
            flattening: sum(&[Stage::Curvature, Stage::Cut, Stage::Scale, Stage::Layout]),
            whole: times.total().as_secs_f64(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::plan::Plans;
    use super::*;
    use geom::{CutMesh, EdgeData, Model};
    use std::f64::consts::TAU;

    /// A torus of quadrilaterals with a bump.
    fn torus(around: u32, across: u32) -> Model {
        let vertex = |i: u32, j: u32| i % around * across + j % across;
        let point = |k: u32| {
            let [u, v] = [(k / across, around), (k % across, across)].map(|(i, n)| TAU * f64::from(i) / f64::from(n));
            let tube = 1.0 + 0.6 * (2.0 * u.cos()).exp() / 7.4;
            let ring = 3.0 + tube * v.cos();
            [ring * u.cos(), ring * u.sin(), tube * v.sin()]
        };
        let quad = |k: u32| {
            let [i, j] = [k / across, k % across];
            [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]
        };
        let all = 0..around * across;
        Model::from_polygons(all.clone().map(point).collect(), all.map(quad)).unwrap()
    }

    /// Where a map is torn.
    fn cut(surface: &Surface, uv: &[[f64; 2]]) -> EdgeData<bool> {
        let mesh = &surface.mesh;
        let is_torn = |e| {
            let h = mesh.halfedge(e);
            let ends = |h, g| uv[surface.corner[h] as usize] == uv[surface.corner[mesh.next(g)] as usize];
            mesh.twin(h).is_some_and(|g| !(ends(h, g) && ends(g, h)))
        };
        mesh.edges().map(is_torn).collect()
    }

    #[test]
    fn baselines_are_cut_as_what_they_are_compared_with_and_between_polygons_only() {
        let subject = PreparedModel::new("torus".to_owned(), torus(24, 12)).unwrap();
        let [surface] = &subject.surfaces[..] else { panic!("a torus is in one piece") };
        let mut plans = Plans::new(&subject);
        let mut cut_of = |name: &str| {
            let variant = Variant::parse(name).unwrap();
            let trial = Trial::run(&subject, variant, &plans.of(variant, 6).unwrap()).unwrap();
            assert_eq!(trial.distortion(&subject).unwrap().islands.len(), 1);
            cut(surface, &trial.uv)
        };
        for rule in ["refined", "alternating+harmonic"] {
            let exact = cut_of(rule);
            assert!(CutMesh::open(&surface.mesh, &exact).is_disk());
            assert_eq!(exact, cut_of(&format!("{rule}+linear")));
            assert_eq!(exact, cut_of(&format!("{rule}+lscm")));
        }
    }
}
