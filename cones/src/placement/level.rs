//! The coarse level that cones are searched on: the energy model of a surface on few of its vertices.

use std::sync::Arc;

use geom::{Id, Mesh, PoissonError, VertexId, Watch};

use super::energy_model::{EnergyModel, EnergyTerms, usable_triangles};
use crate::field::{Operators, coarse_level, opened_level};

/// So many vertices are on a coarse level. Sets of 4 to 32 cones found there and polished had 1.00 to 1.03 of the full search's
/// norm with 3,000; searching takes about in proportion.
const VERTICES: usize = 3000;

/// A level has at least so many vertices for each boundary loop, if the surface has twice as many. On the dragon (437,645 vertices, 303
/// holes and opened handles in its largest part) 3,000 promise an area distortion of 1.41 with 16 cones, where 32 have 1.48 when they are
/// flattened; with 12,120 it is 1.82 and 1.47, and 64 cones are taken that have 1.27.
const FOR_A_LOOP: usize = 40;

/// For so many cones and more a level has more vertices than that.
const MANY: usize = 32;

/// Surfaces with fewer vertices have no coarse level: searching them takes little longer than making one.
pub(crate) const LEAST_VERTICES: usize = 8000;

/// Between surfaces with more vertices than this and their coarse level there is a middle one, with this part of the vertices, which cones are
/// polished on. On the surface itself each vertex tried costs a solve: a hare of 963,098 vertices took 15 s for its hierarchy so, and takes 6.5 s now.
/// There is none where loops leave the coarse level more than half of its vertices.
const WITH_MIDDLE: usize = 300_000;
const MIDDLE: usize = 10;

/// So many vertices has the level that is made of a surface itself, which flips do not change; none where there is no such level.
pub(crate) fn size_of_level(surface: &Mesh) -> Option<usize> {
    let size = || vertices_of_middle(surface).unwrap_or_else(|| vertices_of_level(surface));
    (surface.vertex_count() >= LEAST_VERTICES).then(size)
}

/// Whether there is a level between a surface and its coarse one.
pub(super) fn has_middle(surface: &Mesh) -> bool {
    vertices_of_middle(surface).is_some()
}

fn vertices_of_middle(surface: &Mesh) -> Option<usize> {
    middle_between(surface.vertex_count(), vertices_of_level(surface))
}

/// So many vertices has the level between a surface with `all` and one with so many; see [`WITH_MIDDLE`].
fn middle_between(all: usize, level: usize) -> Option<usize> {
    (all > WITH_MIDDLE && 2 * level <= all / MIDDLE).then_some(all / MIDDLE)
}

fn vertices_of_level(surface: &Mesh) -> usize {
    let for_loops = FOR_A_LOOP * surface.boundary_loops().len();
    for_loops.min(surface.vertex_count() / 2).max(VERTICES)
}

/// A coarse level; see the module's head. Its vertices are numbered by themselves.
#[derive(Debug)]
pub(crate) struct CoarseLevel {
    pub(crate) operators: Operators,
    /// The surface's vertex for each of its own, ascending unless handles are opened.
    vertex: Vec<VertexId>,
    terms: Arc<EnergyTerms>,
    middle: Option<Middle>,
}

/// The level that a coarse one of a large surface was made of.
#[derive(Debug)]
struct Middle {
    level: Box<CoarseLevel>,
    /// Its vertex for each of the coarse level's.
    vertex: Vec<VertexId>,
}

impl CoarseLevel {
    /// The coarse level of a surface whose layout will use the triangles of `input`.
    ///
    /// # Errors
    /// If the coarse Laplacian cannot be factored, or the watch has said stop.
    pub(crate) fn new(fine: &Operators, input: &Mesh, watch: Watch) -> Result<Self, PoissonError> {
        let vertices = vertices_of_level(&fine.mesh);
        match vertices_of_middle(&fine.mesh) {
            None => Self::of_size(fine, input, vertices, watch),
            Some(middle) => Self::of_middle(fine, input, [middle, vertices], watch),
        }
    }

    /// A coarse level with a middle one, of so many vertices.
    pub(super) fn of_middle(
        fine: &Operators,
        input: &Mesh,
        [middle, coarse]: [usize; 2],
        watch: Watch,
    ) -> Result<Self, PoissonError> {
        let (operators, vertex) = coarse_level(fine, middle, watch)?;
        let (terms, coarser) =
            rayon::join(|| terms((&operators, &vertex), input, watch), || coarse_level(&operators, coarse, watch));
        let (terms, (coarser, in_middle)) = (terms?, coarser?);
        let level = Self { operators, vertex, terms, middle: None };
        let vertex = level.of_surface(&in_middle);
        let terms = self::terms((&coarser, &vertex), input, watch)?;
        let middle = Middle { level: Box::new(level), vertex: in_middle };
        Ok(Self { operators: coarser, vertex, terms, middle: Some(middle) })
    }

