//! An island as cells of a grid, conservatively.
//!
//! A cell is a unit square. An island *takes* the cells that one of its edges touches, and those whose centre it winds about;
//! it *keeps off* the cells that come closer to it than the margin. If no cell that one island takes is kept off by
//! another, the two are at least the margin apart: no finer test is needed, whatever the size of the cells.

use num_complex::Complex64;

use super::island_place::quarter;

/// Edges are taken to be wider by this many cells, against rounding.
const ROUNDING: f64 = 1e-6;

/// Cells of an island that is turned and scaled, its lower left corner in cell (0, 0).
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// How its island is turned.
    pub(super) turn: Complex64,
    /// The lower left corner of the turned island, in cells.
    pub(super) low: Complex64,
    /// How many cells it spans, across and up.
    pub(super) size: [usize; 2],
    /// The cells that it takes; see [`spread`].
    pub(super) taken: Vec<Run>,
    /// The cells that it keeps off, around (`pad`, `pad`).
    pub(super) kept_off: Bitmap,
    pub(super) pad: usize,
}

/// Cells `from..to` of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) row: usize,
    pub(super) from: usize,
    pub(super) to: usize,
}

impl Shape {
    /// The cells of an island: `edges` about its centre, turned and scaled, and a margin in cells.
    pub(super) fn new(edges: &[[Complex64; 2]], turn: Complex64, scale: f64, margin: f64) -> Self {
        let mut edges: Vec<[Complex64; 2]> = edges.iter().map(|edge| edge.map(|z| z * turn * scale)).collect();
        let (mut low, mut high) = (Complex64::new(f64::MAX, f64::MAX), Complex64::new(f64::MIN, f64::MIN));
        for z in edges.iter().flatten() {
            low = Complex64::new(low.re.min(z.re), low.im.min(z.im));
            high = Complex64::new(high.re.max(z.re), high.im.max(z.im));
        }
        let inset = Complex64::new(ROUNDING, ROUNDING);
        let low = low - inset;
        let size = [high.re - low.re, high.im - low.im].map(|extent| (extent + ROUNDING) as usize + 1);
        edges.iter_mut().flatten().for_each(|z| *z -= low);
        let mut cells = Bitmap::new(size);
        fill(&mut cells, &edges);
        edges.iter().for_each(|&edge| touched(&mut cells, edge));
        let pad = margin.ceil() as usize + 1;
        let mut kept_off = cells.padded(pad);
        let shift = Complex64::new(pad as f64, pad as f64);
        edges.iter().for_each(|edge| capsule(&mut kept_off, edge.map(|z| z + shift), margin));
        Self { turn, low, size, taken: spread(cells.runs()), kept_off, pad }
    }

    /// The cells of the island turned further by a quarter: these, turned with their grid.
    pub(super) fn quarter_on(&self) -> Self {
        let [width, height] = self.size;
        let mut cells = Bitmap::new(self.size);
        self.taken.iter().for_each(|run| cells.set(run.row, run.from, run.to));
        Self {
            turn: quarter(1) * self.turn,
            low: quarter(1) * self.low - Complex64::new(height as f64, 0.0),
            size: [height, width],
            taken: spread(cells.quarter_on().runs()),
            kept_off: self.kept_off.quarter_on(),
            pad: self.pad,
        }
    }
}

/// The longest run first, then from all over, by their numbers with the bits reversed: neighbours mostly block the same places,
/// so that few of these block a word of them. (Longest first takes 1.2 times as long for 85 islands, 1.4 times for 300.)
fn spread(runs: Vec<Run>) -> Vec<Run> {
    let count = runs.len();
    let bits = count.next_power_of_two().trailing_zeros();
    let reversed = |k: usize| k.reverse_bits().checked_shr(usize::BITS - bits).unwrap_or(0);
    let longest = (0..count).max_by_key(|&k| (runs[k].to - runs[k].from, std::cmp::Reverse(k)));
    let others = (0..1 << bits).map(reversed).filter(|&k| k < count && Some(k) != longest);
    longest.into_iter().chain(others).map(|k| runs[k]).collect()
}

