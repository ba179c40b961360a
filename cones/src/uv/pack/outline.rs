//! The outlines of islands: what of many triangles matters to where they go.
//!
//! What is left of their sides when those that run both ways cancel ([`sides`](super::super::sides)) bounds the island, and its winding number about
//! a point off it is the number of triangles that cover the point, however the island lies over itself. The sides of triangles without area
//! are all kept.

use geom::Watch;
use num_complex::Complex64;
use rayon::prelude::*;

use super::super::sides::{Turned, open_sides, side};
use super::options::PackError;
use super::tilt::tilt;

/// Coordinates up to here can be measured with.
const MOST: f64 = 1e300;

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

impl Outline {
    /// By how much it is turned away from lying along the axes, if it has straight sides.
    pub(super) fn tilt(&self) -> Option<f64> {
        tilt(self.edges.iter().copied())
    }
}

/// The outlines of all islands, and the unit they are measured in: the longest side of a bounding box.
pub(super) fn outlines(
    triangles: &[[[f64; 2]; 3]],
    island: &[u32],
    watch: Watch,
) -> Result<(Vec<Outline>, f64), PackError> {
    let wrong = |t: &[[f64; 2]; 3]| t.as_flattened().iter().any(|x| x.is_nan() || x.abs() > MOST);
    if let Some(triangle) = triangles.par_iter().position_first(wrong) {
        return Err(PackError::NotFinite { triangle });
    }
    let count = island.iter().max().map_or(0, |&last| last as usize + 1);
    let mut boxes = vec![[[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]; count];
    for (corners, &i) in triangles.iter().zip(island) {
        let [low, high] = &mut boxes[i as usize];
        for p in corners {
            for k in 0..2 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
    }
    watch.ask(0.1)?;
    let extent = |[low, high]: &[[f64; 2]; 2]| (high[0] - low[0]).max(high[1] - low[1]);
    let unit = boxes.iter().map(extent).fold(0.0, f64::max);
    let unit = if unit > 0.0 { unit } else { 1.0 };
    let centre = |[low, high]: &[[f64; 2]; 2]| {
        if low[0] > high[0] { [0.0; 2] } else { [0, 1].map(|k| 0.5 * low[k] + 0.5 * high[k]) }
    };
    let centres: Vec<[f64; 2]> = boxes.iter().map(centre).collect();
    let place = |t: usize, p: [f64; 2]| {
        let centre = centres[island[t] as usize];
        Complex64::new((p[0] - centre[0]) / unit, (p[1] - centre[1]) / unit)
    };
    let doubled = |t: usize| {
        let [a, b, c] = triangles[t].map(|p| place(t, p));
        let [u, v] = [b - a, c - a];
        u.re * v.im - u.im * v.re
    };
    let of_centre = |&centre: &[f64; 2]| Outline { edges: Vec::new(), centre, area: 0.0 };
    let mut outlines: Vec<Outline> = centres.iter().map(of_centre).collect();
    for (t, &i) in island.iter().enumerate() {
        let (outline, doubled) = (&mut outlines[i as usize], doubled(t));
        outline.area += 0.5 * doubled.abs();
        if doubled == 0.0 {
            let sides = (0..3).map(|k| side(triangles, 3 * t as u32 + k).map(|p| place(t, p)));
            outline.edges.extend(sides);
        }
    }
    watch.ask(0.3)?;
    let turned = |t: u32| {
        let doubled = doubled(t as usize);
        (doubled != 0.0).then_some(Turned { island: island[t as usize], is_clockwise: doubled < 0.0 })
    };
    for number in open_sides(triangles, turned, watch.within(0.3, 1.0))? {
        let t = number as usize / 3;
        let [from, to] = side(triangles, number).map(|p| place(t, p));
        let edge = if doubled(t) < 0.0 { [to, from] } else { [from, to] };
        outlines[island[t] as usize].edges.push(edge);
    }
    Ok((outlines, unit))
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
