//! Handles opened along short loops, so that few cones are enough.
//!
//! A closed surface of genus g has 4π (g - 1) of curvature too little, which cones must bring: many cones, or bad ones. Opened along
//! g loops that do not separate ([`geom::handle_loops`]) it has boundaries instead, and every vertex there may take curvature. u is constant
//! along each, the same on both sides, so that both sides of the cut have equal lengths: a seam like any other, but not a rigid one.
//! Loops take the place of the seams that a handle needs anyway.

use geom::{EdgeData, Interrupted, VertexData, Watch, handle_loops, open_islands};

use super::refined::{OpenedHandles, Ready};
use crate::field::TiedLoops;
use crate::flatten::{Chain, seam_lengths};

/// Opens the handles of a surface. Halfedges and triangles keep their numbers.
///
/// # Errors
/// If it is stopped.
pub(crate) fn open_handles(ready: Ready, watch: Watch) -> Result<Ready, Interrupted> {
    let mesh = &ready.surface.mesh;
    let found = handle_loops(mesh, &seam_lengths(&ready.surface, &ready.metric), watch)?;
    if found.is_empty() {
        return Ok(ready);
    }
    let mut cut = EdgeData::constant(mesh.edge_count(), false);
    found.iter().flat_map(|around| &around.edges).for_each(|&e| cut[e] = true);
    let mut opened = ready.island(open_islands(mesh, &cut).swap_remove(0), ready.shape);
    let mut on_loop = VertexData::constant(mesh.vertex_count(), None);
    for (k, around) in (0..).zip(&found) {
        around.vertices.iter().for_each(|&v| on_loop[v] = Some(k));
    }
    let now = &opened.surface.mesh;
    let mut of_vertex: TiedLoops = VertexData::constant(now.vertex_count(), None);
    now.halfedges().for_each(|h| of_vertex[now.tail(h)] = on_loop[mesh.tail(h)]);
    let mut loops = Vec::new();
    let mut is_known = vec![false; found.len()];
    for around in now.boundary_loops() {
        let Some(k) = of_vertex[now.tail(around[0])] else { continue };
        if !std::mem::replace(&mut is_known[k as usize], true) {
            let vertices = around.iter().chain(&around[..1]).map(|&h| now.tail(h)).collect();
            loops.push(Chain { vertices, edges: around.iter().map(|&h| now.edge(h)).collect() });
        }
    }
    opened.handles = OpenedHandles { loops, of_vertex: Some(of_vertex) };
    Ok(opened)
}
