//! How many cones, when nobody says: as few as keep the area distortion within a target.
//!
//! The distortion of a flattening is predicted from the linear log scale factor, before anything is flattened (on thirty
//! meshes the median error was 0.001). The curve of the nested order says about how many cones it takes; the best set of
//! that number is better than nested ones, so cones are taken away from it as long as the target holds.
//!
//! Where a few cones more leave nearly nothing to distort, as the eight corners of a box do, these are taken instead: the
//! *knee* of the curve.

use geom::{VertexData, VertexId};

use super::configuration::Configuration;
use super::energy_model::{ConeSet, EnergyModel};
use super::exchange::{drop_cheapest, exchange};
use super::matching_pursuit::{Rule, grow, start};
use super::nested::Nested;
use super::prediction::{Prediction, predict};
use super::pursuit::{brief_pursuit, pursuit};
use super::refined::{by_curvature, refined_without_draws, rounds};
use crate::curvature::{COMFORTABLE_CORNER, ConeCurvatures, CurvatureRule, least_cones};
use crate::field::Operators;

/// A knee leaves at most this share of the log scale factor's norm. Smooth surfaces keep a half to a third of it where cones
/// are doubled; boxes, prisms and blocks keep less than a hundredth.
const KNEE: f64 = 0.1;
/// A nested order keeps more than the best set of a number: so much of the norm may be left in it where that set is looked for.
const NESTED_KNEE: f64 = 0.2;
/// A knee lies within twice as many cones, or this many: a hexagonal prism's twelve corners come after five.
const FEW: usize = 16;
/// An order of so many cones is enough where no more than half of them are needed. It is tried
const BRIEF: usize = 16;
/// where so many cones, each put where the gradient is steepest, meet the target.
const PROBE: usize = 10;
/// Where no number meets the target, twice as many cones are not taken for an excess over 1 that is lower by less than this factor: on white noise 32
/// cones leave 1.30 where none leave 1.33.
const HARDLY: f64 = 1.12;
/// See [`is_tolerable`].
const TOLERABLE: f64 = 1.5;
/// A part of several gets an order of so many at first: most need fewer than half of them.
const BRIEF_FOR_PART: usize = 12;
/// Vertices with less curvature than this, in radians, are no corners: half a degree.
const LEAST_CORNER: f64 = 0.01;

/// A number of cones chosen by their predicted distortion.
#[derive(Clone, Debug)]
pub(crate) struct Automatic {
    /// The cones.
    pub(crate) set: ConeSet,
    /// What is predicted for them.
    pub(crate) predicted: Prediction,
    /// Whether the prediction meets it.
    pub(crate) is_met: bool,
    /// Sets of more cones that were found on the way.
    pub(super) passed: Vec<ConeSet>,
    /// The nested order that led there.
    pub(crate) nested: Nested,
    /// What is predicted for its prefixes.
    pub(crate) curve: Vec<Prediction>,
    /// Whether the nested order and the curve are those of the coarse level, in its vertices.
    pub(crate) is_from_level: bool,
    /// The cones' curvatures by the rule, where the prediction took them.
    pub(crate) curvatures: Option<ConeCurvatures>,
    /// Whether the target is missed by the nested order, and the best set of as many cones was not looked for.
    pub(crate) is_draft: bool,
}

/// What cones are to be chosen for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// The area distortion that they keep within.
    pub(crate) target: f64,
    /// At most so many,
    pub(crate) most: usize,
    /// but a few more where that leaves nearly nothing to distort, and fewer where [hardly more](is_hardly_better) is left by these.
    pub(crate) to_knee: bool,
    /// Whether nothing better than the nested order is looked for where that misses the target: most of the time goes there, in vain where
    /// opened handles make other cones of it.
    pub(crate) is_draft: bool,
    /// Whether the surface is one of several, whose order may end where it tells enough to choose. Alone it is shown what more cones would give.
    pub(crate) is_part: bool,
}

