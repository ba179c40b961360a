//! Rectangles in a strip, each as low as it goes: the bottom-left skyline (Burke, Kendall & Whitwell 2004, without their
//! choice of the best fitting one).
//!
//! The upper edge of what is placed is kept as steps from left to right. O(rectangles × steps).

/// A step of the skyline.
#[derive(Clone, Copy, Debug)]
struct Step {
    x: f64,
    y: f64,
}

/// The lower left corners of rectangles in a strip of a width, placed in their order, and the height that they take.
/// None may be wider than the strip.
pub(super) fn skyline(extents: &[[f64; 2]], width: f64) -> (Vec<[f64; 2]>, f64) {
    let mut steps = vec![Step { x: 0.0, y: 0.0 }];
    let mut height = 0.0_f64;
    let places = extents.iter().map(|&extent| {
        let (first, last, y) = lowest(&steps, extent[0], width);
        let (x, top) = (steps[first].x, y + extent[1]);
        let after = Step { x: x + extent[0], y: steps[last].y };
        steps.splice(first..=last, [Step { x, y: top }, after]);
        // The end of the last step that is covered may be covered as a whole.
        if steps.get(first + 2).is_some_and(|next| next.x <= after.x) || after.x >= width {
            steps.remove(first + 1);
        }
        height = height.max(top);
        [x, y]
    });
    let places = places.collect();
    (places, height)
}

/// Where a rectangle of a width lies lowest: the steps it covers, first and last, and their height.
fn lowest(steps: &[Step], extent: f64, width: f64) -> (usize, usize, f64) {
    let mut best: Option<(usize, usize, f64)> = None;
    for first in 0..steps.len() {
        let end = steps[first].x + extent;
        // Beyond the strip by rounding only where it is as wide as the strip.
        if first > 0 && end > width {
            break;
        }
        let covered = steps[first..].iter().skip(1).take_while(|step| step.x < end).count();
        let y = steps[first..=first + covered].iter().fold(0.0, |y: f64, step| y.max(step.y));
        if best.is_none_or(|(_, _, lowest)| y < lowest) {
            best = Some((first, first + covered, y));
        }
    }
    best.expect("the first step is always tried")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_two_rectangles_lie_on_each_other(extents in prop::collection::vec([0.01..2.0f64, 0.01..2.0], 1..60), width in 2.0..9.0f64) {
            let (places, height) = skyline(&extents, width);
            for (k, (low, extent)) in places.iter().zip(&extents).enumerate() {
                prop_assert!(low[0] + extent[0] <= width * (1.0 + 1e-12) && low[1] + extent[1] <= height);
                for (other, theirs) in places.iter().zip(&extents).take(k) {
                    let apart = |i: usize| low[i] >= other[i] + theirs[i] || other[i] >= low[i] + extent[i];
                    prop_assert!(apart(0) || apart(1), "{places:?}");
                }
            }
        }
    }

    #[test]
    fn equal_squares_leave_nothing_free() {
        let (places, height) = skyline(&[[1.0, 1.0]; 12], 4.0);
        assert_eq!((height, places[5]), (3.0, [1.0, 1.0]));
    }
}
