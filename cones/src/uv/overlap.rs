//! Where a map to the plane lies over itself: the pairs of triangles whose interiors meet.
//!
//! Whether two triangles meet is decided exactly ([`triangle`](super::triangle)). Triangles that only touch do not overlap, those
//! that have no area overlap nothing, and mirrored ones are turned first. Corners that are one point must have the same bits in all
//! their triangles; where they do not, triangles that should touch overlap by a rounding error, which is why pairs have a
//! depth: beyond [`NEGLIGIBLE_DEPTH`] it is no rounding.
//!
//! Most maps have no overlap, and that is soon seen: where triangles cover a region more than once, the winding number of their
//! uncancelled sides ([`sides`](super::sides)) is 2 or more, and it falls across some of these, whose triangles lie there and are not alone. So
//! triangles with such a side are compared with all first. Only if one of them overlaps anything all are compared with all. Candidates
//! come from a tree of the bounding boxes ([`boxes`](super::boxes)). O(n log n + candidates).

use std::borrow::Cow;

use geom::{Interrupted, Watch, distortion};
use rayon::prelude::*;

use super::boxes::Boxes;
use super::sides::{Turned, open_sides};
use super::triangle::{self, Triangle};

/// An overlap that is not deeper than this share of the map's extent is a seam that touches: rounding leaves up to 1e-12,
/// real overlaps are deeper than 1e-7.
pub const NEGLIGIBLE_DEPTH: f64 = 1e-9;
/// Points of the grid along the longer side of a map on which it is measured how much of it is covered more than once.
const GRID: usize = 2048;
/// So many pairs are kept for each triangle, and [`FREE_PAIRS`] besides. The layouts of surfaces have less than two; a map that
/// is folded to a ball has n² of them.
const MOST_PAIRS: usize = 16;
/// So many pairs are kept in any case.
pub(super) const FREE_PAIRS: usize = 1 << 20;
/// So many pairs are kept of one triangle with later ones.
const MOST_OF_ONE: usize = 1 << 12;
/// So many triangles are looked up in the tree between two looks at the watch.
const BLOCK: usize = 1 << 10;
/// Coordinates of this size are computed with as they are.
const NEAR_UNIT: std::ops::Range<f64> = 1e-6..1e6;

/// Two triangles that lie over each other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Overlap {
    /// The triangles, the lower number first.
    pub triangles: [u32; 2],
    /// How far they reach into each other, over the map's extent: at least so far one must be moved to leave the other.
    pub depth: f64,
    /// The area that they have in common, in the map's units and up to rounding.
    pub area: f64,
}

/// All pairs of triangles that lie over each other.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Overlaps {
    /// The pairs in order.
    pub pairs: Vec<Overlap>,
    /// The longer side of the map's bounding box.
    pub extent: f64,
    /// Whether these are all. There are at most n² of them; more than some 16 n are not kept.
    pub is_complete: bool,
}

impl Overlaps {
    /// The greatest depth, over the map's extent; 0 without overlap.
    pub fn depth(&self) -> f64 {
        self.pairs.iter().fold(0.0, |most, pair| pair.depth.max(most))
    }

    /// The share of the covered area of the map, whose pairs these are, that is covered more than once, on a grid of 2048 points along its longer side; 0 without
    /// pairs.
    pub fn share(&self, uv: &[Triangle]) -> f64 {
        // What the grid finds where no pair is, is rounding.
        if self.pairs.is_empty() { 0.0 } else { distortion::overlap(uv, GRID) }
    }

    /// The triangles that lie over or under another, in order.
    pub fn triangles(&self) -> Vec<u32> {
        let mut triangles: Vec<u32> = self.pairs.iter().flat_map(|pair| pair.triangles).collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }
}

/// The pairs of triangles of a map that overlap deeper than [`NEGLIGIBLE_DEPTH`]. Triangles with coordinates that are not finite lie over nothing.
///
/// ```
/// let lower = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
/// let upper = [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// assert!(cones::uv::overlaps(&[lower, upper]).pairs.is_empty());
/// let moved = upper.map(|[u, v]| [u + 0.1, v]);
/// assert_eq!(cones::uv::overlaps(&[lower, moved]).triangles(), [0, 1]);
/// ```
pub fn overlaps(uv: &[Triangle]) -> Overlaps {
    // Only a watch interrupts.
    overlaps_watched(uv, NEGLIGIBLE_DEPTH, |_| true, Watch::NONE).unwrap_or_default()
}

