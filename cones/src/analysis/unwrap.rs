//! From cones on every component to texture coordinates for the model.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use geom::{Id, Model, Watch};
use rayon::prelude::*;

use super::Analysis;
use super::atlas::Atlas;
use super::choosing::{Chosen, Known, Shared, TARGET_DISTORTION, are_same};
use super::component::Component;
use super::cones::{ChosenNumber, Cones, Configuration};
use super::flat::{Flat, RIGID_SEAMS};
use super::instances::{each, each_shape};
use super::limbs::{Settled, is_settled};
use super::note::Note;
use super::observer::{Silent, Stage, Task, Times};
use super::options::{ConeChoice, Handles, Options};
use super::packed::{Packed, packed};
use crate::cut::{ModelEdges, SeamFigures, SeamOptions, SeamPlan, Symmetry, Tiling};
use crate::error::Error;
use crate::placement::{Automatic, Prediction, Predictor, distortion_of};

/// Where so few cones keep the area distortion within [`TARGET_DISTORTION`] handles stay closed.
const FEW_CONES: usize = 8;
/// Handles are opened where the excess of the area distortion over 1 is then so many times as large at most, with as many cones at most,
const LESS_DISTORTION: f64 = 0.75;
/// or so many times as many cones are enough for no more of it.
const FEWER_CONES: f64 = 0.75;

/// What drafts leave above 1 of the area distortion is so many times as large, or more, as what the best set of as many cones leaves: 1.2 to
/// 2.4 times on plates with 10 to 24 handles each.
const DRAFT_EXCESS: f64 = 2.0;

/// Handles stay closed where the nested orders of both searches miss the target, and what that of the opened surface leaves above 1 is more than
/// so many times what the other does. On the largest part of the dragon it is .90 times as much, with the best sets .76 times.
const HARDLY_LESS: f64 = 0.85;

/// Surfaces with more vertices are only opened where the coarse level says that it is worth it: to make one ready takes 4 s on the dragon, to search an opened
/// level of it .3 s. Smaller ones are ready in less time, and most often are better opened.
const MOST_OPENED_AT_ONCE: usize = 100_000;
/// So many triangles are gone through one after the other.
const AT_ONCE: usize = 4096;
/// Curvatures that are rounded for a texture are whole multiples of its angle to this.
const ROUNDING: f64 = 1e-9;

/// Whether nested orders tell that handles are not worth opening.
fn is_hardly_worth_opening(closed: &Automatic, opened: &Automatic) -> bool {
    let excess = |found: &Automatic| found.curve.last().map_or(f64::NAN, |last| last.area_distortion - 1.0);
    closed.is_draft && opened.is_draft && excess(opened) > HARDLY_LESS * excess(closed)
}

/// [`is_worth_opening`] where what is predicted for the closed surface is a draft that misses its target: false may only mean that the draft does
/// not say so.
fn is_surely_worth_opening(draft: &Prediction, opened: &Prediction) -> bool {
    let area_distortion = 1.0 + (draft.area_distortion - 1.0) / DRAFT_EXCESS;
    is_worth_opening(&Prediction { area_distortion, ..*draft }, opened)
}

/// Whether cones on the surface with handles opened are so much better that this is worth seams that are not rigid.
fn is_worth_opening(closed: &Prediction, opened: &Prediction) -> bool {
    let [before, after] = [closed, opened].map(|predicted| predicted.area_distortion - 1.0);
    let is_as_good = after <= before || opened.area_distortion <= TARGET_DISTORTION;
    let has_fewer = opened.count as f64 <= FEWER_CONES * closed.count as f64;
    is_as_good && has_fewer || after <= LESS_DISTORTION * before && opened.count <= closed.count
}

/// Unwraps a model in one call: [`Analysis::unwrapped`] unobserved, with the time of both and all that the user
/// should know.
///
/// ```
/// use cones::{ConeChoice, Options, unwrap_model};
///
/// let model = geom::shapes::by_name("capsule", 500).expect("it is built in").into();
/// let options = Options { cones: ConeChoice::Count(4), ..Options::default() };
/// let atlas = unwrap_model(&model, &options)?;
/// assert_eq!(atlas.cones.len(), 4);
/// assert_eq!(atlas.uv.len(), model.corner_count());
/// let total: f64 = atlas.cones.iter().map(|cone| cone.curvature).sum();
/// assert!((total - 4.0 * std::f64::consts::PI).abs() < 1e-9);
/// # Ok::<(), cones::Error>(())
/// ```
///
/// # Errors
/// If the model has no surface, or the options cannot be met.
pub fn unwrap_model(model: &Model, options: &Options) -> Result<Atlas, Error> {
    let (analysis, mut atlas) = Analysis::unwrapped(model, options, Silent)?;
    atlas.times += analysis.times();
    Ok(atlas)
}

