//! The bottleneck distance of points with finite coordinates: the least number of `f64` for which a matching exists.
//!
//! Matchings by augmenting paths (Hopcroft & Karp 1973), the number by bisection over the bits, as Efrat, Itai & Katz (2001)
//! bisect over the candidates; like them, whom a point can reach is asked of a search structure from which those that a round has
//! seen are taken out, so that a round looks for each point once. A matching is carried on from one number to the next, without the
//! steps that have become too long. For n points O(n log n) a round if points lie well, √n rounds and 64 numbers at most.

use super::ground::{Ground, Point};
use super::kd_tree::{KdTree, Offer};
use crate::pairing::NONE;
use crate::watch::Watch;

/// By how much norms that are computed with roots may be off.
const ROUNDING: f64 = 1e-12;

/// The least reach, no less than `least`, within which all points have a place; any number if the watch has stopped the work.
pub(super) fn bottleneck(a: &[Point], b: &[Point], ground: Ground, least: f64, watch: Watch<'_>) -> f64 {
    let mut sides = [Side::new(a, b, ground), Side::new(b, a, ground)];
    // As far as the diagonal is from all, it does for all; and nobody's nearest place is farther than the distance.
    let farthest = sides.iter().flat_map(|side| &side.to_diagonal).copied().fold(least, f64::max);
    let nearest = sides.iter().map(|side| side.farthest_of_nearest(least, watch)).fold(least, f64::max);
    let slack = if ground == Ground::MAXIMUM { 0.0 } else { ROUNDING };
    // Distances are not negative, so their bits rise as they do.
    let (mut low, mut high) = ((nearest * (1.0 - slack)).max(least).to_bits(), farthest.to_bits());
    // What is least possible is often enough.
    let mut next = nearest.to_bits();
    while low < high {
        let reach = f64::from_bits(next);
        if sides.iter_mut().all(|side| side.is_covered(reach, watch)) {
            high = next;
        } else {
            low = next + 1;
        }
        next = low + high.saturating_sub(low) / 2;
    }
    f64::from_bits(high)
}

/// The points of one diagram, and those of the other that they can go to.
///
/// If all points of each diagram that are beyond reach of the diagonal can be matched with different points of the other, one
/// matching does it for both (Mendelsohn & Dulmage 1958), and the rest is near the diagonal.
struct Side<'a> {
    points: &'a [Point],
    to_diagonal: Vec<f64>,
    others: &'a [Point],
    tree: KdTree,
    ground: Ground,
    /// For each point the other that it goes to, and the other way round.
    partner: Vec<u32>,
    taken: Vec<u32>,
}

impl<'a> Side<'a> {
    fn new(points: &'a [Point], others: &'a [Point], ground: Ground) -> Self {
        let to_diagonal = points.iter().map(|&point| ground.to_diagonal(point)).collect();
        let (partner, taken) = (vec![NONE; points.len()], vec![NONE; others.len()]);
        Self { points, to_diagonal, others, tree: KdTree::new(others), ground, partner, taken }
    }

    /// How far it is at least from each point to some place, if that is more than `least`; the longest of these ways.
    fn farthest_of_nearest(&self, least: f64, watch: Watch<'_>) -> f64 {
        let cost = |x: f64, y: f64| self.ground.norm(x, y);
        self.points.iter().zip(&self.to_diagonal).fold(least, |farthest, (&point, &to_diagonal)| {
            if to_diagonal <= farthest || watch.stops() {
                return farthest;
            }
            let mut offer = Offer { best: to_diagonal, second: to_diagonal, ..Offer::NONE };
            self.tree.offer(point, &cost, &mut offer);
            farthest.max(offer.best)
        })
    }

