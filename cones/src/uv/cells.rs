//! A layout opened along more edges than it needs: cells, and the arcs along which they can be glued.
//!
//! A map that keeps the shape of every triangle can be opened along any network of edges and put together otherwise: its *cells* move rigidly,
//! and two cells that share an *arc* (a run of open edges from one joint of the network to the next) can be glued there if both sides are
//! congruent. An island is a tree of glued cells. Arcs along which an island lies beside itself close by themselves: of the network as far as it
//! is not glued, whatever ends at a vertex that is flat and inside the surface can be closed from there on, as long as there is such an end.
//! What is left are the seams.
//!
//! Cells and arcs are numbered by their size, whatever the order of triangles and vertices: the search draws them by lot.
//!
//! Two cells of which neither overlaps itself lie beside each other iff triangles at the boundary of one meet none at the boundary of the other, and
//! no point of the one with less area is within the other. That depends on their motion to each other alone, so it is remembered by that.

use std::cmp::Reverse;
use std::f64::consts::{FRAC_PI_2, TAU};

use geom::{
    EdgeData, EdgeId, FaceData, FaceId, HalfedgeId, Id, Islands, Mesh, Rows, VertexId, edges_at, open_vertices,
};
use num_complex::Complex64;
use rayon::prelude::*;

use super::AT_ONCE;
use super::across::axis;
use super::attach::{ALLOWED, Moved, may_meet};
use super::boxes::{self, Bounds, Boxes, joined};
use super::chains::motion_across;
use super::map::UvMap;
use super::motion::Motion;
use super::overlap::NEGLIGIBLE_DEPTH;
use super::pack::convex_hull;
use super::table::Table;
use super::triangle;

/// A vertex is flat if its angles add up to a full turn but for this.
const FLAT: f64 = 1e-6;
/// Arcs have whole multiples of this share of the length of all, so that rounding does not decide which of two is longer.
const LENGTHS: f64 = 65_536.0;
/// Cells and arcs are numbered by their size, those that differ by less than this share of all by their vertices.
const NUMBERED: f64 = 1e9;
/// Of a cell's corners those are kept that are farthest in one of so many directions, for the room that islands take.
const DIRECTIONS: usize = 16;
/// Squares are sought in so many directions, evenly over a quarter turn.
pub(super) const QUARTER: usize = 12;
/// Motions that differ by less than this, in shares of the map's extent, are one.
const SAME_MOTION: f64 = 1e-7;

/// A run of open edges between two joints.
pub(super) struct Arc {
    /// The halfedges on one side, in order; their twins are on the other.
    sides: Vec<HalfedgeId>,
    /// The cells on the side of the halfedges and on that of their twins.
    pub(super) cells: [u32; 2],
    /// What takes the twins' cell to where it lies beside the halfedges'; none if nothing does, or it is to stay open.
    pub(super) motion: Option<Motion>,
    /// What it costs as a seam,
    pub(super) cost: f64,
    /// and how long it is then.
    pub(super) length: f64,
    /// The joints at its ends.
    pub(super) joints: [u32; 2],
}

impl Arc {
    /// Whether a map is open at none of its edges.
    pub(super) fn is_closed(&self, mesh: &Mesh, cut: &EdgeData<bool>) -> bool {
        self.sides.iter().all(|&h| !cut[mesh.edge(h)])
    }

    /// The cell on the other side and what takes it to where it lies beside this one; none if nothing does.
    pub(super) fn beyond(&self, c: u32) -> Option<(u32, Motion)> {
        let motion = self.motion?;
        Some(if self.cells[0] == c { (self.cells[1], motion) } else { (self.cells[0], motion.inverse()) })
    }
}

