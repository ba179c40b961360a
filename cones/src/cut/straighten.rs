//! Chains of seams made straight.
//!
//! A shortest path along edges zigzags wherever the way it should go is no direction that edges have, and of many paths of about one length
//! it is any. So each chain is sought anew between its ends, by what its edges cost and, in addition, by how much it turns
//! ([`Turning`]): Dijkstra's algorithm on *halfedges*, since what a step costs depends on the one before.
//!
//! The surface stays a disk: opened along all other seams it is a ring, or a disk with a hole at the chain's loose end, and
//! the chain joins two loops of its boundary. A simple path joins the same two if it leaves and arrives between the same
//! neighbouring seams, and on its way touches neither seam nor boundary. What is sought in is a band round the chain, and what a way on
//! costs at least is known from what edges alone cost to its end (A*; Hart, Nilsson & Raphael 1968): vertices are a sixth of halfedges.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use geom::{EdgeData, HalfedgeData, HalfedgeId, Interrupted, Mesh, VertexData, VertexId, Watch};

use super::turning::Turning;
use crate::flatten::{Chain, Seams};

/// What a turn by a radian costs at full weight, as a share of the mean length of the two edges that it is between. On part,
/// terrain, sphere, hare, bunny and fandisk with 8 and 32 cones and half the weight seams turn 0.78 times as much for their length and
/// are 0.4 % longer with 1/2, 0.72 and 0.9 % with 2, 0.70 and 1.4 % with 4.
const TURN: f64 = 2.0;
/// The band's half width as a share of the chain's length (with 0.35 instead seams turn 0.71 times as much and are 1.3 % longer),
const BAND: f64 = 0.2;
/// but at least so many mean edges of the chain.
const LEAST_BAND: f64 = 4.0;
/// Chains of more edges are straightened piece by piece, since bands grow with the square of what is in them.
const LONGEST: usize = 256;
/// A closed chain is straightened in so many pieces.
const ROUND: usize = 3;

/// What paths cost.
pub(crate) struct PathCost<'a> {
    pub(crate) mesh: &'a Mesh,
    /// The length of each edge; infinite where no seam may run.
    pub(crate) lengths: &'a EdgeData<f64>,
    /// What each edge costs.
    pub(crate) cost: &'a EdgeData<f64>,
    pub(crate) turning: &'a Turning,
    /// From 0 to 1.
    pub(crate) weight: f64,
}

impl PathCost<'_> {
    /// What going on along `g` costs after `h`.
    fn turn(&self, h: HalfedgeId, g: HalfedgeId) -> f64 {
        let [before, after] = [h, g].map(|h| self.lengths[self.mesh.edge(h)]);
        0.5 * self.weight * TURN * (before + after) * self.turning.between(self.mesh, h, g)
    }

    fn edge(&self, h: HalfedgeId) -> f64 {
        self.cost[self.mesh.edge(h)]
    }

    /// What a path costs between what comes before it and after it.
    fn path(&self, piece: &Piece) -> f64 {
        let all: Vec<HalfedgeId> = piece.before.iter().chain(&piece.path).chain(&piece.after).copied().collect();
        piece.path.iter().map(|&h| self.edge(h)).sum::<f64>() + self.turns(&all)
    }

    /// What a path costs by itself.
    pub(crate) fn along(&self, path: &[HalfedgeId]) -> f64 {
        path.iter().map(|&h| self.edge(h)).filter(|cost| cost.is_finite()).sum::<f64>() + self.turns(path)
    }

    fn turns(&self, path: &[HalfedgeId]) -> f64 {
        path.windows(2).map(|step| self.turn(step[0], step[1])).sum()
    }
}

/// A piece of a chain, as halfedges in order.
struct Piece {
    before: Option<HalfedgeId>,
    path: Vec<HalfedgeId>,
    after: Option<HalfedgeId>,
}

