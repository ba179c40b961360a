//! What Cholesky factorization will do, from the pattern of a symmetric matrix and an order of elimination alone.
//!
//! Eliminating a vertex joins its later neighbours; the earliest of them is its parent in the *elimination tree* (Liu 1990).
//! Steps that follow each other and leave nearly the same rows are eliminated together, as *supernodes*, with a few zeros
//! stored as if they were entries (Ashcraft & Grimes 1989). Steps are numbered so that each subtree is in one piece.

use super::graph::Graph;
use crate::watch::{Interrupted, Watch};

/// No step, no supernode.
pub(crate) const NONE: u32 = u32::MAX;

/// Supernodes are merged with their children if of all entries no more than this share are zeros, up to a width. (With 0.8
/// up to a width of 16 and 0.05 beyond 48, factors of 50–140 thousand vertices are larger by a seventh, and not faster.)
const RELAXED: [(u64, f64); 4] = [(4, 1.0), (16, 0.4), (48, 0.1), (u64::MAX, 0.03)];

/// An elimination of all vertices.
#[derive(Debug)]
pub(crate) struct Elimination {
    /// The vertex of each step.
    pub(crate) order: Vec<u32>,
    /// The step of each vertex.
    pub(crate) step: Vec<u32>,
    /// The supernode of each step.
    pub(crate) supernode: Vec<u32>,
    /// The first step of each supernode, and the number of all steps.
    first: Vec<u32>,
    /// The supernode of the first row of each.
    parent: Vec<u32>,
    row_start: Vec<usize>,
    row: Vec<u32>,
    row_in_parent: Vec<u32>,
    value_start: Vec<usize>,
    /// The first supernode of each one's subtree.
    subtree_start: Vec<u32>,
}

impl Elimination {
    /// Analyses an elimination in the given order, or one that comes to the same.
    pub(crate) fn new(graph: &Graph, order: &[u32], watch: Watch) -> Result<Self, Interrupted> {
        watch.ask(0.0)?;
        let (order, parent) = postordered(graph, order);
        watch.ask(0.3)?;
        let step = inverse(&order);
        let later = Later::new(graph, &order, &step);
        watch.ask(0.5)?;
        let first = supernodes(&parent, &column_counts(&later, &parent));
        watch.ask(0.7)?;
        let mut supernode = vec![0; order.len()];
        for (s, steps) in first.windows(2).enumerate() {
            supernode[steps[0] as usize..steps[1] as usize].fill(s as u32);
        }
        let last_steps = first[1..].iter().map(|end| parent[*end as usize - 1]);
        let parent = last_steps.map(|p| if p == NONE { NONE } else { supernode[p as usize] }).collect();
        let mut elimination = Self {
            order,
            step,
            supernode,
            first,
            parent,
            row_start: vec![0],
            row: Vec::new(),
            row_in_parent: Vec::new(),
            value_start: vec![0],
            subtree_start: Vec::new(),
        };
        elimination.find_subtrees();
        elimination.find_rows(&later);
        watch.ask(0.9)?;
        elimination.find_rows_in_parents();
        Ok(elimination)
    }

    /// The number of supernodes.
    pub(crate) fn len(&self) -> usize {
        self.parent.len()
    }

    /// The number of values of the factor.
    pub(crate) fn value_count(&self) -> usize {
        self.value_start[self.len()]
    }

    /// The first step of a supernode.
    pub(crate) fn first(&self, s: usize) -> usize {
        self.first[s] as usize
    }

    /// The number of steps of a supernode.
    pub(crate) fn width(&self, s: usize) -> usize {
        (self.first[s + 1] - self.first[s]) as usize
    }

    /// The supernode that one hangs on.
    pub(crate) fn parent(&self, s: usize) -> Option<usize> {
        (self.parent[s] != NONE).then_some(self.parent[s] as usize)
    }

