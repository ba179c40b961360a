//! Fold-overs removed: no triangle of the layout flipped, and no vertex wound round more often than its angle says.
//!
//! The flat metric is exact, but on the *input's* triangles, which are not its Delaunay triangles, a few can come out
//! negatively oriented, nearly always at a cone of negative curvature. That no triangle is flipped is not enough: around a
//! plain vertex all triangles may be positive with 4π between them. So a triangle is *bad* when its orientation is not
//! positive, and a vertex when w = round((Σ signed angles - Θ) / 2π) is not 0, Θ its angle in the flat metric.
//!
//! What may move: one displacement a vertex. The copies of a seam vertex move by the same displacement, turned by the
//! rotations of the seams between them, so that seams stay rigid; cones stay where they are, so that curvature stays what
//! it is. The sides of an opened handle fit in length, which only holding both keeps; where something stays bad all the same
//! they may move too, each by itself: a few edges of a seam that fit less well are better than triangles that are detached.
//! Two tools:
//! 1. *Fans*: round a bad cone the neighbours are turned about it, radii kept, until the angles are positive, not too
//!    unequal, and sum to the cone's angle.
//! 2. *Untangling* ([`untangle`](super::untangle)) of patches round what is bad, from the triangles themselves to six
//!    rings, with their rims fixed.
//!
//! What stays bad, as needles do round cones of many turns, is untangled with the patch's seams *loose*, if they may be ([`Fixed`]): each
//! copy of a seam vertex or cone in it moves for itself.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use geom::{
    FaceData, FaceId, HalfedgeId, Id, Interrupted, Mesh, Metric, Sides, VertexData, VertexId, Watch, WedgeId, counted,
};
use num_complex::Complex64;
use rayon::prelude::*;
use thiserror::Error;

use super::layout::Layout;
use super::scaling::Scaling;
use super::untangle::{Corner, Patch, PatchTriangle};

/// A triangle's height over its longest side below which it counts as flipped, unless it is as thin in space.
const LEAST_HEIGHT: f64 = 1e-7;
/// A cross product over the sum of the squares of its vectors that is no rounding.
const PLAIN: f64 = 1e-9;
/// Patches grow up to this many rings.
const MAX_RINGS: usize = 6;
/// Patches larger than this are not tried: untangling them takes longer than flattening with other cones.
const MAX_PATCH: usize = 20_000;
/// Nor larger ones with rigid seams where these may be loose: where so much is folded over it seldom helps, and takes seconds a patch.
const MAX_RIGID_PATCH: usize = 512;
/// Where loose seams of so many rings leave more than this share of the triangles folded over, larger patches are not tried: on 30 CAD parts and
/// scans they never helped then, and took up to 2.6 s of 3.5.
const FEW_RINGS: usize = 2;
const LOOSENED: f64 = 0.75;
/// So many triangles or vertices are looked at one after the other.
const AT_ONCE: usize = 1024;

/// Triangles of the layout could not be turned the right way round.
#[derive(Clone, Debug, Error)]
#[error("{} of the layout flipped, and {} wound, the first at vertex {}", counted(*faces, "triangle", "triangles"), counted(*vertices, "vertex", "vertices"), near[0])]
pub(crate) struct FoldOvers {
    /// How many triangles are flipped.
    pub faces: usize,
    /// How many vertices have a wrong angle.
    pub vertices: usize,
    /// Vertices there (of the surface), ascending; not empty.
    pub near: Vec<VertexId>,
    /// The triangles that are flipped or at a wound vertex.
    pub(crate) bad: Vec<FaceId>,
}

