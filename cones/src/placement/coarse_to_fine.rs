//! Cones from a coarse level, polished on the surface itself.
//!
//! The whole search is made on the [coarse level](super::level), where solves cost next to nothing. Its cones are vertices of
//! the surface, so the surface's energy model tells at once how good they are there: a solve for each. Then, for each cone, the
//! best vertex round it that the energy's gradient promises is solved for too, and cones are exchanged with these. Of a large surface
//! all of that is done on a middle level; on the surface what is predicted for the cones that come out is looked at; optimal curvatures they bring along.

use geom::{Interrupted, PoissonError, VertexId};

use super::automatic::{
    Automatic, Goal, at_corners, automatic, bend, has_few_corners, is_hardly_better, is_tolerable, meets,
};
use super::energy_model::{ConeSet, EnergyModel};
use super::exchange::{drop_cheapest, exchange, exchange_deeply};
use super::level::CoarseLevel;
use super::nested::Nested;
use super::prediction::{Prediction, predict};
use super::pursuit::pursuit;
use super::refined::{FEW as VERY_FEW, by_curvature, refined, refined_without_draws, within_comfort};
use super::separation::Separation;
use super::swap_table::SwapTable;
use super::{Ground, Placed};
use crate::curvature::{ConeCurvatures, CurvatureError, CurvatureRule, cone_curvatures, least_cones};
use crate::field::Operators;

/// A cone is looked for so far round where the coarse level has it, in spacings of that.
const REACH: f32 = 1.5;
/// A cone less is looked at further where it misses the target by no more than this factor.
const NEAR: f64 = 1.02;
/// So often, as long as that is worthwhile.
const ROUNDS: usize = 3;
/// For another round, which costs a solve and half a one for each cone, the energy must fall by this share of itself: half as much less of the norm
/// is what the round may bring again.
const WORTHWHILE: f64 = 0.04;
/// With more cones than that each of them counts for less, and a smaller share is enough.
const FEW: usize = 16;
const WORTHWHILE_FOR_MANY: f64 = 0.03;
/// Of very few cones a round costs little, and each counts for much.
const WORTHWHILE_FOR_VERY_FEW: f64 = 0.003;
const ROUNDS_FOR_VERY_FEW: usize = 6;
/// In the end each is exchanged with so many vertices next to it, so many times,
const NEXT_TO: usize = 16;
const ROUNDS_OF_SETTLING: usize = 4;
/// where solves cost little. (On 26 shared meshes 4 and 8 cones have .9991 of the norm; `planck_10000` with 4 stays .06 % worse than a known set without.)
const SETTLED_ON: usize = 50_000;
/// A vertex is solved for where it promises to lower the energy by this share. (On 16 shared meshes 16 to 32 cones have 1.0004 of the norm that they
/// have with 2e-4, at most 1.002.)
const LEAST_GAIN: f64 = 5e-4;

/// The best cones of so many that are found; none where the level has too few vertices, or the surface has not what it takes there.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn refined_from(ground: Ground, level: &CoarseLevel, count: usize) -> Result<Option<Placed>, PoissonError> {
    let mut coarse_model = level.energy_model(ground.watch.within(0.0, 0.5));
    let (coarse, model) = rayon::join(|| refined(&mut coarse_model, count), || finer_model(ground, level));
    let mut model = model?;
    let mut set = polished(&mut model, level, &coarse);
    if count <= VERY_FEW && model.operators().mesh.vertex_count() <= SETTLED_ON {
        set = settled(&mut model, set);
    }
    if set.cones.len() != count || (set.shortfall > 0.0 && coarse.shortfall == 0.0) {
        return Ok(None);
    }
    Ok(Some(match level.middle() {
        None => Placed { curvatures: model.curvatures(&set), cones: set.cones },
        Some(middle) if set.shortfall == 0.0 => {
            let (set, _, curvatures) = confirmed_on_surface(ground, middle, &set, CurvatureRule::Optimal)?;
            Placed { cones: set.cones, curvatures }
        }
        Some(middle) => brought_up(ground, middle, &set.cones)?.into(),
    }))
}

