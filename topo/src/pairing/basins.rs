//! The fast algorithm: pairs without sorting the vertices.
//!
//! 1. *Scan.* Each vertex looks at its neighbours once and points to one that enters before it; a vertex without such a
//!    neighbour is an extremum. Nothing merges at a vertex whose earlier neighbours are connected (they are its *lower
//!    link*); the others are candidates for saddles. A domain that knows which neighbours are adjacent leaves few of
//!    them: on a smooth field about as many as there are extrema. A mere graph has to suspect every vertex with two.
//! 2. *Descend.* Candidates follow the pointers to see which basins their sides belong to; see [`Descent`].
//! 3. *Join.* A candidate between different basins joins them.
//! 4. *Pair.* The elder rule on basins and joins; see [`elder_rule`].
//!
//! That basins and their joins carry the pairs is folklore in discrete Morse theory; merge trees from monotone paths are
//! due to Chiang, Lenz, Lu & Rote (2005), "Simple and optimal output-sensitive construction of contour trees using
//! monotone paths". What is put in order are joins, digit by digit. Nothing here is proportional to n log n.

use super::boruvka;
use super::descent::{Descent, OUTSIDE};
use super::elder_rule::{self, Ended};
use super::graph::Graph;
use super::joins::Join;
use super::merges::{BranchEnd, Merge};
use super::union_find::UnionFind;
use crate::filtration::{Direction, Filtration, Kind};
use crate::parallel;
use crate::scalar::Scalar;
use crate::watch::Watch;
use core::cmp::Ordering;

/// What a scan finds, ranges of vertices apart.
#[derive(Debug, Default)]
pub(crate) struct Scan {
    /// Vertices without an earlier neighbour, by rising index.
    pub(crate) extrema: Vec<u32>,
    /// Vertices at which something may merge, by rising index, with two earlier neighbours in different parts of the
    /// lower link. A vertex with more than two parts has more than one entry. If vertices point to their earliest neighbours, entries are as
    /// [`note_sides`] makes them.
    pub(crate) candidates: Vec<SaddleCandidate>,
}

/// A vertex with two earlier neighbours that may belong to different basins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SaddleCandidate {
    pub(crate) saddle: u32,
    pub(crate) sides: [u32; 2],
}

/// Which of its earlier neighbours a vertex points to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pointing {
    /// Whichever is found first: enough for pairs.
    Any,
    /// The earliest: basins of steepest descent.
    Steepest,
    /// The earliest, and what is asked for is the basin of every vertex: all ways are followed at once, and no component's last vertex is
    /// found.
    Labels,
}

impl Pointing {
    pub(crate) fn is_steepest(self) -> bool {
        self != Self::Any
    }
}

/// Every vertex with its way down to an extremum, and where the basins touch.
#[derive(Debug)]
pub struct Basins {
    descent: Descent,
    joins: Vec<Join>,
    pointing: Pointing,
}

/// The basins of a graph of which nothing more is known.
pub(crate) fn basins_of_graph<G: Graph, S: Scalar, D: Direction>(
    graph: G,
    filtration: &Filtration<'_, S, D>,
    pointing: Pointing,
) -> Basins {
    let mut next = vec![OUTSIDE; graph.vertex_count()];
    let (mut extrema, mut candidates) = (Vec::new(), Vec::new());
    for (v, next) in (0..).zip(&mut next) {
        if (v as usize).is_multiple_of(parallel::BLOCK) && filtration.stops() {
            return Basins::none();
        }
        let mut earlier = 0;
        graph.for_each_neighbor(v as usize, |u| {
            let u = u as u32;
            if filtration.precedes(u, v) {
                let is_taken = pointing == Pointing::Any || earlier == 0 || filtration.precedes(u, *next);
                *next = if is_taken { u } else { *next };
                earlier += 1;
            }
        });
        match earlier {
            0 if filtration.contains(v) => extrema.push(v),
            0 | 1 => {}
            _ => candidates.push(v),
        }
    }
    let descent = Descent::new(next, extrema);
    if pointing == Pointing::Labels {
        descent.shorten(filtration.watch());
    }
    let joins = joins_of_graph(graph, filtration, &descent, &candidates, pointing);
    Basins { descent, joins, pointing }
}

/// The joins between the basins of all earlier neighbours of each candidate. Where vertices point to their earliest neighbours, joins lead to
/// the other basins in the order in which the first neighbours in these enter.
fn joins_of_graph<G: Graph, S: Scalar, D: Direction>(
    graph: G,
    filtration: &Filtration<'_, S, D>,
    descent: &Descent,
    candidates: &[u32],
    pointing: Pointing,
) -> Vec<Join> {
    let (mut joins, mut others) = (Vec::new(), Vec::new());
    for &saddle in candidates.chunks(parallel::BLOCK).take_while(|_| !filtration.stops()).flatten() {
        let own = descent.basin(saddle);
        others.clear();
        graph.for_each_neighbor(saddle as usize, |u| {
            let u = u as u32;
            if filtration.precedes(u, saddle) {
                let basin = descent.basin(u);
                if basin != own {
                    others.push((u, basin));
                }
            }
        });
        if pointing.is_steepest() && others.len() > 1 {
            sort_by_entry(&mut others, &|u, v| filtration.compare(u, v));
        }
        joins.extend(others.iter().map(|&(_, basin)| Join { saddle, basins: [own, basin] }));
    }
    joins
}

