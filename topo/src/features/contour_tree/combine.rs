//! A contour tree from join and split tree, leaf by leaf, and the arcs between its nodes; of all vertices, which are sorted, or of those
//! that are critical in either tree (see [`critical`](super::critical)).

use super::ContourArc;
use crate::domain::Domain;
use crate::error::Error;
use crate::pairing::{NONE, UnionFind};
use crate::watch::Watch;

/// Nodes and arcs on ranks: places in the order in which vertices enter.
pub(super) struct Combined {
    /// The ranks of the nodes, rising.
    pub(super) critical: Vec<u32>,
    pub(super) arcs: Vec<ContourArc>,
    /// For each rank its arc.
    pub(super) arc_of: Vec<u32>,
}

/// The tree of a domain given all vertices that enter, in their order.
pub(super) fn combine<G: Domain>(domain: G, order: &[u32], watch: Watch<'_>) -> Result<Combined, Error> {
    let mut ranks = vec![NONE; domain.vertex_count()];
    order.iter().zip(0..).for_each(|(&v, rank)| ranks[v as usize] = rank);
    let join = Merging::new(domain, order, &ranks, 0..order.len() as u32, watch, |u, v| u < v);
    let split = Merging::new(domain, order, &ranks, (0..order.len() as u32).rev(), watch, |u, v| u > v);
    if watch.stops() {
        return Err(Error::Interrupted);
    }
    let edges = edges(join, split).ok_or(Error::Loops)?.in_order;
    Ok(arcs_between_nodes(&edges, order.len()).0)
}

/// One vertex in so many the watch is asked.
const ASKED: u32 = 1 << 15;

/// The join or the split tree of vertices.
pub(super) struct Merging {
    /// For each the one above (below) it whose component its own becomes; [`NONE`] for a root.
    next: Vec<u32>,
    /// How many components meet at each, without what has been taken out.
    degrees: Vec<u32>,
    /// Whether a vertex has been taken out.
    gone: Vec<bool>,
    /// For each the edge of the contour tree, by the order in which these are found, that its way to the next has become a part of;
    /// [`NONE`] if it has not.
    taken: Vec<u32>,
}

