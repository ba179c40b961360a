//! What the pictures are drawn of: a surface, its texture coordinates, its seams and its cones.

use super::checker::Checker;
use geom::vector::{Vec3, cross, length, sub};
use std::collections::HashMap;

/// A cone as it is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    pub(crate) vertex: u32,
    /// Whether its curvature is positive.
    pub(crate) positive: bool,
}

/// A surface scaled to unit size, with its texture coordinates scaled to the unit square, or so that its tiles fill that.
#[derive(Debug)]
pub(crate) struct Scene {
    pub(crate) points: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// For each triangle the texture coordinates of its corners.
    pub(crate) uv: Vec<[[f64; 2]; 3]>,
    /// Chains of vertices.
    pub(crate) seams: Vec<Vec<u32>>,
    pub(crate) cones: Vec<Mark>,
    /// How many tiles lie beside and above each other, and the islands' share of their area; nothing where it is not packed.
    pub(crate) tiles: Option<([usize; 2], f64)>,
}

impl Scene {
    pub(crate) fn new(
        points: &[Vec3],
        triangles: Vec<[u32; 3]>,
        uv: Vec<[[f64; 2]; 3]>,
        seams: Vec<Vec<u32>>,
        cones: Vec<Mark>,
    ) -> Self {
        let used = || triangles.iter().flatten().map(|&v| points[v as usize]);
        let (low, extent) = extent(used());
        let points = points.iter().map(|&p| sub(p, low).map(|x| x / extent)).collect();
        let uv = to_unit_square(uv);
        Self { points, triangles, uv, seams, cones, tiles: None }
    }

    /// The same scene with texture coordinates that are packed: each tile is a unit square.
    pub(crate) fn packed(self, mut uv: Vec<[[f64; 2]; 3]>, fill: f64) -> Self {
        let count = |axis: usize| {
            let last = uv.iter().flatten().map(|p| p[axis]).fold(0.0, f64::max);
            (last - 1e-9).ceil().max(1.0) as usize
        };
        let tiles = [count(0), count(1)];
        let size = tiles[0].max(tiles[1]) as f64;
        uv.as_flattened_mut().iter_mut().for_each(|p| *p = p.map(|x| x / size));
        Self { uv, tiles: Some((tiles, fill)), ..self }
    }

    /// The same scene where a map flips nothing: a triangle that lies upside down runs round against the surface, and is turned.
    pub(crate) fn upright(mut self) -> Self {
        for t in (0..self.uv.len()).filter(|&t| self.area(t) < 0.0).collect::<Vec<_>>() {
            self.uv[t].swap(1, 2);
            self.triangles[t].swap(1, 2);
        }
        self
    }

    /// The island of each triangle, largest first, and how many there are.
    pub(crate) fn islands(&self) -> (Vec<usize>, usize) {
        let mut of_side = HashMap::with_capacity(3 * self.triangles.len());
        for triangle in 0..self.triangles.len() {
            for corner in 0..3 {
                of_side.insert((self.key(triangle, corner), self.key(triangle, (corner + 1) % 3)), triangle);
            }
        }
        let mut island = vec![usize::MAX; self.triangles.len()];
        let mut areas: Vec<f64> = Vec::new();
        for seed in 0..self.triangles.len() {
            let mut waiting = vec![seed];
            while let Some(t) = waiting.pop() {
                if island[t] != usize::MAX {
                    continue;
                }
                if t == seed {
                    areas.push(0.0);
                }
                island[t] = areas.len() - 1;
                areas[island[t]] += self.area(t).abs();
                let beyond = |k: usize| of_side.get(&(self.key(t, (k + 1) % 3), self.key(t, k))).copied();
                waiting.extend((0..3).filter_map(beyond));
            }
        }
        let mut order: Vec<usize> = (0..areas.len()).collect();
        order.sort_by(|&a, &b| areas[b].total_cmp(&areas[a]));
        let mut rank = vec![0; areas.len()];
        order.iter().enumerate().for_each(|(k, &i)| rank[i] = k);
        (island.into_iter().map(|i| rank[i]).collect(), areas.len())
    }

