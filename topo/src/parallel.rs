//! Work on blocks of vertices, in parallel if the feature `rayon` is on.
//!
//! Blocks are independent and their results come back in order, so nothing that is computed depends on the number of
//! threads, nor on there being any. What is done to a block is called through a pointer: nothing next to the block, and what hands blocks out
//! is compiled once rather than for every domain and type of value.

use crate::watch::Watch;
use core::ops::Range;

/// Vertices in a block: enough to make handing it out cheap, few enough to share a megapixel among threads, and to ask after
/// each whether to go on.
pub(crate) const BLOCK: usize = 1 << 15;

/// What is found in a block of a list, given the range that it has there.
#[cfg(feature = "rayon")]
type Scanning<'a, T, R> = &'a (dyn Fn(Range<usize>, &mut [T], &mut R) + Sync);

/// What is found in a block of a list, given the range that it has there.
#[cfg(not(feature = "rayon"))]
type Scanning<'a, T, R> = &'a dyn Fn(Range<usize>, &mut [T], &mut R);

/// What is found in blocks of two lists, given the range that they have there.
#[cfg(feature = "rayon")]
type ScanningTwo<'a, T, R> = &'a (dyn Fn(Range<usize>, [&mut [T]; 2], &mut R) + Sync);

/// What is found in blocks of two lists, given the range that they have there.
#[cfg(not(feature = "rayon"))]
type ScanningTwo<'a, T, R> = &'a dyn Fn(Range<usize>, [&mut [T]; 2], &mut R);

/// Calls `work` with blocks of `data` and the range each has in it. Blocks are multiples of `unit` long, except the
/// last.
#[cfg(feature = "rayon")]
pub(crate) fn map_blocks<T: Send, R: Send>(
    data: &mut [T],
    unit: usize,
    work: &(dyn Fn(Range<usize>, &mut [T]) -> R + Sync),
) -> Vec<R> {
    use rayon::prelude::*;
    let length = block_length(unit);
    let work = |(block, data): (usize, &mut [T])| work(block * length..block * length + data.len(), data);
    data.par_chunks_mut(length).enumerate().map(work).collect()
}

/// Calls `work` with blocks of `data` and the range each has in it, one after the other.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_blocks<T, R>(data: &mut [T], unit: usize, work: &dyn Fn(Range<usize>, &mut [T]) -> R) -> Vec<R> {
    let length = block_length(unit);
    let work = |(block, data): (usize, &mut [T])| work(block * length..block * length + data.len(), data);
    data.chunks_mut(length).enumerate().map(work).collect()
}

/// Calls `work` with blocks of `data` and the range each has in it, to note what it finds there; the findings of consecutive ranges.
#[cfg(feature = "rayon")]
pub(crate) fn scan_blocks<T: Send, R: Default + Send>(data: &mut [T], unit: usize, work: Scanning<'_, T, R>) -> Vec<R> {
    map_blocks(data, unit, &|range, data| {
        let mut found = R::default();
        work(range, data, &mut found);
        found
    })
}

/// Calls `work` with blocks of `data` and the range each has in it, to note what it finds there; all findings in one.
#[cfg(not(feature = "rayon"))]
pub(crate) fn scan_blocks<T, R: Default>(data: &mut [T], unit: usize, work: Scanning<'_, T, R>) -> Vec<R> {
    let (length, mut found) = (block_length(unit), R::default());
    for (block, data) in data.chunks_mut(length).enumerate() {
        work(block * length..block * length + data.len(), data, &mut found);
    }
    vec![found]
}

/// [`scan_blocks`] of two lists of one length.
#[cfg(feature = "rayon")]
pub(crate) fn scan_blocks_of_two<T: Send, R: Default + Send>(
    [one, two]: [&mut [T]; 2],
    unit: usize,
    work: ScanningTwo<'_, T, R>,
) -> Vec<R> {
    use rayon::prelude::*;
    let length = block_length(unit);
    let blocks = one.par_chunks_mut(length).zip(two.par_chunks_mut(length)).enumerate();
    let scan = |(block, (one, two)): (usize, (&mut [T], &mut [T]))| {
        let mut found = R::default();
        work(block * length..block * length + one.len(), [one, two], &mut found);
        found
    };
    blocks.map(scan).collect()
}

/// [`scan_blocks`] of two lists of one length.
#[cfg(not(feature = "rayon"))]
pub(crate) fn scan_blocks_of_two<T, R: Default>(
    [one, two]: [&mut [T]; 2],
    unit: usize,
    work: ScanningTwo<'_, T, R>,
) -> Vec<R> {
    let (length, mut found) = (block_length(unit), R::default());
    for (block, (one, two)) in one.chunks_mut(length).zip(two.chunks_mut(length)).enumerate() {
        work(block * length..block * length + one.len(), [one, two], &mut found);
    }
    vec![found]
}

/// How long a block of whole units is.
fn block_length(unit: usize) -> usize {
    unit.max(1) * (BLOCK / unit.max(1)).max(1)
}

/// The results of `work` for consecutive blocks of `items`, each with the index of its first, in order.
#[cfg(feature = "rayon")]
pub(crate) fn fold_blocks<T: Sync, R: Send>(items: &[T], work: &(dyn Fn(usize, &[T]) -> R + Sync)) -> Vec<R> {
    use rayon::prelude::*;
    items.par_chunks(BLOCK).enumerate().map(|(block, items)| work(block * BLOCK, items)).collect()
}

/// The result of `work` for all `items` as one block.
#[cfg(not(feature = "rayon"))]
pub(crate) fn fold_blocks<T, R>(items: &[T], work: &dyn Fn(usize, &[T]) -> R) -> Vec<R> {
    vec![work(0, items)]
}

/// The results of `work` for consecutive blocks of `items`, in order.
#[cfg(feature = "rayon")]
pub(crate) fn map_each_block<T: Sync, R: Send>(items: &[T], work: &(dyn Fn(&[T]) -> R + Sync)) -> Vec<R> {
    use rayon::prelude::*;
    items.par_chunks(BLOCK).map(work).collect()
}

/// The results of `work` for consecutive blocks of `items`, in order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_each_block<T, R>(items: &[T], work: &dyn Fn(&[T]) -> R) -> Vec<R> {
    items.chunks(BLOCK).map(work).collect()
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

/// The results that `map` has for the items of blocks, in their order and, if there is one block and both are of one size, in their place;
/// only some if the watch stops.
#[cfg(not(feature = "rayon"))]
pub(crate) fn filter_map<T, R>(blocks: Vec<Vec<T>>, watch: Watch<'_>, map: impl Fn(T) -> Option<R>) -> Vec<R> {
    let (mut count, mut stops) = (0usize, false);
    let mut map_if_it_goes_on = |item: T| {
        stops |= count.is_multiple_of(BLOCK) && watch.stops();
        count += 1;
        if stops { None } else { map(item) }
    };
    let results =
        blocks.into_iter().map(|items| items.into_iter().filter_map(&mut map_if_it_goes_on).collect::<Vec<R>>());
    let joined = results.reduce(|mut all, more| {
        all.extend(more);
        all
    });
    joined.unwrap_or_default()
}
