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
        let order = ComponentOrder::new(operators, 1.0, self, rule, watch);
        curve_of_sequence(&[order], &vec![0; self.cones().len()], watch)
    }

    /// The order with others after it, and its curve with what is predicted for these numbers.
    pub(crate) fn followed_by(
        &mut self,
        others: &[VertexId],
        curve: &mut Vec<Prediction>,
        (model, rule): (&mut EnergyModel, CurvatureRule),
    ) {
        model.add(others);
        let known = self.cones().len();
        let cones = [self.cones(), others].concat();
        self.sets.extend((known + 1..=cones.len()).map(|count| model.fit(&cones[..count])));
        let order = ComponentOrder::new(model.operators(), 1.0, self, rule, model.watch());
        let further = curve_from(&[order], vec![known], &vec![0; others.len()], model.watch());
        curve.extend(further.into_iter().filter(|point| point.count > known));
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
}

/// What is predicted for each number of cones that can take the curvature of all components. A back-substitution for each. Once the
/// watch says stop it ends early.
pub(crate) fn curve_of_sequence(components: &[ComponentOrder], sequence: &[usize], watch: Watch) -> Vec<Prediction> {
    curve_from(components, vec![0; components.len()], sequence, watch)
}

/// The same, the sequence being what follows so many cones of each component.
fn curve_from(
    components: &[ComponentOrder],
    mut counts: Vec<usize>,
    sequence: &[usize],
    watch: Watch,
) -> Vec<Prediction> {
    let mut predictor = Predictor::new(components.len());
    let put = |predictor: &mut Predictor, p: usize, count: usize| {
        if let Some(configuration) = &components[p].prefixes[count] {
            let u = configuration.log_scale(components[p].operators);
            predictor.put(p, components[p].operators, components[p].area, count, u);
        }
    };
    let is_able = |counts: &[usize]| components.iter().zip(counts).all(|(part, &count)| part.prefixes[count].is_some());
    counts.iter().enumerate().for_each(|(p, &count)| put(&mut predictor, p, count));
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

#[cfg(test)]
mod tests {
    use geom::{Metric, shapes};

    use super::*;
    use crate::placement::pursuit;

    #[test]
    fn an_order_followed_by_others_is_the_order_of_all() {
        for shape in [shapes::hare(500), shapes::torus(2, 500), shapes::terrain(500, 3)] {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let mut model = EnergyModel::new(&operators, &mesh);
            let cones = pursuit(&mut model, 12).cones().to_vec();
            for rule in [CurvatureRule::Optimal, CurvatureRule::Harmonic] {
                let all = Nested::new(&mut model, &cones);
                for first in [0, 1, 7, 12] {
                    let mut order = Nested::new(&mut model, &cones[..first]);
                    let mut curve = order.curve(&operators, rule, Watch::NONE);
                    order.followed_by(&cones[first..], &mut curve, (&mut model, rule));
                    assert_eq!(order.sets, all.sets);
                    assert_eq!(curve, all.curve(&operators, rule, Watch::NONE));
                }
            }
        }
    }
}
