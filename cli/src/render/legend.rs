//! Legends below pictures: a scale of colours with its marks, and squares of colour with words.

use super::colour::{Colour, INK, PAPER, mix};
use super::paint::Scale;
use super::picture::{Letters, Picture};

/// Empty pixels round a legend, and between its parts.
const MARGIN: usize = 16;
/// A scale's width and height in pixels; narrower where there is no room.
const BAR: [usize; 2] = [320, 14];

/// An entry of a legend: the colour of a square, and what it means.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) colour: Option<Colour>,
    pub(crate) text: String,
}

impl Entry {
    pub(crate) fn new(colour: Option<Colour>, text: &str) -> Self {
        Self { colour, text: text.to_owned() }
    }
}

/// A strip of a width with a scale, its marks and its title, and entries after it.
pub(crate) fn strip(width: usize, scale: Option<&Scale>, entries: &[Entry]) -> Picture {
    let line = Letters::Small.height();
    let height = if scale.is_some() { 2 * line + BAR[1] + MARGIN } else { line + MARGIN };
    let mut strip = Picture::blank(width, height, PAPER);
    let mut top = 0;
    if let Some(scale) = scale {
        let bar = BAR[0].min(width.saturating_sub(2 * MARGIN));
        for x in 0..bar {
            strip.fill([MARGIN + x, 0], [1, BAR[1]], scale.colour(x as f64 / bar.max(2) as f64));
        }
        for (place, text) in &scale.marks {
            let middle = MARGIN as f64 + place * bar as f64;
            let left = (middle - 0.5 * Letters::Small.width(text) as f64).max(0.0) as usize;
            strip.fill([(middle as usize).min(MARGIN + bar.saturating_sub(1)), BAR[1]], [1, 3], INK);
            strip.write(text, [left, BAR[1] + 3], Letters::Small, INK);
        }
        strip.write(scale.title, [MARGIN, BAR[1] + line + 3], Letters::Small, mix(INK, PAPER, 0.25));
        top = BAR[1] + line + 3;
    }
    let beside = scale.map_or(MARGIN, |scale| 2 * MARGIN + Letters::Small.width(scale.title));
    written(&mut strip, entries, [beside, top], Letters::Small);
    strip
}

/// Writes entries in a line from a place on.
pub(super) fn written(picture: &mut Picture, entries: &[Entry], [mut x, y]: [usize; 2], letters: Letters) {
    let side = letters.height() / 2;
    for entry in entries {
        if let Some(colour) = entry.colour {
            picture.fill([x, y + side / 2 + 1], [side, side], colour);
            x += side + side / 2;
        }
        picture.write(&entry.text, [x, y], letters, INK);
        x += letters.width(&entry.text) + 2 * side;
    }
}
