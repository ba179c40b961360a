//! An intrinsic triangulation that knows where the input's edges cross it, through flips and insertions.
//!
//! Gillespie, Sharp & Crane (2021) keep how often each edge is crossed, integers that are changed exactly, and trace the
//! input's edges at the end. Here each crossing is kept by itself, in its order along the edge, with the input's edge
//! that it belongs to and how far along both it lies: which crossings there are is decided by their order alone, as by
//! integers, so that no rounding can tear the correspondence, and nothing need be traced. A flip costs what the quad's
//! crossings count. Rounding moves a crossing along its edges by some 1e-16 of their lengths, never past another.

use std::borrow::Cow;

use super::SurfacePoint;
use super::cut::{Cell, Chord, Crossing, Cut, Node};
use super::plane::{Point, away_from_sides, crossing, mean_value, minus};
use crate::intrinsic::{Metric, Sides, TOLERANCE, opposite_cosines, other_diagonal};
use crate::mesh::{EdgeData, EdgeId, FaceData, FaceId, HalfedgeId, Id, Triangulation, VertexId};

/// A new vertex stays so far from the input's edges, as a share of its triangle's longest side, if there is room. Circumcentres of right
/// triangles lie on their longest sides: on CAD parts these are edges of the input, and between them and the vertex were triangles without
/// area.
const LEAST_DISTANCE: f64 = 1e-3;

/// How an edge meets the input's edges; seen along the halfedge that names it.
#[derive(Clone, Debug)]
pub(super) enum Trace {
    /// It is a part of one: of this halfedge, which runs its way.
    Along(HalfedgeId),
    /// It crosses these, in order.
    Across(Vec<Crossing>),
}

impl Trace {
    fn crossings(&self) -> &[Crossing] {
        if let Self::Across(crossings) = self { crossings } else { &[] }
    }
}

/// See the module's head.
#[derive(Clone)]
pub(super) struct Overlay<'a> {
    pub(super) input: &'a Triangulation,
    pub(super) triangulation: Triangulation,
    /// The length of each edge.
    pub(super) length: Vec<f64>,
    /// What edges were last [held](Self::hold) of: the input at first.
    pub(super) begun: Cow<'a, Triangulation>,
    /// The halfedge of that which each edge that stays an edge is part of, as its own naming halfedge runs.
    pub(super) held: Vec<Option<HalfedgeId>>,
    pub(super) trace: Vec<Trace>,
    /// How many crossings all edges have.
    pub(super) crossings: usize,
    /// Where each vertex is on the input.
    pub(super) place: Vec<SurfacePoint>,
}

impl<'a> Overlay<'a> {
    /// Edges of the boundary stay edges, and others that are `held`.
    pub(super) fn new(input: &'a Triangulation, metric: &Metric, held: Option<&EdgeData<bool>>) -> Self {
        let is_held = |e: EdgeId| input.is_boundary_edge(e) || held.is_some_and(|held| held[e]);
        Self {
            input,
            begun: Cow::Borrowed(input),
            held: input.edges().map(|e| is_held(e).then(|| input.halfedge(e))).collect(),
            triangulation: input.clone(),
            length: metric.lengths().to_vec(),
            trace: input.edges().map(|e| Trace::Along(input.halfedge(e))).collect(),
            crossings: 0,
            place: input.vertices().map(SurfacePoint::Vertex).collect(),
        }
    }

    pub(super) fn sides(&self, f: FaceId) -> Sides {
        let [a, b, c] = self.triangulation.sides(f).map(|h| self.length[self.triangulation.edge(h).index()]);
        Sides([a, b, c])
    }

    /// A triangle's corners in the plane: the first at the origin, the second to its right.
    pub(super) fn layout(&self, f: FaceId) -> [Point; 3] {
        let [along, _, back] = self.sides(f).unfold();
        [[0.0, 0.0], along, [-back[0], -back[1]]]
    }

