//! The neighbourhood of a grid vertex, and which neighbours are connected.
//!
//! A stencil is a list of offsets. The vertices earlier than the centre are a set of bits, one an offset, and two of
//! them are adjacent if their difference is an edge of the grid. A vertex is *regular* if its earlier neighbours, its
//! *lower link*, are connected; that is all a scan asks, and it is looked up in a table of one bit for each set.
//!
//! With [`Connectivity::Axis`] no two neighbours are adjacent, and half of all vertices of a smooth field would look
//! like saddles. So the stencil also has the vertices diagonally across a square: not neighbours, but adjacent to two
//! of them, and if earlier they show that both lie in one component. The same table does it.

use std::sync::OnceLock;

/// Which vertices of a grid are neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Connectivity {
    /// Along one axis: 2, 4 or 6 neighbours.
    Axis,
    /// Along any number of axes: 2, 8 or 26 neighbours.
    Full,
    /// Edges of the Freudenthal triangulation, whose offsets are {0, 1}ᵈ and their opposites: 2, 6 or 14 neighbours.
    /// The choice for sampled smooth functions, as sub- and superlevel sets then fit together.
    Freudenthal,
}

/// A step along (z, y, x).
pub(crate) type Offset = [i8; 3];

/// Sets of more offsets than this are flooded anew for each vertex; below, a table of 2ⁿ bits (32 KB) is filled once.
const MAX_TABLE_BITS: usize = 18;

/// Parts of sets of more offsets than this are flooded anew; below, two tables of 2ⁿ words (1 KB) are filled once.
const MAX_PART_BITS: usize = 8;

/// Neighbours of a grid vertex, one bit each, true neighbours first.
#[derive(Debug)]
pub(crate) struct Stencil {
    pub(crate) offsets: Vec<Offset>,
    neighbor_bits: u32,
    /// For each offset the set of those adjacent to it.
    adjacent: Vec<u32>,
    /// One bit for each set of offsets: whether its neighbours are not connected.
    splits: Vec<u64>,
    /// For each set of few offsets one neighbour of each part.
    parts: Vec<u32>,
    /// For each set of few offsets its first part.
    first_parts: Vec<u32>,
}

impl Stencil {
    /// The stencil of a connectivity in one to three dimensions; made at first use.
    pub(crate) fn of(connectivity: Connectivity, dimensions: usize) -> &'static Self {
        static STENCILS: [OnceLock<Stencil>; 9] = [const { OnceLock::new() }; 9];
        STENCILS[3 * connectivity as usize + dimensions - 1].get_or_init(|| Self::new(connectivity, dimensions))
    }

    fn new(connectivity: Connectivity, dimensions: usize) -> Self {
        let mut offsets = cube(dimensions);
        offsets.retain(|&offset| is_edge(connectivity, offset));
        let neighbor_bits = low_bits(offsets.len());
        if connectivity == Connectivity::Axis {
            offsets.extend(cube(dimensions).into_iter().filter(|offset| steps(*offset) == 2));
        }
        let adjacent_to = |&a: &Offset| {
            let adjacent = (0..).zip(&offsets).filter(|&(_, &b)| is_edge(connectivity, difference(a, b)));
            adjacent.fold(0, |set, (bit, _)| set | 1 << bit)
        };
        let adjacent = offsets.iter().map(adjacent_to).collect();
        let mut stencil =
            Self { offsets, neighbor_bits, adjacent, splits: Vec::new(), parts: Vec::new(), first_parts: Vec::new() };
        if stencil.offsets.len() <= MAX_TABLE_BITS {
            stencil.fill_table();
        }
        if stencil.offsets.len() <= MAX_PART_BITS {
            let sets = 0..1 << stencil.offsets.len();
            stencil.parts = sets.clone().map(|set| stencil.parts_by_flooding(set)).collect();
            stencil.first_parts = sets.map(|set| stencil.first_part_by_flooding(set)).collect();
        }
        stencil
    }

    fn fill_table(&mut self) {
        let mut splits = vec![0; (1 << self.offsets.len()).max(64) / 64];
        for set in 0..1u32 << self.offsets.len() {
            splits[set as usize / 64] |= u64::from(self.splits_by_flooding(set)) << (set % 64);
        }
        self.splits = splits;
    }

    /// The true neighbours of a set of offsets.
    pub(crate) fn neighbors(&self, set: u32) -> u32 {
        set & self.neighbor_bits
    }

    /// Whether the neighbours in a set are not connected: whether something may merge there.
    #[inline]
    pub(crate) fn splits(&self, set: u32) -> bool {
        match self.splits.get(set as usize / 64) {
            Some(word) => word >> (set % 64) & 1 != 0,
            None => self.splits_by_flooding(set),
        }
    }

    fn splits_by_flooding(&self, set: u32) -> bool {
        let neighbors = self.neighbors(set);
        neighbors != 0 && neighbors & !self.component(set, neighbors.trailing_zeros()) != 0
    }

    /// One neighbour, the first, of each part of the neighbours in a set.
    #[inline]
    pub(crate) fn parts(&self, set: u32) -> u32 {
        self.parts.get(set as usize).copied().unwrap_or_else(|| self.parts_by_flooding(set))
    }

    fn parts_by_flooding(&self, set: u32) -> u32 {
        let (mut rest, mut parts) = (self.neighbors(set), 0);
        while rest != 0 {
            let first = rest.trailing_zeros();
            parts |= 1 << first;
            rest &= !self.component(set, first);
        }
        parts
    }

    /// The first part of the neighbours in a set; none if there is none.
    #[inline]
    pub(crate) fn first_part(&self, set: u32) -> u32 {
        self.first_parts.get(set as usize).copied().unwrap_or_else(|| self.first_part_by_flooding(set))
    }

    fn first_part_by_flooding(&self, set: u32) -> u32 {
        let neighbors = self.neighbors(set);
        if neighbors == 0 { 0 } else { self.neighbors(self.component(set, neighbors.trailing_zeros())) }
    }

    /// The connected component of one of the bits of a set.
    fn component(&self, set: u32, bit: u32) -> u32 {
        let mut reached = 1u32 << bit;
        let mut spread = 0;
        // Mostly the set is connected, and found to be so after very few of its bits.
        while reached != set && reached != spread {
            let fresh = (reached & !spread).trailing_zeros();
            spread |= 1 << fresh;
            reached |= self.adjacent[fresh as usize] & set;
        }
        reached
    }
}

