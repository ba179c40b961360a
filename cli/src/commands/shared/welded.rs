//! Vertices at the same place, taken for one.

use geom::{Model, RepairKind, prepare};
use std::collections::HashMap;

/// For each vertex the first one at its place.
pub(crate) fn welded(model: &Model) -> Vec<u32> {
    let mut first = HashMap::with_capacity(model.vertex_count());
    // Adding 0 makes one of the two zeros.
    let place = |point: &[f64; 3]| point.map(|x| (x + 0.0).to_bits());
    (0..).zip(model.points()).map(|(v, point)| *first.entry(place(point)).or_insert(v)).collect()
}

/// How many vertices on the boundary lie at the place of another one.
pub(crate) fn split_vertices(model: &Model) -> usize {
    let repairs = prepare(model, false).map(|prepared| prepared.repairs).unwrap_or_default();
    repairs.iter().find(|repair| repair.kind == RepairKind::Unwelded).map_or(0, |repair| repair.count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_at_one_place_are_the_first_of_them() {
        let points = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-0.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
            [1.0, 0.0, 0.0],
        ];
        let model = Model::from_triangles(points, &[[0, 1, 2], [3, 4, 5]]).unwrap();
        assert_eq!(welded(&model), [0, 1, 2, 0, 4, 1]);
        assert_eq!(split_vertices(&model), 2);
    }
}