/// Removes fold-overs from a layout in place; returns the number of triangles that were moved.
///
/// # Errors
/// If something stays bad.
pub(crate) fn remove_fold_overs(
    input: &Mesh,
    metric: &Metric,
    scaling: &Scaling,
    fixed: &Fixed,
    layout: &mut Layout,
    watch: Watch,
) -> Result<usize, FoldOvers> {
    let Ok(mut untangler) = Untangler::new(input, metric, scaling, fixed, layout, watch) else {
        return Ok(0);
    };
    let mut bad = untangler.bad();
    if watch.stops_at(0.0) || bad.is_empty() {
        return Ok(0);
    }
    untangler.spread_fans(&bad);
    bad = untangler.bad();
    let mut moved = 0;
    let passes: &[bool] = if fixed.is_side.is_some() { &[true, false] } else { &[false] };
    let rounds = passes.iter().flat_map(|&holds_sides| (0..=MAX_RINGS).map(move |rings| (holds_sides, rings)));
    let count = passes.len() * (MAX_RINGS + 1);
    for (round, (holds_sides, rings)) in rounds.enumerate() {
        untangler.holds_sides = holds_sides;
        let [from, to] = [round, round + 1].map(|round| round as f64 / count as f64);
        let watch = watch.within(from, to);
        if watch.stops_at(0.0) {
            return Ok(moved);
        }
        for patch in untangler.patches(&bad, rings) {
            moved += untangler.untangle(&patch, Fans::Free, watch);
        }
        bad = untangler.bad();
        if watch.stops_at(0.5) {
            return Ok(moved);
        }
        for patch in untangler.patches(&bad, rings) {
            // With the fans held first; once nothing is flipped they may relax, which cannot unwind them.
            if untangler.untangle(&patch, Fans::Held, watch) > 0 {
                moved += untangler.untangle(&patch, Fans::Free, watch).max(patch.len());
            }
        }
        bad = untangler.bad();
        if bad.is_empty() {
            return Ok(moved);
        }
    }
    if fixed.may_loosen {
        let before = bad.faces.len();
        for rings in 1..=MAX_RINGS {
            if rings > FEW_RINGS && bad.faces.len() as f64 > LOOSENED * before as f64 {
                break;
            }
            for patch in untangler.patches(&bad, rings) {
                moved += untangler.loosen(&patch, watch);
            }
            bad = untangler.bad();
            if bad.is_empty() || watch.stops_at(1.0) {
                return Ok(moved);
            }
        }
    }
    let mut faces = untangler.patches(&bad, 0).concat();
    faces.sort_unstable();
    Err(bad.error(input, faces))
}

/// The vertices that stay where they are.
pub(crate) struct Fixed {
    pub(crate) is_cone: VertexData<bool>,
    /// Whether each is on a side of an opened handle, where there are any.
    pub(crate) is_side: Option<VertexData<bool>>,
    /// Whether seams may become loose where triangles would stay flipped otherwise.
    pub(crate) may_loosen: bool,
}

/// What is wrong with a layout.
#[derive(Default)]
struct Bad {
    faces: Vec<FaceId>,
    vertices: Vec<VertexId>,
}

impl Bad {
    fn is_empty(&self) -> bool {
        self.faces.is_empty() && self.vertices.is_empty()
    }

    fn error(&self, input: &Mesh, bad: Vec<FaceId>) -> FoldOvers {
        let mut near: Vec<VertexId> =
            self.faces.iter().flat_map(|&f| input.corners(f)).chain(self.vertices.iter().copied()).collect();
        near.sort_unstable();
        near.dedup();
        FoldOvers { faces: self.faces.len(), vertices: self.vertices.len(), near, bad }
    }
}

/// Where wedges were that have moved.
pub(super) type Moved = Vec<(WedgeId, Complex64)>;

/// Whether the neighbours of cones with spread fans may move.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Fans {
    Free,
    /// Untangling is free to unwind a cone by one turn and to wind a plain vertex instead; held fans prevent that.
    Held,
}

pub(super) struct Untangler<'a> {
    input: &'a Mesh,
    /// The edge lengths in space.
    metric: &'a Metric,
    scaling: &'a Scaling,
    /// Θ, the angle of each vertex in the flat metric.
    angle: VertexData<f64>,
    fixed: &'a Fixed,
    /// Whether the sides of opened handles stay too.
    holds_sides: bool,
    layout: &'a mut Layout,
    /// For each wedge the rotation that takes displacements of the vertex's first wedge to its own.
    turn: Vec<Complex64>,
    /// The cones whose fans were spread, ascending.
    fanned: Vec<VertexId>,
    /// Vertices on seams whose copies have moved for themselves: their angles may be others.
    loose: BTreeSet<VertexId>,
}

