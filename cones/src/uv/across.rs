//! Short cuts across an island, and what they leave on either side.
//!
//! As in [`divide`](super::divide): with T the shortest paths to what is open, each edge that is in neither T nor open closes
//! a path across, and these edges are a spanning tree of the island's triangles. Gone through in preorder, the triangles on
//! one side of a path are a range. So areas and extents on both sides are found for all paths in one sweep.

use std::f64::consts::PI;
use std::sync::OnceLock;

use geom::{
    EdgeData, EdgeId, FaceData, FaceId, HalfedgeId, Interrupted, Islands, Mesh, ShortestPaths, VertexData, VertexId,
    Watch, open_vertices, other_end,
};
use rayon::prelude::*;

use super::map::UvMap;
use super::triangle;

/// Extents are measured in so many directions, evenly over half a turn.
const DIRECTIONS: usize = 8;

/// So many paths are spread over an island,
const MOST_PATHS: usize = 64;
/// none of which passes within this share of the root of the island's area of a shorter one, which is the same however the map is turned.
const NEAR: f64 = 0.04;
/// Either side of them has at least this share of the island's area.
const LEAST_SHARE: f64 = 0.005;

/// How far something reaches in each direction, and in each opposite one.
type Reach = [f32; 2 * DIRECTIONS];
const NOWHERE: Reach = [f32::MIN; 2 * DIRECTIONS];

/// So many triangles are looked at one after the other.
const AT_ONCE: usize = 1024;

/// A path across an island.
#[derive(Clone, Debug)]
pub(super) struct Across {
    /// The edge that closes it.
    edge: EdgeId,
    pub(super) length: f64,
    /// A point on it.
    middle: [f64; 2],
    /// The triangles on one side, as they are numbered in the sweep.
    first: usize,
    end: usize,
}

/// The paths across the islands of a map.
pub(super) struct Paths<'a> {
    mesh: &'a Mesh,
    lengths: &'a EdgeData<f64>,
    map: &'a UvMap,
    islands: Islands,
    shortest: ShortestPaths,
    /// For each vertex the [corner](Self::corner) at which its path arrives, once somebody asks for rings.
    arrivals: OnceLock<VertexData<Option<HalfedgeId>>>,
}

/// The triangles of an island in preorder.
pub(super) struct Sweep {
    faces: Vec<FaceId>,
    /// The edge over which a triangle was reached.
    over: Vec<Option<EdgeId>>,
    /// Where the range of what was reached from a triangle ends.
    end: Vec<usize>,
    /// Where a triangle is; the island's only.
    place: FaceData<u32>,
    /// The sides on the island's boundary, and where their triangles are, which ascends.
    rim: Vec<(usize, [[f64; 2]; 2])>,
    /// Element k: the area of the first k triangles.
    area: Vec<f64>,
}

/// One side of a path, or a whole island: its boundary, and its area in the plane.
#[derive(Clone, Debug)]
pub(super) struct Side {
    pub(super) edges: Vec<[[f64; 2]; 2]>,
    pub(super) area: f64,
}

impl<'a> Paths<'a> {
    /// `lengths` are those of space, infinite where nothing may be cut.
    pub(super) fn new(
        mesh: &'a Mesh,
        lengths: &'a EdgeData<f64>,
        map: &'a UvMap,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let is_open = open_vertices(mesh, &map.cut);
        let sources = mesh.vertices().filter(|&v| is_open[v]).zip(0..);
        let shortest = || ShortestPaths::new_watched(mesh, lengths, sources, watch);
        let (shortest, islands) = rayon::join(shortest, || map.islands(mesh));
        Ok(Self { mesh, lengths, map, islands, shortest: shortest?, arrivals: OnceLock::new() })
    }

    /// The triangles of each island.
    pub(super) fn islands(&self) -> Vec<Vec<FaceId>> {
        self.islands.faces()
    }

    /// An island's boundary and area.
    pub(super) fn outline(&self, island: &[FaceId]) -> Side {
        let rim = island.iter().flat_map(|&f| self.rim(f)).map(|h| self.segment(h));
        Side { edges: rim.collect(), area: island.iter().map(|&f| self.area(f)).sum() }
    }

    /// The sides of a triangle that are on the boundary of its island.
    fn rim(&self, f: FaceId) -> impl Iterator<Item = HalfedgeId> {
        let is_open = |h: &HalfedgeId| self.mesh.twin(*h).is_none() || self.map.cut[self.mesh.edge(*h)];
        self.mesh.sides(f).into_iter().filter(is_open)
    }

