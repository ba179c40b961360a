//! Where basins touch, in the order in which they do.
//!
//! Kruskal's algorithm (1956) wants all joins in order, but few of many decide anything: on white noise one in three. So many joins are first
//! parted by value, and before those of a part are put in order, those are dropped whose basins have been joined by earlier ones (Osipov,
//! Sanders & Singler 2009, "The filter-Kruskal minimum spanning tree algorithm"). Parts fit into the second-level cache and are let go when they are done,
//! so that what comes of them takes no more memory.

use super::by_value;
use super::union_find::UnionFind;
use crate::filtration::{Direction, Filtration, Kind};
use crate::scalar::Scalar;

/// A vertex at which two basins touch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Join {
    pub(crate) saddle: u32,
    pub(crate) basins: [u32; 2],
}

/// So many joins are put in order at once, unless there are more than [`MOST_PARTS`] times as many.
const PART: usize = 1 << 15;

/// Joins go to so many parts at most, as each is written to by itself.
const MOST_PARTS: usize = 16;

/// So many joins for each part are looked at to find where parts should begin.
const SAMPLED: usize = 64;

/// Calls `visit` with the joins of each saddle, saddles in the order in which they enter, joins as they are given: by rising index of the
/// saddle, in [parts](parted). Joins of basins that `visit` has put into one set before may be missing. Ends early if the work is stopped.
pub(super) fn for_each_saddle<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    mut parts: Vec<Vec<Join>>,
    sets: &mut UnionFind,
    mut visit: impl FnMut(&mut UnionFind, &[Join]),
) {
    if D::KIND == Kind::Minimum {
        parts.reverse();
    }
    let (mut is_first, mut at_saddle) = (true, Vec::new());
    while let Some(mut joins) = parts.pop() {
        if !core::mem::take(&mut is_first) {
            joins.retain(|join| sets.find(join.basins[0]) != sets.find(join.basins[1]));
        }
        let order = by_value::in_order(filtration, joins.len(), |place| joins[place as usize].saddle);
        if filtration.stops() {
            return;
        }
        let join = |place: u32| &joins[place as usize];
        for places in order.chunk_by(|&a, &b| join(a).saddle == join(b).saddle) {
            if let [place] = *places {
                visit(sets, core::slice::from_ref(join(place)));
                continue;
            }
            at_saddle.clear();
            at_saddle.extend(places.iter().map(|&place| *join(place)));
            if D::KIND == Kind::Maximum {
                at_saddle.reverse(); // as the order is
            }
            visit(sets, &at_saddle);
        }
    }
}

/// Joins in parts, each of which has lower values than the next; within each as they are given.
pub(super) fn parted<S: Scalar, D: Direction>(filtration: &Filtration<'_, S, D>, joins: Vec<Join>) -> Vec<Vec<Join>> {
    let count = (joins.len() / PART).min(MOST_PARTS);
    if count < 2 {
        return vec![joins];
    }
    let bits = |join: &Join| by_value::bits(filtration.value(join.saddle));
    let mut sample: Vec<u64> = joins.iter().step_by(joins.len() / (count * SAMPLED)).map(bits).collect();
    sample.sort_unstable();
    let begins: Vec<u64> = (1..count).map(|part| sample[part * sample.len() / count]).collect();
    let mut sizes = vec![0usize; count];
    let part_of = |join: &Join| {
        let bits = bits(join);
        let part = begins.partition_point(|&begin| begin <= bits);
        sizes[part] += 1;
        part as u8
    };
    let part_of: Vec<u8> = joins.iter().map(part_of).collect();
    let mut parts: Vec<Vec<Join>> = sizes.into_iter().map(Vec::with_capacity).collect();
    joins.iter().zip(part_of).for_each(|(&join, part)| parts[usize::from(part)].push(join));
    parts
}