    /// What crosses a halfedge, as seen from its triangle.
    fn crossings(&self, h: HalfedgeId) -> Vec<Crossing> {
        let e = self.triangulation.edge(h);
        match &self.trace[e.index()] {
            Trace::Along(_) => Vec::new(),
            Trace::Across(crossings) if self.triangulation.halfedge(e) == h => crossings.clone(),
            Trace::Across(crossings) => crossings.iter().rev().map(|crossing| crossing.reversed(self.input)).collect(),
        }
    }

    /// How many crossings an edge has.
    pub(super) fn crossing_count(&self, e: EdgeId) -> usize {
        self.crossed_at(e).len()
    }

    /// The input's halfedge that a halfedge is part of.
    pub(super) fn shared(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        let e = self.triangulation.edge(h);
        match self.trace[e.index()] {
            Trace::Along(shared) if self.triangulation.halfedge(e) == h => Some(shared),
            Trace::Along(shared) => self.input.twin(shared),
            Trace::Across(_) => None,
        }
    }

    /// The halfedge that a halfedge is part of, of an edge that stays one.
    pub(super) fn held_along(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        let e = self.triangulation.edge(h);
        let held = self.held[e.index()]?;
        if self.triangulation.halfedge(e) == h { Some(held) } else { self.begun.twin(held) }
    }

    /// From now on these edges stay edges, as they are.
    pub(super) fn hold(&mut self, is_held: &[bool]) {
        let t = &self.triangulation;
        self.held = t.edges().map(|e| is_held[e.index()].then(|| t.halfedge(e))).collect();
        self.begun = Cow::Owned(t.clone());
    }

    /// The input's halfedge that each edge is part of, as the halfedge that names it runs; none where it crosses others.
    pub(super) fn along(&self) -> EdgeData<Option<HalfedgeId>> {
        let shared = |trace: &Trace| if let Trace::Along(shared) = trace { Some(*shared) } else { None };
        self.trace.iter().map(shared).collect()
    }

    /// What is across a halfedge; none where it is a side of the boundary or part of an edge that is held.
    pub(super) fn across(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        self.triangulation.twin(h).filter(|_| self.held[self.triangulation.edge(h).index()].is_none())
    }

    /// The places where an edge is crossed.
    pub(super) fn crossed_at(&self, e: EdgeId) -> &[Crossing] {
        self.trace[e.index()].crossings()
    }

