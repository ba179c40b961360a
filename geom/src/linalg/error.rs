//! Why a factorization fails.

use thiserror::Error;

use crate::watch::Interrupted;

/// Why a matrix cannot be factored.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum CholeskyError {
    /// A pivot is not positive.
    #[error("the matrix is not positive definite")]
    NotPositiveDefinite,
    /// The factor does not fit into memory.
    #[error("there is not enough memory to factor a matrix of {0} rows")]
    OutOfMemory(usize),
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}
