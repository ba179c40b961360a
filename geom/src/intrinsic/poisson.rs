//! The Poisson equation L x = b on a mesh: one factorization, many right-hand sides.
//!
//! Without fixed vertices L is singular, its kernel the constants: one vertex is grounded, the right-hand side must sum
//! to zero (as Gauss–Bonnet makes curvatures do), and a solution is known up to a constant. With fixed vertices (a
//! boundary, pinned cones) L is restricted to the others and solutions are 0 at the fixed ones.

use std::fmt;

use petgraph::unionfind::UnionFind;
use thiserror::Error;

use crate::linalg::{Cholesky, CholeskyError, SymmetricMatrix};
use crate::mesh::{Id, VertexData, VertexId};
use crate::parallel::try_each;
use crate::watch::{Interrupted, Watch, unwatched};

/// From so many vertices on it is worth it to dissect. (Approximate minimum degree takes half as long below, and its factor has
/// a quarter more entries: fandisk, 28,910 vertices, 15 ms for 27, 1.38 M entries for 1.10 M.)
const DISSECTED: usize = 35_000;

/// Why a Laplacian is not factored.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum PoissonError {
    /// A pivot is not positive: degenerate triangles, or a surface in several pieces.
    #[error("the Laplacian is not positive definite; the mesh has degenerate triangles or several components")]
    NotPositiveDefinite,
    /// The factor does not fit into memory.
    #[error("there is not enough memory to factor the Laplacian of {0} vertices")]
    OutOfMemory(usize),
    /// Another Laplacian is not of the same surface.
    #[error("the other Laplacian is of {found} vertices, but the first of {vertices}")]
    Size {
        /// How many vertices the other one has.
        found: usize,
        /// How many the first has.
        vertices: usize,
    },
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<CholeskyError> for PoissonError {
    fn from(error: CholeskyError) -> Self {
        match error {
            CholeskyError::NotPositiveDefinite => Self::NotPositiveDefinite,
            CholeskyError::OutOfMemory(rows) => Self::OutOfMemory(rows),
            CholeskyError::Interrupted(interrupted) => Self::Interrupted(interrupted),
        }
    }
}

/// A factored Laplacian. Building costs as much as ten to twenty solves.
///
/// ```
/// # use geom::{Mesh, Metric, Poisson, VertexId, laplacian};
/// let tetrahedron = Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])?;
/// let metric = Metric::new(vec![1.0; 6].into());
/// let poisson = Poisson::new(&laplacian(&tetrahedron, &metric), &[])?;
/// let x = poisson.solve(&[1.0, -1.0, 0.0, 0.0]);
/// assert!((x[VertexId(0)] + x[VertexId(1)]).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Poisson {
    cholesky: Cholesky,
    /// The vertex of each unknown.
    unknown: Vec<VertexId>,
    vertex_count: usize,
    /// No vertex is fixed, so right-hand sides have to sum to zero.
    closed: bool,
}

/// Not its numbers, which are millions.
impl fmt::Debug for Poisson {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { vertex_count, closed, .. } = self;
        f.debug_struct("Poisson").field("vertex_count", vertex_count).field("closed", closed).finish_non_exhaustive()
    }
}

impl Poisson {
    /// Factors the Laplacian of a connected surface, with x = 0 at the fixed vertices (in any order, repeats allowed). Of several pieces each needs
    /// a fixed vertex.
    ///
    /// # Errors
    /// If the matrix is not positive definite off the kernel, as where a piece has no fixed vertex, or memory does not suffice.
    ///
    /// # Panics
    /// If a fixed vertex is none of the surface's.
    pub fn new(laplacian: &SymmetricMatrix, fixed: &[VertexId]) -> Result<Self, PoissonError> {
        check_pieces(laplacian, fixed)?;
        Self::new_watched(laplacian.clone(), fixed, None, Watch::NONE)
    }

