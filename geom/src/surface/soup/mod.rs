//! The triangles of a model on their way to surfaces: glued along edges, what is too much left out.
//!
//! Halfedges are numbered as in a mesh, three a triangle; each knows the one across its edge, in whatever direction that runs.
//! Triangles are turned until neighbours agree ([`orient`](self::orient)); what goes round a vertex without a gap is a
//! *fan*, and a vertex of a surface ([`fans`](self::fans)).

mod fans;
mod orient;

use std::collections::{HashMap, HashSet};
use std::convert::Infallible;
use std::ops::Range;

use super::model::Model;
use super::radial::{RadialFace, solid_pairs};
use super::repair::{RepairKind, RepairLog};
use super::stitches::{BoundarySide, stitches};
use super::t_junctions::{Insertion, OpenSide, t_junctions};
use super::triangulate::Triangles;
use crate::mesh::{Id, Twins, VertexId, of_edges};
use crate::parallel::map;
use crate::vector::{cross, length, sub};
use crate::watch::{Interrupted, Watch, unwatched};

/// So many halfedges or vertices are gone through one after the other.
const RUN: usize = 1 << 16;

/// Stands for "no twin".
pub(super) const NONE: u32 = u32::MAX;

/// Triangles on their way to surfaces. Halfedges are numbered as in a mesh: three a triangle.
pub(super) struct Soup {
    vertex_count: usize,
    /// The vertex where each halfedge starts.
    tail: Vec<VertexId>,
    /// The model's corner where it starts.
    pub(super) corner: Vec<u32>,
    /// For each triangle the model's triangle and face.
    pub(super) triangle: Vec<(u32, u32)>,
    /// The halfedge across the edge, in whatever direction it runs; `NONE` where the surface ends.
    pub(super) twin: Vec<u32>,
}

/// What lies at edges with more than two sides.
#[derive(Default)]
struct Crowded {
    /// The triangles, some of them often.
    faces: Vec<usize>,
    /// The lower end of each such edge that stays open.
    opened: Vec<VertexId>,
    /// The ends of each whose faces are glued in pairs, the lower one first, and the pairs.
    paired: Vec<([u32; 2], Vec<[u32; 2]>)>,
}

impl Soup {
    /// The triangles of a model, each glued to its neighbours; vertices are taken for others at a `place`.
    pub(super) fn glued(
        model: &Model,
        triangles: &Triangles,
        place: Option<&[u32]>,
        log: &mut RepairLog,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        watch.ask(0.0)?;
        if let Some(place) = place {
            (0..)
                .zip(place)
                .filter(|&(v, &place)| v != place)
                .for_each(|(v, _)| log.note(RepairKind::Welded, v as usize));
        }
        let mut soup = Self::new(model, triangles, place, log);
        watch.ask(0.2)?;
        let mut crowded = soup.glue(model.points());
        watch.ask(0.6)?;
        if soup.leave_out_duplicates(crowded.faces, model, place, log) {
            crowded = soup.glue(model.points());
        }
        crowded.opened.iter().for_each(|v| log.note(RepairKind::NonManifoldEdge, v.index()));
        crowded.paired.iter().for_each(|([v, _], _)| log.note(RepairKind::TouchingEdge, *v as usize));
        Ok(soup)
    }

    /// What vertices at the boundary are taken for where it meets itself.
    pub(super) fn stitches(&self, points: &[[f64; 3]]) -> Option<Vec<u32>> {
        let mut open = (0..self.tail.len()).filter(|&h| self.twin[h] == NONE).peekable();
        open.peek()?;
        let reach = points.as_flattened().iter().fold(0.0, |reach: f64, x| reach.max(x.abs()));
        let scale = if reach > 0.0 { reach.recip() } else { 1.0 };
        let at = |h: usize| points[self.tail[h].index()].map(|x| x * scale);
        let twice_area = |f: usize| {
            let [a, b, c] = [3 * f, 3 * f + 1, 3 * f + 2].map(at);
            length(cross(sub(b, a), sub(c, a)))
        };
        let mut part = vec![0; self.triangle.len()];
        let mut area = Vec::new();
        for (faces, k) in self.components().iter().zip(0..) {
            faces.iter().for_each(|&f| part[f as usize] = k);
            area.push(0.5 * faces.iter().map(|&f| twice_area(f as usize)).sum::<f64>());
        }
        let side =
            |h: usize| BoundarySide { triangle: [h, next(h), prev(h)].map(|h| self.tail[h].0), part: part[h / 3] };
        stitches((points, scale), open.map(side), &area)
    }

