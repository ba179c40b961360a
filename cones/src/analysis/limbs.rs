//! Thin limbs cut off at their necks, where no affordable number of cones keeps lengths.
//!
//! Trees, nerve cells and what has many spikes ask for more cones than can be placed, or change lengths a thousandfold on the way to a tip. Cut into
//! pieces of few limbs each ([`limbs`]), which are parts like any others from then on, they are easy: each piece gets the cones that it needs, and
//! the boundary at its necks takes curvature.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use geom::{EdgeData, EdgeId, FaceData, Mesh, OpenedIsland, Watch, open_islands};

use super::Analysis;
use super::atlas::Atlas;
use super::attempts;
use super::choosing::{Chosen, are_same, interrupted_or};
use super::component::Component;
use super::cones::Configuration;
use super::instances::{OfShape, each_shape};
use super::note::Note;
use super::observer::{Stage, Task, Times};
use super::options::{self, Islands, Options};
use super::refined::Ready;
use crate::cut::{Limbs, SeamFigures, ascending, limbs};
use crate::error::Error;
use crate::field::Operators;
use crate::flatten::{Chain, seam_lengths};
use crate::placement::{Automatic, Placement, area_distortion, is_hopeless};

/// A piece has so many tips at most; pieces on which cones fail again are cut again, for fewer.
const MOST_TIPS: [usize; 3] = [24, 12, 6];
/// Limbs are cut off where there are more tips than this. Where there are fewer it is first tried
const FEW_TIPS: usize = 64;
/// whether so many cones for each are enough, up to the next power of two: raptor's 54 tips get 256.
const CONES_PER_TIP: usize = 4;

/// An area distortion that so few cones as are chosen first leave only where many more are needed; on rough surfaces, of which less is measured than is
/// predicted, more is [bad](attempts::BAD): white noise of 14,400 vertices came to 1,063 islands.
const BAD: f64 = 1.5;

/// What is done with a part.
#[derive(Clone)]
enum Remedy {
    /// Nothing.
    None,
    /// It gets more cones.
    Cones(Configuration),
    /// It is cut into pieces.
    Pieces(Vec<OpenedIsland>),
}

impl OfShape for Remedy {
    fn said_of(&self, other: &Component, component: &Component) -> Self {
        match self {
            Self::Cones(cones) => Self::Cones(cones.said_of(other, component)),
            remedy => remedy.clone(),
        }
    }
}

/// What is known of a part.
#[derive(Clone, Default)]
pub(super) struct Settled {
    /// What an automatic number is, if it has been found.
    pub(super) found: Option<Automatic>,
    /// The cones that it gets in place of these.
    pub(super) cones: Option<Configuration>,
    /// How many times it was cut out of another one.
    cuts: usize,
}

/// Whether the automatic number of a part has been found.
pub(super) fn is_settled(settled: &[Settled], part: usize) -> bool {
    settled.get(part).is_some_and(|settled| settled.found.is_some())
}

/// A model some of whose parts are in pieces.
pub(super) struct CutOff {
    pub(super) analysis: Analysis,
    pub(super) parts: Vec<Settled>,
    /// The part that each of its parts was before.
    before: Vec<usize>,
    /// The necks, as chains of vertices of the model.
    necks: Vec<Vec<u32>>,
    /// What is not cut since thin limbs are there, but since it is given.
    given: Vec<Vec<u32>>,
    figures: SeamFigures,
}

