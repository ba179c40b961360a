//! The outlines of islands: what of many triangles matters to where they go.
//!
//! Each triangle is taken counter-clockwise. Its sides, as directed edges, are added up; a side that runs both ways between
//! the same two points cancels. What is left bounds the island, and its winding number about a point off it is the number of
//! triangles that cover the point, however the island lies over itself. The sides of triangles without area are all kept.

use geom::{Interrupted, Rows, Watch};
use num_complex::Complex64;

use super::options::PackError;

/// Coordinates up to here can be measured with.
const MOST: f64 = 1e300;
/// The watch is asked once for so many buckets of sides.
const BUCKETS_AT_ONCE: usize = 1 << 18;

/// An island, about its centre and in a common unit.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// Directed edges; see the module's head.
    pub(super) edges: Vec<[Complex64; 2]>,
    /// The centre of its bounding box, in the plane it comes from.
    pub(super) centre: [f64; 2],
    /// The sum of its triangles' areas.
    pub(super) area: f64,
}

/// The outlines of all islands, and the unit they are measured in: the longest side of a bounding box.
pub(super) fn outlines(
    triangles: &[[[f64; 2]; 3]],
    island: &[u32],
    watch: Watch,
) -> Result<(Vec<Outline>, f64), PackError> {
    let wrong = |t: &[[f64; 2]; 3]| t.as_flattened().iter().any(|x| x.is_nan() || x.abs() > MOST);
    if let Some(triangle) = triangles.iter().position(wrong) {
        return Err(PackError::NotFinite { triangle });
    }
    let count = island.iter().max().map_or(0, |&last| last as usize + 1);
    let rows = Rows::sorted(count, (0..).zip(island).map(|(t, &i)| (i as usize, t)));
    let boxes: Vec<[[f64; 2]; 2]> = (0..count).map(|i| bounding_box(triangles, rows.row(i))).collect();
    watch.ask(0.0)?;
    let extent = |[low, high]: &[[f64; 2]; 2]| (high[0] - low[0]).max(high[1] - low[1]);
    let unit = boxes.iter().map(extent).fold(0.0, f64::max);
    let unit = if unit > 0.0 { unit } else { 1.0 };
    let mut outlines = Vec::with_capacity(count);
    for (i, [low, high]) in boxes.iter().enumerate() {
        let watch = watch.within(i as f64 / count as f64, (i + 1) as f64 / count as f64);
        let centre = if rows.row(i).is_empty() { [0.0; 2] } else { [0, 1].map(|k| 0.5 * low[k] + 0.5 * high[k]) };
        outlines.push(outline(triangles, rows.row(i), (centre, unit), watch)?);
    }
    Ok((outlines, unit))
}

fn bounding_box(triangles: &[[[f64; 2]; 3]], members: &[u32]) -> [[f64; 2]; 2] {
    let mut found = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for p in members.iter().flat_map(|&t| &triangles[t as usize]) {
        for k in 0..2 {
            found[0][k] = found[0][k].min(p[k]);
            found[1][k] = found[1][k].max(p[k]);
        }
    }
    found
}

/// The outline of some triangles about a centre.
fn outline(
    triangles: &[[[f64; 2]; 3]],
    members: &[u32],
    (centre, unit): ([f64; 2], f64),
    watch: Watch,
) -> Result<Outline, Interrupted> {
    watch.ask(0.0)?;
    let place = |p: [f64; 2]| Complex64::new((p[0] - centre[0]) / unit, (p[1] - centre[1]) / unit);
    let mut area = 0.0;
    let mut upright: Vec<[[f64; 2]; 3]> = Vec::with_capacity(members.len());
    let mut edges = Vec::new();
    for &t in members {
        let [a, b, c] = triangles[t as usize];
        let [u, v] = [place(b) - place(a), place(c) - place(a)];
        let doubled = u.re * v.im - u.im * v.re;
        area += 0.5 * doubled.abs();
        match doubled {
            d if d > 0.0 => upright.push([a, b, c]),
            d if d < 0.0 => upright.push([a, c, b]),
            _ => edges.extend(sides([a, b, c]).map(|side| side.map(place))),
        }
    }
    watch.ask(0.2)?;
    edges.extend(uncancelled(&upright, watch.within(0.2, 1.0))?.into_iter().map(|side| side.map(place)));
    Ok(Outline { edges, centre, area })
}

