//! The energy model: how good a set of cones is, without flattening anything.
//!
//! With curvatures q at the cones S the log scale factor is, to first order, `u = p + Σ q_c g_c`, where p takes away
//! all curvature and `g_c` is Green's function of cone c, both centred (see [`Operators::centre`]). Its squared norm weighted by
//! area w is quadratic,
//!
//! ```text
//!     E(S, q) = |u|² = E₀ + 2 q·b_S + qᵀ H_SS q,   E₀ = |p|²,  b_v = ⟨g_v, p⟩,  H_vx = ⟨g_v, g_x⟩,
//! ```
//!
//! and since L is symmetric, `b = L⁺(w p)` and the column `h_v = L⁺(w g_v)` hold these products for *all* vertices at once:
//! one more solve for b, and two for each candidate v. All further questions (the best curvatures, what it would bring to
//! move a cone anywhere) are answered from these columns.
//!
//! Vertices that have been solved for are the *pool*. Products within the pool are kept as f64; the columns, which only
//! tell where it pays to look, as f32: they are most of the memory. Where cones are only moved a little most columns are never
//! looked at: of the first vertices of such a model Green's functions are kept, which give the products, and columns, as b, are found when they
//! are asked for.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use geom::{EdgeDistances, EdgeId, Interrupted, Mesh, VertexData, VertexId, Watch, gram_watched, vertices_around};

use rayon::prelude::*;

use crate::curvature::{
    ConeCurvatures, LARGEST_CORNER, LARGEST_CURVATURE, LEAST_SHARPENED, SHARPEST_CURVATURE, bounds_at, combine,
    general_bounds, usable_degree,
};
use crate::field::Operators;
use crate::numerics::quadratic_program::{Held, Optimum, ProgramError, Quadratic, minimise_from};

/// Vertices that are solved for at once: enough to keep the factor in the cache, few enough for memory.
const BLOCK: usize = 16;

/// Columns are put off for so many vertices at most: for more of them products with all others cost more than a column.
const MOST_GREEN: usize = 64;
/// Green's functions have so many values at most, 64 MB.
const MOST_GREEN_VALUES: usize = 1 << 23;

/// By so much, in radians, sums of bounds may miss the total curvature.
const SUM_TOLERANCE: f64 = 1e-9;

/// Fits may take so much work in all, the sum of the third powers of what they factor, before the search for better cones
/// ends with what it has: about two seconds. The heaviest of ordinary surfaces take a quarter. Where triangles are needles
/// nearly all curvatures end at bounds that they come to one by one, and what is looked for is rounding.
const MOST_WORK: u64 = 4_000_000_000;

/// What the energy model of a surface knows before any vertex is solved for.
#[derive(Debug)]
pub(crate) struct EnergyTerms {
    /// p, the centred log scale factor that takes away all curvature.
    flattening: VertexData<f64>,
    /// b, found when it is first asked for.
    linear: OnceLock<VertexData<f64>>,
    /// E₀
    constant: f64,
    /// What scales lengths to area 1.
    unit: f64,
    /// Found when they are first asked for.
    distances: OnceLock<EdgeDistances>,
    /// How many triangles of each vertex can open up.
    triangles: VertexData<f64>,
}

impl EnergyTerms {
    /// The terms of a surface whose layout will use the triangles of `input`. A solve, unless the surface was asked before.
    pub(crate) fn new(operators: &Operators, input: &Mesh, watch: Watch) -> Result<Self, Interrupted> {
        let triangles = input.vertices().map(|v| usable_triangles(input, v)).collect();
        Self::with_triangles(operators, triangles, watch)
    }

    /// The terms of a surface with so many triangles at each vertex that can open up.
    pub(crate) fn with_triangles(
        operators: &Operators,
        triangles: VertexData<f64>,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let mut flattening = operators.flattening_watched(watch)?.clone();
        operators.centre(&mut flattening);
        watch.ask(f64::NAN)?;
        let constant = operators.inner(&flattening, &flattening);
        let unit = operators.metric.area(&operators.mesh).sqrt().recip();
        Ok(Self { constant, flattening, linear: OnceLock::new(), unit, distances: OnceLock::new(), triangles })
    }
}

