//! Regular grids of one to three dimensions: series, pictures, volumes.
//!
//! No edges are stored. A scan goes along the rows: for each offset of the [`Stencil`] a row is compared with the one
//! it leads to, which are vector instructions; the resulting set of earlier neighbours is looked up, and most vertices
//! are done. Rows are independent, so blocks of them can be scanned in parallel.

use super::graph::Domain;
use super::stencil::{Connectivity, Offset, Stencil};
use crate::filtration::{Direction, Filtration};
use crate::pairing::{Basins, OUTSIDE, Pointing, SaddleCandidate, Scan, note_sides};
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
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn position(&self, vertex: usize) -> [usize; D] {
        let vertices: usize = self.shape.iter().product();
        assert!(vertex < vertices, "there is no vertex {vertex}: the grid has {vertices}, counted from 0");
        let position = self.place(vertex);
        core::array::from_fn(|axis| position[axis + 3 - D])
    }

    /// Where a vertex that there is is, by z, y and x.
    fn place(&self, vertex: usize) -> [usize; 3] {
        let [_, ny, nx] = self.shape;
        [vertex / nx / ny, vertex / nx % ny, vertex % nx]
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
        let position = self.place(vertex);
        core::array::from_fn(|axis| {
            let (at, length) = (position[axis] as isize, self.shape[axis] as isize);
            if self.periodic[axis] { -((length - 1) / 2)..=length / 2 } else { -at..=length - 1 - at }
        })
    }

    /// The vertex one offset within [reach](Self::reach) away.
    pub(crate) fn at_offset(&self, vertex: usize, offset: [isize; 3]) -> usize {
        let position = self.place(vertex);
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
        let position = self.place(index);
        let stencil = self.stencil();
        let count = stencil.neighbors(u32::MAX).count_ones() as usize;
        let offsets = &stencil.offsets[..count];
        if (3 - D..3).all(|axis| position[axis] > 0 && position[axis] + 1 < self.shape[axis]) {
            let [_, ny, nx] = self.shape.map(|length| length as isize);
            let leaps = offsets.iter().map(|offset| offset.map(isize::from)).map(|[z, y, x]| (z * ny + y) * nx + x);
            leaps.for_each(|leap| visit(index.wrapping_add_signed(leap)));
        } else {
            offsets.iter().filter_map(|&offset| self.step(position, offset)).for_each(&mut visit);
        }
    }

    fn fills_loops(&self) -> bool {
        !self.is_periodic() && self.connectivity != Connectivity::Axis
    }

    fn basins<S: Scalar, F: Direction>(&self, filtration: &Filtration<'_, S, F>, pointing: Pointing) -> Basins {
        // Zeros are memory that no thread has touched yet; the scan writes every pointer.
        let mut next = vec![0; self.vertex_count()];
        let row_length = self.shape[2];
        let scans = parallel::scan_blocks(&mut next, row_length, &|vertices, next, found: &mut Scan| {
            if filtration.stops() {
                return;
            }
            let mut scanner = Scanner::new(self, filtration, pointing, found);
            let first_row = vertices.start / row_length;
            for (row, next) in (first_row..).zip(next.chunks_mut(row_length)) {
                scanner.scan_row(row, next);
            }
        });
        Basins::new(next, scans, pointing, filtration.watch())
    }
}

/// How many vertices of a row are scanned at a time, so that rows and sets stay in the first-level cache.
const SPAN: usize = 512;

/// Earlier neighbours fall into fewer parts: no more than there are neighbours, or corners of a cube, where all 26 are neighbours.
const MAX_PARTS: usize = 16;

/// Scans rows of a grid one after the other.
struct Scanner<'a, S, F, const D: usize> {
    grid: &'a Grid<D>,
    filtration: &'a Filtration<'a, S, F>,
    stencil: &'static Stencil,
    /// First vertex of the row that is scanned.
    here: usize,
    /// For each offset of the stencil the first vertex of the row it leads to, if there is one.
    there: Vec<Option<usize>>,
    /// The vertices around one of the row: first those with lower indices, from the nearest by index outwards, then those with
    /// higher ones. So each is before or behind all that were looked at.
    looks: Vec<Look>,
    /// For each offset how far it is by index; differences wrap round, and are added by wrapping again.
    leaps: [u32; 32],
    /// For each vertex of a span the set of stencil vertices that are earlier.
    sets: [u32; SPAN],
    pointing: Pointing,
    /// Of steepest descent, for each vertex of a span the earliest value around it so far.
    earliest: Vec<S>,
    found: &'a mut Scan,
}

