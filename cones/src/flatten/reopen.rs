//! The same map opened along other seams.
//!
//! The two sides of a seam of a cone metric are a rigid motion apart, so that the seams may go anywhere between the cones: opened
//! along old and new seams the layout falls into pieces, and glued along the old ones, each piece moved as a whole, these
//! are the layout with the new seams. Nothing is solved again. O(F).

use geom::{CutMesh, EdgeData, EdgeId, HalfedgeId, Id, Mesh, kruskal};
use num_complex::Complex64;

use super::layout::{Layout, SeamRotations};

/// The two sides of an old seam meet if they are no farther apart, as a share of the layout's extent,
const MEETS: f64 = 1e-10;
/// and of their edge's length, so that no triangle beside it changes.
const MEETS_ON_EDGE: f64 = 1e-6;

/// z goes to `turn` · z + `shift`.
#[derive(Clone, Copy)]
struct Motion {
    turn: Complex64,
    shift: Complex64,
}

impl Motion {
    fn of(&self, z: Complex64) -> Complex64 {
        self.turn * z + self.shift
    }
}

impl Layout {
    /// The same map opened along the edges of `cut`, which leave one disk, in place of those of `before`; none where the old
    /// seams' sides do not meet.
    pub(crate) fn reopened(&self, mesh: &Mesh, before: &EdgeData<bool>, cut: &EdgeData<bool>) -> Option<Self> {
        let both: EdgeData<bool> = before.iter().zip(cut.iter()).map(|(a, b)| *a || *b).collect();
        let pieces = CutMesh::open(mesh, &both);
        let piece = |h: HalfedgeId| pieces.island(mesh.face(h));
        let glued: Vec<(HalfedgeId, HalfedgeId)> = mesh
            .edges()
            .filter(|&e| before[e] && !cut[e])
            .filter_map(|e| Some((mesh.halfedge(e), mesh.twin(mesh.halfedge(e))?)))
            .collect();
        let motion = self.motions(mesh, pieces.island_count(), &glued, piece)?;
        let place = |h: HalfedgeId| motion[piece(h) as usize].of(self.corner(h));
        let extent = self.extent();
        let meets = |&(h, g): &(HalfedgeId, HalfedgeId)| {
            let most = (MEETS * extent).min(MEETS_ON_EDGE * self.vector(mesh, h).norm());
            [(h, mesh.next(g)), (mesh.next(h), g)].iter().all(|&(a, b)| (place(a) - place(b)).norm() <= most)
        };
        if !glued.iter().all(meets) {
            return None;
        }
        let opened = CutMesh::open(mesh, cut);
        let mut position = vec![Complex64::ZERO; opened.wedge_count()];
        mesh.halfedges().for_each(|h| position[opened.wedge(h).index()] = place(h));
        let seam_rotation = SeamRotations::new(mesh, cut, |h, g| {
            let [here, there] = [h, g].map(|h| motion[piece(h) as usize].turn);
            here * self.seam_rotation[h] * there.conj()
        });
        Some(Self { seam_rotation, cut: opened, position })
    }

    fn vector(&self, mesh: &Mesh, h: HalfedgeId) -> Complex64 {
        self.corner(mesh.next(h)) - self.corner(h)
    }

    fn extent(&self) -> f64 {
        let range = |part: fn(&Complex64) -> f64| {
            let bounds = self
                .position
                .iter()
                .map(part)
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            bounds[1] - bounds[0]
        };
        range(|z| z.re).max(range(|z| z.im))
    }

