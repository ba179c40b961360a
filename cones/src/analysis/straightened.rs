//! Seams of refined models made straight.
//!
//! Seams run along edges, and even triangles have none that go straight on. Once there is a map, its seams are made geodesics, which the model is refined
//! with once more, and flattened with the same cones: so seams are as straight as the surface lets them be, and what they cut is the same.

use std::collections::{HashMap, HashSet, VecDeque};

use geom::vector::{angle, normal};
use geom::{EdgeData, EdgeId, FaceData, HalfedgeId, Mesh, StraightPath, VertexData, VertexId, edges_at};

use super::Analysis;
use super::atlas::Atlas;
use super::component::{Component, OnSurface};
use super::finer::{Distortion, MOST_VERTICES};
use super::note::Note;
use super::observer::Times;
use super::options::{ConeChoice, Options, Recipe};
use super::refined::StraightPaths;
use crate::cut::ascending;
use crate::error::Error;

/// Seams stay where they are along edges that bend by more than this.
const SHARP: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// So often at most is a map made with straight seams: with all, with others than those in the way, with none of components where some are.
const ROUNDS: usize = 3;
/// Distortions may become larger by this share: triangles are others.
const AS_GOOD: f64 = 1.01;

/// What an edge of a surface is to seams.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SeamEdge {
    is_loop: bool,
    is_sharp: bool,
}

impl Analysis {
    /// The analysis and its map, or those of the same model refined so that seams are straight. `made` takes what is to be straight on each surface.
    pub(super) fn or_straight(
        self,
        mut atlas: Atlas,
        options: &Options,
        made: impl Fn(&[StraightPaths]) -> Result<Self, Error>,
    ) -> Result<(Self, Atlas), Error> {
        let Some(mut paths) = self.straight_paths(&atlas, options) else { return Ok((self, atlas)) };
        let mut tried = Times::default();
        for round in 0..ROUNDS {
            if !paths.iter().any(StraightPaths::are_worth_it) {
                break;
            }
            let other = match made(&paths) {
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                // Where refining did not end triangles may be any.
                Ok(other) if other.refined().is_some_and(|refined| refined.is_complete) => other,
                _ => break,
            };
            tried += other.times();
            let mut map = match self.mapped_straight(&other, &atlas, options) {
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                Err(_) => break,
                Ok(map) => map,
            };
            let in_pieces = self.more_in_pieces(&atlas, (&other, &map));
            if in_pieces.is_empty() && self.is_as_good(&atlas, (&other, &map), options.cones.wanted()) {
                [self.times(), tried, atlas.times].into_iter().for_each(|times| map.times += times);
                return Ok((other, map));
            }
            tried += map.times;
            // What is in the way stays as it is: seams beside overlaps, then all of the component; or the loops of handles.
            let before = paths.clone();
            for &part in &in_pieces {
                let near = if round == 0 { other.paths_near_overlaps(part, &map) } else { HashSet::new() };
                paths[part] = paths[part].left(|path| near.is_empty() || near.contains(&path));
            }
            if in_pieces.is_empty() {
                paths.iter_mut().for_each(|paths| *paths = paths.left(|path| paths.is_loop[path]));
            }
            if paths == before {
                break;
            }
        }
        atlas.times += tried;
        Ok((self, atlas))
    }

    /// The components that are on more islands on another map.
    fn more_in_pieces(&self, before: &Atlas, (other, after): (&Self, &Atlas)) -> Vec<usize> {
        let counts = [(self, before), (other, after)].map(|(analysis, atlas)| {
            let mut islands = vec![HashSet::new(); analysis.components().len()];
            for (part, island) in analysis.triangle_components().into_iter().zip(&atlas.islands) {
                if let (Some(part), Some(island)) = (part, island) {
                    islands[part].insert(*island);
                }
            }
            islands
        });
        (0..counts[0].len()).filter(|&part| counts[1][part].len() > counts[0][part].len()).collect()
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
        let is_whole = atlas.detached.is_empty() && atlas.unfolded == 0 && atlas.freed == 0 && atlas.necks == 0;
        let is_refined = self.refined().is_some_and(|refined| refined.is_complete);
        // Whoever says where cones or seams are has the last word.
        let is_asked = !options.seams.names_edges() && !options.cones.is_given();
        if !is_refined || !is_asked || !is_whole || self.found.making.is_opened || vertices > MOST_VERTICES {
            return None;
        }
        let seams = self.seam_edges(atlas)?;
        let mut is_cone: Vec<_> =
            self.components().iter().map(|c| VertexData::constant(c.surface.mesh.vertex_count(), false)).collect();
        for (is_cone, on) in is_cone.iter_mut().zip(self.on_surface(&atlas.recipe.cones).ok()?) {
            on.iter().for_each(|&(v, ..)| is_cone[v] = true);
        }
        let paths = self.components().iter().zip(seams).zip(&is_cone);
        Some(
            paths
                .map(|((component, seams), is_cone)| match component.way {
                    Some(_) => StraightPaths::of(&component.surface.mesh, &seams, is_cone),
                    // It was not refined, nor will be.
                    None => StraightPaths::default(),
                })
                .collect(),
        )
    }