/// Sets the cells whose centre is wound about.
fn fill(cells: &mut Bitmap, edges: &[[Complex64; 2]]) {
    let [width, height] = cells.size;
    let mut steps: Vec<Vec<(usize, i32)>> = vec![Vec::new(); height];
    for &[a, b] in edges {
        let (low, high, way) = if a.im <= b.im { (a, b, 1) } else { (b, a, -1) };
        // Rows whose centre line is crossed, the lower end included.
        let rows = (low.im + 0.5) as usize..(high.im + 0.5) as usize;
        for (row, steps) in steps.iter_mut().enumerate().take(rows.end.min(height)).skip(rows.start) {
            let y = row as f64 + 0.5;
            if !(low.im <= y && y < high.im) {
                continue;
            }
            let x = low.re + (y - low.im) * ((high.re - low.re) / (high.im - low.im));
            // The first cell whose centre is not left of the crossing.
            steps.push((((x - 0.5).ceil().max(0.0) as usize).min(width), way));
        }
    }
    for (row, steps) in steps.iter_mut().enumerate() {
        steps.sort_unstable();
        let mut winding = 0;
        for pair in steps.windows(2) {
            winding += pair[0].1;
            if winding != 0 {
                cells.set(row, pair[0].0, pair[1].0);
            }
        }
    }
}

/// Sets the cells that an edge touches.
fn touched(cells: &mut Bitmap, [a, b]: [Complex64; 2]) {
    let (low, high) = if a.im <= b.im { (a, b) } else { (b, a) };
    let slope = (high.re - low.re) / (high.im - low.im);
    // The end of the edge that is cut off by a line, or the end that it has.
    let at = |y: f64| match low.re + (y - low.im) * slope {
        _ if y <= low.im => low.re,
        x if y < high.im => x,
        _ => high.re,
    };
    let [width, height] = cells.size;
    let first = (low.im - ROUNDING).max(0.0) as usize;
    let last = ((high.im + ROUNDING).max(0.0) as usize).min(height - 1);
    for row in first..=last {
        let ends = [at(row as f64 - ROUNDING), at((row + 1) as f64 + ROUNDING)];
        let from = (ends[0].min(ends[1]) - ROUNDING).max(0.0) as usize;
        let to = ((ends[0].max(ends[1]) + ROUNDING).max(0.0) as usize + 1).min(width);
        cells.set(row, from, to);
    }
}

/// Sets the cells that come within `radius` of an edge that ends inside.
fn capsule(cells: &mut Bitmap, [a, b]: [Complex64; 2], radius: f64) {
    let radius = radius + ROUNDING;
    let [width, height] = cells.size;
    let cell = |at: f64, count: usize| (at.max(0.0) as usize).min(count - 1);
    let rows = cell(a.im.min(b.im) - radius, height)..=cell(a.im.max(b.im) + radius, height);
    let from = cell(a.re.min(b.re) - radius, width);
    let to = cell(a.re.max(b.re) + radius, width) + 1;
    if rows.start() == rows.end() {
        return cells.set(*rows.start(), from, to);
    }
    // Of a long outline in large cells mostly others have set all that there is.
    if rows.clone().all(|row| cells.next(row, from, false) >= to) {
        return;
    }
    let (right, left) = (Capsule::new(a, b, radius), Capsule::new(-a.conj(), -b.conj(), radius));
    for row in rows {
        let band = [row as f64, (row + 1) as f64];
        cells.set(row, cell(-left.reach(band), width), cell(right.reach(band), width) + 1);
    }
}

/// The points within `radius` of an edge.
struct Capsule {
    ends: [Complex64; 2],
    radius: f64,
    /// From the edge to its two sides; none if it has no length.
    normal: Option<Complex64>,
}

impl Capsule {
    fn new(a: Complex64, b: Complex64, radius: f64) -> Self {
        let along = b - a;
        let length = along.norm_sqr().sqrt();
        let normal = (length > 0.0).then(|| Complex64::i() * along * (radius / length));
        Self { ends: [a, b], radius, normal }
    }

    /// How far right it reaches in a band of heights. It is convex, so it reaches farthest at the height in the band that is closest to that of
    /// the right end.
    fn reach(&self, band: [f64; 2]) -> f64 {
        let [a, b] = self.ends;
        let end = if a.re >= b.re { a } else { b };
        let y = end.im.clamp(band[0], band[1]);
        let disc = |z: Complex64| match self.radius * self.radius - (y - z.im) * (y - z.im) {
            rest if rest >= 0.0 => z.re + rest.sqrt(),
            _ => f64::NEG_INFINITY,
        };
        let Some(normal) = self.normal else { return disc(a) };
        let side = |offset: Complex64| {
            let (p, q) = (a + offset, b + offset);
            let t = (y - p.im) / (q.im - p.im);
            if (0.0..=1.0).contains(&t) { p.re + t * (q.re - p.re) } else { f64::NEG_INFINITY }
        };
        disc(a).max(disc(b)).max(side(normal)).max(side(-normal))
    }
}

/// Rows of bits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Bitmap {
    /// How many bits a row has, and how many rows there are.
    pub(super) size: [usize; 2],
    words: usize,
    bits: Vec<u64>,
}

