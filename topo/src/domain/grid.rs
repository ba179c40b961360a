//! Regular grids of one to three dimensions: series, pictures, volumes.
//!
//! No edges are stored. A scan goes along the rows: for each offset of the [`Stencil`] a row is compared with the one
//! it leads to, which are vector instructions; the resulting set of earlier neighbours is looked up, and most vertices
//! are done. Rows are independent, so blocks of them can be scanned in parallel.

use super::graph::Domain;
use super::stencil::{Connectivity, Offset, Stencil};
use crate::filtration::{Direction, Filtration, Kind};
use crate::pairing::{Basins, OUTSIDE, Pointing, SaddleCandidate, Scan};
use crate::parallel;
use crate::scalar::Scalar;
use core::ops::{Range, RangeInclusive};

/// A grid of `D` = 1, 2 or 3 axes, the slowest first as in C and `NumPy`: `[rows, columns]`, `[z, y, x]`.
///
/// ```
/// use topo::{Connectivity, Grid};
///
/// let picture = [
///     3, 1, 3, //
///     2, 3, 9, //
///     3, 0, 3,
/// ];
/// let grid = Grid::new([3, 3], Connectivity::Axis);
/// let minima = topo::sublevel(&grid, &picture)?.ranked();
/// assert_eq!(grid.position(minima[0].extremum), [2, 1]); // value 0, essential
/// assert_eq!(grid.position(minima[1].extremum), [0, 1]); // value 1, joins the other …
/// assert_eq!(minima[1].death(), Some(3)); // … over a 3
/// # Ok::<(), topo::Error>(())
/// ```
///
/// Four axes do not compile:
///
/// ```compile_fail
/// topo::Grid::new([2, 2, 2, 2], topo::Connectivity::Axis);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use = "it is made anew, not changed"]
pub struct Grid<const D: usize> {
    /// Along (z, y, x); missing axes are of length 1.
    shape: [usize; 3],
    periodic: [bool; 3],
    connectivity: Connectivity,
}

impl<const D: usize> Grid<D> {
    /// A grid with ends.
    pub fn new(shape: [usize; D], connectivity: Connectivity) -> Self {
        const { assert!(D >= 1 && D <= 3, "a grid has one to three axes") };
        Self { shape: padded(shape, 1), periodic: [false; 3], connectivity }
    }

    /// The same grid where the ends of some axes are neighbours.
    pub fn periodic(self, axes: [bool; D]) -> Self {
        Self { periodic: padded(axes, false), ..self }
    }

    /// Number of vertices along each axis.
    pub fn shape(&self) -> [usize; D] {
        core::array::from_fn(|axis| self.shape[axis + 3 - D])
    }

    /// Which vertices are neighbours.
    pub fn connectivity(&self) -> Connectivity {
        self.connectivity
    }

    /// Whether the ends of any axis are neighbours.
    pub fn is_periodic(&self) -> bool {
        self.periodic.contains(&true)
    }

    /// For each axis whether its ends are neighbours.
    pub fn periodic_axes(&self) -> [bool; D] {
        core::array::from_fn(|axis| self.periodic[axis + 3 - D])
    }

    /// Where a vertex is.
    pub fn position(&self, vertex: usize) -> [usize; D] {
        let [_, ny, nx] = self.shape.map(|length| length.max(1));
        let position = [vertex / nx / ny, vertex / nx % ny, vertex % nx];
        core::array::from_fn(|axis| position[axis + 3 - D])
    }

    /// The vertex at a position, or `None` outside the grid.
    pub fn vertex_at(&self, position: [usize; D]) -> Option<usize> {
        let position = padded(position, 0);
        let inside = position.iter().zip(self.shape).all(|(&at, length)| at < length);
        inside.then(|| self.index(position))
    }

    fn index(&self, [z, y, x]: [usize; 3]) -> usize {
        (z * self.shape[1] + y) * self.shape[2] + x
    }

    /// The vertex one offset away from a position, round the ends of periodic axes.
    fn step(&self, position: [usize; 3], offset: Offset) -> Option<usize> {
        let mut to = [0; 3];
        for axis in 0..3 {
            to[axis] = step_along(position[axis], offset[axis], self.shape[axis], self.periodic[axis])?;
        }
        Some(self.index(to))
    }

    /// The offsets along each axis that lead from a vertex to the others, to each by the shorter way.
    pub(crate) fn reach(&self, vertex: usize) -> [RangeInclusive<isize>; 3] {
        let position = padded(self.position(vertex), 0);
        core::array::from_fn(|axis| {
            let (at, length) = (position[axis] as isize, self.shape[axis] as isize);
            if self.periodic[axis] { -((length - 1) / 2)..=length / 2 } else { -at..=length - 1 - at }
        })
    }

