//! A picture and what its sublevel sets leave out, scanned at once.
//!
//! Round a pixel earlier and later neighbours alternate in runs. With [`Connectivity::Full`] all eight hold earlier ones together, and the
//! four along the axes later ones; with [`Connectivity::Axis`] it is the other way round, with [`Connectivity::Freudenthal`] the same six do
//! both. A run without a neighbour of its own kind parts nothing. What is left are as many runs of earlier as of later pixels, and with
//! two or more of each the pixel is a saddle of both: which neighbours lie across is looked up by the set of earlier ones. Whatever is
//! outside of the picture is later than all, one *frame* with the number after those of the pixels.

use super::graph::Domain;
use super::grid::{Grid, mark};
use super::stencil::Connectivity;
use crate::filtration::{Direction, Filtration};
use crate::pairing::{Crossing, Descent};
use crate::parallel;
use crate::scalar::Scalar;
use core::ops::Range;
use std::sync::OnceLock;

/// Steps (y, x) round a pixel, one bit each.
const ROUND: [[i8; 2]; 8] = [[0, 1], [1, 1], [1, 0], [1, -1], [0, -1], [-1, -1], [-1, 0], [-1, 1]];

/// Along the axes.
const AXIS: u32 = 0b0101_0101;

/// Edges of the Freudenthal triangulation.
const FREUDENTHAL: u32 = 0b0111_0111;

/// The places round a pixel in the order in which it would point there: back along the row if it can, so that most ways end in one pass.
const POINTED: [u8; 8] = [4, 6, 5, 7, 0, 2, 3, 1];

/// No place.
const NOWHERE: u8 = 8;

/// What is round a pixel, by the set of earlier places.
#[derive(Debug, Clone, Copy)]
struct Around {
    /// An earlier neighbour, and a later one of what is left out; [`NOWHERE`] if there is none.
    pointers: [u8; 2],
    /// How many crossings there are.
    count: u8,
    /// For each two earlier places and the later ones between them.
    crossings: [[[u8; 2]; 2]; 3],
}

/// The table of a connectivity; made at first use.
fn table(connectivity: Connectivity) -> &'static [Around; 256] {
    static TABLES: [OnceLock<[Around; 256]>; 3] = [const { OnceLock::new() }; 3];
    TABLES[connectivity as usize].get_or_init(|| {
        let neighbors = neighbors(connectivity);
        core::array::from_fn(|set| around(set as u32, neighbors))
    })
}

/// The neighbours of a pixel, and those of what is left out.
fn neighbors(connectivity: Connectivity) -> [u32; 2] {
    match connectivity {
        Connectivity::Axis => [AXIS, 0xff],
        Connectivity::Full => [0xff, AXIS],
        Connectivity::Freudenthal => [FREUDENTHAL; 2],
    }
}

fn around(set: u32, neighbors: [u32; 2]) -> Around {
    let of_kind = [set & neighbors[0], !set & neighbors[1]];
    let pointers = of_kind.map(|places| {
        let pointed = POINTED.into_iter().find(|&place| places >> place & 1 != 0);
        pointed.unwrap_or(NOWHERE)
    });
    // Places of neighbours in turn, as earlier (0) or later (1), the first of each run; a place of no neighbour of its kind is skipped.
    let mut runs: Vec<(usize, u8)> = Vec::new();
    for place in 0..8 {
        let kind = usize::from(set >> place & 1 == 0);
        if of_kind[kind] >> place & 1 != 0 && runs.last().is_none_or(|run| run.0 != kind) {
            runs.push((kind, place));
        }
    }
    if runs.len() > 1 && runs[0].0 == runs[runs.len() - 1].0 {
        runs.pop(); // it goes on with the first
    }
    let earlier = runs.iter().position(|run| run.0 == 0).unwrap_or(0);
    runs.rotate_left(earlier);
    let side = |run: usize| runs[run].1;
    let mut crossings = [[[0; 2]; 2]; 3];
    let count = (runs.len() / 2).saturating_sub(1);
    // From the first run of earlier places a way to each other one; it crosses from the later run before that to the one after it.
    for (crossing, other) in crossings[..count].iter_mut().zip(1..) {
        *crossing = [[side(0), side(2 * other)], [side(2 * other - 1), side(2 * other + 1)]];
    }
    Around { pointers, count: count as u8, crossings }
}

