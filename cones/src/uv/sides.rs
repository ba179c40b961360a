//! The sides that bound what triangles cover.
//!
//! Each triangle is taken counter-clockwise. Its sides, as directed edges, are added up: a side that runs both ways between the same two
//! points cancels. The winding number of what is left about a point off it is the number of triangles that cover the point, however they
//! lie over each other.

use std::collections::hash_map::Entry;

use geom::{Interrupted, Watch};
use rayon::prelude::*;

use super::table::Table;
use super::triangle::Triangle;

/// Triangles are gone through in so many runs at the same time, then what each leaves together: few sides are between two runs where
/// neighbours have near numbers.
const RUNS: usize = 8;
/// The watch is asked once for so many sides.
const STRIDE: usize = 1 << 16;

/// The ends of a side as bits, the lesser first.
type Ends = [[u64; 2]; 2];

/// Of triangles that are added up together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turned {
    /// Sides cancel within an island.
    pub(super) island: u32,
    /// Whether it is turned clockwise, so that its sides run the other way.
    pub(super) is_clockwise: bool,
}

/// The sides of triangles that do not run both ways, side k of triangle f as 3 f + k, ascending. Triangles that are no [`Turned`] have
/// none. Of sides that run one way n times more often than the other n are left, whichever. O(n), and memory for those that wait for their
/// other way.
///
/// # Errors
/// If it is stopped.
pub(super) fn open_sides(
    triangles: &[Triangle],
    turned: impl Fn(u32) -> Option<Turned> + Sync,
    watch: Watch,
) -> Result<Vec<u32>, Interrupted> {
    let open = Open { triangles, turned, watch };
    let run = triangles.len().div_ceil(RUNS).max(1);
    let of_run = |k: usize| {
        let sides = [k * run, (k + 1) * run].map(|f| 3 * f.min(triangles.len()) as u32);
        open.of(sides[0]..sides[1])
    };
    let runs: Vec<Result<Vec<u32>, Interrupted>> = (0..RUNS).into_par_iter().map(of_run).collect();
    let mut left = runs.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
    loop {
        let before = left.len();
        left = open.of(left.into_iter())?;
        // One that comes twice before its other way does is left at first.
        if left.len() == before {
            left.sort_unstable();
            return Ok(left);
        }
    }
}

struct Open<'a, T> {
    triangles: &'a [Triangle],
    turned: T,
    watch: Watch<'a>,
}

impl<T: Fn(u32) -> Option<Turned>> Open<'_, T> {
    /// Some sides without those that cancel.
    fn of(&self, sides: impl Iterator<Item = u32>) -> Result<Vec<u32>, Interrupted> {
        let mut waiting: Table<(u32, Ends), (u32, bool)> = Table::default();
        let mut again = Vec::new();
        for (count, number) in sides.enumerate() {
            if count.is_multiple_of(STRIDE) {
                self.watch.ask(f64::NAN)?;
            }
            let Some(Turned { island, is_clockwise }) = (self.turned)(number / 3) else { continue };
            let (ends, way) = self.directed(number);
            let way = way != is_clockwise;
            match waiting.entry((island, ends)) {
                Entry::Vacant(place) => _ = place.insert((number, way)),
                Entry::Occupied(other) if other.get().1 != way => _ = other.remove(),
                Entry::Occupied(_) => again.push(number),
            }
        }
        again.extend(waiting.into_values().map(|(number, _)| number));
        Ok(again)
    }

    /// The ends of a side as bits, the lesser first, and whether it runs from that one.
    fn directed(&self, number: u32) -> (Ends, bool) {
        // + 0.0 makes -0.0 the same point.
        let [a, b] = side(self.triangles, number).map(|p| p.map(|x| (x + 0.0).to_bits()));
        if a < b { ([a, b], true) } else { ([b, a], false) }
    }
}

/// The ends of a side in its triangle's order.
pub(super) fn side(triangles: &[Triangle], number: u32) -> [[f64; 2]; 2] {
    let (corners, k) = (&triangles[number as usize / 3], number as usize % 3);
    [corners[k], corners[(k + 1) % 3]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An n × n grid of squares of two triangles each.
    fn grid(n: usize) -> Vec<Triangle> {
        let square = |i: usize, j: usize| {
            let at = |di: usize, dj: usize| [(i + di) as f64, (j + dj) as f64];
            [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]]
        };
        (0..n * n).flat_map(|k| square(k % n, k / n)).collect()
    }

    fn count(triangles: &[Triangle], turned: impl Fn(u32) -> Option<Turned> + Sync) -> usize {
        open_sides(triangles, turned, Watch::NONE).unwrap().len()
    }

    #[test]
    fn what_is_left_bounds_each_island_as_often_as_it_is_covered() {
        let sheet = grid(20);
        let plain = |_| Some(Turned { island: 0, is_clockwise: false });
        assert_eq!(count(&sheet, plain), 80);
        let twice = [sheet.clone(), sheet.clone()].concat();
        assert_eq!(count(&twice, plain), 160);
        let last = |f: u32| f as usize >= sheet.len();
        assert_eq!(count(&twice, |f| Some(Turned { island: u32::from(last(f)), is_clockwise: false })), 160);
        assert_eq!(count(&twice, |f| (!last(f)).then_some(Turned { island: 0, is_clockwise: false })), 80);
        // Turned over and counted the other way round it is the same sheet; counted as it is it takes the first one away.
        let over = sheet.iter().map(|&[a, b, c]| [a, c, b]);
        let both: Vec<Triangle> = sheet.iter().copied().chain(over).collect();
        assert_eq!(count(&both, |f| Some(Turned { island: 0, is_clockwise: last(f) })), 160);
        assert_eq!(count(&both, plain), 0);
    }
}
