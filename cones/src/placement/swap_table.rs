//! What it would bring to move any one cone to any vertex, from the columns of the energy model alone.
//!
//! Take the cones' best curvatures q, F those between their bounds, and the inverse of their optimality conditions,
//!
//! ```text
//!     K = [[H_FF, 1], [1ᵀ, 0]]    (with a boundary H_FF alone),    T = [h_F(v) 1] K⁻¹    for a vertex v.
//! ```
//!
//! Let r be the energy's gradient at v and s = |g|² of its Green's function with what the free cones span projected out.
//! Without the free cone i, with κ its diagonal entry of K⁻¹, the energy is q²/κ more, and r and s turn into r - q T/κ and
//! s + T²/κ (q and T those of cone i); a curvature t at v then changes it by 2 r t + s t², least at t = -r/s between v's
//! bounds. A cone at a bound is taken away at its fixed curvature. All this is exact as long as the cones at bounds stay
//! the same.
//!
//! s is known in the pool. Elsewhere it follows from the distance d to the nearest free cone, on the surface scaled to
//! area 1, as for Green's function of the bilaplacian in the plane: s = d²/4π · max(log(R/d), ½), with R = 0.9/√|F|.
//! Without this norm cones would crowd.

use std::f64::consts::PI;
use std::sync::OnceLock;

use geom::{Id, VertexData, VertexId};

use super::energy_model::{ConeSet, EnergyModel};
use super::separation::Separation;
use crate::curvature::bounds_at;
use crate::numerics::dense;
use crate::numerics::quadratic_program::Held;

/// Distances count up to here, so that norms are finite where there is no cone at all.
const FARTHEST: f64 = 1e3;
/// The most steps that a descent along edges takes.
const LONGEST_DESCENT: usize = 200;

/// So many times [`LANES`] vertices are looked at between two looks at the watch.
pub(super) const STRIDE: usize = 128;

/// A change of a set of cones: what it is estimated to do to the energy, which cone leaves, and who comes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swap {
    pub(crate) change: f64,
    pub(crate) leaving: usize,
    pub(crate) coming: VertexId,
}

/// The table for one set of cones; see the module's head.
pub(crate) struct SwapTable<'a> {
    model: &'a EnergyModel<'a>,
    set: &'a ConeSet,
    columns: OnceLock<Vec<&'a [f32]>>,
    /// The places in the set of cones that are between their bounds.
    free: Vec<usize>,
    clamped: Vec<Clamped>,
    /// Where the cones are in the pool.
    places: Vec<usize>,
    /// What bounds the curvature of any cone, and the lower bound of each one's.
    bounds: [f64; 2],
    low: Vec<f64>,
    /// K⁻¹, row by row.
    inverse: Vec<f64>,
    order: usize,
    /// The sum of the lower bounds without relaxing them, less what the curvatures must sum to, if anything.
    slack: f64,
}

/// A cone whose curvature is at a bound.
struct Clamped {
    place: usize,
    /// r and s there.
    gradient: f64,
    norm: f64,
    /// What taking it away at its curvature does to the energy.
    base: f64,
    /// K⁻¹ times `[h_F(c) 1]`.
    response: Vec<f64>,
}

/// A cone that may leave: without it the energy is `base` more, and with x the products of a vertex with the cones times `weights`,
/// and `offset`, r there falls by x times `slope`, and s grows by x² times `growth`.
pub(crate) struct Departure {
    place: usize,
    base: f64,
    slope: f64,
    growth: f64,
    weights: Vec<f64>,
    offset: f64,
}

/// So many vertices are looked at side by side.
pub(super) const LANES: usize = 8;

/// A number for each of some vertices.
type Lanes = [f64; LANES];

/// Room for the numbers of [`LANES`] vertices.
#[derive(Default)]
pub(crate) struct Rows {
    /// H between the vertices and each cone.
    product: Vec<Lanes>,
    /// T
    response: Vec<Lanes>,
    /// For each clamped cone the sum of its response times the vertices' products.
    projections: Vec<Lanes>,
    /// What moving each cone to the vertices changes.
    pub(crate) change: Vec<Lanes>,
}

