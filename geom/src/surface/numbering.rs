//! Vertices numbered so that what is near is near in memory.

use crate::parallel::{map, sort};

/// Surfaces of fewer vertices fit the cache whatever their numbering.
pub(super) const FITS_THE_CACHE: usize = 1 << 13;

/// Whether what is near on a large surface is mostly far apart in memory: the ends of edges, or triangles that follow each other. Numbers are far apart
/// where four rows of a square grid with as many vertices are between them.
pub(super) fn is_scattered(vertex_count: usize, faces: &[u32], vertex: impl Fn(usize) -> u32) -> bool {
    if vertex_count < FITS_THE_CACHE {
        return false;
    }
    let reach = 4 * vertex_count.isqrt() as u32;
    let ends = faces.iter().map(|&f| (vertex(3 * f as usize), vertex(3 * f as usize + 1)));
    let far = |(a, b): (u32, u32)| a.abs_diff(b) > reach;
    let long = ends.clone().filter(|&ends| far(ends)).count();
    let jumps = ends.clone().zip(ends.skip(1)).filter(|&((a, _), (b, _))| far((a, b))).count();
    2 * long.max(jumps) > faces.len()
}

/// The points of a box of size 1 about the origin, in the order of Morton's curve, where neighbours are mostly near each other. O(n log n).
pub(super) fn along_a_curve(points: &[[f64; 3]]) -> Vec<u32> {
    let code = |k: usize| {
        // 21 bits an axis, each followed by two of the other axes.
        let [x, y, z] = points[k].map(|x| {
            let mut bits = (((x + 0.5) * f64::from(1 << 21)) as u64).min((1 << 21) - 1);
            for (shift, mask) in CURVE {
                bits = (bits | bits << shift) & mask;
            }
            bits
        });
        (x | y << 1 | z << 2, k as u32)
    };
    let mut order: Vec<(u64, u32)> = map(points.len(), code);
    sort(&mut order);
    order.into_iter().map(|(_, k)| k).collect()
}

/// How the bits of a number of 21 are spread to every third place, in five steps.
const CURVE: [(u32, u64); 5] = [
    (32, 0x001F_0000_0000_FFFF),
    (16, 0x001F_0000_FF00_00FF),
    (8, 0x100F_00F0_0F00_F00F),
    (4, 0x10C3_0C30_C30C_30C3),
    (2, 0x1249_2492_4924_9249),
];
