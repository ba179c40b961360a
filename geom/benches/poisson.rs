//! Factoring and solving, beside faer's supernodal factorization with its approximate minimum degree.
//!
//! `cargo bench -p cones-geom --bench poisson`; one thread.

use divan::Bencher;
use divan::counter::ItemsCount;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{CholeskySymbolicParams, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side};
use geom::{Id, Metric, Poisson, SymmetricMatrix, VertexData, VertexId, delaunay, laplacian, shapes};

const SIZES: [usize; 3] = [3_000, 29_000, 134_000];
/// Right-hand sides of the solves for many.
const MANY: usize = 16;

fn main() {
    divan::main();
}

/// The Laplacian of a hare of so many vertices, and its points.
fn hare(vertices: usize) -> (SymmetricMatrix, Vec<[f64; 3]>) {
    let shape = shapes::hare(vertices);
    let mesh = shape.mesh();
    let intrinsic = delaunay(&mesh, &Metric::from_points(&mesh, &shape.points));
    (laplacian(&intrinsic.triangulation, &intrinsic.metric), shape.points)
}

fn factored(vertices: usize) -> (Poisson, usize) {
    let (matrix, points) = hare(vertices);
    (Poisson::with_points(&matrix, &[], &points).expect("a hare's Laplacian is definite"), matrix.dimension())
}

fn dipole(n: usize, k: usize) -> VertexData<f64> {
    let mut b = VertexData::constant(n, 0.0);
    b[VertexId::new(k)] = 1.0;
    b[VertexId::new(n / 2 + k)] = -1.0;
    b
}

#[divan::bench(args = SIZES, sample_count = 7, sample_size = 1)]
fn factor_by_minimum_degree(bencher: Bencher, vertices: usize) {
    let (matrix, _) = hare(vertices);
    bencher.bench_local(|| Poisson::new(&matrix, &[]));
}

#[divan::bench(args = SIZES, sample_count = 7, sample_size = 1)]
fn factor_by_dissection(bencher: Bencher, vertices: usize) {
    let (matrix, points) = hare(vertices);
    bencher.bench_local(|| Poisson::with_points(&matrix, &[], &points));
}

#[divan::bench(args = SIZES, sample_count = 7, sample_size = 1)]
fn factor_by_faer(bencher: Bencher, vertices: usize) {
    let (matrix, _) = hare(vertices);
    // The last vertex is grounded.
    let n = matrix.dimension() - 1;
    let (mut start, mut row, mut value) = (vec![0u32], Vec::new(), Vec::new());
    for v in 0..n {
        for (r, x) in matrix.column(v).filter(|(r, _)| *r < n) {
            row.push(r as u32);
            value.push(x);
        }
        start.push(row.len() as u32);
    }
    bencher.bench_local(|| {
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &start, None, &row);
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, SymmetricOrdering::Amd, parameters)
            .expect("there is enough memory");
        let mut factor = vec![0.0; symbolic.len_val()];
        let mut scratch = MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()));
        let (matrix, stack) = (SparseColMatRef::new(pattern, &value), MemStack::new(&mut scratch));
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                matrix,
                Side::Lower,
                Default::default(),
                Par::Seq,
                stack,
                Default::default(),
            )
            .expect("a hare's Laplacian is definite");
        factor
    });
}

#[divan::bench(args = SIZES, sample_count = 7, sample_size = 1)]
fn factor_again(bencher: Bencher, vertices: usize) {
    let (matrix, points) = hare(vertices);
    let mut poisson = Some(Poisson::with_points(&matrix, &[], &points).expect("a hare's Laplacian is definite"));
    bencher.bench_local(|| poisson = poisson.take().and_then(|poisson| poisson.refactor(&matrix).ok()));
}

#[divan::bench(args = SIZES, sample_count = 20, sample_size = 1)]
fn solve(bencher: Bencher, vertices: usize) {
    let (poisson, n) = factored(vertices);
    let b = dipole(n, 0);
    bencher.bench_local(|| poisson.solve(&b));
}

#[divan::bench(args = SIZES, sample_count = 7, sample_size = 1)]
fn solve_many(bencher: Bencher, vertices: usize) {
    let (poisson, n) = factored(vertices);
    let all: Vec<VertexData<f64>> = (0..MANY).map(|k| dipole(n, k)).collect();
    bencher.counter(ItemsCount::new(MANY)).bench_local(|| poisson.solve_many(&all));
}

#[divan::bench(args = SIZES, sample_count = 20, sample_size = 1)]
fn solve_forward(bencher: Bencher, vertices: usize) {
    let (poisson, n) = factored(vertices);
    let all: Vec<VertexId> = (0..MANY).map(|k| VertexId::new(k * n / MANY)).collect();
    bencher.counter(ItemsCount::new(MANY)).bench_local(|| poisson.solve_forward(&all));
}
