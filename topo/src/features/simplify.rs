//! A field without its small extrema.
//!
//! A minimum is removed by filling its basin up to the saddle, a maximum by cutting it off there; both change the field
//! by no more than the persistence. Removing extrema of one kind can make one of the other kind less persistent, so
//! both are done in turn until nothing changes. The bound holds all the same: what is filled twice is filled to at most
//! the threshold above the eldest extremum of its component, and that lies no higher than any vertex filled before.
//! Bauer, Lange & Wardetzky (2012), "Optimal topological simplification of discrete functions on surfaces", do twice as
//! well on a surface; this works on any graph.

use super::branches::Branches;
use crate::domain::Domain;
use crate::error::{Error, check_threshold};
use crate::filtration::{Direction, Falling, Filtration, NanPolicy, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::Pointing;
use crate::scalar::Scalar;
use crate::watch::Watch;

/// A field at most `threshold` away from the given one everywhere, all of whose finite pairs are more persistent than
/// that, except pairs of zero persistence on the plateaus that this leaves.
///
/// ```
/// let field = [0.0, 5.0, 3.0, 4.0, 2.0, 9.0, 1.0];
/// let smooth = topo::simplify(&topo::Path::new(7), &field, 1.0)?;
/// assert_eq!(smooth, [0.0, 5.0, 4.0, 4.0, 2.0, 9.0, 1.0]);
/// # Ok::<(), topo::Error>(())
/// ```
///
/// # Errors
/// If the field does not fit the domain, or the threshold is NaN, see [`Error`].
pub fn simplify<G: Domain, S: Scalar>(domain: G, field: &[S], threshold: S::Width) -> Result<Vec<S>, Error> {
    PersistenceOptions::new().simplify(domain, field, threshold)
}

impl PersistenceOptions {
    /// [`simplify`](fn@crate::simplify) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, or the threshold is NaN, see [`Error`].
    pub fn simplify<G: Domain, S: Scalar>(self, domain: G, field: &[S], threshold: S::Width) -> Result<Vec<S>, Error> {
        self.simplify_watched(domain, field, threshold, Watch::NONE)
    }

    /// [`simplify`](fn@crate::simplify) with these options that can be stopped.
    ///
    /// # Errors
    /// If the field does not fit the domain, or the threshold is NaN, see [`Error`]; [`Error::Interrupted`] if the watch has stopped the work.
    pub fn simplify_watched<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        threshold: S::Width,
        watch: Watch<'_>,
    ) -> Result<Vec<S>, Error> {
        check_threshold(threshold)?;
        watch.held(|watch| until_stable(domain, field, threshold, self.nan, watch))
    }
}

/// Fills and cuts in turn until nothing changes. Every round but the last removes an extremum for good.
fn until_stable<G: Domain, S: Scalar>(
    domain: G,
    field: &[S],
    threshold: S::Width,
    nan: NanPolicy,
    watch: Watch<'_>,
) -> Result<Vec<S>, Error> {
    let mut simplified = field.to_vec();
    loop {
        let filled = fill::<G, S, Rising>(domain, &simplified, threshold, nan, watch)?;
        let cut = fill::<G, S, Falling>(domain, &filled, threshold, nan, watch)?;
        let is_stable = cut.iter().zip(&simplified).all(|(new, old)| new.key() == old.key());
        simplified = cut;
        if is_stable {
            return Ok(simplified);
        }
    }
}

fn fill<G: Domain, S: Scalar, D: Direction>(
    domain: G,
    field: &[S],
    threshold: S::Width,
    nan: NanPolicy,
    watch: Watch<'_>,
) -> Result<Vec<S>, Error> {
    let filtration = Filtration::<S, D>::new(field, domain.vertex_count(), nan)?.watched(watch);
    let branches = Branches::new(domain, &filtration, Pointing::Labels)?;
    Ok(branches.filled(&filtration, &branches.longer(&filtration, threshold)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_threshold_that_is_no_number_is_refused() {
        let (path, field) = (crate::Path::new(3), [2.0, 1.0, 3.0]);
        assert_eq!(simplify(&path, &field, f64::NAN), Err(Error::Threshold));
        assert_eq!(crate::segmentation(&path, &field, crate::Kind::Minimum, f64::NAN), Err(Error::Threshold));
    }
}