/// How many triangles of a vertex can open up.
pub(crate) fn usable_triangles(input: &Mesh, v: VertexId) -> f64 {
    usable_degree(input, &[], v) as f64
}

fn rounded(h: &VertexData<f64>) -> Vec<f32> {
    h.iter().map(|&h| h as f32).collect()
}

/// A surface's energy model with its pool; see the module's head.
#[derive(Debug)]
pub struct EnergyModel<'a> {
    operators: &'a Operators,
    terms: Arc<EnergyTerms>,
    watch: Watch<'a>,
    /// The widest angle that the triangles at a cone have on average.
    largest_corner: f64,
    /// The largest curvature of a cone, unless it takes more.
    largest_curvature: f64,
    pool: Vec<VertexId>,
    /// Where a vertex is in the pool.
    place: VertexData<Option<u32>>,
    /// b of each member.
    own_linear: Vec<f64>,
    column: Vec<OnceLock<Vec<f32>>>,
    /// The centred Green's functions of the first members, where columns are put off.
    green: Vec<VertexData<f64>>,
    puts_columns_off: bool,
    /// H between members of the pool, row by row up to the diagonal.
    products: Vec<Vec<f64>>,
    /// Stands for b once searches must end.
    no_linear: OnceLock<VertexData<f64>>,
    /// What fits have taken so far.
    work: AtomicU64,
}

/// Cones with the best curvatures that they can have.
#[derive(Clone, Debug, PartialEq)]
pub struct ConeSet {
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

impl<'a> EnergyModel<'a> {
    /// The model of a surface whose layout will use the triangles of `input`, with an empty pool. A solve, and one more for the first vertex.
    pub fn new(operators: &'a Operators, input: &Mesh) -> Self {
        let Ok(terms) = EnergyTerms::new(operators, input, Watch::NONE) else {
            unreachable!("only a watch interrupts");
        };
        Self::with_terms(operators, Arc::new(terms), Watch::NONE)
    }

    /// The same where its terms are known. Once the watch says stop, nothing is solved any more, searches end early, and what
    /// they return means nothing.
    pub(crate) fn with_terms(operators: &'a Operators, terms: Arc<EnergyTerms>, watch: Watch<'a>) -> Self {
        Self {
            operators,
            terms,
            watch,
            largest_corner: LARGEST_CORNER,
            largest_curvature: LARGEST_CURVATURE,
            pool: Vec::new(),
            place: VertexData::constant(operators.mesh.vertex_count(), None),
            own_linear: Vec::new(),
            column: Vec::new(),
            green: Vec::new(),
            puts_columns_off: false,
            products: Vec::new(),
            no_linear: OnceLock::new(),
            work: AtomicU64::new(0),
        }
    }

    /// The same, for searches that ask for few of the pool's columns.
    pub(crate) fn putting_columns_off(self) -> Self {
        Self { puts_columns_off: true, ..self }
    }

    /// The surface.
    pub fn operators(&self) -> &'a Operators {
        self.operators
    }

    /// p, the centred log scale factor that takes away all curvature.
    pub fn flattening(&self) -> &VertexData<f64> {
        &self.terms.flattening
    }

    /// The vertices that have been solved for: one and a half solves each.
    pub fn pool(&self) -> &[VertexId] {
        &self.pool
    }

