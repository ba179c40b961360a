//! Dijkstra's algorithm (1959, "A note on two problems in connexion with graphs").
//!
//! A queue holds the vertices that were reached, the nearest first, ties by index. A vertex is queued again when a shorter way
//! to it is found; what is queued with a longer one is passed over. Non-negative floats are in the order of their bits, so
//! that the queue holds integers: a distance and its vertex are one.

use std::ops::Add;

use super::queue::Queue;
use crate::watch::{Interrupted, Watch};

/// A length that is not negative.
pub(crate) trait Length: Copy + Default + PartialOrd + Add<Output = Self> {
    /// A vertex behind its distance, in the order of distances.
    type Entry: super::queue::Entry;
    fn entry(self, vertex: u32) -> Self::Entry;
    fn vertex(entry: Self::Entry) -> u32;
}

impl Length for f64 {
    type Entry = u128;
    fn entry(self, vertex: u32) -> u128 {
        u128::from(self.to_bits()) << 32 | u128::from(vertex)
    }
    fn vertex(entry: u128) -> u32 {
        entry as u32
    }
}

impl Length for f32 {
    type Entry = u64;
    fn entry(self, vertex: u32) -> u64 {
        u64::from(self.to_bits()) << 32 | u64::from(vertex)
    }
    fn vertex(entry: u64) -> u32 {
        entry as u32
    }
}

/// Lowers distances, infinite to begin with, to those along edges from the sources. `edges` gives the edges at a vertex: each
/// with its other end and its length. `reached` is told of each edge that makes a way shorter, with the ends of it.
pub(crate) fn dijkstra<L: Length, E, I: Iterator<Item = (E, u32, L)>>(
    distance: &mut [L],
    sources: impl Iterator<Item = u32>,
    edges: impl Fn(u32) -> I,
    mut reached: impl FnMut(u32, E, u32),
    watch: Watch,
) -> Result<(), Interrupted> {
    let mut queue = Queue::default();
    for source in sources {
        distance[source as usize] = L::default();
        queue.push(L::default().entry(source));
    }
    let mut done = 0;
    loop {
        // What was queued before a shorter way to its vertex was found is passed over.
        let is_shortest = |entry: L::Entry| {
            let v = L::vertex(entry);
            distance[v as usize].entry(v) == entry
        };
        let Some(first) = queue.pop(is_shortest) else { return Ok(()) };
        let v = L::vertex(first);
        let to_here = distance[v as usize];
        watch.ask_at_step(done, distance.len())?;
        done += 1;
        for (edge, w, length) in edges(v) {
            let along = to_here + length;
            if along < distance[w as usize] {
                distance[w as usize] = along;
                reached(v, edge, w);
                queue.push(along.entry(w));
            }
        }
    }
}
