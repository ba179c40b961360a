//! A surface with other triangles, as parts that lie on the triangles of the old one each.
//!
//! A new triangle whose corners are all on the old one that is nearest to its middle has its image. One that is on several, as of a coarser surface, is halved
//! until its parts are on one each, or no larger than a texel. Where two sheets are near, the one counts that is turned the same way.

use super::faces::{Image, NEAR, size};
use super::tree::Tree;
use cones::uv::Triangle;
use geom::Model;
use geom::vector::{Vec3, dot, normal};
use rayon::prelude::*;

/// The old surface, and how near is near.
struct Old<'a> {
    tree: Tree<'a>,
    triangles: &'a [[Vec3; 3]],
    /// What lies on it is so near.
    near: f64,
    /// What is meant by it is so near.
    reach: f64,
    /// The side of a texel.
    texel: f64,
}

/// A part of a new triangle.
#[derive(Clone, Copy)]
struct Part {
    points: [Vec3; 3],
    uv: Triangle,
}

/// A part on an old triangle: which, and the weights of its corners at each of the part's.
struct Lying {
    triangle: usize,
    weights: [[f64; 3]; 3],
    uv: Triangle,
}

/// The images of the parts of a new surface, for a texture of `side` texels; else the face that is farthest from the old one, and how far, as a share of that one's
/// size, if that is more than `share`.
pub(super) fn images(
    old: &Model,
    (new, uv): (&Model, &[[f64; 2]]),
    side: usize,
    share: f64,
) -> Result<Vec<Image>, (u32, f64)> {
    let [old_triangles, new_triangles] = [old, new].map(Model::triangles);
    let place = |model: &Model, v: u32| model.points()[v as usize];
    let triangles: Vec<[Vec3; 3]> = old_triangles.vertices(old).iter().map(|t| t.map(|v| place(old, v))).collect();
    let near = NEAR * size(old);
    let reach = near.max(share * size(old));
    let surface = Old { tree: Tree::new(&triangles), triangles: &triangles, near, reach, texel: 1.0 / side as f64 };
    let part = |corners: &[u32; 3]| {
        let points = corners.map(|corner| place(new, new.corners()[corner as usize]));
        surface.parts(Part { points, uv: corners.map(|corner| uv[corner as usize]) })
    };
    let parts: Vec<Result<Vec<Lying>, f64>> = new_triangles.corners.par_iter().map(part).collect();
    let misfits =
        parts.iter().zip(&new_triangles.face_of).filter_map(|(part, &face)| Some((face, part.as_ref().err()?)));
    if let Some((face, distance)) = misfits.reduce(|most, next| if next.1 > most.1 { next } else { most }) {
        return Err((face, distance / size(old)));
    }
    let image = |Lying { triangle, weights, uv }: Lying| {
        let corners = old_triangles.corners[triangle].map(|corner| old.uv()?.corner(corner as usize));
        let mixed = |[a, b, c]: Triangle| weights.map(|w| [0, 1].map(|k| w[0] * a[k] + w[1] * b[k] + w[2] * c[k]));
        let whole = if let [Some(a), Some(b), Some(c)] = corners { Some([a, b, c]) } else { None };
        Image { face: old_triangles.face_of[triangle], old: whole.map(mixed), new: uv }
    };
    Ok(parts.into_iter().flatten().flatten().map(image).collect())
}

impl Old<'_> {
    /// The parts of a triangle; else how far it is away.
    fn parts(&self, whole: Part) -> Result<Vec<Lying>, f64> {
        let upwards = normal(whole.points);
        let (mut lying, mut stack) = (Vec::new(), vec![(whole, None)]);
        while let Some((part, known)) = stack.pop() {
            let triangle = self.below(middle(part.points), upwards, known)?;
            match part.halves(self.texel) {
                Some(halves) if !self.is_on(triangle, &part)? => {
                    stack.extend(halves.map(|half| (half, Some(triangle))));
                }
                _ => {
                    let weights = part.points.map(|point| self.tree.on(triangle, point).0);
                    lying.push(Lying { triangle, weights, uv: part.uv });
                }
            }
        }
        Ok(lying)
    }

    /// Whether nothing is nearer to the corners of a part than a triangle; else, if that is too far, how far it is.
    fn is_on(&self, triangle: usize, part: &Part) -> Result<bool, f64> {
        for &point in &part.points {
            let (_, distance) = self.tree.on(triangle, point);
            if distance > self.near && self.tree.nearest(point, distance - self.near, |_| true).is_some() {
                return Ok(false);
            }
            if distance > self.reach {
                return Err(distance);
            }
        }
        Ok(true)
    }

    /// The old triangle that a point of a new one with that normal belongs to; one is `known` to be near.
    fn below(&self, point: Vec3, upwards: Vec3, known: Option<usize>) -> Result<usize, f64> {
        let is_turned_so = |t: usize| dot(normal(self.triangles[t]), upwards) > 0.0;
        let within = known.map_or(f64::INFINITY, |known| self.tree.on(known, point).1);
        let nearest = self.tree.nearest(point, within, |_| true).ok_or(f64::INFINITY)?;
        if nearest.distance > self.reach {
            return Err(nearest.distance);
        }
        if is_turned_so(nearest.triangle) {
            return Ok(nearest.triangle);
        }
        let within = if nearest.distance <= self.near { 2.0 * self.near } else { self.reach };
        Ok(self.tree.nearest(point, within, is_turned_so).unwrap_or(nearest).triangle)
    }
}

