//! Orders of cones every prefix of which is a set of cones, and what is predicted for all of them.

use geom::{VertexId, Watch};

use super::configuration::Configuration;
use super::energy_model::{ConeSet, EnergyModel};
use super::prediction::{Prediction, Predictor};
use crate::curvature::CurvatureRule;
use crate::field::Operators;

/// An order of cones, with the best curvatures of every prefix.
#[derive(Clone, Debug)]
pub struct Nested {
    /// The first N cones with their curvatures, for N from 0 on.
    pub sets: Vec<ConeSet>,
}

impl Nested {
    /// The prefixes of an order of cones. One and a half back-solves for each cone that is not in the pool.
    pub fn new(model: &mut EnergyModel, order: &[VertexId]) -> Self {
        model.add(order);
        Self { sets: (0..=order.len()).map(|count| model.fit(&order[..count])).collect() }
    }

    /// The cones in their order.
    pub fn cones(&self) -> &[VertexId] {
        self.sets.last().map_or(&[], |set| &set.cones)
    }

    /// What is predicted for every number of cones that can take the surface's curvature, with curvatures by a rule. A
    /// back-substitution for each.
    pub(crate) fn curve(&self, operators: &Operators, rule: CurvatureRule, watch: Watch) -> Vec<Prediction> {
        ComponentOrder::new(operators, 1.0, self, rule, watch).curve(watch)
    }
}

/// A component with the curvatures of every prefix of its order.
pub(crate) struct ComponentOrder<'a> {
    operators: &'a Operators,
    /// The area in the model.
    area: f64,
    cones: Vec<VertexId>,
    /// For each number of cones, from 0 on; none where so many cannot take its curvature.
    prefixes: Vec<Option<Configuration>>,
}

impl<'a> ComponentOrder<'a> {
    /// Costs no solves, or one for each cone if curvatures are harmonic.
    pub(crate) fn new(operators: &'a Operators, area: f64, nested: &Nested, rule: CurvatureRule, watch: Watch) -> Self {
        let prefixes = Configuration::nested(operators, &nested.sets, rule, watch);
        Self { operators, area, cones: nested.cones().to_vec(), prefixes }
    }

    /// The curve of this component alone.
    fn curve(self, watch: Watch) -> Vec<Prediction> {
        let sequence = vec![0; self.cones.len()];
        curve_of_sequence(&[self], &sequence, watch)
    }
}

/// What is predicted for each number of cones that can take the curvature of all components. A back-substitution for each. Once the
/// watch says stop it ends early.
pub(crate) fn curve_of_sequence(components: &[ComponentOrder], sequence: &[usize], watch: Watch) -> Vec<Prediction> {
    let mut predictor = Predictor::new(components.len());
    let mut counts = vec![0; components.len()];
    let put = |predictor: &mut Predictor, p: usize, count: usize| {
        if let Some(configuration) = &components[p].prefixes[count] {
            let u = configuration.log_scale(components[p].operators);
            predictor.put(p, components[p].operators, components[p].area, count, u);
        }
    };
    let is_able = |counts: &[usize]| components.iter().zip(counts).all(|(part, &count)| part.prefixes[count].is_some());
    (0..components.len()).for_each(|p| put(&mut predictor, p, 0));
    let mut curve: Vec<Prediction> = is_able(&counts).then(|| predictor.prediction()).into_iter().collect();
    for (k, &p) in sequence.iter().enumerate() {
        if watch.stops_at(k as f64 / sequence.len() as f64) {
            break;
        }
        counts[p] += 1;
        put(&mut predictor, p, counts[p]);
        if is_able(&counts) {
            curve.push(predictor.prediction());
        }
    }
    curve
}

/// The cones of a sequence: component, vertex of it, and curvature, which is none where the cones so far are too few to take
/// the component's curvature.
pub(crate) fn cones_of_sequence(
    components: &[ComponentOrder],
    sequence: &[usize],
) -> Vec<(usize, VertexId, Option<f64>)> {
    let mut counts = vec![0; components.len()];
    let cone = |&p: &usize| {
        let at = counts[p];
        counts[p] += 1;
        let curvature = components[p].prefixes[at + 1].as_ref().map(|configuration| configuration.curvature[at]);
        (p, components[p].cones[at], curvature)
    };
    sequence.iter().map(cone).collect()
}