    /// The corners that faces have to gain so that the surface is closed where vertices lie on their sides; vertices at one place are told apart if
    /// they are not `joined`.
    pub(super) fn t_junctions(&self, model: &Model, joined: bool) -> Vec<Insertion> {
        let open = (0..self.tail.len()).filter(|&h| self.twin[h] == NONE);
        let mut sides: Vec<OpenSide> = open.filter_map(|h| self.side_of_face(model, h)).collect();
        sides.sort_unstable_by_key(|side| side.corner);
        t_junctions(model, &sides, joined)
    }

    /// The side of a face that a halfedge is; none for diagonals.
    fn side_of_face(&self, model: &Model, h: usize) -> Option<OpenSide> {
        let face = self.triangle[h / 3].1;
        let corners = [h, next(h), prev(h)].map(|h| self.corner[h]);
        let range = model.face_corners(face as usize);
        let behind = if corners[0] as usize + 1 < range.end { corners[0] + 1 } else { range.start as u32 };
        let [a, b, apex] = corners.map(|corner| model.corners()[corner as usize]);
        (corners[1] == behind).then_some(OpenSide { face, corner: corners[0], ends: [a, b], apex })
    }

    fn new(model: &Model, triangles: &Triangles, place: Option<&[u32]>, log: &mut RepairLog) -> Self {
        let place = |v: u32| place.map_or(v, |place| place[v as usize]);
        let corner = triangles.corners.as_flattened().to_vec();
        let tail = map(corner.len(), |k| VertexId(place(model.corners()[corner[k] as usize])));
        let triangle = map(triangles.len(), |t| (t as u32, triangles.face_of[t]));
        let mut soup = Self { vertex_count: model.vertex_count(), tail, corner, triangle, twin: Vec::new() };
        let repeats = |[a, b, c]: [VertexId; 3]| a == b || b == c || c == a;
        let keep: Vec<bool> = soup.tail.as_chunks().0.iter().map(|&corners| !repeats(corners)).collect();
        if keep.contains(&false) {
            soup.leave_out(&keep, RepairKind::RepeatedVertex, log);
        }
        soup
    }

    fn sorted_vertices(&self, f: usize) -> [VertexId; 3] {
        let mut vertices = [self.tail[3 * f], self.tail[3 * f + 1], self.tail[3 * f + 2]];
        vertices.sort_unstable();
        vertices
    }

    /// Leaves out all but the first of the triangles on the same three vertices, and of the polygons round the same ones, which may be cut
    /// otherwise, where an edge has too many; whether there are any.
    fn leave_out_duplicates(
        &mut self,
        mut crowded: Vec<usize>,
        model: &Model,
        place: Option<&[u32]>,
        log: &mut RepairLog,
    ) -> bool {
        crowded.sort_unstable();
        crowded.dedup();
        let mut polygons: Vec<u32> = crowded.iter().map(|&f| self.triangle[f].1).collect();
        polygons.dedup();
        let mut first = HashSet::new();
        let mut doubled: Vec<usize> = crowded.into_iter().filter(|&f| !first.insert(self.sorted_vertices(f))).collect();
        self.retain_whole_faces(&mut doubled);
        let around = |&face: &u32| {
            let place = |&v: &u32| place.map_or(v, |place| place[v as usize]);
            cycle(model.face(face as usize).iter().map(place).collect())
        };
        let mut first = HashSet::new();
        let polygons = polygons.into_iter().filter(|&face| model.face(face as usize).len() > 3);
        let copies: Vec<u32> = polygons.filter(|face| !first.insert(around(face))).collect();
        doubled.extend(copies.into_iter().flat_map(|face| self.triangles_of(face)));
        if doubled.is_empty() {
            return false;
        }
        let mut keep = vec![true; self.triangle.len()];
        doubled.into_iter().for_each(|f| keep[f] = false);
        self.leave_out(&keep, RepairKind::DuplicateFace, log);
        true
    }

