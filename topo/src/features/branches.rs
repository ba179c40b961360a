//! The branch decomposition of a field: each extremum with its basin, and the branch its own grows out of.
//!
//! Merge trees, segmentations and simplified fields are all read off from it. Extrema are numbered by vertex index.
//! Pascucci, Cole-McLaughlin & Scorzelli (2004), "Multi-resolution computation and presentation of contour trees".

use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Filtration, Kind};
use crate::pairing::{BasinLabels, Descent, Merge, NONE, OUTSIDE, Paired, Pointing, UnionFind};
use crate::scalar::Scalar;

/// A branch ends at a saddle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BranchEnd {
    /// The extremum whose branch it is.
    pub(crate) extremum: u32,
    pub(crate) saddle: u32,
    /// The eldest extremum of all that meet at the saddle, whose branch goes on.
    pub(crate) elder: u32,
    /// The extremum to which one comes from the saddle by steepest descent into the elder component.
    pub(crate) beyond: u32,
}

/// Basins by steepest descent and the branches on them.
#[derive(Debug)]
pub(crate) struct Branches {
    /// The vertices of the extrema, rising.
    pub(crate) extrema: Vec<u32>,
    /// For each vertex the extremum whose basin it is in.
    pub(crate) basins: BasinLabels,
    /// The branches that end, in the order in which they do.
    pub(crate) ends: Vec<BranchEnd>,
    /// The others, with the last vertex to enter, where not only labels are wanted.
    pub(crate) essential: Vec<(u32, u32)>,
}

impl Branches {
    /// Finds them, unless the work is stopped; `pointing` is the steepest, or that for labels.
    pub(crate) fn new<G: Domain, S: Scalar, D: Direction>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
        pointing: Pointing,
    ) -> Result<Self, Error> {
        let Paired { merges, in_order, descent } = domain.basins(filtration, pointing).pair(filtration);
        if filtration.stops() {
            return Err(Error::Interrupted);
        }
        let essential = (0..).zip(&merges).filter(|(_, merge)| !merge.is_finite());
        let essential = essential.map(|(extremum, merge)| (extremum, merge.end)).collect();
        let ends = ends(domain, filtration, &descent, &merges, in_order);
        if filtration.stops() {
            return Err(Error::Interrupted);
        }
        let (basins, extrema) = descent.into_labels();
        Ok(Self { extrema, basins, ends, essential })
    }

    /// For each extremum whether its branch lives longer than a threshold.
    pub(crate) fn longer<S: Scalar, D: Direction>(
        &self,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> Vec<bool> {
        let mut is_longer = vec![true; self.extrema.len()];
        for end in &self.ends {
            let born = filtration.value(self.extrema[end.extremum as usize]);
            is_longer[end.extremum as usize] = born.width(filtration.value(end.saddle)) > threshold;
        }
        is_longer
    }

    /// The field with all branches that are not kept filled up.
    pub(crate) fn filled<S: Scalar, D: Direction>(&self, filtration: &Filtration<'_, S, D>, kept: &[bool]) -> Vec<S> {
        let ends = self.ends.iter().map(|end| (end.extremum, end.elder, end.saddle));
        let levels = fill_levels(ends, kept);
        let fill = |(v, basin): (u32, u32)| {
            let level = levels.get(basin as usize).copied().flatten();
            filtration.value(level.map_or(v, |saddle| filtration.later(v, saddle)))
        };
        (0..).zip(self.basins.settled().iter()).map(fill).collect()
    }
}

/// For each extremum the level up to which its basin must be filled so that only kept branches are left; from the branches
/// that end, in their order: whose they are, the elder, and the level at which they do.
pub(crate) fn fill_levels<L: Copy>(
    ends: impl DoubleEndedIterator<Item = (u32, u32, L)>,
    kept: &[bool],
) -> Vec<Option<L>> {
    let mut levels = vec![None; kept.len()];
    // Later saddles first: a branch that goes, on one that goes, is filled as far as that.
    for (extremum, elder, level) in ends.rev().filter(|end| !kept[end.0 as usize]) {
        levels[extremum as usize] = levels[elder as usize].or(Some(level));
    }
    levels
}

/// For each extremum the place among the kept ones of that into whose basin its own spills, by way of others that are not
/// kept; from (extremum, beyond) for all branches that end.
///
/// Every branch spills into another component, so spills close no circle: each group is a tree of them, with one
/// extremum that is kept, whichever member is the root of the union-find.
pub(crate) fn spilled(ends: impl Iterator<Item = (u32, u32)>, kept: &[bool]) -> Vec<u32> {
    let mut groups = UnionFind::new(kept.len());
    for (extremum, beyond) in ends.filter(|end| !kept[end.0 as usize]) {
        let (from, to) = (groups.find(extremum), groups.find(beyond));
        groups.join(from, to);
    }
    let mut place_of_group = vec![NONE; kept.len()];
    let kept = (0..).zip(kept).filter(|&(_, &kept)| kept);
    for (place, (extremum, _)) in (0..).zip(kept) {
        place_of_group[groups.find(extremum) as usize] = place;
    }
    (0..groups.len() as u32).map(|extremum| place_of_group[groups.find(extremum) as usize]).collect()
}

/// So many saddles are looked around at before the watch is asked.
const LOOKED_AT: usize = 1 << 13;

