//! Fields that are computed from a mesh.

use geom::{Model, distance_along_edges, gaussian_curvature, mean_curvature};

/// Which field, of those that need no solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Computed {
    /// The angle defect over the vertex's area.
    Gaussian,
    /// Half the sum of the principal curvatures.
    Mean,
    /// A coordinate: 0, 1, 2.
    Height(usize),
    /// Along edges, from a vertex or from the one farthest out.
    Distance(Option<usize>),
}

impl Computed {
    /// The field of a name, if there is one.
    pub(super) fn by_name(name: &str) -> Option<Self> {
        let (name, more) = name.split_once(':').map_or((name, None), |(name, more)| (name, Some(more)));
        match (name, more) {
            ("curvature", None) => Some(Self::Gaussian),
            ("mean-curvature", None) => Some(Self::Mean),
            ("height", None) => Some(Self::Height(2)),
            ("height", Some(axis)) => ["x", "y", "z"].iter().position(|known| *known == axis).map(Self::Height),
            ("distance", None) => Some(Self::Distance(None)),
            ("distance", Some(vertex)) => vertex.parse().ok().map(|vertex| Self::Distance(Some(vertex))),
            _ => None,
        }
    }

    /// The field on the triangles of a model, NaN where it has none.
    pub(super) fn on(self, model: &Model, triangles: &[[u32; 3]]) -> Vec<f64> {
        let points = model.points();
        match self {
            Self::Gaussian => gaussian_curvature(points, triangles),
            Self::Mean => mean_curvature(points, triangles),
            Self::Height(axis) => points.iter().map(|point| point[axis]).collect(),
            Self::Distance(from) => distance_along_edges(points, triangles, from),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_have_names_and_some_a_choice() {
        assert_eq!(Computed::by_name("height:y"), Some(Computed::Height(1)));
        assert_eq!(Computed::by_name("distance:17"), Some(Computed::Distance(Some(17))));
        assert_eq!(Computed::by_name("distance:-1"), None);
        assert_eq!(Computed::by_name("curvature:x"), None);
    }
}
