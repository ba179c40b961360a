//! A surface made ready to be asked about cones: its intrinsic Delaunay triangulation, curvature, areas, and the one
//! factorization of its Laplacian.
//!
//! Everything that the project computes before it flattens is a back-solve on this factor. On a closed surface solutions
//! are known up to a constant. With a boundary they are 0 there, and each boundary loop adds one free constant: the
//! harmonic extension of its indicator function can be added to any log scale factor without changing the curvature
//! inside.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock, PoisonError, RwLock};

use geom::{
    HalfedgeId, Id, Interrupted, Mesh, MeshError, Metric, Poisson, PoissonError, SymmetricMatrix, VertexData, VertexId,
    Watch, angle_defects, delaunay_watched, laplacian,
};
use rayon::prelude::*;

use super::coarsened::{Coarsened, coarsened};
use crate::numerics::dot;

/// So many boundary loops at least get a constant of their own, the longest ones; the others have one in common. (At the value of the
/// longest loop 241 small holes of a scan were 0.4 below all around them.) Each costs a solve and a vector,
const FREE_LOOPS: usize = 16;
/// and more get one as long as all these vectors have at most so many values. With one for each of its 133 opened handles `cheese` comes with
/// 512 cones to an area distortion of 1.19, a quasi-conformal one of 1.27 and no fold-overs, with 16 to 1.49, 1.55 and 68.
const FREE_VALUES: usize = 1 << 21;

/// So many rows of vectors are gone through at a time: they stay in the fastest cache.
const ROWS: usize = 512;
/// So many log scale factors are centred at a time.
const CENTRED: usize = 8;

/// A factor of so many values is let go when it is done with: 32 MB. What is smaller comes from a heap that stays as large as it was.
const LEAST_LET_GO: usize = 1 << 22;

/// The number of the tied boundary loops that each vertex is on, if it is on any.
pub(crate) type TiedLoops = VertexData<Option<u32>>;

/// The vertices of each boundary loop, the longest first; those that share a constant are one.
type Rims = Vec<Vec<VertexId>>;

/// A connected surface with its operators; see the module's head. Building costs one factorization.
#[derive(Debug)]
pub struct Operators {
    /// The intrinsic Delaunay triangulation, on the input's vertices.
    pub(crate) mesh: Mesh,
    /// Its edge lengths.
    pub(crate) metric: Metric,
    /// The flips that led to it from the input's triangulation.
    pub(crate) flips: Vec<HalfedgeId>,
    /// The angle defect K of each vertex, in radians.
    pub(crate) curvature: VertexData<f64>,
    /// The lumped area of each vertex as a share of the whole: the weights sum to 1.
    pub(crate) weight: VertexData<f64>,
    /// See [`Operators::poisson`].
    factored: RwLock<Option<Arc<Poisson>>>,
    /// An orthonormal basis, for the inner product weighted by area, of the log scale factors that change no curvature
    /// inside: the constants, and with several boundary loops their harmonic extensions.
    free: Vec<VertexData<f64>>,
    bordered: bool,
    rims: Rims,
    /// The positions of the vertices, where they were given.
    points: Option<Vec<[f64; 3]>>,
    /// Boundary loops with the same number share their constant, as the two sides of a handle that was opened do.
    tied: Option<TiedLoops>,
    /// See [`Operators::flattening`].
    flattening: OnceLock<VertexData<f64>>,
    /// What a unit of curvature at every vertex causes, divided by their number; on a closed surface.
    even: OnceLock<VertexData<f64>>,
    /// On a coarse level, the share of the finer one's vertices that each vertex stands for: curvature that is spread evenly over
    /// these is spread so.
    pub(super) spread: Option<VertexData<f64>>,
    /// What a coarse level of so many vertices, or fewer, is made of, where one was asked for in advance.
    pub(super) ahead: Option<(usize, Coarsened)>,
}

impl Operators {
    /// Prepares a connected surface.
    ///
    /// # Errors
    /// If the Laplacian cannot be factored.
    pub fn new(mesh: &Mesh, metric: &Metric) -> Result<Self, PoissonError> {
        Self::prepared((mesh, metric), (None, None), None, Watch::NONE)
    }