    /// Leaves out the triangles that are not kept.
    fn leave_out(&mut self, keep: &[bool], why: RepairKind, log: &mut RepairLog) {
        self.note_faces((0..keep.len()).filter(|&f| !keep[f]), why, log);
        let mut side = 0..self.tail.len();
        self.tail.retain(|_| side.next().is_some_and(|h| keep[h / 3]));
        let mut side = 0..self.corner.len();
        self.corner.retain(|_| side.next().is_some_and(|h| keep[h / 3]));
        let mut face = keep.iter();
        self.triangle.retain(|_| face.next() == Some(&true));
    }

    /// Of ascending triangles those whose faces have no others: a polygon without one of its triangles would fall apart, and
    /// its pieces share its corners.
    fn retain_whole_faces(&self, triangles: &mut Vec<usize>) {
        let face = |f: usize| self.triangle[f].1;
        let is_whole = |chunk: &&[usize]| chunk.len() == self.triangles_of(face(chunk[0])).len();
        let whole = triangles.chunk_by(|&f, &g| face(f) == face(g)).filter(is_whole);
        *triangles = whole.flatten().copied().collect();
    }

    /// The triangles of a face.
    fn triangles_of(&self, of: u32) -> Range<usize> {
        let end = |is_before: fn(u32, u32) -> bool| self.triangle.partition_point(|&(_, face)| is_before(face, of));
        end(|face, of| face < of)..end(|face, of| face <= of)
    }

    /// Notes the faces of ascending triangles, each once.
    fn note_faces(&self, triangles: impl Iterator<Item = usize>, why: RepairKind, log: &mut RepairLog) {
        let mut faces: Vec<u32> = triangles.map(|f| self.triangle[f].1).collect();
        faces.dedup();
        faces.into_iter().for_each(|face| log.note(why, face as usize));
    }

    /// Makes twins of the two sides of each edge that has just two, and of pairs of sides where bodies touch. The diagonals of polygons are edges of
    /// their own: a polygon must stay in one piece, for its triangles share its corners.
    fn glue(&mut self, points: &[[f64; 3]]) -> Crowded {
        let twins = Twins::none(self.tail.len());
        let visit = |crowded: &mut Crowded, ends: [u32; 2], sides: &[u32]| {
            match *sides {
                [_] => {}
                [h, g] => twins.set(h, g),
                _ => {
                    crowded.faces.extend(sides.iter().map(|h| (h / 3) as usize));
                    let mut rest = sides.to_vec();
                    for &h in sides {
                        let other = |&g: &u32| self.are_one_diagonal(h as usize, g as usize);
                        if let Some(g) = rest.iter().copied().find(other).filter(|_| rest.contains(&h)) {
                            twins.set(h, g);
                            rest.retain(|&side| side != h && side != g);
                        }
                    }
                    match *rest {
                        [] | [_] => {}
                        [h, g] => twins.set(h, g),
                        _ => match self.touching(points, ends, &rest) {
                            Some(pairs) => {
                                pairs.iter().for_each(|&[h, g]| twins.set(h, g));
                                crowded.paired.push((ends, pairs));
                            }
                            None => crowded.opened.push(VertexId(ends[0])),
                        },
                    }
                }
            }
            Ok::<_, Infallible>(())
        };
        let parts = of_edges(self.vertex_count, self.tail.len(), |h| self.tail[h].0, visit);
        self.twin = twins.into_vec();
        let mut crowded = Crowded::default();
        for Ok(part) in parts {
            crowded.faces.extend(part.faces);
            crowded.opened.extend(part.opened);
            crowded.paired.extend(part.paired);
        }
        self.open_lone_edges(&mut crowded);
        crowded
    }

