//! Values on edges instead of vertices: single linkage.
//!
//! All vertices are there from the beginning, edges enter by rising weight, and two clusters merge at the first edge between
//! them: Kruskal's minimum spanning tree (1956), in the order of which clusters merge (Gower & Ross 1969, "Minimum spanning
//! trees and single linkage cluster analysis"). As persistence of a graph filtered by its edges: all are born at once, and
//! each link is a death.

use crate::domain::{check_edges, known};
use crate::error::{Error, check_vertex_count};
use crate::pairing::{NONE, UnionFind};
use crate::scalar::Scalar;
use num_traits::PrimInt;
use petgraph::visit::{EdgeRef, IntoEdgeReferences, NodeIndexable};

/// Two clusters become one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Link<S> {
    /// The clusters, the one with the lower number first: a vertex has its own number, the cluster of link i has the number
    /// of vertices plus i.
    pub clusters: [usize; 2],
    /// The weight of the edge that joins them.
    pub weight: S,
    /// The number of that edge in the list.
    pub edge: usize,
    /// Number of vertices of both.
    pub size: usize,
}

/// The clusters of a graph with weights on its edges, at every level: the single-linkage dendrogram.
///
/// ```
/// let edges = [(0, 1, 1.0), (1, 2, 4.0), (2, 3, 1.5), (0, 3, 9.0)];
/// let dendrogram = topo::single_linkage(4, &edges)?;
/// let merges: Vec<_> = dendrogram.links().iter().map(|link| (link.clusters, link.weight, link.size)).collect();
/// assert_eq!(merges, [([0, 1], 1.0, 2), ([2, 3], 1.5, 2), ([4, 5], 4.0, 4)]); // as scipy's linkage has it
/// assert_eq!(dendrogram.at(2.0), [0, 0, 1, 1]);
/// assert_eq!(dendrogram.clusters(3), [0, 0, 1, 2]);
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Dendrogram<S> {
    vertices: usize,
    /// By rising weight.
    links: Vec<Link<S>>,
    /// The ends of the edge of each link.
    edges: Vec<[u32; 2]>,
}

/// Clusters the vertices of a graph by its weighted edges (end, end, weight), ends being integers of any type: the smaller a weight, the
/// nearer the ends. Of equal weights the edge that is listed first comes first. O(m log m) for m edges. For a petgraph graph see
/// [`weighted_edges`].
///
/// # Errors
/// If an end is not a vertex, or a weight is NaN.
pub fn single_linkage<I: PrimInt, S: Scalar>(vertices: usize, edges: &[(I, I, S)]) -> Result<Dendrogram<S>, Error> {
    check_edges(vertices, edges.iter().map(|&(a, b, _)| [a, b]))?;
    check_vertex_count(edges.len())?;
    let keyed = |(edge, &(_, _, weight)): (usize, &(I, I, S))| {
        weight.key().map(|key| (key, edge as u32)).ok_or(Error::Weight { edge })
    };
    let mut order = edges.iter().enumerate().map(keyed).collect::<Result<Vec<_>, Error>>()?;
    order.sort_unstable();
    let mut dendrogram = Dendrogram { vertices, links: Vec::new(), edges: Vec::new() };
    let mut parts = UnionFind::new(vertices);
    // Of each part, at its root, the number of its cluster and its size.
    let mut clusters: Vec<(usize, usize)> = (0..vertices).map(|vertex| (vertex, 1)).collect();
    for (_, edge) in order {
        let (a, b, weight) = edges[edge as usize];
        let ends = [a, b].map(known);
        let [root, other] = ends.map(|end| parts.find(end));
        if root == other {
            continue;
        }
        // The smaller under the larger, as roots have no meaning here.
        let ((first, m), (second, n)) = (clusters[root as usize], clusters[other as usize]);
        let (above, below) = if m < n { (other, root) } else { (root, other) };
        parts.join(below, above);
        let pair = [first.min(second), first.max(second)];
        clusters[above as usize] = (vertices + dendrogram.links.len(), m + n);
        dendrogram.links.push(Link { clusters: pair, weight, edge: edge as usize, size: m + n });
        dendrogram.edges.push(ends);
    }
    Ok(dendrogram)
}

/// The edges of a petgraph graph by the indices of their ends, with what they weigh: as [`single_linkage`] takes them.
///
/// ```
/// use petgraph::graph::UnGraph;
///
/// let roads = UnGraph::<&str, f64>::from_edges([(0, 1, 12.5), (1, 2, 3.0), (0, 2, 20.0)]);
/// let edges = topo::weighted_edges(&roads, |&length| length);
/// let dendrogram = topo::single_linkage(roads.node_count(), &edges)?;
/// assert_eq!(dendrogram.clusters(2), [0, 1, 1]);
/// # Ok::<(), topo::Error>(())
/// ```
pub fn weighted_edges<G, S>(graph: G, mut weight: impl FnMut(&G::EdgeWeight) -> S) -> Vec<(usize, usize, S)>
where
    G: IntoEdgeReferences + NodeIndexable,
{
    let edge = |edge: G::EdgeRef| {
        let [a, b] = [edge.source(), edge.target()].map(|end| graph.to_index(end));
        (a, b, weight(edge.weight()))
    };
    graph.edge_references().map(edge).collect()
}

impl<S: Scalar> Dendrogram<S> {
    /// The links by rising weight; as many fewer than vertices as there are connected components. Their edges are a minimum
    /// spanning forest.
    pub fn links(&self) -> &[Link<S>] {
        &self.links
    }

    /// The cluster of each vertex where all edges up to a weight are there, numbered by their first vertices.
    pub fn at(&self, weight: S) -> Vec<usize> {
        self.after(self.links.partition_point(|link| link.weight <= weight))
    }

    /// The cluster of each vertex where as few links are left out as make `count` clusters, or as many as there can be,
    /// numbered by their first vertices. Never fewer than connected components.
    pub fn clusters(&self, count: usize) -> Vec<usize> {
        self.after(self.vertices.saturating_sub(count.max(1)).min(self.links.len()))
    }

    fn after(&self, links: usize) -> Vec<usize> {
        let mut parts = UnionFind::new(self.vertices);
        for &[a, b] in &self.edges[..links] {
            let [a, b] = [a, b].map(|end| parts.find(end));
            // By their first vertices.
            parts.join(a.max(b), a.min(b));
        }
        let (mut numbers, mut count) = (vec![NONE; self.vertices], 0);
        let number = |vertex: u32| {
            let number = &mut numbers[parts.find(vertex) as usize];
            if *number == NONE {
                *number = count;
                count += 1;
            }
            *number as usize
        };
        (0..self.vertices as u32).map(number).collect()
    }
}