impl Bitmap {
    pub(super) fn new(size: [usize; 2]) -> Self {
        let words = size[0].div_ceil(64);
        Self { size, words, bits: vec![0; words * size[1]] }
    }

    pub(super) fn row(&self, row: usize) -> &[u64] {
        &self.bits[row * self.words..(row + 1) * self.words]
    }

    /// Sets bits `from..to` of a row.
    pub(super) fn set(&mut self, row: usize, from: usize, to: usize) {
        let mut at = from;
        while at < to {
            let stop = to.min(64 * (at / 64 + 1));
            self.bits[row * self.words + at / 64] |= (u64::MAX >> (64 - (stop - at))) << (at % 64);
            at = stop;
        }
    }

    /// The runs of set bits.
    pub(super) fn runs(&self) -> Vec<Run> {
        let mut runs = Vec::new();
        for row in 0..self.size[1] {
            let mut from = self.next(row, 0, true);
            while from < self.size[0] {
                let to = self.next(row, from, false);
                runs.push(Run { row, from, to });
                from = self.next(row, to, true);
            }
        }
        runs
    }

    /// The first bit from `at` on that is set or not, or the end of the row.
    fn next(&self, row: usize, at: usize, is_set: bool) -> usize {
        let mut word = at / 64;
        let mut seen = u64::MAX << (at % 64);
        while word < self.words {
            let bits = self.bits[row * self.words + word];
            let wanted = if is_set { bits } else { !bits } & seen;
            if wanted != 0 {
                return (64 * word + wanted.trailing_zeros() as usize).min(self.size[0]);
            }
            (word, seen) = (word + 1, u64::MAX);
        }
        self.size[0]
    }

    /// Turned by a quarter: what goes right goes up.
    fn quarter_on(&self) -> Self {
        let [width, height] = self.size;
        let mut turned = Self::new([height, width]);
        for (from, column) in (0..height).step_by(64).zip(0..) {
            for word in 0..self.words {
                // Of the rows that come to lie in one column of words, the uppermost first.
                let mut block = [0; 64];
                for (k, bits) in block.iter_mut().enumerate().take(height - from) {
                    *bits = self.bits[(height - 1 - from - k) * self.words + word];
                }
                transpose(&mut block);
                for (row, bits) in (64 * word..width).zip(block) {
                    turned.bits[row * turned.words + column] = bits;
                }
            }
        }
        turned
    }

    /// The same with `pad` empty cells on each side.
    fn padded(&self, pad: usize) -> Self {
        let mut padded = Self::new(self.size.map(|n| n + 2 * pad));
        for run in self.runs() {
            padded.set(run.row + pad, run.from + pad, run.to + pad);
        }
        padded
    }
}

