//! Vertices at the same place, taken for one.

use clap::{Args, ValueEnum};
use geom::{Model, RepairKind, Weld, prepare};

/// Which vertices are taken for one.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct WeldArgs {
    /// Merge vertices that are at exactly the same place [default: auto]
    #[arg(long, value_enum, value_name = "WHEN", num_args = 0..=1, require_equals = true, default_missing_value = "always")]
    weld: Option<WeldName>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum WeldName {
    /// Where two edges of the boundary meet, as along the seams and creases of many files
    Auto,
    /// None
    Never,
    /// All
    Always,
}

impl WeldArgs {
    pub(crate) fn is_given(self) -> bool {
        self.weld.is_some()
    }

    pub(crate) fn chosen(self) -> Weld {
        match self.weld {
            None | Some(WeldName::Auto) => Weld::Auto,
            Some(WeldName::Never) => Weld::Never,
            Some(WeldName::Always) => Weld::Always,
        }
    }
}

/// How many vertices on the boundary lie at the place of another one and are not taken for it.
pub(crate) fn split_vertices(model: &Model, weld: Weld) -> usize {
    let repairs = prepare(model, weld).map(|prepared| prepared.repairs).unwrap_or_default();
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
        assert_eq!(split_vertices(&model, Weld::Never), 2);
        let mut triangles = vec![[0, 1, 2], [3, 4, 5]];
        for (weld, expected) in [(Weld::Never, [3, 4, 5]), (Weld::Auto, [0, 4, 1]), (Weld::Always, [0, 4, 1])] {
            weld.apply(&model, &mut triangles);
            assert_eq!(triangles[1], expected);
        }
        assert_eq!(split_vertices(&model, Weld::Auto), 0);
    }
}
