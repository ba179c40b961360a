//! Models whose triangles are no good: refined, and the way back.
//!
//! Each surface gets an even intrinsic triangulation ([`geom::refine`]), and all that is computed is computed on that. What is
//! unwrapped is the *refined model*: the common refinement of the model's triangles and the intrinsic ones, which is the same surface,
//! with every vertex of the model under its own number. In each of its triangles the map is linear, so it is written exactly, and
//! seams are edges of it. Cones may be at vertices that were put in.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use geom::{
    CommonRefinement, EdgeData, EdgeId, EdgeRoles, FaceData, FaceId, HalfedgeData, HalfedgeId, Id, Intrinsic, Mesh,
    MeshError, Metric, Model, OpenedIsland, Prepared, Refinement, StraightPath, Surface, SurfacePoint, TriangleSize,
    Triangles, Triangulation, VertexId, Watch, angle_defects, delaunay, planar_edges, refine_watched,
};
use rayon::prelude::*;

use super::observer::{Stage, Task, Times};
use super::options::Refining;
use crate::cut::{ascending, named_edges, names};
use crate::error::Error;
use crate::field::TiedLoops;
use crate::flatten::Chain;

/// Angles below this, in radians, make a triangle a needle: 10°.
const NEEDLE: f64 = std::f64::consts::PI / 18.0;

/// Angle defects below this, in radians, are rounding.
const FLAT: f64 = 1e-6;

/// The share of the area in needles, after intrinsic Delaunay flips, from which a model is better refined. Scans and remeshed
/// surfaces have at most 0.03; CAD parts with needles from 0.4 on (`cheese` 0.39, `thingi520644` 0.46, `thingi79741` 0.72).
pub const MOST_NEEDLES: f64 = 0.05;

/// The share of the area that is in needles, of triangulations with their lengths and what their areas are multiplied by.
pub(crate) fn needle_share<'a>(parts: impl Iterator<Item = (&'a Triangulation, &'a Metric, f64)>) -> f64 {
    let (needles, whole) = parts.fold((0.0, 0.0), |(needles, whole), (triangulation, metric, scale)| {
        let area = scale * metric.area(triangulation);
        (needles + area * metric.needle_share(triangulation, NEEDLE), whole + area)
    });
    if whole > 0.0 { needles / whole } else { 0.0 }
}

/// Whether surfaces are to be refined. A Delaunay triangulation of each that is not flat where that depends on needles.
pub(crate) fn is_asked_for(refining: Refining, surfaces: &[Surface], shapes: &[usize]) -> bool {
    match refining {
        Refining::Never => false,
        Refining::Always => true,
        Refining::Needles => {
            let flipped: Vec<Option<Intrinsic>> = of_shapes(surfaces, shapes, |_, surface| {
                let metric = surface.metric();
                (!is_flat(surface, &metric)).then(|| delaunay(&surface.mesh, &metric))
            });
            let parts = surfaces.iter().zip(shapes).filter_map(|(surface, &shape)| {
                let Intrinsic { triangulation, metric, .. } = flipped[shape].as_ref()?;
                Some((triangulation, metric, surface.scale.powi(-2)))
            });
            needle_share(parts) > MOST_NEEDLES
        }
    }
}

/// What there is of the first surface of each shape, found at the same time; none for the others.
fn of_shapes<T: Send>(
    surfaces: &[Surface],
    shapes: &[usize],
    of: impl Fn(usize, &Surface) -> Option<T> + Sync,
) -> Vec<Option<T>> {
    let surfaces = surfaces.par_iter().zip(shapes).enumerate().with_max_len(1);
    surfaces.map(|(k, (surface, &shape))| if k == shape { of(k, surface) } else { None }).collect()
}

/// The radius of the largest circumcircle, over the root of the surface's area: some nine hundred triangles at least. On CAD
/// parts large flat triangles lie beside small ones, and a map that is linear on them bends angles. Where that is still too much
/// [a map shows](super::sizing) where triangles should be smaller.
const LARGEST: f64 = 0.03;
/// On surfaces with more vertices than this triangles are [small](TriangleSize::small)
const MANY_VERTICES: usize = 100_000;
/// below this share of that radius: their needles do no harm, but refined they change nearly all edges, and the file's triangles are cut along each.
const SMALL: f64 = 0.25;
/// Parts with less than this share of the model's area have larger triangles: what is missed falls with the number of triangles, and counts by the share.
const LARGE_PART: f64 = 0.01;
/// Their size grows with this power of what they lack; with 0.5 all parts' would be the same in the model's units.
const LARGER: f64 = 0.4;

