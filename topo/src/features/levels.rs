//! The components of a sublevel or superlevel set, read off from a merge tree.

use super::merge_tree::MergeTree;
use super::segmentation::{Segmentation, of_basin};
use crate::pairing::{NONE, UnionFind};
use crate::scalar::Scalar;

/// A connected component of a sublevel or superlevel set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LevelComponent<V, S> {
    /// Its eldest extremum.
    pub extremum: V,
    /// The value there; the height of the component is how far that is from the level.
    pub value: S,
    /// Where it will join an elder component; `None` if it never does.
    pub saddle: Option<V>,
    /// Number of its vertices.
    pub size: usize,
}

impl<V: Copy, S: Scalar> MergeTree<'_, V, S> {
    /// The components of the set of vertices up to a level (for maxima: from it upwards), by index of their extrema.
    /// O(vertices).
    pub fn at(&self, level: S) -> Vec<LevelComponent<V, S>> {
        let components = self.components(level);
        let mut saddles = vec![None; self.leaves.len()];
        self.ends_and_saddles().for_each(|(end, saddle)| saddles[end.extremum as usize] = Some(saddle));
        let alive = self.eldest_at(level).0;
        let component = |(&leaf, size): (&u32, usize)| {
            let (extremum, value) = (self.leaf_name(leaf), self.value(self.leaves[leaf as usize]));
            LevelComponent { extremum, value, saddle: saddles[leaf as usize], size }
        };
        alive.iter().zip(components.sizes()).map(component).collect()
    }

    /// For each vertex the component it is in at a level, as a place among those [at](Self::at) it; vertices beyond the
    /// level are in none. The sums of caller's weights and the vertices of a component are there for the asking. O(vertices).
    ///
    /// ```
    /// let tree = topo::merge_tree(&topo::Path::new(5), &[1.0, 7.0, 3.0, 2.0, 9.0], topo::Kind::Minimum)?;
    /// let lakes = tree.components(5.0);
    /// assert_eq!(lakes.labels().collect::<Vec<_>>(), [Some(0), None, Some(1), Some(1), None]);
    /// assert_eq!(lakes.vertices(1).collect::<Vec<_>>(), [2, 3]);
    /// assert_eq!(lakes.sums(&[0.5, 0.5, 2.0, 1.0, 1.0])?, [0.5, 3.0]);
    /// # Ok::<(), topo::Error>(())
    /// ```
    pub fn components(&self, level: S) -> Segmentation<V> {
        let (alive, mut components) = self.eldest_at(level);
        let mut place = vec![NONE; self.leaves.len()];
        (0..).zip(&alive).for_each(|(component, &leaf)| place[leaf as usize] = component);
        let component_of_leaf: Vec<u32> =
            (0..self.leaves.len() as u32).map(|leaf| place[components.find(leaf) as usize]).collect();
        let label = |(basin, &value)| {
            if self.has_reached(value, level) { of_basin(&component_of_leaf, basin) } else { NONE }
        };
        let labels = self.basins().iter().zip(&*self.values).map(label).collect();
        let extrema = alive.iter().map(|&leaf| self.leaf_name(leaf)).collect();
        Segmentation::new(extrema, labels)
    }

    /// The leaves of the components at a level, rising, and which leaves are merged there.
    fn eldest_at(&self, level: S) -> (Vec<u32>, UnionFind) {
        let mut components = UnionFind::new(self.leaves.len());
        for end in self.ends.iter().take_while(|end| self.has_reached(self.value(end.saddle), level)) {
            components.join(end.extremum, end.elder);
        }
        let is_eldest = |&leaf: &u32| {
            self.has_reached(self.value(self.leaves[leaf as usize]), level) && components.find(leaf) == leaf
        };
        ((0..self.leaves.len() as u32).filter(is_eldest).collect(), components)
    }
}
