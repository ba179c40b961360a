//! Intrinsic simplification: the same surface, roughly, on few of its vertices.
//!
//! Liu, Gillespie, Chislett, Sharp, Jacobson & Crane ("Surface simplification using intrinsic error metrics", 2023) take
//! vertices out one by one: a vertex is *flattened*, by scaling the edges round it alike until the angles at it are those of the
//! plane, which leaves its curvature to its neighbours; edges are flipped until it has three triangles, and these become one. Only
//! lengths are needed, and topology stays.
//!
//! What differs: each vertex carries a *weight*, which it leaves to its neighbours by its cotangent weights, so that the weighted
//! sum of a function that is harmonic round it stays; and the lightest vertices go first, in sweeps over the vertices in their
//! order with a rising threshold in place of a queue, so that those left have about the same weight. The triangulation is kept
//! Delaunay. Flattening need not be exact, since lengths outside the star stay as they are: what is left of the curvature
//! goes where it may. Vertices that cannot be flattened (tips sharper than a right angle's worth, needles, loops) stay.

use std::f64::consts::{PI, TAU};

use super::delaunay::{TOLERANCE, opposite_cosines, other_diagonal, quad};
use super::metric::Metric;
use crate::mesh::{EdgeData, EdgeId, HalfedgeId, Id, Mesh, Triangulation, VertexData, VertexId};
use crate::watch::{Interrupted, Watch};

/// Vertices with more edges wait until they have fewer.
const MOST_EDGES: usize = 24;
/// A vertex is flat when its angles are so near to those of the plane, in radians.
const FLAT: f64 = 1e-4;
/// So many steps of Newton's method flatten a vertex, or it stays.
const STEPS: usize = 8;
/// The threshold of weights rises by this from sweep to sweep: faster, and vertices are left unevenly.
const RISE: f64 = 1.5;
/// No more flips than this follow when a vertex is taken out: on needles rounding may go round in circles.
const FLIPS: usize = 1000;
/// The least sine of an angle that counts as one.
const CLEAR: f64 = 1e-9;
/// So many vertices are looked at between two looks at the watch.
const STRIDE: usize = 4096;
/// Sweeps end when so many in a row have taken out nothing.
const IDLE: usize = 12;

/// A surface on few of its vertices; see the module's head.
#[derive(Clone, Debug)]
pub struct Simplified<const N: usize> {
    /// The intrinsic Delaunay triangulation.
    pub triangulation: Triangulation,
    /// Its edge lengths.
    pub metric: Metric,
    /// Which vertex of the surface each of its vertices is, ascending.
    pub vertex: Vec<VertexId>,
    /// For each kind of weight given, that of each of its vertices; sums stay.
    pub weights: [VertexData<f64>; N],
    sweeps: Sweeps,
}

/// How far sweeps have come.
#[derive(Clone, Debug)]
struct Sweeps {
    threshold: f64,
    /// So many in a row have taken out nothing.
    idle: usize,
    /// Where the last one has ended early, among the vertices that are left.
    paused_at: Option<usize>,
    /// A halfedge that starts at each vertex that is left.
    outgoing: Vec<HalfedgeId>,
}

/// Takes vertices out of a surface until `count` are left, or more where no other can be taken out. `weights` are those to be
/// handed on, by vertex; the first tells which vertices go first, multiplied by `worth`. The mesh must be intrinsic Delaunay
/// already. O(V) for surfaces met in practice.
///
/// # Errors
/// If the watch has said stop.
///
/// # Panics
/// If there are no weights, or not one for each vertex.
pub fn simplified<const N: usize>(
    mesh: &Mesh,
    metric: &Metric,
    weights: [&[f64]; N],
    worth: impl Fn(VertexId) -> f64,
    count: usize,
    watch: Watch,
) -> Result<Simplified<N>, Interrupted> {
    let surface = Surface::new(mesh, metric, weights);
    let worth: Vec<f64> = mesh.vertices().map(worth).collect();
    let threshold = weights[0].iter().sum::<f64>() / mesh.vertex_count() as f64;
    let sweeps = Sweeps { threshold, idle: 0, paused_at: None, outgoing: Vec::new() };
    surface.swept(&worth, sweeps, count, watch)
}

