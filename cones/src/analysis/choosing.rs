//! From what a user wants to cones on every component.

use std::sync::Arc;

use super::Analysis;
use super::apportionment::counts;
use super::component::Component;
use super::cones::{ChosenNumber, Cones, Configuration};
use super::instances::{each, each_shape};
use super::note::Note;
use super::observer::{Stage, Task, Times};
use super::options::{ConeChoice, Options, Recipe};
use super::order::whole_curve;
use crate::curvature::CurvatureRule;
use crate::error::Error;
use crate::field::Operators;
use crate::placement::{
    Automatic, Goal, MOST_OPTIMISED, MOST_ORDERED, MOST_STRETCH, Nested, Placement, Prediction, Predictor,
    area_distortion, stretch,
};

/// The area distortion that is aimed at when nobody says.
pub const TARGET_DISTORTION: f64 = 1.25;

/// No more cones than this are taken on a component by themselves, unless they would leave more than
/// [`TOLERABLE_DISTORTION`](crate::TOLERABLE_DISTORTION).
pub const MOST_AUTOMATIC: usize = 32;

/// The area distortion that is not exceeded to save cones: a gear of 28 teeth takes 80 for it, where 32 leave 1.66.
pub const TOLERABLE_DISTORTION: f64 = 1.3;

/// Where cones leave too much to distort, at least and at most so many times as many are tried next.
const GROWTH: [f64; 2] = [1.25, 2.0];
/// Of the inner vertices at most one in so many is made a cone where more cones are tried, of 567 vertices 512 take 7 s to place,
const FEWEST_BESIDE: usize = 2;
/// but of so few all.
const FEW: usize = 64;

/// What is chosen for a model, and for each component.
pub(super) type Chosen = (Shared, Vec<Result<Configuration, Error>>);

/// What is found before components are worked on by themselves.
#[derive(Default)]
pub(super) struct Shared {
    pub(super) notes: Vec<Note>,
    pub(super) number: Option<ChosenNumber>,
    /// For each component what an automatic number is that of; nothing where numbers are not automatic.
    pub(super) found: Vec<Automatic>,
    pub(super) times: Times,
}

/// What is known of a component when an automatic number is asked for.
#[derive(Clone, Copy)]
pub(super) enum Known<'a> {
    /// Nothing.
    Nothing,
    /// That its handles may be opened, so that a draft will do; see [`Goal`].
    MayBeOpened,
    /// What an automatic number is.
    Found(&'a Automatic),
}

impl Analysis {
    /// The cones that the options ask for.
    ///
    /// # Errors
    /// If a given cone is none, if given curvatures are impossible, if cones cannot take the curvature of a component, or if the
    /// observer has said stop.
    pub fn choose(&self, options: &Options) -> Result<Cones, Error> {
        self.chosen(self.configurations(options, &|_| Known::Nothing, &self.task())?, options)
    }

    /// What was chosen, told, with more cones where these would leave too much to distort.
    pub(super) fn chosen(&self, chosen: Chosen, options: &Options) -> Result<Cones, Error> {
        let (shared, configurations) = self.enough(chosen, options, &self.task())?;
        let configurations = configurations.into_iter().collect::<Result<Vec<Configuration>, Error>>()?;
        Ok(self.cones(options, shared, configurations))
    }