/// As few cones as keep the predicted area distortion within a target, their number from the coarse level as far as the surface
/// agrees.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn fewest_from(
    ground: Ground,
    level: &CoarseLevel,
    rule: CurvatureRule,
    goal: Goal,
) -> Result<Automatic, PoissonError> {
    // What the surface misses that the coarse level has met is looked up further on in its order.
    let goal = Goal { is_part: false, ..goal };
    let Goal { target, most, to_knee, is_draft, .. } = goal;
    let mut coarse_model = level.energy_model(ground.watch.within(0.0, 0.5));
    let (coarse, model) = if is_draft {
        let coarse = automatic(&mut coarse_model, rule, goal);
        if coarse.is_draft {
            return draft(ground, level, coarse, rule);
        }
        (coarse, finer_model(ground, level))
    } else {
        rayon::join(|| automatic(&mut coarse_model, rule, goal), || finer_model(ground, level))
    };
    let mut model = model?;
    let mut search = Fewest { model: &mut model, level, rule, target, to_knee };
    let (set, predicted) = search.confirmed(&mut coarse_model, &coarse, most);
    let is_met = meets(&set, &predicted, target);
    let (norm, is_missed_there) = (coarse.set.log_scale_norm(), !coarse.is_met);
    let mut found = Automatic { set, predicted, is_met, is_from_level: true, ..coarse };
    if to_knee {
        let corners = if level.middle().is_none() { at_corners(&mut model, &found) } else { None };
        let knee = corners.or_else(|| {
            let set = refined_without_draws(&mut coarse_model, bend(&found, norm)?);
            Some(polished(&mut model, level, &set)).filter(|set| found.has_knee_at(set))
        });
        if let Some(set) = knee {
            found = found.with_knee(&model, set, rule, target);
        }
    }
    let Some(middle) = level.middle() else {
        let curvatures = if rule == CurvatureRule::Optimal { model.curvatures(&found.set) } else { None };
        return Ok(Automatic { curvatures, ..found });
    };
    let mut count = found.set.cones.len();
    let mut first = None;
    loop {
        let (set, predicted, curvatures) = confirmed_on_surface(ground, middle, &found.set, rule)?;
        let is_met = meets(&set, &predicted, target);
        found = Automatic { set, predicted, is_met, curvatures, ..found };
        let is_in_vain = to_knee && is_missed_there && is_tolerable(&predicted);
        if is_met || is_in_vain || count >= most || model.is_over() {
            break;
        }
        first.get_or_insert_with(|| found.clone());
        count = enough_cones(&found.curve, (count, predicted.area_distortion), target, most);
        found.set = polished(&mut model, level, &refined_without_draws(&mut coarse_model, count));
    }
    if let Some(first) =
        first.filter(|first| to_knee && !found.is_met && is_hardly_better(&found.predicted, &first.predicted))
    {
        found = first;
    }
    if to_knee && has_few_corners(ground.operators, &found) {
        let mut model = ground.energy_model()?.putting_columns_off();
        if let Some(set) = at_corners(&mut model, &found) {
            found = found.with_knee(&model, set, rule, target);
        }
    }
    Ok(found)
}

/// A draft on the surface, where nothing is known but its factor. Optimal curvatures are the level's, as in [`confirmed_on_surface`].
fn draft(
    ground: Ground,
    level: &CoarseLevel,
    coarse: Automatic,
    rule: CurvatureRule,
) -> Result<Automatic, PoissonError> {
    let cones = level.of_surface(&coarse.set.cones);
    let set = ConeSet { cones, ..coarse.set };
    ground.watch.within(f64::NAN, f64::NAN).ask(0.0)?;
    let curvatures = (rule == CurvatureRule::Optimal && set.shortfall == 0.0).then(|| {
        let predicted = |curvature: &[f64]| ground.operators.log_scale(&set.cones, curvature);
        ConeCurvatures::known(ground.operators, set.curvature.clone(), predicted)
    });
    Ok(Automatic { set, curvatures, is_from_level: true, ..coarse })
}