/// Bit k of word j becomes bit j of word k: halves are exchanged, then halves of those (Warren, Hacker's Delight, 7-3).
fn transpose(block: &mut [u64; 64]) {
    let (mut half, mut low) = (32, u64::from(u32::MAX));
    while half > 0 {
        for j in (0..64).filter(|j| j & half == 0) {
            let exchanged = (block[j] >> half ^ block[j + half]) & low;
            block[j] ^= exchanged << half;
            block[j + half] ^= exchanged;
        }
        half /= 2;
        low ^= low << half;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The distance of a cell to a segment, by sampling.
    fn distance(cell: [usize; 2], [a, b]: [Complex64; 2]) -> f64 {
        let mut least = f64::MAX;
        for k in 0..=400 {
            let z = a + (b - a) * (f64::from(k) / 400.0);
            let [dx, dy] = [z.re, z.im]
                .iter()
                .zip(cell)
                .map(|(x, n)| (n as f64 - x).max(x - n as f64 - 1.0).max(0.0))
                .collect::<Vec<_>>()[..]
            else {
                unreachable!()
            };
            least = least.min(dx.hypot(dy));
        }
        least
    }

    fn is_set(cells: &Bitmap, [x, y]: [usize; 2]) -> bool {
        cells.row(y)[x / 64] >> (x % 64) & 1 == 1
    }

    proptest! {
        #[test]
        fn a_capsule_is_the_cells_within_its_radius(
            ends in [1.0..19.0f64, 1.0..19.0, 1.0..19.0, 1.0..19.0], radius in 0.0..4.0f64,
            holes in prop::collection::vec((0..20usize, 0..20usize), 0..6)
        ) {
            let edge = [Complex64::new(ends[0], ends[1]), Complex64::new(ends[2], ends[3])];
            let mut cells = Bitmap::new([20, 20]);
            capsule(&mut cells, edge, radius);
            // Where nearly all is set already, it sets what it would elsewhere.
            let mut full = Bitmap::new([20, 20]);
            for (k, [x, y]) in (0..400).map(|k| (k, [k % 20, k / 20])) {
                let is_hole = holes.contains(&(x, y)) || k == 0;
                (!is_hole).then(|| full.set(y, x, x + 1));
            }
            let before = full.clone();
            capsule(&mut full, edge, radius);
            for cell in (0..400).map(|k| [k % 20, k / 20]) {
                prop_assert_eq!(is_set(&full, cell), is_set(&before, cell) || is_set(&cells, cell), "{:?}", cell);
            }
            for cell in (0..400).map(|k| [k % 20, k / 20]) {
                let distance = distance(cell, edge);
                prop_assert!(!is_set(&cells, cell) || distance < radius + 0.1, "{cell:?}");
                prop_assert!(is_set(&cells, cell) || distance > radius - 1e-9, "{cell:?}");
            }
        }

        #[test]
        fn runs_are_the_bits(spans in prop::collection::vec((0..3usize, 0..150usize, 0..150usize), 0..9)) {
            let mut cells = Bitmap::new([150, 3]);
            spans.iter().for_each(|&(row, from, to)| cells.set(row, from, to));
            let mut again = Bitmap::new([150, 3]);
            let runs = cells.runs();
            runs.iter().for_each(|run| again.set(run.row, run.from, run.to));
            prop_assert_eq!(&again, &cells);
            prop_assert!(runs.windows(2).all(|r| r[0].row < r[1].row || r[0].to < r[1].from));
        }
    }

    #[test]
    fn turned_by_quarters_cells_come_back_and_runs_are_all_there_once() {
        let [a, b, c] = [[0.0, 0.0], [93.3, 11.2], [40.1, 70.7]].map(|[x, y]| Complex64::new(x, y));
        let shape = Shape::new(&[[a, b], [b, c], [c, a]], Complex64::cis(0.1), 1.0, 2.5);
        let sorted = |shape: &Shape| {
            let mut runs: Vec<_> = shape.taken.iter().map(|run| (run.row, run.from, run.to)).collect();
            runs.sort_unstable();
            runs
        };
        let mut turned = shape.clone();
        for _ in 0..4 {
            let before = turned.clone();
            turned = before.quarter_on();
            let [width, height] = before.kept_off.size;
            for [x, y] in (0..width * height).map(|k| [k % width, k / width]) {
                assert_eq!(is_set(&before.kept_off, [x, y]), is_set(&turned.kept_off, [height - 1 - y, x]));
            }
            // A corner of the island is in the same place of the turned cells.
            let corner = |shape: &Shape| b * shape.turn - shape.low;
            let expected = Complex64::new(before.size[1] as f64 - corner(&before).im, corner(&before).re);
            assert!((corner(&turned) - expected).norm() < 1e-9);
        }
        assert_eq!((sorted(&turned), turned.size), (sorted(&shape), shape.size));
        assert_eq!(turned.kept_off, shape.kept_off);
        let count = |k: usize| (0..k).map(|row| Run { row, from: 0, to: 1 + row % 3 }).collect::<Vec<_>>();
        for k in 0..20 {
            let mut runs = spread(count(k));
            assert!(runs.first().is_none_or(|first| runs.iter().all(|run| run.to <= first.to)));
            runs.sort_by_key(|run| run.row);
            assert_eq!(runs, count(k));
        }
    }

    #[test]
    fn a_ring_leaves_its_hole_free_and_a_point_takes_a_cell() {
        let square = |half: f64, way: f64| -> Vec<[Complex64; 2]> {
            let corner = |k: i32| {
                Complex64::from_polar(half * 2f64.sqrt(), way * std::f64::consts::FRAC_PI_2 * (f64::from(k) + 0.5))
            };
            (0..4).map(|k| [corner(k), corner(k + 1)]).collect()
        };
        let ring: Vec<_> = [square(10.0, 1.0), square(5.0, -1.0)].concat();
        let one = Complex64::new(1.0, 0.0);
        let shape = Shape::new(&ring, one, 1.0, 1.0);
        assert_eq!(shape.size, [21, 21]);
        let taken: usize = shape.taken.iter().map(|run| run.to - run.from).sum();
        assert!((300..=21 * 21 - 64).contains(&taken), "{taken}");
        let point = Shape::new(&[[Complex64::default(); 2]], one, 1.0, 0.0);
        assert_eq!((point.size, point.taken), ([1, 1], vec![Run { row: 0, from: 0, to: 1 }]));
    }
}
