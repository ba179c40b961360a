//! Letters of strokes, for pictures without a font: digits, lower case, and what stands in numbers.
//!
//! A glyph is a list of strokes; a stroke is a list of points, each a digit for x and a digit for y. The baseline is at
//! y = 2, small letters reach to 6, tall ones and digits to 8. A stroke of one point is a dot.

/// Capitals' height in the glyphs' units.
const TALL: f64 = 6.0;
const BASELINE: f64 = 2.0;
/// Space between glyphs.
const GAP: f64 = 2.0;
const BLANK: f64 = 2.0;

/// Strokes of points, x to the right and y up from the baseline's beginning.
pub(super) type Strokes = Vec<Vec<[f64; 2]>>;

/// A text's strokes and its width, `size` being the height of a capital. Letters that are not known are left blank.
pub(super) fn write(text: &str, size: f64) -> (Strokes, f64) {
    let scale = size / TALL;
    let (mut strokes, mut x) = (Vec::new(), 0.0);
    for letter in text.chars() {
        let glyph = glyph(letter);
        let mut width = if glyph.is_empty() { BLANK } else { 0.0 };
        for stroke in glyph.split_whitespace() {
            let points: Vec<[f64; 2]> =
                stroke.as_bytes().chunks_exact(2).map(|p| [p[0], p[1]].map(|d| f64::from(d - b'0'))).collect();
            width = points.iter().fold(width, |width, p| width.max(p[0]));
            strokes.push(points.iter().map(|p| [scale * (x + p[0]), scale * (p[1] - BASELINE)]).collect());
        }
        x += width + GAP;
    }
    (strokes, scale * (x - GAP).max(0.0))
}

fn glyph(letter: char) -> &'static str {
    match letter.to_ascii_lowercase() {
        '0' => "120307183847433212",
        '1' => "062822 0242",
        '2' => "07183847460242",
        '3' => "07183847463515 354443321203",
        '4' => "32380444",
        '5' => "480805354443321203",
        '6' => "473818070312324344351504",
        '7' => "084812",
        '8' => "15060718384746351504031232434435",
        '9' => "031232434738180706153546",
        '-' => "0535",
        '–' => "0545",
        '+' => "0545 2723",
        '=' => "0646 0444",
        '.' => "02",
        ',' => "1201",
        ':' => "02 05",
        '(' => "28171322",
        ')' => "08171302",
        '/' => "0248",
        '_' => "0141",
        'a' => "4642 4536160503123243",
        'b' => "0802 0516364543321203",
        'c' => "4536160503123243",
        'd' => "4842 4536160503123243",
        'e' => "04444536160503123243",
        'f' => "38281712 0636",
        'g' => "4641301001 4536160503123243",
        'h' => "0802 0516364542",
        'i' => "0602 08",
        'j' => "161100 18",
        'k' => "0802 360442",
        'l' => "0802",
        'm' => "0602 0516263532 3546566562",
        'n' => "0602 0516364542",
        'o' => "160503123243453616",
        'p' => "0600 0516364543321203",
        'q' => "4640 4536160503123243",
        'r' => "0602 051636",
        's' => "45361605143443321203",
        't' => "18132232 0636",
        'u' => "0603123243 4642",
        'v' => "062246",
        'w' => "0612243246",
        'x' => "0642 0246",
        'y' => "0622 461000",
        'z' => "06460242",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_numbers_and_labels_are_made_of_is_there() {
        for letter in "0123456789-+.,:()/ abcdefghijklmnopqrstuvwxyz".chars().filter(|letter| *letter != ' ') {
            let (strokes, width) = write(&letter.to_string(), 6.0);
            assert!(!strokes.is_empty() && (0.0..=6.0).contains(&width), "{letter}");
            assert!(strokes.iter().flatten().all(|p| (-2.0..=6.0).contains(&p[1])), "{letter}");
        }
    }

    #[test]
    fn a_text_is_as_wide_as_its_letters_and_the_gaps() {
        assert_eq!(write("", 6.0).1, 0.0);
        assert_eq!(write("ll", 12.0).1, 4.0);
        assert_eq!(write("o o", 6.0).1, 4.0 + 2.0 + 2.0 + 2.0 + 4.0);
    }
}