/// The model that a level's cones are polished on: that of the middle level, or the surface's.
fn finer_model<'a>(ground: Ground<'a>, level: &'a CoarseLevel) -> Result<EnergyModel<'a>, Interrupted> {
    // What the surface will be asked for, while the coarse level is searched.
    let Ground { operators, watch, .. } = ground;
    let solved = watch.within(f64::NAN, f64::NAN);
    operators.flattening_watched(solved)?;
    let even = || if operators.is_bordered() { Ok(()) } else { operators.even_watched(solved).map(|_| ()) };
    let model = || level.middle().map_or_else(|| ground.energy_model(), |middle| Ok(middle.energy_model(watch)));
    let (even, model) = rayon::join(even, model);
    even.and(model).map(EnergyModel::putting_columns_off)
}

/// A middle level's cones as vertices of the surface, apart from each other.
fn brought_up(ground: Ground, middle: &CoarseLevel, cones: &[VertexId]) -> Result<Vec<VertexId>, Interrupted> {
    let cones = middle.of_surface(cones);
    if are_apart(ground.operators, &cones) {
        return Ok(cones);
    }
    Ok(apart(&ground.energy_model()?, cones, REACH * middle.spacing()))
}

/// A middle level's cones on the surface: with their curvatures, and what is predicted for them. Optimal curvatures are the middle level's: to
/// be least the energy's derivatives are 0, so that what they are off matters little. (A hare of 963,098 vertices, 32 cones: area distortion 1.19058 for 1.19052, a solve in
/// place of 33.)
fn confirmed_on_surface(
    ground: Ground,
    middle: &CoarseLevel,
    set: &ConeSet,
    rule: CurvatureRule,
) -> Result<(ConeSet, Prediction, Option<ConeCurvatures>), Interrupted> {
    let Ground { operators, input, watch, .. } = ground;
    let cones = brought_up(ground, middle, &set.cones)?;
    let watch = watch.within(f64::NAN, f64::NAN);
    let found = match rule {
        CurvatureRule::Optimal if set.shortfall == 0.0 => {
            watch.ask(0.0)?;
            let predicted = |curvature: &[f64]| operators.log_scale(&cones, curvature);
            Ok(ConeCurvatures::known(operators, set.curvature.clone(), predicted))
        }
        _ => cone_curvatures(operators, input, &cones, rule, watch),
    };
    match found {
        Ok(found) => {
            let predicted = Prediction::of(operators, cones.len(), &found.predicted);
            let energy = predicted.log_scale_norm.powi(2);
            Ok((ConeSet::with_curvatures(cones, found.curvature.clone(), energy), predicted, Some(found)))
        }
        Err(CurvatureError::Interrupted(interrupted)) => Err(interrupted),
        // They cannot take the curvature: how near they come to that is the energy model's to say.
        Err(_) => {
            let mut model = ground.energy_model()?.putting_columns_off();
            model.add(&cones);
            let set = model.fit(&cones);
            let predicted = predict(&model, &set, rule);
            Ok((set, predicted, None))
        }
    }
}

/// Cones with the curvatures that they have on a middle level; none where that has not all of them, where they cannot take the surface's curvature,
/// or what is predicted is not finite.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn with_curvatures_of(
    ground: Ground,
    middle: &CoarseLevel,
    cones: Vec<VertexId>,
) -> Result<Option<Placed>, Interrupted> {
    let Some(cones) = middle.own_of_surface(&cones) else { return Ok(None) };
    let mut model = middle.energy_model(ground.watch.within(f64::NAN, f64::NAN)).putting_columns_off();
    let cones = apart(&model, cones, REACH * middle.spacing());
    model.add(&cones);
    let set = model.fit(&cones);
    if set.shortfall > 0.0 {
        return Ok(None);
    }
    let (set, predicted, curvatures) = confirmed_on_surface(ground, middle, &set, CurvatureRule::Optimal)?;
    Ok(predicted.log_scale_norm.is_finite().then_some(Placed { cones: set.cones, curvatures }))
}

/// A search for the fewest cones on the surface, or on the middle level.
struct Fewest<'s, 'm> {
    model: &'s mut EnergyModel<'m>,
    level: &'s CoarseLevel,
    rule: CurvatureRule,
    target: f64,
    /// See [`Goal`].
    to_knee: bool,
}

