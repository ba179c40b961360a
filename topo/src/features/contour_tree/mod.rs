//! How contours appear, split, merge and vanish as the level rises: the contour tree.
//!
//! A *contour* is a connected component of a level set. The tree has a node for each vertex at which contours change in number,
//! and an arc for each contour that moves between two of them; every vertex lies on an arc. It is put together from the join
//! tree (components of sublevel sets) and the split tree (of superlevel sets), leaf by leaf: a leaf of one that is regular in the
//! other is a leaf of the contour tree, with the arc that it has there. Carr, Snoeyink & Axen (2003), "Computing contour trees
//! in all dimensions".
//!
//! That takes a domain whose loops are filled by triangles, such as a picture or a volume with
//! [`Freudenthal`](crate::Connectivity::Freudenthal) or [`Full`](crate::Connectivity::Full) edges, a triangulated disk or sphere, or a
//! tree. Elsewhere (a torus, a picture with masked holes, the bare graph of a grid along its axes) contours may form loops, and the
//! whole is a Reeb graph. If there is still a tree that has the join and the split tree of the field, it is what comes out: components of
//! sub- and superlevel sets are right, and those of level sets need not be. If there is none, that is an error.

mod combine;
mod critical;
mod prune;
mod ranks;

use super::merge_tree::MergeTree;
use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Filtration, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::NONE;
use crate::scalar::Scalar;
use crate::watch::Watch;
use combine::Combined;
use critical::Critical;

/// Where one vertex in so many is a minimum, as on white noise, most are critical, and all are sorted: on white noise of 1024² with
/// Freudenthal edges, where one in seven is, that takes 0.95 of the time and three quarters of the memory.
const MANY_LEAVES: usize = 16;

/// So few minima are never too many.
const FEW_LEAVES: usize = 64;

/// A vertex at which contours appear, vanish, split or merge.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContourNode<V, S> {
    /// The vertex.
    pub vertex: V,
    /// The value there.
    pub value: S,
}

/// A contour that moves from one node to another without meeting any.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContourArc {
    /// The node where it begins, as a place among the [nodes](ContourTree::nodes).
    pub lower: usize,
    /// The node where it ends.
    pub upper: usize,
}

/// The contour tree of a field; a forest if the domain is not connected.
///
/// ```
/// let tree = topo::contour_tree(&topo::Path::new(6), &[0.0, 3.0, 2.0, 1.0, 5.0, 9.0])?;
/// let vertices: Vec<usize> = tree.nodes().iter().map(|node| node.vertex).collect();
/// let arcs: Vec<_> = tree.arcs().iter().map(|arc| (vertices[arc.lower], vertices[arc.upper])).collect();
/// assert_eq!(arcs, [(0, 1), (3, 1), (3, 5)]);
/// assert_eq!(tree.label(2), Some(1));
/// assert_eq!(tree.contours_at(2.5), 3);
/// assert_eq!(tree.simplify(3.0).arcs().len(), 1); // without the leaf 0, then without 1
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ContourTree<V, S> {
    /// By rising (value, index).
    nodes: Vec<ContourNode<V, S>>,
    arcs: Vec<ContourArc>,
    /// For each vertex its arc, [`NONE`] if it has none.
    arc_of: Vec<u32>,
}

impl<V: Copy, S: Scalar> ContourTree<V, S> {
    fn new<G: Domain<Vertex = V>>(domain: G, filtration: &Filtration<'_, S, Rising>) -> Result<Self, Error> {
        if domain.fills_loops()
            && let Some(tree) = Self::of_critical(domain, filtration)?
        {
            return Ok(tree);
        }
        Self::of_all(domain, filtration)
    }

    /// From what is critical in the join or the split tree; for domains whose loops are filled, and fields without NaN.
    fn of_critical<G: Domain<Vertex = V>>(
        domain: G,
        filtration: &Filtration<'_, S, Rising>,
    ) -> Result<Option<Self>, Error> {
        if filtration.field().iter().any(|value| value.is_nan()) {
            return Ok(None);
        }
        let join = MergeTree::named(domain, filtration, filtration.field(), &|_| ())?;
        if join.leaf_count() > filtration.field().len() / MANY_LEAVES + FEW_LEAVES {
            return Ok(None);
        }
        let split = MergeTree::named(domain, &filtration.backwards(), filtration.field(), &|_| ())?;
        let critical = critical::combine(&join, &split, filtration);
        if filtration.stops() {
            return Err(Error::Interrupted);
        }
        let Some(Critical { vertices, tree, arc_of }) = critical else { return Ok(None) };
        let node = |&rank: &u32| {
            let vertex = vertices[rank as usize];
            ContourNode { vertex: domain.vertex(vertex as usize), value: filtration.value(vertex) }
        };
        Ok(Some(Self { nodes: tree.critical.iter().map(node).collect(), arcs: tree.arcs, arc_of }))
    }

