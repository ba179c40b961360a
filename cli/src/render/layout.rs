//! The layout in the plane: its tile, islands in a checkerboard each in its colour, outlines, cones, a legend; what lies over
//! something else and flipped triangles stand out.

use super::canvas::{Canvas, ScreenPoint};
use super::colour::{Colour, FLIPPED, INK, ISLANDS, MAXIMUM, MINIMUM, OVERLAP, PAPER, mix};
use super::legend::{Entry, strip, written};
use super::paint::Paint;
use super::picture::{Letters, Picture};
use super::scene::{Mark, Scene};
use std::collections::BTreeMap;

/// The layout's longer side in pixels.
const LONG_SIDE: f64 = 1024.0;
const MARGIN: f64 = 24.0;
/// The height of the legend below.
const LEGEND: f64 = 44.0;
/// How much of an island's colour is in its checkerboard.
const TINT: f64 = 0.45;
const FRAME: f64 = 1.6;
/// The legend tells of overlaps of more than one sample in so many: triangles that touch may share some.
const NOTICED: usize = 500;
const OUTLINE: f64 = 2.6;
/// The diameter of a cone's disc, where few are drawn.
const CONE: f64 = 15.0;
/// The discs of many cones shrink, so as to cover no more than this share of the layout.
const DISCS: f64 = 0.05;
/// The least diameter of a disc.
const LEAST: f64 = 4.0;

/// Draws the layout, its proportions kept, with its legends.
pub(crate) fn draw(scene: &Scene, paint: &Paint) -> Picture {
    let (mut picture, entries) = drawn(scene, paint);
    let below = picture.height - LEGEND as usize;
    written(&mut picture, &entries, [MARGIN as usize, below], Letters::Large);
    match paint.scale() {
        Some(scale) => picture.above(&strip(picture.width, Some(scale), &[]), PAPER),
        None => picture,
    }
}

/// The same without a legend.
pub(crate) fn draw_bare(scene: &Scene, paint: &Paint) -> Picture {
    let (picture, _) = drawn(scene, paint);
    let height = picture.height - LEGEND as usize;
    let pixels = picture.pixels[..picture.width * height].to_vec();
    Picture { height, pixels, ..picture }
}

/// The layout with room for its legend below, and what that says.
fn drawn(scene: &Scene, paint: &Paint) -> (Picture, Vec<Entry>) {
    let (width, height) = size(scene);
    let mut canvas = Canvas::new(width as usize, height as usize, PAPER);
    let brush = paint.brush(scene);
    let is_checker = matches!(paint, Paint::Checker);
    let place = |uv: [f64; 2]| to_page(uv, height);
    let (island, count) = scene.islands();
    let (mut samples, mut covered_again) = (0_usize, 0_usize);
    let (flipped, upright): (Vec<usize>, Vec<usize>) = (0..scene.uv.len()).partition(|&t| scene.is_flipped(t));
    for t in upright {
        let corners = scene.uv[t];
        canvas.triangle_over(corners.map(place), |w, over| {
            samples += 1;
            covered_again += usize::from(over);
            let colour = brush(t, w);
            let colour = if is_checker { tinted(colour, island[t], count) } else { colour };
            if over { overlapping(colour) } else { colour }
        });
    }
    for t in flipped {
        canvas.triangle(scene.uv[t].map(place), |_| FLIPPED);
    }
    for outline in scene.outline() {
        for (i, &from) in outline.iter().enumerate() {
            canvas.line(place(from), place(outline[(i + 1) % outline.len()]), OUTLINE, INK);
        }
    }
    for side in frame(scene) {
        canvas.line(place(side[0]), place(side[1]), FRAME, mix(INK, PAPER, 0.5));
    }
    let copies = cone_copies(scene);
    let entries = legend(scene, count, covered_again > samples / NOTICED);
    let disc = disc(scene, copies.len());
    for (uv, cone) in copies {
        canvas.line(place(uv), place(uv), disc * (1.0 + 2.0 * OUTLINE / CONE), PAPER);
        canvas.line(place(uv), place(uv), disc, colour_of(&cone));
    }
    (canvas.develop(), entries)
}

/// The page's size in pixels.
pub(crate) fn size(scene: &Scene) -> (f64, f64) {
    let side = |i: usize| {
        let longest = scene.uv.iter().flatten().map(|uv| uv[i]).fold(0.0, f64::max);
        let longest = scene.tiles.map_or(longest, |(tiles, _)| tiles[i] as f64 / tiles[0].max(tiles[1]) as f64);
        (LONG_SIDE * longest + 2.0 * MARGIN).ceil()
    };
    (side(0), side(1) + LEGEND)
}

/// The borders of the tiles.
pub(crate) fn frame(scene: &Scene) -> Vec<[[f64; 2]; 2]> {
    let Some(([across, up], _)) = scene.tiles else { return Vec::new() };
    let at = |k: usize| k as f64 / across.max(up) as f64;
    let upright = (0..=across).map(|k| [[at(k), 0.0], [at(k), at(up)]]);
    let level = (0..=up).map(|k| [[0.0, at(k)], [at(across), at(k)]]);
    upright.chain(level).collect()
}