    /// The vertex one offset within [reach](Self::reach) away.
    pub(crate) fn at_offset(&self, vertex: usize, offset: [isize; 3]) -> usize {
        let position = padded(self.position(vertex), 0);
        self.index(core::array::from_fn(|axis| {
            (position[axis] as isize + offset[axis]).rem_euclid(self.shape[axis] as isize) as usize
        }))
    }

    fn stencil(&self) -> &'static Stencil {
        Stencil::of(self.connectivity, D)
    }
}

fn padded<T: Copy, const D: usize>(of: [T; D], missing: T) -> [T; 3] {
    core::array::from_fn(|axis| if axis + D >= 3 { of[axis + D - 3] } else { missing })
}

fn step_along(at: usize, step: i8, length: usize, periodic: bool) -> Option<usize> {
    match at.checked_add_signed(isize::from(step)) {
        Some(to) if to < length => Some(to),
        Some(_) => periodic.then_some(0),
        None => periodic.then_some(length - 1),
    }
}

impl<const D: usize> Domain for &Grid<D> {
    type Vertex = usize;

    fn vertex_count(&self) -> usize {
        self.shape.iter().fold(1, |count, &length| count.saturating_mul(length))
    }

    fn vertex(&self, index: usize) -> usize {
        index
    }

    fn for_each_neighbor(&self, index: usize, mut visit: impl FnMut(usize)) {
        let position = padded(self.position(index), 0);
        let stencil = self.stencil();
        let count = stencil.neighbors(u32::MAX).count_ones() as usize;
        stencil.offsets[..count].iter().filter_map(|&offset| self.step(position, offset)).for_each(&mut visit);
    }

    fn fills_loops(&self) -> bool {
        !self.is_periodic() && self.connectivity != Connectivity::Axis
    }

    fn basins<S: Scalar, F: Direction>(&self, filtration: &Filtration<'_, S, F>, pointing: Pointing) -> Basins {
        // Zeros are memory that no thread has touched yet; the scan writes every pointer.
        let mut next = vec![0; self.vertex_count()];
        let row_length = self.shape[2];
        let scans = parallel::map_blocks(&mut next, row_length, |vertices, next| {
            if filtration.stops() {
                return None;
            }
            let mut scanner = Scanner::new(self, filtration, pointing);
            let first_row = vertices.start / row_length;
            for (row, next) in (first_row..).zip(next.chunks_mut(row_length)) {
                scanner.scan_row(row, next);
            }
            Some(scanner.found)
        });
        Basins::new(next, scans, filtration)
    }
}

/// How many vertices of a row are scanned at a time, so that rows and sets stay in the first-level cache.
const SPAN: usize = 512;

/// Scans rows of a grid one after the other.
struct Scanner<'a, S, F, const D: usize> {
    grid: &'a Grid<D>,
    filtration: &'a Filtration<'a, S, F>,
    stencil: &'static Stencil,
    /// First vertex of the row that is scanned.
    here: usize,
    /// For each offset of the stencil the first vertex of the row it leads to, if there is one.
    there: Vec<Option<usize>>,
    /// For each vertex of a span the set of stencil vertices that are earlier.
    sets: [u32; SPAN],
    pointing: Pointing,
    /// Of steepest descent, for the row that is scanned: how far it is to each neighbour, and its step along the row; by rising
    /// index, with the vertex itself among them.
    leaps: Vec<(isize, i8)>,
    /// Of steepest descent, for each vertex of a span the earliest value around it.
    earliest: Vec<S>,
    found: Scan,
}

impl<'a, S: Scalar, F: Direction, const D: usize> Scanner<'a, S, F, D> {
    fn new(grid: &'a Grid<D>, filtration: &'a Filtration<'a, S, F>, pointing: Pointing) -> Self {
        let (there, leaps, earliest) = (Vec::new(), Vec::new(), Vec::new());
        let (stencil, sets, found) = (grid.stencil(), [0; SPAN], Scan::default());
        Self { grid, filtration, stencil, here: 0, there, sets, pointing, leaps, earliest, found }
    }

    fn scan_row(&mut self, row: usize, next: &mut [u32]) {
        let [_, ny, length] = self.grid.shape;
        self.here = row * length;
        self.there.clear();
        let rows = self.stencil.offsets.iter().map(|&[z, y, _]| self.grid.step([row / ny, row % ny, 0], [z, y, 0]));
        self.there.extend(rows);
        if self.pointing == Pointing::Steepest {
            self.note_leaps();
        }
        for start in (0..length).step_by(SPAN) {
            let span = start..length.min(start + SPAN);
            self.find_earlier(span.clone());
            self.point_and_collect(span.clone(), &mut next[span.clone()]);
            self.point_periodic_ends(span.clone(), next);
            if self.pointing == Pointing::Steepest {
                self.point_steepest(span, next);
            }
        }
    }

