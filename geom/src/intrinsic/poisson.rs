//! The Poisson equation L x = b on a mesh: one factorization, many right-hand sides.
//!
//! Without fixed vertices L is singular, its kernel the constants: one vertex is grounded, the right-hand side must sum
//! to zero (as Gauss–Bonnet makes curvatures do), and a solution is known up to a constant. With fixed vertices (a
//! boundary, pinned cones) L is restricted to the others and solutions are 0 at the fixed ones.

use thiserror::Error;

use crate::linalg::{Cholesky, CholeskyError, SymmetricMatrix};
use crate::mesh::{Id, VertexData, VertexId};

/// From so many vertices on it is worth it to dissect. (Below 30 thousand approximate minimum degree takes no longer, and
/// gives a factor smaller by a twentieth.)
const DISSECTED: usize = 35_000;

/// Why a Laplacian cannot be factored.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PoissonError {
    /// A pivot is not positive: degenerate triangles, or a surface in several pieces.
    #[error("the Laplacian is not positive definite; the mesh has degenerate triangles or several components")]
    NotPositiveDefinite,
    /// The factor does not fit into memory.
    #[error("there is not enough memory to factor the Laplacian of {0} vertices")]
    OutOfMemory(usize),
}

impl From<CholeskyError> for PoissonError {
    fn from(error: CholeskyError) -> Self {
        match error {
            CholeskyError::NotPositiveDefinite => Self::NotPositiveDefinite,
            CholeskyError::OutOfMemory(rows) => Self::OutOfMemory(rows),
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
#[derive(Debug)]
pub struct Poisson {
    cholesky: Cholesky,
    /// The vertex of each unknown.
    unknown: Vec<VertexId>,
    vertex_count: usize,
    /// No vertex is fixed, so right-hand sides have to sum to zero.
    closed: bool,
}

impl Poisson {
    /// Factors the Laplacian of a connected surface, with x = 0 at the fixed vertices (in any order, repeats allowed).
    ///
    /// # Errors
    /// If the matrix is not positive definite off the kernel, or memory does not suffice.
    pub fn new(laplacian: &SymmetricMatrix, fixed: &[VertexId]) -> Result<Self, PoissonError> {
        Self::ordered(laplacian, fixed, None)
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
        Self::ordered(laplacian, fixed, Some(points).filter(|points| points.len() >= DISSECTED))
    }

    fn ordered(
        laplacian: &SymmetricMatrix,
        fixed: &[VertexId],
        points: Option<&[[f64; 3]]>,
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
        let point = |points: &[[f64; 3]]| unknown.iter().map(|v| points[v.index()].map(|x| x as f32)).collect();
        let points: Option<Vec<[f32; 3]>> = points.map(point);
        let cholesky = Cholesky::new(restrict(laplacian, &unknown), points.as_deref())?;
        Ok(Self { cholesky, unknown, vertex_count, closed: fixed.is_empty() })
    }

    /// Factors a matrix that is positive definite as it is, such as M + tL; with [`solve`](Self::solve) alone.
    ///
    /// # Errors
    /// If it is not positive definite, or memory does not suffice.
    pub fn definite(matrix: &SymmetricMatrix) -> Result<Self, PoissonError> {
        let vertex_count = matrix.dimension();
        let unknown: Vec<VertexId> = (0..vertex_count).map(VertexId::new).collect();
        let cholesky = Cholesky::new(restrict(matrix, &unknown), None)?;
        Ok(Self { cholesky, unknown, vertex_count, closed: false })
    }

    /// Factors another Laplacian of the same surface, with the same vertices fixed, in the same order of elimination.
    ///
    /// # Errors
    /// As [`Poisson::new`].
    pub fn another(&self, laplacian: &SymmetricMatrix) -> Result<Self, PoissonError> {
        debug_assert_eq!(laplacian.dimension(), self.vertex_count);
        let cholesky = self.cholesky.another(restrict(laplacian, &self.unknown))?;
        Ok(Self { cholesky, unknown: self.unknown.clone(), ..*self })
    }

    /// Factors another Laplacian of the same surface, with the same vertices fixed; what can be kept is.
    ///
    /// # Errors
    /// As [`Poisson::new`]; after an error the old factor is gone, and only `refactor` may be called.
    pub fn refactor(&mut self, laplacian: &SymmetricMatrix) -> Result<(), PoissonError> {
        debug_assert_eq!(laplacian.dimension(), self.vertex_count);
        Ok(self.cholesky.refactor(restrict(laplacian, &self.unknown))?)
    }

    /// Solves L x = b with x = 0 at the fixed vertices. On a closed surface b must sum to zero, and x is shifted to mean
    /// zero over the vertices. One step of refinement is added where the residual asks for it.
    ///
    /// # Panics
    /// If `b` is not as long as there are vertices.
    pub fn solve(&self, b: &[f64]) -> VertexData<f64> {
        let restricted = self.gather(b);
        let mut x = restricted.clone();
        self.cholesky.solve_in_place(&mut x);
        let product = self.cholesky.multiply(&x);
        let mut residual: Vec<f64> = restricted.iter().zip(&product).map(|(b, p)| b - p).collect();
        if norm(&residual) > 1e-13 * norm(&restricted) {
            self.cholesky.solve_in_place(&mut residual);
            for (x, correction) in x.iter_mut().zip(&residual) {
                *x += correction;
            }
        }
        self.shifted(self.scatter(&x))
    }

    /// Solves for several right-hand sides at once, which is 4–5 times cheaper for each than one by one; without
    /// refinement.
    ///
    /// # Panics
    /// If a right-hand side is not as long as there are vertices.
    pub fn solve_many(&self, right_hand_sides: &[VertexData<f64>]) -> Vec<VertexData<f64>> {
        let n = self.unknown.len();
        if n == 0 {
            return vec![VertexData::constant(self.vertex_count, 0.0); right_hand_sides.len()];
        }
        let mut block: Vec<f64> = right_hand_sides.iter().flat_map(|b| self.gather(b)).collect();
        self.cholesky.solve_in_place(&mut block);
        block.chunks_exact(n).map(|x| self.shifted(self.scatter(x))).collect()
    }

    /// On a closed surface, the vertex that was left out to make the Laplacian definite.
    pub fn grounded(&self) -> Option<VertexId> {
        (self.closed && self.vertex_count > 0).then(|| VertexId::new(self.vertex_count - 1))
    }

    /// For each given vertex, half of the solve that gives its Green's function `G e_v`, where G is the inverse of the
    /// Laplacian that was factored: without the fixed vertices, and on a closed surface without the grounded one. At those
    /// G is 0.
    ///
    /// With the factor, L = C Cᵀ, this is `C⁻¹ e_v`, which is 0 but on the way from v to the root of the elimination tree:
    /// a few thousand entries, for a small share of a solve. [`HalfSolved::dot`] gives the entries of G.
    pub fn half_solve(&self, vertices: &[VertexId]) -> Vec<HalfSolved> {
        let mut scratch = Vec::new();
        let half = |v: &VertexId| match self.unknown.binary_search(v) {
            Ok(k) => HalfSolved { entries: self.cholesky.half_solve(k as u32, &mut scratch) },
            Err(_) => HalfSolved { entries: Vec::new() },
        };
        vertices.iter().map(half).collect()
    }

    /// `G b` for right-hand sides b that are 0 but at the vertices given with their values: for a single vertex its
    /// Green's function. Little more than half as expensive as [`solve_many`](Self::solve_many), since the first half of the
    /// solve is as in [`half_solve`](Self::half_solve). Values at fixed vertices do not count; on a closed surface the
    /// grounded vertex takes what is missing from a sum of zero, and has the solution 0.
    pub fn solve_sparse(&self, right_hand_sides: &[Vec<(VertexId, f64)>]) -> Vec<VertexData<f64>> {
        let row = |&(v, value): &(VertexId, f64)| Some((self.unknown.binary_search(&v).ok()? as u32, value));
        let rows: Vec<Vec<(u32, f64)>> = right_hand_sides.iter().map(|b| b.iter().filter_map(row).collect()).collect();
        let n = self.unknown.len();
        if n == 0 {
            return vec![VertexData::constant(self.vertex_count, 0.0); rows.len()];
        }
        self.cholesky.solve_sparse(&rows).chunks_exact(n).map(|x| self.scatter(x)).collect()
    }

    /// The other half: `Σ k_v G e_v`, 0 at fixed vertices and at the grounded one. Costs half a solve, however many there are.
    pub fn finish<'a>(&self, halves: impl IntoIterator<Item = (&'a HalfSolved, f64)>) -> VertexData<f64> {
        let mut y = vec![0.0; self.unknown.len()];
        for (half, k) in halves {
            half.entries.iter().for_each(|&(step, entry)| y[step as usize] += k * entry);
        }
        self.scatter(&self.cholesky.half_solve_back(y))
    }

    /// The number of stored entries of the factor: eight bytes each.
    pub fn factor_len(&self) -> usize {
        self.cholesky.factor_len()
    }

    fn gather(&self, b: &[f64]) -> Vec<f64> {
        assert_eq!(b.len(), self.vertex_count, "a right-hand side has one value a vertex");
        debug_assert!(
            !self.closed || b.iter().sum::<f64>().abs() <= 1e-8 * (1.0 + b.iter().map(|b| b.abs()).sum::<f64>()),
            "on a closed surface the right-hand side sums to zero"
        );
        self.unknown.iter().map(|v| b[v.index()]).collect()
    }

    fn scatter(&self, x: &[f64]) -> VertexData<f64> {
        let mut full = VertexData::constant(self.vertex_count, 0.0);
        for (&v, &x) in self.unknown.iter().zip(x) {
            full[v] = x;
        }
        full
    }

    /// Shifts a solution on a closed surface to mean zero.
    fn shifted(&self, mut x: VertexData<f64>) -> VertexData<f64> {
        if self.closed {
            let mean = x.iter().sum::<f64>() / self.vertex_count as f64;
            x.iter_mut().for_each(|x| *x -= mean);
        }
        x
    }
}

/// A vertex's half of a solve; see [`Poisson::half_solve`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HalfSolved {
    /// The nonzero entries of `C⁻¹ e_v` by step of the elimination, ascending.
    entries: Vec<(u32, f64)>,
}