/// A refined model: triangles, each part of a face of the model that was given, or of several in one plane that nothing tells apart. It has all of that model's vertices, under their own
/// numbers, and after them those that were put in.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RefinedModel {
    /// The triangles.
    pub model: Model,
    /// The face of the model that was given, for each triangle, or one of them; never decreasing.
    pub face: Vec<u32>,
    /// What each vertex that was put in is made of: vertices of the model that was given, with weights that sum to 1.
    pub added: Vec<[(u32, f64); 3]>,
    /// Whether all triangles of the intrinsic triangulations are even; not so where the cap on vertices was reached.
    pub is_complete: bool,
    /// The edges that were to be held, by their vertices in ascending order.
    named: HashSet<[u32; 2]>,
    /// The edges that those of them that there are are in.
    parts: Parts,
    /// See [`now`](Self::now).
    removed: Vec<Vec<VertexId>>,
    /// See [`is_even`](Self::is_even).
    even: Vec<bool>,
}

/// Edges in parts, all by their vertices, which the names of whole ones have in ascending order.
type Parts = HashMap<[u32; 2], Vec<[u32; 2]>>;

impl RefinedModel {
    /// The edges that an edge of the model that was given is in, if it was held.
    pub(crate) fn parts(&self, ends: [u32; 2]) -> Option<&[[u32; 2]]> {
        self.parts.get(&ascending(ends)).map(Vec::as_slice)
    }

    /// The vertex of a surface that a vertex of it is which was there before seams were made straight; none where it was too near to one.
    pub(crate) fn now(&self, part: usize, v: VertexId) -> Option<VertexId> {
        let removed = &self.removed[part];
        removed.binary_search(&v).err().map(|before| VertexId::new(v.index() - before))
    }

    /// Whether all triangles of a surface are even; those of one that was not refined are what they are.
    pub(crate) fn is_even(&self, part: usize) -> bool {
        self.even[part]
    }

    /// Whether an edge was to be held.
    pub(crate) fn is_named(&self, ends: [u32; 2]) -> bool {
        self.named.contains(&ascending(ends))
    }
}

/// The way from a refined surface to the refined model.
#[derive(Clone, Debug)]
pub(crate) struct Way {
    whole: Arc<WholeWay>,
    /// Where the surface is an island of an opened one, what its edges and triangles were there.
    before: Option<Before>,
}

/// The way from a whole surface.
#[derive(Clone, Debug)]
struct WholeWay {
    common: CommonRefinement,
    /// The refined model's vertex for each of the common refinement's.
    vertex: Vec<u32>,
    /// The refined model's triangle for each of the common refinement's.
    triangle: Vec<u32>,
    /// Whether a triangle runs round as in the model, against the surface.
    is_turned: Vec<bool>,
    /// The first triangle of the common refinement in each intrinsic one.
    start: Vec<u32>,
}

/// What the edges and triangles of an island were before its surface was opened.
#[derive(Clone, Debug)]
struct Before {
    /// The edge that each was, and whether its named halfedge was that one's.
    edge: EdgeData<(EdgeId, bool)>,
    face: FaceData<FaceId>,
}

impl Way {
    /// The corners of the refined model, with the side of an intrinsic triangle that each is on and how far along.
    pub(crate) fn corners(&self) -> impl Iterator<Item = (u32, HalfedgeId, f64)> {
        let whole = &*self.whole;
        let count = self.before.as_ref().map_or(whole.start.len() - 1, |before| before.face.len());
        (0..count as u32).flat_map(move |f| {
            self.parts(FaceId(f)).flat_map(move |t| {
                let place = if whole.is_turned[t] { [0, 2, 1] } else { [0, 1, 2] };
                let corners = whole.common.corner[FaceId(t as u32)];
                let side = |h: HalfedgeId| HalfedgeId(3 * f + h.0 % 3);
                [0, 1, 2].map(|k| (3 * whole.triangle[t] + place[k], side(corners[k].0), corners[k].1))
            })
        })
    }

