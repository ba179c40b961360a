//! Least-squares conformal maps: the baseline without metric scaling (Lévy, Petitjean, Ray & Maillot 2002).
//!
//! Of all maps z of an opened surface into the plane the one with the least conformal energy
//!
//! ```text
//!     E(z) = ½ zᴴ L z - A(z)          (Dirichlet energy less the area of the image)
//! ```
//!
//! L being the cotangent Laplacian: it is 0 just where all angles are kept. Similarities do not change it, so two vertices
//! are pinned, here two that are far from each other along edges. `A(z) = ½ Σ (x_i y_j - x_j y_i)` over all halfedges ij,
//! which cancels but for the boundary's. The real system has two unknowns a vertex and is positive definite: one Cholesky
//! factorization. A triangle whose sides break the triangle inequality counts as one that nearly does.
//!
//! Scale is nobody's concern here, and can differ by orders of magnitude over the surface. Given the metric of
//! [`scale_linearly`](crate::baseline::scale_linearly), which is nearly flat, it lays that out: triangles that do not quite close
//! are fitted by least squares, as ABF++ does with its angles (Sheffer et al. 2005).

use geom::{
    Cholesky, CholeskyError, CutMesh, EdgeData, HalfedgeData, HalfedgeId, Id, Mesh, MeshError, Metric, ShortestPaths,
    Sides, SymmetricMatrix, VertexId, counted,
};
use num_complex::Complex64;
use sprs::{CsMat, TriMat};
use thiserror::Error;

/// A triangle's longest side is at most the other two together less this share: a needle with cotangents of a thousand,
/// which factoring bears. Linear metric scaling makes such triangles and broken ones.
const LEAST_SLACK: f64 = 1e-6;

/// Why there is no least-squares conformal map.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum LscmError {
    /// The cut leaves more than one piece, or one with handles or holes.
    #[error("the surface cut open has an Euler characteristic of {euler} in {}, but must be one disk", counted(*islands, "piece", "pieces"))]
    NoDisk {
        /// V - E + F.
        euler: i64,
        /// How many pieces there are.
        islands: usize,
    },
    /// Lengths to lay out are infinite or NaN, as linear metric scaling can make them.
    #[error("the scaled lengths are too large to be laid out")]
    NotFinite,
    /// The surface is so coarse that two edges join the same vertices.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The system cannot be factored: the map would shrink parts to nothing.
    #[error("the least-squares conformal map cannot be told from others: its system is not positive definite")]
    NotPositiveDefinite,
    /// The system cannot be factored for another reason.
    #[error(transparent)]
    Factor(CholeskyError),
}

impl From<CholeskyError> for LscmError {
    fn from(error: CholeskyError) -> Self {
        match error {
            CholeskyError::NotPositiveDefinite => Self::NotPositiveDefinite,
            error => Self::Factor(error),
        }
    }
}

/// A surface laid out by its conformal energy alone.
#[derive(Clone, Debug)]
pub struct Lscm {
    /// The surface opened along its seams.
    pub cut: CutMesh,
    /// The position of each opened vertex, as a complex number; two of them are one unit apart.
    pub position: Vec<Complex64>,
}

impl Lscm {
    /// Lays out a surface, opened along the edges of the cut, which must leave one disk. One factorization.
    ///
    /// ```
    /// use cones::internals::Lscm;
    /// use geom::{EdgeData, Metric, shapes};
    ///
    /// let shape = shapes::disk(300);
    /// let mesh = shape.mesh();
    /// let uncut = EdgeData::constant(mesh.edge_count(), false);
    /// let map = Lscm::new(&mesh, &Metric::from_points(&mesh, &shape.points), &uncut)?;
    /// assert_eq!(map.position.len(), mesh.vertex_count());
    /// # Ok::<(), cones::LscmError>(())
    /// ```
    ///
    /// # Errors
    /// If the cut leaves no disk, or the system cannot be factored.
    ///
    /// # Panics
    /// If there is an edge without a mark.
    pub fn new(input: &Mesh, metric: &Metric, cut: &EdgeData<bool>) -> Result<Self, LscmError> {
        let cut = CutMesh::open(input, cut);
        if !cut.is_disk() {
            return Err(LscmError::NoDisk { euler: cut.euler_characteristic(), islands: cut.island_count() });
        }
        if !metric.lengths().iter().all(|length| length.is_finite()) {
            return Err(LscmError::NotFinite);
        }
        let triangles: Vec<[u32; 3]> = input.faces().map(|f| cut.corners(f).map(|w| w.0)).collect();
        let opened = Mesh::new(cut.wedge_count(), &triangles)?;
        let mut length = EdgeData::constant(opened.edge_count(), 0.0);
        for h in input.halfedges() {
            length[opened.edge(h)] = metric.length(input.edge(h));
        }
        let position = least_energy(&opened, &Metric::new(length))?;
        Ok(Self { cut, position })
    }