/// A stencil vertex as seen from all vertices of a row.
#[derive(Clone, Copy)]
struct Look {
    bit: usize,
    /// How far it is by index; never 0.
    leap: isize,
    /// The step along the row.
    dx: i8,
}

impl<'a, S: Scalar, F: Direction, const D: usize> Scanner<'a, S, F, D> {
    fn new(grid: &'a Grid<D>, filtration: &'a Filtration<'a, S, F>, pointing: Pointing, found: &'a mut Scan) -> Self {
        let (there, looks, earliest) = (Vec::new(), Vec::new(), Vec::new());
        let (stencil, leaps, sets) = (grid.stencil(), [0; 32], [0; SPAN]);
        Self { grid, filtration, stencil, here: 0, there, looks, leaps, sets, pointing, earliest, found }
    }

    fn scan_row(&mut self, row: usize, next: &mut [u32]) {
        let [_, ny, length] = self.grid.shape;
        self.here = row * length;
        self.there.clear();
        let rows = self.stencil.offsets.iter().map(|&[z, y, _]| self.grid.step([row / ny, row % ny, 0], [z, y, 0]));
        self.there.extend(rows);
        self.note_looks();
        for start in (0..length).step_by(SPAN) {
            let span = start..length.min(start + SPAN);
            match self.pointing {
                Pointing::Any => self.find_earlier(&span),
                Pointing::Steepest | Pointing::Labels => self.find_earliest(&span, &mut next[span.clone()]),
            }
            self.find_earlier_round_the_ends(&span);
            self.point_and_collect(span.clone(), &mut next[span.clone()]);
            self.point_periodic_ends(&span, next);
        }
    }

    /// Notes what is around the vertices of the row.
    fn note_looks(&mut self) {
        self.looks.clear();
        for (bit, (&[_, _, dx], &there)) in self.stencil.offsets.iter().zip(&self.there).enumerate() {
            let leap = there.map_or(0, |there| there as isize - self.here as isize + isize::from(dx));
            self.leaps[bit] = leap as u32;
            // An offset that leads back to the vertex itself, round an axis of length one, is no neighbour.
            if there.is_some_and(|there| there != self.here || dx != 0) {
                self.looks.push(Look { bit, leap, dx });
            }
        }
        nearest_first(&mut self.looks);
    }

    /// Fills in the sets of a span of the row.
    fn find_earlier(&mut self, span: &Range<usize>) {
        self.sets[..span.len()].fill(0);
        for &look in &self.looks {
            let Some((inside, others, centres)) = self.beyond(span, look) else { continue };
            let sets = &mut self.sets[inside];
            if look.leap < 0 {
                mark(sets, others, centres, look.bit, F::precedes_higher_index);
            } else {
                mark(sets, others, centres, look.bit, F::precedes_lower_index);
            }
        }
    }

    /// Finds how far it is from each vertex of a span to the earliest around it. NaN is nobody's earliest, and has none.
    fn find_earliest(&mut self, span: &Range<usize>, farthest: &mut [u32]) {
        let neighbors = self.stencil.neighbors(u32::MAX);
        let own = self.here + span.start..self.here + span.end;
        self.sets[..span.len()].fill(0);
        farthest.fill(0);
        self.earliest.clear();
        self.earliest.extend_from_slice(&self.filtration.field()[own]);
        for &look in &self.looks {
            let Some((inside, others, centres)) = self.beyond(span, look) else { continue };
            let sets = &mut self.sets[inside.clone()];
            let so_far = (&mut self.earliest[inside.clone()], &mut farthest[inside]);
            match (neighbors >> look.bit & 1 != 0, look.leap < 0) {
                (true, true) => mark_and_reduce::<S, F>(sets, so_far, others, centres, look, F::precedes_higher_index),
                (true, false) => mark_and_reduce::<S, F>(sets, so_far, others, centres, look, F::precedes_lower_index),
                (false, true) => mark(sets, others, centres, look.bit, F::precedes_higher_index),
                (false, false) => mark(sets, others, centres, look.bit, F::precedes_lower_index),
            }
        }
    }

