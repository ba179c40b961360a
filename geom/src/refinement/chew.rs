//! The loop: the bad triangle with the largest circumcircle gets a vertex at its circumcentre, until there is none.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap, HashSet, VecDeque};
use std::f64::consts::PI;

use super::SurfacePoint;
use super::common::CommonRefinement;
use super::overlay::Overlay;
use super::plane::{Point, minus, wedge};
use super::straight::{Dead, Straight, StraightPath, retain};
use crate::intrinsic::{Metric, Sides};
use crate::mesh::{EdgeData, EdgeId, FaceId, HalfedgeId, Id, Triangulation, VertexData, VertexId};
use crate::watch::{Interrupted, Watch, unwatched};

/// Angles are at least this, in radians, but beside narrow corners: 25°. Chew's algorithm is proven to end up to 26.5°.
pub const LEAST_ANGLE: f64 = 25.0 * PI / 180.0;
/// A vertex whose angles sum to less than this is a narrow corner: triangles there cannot have the least angle, or hardly.
const NARROW: f64 = PI / 3.0;
/// So many vertices may be put in for each of the input's, and [`SPARE`] besides. The worst of our collection of needles take 2.6
/// (`thingi79741`); what takes more has gone astray, and would fill the memory.
const MOST_PER_VERTEX: usize = 20;
/// See [`MOST_PER_VERTEX`].
const SPARE: usize = 10_000;
/// So often at most are paths made straight, each time but for those that came too near to others.
const MOST_ROUNDS: usize = 4;
/// Beside paths so many may be put in for each two that are there, and so many besides.
const SPARE_BESIDE_PATHS: usize = 500;
/// So many times edges may cross those of the input for each of the input's vertices, and [`SPARE_CROSSINGS`] besides. Before vertices are put in
/// the needles of `thingi79741` take 286; a sphere stretched by 10⁶, whose 642 vertices are crossed 3 million times at the cap, took 3.7 GB.
const MOST_CROSSINGS_PER_VERTEX: usize = 1000;
/// See [`MOST_CROSSINGS_PER_VERTEX`].
const SPARE_CROSSINGS: usize = 500_000;
/// The same for what is left of them in the end: each is two triangles of the common refinement. At most 40 in our collection.
const MOST_LEFT_PER_VERTEX: usize = 200;
/// Distances from a corner are the same if they differ by no more than this share.
const SAME_DISTANCE: f64 = 1e-9;
/// A new vertex has at least these barycentric coordinates in its triangle, lest its triangles have no area. Circumcentres of
/// right triangles lie on their longest sides.
const LEAST_WEIGHT: f64 = 1e-3;
/// The way to a circumcentre crosses few triangles of a Delaunay triangulation; where rounding leads astray it ends.
const MOST_STEPS: usize = 1000;
/// Triangles that a vertex may take away, as far as they are looked at for edges that cannot go.
const LARGEST_CAVITY: usize = 256;
/// Vertices put in, or edges looked at, between two looks at the watch.
const STRIDE: usize = 256;

/// A surface with an even intrinsic triangulation.
#[derive(Clone, Debug)]
pub struct Refinement {
    /// The Delaunay triangulation, constrained by edges that are held, or the input's where it stays as it is. The input's vertices come first,
    /// under their own numbers.
    pub triangulation: Triangulation,
    /// Its edge lengths.
    pub metric: Metric,
    /// Where each vertex is on the input.
    pub place: VertexData<SurfacePoint>,
    /// The path that each edge is part of, of those that were [made straight](EdgeRoles::straight).
    pub path: EdgeData<Option<u32>>,
    /// The vertices that are missing for that: they would be too near to paths. All others keep their order.
    pub removed: Vec<VertexId>,
    /// The input's halfedge that each edge is part of, as the halfedge that names it runs; none where it crosses the input's triangles.
    pub along: EdgeData<Option<HalfedgeId>>,
    /// What both triangulations cut the surface into.
    pub common: CommonRefinement,
    /// Whether all triangles have the least angle, but small ones, those at narrow corners and those that span one between edges that are held; not so
    /// where a cap was reached.
    pub is_complete: bool,
}