impl Fewest<'_, '_> {
    /// The cones chosen on the coarse level, polished; more where they miss the target then, fewer where fewer meet it.
    fn confirmed(&mut self, coarse_model: &mut EnergyModel, coarse: &Automatic, most: usize) -> (ConeSet, Prediction) {
        let mut count = coarse.set.cones.len();
        if let Some(next) = coarse.passed.iter().find(|set| set.cones.len() == count + 1) {
            // What is most often looked at next is solved for in the same block, whose cost is that of going through the factor.
            self.model.add(&self.level.in_finer(&[&coarse.set.cones[..], &next.cones].concat()));
        }
        let mut best = self.polished(&coarse.set);
        if !coarse.is_met {
            // Of what is left here the coarse level has seen too little to do with fewer.
            let is_in_vain = best.0.cones.len() >= most || is_tolerable(&best.1);
            return if is_in_vain { best } else { self.polished(&refined_without_draws(coarse_model, most)) };
        }
        let mut least = least_cones(self.model.operators());
        let first = best.clone();
        while !meets(&best.0, &best.1, self.target) && count < most && !self.model.is_over() {
            least = count + 1;
            count = enough_cones(&coarse.curve, (count, best.1.area_distortion), self.target, most);
            let passed = coarse.passed.iter().find(|set| set.cones.len() == count).cloned();
            best = self.polished(&passed.unwrap_or_else(|| refined_without_draws(coarse_model, count)));
        }
        if self.to_knee && !meets(&best.0, &best.1, self.target) && is_hardly_better(&best.1, &first.1) {
            best = first;
        }
        if meets(&best.0, &best.1, self.target) {
            while best.0.cones.len() > least
                && let Some(fewer) = self.fewer(&best.0)
            {
                best = fewer;
            }
        }
        best
    }

    /// A cone less, if the target is met so.
    fn fewer(&mut self, set: &ConeSet) -> Option<(ConeSet, Prediction)> {
        if self.model.is_over() {
            return None;
        }
        let fewer = exchange(self.model, drop_cheapest(self.model, set));
        let mut fewer = self.predicted(fewer);
        if fewer.1.area_distortion > self.target && fewer.1.area_distortion < NEAR * self.target {
            let new = candidates(self.model, &fewer.0, REACH * self.level.spacing());
            self.model.add(&new);
            let exchanged = exchange(self.model, fewer.0);
            fewer = self.predicted(exchanged);
        }
        meets(&fewer.0, &fewer.1, self.target).then(|| {
            let set = by_curvature(self.model, &fewer.0);
            (set, fewer.1)
        })
    }

    fn polished(&mut self, coarse: &ConeSet) -> (ConeSet, Prediction) {
        let set = polished(self.model, self.level, coarse);
        self.predicted(set)
    }

    fn predicted(&self, set: ConeSet) -> (ConeSet, Prediction) {
        let predicted = predict(self.model, &set, self.rule);
        (set, predicted)
    }
}

/// How many cones are tried where `count` of them have `reached` an area distortion that misses the target: as many as lower its excess
/// over 1 as far on the coarse level's curve, one more at least. With one more at a time each number is polished: on a hare of
/// 930,576 vertices, which the level gives 19 cones, 447 vertices were solved for by the 25th, and the search took more than 44 s; now 12.
fn enough_cones(curve: &[Prediction], (count, reached): (usize, f64), target: f64, most: usize) -> usize {
    let excess = |point: &Prediction| point.area_distortion - 1.0;
    let Some(here) = curve.iter().find(|point| point.count == count).map(excess) else { return count + 1 };
    let enough = here * (target - 1.0) / (reached - 1.0);
    let mut more = curve.iter().filter(|point| (count + 1..most).contains(&point.count));
    more.find(|point| excess(point) <= enough).map_or(most, |point| point.count)
}

/// The nested order of so many cones that a coarse level has, with the best curvatures on the surface.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn order_from(ground: Ground, level: &CoarseLevel, count: usize) -> Result<Nested, Interrupted> {
    let coarse = pursuit(&mut level.energy_model(ground.watch.within(0.0, 0.5)), count);
    let mut model = ground.energy_model()?.putting_columns_off();
    let cones = apart(&model, level.of_surface(coarse.cones()), REACH * level.spacing());
    Ok(Nested::new(&mut model, &cones))
}

/// A coarse level's cones, apart from each other on the surface.
pub(crate) fn on_surface(model: &EnergyModel, level: &CoarseLevel, coarse: &ConeSet) -> Vec<VertexId> {
    apart(model, level.of_surface(&coarse.cones), REACH * level.spacing())
}

