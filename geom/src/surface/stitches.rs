//! The boundary of a surface joined where it meets itself.

use std::collections::HashMap;

use petgraph::unionfind::UnionFind;

use super::model::place_key;
use super::radial::{RadialFace, solid_pairs};
use crate::vector::{length, sub};

/// A run that is joined is at least this times the root of the area of the largest part that it is of: slits of scans are shorter (.03 on the dragon),
/// seams and creases longer (1 and more on robot parts).
const LONG_ENOUGH: f64 = 0.3;
/// Or, where the smallest of its parts has at least this share of the area of the largest, that times the root of the smallest: the mouths of pockets of scans
/// are of less (4e-7 at most on the dragon, which no cones flatten with its pockets joined).
const POCKET: f64 = 1e-5;

/// A side of a triangle on the boundary.
#[derive(Clone, Copy)]
pub(super) struct BoundarySide {
    /// The vertices of the triangle, first those that the side is between.
    pub(super) triangle: [u32; 3],
    /// The connected part that it is of.
    pub(super) part: u32,
}

/// A side of the boundary at the place where it is.
struct AtPlace {
    /// The numbers of the places of its ends, ascending.
    place: [u32; 2],
    side: BoundarySide,
    /// Whether it runs from the lower number to the higher one.
    is_forward: bool,
}

/// Pairs of sides at one place that bound the same body, where bodies touch along it.
fn touching(at_one: &[AtPlace], at: impl Fn(u32) -> [f64; 3]) -> Vec<[BoundarySide; 2]> {
    if at_one.len() < 4 {
        return Vec::new();
    }
    let face = |side: &AtPlace| RadialFace { apex: at(side.side.triangle[2]), is_forward: side.is_forward };
    let AtPlace { side, is_forward, .. } = &at_one[0];
    let [start, end, _] = side.triangle.map(&at);
    let ends = if *is_forward { [start, end] } else { [end, start] };
    let pairs = solid_pairs(ends, &at_one.iter().map(face).collect::<Vec<_>>());
    pairs.unwrap_or_default().into_iter().map(|pair| pair.map(|k| at_one[k].side)).collect()
}

/// For each vertex the first of those that sides of the boundary at the same place join; none if there are none such. `area` is that of each part of
/// the surface, once points are multiplied by `scale`.
pub(super) fn stitches(
    (points, scale): (&[[f64; 3]], f64),
    sides: impl Iterator<Item = BoundarySide>,
    area: &[f64],
) -> Option<Vec<u32>> {
    let key = |v: u32| place_key(&points[v as usize]);
    let mut number = HashMap::new();
    let mut at_place: Vec<AtPlace> = Vec::new();
    for side in sides {
        let [a, b, c] = side.triangle.map(key);
        // What has no area would be a third one between two that meet.
        if a == b || b == c || c == a {
            continue;
        }
        let mut place = [a, b].map(|key| {
            let next = number.len() as u32;
            *number.entry(key).or_insert(next)
        });
        let is_forward = place[0] < place[1];
        place.sort_unstable();
        at_place.push(AtPlace { place, side, is_forward });
    }
    at_place.sort_by_key(|at| at.place);
    let places = |side: &BoundarySide| {
        let mut places = side.triangle.map(key);
        places.sort_unstable();
        places
    };
    let at = |v: u32| points[v as usize].map(|x| x * scale);
    let pairs: Vec<([u32; 2], [BoundarySide; 2])> = at_place
        .chunk_by(|a, b| a.place == b.place)
        .flat_map(|at_one| {
            match at_one {
                [one, other] => vec![[one.side, other.side]],
                _ => touching(at_one, at),
            }
            .into_iter()
            .map(|pair| (at_one[0].place, pair))
        })
        .filter(|(_, [one, other])| places(one) != places(other))
        .collect();
    // Runs of such sides, their lengths and the areas of the smallest and the largest part that they are of.
    let mut runs = UnionFind::<u32>::new(number.len());
    pairs.iter().for_each(|&([a, b], _)| {
        runs.union(a, b);
    });
    let mut run = vec![(0.0, [f64::INFINITY, 0.0]); number.len()];
    for (place, pair) in &pairs {
        let [a, b] = [0, 1].map(|k| points[pair[0].triangle[k] as usize].map(|x| x * scale));
        let (long, of) = &mut run[runs.find_mut(place[0]) as usize];
        *long += length(sub(b, a));
        for side in pair {
            let area = area[side.part as usize];
            *of = [area.min(of[0]), area.max(of[1])];
        }
    }
    let mut joined = UnionFind::<u32>::new(points.len());
    let mut is_any = false;
    for (place, [one, other]) in pairs {
        let (long, [least, most]) = run[runs.find_mut(place[0]) as usize];
        let of = if least < POCKET * most { most } else { least };
        if long < LONG_ENOUGH * f64::sqrt(of) {
            continue;
        }
        let ([a, b, _], [mut c, mut d, _]) = (one.triangle, other.triangle);
        if key(a) != key(c) {
            std::mem::swap(&mut c, &mut d);
        }
        is_any |= joined.union(a, c) | joined.union(b, d);
    }
    is_any.then(|| {
        let mut first = vec![u32::MAX; points.len()];
        (0..points.len() as u32)
            .map(|v| {
                let first = &mut first[joined.find_mut(v) as usize];
                *first = v.min(*first);
                *first
            })
            .collect()
    })
}