impl Automatic {
    /// The same with the cones elsewhere, as a model of the surface has fitted them.
    pub(crate) fn moved(self, model: &EnergyModel, set: ConeSet, rule: CurvatureRule, target: f64) -> Self {
        let predicted = predict(model, &set, rule);
        let is_met = meets(&set, &predicted, target);
        let curvatures = if rule == CurvatureRule::Optimal { model.curvatures(&set) } else { None };
        Self { set, predicted, is_met, curvatures, ..self }
    }

    /// The log scale factor that is predicted for the cones. A back-substitution, one more for each cone if curvatures are harmonic.
    pub(crate) fn log_scale(&self, operators: &Operators, rule: CurvatureRule) -> VertexData<f64> {
        Configuration::new(operators, &self.set, rule).log_scale(operators)
    }
}

/// Chooses as few cones as keep the predicted area distortion within `target`, at most `most`, at least as many as the
/// surface needs, whatever the goal says of a knee. They will get their curvatures by `rule`; where they are is chosen for optimal ones.
pub(crate) fn automatic(model: &mut EnergyModel, rule: CurvatureRule, goal: Goal) -> Automatic {
    let Goal { target, most, to_knee, is_draft, is_part } = goal;
    let operators = model.operators();
    let least = least_cones(operators);
    let ordered = |model: &mut EnergyModel, pursuit: fn(&mut EnergyModel, usize) -> Nested, most: usize| {
        let nested = pursuit(model, most);
        let curve = nested.curve(operators, rule, model.watch());
        let enough = first_within(&curve, least, target).map(|point| point.count);
        (nested, curve, enough)
    };
    // A knee is looked for among twice as many.
    let few = if is_part { BRIEF_FOR_PART } else { BRIEF };
    let is_tried = 2 * least <= few && few < most && (is_part || few_may_do(model, rule, target));
    let brief = is_tried.then(|| ordered(model, brief_pursuit, few));
    let brief = brief.filter(|(_, _, enough)| enough.is_some_and(|count| 2 * count <= few));
    let is_brief = brief.is_some();
    let (mut nested, mut curve, enough) = brief.unwrap_or_else(|| ordered(model, pursuit, most.max(least)));
    let is_draft = is_draft && enough.is_none();
    let (set, predicted, passed) = match enough {
        Some(count) => fewest(model, &nested.sets[count], rule, target, least),
        None => {
            let worthwhile = curve.last().filter(|_| to_knee).and_then(|last| {
                let mut fewer = curve.iter().filter(|point| point.count >= least);
                fewer.find(|fewer| is_hardly_better(last, fewer)).map(|fewer| fewer.count)
            });
            let count = worthwhile.unwrap_or(most.max(least));
            let best = if is_draft { nested.sets.get(count).or(nested.sets.last()).cloned() } else { None };
            let set = best.unwrap_or_else(|| refined_without_draws(model, count));
            let predicted = predict(model, &set, rule);
            (set, predicted, Vec::new())
        }
    };
    let is_met = predicted.area_distortion <= target;
    if is_brief && !is_part {
        // Nothing is chosen among these, each put where it lowers the energy most: they tell what more cones would give.
        let known = nested.cones().len();
        let last = nested.sets.last().cloned().unwrap_or_else(|| model.fit(&[]));
        let longer = grow(model, last, most, Rule::Gain).cones;
        nested.followed_by(&longer[known..], &mut curve, (model, rule));
    }
    Automatic { set, predicted, is_met, passed, nested, curve, is_from_level: false, curvatures: None, is_draft }
}

/// Whether the distortion that at least twice as many cones leave is hardly less.
pub(super) fn is_hardly_better(more: &Prediction, fewer: &Prediction) -> bool {
    let excess = |point: &Prediction| point.area_distortion - 1.0;
    2 * fewer.count <= more.count && excess(fewer) <= HARDLY * excess(more) && is_tolerable(fewer)
}

/// Whether no more is left than is left where cones do not help; more may be left by thin limbs, where many more cones than are tried here do.
pub(super) fn is_tolerable(prediction: &Prediction) -> bool {
    prediction.area_distortion <= TOLERABLE
}