    /// The same where the positions of the vertices are known, which on large surfaces makes the factorization faster; see
    /// [`Poisson::with_points`].
    ///
    /// # Errors
    /// If the Laplacian cannot be factored, or the watch has said stop.
    ///
    /// # Panics
    /// If there are fewer points than vertices.
    pub fn with_points(mesh: &Mesh, metric: &Metric, points: &[[f64; 3]], watch: Watch) -> Result<Self, PoissonError> {
        Self::prepared((mesh, metric), (Some(points), None), None, watch)
    }

    /// The same where boundary loops whose vertices have the same number share their constant; with what a coarse level of `ahead` vertices
    /// is made of, found while the Laplacian is factored.
    ///
    /// # Errors
    /// As [`with_points`](Self::with_points).
    pub(crate) fn with_tied_loops(
        (mesh, metric): (&Mesh, &Metric),
        points: &[[f64; 3]],
        tied: Option<&TiedLoops>,
        ahead: Option<usize>,
        watch: Watch,
    ) -> Result<Self, PoissonError> {
        Self::prepared((mesh, metric), (Some(points), tied.cloned()), ahead, watch)
    }

    fn prepared(
        (mesh, metric): (&Mesh, &Metric),
        (points, tied): (Option<&[[f64; 3]]>, Option<TiedLoops>),
        ahead: Option<usize>,
        watch: Watch,
    ) -> Result<Self, PoissonError> {
        let intrinsic = delaunay_watched(mesh, metric, watch.within(0.0, 0.3));
        if watch.stops_at(0.3) {
            return Err(Interrupted.into());
        }
        let metric = intrinsic.metric;
        let mesh = Mesh::from_triangulation(intrinsic.triangulation)
            .unwrap_or_else(|error: MeshError| unreachable!("flips keep a manifold one: {error}"));
        let (mut weight, curvature) = rayon::join(|| metric.vertex_areas(&mesh), || angle_defects(&mesh, &metric));
        let area: f64 = weight.iter().sum();
        weight.iter_mut().for_each(|w| *w /= area);
        let rims = ranked(tied_loops(&mesh, tied.as_ref()), most_loops(mesh.vertex_count()));
        Self::of_delaunay((mesh, metric), intrinsic.flips, [weight, curvature], (points, tied, rims), ahead, watch)
    }

    /// Whether this is a coarse level of a finer surface.
    pub(crate) fn is_coarse(&self) -> bool {
        self.spread.is_some()
    }

    /// Makes the mean zero over the vertices that curvature is spread over, where it is not so yet.
    pub(crate) fn subtract_spread_mean(&self, x: &mut VertexData<f64>) {
        if let Some(spread) = self.spread.as_ref().filter(|_| !self.bordered) {
            let mean: f64 = spread.iter().zip(x.iter()).map(|(s, x)| s * x).sum();
            x.iter_mut().for_each(|x| *x -= mean);
        }
    }

    /// The operators of a coarse level of a surface: an intrinsic Delaunay triangulation with the weights and curvatures of its
    /// vertices, and the share of the surface's vertices that each stands for; `vertex` says which of the `fine` ones they are.
    pub(super) fn of_coarse(
        surface: (Mesh, Metric),
        (fine, vertex): (&Self, &[VertexId]),
        data: [VertexData<f64>; 3],
        watch: Watch,
    ) -> Result<Self, PoissonError> {
        let tied: Option<TiedLoops> = fine.tied.as_ref().map(|tied| vertex.iter().map(|&v| tied[v]).collect());
        let rims = as_on(&fine.rims, vertex, tied_loops(&surface.0, tied.as_ref()));
        let points: Option<Vec<[f64; 3]>> =
            fine.points().map(|points| vertex.iter().map(|v| points[v.0 as usize]).collect());
        Self::of_level(surface, (points.as_deref(), tied, rims), data, watch)
    }

