//! Sparse symmetric matrices and their factorization. Nothing here knows of meshes.
//!
//! A [`SymmetricMatrix`] is ordered (by `dissection`, whose separators are made small by `separator` and `disjoint_paths` and whose leaves
//! are ordered by `minimum_degree`, or by approximate minimum degree), the work of its factorization is laid out from
//! its pattern alone (`elimination`), the values are factored front by front (`cholesky`, `front`), and the factor is asked
//! by `substitution`.

mod cholesky;
mod disjoint_paths;
mod dissection;
mod elimination;
mod error;
mod factorization;
mod front;
mod gram;
mod graph;
mod minimum_degree;
mod parallel;
mod separator;
mod substitution;
mod symmetric;

pub use cholesky::Cholesky;
pub use error::CholeskyError;
pub use factorization::factorizations;
pub use gram::gram;
pub use symmetric::SymmetricMatrix;
