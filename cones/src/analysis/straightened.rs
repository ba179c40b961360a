//! Seams of refined models made straight.
//!
//! Seams run along edges, and even triangles have none that go straight on. Once there is a map, its seams are made geodesics, which the model is refined
//! with once more, and flattened with the same cones: so seams are as straight as the surface lets them be, and what they cut is the same.

use std::collections::{HashMap, HashSet, VecDeque};
use std::sync::Arc;

use geom::vector::{angle, normal};
use geom::{EdgeData, FaceData, HalfedgeId, Mesh, StraightPath, VertexData, VertexId, edges_at};

use super::Analysis;
use super::atlas::{Atlas, CutEdge};
use super::component::{Component, OnSurface};
use super::finer::{Distortion, MOST_VERTICES};
use super::note::Note;
use super::observer::Times;
use super::options::{ConeChoice, Options, Recipe};
use super::refined::StraightPaths;
use crate::error::Error;

/// Seams stay where they are along edges that bend by more than this.
const SHARP: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// So often at most is a map made with straight seams: with all, with others than those in the way, with none on components where some are.
const ROUNDS: usize = 3;
/// Distortions may become larger by this share: triangles are others.
const AS_GOOD: f64 = 1.01;

/// What an edge of a surface is to seams.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SeamEdge {
    is_loop: bool,
    is_sharp: bool,
}

/// What a map is like on one component.
#[derive(Clone, Default)]
struct OnPart {
    islands: HashSet<u32>,
    detached: usize,
    overlaps: bool,
    is_torn: bool,
}

impl Analysis {
    /// The analysis and its map, or those of the same model refined so that seams are straight, on the components where they can be. `made` takes what is to be straight on
    /// each surface.
    pub(super) fn or_straight(
        self,
        mut atlas: Atlas,
        options: &Options,
        made: impl Fn(&[StraightPaths]) -> Result<Self, Error>,
    ) -> Result<(Self, Atlas), Error> {
        let Some(mut paths) = self.straight_paths(&atlas, options) else { return Ok((self, atlas)) };
        let before = self.on_parts(&atlas);
        let mut tried = Times::default();
        for round in 0..ROUNDS {
            if !paths.iter().any(StraightPaths::are_worth_it) {
                break;
            }
            let other = match made(&paths) {
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                Err(_) => break,
                Ok(other) => other,
            };
            tried += other.times();
            // Where refining did not end.
            for (paths, component) in paths.iter_mut().zip(other.components()) {
                paths.stay |= component.straight.as_ref().is_some_and(|straight| straight.stay);
            }
            if !paths.iter().any(StraightPaths::are_worth_it) {
                break;
            }
            let mut map = match self.mapped_straight(&other, &atlas, options) {
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                Err(_) => break,
                Ok(map) => map,
            };
            let after = other.on_parts(&map);
            let is_torn = before.iter().zip(&after).any(|(before, after)| before.tears(after));
            if !is_torn && self.is_as_good(&atlas, (&other, &map), options.cones.wanted()) {
                [self.times(), tried, atlas.times].into_iter().for_each(|times| map.times += times);
                return Ok((other, map));
            }
            tried += map.times;
            // What is in the way stays as it is: seams beside overlaps, or the loops of handles; then all of the component.
            let mut is_in_way: Vec<bool> =
                before.iter().zip(&after).map(|(before, after)| before.tears(after)).collect();
            if !is_torn {
                is_in_way = self.more_distorted((&atlas, options.cones.wanted()), (&other, &map));
            }
            let taken = paths.clone();
            for part in (0..paths.len()).filter(|&part| is_in_way[part]) {
                let in_way = match before[part].is_in_fewer_pieces(&after[part]) {
                    true => other.paths_near_overlaps(part, &map),
                    false => (0..paths[part].paths.len()).filter(|&path| paths[part].is_loop[path]).collect(),
                };
                match round == 0 && !in_way.is_empty() {
                    true => paths[part] = paths[part].left(|path| in_way.contains(&path)),
                    false => paths[part].stay = true,
                }
            }
            if paths == taken {
                break;
            }
        }
        atlas.times += tried;
        Ok((self, atlas))
    }

