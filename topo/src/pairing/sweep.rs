//! The plain algorithm: sort all vertices, let them enter one by one, keep the components in a union-find.
//!
//! A vertex none of whose neighbours has entered is an extremum and starts a component. A vertex at which components
//! meet is a saddle, and by the *elder rule* every one of them dies there except the eldest. Edelsbrunner, Letscher &
//! Zomorodian (2002), "Topological Persistence and Simplification". O(n log n + m α(n)).
//!
//! This is the reference: the faster ways elsewhere in the crate are tested to agree with it, vertex by vertex.

use super::graph::Graph;
use super::merges::{Merge, NONE};
use super::union_find::UnionFind;
use crate::filtration::{Direction, Filtration};
use crate::scalar::Scalar;

/// Pairs every extremum of a filtration by sorting all vertices; by rising index.
pub(crate) fn sweep<G: Graph, S: Scalar, D: Direction>(graph: G, filtration: &Filtration<'_, S, D>) -> Vec<Merge> {
    let order = filtration.order();
    let mut components = UnionFind::new(graph.vertex_count());
    let mut merges = Vec::new();
    for &v in &order {
        graph.for_each_neighbor(v as usize, |u| {
            let u = u as u32;
            if !filtration.precedes(u, v) {
                return;
            }
            let (a, b) = (components.find(u), components.find(v));
            if a == b {
                return;
            }
            let (elder, younger) = if filtration.precedes(a, b) { (a, b) } else { (b, a) };
            if younger != v {
                merges.push(Merge { extremum: younger, end: v, towards: elder });
            }
            components.join(younger, elder);
        });
    }
    with_essential(merges, &order, &mut components)
}

/// Adds the eldest of each component with the last vertex to enter it, and puts all in the order of their extrema.
fn with_essential(mut merges: Vec<Merge>, order: &[u32], components: &mut UnionFind) -> Vec<Merge> {
    let mut last = vec![0; components.len()];
    for &v in order {
        last[components.find(v) as usize] = v;
    }
    let eldest = order.iter().filter(|&&v| components.find(v) == v);
    merges.extend(eldest.map(|&v| Merge { extremum: v, end: last[v as usize], towards: NONE }));
    merges.sort_unstable_by_key(|merge| merge.extremum);
    merges
}
