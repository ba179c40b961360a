//! A surface with its handles opened along short loops that do not separate it.

use geom::{EdgeData, Id, Interrupted, Mesh, Metric, OpenedIsland, PoissonError, VertexData, VertexId, Watch};
use geom::{handle_loops, open_islands};

use super::operators::{Operators, TiedLoops};

/// A surface opened, and for each vertex the number of the loop that it is on: both sides have the same. Nothing where there is no handle to open. Halfedges and
/// triangles keep their numbers.
///
/// # Errors
/// If it is stopped.
pub(crate) fn open_handles(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    watch: Watch,
) -> Result<Option<(OpenedIsland, TiedLoops)>, Interrupted> {
    let found = handle_loops(mesh, lengths, watch)?;
    if found.is_empty() {
        return Ok(None);
    }
    let mut cut = EdgeData::constant(mesh.edge_count(), false);
    found.iter().flat_map(|around| &around.edges).for_each(|&e| cut[e] = true);
    let mut on_loop = VertexData::constant(mesh.vertex_count(), None);
    for (k, around) in (0..).zip(&found) {
        around.vertices.iter().for_each(|&v| on_loop[v] = Some(k));
    }
    let island = open_islands(mesh, &cut).swap_remove(0);
    let opened = &island.mesh;
    let mut of_vertex: TiedLoops = VertexData::constant(opened.vertex_count(), None);
    opened.halfedges().for_each(|h| of_vertex[opened.tail(h)] = on_loop[mesh.tail(island.halfedge[h])]);
    Ok(Some((island, of_vertex)))
}

/// A coarse level with its handles opened, and which of its vertices each vertex is; nothing where there is no handle to open. What a vertex on a loop has is
/// shared between its two sides by their areas. It is a level of a surface of `fine` vertices.
///
/// # Errors
/// If the Laplacian cannot be factored, or the watch has said stop.
pub(crate) fn opened_level(
    coarse: &Operators,
    fine: usize,
    watch: Watch,
) -> Result<Option<(Operators, Vec<VertexId>)>, PoissonError> {
    let Operators { mesh: whole, metric, weight, spread: Some(spread), curvature, .. } = coarse else {
        return Ok(None);
    };
    let Some((island, tied)) = open_handles(whole, metric.lengths(), watch.within(0.0, 0.5))? else {
        return Ok(None);
    };
    let vertex = island.vertices_of(whole);
    let metric = Metric::new(island.edges_of(whole).iter().map(|&e| metric.length(e)).collect());
    let mesh = island.mesh;
    let [own, all] = [metric.vertex_areas(&mesh), coarse.metric.vertex_areas(whole)];
    let shared = |of: &VertexData<f64>| mesh.vertices().map(|v| of[vertex[v]] * own[v] / all[vertex[v]]).collect();
    let data = [shared(weight), shared(spread), vertex.iter().map(|&v| curvature[v]).collect()];
    let points: Option<Vec<[f64; 3]>> =
        coarse.points().map(|points| vertex.iter().map(|v| points[v.index()]).collect());
    let operators =
        Operators::of_opened_level((mesh, metric), (points.as_deref(), tied), data, fine, watch.within(0.5, 1.0))?;
    Ok(Some((operators, vertex.iter().copied().collect())))
}

#[cfg(test)]
mod tests {
    use super::super::coarse_level;
    use super::*;
    use geom::shapes;

    #[test]
    fn an_opened_level_is_the_same_surface_without_handles() {
        for genus in [1, 3] {
            let shape = shapes::torus(genus, 3000);
            let mesh = shape.mesh();
            let surface = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let (level, _) = coarse_level(&surface, 500, Watch::NONE).unwrap();
            let (opened, vertex) = opened_level(&level, mesh.vertex_count(), Watch::NONE).unwrap().unwrap();
            assert_eq!((opened.mesh.genus(), opened.mesh.boundary_loops().len()), (0, 2 * usize::from(genus)));
            assert!(opened.is_bordered() && !level.is_bordered());
            // The two sides of a loop share what its vertices have.
            let whole = |x: &VertexData<f64>| x.iter().sum::<f64>();
            assert!((whole(&opened.weight) - 1.0).abs() < 1e-12);
            let spread = [&level, &opened].map(|operators| operators.spread.as_ref().map_or(0.0, whole));
            assert!((spread[0] - spread[1]).abs() < 1e-12 && spread[0] > 0.0, "{spread:?}");
            for v in opened.mesh.vertices() {
                let share = opened.weight[v] / level.weight[vertex[v.index()]];
                assert_eq!(opened.mesh.is_boundary_vertex(v), share < 1.0 - 1e-12, "{share}");
            }
            assert!(opened_level(&opened, mesh.vertex_count(), Watch::NONE).unwrap().is_none());
        }
    }
}