    /// Goes through an island; nothing if it is no disk.
    pub(super) fn sweep(&self, island: &[FaceId]) -> Option<Sweep> {
        let mesh = self.mesh;
        let in_tree = |e: EdgeId| mesh.ends(e).iter().any(|&v| self.shortest.predecessor[v] == Some(e));
        let mut place = FaceData::constant(mesh.face_count(), u32::MAX);
        let mut faces = Vec::with_capacity(island.len());
        let (mut over, mut depth) = (Vec::new(), Vec::new());
        let mut waiting = vec![(*island.first()?, None, 0)];
        while let Some((f, edge, level)) = waiting.pop() {
            if place[f] != u32::MAX {
                return None; // reached twice: not a tree
            }
            place[f] = faces.len() as u32;
            faces.push(f);
            over.push(edge);
            depth.push(level);
            for h in mesh.sides(f) {
                let e = mesh.edge(h);
                if let Some(g) = mesh.twin(h)
                    && !self.map.cut[e]
                    && !in_tree(e)
                    && edge != Some(e)
                {
                    waiting.push((mesh.face(g), Some(e), level + 1));
                }
            }
        }
        if faces.len() != island.len() {
            return None;
        }
        let mut end: Vec<usize> = vec![faces.len(); faces.len()];
        let mut above: Vec<usize> = Vec::new();
        for (k, &level) in depth.iter().enumerate() {
            while above.len() > level {
                end[above.pop().expect("it is not empty")] = k;
            }
            above.push(k);
        }
        let mut area = vec![0.0];
        let mut rim = Vec::new();
        for (k, &f) in faces.iter().enumerate() {
            area.push(area[k] + self.area(f));
            rim.extend(self.rim(f).map(|h| (k, self.segment(h))));
        }
        Some(Sweep { faces, over, end, place, rim, area })
    }

    /// The paths across an island that are not longer than `most` and leave at least a share of the area on either side. With `rings`, also those
    /// that begin and end at one point of the surface, on two sides of a seam, as they go round a tube.
    pub(super) fn across(&self, sweep: &Sweep, most: f64, least_share: f64, rings: bool) -> Vec<Across> {
        let (areas, count) = (&sweep.area, sweep.faces.len());
        let whole = areas[count];
        let found = (1..count).filter_map(|k| {
            let (edge, end) = (sweep.over[k]?, sweep.end[k]);
            let share = (areas[end] - areas[k]) / whole;
            let length = self.length(edge);
            if length > most || share < least_share || share > 1.0 - least_share {
                return None;
            }
            self.is_across(edge, rings).then_some(())?;
            let middle = self.middle(edge);
            Some(Across { edge, length, middle, first: k, end })
        });
        found.collect()
    }

    /// The shortest of the paths across an island, none of which passes near a shorter one.
    pub(super) fn spread(&self, sweep: &Sweep) -> Vec<Across> {
        let mut across = self.across(sweep, f64::MAX, LEAST_SHARE, false);
        across.sort_by(|a, b| a.length.total_cmp(&b.length));
        let near = NEAR * sweep.area[sweep.faces.len()].sqrt();
        let mut chosen: Vec<Across> = Vec::new();
        for path in across {
            if chosen.len() == MOST_PATHS {
                break;
            }
            if chosen.iter().all(|other| other.distance(&path) > near) {
                chosen.push(path);
            }
        }
        chosen
    }

    /// For each path, in the order of the sweep, the areas of rectangles about both sides, over that of one about the island.
    /// However the island lies they are the same.
    ///
    /// # Errors
    /// If it is stopped.
    pub(super) fn rectangles(&self, sweep: &Sweep, across: &[Across], watch: Watch) -> Result<Vec<f64>, Interrupted> {
        let corners = sweep.faces.iter().flat_map(|&f| self.map.triangle(f));
        let axis = axis(corners);
        let directions = std::array::from_fn(|k| (axis + PI * k as f64 / DIRECTIONS as f64).sin_cos());
        let faces = sweep.faces.par_iter().with_min_len(AT_ONCE);
        let reach: Vec<Reach> = faces.map(|&f| self.reach(f, &directions)).collect();
        watch.ask(0.4)?;
        let after: Vec<Reach> = running(reach.iter().rev());
        debug_assert!(across.is_sorted_by_key(|path| path.first), "they are in the order of the sweep");
        // What is before a path is met on the way from one to the next.
        let (mut before, mut at) = (NOWHERE, 0);
        let outside = across.iter().map(|path| {
            before = reach[at..path.first].iter().fold(before, |all, next| farther(&all, next));
            at = path.first;
            farther(&before, &after[sweep.faces.len() - path.end])
        });
        let outside: Vec<Reach> = outside.collect();
        drop(after);
        watch.ask(0.6)?;
        let mut below = reach;
        for k in (1..below.len()).rev() {
            let parent = sweep.parent(self.mesh, k);
            below[parent] = farther(&below[parent], &below[k]);
        }
        watch.ask(0.9)?;
        let whole = rectangle(&below[0]);
        let share = |(path, outside): (&Across, &Reach)| (rectangle(&below[path.first]) + rectangle(outside)) / whole;
        Ok(across.iter().zip(&outside).map(share).collect())
    }

