//! One connected component of a model: what is found of it once.
//!
//! Components know nothing of each other, so they can be worked on at the same time. Those that are instances of one shape ([`geom::unify_instances`])
//! share what is found of it.

use std::collections::HashSet;
use std::sync::{Arc, OnceLock};

use geom::{FaceId, HalfedgeId, Id, Interrupted, Mesh, Metric, PoissonError, Surface, VertexData, VertexId, Watch};
use topo::{Extremum, Kind};

use super::cones::{Cone, Configuration};
use super::filled::Filled;
use super::note::Note;
use super::observer::{Stage, Task, Times};
use super::options::{ConeChoice, Options, Preparation};
use super::refined::{OpenedHandles, Ready, Straightened, Way};
use crate::curvature::{ConeCurvatures, CurvatureError, CurvatureRule, cone_curvatures, least_cones};
use crate::cut::{SeamOptions, Symmetry, ascending};
use crate::error::Error;
use crate::field::{ConformalFactor, Operators};
use crate::flatten::Chain;
use crate::hierarchy::ConeHierarchy;
use crate::placement::{
    Automatic, CoarseLevel, ConeSet, EnergyModel, EnergyTerms, Ground, Placed, Placement, Search, moved_off, quantized,
    size_of_level,
};

/// How components are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Making {
    pub(super) preparation: Preparation,
    /// Refined as far as they will be: smaller where [a map shows that](super::sizing).
    pub(super) is_finest: bool,
    /// Refined though there are few needles, since the map of the model as it is [bends angles](super::finer).
    pub(super) is_bent: bool,
    /// With what their coarse levels are made of, which are searched soon.
    pub(super) is_searched: bool,
    /// With handles opened.
    pub(super) is_opened: bool,
    /// Opened along seams that are given, so that whoever has given them wants no others.
    pub(super) is_cut_as_given: bool,
    /// For one map: then large factors go when it needs them no more.
    pub(super) is_asked_once: bool,
}

/// A given cone on the surface of a component: the vertex there, that of the model, the curvature.
pub(super) type OnSurface = (VertexId, u32, Option<f64>);

/// What is found once; see the module's head. It is never changed.
#[derive(Debug)]
pub(crate) struct Component {
    /// Its place among the model's components.
    pub(crate) index: usize,
    /// The number of the first component that is of the same shape.
    shape: usize,
    pub(crate) surface: Surface,
    /// To the refined model, if it was refined.
    pub(crate) way: Option<Way>,
    /// The handles that were opened.
    pub(crate) handles: OpenedHandles,
    /// The paths that were made straight.
    pub(super) straight: Option<Arc<Straightened>>,
    /// The sides on the boundary round small holes,
    pub(super) holes: Arc<HashSet<HalfedgeId>>,
    /// and the surface with these filled as far as they are whole, if they are to be.
    pub(super) filled: Option<Arc<Filled>>,
    /// The edge lengths in space, mollified where they have to be.
    pub(crate) metric: Metric,
    /// The area in the model's units.
    pub(crate) area: f64,
    pub(crate) operators: Arc<Operators>,
    pub(crate) factor: Arc<ConformalFactor>,
    pub(crate) hierarchy: Arc<ConeHierarchy>,
    terms: Arc<OnceLock<Arc<EnergyTerms>>>,
    level: Arc<OnceLock<Option<CoarseLevel>>>,
    is_asked_once: bool,
    /// Whether it is refined as far as it will be.
    pub(super) is_finest: bool,
    pub(crate) notes: Vec<Note>,
    pub(crate) times: Times,
}