/// Positions of the model's corners, as far as they are known.
struct Placed {
    uv: Vec<[f64; 2]>,
    is_placed: Vec<bool>,
}

impl Placed {
    fn new(corners: usize) -> Self {
        Self { uv: vec![[0.0; 2]; corners], is_placed: vec![false; corners] }
    }

    fn at(&self, corner: u32) -> Option<[f64; 2]> {
        self.is_placed[corner as usize].then(|| self.uv[corner as usize])
    }

    fn put(&mut self, corner: u32, position: [f64; 2]) {
        self.uv[corner as usize] = position;
        self.is_placed[corner as usize] = true;
    }

    fn put_if_none(&mut self, corner: u32, position: [f64; 2]) {
        if !self.is_placed[corner as usize] {
            self.put(corner, position);
        }
    }
}

impl Analysis {
    /// Flattens the model with given cones. Fold-overs are removed as far as possible; triangles that stay folded over are
    /// detached and named. No other cones are tried. Where the layout lies over itself it is taken apart.
    ///
    /// # Errors
    /// If the cones are of another analysis, if no flat metric with them is found, or if the observer has said stop.
    pub fn flatten(&self, cones: &Cones) -> Result<Atlas, Error> {
        self.flatten_with(cones, &Options::default())
    }

    /// [`flatten`](Self::flatten), with a say in where seams run and what becomes of the islands: of the options what is said of a map, not
    /// what is said of cones.
    ///
    /// ```
    /// use cones::{Analysis, Options, Placement, SeamOptions};
    ///
    /// let model = geom::shapes::hare(700).into();
    /// let analysis = Analysis::new(&model)?;
    /// let cones = analysis.place(Placement::Refined, 4)?;
    /// let [a, b, ..] = model.face(0) else { unreachable!("a face has three corners") };
    /// let seams = SeamOptions { given: vec![[*a, *b]], ..SeamOptions::default() };
    /// let atlas = analysis.flatten_with(&cones, &Options { seams, ..Options::default() })?;
    /// let is_cut = |seam: &Vec<u32>| seam.windows(2).any(|edge| edge == [*a, *b] || edge == [*b, *a]);
    /// assert!(atlas.seams.iter().any(is_cut));
    /// # Ok::<(), cones::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`flatten`](Self::flatten), and if an edge is none of the model's, or one to be cut is open already.
    pub fn flatten_with(&self, cones: &Cones, options: &Options) -> Result<Atlas, Error> {
        self.check_own(cones)?;
        self.check_seams(&options.seams)?;
        let task = self.task();
        let mut times = Times::default();
        let area = self.area();
        let is_same = |one: usize, other: usize| cones.configurations[one].is_same(&cones.configurations[other]);
        let flats = self.flats(options, &mut times, is_same, |component, times| {
            let plan = self.plan(component, &options.seams, &task, times)?;
            let mut flat = component.flatten(
                &cones.configurations[component.index],
                (&plan, options.may_loosen()),
                &task,
                times,
            )?;
            component.detach_fold_overs(&mut flat);
            component.finish(&mut flat, (options, &plan, component.area / area), &task, times)?;
            flat.notes.extend(component.doubt(&flat, cones.placement.is_none()));
            Ok(flat)
        })?;
        let own = cones.notes.iter().filter(|note| note.component().is_none()).cloned().collect();
        self.assemble(flats, own, (cones.number.clone(), cones.quantize), options, &task, times)
    }

    /// The seams that a map with given cones begins with, as chains of vertices of the model: what [`flatten_with`](Self::flatten_with)
    /// cuts before it knows what folds over or overlaps. A small part of its time.
    ///
    /// # Errors
    /// If the cones are of another analysis, if the surface cannot be cut open, or if the observer has said stop.
    pub fn seams(&self, cones: &Cones, seams: &SeamOptions) -> Result<Vec<Vec<u32>>, Error> {
        self.check_own(cones)?;
        self.check_seams(seams)?;
        let task = self.task();
        let mut times = Times::default();
        let chains = each(self.components(), &mut times, |component, times| {
            let plan = self.plan(component, seams, &task, times)?;
            let vertices = &cones.configurations[component.index].vertices;
            let cut = task.stage((Stage::Cut, component.index), times, |watch| {
                plan.cut(&component.surface.mesh, vertices, watch)
            })??;
            Ok(cut.chains.iter().map(|chain| component.vertices_along(chain)).collect::<Vec<_>>())
        })?;
        Ok(chains.concat())
    }