/// The ways down in a picture and in what is left out, and where they cross.
pub(crate) struct Picture {
    pub(crate) descents: [Descent; 2],
    pub(crate) crossings: Vec<Crossing>,
}

impl Picture {
    /// Scans a picture with ends whose values are all numbers. Nothing crosses if the work is stopped.
    pub(crate) fn new<S: Scalar, D: Direction>(grid: &Grid<2>, filtration: &Filtration<'_, S, D>) -> Self {
        let count = grid.vertex_count();
        let width = grid.shape()[1];
        let (mut inside, mut outside) = (vec![0; count], vec![0; count + 1]);
        let nexts = [&mut inside[..], &mut outside[..count]];
        let scans = parallel::scan_blocks_of_two(nexts, width, &|vertices, [inside, outside], found: &mut Found| {
            if filtration.stops() {
                return;
            }
            let mut scanner = Scanner::new(grid, filtration, found);
            let rows = inside.chunks_mut(width).zip(outside.chunks_mut(width));
            for (y, (inside, outside)) in (vertices.start / width..).zip(rows) {
                scanner.scan_row(y, [inside, outside]);
            }
        });
        let joined = scans.into_iter().reduce(|mut all, Found { extrema, crossings }| {
            all.extrema.iter_mut().zip(extrema).for_each(|(all, extrema)| all.extend(extrema));
            all.crossings.extend(crossings);
            all
        });
        let all = joined.filter(|_| !filtration.stops()).unwrap_or_default();
        let [minima, mut maxima] = all.extrema;
        maxima.push(count as u32);
        let descents = [Descent::new(inside, minima), Descent::new(outside, maxima)];
        for descent in &descents {
            if descent.is_worth_settling_for(all.crossings.len()) {
                descent.settle(filtration.watch());
            }
        }
        Self { descents, crossings: all.crossings }
    }
}

/// What a scan of some rows finds, by rising index.
#[derive(Default)]
struct Found {
    extrema: [Vec<u32>; 2],
    crossings: Vec<Crossing>,
}

/// How many pixels of a row are scanned at a time.
const SPAN: usize = 512;

struct Scanner<'a, S, D> {
    filtration: &'a Filtration<'a, S, D>,
    shape: [usize; 2],
    /// The neighbours of either kind.
    looked_at: u32,
    table: &'static [Around; 256],
    /// How far it is to each place by index; differences wrap round. Nowhere is where one is.
    leaps: [u32; 9],
    /// For each pixel of a span the earlier places.
    sets: [u32; SPAN],
    /// Of a span the extrema and the saddles.
    noted: [[u32; SPAN]; 3],
    found: &'a mut Found,
}

impl<'a, S: Scalar, D: Direction> Scanner<'a, S, D> {
    fn new(grid: &Grid<2>, filtration: &'a Filtration<'a, S, D>, found: &'a mut Found) -> Self {
        let (shape, neighbors) = (grid.shape(), neighbors(grid.connectivity()));
        let mut leaps = [0; 9];
        for (leap, [dy, dx]) in leaps.iter_mut().zip(ROUND) {
            *leap = (dy as i32 as u32).wrapping_mul(shape[1] as u32).wrapping_add(dx as i32 as u32);
        }
        Self {
            filtration,
            shape,
            looked_at: neighbors[0] | neighbors[1],
            table: table(grid.connectivity()),
            leaps,
            sets: [0; SPAN],
            noted: [[0; SPAN]; 3],
            found,
        }
    }

    fn scan_row(&mut self, y: usize, [inside, outside]: [&mut [u32]; 2]) {
        let width = self.shape[1];
        for start in (0..width).step_by(SPAN) {
            let span = start..width.min(start + SPAN);
            self.find_earlier(y, &span);
            self.point_and_note(y, &span, [&mut inside[span.clone()], &mut outside[span.clone()]]);
        }
    }

