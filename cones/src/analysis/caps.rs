//! Surfaces whose small holes are filled for computing, and the way back.
//!
//! Cones, curvatures, seams and the flat metric are found on the surface with *caps* ([`geom::fill_holes`]) as if there were no holes: the metric is
//! flat on a cap, too, so a turn round the hole is none in the plane and the hole's rim closes without a seam. Once the surface is laid out, caps are taken
//! out of the layout again. Nothing that comes after knows of them: what folds over, overlaps, is cut, packed, measured and written is the surface alone, with
//! a boundary where it has one, only that an island may then have holes. Since caps have no vertices of their own, cones are vertices of the
//! surface; vertices, halfedges and triangles have the same numbers on both.
//!
//! An edge at a cap, or on it, is free for a seam: what runs through a hole is not there.

use std::collections::HashSet;

use geom::{
    CutMesh, EdgeData, EdgeId, HalfedgeId, Id, Interrupted, Mesh, Metric, VertexData, VertexId, Watch, edges_at,
};
use num_complex::Complex64;

use super::component::Component;
use super::filled::whole_holes;
use crate::cut::SeamPlan;
use crate::flatten::{Layout, Scaling, SeamError, Seams};
use crate::uv::UvMap;

/// Sides of a seam that are no farther apart than this share of its edge's length lie at one place.
const SHUT: f64 = 1e-6;

impl Component {
    /// How many small holes are filled.
    pub(super) fn filled_holes(&self) -> usize {
        self.filled.as_ref().map_or(0, |_| whole_holes(&self.surface.mesh, &self.holes).len())
    }

    /// How many small holes are not filled, and seams of a layout run to them.
    pub(super) fn holes_at(&self, seams: &Seams, layout: &Layout) -> usize {
        if self.filled.is_some() {
            return 0;
        }
        let mesh = &self.surface.mesh;
        let at = |h| [layout.corner(h).re, layout.corner(h).im];
        let is_open = |e: EdgeId| seams.cut[e] && !is_shut(mesh, at, e);
        let is_reached = |&h: &HalfedgeId| edges_at(mesh, mesh.tail(h)).any(|(e, _)| is_open(e));
        whole_holes(mesh, &self.holes).iter().filter(|around| around.iter().any(is_reached)).count()
    }

    /// What is computed with: its mesh and edge lengths, with caps where holes are filled.
    pub(crate) fn whole(&self) -> (&Mesh, &Metric) {
        match &self.filled {
            Some(filled) => (&filled.mesh, &filled.metric),
            None => (&self.surface.mesh, &self.metric),
        }
    }

    /// The seams of what is computed with.
    ///
    /// # Errors
    /// As [`SeamPlan::cut`].
    pub(super) fn cut_whole(&self, plan: &SeamPlan, cones: &[VertexId], watch: Watch) -> Result<Seams, SeamError> {
        match &self.filled {
            Some(filled) => {
                plan.on_filled(&self.surface.mesh, (&filled.mesh, &filled.metric)).cut(&filled.mesh, cones, watch)
            }
            None => plan.cut(&self.surface.mesh, cones, watch),
        }
    }

    /// Those of the surface alone.
    pub(super) fn own_seams(&self, whole: &Seams, plan: &SeamPlan, cones: &[VertexId]) -> Seams {
        let Some(filled) = &self.filled else { return whole.clone() };
        let mesh = &self.surface.mesh;
        let is_cut = |e| !mesh.is_boundary_edge(e) && whole.cut[filled.mesh.edge(mesh.halfedge(e))];
        let cut: EdgeData<bool> = mesh.edges().map(is_cut).collect();
        let cones: HashSet<VertexId> = cones.iter().copied().collect();
        let is_end = mesh.vertices().map(|v| cones.contains(&v) || mesh.is_boundary_vertex(v)).collect();
        Seams::of_cut(mesh, plan.lengths(), cut, &is_end)
    }

