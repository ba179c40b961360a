//! Cones one level after the other, with a solve for each level.
//!
//! [`iterative`] is the method of Ben-Chen, Gotsman & Bunin (2008, "Conformal flattening by curvature prescription and metric
//! scaling"), which the paper compares with: take the highest and the lowest point of the conformal factor for cones, solve
//! again with φ = 0 at all cones, and so on. As published each level factors the Laplacian without the rows of the cones:
//! [`iterative_refactoring`]. One factorization for all levels gives the same φ (see [`Pinned`]); whoever
//! compares methods should compare with both. [`greedy`] takes one cone a level, where |φ| is largest, as boundary first
//! flattening does (Sawhney & Crane 2017).
//!
//! Cones keep a distance of three edges where there is room, as everywhere here; what is published does not say.

use geom::{PoissonError, VertexData, VertexId};

use crate::crowd::Crowd;
use crate::factor::ConformalFactor;
use crate::operators::Operators;
use crate::pinned::Pinned;

/// The first `count` cones of the iterative method; fewer only where there is no room for more. One factorization serves
/// all levels.
pub fn iterative(operators: &Operators, count: usize) -> Vec<VertexId> {
    grow(Pinned::new(operators), count, highest_and_lowest)
}

/// The first `count` cones where |φ| is largest, one after the other.
pub fn greedy(operators: &Operators, count: usize) -> Vec<VertexId> {
    grow(Pinned::new(operators), count, |phi, crowd| extreme(phi, crowd, f64::abs).into_iter().collect())
}

/// As [`iterative`], with a factorization for each level but the first: the published method, for comparison.
///
/// # Errors
/// If a Laplacian cannot be factored.
pub fn iterative_refactoring(operators: &Operators, count: usize) -> Result<Vec<VertexId>, PoissonError> {
    let source: VertexData<f64> = operators.curvature.iter().map(|k| -k).collect();
    let mut cones: Vec<VertexId> = Vec::new();
    let mut phi = ConformalFactor::new(operators).phi;
    while cones.len() < count {
        let new = highest_and_lowest(&phi, &Crowd::new(operators, &cones));
        if new.is_empty() {
            break;
        }
        cones.extend(new);
        if cones.len() < count {
            phi = operators.refactored(&cones)?.solve(&source);
        }
    }
    cones.truncate(count);
    Ok(cones)
}

/// Adds cones by a rule on the pinned conformal factor, level by level.
fn grow(mut pinned: Pinned, count: usize, rule: impl Fn(&VertexData<f64>, &Crowd) -> Vec<VertexId>) -> Vec<VertexId> {
    while pinned.cones().len() < count {
        let crowd = Crowd::new(pinned.operators(), pinned.cones());
        let new = rule(&pinned.factor(), &crowd);
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
fn highest_and_lowest(phi: &VertexData<f64>, crowd: &Crowd) -> Vec<VertexId> {
    let highest = extreme(phi, crowd, |phi| phi);
    let lowest = extreme(phi, crowd, |phi| -phi);
    highest.into_iter().chain(lowest.filter(|_| highest != lowest)).collect()
}

/// Where a measure of φ is largest among vertices that may be cones; the first of equals.
fn extreme(phi: &VertexData<f64>, crowd: &Crowd, measure: impl Fn(f64) -> f64) -> Option<VertexId> {
    let open = phi.iter_ids().filter(|(v, _)| crowd.admits_another(*v)).map(|(v, phi)| (v, measure(*phi)));
    open.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(v, _)| v)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

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
    fn reusing_the_factor_picks_the_cones_that_refactoring_picks() {
        for operators in surfaces() {
            assert_eq!(iterative(&operators, 16), iterative_refactoring(&operators, 16).unwrap());
        }
    }

    #[test]
    fn so_it_does_on_scans_and_parts() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/meshes");
        if !folder.is_dir() {
            println!("skipped: there is no folder {}", folder.display());
            return;
        }
        for name in ["spot_2930.obj", "casting_5096.obj", "punctured_torus_4599.obj", "table1/fandisk_6475.obj"] {
            let model = geom::io::read(folder.join(name)).unwrap();
            let surface = geom::prepare(&model, false).unwrap().surfaces.swap_remove(0);
            let operators = Operators::new(&surface.mesh, &surface.metric()).unwrap();
            assert_eq!(iterative(&operators, 32), iterative_refactoring(&operators, 32).unwrap(), "{name}");
        }
    }

    #[test]
    fn both_rules_are_nested_and_take_inner_vertices() {
        for operators in surfaces() {
            for rule in [iterative, greedy] {
                let all = rule(&operators, 12);
                assert_eq!(all.len(), 12);
                assert_eq!(rule(&operators, 5), all[..5]);
                assert!(all.iter().all(|&v| !operators.mesh.is_boundary_vertex(v)));
            }
        }
    }

    #[test]
    fn where_there_is_no_room_there_are_fewer_cones() {
        let mesh = geom::Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]).unwrap();
        let operators = Operators::new(&mesh, &Metric::new(vec![1.0; 6].into())).unwrap();
        assert_eq!(iterative(&operators, 9).len(), 4);
        assert_eq!(iterative_refactoring(&operators, 9).unwrap().len(), 4);
        assert_eq!(greedy(&operators, 9).len(), 4);
    }
}