fn sides([a, b, c]: [[f64; 2]; 3]) -> [[[f64; 2]; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// A side without its direction, and 1 or -1 for that.
type Edge = ([[u64; 2]; 2], i32);

/// The sides that do not run both ways, in the order in which they come.
fn uncancelled(triangles: &[[[f64; 2]; 3]], watch: Watch) -> Result<Vec<[[f64; 2]; 2]>, Interrupted> {
    let all: Vec<[[f64; 2]; 2]> = triangles.iter().flat_map(|&t| sides(t)).collect();
    let edges: Vec<Edge> = all.iter().copied().map(edge).collect();
    let buckets = all.len().next_power_of_two();
    let bucket = |edge: &Edge| (mixed(edge) >> 16) as usize % buckets;
    watch.ask(0.3)?;
    let mut rows = Rows::sorted(buckets, edges.iter().map(bucket).zip(0..));
    let mut is_left = vec![false; all.len()];
    for b in 0..buckets {
        if b % BUCKETS_AT_ONCE == 0 {
            watch.ask(0.5 + 0.5 * b as f64 / buckets as f64)?;
        }
        let row: &mut [u32] = rows.row_mut(b);
        // A side's number breaks ties, so that those of an edge stay in their order.
        row.sort_unstable_by_key(|&k| (edges[k as usize].0, k));
        for same in row.chunk_by(|&j, &k| edges[j as usize].0 == edges[k as usize].0) {
            let mut rest: i32 = same.iter().map(|&k| edges[k as usize].1).sum();
            for &k in same {
                let way = edges[k as usize].1;
                if rest * way > 0 {
                    rest -= way;
                    is_left[k as usize] = true;
                }
            }
        }
    }
    Ok(all.into_iter().zip(is_left).filter_map(|(side, is_left)| is_left.then_some(side)).collect())
}

fn edge([a, b]: [[f64; 2]; 2]) -> Edge {
    // + 0.0 makes -0.0 the same point.
    let [a, b] = [a, b].map(|p| p.map(|x| (x + 0.0).to_bits()));
    if a < b { ([a, b], 1) } else { ([b, a], -1) }
}

/// Bits that say little of the edge any more (a multiplicative hash; its upper bits are the good ones). A standard hash map of the sides
/// took eight times as long as buckets by this: 0.2 s for 268,686 triangles.
fn mixed(edge: &Edge) -> u64 {
    let add = |sum: u64, &x: &u64| (sum.rotate_left(29) ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let sum = edge.0.as_flattened().iter().fold(0, add);
    (sum ^ (sum >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOWER: [[f64; 2]; 3] = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
    const UPPER: [[f64; 2]; 3] = [[0.0, 0.0], [2.0, 2.0], [0.0, 2.0]];

    fn edges_of(triangles: &[[[f64; 2]; 3]]) -> usize {
        let (found, unit) = outlines(triangles, &vec![0; triangles.len()], Watch::NONE).unwrap();
        assert_eq!((unit, found.len(), found[0].centre), (2.0, 1, [1.0, 1.0]));
        found[0].edges.len()
    }

    #[test]
    fn common_sides_cancel_however_the_triangles_are_turned() {
        assert_eq!(edges_of(&[LOWER, UPPER]), 4);
        let [a, b, c] = UPPER;
        assert_eq!(edges_of(&[LOWER, [a, c, b]]), 4);
    }

    #[test]
    fn what_lies_over_itself_and_what_has_no_area_keeps_its_sides() {
        assert_eq!(edges_of(&[LOWER, UPPER, UPPER]), 7);
        assert_eq!(edges_of(&[LOWER, UPPER, [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]]), 7);
    }

    #[test]
    fn coordinates_that_are_no_numbers_are_refused_by_triangle() {
        let bad = [[0.0, 0.0], [f64::NAN, 0.0], [0.0, 1.0]];
        assert_eq!(outlines(&[LOWER, bad], &[0, 0], Watch::NONE).unwrap_err(), PackError::NotFinite { triangle: 1 });
    }
}