    /// What the options ask for on each component, or why it cannot be had there. An automatic number is not looked for again where it
    /// is known.
    pub(super) fn configurations<'a>(
        &self,
        options: &Options,
        known: &(dyn Fn(usize) -> Known<'a> + Sync),
        task: &Task,
    ) -> Result<Chosen, Error> {
        let mut shared = Shared::default();
        options.cones.check()?;
        let configurations = match &options.cones {
            ConeChoice::Automatic => {
                self.fewest(&mut shared, options, (TARGET_DISTORTION, MOST_AUTOMATIC), known, task)?
            }
            ConeChoice::WithinDistortion(target) => {
                self.fewest(&mut shared, options, (*target, MOST_ORDERED), known, task)?
            }
            ConeChoice::Count(total) => {
                let counts = self.apportion(&mut shared, options, *total, task)?;
                self.placed(&mut shared, options, &counts, task)?
            }
            ConeChoice::Each(counts) => {
                let counts = self.at_least(&mut shared, counts)?;
                self.placed(&mut shared, options, &counts, task)?
            }
            ConeChoice::MinPersistence(threshold) => {
                let counts = self.above(&mut shared, *threshold);
                self.placed(&mut shared, options, &counts, task)?
            }
            ConeChoice::Given(_) | ConeChoice::Recipe(_) => {
                let given = &self.on_surface(&options.cones.given().unwrap_or_default())?;
                let filled = |size: Option<f64>| size.unwrap_or(0.0);
                let now = filled(self.found.making.preparation.fill_holes);
                if let Some(recipe) = options.cones.recipe().filter(|recipe| filled(recipe.filled) > now) {
                    return Err(Error::NotFilled(filled(recipe.filled)));
                }
                let is_of_charts = options.cones.recipe().is_some_and(|recipe| recipe.charts);
                each(self.components(), &mut shared.times, |component, times| {
                    task.stage((Stage::Curvature, component.index), times, |watch| {
                        let here = &given[component.index];
                        component.given(here, options, watch).map_err(|error| match error {
                            Error::CurvatureSum { .. } | Error::Curvature(_) if is_of_charts => Error::OtherSeams,
                            Error::CurvatureSum { .. } | Error::Curvature(_) if component.filled.is_some() => {
                                Error::ConesForHoles
                            }
                            error => self.naming_a_part(error),
                        })
                    })
                })?
            }
        };
        Ok((shared, configurations))
    }

    /// What concerns a part, of which the only one has no number.
    fn naming_a_part(&self, error: Error) -> Error {
        match (error, self.components()) {
            (Error::CurvatureSum { sum, total, has_handles, .. }, [_]) => {
                Error::CurvatureSum { part: None, sum, total, has_handles }
            }
            (error, _) => error,
        }
    }

    /// What was chosen, with more cones where these would leave too much to distort.
    fn enough(
        &self,
        (mut shared, mut configurations): Chosen,
        options: &Options,
        task: &Task,
    ) -> Result<Chosen, Error> {
        let Some(goal) = options.cones.goal() else { return Ok((shared, configurations)) };
        let is_same = |one: usize, other: usize| are_same(&configurations[one], &configurations[other]);
        let more = each_shape(self.components(), &mut shared.times, is_same, |component, times| {
            let Ok(chosen) = &configurations[component.index] else { return Ok(None) };
            component.enough(chosen, goal, options, task, times)
        })?;
        if more.iter().all(Option::is_none) {
            return Ok((shared, configurations));
        }
        for (configuration, more) in configurations.iter_mut().zip(more) {
            if let Some(more) = more {
                *configuration = Ok(more);
            }
        }
        if let (Some(number), Some(all)) = (&mut shared.number, self.predicted(&configurations)) {
            (number.chosen, number.predicted) = (all.count, all.area_distortion);
            let by_itself = self.predicted_by_itself(&configurations, false);
            let target = number.target;
            number.is_met = by_itself.iter().flatten().all(|part| part.area_distortion <= target);
        }
        Ok((shared, configurations))
    }

    /// Cones as they are told of.
    pub(super) fn cones(&self, options: &Options, shared: Shared, configurations: Vec<Configuration>) -> Cones {
        let mut predictor = Predictor::new(self.components().len());
        let mut cones = Vec::new();
        for (component, configuration) in self.components().iter().zip(&configurations) {
            let Configuration { vertices, curvature, predicted, .. } = configuration;
            let told = vertices.iter().zip(curvature).map(|(&v, &k)| component.cone(v, k, self.points()));
            cones.extend(told);
            predictor.put(component.index, &component.operators, component.area, vertices.len(), predicted.clone());
        }
        let Shared { mut notes, number, times, .. } = shared;
        notes.extend(configurations.iter().flat_map(|configuration| configuration.notes.iter().cloned()));
        let most = configurations.iter().map(|c| c.vertices.len()).max().unwrap_or(0);
        let recipe = Recipe {
            target: options.cones.wanted(),
            freed: options.cones.recipe().map_or_else(Vec::new, |recipe| recipe.freed.clone()),
            ..self.recipe(configurations.iter().map(Configuration::cones))
        };
        Cones {
            cones,
            recipe,
            placement: (!options.cones.is_given()).then(|| options.placement_for(most)),
            rule: options.rule,
            prediction: predictor.prediction(),
            number,
            notes,
            times,
            configurations,
            analysis: self.id(),
            quantize: options.quantize,
        }
    }

