//! The overlaps of a map that is folded over hardly anywhere, found from its boundary and its folds.
//!
//! Near most inner points a map is one to one: the triangles are counter-clockwise, and those about a vertex wind round it once. The pairs of
//! different points with one image fall into connected regions. In the pair of a region that lies farthest out in some direction one point is
//! on the boundary, or the map is not one to one near it: else both could be moved on in that direction, and their images would stay one. So
//! only sides on the boundary, and triangles about vertices that the map winds round otherwise or that a triangle has which is turned over, are
//! looked up among all; from each pair found one goes on to the neighbours of either triangle across sides that the other may reach, as long as they overlap. That looks at the pairs
//! there are and what borders on them, not at all triangles and their neighbours: on layouts of 28,576 triangles a third of the time of
//! [`overlaps`](super::overlaps). Sides and not their triangles, since the bounding boxes of needles meet those of a good part of all others.
//! Regions are gone through as long as triangles do not come to lie on others side on side, to the bit.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use geom::{FaceData, FaceId, Id, Interrupted, Islands, Mesh, VertexData, Watch, open_vertices};
use rayon::prelude::*;

use super::boxes::{Boxes, bounds, joined};
use super::map::UvMap;
use super::overlap::{FREE_PAIRS, NEGLIGIBLE_DEPTH, Overlap, Overlaps};
use super::table::Set;
use super::triangle::{self, Triangle};

/// Extents beyond which products of coordinates overflow or vanish.
const EXTENTS: std::ops::Range<f64> = 1e-60..1e60;
/// So many triangles are looked up between two looks at the watch,
const LOOKED_UP: usize = 1 << 15;
/// and so many pairs gone through.
const BLOCK: usize = 1 << 14;
/// So many pairs are kept for each triangle, and [`FREE_PAIRS`] besides, lest what is looked up beside them fill the memory.
const MOST_PAIRS: usize = 4;
/// So many squares at most are at a side of the grid that tells what is near.
const MOST_SQUARES: usize = 4096;
/// So many triangles are looked up one after the other.
const AT_ONCE: usize = 1 << 10;
/// More islands than this are many.
const MANY_ISLANDS: usize = 64;
/// So many pairs of a triangle are remembered in a list, further ones in a hash set.
const LONGEST_LIST: usize = 24;