    /// The same of a level whose handles were opened, with the numbers of the loops, of which as many have constants of their own as on a surface
    /// of `fine` vertices.
    pub(super) fn of_opened_level(
        surface: (Mesh, Metric),
        (points, tied): (Option<&[[f64; 3]]>, TiedLoops),
        data: [VertexData<f64>; 3],
        fine: usize,
        watch: Watch,
    ) -> Result<Self, PoissonError> {
        let rims = ranked(tied_loops(&surface.0, Some(&tied)), most_loops(fine));
        Self::of_level(surface, (points, Some(tied), rims), data, watch)
    }

    /// The operators of a coarse level with its weights, shares of the finer one's vertices and curvatures.
    fn of_level(
        surface: (Mesh, Metric),
        carried: (Option<&[[f64; 3]]>, Option<TiedLoops>, Rims),
        [weight, spread, curvature]: [VertexData<f64>; 3],
        watch: Watch,
    ) -> Result<Self, PoissonError> {
        let operators = Self::of_delaunay(surface, Vec::new(), [weight, curvature], carried, None, watch)?;
        Ok(Self { spread: Some(spread), ..operators })
    }

    /// The operators of an intrinsic Delaunay triangulation with given weights and curvatures.
    fn of_delaunay(
        (mesh, metric): (Mesh, Metric),
        flips: Vec<HalfedgeId>,
        [weight, curvature]: [VertexData<f64>; 2],
        (points, tied, rims): (Option<&[[f64; 3]]>, Option<TiedLoops>, Rims),
        ahead: Option<usize>,
        watch: Watch,
    ) -> Result<Self, PoissonError> {
        if watch.stops_at(0.4) {
            return Err(Interrupted.into());
        }
        let unknown = watch.within(f64::NAN, f64::NAN);
        let coarsened = |count| coarsened((&mesh, &metric), (&weight, None, &curvature), count, unknown);
        let (poisson, ahead) = rayon::join(
            || Poisson::new_watched(laplacian(&mesh, &metric), &rims.concat(), points, watch.within(0.4, 0.95)),
            || ahead.map(|count| coarsened(count).map(|coarsened| (count, coarsened))).transpose(),
        );
        let (poisson, ahead) = (poisson?, ahead?);
        let bordered = !rims.is_empty();
        let mut operators = Self {
            mesh,
            metric,
            flips,
            curvature,
            weight,
            factored: RwLock::new(Some(Arc::new(poisson))),
            free: Vec::new(),
            bordered,
            rims: Vec::new(),
            points: points.map(<[_]>::to_vec),
            tied,
            flattening: OnceLock::new(),
            even: OnceLock::new(),
            spread: None,
            ahead,
        };
        operators.add_free(VertexData::constant(operators.mesh.vertex_count(), 1.0));
        for extension in operators.harmonic_extensions(rims.get(1..).unwrap_or_default(), watch.within(0.95, 1.0))? {
            operators.add_free(extension);
        }
        Ok(Self { rims, ..operators })
    }

    /// The intrinsic Delaunay triangulation, on the input's vertices.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The angle defect of each vertex, in radians.
    pub fn curvature(&self) -> &VertexData<f64> {
        &self.curvature
    }

    /// The lumped area of each vertex as a share of the whole.
    pub fn weight(&self) -> &VertexData<f64> {
        &self.weight
    }

    /// The cotangent Laplacian, made anew, since its factor alone is kept. O(F).
    pub fn laplacian(&self) -> SymmetricMatrix {
        laplacian(&self.mesh, &self.metric)
    }

    /// L factored, restricted to the inner vertices where there is a boundary.
    ///
    /// # Panics
    /// If it was let go, and memory does not suffice to factor it again.
    pub(crate) fn poisson(&self) -> Arc<Poisson> {
        self.factor_again(Watch::NONE).unwrap_or_else(|error| panic!("a matrix that was factored once: {error}"))
    }