impl Analysis {
    /// The model with thin limbs cut off those parts on which the cones chosen are hopeless, unless more of them are enough; none if there are no limbs,
    /// or whoever asked has a say in where seams run or in how many cones there are. `taken` is the same model, perhaps with handles opened, for which
    /// they were chosen.
    pub(super) fn with_limbs_cut_off(
        &self,
        (taken, chosen): (&Self, &mut Chosen),
        options: &Options,
        (settled, times): (&[Settled], &mut Times),
    ) -> Result<Option<CutOff>, Error> {
        let has_say = options.seams.names_edges()
            || self.found.making.is_cut_as_given
            || options.quantize.is_some()
            || options.islands == Islands::Single;
        let Some(goal) = options.cones.goal() else { return Ok(None) };
        if has_say || options.limbs == options::Limbs::Never {
            return Ok(None);
        }
        let task = self.task();
        let cuts = |part: usize| settled.get(part).map_or(0, |settled| settled.cuts);
        let configurations = &chosen.1;
        let is_same = |one: usize, other: usize| {
            cuts(one) == cuts(other) && are_same(&configurations[one], &configurations[other])
        };
        let remedies = each_shape(self.components(), times, is_same, |component, times| {
            let taken = &taken.components()[component.index];
            let is_in_question = match &configurations[component.index] {
                _ if is_settled(settled, component.index) => false,
                Ok(Configuration { predicted, .. }) => {
                    let predicted = area_distortion(&taken.operators, predicted);
                    predicted > BAD && (predicted > attempts::BAD || !taken.is_rough())
                }
                Err(_) => true,
            };
            let most_tips = MOST_TIPS.get(cuts(component.index)).filter(|_| is_in_question);
            let Some(limbs) = most_tips.map(|&most| component.limbs(most, &task, times)).transpose()?.flatten() else {
                return Ok(Remedy::None);
            };
            if limbs.tips > FEW_TIPS {
                return Ok(component.pieces(&limbs));
            }
            match &configurations[component.index] {
                Ok(chosen) if !is_hopeless(&taken.operators, &chosen.predicted) => Ok(Remedy::None),
                _ => match taken.many_cones(limbs.tips, goal, options, &task, times)? {
                    Some(cones) => Ok(Remedy::Cones(cones)),
                    None => Ok(component.pieces(&limbs)),
                },
            }
        })?;
        if !remedies.iter().any(|remedy| matches!(remedy, Remedy::Pieces(_))) {
            for (configuration, remedy) in chosen.1.iter_mut().zip(remedies) {
                if let Remedy::Cones(more) = remedy {
                    *configuration = Ok(more);
                }
            }
            return Ok(None);
        }
        let more = |part: usize| match &remedies[part] {
            Remedy::Cones(more) => Some(more.clone()),
            _ => settled.get(part).and_then(|settled| settled.cones.clone()),
        };
        let parts = (0..remedies.len())
            .map(|part| Settled { found: chosen.0.found.get(part).cloned(), cones: more(part), cuts: cuts(part) })
            .collect();
        let mut cut_off = CutOff::none(taken.clone(), parts);
        let mut ready = Vec::new();
        // The places of the pieces of the first part of each shape.
        let mut of_shape: HashMap<*const Operators, Vec<usize>> = HashMap::new();
        for (component, remedy) in self.components().iter().zip(remedies) {
            let Remedy::Pieces(pieces) = remedy else { continue };
            let part = component.index;
            [component, &taken.components()[part]].into_iter().for_each(|component| component.let_factor_go());
            let first = of_shape.entry(Arc::as_ptr(&component.operators)).or_default();
            let settled = Settled { cuts: cuts(part) + 1, ..Settled::default() };
            ready.extend(cut_off.cut(component, pieces, first, &settled));
        }
        let task = Task::new(&self.observer, cut_off.before.len());
        cut_off.analysis.found =
            Arc::new(self.found.in_pieces(taken, ready, self.found.making.is_cut_as_given, &task, times)?);
        Ok(Some(cut_off))
    }
}