    /// From all vertices, sorted.
    fn of_all<G: Domain<Vertex = V>>(domain: G, filtration: &Filtration<'_, S, Rising>) -> Result<Self, Error> {
        let order = filtration.order();
        let Combined { critical, arcs, arc_of: arc_of_rank } = combine::combine(domain, &order, filtration.watch())?;
        let node = |&rank: &u32| {
            let vertex = order[rank as usize];
            ContourNode { vertex: domain.vertex(vertex as usize), value: filtration.value(vertex) }
        };
        let mut arc_of = vec![NONE; domain.vertex_count()];
        order.iter().zip(arc_of_rank).for_each(|(&vertex, arc)| arc_of[vertex as usize] = arc);
        Ok(Self { nodes: critical.iter().map(node).collect(), arcs, arc_of })
    }

    /// The vertices at which contours change in number, by rising value: minima have no arc below, maxima none above. A
    /// connected component of one vertex is a node without arcs.
    pub fn nodes(&self) -> &[ContourNode<V, S>] {
        &self.nodes
    }

    /// The arcs, by rising node where they begin and then where they end.
    pub fn arcs(&self) -> &[ContourArc] {
        &self.arcs
    }

    /// The arc on which the vertex with an index lies; `None` if it never enters, or is all of its component. A node has one of
    /// its arcs: the one that ends there if there is one only, or else the one that begins there if there is one only, or else the first
    /// that ends there; in a simplified tree what has become of it.
    pub fn label(&self, index: usize) -> Option<usize> {
        self.arc_of.get(index).and_then(|&arc| (arc != NONE).then_some(arc as usize))
    }

    /// The [label](Self::label) of every vertex by index: the domain in regions, each swept by one contour.
    pub fn labels(&self) -> impl ExactSizeIterator<Item = Option<usize>> {
        self.arc_of.iter().map(|&arc| (arc != NONE).then_some(arc as usize))
    }

    /// Number of vertices on each arc.
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.arcs.len()];
        self.labels().flatten().for_each(|arc| sizes[arc] += 1);
        sizes
    }

    /// How many contours there are just above a level. O(arcs).
    pub fn contours_at(&self, level: S) -> usize {
        let value = |node: usize| self.nodes[node].value;
        self.arcs.iter().filter(|arc| value(arc.lower) <= level && value(arc.upper) > level).count()
    }

    /// The tree without leaves whose arc is no higher than a threshold, the lowest arc first, where another arc leaves the
    /// inner node on the same side; nodes that become regular go. Vertices of a pruned arc go to the longest arc that is left on the same
    /// side of its inner node, or to the arc on which that node lies if it goes too. Carr, Snoeyink & van de Panne (2004), "Simplifying
    /// flexible isosurfaces using local geometric measures". With NaN as with a threshold that no arc is above. O(vertices + arcs log arcs).
    #[must_use = "the tree itself is left as it is"]
    pub fn simplify(&self, threshold: S::Width) -> Self {
        let values: Vec<S> = self.nodes.iter().map(|node| node.value).collect();
        let pruned = prune::prune(&values, &self.arcs, threshold);
        let mut places = vec![NONE as usize; self.nodes.len()];
        pruned.nodes.iter().enumerate().for_each(|(place, &node)| places[node] = place);
        let arc = |arc: &ContourArc| ContourArc { lower: places[arc.lower], upper: places[arc.upper] };
        Self {
            nodes: pruned.nodes.iter().map(|&node| self.nodes[node]).collect(),
            arcs: pruned.arcs.iter().map(arc).collect(),
            arc_of: self.arc_of.iter().map(|&arc| pruned.arc_of.get(arc as usize).copied().unwrap_or(NONE)).collect(),
        }
    }
}

impl PersistenceOptions {
    /// [`contour_tree`](fn@crate::contour_tree) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, or has no contour tree there, see [`Error`].
    pub fn contour_tree<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
    ) -> Result<ContourTree<G::Vertex, S>, Error> {
        self.contour_tree_watched(domain, field, Watch::NONE)
    }

    /// [`contour_tree`](fn@crate::contour_tree) with these options that can be stopped.
    ///
    /// # Errors
    /// As those of [`contour_tree`](fn@crate::contour_tree); [`Error::Interrupted`] if the watch has stopped the work.
    pub fn contour_tree_watched<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        watch: Watch<'_>,
    ) -> Result<ContourTree<G::Vertex, S>, Error> {
        watch.held(|watch| {
            let filtration = Filtration::new(field, domain.vertex_count(), self.nan)?.watched(watch);
            let tree = ContourTree::new(domain, &filtration);
            if filtration.stops() { Err(Error::Interrupted) } else { tree }
        })
    }
}

/// The contour tree of a field. On grids with ends whose loops are filled by triangles it is found from both merge trees of the field: O(n log e + m)
/// for n vertices, e extrema and m edges, and some 18 bytes a vertex beyond the input. Elsewhere, and where extrema are many, all vertices are
/// sorted: O(n log n + m), and some 40 bytes a vertex, 60 if most are nodes.
///
/// # Errors
/// If the field does not fit the domain; [`Error::Loops`] if it has no contour tree, which no field on a domain whose loops are filled
/// by triangles meets with.
pub fn contour_tree<G: Domain, S: Scalar>(domain: G, field: &[S]) -> Result<ContourTree<G::Vertex, S>, Error> {
    PersistenceOptions::new().contour_tree(domain, field)
}
