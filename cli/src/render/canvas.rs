//! A z-buffered canvas for triangles, lines, balls and discs.
//!
//! Places are (x, y, nearness): pixels from the upper left, and the reciprocal of the distance from the eye, which is
//! linear on the screen under perspective; flat drawings use 1 everywhere. Every pixel is [`SAMPLES`]² samples, averaged
//! in linear light when the canvas is [developed](Canvas::develop).

use super::colour::{Colour, Encoder};
use super::picture::Picture;
use std::ops::Range;

/// Samples along a pixel's side. Four look no better on a checkerboard and cost nearly twice the memory.
const SAMPLES: usize = 3;

/// x, y in pixels, and nearness.
pub(crate) type ScreenPoint = [f64; 3];

/// Samples of depth and colour. 7 bytes each: colours as the square roots of linear light, in 8 bits.
#[derive(Debug)]
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    nearness: Vec<f32>,
    colour: Vec<[u8; 3]>,
}

impl Canvas {
    pub(crate) fn new(width: usize, height: usize, paper: Colour) -> Self {
        let samples = width * height * SAMPLES * SAMPLES;
        Self { width, height, nearness: vec![0.0; samples], colour: vec![pack(paper); samples] }
    }

    /// Paints a triangle; `shade` is given the barycentric coordinates in space (perspective undone).
    pub(crate) fn triangle(&mut self, corners: [ScreenPoint; 3], mut shade: impl FnMut([f64; 3]) -> Colour) {
        self.triangle_over(corners, |weights, _| shade(weights));
    }