/// How large triangles may be, and how small those are that need not be even, by the radii of their circumcircles.
///
/// What a function that is linear on triangles misses of a smooth one's gradient is bounded by these radii, whatever the angles are (the
/// *circumradius condition*: Kobayashi & Tsuchiya 2014). So needles with small ones do no harm.
#[derive(Clone, Copy)]
pub struct TriangleSize<'a> {
    /// None is larger; infinity where any will do.
    pub largest: f64,
    /// Nor larger than this is at its corners, on average. It is asked once for each vertex of the intrinsic triangulation, of the input first, and is to
    /// be positive, in the metric's unit; infinity where any size will do. What is nowhere reached ends at the cap on vertices.
    pub at: Option<&'a (dyn Fn(SurfacePoint) -> f64 + Sync)>,
    /// Smaller ones may have any angles; 0 where all are to have [`LEAST_ANGLE`].
    pub small: f64,
}

impl TriangleSize<'_> {
    /// Any size, but all with [`LEAST_ANGLE`].
    pub const ANY: Self = Self { largest: f64::INFINITY, at: None, small: 0.0 };
}

impl std::fmt::Debug for TriangleSize<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { largest, small, .. } = self;
        f.debug_struct("TriangleSize").field("largest", largest).field("small", small).finish_non_exhaustive()
    }
}

/// What is to become of some edges of the input; of none, by default.
#[derive(Clone, Copy, Debug, Default)]
pub struct EdgeRoles<'a> {
    /// The common refinement is not cut along these.
    pub left_out: Option<&'a EdgeData<bool>>,
    /// These stay edges, if need be in several parts: nothing crosses them. Where two of them, or one and the boundary, are less than 60° apart,
    /// triangles between them may be as narrow.
    pub held: Option<&'a EdgeData<bool>>,
    /// These are made straight, and held then; nothing is where one does not run through the triangulation, which is not complete then. An end of one is to be inside no other. Half as many vertices as
    /// there are, and 500, are put in besides for them.
    pub straight: &'a [StraightPath],
}

/// Refines a surface until its triangles are even, and no larger than they may be. At most 20 vertices are put in for each of the input's, and
/// 10,000 more. A surface whose common refinement would fill the memory (more than 200 crossings of edges for each vertex of the input, and 500,000 more) stays as it is, and is not complete.
/// O(n log n) for n vertices in the end, and the number of places where edges of the two triangulations cross.
///
/// ```
/// use geom::{Mesh, Metric, TriangleSize, refine};
///
/// // A strip of two needles.
/// let mesh = Mesh::new(4, &[[0, 1, 2], [0, 2, 3]])?;
/// let strip = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.05, 0.0], [0.0, 0.05, 0.0]];
/// let refinement = refine(&mesh, &Metric::from_points(&mesh, &strip), TriangleSize::ANY);
/// assert!(refinement.is_complete && refinement.triangulation.vertex_count() > 4);
/// # Ok::<(), geom::MeshError>(())
/// ```
pub fn refine(input: &Triangulation, metric: &Metric, size: TriangleSize) -> Refinement {
    unwatched(refine_watched(input, metric, size, EdgeRoles::default(), Watch::NONE))
}

/// [`refine`], with edges of the input that play a role, and watched.
///
/// # Errors
/// If it is stopped.
pub fn refine_watched(
    input: &Triangulation,
    metric: &Metric,
    size: TriangleSize,
    EdgeRoles { left_out, held, straight }: EdgeRoles,
    watch: Watch,
) -> Result<Refinement, Interrupted> {
    let mut chew = Chew::new((input, metric), held, size);
    watch.ask(0.05)?;
    chew.flip_all(watch.within(0.05, 0.2))?;
    watch.ask(0.2)?;
    let most = MOST_PER_VERTEX * input.vertex_count() + SPARE;
    let mut is_complete = chew.run(most, watch.within(0.2, 0.5))?;
    let (mut path_of, mut removed) = (None, Vec::new());
    let do_fit = || straight.iter().all(|path| path.runs_through(&chew.overlay.triangulation));
    if !straight.is_empty() && is_complete && !do_fit() {
        is_complete = false;
    } else if !straight.is_empty() && is_complete {
        let (of_edge, taken) = chew.straighten(straight, watch.within(0.5, 0.65))?;
        (path_of, removed) = (Some(of_edge), taken);
        let most = chew.overlay.triangulation.vertex_count() / 2 + SPARE_BESIDE_PATHS;
        is_complete = chew.run(most, watch.within(0.65, 0.7))?;
    }
    let is_astray = chew.is_astray();
    let mut overlay = chew.overlay;
    let mut home = left_out.map(|edges| overlay.leave_out(edges));
    let is_astray = is_astray || overlay.crossings > MOST_LEFT_PER_VERTEX * input.vertex_count() + SPARE_CROSSINGS;
    if is_astray {
        (overlay, home, path_of) = (Overlay::new(input, metric, held), None, None);
        removed.clear();
    }
    let is_complete = is_complete && !is_astray;
    let common = CommonRefinement::new(input, &overlay, home.as_ref(), watch.within(0.7, 1.0))?;
    let along = overlay.along();
    let path = |held: &Option<HalfedgeId>| path_of.as_ref().and_then(|path_of| path_of[overlay.begun.edge((*held)?)]);
    let path = overlay.held.iter().map(path).collect();
    let Overlay { triangulation, length, place, .. } = overlay;
    let metric = Metric::new(length.into());
    Ok(Refinement { triangulation, metric, place: place.into(), path, removed, along, common, is_complete })
}

