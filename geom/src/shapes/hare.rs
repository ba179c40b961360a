//! A creature.

use super::Shape;
use super::implicit::{blend, ellipsoid, limb, surface};
use crate::vector::Vec3;

/// A hare that sits up, y upwards and looking along z: a sphere by topology, with two ears, four limbs, a nose and a
/// tail. Its conformal factor has an extremum at the end of each, which makes it the method's own portrait.
pub fn hare(vertices: usize) -> Shape {
    surface(hare_distance, [[-1.0, -1.1, -0.95], [1.0, 1.85, 1.05]], 0.05, vertices.max(600))
}

fn hare_distance(p: Vec3) -> f64 {
    let [x, y, z] = p;
    let mirrored = [x.abs(), y, z];
    let torso = blend(
        ellipsoid([0.0, -0.42, -0.12], [0.52, 0.56, 0.50], p),
        ellipsoid([0.0, 0.05, 0.0], [0.36, 0.45, 0.33], p),
        0.2,
    );
    let head = ellipsoid([0.0, 0.58, 0.14], [0.36, 0.32, 0.36], p);
    let nose = ellipsoid([0.0, 0.53, 0.49], [0.09, 0.08, 0.10], p);
    let cheek = ellipsoid([0.12, 0.45, 0.36], [0.15, 0.12, 0.14], mirrored);
    let thigh = ellipsoid([0.42, -0.62, 0.08], [0.22, 0.34, 0.38], mirrored);
    let foot = limb([[0.42, -0.90, 0.22], [0.47, -0.91, 0.68]], [0.13, 0.13, 0.13], mirrored);
    let arm = limb([[0.30, 0.10, 0.20], [0.22, -0.15, 0.58]], [0.13, 0.12, 0.12], mirrored);
    let tail = ellipsoid([0.0, -0.66, -0.68], [0.17, 0.17, 0.17], p);
    let body = blend(torso, tail, 0.1);
    let body = blend(body, blend(thigh, foot, 0.10), 0.08);
    let body = blend(body, arm, 0.1);
    let face = blend(blend(head, cheek, 0.06), nose, 0.04);
    blend(blend(body, face, 0.14), ears(p), 0.07)
}

/// One ear upright, the other bent at half its length; both flat.
fn ears([x, y, z]: Vec3) -> f64 {
    let p = [x, y, 1.5 * z];
    let upright = limb([[0.13, 0.78, 0.06], [0.30, 1.60, -0.06]], [0.08, 0.17, 0.06], p);
    let lower = limb([[-0.13, 0.78, 0.06], [-0.30, 1.30, 0.06]], [0.08, 0.17, 0.14], p);
    let tip = limb([[-0.30, 1.30, 0.06], [-0.58, 1.36, 0.32]], [0.14, 0.13, 0.06], p);
    upright.min(blend(lower, tip, 0.1))
}