impl<'a> Untangler<'a> {
    pub(super) fn new(
        input: &'a Mesh,
        metric: &'a Metric,
        scaling: &'a Scaling,
        fixed: &'a Fixed,
        layout: &'a mut Layout,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        watch.ask(0.0)?;
        let angle = scaling.angles(input);
        watch.ask(0.0)?;
        let turn = wedge_turns(input, layout);
        watch.ask(0.0)?;
        Ok(Self {
            input,
            metric,
            scaling,
            angle,
            fixed,
            holds_sides: true,
            layout,
            turn,
            fanned: Vec::new(),
            loose: BTreeSet::new(),
        })
    }

    pub(super) fn layout(&self) -> &Layout {
        self.layout
    }

    fn is_fixed(&self, v: VertexId) -> bool {
        self.fixed.is_cone[v] || self.holds_sides && self.fixed.is_side.as_ref().is_some_and(|is_side| is_side[v])
    }

    pub(super) fn positions(&self, f: FaceId) -> [Complex64; 3] {
        self.input.sides(f).map(|h| self.layout.corner(h))
    }

    /// The sides that a triangle would have if it were scaled evenly.
    pub(super) fn reference(&self, f: FaceId) -> Sides {
        let mean = self.input.corners(f).iter().map(|&v| self.scaling.u[v]).sum::<f64>() / 3.0;
        Sides(self.metric.sides(self.input, f).0.map(|l| l * mean.exp()))
    }

    fn is_flipped(&self, f: FaceId) -> bool {
        let [a, b, c] = self.positions(f);
        let longest = [b - a, c - b, a - c].iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
        let height = cross(b - a, c - a) / longest;
        let in_space = self.metric.sides(self.input, f);
        let thin = 2.0 * in_space.area() / in_space.0.iter().fold(0.0_f64, |m, l| m.max(*l)).powi(2);
        height.is_nan() || height <= LEAST_HEIGHT.min(1e-3 * thin)
    }

    /// How much too often the triangles wind round a vertex.
    fn winding(&self, v: VertexId) -> f64 {
        if self.loose.contains(&v) {
            return 0.0;
        }
        let sum = self.closed_angle(v);
        let sum = sum.unwrap_or_else(|| self.input.outgoing(v).map(|h| self.signed_angle(h)).sum());
        ((sum - self.angle[v]) / (2.0 * PI)).round()
    }

    /// The sum of the angles round a vertex off the seams where all triangles are plainly positive: full turns, which signs of differences count in
    /// a tenth of the time that angles take.
    fn closed_angle(&self, v: VertexId) -> Option<f64> {
        let (input, layout) = (self.input, &self.layout);
        let mut turns = 0.0;
        for h in input.outgoing(v) {
            let [at, next, last] = [h, input.next(h), input.prev(h)].map(|h| layout.corner(h));
            let is_joined = input.twin(h).is_some_and(|g| {
                layout.cut.wedge(h) == layout.cut.wedge(input.next(g))
                    && layout.cut.wedge(input.next(h)) == layout.cut.wedge(g)
            });
            let [right, left] = [next - at, last - at];
            let is_positive = cross(right, left) > PLAIN * (right.norm_sqr() + left.norm_sqr());
            if !(is_joined && is_positive) {
                return None;
            }
            turns += if right.im < 0.0 && left.im >= 0.0 { 1.0 } else { 0.0 };
        }
        Some(2.0 * PI * turns)
    }

    /// The signed angle of the corner at a halfedge's tail, in (-π, π].
    fn signed_angle(&self, h: HalfedgeId) -> f64 {
        let at = self.layout.corner(h);
        let next = self.layout.corner(self.input.next(h)) - at;
        let prev = self.layout.corner(self.input.prev(h)) - at;
        (prev * next.conj()).arg()
    }