/// A bad triangle, as it was when it was found.
#[derive(Clone, Copy, PartialEq)]
struct Bad {
    radius: f64,
    face: FaceId,
}

impl Eq for Bad {}

impl Ord for Bad {
    fn cmp(&self, other: &Self) -> Ordering {
        self.radius.total_cmp(&other.radius).then(other.face.cmp(&self.face))
    }
}

impl PartialOrd for Bad {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Where the way to a circumcentre ends.
enum Goal {
    /// In a triangle, at these barycentric coordinates.
    Inside(FaceId, [f64; 3]),
    /// At an edge of the boundary, or one that is held.
    Edge(HalfedgeId),
    /// Nowhere.
    Lost,
}

struct Chew<'a> {
    overlay: Overlay<'a>,
    /// The lengths of the edges that those are part of which stay edges.
    held_lengths: Cow<'a, [f64]>,
    /// Where vertices were put on them: on which halfedge, and how far along.
    on_held: HashMap<VertexId, (HalfedgeId, f64)>,
    size: TriangleSize<'a>,
    /// How large triangles may be at each vertex, if that is not everywhere the same.
    largest: Vec<f64>,
    /// Whether angles at a vertex that was there when edges were held are narrow: all round it, or those of a sector.
    is_narrow: Vec<bool>,
    sectors: Sectors,
    bad: BinaryHeap<Bad>,
    /// How many edges may be flipped yet, lest rounding flip some for ever. What is left over serves later: a vertex in the middle of
    /// a circle flips about as many edges as there are vertices on it.
    flips_left: usize,
    /// How many crossings there may be.
    most_crossings: usize,
}

impl<'a> Chew<'a> {
    fn new(
        (input, metric): (&'a Triangulation, &'a Metric),
        held: Option<&EdgeData<bool>>,
        size: TriangleSize<'a>,
    ) -> Self {
        let (sectors, is_narrow) = Sectors::new(input, metric, held);
        let mut chew = Self {
            overlay: Overlay::new(input, metric, held),
            held_lengths: Cow::Borrowed(metric.lengths()),
            on_held: HashMap::new(),
            size,
            largest: Vec::new(),
            is_narrow,
            sectors,
            bad: BinaryHeap::new(),
            flips_left: 0,
            most_crossings: MOST_CROSSINGS_PER_VERTEX * input.vertex_count() + SPARE_CROSSINGS,
        };
        chew.ask_for_sizes();
        chew
    }

