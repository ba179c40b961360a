//! The laws, each a function of bytes that panics where one does not hold.
//!
//! [`obj`], [`field`] and [`surface`] are all laws of a subject at once, for fuzzing.

#![allow(clippy::missing_panics_doc, reason = "a law panics where it does not hold")]

mod files;
mod flattening;
mod operators;
mod persistence;
mod preparing;
mod refinement;

pub use files::{obj_is_given_back, reading};
pub use flattening::{
    Reached, cones_flatten, every_vertex_a_cone_unfolds, files_unwrap, insults_unwrap, options, options_unwrap,
};
pub use operators::{flips, laplacian, poisson, seams};
pub use persistence::{domains, hierarchy, pairing, relabelled};
pub use preparing::preparing;
pub use refinement::refinement;

use geom::shapes::Shape;
use geom::{Mesh, Metric};

/// Every law of OBJ files.
pub fn obj(bytes: &[u8]) {
    reading(bytes, "a.obj");
    obj_is_given_back(bytes);
}

/// Every law of fields on graphs and other domains.
pub fn field(bytes: &[u8]) {
    pairing(bytes);
    relabelled(bytes);
    hierarchy(bytes);
    domains(bytes);
}

/// Every law of small manifold surfaces.
pub fn surface(bytes: &[u8]) {
    flips(bytes);
    laplacian(bytes);
    poisson(bytes);
    seams(bytes);
    cones_flatten(bytes);
    every_vertex_a_cone_unfolds(bytes);
}

/// The lengths that a surface of this shape is computed with: those in space, unless a triangle has no area.
fn metric_of(mesh: &Mesh, shape: &Shape) -> Metric {
    let metric = Metric::from_points(mesh, &shape.points);
    let is_degenerate = mesh.faces().any(|f| metric.sides(mesh, f).area() <= 0.0);
    if is_degenerate { metric.mollified(mesh, Metric::MOLLIFICATION) } else { metric }
}

/// Asserts that two numbers agree to `tolerance`, relative to `size`.
#[track_caller]
fn assert_close(a: f64, b: f64, tolerance: f64, size: f64) {
    assert!((a - b).abs() <= tolerance * size, "{a} and {b} differ by more than {tolerance:e} of {size}");
}