    fn bad(&self) -> Bad {
        let all = |count: usize| (0..count).into_par_iter().with_min_len(AT_ONCE);
        Bad {
            faces: all(self.input.face_count()).map(FaceId::new).filter(|&f| self.is_flipped(f)).collect(),
            vertices: all(self.input.vertex_count()).map(VertexId::new).filter(|&v| self.winding(v) != 0.0).collect(),
        }
    }

    /// Spreads the neighbours of every cone with an angle of 2π and more at which something is bad.
    fn spread_fans(&mut self, bad: &Bad) {
        let touched = bad.faces.iter().flat_map(|&f| self.input.corners(f)).chain(bad.vertices.iter().copied());
        let mut cones: Vec<VertexId> =
            touched.filter(|&v| self.fixed.is_cone[v] && self.angle[v] >= 2.0 * PI).collect();
        cones.sort_unstable();
        cones.dedup();
        for &cone in &cones {
            self.spread_fan(cone);
        }
        self.fanned = cones;
    }

    fn spread_fan(&mut self, cone: VertexId) {
        let input = self.input;
        let around: Vec<HalfedgeId> = input.outgoing(cone).collect();
        let now: Vec<f64> =
            around.iter().map(|&h| self.signed_angle(h)).map(|a| if a < 0.0 { a + 2.0 * PI } else { a }).collect();
        let mean = self.angle[cone] / around.len() as f64;
        let low = (0.12 * PI).min(0.3 * mean);
        let high = (0.88 * PI).max(0.5 * (PI + mean));
        if high * (around.len() as f64) < self.angle[cone] {
            return;
        }
        let wanted = clipped_to_sum(&now, low, high, self.angle[cone]);
        let mut turned = 0.0;
        let mut moves = Vec::new();
        for (k, &h) in around.iter().enumerate().skip(1) {
            turned += wanted[k - 1] - self.signed_angle(around[k - 1]);
            let neighbour = input.head(h);
            if !self.is_fixed(neighbour) {
                let spoke = self.layout.corner(input.next(h)) - self.layout.corner(h);
                moves.push((input.next(h), spoke * (Complex64::cis(turned) - 1.0)));
            }
        }
        for (at, displacement) in moves {
            self.displace(at, displacement);
        }
    }

    /// Moves the vertex at a halfedge's tail, given the displacement of the wedge there.
    fn displace(&mut self, at: HalfedgeId, displacement: Complex64) {
        let base = displacement * self.turn[self.layout.cut.wedge(at).index()].conj();
        self.displace_vertex(self.input.tail(at), base);
    }

    /// Moves a vertex, given the displacement of its first wedge.
    fn displace_vertex(&mut self, v: VertexId, displacement: Complex64) {
        for w in self.layout.cut.wedges(v) {
            self.layout.position[w.index()] += displacement * self.turn[w.index()];
        }
    }

    /// The connected pieces of the rings round what is bad.
    fn patches(&self, bad: &Bad, rings: usize) -> Vec<Vec<FaceId>> {
        let faces_at = |v: &VertexId| self.input.outgoing(*v).map(|h| self.input.face(h));
        let faces: Vec<FaceId> = bad.faces.iter().copied().chain(bad.vertices.iter().flat_map(faces_at)).collect();
        self.pieces(&faces, rings)
    }

    /// The connected pieces of the rings round some triangles.
    pub(super) fn pieces(&self, faces: &[FaceId], rings: usize) -> Vec<Vec<FaceId>> {
        let input = self.input;
        let faces_at = |v: VertexId| input.outgoing(v).map(|h| input.face(h));
        let mut inside = FaceData::constant(input.face_count(), false);
        let mut patch = faces.to_vec();
        patch.retain(|&f| !std::mem::replace(&mut inside[f], true));
        for _ in 0..rings {
            let vertices: Vec<VertexId> = patch.iter().flat_map(|&f| input.corners(f)).collect();
            for v in vertices {
                patch.extend(faces_at(v).filter(|&f| !std::mem::replace(&mut inside[f], true)));
            }
        }
        patch.sort_unstable();
        let mut pieces = Vec::new();
        for seed in patch {
            if !std::mem::replace(&mut inside[seed], false) {
                continue;
            }
            let mut piece = vec![seed];
            let mut at = 0;
            while at < piece.len() {
                let f = piece[at];
                at += 1;
                for v in input.corners(f) {
                    piece.extend(faces_at(v).filter(|&g| std::mem::replace(&mut inside[g], false)));
                }
            }
            piece.sort_unstable();
            pieces.push(piece);
        }
        pieces
    }

