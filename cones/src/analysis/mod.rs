//! The analysis of a model: what is found once and asked many times.
//!
//! Repair, intrinsic Delaunay triangulation, curvature, Laplacian and its one factorization, the conformal factor and its
//! extrema are found when an [`Analysis`] is made. Placing cones by any method, predicting, ordering cones for every number of
//! them are back-solves on that factor; only flattening factors again. An analysis never changes: what is asked of it
//! depends on nothing that was asked before, and several threads can ask at the same time.
//!
//! Connected components are worked on at the same time, on the threads of the current rayon pool; what comes out does not
//! depend on how many there are.

mod apportionment;
mod assembly;
mod atlas;
mod attempts;
mod baselines;
mod caps;
mod choosing;
mod component;
mod cones;
mod filled;
mod finer;
mod flat;
mod freed;
mod given_seams;
mod handles;
mod instances;
mod islands;
mod limbs;
mod note;
mod observer;
mod opening;
mod options;
mod order;
mod packed;
mod preview;
mod quality;
mod refined;
mod remade;
mod reseaming;
mod sizing;
mod straightened;
mod unwrap;

use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use geom::{Model, Prepared, Repair, RepairKind, Surface, Triangles, VertexId, Weld, prepare_watched, unify_instances};
use rayon::prelude::*;

pub use atlas::{Atlas, Topology};
pub use baselines::{Baseline, BaselineMap};
pub use choosing::{MOST_AUTOMATIC, TARGET_DISTORTION, TOLERABLE_DISTORTION};
pub use cones::{ChosenNumber, Cone, Cones};
pub use note::{Failure, Note};
pub use observer::{Observer, Progress, Stage, Times};
pub use options::{
    ConeChoice, FreeSeams, GivenCone, Handles, Islands, Limbs, Options, Preparation, Recipe, Refining, SMALL_HOLE,
};
pub use order::{ConeOrder, ModelExtremum, OrderedCone};
pub use preview::Preview;
pub use refined::{MOST_NEEDLES, RefinedModel};
pub use unwrap::unwrap_model;

use crate::curvature::CurvatureRule;
use crate::cut::ascending;
use crate::error::Error;
use crate::placement::{Placement, Prediction};
use component::{Component, Making};
use handles::open_handles;
use observer::{Silent, Task};
use preview::PreviewOrder;
use refined::{HowRefined, Ready, SizeAt, StraightPaths, is_asked_for, refine_all};
use sizing::Sizing;

/// A model with all that is found of it once; see the [crate's documentation](crate). Clones share it.
///
/// ```
/// use cones::{Analysis, Placement};
///
/// let model = geom::shapes::hare(700).into();
/// let analysis = Analysis::new(&model)?; // the one factorization
/// let sets = [4, 8, 16].map(|count| analysis.place(Placement::Refined, count));
/// let [four, eight, _] = sets.map(|cones| cones.expect("nobody has said stop"));
/// let all = analysis.order(Placement::Pursuit, Default::default(), 64)?; // what is predicted for every number
/// assert!(all.curve.windows(2).all(|step| step[0].count < step[1].count));
/// assert!(eight.prediction().area_distortion < four.prediction().area_distortion);
/// let maps = [analysis.flatten(&four)?, analysis.flatten(&eight)?];
/// assert!(maps.iter().all(|map| map.detached.is_empty() && map.uv.len() == model.corner_count()));
/// # Ok::<(), cones::Error>(())
/// ```
#[derive(Clone)]
pub struct Analysis {
    found: Arc<Found>,
    observer: Arc<dyn Observer>,
}

/// What is found once.
struct Found {
    id: usize,
    /// The positions of the model's vertices.
    points: Vec<[f64; 3]>,
    /// The vertex of each of its corners.
    corner_vertices: Vec<u32>,
    triangles: Triangles,
    left_out: Vec<u32>,
    repairs: Vec<Repair>,
    refined: Option<Arc<RefinedModel>>,
    topology: Topology,
    /// Shared with the analyses of the same model with handles opened, as far as these leave them as they are.
    components: Vec<Arc<Component>>,
    making: Making,
    /// How large triangles may be where, if the surfaces were refined by that.
    sizing: Option<Arc<Sizing>>,
    /// The same model with its handles opened, once that was asked for; none where no handle can be opened.
    opened: OnceLock<Option<Arc<Self>>>,
    /// Orders for previews, of one block and of two, found when they are first asked for.
    previews: [OnceLock<PreviewOrder>; 2],
    notes: Vec<Note>,
    times: Times,
}