    /// The position of a triangle's corner, named by the halfedge that starts there.
    pub fn corner(&self, h: HalfedgeId) -> Complex64 {
        self.position[self.cut.wedge(h).index()]
    }
}

/// The unknowns of a vertex: its x and its y.
fn unknowns(v: VertexId) -> [usize; 2] {
    [2 * v.index(), 2 * v.index() + 1]
}

/// The positions of least conformal energy, with two far vertices pinned at 0 and 1.
fn least_energy(disk: &Mesh, metric: &Metric) -> Result<Vec<Complex64>, LscmError> {
    let energy = conformal_energy(disk, metric);
    let pins = far_apart(disk, metric);
    let pinned: Vec<usize> = pins.into_iter().flat_map(unknowns).collect();
    let free: Vec<usize> = (0..energy.rows()).filter(|i| !pinned.contains(i)).collect();
    let unit = unknowns(pins[1])[0];
    // The matrix is symmetric: its row is its column.
    let mut source = vec![0.0; energy.rows()];
    if let Some(row) = energy.outer_view(unit) {
        row.iter().for_each(|(i, &m)| source[i] = -m);
    }
    let system = SymmetricMatrix::from(&energy).restricted(free.iter().copied());
    let right: Vec<f64> = free.iter().map(|&i| source[i]).collect();
    let mut x = vec![0.0; energy.rows()];
    x[unit] = 1.0;
    for (&i, solved) in free.iter().zip(Cholesky::new(&system)?.solve(&right)) {
        x[i] = solved;
    }
    Ok(x.as_chunks().0.iter().map(|&[x, y]| Complex64::new(x, y)).collect())
}

/// The matrix of twice the conformal energy.
fn conformal_energy(disk: &Mesh, metric: &Metric) -> CsMat<f64> {
    let size = 2 * disk.vertex_count();
    let mut matrix = TriMat::new((size, size));
    let mut counts_area = HalfedgeData::constant(disk.halfedge_count(), false);
    for f in disk.faces() {
        let sides = unbroken(metric.sides(disk, f));
        if sides.area() <= 0.0 {
            continue;
        }
        for (h, cotangent) in disk.sides(f).into_iter().zip(sides.cotangents()) {
            counts_area[h] = true;
            let [i, j] = [disk.tail(h), disk.head(h)].map(unknowns);
            for (i, j) in i.into_iter().zip(j) {
                for (row, column, entry) in [(i, i, 0.5), (j, j, 0.5), (i, j, -0.5), (j, i, -0.5)] {
                    matrix.add_triplet(row, column, entry * cotangent);
                }
            }
        }
    }
    for h in disk.halfedges().filter(|&h| counts_area[h] && !disk.twin(h).is_some_and(|g| counts_area[g])) {
        let [[xi, yi], [xj, yj]] = [disk.tail(h), disk.head(h)].map(unknowns);
        for (a, b, area) in [(xi, yj, -0.5), (xj, yi, 0.5)] {
            matrix.add_triplet(a, b, area);
            matrix.add_triplet(b, a, area);
        }
    }
    matrix.to_csr()
}

/// A triangle with its longest side shortened, where that is needed for the triangle inequality.
fn unbroken(Sides(mut length): Sides) -> Sides {
    let longest = (0..3).max_by(|&a, &b| length[a].total_cmp(&length[b])).unwrap_or(0);
    let others = length[(longest + 1) % 3] + length[(longest + 2) % 3];
    length[longest] = length[longest].min(others * (1.0 - LEAST_SLACK));
    Sides(length)
}

