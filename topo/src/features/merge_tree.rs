//! How the components of sublevel or superlevel sets appear, grow and merge.
//!
//! Leaves are extrema, inner nodes saddles, and the root of each connected component of the domain is the last vertex to
//! enter it. For minima this is called the join tree, for maxima the split tree (usage varies; this is TTK's).
//!
//! The tree is read off from the basins of steepest descent and the pairs, so that it costs little more than the pairs:
//! nothing sorts all vertices. It keeps the way down from each vertex, 4 bytes, and borrows the field. Ways are followed to their ends
//! when it is first asked which vertices belong to what.

use super::branches::{Branches, enters, fill_levels, spilled};
use super::segmentation::{Segmentation, of_basin};
use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Falling, Filtration, Kind, NanPolicy, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::{BasinLabels, BranchEnd, Pointing, Settled};
use crate::scalar::{Scalar, wider_first};
use crate::watch::Watch;
use std::borrow::Cow;

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
/// for threshold in [0.0, 2.0] {
///     println!("{:?}", tree.segmentation(threshold).sizes()); // as many as one likes from one tree
/// }
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MergeTree<'f, V, S: Scalar> {
    pub(super) kind: Kind,
    /// By rising index.
    pub(super) leaves: Vec<u32>,
    leaf_names: Vec<V>,
    /// In the order in which branches end.
    pub(super) ends: Vec<BranchEnd>,
    /// For each branch that ends the name of its saddle.
    saddle_names: Vec<V>,
    /// The leaf of each branch that does not end, and the last vertex.
    pub(super) roots: Vec<(u32, u32)>,
    root_names: Vec<V>,
    /// For each vertex its leaf, the end of its steepest descent.
    pub(super) basins: BasinLabels,
    /// For each vertex its value, or the level up to which it is filled. Leaves, saddles and roots are never filled beyond their own values.
    pub(super) values: Cow<'f, [S]>,
    /// Where basins are filled, for each vertex the one with which it enters: itself, or the saddle up to which it is filled.
    filled_to: Option<Vec<u32>>,
}

impl<V: PartialEq, S: Scalar> PartialEq for MergeTree<'_, V, S> {
    /// Values of vertices that never enter do not count.
    fn eq(&self, other: &Self) -> bool {
        let values = || self.values.iter().zip(&*other.values);
        (self.kind, &self.leaves, &self.ends, &self.roots) == (other.kind, &other.leaves, &other.ends, &other.roots)
            && (&self.leaf_names, &self.saddle_names, &self.root_names)
                == (&other.leaf_names, &other.saddle_names, &other.root_names)
            && self.basins().iter().eq(other.basins().iter())
            && values().zip(self.basins().iter()).all(|((a, b), basin)| !enters(basin) || a == b)
    }
}

impl<V, S: Scalar> MergeTree<'_, V, S> {
    /// For each vertex its leaf.
    pub(super) fn basins(&self) -> Settled<'_> {
        self.basins.settled()
    }
}

impl<'f, V: Copy, S: Scalar> MergeTree<'f, V, S> {
    fn new<G: Domain<Vertex = V>, D: Direction>(
        domain: G,
        field: &'f [S],
        nan: NanPolicy,
        watch: Watch<'_>,
    ) -> Result<Self, Error> {
        let filtration = Filtration::<S, D>::new(field, domain.vertex_count(), nan)?.watched(watch);
        Self::named(domain, &filtration, field, &|index| domain.vertex(index as usize))
    }

