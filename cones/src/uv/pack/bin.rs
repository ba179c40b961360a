//! A square of cells that fills with islands, and the search for the next one's place.
//!
//! An island fits at (x, y) if none of the cells it takes there is kept off. For one y all x are tested at once, 64 to a word:
//! a run of cells a..b of a row blocks x where any of the row's bits x + a..x + b is set. With rows kept for all powers
//! of two, bit x of level k telling whether one of the bits x..x + 2ᵏ is set, that is two shifted rows, whatever its length.
//! Words are gone through one after the other, each until all of its places are blocked: where much is kept off, few runs do
//! that, and the first place is found without the rest of the row.

use super::raster::{Run, Shape};

/// A square of cells.
pub(super) struct Bin {
    side: usize,
    words: usize,
    /// Level k, row after row.
    levels: Vec<Vec<u64>>,
}

/// What makes one place better than another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// A low upper edge.
    Low,
    /// The smallest square about the lower left corner that has it all.
    Corner,
}

/// A place for a shape; the lower the `cost` the better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    cost: [usize; 2],
    pub(super) at: [usize; 2],
}

impl Bin {
    pub(super) fn new(side: usize) -> Self {
        // Shifted rows are read up to two words past the last.
        let words = side.div_ceil(64) + 2;
        let levels = side.max(1).ilog2() as usize + 1;
        Self { side, words, levels: vec![vec![0; words * side]; levels] }
    }

    /// Whether nothing has been added.
    pub(super) fn is_empty(&self) -> bool {
        self.levels[0].iter().all(|&word| word == 0)
    }

    /// The best place for a shape that is better than one already found; `work` counts the words that were looked at.
    pub(super) fn place(&self, shape: &Shape, rule: Rule, better_than: Option<Place>, work: &mut u64) -> Option<Place> {
        let [width, height] = shape.size;
        if width > self.side || height > self.side {
            return None;
        }
        let mut best = better_than;
        let mut found = None;
        for y in 0..=self.side - height {
            if best.is_some_and(|best| best.cost[0] < y + height) {
                break;
            }
            // Beyond this x no place is better.
            let last = match (rule, best) {
                (_, None) => self.side - width,
                (Rule::Low, Some(best)) if best.cost[0] > y + height => self.side - width,
                (Rule::Low, Some(best)) => best.cost[1].min(self.side - width),
                (Rule::Corner, Some(best)) => best.cost[0].min(self.side).saturating_sub(width),
            };
            let Some(x) = self.first_free(shape, y, last, work) else { continue };
            let cost = match rule {
                Rule::Low => [y + height, x],
                Rule::Corner => [(x + width).max(y + height), x + y],
            };
            let place = Place { cost, at: [x, y] };
            if best.is_none_or(|best| place < best) {
                best = Some(place);
                found = Some(place);
            }
            if rule == Rule::Low {
                break;
            }
        }
        found
    }

    /// The first x up to the last where a shape fits at a height.
    fn first_free(&self, shape: &Shape, y: usize, last: usize, work: &mut u64) -> Option<usize> {
        for word in 0..=last / 64 {
            let mut blocked = if word == last / 64 { !(u64::MAX >> (63 - last % 64)) } else { 0 };
            for run in &shape.taken {
                *work += 1;
                blocked |= self.blocked(*run, y, word);
                if blocked == u64::MAX {
                    break;
                }
            }
            if blocked != u64::MAX {
                return Some(64 * word + blocked.trailing_ones() as usize);
            }
        }
        None
    }

    /// Which places of a word are blocked for a run.
    fn blocked(&self, run: Run, y: usize, word: usize) -> u64 {
        let level = (run.to - run.from).ilog2() as usize;
        let start = (y + run.row) * self.words;
        let row = &self.levels[level][start..start + self.words];
        let bits = |from: usize| {
            let (at, shift) = (word + from / 64, from % 64);
            row[at] >> shift | (row[at + 1] << 1) << (63 - shift)
        };
        bits(run.from) | bits(run.to - (1 << level))
    }

    /// Keeps others off a shape at a place.
    pub(super) fn add(&mut self, shape: &Shape, at: [usize; 2]) {
        let [width, height] = shape.kept_off.size;
        let first = at[1].saturating_sub(shape.pad);
        let last = (at[1] + height - shape.pad).min(self.side);
        for y in first..last {
            let from = shape.kept_off.row(y + shape.pad - at[1]);
            let row = &mut self.levels[0][y * self.words..(y + 1) * self.words];
            or_moved(row, from, at[0], shape.pad, self.side);
        }
        let to = (at[0] + width - shape.pad).min(self.side);
        for level in 1..self.levels.len() {
            let (lower, upper) = self.levels.split_at_mut(level);
            for y in first..last {
                let rows = y * self.words..(y + 1) * self.words;
                let (row, below) = (&mut upper[0][rows.clone()], &lower[level - 1][rows]);
                // Beyond the last word that has changed rows are as they were.
                let end = to.div_ceil(64);
                row[..end].copy_from_slice(&below[..end]);
                or_shifted(&mut row[..end], below, 1 << (level - 1));
            }
        }
    }
}