    /// How many cones each component gets of numbers for each: those, or as many as it needs.
    fn at_least(&self, shared: &mut Shared, counts: &[usize]) -> Result<Vec<usize>, Error> {
        let components = self.components();
        if counts.len() > components.len() {
            return Err(Error::NumbersWithoutParts { numbers: counts.len(), parts: components.len() });
        }
        let of_component = |component: &Arc<Component>| {
            let asked = counts.get(component.index).copied().unwrap_or(0);
            let taken = asked.max(component.least());
            if taken > asked {
                shared.notes.push(Note::MoreForCurvature { component: component.index, asked, taken });
            }
            taken
        };
        Ok(components.iter().map(of_component).collect())
    }

    /// How many cones each component gets of a total.
    fn apportion(
        &self,
        shared: &mut Shared,
        options: &Options,
        total: usize,
        task: &Task,
    ) -> Result<Vec<usize>, Error> {
        let components = self.components();
        let needed: usize = components.iter().map(|component| component.least()).sum();
        if total < needed {
            shared.notes.push(Note::FewerThanNeeded { asked: total, needed, components: components.len() });
        }
        let placement = options.placement_for(total.saturating_sub(needed));
        Ok(task.stage((Stage::Hierarchy, 0), &mut shared.times, |watch| {
            counts(components, (placement, options.search), total, watch)
        })??)
    }

    /// How many cones each component gets by a threshold of persistence.
    fn above(&self, shared: &mut Shared, threshold: f64) -> Vec<usize> {
        let components = self.components();
        let above: Vec<usize> = components.iter().map(|c| c.hierarchy.count_above(&c.operators, threshold)).collect();
        let counts: Vec<usize> = components.iter().zip(&above).map(|(c, &above)| above.max(c.least())).collect();
        let [above, taken] = [&above, &counts].map(|counts| counts.iter().sum::<usize>());
        if above < taken {
            shared.notes.push(Note::FewExtrema { threshold, above, taken, components: components.len() });
        }
        counts
    }

    /// So many cones on each component.
    fn placed(
        &self,
        shared: &mut Shared,
        options: &Options,
        counts: &[usize],
        task: &Task,
    ) -> Result<Vec<Result<Configuration, Error>>, Error> {
        let is_same = |one: usize, other: usize| counts[one] == counts[other] && options.seams.avoid.is_empty();
        each_shape(self.components(), &mut shared.times, is_same, |component, times| {
            interrupted_or(component.place(options, counts[component.index], task, times))
        })
    }

    /// As few cones on each component as keep the predicted area distortion within a target.
    fn fewest<'a>(
        &self,
        shared: &mut Shared,
        options: &Options,
        (target, most): (f64, usize),
        known: &(dyn Fn(usize) -> Known<'a> + Sync),
        task: &Task,
    ) -> Result<Vec<Result<Configuration, Error>>, Error> {
        let Options { placement, rule, .. } = *options;
        let to_knee = options.cones == ConeChoice::Automatic;
        let components = self.components();
        // Where seams may not go differs from instance to instance.
        let is_plain = options.seams.avoid.is_empty();
        let is_same = |one: usize, other: usize| match [one, other].map(known) {
            _ if !is_plain => false,
            [Known::Found(one), Known::Found(other)] => one.set.cones == other.set.cones,
            [one, other] => std::mem::discriminant(&one) == std::mem::discriminant(&other),
        };
        let found: Vec<Automatic> = each_shape(components, &mut shared.times, is_same, |component, times| {
            let is_draft = match known(component.index) {
                Known::Found(found) => return Ok(found.clone()),
                known => matches!(known, Known::MayBeOpened),
            };
            let goal = Goal { target, most, to_knee, is_draft, is_part: components.len() > 1 };
            task.stage((Stage::Hierarchy, component.index), times, |watch| {
                let found = placement.fewest(component.ground(options.search, watch), rule, goal)?;
                Ok(match component.moved_off_avoided(&found.set.cones, options, watch)? {
                    Some((model, set)) => found.moved(&model, set, rule, target),
                    None => found,
                })
            })?
        })?;
        let (predicted, curve) = match &found[..] {
            [alone] => (alone.predicted, alone.curve.clone()),
            _ => task.stage((Stage::Hierarchy, 0), &mut shared.times, |watch| {
                let predicted = predict_together(components, &found, rule);
                let nested: Vec<Nested> = found.iter().map(|found| found.nested.clone()).collect();
                let most = (2 * predicted.count).max(most);
                let grounds: Vec<&Operators> = components.iter().zip(&found).map(|(c, f)| c.operators_of(f)).collect();
                (predicted, whole_curve(components, (&nested, &grounds), (placement, rule), most, watch))
            })?,
        };
        let is_met = found.iter().all(|found| found.is_met);
        let Prediction { count: chosen, area_distortion: predicted, .. } = predicted;
        shared.number = Some(ChosenNumber { target, chosen, predicted, is_met, curve });
        let is_same = |one: usize, other: usize| found[one].set.cones == found[other].set.cones;
        let configurations = each_shape(components, &mut shared.times, is_same, |component, times| {
            let Automatic { set, curvatures, .. } = &found[component.index];
            let vertices = set.cones.clone();
            if let (Some(known), None) = (curvatures, options.quantize) {
                return Ok(Ok(component.configured(vertices, known.clone())));
            }
            task.stage((Stage::Curvature, component.index), times, |watch| {
                component.with_curvatures(vertices, options, watch).map_err(Error::from)
            })
        })?;
        shared.found = found;
        Ok(configurations)
    }
}