/// The pairs that overlap deeper than a share of the map's extent, of those that are `asked` for; watched. With a depth of 0
/// the answer is exact.
///
/// # Errors
/// If it is stopped.
pub fn overlaps_watched(
    uv: &[Triangle],
    deeper_than: f64,
    asked: impl Fn([u32; 2]) -> bool + Sync,
    watch: Watch,
) -> Result<Overlaps, Interrupted> {
    let (uv, size) = of_unit_size(uv);
    watch.ask(0.05)?;
    if let Some(extent) = extent_without_overlap(&uv, watch.within(0.05, 0.3))? {
        return Ok(Overlaps { pairs: Vec::new(), extent: extent * size, is_complete: true });
    }
    let tree = Boxes::new(&uv);
    watch.ask(0.4)?;
    let most = FREE_PAIRS + MOST_PAIRS * uv.len();
    let (mut pairs, mut is_complete) = (Vec::new(), true);
    let extent = tree.extent;
    let of_triangle = |f: u32| {
        let mut found = Vec::new();
        if let Some(one) = tree.upright(f) {
            tree.meeting(&one, |g| {
                if g > f
                    && let Some(other) = tree.upright(g).filter(|_| asked([f, g]))
                {
                    let depth = triangle::depth(&one, &other).filter(|depth| *depth > deeper_than * extent);
                    found.extend(depth.map(|depth| Overlap {
                        triangles: [f, g],
                        depth: depth / extent,
                        area: triangle::common_area(&one, &other) * size * size,
                    }));
                }
                found.len() <= MOST_OF_ONE
            });
            found.sort_unstable_by_key(|pair| pair.triangles);
        }
        found
    };
    let all: Vec<u32> = (0..uv.len() as u32).collect();
    for (count, block) in all.chunks(BLOCK).enumerate() {
        watch.ask(0.4 + 0.6 * (count * BLOCK) as f64 / uv.len() as f64)?;
        let found: Vec<Vec<Overlap>> = block.par_iter().map(|&f| of_triangle(f)).collect();
        is_complete &= found.iter().all(|of_one| of_one.len() <= MOST_OF_ONE);
        pairs.extend(found.into_iter().flatten());
        if pairs.len() > most {
            is_complete = false;
            break;
        }
    }
    Ok(Overlaps { pairs, extent: extent * size, is_complete })
}

/// The longer side of the map's bounding box, if no triangle overlaps another; see the module's head.
fn extent_without_overlap(uv: &[Triangle], watch: Watch) -> Result<Option<f64>, Interrupted> {
    let turned = |f: u32| {
        let corners = uv[f as usize];
        let is_clockwise = triangle::upright(corners)? != corners;
        Some(Turned { island: 0, is_clockwise })
    };
    let mut outer: Vec<u32> = open_sides(uv, turned, watch)?.into_iter().map(|side| side / 3).collect();
    outer.dedup();
    watch.ask(0.6)?;
    if 2 * outer.len() > uv.len() {
        return Ok(None); // as soon found the other way
    }
    let tree = Boxes::of(uv, outer);
    let is_free = |f: u32| {
        let mut is_free = true;
        if let Some(one) = tree.upright(f) {
            tree.meeting(&one, |g| {
                is_free = f == g || tree.upright(g).is_none_or(|other| triangle::depth(&one, &other).is_none());
                is_free
            });
        }
        is_free
    };
    let of_block = |block: usize| {
        watch.ask(f64::NAN)?;
        Ok((block * BLOCK..uv.len().min((block + 1) * BLOCK)).all(|f| is_free(f as u32)))
    };
    let blocks = (0..uv.len().div_ceil(BLOCK)).into_par_iter();
    match blocks.map(of_block).find_any(|is_free| *is_free != Ok(true)) {
        Some(Err(interrupted)) => Err(interrupted),
        Some(Ok(_)) => Ok(None),
        None => Ok(Some(tree.extent)),
    }
}