    /// The surface laid out, with the seams of what is computed with, and its own.
    ///
    /// # Errors
    /// If the watch has said stop.
    pub(super) fn lay_out(
        &self,
        scaling: &mut Scaling,
        (whole, own): (&Seams, &Seams),
        watch: Watch,
    ) -> Result<Layout, Interrupted> {
        let layout = Layout::new(self.whole().0, scaling, &whole.cut, watch)?;
        if self.filled.is_none() {
            return Ok(layout);
        }
        let mesh = &self.surface.mesh;
        let cut = CutMesh::open(mesh, &own.cut);
        let mut position = vec![Complex64::ZERO; cut.wedge_count()];
        for h in mesh.halfedges() {
            position[cut.wedge(h).index()] = layout.corner(h);
        }
        let seam_rotation = layout.seam_rotation.of_cut(mesh, &own.cut);
        let own = Layout { cut, position, seam_rotation };
        scaling.rim_angles = rim_angles(mesh, self.whole().0, &own);
        Ok(own)
    }
}

impl Component {
    /// Closes seams of a map that end at filled holes or at flat vertices, from there on, as long as both sides lie at one place: what was put together
    /// anew is open at all holes that it was cut through, and need not be. Seams that are given stay.
    pub(super) fn shut(&self, map: &mut UvMap, cones: &[VertexId], given: &EdgeData<bool>) {
        if self.filled.is_none() {
            return;
        }
        let mesh = &self.surface.mesh;
        // What seams end at: vertices, and each hole as one.
        let mut node: VertexData<VertexId> = mesh.vertices().collect();
        let mut stays: VertexData<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
        for around in whole_holes(mesh, &self.holes) {
            for v in around.iter().map(|&h| mesh.tail(h)) {
                node[v] = mesh.tail(around[0]);
                stays[v] = false;
            }
        }
        cones.iter().for_each(|&v| stays[node[v]] = true);
        let mut seams_at: VertexData<Vec<EdgeId>> = VertexData::constant(mesh.vertex_count(), Vec::new());
        for e in mesh.edges().filter(|&e| map.cut[e]) {
            mesh.ends(e).into_iter().for_each(|v| seams_at[node[v]].push(e));
        }
        let is_end = |seams_at: &VertexData<Vec<EdgeId>>, v: VertexId| seams_at[v].len() == 1 && !stays[v];
        let mut ends: Vec<VertexId> = mesh.vertices().filter(|&v| is_end(&seams_at, v)).collect();
        while let Some(end) = ends.pop() {
            let Some(e) = seams_at[end].pop().filter(|&e| !given[e] && is_shut(mesh, |h| map.position[h], e)) else {
                continue;
            };
            map.cut[e] = false;
            let Some(other) = mesh.ends(e).map(|v| node[v]).into_iter().find(|&v| v != end) else { continue };
            seams_at[other].retain(|&seam| seam != e);
            if is_end(&seams_at, other) {
                ends.push(other);
            }
        }
    }
}

/// Whether both sides of an edge lie at one place.
fn is_shut(mesh: &Mesh, at: impl Fn(HalfedgeId) -> [f64; 2], e: EdgeId) -> bool {
    let h = mesh.halfedge(e);
    let Some(g) = mesh.twin(h) else { return false };
    let apart = |a: HalfedgeId, b: HalfedgeId| {
        let ([x, y], [z, w]) = (at(a), at(b));
        (x - z).hypot(y - w)
    };
    apart(h, mesh.next(g)).max(apart(mesh.next(h), g)) <= SHUT * apart(h, mesh.next(h))
}

/// The angle that a surface has in a layout at each vertex round a hole that was filled.
fn rim_angles(mesh: &Mesh, filled: &Mesh, layout: &Layout) -> Vec<(VertexId, f64)> {
    let at_hole = mesh.halfedges().filter(|&h| mesh.twin(h).is_none() && filled.twin(h).is_some());
    let angle = |h: HalfedgeId| {
        let [at, next, last] = [h, mesh.next(h), mesh.prev(h)].map(|h| layout.corner(h));
        ((last - at) * (next - at).conj()).arg()
    };
    at_hole.map(|h| (mesh.tail(h), mesh.outgoing(mesh.tail(h)).map(angle).sum())).collect()
}
