//! The smallest set of vertices that parts the two ends of a narrow graph.
//!
//! By Menger's theorem it is as large as the greatest number of paths from one end to the other that share no vertex. Paths are
//! added one by one (Ford & Fulkerson 1956); a new one may run against older ones and cancel pieces of them. It is sought from
//! each vertex of the low end once, towards the high end first: what has been reached in vain can never be part of a path later
//! on, and is left alone from then on. In the end this is what lies before the separator, which has one vertex of each
//! path.
//!
//! A vertex on a path has two states: *in*, from where only the path's piece before it can be cancelled, and *out*, from where
//! one can go on. A vertex on no path has only *out*.

use super::graph::{Graph, Side};

/// No vertex, no path.
const NONE: u32 = u32::MAX;
/// What comes before the first vertex of a path, and after the last one.
const END: u32 = u32::MAX - 1;
/// Greater distances are not told apart.
const FARTHEST: usize = 31;

/// Parts the vertices that are given as low from those given as high by as few vertices as possible, which are
/// [`Between`](Side::Between) in the result; they may be of those given. No edge of the result joins low to high. Of the smallest
/// such sets these are the one nearest to the low end, and the one nearest to the high end.
///
/// O(edges) for each path at worst; a path mostly meets few vertices beside its own.
pub(crate) fn smallest_cuts(graph: &Graph, given: &[Side]) -> [Vec<Side>; 2] {
    let mut search = Search::new(graph, given);
    end(given, Side::Low).for_each(|v| search.add_path(v));
    let near_low = search.cut();
    // From the other end no path can be added, but what is before the separator gets known.
    search.turn();
    end(given, Side::High).for_each(|v| search.add_path(v));
    [near_low, search.cut()]
}

fn end(given: &[Side], side: Side) -> impl Iterator<Item = u32> {
    (0..).zip(given).filter(move |(_, given)| **given == side).map(|(v, _)| v)
}

/// How many edges lead from each vertex to the high end; as many as there are vertices where none do.
fn distances(graph: &Graph, given: &[Side]) -> Vec<u32> {
    let mut far = vec![given.len() as u32; given.len()];
    let mut queue: Vec<u32> = end(given, Side::High).collect();
    queue.iter().for_each(|&v| far[v as usize] = 0);
    let mut at = 0;
    while at < queue.len() {
        let v = queue[at];
        at += 1;
        for &w in graph.neighbors(v) {
            if far[w as usize] == given.len() as u32 {
                far[w as usize] = far[v as usize] + 1;
                queue.push(w);
            }
        }
    }
    far
}

/// Paths that share no vertex: what comes before and after each vertex, [`NONE`] off the paths.
struct Paths {
    before: Vec<u32>,
    after: Vec<u32>,
}

impl Paths {
    fn has(&self, v: u32) -> bool {
        self.before[v as usize] != NONE
    }