/// Straightens all chains but those with edges that are `fixed`, in place. Seams stay seams of a disk (of disks, where fixed
/// edges separate).
///
/// # Errors
/// If the watch has said stop; seams are such as well then.
pub(crate) fn straighten(
    costs: &PathCost,
    fixed: &EdgeData<bool>,
    seams: &mut Seams,
    watch: Watch,
) -> Result<(), Interrupted> {
    let mut straightener = Straightener::new(costs, seams);
    let count = seams.chains.len();
    for (k, chain) in seams.chains.iter_mut().enumerate() {
        watch.ask(k as f64 / count as f64)?;
        if !chain.edges.iter().any(|&e| fixed[e]) {
            straightener.straighten(chain);
        }
    }
    seams.cut = straightener.cut;
    seams.length = costs.mesh.edges().filter(|&e| seams.cut[e]).map(|e| costs.lengths[e]).sum();
    Ok(())
}

struct Straightener<'a> {
    costs: &'a PathCost<'a>,
    cut: EdgeData<bool>,
    /// How many cut edges are at each vertex.
    seams_at: VertexData<u32>,
    /// The halfedges that a search has reached,
    reached: Vec<Reached>,
    /// and how many were when each was; 0 where it is not. What is searched is a small part, and memory of zeros is none until it is written.
    place: HalfedgeData<u32>,
    in_band: VertexData<bool>,
    /// From the path, then what edges alone cost to its end; infinite outside of the band.
    distance: VertexData<f64>,
}

/// A halfedge that a search has come along.
struct Reached {
    halfedge: HalfedgeId,
    /// What it costs to its end.
    cost: f64,
    /// The one before.
    from: Option<HalfedgeId>,
}

impl<'a> Straightener<'a> {
    fn new(costs: &'a PathCost, seams: &Seams) -> Self {
        let mesh = costs.mesh;
        let mut seams_at = VertexData::constant(mesh.vertex_count(), 0);
        for v in mesh.edges().filter(|&e| seams.cut[e]).flat_map(|e| mesh.ends(e)) {
            seams_at[v] += 1;
        }
        Self {
            costs,
            cut: seams.cut.clone(),
            seams_at,
            reached: Vec::new(),
            place: HalfedgeData::constant(mesh.halfedge_count(), 0),
            in_band: VertexData::constant(mesh.vertex_count(), false),
            distance: VertexData::constant(mesh.vertex_count(), f64::INFINITY),
        }
    }

    fn straighten(&mut self, chain: &mut Chain) {
        let mesh = self.costs.mesh;
        let mut path = chain.halfedges(mesh);
        let is_closed = chain.vertices.first() == chain.vertices.last();
        let pieces = (path.len().div_ceil(LONGEST)).max(if is_closed { ROUND } else { 1 });
        self.in_pieces(&mut path, pieces, 0);
        if pieces > 1 {
            self.in_pieces(&mut path, pieces, 1); // where pieces met before
        }
        chain.edges = path.iter().map(|&h| mesh.edge(h)).collect();
        chain.vertices.truncate(1);
        chain.vertices.extend(path.iter().map(|&h| mesh.head(h)));
    }

    /// Straightens so many pieces of a path, which begin by half a piece later where `shift` is 1.
    fn in_pieces(&mut self, path: &mut Vec<HalfedgeId>, pieces: usize, shift: usize) {
        let ends: Vec<usize> = (0..=pieces).map(|k| (2 * k + shift) * path.len() / (2 * pieces)).collect();
        let mut done: Vec<HalfedgeId> = path[..ends[0]].to_vec();
        for piece in ends.windows(2) {
            let [from, to] = [piece[0], piece[1].min(path.len())];
            let (before, after) = (done.last().copied(), path.get(to).copied());
            let mut piece = Piece { before, path: path[from..to].to_vec(), after };
            self.replace(&mut piece);
            done.extend(piece.path);
        }
        *path = done;
    }

    /// Replaces a piece by a path that costs less, if there is one.
    fn replace(&mut self, piece: &mut Piece) {
        let mesh = self.costs.mesh;
        if piece.path.len() < 2 || mesh.tail(piece.path[0]) == mesh.head(piece.path[piece.path.len() - 1]) {
            return;
        }
        self.mark(&piece.path, false);
        let most = self.costs.path(piece);
        if let Some(path) = self.cheapest(piece, most) {
            let found = Piece { path, ..*piece };
            if self.costs.path(&found) < most {
                piece.path = found.path;
            }
        }
        self.mark(&piece.path, true);
    }

