//! Mending.
use geom::{Mesh, Metric};
use thiserror::Error;
use crate::layout::Layout;
use crate::scaling::Scaling;
/// Why.
#[derive(Clone, Debug, Error)]
#[error("triangles stay flipped")]
pub struct MendError;
pub(crate) fn mend(_input: &Mesh, _metric: &Metric, _scaling: &Scaling, _layout: &mut Layout) -> Result<(), MendError> {
    Ok(())
}