    /// Adds a path given by its states, which cancels what it runs against.
    fn add(&mut self, states: &[State]) {
        self.before[states[0].vertex as usize] = END;
        for pair in states.windows(2) {
            let (from, to) = (pair[0].vertex, pair[1].vertex);
            match (pair[0].is_out, pair[1].is_out) {
                (true, _) if from == to => {
                    self.before[from as usize] = NONE;
                    self.after[from as usize] = NONE;
                }
                (true, _) => {
                    self.after[from as usize] = to;
                    self.before[to as usize] = from;
                }
                (false, _) => {}
            }
        }
        if let Some(last) = states.last() {
            self.after[last.vertex as usize] = END;
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct State {
    vertex: u32,
    is_out: bool,
}

struct Search<'a> {
    graph: &'a Graph,
    given: &'a [Side],
    /// The end that paths are sought from.
    from: Side,
    paths: Paths,
    far: Vec<u32>,
    /// For both states of each vertex, in and out, the vertex it was reached from; [`END`] where a search began.
    reached_from: Vec<[u32; 2]>,
    /// The states of the present search.
    reached: Vec<State>,
    /// Those to go on from, by their distance to the high end.
    nearest: [Vec<State>; FARTHEST + 1],
    /// No nearer ones are left.
    least: usize,
}

impl<'a> Search<'a> {
    fn new(graph: &'a Graph, given: &'a [Side]) -> Self {
        Self {
            graph,
            given,
            from: Side::Low,
            paths: Paths { before: vec![NONE; given.len()], after: vec![NONE; given.len()] },
            far: distances(graph, given),
            reached_from: vec![[NONE; 2]; given.len()],
            reached: Vec::new(),
            nearest: [const { Vec::new() }; FARTHEST + 1],
            least: 0,
        }
    }

    /// Makes the paths run from the high end to the low one.
    fn turn(&mut self) {
        self.from = self.from.other();
        std::mem::swap(&mut self.paths.before, &mut self.paths.after);
        self.reached_from.fill([NONE; 2]);
    }

    /// Adds a path from a vertex to the other end, if there is one.
    fn add_path(&mut self, source: u32) {
        if self.paths.has(source) {
            return;
        }
        self.reached.clear();
        self.reach(State { vertex: source, is_out: true }, END);
        while let Some(State { vertex: v, is_out }) = self.pop() {
            if self.given[v as usize] == self.from.other() && !self.paths.has(v) {
                self.paths.add(&self.way_to(v));
                for &State { vertex, is_out } in &self.reached {
                    self.reached_from[vertex as usize][usize::from(is_out)] = NONE;
                }
                self.nearest.iter_mut().for_each(Vec::clear);
                return;
            }
            if is_out {
                let graph = self.graph;
                for &w in graph.neighbors(v) {
                    if self.given[w as usize] != self.from {
                        self.reach(State { vertex: w, is_out: !self.paths.has(w) }, v);
                    }
                }
                if self.paths.has(v) {
                    self.reach(State { vertex: v, is_out: false }, v);
                }
            } else if self.paths.before[v as usize] != END {
                self.reach(State { vertex: self.paths.before[v as usize], is_out: true }, v);
            }
        }
    }

    fn reach(&mut self, state: State, by: u32) {
        let reached_from = &mut self.reached_from[state.vertex as usize][usize::from(state.is_out)];
        if *reached_from == NONE {
            *reached_from = by;
            self.reached.push(state);
            let far = (self.far[state.vertex as usize] as usize).min(FARTHEST);
            self.nearest[far].push(state);
            self.least = self.least.min(far);
        }
    }

    /// A state to go on from.
    fn pop(&mut self) -> Option<State> {
        while self.least <= FARTHEST {
            if let Some(state) = self.nearest[self.least].pop() {
                return Some(state);
            }
            self.least += 1;
        }
        None
    }

    /// The states from where the search began to a vertex on no path.
    fn way_to(&self, v: u32) -> Vec<State> {
        let mut way = vec![State { vertex: v, is_out: true }];
        let mut at = way[0];
        loop {
            let by = self.reached_from[at.vertex as usize][usize::from(at.is_out)];
            if by == END {
                break;
            }
            // One comes to the out state of a vertex on a path by cancelling what follows on it.
            at = State { vertex: by, is_out: !(at.is_out && self.paths.has(at.vertex)) };
            way.push(at);
        }
        way.reverse();
        way
    }

    /// The cut at the border of what was reached in vain: the end that the search began at is what was reached.
    fn cut(&self) -> Vec<Side> {
        let side = |(v, [reached_in, reached_out]): (usize, &[u32; 2])| {
            let before = self.paths.before[v];
            if *reached_out != NONE || (self.given[v] == self.from && before == NONE) {
                self.from
            } else if *reached_in != NONE || before == END {
                Side::Between
            } else {
                self.from.other()
            }
        };
        self.reached_from.iter().enumerate().map(side).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The least number of vertices without which no low one is joined to a high one, by trying all sets.
    fn least_cut(graph: &Graph, given: &[Side]) -> u32 {
        let parts = |cut: &u32| {
            let mut seen = *cut;
            let mut stack: Vec<u32> = end(given, Side::Low).filter(|v| cut >> v & 1 == 0).collect();
            stack.iter().for_each(|v| seen |= 1 << v);
            while let Some(v) = stack.pop() {
                for &w in graph.neighbors(v).iter().filter(|&&w| seen >> w & 1 == 0).collect::<Vec<_>>() {
                    seen |= 1 << w;
                    stack.push(w);
                }
            }
            end(given, Side::High).all(|v| cut >> v & 1 == 1 || seen >> v & 1 == 0)
        };
        (0..1u32 << given.len()).filter(parts).map(u32::count_ones).min().unwrap_or(0)
    }

    proptest! {
        #[test]
        fn no_smaller_set_parts_the_ends(
            sides in prop::collection::vec(0..3usize, 1..11),
            edges in prop::collection::vec((0..10usize, 0..10usize), 0..30),
        ) {
            let given: Vec<Side> = sides.iter().map(|&k| [Side::Low, Side::High, Side::Between][k]).collect();
            let n = given.len();
            let mut near = vec![std::collections::BTreeSet::new(); n];
            for (v, w) in edges.into_iter().map(|(v, w)| (v % n, w % n)).filter(|(v, w)| v != w) {
                near[v].insert(w as u32);
                near[w].insert(v as u32);
            }
            let graph = Graph::from_rows(near.into_iter());
            let least = least_cut(&graph, &given);
            for sides in smallest_cuts(&graph, &given) {
                prop_assert_eq!(sides.iter().filter(|&&side| side == Side::Between).count() as u32, least);
                for v in 0..n as u32 {
                    let side = sides[v as usize];
                    let is_given = |side: Side| given[v as usize] == side;
                    prop_assert!(!(is_given(Side::Low) && side == Side::High || is_given(Side::High) && side == Side::Low));
                    let crosses = |&w: &u32| side == Side::Low && sides[w as usize] == Side::High;
                    prop_assert!(!graph.neighbors(v).iter().any(crosses));
                }
            }
        }
    }
}
