//! Small surfaces of every topology, to begin with.

use std::collections::BTreeMap;

use geom::shapes::Shape;
use geom::{Model, ModelError};

/// The points mapped, the triangles as they are.
pub fn mapped(shape: &Shape, f: impl Fn([f64; 3]) -> [f64; 3]) -> Shape {
    Shape { points: shape.points.iter().copied().map(f).collect(), triangles: shape.triangles.clone() }
}

/// Each triangle split into four at the middles of its edges.
pub fn refined(shape: &Shape) -> Shape {
    let mut points = shape.points.clone();
    let mut middles = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            let (p, q) = (points[a as usize], points[b as usize]);
            points.push([0, 1, 2].map(|k| 0.5 * (p[k] + q[k])));
            points.len() as u32 - 1
        })
    };
    let quarter = |&[a, b, c]: &[u32; 3]| {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    };
    let triangles = shape.triangles.iter().flat_map(quarter).collect();
    Shape { points, triangles }
}

/// Several shapes as one, each nine further along the first axis than the one before it.
pub fn side_by_side(shapes: &[Shape]) -> Shape {
    let mut all = Shape { points: Vec::new(), triangles: Vec::new() };
    for (k, shape) in shapes.iter().enumerate() {
        let first = all.points.len() as u32;
        all.points.extend(shape.points.iter().map(|p| [p[0] + 9.0 * k as f64, p[1], p[2]]));
        all.triangles.extend(shape.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

/// A closed surface with a tube, closed by a tip, in place of each of its vertices whose neighbours are no neighbours of another one: of so many rings,
/// as far apart as the surface's edges are long.
pub fn spiky(shape: &Shape, rings: u32) -> Shape {
    let mut next: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); shape.points.len()];
    for &[a, b, c] in &shape.triangles {
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().for_each(|[v, from, to]| _ = next[v as usize].insert(from, to));
    }
    let mut is_taken = vec![false; shape.points.len()];
    let (mut points, mut triangles) = (shape.points.clone(), shape.triangles.clone());
    for v in 0..shape.points.len() as u32 {
        let star = &next[v as usize];
        if star.keys().chain([&v]).any(|&w| is_taken[w as usize]) {
            continue;
        }
        star.keys().chain([&v]).for_each(|&w| is_taken[w as usize] = true);
        triangles.retain(|t| !t.contains(&v));
        let around: Vec<u32> =
            std::iter::successors(star.keys().next(), |w| star.get(w)).take(star.len()).copied().collect();
        let tip = shape.points[v as usize];
        let length = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
        let from_tip = |w: &u32| [0, 1, 2].map(|k| shape.points[*w as usize][k] - tip[k]);
        let edge = around.iter().map(|w| length(from_tip(w))).sum::<f64>() / around.len() as f64;
        let out = tip.map(|x| edge * x / length(tip));
        let mut below = around.clone();
        for ring in 1..=rings {
            let above: Vec<u32> = (points.len() as u32..).take(around.len()).collect();
            points.extend(
                around.iter().map(|&w| [0, 1, 2].map(|k| shape.points[w as usize][k] + f64::from(ring) * out[k])),
            );
            for (k, j) in (0..around.len()).map(|k| (k, (k + 1) % around.len())) {
                triangles.extend([[below[k], below[j], above[j]], [below[k], above[j], above[k]]]);
            }
            below = above;
        }
        points[v as usize] = [0, 1, 2].map(|k| tip[k] + f64::from(rings + 1) * out[k]);
        triangles.extend((0..below.len()).map(|k| [v, below[k], below[(k + 1) % below.len()]]));
    }
    Shape { points, triangles }
}

/// The model that a file of this content gives.
///
/// # Errors
/// If a model must not be so.
pub fn model(shape: &Shape) -> Result<Model, ModelError> {
    Model::from_triangles(shape.points.clone(), &shape.triangles)
}

/// A tetrahedron that is not regular.
pub fn tetrahedron() -> Shape {
    Shape {
        points: vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 1.2, 0.0], [0.3, 0.3, 0.9]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    }
}

/// The regular octahedron.
pub fn octahedron() -> Shape {
    let points =
        vec![[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]];
    Shape { points, triangles }
}

/// A torus of revolution, of `around` by `across` quads (at least three each).
pub fn torus(around: u32, across: u32) -> Shape {
    let point = |i: u32, j: u32| {
        let (a, b) = (turn(i, around), turn(j, across));
        let r = 1.0 + 0.4 * b.cos();
        [r * a.cos(), r * a.sin(), 0.4 * b.sin()]
    };
    grid([around, across], [true, true], point)
}