    /// What a map is like on each component.
    fn on_parts(&self, atlas: &Atlas) -> Vec<OnPart> {
        let mut on = vec![OnPart::default(); self.components().len()];
        let part_of = self.triangle_components();
        for (part, island) in part_of.iter().zip(&atlas.islands) {
            if let (Some(part), Some(island)) = (part, island) {
                on[*part].islands.insert(*island);
            }
        }
        let detached = atlas.detached.iter().filter_map(|&t| part_of[t as usize]);
        detached.for_each(|part| on[part].detached += 1);
        atlas.torn.iter().for_each(|&part| on[part].is_torn = true);
        let overlaps = atlas.notes.iter().filter(|note| matches!(note, Note::Overlap { .. }));
        overlaps.filter_map(Note::component).for_each(|part| on[part].overlaps = true);
        on
    }

    /// The components that another map distorts more, each for itself; all where none is.
    fn more_distorted(&self, (before, target): (&Atlas, Option<f64>), (other, after): (&Self, &Atlas)) -> Vec<bool> {
        let [was, is] = [(self, before), (other, after)].map(|(analysis, atlas)| analysis.distortion_of_parts(atlas));
        let is_more = |(was, is): (&Option<Distortion>, &Option<Distortion>)| match (was, is) {
            (Some(was), Some(is)) => !was.is_kept_by(is, target),
            _ => true,
        };
        let are_more: Vec<bool> = was.iter().zip(&is).map(is_more).collect();
        if are_more.contains(&true) { are_more } else { vec![true; are_more.len()] }
    }

    /// The paths of a component that are nearest to what lay over itself before islands were parted.
    fn paths_near_overlaps(&self, part: usize, atlas: &Atlas) -> HashSet<usize> {
        let component = &self.components()[part];
        let Some(straight) = &component.straight else { return HashSet::new() };
        let mesh = &component.surface.mesh;
        let mut nearest: FaceData<Option<u32>> = FaceData::constant(mesh.face_count(), None);
        let mut queue: VecDeque<HalfedgeId> = mesh.halfedges().collect();
        queue.retain(|&h| straight.path[mesh.edge(h)].is_some());
        for &h in &queue {
            nearest[mesh.face(h)] = straight.path[mesh.edge(h)];
        }
        while let Some(h) = queue.pop_front() {
            for side in mesh.sides(mesh.face(h)) {
                let Some(beyond) = mesh.twin(side).filter(|&g| nearest[mesh.face(g)].is_none()) else { continue };
                nearest[mesh.face(beyond)] = nearest[mesh.face(h)];
                queue.push_back(beyond);
            }
        }
        let overlapped = atlas.overlapped.iter().filter(|(of, _)| *of == part);
        overlapped.filter_map(|&(_, f)| nearest[f]).map(|path| path as usize).collect()
    }

    /// What is to be straight of the seams of a map, on each component; none where seams are to stay as they are.
    fn straight_paths(&self, atlas: &Atlas, options: &Options) -> Option<Vec<StraightPaths>> {
        let vertices: usize = self.components().iter().map(|component| component.surface.mesh.vertex_count()).sum();
        let refined = self.refined()?;
        // Whoever says where cones or seams are has the last word. Limbs that were cut off are surfaces of their own.
        let is_asked = !options.seams.names_edges() && !options.cones.is_given();
        if !is_asked || atlas.necks > 0 || vertices > MOST_VERTICES {
            return None;
        }
        let seams = self.seam_edges(atlas);
        let mut is_cone: Vec<_> =
            self.components().iter().map(|c| VertexData::constant(c.closed().vertex_count(), false)).collect();
        for (component, on) in self.components().iter().zip(self.on_surface(&atlas.recipe.cones).ok()?) {
            on.iter().for_each(|&(v, ..)| is_cone[component.index][component.vertex_closed(v)] = true);
        }
        let on_parts = self.on_parts(atlas);
        let paths_of = |(component, seams): (&Arc<Component>, EdgeData<Option<SeamEdge>>)| {
            let part = component.index;
            // One that was not refined will not be, and where refining did not end, or the map is torn, nothing is done.
            let is_uneven = component.way.is_none() || !refined.is_even(part);
            match is_uneven || on_parts[part].is_torn || on_parts[part].detached > 0 {
                true => StraightPaths::default(),
                false => StraightPaths::of(component.closed(), &seams, &is_cone[part]),
            }
        };
        Some(self.components().iter().zip(seams).map(paths_of).collect())
    }

