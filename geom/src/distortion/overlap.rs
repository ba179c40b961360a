//! How much of a map lies on itself, by sampling.

/// The share of a map's image that is covered more than once: of the points of a regular grid, `resolution` along the
/// longer side of the bounding box, that lie in a triangle, those that lie in two. An overlap thinner than the grid may be
/// missed. Points on a common side are in one of its triangles only. Triangles with coordinates that are not finite are
/// left out.
///
/// ```
/// use geom::distortion::overlap;
/// let lower = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
/// let upper = [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// assert_eq!(overlap(&[lower, upper], 512), 0.0);
/// assert_eq!(overlap(&[lower, upper, lower, upper], 512), 1.0);
/// ```
///
/// Costs O(triangles + covered grid rows), with 64 points of a row at a time; `resolution` is brought between 3 and
/// 16384.
pub fn overlap(uv: &[[[f64; 2]; 3]], resolution: usize) -> f64 {
    let ([once, again], _) = covered(uv, resolution);
    again as f64 / once.max(1) as f64
}

/// The areas of a map's image that are covered at all and more than once, by the same points as [`overlap`], at the same cost; infinite where they are too
/// large for a number, 0 where too small.
pub fn coverage(uv: &[[[f64; 2]; 3]], resolution: usize) -> [f64; 2] {
    let (points, step) = covered(uv, resolution);
    points.map(|points| if points == 0 { 0.0 } else { points as f64 * step * step })
}

/// How many points of the grid are covered, and how many again, and how far these are apart.
fn covered(uv: &[[[f64; 2]; 3]], resolution: usize) -> ([u64; 2], f64) {
    let resolution = resolution.clamp(3, 16384);
    let finite = || uv.iter().filter(|corners| corners.as_flattened().iter().all(|x| x.is_finite()));
    let range = |axis: usize| {
        let coordinates = finite().flatten().map(|q| 0.5 * q[axis]);
        coordinates.fold([f64::MAX, f64::MIN], |[low, high], x| [x.min(low), x.max(high)])
    };
    let (x, y) = (range(0), range(1));
    let extent = (x[1] - x[0]).max(y[1] - y[0]);
    if extent.is_nan() || extent <= 0.0 {
        return ([0; 2], 0.0);
    }
    let place = |at: f64, low: f64| (0.5 * at - low) / extent * (resolution - 2) as f64 + SHIFT;
    let mut coverage = Coverage::new(resolution);
    for corners in finite() {
        coverage.add(corners.map(|[u, v]| [place(u, x[0]), place(v, y[0])]));
    }
    // Half of the extent is computed with, lest it overflow.
    (coverage.points(), 2.0 * extent / (resolution - 2) as f64)
}

/// Maps start off the grid by an odd fraction, so that the sides of regular ones do not run through its points.
const SHIFT: f64 = 0.500_123_457;

/// Which points of a square integer grid are covered once, and which again.
struct Coverage {
    side: usize,
    words: usize,
    once: Vec<u64>,
    again: Vec<u64>,
}

impl Coverage {
    fn new(side: usize) -> Self {
        let words = side.div_ceil(64);
        Self { side, words, once: vec![0; side * words], again: vec![0; side * words] }
    }

    /// How many points are covered, and how many again.
    fn points(&self) -> [u64; 2] {
        [&self.once, &self.again].map(|bits| bits.iter().map(|word| u64::from(word.count_ones())).sum())
    }

    fn add(&mut self, triangle: [[f64; 2]; 3]) {
        let rows = triangle.iter().fold([f64::MAX, f64::MIN], |[low, high], q| [q[1].min(low), q[1].max(high)]);
        for row in self.first_from(rows[0])..self.first_from(rows[1]) {
            let crossings = [0, 1, 2].map(|k| crossing(triangle[k], triangle[(k + 1) % 3], row as f64));
            let span = crossings.into_iter().flatten();
            let [left, right] = span.fold([f64::MAX, f64::MIN], |[low, high], x| [x.min(low), x.max(high)]);
            self.add_span(row, self.first_from(left), self.first_from(right));
        }
    }

    /// The least grid coordinate that is not below x.
    fn first_from(&self, x: f64) -> usize {
        (x.ceil().max(0.0) as usize).min(self.side)
    }

    fn add_span(&mut self, row: usize, from: usize, to: usize) {
        let mut at = from;
        while at < to {
            let word = at / 64;
            let stop = to.min(64 * (word + 1));
            let bits = (u64::MAX >> (64 - (stop - at))) << (at % 64);
            let index = row * self.words + word;
            self.again[index] |= self.once[index] & bits;
            self.once[index] |= bits;
            at = stop;
        }
    }
}

/// Where a side crosses a row, computed alike for the triangles on both of its sides.
fn crossing(a: [f64; 2], b: [f64; 2], row: f64) -> Option<f64> {
    let ([ax, ay], [bx, by]) = if (a[1], a[0]) <= (b[1], b[0]) { (a, b) } else { (b, a) };
    (ay <= row && row < by).then(|| ax + (row - ay) * ((bx - ax) / (by - ay)))
}