/// A map that keeps the shape of its triangles, opened along a network.
pub(super) struct Cells<'a> {
    /// The cell of each triangle.
    pub(super) cell: FaceData<u32>,
    /// How many triangles each cell has.
    pub(super) size: Vec<usize>,
    /// The triangles of each cell that have a corner on its boundary; all where one of these has no area.
    rims: Vec<Boxes<'a>>,
    /// A point of each that is in one of these.
    inner: Vec<[f64; 2]>,
    /// The sides on the boundary of each.
    sides: Vec<Vec<[[f64; 2]; 2]>>,
    /// As they lie at first; none without area.
    pub(super) bounds: Vec<Option<Bounds>>,
    /// The corners of each that are farthest in one of some directions.
    pub(super) extremes: Vec<Vec<Complex64>>,
    pub(super) area: Vec<f64>,
    /// The area of all.
    pub(super) whole: f64,
    /// Directions in which squares are sought, evenly over half a turn.
    pub(super) directions: [[f64; 2]; 2 * QUARTER],
    pub(super) arcs: Vec<Arc>,
    /// The arcs at each cell, and the cells on their other sides.
    pub(super) around: Rows<(u32, u32)>,
    /// Whether what ends at a joint can be closed there.
    is_flat: Vec<bool>,
    /// The arcs at each joint.
    at_joint: Rows<u32>,
    /// What may lie over each other without mattering.
    least: f64,
    extent: f64,
}

/// Room for [`Cells::seams`]: which arcs are open, how many of them end at each joint, and joints where one does.
#[derive(Default)]
pub(super) struct SeamRoom {
    open: Vec<bool>,
    degree: Vec<u32>,
    ends: Vec<u32>,
}

/// Which cells overlap when they are moved to each other, as far as that was asked.
pub(super) type Known = Table<(u32, u32, [i64; 4]), bool>;