/// How many analyses have been made.
static COUNT: AtomicUsize = AtomicUsize::new(0);

impl std::fmt::Debug for Analysis {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Analysis").field("topology", &self.found.topology).finish_non_exhaustive()
    }
}

impl Analysis {
    /// Analyses a model. Costs one factorization for each connected component.
    ///
    /// # Errors
    /// If the model has no surface, or one whose Laplacian cannot be factored.
    pub fn new(model: &Model) -> Result<Self, Error> {
        Self::with(model, Preparation::default())
    }

    /// Analyses a model that is made ready as is said.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with(model: &Model, preparation: Preparation) -> Result<Self, Error> {
        Self::observed(model, preparation, Silent)
    }

    /// Analyses a model while an observer listens, and goes on listening to what is asked.
    ///
    /// # Errors
    /// As [`new`](Self::new), and if the observer has said stop.
    pub fn observed(model: &Model, preparation: Preparation, observer: impl Observer + 'static) -> Result<Self, Error> {
        let making = Making {
            preparation,
            is_finest: false,
            is_bent: false,
            is_searched: false,
            is_opened: false,
            is_cut_as_given: false,
            is_asked_once: false,
        };
        Self::made(model, making, (&HashSet::new(), None, &[]), Arc::new(observer))
    }

    /// Analyses a model and unwraps it, while an observer listens: the same as [`observed`](Self::observed) and
    /// [`atlas`](Self::atlas), but what these options will look for cones on is found while the Laplacian is factored, and large factors
    /// are freed once the map needs them no more. (Whoever asks for more waits until they are there again.) Where surfaces were refined
    /// only for their needles, the model is taken as it is if no cones flatten one of them so, or if it has few corners and its map as it is is exact. Edges that [seams](Options::seams) are named by
    /// stay edges where surfaces are refined, in parts. Where the map of a small model bends angles by more than
    /// 1.06 on average, another one is made, of the model refined if it may be, and then in triangles that are smaller where the map is bent; the best is taken. Seams of small models that are
    /// refined are made straight, unless cones or edges are given: the last map is made again with its cones and geodesics for seams, if that is as good.
    /// Where no cones flatten a part with its [holes filled](Preparation::fill_holes), none are filled.
    /// Where no metric was found and [`Weld::Auto`] has left vertices apart that are at one place, all such are [welded](Weld::Always), if one is found so.
    ///
    /// # Errors
    /// As both.
    pub fn unwrapped(
        model: &Model,
        options: &Options,
        observer: impl Observer + 'static,
    ) -> Result<(Self, Atlas), Error> {
        let observer: Arc<dyn Observer> = Arc::new(observer);
        let said = options.cones.recipe().and_then(|recipe| recipe.filled);
        let fill_holes = said.or(options.preparation.fill_holes);
        let filling = |fill_holes| {
            let preparation = Preparation { fill_holes, ..options.preparation };
            Options { preparation, ..options.clone() }
        };
        let filled = Self::unwrapped_or_welded(model, &filling(fill_holes), Arc::clone(&observer))?;
        let (holes, unfolded) = (filled.1.filled_holes, filled.1.unfolded);
        if holes == 0 || unfolded == 0 || options.cones.is_given() {
            return Ok(filled);
        }
        let as_it_is = Self::unwrapped_or_welded(model, &filling(None), observer);
        Self::or_instead(filled, as_it_is, |map| {
            if map.unfolded >= unfolded {
                return false;
            }
            map.notes.retain(|note| !matches!(note, Note::SmallHoles { .. }));
            map.notes.push(Note::NotFilled { holes });
            // What makes this map again fills none.
            map.recipe.filled = Some(0.0);
            true
        })
    }

    /// [`unwrapped`](Self::unwrapped) with holes filled or not.
    fn unwrapped_or_welded(
        model: &Model,
        options: &Options,
        observer: Arc<dyn Observer>,
    ) -> Result<(Self, Atlas), Error> {
        let is_welded = options.cones.recipe().is_some_and(|recipe| recipe.welded);
        let preparation = Preparation { weld: Weld::Always, ..options.preparation };
        let welded = Options { preparation, ..options.clone() };
        let may_be_welded = options.preparation.weld == Weld::Auto;
        if may_be_welded && is_welded {
            let (analysis, mut atlas) = Self::unwrapped_watched(model, &welded, observer)?;
            atlas.recipe.welded = true;
            return Ok((analysis, atlas));
        }
        let (analysis, atlas) = Self::unwrapped_watched(model, options, Arc::clone(&observer))?;
        let is_apart = analysis.repairs().iter().any(|repair| repair.kind == RepairKind::Unwelded);
        let lacks_metric = |atlas: &Atlas| atlas.notes.iter().any(Note::lacks_metric);
        if !may_be_welded || options.cones.is_given() || !is_apart || !lacks_metric(&atlas) {
            return Ok((analysis, atlas));
        }
        Self::or_instead((analysis, atlas), Self::unwrapped_watched(model, &welded, observer), |map| {
            let is_better = !lacks_metric(map);
            map.recipe.welded |= is_better;
            is_better
        })
    }

    /// A map, or another one instead if there is one and it is taken; either with the time that both took.
    fn or_instead(
        (analysis, mut atlas): (Self, Atlas),
        instead: Result<(Self, Atlas), Error>,
        takes: impl FnOnce(&mut Atlas) -> bool,
    ) -> Result<(Self, Atlas), Error> {
        let (other, mut map) = match instead {
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(_) => return Ok((analysis, atlas)),
            Ok(other) => other,
        };
        if takes(&mut map) {
            [analysis.times(), atlas.times].into_iter().for_each(|times| map.times += times);
            return Ok((other, map));
        }
        [other.times(), map.times].into_iter().for_each(|times| atlas.times += times);
        Ok((analysis, atlas))
    }

    fn unwrapped_watched(
        model: &Model,
        options: &Options,
        observer: Arc<dyn Observer>,
    ) -> Result<(Self, Atlas), Error> {
        let named = options.seams.named().map(ascending).collect();
        let making = |preparation, is_bent, is_finest| {
            let is_searched = options.searches_coarse_level();
            let is_cut_as_given = false;
            Making {
                preparation,
                is_finest,
                is_bent,
                is_searched,
                is_opened: false,
                is_cut_as_given,
                is_asked_once: true,
            }
        };
        let of_size = |making, sizing| Self::made(model, making, (&named, sizing, &[]), observer.clone());
        let made = |preparation| of_size(making(preparation, false, false), None);
        let as_it_is = Preparation { refine: Refining::Never, ..options.preparation };
        let unrefined = Options { preparation: as_it_is, ..options.clone() };
        let analysis = made(options.preparation)?;
        if let Some(recipe) = options.cones.recipe() {
            let may_be_other = !recipe.is_of(&analysis) && options.preparation.refine == Refining::Needles;
            let analysis = match (may_be_other, analysis.refined()) {
                (false, _) => analysis,
                (true, Some(_)) => made(as_it_is)?,
                (true, None) => of_size(making(options.preparation, true, false), None)?,
            };
            let analysis = match &recipe.refined_for {
                Some(choice) if !recipe.is_of(&analysis) && !choice.is_given() => {
                    drop(analysis);
                    let before = Options { cones: (**choice).clone(), ..options.clone() };
                    let (analysis, mut atlas) = Self::unwrapped_watched(model, &before, observer)?;
                    if !recipe.is_of(&analysis) && recipe.refined_from == Some(model.vertex_count()) {
                        atlas
                            .notes
                            .push(Note::RefinedOtherwise { cones: recipe.cones.len(), taken: atlas.cones.len() });
                        return Ok((analysis, atlas));
                    }
                    analysis
                }
                _ => analysis,
            };
            let mut atlas = analysis.atlas(options)?;
            atlas.recipe.refined_for.clone_from(&recipe.refined_for);
            atlas.recipe.refined_from = recipe.refined_from;
            return Ok((analysis, atlas));
        }
        if analysis.refined().is_some() && options.preparation.refine == Refining::Needles {
            let net = Self::net_as_it_is(model, || made(as_it_is), &unrefined)?;
            if let Some((net, mut atlas)) = net {
                atlas.times += analysis.times();
                return Ok((net, atlas));
            }
        }
        match analysis.atlas(options) {
            Err(Error::NotFlatRefined { component }) => {
                drop(analysis);
                let analysis = made(as_it_is)?;
                let mut atlas = analysis.atlas(&unrefined)?;
                atlas.notes.push(Note::NotRefined { component });
                Ok((analysis, atlas))
            }
            Ok(atlas) => {
                let (analysis, atlas) = analysis.or_finer(atlas, options, |sizing| {
                    of_size(making(options.preparation, true, sizing.is_some()), sizing)
                })?;
                let (making, sizing) = (analysis.found.making, analysis.found.sizing.clone());
                let (analysis, mut atlas) = analysis.or_straight(atlas, options, |paths| {
                    Self::made(model, making, (&named, sizing.clone(), paths), observer.clone())
                })?;
                if analysis.found.making.is_finest || atlas.recipe.straight {
                    atlas.recipe.refined_for = Some(Box::new(options.cones.clone()));
                    atlas.recipe.refined_from = Some(model.vertex_count());
                }
                Ok((analysis, atlas))
            }
            Err(error) => Err(error),
        }
    }

    /// Makes it. Where surfaces are refined, edges that are `held`, by their vertices in ascending order, stay edges, and triangles are as small as
    /// `sizing` says.
    fn made(
        model: &Model,
        making: Making,
        (held, sizing, straight): (&HashSet<[u32; 2]>, Option<Arc<Sizing>>, &[StraightPaths]),
        observer: Arc<dyn Observer>,
    ) -> Result<Self, Error> {
        let preparation = making.preparation;
        let mut times = Times::default();
        let (mut prepared, shapes) =
            Task::new(&observer, 0).stage((Stage::Prepare, 0), &mut times, |watch| -> Result<_, Error> {
                let mut prepared = prepare_watched(model, preparation.weld, watch)?;
                let shapes = unify_instances(&mut prepared.surfaces);
                Ok((prepared, shapes))
            })??;
        let repairs = std::mem::take(&mut prepared.repairs);
        let topology = Topology::of(&prepared.surfaces);
        let task = Task::new(&observer, prepared.surfaces.len());
        let is_refined = making.is_bent || is_asked_for(preparation.refine, &prepared.surfaces, &shapes);
        let (ready, refined, triangles, left_out) = if is_refined {
            let size_at = sizing.as_ref().map(|sizing| |part, place| sizing.at(part, place));
            let size_at = size_at.as_ref().map(|at| at as SizeAt);
            let refining = HowRefined { refining: preparation.refine, size_at, names_held: held, straight };
            let (ready, refined, triangles, left_out) =
                refine_all(model, (prepared, &shapes), refining, &task, &mut times)?;
            (ready, Some(Arc::new(refined)), triangles, left_out)
        } else {
            let Prepared { surfaces, triangles, left_out, .. } = prepared;
            let ready = surfaces.into_iter().zip(shapes).map(|(surface, shape)| Ready::as_it_is(surface, shape));
            (ready.collect::<Vec<_>>(), None, triangles, left_out)
        };
        let is_opened = preparation.handles == Handles::Always;
        let size = preparation.fill_holes.unwrap_or(SMALL_HOLE);
        let ready = ready.into_iter().map(|ready| ready.with_holes_marked(size)).enumerate().collect();
        let components = made_of(ready, Making { is_opened, ..making }, &task, &mut times)?;
        let notes = notes_of(&components);
        let model = refined.as_ref().map_or(model, |refined| &refined.model);
        let found = Found {
            id: COUNT.fetch_add(1, Relaxed),
            points: model.points().to_vec(),
            corner_vertices: model.corners().to_vec(),
            triangles,
            left_out,
            repairs,
            refined,
            topology,
            components,
            making,
            sizing,
            opened: OnceLock::new(),
            previews: Default::default(),
            notes,
            times,
        };
        Ok(Self { found: Arc::new(found), observer })
    }

    /// The same model with its handles opened ([`Handles`]); none where there are no handles, or they are open. When it is first
    /// asked for it costs one factorization for each connected component that has handles.
    ///
    /// # Errors
    /// If a Laplacian cannot be factored, or if the observer has said stop.
    pub fn with_handles_opened(&self) -> Result<Option<Self>, Error> {
        let opened = match self.found.opened.get() {
            Some(known) => known.clone(),
            None => {
                let made = match self.components().iter().any(|component| component.has_handles()) {
                    true => Some(Arc::new(self.found.opened(&self.task())?)),
                    false => None,
                };
                // Where one map is asked for, what it is not made of is not kept.
                if self.found.making.is_asked_once { made } else { self.found.opened.get_or_init(|| made).clone() }
            }
        };
        Ok(opened.map(|found| Self { found, observer: Arc::clone(&self.observer) }))
    }

    /// The same analysis, with another observer that listens to what is asked of it.
    #[must_use]
    pub fn with_observer(&self, observer: impl Observer + 'static) -> Self {
        Self { found: Arc::clone(&self.found), observer: Arc::new(observer) }
    }

    /// `count` cones by a method, with optimal curvatures, or as many as the model needs.
    ///
    /// Up to [`MOST_OPTIMISED`](crate::MOST_OPTIMISED) cones take seconds. Beyond, N cones are placed by persistence, but their curvatures are a dense program: 8 (V + 2N) N bytes
    /// and O(N³) time for a part of V vertices (16,000 vertices with 4,000 cones: .8 GB). It can be stopped at any time. Where all inner vertices are cones these keep the curvatures that they have. Those
    /// beyond the extrema take a solve each to be placed besides (2,930 of as many vertices: 7 s).
    ///
    /// # Errors
    /// If there are too few vertices for the model's curvature, or if the observer has said stop.
    pub fn place(&self, placement: Placement, count: usize) -> Result<Cones, Error> {
        self.choose(&Options { cones: ConeChoice::Count(count), placement, ..Options::default() })
    }

    /// Cones at given vertices of the model, with curvatures by a rule.
    ///
    /// # Errors
    /// If one of them cannot be a cone, or they cannot take the curvature of a component.
    pub fn given(&self, vertices: &[u32], rule: CurvatureRule) -> Result<Cones, Error> {
        let given = vertices.iter().map(|&v| (v, None)).collect();
        self.choose(&Options { cones: ConeChoice::Given(given), rule, ..Options::default() })
    }

    /// What linear theory predicts for a flattening with given cones. [`order`](Self::order) has it for every number of cones.
    ///
    /// # Errors
    /// As [`given`](Self::given).
    pub fn predict(&self, vertices: &[u32], rule: CurvatureRule) -> Result<Prediction, Error> {
        Ok(self.given(vertices, rule)?.prediction())
    }

    /// The conformal factor φ of each vertex of the model, those merged with others among them; NaN where it is on no surface.
    pub fn conformal_factor(&self) -> Vec<f64> {
        let mut factor = vec![f64::NAN; self.points().len()];
        for component in self.components() {
            let phi = &component.factor.phi;
            self.corners_of(component).for_each(|(vertex, v)| factor[vertex as usize] = phi[v]);
        }
        factor
    }

    /// The vertices of the model at the corners of a component, and those of the surface that they are or were merged with.
    fn corners_of<'a>(&'a self, component: &'a Component) -> impl Iterator<Item = (u32, VertexId)> + 'a {
        let Surface { mesh, corner, .. } = &component.surface;
        mesh.halfedges().map(|h| (self.corner_vertices()[corner[h] as usize], mesh.tail(h)))
    }

    /// How many cones the model needs at least.
    pub fn least_cones(&self) -> usize {
        self.components().iter().map(|component| component.least()).sum()
    }

    /// The shape of the model's surfaces, as they were before they were refined.
    pub fn topology(&self) -> Topology {
        self.found.topology
    }

    /// The model that maps are of, where [`Preparation::refine`] asked for another one than was given: its vertices, corners and
    /// triangles are then meant everywhere.
    pub fn refined(&self) -> Option<&RefinedModel> {
        self.found.refined.as_deref()
    }

    /// The share of the area that is in triangles with an angle below 10°, after intrinsic Delaunay flips. Above [`MOST_NEEDLES`] a model
    /// is better [refined](Preparation::refine).
    pub fn needle_share(&self) -> f64 {
        let parts = self.components().iter().map(|component| {
            let Component { operators, surface, .. } = &**component;
            (operators.mesh.triangulation(), &operators.metric, surface.scale.powi(-2))
        });
        refined::needle_share(parts)
    }

    /// How many handles are opened.
    pub fn opened_handles(&self) -> usize {
        self.components().iter().map(|component| component.handles.loops.len()).sum()
    }

    /// What was repaired in the model.
    pub fn repairs(&self) -> &[Repair] {
        &self.found.repairs
    }

    /// Which vertices of the model that maps are of are taken for one: those that its [preparation](Preparation::weld) said, or none where
    /// it found none such.
    pub fn weld(&self) -> Weld {
        let is_welded = self.repairs().iter().any(|repair| repair.kind == RepairKind::Welded);
        if is_welded || self.refined().is_some() { self.found.making.preparation.weld } else { Weld::Never }
    }

    /// What the user should know of how it was made ready.
    pub fn notes(&self) -> &[Note] {
        &self.found.notes
    }

    /// The time that making it took.
    pub fn times(&self) -> Times {
        self.found.times
    }

    /// The triangles that are computed with, as corners of the model.
    pub fn triangles(&self) -> &Triangles {
        &self.found.triangles
    }

    /// The connected component that each of the [triangles](Self::triangles) is on, as [`Cone::component`] and [`Note`]s count them; none for those that belong
    /// to no surface. O(triangles).
    pub fn triangle_components(&self) -> Vec<Option<usize>> {
        let mut of_triangle = vec![None; self.triangles().len()];
        for component in self.components() {
            for f in component.surface.mesh.faces() {
                component.triangles_of(f).iter().for_each(|&t| of_triangle[t as usize] = Some(component.index));
            }
        }
        of_triangle
    }

    /// The triangles that belong to no surface: with repeated vertices, or copies.
    pub fn left_out(&self) -> &[u32] {
        &self.found.left_out
    }

    fn id(&self) -> usize {
        self.found.id
    }

    fn points(&self) -> &[[f64; 3]] {
        &self.found.points
    }

    fn corner_vertices(&self) -> &[u32] {
        &self.found.corner_vertices
    }

    pub(crate) fn components(&self) -> &[Arc<Component>] {
        &self.found.components
    }

    fn task(&self) -> Task {
        Task::new(&self.observer, self.components().len())
    }
}

