//! The pairs of a field: extremum and saddle, birth and death.

use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Falling, Filtration, Kind, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::{Merges, sweep};
use crate::scalar::{Scalar, wider_first};
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

    /// Whether the class lives for ever.
    pub fn is_essential(&self) -> bool {
        self.saddle.is_none()
    }
}

/// The pairs of one direction, most persistent first; a slice of [`Pair`]s that knows what it left out.
///
/// Equally persistent pairs stand in the order in which their extrema enter, essential classes before others.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(deserialize = "V: serde::Deserialize<'de>, S: Scalar + serde::Deserialize<'de>"))
)]
pub struct Pairs<V, S> {
    kind: Kind,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "ranked_pairs"))]
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

impl<V: Copy, S: Scalar> Pairs<V, S> {
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
    pub fn above(&self, threshold: S::Width) -> &[Pair<V, S>] {
        &self.pairs[..self.pairs.partition_point(|pair| pair.persistence() > threshold)]
    }

    /// Sum of the persistences of the finite pairs.
    pub fn total_persistence(&self) -> f64 {
        self.finite().filter_map(|pair| pair.persistence().to_f64()).sum()
    }

    pub(crate) fn from_merges<G, D>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
        merges: &Merges,
        keep_zeros: bool,
    ) -> Self
    where
        G: Domain<Vertex = V>,
        D: Direction,
    {
        let entry = |extremum, end, is_finite| Ranked {
            persistence: filtration.value(extremum).width(filtration.value(end)),
            extremum,
            end,
            is_finite,
        };
        let mut ranked: Vec<_> = merges.finite.iter().map(|merge| entry(merge.extremum, merge.saddle, true)).collect();
        let zero_count = ranked.iter().filter(|pair| pair.persistence.is_zero()).count();
        if !keep_zeros {
            ranked.retain(|pair| !pair.persistence.is_zero());
        }
        ranked.extend(merges.essential.iter().map(|&(extremum, last)| entry(extremum, last, false)));
        ranked.sort_unstable_by(|a, b| a.rank(b, filtration));
        let pairs = ranked.iter().map(|pair| pair.resolve(domain, filtration)).collect();
        Self { kind: D::KIND, pairs, zero_count }
    }
}

/// Reads what persists; what does not come by falling persistence is refused, as the order is relied upon.
#[cfg(feature = "serde")]
pub(crate) fn ranked<'de, T, W, R>(reader: R, persistence: impl Fn(&T) -> W) -> Result<Vec<T>, R::Error>
where
    T: serde::Deserialize<'de>,
    W: PartialOrd + Zero,
    R: serde::Deserializer<'de>,
{
    let ranked: Vec<T> = serde::Deserialize::deserialize(reader)?;
    let is_ranked = ranked.is_sorted_by(|a, b| persistence(a) >= persistence(b));
    // NaN is not.
    let is_valid = is_ranked && ranked.iter().all(|entry| persistence(entry) >= W::zero());
    is_valid.then_some(ranked).ok_or_else(|| serde::de::Error::custom("the list is not sorted by falling persistence"))
}

#[cfg(feature = "serde")]
fn ranked_pairs<'de, V, S, R>(reader: R) -> Result<Vec<Pair<V, S>>, R::Error>
where
    V: serde::Deserialize<'de>,
    S: Scalar + serde::Deserialize<'de>,
    R: serde::Deserializer<'de>,
{
    ranked(reader, Pair::persistence)
}

/// A pair in vertex indices with what it is sorted by.
struct Ranked<W> {
    persistence: W,
    extremum: u32,
    end: u32,
    is_finite: bool,
}

impl<W: Copy + PartialOrd> Ranked<W> {
    fn rank<S: Scalar, D: Direction>(&self, other: &Self, filtration: &Filtration<'_, S, D>) -> Ordering {
        wider_first(&self.persistence, &other.persistence)
            .then(self.is_finite.cmp(&other.is_finite))
            .then_with(|| filtration.compare(self.extremum, other.extremum))
    }

    fn resolve<G: Domain, S: Scalar, D: Direction>(
        &self,
        domain: G,
        filtration: &Filtration<'_, S, D>,
    ) -> Pair<G::Vertex, S> {
        Pair {
            extremum: domain.vertex(self.extremum as usize),
            saddle: self.is_finite.then(|| domain.vertex(self.end as usize)),
            birth: filtration.value(self.extremum),
            end: filtration.value(self.end),
        }
    }
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
        self.pairs::<G, S, Rising>(domain, field)
    }

    /// [`superlevel`](fn@crate::superlevel) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`].
    pub fn superlevel<G: Domain, S: Scalar>(self, domain: G, field: &[S]) -> Result<Pairs<G::Vertex, S>, Error> {
        self.pairs::<G, S, Falling>(domain, field)
    }

    /// [`persistence`](fn@crate::persistence) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`].
    pub fn persistence<G: Domain, S: Scalar>(self, domain: G, field: &[S]) -> Result<Persistence<G::Vertex, S>, Error> {
        Ok(Persistence { minima: self.sublevel(domain, field)?, maxima: self.superlevel(domain, field)? })
    }

    fn pairs<G: Domain, S: Scalar, D: Direction>(self, domain: G, field: &[S]) -> Result<Pairs<G::Vertex, S>, Error> {
        let filtration = Filtration::<S, D>::new(field, domain.vertex_count(), self.nan)?;
        let merges = if self.plain_sweep { sweep(domain, &filtration) } else { domain.merges(&filtration) };
        Ok(Pairs::from_merges(domain, &filtration, &merges, self.keep_zeros))
    }
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