/// Whether cones that an order would begin with anyway tell that few are enough. A prediction.
fn few_may_do(model: &mut EnergyModel, rule: CurvatureRule, target: f64) -> bool {
    let set = model.with_largest_corner(COMFORTABLE_CORNER, |model| {
        let first = start(model, PROBE);
        grow(model, first, PROBE, Rule::Gradient)
    });
    meets(&set, &predict(model, &set, rule), target)
}

/// [`automatic`], and a few cones more where these leave nearly nothing to distort. A fit for the corners; a search more only
/// where the nested order tells that it pays.
pub(crate) fn automatic_to_knee(model: &mut EnergyModel, rule: CurvatureRule, goal: Goal) -> Automatic {
    let found = automatic(model, rule, goal);
    if found.is_draft {
        return found;
    }
    let knee = at_corners(model, &found).or_else(|| {
        let set = refined_without_draws(model, bend(&found, found.set.log_scale_norm())?);
        Some(set).filter(|set| found.has_knee_at(set))
    });
    match knee {
        Some(set) => found.with_knee(model, set, rule, goal.target),
        None => found,
    }
}

impl Automatic {
    /// Whether a set of more cones leaves nearly nothing of what these leave to distort.
    pub(super) fn has_knee_at(&self, set: &ConeSet) -> bool {
        set.shortfall == 0.0 && set.log_scale_norm() <= KNEE * self.set.log_scale_norm()
    }

    /// The same with the cones at its knee, unless these miss the target.
    pub(super) fn with_knee(self, model: &EnergyModel, set: ConeSet, rule: CurvatureRule, target: f64) -> Self {
        let predicted = predict(model, &set, rule);
        let is_met = predicted.area_distortion <= target;
        if is_met || !self.is_met { Self { set, predicted, is_met, curvatures: None, ..self } } else { self }
    }
}

/// A cone at each corner, if there are few and they are the curve's knee.
pub(super) fn at_corners(model: &mut EnergyModel, found: &Automatic) -> Option<ConeSet> {
    let corners = few_corners(model.operators(), found)?;
    model.add(&corners);
    let set = model.fit(&corners);
    found.has_knee_at(&set).then(|| by_curvature(model, &set))
}

/// Whether there are so few corners that a cone at each may be the knee.
pub(super) fn has_few_corners(operators: &Operators, found: &Automatic) -> bool {
    few_corners(operators, found).is_some()
}

fn few_corners(operators: &Operators, found: &Automatic) -> Option<Vec<VertexId>> {
    let count = found.set.cones.len();
    let most = if count == 0 { 0 } else { (2 * count).max(FEW) };
    corners(operators, most).filter(|corners| corners.len() > count)
}

/// The number of cones where the nested order tells of a knee beyond what was found, with a norm as that order has it.
pub(super) fn bend(found: &Automatic, norm: f64) -> Option<usize> {
    let count = found.set.cones.len();
    let beyond = found.nested.sets.iter().take(2 * count + 1).skip(count + 1);
    let bend = beyond.map(ConeSet::log_scale_norm).position(|left| left <= NESTED_KNEE * norm)?;
    Some(count + 1 + bend)
}

/// The inner vertices that have curvature, at most so many: without them the surface is developable.
pub(crate) fn corners(operators: &Operators, most: usize) -> Option<Vec<VertexId>> {
    let mesh = operators.mesh();
    let is_corner = |&v: &VertexId| operators.curvature()[v].abs() > LEAST_CORNER && !mesh.is_boundary_vertex(v);
    let corners: Vec<VertexId> = mesh.vertices().filter(is_corner).take(most + 1).collect();
    (corners.len() <= most).then_some(corners)
}