impl<const N: usize> Simplified<N> {
    /// What [`simplified`] makes of the surface, by the same `worth` of its vertices, where fewer are to be left: the same to the bit, in less time.
    ///
    /// # Errors
    /// If the watch has said stop.
    pub fn further(&self, worth: impl Fn(VertexId) -> f64, count: usize, watch: Watch) -> Result<Self, Interrupted> {
        let worth: Vec<f64> = self.vertex.iter().map(|&v| worth(v)).collect();
        let mut further = Surface::of(self).swept(&worth, self.sweeps.clone(), count, watch)?;
        further.vertex.iter_mut().for_each(|v| *v = self.vertex[v.index()]);
        Ok(further)
    }
}

/// A surface while vertices are taken out of it.
struct Surface<const N: usize> {
    triangulation: Triangulation,
    length: EdgeData<f64>,
    /// A halfedge that starts at each vertex.
    outgoing: Vec<HalfedgeId>,
    is_boundary: Vec<bool>,
    is_gone: Vec<bool>,
    weight: Vec<[f64; N]>,
    star: Star,
    suspects: Vec<EdgeId>,
}

/// The surroundings of a vertex laid out in the plane, the vertex at the origin.
#[derive(Default)]
struct Star {
    /// The halfedges to the neighbours, counter-clockwise; on the boundary the last neighbour has none.
    outgoing: Vec<HalfedgeId>,
    /// cos θ of the triangle from each neighbour to the next is P - Q/s², with the edges at the vertex scaled by s.
    cosine: Vec<[f64; 2]>,
    /// The lengths of the edges at the vertex.
    radius: Vec<f64>,
    position: Vec<[f64; 2]>,
    neighbor: Vec<VertexId>,
    /// What [`find_ears`](Star::find_ears) and [`find_shares`](Star::find_shares) find, and the corners that are left on the way.
    ears: Vec<usize>,
    share: Vec<f64>,
    corners: Vec<[f64; 2]>,
}

impl<const N: usize> Surface<N> {
    fn new(mesh: &Mesh, metric: &Metric, weights: [&[f64]; N]) -> Self {
        let first = |v: VertexId| mesh.outgoing(v).next().expect("every vertex of a mesh has a triangle");
        Self {
            triangulation: mesh.triangulation().clone(),
            length: metric.lengths().clone(),
            outgoing: mesh.vertices().map(first).collect(),
            is_boundary: mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect(),
            is_gone: vec![false; mesh.face_count()],
            weight: (0..mesh.vertex_count()).map(|v| weights.map(|weight| weight[v])).collect(),
            star: Star::default(),
            suspects: Vec::new(),
        }
    }

    fn of(simple: &Simplified<N>) -> Self {
        let Simplified { triangulation, metric, weights, sweeps, .. } = simple;
        let mut is_boundary = vec![false; triangulation.vertex_count()];
        for h in triangulation.halfedges().filter(|&h| triangulation.twin(h).is_none()) {
            is_boundary[triangulation.tail(h).index()] = true;
        }
        Self {
            triangulation: triangulation.clone(),
            length: metric.lengths().clone(),
            outgoing: sweeps.outgoing.clone(),
            is_boundary,
            is_gone: vec![false; triangulation.face_count()],
            weight: (0..triangulation.vertex_count())
                .map(|v| std::array::from_fn(|k| weights[k][VertexId::new(v)]))
                .collect(),
            star: Star::default(),
            suspects: Vec::new(),
        }
    }