    /// Fills in the sets of a span.
    fn find_earlier(&mut self, y: usize, span: &Range<usize>) {
        let [height, width] = self.shape;
        self.sets[..span.len()].fill(0);
        for (place, [dy, dx]) in ROUND.into_iter().enumerate() {
            let within = span.start.max(usize::from(dx < 0))..span.end.min(width - usize::from(dx > 0));
            let row = y.checked_add_signed(isize::from(dy)).filter(|&row| row < height);
            let Some(row) = row.filter(|_| self.looked_at >> place & 1 != 0 && !within.is_empty()) else { continue };
            let field = self.filtration.field();
            let from = (row * width + within.start).wrapping_add_signed(isize::from(dx));
            let others = &field[from..from + within.len()];
            let centres = &field[y * width + within.start..y * width + within.end];
            let sets = &mut self.sets[within.start - span.start..within.end - span.start];
            if dy < 0 || dy == 0 && dx < 0 {
                mark(sets, others, centres, place, D::precedes_higher_index);
            } else {
                mark(sets, others, centres, place, D::precedes_lower_index);
            }
        }
    }

    /// Points each pixel of a span to an earlier neighbour, and to a later one of what is left out; notes extrema and saddles. Without a
    /// branch, as on noise none could be foretold.
    fn point_and_note(&mut self, y: usize, span: &Range<usize>, [inside, outside]: [&mut [u32]; 2]) {
        let first = (y * self.shape[1] + span.start) as u32;
        let mut counts = [0; 3];
        let pixels = self.sets[..span.len()].iter().zip(inside.iter_mut().zip(outside.iter_mut()));
        for (v, (&set, (inside, outside))) in (first..).zip(pixels) {
            let around = &self.table[set as usize % 256];
            let [earlier, later] = around.pointers;
            *inside = v.wrapping_add(self.leaps[usize::from(earlier)]);
            *outside = v.wrapping_add(self.leaps[usize::from(later)]);
            let are_noted = [earlier == NOWHERE, later == NOWHERE, around.count > 0];
            for ((noted, count), is_noted) in self.noted.iter_mut().zip(&mut counts).zip(are_noted) {
                noted[*count] = v;
                *count += usize::from(is_noted);
            }
        }
        let [height, width] = self.shape;
        if y == 0 || y + 1 == height {
            outside.fill(self.frame());
        } else {
            let ends = [0, width - 1].into_iter().filter(|x| span.contains(x));
            ends.for_each(|x| outside[x - span.start] = self.frame());
        }
        for (extrema, (noted, count)) in self.found.extrema.iter_mut().zip(self.noted.iter().zip(counts)) {
            extrema.extend_from_slice(&noted[..count]);
        }
        for place in 0..counts[2] {
            self.note_crossings(y, self.noted[2][place], first, span);
        }
    }

    fn note_crossings(&mut self, y: usize, saddle: u32, first: u32, span: &Range<usize>) {
        let offset = (saddle - first) as usize;
        let x = span.start + offset;
        let around = &self.table[self.sets[offset] as usize % 256];
        for crossing in &around.crossings[..usize::from(around.count)] {
            let mut sides =
                crossing.map(|sides| sides.map(|place| saddle.wrapping_add(self.leaps[usize::from(place)])));
            if self.is_at_border(y, x) {
                let within = |place: u8| self.is_within(y, x, ROUND[usize::from(place)]);
                for (side, place) in sides[1].iter_mut().zip(crossing[1]) {
                    *side = if within(place) { *side } else { self.frame() };
                }
            }
            self.found.crossings.push(Crossing { saddle, sides });
        }
    }

    fn is_at_border(&self, y: usize, x: usize) -> bool {
        let [height, width] = self.shape;
        y == 0 || y + 1 == height || x == 0 || x + 1 == width
    }

    fn is_within(&self, y: usize, x: usize, [dy, dx]: [i8; 2]) -> bool {
        let [height, width] = self.shape;
        y.checked_add_signed(isize::from(dy)).is_some_and(|y| y < height)
            && x.checked_add_signed(isize::from(dx)).is_some_and(|x| x < width)
    }

    fn frame(&self) -> u32 {
        self.filtration.field().len() as u32
    }
}
