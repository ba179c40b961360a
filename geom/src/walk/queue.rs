//! A queue for what only grows.
//!
//! Entries are integers, and come out the least first. What is pushed is mostly no less than what came out last, as in Dijkstra's algorithm. So it need
//! not be sorted yet: entries lie in buckets by the highest bit in which they differ from a bound (a radix heap; Ahuja, Mehlhorn, Orlin & Tarjan
//! 1990, *Faster algorithms for the shortest path problem*), and only what is not above the bound is in a heap. Where that is empty the first bucket is
//! moved on: into the heap if it has few entries, else into the buckets below.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::BitXor;

/// A bucket of so many entries goes into the heap.
const FEW: usize = 64;
/// As many buckets as the widest entries have bits.
const BUCKETS: usize = 128;

/// Integers.
pub(crate) trait Entry: Copy + Ord + Default + BitXor<Output = Self> {
    /// The number of the highest bit that is set, of a number that is not 0.
    fn highest_bit(self) -> usize;
}

impl Entry for u64 {
    fn highest_bit(self) -> usize {
        self.ilog2() as usize
    }
}

impl Entry for u128 {
    fn highest_bit(self) -> usize {
        self.ilog2() as usize
    }
}

/// See the module's head.
pub(crate) struct Queue<E> {
    /// What is not above the bound.
    heap: BinaryHeap<Reverse<E>>,
    bound: E,
    /// What is, by the highest bit in which it differs from the bound.
    buckets: [Vec<E>; BUCKETS],
    /// Bit k is set where bucket k has entries.
    filled: u128,
}

impl<E: Entry> Default for Queue<E> {
    fn default() -> Self {
        Self { heap: BinaryHeap::new(), bound: E::default(), buckets: [const { Vec::new() }; BUCKETS], filled: 0 }
    }
}

impl<E: Entry> Queue<E> {
    pub(crate) fn push(&mut self, entry: E) {
        if entry <= self.bound {
            return self.heap.push(Reverse(entry));
        }
        let bucket = (entry ^ self.bound).highest_bit();
        self.buckets[bucket].push(entry);
        self.filled |= 1 << bucket;
    }

    /// The least of the entries that are still wanted; the others are lost.
    pub(crate) fn pop(&mut self, is_wanted: impl Fn(E) -> bool) -> Option<E> {
        loop {
            while let Some(Reverse(first)) = self.heap.pop() {
                if is_wanted(first) {
                    return Some(first);
                }
            }
            if self.filled == 0 {
                return None;
            }
            // All others are greater. Any new bound in this bucket is like the old one above its bit, so that they stay where they are.
            let first = self.filled.trailing_zeros() as usize;
            self.filled &= !(1 << first);
            let mut bucket = std::mem::take(&mut self.buckets[first]);
            bucket.retain(|&entry| is_wanted(entry));
            let bound = if bucket.len() <= FEW { bucket.iter().max() } else { bucket.iter().min() };
            self.bound = bound.copied().unwrap_or(self.bound);
            bucket.drain(..).for_each(|entry| self.push(entry));
            self.buckets[first] = bucket;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// That what comes out is what a heap gives, if what is pushed depends on what came out.
    fn check<E: Entry>(
        first: impl Iterator<Item = E>,
        next: impl Fn(E) -> Vec<E>,
        is_wanted: impl Fn(E) -> bool + Copy,
    ) {
        let (mut queue, mut heap) = (Queue::default(), BinaryHeap::new());
        for entry in first {
            queue.push(entry);
            heap.push(Reverse(entry));
        }
        let (mut count, mut most) = (0, 0);
        while let Some(Reverse(least)) = heap.pop() {
            most = most.max(heap.len());
            if !is_wanted(least) {
                continue;
            }
            assert!(queue.pop(is_wanted) == Some(least));
            count += 1;
            for entry in if count < 20_000 { next(least) } else { Vec::new() } {
                queue.push(entry);
                heap.push(Reverse(entry));
            }
        }
        assert!(queue.pop(is_wanted).is_none());
        assert!(most > 10 * FEW && count > 1000);
    }

    fn random(x: u64) -> u64 {
        let x = (x ^ x >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x ^ x >> 29
    }

    #[test]
    fn entries_come_out_as_from_a_heap() {
        // Distances behind which vertices are, as in Dijkstra's algorithm, with steps of very different lengths.
        let step = |x: u64| ((x % 1000) as f64 / 1e3).powi(1 + (x >> 60) as i32);
        let next = |entry: u128| {
            let along = f64::from_bits((entry >> 32) as u64);
            let ways = (1..=2).map(|k| random(entry as u64 ^ (entry >> 41) as u64 ^ k));
            ways.map(|x| u128::from((along + step(x)).to_bits()) << 32 | u128::from(x as u32 % 5000)).collect()
        };
        check((0..2000_u32).map(u128::from), next, |entry| entry as u32 % 3 != 1);
    }

    #[test]
    fn what_is_pushed_may_be_less_than_what_came_out() {
        let next = |entry: u64| vec![random(entry) >> 20, entry.saturating_sub(random(entry) % 100)];
        let first = (0..1500).map(|k| random(k) >> 20).chain([u64::MAX, u64::MAX - 1]);
        check(first, next, |entry| entry % 5 != 2);
    }
}
