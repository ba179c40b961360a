//! Triangles of the plane in a packed tree of their bounding boxes.
//!
//! Triangles are sorted along a Hilbert curve by the middles of their boxes and taken by eights, these by eights again, and so on up to one
//! (Kamel and Faloutsos 1993, *On packing R-trees*), which does not mind triangles of very different sizes as a uniform grid does. Only boxes of
//! eight triangles and more are kept: the triangles' own are found where a query comes as far. So the tree takes 9 bytes a triangle.

use std::ops::Range;

use geom::FaceId;
use rayon::prelude::*;

use super::AT_ONCE;
use super::motion::Motion;
use super::triangle::{self, Triangle};

/// So many triangles or boxes are in a box.
const WIDTH: usize = 8;

/// Triangles are tried in steps of so many, so that an overlap anywhere is soon found.
const STRIDE: usize = 29;

/// A triangle is a needle if it covers less than half of this share of its bounding box; a half is the most.
const NEEDLE: f64 = 0.25;
/// More than what rounding does to a product with a point, in shares of the largest that may be.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The lower left and the upper right corner.
pub(super) type Bounds = [[f64; 2]; 2];

/// Triangles in a tree of their bounding boxes.
#[derive(Debug)]
pub(super) struct Boxes<'a> {
    triangles: &'a [Triangle],
    /// Those in the tree, along the curve.
    order: Vec<u32>,
    /// The boxes about each eight triangles, about each eight of these boxes, and so on.
    levels: Vec<Vec<Bounds>>,
    /// The longer side of the bounding box of all.
    pub(super) extent: f64,
}

impl<'a> Boxes<'a> {
    /// All triangles that have an area. O(n log n).
    pub(super) fn new(triangles: &'a [Triangle]) -> Self {
        let all = (0..triangles.len() as u32).into_par_iter().with_min_len(AT_ONCE);
        Self::of(triangles, all.filter(|&f| triangle::upright(triangles[f as usize]).is_some()).collect())
    }

    /// Some triangles, which all have an area.
    pub(super) fn of(triangles: &'a [Triangle], some: Vec<u32>) -> Self {
        let about = |f: u32| bounds(&triangles[f as usize]);
        let Some([low, high]) = some.par_iter().with_min_len(AT_ONCE).map(|&f| about(f)).reduce_with(joined) else {
            return Self { triangles, order: some, levels: Vec::new(), extent: 0.0 };
        };
        // The curve runs through a grid of as many bits a side as the triangles' numbers leave: with 16, of 2.9 million triangles in a hundredth
        // of the extent many are in each cell, in no order, and comparing them takes three times as long.
        let of_number = triangles.len().max(2).ilog2() + 1;
        let bits = (u64::BITS - of_number) / 2;
        let cells = f64::from((1_u32 << bits) - 1);
        let key = |f: u32| {
            let [l, h] = about(f);
            let cell = [0, 1].map(|i| (cells * (0.5 * (l[i] + h[i]) - low[i]) / (high[i] - low[i])) as u32);
            along_the_curve(cell, bits) << of_number | u64::from(f)
        };
        let mut keys: Vec<u64> = some.into_par_iter().with_min_len(AT_ONCE).map(key).collect();
        keys.par_sort_unstable();
        let order: Vec<u32> = keys.into_iter().map(|key| (key & ((1 << of_number) - 1)) as u32).collect();
        let of_eight = |eight: &[u32]| eight.iter().map(|&f| about(f)).reduce(joined).expect("a chunk is not empty");
        let mut levels: Vec<Vec<Bounds>> = vec![order.par_chunks(WIDTH).with_min_len(AT_ONCE).map(of_eight).collect()];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            let of_eight = |eight: &[Bounds]| eight.iter().copied().reduce(joined).expect("a chunk is not empty");
            levels.push(below.chunks(WIDTH).map(of_eight).collect());
        }
        Self { triangles, order, levels, extent: (high[0] - low[0]).max(high[1] - low[1]) }
    }

    /// The bounding box of all of them; none if there are none.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        Some(self.levels.last()?[0])
    }

    /// A triangle, turned counter-clockwise; none without area.
    pub(super) fn upright(&self, f: u32) -> Option<Triangle> {
        triangle::upright(self.triangles[f as usize])
    }

    /// The lower left and the upper right corner of the bounding box of those of some triangles that have an area; none if none has.
    pub(super) fn bounds_of(&self, some: impl ParallelIterator<Item = u32>) -> Option<Bounds> {
        some.filter_map(|f| self.upright(f)).map(|corners| bounds(&corners)).reduce_with(joined)
    }

    /// The area of a triangle.
    pub(super) fn area(&self, f: u32) -> f64 {
        triangle::area(self.triangles[f as usize]).unwrap_or(0.0)
    }

    /// Whether some of the triangles, where a motion takes them, lie deeper than `least` over one of those that are asked for.
    pub(super) fn overlap(
        &self,
        some: &[FaceId],
        motion: &Motion,
        is_asked: impl Fn(FaceId) -> bool,
        least: f64,
    ) -> bool {
        let overlaps = |&f: &FaceId| {
            let Some(one) = self.upright(f.0).map(|corners| motion.of_triangle(corners)) else { return false };
            let mut is_free = true;
            self.meeting(&one, |g| {
                if is_asked(FaceId(g))
                    && let Some(other) = self.upright(g)
                {
                    is_free = triangle::depth(&one, &other).is_none_or(|depth| depth <= least);
                }
                is_free
            });
            !is_free
        };
        (0..STRIDE).any(|first| some.iter().skip(first).step_by(STRIDE).any(overlaps))
    }

    /// Whether one of the triangles, where a motion takes them, lies deeper than `least` over one of others. Both trees are gone down at once.
    pub(super) fn lie_over(&self, others: &Self, motion: &Motion, least: f64) -> bool {
        let [Some(top), Some(other_top)] = [self, others].map(|boxes| boxes.levels.len().checked_sub(1)) else {
            return false;
        };
        let all = moved_bounds(self.levels[top][0], motion);
        let pair = Pair { boxes: [self, others], motion, least };
        pair.overlaps(&all, [(top, 0), (other_top, 0)])
    }

    /// Visits the triangles that may lie over one that is turned counter-clockwise: those whose bounding boxes meet its own, unless a
    /// needle's side parts them from it. In no order that means anything, as long as the visitor says to go on.
    pub(super) fn meeting(&self, triangle: &Triangle, mut visit: impl FnMut(u32) -> bool) {
        if let Some(top) = self.levels.len().checked_sub(1) {
            self.descend(top, 0, &Asked::new(triangle, self.levels[top][0]), &mut visit);
        }
    }

    /// Visits what is in one box of a level; whether to go on.
    fn descend(&self, level: usize, at: usize, asked: &Asked, visit: &mut impl FnMut(u32) -> bool) -> bool {
        if !asked.may_meet_box(&self.levels[level][at]) {
            return true;
        }
        let mut within = self.within(level, at);
        if level > 0 {
            return within.all(|below| self.descend(level - 1, below, asked, visit));
        }
        self.order[within].iter().all(|&f| !asked.may_meet(&self.triangles[f as usize]) || visit(f))
    }

    /// What is in one box of a level: boxes of the level below, or places in the order.
    fn within(&self, level: usize, at: usize) -> Range<usize> {
        let count = if level == 0 { self.order.len() } else { self.levels[level - 1].len() };
        at * WIDTH..count.min((at + 1) * WIDTH)
    }

    /// The triangles in one of the smallest boxes, turned counter-clockwise.
    fn leaf(&self, at: usize) -> impl Iterator<Item = Triangle> {
        self.order[self.within(0, at)].iter().filter_map(|&f| self.upright(f))
    }
}

