//! Flattened components put together: one map of the model, with all that is known of it.

use std::collections::{HashMap, HashSet};
use std::time::Instant;

use geom::{EdgeId, Id, Triangles};
use rayon::prelude::*;

use super::Analysis;
use super::atlas::{Atlas, CutEdge};
use super::component::Component;
use super::cones::ChosenNumber;
use super::flat::{Flat, RIGID_SEAMS};
use super::note::Note;
use super::observer::{Stage, Task, Times};
use super::options::{Options, Recipe};
use super::packed::{Packed, packed};
use crate::cut::{SeamFigures, SeamOptions, Tiling, ascending};
use crate::error::Error;
use crate::flatten::Chain;
use crate::placement::{Prediction, Predictor, distortion_of};

/// So many triangles are gone through one after the other.
const AT_ONCE: usize = 4096;
/// Curvatures that are rounded for a texture are whole multiples of its angle to this.
const ROUNDING: f64 = 1e-9;

/// Positions of the model's corners, as far as they are known.
struct Placed {
    uv: Vec<[f64; 2]>,
    is_placed: Vec<bool>,
}

impl Placed {
    fn new(corners: usize) -> Self {
        Self { uv: vec![[0.0; 2]; corners], is_placed: vec![false; corners] }
    }

    fn at(&self, corner: u32) -> Option<[f64; 2]> {
        self.is_placed[corner as usize].then(|| self.uv[corner as usize])
    }

    fn put(&mut self, corner: u32, position: [f64; 2]) {
        self.uv[corner as usize] = position;
        self.is_placed[corner as usize] = true;
    }

    fn put_if_none(&mut self, corner: u32, position: [f64; 2]) {
        if !self.is_placed[corner as usize] {
            self.put(corner, position);
        }
    }

    /// Puts corners that have no positions where others are, one by one.
    fn copy(&mut self, to: &[u32], from: &[u32]) {
        for (&to, &from) in to.iter().zip(from) {
            if let Some(position) = self.at(from) {
                self.put_if_none(to, position);
            }
        }
    }
}

/// The edges of a component that a chain runs along.
fn cut_along(component: &Component, chain: &Chain, is_loop: bool) -> impl Iterator<Item = CutEdge> {
    let halfedge = |&e: &EdgeId| component.surface.mesh.halfedge(e);
    chain.edges.iter().map(move |e| CutEdge { component: component.index, halfedge: halfedge(e), is_loop })
}

/// That edges were to be avoided that were to be cut, too.
fn contested(seams: &SeamOptions) -> Option<Note> {
    if seams.avoid.is_empty() {
        return None;
    }
    let cut: HashSet<[u32; 2]> = seams.given.iter().chain(&seams.kept).map(|&ends| ascending(ends)).collect();
    let avoided: HashSet<[u32; 2]> = seams.avoid.iter().map(|&ends| ascending(ends)).collect();
    let edges = avoided.intersection(&cut).count();
    (edges > 0).then_some(Note::AvoidedGiven { edges })
}

impl Analysis {
    /// What is to be said of the seams that are asked for.
    pub(super) fn notes_of_seams(&self, seams: &SeamOptions) -> impl Iterator<Item = Note> {
        [self.lost_seams(seams), self.open_seams(seams), contested(seams)].into_iter().flatten()
    }