    /// Relaxes a patch if that costs less; returns how many triangles it has, 0 where it was left as it was.
    pub(super) fn improve(&mut self, faces: &[FaceId], cost: impl Fn(&Layout) -> f64, watch: Watch) -> usize {
        if faces.iter().any(|&f| self.is_flipped(f)) {
            return 0;
        }
        let before = cost(self.layout);
        let Some(moved) = self.try_untangling(faces, Fans::Free, watch) else { return 0 };
        let is_better = cost(self.layout) < before; // not so with NaN either
        if !is_better {
            self.put_back(moved);
            return 0;
        }
        faces.len()
    }

    /// Untangles a patch; returns how many triangles it has, 0 where it was left as it was.
    fn untangle(&mut self, faces: &[FaceId], fans: Fans, watch: Watch) -> usize {
        if self.fixed.may_loosen && faces.len() > MAX_RIGID_PATCH {
            return 0;
        }
        self.try_untangling(faces, fans, watch).map_or(0, |_| faces.len())
    }

    /// Untangles a patch; returns where what it moved was before, none where it was left as it was.
    fn try_untangling(&mut self, faces: &[FaceId], fans: Fans, watch: Watch) -> Option<Moved> {
        self.try_shaping(faces, fans, Self::reference, watch)
    }

    /// The same with other reference shapes.
    pub(super) fn try_shaping(
        &mut self,
        faces: &[FaceId],
        fans: Fans,
        reference: impl Fn(&Self, FaceId) -> Sides,
        watch: Watch,
    ) -> Option<Moved> {
        if faces.len() > MAX_PATCH || watch.stops_at(0.0) {
            return None;
        }
        let (patch, moving) = self.patch(faces, fans, reference)?;
        let untangled = patch.untangle(watch);
        if !untangled.succeeded {
            return None;
        }
        let wedges = moving.iter().flat_map(|&v| self.layout.cut.wedges(v));
        let before = wedges.map(|w| (w, self.layout.position[w.index()])).collect();
        for (&v, [x, y]) in moving.iter().zip(untangled.displacements) {
            self.displace_vertex(v, Complex64::new(x, y));
        }
        let corners = || faces.iter().flat_map(|&f| self.input.corners(f));
        if faces.iter().any(|&f| self.is_flipped(f)) || corners().any(|v| self.winding(v) != 0.0) {
            self.put_back(before);
            return None;
        }
        Some(before)
    }

