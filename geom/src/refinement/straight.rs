//! Paths of edges made straight by flipping edges of the intrinsic triangulation, so that they are geodesics (Sharp & Crane 2020, *You can find
//! geodesic paths in triangle meshes by just flipping edges*).
//!
//! Where a path turns by less than π on one side, the edges between on that side are flipped until its outer rim turns no more; the rim is shorter, and
//! becomes the path. Paths keep their ends, and none comes to touch another one, itself or the boundary.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::f64::consts::PI;

use super::overlay::Overlay;
use crate::intrinsic::{Metric, Sides};
use crate::mesh::{EdgeId, FaceId, HalfedgeId, Id, Triangulation, VertexId};
use crate::watch::{Interrupted, Watch};

/// Angles this near to π are straight.
const STRAIGHT: f64 = 1e-6;
/// A path that leaves another one at a narrower angle than this begins farther along that: 30°.
const NARROW_SECTOR: f64 = PI / 6.0;
/// One that leaves another one at a narrower angle than this stays as it was: 3°.
const LEAST_SECTOR: f64 = PI / 60.0;
/// So many times at most, of all paths.
const MOST_SLIDES: usize = 1000;
/// So many edges at most are flipped at one turn.
const MOST_FLIPS: usize = 4096;
/// A rim that is no shorter than by this share is none that rounding could not have found.
const SHORTER: f64 = 1e-12;
/// So many times each edge of a path may be replaced, on average: each time it becomes shorter, but who knows how often.
const MOST_TURNS: usize = 256;

/// Vertices nearer to a path than this share of the mean length of their edges are taken away.
const NEAR: f64 = 0.5;
/// Those of the input stay; a path goes through one that is nearer than this share of that, so that no tiny triangles have to lie between,
const NEARLY_ON: f64 = 0.25;
/// if the path turns by no more than this there on either side, in radians.
const LEAST_TURN: f64 = 0.05;

/// A path that is made straight: a geodesic between its ends, or as near to that as comes without touching another one, itself or the boundary. One of one
/// edge stays where it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StraightPath {
    /// Its edges, one after the other, in the triangulation that the same refinement gives without any paths. None of the vertices between them is to be on an
    /// edge that is held.
    pub halfedges: Vec<HalfedgeId>,
    /// Whether it may end farther along another one instead, where it leaves that at less than 30° and a third one, or more, ends at the same place.
    pub may_slide: bool,
}

impl StraightPath {
    /// Whether it is one way along edges of a triangulation.
    pub(super) fn runs_through(&self, t: &Triangulation) -> bool {
        let is_there = |h: &HalfedgeId| h.index() < t.halfedge_count();
        let goes_on = |pair: &[HalfedgeId]| t.head(pair[0]) == t.tail(pair[1]);
        self.halfedges.iter().all(is_there) && self.halfedges.windows(2).all(goes_on)
    }
}

/// Paths that are made straight.
pub(super) struct Straight<'a, 'b> {
    overlay: &'a mut Overlay<'b>,
    /// The path that each edge is part of.
    pub(super) path_of: Vec<Option<u32>>,
    /// The vertices of each, with the edge to it from the one before.
    ways: Vec<Vec<(VertexId, EdgeId)>>,
    /// Whether a vertex is on a path, or on what stays an edge.
    is_taken: Vec<bool>,
    /// Whether another path ends at a vertex of a path.
    is_joint: Vec<bool>,
    may_slide: Vec<bool>,
    /// Whether a path stays as it is.
    stays: Vec<bool>,
}

