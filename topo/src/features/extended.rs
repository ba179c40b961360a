//! Extended persistence of a function on a graph: components and loops, all of them paired.
//!
//! Ordinary persistence leaves the eldest component and all loops unpaired. Going up through the sublevel sets and then down
//! through the superlevel sets, relative to them, pairs these too: a minimum with the maximum of its component, and each of
//! m - n + c independent loops with the highest vertex of one that it completes on the way up and the lowest of one that it
//! completes on the way down. Cohen-Steiner, Edelsbrunner & Harer (2009), "Extending persistence using Poincaré and Lefschetz duality".
//!
//! For loops: edges enter as their later ends do, and a spanning forest is kept whose edges lie as high as can be. An edge
//! that closes a loop throws out the lowest edge of that loop; the loop is born at the upper end of the one and dies at the
//! lower end of the other. So, of edges up to any level e and down to any level f, as many pairs are made as the edges within
//! both have independent loops, which is what the ranks of the boundary matrix say.
//!
//! The forest is kept as a tree of links with a random, but fixed, priority a vertex: edges get lower towards the root,
//! and vertices rise in priority. That is what a union-find without path compression is when edges come sorted; here an edge that comes
//! late sinks in from below. Each takes O(log n) steps, expected.

use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Filtration, Rising};
use crate::options::PersistenceOptions;
use crate::persistence::{Pairs, Persistence};
use crate::scalar::Scalar;

/// A loop of a graph.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Loop<V, S> {
    /// The vertex at which it is completed on the way up, its highest.
    pub highest: V,
    /// The vertex at which it is completed on the way down, its lowest.
    pub lowest: V,
    /// The value at the highest vertex, where it is born.
    pub birth: S,
    /// The value at the lowest vertex, where it dies.
    pub death: S,
}

impl<V, S: Scalar> Loop<V, S> {
    /// |birth - death|, the height of the loop.
    pub fn persistence(&self) -> S::Width {
        self.birth.width(self.death)
    }
}

/// The four kinds of points of the extended diagram of a graph.
#[derive(Debug, Clone, PartialEq)]
pub struct Extended<V, S> {
    /// Components of sublevel sets: ordinary pairs of dimension 0. The essential classes are the extended pairs of
    /// dimension 0, from the minimum of each component of the graph to its maximum, which is the essential extremum of `maxima`.
    pub minima: Pairs<V, S>,
    /// Components of superlevel sets. The finite ones are the relative pairs of dimension 1, upside down: dead at the extremum.
    pub maxima: Pairs<V, S>,
    /// The extended pairs of dimension 1, by the order in which their highest vertices enter.
    pub loops: Vec<Loop<V, S>>,
}

impl PersistenceOptions {
    /// [`extended_persistence`](fn@crate::extended_persistence) with these options. Loops without height are counted as
    /// pairs are: dropped unless they are kept.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`].
    pub fn extended_persistence<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
    ) -> Result<Extended<G::Vertex, S>, Error> {
        let Persistence { minima, maxima } = self.persistence(domain, field)?;
        let filtration = Filtration::<S, Rising>::new(field, domain.vertex_count(), self.nan)?;
        let mut loops = loops(domain, &filtration);
        loops.retain(|ring| self.keep_zeros || ring.birth != ring.death);
        Ok(Extended { minima, maxima, loops })
    }
}

/// The extended persistence of a function on a graph, whose edges are all there is: triangles fill no loops. Repeated edges
/// make no loop. O(n log n + m log m) expected, for n vertices and m edges.
///
/// ```
/// // A letter A, with values for heights: two feet, the ends of the bar, the tip.
/// let letter = topo::Adjacency::from_edges(5, &[[0, 1], [2, 3], [1, 3], [1, 4], [3, 4]])?;
/// let extended = topo::extended_persistence(&letter, &[0.0, 2.0, 0.5, 2.5, 6.0])?;
/// let [hole] = extended.loops[..] else { panic!("there is one") };
/// assert_eq!((hole.lowest, hole.highest, hole.persistence()), (1, 4, 4.0));
/// assert_eq!(extended.minima.finite().map(|foot| foot.extremum).collect::<Vec<_>>(), [2]); // the shorter leg
/// # Ok::<(), topo::Error>(())
/// ```
///
/// # Errors
/// If the field does not fit the domain, see [`Error`].
pub fn extended_persistence<G: Domain, S: Scalar>(domain: G, field: &[S]) -> Result<Extended<G::Vertex, S>, Error> {
    PersistenceOptions::new().extended_persistence(domain, field)
}

fn loops<G: Domain, S: Scalar>(domain: G, filtration: &Filtration<'_, S, Rising>) -> Vec<Loop<G::Vertex, S>> {
    let order = filtration.order();
    let mut ranks = vec![u32::MAX; domain.vertex_count()];
    order.iter().zip(0..).for_each(|(&v, rank)| ranks[v as usize] = rank);
    let mut forest = Forest::new(order.len());
    let (mut loops, mut earlier) = (Vec::new(), Vec::new());
    let place = |rank: u32| (domain.vertex(order[rank as usize] as usize), filtration.value(order[rank as usize]));
    for (&v, rank) in order.iter().zip(0..) {
        earlier.clear();
        domain.for_each_neighbor(v as usize, |u| earlier.extend(Some(ranks[u]).filter(|&of_u| of_u < rank)));
        earlier.sort_unstable();
        earlier.dedup();
        for &low in &earlier {
            if let Some(lowest) = forest.insert(low, rank) {
                let ((highest, birth), (lowest, death)) = (place(rank), place(lowest));
                loops.push(Loop { highest, lowest, birth, death });
            }
        }
    }
    loops
}

/// A spanning forest of edges that lie as high as can be; the height of an edge is its lower end.
struct Forest {
    /// For each vertex one of higher priority, itself for a root, and the height of what joins them.
    links: Vec<(u32, u32)>,
}

impl Forest {
    fn new(n: usize) -> Self {
        Self { links: (0..n as u32).map(|v| (v, 0)).collect() }
    }

    /// Puts in the edge between a lower and an upper vertex; the height of the edge that must go, if it closes a loop.
    fn insert(&mut self, low: u32, high: u32) -> Option<u32> {
        let (mut u, mut v, mut height) = (low, high, low);
        loop {
            (u, v) = (self.climb(u, height), self.climb(v, height));
            if u == v {
                return Some(height);
            }
            if priority(u) > priority(v) {
                (u, v) = (v, u);
            }
            let (beyond, lower) = core::mem::replace(&mut self.links[u as usize], (v, height));
            if beyond == u {
                return None;
            }
            (u, v, height) = (v, beyond, lower);
        }
    }

    /// The last vertex towards the root over links no lower than a height.
    fn climb(&self, mut v: u32, height: u32) -> u32 {
        loop {
            let (beyond, of_link) = self.links[v as usize];
            if beyond == v || of_link < height {
                return v;
            }
            v = beyond;
        }
    }
}

/// A number for each vertex that looks random, no two alike (the finaliser of `MurmurHash3` is one to one).
fn priority(vertex: u32) -> u32 {
    let mut bits = vertex;
    bits = (bits ^ bits >> 16).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ bits >> 13).wrapping_mul(0xc2b2_ae35);
    bits ^ bits >> 16
}