    /// Untangles a patch whose seams are loose; returns how many triangles it has, 0 where it was left as it was.
    fn loosen(&mut self, faces: &[FaceId], watch: Watch) -> usize {
        if faces.len() > MAX_PATCH || watch.stops_at(0.0) {
            return 0;
        }
        let input = self.input;
        let sides = || faces.iter().flat_map(|&f| input.sides(f));
        let mut inside: BTreeMap<WedgeId, usize> = BTreeMap::new();
        sides().for_each(|h| *inside.entry(self.layout.cut.wedge(h)).or_insert(0) += 1);
        let is_whole = |h: HalfedgeId| {
            let w = self.layout.cut.wedge(h);
            input.outgoing(input.tail(h)).filter(|&g| self.layout.cut.wedge(g) == w).count() == inside[&w]
        };
        let moving: BTreeSet<WedgeId> = sides().filter(|&h| is_whole(h)).map(|h| self.layout.cut.wedge(h)).collect();
        let moving: Vec<WedgeId> = moving.into_iter().collect();
        let corner = |w: &WedgeId| {
            let z = self.layout.position[w.index()];
            match moving.binary_search(w) {
                Ok(k) => Corner::free([z.re, z.im], k as u32),
                Err(_) => Corner::fixed([z.re, z.im]),
            }
        };
        let corners: Vec<Corner> = inside.keys().map(corner).collect();
        let number: BTreeMap<WedgeId, u32> = inside.keys().copied().zip(0..).collect();
        let patch = self.patch_of(faces, corners, |h| number[&self.layout.cut.wedge(h)], moving.len(), Self::reference);
        let Some(patch) = patch.filter(|_| !moving.is_empty()) else { return 0 };
        let untangled = patch.untangle(watch);
        if !untangled.succeeded {
            return 0;
        }
        let before = moving.iter().map(|&w| (w, self.layout.position[w.index()])).collect();
        for (&w, [x, y]) in moving.iter().zip(untangled.displacements) {
            self.layout.position[w.index()] += Complex64::new(x, y);
        }
        let vertices: BTreeSet<VertexId> = faces.iter().flat_map(|&f| input.corners(f)).collect();
        let is_on_seam = |v: &VertexId| self.layout.cut.wedges(*v).len() > 1;
        let loosened: Vec<VertexId> =
            vertices.iter().copied().filter(|v| is_on_seam(v) && !self.loose.contains(v)).collect();
        self.loose.extend(&loosened);
        if faces.iter().any(|&f| self.is_flipped(f)) || vertices.iter().any(|&v| self.winding(v) != 0.0) {
            self.put_back(before);
            loosened.iter().for_each(|v| _ = self.loose.remove(v));
            return 0;
        }
        faces.len()
    }

    /// Puts wedges back where they were.
    pub(super) fn put_back(&mut self, before: Moved) {
        before.into_iter().for_each(|(w, position)| self.layout.position[w.index()] = position);
    }

    /// A patch for untangling, and the vertices that its displacements move; none if nothing can move.
    fn patch(
        &self,
        faces: &[FaceId],
        fans: Fans,
        reference: impl Fn(&Self, FaceId) -> Sides,
    ) -> Option<(Patch, Vec<VertexId>)> {
        let input = self.input;
        let mut degree: BTreeMap<VertexId, usize> = BTreeMap::new();
        for v in faces.iter().flat_map(|&f| input.corners(f)) {
            *degree.entry(v).or_insert(0) += 1;
        }
        let held = |v: VertexId| fans == Fans::Held && input.neighbors(v).iter().any(|w| self.fanned.contains(w));
        let is_inside = |v: VertexId| !self.is_fixed(v) && degree[&v] == input.face_degree(v) && !held(v);
        let moving: Vec<VertexId> = degree.keys().copied().filter(|&v| is_inside(v)).collect();
        if moving.is_empty() {
            return None;
        }
        let mut index: BTreeMap<WedgeId, u32> = BTreeMap::new();
        let mut corners = Vec::new();
        for h in faces.iter().flat_map(|&f| input.sides(f)) {
            let w = self.layout.cut.wedge(h);
            index.entry(w).or_insert_with(|| {
                let (z, turn) = (self.layout.position[w.index()], self.turn[w.index()]);
                let displacement = moving.binary_search(&input.tail(h)).ok().map(|k| k as u32);
                corners.push(Corner { position: [z.re, z.im], displacement, rotation: [turn.re, turn.im] });
                corners.len() as u32 - 1
            });
        }
        let patch = self.patch_of(faces, corners, |h| index[&self.layout.cut.wedge(h)], moving.len(), reference)?;
        Some((patch, moving))
    }

    /// A patch of triangles with reference shapes; each halfedge has the number of a corner.
    fn patch_of(
        &self,
        faces: &[FaceId],
        corners: Vec<Corner>,
        corner: impl Fn(HalfedgeId) -> u32,
        displacements: usize,
        reference: impl Fn(&Self, FaceId) -> Sides,
    ) -> Option<Patch> {
        let areas = faces.iter().map(|&f| reference(self, f).area());
        let mean_area = areas.sum::<f64>() / faces.len() as f64;
        let triangle = |&f: &FaceId| {
            let reference = reference(self, f);
            let weight = (reference.area() / mean_area).sqrt().max(0.01);
            PatchTriangle { corners: self.input.sides(f).map(&corner), lengths: reference.0, weight }
        };
        Patch::new(corners, faces.iter().map(triangle).collect(), displacements).ok()
    }
}

