//! Points that cannot go to the diagonal: essential classes, and points born or dead at infinity.
//!
//! They are matched among each other, alike ones by rising coordinate, which for numbers on a line is the best matching in
//! every order.

use super::Diagram;
use super::ground::{Ground, Point, is_bounded};

/// Places in two lists that are matched, and how far apart they are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Matched {
    pub(super) pairs: Vec<[usize; 2]>,
    pub(super) steps: Vec<f64>,
}

/// The essential classes of two diagrams, as places among them; `None` if there are not as many.
pub(super) fn essential(a: &Diagram, b: &Diagram) -> Option<Matched> {
    let classes = |diagram: &Diagram| -> Vec<(usize, Point)> {
        diagram.essential.iter().map(|&birth| (birth, 0.0)).enumerate().collect()
    };
    in_order(classes(a), classes(b))
}

/// The points of two diagrams with an infinite coordinate, as places among the finite pairs; `None` if there are not as many.
pub(super) fn infinite(a: &Diagram, b: &Diagram) -> Option<Matched> {
    let points = |diagram: &Diagram| -> Vec<(usize, Point)> {
        diagram.finite.iter().copied().enumerate().filter(|(_, point)| !is_bounded(point)).collect()
    };
    in_order(points(a), points(b))
}

fn in_order(mut a: Vec<(usize, Point)>, mut b: Vec<(usize, Point)>) -> Option<Matched> {
    if a.len() != b.len() {
        return None;
    }
    sort(&mut a);
    sort(&mut b);
    // One coordinate at most differs by a finite number, so that all norms are one.
    let step = |(p, q): (&(usize, Point), &(usize, Point))| Ground::MAXIMUM.distance(p.1, q.1);
    let pairs = a.iter().zip(&b).map(|(p, q)| [p.0, q.0]).collect();
    Some(Matched { pairs, steps: a.iter().zip(&b).map(step).collect() })
}

/// Alike ones together, and those by the finite coordinate.
fn sort(points: &mut [(usize, Point)]) {
    let rank = |coordinate: f64| if coordinate.is_finite() { 0.0 } else { coordinate };
    points.sort_by(|(_, p), (_, q)| {
        let by_infinity = rank(p.0).total_cmp(&rank(q.0)).then(rank(p.1).total_cmp(&rank(q.1)));
        by_infinity.then(p.0.total_cmp(&q.0)).then(p.1.total_cmp(&q.1))
    });
}
