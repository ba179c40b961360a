//! A mesh to compare methods on.

use crate::commands::shared::warn;
use crate::error::CommandError;
use cones::Operators;
use geom::{Metric, Model, Poisson, PoissonError, Surface, VertexId, prepare};
use std::path::Path;
use std::time::Instant;

/// A mesh with its surfaces made ready.
#[derive(Debug)]
pub(super) struct PreparedModel {
    pub(super) name: String,
    pub(super) model: Model,
    pub(super) parts: Vec<Part>,
}

/// A surface with a metric whose Laplacian can be factored.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) surface: Surface,
    pub(super) metric: Metric,
    /// What the floor factors.
    operators: Operators,
}

impl PreparedModel {
    /// Makes a model ready, and says on stderr what was mended.
    pub(super) fn new(name: String, model: Model) -> Result<Self, CommandError> {
        let failed = |error: cones::Error| CommandError::Unwrap { path: Path::new(&name).to_owned(), error };
        let prepared = prepare(&model, false).map_err(|error| failed(error.into()))?;
        warn(&prepared.repairs, &[]);
        let parts: Result<Vec<Part>, PoissonError> = prepared.surfaces.into_iter().map(Part::new).collect();
        let parts = parts.map_err(|error| failed(error.into()))?;
        Ok(Self { name, model, parts })
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.parts.iter().map(|part| part.surface.mesh.vertex_count()).sum()
    }

    /// The seconds that preparing the model takes.
    pub(super) fn preparing(&self) -> f64 {
        let start = Instant::now();
        // It was prepared before, and so it can be.
        let _ = std::hint::black_box(prepare(&self.model, false));
        start.elapsed().as_secs_f64()
    }

    /// The seconds that one plain factorization of the Laplacian takes, its ordering included.
    pub(super) fn floor(&self) -> f64 {
        let start = Instant::now();
        for Part { surface, operators, .. } in &self.parts {
            let boundary: Vec<VertexId> =
                surface.mesh.vertices().filter(|&v| surface.mesh.is_boundary_vertex(v)).collect();
            // It was factored before, and so it can be.
            let _ = std::hint::black_box(Poisson::with_points(&operators.laplacian, &boundary, &surface.points));
        }
        start.elapsed().as_secs_f64()
    }
}

impl Part {
    fn new(surface: Surface) -> Result<Self, PoissonError> {
        let metric = surface.metric();
        match Operators::with_points(&surface.mesh, &metric, &surface.points) {
            Err(PoissonError::NotPositiveDefinite) => {
                let metric = metric.mollified(&surface.mesh, Metric::MOLLIFICATION);
                Ok(Self {
                    operators: Operators::with_points(&surface.mesh, &metric, &surface.points)?,
                    surface,
                    metric,
                })
            }
            operators => Ok(Self { operators: operators?, surface, metric }),
        }
    }
}
