//! Leaves pruned from a contour tree, the lowest arc first.

use super::ContourArc;
use crate::pairing::NONE;
use crate::scalar::{Scalar, wider_first};
use core::cmp::Ordering;
use std::collections::BinaryHeap;

/// What is left.
pub(super) struct Pruned {
    /// The nodes, rising.
    pub(super) nodes: Vec<usize>,
    /// The arcs between them, in the numbers of all nodes.
    pub(super) arcs: Vec<ContourArc>,
    /// For each arc of the tree the one that it has become a part of, or has been given to.
    pub(super) arc_of: Vec<u32>,
}

/// A leaf that may be pruned, lower arcs first.
struct Leaf<W> {
    height: W,
    node: usize,
    arc: usize,
}

impl<W: PartialOrd> Ord for Leaf<W> {
    fn cmp(&self, other: &Self) -> Ordering {
        wider_first(&self.height, &other.height).then(other.node.cmp(&self.node)).then(other.arc.cmp(&self.arc))
    }
}

impl<W: PartialOrd> PartialOrd for Leaf<W> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<W: PartialOrd> PartialEq for Leaf<W> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<W: PartialOrd> Eq for Leaf<W> {}

/// Prunes a tree given the value of each node.
pub(super) fn prune<S: Scalar>(values: &[S], arcs: &[ContourArc], threshold: S::Width) -> Pruned {
    let mut tree = Tree::new(values, arcs);
    let mut leaves: BinaryHeap<Leaf<S::Width>> = (0..values.len()).filter_map(|node| tree.leaf(node)).collect();
    while let Some(Leaf { height, node, arc }) = leaves.pop() {
        if height > threshold {
            break;
        }
        // It may have been joined to another arc since, or have become the only arc on its side.
        if tree.leaf(node).is_none_or(|leaf| leaf.arc != arc || leaf.height > height) {
            continue;
        }
        let around = tree.prune(node, arc);
        leaves.extend(around.into_iter().filter_map(|node| tree.leaf(node)));
    }
    tree.into_pruned()
}

/// The arcs on one side of a node: their number, and all their numbers in one, which tells the last of them.
#[derive(Clone, Copy, Default)]
struct Side {
    count: usize,
    xor: usize,
}

impl Side {
    fn add(&mut self, arc: usize) {
        (self.count, self.xor) = (self.count + 1, self.xor ^ arc);
    }

    fn remove(&mut self, arc: usize) {
        (self.count, self.xor) = (self.count - 1, self.xor ^ arc);
    }

    fn only(self) -> Option<usize> {
        (self.count == 1).then_some(self.xor)
    }
}

struct Tree<'a, S> {
    values: &'a [S],
    arcs: Vec<ContourArc>,
    /// For each node the arcs that end there, and those that begin there.
    below: Vec<Side>,
    above: Vec<Side>,
    /// To what each arc, and then each [side](Self::side) of each node, has gone: itself if it is left.
    into: Vec<usize>,
    is_node: Vec<bool>,
}

impl<'a, S: Scalar> Tree<'a, S> {
    fn new(values: &'a [S], arcs: &[ContourArc]) -> Self {
        let (mut below, mut above) = (vec![Side::default(); values.len()], vec![Side::default(); values.len()]);
        for (number, arc) in arcs.iter().enumerate() {
            below[arc.upper].add(number);
            above[arc.lower].add(number);
        }
        let into = (0..arcs.len() + 2 * values.len()).collect();
        Self { values, arcs: arcs.to_vec(), below, above, into, is_node: vec![true; values.len()] }
    }

    /// The place of what pruned arcs leave below (0) or above (1) a node.
    fn side(&self, node: usize, side: usize) -> usize {
        self.arcs.len() + 2 * node + side
    }

    /// A node as a leaf that may be pruned: it has one arc, and the arc is not the only one on its side of the other end.
    fn leaf(&self, node: usize) -> Option<Leaf<S::Width>> {
        let (below, above) = (self.below[node], self.above[node]);
        let arc = Side { count: below.count + above.count, xor: below.xor ^ above.xor }.only()?;
        let ContourArc { lower, upper } = self.arcs[arc];
        let beside = if node == upper { self.above[lower] } else { self.below[upper] };
        (beside.count > 1).then_some(Leaf { height: self.height(arc), node, arc })
    }

    fn height(&self, arc: usize) -> S::Width {
        self.values[self.arcs[arc].lower].width(self.values[self.arcs[arc].upper])
    }

    /// Takes a leaf off, and returns nodes that may have become leaves, or have a longer arc.
    fn prune(&mut self, leaf: usize, arc: usize) -> [usize; 2] {
        let ContourArc { lower, upper } = self.arcs[arc];
        self.below[upper].remove(arc);
        self.above[lower].remove(arc);
        self.remove_node(leaf, arc);
        let (inner, side) = if leaf == upper { (lower, 1) } else { (upper, 0) };
        self.into[arc] = self.side(inner, side);
        match (self.below[inner].only(), self.above[inner].only()) {
            (Some(below), Some(above)) => self.remove_regular(inner, below, above),
            _ => [inner, leaf],
        }
    }

    /// Makes one arc of those below and above a node, and returns its ends.
    fn remove_regular(&mut self, node: usize, below: usize, above: usize) -> [usize; 2] {
        let end = self.arcs[above].upper;
        self.remove_node(node, below);
        self.into[above] = below;
        self.arcs[below].upper = end;
        self.below[end].remove(above);
        self.below[end].add(below);
        [self.arcs[below].lower, end]
    }

    /// Takes a node away that lies on an arc from now on.
    fn remove_node(&mut self, node: usize, arc: usize) {
        self.is_node[node] = false;
        for side in 0..2 {
            let place = self.side(node, side);
            self.into[place] = arc;
        }
    }

    fn into_pruned(mut self) -> Pruned {
        let mut left: Vec<usize> = (0..self.arcs.len()).filter(|&arc| self.into[arc] == arc).collect();
        left.sort_by_key(|&arc| (self.arcs[arc].lower, self.arcs[arc].upper));
        let mut places = vec![NONE; self.arcs.len()];
        left.iter().zip(0..).for_each(|(&arc, place)| places[arc] = place);
        left.iter().for_each(|&arc| self.offer(arc));
        let arc_of = (0..self.arcs.len()).map(|arc| places[self.last(arc)]).collect();
        Pruned {
            nodes: (0..self.is_node.len()).filter(|&node| self.is_node[node]).collect(),
            arcs: left.iter().map(|&arc| self.arcs[arc]).collect(),
            arc_of,
        }
    }

    /// Gives an arc what was left on its sides of its ends, unless there is a longer one, or an earlier as long.
    fn offer(&mut self, arc: usize) {
        let ContourArc { lower, upper } = self.arcs[arc];
        for place in [self.side(lower, 1), self.side(upper, 0)] {
            let other = self.into[place];
            if other == place || self.height(arc) > self.height(other) {
                self.into[place] = arc;
            }
        }
    }

    /// The arc to which an arc has gone in the end.
    fn last(&mut self, mut place: usize) -> usize {
        while self.into[place] != place {
            self.into[place] = self.into[self.into[place]];
            place = self.into[place];
        }
        place
    }
}