    /// The edges of each component, its handles closed, that seams of a map run along.
    fn seam_edges(&self, atlas: &Atlas) -> Vec<EdgeData<Option<SeamEdge>>> {
        let none = |component: &Arc<Component>| EdgeData::constant(component.closed().edge_count(), None);
        let mut seams: Vec<EdgeData<Option<SeamEdge>>> = self.components().iter().map(none).collect();
        for &CutEdge { component: part, halfedge: h, is_loop } in &atlas.cut {
            let component = &self.components()[part];
            let is_sharp = self.bend(component, h) > SHARP;
            seams[part][component.closed().edge(h)] = Some(SeamEdge { is_loop, is_sharp });
        }
        seams
    }

    /// The angle between the triangles of the model on both sides of a halfedge: 0 where it crosses others.
    fn bend(&self, component: &Component, h: HalfedgeId) -> f64 {
        let (mesh, vertex) = (&component.surface.mesh, &component.surface.vertex);
        let ends = [mesh.tail(h), mesh.head(h)].map(|v| vertex[v]);
        let point = |v: u32| self.points()[v as usize];
        let normal_beside = |h: HalfedgeId, [a, b]: [u32; 2]| {
            let corners = |&t: &u32| self.triangles().corners[t as usize].map(|c| self.corner_vertices()[c as usize]);
            let pieces = component.triangles_of(mesh.face(h)).iter().map(corners);
            let beyond = pieces.filter(|piece| piece.contains(&a) && piece.contains(&b));
            let beyond = beyond.flatten().find(|&v| v != a && v != b)?;
            Some(normal([a, b, beyond].map(point)))
        };
        let [a, b] = ends;
        let normals = (normal_beside(h, [a, b]), component.closed().twin(h).and_then(|g| normal_beside(g, [b, a])));
        if let (Some(one), Some(other)) = normals { angle(one, other) } else { 0.0 }
    }

