//! A coarse level of a surface: the same, roughly, on few of its vertices.
//!
//! The surface is simplified intrinsically ([`geom::simplified`]), so that a coarse level has the same topology and nothing of it
//! depends on where it is in space. Areas and curvatures of vertices that are taken out go to their neighbours by cotangent
//! weights, as they do when the vertex is eliminated from Lφ = K^T - K: what is solved on the coarse level is near to the
//! solution on the fine one at the vertices that both have, and ⟨x, y⟩ weighted by area near to the fine product.
//! What is spread evenly over the fine vertices is spread in the shares that they left.

use geom::{Mesh, MeshError, PoissonError, Simplified, VertexId, Watch};

use super::coarsened::{coarsened, coarsened_further};
use super::operators::Operators;

/// The operators of a coarse level with `count` of a surface's vertices, or more where others cannot be taken out, and which
/// vertices they are. Takes about half the time of factoring the surface's Laplacian.
///
/// # Errors
/// If the coarse Laplacian cannot be factored, or the watch has said stop.
pub(crate) fn coarse_level(
    fine: &Operators,
    count: usize,
    watch: Watch,
) -> Result<(Operators, Vec<VertexId>), PoissonError> {
    let Operators { mesh, metric, weight, spread, curvature, ahead, .. } = fine;
    let ahead = ahead.as_ref().filter(|(asked, _)| *asked >= count);
    let Simplified { triangulation, metric, vertex, weights, .. } = match ahead {
        Some((asked, coarsened)) if *asked == count => coarsened.clone(),
        Some((_, more)) => coarsened_further(more, curvature, count, watch.within(0.0, 0.8))?,
        None => coarsened((mesh, metric), (weight, spread.as_ref(), curvature), count, watch.within(0.0, 0.8))?,
    };
    let mesh = Mesh::from_triangulation(triangulation)
        .unwrap_or_else(|error: MeshError| unreachable!("a manifold one stays so: {error}"));
    Ok((Operators::of_coarse((mesh, metric), (fine, &vertex), weights, watch.within(0.8, 1.0))?, vertex))
}