/// The shortest prefix of an order of cones that keeps the predicted area distortion within `target`; all of it where
/// none does. One and a half back-solves for each cone and a back-substitution for each prefix, one more for each cone if curvatures are harmonic.
pub(crate) fn shortest(model: &mut EnergyModel, order: &[VertexId], rule: CurvatureRule, target: f64) -> Automatic {
    let nested = Nested::new(model, order);
    let operators = model.operators();
    let curve = nested.curve(operators, rule, model.watch());
    let enough = first_within(&curve, least_cones(operators), target).copied();
    let set = nested.sets[enough.map_or(order.len(), |point| point.count)].clone();
    let predicted = enough.unwrap_or_else(|| predict(model, &set, rule));
    let is_met = enough.is_some();
    let (passed, is_from_level) = (Vec::new(), false);
    Automatic { set, predicted, is_met, passed, nested, curve, is_from_level, curvatures: None, is_draft: false }
}

/// Where a curve first keeps the area distortion within a target, from `least` cones on.
fn first_within(curve: &[Prediction], least: usize, target: f64) -> Option<&Prediction> {
    curve.iter().find(|point| point.count >= least && point.area_distortion <= target)
}

/// Whether cones can take the curvature, and the prediction for them is within the target.
pub(super) fn meets(set: &ConeSet, predicted: &Prediction, target: f64) -> bool {
    set.shortfall == 0.0 && predicted.area_distortion <= target
}

