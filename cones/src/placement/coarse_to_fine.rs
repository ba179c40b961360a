//! Cones from a coarse level, polished on the surface itself.
//!
//! The whole search is made on the [coarse level](super::level), where solves cost next to nothing. Its cones are vertices of
//! the surface, so the surface's energy model tells at once how good they are there: a solve for each. Then, for each cone, the
//! best vertex round it that the columns of all cones promise is solved for too, and cones are exchanged with these.

use geom::{Interrupted, PoissonError, VertexId};

use super::Ground;
use super::energy_model::{ConeSet, EnergyModel};
use super::exchange::exchange;
use super::level::CoarseLevel;
use super::nested::Nested;
use super::pursuit::pursuit;
use super::refined::{refined, within_comfort};
use super::swap_table::SwapTable;

/// A cone is looked for so far round where the coarse level has it, in spacings of that.
const REACH: f32 = 1.5;
/// So often.
const ROUNDS: usize = 1;

/// The best set of so many cones found; none where the level has too few vertices, or the surface has not what it takes there.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn refined_from(ground: Ground, level: &CoarseLevel, count: usize) -> Result<Option<ConeSet>, PoissonError> {
    let coarse = refined(&mut level.energy_model(ground.watch.within(0.0, 0.5)), count);
    let mut model = ground.energy_model()?;
    let set = polished(&mut model, level, &coarse);
    Ok((set.cones.len() == count && (set.shortfall == 0.0 || coarse.shortfall > 0.0)).then_some(set))
}

/// A nested order of so many cones on the coarse level of a surface, in the level's vertices; on the surface itself where it has
/// none.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn coarse_order(ground: Ground, count: usize) -> Result<Nested, Interrupted> {
    let mut model = match ground.level()? {
        Some(level) => level.energy_model(ground.watch),
        None => ground.energy_model()?,
    };
    Ok(pursuit(&mut model, count))
}

/// A coarse level's cones, moved to where they are best on the surface.
pub(crate) fn polished(model: &mut EnergyModel, level: &CoarseLevel, coarse: &ConeSet) -> ConeSet {
    let cones = level.of_surface(&coarse.cones);
    let reach = REACH * level.spacing();
    model.add(&cones);
    within_comfort(model, |model| {
        let mut set = model.fit(&cones);
        for _ in 0..ROUNDS {
            let new = candidates(model, &set, reach);
            model.add(&new);
            set = exchange(model, set);
        }
        set
    })
}

/// For each cone the best vertex round it that was not solved for.
fn candidates(model: &EnergyModel, set: &ConeSet, reach: f32) -> Vec<VertexId> {
    if model.is_over() {
        return Vec::new();
    }
    SwapTable::new(model, set).proposals_within(reach).into_iter().map(|swap| swap.coming).collect()
}