impl<'a, 'b> Straight<'a, 'b> {
    /// Paths whose ends are to be no vertices inside others.
    pub(super) fn new(overlay: &'a mut Overlay<'b>, paths: &[StraightPath], stays: &[bool]) -> Self {
        let t = &overlay.triangulation;
        let way = |path: &StraightPath| {
            let path = &path.halfedges;
            let first = path.first().map(|&h| (t.tail(h), t.edge(h)));
            first.into_iter().chain(path.iter().map(|&h| (t.head(h), t.edge(h)))).collect()
        };
        let ways = paths.iter().map(way).collect();
        let mut path_of = vec![None; t.edge_count()];
        for (number, path) in (0..).zip(paths) {
            path.halfedges.iter().for_each(|&h| path_of[t.edge(h).index()] = Some(number));
        }
        let is_taken = overlay.are_ends(|e| path_of[e.index()].is_some() || overlay.held[e.index()].is_some());
        let is_joint = vec![false; t.vertex_count()];
        let may_slide = paths.iter().map(|path| path.may_slide).collect();
        Self { overlay, path_of, ways, is_taken, is_joint, may_slide, stays: stays.to_vec() }
    }

    /// Makes them straight. Those of one edge stay as they are.
    ///
    /// # Errors
    /// If it is stopped.
    pub(super) fn straighten(&mut self, watch: Watch) -> Result<(), Interrupted> {
        let count = self.ways.len() as u32;
        let are_turned = |number: &u32| !self.stays[*number as usize] && self.ways[*number as usize].len() > 2;
        let turned_ones: Vec<u32> = (0..count).filter(are_turned).collect();
        for &number in &turned_ones {
            watch.ask(f64::from(number) / f64::from(count))?;
            self.path(number);
        }
        let mut slides_left = MOST_SLIDES;
        for number in turned_ones.into_iter().filter(|&number| self.may_slide[number as usize]).collect::<Vec<_>>() {
            watch.ask(1.0)?;
            for _ in 0..2 {
                while slides_left > 0 && self.slide(number) {
                    slides_left -= 1;
                    self.path(number);
                }
                self.ways[number as usize] = turned(&self.ways[number as usize]);
            }
        }
        Ok(())
    }

    fn path(&mut self, number: u32) {
        let mut way = std::mem::take(&mut self.ways[number as usize]);
        let mut turns_left = MOST_TURNS * way.len();
        let mut k = 1;
        while k + 1 < way.len() && turns_left > 0 {
            let [(a, _), (b, before), (c, after)] = [way[k - 1], way[k], way[k + 1]];
            let rim = if self.is_joint[b.index()] { None } else { self.rim((a, b, c), [before, after]) };
            match rim {
                Some(rim) => {
                    turns_left -= 1;
                    self.is_taken[b.index()] = false;
                    [before, after].iter().for_each(|e| self.path_of[e.index()] = None);
                    for &(v, e) in &rim {
                        self.path_of[e.index()] = Some(number);
                        self.is_taken[v.index()] = true;
                    }
                    way.splice(k..k + 2, rim);
                    k = k.saturating_sub(1).max(1);
                }
                None => k += 1,
            }
        }
        self.ways[number as usize] = way;
    }

    /// The paths that were made straight and leave another one, or what stays an edge, at so narrow an angle that no even triangles fit between.
    pub(super) fn too_narrow(&self, paths: &[StraightPath]) -> Vec<usize> {
        let is_narrow = |way: &[(VertexId, EdgeId)]| {
            let out = self.overlay.leaving(way[0].0, way[1].1);
            let sectors = [true, false].map(|is_left| self.next_held(out?, is_left));
            sectors.into_iter().flatten().any(|(angle, _)| angle < LEAST_SECTOR)
        };
        let is_too_narrow = |&number: &usize| {
            let way = &self.ways[number];
            let is_straightened = !self.stays[number] && paths[number].halfedges.len() > 1;
            is_straightened && (is_narrow(way) || is_narrow(&turned(way)))
        };
        (0..paths.len()).filter(is_too_narrow).collect()
    }

