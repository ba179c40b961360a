//! How the components of sublevel or superlevel sets appear, grow and merge.
//!
//! Leaves are extrema, inner nodes saddles, and the root of each connected component of the domain is the last vertex to
//! enter it. For minima this is called the join tree, for maxima the split tree (usage varies; this is TTK's).

use super::branches::{BranchEnd, Branches};
use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Falling, Filtration, Kind, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::UnionFind;
use crate::persistence::Pair;
use crate::scalar::{Scalar, wider_first};
use core::cmp::Ordering;

/// A place in a [`MergeTree`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Node<V, S> {
    /// The extremum, saddle or last vertex.
    pub vertex: V,
    /// The value there.
    pub value: S,
    /// The node towards the root, as a place among the [nodes](MergeTree::nodes); `None` for a root.
    pub parent: Option<usize>,
}

/// An extremum with the extremum whose component its own joins.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Branch<V, S> {
    /// Birth and death.
    pub pair: Pair<V, S>,
    /// The eldest extremum of the component that is joined at the saddle; `None` if the class is essential. Among peaks:
    /// the highest one that can be reached without going below the saddle (the *island* or *encirclement* parent).
    pub parent: Option<V>,
}

/// A connected component of a sublevel or superlevel set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LevelComponent<V> {
    /// Its eldest extremum.
    pub extremum: V,
    /// Number of its vertices.
    pub size: usize,
}

/// The tree of components of all sublevel sets (minima) or superlevel sets (maxima) of a field; a forest if the domain
/// is not connected. Leaves are extrema, inner nodes saddles, and roots the last vertices to enter.
///
/// ```text
///   9 ●                     9 ●  root
///      ╲     6 ●              ┃
///       ╲    ╱  ╲           6 ┣━━━━┓  saddle
///        ╲  ╱    ● 4          ┃    ● 4  leaf
///         ●                   ┃
///         1                 1 ●  leaf
///     a field on a path     its join tree
/// ```
///
/// ```
/// use topo::{Kind, Path, merge_tree};
///
/// let tree = merge_tree(&Path::new(4), &[9.0, 1.0, 6.0, 4.0], Kind::Minimum)?;
/// let nodes: Vec<_> = tree.nodes().iter().map(|node| (node.vertex, node.parent)).collect();
/// assert_eq!(nodes, [(1, Some(2)), (3, Some(2)), (2, Some(3)), (0, None)]);
/// let below_5: Vec<_> = tree.at(5.0).iter().map(|component| (component.extremum, component.size)).collect();
/// assert_eq!(below_5, [(1, 1), (3, 1)]);
/// assert_eq!(tree.simplify(2.0).nodes().len(), 2); // only 1 and 9 are left
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MergeTree<V, S> {
    kind: Kind,
    leaves: Vec<TreeVertex<V, S>>,
    /// In the order in which branches end.
    endings: Vec<End<V, S>>,
    /// The leaf of each branch that does not end, and the last vertex.
    roots: Vec<(u32, TreeVertex<V, S>)>,
    /// For each vertex its leaf and the value at which it enters; `None` if it never does.
    entries: Vec<Option<(u32, S)>>,
}

/// A vertex with its index and value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TreeVertex<V, S> {
    index: u32,
    vertex: V,
    value: S,
}

/// Where a branch ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End<V, S> {
    leaf: u32,
    elder: u32,
    saddle: TreeVertex<V, S>,
}

impl<V: Copy, S: Scalar> MergeTree<V, S> {
    pub(crate) fn new<G: Domain<Vertex = V>, D: Direction>(domain: G, filtration: &Filtration<'_, S, D>) -> Self {
        let branches = Branches::new(domain, filtration);
        let place =
            |index: u32| TreeVertex { index, vertex: domain.vertex(index as usize), value: filtration.value(index) };
        let end = |end: &BranchEnd| End { leaf: end.extremum, elder: end.elder, saddle: place(end.saddle) };
        let entry = |(basin, &value): (&Option<u32>, &S)| Some(((*basin)?, value));
        Self {
            kind: D::KIND,
            leaves: branches.extrema.iter().map(|&extremum| place(extremum)).collect(),
            endings: branches.ends.iter().map(end).collect(),
            roots: branches.essential.iter().map(|&(leaf, last)| (leaf, place(last))).collect(),
            entries: branches.basins.iter().zip(filtration.field()).map(entry).collect(),
        }
    }

