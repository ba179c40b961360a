//! The merge tree of a part of a domain relative to what it shares with others, and how a graph becomes one.
//!
//! Vertices enter one by one as in the plain sweep. Where components meet, those but the eldest that no open vertex has
//! entered are final. If more than one is left, or the vertex itself is open, it becomes a vertex of the tree; otherwise
//! nothing outside can tell it from the component that it enters. At the end the last vertex of each component is kept for
//! the range of its essential class, or, if none is open, the component is final as a whole.

use crate::error::{Error, check_vertex_count};
use crate::filtration::{Direction, Kind};
use crate::pairing::{NONE, UnionFind};
use crate::persistence::Pair;
use crate::scalar::Scalar;

/// A vertex that is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Place<S> {
    /// Its index in the whole domain.
    pub(super) name: u64,
    pub(super) value: S,
    /// How many of the blocks that have it are joined, and how many there are; zeros if what the others hold does not matter.
    pub(super) blocks: [u32; 2],
}

impl<S> Place<S> {
    /// Whether a block that has it is missing.
    pub(super) fn is_open(&self) -> bool {
        self.blocks[0] < self.blocks[1]
    }
}

/// A forest whose sublevel sets have the components of a part's.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Reduced<S> {
    /// By rising name.
    pub(super) places: Vec<Place<S>>,
    /// For each the next one that enters its component, [`NONE`] for the last.
    pub(super) parents: Vec<u32>,
}

/// Vertices by rising name, and the edges between them.
pub(super) type Graph<S> = (Vec<Place<S>>, Vec<[u32; 2]>);

impl<S> Default for Reduced<S> {
    fn default() -> Self {
        Self { places: Vec::new(), parents: Vec::new() }
    }
}

impl<S: Scalar> Reduced<S> {
    /// The vertices of both, each once, by rising name; and the edges of both between them.
    pub(super) fn united(&self, other: &Self) -> Result<Graph<S>, Error> {
        let vertices = self.places.len() + other.places.len();
        check_vertex_count(vertices)?;
        let mut places = Vec::with_capacity(vertices);
        let mut numbers = [Vec::with_capacity(self.places.len()), Vec::with_capacity(other.places.len())];
        let mut left = [&self.places[..], &other.places[..]];
        while let Some(name) = left.iter().filter_map(|places| places.first()).map(|place| place.name).min() {
            let number = places.len() as u32;
            let mut of_name = None;
            for (left, numbers) in left.iter_mut().zip(&mut numbers) {
                if let [place, rest @ ..] = *left
                    && place.name == name
                {
                    *left = rest;
                    numbers.push(number);
                    of_name = Some(of_name.map_or(Ok(*place), |other| same(&other, place))?);
                }
            }
            places.extend(of_name);
        }
        let edges = [self, other].into_iter().zip(&numbers).flat_map(|(tree, numbers)| tree.edges(numbers));
        let edges = edges.collect();
        Ok((places, edges))
    }

    /// The edges of the tree where vertices have other numbers.
    fn edges<'a>(&'a self, numbers: &'a [u32]) -> impl Iterator<Item = [u32; 2]> + 'a {
        let with_parent = self.parents.iter().zip(numbers).filter(|&(&parent, _)| parent != NONE);
        with_parent.map(|(&parent, &number)| [number, numbers[parent as usize]])
    }
}

/// A vertex as two parts have it.
fn same<S: Scalar>(a: &Place<S>, b: &Place<S>) -> Result<Place<S>, Error> {
    let ([joined, all], [more, all_too]) = (a.blocks, b.blocks);
    let joined = joined.saturating_add(more);
    let agree = a.value == b.value && all == all_too && joined <= all;
    let blocks = if joined < all { [joined, all] } else { [0; 2] };
    agree.then_some(Place { blocks, ..*a }).ok_or(Error::Shared { vertex: a.name })
}

/// Reduces a graph, given its vertices by rising name: its tree, and the pairs that are final.
pub(super) fn reduce<S: Scalar, D: Direction>(
    places: &[Place<S>],
    edges: &[[u32; 2]],
) -> (Reduced<S>, Vec<Pair<u64, S>>) {
    let mut order: Vec<(Option<S::Key>, u32)> =
        places.iter().zip(0..).map(|(place, v)| (place.value.key(), v)).collect();
    order.sort_unstable();
    if D::KIND == Kind::Maximum {
        order.reverse();
    }
    let mut ranks = vec![0; places.len()];
    order.iter().zip(0..).for_each(|(&(_, v), rank)| ranks[v as usize] = rank);
    let mut edges: Vec<[u32; 2]> = edges.iter().map(|edge| edge.map(|v| ranks[v as usize])).collect();
    edges.iter_mut().for_each(|[late, early]| (*late, *early) = (*late.max(early), *late.min(early)));
    edges.retain(|[late, early]| late != early);
    edges.sort_unstable();
    edges.dedup();
    let entering: Vec<Place<S>> = order.iter().map(|&(_, v)| places[v as usize]).collect();
    let mut sweep = Sweep::new(&entering);
    let mut rest = &edges[..];
    for v in 0..entering.len() as u32 {
        let count = rest.iter().take_while(|[late, _]| *late == v).count();
        sweep.enter(v, rest[..count].iter().map(|&[_, early]| early));
        rest = &rest[count..];
    }
    sweep.end();
    sweep.into_tree(&ranks)
}