impl Found {
    /// The same with the handles of all components opened. Those without handles are not made again.
    fn opened(&self, task: &Task) -> Result<Self, Error> {
        let mut times = Times::default();
        let with_handles = self.components.iter().filter(|component| component.has_handles());
        let ready = with_handles.map(|component| (component.index, component.ready())).collect();
        let mut components = self.components.clone();
        let making = Making { is_opened: true, ..self.making };
        for opened in made_of(ready, making, task, &mut times)? {
            let index = opened.index;
            components[index] = opened;
        }
        Ok(self.with_opened(components, times))
    }

    /// The same with other components at some places, and more of them: `ready`, by their places. The others are those of `taken`.
    fn in_pieces(
        &self,
        taken: &Analysis,
        ready: Vec<(usize, Ready)>,
        is_cut_as_given: bool,
        task: &Task,
        times: &mut Times,
    ) -> Result<Self, Error> {
        let making = Making { is_opened: false, is_cut_as_given, ..self.making };
        let mut components: Vec<Option<Arc<Component>>> = taken.components().iter().cloned().map(Some).collect();
        components.resize(components.len().max(1 + ready.iter().map(|(place, _)| *place).max().unwrap_or(0)), None);
        for piece in made_of(ready, making, task, times)? {
            let place = piece.index;
            components[place] = Some(piece);
        }
        let components = components.into_iter().flatten().collect();
        Ok(self.with_components(components, Making { is_cut_as_given, ..self.making }, Times::default()))
    }

