//! Extrema ranked by persistence: the most prominent features first, details later.
//!
//! Three ways to take the first few. [`Hierarchy::alternating`] takes maxima and minima in turn (§3.2 of "Conformal
//! Factor Persistence for Fast Hierarchical Cone Extraction"), [`Hierarchy::by_persistence`] whatever is more
//! persistent, [`Hierarchy::above`] everything beyond a threshold. All are nested: the first `n` are a prefix of the
//! first `n + 1`. On a connected domain the hierarchy begins with the global maximum and the global minimum, which
//! have the whole range for their persistence.

use crate::filtration::Kind;
use crate::persistence::{Pair, Pairs, Persistence};
use crate::scalar::{Scalar, wider_first};

/// An extremum with its rank's reason.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extremum<V, S: Scalar> {
    /// Where it is.
    pub vertex: V,
    /// Minimum or maximum.
    pub kind: Kind,
    /// The field there.
    pub value: S,
    /// How far the field must rise or fall until its component joins an elder one; the range of the field on the
    /// connected component of the domain if it never does.
    pub persistence: S::Width,
    /// Where it joins an elder one; `None` if it never does.
    pub saddle: Option<V>,
}

impl<V: Copy, S: Scalar> Extremum<V, S> {
    fn new(pair: &Pair<V, S>, kind: Kind) -> Self {
        Self { vertex: pair.extremum, kind, value: pair.birth, persistence: pair.persistence(), saddle: pair.saddle }
    }
}

/// The extrema of a field by decreasing persistence.
///
/// ```
/// use topo::Kind;
///
/// // A path with two valleys and two hills between its ends.
/// let path = petgraph::graph::UnGraph::<(), ()>::from_edges([(0, 1), (1, 2), (2, 3), (3, 4)]);
/// let hierarchy = topo::persistence(&path, &[1.0, 9.0, 4.0, 6.0, 0.0])?.hierarchy();
/// let first: Vec<_> = hierarchy.alternating(3).map(|extremum| (extremum.vertex.index(), extremum.persistence)).collect();
/// assert_eq!(first, [(1, 9.0), (4, 9.0), (3, 2.0)]);
/// assert_eq!(hierarchy.above(5.0).iter().filter(|extremum| extremum.kind == Kind::Minimum).count(), 2);
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "V: serde::Serialize, S: serde::Serialize, S::Width: serde::Serialize",
        deserialize = "V: serde::Deserialize<'de>, S: serde::Deserialize<'de>, S::Width: serde::Deserialize<'de>"
    ))
)]
pub struct Hierarchy<V, S: Scalar> {
    #[cfg_attr(feature = "serde", serde(deserialize_with = "ranked_extrema"))]
    extrema: Vec<Extremum<V, S>>,
}

impl<V: Copy, S: Scalar> Persistence<V, S> {
    /// Minima and maxima together, by their persistence.
    pub fn hierarchy(&self) -> Hierarchy<V, S> {
        Hierarchy::new(self)
    }
}

impl<V: Copy, S: Scalar> Hierarchy<V, S> {
    /// Ranks the pairs of both directions. Of equally persistent extrema a maximum comes first.
    pub fn new(persistence: &Persistence<V, S>) -> Self {
        let mut extrema: Vec<_> = ranked(&persistence.maxima).chain(ranked(&persistence.minima)).collect();
        extrema.sort_by(|a, b| wider_first(&a.persistence, &b.persistence));
        Self { extrema }
    }

    /// All extrema, most persistent first.
    pub fn extrema(&self) -> &[Extremum<V, S>] {
        &self.extrema
    }

    /// The `n` most persistent extrema of either kind, or all if there are fewer.
    pub fn by_persistence(&self, n: usize) -> &[Extremum<V, S>] {
        &self.extrema[..n.min(self.extrema.len())]
    }

    /// The extrema of persistence strictly above a threshold.
    pub fn above(&self, threshold: S::Width) -> &[Extremum<V, S>] {
        let count = self.extrema.partition_point(|extremum| extremum.persistence > threshold);
        &self.extrema[..count]
    }

    /// The most persistent maximum, minimum, second maximum, second minimum, …: `n` of them, or all if there are fewer.
    /// Where one kind has run out the other goes on.
    pub fn alternating(&self, n: usize) -> impl Iterator<Item = &Extremum<V, S>> {
        let mut maxima = self.of_kind(Kind::Maximum);
        let mut minima = self.of_kind(Kind::Minimum);
        let mut maximum_is_next = false;
        core::iter::from_fn(move || {
            maximum_is_next = !maximum_is_next;
            if maximum_is_next {
                maxima.next().or_else(|| minima.next())
            } else {
                minima.next().or_else(|| maxima.next())
            }
        })
        .take(n)
    }

    /// The extrema of one kind, most persistent first.
    pub fn of_kind(&self, kind: Kind) -> impl Iterator<Item = &Extremum<V, S>> {
        self.extrema.iter().filter(move |extremum| extremum.kind == kind)
    }
}

fn ranked<V: Copy, S: Scalar>(pairs: &Pairs<V, S>) -> impl Iterator<Item = Extremum<V, S>> {
    pairs.ranked().into_iter().map(|pair| Extremum::new(&pair, pairs.kind()))
}

/// Reads extrema; what does not come by falling persistence is refused, as the order is relied upon.
#[cfg(feature = "serde")]
fn ranked_extrema<'de, V, S, R>(reader: R) -> Result<Vec<Extremum<V, S>>, R::Error>
where
    V: serde::Deserialize<'de>,
    S: Scalar<Width: serde::Deserialize<'de>> + serde::Deserialize<'de>,
    R: serde::Deserializer<'de>,
{
    let extrema: Vec<Extremum<V, S>> = serde::Deserialize::deserialize(reader)?;
    let is_ranked = extrema.is_sorted_by(|a, b| a.persistence >= b.persistence);
    // NaN is not.
    let is_valid = is_ranked && extrema.iter().all(|extremum| extremum.persistence >= num_traits::Zero::zero());
    is_valid.then_some(extrema).ok_or_else(|| serde::de::Error::custom("the list is not sorted by falling persistence"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use petgraph::graph::UnGraph;

    fn hierarchy(edges: &[(u32, u32)], field: &[i32]) -> Hierarchy<petgraph::graph::NodeIndex, i32> {
        crate::persistence(&UnGraph::<(), ()>::from_edges(edges), field)
            .expect("one value for every vertex")
            .hierarchy()
    }

    #[test]
    fn it_begins_with_the_global_maximum_and_minimum() {
        let hierarchy = hierarchy(&[(0, 1), (1, 2), (2, 3)], &[3, 9, 0, 5]);
        let first: Vec<_> =
            hierarchy.alternating(2).map(|extremum| (extremum.vertex.index(), extremum.saddle)).collect();
        assert_eq!(first, [(1, None), (2, None)]);
        assert!(hierarchy.by_persistence(2).iter().all(|extremum| extremum.persistence == 9));
    }

    #[test]
    fn one_kind_goes_on_where_the_other_has_run_out() {
        // A star: one minimum, three maxima.
        let hierarchy = hierarchy(&[(0, 1), (0, 2), (0, 3)], &[0, 1, 2, 3]);
        let order: Vec<_> = hierarchy.alternating(9).map(|extremum| extremum.vertex.index()).collect();
        assert_eq!(order, [3, 0, 2, 1]);
    }
}
