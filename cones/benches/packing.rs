//! How long packing takes: by the number of islands, and by that of the triangles.
//!
//! `cargo bench -p cones --bench packing`

use cones::uv::{PackOptions, pack};
use geom::Watch;

type Triangle = [[f64; 2]; 3];

fn main() {
    divan::main();
}

/// Bent strips of so many triangles each, of different lengths.
fn strips(islands: u32, triangles: usize) -> (Vec<Triangle>, Vec<u32>) {
    let numbered = (0..islands).flat_map(|i| {
        let bend = 0.5 + f64::from(i * 37 % 11) / 4.0;
        let at = move |k: usize, r: f64| {
            let angle = bend * k as f64 / triangles as f64;
            [r * angle.cos(), r * angle.sin()]
        };
        (0..triangles / 2).flat_map(move |k| {
            let [a, b, c, d] = [at(2 * k, 1.0), at(2 * k, 1.3), at(2 * k + 2, 1.3), at(2 * k + 2, 1.0)];
            [([a, b, c], i), ([a, c, d], i)]
        })
    });
    numbered.unzip()
}

#[divan::bench(args = [1, 2, 5, 20, 100, 400, 5000])]
fn islands(bencher: divan::Bencher, count: u32) {
    let (triangles, island) = strips(count, 30_000 / count as usize + 2);
    bencher.bench(|| pack(&triangles, &island, &PackOptions::default(), Watch::NONE));
}

#[divan::bench(args = [30_000, 100_000, 871_414])]
fn triangles_of_ten_islands(bencher: divan::Bencher, count: usize) {
    let (triangles, island) = strips(10, count / 10);
    bencher.bench(|| pack(&triangles, &island, &PackOptions::default(), Watch::NONE));
}
