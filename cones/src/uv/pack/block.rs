//! Small islands, put together to rectangular blocks where there are many.
//!
//! The largest islands are placed by their shape, which takes a search each. The others are sorted by size and put, by their
//! rectangles, on skylines of about equal area; each such block is then placed like an island.

use num_complex::Complex64;

use super::island_place::quarter;
use super::options::PackOptions;
use super::outline::Outline;
use super::piece::{Piece, Rectangle, rectangle};
use super::skyline::skyline;

/// Up to so many islands are all placed by their shape: shapes go into each other's bays, but each takes a search through the
/// whole square. The number is a choice, not the best of several.
const BY_SHAPE: usize = 400;
/// Of more than that so many are.
const LARGEST: usize = 256;
/// The others are put in so many blocks.
const BLOCKS: usize = 64;

/// An island in a piece: z ↦ `turn` z + `to`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    pub(super) island: usize,
    pub(super) turn: Complex64,
    pub(super) to: Complex64,
}

/// A piece and what it is made of.
pub(super) struct Block {
    pub(super) piece: Piece,
    pub(super) members: Vec<Member>,
}

/// The pieces that islands are placed as: themselves, or blocks in which they are `gap` apart, of no more area than a square of
/// side `most` where that can be.
pub(super) fn blocks(outlines: &[Outline], options: &PackOptions, gap: f64, most: f64) -> Vec<Block> {
    let mut islands: Vec<usize> = (0..outlines.len()).filter(|&i| !outlines[i].edges.is_empty()).collect();
    if islands.len() <= BY_SHAPE {
        return alone(outlines, &islands, options);
    }
    let mut rectangles: Vec<Option<Rectangle>> = (0..outlines.len()).map(|_| None).collect();
    islands.iter().for_each(|&i| rectangles[i] = Some(rectangle(&outlines[i], options)));
    let extent = |i: usize| rectangles[i].as_ref().map_or([0.0; 2], |found| found.extent.map(|x| x + gap));
    let size = |i: usize| extent(i)[0] * extent(i)[1];
    islands.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    let mut blocks = alone(outlines, &islands[..LARGEST], options);
    for members in evenly(&islands[LARGEST..], most * most, size) {
        let mut members = members.to_vec();
        members.sort_by(|&a, &b| extent(b)[1].total_cmp(&extent(a)[1]));
        let widest = members.iter().map(|&i| extent(i)[0]).fold(0.0, f64::max);
        let area: f64 = members.iter().map(|&i| size(i)).sum();
        let width = area.sqrt().max(widest);
        let (corners, height) = skyline(&members.iter().map(|&i| extent(i)).collect::<Vec<_>>(), width);
        // Each rectangle has the gap at its right and upper side, which the block itself does not need.
        let right = corners.iter().zip(&members).map(|(at, &i)| at[0] + extent(i)[0]).fold(0.0, f64::max);
        let whole = [right - gap, height - gap].map(|x| x.max(0.0));
        let member = |(&island, at): (&usize, &[f64; 2])| {
            let found = rectangles[island].as_ref().expect("all of these were measured");
            let to = Complex64::new(at[0] - 0.5 * whole[0], at[1] - 0.5 * whole[1]) - found.low;
            Member { island, turn: found.turn, to }
        };
        let covered = members.iter().map(|&i| outlines[i].area).sum();
        blocks.push(Block {
            piece: Piece::rectangle(whole, covered, options.rotations),
            members: members.iter().zip(&corners).map(member).collect(),
        });
    }
    blocks
}

fn alone(outlines: &[Outline], islands: &[usize], options: &PackOptions) -> Vec<Block> {
    let block = |&island: &usize| Block {
        piece: {
            let outline = &outlines[island];
            Piece::new(outline, outline.tilt(), options, islands.len())
        },
        members: vec![Member { island, turn: quarter(0), to: Complex64::default() }],
    };
    islands.iter().map(block).collect()
}

/// Cuts a list into pieces of about equal size, [`BLOCKS`] or as many more as it takes for `most`.
fn evenly(islands: &[usize], most: f64, size: impl Fn(usize) -> f64) -> Vec<&[usize]> {
    let share = islands.iter().map(|&i| size(i)).sum::<f64>() / BLOCKS as f64;
    let share = share.min(most);
    let mut parts = Vec::new();
    let (mut from, mut sum) = (0, 0.0);
    for (k, &island) in islands.iter().enumerate() {
        sum += size(island);
        if sum >= share || k + 1 == islands.len() {
            parts.push(&islands[from..=k]);
            (from, sum) = (k + 1, 0.0);
        }
    }
    parts
}