    /// Paints a triangle; `shade` is told as well whether it covers something.
    pub(crate) fn triangle_over(&mut self, corners: [ScreenPoint; 3], shade: impl FnMut([f64; 3], bool) -> Colour) {
        let [a, b, c] = corners;
        let side =
            |p: ScreenPoint, q: ScreenPoint, x: f64, y: f64| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
        let area = side(a, b, c[0], c[1]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let (low, high) = bounds(&corners);
        self.samples(
            low,
            high,
            |x, y| {
                let on_screen = [side(b, c, x, y) / area, side(c, a, x, y) / area, side(a, b, x, y) / area];
                if on_screen.iter().any(|&w| w < 0.0) {
                    return None;
                }
                let weights = [on_screen[0] * a[2], on_screen[1] * b[2], on_screen[2] * c[2]];
                let nearness = weights[0] + weights[1] + weights[2];
                Some((nearness, weights.map(|w| w / nearness)))
            },
            shade,
        );
    }

    /// Paints a line with round ends.
    pub(crate) fn line(&mut self, from: ScreenPoint, to: ScreenPoint, width: f64, colour: Colour) {
        let radius = 0.5 * width;
        let along = [to[0] - from[0], to[1] - from[1]];
        let length2 = along[0] * along[0] + along[1] * along[1];
        let (low, high) = bounds(&[from, to]);
        self.samples(
            [low[0] - radius, low[1] - radius],
            [high[0] + radius, high[1] + radius],
            |x, y| {
                let d = [x - from[0], y - from[1]];
                let t =
                    if length2 > 0.0 { ((d[0] * along[0] + d[1] * along[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
                let off = [d[0] - t * along[0], d[1] - t * along[1]];
                let inside = off[0] * off[0] + off[1] * off[1] <= radius * radius;
                inside.then(|| (from[2] + t * (to[2] - from[2]), ()))
            },
            |(), _| colour,
        );
    }

    /// Paints a ball seen from afar: `radius` in space, `scale` the pixels of a unit length at its centre. `shade` is
    /// given the normal in the camera's frame (right, up, towards the eye).
    pub(crate) fn ball(
        &mut self,
        centre: ScreenPoint,
        radius: f64,
        scale: f64,
        mut shade: impl FnMut([f64; 3]) -> Colour,
    ) {
        let r = radius * scale;
        let distance = 1.0 / centre[2];
        self.samples(
            [centre[0] - r, centre[1] - r],
            [centre[0] + r, centre[1] + r],
            |x, y| {
                let n = [(x - centre[0]) / r, (centre[1] - y) / r];
                let height = (1.0 - n[0] * n[0] - n[1] * n[1]).sqrt();
                (height > 0.0).then(|| (1.0 / (distance - radius * height), [n[0], n[1], height]))
            },
            |normal, _| shade(normal),
        );
    }

    /// Width and height in pixels.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The nearness at the middle of each pixel; 0 where only paper is seen.
    pub(crate) fn nearness(&self) -> Vec<f32> {
        let middle = SAMPLES / 2;
        let rows = self.nearness.chunks_exact(self.width * SAMPLES).skip(middle).step_by(SAMPLES);
        rows.flat_map(|row| row.iter().skip(middle).step_by(SAMPLES)).copied().collect()
    }

    /// Multiplies each pixel's light by a factor; paper stays as it is.
    pub(crate) fn dim(&mut self, factor: &[f32]) {
        let row = self.width * SAMPLES;
        for (i, (sample, &nearness)) in self.colour.iter_mut().zip(&self.nearness).enumerate() {
            let dimmed = factor[i / row / SAMPLES * self.width + i % row / SAMPLES].sqrt();
            if nearness > 0.0 {
                *sample = sample.map(|s| (f32::from(s) * dimmed + 0.5) as u8);
            }
        }
    }

    /// The picture: samples averaged pixel by pixel.
    pub(crate) fn develop(self) -> Picture {
        self.develop_part(0..self.width, 0..self.height)
    }

    /// The picture without the empty paper round about, but for a margin.
    pub(crate) fn develop_trimmed(self, margin: usize) -> Picture {
        let (columns, rows) = self.painted(margin);
        self.develop_part(columns, rows)
    }

    fn develop_part(&self, columns: Range<usize>, rows: Range<usize>) -> Picture {
        let (row, share) = (self.width * SAMPLES, 1.0 / (SAMPLES * SAMPLES) as f64);
        let encoder = Encoder::new();
        let mut pixels = Vec::with_capacity(columns.len() * rows.len());
        for y in rows.clone() {
            for x in columns.clone() {
                let mut sum = [0.0; 3];
                for j in 0..SAMPLES {
                    let first = (y * SAMPLES + j) * row + x * SAMPLES;
                    for &sample in &self.colour[first..first + SAMPLES] {
                        let light = unpack(sample);
                        sum = std::array::from_fn(|i| sum[i] + light[i]);
                    }
                }
                pixels.push(encoder.encode(sum.map(|s| s * share)));
            }
        }
        Picture { width: columns.len(), height: rows.len(), pixels }
    }

    /// The columns and rows from the first to the last that is painted on, with a margin; all where none is.
    fn painted(&self, margin: usize) -> (Range<usize>, Range<usize>) {
        let row = self.width * SAMPLES;
        let painted = |x: usize, y: usize| self.nearness[(y * row + x) * SAMPLES] > 0.0;
        let span = |size: usize, painted: &dyn Fn(&usize) -> bool| {
            let (first, last) = ((0..size).find(painted), (0..size).rev().find(painted));
            match (first, last) {
                (Some(first), Some(last)) => first.saturating_sub(margin)..(last + 1 + margin).min(size),
                _ => 0..size,
            }
        };
        let columns = span(self.width, &|&x| (0..self.height).any(|y| painted(x, y)));
        (columns, span(self.height, &|&y| (0..self.width).any(|x| painted(x, y))))
    }

    /// Visits the samples of a rectangle: where `hit` answers with a nearness not behind what is there, `shade` is asked
    /// for the colour, and told whether it goes over something.
    fn samples<T>(
        &mut self,
        low: [f64; 2],
        high: [f64; 2],
        hit: impl Fn(f64, f64) -> Option<(f64, T)>,
        mut shade: impl FnMut(T, bool) -> Colour,
    ) {
        let step = 1.0 / SAMPLES as f64;
        let span = |low: f64, high: f64, size: usize| {
            let first = (low / step - 0.5).ceil().max(0.0) as usize;
            let end = ((high / step - 0.5).floor() + 1.0).clamp(0.0, (size * SAMPLES) as f64) as usize;
            first..end
        };
        let columns = span(low[0], high[0], self.width);
        for j in span(low[1], high[1], self.height) {
            let y = (j as f64 + 0.5) * step;
            for i in columns.clone() {
                let Some((nearness, what)) = hit((i as f64 + 0.5) * step, y) else { continue };
                let at = j * self.width * SAMPLES + i;
                if nearness as f32 >= self.nearness[at] {
                    self.colour[at] = pack(shade(what, self.nearness[at] > 0.0));
                    self.nearness[at] = nearness as f32;
                }
            }
        }
    }
}

fn bounds(places: &[ScreenPoint]) -> ([f64; 2], [f64; 2]) {
    let fold = |i: usize, start: f64, pick: fn(f64, f64) -> f64| places.iter().map(|p| p[i]).fold(start, pick);
    let (least, greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    ([fold(0, least, f64::min), fold(1, least, f64::min)], [fold(0, greatest, f64::max), fold(1, greatest, f64::max)])
}

fn pack(colour: Colour) -> [u8; 3] {
    colour.map(|x| (255.0 * x.clamp(0.0, 1.0).sqrt() + 0.5) as u8)
}

fn unpack(sample: [u8; 3]) -> Colour {
    sample.map(|s| {
        let x = f64::from(s) / 255.0;
        x * x
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_covers_its_share_of_the_pixels() {
        let mut canvas = Canvas::new(100, 100, [0.0; 3]);
        canvas.triangle([[0.0, 0.0, 1.0], [100.0, 0.0, 1.0], [0.0, 100.0, 1.0]], |_| [1.0; 3]);
        let light: usize = canvas.develop().pixels.iter().filter(|p| p[0] > 127).count();
        assert!((4900..=5100).contains(&light), "{light}");
    }

    #[test]
    fn trimming_leaves_what_is_painted_and_a_margin() {
        let mut canvas = Canvas::new(100, 50, [1.0; 3]);
        canvas.triangle([[20.0, 10.0, 1.0], [30.0, 10.0, 1.0], [20.0, 30.0, 1.0]], |_| [0.0; 3]);
        let picture = canvas.develop_trimmed(5);
        assert_eq!((picture.width, picture.height), (20, 30));
    }

    #[test]
    fn the_nearer_triangle_hides_the_farther_one_in_any_order() {
        let sheet = |z: f64| [[0.0, 0.0, z], [40.0, 0.0, z], [0.0, 40.0, z]];
        for order in [[1.0, 2.0], [2.0, 1.0]] {
            let mut canvas = Canvas::new(20, 20, [0.0; 3]);
            for z in order {
                canvas.triangle(sheet(z), |_| if z > 1.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] });
            }
            assert_eq!(canvas.develop().pixels[0], [255, 0, 0]);
        }
    }

    #[test]
    fn what_lies_off_the_canvas_is_not_drawn() {
        let mut canvas = Canvas::new(10, 10, [0.0; 3]);
        canvas.line([-50.0, -50.0, 1.0], [-20.0, 80.0, 1.0], 3.0, [1.0; 3]);
        canvas.ball([100.0, 5.0, 1.0], 1.0, 4.0, |_| [1.0; 3]);
        canvas.triangle([[f64::NAN, 0.0, 1.0], [4.0, 4.0, 1.0], [0.0, 9.0, 1.0]], |_| [1.0; 3]);
        assert!(canvas.develop().pixels.iter().all(|&p| p == [0; 3]));
    }
}
