//! A picture for the new map, of what the old ones show.
//!
//! Each triangle is scanned on a grid of its own, of so many samples along a texel's side as the old picture has pixels there ([`Piece::samples`]), and each sample is the old
//! picture there, interpolated between four pixels. A texel is the mean of its samples, of all triangles that it is part of: their area, but for the grid. Colours are averaged in
//! linear light, weighted by alpha; alpha is averaged as it is. Rows are independent of each other, and all sums are in the order of triangles: the same bits for any number of threads.

use crate::input::Texels;
use crate::render::{decode, encode};
use cones::uv::Triangle;
use rayon::prelude::*;

/// The most samples along a texel's side. Beyond, the grid is coarser than the old picture's pixels, and its 256 samples still are a fair mean.
const MOST_SAMPLES: f64 = 16.0;
/// Old pixels on a texel may be so many more before another sample is taken: as large ones as the new are not sampled twice.
const SLACK: f64 = 0.05;
/// What the colour of what cannot be seen counts, so that it has one.
const UNSEEN: f64 = 1e-3;

/// A triangle: where it is in the new picture, and what it shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// In texels from the upper left corner.
    corners: Triangle,
    /// From texels to pixels of the old picture: the value at the first corner, and what a texel right and down add.
    old: [[f64; 2]; 3],
    picture: u32,
    /// What the picture's light and alpha are multiplied by.
    factor: [f64; 4],
    /// Whether the old picture repeats beyond its borders; it ends there for triangles within them.
    repeats: bool,
    samples: u32,
}

impl Piece {
    /// A triangle with texture coordinates in both; none if it has no area in the new picture, of `side` texels, or lies at no finite place of the old one.
    pub(super) fn new(
        old: Triangle,
        new: Triangle,
        (picture, texels, factor): (u32, &Texels, [f64; 4]),
        side: usize,
    ) -> Option<Self> {
        let size = [texels.width, texels.height].map(|size| size as f64);
        let corners = new.map(|[u, v]| [u * side as f64, (1.0 - v) * side as f64]);
        let pixels = old.map(|[u, v]| [u * size[0], (1.0 - v) * size[1]]);
        let edge = |t: &Triangle, k: usize| [t[k][0] - t[0][0], t[k][1] - t[0][1]];
        let ([a, b], [p, q]) = ([edge(&corners, 1), edge(&corners, 2)], [edge(&pixels, 1), edge(&pixels, 2)]);
        let area = a[0] * b[1] - a[1] * b[0];
        let right = [0, 1].map(|k| (p[k] * b[1] - q[k] * a[1]) / area);
        let down = [0, 1].map(|k| (q[k] * a[0] - p[k] * b[0]) / area);
        if ![pixels[0], right, down].as_flattened().iter().all(|x| x.is_finite()) {
            return None;
        }
        let samples = (largest_stretch(right, down) - SLACK).ceil().clamp(1.0, MOST_SAMPLES) as u32;
        // Files round.
        let repeats = old.as_flattened().iter().any(|x| !(-1e-6..=1.0 + 1e-6).contains(x));
        Some(Self { corners, old: [pixels[0], right, down], picture, factor, repeats, samples })
    }

    /// Its rows in the picture.
    fn rows(&self, side: usize) -> std::ops::Range<usize> {
        let y = self.corners.map(|corner| corner[1]);
        let low = y[0].min(y[1]).min(y[2]).floor().max(0.0) as usize;
        let high = y[0].max(y[1]).max(y[2]).ceil().max(0.0) as usize;
        low.min(side)..high.min(side)
    }

    /// From where to where it reaches at a height.
    fn span(&self, y: f64) -> Option<[f64; 2]> {
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        for k in 0..3 {
            let (from, to) = (self.corners[k], self.corners[(k + 1) % 3]);
            // From the upper end, so that the triangle on the other side has the same.
            let [a, b] = if from[1] <= to[1] { [from, to] } else { [to, from] };
            if a[1] <= y && y < b[1] {
                let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                span = [span[0].min(x), span[1].max(x)];
            }
        }
        (span[0] <= span[1]).then_some(span)
    }