impl<'a> Cells<'a> {
    /// The cells of a map opened along a network, in which the edges where it is open must be. Edges that are `kept` are not
    /// glued. `seam` is what a run of seam costs, and its length.
    pub(super) fn new(
        (mesh, kept): (&Mesh, Option<&EdgeData<bool>>),
        seam: impl Fn(&[HalfedgeId]) -> [f64; 2] + Send,
        map: &'a UvMap,
        network: &EdgeData<bool>,
    ) -> Self {
        let opened = Islands::new(mesh, network);
        let count = opened.count();
        let uv = map.triangles();
        let areas: Vec<Option<f64>> =
            uv.par_iter().with_min_len(AT_ONCE).map(|&corners| triangle::area(corners)).collect();
        let order = largest_first(mesh, &areas, &opened);
        let cell: FaceData<u32> = opened.of_faces().iter().map(|&island| order[island as usize]).collect();
        let sums = || {
            let (mut size, mut area, mut bounds) = (vec![0; count], vec![0.0; count], vec![None; count]);
            for f in mesh.faces() {
                let c = cell[f] as usize;
                size[c] += 1;
                if let Some(of_triangle) = areas[f.index()] {
                    area[c] += of_triangle;
                    let about = boxes::bounds(&uv[f.index()]);
                    bounds[c] = Some(bounds[c].map_or(about, |bounds| joined(bounds, about)));
                }
            }
            (size, area, bounds)
        };
        let along = || (rims(mesh, &areas, (&cell, count), network), arcs((mesh, kept), seam, map, network, &cell));
        let ((size, area, bounds), (rims, (mut arcs, is_flat))) = rayon::join(sums, along);
        let middle = |&f: &u32| uv[f as usize].iter().fold([0.0; 2], |[x, y], p| [x + p[0] / 3.0, y + p[1] / 3.0]);
        let area_of = |f: &u32| areas[*f as usize].unwrap_or(0.0);
        let inner =
            |rim: &Vec<u32>| rim.iter().max_by(|f, g| area_of(f).total_cmp(&area_of(g))).map_or([f64::NAN; 2], middle);
        let mut sides = vec![Vec::new(); count];
        for &h in opened.boundary_loops().iter().flatten() {
            sides[cell[mesh.face(h)] as usize].push([h, mesh.next(h)].map(|h| map.position[h]));
        }
        let points = |c: usize| sides[c].iter().map(|&[[x, y], _]| Complex64::new(x, y)).collect::<Vec<_>>();
        let whole: f64 = arcs.iter().map(|arc| arc.cost).sum();
        let first_edge = |arc: &Arc| arc.sides.iter().map(|&h| sorted(mesh.ends(mesh.edge(h)))).min();
        arcs.sort_by_cached_key(|arc| (Reverse(share(arc.cost, whole, NUMBERED)), first_edge(arc)));
        for arc in &mut arcs {
            arc.cost = share(arc.cost, whole, LENGTHS) as f64 * whole / LENGTHS;
        }
        let axis = Complex64::cis(sides.first().map_or(0.0, |sides| axis(sides.iter().map(|side| side[0]))));
        let at_cells = arcs.iter().zip(0..).flat_map(|(Arc { cells: [left, right], .. }, k)| {
            [(*left as usize, (k, *right)), (*right as usize, (k, *left))]
        });
        let at_joints = arcs.iter().zip(0..).flat_map(|(arc, k)| arc.joints.map(|j| (j as usize, k)));
        let (around, at_joint) = (Rows::sorted(count, at_cells), Rows::sorted(is_flat.len(), at_joints));
        let extent = map.extent();
        Self {
            bounds,
            whole: area.iter().sum(),
            area,
            size,
            inner: rims.iter().map(inner).collect(),
            rims: rims.into_par_iter().map(|rim| Boxes::of(uv, rim)).collect(),
            extremes: (0..count).into_par_iter().map(|c| extremes(&convex_hull(points(c)), axis)).collect(),
            sides,
            directions: std::array::from_fn(|k| {
                let direction = axis * Complex64::cis(FRAC_PI_2 * k as f64 / QUARTER as f64);
                [direction.re, direction.im]
            }),
            cell,
            arcs,
            around,
            is_flat,
            at_joint,
            least: ALLOWED * NEGLIGIBLE_DEPTH * extent,
            extent,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.size.len()
    }

    /// Whether two motions differ by rounding alone.
    pub(super) fn is_same(&self, one: &Motion, other: &Motion) -> bool {
        (one.turn - other.turn).norm_sqr() < SAME_MOTION.powi(2)
            && (one.shift - other.shift).norm_sqr() < (SAME_MOTION * self.extent).powi(2)
    }

    /// Whether two cells lie over each other.
    pub(super) fn overlap(&self, [p, q]: [u32; 2], [motion, other]: [&Motion; 2], known: &mut Known) -> bool {
        if self.area[q as usize] < self.area[p as usize] || (self.area[q as usize] == self.area[p as usize] && q < p) {
            return self.overlap_of_smaller([q, p], &motion.inverse().after(other), known);
        }
        self.overlap_of_smaller([p, q], &other.inverse().after(motion), known)
    }

    fn overlap_of_smaller(&self, [p, q]: [u32; 2], motion: &Motion, known: &mut Known) -> bool {
        let rounded = |x: f64| (x / SAME_MOTION).round() as i64;
        let Motion { turn, shift } = motion;
        let of_extent = *shift / self.extent;
        let name = [turn.re, turn.im, of_extent.re, of_extent.im].map(rounded);
        *known.entry((p, q, name)).or_insert_with(|| self.meet([p, q], motion))
    }

    fn meet(&self, [p, q]: [u32; 2], motion: &Motion) -> bool {
        let [moved, still] = [p, q].map(|cell| self.bounds[cell as usize]);
        may_meet(moved, still, motion)
            && (self.touch([p, q], motion) || self.is_within(q as usize, motion.of(self.inner[p as usize])))
    }

    /// Whether triangles at the boundaries of two cells overlap where the first is moved.
    pub(super) fn touch(&self, [p, q]: [u32; 2], motion: &Motion) -> bool {
        self.rims[p as usize].lie_over(&self.rims[q as usize], motion, self.least)
    }

    /// Whether a point is within the boundary of a cell: a ray from it crosses that an odd number of times.
    fn is_within(&self, c: usize, [x, y]: [f64; 2]) -> bool {
        let crosses = |[[a, b], [c, d]]: [[f64; 2]; 2]| (b > y) != (d > y) && x < a + (y - b) / (d - b) * (c - a);
        self.sides[c].iter().filter(|&&side| crosses(side)).count() % 2 == 1
    }

    /// Which of the arcs are seams; `is_open` says which are not glued.
    pub(super) fn seams<'r>(&self, is_open: impl Iterator<Item = bool>, room: &'r mut SeamRoom) -> &'r [bool] {
        let SeamRoom { open, degree, ends } = room;
        open.clear();
        open.extend(is_open);
        degree.clear();
        degree.resize(self.is_flat.len(), 0);
        for (arc, _) in self.arcs.iter().zip(&*open).filter(|(_, open)| **open) {
            arc.joints.iter().for_each(|&j| degree[j as usize] += 1);
        }
        ends.clear();
        ends.extend((0..degree.len() as u32).filter(|&j| degree[j as usize] == 1));
        while let Some(j) = ends.pop() {
            if degree[j as usize] != 1 || !self.is_flat[j as usize] {
                continue;
            }
            let &k = self.at_joint.row(j as usize).iter().find(|&&k| open[k as usize]).expect("one is open");
            if self.arcs[k as usize].motion.is_some() {
                open[k as usize] = false;
                for j in self.arcs[k as usize].joints {
                    degree[j as usize] -= 1;
                    ends.push(j);
                }
            }
        }
        open
    }

    /// The map whose cells have these motions, open at these arcs.
    pub(super) fn moved(&self, mesh: &Mesh, open: &[bool], motion: Vec<Motion>) -> Moved {
        let mut cut = EdgeData::constant(mesh.edge_count(), false);
        for (arc, _) in self.arcs.iter().zip(open).filter(|(_, open)| **open) {
            arc.sides.iter().for_each(|&h| cut[mesh.edge(h)] = true);
        }
        Moved { piece: self.cell.clone(), motion, cut }
    }
}

