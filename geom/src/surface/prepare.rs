//! From a model as a file had it to oriented manifold surfaces that can be computed with, and back.
//!
//! Whatever is wrong is mended here or named, and nothing is dropped silently:
//! - triangles that use a vertex twice, and copies of a triangle at an edge that has too many, are left out;
//! - isolated vertices are left out;
//! - triangles are turned until neighbours agree, the way most of the component had them; a surface that is not
//!   orientable is opened along the edges where they cannot;
//! - at an edge of three or more triangles, and at a vertex of several fans, the surface is opened: every fan gets its own
//!   copy of the vertex;
//! - each connected component becomes a [`Surface`] of its own, moved to the origin and scaled to unit size.
//!
//! Polygons are computed with as triangles ([`Model::triangles`]); the edges inside a polygon are known, so that no seam
//! need run along them. Every halfedge knows the model's corner that it came from: that is the way back.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::convert::Infallible;

use thiserror::Error;

use super::model::{Model, place_key};
use super::triangulate::Triangles;
use super::weld::{BoundarySide, Weld, stitches};
use crate::intrinsic::Metric;
use crate::mesh::{
    EdgeData, EdgeId, FaceData, FaceId, HalfedgeData, HalfedgeId, Id, Mesh, Twins, VertexData, VertexId, of_edges,
};
use crate::parallel::{all, each_of, join, map, sort};
use crate::rows::Rows;
use crate::vector::{cross, length, sub};
use crate::watch::{Interrupted, Watch, unwatched};

/// Something that was mended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Repair {
    /// What it was.
    pub kind: RepairKind,
    /// How often it occurred.
    pub count: usize,
    /// The first place, in the file's numbering from 0: a face for what concerns faces, otherwise a vertex.
    pub first: usize,
}

/// What can be mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum RepairKind {
    /// A face that uses a vertex twice; left out.
    RepeatedVertex,
    /// A copy of a face at an edge with more than two; left out.
    DuplicateFace,
    /// A vertex that no face uses; left out.
    IsolatedVertex,
    /// A face that was oriented against its neighbours; turned.
    FlippedFace,
    /// An edge with more than two faces; opened.
    NonManifoldEdge,
    /// A vertex whose faces form several fans; one copy a fan.
    NonManifoldVertex,
    /// An edge of a surface that cannot be oriented; opened.
    NonOrientableEdge,
    /// A triangle without area; computed with slightly lengthened edges.
    ZeroArea,
    /// A component without any area; left out.
    ComponentWithoutArea,
    /// A boundary vertex at the same place as another one: perhaps a seam that was never [welded](Weld).
    Unwelded,
    /// Vertices welded because they were at the same place.
    Welded,
}

impl RepairKind {
    /// What was found and what was done, for a report.
    pub fn description(self) -> &'static str {
        match self {
            Self::RepeatedVertex => "faces that use a vertex twice, left out",
            Self::DuplicateFace => "copies of faces, left out",
            Self::IsolatedVertex => "isolated vertices, left out",
            Self::FlippedFace => "faces oriented against their neighbours, turned",
            Self::NonManifoldEdge => "edges with more than two faces, opened",
            Self::NonManifoldVertex => "vertices with several fans of faces, opened",
            Self::NonOrientableEdge => "edges where the surface cannot be oriented, opened",
            Self::ZeroArea => "triangles without area, computed with slightly lengthened edges",
            Self::ComponentWithoutArea => "parts without any area, left out",
            Self::Unwelded => "boundary vertices at the place of another one, not welded",
            Self::Welded => "vertices at the place of another one, welded",
        }
    }

    /// The [description](Self::description) with how many there were, in the singular for one.
    pub fn counted(self, count: usize) -> String {
        if count != 1 {
            return format!("{count} {}", self.description());
        }
        let one = match self {
            Self::RepeatedVertex => "face that uses a vertex twice, left out",
            Self::DuplicateFace => "copy of a face, left out",
            Self::IsolatedVertex => "isolated vertex, left out",
            Self::FlippedFace => "face oriented against its neighbours, turned",
            Self::NonManifoldEdge => "edge with more than two faces, opened",
            Self::NonManifoldVertex => "vertex with several fans of faces, opened",
            Self::NonOrientableEdge => "edge where the surface cannot be oriented, opened",
            Self::ZeroArea => "triangle without area, computed with slightly lengthened edges",
            Self::ComponentWithoutArea => "part without any area, left out",
            Self::Unwelded => "boundary vertex at the place of another one, not welded",
            Self::Welded => "vertex at the place of another one, welded",
        };
        format!("1 {one}")
    }

    /// Whether [`Repair::first`] counts faces (otherwise vertices).
    pub fn is_of_faces(self) -> bool {
        matches!(
            self,
            Self::RepeatedVertex
                | Self::DuplicateFace
                | Self::FlippedFace
                | Self::ZeroArea
                | Self::ComponentWithoutArea
        )
    }
}

