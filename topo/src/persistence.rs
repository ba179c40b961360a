//! The pairs of a field: extremum and saddle, birth and death.

use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Falling, Filtration, Kind, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::{Merge, sweep};
use crate::scalar::{Scalar, wider_first};
use crate::watch::Watch;
use core::cell::Cell;
use core::cmp::Ordering;
use core::ops::Deref;
use num_traits::{ToPrimitive, Zero};

/// An extremum and the saddle at which its component joins an elder one.
///
/// The eldest extremum of a connected component of the domain joins nothing: its class is *essential* and has no
/// saddle. Its persistence is the range of the field on its component, so that it comes first there.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pair<V, S> {
    /// The vertex at which the component is born.
    pub extremum: V,
    /// The vertex at which it joins an elder one; `None` if the class is essential.
    pub saddle: Option<V>,
    /// The value at the extremum.
    pub birth: S,
    /// The value at the saddle, or the last value to enter the component.
    pub(crate) end: S,
}

impl<V, S: Scalar> Pair<V, S> {
    /// The value at the saddle; `None` if the class is essential.
    pub fn death(&self) -> Option<S> {
        self.saddle.as_ref().map(|_| self.end)
    }

    /// |birth - death|, or the range of its component for an essential class.
    pub fn persistence(&self) -> S::Width {
        self.birth.width(self.end)
    }

    /// The value at the saddle, or the last value to enter the component if the class is essential: at this distance from
    /// the birth lies the [persistence](Self::persistence).
    pub fn end(&self) -> S {
        self.end
    }

    /// Whether the class lives for ever.
    pub fn is_essential(&self) -> bool {
        self.saddle.is_none()
    }

    /// Whether it dies as it is born.
    fn is_zero(&self) -> bool {
        !self.is_essential() && self.persistence().is_zero()
    }
}

/// The pairs of one direction, by rising index of their extrema: a slice of [`Pair`]s that knows what it left out.
///
/// Ranking is on request, as it may take longer than pairing: [`ranked`](Self::ranked) for all, [`top`](Self::top) for the
/// most persistent few.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(deserialize = "V: serde::Deserialize<'de>, S: Scalar + serde::Deserialize<'de>"))
)]
pub struct Pairs<V, S> {
    kind: Kind,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "valid_pairs"))]
    pairs: Vec<Pair<V, S>>,
    zero_count: usize,
}

impl<V, S> Deref for Pairs<V, S> {
    type Target = [Pair<V, S>];

    fn deref(&self) -> &[Pair<V, S>] {
        &self.pairs
    }
}

impl<V, S> IntoIterator for Pairs<V, S> {
    type Item = Pair<V, S>;
    type IntoIter = std::vec::IntoIter<Pair<V, S>>;

    fn into_iter(self) -> Self::IntoIter {
        self.pairs.into_iter()
    }
}

impl<'a, V, S> IntoIterator for &'a Pairs<V, S> {
    type Item = &'a Pair<V, S>;
    type IntoIter = std::slice::Iter<'a, Pair<V, S>>;

    fn into_iter(self) -> Self::IntoIter {
        self.pairs.iter()
    }
}

/// [`Pairs`] as one array for each of their fields, for tables and arrays of other languages.
#[derive(Debug, Clone, PartialEq)]
pub struct PairColumns<V, S> {
    /// The vertex of each extremum.
    pub extrema: Vec<V>,
    /// The vertex of each saddle; `None` if the class is essential.
    pub saddles: Vec<Option<V>>,
    /// The value at each extremum.
    pub births: Vec<S>,
    /// The value at each saddle, or the last value to enter the component, see [`Pair::end`].
    pub ends: Vec<S>,
}

impl<V: Copy, S: Scalar> Pairs<V, S> {
    /// From pairs by rising index of their extrema.
    pub(crate) fn new(kind: Kind, pairs: Vec<Pair<V, S>>, zero_count: usize) -> Self {
        Self { kind, pairs, zero_count }
    }

    /// From merges by rising index of their extrema, those of zero persistence left out and counted.
    pub(crate) fn of_merges<D: Direction>(
        filtration: &Filtration<'_, S, D>,
        merges: &[Merge],
        vertex: impl Fn(u32) -> V,
    ) -> Self {
        let pair = |merge: &Merge| Pair {
            extremum: vertex(merge.extremum),
            saddle: merge.is_finite().then(|| vertex(merge.end)),
            birth: filtration.value(merge.extremum),
            end: filtration.value(merge.end),
        };
        let pairs: Vec<_> = merges.iter().map(pair).filter(|pair| !pair.is_zero()).collect();
        let zero_count = merges.len() - pairs.len();
        Self::new(D::KIND, pairs, zero_count)
    }