    /// The supernodes below and at one: it is the last of them.
    pub(crate) fn subtree(&self, s: usize) -> std::ops::Range<usize> {
        self.subtree_start[s] as usize..s + 1
    }

    /// Where the values of a subtree are.
    pub(crate) fn tree_values(&self, s: usize) -> std::ops::Range<usize> {
        self.value_start[self.subtree(s).start]..self.value_start[s + 1]
    }

    /// The supernodes that hang on one, ascending. Their subtrees follow each other.
    pub(crate) fn children(&self, s: usize) -> Vec<usize> {
        self.roots_of(self.subtree(s).start..s)
    }

    /// The supernodes that hang on none, ascending.
    pub(crate) fn roots(&self) -> Vec<usize> {
        self.roots_of(0..self.len())
    }

    /// The roots of the subtrees that a range of supernodes consists of.
    fn roots_of(&self, range: std::ops::Range<usize>) -> Vec<usize> {
        let before = |end: usize| (end > range.start).then(|| end - 1);
        let mut roots: Vec<usize> =
            std::iter::successors(before(range.end), |&s| before(self.subtree(s).start)).collect();
        roots.reverse();
        roots
    }

    fn find_subtrees(&mut self) {
        self.subtree_start = (0..self.len() as u32).collect();
        for s in 0..self.len() {
            if let Some(parent) = self.parent(s) {
                self.subtree_start[parent] = self.subtree_start[parent].min(self.subtree_start[s]);
            }
        }
    }

    /// The later steps that a supernode changes, ascending.
    pub(crate) fn rows(&self, s: usize) -> &[u32] {
        &self.row[self.row_start[s]..self.row_start[s + 1]]
    }

    /// Where the rows of a supernode are among the steps and rows of its parent.
    pub(crate) fn rows_in_parent(&self, s: usize) -> &[u32] {
        &self.row_in_parent[self.row_start[s]..self.row_start[s + 1]]
    }

    /// Where the values of a supernode are: a column for each of its steps, with its steps and then its rows.
    pub(crate) fn values(&self, s: usize) -> std::ops::Range<usize> {
        self.value_start[s]..self.value_start[s + 1]
    }

    /// In which supernode the entry of two vertices is, and where among its values.
    pub(crate) fn place(&self, v: u32, w: u32) -> (usize, usize) {
        let (v, w) = (self.step[v as usize], self.step[w as usize]);
        let (column, row) = (v.min(w), v.max(w));
        let s = self.supernode[column as usize] as usize;
        let (first, end, rows) = (self.first[s], self.first[s + 1], self.rows(s));
        let width = (end - first) as usize;
        let row = if row < end { (row - first) as usize } else { width + rows.partition_point(|&r| r < row) };
        (s, (column - first) as usize * (width + rows.len()) + row)
    }

    /// The rows of a supernode are those of its columns and of its children, but for its own steps.
    fn find_rows(&mut self, later: &Later) {
        let mut seen_by = vec![NONE; self.order.len()];
        let mut children = Children::new(self.len());
        for s in 0..self.len() {
            let (from, end) = (self.first[s], self.first[s + 1]);
            let begin = self.row.len();
            let mut add = |rows: &mut Vec<u32>, r: u32| {
                if r >= end && std::mem::replace(&mut seen_by[r as usize], s as u32) != s as u32 {
                    rows.push(r);
                }
            };
            later.of_steps(from, end).iter().for_each(|&r| add(&mut self.row, r));
            for child in children.of(s) {
                for k in self.row_start[child]..self.row_start[child + 1] {
                    let r = self.row[k];
                    add(&mut self.row, r);
                }
            }
            self.row[begin..].sort_unstable();
            self.row_start.push(self.row.len());
            self.value_start.push(self.value_start[s] + self.width(s) * (self.width(s) + self.rows(s).len()));
            children.add(s, self.parent[s]);
        }
    }

