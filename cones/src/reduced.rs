//! The reduced model: how good a set of cones is, without flattening anything.
//!
//! With curvatures q at the cones S the log scale factor is, to first order, u = p + Σ q_c g_c, where p takes away all
//! curvature and g_c is Green's function of cone c, both centred (see [`Operators::centre`]). Its squared norm weighted by
//! area w is quadratic,
//!
//! ```text
//!     E(S, q) = |u|² = E₀ + 2 q·b_S + qᵀ H_SS q,   E₀ = |p|²,  b_v = ⟨g_v, p⟩,  H_vx = ⟨g_v, g_x⟩,
//! ```
//!
//! and since L is symmetric, b = L⁺(w p) and the column h_v = L⁺(w g_v) hold these products for *all* vertices at once:
//! one more solve for b, and two for each candidate v. All further questions (the best curvatures, what it would bring to
//! move a cone anywhere) are answered from these columns.
//!
//! Vertices that have been solved for are the *pool*. Products within the pool are kept as f64; the columns, which only
//! tell where it pays to look, as f32: they are most of the memory.

use std::f64::consts::PI;

use geom::{Mesh, VertexData, VertexId};

use crate::angles::{degree_bound, general_bounds};
use crate::fit::{Held, Quadratic, fit};
use crate::operators::Operators;

/// Vertices that are solved for at once: enough to keep the factor in the cache, few enough for memory.
const BLOCK: usize = 16;

/// A surface's reduced model; see the module's head.
#[derive(Debug)]
pub struct Reduced<'a> {
    operators: &'a Operators,
    /// p, the centred log scale factor that takes away all curvature.
    flattening: VertexData<f64>,
    /// b
    linear: VertexData<f64>,
    /// E₀
    constant: f64,
    /// What lengths are multiplied by to make the area 1.
    unit: f64,
    /// The least curvature that each vertex can have, from the number of its triangles.
    lowest: VertexData<f64>,
    pool: Vec<VertexId>,
    /// Where a vertex is in the pool.
    place: VertexData<Option<u32>>,
    column: Vec<Vec<f32>>,
    /// H between members of the pool, row by row up to the diagonal.
    products: Vec<Vec<f64>>,
}

/// Cones with the best curvatures that they can have.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The cones.
    pub cones: Vec<VertexId>,
    /// The curvature of each.
    pub curvature: Vec<f64>,
    /// The squared norm of the log scale factor that linear theory predicts, weighted by area.
    pub energy: f64,
    /// How far the cones are from being able to take the surface's curvature, in radians; 0 where they can.
    pub shortfall: f64,
    /// Which curvatures are at a bound.
    pub(crate) held: Vec<Held>,
    /// What makes the energy's gradient vanish at free cones where the sum of curvatures is given.
    pub(crate) multiplier: f64,
    /// The bounds of each curvature, the shortfall taken into account.
    pub(crate) bounds: Vec<[f64; 2]>,
}

impl<'a> Reduced<'a> {
    /// The model of a surface whose layout will use the triangles of `input`. Two solves.
    pub fn new(operators: &'a Operators, input: &Mesh) -> Self {
        let mut flattening = operators.poisson.solve(&operators.flattening_source());
        operators.centre(&mut flattening);
        let linear = operators.poisson.solve(&operators.weighted(&flattening));
        let count = operators.mesh.vertex_count();
        Self {
            constant: operators.inner(&flattening, &flattening),
            flattening,
            linear,
            unit: operators.metric.area(&operators.mesh).sqrt().recip(),
            lowest: input.vertices().map(|v| degree_bound(input, v)).collect(),
            pool: Vec::new(),
            place: VertexData::constant(count, None),
            column: Vec::new(),
            products: Vec::new(),
            operators,
        }
    }

