//! Vertices in a row: time series, profiles, spectra.
//!
//! On a path minima and maxima alternate, and one pass with a stack pairs them in O(n): basins wait on the stack,
//! separated by maxima that fall from bottom to top. A new maximum first settles the lower ones: across each the younger
//! basin dies. The idea is the one behind building a Cartesian tree (Vuillemin 1980, "A unifying look at data
//! structures") and rainflow counting.

use super::graph::Domain;
use crate::filtration::{Direction, Filtration};
use crate::pairing::{Merge, NONE};
use crate::scalar::Scalar;
use core::ops::Range;

/// `n` vertices in a row, each a neighbour of the next.
///
/// ```
/// let temperatures = [14.0, 11.5, 17.0, 12.0, 21.0, 9.0];
/// let warm = topo::superlevel(&topo::Path::new(6), &temperatures)?.ranked();
/// let peaks: Vec<_> = warm.iter().map(|peak| (peak.extremum, peak.persistence())).collect();
/// assert_eq!(peaks, [(4, 12.0), (2, 5.0), (0, 2.5)]);
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Path {
    count: usize,
}

impl Path {
    /// A path of so many vertices.
    pub fn new(vertices: usize) -> Self {
        Self { count: vertices }
    }
}

impl Domain for &Path {
    type Vertex = usize;

    fn vertex_count(&self) -> usize {
        self.count
    }

    fn vertex(&self, index: usize) -> usize {
        index
    }

    fn for_each_neighbor(&self, index: usize, mut visit: impl FnMut(usize)) {
        if index > 0 {
            visit(index - 1);
        }
        if index + 1 < self.count {
            visit(index + 1);
        }
    }

    fn merges<S: Scalar, D: Direction>(&self, filtration: &Filtration<'_, S, D>) -> Vec<Merge> {
        let mut stack = Stack { filtration, basins: Vec::new(), merges: Vec::new() };
        let mut start = 0;
        for segment in filtration.field().split(|value| value.is_nan()) {
            stack.pair(start as u32..(start + segment.len()) as u32);
            start += segment.len() + 1;
        }
        stack.merges
    }
}

/// A basin that waits, and the maximum that separates it from the one below it on the stack.
#[derive(Clone, Copy)]
struct Basin {
    minimum: u32,
    /// Its place among the merges.
    place: u32,
    /// [`NONE`] at the bottom of the stack.
    separator: u32,
}

struct Stack<'a, S, D> {
    filtration: &'a Filtration<'a, S, D>,
    basins: Vec<Basin>,
    /// What becomes of each basin, by rising index of its minimum.
    merges: Vec<Merge>,
}

impl<S: Scalar, D: Direction> Stack<'_, S, D> {
    /// Pairs a stretch of vertices that all enter.
    fn pair(&mut self, stretch: Range<u32>) {
        if stretch.is_empty() {
            return;
        }
        let (first, end) = (stretch.start, stretch.end);
        let mut last = self.filtration.later(first, end - 1);
        let (mut falls, mut separator) = (true, NONE);
        for v in stretch {
            let fell = falls;
            falls = v + 1 < end && self.filtration.precedes(v + 1, v);
            if fell && !falls {
                self.basins.push(Basin { minimum: v, place: self.merges.len() as u32, separator });
                self.merges.push(Merge::born(v));
            } else if !fell && falls {
                self.settle(|filtration, separator| filtration.precedes(separator, v));
                last = self.filtration.later(last, v);
                separator = v;
            }
        }
        self.settle(|_, _| true);
        if let Some(eldest) = self.basins.pop() {
            self.merges[eldest.place as usize].end = last;
        }
    }

    /// Merges basins across the separators on top for which `is_due` holds.
    fn settle(&mut self, is_due: impl Fn(&Filtration<'_, S, D>, u32) -> bool) {
        while let [.., below, top] = &mut self.basins[..]
            && is_due(self.filtration, top.separator)
        {
            let saddle = top.separator;
            let is_top_younger = self.filtration.precedes(below.minimum, top.minimum);
            let (elder, younger) = if is_top_younger { (*below, *top) } else { (*top, *below) };
            (below.minimum, below.place) = (elder.minimum, elder.place);
            self.merges[younger.place as usize] =
                Merge { extremum: younger.minimum, end: saddle, towards: elder.minimum };
            self.basins.pop();
        }
    }
}