    /// Only this analysis' own cones can be flattened.
    pub(super) fn check_own(&self, cones: &Cones) -> Result<(), Error> {
        if cones.analysis == self.id() { Ok(()) } else { Err(Error::ForeignCones) }
    }

    /// Chooses cones and flattens the model with them, or on components where these fail with the best of others: see the
    /// notes.
    ///
    /// # Errors
    /// As [`choose`](Self::choose); given cones are never replaced.
    pub fn atlas(&self, options: &Options) -> Result<Atlas, Error> {
        self.check_seams(&options.seams)?;
        if matches!(options.cones, ConeChoice::Given(_)) {
            let cones = self.choose(options)?;
            let mut atlas = self.flatten_with(&cones, options)?;
            atlas.times += cones.times;
            return Ok(atlas);
        }
        self.atlas_beside(&[], options)
    }

    /// The atlas, where something is settled already of parts.
    fn atlas_beside(&self, settled: &[Settled], options: &Options) -> Result<Atlas, Error> {
        let task = self.task();
        let mut tried = Times::default();
        let may_be_opened = self.may_be_opened(options);
        let has_handles = |part: usize| may_be_opened && self.components()[part].has_handles();
        let known = |part: usize| match settled.get(part) {
            Some(Settled { found: Some(found), .. }) => Known::Found(found),
            _ if has_handles(part) => Known::MayBeOpened,
            _ => Known::Nothing,
        };
        let choose = || self.configurations(options, &known, &task);
        let (mut chosen, plan) = match self.components() {
            [alone] if settled.is_empty() && !has_handles(0) => {
                self.planned_meanwhile(choose, alone, options, &task)?
            }
            _ => (choose()?, None),
        };
        let mut taken = self.clone();
        if may_be_opened
            && let Some((opened, other)) = self.opened_instead(&mut chosen, settled, options, &mut tried)?
        {
            tried = opened.times();
            tried += chosen.0.times;
            (taken, chosen) = (opened, other);
        }
        for (configuration, settled) in chosen.1.iter_mut().zip(settled) {
            if let Some(cones) = &settled.cones {
                *configuration = Ok(cones.clone());
            }
        }
        let mut atlas = match self.with_limbs_cut_off((&taken, &mut chosen), options, (settled, &mut tried))? {
            Some(cut_off) => {
                tried += chosen.0.times;
                let atlas = cut_off.analysis.atlas_beside(&cut_off.parts, options);
                cut_off.put_back(atlas)?
            }
            None => taken.with_chosen((chosen, plan), options, &task)?,
        };
        atlas.times += tried;
        Ok(atlas)
    }

    /// What is chosen, and where the seams of the only component go: no cones are needed to know it, and the search for these leaves threads idle.
    fn planned_meanwhile(
        &self,
        choose: impl FnOnce() -> Result<Chosen, Error> + Send,
        component: &Component,
        options: &Options,
        task: &Task,
    ) -> Result<(Chosen, Option<SeamPlan>), Error> {
        let (began, mut of_plan) = (Instant::now(), Times::default());
        let (chosen, plan) = rayon::join(choose, || self.plan(component, &options.seams, task, &mut of_plan));
        let (mut chosen, plan) = (chosen?, plan?);
        chosen.0.times = Times::on_clock([chosen.0.times, of_plan], began.elapsed());
        Ok((chosen, Some(plan)))
    }

    /// Whether handles are to be opened where that promises the better map.
    fn may_be_opened(&self, options: &Options) -> bool {
        // Loops are no rigid motions, so that no texture runs on across them; and whoever says where seams run wants no others.
        let seams = &options.seams;
        let has_say = !seams.given.is_empty() || !seams.kept.is_empty() || options.quantize.is_some();
        self.found.making.preparation.handles == Handles::Auto && !has_say
    }

