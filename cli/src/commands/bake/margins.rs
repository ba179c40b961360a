//! What lies between islands in a baked picture.
//!
//! Texels near an island have the colour of its nearest texel, so that neither interpolation nor the coarser levels of a texture (mipmaps) show a seam. The others
//! have the mean of all colours.

use crate::render::{decode, encode};
use rayon::prelude::*;

/// The picture with every texel filled, of a square one of `side` rows, each at most 2¹⁶ − 1 long: those that are within so many texels of one that is there as the nearest is, of several as near that in the row
/// itself, above or on the left; the others in the mean colour of all, clear where any is.
pub(super) fn filled(texels: &[Option<[u8; 4]>], side: usize, padding: usize) -> Vec<[u8; 4]> {
    let rest = mean(texels);
    let nearest = nearest_in_row(texels, side);
    let mut pixels = vec![rest; side * side];
    pixels.par_chunks_exact_mut(side).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            if let Some(near) = near(&nearest, [x, y], side, padding).and_then(|place| texels[place]) {
                *pixel = near;
            }
        }
    });
    pixels
}

/// Stands for a row without a texel.
const NONE: u16 = u16::MAX;

/// The column of the nearest texel in its row, of each place.
fn nearest_in_row(texels: &[Option<[u8; 4]>], side: usize) -> Vec<u16> {
    let mut nearest = vec![NONE; side * side];
    nearest.par_chunks_exact_mut(side).zip(texels.par_chunks_exact(side)).for_each(|(nearest, texels)| {
        let mut last = NONE;
        for x in 0..side {
            last = if texels[x].is_some() { x as u16 } else { last };
            nearest[x] = last;
        }
        let mut next = NONE;
        for x in (0..side).rev() {
            next = if texels[x].is_some() { x as u16 } else { next };
            let is_nearer = nearest[x] == NONE || usize::from(next) - x < x - usize::from(nearest[x]);
            if next != NONE && is_nearer {
                nearest[x] = next;
            }
        }
    });
    nearest
}

/// The place of the nearest texel that is within a distance.
fn near(nearest: &[u16], [x, y]: [usize; 2], side: usize, padding: usize) -> Option<usize> {
    let mut best = None;
    let mut least = padding * padding + 1;
    for away in 0..=padding {
        if away * away >= least {
            break;
        }
        let rows = [y.checked_sub(away), (y + away < side && away > 0).then_some(y + away)];
        for row in rows.into_iter().flatten() {
            let column = nearest[row * side + x];
            let across = x.abs_diff(usize::from(column));
            if column != NONE && across * across + away * away < least {
                least = across * across + away * away;
                best = Some(row * side + usize::from(column));
            }
        }
    }
    best
}

/// The mean colour in linear light; clear where any texel is not opaque. Whole numbers are summed, so that their order does not matter.
fn mean(texels: &[Option<[u8; 4]>]) -> [u8; 4] {
    let mut counts = [[0_u64; 256]; 3];
    let mut is_opaque = true;
    for [red, green, blue, alpha] in texels.iter().flatten() {
        is_opaque &= *alpha == u8::MAX;
        counts.iter_mut().zip([red, green, blue]).for_each(|(counts, &x)| counts[usize::from(x)] += 1);
    }
    let colour = counts.map(|counts| {
        let all: u64 = counts.iter().sum();
        let light = (0..=u8::MAX).zip(counts).map(|(x, count)| decode([x; 3])[0] * count as f64);
        light.sum::<f64>() / all.max(1) as f64
    });
    let [red, green, blue] = encode(colour);
    [red, green, blue, if is_opaque { u8::MAX } else { 0 }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_texel_within_the_padding_is_as_the_nearest_one() {
        let side = 40;
        // Some texels in each of several places, all of other colours.
        let is_there = |k: usize| (k * k * 7 + k / side).is_multiple_of(37) || (500..520).contains(&k);
        let texels: Vec<Option<[u8; 4]>> =
            (0..side * side).map(|k| is_there(k).then_some([(k % 251) as u8, (k / 251) as u8, 0, 255])).collect();
        let distance = |a: usize, b: usize| {
            let [dx, dy] = [(a % side).abs_diff(b % side), (a / side).abs_diff(b / side)];
            dx * dx + dy * dy
        };
        for padding in [0, 1, 3, 60] {
            let pixels = filled(&texels, side, padding);
            let rest = mean(&texels);
            for (k, &pixel) in pixels.iter().enumerate() {
                let there = || (0..side * side).filter(|&j| texels[j].is_some());
                let least = there().map(|j| distance(j, k)).min().unwrap();
                if least > padding * padding {
                    assert_eq!(pixel, rest);
                } else {
                    let mut nearest = there().filter(|&j| distance(j, k) == least);
                    assert!(nearest.any(|j| texels[j] == Some(pixel)), "{k} at {padding}");
                }
            }
        }
    }

    #[test]
    fn what_is_far_has_the_mean_light_and_is_clear_where_anything_is() {
        let mut texels = vec![None; 64];
        (texels[0], texels[1]) = (Some([0, 0, 0, 255]), Some([255; 4]));
        assert_eq!(filled(&texels, 8, 1)[63], [188, 188, 188, 255]);
        texels[1] = Some([255, 255, 255, 254]);
        assert_eq!(filled(&texels, 8, 1)[63], [188, 188, 188, 0]);
    }
}