impl<'a> SwapTable<'a> {
    pub(crate) fn new(model: &'a EnergyModel<'a>, set: &'a ConeSet) -> Self {
        let n = set.cones.len();
        let mut free: Vec<usize> = (0..n).filter(|&i| set.held[i] == Held::Free).collect();
        if free.is_empty() && model.total().is_some() {
            free = (0..n).collect();
        }
        let order = free.len() + usize::from(model.total().is_some());
        let low: Vec<f64> = set.cones.iter().map(|&c| model.bounds(c, n)[0]).collect();
        let mut table = Self {
            model,
            columns: OnceLock::new(),
            clamped: Vec::new(),
            places: set.cones.iter().map(|&c| model.place_of(c)).collect(),
            bounds: model.bounds_of(n),
            inverse: Vec::new(),
            slack: model.total().map_or(f64::NEG_INFINITY, |total| low.iter().sum::<f64>() - total),
            low,
            set,
            free,
            order,
        };
        table.inverse = table.inverse_conditions();
        table.clamped = (0..n).filter(|i| !table.free.contains(i)).map(|i| table.clamp(i)).collect();
        table
    }

    /// h of the cones, found when they are first asked for: moves within the pool take none.
    fn columns(&self) -> &[&'a [f32]] {
        self.columns.get_or_init(|| self.model.columns(&self.set.cones))
    }

    /// K⁻¹, with a ridge so small that it only matters where cones coincide.
    fn inverse_conditions(&self) -> Vec<f64> {
        let cone = |i: usize| self.set.cones[self.free[i]];
        let mut conditions = vec![0.0; self.order * self.order];
        for i in 0..self.free.len() {
            for j in 0..self.free.len() {
                conditions[i * self.order + j] = self.model.product(cone(i), cone(j));
            }
            conditions[i * self.order + i] *= 1.0 + 1e-12;
            if self.free.len() < self.order {
                conditions[i * self.order + self.free.len()] = 1.0;
                conditions[self.free.len() * self.order + i] = 1.0;
            }
        }
        dense::invert(conditions, self.order).unwrap_or_else(|| vec![0.0; self.order * self.order])
    }

    fn clamp(&self, place: usize) -> Clamped {
        let cone = self.set.cones[place];
        let mut rows = Rows::default();
        self.respond(&mut rows, &[cone]);
        let q = self.set.curvature[place];
        let [gradient, norm] = [self.gradients(&[self.model.linear_of(cone)], &rows), self.exact_norms(&[cone], &rows)];
        let [gradient, norm] = [gradient[0], norm[0]];
        let base = -2.0 * q * gradient + q * q * norm;
        Clamped { place, gradient, norm, base, response: rows.response.iter().map(|response| response[0]).collect() }
    }

    /// Fills in the products and T of members of the pool.
    fn respond(&self, rows: &mut Rows, members: &[VertexId]) {
        rows.product.clear();
        rows.product.resize(self.places.len(), [0.0; LANES]);
        for (lane, &v) in members.iter().enumerate() {
            let products = self.model.products_of(v, &self.places);
            rows.product.iter_mut().zip(products).for_each(|(lanes, product)| lanes[lane] = product);
        }
        self.apply_inverse(rows);
    }

    fn apply_inverse(&self, rows: &mut Rows) {
        let Rows { product, response, .. } = rows;
        response.clear();
        match self.free.len() < self.order {
            true => response.extend(self.inverse[self.free.len() * self.order..].iter().map(|&entry| [entry; LANES])),
            false => response.resize(self.order, [0.0; LANES]),
        }
        for (&i, inverse) in self.free.iter().zip(self.inverse.chunks_exact(self.order.max(1))) {
            response.iter_mut().zip(inverse).for_each(|(t, &entry)| add_scaled(t, &product[i], entry));
        }
    }

    /// r of vertices with these b.
    fn gradients(&self, linear: &[f64], rows: &Rows) -> Lanes {
        // What a sum begins with.
        let mut gradients = [-0.0; LANES];
        rows.product.iter().zip(&self.set.curvature).for_each(|(h, &q)| add_scaled(&mut gradients, h, q));
        for (gradient, linear) in gradients.iter_mut().zip(linear) {
            *gradient = linear + *gradient + self.set.multiplier;
        }
        gradients
    }

