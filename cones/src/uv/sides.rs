//! The sides that bound what triangles cover.
//!
//! Each triangle is taken counter-clockwise. Its sides, as directed edges, are added up: a side that runs both ways between the same two
//! points cancels. The winding number of what is left about a point off it is the number of triangles that cover the point, however they
//! lie over each other.

use std::collections::hash_map::Entry;
use std::ops::Range;

use geom::{Interrupted, Rows, Watch};
use rayon::prelude::*;

use super::table::Table;
use super::triangle::Triangle;

/// Triangles are gone through in so many runs at the same time, then what each leaves together: few sides are between two runs where
/// neighbours have near numbers.
const RUNS: usize = 8;
/// Where neighbours have near numbers the sides that wait for their other way are about as many as in a row of a run. Where this many
/// times more wait, and at least so many, which is more than the cache holds, triangles are put in order first.
const WAITING_A_ROW: usize = 16;
const LEAST_WAITING: usize = 1 << 14;
/// Cells to a side of the grid that puts them in order.
const GRID: usize = 64;
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
    let length = triangles.len().div_ceil(RUNS).max(1);
    let run = |k: usize| triangles.len().min(k * length)..triangles.len().min((k + 1) * length);
    let most = LEAST_WAITING.max(WAITING_A_ROW * length.isqrt());
    let by_number = |k: usize| open.of(run(k).flat_map(sides_of), most);
    let runs = (0..RUNS).into_par_iter().map(by_number).collect::<Result<Option<Vec<_>>, Interrupted>>();
    let left = match runs? {
        Some(runs) => runs.concat(),
        None => {
            let order = cell_by_cell(triangles);
            let in_order = |k: usize| open.of_any(order[run(k)].iter().flat_map(|&f| sides_of(f as usize)));
            let runs = (0..RUNS).into_par_iter().map(in_order).collect::<Result<Vec<_>, Interrupted>>();
            runs?.concat()
        }
    };
    let mut left = open.of_any(left.into_iter())?;
    left.sort_unstable();
    Ok(left)
}

fn sides_of(f: usize) -> Range<u32> {
    3 * f as u32..3 * f as u32 + 3
}

/// Triangles in an order in which neighbours are near each other, cell by cell of a grid over what is finite.
fn cell_by_cell(triangles: &[Triangle]) -> Vec<u32> {
    let first = || triangles.iter().map(|corners| corners[0]);
    let finite = || first().filter(|p| p.iter().all(|x| x.is_finite()));
    let low = finite().fold([f64::INFINITY; 2], |low, p| [0, 1].map(|i| low[i].min(p[i])));
    let high = finite().fold([f64::NEG_INFINITY; 2], |high, p| [0, 1].map(|i| high[i].max(p[i])));
    let scale = [0, 1].map(|i| (GRID as f64 - 0.5) / (high[i] - low[i]));
    let cell = |p: [f64; 2]| [0, 1].map(|i| (((p[i] - low[i]) * scale[i]) as usize).min(GRID - 1));
    let in_rows = first().map(cell).map(|[column, row]| row * GRID + column).zip(0..);
    Rows::sorted(GRID * GRID, in_rows).into_items()
}

/// A side that has not come the other way yet.
struct Waiting {
    number: u32,
    way: bool,
    /// The next one that waits behind it.
    next: Option<u32>,
}

struct Open<'a, T> {
    triangles: &'a [Triangle],
    turned: T,
    watch: Watch<'a>,
}

impl<T: Fn(u32) -> Option<Turned>> Open<'_, T> {
    /// Some sides without those that cancel.
    fn of_any(&self, sides: impl Iterator<Item = u32>) -> Result<Vec<u32>, Interrupted> {
        Ok(self.of(sides, usize::MAX)?.expect("no more than that can wait"))
    }

    /// The same; none if sides between more than `most` pairs of points have to wait for their other way.
    fn of(&self, sides: impl Iterator<Item = u32>, most: usize) -> Result<Option<Vec<u32>>, Interrupted> {
        let mut waiting: Table<(u32, Ends), Waiting> = Table::default();
        // Those that wait behind another one between the same points.
        let mut behind: Vec<(u32, Option<u32>)> = Vec::new();
        for (count, number) in sides.enumerate() {
            if count.is_multiple_of(STRIDE) {
                self.watch.ask(f64::NAN)?;
            }
            if waiting.len() > most {
                return Ok(None);
            }
            let Some(Turned { island, is_clockwise }) = (self.turned)(number / 3) else { continue };
            let (ends, way) = self.directed(number);
            let way = way != is_clockwise;
            match waiting.entry((island, ends)) {
                Entry::Vacant(place) => _ = place.insert(Waiting { number, way, next: None }),
                Entry::Occupied(mut other) if other.get().way != way => match other.get().next {
                    Some(next) => (other.get_mut().number, other.get_mut().next) = behind[next as usize],
                    None => _ = other.remove(),
                },
                Entry::Occupied(mut same) => {
                    behind.push((same.get().number, same.get().next));
                    *same.get_mut() = Waiting { number, way, next: Some(behind.len() as u32 - 1) };
                }
            }
        }
        let mut left = Vec::new();
        for Waiting { number, mut next, .. } in waiting.into_values() {
            left.push(number);
            while let Some(at) = next {
                left.push(behind[at as usize].0);
                next = behind[at as usize].1;
            }
        }
        Ok(Some(left))
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

    #[test]
    fn the_order_of_triangles_does_not_matter() {
        let sheet = grid(200);
        // All come once, since 28,573 is no multiple of 2 or 5; neighbours are far apart.
        let scattered: Vec<Triangle> = (0..sheet.len()).map(|k| sheet[k * 28_573 % sheet.len()]).collect();
        let plain = |_: u32| Some(Turned { island: 0, is_clockwise: false });
        let open = Open { triangles: &scattered, turned: plain, watch: Watch::NONE };
        let run = 3 * scattered.len().div_ceil(RUNS) as u32;
        assert_eq!(open.of(0..run, LEAST_WAITING), Ok(None), "so many sides wait that triangles are put in order");
        let sides = |triangles: &[Triangle]| {
            let mut sides: Vec<_> = open_sides(triangles, plain, Watch::NONE).unwrap();
            sides.sort_by_key(|&k| side(triangles, k).map(|p| p.map(f64::to_bits)));
            sides.into_iter().map(|k| side(triangles, k)).collect::<Vec<_>>()
        };
        assert_eq!(sides(&scattered).len(), 800);
        assert_eq!(sides(&scattered), sides(&sheet));
    }

    #[test]
    fn copies_that_come_one_way_first_and_then_the_other_take_no_longer() {
        let one = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let over = [one[0], one[2], one[1]];
        let copies = 100_000;
        let both: Vec<Triangle> = (0..2 * copies + 3).map(|k| if k < copies { one } else { over }).collect();
        assert_eq!(count(&both, |_| Some(Turned { island: 0, is_clockwise: false })), 9);
    }
}