    pub(super) fn cut(&self, f: FaceId) -> Cut<'a> {
        Cut::new(self.input, self.triangulation.sides(f).map(|h| self.crossings(h)))
    }

    /// The input's triangle that a cell is part of.
    pub(super) fn home(&self, f: FaceId, cut: &Cut, cell: Cell) -> FaceId {
        let sides = self.triangulation.sides(f);
        let by_side = || sides.into_iter().find_map(|h| self.shared(h)).map(|h| self.input.face(h));
        let by_corner = || sides.into_iter().find_map(|h| self.home_at(h));
        // A triangle that nothing crosses, whose corners are vertices of the input, has sides of the input.
        cut.rim(cell).map(|h| self.input.face(h)).or_else(by_side).or_else(by_corner).unwrap_or(FaceId(0))
    }

    /// The input's triangle that the tail of a halfedge is in, or on the edge of with the triangle of the halfedge; none for a vertex of the input.
    fn home_at(&self, mut h: HalfedgeId) -> Option<FaceId> {
        match self.place[self.triangulation.tail(h).index()] {
            SurfacePoint::Vertex(_) => None,
            SurfacePoint::Face(home, _) => Some(home),
            // Clockwise round the vertex to the edge that it is on.
            SurfacePoint::Edge(..) => loop {
                match self.shared(h) {
                    Some(shared) => break Some(self.input.face(shared)),
                    None => h = self.triangulation.next(self.triangulation.twin(h)?),
                }
            },
        }
    }

    /// Forgets where these edges of the input cross others; nothing can be flipped or put in afterwards. A triangle of the input
    /// that each intrinsic one has a part of, since what is left need not tell.
    pub(super) fn leave_out(&mut self, edges: &EdgeData<bool>) -> FaceData<FaceId> {
        let some_home = |f| self.home(f, &self.cut(f), Cell::Middle(0));
        let home = self.triangulation.faces().map(some_home).collect();
        for trace in &mut self.trace {
            if let Trace::Across(crossings) = trace {
                crossings.retain(|crossing| !edges[self.input.edge(crossing.halfedge)]);
            }
        }
        self.crossings = self.trace.iter().map(|trace| trace.crossings().len()).sum();
        home
    }

    /// Barycentric coordinates of a cell's corner in the input's triangle that it is part of.
    pub(super) fn barycentric(&self, home: FaceId, f: FaceId, cut: &Cut, node: Node) -> [f64; 3] {
        match node {
            Node::Corner(s) => self.place[self.triangulation.corners(f)[s].index()].barycentric(self.input, home),
            Node::Side(s, k) => {
                let Crossing { halfedge, along, .. } = cut.sides[s][k];
                SurfacePoint::Edge(halfedge, along).barycentric(self.input, home)
            }
        }
    }

    /// Flips an edge if it is not Delaunay; whether it was.
    pub(super) fn flip_to_delaunay(&mut self, e: EdgeId) -> bool {
        if !self.triangulation.is_flippable(e) || self.held[e.index()].is_some() {
            return false;
        }
        let quad = self.quad(self.triangulation.halfedge(e));
        let quad = quad.map(|side| self.length[self.triangulation.edge(side).index()]);
        opposite_cosines(self.length[e.index()], quad) < -TOLERANCE && self.flip(e)
    }

    /// Flips an edge between two triangles that are a convex quad together; whether it was, which it is not where rounding forbids it.
    pub(super) fn flip(&mut self, e: EdgeId) -> bool {
        let h = self.triangulation.halfedge(e);
        let quad = self.quad(h).map(|side| self.length[self.triangulation.edge(side).index()]);
        let diagonal = other_diagonal(self.length[e.index()], quad);
        if !(diagonal.is_finite() && diagonal > 0.0) {
            return false;
        }
        let trace = self.flipped(h);
        self.triangulation.flip(h);
        self.length[e.index()] = diagonal;
        self.crossings += trace.crossings().len();
        self.crossings -= self.crossing_count(e);
        // The edge is named by h or by its twin, as before.
        self.trace[e.index()] = trace;
        true
    }

    /// The halfedges jk, ki, il, lj round the edge ij of a halfedge.
    pub(super) fn quad(&self, h: HalfedgeId) -> [HalfedgeId; 4] {
        let t = &self.triangulation;
        let g = t.twin(h).expect("only inner edges are flipped");
        [t.next(h), t.prev(h), t.next(g), t.prev(g)]
    }

    /// What the other diagonal of the quad of `h` meets, along it from below to above. `h` must name its edge.
    fn flipped(&self, h: HalfedgeId) -> Trace {
        let g = self.triangulation.twin(h).expect("only inner edges are flipped");
        let [above, below] = [h, g].map(|h| {
            let [a, b] = [self.triangulation.next(h), self.triangulation.prev(h)];
            Cut::new(self.input, [h, a, b].map(|h| self.crossings(h)))
        });
        let chords = match through(&above, &below, self.shared(g)) {
            Through::Diagonal(shared) => return Trace::Along(shared),
            Through::Chords(chords) => chords,
        };
        let [jk, ki, il, lj] = self.quad(h).map(|side| self.length[self.triangulation.edge(side).index()]);
        let ij = self.length[self.triangulation.edge(h).index()];
        let apex = |sides: [f64; 3]| {
            let [_, _, back] = Sides(sides).unfold();
            [-back[0], -back[1]]
        };
        let (top, bottom) = (apex([ij, jk, ki]), apex([ij, il, lj]));
        let corners = [[[0.0, 0.0], [ij, 0.0], top], [[ij, 0.0], [0.0, 0.0], [ij - bottom[0], -bottom[1]]]];
        let way = [corners[1][2], top];
        let chords = chords.into_iter().map(|chord| {
            let end = |end: QuadEnd| match end {
                QuadEnd::Above(node) => above.position(&corners[0], node),
                QuadEnd::Below(node) => below.position(&corners[1], node),
            };
            (chord.halfedge, chord.along, chord.ends.map(end))
        });
        Trace::Across(crossed(way, chords))
    }

    /// Puts a vertex into a triangle, at positive barycentric coordinates.
    pub(super) fn insert(&mut self, f: FaceId, weights: [f64; 3]) -> VertexId {
        let corners = self.layout(f);
        let p = [0, 1].map(|c| (0..3).map(|s| weights[s] * corners[s][c]).sum());
        let cut = self.cut(f);
        let cell = cut.locate(&corners, p);
        let polygon = cut.polygon(cell);
        let positions: Vec<Point> = polygon.iter().map(|&node| cut.position(&corners, node)).collect();
        let longest = self.sides(f).0.into_iter().fold(0.0, f64::max);
        let p = away_from_sides(&positions, p, LEAST_DISTANCE * longest);
        let traces = [1, 2, 0].map(|s| {
            let chords = cut.chords_between(s, cell);
            Trace::Across(crossed([corners[s], p], chords.into_iter().map(|chord| placed(&cut, &corners, chord))))
        });
        let home = self.home(f, &cut, cell);
        let mut at = [0.0; 3];
        for (weight, &node) in mean_value(&positions, p).into_iter().zip(&polygon) {
            let node = self.barycentric(home, f, &cut, node);
            (0..3).for_each(|c| at[c] += weight * node[c]);
        }
        self.place.push(SurfacePoint::Face(home, at));
        self.length.extend([1, 2, 0].map(|s: usize| {
            let [x, y] = minus(p, corners[s]);
            x.hypot(y)
        }));
        self.crossings += traces.iter().map(|trace| trace.crossings().len()).sum::<usize>();
        self.trace.extend(traces);
        self.held.extend([None; 3]);
        self.triangulation.insert(f)
    }

    /// Puts a vertex on an edge between two different triangles or on the boundary, at a share of its length from the start of `h`, or beside where
    /// an edge of the input crosses it just there.
    pub(super) fn split(&mut self, h: HalfedgeId, share: f64) -> VertexId {
        let t = &self.triangulation;
        let e = t.edge(h);
        let crossings = self.crossings(h);
        let before = crossings.partition_point(|crossing| crossing.at <= share);
        let share = Self::away_from_crossings(&crossings, (before, share));
        let place = match self.shared(h) {
            Some(shared) => {
                let along = |v: VertexId, corner: f64| match self.place[v.index()] {
                    SurfacePoint::Edge(halfedge, along) if halfedge == shared => along,
                    SurfacePoint::Edge(_, along) => 1.0 - along,
                    _ => corner,
                };
                let (from, to) = (along(t.tail(h), 0.0), along(t.head(h), 1.0));
                SurfacePoint::Edge(shared, from + share * (to - from))
            }
            None => self.place_between(h, (before, share)),
        };
        let whole = self.length[e.index()];
        let beside = self.beside(h, (before, share));
        let across = t.twin(h).map(|g| self.beside(g, (crossings.len() - before, 1.0 - share)));
        let held = self.held_along(h);
        let parts = match self.shared(h) {
            Some(shared) => [Trace::Along(shared), Trace::Along(shared)],
            None => {
                let (first, second) = crossings.split_at(before);
                let scaled = |part: &[Crossing], from: f64, by: f64| {
                    let at = |at: f64| ((at - from) / by).clamp(0.0, 1.0);
                    Trace::Across(part.iter().map(|crossing| Crossing { at: at(crossing.at), ..*crossing }).collect())
                };
                [scaled(first, 0.0, share), scaled(second, share, 1.0 - share)]
            }
        };
        self.place.push(place);
        let [first, second] = parts;
        (self.length[e.index()], self.trace[e.index()], self.held[e.index()]) = (share * whole, first, held);
        self.length.push(whole - share * whole);
        self.trace.push(second);
        self.held.push(held);
        for (crossings, length) in [Some(beside), across].into_iter().flatten() {
            self.crossings += crossings.len();
            self.length.push(length);
            self.trace.push(Trace::Across(crossings));
            self.held.push(None);
        }
        self.triangulation.split(h)
    }

    /// A share of an edge between its crossings, so many of them before, not too near to either.
    fn away_from_crossings(crossings: &[Crossing], (before, share): (usize, f64)) -> f64 {
        let at = |k: Option<usize>, end: f64| k.and_then(|k| crossings.get(k)).map_or(end, |crossing| crossing.at);
        let (from, to) = (at(before.checked_sub(1), 0.0), at(Some(before), 1.0));
        let room = LEAST_DISTANCE.min(0.5 * (to - from));
        share.clamp(from + room, to - room)
    }

    /// Where a point of a side is on the input, behind so many of its crossings.
    fn place_between(&self, h: HalfedgeId, (before, share): (usize, f64)) -> SurfacePoint {
        let f = self.triangulation.face(h);
        let cut = self.cut(f);
        let s = h.index() % 3;
        let count = cut.sides[s].len();
        let (from, start) = match before {
            0 => (Node::Corner(s), 0.0),
            _ => (Node::Side(s, before - 1), cut.sides[s][before - 1].at),
        };
        let (to, end) = match before < count {
            true => (Node::Side(s, before), cut.sides[s][before].at),
            false => (Node::Corner((s + 1) % 3), 1.0),
        };
        let home = self.home(f, &cut, cut.cell_beside(s, before));
        let [from, to] = [from, to].map(|node| self.barycentric(home, f, &cut, node));
        let way = ((share - start) / (end - start)).clamp(0.0, 1.0);
        let way = if way.is_nan() { 0.5 } else { way };
        SurfacePoint::Face(home, [0, 1, 2].map(|c| from[c] + way * (to[c] - from[c])))
    }

    /// What an edge crosses from a point on a side, at a share of its length from its start and behind so many of its crossings, to the corner opposite,
    /// and its length.
    fn beside(&self, h: HalfedgeId, (before, share): (usize, f64)) -> (Vec<Crossing>, f64) {
        let t = &self.triangulation;
        let sides = [h, t.next(h), t.prev(h)];
        let lengths = sides.map(|h| self.length[t.edge(h).index()]);
        let [along, _, back] = Sides(lengths).unfold();
        let corners = [[0.0, 0.0], along, [-back[0], -back[1]]];
        let m = [share * lengths[0], 0.0];
        let cut = Cut::new(self.input, sides.map(|h| self.crossings(h)));
        // What the way from the corner crosses, turned round.
        let chords = cut.chords_between(2, cut.cell_beside(0, before)).into_iter().rev();
        let chords = chords.map(|chord| placed(&cut, &corners, chord.reversed_in(self.input)));
        let crossings = crossed([m, corners[2]], chords);
        let up = minus(corners[2], m);
        (crossings, up[0].hypot(up[1]))
    }
}