    /// Watches work on this model whose progress is not known.
    pub(crate) fn watch(&self) -> Watch<'a> {
        self.watch.within(f64::NAN, f64::NAN)
    }

    /// Whether searches must end; see [`with_terms`](Self::with_terms).
    pub(crate) fn is_stopped(&self) -> bool {
        self.watch.stops_at(f64::NAN)
    }

    /// What the curvatures must sum to; nothing with a boundary.
    pub(crate) fn total(&self) -> Option<f64> {
        (!self.operators.is_bordered()).then(|| self.operators.total_curvature())
    }

    /// b. A solve where it is first asked for.
    pub(crate) fn linear(&self) -> &VertexData<f64> {
        let solve = || -> Result<VertexData<f64>, Interrupted> {
            let weighted = self.operators.weighted(&self.terms.flattening);
            let mut linear = self.operators.poisson().solve_watched(&weighted, self.watch())?;
            self.operators.subtract_spread_mean(&mut linear);
            Ok(linear)
        };
        self.terms.linear.get().unwrap_or_else(|| match solve() {
            Ok(linear) => self.terms.linear.get_or_init(|| linear),
            Err(Interrupted) => self.no_linear.get_or_init(|| self.nothing()),
        })
    }

    /// b of a member of the pool.
    pub(crate) fn linear_of(&self, v: VertexId) -> f64 {
        self.own_linear[self.place_of(v)]
    }

    /// Half the energy's derivative by a curvature at each vertex, cone or not: `L⁺(w u)`, u of these cones. One solve, where their columns take
    /// one for each; 0 where searches must end.
    pub(crate) fn gradient(&self, set: &ConeSet) -> VertexData<f64> {
        self.columns_of(vec![self.log_scale(&set.cones, &set.curvature)]).swap_remove(0)
    }

    /// Distances on the surface scaled to area 1.
    pub(crate) fn distances(&self) -> &EdgeDistances {
        self.terms.distances.get_or_init(|| EdgeDistances::new(&self.operators.mesh, self.unit_length()))
    }

    /// So many vertices inside, each as far as can be from those before it (Gonzalez 1985), from where the factor that flattens everything is largest on, so that
    /// vertices in another order are the same ones.
    pub(crate) fn spread(&self, count: usize) -> Vec<VertexId> {
        let mesh = &self.operators.mesh;
        let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        let size = |v: VertexId| self.terms.flattening[v].abs();
        let Some(first) = inner.iter().copied().max_by(|&v, &w| size(v).total_cmp(&size(w))) else { return Vec::new() };
        let mut spread = vec![first];
        let Ok(mut distance) = self.distances().from_watched([first], self.watch()) else { return spread };
        while spread.len() < count {
            let farthest = inner.iter().copied().max_by(|&v, &w| distance[v].total_cmp(&distance[w]));
            let Some(farthest) = farthest.filter(|&v| distance[v] > 0.0) else { break };
            spread.push(farthest);
            if self.distances().lower_watched(&mut distance, [farthest], self.watch()).is_err() {
                break;
            }
        }
        spread
    }

    /// The vertices within such a distance of one, at most so many, the nearest first.
    pub(crate) fn around(&self, v: VertexId, radius: f32, most: usize) -> Vec<(VertexId, f32)> {
        vertices_around(&self.operators.mesh, self.unit_length(), v, radius, most)
    }

    /// Lengths of edges on the surface scaled to area 1.
    fn unit_length(&self) -> impl Fn(EdgeId) -> f32 {
        let metric = &self.operators.metric;
        let unit = self.terms.unit;
        move |e| (metric.length(e) * unit) as f32
    }

    /// E₀
    pub(crate) fn constant(&self) -> f64 {
        self.terms.constant
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
            if self.puts_columns_off(block.len()) {
                self.add_without_columns(block);
            } else {
                for (&v, h) in block.iter().zip(self.columns_of(self.green_of(block))) {
                    self.put(v, self.linear()[v], |pool| pool.iter().map(|&x| h[x]).collect());
                    self.column.push(OnceLock::from(rounded(&h)));
                }
            }
        }
    }

    /// Whether so many more vertices are added without their columns.
    fn puts_columns_off(&self, more: usize) -> bool {
        let count = self.pool.len() + more;
        let is_small = count <= MOST_GREEN && count * self.operators.mesh.vertex_count() <= MOST_GREEN_VALUES;
        self.puts_columns_off && is_small
    }

    fn add_without_columns(&mut self, new: &[VertexId]) {
        self.green.extend(self.green_of(new));
        let count = self.green.len();
        let products = gram_watched(&self.green, &self.operators.weight, self.watch());
        let products = products.unwrap_or_else(|_| vec![0.0; count * count]);
        for &v in new {
            let place = self.pool.len();
            let linear = self.operators.inner(&self.green[place], &self.terms.flattening);
            self.put(v, linear, |pool| products[place * count..][..pool.len()].to_vec());
            self.column.push(OnceLock::new());
        }
    }

    /// Adds a vertex with its b and its products with all of the pool, itself included.
    fn put(&mut self, v: VertexId, linear: f64, products: impl FnOnce(&[VertexId]) -> Vec<f64>) {
        self.place[v] = Some(self.pool.len() as u32);
        self.pool.push(v);
        self.own_linear.push(linear);
        self.products.push(products(&self.pool));
    }

    /// Centred Green's functions of some vertices; 0 where searches must end.
    fn green_of(&self, vertices: &[VertexId]) -> Vec<VertexData<f64>> {
        let solve = || -> Result<Vec<VertexData<f64>>, Interrupted> {
            let mut green = self.operators.green_watched(vertices, self.watch())?;
            self.operators.centre_all(&mut green, self.watch())?;
            Ok(green)
        };
        solve().unwrap_or_else(|_| vec![self.nothing(); vertices.len()])
    }

    /// `L⁺(w x)` of some centred functions x, h of Green's functions, in their place; 0 where searches must end.
    fn columns_of(&self, mut functions: Vec<VertexData<f64>>) -> Vec<VertexData<f64>> {
        let watch = self.watch();
        let count = functions.len();
        let mut solve = || -> Result<(), Interrupted> {
            functions.par_iter_mut().try_for_each(|x| -> Result<(), Interrupted> {
                watch.ask(0.0)?;
                x.iter_mut().zip(self.operators.weight.iter()).for_each(|(x, w)| *x *= w);
                Ok(())
            })?;
            self.operators.poisson().solve_many_in_place(&mut functions, watch)?;
            functions.par_iter_mut().for_each(|h| self.operators.subtract_spread_mean(h));
            Ok(())
        };
        match solve() {
            Ok(()) => functions,
            Err(Interrupted) => vec![self.nothing(); count],
        }
    }

    fn nothing(&self) -> VertexData<f64> {
        VertexData::constant(self.operators.mesh.vertex_count(), 0.0)
    }

    /// h of members of the pool, rounded; those that were put off are found together.
    pub(crate) fn columns(&self, members: &[VertexId]) -> Vec<&[f32]> {
        let is_unknown = |place: &usize| self.column[*place].get().is_none();
        let places: Vec<usize> = members.iter().map(|&v| self.place_of(v)).collect();
        let unknown: Vec<usize> = places.iter().copied().filter(is_unknown).collect();
        for block in unknown.chunks(BLOCK) {
            let green = block.iter().map(|&place| self.green[place].clone()).collect();
            for (&place, h) in block.iter().zip(self.columns_of(green)) {
                self.column[place].get_or_init(|| rounded(&h));
            }
        }
        places.iter().map(|&place| self.column[place].get().map_or(&[][..], Vec::as_slice)).collect()
    }

    /// h of a member of the pool, rounded.
    pub(crate) fn column(&self, v: VertexId) -> &[f32] {
        self.columns(&[v])[0]
    }

    /// `H_vx`, for members of the pool.
    pub(crate) fn product(&self, v: VertexId, x: VertexId) -> f64 {
        let (i, j) = (self.place_of(v), self.place_of(x));
        self.products[i.max(j)][i.min(j)]
    }

    /// `H_vx` for a member of the pool and the members at some places.
    pub(crate) fn products_of(&self, v: VertexId, places: &[usize]) -> impl Iterator<Item = f64> {
        let i = self.place_of(v);
        let own = &self.products[i];
        places.iter().map(move |&j| own.get(j).copied().unwrap_or_else(|| self.products[j][i]))
    }

    /// Where a member of the pool is in it.
    pub(crate) fn place_of(&self, v: VertexId) -> usize {
        self.place[v].expect("the vertex was added to the pool") as usize
    }

    /// The bounds of the curvature at a vertex where there are `count` cones in all.
    pub(crate) fn bounds(&self, v: VertexId, count: usize) -> [f64; 2] {
        bounds_at(self.operators, v, self.lowest(v), self.bounds_of(count))
    }

    /// The bounds of the curvature of any of so many cones.
    pub(crate) fn bounds_of(&self, count: usize) -> [f64; 2] {
        general_bounds(self.operators, count, self.largest_curvature)
    }

    /// The least curvature that any of so many cones can have.
    pub(crate) fn lowest_of(&self, count: usize) -> f64 {
        self.bounds_of(count)[0]
    }

    /// The least curvature that a vertex can have, from the number of its triangles.
    pub(crate) fn lowest(&self, v: VertexId) -> f64 {
        2.0 * PI - self.largest_corner * self.terms.triangles[v]
    }

    /// Works with another widest angle that triangles at a cone have on average; infinite where that is left aside.
    pub(crate) fn with_largest_corner<T>(&mut self, angle: f64, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.largest_corner, angle);
        let done = work(self);
        self.largest_corner = before;
        done
    }

    /// Works with another largest curvature of a cone.
    pub(crate) fn with_largest_curvature<T>(&mut self, curvature: f64, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.largest_curvature, curvature);
        let done = work(self);
        self.largest_curvature = before;
        done
    }

    /// What a shortfall counts beside energies, per radian: more than any difference of energies.
    pub(crate) fn price(&self) -> f64 {
        1.0 + 10.0 * self.terms.constant
    }

    /// Whether sets of cones should be improved no further: fits have taken too much, or searches must end.
    pub(crate) fn is_over(&self) -> bool {
        self.work.load(Ordering::Relaxed) > MOST_WORK || self.is_stopped()
    }

    /// Takes all the work that fits may take.
    #[cfg(test)]
    pub(crate) fn spend_all(&self) {
        self.work.store(MOST_WORK + 1, Ordering::Relaxed);
    }

    /// The best curvatures of cones that are in the pool. Where they cannot take the surface's curvature the bounds give
    /// way evenly, and the shortfall tells by how much.
    pub fn fit(&self, cones: &[VertexId]) -> ConeSet {
        self.fit_near(cones, None)
    }

    /// [`fit`](Self::fit), begun with the curvatures that the same cones had in another set, 0 for others, which takes less where
    /// these are many: the same to rounding.
    pub(crate) fn fit_from(&self, cones: &[VertexId], before: &ConeSet) -> ConeSet {
        let mut known: HashMap<VertexId, f64> =
            before.cones.iter().copied().zip(before.curvature.iter().copied()).collect();
        let guess: Vec<f64> = cones.iter().map(|v| known.remove(v).unwrap_or(0.0)).collect();
        self.fit_near(cones, Some(&guess))
    }

    fn fit_near(&self, cones: &[VertexId], guess: Option<&[f64]>) -> ConeSet {
        let n = cones.len();
        if self.is_stopped() {
            return self.unfitted(cones);
        }
        let linear: Vec<f64> = cones.iter().map(|&v| self.linear_of(v)).collect();
        let matrix: Vec<f64> = cones.iter().flat_map(|&v| cones.iter().map(move |&x| self.product(v, x))).collect();
        let mut bounds: Vec<[f64; 2]> = cones.iter().map(|&v| self.bounds(v, n)).collect();
        let total = self.total();
        let shortfall = self.relax(&mut bounds);
        let energy = Quadratic { constant: self.terms.constant, linear: &linear, matrix: &matrix };
        let minimum = |bounds: &[[f64; 2]]| {
            let (optimum, work) = minimise_from(&energy, bounds, total, guess)?;
            self.work.fetch_add(work, Ordering::Relaxed);
            Ok::<Optimum, ProgramError>(optimum)
        };
        match minimum(&bounds) {
            Ok(mut optimum) => {
                if let Some(sharper) = self.sharper(&bounds, &optimum)
                    && let Ok(sharpest) = minimum(&sharper)
                    && sharpest.energy < (1.0 - LEAST_SHARPENED) * optimum.energy
                {
                    (optimum, bounds) = (sharpest, sharper);
                }
                ConeSet {
                    cones: cones.to_vec(),
                    curvature: optimum.curvatures,
                    energy: optimum.energy.max(0.0),
                    shortfall,
                    held: optimum.held,
                    multiplier: optimum.multiplier,
                    bounds,
                }
            }
            // No cones on a surface that needs some.
            Err(_) => ConeSet {
                cones: cones.to_vec(),
                curvature: vec![0.0; n],
                energy: self.terms.constant,
                shortfall: total.map_or(0.0, f64::abs),
                held: vec![Held::Lower; n],
                multiplier: 0.0,
                bounds,
            },
        }
    }

    /// The bounds with the sharpest cones that are allowed, where these hold one at the largest curvature that comes without a gain.
    fn sharper(&self, bounds: &[[f64; 2]], optimum: &Optimum) -> Option<Vec<[f64; 2]>> {
        let is_held = |(&held, bound): (&Held, &[f64; 2])| held == Held::Upper && bound[1] == LARGEST_CURVATURE;
        let mut held = optimum.held.iter().zip(bounds);
        let may_sharpen = self.largest_curvature == LARGEST_CURVATURE && held.any(is_held);
        may_sharpen.then(|| bounds.iter().map(|&[low, high]| [low, high.max(SHARPEST_CURVATURE)]).collect())
    }

    /// What stands for a fit once searches must end.
    fn unfitted(&self, cones: &[VertexId]) -> ConeSet {
        ConeSet {
            cones: cones.to_vec(),
            curvature: vec![0.0; cones.len()],
            energy: self.terms.constant,
            shortfall: 0.0,
            held: vec![Held::Free; cones.len()],
            multiplier: 0.0,
            bounds: vec![[0.0; 2]; cones.len()],
        }
    }

    /// Widens the bounds evenly until they admit the sum; returns by how much in all.
    fn relax(&self, bounds: &mut [[f64; 2]]) -> f64 {
        let Some(total) = self.total() else { return 0.0 };
        let sum = |side: usize| bounds.iter().map(|bound| bound[side]).sum::<f64>();
        let [below, above] = [total - sum(0), total - sum(1)];
        let (side, missing) = if below < 0.0 { (0, below) } else { (1, above.max(0.0)) };
        if bounds.is_empty() || missing.abs() <= SUM_TOLERANCE {
            return 0.0;
        }
        let each = missing / bounds.len() as f64 + SUM_TOLERANCE * missing.signum();
        bounds.iter_mut().for_each(|bound| bound[side] += each);
        missing.abs()
    }

    /// The log scale factor that linear theory predicts for cones with given curvatures, centred. A back-substitution at most.
    pub fn log_scale(&self, cones: &[VertexId], curvature: &[f64]) -> VertexData<f64> {
        let green = |&v: &VertexId| self.green.get(self.place[v]? as usize);
        match cones.iter().map(green).collect::<Option<Vec<_>>>() {
            Some(green) => combine(&self.terms.flattening, green, curvature),
            None => self.operators.log_scale(cones, curvature),
        }
    }

    /// The optimal curvatures of cones that were fitted, with what they cause; none where they cannot take the surface's, or cause what is not finite.
    /// A back-substitution at most.
    pub(crate) fn curvatures(&self, set: &ConeSet) -> Option<ConeCurvatures> {
        let predicted = |curvature: &[f64]| self.log_scale(&set.cones, curvature);
        let is_sound = set.shortfall == 0.0 && set.energy.is_finite();
        is_sound.then(|| ConeCurvatures::known(self.operators, set.curvature.clone(), predicted))
    }
}