    /// The pairs as arrays of vertices and values, in their order.
    pub fn columns(&self) -> PairColumns<V, S> {
        PairColumns {
            extrema: self.pairs.iter().map(|pair| pair.extremum).collect(),
            saddles: self.pairs.iter().map(|pair| pair.saddle).collect(),
            births: self.pairs.iter().map(|pair| pair.birth).collect(),
            ends: self.pairs.iter().map(|pair| pair.end).collect(),
        }
    }

    /// Whether the extrema are minima or maxima.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Number of finite pairs with extremum and saddle of equal value, whether they were kept or not.
    pub fn zero_count(&self) -> usize {
        self.zero_count
    }

    /// The pairs that have a saddle.
    pub fn finite(&self) -> impl Iterator<Item = &Pair<V, S>> {
        self.pairs.iter().filter(|pair| !pair.is_essential())
    }

    /// The classes without a saddle: one for every connected component of the domain.
    pub fn essential(&self) -> impl Iterator<Item = &Pair<V, S>> {
        self.pairs.iter().filter(|pair| pair.is_essential())
    }

    /// The pairs of persistence strictly above a threshold.
    pub fn above(&self, threshold: S::Width) -> impl Iterator<Item = &Pair<V, S>> {
        self.pairs.iter().filter(move |pair| pair.persistence() > threshold)
    }

    /// All pairs, most persistent first. Equally persistent ones stand in the order in which their extrema enter, essential
    /// classes before others. O(n log n) for n pairs.
    pub fn ranked(&self) -> Vec<Pair<V, S>> {
        let mut ranks = self.ranks();
        ranks.sort_unstable_by(|a, b| self.compare(a, b));
        self.at(&ranks)
    }

    /// The `n` most persistent pairs, or all if there are fewer: the first of what is [ranked](Self::ranked), selected
    /// without sorting the others. O(pairs + n log n).
    ///
    /// ```
    /// let peaks = topo::superlevel(&topo::Path::new(6), &[0.0, 7.0, 2.0, 5.0, 4.0, 9.0])?;
    /// let first: Vec<usize> = peaks.top(2).iter().map(|peak| peak.extremum).collect();
    /// assert_eq!(first, [5, 1]);
    /// # Ok::<(), topo::Error>(())
    /// ```
    pub fn top(&self, n: usize) -> Vec<Pair<V, S>> {
        let mut ranks = self.ranks();
        if n < ranks.len() {
            ranks.select_nth_unstable_by(n, |a, b| self.compare(a, b));
            ranks.truncate(n);
        }
        ranks.sort_unstable_by(|a, b| self.compare(a, b));
        self.at(&ranks)
    }

    /// What each pair is ranked by before all else, with its place.
    fn ranks(&self) -> Vec<(S::Width, u32)> {
        self.pairs.iter().map(Pair::persistence).zip(0..).collect()
    }

    /// Which of two pairs is ranked first. Of equally persistent extrema of one value the one whose index is lower enters
    /// first if they are minima, last if they are maxima.
    fn compare(&self, a: &(S::Width, u32), b: &(S::Width, u32)) -> Ordering {
        wider_first(&a.0, &b.0).then_with(|| {
            let [p, q] = [a, b].map(|rank| &self.pairs[rank.1 as usize]);
            let entering = p.birth.key().cmp(&q.birth.key()).then(a.1.cmp(&b.1));
            let entering = if self.kind == Kind::Minimum { entering } else { entering.reverse() };
            q.is_essential().cmp(&p.is_essential()).then(entering)
        })
    }

    fn at(&self, ranks: &[(S::Width, u32)]) -> Vec<Pair<V, S>> {
        ranks.iter().map(|rank| self.pairs[rank.1 as usize]).collect()
    }

    /// Sum of the persistences of the finite pairs.
    pub fn total_persistence(&self) -> f64 {
        // Not by `sum`, which makes -0.0 of nothing.
        self.finite().filter_map(|pair| pair.persistence().to_f64()).fold(0.0, |sum, persistence| sum + persistence)
    }
}

/// Reads pairs; one whose persistence is no number is refused.
#[cfg(feature = "serde")]
fn valid_pairs<'de, V, S, R>(reader: R) -> Result<Vec<Pair<V, S>>, R::Error>
where
    V: serde::Deserialize<'de>,
    S: Scalar + serde::Deserialize<'de>,
    R: serde::Deserializer<'de>,
{
    let pairs: Vec<Pair<V, S>> = serde::Deserialize::deserialize(reader)?;
    let is_valid = pairs.iter().all(|pair| pair.persistence() >= S::Width::zero());
    is_valid.then_some(pairs).ok_or_else(|| serde::de::Error::custom("the persistence of a pair is not a number"))
}

/// The pairs of both directions.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(deserialize = "V: serde::Deserialize<'de>, S: Scalar + serde::Deserialize<'de>"))
)]
pub struct Persistence<V, S> {
    /// Minima with the saddles at which their sublevel components merge.
    pub minima: Pairs<V, S>,
    /// Maxima with the saddles at which their superlevel components merge.
    pub maxima: Pairs<V, S>,
}