    /// The way from an island of the surface, opened along some of its edges.
    fn of_island(&self, whole: &Mesh, OpenedIsland { mesh, halfedge }: &OpenedIsland) -> Self {
        let edge = |e: EdgeId| {
            let (was, is_named) = self.before(whole.edge(halfedge[mesh.halfedge(e)]));
            (was, is_named == (whole.halfedge(whole.edge(halfedge[mesh.halfedge(e)])) == halfedge[mesh.halfedge(e)]))
        };
        let face = |f: FaceId| self.face_before(whole.face(halfedge[mesh.sides(f)[0]]));
        let before = Before { edge: mesh.edges().map(edge).collect(), face: mesh.faces().map(face).collect() };
        Self { whole: Arc::clone(&self.whole), before: Some(before) }
    }

    /// The triangles of the refined model that are part of an intrinsic one.
    pub(crate) fn triangles(&self, f: FaceId) -> &[u32] {
        &self.whole.triangle[self.parts(f)]
    }

    /// The triangles of the common refinement in an intrinsic one.
    fn parts(&self, f: FaceId) -> std::ops::Range<usize> {
        let f = self.face_before(f).index();
        self.whole.start[f] as usize..self.whole.start[f + 1] as usize
    }

    fn face_before(&self, f: FaceId) -> FaceId {
        self.before.as_ref().map_or(f, |before| before.face[f])
    }

    /// The refined model's vertices inside an intrinsic edge, in order along it from one of its ends.
    pub(crate) fn inside(&self, mesh: &Mesh, e: EdgeId, from: VertexId) -> Vec<u32> {
        let inside = self.whole.common.crossings(self.before(e).0).map(|v| self.whole.vertex[v as usize]);
        let is_along = (mesh.tail(mesh.halfedge(e)) == from) == self.before(e).1;
        if is_along { inside.collect() } else { inside.rev().collect() }
    }

    /// Whether a halfedge is its edge's named one, as it was before the surface was opened.
    pub(crate) fn is_named(&self, mesh: &Mesh, h: HalfedgeId) -> bool {
        let e = mesh.edge(h);
        (mesh.halfedge(e) == h) == self.before(e).1
    }

    /// The edge that an edge was before the surface was opened, and whether its named halfedge was that one's.
    fn before(&self, e: EdgeId) -> (EdgeId, bool) {
        self.before.as_ref().map_or((e, true), |before| before.edge[e])
    }
}

/// What was opened on a surface.
#[derive(Debug, Default)]
pub(crate) struct OpenedHandles {
    /// The loops, each along one of its sides.
    pub(crate) loops: Vec<Chain>,
    /// The loop that each vertex on one is on.
    pub(crate) of_vertex: Option<TiedLoops>,
    /// What a refined surface was before: halfedges and triangles have the same numbers.
    pub(crate) closed: Option<Arc<Mesh>>,
}

/// A surface that is ready to be analysed.
pub(crate) struct Ready {
    pub(crate) surface: Surface,
    /// Its edge lengths, in unit size.
    pub(crate) metric: Metric,
    /// To the refined model, if it was refined.
    pub(crate) way: Option<Way>,
    /// The handles that were opened.
    pub(crate) handles: OpenedHandles,
    /// The paths that were made straight.
    pub(crate) straight: Option<Arc<Straightened>>,
    /// The sides on the boundary round small holes.
    pub(crate) holes: HashSet<HalfedgeId>,
    /// The number of the first surface that is of the same shape, and was made ready in the same way.
    pub(crate) shape: usize,
}

impl Ready {
    pub(crate) fn as_it_is(surface: Surface, shape: usize) -> Self {
        Self {
            metric: surface.metric(),
            surface,
            way: None,
            handles: OpenedHandles::default(),
            straight: None,
            holes: HashSet::new(),
            shape,
        }
    }

