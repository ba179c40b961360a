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
use std::collections::{HashMap, HashSet};

use geom::{Interrupted, Watch, distortion};
use rayon::prelude::*;

use super::boxes::Boxes;
use super::sides::{Turned, open_sides};
use super::triangle::{self, Triangle};

/// An overlap that is not deeper than this share of the map's extent is a seam that touches: rounding leaves up to 1e-12,
/// real overlaps are deeper than 1e-7.
pub const NEGLIGIBLE_DEPTH: f64 = 1e-9;
/// Corners are rounded to the nearest number of single precision, 2⁻²⁵ of the extent away, in both coordinates, and two triangles may come nearer by that: 2⁻²³·⁵.
/// Twice as much is left for who scales or turns a map in single precision.
const ROUNDED: f64 = 1.0 / (1 << 22) as f64;
/// Points of the grid at most along the longer side of triangles of which it is measured how much they cover more than once,
const GRID: usize = 2048;
/// and at least,
const FEWEST_POINTS: usize = 256;
/// and so many of its points for each of them between.
const POINTS_OF_TRIANGLE: f64 = 4096.0;
/// So many looks are taken for three triangles that lie over each other.
const MOST_STEPS: usize = 1 << 26;
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

    /// The share of the covered area of the map, whose pairs these are, that is covered more than once: wherever islands are, and exact up to rounding where
    /// no three triangles lie over each other. Triangles of which some do are counted by themselves, those that hang together by overlaps on a grid of up
    /// to 2048 points along their longer side; all are where there are so many pairs that not all are known. O(n + pairs), and the grids' points.
    pub fn share(&self, uv: &[Triangle]) -> f64 {
        if self.pairs.is_empty() {
            return 0.0;
        }
        if !self.is_complete {
            return distortion::overlap(uv, GRID);
        }
        let clusters = clusters(&self.pairs);
        let of_clusters = clusters.into_par_iter().map(|cluster| {
            let all: f64 = cluster.triangles.iter().filter_map(|&f| triangle::area(uv[f as usize])).sum();
            let [once, again] = cluster.coverage(uv, all);
            [all, once, again]
        });
        let of_clusters: Vec<[f64; 3]> = of_clusters.collect();
        let whole: f64 = uv.iter().filter_map(|&corners| triangle::area(corners)).sum();
        let [in_clusters, once, again] =
            of_clusters.iter().fold([0.0; 3], |sum, of_one| [0, 1, 2].map(|k| sum[k] + of_one[k]));
        let covered = (whole - in_clusters).max(0.0) + once;
        if covered > 0.0 { (again / covered).min(1.0) } else { 0.0 }
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

/// Triangles that hang together by overlaps.
#[derive(Default)]
struct Cluster {
    triangles: Vec<u32>,
    /// What the pairs have in common, added up.
    common: f64,
    /// Whether three of them may lie over each other.
    is_deep: bool,
}

impl Cluster {
    /// The areas that they cover, and cover more than once, given what their areas add up to.
    fn coverage(&self, uv: &[Triangle], all: f64) -> [f64; 2] {
        if !self.is_deep {
            return [all - self.common, self.common];
        }
        let own: Vec<Triangle> = self.triangles.iter().map(|&f| uv[f as usize]).collect();
        let points = (POINTS_OF_TRIANGLE * own.len() as f64).sqrt() as usize;
        distortion::coverage(&own, points.clamp(FEWEST_POINTS, GRID))
    }
}

/// Triangles that overlap, by what hangs together, in the order of their first pairs.
fn clusters(pairs: &[Overlap]) -> Vec<Cluster> {
    let mut partners: HashMap<u32, Vec<u32>> = HashMap::new();
    for &Overlap { triangles: [f, g], .. } in pairs {
        partners.entry(f).or_default().push(g);
        partners.entry(g).or_default().push(f);
    }
    partners.values_mut().for_each(|partners| partners.sort_unstable());
    let mut of_triangle: HashMap<u32, usize> = HashMap::new();
    let mut clusters: Vec<Cluster> = Vec::new();
    let mut steps = 0;
    for &Overlap { triangles: [f, g], area, .. } in pairs {
        let number = *of_triangle.entry(f).or_insert_with(|| {
            clusters.push(Cluster::default());
            clusters.len() - 1
        });
        if clusters[number].triangles.is_empty() {
            clusters[number].triangles = reached(f, &partners);
            clusters[number].triangles.iter().for_each(|&f| _ = of_triangle.insert(f, number));
        }
        let cluster = &mut clusters[number];
        cluster.common += area;
        let (few, many) = if partners[&f].len() < partners[&g].len() { (f, g) } else { (g, f) };
        // Three triangles with a point in common are partners of each other.
        let is_third = |third: &u32| partners[&many].binary_search(third).is_ok();
        if !cluster.is_deep {
            steps += partners[&few].len();
            cluster.is_deep = steps > MOST_STEPS || partners[&few].iter().any(is_third);
        }
    }
    clusters
}

/// What is reached from a triangle by overlaps.
fn reached(first: u32, partners: &HashMap<u32, Vec<u32>>) -> Vec<u32> {
    let (mut reached, mut is_reached) = (vec![first], HashSet::from([first]));
    let mut next = 0;
    while let Some(&f) = reached.get(next) {
        next += 1;
        reached.extend(partners[&f].iter().copied().filter(|&g| is_reached.insert(g)));
    }
    reached
}

/// What rounding to single precision, as most files and programs have it, may make overlap of a map, over its extent: 2⁻²² of that, or of the largest
/// coordinate if the map is far from the origin.
pub fn rounding_depth(uv: &[Triangle]) -> f64 {
    let finite = || uv.iter().flatten().filter(|p| p.iter().all(|x| x.is_finite()));
    let range = |k: usize| finite().fold([f64::MAX, f64::MIN], |[low, high], p| [low.min(p[k]), high.max(p[k])]);
    let ranges = [range(0), range(1)];
    let extent = ranges.iter().fold(0.0_f64, |most, [low, high]| most.max(high - low));
    let largest = ranges.as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if extent > 0.0 && extent.is_finite() { ROUNDED * (largest / extent).max(1.0) } else { ROUNDED }
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
    fn the_share_does_not_depend_on_where_islands_are() {
        let moved = |by: [f64; 2]| move |t: &Triangle| t.map(|[x, y]| [x + by[0], y + by[1]]);
        let sheet = grid(9);
        // Two sheets by a third over each other, and as much beside them, near and far.
        let pair: Vec<Triangle> = sheet.iter().copied().chain(sheet.iter().map(moved([2.0 / 3.0, 0.0]))).collect();
        let share = |uv: &[Triangle]| overlaps(uv).share(uv);
        for far in [3.0, 1e3, 1e6] {
            let uv: Vec<Triangle> = pair.iter().copied().chain(sheet.iter().map(moved([far, 0.0]))).collect();
            assert!((share(&uv) - 1.0 / 8.0).abs() < 1e-6, "{far}: {}", share(&uv));
        }
        // Three layers count once.
        let thrice: Vec<Triangle> = [0.0, 0.01, 0.02].iter().flat_map(|&y| sheet.iter().map(moved([0.0, y]))).collect();
        let all = share(&thrice);
        for far in [3.0, 1e3] {
            let uv: Vec<Triangle> = thrice.iter().copied().chain(sheet.iter().map(moved([far, 0.0]))).collect();
            assert!((share(&uv) - all * 1.02 / 2.02).abs() < 2e-3, "{far}: {} {all}", share(&uv));
        }
        assert!((all - 1.0 / 1.02).abs() < 2e-3, "{all}");
    }

    #[test]
    fn a_sliver_of_overlap_has_its_share() {
        let uv = [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[1.0 - 1e-5, 0.0], [2.0, 0.0], [1.0 - 1e-5, 1.0]]];
        let share = overlaps(&uv).share(&uv);
        assert!((share - 1e-5).abs() < 1e-7, "{share}");
    }

    #[test]
    fn rounding_to_single_precision_is_no_overlap_of_maps_from_files() {
        // Two sheets that touch along a slanted line, turned, all corners rounded.
        let sheet = grid(20);
        for k in 0..40 {
            let (turn, offset) = (0.1 * f64::from(k), if k % 4 == 0 { 9.0 } else { 0.3 });
            let rounded = |x: f64| f64::from(x as f32);
            let place = |shift: f64| {
                move |t: &Triangle| {
                    t.map(|[x, y]| {
                        let [x, y] = [0.3 * (x + shift), 0.3 * y];
                        [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos()].map(|x| rounded(x + offset))
                    })
                }
            };
            let uv: Vec<Triangle> = sheet.iter().map(place(0.0)).chain(sheet.iter().map(place(1.0 + 1e-9))).collect();
            let found = overlaps_watched(&uv, rounding_depth(&uv), |_| true, Watch::NONE).unwrap();
            assert!(found.pairs.is_empty(), "{k}: {}", found.depth());
        }
        assert_eq!(rounding_depth(&grid(2)), ROUNDED);
        assert_eq!(rounding_depth(&[]), ROUNDED);
    }

    #[test]
    fn nothing_and_points_overlap_nothing() {
        assert_eq!(overlaps(&[]).pairs, []);
        assert_eq!(overlaps(&[[[1.0, 1.0]; 3], [[1.0, 1.0]; 3]]).pairs, []);
        assert_eq!(overlaps(&[[[f64::NAN; 2]; 3], [[0.0, 0.0], [1.0, 0.0], [0.0, f64::INFINITY]]]).pairs, []);
    }
}