    /// Marks the edges of a path as cut or not.
    fn mark(&mut self, path: &[HalfedgeId], is_cut: bool) {
        for &h in path {
            self.cut[self.costs.mesh.edge(h)] = is_cut;
            for v in [self.costs.mesh.tail(h), self.costs.mesh.head(h)] {
                self.seams_at[v] = if is_cut { self.seams_at[v] + 1 } else { self.seams_at[v] - 1 };
            }
        }
    }

    /// The cheapest path between the ends of a piece that is not marked as cut now, if it costs no more than `most`; none if it would meet
    /// itself.
    fn cheapest(&mut self, piece: &Piece, most: f64) -> Option<Vec<HalfedgeId>> {
        let mesh = self.costs.mesh;
        let (first, last) = (piece.path[0], piece.path[piece.path.len() - 1]);
        let [start, end] = [mesh.tail(first), mesh.head(last)];
        let arrivals: Vec<HalfedgeId> =
            self.sector(mesh.twin(last)?).into_iter().filter_map(|h| mesh.twin(h)).collect();
        let band = self.band(&piece.path, [start, end]);
        let departures: Vec<HalfedgeId> = self.sector(first);
        self.measure_to_end(&arrivals);
        let last = self.search((piece, most), &departures, &arrivals);
        let mut path = Vec::new();
        let mut at = last;
        while let Some(h) = at {
            path.push(h);
            at = self.reached(h).and_then(|reached| reached.from);
        }
        path.reverse();
        for v in band {
            self.in_band[v] = false;
            self.distance[v] = f64::INFINITY;
        }
        for reached in self.reached.drain(..) {
            self.place[reached.halfedge] = 0;
        }
        let mut heads: Vec<VertexId> = path.iter().map(|&h| mesh.head(h)).collect();
        heads.sort_unstable();
        let is_simple = heads.windows(2).all(|pair| pair[0] != pair[1]);
        Some(path).filter(|path| is_simple && !path.is_empty())
    }

    /// What edges alone cost from each vertex of the band to the end.
    fn measure_to_end(&mut self, arrivals: &[HalfedgeId]) {
        let costs = self.costs;
        let last = arrivals.iter().map(|&h| (costs.mesh.tail(h), costs.edge(h)));
        let last = last.filter(|&(v, _)| self.in_band[v]).collect();
        self.spread(last, costs.cost, |this, v, _| this.in_band[v]);
    }

    /// Dijkstra's algorithm from vertices at some distances over those that may be reached at theirs; lists all of them.
    fn spread(
        &mut self,
        mut next: Vec<(VertexId, f64)>,
        lengths: &EdgeData<f64>,
        may_reach: impl Fn(&Self, VertexId, f64) -> bool,
    ) -> Vec<VertexId> {
        let mesh = self.costs.mesh;
        let (mut queue, mut reached) = (BinaryHeap::new(), Vec::new());
        loop {
            for (v, distance) in next.drain(..) {
                if distance < self.distance[v] {
                    if self.distance[v].is_infinite() {
                        reached.push(v);
                    }
                    self.distance[v] = distance;
                    queue.push(Reverse((distance.to_bits(), v)));
                }
            }
            let Some(Reverse((bits, v))) = queue.pop() else { return reached };
            let to_here = f64::from_bits(bits);
            if to_here == self.distance[v] {
                let on = mesh.outgoing(v).map(|h| (mesh.head(h), to_here + lengths[mesh.edge(h)]));
                next.extend(on.filter(|&(w, along)| may_reach(self, w, along)));
            }
        }
    }

