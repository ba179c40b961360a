//! Islands of a map, packed into the unit square or onto tiles.
//!
//! Each island is moved rigidly, and all are scaled alike, so that no measure of distortion changes. Where there is one, the
//! smallest square about it is found exactly. Several are placed on a grid of bits, conservatively: islands may go into each
//! other's holes and bays, in any of a few turns, and are a margin apart however coarse the grid. Where there are
//! thousands, the small ones are put together to blocks first.
//!
//! Sources: greedy placement of bitmaps is what xatlas (J. Young) and Blender's packer do; what differs is that a whole row of places
//! is tested with two shifted rows of bits for each run of cells ([`bin`]), that the margin is exact ([`raster`]), and that
//! the side is searched with many orders ([`search`]). Nothing is mirrored.

mod arrangement;
mod bin;
mod block;
mod fill;
mod given;
mod hull;
mod island_place;
mod options;
mod outline;
mod piece;
mod raster;
mod room;
mod search;
mod skyline;
mod tiles;
mod tilt;

use geom::{Interrupted, Watch};
use num_complex::Complex64;

pub use fill::fill;
pub(crate) use fill::filled;
pub use island_place::IslandPlace;
pub(crate) use options::readable;
pub use options::{PackError, PackOptions, Rotations, Tiles};
pub(super) use room::convex_hull;
pub(crate) use room::room;

use super::across::Side;
use arrangement::Arrangement;
use block::{Block, blocks};
use given::{as_given, is_apart};
use outline::{Outline, outlines};
pub(super) use piece::Piece;
use piece::Rasters;
use search::{Effort, Put, smallest_square};
use tiles::{MOST_TILES, Tiled, tiled};
use tilt::tilt;

/// So many islands at most are packed with fewer turns, too, than they may take: with more that takes seconds and gains little.
const FEW: usize = 64;
/// The squares of all islands' margins may take this share of the square; where they would take more, margins are narrower. So islands are some
/// two and a half margins wide on average at least.
const MOST_MARGINS: f64 = 0.15;
/// The side of the square is guessed for the margins inside of blocks, at most so often.
const GUESSES: u32 = 20;
/// The side of a block of small islands over that of the tile that it goes on.
const BLOCK_SIDE: f64 = 0.25;
/// Rough packings turn pieces as if there were so many, and move the corners of outlines to a lattice of so many points to the root of
/// the area, where that has some 90 cells: short edges vanish.
const ROUGH_TURNS: usize = 100;
const ROUGH_LATTICE: f64 = 512.0;

/// Where islands go.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Packing {
    /// The motion of each island.
    pub places: Vec<IslandPlace>,
    /// What lengths are multiplied by after that: on its tile everything is between 0 and 1.
    pub scale: f64,
    /// How many tiles there are.
    pub tiles: usize,
    /// The islands' areas, added up, over that of the tiles.
    pub fill: f64,
    /// How many texels islands are apart at least: what was asked for, or less where there are too many islands for that.
    pub margin: f64,
}

impl Packing {
    /// The texture coordinates of a point of an island.
    ///
    /// # Panics
    /// If there is no such island.
    pub fn place(&self, island: usize, p: [f64; 2]) -> [f64; 2] {
        let motion = &self.places[island];
        let q = motion.apply(p);
        [0, 1].map(|k| self.scale * q[k] + motion.corner()[k])
    }

    /// The same in the size of the islands: a tile's side is 1 / [`scale`](Self::scale).
    ///
    /// # Panics
    /// If there is no such island.
    pub fn unscaled(&self, island: usize, p: [f64; 2]) -> [f64; 2] {
        let motion = &self.places[island];
        let q = motion.apply(p);
        [0, 1].map(|k| q[k] + motion.corner()[k] / self.scale)
    }
}