    /// s of members of the pool.
    fn exact_norms(&self, members: &[VertexId], rows: &Rows) -> Lanes {
        // [h_F(v) 1] · T
        let mut projections = [-0.0; LANES];
        for (&i, response) in self.free.iter().zip(&rows.response) {
            add_products(&mut projections, &rows.product[i], response);
        }
        let last = rows.response.get(self.free.len()).unwrap_or(&[0.0; LANES]);
        let mut norms = [0.0; LANES];
        for (lane, &v) in members.iter().enumerate() {
            norms[lane] = self.model.product(v, v) - (projections[lane] + last[lane]);
        }
        norms
    }

    /// What moving each cone to members of the pool changes; at most [`LANES`] of them.
    pub(crate) fn fill_for_members(&self, members: &[VertexId], rows: &mut Rows) {
        self.respond(rows, members);
        let linear = lanes(members, |v| self.model.linear_of(v));
        let norms = self.exact_norms(members, rows).map(|norm| norm.max(0.0));
        self.fill(members, linear, norms, rows);
    }

    /// What moving each cone to any vertices changes, with s given; at most [`LANES`] of them.
    pub(crate) fn fill_for_vertices(&self, vertices: &[VertexId], norm: impl Fn(VertexId) -> f64, rows: &mut Rows) {
        rows.product.clear();
        rows.product.extend(self.columns().iter().map(|h| lanes(vertices, |v| f64::from(h[v.index()]))));
        self.apply_inverse(rows);
        self.fill(vertices, lanes(vertices, |v| self.model.linear()[v]), lanes(vertices, norm), rows);
    }

    fn fill(&self, vertices: &[VertexId], linear: Lanes, norm: Lanes, rows: &mut Rows) {
        let gradient = self.gradients(&linear, rows);
        let q = &self.set.curvature;
        let (mut low, mut high) = ([0.0; LANES], [0.0; LANES]);
        for (lane, &v) in vertices.iter().enumerate() {
            [low[lane], high[lane]] = self.bounds_at(v);
        }
        let best = |base: f64, gradient: f64, norm: f64, [low, high]: [f64; 2]| {
            // Not `clamp`, which may panic: that would be looked at one vertex at a time.
            let t = (-gradient / norm.max(f64::MIN_POSITIVE)).max(low).min(high);
            base + t * (2.0 * gradient + t * norm)
        };
        self.project_clamped(rows);
        let Rows { product, response, projections, change } = rows;
        change.clear();
        change.resize(q.len(), [0.0; LANES]);
        for (k, &i) in self.free.iter().enumerate() {
            let kappa = self.inverse[k * self.order + k].max(f64::MIN_POSITIVE);
            let (base, response, change) = (q[i] * q[i] / kappa, &response[k], &mut change[i]);
            for l in 0..LANES {
                let t = response[l] / kappa;
                change[l] = best(base, gradient[l] - q[i] * t, norm[l] + t * response[l], [low[l], high[l]]);
            }
        }
        for (clamped, projection) in self.clamped.iter().zip(&*projections) {
            let i = clamped.place;
            let (product, change) = (&product[i], &mut change[i]);
            for l in 0..LANES {
                let covariance = product[l] - projection[l];
                change[l] = best(clamped.base, gradient[l] - q[i] * covariance, norm[l], [low[l], high[l]]);
            }
        }
        for (change, &own) in change.iter_mut().zip(&self.low) {
            change.iter_mut().zip(low).for_each(|(change, low)| *change += self.shortfall(low, own));
        }
    }

    /// For each clamped cone `[h_F(v) 1]` times its response.
    fn project_clamped(&self, rows: &mut Rows) {
        let Rows { product, projections, .. } = rows;
        projections.clear();
        projections.resize(self.clamped.len(), [-0.0; LANES]);
        for (clamped, projection) in self.clamped.iter().zip(projections) {
            for (&i, &x) in self.free.iter().zip(&clamped.response) {
                add_scaled(projection, &product[i], x);
            }
            let last = clamped.response.get(self.free.len()).unwrap_or(&0.0);
            projection.iter_mut().for_each(|sum| *sum += last);
        }
    }

    /// [`EnergyModel::bounds`] of a vertex beside as many cones.
    fn bounds_at(&self, v: VertexId) -> [f64; 2] {
        bounds_at(self.model.operators(), v, self.model.lowest(v), self.bounds)
    }

    /// The price of what the cones would lack with another lower bound in place of one's own.
    fn shortfall(&self, low: f64, own: f64) -> f64 {
        let after = self.slack + low - own;
        self.model.price() * (after.max(0.0) - self.slack.max(0.0))
    }