    /// A shortest path over halfedges within the band, of those that cost no more than `most`; the halfedge by which the end is reached.
    fn search(
        &mut self,
        (piece, most): (&Piece, f64),
        departures: &[HalfedgeId],
        arrivals: &[HalfedgeId],
    ) -> Option<HalfedgeId> {
        let mesh = self.costs.mesh;
        let mut queue = BinaryHeap::new();
        let leave = |h: HalfedgeId| piece.before.map_or(0.0, |before| self.costs.turn(before, h));
        let arrive = |h: HalfedgeId| piece.after.map_or(0.0, |after| self.costs.turn(h, after));
        let mut next: Vec<_> = departures.iter().map(|&h| (None, h, self.costs.edge(h) + leave(h))).collect();
        let mut best: Option<(f64, HalfedgeId)> = None;
        loop {
            for (from, h, cost) in next.drain(..) {
                let is_arrival = arrivals.contains(&h);
                let at_least = cost + if is_arrival { 0.0 } else { self.distance[mesh.head(h)] };
                if at_least <= most && cost < self.cost_to(h) {
                    self.reach(Reached { halfedge: h, cost, from });
                    if !is_arrival {
                        queue.push(Reverse((at_least.to_bits(), h)));
                    } else if best.is_none_or(|(least, _)| cost + arrive(h) < least) {
                        best = Some((cost + arrive(h), h));
                    }
                }
            }
            let Some(Reverse((bits, h))) = queue.pop() else { break };
            let at_least = f64::from_bits(bits);
            if best.is_some_and(|(least, _)| least <= at_least) || at_least.is_infinite() {
                break;
            }
            let cost = self.cost_to(h);
            if at_least == cost + self.distance[mesh.head(h)] {
                let on = mesh.outgoing(mesh.head(h)).filter(|&g| Some(g) != mesh.twin(h));
                let on = on.map(|g| (g, cost + self.costs.edge(g))).filter(|&(g, cost)| cost < self.cost_to(g));
                next.extend(on.map(|(g, cost)| (Some(h), g, cost + self.costs.turn(h, g))));
            }
        }
        best.map(|(_, h)| h)
    }

    /// How a halfedge was reached, if it was.
    fn reached(&self, h: HalfedgeId) -> Option<&Reached> {
        Some(&self.reached[self.place[h].checked_sub(1)? as usize])
    }

    /// What it costs to the end of a halfedge; infinite where that was not reached.
    fn cost_to(&self, h: HalfedgeId) -> f64 {
        self.reached(h).map_or(f64::INFINITY, |reached| reached.cost)
    }

    /// Reaches a halfedge, or in a better way.
    fn reach(&mut self, reached: Reached) {
        let place = &mut self.place[reached.halfedge];
        match place.checked_sub(1) {
            Some(known) => self.reached[known as usize] = reached,
            None => {
                self.reached.push(reached);
                *place = self.reached.len() as u32;
            }
        }
    }

    /// The halfedges at a vertex between the same two neighbouring seams as one of them.
    fn sector(&self, h: HalfedgeId) -> Vec<HalfedgeId> {
        let mesh = self.costs.mesh;
        let mut around: Vec<HalfedgeId> = mesh.outgoing(mesh.tail(h)).collect();
        let place = around.iter().position(|&g| g == h).expect("it starts there");
        let is_wall = |&g: &HalfedgeId| self.cut[mesh.edge(g)] || mesh.twin(g).is_none();
        if mesh.is_boundary_vertex(mesh.tail(h)) {
            let from = around[..place].iter().rposition(is_wall).map_or(0, |k| k + 1);
            let to = around[place..].iter().position(is_wall).map_or(around.len(), |k| place + k);
            return around[from..to].to_vec();
        }
        around.rotate_left(place);
        let to = around.iter().position(is_wall).unwrap_or(around.len());
        let from = around.iter().rposition(is_wall).map_or(to, |k| k + 1);
        around[from..].iter().chain(&around[..to]).copied().collect()
    }

    /// Marks the vertices of the band round a path that it may go through.
    fn band(&mut self, path: &[HalfedgeId], ends: [VertexId; 2]) -> Vec<VertexId> {
        let PathCost { mesh, lengths, .. } = *self.costs;
        let length: f64 = path.iter().map(|&h| lengths[mesh.edge(h)]).sum();
        let width = (BAND * length).max(LEAST_BAND * length / path.len() as f64);
        let inside = path[1..].iter().map(|&h| (mesh.tail(h), 0.0)).collect();
        let band = self.spread(inside, lengths, |this, v, along| {
            along <= width && this.seams_at[v] == 0 && !mesh.is_boundary_vertex(v) && !ends.contains(&v)
        });
        for &v in &band {
            self.distance[v] = f64::INFINITY;
            self.in_band[v] = true;
        }
        band
    }
}

