//! How the surface answers to light: a soft key light from the upper left, sky and ground, a faint shine.
//!
//! Everything happens in the camera's frame (right, up, towards the eye), so that a shape is lit alike from every side.

use super::colour::Colour;
use super::space::{Vector, dot, plus, unit};

const KEY: Vector = [-0.48, 0.62, 0.62];
const KEY_STRENGTH: f64 = 0.72;
const SKY: f64 = 0.46;
const GROUND: f64 = 0.2;
const SHINE: f64 = 0.10;

/// The light that a surface of a colour sends to the eye. `normal` and `sight` are unit vectors, `normal` on the eye's side.
pub(crate) fn lit(colour: Colour, normal: Vector, sight: Vector) -> Colour {
    let key = unit(KEY);
    // Wrapped round the terminator, so that the dark side keeps its shape.
    let direct = ((dot(normal, key) + 0.25) / 1.25).max(0.0);
    let ambient = GROUND + (SKY - GROUND) * 0.5 * (1.0 + normal[1]);
    // A rim a little darker than the face, so that outlines stand off white paper.
    let rim = 0.72 + 0.28 * dot(normal, sight).clamp(0.0, 1.0).sqrt();
    let half = unit(plus(key, 1.0, sight));
    let shine = SHINE * dot(normal, half).max(0.0).powi(40);
    colour.map(|c| c * (KEY_STRENGTH * direct + ambient) * rim + shine)
}