/// For each wedge the rotation from its vertex's first wedge.
fn wedge_turns(input: &Mesh, layout: &Layout) -> Vec<Complex64> {
    let mut turn = vec![None; layout.cut.wedge_count()];
    for v in input.vertices() {
        let first = layout.cut.wedges(v).next().expect("every vertex has a wedge");
        if layout.cut.wedges(v).len() == 1 {
            turn[first.index()] = Some(Complex64::ONE);
            continue;
        }
        let around: Vec<HalfedgeId> = input.outgoing(v).collect();
        let start = around.iter().position(|&h| layout.cut.wedge(h) == first).unwrap_or(0);
        let mut current = Complex64::ONE;
        for k in 0..around.len() {
            let h = around[(start + k) % around.len()];
            if k > 0 && layout.cut.wedge(h) != layout.cut.wedge(around[(start + k - 1) % around.len()]) {
                current *= layout.seam_rotation[h];
            }
            turn[layout.cut.wedge(h).index()].get_or_insert(current);
        }
    }
    turn.into_iter().map(|turn| turn.unwrap_or(Complex64::ONE)).collect()
}

/// Angles moved by a common amount and clipped, such that they sum to `sum`: found by bisection, the sum being monotone.
fn clipped_to_sum(angles: &[f64], low: f64, high: f64, sum: f64) -> Vec<f64> {
    let clipped = |shift: f64| angles.iter().map(|a| (a + shift).clamp(low, high)).collect::<Vec<f64>>();
    let (mut from, mut to) = (-2.0 * PI, 2.0 * PI);
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        if clipped(middle).iter().sum::<f64>() < sum {
            from = middle;
        } else {
            to = middle;
        }
    }
    clipped(0.5 * (from + to))
}