    fn find_rows_in_parents(&mut self) {
        self.row_in_parent = vec![0; self.row.len()];
        for s in 0..self.len() {
            let Some(parent) = self.parent(s) else { continue };
            let (first, end) = (self.first[parent], self.first[parent + 1]);
            let above = &self.row[self.row_start[parent]..];
            let mut at = 0;
            for k in self.row_start[s]..self.row_start[s + 1] {
                let r = self.row[k];
                self.row_in_parent[k] = if r < end {
                    r - first
                } else {
                    at +=
                        above[at..].iter().position(|&x| x == r).expect("a parent has all later rows of its children");
                    end - first + at as u32
                };
            }
        }
    }
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut step = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &v)| step[v as usize] = k as u32);
    step
}

/// The children of the members of a forest.
struct Children {
    first: Vec<u32>,
    next: Vec<u32>,
}

impl Children {
    fn new(count: usize) -> Self {
        Self { first: vec![NONE; count], next: vec![NONE; count] }
    }

    /// Puts a child before the others.
    fn add(&mut self, child: usize, parent: u32) {
        if parent != NONE {
            self.next[child] = self.first[parent as usize];
            self.first[parent as usize] = child as u32;
        }
    }

    fn of(&self, parent: usize) -> impl Iterator<Item = usize> {
        let some = |child: u32| (child != NONE).then_some(child as usize);
        std::iter::successors(some(self.first[parent]), move |&child| some(self.next[child]))
    }
}

/// The later neighbours of each step.
struct Later {
    start: Vec<u32>,
    step: Vec<u32>,
}

impl Later {
    fn new(graph: &Graph, order: &[u32], step: &[u32]) -> Self {
        let mut later = Self { start: Vec::with_capacity(order.len() + 1), step: Vec::new() };
        later.step.reserve(graph.edge_count());
        later.start.push(0);
        for (k, &v) in order.iter().enumerate() {
            let steps = graph.neighbors(v).iter().map(|&w| step[w as usize]);
            later.step.extend(steps.filter(|&s| s > k as u32));
            later.start.push(later.step.len() as u32);
        }
        later
    }

    fn of_steps(&self, from: u32, end: u32) -> &[u32] {
        &self.step[self.start[from as usize] as usize..self.start[end as usize] as usize]
    }
}

/// The same elimination with each subtree of the elimination tree in one piece, children before parents; and the parents.
fn postordered(graph: &Graph, order: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let parent = elimination_tree(graph, order);
    let n = order.len();
    let mut children = Children::new(n);
    (0..n).rev().for_each(|k| children.add(k, parent[k]));
    let mut moved_to = vec![NONE; n];
    let mut done = Vec::with_capacity(n);
    let mut stack = Vec::new();
    for root in (0..n).filter(|&k| parent[k] == NONE) {
        stack.push(root as u32);
        while let Some(&k) = stack.last() {
            let child = children.first[k as usize];
            if child == NONE {
                moved_to[k as usize] = done.len() as u32;
                done.push(k);
                stack.pop();
            } else {
                children.first[k as usize] = children.next[child as usize];
                stack.push(child);
            }
        }
    }
    let up = |&k: &u32| if parent[k as usize] == NONE { NONE } else { moved_to[parent[k as usize] as usize] };
    (done.iter().map(|&k| order[k as usize]).collect(), done.iter().map(up).collect())
}

/// The parent of each step in the elimination tree, with path compression.
fn elimination_tree(graph: &Graph, order: &[u32]) -> Vec<u32> {
    let step = inverse(order);
    let mut parent = vec![NONE; order.len()];
    let mut ancestor = vec![NONE; order.len()];
    for (k, &v) in order.iter().enumerate() {
        for &w in graph.neighbors(v) {
            let mut at = step[w as usize];
            while at < k as u32 {
                let next = std::mem::replace(&mut ancestor[at as usize], k as u32);
                if next == NONE {
                    parent[at as usize] = k as u32;
                    break;
                }
                at = next;
            }
        }
    }
    parent
}

