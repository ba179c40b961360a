//! Handles opened along short loops, so that few cones are enough.
//!
//! A closed surface of genus g has 4π (g - 1) of curvature too little, which cones must bring: many cones, or bad ones. Opened along
//! g loops that do not separate ([`geom::handle_loops`]) it has boundaries instead, and every vertex there may take curvature. u is constant
//! along each, the same on both sides, so that both sides of the cut have equal lengths: a seam like any other, but not a rigid one.
//! Loops take the place of the seams that a handle needs anyway.

use std::collections::HashSet;
use std::sync::Arc;

use geom::{Interrupted, Watch};

use super::refined::{OpenedHandles, Ready};
use crate::field;
use crate::flatten::{Chain, seam_lengths};

/// What an edge of a loop that is known counts for, as a share of its length: no other loop is as short then.
const KNOWN: f64 = 1e-4;

/// Opens the handles of a surface, along loops that are known where some are. Halfedges and triangles keep their numbers.
///
/// # Errors
/// If it is stopped.
pub(crate) fn open_handles(ready: Ready, watch: Watch) -> Result<Ready, Interrupted> {
    let mut lengths = seam_lengths(&ready.surface, &ready.metric);
    if let Some(straight) = &ready.straight {
        ready.surface.mesh.edges().filter(|&e| straight.is_loop(e)).for_each(|e| lengths[e] *= KNOWN);
    }
    let Some((island, of_vertex)) = field::open_handles(&ready.surface.mesh, &lengths, watch)? else {
        return Ok(ready);
    };
    let mut opened = ready.island(island, ready.shape);
    let closed = ready.way.is_some().then(|| Arc::new(ready.surface.mesh));
    let now = &opened.surface.mesh;
    let mut loops = Vec::new();
    let mut is_known = HashSet::new();
    for around in now.boundary_loops() {
        let Some(k) = of_vertex[now.tail(around[0])] else { continue };
        if is_known.insert(k) {
            let vertices = around.iter().chain(&around[..1]).map(|&h| now.tail(h)).collect();
            loops.push(Chain { vertices, edges: around.iter().map(|&h| now.edge(h)).collect() });
        }
    }
    opened.handles = OpenedHandles { loops, of_vertex: Some(of_vertex), closed };
    Ok(opened)
}
