//! Affine maps, as nodes of a scene have them.

use crate::surface::NodePlace;

/// An affine map: columns of its linear part, and what is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transformation {
    columns: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Transformation {
    pub(super) const IDENTITY: Self =
        Self { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// Of a node where the one is that it hangs on.
    pub(super) fn of(place: &NodePlace) -> Self {
        let (translation, rotation, scale) = match place {
            NodePlace::Matrix(m) => {
                let column = |k: usize| [m[4 * k], m[4 * k + 1], m[4 * k + 2]];
                return Self { columns: [column(0), column(1), column(2)], translation: column(3) };
            }
            NodePlace::Parts { translation, rotation, scale } => (translation, rotation, scale),
        };
        let [x, y, z, w] = rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let rotation = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        let scale = scale.unwrap_or([1.0; 3]);
        let columns = std::array::from_fn(|k| rotation[k].map(|x| x * scale[k]));
        Self { columns, translation: translation.unwrap_or_default() }
    }

    /// First `inner`, then this one.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self { columns: inner.columns.map(|column| self.direction(column)), translation: self.point(inner.translation) }
    }

    pub(super) fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let moved = self.direction(point);
        std::array::from_fn(|i| moved[i] + self.translation[i])
    }

    fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.columns;
        std::array::from_fn(|i| a[i] * x + b[i] * y + c[i] * z)
    }

    /// Whether it turns what is left into what is right.
    pub(super) fn mirrors(&self) -> bool {
        let cofactors = self.cofactors();
        (0..3).map(|i| self.columns[0][i] * cofactors[0][i]).sum::<f64>() < 0.0
    }

    /// Where it takes a normal: cofactors are the inverse transposed but for a factor, whose sign is that of the determinant.
    pub(super) fn normal(&self, normal: [f64; 3]) -> [f64; 3] {
        let moved = Self { columns: self.cofactors(), ..*self }.direction(normal);
        let length = moved.iter().map(|x| x * x).sum::<f64>().sqrt();
        let sign = if self.mirrors() { -1.0 } else { 1.0 };
        if length > 0.0 { moved.map(|x| sign * x / length) } else { [0.0; 3] }
    }

    /// The way back, if there is one.
    pub(super) fn inverse(&self) -> Option<Self> {
        let cofactors = self.cofactors();
        let determinant: f64 = (0..3).map(|i| self.columns[0][i] * cofactors[0][i]).sum();
        let columns = std::array::from_fn(|i| std::array::from_fn(|k| cofactors[k][i] / determinant));
        let back = Self { columns, translation: [0.0; 3] };
        let inverse = Self { translation: back.direction(self.translation.map(|x| -x)), ..back };
        let is_finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        (is_finite(columns.as_flattened()) && is_finite(&inverse.translation)).then_some(inverse)
    }

    fn cofactors(&self) -> [[f64; 3]; 3] {
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let [a, b, c] = self.columns;
        [cross(b, c), cross(c, a), cross(a, b)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_stay_perpendicular_and_outside_under_any_transformation() {
        let map = Transformation::of(&NodePlace::Parts {
            scale: Some([2.0, -0.5, 3.0]),
            rotation: Some([0.5, 0.5, 0.5, 0.5]),
            translation: Some([7.0, 8.0, 9.0]),
        });
        assert!(map.mirrors());
        // The rotation takes x to y, y to z and z to x.
        assert_eq!(map.point([1.0, 0.0, 0.0]), [7.0, 10.0, 9.0]);
        assert_eq!(map.point([0.0, 0.0, 1.0]), [10.0, 8.0, 9.0]);
        let (normal, tangent) = ([0.6, 0.8, 0.0], [0.8, -0.6, 0.0]);
        let (moved, along) = (map.normal(normal), map.direction(tangent));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        assert!(dot(moved, along).abs() < 1e-12 && (dot(moved, moved) - 1.0).abs() < 1e-12);
        assert!(dot(moved, map.direction(normal)) > 0.0, "what was outside stays outside");
        let back = map.inverse().unwrap();
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
        assert!(near(back.point(map.point([1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]) && near(back.normal(moved), normal));
        let flat = NodePlace::Parts { translation: None, rotation: None, scale: Some([1.0, 0.0, 1.0]) };
        assert_eq!(Transformation::of(&flat).inverse(), None);
        let twice = map.after(&map);
        assert_eq!(twice.point([1.0, 2.0, 3.0]), map.point(map.point([1.0, 2.0, 3.0])));
    }
}
