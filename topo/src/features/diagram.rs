//! Persistence diagrams: pairs as points (birth, death), curves drawn from them, and how far two are apart.
//!
//! Both distances match the points of one diagram with those of the other or with the diagonal, where a point (b, d)
//! finds its nearest at |d - b| / 2; points are as far apart as the larger of their differences in birth and death. The
//! *bottleneck* distance is the least possible longest step, the *Wasserstein* distance of order p the least possible
//! p-norm of all steps. Cohen-Steiner, Edelsbrunner & Harer (2007), "Stability of persistence diagrams": fields that
//! differ by ε have diagrams at most ε apart in the first.
//!
//! Both are exact. The bottleneck distance is the least number of `f64` for which a matching exists: matchings by
//! augmenting paths (Hopcroft & Karp 1973), the number by bisection over the bits, as Efrat, Itai & Katz (2001) bisect
//! over the candidates. For n points O(n² · √n) a matching, 64 of them at most. The Wasserstein distance is an assignment
//! problem, solved by shortest augmenting paths (Jonker & Volgenant 1987) in O(n³). Both are meant for thousands of
//! points; for more, drop the least persistent ones: that moves the diagram by half their persistence at most.
//!
//! Points with an infinite coordinate and essential classes have no diagonal to go to: they are matched among each
//! other, by rising coordinate, and if their numbers differ the distance is infinite.

use crate::filtration::Kind;
use crate::persistence::{Pair, Pairs};
use crate::scalar::Scalar;

/// Points (birth, death) of finite pairs, and births of essential classes.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Diagram {
    /// Whether components are born at minima and die higher up, or at maxima and die lower down.
    pub kind: Kind,
    /// Birth and death of the finite pairs.
    pub finite: Vec<(f64, f64)>,
    /// Births of the classes that never die.
    pub essential: Vec<f64>,
}

impl<V: Copy, S: Scalar> Pairs<V, S> {
    /// The pairs as points. Integers beyond 2⁵³ are rounded.
    pub fn diagram(&self) -> Diagram {
        let number = |value: S| value.to_f64().unwrap_or(f64::NAN);
        let point = |pair: &Pair<V, S>| Some((number(pair.birth), number(pair.death()?)));
        Diagram {
            kind: self.kind(),
            finite: self.iter().filter_map(point).collect(),
            essential: self.essential().map(|pair| number(pair.birth)).collect(),
        }
    }
}

impl Diagram {
    /// The number of components at each level: (level, number from there on), by the direction in which components are
    /// born. Levels at which the number does not change are left out.
    pub fn betti_curve(&self) -> Vec<(f64, usize)> {
        let births = self.finite.iter().map(|&(birth, _)| birth).chain(self.essential.iter().copied());
        let mut events: Vec<(f64, bool)> = births.map(|birth| (birth, true)).collect();
        events.extend(self.finite.iter().map(|&(_, death)| (death, false)));
        events.sort_by(|a, b| if self.kind == Kind::Minimum { a.0.total_cmp(&b.0) } else { b.0.total_cmp(&a.0) });
        let mut curve: Vec<(f64, usize)> = Vec::new();
        let mut count = 0;
        for level in events.chunk_by(|a, b| a.0 == b.0) {
            let before = count;
            count += level.iter().filter(|event| event.1).count();
            count -= level.iter().filter(|event| !event.1).count();
            if count != before {
                curve.push((level[0].0, count));
            }
        }
        curve
    }

    /// The number of finite pairs more persistent than each threshold: (threshold, number from there on), beginning at 0.
    /// Long steps of this curve are good places for a threshold.
    pub fn persistence_curve(&self) -> Vec<(f64, usize)> {
        let mut widths: Vec<f64> = self.finite.iter().map(|&(birth, death)| birth.width(death)).collect();
        widths.sort_by(f64::total_cmp);
        let mut curve = vec![(0.0, widths.iter().filter(|&&width| width > 0.0).count())];
        for equal in widths.chunk_by(|a, b| a == b).filter(|equal| equal[0] > 0.0) {
            let remaining = curve[curve.len() - 1].1 - equal.len();
            curve.push((equal[0], remaining));
        }
        curve
    }