/// All offsets but zero in -1..=1 along the last `dimensions` axes, first those along one axis, which have most
/// neighbours among the others.
fn cube(dimensions: usize) -> Vec<Offset> {
    let span = |axis: usize| if axis + dimensions >= 3 { -1..=1i8 } else { 0..=0 };
    let offsets = span(0).flat_map(|z| span(1).flat_map(move |y| span(2).map(move |x| [z, y, x])));
    let mut offsets: Vec<Offset> = offsets.filter(|&offset| offset != [0; 3]).collect();
    offsets.sort_by_key(|&offset| steps(offset));
    offsets
}

fn is_edge(connectivity: Connectivity, offset: Offset) -> bool {
    let short = offset != [0; 3] && offset.iter().all(|step| step.abs() <= 1);
    short
        && match connectivity {
            Connectivity::Axis => steps(offset) == 1,
            Connectivity::Full => true,
            // The edges of the Freudenthal triangulation go up, or down, along every axis they go along.
            Connectivity::Freudenthal => offset.iter().all(|&step| step >= 0) || offset.iter().all(|&step| step <= 0),
        }
}

/// Number of axes along which an offset goes.
fn steps(offset: Offset) -> usize {
    offset.iter().filter(|&&step| step != 0).count()
}

fn difference(a: Offset, b: Offset) -> Offset {
    core::array::from_fn(|axis| b[axis] - a[axis])
}

fn low_bits(count: usize) -> u32 {
    (1 << count) - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use Connectivity::{Axis, Freudenthal, Full};

    #[test]
    fn vertices_have_as_many_neighbors_as_the_names_say() {
        let counts = |connectivity| [1, 2, 3].map(|d| Stencil::of(connectivity, d).neighbor_bits.count_ones());
        assert_eq!(counts(Axis), [2, 4, 6]);
        assert_eq!(counts(Full), [2, 8, 26]);
        assert_eq!(counts(Freudenthal), [2, 6, 14]);
    }

    #[test]
    fn opposite_neighbors_split() {
        for connectivity in [Axis, Full, Freudenthal] {
            for dimensions in 1..=3 {
                let stencil = Stencil::of(connectivity, dimensions);
                let bit = |offset| 1 << stencil.offsets.iter().position(|&other| other == offset).expect("an axis");
                assert!(stencil.splits(bit([0, 0, 1]) | bit([0, 0, -1])));
                assert!(!stencil.splits(bit([0, 0, 1])));
                assert!(!stencil.splits(0));
            }
        }
    }

    #[test]
    fn a_table_says_what_flooding_says() {
        for connectivity in [Axis, Full, Freudenthal] {
            for dimensions in 1..=3 {
                let stencil = Stencil::of(connectivity, dimensions);
                assert_eq!(stencil.splits.is_empty(), stencil.offsets.len() > MAX_TABLE_BITS);
                let sets = 0..1u32 << stencil.offsets.len().min(MAX_TABLE_BITS);
                assert!(sets.clone().all(|set| stencil.splits(set) == stencil.splits_by_flooding(set)));
                assert_eq!(stencil.parts.is_empty(), stencil.offsets.len() > MAX_PART_BITS);
                assert!(sets.clone().all(|set| stencil.parts(set) == stencil.parts_by_flooding(set)));
                assert!(sets.clone().all(|set| stencil.first_part(set) == stencil.first_part_by_flooding(set)));
                assert!(sets.into_iter().all(|set| stencil.splits(set) == (stencil.parts(set).count_ones() > 1)));
            }
        }
    }

    #[test]
    fn neighbors_across_an_earlier_square_hang_together() {
        let stencil = Stencil::of(Axis, 2);
        let bit = |offset| 1 << stencil.offsets.iter().position(|&other| other == offset).expect("in the square");
        let (right, below, across) = (bit([0, 0, 1]), bit([0, 1, 0]), bit([0, 1, 1]));
        assert!(stencil.splits(right | below));
        assert!(!stencil.splits(right | below | across));
    }
}
