//! Of what is computed on a surface before anything is flattened.

use std::f64::consts::PI;

use cones::SeamError;
use cones::internals::Seams;
use geom::{CutMesh, Mesh, Poisson, SymmetricMatrix, VertexId, angle_defects, delaunay, edge_weights};

use super::{assert_close, metric_of};
use crate::decode::{self, Bytes};
use crate::oracle;

/// Intrinsic Delaunay flips keep the connectivity sound, the area, the angle sums and so Gauss–Bonnet; they leave no
/// negative weight; undone backwards they give the triangulation to the bit.
pub fn flips(bytes: &[u8]) {
    let shape = decode::surface(&mut Bytes::new(bytes));
    let mesh = shape.mesh();
    let metric = metric_of(&mesh, &shape);
    let total: f64 = angle_defects(&mesh, &metric).iter().sum();
    assert_close(total, 2.0 * PI * mesh.euler_characteristic() as f64, 1e-12, mesh.face_count() as f64);

    let intrinsic = delaunay(&mesh, &metric);
    intrinsic.triangulation.check();
    let longest = metric.lengths().iter().fold(0.0_f64, |m, &l| m.max(l));
    let area = metric.area(&mesh);
    assert_close(intrinsic.metric.area(&intrinsic.triangulation), area, 1e-9, longest * longest);
    let degenerate = mesh.faces().any(|f| metric.sides(&mesh, f).area() < 1e-6 * longest * longest);
    if !degenerate {
        let sums = [metric.angle_sums(&mesh), intrinsic.metric.angle_sums(&intrinsic.triangulation)];
        mesh.vertices().for_each(|v| assert_close(sums[0][v], sums[1][v], 1e-6, 1.0));
        let weights = edge_weights(&intrinsic.triangulation, &intrinsic.metric);
        assert!(weights.iter_ids().all(|(e, &w)| w > -1e-6 || !intrinsic.triangulation.is_flippable(e)));
    }
    let mut undone = intrinsic.triangulation.clone();
    for &h in intrinsic.flips.iter().rev() {
        undone.unflip(h);
    }
    assert!(undone == *mesh.triangulation(), "flips undone backwards leave the mesh as it was");

    // With its loops and repeated edges the triangulation is a surface to topo.
    let field: Vec<u8> = bytes.iter().copied().chain(0..=u8::MAX).cycle().take(mesh.vertex_count()).collect();
    let flipped = Mesh::from_triangulation(intrinsic.triangulation).expect("flips keep a manifold one");
    let surface = topo::Rings::new(&flipped, |v| !flipped.is_boundary_vertex(v));
    assert_eq!(topo::persistence(surface, &field), topo::persistence(&flipped, &field));
}

/// L is symmetric, constants are in its kernel, and xᵀLx is the Dirichlet energy of the piecewise linear x, 0 for no others.
pub fn laplacian(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let shape = decode::surface(bytes);
    let mesh = shape.mesh();
    let matrix = geom::laplacian(&mesh, &metric_of(&mesh, &shape)).to_csr();
    let largest = matrix.data().iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut energy = 0.0;
    let x: Vec<f64> = mesh.vertices().map(|_| bytes.signed()).collect();
    for (i, row) in matrix.outer_iterator().enumerate() {
        assert_close(row.iter().map(|(_, w)| w).sum(), 0.0, 1e-13, largest);
        for (j, w) in row.iter() {
            assert_eq!(matrix.get(j, i), Some(w), "symmetric to the bit");
            energy += x[i] * w * x[j];
        }
    }
    assert!(energy >= -1e-10 * largest, "positive semidefinite, but xᵀLx = {energy:e}");
    let is_thin = |corners: &[u32; 3]| {
        let [p, q, r] = corners.map(|v| shape.points[v as usize]);
        let longest = [(p, q), (q, r), (r, p)].iter().map(|&(p, q)| distance(p, q)).fold(0.0, f64::max);
        oracle::area([p, q, r]) < 1e-4 * longest * longest
    };
    if !shape.triangles.iter().any(is_thin) {
        let expected: f64 = shape.triangles.iter().map(|corners| dirichlet(corners, &shape.points, &x)).sum();
        assert_close(energy, expected, 1e-9, expected.max(largest));
    }
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    p.iter().zip(q).map(|(p, q)| (p - q).powi(2)).sum::<f64>().sqrt()
}