    /// Takes out vertices, sweep after sweep, until `count` are left or it cannot go on.
    fn swept(
        mut self,
        worth: &[f64],
        mut sweeps: Sweeps,
        count: usize,
        watch: Watch,
    ) -> Result<Simplified<N>, Interrupted> {
        let mut left: Vec<VertexId> = self.triangulation.vertices().collect();
        let first = left.len() as f64;
        let whole = (first / count.max(1) as f64).ln();
        while left.len() > count && sweeps.idle < IDLE {
            let progress = (first / left.len() as f64).ln() / whole;
            let (before, mut looked_at, mut is_stopped) = (left.len(), 0, watch.stops_at(progress));
            let from = sweeps.paused_at.take();
            let mut excess = before - count;
            left.retain(|&v| {
                looked_at += 1;
                if from.is_some_and(|from| looked_at <= from) {
                    return true;
                }
                is_stopped |= looked_at % STRIDE == 0 && watch.stops_at(progress);
                let is_light = || self.weight[v.index()][0] * worth[v.index()] <= sweeps.threshold;
                let goes = excess > 0 && !is_stopped && is_light() && self.take_out(v);
                if goes {
                    excess -= 1;
                    if excess == 0 {
                        sweeps.paused_at = Some(looked_at - (before - count));
                    }
                }
                !goes
            });
            if is_stopped {
                return Err(Interrupted);
            }
            if sweeps.paused_at.is_none() {
                sweeps.idle = if left.len() < before || from.is_some() { 0 } else { sweeps.idle + 1 };
                sweeps.threshold *= RISE;
            }
        }
        Ok(self.finish(&left, sweeps))
    }

    /// Takes out a vertex if that can be done.
    fn take_out(&mut self, v: VertexId) -> bool {
        let is_boundary = self.is_boundary[v.index()];
        if !self.gather(v, is_boundary) || !self.star.flatten(if is_boundary { PI } else { TAU }) {
            return false;
        }
        if !self.star.find_ears(is_boundary) {
            return false;
        }
        self.hand_on(v, is_boundary);
        self.suspects.clear();
        let Self { star, suspects, triangulation, .. } = self;
        suspects.extend(star.outgoing.iter().map(|&h| triangulation.edge(triangulation.next(h))));
        for k in 0..self.star.ears.len() {
            self.cut_ear(self.star.ears[k]);
        }
        self.merge(is_boundary);
        self.flip_suspects();
        true
    }

    /// Fills in the star of a vertex; false where it has too many edges, or a loop.
    fn gather(&mut self, v: VertexId, is_boundary: bool) -> bool {
        let Self { triangulation, length, star, outgoing, .. } = self;
        star.clear();
        let mut first = outgoing[v.index()];
        if is_boundary {
            for _ in 0..MOST_EDGES {
                let Some(twin) = triangulation.twin(first) else { break };
                first = triangulation.next(twin);
            }
            if triangulation.twin(first).is_some() {
                return false;
            }
        }
        let mut next = Some(first);
        while let Some(h) = next {
            let (across, back) = (triangulation.next(h), triangulation.prev(h));
            let [a, b, c] = [h, back, across].map(|h| length[triangulation.edge(h)]);
            star.outgoing.push(h);
            star.push_edge(triangulation.tail(across), a);
            star.cosine.push([(a * a + b * b) / (2.0 * a * b), c * c / (2.0 * a * b)]);
            next = triangulation.twin(back).filter(|&next| next != first);
            if next.is_none() && is_boundary {
                star.push_edge(triangulation.tail(back), b);
            }
            if star.outgoing.len() > MOST_EDGES {
                return false;
            }
        }
        let is_closed = is_boundary && star.neighbor.first() == star.neighbor.last();
        star.outgoing.len() >= if is_boundary { 2 } else { 3 } && !star.neighbor.contains(&v) && !is_closed
    }

    /// Leaves the weights of a vertex to its neighbours.
    fn hand_on(&mut self, v: VertexId, is_boundary: bool) {
        self.star.find_shares(is_boundary);
        let own = self.weight[v.index()];
        for (&w, &share) in self.star.neighbor.iter().zip(&self.star.share) {
            self.weight[w.index()].iter_mut().zip(own).for_each(|(weight, own)| *weight += share * own);
        }
    }