/// A triangle for which others are sought.
struct Asked {
    bounds: Bounds,
    /// Of a needle, whose bounding box is met by many triangles that are far from it: for each side a vector to its right, and what the product
    /// with that is greater than on the right of the side, beyond rounding.
    right: Option<[([f64; 2], f64); 3]>,
}

impl Asked {
    /// What it is compared with is within bounds.
    fn new(triangle: &Triangle, within: Bounds) -> Self {
        let bounds = bounds(triangle);
        let [[left, lower], [right, upper]] = bounds;
        if triangle::twice_area(*triangle) > NEEDLE * (right - left) * (upper - lower) {
            return Self { bounds, right: None };
        }
        let size = joined(bounds, within).as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let right = [0, 1, 2].map(|k| {
            let ([x, y], [to_x, to_y]) = (triangle[k], triangle[(k + 1) % 3]);
            let [right, up] = [to_y - y, x - to_x];
            ([right, up], right * x + up * y + ROUNDING * (right.abs() + up.abs()) * size)
        });
        Self { bounds, right: Some(right) }
    }

    fn may_meet_box(&self, bounds: &Bounds) -> bool {
        let [low, high] = bounds;
        let nearest = |x: f64, i: usize| x * if x > 0.0 { low[i] } else { high[i] };
        let is_beyond = |([x, y], side): &([f64; 2], f64)| nearest(*x, 0) + nearest(*y, 1) > *side;
        meet(bounds, &self.bounds) && !self.right.as_ref().is_some_and(|right| right.iter().any(is_beyond))
    }

    fn may_meet(&self, triangle: &Triangle) -> bool {
        let is_beyond = |([x, y], side): &([f64; 2], f64)| triangle.iter().all(|p| x * p[0] + y * p[1] > *side);
        meet(&bounds(triangle), &self.bounds) && !self.right.as_ref().is_some_and(|right| right.iter().any(is_beyond))
    }
}

/// Two trees, of which the first is moved.
struct Pair<'a> {
    boxes: [&'a Boxes<'a>; 2],
    motion: &'a Motion,
    /// What may lie over each other.
    least: f64,
}