    /// The analysis with handles opened and what is chosen there, where that promises the better map: on all components, or, unless
    /// they share a number of cones, on those where it does; and the time that finding it out took. What is chosen for the closed surface may
    /// have drafts, but none that are left when this returns and are taken.
    fn opened_instead(
        &self,
        chosen: &mut Chosen,
        settled: &[Settled],
        options: &Options,
        tried: &mut Times,
    ) -> Result<Option<(Self, Chosen)>, Error> {
        let is_shared = matches!(options.cones, ConeChoice::Count(_));
        let mut closed = self.predicted_by_itself(&chosen.1, is_shared);
        let has_handles = |part: usize| is_shared || self.components()[part].has_handles();
        let is_good = |closed: &Option<Prediction>| {
            closed.is_some_and(|closed| closed.area_distortion <= TARGET_DISTORTION && closed.count <= FEW_CONES)
        };
        let mut is_in_question: Vec<bool> = closed
            .iter()
            .enumerate()
            .map(|(part, closed)| has_handles(part) && !is_settled(settled, part) && !is_good(closed))
            .collect();
        let is_left = self.left_closed(&chosen.0, &is_in_question, options, tried)?;
        if is_left.contains(&true) {
            self.finish_drafts(chosen, &is_left, options)?;
            closed = self.predicted_by_itself(&chosen.1, is_shared);
            is_in_question.iter_mut().zip(is_left).for_each(|(is_in_question, is_left)| *is_in_question &= !is_left);
        }
        if !is_in_question.contains(&true) {
            return Ok(None);
        }
        let is_draft = |part: usize| chosen.0.found.get(part).is_some_and(|found| found.is_draft);
        // Drafts most often stay behind.
        let drafts = self.components().iter().filter(|component| is_draft(component.index));
        drafts.for_each(|component| component.let_factor_go());
        let Some(opened) = self.with_handles_opened()? else { return Ok(None) };
        *tried += opened.times();
        let opened = if is_shared { opened } else { self.with_parts_of(&opened, &is_in_question) };
        let (other, is_hardly_worth) = opened.searched_beside(&chosen.0.found, &is_in_question, options, tried)?;
        let others = opened.predicted_by_itself(&other.1, is_shared);
        // Drafts will do where they already say that handles are better opened.
        let is_undecided = |part: usize| match (&closed[part], &others[part]) {
            (Some(draft), Some(opened)) => {
                is_draft(part) && (is_hardly_worth(part) || !is_surely_worth_opening(draft, opened))
            }
            (_, opened) => is_draft(part) && opened.is_none(),
        };
        let is_undecided: Vec<bool> = (0..closed.len()).map(is_undecided).collect();
        if is_undecided.contains(&true) {
            let is_same = |one: usize, other: usize| is_undecided[one] == is_undecided[other];
            each_shape(self.components(), tried, is_same, |component, times| match is_undecided[component.index] {
                true => {
                    opened.components()[component.index].let_factor_go();
                    component.factor_again(&self.task(), times)
                }
                false => Ok(()),
            })?;
            self.finish_drafts(chosen, &is_undecided, options)?;
            closed = self.predicted_by_itself(&chosen.1, is_shared);
        }
        let is_better = |(part, (closed, opened)): (usize, (&Option<Prediction>, Option<Prediction>))| {
            let is_better = match (closed, opened) {
                (_, None) => false,
                (None, Some(_)) => true,
                // A draft that is left has said so.
                (Some(closed), Some(opened)) => {
                    chosen.0.found.get(part).is_some_and(|found| found.is_draft) || is_worth_opening(closed, &opened)
                }
            };
            is_in_question[part] && is_better && !is_hardly_worth(part)
        };
        let is_opened: Vec<bool> = closed.iter().zip(others).enumerate().map(is_better).collect();
        let is_opened_part = |part: usize| is_opened[if is_shared { 0 } else { part }];
        let left = self.components().iter().filter(|component| is_opened_part(component.index));
        left.for_each(|component| component.let_factor_go());
        if is_shared || (0..is_opened.len()).all(|part| is_opened[part] || !has_handles(part)) {
            return Ok(is_opened[0].then_some((opened, other)));
        }
        if !is_opened.contains(&true) {
            return Ok(None);
        }
        Ok(Some(self.partly_opened(chosen, (&opened, other), &is_opened)))
    }