/// The pairs of triangles on one island that overlap deeper than [`NEGLIGIBLE_DEPTH`]; none if the map
/// has more than are kept.
///
/// # Errors
/// If it is stopped.
pub(super) fn overlaps_from_boundary(mesh: &Mesh, map: &UvMap, watch: Watch) -> Result<Option<Overlaps>, Interrupted> {
    watch.ask(0.0)?;
    let uv = map.triangles();
    let (islands, is_folded) = rayon::join(|| map.islands(mesh), || folds(mesh, map));
    watch.ask(0.0)?;
    let (first, of_face) = first_to_look_at(mesh, map, &islands, &is_folded);
    watch.ask(0.0)?;
    // The box about these is about all, too.
    let [low, high] = first.iter().map(bounds).reduce(joined).unwrap_or_default();
    let extent = (high[0] - low[0]).max(high[1] - low[1]);
    if !EXTENTS.contains(&extent) {
        return Ok(None);
    }
    let apart = Apart::new(islands.count(), extent);
    let moved: Vec<Triangle> = first.iter().zip(&of_face).map(|(t, &f)| apart.moved(t, islands.of(f))).collect();
    let boxes = Boxes::of(&moved, (0..moved.len() as u32).collect());
    let most = FREE_PAIRS + MOST_PAIRS * uv.len();
    // A pair is found from either triangle. Whether there are too many does not depend on who stops first.
    let found = AtomicUsize::new(0);
    let are_few = || found.load(Relaxed) <= 2 * most;
    let upright = |f: FaceId| triangle::upright(map.triangle(f));
    let near = Near::new(uv.len(), &moved, &boxes);
    let with_first = |g: u32| {
        let g = FaceId(g);
        let mut of_one = Vec::new();
        let may_meet = near.may_meet(&apart.moved(&uv[g.index()], islands.of(g))) && are_few();
        if let Some(one) = upright(g).filter(|_| may_meet) {
            boxes.meeting(&apart.moved(&one, islands.of(g)), |place| {
                let f = of_face[place as usize];
                if f != g
                    && islands.of(f) == islands.of(g)
                    && let Some(other) = upright(f)
                    && triangle::depth(&one, &other).is_some()
                {
                    of_one.push([f, g]);
                    found.fetch_add(1, Relaxed);
                }
                are_few()
            });
        }
        of_one
    };
    let mut spread = Spread::new(uv.len());
    for first in (0..uv.len() as u32).step_by(LOOKED_UP) {
        let block = (first..uv.len().min(first as usize + LOOKED_UP) as u32).into_par_iter().with_min_len(AT_ONCE);
        let pairs: Vec<[FaceId; 2]> = block.flat_map_iter(with_first).collect();
        if !are_few() {
            return Ok(None);
        }
        pairs.into_iter().for_each(|[f, g]| spread.look(f, g));
        watch.ask(0.0)?;
    }
    let overlap = |[f, g]: [FaceId; 2]| {
        let (one, other) = (upright(f)?, upright(g)?);
        let depth = triangle::depth(&one, &other)?;
        let is_deep = depth > NEGLIGIBLE_DEPTH * extent;
        let area = if is_deep { triangle::common_area(&one, &other) } else { 0.0 };
        let beyond = [(f, &other), (g, &one)].map(|(f, other)| neighbors_reached(mesh, map, f, other));
        Some(Found { overlap: Overlap { triangles: [f.0, g.0], depth: depth / extent, area }, is_deep, beyond })
    };
    let mut pairs = Vec::new();
    let mut count = 0;
    let mut found: Vec<Found> = Vec::new();
    while !(spread.waiting.is_empty() && found.is_empty()) {
        watch.ask(1.0 - 1.0 / (1 + count / BLOCK) as f64)?;
        // The last ones first: what is next to them is at hand. They are looked at while one goes on from those before.
        let last = spread.waiting.split_off(spread.waiting.len().saturating_sub(BLOCK));
        count += last.len();
        let go_on = || {
            for Found { overlap, is_deep, beyond: [of_f, of_g] } in std::mem::take(&mut found) {
                let [f, g] = overlap.triangles.map(FaceId);
                pairs.extend(is_deep.then_some(overlap));
                of_f.into_iter().flatten().for_each(|beside| spread.look(beside, g));
                of_g.into_iter().flatten().for_each(|beside| spread.look(beside, f));
            }
        };
        let look = || last.into_par_iter().with_min_len(AT_ONCE).filter_map(overlap).collect();
        ((), found) = rayon::join(go_on, look);
        if pairs.len() > most {
            return Ok(None);
        }
    }
    pairs.par_sort_unstable_by_key(|pair| pair.triangles);
    Ok(Some(Overlaps { pairs, extent, is_complete: true }))
}

/// Where islands are looked for each other's triangles: a cell each in rows, if they are many, which lie all over each other as they are laid out. What
/// is moved is off by rounding of some 1e-12 of the extent, which is no overlap yet; whether two triangles overlap is told by where they are.
struct Apart {
    /// The side of a cell, and how many are in a row.
    cell: f64,
    row: u32,
}

impl Apart {
    fn new(islands: usize, extent: f64) -> Self {
        Self { cell: if islands > MANY_ISLANDS { 1.5 * extent } else { 0.0 }, row: islands.isqrt() as u32 + 1 }
    }

    fn moved(&self, triangle: &Triangle, island: u32) -> Triangle {
        if self.cell == 0.0 {
            return *triangle;
        }
        let [dx, dy] = [island % self.row, island / self.row].map(|step| self.cell * f64::from(step));
        triangle.map(|[x, y]| [x + dx, y + dy])
    }
}

/// Two triangles that overlap.
struct Found {
    overlap: Overlap,
    /// Whether that is more than rounding.
    is_deep: bool,
    /// The neighbours of each that the other may reach.
    beyond: [[Option<FaceId>; 3]; 2],
}

/// A grid of squares, and which of them the bounding boxes of some triangles meet: most of a map's triangles are near none of its boundary.
struct Near {
    low: [f64; 2],
    /// Squares to a unit of length.
    scale: f64,
    /// Squares to a side.
    side: usize,
    /// Whether boxes meet each, row by row; empty if they meet too many to be worth it.
    is_met: Vec<bool>,
}