    /// The same with other components, whose handles are opened, or those of some.
    fn with_opened(&self, components: Vec<Arc<Component>>, times: Times) -> Self {
        let preparation = Preparation { handles: Handles::Always, ..self.making.preparation };
        let making = Making { is_opened: true, preparation, ..self.making };
        Self { opened: OnceLock::from(None), ..self.with_components(components, making, times) }
    }

    /// The same with other components, made in some way.
    fn with_components(&self, components: Vec<Arc<Component>>, making: Making, times: Times) -> Self {
        Self {
            id: COUNT.fetch_add(1, Relaxed),
            points: self.points.clone(),
            corner_vertices: self.corner_vertices.clone(),
            triangles: self.triangles.clone(),
            left_out: self.left_out.clone(),
            repairs: self.repairs.clone(),
            refined: self.refined.clone(),
            topology: self.topology,
            notes: notes_of(&components),
            components,
            making,
            sizing: self.sizing.clone(),
            opened: OnceLock::new(),
            previews: Default::default(),
            times,
        }
    }
}

/// The components of surfaces that are ready, by their numbers, with their handles opened or not.
fn made_of(
    ready: Vec<(usize, Ready)>,
    making: Making,
    task: &Task,
    times: &mut Times,
) -> Result<Vec<Arc<Component>>, Error> {
    let began = Instant::now();
    let open = |(index, mut ready): (usize, Ready)| -> Result<(usize, Ready, Times), Error> {
        let mut times = Times::default();
        if making.is_opened && ready.surface.mesh.genus() > 0 {
            ready = task.stage((Stage::Factor, index), &mut times, |watch| open_handles(ready, watch))??;
        }
        Ok((index, ready, times))
    };
    let opened = ready.into_par_iter().with_max_len(1).map(open).collect::<Vec<_>>();
    let opened = opened.into_iter().collect::<Result<Vec<_>, Error>>()?;
    // The first of each shape, which get these places, and those of a shape that is there.
    let mut place: HashMap<usize, usize> = HashMap::new();
    let (firsts, others): (Vec<_>, Vec<_>) = opened.into_iter().partition(|(_, ready, _)| {
        let shapes = place.len();
        *place.entry(ready.shape).or_insert(shapes) == shapes
    });
    let make = |(index, ready, times): (usize, Ready, Times)| -> Result<Component, Error> {
        let mut component = Component::new(index, ready, making, task)?;
        component.times += times;
        Ok(component)
    };
    let made = firsts.into_par_iter().with_max_len(1).map(make).collect::<Vec<_>>();
    let mut components = made.into_iter().collect::<Result<Vec<_>, Error>>()?;
    for (index, ready, times) in others {
        let mut component = components[place[&ready.shape]].of_instance(index, ready);
        component.times += times;
        components.push(component);
    }
    components.sort_by_key(|component| component.index);
    *times += Times::on_clock(components.iter().map(|component| component.times), began.elapsed());
    Ok(components.into_iter().map(Arc::new).collect())
}

