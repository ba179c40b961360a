//! Ambient occlusion: hollows are darkened, as light reaches them from few sides.
//!
//! Nearness is linear on the screen over every plane, so the mean of two opposite neighbours tells at once whether the
//! surface is hollow between them, however it is tilted (unsharp masking of the depth buffer: Luft, Colditz & Deussen
//! 2006, here with pairs in place of a blur).

use super::canvas::Canvas;

/// Distances of the neighbours, as shares of the picture's height.
const REACHES: [f64; 4] = [0.006, 0.014, 0.03, 0.06];
const DIRECTIONS: usize = 8;
/// Up to so hollow counts as flat: triangles are, where they stand for a smooth surface.
const FLAT: f64 = 0.03;
/// How dark the deepest hollow gets.
const STRENGTH: f64 = 0.62;

/// Darkens hollows. `pixel` is the size of a pixel in space at distance one.
pub(crate) fn darken(canvas: &mut Canvas, pixel: f64) {
    let (width, height) = canvas.size();
    let depth = Depth { nearness: canvas.nearness(), width, height };
    let pairs = pairs(height);
    let shade = |i: usize| match depth.nearness[i] {
        0.0 => 1.0,
        _ => (1.0 - STRENGTH * depth.hollow(i % width, i / width, &pairs, pixel)) as f32,
    };
    let shades: Vec<f32> = (0..width * height).map(shade).collect();
    canvas.dim(&shades);
}

/// Half the distance between two opposite neighbours, in pixels: across, down, along.
type Samples = (isize, isize, f64);

/// Where to look from each pixel: rings, each turned against the one before it.
fn pairs(height: usize) -> Vec<Samples> {
    let mut pairs = Vec::new();
    for (ring, reach) in REACHES.iter().map(|r| r * height as f64).enumerate() {
        for direction in 0..DIRECTIONS {
            let angle = std::f64::consts::PI * (direction as f64 + 0.37 * ring as f64) / DIRECTIONS as f64;
            pairs.push(((reach * angle.cos()).round() as isize, (reach * angle.sin()).round() as isize, reach));
        }
    }
    pairs
}

/// The nearness pixel by pixel; 0 where only paper is seen.
struct Depth {
    nearness: Vec<f32>,
    width: usize,
    height: usize,
}

impl Depth {
    fn at(&self, x: usize, dx: isize, y: usize, dy: isize) -> f64 {
        let inside = |i: usize, d: isize, size: usize| i.checked_add_signed(d).filter(|&i| i < size);
        match (inside(x, dx, self.width), inside(y, dy, self.height)) {
            (Some(x), Some(y)) => f64::from(self.nearness[y * self.width + x]),
            _ => 0.0,
        }
    }

    /// How hollow the surface is at a pixel, from 0 to 1.
    fn hollow(&self, x: usize, y: usize, pairs: &[Samples], pixel: f64) -> f64 {
        let own = self.at(x, 0, y, 0);
        let mut sum = 0.0;
        for &(dx, dy, reach) in pairs {
            let pair = [self.at(x, dx, y, dy), self.at(x, -dx, y, -dy)];
            if pair[0] > 0.0 && pair[1] > 0.0 {
                // How deep the surface lies under the chord, over half the chord.
                let depth = (0.5 * (pair[0] + pair[1]) - own) / (own * reach * pixel);
                // What is far in front hides the surface but does not shadow it.
                sum += (depth - FLAT).clamp(0.0, 1.0) / (1.0 + (depth - 1.5).max(0.0));
            }
        }
        (3.0 * sum / pairs.len() as f64).min(1.0)
    }
}
