//! Built-in shapes for documentation, tests, benches and demonstrations.
//!
//! All are oriented manifolds, counter-clockwise seen from outside (from above, where there is no outside), about two
//! units large, and the same bits on every run. Their `vertices` argument is how many vertices are wanted; the shape has
//! about so many, and at least as many as it needs to be itself.
//!
//! | name | topology | what it is for |
//! |---|---|---|
//! | `sphere` `capsule` | sphere | known curvature |
//! | `torus` `torus-2` `torus-3` … | genus 1, 2, 3 … 255 | handles |
//! | `disk` `square` | disk | flat already |
//! | `cone` `saddle-cone` | disk | flat but for one vertex of curvature π/3, -2π/3 |
//! | `cylinder` | annulus | flat, with two boundary loops |
//! | `hare` | sphere | a creature: smooth, with limbs and ears that ask for cones |
//! | `part` | sphere | a machine part: flat and round faces that meet in sharp edges |
//! | `terrain` | disk | the paper's Fig. 3: eight hills round a higher ninth, and noise |
//!
//! Shapes given by a formula are laid out on rings and rows (`patch`). The others are given as the zero set of a
//! function, marched (`implicit`) and remeshed to the length that is asked for (`remesh`).

mod genus;
mod hare;
mod implicit;
mod part;
mod patch;
mod plain;
mod remesh;
mod terrain;

pub use genus::torus;
pub use hare::hare;
pub use part::part;
pub use plain::{capsule, cone, cylinder, disk, saddle_cone, sphere, square};
pub use terrain::terrain;

use crate::mesh::Mesh;
use crate::surface::Model;
use crate::vector::{Vec3, length, normal};

/// More vertices than this no shape is given.
pub const MAX_VERTICES: usize = 4_000_000;

/// Points and the triangles between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// Where the vertices are.
    pub points: Vec<[f64; 3]>,
    /// The vertices of each triangle, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// The connectivity.
    ///
    /// ```
    /// let mesh = geom::shapes::torus(3, 5000).mesh();
    /// assert_eq!(mesh.genus(), 3);
    /// ```
    ///
    /// # Panics
    /// If the shape was changed and is no oriented manifold any more; the built-in ones are.
    pub fn mesh(&self) -> Mesh {
        Mesh::new(self.points.len(), &self.triangles).expect("built-in shapes are oriented manifolds")
    }

    /// The area of the surface.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|&t| 0.5 * length(normal(self.corners(t)))).sum()
    }

    fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|v| self.points[v as usize])
    }
}

/// The shape as if it had been read from a file.
///
/// # Panics
/// If the shape was changed and is no [`Model`] any more: by an index out of range, or a coordinate that is not finite.
impl From<Shape> for Model {
    fn from(shape: Shape) -> Self {
        Self::from_triangles(shape.points, &shape.triangles).expect("built-in shapes are finite and have triangles")
    }
}

/// What [`by_name`] knows, in the order of the module's table. `torus-2` stands for `torus-G` with any G up to 255.
pub const NAMES: [&str; 12] = [
    "sphere",
    "capsule",
    "torus",
    "torus-2",
    "disk",
    "square",
    "cone",
    "saddle-cone",
    "cylinder",
    "hare",
    "part",
    "terrain",
];

/// The built-in shape of a name, with about `vertices` vertices; nothing if there is no such shape.
///
/// ```
/// use geom::shapes;
/// assert_eq!(shapes::by_name("sphere", 1000).unwrap().mesh().euler_characteristic(), 2);
/// assert_eq!(shapes::by_name("torus-7", 5000).unwrap().mesh().genus(), 7);
/// assert!(shapes::by_name("teapot", 1000).is_none());
/// ```
pub fn by_name(name: &str, vertices: usize) -> Option<Shape> {
    if let Some(genus) = name.strip_prefix("torus-") {
        return Some(torus(genus.parse().ok()?, vertices));
    }
    let shape = match name {
        "sphere" => sphere(vertices),
        "capsule" => capsule(vertices),
        "torus" => torus(1, vertices),
        "disk" => disk(vertices),
        "square" => square(vertices),
        "cone" => cone(5, vertices),
        "saddle-cone" => saddle_cone(vertices),
        "cylinder" => cylinder(vertices),
        "hare" => hare(vertices),
        "part" => part(vertices),
        "terrain" => terrain(vertices, 3),
        _ => return None,
    };
    Some(shape)
}

/// The least n with `count(n)` at least the vertices wanted.
fn least(vertices: usize, count: impl Fn(usize) -> usize) -> usize {
    let wanted = vertices.min(MAX_VERTICES);
    let (mut low, mut high) = (0, 1);
    while count(high) < wanted {
        low = high;
        high *= 2;
    }
    while high - low > 1 {
        let middle = low.midpoint(high);
        if count(middle) < wanted { low = middle } else { high = middle }
    }
    high
}

/// The side of the equilateral triangles that cover an area with so many vertices: A = 2n · √3/4 · l².
fn edge_length(area: f64, vertices: usize) -> f64 {
    (2.0 * area / (3f64.sqrt() * vertices.min(MAX_VERTICES) as f64)).sqrt()
}

#[cfg(test)]
mod tests;