    /// The same where the positions of the vertices are known: they tell an order of elimination that is found
    /// faster on large surfaces, mostly with a smaller factor. The solutions do not depend on them but for rounding.
    ///
    /// # Errors
    /// As [`Poisson::new`].
    ///
    /// # Panics
    /// If there are fewer points than vertices.
    pub fn with_points(
        laplacian: &SymmetricMatrix,
        fixed: &[VertexId],
        points: &[[f64; 3]],
    ) -> Result<Self, PoissonError> {
        check_pieces(laplacian, fixed)?;
        Self::new_watched(laplacian.clone(), fixed, Some(points), Watch::NONE)
    }

    /// [`Poisson::with_points`] where there are points, else [`Poisson::new`]; watched, and without a copy of the Laplacian. Whether each piece of
    /// the surface has a fixed vertex is not looked up: a pivot that should be 0 may be rounded to more.
    ///
    /// # Errors
    /// As [`Poisson::new`], and if it is stopped.
    ///
    /// # Panics
    /// If there are fewer points than vertices.
    pub fn new_watched(
        laplacian: SymmetricMatrix,
        fixed: &[VertexId],
        points: Option<&[[f64; 3]]>,
        watch: Watch,
    ) -> Result<Self, PoissonError> {
        let vertex_count = laplacian.dimension();
        let mut known = VertexData::constant(vertex_count, false);
        for &v in fixed {
            known[v] = true;
        }
        if fixed.is_empty() && vertex_count > 0 {
            known[VertexId::new(vertex_count - 1)] = true;
        }
        let unknown: Vec<VertexId> = known.iter_ids().filter(|(_, known)| !**known).map(|(v, _)| v).collect();
        let points = points.filter(|points| points.len() >= DISSECTED);
        let points: Option<Vec<[f64; 3]>> = points.map(|points| unknown.iter().map(|v| points[v.index()]).collect());
        watch.ask(0.0)?;
        let cholesky = Cholesky::of(restrict(laplacian, &unknown), points.as_deref(), watch)?;
        Ok(Self { cholesky, unknown, vertex_count, closed: fixed.is_empty() })
    }

    /// Factors a matrix that is positive definite as it is, such as M + tL, for [`solve`](Self::solve) alone; in the order of
    /// elimination that [`Poisson::new_watched`] takes, watched.
    ///
    /// # Errors
    /// If it is not positive definite, memory does not suffice, or it is stopped.
    ///
    /// # Panics
    /// If there are fewer points than vertices.
    pub fn definite(matrix: &SymmetricMatrix, points: Option<&[[f64; 3]]>, watch: Watch) -> Result<Self, PoissonError> {
        let vertex_count = matrix.dimension();
        let unknown: Vec<VertexId> = (0..vertex_count).map(VertexId::new).collect();
        let points = points.filter(|points| points.len() >= DISSECTED).map(|points| &points[..vertex_count]);
        let cholesky = Cholesky::new_watched(matrix, points, watch)?;
        Ok(Self { cholesky, unknown, vertex_count, closed: false })
    }

    /// Factors another Laplacian of the same surface, with the same vertices fixed, in the same order of elimination.
    ///
    /// # Errors
    /// As [`Poisson::new`], and if it is of another number of vertices.
    pub fn another(&self, laplacian: &SymmetricMatrix) -> Result<Self, PoissonError> {
        self.another_watched(laplacian.clone(), Watch::NONE)
    }

    /// [`Poisson::another`], watched, and without a copy of the Laplacian.
    ///
    /// # Errors
    /// As [`Poisson::another`], and if it is stopped.
    pub fn another_watched(&self, laplacian: SymmetricMatrix, watch: Watch) -> Result<Self, PoissonError> {
        self.check_size(&laplacian)?;
        let cholesky = self.cholesky.another(restrict(laplacian, &self.unknown), watch)?;
        Ok(Self { cholesky, unknown: self.unknown.clone(), ..*self })
    }

    /// Factors another Laplacian of the same surface in place of this one, with the same vertices fixed: what can be kept is,
    /// and there are never two factors.
    ///
    /// # Errors
    /// As [`Poisson::another`].
    pub fn refactor(self, laplacian: &SymmetricMatrix) -> Result<Self, PoissonError> {
        self.refactor_watched(laplacian.clone(), Watch::NONE)
    }