    /// What taking a cone away changes.
    pub(crate) fn removal(&self, place: usize) -> f64 {
        let q = self.set.curvature[place];
        match self.free.iter().position(|&i| i == place) {
            Some(k) => q * q / self.inverse[k * self.order + k].max(f64::MIN_POSITIVE),
            None => self.clamped.iter().find(|c| c.place == place).map_or(0.0, |c| c.base),
        }
    }

    /// What is needed to tell what moving one cone away changes.
    pub(crate) fn departure(&self, leaving: usize) -> Departure {
        let place = leaving;
        let last = self.free.len();
        let mut weights = vec![0.0; self.set.cones.len()];
        let q = self.set.curvature[leaving];
        if let Some(k) = self.free.iter().position(|&i| i == leaving) {
            let row = &self.inverse[k * self.order..(k + 1) * self.order];
            self.free.iter().zip(row).for_each(|(&i, &entry)| weights[i] = entry);
            let kappa = row[k].max(f64::MIN_POSITIVE);
            let offset = row.get(last).copied().unwrap_or(0.0);
            return Departure { place, base: q * q / kappa, slope: q / kappa, growth: kappa.recip(), weights, offset };
        }
        let clamped = self.clamped.iter().find(|clamped| clamped.place == leaving);
        let (base, response) = clamped.map_or((0.0, &[][..]), |clamped| (clamped.base, &clamped.response[..]));
        self.free.iter().zip(response).for_each(|(&i, &entry)| weights[i] = -entry);
        weights[leaving] = 1.0;
        let offset = -response.get(last).copied().unwrap_or(0.0);
        Departure { place, base, slope: q, growth: 0.0, weights, offset }
    }

    /// What moving one cone to each of some vertices changes, with r and s of a vertex given. The sums of curvatures' bounds are left aside.
    pub(crate) fn changes_at(
        &self,
        departure: &Departure,
        vertices: &[VertexId],
        at: impl Fn(usize) -> (f64, f64),
    ) -> Vec<f64> {
        let Departure { base, slope, growth, weights, offset, .. } = departure;
        let change = |(k, (&v, products)): (usize, (&VertexId, f64))| {
            let (gradient, norm) = at(k);
            let response = offset + products;
            let [low, high] = self.bounds_at(v);
            let (gradient, norm) = (gradient - slope * response, norm + growth * response * response);
            let t = (-gradient / norm.max(f64::MIN_POSITIVE)).clamp(low, high);
            base + t * (2.0 * gradient + t * norm)
        };
        vertices.iter().zip(self.combined(weights, vertices)).enumerate().map(change).collect()
    }

    /// The sum of the cones' h, each times a weight, at some vertices: column by column, since vertices near each other are in few lines of a
    /// column.
    fn combined(&self, weights: &[f64], vertices: &[VertexId]) -> Vec<f64> {
        let mut sums = vec![0.0; vertices.len()];
        for (h, weight) in self.columns().iter().zip(weights) {
            sums.iter_mut().zip(vertices).for_each(|(sum, v)| *sum += f64::from(h[v.index()]) * weight);
        }
        sums
    }

    /// What moving one cone to each of some vertices changes, with s given: in the time that [`fill_for_vertices`](Self::fill_for_vertices)
    /// takes for a few of them.
    fn changes_by(&self, departure: &Departure, vertices: &[VertexId], norm: impl Fn(usize) -> f64) -> Vec<f64> {
        let products = self.combined(&self.set.curvature, vertices);
        let gradient = |k: usize| self.model.linear()[vertices[k]] + products[k] + self.set.multiplier;
        let mut changes = self.changes_at(departure, vertices, |k| (gradient(k), norm(k)));
        let own = self.low[departure.place];
        changes.iter_mut().zip(vertices).for_each(|(x, &v)| *x += self.shortfall(self.bounds_at(v)[0], own));
        changes
    }