    /// Makes paths of edges straight, and holds them besides what is held; the path that each edge is of, and the vertices that were taken away beside
    /// paths.
    fn straighten(
        &mut self,
        paths: &[StraightPath],
        watch: Watch,
    ) -> Result<(EdgeData<Option<u32>>, Vec<VertexId>), Interrupted> {
        let spacing = self.overlay.spacing();
        let mut was_held: Vec<bool> = self.overlay.held.iter().map(Option::is_some).collect();
        let mut stays = vec![false; paths.len()];
        let mut rounds = 0;
        let mut path_of = loop {
            rounds += 1;
            let begun = self.overlay.clone();
            let mut straight = Straight::new(&mut self.overlay, paths, &stays);
            straight.straighten(watch.within(0.0, 0.5))?;
            let too_narrow = straight.too_narrow(paths);
            if too_narrow.is_empty() {
                break straight.path_of;
            }
            self.overlay = begun;
            too_narrow.into_iter().for_each(|number| stays[number] = true);
            if rounds == MOST_ROUNDS {
                stays.fill(true);
            }
        };
        self.hold(&path_of, &was_held);
        self.flip_all(watch.within(0.5, 0.6))?;
        self.overlay.snap(&mut path_of, &spacing);
        self.hold(&path_of, &was_held);
        self.flip_all(watch.within(0.6, 0.7))?;
        let mut dead = Dead::default();
        loop {
            watch.ask(0.8)?;
            let near = self.overlay.near_held(&spacing);
            let mut is_done = true;
            for (v, e) in near {
                if let Some(sides) = self.overlay.remove(v, e, &mut dead) {
                    is_done = false;
                    self.flip(sides.to_vec(), watch.within(0.8, 0.9))?;
                }
            }
            if is_done {
                break;
            }
        }
        let removed = self.overlay.compact(&dead, &mut path_of);
        retain(&mut was_held, |e| !dead.edges.contains(&EdgeId::new(e)));
        retain(&mut self.largest, |v| !dead.vertices.contains(&VertexId::new(v)));
        self.hold(&path_of, &was_held);
        self.flip_all(watch.within(0.9, 1.0))?;
        Ok((path_of.into(), removed))
    }

    /// Holds paths as they are, and what was held.
    fn hold(&mut self, path_of: &[Option<u32>], was_held: &[bool]) {
        let is_held: Vec<bool> = path_of.iter().zip(was_held).map(|(path, held)| path.is_some() || *held).collect();
        self.overlay.hold(&is_held);
        let Overlay { triangulation, length, .. } = &self.overlay;
        let is_inside = |e: EdgeId| is_held[e.index()] && !triangulation.is_boundary_edge(e);
        let inside: EdgeData<bool> = triangulation.edges().map(is_inside).collect();
        let metric = Metric::new(length.clone().into());
        (self.sectors, self.is_narrow) = Sectors::new(triangulation, &metric, Some(&inside));
        self.held_lengths = Cow::Owned(length.clone());
        self.on_held.clear();
        self.bad.clear();
    }

    /// Whether the edges cross those of the input too often.
    fn is_astray(&self) -> bool {
        self.overlay.crossings > self.most_crossings
    }

    /// Asks how large triangles may be at vertices that are new.
    fn ask_for_sizes(&mut self) {
        if let Some(at) = self.size.at {
            self.largest.extend(self.overlay.place[self.largest.len()..].iter().map(|&place| at(place)));
        }
    }

    /// How large a triangle between vertices may be.
    fn largest_between(&self, corners: [VertexId; 3]) -> f64 {
        match self.size.at {
            Some(_) => self.size.largest.min(corners.iter().map(|v| self.largest[v.index()] / 3.0).sum()),
            None => self.size.largest,
        }
    }

    fn flip_all(&mut self, watch: Watch) -> Result<(), Interrupted> {
        let edges: Vec<EdgeId> = self.overlay.triangulation.edges().collect();
        self.flip(edges, watch)
    }

    /// Flips edges until all are Delaunay, beginning with these.
    fn flip(&mut self, edges: Vec<EdgeId>, watch: Watch) -> Result<(), Interrupted> {
        self.flips_left += 64 * edges.len() + 1024;
        let mut queue: VecDeque<EdgeId> = edges.into();
        let mut looked_at = 0_usize;
        while let Some(e) = queue.pop_front() {
            looked_at += 1;
            if looked_at.is_multiple_of(STRIDE) {
                watch.ask(f64::NAN)?;
            }
            if self.flips_left == 0 || self.is_astray() {
                break;
            }
            if self.overlay.flip_to_delaunay(e) {
                self.flips_left -= 1;
                let h = self.overlay.triangulation.halfedge(e);
                queue.extend(self.overlay.quad(h).map(|side| self.overlay.triangulation.edge(side)));
                let twin = self.overlay.triangulation.twin(h).expect("it was flipped");
                for h in [h, twin] {
                    self.look_at(self.overlay.triangulation.face(h));
                }
            }
        }
        Ok(())
    }

    /// Puts a triangle on the heap if it is bad.
    fn look_at(&mut self, face: FaceId) {
        if let Some(radius) = self.badness(face) {
            self.bad.push(Bad { radius, face });
        }
    }