fn cross(a: Complex64, b: Complex64) -> f64 {
    a.re * b.im - a.im * b.re
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Operators;
    use crate::flatten::flattened::Flattened;
    use crate::flatten::{Seams, scale};
    use geom::shapes;

    #[test]
    fn folded_triangles_are_turned_over_also_across_seams() {
        let shape = shapes::hare(1200);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let operators = Operators::new(&mesh, &metric).unwrap();
        let cones = [0, 300, 600, 900, 1100].map(VertexId);
        let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
        let mut is_cone = VertexData::constant(mesh.vertex_count(), false);
        for v in cones {
            target[v] = operators.total_curvature() / cones.len() as f64;
            is_cone[v] = true;
        }
        let zero = VertexData::constant(mesh.vertex_count(), 0.0);
        let scaling = scale(&mesh, &metric, &operators, &target, &zero, Watch::NONE).unwrap();
        let seams = Seams::new(&mesh, metric.lengths(), &cones, Watch::NONE).unwrap();
        let mut layout = Layout::new(&mesh, &scaling, &seams.cut, Watch::NONE).unwrap();
        let fixed = Fixed { is_cone, is_side: None, may_loosen: false };
        remove_fold_overs(&mesh, &metric, &scaling, &fixed, &mut layout, Watch::NONE).unwrap();
        // Fold plain vertices over an edge of their stars: one inside, one on a seam.
        let plain = |wedges: usize| {
            let layout = &layout;
            let is_cone = &fixed.is_cone;
            mesh.vertices().filter(move |&v| layout.cut.wedges(v).len() == wedges && !is_cone[v])
        };
        let inside = plain(1).nth(20).unwrap();
        let seam = plain(2).nth(3).unwrap();
        for v in [inside, seam] {
            let mut folded = layout.clone();
            let mut untangler = Untangler::new(&mesh, &metric, &scaling, &fixed, &mut folded, Watch::NONE).unwrap();
            let h = mesh.outgoing(v).next().unwrap();
            let spoke = untangler.layout.corner(mesh.next(h)) - untangler.layout.corner(h);
            untangler.displace(h, 1.5 * spoke);
            assert!(!untangler.bad().is_empty());
            let angles = |v: VertexId| mesh.outgoing(v).map(|h| untangler.signed_angle(h)).sum::<f64>();
            let counted = mesh.vertices().filter_map(|v| Some((v, untangler.closed_angle(v)?)));
            let counted: Vec<(VertexId, f64)> = counted.collect();
            assert!(10 * counted.len() > 8 * mesh.vertex_count());
            assert!(counted.into_iter().all(|(v, angle)| (angle - angles(v)).abs() < 1e-9));
            assert!(remove_fold_overs(&mesh, &metric, &scaling, &fixed, &mut folded, Watch::NONE).unwrap() > 0);
            let untangler = Untangler::new(&mesh, &metric, &scaling, &fixed, &mut folded, Watch::NONE).unwrap();
            assert!(untangler.bad().is_empty());
            for h in mesh.halfedges() {
                let g = mesh.twin(h).unwrap();
                let here = untangler.layout.corner(mesh.next(h)) - untangler.layout.corner(h);
                let there = untangler.layout.corner(g) - untangler.layout.corner(mesh.next(g));
                let gap = (here - untangler.layout.seam_rotation[h] * there).norm();
                assert!(gap < 1e-9, "seams stay rigid: {gap}, {here}");
            }
        }
    }

    #[test]
    fn what_rigid_seams_do_not_let_unfold_is_unfolded_with_loose_ones() {
        let cones = [0, 300, 600, 900, 1100].map(VertexId);
        let Flattened { mesh, metric, scaling, layout, .. } = Flattened::new(&shapes::hare(1200), &cones);
        let mut is_cone = VertexData::constant(mesh.vertex_count(), false);
        cones.iter().for_each(|&v| is_cone[v] = true);
        let mut sound = layout;
        let fixed = Fixed { is_cone, is_side: None, may_loosen: false };
        remove_fold_overs(&mesh, &metric, &scaling, &fixed, &mut sound, Watch::NONE).unwrap();
        // One copy of a vertex on a seam drawn across the side opposite to it, where no vertex is to move.
        let is_plain = |v: &VertexId| sound.cut.wedges(*v).len() == 2 && !cones.contains(v);
        let v = mesh.vertices().filter(is_plain).nth(3).expect("seams have vertices");
        let h = mesh.outgoing(v).next().expect("it has triangles");
        let wedge = sound.cut.wedge(h);
        let mut folded = sound.clone();
        folded.position[wedge.index()] +=
            1.5 * (sound.corner(mesh.next(h)) + sound.corner(mesh.prev(h)) - 2.0 * sound.corner(h));
        let is_upright = |layout: &Layout, f: FaceId| {
            let [a, b, c] = mesh.sides(f).map(|h| layout.corner(h));
            cross(b - a, c - a) > 0.0
        };
        assert!(!mesh.faces().all(|f| is_upright(&folded, f)));
        let mended = |may_loosen: bool| {
            let mut layout = folded.clone();
            let is_cone = VertexData::constant(mesh.vertex_count(), true);
            let fixed = Fixed { is_cone, is_side: None, may_loosen };
            let done = remove_fold_overs(&mesh, &metric, &scaling, &fixed, &mut layout, Watch::NONE);
            (done.is_ok(), layout)
        };
        let (is_mended, _) = mended(false);
        assert!(!is_mended, "the vertex is held");
        let (is_mended, layout) = mended(true);
        assert!(is_mended && mesh.faces().all(|f| is_upright(&layout, f)));
        let far = layout.position.iter().zip(&folded.position).filter(|(now, before)| now != before).count();
        assert!(far > 0 && far < 60, "{far} corners moved");
    }

    #[test]
    fn clipped_angles_sum_to_what_they_should() {
        let angles = clipped_to_sum(&[0.1, 3.0, 1.0], 0.4, 2.6, 5.0);
        assert!((angles.iter().sum::<f64>() - 5.0).abs() < 1e-12);
        assert!(angles.iter().all(|a| (0.4..=2.6).contains(a)));
    }
}