    /// [`Poisson::refactor`], watched, and without a copy of the Laplacian.
    ///
    /// # Errors
    /// As [`Poisson::another`], and if it is stopped.
    pub fn refactor_watched(self, laplacian: SymmetricMatrix, watch: Watch) -> Result<Self, PoissonError> {
        self.check_size(&laplacian)?;
        let cholesky = self.cholesky.refactor(restrict(laplacian, &self.unknown), watch)?;
        Ok(Self { cholesky, ..self })
    }

    /// Whether another Laplacian is of as many vertices.
    fn check_size(&self, other: &SymmetricMatrix) -> Result<(), PoissonError> {
        let (found, vertices) = (other.dimension(), self.vertex_count);
        if found == vertices { Ok(()) } else { Err(PoissonError::Size { found, vertices }) }
    }

    /// Solves L x = b with x = 0 at the fixed vertices. Where none is fixed, with or without a boundary, b must sum to zero (what it sums to is put
    /// at the last vertex), and x is shifted to mean zero over the vertices. One step of refinement is added where the residual asks for it.
    ///
    /// # Panics
    /// If `b` is not as long as there are vertices; with debug assertions, if it does not sum to zero where it has to.
    pub fn solve(&self, b: &[f64]) -> VertexData<f64> {
        unwatched(self.solve_watched(b, Watch::NONE))
    }

    /// [`Poisson::solve`], watched.
    ///
    /// # Errors
    /// If it is stopped.
    ///
    /// # Panics
    /// If `b` is not as long as there are vertices.
    pub fn solve_watched(&self, b: &[f64], watch: Watch) -> Result<VertexData<f64>, Interrupted> {
        let mut x = self.scatter(&self.cholesky.solve_watched(&self.gather(b), watch)?);
        self.shift(&mut x);
        Ok(x)
    }

    /// Solves for another Laplacian of the same surface, with the same vertices fixed, by conjugate gradients that this factor preconditions:
    /// until no entry of the residual is larger than `tolerance`, or as long as factoring anew would take. Fast where the two
    /// differ much at few vertices alone. `None` where they differ too much.
    ///
    /// # Errors
    /// If it is stopped.
    ///
    /// # Panics
    /// If the other Laplacian is of another number of vertices, or `b` is not as long as there are vertices.
    pub fn solve_perturbed(
        &self,
        laplacian: SymmetricMatrix,
        b: &[f64],
        tolerance: f64,
        watch: Watch,
    ) -> Result<Option<VertexData<f64>>, Interrupted> {
        assert_eq!(laplacian.dimension(), self.vertex_count, "the other Laplacian must be of the same surface");
        let matrix = restrict(laplacian, &self.unknown);
        watch.ask(0.0)?;
        let x = self.cholesky.solve_perturbed(&matrix, &self.gather(b), tolerance, watch)?;
        Ok(x.map(|x| {
            let mut x = self.scatter(&x);
            self.shift(&mut x);
            x
        }))
    }

    /// Solves for several right-hand sides at once, which is 4–5 times cheaper for each than one by one; without
    /// refinement.
    ///
    /// # Panics
    /// If a right-hand side is not as long as there are vertices.
    pub fn solve_many(&self, right_hand_sides: &[VertexData<f64>]) -> Vec<VertexData<f64>> {
        unwatched(self.solve_many_watched(right_hand_sides, Watch::NONE))
    }

    /// [`Poisson::solve_many`], watched.
    ///
    /// # Errors
    /// If it is stopped.
    ///
    /// # Panics
    /// If a right-hand side is not as long as there are vertices.
    pub fn solve_many_watched(
        &self,
        right_hand_sides: &[VertexData<f64>],
        watch: Watch,
    ) -> Result<Vec<VertexData<f64>>, Interrupted> {
        let mut x = right_hand_sides.to_vec();
        self.solve_many_in_place(&mut x, watch)?;
        Ok(x)
    }

