//! Letters of five by seven dots, as many as legends need.

use super::canvas::Canvas;
use super::colour::Colour;

/// The dots of a letter, row by row from above, the leftmost dot in the highest of five bits.
fn rows(letter: char) -> [u8; 7] {
    match letter {
        '0' => [14, 17, 19, 21, 25, 17, 14],
        '1' => [4, 12, 4, 4, 4, 4, 14],
        '2' => [14, 17, 1, 2, 4, 8, 31],
        '3' => [31, 2, 4, 2, 1, 17, 14],
        '4' => [2, 6, 10, 18, 31, 2, 2],
        '5' => [31, 16, 30, 1, 1, 17, 14],
        '6' => [6, 8, 16, 30, 17, 17, 14],
        '7' => [31, 1, 2, 4, 8, 8, 8],
        '8' => [14, 17, 17, 14, 17, 17, 14],
        '9' => [14, 17, 17, 15, 1, 2, 12],
        'a' => [0, 0, 14, 1, 15, 17, 15],
        'c' => [0, 0, 14, 16, 16, 17, 14],
        'd' => [1, 1, 13, 19, 17, 17, 15],
        'e' => [0, 0, 14, 17, 31, 16, 14],
        'f' => [6, 9, 8, 28, 8, 8, 8],
        'g' => [0, 15, 17, 17, 15, 1, 14],
        'i' => [4, 0, 12, 4, 4, 4, 14],
        'l' => [12, 4, 4, 4, 4, 4, 14],
        'n' => [0, 0, 22, 25, 17, 17, 17],
        'o' => [0, 0, 14, 17, 17, 17, 14],
        'p' => [0, 0, 30, 17, 30, 16, 16],
        'r' => [0, 0, 22, 25, 16, 16, 16],
        's' => [0, 0, 14, 16, 14, 1, 30],
        't' => [8, 8, 28, 8, 8, 9, 6],
        'v' => [0, 0, 17, 17, 17, 10, 4],
        '.' => [0, 0, 0, 0, 0, 12, 12],
        '%' => [24, 25, 2, 4, 8, 19, 3],
        _ => [0; 7],
    }
}

/// The width of a text in dots.
pub(super) fn width(text: &str) -> usize {
    6 * text.chars().count()
}

/// Paints a square with its upper left corner at a place.
pub(super) fn square(canvas: &mut Canvas, [x, y]: [f64; 2], side: f64, colour: Colour) {
    let [a, b, c, d] = [[x, y, 1.0], [x + side, y, 1.0], [x + side, y + side, 1.0], [x, y + side, 1.0]];
    canvas.triangle([a, b, c], |_| colour);
    canvas.triangle([a, c, d], |_| colour);
}

/// Writes a text with its upper left corner at a place, dots being squares of a side.
pub(super) fn write(canvas: &mut Canvas, text: &str, [x, y]: [f64; 2], dot: f64, colour: Colour) {
    for (k, letter) in text.chars().enumerate() {
        for (row, dots) in rows(letter).into_iter().enumerate() {
            for column in (0..5).filter(|column| dots >> (4 - column) & 1 == 1) {
                let corner = [x + dot * (6 * k + column) as f64, y + dot * row as f64];
                square(canvas, corner, dot, colour);
            }
        }
    }
}
