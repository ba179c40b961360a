//! Flat drawings of lines, discs and a few words as SVG documents.

use super::colour::{Colour, hex};
use std::fmt::Write;

/// A place on the page: to the right and down, in pixels.
type PagePoint = [f64; 2];

/// A drawing; what is added later lies on top.
#[derive(Debug)]
pub(crate) struct Svg {
    text: String,
}

/// Which part of a text is at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Svg {
    /// An empty page.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"sans-serif\" stroke-linecap=\"round\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
        );
        Self { text }
    }

    /// Adds a line with round ends.
    pub(crate) fn line(&mut self, from: PagePoint, to: PagePoint, width: f64, colour: Colour) {
        let ([x, y], [u, v], colour) = (from, to, hex(colour));
        self.add(format_args!(
            "<path d=\"M{x:.1} {y:.1}L{u:.1} {v:.1}\" stroke=\"{colour}\" stroke-width=\"{width:.1}\"/>"
        ));
    }

    pub(crate) fn disc(&mut self, [x, y]: PagePoint, radius: f64, colour: Colour) {
        self.add(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" fill=\"{}\"/>", hex(colour)));
    }

    /// Adds a text whose baseline is at a place.
    pub(crate) fn text(&mut self, [x, y]: PagePoint, size: f64, anchor: Anchor, colour: Colour, text: &str) {
        let (anchor, colour, text) = (anchor.name(), hex(colour), escaped(text));
        self.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{text}</text>"
        ));
    }

    /// The whole document.
    pub(crate) fn finish(self) -> String {
        self.text + "</svg>\n"
    }

    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        let _ = writeln!(self.text, "{element}");
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
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_holds_what_was_drawn() {
        let mut svg = Svg::new(40.0, 30.0);
        svg.line([0.0, 15.0], [40.0, 15.0], 4.0, [0.0; 3]);
        svg.text([20.0, 10.0], 9.0, Anchor::Middle, [0.0; 3], "a<b");
        let text = svg.finish();
        assert!(text.contains("a&lt;b") && text.contains("M0.0 15.0L40.0 15.0") && text.ends_with("</svg>\n"));
    }
}
