//! Whether handles are opened: decided from predictions, closed beside opened, before anything is flattened.

use std::sync::Arc;

use super::Analysis;
use super::choosing::{Chosen, Known, Shared, TARGET_DISTORTION};
use super::component::Component;
use super::cones::Cones;
use super::instances::{each, each_shape};
use super::limbs::{Settled, is_settled};
use super::observer::{Stage, Times};
use super::options::{ConeChoice, Handles, Options};
use crate::error::Error;
use crate::placement::{Automatic, Prediction};

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

impl Analysis {
    /// Whether handles are to be opened where that promises the better map.
    pub(super) fn may_be_opened(&self, options: &Options) -> bool {
        // Loops are no rigid motions, so that no texture runs on across them; and whoever says where seams run wants no others.
        let seams = &options.seams;
        let has_say = !seams.given.is_empty() || !seams.kept.is_empty() || options.quantize.is_some();
        self.found.making.preparation.handles == Handles::Auto && !has_say
    }

    /// The cones that [`atlas`](Self::atlas) begins with, and the analysis that they are of: this one, or the same with handles opened where that
    /// promises the better map. The atlas has others where flattening shows that these fail, fold over, bend angles or miss what was asked for, and
    /// where limbs are cut off; for a fixed number of cones it mostly has these.
    ///
    /// # Errors
    /// As [`choose`](Self::choose).
    pub fn choose_for_map(&self, options: &Options) -> Result<(Self, Cones), Error> {
        let may_be_opened = self.may_be_opened(options) && !options.cones.is_given();
        let has_handles = |part: usize| may_be_opened && self.components()[part].has_handles();
        let known = |part: usize| if has_handles(part) { Known::MayBeOpened } else { Known::Nothing };
        let mut chosen = self.configurations(options, &known, &self.task())?;
        let (mut taken, mut tried) = (self.clone(), Times::default());
        if may_be_opened && let Some((opened, other)) = self.opened_instead(&mut chosen, &[], options, &mut tried)? {
            tried += chosen.0.times;
            (taken, chosen) = (opened, other);
        }
        let mut cones = taken.chosen(chosen, options)?;
        cones.times += tried;
        Ok((taken, cones))
    }

    /// The analysis with handles opened and what is chosen there, where that promises the better map: on all components, or, unless
    /// they share a number of cones, on those where it does; and the time that finding it out took. What is chosen for the closed surface may
    /// have drafts, but none that are left when this returns and are taken.
    pub(super) fn opened_instead(
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
            closed.is_some_and(|closed| {
                closed.area_distortion <= TARGET_DISTORTION && closed.count <= FEW_CONES.min(options.cones.most())
            })
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
                    // Closed surfaces may need more cones than were asked for.
                    let comes_nearer = opened.count < closed.count && closed.count > options.cones.most();
                    let is_draft = chosen.0.found.get(part).is_some_and(|found| found.is_draft);
                    is_draft || comes_nearer || is_worth_opening(closed, &opened)
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
    /// that drafts are left there. Parts that are not in question are not searched again. The time of it is among what was tried.
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
        *tried += std::mem::take(&mut chosen.0.times);
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
            *tried += std::mem::take(&mut chosen.0.times);
        }
        Ok((chosen, move |part| is_hardly_worth.get(part) == Some(&true)))
    }

    /// The same analysis with some parts of another one, the same but for opened handles.
    pub(super) fn with_parts_of(&self, opened: &Self, is_opened: &[bool]) -> Self {
        let of_part = |part: usize| if is_opened[part] { &opened.components()[part] } else { &self.components()[part] };
        let components = (0..is_opened.len()).map(|part| Arc::clone(of_part(part))).collect();
        let found = self.found.with_opened(components, opened.times());
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
}
