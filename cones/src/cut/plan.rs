//! Where the seams of a surface go: what was asked for, put to work.
//!
//! The surface is opened along the edges that are given; each island of that is cut to a disk by itself ([`Seams::new`]), with
//! its boundary, the given cuts' sides, as terminals like any other boundary. So a given loop that separates makes two islands,
//! each a disk in the end, and given edges that touch no other seam are joined to the rest. Edges that are to be avoided
//! cost [`AVOIDED`] times their length. Then chains are made straight.

use std::collections::{HashMap, HashSet};

use geom::{
    EdgeData, EdgeId, HalfedgeId, Id, Interrupted, Mesh, Metric, Surface, VertexData, VertexId, Watch, edges_at,
    open_islands,
};

use super::cost::shares;
use super::options::SeamOptions;
use super::straighten::{PathCost, straighten};
use super::turning::Turning;
use crate::flatten::{SeamError, Seams, seam_lengths, terminals};

/// What an edge that is to be avoided costs, over its length: more than any way round it that a surface has, and little enough to
/// add up with others without loss.
const AVOIDED: f64 = 1e4;

/// What an edge costs over its length that is no edge of the surface with faces on both sides, but at a hole that is filled, or across: nearly nothing, since nothing is cut there. Of two
/// ways through a hole the shorter one is taken.
const FREE: f64 = 1e-6;

/// Where seams go on one surface.
#[derive(Clone, Debug)]
pub struct SeamPlan {
    /// Infinite inside polygons.
    lengths: EdgeData<f64>,
    cost: EdgeData<f64>,
    /// The lengths, of edges to be avoided times what these cost; none where nothing is to be avoided.
    plain: Option<EdgeData<f64>>,
    given: EdgeData<bool>,
    avoided: EdgeData<bool>,
    has_given: bool,
    /// How straight seams are to be.
    straightness: Option<(f64, Turning)>,
}

impl SeamPlan {
    /// What the options mean on a surface; edges that it does not have are passed over. `metric` has the lengths in space,
    /// `corners` the vertex of each corner of the model. O(F), and the
    /// time of [`exposure`](geom::exposure).
    ///
    /// # Errors
    /// If it is stopped.
    pub fn new(
        surface: &Surface,
        metric: &Metric,
        corners: &[u32],
        options: &SeamOptions,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let weight = if options.weight > 0.0 { options.weight.min(1.0) } else { 0.0 };
        let given = marked(surface, corners, options.given.iter().chain(&options.kept));
        let mut avoided = marked(surface, corners, options.avoid.iter());
        avoided.iter_mut().zip(given.iter()).for_each(|(avoided, given)| *avoided &= !given);
        let lengths = seam_lengths(surface, metric);
        let mut cost = shares(surface, weight, watch.within(0.1, 0.9))?;
        for (e, length) in lengths.iter_ids() {
            cost[e] *= if avoided[e] { AVOIDED * length } else { *length };
        }
        watch.ask(0.9)?;
        let plain = || lengths.iter_ids().map(|(e, l)| if avoided[e] { AVOIDED * l } else { *l }).collect();
        Ok(Self {
            plain: avoided.contains(&true).then(plain),
            has_given: given.iter().any(|&given| given),
            straightness: (weight > 0.0).then(|| (weight, Turning::new(&surface.mesh, metric))),
            lengths,
            cost,
            given,
            avoided,
        })
    }

    /// Gives further edges inside the surface that are cut.
    pub(crate) fn give(&mut self, edges: impl Iterator<Item = EdgeId>) {
        for e in edges {
            self.given[e] = true;
            self.has_given = true;
        }
    }

    /// The same on the surface with its holes filled: edges at caps and on them are [`FREE`].
    pub(crate) fn on_filled(&self, own: &Mesh, (mesh, metric): (&Mesh, &Metric)) -> Self {
        let mut edge = EdgeData::constant(mesh.edge_count(), None);
        for e in own.edges().filter(|&e| !own.is_boundary_edge(e)) {
            edge[mesh.edge(own.halfedge(e))] = Some(e);
        }
        for e in own.edges().filter(|&e| own.is_boundary_edge(e) && mesh.is_boundary_edge(mesh.edge(own.halfedge(e)))) {
            edge[mesh.edge(own.halfedge(e))] = Some(e);
        }
        let of = |values: &EdgeData<f64>| {
            edge.iter_ids().map(|(e, own)| own.map_or_else(|| FREE * metric.length(e), |own| values[own])).collect()
        };
        let marked = |marks: &EdgeData<bool>| edge.iter().map(|own| own.is_some_and(|own| marks[own])).collect();
        Self {
            lengths: of(&self.lengths),
            cost: of(&self.cost),
            plain: self.plain.as_ref().map(of),
            given: marked(&self.given),
            avoided: marked(&self.avoided),
            has_given: self.has_given,
            straightness: self.straightness.as_ref().map(|(weight, _)| (*weight, Turning::new(mesh, metric))),
        }
    }

