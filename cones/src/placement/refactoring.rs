//! The iterative method as published, with a factorization for each level.

use geom::{PoissonError, VertexData, VertexId, Watch};

use super::iterative::highest_and_lowest;
use super::separation::Separation;
use crate::field::{ConformalFactor, Operators};

/// The cones of [`Placement::Iterative`](crate::Placement::Iterative), with a factorization for each level but the first: the
/// method of Ben-Chen, Gotsman & Bunin (2008) as published, for comparison.
///
/// # Errors
/// If a Laplacian cannot be factored.
pub(crate) fn iterative_refactoring(
    operators: &Operators,
    count: usize,
    watch: Watch,
) -> Result<Vec<VertexId>, PoissonError> {
    let source: VertexData<f64> = operators.curvature.iter().map(|k| -k).collect();
    let mut cones: Vec<VertexId> = Vec::new();
    let mut phi = ConformalFactor::new(operators).phi;
    while cones.len() < count && !watch.stops_at(cones.len() as f64 / count as f64) {
        let new = highest_and_lowest(&phi, &Separation::new(operators, &cones));
        if new.is_empty() {
            break;
        }
        cones.extend(new);
        if cones.len() < count {
            let part = |done: usize| done as f64 / count as f64;
            let watch = watch.within(part(cones.len() - 1), part(cones.len()));
            phi =
                operators.refactored(&cones, watch.within(0.0, 0.9))?.solve_watched(&source, watch.within(0.9, 1.0))?;
        }
    }
    cones.truncate(count);
    Ok(cones)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::placement::iterative::iterative;
    use geom::{Metric, shapes};

    #[test]
    fn reusing_the_factor_picks_the_cones_that_refactoring_picks() {
        for shape in [shapes::hare(1500), shapes::torus(2, 1200), shapes::part(1500), shapes::terrain(900, 4)] {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            assert_eq!(
                iterative(&operators, 16, Watch::NONE),
                iterative_refactoring(&operators, 16, Watch::NONE).unwrap()
            );
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
            let surface = geom::prepare(&model, geom::Weld::Auto).unwrap().surfaces.swap_remove(0);
            let operators = Operators::new(&surface.mesh, &surface.metric()).unwrap();
            assert_eq!(
                iterative(&operators, 32, Watch::NONE),
                iterative_refactoring(&operators, 32, Watch::NONE).unwrap(),
                "{name}"
            );
        }
    }

    #[test]
    fn where_there_is_no_room_there_are_fewer_cones() {
        let mesh = geom::Mesh::new(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]).unwrap();
        let operators = Operators::new(&mesh, &Metric::new(vec![1.0; 6].into())).unwrap();
        assert_eq!(iterative_refactoring(&operators, 9, Watch::NONE).unwrap().len(), 4);
    }
}
