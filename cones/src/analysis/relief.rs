//! Cones more where lengths would change too much.
//!
//! The search for cones minimises the mean square of the log scale factor, weighted by area. A thin limb, a hair on a scan,
//! has next to no area: there lengths may change e^40-fold, and that costs nothing. No metric is found then, or one that no number can
//! hold. So where the cones chosen leave more than a factor of e^[`FAR`], a few more are put where lengths change most, one in each
//! such place, until none is left or [`MOST`] were added. On `raptor` 32 cones leave e^49 on one of its limbs, 128 as well.

use geom::{VertexData, VertexId, Watch};

use super::component::Component;
use super::cones::Configuration;
use crate::curvature::{Anchors, CurvatureError, CurvatureRule};

/// Lengths should change by no more than this power of e against the mean. Maps that nobody complains of come to 3.
const FAR: f64 = 3.5;
/// So many cones are added at most,
const MOST: usize = 32;
/// and so many at once.
const BATCH: usize = 8;
/// Where cones are added u counts as much as on so large a share of the surface. Without that neighbours get opposite curvatures as
/// large as bounds allow, which cancel out everywhere but right there.
const WEIGHT: f64 = 0.003;

impl Component {
    /// The same cones, and more where lengths would change too much.
    pub(super) fn relieved(
        &self,
        chosen: Configuration,
        rule: CurvatureRule,
        watch: Watch,
    ) -> Result<Configuration, CurvatureError> {
        let before = chosen.vertices.len();
        let most = before + MOST;
        let mut vertices = chosen.vertices.clone();
        let mut last = chosen.clone();
        let mut best = (self.stretch(&chosen), chosen);
        while best.0 > FAR && vertices.len() < most {
            let new = self.far_places(&last, &vertices, BATCH.min(most - vertices.len()));
            if new.is_empty() {
                break;
            }
            vertices.extend(new);
            let anchors = Anchors { vertices: &vertices[before..], weight: WEIGHT };
            let more = self.configure_anchored(vertices.clone(), (rule, anchors), watch)?;
            let stretch = self.stretch(&more);
            if stretch < best.0 {
                best = (stretch, more.clone());
            }
            last = more;
        }
        Ok(best.1)
    }

    /// The logarithm of the factor by which lengths change most against the mean, as linear theory predicts it.
    pub(super) fn stretch(&self, configuration: &Configuration) -> f64 {
        let u = self.centred(configuration);
        u.iter().fold(0.0_f64, |most, u| most.max(u.abs()))
    }

    fn centred(&self, configuration: &Configuration) -> VertexData<f64> {
        let mut u = configuration.predicted.clone();
        self.operators.subtract_mean(&mut u);
        u
    }

    /// Where lengths change most, at most so many places: one in each connected part of the surface where it is more than
    /// e^[`FAR`], the farthest first.
    fn far_places(&self, configuration: &Configuration, cones: &[VertexId], most: usize) -> Vec<VertexId> {
        let mesh = &self.surface.mesh;
        let u = self.centred(configuration);
        let mut is_taken: VertexData<bool> = u.iter().map(|u| u.abs() <= FAR).collect();
        let mut is_cone = VertexData::constant(mesh.vertex_count(), false);
        cones.iter().for_each(|&v| is_cone[v] = true);
        let is_open = |v: &VertexId| !mesh.is_boundary_vertex(*v) && !is_cone[*v];
        let mut places = Vec::new();
        for seed in mesh.vertices() {
            if std::mem::replace(&mut is_taken[seed], true) {
                continue;
            }
            let mut part = vec![seed];
            let mut at = 0;
            while at < part.len() {
                let near = mesh.neighbors(part[at]).iter().copied();
                part.extend(near.filter(|&v| !std::mem::replace(&mut is_taken[v], true)));
                at += 1;
            }
            let farthest =
                part.into_iter().filter(is_open).max_by(|&v, &w| u[v].abs().total_cmp(&u[w].abs()).then(w.cmp(&v)));
            places.extend(farthest);
        }
        places.sort_by(|&v, &w| u[w].abs().total_cmp(&u[v].abs()).then(v.cmp(&w)));
        places.truncate(most);
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::Analysis;
    use crate::placement::Placement;
    use geom::shapes;

    /// A sphere with a thin horn as long as it.
    fn horned() -> shapes::Shape {
        let mut shape = shapes::sphere(1500);
        for [x, y, z] in &mut shape.points {
            if *z > 0.9 {
                (*x, *y, *z) = (0.15 * *x, 0.15 * *y, 0.9 + 20.0 * (*z - 0.9));
            }
        }
        shape
    }

    #[test]
    fn where_lengths_change_too_much_there_are_more_cones() {
        let analysis = Analysis::new(&horned().into()).unwrap();
        let component = &analysis.components()[0];
        let round: Vec<VertexId> = (0..4)
            .map(|k| {
                let z = |v: &VertexId| component.surface.points[v.0 as usize];
                let below = component.surface.mesh.vertices().filter(|v| z(v)[2] < 0.1);
                below.step_by(97 + k).nth(2).expect("there are many")
            })
            .collect();
        let chosen = component.configure(round, CurvatureRule::Optimal, Watch::NONE).unwrap();
        let before = component.stretch(&chosen);
        assert!(before > FAR, "{before}");
        let relieved = component.relieved(chosen.clone(), CurvatureRule::Optimal, Watch::NONE).unwrap();
        assert!(component.stretch(&relieved) < 0.6 * before, "{before} becomes {}", component.stretch(&relieved));
        assert!(
            relieved.vertices.starts_with(&chosen.vertices) && relieved.vertices.len() <= chosen.vertices.len() + MOST
        );
        let total: f64 = relieved.curvature.iter().sum();
        assert!((total - 4.0 * std::f64::consts::PI).abs() < 1e-9);
    }

    #[test]
    fn cones_that_change_lengths_little_stay_as_they_are() {
        let analysis = Analysis::new(&shapes::hare(900).into()).unwrap();
        let component = &analysis.components()[0];
        let cones = analysis.place(Placement::Refined, 8).unwrap();
        let vertices = cones.configurations[0].vertices.clone();
        let chosen = component.configure(vertices, CurvatureRule::Optimal, Watch::NONE).unwrap();
        let relieved = component.relieved(chosen.clone(), CurvatureRule::Optimal, Watch::NONE).unwrap();
        assert_eq!(relieved.vertices, chosen.vertices);
    }
}
