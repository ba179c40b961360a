//! Flattening as others do it, to compare with: the same cones, cut open along the same seams.

use geom::{Mesh, VertexData};

use super::Analysis;
use super::component::Component;
use super::cones::Cones;
use super::instances::each;
use super::observer::{Stage, Task, Times};
use crate::baseline::{Lscm, scale_linearly};
use crate::cut::{SeamOptions, SeamPlan};
use crate::error::Error;

/// A way from cones to the plane that is no exact flattening.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Baseline {
    /// Lengths scaled by one linear solve, as in the paper (Ben-Chen, Gotsman & Bunin 2008), and laid out by least squares.
    LinearScaling,
    /// No metric scaling: the least-squares conformal map (Lévy, Petitjean, Ray & Maillot 2002).
    LeastSquares,
}

/// A map made by a [`Baseline`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BaselineMap {
    /// A position in the plane for each corner of the model. Components lie over each other, each in the size of its surface.
    pub uv: Vec<[f64; 2]>,
    /// The largest difference between the scaled metric's curvature and what it should be, in radians; none where no metric is
    /// scaled.
    pub curvature_error: Option<f64>,
    /// How many triangles the scaled metric breaks.
    pub broken: usize,
    /// The time each stage took.
    pub times: Times,
}

/// The map of a component.
struct ComponentMap {
    map: Lscm,
    curvature_error: Option<f64>,
    broken: usize,
}

impl Analysis {
    /// Flattens the model with given cones by a baseline.
    ///
    /// # Errors
    /// If the cones are of another analysis, or the baseline fails.
    pub fn flatten_by(&self, baseline: Baseline, cones: &Cones) -> Result<BaselineMap, Error> {
        self.check_own(cones)?;
        let task = self.task();
        let mut times = Times::default();
        let parts = each(self.components(), &mut times, |component, times| {
            let plan = self.plan(component, &SeamOptions::default(), &task, times)?;
            component.flatten_by(baseline, (cones, &plan), &task, times)
        })?;
        let mut uv = vec![[0.0; 2]; self.corner_vertices().len()];
        for (component, part) in self.components().iter().zip(&parts) {
            let size = component.size_of(&part.map);
            let position = |h| {
                let z = part.map.corner(h) * size;
                [z.re, z.im]
            };
            component.spread(position, |corner, position| uv[corner as usize] = position);
        }
        let curvature_error = parts.iter().filter_map(|part| part.curvature_error).reduce(f64::max);
        Ok(BaselineMap { uv, curvature_error, broken: parts.iter().map(|part| part.broken).sum(), times })
    }
}

impl Component {
    fn flatten_by(
        &self,
        baseline: Baseline,
        (cones, plan): (&Cones, &SeamPlan),
        task: &Task,
        times: &mut Times,
    ) -> Result<ComponentMap, Error> {
        let Self { index, surface, metric, .. } = self;
        let mesh = &surface.mesh;
        let configuration = &cones.configurations[*index];
        let vertices = &configuration.vertices;
        let seams = task.stage((Stage::Cut, *index), times, |watch| plan.cut(mesh, vertices, watch))??;
        let scaling = match baseline {
            Baseline::LeastSquares => None,
            Baseline::LinearScaling => Some(task.stage((Stage::Scale, *index), times, |_| {
                let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
                vertices.iter().zip(&configuration.curvature).for_each(|(&v, &k)| target[v] = k);
                scale_linearly(mesh, metric, &target)
            })??),
        };
        let scaled = scaling.as_ref().map_or(metric, |scaling| &scaling.metric);
        let map = task.stage((Stage::Layout, *index), times, |_| Lscm::new(mesh, scaled, &seams.cut))??;
        let (error, broken) = scaling.map_or((None, 0), |scaling| (Some(scaling.error), scaling.broken));
        Ok(ComponentMap { map, curvature_error: error, broken })
    }

    /// What makes a map as large as the surface is in the model.
    fn size_of(&self, map: &Lscm) -> f64 {
        let mesh: &Mesh = &self.surface.mesh;
        let signed_area = |f| {
            let [a, b, c] = mesh.sides(f).map(|h| map.corner(h));
            0.5 * ((b - a).conj() * (c - a)).im
        };
        let image: f64 = mesh.faces().map(signed_area).sum();
        (self.metric.area(mesh) / image.abs().max(f64::MIN_POSITIVE)).sqrt() / self.surface.scale
    }
}