    /// For each cone the best vertex to move it to, and the end of a descent from it along edges; the best first.
    pub(crate) fn proposals(&self) -> Vec<Swap> {
        let separation = Separation::new(self.model.operators(), &self.set.cones);
        let norms = norms(self.model, self.set);
        let mut best: Vec<Option<Swap>> = vec![None; self.set.cones.len()];
        let mut rows = Rows::default();
        let open: Vec<VertexId> = self.model.operators().mesh.vertices().filter(|&v| separation.is_open(v)).collect();
        for (k, vertices) in open.chunks(LANES).enumerate() {
            if k.is_multiple_of(STRIDE) && self.model.is_stopped() {
                return Vec::new();
            }
            self.fill_for_vertices(vertices, |v| norms[v], &mut rows);
            for (leaving, changes) in rows.change.iter().enumerate() {
                for (&v, &change) in vertices.iter().zip(changes) {
                    if best[leaving].is_none_or(|best| change < best.change) && separation.admits(v, leaving) {
                        best[leaving] = Some(Swap { change, leaving, coming: v });
                    }
                }
            }
        }
        let descents = (0..self.set.cones.len()).map(|leaving| self.descend(leaving, &separation, &norms));
        let mut proposals: Vec<Swap> = best.into_iter().flatten().chain(descents).collect();
        proposals.sort_by(|a, b| a.change.total_cmp(&b.change));
        proposals
    }

    /// For each cone the best vertex within a distance of it that is not solved for, where it promises to lower the
    /// energy by a share. One solve.
    ///
    /// So near a cone all that a move needs of the columns is r. With D the squared norm of the difference of Green's functions of cone and
    /// vertex, estimated as s is, a the cone's own s while it is away, and what both have in common with others taken for the
    /// same, a curvature t at the vertex for q at the cone changes the energy by 2 (t r − q r₀) + a (t − q)² + t² D, r₀ the gradient at the
    /// cone, 0 between its bounds.
    pub(crate) fn proposals_within(&self, reach: f32, least_gain: f64) -> Vec<Swap> {
        let separation = Separation::new(self.model.operators(), &self.set.cones);
        let cones = yielding(self.set).len();
        let gradient = self.model.gradient(self.set);
        let best_round = |(leaving, &cone): (usize, &VertexId)| {
            let q = self.set.curvature[leaving];
            let [before, own] = self.gradient_and_norm(leaving);
            let change = |(v, distance): (VertexId, f32)| {
                let [low, high] = self.bounds_at(v);
                let (gradient, norm) = (gradient[v] + self.set.multiplier, norm_at(self.model, cones, distance));
                let t = ((own * q - gradient) / (own + norm)).clamp(low, high);
                let change = 2.0 * (t * gradient - q * before) + own * (t - q) * (t - q) + norm * t * t;
                Swap { change: change + self.shortfall(low, self.low[leaving]), leaving, coming: v }
            };
            let is_open = |v: VertexId| separation.admits(v, leaving) && !self.model.knows(v);
            let around = self.model.around(cone, reach, usize::MAX).into_iter().filter(|&(v, _)| is_open(v));
            let best = around.map(change).min_by(|a, b| a.change.total_cmp(&b.change));
            best.filter(|best| best.change < -least_gain * self.set.energy)
        };
        self.set.cones.iter().enumerate().filter_map(best_round).collect()
    }

    /// r of a cone, and s while it is away.
    fn gradient_and_norm(&self, place: usize) -> [f64; 2] {
        match self.free.iter().position(|&i| i == place) {
            Some(k) => [0.0, self.inverse[k * self.order + k].max(f64::MIN_POSITIVE).recip()],
            None => self.clamped.iter().find(|c| c.place == place).map_or([0.0; 2], |c| [c.gradient, c.norm.max(0.0)]),
        }
    }

    /// Walks from a cone along edges as long as that lowers the energy.
    fn descend(&self, leaving: usize, separation: &Separation, norms: &VertexData<f64>) -> Swap {
        let departure = self.departure(leaving);
        let mesh = &self.model.operators().mesh;
        let mut at = Swap { change: 0.0, leaving, coming: self.set.cones[leaving] };
        for _ in 0..LONGEST_DESCENT {
            let before = at.coming;
            let open = |&v: &VertexId| separation.admits(v, leaving);
            let open: Vec<VertexId> = mesh.neighbors(before).iter().copied().filter(open).collect();
            for (&coming, change) in open.iter().zip(self.changes_by(&departure, &open, |k| norms[open[k]])) {
                if change < at.change {
                    at = Swap { change, leaving, coming };
                }
            }
            if at.coming == before {
                break;
            }
        }
        at
    }
}