#[cfg(test)]
mod tests {
    use geom::{Metric, VertexId, shapes};

    use super::*;

    /// The least cost of paths between the ends of a piece within its band, by relaxing every step until nothing changes.
    fn least(straightener: &mut Straightener, piece: &Piece) -> f64 {
        let costs = straightener.costs;
        let mesh = costs.mesh;
        let (first, last) = (piece.path[0], piece.path[piece.path.len() - 1]);
        let arrivals = straightener.sector(mesh.twin(last).unwrap());
        let is_arrival = |h: HalfedgeId| mesh.twin(h).is_some_and(|twin| arrivals.contains(&twin));
        let departures = straightener.sector(first);
        let band = straightener.band(&piece.path, [mesh.tail(first), mesh.head(last)]);
        let mut reached = HalfedgeData::constant(mesh.halfedge_count(), f64::INFINITY);
        let may_run = |h: HalfedgeId| is_arrival(h) || straightener.in_band[mesh.head(h)];
        departures.into_iter().filter(|&h| may_run(h)).for_each(|h| reached[h] = costs.edge(h));
        let mut has_changed = true;
        while has_changed {
            has_changed = false;
            for h in mesh.halfedges().filter(|&h| !is_arrival(h)) {
                for g in mesh.outgoing(mesh.head(h)).filter(|&g| Some(g) != mesh.twin(h) && may_run(g)) {
                    let cost = reached[h] + costs.edge(g) + costs.turn(h, g);
                    if cost < reached[g] {
                        (reached[g], has_changed) = (cost, true);
                    }
                }
            }
        }
        for v in band {
            (straightener.in_band[v], straightener.distance[v]) = (false, f64::INFINITY);
        }
        mesh.halfedges().filter(|&h| is_arrival(h)).map(|h| reached[h]).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn no_path_within_the_band_costs_less() {
        let mut compared = 0;
        for (shape, count) in [(shapes::hare(900), 6), (shapes::torus(2, 800), 9), (shapes::terrain(900, 2), 5)] {
            let mesh = shape.mesh();
            let metric = Metric::from_points(&mesh, &shape.points);
            let (lengths, turning) = (metric.lengths(), Turning::new(&mesh, &metric));
            let cones: Vec<VertexId> = (0..count).map(|k| VertexId(7 + 83 * k)).collect();
            let seams = Seams::new(&mesh, lengths, &cones, Watch::NONE).unwrap();
            for weight in [0.1, 1.0] {
                let costs = PathCost { mesh: &mesh, lengths, cost: lengths, turning: &turning, weight };
                let mut straightener = Straightener::new(&costs, &seams);
                for chain in &seams.chains {
                    let piece = Piece { before: None, path: chain.halfedges(&mesh), after: None };
                    if piece.path.len() < 2 || chain.vertices.first() == chain.vertices.last() {
                        continue;
                    }
                    straightener.mark(&piece.path, false);
                    let most = costs.path(&piece);
                    let expected = least(&mut straightener, &piece);
                    for most in [f64::INFINITY, most * (1.0 + 1e-12)] {
                        if let Some(path) = straightener.cheapest(&piece, most) {
                            let found = costs.path(&Piece { path, ..piece });
                            assert!((found - expected).abs() <= 1e-12 * expected, "{found} {expected}");
                            compared += 1;
                        }
                    }
                    let cleared = |v: VertexId| !straightener.in_band[v] && straightener.distance[v].is_infinite();
                    assert!(mesh.vertices().all(cleared) && straightener.place.iter().all(|&place| place == 0));
                    straightener.mark(&piece.path, true);
                }
            }
        }
        assert!(compared > 40, "{compared}");
    }
}