    /// The same, watched where it has to be factored again.
    ///
    /// # Errors
    /// If memory does not suffice, or it is stopped.
    pub(crate) fn factor_again(&self, watch: Watch) -> Result<Arc<Poisson>, PoissonError> {
        if let Some(poisson) = &*self.factored.read().unwrap_or_else(PoisonError::into_inner) {
            return Ok(Arc::clone(poisson));
        }
        // Not while it is locked: a thread that waits for others may come upon work that asks for the same.
        let made = Arc::new(Poisson::new_watched(self.laplacian(), &self.rims.concat(), self.points(), watch)?);
        let mut factored = self.factored.write().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(factored.get_or_insert(made)))
    }

    /// Frees a large factor, which is most of the memory, where nobody is expected to ask for it. Who does waits until it is made again,
    /// the same to the bit.
    pub(crate) fn let_factor_go(&self) {
        self.let_go(LEAST_LET_GO);
    }

    fn let_go(&self, least: usize) {
        let mut factored = self.factored.write().unwrap_or_else(PoisonError::into_inner);
        *factored = factored.take().filter(|poisson| poisson.factor_len() < least);
    }

    /// Whether the surface has a boundary.
    pub fn is_bordered(&self) -> bool {
        self.bordered
    }

    /// 2πχ: what the curvatures of a closed surface's cones sum to.
    pub fn total_curvature(&self) -> f64 {
        2.0 * std::f64::consts::PI * self.mesh.euler_characteristic() as f64
    }

    /// The product ⟨x, y⟩ weighted by area.
    pub fn inner(&self, x: &[f64], y: &[f64]) -> f64 {
        self.weight.iter().zip(x).zip(y).map(|((w, x), y)| w * x * y).sum()
    }

    /// Adds to a log scale factor the curvature-free one that makes its L2 norm least: on a closed surface, subtracts the
    /// mean weighted by area; with a boundary each loop gets its best constant.
    pub fn centre(&self, x: &mut VertexData<f64>) {
        self.centre_block(std::slice::from_mut(x));
    }

    /// The same for many of them: a basis of sixteen vectors is read once for several.
    ///
    /// # Errors
    /// If the watch has said stop.
    pub(crate) fn centre_all(&self, columns: &mut [VertexData<f64>], watch: Watch) -> Result<(), Interrupted> {
        columns.par_chunks_mut(CENTRED).try_for_each(|block| {
            watch.ask(0.0)?;
            self.centre_block(block);
            Ok(())
        })
    }

    fn centre_block(&self, columns: &mut [VertexData<f64>]) {
        let free: Vec<&[f64]> = self.free.iter().map(|basis| &**basis).collect();
        let mut columns: Vec<&mut [f64]> = columns.iter_mut().map(|x| &mut **x).collect();
        let mut parts = vec![vec![0.0; free.len()]; columns.len()];
        for (first, weight) in (0..).step_by(ROWS).zip(self.weight.chunks(ROWS)) {
            let rows = first..first + weight.len();
            for (x, parts) in columns.iter().map(|x| &x[rows.clone()]).zip(&mut parts) {
                let mut weighted = [0.0; ROWS];
                weighted.iter_mut().zip(weight).zip(x).for_each(|((product, w), x)| *product = w * x);
                for (part, basis) in parts.iter_mut().zip(&free) {
                    *part += dot(&basis[rows.clone()], &weighted[..rows.len()]);
                }
            }
        }
        let (fours, rest) = free.as_chunks::<4>();
        for (first, weight) in (0..).step_by(ROWS).zip(self.weight.chunks(ROWS)) {
            let rows = first..first + weight.len();
            for (x, parts) in columns.iter_mut().map(|x| &mut x[rows.clone()]).zip(&parts) {
                let (parts_of_fours, parts_of_rest) = parts.as_chunks::<4>();
                for (basis, [p, q, r, s]) in fours.iter().zip(parts_of_fours) {
                    let [a, b, c, d] = basis.map(|basis| &basis[rows.clone()]);
                    for ((((x, a), b), c), d) in x.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                        *x = *x - p * a - q * b - r * c - s * d;
                    }
                }
                for (basis, part) in rest.iter().zip(parts_of_rest) {
                    x.iter_mut().zip(&basis[rows.clone()]).for_each(|(x, b)| *x -= part * b);
                }
            }
        }
    }

    /// Makes the mean, weighted by area, zero.
    pub fn subtract_mean(&self, x: &mut VertexData<f64>) {
        let mean: f64 = self.weight.iter().zip(x.iter()).map(|(w, x)| w * x).sum();
        x.iter_mut().for_each(|x| *x -= mean);
    }

    /// The log scale factor that takes away all curvature, up to a constant: on a closed surface all but the mean, 2πχ/n at
    /// each of n vertices. One solve, when it is first asked for.
    pub(crate) fn flattening(&self) -> &VertexData<f64> {
        known_or(&self.flattening, || self.poisson().solve(&self.flattening_source()))
    }

    /// The same, watched.
    pub(crate) fn flattening_watched(&self, watch: Watch) -> Result<&VertexData<f64>, Interrupted> {
        if self.flattening.get().is_none() {
            let solved = self.poisson().solve_watched(&self.flattening_source(), watch)?;
            return Ok(self.flattening.get_or_init(|| solved));
        }
        Ok(self.flattening())
    }

    fn flattening_source(&self) -> VertexData<f64> {
        let total = if self.bordered { 0.0 } else { self.total_curvature() };
        if let Some(spread) = &self.spread {
            return spread.iter().zip(self.curvature.iter()).map(|(share, k)| total * share - k).collect();
        }
        let mean = total / self.mesh.vertex_count() as f64;
        self.curvature.iter().map(|k| mean - k).collect()
    }

    /// The log scale factors `g_v` that a unit of curvature at each given vertex causes (Green's functions): on a closed
    /// surface taken away evenly from all vertices, with mean 0 over these. A back-substitution each.
    pub(crate) fn green_watched(
        &self,
        vertices: &[VertexId],
        watch: Watch,
    ) -> Result<Vec<VertexData<f64>>, Interrupted> {
        let sources: Vec<Vec<(VertexId, f64)>> = vertices.iter().map(|&v| vec![(v, 1.0)]).collect();
        let mut green = self.poisson().solve_sparse_watched(&sources, watch)?;
        if !self.bordered {
            let even = self.even_watched(watch.within(1.0, 1.0))?;
            green.par_iter_mut().try_for_each(|g| -> Result<(), Interrupted> {
                watch.ask(1.0)?;
                let mean = g.iter().sum::<f64>() / g.len() as f64;
                g.iter_mut().zip(even.iter()).for_each(|(g, even)| *g -= even + mean);
                Ok(())
            })?;
        }
        Ok(green)
    }

    /// The same unwatched.
    #[cfg(test)]
    pub(crate) fn green(&self, vertices: &[VertexId]) -> Vec<VertexData<f64>> {
        self.green_watched(vertices, Watch::NONE).unwrap_or_default()
    }

    /// The log scale factor, with mean 0 over the vertices, of a closed surface that a unit of curvature causes where it is
    /// spread evenly over the vertices and taken from the grounded one.
    fn even(&self) -> &VertexData<f64> {
        known_or(&self.even, || self.poisson().solve(&self.even_source()))
    }

    /// The same, watched.
    pub(crate) fn even_watched(&self, watch: Watch) -> Result<&VertexData<f64>, Interrupted> {
        if self.even.get().is_none() {
            let solved = self.poisson().solve_watched(&self.even_source(), watch)?;
            return Ok(self.even.get_or_init(|| solved));
        }
        Ok(self.even())
    }

    fn even_source(&self) -> VertexData<f64> {
        let n = self.mesh.vertex_count();
        let mut source = self.spread.clone().unwrap_or_else(|| VertexData::constant(n, 1.0 / n as f64));
        if let Some(grounded) = self.poisson().grounded() {
            source[grounded] -= 1.0;
        }
        source
    }

    /// A log scale factor times the weights: with it the product ⟨x, y⟩ is a plain one.
    pub(crate) fn weighted(&self, x: &[f64]) -> VertexData<f64> {
        self.weight.iter().zip(x).map(|(w, x)| w * x).collect()
    }

    /// The log scale factor that linear theory predicts for cones with given curvatures, centred. A back-substitution.
    pub fn log_scale(&self, cones: &[VertexId], curvature: &[f64]) -> VertexData<f64> {
        let mut u = self.uncentred_log_scale(cones, curvature);
        self.centre(&mut u);
        u
    }

    /// The same as it comes from the solve: 0 on a boundary, on a closed surface up to a constant. What the curvatures lack
    /// there is spread evenly.
    pub(crate) fn uncentred_log_scale(&self, cones: &[VertexId], curvature: &[f64]) -> VertexData<f64> {
        let source = cones.iter().copied().zip(curvature.iter().copied()).collect();
        let mut u = self.poisson().solve_sparse(&[source]).remove(0);
        u.iter_mut().zip(self.flattening().iter()).for_each(|(u, p)| *u += p);
        if !self.bordered {
            let sum: f64 = curvature.iter().sum();
            u.iter_mut().zip(self.even().iter()).for_each(|(u, even)| *u -= sum * even);
        }
        u
    }

    /// The positions of the vertices, where they were given.
    pub(super) fn points(&self) -> Option<&[[f64; 3]]> {
        self.points.as_deref()
    }

    /// Factors the Laplacian anew with more vertices pinned to 0 than the boundary, from its ordering on.
    pub(crate) fn refactored(&self, pinned: &[VertexId], watch: Watch) -> Result<Poisson, PoissonError> {
        let boundary = self.mesh.vertices().filter(|&v| self.mesh.is_boundary_vertex(v));
        let fixed: Vec<VertexId> = boundary.chain(pinned.iter().copied()).collect();
        Poisson::new_watched(self.laplacian(), &fixed, self.points(), watch)
    }

    /// For each of some boundary loops, with those tied to it, the harmonic function that is 1 there and 0 on the others.
    fn harmonic_extensions(&self, rims: &[Vec<VertexId>], watch: Watch) -> Result<Vec<VertexData<f64>>, Interrupted> {
        if rims.is_empty() {
            return Ok(Vec::new());
        }
        let laplacian = self.laplacian();
        let beside = |&v: &VertexId| {
            let mut beside: Vec<VertexId> = self.mesh.neighbors(v).to_vec();
            beside.sort_unstable();
            beside.dedup();
            let laplacian = &laplacian;
            beside.into_iter().map(move |w| (w, -laplacian.get(v.index(), w.index())))
        };
        // What this is at vertices of loops does not count.
        let sources: Vec<Vec<(VertexId, f64)>> =
            rims.iter().map(|around| around.iter().flat_map(beside).collect()).collect();
        let mut extensions = self.poisson().solve_sparse_watched(&sources, watch)?;
        for (extension, around) in extensions.iter_mut().zip(rims) {
            around.iter().for_each(|&v| extension[v] = 1.0);
        }
        Ok(extensions)
    }

    fn add_free(&mut self, mut x: VertexData<f64>) {
        // Twice is enough (Kahan, in Parlett 1980): the second pass removes what rounding left.
        self.centre(&mut x);
        self.centre(&mut x);
        let norm = self.inner(&x, &x).sqrt();
        if norm > 1e-8 {
            x.iter_mut().for_each(|x| *x /= norm);
            self.free.push(x);
        }
    }
}

