//! How large a square islands take.

use num_complex::Complex64;

use super::hull::{Enclosing, enclosing};

pub(in crate::uv) use super::hull::convex_hull;

/// The side of the smallest square about an island, in any turn; of several islands the root of the sum of squares, as if
/// nothing could stand in another's square. `islands` are the points on their boundaries. Nothing is placed: this is for
/// comparing. O(b log b) for b points.
pub(crate) fn room(islands: Vec<Vec<Complex64>>) -> f64 {
    islands.into_iter().map(|points| side(&convex_hull(points)).powi(2)).sum::<f64>().sqrt()
}

/// The side of the smallest square about a convex polygon, in any turn. O(h log h) for h corners.
pub(in crate::uv) fn side(hull: &[Complex64]) -> f64 {
    let side = enclosing(hull).iter().map(Enclosing::side).fold(f64::INFINITY, f64::min);
    if side.is_finite() { side } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_takes_its_own_room_however_it_is_turned_and_two_take_twice_as_much() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Complex64::new(x, y));
        for angle in [0.0, 0.3, 1.0] {
            let square = corners.map(|z| z * Complex64::from_polar(1.0, angle)).to_vec();
            assert!((room(vec![square.clone()]) - 1.0).abs() < 1e-12);
            assert!((room(vec![square.clone(), square]) - 2.0_f64.sqrt()).abs() < 1e-12);
        }
        assert_eq!(room(vec![Vec::new()]), 0.0);
    }
}
