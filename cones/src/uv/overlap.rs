//! Where a map to the plane lies over itself: the pairs of triangles whose interiors meet.
//!
//! Whether two triangles meet is decided exactly ([`triangle`](super::triangle)). Triangles that only touch do not overlap, those
//! that have no area overlap nothing, and mirrored ones are turned first. Corners that are one point must have the same bits in all
//! their triangles; where they do not, triangles that should touch overlap by a rounding error, which is why pairs have a
//! depth: beyond [`NEGLIGIBLE_DEPTH`] it is no rounding.
//!
//! Candidates come from a packed Hilbert R-tree of the bounding boxes, which does not mind triangles of very different sizes
//! as a uniform grid does. O(n log n + candidates).

use geom::{Interrupted, Watch};
use rayon::prelude::*;
use static_aabb2d_index::{StaticAABB2DIndex, StaticAABB2DIndexBuilder};

use super::triangle::{self, Triangle};

/// An overlap that is not deeper than this share of the map's extent is a seam that touches: rounding leaves up to 1e-12,
/// real overlaps are deeper than 1e-7.
pub const NEGLIGIBLE_DEPTH: f64 = 1e-9;
/// So many pairs are kept for each triangle, and [`FREE_PAIRS`] besides. The layouts of surfaces have less than two; a map that
/// is folded to a ball has n² of them.
const MOST_PAIRS: usize = 16;
/// So many pairs are kept in any case.
pub(super) const FREE_PAIRS: usize = 1 << 20;
/// So many pairs are kept of one triangle with later ones.
const MOST_OF_ONE: usize = 1 << 12;
/// So many triangles are looked up in the tree between two looks at the watch.
const BLOCK: usize = 1 << 10;

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

    /// The triangles that lie over or under another, in order.
    pub fn triangles(&self) -> Vec<u32> {
        let mut triangles: Vec<u32> = self.pairs.iter().flat_map(|pair| pair.triangles).collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }
}

/// The pairs of triangles of a map that overlap deeper than [`NEGLIGIBLE_DEPTH`].
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
    let tree = Boxes::new(uv.iter().copied().map(triangle::upright));
    watch.ask(0.3)?;
    let most = FREE_PAIRS + MOST_PAIRS * uv.len();
    let (mut pairs, mut is_complete) = (Vec::new(), true);
    let extent = tree.extent;
    let of_triangle = |f: u32| {
        let mut found = Vec::new();
        if let Some(one) = tree.upright[f as usize] {
            tree.meeting(&one, |g| {
                if g > f
                    && let Some(other) = tree.upright[g as usize].filter(|_| asked([f, g]))
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
        watch.ask(0.3 + 0.7 * (count * BLOCK) as f64 / uv.len() as f64)?;
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

/// The map scaled by a power of two, and so without rounding, to an extent near 1, where products neither overflow nor
/// vanish; and what it was divided by.
fn of_unit_size(uv: &[Triangle]) -> (Vec<Triangle>, f64) {
    let finite = uv.iter().flatten().flatten().filter(|x| x.is_finite());
    let largest = finite.fold(0.0_f64, |most, x| most.max(x.abs()));
    let size = if largest > 0.0 { largest.log2().floor().clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
    (uv.iter().map(|corners| corners.map(|p| p.map(|x| x / size))).collect(), size)
}

/// Upright triangles in a tree of their bounding boxes.
#[derive(Debug)]
pub(super) struct Boxes {
    /// The triangles, turned counter-clockwise; none for those without area.
    pub(super) upright: Vec<Option<Triangle>>,
    /// None if no triangle has an area.
    tree: Option<StaticAABB2DIndex<f64>>,
    /// The triangles in the tree.
    triangle: Vec<u32>,
    /// The longer side of the bounding box of all.
    pub(super) extent: f64,
}

impl Boxes {
    pub(super) fn new(upright: impl Iterator<Item = Option<Triangle>>) -> Self {
        let upright: Vec<Option<Triangle>> = upright.collect();
        let triangle: Vec<u32> = (0..).zip(&upright).filter_map(|(f, corners)| corners.map(|_| f)).collect();
        let mut builder = StaticAABB2DIndexBuilder::new(triangle.len());
        for corners in upright.iter().flatten() {
            let [low, high] = bounds(corners);
            builder.add(low[0], low[1], high[0], high[1]);
        }
        let tree = builder.build().ok();
        let mut boxes = Self { upright, tree, triangle, extent: 0.0 };
        boxes.extent = boxes.bounds().map_or(0.0, |[low, high]| (high[0] - low[0]).max(high[1] - low[1]));
        boxes
    }

    /// The lower left and the upper right corner of the bounding box of all; none without area.
    pub(super) fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        self.tree.as_ref()?.bounds().map(|b| [[b.min_x, b.min_y], [b.max_x, b.max_y]])
    }

    /// The same of some triangles.
    pub(super) fn bounds_of(&self, some: impl Iterator<Item = u32>) -> Option<[[f64; 2]; 2]> {
        let boxes = some.filter_map(|f| self.upright[f as usize].as_ref()).map(bounds);
        boxes.reduce(|[low, high], [l, h]| {
            [[low[0].min(l[0]), low[1].min(l[1])], [high[0].max(h[0]), high[1].max(h[1])]]
        })
    }

    /// The area of a triangle.
    pub(super) fn area(&self, f: u32) -> f64 {
        self.upright[f as usize].map_or(0.0, |corners| 0.5 * triangle::twice_area(corners))
    }

    /// Visits the triangles whose bounding boxes meet that of a triangle, in no order that means anything, as long as the
    /// visitor says to go on.
    pub(super) fn meeting(&self, triangle: &Triangle, mut visit: impl FnMut(u32) -> bool) {
        let [low, high] = bounds(triangle);
        let Some(tree) = &self.tree else { return };
        let mut visitor = |k: usize| if visit(self.triangle[k]) { Ok(()) } else { Err(()) };
        // Stopping is no failure.
        let _: Result<(), ()> = tree.visit_query(low[0], low[1], high[0], high[1], &mut visitor);
    }
}

/// The lower left and the upper right corner of the bounding box of points.
pub(super) fn bounds<const N: usize>(points: &[[f64; 2]; N]) -> [[f64; 2]; 2] {
    let extreme = |start: f64, of: fn(f64, f64) -> f64| [0, 1].map(|i| points.iter().fold(start, |x, p| of(x, p[i])));
    [extreme(f64::INFINITY, f64::min), extreme(f64::NEG_INFINITY, f64::max)]
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