/// A number for each of some vertices, 0 beyond them.
fn lanes(vertices: &[VertexId], of: impl Fn(VertexId) -> f64) -> Lanes {
    let mut lanes = [0.0; LANES];
    lanes.iter_mut().zip(vertices).for_each(|(lane, &v)| *lane = of(v));
    lanes
}

fn add_scaled(sums: &mut Lanes, numbers: &Lanes, by: f64) {
    sums.iter_mut().zip(numbers).for_each(|(sum, x)| *sum += x * by);
}

fn add_products(sums: &mut Lanes, a: &Lanes, b: &Lanes) {
    sums.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a * b);
}

/// The cones whose nearness makes Green's functions small: those between their bounds, or all where there are none.
fn yielding(set: &ConeSet) -> Vec<VertexId> {
    let free = set.cones.iter().zip(&set.held).filter(|(_, held)| **held == Held::Free).map(|(&c, _)| c);
    if set.held.contains(&Held::Free) { free.collect() } else { set.cones.clone() }
}

/// s at a distance from the nearest of so many cones that yield, estimated.
fn norm_at(model: &EnergyModel, cones: usize, distance: f32) -> f64 {
    let parts = cones + usize::from(model.operators().is_bordered());
    let radius = 0.9 / (parts.max(1) as f64).sqrt();
    let d = f64::from(distance).min(FARTHEST);
    d * d / (4.0 * PI) * if d > 0.0 { (radius / d).ln().max(0.5) } else { 0.0 }
}

/// s at every vertex, estimated from distances along edges; 0 once searches must end.
pub(crate) fn norms(model: &EnergyModel, set: &ConeSet) -> VertexData<f64> {
    Nearness::default().norms(model, set)
}

/// Distances from the cones of sets that are mostly those before with some more: only what these change is found anew.
#[derive(Default)]
pub(crate) struct Nearness {
    cones: Vec<VertexId>,
    distance: Option<VertexData<f32>>,
}

impl Nearness {
    /// [`norms`] of a set.
    pub(crate) fn norms(&mut self, model: &EnergyModel, set: &ConeSet) -> VertexData<f64> {
        let operators = model.operators();
        let cones = yielding(set);
        let known = self.distance.take().filter(|_| self.cones.iter().all(|cone| cones.contains(cone)));
        let found = match known {
            Some(mut distance) => {
                let new = cones.iter().copied().filter(|cone| !self.cones.contains(cone));
                model.distances().lower_watched(&mut distance, new, model.watch()).map(|()| distance)
            }
            None => {
                let boundary = operators.mesh.vertices().filter(|&v| operators.mesh.is_boundary_vertex(v));
                model.distances().from_watched(cones.iter().copied().chain(boundary), model.watch())
            }
        };
        let distance = found.unwrap_or_else(|_| VertexData::constant(operators.mesh.vertex_count(), 0.0));
        let norms = distance.iter().map(|&d| norm_at(model, cones.len(), d)).collect();
        (self.cones, self.distance) = (cones, Some(distance));
        norms
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Operators;
    use geom::{Mesh, Metric, shapes};

    fn prepare(shape: &shapes::Shape) -> (Mesh, Operators) {
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        (mesh, operators)
    }

    /// Every so many inner vertices.
    fn every(mesh: &Mesh, step: usize) -> Vec<VertexId> {
        mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).step_by(step).collect()
    }