/// Packs islands, given as triangles in the plane and the number of the island of each, which count from 0.
///
/// ```
/// use cones::uv::{PackOptions, pack};
///
/// let square = [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
/// let far = square.map(|t| t.map(|[x, y]| [x + 7.0, 0.25 * y]));
/// let triangles = [square, far].concat();
/// let packing = pack(&triangles, &[0, 0, 1, 1], &PackOptions::default(), geom::Watch::NONE)?;
/// assert!(packing.fill > 0.6);
/// let corner = packing.place(1, [7.0, 0.0]);
/// assert!(corner.iter().all(|x| (0.0..=1.0).contains(x)));
/// # Ok::<(), cones::uv::PackError>(())
/// ```
///
/// Linear in the triangles but for what bounds the islands; the search takes a number of steps that depends on the number of
/// islands only. What comes out depends on nothing but the input, not on the number of threads either.
///
/// # Errors
/// If the lists differ in length, the number of an island is not less than that of all triangles, coordinates are not finite, options make no sense, an island is larger than a tile of the
/// density that was asked for, or the work was stopped.
pub fn pack(
    triangles: &[[[f64; 2]; 3]],
    island: &[u32],
    options: &PackOptions,
    watch: Watch,
) -> Result<Packing, PackError> {
    options.check()?;
    if triangles.len() != island.len() {
        return Err(PackError::Count { triangles: triangles.len(), islands: island.len() });
    }
    check_islands(island.iter().copied().map(Some))?;
    pack_numbered(triangles, island, options, watch)
}

/// Refuses the numbers of triangles' islands, if these have any, that are not less than how many triangles there are: memory is taken for each number.
pub(super) fn check_islands(islands: impl ExactSizeIterator<Item = Option<u32>>) -> Result<(), PackError> {
    let triangles = islands.len();
    let is_too_large = |&(_, island): &(usize, Option<u32>)| island.is_some_and(|island| island as usize >= triangles);
    match islands.enumerate().find(is_too_large) {
        Some((triangle, Some(island))) => Err(PackError::Island { triangle, island, triangles }),
        _ => Ok(()),
    }
}

/// [`pack`] with options, and numbers of islands, that were checked.
pub(super) fn pack_numbered(
    triangles: &[[[f64; 2]; 3]],
    island: &[u32],
    options: &PackOptions,
    watch: Watch,
) -> Result<Packing, PackError> {
    let (outlines, unit) = outlines(triangles, island, watch.within(0.0, 0.2))?;
    let count = outlines.iter().filter(|outline| !outline.edges.is_empty()).count();
    if count == 0 {
        return Ok(Packing {
            places: vec![IslandPlace::NONE; outlines.len()],
            scale: 1.0,
            tiles: 0,
            fill: 0.0,
            margin: options.margin,
        });
    }
    let share = share(options, count);
    let mut best = best_arranged(&outlines, (unit, share), options, watch.within(0.2, 0.95))?;
    let may_stay = options.tiles == Tiles::One && !options.align;
    if may_stay
        && let Some(given) = as_given(&outlines, unit, share)
        && !best.is_better_than(&given)
        && is_apart((triangles, island), (&outlines, unit), &given, watch.within(0.95, 1.0))?
    {
        best = given;
    }
    let area: f64 = outlines.iter().map(|outline| outline.area).sum();
    Ok(Packing {
        scale: 1.0 / (best.side * unit),
        tiles: best.tiles,
        fill: area / (best.side * best.side) / best.tiles as f64,
        margin: best.share * f64::from(options.texture_size),
        places: best.places,
    })
}