impl Analysis {
    /// The model with limbs cut off at necks that are given, as chains of its vertices; none if none is given.
    ///
    /// # Errors
    /// If they part no surface, if a Laplacian cannot be factored, or if the observer has said stop.
    pub(super) fn cut_at(&self, necks: &[Vec<u32>]) -> Result<Option<CutOff>, Error> {
        if necks.is_empty() {
            return Ok(None);
        }
        let edges = edges_along(necks);
        let mut cut_off = CutOff::none(self.clone(), vec![Settled::default(); self.components().len()]);
        let mut ready = Vec::new();
        for component in self.components() {
            let mesh = &component.surface.mesh;
            let is_cut = |e: EdgeId| {
                let whole = Chain { vertices: mesh.ends(e).to_vec(), edges: vec![e] };
                let along = component.vertices_along(&whole);
                !mesh.is_boundary_edge(e) && along.windows(2).all(|part| edges.contains(&ascending([part[0], part[1]])))
            };
            let pieces = open_islands(mesh, &mesh.edges().map(is_cut).collect());
            if pieces.len() > 1 {
                component.let_factor_go();
                // Each is worked on by itself.
                ready.extend(cut_off.cut(component, pieces, &mut Vec::new(), &Settled::default()));
            }
        }
        if ready.is_empty() {
            return Err(Error::NoNecks);
        }
        let task = Task::new(&self.observer, cut_off.before.len());
        cut_off.analysis.found = Arc::new(self.found.in_pieces(
            self,
            ready,
            self.found.making.is_cut_as_given,
            &task,
            &mut Times::default(),
        )?);
        Ok(Some(cut_off))
    }
}

impl Component {
    /// Its thin limbs, if it has more tips than so many; none where handles were opened from the start, whose loops a cut might part.
    fn limbs(&self, most_tips: usize, task: &Task, times: &mut Times) -> Result<Option<Limbs>, Error> {
        let Self { index, surface, metric, factor, handles, .. } = self;
        if handles.of_vertex.is_some() {
            return Ok(None);
        }
        let lengths = seam_lengths(surface, metric);
        let found = |watch: Watch| limbs(&surface.mesh, &lengths, &factor.phi, most_tips, watch);
        Ok(task.stage((Stage::Cut, *index), times, found)??)
    }

    fn pieces(&self, limbs: &Limbs) -> Remedy {
        let mesh = &self.surface.mesh;
        Remedy::Pieces(open_islands(mesh, &between(mesh, &limbs.piece)))
    }

    /// So many cones as so many tips need, if these are predicted to be enough.
    fn many_cones(
        &self,
        tips: usize,
        goal: f64,
        options: &Options,
        task: &Task,
        times: &mut Times,
    ) -> Result<Option<Configuration>, Error> {
        let count = (CONES_PER_TIP * tips).next_power_of_two();
        if count > self.most_cones() {
            return Ok(None);
        }
        let placed = interrupted_or(self.place_by(Placement::quick_cones, options, count, task, times))?;
        let is_enough = |cones: &Configuration| {
            area_distortion(&self.operators, &cones.predicted) <= goal
                && !is_hopeless(&self.operators, &cones.predicted)
        };
        Ok(placed.ok().filter(is_enough))
    }
}

impl CutOff {
    /// An analysis none of whose parts is in pieces.
    fn none(analysis: Analysis, parts: Vec<Settled>) -> Self {
        let before = (0..parts.len()).collect();
        Self { analysis, parts, before, necks: Vec::new(), given: Vec::new(), figures: SeamFigures::default() }
    }

    /// An analysis opened along seams that are given, and the part that each of its parts was before.
    pub(super) fn along_seams(analysis: Analysis, before: Vec<usize>, given: Vec<Vec<u32>>) -> Self {
        Self { before, given, ..Self::none(analysis, Vec::new()) }
    }

    /// Puts a part into pieces, the first in its place; these, with their places. `first` has the places of the pieces of the first part of its shape, or gets
    /// these; `settled` is what is known of each.
    fn cut(
        &mut self,
        component: &Component,
        pieces: Vec<OpenedIsland>,
        first: &mut Vec<usize>,
        settled: &Settled,
    ) -> Vec<(usize, Ready)> {
        let part = component.index;
        let necks = necks(&component.surface.mesh, &pieces);
        self.figures += SeamFigures::of_chains(&component.surface, &component.metric, &necks);
        self.necks.extend(necks.iter().map(|chain| component.vertices_along(chain)));
        let places: Vec<usize> = std::iter::once(part).chain(self.before.len()..).take(pieces.len()).collect();
        if first.is_empty() {
            first.clone_from(&places);
        }
        self.parts[part] = settled.clone();
        self.parts.extend(places[1..].iter().map(|_| settled.clone()));
        self.before.extend(places[1..].iter().map(|_| part));
        let whole = component.ready();
        let pieces = pieces.into_iter().enumerate();
        pieces.map(|(k, piece)| (places[k], whole.island(piece, first[k]).in_unit_size())).collect()
    }

