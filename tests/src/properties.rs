//! The laws, each a function of bytes that panics where one does not hold.

mod files;
mod flattening;
mod operators;
mod persistence;
mod preparing;

pub use files::{obj_is_given_back, reading};
pub use flattening::{cones_flatten, every_vertex_a_cone_unfolds, insults_unwrap};
pub use operators::{flips, laplacian, poisson, seams};
pub use persistence::{hierarchy, pairing, relabelled};
pub use preparing::preparing;

/// Asserts that two numbers agree to `tolerance`, relative to `size`.
#[track_caller]
fn assert_close(a: f64, b: f64, tolerance: f64, size: f64) {
    assert!((a - b).abs() <= tolerance * size, "{a} and {b} differ by more than {tolerance:e} of {size}");
}