    /// Whether leaves are minima or maxima.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Number of leaves, which come first among the [nodes](Self::nodes).
    pub fn leaf_count(&self) -> usize {
        self.leaves.len()
    }

    /// Leaves, then saddles in the order in which they enter, then roots that are neither.
    pub fn nodes(&self) -> Vec<Node<V, S>> {
        let node = |place: &TreeVertex<V, S>| Node { vertex: place.vertex, value: place.value, parent: None };
        let mut nodes: Vec<_> = self.leaves.iter().map(node).collect();
        // For each branch its last node so far.
        let mut tops: Vec<usize> = (0..nodes.len()).collect();
        let mut last_saddle = None;
        for End { leaf, elder, saddle } in &self.endings {
            let (younger, elder) = (*leaf as usize, *elder as usize);
            if last_saddle.replace(saddle.index) != Some(saddle.index) {
                nodes[tops[elder]].parent = Some(nodes.len());
                tops[elder] = nodes.len();
                nodes.push(node(saddle));
            }
            nodes[tops[younger]].parent = Some(tops[elder]);
        }
        let mut is_node: Vec<u32> =
            self.leaves.iter().chain(self.endings.iter().map(|end| &end.saddle)).map(|place| place.index).collect();
        is_node.sort_unstable();
        for (leaf, last) in &self.roots {
            if is_node.binary_search(&last.index).is_err() {
                nodes[tops[*leaf as usize]].parent = Some(nodes.len());
                nodes.push(node(last));
            }
        }
        nodes
    }

    /// The extrema with their parents, in the order of [`Pairs`](crate::Pairs) and with the pairs of zero persistence.
    ///
    /// ```
    /// let heights = [0.0, 7.0, 2.0, 5.0, 4.0, 9.0];
    /// let tree = topo::merge_tree(&topo::Path::new(6), &heights, topo::Kind::Maximum)?;
    /// let family: Vec<_> = tree.branches().iter().map(|peak| (peak.pair.extremum, peak.parent)).collect();
    /// assert_eq!(family, [(5, None), (1, Some(5)), (3, Some(5))]);
    /// # Ok::<(), topo::Error>(())
    /// ```
    pub fn branches(&self) -> Vec<Branch<V, S>> {
        let leaf = |leaf: u32| self.leaves[leaf as usize];
        let finite = self.endings.iter().map(|end| (leaf(end.leaf), end.saddle, Some(leaf(end.elder).vertex)));
        let essential = self.roots.iter().map(|&(root, last)| (leaf(root), last, None));
        let mut branches: Vec<_> = finite.chain(essential).collect();
        let persistence = |(born, end, _): &(TreeVertex<V, S>, TreeVertex<V, S>, _)| born.value.width(end.value);
        branches.sort_by(|a, b| {
            let by_persistence = wider_first(&persistence(a), &persistence(b));
            by_persistence.then(a.2.is_some().cmp(&b.2.is_some())).then_with(|| self.compare(&a.0, &b.0))
        });
        let branch = |(born, end, parent): (TreeVertex<V, S>, TreeVertex<V, S>, Option<V>)| {
            let saddle = parent.map(|_| end.vertex);
            Branch { pair: Pair { extremum: born.vertex, saddle, birth: born.value, end: end.value }, parent }
        };
        branches.into_iter().map(branch).collect()
    }

    /// The edges of the tree: each node that is no root with its parent, as places among the [nodes](Self::nodes).
    pub fn arcs(&self) -> Vec<[usize; 2]> {
        let nodes = self.nodes();
        (0..).zip(&nodes).filter_map(|(child, node)| Some([child, node.parent?])).collect()
    }