    /// Opens edges that are glued in pairs, but meet no other such edge and are of one body: a scan touches itself there by noise, and a tunnel or a handle of no
    /// width would be left (raptor: genus 10 for 9, eleven islands for four).
    fn open_lone_edges(&mut self, crowded: &mut Crowded) {
        let mut meeting = HashMap::<u32, u32>::new();
        let ends = crowded.paired.iter().flat_map(|(ends, _)| ends);
        ends.for_each(|&v| *meeting.entry(v).or_default() += 1);
        let is_lone = |ends: &[u32; 2]| ends.iter().all(|v| meeting[v] == 1);
        let (lone, mut paired): (Vec<_>, Vec<_>) = crowded.paired.drain(..).partition(|(ends, _)| is_lone(ends));
        if !lone.is_empty() {
            lone.iter().flat_map(|(_, pairs)| pairs).flatten().for_each(|&h| self.twin[h as usize] = NONE);
            let mut body = vec![0; self.triangle.len()];
            for (k, component) in self.components().into_iter().enumerate() {
                component.into_iter().for_each(|f| body[f as usize] = k);
            }
            let body_of = |pair: &[u32; 2]| body[pair[0] as usize / 3];
            for (ends, pairs) in lone {
                if pairs.iter().all(|pair| body_of(pair) == body_of(&pairs[0])) {
                    crowded.opened.push(VertexId(ends[0]));
                    continue;
                }
                for &[h, g] in &pairs {
                    (self.twin[h as usize], self.twin[g as usize]) = (g, h);
                }
                paired.push((ends, pairs));
            }
        }
        paired.sort_by_key(|(ends, _)| *ends);
        crowded.opened.sort_unstable();
        crowded.paired = paired;
    }

    /// Pairs of the sides at an edge that bound the same body, where bodies touch along it. None where sides are of one polygon, whose triangles
    /// must not be told apart.
    fn touching(&self, points: &[[f64; 3]], ends: [u32; 2], sides: &[u32]) -> Option<Vec<[u32; 2]>> {
        let mut polygons: Vec<u32> = sides.iter().map(|&h| self.triangle[h as usize / 3].1).collect();
        polygons.sort_unstable();
        if polygons.windows(2).any(|pair| pair[0] == pair[1]) {
            return None;
        }
        let face = |&h: &u32| RadialFace {
            apex: points[self.tail[prev(h as usize)].index()],
            is_forward: self.tail[h as usize].0 == ends[0],
        };
        let faces: Vec<RadialFace> = sides.iter().map(face).collect();
        let pairs = solid_pairs(ends.map(|v| points[v as usize]), &faces)?;
        Some(pairs.into_iter().map(|pair| pair.map(|k| sides[k])).collect())
    }

    /// Whether two sides run the opposite way between the same corners of a polygon.
    fn are_one_diagonal(&self, h: usize, g: usize) -> bool {
        let corners = |h: usize| [self.corner[h], self.corner[next(h)]];
        let ([a, b], [c, d]) = (corners(h), corners(g));
        self.triangle[h / 3].1 == self.triangle[g / 3].1 && [a, b] == [d, c]
    }

    /// The connected components, as lists of triangles in ascending order.
    pub(super) fn components(&self) -> Vec<Vec<u32>> {
        let faces = self.triangle.len();
        let mut component = vec![NONE; faces];
        let mut count = 0;
        let mut stack = Vec::new();
        for seed in 0..faces {
            if component[seed] != NONE {
                continue;
            }
            component[seed] = count;
            stack.push(seed);
            while let Some(f) = stack.pop() {
                for &g in &self.twin[3 * f..3 * f + 3] {
                    if g != NONE && component[g as usize / 3] == NONE {
                        component[g as usize / 3] = count;
                        stack.push(g as usize / 3);
                    }
                }
            }
            count += 1;
        }
        let mut lists = vec![Vec::new(); count as usize];
        for (f, &c) in component.iter().enumerate() {
            lists[c as usize].push(f as u32);
        }
        lists
    }
}

/// What vertices of a model at its boundary are taken for where that meets itself.
pub(super) fn stitches_of(model: &Model) -> Option<Vec<u32>> {
    let soup = Soup::glued(model, &model.triangles(), None, &mut RepairLog::default(), Watch::NONE);
    unwatched(soup).stitches(model.points())
}

/// The corners of a polygon from the least one on, the way that has the lesser of its neighbours next: the same whichever the first corner and
/// whichever way round.
fn cycle(mut corners: Vec<u32>) -> Vec<u32> {
    let least = (0..corners.len()).min_by_key(|&k| corners[k]).unwrap_or_default();
    corners.rotate_left(least);
    if corners[corners.len() - 1] < corners[1] {
        corners[1..].reverse();
    }
    corners
}

fn next(h: usize) -> usize {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

fn prev(h: usize) -> usize {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// Writes for each item its place in the list.
pub(super) fn number(list: &[u32], place: &mut [u32]) {
    for (k, &item) in list.iter().enumerate() {
        place[item as usize] = k as u32;
    }
}