/// A chord with its ends in the plane.
fn placed(cut: &Cut, corners: &[Point; 3], chord: Chord) -> (HalfedgeId, [f64; 2], [Point; 2]) {
    (chord.halfedge, chord.along, chord.ends.map(|node| cut.position(corners, node)))
}

/// Where chords, in this order, cross a way through the plane.
fn crossed(way: [Point; 2], chords: impl Iterator<Item = (HalfedgeId, [f64; 2], [Point; 2])>) -> Vec<Crossing> {
    let mut last = 0.0_f64;
    let place = |(halfedge, [from, to], ends): (HalfedgeId, [f64; 2], [Point; 2])| {
        let [at, share] = crossing(way, ends);
        last = last.max(at);
        Crossing { halfedge, along: from + share * (to - from), at: last }
    };
    chords.map(place).collect()
}

/// An end of a chord of a quad, in one of its triangles.
#[derive(Clone, Copy, Debug)]
enum QuadEnd {
    Above(Node),
    Below(Node),
}

/// A chord of a quad.
struct QuadChord {
    halfedge: HalfedgeId,
    along: [f64; 2],
    ends: [QuadEnd; 2],
}

/// What crosses a quad from one side of the line lk to the other.
enum Through {
    /// An input edge runs along that line, this halfedge from l to k.
    Diagonal(HalfedgeId),
    /// Chords from right to left, in order from l to k.
    Chords(Vec<QuadChord>),
}