    #[test]
    fn one_cone_s_moves_are_those_of_the_table() {
        let mut priced = 0;
        for shape in [shapes::hare(1200), shapes::torus(2, 1200), shapes::terrain(900, 3)] {
            let (mesh, operators) = prepare(&shape);
            let pool = every(&mesh, 97);
            let mut model = EnergyModel::new(&operators, &mesh);
            model.add(&pool);
            let mut compare = |model: &EnergyModel, count: usize| {
                let set = model.fit(&pool[..count]);
                let table = SwapTable::new(model, &set);
                let vertices = every(&mesh, 31);
                let norm = |v: VertexId| 1e-3 * (1 + v.0) as f64;
                let mut rows = Rows::default();
                for (leaving, vertices) in (0..count).flat_map(|i| vertices.chunks(LANES).map(move |some| (i, some))) {
                    let changes = table.changes_by(&table.departure(leaving), vertices, |k| norm(vertices[k]));
                    table.fill_for_vertices(vertices, norm, &mut rows);
                    for ((&v, change), whole) in vertices.iter().zip(changes).zip(rows.change[leaving]) {
                        let is_same = change == whole || (change - whole).abs() <= 1e-9 * (1.0 + whole.abs());
                        assert!(is_same, "{change} for {whole}");
                        let price = table.shortfall(table.bounds_at(v)[0], table.low[leaving]);
                        priced += usize::from(price != 0.0 && whole.is_finite());
                    }
                }
            };
            // So that some cones are at their bounds, and that they must take more than the surface has: what that is too much has a price.
            model.with_largest_curvature(1.5 * PI, |model| compare(model, pool.len()));
            model.with_largest_curvature(0.5 * PI, |model| compare(model, pool.len() / 2));
            for corner in [0.2, 0.25, 0.28] {
                model.with_largest_corner(corner * PI, |model| compare(model, pool.len()));
            }
        }
        assert!(priced > 100, "{priced} moves have a price");
    }

    /// Works with half of a pool as cones, some at their bounds, and the other half, on three shapes.
    fn with_cones_at_bounds(mut work: impl FnMut(&EnergyModel, &ConeSet, &[VertexId])) {
        for shape in [shapes::hare(1200), shapes::torus(2, 1200), shapes::terrain(900, 3)] {
            let (mesh, operators) = prepare(&shape);
            let pool = every(&mesh, 29);
            let mut model = EnergyModel::new(&operators, &mesh);
            model.add(&pool);
            let (cones, others) = pool.split_at(pool.len() / 2);
            model.with_largest_curvature(0.9 * PI, |model| work(model, &model.fit(cones), others));
        }
    }

    #[test]
    fn vertices_side_by_side_have_the_bits_that_each_has_alone() {
        let mut clamped = 0;
        with_cones_at_bounds(|model, set, _| {
            let table = SwapTable::new(model, set);
            clamped += table.clamped.len();
            let bits = |rows: &Rows, lane: usize| -> Vec<u64> {
                rows.change.iter().map(|changes| changes[lane].to_bits()).collect()
            };
            let norm = |v: VertexId| 1e-3 * (1 + v.0) as f64;
            let compare = |vertices: &[VertexId], fill: &dyn Fn(&[VertexId], &mut Rows)| {
                let (mut together, mut alone) = (Rows::default(), Rows::default());
                for some in vertices.chunks(LANES) {
                    fill(some, &mut together);
                    for (lane, v) in some.iter().enumerate() {
                        fill(std::slice::from_ref(v), &mut alone);
                        assert_eq!(bits(&together, lane), bits(&alone, 0));
                    }
                }
            };
            compare(model.pool(), &|members, rows| table.fill_for_members(members, rows));
            let all = every(&model.operators().mesh, 7);
            compare(&all, &|vertices, rows| table.fill_for_vertices(vertices, norm, rows));
        });
        assert!(clamped > 5, "{clamped} cones are at their bounds");
    }

    #[test]
    fn the_table_is_what_a_new_fit_says_where_the_same_cones_are_at_bounds() {
        let mut compared = [0; 2];
        with_cones_at_bounds(|model, set, others| {
            let table = SwapTable::new(model, set);
            let mut rows = Rows::default();
            for &coming in others {
                table.fill_for_members(&[coming], &mut rows);
                let gradient = table.gradients(&[model.linear_of(coming)], &rows)[0];
                for leaving in 0..set.cones.len() {
                    let whole = rows.change[leaving][0];
                    let norm = table.exact_norms(&[coming], &rows)[0];
                    let alone = table.changes_at(&table.departure(leaving), &[coming], |_| (gradient, norm))[0];
                    assert!((alone - whole).abs() < 1e-4 * (1.0 + set.energy), "columns are rounded");
                    let mut cones = set.cones.clone();
                    cones[leaving] = coming;
                    let after = model.fit(&cones);
                    let others = |i: &usize| *i != leaving;
                    let same = (0..cones.len()).filter(others).all(|i| after.held[i] == set.held[i]);
                    let change = after.energy - set.energy;
                    if same && after.shortfall == 0.0 && set.shortfall == 0.0 {
                        assert!((whole - change).abs() < 1e-6 * (1.0 + set.energy));
                        compared[usize::from(set.held[leaving] != Held::Free)] += 1;
                    }
                }
            }
        });
        assert!(compared[0] > 500 && compared[1] > 5, "{compared:?} free and clamped cones were compared");
    }