    /// Lets a path begin farther along another one, or what stays an edge, where it leaves that at a narrow angle; whether it does.
    fn slide(&mut self, number: u32) -> bool {
        let way = &self.ways[number as usize];
        let ((a, _), (x, e)) = (way[0], way[1]);
        let t = &self.overlay.triangulation;
        let Some(out) = self.overlay.leaving(a, e).filter(|_| a != x) else { return false };
        let [left, right] = [self.next_held(out, true), self.next_held(out, false)];
        // Else the vertex is the end of the other one, too, and would be left behind.
        let is_left_to_others = match (&left, &right) {
            (Some((_, one)), Some((_, other))) => t.edge(*one) != t.edge(*other),
            _ => false,
        };
        let nearest = [(left, true), (right, false)].into_iter().filter_map(|(next, is_left)| Some((next?, is_left)));
        let nearest = nearest.min_by(|((one, _), _), ((other, _), _)| one.total_cmp(other));
        let Some(((angle, spoke), is_left)) = nearest.filter(|_| is_left_to_others) else { return false };
        let (b, along) = (t.head(spoke), t.edge(spoke));
        if angle >= NARROW_SECTOR || b == x || b == a {
            return false;
        }
        let (first, last) = if is_left { (e, along) } else { (along, e) };
        self.flip_between(a, first, last);
        let is_shorter = |rim: &Vec<(VertexId, EdgeId)>| {
            let length = |e: EdgeId| self.overlay.length[e.index()];
            rim.iter().map(|&(_, e)| length(e)).sum::<f64>() < (1.0 - SHORTER) * length(e)
        };
        let Some(rim) = self.rim_of(a, first, last, is_left).filter(is_shorter) else { return false };
        self.path_of[e.index()] = None;
        for &(v, e) in &rim {
            self.path_of[e.index()] = Some(number);
            self.is_taken[v.index()] = true;
        }
        self.is_joint[b.index()] = true;
        let way = &mut self.ways[number as usize];
        way[0] = (b, rim[0].1);
        way.splice(1..2, rim);
        true
    }

    /// The next halfedge with the same tail whose edge stays, counter-clockwise or clockwise, and how far round it is; none beyond the boundary.
    fn next_held(&self, from: HalfedgeId, is_left: bool) -> Option<(f64, HalfedgeId)> {
        let t = &self.overlay.triangulation;
        let (mut h, mut angle) = (from, 0.0);
        loop {
            if is_left {
                angle += self.overlay.angle(h);
                h = t.twin(t.prev(h))?;
            } else {
                h = t.next(t.twin(h)?);
                angle += self.overlay.angle(h);
            }
            if h == from {
                return None;
            }
            if !self.is_free(t.edge(h)) {
                return Some((angle, h));
            }
        }
    }

    /// A shorter way from a to c than through b, by the vertices after a and the edges to them, if there is one that touches nothing.
    fn rim(
        &mut self,
        (a, b, c): (VertexId, VertexId, VertexId),
        [before, after]: [EdgeId; 2],
    ) -> Option<Vec<(VertexId, EdgeId)>> {
        if a == b || b == c || a == c {
            return None;
        }
        let (to_a, to_c) = (self.overlay.leaving(b, before)?, self.overlay.leaving(b, after)?);
        // On the left between the way out and the way in; on the right between the way in and the way out.
        let sides = [(to_c, to_a), (to_a, to_c)].map(|(from, to)| self.angle_between(from, to));
        let [left, right] = sides.map(|angle| angle.unwrap_or(f64::INFINITY));
        let is_left = left <= right;
        if left.min(right) >= PI - STRAIGHT {
            return None;
        }
        let (first, last) = if is_left { (after, before) } else { (before, after) };
        self.flip_between(b, first, last);
        self.rim_of(b, first, last, is_left)
    }

    /// The angle from one halfedge counter-clockwise to another one with the same tail; none where the boundary or an edge that is not free
    /// lies between.
    fn angle_between(&self, from: HalfedgeId, to: HalfedgeId) -> Option<f64> {
        let t = &self.overlay.triangulation;
        let (mut h, mut angle) = (from, 0.0);
        loop {
            angle += self.overlay.angle(h);
            h = t.twin(t.prev(h))?;
            if h == to {
                return Some(angle);
            }
            if h == from || !self.is_free(t.edge(h)) {
                return None;
            }
        }
    }

