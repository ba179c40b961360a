//! Vertices at the same place, taken for one.

use geom::{Model, RepairKind, prepare};

/// How many vertices on the boundary lie at the place of another one.
pub(crate) fn split_vertices(model: &Model) -> usize {
    let repairs = prepare(model, false).map(|prepared| prepared.repairs).unwrap_or_default();
    repairs.iter().find(|repair| repair.kind == RepairKind::Unwelded).map_or(0, |repair| repair.count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_split_along_a_seam_are_counted() {
        let points = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-0.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
            [1.0, 0.0, 0.0],
        ];
        let model = Model::from_triangles(points, &[[0, 1, 2], [3, 4, 5]]).unwrap();
        assert_eq!(split_vertices(&model), 2);
    }
}