    /// The seams of the surface with the cones given: each island that they leave is a disk. O(V log V), O(E log E) where there
    /// are handles.
    ///
    /// # Errors
    /// As [`Seams::new`].
    pub fn cut(&self, mesh: &Mesh, cones: &[VertexId], watch: Watch) -> Result<Seams, SeamError> {
        let mut seams = match self.has_given {
            false => Seams::new(mesh, &self.cost, cones, watch.within(0.0, 0.8))?,
            true => self.cut_islands(mesh, cones, watch.within(0.0, 0.8))?,
        };
        seams.length = mesh.edges().filter(|&e| seams.cut[e]).map(|e| self.lengths[e]).sum();
        if let Some(costs) = self.with_turns(mesh) {
            straighten(&costs, &self.given, &mut seams, watch.within(0.8, 1.0))?;
        }
        Ok(seams)
    }

    /// The edges given and paths between neighbouring cones: what seams may run along besides.
    ///
    /// # Errors
    /// If it is stopped.
    pub(crate) fn network(
        &self,
        mesh: &Mesh,
        cones: &[VertexId],
        cut: EdgeData<bool>,
        watch: Watch,
    ) -> Result<EdgeData<bool>, Interrupted> {
        let fixed = cut.clone();
        let mut network = Seams::network(mesh, &self.cost, &terminals(mesh, cones), cut, watch.within(0.0, 0.6))?;
        if let Some(costs) = self.with_turns(mesh) {
            straighten(&costs, &fixed, &mut network, watch.within(0.6, 1.0))?;
        }
        Ok(network.cut)
    }

    /// A network with shortest paths besides, which may turn and run where they are seen: between neighbouring cones and boundary loops, and between
    /// cones as if there were no boundary, whose region may part them.
    ///
    /// # Errors
    /// If it is stopped.
    pub(crate) fn with_shortest(
        &self,
        mesh: &Mesh,
        cones: &[VertexId],
        network: EdgeData<bool>,
        watch: Watch,
    ) -> Result<EdgeData<bool>, Interrupted> {
        let alone: Vec<(VertexId, u32)> = cones.iter().copied().zip(0..).collect();
        [terminals(mesh, cones), alone].iter().try_fold(network, |network, terminals| {
            Ok(Seams::network(mesh, self.costs(), terminals, network, watch)?.cut)
        })
    }

    /// What edges cost that islands are cut along: their lengths, and those that are to be avoided [`AVOIDED`] times as much.
    pub(crate) fn costs(&self) -> &EdgeData<f64> {
        self.plain.as_ref().unwrap_or(&self.lengths)
    }

    /// The lengths of edges, infinite inside polygons.
    pub(crate) fn lengths(&self) -> &EdgeData<f64> {
        &self.lengths
    }

    /// What a run of seam costs: [`costs`](Self::costs), less where seams are welcome, and its turns.
    pub(crate) fn along(&self, mesh: &Mesh, run: &[HalfedgeId]) -> f64 {
        match self.with_turns(mesh) {
            Some(costs) => costs.along(run),
            None => run.iter().map(|&h| self.cost[mesh.edge(h)]).filter(|cost| cost.is_finite()).sum(),
        }
    }

    /// What paths cost where turns count.
    fn with_turns<'a>(&'a self, mesh: &'a Mesh) -> Option<PathCost<'a>> {
        let (weight, turning) = self.straightness.as_ref()?;
        Some(PathCost { mesh, lengths: &self.lengths, cost: &self.cost, turning, weight: *weight })
    }

    /// The edges that are cut whatever becomes of the islands.
    pub(crate) fn given(&self) -> &EdgeData<bool> {
        &self.given
    }

    /// How many edges are cut that were to be avoided, and one of them.
    pub fn avoided(&self, seams: &Seams) -> Option<(usize, EdgeId)> {
        let mut cut = self.avoided.iter_ids().filter(|&(e, avoided)| *avoided && seams.cut[e]).map(|(e, _)| e);
        let first = cut.next()?;
        Some((1 + cut.count(), first))
    }

