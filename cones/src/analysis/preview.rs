//! Cones for a slider: any number of them at once, with what is predicted.
//!
//! The first question finds a nested order on the coarse level of each component ([`Search::CoarseToFine`]) and what is predicted
//! there for every number; it is kept, and all further questions are answered from it. The order is found in blocks of 32 cones,
//! each beginning with all before it, so that what is answered depends on no other question.

use std::sync::Arc;

use super::Analysis;
use super::apportionment::sequence_of;
use super::component::Component;
use super::cones::Cone;
use super::instances::of_shapes;
use super::observer::{Stage, Times};
use super::order::{affordable, component_orders};
use crate::curvature::CurvatureRule;
use crate::error::Error;
use crate::field::Operators;
use crate::placement::{BLOCK, Nested, Placement, Prediction, Search, curve_of_sequence, searched_order};

/// Cones with what is predicted for them; see [`Analysis::preview`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Preview {
    /// The cones, component by component, with optimal curvatures.
    pub cones: Vec<Cone>,
    /// What is predicted: on surfaces of thousands of vertices within some percent of [`Analysis::predict`].
    pub prediction: Prediction,
}

/// An order of cones for the whole model with all that is predicted.
#[derive(Debug)]
pub(super) struct PreviewOrder {
    /// The vertices of each component with the curvatures of every prefix.
    nested: Vec<Nested>,
    /// The component that gets the next cone.
    sequence: Vec<usize>,
    curve: Vec<Prediction>,
}

impl Analysis {
    /// About `count` cones: the nearest number below that can take the model's curvature, or the least one above; at most 64, or as
    /// many as the model needs, and of several parts until one of them has 64. They are those of [`Placement::Pursuit`] on a coarse level.
    ///
    /// Made for a slider. The first call simplifies surfaces of 8,000 vertices and more (about half the time of factoring the
    /// Laplacian) and searches on what is left (some tenths of a second, whatever the size); the first beyond 32 searches again. All
    /// others take microseconds.
    ///
    /// ```
    /// let analysis = cones::Analysis::new(&geom::shapes::hare(700).into())?;
    /// let [few, many] = [analysis.preview(6)?, analysis.preview(20)?];
    /// assert!(few.cones.iter().all(|cone| many.cones.iter().any(|other| other.vertex == cone.vertex)));
    /// assert!(many.prediction.area_distortion < few.prediction.area_distortion);
    /// # Ok::<(), cones::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the observer has said stop.
    pub fn preview(&self, count: usize) -> Result<Preview, Error> {
        let blocks = if count <= BLOCK { 1 } else { 2 };
        let known = &self.found.previews[blocks - 1];
        let order = match known.get() {
            Some(order) => order,
            None => {
                let found = self.preview_order(blocks * BLOCK)?;
                known.get_or_init(|| found)
            }
        };
        Ok(order.first(self, count))
    }

    fn preview_order(&self, most: usize) -> Result<PreviewOrder, Error> {
        let task = self.task();
        let components = self.components();
        let find = |component: &Arc<Component>| -> Result<Nested, Error> {
            let mut times = Times::default();
            Ok(task.stage((Stage::Hierarchy, component.index), &mut times, |watch| {
                searched_order(component.ground(Search::CoarseToFine, watch), most, false)
            })??)
        };
        let mut nested = of_shapes(components, find).into_iter().collect::<Result<Vec<Nested>, Error>>()?;
        let total = match components.len() {
            1 => self.least_cones().max(most),
            parts => affordable(components, self.least_cones() + parts * most),
        };
        let sequence = sequence_of(components, &nested, Placement::Pursuit, total);
        let curve = task.stage((Stage::Hierarchy, 0), &mut Times::default(), |watch| {
            let operators: Vec<&Operators> = components.iter().map(|component| component.searched()).collect();
            let orders = component_orders(components, (&nested, &operators), CurvatureRule::Optimal, watch);
            curve_of_sequence(&orders, &sequence, watch)
        })?;
        for (component, nested) in components.iter().zip(&mut nested) {
            if let Some(level) = component.level() {
                nested.sets.iter_mut().for_each(|set| set.cones = level.of_surface(&set.cones));
            }
        }
        Ok(PreviewOrder { nested, sequence, curve })
    }
}

