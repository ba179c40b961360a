//! The bottleneck distance of points with finite coordinates: the least number of `f64` for which a matching exists.
//!
//! Matchings by augmenting paths (Hopcroft & Karp 1973), the number by bisection over the bits, as Efrat, Itai & Katz (2001)
//! bisect over the candidates. Whom a point can reach is sought among those whose births are within reach. For n points
//! O(n² · √n) a matching at worst, 64 of them at most.

use super::ground::{Ground, Point};
use crate::watch::Watch;
use core::ops::Range;

/// The least reach, no less than `least`, within which all points have a place; any number if the watch has stopped the work.
pub(super) fn bottleneck(a: &[Point], b: &[Point], ground: Ground, least: f64, watch: Watch<'_>) -> f64 {
    let by_birth = |points: &[Point]| {
        let mut points = points.to_vec();
        points.sort_unstable_by(|p, q| p.0.total_cmp(&q.0));
        points
    };
    let (a, b) = (by_birth(a), by_birth(b));
    // As far as the diagonal is from all, it does for all. Distances are not negative, so their bits rise as they do.
    let farthest = a.iter().chain(&b).map(|&point| ground.to_diagonal(point)).fold(least, f64::max);
    let (mut low, mut high) = (least.to_bits(), farthest.to_bits());
    while low < high {
        let middle = low + (high - low) / 2;
        let reach = f64::from_bits(middle);
        if covers(&a, &b, ground, reach, watch) && covers(&b, &a, ground, reach, watch) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    f64::from_bits(low)
}

/// Whether all points of `a` that are beyond reach of the diagonal can be matched with different points of `b`.
///
/// If that holds both ways, one matching does it for both (Mendelsohn & Dulmage 1958), and the rest is near the diagonal.
fn covers(a: &[Point], b: &[Point], ground: Ground, reach: f64, watch: Watch<'_>) -> bool {
    let far: Vec<Point> = a.iter().copied().filter(|&point| ground.to_diagonal(point) > reach).collect();
    if far.len() > b.len() {
        return false;
    }
    let window = |&(birth, _): &Point| {
        b.partition_point(|other| other.0 < birth - reach)..b.partition_point(|other| other.0 <= birth + reach)
    };
    let windows: Vec<Range<usize>> = far.iter().map(window).collect();
    let (partner, taken) = (vec![None; far.len()], vec![None; b.len()]);
    Matching { far: &far, others: b, windows: &windows, ground, reach, partner, taken, watch }.covers_all()
}

/// Hopcroft & Karp's matching of points within reach of each other.
struct Matching<'a> {
    far: &'a [Point],
    /// By birth.
    others: &'a [Point],
    /// For each point the others whose births are within reach.
    windows: &'a [Range<usize>],
    ground: Ground,
    reach: f64,
    partner: Vec<Option<usize>>,
    taken: Vec<Option<usize>>,
    watch: Watch<'a>,
}

impl Matching<'_> {
    fn covers_all(&mut self) -> bool {
        while self.partner.contains(&None) {
            let mut layers = self.layers();
            let free: Vec<usize> = (0..self.far.len()).filter(|&point| self.partner[point].is_none()).collect();
            if free.into_iter().filter(|&point| self.augment(point, &mut layers)).count() == 0 {
                return false;
            }
        }
        true
    }

    /// Distance of each point from the unmatched ones along alternating paths.
    fn layers(&self) -> Vec<Option<usize>> {
        let mut layers: Vec<_> = self.partner.iter().map(|partner| partner.is_none().then_some(0)).collect();
        let mut queue: Vec<usize> = (0..self.far.len()).filter(|&point| layers[point].is_some()).collect();
        let mut is_seen = vec![false; self.others.len()];
        let mut next = 0;
        while let Some(&point) = queue.get(next) {
            if self.watch.stops() {
                break;
            }
            next += 1;
            for other in self.windows[point].clone() {
                if is_seen[other] || !self.is_near(point, other) {
                    continue;
                }
                is_seen[other] = true;
                if let Some(owner) = self.taken[other].filter(|&owner| layers[owner].is_none()) {
                    layers[owner] = layers[point].map(|layer| layer + 1);
                    queue.push(owner);
                }
            }
        }
        layers
    }

    /// Looks for a free point along the layers from one of them, and swaps partners on the way. With a stack of its own,
    /// for paths can be as long as there are points.
    fn augment(&mut self, start: usize, layers: &mut [Option<usize>]) -> bool {
        // Each point of the path with the next other point to try.
        let mut path = vec![(start, self.windows[start].start)];
        while let Some((point, next)) = path.last_mut() {
            if self.watch.stops() {
                return false;
            }
            let (point, layer) = (*point, layers[*point]);
            let leads_on = |&other: &usize| {
                let owner_fits = self.taken[other].is_none_or(|owner| layers[owner] == layer.map(|layer| layer + 1));
                owner_fits && self.is_near(point, other)
            };
            let Some(other) = (*next..self.windows[point].end).find(leads_on) else {
                layers[point] = None;
                path.pop();
                continue;
            };
            *next = other + 1;
            match self.taken[other] {
                Some(owner) => path.push((owner, self.windows[owner].start)),
                None => {
                    for &(point, after) in &path {
                        self.partner[point] = Some(after - 1);
                        self.taken[after - 1] = Some(point);
                    }
                    path.iter().for_each(|&(point, _)| layers[point] = None);
                    return true;
                }
            }
        }
        false
    }

    fn is_near(&self, point: usize, other: usize) -> bool {
        self.ground.distance(self.far[point], self.others[other]) <= self.reach
    }
}