impl PersistenceOptions {
    /// [`sublevel`](fn@crate::sublevel) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`].
    pub fn sublevel<G: Domain, S: Scalar>(self, domain: G, field: &[S]) -> Result<Pairs<G::Vertex, S>, Error> {
        self.pairs::<G, S, Rising>(domain, field, Watch::NONE)
    }

    /// [`superlevel`](fn@crate::superlevel) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`].
    pub fn superlevel<G: Domain, S: Scalar>(self, domain: G, field: &[S]) -> Result<Pairs<G::Vertex, S>, Error> {
        self.pairs::<G, S, Falling>(domain, field, Watch::NONE)
    }

    /// [`persistence`](fn@crate::persistence) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`].
    pub fn persistence<G: Domain, S: Scalar>(self, domain: G, field: &[S]) -> Result<Persistence<G::Vertex, S>, Error> {
        Ok(Persistence { minima: self.sublevel(domain, field)?, maxima: self.superlevel(domain, field)? })
    }

    /// [`sublevel`](Self::sublevel) that can be stopped.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`]; [`Error::Interrupted`] if the watch has stopped the work. It is asked after
    /// each block of vertices on grids, rings and triangle meshes, on other domains while basins are paired, and at the end.
    pub fn sublevel_watched<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        watch: Watch<'_>,
    ) -> Result<Pairs<G::Vertex, S>, Error> {
        self.pairs::<G, S, Rising>(domain, field, watch)
    }

    /// [`superlevel`](Self::superlevel) that can be stopped.
    ///
    /// # Errors
    /// As those of [`sublevel_watched`](Self::sublevel_watched).
    pub fn superlevel_watched<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        watch: Watch<'_>,
    ) -> Result<Pairs<G::Vertex, S>, Error> {
        self.pairs::<G, S, Falling>(domain, field, watch)
    }

    fn pairs<G: Domain, S: Scalar, D: Direction>(
        self,
        domain: G,
        field: &[S],
        watch: Watch<'_>,
    ) -> Result<Pairs<G::Vertex, S>, Error> {
        watch.held(|watch| {
            let filtration = Filtration::<S, D>::unchecked(field, domain.vertex_count(), self.nan)?.watched(watch);
            let looks_once = domain.looks_once() && !self.plain_sweep;
            if !looks_once {
                filtration.check()?;
            }
            let zero_count = Cell::new(0);
            let pair = |merge: &Merge, birth, end| {
                let pair = Pair {
                    extremum: domain.vertex(merge.extremum as usize),
                    saddle: merge.is_finite().then(|| domain.vertex(merge.end as usize)),
                    birth,
                    end,
                };
                zero_count.update(|count| count + usize::from(pair.is_zero()));
                pair
            };
            let mut pairs = if self.plain_sweep {
                let mut pairs = Vec::new();
                for merge in sweep(domain, &filtration) {
                    pairs.push(pair(&merge, filtration.value(merge.extremum), filtration.value(merge.end)));
                }
                pairs
            } else {
                domain.map_merges(&filtration, pair)
            };
            if filtration.stops() {
                return Err(Error::Interrupted);
            }
            if looks_once && pairs.is_empty() {
                filtration.check()?;
            }
            if !self.keep_zeros && zero_count.get() > 0 {
                leave_out_zeros(&mut pairs);
            }
            Ok(Pairs::new(D::KIND, pairs, zero_count.get()))
        })
    }
}

fn leave_out_zeros<V: Copy, S: Scalar>(pairs: &mut Vec<Pair<V, S>>) {
    pairs.retain(|pair| !pair.is_zero());
}

/// The minima of a field, paired with the saddles at which the components of its sublevel sets merge.
///
/// # Errors
/// If the field does not fit the domain, see [`Error`].
pub fn sublevel<G: Domain, S: Scalar>(domain: G, field: &[S]) -> Result<Pairs<G::Vertex, S>, Error> {
    PersistenceOptions::new().sublevel(domain, field)
}

/// The maxima of a field, paired with the saddles at which the components of its superlevel sets merge.
///
/// # Errors
/// If the field does not fit the domain, see [`Error`].
pub fn superlevel<G: Domain, S: Scalar>(domain: G, field: &[S]) -> Result<Pairs<G::Vertex, S>, Error> {
    PersistenceOptions::new().superlevel(domain, field)
}

/// The pairs of both directions.
///
/// # Errors
/// If the field does not fit the domain, see [`Error`].
pub fn persistence<G: Domain, S: Scalar>(domain: G, field: &[S]) -> Result<Persistence<G::Vertex, S>, Error> {
    PersistenceOptions::new().persistence(domain, field)
}