/// The map, if it is far from an extent near 1 scaled to one by a power of two, and so without rounding, lest products overflow or
/// vanish; and what it was divided by.
fn of_unit_size(uv: &[Triangle]) -> (Cow<'_, [Triangle]>, f64) {
    let finite = uv.iter().flatten().flatten().filter(|x| x.is_finite());
    let largest = finite.fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest == 0.0 || NEAR_UNIT.contains(&largest) {
        return (Cow::Borrowed(uv), 1.0);
    }
    let size = largest.log2().floor().clamp(-1000.0, 1000.0).exp2();
    (uv.iter().map(|corners| corners.map(|p| p.map(|x| x / size))).collect(), size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn slow(uv: &[Triangle]) -> Vec<[u32; 2]> {
        let upright: Vec<_> = uv.iter().map(|&t| triangle::upright(t)).collect();
        let mut found = Vec::new();
        for (f, one) in (0..).zip(&upright) {
            for (g, other) in (0..).zip(&upright).take(f as usize) {
                if let (Some(one), Some(other)) = (one, other)
                    && triangle::depth(one, other).is_some()
                {
                    found.push([g, f]);
                }
            }
        }
        found.sort_unstable();
        found
    }

    fn pairs(uv: &[Triangle]) -> Vec<[u32; 2]> {
        let found = overlaps_watched(uv, 0.0, |_| true, Watch::NONE).unwrap();
        found.pairs.iter().map(|pair| pair.triangles).collect()
    }

    proptest! {
        #[test]
        fn the_tree_loses_no_pair(
            coarse in prop::collection::vec(prop::array::uniform3(prop::array::uniform2(0..12i32)), 1..40),
            tiny in prop::collection::vec(prop::array::uniform3(prop::array::uniform2(0..9i32)), 0..40),
            exponent in -300..300i32,
        ) {
            // Large triangles with corners on the same lattice points, beside clusters of tiny ones.
            let scale = f64::from(exponent).exp2();
            let large = coarse.iter().map(|t| t.map(|p| p.map(|x| f64::from(x) * scale)));
            let small = tiny.iter().map(|t| t.map(|p| p.map(|x| (5.0 + f64::from(x) * 1e-3) * scale)));
            let uv: Vec<Triangle> = large.chain(small).collect();
            prop_assert_eq!(pairs(&uv), slow(&uv));
        }
    }

    /// A square grid of n × n squares of two triangles each.
    fn grid(n: usize) -> Vec<Triangle> {
        let square = |i: usize, j: usize| {
            let at = |di: usize, dj: usize| [(i + di) as f64 / n as f64, (j + dj) as f64 / n as f64];
            [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]]
        };
        (0..n * n).flat_map(|k| square(k % n, k / n)).collect()
    }

    #[test]
    fn tiles_that_touch_do_not_overlap_and_a_doubled_sheet_does_everywhere() {
        let sheet = grid(30);
        assert!(pairs(&sheet).is_empty());
        let mirrored = sheet.iter().map(|&[a, b, c]| [a, c, b]);
        let doubled: Vec<Triangle> = sheet.iter().copied().chain(mirrored).collect();
        let found = overlaps(&doubled);
        assert_eq!(found.triangles().len(), doubled.len());
        assert_eq!(found.pairs.len(), sheet.len());
        let area: f64 = found.pairs.iter().map(|pair| pair.area).sum();
        assert!((area - 1.0).abs() < 1e-12);
        assert!((found.extent - 1.0).abs() < 1e-12 && found.is_complete);
    }

    #[test]
    fn whether_sheets_lie_over_each_other_their_open_sides_tell() {
        let sheet = grid(9);
        let mut free = 0;
        for k in 0..60 {
            // Beside, across, within a hole, and wholly inside of the other; every other one is turned over.
            let (turn, size) = (0.1 * f64::from(k), [1.0, 0.4, 0.05][k as usize % 3]);
            let shift = [1.1 * f64::from(k % 7) - 1.5, 0.2 * f64::from(k % 5)];
            let moved = |[x, y]: [f64; 2]| {
                let [x, y] = [size * x, if k % 2 == 0 { size * y } else { -size * y }];
                [x * turn.cos() - y * turn.sin() + shift[0], x * turn.sin() + y * turn.cos() + shift[1]]
            };
            let holed = sheet.iter().copied().enumerate().filter(|(f, _)| k % 4 != 0 || !(70..90).contains(f));
            let uv: Vec<Triangle> = holed.map(|(_, t)| t).chain(sheet.iter().map(|t| t.map(moved))).collect();
            let expected = slow(&uv);
            assert_eq!(pairs(&uv), expected);
            let extent = extent_without_overlap(&uv, Watch::NONE).unwrap();
            assert_eq!(extent.is_some(), expected.is_empty(), "{k}");
            assert!(extent.is_none_or(|extent| extent == Boxes::new(&uv).extent));
            free += usize::from(expected.is_empty());
        }
        assert!((10..50).contains(&free), "{free}");
    }

    #[test]
    fn rounding_is_no_overlap_but_a_millionth_is() {
        for (shift, count) in [(1e-13, 0), (1e-6, 1)] {
            let left = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
            let right = [[1.0 - shift, 0.0], [2.0, 0.0], [1.0 - shift, 1.0]];
            assert_eq!(overlaps(&[left, right]).pairs.len(), count);
        }
    }

    #[test]
    fn a_ball_of_triangles_does_not_fill_the_memory() {
        let ball: Vec<Triangle> = (0..4000).map(|k| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0 + f64::from(k)]]).collect();
        let found = overlaps(&ball);
        assert!(!found.is_complete && found.pairs.len() <= FREE_PAIRS + MOST_PAIRS * ball.len() + BLOCK * MOST_OF_ONE);
    }

    #[test]
    fn nothing_and_points_overlap_nothing() {
        assert_eq!(overlaps(&[]).pairs, []);
        assert_eq!(overlaps(&[[[1.0, 1.0]; 3], [[1.0, 1.0]; 3]]).pairs, []);
        assert_eq!(overlaps(&[[[f64::NAN; 2]; 3], [[0.0, 0.0], [1.0, 0.0], [0.0, f64::INFINITY]]]).pairs, []);
    }
}