    #[test]
    fn moves_to_vertices_nearby_bring_about_what_they_promise() {
        let mut compared = [0; 2];
        for shape in [shapes::hare(4000), shapes::torus(2, 4000), shapes::terrain(3000, 3)] {
            let (mesh, operators) = prepare(&shape);
            for largest in [1.5 * PI, 0.9 * PI] {
                let mut model = EnergyModel::new(&operators, &mesh).putting_columns_off();
                let cones = every(&mesh, 397);
                model.add(&cones);
                model.with_largest_curvature(largest, |model| {
                    let set = model.fit(&cones);
                    let proposals = SwapTable::new(model, &set).proposals_within(0.05, 1e-3);
                    for Swap { change, leaving, coming } in proposals {
                        model.add(&[coming]);
                        let mut moved = cones.clone();
                        moved[leaving] = coming;
                        let after = model.fit(&moved);
                        if set.shortfall + after.shortfall == 0.0 && after.held == set.held {
                            let share = (after.energy - set.energy) / change;
                            assert!((0.5..1.5).contains(&share), "{share} of what was promised");
                            compared[usize::from(set.held[leaving] != Held::Free)] += 1;
                        }
                    }
                });
            }
        }
        assert!(compared[0] > 20 && compared[1] > 2, "{compared:?} free and clamped cones were compared");
    }

    #[test]
    fn a_removal_costs_what_a_new_fit_says() {
        let (mesh, operators) = prepare(&shapes::hare(1200));
        let pool = every(&mesh, 90);
        let mut model = EnergyModel::new(&operators, &mesh);
        model.add(&pool);
        let set = model.fit(&pool);
        let table = SwapTable::new(&model, &set);
        for place in 0..pool.len() {
            let mut cones = pool.clone();
            cones.remove(place);
            let after = model.fit(&cones);
            let same = (0..cones.len()).all(|i| after.held[i] == set.held[i + usize::from(i >= place)]);
            if same {
                assert!((table.removal(place) - (after.energy - set.energy)).abs() < 1e-8 * (1.0 + set.energy));
            }
        }
    }

    #[test]
    fn moving_a_cone_to_where_it_is_changes_nothing() {
        let (mesh, operators) = prepare(&shapes::hare(1200));
        let pool = every(&mesh, 150);
        let mut model = EnergyModel::new(&operators, &mesh);
        model.add(&pool);
        let set = model.fit(&pool);
        let table = SwapTable::new(&model, &set);
        let mut rows = Rows::default();
        for (place, &cone) in pool.iter().enumerate().filter(|(i, _)| set.held[*i] == Held::Free) {
            table.fill_for_members(&[cone], &mut rows);
            assert!(rows.change[place][0].abs() < 1e-6 * (1.0 + set.energy));
        }
    }

    #[test]
    fn norms_of_growing_and_of_other_sets_are_those_found_anew() {
        for shape in [shapes::hare(1200), shapes::terrain(900, 3)] {
            let (mesh, operators) = prepare(&shape);
            let pool = every(&mesh, 40);
            let mut model = EnergyModel::new(&operators, &mesh);
            model.add(&pool);
            let mut nearness = Nearness::default();
            for cones in [&pool[..4], &pool[..5], &pool[..9], &pool[..9], &pool[3..8], &[], &pool[2..3]] {
                let set = model.fit(cones);
                assert_eq!(nearness.norms(&model, &set), norms(&model, &set));
            }
        }
    }

    #[test]
    fn norms_grow_with_the_distance_and_vanish_at_cones() {
        let (mesh, operators) = prepare(&shapes::hare(1200));
        let pool = every(&mesh, 100);
        let mut model = EnergyModel::new(&operators, &mesh);
        model.add(&pool);
        let set = model.fit(&pool);
        let norms = norms(&model, &set);
        let free = pool.iter().zip(&set.held).filter(|(_, held)| **held == Held::Free);
        assert!(free.clone().count() > 0 && free.clone().all(|(&v, _)| norms[v] == 0.0));
        assert!(mesh.vertices().filter(|v| !pool.contains(v)).all(|v| norms[v] > 0.0 && norms[v] < 1.0));
    }
}
