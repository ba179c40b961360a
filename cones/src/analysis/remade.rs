//! What makes a map again: its cones alone do not, where more was done to the surface before it was flattened with them.

use std::collections::{HashMap, HashSet};

use geom::{HalfedgeId, Id, VertexId};

use super::Analysis;
use super::atlas::Atlas;
use super::component::{Component, OnSurface};
use super::cones::Configuration;
use super::options::{GivenCone, Handles, Options, Recipe};
use crate::error::Error;

impl Recipe {
    /// Whether it is of the model that maps of an analysis are of, as far as can be told.
    pub(super) fn is_of(&self, analysis: &Analysis) -> bool {
        let has_paths = || analysis.components().iter().any(|component| component.straight.is_some());
        self.vertices.is_none_or(|vertices| vertices == analysis.points().len())
            && (!self.straight || has_paths() || analysis.refined().is_none())
    }
}

impl Analysis {
    /// The recipe of cones on each component.
    pub(super) fn recipe<'a>(&self, cones: impl Iterator<Item = (&'a [VertexId], &'a [f64])>) -> Recipe {
        let mut copies = vec![0_u8; self.points().len()];
        let vertices = self.components().iter().flat_map(|component| component.surface.vertex.iter());
        vertices.for_each(|&v| copies[v as usize] = copies[v as usize].saturating_add(1));
        let mut given = Vec::new();
        for (component, (vertices, curvatures)) in self.components().iter().zip(cones) {
            let surface = &component.surface;
            given.extend(vertices.iter().zip(curvatures).map(|(&v, &curvature)| {
                let vertex = surface.vertex[v];
                let side = surface.mesh.outgoing(v).next().filter(|_| copies[vertex as usize] > 1);
                let face = side.map(|h| self.face_at(component, h));
                GivenCone { vertex, curvature: Some(curvature), face }
            }));
        }
        let opened = self.components().iter().filter(|component| component.handles.of_vertex.is_some());
        let opened = opened.map(|component| self.first_face(component)).collect();
        let is_filled = self.components().iter().any(|component| component.filled.is_some());
        let filled = self.found.making.preparation.fill_holes.filter(|_| is_filled);
        Recipe { cones: given, vertices: Some(self.points().len()), opened, filled, ..Recipe::default() }
    }

    /// The face of the model at the tail of a halfedge of a component.
    fn face_at(&self, component: &Component, h: HalfedgeId) -> u32 {
        let surface = &component.surface;
        let triangle = match component.way {
            None => surface.triangle[surface.mesh.face(h)],
            // A refined model has triangles only.
            Some(_) => surface.corner[h] / 3,
        };
        self.triangles().face_of[triangle as usize]
    }

    /// The first face of a component.
    pub(super) fn first_face(&self, component: &Component) -> u32 {
        self.face_at(component, HalfedgeId::new(0))
    }

    /// The components that faces of the model are on.
    pub(super) fn parts_of(&self, faces: &[u32]) -> HashSet<usize> {
        if faces.is_empty() {
            return HashSet::new();
        }
        let faces: HashSet<u32> = faces.iter().copied().collect();
        let on = self.triangle_components().into_iter().zip(&self.triangles().face_of);
        on.filter(|(_, face)| faces.contains(face)).filter_map(|(part, _)| part).collect()
    }

    /// Given cones as vertices of each component's surface, each once: where vertices were merged the one that stands for them. One that is
    /// there several times and given without a face is a cone of each component that has it.
    pub(super) fn on_surface(&self, given: &[GivenCone]) -> Result<Vec<Vec<OnSurface>>, Error> {
        let count = self.points().len();
        let is_asked: HashSet<u32> = given.iter().filter_map(|cone| cone.face).collect();
        let mut stands_for = vec![None; count];
        let mut at_face = HashMap::new();
        for (part, component) in self.components().iter().enumerate() {
            let mesh = &component.surface.mesh;
            // One that others were merged with may be at no corner itself, where the faces that use it were left out.
            component.surface.vertex.iter().for_each(|&v| stands_for[v as usize] = Some(v));
            for h in mesh.halfedges() {
                let v = mesh.tail(h);
                let stands = component.surface.vertex[v];
                stands_for[self.corner_vertices()[component.surface.corner[h] as usize] as usize] = Some(stands);
                if !is_asked.is_empty() {
                    let face = self.face_at(component, h);
                    if is_asked.contains(&face) {
                        at_face.insert((stands, face), (part, v));
                    }
                }
            }
        }
        let mut found = vec![Vec::new(); self.components().len()];
        let mut is_given = HashSet::new();
        for &GivenCone { vertex, curvature, face } in given {
            let stands = stands_for.get(vertex as usize).copied().flatten();
            let stands = stands.ok_or(Error::NoSuchCone { vertex, count })?;
            let places = match face {
                Some(face) => vec![*at_face.get(&(stands, face)).ok_or(Error::NotAtFace { vertex, face })?],
                None => self.places_of(stands),
            };
            for (part, v) in places {
                if !is_given.insert((part, v)) {
                    return Err(Error::RepeatedCone(vertex));
                }
                found[part].push((v, stands, curvature));
            }
        }
        let known = given.iter().filter(|cone| cone.curvature.is_some()).count();
        if known != 0 && known != given.len() {
            return Err(Error::SomeCurvatures { known, given: given.len() });
        }
        Ok(found)
    }

    /// The first place on each component of a vertex of the model that stands for those merged with it.
    fn places_of(&self, vertex: u32) -> Vec<(usize, VertexId)> {
        let on = |(part, component): (usize, &std::sync::Arc<Component>)| {
            let v = component.surface.vertex.iter().position(|&v| v == vertex)?;
            Some((part, VertexId::new(v)))
        };
        self.components().iter().enumerate().filter_map(on).collect()
    }

    /// The atlas with cones that are given, and with what was done to the surface where a recipe says so.
    pub(super) fn atlas_as_given(&self, options: &Options) -> Result<Atlas, Error> {
        let Some(recipe) = options.cones.recipe() else { return self.flattened_as_given(options) };
        if !recipe.is_of(self) {
            let vertices = recipe.vertices.unwrap_or_default();
            return Err(Error::OtherModel { vertices, count: self.points().len() });
        }
        match self.cut_at(&recipe.necks)? {
            None => self.opened_at(&recipe.opened)?.flattened_as_given(options),
            Some(cut_off) => {
                let opened = cut_off.analysis.opened_at(&recipe.opened)?;
                cut_off.put_back(opened.flattened_as_given(options))
            }
        }
    }

    fn flattened_as_given(&self, options: &Options) -> Result<Atlas, Error> {
        let cones = self.choose(options)?;
        let mut atlas = self.flatten_with(&cones, options)?;
        atlas.times += cones.times;
        Ok(atlas)
    }

    /// The analysis with the handles opened of the parts that have one of these faces; as it is if none is to be, or handles are to stay as they are.
    fn opened_at(&self, faces: &[u32]) -> Result<Self, Error> {
        let parts = self.parts_of(faces);
        if parts.is_empty() || self.found.making.preparation.handles != Handles::Auto {
            return Ok(self.clone());
        }
        let is_opened: Vec<bool> = (0..self.components().len()).map(|part| parts.contains(&part)).collect();
        let opened = self.with_handles_opened()?;
        Ok(opened.map_or_else(|| self.clone(), |opened| self.with_parts_of(&opened, &is_opened)))
    }
}

impl Configuration {
    /// Its cones and their curvatures.
    pub(super) fn cones(&self) -> (&[VertexId], &[f64]) {
        (&self.vertices, &self.curvature)
    }
}