    fn is_free(&self, e: EdgeId) -> bool {
        self.path_of[e.index()].is_none() && self.overlay.held[e.index()].is_none()
    }

    /// The halfedges that leave a vertex from one edge counter-clockwise to another one.
    fn fan(&self, b: VertexId, first: EdgeId, last: EdgeId) -> Vec<HalfedgeId> {
        let t = &self.overlay.triangulation;
        let begin = self.overlay.leaving(b, first);
        let next = |h: &HalfedgeId| if t.edge(*h) == last { None } else { t.twin(t.prev(*h)) };
        std::iter::successors(begin, next).take(MOST_FLIPS).collect()
    }

    /// Flips edges between two others at a vertex until none is left whose outer end the two triangles at it meet with less than π.
    fn flip_between(&mut self, b: VertexId, first: EdgeId, last: EdgeId) {
        // Each flip takes one away, but where edges come back to where they began.
        for _ in 0..MOST_FLIPS {
            let fan = self.fan(b, first, last);
            let t = &self.overlay.triangulation;
            let bends_in = |h: &&HalfedgeId| {
                let Some(twin) = t.twin(**h) else { return false };
                let outer = self.overlay.angle(t.next(**h)) + self.overlay.angle(twin);
                outer < PI - STRAIGHT && t.is_flippable(t.edge(**h))
            };
            let inner = &fan[1..fan.len().max(2) - 1];
            let Some(&h) = inner.iter().find(bends_in) else { return };
            if !self.overlay.flip(t.edge(h)) {
                return;
            }
        }
    }

    /// The outer rim of the triangles between two edges at a vertex, if it is a shorter way between their other ends that touches nothing; from the
    /// last one's on where those triangles lie to the left.
    fn rim_of(&self, b: VertexId, first: EdgeId, last: EdgeId, is_left: bool) -> Option<Vec<(VertexId, EdgeId)>> {
        let t = &self.overlay.triangulation;
        let fan = self.fan(b, first, last);
        if fan.len() < 2 || t.edge(fan[fan.len() - 1]) != last {
            return None;
        }
        let rim: Vec<HalfedgeId> = fan[..fan.len() - 1].iter().map(|&h| t.next(h)).collect();
        let length = |e: EdgeId| self.overlay.length[e.index()];
        let whole: f64 = rim.iter().map(|&h| length(t.edge(h))).sum();
        let is_shorter = whole < (1.0 - SHORTER) * (length(first) + length(last));
        let mut inner: Vec<VertexId> = rim[1..].iter().map(|&h| t.tail(h)).collect();
        let touches = inner.iter().any(|v| self.is_taken[v.index()]) || rim.iter().any(|&h| !self.is_free(t.edge(h)));
        inner.sort_unstable_by_key(|v| v.index());
        let repeats = inner.windows(2).any(|pair| pair[0] == pair[1]);
        if !is_shorter || touches || repeats {
            return None;
        }
        // It runs from the first edge's other end to the last one's: counter-clockwise about b.
        Some(match is_left {
            true => rim.iter().rev().map(|&h| (t.tail(h), t.edge(h))).collect(),
            false => rim.iter().map(|&h| (t.head(h), t.edge(h))).collect(),
        })
    }
}

/// A way the other way round.
fn turned(way: &[(VertexId, EdgeId)]) -> Vec<(VertexId, EdgeId)> {
    let edges = way.iter().skip(1).map(|&(_, e)| e).rev();
    let edges = way.last().map(|&(_, e)| e).into_iter().chain(edges);
    way.iter().rev().map(|&(v, _)| v).zip(edges).collect()
}