    /// An island of it, opened along some of its edges, in the same units.
    pub(crate) fn island(&self, island: OpenedIsland, shape: usize) -> Self {
        let Surface { mesh: whole, points, vertex, corner, triangle, diagonal, scale, .. } = &self.surface;
        let way = self.way.as_ref().map(|way| way.of_island(whole, &island));
        let (vertex_before, edge_before) = (island.vertices_of(whole), island.edges_of(whole));
        let OpenedIsland { mesh, halfedge } = island;
        let holes = match self.holes.is_empty() {
            true => HashSet::new(),
            false => halfedge.iter_ids().filter(|(_, before)| self.holes.contains(before)).map(|(h, _)| h).collect(),
        };
        let surface = Surface {
            points: vertex_before.iter().map(|&v| points[v.index()]).collect(),
            vertex: vertex_before.iter().map(|&v| vertex[v]).collect(),
            corner: halfedge.iter().map(|&h| corner[h]).collect(),
            triangle: mesh.faces().map(|f| triangle[whole.face(halfedge[mesh.sides(f)[0]])]).collect(),
            diagonal: edge_before.iter().map(|&e| diagonal[e]).collect(),
            scale: *scale,
            zero_area: 0,
            mesh,
        };
        let lengths = edge_before.iter().map(|&e| self.metric.length(e)).collect();
        let of_island = |straight: &Arc<Straightened>| {
            let path = edge_before.iter().map(|&e| straight.path[e]).collect();
            Arc::new(Straightened { path, is_loop: straight.is_loop.clone(), stay: straight.stay })
        };
        let straight = self.straight.as_ref().map(of_island);
        Self { metric: Metric::new(lengths), surface, way, handles: OpenedHandles::default(), straight, holes, shape }
    }

    /// The same, the longest side of its box 1.
    pub(crate) fn in_unit_size(mut self) -> Self {
        let points = &mut self.surface.points;
        let extent = |k: usize| {
            let along = || points.iter().map(|p| p[k]);
            along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
        };
        let scale = (0..3).map(extent).fold(0.0, f64::max).recip();
        if scale.is_finite() {
            points.iter_mut().flatten().for_each(|x| *x *= scale);
            self.metric = Metric::new(self.metric.lengths().iter().map(|l| scale * l).collect());
            self.surface.scale *= scale;
        }
        self
    }

    /// Goes from triangles of the refined model in any order to their places in it.
    fn renumber(&mut self, number: &[u32]) {
        let Some(way) = &mut self.way else {
            self.surface.triangle.iter_mut().for_each(|t| *t = number[*t as usize]);
            self.surface.corner.iter_mut().for_each(|c| *c = 3 * number[*c as usize / 3] + *c % 3);
            return;
        };
        Arc::make_mut(&mut way.whole).triangle.iter_mut().for_each(|t| *t = number[*t as usize]);
        for (corner, h, along) in way.corners() {
            if along <= 0.0 {
                self.surface.corner[h] = corner;
            }
        }
        self.surface.triangle = self.surface.mesh.faces().map(|f| way.triangles(f)[0]).collect();
    }
}

/// Whether a surface is flat as it is, but at its boundary: whatever its triangles, it is unrolled without distortion.
fn is_flat(Surface { mesh, .. }: &Surface, metric: &Metric) -> bool {
    let defects = angle_defects(mesh, metric);
    let mut inner = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v));
    mesh.vertices().any(|v| mesh.is_boundary_vertex(v)) && inner.all(|v| defects[v].abs() < FLAT)
}

/// How large the circumcircles of a part's triangles may be at a place, in the model's unit.
pub(crate) type SizeAt<'a> = &'a (dyn Fn(usize, [f64; 3]) -> f64 + Sync);

/// Vertices this far from a plane, over the largest coordinate, are in it: two units of single precision, which is what most files have.
const PLANE: f64 = 2.0 * f32::EPSILON as f64;
/// But no farther than this, over the part's extent (the unit of its points), where a part is small or far from the origin.
const VISIBLE: f64 = 1e-6;

/// The points of an instance where the model has them, in unit size.
fn own_points(model: &Model, surface: &Surface) -> Vec<[f64; 3]> {
    let origin = model.points()[surface.vertex[VertexId(0)] as usize];
    let place = |&v: &u32| [0, 1, 2].map(|k| (model.points()[v as usize][k] - origin[k]) * surface.scale);
    surface.vertex.iter().map(place).collect()
}

