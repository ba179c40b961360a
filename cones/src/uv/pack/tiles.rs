//! Pieces of a given size on as many tiles as they need.

use geom::{Interrupted, Watch};

use super::bin::Bin;
use super::piece::Piece;
use super::search::{Level, Put};

/// The side of a tile's grid in cells, for few pieces and for many.
const CELLS: [f64; 2] = [1024.0, 512.0];
const FEW: usize = 64;
/// So many of the last tiles are tried before a new one is begun.
const OPEN: usize = 16;
/// UDIM numbers tiles from 1001 to 9999.
pub(super) const MOST_TILES: usize = 8999;

/// What came of placing pieces on tiles.
pub(super) enum Tiled {
    /// Where each goes.
    All(Vec<Put>),
    /// This piece, the largest, is larger than a tile.
    TooLarge(usize),
    /// There are not enough tiles.
    TooMany,
}

/// Places pieces, largest first, each on the first of the last tiles that has room; tiles have the given side in the pieces'
/// unit, margins being the `share` of it.
pub(super) fn tiled(pieces: &[Piece], side: f64, share: f64, watch: Watch) -> Result<Tiled, Interrupted> {
    // The largest of all: what makes it fit makes all fit.
    let largest = (0..pieces.len()).max_by(|&j, &k| pieces[j].side.total_cmp(&pieces[k].side).then(k.cmp(&j)));
    if let Some(k) = largest.filter(|&k| pieces[k].side > (1.0 - share) * side) {
        return Ok(Tiled::TooLarge(k));
    }
    let cells = CELLS[usize::from(pieces.len() > FEW)];
    let level = Level::new(pieces, None, cells, (side, share), watch)?;
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|&a, &b| pieces[b].side.total_cmp(&pieces[a].side));
    let mut bins: Vec<Option<Bin>> = Vec::new();
    let mut puts = vec![None; pieces.len()];
    for (done, &k) in order.iter().enumerate() {
        watch.ask(done as f64 / order.len() as f64)?;
        let mut open = bins.len().saturating_sub(OPEN);
        if open > 0 {
            bins[open - 1] = None;
        }
        loop {
            if open == bins.len() {
                if bins.len() == MOST_TILES {
                    return Ok(Tiled::TooMany);
                }
                bins.push(Some(level.bin()));
            }
            if let Some(bin) = &mut bins[open] {
                if let Some(put) = level.place_on(bin, k, open as u32) {
                    puts[k] = Some(put);
                    break;
                }
                if bin.is_empty() {
                    return Ok(Tiled::TooLarge(k));
                }
            }
            open += 1;
        }
    }
    Ok(Tiled::All(puts.into_iter().flatten().collect()))
}