/// What the picture shows, in words.
pub(crate) fn legend(scene: &Scene, islands: usize, lies_over: bool) -> Vec<Entry> {
    let tiles = scene.tiles.map_or(1, |([across, up], _)| across * up);
    let islands = if islands == 1 { "1 island".to_owned() } else { format!("{islands} islands") };
    let fill = scene
        .tiles
        .map(|(_, fill)| format!("{:.1} % {}", 100.0 * fill, if tiles == 1 { "filled" } else { "filled on tiles" }));
    let has = |positive: bool| scene.cones.iter().any(|cone| cone.positive == positive);
    let cone = |positive: bool| colour_of(&Mark { vertex: 0, positive });
    let mut entries = vec![Entry::new(None, &islands)];
    entries.extend(fill.map(|text| Entry::new(None, &text)));
    entries.extend(has(true).then(|| Entry::new(Some(cone(true)), "positive cone")));
    entries.extend(has(false).then(|| Entry::new(Some(cone(false)), "negative cone")));
    entries.extend(lies_over.then(|| Entry::new(Some(OVERLAP), "over itself")));
    entries.extend((0..scene.uv.len()).any(|t| scene.is_flipped(t)).then(|| Entry::new(Some(FLIPPED), "flipped")));
    entries
}

/// The colour of the checkerboard on an island, the quiet one where there are no others.
pub(crate) fn tinted(colour: Colour, island: usize, count: usize) -> Colour {
    if count > 1 { mix(colour, ISLANDS[island % ISLANDS.len()], TINT) } else { colour }
}

/// From the unit square to the page, whose y runs downwards.
pub(crate) fn to_page(uv: [f64; 2], height: f64) -> ScreenPoint {
    [MARGIN + LONG_SIDE * uv[0], height - LEGEND - MARGIN - LONG_SIDE * uv[1], 1.0]
}

/// The colour of the checkerboard where it lies over something else.
pub(crate) fn overlapping(colour: Colour) -> Colour {
    mix(colour, OVERLAP, 0.6)
}

/// The diameter of each of so many discs, in pixels.
pub(crate) fn disc(scene: &Scene, count: usize) -> f64 {
    let covered = DISCS * scene.covered() * LONG_SIDE * LONG_SIDE;
    (covered / count.max(1) as f64 / std::f64::consts::FRAC_PI_4).sqrt().clamp(LEAST, CONE)
}

pub(crate) fn colour_of(cone: &Mark) -> Colour {
    let colour = if cone.positive { MINIMUM } else { MAXIMUM };
    mix(colour, PAPER, 0.06)
}

/// Each place in the layout where a cone came to lie: one for each of its copies.
pub(crate) fn cone_copies(scene: &Scene) -> Vec<([f64; 2], Mark)> {
    let cones: BTreeMap<u32, Mark> = scene.cones.iter().map(|c| (c.vertex, *c)).collect();
    let mut copies = BTreeMap::new();
    for (t, uv) in scene.triangles.iter().zip(&scene.uv) {
        for (v, &uv) in t.iter().zip(uv) {
            if let Some(cone) = cones.get(v) {
                copies.insert((*v, uv.map(f64::to_bits)), (uv, *cone));
            }
        }
    }
    copies.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of a strip, the second folded over the first or laid beside it, either way upright.
    fn two(second: [[f64; 2]; 3], cones: Vec<Mark>) -> Scene {
        let points: Vec<[f64; 3]> = (0..6).map(|i| [f64::from(i), f64::from(i % 2), 0.0]).collect();
        let first = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        Scene::new(&points, vec![[0, 1, 2], [3, 4, 5]], vec![first, second], vec![], cones)
    }

    #[test]
    fn what_lies_over_something_else_stands_out() {
        let is_warm = |p: &&[u8; 3]| p[0] > p[2].saturating_add(60);
        let warm = |scene: &Scene| draw(scene, &Paint::Checker).pixels.iter().filter(is_warm).count();
        let beside = two([[1.0, 1.0], [0.0, 1.0], [1.0, 0.0]], vec![]);
        assert!(warm(&beside) < 100, "{}", warm(&beside));
        let over = two([[0.5, 0.0], [1.0, 0.0], [0.5, 0.5]], vec![]);
        // An eighth of the unit square.
        let share = warm(&over) as f64 / (LONG_SIDE * LONG_SIDE);
        assert!((share - 0.125).abs() < 0.02, "{share}");
    }

    #[test]
    fn discs_of_many_cones_leave_the_layout_in_sight() {
        let scene = two([[1.0, 1.0], [0.0, 1.0], [1.0, 0.0]], vec![]);
        assert_eq!(disc(&scene, 0), CONE);
        assert_eq!(disc(&scene, 12), CONE);
        assert!(disc(&scene, 1000) < 0.7 * CONE);
        assert_eq!(disc(&scene, 1_000_000), LEAST);
    }
}
