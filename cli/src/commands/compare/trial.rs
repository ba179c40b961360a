//! One run of one method on one mesh: its map, and how long each step took.

use std::time::Instant;

use cones::{Atlas, ConeChoice, Lscm, LscmError, Operators, Options, Seams, Stage, cone_curvatures, scale_linearly};
use geom::distortion::{self, Distortion, DistortionError};
use geom::{VertexData, VertexId};
use thiserror::Error;

use crate::commands::shared::corner_uv;

use super::plan::Plan;
use super::prepared::{Part, PreparedModel};
use super::variant::{Flattening, Variant};

/// Why a method has no result.
#[derive(Debug, Error)]
pub(super) enum TrialError {
    #[error(transparent)]
    Unwrap(#[from] cones::Error),
    #[error(transparent)]
    Lscm(#[from] LscmError),
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

/// The cones of a part with their curvatures.
struct Curved {
    cones: Vec<VertexId>,
    curvature: Vec<f64>,
}

impl Trial {
    /// Runs a method with as many cones on each part as its plan has.
    pub(super) fn run(subject: &PreparedModel, variant: Variant, plan: &Plan) -> Result<Self, TrialError> {
        let mut trial = Self {
            cones: 0,
            seconds: TrialTimes { preparing: subject.preparing(), detection: 0.0, flattening: 0.0, whole: 0.0 },
            curvature_left: None,
            broken: 0,
            uv: vec![[0.0; 2]; subject.model.corner_count()],
        };
        let mut all = Vec::new();
        for (part, &count) in subject.parts.iter().zip(&plan.counts) {
            all.push(trial.detect(part, variant, count)?);
        }
        match variant.flattening {
            Flattening::Exact => trial.unwrap(subject, &all)?,
            Flattening::Linear | Flattening::Lscm => {
                for (part, curved) in subject.parts.iter().zip(&all) {
                    trial.lay_out(part, curved, variant.flattening)?;
                }
            }
        }
        let TrialTimes { preparing, detection, flattening, .. } = trial.seconds;
        trial.seconds.whole = preparing + detection + flattening;
        Ok(trial)
    }

    /// Finds the cones of a part. Their curvatures are counted to the flattening, as in the paper.
    fn detect(&mut self, part: &Part, variant: Variant, count: usize) -> Result<Curved, TrialError> {
        let mesh = &part.surface.mesh;
        let start = Instant::now();
        let operators = Operators::with_points(mesh, &part.metric, &part.surface.points).map_err(cones::Error::from)?;
        let cones = variant.cones(&operators, mesh, count).map_err(cones::Error::from)?;
        self.seconds.detection += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let curvatures = cone_curvatures(&operators, mesh, &cones, variant.angles).map_err(cones::Error::from)?;
        self.seconds.flattening += start.elapsed().as_secs_f64();
        self.cones += cones.len();
        Ok(Curved { cones, curvature: curvatures.curvature })
    }

    /// Flattens as `cones unwrap` does.
    fn unwrap(&mut self, subject: &PreparedModel, all: &[Curved]) -> Result<(), TrialError> {
        let of_model = |(part, curved): (&Part, &Curved)| -> Vec<(u32, Option<f64>)> {
            let pairs = curved.cones.iter().zip(&curved.curvature);
            pairs.map(|(&v, &k)| (part.surface.vertex[v], Some(k))).collect()
        };
        let given = subject.parts.iter().zip(all).flat_map(of_model).collect();
        let options = Options { cones: ConeChoice::Given(given), ..Options::default() };
        let Atlas { uv, times, curvature_error, .. } = cones::unwrap(&subject.model, &options, &mut |_| ())?;
        let is_flattening = |stage| matches!(stage, Stage::Cut | Stage::Scale | Stage::Layout);
        let flattening = times.iter().filter(|(stage, _)| is_flattening(*stage));
        self.seconds.flattening += flattening.map(|(_, time)| time.as_secs_f64()).sum::<f64>();
        self.curvature_left = Some(curvature_error);
        self.uv = uv;
        Ok(())
    }

    /// Flattens a part by a baseline, cut open as `cones unwrap` does it.
    fn lay_out(&mut self, part: &Part, curved: &Curved, flattening: Flattening) -> Result<(), TrialError> {
        let (surface, metric) = (&part.surface, &part.metric);
        let start = Instant::now();
        let seams = Seams::of_surface(surface, metric, &curved.cones).map_err(cones::Error::from)?;
        let map = if flattening == Flattening::Linear {
            let mut target = VertexData::constant(surface.mesh.vertex_count(), 0.0);
            curved.cones.iter().zip(&curved.curvature).for_each(|(&v, &k)| target[v] = k);
            let scaling = scale_linearly(&surface.mesh, metric, &target).map_err(cones::Error::from)?;
            self.curvature_left = Some(self.curvature_left.unwrap_or(0.0).max(scaling.error));
            self.broken += scaling.broken;
            Lscm::new(&surface.mesh, &scaling.metric, &seams.cut)?
        } else {
            Lscm::new(&surface.mesh, metric, &seams.cut)?
        };
        self.seconds.flattening += start.elapsed().as_secs_f64();
        self.place(part, &map);
        Ok(())
    }

    /// Takes over the texture coordinates of a part, in the size of its surface.
    fn place(&mut self, part: &Part, map: &Lscm) {
        let mesh = &part.surface.mesh;
        let signed_area = |f| {
            let [a, b, c] = mesh.sides(f).map(|h| map.corner(h));
            0.5 * ((b - a).conj() * (c - a)).im
        };
        let image: f64 = mesh.faces().map(signed_area).sum();
        let size = (part.metric.area(mesh) / image.abs().max(f64::MIN_POSITIVE)).sqrt() / part.surface.scale;
        for h in mesh.halfedges() {
            let z = map.corner(h) * size;
            self.uv[part.surface.corner[h] as usize] = [z.re, z.im];
        }
    }

    /// Measures the map, on the surfaces as they were opened.
    pub(super) fn distortion(&self, subject: &PreparedModel) -> Result<Distortion, TrialError> {
        let (mut points, mut triangles, mut corners) = (Vec::new(), Vec::new(), Vec::new());
        for Part { surface, .. } in &subject.parts {
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
    fn cut(Part { surface, .. }: &Part, uv: &[[f64; 2]]) -> EdgeData<bool> {
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
        let [part] = &subject.parts[..] else { panic!("a torus is in one piece") };
        let mut plans = Plans::new(&subject);
        let mut cut_of = |name: &str| {
            let variant = Variant::parse(name).unwrap();
            let trial = Trial::run(&subject, variant, &plans.of(variant, 6).unwrap()).unwrap();
            assert_eq!(trial.distortion(&subject).unwrap().islands.len(), 1);
            cut(part, &trial.uv)
        };
        for rule in ["refined", "alternating+harmonic"] {
            let exact = cut_of(rule);
            assert!(CutMesh::open(&part.surface.mesh, &exact).is_disk());
            assert_eq!(exact, cut_of(&format!("{rule}+linear")));
            assert_eq!(exact, cut_of(&format!("{rule}+lscm")));
        }
    }
}
