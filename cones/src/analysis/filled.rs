//! Surfaces whose small holes are filled for computing; [`caps`](super::caps) has what becomes of them.

use std::collections::HashSet;

use geom::{HalfedgeId, Mesh, Metric, fill_holes, small_holes};

use super::refined::Ready;

/// A surface with caps.
#[derive(Debug)]
pub(crate) struct Filled {
    pub(crate) mesh: Mesh,
    pub(crate) metric: Metric,
}

impl Ready {
    /// The same, its small holes marked.
    pub(super) fn with_holes_marked(mut self, size: f64) -> Self {
        self.holes = small_holes(&self.surface.mesh, &self.metric, size).into_iter().flatten().collect();
        self
    }
}

impl Filled {
    /// A surface with a cap at each loop that is marked all round; none if there is none.
    pub(super) fn new(mesh: &Mesh, metric: &Metric, points: &[[f64; 3]], marked: &HashSet<HalfedgeId>) -> Option<Self> {
        let holes = whole_holes(mesh, marked);
        let (mesh, metric) = (!holes.is_empty()).then(|| fill_holes(mesh, metric, points, &holes))?;
        Some(Self { mesh, metric })
    }
}

/// The loops that are marked all round.
pub(super) fn whole_holes(mesh: &Mesh, marked: &HashSet<HalfedgeId>) -> Vec<Vec<HalfedgeId>> {
    if marked.is_empty() {
        return Vec::new();
    }
    let mut holes = mesh.boundary_loops();
    holes.retain(|around| around.iter().all(|h| marked.contains(h)));
    holes
}