/// Sets bit x of `target` where bit x + `shift` of `row` is set; `row` must have a word more than that takes.
fn or_shifted(target: &mut [u64], row: &[u64], shift: usize) {
    let (words, bits) = (shift / 64, shift % 64);
    let row = &row[words.min(row.len())..];
    if bits == 0 {
        target.iter_mut().zip(row).for_each(|(target, &word)| *target |= word);
    } else {
        for (target, pair) in target.iter_mut().zip(row.windows(2)) {
            *target |= pair[0] >> bits | pair[1] << (64 - bits);
        }
    }
}

/// Sets bit x of `row` where bit x - `at` + `pad` of `from` is set, for x up to `side`.
fn or_moved(row: &mut [u64], from: &[u64], at: usize, pad: usize, side: usize) {
    if at < pad {
        let words = row.len();
        let mut wide = from.to_vec();
        wide.resize(from.len() + 2, 0);
        or_shifted(&mut row[..words.min(from.len())], &wide, pad - at);
    } else {
        let (words, bits) = ((at - pad) / 64, (at - pad) % 64);
        for (k, &word) in from.iter().enumerate() {
            if let Some(target) = row.get_mut(words + k) {
                *target |= word << bits;
            }
            if bits > 0
                && let Some(target) = row.get_mut(words + k + 1)
            {
                *target |= word >> (64 - bits);
            }
        }
    }
    for (k, word) in row.iter_mut().enumerate().skip(side / 64) {
        *word &= if k == side / 64 { !(u64::MAX << (side % 64)) } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;
    use proptest::prelude::*;

    fn triangle(corners: [[f64; 2]; 3], margin: f64) -> Shape {
        let [a, b, c] = corners.map(|p| Complex64::new(p[0], p[1]));
        Shape::new(&[[a, b], [b, c], [c, a]], Complex64::new(1.0, 0.0), 1.0, margin)
    }

    /// The cells of a square, one by one.
    struct Plain(Vec<Vec<bool>>);

    impl Plain {
        fn fits(&self, shape: &Shape, [x, y]: [usize; 2]) -> bool {
            shape.taken.iter().all(|run| (run.from..run.to).all(|k| !self.0[y + run.row][x + k]))
        }

        fn add(&mut self, shape: &Shape, [x, y]: [usize; 2]) {
            for run in shape.kept_off.runs() {
                for k in run.from..run.to {
                    let cell = [x + k, y + run.row].map(|n| n.checked_sub(shape.pad));
                    if let [Some(x), Some(y)] = cell
                        && let Some(cell) = self.0.get_mut(y).and_then(|row| row.get_mut(x))
                    {
                        *cell = true;
                    }
                }
            }
        }
    }

    proptest! {
        #[test]
        fn the_first_place_is_that_of_trying_all(
            triangles in prop::collection::vec([[0.0..40.0f64, 0.0..30.0], [0.0..40.0, 0.0..30.0], [0.0..40.0, 0.0..30.0]], 1..8),
            side in 20..150usize,
            margin in 0.0..5.0f64,
        ) {
            let mut bin = Bin::new(side);
            let mut plain = Plain(vec![vec![false; side]; side]);
            for shape in triangles.iter().map(|&corners| triangle(corners, margin)) {
                for rule in [Rule::Low, Rule::Corner] {
                    let all = (0..side).flat_map(|y| (0..side).map(move |x| [x, y]));
                    let inside = all.filter(|at| (0..2).all(|k| at[k] + shape.size[k] <= side));
                    let free = inside.filter(|&at| plain.fits(&shape, at));
                    let cost = |[x, y]: [usize; 2]| match rule {
                        Rule::Low => [y + shape.size[1], x],
                        Rule::Corner => [(x + shape.size[0]).max(y + shape.size[1]), x + y],
                    };
                    let best = free.map(|at| Place { cost: cost(at), at }).min();
                    prop_assert_eq!(bin.place(&shape, rule, None, &mut 0).map(|place| place.cost), best.map(|place| place.cost));
                }
                if let Some(place) = bin.place(&shape, Rule::Low, None, &mut 0) {
                    bin.add(&shape, place.at);
                    plain.add(&shape, place.at);
                }
            }
        }
    }
}