impl Component {
    /// What is found once of a surface.
    pub(super) fn new(index: usize, ready: Ready, making: Making, task: &Task) -> Result<Self, Error> {
        let Making { preparation, is_finest, is_searched, is_asked_once, .. } = making;
        let Ready { surface, mut metric, way, handles, straight, holes, shape } = ready;
        let area = metric.area(&surface.mesh) / surface.scale / surface.scale;
        let mut notes = Vec::new();
        let mut times = Times::default();
        let fill = |metric: &Metric| {
            preparation.fill_holes.and_then(|_| Filled::new(&surface.mesh, metric, &surface.points, &holes))
        };
        let mut filled = fill(&metric);
        let operators = task.stage((Stage::Factor, index), &mut times, |watch| {
            let made = |metric: &Metric, filled: Option<&Filled>| {
                let tied = handles.of_vertex.as_ref();
                let (mesh, metric) = filled.map_or((&surface.mesh, metric), |filled| (&filled.mesh, &filled.metric));
                let ahead = if is_searched { size_of_level(mesh) } else { None };
                Operators::with_tied_loops((mesh, metric), &surface.points, tied, ahead, watch)
            };
            let operators = made(&metric, filled.as_ref());
            if !matches!(operators, Err(PoissonError::NotPositiveDefinite)) {
                return operators;
            }
            metric = metric.mollified(&surface.mesh, Metric::MOLLIFICATION);
            filled = fill(&metric);
            notes.push(Note::Mollified { component: index });
            made(&metric, filled.as_ref())
        })??;
        let (factor, hierarchy) =
            task.stage((Stage::Hierarchy, index), &mut times, |watch| -> Result<_, Error> {
                let smoothed =
                    preparation.smooth.then(|| ConformalFactor::smoothed(&operators, watch.within(0.0, 0.4)));
                if let Some(Err(_)) = &smoothed {
                    notes.push(Note::NotSmoothed { component: index });
                }
                let factor = smoothed.and_then(Result::ok).unwrap_or_else(|| ConformalFactor::new(&operators));
                watch.ask(0.5)?;
                let hierarchy = ConeHierarchy::new(&operators, &factor);
                Ok((factor, hierarchy))
            })??;
        Ok(Self {
            index,
            shape,
            surface,
            way,
            handles,
            straight,
            holes: Arc::new(holes),
            filled: filled.map(Arc::new),
            metric,
            area,
            operators: Arc::new(operators),
            factor: Arc::new(factor),
            hierarchy: Arc::new(hierarchy),
            terms: Arc::default(),
            level: Arc::default(),
            is_asked_once,
            is_finest,
            notes,
            times,
        })
    }

    /// What is found of another surface of the same shape, made ready in the same way.
    pub(super) fn of_instance(
        &self,
        index: usize,
        Ready { surface, way, handles, straight, holes: _, metric: _, shape }: Ready,
    ) -> Self {
        let mut instance = Self {
            index,
            shape,
            surface,
            way,
            handles,
            straight,
            holes: Arc::clone(&self.holes),
            filled: self.filled.clone(),
            metric: self.metric.clone(),
            area: self.area,
            operators: Arc::clone(&self.operators),
            factor: Arc::clone(&self.factor),
            hierarchy: Arc::clone(&self.hierarchy),
            terms: Arc::clone(&self.terms),
            level: Arc::clone(&self.level),
            is_asked_once: self.is_asked_once,
            is_finest: self.is_finest,
            notes: Vec::new(),
            times: Times::default(),
        };
        instance.notes = instance.own_notes(&self.notes, self);
        instance
    }

    /// What there is to say of another one of the same shape, said of this one.
    pub(super) fn own_notes(&self, notes: &[Note], other: &Self) -> Vec<Note> {
        let own = |vertex: u32| {
            let v = other.surface.vertex.iter().position(|&v| v == vertex);
            v.map_or(vertex, |v| self.surface.vertex[VertexId::new(v)])
        };
        notes.iter().map(|note| note.clone().said_of(self.index, own)).collect()
    }

    /// The surface as it was made ready.
    pub(crate) fn ready(&self) -> Ready {
        let Self { surface, metric, way, straight, holes, shape, .. } = self;
        Ready {
            surface: surface.clone(),
            metric: metric.clone(),
            way: way.clone(),
            handles: OpenedHandles::default(),
            straight: straight.clone(),
            holes: HashSet::clone(holes),
            shape: *shape,
        }
    }

    /// What cones are placed on.
    pub(crate) fn ground<'a>(&'a self, search: Search, watch: Watch<'a>) -> Ground<'a> {
        let Self { operators, hierarchy, terms, level, .. } = self;
        Ground { operators, input: self.whole().0, hierarchy, terms, level, search, watch }
    }

    /// Its coarse level, once that has been asked for.
    pub(crate) fn level(&self) -> Option<&CoarseLevel> {
        self.level.get().and_then(Option::as_ref)
    }

    /// The operators that a number of cones was chosen with: its own, or those of its coarse level.
    pub(crate) fn operators_of(&self, found: &Automatic) -> &Operators {
        if found.is_from_level { self.searched() } else { &self.operators }
    }

