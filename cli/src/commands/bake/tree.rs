//! The triangles of a surface by their places: which is the nearest to a point.
//!
//! A balanced tree of boxes: each node has half of its parent's triangles, parted at the median of their middles along the axis on which these are
//! farthest apart. Nodes are numbered from 1, and the children of k are 2 k and 2 k + 1, so that none has to be stored but its box. The nearest point of a
//! triangle is found by the region that the point is in (Ericson 2004, *Real-Time Collision Detection*, §5.1.5).

use geom::vector::{Vec3, cross, dot, length, scale, sub};
use std::ops::Range;

/// So many triangles have a box of their own, at most: fewer make the tree larger than what it spares.
const TOGETHER: usize = 4;

/// Triangles by their places; those without area are left out.
#[derive(Debug)]
pub(super) struct Tree<'a> {
    triangles: &'a [[Vec3; 3]],
    order: Vec<u32>,
    boxes: Vec<[Vec3; 2]>,
    /// The first node without children.
    leaves: usize,
}

/// What is nearest to a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) triangle: usize,
    pub(super) distance: f64,
}

impl<'a> Tree<'a> {
    pub(super) fn new(triangles: &'a [[Vec3; 3]]) -> Self {
        let has_area = |&t: &u32| {
            let [a, b, c] = triangles[t as usize];
            length(cross(sub(b, a), sub(c, a))) > 0.0
        };
        let order: Vec<u32> = (0..triangles.len() as u32).filter(has_area).collect();
        let mut leaves = 1;
        while order.len().div_ceil(leaves) > TOGETHER {
            leaves *= 2;
        }
        let boxes = vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; 2 * leaves];
        let mut tree = Self { triangles, order, boxes, leaves };
        tree.part(1, 0..tree.order.len());
        tree
    }

    /// Orders the triangles of a node, and bounds them.
    fn part(&mut self, node: usize, range: Range<usize>) {
        let triangles = self.triangles;
        let corners = self.order[range.clone()].iter().flat_map(|&t| triangles[t as usize]);
        self.boxes[node] = bounds(corners);
        if node >= self.leaves {
            return;
        }
        let middle = |t: u32| {
            let [a, b, c] = triangles[t as usize];
            [0, 1, 2].map(|k| a[k] + b[k] + c[k])
        };
        let [low, high] = bounds(self.order[range.clone()].iter().map(|&t| middle(t)));
        let extent = sub(high, low);
        let axis = (0..3).fold(0, |most, k| if extent[k] > extent[most] { k } else { most });
        let half = range.len() / 2;
        let by_place = |a: &u32, b: &u32| middle(*a)[axis].total_cmp(&middle(*b)[axis]).then(a.cmp(b));
        if half > 0 {
            self.order[range.clone()].select_nth_unstable_by(half, by_place);
        }
        let [first, second] = halves(range);
        self.part(2 * node, first);
        self.part(2 * node + 1, second);
    }

    /// The nearest of the triangles that are accepted, of several the first, if any is within a distance.
    pub(super) fn nearest(&self, p: Vec3, within: f64, accepts: impl Fn(usize) -> bool) -> Option<Near> {
        let mut best: Option<Near> = None;
        let mut stack = vec![(self.away(1, p), 1, 0..self.order.len())];
        while let Some((away, node, range)) = stack.pop() {
            if away > best.map_or(within, |best| best.distance) {
                continue;
            }
            if node < self.leaves {
                let [first, second] = halves(range);
                let first = (self.away(2 * node, p), 2 * node, first);
                let second = (self.away(2 * node + 1, p), 2 * node + 1, second);
                // The nearer one is looked at first.
                stack.extend(if first.0 <= second.0 { [second, first] } else { [first, second] });
                continue;
            }
            for &t in &self.order[range] {
                let triangle = t as usize;
                if !accepts(triangle) {
                    continue;
                }
                let (_, distance) = self.on(triangle, p);
                let limit = best.map_or(within, |best| best.distance);
                let is_first = best.is_none_or(|best| triangle < best.triangle);
                if distance < limit || distance == limit && is_first {
                    best = Some(Near { triangle, distance });
                }
            }
        }
        best
    }

    /// The point of a triangle that is nearest to one, by weights of its corners, and how far it is.
    pub(super) fn on(&self, triangle: usize, p: Vec3) -> ([f64; 3], f64) {
        let corners = self.triangles[triangle];
        let weights = nearest_weights(p, corners);
        let at = [0, 1, 2].map(|k| (0..3).map(|i| weights[i] * corners[i][k]).sum());
        (weights, length(sub(p, at)))
    }

    /// How far a point is from a node's box.
    fn away(&self, node: usize, p: Vec3) -> f64 {
        let [low, high] = self.boxes[node];
        length([0, 1, 2].map(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0)))
    }
}

