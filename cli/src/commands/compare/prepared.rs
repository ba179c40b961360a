//! A mesh to compare methods on.

use crate::commands::shared::warn;
use crate::error::CommandError;
use cones::Analysis;
use geom::{Metric, Model, Poisson, Surface, SymmetricMatrix, VertexId, delaunay, laplacian, prepare};
use std::path::Path;
use std::time::Instant;

/// A mesh with its surfaces made ready.
#[derive(Debug)]
pub(super) struct PreparedModel {
    pub(super) name: String,
    pub(super) model: Model,
    pub(super) surfaces: Vec<Surface>,
    /// What the floor factors: the Laplacian of each surface, and the vertices that it is held at.
    laplacians: Vec<(SymmetricMatrix, Vec<VertexId>)>,
}

impl PreparedModel {
    /// Makes a model ready, and says on stderr what was repaired.
    pub(super) fn new(name: String, model: Model) -> Result<Self, CommandError> {
        let failed = |error: cones::Error| CommandError::Unwrap { path: Path::new(&name).to_owned(), error };
        let analysis = Analysis::new(&model).map_err(failed)?;
        warn(analysis.repairs(), analysis.notes(), analysis.topology().components);
        let surfaces = prepare(&model, geom::Weld::Auto).map_err(|error| failed(error.into()))?.surfaces;
        let laplacians = surfaces.iter().map(factorable).collect();
        Ok(Self { name, model, surfaces, laplacians })
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.surfaces.iter().map(|surface| surface.mesh.vertex_count()).sum()
    }

    /// The seconds that one plain factorization of the Laplacian takes, its ordering included.
    pub(super) fn floor(&self) -> f64 {
        let start = Instant::now();
        for (surface, (laplacian, boundary)) in self.surfaces.iter().zip(&self.laplacians) {
            // It was factored before, and so it can be.
            let _ = std::hint::black_box(Poisson::with_points(laplacian, boundary, &surface.points));
        }
        start.elapsed().as_secs_f64()
    }
}

/// The Laplacian of a surface, of mollified lengths where it cannot be factored otherwise.
fn factorable(surface: &Surface) -> (SymmetricMatrix, Vec<VertexId>) {
    let mesh = &surface.mesh;
    let boundary: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
    let of = |metric: &Metric| {
        let intrinsic = delaunay(mesh, metric);
        laplacian(&intrinsic.triangulation, &intrinsic.metric)
    };
    let metric = surface.metric();
    let plain = of(&metric);
    match Poisson::with_points(&plain, &boundary, &surface.points) {
        Ok(_) => (plain, boundary),
        Err(_) => (of(&metric.mollified(mesh, Metric::MOLLIFICATION)), boundary),
    }
}
