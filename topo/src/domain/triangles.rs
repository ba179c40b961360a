//! Basins on triangles that are in no order: no rings are made, no corners sorted.
//!
//! One pass over the triangles points the two later corners of each to its earliest one. A second pass finds the triangles whose
//! corners are in several basins; only these can say where anything merges. A vertex joins its own basin to that of any earlier neighbour, but most
//! of these joins are known before: where both are corners of one triangle of which the vertex is the last, the edge between them has joined their basins
//! already. Such a triangle is remembered for each vertex, one other basin of it, which is nearly always the only one; what is then left too many decides
//! nothing. That holds for any set of triangles, whatever its sheets and boundaries.

use crate::filtration::{Direction, Filtration};
use crate::pairing::{Basins, Descent, Join, NONE, OUTSIDE};
use crate::parallel;
use crate::scalar::Scalar;
use crate::watch::Watch;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// The basins of the vertices of some triangles; vertices point to any earlier neighbour.
pub(super) fn basins<S: Scalar, D: Direction>(
    vertices: usize,
    triangles: &[[u32; 3]],
    filtration: &Filtration<'_, S, D>,
) -> Basins {
    let next = pointers(vertices, triangles, filtration);
    let is_extremum = |&(v, &pointer): &(u32, &u32)| pointer == OUTSIDE && filtration.contains(v);
    let extrema = (0..).zip(&next).filter(is_extremum).map(|(v, _)| v).collect();
    let descent = Descent::new(next, extrema);
    descent.settle(filtration.watch());
    let crossed = crossed(triangles, filtration, &descent);
    let joins = if filtration.stops() { Vec::new() } else { joins(vertices, &crossed, &descent) };
    Basins::of_joins(descent, joins)
}

/// For each vertex an earlier neighbour. Several threads may write to one place; which of them is the last makes no difference to pairs.
fn pointers<S: Scalar, D: Direction>(
    vertices: usize,
    triangles: &[[u32; 3]],
    filtration: &Filtration<'_, S, D>,
) -> Vec<u32> {
    let next: Vec<AtomicU32> = vec![OUTSIDE; vertices].into_iter().map(AtomicU32::new).collect();
    let point = |[first, middle, last]: [u32; 3]| {
        next[last as usize].store(first, Relaxed);
        if middle != first {
            next[middle as usize].store(first, Relaxed);
        }
    };
    for_blocks(triangles, filtration.watch(), &|triangles| {
        triangles.iter().for_each(|&triangle| for_each_in_order(filtration, triangle, point));
    });
    next.into_iter().map(AtomicU32::into_inner).collect()
}

/// Triangles that reach into several basins, each in the order in which its corners enter; edges as triangles whose first corners are one.
fn crossed<S: Scalar, D: Direction>(
    triangles: &[[u32; 3]],
    filtration: &Filtration<'_, S, D>,
    descent: &Descent,
) -> Vec<Vec<[u32; 3]>> {
    for_blocks(triangles, filtration.watch(), &|triangles| {
        let mut crossed = Vec::new();
        for &triangle in triangles {
            let [a, b, c] = triangle.map(|corner| descent.basin_or_outside(corner));
            if (a ^ b) | (b ^ c) != 0 {
                for_each_in_order(filtration, triangle, |ordered| crossed.push(ordered));
            }
        }
        crossed
    })
}

/// The joins that are not known to have been made before, by rising index of the saddle.
fn joins(vertices: usize, crossed: &[Vec<[u32; 3]>], descent: &Descent) -> Vec<Join> {
    let crossed = || crossed.iter().flatten().map(|&corners| (corners, corners.map(|corner| descent.basin(corner))));
    // For each vertex a basin that an earlier edge has joined to its own.
    let mut joined = vec![NONE; vertices];
    for ([.., last], [first, middle, own]) in crossed() {
        if first != middle && (first == own || middle == own) {
            joined[last as usize] = if first == own { middle } else { first };
        }
    }
    let mut joins = Vec::new();
    let mut note = |saddle: u32, own: u32, other: u32| {
        if other != own && joined[saddle as usize] != other {
            joins.push(Join { saddle, basins: [own, other] });
        }
    };
    for ([_, middle, last], [first_basin, middle_basin, own]) in crossed() {
        note(middle, middle_basin, first_basin);
        note(last, own, first_basin);
        if middle_basin != first_basin {
            note(last, own, middle_basin);
        }
    }
    joins.sort_unstable_by_key(|join| (join.saddle, join.basins[1]));
    joins.dedup_by_key(|join| (join.saddle, join.basins[1]));
    joins
}

/// Calls `visit` with the corners of a triangle in the order in which they enter. Of one that has a corner twice, or one that never enters,
/// what is left are edges, whose first corner comes twice.
#[inline]
fn for_each_in_order<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    [a, b, c]: [u32; 3],
    mut visit: impl FnMut([u32; 3]),
) {
    let whole = a != b && b != c && c != a;
    if !whole || filtration.is_masked() && ![a, b, c].into_iter().all(|v| filtration.contains(v)) {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            if filtration.precedes(u, v) {
                visit([u, u, v]);
            } else if filtration.precedes(v, u) {
                visit([v, v, u]);
            }
        }
        return;
    }
    let corner = |v: u32| (v, filtration.value(v));
    let [a, b] = ordered::<S, D>(corner(a), corner(b));
    let [b, c] = ordered::<S, D>(b, corner(c));
    let [a, b] = ordered::<S, D>(a, b);
    visit([a.0, b.0, c.0]);
}

/// Two vertices with their values, the earlier first. Without a branch, since none could be foretold.
#[inline]
fn ordered<S: Scalar, D: Direction>(u: (u32, S), v: (u32, S)) -> [(u32, S); 2] {
    let is_right =
        (D::precedes_higher_index(u.1, v.1) & (u.0 < v.0)) | (D::precedes_lower_index(u.1, v.1) & (u.0 > v.0));
    let [first, second] = [is_right, !is_right].map(|takes_first| if takes_first { u.0 } else { v.0 });
    let [low, high] = [is_right, !is_right].map(|takes_first| if takes_first { u.1 } else { v.1 });
    [(first, low), (second, high)]
}

/// What `work` makes of blocks of triangles; of those only that it comes to before the work is stopped.
fn for_blocks<R: Send>(triangles: &[[u32; 3]], watch: Watch<'_>, work: &(dyn Fn(&[[u32; 3]]) -> R + Sync)) -> Vec<R> {
    let results = parallel::map_each_block(triangles, &|block| (!watch.stops()).then(|| work(block)));
    results.into_iter().flatten().collect()
}
