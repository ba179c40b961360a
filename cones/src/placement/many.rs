//! The best cones where they are many: what [`refined`](super::refined()) is for few.
//!
//! Moving cones one at a time takes a time that grows with the third power of their number. But far from each other cones hardly
//! matter to each other: so here many are added, moved or taken away at once, as long as they are apart, and one fit of all
//! curvatures tells whether that was good. Three kinds of steps:
//!
//! - *growth* adds cones where the energy would fall most, the best first and none near to another new one;
//! - *moves* take each cone to the vertex round it that the columns of all promise most for, all of them together, and where that
//!   was too much the better half of them;
//! - *renewal* adds some and takes those away that are missed least.
//!
//! Fits begin with the curvatures before. On a level whose vertices grow with the root of the number of cones, solves, a few for
//! each cone, take a time that grows like its power of 1.5.

use geom::{VertexData, VertexId};

use super::energy_model::{ConeSet, EnergyModel};
use super::matching_pursuit::{gradient, start};
use super::refined::by_curvature;
use super::separation::Separation;
use super::swap_table::{SwapTable, norms};
use crate::curvature::{COMFORTABLE_CORNER, COMFORTABLE_CURVATURE};

/// A batch of new cones holds only those that promise at least this share of what the best one does. Cones that change what others
/// promise are so added later.
const LEAST_SHARE: f64 = 0.1;
/// A batch holds at most this share of the cones that are there.
const BATCH: f64 = 0.5;
/// Cones of a batch are so far apart, and a cone moves so far, in radii of a disk that is one cone's share of the surface.
const REACH: f64 = 0.9;
/// That is, where vertices are crowded, so many times one cone's share of them at most: where most of the vertices are on a small part of the
/// surface, each move would look at all for every cone.
const CROWD: usize = 16;
/// A renewal adds, and takes away, one cone in so many.
const RENEWED: usize = 8;
/// So many rounds of moves and renewals at most.
const ROUNDS: usize = 10;
/// They end when the energy falls by less than this share.
const LEAST_GAIN: f64 = 0.01;
/// Moves that make it worse together are tried by their better half so often.
const HALVINGS: usize = 3;

/// The best set of so many cones that was found, in the order of their curvature's size; fewer only where there is no room for more.
pub(crate) fn many_cones(model: &mut EnergyModel, count: usize) -> ConeSet {
    let comfortable = |model: &mut EnergyModel| {
        model.with_largest_curvature(COMFORTABLE_CURVATURE, |model| {
            model.with_largest_corner(COMFORTABLE_CORNER, |model| search(model, count))
        })
    };
    let mut set = comfortable(model);
    if set.shortfall > 0.0 {
        set = search(model, count);
    }
    by_curvature(model, &set)
}

fn search(model: &mut EnergyModel, count: usize) -> ConeSet {
    let first = start(model, count);
    let mut set = grown(model, first, count);
    for _ in 0..ROUNDS {
        if model.is_stopped() {
            break;
        }
        let before = set.clone();
        set = moved(model, set);
        set = renewed(model, set);
        if !set.is_better_than(&before, LEAST_GAIN) {
            break;
        }
    }
    moved(model, set)
}

/// The vertices round one that are no farther than `reach` radii of a disk that is the share of one of so many cones, with
/// their distances; no more than [`CROWD`] shares of the vertices.
fn around(model: &EnergyModel, v: VertexId, reach: f64, count: usize) -> Vec<(VertexId, f32)> {
    let count = count.max(1);
    let radius = reach * REACH / (std::f64::consts::PI * count as f64).sqrt();
    let most = CROWD * model.operators().mesh().vertex_count().div_ceil(count);
    model.around(v, radius as f32, most)
}

/// Adds cones in batches until there are so many, or there is no room.
fn grown(model: &mut EnergyModel, mut set: ConeSet, count: usize) -> ConeSet {
    while set.cones.len() < count && !model.is_stopped() {
        let most = ((BATCH * set.cones.len() as f64) as usize).clamp(1, count - set.cones.len());
        let new = gainful(model, &set, most);
        if new.is_empty() {
            break;
        }
        model.add(&new);
        let cones = [&set.cones[..], &new].concat();
        set = model.fit_from(&cones, &set);
    }
    set
}

/// At most so many vertices where a further cone promises most, apart from each other.
fn gainful(model: &EnergyModel, set: &ConeSet, most: usize) -> Vec<VertexId> {
    let separation = Separation::new(model.operators(), &set.cones);
    let (gradient, norms) = (gradient(model, set), norms(model, set));
    let gain = |v: VertexId| {
        let [low, high] = model.bounds(v, set.cones.len() + 1);
        let t = (-gradient[v] / norms[v].max(f64::MIN_POSITIVE)).clamp(low, high);
        -t * (2.0 * gradient[v] + t * norms[v])
    };
    let open = model.operators().mesh().vertices().filter(|&v| separation.admits_another(v));
    let mut ranked: Vec<(f64, VertexId)> = open.map(|v| (gain(v), v)).collect();
    ranked.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let least = ranked.first().map_or(0.0, |best| LEAST_SHARE * best.0);
    let mut is_near = VertexData::constant(model.operators().mesh().vertex_count(), false);
    let mut new = Vec::new();
    for (_, v) in ranked.into_iter().take_while(|(gain, _)| *gain >= least) {
        if new.len() == most {
            break;
        }
        if !is_near[v] {
            new.push(v);
            around(model, v, 1.0, set.cones.len() + most).into_iter().for_each(|(w, _)| is_near[w] = true);
        }
    }
    new
}