    /// The part of a span of the row from which a look stays within the row that it leads to, from the start of the span; the values
    /// there, and those of the part itself.
    fn beyond(&self, span: &Range<usize>, look: Look) -> Option<(Range<usize>, &'a [S], &'a [S])> {
        let inner =
            span.start.max(usize::from(look.dx < 0))..span.end.min(self.grid.shape[2] - usize::from(look.dx > 0));
        if inner.is_empty() {
            return None;
        }
        let field = self.filtration.field();
        let own = self.here + inner.start..self.here + inner.end;
        let from = own.start.wrapping_add_signed(look.leap);
        Some((inner.start - span.start..inner.end - span.start, &field[from..from + inner.len()], &field[own]))
    }

    /// Adds what lies beyond the ends of a periodic row.
    fn find_earlier_round_the_ends(&mut self, span: &Range<usize>) {
        let length = self.grid.shape[2];
        for x in self.periodic_ends(span) {
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
        let first = (self.here + span.start) as u32;
        let is_steepest = self.pointing.is_steepest();
        for (v, (&set, next)) in (first..).zip(self.sets.iter().zip(next)) {
            let neighbors = self.stencil.neighbors(set);
            if neighbors == 0 {
                *next = OUTSIDE;
                if self.filtration.contains(v) {
                    self.found.extrema.push(v);
                }
                continue;
            }
            let leap = if is_steepest { *next } else { self.leaps[neighbors.trailing_zeros() as usize % 32] };
            *next = v.wrapping_add(leap);
            if self.stencil.splits(set) {
                let x = v as usize - self.here;
                let is_end = self.grid.periodic[2] && (x == 0 || x + 1 == self.grid.shape[2]);
                let leaps = (!is_end).then_some(&self.leaps);
                let around = Around { grid: self.grid, stencil: self.stencil, leaps, vertex: v, set };
                if is_steepest {
                    around.note_earliest(self.filtration, &mut self.found.candidates);
                } else {
                    around.note_candidates(&mut self.found.candidates);
                }
            }
        }
    }

    /// Points the ends of a periodic row where they should.
    fn point_periodic_ends(&self, span: &Range<usize>, next: &mut [u32]) {
        for x in self.periodic_ends(span) {
            let v = (self.here + x) as u32;
            let neighbors = self.stencil.neighbors(self.sets[x - span.start]);
            if neighbors == 0 {
                continue;
            }
            next[x] = neighbor(self.grid, self.stencil, v, neighbors.trailing_zeros());
            if self.pointing.is_steepest() {
                self.grid.for_each_neighbor(v as usize, |u| next[x] = self.filtration.earlier(u as u32, next[x]));
            }
        }
    }

    /// The ends of the row, if it is periodic, that lie in a span.
    fn periodic_ends(&self, span: &Range<usize>) -> impl Iterator<Item = usize> + use<S, F, D> {
        ends_within(span, self.grid.shape[2], self.grid.periodic[2])
    }
}

/// Puts looks in the order that [`Scanner::looks`] has.
fn nearest_first(looks: &mut [Look]) {
    looks.sort_unstable_by_key(|look| (look.leap > 0, look.leap.abs()));
}

/// The ends of a row, if it is periodic, that lie in a span.
fn ends_within(span: &Range<usize>, length: usize, is_periodic: bool) -> impl Iterator<Item = usize> + use<> {
    let (span, last) = (span.clone(), length - 1);
    let ends = [Some(0), (last > 0).then_some(last)];
    ends.into_iter().flatten().filter(move |x| is_periodic && span.contains(x))
}

/// Sets a bit where the value of the other vertex is earlier than that of the centre.
pub(super) fn mark<S: Scalar>(
    sets: &mut [u32],
    others: &[S],
    centres: &[S],
    bit: usize,
    is_earlier: impl Fn(S, S) -> bool,
) {
    for (set, (&other, &centre)) in sets.iter_mut().zip(others.iter().zip(centres)) {
        *set |= u32::from(is_earlier(other, centre)) << bit;
    }
}

/// The same for a neighbour, which becomes the earliest so far where it is earlier than that: its value, and how far it is.
fn mark_and_reduce<S: Scalar, F: Direction>(
    sets: &mut [u32],
    (earliest, farthest): (&mut [S], &mut [u32]),
    others: &[S],
    centres: &[S],
    look: Look,
    is_earlier: impl Fn(S, S) -> bool,
) {
    let leap = look.leap as u32;
    let so_far = earliest.iter_mut().zip(farthest);
    for ((set, (earliest, farthest)), (&other, &centre)) in sets.iter_mut().zip(so_far).zip(others.iter().zip(centres))
    {
        *set |= u32::from(is_earlier(other, centre)) << look.bit;
        let is_earliest = is_earlier(other, *earliest);
        *earliest = F::first(other, *earliest);
        // As bits, which compiles to vector instructions where a choice does not.
        *farthest ^= (*farthest ^ leap) & u32::from(is_earliest).wrapping_neg();
    }
}

/// A vertex with the set of what is earlier around it.
struct Around<'a, const D: usize> {
    grid: &'a Grid<D>,
    stencil: &'a Stencil,
    /// How far neighbours are by index, if all are within the rows.
    leaps: Option<&'a [u32; 32]>,
    vertex: u32,
    set: u32,
}