/// ∫ |∇x|² over a triangle, from the gradient itself: as long as the sum of the sides, each times the value opposite to it, over twice the area.
fn dirichlet(corners: &[u32; 3], points: &[[f64; 3]], x: &[f64]) -> f64 {
    let p = corners.map(|v| points[v as usize]);
    let x = corners.map(|v| x[v as usize]);
    let sum = [0, 1, 2].map(|axis| (0..3).map(|k| x[k] * (p[(k + 2) % 3][axis] - p[(k + 1) % 3][axis])).sum::<f64>());
    sum.iter().map(|s| s * s).sum::<f64>() / (4.0 * oracle::area(p))
}

/// Solutions are those of Gaussian elimination on the dense matrix, for any fixed vertices and none, one right-hand side
/// and several, all entries given or those that are not 0.
pub fn poisson(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let shape = decode::surface(bytes);
    let mesh = shape.mesh();
    let metric = metric_of(&mesh, &shape).mollified(&mesh, 1e-2);
    let intrinsic = delaunay(&mesh, &metric);
    let matrix = geom::laplacian(&intrinsic.triangulation, &intrinsic.metric);
    let n = mesh.vertex_count();
    let fixed: Vec<VertexId> = (0..bytes.below(4)).map(|_| VertexId(bytes.below(n) as u32)).collect();
    let mut b: Vec<f64> = (0..n).map(|_| bytes.signed()).collect();
    if fixed.is_empty() {
        let mean = b.iter().sum::<f64>() / n as f64;
        b.iter_mut().for_each(|b| *b -= mean);
    }
    let Some(expected) = dense_solution(&matrix, &fixed, &b) else { return };
    let poisson = Poisson::new(&matrix, &fixed).expect("connected, with triangles that have area");
    let size = expected.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
    let many = poisson.solve_many(&[b.clone().into(), b.iter().map(|b| -2.0 * b).collect()]);
    let entries: Vec<(VertexId, f64)> = mesh.vertices().zip(b.iter().copied()).collect();
    let sides = [entries, Vec::new()];
    let sparse = [poisson.solve_sparse(&sides[..1]), poisson.solve_sparse(&sides)];
    for (v, &x) in poisson.solve(&b).iter_ids() {
        // On a closed surface these are 0 at the grounded vertex.
        let shift = poisson.grounded().map_or(0.0, |grounded| many[0][grounded]);
        sparse.iter().for_each(|sparse| assert_close(sparse[0][v] + shift, x, 1e-8, size));
        assert_eq!(sparse[1][1][v], 0.0);
        assert_close(x, expected[v.0 as usize], 1e-8, size);
        assert_close(many[0][v], x, 1e-8, size);
        assert_close(many[1][v], -2.0 * x, 1e-8, 2.0 * size);
    }
}

/// Fixed vertices get the row `x_v = 0`. Without any, the last row is replaced by Σx = 0.
fn dense_solution(matrix: &SymmetricMatrix, fixed: &[VertexId], b: &[f64]) -> Option<Vec<f64>> {
    let n = b.len();
    let mut rows: Vec<Vec<f64>> = matrix.to_csr().to_dense().outer_iter().map(|row| row.to_vec()).collect();
    let mut b = b.to_vec();
    for v in fixed.iter().map(|v| v.0 as usize) {
        rows[v] = (0..n).map(|j| f64::from(u8::from(j == v))).collect();
        b[v] = 0.0;
    }
    if fixed.is_empty() {
        rows[n - 1] = vec![1.0; n];
        b[n - 1] = 0.0;
    }
    oracle::solve_densely(rows, b)
}

/// Seams through any cones open the surface to a disk and are no longer than the minimum spanning tree of the cones'
/// distances, whatever the topology.
pub fn seams(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let shape = decode::surface(bytes);
    let mesh = shape.mesh();
    let lengths = metric_of(&mesh, &shape).lengths().clone();
    let count = bytes.below(9);
    let cones = decode::inner_vertices(bytes, &mesh, count);
    match Seams::new(&mesh, &lengths, &cones, geom::Watch::NONE) {
        Err(error) => {
            assert_eq!(error, SeamError::TooFewCones { cones: cones.len() });
            assert!(mesh.euler_characteristic() == 2 && cones.len() < 2);
        }
        Ok(seams) => {
            assert!(CutMesh::open(&mesh, &seams.cut).is_disk());
            if mesh.euler_characteristic() == 2 && mesh.vertex_count() < 200 {
                let tree = oracle::terminal_tree_length(&mesh, &lengths, &cones);
                assert!(seams.length <= tree * (1.0 + 1e-12), "{} > {tree}", seams.length);
                assert!(seams.length >= 0.5 * tree, "not even Steiner's tree is so short");
            }
        }
    }
}