/// Notes joins from the earliest side of a saddle to its other sides in the order in which these enter; each side a neighbour, the earliest
/// of its part of the lower link.
pub(crate) fn note_sides<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    saddle: u32,
    sides: &mut [u32],
    candidates: &mut Vec<SaddleCandidate>,
) {
    match sides {
        [a, b] if filtration.precedes(*b, *a) => candidates.push(SaddleCandidate { saddle, sides: [*b, *a] }),
        [a, b] => candidates.push(SaddleCandidate { saddle, sides: [*a, *b] }),
        _ => {
            sort_sides(sides, &|u, v| filtration.compare(u, v));
            candidates.extend(sides[1..].iter().map(|&side| SaddleCandidate { saddle, sides: [sides[0], side] }));
        }
    }
}

/// Puts neighbours, each with its basin, in the order in which they enter.
fn sort_by_entry(neighbors: &mut [(u32, u32)], compare: &dyn Fn(u32, u32) -> Ordering) {
    neighbors.sort_unstable_by(|&(u, _), &(v, _)| compare(u, v));
}

/// Puts neighbours in the order in which they enter.
fn sort_sides(sides: &mut [u32], compare: &dyn Fn(u32, u32) -> Ordering) {
    sides.sort_unstable_by(|&u, &v| compare(u, v));
}

impl Basins {
    /// Of work that is stopped.
    fn none() -> Self {
        Self { descent: Descent::new(Vec::new(), Vec::new()), joins: Vec::new(), pointing: Pointing::Any }
    }

    /// From where vertices point to and what the scans of consecutive ranges have found; nothing if one was stopped.
    pub(crate) fn new(next: Vec<u32>, scans: Vec<Scan>, pointing: Pointing, watch: Watch<'_>) -> Self {
        if watch.stops() {
            return Self::none();
        }
        let mut extrema = Vec::with_capacity(scans.iter().map(|scan| scan.extrema.len()).sum());
        scans.iter().for_each(|scan| extrema.extend_from_slice(&scan.extrema));
        let candidates: Vec<_> = scans.into_iter().map(|scan| scan.candidates).collect();
        let descent = Descent::new(next, extrema);
        if descent.is_worth_settling_for(candidates.iter().map(Vec::len).sum()) {
            descent.settle(watch);
        } else if pointing == Pointing::Labels {
            descent.shorten(watch);
        }
        let mut joins = parallel::filter_map(candidates, watch, |SaddleCandidate { saddle, sides }| {
            let basins = sides.map(|side| descent.basin(side));
            (basins[0] != basins[1]).then_some(Join { saddle, basins })
        });
        joins.shrink_to_fit(); // they are where candidates were
        Self { descent, joins, pointing }
    }

    /// From ways to any earlier neighbours and joins by rising index of the saddle.
    pub(crate) fn of_joins(descent: Descent, joins: Vec<Join>) -> Self {
        Self { descent, joins, pointing: Pointing::Any }
    }

    /// What becomes of each component, by rising index of the extremum.
    pub(crate) fn pair<S: Scalar, D: Direction>(self, filtration: &Filtration<'_, S, D>) -> Vec<Merge> {
        let Self { descent, joins, .. } = self;
        let Ended { mut merges, mut components } = elder_rule::pair(filtration, descent.extrema(), joins);
        let eldest = (0..).zip(&merges).filter(|(_, merge)| !merge.is_finite()).map(|(basin, _)| basin).collect();
        for (basin, last) in last_of_eldest(filtration, &descent, &mut components, eldest) {
            merges[basin as usize].end = last;
        }
        merges
    }

    /// The branches of the tree of components, if vertices point to their earliest neighbours.
    pub(crate) fn branch<S: Scalar, D: Direction>(self, filtration: &Filtration<'_, S, D>) -> Branched {
        let Self { descent, joins, pointing } = self;
        let (ends, mut components) = elder_rule::branch(filtration, descent.extrema(), joins);
        let mut essential = Vec::new();
        if pointing != Pointing::Labels && !filtration.stops() {
            let is_eldest = |&basin: &u32| components.find(basin) == basin;
            let eldest = (0..descent.extrema().len() as u32).filter(is_eldest).collect();
            essential = last_of_eldest(filtration, &descent, &mut components, eldest);
        }
        Branched { ends, essential, descent }
    }
}

/// Basins with the branches on them.
#[derive(Debug)]
pub(crate) struct Branched {
    /// The branches that end, in the order in which they do.
    pub(crate) ends: Vec<BranchEnd>,
    /// The basins of the others with the last vertices to enter, if not only labels are wanted.
    pub(crate) essential: Vec<(u32, u32)>,
    /// The way down from each vertex.
    pub(crate) descent: Descent,
}

