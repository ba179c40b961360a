//! Flattened surfaces for unit tests.

use geom::{Mesh, Metric, VertexData, VertexId, Watch, shapes};

use super::layout::Layout;
use super::scaling::{Scaling, scale};
use super::seams::Seams;
use crate::field::Operators;

/// A surface flattened with cones that share its curvature evenly.
pub(crate) struct Flattened {
    pub(crate) mesh: Mesh,
    pub(crate) metric: Metric,
    pub(crate) scaling: Scaling,
    pub(crate) seams: Seams,
    pub(crate) layout: Layout,
}

impl Flattened {
    pub(crate) fn new(shape: &shapes::Shape, cones: &[VertexId]) -> Self {
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let operators = Operators::new(&mesh, &metric).unwrap();
        let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
        cones.iter().for_each(|&v| target[v] = operators.total_curvature() / cones.len() as f64);
        let zero = VertexData::constant(mesh.vertex_count(), 0.0);
        let scaling = scale(&mesh, &metric, &operators, &target, &zero, Watch::NONE).unwrap();
        let seams = Seams::new(&mesh, metric.lengths(), cones, Watch::NONE).unwrap();
        let layout = Layout::new(&mesh, &scaling, &seams.cut, Watch::NONE).unwrap();
        Self { mesh, metric, scaling, seams, layout }
    }
}
