//! The choices a caller has. What takes them stands with what it computes.

use crate::filtration::NanPolicy;

/// How to compute persistence where the defaults will not do.
///
/// ```
/// use topo::{NanPolicy, PersistenceOptions};
///
/// let path = petgraph::graph::UnGraph::<(), ()>::from_edges([(0, 1), (1, 2), (2, 3)]);
/// let masked = PersistenceOptions::new().nan(NanPolicy::Mask).sublevel(&path, &[1.0, f64::NAN, 2.0, 2.0])?;
/// assert_eq!(masked.essential().count(), 2); // the masked vertex cuts the path in two
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
#[must_use = "options are made anew, not changed"]
pub struct PersistenceOptions {
    pub(crate) nan: NanPolicy,
    pub(crate) keep_zeros: bool,
    pub(crate) plain_sweep: bool,
}

impl PersistenceOptions {
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
        Self { plain_sweep: true, ..self }
    }
}