/// A coarse level's cones, moved to where they are best on the finer level whose model this is, or on the surface.
pub(crate) fn polished(model: &mut EnergyModel, level: &CoarseLevel, coarse: &ConeSet) -> ConeSet {
    let reach = REACH * level.spacing();
    let cones = apart(model, level.in_finer(&coarse.cones), reach);
    model.add(&cones);
    let (worthwhile, rounds) = match cones.len() {
        count if count <= VERY_FEW => (WORTHWHILE_FOR_VERY_FEW, ROUNDS_FOR_VERY_FEW),
        count if count <= FEW => (WORTHWHILE, ROUNDS),
        _ => (WORTHWHILE_FOR_MANY, ROUNDS),
    };
    within_comfort(model, |model| {
        let mut set = model.fit(&cones);
        for _ in 0..rounds {
            let new = candidates(model, &set, reach);
            model.add(&new);
            let next = exchange(model, set.clone());
            let is_over = new.is_empty() || !next.is_better_than(&set, worthwhile);
            set = next;
            if is_over {
                break;
            }
        }
        set
    })
}

/// Very few cones exchanged with the vertices next to them, one and two at a time, as long as that helps.
fn settled(model: &mut EnergyModel, set: ConeSet) -> ConeSet {
    within_comfort(model, |model| {
        let mut set = model.fit(&set.cones);
        for _ in 0..ROUNDS_OF_SETTLING {
            if model.is_over() {
                break;
            }
            let next_to = |&cone: &VertexId| model.around(cone, f32::INFINITY, NEXT_TO).into_iter().map(|(v, _)| v);
            let mesh = &model.operators().mesh;
            let inner = set.cones.iter().flat_map(next_to).filter(|&v| !mesh.is_boundary_vertex(v));
            let inner: Vec<VertexId> = inner.collect();
            model.add(&inner);
            let next = exchange_deeply(model, set.clone());
            let is_over = next.cones == set.cones;
            set = next;
            if is_over {
                break;
            }
        }
        set
    })
}

/// The same cones, each that is too near to one before it on the surface moved to the nearest vertex round it that is not: so that what
/// becomes of the first ones does not depend on those after them.
fn apart(model: &EnergyModel, mut cones: Vec<VertexId>, reach: f32) -> Vec<VertexId> {
    let operators = model.operators();
    if are_apart(operators, &cones) {
        return cones;
    }
    for place in 1..cones.len() {
        let separation = Separation::new(operators, &cones[..place]);
        let mut around = model.around(cones[place], reach, usize::MAX).into_iter();
        if let Some((v, _)) = around.find(|&(v, _)| separation.admits_another(v)) {
            cones[place] = v;
        }
    }
    cones
}

/// Whether none is too near to another.
fn are_apart(operators: &Operators, cones: &[VertexId]) -> bool {
    let separation = Separation::new(operators, cones);
    (0..cones.len()).all(|place| separation.admits(cones[place], place))
}

