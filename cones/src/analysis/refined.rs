//! Models whose triangles are no good: refined, and the way back.
//!
//! Each surface gets an even intrinsic triangulation ([`geom::refine`]), and all that is computed is computed on that. What is
//! unwrapped is the *refined model*: the common refinement of the model's triangles and the intrinsic ones, which is the same surface,
//! with every vertex of the model under its own number. In each of its triangles the map is linear, so it is written exactly, and
//! seams are edges of it. Cones may be at vertices that were put in.

use geom::{
    CommonRefinement, EdgeData, FaceId, HalfedgeData, HalfedgeId, Id, Mesh, MeshError, Metric, Model, Prepared,
    Refinement, Surface, Triangles, VertexId, Watch, refine_watched,
};
use rayon::prelude::*;

use super::observer::{Stage, Task, Times};
use crate::error::Error;

/// A refined model: triangles, each part of a face of the model that was given. It has all of that model's vertices, under their own
/// numbers, and after them those that were put in.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RefinedModel {
    /// The triangles.
    pub model: Model,
    /// The face of the model that was given, for each triangle.
    pub face: Vec<u32>,
    /// Whether all triangles of the intrinsic triangulations are even; not so where the cap on vertices was reached.
    pub is_complete: bool,
}

/// The way from a refined surface to the refined model.
#[derive(Debug)]
pub(crate) struct Way {
    common: CommonRefinement,
    /// The refined model's vertex for each of the common refinement's.
    vertex: Vec<u32>,
    /// The refined model's first triangle that is of this surface; the others follow.
    first: u32,
    /// Whether a triangle runs round as in the model, against the surface.
    is_turned: Vec<bool>,
    /// The first triangle of the common refinement in each intrinsic one.
    start: Vec<u32>,
}

impl Way {
    /// The corners of the refined model, with the side of an intrinsic triangle that each is on and how far along.
    pub(crate) fn corners(&self) -> impl Iterator<Item = (u32, HalfedgeId, f64)> {
        self.common.corner.iter().zip(&self.is_turned).enumerate().flat_map(|(t, (corners, &is_turned))| {
            let place = if is_turned { [0, 2, 1] } else { [0, 1, 2] };
            [0, 1, 2].map(|k| (3 * (self.first + t as u32) + place[k], corners[k].0, corners[k].1))
        })
    }

    /// The triangles of the refined model that are part of an intrinsic one.
    pub(crate) fn triangles(&self, f: FaceId) -> std::ops::Range<u32> {
        self.first + self.start[f.index()]..self.first + self.start[f.index() + 1]
    }

    /// The refined model's vertices inside an intrinsic edge, in order along it from one of its ends.
    pub(crate) fn inside(&self, mesh: &Mesh, e: geom::EdgeId, from: VertexId) -> Vec<u32> {
        let inside = self.common.crossings(e).map(|v| self.vertex[v as usize]);
        if mesh.tail(mesh.halfedge(e)) == from { inside.collect() } else { inside.rev().collect() }
    }
}

/// A surface that is ready to be analysed.
pub(crate) struct Ready {
    pub(crate) surface: Surface,
    /// Its edge lengths, in unit size.
    pub(crate) metric: Metric,
    /// To the refined model, if it was refined.
    pub(crate) way: Option<Way>,
}

impl Ready {
    pub(crate) fn as_it_is(surface: Surface) -> Self {
        Self { metric: surface.metric(), surface, way: None }
    }
}