    /// Seams through the given edges.
    fn cut_islands(&self, mesh: &Mesh, cones: &[VertexId], watch: Watch) -> Result<Seams, SeamError> {
        let mut is_cone = VertexData::constant(mesh.vertex_count(), false);
        for &cone in cones {
            let known = is_cone.get_mut(cone.index());
            *known.ok_or(SeamError::NoSuchVertex { cone, count: mesh.vertex_count() })? = true;
        }
        let mut cut = self.given.clone();
        for island in open_islands(mesh, &self.given) {
            let whole = |h: HalfedgeId| island.halfedge[h];
            let edge = |e: EdgeId| mesh.edge(whole(island.mesh.halfedge(e)));
            let cost = island.mesh.edges().map(|e| self.cost[edge(e)]).collect();
            let inside = |v: &VertexId| {
                let first = island.mesh.outgoing(*v).next();
                !island.mesh.is_boundary_vertex(*v) && first.is_some_and(|h| is_cone[mesh.tail(whole(h))])
            };
            let cones: Vec<VertexId> = island.mesh.vertices().filter(inside).collect();
            let seams = Seams::new(&island.mesh, &cost, &cones, watch)?;
            island.mesh.edges().filter(|&e| seams.cut[e]).for_each(|e| cut[edge(e)] = true);
        }
        // Chains end, too, where they go on as given edges.
        let is_joint = |v: VertexId| {
            let mut seams = edges_at(mesh, v).filter(|&(e, _)| cut[e]).map(|(e, _)| self.given[e]);
            seams.next().is_some_and(|first| seams.any(|given| given != first))
        };
        let is_end = mesh.vertices().map(|v| is_cone[v] || mesh.is_boundary_vertex(v) || is_joint(v)).collect();
        Ok(Seams::of_cut(mesh, &self.lengths, cut, &is_end))
    }
}

/// The edges that a model's faces have, by their vertices.
pub(crate) struct ModelEdges {
    /// For each whether it is inside the surface, and so can be cut.
    is_inner: HashMap<[u32; 2], bool>,
}

impl ModelEdges {
    /// The edges of all surfaces of a model; `corners` has the vertex of each of its corners.
    pub(crate) fn new<'a>(surfaces: impl Iterator<Item = &'a Surface>, corners: &[u32]) -> Self {
        let mut is_inner = HashMap::new();
        for surface in surfaces {
            for e in surface.mesh.edges().filter(|&e| !surface.diagonal[e]) {
                for name in names(surface, corners, e) {
                    *is_inner.entry(name).or_insert(false) |= !surface.mesh.is_boundary_edge(e);
                }
            }
        }
        Self { is_inner }
    }

    /// Takes edges of a surface for ones that can be cut, as those are along which it was opened: they are seams already.
    pub(crate) fn allow<'a>(&mut self, surface: &Surface, corners: &[u32], opened: impl Iterator<Item = &'a EdgeId>) {
        for name in opened.flat_map(|&e| names(surface, corners, e)) {
            self.is_inner.insert(name, true);
        }
    }

    /// Whether there is such an edge.
    pub(crate) fn has(&self, ends: [u32; 2]) -> bool {
        self.is_inner.contains_key(&ascending(ends))
    }

    /// Whether the surface is open at that edge.
    pub(crate) fn is_open(&self, ends: [u32; 2]) -> bool {
        self.is_inner.get(&ascending(ends)) == Some(&false)
    }
}

/// The inner edges of a surface that are named by vertices of the model; none inside a polygon.
fn marked<'a>(surface: &Surface, corners: &[u32], edges: impl Iterator<Item = &'a [u32; 2]>) -> EdgeData<bool> {
    let mut marked = named_edges(surface, corners, &edges.map(|&ends| ascending(ends)).collect());
    surface.mesh.edges().filter(|&e| surface.mesh.is_boundary_edge(e)).for_each(|e| marked[e] = false);
    marked
}

/// The edges of a surface that are named by vertices of the model in ascending order; none inside a polygon.
pub(crate) fn named_edges(surface: &Surface, corners: &[u32], named: &HashSet<[u32; 2]>) -> EdgeData<bool> {
    let mesh = &surface.mesh;
    if named.is_empty() {
        return EdgeData::constant(mesh.edge_count(), false);
    }
    let is_named = |e: EdgeId| names(surface, corners, e).any(|name| named.contains(&name));
    mesh.edges().map(|e| !surface.diagonal[e] && is_named(e)).collect()
}

/// What an edge is called, by vertices of the model in ascending order: by each side of it, which differ where vertices were welded, and by those that
/// its ends are taken for, as seams are told. `corners` has the vertex of each corner of the model.
pub(crate) fn names(surface: &Surface, corners: &[u32], e: EdgeId) -> impl Iterator<Item = [u32; 2]> {
    let mesh = &surface.mesh;
    let h = mesh.halfedge(e);
    let vertex = |h: HalfedgeId| corners[surface.corner[h] as usize];
    let name = |h: HalfedgeId| ascending([h, mesh.next(h)].map(vertex));
    let welded = ascending([mesh.tail(h), mesh.head(h)].map(|v| surface.vertex[v]));
    [Some(name(h)), mesh.twin(h).map(name), Some(welded)].into_iter().flatten()
}

/// The name of an edge, whichever way it runs.
pub(crate) fn ascending([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