/// The triangles of each cell that have a corner on its boundary; all that have an area where one of these has none.
fn rims(
    mesh: &Mesh,
    areas: &[Option<f64>],
    (cell, count): (&FaceData<u32>, usize),
    network: &EdgeData<bool>,
) -> Vec<Vec<u32>> {
    let is_open = open_vertices(mesh, network);
    let is_rim = |f: &FaceId| mesh.corners(*f).into_iter().any(|v| is_open[v]);
    let has_area = |f: &FaceId| areas[f.index()].is_some();
    let mut needs_all = vec![false; count];
    mesh.faces().filter(|f| is_rim(f) && !has_area(f)).for_each(|f| needs_all[cell[f] as usize] = true);
    let mut rims = vec![Vec::new(); count];
    for f in mesh.faces().filter(|f| has_area(f) && (needs_all[cell[*f] as usize] || is_rim(f))) {
        rims[cell[f] as usize].push(f.0);
    }
    rims
}

/// The number of each island: the largest first.
fn largest_first(mesh: &Mesh, areas: &[Option<f64>], opened: &Islands) -> Vec<u32> {
    let count = opened.count();
    let (mut area, mut first) = (vec![0.0; count], vec![[VertexId(u32::MAX); 3]; count]);
    for f in mesh.faces() {
        let island = opened.of(f) as usize;
        area[island] += areas[f.index()].unwrap_or(0.0);
        first[island] = sorted(mesh.corners(f)).min(first[island]);
    }
    let whole: f64 = area.iter().sum();
    let mut islands: Vec<usize> = (0..count).collect();
    islands.sort_by_cached_key(|&island| (Reverse(share(area[island], whole, NUMBERED)), first[island]));
    let mut number = vec![0; count];
    islands.into_iter().zip(0..).for_each(|(island, k)| number[island] = k);
    number
}

/// How many parts of so many of a whole something has.
fn share(of: f64, whole: f64, parts: f64) -> u64 {
    if whole > 0.0 { (of / whole * parts).round() as u64 } else { 0 }
}

fn sorted<const N: usize>(mut vertices: [VertexId; N]) -> [VertexId; N] {
    vertices.sort_unstable();
    vertices
}

