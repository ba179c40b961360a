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
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Join {
    pub(crate) saddle: u32,
    pub(crate) basins: [u32; 2],
}

/// So many joins are put in order at once, unless there are more than [`MOST_PARTS`] times as many.
const PART: usize = 1 << 13;

/// Joins go to so many parts at most, as each is written to by itself.
const MOST_PARTS: usize = 16;

/// So many joins for each part are looked at to find where parts should begin.
const SAMPLED: usize = 64;

/// Joins parted by value; those that enter last come first.
pub(super) struct Parts {
    joins: Vec<Join>,
    /// Where each part begins.
    begins: Vec<usize>,
}

impl Parts {
    /// Parts joins that are given by rising index of the saddle. Within a part they stay as they are.
    pub(super) fn new<S: Scalar, D: Direction>(filtration: &Filtration<'_, S, D>, joins: Vec<Join>) -> Self {
        let count = (joins.len() / PART).min(MOST_PARTS);
        if count < 2 {
            return Self { joins, begins: vec![0] };
        }
        let bits = |join: &Join| by_value::bits(filtration.value(join.saddle));
        let sample = joins.iter().step_by(joins.len() / (count * SAMPLED)).map(bits).collect();
        let lowest = lowest_of_parts(sample, count);
        let part_of = |join: &Join| {
            let bits = bits(join);
            let lower = lowest.partition_point(|&lowest| lowest <= bits);
            (if D::KIND == Kind::Minimum { count - 1 - lower } else { lower }) as u8
        };
        let part_of = joins.iter().map(part_of).collect();
        Self::parted(joins, part_of, count)
    }

    /// Joins that go to so many parts, each to its own.
    fn parted(joins: Vec<Join>, part_of: Vec<u8>, count: usize) -> Self {
        let mut sizes = vec![0; count];
        part_of.iter().for_each(|&part| sizes[usize::from(part)] += 1);
        let begin = |end: &mut usize, size: usize| {
            *end += size;
            Some(*end - size)
        };
        let begins: Vec<usize> = sizes.into_iter().scan(0, begin).collect();
        let (mut filled, mut parted) = (begins.clone(), vec![Join::default(); joins.len()]);
        for (&join, part) in joins.iter().zip(part_of) {
            let place = &mut filled[usize::from(part)];
            parted[*place] = join;
            *place += 1;
        }
        Self { joins: parted, begins }
    }

    /// Calls `visit` with the joins of each saddle, saddles in the order in which they enter, joins as they were given. Joins of basins that
    /// `visit` has put into one set before may be missing. Ends early if the work is stopped.
    pub(super) fn for_each_saddle<S: Scalar, D: Direction>(
        self,
        filtration: &Filtration<'_, S, D>,
        sets: &mut UnionFind,
        mut visit: impl FnMut(&mut UnionFind, &[Join]),
    ) {
        let Self { mut joins, begins } = self;
        let (mut is_first, mut left, mut at_saddle) = (true, Vec::new(), Vec::new());
        for begin in begins.into_iter().rev() {
            let mut part = &joins[begin..];
            if !is_first {
                left.clear();
                left.extend(part.iter().filter(|join| sets.find(join.basins[0]) != sets.find(join.basins[1])));
                part = &left;
            }
            let order = by_value::in_order(filtration, part.len(), |place| part[place as usize].saddle);
            if filtration.stops() {
                return;
            }
            let join = |place: u32| &part[place as usize];
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
            joins.truncate(begin);
            is_first = false;
        }
    }
}

/// The lowest value of each part but the first, from those of a sample.
fn lowest_of_parts(mut sample: Vec<u64>, count: usize) -> Vec<u64> {
    sample.sort_unstable();
    (1..count).map(|part| sample[part * sample.len() / count]).collect()
}