impl Part {
    /// Its halves, parted at its longest side in the map; none if that is no longer than a texel.
    fn halves(&self, texel: f64) -> Option<[Self; 2]> {
        let side = |k: usize| {
            let [a, b] = [self.uv[k], self.uv[(k + 1) % 3]];
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        let k = (0..3).fold(0, |most, k| if side(k) > side(most) { k } else { most });
        if side(k) <= texel {
            return None;
        }
        let next = (k + 1) % 3;
        let (mut first, mut second) = (*self, *self);
        let point = [0, 1, 2].map(|i| 0.5 * (self.points[k][i] + self.points[next][i]));
        let uv = [0, 1].map(|i| 0.5 * (self.uv[k][i] + self.uv[next][i]));
        (first.points[next], first.uv[next]) = (point, uv);
        (second.points[k], second.uv[k]) = (point, uv);
        Some([first, second])
    }
}

fn middle([a, b, c]: [Vec3; 3]) -> Vec3 {
    [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of so many rows of squares, with a map by which the texture is turned, raised by some height.
    fn grid(rows: u32, height: f64) -> Model {
        let at = |k: u32| f64::from(k) / f64::from(rows);
        let points = (0..(rows + 1).pow(2)).map(|k| [at(k % (rows + 1)), at(k / (rows + 1)), height]);
        let first = |k: u32| k / rows * (rows + 1) + k % rows;
        let squares = (0..rows * rows).map(first).flat_map(|k| {
            let [a, b, c, d] = [k, k + 1, k + rows + 2, k + rows + 1];
            [[a, b, c], [a, c, d]]
        });
        let squares: Vec<[u32; 3]> = squares.collect();
        let model = Model::from_triangles(points.collect(), &squares).unwrap();
        let uv = model.corners().iter().map(|&v| model.points()[v as usize]).map(|[x, y, _]| [y, 1.0 - x]).collect();
        model.with_texture(uv).unwrap()
    }

    #[test]
    fn parts_of_finer_and_of_coarser_triangles_show_what_is_at_their_places() {
        for (from, to) in [(3, 9), (9, 3), (7, 5)] {
            let (old, new) = (grid(from, 0.0), grid(to, 1e-4));
            // The new map is how the square lies.
            let uv: Vec<[f64; 2]> =
                new.corners().iter().map(|&v| new.points()[v as usize]).map(|[x, y, _]| [x, y]).collect();
            let images = images(&old, (&new, &uv), 64, 1e-3).unwrap();
            let area = |[a, b, c]: Triangle| 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
            let all: f64 = images.iter().map(|image| area(image.new)).sum();
            assert!((all - 1.0).abs() < 1e-12, "{all}");
            for Image { old, new, .. } in images {
                for (old, new) in old.unwrap().into_iter().zip(new) {
                    let off = (old[0] - new[1]).abs().max((old[1] - 1.0 + new[0]).abs());
                    assert!(off <= 1.0 / 64.0, "{old:?} {new:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_far_is_said_and_the_side_that_is_turned_the_same_way_counts() {
        let (old, high) = (grid(3, 0.0), grid(3, 0.1));
        let uv = vec![[0.0; 2]; high.corner_count()];
        let (face, share) = images(&old, (&high, &uv), 64, 1e-3).unwrap_err();
        assert!(face < 18 && (share - 0.1 / 2_f64.sqrt()).abs() < 1e-9, "{face} {share}");
        // Two sheets at one place, the first turned down.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].to_vec();
        let sheets = Model::from_triangles(points.clone(), &[[0, 2, 1], [0, 1, 2]]).unwrap();
        for (turned, face) in [([0, 1, 2], 1), ([0, 2, 1], 0)] {
            let new = Model::from_triangles(points.clone(), &[turned]).unwrap();
            let images = images(&sheets, (&new, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), 8, 1e-3).unwrap();
            assert_eq!(images.iter().map(|image| image.face).collect::<Vec<_>>(), [face]);
        }
    }
}