    /// Which of some parts with drafts are left closed since their coarse levels, opened, tell that it is hardly worth opening them.
    fn left_closed(
        &self,
        shared: &Shared,
        is_in_question: &[bool],
        options: &Options,
        tried: &mut Times,
    ) -> Result<Vec<bool>, Error> {
        let Shared { found, number, .. } = shared;
        let is_asked = |component: &Component| {
            is_in_question[component.index] && component.surface.mesh.vertex_count() > MOST_OPENED_AT_ONCE
        };
        each(self.components(), tried, |component, times| {
            let draft = found.get(component.index).filter(|found| found.is_draft && is_asked(component));
            let (Some(draft), Some(number)) = (draft, number) else { return Ok(false) };
            let most = draft.curve.last().map_or(0, |point| point.count);
            let opened = self.task().stage((Stage::Hierarchy, component.index), times, |watch| {
                let ground = component.ground(options.search, watch);
                options.placement.draft_opened(ground, options.rule, (number.target, most))
            })??;
            Ok(opened.is_some_and(|opened| is_hardly_worth_opening(draft, &opened)))
        })
    }

    /// Looks for the best sets of cones on some parts that have drafts.
    fn finish_drafts(&self, chosen: &mut Chosen, is_draft: &[bool], options: &Options) -> Result<(), Error> {
        let before = std::mem::take(&mut chosen.0);
        let known = |part: usize| if is_draft[part] { Known::Nothing } else { Known::Found(&before.found[part]) };
        *chosen = self.configurations(options, &known, &self.task())?;
        chosen.0.times += before.times;
        Ok(())
    }

    /// What is chosen with handles opened, beside what was found with them closed; and which parts nested orders tell are hardly worth opening, so
    /// that drafts are left there. Parts that are not in question are not searched again.
    fn searched_beside(
        &self,
        closed: &[Automatic],
        is_in_question: &[bool],
        options: &Options,
        tried: &mut Times,
    ) -> Result<(Chosen, impl Fn(usize) -> bool + use<>), Error> {
        let known = |part: usize| match (closed.get(part), is_in_question.get(part)) {
            (Some(found), Some(false)) => Known::Found(found),
            (Some(found), _) if found.is_draft => Known::MayBeOpened,
            _ => Known::Nothing,
        };
        let mut chosen = self.configurations(options, &known, &self.task())?;
        *tried += chosen.0.times;
        let both = || closed.iter().zip(&chosen.0.found);
        let is_hardly_worth: Vec<bool> =
            both().map(|(closed, opened)| is_hardly_worth_opening(closed, opened)).collect();
        let may_be_worth = |part: usize, found: &Automatic| found.is_draft && !is_hardly_worth[part];
        if chosen.0.found.iter().enumerate().any(|(part, found)| may_be_worth(part, found)) {
            let drafts = std::mem::take(&mut chosen.0.found);
            let known = |part: usize| match may_be_worth(part, &drafts[part]) {
                true => Known::Nothing,
                false => Known::Found(&drafts[part]),
            };
            chosen = self.configurations(options, &known, &self.task())?;
            *tried += chosen.0.times;
        }
        Ok((chosen, move |part| is_hardly_worth.get(part) == Some(&true)))
    }

    /// The same analysis with some parts of another one, the same but for opened handles.
    fn with_parts_of(&self, opened: &Self, is_opened: &[bool]) -> Self {
        let of_part = |part: usize| if is_opened[part] { &opened.components()[part] } else { &self.components()[part] };
        let components = (0..is_opened.len()).map(|part| Arc::clone(of_part(part))).collect();
        let found = self.found.with_components(components, opened.times());
        Self { found: Arc::new(found), observer: Arc::clone(&self.observer) }
    }

    /// The analysis with the handles of some components opened, and for each what was chosen with them closed or opened.
    fn partly_opened(&self, chosen: &Chosen, (opened, other): (&Self, Chosen), is_opened: &[bool]) -> (Self, Chosen) {
        let mixed = self.with_parts_of(opened, is_opened);
        let of_part = |((closed, opened), &is_opened)| if is_opened { opened } else { Clone::clone(closed) };
        let (mut shared, others) = other;
        for ((found, closed), _) in
            shared.found.iter_mut().zip(&chosen.0.found).zip(is_opened).filter(|(_, opened)| !*opened)
        {
            found.clone_from(closed);
        }
        let configurations: Vec<_> = chosen.1.iter().zip(others).zip(is_opened).map(of_part).collect();
        if let (Some(number), Some(all)) = (&mut shared.number, mixed.predicted(&configurations)) {
            (number.chosen, number.predicted) = (all.count, all.area_distortion);
        }
        (mixed, (shared, configurations))
    }

