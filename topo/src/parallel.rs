//! Work on blocks of vertices, in parallel if the feature `rayon` is on.
//!
//! Blocks are independent and their results come back in order, so nothing that is computed depends on the number of
//! threads, nor on there being any.

use crate::watch::Watch;
use core::ops::Range;

/// Vertices in a block: enough to make handing it out cheap, few enough to share a megapixel among threads, and to ask after
/// each whether to go on.
pub(crate) const BLOCK: usize = 1 << 15;

/// Calls `work` with blocks of `data` and the range each has in it. Blocks are multiples of `unit` long, except the
/// last.
#[cfg(feature = "rayon")]
pub(crate) fn map_blocks<T: Send, R: Send>(
    data: &mut [T],
    unit: usize,
    work: impl Fn(Range<usize>, &mut [T]) -> R + Sync,
) -> Vec<R> {
    use rayon::prelude::*;
    let length = block_length(unit);
    let work = |(block, data): (usize, &mut [T])| work(block * length..block * length + data.len(), data);
    data.par_chunks_mut(length).enumerate().map(work).collect()
}

/// Calls `work` with blocks of `data` and the range each has in it, one after the other.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_blocks<T, R>(data: &mut [T], unit: usize, work: impl Fn(Range<usize>, &mut [T]) -> R) -> Vec<R> {
    let length = block_length(unit);
    let work = |(block, data): (usize, &mut [T])| work(block * length..block * length + data.len(), data);
    data.chunks_mut(length).enumerate().map(work).collect()
}

/// Calls `work` with blocks of two lists of one length and the range each has in them, as [`map_blocks`] does.
#[cfg(feature = "rayon")]
pub(crate) fn map_blocks_of_two<T: Send, R: Send>(
    [one, two]: [&mut [T]; 2],
    unit: usize,
    work: impl Fn(Range<usize>, [&mut [T]; 2]) -> R + Sync,
) -> Vec<R> {
    use rayon::prelude::*;
    let length = block_length(unit);
    let blocks = one.par_chunks_mut(length).zip(two.par_chunks_mut(length)).enumerate();
    blocks.map(|(block, (one, two))| work(block * length..block * length + one.len(), [one, two])).collect()
}

/// Calls `work` with blocks of two lists of one length and the range each has in them, one after the other.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_blocks_of_two<T, R>(
    [one, two]: [&mut [T]; 2],
    unit: usize,
    work: impl Fn(Range<usize>, [&mut [T]; 2]) -> R,
) -> Vec<R> {
    let length = block_length(unit);
    let blocks = one.chunks_mut(length).zip(two.chunks_mut(length)).enumerate();
    blocks.map(|(block, (one, two))| work(block * length..block * length + one.len(), [one, two])).collect()
}

/// How long a block of whole units is.
fn block_length(unit: usize) -> usize {
    unit.max(1) * (BLOCK / unit.max(1)).max(1)
}

/// The results of `work` for consecutive blocks of `items`, each with the index of its first, in order.
#[cfg(feature = "rayon")]
pub(crate) fn fold_blocks<T: Sync, R: Send>(items: &[T], work: impl Fn(usize, &[T]) -> R + Sync) -> Vec<R> {
    use rayon::prelude::*;
    items.par_chunks(BLOCK).enumerate().map(|(block, items)| work(block * BLOCK, items)).collect()
}

/// The result of `work` for all `items` as one block.
#[cfg(not(feature = "rayon"))]
pub(crate) fn fold_blocks<T, R>(items: &[T], work: impl Fn(usize, &[T]) -> R) -> Vec<R> {
    vec![work(0, items)]
}

/// The results that `map` has for the items of blocks, in their order; those of some blocks only if the watch stops.
#[cfg(feature = "rayon")]
pub(crate) fn filter_map<T: Send, R: Send>(
    blocks: Vec<Vec<T>>,
    watch: Watch<'_>,
    map: impl Fn(T) -> Option<R> + Sync + Send,
) -> Vec<R> {
    use rayon::prelude::*;
    let blocks = blocks.into_par_iter().filter(|_| !watch.stops());
    blocks.flat_map_iter(|items| items.into_iter().filter_map(&map)).collect()
}

/// The results that `map` has for the items of blocks, in their order; those of the first blocks only if the watch stops.
#[cfg(not(feature = "rayon"))]
pub(crate) fn filter_map<T, R>(blocks: Vec<Vec<T>>, watch: Watch<'_>, map: impl Fn(T) -> Option<R>) -> Vec<R> {
    blocks.into_iter().take_while(|_| !watch.stops()).flatten().filter_map(map).collect()
}