    /// The bottleneck distance: the least possible longest step when each point of one diagram goes to one of the other or to the
    /// diagonal, to each its own. Steps are measured by the larger of the differences in birth and death. Infinite if the
    /// diagrams do not have as many essential classes. Exact; fields that differ by ε at most have diagrams no farther
    /// apart than that. For thousands of points, see [`Pairs::above`] to drop what hardly matters.
    pub fn bottleneck(&self, other: &Self) -> f64 {
        let unbounded = unbounded_steps(self, other).into_iter().fold(0.0, f64::max);
        let (a, b) = (bounded(self), bounded(other));
        // Distances are not negative, so their bits rise as they do.
        let (mut low, mut high) = (0u64, f64::INFINITY.to_bits());
        while low < high {
            let middle = low + (high - low) / 2;
            let reach = f64::from_bits(middle);
            if reach >= unbounded && covers(&a, &b, reach) && covers(&b, &a, reach) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        f64::from_bits(low)
    }

    /// The Wasserstein distance of order p: as [`bottleneck`](Self::bottleneck), but the least possible p-norm of all steps. Orders below 1
    /// are taken for 1. Exact, O(n³) for n points.
    pub fn wasserstein(&self, other: &Self, order: f64) -> f64 {
        let order = order.max(1.0);
        let unbounded: f64 = unbounded_steps(self, other).into_iter().map(|step| step.powf(order)).sum();
        let (a, b) = (bounded(self), bounded(other));
        // Row i: point i of a, or the diagonal; column j: point j of b, or the diagonal.
        let cost = |i: usize, j: usize| {
            let step = match (a.get(i), b.get(j)) {
                (Some(&p), Some(&q)) => distance(p, q),
                (Some(&p), None) | (None, Some(&p)) => to_diagonal(p),
                (None, None) => 0.0,
            };
            step.powf(order)
        };
        let matched: f64 = assign(a.len() + b.len(), &cost).into_iter().map(|(i, j)| cost(i, j)).sum();
        (unbounded + matched).powf(order.recip())
    }
}

type Point = (f64, f64);

fn distance(p: Point, q: Point) -> f64 {
    p.0.width(q.0).max(p.1.width(q.1))
}

fn to_diagonal((birth, death): Point) -> f64 {
    birth.width(death) / 2.0
}

fn is_bounded((birth, death): &Point) -> bool {
    birth.is_finite() && death.is_finite()
}

fn bounded(diagram: &Diagram) -> Vec<Point> {
    diagram.finite.iter().copied().filter(is_bounded).collect()
}

/// The steps between essential classes and between points with infinite coordinates.
fn unbounded_steps(a: &Diagram, b: &Diagram) -> Vec<f64> {
    let mut steps = steps_in_order(&essential(a), &essential(b));
    steps.extend(steps_in_order(&infinite(a), &infinite(b)));
    steps
}

/// The steps from each point to that of the same place, which for sorted numbers is the best matching.
fn steps_in_order(a: &[Point], b: &[Point]) -> Vec<f64> {
    match a.len() == b.len() {
        true => a.iter().zip(b).map(|(&p, &q)| distance(p, q)).collect(),
        false => vec![f64::INFINITY],
    }
}

/// The essential classes by birth, as points that all die at the same place.
fn essential(diagram: &Diagram) -> Vec<Point> {
    let mut points: Vec<Point> = diagram.essential.iter().map(|&birth| (birth, 0.0)).collect();
    points.sort_by(|p, q| p.0.total_cmp(&q.0));
    points
}

/// The points with infinite coordinates: alike ones together, and those sorted by the finite coordinate.
fn infinite(diagram: &Diagram) -> Vec<Point> {
    let mut points: Vec<Point> = diagram.finite.iter().copied().filter(|point| !is_bounded(point)).collect();
    let rank = |coordinate: f64| if coordinate.is_finite() { 0.0 } else { coordinate };
    points.sort_by(|p, q| {
        let by_infinity = rank(p.0).total_cmp(&rank(q.0)).then(rank(p.1).total_cmp(&rank(q.1)));
        by_infinity.then(p.0.total_cmp(&q.0)).then(p.1.total_cmp(&q.1))
    });
    points
}

/// Whether all points of `a` that are beyond reach of the diagonal can be matched with different points of `b`.
///
/// If that holds both ways, one matching does it for both (Mendelsohn & Dulmage 1958), and the rest is near the diagonal.
fn covers(a: &[Point], b: &[Point], reach: f64) -> bool {
    let far: Vec<Point> = a.iter().copied().filter(|&point| to_diagonal(point) > reach).collect();
    let mut matching =
        Matching { far: &far, others: b, reach, partner: vec![None; far.len()], taken: vec![None; b.len()] };
    matching.covers_all()
}

/// Hopcroft & Karp's matching of points within reach of each other.
struct Matching<'a> {
    far: &'a [Point],
    others: &'a [Point],
    reach: f64,
    partner: Vec<Option<usize>>,
    taken: Vec<Option<usize>>,
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
        let mut unseen: Vec<usize> = (0..self.others.len()).collect();
        let mut next = 0;
        while let Some(&point) = queue.get(next) {
            next += 1;
            unseen.retain(|&other| {
                let is_near = self.is_near(point, other);
                if let Some(owner) = self.taken[other].filter(|&owner| is_near && layers[owner].is_none()) {
                    layers[owner] = layers[point].map(|layer| layer + 1);
                    queue.push(owner);
                }
                !is_near
            });
        }
        layers
    }

    /// Looks for a free point along the layers from one of them, and swaps partners on the way. With a stack of its own,
    /// for paths can be as long as there are points.
    fn augment(&mut self, start: usize, layers: &mut [Option<usize>]) -> bool {
        // Each point of the path with the next other point to try.
        let mut path = vec![(start, 0)];
        while let Some((point, next)) = path.last_mut() {
            let (point, layer) = (*point, layers[*point]);
            let leads_on = |&other: &usize| {
                let owner_fits = self.taken[other].is_none_or(|owner| layers[owner] == layer.map(|layer| layer + 1));
                owner_fits && self.is_near(point, other)
            };
            let Some(other) = (*next..self.others.len()).find(leads_on) else {
                layers[point] = None;
                path.pop();
                continue;
            };
            *next = other + 1;
            match self.taken[other] {
                Some(owner) => path.push((owner, 0)),
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
        distance(self.far[point], self.others[other]) <= self.reach
    }
}

/// The cheapest assignment of `n` rows to `n` columns, as (row, column).
///
/// Rows come in one by one; each looks for the shortest path to a free column in the costs reduced by the potentials.
fn assign(n: usize, cost: &impl Fn(usize, usize) -> f64) -> Vec<(usize, usize)> {
    // One column more, in which the row that comes in stands.
    let (mut row_potential, mut column_potential) = (vec![0.0; n], vec![0.0; n + 1]);
    let mut row_of: Vec<Option<usize>> = vec![None; n + 1];
    for row in 0..n {
        row_of[n] = Some(row);
        let mut column = n;
        let (mut slack, mut before) = (vec![f64::INFINITY; n], vec![n; n]);
        let mut visited = vec![false; n + 1];
        while let Some(row) = row_of[column] {
            visited[column] = true;
            for next in (0..n).filter(|&next| !visited[next]) {
                let reduced = cost(row, next) - row_potential[row] - column_potential[next];
                if reduced < slack[next] {
                    (slack[next], before[next]) = (reduced, column);
                }
            }
            let nearest = (0..n).filter(|&next| !visited[next]).min_by(|&a, &b| slack[a].total_cmp(&slack[b]));
            let nearest = nearest.expect("a column is free while a row comes in");
            let step = slack[nearest];
            for place in 0..=n {
                match row_of[place].filter(|_| visited[place]) {
                    Some(row) => {
                        row_potential[row] += step;
                        column_potential[place] -= step;
                    }
                    None if place < n && !visited[place] => slack[place] -= step,
                    None => {}
                }
            }
            column = nearest;
        }
        while column != n {
            row_of[column] = row_of[before[column]];
            column = before[column];
        }
    }
    row_of.into_iter().take(n).enumerate().filter_map(|(column, row)| Some((row?, column))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagram(finite: &[Point]) -> Diagram {
        Diagram { kind: Kind::Minimum, finite: finite.to_vec(), essential: vec![0.0] }
    }

    #[test]
    fn a_lone_point_goes_to_the_diagonal() {
        assert_eq!(diagram(&[(0.0, 3.0)]).bottleneck(&diagram(&[])), 1.5);
        assert_eq!(diagram(&[(0.0, 3.0)]).wasserstein(&diagram(&[]), 1.0), 1.5);
    }

    #[test]
    fn near_points_are_matched() {
        let (a, b) = (diagram(&[(0.0, 3.0), (1.0, 1.5)]), diagram(&[(0.5, 3.0)]));
        assert_eq!(a.bottleneck(&b), 0.5);
        assert_eq!(a.wasserstein(&b, 1.0), 0.75);
        assert_eq!(a.wasserstein(&b, 2.0), (0.25f64 + 0.0625).sqrt());
    }

    #[test]
    fn essential_classes_have_nowhere_else_to_go() {
        let two = Diagram { kind: Kind::Minimum, finite: vec![], essential: vec![0.0, 5.0] };
        assert_eq!(two.bottleneck(&diagram(&[])), f64::INFINITY);
        assert_eq!(two.bottleneck(&Diagram { kind: Kind::Minimum, finite: vec![], essential: vec![4.0, 1.0] }), 1.0);
    }

    #[test]
    fn infinite_pairs_are_matched_among_each_other() {
        let a = diagram(&[(f64::NEG_INFINITY, 2.0)]);
        assert_eq!(a.bottleneck(&diagram(&[(f64::NEG_INFINITY, 3.0)])), 1.0);
        assert_eq!(a.wasserstein(&diagram(&[]), 2.0), f64::INFINITY);
    }

    #[test]
    fn curves_count_components() {
        let diagram = Diagram { kind: Kind::Minimum, finite: vec![(1.0, 4.0), (2.0, 3.0)], essential: vec![0.0] };
        assert_eq!(diagram.betti_curve(), [(0.0, 1), (1.0, 2), (2.0, 3), (3.0, 2), (4.0, 1)]);
        assert_eq!(diagram.persistence_curve(), [(0.0, 2), (1.0, 1), (3.0, 0)]);
    }
}
