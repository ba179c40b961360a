//! From every vertex a way down to its extremum.
//!
//! Each vertex points to a neighbour that enters before it; following the pointers ends at an extremum, whose *basin*
//! is what leads to it. (Down is meant in the order of the filtration: towards maxima if it is falling.) Basins are
//! found out only for the vertices that are asked about, and every question shortens the way for the next.

use crate::watch::Watch;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::sync::OnceLock;

/// The top bit of a pointer says that it is the number of a basin rather than a vertex.
const BASIN: u32 = 1 << 31;

/// So many vertices are settled within a millisecond, and then the watch is asked.
const SETTLED: usize = 1 << 17;

/// The pointer of a vertex that never enters. No basin has this number, as there are fewer than 2³¹ vertices.
pub(crate) const OUTSIDE: u32 = u32::MAX;

/// Where one vertex in so many may be a saddle, as on noise, all ways down are followed to their ends at once: on white noise of 1024² that
/// takes half the time of following those that are asked for.
const MANY_CANDIDATES: usize = 16;

/// A pointer for each vertex, and the extrema at which they end.
///
/// Pointers are atomic so that several threads may ask at once. They overwrite a pointer by the basin it leads to, which
/// is the same whoever does it and whenever: hence relaxed order suffices and results never depend on threads.
#[derive(Debug)]
pub(crate) struct Descent {
    next: Vec<AtomicU32>,
    extrema: Vec<u32>,
    /// Whether all ways have been followed to their ends.
    settled: OnceLock<()>,
}

impl Descent {
    /// From the neighbour each vertex points to ([`OUTSIDE`] if it never enters, anything for extrema) and the extrema
    /// by rising index.
    pub(crate) fn new(mut next: Vec<u32>, extrema: Vec<u32>) -> Self {
        for (&extremum, basin) in extrema.iter().zip(0..) {
            next[extremum as usize] = BASIN | basin;
        }
        Self { next: next.into_iter().map(AtomicU32::new).collect(), extrema, settled: OnceLock::new() }
    }

    /// The extrema by basin, which is by rising vertex index.
    pub(crate) fn extrema(&self) -> &[u32] {
        &self.extrema
    }

    /// The basin of a vertex that enters.
    #[inline]
    pub(crate) fn basin(&self, vertex: u32) -> u32 {
        let pointer = self.pointer(vertex);
        (if pointer & BASIN == 0 { follow(&self.next, vertex) } else { pointer }) & !BASIN
    }

    /// The basin of a vertex once all ways have been followed to their ends, [`OUTSIDE`] if it never enters; any number that differs from
    /// those of other basins.
    #[inline]
    pub(crate) fn basin_or_outside(&self, vertex: u32) -> u32 {
        self.pointer(vertex)
    }

    /// The basin of any vertex, if it enters.
    pub(crate) fn basin_if_any(&self, vertex: u32) -> Option<u32> {
        (self.pointer(vertex) != OUTSIDE).then(|| self.basin(vertex))
    }

    /// Whether so many candidates for saddles make it worth while to follow all ways to their ends.
    pub(crate) fn is_worth_settling_for(&self, candidates: usize) -> bool {
        candidates > self.extrema.len().max(self.next.len() / MANY_CANDIDATES)
    }

    /// Follows most ways to their ends, all of one bend: there is no need to settle before [`BasinLabels::into_labels`].
    pub(crate) fn shorten(&self, watch: Watch<'_>) {
        shorten(&self.next, watch);
    }

    /// Follows all ways to their ends.
    pub(crate) fn settle(&self, watch: Watch<'_>) {
        self.settled.get_or_init(|| settle(&self.next, watch));
    }

    /// The way down from every vertex without the extrema; and the extrema.
    pub(crate) fn into_labels(self) -> (BasinLabels, Vec<u32>) {
        (BasinLabels { next: self.next, settled: self.settled }, self.extrema)
    }

    fn pointer(&self, vertex: u32) -> u32 {
        self.next[vertex as usize].load(Relaxed)
    }
}

/// The basin of each vertex. All are found at once when one is first asked for: nodes and pairs of a merge tree need none.
#[derive(Debug)]
pub(crate) struct BasinLabels {
    next: Vec<AtomicU32>,
    /// Whether all ways have ended.
    settled: OnceLock<()>,
}