impl Pair<'_> {
    /// Whether triangles overlap of which one is in a box of the first tree, whose bounds where it is moved to are given, and one in a box of
    /// the other. Boxes are levels and places on them.
    fn overlaps(&self, moved: &Bounds, [(level, at), (other_level, other_at)]: [(usize, usize); 2]) -> bool {
        let [one, other] = self.boxes;
        if !meet(moved, &other.levels[other_level][other_at]) {
            return false;
        }
        if level == 0 && other_level == 0 {
            return one.leaf(at).any(|triangle| {
                let triangle = self.motion.of_triangle(triangle);
                let about = bounds(&triangle);
                let meets = |other: &Triangle| {
                    meet(&about, &bounds(other)) && triangle::depth(&triangle, other).is_some_and(|d| d > self.least)
                };
                meet(&about, &other.levels[0][other_at]) && other.leaf(other_at).any(|other| meets(&other))
            });
        }
        if level >= other_level {
            return one.within(level, at).any(|below| {
                let moved = moved_bounds(one.levels[level - 1][below], self.motion);
                self.overlaps(&moved, [(level - 1, below), (other_level, other_at)])
            });
        }
        other.within(other_level, other_at).any(|below| self.overlaps(moved, [(level, at), (other_level - 1, below)]))
    }
}

/// A bounding box that holds another one where this is moved.
pub(super) fn moved_bounds([low, high]: Bounds, motion: &Motion) -> Bounds {
    bounds(&[low, [high[0], low[1]], high, [low[0], high[1]]].map(|corner| motion.of(corner)))
}

/// The bounding box of points.
pub(super) fn bounds<const N: usize>(points: &[[f64; 2]; N]) -> Bounds {
    let extreme = |start: f64, of: fn(f64, f64) -> f64| [0, 1].map(|i| points.iter().fold(start, |x, p| of(x, p[i])));
    [extreme(f64::INFINITY, f64::min), extreme(f64::NEG_INFINITY, f64::max)]
}

pub(super) fn joined([low, high]: Bounds, [l, h]: Bounds) -> Bounds {
    [[low[0].min(l[0]), low[1].min(l[1])], [high[0].max(h[0]), high[1].max(h[1])]]
}

pub(super) fn meet([low, high]: &Bounds, [l, h]: &Bounds) -> bool {
    (0..2).all(|i| low[i] <= h[i] && l[i] <= high[i])
}

/// The place of a cell on the Hilbert curve through all of a grid of so many bits a side.
fn along_the_curve([mut x, mut y]: [u32; 2], bits: u32) -> u64 {
    let mut place = 0;
    for bit in (0..bits).rev() {
        let [right, upper] = [x >> bit & 1, y >> bit & 1];
        place = place << 2 | u64::from((3 * right) ^ upper);
        // The lower quarters are turned, so that each begins where the one before it ends.
        if upper == 0 {
            if right == 1 {
                [x, y] = [!x, !y];
            }
            [x, y] = [y, x];
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_cell_to_neighbour_through_all() {
        // The last bits of the first cells: the curve through an 8 × 8 grid.
        let mut cells: Vec<[u32; 2]> = (0..64).map(|k| [k % 8, k / 8]).collect();
        cells.sort_by_key(|&cell| along_the_curve(cell, 16));
        for step in cells.windows(2) {
            assert_eq!(step[0][0].abs_diff(step[1][0]) + step[0][1].abs_diff(step[1][1]), 1);
        }
    }

    #[test]
    fn what_lies_over_a_needle_is_visited_and_little_else() {
        let turned =
            |turn: f64, [x, y]: [f64; 2]| [0.3 + x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos()];
        let needle = |k: usize| {
            let (turn, along) = (k as f64 * 2.4, (k % 17) as f64 - 8.0);
            [[along, 0.0], [along + 3.0, 0.0], [along + 1.0, 1e-3 * (k % 5 + 1) as f64]].map(|p| turned(turn, p))
        };
        let triangles: Vec<Triangle> = (0..600).map(needle).collect();
        let boxes = Boxes::new(&triangles);
        let [mut over, mut visited, mut meeting] = [0; 3];
        for one in &triangles {
            let mut is_visited = vec![false; triangles.len()];
            boxes.meeting(one, |f| {
                is_visited[f as usize] = true;
                true
            });
            for (other, is_visited) in triangles.iter().zip(is_visited) {
                let lies_over = triangle::depth(one, other).is_some();
                assert!(is_visited || !lies_over);
                [over, visited, meeting] = [
                    over + usize::from(lies_over),
                    visited + usize::from(is_visited),
                    meeting + usize::from(meet(&bounds(one), &bounds(other))),
                ];
            }
        }
        assert!(over > 600 && 2 * (visited - over) < meeting - over, "{over} {visited} {meeting}");
    }

    #[test]
    fn what_stops_is_not_visited_further() {
        let triangles = [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]; 100];
        let mut visited = 0;
        Boxes::new(&triangles).meeting(&triangles[0], |_| {
            visited += 1;
            visited < 10
        });
        assert_eq!(visited, 10);
    }
}