    /// Whether all points that are beyond reach of the diagonal can be matched with different others.
    fn is_covered(&mut self, reach: f64, watch: Watch<'_>) -> bool {
        let far: Vec<u32> = (0..).zip(&self.to_diagonal).filter(|&(_, &way)| way > reach).map(|(p, _)| p).collect();
        if far.len() > self.others.len() {
            return false;
        }
        for (point, partner) in self.partner.iter_mut().enumerate().filter(|(_, partner)| **partner != NONE) {
            let other = *partner as usize;
            let is_kept = self.to_diagonal[point] > reach
                && self.ground.distance(self.points[point], self.others[other]) <= reach;
            if !is_kept {
                (*partner, self.taken[other]) = (NONE, NONE);
            }
        }
        let mut free: Vec<u32> = far.into_iter().filter(|&point| self.partner[point as usize] == NONE).collect();
        while !free.is_empty() {
            let mut layers = self.layers(&free, reach, watch);
            let before = free.len();
            free.retain(|&point| !self.augment(point, &mut layers, reach));
            if free.len() == before || watch.stops() {
                return false;
            }
        }
        true
    }

    /// The others that free points reach, then those that the owners of these reach, and so on until some have no owner.
    fn layers(&mut self, free: &[u32], reach: f64, watch: Watch<'_>) -> Vec<Layer> {
        let (mut layers, mut from) = (Vec::new(), free.to_vec());
        self.tree.offer_all();
        while !from.is_empty() && !watch.stops() {
            let (mut reached, mut owners, mut is_last) = (Vec::new(), Vec::new(), false);
            for point in from {
                while let Some(other) = self.tree.take(self.points[point as usize], self.ground, reach) {
                    reached.push(other);
                    match self.taken[other as usize] {
                        NONE => is_last = true,
                        owner => owners.push(owner),
                    }
                }
            }
            let places: Vec<Point> = reached.iter().map(|&other| self.others[other as usize]).collect();
            layers.push(Layer { tree: KdTree::new(&places), others: reached });
            from = if is_last { Vec::new() } else { owners };
        }
        layers
    }

    /// Looks for an other without owner along the layers, and swaps partners on the way. With a stack of its own, for paths can be as
    /// long as there are points. What has been looked at is taken out of its layer.
    fn augment(&mut self, start: u32, layers: &mut [Layer], reach: f64) -> bool {
        // The points of the path, and the others between them.
        let (mut path, mut between) = (vec![start], Vec::new());
        while let Some(&point) = path.last() {
            let layer = layers.get_mut(path.len() - 1);
            let Some(other) = layer.and_then(|layer| layer.take(self.points[point as usize], self.ground, reach))
            else {
                path.pop();
                between.pop();
                continue;
            };
            between.push(other);
            match self.taken[other as usize] {
                NONE => {
                    for (&point, &other) in path.iter().zip(&between) {
                        (self.partner[point as usize], self.taken[other as usize]) = (other, point);
                    }
                    return true;
                }
                owner => path.push(owner),
            }
        }
        false
    }
}

/// Others that are equally many steps from the free points.
struct Layer {
    tree: KdTree,
    others: Vec<u32>,
}

impl Layer {
    fn take(&mut self, from: Point, ground: Ground, reach: f64) -> Option<u32> {
        Some(self.others[self.tree.take(from, ground, reach)? as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_carried_on_from_one_number_to_the_next_changes_nothing() {
        let mut random = 1_u64;
        let mut coordinate = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f64 / (1 << 24) as f64
        };
        let mut harder = 0;
        for _ in 0..20 {
            // Far from the diagonal, so that all have to go to each other.
            let [a, b] = [(); 2].map(|()| (0..40).map(|_| (coordinate(), 10.0 + coordinate())).collect::<Vec<Point>>());
            let ground = Ground::MAXIMUM;
            let covers = |reach: f64| {
                [(&a, &b), (&b, &a)].iter().all(|(p, q)| Side::new(p, q, ground).is_covered(reach, Watch::NONE))
            };
            let mut steps: Vec<f64> = a.iter().flat_map(|&p| b.iter().map(move |&q| ground.distance(p, q))).collect();
            steps.sort_unstable_by(f64::total_cmp);
            let least = steps[steps.partition_point(|&step| !covers(step))];
            assert_eq!(bottleneck(&a, &b, ground, 0.0, Watch::NONE), least);
            let nearest = Side::new(&a, &b, ground).farthest_of_nearest(0.0, Watch::NONE);
            harder += usize::from(least > nearest);
        }
        assert!(harder > 3, "the first number that is tried must not be enough: {harder}");
    }
}