/// An open tube of `around` by `along` quads, a little wider at one end: flat, with two boundary loops.
pub fn tube(around: u32, along: u32) -> Shape {
    let point = |i: u32, j: u32| {
        let (a, z) = (turn(i, around), f64::from(j) / f64::from(along));
        let r = 1.0 + 0.3 * z;
        [r * a.cos(), r * a.sin(), z]
    };
    grid([around, along], [true, false], point)
}

/// A curved sheet of `width` by `height` quads.
pub fn patch(width: u32, height: u32) -> Shape {
    let point = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) / f64::from(width) - 0.5, f64::from(j) / f64::from(height) - 0.5);
        [x, y, 0.5 * x * x + 0.7 * x * y - 0.3 * y * y]
    };
    grid([width, height], [false, false], point)
}

/// The surface of a slab of cubes with `genus` square holes through it and `windows` (up to four) of its sides taken out.
pub fn slab(genus: usize, windows: usize) -> Shape {
    let size = [2 * genus as i32 + 1, 3, 1];
    let is_solid = |p: [i32; 3]| (0..3).all(|k| (0..size[k]).contains(&p[k])) && !(p[0] % 2 == 1 && p[1] == 1);
    let open: Vec<[i32; 3]> = [[0, 0, 0], [0, 2, 0], [0, 0, 1], [0, 2, 1]].into_iter().take(windows).collect();
    let mut vertices = BTreeMap::new();
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for (p, axis) in cells(size.map(|k| k + 1)).flat_map(|p| (0..3).map(move |axis| (p, axis))) {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let shifted = |at: [i32; 3], axis: usize, by: i32| -> [i32; 3] {
            std::array::from_fn(|k| if k == axis { at[k] + by } else { at[k] })
        };
        let (above, below) = (is_solid(p), is_solid(shifted(p, axis, -1)));
        if above == below || axis == 2 && open.contains(&p) {
            continue;
        }
        let quad = [p, shifted(p, i, 1), shifted(shifted(p, i, 1), j, 1), shifted(p, j, 1)].map(|corner| {
            *vertices.entry(corner).or_insert_with(|| {
                points.push(corner.map(f64::from));
                points.len() as u32 - 1
            })
        });
        let [a, b, c, d] = if above { [quad[0], quad[3], quad[2], quad[1]] } else { quad };
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    Shape { points, triangles }
}

/// A sphere with bumps of no symmetry, from a subdivided octahedron.
pub fn bumpy_sphere(subdivisions: usize) -> Shape {
    let smooth = (0..subdivisions).fold(octahedron(), |shape, _| refined(&shape));
    mapped(&smooth, |p| {
        let [x, y, z] = p.map(|x| x / distance(p, [0.0; 3]));
        let r = 1.0 + 0.2 * (3.0 * x + 0.4).sin() * (2.5 * y - 0.7).cos() + 0.15 * (4.0 * z + x).sin() + 0.1 * y;
        [1.3 * r * x, r * y, 0.8 * r * z]
    })
}

fn turn(i: u32, count: u32) -> f64 {
    std::f64::consts::TAU * f64::from(i) / f64::from(count)
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
}

fn cells(size: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    let plane = move |z| (0..size[1]).flat_map(move |y| (0..size[0]).map(move |x| [x, y, z]));
    (0..size[2]).flat_map(plane)
}

/// A grid of quads, each cut in two, closed up in the directions that wrap.
fn grid(size: [u32; 2], wraps: [bool; 2], point: impl Fn(u32, u32) -> [f64; 3]) -> Shape {
    let columns = if wraps[0] { size[0] } else { size[0] + 1 };
    let rows = if wraps[1] { size[1] } else { size[1] + 1 };
    let at = |i: u32, j: u32| (i % columns) * rows + j % rows;
    let points = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))).map(|(i, j)| point(i, j)).collect();
    let quads = (0..size[0]).flat_map(|i| (0..size[1]).map(move |j| (i, j)));
    let halves = |(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    Shape { points, triangles: quads.flat_map(halves).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solids_have_their_topology() {
        let topology = |shape: Shape| {
            let mesh = shape.mesh();
            mesh.check();
            (mesh.genus(), mesh.boundary_loops().len())
        };
        assert_eq!(topology(tetrahedron()), (0, 0));
        assert_eq!(topology(bumpy_sphere(2)), (0, 0));
        assert_eq!(topology(torus(5, 3)), (1, 0));
        assert_eq!(topology(tube(3, 1)), (0, 2));
        assert_eq!(topology(patch(2, 3)), (0, 1));
        for genus in 0..5 {
            for windows in 0..5 {
                assert_eq!(topology(slab(genus, windows)), (genus, windows));
                assert_eq!(topology(refined(&slab(genus, windows))), (genus, windows));
            }
        }
    }
}