impl Near {
    /// Those of a map of so many triangles.
    fn new(count: usize, first: &[Triangle], boxes: &Boxes) -> Self {
        let side = ((count as f64).sqrt() as usize).clamp(1, MOST_SQUARES);
        let [low, _] = boxes.bounds().unwrap_or_default();
        let scale = side as f64 / boxes.extent;
        let mut near = Self { low, scale, side, is_met: vec![false; side * side] };
        let mut left = count;
        for triangle in first {
            let [columns, rows] = near.squares(triangle);
            let count = columns.len() * rows.len();
            if count > left {
                near.is_met.clear();
                break;
            }
            left -= count;
            rows.for_each(|row| near.is_met[row * side + columns.start..row * side + columns.end].fill(true));
        }
        near
    }

    /// The columns and rows that the bounding box of a triangle meets.
    fn squares(&self, triangle: &Triangle) -> [Range<usize>; 2] {
        let [from, to] = bounds(triangle).map(|p| [0, 1].map(|i| ((p[i] - self.low[i]) * self.scale) as usize));
        // What is not finite ends before it begins.
        [0, 1].map(|i| from[i].min(self.side - 1)..to[i].max(from[i]).min(self.side - 1) + 1)
    }

    /// Whether a triangle's bounding box may meet one of them.
    fn may_meet(&self, triangle: &Triangle) -> bool {
        let [columns, rows] = self.squares(triangle);
        let is_met = |row: usize| {
            self.is_met[row * self.side + columns.start..row * self.side + columns.end].iter().any(|&met| met)
        };
        self.is_met.is_empty() || rows.into_iter().any(is_met)
    }
}

/// The neighbours of a triangle across sides that are not open and that another one may reach.
fn neighbors_reached(mesh: &Mesh, map: &UvMap, f: FaceId, other: &Triangle) -> [Option<FaceId>; 3] {
    let is_reached = reached_by(map.triangle(f), other);
    let sides = mesh.sides(f);
    std::array::from_fn(|k| {
        let inner = Some(sides[k]).filter(|&h| is_reached[k] && !map.cut[mesh.edge(h)]);
        inner.and_then(|h| mesh.twin(h)).map(|twin| mesh.face(twin))
    })
}

/// Which sides of a triangle another one may reach: it is not, beyond rounding, all on the inner side of their lines. The images of points that
/// go on across a side together lie on it.
fn reached_by(corners: Triangle, other: &Triangle) -> [bool; 3] {
    let is_inside = |[a, b]: [[f64; 2]; 2], p: &[f64; 2]| {
        let [one, two] = [(b[0] - a[0]) * (p[1] - a[1]), (b[1] - a[1]) * (p[0] - a[0])];
        one - two > 8.0 * f64::EPSILON * (one.abs() + two.abs())
    };
    let is_upright = triangle::upright(corners) == Some(corners);
    [0, 1, 2].map(|k| !is_upright || !other.iter().all(|p| is_inside([corners[k], corners[(k + 1) % 3]], p)))
}

/// The pairs that were seen.
struct Spread {
    /// For each triangle one more than where the list begins of those with greater numbers that it was seen with; 0 where it is empty. What is
    /// near in the plane is mostly near in memory, too, which a hash would end.
    first: Vec<u32>,
    /// The triangles of the lists, each with one more than where the next one is.
    lists: Vec<(FaceId, u32)>,
    /// What is on lists that are too long.
    others: Set<u64>,
    waiting: Vec<[FaceId; 2]>,
}

impl Spread {
    /// Of so many triangles.
    fn new(count: usize) -> Self {
        Self { first: vec![0; count], lists: Vec::new(), others: Set::default(), waiting: Vec::new() }
    }

    fn look(&mut self, f: FaceId, g: FaceId) {
        let [f, g] = [f.min(g), f.max(g)];
        if f != g && self.is_new(f, g) {
            self.waiting.push([f, g]);
        }
    }

