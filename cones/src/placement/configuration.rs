//! Cones with the curvatures that a rule gives them, and the log scale factor that comes of it, by linear theory.
//!
//! Optimal curvatures leave every boundary loop its own best constant; harmonic ones pin the log scale to one value at all
//! cones and on all of the boundary. Harmonic curvatures that no cone can have are replaced by optimal ones, as
//! [`cone_curvatures`](crate::cone_curvatures) does.

use geom::{VertexData, VertexId};

use crate::angles::{Angles, is_buildable};
use crate::operators::Operators;
use crate::pinned::Pinned;
use crate::reduced::Fitted;

/// See the module's head.
#[derive(Clone, Debug)]
pub(crate) struct Settled {
    cones: Vec<VertexId>,
    pub(crate) curvature: Vec<f64>,
    /// The rule that has given them.
    angles: Angles,
}

impl Settled {
    /// The curvatures of one set of cones: a solve for each if they are harmonic.
    pub(crate) fn new(operators: &Operators, set: &Fitted, angles: Angles) -> Self {
        let pinned = |cones: &[VertexId]| {
            let mut pinned = Pinned::new(operators);
            pinned.add(cones);
            pinned
        };
        match angles {
            Angles::Optimal => Self::optimal(set),
            Angles::Harmonic => Self::harmonic(set, &pinned(&set.cones)),
        }
    }

    /// The curvatures of sets each of which begins with the one before, as long as they can take the surface's curvature;
    /// no more solves than for the last of them.
    pub(crate) fn nested(operators: &Operators, sets: &[Fitted], angles: Angles) -> Vec<Option<Self>> {
        let able = |set: &Fitted| set.shortfall == 0.0;
        match angles {
            Angles::Optimal => sets.iter().map(|set| able(set).then(|| Self::optimal(set))).collect(),
            Angles::Harmonic => {
                let mut pinned = Pinned::new(operators);
                let mut settle = |set: &Fitted| {
                    let known = pinned.cones().len();
                    pinned.add(&set.cones[known..]);
                    able(set).then(|| Self::harmonic(set, &pinned))
                };
                sets.iter().map(&mut settle).collect()
            }
        }
    }

    fn optimal(set: &Fitted) -> Self {
        Self { cones: set.cones.clone(), curvature: set.curvature.clone(), angles: Angles::Optimal }
    }

    fn harmonic(set: &Fitted, pinned: &Pinned) -> Self {
        let buildable = |k: &Vec<f64>| k.iter().zip(&set.bounds).all(|(&k, bound)| is_buildable(k, bound[0]));
        match pinned.curvature().filter(buildable) {
            Some(curvature) => Self { cones: set.cones.clone(), curvature, angles: Angles::Harmonic },
            None => Self::optimal(set),
        }
    }

    /// The log scale factor, centred. Half a solve.
    pub(crate) fn log_scale(&self, operators: &Operators) -> VertexData<f64> {
        let mut u = operators.uncentred_log_scale(&self.cones, &self.curvature);
        match self.angles {
            Angles::Optimal => operators.centre(&mut u),
            Angles::Harmonic => operators.subtract_mean(&mut u),
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angles::cone_curvatures;
    use crate::reduced::Reduced;
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
            let mut reduced = Reduced::new(&operators, &mesh);
            reduced.add(&cones);
            let sets: Vec<Fitted> = (0..=cones.len()).map(|count| reduced.fit(&cones[..count])).collect();
            for angles in [Angles::Optimal, Angles::Harmonic] {
                for (set, settled) in sets.iter().zip(Settled::nested(&operators, &sets, angles)) {
                    let used = cone_curvatures(&operators, &mesh, &set.cones, angles);
                    let Some(settled) = settled else { continue };
                    let used = used.expect("they can take the curvature");
                    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7);
                    assert!(near(&settled.curvature, &used.curvature), "{angles:?}: {settled:?} {used:?}");
                    assert!(near(&settled.log_scale(&operators), &used.predicted), "{angles:?}");
                    let alone = Settled::new(&operators, set, angles);
                    assert!(near(&settled.curvature, &alone.curvature));
                }
            }
        }
    }
}