impl Merging {
    fn new<G: Domain>(
        domain: G,
        order: &[u32],
        ranks: &[u32],
        entering: impl Iterator<Item = u32>,
        watch: Watch<'_>,
        is_earlier: impl Fn(u32, u32) -> bool,
    ) -> Self {
        let n = order.len();
        let mut components = UnionFind::new(n);
        let (mut next, mut degrees) = (vec![NONE; n], vec![0; n]);
        for v in entering {
            if v.is_multiple_of(ASKED) && watch.stops() {
                break;
            }
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
        Self::of_next(next, degrees)
    }

    /// From the next vertex of each and how many vertices each is next to.
    pub(super) fn of_next(next: Vec<u32>, degrees: Vec<u32>) -> Self {
        let (gone, taken) = (vec![false; next.len()], vec![NONE; next.len()]);
        Self { next, degrees, gone, taken }
    }

    /// The one that is left next after a leaf; all the way there becomes a part of an edge. At a vertex that has been taken out one
    /// component met at most, so that none is passed twice.
    fn take(&mut self, leaf: u32, edge: u32) -> Option<u32> {
        let mut v = leaf;
        loop {
            self.taken[v as usize] = edge;
            v = self.next[v as usize];
            if v == NONE || !self.gone[v as usize] {
                return (v != NONE).then_some(v);
            }
        }
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

/// The edges of a contour tree, lower end first.
pub(super) struct Edges {
    /// By rising ends.
    pub(super) in_order: Vec<[u32; 2]>,
    /// For each of these as the how many-th it was found.
    pub(super) order: Vec<u32>,
    /// For each vertex the number of the edge, as found, of which its way to the next is a part in the join and in the split tree, the
    /// first of both where they differ; [`NONE`] if of none.
    pub(super) taken: [Vec<u32>; 2],
}

/// The edges of the contour tree of vertices; `None` if no tree has these join and split trees.
///
/// Where there is one, it has a leaf: a vertex where one component meets in one tree and none in the other. Where there is none,
/// leaves run out early, or what they make has other join and split trees.
pub(super) fn edges(mut join: Merging, mut split: Merging) -> Option<Edges> {
    let n = join.next.len();
    let mut found = Vec::with_capacity(n);
    let is_leaf = |join: &Merging, split: &Merging, v: u32| join.degrees[v as usize] + split.degrees[v as usize] == 1;
    let mut leaves: Vec<u32> = (0..n as u32).filter(|&v| is_leaf(&join, &split, v)).collect();
    while let Some(v) = leaves.pop() {
        if !is_leaf(&join, &split, v) {
            continue; // the last of its component
        }
        let is_lower = join.degrees[v as usize] == 0;
        let of = if is_lower { &mut join } else { &mut split };
        let next = of.take(v, found.len() as u32)?;
        of.degrees[next as usize] -= 1;
        (join.gone[v as usize], split.gone[v as usize]) = (true, true);
        found.push(if is_lower { [v, next] } else { [next, v] });
        if is_leaf(&join, &split, next) {
            leaves.push(next);
        }
    }
    let all: Vec<u32> = (0..found.len() as u32).collect();
    let by_upper = by_end(&all, n, |edge| found[edge as usize][1]);
    let has_join_tree = join.is_of(by_upper.iter().map(|&edge| found[edge as usize]));
    let order = by_end(&by_upper, n, |edge| found[edge as usize][0]);
    drop((all, by_upper));
    let in_order: Vec<[u32; 2]> = order.iter().map(|&edge| found[edge as usize]).collect();
    let downwards = in_order.iter().rev().map(|&[lower, upper]| [upper, lower]);
    let is_right = has_join_tree && split.is_of(downwards);
    is_right.then_some(Edges { in_order, order, taken: [join.taken, split.taken] })
}

/// Edges in the order of an end each, of `n` vertices; those with the same keep their order. They are counted, not compared.
fn by_end(edges: &[u32], n: usize, end: impl Fn(u32) -> u32) -> Vec<u32> {
    let mut places = vec![0u32; n + 1];
    edges.iter().for_each(|&edge| places[end(edge) as usize + 1] += 1);
    for v in 0..n {
        places[v + 1] += places[v];
    }
    let mut sorted = vec![0; edges.len()];
    for &edge in edges {
        let place = &mut places[end(edge) as usize];
        sorted[*place as usize] = edge;
        *place += 1;
    }
    sorted
}

/// Nodes and arcs of a tree whose regular vertices have one edge down and one up, given its edges by rising lower end; and the arc of
/// each edge.
pub(super) fn arcs_between_nodes(edges: &[[u32; 2]], n: usize) -> (Combined, Vec<u32>) {
    let (mut down, mut up) = (vec![0u32; n], vec![0u32; n]);
    edges.iter().for_each(|&[lower, upper]| {
        up[lower as usize] += 1;
        down[upper as usize] += 1;
    });
    let is_regular = |v: u32| (down[v as usize], up[v as usize]) == (1, 1);
    let critical: Vec<u32> = (0..n as u32).filter(|&v| !is_regular(v)).collect();
    let mut node_of = vec![NONE; n];
    critical.iter().zip(0..).for_each(|(&v, node)| node_of[v as usize] = node);
    let node = |v: u32| node_of[v as usize] as usize;
    let is_regular = |v: u32| node_of[v as usize] == NONE;
    drop((down, up));
    let mut arcs: Vec<ContourArc> = Vec::new();
    let (mut arc_of, mut of_edges) = (vec![NONE; n], Vec::with_capacity(edges.len()));
    for &[lower, upper] in edges {
        let arc = if is_regular(lower) { arc_of[lower as usize] } else { arcs.len() as u32 };
        if arc as usize == arcs.len() {
            arcs.push(ContourArc { lower: node(lower), upper: 0 });
        }
        of_edges.push(arc);
        if is_regular(upper) {
            arc_of[upper as usize] = arc;
        } else {
            arcs[arc as usize].upper = node(upper);
        }
    }
    sort(&mut arcs, [&mut arc_of, &mut of_edges]);
    label_nodes(&critical, &arcs, &mut arc_of);
    (Combined { critical, arcs, arc_of }, of_edges)
}

/// Sorts arcs by where they begin and then by where they end, and puts their new numbers into lists of them.
fn sort(arcs: &mut Vec<ContourArc>, lists: [&mut Vec<u32>; 2]) {
    let mut order: Vec<u32> = (0..arcs.len() as u32).collect();
    order.sort_unstable_by_key(|&arc| (arcs[arc as usize].lower, arcs[arc as usize].upper));
    let mut places = vec![0; arcs.len()];
    order.iter().zip(0..).for_each(|(&arc, place)| places[arc as usize] = place);
    for arc in lists.into_iter().flatten() {
        *arc = places.get(*arc as usize).copied().unwrap_or(NONE);
    }
    *arcs = order.iter().map(|&arc| arcs[arc as usize]).collect();
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