impl Component {
    /// How many cones are tried at most where those chosen are too few.
    pub(super) fn most_cones(&self) -> usize {
        let inner = self.inner_vertices();
        inner.min(FEW.max(inner / FEWEST_BESIDE))
    }

    /// More cones where those chosen miss a goal by what is predicted, as few as it takes about. Where no number is good enough none, or those that come
    /// nearest if the goal is what was asked for.
    pub(super) fn enough(
        &self,
        chosen: &Configuration,
        goal: f64,
        options: &Options,
        task: &Task,
        times: &mut Times,
    ) -> Result<Option<Configuration>, Error> {
        let excess =
            |chosen: &Configuration| (area_distortion(&self.operators, &chosen.predicted) - 1.0) / (goal - 1.0);
        let (mut count, mut least, mut nearest) = (chosen.vertices.len(), excess(chosen), None);
        let mut now = least;
        let most = self.most_cones().min(MOST_OPTIMISED);
        while now > 1.0 && count < most {
            let [slowest, fastest] = GROWTH;
            count = ((count as f64 * now.clamp(slowest, fastest)).ceil() as usize).clamp(count + 1, most);
            if options.placement_for(count) != options.placement {
                break;
            }
            let Ok(more) = interrupted_or(self.place_by(Placement::quick_cones, options, count, task, times))? else {
                break;
            };
            now = excess(&more);
            if now < least && stretch(&self.operators, more.predicted.clone()) <= MOST_STRETCH.ln() {
                (least, nearest) = (now, Some(more));
            }
        }
        let is_asked_for = matches!(options.cones, ConeChoice::WithinDistortion(_));
        Ok(nearest.filter(|_| least <= 1.0 || is_asked_for))
    }
}

impl ConeChoice {
    /// The area distortion that somebody asked for.
    pub(super) fn wanted(&self) -> Option<f64> {
        match self {
            Self::WithinDistortion(target) => Some(*target),
            Self::Recipe(recipe) => recipe.target,
            _ => None,
        }
    }

    /// The area distortion that is not exceeded as long as more cones help.
    pub(super) fn goal(&self) -> Option<f64> {
        match self {
            Self::Automatic => Some(TOLERABLE_DISTORTION),
            Self::WithinDistortion(target) => Some(*target),
            _ => None,
        }
    }
}

/// Whether two components of the same shape have the same cones.
pub(super) fn are_same(one: &Result<Configuration, Error>, other: &Result<Configuration, Error>) -> bool {
    match (one, other) {
        (Ok(one), Ok(other)) => one.is_same(other),
        (one, other) => one.is_err() && other.is_err(),
    }
}

/// Why cones cannot be had on one component is its own affair; a stop is everybody's.
pub(super) fn interrupted_or<T>(done: Result<T, Error>) -> Result<Result<T, Error>, Error> {
    match done {
        Err(Error::Interrupted) => Err(Error::Interrupted),
        done => Ok(done),
    }
}

/// What is predicted for all components together, with the cones that were found for each.
fn predict_together(components: &[Arc<Component>], found: &[Automatic], rule: CurvatureRule) -> Prediction {
    let mut predictor = Predictor::new(components.len());
    for (component, found) in components.iter().zip(found) {
        let u = found.log_scale(&component.operators, rule);
        predictor.put(component.index, &component.operators, component.area, found.set.cones.len(), u);
    }
    predictor.prediction()
}