/// Two vertices far from each other: the farthest from the farthest from the first on the boundary.
fn far_apart(disk: &Mesh, metric: &Metric) -> [VertexId; 2] {
    let rim = disk.vertices().filter(|&v| disk.is_boundary_vertex(v));
    let farthest = |from: VertexId| {
        let paths = ShortestPaths::new(disk, metric.lengths(), [(from, 0)]);
        rim.clone()
            .filter(|&v| v != from)
            .max_by(|&a, &b| paths.distance[a].total_cmp(&paths.distance[b]).then(b.cmp(&a)))
    };
    let first = rim.clone().next().expect("a disk has a rim");
    let second = farthest(first).expect("a disk's rim has three vertices");
    [second, farthest(second).expect("a disk's rim has three vertices")]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flatten::Seams;
    use geom::Watch;
    use geom::distortion::{Distortion, measure};
    use geom::shapes::{self, Shape};

    fn map(shape: &Shape, cones: &[VertexId]) -> Lscm {
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let seams = Seams::new(&mesh, metric.lengths(), cones, Watch::NONE).unwrap();
        Lscm::new(&mesh, &metric, &seams.cut).unwrap()
    }

    fn distortion(shape: &Shape, map: &Lscm) -> Distortion {
        let mesh = shape.mesh();
        let corner = |h| [map.corner(h).re, map.corner(h).im];
        let uv: Vec<_> = mesh.faces().map(|f| mesh.sides(f).map(corner)).collect();
        measure(&shape.points, &shape.triangles, &uv).unwrap()
    }

    #[test]
    fn what_can_be_unrolled_is_unrolled() {
        let tip = VertexId(0);
        for (shape, cones) in
            [(shapes::square(200), vec![]), (shapes::cylinder(400), vec![]), (shapes::cone(5, 400), vec![tip])]
        {
            let distortion = distortion(&shape, &map(&shape, &cones));
            assert!(distortion.quasi_conformal.max < 1.0 + 1e-6, "{}", distortion.quasi_conformal.max);
            assert!(distortion.u_linf < 1e-6, "{}", distortion.u_linf);
            assert_eq!(distortion.flipped, 0);
        }
    }

    #[test]
    fn the_energy_is_stationary_but_for_two_pins() {
        let shape = shapes::terrain(600, 4);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let z: Vec<f64> = least_energy(&mesh, &metric).unwrap().iter().flat_map(|z| [z.re, z.im]).collect();
        let mut gradient = vec![0.0_f64; z.len()];
        conformal_energy(&mesh, &metric).iter().for_each(|(m, (i, j))| gradient[i] += m * z[j]);
        let moved = gradient.iter().filter(|g| g.abs() > 1e-9).count();
        assert!(moved <= 4, "{moved}");
    }

    #[test]
    fn the_energy_of_the_identity_is_none_and_a_reflection_has_twice_the_area() {
        let shape = shapes::disk(150);
        let mesh = shape.mesh();
        let energy = conformal_energy(&mesh, &Metric::from_points(&mesh, &shape.points));
        let twice_energy = |y: f64| {
            let z: Vec<f64> = shape.points.iter().flat_map(|p| [p[0], y * p[1]]).collect();
            energy.iter().map(|(m, (i, j))| z[i] * m * z[j]).sum::<f64>()
        };
        assert!(twice_energy(1.0).abs() < 1e-10);
        assert!((twice_energy(-1.0) - 4.0 * shape.area()).abs() < 1e-10);
    }

    #[test]
    fn a_broken_triangle_becomes_a_needle_and_a_sound_one_stays() {
        assert_eq!(unbroken(Sides([3.0, 4.0, 5.0])), Sides([3.0, 4.0, 5.0]));
        let needle = unbroken(Sides([1.0, 5.0, 2.0]));
        assert!(needle.area() > 0.0 && needle.cotangents().iter().all(|c| c.abs() < 1e4), "{needle:?}");
    }

    #[test]
    fn a_metric_with_broken_triangles_is_laid_out() {
        let shape = shapes::torus(3, 1500);
        let mesh = shape.mesh();
        let mut length = Metric::from_points(&mesh, &shape.points).lengths().clone();
        for e in mesh.edges().step_by(50) {
            length[e] *= 3.0;
        }
        let seams = Seams::new(&mesh, &length, &[VertexId(0)], Watch::NONE).unwrap();
        let map = Lscm::new(&mesh, &Metric::new(length), &seams.cut).unwrap();
        assert!(map.position.iter().all(|z| z.is_finite()));
    }

    #[test]
    fn a_closed_surface_that_is_not_cut_is_refused() {
        let shape = shapes::sphere(100);
        let mesh = shape.mesh();
        let uncut = EdgeData::constant(mesh.edge_count(), false);
        let refused = Lscm::new(&mesh, &Metric::from_points(&mesh, &shape.points), &uncut);
        assert!(matches!(refused, Err(LscmError::NoDisk { euler: 2, islands: 1 })));
    }
}