    /// The map with the same cones of another analysis, whose seams are straight.
    fn mapped_straight(&self, other: &Self, atlas: &Atlas, options: &Options) -> Result<Atlas, Error> {
        let on = self.on_surface(&atlas.recipe.cones)?;
        let now = |part: usize, v: VertexId| {
            let v = self.components()[part].vertex_closed(v);
            let v = other.refined().map_or(Some(v), |refined| refined.now(part, v))?;
            Some(other.components()[part].vertex_opened(v))
        };
        let of_part = |(part, cones): (usize, &Vec<OnSurface>)| {
            let now = |&(v, _, curvature): &OnSurface| Some((now(part, v)?, curvature.unwrap_or_default()));
            cones.iter().filter_map(now).unzip()
        };
        let cones: Vec<(Vec<VertexId>, Vec<f64>)> = on.iter().enumerate().map(of_part).collect();
        let faces_now = |faces: &[u32]| -> Vec<u32> {
            let parts = self.parts_of(faces);
            let components = other.components().iter().filter(|component| parts.contains(&component.index));
            components.map(|component| other.first_face(component)).collect()
        };
        let mut recipe = Recipe {
            opened: faces_now(&atlas.recipe.opened),
            freed: faces_now(&atlas.recipe.freed),
            straight: true,
            target: atlas.recipe.target,
            ..other.recipe(cones.iter().map(|(vertices, curvatures)| (&vertices[..], &curvatures[..])))
        };
        if !recipe.opened.is_empty() && options.quantize.is_none() {
            // Loops along geodesics are others, and what is best for their cones.
            recipe.cones.iter_mut().for_each(|cone| cone.curvature = None);
        }
        let options = Options { cones: ConeChoice::Recipe(Box::new(recipe)), ..options.clone() };
        let mut map = other.atlas(&options)?;
        map.recipe.straight = true;
        let mut number: HashMap<u32, u32> = HashMap::new();
        for (part, (one, other)) in self.components().iter().zip(other.components()).enumerate() {
            let vertices = one.surface.vertex.iter_ids();
            number.extend(vertices.filter_map(|(v, &vertex)| Some((vertex, other.surface.vertex[now(part, v)?]))));
        }
        let own = |vertex: u32| number.get(&vertex).copied().unwrap_or(vertex);
        for note in atlas.notes.iter().filter(|note| note.is_of_cones()) {
            let note = match note.component() {
                Some(component) => note.clone().said_of(component, own),
                None => note.clone(),
            };
            if !map.notes.contains(&note) {
                map.notes.push(note);
            }
        }
        let areas = other.measures(&map).map(|measured| measured.area.mean);
        map.number = atlas.number.clone().map(|number| areas.map_or(number.clone(), |areas| number.judged(areas)));
        Ok(map)
    }

    /// Whether a map with straight seams is as good as the one before.
    fn is_as_good(&self, before: &Atlas, (other, after): (&Self, &Atlas), target: Option<f64>) -> bool {
        let measures = [self.measures(before), other.measures(after)].map(|measured| Some(Distortion::of(&measured?)));
        let [Some(distorted), Some(now)] = measures else { return false };
        let turns_less = after.seam_figures.turning < before.seam_figures.turning;
        after.opened_handles == before.opened_handles && distorted.is_kept_by(&now, target) && turns_less
    }
}

impl Distortion {
    /// Whether that of another map is hardly larger, and meets the target if this one does.
    fn is_kept_by(&self, now: &Self, target: Option<f64>) -> bool {
        let meets = |areas: f64| target.is_none_or(|target| areas <= target);
        now.areas <= AS_GOOD * self.areas
            && now.angles <= AS_GOOD * self.angles
            && (meets(now.areas) || !meets(self.areas))
    }
}

impl OnPart {
    /// Whether another map is in more pieces here.
    fn is_in_fewer_pieces(&self, other: &Self) -> bool {
        other.islands.len() > self.islands.len()
    }

    /// Whether another map tears here what this one does not.
    fn tears(&self, other: &Self) -> bool {
        let is_worse = |was: bool, is: bool| is && !was;
        self.is_in_fewer_pieces(other)
            || other.detached > self.detached
            || is_worse(self.is_torn, other.is_torn)
            || is_worse(self.overlaps, other.overlaps)
    }
}

impl StraightPaths {
    /// Whether some path can become straighter.
    fn are_worth_it(&self) -> bool {
        !self.stay && self.paths.iter().any(|path| path.halfedges.len() > 1)
    }

    /// The same, some of them left as they are: edge by edge.
    fn left(&self, is_left: impl Fn(usize) -> bool) -> Self {
        let mut left = Self::default();
        for (number, (path, &is_loop)) in self.paths.iter().zip(&self.is_loop).enumerate() {
            let edges = || path.halfedges.iter().map(|&h| StraightPath { halfedges: vec![h], may_slide: false });
            let parts: Vec<StraightPath> = if is_left(number) { edges().collect() } else { vec![path.clone()] };
            left.is_loop.resize(left.is_loop.len() + parts.len(), is_loop);
            left.paths.extend(parts);
        }
        left
    }

