//! How many cones, when nobody says: as few as keep the area distortion within a target.
//!
//! The distortion of a flattening is predicted from the linear log scale factor, before anything is flattened (on thirty
//! meshes the median error was 0.001). The curve of the nested order says about how many cones it takes; the best set of
//! that number is better than nested ones, so cones are taken away from it as long as the target holds.

use geom::VertexId;

use crate::angles::{Angles, least_cones};
use crate::distortion::{Predicted, predict};
use crate::exchange::{drop_cheapest, exchange};
use crate::pursuit::{Nested, pursuit};
use crate::reduced::{Fitted, Reduced};
use crate::refined::{by_curvature, refined, rounds};

/// The area distortion that is aimed at when nobody says.
pub const TARGET_DISTORTION: f64 = 1.25;

/// No more cones than this are taken by themselves.
pub const MOST_AUTOMATIC: usize = 32;

/// A number of cones chosen by their predicted distortion.
#[derive(Clone, Debug)]
pub struct Automatic {
    /// The cones.
    pub set: Fitted,
    /// What is predicted for them.
    pub predicted: Predicted,
    /// The target.
    pub target: f64,
    /// Whether the prediction meets it.
    pub is_met: bool,
    /// The nested order that led there.
    pub nested: Nested,
    /// What is predicted for its prefixes.
    pub curve: Vec<Predicted>,
}

/// Chooses as few cones as keep the predicted area distortion within `target`, at most `most`, at least as many as the
/// surface needs. They will get their curvatures by the rule `angles`; where they are is chosen for optimal ones.
pub fn automatic(reduced: &mut Reduced, angles: Angles, target: f64, most: usize) -> Automatic {
    let operators = reduced.operators();
    let least = least_cones(operators);
    let nested = pursuit(reduced, most.max(least));
    let curve = nested.curve(operators, angles);
    let (set, predicted) = match first_within(&curve, least, target) {
        Some(point) => fewest(reduced, &nested.sets[point.count], angles, target, least),
        None => {
            let set = refined(reduced, most.max(least));
            let predicted = predict(operators, &set, angles);
            (set, predicted)
        }
    };
    Automatic { set, predicted, target, is_met: predicted.area_distortion <= target, nested, curve }
}

/// The shortest prefix of an order of cones that keeps the predicted area distortion within `target`; all of it where
/// none does. One and a half back-solves for each cone and half a one for each prefix, one more for each cone if curvatures are harmonic.
pub fn shortest(reduced: &mut Reduced, order: &[VertexId], angles: Angles, target: f64) -> Automatic {
    let nested = Nested::new(reduced, order);
    let operators = reduced.operators();
    let curve = nested.curve(operators, angles);
    let enough = first_within(&curve, least_cones(operators), target).copied();
    let set = nested.sets[enough.map_or(order.len(), |point| point.count)].clone();
    let predicted = enough.unwrap_or_else(|| predict(operators, &set, angles));
    Automatic { set, predicted, target, is_met: enough.is_some(), nested, curve }
}

/// Where a curve first keeps the area distortion within a target, from `least` cones on.
fn first_within(curve: &[Predicted], least: usize, target: f64) -> Option<&Predicted> {
    curve.iter().find(|point| point.count >= least && point.area_distortion <= target)
}