    /// Whether a pair has not been seen. It has been then.
    fn is_new(&mut self, f: FaceId, g: FaceId) -> bool {
        let begin = self.first[f.index()];
        let mut next = begin;
        for _ in 0..LONGEST_LIST {
            let Some(at) = next.checked_sub(1) else {
                self.lists.push((g, begin));
                self.first[f.index()] = self.lists.len() as u32;
                return true;
            };
            let (other, after) = self.lists[at as usize];
            if other == g {
                return false;
            }
            next = after;
        }
        self.others.insert(u64::from(f.0) << 32 | u64::from(g.0))
    }
}

/// The vertices near which the map is not one to one: those of triangles that are turned over, and those inside islands that it does not wind
/// round once. Of the triangles about one that it does exactly one has the direction to the right; signs of differences tell, which is exact.
fn folds(mesh: &Mesh, map: &UvMap) -> VertexData<bool> {
    let is_open = open_vertices(mesh, &map.cut);
    let mut rounds: VertexData<u8> = VertexData::constant(mesh.vertex_count(), 0);
    let mut is_folded = VertexData::constant(mesh.vertex_count(), false);
    for f in mesh.faces() {
        let corners: Triangle = map.triangle(f);
        if triangle::upright(corners) != Some(corners) {
            mesh.corners(f).into_iter().for_each(|v| is_folded[v] = true);
        }
        for (k, h) in mesh.sides(f).into_iter().enumerate() {
            let [at, next, last] = [0, 1, 2].map(|i| corners[(k + i) % 3][1]);
            let v = mesh.tail(h);
            rounds[v] = rounds[v].saturating_add(u8::from(next < at && last >= at));
        }
    }
    mesh.vertices().filter(|&v| !is_open[v] && rounds[v] != 1).for_each(|v| is_folded[v] = true);
    is_folded
}

/// The sides on the boundary, as triangles without area, and the triangles about vertices near which the map is not one to one: of which
/// triangles, all of these with an area.
fn first_to_look_at(
    mesh: &Mesh,
    map: &UvMap,
    islands: &Islands,
    is_folded: &VertexData<bool>,
) -> (Vec<Triangle>, Vec<FaceId>) {
    let faces = (0..mesh.face_count()).into_par_iter().with_min_len(AT_ONCE).map(FaceId::new);
    let is_whole: Vec<bool> = faces.map(|f| mesh.corners(f).into_iter().any(|v| is_folded[v])).collect();
    let is_whole: FaceData<bool> = is_whole.into();
    let whole = mesh.faces().filter(|&f| is_whole[f]).map(|f| (map.triangle(f), f));
    let ends = |h| [h, mesh.next(h)].map(|h| map.position[h]);
    let sides = islands.boundary_loops().iter().flatten().map(|&h| (ends(h), mesh.face(h)));
    let sides = sides.filter(|&(_, f)| !is_whole[f]).map(|([from, to], f)| ([from, to, to], f));
    whole.chain(sides).filter(|&(_, f)| triangle::upright(map.triangle(f)).is_some()).unzip()
}

#[cfg(test)]
mod tests {
    use super::super::overlap::overlaps;
    use super::*;
    use geom::{HalfedgeData, Id, VertexId, shapes};
    use num_complex::Complex64;

    fn of(mesh: &Mesh, map: &UvMap) -> Option<Overlaps> {
        overlaps_from_boundary(mesh, map, Watch::NONE).unwrap()
    }

    #[test]
    fn among_many_islands_each_is_looked_at_by_itself() {
        let (mesh, mut map) = image(|w| w * w * (1.0 + 0.13 * w));
        // Rings, on each of which about w and -w lie over each other, and to the right each triangle by itself.
        let middle = |f: FaceId| {
            let [a, b, c] = map.triangle(f);
            [0, 1].map(|i| (a[i] + b[i] + c[i]) / 3.0)
        };
        let cell = |f: FaceId| {
            let [x, y] = middle(f);
            if x > 0.4 { f.0 } else { u32::MAX - (6.0 * x.hypot(y)) as u32 }
        };
        let is_cut = |e: geom::EdgeId| {
            let h = mesh.halfedge(e);
            mesh.twin(h).is_some_and(|g| cell(mesh.face(h)) != cell(mesh.face(g)))
        };
        map.cut = mesh.edges().map(is_cut).collect();
        let islands = map.islands(&mesh);
        assert!(islands.count() > MANY_ISLANDS);
        let found = of(&mesh, &map).unwrap();
        let mut expected = overlaps(map.triangles());
        expected.pairs.retain(|pair| islands.of(FaceId(pair.triangles[0])) == islands.of(FaceId(pair.triangles[1])));
        assert!(expected.pairs.len() > 200, "{}", expected.pairs.len());
        let triangles = |overlaps: &Overlaps| overlaps.pairs.iter().map(|pair| pair.triangles).collect::<Vec<_>>();
        assert_eq!(triangles(&found), triangles(&expected));
        assert_eq!(found.extent, expected.extent);
    }

