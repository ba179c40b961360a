//! All that can go wrong, in one.

use thiserror::Error;

use crate::distortion::DistortionError;
use crate::intrinsic::PoissonError;
#[cfg(feature = "files")]
use crate::io::{ReadError, WriteError};
use crate::linalg::CholeskyError;
use crate::mesh::MeshError;
use crate::surface::{AttributeError, MissingTexture, ModelError, PrepareError};
use crate::watch::Interrupted;

/// Any error of this crate, for callers that pass all of them on. Each function returns its own, which says more of what to
/// expect.
///
/// ```
/// fn factored(path: &std::path::Path) -> Result<geom::Poisson, geom::Error> {
///     let surface = geom::prepare(&geom::io::read(path)?, geom::Weld::Auto)?.surfaces.swap_remove(0);
///     Ok(geom::Poisson::new(&geom::laplacian(&surface.mesh, &surface.metric()), &[])?)
/// }
/// assert!(matches!(factored("no such file.obj".as_ref()), Err(geom::Error::Read(_))));
/// ```
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read.
    #[cfg(feature = "files")]
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file could not be written.
    #[cfg(feature = "files")]
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Points and polygons make no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Numbers make no attribute of a model.
    #[error(transparent)]
    Attribute(#[from] AttributeError),
    /// A map is not one of all corners.
    #[error(transparent)]
    Texture(#[from] MissingTexture),
    /// A model has no surface.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// Triangles do not form an oriented manifold.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A Laplacian is not factored.
    #[error(transparent)]
    Poisson(#[from] PoissonError),
    /// A matrix is not factored.
    #[error(transparent)]
    Cholesky(#[from] CholeskyError),
    /// A map cannot be measured.
    #[error(transparent)]
    Distortion(#[from] DistortionError),
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}