    /// The radius of a bad triangle's circumcircle.
    fn badness(&self, f: FaceId) -> Option<f64> {
        let sides = self.overlay.sides(f);
        let corners = self.overlay.triangulation.corners(f);
        let angles = sides.corner_angles();
        let out = self.overlay.triangulation.sides(f);
        let is_excused =
            |s: usize| self.is_narrow_at(out[s]) || self.spans_corner([1, 2].map(|k| corners[(s + k) % 3]));
        let area = sides.area();
        let radius = sides.0.iter().product::<f64>() / (4.0 * area);
        let is_bad = radius >= self.size.small && (0..3).any(|s| angles[s] < LEAST_ANGLE && !is_excused(s));
        (area > 0.0 && (is_bad || radius > self.largest_between(corners))).then_some(radius)
    }

    /// Whether the angles of the input are narrow where a halfedge begins, on its left.
    fn is_narrow_at(&self, mut h: HalfedgeId) -> bool {
        let t = &self.overlay.triangulation;
        let v = t.tail(h);
        if !self.sectors.divided.contains(&v) {
            return self.is_narrow.get(v.index()).copied().unwrap_or(false);
        }
        // Clockwise to where the sector begins.
        while let Some(g) = self.overlay.across(h) {
            h = t.next(g);
        }
        self.overlay.held_along(h).is_some_and(|first| self.sectors.narrow.contains_key(&first))
    }

    /// Whether vertices are equally far from a narrow corner, on the edges that it is between. What is opposite of them is narrow as the
    /// corner is, and to split it would split the edges beside the corner in vain (Miller, Pav & Walkington 2003).
    fn spans_corner(&self, ends: [VertexId; 2]) -> bool {
        if self.sectors.narrow.is_empty() {
            return false;
        }
        let [Some(one), Some(other)] = ends.map(|v| self.ways_from_corners(v)) else { return false };
        let is_between = |begin: &WayFrom, end: &WayFrom| {
            begin.out.is_some_and(|out| self.sectors.narrow.get(&out) == Some(&end.edge))
                && begin.corner == end.corner
                && (begin.far - end.far).abs() <= SAME_DISTANCE * end.far
        };
        one.iter().any(|one| other.iter().any(|other| is_between(one, other) || is_between(other, one)))
    }

    /// The ways to a vertex from the ends of the edge that it was put on.
    fn ways_from_corners(&self, v: VertexId) -> Option<[WayFrom; 2]> {
        let &(h, along) = self.on_held.get(&v)?;
        let begun = &self.overlay.begun;
        let edge = begun.edge(h);
        let length = self.held_lengths[edge.index()];
        Some([
            WayFrom { corner: begun.tail(h), edge, out: Some(h), far: along * length },
            WayFrom { corner: begun.head(h), edge, out: begun.twin(h), far: (1.0 - along) * length },
        ])
    }

    /// Puts a vertex on an edge that stays one.
    fn split(&mut self, h: HalfedgeId) {
        let share = self.split_at(h);
        let held = self.overlay.held_along(h).expect("only edges that stay edges are split");
        let along = |v: VertexId, corner: f64| match self.on_held.get(&v) {
            Some(&(on, along)) if on == held => along,
            Some(&(_, along)) => 1.0 - along,
            None => corner,
        };
        let t = &self.overlay.triangulation;
        let (from, to) = (along(t.tail(h), 0.0), along(t.head(h), 1.0));
        let v = self.overlay.split(h, share);
        self.on_held.insert(v, (held, from + share * (to - from)));
    }

