//! Where the eye stands: three quarters from above, near enough to fill the picture.

use super::canvas::ScreenPoint;
use geom::vector::{Vec3, cross, dot, step, sub, unit};

/// The vertical field of view's half, as its tangent: a long lens, so that shapes are not distorted.
const HALF_HEIGHT: f64 = 0.19;
/// The share of the picture left free on each side.
const MARGIN: f64 = 0.04;

/// A perspective camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    /// From the scene to the eye.
    towards: Vec3,
    /// Pixels of a unit length at distance one.
    focal: f64,
    middle: [f64; 2],
}

impl Camera {
    /// A camera that sees all the points, from the direction `towards`, with `up` upwards.
    pub(crate) fn framing(points: &[Vec3], towards: Vec3, up: Vec3, width: usize, height: usize) -> Self {
        let towards = unit(towards);
        let right = unit(cross(up, towards));
        let up = cross(towards, right);
        let half = [HALF_HEIGHT * width as f64 / height as f64, HALF_HEIGHT].map(|h| h * (1.0 - 2.0 * MARGIN));
        let seen: Vec<Vec3> = points.iter().map(|&p| [dot(p, right), dot(p, up), dot(p, towards)]).collect();
        let centred = |axis: usize, half: f64| frame(&seen, axis, half);
        let (x, dx) = centred(0, half[0]);
        let (y, dy) = centred(1, half[1]);
        let from = dx.max(dy);
        let eye = step(step(right.map(|a| a * x), y, up), from, towards);
        Self {
            eye,
            right,
            up,
            towards,
            focal: height as f64 / (2.0 * HALF_HEIGHT),
            middle: [0.5 * width as f64, 0.5 * height as f64],
        }
    }

    /// Where a point is seen.
    pub(crate) fn place(&self, p: Vec3) -> ScreenPoint {
        let [x, y, z] = self.turn(sub(p, self.eye));
        let nearness = -1.0 / z;
        let scale = self.focal * nearness;
        [self.middle[0] + scale * x, self.middle[1] - scale * y, nearness]
    }

    /// Pixels of a unit length at a place.
    pub(crate) fn scale(&self, place: ScreenPoint) -> f64 {
        self.focal * place[2]
    }

    /// The size of a pixel in space at distance one.
    pub(crate) fn pixel(&self) -> f64 {
        1.0 / self.focal
    }

    /// A direction in the camera's frame: right, up, towards the eye.
    pub(crate) fn turn(&self, d: Vec3) -> Vec3 {
        [dot(d, self.right), dot(d, self.up), dot(d, self.towards)]
    }

    /// The direction in which a point looks at the eye, in the camera's frame.
    pub(crate) fn sight(&self, p: Vec3) -> Vec3 {
        unit(self.turn(sub(self.eye, p)))
    }
}

/// The coordinate and the least distance from which all points are within the half field of view along one axis: the
/// extreme rays touch the scene on both sides.
fn frame(seen: &[Vec3], axis: usize, half: f64) -> (f64, f64) {
    // From x at distance d a point is inside when |p - x| ≤ half·(d - z): the two sides give x - half·d ≤ min(p - half·z)
    // … so the greatest of p + half·z and the least of p - half·z decide.
    let high = seen.iter().map(|p| p[axis] + half * p[2]).fold(f64::NEG_INFINITY, f64::max);
    let low = seen.iter().map(|p| p[axis] - half * p[2]).fold(f64::INFINITY, f64::min);
    let nearest = seen.iter().map(|p| p[2]).fold(f64::NEG_INFINITY, f64::max);
    let distance = (high - low) / (2.0 * half);
    (0.5 * (high + low), distance.max(nearest + 1e-3 * (high - low).abs().max(f64::MIN_POSITIVE)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_lands_within_the_margins_and_some_point_on_them() {
        let points: Vec<Vec3> = (0..200)
            .map(|i| {
                let t = f64::from(i);
                [7.0 + (1.3 * t).sin() * 5.0, (0.7 * t).cos() * 0.5, -3.0 + (2.1 * t).sin() * 2.0]
            })
            .collect();
        let camera = Camera::framing(&points, [0.4, 0.5, 1.0], [0.0, 1.0, 0.0], 400, 300);
        let places: Vec<ScreenPoint> = points.iter().map(|&p| camera.place(p)).collect();
        let (x, y) = (400.0 * MARGIN - 1e-6, 300.0 * MARGIN - 1e-6);
        assert!(places.iter().all(|p| p[0] >= x && p[0] <= 400.0 - x && p[1] >= y && p[1] <= 300.0 - y));
        assert!(places.iter().any(|p| p[0] < x + 1.0 || p[1] < y + 1.0));
    }
}