/// The number of entries below the diagonal of each column of the factor (Gilbert, Ng & Peyton 1994).
///
/// A row has entries in a subtree of the elimination tree, whose leaves are among the row's earlier neighbours. So each
/// leaf counts one for the row in all columns above it, and two leaves count one too many from where their paths meet.
fn column_counts(later: &Later, parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    let mut first_descendant: Vec<u32> = (0..n as u32).collect();
    for k in (0..n).filter(|&k| parent[k] != NONE) {
        let p = parent[k] as usize;
        first_descendant[p] = first_descendant[p].min(first_descendant[k]);
    }
    let mut count = vec![0i32; n];
    let mut ancestor: Vec<u32> = (0..n as u32).collect();
    let mut last_leaf = vec![NONE; n];
    for k in 0..n {
        if last_leaf[k] != NONE {
            // The path of the row ends here.
            count[k] -= 1;
        }
        for &row in later.of_steps(k as u32, k as u32 + 1) {
            let before = last_leaf[row as usize];
            if before == NONE || first_descendant[k] > before {
                count[k] += 1;
                last_leaf[row as usize] = k as u32;
                if before != NONE {
                    count[find(&mut ancestor, before) as usize] -= 1;
                }
            }
        }
        if parent[k] != NONE {
            ancestor[k] = parent[k];
        }
    }
    for k in (0..n).filter(|&k| parent[k] != NONE) {
        count[parent[k] as usize] += count[k];
    }
    count.into_iter().map(|count| count as u32).collect()
}

/// The root of a set, with the way to it made short.
fn find(ancestor: &mut [u32], of: u32) -> u32 {
    let mut root = of;
    while ancestor[root as usize] != root {
        root = ancestor[root as usize];
    }
    let mut at = of;
    while at != root {
        at = std::mem::replace(&mut ancestor[at as usize], root);
    }
    root
}