/// Why a model has no surface to compute with.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum PrepareError {
    /// All faces lie in lines or points.
    #[error("the mesh has no area: all of its {faces} faces are points or lines")]
    NoArea {
        /// How many faces there are.
        faces: usize,
    },
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// A connected, oriented manifold surface with the way back to the model.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its connectivity.
    pub mesh: Mesh,
    /// The positions of its vertices, centred and scaled to unit size.
    pub points: Vec<[f64; 3]>,
    /// The model's vertex that each vertex is, or is a copy of.
    pub vertex: VertexData<u32>,
    /// The model's corner that each halfedge starts at.
    pub corner: HalfedgeData<u32>,
    /// The model's triangle that each face is (perhaps turned).
    pub triangle: FaceData<u32>,
    /// The edges that lie inside a polygon of the model.
    pub diagonal: EdgeData<bool>,
    /// What positions were multiplied by.
    pub scale: f64,
    /// How many triangles have no area.
    pub zero_area: usize,
}

impl Surface {
    /// The edge lengths in unit size; where triangles have no area, lengthened by a hair so that all have some.
    pub fn metric(&self) -> Metric {
        let metric = Metric::from_points(&self.mesh, &self.points);
        if self.zero_area > 0 { metric.mollified(&self.mesh, Metric::MOLLIFICATION) } else { metric }
    }
}

/// A model's surfaces and what was mended.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The connected components, in the order of their first triangles.
    pub surfaces: Vec<Surface>,
    /// The triangles of the model, before anything was left out.
    pub triangles: Triangles,
    /// Which of the triangles belong to no surface.
    pub left_out: Vec<u32>,
    /// What was mended, in a fixed order.
    pub repairs: Vec<Repair>,
}

/// Makes surfaces of a model, some of whose vertices may be taken for one. O(F) but for sorting.
///
/// # Errors
/// If nothing has any area.
pub fn prepare(model: &Model, weld: Weld) -> Result<Prepared, PrepareError> {
    prepare_watched(model, weld, Watch::NONE)
}

/// [`prepare()`], watched.
///
/// # Errors
/// If nothing has any area, or the work is stopped.
pub fn prepare_watched(model: &Model, weld: Weld, watch: Watch) -> Result<Prepared, PrepareError> {
    let mut log = RepairLog::default();
    let triangles = model.triangles();
    watch.ask(0.02)?;
    // Boundaries have to be known before they are joined: where they are, triangles are glued again.
    let welded = if weld == Weld::Always { weld.of(model) } else { None };
    let mut soup = Soup::glued(model, &triangles, welded.as_deref(), &mut log, watch.within(0.05, 0.3))?;
    if weld == Weld::Auto
        && let Some(place) = soup.stitches(model.points())
    {
        log = RepairLog::default();
        soup = Soup::glued(model, &triangles, Some(&place), &mut log, watch.within(0.3, 0.35))?;
    }
    note_isolated(model, &mut log);
    soup.orient(&mut log);
    watch.ask(0.5)?;
    let surfaces = soup.into_surfaces(model.points(), &mut log, watch.within(0.5, 0.95))?;
    if surfaces.is_empty() {
        return Err(PrepareError::NoArea { faces: model.face_count() });
    }
    note_unwelded(model.points(), &surfaces, &mut log);
    let mut used = vec![false; triangles.len()];
    surfaces.iter().flat_map(|surface| surface.triangle.iter()).for_each(|&t| used[t as usize] = true);
    let left_out = (0..triangles.len() as u32).filter(|&t| !used[t as usize]).collect();
    Ok(Prepared { surfaces, triangles, left_out, repairs: log.into_repairs() })
}

/// What has been mended so far.
#[derive(Default)]
pub(super) struct RepairLog(BTreeMap<RepairKind, (usize, usize)>);

impl RepairLog {
    fn note(&mut self, kind: RepairKind, place: usize) {
        let (count, first) = self.0.entry(kind).or_insert((0, place));
        *count += 1;
        *first = place.min(*first);
    }

    fn into_repairs(self) -> Vec<Repair> {
        self.0.into_iter().map(|(kind, (count, first))| Repair { kind, count, first }).collect()
    }
}

/// A triangle's height in a surface of size 1 that may be rounding alone.
const ROUNDED_HEIGHT: f64 = 1e-14;

/// So many halfedges or vertices are gone through one after the other.
const RUN: usize = 1 << 16;

/// Stands for "no twin".
const NONE: u32 = u32::MAX;

/// Triangles on their way to surfaces. Halfedges are numbered as in a mesh: three a triangle.
struct Soup {
    vertex_count: usize,
    /// The vertex where each halfedge starts.
    tail: Vec<VertexId>,
    /// The model's corner where it starts.
    corner: Vec<u32>,
    /// For each triangle the model's triangle and face.
    triangle: Vec<(u32, u32)>,
    /// The halfedge across the edge, in whatever direction it runs; `NONE` where the surface ends.
    twin: Vec<u32>,
}

/// What lies at edges with more than two sides.
#[derive(Default)]
struct Crowded {
    /// The triangles, some of them often.
    faces: Vec<usize>,
    /// The lower end of each such edge that stays open.
    opened: Vec<VertexId>,
}

impl Soup {
    /// The triangles of a model, each glued to its neighbours; vertices are taken for others at a `place`.
    fn glued(
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
        let mut crowded = soup.glue();
        watch.ask(0.6)?;
        if soup.leave_out_duplicates(crowded.faces, log) {
            crowded = soup.glue();
        }
        crowded.opened.iter().for_each(|v| log.note(RepairKind::NonManifoldEdge, v.index()));
        Ok(soup)
    }

