//! Work done at the same time, if the feature `rayon` is on: both sides of a tree, values of which none depends on another.
//!
//! Nothing that is computed depends on the number of threads; how work is parted seldom does ([`threads`]).

use std::cmp::Ordering;
use std::ops::Range;

/// The results of two pieces of work.
#[cfg(feature = "rayon")]
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// The results of two pieces of work, one after the other.
#[cfg(not(feature = "rayon"))]
pub(crate) fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    let a = a();
    (a, b())
}

/// How many threads there are to work on. Nothing that is computed may depend on it, only how work is parted.
#[cfg(feature = "rayon")]
pub(crate) fn threads() -> usize {
    rayon::current_num_threads()
}

/// How many threads there are to work on.
#[cfg(not(feature = "rayon"))]
pub(crate) fn threads() -> usize {
    1
}

/// So many values are found one after the other at least: some tens of microseconds.
#[cfg(feature = "rayon")]
const LEAST: usize = 2048;

/// The values of all numbers below `count`, in order.
#[cfg(feature = "rayon")]
pub(crate) fn map<T: Send>(count: usize, value: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    use rayon::prelude::*;
    (0..count).into_par_iter().with_min_len(LEAST).map(value).collect()
}

/// The values of all numbers below `count`, in order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map<T>(count: usize, value: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(value).collect()
}

/// What is found of each run of `length` numbers below `count`, in order.
#[cfg(feature = "rayon")]
pub(crate) fn of_runs<T: Send>(count: usize, length: usize, of: impl Fn(Range<usize>) -> T + Send + Sync) -> Vec<T> {
    use rayon::prelude::*;
    let run = |k: usize| of(k * length..count.min((k + 1) * length));
    (0..count.div_ceil(length)).into_par_iter().map(run).collect()
}

/// What is found of each run of `length` numbers below `count`, in order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn of_runs<T>(count: usize, length: usize, of: impl Fn(Range<usize>) -> T) -> Vec<T> {
    (0..count.div_ceil(length)).map(|k| of(k * length..count.min((k + 1) * length))).collect()
}

/// Whether something is true of all numbers below `count`, of which so many are asked one after the other.
pub(crate) fn all(count: usize, length: usize, is_true: impl Fn(usize) -> bool + Send + Sync) -> bool {
    !of_runs(count, length, |mut run| run.all(&is_true)).contains(&false)
}

/// Puts items in order, no two of which are equal.
pub(crate) fn sort<T: Ord + Send>(items: &mut [T]) {
    sort_by(items, T::cmp);
}

/// Puts items in order. Those that are equal in it must be the same to the bit.
#[cfg(feature = "rayon")]
pub(crate) fn sort_by<T: Send>(items: &mut [T], order: impl Fn(&T, &T) -> Ordering + Sync) {
    use rayon::prelude::*;
    if threads() > 1 { items.par_sort_unstable_by(order) } else { items.sort_unstable_by(order) }
}

/// Puts items in order. Those that are equal in it must be the same to the bit.
#[cfg(not(feature = "rayon"))]
pub(crate) fn sort_by<T>(items: &mut [T], order: impl Fn(&T, &T) -> Ordering) {
    items.sort_unstable_by(order);
}

/// So many values are found before they are taken up: what they take stays in the cache.
const PIECE: usize = 1 << 15;

/// Takes up the values of all numbers below `count` one after the other, in order; they are found on all threads, piece by piece.
pub(crate) fn each_of<T: Send>(
    count: usize,
    value: impl Fn(usize) -> T + Send + Sync,
    mut take_up: impl FnMut(usize, T),
) {
    for first in (0..count).step_by(PIECE) {
        let found = map(PIECE.min(count - first), |k| value(first + k));
        found.into_iter().zip(first..).for_each(|(value, k)| take_up(k, value));
    }
}

/// The results of two pieces of work, the first of which need not be `Send`: this thread does it.
#[cfg(all(feature = "files", feature = "rayon"))]
pub(crate) fn beside<A, B: Send>(here: impl FnOnce() -> A, b: impl FnOnce() -> B + Send) -> (A, B) {
    let mut of_b = None;
    let a = rayon::in_place_scope(|scope| {
        scope.spawn(|_| of_b = Some(b()));
        here()
    });
    (a, of_b.expect("the scope waits for it"))
}

/// The results of two pieces of work, one after the other.
#[cfg(all(feature = "files", not(feature = "rayon")))]
pub(crate) fn beside<A, B>(here: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    let a = here();
    (a, b())
}

/// Does some work for each of the items, with its place.
///
/// # Errors
/// With the first error in the order of the items.
pub(crate) fn try_each<T: Send, E: Send>(
    first: usize,
    items: &mut [T],
    work: &(impl Fn(usize, &mut T) -> Result<(), E> + Sync),
) -> Result<(), E> {
    match items {
        [] => Ok(()),
        [item] => work(first, item),
        _ => {
            let half = items.len() / 2;
            let (low, high) = items.split_at_mut(half);
            let (low, high) = join(|| try_each(first, low, work), || try_each(first + half, high, work));
            low.and(high)
        }
    }
}
