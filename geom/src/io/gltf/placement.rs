//! Where meshes stand: the tree of nodes with their transformations.

use super::super::error::{Fault, Place};
use super::document::{Document, Node};

/// An affine map: columns of its linear part, and what is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transformation {
    columns: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Transformation {
    pub(super) const IDENTITY: Self =
        Self { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// A node's own transformation: its matrix, or scale, then rotation, then translation.
    fn of(node: &Node) -> Self {
        if let Some(m) = &node.matrix {
            let column = |k: usize| [m[4 * k], m[4 * k + 1], m[4 * k + 2]];
            return Self { columns: [column(0), column(1), column(2)], translation: column(3) };
        }
        let [x, y, z, w] = node.rotation.as_deref().copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let rotation = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        let scale = node.scale.as_deref().copied().unwrap_or([1.0; 3]);
        let columns = std::array::from_fn(|k| rotation[k].map(|x| x * scale[k]));
        Self { columns, translation: node.translation.as_deref().copied().unwrap_or_default() }
    }

    /// First `inner`, then this one.
    fn after(&self, inner: &Self) -> Self {
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

    fn cofactors(&self) -> [[f64; 3]; 3] {
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let [a, b, c] = self.columns;
        [cross(b, c), cross(c, a), cross(a, b)]
    }
}

/// The meshes of the scene with where they stand, in the order of a walk down the tree. Without scenes all nodes are there,
/// and without nodes all meshes. A mesh with a skin stays where it was made, as its node does not move it.
pub(super) fn instances(document: &Document) -> Result<Vec<(usize, Transformation)>, Fault> {
    if document.nodes.is_empty() {
        return Ok((0..document.meshes.len()).map(|mesh| (mesh, Transformation::IDENTITY)).collect());
    }
    let scene = document.scenes.get(document.scene.unwrap_or(0));
    let roots = scene.map_or_else(|| roots(document), |scene| scene.nodes.clone());
    let mut is_met = vec![false; document.nodes.len()];
    let mut found = Vec::new();
    let mut stack: Vec<(usize, Transformation)> =
        roots.iter().rev().map(|&node| (node, Transformation::IDENTITY)).collect();
    while let Some((number, outer)) = stack.pop() {
        let node = document.nodes.get(number);
        let node = node.ok_or_else(|| Fault::unexpected(Place::File, format!("no node {number}"), "one"))?;
        if std::mem::replace(&mut is_met[number], true) {
            let found = format!("node {number} in two places of the scene");
            return Err(Fault::unexpected(Place::File, found, "a tree"));
        }
        let here = outer.after(&Transformation::of(node));
        if let Some(mesh) = node.mesh {
            found.push((mesh, if node.skin.is_some() { Transformation::IDENTITY } else { here }));
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, here)));
    }
    Ok(found)
}

/// The nodes that are no children.
fn roots(document: &Document) -> Vec<usize> {
    let mut is_child = vec![false; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    (0..is_child.len()).filter(|&node| !is_child[node]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_stay_perpendicular_and_outside_under_any_transformation() {
        let node = Node {
            scale: Some(Box::new([2.0, -0.5, 3.0])),
            rotation: Some(Box::new([0.5, 0.5, 0.5, 0.5])),
            translation: Some(Box::new([7.0, 8.0, 9.0])),
            ..Node::default()
        };
        let map = Transformation::of(&node);
        assert!(map.mirrors());
        // The rotation takes x to y, y to z and z to x.
        assert_eq!(map.point([1.0, 0.0, 0.0]), [7.0, 10.0, 9.0]);
        assert_eq!(map.point([0.0, 0.0, 1.0]), [10.0, 8.0, 9.0]);
        let (normal, tangent) = ([0.6, 0.8, 0.0], [0.8, -0.6, 0.0]);
        let (moved, along) = (map.normal(normal), map.direction(tangent));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        assert!(dot(moved, along).abs() < 1e-12 && (dot(moved, moved) - 1.0).abs() < 1e-12);
        assert!(dot(moved, map.direction(normal)) > 0.0, "what was outside stays outside");
        let twice = map.after(&map);
        assert_eq!(twice.point([1.0, 2.0, 3.0]), map.point(map.point([1.0, 2.0, 3.0])));
    }
}