    /// The operators of its coarse level, once that has been asked for; its own where there is none.
    pub(crate) fn searched(&self) -> &Operators {
        self.level().map_or(&self.operators, |level| &level.operators)
    }

    /// Lets a large factor go if one map is made of it, which needs it no more.
    pub(super) fn let_factor_go(&self) {
        if self.is_asked_once {
            self.operators.let_factor_go();
        }
    }

    /// Whether it was refined by one who can do without.
    pub(super) fn may_be_unrefined(&self) -> bool {
        self.is_asked_once && self.way.is_some()
    }

    /// Factors its Laplacian again if the factor was let go.
    pub(super) fn factor_again(&self, task: &Task, times: &mut Times) -> Result<(), Error> {
        task.stage((Stage::Factor, self.index), times, |watch| self.operators.factor_again(watch))??;
        Ok(())
    }

    /// How many cones it needs at least.
    pub(crate) fn least(&self) -> usize {
        least_cones(&self.operators)
    }

    /// Whether it has handles.
    pub(crate) fn has_handles(&self) -> bool {
        self.surface.mesh.genus() > 0
    }

    pub(crate) fn inner_vertices(&self) -> usize {
        let (mesh, _) = self.whole();
        mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).count()
    }

    /// `asked` cones, or as many more as it takes for its curvature.
    pub(crate) fn place(
        &self,
        options: &Options,
        asked: usize,
        task: &Task,
        times: &mut Times,
    ) -> Result<Configuration, Error> {
        self.place_by(Placement::cones, options, asked, task, times)
    }

    /// [`place`](Self::place) by one of a placement's ways.
    pub(super) fn place_by(
        &self,
        way: fn(Placement, Ground, usize) -> Result<Placed, PoissonError>,
        options: &Options,
        asked: usize,
        task: &Task,
        times: &mut Times,
    ) -> Result<Configuration, Error> {
        let mut count = asked;
        loop {
            let placement = options.placement_for(count);
            let Placed { cones, curvatures } = task.stage((Stage::Hierarchy, self.index), times, |watch| {
                let placed = way(placement, self.ground(options.search, watch), count)?;
                let moved = self.moved_off_avoided(&placed.cones, options, watch)?;
                Ok::<Placed, PoissonError>(
                    moved
                        .map_or(placed, |(model, set)| Placed { curvatures: model.curvatures(&set), cones: set.cones }),
                )
            })??;
            let placed = cones.len();
            let configured = task.stage((Stage::Curvature, self.index), times, |watch| {
                match curvatures.filter(|_| options.rule == CurvatureRule::Optimal && options.quantize.is_none()) {
                    Some(known) => Ok(self.configured(cones, known)),
                    None => self.with_curvatures(cones, options, watch),
                }
            })?;
            let mut configuration = match configured {
                Err(CurvatureError::TooFew { .. }) if placed == count => {
                    count += 1 + count / 4;
                    continue;
                }
                configuration => configuration?,
            };
            let component = self.index;
            // Where fewer could be placed than were asked for, all vertices are cones, whatever the method.
            if options.placement_for(placed) != options.placement_for(0) {
                configuration.notes.push(Note::PlacedByPersistence { component, cones: placed });
            }
            if count > asked {
                configuration.notes.push(Note::MoreForCurvature { component, asked, taken: count });
            } else if placed < asked && !matches!(options.cones, ConeChoice::WithinDistortion(_)) {
                configuration.notes.push(Note::FewVertices { component, asked, there: placed });
            }
            return Ok(configuration);
        }
    }

    /// The cones moved to where a seam may reach them, if some are where it may not: where all edges are to be avoided. None if there is nothing to move.
    ///
    /// # Errors
    /// If the watch has said stop.
    pub(super) fn moved_off_avoided<'a>(
        &'a self,
        cones: &[VertexId],
        options: &Options,
        watch: Watch<'a>,
    ) -> Result<Option<(EnergyModel<'a>, ConeSet)>, Interrupted> {
        let SeamOptions { avoid, given, kept, .. } = &options.seams;
        if avoid.is_empty() {
            return Ok(None);
        }
        let Surface { mesh, vertex, diagonal, .. } = &self.surface;
        let mut avoided: HashSet<[u32; 2]> = avoid.iter().map(|&ends| ascending(ends)).collect();
        given.iter().chain(kept).for_each(|&ends| _ = avoided.remove(&ascending(ends)));
        let mut is_reached = VertexData::constant(mesh.vertex_count(), false);
        for e in mesh.edges().filter(|&e| !diagonal[e]) {
            let ends = mesh.ends(e);
            if !avoided.contains(&ascending(ends.map(|v| vertex[v]))) {
                ends.into_iter().for_each(|v| is_reached[v] = true);
            }
        }
        moved_off(self.ground(options.search, watch), cones, |v| !is_reached[v])
    }

    /// Gives cones that were placed their curvatures: by a rule, or on a lattice, for which they may go elsewhere.
    pub(crate) fn with_curvatures(
        &self,
        vertices: Vec<VertexId>,
        options: &Options,
        watch: Watch,
    ) -> Result<Configuration, CurvatureError> {
        match options.quantize {
            Some(symmetry) => self.quantize(vertices, symmetry, true, watch),
            None => self.configure(vertices, options.rule, watch),
        }
    }

    /// Gives cones curvatures that are multiples of a texture's angle.
    fn quantize(
        &self,
        vertices: Vec<VertexId>,
        symmetry: Symmetry,
        is_free: bool,
        watch: Watch,
    ) -> Result<Configuration, CurvatureError> {
        let placed = vertices.len();
        let (vertices, curvature) = quantized(self.ground(Search::Full, watch), &vertices, symmetry.angle(), is_free)?;
        let given = ConeCurvatures::given(&self.operators, &vertices, curvature, watch)?;
        let mut notes = Vec::new();
        if vertices.len() < placed {
            notes.push(Note::RoundedAway { component: self.index, placed, left: vertices.len() });
        }
        Ok(Configuration { vertices, curvature: given.curvature, predicted: given.predicted, notes })
    }

    /// Gives cones their curvatures by a rule.
    pub(crate) fn configure(
        &self,
        vertices: Vec<VertexId>,
        rule: CurvatureRule,
        watch: Watch,
    ) -> Result<Configuration, CurvatureError> {
        let found = cone_curvatures(&self.operators, self.whole().0, &vertices, rule, watch)?;
        Ok(self.configured(vertices, found))
    }

    /// Cones with the curvatures that a rule has given them.
    pub(crate) fn configured(&self, vertices: Vec<VertexId>, found: ConeCurvatures) -> Configuration {
        let mut notes = Vec::new();
        if let [first, ..] = found.out_of_bounds[..] {
            notes.push(Note::HarmonicOutOfBounds {
                component: self.index,
                count: found.out_of_bounds.len(),
                cones: vertices.len(),
                first: self.surface.vertex[first],
            });
        }
        Configuration { vertices, curvature: found.curvature, predicted: found.predicted, notes }
    }

    /// Cones that keep the curvature that they have: where other vertices have none, nothing is stretched.
    pub(crate) fn with_own_curvatures(&self, vertices: Vec<VertexId>) -> Configuration {
        let own = vertices.iter().map(|&v| self.operators.curvature()[v]).collect();
        let nothing = VertexData::constant(self.operators.mesh().vertex_count(), 0.0);
        self.configured(vertices, ConeCurvatures::known(&self.operators, own, |_| nothing))
    }

    /// Takes curvatures as they are given.
    pub(crate) fn configure_given(
        &self,
        vertices: Vec<VertexId>,
        curvature: Vec<f64>,
        watch: Watch,
    ) -> Result<Configuration, Error> {
        let sum: f64 = curvature.iter().sum();
        let total = self.operators.total_curvature();
        if !self.operators.is_bordered() && (sum - total).abs() > 1e-6 {
            return Err(Error::CurvatureSum { part: Some(self.index), sum, total, has_handles: self.has_handles() });
        }
        if let Some(k) = curvature.iter().find(|k| k.is_nan() || **k >= 2.0 * std::f64::consts::PI) {
            return Err(Error::CurvatureTooLarge(*k));
        }
        let given = ConeCurvatures::given(&self.operators, &vertices, curvature, watch)?;
        Ok(Configuration { vertices, curvature: given.curvature, predicted: given.predicted, notes: Vec::new() })
    }

    /// The given cones that lie on it, with their curvatures.
    pub(super) fn given(&self, here: &[OnSurface], options: &Options, watch: Watch) -> Result<Configuration, Error> {
        let (mesh, _) = self.whole();
        if let Some(&(_, vertex, _)) = here.iter().find(|(v, _, _)| mesh.is_boundary_vertex(*v)) {
            let is_at_hole = self.holes.iter().any(|&h| self.surface.vertex[self.surface.mesh.tail(h)] == vertex);
            return Err(if is_at_hole { Error::ConeAtHole(vertex) } else { Error::ConeOnBoundary(vertex) });
        }
        let vertices = here.iter().map(|&(v, _, _)| v).collect();
        let curvatures: Option<Vec<f64>> = here.iter().map(|&(_, _, k)| k).collect();
        match curvatures.filter(|k| !k.is_empty()) {
            Some(curvatures) => self.configure_given(vertices, curvatures, watch),
            None => match options.quantize {
                Some(symmetry) => Ok(self.quantize(vertices, symmetry, false, watch)?),
                None => Ok(self.configure(vertices, options.rule, watch)?),
            },
        }
    }

    /// Puts the model's corners where a map has them, given the position of each halfedge.
    pub(crate) fn spread(&self, position: impl Fn(HalfedgeId) -> [f64; 2], mut put: impl FnMut(u32, [f64; 2])) {
        let Self { surface, way, .. } = self;
        let Some(way) = way else {
            surface.mesh.halfedges().for_each(|h| put(surface.corner[h], position(h)));
            return;
        };
        for (corner, h, along) in way.corners() {
            let (p, q) = (position(h), position(surface.mesh.next(h)));
            // From the same end whichever side it is seen from, lest the sides differ by a rounding.
            let is_named = way.is_named(&surface.mesh, h);
            let (from, to, share) = if is_named { (q, p, 1.0 - along) } else { (p, q, along) };
            let between = match share {
                ..=0.0 => from,
                1.0.. => to,
                _ => [0, 1].map(|c| from[c] + share * (to[c] - from[c])),
            };
            put(corner, between);
        }
    }

    /// The model's vertices along a piece of seam.
    pub(crate) fn vertices_along(&self, chain: &Chain) -> Vec<u32> {
        let of_model = |v: VertexId| self.surface.vertex[v];
        let Some(way) = &self.way else { return chain.vertices.iter().copied().map(of_model).collect() };
        let mut along: Vec<u32> = chain.vertices.first().copied().map(of_model).into_iter().collect();
        for (&e, ends) in chain.edges.iter().zip(chain.vertices.windows(2)) {
            along.extend(way.inside(&self.surface.mesh, e, ends[0]));
            along.push(of_model(ends[1]));
        }
        along
    }

    /// Its mesh as it was before handles were opened: halfedges and triangles have the same numbers there, edges and vertices others.
    pub(super) fn closed(&self) -> &Mesh {
        self.handles.closed.as_deref().unwrap_or(&self.surface.mesh)
    }

    /// What a vertex was before handles were opened.
    pub(super) fn vertex_closed(&self, v: VertexId) -> VertexId {
        let at = self.handles.closed.as_ref().and_then(|closed| Some((closed, self.surface.mesh.outgoing(v).next()?)));
        at.map_or(v, |(closed, h)| closed.tail(h))
    }

    /// What a vertex became when handles were opened: one of both where it is on a loop.
    pub(super) fn vertex_opened(&self, v: VertexId) -> VertexId {
        let at = self.handles.closed.as_ref().and_then(|closed| closed.outgoing(v).next());
        at.map_or(v, |h| self.surface.mesh.tail(h))
    }

    /// The model's triangles that a triangle is.
    pub(crate) fn triangles_of(&self, f: FaceId) -> &[u32] {
        let alone = std::slice::from_ref(&self.surface.triangle[f]);
        self.way.as_ref().map_or(alone, |way| way.triangles(f))
    }

    /// A cone as it is told of.
    pub(crate) fn cone(&self, v: VertexId, curvature: f64, points: &[[f64; 3]]) -> Cone {
        let vertex = self.surface.vertex[v];
        let extremum = self.hierarchy.extremum(v);
        let by_sign = if curvature >= 0.0 { Kind::Minimum } else { Kind::Maximum };
        Cone {
            component: self.index,
            vertex,
            position: points[vertex as usize],
            kind: extremum.map_or(by_sign, |e: Extremum<_, _>| e.kind),
            persistence: extremum.map(|e| e.persistence),
            curvature,
        }
    }
}
