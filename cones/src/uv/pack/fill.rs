//! How full the tiles of a map are.

use std::collections::HashSet;

/// Coordinates beyond the border of a tile by no more than this are on it: files round.
const ROUNDING: f64 = 1e-6;

/// The areas of a map's triangles, added up, over that of the tiles they are on: unit squares with corners at whole numbers. Where
/// a triangle lies on two of them, or left of or below the first, the map keeps to no tiles, and what is told is the
/// share of the smallest upright square about it. Areas that lie over each other count twice; 0 where there is no area, or a
/// coordinate is not finite.
///
/// ```
/// let half = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
/// assert_eq!(cones::uv::fill(&[half]), 0.5);
/// assert_eq!(cones::uv::fill(&[half, half.map(|[x, y]| [x + 3.0, y])]), 0.5);
/// assert_eq!(cones::uv::fill(&[half.map(|[x, y]| [3.0 * x, 3.0 * y])]), 0.5);
/// ```
pub fn fill(uv: &[[[f64; 2]; 3]]) -> f64 {
    filled(uv).0
}

/// [`fill`], and on how many tiles the map is, if each of its triangles is on one.
pub(crate) fn filled(uv: &[[[f64; 2]; 3]]) -> (f64, Option<usize>) {
    let area = |[a, b, c]: &[[f64; 2]; 3]| 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    let (low, side) = square(uv);
    let on_tiles = tiles(uv);
    let fill = match on_tiles {
        Some(tiles) => uv.iter().map(area).sum::<f64>() / tiles as f64,
        None => {
            let unit = |t: &[[f64; 2]; 3]| area(&t.map(|p| [0, 1].map(|k| (p[k] - low[k]) / side)));
            uv.iter().map(unit).sum()
        }
    };
    (if fill.is_finite() { fill } else { 0.0 }, on_tiles)
}

/// On how many tiles a map is, if each of its triangles is on one.
fn tiles(uv: &[[[f64; 2]; 3]]) -> Option<usize> {
    let mut found = HashSet::new();
    let mut last = None;
    for t in uv {
        let range = |k: usize| t.iter().fold([f64::MAX, f64::MIN], |[low, high], p| [low.min(p[k]), high.max(p[k])]);
        let tile = [0, 1].map(|k| (range(k)[0] + ROUNDING).floor());
        if (0..2).any(|k| tile[k] < 0.0 || range(k)[1] > tile[k] + 1.0 + ROUNDING) {
            return None;
        }
        if last.replace(tile) != Some(tile) {
            found.insert(tile.map(f64::to_bits));
        }
    }
    Some(found.len())
}

/// The lower left corner and the side of the smallest upright square.
fn square(uv: &[[[f64; 2]; 3]]) -> ([f64; 2], f64) {
    let range = |k: usize| {
        uv.iter().flatten().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p[k]), high.max(p[k])])
    };
    let [x, y] = [range(0), range(1)];
    ([x[0], y[0]], (x[1] - x[0]).max(y[1] - y[0]))
}