    /// The surface.
    pub fn operators(&self) -> &'a Operators {
        self.operators
    }

    /// p, the centred log scale factor that takes away all curvature.
    pub fn flattening(&self) -> &VertexData<f64> {
        &self.flattening
    }

    /// The vertices that have been solved for: two solves each.
    pub fn pool(&self) -> &[VertexId] {
        &self.pool
    }

    /// What the curvatures must sum to; nothing with a boundary.
    pub(crate) fn total(&self) -> Option<f64> {
        (!self.operators.is_bordered()).then(|| self.operators.total_curvature())
    }

    /// b
    pub(crate) fn linear(&self) -> &VertexData<f64> {
        &self.linear
    }

    /// E₀
    pub(crate) fn constant(&self) -> f64 {
        self.constant
    }

    /// What lengths are multiplied by to make the surface's area 1.
    pub(crate) fn unit(&self) -> f64 {
        self.unit
    }

    /// Whether a vertex has been solved for.
    pub fn knows(&self, v: VertexId) -> bool {
        self.place[v].is_some()
    }

    /// Adds vertices to the pool.
    pub fn add(&mut self, vertices: &[VertexId]) {
        let mut new = Vec::new();
        for &v in vertices {
            if !self.knows(v) && !new.contains(&v) {
                new.push(v);
            }
        }
        for block in new.chunks(BLOCK) {
            let mut green = self.operators.green(block);
            for g in &mut green {
                self.operators.centre(g);
                *g = self.operators.weighted(g);
            }
            for (&v, h) in block.iter().zip(self.operators.poisson.solve_many(&green)) {
                self.place[v] = Some(self.pool.len() as u32);
                self.pool.push(v);
                self.products.push(self.pool.iter().map(|&x| h[x]).collect());
                self.column.push(h.iter().map(|&h| h as f32).collect());
            }
        }
    }

    /// h of a member of the pool, rounded.
    pub(crate) fn column(&self, v: VertexId) -> &[f32] {
        &self.column[self.place_of(v)]
    }

    /// H_vx, for members of the pool.
    pub(crate) fn product(&self, v: VertexId, x: VertexId) -> f64 {
        let (i, j) = (self.place_of(v), self.place_of(x));
        self.products[i.max(j)][i.min(j)]
    }

    fn place_of(&self, v: VertexId) -> usize {
        self.place[v].expect("the vertex was added to the pool") as usize
    }

    /// The bounds of the curvature at a vertex where there are `count` cones in all.
    pub(crate) fn bounds(&self, v: VertexId, count: usize) -> [f64; 2] {
        let [low, high] = general_bounds(self.operators, count);
        [low.max(self.lowest[v]).min(high), high]
    }

    /// What a shortfall counts beside energies, per radian: more than any difference of energies.
    pub(crate) fn price(&self) -> f64 {
        1.0 + 10.0 * self.constant
    }

    /// The best curvatures of cones that are in the pool. Where they cannot take the surface's curvature within bounds the
    /// lower bounds give way, and the shortfall tells by how much.
    pub fn fit(&self, cones: &[VertexId]) -> Fitted {
        let n = cones.len();
        let linear: Vec<f64> = cones.iter().map(|&v| self.linear[v]).collect();
        let matrix: Vec<f64> = cones.iter().flat_map(|&v| cones.iter().map(move |&x| self.product(v, x))).collect();
        let mut bounds: Vec<[f64; 2]> = cones.iter().map(|&v| self.bounds(v, n)).collect();
        let total = self.total();
        let shortfall = self.relax(&mut bounds);
        let energy = Quadratic { constant: self.constant, linear: &linear, matrix: &matrix };
        match fit(&energy, &bounds, total) {
            Ok(fit) => Fitted {
                cones: cones.to_vec(),
                curvature: fit.curvatures,
                energy: fit.energy.max(0.0),
                shortfall,
                held: fit.held,
                multiplier: fit.multiplier,
                bounds,
            },
            // No cones on a surface that needs some.
            Err(_) => Fitted {
                cones: cones.to_vec(),
                curvature: vec![0.0; n],
                energy: self.constant,
                shortfall: total.map_or(0.0, f64::abs).max(shortfall),
                held: vec![Held::Lower; n],
                multiplier: 0.0,
                bounds,
            },
        }
    }

    /// Lowers the lower bounds evenly until they admit the sum; returns by how much in all.
    fn relax(&self, bounds: &mut [[f64; 2]]) -> f64 {
        let Some(total) = self.total() else { return 0.0 };
        let shortfall = bounds.iter().map(|[low, _]| low).sum::<f64>() - total;
        if bounds.is_empty() || shortfall <= 1e-9 {
            return 0.0;
        }
        let each = shortfall / bounds.len() as f64 + 1e-9;
        bounds.iter_mut().for_each(|[low, _]| *low -= each);
        shortfall
    }

    /// The log scale factor that linear theory predicts for cones with given curvatures, centred. One solve.
    pub fn log_scale(&self, cones: &[VertexId], curvature: &[f64]) -> VertexData<f64> {
        self.operators.log_scale(cones, curvature)
    }
}

impl Fitted {
    /// The L2 norm of the log scale factor that linear theory predicts.
    pub fn log_scale_norm(&self) -> f64 {
        self.energy.sqrt()
    }

    /// Whether this is a better set of cones than another: first of all they must be able to take the curvature.
    pub(crate) fn is_better_than(&self, other: &Self, by: f64) -> bool {
        let gap = self.shortfall - other.shortfall;
        if gap.abs() > 1e-6 * PI { gap < 0.0 } else { self.energy < (1.0 - by) * other.energy }
    }
}
