//! Short cuts across an island, and what they leave on either side.
//!
//! As in [`divide`](super::divide): with T the shortest paths to what is open, each edge that is in neither T nor open closes
//! a path across, and these edges are a spanning tree of the island's triangles. Gone through in preorder, the triangles on
//! one side of a path are a range. So areas and extents on both sides are found for all paths in one sweep.

use std::f64::consts::PI;

use geom::{CutMesh, EdgeData, EdgeId, FaceData, FaceId, Interrupted, Mesh, ShortestPaths, VertexId, Watch, edges_at};

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
    opened: CutMesh,
    shortest: ShortestPaths,
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
        let is_open = |v: VertexId| mesh.is_boundary_vertex(v) || edges_at(mesh, v).any(|(e, _)| map.cut[e]);
        let sources = mesh.vertices().filter(|&v| is_open(v)).zip(0..);
        let shortest = ShortestPaths::new_watched(mesh, lengths, sources, watch)?;
        Ok(Self { mesh, lengths, map, opened: map.opened(mesh), shortest })
    }

    pub(super) fn island_count(&self) -> usize {
        self.opened.island_count()
    }

    /// The triangles of each island.
    pub(super) fn islands(&self) -> Vec<Vec<FaceId>> {
        let mut islands = vec![Vec::new(); self.island_count()];
        self.mesh.faces().for_each(|f| islands[self.opened.island(f) as usize].push(f));
        islands
    }

    /// The sides of some of the triangles of an island that have others, or nothing, beyond.
    pub(super) fn side(&self, faces: &[FaceId], is_within: impl Fn(FaceId) -> bool) -> Side {
        let mut side = Side { edges: Vec::new(), area: 0.0 };
        for &f in faces.iter().filter(|&&f| is_within(f)) {
            side.area += self.area(f);
            for h in self.mesh.sides(f) {
                let beyond = self.mesh.twin(h).filter(|_| !self.map.cut[self.mesh.edge(h)]);
                if beyond.is_none_or(|g| !is_within(self.mesh.face(g))) {
                    side.edges.push([self.map.position[h], self.map.position[self.mesh.next(h)]]);
                }
            }
        }
        side
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
        Some(Sweep { faces, over, end, place })
    }

    /// The paths across an island that are not longer than `most` and leave at least a share of the area on either side.
    pub(super) fn across(&self, sweep: &Sweep, most: f64, least_share: f64) -> Vec<Across> {
        let mut areas = vec![0.0];
        for &f in &sweep.faces {
            areas.push(areas[areas.len() - 1] + self.area(f));
        }
        let count = sweep.faces.len();
        let whole = areas[count];
        let found = (1..count).filter_map(|k| {
            let (edge, end) = (sweep.over[k]?, sweep.end[k]);
            let share = (areas[end] - areas[k]) / whole;
            let length = self.length(edge)?;
            if length > most || share < least_share || share > 1.0 - least_share {
                return None;
            }
            let middle = self.middle(edge);
            Some(Across { edge, length, middle, first: k, end })
        });
        found.collect()
    }

    /// The shortest of the paths across an island, none of which passes near a shorter one.
    pub(super) fn spread(&self, sweep: &Sweep) -> Vec<Across> {
        let mut across = self.across(sweep, f64::MAX, LEAST_SHARE);
        across.sort_by(|a, b| a.length.total_cmp(&b.length));
        let near = NEAR * sweep.faces.iter().map(|&f| self.area(f)).sum::<f64>().sqrt();
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

    /// For each path the areas of rectangles about both sides, over that of one about the island. However the island lies
    /// they are the same.
    ///
    /// # Errors
    /// If it is stopped.
    pub(super) fn rectangles(&self, sweep: &Sweep, across: &[Across], watch: Watch) -> Result<Vec<f64>, Interrupted> {
        let corners = sweep.faces.iter().flat_map(|&f| self.map.triangle(f));
        let axis = axis(corners);
        let directions = std::array::from_fn(|k| (axis + PI * k as f64 / DIRECTIONS as f64).sin_cos());
        let reach: Vec<Reach> = sweep.faces.iter().map(|&f| self.reach(f, &directions)).collect();
        watch.ask(0.4)?;
        let mut below = reach.clone();
        for k in (1..below.len()).rev() {
            let parent = sweep.parent(self.mesh, k);
            below[parent] = farther(&below[parent], &below[k]);
        }
        watch.ask(0.6)?;
        let before = running(reach.iter());
        let after: Vec<Reach> = running(reach.iter().rev());
        let both = |path: &Across| {
            let outside = farther(&before[path.first], &after[sweep.faces.len() - path.end]);
            (rectangle(&below[path.first]) + rectangle(&outside)) / rectangle(&below[0])
        };
        watch.ask(0.9)?;
        Ok(across.iter().map(both).collect())
    }

    /// The length of the path that an edge closes; nothing if both of its ends come to the same point.
    fn length(&self, e: EdgeId) -> Option<f64> {
        let [u, v] = self.mesh.ends(e);
        let owner = &self.shortest.owner;
        (owner[u] != owner[v]).then(|| self.shortest.distance[u] + self.lengths[e] + self.shortest.distance[v])
    }

    /// The edges of a path.
    pub(super) fn edges(&self, across: &Across) -> Vec<EdgeId> {
        let ends = self.mesh.ends(across.edge);
        let ways = ends.into_iter().flat_map(|v| self.shortest.to_source(self.mesh, v).map(|(e, _)| e));
        std::iter::once(across.edge).chain(ways).collect()
    }

    /// What a path leaves on its two sides.
    pub(super) fn sides(&self, sweep: &Sweep, across: &Across) -> [Side; 2] {
        let is_first = |f: FaceId| (across.first..across.end).contains(&(sweep.place[f] as usize));
        let first = &sweep.faces[across.first..across.end];
        [self.side(first, is_first), self.side(&sweep.faces, |f| !is_first(f))]
    }

    /// The area of a triangle in the plane.
    fn area(&self, f: FaceId) -> f64 {
        0.5 * triangle::twice_area(self.map.triangle(f)).abs()
    }

    /// The middle of an edge that is not open.
    fn middle(&self, e: EdgeId) -> [f64; 2] {
        let h = self.mesh.halfedge(e);
        let [p, q] = [h, self.mesh.next(h)].map(|h| self.map.position[h]);
        [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
    }

    /// How far a triangle reaches in directions, given by sine and cosine.
    fn reach(&self, f: FaceId, directions: &[(f64, f64); DIRECTIONS]) -> Reach {
        let mut reach = [f32::MIN; 2 * DIRECTIONS];
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
    let mut all = vec![[f32::MIN; 2 * DIRECTIONS]];
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