    /// What is predicted for the cones of each component by itself, or of all where they share a number of them.
    pub(super) fn predicted_by_itself(
        &self,
        configurations: &[Result<Configuration, Error>],
        is_shared: bool,
    ) -> Vec<Option<Prediction>> {
        if is_shared {
            return vec![self.predicted(configurations)];
        }
        let predicted = |(component, configuration): (&Arc<Component>, &Result<Configuration, Error>)| {
            let Configuration { vertices, predicted, .. } = configuration.as_ref().ok()?;
            let mut predictor = Predictor::new(1);
            predictor.put(0, &component.operators, component.area, vertices.len(), predicted.clone());
            Some(predictor.prediction())
        };
        self.components().iter().zip(configurations).map(predicted).collect()
    }

    /// What is predicted for cones on all components, if they can be had on all.
    pub(super) fn predicted(&self, configurations: &[Result<Configuration, Error>]) -> Option<Prediction> {
        let mut predictor = Predictor::new(self.components().len());
        for (component, configuration) in self.components().iter().zip(configurations) {
            let Configuration { vertices, predicted, .. } = configuration.as_ref().ok()?;
            predictor.put(component.index, &component.operators, component.area, vertices.len(), predicted.clone());
        }
        Some(predictor.prediction())
    }

    /// Flattens the model with the cones chosen, or on components where these fail with the best of others. If there is a plan, it is that of the only
    /// component's seams.
    fn with_chosen(
        &self,
        (chosen, plan): (Chosen, Option<SeamPlan>),
        options: &Options,
        task: &Task,
    ) -> Result<Atlas, Error> {
        let (Shared { notes, number, mut times, .. }, configurations) = chosen;
        let area = self.area();
        let is_same = |one: usize, other: usize| are_same(&configurations[one], &configurations[other]);
        let flats = self.flats(options, &mut times, is_same, |component, times| {
            let made;
            let plan = match &plan {
                Some(plan) => plan,
                None => {
                    made = self.plan(component, &options.seams, task, times)?;
                    &made
                }
            };
            let mut flat = component.flatten_well(&configurations[component.index], (options, plan), task, times)?;
            component.finish(&mut flat, (options, plan, component.area / area), task, times)?;
            Ok(flat)
        })?;
        self.assemble(flats, notes, (number, options.quantize), options, task, times)
    }

    /// The components flattened: one of each shape, unless something is said of edges.
    fn flats(
        &self,
        options: &Options,
        times: &mut Times,
        is_same: impl Fn(usize, usize) -> bool,
        flatten: impl Fn(&Component, &mut Times) -> Result<Flat, Error> + Sync,
    ) -> Result<Vec<Flat>, Error> {
        match options.seams.names_edges() {
            true => each(self.components(), times, flatten),
            false => each_shape(self.components(), times, is_same, flatten),
        }
    }

    /// Of all components, in the model's units.
    fn area(&self) -> f64 {
        self.components().iter().map(|component| component.area).sum()
    }

    /// Where the seams of a component go.
    pub(super) fn plan(
        &self,
        component: &Component,
        seams: &SeamOptions,
        task: &Task,
        times: &mut Times,
    ) -> Result<SeamPlan, Error> {
        let Component { index, surface, metric, .. } = component;
        let in_parts = self.refined().map(|_| seams.in_parts(|ends| self.parts(ends)));
        let seams = in_parts.as_ref().unwrap_or(seams);
        let plan = |watch: Watch| SeamPlan::new(surface, metric, self.corner_vertices(), seams, watch);
        Ok(task.stage((Stage::Cut, *index), times, plan)??)
    }

    /// Edges must be edges of the model, and those that are to be cut not open already.
    fn check_seams(&self, seams: &SeamOptions) -> Result<(), Error> {
        if seams.given.is_empty() && seams.avoid.is_empty() {
            return Ok(());
        }
        let edges = self.edges();
        for &ends in seams.given.iter().chain(&seams.avoid) {
            if !self.parts(&ends).iter().all(|&part| edges.has(part)) {
                let is_refined = self.refined().is_some_and(|refined| !refined.is_named(ends));
                return Err(Error::NoSuchEdge { ends, is_refined });
            }
        }
        let is_open = |ends: &[u32; 2]| self.parts(ends).iter().any(|&part| edges.is_open(part));
        match seams.given.iter().find(|ends| is_open(ends)) {
            Some(&ends) => Err(Error::OpenEdge { ends }),
            None => Ok(()),
        }
    }

