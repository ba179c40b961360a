//! Surfaces put together from patches of regular triangles, which are joined where their points are the same, bit by
//! bit.

use std::collections::HashMap;

use super::Shape;
use crate::vector::Vec3;

/// Triangles given by points; equal points are one vertex.
#[derive(Default)]
pub(super) struct Patches {
    shape: Shape,
    vertex_at: HashMap<[u64; 3], u32>,
}

impl Patches {
    /// What the patches form together.
    pub(super) fn join(self) -> Shape {
        self.shape
    }

    /// Adds a triangle, counter-clockwise.
    pub(super) fn triangle(&mut self, corners: [Vec3; 3]) {
        let triangle = corners.map(|p| self.vertex(p));
        self.shape.triangles.push(triangle);
    }

    fn vertex(&mut self, point: Vec3) -> u32 {
        let point = point.map(|x| x + 0.0); // -0 and 0 are the same place
        *self.vertex_at.entry(point.map(f64::to_bits)).or_insert_with(|| {
            self.shape.points.push(point);
            self.shape.points.len() as u32 - 1
        })
    }

    /// Adds triangles in another place, turned over if `reversed`.
    pub(super) fn shape(&mut self, shape: &Shape, reversed: bool, place: impl Fn(Vec3) -> Vec3) {
        for &triangle in &shape.triangles {
            let [a, b, c] = shape.corners(triangle).map(&place);
            self.triangle(if reversed { [c, b, a] } else { [a, b, c] });
        }
    }

    /// Adds rings about a point: ring k, for k up to `rings`, has `sectors` · k points and `point(k, j)` is the j-th of
    /// them, counter-clockwise.
    pub(super) fn rings(&mut self, sectors: usize, rings: usize, point: impl Fn(usize, usize) -> Vec3) {
        for k in 1..=rings {
            let outer = |j: usize| point(k, j % (sectors * k));
            let inner = |j: usize| point(k - 1, j % (sectors * (k - 1)).max(1));
            for sector in 0..sectors {
                let (out, within) = (sector * k, sector * (k - 1));
                for j in 0..k {
                    self.triangle([inner(within + j), outer(out + j), outer(out + j + 1)]);
                }
                for j in 1..k {
                    self.triangle([inner(within + j - 1), outer(out + j), inner(within + j)]);
                }
            }
        }
    }

    /// Adds a grid of quads, `point(i, j)` for i up to `columns` and j up to `rows`, each cut by a diagonal; the
    /// diagonals alternate. Counter-clockwise if i runs to the right and j upwards.
    pub(super) fn grid(&mut self, columns: usize, rows: usize, point: impl Fn(usize, usize) -> Vec3) {
        for j in 0..rows {
            for i in 0..columns {
                let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                halves.into_iter().for_each(|half| self.triangle(half));
            }
        }
    }

    /// Adds a band of `rows` rows round an axis, odd ones shifted by half a step so that triangles can be equilateral:
    /// `point(t, j)` is the point at the fraction t of the way round in row j.
    pub(super) fn band(&mut self, around: usize, rows: usize, point: impl Fn(f64, usize) -> Vec3) {
        let place = |i: usize, j: usize| point(((i % around) as f64 + 0.5 * (j % 2) as f64) / around as f64, j);
        for j in 0..rows {
            for i in 0..around {
                let [a, b, c, d] = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
                let halves = if j % 2 == 0 { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] };
                halves.into_iter().for_each(|half| self.triangle(half));
            }
        }
    }
}