    /// Inserts vertices until no triangle is bad, or so many; whether none is.
    fn run(&mut self, most: usize, watch: Watch) -> Result<bool, Interrupted> {
        self.overlay.triangulation.faces().for_each(|f| self.look_at(f));
        let mut inserted = 0;
        let mut is_complete = true;
        while let Some(Bad { radius, face }) = self.bad.pop() {
            if self.badness(face) != Some(radius) {
                continue;
            }
            if inserted == most || self.is_astray() {
                return Ok(false);
            }
            if inserted.is_multiple_of(STRIDE) {
                watch.ask(f64::NAN)?;
            }
            inserted += 1;
            let before = self.overlay.triangulation.edge_count();
            let touched = match self.way_to_circumcentre(face) {
                Goal::Inside(f, weights) => {
                    let edges = self.overlay.triangulation.sides(f).map(|h| self.overlay.triangulation.edge(h));
                    self.overlay.insert(f, weights);
                    edges.to_vec()
                }
                Goal::Edge(h) if !self.is_folded(h) => {
                    let t = &self.overlay.triangulation;
                    let sides = [Some(h), t.twin(h)].into_iter().flatten();
                    let edges = sides.flat_map(|h| [t.next(h), t.prev(h)]).map(|h| t.edge(h)).collect();
                    self.split(h);
                    edges
                }
                Goal::Edge(_) | Goal::Lost => {
                    is_complete = false;
                    continue;
                }
            };
            self.ask_for_sizes();
            let new = before..self.overlay.triangulation.edge_count();
            let edges: Vec<EdgeId> = touched.into_iter().chain(new.map(EdgeId::new)).collect();
            for &e in &edges {
                let h = self.overlay.triangulation.halfedge(e);
                let sides = [Some(h), self.overlay.triangulation.twin(h)];
                sides.into_iter().flatten().for_each(|h| self.look_at(self.overlay.triangulation.face(h)));
            }
            self.flip(edges, watch)?;
            // Where an edge was split it may be as it was.
            self.look_at(face);
        }
        Ok(is_complete)
    }

    /// Whether an edge has one triangle on both sides.
    fn is_folded(&self, h: HalfedgeId) -> bool {
        let t = &self.overlay.triangulation;
        t.twin(h).is_some_and(|g| t.face(g) == t.face(h))
    }

    /// Where an edge is split: in the middle, but beside a narrow corner at a power of two from it, so that both sides
    /// of the corner are split alike (Ruppert 1995, §8).
    fn split_at(&self, h: HalfedgeId) -> f64 {
        let t = &self.overlay.triangulation;
        let length = self.overlay.length[t.edge(h).index()];
        let is_narrow = |v: VertexId| self.is_narrow.get(v.index()).copied().unwrap_or(false);
        let shell = (0.5 * length).log2().round().exp2() / length;
        match [t.tail(h), t.head(h)].map(is_narrow) {
            [true, false] => shell,
            [false, true] => 1.0 - shell,
            _ => 0.5,
        }
    }

    /// Goes straight from a triangle's middle to its circumcentre.
    fn way_to_circumcentre(&self, f: FaceId) -> Goal {
        let t = &self.overlay.triangulation;
        let mut corners = self.overlay.layout(f);
        let middle = [0, 1].map(|c| corners.iter().map(|p| p[c]).sum::<f64>() / 3.0);
        let goal = circumcentre(corners);
        let mut sides = t.sides(f);
        let mut entered = None;
        for _ in 0..MOST_STEPS {
            let leaves = |&s: &usize| {
                let [p, q] = [corners[s], corners[(s + 1) % 3]];
                let way = minus(goal, middle);
                Some(s) != entered
                    && wedge(minus(q, p), minus(goal, p)) < 0.0
                    && wedge(way, minus(p, middle)) <= 0.0
                    && wedge(way, minus(q, middle)) >= 0.0
            };
            let Some(s) = (0..3).find(leaves) else {
                if let Some(h) = self.encroached((sides, corners), goal) {
                    return Goal::Edge(h);
                }
                return match weights(corners, goal) {
                    Some(weights) => Goal::Inside(t.face(sides[0]), rotated(weights, sides[0])),
                    None => Goal::Lost,
                };
            };
            match self.across((sides, corners), s) {
                Some(next) => (sides, corners) = next,
                None => return Goal::Edge(sides[s]),
            }
            entered = Some(0);
        }
        Goal::Lost
    }

    /// The triangle across a side, unfolded, that side first; none across the boundary and edges that are held.
    fn across(&self, (sides, corners): Unfolded, s: usize) -> Option<Unfolded> {
        let t = &self.overlay.triangulation;
        let g = self.overlay.across(sides[s])?;
        let (p, q) = (corners[(s + 1) % 3], corners[s]);
        let sides = [g, t.next(g), t.prev(g)];
        let [along, _, back] = Sides(sides.map(|h| self.overlay.length[t.edge(h).index()])).unfold();
        let turn = minus(q, p).map(|x| x / along[0]);
        let apex = [p[0] - turn[0] * back[0] + turn[1] * back[1], p[1] - turn[1] * back[0] - turn[0] * back[1]];
        Some((sides, [p, q, apex]))
    }

