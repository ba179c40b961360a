//! From every vertex a way down to its extremum.
//!
//! Each vertex points to a neighbour that enters before it; following the pointers ends at an extremum, whose *basin*
//! is what leads to it. (Down is meant in the order of the filtration: towards maxima if it is falling.) Basins are
//! found out only for the vertices that are asked about, and every question shortens the way for the next.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// The top bit of a pointer says that it is the number of a basin rather than a vertex.
const BASIN: u32 = 1 << 31;

/// The pointer of a vertex that never enters. No basin has this number, as there are fewer than 2³¹ vertices.
pub(crate) const OUTSIDE: u32 = u32::MAX;

/// A pointer for each vertex, and the extrema at which they end.
///
/// Pointers are atomic so that several threads may ask at once. They overwrite a pointer by the basin it leads to, which
/// is the same whoever does it and whenever: hence relaxed order suffices and results never depend on threads.
#[derive(Debug)]
pub(crate) struct Descent {
    next: Vec<AtomicU32>,
    extrema: Vec<u32>,
}

impl Descent {
    /// From the neighbour each vertex points to ([`OUTSIDE`] if it never enters, anything for extrema) and the extrema
    /// by rising index.
    pub(crate) fn new(mut next: Vec<u32>, extrema: Vec<u32>) -> Self {
        for (&extremum, basin) in extrema.iter().zip(0..) {
            next[extremum as usize] = BASIN | basin;
        }
        Self { next: next.into_iter().map(AtomicU32::new).collect(), extrema }
    }

    /// The extrema by basin, which is by rising vertex index.
    pub(crate) fn extrema(&self) -> &[u32] {
        &self.extrema
    }

    /// The basin of a vertex that enters.
    pub(crate) fn basin(&self, vertex: u32) -> u32 {
        let mut pointer = self.pointer(vertex);
        while pointer & BASIN == 0 {
            pointer = self.pointer(pointer);
        }
        self.shorten(vertex, pointer);
        pointer & !BASIN
    }

    /// The basin of any vertex, if it enters.
    pub(crate) fn basin_if_any(&self, vertex: u32) -> Option<u32> {
        (self.pointer(vertex) != OUTSIDE).then(|| self.basin(vertex))
    }

    /// The basin of every vertex, [`OUTSIDE`] where it never enters; and the extrema.
    pub(crate) fn into_basins(self) -> (Vec<u32>, Vec<u32>) {
        // In place: both kinds of pointers are of one size.
        let mut next: Vec<u32> = self.next.into_iter().map(AtomicU32::into_inner).collect();
        // Most ways end within two passes, upwards and downwards, that skip without a branch.
        (0..next.len()).for_each(|v| skip(&mut next, v));
        (0..next.len()).rev().for_each(|v| skip(&mut next, v));
        for v in 0..next.len() {
            if next[v] & BASIN == 0 {
                next[v] = follow(&mut next, v as u32);
            }
        }
        next.iter_mut().filter(|pointer| **pointer != OUTSIDE).for_each(|pointer| *pointer &= !BASIN);
        (next, self.extrema)
    }

    fn pointer(&self, vertex: u32) -> u32 {
        self.next[vertex as usize].load(Relaxed)
    }

    /// Lets all vertices on the way point to the basin itself.
    fn shorten(&self, mut vertex: u32, basin: u32) {
        loop {
            let pointer = self.pointer(vertex);
            if pointer & BASIN != 0 {
                return;
            }
            self.next[vertex as usize].store(basin, Relaxed);
            vertex = pointer;
        }
    }
}

/// Lets a vertex point where the vertex it points to does.
fn skip(next: &mut [u32], vertex: usize) {
    let pointer = next[vertex];
    let from = if pointer & BASIN == 0 { pointer as usize } else { vertex };
    next[vertex] = next[from];
}

/// The basin to which the pointers lead from a vertex; all on the way point to it from now on.
fn follow(next: &mut [u32], from: u32) -> u32 {
    let mut basin = next[from as usize];
    while basin & BASIN == 0 {
        basin = next[basin as usize];
    }
    let mut vertex = from;
    while next[vertex as usize] & BASIN == 0 {
        vertex = core::mem::replace(&mut next[vertex as usize], basin);
    }
    basin
}
