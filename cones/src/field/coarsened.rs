//! A surface on few of its vertices, before anything is asked of it: what takes the time of a [coarse level](super::coarse), and needs no
//! factor, so that it can be found while the surface's Laplacian is factored.

use geom::{Interrupted, Mesh, Metric, Simplified, VertexData, VertexId, Watch, simplified};

/// A vertex with so much curvature, in radians, is kept as one of twice its area is, with more by its square: corners stay where
/// they are.
const SHARP: f64 = 0.3;

/// A surface on few of its vertices, with their weights, shares of the surface's vertices and curvatures.
pub(crate) type Coarsened = Simplified<3>;

/// An intrinsic Delaunay surface on `count` of its vertices, or more where others cannot be taken out; it is given with the weight and the
/// curvature of each vertex, and the share of a finer surface's vertices that it stands for where it is a coarse level itself.
///
/// # Errors
/// If the watch has said stop.
pub(super) fn coarsened(
    (mesh, metric): (&Mesh, &Metric),
    (weight, spread, curvature): (&VertexData<f64>, Option<&VertexData<f64>>, &VertexData<f64>),
    count: usize,
    watch: Watch,
) -> Result<Coarsened, Interrupted> {
    let even = || VertexData::constant(mesh.vertex_count(), 1.0 / mesh.vertex_count() as f64);
    let spread = spread.cloned().unwrap_or_else(even);
    simplified(mesh, metric, [weight, &spread, curvature], worth(curvature), count, watch)
}

/// The same as [`coarsened`] makes of the surface that `more` of its vertices were left of, which has this curvature.
///
/// # Errors
/// If the watch has said stop.
pub(super) fn coarsened_further(
    more: &Coarsened,
    curvature: &VertexData<f64>,
    count: usize,
    watch: Watch,
) -> Result<Coarsened, Interrupted> {
    more.further(worth(curvature), count, watch)
}

fn worth(curvature: &VertexData<f64>) -> impl Fn(VertexId) -> f64 {
    |v| 1.0 + (curvature[v] / SHARP).powi(2)
}
