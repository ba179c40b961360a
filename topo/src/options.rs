//! The choices a caller has, and the one way in to everything that is computed of a field.

use crate::simplify;
use crate::sweep;
use crate::{
    Direction, Domain, Falling, FieldError, Filtration, Kind, MergeTree, NanPolicy, Pairs, Persistence, Rising, Scalar,
    Segmentation,
};

/// How to compute persistence where the defaults will not do.
///
/// ```
/// use topo::{NanPolicy, Options};
///
/// let path = petgraph::graph::UnGraph::<(), ()>::from_edges([(0, 1), (1, 2), (2, 3)]);
/// let masked = Options::new().nan(NanPolicy::Mask).sublevel(&path, &[1.0, f64::NAN, 2.0, 2.0])?;
/// assert_eq!(masked.essential().count(), 2); // the masked vertex cuts the path in two
/// # Ok::<(), topo::FieldError>(())
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct Options {
    nan: NanPolicy,
    keep_zeros: bool,
    plain: bool,
}

impl Options {
    /// NaN is refused, pairs of zero persistence are dropped, the fastest algorithm is used.
    pub fn new() -> Self {
        Self::default()
    }

    /// What to do with NaN.
    pub fn nan(self, nan: NanPolicy) -> Self {
        Self { nan, ..self }
    }

    /// Keeps the finite pairs whose extremum and saddle have equal values, as plateaus and ties produce them.
    pub fn keep_zeros(self) -> Self {
        Self { keep_zeros: true, ..self }
    }

    /// Uses the plain sweep over all sorted vertices: slower, with the same result. For tests and comparisons.
    pub fn plain_sweep(self) -> Self {
        Self { plain: true, ..self }
    }

    /// [`sublevel`](fn@crate::sublevel) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`FieldError`].
    pub fn sublevel<G: Domain, S: Scalar>(self, domain: G, field: &[S]) -> Result<Pairs<G::Vertex, S>, FieldError> {
        self.pairs::<G, S, Rising>(domain, field)
    }

    /// [`superlevel`](fn@crate::superlevel) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`FieldError`].
    pub fn superlevel<G: Domain, S: Scalar>(self, domain: G, field: &[S]) -> Result<Pairs<G::Vertex, S>, FieldError> {
        self.pairs::<G, S, Falling>(domain, field)
    }

    /// [`persistence`](fn@crate::persistence) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`FieldError`].
    pub fn persistence<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
    ) -> Result<Persistence<G::Vertex, S>, FieldError> {
        Ok(Persistence { minima: self.sublevel(domain, field)?, maxima: self.superlevel(domain, field)? })
    }

    /// [`merge_tree`](fn@crate::merge_tree) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`FieldError`].
    pub fn merge_tree<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        kind: Kind,
    ) -> Result<MergeTree<G::Vertex, S>, FieldError> {
        let count = domain.vertex_count();
        Ok(match kind {
            Kind::Minimum => MergeTree::new(domain, &Filtration::<S, Rising>::new(field, count, self.nan)?),
            Kind::Maximum => MergeTree::new(domain, &Filtration::<S, Falling>::new(field, count, self.nan)?),
        })
    }

    /// [`segmentation`](fn@crate::segmentation) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`FieldError`].
    pub fn segmentation<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        kind: Kind,
        threshold: S::Width,
    ) -> Result<Segmentation<G::Vertex>, FieldError> {
        let count = domain.vertex_count();
        Ok(match kind {
            Kind::Minimum => {
                Segmentation::new(domain, &Filtration::<S, Rising>::new(field, count, self.nan)?, threshold)
            }
            Kind::Maximum => {
                Segmentation::new(domain, &Filtration::<S, Falling>::new(field, count, self.nan)?, threshold)
            }
        })
    }

    /// [`simplify`](fn@crate::simplify) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`FieldError`].
    pub fn simplify<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        threshold: S::Width,
    ) -> Result<Vec<S>, FieldError> {
        simplify::until_settled(domain, field, threshold, self.nan)
    }

    fn pairs<G: Domain, S: Scalar, D: Direction>(
        self,
        domain: G,
        field: &[S],
    ) -> Result<Pairs<G::Vertex, S>, FieldError> {
        let filtration = Filtration::<S, D>::new(field, domain.vertex_count(), self.nan)?;
        let merges = if self.plain { sweep::merges(domain, &filtration) } else { domain.merges(&filtration) };
        Ok(Pairs::from_merges(domain, &filtration, &merges, self.keep_zeros))
    }
}