impl ConeSet {
    /// Cones with curvatures that were found otherwise.
    pub(crate) fn with_curvatures(cones: Vec<VertexId>, curvature: Vec<f64>, energy: f64) -> Self {
        let held = vec![Held::Free; cones.len()];
        let bounds = vec![[f64::NEG_INFINITY, f64::INFINITY]; cones.len()];
        Self { cones, curvature, energy, shortfall: 0.0, held, multiplier: 0.0, bounds }
    }

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::{CurvatureRule, cone_curvatures};
    use geom::{Id, Mesh, Metric, shapes};
    use proptest::prelude::*;

    /// A shape without a boundary, of higher genus, and with a boundary of one and of two loops.
    fn surfaces() -> Vec<(Mesh, Operators)> {
        let shapes = [shapes::hare(900), shapes::torus(2, 900), shapes::terrain(700, 3), shapes::cylinder(700)];
        let surface = |shape: shapes::Shape| {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            (mesh, operators)
        };
        shapes.map(surface).into()
    }

    /// Inner vertices, `count` different ones.
    fn scattered(mesh: &Mesh, count: usize, seed: usize) -> Vec<VertexId> {
        let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        (0..count).map(|k| inner[(k * inner.len() / count + seed) % inner.len()]).collect()
    }

    fn relative(a: f64, b: f64) -> f64 {
        (a - b).abs() / (1.0 + b.abs())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn the_predicted_norm_is_that_of_the_log_scale_factor(count in 1usize..12, seed in 0usize..700) {
            for (mesh, operators) in surfaces() {
                let cones = scattered(&mesh, count, seed);
                let mut model = EnergyModel::new(&operators, &mesh);
                model.add(&cones);
                let set = model.fit(&cones);
                let u = model.log_scale(&cones, &set.curvature);
                prop_assert!(relative(set.energy, operators.inner(&u, &u)) < 1e-10);
            }
        }

        #[test]
        fn curvatures_are_the_optimal_ones(count in 3usize..12, seed in 0usize..700) {
            for (mesh, operators) in surfaces() {
                let cones = scattered(&mesh, count, seed);
                let mut model = EnergyModel::new(&operators, &mesh);
                model.add(&cones);
                let set = model.fit(&cones);
                let Ok(optimal) = cone_curvatures(&operators, &mesh, &cones, CurvatureRule::Optimal, Watch::NONE) else {
                    prop_assert!(set.shortfall > 0.0);
                    continue;
                };
                let norm = operators.inner(&optimal.predicted, &optimal.predicted);
                prop_assert!(relative(set.energy, norm) < 1e-9);
                if let Some(total) = model.total() {
                    prop_assert!((set.curvature.iter().sum::<f64>() - total).abs() < 1e-11);
                }
            }
        }
    }

