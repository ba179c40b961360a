//! Cones for a slider: any number of them at once, with what is predicted.
//!
//! The first question finds a nested order on the coarse level of each component ([`Search::CoarseToFine`]) and what is predicted
//! there for every number; it is kept, and all further questions are answered from it. The order is found in blocks of 32 cones,
//! each beginning with all before it, so that what is answered depends on no other question.

use rayon::prelude::*;

use super::Analysis;
use super::apportionment::sequence_of;
use super::component::Component;
use super::cones::Cone;
use super::observer::{Stage, Times};
use crate::curvature::CurvatureRule;
use crate::error::Error;
use crate::placement::{BLOCK, ComponentOrder, Nested, Placement, Prediction, Search, coarse_order, curve_of_sequence};

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
    /// About `count` cones: the nearest number below that can take the model's curvature, or the least one above; at most 32 more
    /// than the model needs, or 64 where more than these are asked for. They are those of [`Placement::Pursuit`] on a coarse level.
    ///
    /// Made for a slider. The first call, and the first beyond 32, takes some tenths of a second, or a second for a million vertices:
    /// as long as factoring the Laplacian at most. All others take microseconds.
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
        let spare = count.saturating_sub(self.least_cones());
        let blocks = if spare <= BLOCK { 1 } else { 2 };
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

    fn preview_order(&self, spare: usize) -> Result<PreviewOrder, Error> {
        let task = self.task();
        let components = self.components();
        let find = |component: &Component| -> Result<Nested, Error> {
            let most = component.least() + spare;
            let mut times = Times::default();
            Ok(task.stage((Stage::Hierarchy, component.index), &mut times, |watch| {
                coarse_order(component.ground(Search::CoarseToFine, watch), most)
            })??)
        };
        let nested = components.par_iter().with_max_len(1).map(find).collect::<Vec<_>>();
        let mut nested = nested.into_iter().collect::<Result<Vec<Nested>, Error>>()?;
        let sequence = sequence_of(components, &nested, Placement::Pursuit, self.least_cones() + spare);
        let curve = task.stage((Stage::Hierarchy, 0), &mut Times::default(), |watch| {
            let levels: Vec<ComponentOrder> = components
                .iter()
                .zip(&nested)
                .map(|(component, nested)| {
                    let operators = component.level().map_or(&component.operators, |level| &level.operators);
                    ComponentOrder::new(operators, component.area, nested, CurvatureRule::Optimal, watch)
                })
                .collect();
            curve_of_sequence(&levels, &sequence, watch)
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
        let of_component = |((component, nested), count): ((&Component, &Nested), usize)| {
            let set = &nested.sets[count];
            let cone = |(&v, &k): (&_, &f64)| component.cone(v, k, analysis.points());
            set.cones.iter().zip(&set.curvature).map(cone).collect::<Vec<Cone>>()
        };
        let cones = analysis.components().iter().zip(&self.nested).zip(counts).flat_map(of_component).collect();
        Preview { cones, prediction }
    }
}