    /// [`Poisson::solve_many`] in place of the right-hand sides, watched: half of the memory.
    ///
    /// # Errors
    /// If it is stopped; what is left is neither right-hand sides nor solutions then.
    ///
    /// # Panics
    /// If a right-hand side is not as long as there are vertices.
    pub fn solve_many_in_place(&self, columns: &mut [VertexData<f64>], watch: Watch) -> Result<(), Interrupted> {
        columns.iter().for_each(|b| self.check(b));
        let mut all: Vec<&mut [f64]> = columns.iter_mut().map(|column| &mut **column).collect();
        self.cholesky.solve_columns(&mut all, &|row| self.unknown[row].index(), watch.within(0.0, 0.9))?;
        let (watch, count) = (watch.within(0.9, 1.0), columns.len());
        watch.shared(|watch| {
            try_each(0, columns, &|k, x| {
                watch.ask(k as f64 / count as f64)?;
                self.clear_fixed(x);
                self.shift(x);
                Ok(())
            })
        })
    }

    /// Where none is fixed, the vertex that was left out to make the Laplacian definite.
    pub fn grounded(&self) -> Option<VertexId> {
        (self.closed && self.vertex_count > 0).then(|| VertexId::new(self.vertex_count - 1))
    }

    /// For each given vertex the forward substitution of the solve that gives its Green's function `G e_v`, where G is the
    /// inverse of the Laplacian that was factored: without the fixed vertices, and where there are none without the
    /// grounded one. At those G is 0.
    ///
    /// With the factor, L = C Cᵀ, this is `C⁻¹ e_v`, which is 0 but on the way from v to the root of the elimination tree:
    /// a few thousand entries, for a small share of a solve. [`ForwardSolution::dot`] gives the entries of G.
    pub fn solve_forward(&self, vertices: &[VertexId]) -> Vec<ForwardSolution> {
        let mut scratch = Vec::new();
        let solution = |v: &VertexId| match self.unknown.binary_search(v) {
            Ok(k) => ForwardSolution { entries: self.cholesky.solve_forward(k as u32, &mut scratch) },
            Err(_) => ForwardSolution { entries: Vec::new() },
        };
        vertices.iter().map(solution).collect()
    }

    /// `G b` for right-hand sides b that are 0 but at the vertices given with their values: for a single vertex its
    /// Green's function. Little more than half as expensive as [`solve_many`](Self::solve_many), since the forward
    /// substitution is sparse, as in [`solve_forward`](Self::solve_forward). Values at fixed vertices do not count; where none is fixed the
    /// grounded vertex takes what is missing from a sum of zero, and has the solution 0.
    pub fn solve_sparse(&self, right_hand_sides: &[Vec<(VertexId, f64)>]) -> Vec<VertexData<f64>> {
        unwatched(self.solve_sparse_watched(right_hand_sides, Watch::NONE))
    }

    /// [`Poisson::solve_sparse`], watched.
    ///
    /// # Errors
    /// If it is stopped.
    pub fn solve_sparse_watched(
        &self,
        right_hand_sides: &[Vec<(VertexId, f64)>],
        watch: Watch,
    ) -> Result<Vec<VertexData<f64>>, Interrupted> {
        let row = |&(v, value): &(VertexId, f64)| Some((self.unknown.binary_search(&v).ok()? as u32, value));
        let rows: Vec<Vec<(u32, f64)>> = right_hand_sides.iter().map(|b| b.iter().filter_map(row).collect()).collect();
        // Each by itself, which clears no memory that will be written to anyway.
        let mut columns: Vec<VertexData<f64>> =
            rows.iter().map(|_| VertexData::constant(self.vertex_count, 0.0)).collect();
        let mut all: Vec<&mut [f64]> = columns.iter_mut().map(|column| &mut **column).collect();
        self.cholesky.solve_sparse(&rows, &mut all, &|row| self.unknown[row].index(), watch)?;
        Ok(columns)
    }

