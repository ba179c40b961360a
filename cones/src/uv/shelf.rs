//! Islands in rows, so that they do not lie on each other.

use num_complex::Complex64;

use super::motion::Motion;
use super::triangle::Triangle;

/// The width of the rows, over the root of the islands' area.
const WIDTH: f64 = 1.5;
/// The gap between islands, over the same.
const GAP: f64 = 0.01;

/// Where islands go: the motion of each, from left to right in rows. O(triangles).
pub fn shelve(islands: &[Vec<Triangle>]) -> Vec<Motion> {
    let area: f64 = islands.iter().flatten().map(|&triangle| 0.5 * super::triangle::twice_area(triangle).abs()).sum();
    let mut shelf = Shelf::new(area);
    let place = |island: &Vec<Triangle>| {
        let [low, high] = island.iter().flatten().fold(NOWHERE, |[low, high], p| {
            [[0, 1].map(|i: usize| p[i].min(low[i])), [0, 1].map(|i: usize| p[i].max(high[i]))]
        });
        let corner = shelf.corner([0, 1].map(|i: usize| (high[i] - low[i]).max(0.0)));
        let [x, y] = [0, 1].map(|i: usize| if island.is_empty() { 0.0 } else { corner[i] - low[i] });
        Motion { turn: Complex64::ONE, shift: Complex64::new(x, y) }
    };
    islands.iter().map(place).collect()
}

/// The bounds of nothing.
const NOWHERE: [[f64; 2]; 2] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];

/// Rows of islands, filled from left to right.
struct Shelf {
    at: [f64; 2],
    height: f64,
    width: f64,
    gap: f64,
}

impl Shelf {
    fn new(area: f64) -> Self {
        Self { at: [0.0; 2], height: 0.0, width: WIDTH * area.sqrt(), gap: GAP * area.sqrt() }
    }

    /// The lower left corner of the next free place of this extent.
    fn corner(&mut self, extent: [f64; 2]) -> [f64; 2] {
        if self.at[0] > 0.0 && self.at[0] + extent[0] > self.width {
            self.at = [0.0, self.at[1] + self.height + self.gap];
            self.height = 0.0;
        }
        let corner = self.at;
        self.at[0] += extent[0] + self.gap;
        self.height = self.height.max(extent[1]);
        corner
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_two_islands_lie_on_each_other_and_none_is_turned(
            islands in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(prop::array::uniform2(-3.0..5.0f64)), 1..5), 2..30),
        ) {
            let bounds = |island: &[Triangle]| island.iter().flatten().fold(NOWHERE, |[low, high], p| {
                [[0, 1].map(|i: usize| p[i].min(low[i])), [0, 1].map(|i: usize| p[i].max(high[i]))]
            });
            let motions = shelve(&islands);
            let placed: Vec<Vec<Triangle>> = islands.iter().zip(&motions)
                .map(|(island, motion)| island.iter().map(|&t| motion.of_triangle(t)).collect()).collect();
            for (k, island) in placed.iter().enumerate() {
                prop_assert_eq!(motions[k].turn, Complex64::ONE);
                let [low, high] = bounds(island);
                prop_assert!(low.iter().all(|&x| x > -1e-9), "from the origin on");
                for other in &placed[..k] {
                    let [theirs, end] = bounds(other);
                    let apart = |i: usize| low[i] >= end[i] - 1e-12 || theirs[i] >= high[i] - 1e-12;
                    prop_assert!(apart(0) || apart(1));
                }
            }
        }
    }

    #[test]
    fn nothing_and_points_have_a_place() {
        let motions = shelve(&[vec![], vec![[[2.0, 3.0]; 3]]]);
        assert_eq!(motions[1].of([2.0, 3.0]), [0.0, 0.0]);
    }
}
