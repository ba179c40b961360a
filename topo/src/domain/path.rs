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

    fn looks_once(&self) -> bool {
        true
    }

    fn map_merges<S: Scalar, D: Direction, T>(
        &self,
        filtration: &Filtration<'_, S, D>,
        pair: impl Fn(&Merge, S, S) -> T,
    ) -> Vec<T> {
        let mut stack = Stack {
            filtration,
            pair,
            basins: Vec::new(),
            is_minimum: true,
            separator: 0,
            level: None,
            is_unpaired: false,
            pairs: Vec::new(),
        };
        let field = filtration.field();
        if filtration.is_masked() {
            let mut start = 0;
            for stretch in field.split(|value| value.is_nan()) {
                stack.pair(start as u32..(start + stretch.len()) as u32);
                start += stretch.len() + 1;
            }
        } else {
            stack.pair(0..field.len() as u32);
        }
        if stack.is_unpaired { Vec::new() } else { stack.pairs }
    }
}

/// So many vertices are searched for extrema at a time.
const SEARCHED: usize = 1024;

/// One time in so many the watch is asked.
const ASKED: u32 = 64;

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
    /// Whether the next extremum is a minimum.
    is_minimum: bool,
    /// The last maximum of the stretch, and its value.
    separator: u32,
    level: Option<S>,
    /// Whether a value has turned out to be no number.
    is_unpaired: bool,
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
            if (start / SEARCHED as u32).is_multiple_of(ASKED) && self.filtration.stops() {
                break;
            }
            let end = last.min(start.saturating_add(SEARCHED as u32));
            let values = &self.filtration.field()[start as usize..=end as usize];
            if values.iter().fold(false, |found, value| found | value.is_nan()) {
                self.is_unpaired = true;
                break;
            }
            let (mut turns, mut count) = ([0; SEARCHED], 0);
            for (v, (&value, &next)) in (start..).zip(values.iter().zip(&values[1..])) {
                let falls_on = D::precedes_lower_index(next, value);
                turns[count] = v;
                count += usize::from(falls_on != falls);
                falls = falls_on;
            }
            latest = self.turn(&turns[..count], latest);
        }
        if falls {
            latest = self.turn(&[last], latest);
        }
        self.end(latest);
    }

    /// Minima and maxima in turn, with a minimum at both ends of a stretch; the latest of a vertex and these maxima.
    fn turn(&mut self, mut turns: &[u32], mut latest: u32) -> u32 {
        if !self.is_minimum
            && let [first, others @ ..] = turns
        {
            latest = self.maximum(*first, latest);
            (self.is_minimum, turns) = (true, others);
        }
        let (couples, rest) = turns.as_chunks::<2>();
        for &[minimum, maximum] in couples {
            self.minimum(minimum);
            latest = self.maximum(maximum, latest);
        }
        for &minimum in rest {
            self.minimum(minimum);
            self.is_minimum = false;
        }
        latest
    }

    fn minimum(&mut self, v: u32) {
        let value = self.filtration.value(v);
        let (place, level) = (self.pairs.len() as u32, self.level.unwrap_or(value));
        self.basins.push(Basin { minimum: v, place, birth: value, separator: self.separator, level });
        self.pairs.push((self.pair)(&Merge::born(v), value, value));
    }

    /// Merges what lies below a maximum; the latest of it and a vertex.
    fn maximum(&mut self, v: u32, latest: u32) -> u32 {
        let value = self.filtration.value(v);
        self.settle(|level| D::precedes_higher_index(level, value));
        (self.separator, self.level) = (v, Some(value));
        self.filtration.later(latest, v)
    }

    /// Merges basins across the separators on top for whose values `is_due` holds.
    fn settle(&mut self, is_due: impl Fn(S) -> bool) {
        let Some(mut top) = self.basins.pop() else { return };
        while let Some(&below) = self.basins.last()
            && is_due(top.level)
        {
            self.basins.pop();
            let is_top_younger = D::precedes_higher_index(below.birth, top.birth);
            let (elder, younger) = if is_top_younger { (below, top) } else { (top, below) };
            let merge = Merge { extremum: younger.minimum, end: top.separator, towards: elder.minimum };
            self.pairs[younger.place as usize] = (self.pair)(&merge, younger.birth, top.level);
            top = Basin { separator: below.separator, level: below.level, ..elder };
        }
        self.basins.push(top);
    }

    /// Merges all basins that wait; the eldest has its end at the last vertex to enter.
    fn end(&mut self, latest: u32) {
        self.settle(|_| true);
        if let Some(Basin { minimum, place, birth, .. }) = self.basins.pop() {
            let merge = Merge { extremum: minimum, end: latest, towards: NONE };
            self.pairs[place as usize] = (self.pair)(&merge, birth, self.filtration.value(latest));
        }
        (self.is_minimum, self.level) = (true, None);
    }
}