/// From a set that meets the target to the smallest one near it that does; with those in between.
fn fewest(
    model: &mut EnergyModel,
    nested: &ConeSet,
    rule: CurvatureRule,
    target: f64,
    least: usize,
) -> (ConeSet, Prediction, Vec<ConeSet>) {
    let mut best = refined_without_draws(model, nested.cones.len());
    let mut predicted = predict(model, &best, rule);
    if !meets(&best, &predicted, target) {
        return (nested.clone(), predict(model, nested, rule), Vec::new());
    }
    let mut passed = Vec::new();
    while best.cones.len() > least && !model.is_over() {
        let fewer = exchange(model, drop_cheapest(model, &best));
        let fewer = rounds(model, fewer, 2);
        let after = predict(model, &fewer, rule);
        if !meets(&fewer, &after, target) {
            break;
        }
        passed.push(std::mem::replace(&mut best, fewer));
        predicted = after;
    }
    (by_curvature(model, &best), predicted, passed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::cone_curvatures;
    use crate::placement::prediction::area_distortion;
    use geom::Watch;
    use geom::{Metric, shapes};

    fn goal(target: f64, most: usize) -> Goal {
        Goal { target, most, to_knee: false, is_draft: false, is_part: false }
    }

    fn choose(shape: &shapes::Shape, target: f64, most: usize) -> Automatic {
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        automatic(&mut EnergyModel::new(&operators, &mesh), CurvatureRule::Optimal, goal(target, most))
    }

    #[test]
    fn what_is_flat_gets_no_cones() {
        let flat = choose(&shapes::square(400), 1.25, 32);
        assert!(flat.is_met && flat.set.cones.is_empty());
    }

    #[test]
    fn where_cones_hardly_help_few_are_taken_unless_a_target_is_asked_for() {
        let point = |count, area_distortion| Prediction { count, log_scale_norm: 0.1, area_distortion };
        for (more, fewer, expected) in [
            (point(32, 1.30), point(0, 1.33), true),
            (point(32, 1.30), point(16, 1.33), true),
            (point(32, 1.30), point(16, 1.34), false),
            (point(32, 1.30), point(17, 1.31), false),
            (point(32, 1.52), point(0, 1.55), false),
        ] {
            assert_eq!(is_hardly_better(&more, &fewer), expected, "{more:?} {fewer:?}");
        }
        // White noise, each vertex of a square moved up or down by as much as an edge is long.
        let mut noise = shapes::square(900);
        let mut dice = 1_u64;
        for point in &mut noise.points {
            dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            point[2] = (f64::from((dice >> 32) as u32) / f64::from(u32::MAX) - 0.5) / 15.0;
        }
        let mesh = noise.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &noise.points)).unwrap();
        let [few, most] = [true, false].map(|to_knee| {
            let goal = Goal { to_knee, ..goal(1.05, 32) };
            let chosen = automatic(&mut EnergyModel::new(&operators, &mesh), CurvatureRule::Optimal, goal);
            assert!(!chosen.is_met);
            chosen.set.cones.len()
        });
        assert!(few <= 16 && most == 32, "{few} {most}");
    }

    #[test]
    fn a_tighter_target_takes_more_cones_and_is_met() {
        let counts = [2.0, 1.6, 1.4].map(|target| {
            let chosen = choose(&shapes::hare(1200), target, 32);
            assert!(chosen.is_met && chosen.predicted.area_distortion <= target, "{:?}", chosen.predicted);
            assert_eq!(chosen.predicted.count, chosen.set.cones.len());
            assert!(chosen.set.cones.len() >= 3);
            chosen.set.cones.len()
        });
        assert!(counts[0] <= counts[1] && counts[1] < counts[2], "{counts:?}");
    }

    /// A box of a by b by c unit cubes, its sides divided into squares.
    fn box_of(sides: [usize; 3]) -> shapes::Shape {
        let mut points: Vec<[f64; 3]> = Vec::new();
        let mut triangles = Vec::new();
        for axis in 0..3 {
            let (across, up) = ((axis + 1) % 3, (axis + 2) % 3);
            for end in [0, sides[axis]] {
                for (i, j) in (0..sides[across]).flat_map(|i| (0..sides[up]).map(move |j| (i, j))) {
                    let mut corner = |a: usize, b: usize| {
                        let mut point = [0.0; 3];
                        (point[axis], point[across], point[up]) = (end as f64, a as f64, b as f64);
                        points.iter().position(|p| *p == point).unwrap_or_else(|| {
                            points.push(point);
                            points.len() - 1
                        }) as u32
                    };
                    let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                    triangles.extend(if end == 0 { [[a, c, b], [a, d, c]] } else { [[a, b, c], [a, c, d]] });
                }
            }
        }
        shapes::Shape { points, triangles }
    }

    #[test]
    fn where_a_few_cones_more_leave_nothing_to_distort_they_are_taken() {
        for sides in [[1, 1, 1], [3, 2, 1], [9, 6, 3]] {
            let shape = box_of(sides);
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let fewest = automatic(&mut EnergyModel::new(&operators, &mesh), CurvatureRule::Optimal, goal(1.25, 32));
            assert!(fewest.set.cones.len() < 8);
            let chosen =
                automatic_to_knee(&mut EnergyModel::new(&operators, &mesh), CurvatureRule::Optimal, goal(1.25, 32));
            assert_eq!((chosen.set.cones.len(), chosen.is_met), (8, true), "{sides:?}");
            assert!(chosen.predicted.area_distortion < 1.0 + 1e-6);
        }
    }

    #[test]
    fn a_part_is_as_well_served_by_a_brief_order_and_gets_the_whole_one_where_that_is_too_short() {
        let [capsule, terrain] = [shapes::by_name("capsule", 500).unwrap(), shapes::terrain(900, 2)];
        let cases = [(capsule, 1.25, true), (terrain, 1.25, true), (shapes::hare(1200), 1.5, false)];
        for (shape, target, is_enough) in cases {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let [whole, part] = [false, true].map(|is_part| {
                let goal = Goal { is_part, ..goal(target, 32) };
                automatic(&mut EnergyModel::new(&operators, &mesh), CurvatureRule::Optimal, goal)
            });
            assert_eq!(whole.nested.sets.len(), 33);
            assert_eq!(whole.curve.last().map(|point| point.count), Some(32));
            let brief = brief_pursuit(&mut EnergyModel::new(&operators, &mesh), BRIEF);
            let is_lengthened = whole.nested.cones().starts_with(brief.cones());
            assert!(is_lengthened || 2 * whole.set.cones.len() > BRIEF, "more cones come after the brief order");
            assert_eq!(part.nested.sets.len(), if is_enough { BRIEF_FOR_PART + 1 } else { 33 }, "for {target}");
            assert!(part.is_met && part.set.cones.len() <= whole.set.cones.len() + 1);
        }
    }

    #[test]
    fn a_smooth_curve_has_no_knee() {
        let shape = shapes::hare(1200);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let choose = |choose: fn(&mut EnergyModel, CurvatureRule, Goal) -> Automatic| {
            choose(&mut EnergyModel::new(&operators, &mesh), CurvatureRule::Optimal, goal(1.6, 32)).set
        };
        assert_eq!(choose(automatic_to_knee), choose(automatic));
    }

    #[test]
    fn an_order_is_cut_where_it_first_meets_the_target() {
        let shape = shapes::hare(1200);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let mut model = EnergyModel::new(&operators, &mesh);
        let order = pursuit(&mut model, 12).cones().to_vec();
        let all = shortest(&mut model, &order, CurvatureRule::Optimal, 1.0001);
        assert!(!all.is_met && all.set.cones == order);
        for target in all.curve.iter().map(|point| point.area_distortion) {
            let cut = shortest(&mut model, &order, CurvatureRule::Optimal, target);
            assert!(cut.is_met && cut.predicted.area_distortion <= target);
            assert_eq!(cut.set.cones, order[..cut.predicted.count]);
            let mut shorter = cut.curve.iter().filter(|point| (3..cut.predicted.count).contains(&point.count));
            assert!(shorter.all(|point| point.area_distortion > target));
        }
    }

    #[test]
    fn a_draft_is_the_nested_order_where_that_misses_the_target_and_else_what_is_chosen() {
        let shape = shapes::hare(900);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let choose = |goal| automatic_to_knee(&mut EnergyModel::new(&operators, &mesh), CurvatureRule::Optimal, goal);
        let [met, missed] = [goal(1.6, 32), goal(1.0001, 6)].map(|goal| (goal, Goal { is_draft: true, ..goal }));
        let (whole, draft) = (choose(met.0), choose(met.1));
        assert!(!draft.is_draft && draft.set == whole.set);
        let (whole, draft) = (choose(missed.0), choose(missed.1));
        assert!(draft.is_draft && !draft.is_met && !whole.is_draft);
        assert_eq!(draft.set, draft.nested.sets[6]);
        assert!(whole.set.energy <= draft.set.energy);
    }

    #[test]
    fn what_the_nested_order_can_do_is_done() {
        let shape = shapes::hare(600);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let mut model = EnergyModel::new(&operators, &mesh);
        let nested = pursuit(&mut model, 12);
        for rule in [CurvatureRule::Optimal, CurvatureRule::Harmonic] {
            for point in nested.curve(&operators, rule, geom::Watch::NONE) {
                let chosen = automatic(&mut EnergyModel::new(&operators, &mesh), rule, goal(point.area_distortion, 12));
                assert!(chosen.is_met, "{rule:?}: {point:?} is possible, {:?} was taken", chosen.predicted);
                assert!(chosen.set.cones.len() <= point.count);
            }
        }
    }

    #[test]
    fn what_is_predicted_is_for_the_curvatures_that_will_be_used() {
        let shape = shapes::hare(1200);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        for rule in [CurvatureRule::Optimal, CurvatureRule::Harmonic] {
            let chosen = automatic(&mut EnergyModel::new(&operators, &mesh), rule, goal(1.5, 32));
            let used = cone_curvatures(&operators, &mesh, &chosen.set.cones, rule, Watch::NONE).unwrap();
            assert!(chosen.is_met);
            assert!((area_distortion(&operators, &used.predicted) - chosen.predicted.area_distortion).abs() < 1e-9);
        }
    }

    #[test]
    fn where_the_target_is_out_of_reach_the_most_are_taken_and_it_is_said() {
        let chosen = choose(&shapes::hare(1200), 1.0001, 5);
        assert!(!chosen.is_met);
        assert_eq!(chosen.set.cones.len(), 5);
        let near = choose(&shapes::hare(1200), 0.95 * chosen.predicted.area_distortion, 5);
        assert!(!near.is_met && near.predicted == chosen.predicted);
    }
}