/// How surfaces are to be refined.
#[derive(Clone, Copy)]
pub(crate) struct HowRefined<'a> {
    pub(crate) refining: Refining,
    /// How large triangles may be at most, besides [`LARGEST`].
    pub(crate) size_at: Option<SizeAt<'a>>,
    /// Edges that stay edges, by their vertices in ascending order.
    pub(crate) names_held: &'a HashSet<[u32; 2]>,
    /// What is made straight on each surface, if anything is.
    pub(crate) straight: &'a [StraightPaths],
}

/// Paths along edges of a refined surface that are to be straight.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StraightPaths {
    pub(crate) paths: Vec<StraightPath>,
    /// Whether each is of a loop that a handle is opened along.
    pub(crate) is_loop: Vec<bool>,
    /// Whether all stay as they are: the surface is refined as if there were none.
    pub(crate) stay: bool,
}

/// Paths of a surface that were made straight, or stay as they are.
#[derive(Debug)]
pub(crate) struct Straightened {
    /// The path that each edge is of.
    pub(crate) path: EdgeData<Option<u32>>,
    is_loop: Vec<bool>,
    /// Whether all stay as they are, as where refining would not end.
    pub(crate) stay: bool,
}

impl Straightened {
    /// `made` has the path that each edge is of, if refining ended.
    fn new(paths: &StraightPaths, made: EdgeData<Option<u32>>, triangulation: &Triangulation) -> Self {
        let mut path = made;
        let stay = path.iter().all(Option::is_none);
        if stay {
            let along =
                (0..).zip(&paths.paths).flat_map(|(number, way)| way.halfedges.iter().map(move |&h| (h, number)));
            let is_there = |h: HalfedgeId| h.index() < triangulation.halfedge_count();
            along.filter(|&(h, _)| is_there(h)).for_each(|(h, number)| path[triangulation.edge(h)] = Some(number));
        }
        Self { path, is_loop: paths.is_loop.clone(), stay }
    }

    /// Whether an edge is of a loop that a handle is opened along.
    pub(crate) fn is_loop(&self, e: EdgeId) -> bool {
        self.path[e].is_some_and(|path| self.is_loop[path as usize])
    }
}