/// What crosses the other diagonal of a quad, whose triangles are (i, j, k) above and (j, i, l) below; `diagonal` is the input's
/// halfedge that ji is part of.
fn through(above: &Cut, below: &Cut, diagonal: Option<HalfedgeId>) -> Through {
    let crossed = above.sides[0].len();
    // By the side of ij where they are: round i to the left, round j to the right, between them to the apex.
    let (up_left, up_right) = (above.arcs[0], crossed - above.arcs[1]);
    let (down_left, down_right) = (below.arcs[1], crossed - below.arcs[0]);
    let to_both = up_left.max(down_left)..up_right.min(down_right);
    if let Some(p) = { to_both }.next() {
        return Through::Diagonal(above.sides[0][p].halfedge);
    }
    let of = |chord: Chord, end: fn(Node) -> QuadEnd| QuadChord {
        halfedge: chord.halfedge,
        along: chord.along,
        ends: chord.ends.map(end),
    };
    let mut chords = Vec::new();
    // Round l, which lies to their left: turned, they run from the right, lj, to the left, il.
    let round_below = (0..below.arcs[2]).map(|m| below.arc(2, m));
    chords.extend(round_below.map(|arc| of(arc, QuadEnd::Below)));
    match below.fan {
        // From i, the second corner below, to lj, its third side.
        Some((1, count)) => chords.extend((0..count).map(|m| of(below.spoke(1, m), QuadEnd::Below))),
        // From j to il.
        Some((0, count)) => {
            let spokes = (0..count).rev().map(|m| below.spoke(0, m).reversed_in(below.input));
            chords.extend(spokes.map(|spoke| of(spoke, QuadEnd::Below)));
        }
        _ => {}
    }
    // Through ij: from lj to ki, and from jk to il.
    chords.extend((down_right..up_left).map(|p| {
        // Below, the crossing is the (crossed - 1 - p)-th of the side ji, round j.
        let m = crossed - 1 - p;
        let down = below.before(0, m);
        let up = above.before(0, p);
        chord_of(below, QuadEnd::Below(down), down, above, QuadEnd::Above(up), up)
    }));
    chords.extend((up_right..down_left).rev().map(|p| {
        let up = Node::Side(1, crossed - 1 - p);
        let down = Node::Side(1, p);
        chord_of(above, QuadEnd::Above(up), up, below, QuadEnd::Below(down), down)
    }));
    chords.extend(diagonal.map(|halfedge| QuadChord {
        halfedge,
        along: [0.0, 1.0],
        ends: [1, 0].map(|s| QuadEnd::Above(Node::Corner(s))),
    }));
    match above.fan {
        // From i to jk.
        Some((0, count)) => chords.extend((0..count).map(|m| of(above.spoke(0, m), QuadEnd::Above))),
        // From j to ki.
        Some((1, count)) => {
            let spokes = (0..count).rev().map(|m| above.spoke(1, m).reversed_in(above.input));
            chords.extend(spokes.map(|spoke| of(spoke, QuadEnd::Above)));
        }
        _ => {}
    }
    let round_above = (0..above.arcs[2]).rev().map(|m| above.arc(2, m).reversed_in(above.input));
    chords.extend(round_above.map(|arc| of(arc, QuadEnd::Above)));
    Through::Chords(chords)
}

/// The chord from a crossing of one triangle of a quad to one of the other.
fn chord_of(first: &Cut, from: QuadEnd, enters: Node, second: &Cut, to: QuadEnd, leaves: Node) -> QuadChord {
    let at = |cut: &Cut, node: Node| match node {
        Node::Side(s, k) => cut.sides[s][k],
        Node::Corner(_) => unreachable!("it crosses a side"),
    };
    let (enters, leaves) = (at(first, enters), at(second, leaves));
    QuadChord { halfedge: enters.halfedge, along: [enters.along, 1.0 - leaves.along], ends: [from, to] }
}