    /// Flips the edge to a neighbour away.
    fn cut_ear(&mut self, ear: usize) {
        let h = self.star.outgoing[ear];
        let moved = self.triangulation.prev(h);
        let e = self.triangulation.edge(h);
        self.flip(h);
        self.length[e] = self.star.diagonal(ear);
        self.suspects.push(e);
        let before = self.star.before(ear);
        self.star.outgoing[before] = moved;
        self.star.remove(ear);
    }

    /// Makes the last triangles of the vertex one.
    fn merge(&mut self, is_boundary: bool) {
        let h = self.star.outgoing[0];
        if is_boundary {
            let gone = self.triangulation.take_out_of_boundary(h);
            self.is_gone[gone.index()] = true;
            self.length[self.triangulation.edge(h)] = self.star.diagonal(1);
        } else {
            let gone = self.triangulation.take_out(h);
            gone.iter().for_each(|f| self.is_gone[f.index()] = true);
        }
        self.note_outgoing(h);
    }

    fn flip(&mut self, h: HalfedgeId) {
        self.triangulation.flip(h);
        self.note_outgoing(h);
        if let Some(g) = self.triangulation.twin(h) {
            self.note_outgoing(g);
        }
    }

    /// Remembers where the sides of a triangle start.
    fn note_outgoing(&mut self, h: HalfedgeId) {
        for side in self.triangulation.sides(self.triangulation.face(h)) {
            self.outgoing[self.triangulation.tail(side).index()] = side;
        }
    }

    /// Flips what is not Delaunay any more.
    fn flip_suspects(&mut self) {
        let mut budget = FLIPS;
        while let Some(e) = self.suspects.pop() {
            if budget == 0 || !self.triangulation.is_flippable(e) {
                continue;
            }
            let h = self.triangulation.halfedge(e);
            let quad = quad(&self.triangulation, h);
            let [jk, ki, il, lj] = quad;
            let sides = [self.length[jk], self.length[ki], self.length[il], self.length[lj]];
            if opposite_cosines(self.length[e], sides) >= -TOLERANCE {
                continue;
            }
            budget -= 1;
            self.length[e] = other_diagonal(self.length[e], sides);
            self.flip(h);
            self.suspects.extend(quad);
        }
    }

    fn finish(self, left: &[VertexId], sweeps: Sweeps) -> Simplified<N> {
        let (triangulation, vertex, edge) = self.triangulation.without_gaps(|f| self.is_gone[f.index()]);
        debug_assert_eq!(left, vertex);
        let weights = std::array::from_fn(|k| vertex.iter().map(|v| self.weight[v.index()][k]).collect());
        let length = edge.iter().map(|&e| self.length[e]).collect();
        // The number of triangles that are left before each.
        let before = |count: &mut usize, is_gone: &bool| Some(std::mem::replace(count, *count + usize::from(!is_gone)));
        let place: Vec<u32> = self.is_gone.iter().scan(0, before).map(|place| place as u32).collect();
        let moved = |h: HalfedgeId| {
            let f = self.triangulation.face(h).index();
            HalfedgeId::new(3 * place[f] as usize + h.index() - 3 * f)
        };
        let outgoing = vertex.iter().map(|v| moved(self.outgoing[v.index()])).collect();
        Simplified {
            triangulation,
            metric: Metric::new(length),
            vertex,
            weights,
            sweeps: Sweeps { outgoing, ..sweeps },
        }
    }
}

impl Star {
    fn clear(&mut self) {
        self.outgoing.clear();
        self.cosine.clear();
        self.radius.clear();
        self.neighbor.clear();
        self.position.clear();
    }

    fn push_edge(&mut self, neighbor: VertexId, radius: f64) {
        self.neighbor.push(neighbor);
        self.radius.push(radius);
    }