    /// The backward substitution: `Σ k_v G e_v`, 0 at fixed vertices and at the grounded one. Costs half a solve, however many
    /// there are.
    pub fn solve_backward<'a>(&self, forward: impl IntoIterator<Item = (&'a ForwardSolution, f64)>) -> VertexData<f64> {
        let mut y = vec![0.0; self.unknown.len()];
        for (solution, k) in forward {
            solution.entries.iter().for_each(|&(step, entry)| y[step as usize] += k * entry);
        }
        self.scatter(&self.cholesky.solve_backward(y))
    }

    /// The number of stored entries of the factor: eight bytes each.
    pub fn factor_len(&self) -> usize {
        self.cholesky.factor_len()
    }

    /// A right-hand side has a value a vertex, and sums to zero where it has to.
    fn check(&self, b: &[f64]) {
        assert_eq!(b.len(), self.vertex_count, "a right-hand side has one value a vertex");
        debug_assert!(
            !self.closed || b.iter().sum::<f64>().abs() <= 1e-8 * (1.0 + b.iter().map(|b| b.abs()).sum::<f64>()),
            "where no vertex is fixed the right-hand side sums to zero"
        );
    }

    fn gather(&self, b: &[f64]) -> Vec<f64> {
        self.check(b);
        self.unknown.iter().map(|v| b[v.index()]).collect()
    }

    /// 0 at the vertices that are not solved for.
    fn clear_fixed(&self, x: &mut [f64]) {
        let mut from = 0;
        for v in &self.unknown {
            x[from..v.index()].fill(0.0);
            from = v.index() + 1;
        }
        x[from..].fill(0.0);
    }

    fn scatter(&self, x: &[f64]) -> VertexData<f64> {
        let mut full = VertexData::constant(self.vertex_count, 0.0);
        for (&v, &x) in self.unknown.iter().zip(x) {
            full[v] = x;
        }
        full
    }

    /// Shifts a solution on a closed surface to mean zero.
    fn shift(&self, x: &mut [f64]) {
        if self.closed {
            let mean = x.iter().sum::<f64>() / self.vertex_count as f64;
            x.iter_mut().for_each(|x| *x -= mean);
        }
    }
}

/// The forward substitution for a vertex; see [`Poisson::solve_forward`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForwardSolution {
    /// The nonzero entries of `C⁻¹ e_v` by step of the elimination, ascending.
    entries: Vec<(u32, f64)>,
}

impl ForwardSolution {
    /// The entry of G for the vertices of two forward substitutions with the same factor.
    pub fn dot(&self, other: &Self) -> f64 {
        let mut others = other.entries.iter().peekable();
        let mut sum = 0.0;
        for &(step, x) in &self.entries {
            while others.next_if(|(other, _)| *other < step).is_some() {}
            if let Some((_, y)) = others.next_if(|(other, _)| *other == step) {
                sum += x * y;
            }
        }
        sum
    }
}

/// The rows and columns of the unknowns.
fn restrict(matrix: SymmetricMatrix, unknown: &[VertexId]) -> SymmetricMatrix {
    matrix.into_restricted(unknown.iter().map(|v| v.index()))
}