    /// The tree with vertices named otherwise than by the domain, unless the work is stopped.
    pub(super) fn named<G: Domain, D: Direction>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
        field: &'f [S],
        name: &dyn Fn(u32) -> V,
    ) -> Result<Self, Error> {
        Ok(Self::of_branches(Branches::new(domain, filtration, Pointing::Steepest)?, D::KIND, field, name))
    }

    fn of_branches(branches: Branches, kind: Kind, field: &'f [S], name: &dyn Fn(u32) -> V) -> Self {
        let Branches { extrema, basins, ends, essential } = branches;
        Self {
            kind,
            leaf_names: extrema.iter().map(|&extremum| name(extremum)).collect(),
            leaves: extrema,
            saddle_names: ends.iter().map(|end| name(end.saddle)).collect(),
            ends,
            root_names: essential.iter().map(|&(_, last)| name(last)).collect(),
            roots: essential,
            basins,
            values: Cow::Borrowed(field),
            filled_to: None,
        }
    }

    /// The vertex with which a vertex enters, itself unless it is filled up to another.
    pub(super) fn enters_with(&self, vertex: u32) -> u32 {
        self.filled_to.as_ref().map_or(vertex, |filled_to| filled_to[vertex as usize])
    }

    /// The value at a vertex.
    pub(super) fn value(&self, vertex: u32) -> S {
        self.values[vertex as usize]
    }

    /// What a leaf is called.
    pub(super) fn leaf_name(&self, leaf: u32) -> V {
        self.leaf_names[leaf as usize]
    }

    /// The branches that end, with what their saddles are called.
    pub(super) fn ends_and_saddles(&self) -> impl Iterator<Item = (&BranchEnd, V)> {
        self.ends.iter().zip(self.saddle_names.iter().copied())
    }

    /// The branches that do not end: leaves, last vertices, and what these are called.
    pub(super) fn roots_and_names(&self) -> impl Iterator<Item = (u32, u32, V)> {
        self.roots.iter().zip(&self.root_names).map(|(&(leaf, last), &name)| (leaf, last, name))
    }

    /// Whether leaves are minima or maxima.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Number of leaves, which come first among the [nodes](Self::nodes).
    pub fn leaf_count(&self) -> usize {
        self.leaves.len()
    }

    /// The tree with a copy of the field, where it borrows that.
    ///
    /// ```
    /// fn tree_of(seconds: usize) -> Result<topo::MergeTree<'static, usize, f64>, topo::Error> {
    ///     let wave: Vec<f64> = (0..seconds).map(|second| (second as f64).sin()).collect();
    ///     Ok(topo::merge_tree(&topo::Path::new(seconds), &wave, topo::Kind::Maximum)?.into_owned())
    /// }
    /// assert_eq!(tree_of(60)?.leaf_count(), 10);
    /// # Ok::<(), topo::Error>(())
    /// ```
    pub fn into_owned(self) -> MergeTree<'static, V, S> {
        let Self { kind, leaves, leaf_names, ends, saddle_names, roots, root_names, basins, values, filled_to } = self;
        let values = Cow::Owned(values.into_owned());
        MergeTree { kind, leaves, leaf_names, ends, saddle_names, roots, root_names, basins, values, filled_to }
    }

    /// Leaves, then saddles in the order in which they enter, then roots that are neither.
    pub fn nodes(&self) -> Vec<Node<V, S>> {
        let node = |vertex: u32, name: V| Node { vertex: name, value: self.value(vertex), parent: None };
        let mut nodes: Vec<_> =
            self.leaves.iter().zip(&self.leaf_names).map(|(&leaf, &name)| node(leaf, name)).collect();
        // For each branch its last node so far.
        let mut tops: Vec<usize> = (0..nodes.len()).collect();
        let mut last_saddle = None;
        for (&BranchEnd { extremum, elder, saddle, .. }, name) in self.ends_and_saddles() {
            let (younger, elder) = (extremum as usize, elder as usize);
            if last_saddle.replace(saddle) != Some(saddle) {
                nodes[tops[elder]].parent = Some(nodes.len());
                tops[elder] = nodes.len();
                nodes.push(node(saddle, name));
            }
            nodes[tops[younger]].parent = Some(tops[elder]);
        }
        let saddles = self.ends.iter().map(|end| end.saddle);
        let mut is_node: Vec<u32> = self.leaves.iter().copied().chain(saddles).collect();
        is_node.sort_unstable();
        for (leaf, last, name) in self.roots_and_names() {
            if is_node.binary_search(&last).is_err() {
                nodes[tops[leaf as usize]].parent = Some(nodes.len());
                nodes.push(node(last, name));
            }
        }
        nodes
    }

    /// The edges of the tree: each node that is no root with its parent, as places among the [nodes](Self::nodes).
    pub fn arcs(&self) -> Vec<[usize; 2]> {
        let nodes = self.nodes();
        (0..).zip(&nodes).filter_map(|(child, node)| Some([child, node.parent?])).collect()
    }

    /// The field as the tree has it: as it was given, and after [`simplify`](Self::simplify) or [`filter`](Self::filter)
    /// without the basins (for maxima, peaks) of the branches that have gone. What never enters is as it was.
    pub fn field(&self) -> &[S] {
        &self.values
    }

    /// The basins of all leaves that are more persistent than a threshold, as [`segmentation`](fn@crate::segmentation)
    /// finds them; with NaN as with one that none is above. O(vertices).
    pub fn segmentation(&self, threshold: S::Width) -> Segmentation<V> {
        self.basins_of(&self.longer(threshold))
    }

    fn basins_of(&self, kept: &[bool]) -> Segmentation<V> {
        let extrema = those(&self.leaf_names, kept);
        let segment_of_basin = self.spilled(kept);
        Segmentation::new(extrema, self.basins().iter().map(|basin| of_basin(&segment_of_basin, basin)).collect())
    }

    /// The basins of as many leaves as are wanted, those of the most persistent branches, or of all if there are fewer; never fewer than
    /// connected components. Of equally persistent ones those whose leaves come first in the order of the tree. O(vertices + leaves log leaves).
    ///
    /// Of the maxima of a density on a neighbour graph these are the clusters of `ToMATo` (Chazal, Guibas, Oudot & Skraba 2013,
    /// "Persistence-based clustering in Riemannian manifolds"), and [`segmentation`](Self::segmentation) has those above a prominence.
    ///
    /// ```
    /// let near = topo::Adjacency::from_edges(7, &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6)])?;
    /// let density = [2.0, 5.0, 1.0, 4.0, 3.5, 3.8, 2.0];
    /// let tree = topo::merge_tree(&near, &density, topo::Kind::Maximum)?;
    /// assert_eq!(tree.clusters(2).sizes(), [3, 4]); // the minimum goes where it is steepest
    /// # Ok::<(), topo::Error>(())
    /// ```
    pub fn clusters(&self, count: usize) -> Segmentation<V> {
        let mut kept = vec![true; self.leaves.len()];
        let born = |leaf: u32| self.value(self.leaves[leaf as usize]);
        let width = |end: &BranchEnd| born(end.extremum).width(self.value(end.saddle));
        let mut ended: Vec<(S::Width, u32)> = self.ends.iter().map(|end| (width(end), end.extremum)).collect();
        ended.sort_unstable_by(|a, b| {
            let first = (born(a.1).key(), a.1).cmp(&(born(b.1).key(), b.1));
            wider_first(&a.0, &b.0).then(if self.kind == Kind::Minimum { first } else { first.reverse() })
        });
        for &(_, leaf) in ended.iter().skip(count.saturating_sub(self.roots.len())) {
            kept[leaf as usize] = false;
        }
        self.basins_of(&kept)
    }

    /// The tree without branches that live no longer than a threshold: that of the field with their basins filled up
    /// (or, for maxima, cut off) to the saddle; with NaN only what never dies is left. O(vertices).
    #[must_use = "the tree itself is left as it is"]
    pub fn simplify(&self, threshold: S::Width) -> MergeTree<'static, V, S> {
        self.pruned(&self.longer(threshold))
    }

    /// The tree with some branches only; those that end in others bring them along.
    pub(super) fn pruned(&self, kept: &[bool]) -> MergeTree<'static, V, S> {
        let place = self.spilled(kept);
        let levels = fill_levels(self.ends.iter().map(|end| (end.extremum, end.elder, end.saddle)), kept);
        let renumbered = |leaf: u32| place[leaf as usize];
        let filled_to = |((v, basin), &value): ((u32, u32), &S)| {
            let (saddle, own) = (levels.get(basin as usize).copied().flatten(), self.enters_with(v));
            saddle.filter(|&saddle| self.is_before(own, value, saddle)).unwrap_or(own)
        };
        let vertices = (0..).zip(self.basins().iter()).zip(&*self.values);
        let filled_to: Vec<u32> = vertices.map(filled_to).collect();
        let value =
            |(&to, (v, &value)): (&u32, (u32, &S))| if to == self.enters_with(v) { value } else { self.value(to) };
        let ends = self.ends_and_saddles().filter(|(end, _)| kept[end.extremum as usize]);
        let end = |(end, name): (&BranchEnd, V)| {
            let [extremum, elder, beyond] = [end.extremum, end.elder, end.beyond].map(renumbered);
            (BranchEnd { extremum, saddle: end.saddle, elder, beyond }, name)
        };
        let (ends, saddle_names) = ends.map(end).unzip();
        MergeTree {
            kind: self.kind,
            leaves: those(&self.leaves, kept),
            leaf_names: those(&self.leaf_names, kept),
            ends,
            saddle_names,
            roots: self.roots.iter().map(|&(leaf, last)| (renumbered(leaf), last)).collect(),
            root_names: self.root_names.clone(),
            values: filled_to.iter().zip((0..).zip(&*self.values)).map(value).collect(),
            basins: BasinLabels::new(self.basins().iter().map(|basin| of_basin(&place, basin))),
            filled_to: Some(filled_to),
        }
    }

    /// Whether the branch of each leaf lives longer than a threshold.
    fn longer(&self, threshold: S::Width) -> Vec<bool> {
        let mut is_longer = vec![true; self.leaves.len()];
        for end in &self.ends {
            let born = self.value(self.leaves[end.extremum as usize]);
            is_longer[end.extremum as usize] = born.width(self.value(end.saddle)) > threshold;
        }
        is_longer
    }

    fn spilled(&self, kept: &[bool]) -> Vec<u32> {
        spilled(&self.ends, kept)
    }

    /// Whether a value has been reached at a level.
    pub(super) fn has_reached(&self, value: S, level: S) -> bool {
        match self.kind {
            Kind::Minimum => value <= level,
            Kind::Maximum => value >= level,
        }
    }

    /// Whether the vertex with an index and a value enters before a saddle.
    pub(super) fn is_before(&self, index: u32, value: S, saddle: u32) -> bool {
        let level = self.value(saddle);
        match (self.kind, index < saddle) {
            (Kind::Minimum, true) => Rising::precedes_higher_index(value, level),
            (Kind::Minimum, false) => Rising::precedes_lower_index(value, level),
            (Kind::Maximum, true) => Falling::precedes_higher_index(value, level),
            (Kind::Maximum, false) => index != saddle && Falling::precedes_lower_index(value, level),
        }
    }
}