/// The best arrangement with islands turned as far as they may be, or less: greedy as the search is, it may find a better one among few turns than
/// among many.
fn best_arranged(
    outlines: &[Outline],
    (unit, share): (f64, f64),
    options: &PackOptions,
    watch: Watch,
) -> Result<Arrangement, PackError> {
    let all = match outlines.len() {
        0..=FEW => options.rotations.up_to(),
        _ => &[options.rotations][..],
    };
    let mut best: Result<Arrangement, PackError> = Err(Interrupted.into());
    for (k, &rotations) in all.iter().enumerate() {
        let at = |k: usize| k as f64 / all.len() as f64;
        let options = PackOptions { rotations, ..*options };
        let found = arranged(outlines, (unit, share), &options, watch.within(at(k), at(k + 1)));
        best = match (best, found) {
            (_, Err(error @ PackError::Interrupted(_))) => return Err(error),
            (Ok(best), Err(_)) => Ok(best),
            (Ok(best), Ok(found)) if !found.is_better_than(&best) => Ok(best),
            (_, found) => found,
        };
    }
    best
}

fn arranged(
    outlines: &[Outline],
    (unit, share): (f64, f64),
    options: &PackOptions,
    watch: Watch,
) -> Result<Arrangement, PackError> {
    let (blocks, puts, [side, share]) = match options.tiles {
        Tiles::One => in_square(outlines, options, share, watch)?,
        Tiles::Udim { texel_density } => {
            let side = f64::from(options.texture_size) / texel_density / unit;
            if !side.is_finite() {
                return Err(PackError::Density(texel_density));
            }
            let (blocks, puts) = on_tiles(outlines, options, (side, share), texel_density, watch)?;
            (blocks, puts, [side, share])
        }
    };
    let tiles = puts.iter().map(|put| put.tile as usize + 1).max().unwrap_or(0);
    Ok(Arrangement { places: places(outlines, unit, &blocks, &puts), tiles, side, share })
}

/// Islands that are packed roughly, again and again with others in place of some: for comparing.
pub(super) struct Rough<'a> {
    area: f64,
    options: &'a PackOptions,
    pieces: Vec<Piece>,
}

impl<'a> Rough<'a> {
    pub(super) fn new(sides: &[&Side], options: &'a PackOptions) -> Self {
        let area = sides.iter().map(|side| side.area).sum();
        let mut rough = Self { area, options, pieces: Vec::new() };
        rough.pieces = sides.iter().map(|side| rough.piece(side)).collect();
        rough
    }

    /// An island that may be packed often.
    pub(super) fn piece(&self, side: &Side) -> Piece {
        let unit = self.area.sqrt();
        let point = |p: [f64; 2]| {
            let [x, y] = p.map(|x| (x / unit * ROUGH_LATTICE).round() / ROUGH_LATTICE);
            Complex64::new(x, y)
        };
        let edges = side.edges.iter().map(|edge| edge.map(point)).filter(|[a, b]| a != b).collect();
        let outline = Outline { edges, centre: [0.0; 2], area: side.area / self.area };
        // Not of the points on the lattice, which has directions of its own.
        let exact = side.edges.iter().map(|edge| edge.map(|[x, y]| Complex64::new(x, y)));
        let tilt = if self.options.rotations == Rotations::Any { None } else { tilt(exact) };
        Piece { rasters: Rasters::kept(), ..Piece::new(&outline, tilt, self.options, ROUGH_TURNS) }
    }

    /// How much of a square they fill.
    pub(super) fn fill(&self, watch: Watch) -> Result<f64, Interrupted> {
        self.fill_of(&self.pieces, Effort::ROUGH, watch)
    }

    /// How much of a square they fill with others in place of some, which have the areas of these.
    pub(super) fn fill_with(&self, others: &[Instead], watch: Watch) -> Result<f64, Interrupted> {
        self.fill_of(&self.pieces_with(others), Effort::ROUGH, watch)
    }

    /// The same if they are placed once, the largest first: mostly less, in a fraction of the time.
    pub(super) fn fill_once_with(&self, others: &[Instead], watch: Watch) -> Result<f64, Interrupted> {
        self.fill_of(&self.pieces_with(others), Effort::ONCE, watch)
    }

    fn pieces_with(&self, others: &[Instead]) -> Vec<Piece> {
        let stays = |(k, _): &(usize, &Piece)| others.iter().all(|(without, _)| without != k);
        let left = self.pieces.iter().enumerate().filter(stays).map(|(_, piece)| piece);
        left.chain(others.iter().flat_map(|(_, pieces)| *pieces)).cloned().collect()
    }