/// The branches that end, in the order in which they do; none if the work is stopped.
fn ends<G: Domain, S: Scalar, D: Direction>(
    domain: G,
    filtration: &Filtration<'_, S, D>,
    descent: &Descent,
    merges: &[Merge],
    mut in_order: Vec<u32>,
) -> Vec<BranchEnd> {
    let saddles: Vec<u32> = in_order.iter().map(|&basin| merges[basin as usize].end).collect();
    let distinct = VertexSet::new(filtration.field().len(), saddles.iter().copied());
    let sides = Sides::new(domain, filtration, descent, &distinct);
    if filtration.stops() {
        return Vec::new();
    }
    // For each component that touches the saddle, where it does first.
    let mut first = vec![NONE; merges.len()];
    let mut components = UnionFind::new(merges.len());
    let mut ends = Vec::with_capacity(in_order.len());
    let mut rest = &mut in_order[..];
    for at_saddle in saddles.chunk_by(|a, b| a == b) {
        let (ending, others) = rest.split_at_mut(at_saddle.len());
        rest = others;
        if ending.len() > 1 {
            // The elder first, as the younger spill into what the elder have become.
            ending.copy_from_slice(&filtration.sorted(ending, |&basin| merges[basin as usize].extremum));
        }
        // All components that meet here end but one.
        let (saddle, mut elder) = (at_saddle[0], NONE);
        let around = sides.of(distinct.place(saddle));
        let ends_here = |component: u32| match ending[..] {
            [only] => component == only,
            _ => merges[component as usize].is_finite() && merges[component as usize].end == saddle,
        };
        for (place, &basin) in around.iter().enumerate().rev() {
            let component = components.find(basin);
            first[component as usize] = place as u32;
            elder = if ends_here(component) { elder } else { component };
        }
        for &mut extremum in ending {
            let [from, to] = [extremum, elder].map(|component| first[component as usize]);
            // From now on the younger component is a part of the elder one.
            first[elder as usize] = from.min(to);
            components.join(extremum, elder);
            ends.push(BranchEnd { extremum, saddle, elder, beyond: around[to as usize] });
        }
    }
    ends
}

/// The basins around each of some saddles in the order in which the first neighbours in them enter; where there are two, in any, since
/// they are in different components. Only round a vertex of very many neighbours one may come more than once.
struct Sides {
    /// Where each list begins, and the end of the last.
    starts: Vec<usize>,
    basins: Vec<u32>,
}

impl Sides {
    /// Looks around saddles as they lie in memory: on noise that takes half the time of looking around when they come by value. Not
    /// around all if the work is stopped.
    fn new<G: Domain, S: Scalar, D: Direction>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
        descent: &Descent,
        saddles: &VertexSet,
    ) -> Self {
        let (mut starts, mut basins) = (Vec::with_capacity(saddles.len() + 1), Vec::new());
        starts.push(0);
        let (mut neighbors, mut around) = (Vec::new(), Vec::new());
        for (place, saddle) in saddles.iter().enumerate() {
            if place.is_multiple_of(LOOKED_AT) && filtration.stops() {
                break;
            }
            neighbors.clear();
            domain.for_each_neighbor(saddle as usize, |u| {
                if filtration.precedes(u as u32, saddle) {
                    neighbors.push(u as u32);
                }
            });
            distinct_basins(descent, &neighbors, &mut around);
            if around.len() != 2 {
                neighbors.sort_unstable_by_key(|&u| (filtration.value(u).key(), u));
                if D::KIND == Kind::Maximum {
                    neighbors.reverse();
                }
                distinct_basins(descent, &neighbors, &mut around);
            }
            basins.extend_from_slice(&around);
            starts.push(basins.len());
        }
        Self { starts, basins }
    }

    fn of(&self, place: usize) -> &[u32] {
        &self.basins[self.starts[place]..self.starts[place + 1]]
    }
}

/// The basins of some vertices, each where it comes first, if it is among the first [`DISTINCT`].
fn distinct_basins(descent: &Descent, vertices: &[u32], basins: &mut Vec<u32>) {
    basins.clear();
    for &vertex in vertices {
        let basin = descent.basin(vertex);
        if !basins.iter().take(DISTINCT).any(|&other| other == basin) {
            basins.push(basin);
        }
    }
}

/// So many basins are compared with each other.
const DISTINCT: usize = 32;

/// Some of the vertices of a domain, each with its place among them by rising index: a bit for each vertex.
struct VertexSet {
    words: Vec<u64>,
    /// How many vertices come before each word.
    before: Vec<u32>,
    count: usize,
}

impl VertexSet {
    fn new(vertices: usize, members: impl Iterator<Item = u32>) -> Self {
        let mut words = vec![0u64; vertices.div_ceil(64)];
        members.for_each(|v| words[v as usize / 64] |= 1 << (v % 64));
        let mut count = 0;
        let count_before = |word: &u64| {
            let before = count;
            count += word.count_ones();
            before
        };
        let before = words.iter().map(count_before).collect();
        Self { words, before, count: count as usize }
    }

    fn len(&self) -> usize {
        self.count
    }

    /// The place of a member.
    fn place(&self, member: u32) -> usize {
        let word = member as usize / 64;
        let lower = self.words[word] & ((1 << (member % 64)) - 1);
        (self.before[word] + lower.count_ones()) as usize
    }

    /// By rising index.
    fn iter(&self) -> impl Iterator<Item = u32> {
        (0..).step_by(64).zip(&self.words).flat_map(|(first, &word)| {
            let mut rest = word;
            core::iter::from_fn(move || {
                let bit = (rest != 0).then(|| rest.trailing_zeros())?;
                rest &= rest - 1;
                Some(first + bit)
            })
        })
    }
}

/// Whether a vertex with this basin enters.
pub(crate) fn enters(basin: u32) -> bool {
    basin != OUTSIDE
}
