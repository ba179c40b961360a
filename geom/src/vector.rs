//! Points and vectors of space as plain arrays.

/// A point or a vector.
pub type Vec3 = [f64; 3];

/// a + b
pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a - b
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// s a
pub fn scale(a: Vec3, s: f64) -> Vec3 {
    a.map(|x| x * s)
}

/// a + s b
pub fn step(a: Vec3, s: f64, b: Vec3) -> Vec3 {
    add(a, scale(b, s))
}

/// The inner product.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product.
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length of a vector.
pub fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// The length of a vector of the plane. `f64::hypot` takes several times as long, and is needed only where squares leave the range of numbers.
pub fn norm([x, y]: [f64; 2]) -> f64 {
    let squared = x * x + y * y;
    if squared.is_normal() { squared.sqrt() } else { x.hypot(y) }
}

/// The distance of two points.
pub fn distance(a: Vec3, b: Vec3) -> f64 {
    length(sub(a, b))
}

/// The vector of length 1 in the same direction; zero stays zero.
pub fn unit(a: Vec3) -> Vec3 {
    let length = length(a);
    if length > 0.0 { a.map(|x| x / length) } else { [0.0; 3] }
}

/// The angle between two vectors, from 0 to π; exact to rounding also where it is small.
pub fn angle(a: Vec3, b: Vec3) -> f64 {
    length(cross(a, b)).atan2(dot(a, b))
}

/// The normal of a triangle, as long as twice its area.
pub fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    cross(sub(b, a), sub(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn axes_are_a_right_handed_orthonormal_basis() {
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!([cross(x, y), cross(y, z), cross(z, x)], [z, x, y]);
        assert_eq!(normal([z, add(z, x), add(z, y)]), z);
        assert_eq!([angle(x, y), angle(x, scale(x, -2.0))], [PI / 2.0, PI]);
        assert_eq!((unit(step(x, 3.0, x)), unit([0.0; 3])), (x, [0.0; 3]));
        assert_eq!(distance(sub(x, y), y), 5.0_f64.sqrt());
    }
}