/// Refines the surfaces of a model, but none that is flat where needles alone ask for it or where it is small; what was prepared becomes that of the refined
/// model.
///
/// # Errors
/// If the refined model is too large, or the watch has said stop.
pub(crate) fn refine_all(
    model: &Model,
    (prepared, shapes): (Prepared, &[usize]),
    HowRefined { refining, size_at, names_held, straight }: HowRefined,
    task: &Task,
    times: &mut Times,
) -> Result<(Vec<Ready>, RefinedModel, Triangles, Vec<u32>), Error> {
    let Prepared { surfaces, triangles, left_out, .. } = prepared;
    let largest_coordinate = model.points().iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
    let rounding = PLANE * largest_coordinate;
    // Faces that nothing tells from each other need not be told apart.
    let is_bare = model.obj_text().is_none() && model.attributes().is_bare();
    let face_of = |surface: &Surface, f: FaceId| triangles.face_of[surface.triangle[f] as usize];
    let (shapes, planar, held, mut refined) =
        task.stage((Stage::Prepare, 0), times, |watch| -> Result<_, Error> {
            let planar = |(k, surface): (usize, &Surface)| {
                // An instance has the points of another one, but it is its own planes that edges may be left out of.
                let own = (shapes[k] != k).then(|| own_points(model, surface));
                let points = own.as_ref().unwrap_or(&surface.points);
                let tolerance = (rounding * surface.scale).min(VISIBLE);
                planar_edges(&surface.mesh, points, tolerance, |f, g| {
                    is_bare || face_of(surface, f) == face_of(surface, g)
                })
            };
            let planar: Vec<_> = surfaces.par_iter().enumerate().with_max_len(1).map(planar).collect();
            let held = surfaces.iter().map(|surface| named_edges(surface, model.corners(), names_held));
            let held: Vec<EdgeData<bool>> = held.collect();
            let is_alike = |k: usize, shape: usize| planar[k] == planar[shape] && held[k] == held[shape];
            let alike = |(k, &shape): (usize, &usize)| if is_alike(k, shape) { shape } else { k };
            let alike: Vec<usize> = shapes.iter().enumerate().map(alike).collect();
            // Paths are those of the triangulation that there is without them, which is the same for all that are alike.
            let as_straight =
                |(k, &shape): (usize, &usize)| if straight.get(k) == straight.get(shape) { shape } else { k };
            let shapes: Vec<usize> = alike.iter().enumerate().map(as_straight).collect();
            // In the model's units.
            let area = |surface: &Surface| surface.metric().area(&surface.mesh) * surface.scale.powi(-2);
            let areas: Vec<f64> = surfaces.par_iter().map(area).collect();
            let whole: f64 = areas.iter().sum();
            let refine = |k: usize, surface: &Surface| {
                let metric = surface.metric();
                let lacks = (LARGE_PART * whole / areas[k]).max(1.0);
                if (refining == Refining::Needles || lacks > 1.0) && is_flat(surface, &metric) {
                    return Ok(None);
                }
                let larger = lacks.powf(LARGER);
                let largest = larger * LARGEST * metric.area(&surface.mesh).sqrt();
                let small = if surface.mesh.vertex_count() > MANY_VERTICES { SMALL * largest } else { 0.0 };
                let straight =
                    straight.get(k).filter(|straight| !straight.stay).map_or(&[][..], |straight| &straight.paths);
                let roles = EdgeRoles { left_out: Some(&planar[k]), held: Some(&held[k]), straight };
                let size_at = size_at.map(|size_at| {
                    let (part, first) = (alike[k], &surfaces[alike[k]]);
                    let points: Vec<_> = first.vertex.iter().map(|&v| model.points()[v as usize]).collect();
                    move |place: SurfacePoint| first.scale * size_at(part, place.position(&first.mesh, &points))
                });
                let at = size_at.as_ref().map(|at| at as &(dyn Fn(SurfacePoint) -> f64 + Sync));
                let size = TriangleSize { largest, at, small };
                let refinement = refine_watched(&surface.mesh, &metric, size, roles, watch)?;
                if refinement.is_complete || straight.is_empty() {
                    return Ok(Some(refinement));
                }
                // Between paths it does not end: then they stay as they are.
                let roles = EdgeRoles { straight: &[], ..roles };
                refine_watched(&surface.mesh, &metric, size, roles, watch).map(Some)
            };
            let refined = of_shapes(&surfaces, &shapes, |k, surface| refine(k, surface).transpose());
            let refined = refined.into_iter().map(Option::transpose).collect::<Result<Vec<Option<Refinement>>, _>>()?;
            Ok((shapes, planar, held, refined))
        })??;
    let is_even = |&shape: &usize| refined[shape].as_ref().is_none_or(|refinement| refinement.is_complete);
    let even: Vec<bool> = shapes.iter().map(is_even).collect();
    task.stage((Stage::Prepare, 0), times, |watch: Watch| {
        let points = model.points().to_vec();
        let mut growing = Growing { points, ..Growing::default() };
        // Where no side of a triangle was left out, the pieces named for it are all of it.
        let whole = |(surface, planar): (&Surface, &EdgeData<bool>)| {
            let is_whole = |f: &FaceId| surface.mesh.sides(*f).iter().all(|&h| !planar[surface.mesh.edge(h)]);
            surface.mesh.faces().filter(is_whole).map(|f| surface.triangle[f]).collect::<Vec<_>>()
        };
        let whole: Vec<u32> = surfaces.iter().zip(&planar).flat_map(whole).collect();
        let mut ready: Vec<Ready> = Vec::with_capacity(surfaces.len());
        let mut instances = vec![0; surfaces.len()];
        shapes.iter().for_each(|&shape| instances[shape] += 1);
        let no_paths = StraightPaths::default();
        for (k, ((surface, &shape), held)) in surfaces.into_iter().zip(&shapes).zip(&held).enumerate() {
            let held = (held, straight.get(k).unwrap_or(&no_paths));
            instances[shape] -= 1;
            let refinement = &mut refined[shape];
            ready.push(match if instances[shape] == 0 { refinement.take() } else { refinement.clone() } {
                Some(refinement) => growing.add((model, &triangles), (surface, shape), held, refinement),
                None => growing.add_as_it_is(model, &triangles, (surface, shape)),
            });
            watch.ask(0.5)?;
        }
        let kept = growing.triangles.len();
        growing.add_left_out(&triangles.vertices(model), &left_out, &whole);
        let number = growing.sort_by_face(&triangles);
        watch.ask(0.7)?;
        ready.iter_mut().for_each(|ready| ready.renumber(&number));
        watch.ask(0.8)?;
        let left_out = number[kept..].to_vec();
        let Growing { points, added, triangles: pieces, part_of, parts, removed } = growing;
        let face = part_of.iter().map(|&t| triangles.face_of[t as usize]).collect();
        let model = Model::from_triangles(points, &pieces).map_err(Error::Refined)?;
        watch.ask(0.9)?;
        let triangles = model.triangles();
        Ok((
            ready,
            RefinedModel {
                model,
                face,
                added,
                is_complete: !even.contains(&false),
                named: names_held.clone(),
                parts,
                removed,
                even,
            },
            triangles,
            left_out,
        ))
    })?
}

