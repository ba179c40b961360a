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

    fn map_merges<S: Scalar, D: Direction, T>(
        &self,
        filtration: &Filtration<'_, S, D>,
        pair: impl Fn(&Merge, S, S) -> T,
    ) -> Vec<T> {
        let mut stack =
            Stack { filtration, pair, basins: Vec::new(), separator: 0, is_minimum: true, pairs: Vec::new() };
        let mut start = 0;
        for stretch in filtration.field().split(|value| value.is_nan()) {
            stack.pair(start as u32..(start + stretch.len()) as u32);
            start += stretch.len() + 1;
        }
        stack.pairs
    }
}

/// So many vertices are searched for extrema at a time.
const SEARCHED: usize = 1024;

/// A basin that waits, and the maximum that separates it from the one below it on the stack.
#[derive(Clone, Copy)]
struct Basin<S> {
    minimum: u32,
    /// Its place among the pairs.
    place: u32,
    birth: S,
    /// Of the basin at the bottom of the stack nothing in particular.
    separator: u32,
    level: S,
}

struct Stack<'a, S, D, P, T> {
    filtration: &'a Filtration<'a, S, D>,
    pair: P,
    basins: Vec<Basin<S>>,
    /// The last maximum.
    separator: u32,
    /// Whether the next extremum is a minimum.
    is_minimum: bool,
    /// What becomes of each basin, by rising index of its minimum.
    pairs: Vec<T>,
}

impl<S: Scalar, D: Direction, P: Fn(&Merge, S, S) -> T, T> Stack<'_, S, D, P, T> {
    /// Pairs a stretch of vertices that all enter. Extrema are found without a branch: on noise none could be foretold.
    fn pair(&mut self, stretch: Range<u32>) {
        let Some(last) = stretch.clone().last() else { return };
        let mut latest = self.filtration.later(stretch.start, last);
        let mut falls = true;
        for start in stretch.step_by(SEARCHED) {
            let end = last.min(start.saturating_add(SEARCHED as u32));
            let values = &self.filtration.field()[start as usize..=end as usize];
            let (mut turns, mut count) = ([0; SEARCHED], 0);
            for (v, (&value, &next)) in (start..).zip(values.iter().zip(&values[1..])) {
                let falls_on = D::precedes_lower_index(next, value);
                turns[count] = v;
                count += usize::from(falls_on != falls);
                falls = falls_on;
            }
            turns[..count].iter().for_each(|&v| latest = self.turn(v, latest));
        }
        if falls {
            self.turn(last, latest);
        }
        self.end(latest);
    }

    /// Minima and maxima in turn, with a minimum at both ends; the later of a vertex and this one, if it is a maximum.
    fn turn(&mut self, v: u32, latest: u32) -> u32 {
        let value = self.filtration.value(v);
        let is_minimum = self.is_minimum;
        self.is_minimum = !is_minimum;
        if is_minimum {
            let (place, separator) = (self.pairs.len() as u32, self.separator);
            let level = self.filtration.value(separator);
            self.basins.push(Basin { minimum: v, place, birth: value, separator, level });
            self.pairs.push((self.pair)(&Merge::born(v), value, value));
            return latest;
        }
        self.settle(|level| D::precedes_higher_index(level, value));
        self.separator = v;
        self.filtration.later(latest, v)
    }

    /// Merges basins across the separators on top for whose values `is_due` holds.
    fn settle(&mut self, is_due: impl Fn(S) -> bool) {
        while let [.., below, top] = &mut self.basins[..]
            && is_due(top.level)
        {
            let (saddle, level) = (top.separator, top.level);
            let is_top_younger = D::precedes_higher_index(below.birth, top.birth);
            let (elder, younger) = if is_top_younger { (*below, *top) } else { (*top, *below) };
            (below.minimum, below.place, below.birth) = (elder.minimum, elder.place, elder.birth);
            let merge = Merge { extremum: younger.minimum, end: saddle, towards: elder.minimum };
            self.pairs[younger.place as usize] = (self.pair)(&merge, younger.birth, level);
            self.basins.pop();
        }
    }

    /// Merges all basins that wait; the eldest has its end at the last vertex to enter.
    fn end(&mut self, latest: u32) {
        self.settle(|_| true);
        if let Some(Basin { minimum, place, birth, .. }) = self.basins.pop() {
            let merge = Merge { extremum: minimum, end: latest, towards: NONE };
            self.pairs[place as usize] = (self.pair)(&merge, birth, self.filtration.value(latest));
        }
        self.is_minimum = true;
    }
}
