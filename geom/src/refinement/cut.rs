//! One triangle and the input's edges across it.
//!
//! An input edge runs straight through the triangle, so how often each side is crossed tells all of its combinatorics
//! (normal coordinates; Gillespie, Sharp & Crane 2021, §3): *arcs* go round a corner, from one of its sides to the other, and
//! a *fan* leaves at most one corner and ends on the side opposite. Between them lie *cells*, each a convex part of one input
//! triangle.
//!
//! ```text
//!            k
//!           ╱│╲           side s runs from corner s to s + 1; the crossings of a side are in its order
//!          ╱╲│ ╲          round corner s, arc m joins crossing m of side s to crossing m from the end of side s + 2
//!         ╱  │  ╲         the fan of corner s ends on side s + 1, between its arcs
//!        ╱──╲│   ╲
//!       i────────j
//! ```

use super::plane::{Point, between, is_left};
use crate::mesh::{HalfedgeId, Triangulation};

/// Where an input edge crosses the side of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// The input's halfedge that comes in here: from the right of the side to its left.
    pub(super) halfedge: HalfedgeId,
    /// How far along that halfedge, from 0 to 1.
    pub(super) along: f64,
    /// How far along the side, from 0 to 1.
    pub(super) at: f64,
}

impl Crossing {
    /// The same as seen from the other side.
    pub(super) fn reversed(self, input: &Triangulation) -> Self {
        let halfedge = input.twin(self.halfedge).expect("the input's boundary is crossed by nothing");
        Self { halfedge, along: 1.0 - self.along, at: 1.0 - self.at }
    }
}

/// A corner of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Node {
    /// A corner of the triangle.
    Corner(usize),
    /// A crossing of a side.
    Side(usize, usize),
}

/// A piece of an input edge inside the triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub(super) ends: [Node; 2],
    /// The input's halfedge that runs this way.
    pub(super) halfedge: HalfedgeId,
    /// How far along it both ends are.
    pub(super) along: [f64; 2],
}

impl Chord {
    pub(super) fn reversed_in(self, input: &Triangulation) -> Self {
        let [a, b] = self.ends;
        let [s, t] = self.along;
        let halfedge = input.twin(self.halfedge).expect("the input's boundary is crossed by nothing");
        Self { ends: [b, a], halfedge, along: [1.0 - t, 1.0 - s] }
    }
}

/// A part of the triangle between chords.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// Beside a corner, with so many arcs between.
    Corner(usize, usize),
    /// In the middle, behind so many chords of the fan.
    Middle(usize),
}

/// A triangle with what crosses it.
pub(super) struct Cut<'a> {
    pub(super) input: &'a Triangulation,
    /// The crossings of each side.
    pub(super) sides: [Vec<Crossing>; 3],
    /// How many arcs go round each corner.
    pub(super) arcs: [usize; 3],
    /// The corner that a fan leaves, and of how many chords.
    pub(super) fan: Option<(usize, usize)>,
}

impl<'a> Cut<'a> {
    pub(super) fn new(input: &'a Triangulation, sides: [Vec<Crossing>; 3]) -> Self {
        let (arcs, fan) = corner_counts([0, 1, 2].map(|s: usize| sides[s].len()));
        Self { input, sides, arcs, fan }
    }

    /// Where a node is, the triangle's corners given.
    pub(super) fn position(&self, corners: &[Point; 3], node: Node) -> Point {
        match node {
            Node::Corner(s) => corners[s],
            Node::Side(s, k) => between(corners[s], corners[(s + 1) % 3], self.sides[s][k].at),
        }
    }

    /// The crossing that arc `m` round corner `s` has on the side that ends there.
    pub(super) fn before(&self, s: usize, m: usize) -> Node {
        let side = (s + 2) % 3;
        Node::Side(side, self.sides[side].len() - 1 - m)
    }

    /// Arc `m` round corner `s`, which lies to its left.
    pub(super) fn arc(&self, s: usize, m: usize) -> Chord {
        let Node::Side(side, k) = self.before(s, m) else { unreachable!("it is on a side") };
        let from = self.sides[s][m];
        let along = [from.along, 1.0 - self.sides[side][k].along];
        Chord { ends: [Node::Side(s, m), Node::Side(side, k)], halfedge: from.halfedge, along }
    }

    /// Chord `m` of the fan of corner `s`, running to it; corner `s + 1` lies to its left.
    pub(super) fn spoke(&self, s: usize, m: usize) -> Chord {
        let k = self.arcs[(s + 1) % 3] + m;
        let from = self.sides[(s + 1) % 3][k];
        Chord { ends: [Node::Side((s + 1) % 3, k), Node::Corner(s)], halfedge: from.halfedge, along: [from.along, 1.0] }
    }

    /// The cell that a point lies in.
    pub(super) fn locate(&self, corners: &[Point; 3], p: Point) -> Cell {
        let on_left = |chord: Chord| {
            let [from, to] = chord.ends.map(|node| self.position(corners, node));
            is_left(from, to, p)
        };
        for s in 0..3 {
            let inside = (0..self.arcs[s]).rev().take_while(|&m| on_left(self.arc(s, m))).last();
            if let Some(m) = inside {
                return Cell::Corner(s, m);
            }
        }
        let behind = |(s, count): (usize, usize)| (0..count).take_while(|&m| !on_left(self.spoke(s, m))).count();
        Cell::Middle(self.fan.map_or(0, behind))
    }