    /// A level to place so many cones on: its vertices grow with the root of their number, with room for every hole. None where the surface has
    /// hardly more.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn for_many(
        fine: &Operators,
        input: &Mesh,
        cones: usize,
        watch: Watch,
    ) -> Result<Option<Self>, PoissonError> {
        let for_cones = VERTICES as f64 * (cones as f64 / MANY as f64).sqrt();
        let vertices = vertices_of_level(&fine.mesh).max(for_cones as usize);
        if fine.mesh.vertex_count() < 2 * vertices {
            return Ok(None);
        }
        Self::of_size(fine, input, vertices, watch).map(Some)
    }

    /// The same with so many vertices.
    pub(super) fn of_size(fine: &Operators, input: &Mesh, vertices: usize, watch: Watch) -> Result<Self, PoissonError> {
        let (operators, vertex) = coarse_level(fine, vertices, watch)?;
        let terms = terms((&operators, &vertex), input, watch)?;
        Ok(Self { operators, vertex, terms, middle: None })
    }

    /// The same with its handles opened; nothing where there is none to open. What was found between it and the surface is left out.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn with_handles_opened(&self, input: &Mesh, watch: Watch) -> Result<Option<Self>, PoissonError> {
        let Some((operators, of_level)) = opened_level(&self.operators, input.vertex_count(), watch)? else {
            return Ok(None);
        };
        let vertex = self.of_surface(&of_level);
        let terms = terms((&operators, &vertex), input, watch)?;
        Ok(Some(Self { operators, vertex, terms, middle: None }))
    }

    /// Its energy model, with an empty pool.
    pub(crate) fn energy_model<'a>(&'a self, watch: Watch<'a>) -> EnergyModel<'a> {
        EnergyModel::with_terms(&self.operators, Arc::clone(&self.terms), watch)
    }

    /// The surface's vertices that some of its vertices are.
    pub(crate) fn of_surface(&self, cones: &[VertexId]) -> Vec<VertexId> {
        cones.iter().map(|v| self.vertex[v.0 as usize]).collect()
    }

    /// Some of its vertices in the numbers of the level that it was made of: the middle one, or the surface.
    pub(crate) fn in_finer(&self, cones: &[VertexId]) -> Vec<VertexId> {
        let vertex = self.middle.as_ref().map_or(&self.vertex, |middle| &middle.vertex);
        cones.iter().map(|v| vertex[v.0 as usize]).collect()
    }

    /// Its own vertices that some of the surface's are, if all of them are; not where handles are opened.
    pub(crate) fn own_of_surface(&self, cones: &[VertexId]) -> Option<Vec<VertexId>> {
        cones.iter().map(|v| self.vertex.binary_search(v).ok().map(VertexId::new)).collect()
    }

    /// The level between it and a large surface.
    pub(crate) fn middle(&self) -> Option<&Self> {
        self.middle.as_ref().map(|middle| &*middle.level)
    }

    /// About how far its neighbours are from each other, on the surface scaled to area 1.
    pub(crate) fn spacing(&self) -> f32 {
        (self.vertex.len() as f32).sqrt().recip()
    }
}

/// The terms of a level's energy that do not depend on cones; its layout will use the triangles of `input`.
fn terms(
    (operators, vertex): (&Operators, &[VertexId]),
    input: &Mesh,
    watch: Watch,
) -> Result<Arc<EnergyTerms>, PoissonError> {
    let triangles = vertex.iter().map(|&v| usable_triangles(input, v)).collect();
    Ok(Arc::new(EnergyTerms::with_triangles(operators, triangles, watch)?))
}

#[cfg(test)]
mod tests {
    use geom::{Metric, shapes};

    use super::*;

    #[test]
    fn a_level_has_room_for_every_hole() {
        let sphere = shapes::sphere(9000);
        // A triangle here and there is missing: a hundred holes that do not touch.
        let triangles: Vec<[u32; 3]> =
            sphere.triangles.iter().enumerate().filter(|(t, _)| t % 180 != 90).map(|(_, &t)| t).collect();
        let mesh = Mesh::new(sphere.points.len(), &triangles).unwrap();
        let holes = mesh.boundary_loops().len();
        assert!(holes > 90);
        let operators = |mesh: &Mesh| Operators::new(mesh, &Metric::from_points(mesh, &sphere.points)).unwrap();
        let vertices = |mesh: &Mesh| CoarseLevel::new(&operators(mesh), mesh, Watch::NONE).unwrap().vertex.len();
        assert_eq!(vertices(&sphere.mesh()), VERTICES);
        assert_eq!(vertices(&mesh), FOR_A_LOOP * holes);
        let for_many = |mesh: &Mesh, cones: usize| {
            let level = CoarseLevel::for_many(&operators(mesh), mesh, cones, Watch::NONE).unwrap();
            level.map(|level| level.vertex.len())
        };
        assert_eq!([40, 128].map(|cones| for_many(&mesh, cones)), [Some(FOR_A_LOOP * holes), None]);
        assert_eq!(for_many(&sphere.mesh(), 65), Some(4275));
    }

    #[test]
    fn a_large_surface_has_a_middle_level_if_that_is_no_coarser_than_twice() {
        assert_eq!(middle_between(300_000, 3000), None);
        assert_eq!(middle_between(437_645, 16_280), Some(43_764));
        assert_eq!(middle_between(437_645, 21_883), None);
    }
}