/// A refined model as far as it is known.
#[derive(Default)]
struct Growing {
    points: Vec<[f64; 3]>,
    /// What the vertices that were put in are made of.
    added: Vec<[(u32, f64); 3]>,
    triangles: Vec<[u32; 3]>,
    /// The triangle of the model that each is part of, or one of them.
    part_of: Vec<u32>,
    /// The edges that those that were held are in.
    parts: Parts,
    /// See [`RefinedModel::now`].
    removed: Vec<Vec<VertexId>>,
}

impl Growing {
    /// Brings the triangles into the order of the model's faces; where each has gone.
    fn sort_by_face(&mut self, triangles: &Triangles) -> Vec<u32> {
        let mut order: Vec<u32> = (0..self.triangles.len() as u32).collect();
        order.sort_by_key(|&t| triangles.face_of[self.part_of[t as usize] as usize]);
        let mut number = vec![0; order.len()];
        (0..).zip(&order).for_each(|(to, &from)| number[from as usize] = to);
        self.triangles = order.iter().map(|&t| self.triangles[t as usize]).collect();
        self.part_of = order.iter().map(|&t| self.part_of[t as usize]).collect();
        number
    }

    /// Adds triangles that belong to no surface: a copy of one that is `whole` in the pieces of that one, so that it lies where that does.
    fn add_left_out(&mut self, vertices: &[[u32; 3]], left_out: &[u32], whole: &[u32]) {
        let place = |t: u32| {
            let mut place = vertices[t as usize];
            place.sort_unstable();
            place
        };
        let wanted: HashSet<[u32; 3]> = left_out.iter().map(|&t| place(t)).collect();
        let mut originals: HashMap<[u32; 3], (u32, Vec<[u32; 3]>)> = HashMap::new();
        for &t in whole.iter().filter(|&&t| wanted.contains(&place(t))) {
            originals.entry(place(t)).or_insert((t, Vec::new()));
        }
        for (&piece, &t) in self.triangles.iter().zip(&self.part_of) {
            if let Some((_, pieces)) = originals.get_mut(&place(t)).filter(|original| original.0 == t) {
                pieces.push(piece);
            }
        }
        for &t in left_out {
            let own = vertices[t as usize];
            let runs_as = |[a, b, _]: [u32; 3]| (0..3).any(|k| [own[k], own[(k + 1) % 3]] == [a, b]);
            let pieces = match originals.get(&place(t)) {
                Some((original, pieces)) if runs_as(vertices[*original as usize]) => pieces.clone(),
                Some((_, pieces)) => pieces.iter().map(|&[a, b, c]| [a, c, b]).collect(),
                None => vec![own],
            };
            self.part_of.resize(self.part_of.len() + pieces.len(), t);
            self.triangles.extend(pieces);
        }
    }