/// From a set that meets the target to the smallest one near it that does.
fn fewest(reduced: &mut Reduced, nested: &Fitted, angles: Angles, target: f64, least: usize) -> (Fitted, Predicted) {
    let operators = reduced.operators();
    let meets = |set: &Fitted, predicted: &Predicted| set.shortfall == 0.0 && predicted.area_distortion <= target;
    let mut best = refined(reduced, nested.cones.len());
    let mut predicted = predict(operators, &best, angles);
    if !meets(&best, &predicted) {
        return (nested.clone(), predict(operators, nested, angles));
    }
    while best.cones.len() > least && !reduced.is_spent() {
        let fewer = exchange(reduced, drop_cheapest(reduced, &best));
        let fewer = rounds(reduced, fewer, 2);
        let after = predict(operators, &fewer, angles);
        if !meets(&fewer, &after) {
            break;
        }
        (best, predicted) = (fewer, after);
    }
    (by_curvature(reduced, &best), predicted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angles::cone_curvatures;
    use crate::distortion::area_distortion;
    use crate::operators::Operators;
    use geom::{Metric, shapes};

    fn choose(shape: &shapes::Shape, target: f64, most: usize) -> Automatic {
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        automatic(&mut Reduced::new(&operators, &mesh), Angles::Optimal, target, most)
    }

    #[test]
    fn what_is_flat_gets_no_cones() {
        let flat = choose(&shapes::square(400), TARGET_DISTORTION, MOST_AUTOMATIC);
        assert!(flat.is_met && flat.set.cones.is_empty());
    }

    #[test]
    fn a_tighter_target_takes_more_cones_and_is_met() {
        let counts = [2.0, 1.6, 1.4].map(|target| {
            let chosen = choose(&shapes::hare(1200), target, MOST_AUTOMATIC);
            assert!(chosen.is_met && chosen.predicted.area_distortion <= target, "{:?}", chosen.predicted);
            assert_eq!(chosen.predicted.count, chosen.set.cones.len());
            assert!(chosen.set.cones.len() >= 3);
            chosen.set.cones.len()
        });
        assert!(counts[0] <= counts[1] && counts[1] < counts[2], "{counts:?}");
    }

    #[test]
    fn an_order_is_cut_where_it_first_meets_the_target() {
        let shape = shapes::hare(1200);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let mut reduced = Reduced::new(&operators, &mesh);
        let order = pursuit(&mut reduced, 12).cones().to_vec();
        let all = shortest(&mut reduced, &order, Angles::Optimal, 1.0001);
        assert!(!all.is_met && all.set.cones == order);
        for target in all.curve.iter().map(|point| point.area_distortion) {
            let cut = shortest(&mut reduced, &order, Angles::Optimal, target);
            assert!(cut.is_met && cut.predicted.area_distortion <= target);
            assert_eq!(cut.set.cones, order[..cut.predicted.count]);
            let mut shorter = cut.curve.iter().filter(|point| (3..cut.predicted.count).contains(&point.count));
            assert!(shorter.all(|point| point.area_distortion > target));
        }
    }

    #[test]
    fn what_the_nested_order_can_do_is_done() {
        let shape = shapes::hare(600);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let mut reduced = Reduced::new(&operators, &mesh);
        let nested = pursuit(&mut reduced, 12);
        for angles in [Angles::Optimal, Angles::Harmonic] {
            for point in nested.curve(&operators, angles) {
                let chosen = automatic(&mut Reduced::new(&operators, &mesh), angles, point.area_distortion, 12);
                assert!(chosen.is_met, "{angles:?}: {point:?} is possible, {:?} was taken", chosen.predicted);
                assert!(chosen.set.cones.len() <= point.count);
            }
        }
    }

    #[test]
    fn what_is_predicted_is_for_the_curvatures_that_will_be_used() {
        let shape = shapes::hare(1200);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        for angles in [Angles::Optimal, Angles::Harmonic] {
            let chosen = automatic(&mut Reduced::new(&operators, &mesh), angles, 1.5, MOST_AUTOMATIC);
            let used = cone_curvatures(&operators, &mesh, &chosen.set.cones, angles).unwrap();
            assert!(chosen.is_met);
            assert!((area_distortion(&operators, &used.predicted) - chosen.predicted.area_distortion).abs() < 1e-9);
        }
    }

    #[test]
    fn where_the_target_is_out_of_reach_the_most_are_taken_and_it_is_said() {
        let chosen = choose(&shapes::hare(1200), 1.0001, 5);
        assert!(!chosen.is_met);
        assert_eq!(chosen.set.cones.len(), 5);
    }
}