    #[test]
    fn products_are_those_of_green_s_functions() {
        for (mesh, operators) in surfaces() {
            let cones = scattered(&mesh, 5, 11);
            let mut model = EnergyModel::new(&operators, &mesh);
            cones.iter().for_each(|&v| model.add(&[v]));
            let mut green = operators.green(&cones);
            green.iter_mut().for_each(|g| operators.centre(g));
            for (&v, g) in cones.iter().zip(&green) {
                assert!(relative(model.linear()[v], operators.inner(g, model.flattening())) < 1e-11);
                for (&x, other) in cones.iter().zip(&green) {
                    let product = operators.inner(g, other);
                    assert!(relative(model.product(v, x), product) < 1e-11);
                    assert!(
                        (f64::from(model.column(v)[x.0 as usize]) - product).abs() < 1e-6 * product.abs().max(1e-3)
                    );
                }
            }
        }
    }

    #[test]
    fn the_gradient_is_what_all_columns_say() {
        for (mesh, operators) in surfaces() {
            let cones = scattered(&mesh, 9, 11);
            let mut model = EnergyModel::new(&operators, &mesh).putting_columns_off();
            model.add(&cones);
            assert!(model.terms.linear.get().is_none(), "b of the pool comes from Green's functions");
            let set = model.fit(&cones);
            let gradient = model.gradient(&set);
            let columns = model.columns(&cones);
            for v in mesh.vertices() {
                let products = columns.iter().zip(&set.curvature).map(|(h, q)| f64::from(h[v.index()]) * q);
                assert!(relative(gradient[v], model.linear()[v] + products.sum::<f64>()) < 1e-5);
            }
            for (&v, held) in cones.iter().zip(&set.held).filter(|(_, held)| **held == Held::Free) {
                assert!((gradient[v] + set.multiplier).abs() < 1e-9, "{held:?} at {v:?}");
            }
        }
    }