    /// Adds its samples to a row.
    fn add(&self, y: usize, row: &mut [Sum], pictures: &[Texels], light: &[f64; 256]) {
        let picture = &pictures[self.picture as usize];
        let samples = f64::from(self.samples);
        let weight = 1.0 / (samples * samples);
        for j in 0..self.samples {
            let at = y as f64 + (f64::from(j) + 0.5) / samples;
            let Some([low, high]) = self.span(at) else { continue };
            let first = (low * samples - 0.5).ceil().max(0.0) as usize;
            // A sample on a side is of the triangle to its right, so that one on two triangles counts once.
            let end = (high * samples - 0.5).ceil().clamp(0.0, row.len() as f64 * samples) as usize;
            for i in first..end {
                let x = (i as f64 + 0.5) / samples;
                let [dx, dy] = [x - self.corners[0][0], at - self.corners[0][1]];
                let [p, right, down] = self.old;
                let pixel = [0, 1].map(|k| p[k] + dx * right[k] + dy * down[k]);
                row[i / self.samples as usize].add(self.sample(picture, pixel, light), weight);
            }
        }
    }
    /// The picture between its pixels: red, green, blue in linear light times alpha and a little, that weight, and alpha.
    fn sample(&self, picture: &Texels, [x, y]: [f64; 2], light: &[f64; 256]) -> [f64; 5] {
        let place = |x: f64, size: usize| {
            let low = (x - 0.5).floor();
            let whole = |x: f64| {
                let last = size as f64 - 1.0;
                let x = if self.repeats { x.rem_euclid(size as f64).min(last) } else { x.clamp(0.0, last) };
                x as usize
            };
            ([whole(low), whole(low + 1.0)], x - 0.5 - low)
        };
        let ((columns, across), (rows, along)) = (place(x, picture.width), place(y, picture.height));
        let mut sum = [0.0; 5];
        for (row, weight) in rows.into_iter().zip([1.0 - along, along]) {
            for (column, share) in columns.into_iter().zip([1.0 - across, across]) {
                let [red, green, blue, alpha] = picture.pixels[row * picture.width + column];
                let (weight, alpha) = (weight * share, f64::from(alpha) / 255.0 * self.factor[3]);
                let seen = weight * (alpha + UNSEEN);
                let [red, green, blue] = [red, green, blue].map(|x| seen * light[usize::from(x)]);
                let [by_red, by_green, by_blue, _] = self.factor;
                let parts = [red * by_red, green * by_green, blue * by_blue, seen, weight * alpha];
                sum = std::array::from_fn(|k| sum[k] + parts[k]);
            }
        }
        sum
    }
}

/// By how much an affine map, given by what a step right and one down become, stretches at most.
fn largest_stretch([a, c]: [f64; 2], [b, d]: [f64; 2]) -> f64 {
    let (sum, det) = (a * a + b * b + c * c + d * d, a * d - b * c);
    (0.5 * (sum + (sum * sum - 4.0 * det * det).max(0.0).sqrt())).sqrt()
}

/// What the samples of a texel add up to, and their weight.
#[derive(Clone, Copy, Debug, Default)]
struct Sum([f64; 5], f64);

impl Sum {
    fn add(&mut self, sample: [f64; 5], weight: f64) {
        self.0 = std::array::from_fn(|k| self.0[k] + weight * sample[k]);
        self.1 += weight;
    }

    /// Their mean as a pixel, if there are any.
    fn pixel(&self) -> Option<[u8; 4]> {
        let Self([red, green, blue, seen, alpha], weight) = *self;
        let [red, green, blue] = encode([red, green, blue].map(|x| x / seen));
        (weight > 0.0).then(|| [red, green, blue, (255.0 * alpha / weight).round() as u8])
    }
}

/// The texels that triangles are on, row by row from the top.
pub(super) fn rasterized(pieces: &[Piece], pictures: &[Texels], side: usize) -> Vec<Option<[u8; 4]>> {
    let light: [f64; 256] = std::array::from_fn(|k| decode([k as u8; 3])[0]);
    let (start, of_row) = by_row(pieces, side);
    let mut texels = vec![None; side * side];
    texels.par_chunks_exact_mut(side).enumerate().for_each(|(y, texels)| {
        let mut row = vec![Sum::default(); side];
        for &piece in &of_row[start[y]..start[y + 1]] {
            pieces[piece as usize].add(y, &mut row, pictures, &light);
        }
        texels.iter_mut().zip(&row).for_each(|(texel, sum)| *texel = sum.pixel());
    });
    texels
}