impl<const D: usize> Around<'_, D> {
    #[inline]
    fn neighbor(&self, bit: u32) -> u32 {
        match self.leaps {
            Some(leaps) => self.vertex.wrapping_add(leaps[bit as usize % 32]),
            None => neighbor(self.grid, self.stencil, self.vertex, bit),
        }
    }

    /// Notes one neighbour of each part of the set against one of the first part.
    #[inline]
    fn note_candidates(&self, candidates: &mut Vec<SaddleCandidate>) {
        let parts = self.stencil.parts(self.set);
        let first = self.neighbor(parts.trailing_zeros());
        let mut others = parts & (parts - 1);
        while others != 0 {
            let sides = [first, self.neighbor(others.trailing_zeros())];
            candidates.push(SaddleCandidate { saddle: self.vertex, sides });
            others &= others - 1;
        }
    }

    /// Notes the earliest neighbour in each part of the set.
    #[inline]
    fn note_earliest<S: Scalar, F: Direction>(
        &self,
        filtration: &Filtration<'_, S, F>,
        candidates: &mut Vec<SaddleCandidate>,
    ) {
        let (mut rest, mut sides, mut count) = (self.set, [0; MAX_PARTS], 0);
        while self.stencil.neighbors(rest) != 0 {
            let mut part = self.stencil.first_part(rest);
            rest &= !part;
            let mut earliest = self.neighbor(part.trailing_zeros());
            part &= part - 1;
            while part != 0 {
                earliest = filtration.earlier(self.neighbor(part.trailing_zeros()), earliest);
                part &= part - 1;
            }
            sides[count] = earliest;
            count += 1;
        }
        note_sides(filtration, self.vertex, &mut sides[..count], candidates);
    }
}

/// The neighbour of a vertex that a bit of the stencil stands for.
fn neighbor<const D: usize>(grid: &Grid<D>, stencil: &Stencil, vertex: u32, bit: u32) -> u32 {
    let position = padded(grid.position(vertex as usize), 0);
    let neighbor = grid.step(position, stencil.offsets[bit as usize]);
    neighbor.expect("bits are set for vertices inside the grid only") as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "there is no vertex 6: the grid has 6, counted from 0")]
    fn no_position_is_beyond_the_grid() {
        let grid = Grid::new([2, 3], Connectivity::Axis);
        assert_eq!(grid.position(5), [1, 2]);
        grid.position(6);
    }
}