    /// Points each vertex of a span to its earliest neighbour instead: the values first, then who has them. Of those that do, the one
    /// with the lowest index is earliest if the filtration rises, or else that with the highest. NaN is nobody's.
    fn point_steepest(&mut self, span: Range<usize>, next: &mut [u32]) {
        let (field, here) = (self.filtration.field(), self.here);
        self.earliest.clear();
        self.earliest.extend_from_slice(&field[here + span.start..here + span.end]);
        self.sets[..span.len()].fill(0);
        for &leap in &self.leaps {
            let (inside, others) = self.beyond(&span, leap);
            reduce(&mut self.earliest[inside], others, F::precedes_lower_index);
        }
        for (bit, &leap) in self.leaps.iter().enumerate() {
            let (inside, others) = self.beyond(&span, leap);
            mark(&mut self.sets[inside.clone()], others, &self.earliest[inside], bit, |a, b| a == b);
        }
        let mut leaps = [0u32; 32];
        leaps.iter_mut().zip(&self.leaps).for_each(|(to, leap)| *to = leap.0 as u32);
        for ((v, next), &set) in ((here + span.start) as u32..).zip(&mut next[span.clone()]).zip(&self.sets) {
            let bit = if F::KIND == Kind::Minimum { set.trailing_zeros() } else { 31 - (set | 1).leading_zeros() };
            let leap = leaps[bit as usize % leaps.len()];
            *next = if leap == 0 || set == 0 { OUTSIDE } else { v.wrapping_add(leap) };
        }
        for x in self.periodic_ends(&span) {
            let mut earliest = (here + x) as u32;
            self.grid.for_each_neighbor(here + x, |u| earliest = self.filtration.earlier(u as u32, earliest));
            next[x] = if earliest as usize == here + x { OUTSIDE } else { earliest };
        }
    }

    /// The part of a span of the row from which a leap stays within the row that it leads to, from the start of the span; and the
    /// values there.
    fn beyond(&self, span: &Range<usize>, (leap, dx): (isize, i8)) -> (Range<usize>, &'a [S]) {
        let inner = span.start.max(usize::from(dx < 0))..span.end.min(self.grid.shape[2] - usize::from(dx > 0));
        if inner.is_empty() {
            return (0..0, &[]);
        }
        let from = (self.here + inner.start).wrapping_add_signed(leap);
        (inner.start - span.start..inner.end - span.start, &self.filtration.field()[from..from + inner.len()])
    }

    /// Notes how far it is by index to each neighbour and to the vertex itself, and the steps along the row.
    fn note_leaps(&mut self) {
        let count = self.stencil.neighbors(u32::MAX).count_ones() as usize;
        self.leaps.clear();
        self.leaps.push((0, 0));
        for (&[_, _, dx], &there) in self.stencil.offsets[..count].iter().zip(&self.there) {
            // An offset that leads back to the vertex itself, round an axis of length one, is no neighbour.
            if let Some(there) = there.filter(|&there| there != self.here || dx != 0) {
                self.leaps.push((there as isize - self.here as isize + isize::from(dx), dx));
            }
        }
        self.leaps.sort_unstable();
    }

    /// Fills in the sets of a span of the row.
    fn find_earlier(&mut self, span: Range<usize>) {
        let length = self.grid.shape[2];
        let field = self.filtration.field();
        self.sets[..span.len()].fill(0);
        for (bit, (&[_, _, dx], &there)) in self.stencil.offsets.iter().zip(&self.there).enumerate() {
            // An offset that leads back to the vertex itself, round an axis of length one, is no neighbour.
            let Some(there) = there.filter(|&there| there != self.here || dx != 0) else { continue };
            let has_lower_index = there < self.here || there == self.here && dx < 0;
            let inner = span.start.max(usize::from(dx < 0))..span.end.min(length - usize::from(dx > 0));
            if inner.is_empty() {
                continue;
            }
            let sets = &mut self.sets[inner.start - span.start..inner.end - span.start];
            let from = (there + inner.start).wrapping_add_signed(isize::from(dx));
            let (others, centres) = (&field[from..from + inner.len()], &field[self.here + inner.start..]);
            if has_lower_index {
                mark(sets, others, centres, bit, F::precedes_higher_index);
            } else {
                mark(sets, others, centres, bit, F::precedes_lower_index);
            }
        }
        self.find_earlier_round_the_ends(span);
    }