    #[test]
    fn columns_that_are_put_off_change_nothing() {
        for (mesh, operators) in surfaces() {
            let all = scattered(&mesh, MOST_GREEN + 6, 11);
            let mut at_once = EnergyModel::new(&operators, &mesh);
            let mut put_off = EnergyModel::new(&operators, &mesh).putting_columns_off();
            // The last block is more than columns are put off for.
            for some in [&all[..5], &all[5..MOST_GREEN - 3], &all[MOST_GREEN - 3..]] {
                at_once.add(some);
                put_off.add(some);
            }
            assert!(put_off.green.len() == MOST_GREEN - 3 && put_off.column[0].get().is_none());
            for (i, &v) in all.iter().enumerate() {
                all[..=i].iter().for_each(|&x| {
                    assert!(relative(put_off.product(v, x), at_once.product(v, x)) < 1e-11);
                });
                assert!(relative(put_off.linear_of(v), at_once.linear_of(v)) < 1e-11);
            }
            let some = [all[MOST_GREEN], all[3], all[20]];
            for (column, &v) in put_off.columns(&some).iter().zip(&some) {
                assert!(column.len() == mesh.vertex_count());
                assert!(column.iter().zip(at_once.column(v)).all(|(a, b)| (a - b).abs() < 1e-5 * (1.0 + b.abs())));
            }
            assert!(put_off.column[3].get().is_some() && put_off.column[4].get().is_none());
            for cones in [&all[..9], &all[MOST_GREEN - 9..]] {
                let [found, expected] = [&put_off, &at_once].map(|model| model.fit(cones));
                assert!(relative(found.energy, expected.energy) < 1e-10);
                let u = [&put_off, &at_once].map(|model| model.log_scale(cones, &expected.curvature));
                assert!(mesh.vertices().all(|v| (u[0][v] - u[1][v]).abs() < 1e-10));
            }
        }
    }

    #[test]
    fn what_cannot_take_the_curvature_says_by_how_much() {
        let (mesh, operators) = surfaces().swap_remove(0);
        let mut model = EnergyModel::new(&operators, &mesh);
        assert!((model.fit(&[]).shortfall - 4.0 * PI).abs() < 1e-9);
        let cones = scattered(&mesh, 2, 0);
        model.add(&cones);
        let pair = model.fit(&cones);
        assert!((pair.shortfall - 0.02 * PI).abs() < 1e-6, "two cones of at most 1.99π miss 4π by 0.02π");
    }

    #[test]
    fn a_vertex_is_solved_for_once() {
        let (mesh, operators) = surfaces().swap_remove(2);
        let mut model = EnergyModel::new(&operators, &mesh);
        let cones = scattered(&mesh, 20, 3);
        model.add(&[&cones[..], &cones[..]].concat());
        model.add(&cones);
        assert_eq!(model.pool(), cones);
    }
}
