//! Sparse symmetric matrices and their factorization. Nothing here knows of meshes.
//!
//! A [`SymmetricMatrix`] is ordered (`dissection`, or approximate minimum degree), the work of its factorization is laid out from
//! its pattern alone (`elimination`), the values are factored front by front (`cholesky`, `factorization`, `front`), and the factor is asked
//! by `substitution` and `single`; also for other matrices that differ little from the factored one (`perturbed`).

mod cholesky;
mod dissection;
mod elimination;
mod error;
mod factorization;
mod front;
mod gram;
mod graph;
mod perturbed;
mod registers;
mod single;
mod substitution;
mod symmetric;

pub use cholesky::Cholesky;
pub use error::CholeskyError;
pub use factorization::factorizations;
pub use gram::{gram, gram_watched};
pub use symmetric::SymmetricMatrix;