    /// The signed area of a triangle in the layout.
    fn area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.uv[triangle];
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    }

    /// Whether a triangle is laid out upside down.
    pub(crate) fn is_flipped(&self, triangle: usize) -> bool {
        self.area(triangle) < 0.0
    }

    /// The areas of the layout's triangles, added up.
    pub(crate) fn covered(&self) -> f64 {
        (0..self.uv.len()).map(|t| self.area(t).abs()).sum()
    }

    /// The areas of the triangles in space.
    pub(crate) fn areas(&self) -> Vec<f64> {
        self.triangles.iter().map(|t| 0.5 * length(face_normal(self, t))).collect()
    }

    /// The checkerboard that it is drawn with.
    pub(crate) fn checker(&self) -> Checker {
        Checker::for_area(self.covered())
    }

    /// The outline of the layout as closed loops: where the surface ends or is cut. Pinched points are passed as they come.
    pub(crate) fn outline(&self) -> Vec<Vec<[f64; 2]>> {
        self.outlines().into_iter().map(|(_, outline)| outline).collect()
    }

    /// The same, each loop with a triangle at it.
    pub(crate) fn outlines(&self) -> Vec<(usize, Vec<[f64; 2]>)> {
        let mut open = self.open_sides();
        let mut starts: Vec<SeamSide> = open.values().flatten().copied().collect();
        starts.sort_unstable_by_key(|side| (side.triangle, side.corner));
        let mut loops = Vec::new();
        for start in starts {
            let mut outline = Vec::new();
            let mut key = self.key(start.triangle, start.corner);
            while let Some(side) = open.get_mut(&key).and_then(Vec::pop) {
                outline.push(self.uv[side.triangle][side.corner]);
                key = self.key(side.triangle, (side.corner + 1) % 3);
            }
            if !outline.is_empty() {
                loops.push((start.triangle, outline));
            }
        }
        loops
    }

    /// The sides that no other triangle continues across with the same texture coordinates, by where they begin.
    fn open_sides(&self) -> HashMap<Key, Vec<SeamSide>> {
        let sides =
            || (0..self.triangles.len()).flat_map(|triangle| (0..3).map(move |corner| SeamSide { triangle, corner }));
        let ends = |s: SeamSide| (self.key(s.triangle, s.corner), self.key(s.triangle, (s.corner + 1) % 3));
        let mut count: HashMap<(Key, Key), i32> = HashMap::with_capacity(3 * self.triangles.len());
        for side in sides() {
            *count.entry(ends(side)).or_default() += 1;
        }
        let mut open: HashMap<Key, Vec<SeamSide>> = HashMap::new();
        for side in sides() {
            let (from, to) = ends(side);
            if !count.contains_key(&(to, from)) {
                open.entry(from).or_default().push(side);
            }
        }
        open
    }

    fn key(&self, triangle: usize, corner: usize) -> Key {
        (self.triangles[triangle][corner], self.uv[triangle][corner].map(f64::to_bits))
    }
}

/// A vertex and its texture coordinates' bits: what tells the copies of a seam vertex apart.
type Key = (u32, [u64; 2]);

/// The side of a triangle that begins at a corner.
#[derive(Clone, Copy, Debug)]
struct SeamSide {
    triangle: usize,
    corner: usize,
}

/// The texture coordinates moved and scaled into the unit square, their proportions kept.
pub(crate) fn to_unit_square(mut uv: Vec<[[f64; 2]; 3]>) -> Vec<[[f64; 2]; 3]> {
    let (low, size) = extent(uv.iter().flatten().copied());
    for corner in uv.iter_mut().flatten() {
        *corner = std::array::from_fn(|i| (corner[i] - low[i]) / size);
    }
    uv
}

/// The face's normal, as long as twice its area.
pub(crate) fn face_normal(scene: &Scene, t: &[u32; 3]) -> Vec3 {
    let [a, b, c] = t.map(|v| scene.points[v as usize]);
    cross(sub(b, a), sub(c, a))
}

/// The least corner and the longest side of the points' box; 0 and 1 where there is none.
pub(crate) fn extent<const N: usize>(points: impl Iterator<Item = [f64; N]>) -> ([f64; N], f64) {
    let (mut low, mut high) = ([f64::INFINITY; N], [f64::NEG_INFINITY; N]);
    for p in points {
        low = std::array::from_fn(|i| low[i].min(p[i]));
        high = std::array::from_fn(|i| high[i].max(p[i]));
    }
    let size = (0..N).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    if size > 0.0 && size.is_finite() { (low, size) } else { (low.map(|x| if x.is_finite() { x } else { 0.0 }), 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four triangles about vertex 0; the side from 0 to 1 is cut.
    fn cut_fan() -> Scene {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
        let at = |v: u32| [points[v as usize][0], points[v as usize][1]];
        let mut uv: Vec<[[f64; 2]; 3]> = triangles.iter().map(|t| t.map(at)).collect();
        uv[3][2] = [1.0, -0.1];
        Scene::new(&points, triangles, uv, vec![], vec![])
    }

    #[test]
    fn the_outline_of_a_cut_fan_runs_along_both_sides_of_the_seam() {
        let scene = cut_fan();
        let outline = scene.outline();
        assert_eq!(outline.len(), 1);
        assert_eq!(outline[0].len(), 6, "4 rim sides and twice the seam");
        assert!(!(0..4).any(|t| scene.is_flipped(t)));
    }

    #[test]
    fn a_triangle_that_runs_against_the_surface_is_drawn_as_its_neighbours_are() {
        let mut turned = cut_fan();
        turned.triangles[2].swap(1, 2);
        turned.uv[2].swap(1, 2);
        assert!(turned.is_flipped(2) && turned.islands() != cut_fan().islands());
        let upright = turned.upright();
        assert!(!(0..4).any(|t| upright.is_flipped(t)) && upright.islands() == cut_fan().islands());
    }
}