/// Where the triangles of each row begin, and all of them, in order.
fn by_row(pieces: &[Piece], side: usize) -> (Vec<usize>, Vec<u32>) {
    let mut start = vec![0; side + 1];
    for piece in pieces {
        piece.rows(side).for_each(|y| start[y + 1] += 1);
    }
    (0..side).for_each(|y| start[y + 1] += start[y]);
    let mut next = start.clone();
    let mut of_row = vec![0; start[side]];
    for (number, piece) in (0..).zip(pieces) {
        for y in piece.rows(side) {
            of_row[next[y]] = number;
            next[y] += 1;
        }
    }
    (start, of_row)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit square as two triangles.
    const SQUARE: [Triangle; 2] = [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];

    fn checker(size: usize, colours: [[u8; 4]; 2]) -> Texels {
        let pixels = (0..size * size).map(|k| colours[(k % size + k / size) % 2]).collect();
        Texels { width: size, height: size, pixels, has_alpha: true }
    }

    fn baked(picture: &Texels, old: impl Fn([f64; 2]) -> [f64; 2], side: usize) -> Vec<Option<[u8; 4]>> {
        let pieces = SQUARE.iter().filter_map(|t| Piece::new(t.map(&old), *t, (0, picture, [1.0; 4]), side));
        rasterized(&pieces.collect::<Vec<_>>(), std::slice::from_ref(picture), side)
    }

    #[test]
    fn the_same_map_of_the_same_size_is_the_same_picture() {
        let noise = |k: usize| [k, 3 * k, 7 * k, 11 * k + 40].map(|x| (x % 256) as u8);
        let picture = Texels { width: 32, height: 32, pixels: (0..1024).map(noise).collect(), has_alpha: true };
        let texels = baked(&picture, |p| p, 32);
        assert!(texels.iter().zip(&picture.pixels).all(|(a, b)| *a == Some(*b)));
        // Turned by a quarter, and repeated.
        let turned = baked(&picture, |[u, v]| [v + 5.0, -2.0 - u], 32);
        let at = |x: usize, y: usize| picture.pixels[y * 32 + x];
        assert!((0..1024).all(|k| turned[k] == Some(at(31 - k / 32, k % 32))), "each is one of the old ones");
    }

    #[test]
    fn fine_checks_become_the_mean_of_their_light() {
        let black_and_white = checker(64, [[0, 0, 0, 255], [255; 4]]);
        // Half the light is 188 in sRGB.
        assert!(baked(&black_and_white, |p| p, 8).iter().all(|texel| *texel == Some([188, 188, 188, 255])));
        // What cannot be seen has no part in the colour.
        let red_and_clear = checker(64, [[255, 0, 0, 255], [0, 255, 0, 0]]);
        assert!(baked(&red_and_clear, |p| p, 8).iter().all(|texel| *texel == Some([255, 3, 0, 128])));
    }

    #[test]
    fn light_and_alpha_are_multiplied() {
        let white = checker(4, [[255; 4]; 2]);
        let factor = [0.5, 0.25, 1.0, 0.5];
        let pieces = SQUARE.iter().filter_map(|t| Piece::new(*t, *t, (0, &white, factor), 4));
        let texels = rasterized(&pieces.collect::<Vec<_>>(), std::slice::from_ref(&white), 4);
        assert!(texels.iter().all(|texel| *texel == Some([188, 137, 255, 128])), "{texels:?}");
    }

    #[test]
    fn triangles_smaller_than_texels_leave_none_of_these_out() {
        let picture = checker(256, [[9, 9, 9, 255], [9, 9, 9, 255]]);
        let mut pieces = Vec::new();
        for k in 0..64 * 64 {
            let shift = [(k % 64) as f64, (k / 64) as f64];
            for t in SQUARE {
                let t = t.map(|p| [0, 1].map(|i| (p[i] + shift[i]) / 64.0));
                pieces.extend(Piece::new(t, t, (0, &picture, [1.0; 4]), 16));
            }
        }
        assert!(rasterized(&pieces, &[picture], 16).iter().all(|texel| *texel == Some([9, 9, 9, 255])));
    }

    #[test]
    fn what_has_no_area_or_place_is_none() {
        let picture = checker(4, [[0; 4]; 2]);
        let [a, b] = SQUARE;
        assert!(Piece::new(a, [[0.5; 2]; 3], (0, &picture, [1.0; 4]), 8).is_none());
        assert!(Piece::new(a.map(|_| [f64::NAN; 2]), b, (0, &picture, [1.0; 4]), 8).is_none());
    }
}
