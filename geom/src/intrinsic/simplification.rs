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
    let mut surface = Surface::new(mesh, metric, weights);
    let worth: Vec<f64> = mesh.vertices().map(worth).collect();
    let mut left: Vec<VertexId> = mesh.vertices().collect();
    let mut threshold = weights[0].iter().sum::<f64>() / mesh.vertex_count() as f64;
    let mut idle = 0;
    while left.len() > count && idle < IDLE {
        let progress = (mesh.vertex_count() as f64 / left.len() as f64).ln();
        watch.ask(progress / (mesh.vertex_count() as f64 / count.max(1) as f64).ln())?;
        let before = left.len();
        let mut excess = before - count;
        left.retain(|&v| {
            let goes =
                excess > 0 && surface.weight[v.index()][0] * worth[v.index()] <= threshold && surface.take_out(v);
            excess -= usize::from(goes);
            !goes
        });
        idle = if left.len() < before { 0 } else { idle + 1 };
        threshold *= RISE;
    }
    Ok(surface.finish())
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

    /// Takes out a vertex if that can be done.
    fn take_out(&mut self, v: VertexId) -> bool {
        let is_boundary = self.is_boundary[v.index()];
        if !self.gather(v, is_boundary) || !self.star.flatten(if is_boundary { PI } else { TAU }) {
            return false;
        }
        let Some(ears) = self.star.ears(is_boundary) else { return false };
        self.hand_on(v, is_boundary);
        self.suspects.clear();
        let Self { star, suspects, triangulation, .. } = self;
        suspects.extend(star.outgoing.iter().map(|&h| triangulation.edge(triangulation.next(h))));
        for ear in ears {
            self.cut_ear(ear);
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
        let share = self.star.shares(is_boundary);
        let own = self.weight[v.index()];
        for (&w, share) in self.star.neighbor.iter().zip(share) {
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

    fn finish(self) -> Simplified<N> {
        let (triangulation, vertex, edge) = self.triangulation.without_gaps(|f| self.is_gone[f.index()]);
        let weights = std::array::from_fn(|k| vertex.iter().map(|v| self.weight[v.index()][k]).collect());
        let length = edge.iter().map(|&e| self.length[e]).collect();
        Simplified { triangulation, metric: Metric::new(length), vertex, weights }
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

    /// The places of neighbours, each once those before it are removed, that flips take away until three are left, on the
    /// boundary three with the two along it.
    fn ears(&self, is_boundary: bool) -> Option<Vec<usize>> {
        let mut corners = self.position.clone();
        let mut ears = Vec::new();
        let least = 3;
        while corners.len() > least {
            let n = corners.len();
            let inner = if is_boundary { 1..n - 1 } else { 0..n };
            let is_ear = |&k: &usize| {
                let [before, at, after] = [corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]];
                is_left(minus(at, before), minus(after, at)) && is_left(before, after)
            };
            let ear = inner.into_iter().find(is_ear)?;
            corners.remove(ear);
            ears.push(ear);
        }
        let [a, b, c] = corners[..] else { return None };
        is_left(minus(b, a), minus(c, b)).then_some(ears)
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

    /// What share of the vertex's weight each neighbour gets.
    fn shares(&self, is_boundary: bool) -> Vec<f64> {
        let n = self.position.len();
        let mut share = vec![0.0; n];
        if is_boundary {
            let whole = self.radius[0] + self.radius[n - 1];
            (share[0], share[n - 1]) = (self.radius[n - 1] / whole, self.radius[0] / whole);
            return share;
        }
        for k in 0..n {
            let next = (k + 1) % n;
            let [p, q] = [self.position[k], self.position[next]];
            let across = minus(q, p);
            let area = cross(p, q).max(f64::MIN_POSITIVE);
            // The cotangents at q and at p, opposite the edges to p and to q.
            share[k] += dot(q, across) / area;
            share[next] -= dot(p, across) / area;
        }
        share.iter_mut().for_each(|share| *share = share.max(0.0));
        let whole: f64 = share.iter().sum();
        if !(whole > 0.0 && whole.is_finite()) {
            return vec![1.0 / n as f64; n];
        }
        share.iter_mut().for_each(|share| *share /= whole);
        share
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
