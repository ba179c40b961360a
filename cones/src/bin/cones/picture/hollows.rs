//! Hollows are darkened, as light reaches them from few sides.
//!
//! Nearness is linear on the screen over every plane, so the mean of two opposite neighbours tells at once whether the
//! surface is hollow between them, however it is tilted (unsharp masking of the depth buffer: Luft, Colditz & Deussen
//! 2006, here with pairs in place of a blur).

use super::canvas::Canvas;

/// Distances of the neighbours, as shares of the picture's height.
const REACHES: [f64; 4] = [0.006, 0.014, 0.03, 0.06];
const DIRECTIONS: usize = 8;
/// How dark the deepest hollow gets.
const STRENGTH: f64 = 0.62;

/// Darkens hollows. `pixel` is the size of a pixel in space at distance one.
pub(crate) fn darken(canvas: &mut Canvas, pixel: f64) {
    let (width, height) = canvas.size();
    let mut shade = vec![1.0f32; width * height];
    for y in 0..height {
        for x in 0..width {
            let nearness = canvas.nearness_at(x, y);
            if nearness > 0.0 {
                shade[y * width + x] = (1.0 - STRENGTH * hollow(canvas, x, y, nearness, pixel)) as f32;
            }
        }
    }
    canvas.dim(&shade);
}

/// How hollow the surface is at a pixel, from 0 to 1.
fn hollow(canvas: &Canvas, x: usize, y: usize, nearness: f64, pixel: f64) -> f64 {
    let (width, height) = canvas.size();
    let look = |dx: f64, dy: f64| {
        let (x, y) = (x as f64 + dx, y as f64 + dy);
        let inside = x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
        if inside { canvas.nearness_at(x as usize, y as usize) } else { 0.0 }
    };
    let mut sum = 0.0;
    for (ring, reach) in REACHES.iter().map(|r| r * height as f64).enumerate() {
        for direction in 0..DIRECTIONS {
            // Each ring is turned against the one before it.
            let angle = std::f64::consts::PI * (direction as f64 + 0.37 * ring as f64) / DIRECTIONS as f64;
            let (dx, dy) = ((reach * angle.cos()).round(), (reach * angle.sin()).round());
            let pair = [look(dx, dy), look(-dx, -dy)];
            if pair[0] > 0.0 && pair[1] > 0.0 {
                // How deep the surface lies under the chord, over half the chord.
                let depth = (0.5 * (pair[0] + pair[1]) - nearness) / (nearness * reach * pixel);
                // What is far in front hides the surface but does not shadow it.
                sum += depth.clamp(0.0, 1.0) / (1.0 + (depth - 1.5).max(0.0));
            }
        }
    }
    (3.0 * sum / (REACHES.len() * DIRECTIONS) as f64).min(1.0)
}