/// What the user should know of components.
fn notes_of(components: &[Arc<Component>]) -> Vec<Note> {
    components.iter().flat_map(|component| component.notes.iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_analysis_and_what_comes_of_it_can_be_shared_by_threads() {
        fn is_shared<T: Send + Sync + Clone + 'static>() {}
        is_shared::<Analysis>();
        is_shared::<Cones>();
        is_shared::<Atlas>();
        is_shared::<ConeOrder>();
        is_shared::<Error>();
    }

    #[test]
    fn parts_without_handles_are_shared_when_the_others_are_opened() {
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        for (shape, x) in [(geom::shapes::hare(300), 0.0), (geom::shapes::torus(1, 300), 9.0)] {
            let first = points.len() as u32;
            points.extend(shape.points.iter().map(|p| [p[0] + x, p[1], p[2]]));
            triangles.extend(shape.triangles.iter().map(|t| t.map(|v| first + v)));
        }
        let model = geom::shapes::Shape { points, triangles }.into();
        let closed = Analysis::new(&model).unwrap();
        let opened = closed.with_handles_opened().unwrap().expect("the torus has a handle");
        let mut pairs = closed.components().iter().zip(opened.components());
        assert!(pairs.all(|(closed, opened)| Arc::ptr_eq(closed, opened) != closed.has_handles()));
        assert_eq!(closed.components().iter().filter(|part| part.has_handles()).count(), 1);
    }

    #[test]
    fn what_is_taken_for_one_in_maps_is_what_was_found_to_be() {
        let hare = geom::shapes::hare(300);
        let corners: Vec<[f64; 3]> = hare.triangles.as_flattened().iter().map(|&v| hare.points[v as usize]).collect();
        let faces: Vec<[u32; 3]> = (0..hare.triangles.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let apart = Model::from_triangles(corners, &faces).unwrap();
        let one = Model::from_triangles(apart.points()[..3].to_vec(), &faces[..1]).unwrap();
        for (model, is_welded) in [(&apart, true), (&hare.into(), false), (&one, false)] {
            for weld in [Weld::Auto, Weld::Always, Weld::Never] {
                for refine in [Refining::Never, Refining::Always] {
                    let analysis = Analysis::with(model, Preparation { weld, refine, ..Preparation::default() });
                    // As many parts as triangles are a surface all the same.
                    let Ok(analysis) = analysis else { continue };
                    let of = analysis.refined().map_or(model, |refined| &refined.model);
                    assert_eq!(analysis.weld().of(of), weld.of(of));
                    if refine == Refining::Never && !is_welded {
                        assert_eq!(analysis.weld(), Weld::Never);
                    }
                }
            }
        }
    }
}