    /// The length of the path that an edge closes.
    fn length(&self, e: EdgeId) -> f64 {
        let [u, v] = self.mesh.ends(e).map(|v| self.shortest.distance[v]);
        u + self.lengths[e] + v
    }

    /// Whether both ends of the path that an edge closes come to other points; or, of rings, to other [corners](Self::corner) of one.
    fn is_across(&self, e: EdgeId, rings: bool) -> bool {
        let ends = self.mesh.ends(e);
        let [one, other] = ends.map(|v| self.shortest.owner[v]);
        let arrival =
            |v: VertexId| self.arrivals.get_or_init(|| self.arrivals())[v].unwrap_or_else(|| self.corner(e, v));
        one != other || rings && arrival(ends[0]) != arrival(ends[1])
    }

    /// For each vertex the corner at which its path arrives; none where something is open already.
    fn arrivals(&self) -> VertexData<Option<HalfedgeId>> {
        let predecessor = &self.shortest.predecessor;
        let mut arrivals = VertexData::constant(self.mesh.vertex_count(), None);
        let mut way = Vec::new();
        for start in self.mesh.vertices() {
            let (mut at, mut found) = (start, None);
            while let Some(e) = predecessor[at].filter(|_| found.is_none()) {
                found = arrivals[at];
                way.push(at);
                at = other_end(self.mesh, e, at);
                if predecessor[at].is_none() {
                    found = found.or_else(|| Some(self.corner(e, at)));
                }
            }
            way.drain(..).for_each(|v| arrivals[v] = found);
        }
        arrivals
    }

    /// The corner at a vertex where something is open that an edge is in, by its last side: what is between two open edges.
    fn corner(&self, e: EdgeId, v: VertexId) -> HalfedgeId {
        let h = self.mesh.halfedge(e);
        let from = if self.mesh.tail(h) == v { Some(h) } else { self.mesh.twin(h) };
        let mut at = from.unwrap_or(h);
        while let Some(g) = self.mesh.twin(at).filter(|_| !self.map.cut[self.mesh.edge(at)]) {
            at = self.mesh.next(g);
            if Some(at) == from {
                break; // nothing is open here
            }
        }
        at
    }

    /// The edges of a path.
    pub(super) fn edges(&self, across: &Across) -> Vec<EdgeId> {
        let ends = self.mesh.ends(across.edge);
        let ways = ends.into_iter().flat_map(|v| self.shortest.to_source(self.mesh, v).map(|(e, _)| e));
        std::iter::once(across.edge).chain(ways).collect()
    }

    /// What a path leaves on its two sides.
    pub(super) fn sides(&self, sweep: &Sweep, across: &Across) -> [Side; 2] {
        let Sweep { rim, area, place, .. } = sweep;
        let is_first = |f: FaceId| (across.first..across.end).contains(&(place[f] as usize));
        let [from, to] = [across.first, across.end].map(|k| rim.partition_point(|&(place, _)| place < k));
        let of_first = area[across.end] - area[across.first];
        let areas = [of_first, area[sweep.faces.len()] - of_first];
        let mut sides = areas.map(|area| Side { edges: Vec::new(), area });
        for (k, &(_, segment)) in rim.iter().enumerate() {
            sides[usize::from(!(from..to).contains(&k))].edges.push(segment);
        }
        // A path runs between triangles of both sides.
        let path = self.edges(across).into_iter().map(|e| self.mesh.halfedge(e));
        for h in path.flat_map(|h| [Some(h), self.mesh.twin(h)]).flatten() {
            sides[usize::from(!is_first(self.mesh.face(h)))].edges.push(self.segment(h));
        }
        sides
    }

    /// A side of a triangle in the plane.
    fn segment(&self, h: HalfedgeId) -> [[f64; 2]; 2] {
        [h, self.mesh.next(h)].map(|h| self.map.position[h])
    }

    /// The area of a triangle in the plane.
    fn area(&self, f: FaceId) -> f64 {
        0.5 * triangle::twice_area(self.map.triangle(f)).abs()
    }

    /// The middle of an edge that is not open.
    fn middle(&self, e: EdgeId) -> [f64; 2] {
        let [p, q] = self.segment(self.mesh.halfedge(e));
        [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
    }

    /// How far a triangle reaches in directions, given by sine and cosine.
    fn reach(&self, f: FaceId, directions: &[(f64, f64); DIRECTIONS]) -> Reach {
        let mut reach = NOWHERE;
        for [x, y] in self.mesh.sides(f).map(|h| self.map.position[h]) {
            for (k, (sin, cos)) in directions.iter().enumerate() {
                let at = (cos * x + sin * y) as f32;
                reach[k] = reach[k].max(at);
                reach[k + DIRECTIONS] = reach[k + DIRECTIONS].max(-at);
            }
        }
        reach
    }
}

impl Across {
    /// How far apart two paths are in their middles.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        (self.middle[0] - other.middle[0]).hypot(self.middle[1] - other.middle[1])
    }
}

