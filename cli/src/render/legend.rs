//! Legends below pictures: a scale of colours with its marks, and squares of colour with words.

use super::colour::{Colour, INK, PAPER, mix};
use super::paint::Scale;
use super::picture::{Letters, Picture};

/// Empty pixels round a legend, and between its parts.
const MARGIN: usize = 16;
/// A scale's width and height in pixels; narrower where there is no room.
const BAR: [usize; 2] = [320, 14];
/// Empty pixels beside what is written, at least.
const EDGE: usize = 4;

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

/// A strip of a width with a scale, its marks and its title, and entries after it, in as many lines as they take.
pub(crate) fn strip(width: usize, scale: Option<&Scale>, entries: &[Entry]) -> Picture {
    let letters = Letters::Small;
    let line = letters.height();
    let title = scale.map_or_else(Vec::new, |scale| lines(scale.title, width.saturating_sub(2 * MARGIN)));
    let beside = title.last().map_or(MARGIN, |last| 2 * MARGIN + letters.width(last));
    // Entries stand beside the last line of the title, or below it where they are too wide for that.
    let fits = entries.is_empty() || beside + entries_width(entries, letters) + EDGE <= width;
    let left = if fits { beside } else { MARGIN.min(width.saturating_sub(entries_width(entries, letters) + EDGE)) };
    let above = if fits { title.len().saturating_sub(1) } else { title.len() };
    let top = if scale.is_some() { BAR[1] + line + 3 } else { 0 };
    let foot = if scale.is_some() { MARGIN - 3 } else { MARGIN };
    let mut strip = Picture::blank(width, top + line * (above + 1) + foot, PAPER);
    if let Some(scale) = scale {
        let bar = BAR[0].min(width.saturating_sub(2 * MARGIN));
        for x in 0..bar {
            strip.fill([MARGIN + x, 0], [1, BAR[1]], scale.colour(x as f64 / bar.max(2) as f64));
        }
        for ((place, text), left) in scale.marks.iter().zip(lefts(&scale.marks, bar, width)) {
            let middle = (MARGIN as f64 + place * bar as f64) as usize;
            strip.fill([middle.min(MARGIN + bar.saturating_sub(1)), BAR[1]], [1, 3], INK);
            if let Some(left) = left {
                strip.write(text, [left, BAR[1] + 3], letters, INK);
            }
        }
        for (k, text) in title.iter().enumerate() {
            strip.write(text, [MARGIN, top + k * line], letters, mix(INK, PAPER, 0.25));
        }
    }
    written(&mut strip, entries, [left, top + above * line], letters);
    strip
}

/// Where the texts of marks begin: below their places, but within the strip. Those at the ends come first; none where a text would run
/// into another.
fn lefts(marks: &[(f64, String)], bar: usize, width: usize) -> Vec<Option<usize>> {
    let span = |(place, text): &(f64, String)| {
        let wide = Letters::Small.width(text);
        let left = (MARGIN as f64 + place * bar as f64 - 0.5 * wide as f64).max(EDGE as f64) as usize;
        let left = left.min(width.saturating_sub(wide + EDGE));
        [left, left + wide]
    };
    let spans: Vec<[usize; 2]> = marks.iter().map(span).collect();
    let mut taken: Vec<[usize; 2]> = Vec::new();
    let mut lefts = vec![None; marks.len()];
    let last = marks.len().saturating_sub(1);
    for k in [0, last].into_iter().chain(1..last).take(marks.len()) {
        let [left, right] = spans[k];
        if taken.iter().all(|other| right + EDGE <= other[0] || other[1] + EDGE <= left) {
            taken.push(spans[k]);
            lefts[k] = Some(left);
        }
    }
    lefts
}

/// A text in lines of a width, parted at its spaces.
fn lines(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line)
                if Letters::Small.width(line) + Letters::Small.width(" ") + Letters::Small.width(word) <= width =>
            {
                *line += " ";
                *line += word;
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// How wide a line of entries is.
fn entries_width(entries: &[Entry], letters: Letters) -> usize {
    let side = letters.height() / 2;
    let wide = |entry: &Entry| letters.width(&entry.text) + entry.colour.map_or(0, |_| side + side / 2);
    entries.iter().map(wide).sum::<usize>() + 2 * side * entries.len().saturating_sub(1)
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

#[cfg(test)]
mod tests {
    use super::super::colour::encode;
    use super::super::paint::Paint;
    use super::*;

    /// The columns of a strip's rows in which something is drawn, from the first to the last.
    fn drawn(strip: &Picture, rows: std::ops::Range<usize>) -> Option<[usize; 2]> {
        let paper = encode(PAPER);
        let is_drawn = |x: &usize| rows.clone().any(|y| strip.pixels[y * strip.width + x] != paper);
        let columns: Vec<usize> = (0..strip.width).filter(is_drawn).collect();
        columns.first().zip(columns.last()).map(|(&first, &last)| [first, last])
    }

    #[test]
    fn all_that_is_written_is_within_the_strip_at_every_width() {
        let inside = [Entry::new(Some(INK), "inside of the surface")];
        let values: Vec<f64> = (0..101).map(|k| -1.0 - 0.03 * f64::from(k)).collect();
        let field = Paint::field(&values, &[], "conformal factor");
        for width in [200, 240, 300, 352, 400, 560, 1280] {
            for paint in [&field, &Paint::area(&[0.0]), &Paint::stretch(&[1.0])] {
                let scale = paint.scale().expect("it has values");
                for entries in [&inside[..], &[]] {
                    let strip = strip(width, Some(scale), entries);
                    let [first, last] = drawn(&strip, BAR[1]..strip.height).expect("it is written on");
                    assert!(first >= EDGE && last + EDGE <= width, "{width} {}: {first} {last}", scale.title);
                }
                let bar = BAR[0].min(width - 2 * MARGIN);
                let lefts = lefts(&scale.marks, bar, width);
                assert!(lefts[0].is_some() && lefts[lefts.len() - 1].is_some(), "{width}: the ends are told");
            }
        }
        let [first, last] = drawn(&strip(200, None, &inside), 0..32).expect("it is written on");
        assert!(first >= 2 && last < 199, "{first} {last}");
    }

    #[test]
    fn marks_that_have_no_room_between_the_ends_are_left_out() {
        let marks = [(0.0, "<= -0.00001234"), (0.5, "0.00000012"), (1.0, ">= 0.00001234")];
        let marks = marks.map(|(place, text)| (place, text.to_owned()));
        let is_told = |width: usize| lefts(&marks, BAR[0].min(width - 2 * MARGIN), width).iter().flatten().count();
        assert_eq!([is_told(230), is_told(500)], [2, 3]);
    }

    #[test]
    fn titles_are_parted_where_they_are_too_wide() {
        let letters = Letters::Small.width("x");
        assert_eq!(lines("area on the map", 8 * letters), ["area on", "the map"]);
        assert_eq!(lines("area on the map", 15 * letters), ["area on the map"]);
    }
}