    /// The cell at a side behind so many of its crossings.
    pub(super) fn cell_beside(&self, s: usize, before: usize) -> Cell {
        let (next, behind) = ((s + 1) % 3, self.sides[s].len() - before);
        match self.fan {
            _ if before < self.arcs[s] => Cell::Corner(s, before),
            _ if behind < self.arcs[next] => Cell::Corner(next, behind),
            // It ends on this side, leaves its start, or its end.
            Some((corner, _)) if corner == (s + 2) % 3 => Cell::Middle(before - self.arcs[s]),
            Some((corner, count)) if corner == next => Cell::Middle(count),
            _ => Cell::Middle(0),
        }
    }

    /// The chords between a corner and a cell, from the corner on, each running from right to left across the way.
    pub(super) fn chords_between(&self, corner: usize, cell: Cell) -> Vec<Chord> {
        if let Cell::Corner(s, m) = cell
            && s == corner
        {
            return (0..m).map(|m| self.arc(s, m)).collect();
        }
        let mut chords: Vec<Chord> = (0..self.arcs[corner]).map(|m| self.arc(corner, m)).collect();
        if let Some((s, count)) = self.fan {
            let behind = match cell {
                Cell::Middle(behind) => behind,
                Cell::Corner(beside, _) if beside == (s + 1) % 3 => 0,
                Cell::Corner(..) => count,
            };
            if corner == (s + 1) % 3 {
                chords.extend((0..behind).map(|m| self.spoke(s, m)));
            } else if corner == (s + 2) % 3 {
                chords.extend((behind..count).rev().map(|m| self.spoke(s, m).reversed_in(self.input)));
            }
        }
        if let Cell::Corner(s, m) = cell {
            chords.extend((m..self.arcs[s]).rev().map(|m| self.arc(s, m).reversed_in(self.input)));
        }
        chords
    }

    /// The input's halfedge that a chord at a cell's rim runs along with the cell to its left; none where no chord is.
    pub(super) fn rim(&self, cell: Cell) -> Option<HalfedgeId> {
        let other = |chord: Chord| chord.reversed_in(self.input).halfedge;
        match (cell, self.fan) {
            (Cell::Corner(s, m), _) => Some(self.arc(s, m).halfedge),
            (Cell::Middle(behind), Some((s, count))) if behind < count => Some(self.spoke(s, behind).halfedge),
            (Cell::Middle(_), Some((s, count))) => Some(other(self.spoke(s, count - 1))),
            (Cell::Middle(_), None) => {
                let s = (0..3).find(|&s| self.arcs[s] > 0)?;
                Some(other(self.arc(s, self.arcs[s] - 1)))
            }
        }
    }

    /// All cells.
    pub(super) fn cells(&self) -> impl Iterator<Item = Cell> {
        let beside = (0..3).flat_map(|s| (0..self.arcs[s]).map(move |m| Cell::Corner(s, m)));
        beside.chain((0..=self.fan.map_or(0, |(_, count)| count)).map(Cell::Middle))
    }

    /// The corners of a cell, counter-clockwise.
    pub(super) fn polygon(&self, cell: Cell) -> Vec<Node> {
        match cell {
            Cell::Corner(s, 0) => vec![Node::Corner(s), Node::Side(s, 0), self.before(s, 0)],
            Cell::Corner(s, m) => {
                vec![Node::Side(s, m - 1), Node::Side(s, m), self.before(s, m), self.before(s, m - 1)]
            }
            Cell::Middle(behind) => self.middle(behind),
        }
    }

    fn middle(&self, behind: usize) -> Vec<Node> {
        // The way round corner s, past its arcs.
        let past = |s: usize| match self.arcs[s] {
            0 => vec![Node::Corner(s)],
            count => vec![self.before(s, count - 1), Node::Side(s, count - 1)],
        };
        let Some((s, count)) = self.fan else { return (0..3).flat_map(past).collect() };
        let [left, right] = [(s + 1) % 3, (s + 2) % 3];
        let mut polygon = vec![Node::Corner(s)];
        match behind {
            0 => polygon.extend(past(left)),
            _ => polygon.push(self.spoke(s, behind - 1).ends[0]),
        }
        match behind < count {
            true => polygon.push(self.spoke(s, behind).ends[0]),
            false => polygon.extend(past(right)),
        }
        polygon
    }
}

/// How many arcs go round each corner, and which corner has a fan of how many chords, from how often each side is crossed.
pub(super) fn corner_counts(sides: [usize; 3]) -> ([usize; 3], Option<(usize, usize)>) {
    for s in 0..3 {
        let [beside, opposite, before] = [sides[s], sides[(s + 1) % 3], sides[(s + 2) % 3]];
        if opposite > beside + before {
            let mut arcs = [0; 3];
            (arcs[(s + 1) % 3], arcs[(s + 2) % 3]) = (beside, before);
            return (arcs, Some((s, opposite - beside - before)));
        }
    }
    let arcs = [0, 1, 2].map(|s: usize| (sides[s] + sides[(s + 2) % 3] - sides[(s + 1) % 3]) / 2);
    (arcs, None)
}
