//! Fields for benchmarks, the same on every machine: smooth noise with hills of many sizes.

/// A number in 0..1 from a seed and lattice coordinates (the finaliser of `SplitMix64`).
pub(crate) fn hash(seed: u64, at: [i64; 3]) -> f64 {
    let mut bits =
        at.iter().fold(seed, |bits, &c| (bits ^ c as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29));
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ bits >> 31) >> 11) as f64 / (1u64 << 53) as f64
}

/// Value noise: random numbers on the integer lattice, blended smoothly between.
fn value_noise(seed: u64, point: [f64; 3]) -> f64 {
    let cell = point.map(|c| c.floor() as i64);
    let blend: [f64; 3] = core::array::from_fn(|axis| {
        let t = point[axis] - point[axis].floor();
        t * t * (3.0 - 2.0 * t)
    });
    let corner = |dz: i64, dy: i64, dx: i64| hash(seed, [cell[0] + dz, cell[1] + dy, cell[2] + dx]);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let row = |dz, dy| mix(corner(dz, dy, 0), corner(dz, dy, 1), blend[2]);
    let plane = |dz| mix(row(dz, 0), row(dz, 1), blend[1]);
    if blend[0] == 0.0 { plane(0) } else { mix(plane(0), plane(1), blend[0]) }
}

/// Long waves and three octaves of value noise, the finest with features of a few vertices.
pub(crate) fn smooth(point: [f64; 3]) -> f64 {
    let waves: f64 = point.iter().zip([0.031, 0.017, 0.023]).map(|(c, k)| (c * k).sin()).sum();
    let octaves = [(3.9, 0.25), (13.7, 0.6), (61.0, 2.0)];
    let noise: f64 = octaves
        .iter()
        .zip(1..)
        .map(|(&(size, height), seed)| height * value_noise(seed, point.map(|c| c / size)))
        .sum();
    waves + noise
}

/// A smooth field on a grid of three axes.
pub(crate) fn on_grid([nz, ny, nx]: [usize; 3]) -> Vec<f64> {
    let at = |z: usize, y: usize, x: usize| smooth([z as f64, y as f64, x as f64]);
    (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| at(z, y, x)))).collect()
}