    /// Scales the edges at the vertex until its angles sum to `flat`, and lays them out; false where that cannot be.
    fn flatten(&mut self, flat: f64) -> bool {
        // Where all cosines are between -1 and 1.
        let bound = |side: f64| self.cosine.iter().map(move |[p, q]| (p + side) / q);
        let (least, most) = (bound(-1.0).fold(0.0, f64::max), bound(1.0).fold(f64::INFINITY, f64::min));
        let mut inverse_square = 1.0;
        for _ in 0..STEPS {
            if !(least < inverse_square && inverse_square < most) {
                return false;
            }
            let (sum, slope) = self.angles(inverse_square);
            let step = (flat - sum) / slope;
            if (flat - sum).abs() < FLAT {
                return self.lay_out(inverse_square);
            }
            let next = inverse_square + step;
            inverse_square = match next {
                next if next <= least => 0.5 * (inverse_square + least),
                next if next >= most => 0.5 * (inverse_square + most),
                next => next,
            };
        }
        false
    }

    /// The sum of the angles at the vertex with its edges scaled by s, and its derivative by 1/s².
    fn angles(&self, inverse_square: f64) -> (f64, f64) {
        let (mut x, mut y, mut turns, mut slope) = (1.0, 0.0_f64, 0.0, 0.0);
        for [p, q] in &self.cosine {
            let cos = p - q * inverse_square;
            let sin = (1.0 - cos * cos).max(f64::MIN_POSITIVE).sqrt();
            slope += q / sin;
            let was_below = y < 0.0;
            (x, y) = (x * cos - y * sin, x * sin + y * cos);
            if was_below && y >= 0.0 {
                turns += TAU;
            }
        }
        let angle = y.atan2(x);
        (turns + if angle < 0.0 { angle + TAU } else { angle }, slope)
    }

    fn lay_out(&mut self, inverse_square: f64) -> bool {
        let scale = inverse_square.sqrt().recip();
        let (mut x, mut y) = (1.0, 0.0);
        for (k, radius) in self.radius.iter().enumerate() {
            self.position.push([scale * radius * x, scale * radius * y]);
            let Some([p, q]) = self.cosine.get(k) else { break };
            let cos = p - q * inverse_square;
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            (x, y) = (x * cos - y * sin, x * sin + y * cos);
        }
        self.position.iter().flatten().all(|x| x.is_finite())
    }

    /// Finds the places of neighbours, each once those before it are removed, that flips take away until three are left, on the
    /// boundary three with the two along it; false where that cannot be.
    fn find_ears(&mut self, is_boundary: bool) -> bool {
        let Self { corners, ears, position, .. } = self;
        corners.clone_from(position);
        ears.clear();
        let least = 3;
        while corners.len() > least {
            let n = corners.len();
            let mut inner = if is_boundary { 1..n - 1 } else { 0..n };
            let is_ear = |&k: &usize| {
                let [before, at, after] = [corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]];
                is_left(minus(at, before), minus(after, at)) && is_left(before, after)
            };
            let Some(ear) = inner.find(is_ear) else { return false };
            corners.remove(ear);
            ears.push(ear);
        }
        let [a, b, c] = corners[..] else { return false };
        is_left(minus(b, a), minus(c, b))
    }

    fn before(&self, k: usize) -> usize {
        (k + self.position.len() - 1) % self.position.len()
    }

    /// The distance between the neighbours beside one.
    fn diagonal(&self, k: usize) -> f64 {
        let [x, y] = minus(self.position[(k + 1) % self.position.len()], self.position[self.before(k)]);
        x.hypot(y)
    }

    fn remove(&mut self, k: usize) {
        self.outgoing.remove(k);
        self.position.remove(k);
        self.neighbor.remove(k);
    }

    /// Finds what share of the vertex's weight each neighbour gets.
    fn find_shares(&mut self, is_boundary: bool) {
        let Self { share, position, radius, .. } = self;
        let n = position.len();
        share.clear();
        share.resize(n, 0.0);
        if is_boundary {
            let whole = radius[0] + radius[n - 1];
            (share[0], share[n - 1]) = (radius[n - 1] / whole, radius[0] / whole);
            return;
        }
        for k in 0..n {
            let next = (k + 1) % n;
            let [p, q] = [position[k], position[next]];
            let across = minus(q, p);
            let area = cross(p, q).max(f64::MIN_POSITIVE);
            // The cotangents at q and at p, opposite the edges to p and to q.
            share[k] += dot(q, across) / area;
            share[next] -= dot(p, across) / area;
        }
        share.iter_mut().for_each(|share| *share = share.max(0.0));
        let whole: f64 = share.iter().sum();
        match whole > 0.0 && whole.is_finite() {
            true => share.iter_mut().for_each(|share| *share /= whole),
            false => share.fill(1.0 / n as f64),
        }
    }
}

