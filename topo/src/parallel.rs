//! Work on blocks of vertices, in parallel if the feature `rayon` is on.
//!
//! Blocks are independent and their results come back in order, so nothing that is computed depends on the number of
//! threads, nor on there being any.

use core::ops::Range;

/// Vertices in a block: enough to make handing it out cheap, few enough to share a megapixel among threads.
#[cfg(feature = "rayon")]
const BLOCK: usize = 1 << 15;

/// Calls `work` with blocks of `data` and the range each has in it. Blocks are multiples of `unit` long, except the
/// last.
#[cfg(feature = "rayon")]
pub(crate) fn map_blocks<T: Send, R: Send>(
    data: &mut [T],
    unit: usize,
    work: impl Fn(Range<usize>, &mut [T]) -> R + Sync,
) -> Vec<R> {
    use rayon::prelude::*;
    let length = unit.max(1) * (BLOCK / unit.max(1)).max(1);
    let work = |(block, data): (usize, &mut [T])| work(block * length..block * length + data.len(), data);
    data.par_chunks_mut(length).enumerate().map(work).collect()
}

/// Calls `work` with all of `data` as one block.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_blocks<T, R>(data: &mut [T], _unit: usize, work: impl Fn(Range<usize>, &mut [T]) -> R) -> Vec<R> {
    if data.is_empty() { Vec::new() } else { vec![work(0..data.len(), data)] }
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

/// The results that `map` has for `items`, in their order.
#[cfg(feature = "rayon")]
pub(crate) fn filter_map<T: Sync, R: Send>(items: &[T], map: impl Fn(&T) -> Option<R> + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    items.par_iter().filter_map(map).collect()
}

/// The results that `map` has for `items`, in their order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn filter_map<T, R>(items: &[T], map: impl Fn(&T) -> Option<R>) -> Vec<R> {
    items.iter().filter_map(map).collect()
}
