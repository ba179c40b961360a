//! An island as cells of a grid, conservatively.
//!
//! A cell is a unit square. An island *takes* the cells that one of its edges touches, and those whose centre it winds about;
//! it *keeps off* the cells that come closer to it than the margin. If no cell that one island takes is kept off by
//! another, the two are at least the margin apart: no finer test is needed, whatever the size of the cells.

use num_complex::Complex64;

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
    /// The cells that it takes, longest first.
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
        let place = |z: Complex64| z * turn * scale;
        let (mut low, mut high) = (Complex64::new(f64::MAX, f64::MAX), Complex64::new(f64::MIN, f64::MIN));
        for z in edges.iter().flatten().map(|&z| place(z)) {
            low = Complex64::new(low.re.min(z.re), low.im.min(z.im));
            high = Complex64::new(high.re.max(z.re), high.im.max(z.im));
        }
        let inset = Complex64::new(ROUNDING, ROUNDING);
        let low = low - inset;
        let size = [high.re - low.re, high.im - low.im].map(|extent| (extent + ROUNDING) as usize + 1);
        let edges = || edges.iter().map(|edge| edge.map(|z| place(z) - low));
        let mut cells = Bitmap::new(size);
        fill(&mut cells, edges());
        edges().for_each(|edge| capsule(&mut cells, edge, 0.0));
        let pad = margin.ceil() as usize + 1;
        let mut kept_off = cells.padded(pad);
        let shift = Complex64::new(pad as f64, pad as f64);
        edges().for_each(|edge| capsule(&mut kept_off, edge.map(|z| z + shift), margin));
        let mut taken = cells.runs();
        taken.sort_by_key(|run| std::cmp::Reverse(run.to - run.from));
        Self { turn, low, size, taken, kept_off, pad }
    }
}

/// Sets the cells whose centre is wound about.
fn fill(cells: &mut Bitmap, edges: impl Iterator<Item = [Complex64; 2]>) {
    let [width, height] = cells.size;
    let mut steps: Vec<Vec<(usize, i32)>> = vec![Vec::new(); height];
    for [a, b] in edges {
        let (low, high, way) = if a.im <= b.im { (a, b, 1) } else { (b, a, -1) };
        // Rows whose centre line is crossed, the lower end included.
        let rows = (low.im + 0.5).floor().max(0.0) as usize..(high.im + 0.5).floor().max(0.0) as usize;
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

/// Sets the cells that come within `radius` of an edge.
fn capsule(cells: &mut Bitmap, [a, b]: [Complex64; 2], radius: f64) {
    let radius = radius + ROUNDING;
    let [width, height] = cells.size.map(|n| n as f64);
    let first = (a.im.min(b.im) - radius).floor().max(0.0);
    let last = (a.im.max(b.im) + radius).floor().min(height - 1.0);
    let mut set = |row: f64, left: f64, right: f64| {
        let (from, to) = (left.floor().max(0.0), (right.floor() + 1.0).min(width));
        if from < to {
            cells.set(row as usize, from as usize, to as usize);
        }
    };
    if first == last {
        return set(first, a.re.min(b.re) - radius, a.re.max(b.re) + radius);
    }
    let (right, left) = (Capsule::new(a, b, radius), Capsule::new(-a.conj(), -b.conj(), radius));
    let mut row = first;
    while row <= last {
        let band = [row, row + 1.0];
        set(row, -left.reach(band), right.reach(band));
        row += 1.0;
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
        let length = along.norm();
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

    /// The same with `pad` empty cells on each side.
    fn padded(&self, pad: usize) -> Self {
        let mut padded = Self::new(self.size.map(|n| n + 2 * pad));
        for run in self.runs() {
            padded.set(run.row + pad, run.from + pad, run.to + pad);
        }
        padded
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
        fn a_capsule_is_the_cells_within_its_radius(ends in [1.0..19.0f64, 1.0..19.0, 1.0..19.0, 1.0..19.0], radius in 0.0..4.0f64) {
            let edge = [Complex64::new(ends[0], ends[1]), Complex64::new(ends[2], ends[3])];
            let mut cells = Bitmap::new([20, 20]);
            capsule(&mut cells, edge, radius);
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