    /// What moves each piece so that all are glued along these edges; none if they do not hang together. Pieces follow each other
    /// over the longest edges.
    fn motions(
        &self,
        mesh: &Mesh,
        count: usize,
        glued: &[(HalfedgeId, HalfedgeId)],
        piece: impl Fn(HalfedgeId) -> u32,
    ) -> Option<Vec<Motion>> {
        let mut longest: Vec<(f64, EdgeId, [HalfedgeId; 2])> =
            glued.iter().map(|&(h, g)| (self.vector(mesh, h).norm_sqr(), mesh.edge(h), [h, g])).collect();
        longest.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let tree = kruskal(count, longest.iter().map(|(_, _, sides)| (*sides, sides.map(&piece))));
        let mut beside: Vec<Vec<[HalfedgeId; 2]>> = vec![Vec::new(); count];
        for [h, g] in tree {
            beside[piece(h) as usize].push([h, g]);
            beside[piece(g) as usize].push([g, h]);
        }
        let mut motion: Vec<Option<Motion>> = vec![None; count];
        let first = mesh.halfedges().next()?;
        let mut waiting = vec![(piece(first), Motion { turn: Complex64::ONE, shift: Complex64::ZERO })];
        while let Some((p, at)) = waiting.pop() {
            if motion[p as usize].replace(at).is_some() {
                return None;
            }
            for &[h, g] in &beside[p as usize] {
                if motion[piece(g) as usize].is_none() {
                    let turn = at.turn * self.seam_rotation[h];
                    let turn = turn / turn.norm();
                    let middle = |h: HalfedgeId| 0.5 * (self.corner(h) + self.corner(mesh.next(h)));
                    waiting.push((piece(g), Motion { turn, shift: at.of(middle(h)) - turn * middle(g) }));
                }
            }
        }
        motion.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flatten::flattened::Flattened;
    use crate::flatten::{Seams, Variation};
    use geom::{VertexId, Watch, shapes};

    fn cases() -> Vec<(shapes::Shape, Vec<VertexId>)> {
        let cones = |count: u32, step: u32| (0..count).map(|k| VertexId(7 + k * step)).collect();
        vec![
            (shapes::hare(900), cones(12, 70)),
            (shapes::torus(2, 800), cones(6, 100)),
            (shapes::terrain(900, 2), cones(5, 150)),
        ]
    }

    #[test]
    fn along_other_seams_all_triangles_keep_their_shape_and_seams_their_rotation() {
        for (shape, cones) in cases() {
            let Flattened { mesh, metric, seams, layout, .. } = Flattened::new(&shape, &cones);
            for number in 0..4 {
                let variation = Variation { strength: 2.0, number, angle: None };
                let other = Seams::varied(&mesh, metric.lengths(), &cones, variation, Watch::NONE).unwrap();
                let opened = layout.reopened(&mesh, &seams.cut, &other.cut).expect("the sides of a seam are congruent");
                assert!(opened.cut.is_disk() && opened.position.len() == opened.cut.wedge_count());
                for h in mesh.halfedges() {
                    let [before, after] = [&layout, &opened].map(|layout| layout.vector(&mesh, h));
                    assert!((after.norm() / before.norm() - 1.0).abs() < 1e-7);
                    let Some(g) = mesh.twin(h) else { continue };
                    let there = -opened.vector(&mesh, g);
                    assert!((after - opened.seam_rotation[h] * there).norm() < 1e-9 * layout.extent());
                    assert!(other.cut[mesh.edge(h)] || opened.seam_rotation[h] == Complex64::ONE);
                }
            }
        }
    }

    #[test]
    fn back_along_the_first_seams_it_is_the_same_map_moved() {
        for (shape, cones) in cases() {
            let Flattened { mesh, metric, seams, layout, .. } = Flattened::new(&shape, &cones);
            let variation = Variation { strength: 2.0, number: 1, angle: None };
            let other = Seams::varied(&mesh, metric.lengths(), &cones, variation, Watch::NONE).unwrap();
            let there = layout.reopened(&mesh, &seams.cut, &other.cut).unwrap();
            let back = there.reopened(&mesh, &other.cut, &seams.cut).unwrap();
            let (h, extent) = (mesh.halfedges().next().unwrap(), layout.extent());
            let turn = back.vector(&mesh, h) / layout.vector(&mesh, h);
            for g in mesh.halfedges() {
                let [before, after] = [(&layout, turn), (&back, Complex64::ONE)]
                    .map(|(layout, turn)| turn * (layout.corner(g) - layout.corner(h)));
                assert!((before - after).norm() < 1e-8 * extent);
            }
        }
    }

    #[test]
    fn sides_that_do_not_meet_are_not_glued() {
        let (shape, cones) = &cases()[0];
        let Flattened { mesh, metric, seams, mut layout, .. } = Flattened::new(shape, cones);
        let variation = Variation { strength: 2.0, number: 1, angle: None };
        let other = Seams::varied(&mesh, metric.lengths(), cones, variation, Watch::NONE).unwrap();
        let is_glued = |e: &EdgeId| seams.cut[*e] && !other.cut[*e];
        let e = mesh.edges().find(is_glued).expect("the trees differ");
        let moved = layout.cut.wedge(mesh.halfedge(e));
        let step = 0.01 * layout.vector(&mesh, mesh.halfedge(e));
        layout.position[moved.index()] += step;
        assert!(layout.reopened(&mesh, &seams.cut, &other.cut).is_none());
        assert!(layout.reopened(&mesh, &seams.cut, &seams.cut).is_some(), "where nothing is glued nothing has to meet");
    }
}
