//! From cones on every component to texture coordinates for the model.

use std::sync::Arc;
use std::time::Instant;

use geom::{Model, Watch};

use super::Analysis;
use super::atlas::Atlas;
use super::choosing::{Chosen, Known, Shared, are_same};
use super::component::Component;
use super::cones::{Cones, Configuration};
use super::flat::Flat;
use super::instances::{each, each_shape};
use super::limbs::Settled;
use super::note::Note;
use super::observer::{Silent, Stage, Task, Times};
use super::options::Options;
use crate::cut::{ModelEdges, SeamOptions, SeamPlan};
use crate::error::Error;
use crate::placement::{Prediction, Predictor};

/// Unwraps a model in one call: [`Analysis::unwrapped`] unobserved, with the time of both and all that the user
/// should know. Where the options ask for [refining](crate::Refining), what is unwrapped is another model, of even triangles: the atlas
/// [has it](Atlas::refined).
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

impl Analysis {
    /// Flattens the model with given cones, in some ten solves of its Laplacian and a few factorizations. Fold-overs are removed as far as possible; triangles that stay folded over are
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
    /// As [`flatten`](Self::flatten), if an edge is none of the model's, and if islands cannot be packed as is
    /// asked.
    pub fn flatten_with(&self, cones: &Cones, options: &Options) -> Result<Atlas, Error> {
        self.check_own(cones)?;
        options.packing.check()?;
        self.check_seams(&options.seams)?;
        // Where curvatures were rounded for a texture, seams stay rigid and islands keep its directions.
        let options = &Options { quantize: cones.quantize, ..options.clone() };
        let task = self.task();
        let mut times = Times::default();
        let area = self.area();
        let missed = self.parts_of(&cones.recipe.freed);
        let is_same = |one: usize, other: usize| {
            missed.contains(&one) == missed.contains(&other)
                && cones.configurations[one].is_same(&cones.configurations[other])
        };
        let flats = self.flats(options, &mut times, is_same, |component, times| {
            let mut plan = self.plan(component, &options.seams, &task, times)?;
            if let Some(straight) = component.straight.as_ref().filter(|_| options.cones.has_straight_seams()) {
                let mesh = &component.surface.mesh;
                plan.give(mesh.edges().filter(|&e| straight.path[e].is_some() && !mesh.is_boundary_edge(e)));
            }
            let mut flat = component.flatten(
                &cones.configurations[component.index],
                (&plan, options.may_loosen()),
                &task,
                times,
            )?;
            component.detach_fold_overs(&mut flat);
            flat.misses_areas = missed.contains(&component.index);
            task.stage((Stage::Layout, component.index), times, |watch| {
                component.promised(&mut flat, options, watch)
            })??;
            component.finish(&mut flat, (options, &plan, component.area / area), &task, times)?;
            flat.notes.extend(component.doubt(&flat, cones.placement.is_none()));
            Ok(flat)
        })?;
        let own = cones.notes.iter().filter(|note| note.component().is_none()).cloned().collect();
        self.assemble(flats, own, cones.number.clone(), options, &task, times)
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
            let whole =
                task.stage((Stage::Cut, component.index), times, |watch| component.cut_whole(&plan, vertices, watch))??;
            let cut = component.own_seams(&whole, &plan, vertices);
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
    /// As [`choose`](Self::choose) and [`flatten_with`](Self::flatten_with); given cones are never replaced.
    pub fn atlas(&self, options: &Options) -> Result<Atlas, Error> {
        self.check_seams(&options.seams)?;
        options.packing.check()?;
        match self.atlas_along_seams(options)? {
            Some(atlas) => Ok(atlas),
            None if options.cones.is_given() => self.atlas_as_given(options),
            None => self.atlas_beside(&[], options),
        }
    }

    /// The atlas, where something is settled already of parts.
    pub(super) fn atlas_beside(&self, settled: &[Settled], options: &Options) -> Result<Atlas, Error> {
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
        self.assemble(flats, notes, number, options, task, times)
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
    pub(super) fn area(&self) -> f64 {
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

    /// Edges must be edges of the model.
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
        Ok(())
    }

    /// That edges to be cut are open already.
    pub(super) fn open_seams(&self, seams: &SeamOptions) -> Option<Note> {
        if seams.given.is_empty() {
            return None;
        }
        let edges = self.edges();
        let is_open = |ends: &&[u32; 2]| self.parts(ends).iter().any(|&part| edges.is_open(part));
        let open = seams.given.iter().filter(is_open).count();
        (open > 0).then_some(Note::SeamsOpen { edges: open, of: seams.given.len() })
    }

    /// The edges that an edge of the model that was given is in: itself, where it was not held while the model was refined.
    pub(super) fn parts<'a>(&'a self, ends: &'a [u32; 2]) -> &'a [[u32; 2]] {
        let parts = self.refined().and_then(|refined| refined.parts(*ends));
        parts.unwrap_or(std::slice::from_ref(ends))
    }

    /// That a surface that was refined before they were named has not all edges that were to be kept as seams.
    pub(super) fn lost_seams(&self, seams: &SeamOptions) -> Option<Note> {
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
}