/// The halves of a node's triangles.
fn halves(range: Range<usize>) -> [Range<usize>; 2] {
    let half = range.start + range.len() / 2;
    [range.start..half, half..range.end]
}

/// The box about points.
pub(super) fn bounds(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    points.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], p| {
        [[0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k]))]
    })
}

/// The weights of the corners of a triangle at its point that is nearest to `p`.
fn nearest_weights(p: Vec3, [a, b, c]: [Vec3; 3]) -> [f64; 3] {
    let [ab, ac] = [sub(b, a), sub(c, a)];
    let along = |from: Vec3| [dot(ab, sub(p, from)), dot(ac, sub(p, from))];
    let ([a1, a2], [b1, b2], [c1, c2]) = (along(a), along(b), along(c));
    if a1 <= 0.0 && a2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if b1 >= 0.0 && b2 <= b1 {
        return [0.0, 1.0, 0.0];
    }
    if c2 >= 0.0 && c1 <= c2 {
        return [0.0, 0.0, 1.0];
    }
    let beyond_ab = a1 * b2 - b1 * a2;
    if beyond_ab <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
        let t = a1 / (a1 - b1);
        return [1.0 - t, t, 0.0];
    }
    let beyond_ac = c1 * a2 - a1 * c2;
    if beyond_ac <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
        let t = a2 / (a2 - c2);
        return [1.0 - t, 0.0, t];
    }
    let beyond_bc = b1 * c2 - c1 * b2;
    if beyond_bc <= 0.0 && b2 - b1 >= 0.0 && c1 - c2 >= 0.0 {
        let t = (b2 - b1) / ((b2 - b1) + (c1 - c2));
        return [0.0, 1.0 - t, t];
    }
    scale([beyond_bc, beyond_ac, beyond_ab], 1.0 / (beyond_ab + beyond_ac + beyond_bc))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_triangle_is_that_of_a_search_through_all() {
        let shape = geom::shapes::torus(1, 300);
        let triangles: Vec<[Vec3; 3]> = shape.triangles.iter().map(|t| t.map(|v| shape.points[v as usize])).collect();
        let tree = Tree::new(&triangles);
        for k in 0..400_u32 {
            let p = [1, 2, 3].map(|prime| (f64::from(k * 7919 * prime + prime) * 0.618).fract() * 4.0 - 2.0);
            let accepts = |t: usize| !t.is_multiple_of(3);
            let all = (0..triangles.len()).filter(|&t| accepts(t)).map(|t| tree.on(t, p).1);
            let least = all.fold(f64::INFINITY, f64::min);
            assert_eq!(tree.nearest(p, f64::INFINITY, accepts).unwrap().distance, least);
            assert!(tree.nearest(p, 0.9 * least, accepts).is_none());
        }
        assert!(Tree::new(&[]).nearest([0.0; 3], 1.0, |_| true).is_none());
    }

    #[test]
    fn no_point_of_a_triangle_is_nearer_than_the_nearest() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.5, 1.0, 0.0]];
        let at = |w: [f64; 3]| [0, 1, 2].map(|k| (0..3).map(|i| w[i] * corners[i][k]).sum::<f64>());
        for k in 0..125 {
            let p = [k % 5, k / 5 % 5, k / 25].map(|x| f64::from(x) - 2.0);
            let weights = nearest_weights(p, corners);
            assert!(weights.iter().all(|w| *w >= 0.0) && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let least = length(sub(p, at(weights)));
            for (i, j) in (0..=20).flat_map(|i| (0..=20 - i).map(move |j| (i, j))) {
                let other = at([i, j, 20 - i - j].map(|w| f64::from(w) / 20.0));
                assert!(least <= length(sub(p, other)) + 1e-12, "{p:?}");
            }
        }
    }
}