/// So many boundary loops of a surface of so many vertices have a constant of their own.
fn most_loops(vertices: usize) -> usize {
    FREE_LOOPS.max(FREE_VALUES / vertices.max(1))
}

/// Boundary loops by their lengths, the longest first; all but so many are one.
fn ranked(mut loops: Vec<Vec<VertexId>>, most: usize) -> Rims {
    loops.sort_by_key(|around| std::cmp::Reverse(around.len()));
    if loops.len() > most {
        let others = loops.split_off(most - 1).concat();
        loops.push(others);
    }
    loops
}

/// The boundary loops of a coarse level in the order of the fine ones, of which `vertex` says what is left, and together where these are.
fn as_on(fine: &[Vec<VertexId>], vertex: &[VertexId], loops: Vec<Vec<VertexId>>) -> Rims {
    let mut place = HashMap::new();
    for (k, around) in fine.iter().enumerate() {
        around.iter().for_each(|&v| _ = place.insert(v, k));
    }
    let mut rims = vec![Vec::new(); fine.len()];
    for v in loops.into_iter().flatten() {
        let k =
            place.get(&vertex[v.index()]).copied().expect("a boundary vertex of a coarse level is one of the fine one");
        rims[k].push(v);
    }
    rims.retain(|around| !around.is_empty());
    rims
}