impl Sweep {
    /// The triangle from which another was reached.
    fn parent(&self, mesh: &Mesh, k: usize) -> usize {
        let edge = self.over[k].expect("only the first was not reached from another");
        let h = mesh.halfedge(edge);
        let faces = [Some(h), mesh.twin(h)].into_iter().flatten().map(|h| self.place[mesh.face(h)] as usize);
        faces.min().expect("an edge has a triangle")
    }
}

/// The angle of the direction along which points are spread most.
pub(super) fn axis(points: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let (sum, count) =
        points.clone().fold(([0.0; 2], 0.0), |(sum, count), [x, y]| ([sum[0] + x, sum[1] + y], count + 1.0));
    let mut spread = [0.0; 2];
    for [x, y] in points {
        let [x, y] = [x - sum[0] / count, y - sum[1] / count];
        spread = [spread[0] + x * x - y * y, spread[1] + 2.0 * x * y];
    }
    0.5 * spread[1].atan2(spread[0])
}

fn farther(a: &Reach, b: &Reach) -> Reach {
    std::array::from_fn(|k| a[k].max(b[k]))
}

/// Element k: how far the first k reach.
fn running<'a>(reach: impl Iterator<Item = &'a Reach>) -> Vec<Reach> {
    let mut all = vec![NOWHERE];
    for next in reach {
        all.push(farther(&all[all.len() - 1], next));
    }
    all
}

/// The area of the smallest rectangle in one of the directions.
fn rectangle(reach: &Reach) -> f64 {
    let extent = |k: usize| f64::from(reach[k % DIRECTIONS]) + f64::from(reach[k % DIRECTIONS + DIRECTIONS]);
    (0..DIRECTIONS / 2).map(|k| extent(k) * extent(k + DIRECTIONS / 2)).fold(f64::MAX, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::shapes;

    #[test]
    fn the_sides_of_a_path_are_bounded_by_what_its_triangles_are() {
        let shape = shapes::disk(400);
        let mesh = shape.mesh();
        let position =
            mesh.halfedges().map(|h| shape.points[mesh.tail(h).0 as usize]).map(|[x, y, _]| [x, y]).collect();
        let map = UvMap::new(&mesh, position);
        let lengths = mesh.edges().map(|_| 1.0).collect();
        let paths = Paths::new(&mesh, &lengths, &map, Watch::NONE).unwrap();
        let sweep = paths.sweep(&paths.islands()[0]).unwrap();
        let across = paths.across(&sweep, f64::MAX, 0.05, false);
        assert!(across.len() > 20, "{}", across.len());
        let axis = axis(sweep.faces.iter().flat_map(|&f| map.triangle(f)));
        let directions = std::array::from_fn(|k| (axis + PI * k as f64 / DIRECTIONS as f64).sin_cos());
        let reach =
            |faces: &[FaceId]| faces.iter().fold(NOWHERE, |all, &f| farther(&all, &paths.reach(f, &directions)));
        let rectangles = paths.rectangles(&sweep, &across, Watch::NONE).unwrap();
        for (path, share) in across.iter().zip(rectangles) {
            let outside = farther(&reach(&sweep.faces[..path.first]), &reach(&sweep.faces[path.end..]));
            let inside = reach(&sweep.faces[path.first..path.end]);
            assert_eq!(share, (rectangle(&inside) + rectangle(&outside)) / rectangle(&reach(&sweep.faces)));
        }
        for path in &across {
            let (first, rest) =
                (&sweep.faces[path.first..path.end], [&sweep.faces[..path.first], &sweep.faces[path.end..]]);
            for (side, faces) in paths.sides(&sweep, path).into_iter().zip([first.to_vec(), rest.concat()]) {
                let is_rim = |h: &HalfedgeId| mesh.twin(*h).is_none_or(|g| !faces.contains(&mesh.face(g)));
                let rim = faces.iter().flat_map(|&f| mesh.sides(f)).filter(is_rim).map(|h| paths.segment(h));
                let sorted = |mut edges: Vec<[[f64; 2]; 2]>| {
                    edges.sort_by(|a, b| a.partial_cmp(b).unwrap());
                    edges
                };
                assert_eq!(sorted(side.edges), sorted(rim.collect()));
                assert!((side.area - faces.iter().map(|&f| paths.area(f)).sum::<f64>()).abs() < 1e-12);
            }
        }
    }
}