    fn fill_of(&self, pieces: &[Piece], effort: Effort, watch: Watch) -> Result<f64, Interrupted> {
        let (_, side) = smallest_square(pieces, share(self.options, pieces.len()), effort, watch)?;
        Ok(if self.area > 0.0 { 1.0 / (side * side) } else { 0.0 })
    }
}

/// An island's number, and what there is in its place.
pub(super) type Instead<'a> = (usize, &'a [Piece; 2]);

/// The margin as a share of a tile's side.
fn share(options: &PackOptions, islands: usize) -> f64 {
    let asked = options.margin / f64::from(options.texture_size);
    match options.tiles {
        Tiles::One => asked.min((MOST_MARGINS / islands as f64).sqrt()),
        Tiles::Udim { .. } => asked,
    }
}

/// What is packed and where; the side of the square, and the share of it that margins take.
type InSquare = (Vec<Block>, Vec<Put>, [f64; 2]);

/// Packs into the smallest square. The margin inside of blocks depends on the side that comes out, so that is guessed until
/// the guess is neither too small nor much too large.
fn in_square(outlines: &[Outline], options: &PackOptions, share: f64, watch: Watch) -> Result<InSquare, PackError> {
    let area: f64 = outlines.iter().map(|outline| outline.area).sum();
    let mut guess = 1.5 * area.sqrt();
    let mut growth = 1.0;
    for round in 1.. {
        watch.ask(0.0)?;
        let blocks = blocks(outlines, options, share * guess, f64::INFINITY);
        let pieces: Vec<Piece> = blocks.iter().map(|block| block.piece.clone()).collect();
        let (puts, side) = smallest_square(&pieces, share, Effort::FULL, watch)?;
        let is_simple = blocks.iter().all(|block| block.members.len() == 1);
        let is_enough = side <= guess && (side > 0.9 * guess || round > 2);
        if is_simple || is_enough || round == GUESSES {
            let kept = if is_simple { share } else { share * (guess / side).min(1.0) };
            return Ok((blocks, puts, [side, kept]));
        }
        growth += 0.05;
        guess = if side > guess { growth * side } else { 1.03 * side };
    }
    unreachable!("rounds end")
}

/// Packs onto tiles of a side in the outlines' unit.
fn on_tiles(
    outlines: &[Outline],
    options: &PackOptions,
    (side, share): (f64, f64),
    density: f64,
    watch: Watch,
) -> Result<(Vec<Block>, Vec<Put>), PackError> {
    let blocks = blocks(outlines, options, share * side, BLOCK_SIDE * side);
    let pieces: Vec<Piece> = blocks.iter().map(|block| block.piece.clone()).collect();
    match tiled(&pieces, side, share, watch)? {
        Tiled::All(puts) => Ok((blocks, puts)),
        Tiled::TooLarge(k) => {
            let times = pieces[k].side / (1.0 - share) / side;
            // A little less, as tiles are filled on a grid.
            let fits = 0.99 * density / times.max(1.0);
            Err(PackError::TooLarge { island: blocks[k].members[0].island, times, fits })
        }
        Tiled::TooMany => Err(PackError::TooManyTiles(MOST_TILES)),
    }
}

fn places(outlines: &[Outline], unit: f64, blocks: &[Block], puts: &[Put]) -> Vec<IslandPlace> {
    let mut places = vec![IslandPlace::NONE; outlines.len()];
    for (block, put) in blocks.iter().zip(puts) {
        for member in &block.members {
            let turn: Complex64 = put.turn * member.turn;
            let to = (put.turn * member.to + put.to) * unit;
            let from = outlines[member.island].centre;
            places[member.island] = IslandPlace { turn: [turn.re, turn.im], from, to: [to.re, to.im], tile: put.tile };
        }
    }
    places
}

#[cfg(test)]
mod tests;
