//! Fields that lie in parts on many machines, or one part after the other in memory: persistence by blocks.
//!
//! A domain is cut into *blocks* that share vertices and together have all edges. A block is reduced to a *summary*: pairs
//! that are final whatever the other blocks hold, and the merge tree of the rest, restricted to the vertices that are
//! shared, the extrema that may still die elsewhere, and the saddles between them. Two summaries are joined where they
//! share vertices, and what has become final is paired. Summaries form a commutative monoid: they may be joined in any
//! order and grouping, neighbours or not, and in the end the pairs are those of the domain in one piece, vertex by vertex.
//!
//! A pair is final as soon as its component dies before a vertex enters it that is shared with a block not yet joined:
//! until then nothing outside can touch it, and one elder component at the saddle is enough. The rest is a tree whose
//! sublevel sets have the components of the block's, so joining the blocks is joining the trees. Distributed merge trees are
//! due to Morozov & Weber (2013), "Distributed merge trees"; here nothing but pairs is wanted, so that what is final goes
//! and only the border stays. On grids a shared vertex with an earlier neighbour that is shared by the same blocks, or by
//! more, is left out too: blocks that agree at the neighbour agree at it.
//!
//! **Size.** A summary has at most three vertices for each shared one that is kept, and two for each *step*: an extremum
//! beyond a saddle that leads from a shared component to an elder one. Steps in a row are extrema that rise less and less far, as
//! records of a series do: of noise there are some log n at a place, of a staircase towards the border as many as it has.
//! `tests/all/tiles.rs` has figures.
//!
//! Which vertex comes first among equal values is decided by their names in the whole domain, as in one piece.

mod block;
mod bytes;
mod order;
mod reduced;
mod tile;

pub use tile::Tile;

use crate::error::Error;
use crate::filtration::{Falling, Kind, Rising};
use crate::options::PersistenceOptions;
use crate::persistence::{Pair, Pairs};
use crate::scalar::Scalar;
use num_traits::Zero;
use reduced::{Place, Reduced, reduce};

/// The persistence of a part of a domain, as far as it is known, and what must be known to go on.
///
/// ```
/// use topo::{Connectivity, Grid, Kind, PersistenceOptions, Summary, Tile};
///
/// let grid = Grid::new([4, 6], Connectivity::Axis);
/// let field: Vec<u32> = (0..24).map(|v| v * v % 17).collect();
/// let options = PersistenceOptions::new();
/// let mut whole = Summary::empty(Kind::Minimum, options);
/// for tile in Tile::cut(&grid, [&[2, 2], &[3, 1, 2]])? {
///     let values = tile.values(&field)?; // on another machine these would be read
///     whole = whole.join(Summary::of_tile(&tile, &values, Kind::Minimum, options)?)?;
/// }
/// let in_one_piece = topo::sublevel(&grid, &field)?;
/// assert!(whole.finish()?.iter().map(|pair| pair.extremum).eq(in_one_piece.iter().map(|pair| pair.extremum as u64)));
/// # Ok::<(), topo::Error>(())
/// ```
///
/// With the feature `serde` summaries are written and read; [`to_bytes`](Self::to_bytes) needs no feature.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(deserialize = "S: Scalar + serde::Deserialize<'de>"), try_from = "bytes::Unchecked<S>")
)]
pub struct Summary<S> {
    kind: Kind,
    keep_zeros: bool,
    /// Final pairs that have not been taken, by rising name of the extremum.
    pairs: Vec<Pair<u64, S>>,
    /// Final pairs of zero persistence that have not been taken, kept or not.
    zero_count: usize,
    tree: Reduced<S>,
}

impl<S: Scalar> Summary<S> {
    /// The summary of nothing, which changes none that it is joined with.
    pub fn empty(kind: Kind, options: PersistenceOptions) -> Self {
        let (pairs, tree) = (Vec::new(), Reduced::default());
        Self { kind, keep_zeros: options.keep_zeros, pairs, zero_count: 0, tree }
    }

    /// The summary of both. Takes O(n log n) for the n vertices that the two still have, and moves the pairs that have not
    /// been [taken](Self::take_pairs).
    ///
    /// # Errors
    /// If directions or options differ, or the two do not agree on a vertex that they share, or both have the same final pair, as where a
    /// block is part of both.
    pub fn join(self, other: Self) -> Result<Self, Error> {
        if (self.kind, self.keep_zeros) != (other.kind, other.keep_zeros) {
            return Err(Error::Summaries);
        }
        let (places, edges) = self.tree.united(&other.tree)?;
        let pairs = [self.pairs, other.pairs].concat();
        // What is read as bytes may claim any number.
        let zero_count = self.zero_count.saturating_add(other.zero_count);
        let mut joined = Self { pairs, zero_count, tree: Reduced::default(), ..self };
        joined.reduce(&places, &edges);
        match joined.pairs.windows(2).find(|two| two[0].extremum == two[1].extremum) {
            Some(two) => Err(Error::JoinedTwice { vertex: two[0].extremum }),
            None => Ok(joined),
        }
    }

    /// All pairs that have not been [taken](Self::take_pairs), by rising name of the extremum: once all blocks are joined,
    /// those of the whole domain.
    ///
    /// # Errors
    /// If a block is missing.
    pub fn finish(mut self) -> Result<Pairs<u64, S>, Error> {
        match self.tree.places.iter().find(|place| place.is_open()) {
            Some(place) => Err(Error::Unfinished { vertex: place.name }),
            None => Ok(self.take_pairs()),
        }
    }

    /// Takes the pairs that are final out of the summary, by rising name of the extremum, so that they need not be carried to
    /// the next join. Pairs once taken come no second time.
    pub fn take_pairs(&mut self) -> Pairs<u64, S> {
        Pairs::new(self.kind, core::mem::take(&mut self.pairs), core::mem::take(&mut self.zero_count))
    }

    /// Whether the extrema are minima or maxima.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Number of final pairs that have not been taken.
    pub fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// Number of vertices that are kept because what happens there is not final.
    pub fn vertex_count(&self) -> usize {
        self.tree.places.len()
    }

    /// Number of vertices kept that blocks share which have not been joined.
    pub fn shared_count(&self) -> usize {
        self.tree.places.iter().filter(|place| place.is_open()).count()
    }

    /// Whether all blocks have been joined that share a vertex with one that has.
    pub fn is_complete(&self) -> bool {
        self.shared_count() == 0
    }

    /// Reduces a graph to the tree, and adds the pairs that are final.
    fn reduce(&mut self, places: &[Place<S>], edges: &[[u32; 2]]) {
        let (tree, pairs) = match self.kind {
            Kind::Minimum => reduce::<S, Rising>(places, edges),
            Kind::Maximum => reduce::<S, Falling>(places, edges),
        };
        self.tree = tree;
        self.add(pairs);
    }

    /// Adds final pairs, and those of zero persistence only if they are to be kept.
    fn add(&mut self, mut pairs: Vec<Pair<u64, S>>) {
        pairs.retain(|pair| {
            let is_zero = !pair.is_essential() && pair.persistence().is_zero();
            self.zero_count = self.zero_count.saturating_add(usize::from(is_zero));
            self.keep_zeros || !is_zero
        });
        self.pairs.append(&mut pairs);
        self.pairs.sort_by_key(|pair| pair.extremum);
    }
}