    /// The edges that an edge of the model that was given is in: itself, where it was not held while the model was refined.
    fn parts<'a>(&'a self, ends: &'a [u32; 2]) -> &'a [[u32; 2]] {
        let parts = self.refined().and_then(|refined| refined.parts(*ends));
        parts.unwrap_or(std::slice::from_ref(ends))
    }

    /// That a surface that was refined before they were named has not all edges that were to be kept as seams.
    fn lost_seams(&self, seams: &SeamOptions) -> Option<Note> {
        let refined = self.refined()?;
        let others: Vec<[u32; 2]> = seams.kept.iter().copied().filter(|&ends| !refined.is_named(ends)).collect();
        if others.is_empty() {
            return None;
        }
        let edges = self.edges();
        let lost = others.into_iter().filter(|&ends| !edges.has(ends)).count();
        (lost > 0).then_some(Note::SeamsNotKept { lost, of: seams.kept.len() })
    }

    /// The edges that seams may be given by.
    fn edges(&self) -> ModelEdges {
        let surfaces = self.components().iter().map(|component| &component.surface);
        let mut edges = ModelEdges::new(surfaces, self.corner_vertices());
        for component in self.components() {
            let opened = component.handles.loops.iter().flat_map(|around| &around.edges);
            edges.allow(&component.surface, self.corner_vertices(), opened);
        }
        edges
    }