    /// What vertices at the boundary are taken for where it meets itself.
    fn stitches(&self, points: &[[f64; 3]]) -> Option<Vec<u32>> {
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

    /// Leaves out all but the first of the triangles on the same three vertices, where an edge has too many; whether there are any.
    fn leave_out_duplicates(&mut self, mut crowded: Vec<usize>, log: &mut RepairLog) -> bool {
        crowded.sort_unstable();
        crowded.dedup();
        let mut first = HashSet::new();
        let mut doubled: Vec<usize> = crowded.into_iter().filter(|&f| !first.insert(self.sorted_vertices(f))).collect();
        self.retain_whole_faces(&mut doubled);
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
        for (_, (_, face)) in keep.iter().zip(&self.triangle).filter(|(keep, _)| !**keep) {
            log.note(why, *face as usize);
        }
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
        let size = |of: u32| {
            let from = self.triangle.partition_point(|&(_, face)| face < of);
            self.triangle[from..].iter().take_while(|&&(_, face)| face == of).count()
        };
        let whole = triangles.chunk_by(|&f, &g| face(f) == face(g)).filter(|chunk| chunk.len() == size(face(chunk[0])));
        *triangles = whole.flatten().copied().collect();
    }

    /// Makes twins of the two sides of each edge that has just two. The diagonals of polygons are edges of their own: a
    /// polygon must stay in one piece, for its triangles share its corners.
    fn glue(&mut self) -> Crowded {
        let twins = Twins::none(self.tail.len());
        let visit = |crowded: &mut Crowded, [lower, _]: [u32; 2], sides: &[u32]| {
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
                        _ => crowded.opened.push(VertexId(lower)),
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
        }
        crowded
    }

    /// Whether two sides run the opposite way between the same corners of a polygon.
    fn are_one_diagonal(&self, h: usize, g: usize) -> bool {
        let corners = |h: usize| [self.corner[h], self.corner[next(h)]];
        let ([a, b], [c, d]) = (corners(h), corners(g));
        self.triangle[h / 3].1 == self.triangle[g / 3].1 && [a, b] == [d, c]
    }

    /// Turns triangles until twins run in opposite directions; unglues them where that cannot be, but never inside a polygon.
    fn orient(&mut self, log: &mut RepairLog) {
        let is_oriented = |h: usize| self.twin[h] == NONE || !self.run_alike(h, self.twin[h] as usize);
        if all(self.tail.len(), RUN, is_oriented) {
            return;
        }
        let faces = self.triangle.len();
        let mut turned: Vec<Option<bool>> = vec![None; faces];
        let mut component = Vec::new();
        for seed in 0..faces {
            if turned[seed].is_some() {
                continue;
            }
            component.clear();
            self.turn_polygon((seed, false), &mut turned, &mut component);
            let mut at = 0;
            while at < component.len() {
                let f: usize = component[at];
                at += 1;
                for h in 3 * f..3 * f + 3 {
                    let g = self.twin[h] as usize;
                    if self.twin[h] != NONE && turned[g / 3].is_none() {
                        let turns = (turned[f] == Some(true)) ^ self.run_alike(h, g);
                        self.turn_polygon((g / 3, turns), &mut turned, &mut component);
                    }
                }
            }
            // The way most of them were is the right way.
            let majority = component.iter().filter(|&&f| turned[f] == Some(true)).count() * 2 > component.len();
            for &f in &component {
                turned[f] = turned[f].map(|t| t ^ majority);
            }
        }
        for h in 0..self.tail.len() {
            let g = self.twin[h] as usize;
            if self.twin[h] != NONE && (turned[h / 3] != turned[g / 3]) != self.run_alike(h, g) {
                log.note(RepairKind::NonOrientableEdge, self.tail[h].index());
                self.twin[g] = NONE;
                self.twin[h] = NONE;
            }
        }
        for f in (0..faces).filter(|&f| turned[f] == Some(true)) {
            log.note(RepairKind::FlippedFace, self.triangle[f].1 as usize);
            self.turn(f);
        }
    }

    /// Decides whether a triangle is turned, and with it the others of its polygon, which share its corners: all are listed.
    fn turn_polygon(&self, (first, turns): (usize, bool), turned: &mut [Option<bool>], listed: &mut Vec<usize>) {
        let mut at = listed.len();
        turned[first] = Some(turns);
        listed.push(first);
        while at < listed.len() {
            let f = listed[at];
            at += 1;
            for h in 3 * f..3 * f + 3 {
                let g = self.twin[h] as usize;
                let is_inside = self.twin[h] != NONE && self.triangle[g / 3].1 == self.triangle[f].1;
                if is_inside && turned[g / 3].is_none() {
                    turned[g / 3] = turned[f].map(|f| f ^ self.run_alike(h, g));
                    listed.push(g / 3);
                }
            }
        }
    }

    /// Whether two halfedges with the same ends run in the same direction.
    fn run_alike(&self, h: usize, g: usize) -> bool {
        self.tail[h] == self.tail[g]
    }

    /// Reverses a triangle: corners 0, 1, 2 become 0, 2, 1, and so sides 01, 12, 20 become 02, 21, 10.
    fn turn(&mut self, f: usize) {
        let [a, b, c] = [3 * f, 3 * f + 1, 3 * f + 2];
        self.tail.swap(b, c);
        self.corner.swap(b, c);
        self.twin.swap(a, c);
        for h in [a, b, c] {
            let g = self.twin[h];
            if g != NONE {
                // A twin within the same triangle would be an edge with repeated ends, and there is none.
                self.twin[g as usize] = h as u32;
            }
        }
    }

    /// Numbers the fans: each is a vertex of its own. Returns the fan of each halfedge's tail and the vertex of each fan,
    /// which are in the order of the vertices.
    fn fans(&self, log: &mut RepairLog) -> (Vec<u32>, Vec<VertexId>) {
        if let Some(lone) = self.lone_fans() {
            return lone;
        }
        let mut fan = vec![NONE; self.tail.len()];
        let mut vertex: Vec<VertexId> = Vec::new();
        for corner in 0..self.tail.len() {
            if fan[corner] != NONE {
                continue;
            }
            let number = vertex.len() as u32;
            vertex.push(self.tail[corner]);
            // Counter-clockwise over twin(prev), then clockwise over next(twin).
            let mut h = corner;
            while fan[h] == NONE {
                fan[h] = number;
                match self.twin[prev(h)] {
                    NONE => break,
                    g => h = g as usize,
                }
            }
            h = corner;
            while self.twin[h] != NONE {
                h = next(self.twin[h] as usize);
                if fan[h] != NONE {
                    break;
                }
                fan[h] = number;
            }
        }
        let of_vertex = Rows::sorted(self.vertex_count, (0..).zip(&vertex).map(|(number, v)| (v.index(), number)));
        for v in (0..self.vertex_count).filter(|&v| of_vertex.row(v).len() > 1) {
            log.note(RepairKind::NonManifoldVertex, v);
        }
        let order = of_vertex.into_items();
        let mut rank = vec![0; order.len()];
        number(&order, &mut rank);
        fan.iter_mut().for_each(|fan| *fan = rank[*fan as usize]);
        (fan, order.into_iter().map(|number| vertex[number as usize]).collect())
    }

    /// The same where each vertex has one fan; none if one has several.
    fn lone_fans(&self) -> Option<(Vec<u32>, Vec<VertexId>)> {
        // How many halfedges start at each vertex, and one of them.
        let mut starting = vec![(0, 0); self.vertex_count];
        for (h, v) in self.tail.iter().enumerate() {
            let (count, any) = &mut starting[v.index()];
            (*count, *any) = (*count + 1, h as u32);
        }
        let is_lone = |v: usize| starting[v].0 == 0 || self.fan_size(starting[v].1 as usize) == starting[v].0;
        if !all(self.vertex_count, RUN, is_lone) {
            return None;
        }
        let vertex: Vec<VertexId> =
            (0..).map(VertexId).zip(&starting).filter(|(_, s)| s.0 > 0).map(|(v, _)| v).collect();
        let mut fan = vec![NONE; self.vertex_count];
        (0..).zip(&vertex).for_each(|(number, v)| fan[v.index()] = number);
        Some((map(self.tail.len(), |h| fan[self.tail[h].index()]), vertex))
    }

    /// How many halfedges the fan has that one is in.
    fn fan_size(&self, start: usize) -> u32 {
        let (mut h, mut size) = (start, 1);
        loop {
            match self.twin[prev(h)] {
                NONE => break,
                g if g as usize == start => return size,
                g => h = g as usize,
            }
            size += 1;
        }
        // It ends at the boundary: the rest is clockwise.
        h = start;
        while self.twin[h] != NONE {
            h = next(self.twin[h] as usize);
            size += 1;
        }
        size
    }

    /// The connected components, as lists of triangles in ascending order.
    fn components(&self) -> Vec<Vec<u32>> {
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

    fn into_surfaces(
        self,
        points: &[[f64; 3]],
        log: &mut RepairLog,
        watch: Watch,
    ) -> Result<Vec<Surface>, Interrupted> {
        let ((fan, fan_vertex), components) = join(|| self.fans(log), || self.components());
        let mut local = vec![NONE; fan_vertex.len()];
        let mut new_face = vec![NONE; self.triangle.len()];
        let mut surfaces = Vec::new();
        let mut done = 0;
        for mut faces in components {
            let share = |faces: usize| faces as f64 / new_face.len() as f64;
            let watch = watch.within(share(done), share(done + faces.len()));
            watch.ask(0.0)?;
            done += faces.len();
            let mut fans: Vec<u32> = if faces.len() == new_face.len() {
                (0..fan_vertex.len() as u32).collect()
            } else {
                let is_new = |fan: &u32| std::mem::replace(&mut local[*fan as usize], 0) == NONE;
                let mut fans: Vec<u32> = sides(&faces).map(|h| fan[h]).filter(is_new).collect();
                fans.sort_unstable();
                fans
            };
            let places = map(fans.len(), |k| points[fan_vertex[fans[k] as usize].index()]);
            let first_face = self.triangle[faces[0] as usize].1 as usize;
            let Some((mut points, scale)) = to_unit_size(&places) else {
                log.note(RepairKind::ComponentWithoutArea, first_face);
                continue;
            };
            number(&fans, &mut local);
            if is_scattered(fans.len(), &faces, |h| local[fan[h] as usize]) {
                let order = along_a_curve(&points);
                fans = order.iter().map(|&k| fans[k as usize]).collect();
                points = order.iter().map(|&k| points[k as usize]).collect();
                number(&fans, &mut local);
                // By their first vertices.
                let first =
                    |k: usize| (0..3).map(|i| local[fan[side(&faces, 3 * k + i)] as usize]).fold(NONE, u32::min);
                let first = map(faces.len(), first);
                let in_rows = first.iter().zip(&faces).map(|(&first, &f)| (first as usize, f));
                faces = Rows::sorted(fans.len(), in_rows).into_items();
            }
            number(&faces, &mut new_face);
            watch.ask(0.2)?;
            let side = |k: usize| side(&faces, k);
            let side_count = 3 * faces.len();
            let tail: Vec<VertexId> = map(side_count, |k| VertexId(local[fan[side(k)] as usize]));
            let renumber = |g: u32| if g == NONE { NONE } else { 3 * new_face[g as usize / 3] + g % 3 };
            let twin: Vec<u32> = map(side_count, |k| renumber(self.twin[side(k)]));
            watch.ask(0.4)?;
            let mesh = Mesh::from_twins(fans.len(), tail, twin).expect("every fan is a vertex of its own");
            watch.ask(0.6)?;
            let vertex = map(fans.len(), |k| fan_vertex[fans[k] as usize].0).into();
            let corner = map(side_count, |k| self.corner[side(k)]).into();
            let face_of = |h: HalfedgeId| self.triangle[faces[h.index() / 3] as usize].1;
            let metric = Metric::from_points(&mesh, &points);
            watch.ask(0.8)?;
            let mut zero_area = 0;
            let has_none = |f: usize| metric.sides(&mesh, FaceId::new(f)).area() <= 0.0;
            each_of(mesh.face_count(), has_none, |f, has_none| {
                if has_none {
                    log.note(RepairKind::ZeroArea, face_of(mesh.sides(FaceId::new(f))[0]) as usize);
                    zero_area += 1;
                }
            });
            if zero_area == mesh.face_count()
                || mesh.faces().all(|f| is_line(mesh.corners(f).map(|v| points[v.index()])))
            {
                log.note(RepairKind::ComponentWithoutArea, first_face);
                continue;
            }
            let inside = |e: EdgeId| {
                let h = mesh.halfedge(e);
                mesh.twin(h).is_some_and(|g| face_of(g) == face_of(h))
            };
            let diagonal = map(mesh.edge_count(), |e| inside(EdgeId::new(e))).into();
            let triangle = map(faces.len(), |k| self.triangle[faces[k] as usize].0).into();
            surfaces.push(Surface { mesh, points, vertex, corner, triangle, diagonal, scale, zero_area });
        }
        Ok(surfaces)
    }
}

/// The halfedges of triangles.
fn sides(faces: &[u32]) -> impl Iterator<Item = usize> {
    (0..3 * faces.len()).map(|k| side(faces, k))
}

fn side(faces: &[u32], k: usize) -> usize {
    3 * faces[k / 3] as usize + k % 3
}

fn next(h: usize) -> usize {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

fn prev(h: usize) -> usize {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// Writes for each item its place in the list.
fn number(list: &[u32], place: &mut [u32]) {
    for (k, &item) in list.iter().enumerate() {
        place[item as usize] = k as u32;
    }
}

/// Surfaces of fewer vertices fit the cache whatever their numbering.
const FITS_THE_CACHE: usize = 1 << 13;

/// Whether what is near on a large surface is mostly far apart in memory: the ends of edges, or triangles that follow each other. Numbers are far apart
/// where four rows of a square grid with as many vertices are between them.
fn is_scattered(vertex_count: usize, faces: &[u32], vertex: impl Fn(usize) -> u32) -> bool {
    if vertex_count < FITS_THE_CACHE {
        return false;
    }
    let reach = 4 * vertex_count.isqrt() as u32;
    let ends = faces.iter().map(|&f| (vertex(3 * f as usize), vertex(3 * f as usize + 1)));
    let far = |(a, b): (u32, u32)| a.abs_diff(b) > reach;
    let long = ends.clone().filter(|&ends| far(ends)).count();
    let jumps = ends.clone().zip(ends.skip(1)).filter(|&((a, _), (b, _))| far((a, b))).count();
    2 * long.max(jumps) > faces.len()
}

/// The points of a box of size 1 about the origin, in the order of Morton's curve, where neighbours are mostly near each other. O(n log n).
fn along_a_curve(points: &[[f64; 3]]) -> Vec<u32> {
    let code = |k: usize| {
        // 21 bits an axis, each followed by two of the other axes.
        let [x, y, z] = points[k].map(|x| {
            let mut bits = (((x + 0.5) * f64::from(1 << 21)) as u64).min((1 << 21) - 1);
            for (shift, mask) in CURVE {
                bits = (bits | bits << shift) & mask;
            }
            bits
        });
        (x | y << 1 | z << 2, k as u32)
    };
    let mut order: Vec<(u64, u32)> = map(points.len(), code);
    sort(&mut order);
    order.into_iter().map(|(_, k)| k).collect()
}

/// How the bits of a number of 21 are spread to every third place, in five steps.
const CURVE: [(u32, u64); 5] = [
    (32, 0x001F_0000_0000_FFFF),
    (16, 0x001F_0000_FF00_00FF),
    (8, 0x100F_00F0_0F00_F00F),
    (4, 0x10C3_0C30_C30C_30C3),
    (2, 0x1249_2492_4924_9249),
];

/// Points moved so that their bounding box is centred, and scaled so that its longest side is 1, with that scale; none if
/// they all coincide.
fn to_unit_size(points: &[[f64; 3]]) -> Option<(Vec<[f64; 3]>, f64)> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for p in points {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let scale = size.recip();
    if !(size > 0.0 && scale.is_finite()) {
        return None;
    }
    let middle = [0, 1, 2].map(|k| 0.5 * low[k] + 0.5 * high[k]);
    Some((points.iter().map(|p| [0, 1, 2].map(|k| (p[k] - middle[k]) * scale)).collect(), scale))
}

/// Whether a triangle is so flat, in a surface of size 1, that rounding gave it all the height it has.
fn is_line([a, b, c]: [[f64; 3]; 3]) -> bool {
    let [first, second, third] = [sub(b, a), sub(c, a), sub(c, b)];
    let longest = [first, second, third].map(length).into_iter().fold(0.0, f64::max);
    length(cross(first, second)) <= ROUNDED_HEIGHT * longest
}

/// What vertices of a model at its boundary are taken for where that meets itself.
pub(super) fn stitches_of(model: &Model) -> Option<Vec<u32>> {
    let soup = Soup::glued(model, &model.triangles(), None, &mut RepairLog::default(), Watch::NONE);
    unwatched(soup).stitches(model.points())
}

fn note_isolated(model: &Model, log: &mut RepairLog) {
    let mut used = vec![false; model.vertex_count()];
    model.corners().iter().for_each(|&v| used[v as usize] = true);
    for (v, _) in used.iter().enumerate().filter(|(_, used)| !**used) {
        log.note(RepairKind::IsolatedVertex, v);
    }
}

fn note_unwelded(points: &[[f64; 3]], surfaces: &[Surface], log: &mut RepairLog) {
    let mut at_place: HashMap<[u64; 3], u32> = HashMap::new();
    for surface in surfaces {
        for v in surface.mesh.vertices().filter(|&v| surface.mesh.is_boundary_vertex(v)) {
            let vertex = surface.vertex[v];
            let other = *at_place.entry(place_key(&points[vertex as usize])).or_insert(vertex);
            if other != vertex {
                log.note(RepairKind::Unwelded, vertex as usize);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn prepared(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Prepared {
        prepare(&Model::from_triangles(points.to_vec(), faces).unwrap(), Weld::Never).unwrap()
    }

    fn count(prepared: &Prepared, kind: RepairKind) -> usize {
        prepared.repairs.iter().find(|repair| repair.kind == kind).map_or(0, |repair| repair.count)
    }

    fn check(prepared: &Prepared, model: &Model) {
        for surface in &prepared.surfaces {
            surface.mesh.check();
            assert_eq!(surface.mesh.components().1, 1);
            for h in surface.mesh.halfedges() {
                let vertex = model.corners()[surface.corner[h] as usize];
                assert_eq!(surface.vertex[surface.mesh.tail(h)], vertex, "corners lead back to their vertices");
            }
        }
        let faces: usize = prepared.surfaces.iter().map(|surface| surface.mesh.face_count()).sum();
        assert_eq!(faces + prepared.left_out.len(), prepared.triangles.len(), "no triangle is lost");
    }

    fn sphere() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let shape = shapes::sphere(100);
        (shape.points, shape.triangles)
    }

    #[test]
    fn a_clean_mesh_stays_as_it_is() {
        let (points, faces) = sphere();
        let model = Model::from_triangles(points.clone(), &faces).unwrap();
        let prepared = prepare(&model, Weld::Always).unwrap();
        assert_eq!(prepared.repairs, []);
        check(&prepared, &model);
        let [surface] = &prepared.surfaces[..] else { panic!("it is connected") };
        assert_eq!(surface.mesh, Mesh::new(points.len(), &faces).unwrap());
        assert!((surface.points[0][0] / surface.points[1][0] - points[0][0] / points[1][0]).abs() < 1e-9);
    }

    #[test]
    fn a_large_surface_in_no_order_is_numbered_along_a_curve() {
        let shape = shapes::sphere(FITS_THE_CACHE);
        let n = shape.points.len();
        assert!((FITS_THE_CACHE..4 * FITS_THE_CACHE).contains(&n), "{n}");
        let share_of_far = |mesh: &Mesh| {
            let far = mesh.edges().map(|e| mesh.ends(e)).filter(|[a, b]| a.0.abs_diff(b.0) > 1000).count();
            far as f64 / mesh.edge_count() as f64
        };
        // The k-th vertex becomes vertex 3,163 k mod n.
        let renumbered: Vec<usize> = (0..n).map(|k| k * 3_163 % n).collect();
        let mut points = vec![[0.0; 3]; n];
        renumbered.iter().zip(&shape.points).for_each(|(&to, &p)| points[to] = p);
        assert!(points.iter().all(|p| *p != [0.0; 3]), "every number is taken");
        let mut faces: Vec<[u32; 3]> =
            shape.triangles.iter().map(|t| t.map(|v| renumbered[v as usize] as u32)).collect();
        let half = faces.split_off(faces.len() / 2);
        faces = half.into_iter().zip(faces).flat_map(|(a, b)| [a, b]).collect();
        let model = Model::from_triangles(points.clone(), &faces).unwrap();
        let prepared = prepare(&model, Weld::Never).unwrap();
        check(&prepared, &model);
        let surface = &prepared.surfaces[0];
        assert!(share_of_far(&Mesh::new(n, &faces).unwrap()) > 0.7);
        assert!(share_of_far(&surface.mesh) < 0.1, "{}", share_of_far(&surface.mesh));
        for v in surface.mesh.vertices() {
            let given = points[surface.vertex[v] as usize];
            assert!((0..3).all(|k| (surface.points[v.index()][k] / surface.scale - given[k]).abs() < 1e-2));
        }
    }

    #[test]
    fn a_surface_that_cannot_be_oriented_is_opened_between_polygons_only() {
        for count in 3..9_u32 {
            // A Möbius band of quads: half a turn about its centre line on the way round.
            let at = |k: u32, side: f64| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
                let (up, out) = (std::f64::consts::PI * f64::from(k) / f64::from(count)).sin_cos();
                [(2.0 + side * out) * cos, (2.0 + side * out) * sin, side * up]
            };
            let points = (0..count).flat_map(|k| [at(k, -0.5), at(k, 0.5)]).collect();
            let quad = |k: u32| match k + 1 < count {
                true => [2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2],
                false => [2 * k, 2 * k + 1, 0, 1],
            };
            let quads: Vec<[u32; 4]> = (0..count).map(quad).collect();
            let model = Model::from_polygons(points, &quads).unwrap();
            let prepared = prepare(&model, Weld::Never).unwrap();
            check(&prepared, &model);
            let [surface] = &prepared.surfaces[..] else { panic!("it is connected") };
            assert_eq!(surface.diagonal.iter().filter(|&&is_inside| is_inside).count(), quads.len(), "{count} quads");
            assert_eq!(self::count(&prepared, RepairKind::NonOrientableEdge), 1);
            assert_eq!(surface.mesh.euler_characteristic(), 1, "a strip");
        }
    }

    #[test]
    fn misoriented_faces_are_turned_to_the_majority() {
        let (points, mut faces) = sphere();
        for f in [0, 3, 17] {
            faces[f].swap(1, 2);
        }
        let model = Model::from_triangles(points.clone(), &faces).unwrap();
        let turned = prepare(&model, Weld::Never).unwrap();
        check(&turned, &model);
        assert_eq!(turned.repairs, [Repair { kind: RepairKind::FlippedFace, count: 3, first: 0 }]);
        // Inside out is consistent, too.
        faces.iter_mut().for_each(|face| face.swap(0, 2));
        let inside_out = prepared(&points, &faces);
        assert_eq!(count(&inside_out, RepairKind::FlippedFace), 3);
    }

    #[test]
    fn copies_repeated_vertices_and_isolated_ones_are_left_out_and_counted() {
        let (mut points, mut faces) = sphere();
        faces.extend([faces[5], [faces[7][0], faces[7][2], faces[7][1]], [1, 1, 2]]);
        points.push([9.0, 9.0, 9.0]);
        let model = Model::from_triangles(points.clone(), &faces).unwrap();
        let mended = prepare(&model, Weld::Never).unwrap();
        check(&mended, &model);
        assert_eq!(count(&mended, RepairKind::DuplicateFace), 2);
        assert_eq!(count(&mended, RepairKind::RepeatedVertex), 1);
        assert_eq!(count(&mended, RepairKind::IsolatedVertex), 1);
        assert_eq!(mended.surfaces.len(), 1);
        assert_eq!(mended.surfaces[0].mesh.euler_characteristic(), 2);
        assert_eq!(mended.left_out.len(), 3);
    }

    #[test]
    fn surfaces_are_opened_at_edges_with_too_many_faces_and_at_vertices_with_several_fans() {
        // Two tetrahedra with an edge in common, then with a vertex in common.
        let points: Vec<[f64; 3]> =
            (0..7).map(|k| [f64::from(k * k % 7), f64::from(k % 3), f64::from(k * 3 % 5)]).collect();
        let tetrahedron = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d], [a, d, b], [b, d, c]];
        for (second, edges, vertices, parts) in [([0, 1, 4, 5], 1, 0, 1), ([0, 4, 5, 6], 0, 1, 2)] {
            let faces = [tetrahedron([0, 1, 2, 3]), tetrahedron(second)].concat();
            let used = 1 + faces.iter().flatten().max().unwrap();
            let model = Model::from_triangles(points[..used as usize].to_vec(), &faces).unwrap();
            let opened = prepare(&model, Weld::Never).unwrap();
            check(&opened, &model);
            assert_eq!(count(&opened, RepairKind::NonManifoldEdge), edges);
            assert!(count(&opened, RepairKind::NonManifoldVertex) >= vertices);
            assert!(opened.surfaces.len() >= parts);
        }
    }

    #[test]
    fn a_polygon_stays_in_one_piece_where_others_share_its_diagonal() {
        // A quad, and two triangles on each of its diagonals.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let tips = [[0.5, 0.5, 1.0], [0.5, 0.4, -1.0], [0.6, 0.5, 2.0], [0.4, 0.5, -2.0]];
        let faces: [&[u32]; 5] = [&[0, 1, 2, 3], &[0, 2, 4], &[2, 0, 5], &[1, 3, 6], &[3, 1, 7]];
        let model = Model::from_polygons([&points[..], &tips].concat(), faces).unwrap();
        let prepared = prepare(&model, Weld::Never).unwrap();
        check(&prepared, &model);
        let of_quad = |s: &Surface| s.corner.iter().filter(|&&c| c < 4).count();
        assert_eq!(prepared.surfaces.iter().map(of_quad).filter(|&sides| sides > 0).collect::<Vec<_>>(), [6]);
        assert!(prepared.surfaces.iter().any(|s| s.diagonal.iter().any(|&inside| inside)));
        assert_eq!(count(&prepared, RepairKind::NonManifoldEdge), 0);
    }

    #[test]
    fn a_polygon_stays_in_one_piece_where_a_triangle_covers_a_part_of_it() {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
        let faces: [&[u32]; 3] = [&[0, 1, 2], &[0, 2, 4], &[0, 1, 2, 3]];
        let model = Model::from_polygons(points.clone(), faces).unwrap();
        let prepared = prepare(&model, Weld::Never).unwrap();
        check(&prepared, &model);
        let of_quad = |s: &Surface| s.corner.iter().filter(|&&c| c >= 6).count();
        assert_eq!(prepared.surfaces.iter().map(of_quad).filter(|&sides| sides > 0).collect::<Vec<_>>(), [6]);
        assert!(prepared.left_out.is_empty());
        // A copy of the whole polygon is left out as before.
        let faces: [&[u32]; 3] = [&[0, 1, 2, 3], &[0, 2, 4], &[0, 1, 2, 3]];
        let copied = prepare(&Model::from_polygons(points, faces).unwrap(), Weld::Never).unwrap();
        assert_eq!((count(&copied, RepairKind::DuplicateFace), &copied.left_out[..]), (2, &[3, 4][..]));
    }

    #[test]
    fn points_on_a_slanted_line_are_no_surface_however_they_are_rounded() {
        let points: Vec<[f64; 3]> = (0..12).map(|k| [0.1, 0.7, 0.3].map(|x| x * f64::from(k))).collect();
        let faces: Vec<[u32; 3]> = (0..10).map(|k| [k, k + 1, k + 2]).collect();
        let line = Model::from_triangles(points, &faces).unwrap();
        assert_eq!(prepare(&line, Weld::Never).unwrap_err(), PrepareError::NoArea { faces: 10 });
    }

    #[test]
    fn a_moebius_strip_is_opened_where_it_cannot_be_oriented() {
        let n = 12u32;
        let points: Vec<[f64; 3]> = (0..2 * n)
            .map(|k| {
                let around = std::f64::consts::TAU * f64::from(k / 2) / f64::from(n);
                let across = if k % 2 == 0 { 0.3 } else { -0.3 };
                let radius = 1.0 + across * (0.5 * around).cos();
                [radius * around.cos(), radius * around.sin(), across * (0.5 * around).sin()]
            })
            .collect();
        let faces: Vec<[u32; 3]> = (0..n)
            .flat_map(|k| {
                let [a, b] = [2 * k, 2 * k + 1];
                let [c, d] = if k + 1 < n { [a + 2, b + 2] } else { [1, 0] };
                [[a, b, c], [b, d, c]]
            })
            .collect();
        let model = Model::from_triangles(points, &faces).unwrap();
        let opened = prepare(&model, Weld::Never).unwrap();
        check(&opened, &model);
        assert!(count(&opened, RepairKind::NonOrientableEdge) > 0);
        assert_eq!(opened.surfaces[0].mesh.euler_characteristic(), 1);
    }

    #[test]
    fn unwelded_vertices_are_reported_and_welded_on_request() {
        let (points, faces) = sphere();
        let soup: Vec<[f64; 3]> = faces.iter().flatten().map(|&v| points[v as usize]).collect();
        let apart: Vec<[u32; 3]> = (0..faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let model = Model::from_triangles(soup, &apart).unwrap();
        let loose = prepare(&model, Weld::Never).unwrap();
        check(&loose, &model);
        assert_eq!(loose.surfaces.len(), faces.len());
        assert_eq!(count(&loose, RepairKind::Unwelded), 3 * faces.len() - points.len());
        let welded = prepare(&model, Weld::Always).unwrap();
        assert_eq!(welded.surfaces.len(), 1);
        assert_eq!(welded.surfaces[0].mesh.euler_characteristic(), 2);
        assert_eq!(count(&welded, RepairKind::Welded), 3 * faces.len() - points.len());
    }

    #[test]
    fn triangles_without_area_are_given_some_and_a_mesh_without_any_is_refused() {
        let points = [[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let flat = prepared(&points, &[[0, 1, 2], [0, 2, 3], [2, 1, 3]]);
        assert_eq!(count(&flat, RepairKind::ZeroArea), 1);
        let surface = &flat.surfaces[0];
        let metric = surface.metric();
        assert!(surface.mesh.faces().all(|f| metric.sides(&surface.mesh, f).area() > 0.0));
        let line = Model::from_triangles(points[..3].to_vec(), &[[0, 1, 2]]).unwrap();
        assert_eq!(prepare(&line, Weld::Never).unwrap_err(), PrepareError::NoArea { faces: 1 });
    }

    #[test]
    fn size_and_place_do_not_matter() {
        let (points, faces) = sphere();
        for (scale, offset) in [(1e-160, 0.0), (1e150, 0.0), (1.0, 1e6)] {
            let moved: Vec<[f64; 3]> = points.iter().map(|p| p.map(|x| scale * x + offset)).collect();
            let prepared = prepared(&moved, &faces);
            let reference = self::prepared(&points, &faces);
            let [a, b] = [&prepared, &reference].map(|p| p.surfaces[0].metric());
            let worst =
                a.lengths().iter().zip(b.lengths().iter()).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-15 * (1.0 + 1e4 * offset), "scale {scale}, offset {offset}: {worst}");
        }
    }
}