/// Refines all surfaces of a model; what was prepared becomes that of the refined model.
///
/// # Errors
/// If the refined model is too large, or the watch has said stop.
pub(crate) fn refine_all(
    model: &Model,
    prepared: Prepared,
    task: &Task,
    times: &mut Times,
) -> Result<(Vec<Ready>, RefinedModel, Triangles, Vec<u32>), Error> {
    let Prepared { surfaces, triangles, left_out, .. } = prepared;
    let refinements = task.stage((Stage::Prepare, 0), times, |watch: Watch| {
        let refine = |surface: &Surface| refine_watched(&surface.mesh, &surface.metric(), watch);
        let refinements: Vec<Refinement> = surfaces.par_iter().with_max_len(1).map(refine).collect();
        watch.ask(1.0).map(|()| refinements)
    })??;
    let is_complete = refinements.iter().all(|refinement| refinement.is_complete);
    let mut growing = Growing { points: model.points().to_vec(), triangles: Vec::new(), face: Vec::new() };
    let refined = surfaces.into_iter().zip(refinements);
    let ready: Vec<Ready> = refined.map(|(surface, refinement)| growing.add(model, &triangles, surface, refinement)).collect();
    let kept = growing.triangles.len() as u32;
    for &t in &left_out {
        growing.triangles.push(triangles.corners[t as usize].map(|c| model.corners()[c as usize]));
        growing.face.push(triangles.face_of[t as usize]);
    }
    let Growing { points, triangles, face } = growing;
    let left_out = (kept..triangles.len() as u32).collect();
    let model = Model::from_triangles(points, &triangles).map_err(Error::Refined)?;
    let triangles = model.triangles();
    Ok((ready, RefinedModel { model, face, is_complete }, triangles, left_out))
}

/// A refined model as far as it is known.
struct Growing {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The face of the model for each triangle.
    face: Vec<u32>,
}

impl Growing {
    fn add(&mut self, model: &Model, triangles: &Triangles, surface: Surface, refinement: Refinement) -> Ready {
        let Refinement { triangulation, metric, common, .. } = refinement;
        let input = &surface.mesh;
        let corner = |h: HalfedgeId| model.corners()[surface.corner[h] as usize];
        let positions: Vec<[f64; 3]> = surface.vertex.iter().map(|&v| model.points()[v as usize]).collect();
        let there = input.vertex_count();
        let mut vertex: Vec<u32> = surface.vertex.to_vec();
        for place in common.place.iter().skip(there) {
            vertex.push(self.points.len() as u32);
            self.points.push(place.position(input, &positions));
        }
        let first = self.triangles.len() as u32;
        // A triangle that was turned so that the surface is oriented is written as it was.
        let runs_as_given = |f: FaceId| {
            let [a, b, _] = input.sides(f).map(corner);
            let given = triangles.corners[surface.triangle[f] as usize].map(|c| model.corners()[c as usize]);
            (0..3).any(|k| [given[k], given[(k + 1) % 3]] == [a, b])
        };
        let is_turned: Vec<bool> = common.input.iter().map(|&f| !runs_as_given(f)).collect();
        for ((t, corners), &is_turned) in common.triangles.iter_ids().zip(&is_turned) {
            let [a, b, c] = corners.map(|v| vertex[v as usize]);
            self.triangles.push(if is_turned { [a, c, b] } else { [a, b, c] });
            self.face.push(triangles.face_of[surface.triangle[common.input[t]] as usize]);
        }
        let mut start = vec![0; triangulation.face_count() + 1];
        common.intrinsic.iter().for_each(|f| start[f.index() + 1] += 1);
        (0..triangulation.face_count()).for_each(|f| start[f + 1] += start[f]);
        let mesh = Mesh::from_triangulation(triangulation)
            .unwrap_or_else(|error: MeshError| unreachable!("it stays a manifold: {error}"));
        let points = common.place.iter().take(mesh.vertex_count());
        let points = points.map(|place| place.position(input, &surface.points)).collect();
        let way = Way { common, vertex, first, is_turned, start };
        let mut corner = HalfedgeData::constant(mesh.halfedge_count(), 0);
        for (at, h, along) in way.corners() {
            if along <= 0.0 {
                corner[h] = at;
            }
        }
        let surface = Surface {
            points,
            vertex: way.vertex[..mesh.vertex_count()].to_vec().into(),
            corner,
            triangle: mesh.faces().map(|f| way.triangles(f).start).collect(),
            diagonal: EdgeData::constant(mesh.edge_count(), false),
            scale: surface.scale,
            zero_area: 0,
            mesh,
        };
        Ready { surface, metric, way: Some(way) }
    }
}