/// A cone's place in the set and where it should go, with what that promises.
type Move = (f64, usize, VertexId);

/// Moves cones to better places round them, as long as that helps.
fn moved(model: &mut EnergyModel, set: ConeSet) -> ConeSet {
    let mut moves = moves(model, &set);
    for _ in 0..=HALVINGS {
        if moves.is_empty() || model.is_stopped() {
            break;
        }
        let (cones, places): (Vec<VertexId>, Vec<VertexId>) = applied(model, &set, &moves);
        model.add(&places);
        let next = model.fit_from(&cones, &set);
        if next.is_better_than(&set, 0.0) {
            return next;
        }
        moves.truncate(moves.len() / 2);
    }
    set
}

/// For each cone the best vertex round it, if it is a better place; the best first.
fn moves(model: &EnergyModel, set: &ConeSet) -> Vec<Move> {
    let separation = Separation::new(model.operators(), &set.cones);
    let (gradient, norms) = (gradient(model, set), norms(model, set));
    let table = SwapTable::new(model, set);
    let least = LEAST_GAIN / 10.0 * set.energy / set.cones.len().max(1) as f64;
    let mut moves = Vec::new();
    for (leaving, &cone) in set.cones.iter().enumerate() {
        if model.is_stopped() {
            return Vec::new();
        }
        let departure = table.departure(leaving);
        let around = around(model, cone, 1.0, set.cones.len());
        let open = around.into_iter().map(|(v, _)| v).filter(|&v| v != cone && separation.admits(v, leaving));
        let open: Vec<VertexId> = open.collect();
        let changes = table.changes_at(&departure, &open, |k| (gradient[open[k]], norms[open[k]]));
        let changes = changes.into_iter().zip(&open).map(|(change, &v)| (change, leaving, v));
        moves.extend(changes.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|best| best.0 < -least));
    }
    moves.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    moves
}

/// The cones after such of the moves as leave them apart, and the places that are new.
fn applied(model: &EnergyModel, set: &ConeSet, moves: &[Move]) -> (Vec<VertexId>, Vec<VertexId>) {
    let mut cones = set.cones.clone();
    moves.iter().for_each(|&(_, place, v)| cones[place] = v);
    // Two that meet go back, and with them who then is in their way.
    loop {
        let separation = Separation::new(model.operators(), &cones);
        let is_astray = |place: &usize| cones[*place] != set.cones[*place] && !separation.admits(cones[*place], *place);
        let astray: Vec<usize> = (0..cones.len()).filter(is_astray).collect();
        if astray.is_empty() {
            break;
        }
        astray.into_iter().for_each(|place| cones[place] = set.cones[place]);
    }
    let places = cones.iter().zip(&set.cones).filter(|(now, before)| now != before).map(|(&now, _)| now).collect();
    (cones, places)
}

/// Adds some cones where they promise most, and takes as many away that are missed least, if that helps.
fn renewed(model: &mut EnergyModel, set: ConeSet) -> ConeSet {
    let count = set.cones.len();
    let more = grown(model, set.clone(), count + count.div_ceil(RENEWED));
    let fewer = thinned(model, more, count);
    if fewer.is_better_than(&set, 0.0) { fewer } else { set }
}

/// Takes cones away that are missed least and are apart, until so many are left.
fn thinned(model: &EnergyModel, mut set: ConeSet, count: usize) -> ConeSet {
    while set.cones.len() > count && !model.is_stopped() {
        let table = SwapTable::new(model, &set);
        let mut order: Vec<(f64, usize)> = (0..set.cones.len()).map(|place| (table.removal(place), place)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut is_near = VertexData::constant(model.operators().mesh().vertex_count(), false);
        let mut is_gone = vec![false; set.cones.len()];
        let mut left = set.cones.len() - count;
        for (_, place) in order {
            let cone = set.cones[place];
            if left > 0 && !is_near[cone] {
                (is_gone[place], left) = (true, left - 1);
                let around = around(model, cone, 2.0, set.cones.len());
                around.into_iter().for_each(|(w, _)| is_near[w] = true);
            }
        }
        let cones: Vec<VertexId> = set.cones.iter().zip(is_gone).filter(|(_, gone)| !gone).map(|(&c, _)| c).collect();
        set = model.fit_from(&cones, &set);
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Operators;
    use crate::hierarchy::ConeHierarchy;
    use crate::placement::refined;
    use geom::{Metric, Watch, shapes};

    #[test]
    fn many_cones_are_nearly_as_good_as_the_full_search_finds_and_better_than_by_persistence() {
        for shape in [shapes::hare(1500), shapes::torus(2, 1500), shapes::terrain(1500, 3)] {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let set = many_cones(&mut EnergyModel::new(&operators, &mesh), 40);
            assert_eq!((set.cones.len(), set.shortfall), (40, 0.0));
            let full = refined(&mut EnergyModel::new(&operators, &mesh), 40);
            let ratio = set.log_scale_norm() / full.log_scale_norm();
            assert!(ratio < 1.15, "{ratio}");
            let factor = crate::field::ConformalFactor::new(&operators);
            let cones = ConeHierarchy::new(&operators, &factor).by_persistence(&operators, 40, Watch::NONE);
            let mut model = EnergyModel::new(&operators, &mesh);
            model.add(&cones);
            let share = set.log_scale_norm() / model.fit(&cones).log_scale_norm();
            assert!(share < 0.9, "{share} of the norm by persistence");
        }
    }
}