    /// The edges of each component that seams of a map run along.
    fn seam_edges(&self, atlas: &Atlas) -> Option<Vec<EdgeData<Option<SeamEdge>>>> {
        let mut named: HashMap<[u32; 2], Vec<(usize, EdgeId)>> = HashMap::new();
        let mut is_corner = vec![false; self.points().len()];
        let mut seams = Vec::new();
        for component in self.components() {
            let mesh = &component.surface.mesh;
            component.surface.vertex.iter().for_each(|&v| is_corner[v as usize] = true);
            for e in mesh.edges() {
                let name = ascending(mesh.ends(e).map(|v| component.surface.vertex[v]));
                named.entry(name).or_default().push((component.index, e));
            }
            seams.push(EdgeData::constant(mesh.edge_count(), None));
        }
        let loops_from = atlas.seams.len() - atlas.opened_handles;
        for (k, chain) in atlas.seams.iter().enumerate() {
            let mut from = 0;
            for to in (1..chain.len()).filter(|&to| is_corner[chain[to] as usize]) {
                let ends = [chain[from], chain[to]];
                let is_it =
                    |&&(part, e): &&(usize, EdgeId)| self.components()[part].inside(e, ends[0]) == chain[from + 1..to];
                let &(part, e) = named.get(&ascending(ends))?.iter().find(is_it)?;
                let is_sharp = self.bend(&self.components()[part], e) > SHARP;
                seams[part][e] = Some(SeamEdge { is_loop: k >= loops_from, is_sharp });
                from = to;
            }
        }
        Some(seams)
    }

    /// The angle between the triangles of the model at an edge: 0 where it crosses others.
    fn bend(&self, component: &Component, e: EdgeId) -> f64 {
        let mesh = &component.surface.mesh;
        let ends = mesh.ends(e).map(|v| component.surface.vertex[v]);
        let h = mesh.halfedge(e);
        let point = |v: u32| self.points()[v as usize];
        let normal_beside = |h: HalfedgeId, [a, b]: [u32; 2]| {
            let corners = |&t: &u32| self.triangles().corners[t as usize].map(|c| self.corner_vertices()[c as usize]);
            let pieces = component.triangles_of(mesh.face(h)).iter().map(corners);
            let beyond = pieces.filter(|piece| piece.contains(&a) && piece.contains(&b));
            let beyond = beyond.flatten().find(|&v| v != a && v != b)?;
            Some(normal([a, b, beyond].map(point)))
        };
        let [a, b] = ends;
        let normals = (normal_beside(h, [a, b]), mesh.twin(h).and_then(|g| normal_beside(g, [b, a])));
        if let (Some(one), Some(other)) = normals { angle(one, other) } else { 0.0 }
    }

    /// The map with the same cones of another analysis, whose seams are straight.
    fn mapped_straight(&self, other: &Self, atlas: &Atlas, options: &Options) -> Result<Atlas, Error> {
        let on = self.on_surface(&atlas.recipe.cones)?;
        let now = |part: usize, v: VertexId| other.refined().map_or(Some(v), |refined| refined.now(part, v));
        let of_part = |(part, cones): (usize, &Vec<OnSurface>)| {
            let now = |&(v, _, curvature): &OnSurface| Some((now(part, v)?, curvature.unwrap_or_default()));
            cones.iter().filter_map(now).unzip()
        };
        let cones: Vec<(Vec<VertexId>, Vec<f64>)> = on.iter().enumerate().map(of_part).collect();
        let opened = self.parts_of(&atlas.recipe.opened);
        let opened = other.components().iter().filter(|component| opened.contains(&component.index));
        let mut recipe = Recipe {
            opened: opened.map(|component| other.first_face(component)).collect(),
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
        let overlaps = |atlas: &Atlas| atlas.notes.iter().any(|note| matches!(note, Note::Overlap { .. }));
        let is_whole = after.detached.is_empty() && after.unfolded == 0 && after.freed == 0;
        let is_alike = after.opened_handles == before.opened_handles && (overlaps(before) || !overlaps(after));
        let measures = [self.measures(before), other.measures(after)].map(|measured| Some(Distortion::of(&measured?)));
        let [Some(distorted), Some(now)] = measures else { return false };
        let meets = |areas: f64| target.is_none_or(|target| areas <= target);
        let is_no_worse = now.areas <= AS_GOOD * distorted.areas
            && now.angles <= AS_GOOD * distorted.angles
            && (meets(now.areas) || !meets(distorted.areas));
        is_whole && is_alike && is_no_worse && after.seam_figures.turning < before.seam_figures.turning
    }
}

impl StraightPaths {
    /// Whether some path can become straighter.
    fn are_worth_it(&self) -> bool {
        self.paths.iter().any(|path| path.halfedges.len() > 1)
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
    use geom::{Model, shapes};

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

    fn is_alike(before: &(Analysis, Atlas), after: &(Analysis, Atlas)) {
        assert!(after.1.recipe.straight, "it was not made");
        let [was, is] = [&before.1, &after.1];
        assert!(is.seam_figures.turning < 0.5 * was.seam_figures.turning, "{:?}", (is.seam_figures, was.seam_figures));
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
        let seams = after.0.seam_edges(&after.1).unwrap();
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