impl HalfSolved {
    /// The entry of G for the vertices of two halves of the same factor.
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

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The rows and columns of the unknowns.
fn restrict(matrix: &SymmetricMatrix, unknown: &[VertexId]) -> SymmetricMatrix {
    matrix.restricted(unknown.iter().map(|v| v.index()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Metric, laplacian, shapes};

    #[test]
    fn half_solves_make_up_whole_ones() {
        for (shape, fixed) in [(shapes::hare(900), vec![]), (shapes::hare(900), vec![VertexId(5), VertexId(600)])] {
            let mesh = shape.mesh();
            let matrix = laplacian(&mesh, &Metric::from_points(&mesh, &shape.points));
            let poisson = Poisson::with_points(&matrix, &fixed, &shape.points).unwrap();
            let (v, w) = (VertexId(17), VertexId(300));
            let halves = poisson.half_solve(&[v, w, fixed.first().copied().or(poisson.grounded()).unwrap()]);
            assert_eq!(halves[2], HalfSolved::default());
            // A dipole sums to zero.
            let mut source = VertexData::constant(mesh.vertex_count(), 0.0);
            (source[v], source[w]) = (1.0, -1.0);
            let (half, whole) = (poisson.finish([(&halves[0], 1.0), (&halves[1], -1.0)]), poisson.solve(&source));
            let shift = whole[v] - half[v];
            assert!(mesh.vertices().all(|x| (whole[x] - half[x] - shift).abs() < 1e-11));
            let sparse = poisson.solve_sparse(&[vec![(v, 1.0), (w, -1.0)], vec![(w, 1.0)], vec![]]);
            assert!(mesh.vertices().all(|x| (sparse[0][x] - half[x]).abs() < 1e-11 && sparse[2][x] == 0.0));
            let [alone] = &poisson.solve_sparse(&[vec![(w, 1.0)]])[..] else { panic!("one for one") };
            assert!(mesh.vertices().all(|x| (sparse[1][x] - alone[x]).abs() < 1e-11));
            assert!((alone[v] - halves[0].dot(&halves[1])).abs() < 1e-11);
            let across = halves[0].dot(&halves[0]) - halves[0].dot(&halves[1]);
            assert!((across - half[v]).abs() < 1e-11);
            assert_eq!(
                poisson.finish([(&halves[1], 1.0)])[v],
                poisson.another(&matrix).unwrap().finish([(&halves[1], 1.0)])[v]
            );
        }
    }
}