/// Refuses a surface of which a piece has no fixed vertex: nothing determines a solution there. O(stored entries).
fn check_pieces(laplacian: &SymmetricMatrix, fixed: &[VertexId]) -> Result<(), PoissonError> {
    let count = laplacian.dimension();
    let mut pieces = UnionFind::<u32>::new(count);
    for column in 0..count {
        for (row, value) in laplacian.column(column) {
            if row != column && value != 0.0 {
                pieces.union(column as u32, row as u32);
            }
        }
    }
    let mut is_held = vec![false; count];
    fixed.iter().for_each(|v| is_held[pieces.find_mut(v.0) as usize] = true);
    if fixed.is_empty() && count > 0 {
        is_held[pieces.find_mut(0) as usize] = true;
    }
    let is_free = (0..count as u32).any(|v| !is_held[pieces.find_mut(v) as usize]);
    if is_free { Err(PoissonError::NotPositiveDefinite) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, Metric, laplacian, shapes};

    #[test]
    fn each_piece_of_a_surface_needs_a_fixed_vertex() {
        for shape in [shapes::sphere(60), shapes::disk(200), shapes::hare(300), shapes::torus(1, 400)] {
            let count = shape.points.len() as u32;
            let second = shape.triangles.iter().map(|t| t.map(|v| v + count));
            let both: Vec<[u32; 3]> = shape.triangles.iter().copied().chain(second).collect();
            let mesh = Mesh::new(2 * count as usize, &both).unwrap();
            let points = [&shape.points[..], &shape.points].concat();
            let laplacian = laplacian(&mesh, &Metric::from_points(&mesh, &points));
            let [one, other] = [VertexId(3), VertexId(count + 5)];
            for fixed in [&[][..], &[one], &[other, other]] {
                let refused = Poisson::new(&laplacian, fixed).map(|_| ());
                assert_eq!(refused, Err(PoissonError::NotPositiveDefinite));
                let refused = Poisson::with_points(&laplacian, fixed, &points).map(|_| ());
                assert_eq!(refused, Err(PoissonError::NotPositiveDefinite));
            }
            assert!(Poisson::new(&laplacian, &[one, other]).is_ok());
        }
    }

    #[test]
    fn another_laplacian_is_of_as_many_vertices() {
        let of = |shape: shapes::Shape| {
            let mesh = shape.mesh();
            laplacian(&mesh, &Metric::from_points(&mesh, &shape.points))
        };
        let [matrix, small, large] = [shapes::disk(200), shapes::sphere(60), shapes::hare(900)].map(of);
        assert!(small.dimension() < matrix.dimension() && matrix.dimension() < large.dimension());
        let poisson = Poisson::new(&matrix, &[]).unwrap();
        for wrong in [&small, &large] {
            let refused = PoissonError::Size { found: wrong.dimension(), vertices: matrix.dimension() };
            assert_eq!(poisson.another(wrong).map(|_| ()), Err(refused.clone()));
            assert_eq!(Poisson::new(&matrix, &[]).unwrap().refactor(wrong).map(|_| ()), Err(refused));
        }
        assert!(poisson.another(&matrix).is_ok());
    }

    #[test]
    fn forward_and_backward_substitution_make_up_a_solve() {
        for (shape, fixed) in [(shapes::hare(900), vec![]), (shapes::hare(900), vec![VertexId(5), VertexId(600)])] {
            let mesh = shape.mesh();
            let matrix = laplacian(&mesh, &Metric::from_points(&mesh, &shape.points));
            let poisson = Poisson::with_points(&matrix, &fixed, &shape.points).unwrap();
            let (v, w) = (VertexId(17), VertexId(300));
            let forward = poisson.solve_forward(&[v, w, fixed.first().copied().or(poisson.grounded()).unwrap()]);
            assert_eq!(forward[2], ForwardSolution::default());
            // A dipole sums to zero.
            let mut source = VertexData::constant(mesh.vertex_count(), 0.0);
            (source[v], source[w]) = (1.0, -1.0);
            let (half, whole) =
                (poisson.solve_backward([(&forward[0], 1.0), (&forward[1], -1.0)]), poisson.solve(&source));
            let sum: f64 = whole.iter().sum();
            assert!(!fixed.is_empty() || sum.abs() < 1e-11, "on a closed surface the mean is zero: {sum}");
            let shift = whole[v] - half[v];
            assert!(mesh.vertices().all(|x| (whole[x] - half[x] - shift).abs() < 1e-11));
            let sparse = poisson.solve_sparse(&[vec![(v, 1.0), (w, -1.0)], vec![(w, 1.0)], vec![]]);
            assert!(mesh.vertices().all(|x| (sparse[0][x] - half[x]).abs() < 1e-11 && sparse[2][x] == 0.0));
            let [alone] = &poisson.solve_sparse(&[vec![(w, 1.0)]])[..] else { panic!("one for one") };
            assert!(mesh.vertices().all(|x| (sparse[1][x] - alone[x]).abs() < 1e-11));
            assert!((alone[v] - forward[0].dot(&forward[1])).abs() < 1e-11);
            let across = forward[0].dot(&forward[0]) - forward[0].dot(&forward[1]);
            assert!((across - half[v]).abs() < 1e-11);
            assert_eq!(
                poisson.solve_backward([(&forward[1], 1.0)])[v],
                poisson.another(&matrix).unwrap().solve_backward([(&forward[1], 1.0)])[v]
            );
        }
    }
}