/// The first step of each supernode, and the number of steps. A step is merged with the supernodes of its children, from
/// the last child on, as long as few zeros are stored for it.
fn supernodes(parent: &[u32], count: &[u32]) -> Vec<u32> {
    struct Supernode {
        first: u32,
        end: u32,
        rows: u64,
        zeros: u64,
    }
    let mut done: Vec<Supernode> = Vec::new();
    for (k, &rows) in (0..).zip(count) {
        let mut new = Supernode { first: k, end: k + 1, rows: u64::from(rows), zeros: 0 };
        while let Some(child) = done.last().filter(|child| parent[child.end as usize - 1] == k) {
            let more = u64::from(child.end - child.first) * (u64::from(new.end - new.first) + new.rows - child.rows);
            let zeros = new.zeros + child.zeros + more;
            let width = u64::from(new.end - child.first);
            let entries = width * (width + 1) / 2 + width * new.rows;
            let most = RELAXED.iter().find(|(widest, _)| width <= *widest).map_or(0.0, |(_, share)| *share);
            if more > 0 && zeros as f64 > most * entries as f64 {
                break;
            }
            new = Supernode { first: child.first, zeros, ..new };
            done.pop();
        }
        done.push(new);
    }
    done.iter().map(|supernode| supernode.first).chain([parent.len() as u32]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::dissection::dissect;
    use std::collections::BTreeSet;

    /// A square grid with one diagonal in each cell, and its points.
    fn grid(side: u32) -> (Graph, Vec<[f64; 3]>) {
        let mut start = vec![0];
        let mut row = Vec::new();
        for v in 0..side * side {
            row.push(v);
            let [right, below] = [v % side + 1 < side, v / side + 1 < side];
            row.extend(right.then_some(v + 1));
            row.extend(below.then_some(v + side));
            row.extend((right && below).then_some(v + side + 1));
            start.push(row.len() as u32);
        }
        let points = (0..side * side).map(|v| [f64::from(v % side), f64::from(v / side), 0.0]).collect();
        (Graph::of_lower_triangle(&start, &row), points)
    }

    /// The rows below the diagonal of each column of the factor, by eliminating.
    fn eliminate(graph: &Graph, order: &[u32]) -> Vec<BTreeSet<u32>> {
        let step = inverse(order);
        let later = Later::new(graph, order, &step);
        let mut rows: Vec<BTreeSet<u32>> =
            (0..order.len() as u32).map(|k| later.of_steps(k, k + 1).iter().copied().collect()).collect();
        for k in 0..order.len() {
            if let Some(&parent) = rows[k].first() {
                let up: Vec<u32> = rows[k].iter().copied().filter(|&r| r != parent).collect();
                rows[parent as usize].extend(up);
            }
        }
        rows
    }

    fn shuffled(n: u32) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n).collect();
        order.sort_by_key(|v| (v * 7919 + 13) % 10_007);
        order
    }

    #[test]
    fn trees_and_counts_are_those_of_eliminating() {
        for (side, given) in [(1, false), (2, true), (7, false), (20, false), (20, true)] {
            let (graph, _) = grid(side);
            let order = if given { (0..side * side).collect() } else { shuffled(side * side) };
            let (order, parent) = postordered(&graph, &order);
            let rows = eliminate(&graph, &order);
            let count = column_counts(&Later::new(&graph, &order, &inverse(&order)), &parent);
            for (k, rows) in rows.iter().enumerate() {
                assert_eq!(parent[k], rows.first().copied().unwrap_or(NONE));
                assert_eq!(count[k] as usize, rows.len());
            }
        }
    }

    #[test]
    fn the_postorder_changes_no_fill() {
        let (graph, _) = grid(20);
        let order = shuffled(400);
        let fill = |order: &[u32]| eliminate(&graph, order).iter().map(BTreeSet::len).sum::<usize>();
        assert_eq!(fill(&order), fill(&postordered(&graph, &order).0));
    }

    #[test]
    fn supernodes_hold_every_entry_of_the_factor() {
        let (graph, points) = grid(30);
        for order in [shuffled(900), dissect(&graph, &points, Watch::NONE).unwrap()] {
            let elimination = Elimination::new(&graph, &order, Watch::NONE).unwrap();
            for (k, rows) in eliminate(&graph, &elimination.order).iter().enumerate() {
                let s = elimination.supernode[k] as usize;
                let end = (elimination.first(s) + elimination.width(s)) as u32;
                assert!(rows.iter().all(|r| *r < end || elimination.rows(s).contains(r)));
            }
        }
    }

    #[test]
    fn dissection_orders_each_vertex_once_whatever_the_points() {
        let (graph, points) = grid(50);
        for points in [points, vec![[0.0; 3]; 2500], vec![[f64::NAN, f64::INFINITY, 1.0]; 2500]] {
            let mut order = dissect(&graph, &points, Watch::NONE).unwrap();
            order.sort_unstable();
            assert!(order.into_iter().eq(0..2500));
        }
    }

    #[test]
    fn dissection_makes_the_factor_small() {
        let (graph, points) = grid(50);
        let given: Vec<u32> = (0..2500).collect();
        let entries = |order: &[u32]| eliminate(&graph, order).iter().map(BTreeSet::len).sum::<usize>();
        assert!(2 * entries(&dissect(&graph, &points, Watch::NONE).unwrap()) < entries(&given));
    }

    #[test]
    fn what_nothing_joins_is_eliminated_too() {
        let loose = Graph::of_lower_triangle(&(0..=300).collect::<Vec<u32>>(), &(0..300).collect::<Vec<u32>>());
        let elimination =
            Elimination::new(&loose, &dissect(&loose, &[[0.0; 3]; 300], Watch::NONE).unwrap(), Watch::NONE).unwrap();
        assert_eq!((elimination.order.len(), elimination.value_count() >= 300), (300, true));
        assert_eq!(Elimination::new(&Graph::of_lower_triangle(&[0], &[]), &[], Watch::NONE).unwrap().len(), 0);
    }
}
