//! How a surface answers to light: a soft key light from the upper left, sky and ground, a faint shine.
//!
//! Everything happens in the camera's frame (right, up, towards the eye), so that a shape is lit alike from every side.

use super::colour::Colour;
use geom::vector::{Vec3, dot, step, unit};

const KEY: Vec3 = [-0.50, 0.64, 0.58];
const KEY_STRENGTH: f64 = 0.74;
const SKY: f64 = 0.33;
const GROUND: f64 = 0.13;
const SHINE: f64 = 0.09;

/// What light does to a colour: scale it, and add white.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    diffuse: f64,
    shine: f64,
}

impl Light {
    /// The light that comes from a surface to the eye. `normal` and `sight` are unit vectors, `normal` on the eye's side.
    pub(crate) fn on(normal: Vec3, sight: Vec3) -> Self {
        let key = unit(KEY);
        // Wrapped round the terminator, so that the dark side keeps its shape.
        let direct = ((dot(normal, key) + 0.25) / 1.25).max(0.0);
        let ambient = GROUND + (SKY - GROUND) * 0.5 * (1.0 + normal[1]);
        // A rim a little darker than the face, so that outlines stand off white paper.
        let rim = 0.68 + 0.32 * dot(normal, sight).clamp(0.0, 1.0).sqrt();
        let half = unit(step(key, 1.0, sight));
        Self { diffuse: (KEY_STRENGTH * direct + ambient) * rim, shine: SHINE * dot(normal, half).max(0.0).powi(40) }
    }

    /// Between the light at a triangle's corners.
    pub(crate) fn blend(corners: &[Self; 3], w: [f64; 3]) -> Self {
        let sum = |part: fn(&Self) -> f64| (0..3).map(|i| w[i] * part(&corners[i])).sum();
        Self { diffuse: sum(|l| l.diffuse), shine: sum(|l| l.shine) }
    }

    /// The colour seen.
    pub(crate) fn apply(self, colour: Colour) -> Colour {
        colour.map(|c| c * self.diffuse + self.shine)
    }
}
