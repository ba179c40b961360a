//! Cones with the curvatures that a rule gives them, and the log scale factor that comes of it, by linear theory.
//!
//! Optimal curvatures leave every boundary loop its own best constant; harmonic ones pin the log scale to one value at all
//! cones and on all of the boundary. Harmonic curvatures that no cone can have are replaced by optimal ones, as
//! [`cone_curvatures`](crate::curvature::cone_curvatures) does.

use geom::{VertexData, VertexId, Watch};

use super::energy_model::ConeSet;
use crate::curvature::{CurvatureRule, is_buildable};
use crate::field::Operators;
use crate::field::PinnedFactor;

/// See the module's head.
#[derive(Clone, Debug)]
pub(crate) struct Configuration {
    cones: Vec<VertexId>,
    pub(crate) curvature: Vec<f64>,
    /// The rule that has given them.
    rule: CurvatureRule,
}

impl Configuration {
    /// The curvatures of one set of cones: a solve for each if they are harmonic.
    pub(crate) fn new(operators: &Operators, set: &ConeSet, rule: CurvatureRule) -> Self {
        let pinned = |cones: &[VertexId]| {
            let mut pinned = PinnedFactor::new(operators);
            pinned.add(cones);
            pinned
        };
        match rule {
            CurvatureRule::Optimal => Self::optimal(set),
            CurvatureRule::Harmonic => Self::harmonic(set, &pinned(&set.cones)),
        }
    }

    /// The curvatures of sets each of which begins with the one before, as long as they can take the surface's curvature;
    /// no more solves than for the last of them.
    pub(crate) fn nested(
        operators: &Operators,
        sets: &[ConeSet],
        rule: CurvatureRule,
        watch: Watch,
    ) -> Vec<Option<Self>> {
        let able = |set: &ConeSet| set.shortfall == 0.0;
        match rule {
            CurvatureRule::Optimal => sets.iter().map(|set| able(set).then(|| Self::optimal(set))).collect(),
            CurvatureRule::Harmonic => {
                let mut pinned = PinnedFactor::new(operators);
                let mut configured = |set: &ConeSet| {
                    if watch.stops_at(f64::NAN) {
                        return None;
                    }
                    let known = pinned.cones().len();
                    pinned.add(&set.cones[known..]);
                    able(set).then(|| Self::harmonic(set, &pinned))
                };
                sets.iter().map(&mut configured).collect()
            }
        }
    }

    fn optimal(set: &ConeSet) -> Self {
        Self { cones: set.cones.clone(), curvature: set.curvature.clone(), rule: CurvatureRule::Optimal }
    }

    fn harmonic(set: &ConeSet, pinned: &PinnedFactor) -> Self {
        let buildable = |k: &Vec<f64>| k.iter().zip(&set.bounds).all(|(&k, bound)| is_buildable(k, bound[0]));
        match pinned.curvature().filter(buildable) {
            Some(curvature) => Self { cones: set.cones.clone(), curvature, rule: CurvatureRule::Harmonic },
            None => Self::optimal(set),
        }
    }

    /// The log scale factor, centred. A back-substitution.
    pub(crate) fn log_scale(&self, operators: &Operators) -> VertexData<f64> {
        let mut u = operators.uncentred_log_scale(&self.cones, &self.curvature);
        match self.rule {
            CurvatureRule::Optimal => operators.centre(&mut u),
            CurvatureRule::Harmonic => operators.subtract_mean(&mut u),
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::cone_curvatures;
    use crate::placement::energy_model::EnergyModel;
    use geom::Watch;
    use geom::{Metric, shapes};

    #[test]
    fn curvatures_and_log_scale_are_those_that_will_be_used() {
        // With two boundary loops, and curvature.
        let mut vase = shapes::cylinder(400);
        for [x, y, z] in &mut vase.points {
            let wide = 1.0 + 0.4 * (3.0 * *z).sin();
            (*x, *y) = (*x * wide, *y * wide);
        }
        for shape in [shapes::hare(700), shapes::torus(1, 500), shapes::terrain(500, 3), shapes::cylinder(400), vase] {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
            let cones: Vec<VertexId> = inner.iter().step_by(inner.len() / 7).copied().collect();
            let mut model = EnergyModel::new(&operators, &mesh);
            model.add(&cones);
            let sets: Vec<ConeSet> = (0..=cones.len()).map(|count| model.fit(&cones[..count])).collect();
            for rule in [CurvatureRule::Optimal, CurvatureRule::Harmonic] {
                for (set, configuration) in sets.iter().zip(Configuration::nested(&operators, &sets, rule, Watch::NONE))
                {
                    let used = cone_curvatures(&operators, &mesh, &set.cones, rule, Watch::NONE);
                    let Some(configuration) = configuration else { continue };
                    let used = used.expect("they can take the curvature");
                    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7);
                    assert!(near(&configuration.curvature, &used.curvature), "{rule:?}: {configuration:?} {used:?}");
                    assert!(near(&configuration.log_scale(&operators), &used.predicted), "{rule:?}");
                    let alone = Configuration::new(&operators, set, rule);
                    assert!(near(&configuration.curvature, &alone.curvature));
                }
            }
        }
    }

    #[test]
    fn harmonic_curvatures_out_of_bounds_are_replaced_as_they_will_be() {
        let shape = shapes::torus(2, 400);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let mut model = EnergyModel::new(&operators, &mesh);
        let mut replaced = 0;
        for k in 0..60 {
            let cones = [7 * k, 8 * k + 1].map(|v| VertexId(v % mesh.vertex_count() as u32));
            let Ok(used) = cone_curvatures(&operators, &mesh, &cones, CurvatureRule::Harmonic, Watch::NONE) else {
                continue;
            };
            model.add(&cones);
            let configuration = Configuration::new(&operators, &model.fit(&cones), CurvatureRule::Harmonic);
            let near = configuration.curvature.iter().zip(&used.curvature).all(|(a, b)| (a - b).abs() < 1e-7);
            assert!(near, "{configuration:?} {used:?}");
            replaced += usize::from(!used.out_of_bounds.is_empty());
        }
        assert!(replaced >= 2, "{replaced}");
    }
}