    /// Its atlas as one of the model before.
    pub(super) fn put_back(self, atlas: Result<Atlas, Error>) -> Result<Atlas, Error> {
        let mut atlas = atlas.map_err(|error| match error {
            Error::NotFlatRefined { component } => Error::NotFlatRefined { component: self.before[component] },
            error => error,
        })?;
        atlas.cones.iter_mut().for_each(|cone| cone.component = self.before[cone.component]);
        atlas.cones.sort_by_key(|cone| cone.component);
        let of_part = |note: Note| match note.component() {
            Some(component) => note.said_of(self.before[component], |v| v),
            None => note,
        };
        // What another number was taken for is no number of the part's.
        let is_cut = |part: usize| self.before.iter().filter(|&&before| before == part).count() > 1;
        let notes = atlas.notes.into_iter().map(of_part);
        let mut own: Vec<Note> = Vec::new();
        for note in notes.filter(|note| !matches!(note, Note::OtherNumber { component, .. } if is_cut(*component))) {
            if !own.contains(&note) {
                own.push(note);
            }
        }
        atlas.notes = own;
        atlas.seams.splice(0..0, self.given);
        let first = atlas.seams.len() - atlas.opened_handles - atlas.necks;
        atlas.necks += self.necks.len();
        atlas.recipe.necks.extend(self.necks.iter().cloned());
        atlas.seams.splice(first..first, self.necks);
        atlas.seam_figures += self.figures;
        Ok(atlas)
    }
}

/// The edges along chains of vertices, by these in ascending order.
fn edges_along(chains: &[Vec<u32>]) -> HashSet<[u32; 2]> {
    chains.iter().flat_map(|chain| chain.windows(2).map(|ends| ascending([ends[0], ends[1]]))).collect()
}

/// The edges between different pieces.
fn between(mesh: &Mesh, piece: &FaceData<u32>) -> EdgeData<bool> {
    let is_between = |h| mesh.twin(h).is_some_and(|g| piece[mesh.face(h)] != piece[mesh.face(g)]);
    mesh.edges().map(|e| is_between(mesh.halfedge(e))).collect()
}

/// The loops between pieces, or their runs where they meet each other or the boundary, each once.
fn necks(mesh: &Mesh, pieces: &[OpenedIsland]) -> Vec<Chain> {
    let mut piece_of = FaceData::constant(mesh.face_count(), 0);
    for (k, piece) in (0..).zip(pieces) {
        piece.halfedge.iter().for_each(|&h| piece_of[mesh.face(h)] = k);
    }
    let mut necks = Vec::new();
    for (k, piece) in (0..).zip(pieces) {
        for around in piece.mesh.boundary_loops() {
            let around: Vec<_> = around.into_iter().map(|h| piece.halfedge[h]).collect();
            let is_own = |h| mesh.twin(h).is_some_and(|g| piece_of[mesh.face(g)] < k);
            // From where a run begins, if not all are one.
            let first = (0..around.len())
                .find(|&i| is_own(around[i]) && !is_own(around[(i + around.len() - 1) % around.len()]));
            let around = [&around[first.unwrap_or(0)..], &around[..first.unwrap_or(0)]].concat();
            for run in around.chunk_by(|&a, &b| is_own(a) == is_own(b)).filter(|run| is_own(run[0])) {
                let mut vertices: Vec<_> = run.iter().map(|&h| mesh.tail(h)).collect();
                vertices.extend(run.last().map(|&h| mesh.head(h)));
                necks.push(Chain { vertices, edges: run.iter().map(|&h| mesh.edge(h)).collect() });
            }
        }
    }
    necks
}