    /// Seams of a surface as paths between cones, the boundary and the places where they meet or become sharp.
    fn of(mesh: &Mesh, seams: &EdgeData<Option<SeamEdge>>, is_cone: &VertexData<bool>) -> Self {
        let at = |v: VertexId| edges_at(mesh, v).filter_map(|(e, _)| seams[e]);
        let is_end = |v: VertexId| {
            let mut kinds = at(v);
            let alike = (kinds.next(), kinds.next(), kinds.next());
            let goes_on = matches!(alike, (Some(one), Some(other), None) if one == other && !one.is_sharp);
            is_cone[v] || mesh.is_boundary_vertex(v) || !goes_on
        };
        let mut is_done = EdgeData::constant(mesh.edge_count(), false);
        let mut found = Self::default();
        let is_seam = |h: HalfedgeId| seams[mesh.edge(h)].is_some();
        // From ends first; what is left are closed loops, which may begin anywhere.
        let ends = mesh.vertices().filter(|&v| is_end(v));
        for v in ends.chain(mesh.vertices()) {
            for first in mesh.outgoing(v).filter(|&h| is_seam(h)) {
                if is_done[mesh.edge(first)] {
                    continue;
                }
                let mut path = vec![first];
                is_done[mesh.edge(first)] = true;
                let mut head = mesh.head(first);
                while head != v && !is_end(head) {
                    let Some(next) = mesh.outgoing(head).find(|&h| is_seam(h) && !is_done[mesh.edge(h)]) else { break };
                    is_done[mesh.edge(next)] = true;
                    path.push(next);
                    head = mesh.head(next);
                }
                let is_loop = seams[mesh.edge(first)].is_some_and(|edge| edge.is_loop);
                found.is_loop.push(is_loop);
                // A loop is to stay closed.
                found.paths.push(StraightPath { halfedges: path, may_slide: !is_loop });
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::observer::Silent;
    use crate::{FreeSeams, Islands, Preparation, Refining, SeamOptions};
    use geom::Model;
    use geom::shapes::{self, Shape};

    fn options(count: usize) -> Options {
        let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
        Options { preparation, cones: ConeChoice::Count(count), free_seams: FreeSeams::Never, ..Options::default() }
    }

    /// The maps of a refined model with seams along its edges and with straight ones.
    fn maps(model: &Model, options: &Options) -> [(Analysis, Atlas); 2] {
        let analysis = Analysis::with(model, options.preparation).unwrap();
        let atlas = analysis.atlas(options).unwrap();
        let made = |paths: &[StraightPaths]| {
            let making = analysis.found.making;
            Analysis::made(model, making, (&HashSet::new(), None, paths), std::sync::Arc::new(Silent))
        };
        let straight = analysis.clone().or_straight(atlas.clone(), options, made).unwrap();
        [(analysis.clone(), atlas), straight]
    }

    /// Two surfaces as one model.
    fn beside(one: &Shape, other: &Shape) -> Shape {
        let first = one.points.len() as u32;
        let points = one.points.iter().copied().chain(other.points.iter().map(|p| [p[0] + 9.0, p[1], p[2]]));
        let triangles = one.triangles.iter().copied().chain(other.triangles.iter().map(|t| t.map(|v| first + v)));
        Shape { points: points.collect(), triangles: triangles.collect() }
    }

    fn is_alike(before: &(Analysis, Atlas), after: &(Analysis, Atlas)) {
        is_alike_but(before, after, 0.5);
    }

    /// As good a map, whose seams turn less than this share.
    fn is_alike_but(before: &(Analysis, Atlas), after: &(Analysis, Atlas), share: f64) {
        assert!(after.1.recipe.straight, "it was not made");
        let [was, is] = [&before.1, &after.1];
        assert!(
            is.seam_figures.turning < share * was.seam_figures.turning,
            "{:?}",
            (is.seam_figures, was.seam_figures)
        );
        assert!(is.seam_figures.length < was.seam_figures.length && is.seam_figures.mean_mismatch() < 1e-6);
        assert_eq!(is.cones.len(), was.cones.len());
        assert_eq!((is.island_count(), is.detached.len()), (was.island_count(), 0));
        assert_eq!(is.opened_handles, was.opened_handles);
        let [measured, now] =
            [before, after].map(|(analysis, atlas)| Distortion::of(&analysis.measures(atlas).unwrap()));
        assert!(now.areas <= AS_GOOD * measured.areas && now.angles <= AS_GOOD * measured.angles);
        // Cones are where they were.
        let places = |atlas: &Atlas| {
            let mut places: Vec<[u64; 3]> = atlas.cones.iter().map(|cone| cone.position.map(f64::to_bits)).collect();
            places.sort_unstable();
            places
        };
        assert_eq!(places(is), places(was));
    }

    #[test]
    fn seams_of_a_refined_surface_turn_less_and_cut_the_same() {
        let [before, after] = maps(&shapes::sphere(500).into(), &options(8));
        is_alike(&before, &after);
        // What is cut are the straight paths.
        let component = &after.0.components()[0];
        let straight = component.straight.as_ref().unwrap();
        let seams = after.0.seam_edges(&after.1);
        assert!(component.surface.mesh.edges().all(|e| seams[0][e].is_some() == straight.path[e].is_some()));
    }

    #[test]
    fn handles_are_opened_along_straight_loops_and_what_was_found_makes_the_same_map_again() {
        let model = shapes::torus(3, 1000).into();
        let (analysis, atlas) = Analysis::unwrapped(&model, &options(4), Silent).unwrap();
        assert_eq!((atlas.opened_handles, atlas.island_count()), (3, 1));
        assert!(atlas.recipe.straight && atlas.recipe.vertices == Some(analysis.points().len()));
        let again = ConeChoice::Recipe(Box::new(atlas.recipe().clone()));
        let (_, again) = Analysis::unwrapped(&model, &Options { cones: again, ..options(4) }, Silent).unwrap();
        assert_eq!(again.uv, atlas.uv);
    }

    #[test]
    fn a_part_where_refining_does_not_end_stays_as_it_was_and_others_become_straight() {
        let model = beside(&shapes::sphere(500), &shapes::hare(700)).into();
        let options = Options { cones: ConeChoice::Each(vec![6, 8]), ..options(0) };
        let analysis = Analysis::with(&model, options.preparation).unwrap();
        let atlas = analysis.atlas(&options).unwrap();
        let made = |paths: &[StraightPaths]| {
            let mut paths = paths.to_vec();
            // Such a path does not run through the triangulation, and where one does not, refining is not complete.
            paths[1].paths.iter_mut().for_each(|path| path.halfedges.reverse());
            let making = analysis.found.making;
            Analysis::made(&model, making, (&HashSet::new(), None, &paths), std::sync::Arc::new(Silent))
        };
        let after = analysis.clone().or_straight(atlas.clone(), &options, made).unwrap();
        let stay = |part: usize| after.0.components()[part].straight.as_ref().unwrap().stay;
        assert!(after.0.refined().unwrap().is_complete && !stay(0) && stay(1));
        let seams = |analysis: &Analysis, atlas: &Atlas| {
            let seams = analysis.seam_edges(atlas).swap_remove(1);
            seams.iter().map(Option::is_some).collect::<Vec<_>>()
        };
        assert_eq!(seams(&after.0, &after.1), seams(&analysis, &atlas));
        is_alike_but(&(analysis, atlas), &after, 0.9);
    }

    #[test]
    fn a_part_whose_map_is_torn_stays_as_it_was() {
        let model = beside(&shapes::sphere(500), &shapes::hare(700)).into();
        let options = Options { cones: ConeChoice::Each(vec![6, 8]), ..options(0) };
        let analysis = Analysis::with(&model, options.preparation).unwrap();
        let atlas = analysis.atlas(&options).unwrap();
        let worth = |atlas: &Atlas| {
            let paths = analysis.straight_paths(atlas, &options).unwrap();
            paths.iter().map(StraightPaths::are_worth_it).collect::<Vec<_>>()
        };
        assert_eq!(worth(&atlas), [true, true]);
        assert_eq!(worth(&Atlas { torn: vec![0], freed: 1, ..atlas.clone() }), [false, true]);
        let part_of = analysis.triangle_components();
        let of_second = part_of.iter().position(|&part| part == Some(1)).unwrap();
        assert_eq!(worth(&Atlas { detached: vec![of_second as u32], ..atlas.clone() }), [true, false]);
    }

    #[test]
    fn bodies_that_touch_have_their_own_seams() {
        // Two cubes with an edge in common, along which both are cut.
        let corner = |k: u32| [f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)];
        let mut points: Vec<[f64; 3]> = (0..8).map(corner).collect();
        points.extend((0..8).filter(|k| k & 3 != 0).map(corner).map(|[x, y, z]| [1.0 + x, 1.0 + y, z]));
        let of_second = [3, 8, 9, 10, 7, 11, 12, 13];
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let both = quads.iter().copied().chain(quads.map(|quad| quad.map(|k: u32| of_second[k as usize])));
        let triangles: Vec<[u32; 3]> = both.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let model = Model::from_triangles(points, &triangles).unwrap();
        let seams = SeamOptions { given: vec![[3, 7]], ..SeamOptions::default() };
        let options = Options { seams, cones: ConeChoice::Each(vec![8, 8]), ..options(0) };
        let making = Analysis::with(&model, options.preparation).unwrap().found.making;
        let named = HashSet::from([[3, 7]]);
        let analysis = Analysis::made(&model, making, (&named, None, &[]), std::sync::Arc::new(Silent)).unwrap();
        assert_eq!(analysis.components().len(), 2);
        let atlas = analysis.atlas(&options).unwrap();
        for (component, seams) in analysis.components().iter().zip(analysis.seam_edges(&atlas)) {
            let mesh = &component.surface.mesh;
            let edges: Vec<_> = mesh.edges().filter(|&e| seams[e].is_some()).collect();
            let vertices: HashSet<VertexId> = edges.iter().flat_map(|&e| mesh.ends(e)).collect();
            assert!(!edges.is_empty() && vertices.len() == edges.len() + 1, "a tree leaves a disk");
        }
    }

    #[test]
    fn seams_are_straight_where_all_handles_are_to_be_opened() {
        let model = shapes::torus(3, 1000).into();
        let mut options = options(4);
        options.preparation.handles = crate::Handles::Always;
        let [before, after] = maps(&model, &options);
        is_alike(&before, &after);
        assert_eq!(after.1.opened_handles, 3);
        // What was found makes the same map again.
        let (_, atlas) = Analysis::unwrapped(&model, &options, Silent).unwrap();
        assert!(atlas.recipe.straight);
        let again = ConeChoice::Recipe(Box::new(atlas.recipe().clone()));
        let (_, again) = Analysis::unwrapped(&model, &Options { cones: again, ..options }, Silent).unwrap();
        assert_eq!(again.uv, atlas.uv);
    }

    #[test]
    fn whoever_names_edges_or_cones_has_the_last_word() {
        let model: Model = shapes::hare(1500).into();
        let [a, b, ..] = model.face(0) else { unreachable!("a face has three corners") };
        let seams = SeamOptions { avoid: vec![[*a, *b]], ..SeamOptions::default() };
        let given = ConeChoice::Given(vec![(0, None), (40, None), (400, None), (1000, None)]);
        let named = Options { seams, ..options(8) };
        for options in [named, Options { cones: given, ..options(8) }] {
            let [(_, before), (_, after)] = maps(&model, &options);
            assert!(!after.recipe.straight);
            assert_eq!(before.seams, after.seams);
        }
        // What lies over itself is not to be in more pieces.
        let single = Options { islands: Islands::Single, ..options(24) };
        let [(_, before), (_, after)] = maps(&model, &single);
        assert_eq!(before.island_count(), after.island_count());
    }
}
