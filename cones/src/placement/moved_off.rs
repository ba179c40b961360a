//! Cones moved away from where none may be: a seam leads to each, and some places no seam may cross.

use geom::{Interrupted, VertexId};

use super::Ground;
use super::energy_model::{ConeSet, EnergyModel};
use super::exchange::exchange;
use super::separation::Separation;

/// A cone that must move is tried at so many vertices round where it was,
const TRIED: usize = 24;
/// up to so many times as far as the nearest that is open.
const REACH: f32 = 2.5;

/// The cones, those at closed vertices moved to open ones near them that cost least, with the model that they were compared by; none where there is nothing to
/// move, or no open vertex. Up to [`TRIED`] solves for each cone that moves, one for each other.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn moved_off<'a>(
    ground: Ground<'a>,
    cones: &[VertexId],
    is_closed: impl Fn(VertexId) -> bool,
) -> Result<Option<(EnergyModel<'a>, ConeSet)>, Interrupted> {
    let mesh = &ground.operators.mesh;
    let is_open = |v: VertexId| !is_closed(v) && !mesh.is_boundary_vertex(v);
    let (mut moved, closed): (Vec<VertexId>, Vec<VertexId>) = cones.iter().partition(|&&v| !is_closed(v));
    if closed.is_empty() {
        return Ok(None);
    }
    let mut model = ground.energy_model()?.putting_columns_off();
    let mut tried = Vec::new();
    for cone in closed {
        let separation = Separation::new(ground.operators, &moved);
        let around = model.around(cone, f32::INFINITY, usize::MAX).into_iter();
        let open: Vec<(VertexId, f32)> = around.filter(|&(v, _)| is_open(v) && separation.admits_another(v)).collect();
        let Some(&(nearest, distance)) = open.first() else { return Ok(None) };
        moved.push(nearest);
        let near = open.partition_point(|&(_, other)| other <= REACH * distance);
        tried.extend(open[..near].iter().step_by(near.div_ceil(TRIED)).map(|(v, _)| *v));
    }
    model.add(&[&moved[..], &tried].concat());
    let set = exchange(&model, model.fit(&moved));
    Ok(Some((model, set)))
}

#[cfg(test)]
mod tests {
    use std::sync::OnceLock;

    use geom::{Metric, Watch, shapes};

    use super::*;
    use crate::field::{ConformalFactor, Operators};
    use crate::hierarchy::ConeHierarchy;
    use crate::placement::{Search, refined};

    #[test]
    fn cones_leave_closed_vertices_for_open_ones_that_cost_little() {
        let shape = shapes::hare(1500);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let hierarchy = ConeHierarchy::new(&operators, &ConformalFactor::new(&operators));
        let (terms, level) = (OnceLock::new(), OnceLock::new());
        let ground = Ground {
            operators: &operators,
            input: &mesh,
            hierarchy: &hierarchy,
            terms: &terms,
            level: &level,
            search: Search::Full,
            watch: Watch::NONE,
        };
        let best = refined(&mut ground.energy_model().unwrap(), 8);
        // The cone that bends most, and what is near it.
        let ball = ground.energy_model().unwrap().around(best.cones[0], f32::INFINITY, 60);
        let is_closed = |v: VertexId| ball.iter().any(|&(w, _)| v == w);
        let (model, set) = moved_off(ground, &best.cones, is_closed).unwrap().unwrap();
        assert_eq!((set.cones.len(), set.shortfall), (8, 0.0));
        assert!(set.cones.iter().all(|&v| !is_closed(v) && !mesh.is_boundary_vertex(v)));
        // Better than to move it to the nearest one, which is in the pool.
        let nearest =
            model.around(best.cones[0], f32::INFINITY, 200).into_iter().find(|&(v, _)| !is_closed(v)).unwrap();
        let others = best.cones.iter().copied().filter(|&v| !is_closed(v));
        let plain: Vec<VertexId> = others.chain([nearest.0]).collect();
        assert!(set.energy < model.fit(&plain).energy);
        assert!(set.log_scale_norm() < 2.0 * best.log_scale_norm());
        assert!(moved_off(ground, &set.cones, is_closed).unwrap().is_none(), "nothing is left to move");
        assert!(moved_off(ground, &set.cones, |_| true).unwrap().is_none(), "there is nowhere to go");
    }
}
