//! Flat drawings of lines, discs and a few words: as SVG, or as a picture like any other.

use super::canvas::{Canvas, Picture};
use super::colour::{Colour, PAPER, hex};
use super::lettering;
use std::fmt::Write;

/// The strokes of letters, as a share of their height.
const STROKE: f64 = 0.13;
/// A capital's height as a share of the font's size.
const CAPITAL: f64 = 0.71;

/// A place on the page: to the right and down, in pixels.
pub(crate) type Place = [f64; 2];

/// A drawing; what is added later lies on top.
#[derive(Debug)]
pub(crate) struct Sketch {
    width: f64,
    height: f64,
    items: Vec<Item>,
}

#[derive(Debug)]
enum Item {
    Line { from: Place, to: Place, width: f64, colour: Colour },
    Disc { centre: Place, radius: f64, colour: Colour },
    Text { at: Place, size: f64, anchor: Anchor, colour: Colour, text: String },
}

/// Which part of a text is at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Sketch {
    /// An empty page.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self { width, height, items: Vec::new() }
    }

    /// Adds a line with round ends.
    pub(crate) fn line(&mut self, from: Place, to: Place, width: f64, colour: Colour) {
        self.items.push(Item::Line { from, to, width, colour });
    }

    pub(crate) fn disc(&mut self, centre: Place, radius: f64, colour: Colour) {
        self.items.push(Item::Disc { centre, radius, colour });
    }

    /// Adds a text whose baseline is at a place.
    pub(crate) fn text(&mut self, at: Place, size: f64, anchor: Anchor, colour: Colour, text: impl Into<String>) {
        self.items.push(Item::Text { at, size, anchor, colour, text: text.into() });
    }

    /// As an SVG document.
    pub(crate) fn svg(&self) -> String {
        let (width, height) = (self.width, self.height);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"sans-serif\" stroke-linecap=\"round\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
        );
        for item in &self.items {
            let _ = match item {
                Item::Line { from, to, width, colour } => writeln!(
                    svg,
                    "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{}\" stroke-width=\"{width:.1}\"/>",
                    from[0],
                    from[1],
                    to[0],
                    to[1],
                    hex(*colour)
                ),
                Item::Disc { centre, radius, colour } => writeln!(
                    svg,
                    "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" fill=\"{}\"/>",
                    centre[0],
                    centre[1],
                    hex(*colour)
                ),
                Item::Text { at, size, anchor, colour, text } => writeln!(
                    svg,
                    "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{size}\" text-anchor=\"{}\" fill=\"{}\">{}</text>",
                    at[0],
                    at[1],
                    anchor.name(),
                    hex(*colour),
                    escaped(text)
                ),
            };
        }
        svg + "</svg>\n"
    }

    /// As a picture.
    pub(crate) fn picture(&self) -> Picture {
        let mut canvas = Canvas::new(self.width.ceil() as usize, self.height.ceil() as usize, PAPER);
        let flat = |[x, y]: Place| [x, y, 1.0];
        for item in &self.items {
            match item {
                Item::Line { from, to, width, colour } => canvas.line(flat(*from), flat(*to), *width, *colour),
                Item::Disc { centre, radius, colour } => {
                    canvas.line(flat(*centre), flat(*centre), 2.0 * radius, *colour);
                }
                Item::Text { at, size, anchor, colour, text } => {
                    let (strokes, width) = lettering::write(text, CAPITAL * size);
                    let left = at[0] - anchor.share() * width;
                    let place = |p: [f64; 2]| flat([left + p[0], at[1] - p[1]]);
                    for stroke in strokes {
                        for (i, &from) in stroke.iter().enumerate() {
                            let to = stroke.get(i + 1).copied().unwrap_or(from);
                            canvas.line(place(from), place(to), STROKE * CAPITAL * size, *colour);
                        }
                    }
                }
            }
        }
        canvas.develop()
    }
}

impl Anchor {
    fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }

    /// The part of the text that is left of its place.
    fn share(self) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5,
            Self::End => 1.0,
        }
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_show_what_was_drawn() {
        let mut sketch = Sketch::new(40.0, 30.0);
        sketch.line([0.0, 15.0], [40.0, 15.0], 4.0, [0.0; 3]);
        sketch.text([20.0, 10.0], 9.0, Anchor::Middle, [0.0; 3], "a<b");
        assert!(sketch.svg().contains("a&lt;b") && sketch.svg().contains("<path"));
        let picture = sketch.picture();
        assert_eq!((picture.width, picture.height), (40, 30));
        assert_eq!(picture.pixels[15 * 40 + 20], [0; 3]);
        assert_eq!(picture.pixels[28 * 40 + 20], [255; 3]);
    }
}