/// The vertices of each boundary loop; loops that are tied are one.
fn tied_loops(mesh: &Mesh, tied: Option<&TiedLoops>) -> Vec<Vec<VertexId>> {
    let mut loops: Vec<Vec<VertexId>> = Vec::new();
    let mut of_number = HashMap::new();
    for around in mesh.boundary_loops() {
        let vertices = around.iter().map(|&h| mesh.tail(h));
        match tied.and_then(|tied| tied[mesh.tail(around[0])]) {
            Some(number) => {
                let place = *of_number.entry(number).or_insert(loops.len());
                if place == loops.len() {
                    loops.push(Vec::new());
                }
                loops[place].extend(vertices);
            }
            None => loops.push(vertices.collect()),
        }
    }
    loops
}

/// What is found once, by whoever asks first; not while others are kept waiting, since a thread that waits for others may come upon work that asks
/// for the same.
fn known_or<T>(known: &OnceLock<T>, find: impl FnOnce() -> T) -> &T {
    if let Some(known) = known.get() {
        return known;
    }
    let found = find();
    known.get_or_init(|| found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::shapes::{self, Shape};

    fn operators(shape: &Shape) -> Operators {
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        Operators::new(&mesh, &metric).unwrap()
    }

    #[test]
    fn free_log_scale_factors_change_no_curvature_inside() {
        let operators = operators(&shapes::cylinder(400));
        assert_eq!(operators.free.len(), 2, "a constant for each of the two loops");
        for basis in &operators.free {
            for (v, change) in operators.laplacian().multiply(basis).into_iter().enumerate() {
                assert!(operators.mesh.is_boundary_vertex(VertexId(v as u32)) || change.abs() < 1e-9);
            }
        }
    }

    /// A surface with many holes.
    fn pierced() -> Operators {
        let whole = shapes::hare(2500);
        let is_out = |t: &[u32; 3]| t.iter().any(|v| v % 60 == 30);
        let triangles: Vec<[u32; 3]> = whole.triangles.iter().copied().filter(|t| !is_out(t)).collect();
        let mut number = vec![u32::MAX; whole.points.len()];
        let mut points = Vec::new();
        for &v in triangles.iter().flatten() {
            if number[v as usize] == u32::MAX {
                number[v as usize] = points.len() as u32;
                points.push(whole.points[v as usize]);
            }
        }
        let triangles = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
        operators(&Shape { points, triangles })
    }

    #[test]
    fn a_coarse_level_has_the_same_loops_in_the_same_order() {
        let fine = pierced();
        assert!(fine.rims.len() > FREE_LOOPS, "all have a constant on a small mesh");
        let (coarse, vertex) = super::super::coarse_level(&fine, 900, Watch::NONE).unwrap();
        assert!(coarse.mesh.vertex_count() < fine.mesh.vertex_count());
        assert_eq!((coarse.rims.len(), coarse.free.len()), (fine.rims.len(), fine.free.len()));
        for (here, there) in coarse.rims.iter().zip(&fine.rims) {
            assert!(!here.is_empty() && here.iter().all(|v| there.contains(&vertex[v.index()])));
        }
    }

    #[test]
    fn a_coarse_level_is_the_same_whatever_was_found_ahead() {
        let shape = shapes::hare(2500);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let level = |ahead| {
            let fine = Operators::with_tied_loops((&mesh, &metric), &shape.points, None, ahead, Watch::NONE).unwrap();
            super::super::coarse_level(&fine, 400, Watch::NONE).unwrap()
        };
        let (none, vertex) = level(None);
        for ahead in [300, 400, 1100] {
            let (found, of_found) = level(Some(ahead));
            assert_eq!((found.mesh.triangulation(), &found.metric), (none.mesh.triangulation(), &none.metric));
            assert_eq!(
                (found.weight, found.curvature, found.spread),
                (none.weight.clone(), none.curvature.clone(), none.spread.clone())
            );
            assert_eq!(of_found, vertex);
        }
    }

    #[test]
    fn all_but_the_longest_loops_share_a_constant() {
        let loops = |sizes: &[u32]| sizes.iter().map(|&n| (0..n).map(|k| VertexId(100 * n + k)).collect()).collect();
        let lengths = |rims: Vec<Vec<VertexId>>| rims.iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(lengths(ranked(loops(&[3, 9, 5, 4]), 4)), [9, 5, 4, 3]);
        assert_eq!(lengths(ranked(loops(&[3, 9, 5, 4, 6]), 3)), [9, 6, 12]);
    }

    #[test]
    fn centring_is_a_projection_that_shortens() {
        let operators = operators(&shapes::cylinder(400));
        let mut x: VertexData<f64> = operators.mesh.vertices().map(|v| f64::from(v.0 * 7 % 13)).collect();
        let before = operators.inner(&x, &x);
        operators.centre(&mut x);
        let once = x.clone();
        operators.centre(&mut x);
        assert!(operators.inner(&once, &once) < before);
        assert!(x.iter().zip(once.iter()).all(|(x, once)| (x - once).abs() < 1e-12));
    }

    #[test]
    fn many_are_centred_as_one_is_to_the_bit() {
        let free = |operators: &Operators| operators.free.len();
        let surfaces = [shapes::hare(2500), shapes::cylinder(1500)].map(|shape| operators(&shape));
        let pierced = pierced();
        assert!(free(&surfaces[0]) == 1 && free(&surfaces[1]) == 2 && free(&pierced) > 4);
        for operators in surfaces.iter().chain([&pierced]) {
            let column = |k: u32| operators.mesh.vertices().map(|v| f64::from(v.0 * (7 + k) % 13)).collect();
            let mut together: Vec<VertexData<f64>> = (0..2 * CENTRED as u32 + 3).map(column).collect();
            let mut alone = together.clone();
            operators.centre_all(&mut together, Watch::NONE).unwrap();
            alone.iter_mut().for_each(|x| operators.centre(x));
            assert_eq!(together, alone);
            for x in &alone {
                assert!(operators.free.iter().all(|basis| operators.inner(x, basis).abs() < 1e-10));
            }
        }
    }

    #[test]
    fn a_factor_that_was_let_go_is_made_again_the_same_to_the_bit() {
        for shape in [shapes::hare(900), shapes::cylinder(400)] {
            let operators = operators(&shape);
            let source = operators.flattening_source();
            let before = operators.poisson().solve(&source);
            operators.let_go(operators.poisson().factor_len() + 1);
            assert!(operators.factored.read().unwrap().is_some(), "a small one stays");
            operators.let_go(0);
            assert!(operators.factored.read().unwrap().is_none());
            let stop = |_: f64| std::ops::ControlFlow::Break(());
            assert!(operators.factor_again(Watch::new(&stop)).is_err());
            assert_eq!(operators.poisson().solve(&source), before);
        }
    }

    #[test]
    fn a_green_function_has_unit_curvature_at_its_vertex() {
        for shape in [shapes::sphere(300), shapes::disk(300)] {
            let operators = operators(&shape);
            let v = operators.mesh.vertices().find(|&v| !operators.mesh.is_boundary_vertex(v)).unwrap();
            let green = operators.green(&[v]).remove(0);
            let elsewhere = if operators.is_bordered() { 0.0 } else { -1.0 / operators.mesh.vertex_count() as f64 };
            for (i, curvature) in operators.laplacian().multiply(&green).into_iter().enumerate() {
                let w = VertexId(i as u32);
                let expected = elsewhere + f64::from(u8::from(w == v));
                assert!(operators.mesh.is_boundary_vertex(w) || (curvature - expected).abs() < 1e-10);
            }
        }
    }
}
