//! Persistence diagrams: pairs as points (birth, death), curves drawn from them, and how far two are apart.
//!
//! Both distances match the points of one diagram with those of the other or with the diagonal, where a point (b, d)
//! finds its nearest at |d - b| / 2; points are as far apart as the larger of their differences in birth and death. The
//! *bottleneck* distance is the least possible longest step, the *Wasserstein* distance of order p the least possible
//! p-norm of all steps. Cohen-Steiner, Edelsbrunner & Harer (2007), "Stability of persistence diagrams": fields that
//! differ by ε have diagrams at most ε apart in the first.
//!
//! Bottleneck distances are exact: bisection over matchings. Wasserstein distances are a rectangular assignment problem, solved
//! exactly for small diagrams; for large ones by an auction on a k-d tree, to a stated relative error.
//!
//! Points with an infinite coordinate and essential classes have no diagonal to go to: they are matched among each
//! other, by rising coordinate, and if their numbers differ the distance is infinite.

mod assignment;
mod auction;
mod bottleneck;
mod ground;
mod kd_tree;
mod unbounded;
mod vectors;
mod wasserstein;

pub use wasserstein::{Matching, Wasserstein};

use crate::error::Error;
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
    /// The bottleneck distance: the least possible longest step when each point of one diagram goes to one of the other or to the
    /// diagonal, to each its own. Steps are measured by the larger of the differences in birth and death. Infinite if the
    /// diagrams do not have as many essential classes. Exact; fields that differ by ε at most have diagrams no farther apart than
    /// that.
    ///
    /// # Errors
    /// If one diagram is of minima and the other of maxima, or if a coordinate is NaN.
    pub fn bottleneck(&self, other: &Self) -> Result<f64, Error> {
        Wasserstein::new(f64::INFINITY).distance(self, other)
    }

    /// The Wasserstein distance of order p: as [`bottleneck`](Self::bottleneck), but the least possible p-norm of all steps.
    /// Exact for small diagrams, larger ones to one per cent at most ([`Wasserstein::relative_error`]), so that what is measured from the other end may
    /// differ by as much. [`Wasserstein`] has other ground metrics, and the matching itself.
    ///
    /// # Errors
    /// As [`bottleneck`](Self::bottleneck), or if the order is not 1 at least.
    pub fn wasserstein(&self, other: &Self, order: f64) -> Result<f64, Error> {
        Wasserstein::new(order).distance(self, other)
    }

    /// The number of components at each level: (level, number from there on), by the direction in which components are
    /// born. Levels at which the number does not change are left out, and so are pairs that die before they are born.
    pub fn betti_curve(&self) -> Vec<(f64, usize)> {
        let lives =
            |&&(birth, death): &&(f64, f64)| if self.kind == Kind::Minimum { birth <= death } else { birth >= death };
        let living = || self.finite.iter().filter(lives);
        let births = living().map(|&(birth, _)| birth).chain(self.essential.iter().copied());
        let mut events: Vec<(f64, bool)> = births.map(|birth| (birth, true)).collect();
        events.extend(living().map(|&(_, death)| (death, false)));
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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagram(finite: &[(f64, f64)]) -> Diagram {
        Diagram { kind: Kind::Minimum, finite: finite.to_vec(), essential: vec![0.0] }
    }

    #[test]
    fn a_lone_point_goes_to_the_diagonal() {
        assert_eq!(diagram(&[(0.0, 3.0)]).bottleneck(&diagram(&[])), Ok(1.5));
        assert_eq!(diagram(&[(0.0, 3.0)]).wasserstein(&diagram(&[]), 1.0), Ok(1.5));
    }

    #[test]
    fn near_points_are_matched() {
        let (a, b) = (diagram(&[(0.0, 3.0), (1.0, 1.5)]), diagram(&[(0.5, 3.0)]));
        assert_eq!(a.bottleneck(&b), Ok(0.5));
        assert_eq!(a.wasserstein(&b, 1.0), Ok(0.75));
        assert_eq!(a.wasserstein(&b, 2.0), Ok((0.25f64 + 0.0625).sqrt()));
    }

    #[test]
    fn essential_classes_have_nowhere_else_to_go() {
        let two = Diagram { kind: Kind::Minimum, finite: vec![], essential: vec![0.0, 5.0] };
        assert_eq!(two.bottleneck(&diagram(&[])), Ok(f64::INFINITY));
        assert_eq!(
            two.bottleneck(&Diagram { kind: Kind::Minimum, finite: vec![], essential: vec![4.0, 1.0] }),
            Ok(1.0)
        );
    }

    #[test]
    fn infinite_pairs_are_matched_among_each_other() {
        let a = diagram(&[(f64::NEG_INFINITY, 2.0)]);
        assert_eq!(a.bottleneck(&diagram(&[(f64::NEG_INFINITY, 3.0)])), Ok(1.0));
        assert_eq!(a.wasserstein(&diagram(&[]), 2.0), Ok(f64::INFINITY));
    }

    #[test]
    fn curves_count_components() {
        let diagram = Diagram { kind: Kind::Minimum, finite: vec![(1.0, 4.0), (2.0, 3.0)], essential: vec![0.0] };
        assert_eq!(diagram.betti_curve(), [(0.0, 1), (1.0, 2), (2.0, 3), (3.0, 2), (4.0, 1)]);
        assert_eq!(diagram.persistence_curve(), [(0.0, 2), (1.0, 1), (3.0, 0)]);
    }

    #[test]
    fn a_pair_that_dies_before_it_is_born_is_no_component() {
        for (kind, sign) in [(Kind::Minimum, 1.0), (Kind::Maximum, -1.0)] {
            let finite = vec![(2.0 * sign, sign), (3.0 * sign, 4.0 * sign)];
            let diagram = Diagram { kind, finite, essential: vec![] };
            assert_eq!(diagram.betti_curve(), [(3.0 * sign, 1), (4.0 * sign, 0)]);
        }
    }
}