/// The arcs of a network, and whether its joints are flat.
fn arcs(
    (mesh, kept): (&Mesh, Option<&EdgeData<bool>>),
    seam: impl Fn(&[HalfedgeId]) -> [f64; 2],
    map: &UvMap,
    network: &EdgeData<bool>,
    cell: &FaceData<u32>,
) -> (Vec<Arc>, Vec<bool>) {
    let extent = map.extent();
    let is_inner = |e: EdgeId| network[e] && !mesh.is_boundary_edge(e);
    let at = |v: VertexId| edges_at(mesh, v).filter(|&(e, _)| is_inner(e)).map(|(e, _)| e);
    let is_flat = |v: VertexId| !mesh.is_boundary_vertex(v) && (angle(mesh, map, v) - TAU).abs() < FLAT;
    // Where what is kept begins or ends, too.
    let is_kept = |e: EdgeId| kept.is_some_and(|kept| kept[e]);
    let is_joint = |v: VertexId| {
        let edges: Vec<EdgeId> = at(v).collect();
        edges.len() != 2 || is_kept(edges[0]) != is_kept(edges[1]) || !is_flat(v)
    };
    let mut joint: Table<VertexId, u32> = Table::default();
    let mut flat = Vec::new();
    let mut number = |v: VertexId| {
        *joint.entry(v).or_insert_with(|| {
            flat.push(is_flat(v));
            flat.len() as u32 - 1
        })
    };
    let mut is_done = EdgeData::constant(mesh.edge_count(), false);
    let mut arcs = Vec::new();
    let inner: Vec<EdgeId> = mesh.edges().filter(|&e| is_inner(e)).collect();
    // From joints first; what is left are loops without one.
    let from_joints = inner.iter().flat_map(|&e| mesh.ends(e).map(|v| (v, e))).filter(|&(v, _)| is_joint(v));
    let loops = inner.iter().map(|&e| (mesh.ends(e)[0], e));
    for (start, first) in from_joints.chain(loops).collect::<Vec<_>>() {
        if is_done[first] {
            continue;
        }
        let (mut v, mut e) = (start, first);
        let mut sides: Vec<HalfedgeId> = Vec::new();
        loop {
            is_done[e] = true;
            let h = mesh.halfedge(e);
            let twin = mesh.twin(h).expect("an inner edge has two");
            sides.push(if mesh.tail(h) == v { h } else { twin });
            v = mesh.ends(e).into_iter().find(|&w| w != v).unwrap_or(v);
            if v == start || is_joint(v) {
                break;
            }
            let next = at(v).find(|&next| !is_done[next]);
            let Some(next) = next else { break };
            e = next;
        }
        let twin = mesh.twin(sides[0]).expect("an inner edge has two");
        let cells = [sides[0], twin].map(|h| cell[mesh.face(h)]);
        let motion = if sides.iter().any(|&h| is_kept(mesh.edge(h))) {
            None
        } else {
            motion_across(mesh, &sides, |h| map.position[h], extent)
        };
        let [cost, length] = seam(&sides);
        let joints = [number(start), number(v)];
        arcs.push(Arc { sides, cells, motion, cost, length, joints });
    }
    (arcs, flat)
}

/// The corners of a convex polygon that are farthest in one of some directions.
fn extremes(hull: &[Complex64], axis: Complex64) -> Vec<Complex64> {
    let farthest = |k: usize| {
        let direction = axis * Complex64::cis(TAU * k as f64 / DIRECTIONS as f64);
        let along = |&j: &usize| (hull[j] * direction.conj()).re;
        (0..hull.len()).max_by(|i, j| along(i).total_cmp(&along(j)))
    };
    let mut found: Vec<usize> = (0..DIRECTIONS).filter_map(farthest).collect();
    found.sort_unstable();
    found.dedup();
    found.into_iter().map(|j| hull[j]).collect()
}

/// The sum of the angles at a vertex.
fn angle(mesh: &Mesh, map: &UvMap, v: VertexId) -> f64 {
    let at = |h: HalfedgeId| Complex64::new(map.position[h][0], map.position[h][1]);
    let corner = |h: HalfedgeId| {
        let [here, next, before] = [h, mesh.next(h), mesh.prev(h)].map(at);
        ((next - here).conj() * (before - here)).arg().abs()
    };
    mesh.outgoing(v).map(corner).sum()
}
