//! The contour tree of all vertices from their join and split tree, leaf by leaf; and the arcs between its nodes.

use super::ContourArc;
use crate::domain::Domain;
use crate::error::Error;
use crate::pairing::{NONE, UnionFind};

/// Nodes and arcs on ranks: places in the order in which vertices enter.
pub(super) struct Combined {
    /// The ranks of the nodes, rising.
    pub(super) critical: Vec<u32>,
    pub(super) arcs: Vec<ContourArc>,
    /// For each rank its arc.
    pub(super) arc_of: Vec<u32>,
}

/// The tree of a domain given all vertices that enter, in their order.
pub(super) fn combine<G: Domain>(domain: G, order: &[u32]) -> Result<Combined, Error> {
    let mut ranks = vec![NONE; domain.vertex_count()];
    order.iter().zip(0..).for_each(|(&v, rank)| ranks[v as usize] = rank);
    let join = Merging::new(domain, order, &ranks, 0..order.len() as u32, |u, v| u < v);
    let split = Merging::new(domain, order, &ranks, (0..order.len() as u32).rev(), |u, v| u > v);
    Ok(arcs_between_nodes(&edges(join, split).ok_or(Error::Loops)?, order.len()))
}

/// The join or the split tree of all vertices.
struct Merging {
    /// For each the one above (below) it whose component its own becomes; [`NONE`] for a root.
    next: Vec<u32>,
    /// How many components meet at each, without what has been taken out.
    degrees: Vec<u32>,
    /// Whether a vertex has been taken out.
    gone: Vec<bool>,
}

impl Merging {
    fn new<G: Domain>(
        domain: G,
        order: &[u32],
        ranks: &[u32],
        entering: impl Iterator<Item = u32>,
        is_earlier: impl Fn(u32, u32) -> bool,
    ) -> Self {
        let n = order.len();
        let mut components = UnionFind::new(n);
        let (mut next, mut degrees) = (vec![NONE; n], vec![0; n]);
        for v in entering {
            domain.for_each_neighbor(order[v as usize] as usize, |u| {
                let u = ranks[u];
                if u == NONE || !is_earlier(u, v) {
                    return;
                }
                // The root of a component is the last of it to have entered.
                let root = components.find(u);
                if root != v {
                    next[root as usize] = v;
                    degrees[v as usize] += 1;
                    components.join(root, v);
                }
            });
        }
        Self { next, degrees, gone: vec![false; n] }
    }

    /// The one that is left next after a leaf. At a vertex that has been taken out one component met at most, so that none is passed
    /// twice.
    fn next_left(&self, v: u32) -> Option<u32> {
        let mut next = self.next[v as usize];
        while next != NONE && self.gone[next as usize] {
            next = self.next[next as usize];
        }
        (next != NONE).then_some(next)
    }

    /// Whether a forest has this tree, given its edges, earlier end first, as their later ends enter.
    fn is_of(&self, edges: impl Iterator<Item = [u32; 2]>) -> bool {
        let mut components = UnionFind::new(self.next.len());
        let mut merges = 0;
        for [earlier, v] in edges {
            let root = components.find(earlier);
            if self.next[root as usize] != v {
                return false;
            }
            components.join(root, v);
            merges += 1;
        }
        merges == self.next.iter().filter(|&&next| next != NONE).count()
    }
}

/// The edges of the contour tree of all vertices, lower end first; `None` if no tree has these join and split trees.
///
/// Where there is one, it has a leaf: a vertex where one component meets in one tree and none in the other. Where there is none,
/// leaves run out early, or what they make has other join and split trees.
fn edges(mut join: Merging, mut split: Merging) -> Option<Vec<[u32; 2]>> {
    let n = join.next.len();
    let mut edges = Vec::with_capacity(n);
    let is_leaf = |join: &Merging, split: &Merging, v: u32| join.degrees[v as usize] + split.degrees[v as usize] == 1;
    let mut leaves: Vec<u32> = (0..n as u32).filter(|&v| is_leaf(&join, &split, v)).collect();
    while let Some(v) = leaves.pop() {
        if !is_leaf(&join, &split, v) {
            continue; // the last of its component
        }
        let is_lower = join.degrees[v as usize] == 0;
        let of = if is_lower { &mut join } else { &mut split };
        let next = of.next_left(v)?;
        of.degrees[next as usize] -= 1;
        (join.gone[v as usize], split.gone[v as usize]) = (true, true);
        edges.push(if is_lower { [v, next] } else { [next, v] });
        if is_leaf(&join, &split, next) {
            leaves.push(next);
        }
    }
    edges.sort_unstable_by_key(|&[_, upper]| upper);
    let has_join_tree = join.is_of(edges.iter().copied());
    edges.sort_unstable();
    let downwards = edges.iter().rev().map(|&[lower, upper]| [upper, lower]);
    (has_join_tree && split.is_of(downwards)).then_some(edges)
}

/// Nodes and arcs of a tree whose regular vertices have one edge down and one up, given its edges by rising lower end.
fn arcs_between_nodes(edges: &[[u32; 2]], n: usize) -> Combined {
    let (mut down, mut up) = (vec![0u32; n], vec![0u32; n]);
    edges.iter().for_each(|&[lower, upper]| {
        up[lower as usize] += 1;
        down[upper as usize] += 1;
    });
    let is_regular = |v: u32| (down[v as usize], up[v as usize]) == (1, 1);
    let critical: Vec<u32> = (0..n as u32).filter(|&v| !is_regular(v)).collect();
    let node = |v: u32| critical.partition_point(|&other| other < v);
    let mut arcs: Vec<ContourArc> = Vec::new();
    let mut arc_of = vec![NONE; n];
    for &[lower, upper] in edges {
        let arc = if is_regular(lower) { arc_of[lower as usize] } else { arcs.len() as u32 };
        if arc as usize == arcs.len() {
            arcs.push(ContourArc { lower: node(lower), upper: 0 });
        }
        if is_regular(upper) {
            arc_of[upper as usize] = arc;
        } else {
            arcs[arc as usize].upper = node(upper);
        }
    }
    label_nodes(&critical, &arcs, &mut arc_of);
    Combined { critical, arcs, arc_of }
}

/// Gives each node an arc: the only one below, or the only one above, or the first below.
fn label_nodes(critical: &[u32], arcs: &[ContourArc], arc_of: &mut [u32]) {
    let mut below = vec![(0u32, NONE); critical.len()];
    let mut above = below.clone();
    for (arc, number) in arcs.iter().zip(0..) {
        for (count, first) in [&mut below[arc.upper], &mut above[arc.lower]] {
            *count += 1;
            *first = if *count == 1 { number } else { *first };
        }
    }
    for ((&v, below), above) in critical.iter().zip(below).zip(above) {
        arc_of[v as usize] = if below.0 == 1 || above.0 != 1 && below.0 > 0 { below.1 } else { above.1 };
    }
}