    /// An edge that cannot go in whose diametral circle a point of a triangle lies; its triangle would be one that the point takes away.
    fn encroached(&self, from: Unfolded, goal: Point) -> Option<HalfedgeId> {
        let mut seen = vec![(from, None)];
        let mut next = 0;
        while next < seen.len() && seen.len() < LARGEST_CAVITY {
            let ((sides, corners), entered) = seen[next];
            next += 1;
            for s in (0..3).filter(|&s| Some(s) != entered) {
                let [p, q] = [corners[s], corners[(s + 1) % 3]].map(|end| minus(end, goal));
                match self.across((sides, corners), s) {
                    None if p[0] * q[0] + p[1] * q[1] < 0.0 => return Some(sides[s]),
                    None => {}
                    Some(beyond) if is_in_circumcircle(beyond.1, goal) => seen.push((beyond, Some(0))),
                    Some(_) => {}
                }
            }
        }
        None
    }
}

/// A way along one of the input's edges, from one of its ends.
struct WayFrom {
    corner: VertexId,
    edge: EdgeId,
    /// The halfedge that runs so, if there is one.
    out: Option<HalfedgeId>,
    far: f64,
}

/// What edges that cannot go divide the angles at vertices of the input into, where some are held.
#[derive(Default)]
struct Sectors {
    /// The vertices that such an edge ends at.
    divided: HashSet<VertexId>,
    /// The narrow sectors, by the halfedge that each begins with, counter-clockwise, with the edge that it ends at.
    narrow: HashMap<HalfedgeId, EdgeId>,
}

impl Sectors {
    /// Those of a triangulation, none where nothing is held inside it, and whether angles at each vertex are narrow: all round it, or of a sector.
    fn new(input: &Triangulation, metric: &Metric, held: Option<&EdgeData<bool>>) -> (Self, Vec<bool>) {
        let mut sectors = Self::default();
        let mut is_narrow: Vec<bool> = metric.angle_sums(input).iter().map(|sum| *sum < NARROW).collect();
        let Some(held) = held.filter(|held| held.contains(&true)) else { return (sectors, is_narrow) };
        let across = |h: HalfedgeId| input.twin(h).filter(|_| !held[input.edge(h)]);
        for first in input.halfedges().filter(|&h| across(h).is_none()) {
            sectors.divided.insert(input.tail(first));
            let (mut h, mut angle) = (first, metric.angle(input, first));
            while let Some(next) = across(input.prev(h)) {
                h = next;
                angle += metric.angle(input, h);
            }
            if angle < NARROW {
                sectors.narrow.insert(first, input.edge(input.prev(h)));
                is_narrow[input.tail(first).index()] = true;
            }
        }
        (sectors, is_narrow)
    }
}

/// A triangle's halfedges, from any of them on, with the positions of their tails.
type Unfolded = ([HalfedgeId; 3], [Point; 3]);

fn is_in_circumcircle(corners: [Point; 3], p: Point) -> bool {
    let [a, b, c] = corners.map(|q| minus(q, p));
    let [aa, bb, cc] = [a, b, c].map(|q| q[0] * q[0] + q[1] * q[1]);
    aa * wedge(b, c) + bb * wedge(c, a) + cc * wedge(a, b) > 0.0
}

/// Weights in the order of a triangle's own halfedges, where they were given from one of them on.
fn rotated(weights: [f64; 3], first: HalfedgeId) -> [f64; 3] {
    let shift = first.0 as usize % 3;
    [0, 1, 2].map(|k| weights[(k + 3 - shift) % 3])
}

fn circumcentre([a, b, c]: [Point; 3]) -> Point {
    let (u, v) = (minus(b, a), minus(c, a));
    let twice = 2.0 * wedge(u, v);
    let [uu, vv] = [u, v].map(|w| w[0] * w[0] + w[1] * w[1]);
    [a[0] + (v[1] * uu - u[1] * vv) / twice, a[1] + (u[0] * vv - v[0] * uu) / twice]
}

/// Barycentric coordinates, none of them too near to 0; none for a triangle without area.
fn weights([a, b, c]: [Point; 3], p: Point) -> Option<[f64; 3]> {
    let whole = wedge(minus(b, a), minus(c, a));
    let parts = [(b, c), (c, a), (a, b)].map(|(q, r)| wedge(minus(q, p), minus(r, p)) / whole);
    let parts = parts.map(|w| w.clamp(LEAST_WEIGHT, 1.0));
    let sum: f64 = parts.iter().sum();
    (whole > 0.0 && sum.is_finite()).then(|| parts.map(|w| w / sum))
}
