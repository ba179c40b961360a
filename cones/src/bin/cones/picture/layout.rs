//! The layout in the plane: checkerboard, outline, cones; flipped triangles stand out.

use super::canvas::{Canvas, Picture, Place};
use super::chart::{Chart, Mark};
use super::colour::{Colour, FLIPPED, INK, MAXIMUM, MINIMUM, PAPER, mix};
use std::collections::BTreeMap;

/// The layout's longer side in pixels.
const LONG_SIDE: f64 = 1024.0;
const MARGIN: f64 = 24.0;
const OUTLINE: f64 = 2.6;
const CONE: f64 = 15.0;

/// Draws the layout, its proportions kept.
pub(crate) fn draw(chart: &Chart) -> Picture {
    let (width, height) = size(chart);
    let mut canvas = Canvas::new(width as usize, height as usize, PAPER);
    let checker = chart.checker();
    let place = |uv: [f64; 2]| to_page(uv, height);
    for (f, corners) in chart.uv.iter().enumerate() {
        let flipped = chart.is_flipped(f);
        canvas.triangle(corners.map(place), |w| {
            let uv = [0, 1].map(|i| (0..3).map(|k| w[k] * corners[k][i]).sum());
            if flipped { FLIPPED } else { checker.colour(uv) }
        });
    }
    for outline in chart.outline() {
        for (i, &from) in outline.iter().enumerate() {
            canvas.line(place(from), place(outline[(i + 1) % outline.len()]), OUTLINE, INK);
        }
    }
    for (uv, cone) in cone_copies(chart) {
        canvas.line(place(uv), place(uv), CONE + 2.0 * OUTLINE, PAPER);
        canvas.line(place(uv), place(uv), CONE, colour_of(&cone));
    }
    canvas.develop()
}

/// The page's size in pixels.
pub(crate) fn size(chart: &Chart) -> (f64, f64) {
    let side = |i: usize| {
        let longest = chart.uv.iter().flatten().map(|uv| uv[i]).fold(0.0, f64::max);
        (LONG_SIDE * longest + 2.0 * MARGIN).ceil()
    };
    (side(0), side(1))
}

/// From the unit square to the page, whose y runs downwards.
pub(crate) fn to_page(uv: [f64; 2], height: f64) -> Place {
    [MARGIN + LONG_SIDE * uv[0], height - MARGIN - LONG_SIDE * uv[1], 1.0]
}

pub(crate) fn colour_of(cone: &Mark) -> Colour {
    let colour = if cone.positive { MINIMUM } else { MAXIMUM };
    mix(colour, PAPER, 0.06)
}

/// Each place in the layout where a cone came to lie: one for each of its copies.
pub(crate) fn cone_copies(chart: &Chart) -> Vec<([f64; 2], Mark)> {
    let cones: BTreeMap<u32, Mark> = chart.cones.iter().map(|c| (c.vertex, *c)).collect();
    let mut copies = BTreeMap::new();
    for (t, uv) in chart.triangles.iter().zip(&chart.uv) {
        for (v, &uv) in t.iter().zip(uv) {
            if let Some(cone) = cones.get(v) {
                copies.insert((*v, uv.map(f64::to_bits)), (uv, *cone));
            }
        }
    }
    copies.into_values().collect()
}