    /// Adds what lies beyond the ends of a periodic row.
    fn find_earlier_round_the_ends(&mut self, span: Range<usize>) {
        let length = self.grid.shape[2];
        for x in self.periodic_ends(&span) {
            for (bit, (&[_, _, dx], &there)) in self.stencil.offsets.iter().zip(&self.there).enumerate() {
                let beyond = if x == 0 && dx < 0 { length - 1 } else { 0 };
                let leaves = x == 0 && dx < 0 || x + 1 == length && dx > 0;
                if let Some(there) = there.filter(|_| leaves) {
                    let earlier = self.filtration.precedes((there + beyond) as u32, (self.here + x) as u32);
                    self.sets[x - span.start] |= u32::from(earlier) << bit;
                }
            }
        }
    }

    /// Points each vertex of a span to an earlier neighbour; notes extrema and candidates for saddles.
    fn point_and_collect(&mut self, span: Range<usize>, next: &mut [u32]) {
        let mut leaps = [0u32; 32];
        for (leap, (&[_, _, dx], &there)) in leaps.iter_mut().zip(self.stencil.offsets.iter().zip(&self.there)) {
            // Differences wrap round: they are added by wrapping again.
            *leap = (there.unwrap_or(0) as u32).wrapping_sub(self.here as u32).wrapping_add_signed(i32::from(dx));
        }
        let first = (self.here + span.start) as u32;
        for (v, (&set, next)) in (first..).zip(self.sets.iter().zip(next)) {
            let neighbors = self.stencil.neighbors(set);
            if neighbors == 0 {
                *next = OUTSIDE;
                if self.filtration.contains(v) {
                    self.found.extrema.push(v);
                }
                continue;
            }
            *next = v.wrapping_add(leaps[neighbors.trailing_zeros() as usize % leaps.len()]);
            if self.stencil.splits(set) {
                note_candidates(self.grid, self.stencil, &mut self.found.candidates, v, set);
            }
        }
    }

    /// Points the ends of a periodic row where they should.
    fn point_periodic_ends(&self, span: Range<usize>, next: &mut [u32]) {
        for x in self.periodic_ends(&span) {
            let neighbors = self.stencil.neighbors(self.sets[x - span.start]);
            if neighbors != 0 {
                next[x] = neighbor(self.grid, self.stencil, (self.here + x) as u32, neighbors.trailing_zeros());
            }
        }
    }

    fn periodic_ends(&self, span: &Range<usize>) -> impl Iterator<Item = usize> + use<S, F, D> {
        let (span, is_periodic) = (span.clone(), self.grid.periodic[2]);
        let last = self.grid.shape[2] - 1;
        let ends = [Some(0), (last > 0).then_some(last)];
        ends.into_iter().flatten().filter(move |x| is_periodic && span.contains(x))
    }
}

/// Sets a bit where the value of the other vertex is earlier than that of the centre.
fn mark<S: Scalar>(sets: &mut [u32], others: &[S], centres: &[S], bit: usize, is_earlier: impl Fn(S, S) -> bool) {
    for (set, (&other, &centre)) in sets.iter_mut().zip(others.iter().zip(centres)) {
        *set |= u32::from(is_earlier(other, centre)) << bit;
    }
}

/// Takes the other value where it is earlier than the earliest so far.
fn reduce<S: Scalar>(earliest: &mut [S], others: &[S], is_earlier: impl Fn(S, S) -> bool) {
    for (earliest, &other) in earliest.iter_mut().zip(others) {
        *earliest = if is_earlier(other, *earliest) { other } else { *earliest };
    }
}

/// Notes one neighbour of each part of a set against one of the first part.
#[cold]
fn note_candidates<const D: usize>(
    grid: &Grid<D>,
    stencil: &Stencil,
    candidates: &mut Vec<SaddleCandidate>,
    saddle: u32,
    set: u32,
) {
    let mut rest = stencil.neighbors(set);
    let first = rest.trailing_zeros();
    rest &= !stencil.component(set, first);
    while rest != 0 {
        let other = rest.trailing_zeros();
        let sides = [first, other].map(|bit| neighbor(grid, stencil, saddle, bit));
        candidates.push(SaddleCandidate { saddle, sides });
        rest &= !stencil.component(set, other);
    }
}

/// The neighbour of a vertex that a bit of the stencil stands for.
fn neighbor<const D: usize>(grid: &Grid<D>, stencil: &Stencil, vertex: u32, bit: u32) -> u32 {
    let position = padded(grid.position(vertex as usize), 0);
    let neighbor = grid.step(position, stencil.offsets[bit as usize]);
    neighbor.expect("bits are set for vertices inside the grid only") as u32
}
