//! Pictures of a field: in grey with its extrema marked, and segments shaded by it.

use super::pairs::PairList;
use crate::render::{MAXIMUM, MINIMUM, PAPER, Picture, encode};
use topo::Kind;

/// The share of the values at each end that share one shade, so that few do not bleach all others.
const TAIL: f64 = 0.02;
/// A mark's radius in pixels, of the most and of the least persistent extremum drawn, in a picture a thousand pixels wide; and the
/// smallest that can be seen.
const RADII: (f64, f64) = (9.0, 3.5);
const LEAST_RADIUS: f64 = 1.5;
/// How much larger the white disc under each mark is.
const RIM: f64 = 1.4;
/// A field with fewer pixels along its longer side is drawn larger, by whole factors up to so many.
const READABLE: usize = 480;
/// The share of its colour that a segment keeps where the field is lowest.
const DARKEST: f64 = 0.35;

/// Values from 0 to 1, the tails cut off; NaN where there is none.
pub(crate) fn shares(values: &[f64]) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * sorted.len().saturating_sub(1) as f64) as usize).copied().unwrap_or(0.0);
    let (low, high) = (at(TAIL), at(1.0 - TAIL));
    let share = |value: f64| if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
    values.iter().map(|&value| if value.is_nan() { value } else { share(value) }).collect()
}

/// A field in grey, the most persistent extrema of each direction marked, minima by blue discs and maxima by red ones, the first ones
/// the largest; black where there is no value.
pub(super) fn marked(values: &[f64], [height, width]: [usize; 2], lists: &[PairList], most: usize) -> Picture {
    let grey = |share: f64| if share.is_nan() { [0; 3] } else { [(255.0 * share).round() as u8; 3] };
    let factor = enlargement([height, width]);
    let mut picture =
        Picture { width, height, pixels: shares(values).into_iter().map(grey).collect() }.enlarged(factor);
    let scale = picture.width.max(picture.height) as f64 / 1000.0;
    for list in lists {
        let colour = encode(if list.kind == Kind::Minimum { MINIMUM } else { MAXIMUM });
        let shown = list.pairs.len().min(most);
        // The most persistent come last, above the others.
        for (rank, pair) in list.pairs[..shown].iter().enumerate().rev() {
            let share = rank as f64 / shown as f64;
            let radius = (scale * (RADII.0 + share * (RADII.1 - RADII.0))).max(LEAST_RADIUS);
            let centre = [pair.extremum / width, pair.extremum % width].map(|at| at * factor + factor / 2);
            disc(&mut picture, centre, RIM * radius, encode(PAPER));
            disc(&mut picture, centre, radius, colour);
        }
    }
    picture
}

/// How many pixels along each axis stand for one value of a picture.
fn enlargement([height, width]: [usize; 2]) -> usize {
    (READABLE / width.max(height).max(1)).max(1)
}

/// A picture of colours shaded by a field.
pub(super) fn segmented(
    colours: impl Iterator<Item = [u8; 3]>,
    values: &[f64],
    [height, width]: [usize; 2],
) -> Picture {
    Picture { width, height, pixels: shaded(colours, values) }.enlarged(enlargement([height, width]))
}

/// Colours shaded by a field.
fn shaded(colours: impl Iterator<Item = [u8; 3]>, values: &[f64]) -> Vec<[u8; 3]> {
    let shade = |(colour, share): ([u8; 3], f64)| {
        let light = DARKEST + (1.0 - DARKEST) * if share.is_nan() { 0.0 } else { share };
        colour.map(|part| (f64::from(part) * light).round() as u8)
    };
    colours.zip(shares(values)).map(shade).collect()
}

/// Fills a disc, blending its rim.
fn disc(picture: &mut Picture, [row, column]: [usize; 2], radius: f64, colour: [u8; 3]) {
    let reach = radius.ceil() as usize + 1;
    for y in row.saturating_sub(reach)..(row + reach + 1).min(picture.height) {
        for x in column.saturating_sub(reach)..(column + reach + 1).min(picture.width) {
            let distance = (y as f64 - row as f64).hypot(x as f64 - column as f64);
            let cover = (radius + 0.5 - distance).clamp(0.0, 1.0);
            let pixel = &mut picture.pixels[y * picture.width + x];
            *pixel = std::array::from_fn(|part| {
                let [under, over] = [pixel[part], colour[part]].map(f64::from);
                (under + cover * (over - under)).round() as u8
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_fields_are_drawn_large_enough_to_read() {
        let picture = marked(&[0.0; 64], [8, 8], &[], 0);
        assert_eq!((picture.width, picture.height, picture.pixels.len()), (480, 480, 480 * 480));
        let striped = segmented([[255; 3], [0; 3]].into_iter(), &[1.0, 1.0], [1, 2]);
        assert_eq!((striped.width, striped.height), (480, 240));
        assert!(
            striped
                .pixels
                .chunks(480)
                .all(|row| row[..240].iter().all(|pixel| pixel[0] > 90) && row[240..] == [[0; 3]; 240])
        );
        let tall = marked(&[0.0; 600], [300, 2], &[], 0);
        assert_eq!((tall.width, tall.height), (2, 300));
    }

    #[test]
    fn shades_are_shared_out_between_the_tails() {
        let mut values: Vec<f64> = (0..101).map(f64::from).collect();
        values[100] = 1e9;
        values.push(f64::NAN);
        let shares = shares(&values);
        assert_eq!((shares[0], shares[50], shares[100]), (0.0, 0.5, 1.0));
        assert!(shares[101].is_nan());
        assert_eq!(super::shares(&[7.0, 7.0]), [0.5, 0.5]);
    }
}