impl PreviewOrder {
    fn first(&self, analysis: &Analysis, count: usize) -> Preview {
        let within = self.curve.iter().rev().find(|point| point.count <= count);
        let Some(prediction) = within.or(self.curve.first()).copied() else {
            return Preview { cones: Vec::new(), prediction: Prediction::none() };
        };
        let mut counts = vec![0; self.nested.len()];
        self.sequence[..prediction.count].iter().for_each(|&p| counts[p] += 1);
        let of_component = |((component, nested), count): ((&Arc<Component>, &Nested), usize)| {
            let set = &nested.sets[count];
            let cone = |(&v, &k): (&_, &f64)| component.cone(v, k, analysis.points());
            set.cones.iter().zip(&set.curvature).map(cone).collect::<Vec<Cone>>()
        };
        let cones = analysis.components().iter().zip(&self.nested).zip(counts).flat_map(of_component).collect();
        Preview { cones, prediction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::{ConeChoice, Options};
    use geom::shapes;

    #[test]
    fn previews_depend_on_no_other_question_and_are_nested() {
        let model = shapes::hare(700).into();
        let [first, second] = [(); 2].map(|()| Analysis::new(&model).unwrap());
        let counts = [40, 3, 12, 32, 33];
        let up: Vec<Preview> = counts.iter().map(|&count| first.preview(count).unwrap()).collect();
        let down: Vec<Preview> = counts.iter().rev().map(|&count| second.preview(count).unwrap()).collect();
        assert!(up.iter().eq(down.iter().rev()));
        for (preview, count) in up.iter().zip(counts) {
            assert_eq!((preview.cones.len(), preview.prediction.count), (count, count));
            let sum: f64 = preview.cones.iter().map(|cone| cone.curvature).sum();
            assert!((sum - 4.0 * std::f64::consts::PI).abs() < 1e-6);
            assert!(preview.cones.iter().all(|cone| up[0].cones.iter().any(|other| other.vertex == cone.vertex)));
        }
        assert_eq!(first.preview(0).unwrap().cones.len(), 3, "a sphere needs three");
        assert_eq!(first.preview(1000).unwrap().cones.len(), 64);
    }

    #[test]
    fn several_parts_have_as_many_more_as_they_need() {
        let ball = shapes::sphere(300);
        let points = (0..30).flat_map(|k| ball.points.iter().map(move |p| [p[0] + 3.0 * f64::from(k), p[1], p[2]]));
        let first = |k: u32| k * ball.points.len() as u32;
        let triangles: Vec<[u32; 3]> =
            (0..30).flat_map(|k| ball.triangles.iter().map(move |t| t.map(|v| first(k) + v))).collect();
        let model = geom::Model::from_triangles(points.collect(), &triangles).unwrap();
        let analysis = Analysis::new(&model).unwrap();
        assert_eq!(analysis.least_cones(), 90);
        let [least, more] = [90, 400].map(|count| analysis.preview(count).unwrap());
        assert_eq!([least.cones.len(), more.cones.len()], [90, 400]);
        assert!(more.prediction.area_distortion < least.prediction.area_distortion);
    }

    #[test]
    fn what_is_predicted_on_a_coarse_level_is_near_to_what_is_predicted_on_the_surface() {
        let model = shapes::hare(9000).into();
        let analysis = Analysis::new(&model).unwrap();
        for count in [6, 16] {
            let preview = analysis.preview(count).unwrap();
            let given = preview.cones.iter().map(|cone| (cone.vertex, Some(cone.curvature))).collect();
            let options = Options { cones: ConeChoice::Given(given), ..Options::default() };
            let exact = analysis.choose(&options).unwrap().prediction();
            let ratio = preview.prediction.log_scale_norm / exact.log_scale_norm;
            assert!((ratio - 1.0).abs() < 0.05, "{count} cones: {ratio}");
            let excess = preview.prediction.area_distortion / exact.area_distortion;
            assert!((excess - 1.0).abs() < 0.1, "{count} cones: {excess}");
        }
    }
}
