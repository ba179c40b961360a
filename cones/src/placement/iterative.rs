//! Cones one level after the other, with a solve for each level.
//!
//! [`iterative`] is the method of Ben-Chen, Gotsman & Bunin (2008, "Conformal flattening by curvature prescription and metric
//! scaling"), which the paper compares with: take the highest and the lowest point of the conformal factor for cones, solve
//! again with φ = 0 at all cones, and so on. As published each level factors the Laplacian without the rows of the cones
//! ([`iterative_refactoring`](super::refactoring)). One factorization for all levels gives the same φ (see
//! [`PinnedFactor`]); whoever compares methods should compare with both. [`greedy`] takes one cone a level, where |φ| is largest, as boundary first
//! flattening does (Sawhney & Crane 2017).
//!
//! Cones keep a distance of three edges where there is room, as everywhere here; what is published does not say.

use geom::{VertexData, VertexId, Watch};

use super::separation::Separation;
use crate::field::{Operators, PinnedFactor};

/// The first `count` cones of the iterative method; fewer only where there is no room for more. One factorization serves
/// all levels.
pub(crate) fn iterative(operators: &Operators, count: usize, watch: Watch) -> Vec<VertexId> {
    grow(PinnedFactor::new(operators), count, watch, highest_and_lowest)
}

/// The first `count` cones where |φ| is largest, one after the other.
pub(crate) fn greedy(operators: &Operators, count: usize, watch: Watch) -> Vec<VertexId> {
    grow(PinnedFactor::new(operators), count, watch, |phi, separation| {
        extreme(phi, separation, f64::abs).into_iter().collect()
    })
}

/// Adds cones by a rule on the pinned conformal factor, level by level.
fn grow(
    mut pinned: PinnedFactor,
    count: usize,
    watch: Watch,
    rule: impl Fn(&VertexData<f64>, &Separation) -> Vec<VertexId>,
) -> Vec<VertexId> {
    while pinned.cones().len() < count && !watch.stops_at(pinned.cones().len() as f64 / count as f64) {
        let separation = Separation::new(pinned.operators(), pinned.cones());
        let new = rule(&pinned.factor(), &separation);
        if new.is_empty() {
            break;
        }
        pinned.add(&new);
    }
    let mut cones = pinned.cones().to_vec();
    cones.truncate(count);
    cones
}

/// The highest point of φ and the lowest.
pub(crate) fn highest_and_lowest(phi: &VertexData<f64>, separation: &Separation) -> Vec<VertexId> {
    let highest = extreme(phi, separation, |phi| phi);
    let lowest = extreme(phi, separation, |phi| -phi);
    highest.into_iter().chain(lowest.filter(|_| highest != lowest)).collect()
}

/// Where a measure of φ is largest among vertices that may be cones; the first of equals.
fn extreme(phi: &VertexData<f64>, separation: &Separation, measure: impl Fn(f64) -> f64) -> Option<VertexId> {
    let open = phi.iter_ids().filter(|(v, _)| separation.admits_another(*v)).map(|(v, phi)| (v, measure(*phi)));
    open.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(v, _)| v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Metric, shapes};

    fn surfaces() -> [Operators; 4] {
        let shapes = [shapes::hare(1500), shapes::torus(2, 1200), shapes::part(1500), shapes::terrain(900, 4)];
        shapes.map(|shape| {
            let mesh = shape.mesh();
            Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap()
        })
    }

    #[test]
    fn both_rules_are_nested_and_take_inner_vertices() {
        for operators in surfaces() {
            for rule in [iterative, greedy] {
                let all = rule(&operators, 12, Watch::NONE);
                assert_eq!(all.len(), 12);
                assert_eq!(rule(&operators, 5, Watch::NONE), all[..5]);
                assert!(all.iter().all(|&v| !operators.mesh.is_boundary_vertex(v)));
            }
        }
    }

    #[test]
    fn where_there_is_no_room_there_are_fewer_cones() {
        let mesh = geom::Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]).unwrap();
        let operators = Operators::new(&mesh, &Metric::new(vec![1.0; 6].into())).unwrap();
        assert_eq!(iterative(&operators, 9, Watch::NONE).len(), 4);
        assert_eq!(greedy(&operators, 9, Watch::NONE).len(), 4);
    }
}