    /// Puts flattened components together.
    fn assemble(
        &self,
        flats: Vec<Flat>,
        mut notes: Vec<Note>,
        (number, quantize): (Option<ChosenNumber>, Option<Symmetry>),
        options: &Options,
        task: &Task,
        mut times: Times,
    ) -> Result<Atlas, Error> {
        let Packed { triangles, packing, islands, added } =
            packed(self.components(), &flats, options, task, &mut times)?;
        let began = Instant::now();
        let (mut cones, mut seams, mut loops, mut detached) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let number = number.map(|number| self.measured(number, &flats));
        let mut curvature_error = 0.0_f64;
        let (mut unfolded, mut freed) = (0, 0);
        let mut seam_figures = SeamFigures::default();
        let mut tiling = quantize.map(Tiling::none);
        notes.splice(0..0, self.notes().iter().cloned());
        for (component, flat) in self.components().iter().zip(flats) {
            let surface = &component.surface;
            curvature_error = curvature_error.max(flat.error);
            unfolded += usize::from(flat.is_unfolded);
            let figures = SeamFigures::laid_out(surface, &component.metric, &flat.seams, &flat.layout);
            freed += usize::from(figures.mean_mismatch() > RIGID_SEAMS);
            seam_figures += figures;
            if let Some(tiling) = &mut tiling {
                *tiling += Tiling::new(&surface.mesh, &flat.seams, &flat.layout, tiling.symmetry);
            }
            seam_figures += SeamFigures::of_chains(surface, &component.metric, &component.handles.loops);
            seams.extend(flat.seams.chains.iter().map(|chain| component.vertices_along(chain)));
            loops.extend(component.handles.loops.iter().map(|chain| component.vertices_along(chain)));
            detached.extend(flat.detached.iter().flat_map(|&f| component.triangles_of(f)).copied());
            cones.extend(flat.cones.iter().zip(&flat.curvature).map(|(&v, &k)| component.cone(v, k, self.points())));
            for note in flat.notes {
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        notes.extend(self.lost_seams(&options.seams));
        if let Some(Tiling { symmetry, seams, broken: broken @ 1.., .. }) = tiling {
            let mut steps = cones.iter().map(|cone| cone.curvature / symmetry.angle());
            let are_given = steps.any(|steps| (steps - steps.round()).abs() > ROUNDING);
            notes.push(Note::SeamsDoNotTile { symmetry, seams, broken, are_given });
        }
        seams.extend(added);
        let opened_handles = loops.len();
        seams.extend(loops);
        let mut island = vec![None; self.triangles().len()];
        let mut placed = Placed::new(self.corner_vertices().len());
        let mut triangles = triangles.as_slice();
        for (component, islands) in self.components().iter().zip(&islands) {
            let (own, others) = triangles.split_at(islands.len());
            component.spread(|h| own.as_flattened()[h.index()], |corner, position| placed.put(corner, position));
            triangles = others;
            for (f, &number) in islands.iter_ids() {
                component.triangles_of(f).iter().for_each(|&triangle| island[triangle as usize] = Some(number));
            }
        }
        let uv = self.fill_corners(placed);
        times.add(Stage::Pack, began.elapsed());
        Ok(Atlas {
            uv,
            area: self.area(),
            scale: packing.scale,
            tiles: packing.tiles,
            fill: packing.fill,
            triangles: self.triangles().clone(),
            left_out: self.left_out().to_vec(),
            islands: island,
            detached,
            cones,
            seams,
            opened_handles,
            necks: 0,
            seam_figures,
            tiling,
            number,
            curvature_error,
            unfolded,
            freed,
            times,
            notes,
        })
    }

    /// The number of cones that were taken in the end, what is predicted for these, and whether the map that was made meets the target.
    fn measured(&self, number: ChosenNumber, flats: &[Flat]) -> ChosenNumber {
        let mut predictor = Predictor::new(flats.len());
        for (component, flat) in self.components().iter().zip(flats) {
            let Component { index, operators, area, .. } = &**component;
            predictor.put(*index, operators, *area, flat.cones.len(), flat.predicted.clone());
        }
        let Prediction { count: chosen, area_distortion: predicted, .. } = predictor.prediction();
        let mut all: Vec<(f64, f64)> = Vec::new();
        for (component, flat) in self.components().iter().zip(flats) {
            let whole: f64 = flat.quality.ratios.iter().map(|(area, _)| area).sum();
            let size = flat.size * flat.size * component.surface.scale * component.surface.scale;
            let ratios = flat.quality.ratios.par_iter().with_min_len(AT_ONCE);
            all.par_extend(ratios.map(|(area, r)| (area / whole * component.area, r * size)));
        }
        ChosenNumber { chosen, predicted, ..number }.judged(distortion_of(&all))
    }

    /// Corners that no surface has get the positions of a triangle on the same three vertices, or of a corner at the same vertex of their own
    /// one. What is left of a triangle goes to one point, so that it lies over nothing: of its own, of one of its vertices, or the origin.
    fn fill_corners(&self, mut placed: Placed) -> Vec<[f64; 2]> {
        if placed.is_placed.contains(&false) {
            self.fill_copies(&mut placed);
            let corners = || (0..).zip(self.corner_vertices());
            let mut of_vertex = vec![None; self.points().len()];
            for (corner, &v) in corners() {
                of_vertex[v as usize] = placed.at(corner).or(of_vertex[v as usize]);
            }
            let vertex = |corner: u32| self.corner_vertices()[corner as usize];
            for &t in self.left_out() {
                let own = self.triangles().corners[t as usize];
                let point = own.iter().find_map(|&corner| placed.at(corner));
                let point = point.or_else(|| own.iter().find_map(|&corner| of_vertex[vertex(corner) as usize]));
                for corner in own {
                    let twin = own.iter().filter(|&&other| vertex(other) == vertex(corner));
                    let twin = twin.copied().find_map(|other| placed.at(other));
                    placed.put_if_none(corner, twin.or(point).unwrap_or_default());
                }
            }
            // Corners of no triangle at all.
            corners().for_each(|(corner, &v)| placed.put_if_none(corner, of_vertex[v as usize].unwrap_or_default()));
        }
        placed.uv
    }

    /// Gives copies of triangles the positions of the triangle that they are copies of.
    fn fill_copies(&self, placed: &mut Placed) {
        let vertex = |corner: &u32| self.corner_vertices()[*corner as usize];
        let sorted = |t: u32| {
            let mut corners = self.triangles().corners[t as usize];
            corners.sort_unstable_by_key(vertex);
            corners
        };
        let place = |t: u32| sorted(t).map(|corner| vertex(&corner));
        let mut original: HashMap<[u32; 3], Option<[u32; 3]>> =
            self.left_out().iter().map(|&t| (place(t), None)).collect();
        if original.is_empty() {
            return;
        }
        let mut is_on_surface = vec![true; self.triangles().len()];
        self.left_out().iter().for_each(|&t| is_on_surface[t as usize] = false);
        for t in (0..).zip(is_on_surface).filter_map(|(t, is_on_surface)| is_on_surface.then_some(t)) {
            original.entry(place(t)).and_modify(|first| _ = first.get_or_insert_with(|| sorted(t)));
        }
        for &t in self.left_out() {
            let Some(Some(from)) = original.get(&place(t)) else { continue };
            for (to, from) in sorted(t).into_iter().zip(from) {
                if let Some(position) = placed.at(*from) {
                    placed.put_if_none(to, position);
                }
            }
        }
    }
}