    /// The image of the unit disk under a function.
    fn image(of: impl Fn(Complex64) -> Complex64) -> (Mesh, UvMap) {
        let shape = shapes::disk(900);
        let mesh = shape.mesh();
        let at = |v: geom::VertexId| {
            let [x, y, _] = shape.points[v.index()];
            let w = of(Complex64::new(x, y));
            [w.re, w.im]
        };
        let position: HalfedgeData<[f64; 2]> = mesh.halfedges().map(|h| at(mesh.tail(h))).collect();
        let map = UvMap::new(&mesh, position);
        (mesh, map)
    }

    /// That the overlaps found are those of all triangles; how many there are.
    fn check(mesh: &Mesh, map: &UvMap) -> usize {
        let found = of(mesh, map).expect("it is folded over hardly anywhere");
        let all = overlaps(map.triangles());
        let of = |overlaps: &Overlaps| overlaps.pairs.iter().map(|pair| pair.triangles).collect::<Vec<_>>();
        assert_eq!((of(&found).len(), found.extent), (of(&all).len(), all.extent));
        assert_eq!(of(&found), of(&all));
        all.pairs.len()
    }

    #[test]
    fn where_it_winds_round_a_point_twice_or_is_mirrored_is_looked_at_too() {
        let (mesh, map) = image(|z| 4.0 * z + z * z * z / 3.0);
        assert_eq!(check(&mesh, &map), 0);
        let mirrored = UvMap { position: map.position.iter().map(|[x, y]| [-x, *y]).collect(), cut: map.cut };
        assert_eq!(check(&mesh, &mirrored), 0);
        // Beside the middle, where no triangle lies just on another.
        let (mesh, twice) = image(|z| (z + 0.013) * (z + 0.013));
        assert!(check(&mesh, &twice) > mesh.face_count() / 2);
    }

    #[test]
    fn what_is_folded_over_inside_or_has_no_area_is_found() {
        let shape = shapes::disk(900);
        let mesh = shape.mesh();
        let flat: Vec<[f64; 2]> = shape.points.iter().map(|&[x, y, _]| [x, y]).collect();
        let mut folded = 0;
        for seed in 0..40_usize {
            let mut at = flat.clone();
            for k in 0..4 {
                let v = (seed * 7919 + k * 104_729) % at.len();
                let neighbor = mesh.neighbors(VertexId::new(v))[0].index();
                // Beyond a neighbour, or on it, so that triangles have no area.
                let far = if k == 0 { 1.0 } else { 1.0 + 0.3 * k as f64 };
                at[v] = [0, 1].map(|i| flat[v][i] + far * (flat[neighbor][i] - flat[v][i]));
            }
            let map = UvMap::new(&mesh, mesh.halfedges().map(|h| at[mesh.tail(h).index()]).collect());
            folded += usize::from(check(&mesh, &map) > 0);
        }
        assert!(folded > 30, "{folded}");
    }

    #[test]
    fn what_is_not_finite_overlaps_nothing() {
        let (mesh, map) = image(|z| 4.0 * z + z * z * z / 3.0);
        for (count, x) in [(3, f64::NAN), (4, f64::NAN), (3, f64::INFINITY), (2, f64::NEG_INFINITY)] {
            let mut map = map.clone();
            map.position.iter_mut().take(count).for_each(|p| p[0] = x);
            assert_eq!(check(&mesh, &map), 0);
        }
    }

    #[test]
    fn what_lies_over_itself_after_a_full_turn_is_found_from_the_boundary_inside_too() {
        for speed in [3.0, 4.0, 6.0] {
            let (mesh, map) = image(|z| (speed * z).exp());
            // The exponential function has no critical point.
            assert_eq!(check(&mesh, &map) == 0, speed < std::f64::consts::PI);
        }
    }
}