/// What was taken out of a triangulation.
#[derive(Default)]
pub(super) struct Dead {
    pub(super) vertices: BTreeSet<VertexId>,
    pub(super) edges: HashSet<EdgeId>,
    faces: HashSet<FaceId>,
}

impl Overlay<'_> {
    /// The halfedge of an edge that leaves one of its ends; none on the boundary where only the other one runs.
    fn leaving(&self, v: VertexId, e: EdgeId) -> Option<HalfedgeId> {
        let t = &self.triangulation;
        let h = t.halfedge(e);
        if t.tail(h) == v { Some(h) } else { t.twin(h) }
    }

    /// Whether each vertex is an end of one of these edges.
    fn are_ends(&self, of: impl Fn(EdgeId) -> bool) -> Vec<bool> {
        let t = &self.triangulation;
        let mut are_ends = vec![false; t.vertex_count()];
        t.edges().filter(|&e| of(e)).flat_map(|e| t.ends(e)).for_each(|v| are_ends[v.index()] = true);
        are_ends
    }

    /// The mean length of the edges at each vertex.
    pub(super) fn spacing(&self) -> Vec<f64> {
        let t = &self.triangulation;
        let mut sums = vec![(0.0, 0.0); t.vertex_count()];
        for e in t.edges() {
            for v in t.ends(e) {
                let (sum, count) = &mut sums[v.index()];
                (*sum, *count) = (*sum + self.length[e.index()], *count + 1.0);
            }
        }
        sums.into_iter().map(|(sum, count)| sum / count).collect()
    }

    /// The vertex opposite to a side, how far it is from it, and how far from its ends, where it lies beside it.
    fn beside_side(&self, h: HalfedgeId) -> Option<(VertexId, f64, [f64; 2])> {
        let t = &self.triangulation;
        let lengths = [h, t.next(h), t.prev(h)].map(|h| self.length[t.edge(h).index()]);
        let [_, _, back] = Sides(lengths).unfold();
        let foot = -back[0];
        (0.0 < foot && foot < lengths[0]).then(|| (t.tail(t.prev(h)), -back[1], [lengths[2], lengths[1]]))
    }

    /// Lets paths go through vertices of the input that they nearly go through.
    pub(super) fn snap(&self, path_of: &mut [Option<u32>], spacing: &[f64]) {
        let t = &self.triangulation;
        let whole = Metric::new(self.length.clone().into()).angle_sums(t);
        let mut is_taken = self.are_ends(|e| path_of[e.index()].is_some() || self.held[e.index()].is_some());
        let mut edges: Vec<EdgeId> = t.edges().filter(|e| path_of[e.index()].is_some()).collect();
        while let Some(e) = edges.pop() {
            let h = t.halfedge(e);
            let nearly = [Some(h), t.twin(h)].into_iter().flatten().find_map(|h| {
                let (v, distance, [a, b]) = self.beside_side(h)?;
                let is_near = distance < NEARLY_ON * spacing[v.index()] && distance < LEAST_TURN * a.min(b);
                let is_free = v.index() < self.input.vertex_count() && !is_taken[v.index()];
                let beyond = whole[v] - self.angle(t.prev(h));
                (is_near && is_free && (beyond - PI).abs() < 2.0 * LEAST_TURN).then_some((h, v))
            });
            if let Some((h, v)) = nearly {
                is_taken[v.index()] = true;
                let number = path_of[e.index()].take();
                for e in [t.next(h), t.prev(h)].map(|h| t.edge(h)) {
                    path_of[e.index()] = number;
                    edges.push(e);
                }
            }
        }
    }

    /// Vertices that were put in and lie too near to an edge that is held inside the surface, each with one of its edges.
    pub(super) fn near_held(&self, spacing: &[f64]) -> BTreeMap<VertexId, EdgeId> {
        let t = &self.triangulation;
        let held = |e: &EdgeId| self.held[e.index()].is_some();
        let is_taken = self.are_ends(|e| held(&e));
        let sides = t.edges().filter(held).filter_map(|e| Some([t.halfedge(e), t.twin(t.halfedge(e))?])).flatten();
        let near = sides.filter_map(|h| {
            let (v, distance, _) = self.beside_side(h)?;
            let is_free = v.index() >= self.input.vertex_count() && !is_taken[v.index()];
            (is_free && distance < NEAR * spacing[v.index()]).then(|| (v, t.edge(t.prev(h))))
        });
        near.collect()
    }

    /// Takes a vertex out that was put in inside the surface, one of whose edges is given; the sides of the triangle that is left. None where it stays.
    pub(super) fn remove(&mut self, v: VertexId, mut e: EdgeId, dead: &mut Dead) -> Option<[EdgeId; 3]> {
        if dead.vertices.contains(&v) || dead.edges.contains(&e) {
            return None;
        }
        loop {
            let t = &self.triangulation;
            let first = self.leaving(v, e).filter(|&h| t.tail(h) == v)?;
            let mut ring = vec![first];
            while let Some(next) = t.twin(t.prev(ring[ring.len() - 1])).filter(|&next| next != first) {
                ring.push(next);
            }
            t.twin(first)?;
            if ring.len() == 3 {
                let sides = [0, 1, 2].map(|k| t.edge(t.next(ring[k])));
                let ends = [0, 1, 2].map(|k| t.head(ring[k]));
                let are_three = |[a, b, c]: [usize; 3]| a != b && b != c && c != a;
                if !are_three(sides.map(EdgeId::index)) || !are_three(ends.map(VertexId::index)) || ends.contains(&v) {
                    return None;
                }
                for &h in &ring {
                    let spoke = t.edge(h);
                    self.crossings -= self.crossing_count(spoke);
                    dead.edges.insert(spoke);
                }
                dead.faces.extend([t.face(ring[1]), t.face(ring[2])]);
                dead.vertices.insert(v);
                self.triangulation.remove(first);
                return Some(sides);
            }
            let is_ear = |&&h: &&HalfedgeId| {
                let Some(g) = t.twin(h) else { return false };
                let at_ends = [self.angle(h) + self.angle(t.next(g)), self.angle(g) + self.angle(t.next(h))];
                let beside = [h, g].map(|h| t.tail(t.prev(h)));
                t.is_flippable(t.edge(h))
                    && at_ends.iter().all(|angle| *angle < PI - STRAIGHT)
                    && beside[0] != beside[1]
                    && !beside.contains(&v)
            };
            let at = ring.iter().position(|h| is_ear(&h)).filter(|_| ring.len() > 3)?;
            e = t.edge(ring[(at + 1) % ring.len()]);
            let ear = t.edge(ring[at]);
            if !self.flip(ear) {
                return None;
            }
        }
    }

    /// Numbers anew what is left; the vertices that are gone.
    pub(super) fn compact(&mut self, dead: &Dead, path_of: &mut Vec<Option<u32>>) -> Vec<VertexId> {
        let is_left = |e: usize| !dead.edges.contains(&EdgeId::new(e));
        self.triangulation.compact(
            |v| !dead.vertices.contains(&v),
            |e| is_left(e.index()),
            |f| !dead.faces.contains(&f),
        );
        retain(&mut self.length, is_left);
        retain(&mut self.trace, is_left);
        retain(&mut self.held, is_left);
        retain(path_of, is_left);
        retain(&mut self.place, |v| !dead.vertices.contains(&VertexId::new(v)));
        dead.vertices.iter().copied().collect()
    }

    /// The angle at the tail of a halfedge.
    fn angle(&self, h: HalfedgeId) -> f64 {
        self.sides(self.triangulation.face(h)).angle((h.index() + 1) % 3)
    }
}

/// Keeps values by their numbers.
pub(super) fn retain<T>(values: &mut Vec<T>, is_left: impl Fn(usize) -> bool) {
    let mut number = 0;
    values.retain(|_| {
        number += 1;
        is_left(number - 1)
    });
}