/// Those things that are kept.
fn those<T: Copy>(things: &[T], kept: &[bool]) -> Vec<T> {
    things.iter().zip(kept).filter(|&(_, &kept)| kept).map(|(&thing, _)| thing).collect()
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
    ) -> Result<MergeTree<'_, G::Vertex, S>, Error> {
        self.merge_tree_watched(domain, field, kind, Watch::NONE)
    }

    /// [`merge_tree`](fn@crate::merge_tree) with these options that can be stopped.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`]; [`Error::Interrupted`] if the watch has stopped the work.
    pub fn merge_tree_watched<'f, G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &'f [S],
        kind: Kind,
        watch: Watch<'_>,
    ) -> Result<MergeTree<'f, G::Vertex, S>, Error> {
        watch.held(|watch| match kind {
            Kind::Minimum => MergeTree::new::<G, Rising>(domain, field, self.nan, watch),
            Kind::Maximum => MergeTree::new::<G, Falling>(domain, field, self.nan, watch),
        })
    }
}

/// The merge tree of a field, with minima or maxima for leaves.
///
/// # Errors
/// If the field does not fit the domain, see [`Error`].
pub fn merge_tree<G: Domain, S: Scalar>(
    domain: G,
    field: &[S],
    kind: Kind,
) -> Result<MergeTree<'_, G::Vertex, S>, Error> {
    PersistenceOptions::new().merge_tree(domain, field, kind)
}
