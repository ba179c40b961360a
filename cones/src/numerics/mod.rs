//! Small dense systems and a minimiser: no geometry.

pub(crate) mod dense;
pub(crate) mod lattice;
pub(crate) mod lbfgs;
pub(crate) mod quadratic_program;