impl BasinLabels {
    /// From the basin of each vertex, [`OUTSIDE`] where it never enters.
    pub(crate) fn new(basins: impl Iterator<Item = u32>) -> Self {
        let next = basins.map(|basin| AtomicU32::new(basin | BASIN)).collect();
        Self { next, settled: OnceLock::from(()) }
    }

    /// The basins themselves. O(n) at the first call.
    pub(crate) fn settled(&self) -> Settled<'_> {
        self.settled.get_or_init(|| settle(&self.next, Watch::NONE));
        Settled(&self.next)
    }

    /// For each vertex what `label` makes of its basin, or of [`OUTSIDE`]; of anything once the watch stops. Ways that have not ended are
    /// followed on the way: they end at a basin, or at a vertex that has its label.
    pub(crate) fn into_labels(self, watch: Watch<'_>, label: impl Fn(u32) -> u32) -> Vec<u32> {
        // In place and at no cost: both are the same bits.
        let mut labels: Vec<u32> = self.next.into_iter().map(AtomicU32::into_inner).collect();
        for start in (0..labels.len()).step_by(SETTLED).take_while(|_| !watch.stops()) {
            for v in start..labels.len().min(start + SETTLED) {
                let mut pointer = labels[v];
                while pointer & BASIN == 0 && pointer as usize >= v {
                    pointer = labels[pointer as usize];
                }
                labels[v] = if pointer & BASIN == 0 { labels[pointer as usize] } else { label(basin(pointer)) };
            }
        }
        labels
    }
}

impl Clone for BasinLabels {
    fn clone(&self) -> Self {
        Self::new(self.settled().iter())
    }
}

/// The basin of every vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settled<'a>(&'a [AtomicU32]);

impl<'a> Settled<'a> {
    /// The basin of a vertex, [`OUTSIDE`] where it never enters.
    pub(crate) fn of(self, vertex: u32) -> u32 {
        basin(self.0[vertex as usize].load(Relaxed))
    }

    /// The basin of every vertex, [`OUTSIDE`] where it never enters.
    pub(crate) fn iter(self) -> impl ExactSizeIterator<Item = u32> + 'a {
        self.0.iter().map(|pointer| basin(pointer.load(Relaxed)))
    }
}

/// The basin in a pointer to one.
fn basin(pointer: u32) -> u32 {
    if pointer == OUTSIDE { OUTSIDE } else { pointer & !BASIN }
}

/// Lets every vertex point to its basin, unless the watch stops.
fn settle(next: &[AtomicU32], watch: Watch<'_>) {
    shorten(next, watch);
    let goes_on = |_: &&[AtomicU32]| !watch.stops();
    for (v, pointer) in (0..).zip(next.chunks(SETTLED).take_while(goes_on).flatten()) {
        if pointer.load(Relaxed) & BASIN == 0 {
            follow(next, v);
        }
    }
}

/// Lets most vertices point to their basins, unless the watch stops: most ways end within three passes, up, down and up, that skip
/// without a branch. After two one vertex in ten of a smooth picture still points to another.
fn shorten(next: &[AtomicU32], watch: Watch<'_>) {
    let goes_on = |_: &&[AtomicU32]| !watch.stops();
    next.chunks(SETTLED).take_while(goes_on).flatten().for_each(|pointer| skip(next, pointer));
    next.rchunks(SETTLED)
        .take_while(goes_on)
        .flat_map(|block| block.iter().rev())
        .for_each(|pointer| skip(next, pointer));
    next.chunks(SETTLED).take_while(goes_on).flatten().for_each(|pointer| skip(next, pointer));
}

/// Lets a vertex point where the vertex it points to does.
fn skip(next: &[AtomicU32], of: &AtomicU32) {
    let pointer = of.load(Relaxed);
    let farther = next.get(pointer as usize).unwrap_or(of);
    of.store(farther.load(Relaxed), Relaxed);
}

/// The pointer to a basin at which the way from a vertex ends; all on the way point there from now on.
fn follow(next: &[AtomicU32], from: u32) -> u32 {
    let pointer = |vertex: u32| next[vertex as usize].load(Relaxed);
    let mut end = pointer(from);
    while end & BASIN == 0 {
        end = pointer(end);
    }
    let mut vertex = from;
    loop {
        let on = pointer(vertex);
        if on & BASIN != 0 {
            return end;
        }
        next[vertex as usize].store(end, Relaxed);
        vertex = on;
    }
}