    /// Adds a surface that is not refined.
    fn add_as_it_is(&mut self, model: &Model, triangles: &Triangles, (mut surface, shape): (Surface, usize)) -> Ready {
        self.removed.push(Vec::new());
        let first = self.triangles.len() as u32;
        for (number, t) in (first..).zip(surface.triangle.iter_mut()) {
            let corners = triangles.corners[*t as usize];
            self.triangles.push(corners.map(|c| model.corners()[c as usize]));
            self.part_of.push(*t);
            *t = number;
            let place = |corner: u32| corners.iter().position(|&c| c == corner).expect("it is the triangle's");
            let f = FaceId(number - first);
            surface
                .mesh
                .sides(f)
                .iter()
                .for_each(|&h| surface.corner[h] = 3 * number + place(surface.corner[h]) as u32);
        }
        surface.diagonal = EdgeData::constant(surface.mesh.edge_count(), false);
        Ready::as_it_is(surface, shape)
    }

    fn add(
        &mut self,
        (model, triangles): (&Model, &Triangles),
        (surface, shape): (Surface, usize),
        (held, straight): (&EdgeData<bool>, &StraightPaths),
        refinement: Refinement,
    ) -> Ready {
        let Refinement { triangulation, metric, common, along, path, removed, .. } = refinement;
        self.removed.push(removed);
        let input = &surface.mesh;
        let corner = |h: HalfedgeId| model.corners()[surface.corner[h] as usize];
        let positions: Vec<[f64; 3]> = surface.vertex.iter().map(|&v| model.points()[v as usize]).collect();
        let there = input.vertex_count();
        let mut vertex: Vec<u32> = surface.vertex.to_vec();
        for place in common.place.iter().skip(there) {
            vertex.push(self.points.len() as u32);
            self.points.push(place.position(input, &positions));
            self.added.push(made_of(*place, input).map(|(v, weight)| (surface.vertex[v], weight)));
        }
        for (e, part_of) in along.iter_ids() {
            let Some(whole) = part_of.map(|h| input.edge(h)).filter(|&whole| held[whole]) else { continue };
            let part = triangulation.ends(e).map(|v| vertex[v.index()]);
            for name in names(&surface, model.corners(), whole) {
                let parts = self.parts.entry(name).or_default();
                // Both sides call it the same where nothing was welded.
                if parts.last() != Some(&part) {
                    parts.push(part);
                }
            }
        }
        let straight = (!straight.paths.is_empty()).then(|| Straightened::new(straight, path, &triangulation));
        let straight = straight.map(Arc::new);
        let first = self.triangles.len() as u32;
        let triangle = (first..first + common.triangles.len() as u32).collect();
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
            self.part_of.push(surface.triangle[common.input[t]]);
        }
        let mut start = vec![0; triangulation.face_count() + 1];
        common.intrinsic.iter().for_each(|f| start[f.index() + 1] += 1);
        (0..triangulation.face_count()).for_each(|f| start[f + 1] += start[f]);
        let mesh = Mesh::from_triangulation(triangulation)
            .unwrap_or_else(|error: MeshError| unreachable!("it stays a manifold: {error}"));
        let points = common.place.iter().take(mesh.vertex_count());
        let points = points.map(|place| place.position(input, &surface.points)).collect();
        let whole = WholeWay { common, vertex, triangle, is_turned, start };
        let surface = Surface {
            points,
            vertex: whole.vertex[..mesh.vertex_count()].to_vec().into(),
            // Known once all triangles are in order.
            corner: HalfedgeData::constant(mesh.halfedge_count(), 0),
            triangle: FaceData::constant(mesh.face_count(), 0),
            diagonal: EdgeData::constant(mesh.edge_count(), false),
            scale: surface.scale,
            zero_area: 0,
            mesh,
        };
        let way = Some(Way { whole: Arc::new(whole), before: None });
        let holes = HashSet::new();
        Ready { surface, metric, way, handles: OpenedHandles::default(), straight, holes, shape }
    }
}

/// The vertices that a place is between, with their weights.
fn made_of(place: SurfacePoint, input: &Mesh) -> [(VertexId, f64); 3] {
    let f = match place {
        SurfacePoint::Vertex(v) => return [(v, 1.0), (v, 0.0), (v, 0.0)],
        SurfacePoint::Edge(h, _) => input.face(h),
        SurfacePoint::Face(f, _) => f,
    };
    let (corners, weights) = (input.corners(f), place.barycentric(input, f));
    [0, 1, 2].map(|s| (corners[s], weights[s]))
}