/// The basins that are the eldest of a component, each with the last vertex to enter it; none if the work is stopped.
fn last_of_eldest<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    descent: &Descent,
    components: &mut UnionFind,
    eldest: Vec<u32>,
) -> Vec<(u32, u32)> {
    let last = match eldest[..] {
        _ if filtration.stops() => Vec::new(),
        [_] => last_of_all(filtration),
        _ => last_of_each(filtration, descent, components, &eldest),
    };
    eldest.into_iter().zip(last).collect()
}

/// What is left of a part of a domain once all that is final has been paired.
#[derive(Debug)]
pub(crate) struct Remnant {
    /// The pairs that are final.
    pub(crate) merges: Vec<Merge>,
    /// Edges between vertices that are left: extrema, saddles, open vertices, and the last vertex to enter each connected
    /// component. At any level the sublevel set of these has components as that of the part has, but for those that are
    /// paired and for what lies in none of them. A vertex may have an edge to itself only.
    pub(crate) edges: Vec<[u32; 2]>,
}

impl Basins {
    /// Pairs what is final whatever happens at the open vertices.
    pub(crate) fn pair_inside<S: Scalar, D: Direction>(
        self,
        filtration: &Filtration<'_, S, D>,
        open: &[u32],
    ) -> Remnant {
        let Self { descent, joins, .. } = self;
        let open: Vec<(u32, u32)> = open.iter().map(|&vertex| (descent.basin(vertex), vertex)).collect();
        let (mut merges, mut components, joins) = boruvka::pair_inside(filtration, descent.extrema(), joins, &open);
        merges.retain(Merge::is_finite);
        let extremum = |basin: u32| descent.extrema()[basin as usize];
        let mut edges = Vec::with_capacity(2 * joins.len() + open.len());
        for Join { saddle, basins } in &joins {
            edges.extend(basins.map(|basin| [*saddle, extremum(basin)]));
        }
        edges.extend(open.iter().map(|&(basin, vertex)| [vertex, extremum(components.find(basin))]));
        for Join { basins, .. } in joins {
            let [a, b] = basins.map(|basin| components.find(basin));
            if a != b {
                components.join(a, b);
            }
        }
        let roots: Vec<u32> = (0..components.len() as u32).filter(|&basin| components.find(basin) == basin).collect();
        let last = match roots[..] {
            [_] => last_of_all(filtration),
            _ => last_of_each(filtration, &descent, &mut components, &roots),
        };
        edges.extend(roots.iter().zip(last).map(|(&basin, last)| [last, extremum(basin)]));
        Remnant { merges, edges }
    }
}

/// The last vertex to enter, for the only component. Values are compared [`LANES`] abreast, which compiles to vector instructions; only
/// the stretch that has the last value is searched.
pub(crate) fn last_of_all<S: Scalar, D: Direction>(filtration: &Filtration<'_, S, D>) -> Vec<u32> {
    let later = |u: S, v: S| if D::precedes_higher_index(u, v) { v } else { u };
    let last_value = |values: &[S]| {
        let first = values.iter().copied().find(|value| !value.is_nan())?;
        let (lanes, rest) = values.as_chunks::<LANES>();
        let latest =
            lanes.iter().fold([first; LANES], |latest, values| core::array::from_fn(|i| later(latest[i], values[i])));
        Some(latest.iter().chain(rest).fold(first, |last, &value| later(last, value)))
    };
    let last_of_block = |start: usize, field: &[S]| {
        let stretches = (0..).step_by(STRETCH).zip(field.chunks(STRETCH));
        let lasts = stretches.filter_map(|(of, values)| Some((of, values, last_value(values)?)));
        // Of equal values those with higher indices enter last or, backwards, first.
        let (of, values, last) = lasts.reduce(|a, b| if D::precedes_higher_index(a.2, b.2) { b } else { a })?;
        let has_last = |value: &S| *value == last;
        let place =
            if D::KIND == Kind::Minimum { values.iter().rposition(has_last) } else { values.iter().position(has_last) };
        place.map(|place| start + of + place)
    };
    let lasts = parallel::fold_blocks(filtration.field(), &last_of_block);
    lasts.into_iter().flatten().map(|v| v as u32).reduce(|u, v| filtration.later(u, v)).into_iter().collect()
}

/// How many values are compared at once, and how many are searched for the last of them.
const LANES: usize = 8;
const STRETCH: usize = 1024;

/// The last vertex to enter the component of each basin that is the eldest of one.
fn last_of_each<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    descent: &Descent,
    components: &mut UnionFind,
    eldest: &[u32],
) -> Vec<u32> {
    let mut last = descent.extrema().to_vec();
    for v in 0..filtration.field().len() as u32 {
        if (v as usize).is_multiple_of(parallel::BLOCK) && filtration.stops() {
            break;
        }
        if let Some(basin) = descent.basin_if_any(v) {
            let last = &mut last[components.find(basin) as usize];
            *last = filtration.later(*last, v);
        }
    }
    eldest.iter().map(|&basin| last[basin as usize]).collect()
}