    /// Puts flattened components together.
    pub(super) fn assemble(
        &self,
        flats: Vec<Flat>,
        mut notes: Vec<Note>,
        number: Option<ChosenNumber>,
        options: &Options,
        task: &Task,
        mut times: Times,
    ) -> Result<Atlas, Error> {
        let is_given = options.seams.names_edges() || options.cones.has_straight_seams();
        let has_say = is_given || self.found.making.is_cut_as_given;
        let Packed { triangles, packing, islands, added } =
            packed(self.components(), &flats, (options, has_say), task, &mut times)?;
        let began = Instant::now();
        let (mut cones, mut seams, mut loops, mut detached) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let number = number.map(|number| self.measured(number, &flats));
        let missed = self.components().iter().zip(&flats).filter(|(_, flat)| flat.misses_areas);
        let recipe = Recipe {
            freed: missed.map(|(component, _)| self.first_face(component)).collect(),
            target: options.cones.wanted(),
            ..self.recipe(flats.iter().map(|flat| (&flat.cones[..], &flat.curvature[..])))
        };
        // Whoever gives cones gives them for the surface as it is.
        let with_holes = self.components().iter().zip(&flats).filter(|_| !options.cones.is_given());
        let holes: usize = with_holes.map(|(component, flat)| component.holes_at(&flat.seams, &flat.layout)).sum();
        let (mut curvature_error, mut overlapped) = (0.0_f64, Vec::new());
        let (mut unfolded, mut freed, mut torn) = (0, 0, Vec::new());
        let (mut cut, mut cut_loops) = (Vec::new(), Vec::new());
        let mut seam_figures = SeamFigures::default();
        let mut tiling = options.quantize.map(Tiling::none);
        notes.splice(0..0, self.notes().iter().cloned());
        for (component, flat) in self.components().iter().zip(flats) {
            let surface = &component.surface;
            overlapped.extend(flat.overlapped.iter().map(|&f| (component.index, f)));
            curvature_error = curvature_error.max(flat.error);
            unfolded += usize::from(flat.is_unfolded);
            let figures = SeamFigures::laid_out(surface, &component.metric, &flat.seams, &flat.layout);
            let is_freed = figures.mean_mismatch() > RIGID_SEAMS;
            freed += usize::from(is_freed);
            torn.extend((is_freed || flat.is_unfolded).then_some(component.index));
            seam_figures += figures;
            if let Some(tiling) = &mut tiling {
                *tiling += Tiling::new(&surface.mesh, &flat.seams, &flat.layout, tiling.symmetry);
            }
            seam_figures += SeamFigures::of_chains(surface, &component.metric, &component.handles.loops);
            seams.extend(flat.seams.chains.iter().map(|chain| component.vertices_along(chain)));
            loops.extend(component.handles.loops.iter().map(|chain| component.vertices_along(chain)));
            cut.extend(flat.seams.chains.iter().flat_map(|chain| cut_along(component, chain, false)));
            cut_loops.extend(component.handles.loops.iter().flat_map(|chain| cut_along(component, chain, true)));
            detached.extend(flat.detached.iter().flat_map(|&f| component.triangles_of(f)).copied());
            cones.extend(flat.cones.iter().zip(&flat.curvature).map(|(&v, &k)| component.cone(v, k, self.points())));
            for note in flat.notes {
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        notes.extend(self.notes_of_seams(&options.seams));
        notes.extend(Note::of_margin(options.packing.margin, packing.margin));
        notes.extend((holes > 0).then_some(Note::SmallHoles { holes }));
        if let Some(Tiling { symmetry, seams, broken: broken @ 1.., .. }) = tiling {
            let mut steps = cones.iter().map(|cone| cone.curvature / symmetry.angle());
            let are_given = steps.any(|steps| (steps - steps.round()).abs() > ROUNDING);
            notes.push(Note::SeamsDoNotTile { symmetry, seams, broken, are_given });
        }
        for (part, e) in added {
            let component = &self.components()[part];
            let alone = Chain { vertices: component.surface.mesh.ends(e).to_vec(), edges: vec![e] };
            seams.push(component.vertices_along(&alone));
            cut.extend(cut_along(component, &alone, false));
        }
        cut.extend(cut_loops);
        let opened_handles = loops.len();
        seams.extend(loops);
        let mut island = vec![None; self.triangles().len()];
        let mut placed = Placed::new(self.corner_vertices().len());
        let mut triangles = triangles.as_slice();
        for (component, islands) in self.components().iter().zip(&islands) {
            let (own, others) = triangles.split_at(islands.len());
            component.spread(|h| own.as_flattened()[h.index()], |corner, position| placed.put(corner, position));
            triangles = others;
            for (f, &number) in islands.iter_ids() {
                component.triangles_of(f).iter().for_each(|&triangle| island[triangle as usize] = Some(number));
            }
        }
        let uv = self.fill_corners(placed);
        times.add(Stage::Pack, began.elapsed());
        Ok(Atlas {
            uv,
            area: self.area(),
            scale: packing.scale,
            tiles: packing.tiles,
            fill: packing.fill,
            triangles: self.triangles().clone(),
            left_out: self.left_out().to_vec(),
            islands: island,
            detached,
            cones,
            seams,
            opened_handles,
            necks: 0,
            filled_holes: self.components().iter().map(|component| component.filled_holes()).sum(),
            seam_figures,
            tiling,
            number,
            curvature_error,
            unfolded,
            freed,
            times,
            notes,
            repairs: self.repairs().to_vec(),
            refined: self.found.refined.clone(),
            recipe,
            overlapped,
            cut,
            torn,
        })
    }

    /// The number of cones that were taken in the end, what is predicted for these, and whether the map that was made meets the target.
    fn measured(&self, number: ChosenNumber, flats: &[Flat]) -> ChosenNumber {
        let mut predictor = Predictor::new(flats.len());
        for (component, flat) in self.components().iter().zip(flats) {
            let Component { index, operators, area, .. } = &**component;
            predictor.put(*index, operators, *area, flat.cones.len(), flat.predicted.clone());
        }
        let Prediction { count: chosen, area_distortion: predicted, .. } = predictor.prediction();
        let mut all: Vec<(f64, f64)> = Vec::new();
        for (component, flat) in self.components().iter().zip(flats) {
            let whole: f64 = flat.quality.ratios.iter().map(|(area, _)| area).sum();
            let size = flat.size * flat.size * component.surface.scale * component.surface.scale;
            let ratios = flat.quality.ratios.par_iter().with_min_len(AT_ONCE);
            all.par_extend(ratios.map(|(area, r)| (area / whole * component.area, r * size)));
        }
        ChosenNumber { chosen, predicted, ..number }.judged(distortion_of(&all))
    }

    /// Corners that no surface has get the positions of a triangle on the same three vertices, or of a corner at the same vertex of their own
    /// one. What is left of a triangle goes to one point, so that it lies over nothing: of its own, of one of its vertices, or the origin.
    fn fill_corners(&self, mut placed: Placed) -> Vec<[f64; 2]> {
        if placed.is_placed.contains(&false) {
            self.fill_copies(&mut placed);
            let corners = || (0..).zip(self.corner_vertices());
            let mut of_vertex = vec![None; self.points().len()];
            for (corner, &v) in corners() {
                of_vertex[v as usize] = placed.at(corner).or(of_vertex[v as usize]);
            }
            let vertex = |corner: u32| self.corner_vertices()[corner as usize];
            for &t in self.left_out() {
                let own = self.triangles().corners[t as usize];
                let point = own.iter().find_map(|&corner| placed.at(corner));
                let point = point.or_else(|| own.iter().find_map(|&corner| of_vertex[vertex(corner) as usize]));
                for corner in own {
                    let twin = own.iter().filter(|&&other| vertex(other) == vertex(corner));
                    let twin = twin.copied().find_map(|other| placed.at(other));
                    placed.put_if_none(corner, twin.or(point).unwrap_or_default());
                }
            }
            // Corners of no triangle at all.
            corners().for_each(|(corner, &v)| placed.put_if_none(corner, of_vertex[v as usize].unwrap_or_default()));
        }
        placed.uv
    }

    /// Gives copies of triangles the positions of the triangle that they are copies of.
    fn fill_copies(&self, placed: &mut Placed) {
        let vertex = |corner: &u32| self.corner_vertices()[*corner as usize];
        let sorted = |t: u32| {
            let mut corners = self.triangles().corners[t as usize];
            corners.sort_unstable_by_key(vertex);
            corners
        };
        let place = |t: u32| sorted(t).map(|corner| vertex(&corner));
        let mut original: HashMap<[u32; 3], Option<[u32; 3]>> =
            self.left_out().iter().map(|&t| (place(t), None)).collect();
        if original.is_empty() {
            return;
        }
        let mut is_on_surface = vec![true; self.triangles().len()];
        self.left_out().iter().for_each(|&t| is_on_surface[t as usize] = false);
        for t in (0..).zip(is_on_surface).filter_map(|(t, is_on_surface)| is_on_surface.then_some(t)) {
            original.entry(place(t)).and_modify(|first| _ = first.get_or_insert_with(|| sorted(t)));
        }
        for &t in self.left_out() {
            if let Some(Some(from)) = original.get(&place(t)) {
                placed.copy(&sorted(t), from);
            }
        }
        self.fill_copied_polygons(placed);
    }

    /// Gives copies of polygons, which may be cut into other triangles, the positions of the polygon that they are copies of.
    fn fill_copied_polygons(&self, placed: &mut Placed) {
        let Triangles { corners, face_of } = self.triangles();
        let of_face = |face: u32| face_of.partition_point(|&f| f < face)..face_of.partition_point(|&f| f <= face);
        let vertex = |corner: &u32| self.corner_vertices()[*corner as usize];
        let sorted = |face: u32| {
            let mut corners = corners[of_face(face)].concat();
            corners.sort_unstable_by_key(|corner| (vertex(corner), *corner));
            corners.dedup();
            corners
        };
        let key = |corners: &[u32]| corners.iter().map(vertex).collect::<Vec<u32>>();
        let mut left_out: Vec<u32> = self.left_out().iter().map(|&t| face_of[t as usize]).collect();
        left_out.dedup();
        let copies: Vec<Vec<u32>> =
            left_out.iter().filter(|&&face| of_face(face).len() > 1).map(|&face| sorted(face)).collect();
        let mut original: HashMap<Vec<u32>, Option<Vec<u32>>> =
            copies.iter().map(|corners| (key(corners), None)).collect();
        if original.is_empty() {
            return;
        }
        let faces = face_of.chunk_by(|f, g| f == g).filter(|chunk| chunk.len() > 1).map(|chunk| chunk[0]);
        for corners in faces.filter(|face| left_out.binary_search(face).is_err()).map(sorted) {
            original.entry(key(&corners)).and_modify(|first| _ = first.get_or_insert(corners));
        }
        for to in copies {
            if let Some(Some(from)) = original.get(&key(&to)) {
                placed.copy(&to, from);
            }
        }
    }
}