/// Vertices by rank in the order in which they enter.
struct Sweep<'a, S> {
    places: &'a [Place<S>],
    components: UnionFind,
    /// For each eldest vertex of a component the last of it that is kept, the last of it at all, and whether it is open.
    tops: Vec<u32>,
    lasts: Vec<u32>,
    open: Vec<bool>,
    kept: Vec<bool>,
    parents: Vec<u32>,
    /// The components that meet at the vertex that enters.
    meeting: Vec<u32>,
    pairs: Vec<Pair<u64, S>>,
}

impl<'a, S: Scalar> Sweep<'a, S> {
    fn new(places: &'a [Place<S>]) -> Self {
        let n = places.len();
        Self {
            places,
            components: UnionFind::new(n),
            tops: (0..n as u32).collect(),
            lasts: (0..n as u32).collect(),
            open: places.iter().map(Place::is_open).collect(),
            kept: vec![false; n],
            parents: vec![NONE; n],
            meeting: Vec::new(),
            pairs: Vec::new(),
        }
    }

    fn enter(&mut self, v: u32, earlier: impl Iterator<Item = u32>) {
        let mut meeting = core::mem::take(&mut self.meeting);
        meeting.clear();
        meeting.extend(earlier.map(|u| self.components.find(u)));
        meeting.sort_unstable();
        meeting.dedup();
        match meeting[..] {
            [] => self.kept[v as usize] = true,
            [eldest, ..] => self.meet(v, eldest, &mut meeting),
        }
        self.meeting = meeting;
    }

    /// Lets components meet at a vertex, the eldest first.
    fn meet(&mut self, v: u32, eldest: u32, meeting: &mut Vec<u32>) {
        self.components.join(v, eldest);
        meeting.retain(|&component| {
            let is_final = component != eldest && !self.open[component as usize];
            if is_final {
                // What is not open has no vertex in the tree but its extremum.
                self.kept[component as usize] = false;
                self.pair(component, Some(v), v);
            }
            if component != eldest {
                self.components.join(component, eldest);
            }
            !is_final
        });
        if meeting.len() > 1 || self.open[v as usize] {
            self.kept[v as usize] = true;
            meeting.iter().for_each(|&component| self.parents[self.tops[component as usize] as usize] = v);
            self.tops[eldest as usize] = v;
            // Several are left only if all but the eldest are open.
            self.open[eldest as usize] = true;
        }
        self.lasts[eldest as usize] = v;
    }

    /// Settles what becomes of the components that are left.
    fn end(&mut self) {
        for v in 0..self.places.len() as u32 {
            if self.components.find(v) != v {
                continue;
            }
            let last = self.lasts[v as usize];
            if !self.open[v as usize] {
                self.kept[v as usize] = false;
                self.pair(v, None, last);
            } else if self.tops[v as usize] != last {
                self.kept[last as usize] = true;
                self.parents[self.tops[v as usize] as usize] = last;
            }
        }
    }

    fn pair(&mut self, extremum: u32, saddle: Option<u32>, end: u32) {
        let place = |v: u32| self.places[v as usize];
        let (born, saddle) = (place(extremum), saddle.map(|saddle| place(saddle).name));
        self.pairs.push(Pair { extremum: born.name, saddle, birth: born.value, end: place(end).value });
    }

    /// The vertices that are kept, by rising name, given the rank of each name.
    fn into_tree(self, ranks: &[u32]) -> (Reduced<S>, Vec<Pair<u64, S>>) {
        let kept: Vec<u32> = ranks.iter().copied().filter(|&rank| self.kept[rank as usize]).collect();
        let mut numbers = vec![NONE; ranks.len()];
        kept.iter().zip(0..).for_each(|(&rank, number)| numbers[rank as usize] = number);
        let parent = |&rank: &u32| numbers.get(self.parents[rank as usize] as usize).copied().unwrap_or(NONE);
        let places = kept.iter().map(|&rank| self.places[rank as usize]).collect();
        (Reduced { places, parents: kept.iter().map(parent).collect() }, self.pairs)
    }
}