fn minus(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [p[0] - q[0], p[1] - q[1]]
}

fn dot(p: [f64; 2], q: [f64; 2]) -> f64 {
    p[0] * q[0] + p[1] * q[1]
}

fn cross(p: [f64; 2], q: [f64; 2]) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

/// Whether a vector is clearly to the left of another.
fn is_left(from: [f64; 2], to: [f64; 2]) -> bool {
    let area = cross(from, to);
    area > 0.0 && area * area > CLEAR * CLEAR * dot(from, from) * dot(to, to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intrinsic::{angle_defects, delaunay, edge_weights};
    use crate::shapes::{self, Shape};
    use proptest::prelude::*;

    fn intrinsic(shape: &Shape) -> (Mesh, Metric) {
        let mesh = shape.mesh();
        let intrinsic = delaunay(&mesh, &Metric::from_points(&mesh, &shape.points));
        (Mesh::from_triangulation(intrinsic.triangulation).unwrap(), intrinsic.metric)
    }

    fn to_count(mesh: &Mesh, metric: &Metric, count: usize) -> Simplified<2> {
        let areas = metric.vertex_areas(mesh);
        let defects = angle_defects(mesh, metric);
        simplified(mesh, metric, [&areas, &defects], |_| 1.0, count, Watch::NONE).unwrap()
    }

    /// Asserts what is true of any simplification.
    fn check(mesh: &Mesh, metric: &Metric, simple: &Simplified<2>) -> Mesh {
        simple.triangulation.check();
        let left = Mesh::from_triangulation(simple.triangulation.clone()).unwrap();
        left.check();
        assert_eq!(left.euler_characteristic(), mesh.euler_characteristic());
        assert_eq!(left.boundary_loops().len(), mesh.boundary_loops().len());
        assert!(simple.vertex.windows(2).all(|two| two[0] < two[1]));
        for (v, &before) in left.vertices().zip(&simple.vertex) {
            assert_eq!(left.is_boundary_vertex(v), mesh.is_boundary_vertex(before));
        }
        let wanted = [metric.vertex_areas(mesh), angle_defects(mesh, metric)];
        for (after, before) in simple.weights.iter().zip(&wanted) {
            let [after, before] = [after, before].map(|weights| weights.iter().sum::<f64>());
            assert!((after - before).abs() < 1e-9 * (1.0 + before.abs()), "{after} of {before}");
        }
        left
    }

    #[test]
    fn topology_and_sums_of_weights_stay_and_so_many_vertices_are_left() {
        let shapes = [
            shapes::hare(1500),
            shapes::torus(2, 1200),
            shapes::cylinder(900),
            shapes::terrain(900, 3),
            shapes::capsule(800),
        ];
        for shape in shapes {
            let (mesh, metric) = intrinsic(&shape);
            let simple = to_count(&mesh, &metric, 150);
            check(&mesh, &metric, &simple);
            assert_eq!(simple.vertex.len(), 150);
            let weights = edge_weights(&simple.triangulation, &simple.metric);
            let inner = simple.triangulation.edges().filter(|&e| !simple.triangulation.is_boundary_edge(e));
            assert!(inner.into_iter().all(|e| weights[e] > -1e-6), "it is Delaunay");
            let even = simple.weights[0].iter().sum::<f64>() / 150.0;
            assert!(simple.weights[0].iter().all(|&area| area < 12.0 * even), "weights are about even");
        }
    }

    #[test]
    fn simplified_further_a_surface_is_what_it_is_at_once_to_the_bit() {
        for shape in [shapes::hare(1500), shapes::torus(2, 1200), shapes::terrain(900, 3), shapes::capsule(800)] {
            let (mesh, metric) = intrinsic(&shape);
            for (first, then) in [(700, 150), (400, 399), (151, 150), (150, 20), (20, 1), (2, 1)] {
                let (before, at_once) = (to_count(&mesh, &metric, first), to_count(&mesh, &metric, then));
                let after = before.further(|_| 1.0, then, Watch::NONE).unwrap();
                assert_eq!((&after.triangulation, &after.metric), (&at_once.triangulation, &at_once.metric));
                assert_eq!((&after.vertex, &after.weights), (&at_once.vertex, &at_once.weights));
            }
        }
    }

    #[test]
    fn a_flat_surface_stays_as_it_is_and_moments_stay() {
        let shape = shapes::square(600);
        let (mesh, metric) = intrinsic(&shape);
        let areas = metric.vertex_areas(&mesh);
        // A square's corners cannot be flattened without moving: they are kept.
        let simple = simplified(&mesh, &metric, [&areas], |v| 1e9_f64.powf(angle(&mesh, &metric, v)), 60, Watch::NONE);
        let simple = simple.unwrap();
        let area = simple.metric.area(&simple.triangulation);
        assert!((area - metric.area(&mesh)).abs() < 1e-9 * area);
        for axis in 0..2 {
            let before: f64 = mesh.vertices().map(|v| areas[v] * shape.points[v.index()][axis]).sum();
            let after: f64 = simple
                .vertex
                .iter()
                .zip(simple.weights[0].iter())
                .map(|(v, w)| w * shape.points[v.index()][axis])
                .sum();
            assert!((after - before).abs() < 1e-9, "{after} for {before}");
        }
    }

    fn angle(mesh: &Mesh, metric: &Metric, v: VertexId) -> f64 {
        angle_defects(mesh, metric)[v].abs()
    }

    #[test]
    fn no_vertex_is_taken_out_where_enough_are_asked_for_and_a_stop_is_heard() {
        let (mesh, metric) = intrinsic(&shapes::hare(300));
        let simple = to_count(&mesh, &metric, 1000);
        assert_eq!((&simple.triangulation, &simple.metric), (mesh.triangulation(), &metric));
        let stop = |_: f64| std::ops::ControlFlow::Break(());
        let areas = metric.vertex_areas(&mesh);
        assert!(simplified(&mesh, &metric, [&areas], |_| 1.0, 10, Watch::new(&stop)).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Squashed and shaken until most triangles are needles, down to as few vertices as there can be.
        #[test]
        fn needles_and_noise_do_no_harm(
            kind in 0usize..4, squash in -6.0..0.0f64, noise in 0.0..0.3f64, seed in 0u64..1000, count in 1usize..200,
        ) {
            let mut shape = match kind {
                0 => shapes::hare(400),
                1 => shapes::torus(3, 400),
                2 => shapes::cylinder(300),
                _ => shapes::terrain(300, seed),
            };
            let mut state = seed;
            for point in &mut shape.points {
                for x in point.iter_mut() {
                    state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    *x += noise * ((state >> 40) as f64 / (1u64 << 24) as f64 - 0.5);
                }
                point[2] *= 10f64.powf(squash);
            }
            let mesh = shape.mesh();
            let metric = Metric::from_points(&mesh, &shape.points).mollified(&mesh, 1e-4);
            let intrinsic = delaunay(&mesh, &metric);
            let mesh = Mesh::from_triangulation(intrinsic.triangulation).unwrap();
            let simple = to_count(&mesh, &intrinsic.metric, count);
            check(&mesh, &intrinsic.metric, &simple);
            prop_assert!(simple.metric.lengths().iter().all(|l| l.is_finite() && *l > 0.0));
        }
    }
}