/// For each cone the best vertex round it that was not solved for.
fn candidates(model: &EnergyModel, set: &ConeSet, reach: f32) -> Vec<VertexId> {
    if model.is_over() {
        return Vec::new();
    }
    SwapTable::new(model, set).proposals_within(reach, LEAST_GAIN).into_iter().map(|swap| swap.coming).collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    use super::*;
    use crate::curvature::CurvatureRule;
    use crate::field::{Operators, TiedLoops, open_handles};
    use crate::placement::area_distortion;
    use geom::{Id, Mesh, Metric, Watch, shapes};

    /// A surface of each kind, with a level of a sixth of its vertices.
    fn levels() -> Vec<(Mesh, Operators, CoarseLevel)> {
        let shapes = [shapes::hare(2400), shapes::torus(2, 2400), shapes::terrain(2400, 3), shapes::cylinder(2400)];
        let level = |shape: shapes::Shape| {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let level = CoarseLevel::of_size(&operators, &mesh, 400, Watch::NONE).unwrap();
            (mesh, operators, level)
        };
        shapes.map(level).into()
    }

    #[test]
    fn cones_have_nearly_the_same_energy_on_both_levels() {
        for (mesh, operators, level) in levels() {
            let mut coarse = level.energy_model(Watch::NONE);
            let mut fine = EnergyModel::new(&operators, &mesh);
            for count in [4, 9] {
                let set = refined(&mut coarse, count);
                let cones = level.of_surface(&set.cones);
                fine.add(&cones);
                let ratio = fine.fit(&cones).log_scale_norm() / set.log_scale_norm();
                assert!((ratio - 1.0).abs() < 0.15 || set.log_scale_norm() < 1e-3, "{count} cones: {ratio}");
            }
        }
    }

    #[test]
    fn what_is_found_is_nearly_as_good_as_by_the_full_search() {
        let mut ratios = Vec::new();
        for (mesh, operators, level) in levels() {
            for count in [4, 8, 16, 24] {
                let set = refined(&mut level.energy_model(Watch::NONE), count);
                let mut model = EnergyModel::new(&operators, &mesh);
                let found = polished(&mut model, &level, &set);
                let full = refined(&mut EnergyModel::new(&operators, &mesh), count);
                assert_eq!((found.cones.len(), found.shortfall), (count, 0.0));
                if full.log_scale_norm() > 1e-3 {
                    ratios.push(found.log_scale_norm() / full.log_scale_norm());
                }
            }
        }
        let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp();
        assert!(mean < 1.03 && ratios.iter().all(|&ratio| ratio < 1.1), "{mean}: {ratios:?}");
    }

    #[test]
    fn an_opened_level_promises_what_the_level_of_the_opened_surface_does() {
        for genus in [1, 2, 4] {
            let shape = shapes::torus(genus, 4000);
            let mesh = shape.mesh();
            let metric = Metric::from_points(&mesh, &shape.points);
            let of = |mesh: &Mesh, metric: &Metric, tied: Option<&TiedLoops>, points: &[[f64; 3]]| {
                let operators = Operators::with_tied_loops((mesh, metric), points, tied, None, Watch::NONE).unwrap();
                CoarseLevel::of_size(&operators, mesh, 800, Watch::NONE).unwrap()
            };
            let closed = of(&mesh, &metric, None, &shape.points);
            let promised = closed.with_handles_opened(&mesh, Watch::NONE).unwrap().unwrap();
            let (island, tied) = open_handles(&mesh, metric.lengths(), Watch::NONE).unwrap().unwrap();
            let lengths = island.edges_of(&mesh).iter().map(|&e| metric.length(e)).collect();
            let points: Vec<[f64; 3]> = island.vertices_of(&mesh).iter().map(|v| shape.points[v.index()]).collect();
            let opened = of(&island.mesh, &Metric::new(lengths), Some(&tied), &points);
            let excess = |level: &CoarseLevel| {
                let mut model = level.energy_model(Watch::NONE);
                let set = pursuit(&mut model, 8).sets.pop().unwrap();
                predict(&model, &set, CurvatureRule::Optimal).area_distortion - 1.0
            };
            let [closed, promised, opened] = [&closed, &promised, &opened].map(excess);
            assert!(promised < 0.85 * closed && (promised / opened - 1.0).abs() < 0.1, "{closed} {promised} {opened}");
        }
    }

    fn fewest(operators: &Operators, input: &Mesh, level: &CoarseLevel, target: (f64, bool), most: usize) -> Automatic {
        fewest_watched((operators, input), level, target, most, Watch::NONE).unwrap()
    }

    fn fewest_watched(
        (operators, input): (&Operators, &Mesh),
        level: &CoarseLevel,
        target: (f64, bool),
        most: usize,
        watch: Watch,
    ) -> Result<Automatic, PoissonError> {
        let goal = Goal { target: target.0, most, to_knee: target.1, is_draft: false, is_part: false };
        with_ground((operators, input), watch, |ground| fewest_from(ground, level, CurvatureRule::Optimal, goal))
    }

    fn with_ground<T>(
        (operators, input): (&Operators, &Mesh),
        watch: Watch,
        ask: impl FnOnce(Ground) -> Result<T, PoissonError>,
    ) -> Result<T, PoissonError> {
        let factor = crate::field::ConformalFactor::new(operators);
        let hierarchy = &crate::hierarchy::ConeHierarchy::new(operators, &factor);
        let (terms, level) = (OnceLock::new(), OnceLock::new());
        let search = super::super::Search::CoarseToFine;
        ask(Ground { operators, input, hierarchy, terms: &terms, level: &level, search, watch })
    }

    fn with_middle(operators: &Operators, mesh: &Mesh) -> CoarseLevel {
        CoarseLevel::of_middle(operators, mesh, [1200, 400], Watch::NONE).unwrap()
    }

    #[test]
    fn polished_on_a_middle_level_cones_are_nearly_as_good() {
        for (mesh, operators, level) in levels() {
            let coarsest = with_middle(&operators, &mesh);
            let middle = coarsest.middle().unwrap();
            let norm = |cones: Vec<VertexId>| {
                let mut model = EnergyModel::new(&operators, &mesh);
                model.add(&cones);
                let set = model.fit(&cones);
                assert_eq!((set.cones.len(), set.shortfall), (8, 0.0));
                set.log_scale_norm()
            };
            let set = |level: &CoarseLevel| refined(&mut level.energy_model(Watch::NONE), 8);
            let directly = polished(&mut EnergyModel::new(&operators, &mesh), &level, &set(&level));
            let through_middle = polished(&mut middle.energy_model(Watch::NONE), &coarsest, &set(&coarsest));
            let (directly, through_middle) = (norm(directly.cones), norm(middle.of_surface(&through_middle.cones)));
            assert!(through_middle < 1.05 * directly + 1e-3, "{through_middle} for {directly}");
        }
    }

    #[test]
    fn what_a_middle_level_promises_is_confirmed_on_the_surface() {
        for (mesh, operators, _) in levels() {
            let level = with_middle(&operators, &mesh);
            let found = fewest(&operators, &mesh, &level, (1.3, true), 32);
            assert!(found.is_met && found.predicted.area_distortion <= 1.3);
            let (cones, rule) = (&found.set.cones, CurvatureRule::Optimal);
            let alone = cone_curvatures(&operators, &mesh, cones, rule, Watch::NONE).unwrap();
            let known = found.curvatures.unwrap();
            assert_eq!(found.predicted.area_distortion, area_distortion(&operators, &known.predicted));
            let sum: f64 = known.curvature.iter().sum();
            assert!(operators.is_bordered() || (sum - operators.total_curvature()).abs() < 1e-12);
            // The middle level's curvatures are hardly worse than the best.
            let [norm, least] =
                [&known, &alone].map(|found| operators.inner(&found.predicted, &found.predicted).sqrt());
            assert!(least <= norm * (1.0 + 1e-9) && norm <= 1.01 * least, "{norm} for {least}");
            // A target that no number of cones meets: all that are allowed are taken.
            let strict = fewest(&operators, &mesh, &level, (1.0, false), 6);
            assert!(!strict.is_met && strict.set.cones.len() <= 6);
        }
    }

    #[test]
    fn curvatures_that_the_search_knows_are_the_best() {
        for (mesh, operators, level) in levels() {
            for (level, is_exact) in [(level, true), (with_middle(&operators, &mesh), false)] {
                let (operators, input, watch) = (&operators, &mesh, Watch::NONE);
                let found = with_ground((operators, input), watch, |ground| refined_from(ground, &level, 6));
                let Placed { cones, curvatures } = found.unwrap().expect("there is room");
                let known = curvatures.expect("six cones can take the curvature");
                let alone = cone_curvatures(operators, input, &cones, CurvatureRule::Optimal, watch).unwrap();
                let norm = |u: &[f64]| operators.inner(u, u).sqrt();
                assert!(norm(&known.predicted) <= 1.01 * norm(&alone.predicted));
                if is_exact {
                    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
                    assert!(near(&known.curvature, &alone.curvature) && near(&known.predicted, &alone.predicted));
                }
            }
        }
    }

    #[test]
    fn a_middle_level_s_curvatures_are_hardly_worse_than_the_surface_s() {
        for (mesh, operators, _) in levels() {
            let coarsest = with_middle(&operators, &mesh);
            let middle = coarsest.middle().unwrap();
            let (operators, input, watch) = (&operators, &mesh, Watch::NONE);
            let curvatures_of = |cones: &[VertexId]| {
                let ask = |ground: Ground| Ok(with_curvatures_of(ground, middle, cones.to_vec())?);
                with_ground((operators, input), watch, ask).unwrap()
            };
            let set = refined(&mut coarsest.energy_model(Watch::NONE), 12);
            let cones = coarsest.of_surface(&set.cones);
            assert_eq!(middle.own_of_surface(&cones).unwrap(), coarsest.in_finer(&set.cones));
            let Placed { cones, curvatures } = curvatures_of(&cones).unwrap();
            let alone = cone_curvatures(operators, input, &cones, CurvatureRule::Optimal, watch).unwrap();
            let norm = |u: &[f64]| operators.inner(u, u).sqrt();
            let [known, least] = [&curvatures.unwrap().predicted, &alone.predicted].map(|u| norm(u));
            assert!(least <= known * (1.0 + 1e-9) && known <= 1.02 * least, "{known} for {least}");
            let other = mesh.vertices().find(|&v| middle.own_of_surface(&[v]).is_none()).unwrap();
            assert!(curvatures_of(&[other]).is_none());
            assert_eq!(curvatures_of(&cones[..1]).is_none(), least_cones(operators) > 1);
        }
    }

    #[test]
    fn the_search_ends_where_a_level_has_no_room_for_as_many_cones_as_are_allowed() {
        let shape = shapes::hare(900);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let level = CoarseLevel::of_middle(&operators, &mesh, [60, 12], Watch::NONE).unwrap();
        // A search that begins again and again is stopped.
        let asked = AtomicUsize::new(0);
        let observe = |_| match asked.fetch_add(1, Relaxed) < 3000 {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        };
        let watch = Watch::new(&observe);
        let found = fewest_watched((&operators, &mesh), &level, (1.0, false), 32, watch);
        let found = found.expect("it ends by itself");
        assert!(!found.is_met && found.set.cones.len() <= 12, "{:?}", found.set.cones);
        assert!(asked.into_inner() < 3000);
    }

    #[test]
    fn cones_are_apart_on_the_surface() {
        let (mesh, operators, _) = levels().swap_remove(0);
        let model = EnergyModel::new(&operators, &mesh);
        let mut together = vec![VertexId(700)];
        together.extend(operators.mesh().neighbors(VertexId(700)).iter().take(3));
        let moved = apart(&model, together.clone(), 1.0);
        let separation = Separation::new(&operators, &moved);
        assert!((0..moved.len()).all(|place| separation.admits(moved[place], place)), "{moved:?} of {together:?}");
        assert_eq!(apart(&model, moved.clone(), 1.0), moved);
    }

    #[test]
    fn as_many_cones_more_are_tried_as_the_level_needs_to_fall_as_far() {
        let point = |count: usize| Prediction { count, log_scale_norm: 0.0, area_distortion: 1.0 + 1.0 / count as f64 };
        let curve: Vec<Prediction> = (2..=20).map(point).collect();
        let tried = |reached: f64| enough_cones(&curve, (4, reached), 1.25, 20);
        assert_eq!([1.2501, 1.3, 1.37, 1.5].map(tried), [5, 5, 6, 8]);
        assert_eq!([3.0, f64::INFINITY, f64::NAN].map(tried), [20; 3], "nothing on the curve is enough");
        assert_eq!(tried(1.2), 5, "the target is met, but curvature cannot be taken: one more");
        assert_eq!(enough_cones(&curve, (1, 1.5), 1.25, 20), 2, "the curve knows nothing of one cone");
        assert_eq!(enough_cones(&curve, (19, 1.5), 1.25, 20), 20);
    }

    #[test]
    fn as_few_cones_as_meet_the_target_on_the_surface() {
        for (mesh, operators, level) in levels().into_iter().take(2) {
            let found = fewest(&operators, &mesh, &level, (1.4, false), 32);
            let goal = Goal { target: 1.4, most: 32, to_knee: false, is_draft: false, is_part: false };
            let full = automatic(&mut EnergyModel::new(&operators, &mesh), CurvatureRule::Optimal, goal);
            assert!(found.is_met && found.predicted.area_distortion <= 1.4);
            assert!(found.set.cones.len().abs_diff(full.set.cones.len()) <= 1);
        }
    }
}