    /// The tree without branches that live no longer than a threshold: that of the field with their basins filled up
    /// (or, for maxima, cut off) to the saddle.
    #[must_use = "the tree itself is left as it is"]
    pub fn simplify(&self, threshold: S::Width) -> Self {
        let is_short = |end: &End<V, S>| self.leaves[end.leaf as usize].value.width(end.saddle.value) <= threshold;
        // Where vertices of a basin go, and from which value on. A short branch on a short branch goes where that does.
        let mut filled: Vec<(u32, Option<S>)> = (0..self.leaves.len() as u32).map(|leaf| (leaf, None)).collect();
        for end in self.endings.iter().rev().filter(|end| is_short(end)) {
            let (elder, level) = filled[end.elder as usize];
            filled[end.leaf as usize] = (elder, level.or(Some(end.saddle.value)));
        }
        let kept: Vec<u32> =
            (0..).zip(&filled).filter(|(_, (_, level))| level.is_none()).map(|(leaf, _)| leaf).collect();
        let renumbered = |leaf: u32| kept.partition_point(|&other| other < filled[leaf as usize].0) as u32;
        let ends = self.endings.iter().filter(|end| !is_short(end));
        let entry = |&(leaf, value): &(u32, S)| {
            let level = filled[leaf as usize].1.filter(|&level| self.is_at(value, level));
            (renumbered(leaf), level.unwrap_or(value))
        };
        Self {
            kind: self.kind,
            leaves: kept.iter().map(|&leaf| self.leaves[leaf as usize]).collect(),
            endings: ends.map(|end| End { leaf: renumbered(end.leaf), elder: renumbered(end.elder), ..*end }).collect(),
            roots: self.roots.iter().map(|&(leaf, last)| (renumbered(leaf), last)).collect(),
            entries: self.entries.iter().map(|vertex| vertex.as_ref().map(entry)).collect(),
        }
    }

    /// The components of the set of vertices up to a level (for maxima: from it upwards), by index of their extrema.
    /// O(vertices).
    pub fn at(&self, level: S) -> Vec<LevelComponent<V>> {
        let mut components = UnionFind::new(self.leaves.len());
        for end in self.endings.iter().take_while(|end| self.is_at(end.saddle.value, level)) {
            components.join(end.leaf, end.elder);
        }
        let mut sizes = vec![0; self.leaves.len()];
        for &(leaf, value) in self.entries.iter().flatten() {
            if self.is_at(value, level) {
                sizes[components.find(leaf) as usize] += 1;
            }
        }
        let components = self.leaves.iter().zip(sizes).filter(|&(_, size)| size > 0);
        components.map(|(leaf, size)| LevelComponent { extremum: leaf.vertex, size }).collect()
    }

    /// The order in which two vertices enter.
    fn compare(&self, a: &TreeVertex<V, S>, b: &TreeVertex<V, S>) -> Ordering {
        let rising = a.value.key().cmp(&b.value.key()).then(a.index.cmp(&b.index));
        if self.kind == Kind::Minimum { rising } else { rising.reverse() }
    }

    /// Whether a value has been reached at a level.
    fn is_at(&self, value: S, level: S) -> bool {
        match self.kind {
            Kind::Minimum => value <= level,
            Kind::Maximum => value >= level,
        }
    }
}

impl PersistenceOptions {
    /// [`merge_tree`](fn@crate::merge_tree) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`].
    pub fn merge_tree<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        kind: Kind,
    ) -> Result<MergeTree<G::Vertex, S>, Error> {
        let count = domain.vertex_count();
        Ok(match kind {
            Kind::Minimum => MergeTree::new(domain, &Filtration::<S, Rising>::new(field, count, self.nan)?),
            Kind::Maximum => MergeTree::new(domain, &Filtration::<S, Falling>::new(field, count, self.nan)?),
        })
    }
}

/// The merge tree of a field, with minima or maxima for leaves.
///
/// # Errors
/// If the field does not fit the domain, see [`Error`].
pub fn merge_tree<G: Domain, S: Scalar>(domain: G, field: &[S], kind: Kind) -> Result<MergeTree<G::Vertex, S>, Error> {
    PersistenceOptions::new().merge_tree(domain, field, kind)
}
